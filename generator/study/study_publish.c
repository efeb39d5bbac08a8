#include "generator/study/study_publish.h"

#include <string.h>

#include "generator/kernel/document.h"

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

/* "spacing = 10 mm, E = 30 GPa" */
static const char *label_of(const study_outcome *o, const study_case *c) {
  const char *label = "";
  for (int k = 0; k < c->value_count && k < o->key_count; k++)
    label = arena_printf(o->request->memory, "%s%s%s = %s", label, k ? ", " : "", o->keys[k],
                         c->values[k]);
  return *label ? label : c->name;
}

/* False after a message. A study without a result has none. */
static bool draw(const study_outcome *o, const char *path) {
  const char *results[MOST_CURVES], *labels[MOST_CURVES], *x = NULL, *y = NULL;
  char error[2048];
  int count = 0;
  for (int k = 0; k < o->count && count < MOST_CURVES - o->beside_count; k++) {
    if (!o->rows[k].there) continue;
    results[count] = o->cases[k].result;
    labels[count++] = label_of(o, &o->cases[k]);
    x = o->rows[k].x_name;
    y = o->rows[k].y_name;
  }
  const plot_curve_options options = {.output = path,
                                      .x = x,
                                      .y = y,
                                      .labels = labels,
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
  study_table_print(&t, stdout);
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
