#include "runtime/analysis/material.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

#include "dsl/base/arena.h"
#include "dsl/base/units.h"
#include "runtime/lattice/place_table.h"
#include "runtime/lattice/placed_values.h"

double material_density(const pl_law *law, const double *values) {
  return law->density < 0 ? 0 : values[law->density];
}

/* Namelists do not know case, and no two parameters of a law differ in case only. */
static int find_parameter(const pl_law *law, const char *name) {
  for (int p = 0; p < law->parameter_count; p++)
    if (strcasecmp(law->parameters[p].name, name) == 0) return p;
  return -1;
}

static bool unknown(const deck_assignment *a, const pl_law *law, diagnostics *d) {
  const char **names = must_calloc((size_t)law->parameter_count + 1, sizeof *names);
  for (int p = 0; p < law->parameter_count; p++)
    names[p] = law->parameters[p].name;
  diag_report(d, DIAG_UNKNOWN_KEY, a->name_where, "the law `%s` has no parameter `%s`", law->name,
              a->name);
  diag_suggest(d, a->name, names, law->parameter_count);
  free(names);
  return false;
}

/* A number without a unit is taken in SI. */
static bool check_unit(const deck_assignment *a, const pl_parameter *p, diagnostics *d) {
  const char *bad;
  size_t bad_length;
  unit wanted = {.dim = DIMENSIONLESS, .factor = 1};
  if (p->unit && *p->unit) (void)unit_parse(p->unit, strlen(p->unit), &wanted, &bad, &bad_length);
  if (!a->has_unit || dim_equal(a->dim, wanted.dim)) return true;
  char given[80], needed[80];
  dim_describe(a->dim, given, sizeof given);
  dim_describe(wanted.dim, needed, sizeof needed);
  diag_report(d, DIAG_UNITS, a->value_where, "`%s` needs %s, this is %s", p->name, needed, given);
  return false;
}

/* What stands for all values of a file before there are particles: their mean. */
static bool take_mean(const deck_assignment *a, const pl_law *law, int parameter, double *value,
                      diagnostics *d) {
  enum { ONE_BOX = 1 }; /* m: nobody asks what is near */
  place_table t;
  const deck_placed from = placed_of_parameter(a, &law->parameters[parameter]);
  const bool good = place_table_read(&t, &from, law->dimensions, ONE_BOX, a->value_where, d);
  if (good) *value = place_table_mean(&t);
  place_table_free(&t);
  return good;
}

static bool assign(const deck_assignment *a, const pl_law *law, double *values, span *where,
                   bool *given, diagnostics *d) {
  const int p = find_parameter(law, a->name);
  if (p < 0) return unknown(a, law, d);
  if (a->word) {
    diag_report(d, DIAG_BAD_VALUE, a->value_where, "`%s` needs a number, not the word '%s'",
                law->parameters[p].name, a->word);
    return false;
  }
  if (given[p]) {
    diag_report(d, DIAG_DUPLICATE_KEY, a->name_where, "`%s` is given twice",
                law->parameters[p].name);
    diag_note(d, where[p], "first given here");
    return false;
  }
  given[p] = true;
  where[p] = a->value_where;
  values[p] = a->value;
  if (a->placed && a->placed->path) return take_mean(a, law, p, &values[p], d);
  return check_unit(a, &law->parameters[p], d);
}

/* Values the deck does not give: defaults. All that are missing are reported. */
static bool fill_defaults(const deck_material *m, const pl_law *law, double *values,
                          const bool *given, diagnostics *d) {
  bool good = true;
  for (int p = 0; p < law->parameter_count; p++) {
    const pl_parameter *parameter = &law->parameters[p];
    if (given[p]) continue;
    values[p] = parameter->initial;
    if (parameter->has_default) continue;
    good = false;
    diag_report(d, DIAG_MISSING_KEY, m->item.where, "the law `%s` needs a value for `%s`%s%s%s",
                law->name, parameter->name, parameter->doc && *parameter->doc ? " (" : "",
                parameter->doc ? parameter->doc : "", parameter->doc && *parameter->doc ? ")" : "");
  }
  return good;
}

static void print_bound(double value, bool upper, char *text, size_t size) {
  if (isinf(value))
    snprintf(text, size, upper ? "inf" : "-inf");
  else
    snprintf(text, size, "%.8g", value);
}

/* What a law makes of such a value may be 0 or infinite. */
static bool is_computable(double value) {
  return value == 0 || (fabs(value) >= 1e-100 && fabs(value) <= 1e100);
}

static bool check_sizes(const deck_material *m, const pl_law *law, const double *values,
                        const span *where, const bool *given, diagnostics *d) {
  bool good = true;
  for (int p = 0; p < law->parameter_count; p++) {
    if (is_computable(values[p])) continue;
    const bool large = fabs(values[p]) > 1;
    diag_report(d, DIAG_OUT_OF_BOUNDS, given[p] ? where[p] : m->item.where,
                "`%s` = %.8g is too %s to compute with", law->parameters[p].name, values[p],
                large ? "large" : "small");
    diag_hint(d, large ? "no quantity of a law is larger than 1e100 in SI units"
                       : "give 0, or a quantity of at least 1e-100 in SI units");
    good = false;
  }
  return good;
}

static const deck_placed *placed_of(const deck_material *m, const pl_parameter *p) {
  for (int a = 0; a < m->assignment_count; a++)
    if (m->assignments[a].placed && strcasecmp(m->assignments[a].name, p->name) == 0)
      return m->assignments[a].placed;
  return NULL;
}

/* What differs is judged at the particles (parameter_planes.h): where the law forbids the value of
   a formula in the middle, or the mean of a file, the default answers until they are known. */
static void replace_placed(const deck_material *m, const pl_law *law, double *values) {
  const size_t n = (size_t)law->parameter_count + 1;
  double *bounds = must_calloc(2 * n, sizeof *bounds);
  unsigned char *open = must_calloc(2 * n, 1);
  law->bounds(law, values, bounds, bounds + n, open, open + n);
  for (size_t p = 0; p + 1 < n; p++) {
    const double v = values[p];
    const bool inside = (open[p] ? v > bounds[p] : v >= bounds[p]) &&
                        (open[n + p] ? v < bounds[n + p] : v <= bounds[n + p]);
    if ((!inside || !isfinite(v)) && law->parameters[p].has_default &&
        placed_of(m, &law->parameters[p]))
      values[p] = law->parameters[p].initial;
  }
  free(bounds);
  free(open);
}

static bool check_bounds(const deck_material *m, const pl_law *law, const double *values,
                         const span *where, const bool *given, diagnostics *d) {
  const size_t n = (size_t)law->parameter_count + 1;
  double *lower = must_calloc(n, sizeof *lower), *upper = must_calloc(n, sizeof *upper);
  unsigned char *low_open = must_calloc(n, 1), *high_open = must_calloc(n, 1);
  law->bounds(law, values, lower, upper, low_open, high_open);
  bool good = true;
  for (int p = 0; p < law->parameter_count; p++) {
    const double v = values[p];
    const bool above = low_open[p] ? v > lower[p] : v >= lower[p];
    const bool below = high_open[p] ? v < upper[p] : v <= upper[p];
    if (above && below && isfinite(v)) continue; /* NaN is neither */
    char low[32], high[32];
    print_bound(lower[p], false, low, sizeof low);
    print_bound(upper[p], true, high, sizeof high);
    const char *u = law->parameters[p].unit;
    const bool pure = !u || !*u || strcmp(u, "1") == 0;
    diag_report(d, DIAG_OUT_OF_BOUNDS, given[p] ? where[p] : m->item.where,
                "`%s` = %.8g%s%s is not in %c%s, %s%c, the range of the law `%s`",
                law->parameters[p].name, v, pure ? "" : " ", pure ? "" : u, low_open[p] ? '(' : '[',
                low, high, high_open[p] ? ')' : ']', law->name);
    const deck_placed *by = placed_of(m, &law->parameters[p]);
    if (by)
      diag_hint(d, by->path ? "this is the mean of the file's values"
                            : "this is the formula's value in the middle of the bodies");
    if (!given[p])
      diag_hint(d, "this is the law's default; its range depends on the values given here");
    good = false;
  }
  free(lower);
  free(upper);
  free(low_open);
  free(high_open);
  return good;
}

bool material_parameters(const deck_material *m, const pl_law *law, double *values,
                         diagnostics *d) {
  bool *given = must_calloc((size_t)law->parameter_count + 1, sizeof *given);
  span *where = must_calloc((size_t)law->parameter_count + 1, sizeof *where);
  bool good = true;
  for (int a = 0; a < m->assignment_count; a++)
    good = assign(&m->assignments[a], law, values, where, given, d) && good;
  good = !m->item.faulty && fill_defaults(m, law, values, given, d) && good;
  if (good) replace_placed(m, law, values);
  good = good && check_bounds(m, law, values, where, given, d) &&
         check_sizes(m, law, values, where, given, d);
  free(given);
  free(where);
  return good;
}
