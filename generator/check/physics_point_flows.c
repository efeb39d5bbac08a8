#include "generator/check/physics_point_flows.h"

#include <math.h>
#include <stdlib.h>

#include "dsl/base/arena.h"
#include "dsl/base/elementary.h"
#include "generator/ir/interpret.h"
#include "generator/ir/random_values.h"
#include "generator/lower/kinematics.h"
#include "generator/lower/lower.h"
#include "generator/lower/point_inputs.h"

static const double RETURNED = 1e-6;  /* of the overstress before */
static const double TIME_STEP = 1e-6; /* s */

struct point_flows {
  const law *law;
  arena *memory;
  ir *graph;
  lowered_law step;
  interpreter *fields, *overstress;
  int count;                         /* of flows */
  double *room, **field, **over;     /* [fields], [3 count]: overstresses, slopes */
  const double **at_field, **at_own; /* [fields], [parameters] */
  double strain[POINT_STRAINS];
};

/* --- opening ---------------------------------------------------------------------------------- */

static bool lower_flows(point_flows *f, diagnostics *d) {
  f->memory = arena_new();
  f->graph = ir_new();
  if (!lower_law(f->law, f->graph, LOWER_STEP, f->memory, &f->step, d)) return false;
  f->count = f->step.text.flow_count;
  for (int k = 0; k < f->count; k++)
    if (f->step.text.flows[k].overstress == IR_NONE) return false;
  return f->count > 0;
}

static void open_values(point_flows *f) {
  const int fields = f->law->fields.count;
  ir_node *over = arena_alloc(f->memory, 3 * (size_t)f->count * sizeof *over);
  for (int k = 0; k < f->count; k++) {
    const lowered_flow *flow = &f->step.text.flows[k];
    over[k] = flow->overstress;
    over[f->count + k] = flow->slope == IR_NONE ? flow->overstress : flow->slope;
    over[2 * f->count + k] = flow->slope == IR_NONE ? flow->overstress : flow->slope_after;
  }
  f->fields = interpreter_new(f->graph, f->step.fields, fields);
  f->overstress = interpreter_new(f->graph, over, 3 * f->count);
  f->room = must_calloc((size_t)(2 * fields + 3 * f->count), sizeof(double));
  f->field = must_calloc((size_t)fields, sizeof *f->field);
  f->over = must_calloc(3 * (size_t)f->count, sizeof *f->over);
  f->at_field = must_calloc((size_t)fields, sizeof *f->at_field);
  f->at_own = must_calloc((size_t)f->law->parameters.count + 1, sizeof *f->at_own);
  for (int k = 0; k < fields; k++) {
    f->at_field[k] = &f->room[k];
    f->field[k] = &f->room[fields + k];
  }
  for (int k = 0; k < 3 * f->count; k++)
    f->over[k] = &f->room[2 * fields + k];
}

point_flows *point_flows_open(point_bench *b) {
  point_flows *f = must_calloc(1, sizeof *f);
  f->law = &b->setting;
  if (!lower_flows(f, b->said)) {
    point_flows_close(f);
    return NULL;
  }
  open_values(f);
  return f;
}

void point_flows_close(point_flows *f) {
  if (!f) return;
  interpreter_free(f->fields);
  interpreter_free(f->overstress);
  ir_free(f->graph);
  arena_free(f->memory);
  free(f->room);
  free(f->field);
  free(f->over);
  free(f->at_field);
  free(f->at_own);
  free(f);
}

/* --- one strain ------------------------------------------------------------------------------- */

static void run(point_bench *b, point_flows *f, interpreter *program, double *const *out) {
  static const double none = 0, step = TIME_STEP;
  const double *point[POINT_INPUTS],
      *ends[ENDS_COUNT] = {[ENDS_TIME_STEP] = &step, [ENDS_ADVANCE] = &none};
  for (int k = 0; k < POINT_INPUTS; k++)
    point[k] = k < POINT_STRAINS ? &f->strain[k] : k == POINT_CELL_SIZE ? &b->size[0] : &none;
  for (int k = 0; k < f->law->parameters.count; k++)
    f->at_own[k] = &b->parameters[k];
  const interpreter_inputs in = {.values = {[IR_FROM_PARAMETER] = f->at_own,
                                            [IR_FROM_FIELD] = f->at_field,
                                            [IR_FROM_ENDS] = ends,
                                            [IR_FROM_POINT] = point}};
  interpreter_run(program, &in, 1, out);
  b->report->states++;
}

static void draw_strain(point_bench *b, point_flows *f) {
  const double size = pl_pow(10, draw_uniform(&b->seed, -5, -2));
  for (int k = 0; k < POINT_STRAINS; k++)
    f->strain[k] = size * draw_uniform(&b->seed, -1, 1);
}

/* The drawn strain as the bench names its components. */
static void strain_of(const point_bench *b, const point_flows *f, double *strain) {
  const int dimensions = b->strains == 3 ? 2 : 3;
  for (int k = 0; k < b->strains; k++)
    strain[k] = f->strain[point_component(dimensions, k)];
}

static void say(point_bench *b, const point_flows *f, int k, double left) {
  double strain[POINT_MOST];
  strain_of(b, f, strain);
  if (f->step.text.flows[k].rule->returned)
    point_bench_say_at(b, f->step.text.flows[k].rule->where, DIAG_FLOW, strain,
                       "the guard must see all that the flow changes, each with its new value: "
                       "factors of the increments, the size of the direction",
                       "with the new states %.4g of the overstress is left, and a returned flow "
                       "leaves none",
                       left);
  else
    point_bench_say_at(b, f->step.text.flows[k].rule->where, DIAG_FLOW, strain,
                       "a flow that removes 1 returns to the yield limit; more than 2 runs away",
                       "this flow removes %.4g of the overstress in a step; it must remove more "
                       "than 0 and less than 2",
                       1 - left);
}

/* Of a returned flow whose return is not found: Newton's method goes down f, which must fall, and
   not without bound. Whether it can. */
static bool can_return(point_bench *b, const point_flows *f, int k) {
  static const double STEEP = 100;
  const lowered_flow *flow = &f->step.text.flows[k];
  const double slope = *f->over[f->count + k], after = *f->over[2 * f->count + k];
  const bool steep = !isfinite(slope) || !isfinite(after) || fabs(after) > STEEP * fabs(slope);
  double strain[POINT_MOST];
  if (flow->slope == IR_NONE || (!steep && slope < 0)) return true;
  strain_of(b, f, strain);
  if (!steep)
    point_bench_say_at(b, flow->rule->where, DIAG_FLOW, strain,
                       "look at signs: what the flow relaxes is taken from f, as in `- "
                       "3*mu*(x - previous(x))`, and softening must be less steep",
                       "f does not fall along the direction of the flow: its slope is %.4g where "
                       "it begins, and no return is found",
                       slope);
  else
    point_bench_say_at(b, flow->rule->where, DIAG_NOT_FINITE, strain,
                       "write `(x + small)**m` for `x**m`, a root likewise: `small` as 1e-6",
                       "f has no finite slope at the start of the return, and it is not found");
  return false;
}

void physics_check_flows(point_bench *b, point_flows *f) {
  const symbol_list *fields = &f->law->fields;
  double before[16];
  if (!f || b->failed[DIAG_FLOW] || f->count > 16 || b->kernel->reads_rates) return;
  draw_strain(b, f);
  for (int k = 0; k < fields->count; k++)
    f->room[k] = fields->items[k]->initial;
  run(b, f, f->overstress, f->over);
  for (int k = 0; k < f->count; k++)
    before[k] = *f->over[k];
  run(b, f, f->fields, f->field);
  for (int k = 0; k < f->count; k++)
    if (before[k] > 0 && !isfinite(*f->field[f->step.text.flows[k].field]) && !can_return(b, f, k))
      return;
  for (int k = 0; k < fields->count; k++)
    f->room[k] = *f->field[k];
  run(b, f, f->overstress, f->over);
  for (int k = 0; k < f->count; k++) {
    const double left = *f->over[k] / before[k];
    const bool returned = f->step.text.flows[k].rule->returned;
    if (!(before[k] > 0) || !isfinite(left)) continue; /* the latter is said elsewhere */
    if (returned ? fabs(left) > RETURNED : left >= 1 || left <= -1) {
      say(b, f, k, left);
      return;
    }
  }
}
