/* perilat export: histories, or one frame of a result, as comma-separated values. */
#include <errno.h>
#include <limits.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "dsl/arena.h"
#include "generator/commands.h"
#include "generator/model.h"
#include "generator/result_table.h"
#include "runtime/whole_file.h"

static const char program[] = "perilat export";

typedef struct export_request {
  const char *result, *output; /* output NULL: standard output */
  const char **names;          /* the only histories or fields to write; none given: all */
  int name_count;
  const char *of_histories,
      *of_frames; /* an option that only this table knows, when one was given */
  bool bonds, framed;
  long frame;
} export_request;

/* --- writing ---------------------------------------------------------------------------------- */

/* The shortest text that reads back as the same number. */
static void write_number(FILE *out, double value) {
  value += 0.0; /* no minus before zeros */
  char text[40];
  for (int digits = 15; digits <= 17; digits++) {
    snprintf(text, sizeof text, "%.*g", digits, value);
    if (strtod(text, NULL) == value) break;
  }
  fputs(text, out);
}

/* A name with its unit; quoted as CSV wants it when a name holds what separates. */
static void write_title(FILE *out, const table_values *v, int component) {
  bool quoted = strpbrk(v->name, ",\"\n") != NULL;
  if (quoted) putc('"', out);
  for (const char *c = v->name; *c; c++) {
    if (*c == '"') putc('"', out);
    putc(*c, out);
  }
  fprintf(out, "%s [%s]%s", table_component(v->components, component), *v->unit ? v->unit : "1",
          quoted ? "\"" : "");
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

/* --- tables ----------------------------------------------------------------------------------- */

/* Columns of a table, and the names that they stand under. */
typedef struct table {
  result_names names;
  table_values *columns;
  int count;
  long rows, frame; /* frame -1: histories */
} table;

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
    fprintf(stderr, "perilat: error: %s\n", error);
  else if (v->count != t->rows)
    fprintf(stderr, "perilat: error: `%s` has %ld values where %ld are expected\n", v->name,
            v->count, t->rows);
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
      fprintf(stderr, "perilat: error: `%s` is a field of %s; %s --bonds\n", name,
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

static bool export_history(result_file *f, const export_request *q, FILE *out) {
  char error[1024];
  table t = table_new(f, q, -1);
  bool good = table_read(f, "time", -1, &t.columns[0], error, sizeof error);
  if (!good) fprintf(stderr, "perilat: error: %s\n", error);
  if (good && !*t.columns[0].unit) strcpy(t.columns[0].unit, "s");
  t.count = good;
  t.rows = t.columns[0].count;
  good = good && add_columns(&t, f, q);
  if (good) write_titles(out, t.columns, t.count);
  for (long row = 0; good && row < t.rows; row++) {
    putc('\n', out);
    write_row(out, t.columns, t.count, row);
  }
  if (good) putc('\n', out);
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

static bool export_frame(result_file *f, const export_request *q, FILE *out) {
  long frames = 0, particles = 0, bonds = 0;
  free(result_read_frame_times(f, &frames));
  const long frame = q->frame < 0 ? frames + q->frame : q->frame;
  if (frame < 0 || frame >= frames) {
    fprintf(stderr, "perilat: error: `%s` has %ld frames, numbered from 0; there is no frame %ld\n",
            q->result, frames, q->frame);
    return false;
  }
  frame_rows rows = {.reference = NULL};
  rows.reference = result_read_reference(f, &particles, &rows.dimensions);
  if (q->bonds) rows.bonds = result_read_bonds(f, NULL, &bonds);
  rows.count = q->bonds ? bonds : particles;
  bool good = rows.reference && (rows.bonds || !q->bonds);
  if (!good)
    fprintf(stderr, "perilat: error: `%s` does not say where its %s are\n", q->result,
            q->bonds ? "bonds" : "particles");
  table t = table_new(f, q, frame);
  t.rows = rows.count;
  good = good && add_columns(&t, f, q);
  if (good) write_frame(out, &rows, t.columns, t.count);
  table_free(&t);
  free(rows.reference);
  free(rows.bonds);
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
    else if (option_flag(argv, &at, "--bonds"))
      q->bonds = true;
    else if ((v = option_value(argc, argv, &at, "--frame", &bad))) {
      q->framed = true;
      errno = 0;
      q->frame = strtol(v, &end, 10);
      if (!bad && (*end || end == v || errno || labs(q->frame) > INT_MAX)) {
        fprintf(stderr, "perilat: error: --frame needs a whole number, not `%s`\n", v);
        bad = 1;
      }
    } else if (argv[at][0] == '-')
      bad = option_unknown("export", argv[at]);
    else if (q->result) {
      fprintf(stderr, "perilat: error: `%s` takes one result; `%s` is a second one\n", program,
              argv[at]);
      bad = 1;
    } else
      q->result = argv[at++];
  }
  return !bad;
}

static bool complete(const export_request *q) {
  if (!q->result)
    fputs("perilat: error: `perilat export` needs a result file\n  perilat export result.h5 -o "
          "history.csv\n",
          stderr);
  else if (q->of_histories && (q->framed || q->of_frames))
    fputs("perilat: error: histories and a frame are two tables; export one at a time\n", stderr);
  else if (q->of_frames && !q->framed)
    fputs(
        "perilat: error: --field belongs to frames; add --frame N, e.g. --frame -1 for the last\n",
        stderr);
  else if (q->bonds && !q->framed)
    fputs(
        "perilat: error: --bonds belongs to frames; add --frame N, e.g. --frame -1 for the last\n",
        stderr);
  else if (q->output && same_file(q->output, q->result))
    fprintf(stderr,
            "perilat: error: the table would overwrite `%s`; give it another name with -o\n",
            q->result);
  else
    return true;
  return false;
}

/* 0, or the exit status 2 after a message. */
static int write_table(const char *text, size_t length, const char *path) {
  if (!path) return fwrite(text, 1, length, stdout) == length ? 0 : 2; /* main says why */
  whole_file file;
  FILE *out = whole_file_open(&file, path);
  bool good = out && fwrite(text, 1, length, out) == length;
  good = out && fclose(out) == 0 && good;
  good = out && whole_file_end(&file, good);
  if (good)
    printf("written %s\n", path);
  else
    fprintf(stderr, "perilat: error: cannot write `%s`: %s\n", path, strerror(errno));
  return good ? 0 : 2;
}

/* The table is made whole before anything is written. */
static int export_result(const export_request *q) {
  result_file *f = table_open(program, q->result);
  if (!f) return 1;
  char *text = NULL;
  size_t length = 0;
  FILE *out = open_memstream(&text, &length);
  bool good = out && (q->framed ? export_frame(f, q, out) : export_history(f, q, out));
  const bool whole = out && fclose(out) == 0;
  good = table_close(f, good);
  if (good && !whole) fputs("perilat: error: not enough memory for the table\n", stderr);
  const int status = !good ? 1 : !whole ? 2 : write_table(text, length, q->output);
  free(text);
  return status;
}

int command_export(int argc, char **argv) {
  export_request q = {.names = must_calloc((size_t)argc + 1, sizeof *q.names)};
  const int status = read_request(argc, argv, &q) && complete(&q) ? export_result(&q) : 1;
  free(q.names);
  return status;
}
