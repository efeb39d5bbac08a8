#include "dsl/semantics/law_check.h"

#include <string.h>

#include "dsl/semantics/calls.h"
#include "dsl/semantics/declarations.h"
#include "dsl/semantics/holes.h"
#include "dsl/semantics/increments.h"
#include "dsl/semantics/names.h"
#include "dsl/semantics/order.h"
#include "dsl/semantics/parameters.h"
#include "dsl/semantics/types.h"

/* --- fields ----------------------------------------------------------------------------------- */

static void check_field_place(checker *ck, const stmt *s, symbol *field) {
  span where = s->place == ON_NOTHING ? s->name_where : s->place_where;
  const char *kind = stmt_kind_name(s->kind);
  field->place = s->place;
  if (is_single(ck)) {
    field->place = natural_place(ck);
    if (s->place == ON_NOTHING || s->place == field->place) return;
    const char *name = placement_name(field->place);
    complain(ck, DIAG_PLACEMENT, where, "a %s law keeps its %s on %ss", law_word(ck), kind, name);
    diag_hint(ck->d, "write `on %s`; a state law may have it %s", name,
              "on particles and on neighbours");
  } else if (s->place < ON_PARTICLE) {
    field->place = ON_PARTICLE;
    complain(ck, DIAG_PLACEMENT, where, "where does the %s `%s` live?", kind, s->name);
    diag_hint(ck->d, "write `on particle`, `on bond` or `on neighbour` after its name");
  }
}

static void check_fields(checker *ck) {
  for (int i = 0; i < ck->law->fields.count; i++) {
    symbol *field = ck->law->fields.items[i];
    entry *e = entry_of(field);
    stmt *s = ck->statements[e->declared_at];
    check_field_place(ck, s, field);
    if (field->kind == SYMBOL_DAMAGE) {
      e->type = scalar_of(DIMENSIONLESS, field->place);
      e->known = true;
    } else {
      check_initial_value(ck, s);
    }
  }
}

/* A product or sum in which the bond's length is the only thing that differs from neighbour to
   neighbour. */
static bool is_made_of_length(const expr *e) {
  if (!e || e->place <= ON_PARTICLE) return false;
  if (e->kind == EXPR_NAME) return strcmp(e->name, "s") == 0;
  if (e->kind != EXPR_BINARY && e->kind != EXPR_UNARY) return false;
  const bool left = e->left && e->left->place > ON_PARTICLE;
  const bool right = e->kind == EXPR_BINARY && e->right && e->right->place > ON_PARTICLE;
  return (left || right) && (!left || is_made_of_length(e->left)) &&
         (!right || is_made_of_length(e->right));
}

/* In a state law the [j] on the left says whether there is one value or one for each neighbour. */
static bool check_family_rule(checker *ck, const stmt *s, value *v) {
  if (v->unknown && !is_single(ck) && v->place == ON_NOTHING) v->place = ON_PARTICLE;
  if (is_single(ck)) {
    if (!s->indexed) return true;
    complain(ck, DIAG_PLACEMENT, s->name_where, "a %s law has no neighbours to give `%s` to",
             law_word(ck), s->name);
    diag_hint(ck->d, "write `%s`; only a state law has a family", s->name);
    return false;
  }
  bool varies = v->place == ON_BOND || v->place == ON_NEIGHBOUR;
  if (varies && !s->indexed) {
    complain(ck, DIAG_PLACEMENT, s->name_where,
             "the rule of `%s` has one value for each neighbour, but `%s` has only one", s->name,
             s->name);
    if (is_made_of_length(s->value))
      diag_hint(ck->d,
                "`s` is the length of one bond: write `spacing` for that of the lattice, or put "
                "`s` inside the sum");
    else
      diag_hint(ck->d, "write `%s[j] = ...`, or take the sum, mean or max over the family",
                s->name);
    return false;
  }
  if (s->indexed && !varies) v->place = v->place == ON_PARTICLE ? ON_NEIGHBOUR : ON_BOND;
  return true;
}

/* Of a state, as its declaration says. */
static shape declared_shape(const stmt *declared) {
  return declared->tensor ? SHAPE_TENSOR : declared->vector ? SHAPE_VECTOR : SHAPE_SCALAR;
}

/* What begins at a number stays one. */
static bool refuse_components(checker *ck, const stmt *s, const entry *field, shape found) {
  const stmt *declared = field->symbol.declared;
  if (declared_shape(declared) != SHAPE_SCALAR) return false;
  complain(ck, DIAG_SHAPE, s->value->where, "the %s `%s` is one number, but this is %s",
           field->symbol.kind == SYMBOL_STATE ? "state" : "damage", s->name, shape_words(found));
  diag_note(ck->d, declared->name_where, "it is declared here");
  if (field->symbol.kind == SYMBOL_STATE)
    diag_hint(ck->d, "declare it `state %s on %s = %s 0`", s->name,
              placement_name(field->symbol.place), found == SHAPE_VECTOR ? LAW_VECTOR : "tensor");
  return true;
}

/* Where a tensor gets its trace from: the first part of it that is no deviator. */
static expr *traced_part(expr *e) {
  if (e->kind == EXPR_CASES)
    for (int k = 0; k < e->case_count; k++)
      if (!e->cases[k].value->deviator) return traced_part(e->cases[k].value);
  if (e->kind == EXPR_UNARY && e->left->shape == SHAPE_TENSOR) return traced_part(e->left);
  if (e->kind != EXPR_BINARY) return e;
  if (e->left->shape == SHAPE_TENSOR && !e->left->deviator) return traced_part(e->left);
  if (e->right->shape == SHAPE_TENSOR && !e->right->deviator) return traced_part(e->right);
  return e;
}

/* What is kept without its component zz needs a trace of 0. */
static bool refuse_trace(checker *ck, const stmt *s, const entry *field, value v) {
  if (!field->symbol.declared->deviator || v.deviator || v.zero || v.unknown) return false;
  expr *part = traced_part(s->value);
  const char *text = written(ck, part, NULL);
  complain(ck, DIAG_SHAPE, part->where, "the state `%s` is a deviator, but %s may have a trace",
           s->name, text ? quoted(ck, part, "") : "this");
  diag_note(ck->d, field->symbol.declared->name_where, "it is declared here");
  diag_hint(ck->d, "take `dev(%s)`, or declare the state `tensor 0`", text ? text : "...");
  return true;
}

static void check_field_rule(checker *ck, stmt *s, entry *field, value v) {
  const char *what = arena_printf(ck->memory, "the %s `%s`",
                                  field->symbol.kind == SYMBOL_STATE ? "state" : "damage", s->name);
  bool directed = field->symbol.place == ON_BOND || field->symbol.place == ON_NEIGHBOUR;
  if (v.broken) return;
  if (is_single(ck) || s->kind != STMT_DAMAGE) {
    if (!check_family_rule(ck, s, &v)) return;
    if (!is_single(ck) && s->indexed != directed) {
      complain(ck, DIAG_PLACEMENT, s->name_where, "%s lives on the %s", what,
               directed ? "bonds" : "particle");
      diag_hint(ck->d, directed ? "write `%s[j] = ...`" : "write `%s = ...`", s->name);
      return;
    }
  }
  if (!field->known) {
    if (v.unknown) return; /* perhaps in the next pass */
    value as = v;
    as.zero = false;
    if (declared_shape(field->symbol.declared) != SHAPE_SCALAR) /* another rule is refused */
      as.shape = declared_shape(field->symbol.declared);
    as.deviator = field->symbol.declared->deviator;
    as.place = field->symbol.place;
    field->type = as;
    field->known = true;
  }
  if (field->type.broken || field->type.unknown) return;
  if (v.shape == SHAPE_TENSOR && refuse_trace(ck, s, field, v)) return;
  if (s->kind == STMT_FLOW) return;
  const bool parts = shape_is_tensor(v.shape) || v.shape == SHAPE_VECTOR;
  if (parts && !v.zero && refuse_components(ck, s, field, v.shape)) return;
  if (s->kind == STMT_RATE) return;
  if (!expect(ck, s->value, v, field->type.dim, field->type.shape, what)) return;
}

/* --- statements ------------------------------------------------------------------------------- */

static void set_type(const stmt *s, value v) {
  if (!s->symbol) return;
  entry *e = entry_of(s->symbol);
  v.zero = v.whole = false; /* a name for a bare 0 is a pure number */
  if (v.place == ON_NOTHING) v.place = ON_BODY;
  e->type = v;
  e->known = true;
}

/* A pure number of a bond, a tensor of a point. */
static value check_rest(checker *ck, const stmt *s, value v) {
  const bool tensor = ck->tree->law == LAW_CONTINUUM;
  const shape wanted = tensor ? SHAPE_TENSOR : SHAPE_SCALAR;
  if (expect(ck, s->value, v, dimension_of("1"), wanted,
             tensor ? "the rest strain" : "the rest stretch")) {
    v.shape = wanted; /* 0 may be either */
    return v;
  }
  if (tensor && v.shape == SHAPE_SCALAR)
    diag_hint(ck->d, "what is alike in all directions is times `tensor(1, 1, 1, 0)`");
  return BROKEN;
}

static void check_definition(checker *ck, stmt *s) {
  entry *e = s->symbol ? entry_of(s->symbol) : NULL;
  if (s->rest_of && !e) return; /* it has been refused */
  bool field = e && (e->symbol.kind == SYMBOL_STATE || e->symbol.kind == SYMBOL_DAMAGE);
  value v = check_value(ck, s->value);
  if (s->rest_of && !v.broken && !v.unknown) v = check_rest(ck, s, v);
  if (field)
    check_field_rule(ck, s, e, v);
  else
    set_type(s, v.broken || check_family_rule(ck, s, &v) ? v : BROKEN);
}

static void check_constant(checker *ck, stmt *s) {
  ck->context = IN_CONSTANT;
  value v = check_value(ck, s->value);
  ck->context = IN_RULE;
  if (s->indexed && !v.broken && !check_family_rule(ck, s, &v)) v = BROKEN;
  set_type(s, v);
}

static void check_damage(checker *ck, stmt *s) {
  if (!s->value || !s->symbol) return;
  check_field_rule(ck, s, entry_of(s->symbol), check_value(ck, s->value));
}

static void check_function(checker *ck, stmt *s) {
  if (!s->symbol) return;
  entry *e = entry_of(s->symbol);
  for (int i = 0; i < s->word_count; i++)
    e->arguments[i].known = false;
  e->type = check_function_body(ck, e);
  e->known = true;
}

static const struct {
  const char *unit;
  shape shape;
} results[RESULT_COUNT] = {
    [RESULT_N] = {"N", SHAPE_SCALAR},      [RESULT_V] = {"N", SHAPE_BENDING},
    [RESULT_M_I] = {"N*m", SHAPE_BENDING}, [RESULT_M_J] = {"N*m", SHAPE_BENDING},
    [RESULT_T] = {"N*m", SHAPE_SCALAR},    [RESULT_W] = {"J", SHAPE_SCALAR},
    [RESULT_SIGMA] = {"Pa", SHAPE_TENSOR}, [RESULT_GROW] = {"1", SHAPE_LOGICAL},
    [RESULT_TOWARD] = {"1", SHAPE_SCALAR}, [RESULT_SPEED] = {"m/s", SHAPE_SCALAR}};

/* The energy of a continuum. */
static bool is_per_volume(const checker *ck) {
  return ck->tree->law == LAW_CONTINUUM;
}

static const char *unit_of_result(const checker *ck, int which) {
  return which == RESULT_W && is_per_volume(ck) ? "J/m^3" : results[which].unit;
}

static void check_result(checker *ck, stmt *s) {
  value v = check_number(ck, s->value);
  if (!v.broken && !check_family_rule(ck, s, &v)) v = BROKEN;
  int which = s->symbol && s->symbol->kind == SYMBOL_RESULT ? s->symbol->index : RESULT_COUNT;
  if (which < RESULT_COUNT) {
    const char *volume = which == RESULT_W && is_per_volume(ck) ? " (J/m^3)" : "";
    const char *what = arena_printf(ck->memory, "`%s`%s", stmt_words(ck->memory, s), volume);
    dimension dim = dimension_of(unit_of_result(ck, which));
    if (!expect(ck, s->value, v, dim, results[which].shape, what)) v = BROKEN;
    v.dim = dim;
    v.shape = results[which].shape;
    v.unknown = false;
  }
  set_type(s, v);
}

static void check_tip_result(checker *ck, stmt *s) {
  if (!s->symbol) return;
  if (s->kind != STMT_GROW) {
    check_result(ck, s);
    return;
  }
  value v = check_guard(ck, s->value);
  v.shape = SHAPE_LOGICAL;
  set_type(s, v);
}

static void check_force_state(checker *ck, stmt *s) {
  value v = check_number(ck, s->value);
  if (!v.broken && !s->indexed && !is_single(ck)) {
    complain(ck, DIAG_PLACEMENT, s->name_where, "a force state has one value for each neighbour");
    diag_hint(ck->d, "write `force state %s[j] = ...`", s->name);
    v = BROKEN;
  }
  if (!v.broken && !check_family_rule(ck, s, &v)) v = BROKEN;
  bool per_volumes = !v.broken && dim_equal(v.dim, dimension_of("N/m^6"));
  const char *what = "a force state in N (or N/m^6)";
  dimension dim = dimension_of(per_volumes ? "N/m^6" : "N");
  const bool vector = !v.broken && !v.zero && !v.unknown && v.shape == SHAPE_VECTOR;
  if (vector && s->along_reference) {
    complain(ck, DIAG_LAW_KIND, s->name_where,
             "a force state that is a vector has a direction of its own");
    diag_hint(ck->d, "leave out `along reference`");
    v = BROKEN;
  }
  if (!expect(ck, s->value, v, dim, vector ? SHAPE_VECTOR : SHAPE_SCALAR, what)) v = BROKEN;
  v.dim = dim;
  v.place = ON_NEIGHBOUR;
  set_type(s, v);
}

static void check_tensor(checker *ck, stmt *s) {
  if (s->symbol && s->symbol->kind == SYMBOL_RESULT) {
    check_result(ck, s);
    return;
  }
  value v = check_number(ck, s->value);
  dimension dim = s->kind == STMT_STRESS ? dimension_of("Pa") : DIMENSIONLESS;
  const char *what = s->kind == STMT_STRESS ? "a stress" : "a strain";
  if (!expect(ck, s->value, v, dim, SHAPE_TENSOR, what)) v = BROKEN;
  if (v.unknown)
    v = (value){.dim = dim, .shape = SHAPE_TENSOR, .place = is_single(ck) ? v.place : ON_PARTICLE};
  set_type(s, v.broken || check_family_rule(ck, s, &v) ? v : BROKEN);
}

static void check_yield(checker *ck, stmt *s) {
  value v = check_number(ck, s->value);
  if (!expect_scalar(ck, s->value, v, "a yield function")) v = BROKEN;
  set_type(s, v.broken || check_family_rule(ck, s, &v) ? v : BROKEN);
}

/* `by` adds the value itself; `along` gives a direction, whose size the yield function decides. */
static void check_flow(checker *ck, stmt *s) {
  value v = check_number(ck, s->value);
  if (s->when) check_guard(ck, s->when);
  entry *field = s->symbol ? entry_of(s->symbol) : NULL;
  if (!field || v.broken) return;
  check_field_rule(ck, s, field, v);
  if (s->returned || !field->known || field->type.broken || field->type.unknown) return;
  const char *what = arena_printf(ck->memory, "the flow of `%s`", s->name);
  expect(ck, s->value, v, field->type.dim, field->type.shape, what);
}

/* What a state becomes in time: of its unit per second. */
static void check_rate(checker *ck, stmt *s) {
  const dimension second = dimension_of("s");
  value v = check_number(ck, s->value), of_state = v;
  entry *field = s->symbol ? entry_of(s->symbol) : NULL;
  if (!field || v.broken) return;
  if (!v.zero) of_state.dim = dim_mul(v.dim, second);
  check_field_rule(ck, s, field, of_state);
  if (!field->known || field->type.broken || field->type.unknown) return;
  const char *what = arena_printf(ck->memory, "the rate of the state `%s`", s->name);
  const dimension wanted = dim_div(field->type.dim, second);
  if (!expect(ck, s->value, v, wanted, field->type.shape, what) && !v.zero &&
      v.shape == field->type.shape && dim_equal(v.dim, field->type.dim))
    hint_rate(ck, s->value);
}

static void check_output(checker *ck, stmt *s) {
  value v = check_number(ck, s->value);
  if (!v.broken && !is_single(ck) && !s->indexed && v.place > ON_PARTICLE) {
    set_type(s, v); /* results may hold values of bonds */
    return;
  }
  set_type(s, v.broken || check_family_rule(ck, s, &v) ? v : BROKEN);
}

static void check_statement(checker *ck, stmt *s) {
  ck->context = IN_RULE;
  if (s->symbol && entry_of(s->symbol)->refused) {
    check_family(ck, s->value); /* for the names in it */
    set_type(s, BROKEN);
    return;
  }
  switch (s->kind) {
  case STMT_PARAMETER:
    check_parameter(ck, s);
    break;
  case STMT_FIELD:
    check_field(ck, s);
    break;
  case STMT_CONSTANT:
    check_constant(ck, s);
    break;
  case STMT_DEFINITION:
    check_definition(ck, s);
    break;
  case STMT_DAMAGE:
    check_damage(ck, s);
    break;
  case STMT_FUNCTION:
    check_function(ck, s);
    break;
  case STMT_FORCE:
  case STMT_MOMENT:
  case STMT_ENERGY:
    check_result(ck, s);
    break;
  case STMT_GROW:
  case STMT_TOWARD:
  case STMT_SPEED:
    check_tip_result(ck, s);
    break;
  case STMT_FORCE_STATE:
    check_force_state(ck, s);
    break;
  case STMT_STRESS:
  case STMT_STRAIN:
    check_tensor(ck, s);
    break;
  case STMT_YIELD:
    check_yield(ck, s);
    break;
  case STMT_FLOW:
    check_flow(ck, s);
    break;
  case STMT_RATE:
    check_rate(ck, s);
    break;
  case STMT_OUTPUT:
    check_output(ck, s);
    break;
  case STMT_STATE:
  case STMT_OPTION:
  case STMT_NONCONSERVATIVE:
  case STMT_ACCEPT:
  case STMT_REQUIRE:
  case STMT_INCLUDE:
  case STMT_COUNT:
    break;
  }
}

static void forget_types(checker *ck) {
  for (int i = 0; i < ck->entry_count; i++) {
    entry *e = ck->entries[i];
    e->in_cycle = false;
    if (e->declared_at < 0 || e->infer) continue;
    e->known = false;
    e->type = (value){0};
  }
}

static void check_statements(checker *ck) {
  forget_types(ck);
  ck->expansions = 0;
  ck->too_deep = false;
  ck->now = ck->statement_count;
  check_fields(ck);
  for (int i = 0; i < ck->statement_count; i++) {
    ck->now = i;
    check_statement(ck, ck->statements[i]);
  }
  ck->now = ck->statement_count;
  check_bounds(ck);
}

/* --- units of states that start from a bare 0 ------------------------------------------------- */

static int count_open_states(const checker *ck) {
  int open = 0;
  for (int i = 0; i < ck->law->fields.count; i++)
    open += !entry_of(ck->law->fields.items[i])->known;
  return open;
}

/* Passes over the law without reporting, until every rule has told what its state is. */
static void infer_states(checker *ck) {
  diagnostics *reported = ck->d, silent;
  diag_begin(&silent, reported->sources);
  ck->d = &silent;
  int open = ck->law->fields.count + 1;
  for (long looked_at = 0; looked_at < MOST_INFERENCE; looked_at += ck->statement_count) {
    check_statements(ck);
    diag_clear(&silent);
    int still_open = count_open_states(ck);
    if (still_open == 0 || still_open == open) break;
    open = still_open;
  }
  ck->d = reported;
  ck->searches = 0;
  for (int i = 0; i < ck->law->parameters.count; i++)
    entry_of(ck->law->parameters.items[i])->blamed = false; /* in silence */
  for (int i = 0; i < ck->law->fields.count; i++) {
    entry *e = entry_of(ck->law->fields.items[i]);
    e->blamed = false;
    if (e->known) continue;
    e->type = scalar_of(DIMENSIONLESS, e->symbol.place);
    e->type.shape = declared_shape(e->symbol.declared);
    e->type.deviator = e->symbol.declared->deviator;
    e->type.unknown = ck->holes;
    e->known = true;
  }
}

static bool has_state(const checker *ck) {
  for (int i = 0; i < ck->law->fields.count; i++)
    if (ck->law->fields.items[i]->kind == SYMBOL_STATE) return true;
  return false;
}

/* --- what a law must give --------------------------------------------------------------------- */

static void check_rules_of_fields(checker *ck) {
  for (int i = 0; i < ck->law->fields.count; i++) {
    const symbol *s = ck->law->fields.items[i];
    if (s->rule) continue;
    const entry *e = entry_of(s);
    const char *index = e->symbol.place > ON_PARTICLE && !is_single(ck) ? "[j]" : "";
    complain(ck, DIAG_UNDEFINED, s->where, "the %s `%s` has no rule",
             s->kind == SYMBOL_STATE ? "state" : "damage", s->name);
    diag_hint(ck->d, "say what it becomes in each step: `%s%s = ...`", s->name, index);
  }
}

static void report_missing(checker *ck, const char *what, const char *name) {
  complain(ck, DIAG_LAW_KIND, ck->tree->law_where, "this law gives no %s", what);
  const entry *found = names_find(ck, SPACE_QUANTITIES, name);
  if (found && found->symbol.kind == SYMBOL_DEFINED) {
    diag_note(ck->d, found->symbol.where, "`%s` is only a name here", name);
    diag_hint(ck->d, "write `%s = ...`", what);
  } else {
    diag_hint(ck->d,
              ck->tree->law == LAW_STATE ? "write `force state F[j] = ...`"
                                         : "write `%s = ...`, or give the `energy W`",
              what);
  }
}

static void report_missing_of_tip(checker *ck, const char *line) {
  complain(ck, DIAG_LAW_KIND, ck->tree->law_where, "this law of cracks has no line `%.*s`",
           (int)strcspn(line, " "), line);
  diag_hint(ck->d, "say what the tip does, such as `%s`", line);
}

static void check_results_given(checker *ck) {
  const symbol *const *r = ck->law->results;
  if (r[RESULT_V] && (r[RESULT_M_I] || r[RESULT_M_J])) {
    const symbol *moment = r[RESULT_M_I] ? r[RESULT_M_I] : r[RESULT_M_J];
    complain(ck, DIAG_LAW_KIND, r[RESULT_V]->where, "a law gives either `force V` or moments");
    diag_note(ck->d, moment->where, "a moment is given here");
    diag_hint(ck->d, "with `force V` both moments are V*length/2; remove the one or the other");
  }
  if (ck->result_refused) return;
  if (ck->tree->law == LAW_CONTINUUM) {
    if (!r[RESULT_W] && !r[RESULT_SIGMA]) report_missing(ck, "stress sigma", "sigma");
    return;
  }
  if (ck->tree->law == LAW_CRACK) {
    if (!r[RESULT_GROW]) report_missing_of_tip(ck, "grow when K_I >= K_Ic");
    if (!r[RESULT_TOWARD]) report_missing_of_tip(ck, "toward theta");
    if (!r[RESULT_SPEED]) report_missing_of_tip(ck, "speed v_0");
    return;
  }
  const bool slip = ck->tree->law == LAW_SLIP_BOND;
  if (r[RESULT_W] && !(slip && (r[RESULT_N] || r[RESULT_V]))) return;
  if (!r[RESULT_N]) report_missing(ck, "force N", "N");
  if (slip && !r[RESULT_V]) report_missing(ck, "force V", "V");
  if (slip || ck->tree->law == LAW_CENTRAL_BOND || r[RESULT_V]) return;
  if (!r[RESULT_M_I]) report_missing(ck, "moment M_i", "M_i");
  if (!r[RESULT_M_J]) report_missing(ck, "moment M_j", "M_j");
}

static void check_force_state_given(checker *ck) {
  const stmt *first = NULL;
  for (int i = 0; i < ck->statement_count; i++) {
    const stmt *s = ck->statements[i];
    if (s->kind != STMT_FORCE_STATE) continue;
    if (first) {
      complain(ck, DIAG_DUPLICATE_NAME, s->name_where, "a law gives one force state");
      diag_note(ck->d, first->name_where, "the first one is here");
      return;
    }
    first = s;
  }
  if (!first && !ck->law->results[RESULT_W] && !ck->result_refused)
    report_missing(ck, "force state", "F");
}

/* --- options ---------------------------------------------------------------------------------- */

static void choose(checker *ck, const law_choice *wanted) {
  const symbol_list *options = &ck->law->options;
  for (int i = 0; i < options->count; i++) {
    const stmt *s = options->items[i]->declared;
    if (strcmp(s->name, wanted->option) != 0) continue;
    for (int k = 0; k < s->word_count; k++)
      if (strcmp(s->words[k], wanted->choice) == 0) {
        ck->law->chosen[i] = s->words[k];
        return;
      }
    complain(ck, DIAG_OPTION, s->name_where, "option `%s` has no choice `%s`", s->name,
             wanted->choice);
    diag_suggest(ck->d, wanted->choice, s->words, s->word_count);
    return;
  }
  complain(ck, DIAG_OPTION, ck->tree->name_where, "this law has no option `%s`", wanted->option);
}

static void check_choices(checker *ck, const law_choice *choices, int count) {
  const symbol_list *options = &ck->law->options;
  ck->law->chosen = arena_alloc(ck->memory, (size_t)options->count * sizeof(char *));
  for (int i = 0; i < options->count; i++) {
    const stmt *s = options->items[i]->declared;
    ck->law->chosen[i] = s->word_count ? s->words[0] : "";
  }
  for (int i = 0; i < count; i++)
    choose(ck, &choices[i]);
}

/* --- the whole -------------------------------------------------------------------------------- */

static bool is_rule(const stmt *s) {
  switch (s->kind) {
  case STMT_PARAMETER:
  case STMT_FIELD:
  case STMT_OPTION:
  case STMT_STATE:
  case STMT_FUNCTION:
  case STMT_NONCONSERVATIVE:
  case STMT_ACCEPT:
  case STMT_REQUIRE:
  case STMT_INCLUDE:
  case STMT_COUNT:
    return false;
  case STMT_DAMAGE:
    return s->value != NULL;
  default:
    return true;
  }
}

/* Every name stands above its use, so the order written is an order of evaluation. */
static void list_rules(checker *ck) {
  law *l = ck->law;
  l->rules = arena_alloc(ck->memory, (size_t)ck->statement_count * sizeof(stmt *));
  for (int constants = 1; constants >= 0; constants--)
    for (int i = 0; i < ck->statement_count; i++) {
      const stmt *s = ck->statements[i];
      if (is_rule(s) && (s->kind == STMT_CONSTANT) == (constants == 1))
        l->rules[l->rule_count++] = s;
    }
}

/* --- states that are tensors or vectors ------------------------------------------------------- */

/* What stores and shows states knows numbers only: a tensor's components are fields of their own,
   eps_p_xx and so on, a vector's slip_x and so on. The name itself keeps the index of the first. */
static symbol *component_of(checker *ck, const symbol *whole, int k) {
  symbol *s = arena_alloc(ck->memory, sizeof *s);
  *s = *whole;
  if (whole->shape == SHAPE_VECTOR)
    s->name = arena_printf(ck->memory, "%s_%c", whole->name, vector_axis(k));
  else
    s->name =
        arena_printf(ck->memory, "%s_%c%c", whole->name, tensor_axis(k, 0), tensor_axis(k, 1));
  s->shape = SHAPE_SCALAR;
  s->component_of = whole;
  s->component = k;
  const entry *other = names_find(ck, SPACE_QUANTITIES, s->name);
  if (!other) return s;
  complain(ck, DIAG_DUPLICATE_NAME, other->symbol.where,
           "`%s` is what the component of the state `%s` is called in results", s->name,
           whole->name);
  diag_note(ck->d, whole->where, "`%s` is declared here", whole->name);
  return s;
}

static int components_of(const symbol *s) {
  return s->shape == SHAPE_TENSOR   ? TENSOR_COMPONENT_COUNT
         : s->shape == SHAPE_VECTOR ? VECTOR_COMPONENT_COUNT
                                    : 1;
}

static int kept_components(const symbol *s) {
  return components_of(s) - s->deviator;
}

static void split_fields(checker *ck) {
  const symbol_list whole = ck->law->fields;
  int count = 0;
  for (int i = 0; i < whole.count; i++)
    count += kept_components(whole.items[i]);
  if (count == whole.count) return;
  symbol **items = arena_alloc(ck->memory, (size_t)count * sizeof *items);
  count = 0;
  for (int i = 0; i < whole.count; i++) {
    symbol *s = whole.items[i];
    s->index = count;
    const int parts = components_of(s);
    for (int k = 0; parts > 1 && k < parts; k++) {
      if (law_field_of(s, k) < 0) continue;
      items[count] = component_of(ck, s, k);
      items[count]->index = count;
      count++;
    }
    if (parts == 1) items[count++] = s;
  }
  ck->law->fields = (symbol_list){items, count};
}

/* --- rates ------------------------------------------------------------------------------------ */

/* A name that nothing of the law has. */
static const char *name_of_rate(checker *ck, const char *state) {
  const char *name = arena_printf(ck->memory, "%s_rate", state);
  while (names_find(ck, SPACE_QUANTITIES, name))
    name = arena_printf(ck->memory, "%s_", name);
  return name;
}

static symbol *rate_of(checker *ck, const symbol *state) {
  symbol *s = arena_alloc(ck->memory, sizeof *s);
  *s = *state;
  s->name = name_of_rate(ck, state->name);
  s->dim = dim_div(state->dim, dimension_of("s"));
  s->doc = arena_printf(ck->memory, "rate of %s at the end of the step", state->name);
  s->initial = 0;
  s->rate_of = state;
  return s;
}

/* Beside each state that has a rate a field behind all others keeps how quickly it changed when the
   step began. */
static void keep_rates(checker *ck) {
  const symbol_list states = ck->law->fields;
  symbol **items = arena_alloc(ck->memory, 2 * (size_t)states.count * sizeof *items);
  int count = states.count;
  for (int i = 0; i < states.count; i++) {
    symbol *s = items[i] = states.items[i];
    if (!s->rule || s->rule->kind != STMT_RATE) continue;
    items[count] = rate_of(ck, s);
    items[count]->index = count;
    count++;
  }
  if (count > states.count) ck->law->fields = (symbol_list){items, count};
}

static void list_statements(checker *ck) {
  for (stmt *s = ck->tree->first; s; s = s->next)
    ck->statement_count++;
  ck->statements = arena_alloc(ck->memory, (size_t)ck->statement_count * sizeof(stmt *));
  int i = 0;
  for (stmt *s = ck->tree->first; s; s = s->next) {
    s->symbol = NULL;
    ck->statements[i++] = s;
  }
}

static void publish_types(checker *ck) {
  for (int i = 0; i < ck->entry_count; i++) {
    entry *e = ck->entries[i];
    if (e->declared_at < 0 || !e->known) continue;
    e->symbol.dim = e->type.dim;
    e->symbol.shape = e->type.shape;
    e->symbol.place = e->type.place;
    e->symbol.deviator = e->symbol.kind == SYMBOL_STATE && e->type.deviator;
  }
  for (int i = 0; i < RESULT_COUNT; i++) {
    if (!ck->law->results[i]) continue;
    entry *e = entry_of(ck->law->results[i]);
    e->symbol.dim = e->type.dim;
    e->symbol.shape = e->type.shape;
    e->symbol.place = e->type.place;
  }
}

static void check_anisotropic(checker *ck) {
  const tree *t = ck->tree;
  if (!t->anisotropic || t->law != LAW_SLIP_BOND) return;
  complain(ck, DIAG_LAW_KIND, t->anisotropic_where,
           "`anisotropic` is said of bodies and of cracks in them, not of a bar's bonds");
  diag_hint(ck->d, "leave it away");
}

static void check_all(checker *ck, const law_choice *choices, int choice_count) {
  declare_names(ck);
  ck->now = ck->statement_count;
  check_choices(ck, choices, choice_count);
  if (has_state(ck)) infer_states(ck);
  check_statements(ck);
  check_anisotropic(ck);
  check_rules_of_fields(ck);
  if (is_single(ck))
    check_results_given(ck);
  else
    check_force_state_given(ck);
  report_holes(ck);
  publish_types(ck);
}

law *law_check(arena *memory, tree *t, const source_set *sources, const law_choice *choices,
               int choice_count, diagnostics *d) {
  int errors = d->errors;
  law *l = arena_alloc(memory, sizeof(law));
  *l = (law){.tree = t, .memory = memory, .sources = sources};
  l->setting = law_first_setting(l);
  checker ck = {.memory = memory, .tree = t, .sources = sources, .d = d, .law = l};
  list_statements(&ck);
  names_begin(&ck);
  check_all(&ck, choices, choice_count);
  if (d->errors == errors) {
    mark_used(&ck);
    report_unused(&ck);
    report_increments(&ck);
    mark_going_on(&ck);
    list_rules(&ck);
    split_fields(&ck);
    keep_rates(&ck);
  }
  names_end(&ck);
  return d->errors == errors ? l : NULL;
}
