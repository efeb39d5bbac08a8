#include "generator/drive/driven_fields.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

#include "dsl/base/arena.h"
#include "runtime/analysis/material.h"
#include "runtime/deck/deck_value.h"

static int find_parameter(const pl_law *law, const char *name) {
  for (int p = 0; p < law->parameter_count; p++)
    if (strcasecmp(law->parameters[p].name, name) == 0) return p;
  return -1;
}

/* Its number among the parameters; -1 after a message. */
static int field_of(const drive_given *g, const pl_law *law, diagnostics *d) {
  const int p = find_parameter(law, g->name);
  if (p >= 0 && material_is_given(law, p)) return p;
  const char **names = must_calloc((size_t)law->parameter_count + 1, sizeof *names);
  int count = 0;
  for (int k = 0; k < law->parameter_count; k++)
    if (material_is_given(law, k)) names[count++] = law->parameters[k].name;
  diag_report(d, DIAG_UNKNOWN_NAME, g->name_where, "the law `%s` has no field `%s`", law->name,
              g->name);
  if (p >= 0)
    diag_hint(d, "`%s` is a parameter: give it in &material, or declare it `field` in the law",
              law->parameters[p].name);
  else if (count)
    deck_suggest(d, g->name, names, count, "its fields are");
  free(names);
  return -1;
}

static bool unit_fits(const drive_given *g, const pl_parameter *p, diagnostics *d) {
  unit wanted = {.dim = DIMENSIONLESS, .factor = 1};
  const char *bad;
  size_t bad_length;
  char given[80], needed[80];
  if (p->unit && *p->unit) (void)unit_parse(p->unit, strlen(p->unit), &wanted, &bad, &bad_length);
  if (!g->has_unit || dim_equal(g->dim, wanted.dim)) return true;
  dim_describe(g->dim, given, sizeof given);
  dim_describe(wanted.dim, needed, sizeof needed);
  diag_report(d, DIAG_UNITS, g->where, "`%s` needs %s, this is %s", p->name, needed, given);
  return false;
}

/* Between its corners a path is straight: these say all. */
static bool is_allowed(const drive_given *g, const pl_law *law, int p, double *values,
                       diagnostics *d) {
  const size_t n = (size_t)law->parameter_count + 1;
  double *bounds = must_calloc(2 * n, sizeof *bounds);
  unsigned char *open = must_calloc(2 * n, 1);
  bool good = true;
  for (int k = 0; k < g->f.count && good; k++) {
    const double v = values[p] = g->f.values[k];
    law->bounds(law, values, bounds, bounds + n, open, open + n);
    good = (open[p] ? v > bounds[p] : v >= bounds[p]) &&
           (open[n + (size_t)p] ? v < bounds[n + (size_t)p] : v <= bounds[n + (size_t)p]);
    if (!good)
      diag_report(d, DIAG_OUT_OF_BOUNDS, g->where,
                  "`%s` = %.6g (SI) is not in the range %c%.6g, %.6g%c of the law `%s`", g->name, v,
                  open[p] ? '(' : '[', bounds[p], bounds[n + (size_t)p],
                  open[n + (size_t)p] ? ')' : ']', law->name);
  }
  free(bounds);
  free(open);
  return good;
}

bool driven_fields_suit(const drive_input *in, const pl_law *law, const double *parameters,
                        diagnostics *d) {
  double *values = must_calloc((size_t)law->parameter_count + 1, sizeof *values);
  bool good = true;
  for (int k = 0; k < in->given_count; k++) {
    const drive_given *g = &in->given[k];
    const int p = field_of(g, law, d);
    memcpy(values, parameters, (size_t)law->parameter_count * sizeof *values);
    good =
        p >= 0 && unit_fits(g, &law->parameters[p], d) && is_allowed(g, law, p, values, d) && good;
  }
  free(values);
  return good;
}

bool driven_fields_at(const drive_input *in, const pl_law *law, double time, double *values) {
  for (int k = 0; k < in->given_count; k++)
    values[find_parameter(law, in->given[k].name)] = time_function_at(&in->given[k].f, time);
  return in->given_count > 0;
}

int driven_fields_count(const pl_law *law) {
  int count = 0;
  for (int p = 0; p < law->parameter_count; p++)
    count += material_is_given(law, p);
  return count;
}

void driven_fields_add(drive_table *t, const pl_law *law, long room) {
  for (int p = 0; p < law->parameter_count; p++)
    if (material_is_given(law, p))
      drive_add_column(t, law->parameters[p].name, law->parameters[p].unit, room);
}

int driven_fields_put(drive_table *t, const pl_law *law, const double *values, int column,
                      long row) {
  for (int p = 0; p < law->parameter_count; p++)
    if (material_is_given(law, p)) t->columns[column++].values[row] = values[p];
  return column;
}
