#include "generator/emit/law_functions.h"

#include <assert.h>
#include <stdlib.h>

#include "generator/lower/law_inputs.h"

/* --- the law alone ---------------------------------------------------------------------------- */

/* What differs from bond to bond and is no class's is of its motion. */
static int motion_plane(int quantity) {
  const int plane = law_motion_place((builtin_quantity)quantity);
  assert(plane >= 0);
  return plane;
}

static void declare_state(emitter *e, ir_node n) {
  const int index = ir_input_index(e->graph, n);
  const bool field = ir_input_source(e->graph, n) == IR_FROM_FIELD;
  const char *array = field ? spell(e, SAY_STATE_FIELD, numeral(e, index))
                            : spell(e, SAY_STATE_INPUT, numeral(e, motion_plane(index)));
  say(e, SAY_DECLARE, "  ", spell(e, SAY_READ), spell(e, SAY_INPUT_ARRAY, e->name[n]), array);
}

static const char *state(emitter *e, ir_node n) {
  return spell(e, SAY_HERE, spell(e, SAY_INPUT_ARRAY, e->name[n]));
}

static const scope of_states = {.before = "  ",
                                .indent = "    ",
                                .uniform = SAY_UNIFORM,
                                .declare = declare_state,
                                .input = state};

/* Results first, then new fields. Planes without a root (moments of a central law) are zero. */
static void write_states(emitter *e, program_task task, int results, int fields) {
  const int planes = results + fields;
  expression_open_segment(e, &of_states, plan_segment(e->plan, task));
  kernel_function_begin(&e->parts, e->out, "PL_RARE PL_PASS", e->plan->programs[task].name,
                        spell(e, SAY_OVER_STATES));
  say(e, SAY_STATES_HEAD);
  expression_declare(e);
  for (int k = 0; k < planes; k++) {
    const char *array = k < results ? spell(e, SAY_STATE_RESULT, numeral(e, k))
                                    : spell(e, SAY_STATE_NEW_FIELD, numeral(e, k - results));
    say(e, SAY_DECLARE, "  ", spell(e, SAY_WRITTEN), spell(e, SAY_RESULT_ARRAY, numeral(e, k)),
        array);
  }
  say(e, SAY_OVER_BONDS);
  expression_lines(e);
  for (int k = 0; k < planes; k++) {
    const segment_root *r = expression_find_root(e, TO_OUT, k);
    say(e, SAY_STORE, "    ", spell(e, SAY_HERE, spell(e, SAY_RESULT_ARRAY, numeral(e, k))),
        r ? expression_whole(e, r->node) : "0.0");
  }
  say(e, SAY_END, "  ");
  kernel_function_end(&e->parts, e->out);
  expression_close(e);
}

void law_functions_of_states(emitter *e) {
  write_states(e, PROGRAM_STATES, PL_STATE_RESULTS, e->plan->law->fields.count);
  write_states(e, PROGRAM_TANGENT, PL_TANGENTS, 0);
}

/* --- parameters ------------------------------------------------------------------------------- */

/* Values of a bond class, as C. */
static const char *const class_values[QUANTITY_COUNT] = {
#define X(code, value) [QUANTITY_##code] = #value,
    CLASS_QUANTITIES(X)
#undef X
};

static const char *parameter(emitter *e, ir_node n) {
  const int index = ir_input_index(e->graph, n);
  switch (ir_input_source(e->graph, n)) {
  case IR_FROM_PARAMETER:
    return spell(e, SAY_PARAMETER, numeral(e, index));
  case IR_FROM_ENDS:
    return spell(e, SAY_CLASS_CHORD, numeral(e, ends_origins[index].component));
  default:
    return class_values[index];
  }
}

static const scope of_parameters = {.indent = "  ", .input = parameter};

static void write_prepare(emitter *e) {
  const int count = e->plan->uniform_count;
  const ir_node *uniforms = e->plan->uniforms;
  expression_open(e, &of_parameters, uniforms, count);
  say(e, SAY_PREPARE);
  expression_lines(e);
  for (int k = 0; k < count; k++)
    say(e, SAY_STORE, "  ", spell(e, SAY_UNIFORM, numeral(e, k)), expression_whole(e, uniforms[k]));
  say(e, SAY_LAST_END);
  expression_close(e);
}

/* `lower[3] = 0.0, low_open[3] = 1;` */
static void write_bound(emitter *e, int number, int at, segment_target target, bool is_open) {
  const segment_root *r = expression_find_root(e, target, number);
  const bool lower = target == TO_LOWER;
  const char *nowhere = spell(e, lower ? SAY_BELOW_ALL : SAY_ABOVE_ALL);
  say(e, lower ? SAY_LOWER_BOUND : SAY_UPPER_BOUND, numeral(e, at),
      r ? expression_whole(e, r->node) : nowhere, numeral(e, !r || is_open));
}

static void open_bounds(emitter *e, program_task task) {
  expression_open_segment(e, &of_parameters, plan_segment(e->plan, task));
  say(e, SAY_BOUNDS, e->plan->programs[task].name);
  expression_lines(e);
}

static void write_bounds(emitter *e) {
  const symbol_list *parameters = &e->plan->law->parameters;
  open_bounds(e, PROGRAM_BOUNDS);
  for (int k = 0; k < parameters->count; k++) {
    const bounds *in = &parameters->items[k]->declared->in;
    write_bound(e, k, k, TO_LOWER, in->lower_open);
    write_bound(e, k, k, TO_UPPER, in->upper_open);
  }
  say(e, SAY_LAST_END);
  expression_close(e);
}

static void write_size_bounds(emitter *e) {
  const stmt *sized = e->plan->law->sized;
  if (!sized) return;
  open_bounds(e, PROGRAM_SIZE_BOUNDS);
  write_bound(e, e->plan->law->parameters.count, 0, TO_LOWER, sized->in.lower_open);
  write_bound(e, e->plan->law->parameters.count, 0, TO_UPPER, sized->in.upper_open);
  say(e, SAY_LAST_END);
  expression_close(e);
}

static void write_defaults(emitter *e) {
  if (!e->plan->programs[PROGRAM_DEFAULTS].pass_count) return;
  expression_open_segment(e, &of_parameters, plan_segment(e->plan, PROGRAM_DEFAULTS));
  say(e, SAY_DEFAULTS);
  expression_lines(e);
  for (int k = 0; k < e->root_count; k++)
    say(e, SAY_STORE, "  ", spell(e, SAY_DEFAULT, numeral(e, e->roots[k].index)),
        expression_whole(e, e->roots[k].node));
  say(e, SAY_LAST_END);
  expression_close(e);
}

void law_functions_of_parameters(emitter *e) {
  write_prepare(e);
  write_defaults(e);
  write_bounds(e);
  write_size_bounds(e);
}
