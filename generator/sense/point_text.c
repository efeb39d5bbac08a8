#include "generator/sense/point_text.h"

#include <stdlib.h>
#include <string.h>

#include "dsl/base/arena.h"
#include "generator/lower/kinematics.h"
#include "generator/lower/lower_inputs.h"
#include "generator/lower/point_inputs.h"

static const double TIME_STEP = 1e-6; /* s */

bool point_text_open(point_text *t, point_bench *p) {
  const int fields = p->law->fields.count;
  *t = (point_text){.memory = arena_new(), .graph = ir_new()};
  if (!lower_law(&p->setting, t->graph, LOWER_STEP, t->memory, &t->step, p->said) ||
      !lower_law(&p->setting, t->graph, LOWER_FROZEN, t->memory, &t->frozen, p->said))
    return false;
  t->count = LOWERED_STRESSES + fields;
  ir_node *roots = arena_alloc(t->memory, (size_t)t->count * sizeof *roots);
  for (int k = 0; k < LOWERED_STRESSES; k++)
    roots[k] = t->frozen.sigma[k] == IR_NONE ? ir_constant(t->graph, 0) : t->frozen.sigma[k];
  memcpy(roots + LOWERED_STRESSES, t->step.text.rules, (size_t)fields * sizeof *roots);
  for (int k = 0; k < fields; k++)
    if (p->law->fields.items[k]->kind != SYMBOL_DAMAGE)
      roots[LOWERED_STRESSES + k] = t->step.fields[k];
  t->program = interpreter_new(t->graph, roots, t->count);
  t->room = must_calloc((size_t)t->count, sizeof *t->room);
  t->out = must_calloc((size_t)t->count, sizeof *t->out);
  t->field = must_calloc((size_t)fields + 1, sizeof *t->field);
  t->parameter = must_calloc((size_t)p->law->parameters.count + 1, sizeof *t->parameter);
  for (int k = 0; k < t->count; k++)
    t->out[k] = &t->room[k];
  return true;
}

void point_text_close(point_text *t) {
  if (t->program) interpreter_free(t->program);
  ir_free(t->graph);
  arena_free(t->memory);
  free(t->room);
  free(t->out);
  free(t->field);
  free(t->parameter);
}

void point_text_run(point_text *t, const point_bench *p, const double *strain, double *out) {
  static const double none = 0, step = TIME_STEP;
  double all[POINT_STRAINS] = {0};
  const double *point[POINT_INPUTS],
      *ends[ENDS_COUNT] = {[ENDS_TIME_STEP] = &step, [ENDS_ADVANCE] = &step};
  for (int k = 0; k < p->strains; k++)
    all[point_component(p->strains == 3 ? 2 : 3, k)] = strain[k];
  for (int k = 0; k < POINT_INPUTS; k++)
    point[k] = k < POINT_STRAINS ? &all[k] : k == POINT_CELL_SIZE ? &p->size[0] : &none;
  for (int k = 0; k < p->law->fields.count; k++)
    t->field[k] = &p->old_field[k][0];
  for (int k = 0; k < p->law->parameters.count; k++)
    t->parameter[k] = &p->parameters[k];
  const interpreter_inputs in = {.values = {[IR_FROM_PARAMETER] = t->parameter,
                                            [IR_FROM_FIELD] = t->field,
                                            [IR_FROM_ENDS] = ends,
                                            [IR_FROM_POINT] = point}};
  interpreter_run(t->program, &in, 1, t->out);
  memcpy(out, t->room, (size_t)t->count * sizeof *out);
}

bool point_text_moves(const point_text *t, const point_bench *p, int k) {
  const ir_node now = t->step.fields[k];
  return now != lower_field(t->graph, &p->setting, k) && !ir_is_uniform(t->graph, now);
}
