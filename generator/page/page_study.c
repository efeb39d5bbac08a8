#include "generator/page/page_study.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "dsl/base/units.h"
#include "generator/page/diagram.h"
#include "generator/page/html.h"
#include "generator/page/packing.h"
#include "generator/page/page_data.h"
#include "generator/page/shell.h"
#include "generator/study/study_read.h"

enum { KEY = 16, MOST_POINTS = 400000 };

/* "c12": of a case, for the script. */
static const char *key_of(int k, char text[KEY]) {
  snprintf(text, KEY, "c%d", k);
  return text;
}

/* --- the verdict ------------------------------------------------------------------------------ */

static int failed_cases(const study_reading *r) {
  const study_column *status = study_reading_column(r, "status");
  int failed = 0;
  for (int k = 0; k < r->table.rows; k++)
    failed += !r->curves || k >= r->curve_count || r->curves[k].count == 0 ||
              (status && status->values && status->values[k] != 0);
  return failed;
}

/* The largest and the smallest of the peaks. */
static void put_peaks(FILE *out, const study_reading *r) {
  char name[400];
  snprintf(name, sizeof name, "%.300s peak", r->y_name);
  const study_column *peaks = study_reading_column(r, name);
  const double *v = peaks ? peaks->values : NULL;
  int least = -1, most = -1;
  for (int k = 0; v && k < r->table.rows; k++) {
    if (!isfinite(v[k])) continue;
    if (least < 0 || v[k] < v[least]) least = k;
    if (most < 0 || v[k] > v[most]) most = k;
  }
  if (most < 0) return;
  for (int n = 0; n < 2; n++) {
    const int k = n ? least : most;
    fprintf(out, "<div class=\"card good\"><dt>%s peak of ", n ? "smallest" : "largest");
    html_text(out, r->y_name);
    fputs("</dt><dd>", out);
    html_put_quantity(out, v[k], peaks->unit);
    fputs("<small>", out);
    html_text(out, k < r->curve_count ? r->curves[k].name : "");
    fputs("</small></dd></div>\n", out);
  }
}

static void put_verdict(FILE *out, const study_reading *r, const char *path) {
  const int failed = failed_cases(r), rows = r->table.rows;
  fprintf(out, "<section class=\"verdict %s\" aria-label=\"verdict\">\n<p class=\"sentence\">",
          failed ? "wrong" : "good");
  if (failed)
    fprintf(out, "%d of %d case%s did not come to an end.", failed, rows, rows == 1 ? "" : "s");
  else
    fprintf(out, "All %d case%s done.", rows, rows == 1 ? "" : "s");
  fputs("</p>\n<p class=\"quiet\">", out);
  html_text(out, path);
  fputs("</p>\n<dl>\n", out);
  put_peaks(out, r);
  fputs("</dl></section>\n", out);
}

/* --- the table -------------------------------------------------------------------------------- */

static void put_cell(FILE *out, const study_column *c, int row) {
  fputs(c->texts ? "<td>" : "<td class=\"number\">", out);
  if (c->texts)
    html_text(out, c->texts[row]);
  else if (isfinite(c->values[row]))
    html_print(out, "%.6g", c->values[row] + 0.0);
  fputs("</td>", out);
}

static void put_title(FILE *out, const study_column *c) {
  fputs("<th>", out);
  html_text(out, c->name);
  if (!c->texts && !unit_is_pure(c->unit)) {
    fputs(" [", out);
    html_unit(out, c->unit);
    fputc(']', out);
  }
  fputs("</th>", out);
}

/* Columns that people are shown, or all others. */
static void put_table(FILE *out, const study_table *t, bool shown) {
  fputs("<div class=\"scroll\"><table><thead><tr>", out);
  for (int k = 0; k < t->column_count; k++)
    if (t->columns[k].shown == shown) put_title(out, &t->columns[k]);
  fputs("</tr></thead><tbody>\n", out);
  for (int row = 0; row < t->rows; row++) {
    fputs("<tr>", out);
    for (int k = 0; k < t->column_count; k++)
      if (t->columns[k].shown == shown) put_cell(out, &t->columns[k], row);
    fputs("</tr>\n", out);
  }
  fputs("</tbody></table></div>\n", out);
}

static bool any_column(const study_table *t, bool shown) {
  for (int k = 0; k < t->column_count; k++)
    if (t->columns[k].shown == shown) return true;
  return false;
}

static void put_tables(FILE *out, const study_reading *r) {
  fputs("<section><h2>The cases</h2>\n", out);
  if (any_column(&r->table, true)) put_table(out, &r->table, true);
  if (any_column(&r->table, false)) {
    fputs("<details><summary>All other columns</summary>\n", out);
    put_table(out, &r->table, false);
    fputs("</details>\n", out);
  }
  fputs("</section>\n", out);
}

/* --- curves ----------------------------------------------------------------------------------- */

static void put_curves(FILE *out, const study_reading *r) {
  char(*keys)[KEY] = must_calloc((size_t)r->curve_count + 1, sizeof *keys);
  diagram_curve *curves = must_calloc((size_t)r->curve_count + 1, sizeof *curves);
  int count = 0;
  const study_curve *first = NULL;
  for (int k = 0; k < r->curve_count; k++) {
    const study_curve *c = &r->curves[k];
    if (c->count == 0) continue;
    if (!first) first = c;
    curves[count++] = (diagram_curve){.label = c->name,
                                      .x = c->x,
                                      .y = c->y,
                                      .count = c->count,
                                      .ink = k,
                                      .series = "y",
                                      .of = key_of(k, keys[k])};
  }
  char title[700];
  snprintf(title, sizeof title, "%.300s over %.300s", r->y_name, r->x_name);
  const diagram d = {.title = title,
                     .x_name = r->x_name,
                     .x_unit = first ? first->x_unit : "1",
                     .y_name = r->y_name,
                     .y_unit = first ? first->y_unit : "1",
                     .curves = curves,
                     .count = count,
                     .large = true,
                     .over = "x"};
  fputs("<section><h2>Their curves</h2>\n", out);
  diagram_legend(out, &d);
  fputs("<figure class=\"curve\"><figcaption>", out);
  html_text(out, title);
  fputs("</figcaption>\n", out);
  if (count == 0 || !diagram_svg(out, &d)) fputs("<p class=\"none\">none</p>", out);
  fputs("</figure>\n</section>\n", out);
  free(curves);
  free(keys);
}

/* --- numbers ---------------------------------------------------------------------------------- */

/* Every `stride`-th and the last one. */
static void put_values(json *w, const char *name, const double *values, long count, long stride) {
  packing bytes = {.bytes = NULL};
  for (long k = 0; k < count; k++)
    if (k % stride == 0 || k + 1 == count) packing_doubles(&bytes, &values[k], 1);
  page_put_packed(w, name, &bytes);
}

static void put_case(json *w, const study_reading *r, int k, long stride) {
  const study_curve *c = &r->curves[k];
  const struct {
    const char *name, *shown;
    const double *values;
  } series[] = {{"x", r->x_name, c->x}, {"y", r->y_name, c->y}};
  char key[KEY];
  json_put_object(w, key_of(k, key));
  json_put_text(w, "path", c->name);
  json_put_text(w, "samples", "");
  json_put_text(w, "timeName", "time");
  put_values(w, "time", c->time, c->count, stride);
  json_put_array(w, "series");
  for (int n = 0; n < 2; n++) {
    json_object(w);
    json_put_text(w, "name", series[n].name);
    json_put_text(w, "shown", series[n].shown);
    put_values(w, "values", series[n].values, c->count, stride);
    json_object_end(w);
  }
  json_array_end(w);
  json_object_end(w);
}

/* malloc'ed */
static char *data_of(const study_reading *r) {
  char *text = NULL;
  size_t length;
  long points = 0;
  for (int k = 0; k < r->curve_count; k++)
    points += r->curves[k].count;
  FILE *out = must_open_text(&text, &length);
  json w;
  json_begin(&w, out);
  json_object(&w);
  for (int k = 0; k < r->curve_count; k++)
    if (r->curves[k].count > 0) put_case(&w, r, k, 1 + points / MOST_POINTS);
  json_object_end(&w);
  json_end(&w);
  must_close_text(out);
  return text;
}

int page_of_study(FILE *out, const char *path) {
  const char *slash = strrchr(path, '/'), *name = slash ? slash + 1 : path;
  arena *memory = arena_new();
  study_reading r;
  const bool good = study_read(memory, path, &r);
  if (good) {
    char *data = data_of(&r);
    shell_begin(out, name);
    fputs("<main>\n<header><h1>A study of ", out);
    fprintf(out, "%d case%s", r.table.rows, r.table.rows == 1 ? "" : "s");
    fputs("</h1></header>\n", out);
    put_verdict(out, &r, name);
    put_curves(out, &r);
    put_tables(out, &r);
    fputs("</main>\n", out);
    shell_end(out, data);
    free(data);
  }
  arena_free(memory);
  return good ? 0 : 1;
}
