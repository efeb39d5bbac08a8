#include "generator/emit/point_loops.h"

#include <stdlib.h>
#include <string.h>

#include "generator/emit/family_segment.h"
#include "generator/lower/point_inputs.h"
#include "generator/plan/plan_points.h"

/* --- inputs ----------------------------------------------------------------------------------- */

static bool is_rate(int input) {
  return input >= POINT_STRAIN_RATE;
}

/* Of a strain or its rate, among those that the kernel has. */
static const char *component(emitter *e, int input) {
  int at = 0;
  while (point_component(e->plan->dimensions, at) != input % POINT_STRAINS)
    at++;
  return numeral(e, at);
}

static const char *array_of_point(emitter *e, int input) {
  if (input == POINT_CELL_SIZE) return spell(e, SAY_POINT_SIZE);
  return spell(e, is_rate(input) ? SAY_POINT_RATE : SAY_POINT_STRAIN, component(e, input));
}

static const char *array_of_input(emitter *e, ir_node n) {
  const int index = ir_input_index(e->graph, n);
  switch (ir_input_source(e->graph, n)) {
  case IR_FROM_POINT:
    return array_of_point(e, index);
  case IR_FROM_TIP:
    return spell(e, SAY_TIP_INPUT, numeral(e, index));
  case IR_FROM_FIELD:
    return spell(e, SAY_POINT_OLD_FIELD, numeral(e, index));
  default:
    return spell(e, SAY_POINT_PARAMETER, numeral(e, index));
  }
}

static void declare(emitter *e, ir_node n) {
  if (ir_is_sought(e->graph, n)) return;
  if (expression_is_of_time(e, n))
    say(e, SAY_DECLARE, "  ", spell(e, SAY_VALUE), e->name[n],
        expression_time(e, n, SAY_POINT_TIME_STEP, SAY_POINT_ADVANCE));
  else
    say(e, SAY_DECLARE, "  ", spell(e, SAY_READ), spell(e, SAY_INPUT_ARRAY, e->name[n]),
        array_of_input(e, n));
}

/* Searches of a program one after the other; what they and what follows them take from before. */
typedef struct searches {
  ir_node *of;         /* [count] */
  int count, now;      /* the one that is written */
  int *kept;           /* [node_count] number of the array where a value waits for a search; -1 */
  unsigned char *mask; /* [node_count] lines of a loop */
} searches;

static int number_of_search(const searches *s, ir_node n) {
  int k = 0;
  while (s->of[k] != n)
    k++;
  return k;
}

static const char *input(emitter *e, ir_node n) {
  const searches *s = e->form;
  if (ir_is_sought(e->graph, n)) return spell(e, SAY_SEARCH_RESULT, numeral(e, s->now));
  if (ir_operation(e->graph, n) == IR_SEARCH)
    return spell(e, SAY_SEARCH_RESULT, numeral(e, number_of_search(s, n)));
  return spell(e, SAY_HERE, spell(e, SAY_INPUT_ARRAY, e->name[n]));
}

static const scope of_points = {
    .before = "  ", .indent = "    ", .uniform = SAY_UNIFORM, .declare = declare, .input = input};

/* --- results ---------------------------------------------------------------------------------- */

static const char *array_of_root(emitter *e, const segment_root *r) {
  static const word members[] = {
      [TO_FORCE] = SAY_POINT_STRESS,          [TO_FIELD] = SAY_POINT_NEW_FIELD,
      [TO_DISSIPATED_STATE] = SAY_POINT_LOST, [TO_DISSIPATED_RATE] = SAY_POINT_LOST,
      [TO_GIVEN_BY_REST] = SAY_POINT_LOST,    [TO_OBSERVED] = SAY_POINT_OBSERVED,
      [TO_TANGENT] = SAY_POINT_TANGENT,       [TO_OUT] = SAY_TIP_OUT};
  return spell(e, members[r->target], numeral(e, r->index));
}

/* To where result k goes, in the words of its kind: what adds to what is lost waits where it may be
   computed again. */
static void write_result(emitter *e, const segment_root *r, int k, bool again) {
  const bool adds = segment_is_loss(r);
  const char *to = adds && again ? spell(e, SAY_LOSS_THAT_WAITS, numeral(e, k))
                                 : spell(e, SAY_HERE, spell(e, SAY_RESULT_ARRAY, numeral(e, k)));
  say(e, adds && !again ? SAY_ADD : SAY_STORE, "    ", to, expression_whole(e, r->node));
}

static void write_results(emitter *e, const segment *a, bool again) {
  for (int k = 0; k < a->root_count; k++)
    write_result(e, &a->roots[k], k, again);
}

/* --- what is expected ------------------------------------------------------------------------- */

/* Writes the body of a loop, whose roots are computed there. */
typedef void (*body_writer)(emitter *e, const segment *a, bool expects);

static void open_losses(emitter *e, const segment *a) {
  for (int k = 0; k < a->root_count; k++)
    if (segment_is_loss(&a->roots[k])) say(e, SAY_LOSS_WAITS, numeral(e, k));
}

static void add_losses(emitter *e, const segment *a) {
  bool any = false;
  for (int k = 0; k < a->root_count; k++)
    any = any || segment_is_loss(&a->roots[k]);
  if (!any) return;
  say(e, SAY_SEARCH_LOOP);
  for (int k = 0; k < a->root_count; k++)
    if (segment_is_loss(&a->roots[k]))
      say(e, SAY_ADD, "    ", spell(e, SAY_HERE, spell(e, SAY_RESULT_ARRAY, numeral(e, k))),
          spell(e, SAY_LOSS_THAT_WAITS, numeral(e, k)));
  say(e, SAY_END, "  ");
}

/* The loop over a block that relies on what is expected, and the whole of it again where some point
   is not so. */
static void write_twice(emitter *e, const segment *a, body_writer loop) {
  ir_node *nodes = segment_values(a);
  open_losses(e, a);
  say(e, SAY_SOME_UNEXPECTED);
  unsigned char *before = family_narrow(e, nodes, a->root_count, RELIES_ON_EXPECTED);
  loop(e, a, true);
  family_widen(e, before);
  say(e, SAY_IF_SOME_UNEXPECTED);
  loop(e, a, false);
  say(e, SAY_END, "    ");
  add_losses(e, a);
  free(nodes);
}

static void gather_unexpected(emitter *e) {
  say(e, SAY_GATHER_UNEXPECTED, family_expected(e), "1");
}

/* --- searches --------------------------------------------------------------------------------- */

enum { SEARCH_BLOCK = 64, EXPECTED_BLOCK = 32 };

static searches searches_of(const emitter *e) {
  const size_t size = (size_t)e->node_count + 1;
  searches s = {must_alloc(size * sizeof *s.of), 0, 0, must_alloc(size * sizeof *s.kept),
                must_calloc(size, 1)};
  for (ir_node n = 0; n < e->node_count; n++)
    if (e->needed[n] && ir_operation(e->graph, n) == IR_SEARCH) s.of[s.count++] = n;
  return s;
}

static void searches_free(searches *s) {
  free(s->of);
  free(s->kept);
  free(s->mask);
}

static bool is_leaf(const emitter *e, ir_node n) {
  return expression_is_uniform(e, n) || expression_is_of_time(e, n) ||
         ir_arity(ir_operation(e->graph, n)) == 0 || ir_operation(e->graph, n) == IR_SEARCH;
}

/* Adds to the mask what its nodes need, down to searches and to what is kept. */
static void spread(const emitter *e, searches *s) {
  for (ir_node n = e->node_count - 1; n >= 0; n--)
    for (int k = 0;
         s->mask[n] && !is_leaf(e, n) && s->kept[n] < 0 && k < ir_arity(ir_operation(e->graph, n));
         k++)
      s->mask[ir_operand(e->graph, n, k)] = 1;
}

static void write_lines(emitter *e, const searches *s) {
  for (int k = 0; k < e->node_count; k++) {
    const ir_node n = expression_in_order(e, k);
    if (s->mask[n] && s->kept[n] >= 0)
      say(e, SAY_LINE, "    ", e->name[n], spell(e, SAY_SEARCH_KEPT, numeral(e, s->kept[n])),
          expression_line_end(e, n));
    else if (s->mask[n])
      expression_line(e, n);
  }
}

/* What its steps take that does not change from step to step, and where it begins. */
static void write_start(emitter *e, searches *s, const char *found) {
  const ir_node n = s->of[s->now];
  unsigned char *changing = must_calloc((size_t)e->node_count + 1, 1);
  int *kept = must_alloc(((size_t)e->node_count + 1) * sizeof *kept), count = 0;
  changing[ir_operand(e->graph, n, 1)] = changing[ir_operand(e->graph, n, 2)] = 1;
  memset(s->mask, 0, (size_t)e->node_count + 1);
  s->mask[ir_operand(e->graph, n, 0)] = 1;
  for (ir_node k = e->node_count - 1; k >= 0; k--) {
    kept[k] = -1;
    if (!changing[k] || is_leaf(e, k)) continue;
    if (!ir_is_sought(e->graph, k) && e->name[k]) {
      s->mask[k] = 1;
      kept[k] = count++;
      say(e, SAY_SEARCH_KEEP, numeral(e, kept[k]));
      continue;
    }
    for (int o = 0; o < ir_arity(ir_operation(e->graph, k)); o++)
      changing[ir_operand(e->graph, k, o)] = 1;
  }
  spread(e, s);
  say(e, SAY_SEARCH_LOOP);
  write_lines(e, s);
  for (ir_node k = 0; k < e->node_count; k++)
    if (kept[k] >= 0)
      say(e, SAY_STORE, "    ", spell(e, SAY_SEARCH_KEPT, numeral(e, kept[k])), e->name[k]);
  say(e, SAY_SEARCH_START, expression_whole(e, ir_operand(e->graph, n, 0)), found);
  say(e, SAY_END, "  ");
  memcpy(s->kept, kept, (size_t)e->node_count * sizeof *kept);
  free(changing);
  free(kept);
}

static void forget_kept(const emitter *e, searches *s) {
  for (ir_node n = 0; n <= e->node_count; n++)
    s->kept[n] = -1;
  memset(s->mask, 0, (size_t)e->node_count + 1);
}

static void write_search(emitter *e, searches *s) {
  const ir_node n = s->of[s->now];
  const char *found = spell(e, SAY_SEARCH_RESULT, numeral(e, s->now));
  say(e, SAY_SEARCH_FOUND, numeral(e, s->now));
  say(e, SAY_SEARCH_BEGIN);
  say(e, SAY_SEARCH_PLACES);
  write_start(e, s, found);
  memset(s->mask, 0, (size_t)e->node_count + 1);
  s->mask[ir_operand(e->graph, n, 1)] = s->mask[ir_operand(e->graph, n, 2)] = 1;
  spread(e, s);
  say(e, SAY_SEARCH_STEPS);
  say(e, SAY_SEARCH_LOOP);
  write_lines(e, s);
  say(e, SAY_SEARCH_STEP, found, expression_whole(e, ir_operand(e->graph, n, 1)),
      expression_whole(e, ir_operand(e->graph, n, 2)));
  say(e, SAY_END, "  ");
  say(e, SAY_END, "  ");
  say(e, SAY_END, "  ");
  forget_kept(e, s);
}

/* Block by block: its searches, then the rest. */
static void write_blocks(emitter *e, const segment *a, searches *s) {
  say(e, SAY_SEARCH_BLOCKS, numeral(e, SEARCH_BLOCK));
  for (s->now = 0; s->now < s->count; s->now++)
    write_search(e, s);
  for (int k = 0; k < a->root_count; k++)
    s->mask[a->roots[k].node] = 1;
  spread(e, s);
  say(e, SAY_SEARCH_LOOP);
  write_lines(e, s);
  write_results(e, a, false);
  say(e, SAY_END, "  ");
  say(e, SAY_END, "  ");
}

/* --- programs --------------------------------------------------------------------------------- */

static void write_loop_of_block(emitter *e, const segment *a, bool expects) {
  say(e, SAY_SEARCH_LOOP);
  expression_lines(e);
  if (expects) gather_unexpected(e);
  write_results(e, a, true);
  say(e, SAY_END, "  ");
}

static void write_expected(emitter *e, const segment *a) {
  say(e, SAY_SEARCH_BLOCKS, numeral(e, EXPECTED_BLOCK));
  write_twice(e, a, write_loop_of_block);
  say(e, SAY_END, "  ");
}

static void write_program(emitter *e, const segment *a, const char *name) {
  expression_open_segment(e, &of_points, a);
  searches s = searches_of(e);
  e->form = &s;
  forget_kept(e, &s);
  kernel_function_begin(&e->parts, e->out, "PL_PASS", name,
                        spell(e, e->plan->form == FORM_TIPS ? SAY_OVER_TIPS : SAY_OVER_POINTS));
  say(e, SAY_POINTS_HEAD);
  expression_declare(e);
  for (int k = 0; k < a->root_count; k++)
    say(e, SAY_DECLARE, "  ", spell(e, SAY_WRITTEN), spell(e, SAY_RESULT_ARRAY, numeral(e, k)),
        array_of_root(e, &a->roots[k]));
  if (s.count) {
    write_blocks(e, a, &s);
  } else if (family_expected(e)) {
    write_expected(e, a);
  } else {
    say(e, SAY_OVER_BONDS);
    expression_lines(e);
    write_results(e, a, false);
    say(e, SAY_END, "  ");
  }
  kernel_function_end(&e->parts, e->out);
  expression_close(e);
  searches_free(&s);
}

/* --- rectangles ------------------------------------------------------------------------------- */

static bool is_strain(const emitter *e, ir_node n) {
  return ir_operation(e->graph, n) == IR_INPUT && ir_input_source(e->graph, n) == IR_FROM_POINT &&
         ir_input_index(e->graph, n) != POINT_CELL_SIZE;
}

static void declare_beside_strains(emitter *e, ir_node n) {
  if (!is_strain(e, n)) declare(e, n);
}

static const char *input_of_rectangle(emitter *e, ir_node n) {
  const int index = is_strain(e, n) ? ir_input_index(e->graph, n) : 0;
  return is_strain(e, n) ? spell(e, SAY_RECTANGLE_VALUE,
                                 is_rate(index) ? "cell_rate" : "cell_strain", component(e, index))
                         : input(e, n);
}

static const scope of_rectangles = {.before = "  ",
                                    .indent = "    ",
                                    .uniform = SAY_UNIFORM,
                                    .declare = declare_beside_strains,
                                    .input = input_of_rectangle};

/* Stress along z pushes no node, and a field that is the same at all times is there already. */
static bool counts_in_rectangle(const emitter *e, const segment_root *r) {
  if (r->target == TO_FORCE) return r->index < 3;
  return r->target != TO_FIELD ||
         !ir_is_number(e->graph, r->node, e->plan->law->fields.items[r->index]->initial);
}

static segment of_rectangle(const emitter *e, const segment *a) {
  segment out = *a;
  out.root_count = 0;
  out.roots = arena_alloc(e->memory, ((size_t)a->root_count + 1) * sizeof *out.roots);
  for (int k = 0; k < a->root_count; k++)
    if (counts_in_rectangle(e, &a->roots[k])) out.roots[out.root_count++] = a->roots[k];
  return out;
}

static void write_results_of_rectangle(emitter *e, const segment *a, bool again) {
  for (int k = 0; k < a->root_count; k++) {
    const segment_root *r = &a->roots[k];
    if (r->target == TO_FORCE)
      say(e, SAY_STORE, "    ", spell(e, SAY_RECTANGLE_VALUE, "cell_stress", numeral(e, r->index)),
          expression_whole(e, r->node));
    else
      write_result(e, r, k, again);
  }
}

enum { AXES = 2 };

static bool reads_rates(const emitter *e) {
  bool rates = false;
  for (ir_node n = 0; n < e->node_count; n++)
    rates = rates || (e->needed[n] && is_strain(e, n) && is_rate(ir_input_index(e->graph, n)));
  return rates;
}

/* The rectangles of a vector: their strains, their points, what these push. */
static void write_vector(emitter *e, const segment *a, bool rates, bool expects, bool again) {
  say(e, SAY_RECTANGLE_LANES);
  say(e, SAY_RECTANGLE_STRAINS, "cell_strain");
  if (rates) say(e, SAY_RECTANGLE_STRAINS, "cell_rate");
  say(e, SAY_RECTANGLE_POINTS);
  expression_lines(e);
  if (expects) gather_unexpected(e);
  write_results_of_rectangle(e, a, again);
  say(e, SAY_END, "    ");
  say(e, SAY_RECTANGLE_PUSH);
  for (int d = 0; d < AXES; d++)
    say(e, SAY_RECTANGLE_STORE, numeral(e, d));
  say(e, SAY_END, "  ");
}

static void write_vector_again(emitter *e, const segment *a, bool expects) {
  write_vector(e, a, reads_rates(e), expects, true);
}

static void write_rectangles(emitter *e, const segment *of, const char *name) {
  const segment a = of_rectangle(e, of);
  expression_open_segment(e, &of_rectangles, &a);
  e->form = NULL; /* no searches */
  const bool rates = reads_rates(e);
  kernel_function_begin(&e->parts, e->out, "PL_PASS", name, spell(e, SAY_OVER_RECTANGLES));
  say(e, SAY_RECTANGLES_HEAD);
  say(e, SAY_RECTANGLE_FIELD, "cell_strain", "displacement");
  if (rates) say(e, SAY_RECTANGLE_FIELD, "cell_rate", "velocity");
  expression_declare(e);
  for (int k = 0; k < a.root_count; k++)
    if (a.roots[k].target != TO_FORCE)
      say(e, SAY_DECLARE, "  ", spell(e, SAY_WRITTEN), spell(e, SAY_RESULT_ARRAY, numeral(e, k)),
          array_of_root(e, &a.roots[k]));
  for (int d = 0; d < AXES; d++)
    say(e, SAY_RECTANGLE_FORCE, numeral(e, d));
  say(e, SAY_RECTANGLE_LOOP);
  if (family_expected(e))
    write_twice(e, &a, write_vector_again);
  else
    write_vector(e, &a, rates, false, false);
  for (int d = 0; d < AXES; d++)
    say(e, SAY_RECTANGLE_SUM, numeral(e, d));
  say(e, SAY_END, "  ");
  for (int d = 0; d < AXES; d++)
    say(e, SAY_RECTANGLE_END, numeral(e, d));
  kernel_function_end(&e->parts, e->out);
  expression_close(e);
}

void point_loops(emitter *e) {
  if (e->plan->form == FORM_TIPS) {
#define X(task, member) write_program(e, plan_segment(e->plan, task), #member);
    TIP_PROGRAMS(X)
#undef X
    return;
  }
#define X(task, member) write_program(e, plan_segment(e->plan, task), #member);
  POINT_PROGRAMS(X)
#undef X
  if (!plan_has_rectangles(e->plan)) return;
#define X(task, member) write_rectangles(e, plan_segment(e->plan, task), #member);
  RECTANGLE_PROGRAMS(X)
#undef X
}
