/* perilat plot: curves of histories, or the map of a frame. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "dsl/arena.h"
#include "generator/commands.h"
#include "runtime/plot.h"

static const char *const option_names[] = {"-o",     "--x",      "--y",     "--x-unit",    "--y-unit", "--title",
                                           "--label", "--map",    "--frame", "--factor", "--component"};
enum { OPTION_COUNT = sizeof option_names / sizeof *option_names };

typedef struct plot_request {
  const char **results, **labels;
  int result_count, label_count;
  plot_curve_options curve;
  plot_map_options map;
  bool is_map;
} plot_request;

static bool read_number(const char *name, const char *text, double *value) {
  char *end;
  *value = strtod(text, &end);
  if (*end || end == text) {
    fprintf(stderr, "perilat: error: %s needs a number, not `%s`\n", name, text);
    return false;
  }
  return true;
}

/* One option or file; false after a message. */
static bool read_one(int argc, char **argv, int *at, plot_request *q) {
  int bad = 0;
  double number = 0;
  const char *v;
  if ((v = option_value(argc, argv, at, "-o", &bad)))
    q->curve.output = q->map.output = v;
  else if ((v = option_value(argc, argv, at, "--x", &bad)))
    q->curve.x = v;
  else if ((v = option_value(argc, argv, at, "--y", &bad)))
    q->curve.y = v;
  else if ((v = option_value(argc, argv, at, "--x-unit", &bad)))
    q->curve.x_unit = v;
  else if ((v = option_value(argc, argv, at, "--y-unit", &bad)))
    q->curve.y_unit = v;
  else if ((v = option_value(argc, argv, at, "--title", &bad)))
    q->curve.title = q->map.title = v;
  else if ((v = option_value(argc, argv, at, "--label", &bad)))
    q->labels[q->label_count++] = v;
  else if ((v = option_value(argc, argv, at, "--map", &bad))) {
    q->map.field = v;
    q->is_map = true;
  } else if ((v = option_value(argc, argv, at, "--frame", &bad))) {
    bad |= !read_number("--frame", v, &number);
    q->map.frame = (long)number;
  } else if ((v = option_value(argc, argv, at, "--factor", &bad)))
    bad |= !read_number("--factor", v, &q->map.factor);
  else if ((v = option_value(argc, argv, at, "--component", &bad))) {
    bad |= !read_number("--component", v, &number);
    q->map.component = (int)number;
  } else if (argv[*at][0] == '-')
    bad = option_unknown("plot", argv[*at], option_names, OPTION_COUNT);
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
    good = plot_curve(q->results, q->result_count, &q->curve, error, sizeof error);
  }
  if (!good)
    fprintf(stderr, "perilat: error: %s\n", error);
  else
    printf("written %s\n", q->curve.output);
  return good;
}

static bool complete(const plot_request *q) {
  if (q->result_count == 0)
    fputs("perilat: error: `perilat plot` needs a result file\n  perilat plot result.h5 -o curve.png\n", stderr);
  else if (q->is_map && q->result_count > 1)
    fputs("perilat: error: a map shows one result; give one file\n", stderr);
  else if (q->label_count && q->label_count != q->result_count)
    fprintf(stderr, "perilat: error: %d labels for %d results; give one --label a result\n", q->label_count,
            q->result_count);
  else
    return true;
  return false;
}

int command_plot(int argc, char **argv) {
  plot_request q = {.curve = {.output = NULL}, .map = {.frame = -1, .component = -1, .factor = -1, .field = "damage"}};
  q.results = must_calloc((size_t)argc + 1, sizeof *q.results);
  q.labels = must_calloc((size_t)argc + 1, sizeof *q.labels);
  bool good = true;
  for (int at = 0; at < argc && good;)
    good = read_one(argc, argv, &at, &q);
  good = good && complete(&q);
  if (good && !q.curve.output)
    q.curve.output = q.map.output = q.is_map ? "map.png" : "curve.png";
  good = good && draw(&q);
  free(q.results);
  free(q.labels);
  return good ? 0 : 1;
}
