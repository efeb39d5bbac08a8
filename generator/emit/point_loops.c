#include "generator/emit/point_loops.h"

#include "generator/lower/point_inputs.h"

/* --- inputs ----------------------------------------------------------------------------------- */

static const char *array_of_point(emitter *e, int input) {
  const int dimensions = e->plan->dimensions;
  if (input == POINT_CELL_SIZE) return spell(e, SAY_POINT_SIZE);
  const bool rate = input >= POINT_STRAIN_RATE;
  int at = 0;
  while (point_component(dimensions, at) != input % POINT_STRAINS)
    at++;
  return spell(e, rate ? SAY_POINT_RATE : SAY_POINT_STRAIN, numeral(e, at));
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
  if (expression_is_ends_input(e, n, ENDS_TIME_STEP))
    say(e, SAY_DECLARE, "  ", spell(e, SAY_VALUE), e->name[n], spell(e, SAY_POINT_TIME_STEP));
  else
    say(e, SAY_DECLARE, "  ", spell(e, SAY_READ), spell(e, SAY_INPUT_ARRAY, e->name[n]),
        array_of_input(e, n));
}

static const char *input(emitter *e, ir_node n) {
  return spell(e, SAY_HERE, spell(e, SAY_INPUT_ARRAY, e->name[n]));
}

static const scope of_points = {
    .before = "  ", .indent = "    ", .uniform = SAY_UNIFORM, .declare = declare, .input = input};

/* --- results ---------------------------------------------------------------------------------- */

static const char *array_of_root(emitter *e, const segment_root *r) {
  static const word members[] = {[TO_FORCE] = SAY_POINT_STRESS,
                                 [TO_FIELD] = SAY_POINT_NEW_FIELD,
                                 [TO_DISSIPATED_STATE] = SAY_POINT_LOST,
                                 [TO_DISSIPATED_RATE] = SAY_POINT_LOST,
                                 [TO_OBSERVED] = SAY_POINT_OBSERVED,
                                 [TO_TANGENT] = SAY_POINT_TANGENT,
                                 [TO_OUT] = SAY_TIP_OUT};
  return spell(e, members[r->target], numeral(e, r->index));
}

static void write_program(emitter *e, const segment *a, const char *name) {
  expression_open_segment(e, &of_points, a);
  kernel_function_begin(&e->parts, e->out, "PL_PASS", name,
                        spell(e, e->plan->form == FORM_TIPS ? SAY_OVER_TIPS : SAY_OVER_POINTS));
  say(e, SAY_POINTS_HEAD);
  expression_declare(e);
  for (int k = 0; k < a->root_count; k++)
    say(e, SAY_DECLARE, "  ", spell(e, SAY_WRITTEN), spell(e, SAY_RESULT_ARRAY, numeral(e, k)),
        array_of_root(e, &a->roots[k]));
  say(e, SAY_OVER_BONDS);
  expression_lines(e);
  for (int k = 0; k < a->root_count; k++)
    say(e, segment_is_loss(&a->roots[k]) ? SAY_ADD : SAY_STORE, "    ",
        spell(e, SAY_HERE, spell(e, SAY_RESULT_ARRAY, numeral(e, k))),
        expression_whole(e, a->roots[k].node));
  say(e, SAY_END, "  ");
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
}
