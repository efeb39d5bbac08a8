#include "dsl/semantics/parameters.h"

#include <math.h>
#include <string.h>

#include "dsl/semantics/law_limits.h"
#include "dsl/semantics/literals.h"
#include "dsl/semantics/types.h"

static value check_plain(checker *ck, expr *e, context where) {
  context before = ck->context;
  const bool holes = ck->holes;
  ck->context = where;
  ck->holes = false;
  value v = check_number(ck, e);
  v.unknown |= ck->holes;
  ck->context = before;
  ck->holes |= holes;
  if (v.broken || v.unknown || (where == IN_BOUNDS ? law_is_bound(e) : law_is_plain(e))) return v;
  complain(ck, DIAG_BAD_NUMBER, e->where,
           "a value given here is made of numbers, + - * / ** and plain functions");
  if (where == IN_BOUNDS && e->kind == EXPR_CASES)
    diag_hint(ck->d, "cases of a bound are decided by options and by the lattice, such as "
                     "`| 1/4 when plane_strain | 1/3 otherwise`");
  return BROKEN;
}

/* Of the parameters above, which are known by now; NAN of those without. */
static double *defaults_so_far(checker *ck) {
  const symbol_list *list = &ck->law->parameters;
  double *defaults = arena_alloc(ck->memory, ((size_t)list->count + 1) * sizeof(double));
  for (int i = 0; i < list->count; i++)
    defaults[i] = list->items[i]->has_default ? list->items[i]->initial : NAN;
  return defaults;
}

/* The first parameter that a default reads and that has none itself, or NULL. */
static const symbol *without_default(const expr *e) {
  const symbol *found = NULL;
  if (!e) return NULL;
  if (e->kind == EXPR_NAME && e->symbol && e->symbol->kind == SYMBOL_PARAMETER &&
      !e->symbol->has_default)
    return e->symbol;
  if (!found) found = without_default(e->left);
  if (!found) found = without_default(e->right);
  for (int i = 0; i < e->argument_count && !found; i++)
    found = without_default(e->arguments[i].value);
  return found;
}

static bool read_finite(checker *ck, const expr *e, double *number) {
  *number = law_constant_value(e, defaults_so_far(ck));
  if (isfinite(*number)) return true;
  const symbol *missing = without_default(e);
  if (missing) {
    complain(ck, DIAG_BAD_NUMBER, e->where, "this default reads `%s`, which has none",
             missing->name);
    diag_note(ck->d, missing->where, "`%s` is declared here", missing->name);
    diag_hint(ck->d, "give `%s` a default, too: the deck may set either", missing->name);
    return false;
  }
  complain(ck, DIAG_BAD_NUMBER, e->where, "this is not a finite number");
  return false;
}

/* --- parameters and states -------------------------------------------------------------------- */

static void check_density(checker *ck, const stmt *s, dimension dim) {
  dimension density = dimension_of("kg/m^3");
  if (strcmp(s->name, "rho") != 0 || dim_equal(dim, density)) return;
  complain(ck, DIAG_UNITS, s->value ? s->value->where : s->name_where,
           "`rho` is the mass density the lattice reads, but this is %s", describe(ck, dim));
  diag_hint(ck->d, "give it a unit such as `2323 [kg/m^3]`, or choose another name");
}

/* The default of a component of a vector that is called `p`. */
static bool check_component(checker *ck, const symbol *p, value whole) {
  entry *e = entry_of(p);
  expr *part = p->declared->value;
  e->type = scalar_of(whole.dim, ON_BODY);
  e->known = true;
  if (p->component < p->component_of->declared->value->argument_count) {
    const value v = check_plain(ck, part, IN_DEFAULT);
    if (v.broken || (!v.unknown && !read_finite(ck, part, &e->symbol.initial))) return false;
    e->symbol.has_default = !v.unknown;
  } else {
    e->symbol.has_default = true;
  }
  return true;
}

/* (1, 0, 0): each component is a number. */
static void check_vector(checker *ck, const stmt *s) {
  entry *e = entry_of(s->symbol);
  const context before = ck->context;
  ck->context = IN_DEFAULT;
  value v = check_number(ck, s->value);
  ck->context = before;
  v.zero = false;
  v.place = ON_BODY;
  if (!v.broken && s->in.given) {
    complain(ck, DIAG_BOUNDS, s->in.where, "`%s` is a vector, and has no bounds", s->name);
    diag_hint(ck->d, "leave them away; what a law needs is its direction alone: `%s/norm(%s)`",
              s->name, s->name);
    v = BROKEN;
  }
  for (int k = 0; k < VECTOR_COMPONENT_COUNT && !v.broken; k++)
    if (!check_component(ck, ck->law->parameters.items[e->symbol.index + k], v)) v = BROKEN;
  e->type = v;
  e->known = true;
}

void check_parameter(checker *ck, stmt *s) {
  if (!s->symbol) return;
  if (expr_is_vector(s->value)) {
    check_vector(ck, s);
    return;
  }
  entry *e = entry_of(s->symbol);
  value v = scalar_of(DIMENSIONLESS, ON_BODY);
  unit u;
  if (s->value) {
    v = check_plain(ck, s->value, s->kind == STMT_FIELD ? IN_DEFAULT : IN_FORMULA);
    if (!v.broken && v.shape != SHAPE_SCALAR) v = BROKEN;
    e->symbol.follows = !v.broken && !v.unknown && law_reads_parameter(s->value, NULL);
    if (!v.broken && !v.unknown && !read_finite(ck, s->value, &e->symbol.initial)) v = BROKEN;
    e->symbol.has_default = !v.broken && !v.unknown;
  } else if (s->unit_text) {
    if (read_unit(ck, s->unit_text, s->unit_where, &u))
      v.dim = u.dim;
    else
      v = BROKEN;
  }
  v.zero = false;
  v.place = ON_BODY;
  e->type = v;
  e->known = true;
  if (!v.broken && !v.unknown) check_density(ck, s, v.dim);
}

/* --- fields in place and time ----------------------------------------------------------------- */

/* Where a field is given; a bond reads the mean of its ends, so that it lives on the bond there. */
static placement field_place(checker *ck, const stmt *s) {
  const placement given = ck->tree->law == LAW_CONTINUUM ? ON_POINT : ON_PARTICLE;
  const placement read = ck->tree->law == LAW_CONTINUUM ? ON_POINT
                         : ck->tree->law == LAW_STATE   ? ON_PARTICLE
                                                        : ON_BOND;
  if (s->place == ON_NOTHING || s->place == given) return read;
  complain(ck, DIAG_PLACEMENT, s->place_where, "a %s law is given its fields on %ss", law_word(ck),
           placement_name(given));
  diag_hint(ck->d, "write `on %s`%s", placement_name(given),
            read == ON_BOND ? "; a bond reads the mean of its two ends" : "");
  return read;
}

/* The unit behind the name says what the default must be. */
static void check_field_unit(checker *ck, const stmt *s, value *v) {
  unit u;
  if (!s->unit_text) return;
  if (!read_unit(ck, s->unit_text, s->unit_where, &u)) {
    *v = BROKEN;
  } else if (!v->broken && !v->unknown && !dim_equal(u.dim, v->dim)) {
    complain(ck, DIAG_UNITS, s->value->where, "the field `%s` is %s, but its default is %s",
             s->name, describe(ck, u.dim), describe(ck, v->dim));
    diag_note(ck->d, s->unit_where, "its unit is given here");
    *v = BROKEN;
  }
}

/* The masses of particles do not change. */
static bool refuse_field(checker *ck, const stmt *s) {
  if (ck->tree->law == LAW_CRACK) {
    complain(ck, DIAG_LAW_KIND, s->name_where, "what the tip of a crack does reads no fields");
    diag_hint(ck->d, "make it a parameter");
    return true;
  }
  if (strcmp(s->name, "rho") != 0) return false;
  complain(ck, DIAG_LAW_KIND, s->name_where,
           "`rho` is the mass density of the particles, which does not change in time");
  diag_hint(ck->d, "make it a parameter: a deck may give that by place, too");
  return true;
}

void check_field(checker *ck, stmt *s) {
  if (!s->symbol) return;
  entry *e = entry_of(s->symbol);
  check_parameter(ck, s);
  if (s->value) check_field_unit(ck, s, &e->type);
  const bool refused = refuse_field(ck, s);
  if (refused) e->type = BROKEN;
  e->type.place = e->symbol.place = refused ? ON_BODY : field_place(ck, s);
}

/* A bare 0 leaves unit and shape to the rule. */
void check_initial_value(checker *ck, stmt *s) {
  if (!s->symbol) return;
  entry *e = entry_of(s->symbol);
  value v = {.zero = true};
  if (s->value) v = check_plain(ck, s->value, IN_DEFAULT);
  if (!v.broken && !v.unknown && s->value && !read_finite(ck, s->value, &e->symbol.initial))
    v = BROKEN;
  if (!v.broken && (s->tensor || s->vector)) v.shape = s->vector ? SHAPE_VECTOR : SHAPE_TENSOR;
  v.deviator = s->deviator;
  if (v.zero || v.unknown) {
    e->infer = true; /* in every pass: what one has found stays until its rule says it again */
    return;
  }
  v.place = e->symbol.place;
  e->type = v;
  e->known = true;
}

/* --- bounds ----------------------------------------------------------------------------------- */

/* The unit the default is written in; the SI unit where it is not a single number. */
static double own_unit(const symbol *p, char *text, size_t size) {
  const expr *e = p->declared->value;
  const char *own = e && e->kind == EXPR_NUMBER ? e->unit_text : p->declared->unit_text;
  unit u;
  const char *bad;
  size_t length;
  if (own && unit_parse(own, strlen(own), &u, &bad, &length)) {
    snprintf(text, size, "%s", own);
    return u.factor;
  }
  dim_unit(entry_of(p)->type.dim, text, size);
  return 1;
}

static bool check_limit(checker *ck, expr *limit, const char *name, dimension dim,
                        const char *own) {
  if (!limit) return true;
  value v = check_plain(ck, limit, IN_BOUNDS);
  if (v.broken) return false;
  const char *what = arena_printf(ck->memory, "a bound of `%s`", name);
  if (expect(ck, limit, v, dim, SHAPE_SCALAR, what)) return true;
  if (limit->kind == EXPR_NUMBER && !limit->unit_text)
    diag_hint(ck->d, "give the number its unit: `%g [%s]`", limit->number, own);
  return false;
}

static void check_default_in_bounds(checker *ck, const symbol *p, const double *defaults) {
  const stmt *s = p->declared;
  law_limits in = law_parameter_limits(ck->law, p->index, defaults);
  if (isnan(in.lower) || isnan(in.upper)) return; /* of a parameter without a default */
  char text[80], unit_name[64];
  double factor = own_unit(p, unit_name, sizeof(unit_name));
  limits_text(limits_in(in, factor), text, sizeof(text));
  if (in.lower > in.upper || (in.lower == in.upper && (in.lower_open || in.upper_open))) {
    complain(ck, DIAG_BOUNDS, s->in.where, "no value lies in %s", text);
    if (in.lower > in.upper) diag_hint(ck->d, "the lower bound comes first");
  } else if (p->has_default && !limits_hold(in, p->initial)) {
    bool plain = strcmp(unit_name, "1") == 0;
    complain(ck, DIAG_BOUNDS, s->value->where, "the default of `%s` is not in %s%s%s", p->name,
             text, plain ? "" : " ", plain ? "" : unit_name);
    diag_note(ck->d, s->in.where, "its bounds are given here");
  }
}

static void check_sizes(checker *ck) {
  const stmt *s = ck->law->sized;
  if (!s) return;
  const dimension dim = dimension_of("m");
  check_limit(ck, s->in.lower, s->name, dim, "mm");
  check_limit(ck, s->in.upper, s->name, dim, "mm");
}

void check_bounds(checker *ck) {
  const symbol_list *parameters = &ck->law->parameters;
  const double *defaults = defaults_so_far(ck);
  for (int i = 0; i < parameters->count; i++) {
    const symbol *p = parameters->items[i];
    const bounds *in = &p->declared->in;
    if (!in->given || p->component_of || entry_of(p)->type.broken || entry_of(p)->type.unknown)
      continue;
    const dimension dim = entry_of(p)->type.dim;
    char text[64];
    own_unit(p, text, sizeof(text));
    bool lower = check_limit(ck, in->lower, p->name, dim, text),
         upper = check_limit(ck, in->upper, p->name, dim, text);
    if (lower && upper) check_default_in_bounds(ck, p, defaults);
  }
  check_sizes(ck);
}
