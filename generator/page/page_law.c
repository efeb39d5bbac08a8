#include "generator/page/page_law.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

#include "dsl/base/characters.h"
#include "dsl/print/explain.h"
#include "dsl/print/explain_math.h"
#include "dsl/print/mathml.h"
#include "dsl/semantics/law_variant.h"
#include "generator/kernel/material_law.h"
#include "generator/page/diagram.h"
#include "generator/page/html.h"
#include "generator/page/law_curve.h"
#include "generator/page/markdown.h"
#include "runtime/analysis/material.h"
#include "runtime/result/result_find.h"
#include "runtime/result/result_read.h"

/* --- the law's text --------------------------------------------------------------------------- */

/* "mplm_bilinear" of "../models/mplm_bilinear.plm". */
static const char *short_name(arena *a, const char *model_name) {
  const char *slash = strrchr(model_name, '/'), *name = slash ? slash + 1 : model_name;
  const size_t length = strlen(name);
  const bool ends = length > 4 && strcmp(name + length - 4, ".plm") == 0;
  return arena_text(a, name, ends ? length - 4 : length);
}

/* As the result keeps it, malloc'ed; NULL: not under this name, and there are several. */
static char *text_of(const page_result *p, const char *model_name) {
  char path[1024];
  result_names names = result_list(p->file, "/input/models");
  const char *wanted = short_name(p->memory, model_name),
             *name = names.count == 1 ? names.items[0] : NULL;
  for (int k = 0; k < names.count; k++)
    if (strcmp(names.items[k], wanted) == 0) name = names.items[k];
  if (name) snprintf(path, sizeof path, "/input/models/%s", name);
  char *text = name ? result_read_text(p->file, path) : NULL;
  result_names_free(&names);
  return text;
}

typedef struct used_law {
  const page_result *p;
  const deck_material *material;
  const deck_lattice *lattice;
  model m;
  const pl_law *kernel;
  double *parameters;
  diagnostics said;
} used_law;

/* The material as one that is alone, and the same everywhere. A formula keeps its value in the
   middle; a file is not asked, it may be gone: the default stands for it. */
static deck_material without_files(arena *a, const deck_material *m) {
  deck_material known = *m;
  known.varying_count = 0;
  known.regional_count = 0;
  known.assignment_count = 0;
  known.assignments = arena_alloc(a, ((size_t)m->assignment_count + 1) * sizeof *known.assignments);
  for (int k = 0; k < m->assignment_count; k++) {
    const deck_placed *by = m->assignments[k].placed;
    if (!by || !by->path) known.assignments[known.assignment_count++] = m->assignments[k];
  }
  return known;
}

static deck_material without_places(arena *a, const deck_material *m) {
  deck_material alone = *m;
  alone.beside = false;
  alone.assignments = arena_alloc(a, ((size_t)m->assignment_count + 1) * sizeof *alone.assignments);
  for (int k = 0; k < m->assignment_count; k++) {
    alone.assignments[k] = m->assignments[k];
    alone.assignments[k].placed = NULL;
  }
  return alone;
}

/* A single bond is that of the plane also where its lattice is in space. */
static void take_setting(used_law *u) {
  const law_setting setting = material_setting(u->lattice);
  const law_kind kind = u->m.law->tree->law;
  if (setting != SETTING_SPACE || kind == LAW_STATE || kind == LAW_CONTINUUM)
    u->m.law = law_on_lattice(u->m.law, setting, false, 0);
}

/* Read from the result alone, with the deck's options and values. False: what is missing (a file
   that the law includes, say) is not told, the text stands in the page. */
static bool open_law(used_law *u, char *text) {
  char error[4096];
  const char *note;
  const deck_material known = without_files(u->p->memory, u->material),
                      alone = without_places(u->p->memory, &known);
  diag_begin(&u->said, (source_set *)&u->p->sources);
  if (!model_open_text(&u->m, u->material->model, text, strlen(text), NULL, 0) ||
      !material_law_take_options(&known, &u->m, &u->said))
    return false;
  take_setting(u);
  if (!material_law_plan(&alone, NULL, &u->m, &u->said)) return false;
  u->kernel = model_kernel(&u->m, true, &note, error, sizeof error);
  if (!u->kernel) return false;
  u->parameters = must_calloc((size_t)u->kernel->parameter_count + 1, sizeof *u->parameters);
  return material_parameters(&u->m.values, u->kernel, u->parameters, &u->said);
}

/* --- equations -------------------------------------------------------------------------------- */

static void put_equations(FILE *out, const used_law *u) {
  static const char *const skip[] = {"Parameters", NULL};
  const law *l = u->m.law;
  law_choice *choices = arena_alloc(u->p->memory, ((size_t)l->options.count + 1) * sizeof *choices);
  for (int k = 0; k < l->options.count; k++)
    choices[k] = (law_choice){l->options.items[k]->name, l->chosen[k]};
  char *text = NULL;
  size_t length;
  FILE *memory = must_open_text(&text, &length);
  explain_law(l, EXPLAIN_MARKDOWN, choices, l->options.count, memory);
  must_close_text(memory);
  markdown_put(out, text, skip);
  free(text);
}

/* --- parameters ------------------------------------------------------------------------------- */

static const deck_assignment *given(const used_law *u, const char *name) {
  for (int k = 0; k < u->material->assignment_count; k++)
    if (strcasecmp(u->material->assignments[k].name, name) == 0)
      return &u->material->assignments[k];
  return NULL;
}

static void put_symbol(FILE *out, const law *l, const char *name) {
  char *latex = NULL;
  size_t length;
  FILE *memory = must_open_text(&latex, &length);
  math_symbol(l, name, NO_STEP, false, false, memory);
  must_close_text(memory);
  mathml_put(latex, length, false, out);
  free(latex);
}

/* In the law's own unit, where that is none of SI. */
static void put_value(FILE *out, double value, const char *unit_text) {
  unit own = {.factor = 1};
  const char *bad;
  size_t bad_length;
  if (!unit_parse(unit_text, strlen(unit_text), &own, &bad, &bad_length)) own.factor = 1;
  if (own.factor == 1) {
    html_put_quantity(out, value, unit_text);
    return;
  }
  html_print(out, "%.6g ", value / own.factor + 0.0);
  html_unit(out, unit_text);
}

/* Which value of a parameter that differs from place to place is told; NULL where it does not. */
static const char *told_of(const used_law *u, const char *name, double value) {
  const deck_assignment *a = given(u, name);
  if (a && a->placed)
    return !a->placed->path && value == a->value ? "in the middle of the bodies" : "by default";
  for (int k = 0; k < u->material->varying_count; k++)
    if (strcasecmp(u->material->varying[k], name) == 0) return "of the material";
  for (int k = 0; k < u->material->regional_count; k++)
    for (int n = 0; n < u->material->regional[k]->assignment_count; n++)
      if (strcasecmp(u->material->regional[k]->assignments[n].name, name) == 0)
        return "outside of its regions";
  return NULL;
}

static bool varies(const used_law *u) {
  for (int k = 0; k < u->kernel->parameter_count; k++)
    if (told_of(u, u->kernel->parameters[k].name, u->parameters[k])) return true;
  return false;
}

static void put_parameter(FILE *out, const used_law *u, int k) {
  const pl_parameter *q = &u->kernel->parameters[k];
  const bool set = given(u, q->name) != NULL;
  fputs("<tr><td>", out);
  put_symbol(out, u->m.law, q->name);
  fputs("</td><td><code>", out);
  html_text(out, q->name);
  fprintf(out, "</code></td><td class=\"number%s\">", set ? " changed" : "");
  put_value(out, u->parameters[k], q->unit);
  const char *told = told_of(u, q->name, u->parameters[k]);
  if (told) fprintf(out, " %s; differs from place to place", told);
  fputs("</td><td class=\"number\">", out);
  if (q->has_default) put_value(out, q->initial, q->unit);
  fputs("</td><td>", out);
  html_text(out, q->doc ? q->doc : "");
  fputs("</td></tr>\n", out);
}

static void put_parameters(FILE *out, const used_law *u) {
  if (u->kernel->parameter_count == 0) return;
  fputs(
      "<h3>Parameters as used</h3>\n<p class=\"quiet\">Values that the deck gives stand out.</p>\n"
      "<div class=\"scroll\"><table><thead><tr><th>symbol</th><th>name</th><th>value</th>"
      "<th>default</th><th>meaning</th></tr></thead><tbody>\n",
      out);
  for (int k = 0; k < u->kernel->parameter_count; k++)
    put_parameter(out, u, k);
  fputs("</tbody></table></div>\n", out);
}

/* --- the curve -------------------------------------------------------------------------------- */

static void put_diagram(FILE *out, const drive_table *t, const char *title) {
  const diagram_curve curve = {
      .x = t->columns[t->way].values, .y = t->columns[t->force].values, .count = t->rows};
  const diagram d = {.title = title,
                     .x_name = t->columns[t->way].name,
                     .x_unit = t->columns[t->way].unit,
                     .y_name = t->columns[t->force].name,
                     .y_unit = t->columns[t->force].unit,
                     .curves = &curve,
                     .count = 1};
  if (!diagram_svg(out, &d)) fputs("<p class=\"none\">nothing</p>", out);
}

static void put_curve_caption(FILE *out, const law_curve *c, law_setting setting, bool varied) {
  static const char *const settings[] = {[SETTING_PLANE_STRESS] = "plane stress",
                                         [SETTING_PLANE_STRAIN] = "plane strain",
                                         [SETTING_SPACE] = "space"};
  static const char *const things[] = {[DRIVE_OF_BONDS] = "One bond, spacing",
                                       [DRIVE_OF_FAMILIES] = "One particle, spacing",
                                       [DRIVE_OF_POINTS] = "One point, free across, cell size"};
  char text[HTML_QUANTITY];
  html_print(out, "%s %s, in %s: drawn out by a third of the way, let go, drawn out", things[c->of],
             html_quantity(c->size, "m", text), settings[setting]);
  fputs(c->was_pressed ? "; beside it pressed in the same way" : "", out);
  if (varied) fputs("; with the values above, the same everywhere", out);
}

static void put_curve(FILE *out, const used_law *u) {
  law_curve c;
  if (law_curve_read(&c, &u->m, u->kernel, u->parameters, u->lattice)) {
    fputs("<h3>What it answers by itself</h3>\n<figure class=\"curve alone\"><figcaption>", out);
    put_curve_caption(out, &c, u->m.law->setting, varies(u));
    fputs("</figcaption>\n", out);
    put_diagram(out, &c.drawn, "the answer when drawn");
    if (c.was_pressed) put_diagram(out, &c.pressed, "the answer when pressed");
    fputs("</figure>\n", out);
  }
  law_curve_free(&c);
}

/* --- all laws --------------------------------------------------------------------------------- */

static void put_law(FILE *out, const page_result *p, const deck_material *m,
                    const deck_lattice *lattice, const char *on) {
  used_law u = {.p = p, .material = m, .lattice = lattice};
  char *text = text_of(p, m->model);
  fputs("<section class=\"law\">", out);
  if (text && open_law(&u, text)) {
    put_equations(out, &u);
    fputs("<p class=\"quiet\">At work on <code>", out);
    html_text(out, on);
    fputs("</code>.</p>\n", out);
    put_parameters(out, &u);
    put_curve(out, &u);
  } else {
    fputs("<h2>", out);
    html_text(out, m->model);
    fputs("</h2>\n<p>The result alone does not tell enough to read this law as equations; its text "
          "is below.</p>\n",
          out);
  }
  fputs("</section>\n", out);
  if (u.m.memory) model_close(&u.m);
  if (u.said.sources) diag_clear(&u.said);
  free(u.parameters);
  free(text);
}

/* The same law with the same values, on several lattices, is shown once for each. */
void page_laws(FILE *out, const page_result *p) {
  const deck *k = p->deck;
  for (int n = 0; k && n < k->interaction_count; n++) {
    const deck_interaction *i = &k->interactions[n];
    if (i->material && i->material->model)
      put_law(out, p, i->material, &k->lattices[i->lattice], i->name);
  }
  for (int n = 0; k && n < k->crack_count; n++) {
    const deck_crack *c = &k->cracks[n];
    const int lattice = deck_find_lattice(k, c->mesh);
    if (c->model && lattice >= 0) put_law(out, p, &c->material, &k->lattices[lattice], c->name);
  }
}
