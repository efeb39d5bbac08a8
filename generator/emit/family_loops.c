#include "generator/emit/family_loops.h"

#include <stdlib.h>

#include "generator/emit/family_segment.h"

static const family_index in_loops = {.first = " + first",
                                      .k = "k",
                                      .back = "back",
                                      .to = "to",
                                      .link_to = "link_to",
                                      .owned = "owned",
                                      .owner = "owner"};

void family_loops_declare(emitter *e, ir_node n) {
  if (expression_is_of_time(e, n)) {
    say(e, SAY_DECLARE, e->scope->before, spell(e, SAY_VALUE), e->name[n],
        expression_time(e, n, SAY_FAMILY_TIME_STEP, SAY_FAMILY_ADVANCE));
    return;
  }
  say(e, SAY_DECLARE, e->scope->before,
      spell(e, family_is_protection(e, n) ? SAY_READ_BITS : SAY_READ),
      spell(e, SAY_INPUT_ARRAY, e->name[n]), family_input_array(e, n, &in_loops));
}

const char *family_loops_input(emitter *e, ir_node n) {
  const char *value = spell(e, SAY_HERE, spell(e, SAY_INPUT_ARRAY, e->name[n]));
  if (ir_input_source(e->graph, n) == IR_FROM_SHARED_ODD) return spell(e, SAY_SIGNED, value);
  return family_is_protection(e, n) ? spell(e, SAY_ANY_BIT, value) : value;
}

/* --- what stands before the loops ------------------------------------------------------------- */

void family_loops_start(emitter *e, const segment *a) {
  bool any = false;
  for (int k = 0; k < a->root_count; k++)
    any = any || family_root_is_reduction(&a->roots[k]);
  if (!any) return;
  say(e, SAY_START_SLOTS);
  for (int k = 0; k < a->root_count; k++)
    if (family_root_is_reduction(&a->roots[k]))
      say(e, SAY_STORE, "      ",
          spell(e, SAY_HERE, spell(e, SAY_SLOT, numeral(e, a->roots[k].index))),
          family_reduction_start(e, &a->roots[k]));
  say(e, SAY_END, "    ");
}

static void declare_outputs(emitter *e, const segment *a) {
  for (int k = 0; k < a->root_count; k++)
    say(e, SAY_DECLARE, e->scope->before, spell(e, SAY_WRITTEN),
        spell(e, SAY_ROOT_ARRAY, numeral(e, k)), family_root_array(e, &a->roots[k], &in_loops));
}

/* --- the loop over the particles of a chunk --------------------------------------------------- */

static void write_stores(emitter *e, const segment *a) {
  for (int k = 0; k < a->root_count; k++)
    family_store(e, &a->roots[k], spell(e, SAY_HERE, spell(e, SAY_ROOT_ARRAY, numeral(e, k))),
                 false);
}

/* With `expects` the loop notes where not all is as expected. */
static void write_lanes(emitter *e, const segment *a, bool expects) {
  say(e, SAY_OVER_LANES, e->scope->before);
  expression_lines(e);
  if (expects) say(e, SAY_GATHER_UNEXPECTED, family_expected(e), "1");
  if (a->kind != OVER_PARTICLES && family_segment_asks(a)) say(e, SAY_PRESENT_BY_BIT);
  write_stores(e, a);
  say(e, SAY_END, e->scope->before);
}

static void write_loop(emitter *e, const segment *a) {
  expression_declare(e);
  declare_outputs(e, a);
  write_lanes(e, a, false);
}

/* A loop that relies on what is expected, and the same with both sides where some particle of the
   chunk is not so. */
static void write_expected_loop(emitter *e, const segment *a) {
  ir_node *nodes = must_alloc((2 * (size_t)a->root_count + 1) * sizeof *nodes);
  const int count = segment_nodes(e->graph, a, nodes);
  expression_declare(e);
  declare_outputs(e, a);
  say(e, SAY_SOME_UNEXPECTED);
  unsigned char *before = family_narrow(e, nodes, count, RELIES_ON_EXPECTED);
  write_lanes(e, a, true);
  family_widen(e, before);
  say(e, SAY_IF_SOME_UNEXPECTED);
  write_lanes(e, a, false);
  say(e, SAY_END, "    ");
  free(nodes);
}

void family_loops_particles(emitter *e, const segment *a) {
  static const scope in = {.before = "    ",
                           .indent = "      ",
                           .uniform = SAY_UNIFORM,
                           .declare = family_loops_declare,
                           .input = family_loops_input};
  expression_open_segment(e, &in, a);
  say(e, SAY_OVER_PARTICLES);
  (family_expected(e) ? write_expected_loop : write_loop)(e, a);
  say(e, SAY_END, "    ");
  expression_close(e);
}

void family_loops_neighbours(emitter *e, const segment *a) {
  static const scope in = {.before = "      ",
                           .indent = "        ",
                           .uniform = SAY_UNIFORM_OF_NEIGHBOUR,
                           .declare = family_loops_declare,
                           .input = family_loops_input};
  expression_open_segment(e, &in, a);
  const bool odd = expression_reads(e, IR_FROM_SHARED_ODD);
  family_loops_start(e, a);
  say(e, a->kind == OVER_BONDS ? SAY_OVER_OWNED : SAY_OVER_NEIGHBOURS);
  say(e, SAY_WAY_OF_ROWS);
  if (family_segment_asks(a)) say(e, SAY_BONDS_OF_ROWS);
  if (odd) say(e, SAY_SIGN);
  if (odd || expression_reads(e, IR_FROM_SHARED)) say(e, SAY_OWNER);
  write_loop(e, a);
  say(e, SAY_END, "    ");
  expression_close(e);
}
