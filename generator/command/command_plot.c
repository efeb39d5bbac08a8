/* perilat plot: curves of histories, or the map of a frame. */
#include <errno.h>
#include <limits.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "dsl/base/arena.h"
#include "generator/command/commands.h"
#include "generator/kernel/document.h"
#include "generator/kernel/model.h"
#include "generator/results/frame_choice.h"
#include "generator/results/measured.h"
#include "generator/study/study_plot.h"
#include "generator/study/study_read.h"
#include "runtime/base/quantity.h"
#include "runtime/plot/plot_curve.h"
#include "runtime/plot/plot_map.h"
#include "runtime/plot/plot_paths.h"

/* --data, with the --band of two of its columns; --line; --band of two values. */
typedef struct beside_request {
  enum { BESIDE_TABLE, BESIDE_LINE, BESIDE_LEVELS } kind;
  const char *text, *band;
} beside_request;

typedef struct plot_request {
  const char **results, **labels, **ys;
  int result_count, label_count, y_count;
  beside_request *besides;
  int beside_count, table_count;
  plot_curve_options curve;
  plot_map_options map;
  const char *frames, *frame; /* as given */
  bool is_map, is_paths;
  plot_paths_options paths;
  const char *of_curves, *of_maps; /* an option that only these know, when one was given */
} plot_request;

static bool read_number(const char *name, const char *text, double *value) {
  char *end;
  *value = strtod(text, &end);
  if (!*end && end != text && isfinite(*value)) return true;
  say_error("%s needs a number, not `%s`", name, text);
  return false;
}

static bool read_whole(const char *name, const char *text, long *value) {
  char *end;
  errno = 0;
  *value = strtol(text, &end, 10);
  if (!*end && end != text && !errno && labs(*value) < INT_MAX) return true;
  say_error("%s needs a whole number, not `%s`", name, text);
  return false;
}

/* A number, an axis, or a component of a tensor. */
static bool read_component(const char *text, plot_map_options *o) {
  static const char *const parts[] = {"xx", "yy", "zz", "xy", "yz", "xz", "principal"};
  long whole;
  for (size_t k = 0; k < sizeof parts / sizeof *parts; k++)
    if (strcmp(text, parts[k]) == 0) {
      o->part = text;
      return true;
    }
  if (strlen(text) == 1 && strchr("xyz", *text))
    whole = *text - 'x';
  else if (!read_whole("--component", text, &whole))
    return false;
  o->component = (int)whole;
  return true;
}

/* "z=0.05" or "x=5 mm". */
static bool read_slice(const char *text, plot_map_options *o) {
  const char *axis = strchr("xyz", text[0]);
  if (text[0] && axis && text[1] == '=' &&
      quantity_read(text + 2, strlen(text + 2), "m", &o->slice_at)) {
    o->slice_axis = (int)(axis - "xyz");
    return true;
  }
  say_error(
      "--slice needs an axis and a place in m or with a unit, e.g. z=0.05 or 'x=5 mm', not `%s`",
      text);
  return false;
}

/* Takes an option that only curves, or only maps, know. */
static const char *special_value(int argc, char **argv, int *at, const char *name,
                                 const char **seen, int *bad) {
  const char *v = option_value(argc, argv, at, name, bad);
  if (v) *seen = name;
  return v;
}

static bool set_once(const char **x, const char *given) {
  if (*x)
    say_error("--x is given twice, `%s` and `%s`; all curves of a picture have one x", *x, given);
  const bool first = !*x;
  *x = given;
  return first;
}

static bool add_beside(plot_request *q, int kind, const char *text) {
  q->table_count += kind == BESIDE_TABLE;
  q->besides[q->beside_count++] = (beside_request){.kind = kind, .text = text};
  return true;
}

/* Values stand for themselves; columns, by names or numbers, are those of the table before. */
static bool add_band(plot_request *q, const char *text) {
  const char *equals = strrchr(text, '=');
  beside_request *last = q->beside_count ? &q->besides[q->beside_count - 1] : NULL;
  const bool of_table = last && last->kind == BESIDE_TABLE && !last->band;
  const bool numbers = strspn(text, "0123456789, ") == strlen(text);
  if (quantity_begins(equals ? equals + 1 : text) && !(numbers && of_table))
    return add_beside(q, BESIDE_LEVELS, text);
  if (of_table) {
    last->band = text;
    return true;
  }
  say_error("--band %s follows the --data of its table: --data lab.csv --band low,high", text);
  return false;
}

/* One option or file; false after a message. */
static bool read_one(int argc, char **argv, int *at, plot_request *q) {
  int bad = 0;
  long whole = -1;
  const char *v;
  if ((v = option_value(argc, argv, at, "-o", &bad)))
    q->curve.output = q->map.output = v;
  else if ((v = option_value(argc, argv, at, "--title", &bad)))
    q->curve.title = q->map.title = v;
  else if ((v = option_value(argc, argv, at, "--map", &bad))) {
    q->map.field = v;
    q->is_map = true;
  } else if (option_flag(argv, at, "--cracks"))
    q->is_paths = true;
  else if ((v = special_value(argc, argv, at, "--x", &q->of_curves, &bad)))
    bad = bad || !set_once(&q->curve.x, v);
  else if ((v = special_value(argc, argv, at, "--y", &q->of_curves, &bad)))
    q->ys[q->y_count++] = v;
  else if ((v = special_value(argc, argv, at, "--x-unit", &q->of_curves, &bad)))
    q->curve.x_unit = v;
  else if ((v = special_value(argc, argv, at, "--y-unit", &q->of_curves, &bad)))
    q->curve.y_unit = v;
  else if ((v = option_value(argc, argv, at, "--label", &bad)))
    q->labels[q->label_count++] = v;
  else if ((v = special_value(argc, argv, at, "--data", &q->of_curves, &bad)))
    add_beside(q, BESIDE_TABLE, v);
  else if ((v = special_value(argc, argv, at, "--line", &q->of_curves, &bad)))
    add_beside(q, BESIDE_LINE, v);
  else if ((v = special_value(argc, argv, at, "--band", &q->of_curves, &bad)))
    bad = bad || !add_band(q, v);
  else if ((v = option_value(argc, argv, at, "--frame", &bad)))
    bad = bad || !read_whole("--frame", q->frame = v, &q->map.frame);
  else if ((v = special_value(argc, argv, at, "--frames", &q->of_maps, &bad)))
    q->frames = v;
  else if ((v = special_value(argc, argv, at, "--mark", &q->of_maps, &bad)))
    q->map.mark = v;
  else if ((v = special_value(argc, argv, at, "--factor", &q->of_maps, &bad)))
    bad = bad || !read_number("--factor", v, &q->map.factor);
  else if ((v = special_value(argc, argv, at, "--component", &q->of_maps, &bad))) {
    bad = bad || !read_component(v, &q->map);
  } else if ((v = special_value(argc, argv, at, "--range", &q->of_maps, &bad)))
    q->map.range = v;
  else if ((v = special_value(argc, argv, at, "--contours", &q->of_maps, &bad))) {
    bad = bad || !read_whole("--contours", v, &whole);
    q->map.contours = (int)whole;
    if (!bad && (whole < 1 || whole > PLOT_MOST_CONTOURS)) {
      say_error("--contours needs a number of lines from 1 to %d", PLOT_MOST_CONTOURS);
      bad = 1;
    }
  } else if ((v = special_value(argc, argv, at, "--slice", &q->of_maps, &bad)))
    bad = bad || !read_slice(v, &q->map);
  else if (argv[*at][0] == '-')
    bad = option_unknown("plot", argv[*at]);
  else
    q->results[q->result_count++] = argv[(*at)++];
  return !bad;
}

/* --- beside computed curves ------------------------------------------------------------------- */

typedef struct beside_set {
  measured *tables;
  double (*values)[2];
  plot_beside *items; /* they point into the others */
} beside_set;

static bool read_table(const beside_request *b, const measured_axes *axes, const char *label,
                       measured *m, plot_beside *item) {
  source_set sources = {NULL, 0};
  diagnostics said;
  diag_begin(&said, &sources);
  const bool good = measured_read(m, "--data", b->text, b->band, axes, &said);
  *item = (plot_beside){label ? label : m->label, m->x, m->y, m->low, m->high, m->count};
  diag_print(&said, stderr);
  diag_clear(&said);
  source_clear(&sources);
  return good;
}

static bool read_beside(const plot_request *q, int k, const measured_axes *axes, int *tables,
                        beside_set *s) {
  const beside_request *b = &q->besides[k];
  const char *const *labels = q->label_count > q->result_count ? q->labels + q->result_count : NULL;
  double *v = s->values[k];
  const int table = *tables;
  s->items[k] = (plot_beside){.label = b->text, .count = 1};
  switch (b->kind) {
  case BESIDE_TABLE:
    *tables += 1;
    return read_table(b, axes, labels ? labels[table] : NULL, &s->tables[table], &s->items[k]);
  case BESIDE_LINE:
    s->items[k].y = v;
    return measured_line(b->text, axes->y_unit, v);
  default:
    s->items[k].low = v;
    s->items[k].high = v + 1;
    return measured_levels(b->text, axes->y_unit, v);
  }
}

static bool draw_curves(plot_request *q) {
  char error[1024] = "";
  measured_axes axes = {.x = q->curve.x, .ys = q->ys, .y_count = q->y_count};
  const size_t room = (size_t)q->beside_count + 1;
  beside_set s = {must_calloc(room, sizeof *s.tables), must_calloc(room, sizeof *s.values),
                  must_calloc(room, sizeof *s.items)};
  int tables = 0;
  plot_histories h;
  bool good = plot_histories_read(&h, q->results[0], axes.x, axes.ys[0], error, sizeof error);
  axes.x_unit = h.x_unit;
  axes.y_unit = h.y_unit;
  for (int k = 0; good && k < q->beside_count; k++)
    good = read_beside(q, k, &axes, &tables, &s);
  q->curve.labels = q->label_count ? q->labels : NULL;
  q->curve.ys = q->ys;
  q->curve.y_count = q->y_count;
  q->curve.beside = s.items;
  q->curve.beside_count = q->beside_count;
  good = good && plot_curve(q->results, q->result_count, &q->curve, error, sizeof error);
  if (*error) say_error("%s", error);
  for (int k = 0; k < tables; k++)
    measured_free(&s.tables[k]);
  free(h.x);
  free(h.y);
  free(s.tables);
  free(s.values);
  free(s.items);
  return good;
}

static bool draw_map(plot_request *q) {
  char error[1024];
  frame_choice chosen = {.count = 0};
  if (q->frames && !frame_choice_read(&chosen, q->results[0], q->frames)) {
    frame_choice_free(&chosen);
    return false;
  }
  q->map.frames = chosen.frames;
  q->map.captions = (const char *const *)chosen.captions;
  q->map.frame_count = chosen.count;
  const bool good = plot_map(q->results[0], &q->map, error, sizeof error);
  if (!good) say_error("%s", error);
  frame_choice_free(&chosen);
  return good;
}

static bool draw_paths(plot_request *q) {
  char error[1024];
  q->paths = (plot_paths_options){.output = q->curve.output,
                                  .title = q->curve.title,
                                  .labels = q->label_count ? q->labels : NULL,
                                  .frame = q->map.frame};
  const bool good = plot_paths(q->results, q->result_count, &q->paths, error, sizeof error);
  if (!good) say_error("%s", error);
  return good;
}

/* A column of a study's table over a key. */
static bool draw_study(plot_request *q) {
  if (q->beside_count > 0 || q->y_count > 1) {
    say_error("%s: the table of a study is drawn by itself, one --y over one --x", q->results[0]);
    return false;
  }
  q->curve.labels = q->label_count ? q->labels : NULL;
  q->curve.y = q->ys[0];
  return study_plot(q->results[0], &q->curve, q->label_count);
}

/* Whose table has no time. */
static bool is_study(const plot_request *q) {
  return !q->is_map && !q->is_paths && q->result_count == 1 && strcmp(q->curve.x, "time") != 0 &&
         study_is_table(q->results[0]);
}

static bool draw(plot_request *q) {
  const bool good = is_study(q)   ? draw_study(q)
                    : q->is_paths ? draw_paths(q)
                    : q->is_map   ? draw_map(q)
                                  : draw_curves(q);
  if (good) printf("written %s\n", q->curve.output);
  return good;
}

static bool are_results(const plot_request *q) {
  if (is_study(q)) return true;
  for (int k = 0; k < q->result_count; k++)
    if (!file_suits(q->results[k], FILES(RESULT), "perilat plot",
                    "a result, which `perilat run` makes"))
      return false;
  return true;
}

static bool complete(const plot_request *q) {
  if (q->result_count == 0)
    say_error("`perilat plot` needs a result file\n  perilat plot result.h5 -o curve.png");
  else if (q->is_paths && q->is_map)
    say_error("--cracks draws paths, --map a map, which has its cracks in it; give one of them");
  else if (q->is_map && q->result_count > 1)
    say_error("a map shows one result; give one file");
  else if (q->label_count && !is_study(q) && q->label_count != q->result_count &&
           q->label_count != q->result_count + q->table_count)
    say_error("%d labels for %d results%s; give one --label a result%s", q->label_count,
              q->result_count, q->table_count ? " and their tables" : "",
              q->table_count ? ", then one a table" : "");
  else if (q->is_map && (q->of_curves || q->label_count))
    say_error("%s belongs to curves, --map draws a map; leave one of them out",
              q->of_curves ? q->of_curves : "--label");
  else if (q->is_paths && (q->of_curves || q->of_maps))
    say_error("%s does not belong to --cracks; leave one of them out",
              q->of_curves ? q->of_curves : q->of_maps);
  else if (!q->is_map && (q->of_maps || (q->frame && !q->is_paths)))
    say_error("%s belongs to maps; add --map FIELD, e.g. --map damage",
              q->of_maps ? q->of_maps : "--frame");
  else if (q->frame && q->frames)
    say_error("--frame shows one frame, --frames several; give one of them");
  else if (q->map.component < -1)
    say_error("--component counts from 0 (x); -1 is the size of the vector");
  else
    return are_results(q);
  return false;
}

/* The picture must not take the place of what it is drawn from. */
static bool spares(const plot_request *q, const char *path) {
  if (!same_file(q->curve.output, path)) return true;
  say_error("the picture would overwrite `%s`; give it another name with -o", path);
  return false;
}

static bool spares_inputs(const plot_request *q) {
  bool good = true;
  for (int k = 0; good && k < q->result_count; k++)
    good = spares(q, q->results[k]);
  for (int k = 0; good && k < q->beside_count; k++) {
    const char *columns;
    char *path = text_table_split(q->besides[k].text, &columns);
    good = q->besides[k].kind != BESIDE_TABLE || spares(q, path);
    free(path);
  }
  return good;
}

/* "beam_load.png", in the working folder: after the first result and what is drawn, so that
   pictures of other results stay. */
static void name_output(plot_request *q, char *name, size_t size) {
  const char *drawn = q->is_paths ? "cracks" : q->is_map ? q->map.field : q->ys[0];
  const char *slash = strrchr(q->results[0], '/');
  const char *result = slash ? slash + 1 : q->results[0], *dot = strrchr(result, '.');
  const size_t stem = dot && dot > result ? (size_t)(dot - result) : strlen(result);
  const int head = snprintf(name, size, "%.*s_", (int)stem, result);
  snprintf(name + head, size - (size_t)head, "%.100s.png", drawn);
  for (char *c = name + head; *c; c++)
    if (*c == '/') *c = '_';
  q->curve.output = q->map.output = name;
}

int command_plot(int argc, char **argv) {
  plot_request q = {
      .curve = {.output = NULL},
      .map = {.frame = -1, .component = -1, .factor = -1, .field = "damage", .slice_axis = -1}};
  q.results = must_calloc((size_t)argc + 1, sizeof *q.results);
  q.labels = must_calloc((size_t)argc + 1, sizeof *q.labels);
  q.ys = must_calloc((size_t)argc + 1, sizeof *q.ys);
  q.besides = must_calloc((size_t)argc + 1, sizeof *q.besides);
  bool good = true;
  for (int at = 0; at < argc && good;)
    good = read_one(argc, argv, &at, &q);
  if (!q.curve.x) q.curve.x = "time";
  if (q.y_count == 0) q.ys[q.y_count++] = "load";
  good = good && complete(&q);
  char *name = good ? must_calloc(strlen(q.results[0]) + 128, 1) : NULL;
  if (good && !q.curve.output) name_output(&q, name, strlen(q.results[0]) + 128);
  good = good && spares_inputs(&q) && draw(&q);
  free(name);
  free(q.results);
  free(q.labels);
  free(q.ys);
  free(q.besides);
  return good ? 0 : 1;
}
