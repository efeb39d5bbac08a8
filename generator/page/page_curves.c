#include "generator/page/page_curves.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "dsl/base/arena.h"
#include "dsl/base/elementary.h"
#include "generator/page/diagram.h"
#include "generator/page/html.h"

static void put_caption(FILE *out, const char *y, const char *x) {
  fputs("<figcaption>", out);
  html_text(out, page_series_words(y));
  if (x) html_print(out, " over %s", page_series_words(x));
  fputs("</figcaption>\n", out);
}

/* The series of that name of each result, over time or over another one. */
static void put_curve(FILE *out, const page_result *results, int count, const char *y,
                      const char *x, bool large) {
  diagram_curve curves[2];
  int shown = 0;
  const page_result *first = NULL;
  for (int k = 0; k < count; k++) {
    const page_result *p = &results[k];
    const int found = page_series_find(p, y), over = x ? page_series_find(p, x) : -1;
    if (found < 0 || (x && over < 0)) continue;
    if (!first) first = p;
    curves[shown++] = (diagram_curve){.x = x ? p->series[over].values : p->time,
                                      .y = p->series[found].values,
                                      .count = p->samples,
                                      .ink = k,
                                      .series = y,
                                      .of = p->key};
  }
  if (!first) return;
  char title[512];
  snprintf(title, sizeof title, "%.200s over %.200s", page_series_words(y),
           x ? page_series_words(x) : page_time_name(first));
  const diagram d = {.title = title,
                     .x_name = x ? page_series_words(x) : page_time_name(first),
                     .x_unit =
                         x ? first->series[page_series_find(first, x)].unit : page_time_unit(first),
                     .y_name = page_series_words(y),
                     .y_unit = first->series[page_series_find(first, y)].unit,
                     .curves = curves,
                     .count = shown,
                     .large = large,
                     .over = x ? x : ""};
  fputs("<figure class=\"curve\">", out);
  put_caption(out, y, x);
  if (!diagram_svg(out, &d)) fputs("<p class=\"none\">no value that is a number</p>", out);
  fputs("</figure>\n", out);
}

static void put_results_legend(FILE *out, const page_result *results, int count) {
  diagram_curve of[2];
  if (count < 2) return;
  for (int k = 0; k < count; k++)
    of[k] = (diagram_curve){.label = results[k].shown, .ink = k};
  diagram_legend(out, &(diagram){.curves = of, .count = count});
}

/* What the first result's is drawn over counts, where the other has it, too. */
void page_main_curve(FILE *out, const page_result *results, int count, bool large) {
  const page_result *p = &results[0];
  if (p->main < 0) return;
  const char *x = p->over >= 0 ? p->series[p->over].name : NULL;
  for (int k = 1; k < count; k++)
    if (x && page_series_find(&results[k], x) < 0) x = NULL;
  fputs("<div class=\"main-curve\">", out);
  put_results_legend(out, results, count);
  put_curve(out, results, count, p->series[p->main].name, x, large);
  fputs("</div>\n", out);
}

/* A monitor stands in no folder; energies do. */
static bool is_energy(const page_series *s) {
  return strchr(s->name, '/') != NULL;
}

void page_monitors(FILE *out, const page_result *results, int count) {
  fputs("<section id=\"monitors\"><h2>Monitors</h2>\n", out);
  put_results_legend(out, results, count);
  fputs("<div class=\"curves\">\n", out);
  for (int n = 0; n < count; n++)
    for (int k = 0; k < results[n].series_count; k++) {
      const page_series *s = &results[n].series[k];
      const bool shown = n == 1 && page_series_find(&results[0], s->name) >= 0;
      if (!is_energy(s) && !shown) put_curve(out, results, count, s->name, NULL, false);
    }
  fputs("</div></section>\n", out);
}

/* --- energies --------------------------------------------------------------------------------- */

/* From the ground up: what is lost for good, then what may still come back. */
static const struct {
  const char *series, *words;
} parts[] = {{"energy/dissipated_damage", "dissipated by damage and states"},
             {"energy/dissipated_damping", "dissipated by damping"},
             {"energy/stored", "stored"},
             {"energy/kinetic", "kinetic"}};
enum { PARTS = sizeof parts / sizeof *parts };

/* Whether there is anything of it. */
static bool add_part(const page_result *p, const char *name, double *sum) {
  const int found = page_series_find(p, name);
  bool any = false;
  for (long k = 0; found >= 0 && k < p->samples; k++) {
    const double value = p->series[found].values[k];
    sum[k] += value;
    any = any || value != 0;
  }
  return any;
}

/* Areas on each other, and their legend. */
static void put_stack(FILE *out, const page_result *p) {
  double *sums = must_calloc((size_t)(PARTS * p->samples) + 1, sizeof *sums);
  diagram_curve areas[PARTS];
  int count = 0;
  const double *below = NULL;
  for (int n = 0; n < PARTS; n++) {
    double *sum = sums + count * p->samples;
    if (below) memcpy(sum, below, (size_t)p->samples * sizeof *sum);
    if (!below) memset(sum, 0, (size_t)p->samples * sizeof *sum);
    if (!add_part(p, parts[n].series, sum)) continue;
    areas[count++] = (diagram_curve){.label = parts[n].words,
                                     .x = p->time,
                                     .y = sum,
                                     .count = p->samples,
                                     .ink = n,
                                     .series = parts[n].series,
                                     .of = p->key};
    below = sum;
  }
  const diagram d = {.title = "energies on each other, over time",
                     .x_name = page_time_name(p),
                     .x_unit = page_time_unit(p),
                     .y_name = "energy",
                     .y_unit = "J",
                     .curves = areas,
                     .count = count,
                     .stacked = true,
                     .large = true,
                     .over = ""};
  diagram_legend(out, &d);
  if (count == 0 || !diagram_svg(out, &d)) fputs("<p class=\"none\">none</p>", out);
  free(sums);
}

/* Those of bodies, laws and contacts, where there are several. */
static void put_shares(FILE *out, const page_result *p) {
  int shares = 0;
  for (int k = 0; k < p->series_count; k++)
    shares += is_energy(&p->series[k]) && strncmp(p->series[k].name, "energy/", 7) != 0;
  if (shares == 0) return;
  fputs("<details><summary>Energies of each body</summary>\n<div class=\"curves\">\n", out);
  for (int k = 0; k < p->series_count; k++)
    if (is_energy(&p->series[k]) && strncmp(p->series[k].name, "energy/", 7) != 0)
      put_curve(out, p, 1, p->series[k].name, NULL, false);
  fputs("</div></details>\n", out);
}

void page_energies(FILE *out, const page_result *p) {
  const int imbalance = page_series_find(p, "energy/imbalance");
  if (page_series_find(p, "energy/kinetic") < 0) return;
  const bool checked = imbalance >= 0 && !*p->series[imbalance].unchecked;
  fputs("<section class=\"energies\"><h2>Where the energy went</h2>\n<figure class=\"curve "
        "ledger\">",
        out);
  put_stack(out, p);
  fputs("</figure>\n<div class=\"curves\">\n", out);
  put_curve(out, p, 1, "energy/external", NULL, false);
  if (checked) put_curve(out, p, 1, "energy/imbalance", NULL, false);
  fputs("</div>\n", out);
  if (!checked && imbalance >= 0) {
    fputs("<p>The imbalance is not checked: ", out);
    html_text(out, p->series[imbalance].unchecked);
    fputs(".</p>\n", out);
  }
  put_shares(out, p);
  fputs("</section>\n", out);
}
