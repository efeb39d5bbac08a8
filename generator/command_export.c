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

static const char program[] = "perilat export";

typedef struct export_request {
  const char *result, *output; /* output NULL: standard output */
  bool history, bonds, framed;
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

/* Reads the named columns; all have `rows` values. False after a message. */
static bool read_columns(result_file *f, const table_names *names, long frame, bool bonds,
                         long rows, table_values *columns, int *count) {
  char error[1024];
  for (int k = 0; k < names->count; k++) {
    if (frame >= 0 && table_on_bonds(names->items[k]) != bonds) continue;
    table_values *v = &columns[*count];
    if (!table_read(f, names->items[k], frame, v, error, sizeof error)) {
      fprintf(stderr, "perilat: error: %s\n", error);
      return false;
    }
    ++*count;
    if (v->count != rows) {
      fprintf(stderr, "perilat: error: `%s` has %ld values where %ld are expected\n", v->name,
              v->count, rows);
      return false;
    }
  }
  return true;
}

static bool export_history(result_file *f, FILE *out) {
  char error[1024];
  table_names names = table_names_of(f, "/history");
  table_values *columns = must_calloc((size_t)names.count + 1, sizeof *columns);
  int count = 1;
  bool good = table_read(f, "time", -1, &columns[0], error, sizeof error);
  if (!good) fprintf(stderr, "perilat: error: %s\n", error);
  if (good && !*columns[0].unit) strcpy(columns[0].unit, "s");
  good = good && read_columns(f, &names, -1, false, columns[0].count, columns, &count);
  if (good) write_titles(out, columns, count);
  for (long row = 0; good && row < columns[0].count; row++) {
    putc('\n', out);
    write_row(out, columns, count, row);
  }
  if (good) putc('\n', out);
  for (int k = 0; k < count; k++)
    free(columns[k].values);
  free(columns);
  table_names_free(&names);
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
  table_names names = table_names_of(f, "/frames");
  table_values *columns = must_calloc((size_t)names.count + 1, sizeof *columns);
  int count = 0;
  good = good && read_columns(f, &names, frame, q->bonds, rows.count, columns, &count);
  if (good) write_frame(out, &rows, columns, count);
  for (int k = 0; k < count; k++)
    free(columns[k].values);
  free(columns);
  table_names_free(&names);
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
    else if (option_flag(argv, &at, "--history"))
      q->history = true;
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
  else if (q->history && q->framed)
    fputs("perilat: error: --history and --frame are two tables; export one at a time\n", stderr);
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
  FILE *out = path ? fopen(path, "w") : stdout;
  bool good = out && fwrite(text, 1, length, out) == length;
  if (path && out) good = fclose(out) == 0 && good;
  if (good && path) printf("written %s\n", path);
  if (!good)
    fprintf(stderr, "perilat: error: cannot write `%s`: %s\n", path ? path : "standard output",
            strerror(errno));
  return good ? 0 : 2;
}

/* The table is made whole before a file of that name is touched. */
int command_export(int argc, char **argv) {
  export_request q = {0};
  if (!read_request(argc, argv, &q) || !complete(&q)) return 1;
  result_file *f = table_open(program, q.result);
  if (!f) return 1;
  char *text = NULL;
  size_t length = 0;
  FILE *table = open_memstream(&text, &length);
  bool good = table && (q.framed ? export_frame(f, &q, table) : export_history(f, table));
  const bool whole = table && fclose(table) == 0;
  result_read_close(f);
  if (good && !whole) fputs("perilat: error: not enough memory for the table\n", stderr);
  const int status = !good ? 1 : !whole ? 2 : write_table(text, length, q.output);
  free(text);
  return status;
}
