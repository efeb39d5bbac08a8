#include "generator/emit/strip_cut.h"

#include <assert.h>
#include <stdlib.h>

#include "generator/emit/strip_arrays.h"

/* --- buffers ---------------------------------------------------------------------------------- */

/* The root whose array is result array `number`. */
static const segment_root *root_of_array(const emitter *e, int number) {
  int arrays = 0;
  for (int k = 0; k < e->root_count; k++)
    if (stages_in_result_array(&e->roots[k]) && arrays++ == number) return &e->roots[k];
  return NULL;
}

/* Where values wait for later stages. */
static const char *buffer(const emitter *e, const stages *s, int number) {
  if (number >= s->result_arrays)
    return spell(e, SAY_BUFFER, numeral(e, number - s->result_arrays));
  return spell(e, SAY_HERE, strip_array(e, root_of_array(e, number)));
}

static void write_kept_loads(emitter *e, const stages *s, const unsigned char *kept_loads) {
  for (ir_node n = 0; n < e->node_count; n++)
    if (kept_loads[n])
      say(e, SAY_DECLARE, "    ", spell(e, SAY_VALUE), e->name[n], buffer(e, s, s->buffer[n]));
}

static void write_kept_store(emitter *e, const stages *s, ir_node n) {
  say(e, SAY_STORE, "    ", buffer(e, s, s->buffer[n]), e->name[n]);
}

static void write_kept_stores(emitter *e, const stages *s, int stage) {
  for (ir_node n = 0; n < e->node_count; n++)
    if (stages_store(s, n, stage)) write_kept_store(e, s, n);
}

/* --- what is expected ------------------------------------------------------------------------- */

/* The choices that ask for it, in the order of the graph. */
enum { EXPECTATIONS = 4 };
typedef struct expectations {
  ir_node condition[EXPECTATIONS];
  int stage[EXPECTATIONS];
  expectation of[EXPECTATIONS];
  int count;
} expectations;

static expectations find_expectations(const emitter *e, const stages *s) {
  expectations x = {.count = 0};
  for (ir_node n = 0; n < e->node_count; n++) {
    if (s->of[n] < 0 || !stages_ask(e, s, n)) continue;
    assert(x.count < EXPECTATIONS);
    x.condition[x.count] = ir_operand(e->graph, n, 0);
    x.stage[x.count] = s->of[n];
    x.of[x.count] = choice_expectation(e, x.condition[x.count]);
    x.count++;
  }
  return x;
}

static const char *bits(const emitter *e, ir_node n) {
  return spell(e, SAY_BITS, expression_value(e, n));
}

static int flag_count(const expectations *x) {
  int count = 0;
  for (int k = 0; k < x->count; k++)
    count += x->of[k].count == 0;
  return count;
}

/* Where it waits, behind the buffers, whether expectation k, of no size, is not so of a bond. */
static const char *flag(const emitter *e, const stages *s, const expectations *x, int k) {
  int at = s->buffers;
  while (--k >= 0)
    at += x->of[k].count == 0;
  return spell(e, SAY_BUFFER, numeral(e, at));
}

/* Buffers of values and of flags. */
static int buffer_count(const emitter *e, const stages *s) {
  const expectations x = find_expectations(e, s);
  return s->buffers + flag_count(&x);
}

/* The largest sizes so far, of absent bonds too, as bits, which are in the order of sizes, those of
   NaN above all; a size of 2 or more has a bit that smaller ones have not. */
static void write_sizes(emitter *e, const stages *s, int stage) {
  const expectations x = find_expectations(e, s);
  for (int k = 0; k < x.count; k++) {
    const ir_node *size = x.of[k].size;
    if (x.stage[k] != stage) continue;
    if (x.of[k].count == 0)
      say(e, SAY_GATHER_OTHER, numeral(e, k), flag(e, s, &x, k),
          expression_condition(e, x.condition[k]));
    else if (x.of[k].count == 2)
      say(e, SAY_GATHER_LARGE, bits(e, size[0]), bits(e, size[1]));
    else
      say(e, SAY_GATHER_LARGEST, numeral(e, k), bits(e, size[0]));
  }
}

static void write_no_sizes(emitter *e, const stages *s) {
  const expectations x = find_expectations(e, s);
  for (int k = 0; k < x.count; k++)
    say(e,
        x.of[k].count == 0   ? SAY_NO_OTHER
        : x.of[k].count == 1 ? SAY_NO_LARGEST
                             : SAY_NO_LARGE,
        numeral(e, k));
}

/* Whether that may not be so of some bond. */
static const char *is_unexpected(const emitter *e, const expectations *x, int k) {
  if (x->of[k].count == 0) return spell(e, SAY_IS_OTHER, numeral(e, k));
  if (x->of[k].count == 2) return spell(e, SAY_IS_LARGE);
  return spell(e, SAY_IS_LARGEST, numeral(e, k), bits(e, x->of[k].limit));
}

/* Asks the function for what is not as expected, where something may be. */
static void write_question(emitter *e, const stages *s, const char *name) {
  const expectations x = find_expectations(e, s);
  const char *asked = NULL, *arrays = NULL;
  for (int k = 0; k < x.count; k++)
    asked = words_join(e->memory, asked, " || ", is_unexpected(e, &x, k));
  for (int k = 0; k < s->result_arrays; k++)
    arrays = words_join(e->memory, arrays, ", ", strip_array(e, root_of_array(e, k)));
  if (asked)
    say(e, SAY_COMPUTE_AGAIN, asked, name, arrays ? arrays : "",
        spell(e, buffer_count(e, s) ? SAY_BUFFERS : SAY_NO_BUFFERS));
}

/* --- stages ----------------------------------------------------------------------------------- */

/* Not 0 when a bond that exists has new damage. One line for all: gcc does not vectorise two. */
static void write_changes(emitter *e) {
  const char *changes = NULL;
  for (int k = 0; k < e->root_count; k++) {
    const segment_root *r = &e->roots[k];
    if (r->target == TO_FIELD && stages_is_of_change(e, r))
      changes = words_join(e->memory, changes, " | ",
                           spell(e, SAY_CHANGE, bits(e, r->node), strip_array(e, r)));
  }
  say(e, SAY_GATHER_CHANGES, changes);
}

/* What the pass gives in this stage: in the last one, and in that behind it. */
static void write_results(emitter *e, const stages *s, int stage) {
  const bool of_change = stage > stages_last(s);
  if (stage < stages_last(s)) return;
  for (int k = 0; k < e->root_count; k++)
    if (!s->changes || stages_is_of_change(e, &e->roots[k]) == of_change)
      strip_store(e, &e->roots[k]);
  if (s->changes && !of_change) write_changes(e);
}

/* Whether a stage asks for anything but sizes: of bonds that exist. */
static bool asks_present(const emitter *e, const stages *s, int stage) {
  const expectations x = find_expectations(e, s);
  for (int k = 0; k < x.count; k++)
    if (x.stage[k] == stage && x.of[k].count == 0) return true;
  return false;
}

/* Whether the loop of a stage looks at arrays of the strip, not at buffers alone. */
static bool reads_bonds(const emitter *e, const stages *s, int stage, const unsigned char *mask,
                        const unsigned char *kept_loads) {
  bool reads = stage >= stages_last(s) || asks_present(e, s, stage);
  for (ir_node n = 0; n < e->node_count && !reads; n++) {
    const bool in_array = s->buffer[n] >= 0 && s->buffer[n] < s->result_arrays;
    reads = (mask[n] && expression_is_input(e, n)) ||
            (in_array && (kept_loads[n] || s->of[n] == stage));
  }
  return reads;
}

/* Forces that are computed in the last loop are dropped with the operation that makes them: where
   other lines need them, too, dropping them behind it would be an operation of its own. NULL in
   other loops. */
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
  expression_lines(e);
  e->relies = RELIES_ON_NOTHING;
  e->needed = whole;
}

static void write_stage(emitter *e, const stages *s, int stage, unsigned relies) {
  const size_t size = (size_t)e->node_count + 1;
  unsigned char *mask = must_alloc(size), *kept_loads = must_alloc(size);
  stages_mark(e, s, stage, relies, mask, kept_loads);
  say(e, SAY_OVER_PART);
  if (reads_bonds(e, s, stage, mask, kept_loads)) say(e, SAY_BOND_OF_PART);
  if (stage >= stages_last(s) || asks_present(e, s, stage)) say(e, SAY_PRESENT_OF_PART);
  write_kept_loads(e, s, kept_loads);
  e->dropped = drop_early(e, s, stage);
  write_lines_of(e, relies, mask);
  if (relies & RELIES_ON_EXPECTED) write_sizes(e, s, stage);
  write_kept_stores(e, s, stage);
  write_results(e, s, stage);
  say(e, SAY_END, "  ");
  free(e->dropped);
  e->dropped = NULL;
  free(mask);
  free(kept_loads);
}

/* A stage for strips that have protected bonds, and for those that have none: nearly all. */
static void write_stage_for_strip(emitter *e, const stages *s, int stage) {
  const bool asks = stages_ask_for_protection(e, s, stage);
  if (asks) say(e, SAY_IF_UNPROTECTED);
  write_stage(e, s, stage, RELIES_ON_EXPECTED | RELIES_ON_UNPROTECTED);
  if (!asks) return;
  say(e, SAY_IF_PROTECTED);
  write_stage(e, s, stage, RELIES_ON_EXPECTED);
  say(e, SAY_END, "  ");
}

void strip_cut_loops(emitter *e, const stages *s, const char *name) {
  const int buffers = buffer_count(e, s);
  if (buffers) say(e, SAY_KEEP_BUFFERS, numeral(e, buffers), numeral(e, STAGES_PITCH));
  say(e, SAY_OVER_PARTS, numeral(e, STAGES_PART));
  write_no_sizes(e, s);
  if (s->changes) say(e, SAY_NO_CHANGES);
  for (int stage = 0; stage <= stages_last(s); stage++) {
    if (stage == stages_last(s)) write_question(e, s, name);
    write_stage_for_strip(e, s, stage);
  }
  if (s->changes) {
    say(e, SAY_IF_CHANGED);
    write_stage(e, s, s->count - 1, RELIES_ON_NOTHING);
    say(e, SAY_END, "  ");
  }
  say(e, SAY_END, "  ");
}

/* --- what is not as expected ------------------------------------------------------------------ */

static const char *unexpected_name(const emitter *e, const char *name) {
  return spell(e, SAY_UNEXPECTED_NAME, name);
}

static const char *over_part(const emitter *e) {
  return spell(e, SAY_OVER_PART_OF_STRIP, numeral(e, STAGES_PITCH));
}

void strip_cut_declare(emitter *e, const char *name) {
  say(e, SAY_DECLARE_UNEXPECTED, unexpected_name(e, name), over_part(e));
}

/* Which groups have some bond that is not as expected: by sizes, which are computed once more, and
   by flags that wait. */
static void write_search(emitter *e, const stages *s, const expectations *x, unsigned char *mask) {
  const char *all = NULL;
  for (int k = 0; k < x->count; k++)
    if (x->of[k].count)
      all = words_join(e->memory, all, " && ",
                       arena_printf(e->memory, "(%s)", expression_condition(e, x->condition[k])));
  say(e, SAY_OVER_GROUPS, numeral(e, STAGES_PART / PL_LANES + 1));
  if (all) {
    say(e, SAY_SEARCH);
    write_lines_of(e, RELIES_ON_EXPECTED, mask);
    say(e, SAY_SEARCH_END, all);
  }
  for (int k = 0; k < x->count; k++)
    if (!x->of[k].count) say(e, SAY_SEARCH_KEPT_FLAGS, flag(e, s, x, k));
  say(e, SAY_OVER_UNEXPECTED);
}

/* Of what the last stage takes from buffers. */
typedef struct both_sides {
  unsigned char *kept;  /* [node_count] all of it */
  unsigned char *again; /* [node_count] that hangs on what is expected, */
  unsigned char *loads; /* [node_count] the rest that this is computed from, which is there, */
  unsigned char *lines; /* [node_count] and the lines between */
} both_sides;

static void mark_dependent(const emitter *e, unsigned char *marks) {
  for (ir_node n = 0; n < e->node_count; n++) {
    if (expression_is_uniform(e, n)) continue;
    marks[n] = choice_is_expected(e, n);
    for (int k = 0; k < ir_arity(ir_operation(e->graph, n)); k++)
      marks[n] |= marks[ir_operand(e->graph, n, k)];
  }
}

static both_sides both_sides_of(const emitter *e, const stages *s) {
  const size_t size = (size_t)e->node_count + 1;
  both_sides b = {must_calloc(size, 1), must_calloc(size, 1), must_calloc(size, 1),
                  must_calloc(size, 1)};
  stages_mark_kept(e, s, b.kept);
  mark_dependent(e, b.again);
  for (ir_node n = e->node_count - 1; n >= 0; n--) {
    b.again[n] &= b.kept[n];
    if (!b.lines[n] && !b.again[n]) continue;
    b.lines[n] = !b.kept[n] || b.again[n];
    b.loads[n] = !b.lines[n];
    ir_node operand[3];
    const int count = b.loads[n] ? 0 : choice_operands(e, n, RELIES_ON_NOTHING, operand);
    for (int k = 0; k < count; k++)
      b.lines[operand[k]] = 1;
  }
  return b;
}

static void both_sides_free(both_sides *b) {
  free(b->kept);
  free(b->again);
  free(b->loads);
  free(b->lines);
}

static void write_both_sides(emitter *e, const stages *s, const both_sides *b) {
  say(e, SAY_BOTH_SIDES);
  write_kept_loads(e, s, b->loads);
  write_lines_of(e, RELIES_ON_NOTHING, b->lines);
  for (ir_node n = 0; n < e->node_count; n++)
    if (b->again[n]) write_kept_store(e, s, n);
  say(e, SAY_BOTH_SIDES_END);
}

static void declare_result_arrays(emitter *e, const stages *s, const both_sides *b) {
  for (int k = 0; k < s->result_arrays; k++) {
    bool used = false;
    for (ir_node n = 0; n < e->node_count; n++)
      used |= (b->again[n] || b->loads[n]) && s->buffer[n] == k;
    if (used) strip_declare_array(e, root_of_array(e, k), spell(e, SAY_ARRAY_GIVEN, numeral(e, k)));
  }
}

void strip_cut_unexpected(emitter *e, const stages *s, const char *name) {
  const size_t size = (size_t)e->node_count + 1;
  unsigned char *asked = must_calloc(size, 1), *whole = e->needed;
  both_sides both = both_sides_of(e, s);
  const expectations x = find_expectations(e, s);
  for (int k = 0; k < x.count; k++)
    asked[x.condition[k]] = x.of[k].count > 0;
  choice_mark_operands(e, RELIES_ON_EXPECTED, asked);
  e->needed = must_calloc(size, 1);
  for (ir_node n = 0; n < e->node_count; n++)
    e->needed[n] = asked[n] | both.lines[n];
  kernel_function_begin(&e->parts, e->out, "PL_APART PL_PASS", unexpected_name(e, name),
                        over_part(e));
  say(e, SAY_UNEXPECTED_HEAD);
  strip_declare_protection(e);
  expression_declare(e);
  strip_declare_fields(e, false);
  declare_result_arrays(e, s, &both);
  write_search(e, s, &x, asked);
  write_both_sides(e, s, &both);
  kernel_function_end(&e->parts, e->out);
  free(e->needed);
  e->needed = whole;
  free(asked);
  both_sides_free(&both);
}

unsigned char *strip_cut_usually_needed(const emitter *e, const stages *s) {
  const size_t size = (size_t)e->node_count + 1;
  unsigned char *usual = must_calloc(size, 1), *mask = must_alloc(size), *loads = must_alloc(size);
  for (int stage = 0; stage < s->count; stage++) {
    stages_mark(e, s, stage, stage > stages_last(s) ? RELIES_ON_NOTHING : RELIES_ON_EXPECTED, mask,
                loads);
    for (ir_node n = 0; n < e->node_count; n++)
      usual[n] |= mask[n];
  }
  const expectations x = find_expectations(e, s);
  for (int k = 0; k < x.count; k++)
    if (x.of[k].count) usual[x.of[k].limit] = 1;
  free(mask);
  free(loads);
  return usual;
}
