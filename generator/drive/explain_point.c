#include "generator/drive/explain_point.h"

#include <math.h>
#include <stdlib.h>

#include "dsl/base/arena.h"
#include "generator/drive/explain_values.h"
#include "generator/lower/lower.h"
#include "generator/lower/lower_inputs.h"
#include "generator/lower/point_inputs.h"

/* Whether the value is a state of a flow that is solved for. */
static bool is_returned(const kernel_plan *p, ir_node n) {
  const span where = ir_where(p->graph, n);
  for (int f = 0; f < p->law->fields.count; f++) {
    const symbol *s = p->law->fields.items[f], *of = s->component_of ? s->component_of : s;
    if (lower_is_returned(of) && of->rule->where.file == where.file &&
        of->rule->where.begin == where.begin)
      return true;
  }
  return false;
}

/* The same by the law's flow, whose slopes tell. */
static const lowered_flow *flow_of(const kernel_plan *p, ir_node n, const lowered_law *step) {
  const span where = ir_where(p->graph, n);
  for (int k = 0; k < step->text.flow_count; k++) {
    const lowered_flow *f = &step->text.flows[k];
    const symbol *s = p->law->fields.items[f->field], *of = s->component_of ? s->component_of : s;
    if (f->slope != IR_NONE && of->rule->where.file == where.file &&
        of->rule->where.begin == where.begin)
      return f;
  }
  return NULL;
}

/* Why a return is not found, where its slopes at its start tell. */
static bool report_slope(const kernel_plan *p, ir_node n, const interpreter_inputs *in, FILE *out) {
  arena *memory = arena_new();
  ir *graph = ir_new();
  diagnostics said = {0};
  lowered_law step;
  double slope = -1, *at = &slope;
  const bool lowered = lower_law(p->law, graph, LOWER_STEP, memory, &step, &said);
  const lowered_flow *f = lowered ? flow_of(p, n, &step) : NULL;
  if (f) {
    interpreter *program = interpreter_new(graph, &f->slope, 1);
    interpreter_run(program, in, 1, &at);
    interpreter_free(program);
    if (!isfinite(slope))
      fputs("  f has no finite slope at the start of the return: write `(x + small)**m` for "
            "`x**m`, `small` as 1e-6\n",
            out);
    else if (slope >= 0)
      fputs("  f does not fall along the direction of the flow: look at signs\n", out);
  }
  ir_free(graph);
  arena_free(memory);
  return !(slope < 0 && isfinite(slope));
}

static bool report_point(const kernel_plan *p, const interpreter_inputs *in, FILE *out) {
  explained e = explain_values(p, PROGRAM_STEP, in);
  const bool bad = e.bad < e.count, flow = bad && is_returned(p, e.named[e.bad]);
  bool no_slope = false;
  if (bad)
    explain_line(p, e.named[e.bad],
                 flow ? "does not come back to its limit: the flow is not found"
                      : "stops being finite",
                 out);
  if (flow)
    no_slope = report_slope(p, e.named[e.bad], in, out);
  else if (!bad && p->law->setting == SETTING_PLANE_STRESS)
    fputs("  no strain along z is found that leaves no stress there\n", out);
  explained_free(&e);
  return no_slope;
}

bool explain_point(const kernel_plan *p, const double *parameters, const asked_point *at,
                   FILE *out) {
  const law *l = p->law;
  const double none = 0, *point[POINT_INPUTS], *ends[ENDS_COUNT] = {[ENDS_TIME_STEP] = &at->step};
  const double **given = must_calloc((size_t)l->parameters.count + 1, sizeof *given),
               **own = must_calloc((size_t)l->parameters.count + 1, sizeof *own),
               **field = must_calloc((size_t)l->fields.count + 1, sizeof *field);
  for (int k = 0; k < POINT_INPUTS; k++)
    point[k] = k == POINT_CELL_SIZE ? &at->size : &none;
  for (int k = 0; k < PL_STRAINS(p->dimensions); k++)
    point[POINT_STRAIN + point_component(p->dimensions, k)] = &at->strain[k];
  for (int k = 0; k < l->parameters.count; k++)
    given[k] = &parameters[k];
  for (int k = 0; k < p->variation.varying_count; k++)
    own[k] = &parameters[p->variation.varying[k]];
  for (int k = 0; k < l->fields.count; k++)
    field[k] = &at->field[k];
  const interpreter_inputs in = {.values = {[IR_FROM_PARAMETER] = given,
                                            [IR_FROM_BOND_PARAMETER] = own,
                                            [IR_FROM_FIELD] = field,
                                            [IR_FROM_ENDS] = ends,
                                            [IR_FROM_POINT] = point}};
  const bool no_slope = report_point(p, &in, out);
  free(given);
  free(own);
  free(field);
  return no_slope;
}
