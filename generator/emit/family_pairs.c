#include "generator/emit/family_pairs.h"

#include <stdlib.h>

#include "generator/emit/family_loops.h"
#include "generator/emit/family_segment.h"
#include "generator/plan/program_facts.h"
#include "generator/target/choices.h"

/* What the segment computes for its roots (segment_nodes), and which of that the first loop keeps
   for the second. */
typedef struct pair_loops {
  const segment *of;
  ir_node *node; /* [count] */
  int count;
  ir_node *factor;  /* [root_count] of these, what is read again for the root's sum; or IR_NONE */
  int *kept;        /* [root_count] where the value is kept; -1: of constant sums */
  int *kept_far;    /* [root_count] and that at the far end; -1: none of its own */
  ir_node *to_keep; /* [kept_count] */
  int kept_count;
  int constants;   /* roots that are constant sums */
  bool finds_out;  /* where bonds are as expected, for later passes */
  bool knows;      /* that from an earlier pass */
  bool one;        /* one loop does both: it need not be done again */
  bool constant_0; /* this loop is for where marked fields are 0 and nothing is protected */
} pair_loops;

static bool is_field(const segment_root *r) {
  return r->target == TO_FIELD;
}

static bool is_constant(const emitter *e, const segment_root *r) {
  return segment_is_constant(e->graph, r);
}

void family_pairs_functions(emitter *e) {
  for (int f = 0; f < e->plan->law->fields.count; f++)
    if (program_pairs_field(&e->plan->programs[PROGRAM_STEP], f)) {
      say(e, SAY_FIELD_FUNCTIONS, numeral(e, FAMILY_CHUNK));
      return;
    }
}

/* --- marks of where fields are 0 -------------------------------------------------------------- */

/* "old" or "new" where marks tell where the field is 0; else NULL. */
static const char *marked_field(const emitter *e, ir_node n) {
  if (ir_operation(e->graph, n) != IR_INPUT) return NULL;
  const ir_source from = ir_input_source(e->graph, n);
  if (from != IR_FROM_FIELD && from != IR_FROM_NEW_FIELD) return NULL;
  if (!program_pairs_field(&e->plan->programs[PROGRAM_STEP], ir_input_index(e->graph, n)))
    return NULL;
  return from == IR_FROM_FIELD ? "old" : "new";
}

static const char *input(emitter *e, ir_node n) {
  const pair_loops *l = e->form;
  if (l->constant_0 && (marked_field(e, n) || family_is_protection(e, n))) return "0.0";
  return family_loops_input(e, n);
}

static const scope in_pairs = {.before = "      ",
                               .indent = "        ",
                               .uniform = SAY_UNIFORM_OF_NEIGHBOUR,
                               .declare = family_loops_declare,
                               .input = input};

static bool writes_field(const segment *a, int field) {
  for (int k = 0; k < a->root_count; k++)
    if (is_field(&a->roots[k]) && a->roots[k].index == field) return true;
  return false;
}

static bool writes_fields(const segment *a) {
  for (int k = 0; k < a->root_count; k++)
    if (is_field(&a->roots[k])) return true;
  return false;
}

/* Whether the segment reads the old, or the new, values of the field. */
static bool reads_marked(const emitter *e, int field, bool new) {
  for (ir_node n = 0; n < e->node_count; n++) {
    const char *which = e->needed[n] ? marked_field(e, n) : NULL;
    if (which && ir_input_index(e->graph, n) == field && (*which == 'n') == new) return true;
  }
  return false;
}

static void write_marks(emitter *e, const segment *a) {
  for (int f = 0; f < e->plan->law->fields.count; f++) {
    if (writes_field(a, f) || reads_marked(e, f, false))
      say(e, SAY_FILLED_MARKS, "old", numeral(e, f));
    if (reads_marked(e, f, true)) say(e, SAY_FILLED_MARKS, "new", numeral(e, f));
  }
  for (int k = 0; k < a->root_count; k++)
    if (is_field(&a->roots[k]))
      say(e, SAY_SETTLED_MARKS, numeral(e, k), numeral(e, a->roots[k].index));
}

/* --- two loops -------------------------------------------------------------------------------- */

static int keep(pair_loops *l, ir_node n) {
  int k = 0;
  while (k < l->kept_count && l->to_keep[k] != n)
    k++;
  if (k == l->kept_count) l->to_keep[l->kept_count++] = n;
  return k;
}

static pair_loops loops_of(const emitter *e, const segment *a) {
  const size_t size = 2 * (size_t)a->root_count + 1;
  pair_loops l = {.of = a,
                  .node = must_alloc(size * sizeof *l.node),
                  .factor = must_alloc(size * sizeof *l.factor),
                  .kept = must_alloc(size * sizeof *l.kept),
                  .kept_far = must_alloc(size * sizeof *l.kept_far),
                  .to_keep = must_alloc(size * sizeof *l.to_keep)};
  l.finds_out = program_asks(e->graph, &e->plan->programs[PROGRAM_STEP]) == a;
  l.knows = program_is_told(e->graph, &e->plan->programs[PROGRAM_STEP], a);
  l.one = l.knows || !family_expected(e);
  l.count = segment_nodes(e->graph, a, l.node);
  for (int k = 0, second = a->root_count; k < a->root_count; k++) {
    const segment_root *r = &a->roots[k];
    const bool fuses = segment_fuses(e->graph, r);
    l.factor[k] = fuses ? l.node[second] : IR_NONE;
    second += fuses || segment_has_far(r);
    l.constants += is_constant(e, r);
    l.kept[k] = is_constant(e, r) ? -1 : keep(&l, l.node[k]);
    l.kept_far[k] = segment_has_far(r) ? keep(&l, r->far) : -1;
  }
  return l;
}

static void loops_free(pair_loops *l) {
  free(l->node);
  free(l->factor);
  free(l->kept);
  free(l->kept_far);
  free(l->to_keep);
}

/* Whether kept value k is that of a field, or of a sum. */
static bool is_kept_for(const pair_loops *l, int k, bool field) {
  for (int n = 0; n < l->of->root_count; n++)
    if ((l->kept[n] == k || l->kept_far[n] == k) && is_field(&l->of->roots[n]) == field)
      return true;
  return false;
}

/* Value k, 0 where the bond is absent: kept for the second loop, or for what is stored behind the
   loop. */
static void write_value(emitter *e, const pair_loops *l, int k) {
  say(e, SAY_ROOT_VALUE, numeral(e, k), expression_value(e, l->to_keep[k]));
  if (!l->one || is_kept_for(l, k, true)) say(e, SAY_KEEP_VALUE, numeral(e, k));
}

/* Adds a root's value to both ends, its product with a factor, or to each end its own. */
static void write_sum(emitter *e, const pair_loops *l, int k) {
  const bool odd = l->of->roots[k].parity < 0;
  const char *root = numeral(e, k), *value = numeral(e, l->kept[k]);
  if (l->kept_far[k] >= 0)
    say(e, SAY_ADD_TO_EACH, root, value, numeral(e, l->kept_far[k]));
  else if (l->factor[k] == IR_NONE)
    say(e, SAY_ADD_TO_BOTH, root, value, odd ? "-" : "+");
  else
    say(e, SAY_ADD_PRODUCT_TO_BOTH, root, value, expression_value(e, l->factor[k]), odd ? "-" : "");
}

static void write_sums(emitter *e, const pair_loops *l) {
  for (int k = 0; k < l->of->root_count; k++)
    if (!is_field(&l->of->roots[k]) && !is_constant(e, &l->of->roots[k])) write_sum(e, l, k);
}

/* The first loop, or the only one. */
static void write_values(emitter *e, pair_loops *l, bool usual, bool constant_0) {
  const unsigned relies = usual ? RELIES_ON_EXPECTED : RELIES_ON_NOTHING;
  unsigned char *before = l->one ? family_narrow(e, l->node, l->count, relies)
                                 : family_narrow(e, l->to_keep, l->kept_count, relies);
  l->constant_0 = constant_0;
  say(e, SAY_OVER_LANES, "      ");
  expression_lines(e);
  if (!l->one) say(e, SAY_GATHER_UNEXPECTED, family_expected(e), "bonds[q]");
  say(e, SAY_PRESENT_BY_SIGN);
  for (int k = 0; k < l->kept_count; k++)
    write_value(e, l, k);
  if (l->one) write_sums(e, l);
  say(e, SAY_END, "      ");
  l->constant_0 = false;
  family_widen(e, before);
}

static bool reads_protection(const emitter *e) {
  for (ir_node n = 0; n < e->node_count; n++)
    if (e->needed[n] && expression_is_input(e, n) && family_is_protection(e, n)) return true;
  return false;
}

/* The marks of all fields that are read, where such are: NULL if none. */
static const char *marks_read(const emitter *e) {
  const char *marks = NULL;
  for (int f = 0; f < e->plan->law->fields.count; f++)
    for (int new = 0; new < 2; new ++)
      if (reads_marked(e, f, new))
        marks = words_join(e->memory, marks, " | ",
                           spell(e, SAY_FILLED, new ? "new" : "old", numeral(e, f)));
  return marks;
}

/* One loop for where all fields that it reads are 0 and nothing is protected, with these as
   constants, and one for elsewhere. */
static void write_either(emitter *e, pair_loops *l, bool usual) {
  const char *marks = marks_read(e);
  if (marks) say(e, reads_protection(e) ? SAY_IF_FILLED_OR_PROTECTED : SAY_IF_FILLED, marks);
  write_values(e, l, usual, false);
  if (!marks) return;
  say(e, SAY_ELSE);
  write_values(e, l, usual, true);
  say(e, SAY_END, "      ");
}

/* These, and the same with both sides of what is expected: where it does not hold, which is tried
   first where it did not hold when the pass was here last. */
static void write_first(emitter *e, pair_loops *l) {
  if (l->one && !l->knows) {
    write_either(e, l, true);
    return;
  }
  if (!l->knows) say(e, l->finds_out ? SAY_AS_BEFORE : SAY_AS_EXPECTED);
  say(e, SAY_IF_EXPECTED);
  write_either(e, l, true);
  say(e, l->knows ? SAY_ELSE : SAY_IF_UNEXPECTED);
  write_either(e, l, false);
  if (l->finds_out) say(e, SAY_REMEMBER);
  say(e, SAY_END, "      ");
}

/* --- what stands before and behind ------------------------------------------------------------ */

static void declare_outputs(emitter *e, const pair_loops *l) {
  for (int k = 0; k < l->of->root_count; k++) {
    const segment_root *r = &l->of->roots[k];
    if (is_field(r))
      say(e, SAY_FIELD_BEFORE, numeral(e, k), numeral(e, r->index));
    else
      say(e, SAY_BOTH_ENDS, numeral(e, k), numeral(e, r->index), numeral(e, r->sum));
  }
}

static void write_field_stores(emitter *e, const pair_loops *l) {
  for (int k = 0; k < l->of->root_count; k++)
    if (is_field(&l->of->roots[k]))
      say(e, SAY_STORE_FIELD, numeral(e, k), numeral(e, l->kept[k]),
          numeral(e, l->of->roots[k].index));
}

/* Sums that do not change from step to step. */
static void write_constants(emitter *e, const pair_loops *l) {
  if (!l->constants) return;
  say(e, SAY_UNLESS_KNOWN, "      ");
  say(e, SAY_OVER_LANES, "      ");
  say(e, SAY_PRESENT_BY_SIGN);
  for (int k = 0; k < l->of->root_count; k++) {
    const segment_root *r = &l->of->roots[k];
    const char *root = numeral(e, k);
    if (!is_constant(e, r)) continue;
    say(e, SAY_ROOT_VALUE, root, expression_value(e, l->node[k]));
    say(e, SAY_ADD_TO_BOTH, root, root, r->parity > 0 ? "+" : "-");
  }
  say(e, SAY_END, "      ");
}

static void write_second(emitter *e, const pair_loops *l) {
  write_constants(e, l);
  if (l->one) return;
  unsigned char *before = family_narrow(e, l->factor, l->of->root_count, RELIES_ON_NOTHING);
  say(e, SAY_OVER_LANES, "      ");
  expression_lines(e);
  for (int k = 0; k < l->kept_count; k++)
    if (is_kept_for(l, k, false)) say(e, SAY_KEPT_VALUE, numeral(e, k));
  write_sums(e, l);
  say(e, SAY_END, "      ");
  family_widen(e, before);
}

/* What the particles have got from behind; from then on the sums are 0 for the next pass. */
static void write_ends(emitter *e, const segment *a) {
  int number = program_constant_sums(e->graph, &e->plan->programs[PROGRAM_STEP], a);
  for (int k = 0; k < a->root_count; k++) {
    const segment_root *r = &a->roots[k];
    const bool constant = is_constant(e, r);
    if (is_field(r)) continue;
    if (constant) say(e, SAY_UNLESS_KNOWN, "    ");
    say(e, SAY_TAKE_SUM, numeral(e, r->sum), numeral(e, r->index));
    if (constant) say(e, SAY_KEEP_CONSTANT_SUM, numeral(e, number++), numeral(e, r->index));
  }
  say(e, SAY_NEXT_IF_AHEAD);
}

/* What a chunk needs before its bonds. */
static void write_chunk(emitter *e, const pair_loops *l) {
  family_loops_start(e, l->of);
  write_marks(e, l->of);
  if (l->kept_count && (!l->one || writes_fields(l->of)))
    say(e, SAY_KEEP_VALUES, numeral(e, l->kept_count));
  if (l->finds_out) say(e, SAY_UNEXPECTED_BEFORE);
  if (l->knows) say(e, SAY_UNEXPECTED_NOW);
}

void family_pairs(emitter *e, const segment *a) {
  expression_open_segment(e, &in_pairs, a);
  pair_loops l = loops_of(e, a);
  e->form = &l;
  write_chunk(e, &l);
  say(e, SAY_OVER_PAIRS);
  expression_declare(e);
  declare_outputs(e, &l);
  if (l.kept_count) write_first(e, &l);
  write_field_stores(e, &l);
  write_second(e, &l);
  say(e, SAY_END, "    ");
  if (l.finds_out) say(e, SAY_LEAVE_UNEXPECTED);
  write_ends(e, a);
  e->form = NULL;
  loops_free(&l);
  expression_close(e);
}
