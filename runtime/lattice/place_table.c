#include "runtime/lattice/place_table.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

#include "dsl/base/arena.h"
#include "runtime/particles/particle_table.h"
#include "runtime/result/result_fields.h"
#include "runtime/result/result_file.h"
#include "runtime/result/result_find.h"
#include "runtime/result/result_names.h"
#include "runtime/result/result_read.h"

/* --- tables ----------------------------------------------------------------------------------- */

/* The only column that is no coordinate; -1 after a message. */
static int only_column(text_table *t, int dimensions, diagnostics *d) {
  static const char *const coordinates[] = {"x", "y", "z"};
  int found = -1, others = 0;
  for (int c = 0; c < t->column_count; c++) {
    bool is_value = true;
    for (int k = 0; k < dimensions; k++)
      is_value = is_value && strcasecmp(t->columns[c].name, coordinates[k]) != 0;
    if (is_value) found = c;
    others += is_value;
  }
  if (others == 1) return found;
  diag_report(d, DIAG_BAD_VALUE, text_table_header(t, d),
              "`%s` has %d columns beside those of the places", t->file.path, others);
  diag_hint(d, "name the one that is meant: 'FILE:NAME'");
  return -1;
}

static double *values_of_text(text_table *t, const deck_placed *p, int dimensions, span where,
                              diagnostics *d) {
  const int column =
      p->column ? text_table_column(t, p->column, where, d) : only_column(t, dimensions, d);
  return column < 0 ? NULL : text_table_values(t, column, p->unit_text, false, d);
}

/* --- results ---------------------------------------------------------------------------------- */

static bool unit_is(const char *given, const char *wanted) {
  const char *bad;
  size_t length;
  unit u = {DIMENSIONLESS, 1};
  if (*given && !unit_parse(given, strlen(given), &u, &bad, &length)) return false;
  return dim_equal(u.dim, dimension_of(wanted));
}

/* Component of each particle. */
static double *take_component(double *values, long count, int components, int component) {
  const int which = components == 1 ? 0 : component;
  for (long k = 0; k < count; k++)
    values[k] = values[k * components + which];
  return values;
}

static double *values_of_frame(result_file *f, const deck_placed *p, long places, span where,
                               diagnostics *d) {
  char error[1024] = "", of_field[64] = "";
  long frames = 0, count = 0;
  int components = 0;
  free(result_read_frame_times(f, &frames));
  double *values = result_read_frame(f, p->column, frames - 1, &count, &components, of_field,
                                     sizeof of_field, error, sizeof error);
  if (!values)
    diag_report(d, DIAG_FILE, where, "%s", error);
  else if (count != places)
    diag_report(d, DIAG_BAD_VALUE, where, "`%s` has no values on particles", p->column);
  else if (!unit_is(of_field, p->unit_text))
    diag_report(d, DIAG_UNITS, where, "`%s` is in %s, here a value in %s is needed", p->column,
                of_field, p->unit_text);
  else if (components > 1 && p->component < 0)
    diag_report(d, DIAG_BAD_VALUE, where, "`%s` has several components, here one number is needed",
                p->column);
  else if (components > 1 && p->component >= components)
    diag_report(d, DIAG_BAD_VALUE, where, "`%s` has no such component", p->column);
  else
    return take_component(values, count, components, p->component);
  free(values);
  return NULL;
}

static bool has_lattice(result_file *f, const deck_placed *p, span where, diagnostics *d) {
  result_names lattices = result_list(f, "/bonds");
  bool found = false;
  for (int k = 0; k < lattices.count; k++)
    found = found || strcmp(lattices.items[k], p->lattice) == 0;
  result_names_free(&lattices);
  if (found) return true;
  diag_report(d, DIAG_UNKNOWN_NAME, where,
              "the result is of several lattices, and none of them is named `%s`", p->lattice);
  return false;
}

static void keep(place_table *t, double *values, const bool *kept) {
  long count = 0;
  for (long k = 0; k < t->count; k++) {
    if (!kept[k]) continue;
    for (int c = 0; c < t->dimensions; c++)
      t->at[c][count] = t->at[c][k];
    values[count++] = values[k];
  }
  t->count = count;
}

/* Lattices may overlap: of several, that with the region's name counts. Its particles are those of
   its bonds. */
static bool keep_lattice(result_file *f, const deck_placed *p, place_table *t, double *values,
                         span where, diagnostics *d) {
  long bonds = 0;
  if (!has_lattice(f, p, where, d)) return false;
  int32_t *pairs = result_read_bonds(f, p->lattice, &bonds);
  bool *kept = must_calloc((size_t)t->count + 1, sizeof *kept);
  for (long b = 0; pairs && b < 2 * bonds; b++)
    kept[pairs[b]] = true;
  if (pairs)
    keep(t, values, kept);
  else
    diag_report(d, DIAG_FILE, where, "the bonds of `%s` cannot be read", p->lattice);
  free(kept);
  free(pairs);
  return pairs != NULL;
}

static bool is_of_several(result_file *f) {
  result_names lattices = result_list(f, "/bonds");
  const bool several = lattices.count > 1;
  result_names_free(&lattices);
  return several;
}

static double *values_of_result(const deck_placed *p, place_table *t, span where, diagnostics *d) {
  char error[1024];
  if (!p->column) {
    diag_report(d, DIAG_BAD_VALUE, where, "which field of the result is meant?");
    diag_hint(d, "name it behind a colon: 'run.h5:displacement'");
    return NULL;
  }
  result_file *f = result_read(p->path, error, sizeof error);
  if (!f) {
    diag_report(d, DIAG_FILE, where, "%s", error);
    return NULL;
  }
  double *values = values_of_frame(f, p, t->count, where, d);
  if (values && is_of_several(f) && !keep_lattice(f, p, t, values, where, d)) {
    free(values);
    values = NULL;
  }
  result_read_close(f);
  return values;
}

/* --- both ------------------------------------------------------------------------------------- */

bool place_table_read(place_table *t, const deck_placed *p, int dimensions, double spacing,
                      span where, diagnostics *d) {
  particle_table places;
  *t = (place_table){.dimensions = dimensions};
  bool good = particle_table_read(&places, must_copy(p->path), dimensions, 1, where, d);
  for (int c = 0; good && c < dimensions; c++) {
    t->at[c] = places.at[c]; /* taken over */
    places.at[c] = NULL;
  }
  t->count = places.count;
  if (good)
    t->value = places.text.columns ? values_of_text(&places.text, p, dimensions, where, d)
                                   : values_of_result(p, t, where, d);
  particle_table_free(&places);
  if (t->value) bins_of_size(&t->near, dimensions, (const double *const *)t->at, t->count, spacing);
  return t->value != NULL;
}

void place_table_free(place_table *t) {
  if (t->value) bins_end(&t->near);
  for (int c = 0; c < 3; c++)
    free(t->at[c]);
  free(t->value);
}

double place_table_mean(const place_table *t) {
  double sum = 0;
  long count = 0;
  for (long k = 0; k < t->count; k++) {
    if (!isfinite(t->value[k])) continue;
    sum += t->value[k];
    count++;
  }
  return sum / (double)count;
}

static double distance_square(const place_table *t, long k, const double at[3]) {
  double square = 0;
  for (int c = 0; c < t->dimensions; c++)
    square += (t->at[c][k] - at[c]) * (t->at[c][k] - at[c]);
  return square;
}

static void look_in_box(const place_table *t, const int box[3], const double at[3], double *least,
                        long *nearest) {
  const int64_t number = boxes_number(&t->near.boxes, box);
  for (int32_t k = number < 0 ? 0 : t->near.first[number];
       number >= 0 && k < t->near.first[number + 1]; k++) {
    const double square = distance_square(t, t->near.point[k], at);
    if (!(square <= *least)) continue;
    if (square == *least && *nearest >= 0 && *nearest < t->near.point[k]) continue;
    *least = square;
    *nearest = t->near.point[k];
  }
}

long place_table_nearest(const place_table *t, const double at[3], double within) {
  int home[3];
  double least = within * within;
  long nearest = -1;
  boxes_home(&t->near.boxes, at, home);
  for (int z = -1; z <= 1; z++)
    for (int y = -1; y <= 1; y++)
      for (int x = -1; x <= 1; x++)
        look_in_box(t, (const int[]){home[0] + x, home[1] + y, home[2] + z}, at, &least, &nearest);
  return nearest;
}
