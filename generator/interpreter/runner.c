#include "generator/interpreter/runner.h"

#include <stdlib.h>
#include <string.h>

#include "dsl/base/arena.h"
#include "generator/lower/law_inputs.h"
#include "generator/lower/point_inputs.h"

/* What the passes of a plan keep for themselves, the most. */
typedef struct needs {
  int slots, planes, nodes;
} needs;

static int larger(int a, int b) {
  return a > b ? a : b;
}

/* --- interpreters ----------------------------------------------------------------------------- */

/* With inputs in place of the uniforms: as in compiled kernels they are computed in `prepare`.
   Bounds are not: they know no bonds. */
static interpreter *segment_interpreter(const kernel_plan *p, int task, const segment *a,
                                        const ir_node *inputs, needs *most) {
  ir_node *nodes = must_alloc((2 * (size_t)a->root_count + 1) * sizeof *nodes);
  const int count = segment_nodes(p->graph, a, nodes);
  if (task < PROGRAM_BOUNDS)
    ir_substitute(p->graph, nodes, count, p->uniforms, inputs, p->uniform_count, nodes);
  interpreter *made = count ? interpreter_new(p->graph, nodes, count) : NULL;
  most->nodes = larger(most->nodes, count);
  free(nodes);
  return made;
}

static void make_interpreters(runner *r, const ir_node *inputs, needs *most) {
  const kernel_plan *p = r->plan;
  for (int task = 0; task < PROGRAM_COUNT; task++) {
    const kernel_program *of = &p->programs[task];
    r->run[task] = arena_alloc(r->memory, ((size_t)of->pass_count + 1) * sizeof *r->run[task]);
    for (int k = 0; k < of->pass_count; k++) {
      const program_pass *now = &of->passes[k];
      most->slots = larger(most->slots, now->slot_count);
      most->planes = larger(most->planes, now->plane_count);
      r->run[task][k] =
          arena_alloc(r->memory, ((size_t)now->segment_count + 1) * sizeof(interpreter *));
      for (int s = 0; s < now->segment_count; s++)
        r->run[task][k][s] = segment_interpreter(p, task, &now->segments[s], inputs, most);
    }
  }
  most->nodes = larger(most->nodes, p->uniform_count);
  if (p->uniform_count) r->prepare = interpreter_new(p->graph, p->uniforms, p->uniform_count);
}

/* --- inputs ----------------------------------------------------------------------------------- */

/* How many inputs a source has; all differ from particle to particle, or from bond to bond, but
   parameters, what a class knows and what a whole strip has. */
static int input_count(const kernel_plan *p, ir_source from, const needs *most) {
  switch (from) {
  case IR_FROM_PARAMETER:
    return p->law->parameters.count + p->uniform_count;
  case IR_FROM_QUANTITY:
    return QUANTITY_COUNT;
  case IR_FROM_ENDS:
    return ENDS_COUNT;
  case IR_FROM_FIELD:
  case IR_FROM_NEW_FIELD:
  case IR_FROM_NEIGHBOUR_FIELD:
    return p->law->fields.count;
  case IR_FROM_BOND_PARAMETER:
  case IR_FROM_PARTICLE_PARAMETER:
  case IR_FROM_NEIGHBOUR_PARAMETER:
    return p->variation.varying_count;
  case IR_FROM_SHAPE:
    return PL_SHAPE_PLANES(3);
  case IR_FROM_LINK:
  case IR_FROM_NEIGHBOUR_LINK:
    return p->links.of_particles;
  case IR_FROM_BOND_LINK:
  case IR_FROM_NEIGHBOUR_BOND_LINK:
    return p->links.of_bonds;
  case IR_FROM_SHARED:
  case IR_FROM_SHARED_ODD:
    return 2 * p->links.of_bonds;
  case IR_FROM_POINT:
    return POINT_INPUTS;
  case IR_FROM_TIP:
    return TIP_INPUTS;
  case IR_FROM_SLOT:
    return most->slots;
  case IR_FROM_PLANE:
    return most->planes;
  default:
    return 0;
  }
}

static const unsigned char ends_stride[ENDS_COUNT] = {
#define X(code, name, array, owner, component) [ENDS_##code] = (owner) != OF_STRIP,
    ENDS_INPUTS(X)
#undef X
};

static void make_inputs(runner *r, const needs *most) {
  for (int from = 0; from < IR_SOURCE_COUNT; from++) {
    const size_t count = (size_t)input_count(r->plan, (ir_source)from, most);
    unsigned char *stride = arena_alloc(r->memory, count + 1);
    const bool varies = from != IR_FROM_PARAMETER && from != IR_FROM_QUANTITY;
    memset(stride, varies, count);
    r->at[from] = arena_alloc(r->memory, (count + 1) * sizeof *r->at[from]);
    memset(r->at[from], 0, count * sizeof *r->at[from]);
    for (int k = 0; from == IR_FROM_QUANTITY && k < PL_STATE_INPUTS; k++)
      stride[law_motion[k]] = 1;
    r->in.values[from] = r->at[from];
    r->in.stride[from] = from == IR_FROM_ENDS ? ends_stride : stride;
  }
  for (int k = 0; k < ENDS_COUNT; k++) {
    const ends_origin *o = &ends_origins[k];
    if ((o->array == FROM_DISPLACEMENT || o->array == FROM_VELOCITY) && o->component < r->plan->dof)
      r->motion[o->owner][r->motion_count[o->owner]++] = k;
  }
  for (int k = 0; k < QUANTITY_COUNT; k++)
    r->at[IR_FROM_QUANTITY][k] = &r->of_class[k];
  for (int k = 0; k < most->slots; k++)
    r->at[IR_FROM_SLOT][k] = r->slot + (size_t)k * RUNNER_LANES;
}

/* --- making ----------------------------------------------------------------------------------- */

/* Takes `count` times RUNNER_LANES values from *space. */
static double *take(double **space, int count) {
  double *taken = *space;
  *space += (size_t)count * RUNNER_LANES;
  return taken;
}

/* In one piece: of zero pages that are never read the system gives none. */
static void make_space(runner *r, const needs *most) {
  const kernel_plan *p = r->plan;
  const int planes = most->planes * RUNNER_NEIGHBOURS, opposite = 2 * p->links.of_bonds,
            gathered = p->links.of_particles + 3 * p->links.of_bonds + p->law->fields.count +
                       p->variation.varying_count + ENDS_COUNT,
            all = most->slots + planes + opposite + gathered + most->nodes;
  double *space = r->space = must_calloc((size_t)all * RUNNER_LANES, sizeof *space);
  r->slot = take(&space, most->slots);
  r->plane = take(&space, planes);
  r->opposite = take(&space, opposite);
  r->gathered = take(&space, gathered);
  r->result = arena_alloc(r->memory, ((size_t)most->nodes + 1) * sizeof *r->result);
  for (int k = 0; k < most->nodes; k++)
    r->result[k] = take(&space, 1);
}

runner *runner_new(const kernel_plan *p, const ir_node *inputs) {
  runner *r = must_calloc(1, sizeof *r);
  needs most = {0, 0, 0};
  r->plan = p;
  r->memory = arena_new();
  make_interpreters(r, inputs, &most);
  make_space(r, &most);
  make_inputs(r, &most);
  return r;
}

void runner_free(runner *r) {
  if (!r) return;
  const kernel_program *of = r->plan->programs;
  for (int task = 0; task < PROGRAM_COUNT; task++)
    for (int k = 0; k < of[task].pass_count; k++)
      for (int s = 0; s < of[task].passes[k].segment_count; s++)
        interpreter_free(r->run[task][k][s]);
  interpreter_free(r->prepare);
  free(r->space);
  arena_free(r->memory);
  free(r);
}

void runner_watch(runner *r, interpreter_look *look, void *context) {
  const kernel_program *of = r->plan->programs;
  for (int task = 0; task < PROGRAM_COUNT; task++)
    for (int k = 0; k < of[task].pass_count; k++)
      for (int s = 0; s < of[task].passes[k].segment_count; s++)
        if (r->run[task][k][s]) interpreter_watch(r->run[task][k][s], look, context);
}

void runner_take_parameters(runner *r, const double *parameters) {
  for (int k = 0; k < r->plan->law->parameters.count; k++)
    r->at[IR_FROM_PARAMETER][k] = parameters + k;
}

void runner_take_uniforms(runner *r, const double *uniforms) {
  for (int k = 0; k < r->plan->uniform_count; k++)
    r->at[IR_FROM_PARAMETER][r->plan->law->parameters.count + k] = uniforms + k;
}
