#include "generator/study/study_publish.h"

#include <stdlib.h>
#include <string.h>

#include "generator/kernel/document.h"
#include "runtime/result/result_read.h"

enum { MOST_CURVES = 64 };

bool study_read_rows(study_outcome *o) {
  bool good = true;
  o->rows = arena_alloc(o->request->memory, ((size_t)o->count + 1) * sizeof *o->rows);
  for (int k = 0; k < o->count && good; k++)
    good = study_row_read(o->request->memory, &o->cases[k], o->x, o->y, &o->rows[k]);
  return good;
}

int study_rows_there(const study_outcome *o) {
  int there = 0;
  for (int k = 0; k < o->count; k++)
    there += o->rows[k].there;
  return there;
}

int study_rows_good(const study_outcome *o) {
  int good = 0;
  for (int k = 0; k < o->count; k++)
    good += o->rows[k].there && o->rows[k].of->status == 0;
  return good;
}

/* --- the picture ------------------------------------------------------------------------------ */

static bool is_drawn(const study_outcome *o, int k) {
  return o->rows[k].there && (!o->drawn || o->drawn[k]);
}

/* All cases that are drawn have it. */
static bool is_common(const study_outcome *o, int key) {
  const char *first = NULL;
  int drawn = 0;
  for (int k = 0; k < o->count; k++) {
    if (!is_drawn(o, k)) continue;
    const char *value = o->cases[k].values[key];
    if (first && strcmp(first, value) != 0) return false;
    first = value;
    drawn++;
  }
  return drawn > 1;
}

/* With six digits at most. */
static const char *value_shown(arena *a, const char *value) {
  double number;
  const char *symbol_text;
  if (!study_split_number(value, &number, &symbol_text)) return value;
  return arena_printf(a, "%.6g%s%s", number, *symbol_text ? " " : "", symbol_text);
}

/* "spacing = 10 mm, E = 30 GPa" */
static const char *label_of(const study_outcome *o, const study_case *c) {
  arena *a = o->request->memory;
  const char *label = o->request->decks.count > 1 ? c->deck : "";
  const char *slash = strrchr(label, '/');
  label = slash ? slash + 1 : label;
  for (int k = 0; k < c->value_count && k < o->key_count; k++)
    if (!is_common(o, k))
      label = arena_printf(a, "%s%s%s = %s", label, *label ? ", " : "", o->keys[k],
                           value_shown(a, c->values[k]));
  return *label ? label : c->name;
}

/* Of the deck, which may tell the value that is varied: "Plain beam" of "Plain beam, 42 kN/m". */
static const char *title_of(const study_outcome *o, const char *path) {
  char error[1024];
  result_file *f = result_read(path, error, sizeof error);
  if (!f) return "";
  char *title = result_read_title(f);
  const char *kept = arena_text(o->request->memory, title, strcspn(title, ",:;"));
  free(title);
  result_read_close(f);
  return kept;
}

/* False after a message. A study without a result has none. */
static bool draw(const study_outcome *o, const char *path) {
  const char *results[MOST_CURVES], *labels[MOST_CURVES], *x = NULL, *y = NULL;
  char error[2048];
  int count = 0;
  for (int k = 0; k < o->count && count < MOST_CURVES - o->beside_count; k++) {
    if (!is_drawn(o, k)) continue;
    results[count] = o->cases[k].result;
    labels[count++] = label_of(o, &o->cases[k]);
    x = o->rows[k].x_name;
    y = o->rows[k].y_name;
  }
  const plot_curve_options options = {.output = path,
                                      .x = x,
                                      .y = y,
                                      .labels = labels,
                                      .title = count ? title_of(o, results[0]) : NULL,
                                      .y_most = o->y_most,
                                      .beside = o->beside,
                                      .beside_count = o->beside_count};
  if (plot_curve(results, count, &options, error, sizeof error)) return true;
  say_error("%s", error);
  return false;
}

/* --- all of it -------------------------------------------------------------------------------- */

bool study_publish(const study_outcome *o, json *w) {
  arena *a = o->request->memory;
  const char *name = study_name(o->request);
  const char *csv = arena_printf(a, "%s.csv", name), *h5 = arena_printf(a, "%s.h5", name),
             *png = arena_printf(a, "%s.png", name);
  study_table t = study_table_of(a, o->rows, o->count, o->keys, o->key_count);
  for (int k = 0; k < o->more_count; k++)
    study_table_add(a, &t, &o->more[k]);
  const bool drawn = study_rows_there(o) > 0;
  study_table_print(&t, o->drawn, stdout);
  if (w) study_table_json(&t, "cases", w);
  if (!study_table_csv(&t, csv) || !study_table_hdf5(&t, o->rows, h5) || (drawn && !draw(o, png)))
    return false;
  printf("  wrote %s, %s%s%s; results and what runs said in %s/\n", csv, h5, drawn ? ", " : "",
         drawn ? png : "", name);
  if (!w) return true;
  json_put_array(w, "files");
  json_text(w, csv);
  json_text(w, h5);
  if (drawn) json_text(w, png);
  json_array_end(w);
  return true;
}
