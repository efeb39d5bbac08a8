#include "runtime/analysis/material.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

#include "dsl/base/arena.h"
#include "dsl/base/elementary.h"
#include "dsl/base/units.h"
#include "runtime/deck/deck_value.h"
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

bool material_is_given(const pl_law *law, int parameter) {
  for (int k = 0; PL_HAS(law, given) && k < law->given_count; k++)
    if (law->given[k] == parameter) return true;
  return false;
}

/* Whether the law has a vector of this name, as parameters name_x, name_y and name_z. */
static bool has_vector(const pl_law *law, const char *name) {
  static const char *const axes[] = {"x", "y", "z"};
  char component[128];
  int found = 0;
  for (int k = 0; k < 3; k++) {
    snprintf(component, sizeof component, "%s_%s", name, axes[k]);
    found += find_parameter(law, component) >= 0;
  }
  return found == 3;
}

/* A list where the law has a number, or a number where it has a list. False: neither. */
static bool is_miscounted(const deck_assignment *a, const pl_law *law, diagnostics *d) {
  const bool number = a->vector && find_parameter(law, a->vector) >= 0;
  if (!number && (a->vector || !has_vector(law, a->name))) return false;
  if (number && a->name[strlen(a->name) - 1] != 'x') return true; /* said of the first */
  if (number) {
    diag_report(d, DIAG_BAD_VALUE, a->value_where, "`%s` takes 1 value, but %d are given",
                a->vector, a->listed);
    if (a->listed == 2 && !a->has_unit)
      diag_hint(d, "decimals are written with a point, not a comma");
  } else {
    diag_report(d, DIAG_BAD_VALUE, a->value_where, "`%s` is a vector, but one number is given",
                a->name);
    diag_hint(d, "give its components: `%s = 1, 0, 0`; in the plane two are enough", a->name);
  }
  return true;
}

/* Names of the law's parameters, of its vectors (`fibre` of fibre_x) or of what it is given;
   [law->parameter_count] and what they are made of. */
static int known_names(arena *memory, const pl_law *law, const deck_assignment *a,
                       const char **names) {
  int count = 0;
  for (int p = 0; p < law->parameter_count; p++) {
    const char *name = law->parameters[p].name;
    const size_t n = strlen(name);
    if (a->vector && n > 2 && strcmp(name + n - 2, "_x") == 0)
      names[count++] = arena_text(memory, name, n - 2);
    else if (!a->vector && (!a->of_field || material_is_given(law, p)))
      names[count++] = name;
  }
  return count;
}

static bool unknown(const deck_assignment *a, const pl_law *law, diagnostics *d) {
  if (is_miscounted(a, law, d)) return false;
  if (a->vector && a->name[strlen(a->name) - 1] != 'x') return false; /* said of the first */
  const char *name = a->vector ? a->vector : a->name;
  arena *memory = arena_new();
  const char **names = arena_alloc(memory, ((size_t)law->parameter_count + 1) * sizeof *names);
  const int count = known_names(memory, law, a, names);
  diag_report(d, DIAG_UNKNOWN_KEY, a->name_where, "the law `%s` has no %s `%s`", law->name,
              a->of_field ? "field"
              : a->vector ? "vector"
                          : "parameter",
              name);
  if (!a->of_field)
    diag_suggest(d, name, names, count);
  else if (count)
    deck_suggest(d, name, names, count, "its fields are");
  else
    diag_hint(d, "a law declares what it is given: `field %s [K] on particle = 293 [K]`", name);
  arena_free(memory);
  return false;
}

static bool no_field(const deck_assignment *a, const pl_law *law, diagnostics *d) {
  diag_report(d, DIAG_CONFLICT, a->name_where, "`%s` is a parameter of the law `%s`, not a field",
              a->name, law->name);
  diag_hint(d, "give it in &material, where it may be a formula of the place, too; or declare it "
               "`field` in the law");
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
  if (p < 0 && a->of_field && a->anyway) return true;
  if (p < 0) return unknown(a, law, d);
  if (a->of_field && !material_is_given(law, p)) return no_field(a, law, d);
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

/* That of parameter p, which may follow from those above it; `defaults` [parameter_count] is there
   to be written to. */
static double default_of(const pl_law *law, int p, const double *values, double *defaults) {
  defaults[p] = law->parameters[p].initial;
  if (PL_HAS(law, defaults) && law->defaults) law->defaults(law, values, defaults);
  return defaults[p];
}

/* Values the deck does not give: defaults. All that are missing are reported. */
static bool fill_defaults(const deck_material *m, const pl_law *law, double *values,
                          const bool *given, diagnostics *d) {
  bool good = true;
  double *defaults = must_calloc((size_t)law->parameter_count + 1, sizeof *defaults);
  for (int p = 0; p < law->parameter_count; p++) /* what is not filled yet is read as well */
    if (!given[p]) values[p] = law->parameters[p].initial;
  for (int p = 0; p < law->parameter_count; p++) {
    const pl_parameter *parameter = &law->parameters[p];
    if (given[p]) continue;
    values[p] = default_of(law, p, values, defaults);
    if (parameter->has_default) continue;
    good = false;
    diag_report(d, DIAG_MISSING_KEY, m->item.where, "the law `%s` needs a value for `%s`%s%s%s",
                law->name, parameter->name, parameter->doc && *parameter->doc ? " (" : "",
                parameter->doc ? parameter->doc : "", parameter->doc && *parameter->doc ? ")" : "");
  }
  free(defaults);
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

/* Whether a limit is one of angles: a half or a quarter of a turn, also as 3.14. */
static bool is_of_angles(double limit) {
  const double quarters = fabs(limit) / PL_HALF_PI_HI;
  return quarters > 0.5 && quarters < 4.5 && fabs(quarters - round(quarters)) < 0.01 * quarters;
}

/* `phi = 30` where '30 deg' is meant. */
static void hint_degrees(double v, double lower, double upper, diagnostics *d) {
  const double radians = v * PL_HALF_PI_HI / 90;
  const bool fits = radians >= lower && radians <= upper;
  if (fits && (is_of_angles(lower) || is_of_angles(upper)))
    diag_hint(d, "angles are in radians: `'%g deg'`", v);
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
    if (given[p] && pure && !by) hint_degrees(v, lower[p], upper[p], d);
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
