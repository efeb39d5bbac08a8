#include "dsl/semantics/calls.h"

#include <string.h>

#include "dsl/semantics/names.h"
#include "dsl/semantics/order.h"
#include "dsl/semantics/types.h"

static expr *operand(const expr *e, int i) {
  return e->arguments[i].value;
}

static const char *function_name(checker *ck, const expr *e) {
  return arena_printf(ck->memory, "the argument of `%s`", e->name);
}

static value bad_shape(checker *ck, const expr *e, value v, const char *hint) {
  complain(ck, DIAG_SHAPE, operand(e, 0)->where, "`%s` does not take %s", e->name,
           v.shape == SHAPE_LOGICAL ? "what is true or false" : shape_words(v.shape));
  if (hint) diag_hint(ck->d, "%s", hint);
  return BROKEN;
}

static value with_shape(value v, dimension dim, shape s) {
  v.dim = dim;
  v.shape = s;
  v.zero = v.whole = v.deviator = false;
  return v;
}

/* --- functions of one number ------------------------------------------------------------------ */

static value check_scalar_argument(checker *ck, expr *e, const char *hint) {
  value v = check_number(ck, operand(e, 0));
  if (v.broken || v.unknown || v.shape == SHAPE_SCALAR) return v;
  bool magnitude = v.shape == SHAPE_BENDING || v.shape == SHAPE_VECTOR;
  return bad_shape(ck, e, v, magnitude ? hint : NULL);
}

static value same_unit(checker *ck, expr *e) {
  return check_scalar_argument(
      ck, e, "for the magnitude of a bending quantity or vector write `norm(...)`");
}

static value sign(checker *ck, expr *e) {
  value v = check_scalar_argument(ck, e, NULL);
  if (v.broken) return v;
  v.unknown = false;
  return with_shape(v, DIMENSIONLESS, SHAPE_SCALAR);
}

static value pure(checker *ck, expr *e) {
  value v = check_scalar_argument(ck, e, "take the magnitude first: `norm(...)`");
  if (v.broken || v.unknown) {
    v.unknown = false;
    return v.broken ? v : with_shape(v, DIMENSIONLESS, SHAPE_SCALAR);
  }
  if (!expect(ck, operand(e, 0), v, DIMENSIONLESS, SHAPE_SCALAR, function_name(ck, e))) {
    if (!diag_hinted(ck->d)) diag_hint(ck->d, "divide by a reference value: `%s(x/x_0)`", e->name);
    return BROKEN;
  }
  return with_shape(v, DIMENSIONLESS, SHAPE_SCALAR);
}

static value root(checker *ck, expr *e) {
  value v = check_scalar_argument(ck, e, "take the magnitude first: `norm(...)`");
  if (v.broken || v.unknown) return v;
  v.zero = false;
  if (dim_pow(v.dim, 1, e->builtin == FUNCTION_SQRT ? 2 : 3, &v.dim)) return v;
  complain(ck, DIAG_UNITS, e->where, "the %s root of %s has no exact unit",
           e->builtin == FUNCTION_SQRT ? "square" : "cube", describe(ck, v.dim));
  return BROKEN;
}

/* Carries [j]: has a value for each neighbour. */
static bool varies_in_family(value v) {
  return v.place == ON_BOND || v.place == ON_NEIGHBOUR;
}

/* Of `norm`, which goes over the whole family: how what carries [j] is written without it. */
static void hint_at_whole(checker *ck, const expr *of) {
  const bool deviates = of->kind == EXPR_CALL && of->builtin == FUNCTION_DEVIATOR;
  const expr *inner = deviates ? of->arguments[0].value : of;
  if (inner->kind == EXPR_NAME && !inner->primed)
    diag_hint(ck->d,
              "over the whole family, without [j]: `norm(%s%s%s)`; one value's size: `abs(...)`",
              deviates ? "deviator(" : "", inner->name, deviates ? ")" : "");
  else
    diag_hint(ck->d, "over the whole family: give it a name first, `x[j] = ...`, and write "
                     "`norm(x)`; one value's size: `abs(...)`");
}

static value norm(checker *ck, expr *e) {
  value v = check_family(ck, operand(e, 0));
  if (v.whole) v.place = ON_PARTICLE;
  const bool family = v.whole;
  v.whole = false;
  if (v.broken || v.unknown) return v;
  if (!family && (v.shape == SHAPE_SCALAR || v.shape == SHAPE_LOGICAL)) {
    const bool indexed = !is_single(ck) && varies_in_family(v);
    bad_shape(ck, e, v, indexed ? NULL : "for the size of a number write `abs(...)`");
    if (indexed) hint_at_whole(ck, operand(e, 0));
    return BROKEN;
  }
  return with_shape(v, v.dim, SHAPE_SCALAR);
}

/* --- of several numbers ----------------------------------------------------------------------- */

static value arctangent(checker *ck, expr *e) {
  value y = check_number(ck, operand(e, 0)), x = check_number(ck, operand(e, 1));
  value v = agree(ck, e->where, operand(e, 0), y, operand(e, 1), x, "the sides of one angle");
  if (v.broken) return v;
  v.unknown = false;
  if (!expect_scalar(ck, operand(e, 0), v, function_name(ck, e))) return BROKEN;
  return with_shape(v, DIMENSIONLESS, SHAPE_SCALAR);
}

static value reduced(checker *ck, expr *e, value v) {
  if (v.broken) return v;
  if (is_single(ck)) {
    complain(ck, DIAG_PLACEMENT, e->where,
             "`%s` of one value goes over a family, which a %s law does not have", e->name,
             law_word(ck));
    if (e->builtin == FUNCTION_MIN || e->builtin == FUNCTION_MAX)
      diag_hint(ck->d, "give it two values or more");
    return BROKEN;
  }
  if (!v.unknown && !varies_in_family(v)) {
    complain(ck, DIAG_PLACEMENT, e->where,
             "`%s` goes over the family, but nothing in it carries [j]", e->name);
    diag_hint(ck->d, "write the neighbour's value as `x[j]`");
    return BROKEN;
  }
  if (!v.unknown && v.shape != SHAPE_SCALAR && e->builtin != FUNCTION_SUM &&
      e->builtin != FUNCTION_MEAN)
    return bad_shape(ck, e, v, NULL);
  v.place = ON_PARTICLE;
  return v;
}

static value reduce_argument(checker *ck, expr *e, int i) {
  if (ck->in_reduction) {
    complain(ck, DIAG_PLACEMENT, e->where, "`%s` stands inside another sum over the family",
             e->name);
    diag_hint(ck->d, "give the inner one a name of its own first");
    return BROKEN;
  }
  ck->in_reduction = true;
  value v = check_number(ck, operand(e, i));
  ck->in_reduction = false;
  return v;
}

static value extreme(checker *ck, expr *e) {
  if (e->argument_count == 1) return reduced(ck, e, reduce_argument(ck, e, 0));
  value v = check_number(ck, operand(e, 0));
  for (int i = 1; i < e->argument_count; i++) {
    value next = check_number(ck, operand(e, i));
    v = agree(ck, e->where, operand(e, 0), v, operand(e, i), next, "compared");
  }
  if (v.broken || v.unknown || v.shape == SHAPE_SCALAR) return v;
  bool magnitude = v.shape == SHAPE_BENDING || v.shape == SHAPE_VECTOR;
  return bad_shape(ck, e, v, magnitude ? "compare magnitudes: `norm(...)`" : NULL);
}

static value sum(checker *ck, expr *e) {
  return reduced(ck, e, reduce_argument(ck, e, 0));
}

static value mean(checker *ck, expr *e) {
  value v = reduced(ck, e, reduce_argument(ck, e, 0));
  if (e->argument_count == 1 || v.broken) return v;
  value weight = reduce_argument(ck, e, 1);
  if (weight.broken || !expect_scalar(ck, operand(e, 1), weight, "a weight")) return BROKEN;
  return v;
}

/* --- old values and derivatives --------------------------------------------------------------- */

static value previous(checker *ck, expr *e) {
  expr *of = operand(e, 0);
  value v = check_family(ck, of);
  if (v.broken || of->kind == EXPR_HOLE) return v;
  const symbol *s = of->kind == EXPR_NAME ? of->symbol : NULL;
  if (s && (s->kind == SYMBOL_STATE || s->kind == SYMBOL_DAMAGE)) {
    of->reads_old = true;
    entry_of(s)->symbol.old_is_read = true;
    return v;
  }
  complain(ck, DIAG_ARGUMENTS, of->where, "`previous` takes the name of a state or damage");
  diag_hint(ck->d, "to keep a value from step to step declare `state x on %s = 0`",
            placement_name(natural_place(ck)));
  return BROKEN;
}

/* Made of a bond's length and rotations. */
static bool is_slip(const expr *e) {
  return e->kind == EXPR_NAME && e->symbol && e->symbol->kind == SYMBOL_QUANTITY &&
         builtin_quantities[e->symbol->index].kinds == IN_SLIP;
}

static bool is_variable(const expr *e) {
  if (e->kind != EXPR_NAME || !e->symbol) return false;
  switch (e->symbol->kind) {
  case SYMBOL_QUANTITY:
    return !is_slip(e);
  case SYMBOL_PARAMETER:
  case SYMBOL_STATE:
  case SYMBOL_DAMAGE:
    return true;
  default:
    return false;
  }
}

static value derivative(checker *ck, expr *e) {
  expr *by = operand(e, 1);
  value f = check_number(ck, operand(e, 0)), x = check_number(ck, by);
  if (f.broken || x.broken) return BROKEN;
  if (!is_variable(by) && by->kind != EXPR_HOLE) {
    complain(ck, DIAG_ARGUMENTS, by->where,
             "`diff` differentiates by a quantity, a parameter, a state or a damage");
    if (is_slip(by))
      diag_hint(ck->d,
                "`%s` follows from length and rotations of the bond: give `energy W` and no "
                "forces, or write the derivative out",
                by->name);
    else
      diag_hint(ck->d, "write a name such as `stretch`");
    return BROKEN;
  }
  value v = {.dim = dim_div(f.dim, x.dim),
             .place = place_join(ck, f.place, x.place),
             .unknown = f.unknown || x.unknown};
  if (v.unknown) return v;
  if (f.shape != SHAPE_SCALAR && x.shape != SHAPE_SCALAR && f.shape != SHAPE_BENDING) {
    complain(ck, DIAG_SHAPE, e->where, "%s cannot be differentiated by %s", shape_words(f.shape),
             shape_words(x.shape));
    return BROKEN;
  }
  /* A moment by a rotation: a number in two dimensions. */
  bool both = f.shape == SHAPE_BENDING && x.shape == SHAPE_BENDING;
  v.shape = both ? SHAPE_SCALAR : f.shape != SHAPE_SCALAR ? f.shape : x.shape;
  v.deviator = f.deviator || x.deviator;
  return v;
}

/* --- of a family and of tensors --------------------------------------------------------------- */

static bool needs_state_law(checker *ck, const expr *e) {
  if (!is_single(ck)) return true;
  complain(ck, DIAG_LAW_KIND, e->where,
           "`%s` needs a particle's family, which a %s law does not have", e->name, law_word(ck));
  diag_hint(ck->d, "a law that begins with `law state` has it");
  return false;
}

static value family_argument(checker *ck, expr *e, bool indexed_too) {
  if (!needs_state_law(ck, e)) return BROKEN;
  const char *outer = ck->of_whole_family;
  ck->of_whole_family = operand(e, 0) && operand(e, 0)->kind != EXPR_NAME ? e->name : NULL;
  value v = check_family(ck, operand(e, 0));
  const bool unnamed = ck->of_whole_family != NULL;
  ck->of_whole_family = outer;
  if (v.broken || v.unknown) return v;
  if (v.whole || (indexed_too && varies_in_family(v))) return v;
  complain(ck, DIAG_PLACEMENT, operand(e, 0)->where, "`%s` takes a family's values as a whole",
           e->name);
  if (unnamed)
    diag_hint(ck->d, HINT_NAME_THE_FAMILY, e->name);
  else
    diag_hint(ck->d, "write the name without [j]");
  return BROKEN;
}

static value deviator(checker *ck, expr *e) {
  value v = family_argument(ck, e, true);
  v.zero = false;
  return v;
}

/* What goes along the bonds, or is measured so, is a number toward each neighbour. */
static bool is_along_bonds(checker *ck, const expr *e, value v) {
  if (v.unknown || v.shape == SHAPE_SCALAR) return true;
  bad_shape(ck, e, v, "it takes a number toward each neighbour, along the bonds");
  return false;
}

/* Of a force state in N, or in N/m^6 (a force per both volumes). */
static value virtual_work(checker *ck, expr *e) {
  value v = family_argument(ck, e, false);
  if (v.broken || !is_along_bonds(ck, e, v)) return BROKEN;
  bool known =
      v.unknown || dim_equal(v.dim, dimension_of("N")) || dim_equal(v.dim, dimension_of("N/m^6"));
  if (!known) {
    complain(ck, DIAG_UNITS, operand(e, 0)->where,
             "`virtual_work` takes a force state in N or N/m^6, but this is %s",
             describe(ck, v.dim));
    return BROKEN;
  }
  ck->reads_poisson = true;
  v.place = ON_PARTICLE;
  v.unknown = false;
  return with_shape(v, dimension_of("Pa"), SHAPE_TENSOR);
}

static value fit(checker *ck, expr *e) {
  value v = family_argument(ck, e, false);
  v.place = ON_PARTICLE;
  v.whole = false;
  if (v.broken || v.unknown) return v;
  if (!is_along_bonds(ck, e, v)) return BROKEN;
  ck->reads_poisson = true;
  return with_shape(v, v.dim, SHAPE_TENSOR);
}

static value tensor_argument(checker *ck, expr *e);

/* A number toward each neighbour, out of a tensor of the particle. */
static value toward_neighbours(checker *ck, expr *e, const char *unit_in, const char *unit_out,
                               const char *what) {
  value v = tensor_argument(ck, e);
  if (v.broken || v.unknown) return v;
  if (!expect(ck, operand(e, 0), v, dimension_of(unit_in), SHAPE_TENSOR, what)) return BROKEN;
  v.place = ON_NEIGHBOUR;
  return with_shape(v, dimension_of(unit_out), SHAPE_SCALAR);
}

static value uniform_force(checker *ck, expr *e) {
  return toward_neighbours(ck, e, "Pa", "N", "what `uniform_force` takes");
}

static value uniform_stretch(checker *ck, expr *e) {
  return toward_neighbours(ck, e, "1", "1", "what `uniform_stretch` takes");
}

static value hooke(checker *ck, expr *e) {
  value v = tensor_argument(ck, e);
  value E = check_number(ck, operand(e, 1)), nu = check_number(ck, operand(e, 2));
  if (!expect(ck, operand(e, 0), v, DIMENSIONLESS, SHAPE_TENSOR, "the strain in `hooke`") ||
      !expect(ck, operand(e, 1), E, dimension_of("Pa"), SHAPE_SCALAR, "Young's modulus") ||
      !expect(ck, operand(e, 2), nu, DIMENSIONLESS, SHAPE_SCALAR, "Poisson's ratio"))
    return BROKEN;
  v.place = place_join(ck, v.place, place_join(ck, E.place, nu.place));
  v.unknown = false;
  return with_shape(v, dimension_of("Pa"), SHAPE_TENSOR);
}

static bool has_tensors(checker *ck, const expr *e) {
  if (!is_single(ck) || ck->tree->law == LAW_CONTINUUM) return true;
  complain(ck, DIAG_LAW_KIND, e->where, "`%s` is of tensors, which a %s law does not have", e->name,
           law_word(ck));
  diag_hint(ck->d, "laws that begin with `law state` or `law continuum` have tensors");
  return false;
}

static value tensor_argument(checker *ck, expr *e) {
  if (!has_tensors(ck, e)) return BROKEN;
  value v = check_number(ck, operand(e, 0));
  if (v.broken || v.unknown || v.shape == SHAPE_TENSOR) return v;
  return bad_shape(ck, e, v,
                   v.shape == SHAPE_GENERAL ? "take its symmetric part: `sym(...)`"
                                            : "it takes a stress or strain");
}

static value deviator_of_tensor(checker *ck, expr *e) {
  value v = tensor_argument(ck, e);
  v.deviator = !v.broken && !v.unknown;
  return v;
}

/* Also one that need not be symmetric. */
static value any_tensor_argument(checker *ck, expr *e) {
  if (!has_tensors(ck, e)) return BROKEN;
  value v = check_number(ck, operand(e, 0));
  if (v.broken || v.unknown || shape_is_tensor(v.shape)) return v;
  return bad_shape(ck, e, v, "it takes a tensor");
}

static value transpose(checker *ck, expr *e) {
  return any_tensor_argument(ck, e);
}

static value sym(checker *ck, expr *e) {
  value v = any_tensor_argument(ck, e);
  if (!v.broken && !v.unknown) v.shape = SHAPE_TENSOR;
  return v;
}

static value det(checker *ck, expr *e) {
  value v = any_tensor_argument(ck, e);
  if (v.broken || v.unknown) return v;
  return with_shape(v, dim_mul(dim_mul(v.dim, v.dim), v.dim), SHAPE_SCALAR);
}

static value inverse(checker *ck, expr *e) {
  value v = any_tensor_argument(ck, e);
  if (v.broken || v.unknown) return v;
  return with_shape(v, dim_div(DIMENSIONLESS, v.dim), v.shape);
}

static value rotation(checker *ck, expr *e) {
  value v = any_tensor_argument(ck, e);
  if (v.broken || v.unknown) return v;
  return with_shape(v, DIMENSIONLESS, SHAPE_GENERAL);
}

static value tensor_to_scalar(checker *ck, expr *e) {
  const bool any = e->builtin == FUNCTION_TRACE;
  value v = any ? any_tensor_argument(ck, e) : tensor_argument(ck, e);
  if (v.broken || v.unknown) return v;
  dimension dim = e->builtin == FUNCTION_J2 ? dim_mul(v.dim, v.dim) : v.dim;
  return with_shape(v, dim, SHAPE_SCALAR);
}

/* `v` where the second argument says which principal value is meant. */
static value of_principal(checker *ck, expr *e, value v) {
  expr *which = operand(e, 1);
  check_number(ck, which);
  bool one_to_three = which->kind == EXPR_NUMBER && !which->unit_text &&
                      (which->number == 1 || which->number == 2 || which->number == 3);
  if (v.broken || one_to_three || which->kind == EXPR_HOLE) return v;
  complain(ck, DIAG_ARGUMENTS, which->where, "the second argument of `%s` is 1, 2 or 3", e->name);
  diag_hint(ck->d, "1 is the largest principal value");
  return BROKEN;
}

static value principal(checker *ck, expr *e) {
  return of_principal(ck, e, tensor_to_scalar(ck, e));
}

static value principal_direction(checker *ck, expr *e) {
  value v = tensor_argument(ck, e);
  if (!v.broken && !v.unknown) v = with_shape(v, DIMENSIONLESS, SHAPE_TENSOR);
  return of_principal(ck, e, v);
}

static value product(checker *ck, expr *e) {
  value a = tensor_argument(ck, e);
  if (a.broken) return BROKEN;
  value b = check_number(ck, operand(e, 1));
  if (b.broken) return BROKEN;
  value v = {.place = place_join(ck, a.place, b.place), .unknown = a.unknown || b.unknown};
  if (v.unknown) return v;
  if (b.shape != SHAPE_TENSOR) return bad_shape(ck, e, b, "both are tensors");
  return with_shape(v, dim_mul(a.dim, b.dim), SHAPE_TENSOR);
}

/* xx, yy, zz, xy and, where they are not 0, yz, xz; of one that need not be symmetric yx, zy, zx,
   too. */
static value tensor_of_components(checker *ck, expr *e) {
  if (!has_tensors(ck, e)) return BROKEN;
  value all = {.zero = true};
  for (int i = 0; i < e->argument_count; i++) {
    value v = check_number(ck, operand(e, i));
    all = agree(ck, operand(e, i)->where, operand(e, 0), all, operand(e, i), v,
                "components of one tensor");
    if (all.broken) return BROKEN;
    if (!v.zero && !v.unknown && v.shape != SHAPE_SCALAR)
      return bad_shape(ck, e, v, "its components are numbers: xx, yy, zz, xy, yz, xz");
  }
  const bool general = e->argument_count == GENERAL_COMPONENT_COUNT;
  if (e->argument_count != 4 && e->argument_count != TENSOR_COMPONENT_COUNT && !general) {
    complain(ck, DIAG_ARGUMENTS, e->where, "`tensor` takes 4, %d or %d components, not %d",
             TENSOR_COMPONENT_COUNT, GENERAL_COMPONENT_COUNT, e->argument_count);
    diag_hint(ck->d, "they are xx, yy, zz, xy, and out of the plane yz, xz; of a tensor that need "
                     "not be symmetric yx, zy, zx behind these");
    return BROKEN;
  }
  const bool zero = all.zero;
  all.zero = false;
  all.unknown &= ck->holes;
  all = with_shape(all, all.dim, general ? SHAPE_GENERAL : SHAPE_TENSOR);
  all.deviator = zero && !general;
  return all;
}

/* --- gradients of a family -------------------------------------------------------------------- */

/* `weight = w[j]` behind the first argument. */
static bool has_good_weight(checker *ck, expr *e) {
  if (e->argument_count == 1) return true;
  const value weight = reduce_argument(ck, e, 1);
  return !weight.broken &&
         expect(ck, operand(e, 1), weight, DIMENSIONLESS, SHAPE_SCALAR, "a weight");
}

static bool is_displacement(const expr *e) {
  return e->kind == EXPR_NAME && !e->indexed && e->symbol && e->symbol->kind == SYMBOL_QUANTITY &&
         e->symbol->index == QUANTITY_U;
}

/* Of a number a vector, of a vector a tensor. */
static value gradient(checker *ck, expr *e) {
  if (!needs_state_law(ck, e)) return BROKEN;
  expr *of = operand(e, 0);
  value v = check_number(ck, of);
  if (v.broken || !has_good_weight(ck, e)) return BROKEN;
  if (is_displacement(of)) v.place = ON_PARTICLE;
  if (!v.unknown && v.place != ON_PARTICLE) {
    const bool toward = v.place > ON_PARTICLE;
    complain(ck, DIAG_PLACEMENT, of->where,
             toward ? "`gradient` takes what each particle has, but %s has a value for each "
                      "neighbour"
                    : "`gradient` takes what each particle has, but %s is the same for all",
             quoted(ck, of, "this"));
    if (toward) diag_hint(ck->d, "write the name without [j]: the sum over the family is its own");
    return BROKEN;
  }
  if (v.unknown) return v;
  if (v.shape != SHAPE_SCALAR && v.shape != SHAPE_VECTOR)
    return bad_shape(ck, e, v, "it takes a number or a vector of the particle");
  return with_shape(v, dim_div(v.dim, dimension_of("m")),
                    v.shape == SHAPE_VECTOR ? SHAPE_GENERAL : SHAPE_VECTOR);
}

static value correspondence(checker *ck, expr *e) {
  if (!needs_state_law(ck, e)) return BROKEN;
  value v = any_tensor_argument(ck, e);
  if (v.broken || !has_good_weight(ck, e)) return BROKEN;
  if (!v.unknown && v.place > ON_PARTICLE) {
    complain(ck, DIAG_PLACEMENT, operand(e, 0)->where,
             "`correspondence` takes the stress of the particle, but this has a value for each "
             "neighbour");
    return BROKEN;
  }
  if (!v.unknown && !expect(ck, operand(e, 0), v, dimension_of("Pa"),
                            v.zero ? SHAPE_TENSOR : v.shape, "what `correspondence` takes"))
    return BROKEN;
  v.place = ON_NEIGHBOUR;
  v.unknown = false;
  return with_shape(v, dimension_of("N"), SHAPE_VECTOR);
}

/* --- vectors ---------------------------------------------------------------------------------- */

/* x, y and, where it is not 0, z. */
static value vector_of_components(checker *ck, expr *e) {
  value all = {.zero = true};
  for (int i = 0; i < e->argument_count; i++) {
    const value v = check_number(ck, operand(e, i));
    all = agree(ck, operand(e, i)->where, operand(e, 0), all, operand(e, i), v,
                "components of one vector");
    if (all.broken) return BROKEN;
    if (v.zero || v.unknown || v.shape == SHAPE_SCALAR) continue;
    complain(ck, DIAG_SHAPE, operand(e, i)->where,
             "a component of a vector must be a number, but this is %s", shape_words(v.shape));
    return BROKEN;
  }
  return with_shape(all, all.dim, SHAPE_VECTOR);
}

/* Argument `i`, which must be a vector. */
static value vector_argument(checker *ck, expr *e, int i) {
  expr *of = operand(e, i);
  const value v = check_number(ck, of);
  if (v.broken || v.unknown || v.shape == SHAPE_VECTOR) return v;
  complain(ck, DIAG_SHAPE, of->where, "`%s` takes two vectors, but %s is %s", e->name,
           quoted(ck, of, "this"), shape_words(v.shape));
  if (v.shape == SHAPE_SCALAR)
    diag_hint(ck->d, "a vector is a parameter such as `fibre = (1, 0, 0)`, `direction`, or "
                     "`(x, y, z)` of three numbers");
  else if (e->builtin == FUNCTION_DOT)
    diag_hint(ck->d, "for the scalar product of tensors or bending quantities write `a : b`");
  return BROKEN;
}

static value of_two_vectors(checker *ck, expr *e, shape s) {
  const value a = vector_argument(ck, e, 0), b = vector_argument(ck, e, 1);
  if (a.broken || b.broken) return BROKEN;
  value v = {.place = place_join(ck, a.place, b.place), .unknown = a.unknown || b.unknown};
  return v.unknown ? v : with_shape(v, dim_mul(a.dim, b.dim), s);
}

static value dot(checker *ck, expr *e) {
  return of_two_vectors(ck, e, SHAPE_SCALAR);
}

static value cross(checker *ck, expr *e) {
  return of_two_vectors(ck, e, SHAPE_VECTOR);
}

static value dyad(checker *ck, expr *e) {
  return has_tensors(ck, e) ? of_two_vectors(ck, e, SHAPE_TENSOR) : BROKEN;
}

static value (*const calls[FUNCTION_COUNT])(checker *ck, expr *e) = {
#define X(code, name, least, most, check, ...) check,
    BUILTIN_FUNCTIONS(X)
#undef X
};

/* --- functions of the law --------------------------------------------------------------------- */

value check_function_body(checker *ck, entry *function) {
  entry *outer = ck->function;
  bool reduction = ck->in_reduction;
  ck->function = function;
  ck->in_reduction = false;
  function->in_use = true;
  value v = check_value(ck, function->symbol.declared->value);
  function->in_use = false;
  ck->function = outer;
  ck->in_reduction = reduction;
  return v;
}

static bool takes_weight(const expr *e) {
  return e->builtin == FUNCTION_MEAN || e->builtin == FUNCTION_GRADIENT ||
         e->builtin == FUNCTION_CORRESPONDENCE;
}

static bool check_arity(checker *ck, const expr *e, int least, int most, const char *meaning) {
  for (int i = 0; i < e->argument_count; i++) {
    const argument *a = &e->arguments[i];
    if (!a->keyword || (takes_weight(e) && i == 1 && strcmp(a->keyword, "weight") == 0)) continue;
    complain(ck, DIAG_ARGUMENTS, a->keyword_where, "`%s` has no argument called `%s`", e->name,
             a->keyword);
    if (takes_weight(e))
      diag_hint(ck->d, "write `%s(%s, weight = w[j])`", e->name,
                e->builtin == FUNCTION_MEAN ? "x[j]" : "x");
    return false;
  }
  if (e->argument_count >= least && e->argument_count <= most) return true;
  if (least == most)
    complain(ck, DIAG_ARGUMENTS, e->where, "`%s` takes %d argument%s, not %d", e->name, least,
             least == 1 ? "" : "s", e->argument_count);
  else
    complain(ck, DIAG_ARGUMENTS, e->where, "`%s` takes %d to %d arguments, not %d", e->name, least,
             most, e->argument_count);
  if (meaning) diag_hint(ck->d, "`%s`: %s", e->name, meaning);
  return false;
}

/* A function has no units of its own: with f(p, q) = p*q, f(s, s) is in m^2 and f(k, stretch) in N.
   The body is checked once where it is declared, its arguments agreeing with everything, and again
   at each call with the arguments' units; what is wrong there is reported at the call. */
static value expand(checker *ck, expr *e, entry *function) {
  value values[MOST_ARGUMENTS];
  bool broken = false;
  for (int i = 0; i < e->argument_count; i++) {
    values[i] = check_value(ck, operand(e, i));
    broken |= values[i].broken;
  }
  if (broken || function->type.broken) return BROKEN;
  if (++ck->expansions > MOST_EXPANSIONS) {
    if (ck->expansions == MOST_EXPANSIONS + 1)
      complain(ck, DIAG_TOO_LONG, e->where,
               "functions that call functions make this law longer than %d calls", MOST_EXPANSIONS);
    return BROKEN;
  }
  for (int i = 0; i < e->argument_count; i++) {
    function->arguments[i].type = values[i];
    function->arguments[i].known = true;
  }
  if (ck->call_depth++ == 0) ck->call_where = e->where;
  value v = check_function_body(ck, function);
  ck->call_depth--;
  return v;
}

static value check_own_function(checker *ck, expr *e, entry *function) {
  const stmt *s = function->symbol.declared;
  e->symbol = &function->symbol;
  function->symbol.used = true;
  if (function->in_use || function->declared_at >= ck->now) {
    report_undefined(ck, e, function);
    return BROKEN;
  }
  if (!check_arity(ck, e, s->word_count, s->word_count, NULL)) {
    diag_note(ck->d, s->name_where, "`%s` is declared here", s->name);
    return BROKEN;
  }
  return expand(ck, e, function);
}

/* What people call functions elsewhere, and how the same is written here. X(name, hint) */
#define FOREIGN_FUNCTIONS(X)                                                                       \
  X("ln", "the natural logarithm is `log(x)`")                                                     \
  X("pow", "powers are written `x**p`")                                                            \
  X("fabs", "the absolute value is `abs(x)`")                                                      \
  X("macaulay", "write `positive_part(x)`")                                                        \
  X("sgn", "write `sign(x)`")                                                                      \
  X("atan", "write `atan2(x, 1)`")                                                                 \
  X("arctan", "write `atan2(x, 1)`")                                                               \
  X("arcsin", "write `asin(x)`")                                                                   \
  X("arccos", "write `acos(x)`")                                                                   \
  X("asinh", "write `log(x + sqrt(x**2 + 1))`")                                                    \
  X("acosh", "write `log(x + sqrt(x**2 - 1))`")                                                    \
  X("atanh", "write `log((1 + x)/(1 - x))/2`")                                                     \
  X("log2", "write `log(x)/log(2)`")                                                               \
  X("if", "choose with cases: | value when guard | value otherwise")                               \
  X("heaviside", "choose with cases: | 1 when x > 0 | 0 otherwise")                                \
  X("old", "write `previous(x)`")                                                                  \
  X("clamp", "write `min(max(x, low), high)`")

static const char *hint_for_foreign(const char *name) {
#define X(foreign, hint)                                                                           \
  if (strcmp(name, foreign) == 0) return hint;
  FOREIGN_FUNCTIONS(X)
#undef X
  return NULL;
}

static value report_unknown_function(checker *ck, const expr *e) {
  const char *hint = hint_for_foreign(e->name);
  const entry *quantity = names_find(ck, SPACE_QUANTITIES, e->name);
  complain(ck, DIAG_UNKNOWN_FUNCTION, e->name_where,
           quantity ? "`%s` is a quantity, not a function" : "there is no function `%s`", e->name);
  if (quantity)
    diag_hint(ck->d, "a product needs its sign: `%s*(...)`", e->name);
  else if (hint)
    diag_hint(ck->d, "%s", hint);
  else
    names_suggest(ck, SPACE_FUNCTIONS, e->name);
  return BROKEN;
}

static void check_arguments_alone(checker *ck, expr *e) {
  for (int i = 0; i < e->argument_count; i++)
    check_family(ck, operand(e, i));
}

value check_call(checker *ck, expr *e) {
  entry *own = names_find(ck, SPACE_FUNCTIONS, e->name);
  e->builtin = own ? -1 : builtin_function_find(e->name);
  if (own) return check_own_function(ck, e, own);
  if (e->builtin < 0) {
    report_unknown_function(ck, e);
    check_arguments_alone(ck, e);
    return BROKEN;
  }
  const builtin_function_info *f = &builtin_functions[e->builtin];
  if (!check_arity(ck, e, f->least, f->most, f->meaning)) return BROKEN;
  return calls[e->builtin](ck, e);
}
