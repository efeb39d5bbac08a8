#include "dsl/semantics/agreement.h"

#include <string.h>

#include "dsl/semantics/builtins.h"

const value BROKEN = {.broken = true};

value scalar_of(dimension dim, placement where) {
  return (value){.dim = dim, .shape = SHAPE_SCALAR, .place = where};
}

const char *describe(checker *ck, dimension dim) {
  char text[160];
  dim_describe(dim, text, sizeof(text));
  return arena_text(ck->memory, text, strlen(text));
}

const char *shape_words(shape s) {
  switch (s) {
  case SHAPE_SCALAR:
    return "a scalar";
  case SHAPE_LOGICAL:
    return "true or false";
  case SHAPE_BENDING:
    return "a bending quantity";
  case SHAPE_VECTOR:
    return "a vector";
  case SHAPE_TENSOR:
    return "a tensor";
  case SHAPE_GENERAL:
    return "a tensor that need not be symmetric";
  }
  return "";
}

/* What a bond and a particle have in common is the particle's view of the bond: directed. */
placement place_join(const checker *ck, placement a, placement b) {
  placement low = a < b ? a : b, high = a < b ? b : a;
  if (!is_single(ck) && low == ON_PARTICLE && high == ON_BOND) return ON_NEIGHBOUR;
  return high;
}

value joined(const checker *ck, value v, value other) {
  v.place = place_join(ck, v.place, other.place);
  return v;
}

/* --- agreement of two values ------------------------------------------------------------------ */

static void hint_magnitude(checker *ck, expr *a, value va, expr *b, value vb) {
  if (va.shape != SHAPE_SCALAR && vb.shape != SHAPE_SCALAR) return;
  const expr *other = va.shape == SHAPE_SCALAR ? b : a;
  shape s = va.shape == SHAPE_SCALAR ? vb.shape : va.shape;
  if (s == SHAPE_BENDING || s == SHAPE_VECTOR)
    diag_hint(ck->d, "take its magnitude: `norm(%s)`", written(ck, other, "..."));
}

static bool is_bare_number(const expr *e) {
  return e->kind == EXPR_NUMBER && !e->unit_text;
}

const char *quoted(checker *ck, const expr *e, const char *otherwise) {
  const char *text = written(ck, e, NULL);
  return text ? arena_printf(ck->memory, "`%s`", text) : otherwise;
}

/* In x/50 of a formula the 50 lacks the unit of x; where there is such a quotient. */
static const expr *bare_divisor(const expr *e) {
  if (!e) return NULL;
  if (e->kind == EXPR_BINARY && e->binary == OP_DIV && is_bare_number(e->right) &&
      !dim_is_none(e->left->dim))
    return e;
  const expr *found = bare_divisor(e->left);
  if (!found) found = bare_divisor(e->right);
  for (int k = 0; !found && k < e->argument_count; k++)
    found = bare_divisor(e->arguments[k].value);
  return found;
}

static void hint_divisor(checker *ck, const expr *quotient) {
  char text[128];
  dim_unit(quotient->left->dim, text, sizeof text);
  diag_hint(ck->d, "give `%g` its unit, such as `%g [%s]`", quotient->right->number,
            quotient->right->number, strcmp(text, "m") == 0 ? "mm" : text);
}

static void hint_unit(checker *ck, const expr *a, const expr *b, value va, value vb) {
  char text[128];
  const expr *bare = is_bare_number(a) ? a : is_bare_number(b) ? b : NULL;
  if (!bare) return;
  dim_unit(bare == a ? vb.dim : va.dim, text, sizeof(text));
  const expr *other = bare == a ? b : a;
  const expr *quotient = ck->alone && other != bare ? bare_divisor(other) : NULL;
  if (quotient)
    hint_divisor(ck, quotient);
  else if (ck->alone && other != bare) /* x/200, where x/200 [mm] is meant */
    diag_hint(ck->d, "give the number its unit: `%g [%s]`, or divide %s by `1 [%s]`", bare->number,
              text, quoted(ck, other, "the other one"), text);
  else
    diag_hint(ck->d, "give the number its unit: `%g [%s]`", bare->number, text);
}

/* --- the parameter without a unit ------------------------------------------------------------- */

/* What an expression is made of, by names: the first parameter of a large bare number. */
typedef struct cause {
  entry *parameter;
  bool said; /* it is one that has been blamed */
  int looks;
} cause;

static void look_for_cause(const expr *e, cause *c) {
  enum { MOST_LOOKS = 1000 };
  static const double large = 1e3;
  if (!e || c->parameter || c->looks++ > MOST_LOOKS) return;
  const symbol *s = e->kind == EXPR_NAME ? e->symbol : NULL;
  if (s && s->kind == SYMBOL_PARAMETER) {
    const expr *given = s->declared->value;
    if (!given || given->kind != EXPR_NUMBER || given->unit_text || !(given->number >= large))
      return;
    c->parameter = entry_of(s);
    c->said = c->parameter->blamed;
  }
  if (s && (s->kind == SYMBOL_CONSTANT || s->kind == SYMBOL_DEFINED) && s->rule)
    look_for_cause(s->rule->value, c);
  look_for_cause(e->left, c);
  look_for_cause(e->right, c);
  for (int k = 0; k < e->argument_count; k++)
    look_for_cause(e->arguments[k].value, c);
  for (int k = 0; k < e->case_count; k++)
    look_for_cause(e->cases[k].value, c);
}

/* Where a unit of stress is missing in `e`, and a parameter in it is a large bare number, the
   parameter is named, once, and not what it makes wrong. */
static bool blame(checker *ck, const expr *e, dimension has, dimension needs) {
  const dimension stress = dimension_of("Pa");
  cause c = {NULL, false, 0};
  if (!dim_equal(dim_div(needs, has), stress)) return false;
  look_for_cause(e, &c);
  if (!c.parameter || c.said) return c.said;
  const symbol *s = &c.parameter->symbol;
  c.parameter->blamed = true;
  complain(ck, DIAG_UNITS, s->declared->value->where,
           "`%s` has no unit, and what is made of it lacks that of a stress", s->name);
  diag_hint(ck->d, "give the number its unit: `%s [Pa]`, and its bounds theirs",
            written(ck, s->declared->value, "..."));
  diag_note(ck->d, e->where, "it is missed here");
  return true;
}

/* What is not known yet, beside it, may be a tensor that need not be symmetric. */
static bool may_be_general(const checker *ck, value v) {
  return v.shape == SHAPE_TENSOR && ck->tree->law == LAW_STATE;
}

/* --- the forgotten time ----------------------------------------------------------------------- */

/* state v = 0
   rate v = stretch - v

   What begins at a bare 0 has the unit that its rate gives it: v is a time, and its uses are called
   wrong where the rate is. */

typedef bool is_meant(const symbol *s);

static bool is_told_by_rate(const symbol *s) {
  return s->kind == SYMBOL_STATE && entry_of(s)->infer && s->rule && s->rule->kind == STMT_RATE;
}

static bool is_thickness(const symbol *s) {
  return s->kind == SYMBOL_QUANTITY && s->index == QUANTITY_T;
}

/* The first name of that kind in `e`, or NULL. */
static const symbol *first_of(const expr *e, is_meant *meant, int *looks) {
  enum { MOST_LOOKS = 1000 };
  if (!e || ++*looks > MOST_LOOKS) return NULL;
  if (e->kind == EXPR_NAME && e->symbol && meant(e->symbol)) return e->symbol;
  const symbol *found = first_of(e->left, meant, looks);
  if (!found) found = first_of(e->right, meant, looks);
  for (int k = 0; !found && k < e->argument_count; k++)
    found = first_of(e->arguments[k].value, meant, looks);
  for (int k = 0; !found && k < e->case_count; k++)
    found = first_of(e->cases[k].value, meant, looks);
  return found;
}

void hint_rate(checker *ck, const expr *rate) {
  const expr *by = rate->kind == EXPR_BINARY && rate->binary == OP_DIV ? rate->right : NULL;
  const symbol *s = by && by->kind == EXPR_NAME ? by->symbol : NULL;
  if (s && s->kind == SYMBOL_PARAMETER)
    diag_hint(ck->d, "a rate is per second: divide by a time; `%s` is %s and lacks one", s->name,
              describe(ck, by->dim));
  else
    diag_hint(ck->d, "a rate is per second: divide by a time");
}

/* Where `e` has a time too much, and a state of that kind in it, its rate is named, once. */
static bool blame_rate(checker *ck, const expr *e, dimension has, dimension needs) {
  const dimension second = dimension_of("s");
  if (!dim_equal(dim_div(has, needs), second)) return false;
  const symbol *s = first_of(e, is_told_by_rate, &(int){0});
  if (!s || entry_of(s)->blamed) return s != NULL;
  const dimension told = entry_of(s)->type.dim;
  entry_of(s)->blamed = true;
  complain(ck, DIAG_UNITS, s->rule->value->where, "by its rate `%s` is %s, but it is used as %s",
           s->name, describe(ck, told), describe(ck, dim_div(told, second)));
  hint_rate(ck, s->rule->value);
  diag_note(ck->d, e->where, "it is used here");
  return true;
}

/* exp(-t/tau), where t is meant as the time. */
static bool hint_thickness(checker *ck, const expr *e, dimension has, dimension needs) {
  const dimension speed = dimension_of("m/s");
  if (!dim_equal(dim_div(has, needs), speed) && !dim_equal(dim_div(needs, has), speed))
    return false;
  if (!first_of(e, is_thickness, &(int){0})) return false;
  diag_hint(ck->d,
            "`t` is the thickness; the time that a step takes is `dt`, and a state may add it "
            "up: `age = previous(age) + dt`");
  return true;
}

value agree(checker *ck, span where, expr *a, value va, expr *b, value vb, const char *deed) {
  if (va.broken || vb.broken) return BROKEN;
  if (va.zero || va.unknown) {
    vb.unknown |= va.unknown && (vb.zero || may_be_general(ck, vb));
    vb.zero &= va.zero;
    return joined(ck, vb, va);
  }
  va.unknown |= vb.unknown && may_be_general(ck, va);
  if (vb.zero || vb.unknown) return joined(ck, va, vb);
  bool listed = where.begin == b->where.begin && where.end == b->where.end; /* a line of cases */
  const char *first = quoted(ck, a, listed ? "a value above" : "the left side");
  const char *second = quoted(ck, b, listed ? "this value" : "the right side");
  if (va.shape != vb.shape && shape_is_tensor(va.shape) && shape_is_tensor(vb.shape)) {
    va.shape = vb.shape = SHAPE_GENERAL;
    va.deviator = vb.deviator = false;
  }
  if (va.shape != vb.shape) {
    complain(ck, DIAG_SHAPE, where, "%s is %s but %s is %s, so they cannot be %s", first,
             shape_words(va.shape), second, shape_words(vb.shape), deed);
    if (!listed && shape_is_tensor(va.shape) + shape_is_tensor(vb.shape) == 1 &&
        (is_bare_number(a) || is_bare_number(b)))
      diag_hint(ck->d, "the unit tensor is `tensor(1, 1, 1, 0)`");
    hint_magnitude(ck, a, va, b, vb);
    return BROKEN;
  }
  if (va.shape != SHAPE_LOGICAL && !dim_equal(va.dim, vb.dim)) {
    if (blame(ck, a, va.dim, vb.dim) || blame(ck, b, vb.dim, va.dim) ||
        blame_rate(ck, a, va.dim, vb.dim) || blame_rate(ck, b, vb.dim, va.dim))
      return BROKEN;
    complain(ck, DIAG_UNITS, where, "%s is %s but %s is %s, so they cannot be %s", first,
             describe(ck, va.dim), second, describe(ck, vb.dim), deed);
    if (!hint_thickness(ck, a, va.dim, vb.dim) && !hint_thickness(ck, b, vb.dim, va.dim))
      hint_unit(ck, a, b, va, vb);
    return BROKEN;
  }
  va.deviator &= vb.deviator;
  return joined(ck, va, vb);
}

bool expect(checker *ck, expr *e, value v, dimension dim, shape s, const char *what) {
  if (v.broken) return false;
  if (v.zero || v.unknown) {
    e->dim = dim;
    e->shape = s;
    return true;
  }
  if (v.shape != s) {
    complain(ck, DIAG_SHAPE, e->where, "%s must be %s, but this is %s", what, shape_words(s),
             shape_words(v.shape));
    if (s == SHAPE_SCALAR && (v.shape == SHAPE_BENDING || v.shape == SHAPE_VECTOR))
      diag_hint(ck->d, "take its magnitude: `norm(...)`%s",
                v.shape == SHAPE_VECTOR ? ", a component, such as `v[x]`, or `dot(v, w)`" : "");
    if (s == SHAPE_TENSOR && v.shape == SHAPE_GENERAL)
      diag_hint(ck->d, "take its symmetric part: `sym(...)`");
    if (s == SHAPE_VECTOR && v.shape == SHAPE_SCALAR)
      diag_hint(ck->d, "give it its components, `(a, b, c)`, or a direction: `...*(1, 0, 0)`");
    return false;
  }
  if (dim_equal(v.dim, dim)) return true;
  if (blame(ck, e, v.dim, dim) || blame_rate(ck, e, v.dim, dim)) return false;
  complain(ck, DIAG_UNITS, e->where, "%s must be %s, but this is %s", what, describe(ck, dim),
           describe(ck, v.dim));
  if (is_bare_number(e))
    hint_unit(ck, e, e, (value){.dim = dim}, (value){.dim = dim});
  else
    hint_thickness(ck, e, v.dim, dim);
  return false;
}

bool expect_scalar(checker *ck, expr *e, value v, const char *what) {
  return expect(ck, e, v, v.dim, SHAPE_SCALAR, what);
}
