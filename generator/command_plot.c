/* perilat plot: curves of histories, or the map of a frame. */
#include <errno.h>
#include <limits.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "dsl/arena.h"
#include "dsl/units.h"
#include "generator/commands.h"
#include "generator/model.h"
#include "runtime/plot.h"

typedef struct plot_request {
  const char **results, **labels, **ys;
  int result_count, label_count, y_count;
  plot_curve_options curve;
  plot_map_options map;
  bool is_map;
  const char *of_curves, *of_maps; /* an option that only these know, when one was given */
} plot_request;

static bool read_number(const char *name, const char *text, double *value) {
  char *end;
  *value = strtod(text, &end);
  if (!*end && end != text && isfinite(*value)) return true;
  fprintf(stderr, "perilat: error: %s needs a number, not `%s`\n", name, text);
  return false;
}

static bool read_whole(const char *name, const char *text, long *value) {
  char *end;
  errno = 0;
  *value = strtol(text, &end, 10);
  if (!*end && end != text && !errno && labs(*value) < INT_MAX) return true;
  fprintf(stderr, "perilat: error: %s needs a whole number, not `%s`\n", name, text);
  return false;
}

/* "z=0.05" or "x=5 mm". */
static bool read_slice(const char *text, plot_map_options *o) {
  const char *axis = strchr("xyz", text[0]), *bad;
  char *end;
  size_t bad_length;
  unit metre, in;
  unit_parse("m", 1, &metre, &bad, &bad_length);
  in = metre;
  if (text[0] && axis && text[1] == '=') {
    o->slice_axis = (int)(axis - "xyz");
    o->slice_at = strtod(text + 2, &end);
    const bool number = end != text + 2 && isfinite(o->slice_at);
    end += strspn(end, " ");
    if (number && (!*end || unit_parse(end, strlen(end), &in, &bad, &bad_length)) &&
        dim_equal(in.dim, metre.dim)) {
      o->slice_at *= in.factor;
      return true;
    }
  }
  fprintf(stderr,
          "perilat: error: --slice needs an axis and a place in m or with a unit, e.g. z=0.05 or "
          "'x=5 mm', not `%s`\n",
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
    fprintf(
        stderr,
        "perilat: error: --x is given twice, `%s` and `%s`; all curves of a picture have one x\n",
        *x, given);
  const bool first = !*x;
  *x = given;
  return first;
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
  } else if ((v = special_value(argc, argv, at, "--x", &q->of_curves, &bad)))
    bad = bad || !set_once(&q->curve.x, v);
  else if ((v = special_value(argc, argv, at, "--y", &q->of_curves, &bad)))
    q->ys[q->y_count++] = v;
  else if ((v = special_value(argc, argv, at, "--x-unit", &q->of_curves, &bad)))
    q->curve.x_unit = v;
  else if ((v = special_value(argc, argv, at, "--y-unit", &q->of_curves, &bad)))
    q->curve.y_unit = v;
  else if ((v = special_value(argc, argv, at, "--label", &q->of_curves, &bad)))
    q->labels[q->label_count++] = v;
  else if ((v = special_value(argc, argv, at, "--frame", &q->of_maps, &bad)))
    bad = bad || !read_whole("--frame", v, &q->map.frame);
  else if ((v = special_value(argc, argv, at, "--factor", &q->of_maps, &bad)))
    bad = bad || !read_number("--factor", v, &q->map.factor);
  else if ((v = special_value(argc, argv, at, "--component", &q->of_maps, &bad))) {
    bad = bad || !read_whole("--component", v, &whole);
    q->map.component = (int)whole;
  } else if ((v = special_value(argc, argv, at, "--slice", &q->of_maps, &bad)))
    bad = bad || !read_slice(v, &q->map);
  else if (argv[*at][0] == '-')
    bad = option_unknown("plot", argv[*at]);
  else
    q->results[q->result_count++] = argv[(*at)++];
  return !bad;
}

static bool draw(plot_request *q) {
  char error[1024];
  bool good;
  if (q->is_map) {
    good = plot_map(q->results[0], &q->map, error, sizeof error);
  } else {
    q->curve.labels = q->label_count ? q->labels : NULL;
    q->curve.ys = q->ys;
    q->curve.y_count = q->y_count;
    good = plot_curve(q->results, q->result_count, &q->curve, error, sizeof error);
  }
  if (!good)
    fprintf(stderr, "perilat: error: %s\n", error);
  else
    printf("written %s\n", q->curve.output);
  return good;
}

static bool are_results(const plot_request *q) {
  for (int k = 0; k < q->result_count; k++)
    if (!file_suits(q->results[k], FILES(RESULT), "perilat plot",
                    "a result, which `perilat run` makes"))
      return false;
  return true;
}

static bool complete(const plot_request *q) {
  if (q->result_count == 0)
    fputs("perilat: error: `perilat plot` needs a result file\n  perilat plot result.h5 -o "
          "curve.png\n",
          stderr);
  else if (q->is_map && q->result_count > 1)
    fputs("perilat: error: a map shows one result; give one file\n", stderr);
  else if (q->label_count && q->label_count != q->result_count)
    fprintf(stderr, "perilat: error: %d labels for %d results; give one --label a result\n",
            q->label_count, q->result_count);
  else if (q->is_map && q->of_curves)
    fprintf(stderr,
            "perilat: error: %s belongs to curves, --map draws a map; leave one of them out\n",
            q->of_curves);
  else if (!q->is_map && q->of_maps)
    fprintf(stderr, "perilat: error: %s belongs to maps; add --map FIELD, e.g. --map damage\n",
            q->of_maps);
  else if (q->map.component < -1)
    fprintf(stderr,
            "perilat: error: --component counts from 0 (x); -1 is the size of the vector\n");
  else
    return are_results(q);
  return false;
}

/* The picture must not take a result's place. */
static bool spares_results(const plot_request *q) {
  for (int k = 0; k < q->result_count; k++)
    if (same_file(q->curve.output, q->results[k])) {
      fprintf(stderr,
              "perilat: error: the picture would overwrite `%s`; give it another name with -o\n",
              q->results[k]);
      return false;
    }
  return true;
}

/* "beam_load.png", in the working folder: after the first result and what is drawn, so that pictures of other results stay. */
static void name_output(plot_request *q, char *name, size_t size) {
  const char *drawn = q->is_map ? q->map.field : q->y_count ? q->ys[0] : "load";
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
  bool good = true;
  for (int at = 0; at < argc && good;)
    good = read_one(argc, argv, &at, &q);
  good = good && complete(&q);
  char *name = good ? must_calloc(strlen(q.results[0]) + 128, 1) : NULL;
  if (good && !q.curve.output) name_output(&q, name, strlen(q.results[0]) + 128);
  good = good && spares_results(&q) && draw(&q);
  free(name);
  free(q.results);
  free(q.labels);
  free(q.ys);
  return good ? 0 : 1;
}
