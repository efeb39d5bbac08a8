/* One caller's working space on the interpreter: the segments of a plan, ready to be evaluated, and
   where the inputs of their nodes stand. */
#ifndef PERILAT_GENERATOR_RUNNER_H
#define PERILAT_GENERATOR_RUNNER_H

#include "generator/ir/interpret.h"
#include "generator/plan/plan.h"

enum { RUNNER_LANES = INTERPRET_LANES, RUNNER_NEIGHBOURS = 2 * PL_MAX_DIRECTIONS };

typedef struct runner {
  const kernel_plan *plan;
  arena *memory;
  interpreter ***run[PROGRAM_COUNT]; /* [pass][segment]; NULL: of a segment without roots */
  interpreter *prepare;              /* of the uniforms; NULL: there are none */
  /* [source][index] where values begin, for interpreter_inputs; uniforms behind the parameters */
  const double **at[IR_SOURCE_COUNT];
  interpreter_inputs in;
  double of_class[QUANTITY_COUNT];
  /* [OF_I, OF_J] inputs that are displacements and velocities of particles of a family */
  int motion[2][ENDS_COUNT], motion_count[2];
  double protection[2][RUNNER_LANES]; /* of the bond, or of the particle; of its neighbour */
  double *space;                      /* of what follows */
  double *slot;                       /* [slots][RUNNER_LANES] */
  double *plane;                      /* [planes][RUNNER_NEIGHBOURS][RUNNER_LANES] */
  /* [2 links of bonds][RUNNER_LANES] shared values as the far end has them, when their sign
     differs */
  double *opposite;
  double *gathered; /* [most][RUNNER_LANES] values of neighbours, on lists */
  int gathered_count;
  double **result; /* [most nodes of a segment][RUNNER_LANES] */
} runner;

/* inputs[k] is the input node that stands for uniform k. The plan must outlive the runner. */
runner *runner_new(const kernel_plan *p, const ir_node *inputs);
void runner_free(runner *r);

/* interpreter_watch of all of its segments. */
void runner_watch(runner *r, interpreter_look *look, void *context);

/* From here on parameters, or uniforms, are those. */
void runner_take_parameters(runner *r, const double *parameters);
void runner_take_uniforms(runner *r, const double *uniforms);

#endif
