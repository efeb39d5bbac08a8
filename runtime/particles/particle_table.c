#include "runtime/particles/particle_table.h"

#include <fcntl.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "dsl/base/arena.h"
#include "runtime/base/ordinary_file.h"
#include "runtime/result/result_file.h"
#include "runtime/result/result_read.h"

#define FARTHEST 1e30 /* m, m^2, m^3: squares and cubes of sums are finite */

enum { X, Y, Z, VOLUME, AREA, COLUMNS };
static const char *const column_names[] = {"x", "y", "z", "volume", "area"};
static const char *const column_units[] = {"m", "m", "m", "m^3", "m^2"};

typedef struct reader {
  particle_table *table;
  span where;
  double thickness;
  diagnostics *d;
  int column[COLUMNS]; /* of the text, or TEXT_TABLE_NONE */
} reader;

span particle_table_where(particle_table *t, long particle, span otherwise, diagnostics *d) {
  return t->text.columns ? text_table_line(&t->text, t->row[particle], d) : otherwise;
}

const char *particle_table_name(const particle_table *t, long particle,
                                char text[PARTICLE_TABLE_TEXT]) {
  if (t->text.columns)
    snprintf(text, PARTICLE_TABLE_TEXT, "line %ld",
             text_table_line_number(&t->text, t->row[particle]));
  else
    snprintf(text, PARTICLE_TABLE_TEXT, "particle %ld of the result", t->row[particle]);
  return text;
}

static bool no_particles(const reader *r) {
  diag_report(r->d, DIAG_EMPTY_REGION, r->where, "`%s` holds no particle",
              r->table->text.file.path);
  return false;
}

static void number_rows(particle_table *t) {
  t->row = must_alloc(((size_t)t->count + 1) * sizeof *t->row);
  for (long k = 0; k < t->count; k++)
    t->row[k] = k;
}

/* --- tables ----------------------------------------------------------------------------------- */

static span header(const reader *r) {
  return text_table_header(&r->table->text, r->d);
}

static bool lacks(const reader *r, const char *name) {
  diag_report(r->d, DIAG_MISSING_KEY, header(r), "the table has no column `%s`", name);
  diag_hint(r->d, "its first line names the columns, e.g. %s",
            r->table->dimensions == 2 ? "x [mm], y [mm], volume [mm^3]"
                                      : "x [mm], y [mm], z [mm], volume [mm^3]");
  return false;
}

static bool columns_suit(const reader *r) {
  const bool plane = r->table->dimensions == 2;
  for (int c = 0; c < r->table->dimensions; c++)
    if (r->column[c] < 0) return lacks(r, column_names[c]);
  if (plane && r->column[Z] >= 0) {
    diag_report(r->d, DIAG_CONFLICT, header(r),
                "the table has a column `z`, the lattice is in the plane");
    diag_hint(r->d, "give the lattice `setting = 'space'`, or leave the column out");
  } else if (!plane && r->column[AREA] >= 0) {
    diag_report(r->d, DIAG_CONFLICT, header(r),
                "particles in space have a `volume`, not an `area`");
  } else if (r->column[AREA] >= 0 && r->column[VOLUME] >= 0) {
    diag_report(r->d, DIAG_CONFLICT, header(r), "`area` and `volume` exclude each other");
  } else {
    return true;
  }
  return false;
}

/* Columns are known by their names only. */
static bool find_columns(reader *r) {
  text_table *text = &r->table->text;
  for (int c = 0; c < COLUMNS; c++) {
    r->column[c] = text_table_find(text, column_names[c], r->d);
    if (r->column[c] == TEXT_TABLE_TWO) return false;
  }
  return columns_suit(r);
}

static bool value_suits(const reader *r, int column, long row, double value) {
  text_table *text = &r->table->text;
  const bool far = fabs(value) > FARTHEST, flat = column >= VOLUME && !(value > 0);
  if (!far && !flat) return true;
  const span where = text_table_cell(text, row, r->column[column], r->d);
  if (far)
    diag_report(r->d, DIAG_BAD_NUMBER, where, "`%s` is too large here", column_names[column]);
  else
    diag_report(r->d, DIAG_OUT_OF_BOUNDS, where, "`%s` must be positive", column_names[column]);
  return false;
}

static bool read_column(const reader *r, int column, double **values) {
  text_table *text = &r->table->text;
  if (r->column[column] < 0) return true;
  *values = text_table_values(text, r->column[column], column_units[column], false, r->d);
  bool good = *values != NULL;
  for (long k = 0; good && k < text->rows; k++)
    good = value_suits(r, column, k, (*values)[k]);
  return good;
}

static bool read_text(reader *r) {
  particle_table *t = r->table;
  if (t->text.column_count == 0) return no_particles(r);
  if (!find_columns(r)) return false;
  bool good = true;
  for (int c = 0; good && c < t->dimensions; c++)
    good = read_column(r, c, &t->at[c]);
  const bool areas = r->column[AREA] >= 0;
  if (!good || !read_column(r, areas ? AREA : VOLUME, &t->volume)) return false;
  t->count = t->text.rows;
  for (long k = 0; t->volume && !areas && t->dimensions == 2 && k < t->count; k++)
    t->volume[k] /= r->thickness;
  number_rows(t);
  return t->count > 0 || no_particles(r);
}

/* --- results ---------------------------------------------------------------------------------- */

static bool refuse_file(const reader *r, const char *why) {
  diag_report(r->d, DIAG_FILE, r->where, "cannot read `%s`: %s", r->table->text.file.path, why);
  return false;
}

static bool is_result(const char *path) {
  char head[8] = "";
  const char *why;
  const int file = ordinary_file_open(path, O_RDONLY, &why);
  FILE *in = file >= 0 ? fdopen(file, "rb") : NULL;
  if (!in) return false;
  const size_t length = fread(head, 1, sizeof head, in);
  fclose(in);
  return length == sizeof head && memcmp(head, "\x89HDF\r\n\x1a\n", sizeof head) == 0;
}

static bool take_places(const reader *r, const double *reference, int dimensions) {
  particle_table *t = r->table;
  number_rows(t);
  for (int c = 0; c < dimensions; c++) {
    t->at[c] = must_alloc(((size_t)t->count + 1) * sizeof(double));
    for (long k = 0; k < t->count; k++) {
      t->at[c][k] = reference[k * dimensions + c];
      if (!(fabs(t->at[c][k]) <= FARTHEST))
        return refuse_file(r, "a place in it is not finite, or too far away");
    }
  }
  for (long k = 0; t->volume && k < t->count; k++) {
    if (t->dimensions == 2) t->volume[k] /= r->thickness;
    if (!(t->volume[k] > 0 && t->volume[k] <= FARTHEST))
      return refuse_file(r, "a volume in it is not positive");
  }
  return true;
}

static bool take_result(const reader *r, result_file *f) {
  particle_table *t = r->table;
  int dimensions;
  long volumes, spacings;
  double *reference = result_read_reference(f, &t->count, &dimensions);
  t->volume = result_read_volume(f, &volumes);
  t->spacing = result_read_spacing(f, &spacings);
  bool good = false;
  if (result_trouble(f))
    diag_report(r->d, DIAG_FILE, r->where, "%s", result_trouble(f));
  else if (!reference || (t->volume && volumes != t->count) || (t->spacing && spacings != t->count))
    refuse_file(r, "its particles are damaged");
  else if (dimensions != t->dimensions)
    diag_report(r->d, DIAG_CONFLICT, r->where,
                "the particles of `%s` are in %s, the lattice is in %s", t->text.file.path,
                dimensions == 2 ? "the plane" : "space", dimensions == 2 ? "space" : "the plane");
  else if (t->count == 0)
    no_particles(r);
  else
    good = take_places(r, reference, dimensions);
  free(reference);
  return good;
}

static bool read_result(reader *r) {
  char error[1024];
  result_file *f = result_read(r->table->text.file.path, error, sizeof error);
  if (!f) {
    diag_report(r->d, DIAG_FILE, r->where, "%s", error);
    return false;
  }
  const bool good = take_result(r, f);
  result_read_close(f);
  return good;
}

bool particle_table_read(particle_table *t, char *path, int dimensions, double thickness,
                         span where, diagnostics *d) {
  *t = (particle_table){.dimensions = dimensions, .text = {.file = {.path = path}}};
  reader r = {.table = t, .where = where, .thickness = thickness, .d = d};
  if (is_result(path)) return read_result(&r);
  return text_table_read(&t->text, path, where, d) && read_text(&r);
}

void particle_table_free(particle_table *t) {
  for (int c = 0; c < 3; c++)
    free(t->at[c]);
  free(t->volume);
  free(t->spacing);
  free(t->row);
  text_table_free(&t->text);
}
