#include "runtime/result/result_fields.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "dsl/base/arena.h"
#include "runtime/result/result_find.h"
#include "runtime/result/result_read.h"
#include "runtime/result/result_sets.h"

/* --- a field ---------------------------------------------------------------------------------- */

/* The set of a field, which stays open: frames that follow each other may lie in one chunk. */
static hid_t open_field(result_file *f, const char *field, char *error, size_t size) {
  if (f->field >= 0 && strcmp(f->field_name, field) == 0) return f->field;
  if (f->field >= 0) H5Dclose(f->field);
  f->field = result_set_named(f, "/frames", field, error, size);
  snprintf(f->field_name, sizeof f->field_name, "%s", field);
  return f->field;
}

static double *read_slab(hid_t set, long frame, int rank, const hsize_t shape[3]) {
  hsize_t start[3] = {(hsize_t)frame, 0, 0}, count[3] = {1, shape[1], rank > 2 ? shape[2] : 1};
  double *values = must_calloc((size_t)(count[1] * count[2]) + 1, sizeof *values);
  hid_t space = H5Dget_space(set), memory = H5Screate_simple(rank, count, NULL);
  bool good = H5Sselect_hyperslab(space, H5S_SELECT_SET, start, NULL, count, NULL) >= 0 &&
              H5Dread(set, H5T_NATIVE_DOUBLE, memory, space, H5P_DEFAULT, values) >= 0;
  H5Sclose(memory);
  H5Sclose(space);
  if (good) return values;
  free(values);
  return NULL;
}

/* A frame of a data set, a field. */
static double *read_of_set(result_file *f, hid_t set, const char *field, long frame, long *count,
                           int *components, char *unit_text, size_t unit_size, char *error,
                           size_t size) {
  int rank = 0;
  hsize_t shape[3] = {0, 0, 0};
  if (!result_set_shape(set, 1, &rank, shape) || rank < 2) {
    result_set_report(f, set);
    snprintf(error, size, "`%s` of `%s` is not a field with a value for each particle or bond",
             field, f->path);
    return NULL;
  }
  long frames = (long)shape[0], wanted = frame < 0 ? frames + frame : frame;
  double *values = NULL;
  if (wanted < 0 || wanted >= frames)
    snprintf(error, size, "`%s` has %ld frames, numbered from 0; there is no frame %ld", f->path,
             frames, frame);
  else if (!(values = read_slab(set, wanted, rank, shape))) {
    result_set_report(f, set);
    snprintf(error, size, "frame %ld of %s", wanted, f->trouble);
  }
  *count = (long)shape[1];
  *components = rank > 2 ? (int)shape[2] : 1;
  h5_read_attribute_text(set, "units", unit_text, unit_size);
  return values;
}

static double *read_one(result_file *f, const char *field, long frame, long *count, int *components,
                        char *unit_text, size_t unit_size, char *error, size_t size) {
  const hid_t set = open_field(f, field, error, size);
  if (set < 0) return NULL;
  return read_of_set(f, set, field, frame, count, components, unit_text, unit_size, error, size);
}

double *result_read_cells(result_file *f, const char *field, long frame, long *count,
                          char *unit_text, size_t unit_size) {
  char path[560], unsaid[1700];
  int components = 0;
  snprintf(path, sizeof path, "/cells/%.500s", field);
  const hid_t set = result_set_open(f, path);
  if (set < 0) return NULL;
  double *values = read_of_set(f, set, field, frame, count, &components, unit_text, unit_size,
                               unsaid, sizeof unsaid);
  H5Dclose(set);
  if (values && components == 1) return values;
  free(values);
  return NULL;
}

/* --- fields of bonds -------------------------------------------------------------------------- */

static long bonds_in(result_file *f, const char *interaction) {
  char path[512];
  hsize_t shape[3] = {0, 0, 0};
  int rank;
  snprintf(path, sizeof path, "/bonds/%.500s", interaction);
  const hid_t set = result_set_open(f, path);
  const bool good = set >= 0 && result_set_shape(set, 0, &rank, shape) && rank == 2;
  if (set >= 0) H5Dclose(set);
  return good ? (long)shape[0] : 0;
}

static const result_names *interactions_of(result_file *f) {
  if (f->first_bond) return &f->interactions;
  f->interactions = result_list(f, "/bonds");
  f->first_bond = must_calloc((size_t)f->interactions.count + 1, sizeof *f->first_bond);
  for (int k = 0; k < f->interactions.count; k++)
    f->first_bond[k + 1] = f->first_bond[k] + bonds_in(f, f->interactions.items[k]);
  return &f->interactions;
}

static bool is_of(const char *field, const char *interaction) {
  const size_t own = strlen(interaction);
  return strncmp(field, interaction, own) == 0 && field[own] == '/';
}

/* Puts the field of one interaction where its bonds are among all. False with a sentence. */
static bool put_bonds(result_file *f, const char *field, int interaction, long frame, double *all,
                      char *unit_text, size_t unit_size, char *error, size_t size) {
  char found[64] = "";
  long count = 0;
  int components = 0;
  const long first = f->first_bond[interaction], bonds = f->first_bond[interaction + 1] - first;
  double *values = read_one(f, field, frame, &count, &components, found, sizeof found, error, size);
  bool good = values != NULL;
  if (good && (count != bonds || components != 1)) {
    snprintf(error, size, "`%s` in `%s` is not one number a bond", field, f->path);
    good = false;
  }
  if (good && *unit_text && strcmp(unit_text, found) != 0) {
    snprintf(error, size, "`%s` has one unit in `%s` and another elsewhere: give the whole name",
             result_names_last(field), field);
    good = false;
  }
  snprintf(unit_text, unit_size, "%s", found);
  if (good) memcpy(all + first, values, (size_t)bonds * sizeof *all);
  free(values);
  return good;
}

/* In the order of result_read_bonds; NaN where an interaction has no such field. */
static double *read_bonds_of_all(result_file *f, const char *name, long frame, long *count,
                                 char *unit_text, size_t unit_size, char *error, size_t size) {
  const result_names *all = interactions_of(f), *fields = result_names_in(f, "/frames");
  const bool any = strncmp(name, "*/", 2) == 0;
  *count = f->first_bond[all->count];
  double *values = must_calloc((size_t)*count + 1, sizeof *values);
  bool good = true;
  for (long b = 0; b < *count; b++)
    values[b] = NAN;
  *unit_text = 0;
  for (int k = 0; good && k < fields->count; k++) {
    const char *field = fields->items[k];
    if (any ? strcmp(result_names_last(field), name + 2) != 0 : strcmp(field, name) != 0) continue;
    for (int n = 0; good && n < all->count; n++)
      if (is_of(field, all->items[n]))
        good = put_bonds(f, field, n, frame, values, unit_text, unit_size, error, size);
  }
  if (good) return values;
  free(values);
  return NULL;
}

double *result_read_frame(result_file *f, const char *field, long frame, long *count,
                          int *components, char *unit_text, size_t unit_size, char *error,
                          size_t size) {
  char name[512];
  if (!result_find(f, "/frames", field, name, sizeof name, error, size)) return NULL;
  if (!strchr(name, '/') || interactions_of(f)->count < 2)
    return read_one(f, name, frame, count, components, unit_text, unit_size, error, size);
  *components = 1;
  return read_bonds_of_all(f, name, frame, count, unit_text, unit_size, error, size);
}

static bool is_damage(result_file *f, const char *field) {
  char path[512], kind[16] = "";
  snprintf(path, sizeof path, "/frames/%.500s", field);
  hid_t set = result_set_open(f, path);
  if (set < 0) return false;
  h5_read_attribute_text(set, "kind", kind, sizeof kind);
  H5Dclose(set);
  return strcmp(kind, "damage") == 0;
}

/* Takes one more damage into `most`, which may be NULL; frees it. NULL when they do not fit. */
static double *larger_of(double *most, long bonds, double *more, long count) {
  if (!most) return more;
  const bool fits = more && count == bonds;
  for (long b = 0; fits && b < bonds; b++)
    if (!(most[b] >= more[b]) && !isnan(more[b])) most[b] = more[b];
  free(more);
  if (fits) return most;
  free(most);
  return NULL;
}

double *result_read_damage(result_file *f, long frame, long *bonds, char *error, size_t size) {
  const result_names *fields = result_names_in(f, "/frames");
  double *most = NULL;
  bool good = true;
  error[0] = 0;
  *bonds = 0;
  for (int k = 0; good && k < fields->count; k++) {
    const char *name = fields->items[k];
    char unit_text[16];
    long count = 0;
    int components = 0;
    if (!strchr(name, '/') || !is_damage(f, name)) continue;
    double *more = result_read_frame(f, name, frame, &count, &components, unit_text,
                                     sizeof unit_text, error, size);
    if (more && components != 1) { /* one number a bond */
      free(more);
      more = NULL;
      snprintf(error, size, "`%s` in `%s` is not one number a bond", name, f->path);
    }
    most = larger_of(most, *bonds, more, count);
    *bonds = count;
    good = most != NULL;
  }
  return most;
}

/* --- bonds ------------------------------------------------------------------------------------ */

static bool name_particles(const int32_t *pairs, long bonds, long particles) {
  for (long k = 0; k < 2 * bonds; k++)
    if (pairs[k] < 0 || pairs[k] >= particles) return false;
  return true;
}

static int32_t *read_pairs(result_file *f, const char *interaction, long particles, long *bonds) {
  char path[512];
  int columns;
  snprintf(path, sizeof path, "/bonds/%.500s", interaction);
  int32_t *pairs = result_read_table(f, path, true, 2, 2, bonds, &columns);
  if (!pairs || name_particles(pairs, *bonds, particles)) return pairs;
  snprintf(f->trouble, sizeof f->trouble, "`%s` of `%s` names particles that are not there", path,
           f->path);
  free(pairs);
  return NULL;
}

int32_t *result_read_bonds(result_file *f, const char *interaction, long *bonds) {
  const result_names *names = interactions_of(f);
  long particles = 0;
  int columns;
  free(result_read_reference(f, &particles, &columns));
  *bonds = 0;
  if (interaction) return read_pairs(f, interaction, particles, bonds);
  int32_t *all = NULL;
  for (int k = 0; k < names->count; k++) {
    long count = 0;
    int32_t *more = read_pairs(f, names->items[k], particles, &count);
    if (!more) {
      free(all);
      *bonds = 0;
      return NULL;
    }
    all = must_realloc(all, 2 * (size_t)(*bonds + count + 1) * sizeof *all);
    if (count) memcpy(all + 2 * *bonds, more, 2 * (size_t)count * sizeof *all);
    *bonds += count;
    free(more);
  }
  return all;
}
