/* perilat export: histories, one frame, or cracks of a result, as comma-separated values. */
#include <errno.h>
#include <limits.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "dsl/base/arena.h"
#include "dsl/base/characters.h"
#include "dsl/base/digits.h"
#include "dsl/base/terminal.h"
#include "generator/command/commands.h"
#include "generator/kernel/document.h"
#include "generator/kernel/model.h"
#include "generator/results/result_table.h"
#include "runtime/base/whole_file.h"
#include "runtime/result/result_fields.h"
#include "runtime/result/result_find.h"
#include "runtime/result/result_names.h"
#include "runtime/result/result_read.h"

static const char program[] = "perilat export";

typedef struct export_request {
  const char *result, *output; /* output NULL: standard output */
  const char **names;          /* the only histories or fields to write; none given: all */
  int name_count;
  const char *of_histories,
      *of_frames;     /* an option that only this table knows, when one was given */
  const char *cracks; /* of this monitor */
  bool bonds, framed, json;
  long frame;
} export_request;

/* --- writing ---------------------------------------------------------------------------------- */

static void write_number(FILE *out, double value) {
  char text[DIGITS_TEXT];
  fputs(fewest_digits(value + 0.0, text), out); /* no minus before zeros */
}

/* As RFC 4180 wants a text in quotes. */
static void write_quoted(FILE *out, const char *text) {
  for (; *text; text++) {
    if (*text == '"') putc('"', out);
    putc(*text, out);
  }
}

/* A name with its unit; quoted when one of them holds what separates. */
static void write_title(FILE *out, const table_values *v, int component) {
  static const char separates[] = ",\"\r\n";
  const char *part = table_component(v->components, component), *in = *v->unit ? v->unit : "1";
  if (!strpbrk(v->name, separates) && !strpbrk(in, separates)) {
    fprintf(out, "%s%s [%s]", v->name, part, in);
    return;
  }
  putc('"', out);
  write_quoted(out, v->name);
  fprintf(out, "%s [", part);
  write_quoted(out, in);
  fputs("]\"", out);
}

static void write_titles(FILE *out, const table_values *columns, int count) {
  for (int k = 0; k < count; k++)
    for (int c = 0; c < columns[k].components; c++) {
      if (k + c > 0) putc(',', out);
      write_title(out, &columns[k], c);
    }
}

static void write_row(FILE *out, const table_values *columns, int count, long row) {
  for (int k = 0; k < count; k++)
    for (int c = 0; c < columns[k].components; c++) {
      if (k + c > 0) putc(',', out);
      write_number(out, columns[k].values[row * columns[k].components + c]);
    }
}

/* --- as JSON ---------------------------------------------------------------------------------- */

/* unchecked: of a history, why it says nothing, or ""; NULL: no history. */
static void open_column(json *w, const char *name, const char *ending, const char *unit_name,
                        const char *unchecked) {
  char title[300];
  snprintf(title, sizeof title, "%s%s", name, ending);
  json_object(w);
  json_put_text(w, "name", title);
  json_put_text(w, "unit", *unit_name ? unit_name : "1");
  if (unchecked) json_put_text(w, "unchecked", *unchecked ? unchecked : NULL);
  json_put_array(w, "values");
}

static void close_column(json *w) {
  json_array_end(w);
  json_object_end(w);
}

/* --- tables ----------------------------------------------------------------------------------- */

/* Columns of a table, and the names that they stand under. */
typedef struct table {
  result_names names;
  table_values *columns;
  int count;
  long rows, frame; /* frame -1: histories */
} table;

static void put_columns(json *w, const table *t) {
  for (int k = 0; k < t->count; k++)
    for (int c = 0; c < t->columns[k].components; c++) {
      const table_values *v = &t->columns[k];
      open_column(w, v->name, table_component(v->components, c), v->unit,
                  t->frame < 0 ? v->unchecked : NULL);
      for (long row = 0; row < v->count; row++)
        json_number(w, v->values[row * v->components + c] + 0.0);
      close_column(w);
    }
}

static table table_new(result_file *f, const export_request *q, long frame) {
  table t = {.names = result_members(f, frame < 0 ? "/history" : "/frames"), .frame = frame};
  t.columns = must_calloc((size_t)(t.names.count + q->name_count) + 1, sizeof *t.columns);
  return t;
}

static void table_free(table *t) {
  for (int k = 0; k < t->count; k++)
    free(t->columns[k].values);
  free(t->columns);
  result_names_free(&t->names);
}

/* False after a message. */
static bool add_column(table *t, result_file *f, const char *name) {
  char error[1024];
  table_values *v = &t->columns[t->count];
  const bool good = table_read(f, name, t->frame, v, error, sizeof error);
  t->count += good;
  if (!good)
    say_error("%s", error);
  else if (v->count != t->rows)
    say_error("`%s` has %ld values where %ld are expected", name_shown(v->name), v->count, t->rows);
  return good && v->count == t->rows;
}

static bool add_all(table *t, result_file *f, bool bonds) {
  bool good = true;
  for (int k = 0; good && k < t->names.count; k++)
    if (t->frame < 0 || table_on_bonds(t->names.items[k]) == bonds)
      good = add_column(t, f, t->names.items[k]);
  return good;
}

/* Those asked for, in that order; they stand under their full names. */
static bool add_asked(table *t, result_file *f, const export_request *q) {
  bool good = true;
  for (int k = 0; good && k < q->name_count; k++) {
    const int n = result_names_find(&t->names, q->names[k]);
    const char *name = n < 0 ? q->names[k] : t->names.items[n];
    if (n >= 0 && t->frame >= 0 && table_on_bonds(name) != q->bonds) {
      say_error("`%s` is a field of %s; %s --bonds", name_shown(name),
                q->bonds ? "particles" : "bonds", q->bonds ? "leave out" : "add");
      good = false;
    } else
      good = add_column(t, f, name);
  }
  return good;
}

static bool add_columns(table *t, result_file *f, const export_request *q) {
  return q->name_count ? add_asked(t, f, q) : add_all(t, f, q->bonds);
}

static void write_rows(FILE *out, const table *t) {
  write_titles(out, t->columns, t->count);
  for (long row = 0; row < t->rows; row++) {
    putc('\n', out);
    write_row(out, t->columns, t->count, row);
  }
  putc('\n', out);
}

static void put_rows(json *w, const char *of, const table *t) {
  json_put_text(w, "of", of);
  json_put_integer(w, "rows", t->rows);
  json_put_array(w, "columns");
  put_columns(w, t);
  json_array_end(w);
}

static bool export_history(result_file *f, const export_request *q, FILE *out, json *w) {
  char error[1024];
  table t = table_new(f, q, -1);
  bool good = table_read(f, "time", -1, &t.columns[0], error, sizeof error);
  if (!good) say_error("%s", error);
  if (good && !*t.columns[0].unit) strcpy(t.columns[0].unit, "s");
  t.count = good;
  t.rows = t.columns[0].count;
  good = good && add_columns(&t, f, q);
  if (good && w)
    put_rows(w, "history", &t);
  else if (good)
    write_rows(out, &t);
  table_free(&t);
  return good;
}

/* What a row of a frame is about, before its fields: a particle and its place, or a bond and its
 * ends. */
typedef struct frame_rows {
  double *reference; /* [particles][dimensions] m */
  int dimensions;
  int32_t *bonds; /* [rows][2]; NULL: rows are particles */
  long count;
} frame_rows;

static void write_frame(FILE *out, const frame_rows *rows, const table_values *columns, int count) {
  const int n = rows->dimensions, places = (rows->bonds ? 2 : 1) * n;
  fputs(rows->bonds ? "bond,i,j" : "particle", out);
  for (int c = 0; c < places; c++)
    fprintf(out, ",%c%s [m]", "xyz"[c % n], !rows->bonds ? "" : c < n ? "_i" : "_j");
  putc(count ? ',' : '\n', out);
  write_titles(out, columns, count);
  putc('\n', out);
  for (long row = 0; row < rows->count; row++) {
    const int32_t own = (int32_t)row, *ends = rows->bonds ? &rows->bonds[2 * row] : &own;
    fprintf(out, "%ld", row);
    for (int e = 0; rows->bonds && e < 2; e++)
      fprintf(out, ",%d", (int)ends[e]);
    for (int c = 0; c < places; c++) {
      putc(',', out);
      write_number(out, rows->reference[n * ends[c / n] + c % n]);
    }
    if (count) putc(',', out);
    write_row(out, columns, count, row);
    putc('\n', out);
  }
}

static void put_whole(json *w, const char *name, const int32_t *values, int stride, long count) {
  open_column(w, name, "", "", NULL);
  for (long row = 0; row < count; row++)
    json_integer(w, values ? values[stride * row] : row);
  close_column(w);
}

static void put_frame(json *w, const frame_rows *rows, const table *t, double time) {
  const int n = rows->dimensions, places = (rows->bonds ? 2 : 1) * n;
  json_put_text(w, "of", rows->bonds ? "bonds" : "particles");
  json_put_integer(w, "frame", t->frame);
  json_put_number(w, "time", time);
  json_put_integer(w, "rows", rows->count);
  json_put_array(w, "columns");
  put_whole(w, rows->bonds ? "bond" : "particle", NULL, 0, rows->count);
  for (int e = 0; rows->bonds && e < 2; e++)
    put_whole(w, e ? "j" : "i", rows->bonds + e, 2, rows->count);
  for (int c = 0; c < places; c++) {
    open_column(w, (const char[]){"xyz"[c % n], 0},
                !rows->bonds ? ""
                : c < n      ? "_i"
                             : "_j",
                "m", NULL);
    for (long row = 0; row < rows->count; row++)
      json_number(w,
                  rows->reference[n * (rows->bonds ? rows->bonds[2 * row + c / n] : row) + c % n]);
    close_column(w);
  }
  put_columns(w, t);
  json_array_end(w);
}

/* The number of the frame that is asked for; -1 after a message. */
static long find_frame(const export_request *q, long frames) {
  const long frame = q->frame < 0 ? frames + q->frame : q->frame;
  if (frame >= 0 && frame < frames) return frame;
  say_error("`%s` has %ld frames, numbered from 0; there is no frame %ld", q->result, frames,
            q->frame);
  return -1;
}

static bool export_frame(result_file *f, const export_request *q, FILE *out, json *w) {
  long frames = 0, particles = 0, bonds = 0;
  double *times = result_read_frame_times(f, &frames);
  const long frame = find_frame(q, times ? frames : 0);
  const double time = frame < 0 ? 0 : times[frame];
  free(times);
  if (frame < 0) return false;
  frame_rows rows = {.reference = NULL};
  rows.reference = result_read_reference(f, &particles, &rows.dimensions);
  if (q->bonds) rows.bonds = result_read_bonds(f, NULL, &bonds);
  rows.count = q->bonds ? bonds : particles;
  bool good = rows.reference && (rows.bonds || !q->bonds);
  if (!good)
    say_error("`%s` does not say where its %s are", q->result, q->bonds ? "bonds" : "particles");
  table t = table_new(f, q, frame);
  t.rows = rows.count;
  good = good && add_columns(&t, f, q);
  if (good && w)
    put_frame(w, &rows, &t, time);
  else if (good)
    write_frame(out, &rows, t.columns, t.count);
  table_free(&t);
  free(rows.reference);
  free(rows.bonds);
  return good;
}

/* --- cracks ---------------------------------------------------------------------------------- */

enum { CRACK_FRAME, CRACK_TIME, CRACK_FIRST, CRACK_SECOND, CRACK_COLUMNS };

/* A row for each crack of each frame, from the values of result_read_cracks; or for each point of a
   crack, from those of result_read_path. */
static table list_cracks(const double *values, long frames, long most, const double *times,
                         bool path) {
  static const char *const widths[CRACK_COLUMNS] = {"frame", "time", "place", "width"},
                           *const points[CRACK_COLUMNS] = {"frame", "time", "x", "y"};
  const char *const *names = path ? points : widths;
  static const char *const units[CRACK_COLUMNS] = {"1", "s", "m", "m"};
  table t = {.columns = must_calloc(CRACK_COLUMNS, sizeof *t.columns), .count = CRACK_COLUMNS};
  for (int c = 0; c < CRACK_COLUMNS; c++) {
    table_values *v = &t.columns[c];
    *v = (table_values){.name = names[c], .components = 1};
    strcpy(v->unit, units[c]);
    v->values = must_calloc((size_t)(frames * most) + 1, sizeof *v->values);
  }
  for (long n = 0; n < frames * most; n++) {
    if (isnan(values[2 * n])) continue;
    const double row[CRACK_COLUMNS] = {(double)(n / most), times[n / most], values[2 * n],
                                       values[2 * n + 1]};
    for (int c = 0; c < CRACK_COLUMNS; c++)
      t.columns[c].values[t.rows] = row[c];
    t.rows++;
  }
  for (int c = 0; c < CRACK_COLUMNS; c++)
    t.columns[c].count = t.rows;
  return t;
}

static bool export_cracks(result_file *f, const export_request *q, FILE *out, json *w) {
  char error[1024];
  long frames = 0, most = 0, instants = 0;
  const bool path = result_has_path(f, q->cracks);
  double *values = path ? result_read_path(f, q->cracks, &frames, &most, error, sizeof error)
                        : result_read_cracks(f, q->cracks, &frames, &most, error, sizeof error),
         *times = result_read_frame_times(f, &instants);
  const bool good = values && times && instants >= frames;
  if (!good) say_error("%s", values ? "the frames have no times" : error);
  if (good) {
    table t = list_cracks(values, frames, most, times, path);
    if (w)
      put_rows(w, "cracks", &t);
    else
      write_rows(out, &t);
    table_free(&t);
  }
  free(values);
  free(times);
  return good;
}

/* --- the command ------------------------------------------------------------------------------ */

static bool read_request(int argc, char **argv, export_request *q) {
  int bad = 0;
  const char *v;
  for (int at = 0; at < argc && !bad;) {
    char *end;
    if ((v = option_value(argc, argv, &at, "-o", &bad)))
      q->output = v;
    else if ((v = option_value(argc, argv, &at, "--history", &bad)))
      q->names[q->name_count++] = q->of_histories = v;
    else if ((v = option_value(argc, argv, &at, "--field", &bad)))
      q->names[q->name_count++] = q->of_frames = v;
    else if ((v = option_value(argc, argv, &at, "--cracks", &bad)))
      q->cracks = v;
    else if (option_flag(argv, &at, "--bonds"))
      q->bonds = true;
    else if (option_flag(argv, &at, "--json"))
      q->json = true;
    else if ((v = option_value(argc, argv, &at, "--frame", &bad))) {
      q->framed = true;
      errno = 0;
      q->frame = strtol(v, &end, 10);
      if (!bad && (*end || end == v || errno || labs(q->frame) > INT_MAX)) {
        say_error("--frame needs a whole number, not `%s`", v);
        bad = 1;
      }
    } else if (argv[at][0] == '-')
      bad = option_unknown("export", argv[at]);
    else if (q->result) {
      say_error("`%s` takes one result; `%s` is a second one", program, argv[at]);
      bad = 1;
    } else
      q->result = argv[at++];
  }
  return !bad;
}

static bool complete(const export_request *q) {
  if (!q->result)
    say_error("`perilat export` needs a result file\n  perilat export result.h5 -o "
              "history.csv");
  else if (q->of_histories && (q->framed || q->of_frames))
    say_error("histories and a frame are two tables; export one at a time");
  else if (q->cracks && (q->framed || q->of_frames || q->of_histories || q->bonds))
    say_error("cracks are a table of their own; leave out --history, --frame, --field and --bonds");
  else if (q->of_frames && !q->framed)
    say_error("--field belongs to frames; add --frame N, e.g. --frame -1 for the last");
  else if (q->bonds && !q->framed)
    say_error("--bonds belongs to frames; add --frame N, e.g. --frame -1 for the last");
  else if (q->json && q->output)
    say_error("--json writes to the standard output; leave out -o");
  else if (q->output && same_file(q->output, q->result))
    say_error("the table would overwrite `%s`; give it another name with -o", q->result);
  else
    return true;
  return false;
}

/* 0, or the exit status 2 after a message. */
static int write_table(const char *text, size_t length, const char *path) {
  if (!path) {
    terminal_expect_data();
    return fwrite(text, 1, length, stdout) == length ? 0 : 2; /* main says why */
  }
  whole_file file;
  FILE *out = whole_file_open(&file, path);
  bool good = out && fwrite(text, 1, length, out) == length;
  good = out && fclose(out) == 0 && good;
  good = out && whole_file_end(&file, good);
  if (good)
    printf("written %s\n", path);
  else
    say_error("cannot write `%s`: %s", path, strerror(errno));
  return good ? 0 : 2;
}

/* 0 or 1. */
static int export_table(const export_request *q, FILE *out, json *w) {
  result_file *f = table_open(program, q->result);
  if (!f) return 1;
  const bool good = q->cracks   ? export_cracks(f, q, out, w)
                    : q->framed ? export_frame(f, q, out, w)
                                : export_history(f, q, out, w);
  return table_close(f, good) ? 0 : 1;
}

static int export_to_json(const export_request *q) {
  document d;
  document_begin(&d);
  json_put_text(&d.writer, "result", q->result);
  return document_end(&d, export_table(q, NULL, &d.writer));
}

/* The table is made whole before anything is written. */
static int export_result(const export_request *q) {
  char *text = NULL;
  size_t length = 0;
  FILE *out = must_open_text(&text, &length);
  const bool good = export_table(q, out, NULL) == 0;
  must_close_text(out);
  const int status = good ? write_table(text, length, q->output) : 1;
  free(text);
  return status;
}

static int export_as_asked(const export_request *q) {
  return q->json ? export_to_json(q) : export_result(q);
}

int command_export(int argc, char **argv) {
  export_request q = {.names = must_calloc((size_t)argc + 1, sizeof *q.names)};
  const int status = read_request(argc, argv, &q) && complete(&q) ? export_as_asked(&q) : 1;
  free(q.names);
  return status;
}
