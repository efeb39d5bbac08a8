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
  html_text(out, y);
  if (x) html_print(out, " over %s", x);
  fputs("</figcaption>\n", out);
}

/* One series over time, or over another one. */
static void put_curve(FILE *out, const page_result *p, int y, int x, bool large) {
  const page_series *of = &p->series[y], *over = x < 0 ? NULL : &p->series[x];
  const char *x_name = over ? over->name : page_time_name(p);
  const diagram_curve curve = {.x = over ? over->values : p->time,
                               .y = of->values,
                               .count = p->samples,
                               .series = of->name,
                               .over = over ? over->name : ""};
  char title[512];
  snprintf(title, sizeof title, "%.200s over %.200s", of->name, x_name);
  const diagram d = {.title = title,
                     .x_name = x_name,
                     .x_unit = over ? over->unit : page_time_unit(p),
                     .y_name = of->name,
                     .y_unit = of->unit,
                     .curves = &curve,
                     .count = 1,
                     .large = large,
                     .of = p->key};
  fputs("<figure class=\"curve\">", out);
  put_caption(out, of->name, over ? over->name : NULL);
  if (!diagram_svg(out, &d)) fputs("<p class=\"none\">no value that is a number</p>", out);
  fputs("</figure>\n", out);
}

void page_main_curve(FILE *out, const page_result *p) {
  if (p->main < 0) return;
  fputs("<section><h2>What it bears</h2>\n<div class=\"main-curve\">", out);
  put_curve(out, p, p->main, p->over, true);
  fputs("</div></section>\n", out);
}

/* A monitor stands in no folder; energies do. */
static bool is_energy(const page_series *s) {
  return strchr(s->name, '/') != NULL;
}

void page_monitors(FILE *out, const page_result *p) {
  int shown = 0;
  for (int k = 0; k < p->series_count; k++)
    shown += !is_energy(&p->series[k]);
  if (shown == 0) return;
  fputs("<section><h2>Monitors</h2>\n<div class=\"curves\">\n", out);
  for (int k = 0; k < p->series_count; k++)
    if (!is_energy(&p->series[k])) put_curve(out, p, k, -1, false);
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
                                     .over = ""};
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
                     .of = p->key};
  fputs("<ul class=\"legend\">", out);
  for (int k = count - 1; k >= 0; k--)
    fprintf(out, "<li><span class=\"ink%d\"></span>%s</li>", areas[k].ink, areas[k].label);
  fputs("</ul>\n", out);
  if (count == 0 || !diagram_svg(out, &d)) fputs("<p class=\"none\">none</p>", out);
  free(sums);
}

void page_energies(FILE *out, const page_result *p) {
  const int imbalance = page_series_find(p, "energy/imbalance"),
            external = page_series_find(p, "energy/external");
  if (page_series_find(p, "energy/kinetic") < 0) return;
  fputs("<section><h2>Where the energy went</h2>\n<figure class=\"curve ledger\">", out);
  put_stack(out, p);
  fputs("</figure>\n<div class=\"curves\">\n", out);
  if (external >= 0) put_curve(out, p, external, -1, false);
  if (imbalance >= 0 && !*p->series[imbalance].unchecked) put_curve(out, p, imbalance, -1, false);
  fputs("</div>", out);
  if (imbalance >= 0 && *p->series[imbalance].unchecked) {
    fputs("<p>The imbalance is not checked: ", out);
    html_text(out, p->series[imbalance].unchecked);
    fputs(".</p>", out);
  }
  fputs("</section>\n", out);
}
