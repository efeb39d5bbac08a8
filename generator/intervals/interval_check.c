#include "generator/intervals/interval_check.h"

#include <math.h>
#include <stdlib.h>

#include "dsl/base/arena.h"
#include "dsl/base/elementary.h"
#include "generator/intervals/interval_ranges.h"
#include "generator/intervals/interval_warning.h"
#include "generator/lower/lower_inputs.h"

enum { MOST_CONTEXTS = 600 };
static const long MOST_MEMORY = 20000000; /* numbers, in all contexts */

/* --- bounds of parameters --------------------------------------------------------------------- */

/* False when a bound cannot be compiled (said). */
static bool find_bounds(analysis *a) {
  const law *l = a->law;
  size_t bytes = ((size_t)l->parameters.count + 1) * sizeof(ir_node);
  a->lower = arena_alloc(a->memory, bytes);
  a->upper = arena_alloc(a->memory, bytes);
  for (int k = 0; k < l->parameters.count; k++) {
    const bounds *in = &l->parameters.items[k]->declared->in;
    a->lower[k] = lower_bound(a->graph, l, in->given ? in->lower : NULL, -INFINITY, a->said);
    a->upper[k] = lower_bound(a->graph, l, in->given ? in->upper : NULL, INFINITY, a->said);
    if (a->lower[k] == IR_NONE || a->upper[k] == IR_NONE) return false;
    lower_parameter(a->graph, l, k);
  }
  return true;
}

/* Bounds that are made of other parameters. */
static void relate_parameters(analysis *a, context *c) {
  const law *l = a->law;
  for (int k = 0; k < l->parameters.count; k++) {
    const bounds *in = &l->parameters.items[k]->declared->in;
    ir_node p = lower_parameter(a->graph, l, k);
    if (ir_operation(a->graph, a->lower[k]) != IR_CONSTANT)
      context_relate(a, c, in->lower_open ? POSITIVE : NOT_NEGATIVE, a->lower[k], p);
    if (ir_operation(a->graph, a->upper[k]) != IR_CONSTANT)
      context_relate(a, c, in->upper_open ? POSITIVE : NOT_NEGATIVE, p, a->upper[k]);
  }
}

static context *whole_law(analysis *a) {
  context *c = context_new(a, NULL, IR_NONE, false);
  relate_parameters(a, c);
  return c;
}

/* --- states ----------------------------------------------------------------------------------- */

/* A state that has a rate stays above its initial value where it does not fall from there. */
static range range_of_rate(analysis *a, int k) {
  const range kept = a->fields[k];
  const double initial = a->law->fields.items[k]->initial;
  a->fields[k] = range_of(initial);
  const range rate = interval_value(a, whole_law(a), a->bench->law_step.text.rules[k]);
  a->fields[k] = kept;
  const bool falls = !range_is_nonnegative(rate), rises = !range_is_nonnegative(range_neg(rate));
  return range_between(falls ? -INFINITY : initial, rises ? INFINITY : initial, falls, rises);
}

/* Takes back what the rules do not keep up when all fields are as supposed. False when nothing is
 * left to take back. */
static bool take_back(analysis *a) {
  arena *memory = a->memory;
  bool changed = false;
  a->memory = arena_new();
  a->contexts = 0;
  context *whole = whole_law(a);
  for (int k = 0; k < a->law->fields.count; k++) {
    if (a->law->fields.items[k]->kind == SYMBOL_DAMAGE) continue;
    const bool in_time = law_rate_field(a->law, k) >= 0;
    range r =
        in_time ? range_of_rate(a, k) : interval_value(a, whole, a->bench->law_step.fields[k]);
    range *f = &a->fields[k];
    if (f->low > r.low) changed = true, f->low = -INFINITY, f->low_open = true;
    if (f->high < r.high) changed = true, f->high = INFINITY, f->high_open = true;
  }
  arena_free(a->memory);
  a->memory = memory;
  a->contexts = 0;
  return changed;
}

/* A state may never fall below its initial value, or never rise above it: supposed of all, until
   the rules keep up what is left. A damage is kept from 0 to 1. */
static void learn_fields(analysis *a) {
  const symbol_list *fields = &a->law->fields;
  a->fields = arena_alloc(a->memory, ((size_t)fields->count + 1) * sizeof *a->fields);
  for (int k = 0; k < fields->count; k++)
    a->fields[k] = fields->items[k]->kind == SYMBOL_DAMAGE ? range_between(0, 1, false, false)
                                                           : range_of(fields->items[k]->initial);
  a->quiet = true;
  for (bool changed = fields->count > 0; changed;)
    changed = take_back(a);
  a->quiet = false;
  a->combinations = 0;
}

/* --- the law ---------------------------------------------------------------------------------- */

static void look_at(analysis *a, context *c, ir_node n) {
  if (n != IR_NONE) interval_value(a, c, n);
}

/* How far the rules of the damages stay above 0 and below 1: [2*fields], IR_NONE for states. */
static ir_node *damage_margins(analysis *a) {
  const double rounding = 1e-9;
  ir *g = a->graph;
  int count = a->law->fields.count;
  ir_node *margins = arena_alloc(a->memory, (2 * (size_t)count + 1) * sizeof *margins);
  for (int k = 0; k < count; k++) {
    bool damage = a->law->fields.items[k]->kind == SYMBOL_DAMAGE;
    ir_node rule = a->bench->law_step.text.rules[k];
    margins[2 * k] = damage ? ir_add(g, rule, ir_constant(g, rounding)) : IR_NONE;
    margins[2 * k + 1] = damage ? ir_sub(g, ir_constant(g, 1 + rounding), rule) : IR_NONE;
  }
  return margins;
}

/* Only what a state shows is said: ranges alone are too wide for a curve of softening. */
static void check_damages(analysis *a, context *c, const ir_node *margins) {
  for (int k = 0; k < 2 * a->law->fields.count; k++) {
    const symbol *s = a->law->fields.items[k / 2];
    if (margins[k] == IR_NONE || interval_value(a, c, margins[k]).low >= 0 ||
        interval_said_before(a, DIAG_DAMAGE_RANGE, s->rule->where))
      continue;
    char *state = interval_witness(a->bench, a->fields, margins[k], WISH_NEGATIVE, NULL, 0);
    if (!state) continue;
    diag_report(
        a->said, DIAG_DAMAGE_RANGE, s->rule->where,
        "the rule of damage `%s` gives %s in a state within the bounds; it is cut off there",
        s->name, k % 2 ? "more than 1" : "less than 0");
    diag_note(a->said, (span){0, 0, UINT16_MAX}, "found at %s", state);
    diag_hint(a->said, "narrow the bounds of a parameter, or keep such values away by `max`");
    free(state);
  }
}

/* What the compiler computes to solve rates, not the text: it keeps away from zeros by itself. */
static void mark_solved(analysis *a) {
  const lowered_law *s = &a->bench->law_step;
  const law *l = a->law;
  unsigned char *written = arena_alloc(a->memory, (size_t)a->nodes);
  a->solved = arena_alloc(a->memory, (size_t)a->nodes);
  for (int k = 0; k < l->fields.count; k++) {
    if (law_rate_field(l, k) < 0) continue;
    ir_mark(a->graph, &s->fields[k], 1, a->solved);
    ir_mark(a->graph, &s->fields[law_rate_field(l, k)], 1, a->solved);
    ir_mark(a->graph, &s->text.rules[k], 1, written);
  }
  for (int k = 0; k < s->text.place_count; k++)
    written[s->text.places[k].node] = 1;
  for (int n = 0; n < a->nodes; n++)
    a->solved[n] = a->solved[n] && !written[n];
}

static void look_at_law(analysis *a) {
  const bench *b = a->bench;
  const law *l = a->law;
  const ir_node *margins = damage_margins(a);
  a->nodes = ir_count(b->graph);
  mark_solved(a);
  a->most_contexts = (int)pl_fmin(MOST_CONTEXTS, (double)(1 + MOST_MEMORY / (4 * (long)a->nodes)));
  a->tried = arena_alloc(a->memory, (size_t)a->nodes);
  learn_fields(a);
  context *whole = whole_law(a);
  const lowered_law *s = &b->law_step;
  for (int k = 0; k < l->fields.count; k++)
    if (!l->fields.items[k]->rate_of) /* the rule of the state, at another value of it */
      look_at(a, whole, law_rate_field(l, k) >= 0 ? s->text.rules[k] : s->fields[k]);
  const ir_node results[] = {s->rest, s->N, s->M_i[0], s->M_j[0], s->T, s->W};
  for (size_t k = 0; k < sizeof results / sizeof *results; k++)
    look_at(a, whole, results[k]);
  for (int k = 0; k < l->outputs.count; k++)
    look_at(a, whole, s->outputs[k]);
  check_damages(a, whole, margins);
}

void interval_check(const law *l, diagnostics *d) {
  static const physics_options usual = {0};
  const int before = d->count;
  bench b;
  const law_kind kind = l->tree->law;
  if (kind == LAW_STATE || kind == LAW_CONTINUUM || kind == LAW_CRACK) return;
  if (!bench_open(&b, l, &usual, d)) return;
  analysis a = {.bench = &b, .graph = b.graph, .law = l, .said = d, .memory = arena_new()};
  if (find_bounds(&a)) look_at_law(&a);
  arena_free(a.memory);
  bench_close(&b);
  law_waive(l, d, before);
}
