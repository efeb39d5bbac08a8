/* Loops over bonds that add to both ends (OVER_PAIRS). A chunk is FAMILY_CHUNK particles of one row, whatever thread has
   it, so that what a particle gets comes in one order. A value for the far end is added to family->sum there, and what the
   chunk's own particles have got from behind is theirs after the loop.

   Values of fields toward neighbours are 0 for nearly all bonds and seldom change, and to read and write them would take
   longer than to compute them: eight at a time bear marks of where one is not 0 (family->old_filled), elsewhere the loop has 0 as a
   constant; and new values are stored only where they differ from what stands there.

   For each bond of the chunk's particles one loop computes values and another adds them to both ends, so that the first can
   be done once more where not all is as it was expected. Later passes are told where (family->unusual) and need one loop. */
#include <stdlib.h>

#include "dsl/base/arena.h"
#include "generator/emit/emit_parts.h"
#include "generator/emit/stages.h"
#include "generator/plan/program_facts.h"

static const char field_functions[] =
    "static const _Alignas(PL_ALIGNMENT) double zeros[%d];\n\n"
    "/* Bits of neighbours toward which some of the particles of a chunk have the mark, or do not "
    "have it. */\n"
    "static uint64_t some_marked(const uint64_t *mark, long lanes, uint64_t turned) {\n"
    "  uint64_t all = 0;\n"
    "  for (long q = 0; q < lanes; q += PL_LANES)\n"
    "    all |= mark[q / PL_LANES] ^ turned;\n"
    "  return all;\n"
    "}\n\n"
    "static int are_equal(const double *a, const double *b, long lanes) {\n"
    "  uint64_t differ = 0;\n"
    "  for (long q = 0; q < lanes; q++)\n"
    "    differ |= pl_to_bits(a[q]) ^ pl_to_bits(b[q]);\n"
    "  return differ == 0;\n"
    "}\n\n"
    "/* New values toward neighbour k, at both ends. */\n"
    "static __attribute__((noinline, cold)) void store_at_ends(\n"
    "    const pl_family *family, int field, long first, long lanes, long k, const double "
    "*values,\n"
    "    int settled) {\n"
    "  const long to = family->offset[k], half = family->neighbours / 2;\n"
    "  double *restrict here = family->new_field[field] + first + k*family->new_plane;\n"
    "  double *restrict there = family->new_field[field] + first + to + (k + "
    "half)*family->new_plane;\n"
    "  const uint64_t bit = UINT64_C(1) << k;\n"
    "  for (long at = 0; at < lanes; at += PL_LANES) {\n"
    "    uint64_t *filled = family->new_filled[field] + (first + at) / PL_LANES;\n"
    "    uint64_t *same = family->settled[field] + (first + at) / PL_LANES, bits = 0;\n"
    "    for (long q = at; q < at + PL_LANES; q++) {\n"
    "      here[q] = there[q] = values[q];\n"
    "      bits |= pl_to_bits(values[q]);\n"
    "    }\n"
    "    *filled = bits != 0 ? *filled | bit : *filled & ~bit;\n"
    "    *same = settled ? *same | bit : *same & ~bit;\n"
    "  }\n"
    "}\n\n";

static bool is_field(const segment_root *r) {
  return r->target == TO_NEIGHBOUR_FIELD;
}

void emit_pairs_functions(emitter *e) {
  for (int f = 0; f < e->plan->law->fields.count; f++)
    if (program_pairs_field(&e->plan->step, f)) {
      c_text_add(e->out, field_functions, FAMILY_CHUNK);
      return;
    }
}

/* "old" or "new" where marks tell where the field is 0; else NULL. */
static const char *marked_field(const emitter *e, ir_node n) {
  if (ir_operation(e->graph, n) != IR_INPUT) return NULL;
  const ir_source from = ir_input_source(e->graph, n);
  if (from != IR_FROM_FIELD && from != IR_FROM_NEW_FIELD) return NULL;
  if (!program_pairs_field(&e->plan->step, ir_input_index(e->graph, n))) return NULL;
  return from == IR_FROM_FIELD ? "old" : "new";
}

bool emit_pairs_is_zero(const emitter *e, ir_node n) {
  return e->quiet && (marked_field(e, n) || emit_is_held(e, n));
}

static void write_filled(emitter *e, const char *which, int field) {
  c_text_add(e->out,
             "    const uint64_t %s_filled_%d = some_marked(family->%s_filled[%d] + first / "
             "PL_LANES, lanes, 0);\n",
             which, field, which, field);
}

static bool writes_field(const segment *a, int field) {
  for (int k = 0; k < a->root_count; k++)
    if (is_field(&a->roots[k]) && a->roots[k].index == field) return true;
  return false;
}

static bool writes_fields(const segment *a) {
  bool any = false;
  for (int k = 0; k < a->root_count; k++)
    any = any || is_field(&a->roots[k]);
  return any;
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
    if (writes_field(a, f) || reads_marked(e, f, false)) write_filled(e, "old", f);
    if (reads_marked(e, f, true)) write_filled(e, "new", f);
  }
  for (int k = 0; k < a->root_count; k++)
    if (is_field(&a->roots[k]))
      c_text_add(e->out,
                 "    const uint64_t unsettled_%d = some_marked(family->settled[%d] + first / "
                 "PL_LANES, lanes, UINT64_MAX);\n",
                 k, a->roots[k].index);
}

/* --- two loops -------------------------------------------------------------------------------- */

/* By the sign of what is moved there: gcc asks more if it is to ask for a bit. */
static const char present_text[] =
    "        const int64_t present = (int64_t)(bonds[q] << above) < 0;\n";

/* What the segment computes for its roots (segment_nodes), and which of that the first loop keeps for the second. */
typedef struct pair_loops {
  const segment *of;
  ir_node *node;    /* [count] */
  int count;        /* roots, then factors that are read again */
  int *kept;        /* [root_count] where the value is kept; -1: of constant sums */
  ir_node *to_keep; /* [kept_count] */
  int kept_count;
  int constants;   /* roots that are constant sums */
  bool asks, told; /* what is as expected: for later passes, or by an earlier one */
  bool one;        /* one loop does both: it need not be done again */
} pair_loops;

static bool expects(const emitter *e) {
  for (ir_node n = 0; n < e->node_count; n++)
    if (e->needed[n] && stages_is_expected_choice(e, n)) return true;
  return false;
}

static pair_loops loops_of(const emitter *e, const segment *a) {
  const size_t size = 2 * (size_t)a->root_count + 1;
  pair_loops l = {.of = a,
                  .node = must_alloc(size * sizeof *l.node),
                  .kept = must_alloc(size * sizeof *l.kept),
                  .to_keep = must_alloc(size * sizeof *l.to_keep)};
  l.asks = program_asks(e->graph, &e->plan->step) == a;
  l.told = program_is_told(e->graph, &e->plan->step, a);
  l.one = l.told || !expects(e);
  l.count = segment_nodes(e->graph, a, l.node);
  for (int k = 0; k < a->root_count; k++) {
    const bool keep = !segment_is_constant(e->graph, &a->roots[k]);
    l.kept[k] = keep ? 0 : -1;
    l.constants += !keep;
    while (keep && l.kept[k] < l.kept_count && l.to_keep[l.kept[k]] != l.node[k])
      l.kept[k]++;
    if (keep && l.kept[k] == l.kept_count) l.to_keep[l.kept_count++] = l.node[k];
  }
  return l;
}

static void loops_free(pair_loops *l) {
  free(l->node);
  free(l->kept);
  free(l->to_keep);
}

/* Marks what these nodes need; of choices by what is relied on only what is chosen then. The caller frees it. */
static unsigned char *needed_for(const emitter *e, const ir_node *nodes, int count,
                                 unsigned relies) {
  unsigned char *mask = must_calloc((size_t)e->node_count + 1, 1);
  for (int k = 0; k < count; k++)
    mask[nodes[k]] = 1;
  for (ir_node n = e->node_count - 1; n >= 0; n--) {
    ir_node operand[3];
    const int operands = mask[n] ? stages_operands(e, n, relies, operand) : 0;
    for (int k = 0; k < operands; k++)
      mask[operand[k]] = 1;
  }
  return mask;
}

/* Bonds that are not as expected leave their bits. One line for all conditions: gcc does not vectorise two. */
static void write_expectations(emitter *e) {
  const char *joined = "        unusual |= ((";
  for (ir_node n = 0; n < e->node_count; n++) {
    bool again = !e->needed[n] || !stages_is_expected_choice(e, n);
    const ir_node asked = again ? IR_NONE : ir_operand(e->graph, n, 0);
    for (ir_node before = 0; before < n && !again; before++)
      again = e->needed[before] && stages_is_expected_choice(e, before) &&
              ir_operand(e->graph, before, 0) == asked;
    if (again) continue;
    c_text_add(e->out, "%s", joined);
    emit_condition(e, asked);
    joined = ") && (";
  }
  c_text_add(e->out, ")) ? 0 : bonds[q];\n");
}

/* Whether kept value k is that of a field, or of a sum. */
static bool is_kept_for(const pair_loops *l, int k, bool field) {
  for (int n = 0; n < l->of->root_count; n++)
    if (l->kept[n] == k && is_field(&l->of->roots[n]) == field) return true;
  return false;
}

/* Value k, 0 where the bond is absent: kept for the second loop, or for what is stored behind the loop. */
static void write_value(emitter *e, const pair_loops *l, int k) {
  c_text_add(e->out, "        const double value_%d = present ? ", k);
  emit_value(e, l->to_keep[k]);
  c_text_add(e->out, " : 0.0;\n");
  if (!l->one || is_kept_for(l, k, true))
    c_text_add(e->out, "        kept[%d][q] = value_%d;\n", k, k);
}

/* Adds a root's value, or its product with node `factor`, to both ends. */
static void write_sum(emitter *e, const pair_loops *l, int k, ir_node factor) {
  const char sign = l->of->roots[k].parity > 0 ? '+' : '-';
  const int value = l->kept[k];
  if (factor == IR_NONE) {
    c_text_add(e->out, "        to_%d[q] += value_%d;\n        far_%d[q] %c= value_%d;\n", k, value,
               k, sign, value);
    return;
  }
  c_text_add(e->out, "        to_%d[q] = pl_fma(value_%d, ", k, value);
  emit_value(e, factor);
  c_text_add(e->out, ", to_%d[q]);\n        far_%d[q] = pl_fma(%svalue_%d, ", k, k,
             sign == '-' ? "-" : "", value);
  emit_value(e, factor);
  c_text_add(e->out, ", far_%d[q]);\n", k);
}

static void write_sums(emitter *e, const pair_loops *l) {
  for (int k = 0, factors = l->of->root_count; k < l->of->root_count; k++) {
    const segment_root *r = &l->of->roots[k];
    const bool fuses = segment_fuses(e->graph, r);
    if (!is_field(r) && !segment_is_constant(e->graph, r))
      write_sum(e, l, k, fuses ? l->node[factors] : IR_NONE);
    factors += fuses;
  }
}

/* The first loop, or the only one. */
static void write_values(emitter *e, const pair_loops *l, bool usual, bool quiet) {
  unsigned char *whole = e->needed;
  e->relies = usual ? SURE_OF_EXPECTED : SURE_OF_NOTHING;
  e->needed = l->one ? needed_for(e, l->node, l->count, e->relies)
                     : needed_for(e, l->to_keep, l->kept_count, e->relies);
  e->quiet = quiet;
  emit_family_loop(e, "      ");
  emit_lines(e);
  if (!l->one) write_expectations(e);
  c_text_add(e->out, present_text);
  for (int k = 0; k < l->kept_count; k++)
    write_value(e, l, k);
  if (l->one) write_sums(e, l);
  c_text_add(e->out, "      }\n");
  e->relies = SURE_OF_NOTHING;
  e->quiet = false;
  free(e->needed);
  e->needed = whole;
}

static bool reads_held(const emitter *e) {
  for (ir_node n = 0; n < e->node_count; n++)
    if (e->needed[n] && emit_is_input(e, n) && emit_is_held(e, n)) return true;
  return false;
}

/* Whether toward neighbour k a field that is read may be other than 0, or something is held. False if nothing is asked. */
static bool write_question(emitter *e) {
  const char *join = "      if (((";
  const bool held = reads_held(e);
  for (int f = 0; f < e->plan->law->fields.count; f++)
    for (int new = 0; new < 2; new ++)
      if (reads_marked(e, f, new)) {
        c_text_add(e->out, "%s%s_filled_%d", join, new ? "new" : "old", f);
        join = " | ";
      }
  const bool marks = *join == ' ' && join[1] == '|';
  if (marks) c_text_add(e->out, ") >> k & 1) != 0%s) {\n", held ? " || family->held_near" : "");
  return marks;
}

/* One loop for where all fields that it reads are 0 and nothing is held, with these as constants, and one for elsewhere. */
static void write_either(emitter *e, const pair_loops *l, bool usual) {
  const bool marks = write_question(e);
  write_values(e, l, usual, false);
  if (!marks) return;
  c_text_add(e->out, "      } else {\n");
  write_values(e, l, usual, true);
  c_text_add(e->out, "      }\n");
}

/* These, and the same with both sides of what is expected: where it does not hold, which is tried first where it did not hold
   when the pass was here last. */
static void write_first(emitter *e, const pair_loops *l) {
  if (l->one && !l->told) {
    write_either(e, l, true);
    return;
  }
  if (!l->told)
    c_text_add(e->out, l->asks ? "      uint64_t unusual = before & present_bit;\n"
                               : "      uint64_t unusual = 0;\n");
  c_text_add(e->out, "      if ((unusual & present_bit) == 0) {\n");
  write_either(e, l, true);
  c_text_add(e->out,
             l->told ? "      } else {\n" : "      }\n      if ((unusual & present_bit) != 0) {\n");
  if (!l->told) c_text_add(e->out, "      unusual = 0;\n");
  write_either(e, l, false);
  if (l->asks) c_text_add(e->out, "      told |= unusual & present_bit;\n");
  c_text_add(e->out, "      }\n");
}

static void write_outputs(emitter *e, const pair_loops *l) {
  for (int k = 0; k < l->of->root_count; k++) {
    const segment_root *r = &l->of->roots[k];
    if (is_field(r))
      c_text_add(e->out,
                 "      const double *restrict before_%d = (old_filled_%d >> k & 1) == 0 ? zeros : "
                 "family->old_field[%d] + first + k*family->plane;\n",
                 k, r->index, r->index);
    else
      c_text_add(e->out,
                 "      double *restrict to_%d = slot_%d, *restrict far_%d = family->sum[%d] + "
                 "first + to;\n",
                 k, r->index, k, r->sum);
  }
}

static void write_field_stores(emitter *e, const pair_loops *l) {
  for (int k = 0; k < l->of->root_count; k++)
    if (is_field(&l->of->roots[k]))
      c_text_add(e->out,
                 "      const int settled_%d = are_equal(kept[%d], before_%d, lanes);\n"
                 "      if (!family->ahead_only && (!settled_%d || (unsettled_%d >> k & 1)))\n"
                 "        store_at_ends(family, %d, first, lanes, k, kept[%d], settled_%d);\n",
                 k, l->kept[k], k, k, k, l->of->roots[k].index, l->kept[k], k);
}

/* Sums that do not change from step to step. */
static void write_constants(emitter *e, const pair_loops *l) {
  if (!l->constants) return;
  c_text_add(e->out, "      if (!family->constants_known)\n");
  emit_family_loop(e, "      ");
  c_text_add(e->out, present_text);
  for (int k = 0; k < l->of->root_count; k++) {
    if (!segment_is_constant(e->graph, &l->of->roots[k])) continue;
    c_text_add(e->out, "        const double value_%d = present ? ", k);
    emit_value(e, l->node[k]);
    c_text_add(e->out, " : 0.0;\n        to_%d[q] += value_%d;\n        far_%d[q] %c= value_%d;\n",
               k, k, k, l->of->roots[k].parity > 0 ? '+' : '-', k);
  }
  c_text_add(e->out, "      }\n");
}

static void write_second(emitter *e, const pair_loops *l) {
  const int roots = l->of->root_count;
  unsigned char *whole = e->needed;
  write_constants(e, l);
  if (l->one) return;
  e->needed = needed_for(e, l->node + roots, l->count - roots, SURE_OF_NOTHING);
  emit_family_loop(e, "      ");
  emit_lines(e);
  for (int k = 0; k < l->kept_count; k++)
    if (is_kept_for(l, k, false))
      c_text_add(e->out, "        const double value_%d = kept[%d][q];\n", k, k);
  write_sums(e, l);
  c_text_add(e->out, "      }\n");
  free(e->needed);
  e->needed = whole;
}

/* What the particles have got from behind; from then on the sums are 0 for the next pass. */
static void write_end(emitter *e, const segment_root *r) {
  c_text_add(e->out,
             "    {\n"
             "    double *restrict got = family->sum[%d] + first;\n"
             "    for (long q = 0; q < lanes; q++) {\n"
             "      slot_%d[q] += got[q];\n"
             "      got[q] = 0.0;\n"
             "    }\n"
             "    }\n",
             r->sum, r->index);
}

static void write_constant_end(emitter *e, const segment_root *r, int number) {
  c_text_add(e->out, "    if (!family->constants_known)\n");
  write_end(e, r);
  c_text_add(e->out,
             "    if (family->constant_sum && !family->ahead_only) {\n"
             "    double *restrict constant = family->constant_sum[%d] + first;\n"
             "    for (long q = 0; q < lanes; q++)\n"
             "      slot_%d[q] = constant[q] = family->constants_known ? constant[q] : "
             "slot_%d[q];\n"
             "    }\n",
             number, r->index, r->index);
}

static void write_ends(emitter *e, const segment *a) {
  int number = program_constant_sums(e->graph, &e->plan->step, a);
  for (int k = 0; k < a->root_count; k++) {
    const segment_root *r = &a->roots[k];
    if (segment_is_constant(e->graph, r))
      write_constant_end(e, r, number++);
    else if (!is_field(r))
      write_end(e, r);
  }
  c_text_add(e->out, "    if (family->ahead_only) continue;\n");
}

/* What a chunk needs before its bonds. */
static void write_chunk(emitter *e, const pair_loops *l) {
  emit_family_starts(e, l->of);
  write_marks(e, l->of);
  if (l->kept_count && (!l->one || writes_fields(l->of)))
    c_text_add(e->out, "    _Alignas(PL_ALIGNMENT) double kept[%d][CHUNK];\n", l->kept_count);
  if (l->asks)
    c_text_add(e->out, "    const uint64_t before = family->unusual && !family->ahead_only ? "
                       "family->unusual[first / PL_LANES] : 0;\n    uint64_t told = 0;\n");
  if (l->told)
    c_text_add(e->out, "    const uint64_t unusual = family->unusual ? family->unusual[first / "
                       "PL_LANES] : UINT64_MAX;\n");
}

void emit_pairs(emitter *e, const segment *a) {
  pair_loops l = loops_of(e, a);
  write_chunk(e, &l);
  c_text_add(e->out,
             "    for (long k = 0; k < half; k++) { /* bond by bond, adding to both ends */\n"
             "      const long to = family->offset[k], link_to = family->link_offset[k], back = k "
             "+ half;\n"
             "      (void)back, (void)link_to;\n"
             "      const uint64_t *restrict bonds = family->bonds + first;\n"
             "      const uint64_t present_bit = UINT64_C(1) << k;\n"
             "      const long above = 63 - k;\n"
             "      (void)present_bit, (void)above;\n");
  emit_family_inputs(e);
  write_outputs(e, &l);
  if (l.kept_count) write_first(e, &l);
  write_field_stores(e, &l);
  write_second(e, &l);
  c_text_add(e->out, "    }\n");
  if (l.asks)
    c_text_add(e->out, "    if (family->unusual && !family->ahead_only) family->unusual[first / "
                       "PL_LANES] = told;\n");
  write_ends(e, a);
  loops_free(&l);
}
