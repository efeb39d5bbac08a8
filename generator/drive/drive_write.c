/* What a drive leaves: table, CSV. */
#include "generator/drive/drive_write.h"

#include <ctype.h>
#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "dsl/base/elementary.h"
#include "dsl/base/terminal.h"
#include "generator/drive/drive_motion.h"
#include "generator/drive/drive_table.h"
#include "runtime/base/whole_file.h"

static void heading(const drive_column *c, char *text, size_t size) {
  if (unit_is_pure(c->unit))
    snprintf(text, size, "%s", c->name);
  else
    snprintf(text, size, "%s [%s]", c->name, c->unit);
}

/* --- what is printed -------------------------------------------------------------------------- */

/* Length of the name before the number of a neighbour: 1 of "F_12"; 0 without one. */
static int stem_of(const char *name) {
  const size_t length = strlen(name);
  size_t at = length;
  while (at > 0 && isdigit((unsigned char)name[at - 1]))
    at--;
  return at < length && at > 1 && name[at - 1] == '_' ? (int)at - 1 : 0;
}

/* One of more neighbours than a table has room for. */
static bool is_of_many(const drive_table *t, int column) {
  enum { ROOM = 12 };
  const char *name = t->columns[column].name;
  const int stem = stem_of(name);
  int family = 0;
  for (int c = 0; stem > 0 && c < t->column_count; c++)
    family +=
        stem_of(t->columns[c].name) == stem && strncmp(t->columns[c].name, name, (size_t)stem) == 0;
  return family > ROOM;
}

static double largest(const drive_table *t, int column) {
  double most = 0;
  for (long k = 0; k < t->rows; k++)
    if (!(fabs(t->columns[column].values[k]) <= most)) most = fabs(t->columns[column].values[k]);
  return most;
}

/* What is left of stresses that are held at 0, and of energies that balance. */
static double rounding_of(const drive_table *t, int column) {
  double most = 0;
  for (int c = 0; c < t->column_count && t->of == DRIVE_OF_POINTS; c++)
    if (strcmp(t->columns[c].unit, t->columns[column].unit) == 0)
      most = pl_fmax(most, largest(t, c));
  return 1e-12 * most;
}

/* Columns that are 0 throughout, such as the moments of a central law, are left out. */
static bool is_worth_showing(const drive_table *t, int column) {
  return column == DRIVE_COLUMN_TIME || column == t->way || column == t->force ||
         !(largest(t, column) <= rounding_of(t, column));
}

/* Of the terminal; where there is none, of a wide page. */
static int width_of(FILE *out) {
  enum { PAGE = 132, LEAST = 40 };
  const int columns = terminal_columns(out);
  return columns < LEAST ? PAGE : columns;
}

static int value_text(const drive_column *c, long row, char *text, size_t size) {
  return snprintf(text, size, "%.6g", c->values[row] + 0.0); /* no minus before zeros */
}

/* Of the heading and the values that are shown. */
static int column_width(const drive_table *t, int column, const bool *shown) {
  char text[128];
  heading(&t->columns[column], text, sizeof text);
  int width = (int)strlen(text);
  for (long k = 0; k < t->rows; k++) {
    const int used = shown[k] ? value_text(&t->columns[column], k, text, sizeof text) : 0;
    width = used > width ? used : width;
  }
  return width;
}

enum { GAP = 2 };

/* The heading for row -1. */
static void print_cell(const drive_table *t, int column, int width, long row, FILE *out) {
  char text[128];
  if (row < 0)
    heading(&t->columns[column], text, sizeof text);
  else
    value_text(&t->columns[column], row, text, sizeof text);
  fprintf(out, "%*s", width + GAP, text);
}

/* Columns `from` up to `to` of a list, each line begun with the time. */
static void print_block(const drive_table *t, const int *columns, const int *widths, int from,
                        int to, const bool *shown, FILE *out) {
  for (long row = -1; row < t->rows; row++) {
    if (row >= 0 && !shown[row]) continue;
    print_cell(t, columns[0], widths[0], row, out);
    for (int k = from; k < to; k++)
      print_cell(t, columns[k], widths[k], row, out);
    fputc('\n', out);
  }
}

/* As many columns beside each other as there is room for, the others below. */
static void print_blocks(const drive_table *t, const int *columns, int count, const bool *shown,
                         FILE *out) {
  const int room = width_of(out);
  int *widths = must_calloc((size_t)count, sizeof *widths);
  for (int k = 0; k < count; k++)
    widths[k] = column_width(t, columns[k], shown);
  for (int from = 1, to; from < count; from = to) {
    int used = widths[0] + widths[from] + 2 * GAP;
    for (to = from + 1; to < count && used + widths[to] + GAP <= room; to++)
      used += widths[to] + GAP;
    if (from > 1) fputc('\n', out);
    print_block(t, columns, widths, from, to, shown, out);
  }
  free(widths);
}

static void print_table(const drive_table *t, const bool *shown, FILE *out) {
  int *columns = must_calloc((size_t)t->column_count, sizeof *columns), count = 0, left = 0;
  for (int c = 0; c < t->column_count; c++) {
    if (!is_worth_showing(t, c)) continue;
    if (c != t->way && c != t->force && is_of_many(t, c))
      left++;
    else
      columns[count++] = c;
  }
  print_blocks(t, columns, count, shown, out);
  if (left > 0)
    fprintf(out, "%d columns of single neighbours are not shown; --csv FILE writes them\n", left);
  free(columns);
}

/* --- rows that are printed -------------------------------------------------------------------- */

static long row_of_largest_force(const drive_table *t) {
  const double *N = t->columns[t->force].values;
  long row = 0;
  for (long k = 1; k < t->rows; k++)
    if (fabs(N[k]) > fabs(N[row])) row = k;
  return row;
}

/* Marks `most` more rows, at corners of the path: every n-th where there are more. */
static void mark_corners(const drive_input *in, const drive_table *t, long most, bool *shown) {
  const double *time = t->columns[DRIVE_COLUMN_TIME].values;
  long corners, row = 0, unmarked = 0;
  double *at = drive_corners(in, &corners);
  long *rows = must_calloc((size_t)corners + 1, sizeof *rows);
  for (long k = 0; k < corners; k++) {
    while (row < t->rows - 1 &&
           time[row] < at[k] - 1e-12 * time[t->rows - 1]) /* as rows are kept apart */
      row++;
    if (!shown[row]) rows[unmarked++] = row;
  }
  for (long k = 0; most > 0 && k < unmarked; k += (unmarked + most - 1) / most)
    shown[rows[k]] = true;
  free(rows);
  free(at);
}

static long count_marked(const drive_table *t, const bool *shown) {
  long marked = 0;
  for (long k = 0; k < t->rows; k++)
    marked += shown[k];
  return marked;
}

/* Marks `more` rows, evenly spread between those that are marked; both ends are. */
static void mark_between(const drive_table *t, long more, bool *shown) {
  double share = (double)more / (double)(t->rows > 1 ? t->rows - 1 : 1), due = 0;
  for (long row = 0, next; row < t->rows - 1; row = next) {
    for (next = row + 1; !shown[next];)
      next++;
    due += share * (double)(next - row);
    const long here = (long)(due + 0.5) < next - row - 1 ? (long)(due + 0.5) : next - row - 1;
    for (long k = 1; k <= here; k++)
      shown[row + k * (next - row) / (here + 1)] = true;
    due -= (double)here;
  }
}

void drive_print(const drive_input *in, const drive_table *t, FILE *out) {
  const long most = in->output.rows;
  if (most < 1 || t->rows < 1) return;
  bool *shown = must_calloc((size_t)t->rows, sizeof *shown);
  shown[t->rows - 1] = true;
  if (most > 1) shown[0] = true;
  if (most > 2) shown[row_of_largest_force(t)] = true;
  mark_corners(in, t, most - count_marked(t, shown), shown);
  const long left = most - count_marked(t, shown);
  if (left > 0) mark_between(t, left, shown);
  print_table(t, shown, out);
  free(shown);
}

/* --- files ------------------------------------------------------------------------------------ */

static bool write_rows(const drive_table *t, FILE *out) {
  char text[128];
  for (int c = 0; c < t->column_count; c++) {
    heading(&t->columns[c], text, sizeof text);
    fprintf(out, "%s%s", c ? "," : "", text);
  }
  for (long k = 0; k < t->rows; k++)
    for (int c = 0; c < t->column_count; c++)
      fprintf(out, "%s%.17g", c ? "," : "\n", t->columns[c].values[k]);
  return fputc('\n', out) != EOF && !ferror(out);
}

static bool cannot_write(const char *path, char *error, size_t size) {
  snprintf(error, size, "cannot write `%s`: %s", path, strerror(errno));
  return false;
}

bool drive_write_csv(const drive_table *t, const char *path, char *error, size_t size) {
  whole_file whole;
  FILE *out = whole_file_open(&whole, path);
  if (!out) return cannot_write(path, error, size);
  bool good = write_rows(t, out);
  good = fclose(out) == 0 && good;
  return whole_file_end(&whole, good) || cannot_write(path, error, size);
}
