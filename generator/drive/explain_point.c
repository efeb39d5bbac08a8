#include "generator/drive/explain_point.h"

#include <math.h>
#include <stdlib.h>

#include "dsl/base/arena.h"
#include "generator/drive/explain_values.h"
#include "generator/lower/lower.h"
#include "generator/lower/lower_inputs.h"

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

/* Whether none along z is without stress. */
static bool report_along_z(const kernel_plan *p, lone_point *at, FILE *out) {
  const along_z seen = lone_point_along_z(at, p->law);
  fputs("  no strain along z is found that leaves no stress there", out);
  if (seen.roots > 0)
    fprintf(out, ", though one near %.6g does\n", seen.root);
  else if (isfinite(seen.least))
    fprintf(out, ": between %.6g and %.6g it is %.6g MPa in size at least, at %.6g\n", -seen.reach,
            seen.reach, 1e-6 * seen.least, seen.least_at);
  else
    fputc('\n', out);
  return seen.roots == 0 && isfinite(seen.least);
}

static point_fault report_point(const kernel_plan *p, lone_point *at, FILE *out) {
  explained e = explain_values(p, PROGRAM_STEP, &at->in);
  const bool bad = e.bad < e.count, flow = bad && is_returned(p, e.named[e.bad]);
  point_fault fault = POINT_FAULT_OTHER;
  if (bad)
    explain_line(p, e.named[e.bad],
                 flow ? "does not come back to its limit: the flow is not found"
                      : "stops being finite",
                 out);
  if (flow && report_slope(p, e.named[e.bad], &at->in, out)) fault = POINT_FAULT_FLOW;
  if (!bad && p->law->setting == SETTING_PLANE_STRESS && report_along_z(p, at, out))
    fault = POINT_FAULT_FOLD;
  explained_free(&e);
  return fault;
}

point_fault explain_point(const kernel_plan *p, const double *parameters, const asked_point *at,
                          FILE *out) {
  lone_point point;
  lone_point_open(&point, p, parameters, at);
  const point_fault fault = report_point(p, &point, out);
  lone_point_close(&point);
  return fault;
}
