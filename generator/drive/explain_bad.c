#include "generator/drive/explain_bad.h"

#include <math.h>

#include "generator/drive/explain_values.h"
#include "generator/interpreter/comparison.h"
#include "generator/lower/law_inputs.h"

/* The largest of the law's results, or -1 when all are zero. */
static int largest_result(const kernel_plan *p, const explained *e) {
  const segment *states = plan_segment(p, PROGRAM_STATES);
  int largest = -1;
  for (int k = 0; k < e->count; k++)
    for (int r = 0; r < states->root_count && r < PL_STATE_RESULTS; r++)
      if (states->roots[r].node == e->named[k] &&
          fabs(e->values[k][0]) > (largest < 0 ? 0 : fabs(e->values[largest][0])))
        largest = k;
  return largest;
}

/* The first that is not finite; when all are, the force or moment that is too large. */
static void report(const kernel_plan *p, const interpreter_inputs *in, FILE *out) {
  explained e = explain_values(p, PROGRAM_STATES, in);
  char what[64] = "stops being finite";
  int k = e.bad;
  if (k == e.count && (k = largest_result(p, &e)) >= 0)
    snprintf(what, sizeof what, "is %.6g (SI)", e.values[k][0]);
  if (k >= 0) explain_line(p, e.named[k], what, out);
  explained_free(&e);
}

void explain_bad(const kernel_plan *p, const double *parameters, const pl_bond_class *bonds,
                 const bad_state *b, FILE *out) {
  const symbol_list *fields = &p->law->fields;
  const double kinematics[PL_STATE_INPUTS] = {b->stretch, b->stretch_rate, b->theta_i, b->theta_j,
                                              bonds->s * (1 + b->stretch), b->advance};
  double **in = planes_new(PL_STATE_INPUTS, 1), **field = planes_new(fields->count, 1);
  for (int k = 0; k < PL_STATE_INPUTS; k++)
    in[k][0] = kinematics[k];
  for (int f = 0; f < fields->count; f++)
    field[f][0] = f < b->field_count ? b->fields[f] : fields->items[f]->initial;
  law_inputs inputs;
  law_inputs_open(&inputs, p->law, parameters, bonds);
  interpreter_inputs at =
      law_inputs_at(&inputs, (const double *const *)in, (const double *const *)field);
  report(p, &at, out);
  law_inputs_close(&inputs);
  planes_free(in, PL_STATE_INPUTS);
  planes_free(field, fields->count);
}
