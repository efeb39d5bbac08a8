#include "generator/emit/strip_arrays.h"

#include <stdlib.h>

typedef enum absent_leaves { LEAVES_ZERO, LEAVES_OLD, LEAVES_SUM } absent_leaves;

static const struct {
  word member, name;
  absent_leaves absent;
} targets[] = {
    [TO_FORCE] = {SAY_STRIP_FORCE, SAY_FORCE_ARRAY, LEAVES_ZERO},
    [TO_FIELD] = {SAY_STRIP_FIELD, SAY_FIELD_ARRAY, LEAVES_OLD},
    [TO_DISSIPATED_STATE] = {SAY_STRIP_STATE_LOSS, SAY_STATE_LOSS_ARRAY, LEAVES_SUM},
    [TO_DISSIPATED_RATE] = {SAY_STRIP_RATE_LOSS, SAY_RATE_LOSS_ARRAY, LEAVES_SUM},
    [TO_GIVEN_BY_REST] = {SAY_STRIP_REST_GIFT, SAY_REST_GIFT_ARRAY, LEAVES_SUM},
    [TO_OBSERVED] = {SAY_STRIP_OBSERVED, SAY_OBSERVED_ARRAY, LEAVES_ZERO},
};

const char *strip_array(const emitter *e, const segment_root *r) {
  return spell(e, targets[r->target].name, numeral(e, r->index));
}

static const char *member_of(const emitter *e, const segment_root *r) {
  return spell(e, targets[r->target].member, numeral(e, r->index));
}

void strip_declare_array(emitter *e, const segment_root *r, const char *value) {
  say(e, SAY_DECLARE, "  ", spell(e, SAY_WRITTEN), strip_array(e, r), value);
}

void strip_declare_fields(emitter *e, bool only_read) {
  const int fields = e->plan->law->fields.count;
  unsigned char *read = must_calloc((size_t)fields + 1, 1);
  for (ir_node n = 0; n < e->node_count; n++)
    if (e->needed[n] && expression_is_input(e, n) && ir_input_source(e->graph, n) == IR_FROM_FIELD)
      read[ir_input_index(e->graph, n)] = 1;
  for (int k = 0; k < e->root_count && only_read; k++)
    if (e->roots[k].target == TO_FIELD) read[e->roots[k].index] = 0;
  for (int f = 0; f < fields; f++) {
    const segment_root field = {.target = TO_FIELD, .index = f};
    if (read[f])
      say(e, SAY_DECLARE, "  ", spell(e, SAY_READ), strip_array(e, &field), member_of(e, &field));
  }
  free(read);
}

void strip_declare_outputs(emitter *e) {
  strip_declare_fields(e, true);
  for (int k = 0; k < e->root_count; k++)
    strip_declare_array(e, &e->roots[k], member_of(e, &e->roots[k]));
}

void strip_declare_protection(emitter *e) {
  for (ir_node n = 0; n < e->node_count; n++)
    if (e->needed[n] && expression_is_ends_input(e, n, ENDS_PROTECTED)) {
      say(e, SAY_PROTECTED_BIT);
      return;
    }
}

void strip_store(emitter *e, const segment_root *r) {
  const char *at = spell(e, SAY_HERE, strip_array(e, r));
  if (e->dropped && e->dropped[r->node]) {
    say(e, SAY_STORE, "    ", at, e->name[r->node]);
    return;
  }
  const absent_leaves absent = targets[r->target].absent;
  const char *value = spell(e, SAY_CHOICE, spell(e, SAY_NOT_ABSENT), expression_value(e, r->node),
                            absent == LEAVES_OLD ? at : "0.0");
  say(e, absent == LEAVES_SUM ? SAY_ADD : SAY_STORE, "    ", at, value);
}

/* --- inputs ----------------------------------------------------------------------------------- */

/* A strip's fields are also written: strip_declare_outputs. */
static void declare(emitter *e, ir_node n) {
  static const char *const arrays[] = {
      [FROM_DISPLACEMENT] = "displacement", [FROM_VELOCITY] = "velocity", [FROM_CHORD] = "chord"};
  static const char *const ends[] = {[OF_I] = "_i", [OF_J] = "_j", [OF_BOND] = ""};
  const int index = ir_input_index(e->graph, n);
  const ir_source from = ir_input_source(e->graph, n);
  const char *array = spell(e, SAY_STRIP_PARAMETER, numeral(e, index));
  if (from == IR_FROM_FIELD || expression_is_ends_input(e, n, ENDS_PROTECTED)) return;
  if (expression_is_of_time(e, n)) {
    say(e, SAY_DECLARE, "  ", spell(e, SAY_VALUE), e->name[n],
        expression_time(e, n, SAY_STRIP_TIME_STEP, SAY_STRIP_ADVANCE));
    return;
  }
  if (from == IR_FROM_ENDS) {
    const ends_origin *o = &ends_origins[index];
    array = spell(e, SAY_STRIP_MOTION, arrays[o->array], ends[o->owner], numeral(e, o->component));
  }
  say(e, SAY_DECLARE, "  ", spell(e, SAY_READ), spell(e, SAY_INPUT_ARRAY, e->name[n]), array);
}

static const char *input(emitter *e, ir_node n) {
  const char *array = ir_input_source(e->graph, n) == IR_FROM_FIELD
                          ? spell(e, SAY_FIELD_ARRAY, numeral(e, ir_input_index(e->graph, n)))
                          : spell(e, SAY_INPUT_ARRAY, e->name[n]);
  return spell(e, SAY_HERE, array);
}

const scope scope_of_strips = {.before = "  ",
                               .indent = "    ",
                               .uniform = SAY_UNIFORM,
                               .strip = true,
                               .declare = declare,
                               .input = input};
