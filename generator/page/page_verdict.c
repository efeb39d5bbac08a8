#include "generator/page/page_verdict.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "dsl/base/arena.h"
#include "generator/page/html.h"
#include "generator/report/report_trust.h"

typedef enum judgement { GOOD, UNCHECKED, DOUBTFUL, WRONG } judgement;
static const char *const judgement_names[] = {"good", "unchecked", "doubtful", "wrong"};

/* The last imbalance in parts of the largest energy; NaN: not known. *why: it says nothing, or
   NULL. */
static double imbalance_of(const page_result *p, const char **why) {
  const int found = page_series_find(p, "energy/imbalance");
  *why = NULL;
  if (found < 0 || p->samples < 1) return NAN;
  if (*p->series[found].unchecked) *why = p->series[found].unchecked;
  const double largest = page_largest_energy(p);
  return largest > 0 ? fabs(p->series[found].values[p->samples - 1]) / largest : NAN;
}

/* As the run has judged; of a result that does not say what its run said, by the number. */
static bool is_unbalanced(const page_result *p) {
  const char *why;
  const double imbalance = imbalance_of(p, &why);
  if (*p->said_end) return strstr(p->said_warnings, IMBALANCE_WARNED) != NULL;
  return !why && imbalance > MUCH_IMBALANCE;
}

static judgement judge(const page_result *p) {
  if (p->status != 0 && !isnan(p->status)) return WRONG;
  if (is_unbalanced(p)) return WRONG;
  const char *why;
  if (*p->said_warnings) return DOUBTFUL;
  return isnan(imbalance_of(p, &why)) || why ? UNCHECKED : GOOD;
}

/* --- cards ------------------------------------------------------------------------------------ */

static void open_card(FILE *out, const char *name, judgement how) {
  fprintf(out, "<div class=\"card %s\"><dt>", judgement_names[how]);
  html_text(out, name);
  fputs("</dt><dd>", out);
}

static void close_card(FILE *out) {
  fputs("</dd></div>\n", out);
}

static void put_peak(FILE *out, const page_result *p) {
  if (p->main < 0 || p->peak < 0) return;
  char text[HTML_QUANTITY], when[PAGE_MOMENT];
  const page_series *y = &p->series[p->main];
  open_card(out, y->name, GOOD);
  html_print(out, "%s", html_quantity(y->values[p->peak], y->unit, text));
  fputs("<small>largest, at ", out);
  html_text(out, page_moment(p, p->time[p->peak], when));
  if (p->over >= 0) {
    const page_series *x = &p->series[p->over];
    html_print(out, ", %s %s", x->name, html_quantity(x->values[p->peak], x->unit, text));
  }
  fputs("</small>", out);
  close_card(out);
}

static void put_ending(FILE *out, const page_result *p) {
  const bool failed = p->status != 0 && !isnan(p->status);
  const char *colon = strstr(p->ended, ": ");
  open_card(out, "ended", failed ? WRONG : GOOD);
  if (!*p->ended) fputs("not told", out);
  html_bytes(out, p->ended, colon ? (size_t)(colon - p->ended) : strlen(p->ended));
  fputs("<small>", out);
  if (colon) html_text(out, colon + 2);
  if (failed) html_print(out, "%sexit status %.0f", colon ? "; " : "", p->status);
  fputs("</small>", out);
  close_card(out);
}

static void put_imbalance(FILE *out, const page_result *p) {
  const char *why;
  const double part = imbalance_of(p, &why);
  if (isnan(part) && !why) return;
  open_card(out, "energy imbalance", is_unbalanced(p) ? WRONG : GOOD);
  if (why)
    html_print(out, "not checked");
  else
    html_print(out, "%.2g %%", 100 * part);
  fputs("<small>", out);
  html_text(out, why ? why : "in the end, of the largest energy");
  fputs("</small>", out);
  close_card(out);
}

static void put_size(FILE *out, const page_result *p) {
  char text[HTML_QUANTITY];
  if (isnan(p->steps)) return;
  open_card(out, "march", GOOD);
  html_print(out, "%.0f step%s", p->steps, p->steps == 1 ? "" : "s");
  fputs("<small>", out);
  if (!p->quasi_static && p->step > 0)
    html_print(out, "of %s, ", html_quantity(p->step, "s", text));
  html_print(out, "in %.3g s of wall time", p->wall);
  fputs("</small>", out);
  close_card(out);
}

/* --- the section ------------------------------------------------------------------------------ */

static const char *sentence(const page_result *p, judgement how) {
  if (p->status != 0 && !isnan(p->status)) return "This run did not come to its end.";
  if (how == WRONG) return "The energies of this run do not add up.";
  if (how == DOUBTFUL) return "Done, with <a href=\"#warnings\">warnings</a>.";
  return how == UNCHECKED ? "Done; whether the energies add up was not checked."
                          : "Done; nothing was found wrong.";
}

void page_verdict(FILE *out, const page_result *p) {
  const judgement how = judge(p);
  fprintf(out,
          "<section class=\"verdict %s\" aria-label=\"verdict\">\n<p class=\"sentence\">%s</p>\n",
          judgement_names[how], sentence(p, how));
  fputs("<p class=\"quiet\">", out);
  html_text(out, p->shown);
  fputs("</p>\n<dl>\n", out);
  put_peak(out, p);
  put_ending(out, p);
  put_imbalance(out, p);
  put_size(out, p);
  fputs("</dl>\n</section>\n", out);
}

void page_warnings(FILE *out, const page_result *p) {
  if (!*p->said_warnings) return;
  fputs("<section class=\"warnings\"><h2>Warnings</h2>\n<pre class=\"said\">", out);
  html_text(out, p->said_warnings);
  fputs("</pre></section>\n", out);
}
