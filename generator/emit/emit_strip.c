/* Passes over strips of bonds as C: one loop, or stages (stages.h). */
#include <assert.h>
#include <stdlib.h>
#include <string.h>

#include "dsl/base/arena.h"
#include "generator/emit/emit.h"
#include "generator/emit/emit_parts.h"
#include "generator/emit/stages.h"

/* --- one loop --------------------------------------------------------------------------------- */

static bool reads_protected(const emitter *e) {
  for (ir_node n = 0; n < e->node_count; n++)
    if (e->needed[n] && emit_is_input(e, n) && ir_input_source(e->graph, n) == IR_FROM_ENDS &&
        ir_input_index(e->graph, n) == ENDS_PROTECTED)
      return true;
  return false;
}

/* X(target, member, array name, how it is stored) */
#define STRIP_TARGETS(X)                                                                           \
  X(TO_FORCE, "force[%d]", "at_force_%d", ZERO)                                                    \
  X(TO_FIELD, "field[%d]", "at_field_%d", KEEP)                                                    \
  X(TO_DISSIPATED_STATE, "dissipated_state", "at_dissipated_state", ADD)                           \
  X(TO_DISSIPATED_RATE, "dissipated_rate", "at_dissipated_rate", ADD)                              \
  X(TO_OBSERVED, "observed[%d]", "at_observed_%d", ZERO)

typedef enum store_kind { ZERO, KEEP, ADD } store_kind; /* what an absent bond leaves behind */

typedef struct strip_target {
  const char *member, *array;
  store_kind store;
} strip_target;

static const strip_target strip_targets[] = {
#define X(target, member, array, store) [target] = {member, array, store},
    STRIP_TARGETS(X)
#undef X
};

/* A format of the table with its index, where it has one. */
static void write_indexed(emitter *e, const char *format, int index) {
  const char *mark = strstr(format, "%d");
  if (mark)
    c_text_add(e->out, "%.*s%d%s", (int)(mark - format), format, index, mark + 2);
  else
    c_text_add(e->out, "%s", format);
}

static void write_target_array(emitter *e, pass_target target, int index, const char *qualifier) {
  c_text_add(e->out, "  %sdouble *restrict ", qualifier);
  write_indexed(e, strip_targets[target].array, index);
  c_text_add(e->out, " = strip->");
  write_indexed(e, strip_targets[target].member, index);
  c_text_add(e->out, ";\n");
}

/* Arrays of the fields that are read, of all or of those only that the pass does not write. */
static void write_read_fields(emitter *e, bool only_read) {
  const int fields = e->plan->law->fields.count;
  unsigned char *read = must_calloc((size_t)fields + 1, 1);
  for (ir_node n = 0; n < e->node_count; n++)
    if (e->needed[n] && emit_is_input(e, n) && ir_input_source(e->graph, n) == IR_FROM_FIELD)
      read[ir_input_index(e->graph, n)] = 1;
  for (int k = 0; k < e->root_count && only_read; k++)
    if (e->roots[k].target == TO_FIELD) read[e->roots[k].index] = 0;
  for (int f = 0; f < fields; f++)
    if (read[f]) write_target_array(e, TO_FIELD, f, "const ");
  free(read);
}

static void write_output_arrays(emitter *e) {
  write_read_fields(e, true);
  for (int k = 0; k < e->root_count; k++)
    write_target_array(e, e->roots[k].target, e->roots[k].index, "");
}

/* Absent bonds are evaluated too (no branch), and what they gave is dropped here, unless it has been (drop_early). */
static void write_store(emitter *e, const pass_root *r) {
  const strip_target *target = &strip_targets[r->target];
  c_text_add(e->out, "    ");
  write_indexed(e, target->array, r->index);
  if (e->dropped && e->dropped[r->node]) {
    c_text_add(e->out, "[q] = %s;\n", e->name[r->node]);
    return;
  }
  c_text_add(e->out, target->store == ADD ? "[q] += present != 0 ? " : "[q] = present != 0 ? ");
  emit_value(e, r->node);
  c_text_add(e->out, " : ");
  if (target->store == KEEP) {
    write_indexed(e, target->array, r->index);
    c_text_add(e->out, "[q];\n");
  } else
    c_text_add(e->out, "0.0;\n");
}

static void write_protected_bit(emitter *e) {
  if (reads_protected(e))
    c_text_add(e->out, "  const int64_t protected_bit = PL_PROTECTED(strip->direction);\n");
}

/* `present` has 32 bits on purpose: gcc then takes twice as many bonds at a time, as pairs of
   vectors, and the divisions of one hide those of the other (5 to 40 % faster on all laws tried).
 */
static void write_strip_head(emitter *e, const char *name, bool cut) {
  const int bits = cut ? 64 : 32;
  emit_function_begin(e, "PL_PASS", name, "const pl_strip *strip");
  c_text_add(e->out,
             "  (void)law, (void)uniforms;\n"
             "  const long count = strip->count / PL_LANES * PL_LANES;\n"
             "  const int64_t *restrict flags = strip->flags;\n"
             "  const int%d_t present_bit = (int%d_t)PL_PRESENT(strip->direction);\n",
             bits, bits);
  write_protected_bit(e);
  if (!e->root_count) c_text_add(e->out, "  (void)flags, (void)present_bit;\n");
  emit_inputs_before_loop(e);
  write_output_arrays(e);
}

static void write_one_loop(emitter *e) {
  emit_loop_begin(e);
  emit_lines(e);
  if (e->root_count)
    c_text_add(e->out, "    const int32_t present = (int32_t)flags[q] & present_bit;\n");
  for (int k = 0; k < e->root_count; k++)
    write_store(e, &e->roots[k]);
  c_text_add(e->out, "  }\n");
}

/* --- stages ----------------------------------------------------------------------------------- */

/* Where values wait for later stages. */
static void write_buffer(emitter *e, const stages *s, int buffer) {
  int lent = 0;
  for (int k = 0; k < e->root_count && buffer < s->lent; k++) {
    const pass_root *r = &e->roots[k];
    if (!stages_is_lent(r) || lent++ != buffer) continue;
    write_indexed(e, strip_targets[r->target].array, r->index);
    c_text_add(e->out, "[q]");
  }
  if (buffer >= s->lent) c_text_add(e->out, "kept[%d][k]", buffer - s->lent);
}

static void write_kept_loads(emitter *e, const stages *s, const unsigned char *kept_loads) {
  for (ir_node n = 0; n < e->node_count; n++)
    if (kept_loads[n]) {
      c_text_add(e->out, "    const double %s = ", e->name[n]);
      write_buffer(e, s, s->buffer[n]);
      c_text_add(e->out, ";\n");
    }
}

static void write_kept_store(emitter *e, const stages *s, ir_node n) {
  c_text_add(e->out, "    ");
  write_buffer(e, s, s->buffer[n]);
  c_text_add(e->out, " = %s;\n", e->name[n]);
}

static void write_kept_stores(emitter *e, const stages *s, int stage) {
  for (ir_node n = 0; n < e->node_count; n++)
    if (stages_stores(s, n, stage)) write_kept_store(e, s, n);
}

/* What is expected, of all loops, in the order of the graph; [EXPECTATIONS], the number returned. */
enum { EXPECTATIONS = 2 };

static int find_expectations(const emitter *e, const stages *s, ir_node choice[EXPECTATIONS]) {
  int count = 0;
  for (ir_node n = 0; n < e->node_count; n++) {
    if (s->of[n] < 0 || !stages_asks(e, s, n)) continue;
    assert(count < EXPECTATIONS);
    choice[count++] = n;
  }
  return count;
}

static expectation expectation_of(const emitter *e, ir_node choice) {
  return stages_expectation(e, ir_operand(e->graph, choice, 0));
}

static void write_bits(emitter *e, ir_node n) {
  c_text_add(e->out, "pl_to_bits(");
  emit_value(e, n);
  c_text_add(e->out, ")");
}

/* The largest sizes so far, of absent bonds too, as bits, which are in the order of sizes, those of NaN above all; a size
   of 2 or more has a bit that smaller ones have not. */
static void write_sizes(emitter *e, const stages *s, int stage) {
  ir_node choice[EXPECTATIONS];
  const int count = find_expectations(e, s, choice);
  for (int k = 0; k < count; k++) {
    const expectation x = expectation_of(e, choice[k]);
    if (s->of[choice[k]] != stage) continue;
    c_text_add(e->out, x.count == 2 ? "    large |= " : "    const uint64_t size_%d = ", k);
    write_bits(e, x.size[0]);
    if (x.count == 2) {
      c_text_add(e->out, " | ");
      write_bits(e, x.size[1]);
      c_text_add(e->out, ";\n");
    } else
      c_text_add(e->out, ";\n    largest_%d = size_%d > largest_%d ? size_%d : largest_%d;\n", k, k,
                 k, k, k);
  }
}

static void write_no_sizes(emitter *e, const stages *s) {
  ir_node choice[EXPECTATIONS];
  const int count = find_expectations(e, s, choice);
  for (int k = 0; k < count; k++)
    if (expectation_of(e, choice[k]).count == 2)
      c_text_add(e->out, "  uint64_t large = 0;\n");
    else
      c_text_add(e->out, "  uint64_t largest_%d = 0;\n", k);
}

/* Asks the function for what is not as expected, where something may be. */
static void write_question(emitter *e, const stages *s, const char *name) {
  const char *joined = "  if (";
  ir_node choice[EXPECTATIONS];
  const int count = find_expectations(e, s, choice);
  for (int k = 0; k < count; k++) {
    const expectation x = expectation_of(e, choice[k]);
    c_text_add(e->out, "%s", joined);
    joined = " || ";
    if (x.count == 2)
      c_text_add(e->out, "(large >> 62 & 1) != 0");
    else {
      c_text_add(e->out, "largest_%d >= ", k);
      write_bits(e, x.limit);
    }
  }
  if (!count) return;
  c_text_add(e->out, ")\n    %s_unusual(law, uniforms, strip, first, last, (double *[]){", name);
  const char *comma = "";
  for (int k = 0; k < e->root_count; k++) {
    if (!stages_is_lent(&e->roots[k])) continue;
    c_text_add(e->out, "%s", comma);
    write_indexed(e, strip_targets[e->roots[k].target].array, e->roots[k].index);
    comma = ", ";
  }
  c_text_add(e->out, "}, %s);\n", s->buffers ? "kept" : "(void *)0");
}

/* Not 0 when a bond that exists has new damage. One line for all, as above. */
static void write_changes(emitter *e) {
  const char *joined = "    changed |= present != 0 ? ";
  for (int k = 0; k < e->root_count; k++) {
    const pass_root *r = &e->roots[k];
    if (r->target != TO_FIELD || !stages_is_of_change(e, r)) continue;
    c_text_add(e->out, "%s(pl_to_bits(", joined);
    emit_value(e, r->node);
    c_text_add(e->out, ") - pl_to_bits(at_field_%d[q]))", r->index);
    joined = " | ";
  }
  c_text_add(e->out, " : 0;\n");
}

/* What the pass gives in this stage: in the last one, and in that behind it. */
static void write_results(emitter *e, const stages *s, int stage) {
  const bool of_change = stage > stages_last(s);
  if (stage < stages_last(s)) return;
  for (int k = 0; k < e->root_count; k++)
    if (!s->changes || stages_is_of_change(e, &e->roots[k]) == of_change)
      write_store(e, &e->roots[k]);
  if (s->changes && !of_change) write_changes(e);
}

/* Whether the loop of a stage looks at arrays of the strip, not at buffers alone. */
static bool reads_bonds(const emitter *e, const stages *s, int stage, const unsigned char *mask,
                        const unsigned char *kept_loads) {
  bool reads = stage >= stages_last(s);
  for (ir_node n = 0; n < e->node_count && !reads; n++) {
    const bool lent = s->buffer[n] >= 0 && s->buffer[n] < s->lent;
    reads = (mask[n] && emit_is_input(e, n) && !emit_is_uniform(e, n)) ||
            (lent && (kept_loads[n] || s->of[n] == stage));
  }
  return reads;
}

/* Forces that are computed in the last loop are dropped with the operation that makes them: where other lines need them,
   too, dropping them behind it would be an operation of its own. NULL in other loops. */
static unsigned char *drop_early(const emitter *e, const stages *s, int stage) {
  if (stage != stages_last(s)) return NULL;
  unsigned char *dropped = must_calloc((size_t)e->node_count + 1, 1);
  for (int k = 0; k < e->root_count; k++)
    dropped[e->roots[k].node] |= e->roots[k].target == TO_FORCE && s->of[e->roots[k].node] == stage;
  return dropped;
}

static void write_lines_of(emitter *e, unsigned relies, unsigned char *mask) {
  unsigned char *whole = e->needed;
  e->needed = mask;
  e->relies = relies;
  emit_lines(e);
  e->relies = SURE_OF_NOTHING;
  e->needed = whole;
}

static void write_stage(emitter *e, const stages *s, int stage, unsigned relies) {
  const size_t size = (size_t)e->node_count + 1;
  unsigned char *mask = must_alloc(size), *kept_loads = must_alloc(size);
  stages_mark(e, s, stage, relies, mask, kept_loads);
  c_text_add(e->out, "  PL_INDEPENDENT\n  for (long k = 0; k < last; k++) {\n");
  if (reads_bonds(e, s, stage, mask, kept_loads))
    c_text_add(e->out, "    const long q = first + k;\n");
  if (stage >= stages_last(s))
    c_text_add(e->out, "    const int64_t present = flags[q] & present_bit;\n");
  write_kept_loads(e, s, kept_loads);
  e->dropped = drop_early(e, s, stage);
  write_lines_of(e, relies, mask);
  if (relies & SURE_OF_EXPECTED) write_sizes(e, s, stage);
  write_kept_stores(e, s, stage);
  write_results(e, s, stage);
  c_text_add(e->out, "  }\n");
  free(e->dropped);
  e->dropped = NULL;
  free(mask);
  free(kept_loads);
}

/* A stage for strips that have protected bonds, and for those that have none: nearly all. */
static void write_stage_for_strip(emitter *e, const stages *s, int stage) {
  const bool held = stages_has_held_choices(e, s, stage);
  if (held) c_text_add(e->out, "  if (strip->unheld != 0) {\n");
  write_stage(e, s, stage, SURE_OF_EXPECTED | SURE_OF_UNHELD);
  if (!held) return;
  c_text_add(e->out, "  }\n  if (strip->unheld == 0) {\n");
  write_stage(e, s, stage, SURE_OF_EXPECTED);
  c_text_add(e->out, "  }\n");
}

static void write_stages(emitter *e, const stages *s, const char *name) {
  if (s->buffers)
    c_text_add(e->out, "  _Alignas(PL_ALIGNMENT) double kept[%d][%d];\n", s->buffers, STAGES_PITCH);
  c_text_add(e->out,
             "  for (long first = 0; first < count; first += %d) {\n"
             "  const long last = count - first < %d ? count - first : %d;\n",
             STAGES_PART, STAGES_PART, STAGES_PART);
  write_no_sizes(e, s);
  if (s->changes) c_text_add(e->out, "  uint64_t changed = 0;\n");
  for (int stage = 0; stage <= stages_last(s); stage++) {
    if (stage == stages_last(s)) write_question(e, s, name);
    write_stage_for_strip(e, s, stage);
  }
  if (s->changes) {
    c_text_add(e->out, "  if (changed != 0) {\n");
    write_stage(e, s, s->count - 1, SURE_OF_NOTHING);
    c_text_add(e->out, "  }\n");
  }
  c_text_add(e->out, "  }\n");
}

/* --- what is not as expected ------------------------------------------------------------------ */

#define TEXT_OF(number) #number
#define TEXT(macro)     TEXT_OF(macro)
static const char unusual_over[] = "const pl_strip *strip, long first, long last,\n    "
                                   "double *const *lent, double (*kept)[" TEXT(STAGES_PITCH) "]";

/* Marks what the marked nodes need, too; all of both sides, or what is expected. */
static void mark_below(const emitter *e, unsigned relies, unsigned char *mask) {
  for (ir_node n = e->node_count - 1; n >= 0; n--) {
    ir_node operand[3];
    const int count = mask[n] ? stages_operands(e, n, relies, operand) : 0;
    for (int k = 0; k < count; k++)
      mask[operand[k]] = 1;
  }
}

/* One line for all conditions: gcc does not vectorise two. */
static void write_search(emitter *e, const stages *s, unsigned char *mask) {
  ir_node choice[EXPECTATIONS];
  const int count = find_expectations(e, s, choice);
  c_text_add(e->out, "  int64_t unusual = 0;\n  PL_INDEPENDENT\n"
                     "  for (long k = group; k < group + PL_LANES; k++) {\n"
                     "    const long q = first + k;\n");
  write_lines_of(e, SURE_OF_EXPECTED, mask);
  c_text_add(e->out, "    const int64_t present = flags[q] & present_bit;\n");
  for (int k = 0; k < count; k++) {
    c_text_add(e->out, k ? " && (" : "    unusual |= ((");
    emit_condition(e, ir_operand(e->graph, choice[k], 0));
    c_text_add(e->out, ")");
  }
  c_text_add(e->out, ") ? 0 : present;\n  }\n  if (unusual != 0) { "
                     "/* both sides of what was expected */\n");
}

static void write_both_sides(emitter *e, const stages *s, const unsigned char *kept,
                             unsigned char *mask) {
  c_text_add(e->out, "  PL_INDEPENDENT\n  for (long k = group; k < group + PL_LANES; k++) {\n"
                     "    const long q = first + k;\n");
  write_lines_of(e, SURE_OF_NOTHING, mask);
  for (ir_node n = 0; n < e->node_count; n++)
    if (kept[n]) write_kept_store(e, s, n);
  c_text_add(e->out, "  }\n  }\n  }\n");
}

static void write_lent_arrays(emitter *e, const stages *s, const unsigned char *kept) {
  for (int k = 0, lent = 0; k < e->root_count; k++) {
    const pass_root *r = &e->roots[k];
    if (!stages_is_lent(r)) continue;
    bool used = false;
    for (ir_node n = 0; n < e->node_count; n++)
      used |= kept[n] && s->buffer[n] == lent;
    if (used) {
      c_text_add(e->out, "  double *restrict ");
      write_indexed(e, strip_targets[r->target].array, r->index);
      c_text_add(e->out, " = lent[%d];\n", lent);
    }
    lent++;
  }
}

static void write_unusual_head(emitter *e, const stages *s, const char *name,
                               const unsigned char *kept) {
  c_text function = {0};
  c_text_add(&function, "%s_unusual", name);
  emit_function_begin(e, "PL_APART PL_PASS", function.text, unusual_over);
  free(function.text);
  c_text_add(e->out, "  (void)law, (void)lent, (void)kept;\n"
                     "  const int64_t *restrict flags = strip->flags;\n"
                     "  const int64_t present_bit = (int64_t)PL_PRESENT(strip->direction);\n");
  write_protected_bit(e);
  emit_inputs_before_loop(e);
  write_read_fields(e, false);
  write_lent_arrays(e, s, kept);
  c_text_add(e->out, "  for (long group = 0; group < last; group += PL_LANES) {\n");
}

/* A function for the vectors that hold a bond that exists and is not as expected: computes again, with both sides, what the
   last loop takes from the buffers. */
static void write_unusual(emitter *e, const stages *s, const char *name) {
  const size_t size = (size_t)e->node_count + 1;
  unsigned char *asked = must_calloc(size, 1), *kept = must_calloc(size, 1),
                *both = must_calloc(size, 1), *whole = e->needed;
  ir_node choice[EXPECTATIONS];
  const int count = find_expectations(e, s, choice);
  for (int k = 0; k < count; k++)
    asked[ir_operand(e->graph, choice[k], 0)] = 1;
  mark_below(e, SURE_OF_EXPECTED, asked);
  stages_mark_kept(e, s, kept);
  memcpy(both, kept, size);
  mark_below(e, SURE_OF_NOTHING, both);
  e->needed = must_calloc(size, 1);
  for (ir_node n = 0; n < e->node_count; n++)
    e->needed[n] = asked[n] | both[n];
  write_unusual_head(e, s, name, kept);
  write_search(e, s, asked);
  write_both_sides(e, s, kept, both);
  emit_function_end(e);
  free(e->needed);
  e->needed = whole;
  free(asked);
  free(kept);
  free(both);
}

/* --- a pass ----------------------------------------------------------------------------------- */

/* What was decided, in a line for readers of the C text and of --dump=passes. */
static void describe(const stages *s, c_text *out) {
  if (s->count == 1) {
    c_text_add(out, "one loop, a chain of %d cycles", s->cost[0].chain);
    return;
  }
  c_text_add(out, "%d loops over parts of %d bonds, chains of", stages_last(s) + 1, STAGES_PART);
  for (int k = 0; k <= stages_last(s); k++)
    c_text_add(out, "%s%d", k ? ", " : " ", s->cost[k].chain);
  c_text_add(out, " cycles instead of %d, %d buffers between", s->whole_chain, s->buffers);
  if (s->conditions) c_text_add(out, ", %d choices expected", s->conditions);
  if (s->changes) c_text_add(out, ", one more loop where damage changed");
}

/* What the loops of a pass need where all is as expected; without cuts, what the pass needs. The caller frees it. */
static unsigned char *usually_needed(const emitter *e, const stages *s) {
  const size_t size = (size_t)e->node_count + 1;
  unsigned char *usual = must_calloc(size, 1), *mask = must_alloc(size), *loads = must_alloc(size);
  if (s->count == 1) memcpy(usual, e->needed, size);
  for (int stage = 0; stage < s->count && s->count > 1; stage++) {
    stages_mark(e, s, stage, stage > stages_last(s) ? SURE_OF_NOTHING : SURE_OF_EXPECTED, mask,
                loads);
    for (ir_node n = 0; n < e->node_count; n++)
      usual[n] |= mask[n];
  }
  for (ir_node n = 0; n < e->node_count; n++)
    if (s->of[n] >= 0 && stages_asks(e, s, n)) usual[expectation_of(e, n).limit] = 1;
  free(mask);
  free(loads);
  return usual;
}

void emit_strip_pass(emitter *e, const pass *p, const char *name) {
  emit_open_roots(e, IN_ROWS, p->roots, p->root_count);
  stages *s = stages_plan(e, e->plan->cutting);
  unsigned char *whole = e->needed, *usual = usually_needed(e, s);
  c_text_add(e->out, "/* ");
  describe(s, e->out);
  c_text_add(e->out, " */\n");
  if (s->conditions)
    c_text_add(e->out, "PL_APART PL_PASS void %s_unusual(const pl_law *, const double *, %s);\n",
               name, unusual_over);
  e->needed = usual;
  write_strip_head(e, name, s->count > 1);
  e->needed = whole;
  if (s->count > 1)
    write_stages(e, s, name);
  else
    write_one_loop(e);
  emit_function_end(e);
  if (s->conditions) write_unusual(e, s, name);
  free(usual);
  stages_free(s);
  emit_close(e);
}

/* --- what --dump=passes says ------------------------------------------------------------------ */

static void describe_stages(const stages *s, FILE *out) {
  for (int k = 0; k < s->count; k++) {
    const stage_cost *c = &s->cost[k];
    fprintf(out,
            "    loop %d: %d operations, %d divisions, %d loads, %d stores, a chain of %d cycles; "
            "%.0f cycles for eight bonds%s\n",
            k + 1, c->operations, c->divisions, c->loads, c->stores, c->chain, c->cycles,
            k > stages_last(s) ? "; only where damage changed" : "");
  }
}

void emit_describe_loops(const kernel_plan *p, pass_kind kind, FILE *out) {
  static const bool over_strips[PASS_COUNT] = {
#define X(pass, member, task) [pass] = true,
      STRIP_PASSES(X)
#undef X
  };
  const pass *a = &p->passes[kind];
  if (!over_strips[kind] || !a->root_count) return;
  c_text text = {0};
  emitter e = {.plan = p, .graph = p->graph, .out = &text, .node_count = ir_count(p->graph)};
  emit_find_uniforms(&e);
  emit_open_roots(&e, IN_ROWS, a->roots, a->root_count);
  stages *s = stages_plan(&e, p->cutting);
  describe(s, &text);
  fprintf(out, "  loops  %s\n", text.text);
  describe_stages(s, out);
  stages_free(s);
  emit_close(&e);
  free(e.uniform_of);
  free(text.text);
}
