#include "generator/interpreter/lone_point.h"

#include <math.h>
#include <stdlib.h>

#include "dsl/base/arena.h"
#include "generator/ir/rewrite.h"
#include "generator/lower/lower.h"
#include "generator/lower/point_inputs.h"

static const double NONE = 0;

void lone_point_open(lone_point *p, const kernel_plan *of, const double *parameters,
                     const asked_point *at) {
  const law *l = of->law;
  *p = (lone_point){.point = must_calloc(POINT_INPUTS, sizeof *p->point),
                    .given = must_calloc((size_t)l->parameters.count + 1, sizeof *p->given),
                    .own = must_calloc((size_t)l->parameters.count + 1, sizeof *p->own),
                    .field = must_calloc((size_t)l->fields.count + 1, sizeof *p->field)};
  p->ends[ENDS_TIME_STEP] = &at->step;
  p->ends[ENDS_ADVANCE] = &at->advance;
  for (int k = 0; k < POINT_INPUTS; k++)
    p->point[k] = k == POINT_CELL_SIZE ? &at->size : &NONE;
  for (int k = 0; k < PL_STRAINS(of->dimensions); k++)
    p->point[POINT_STRAIN + point_component(of->dimensions, k)] = &at->strain[k];
  for (int k = 0; k < l->parameters.count; k++)
    p->given[k] = &parameters[k];
  for (int k = 0; k < of->variation.varying_count; k++)
    p->own[k] = &parameters[of->variation.varying[k]];
  for (int k = 0; k < l->fields.count; k++)
    p->field[k] = &at->field[k];
  p->in = (interpreter_inputs){.values = {[IR_FROM_PARAMETER] = p->given,
                                          [IR_FROM_BOND_PARAMETER] = p->own,
                                          [IR_FROM_FIELD] = p->field,
                                          [IR_FROM_ENDS] = p->ends,
                                          [IR_FROM_POINT] = p->point}};
}

void lone_point_close(lone_point *p) {
  free(p->point);
  free(p->given);
  free(p->own);
  free(p->field);
}

static double reach_of(const lone_point *p) {
  double size = 0;
  for (int k = 0; k < POINT_STRAINS; k++)
    size += fabs(*p->point[POINT_STRAIN + k]);
  return 4 * size;
}

static along_z look_along(lone_point *p, interpreter *program) {
  enum { STEPS = 800, ZZ = POINT_STRAIN + 2 };
  const double *kept = p->point[ZZ];
  double z, stress = NAN, *out = &stress, before = NAN;
  along_z seen = {0, NAN, reach_of(p), NAN, NAN};
  p->point[ZZ] = &z;
  for (int k = 0; k <= STEPS; k++, before = stress) {
    z = seen.reach * (2.0 * k / STEPS - 1);
    interpreter_run(program, &p->in, 1, &out);
    if (isfinite(stress) && !(fabs(stress) >= seen.least)) {
      seen.least = fabs(stress);
      seen.least_at = z;
    }
    const bool zero = stress == 0 && before != 0; /* of a range that is without stress one */
    if ((zero || before * stress < 0) && !seen.roots++) seen.root = z;
  }
  p->point[ZZ] = kept;
  return seen;
}

along_z lone_point_along_z(lone_point *p, const law *l) {
  arena *memory = arena_new();
  ir *graph = ir_new();
  diagnostics said = {0};
  lowered_law step;
  along_z seen = {1, 0, NAN, NAN, NAN};
  const ir_node z = lower_point_strain(graph, l, 2, false);
  if (lower_law(l, graph, LOWER_STEP, memory, &step, &said) &&
      rewrite_depends(graph, &step.sigma[2], 1, &z, 1)) {
    interpreter *program = interpreter_new(graph, &step.sigma[2], 1);
    seen = look_along(p, program);
    interpreter_free(program);
  }
  ir_free(graph);
  arena_free(memory);
  return seen;
}
