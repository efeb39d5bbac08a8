#define _GNU_SOURCE /* strcasestr */
#include "generator/run/run_laws.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

#include "dsl/base/elementary.h"
#include "generator/kernel/document.h"
#include "generator/kernel/material_law.h"
#include "generator/plan/plan.h"
#include "generator/run/law_verdict.h"

/* --- laws ------------------------------------------------------------------------------------- */

static const built_in_law *find_built_in(const run_options *o, const deck_material *m,
                                         const char *name) {
  for (int k = 0; k < o->law_count; k++)
    if (strcmp(o->laws[k].model, m->model) == 0 && strcmp(o->laws[k].interaction, name) == 0)
      return &o->laws[k];
  return NULL;
}

/* Options were decided when the solver was built; the deck may repeat them, not change them. */
static bool drop_built_in_choices(run *r, const deck_material *m, const built_in_law *b,
                                  deck_material *values) {
  int kept = 0;
  bool good = true;
  *values = *m;
  values->assignments =
      arena_alloc(r->memory, ((size_t)m->assignment_count + 1) * sizeof *values->assignments);
  for (int k = 0; k < m->assignment_count; k++) {
    const deck_assignment *a = &m->assignments[k];
    char pair[256];
    snprintf(pair, sizeof pair, ";%s=", a->name);
    const char *at = strcasestr(b->choices, pair);
    if (!at || !a->word) {
      values->assignments[kept++] = *a;
      continue;
    }
    size_t n = strcspn(at + strlen(pair), ";");
    if (strlen(a->word) != n || strncmp(at + strlen(pair), a->word, n) != 0) {
      diag_report(&r->said, DIAG_OPTION, a->value_where, "this solver was built with `%s` = '%.*s'",
                  a->name, (int)n, at + strlen(pair));
      diag_hint(&r->said, "build another solver with `perilat build`, or use `perilat run`");
      good = false;
    }
  }
  values->assignment_count = kept;
  return good;
}

/* Mean distance of the nearest neighbour, m; 0 without bonds. */
static double nearest_distance(const rows *w) {
  double sum = 0, chord[3];
  long count = 0;
  for (long p = 0; p < w->particle_count; p++) {
    const long site = w->particle_site[p];
    double nearest = INFINITY;
    for (int k = 0; k < 2 * w->directions; k++)
      if (rows_has_neighbour(w, site, k)) nearest = pl_fmin(nearest, rows_chord(w, site, k, chord));
    sum += isfinite(nearest) ? nearest : 0;
    count += isfinite(nearest);
  }
  return count ? sum / (double)count : 0;
}

/* Laws are checked on perfect lattices: for particles `w` that stand on none, on one whose
   particles are as far from each other, with the neighbours that the law counts on there. */
static deck_lattice lattice_like(const deck_lattice *d, const rows *w) {
  deck_lattice like = *d;
  if (deck_lattice_is_bar(d)) return lattice_default_bars(d->setting, w->spacing, d->area);
  if (deck_lattice_is_link(d) && d->area > 0)
    return lattice_default_bars(d->setting, d->spacing, d->area);
  if (deck_lattice_is_mesh(d)) return lattice_default(d->setting, d->spacing, d->thickness);
  if (deck_lattice_is_link(d)) return lattice_default(d->setting, d->spacing, d->thickness);
  if (!deck_lattice_is_listed(d)) return like;
  const deck_lattice usual = lattice_default(d->setting, 0, 0);
  like.kind = usual.kind;
  like.spacing = nearest_distance(w);
  like.shells = d->horizon > 0 ? 0 : usual.shells;
  like.neighbours = 0;
  return like;
}

bool obeys_mechanics(run *r, int interaction) {
  const deck_interaction *of = &r->deck->interactions[interaction];
  const deck_lattice like = lattice_like(&r->deck->lattices[of->lattice], r->lattices[of->lattice]);
  const simulation_law *l = &r->laws[interaction];
  model *opened = r->model_of[interaction];
  bool good = run_law_obeys(opened, &like, l->parameters, deck_where(&of->material->item, "model"),
                            &opened->said, &r->said);
  for (int k = 0; k < l->regional_count && good; k++)
    good =
        run_law_obeys(opened, &like, l->regional[k].parameters,
                      deck_where(&l->regional[k].material->item, "model"), &opened->said, &r->said);
  return good;
}

/* --- opening ---------------------------------------------------------------------------------- */

static void say_not_built_in(run *r, const deck_item *item, const char *model_name) {
  diag_report(&r->said, DIAG_FILE, deck_where(item, "model"),
              "this solver was built without the model `%s`", model_name);
}

static bool take_built_in(run *r, const deck_material *m, int interaction, deck_material *values) {
  const built_in_law *b = find_built_in(r->options, m, r->deck->interactions[interaction].name);
  if (!b) {
    say_not_built_in(r, &m->item, m->model);
    return false;
  }
  if (!drop_built_in_choices(r, m, b, values)) return false;
  r->laws[interaction].law = b->law;
  r->built_in[interaction] = b;
  return true;
}

/* A check asks a kernel for a few hundred steps at most, to find the fastest mode of a body of
   families, or of parameters that differ: of a small body that takes the interpreter less time than
   the compiler. */
static bool is_worth_compiling(const rows *w, const model *opened) {
  enum { MANY_BONDS = 200000 };
  return w && w->bond_count > MANY_BONDS &&
         (opened->law->tree->law == LAW_STATE || opened->plan->variation.varying_count > 0);
}

/* 0, or an exit status. */
static int take_model(run *r, const deck_material *m, int interaction, deck_material *values) {
  const int lattice = r->deck->interactions[interaction].lattice;
  char error[4 * ERROR_LENGTH];
  const char *note;
  model *opened = &r->models[r->open_models];
  const bool good =
      material_law_open(m, &r->deck->lattices[lattice], r->options->deck_path, opened, &r->said);
  r->open_models += opened->memory != NULL;
  if (!good) return INPUT_WRONG;
  r->model_of[interaction] = opened;
  *values = opened->values;
  const bool interpret =
      r->options->interpret ||
      (r->options->check_only && !is_worth_compiling(r->lattices[lattice], opened));
  r->laws[interaction].law = model_kernel(opened, interpret, &note, error, sizeof error);
  if (note) fprintf(stderr, "perilat: warning: %s\n", note);
  if (r->laws[interaction].law) return 0;
  say_error("%s", error);
  return RUN_FAILED;
}

static double *parameters_of(run *r, const deck_material *values, const pl_law *kernel) {
  double *parameters = must_calloc((size_t)kernel->parameter_count + 1, sizeof *parameters);
  if (material_parameters(values, kernel, parameters, &r->said)) return parameters;
  free(parameters);
  return NULL;
}

/* Of a region; its options are those of the lattice. */
static bool take_regional(run *r, int interaction, const deck_material *m, regional_values *out) {
  deck_material values;
  const bool good =
      r->options->laws
          ? drop_built_in_choices(r, m, r->built_in[interaction], &values)
          : material_law_regional(m, r->model_of[interaction], r->memory, &values, &r->said);
  *out = (regional_values){m, good ? parameters_of(r, &values, r->laws[interaction].law) : NULL};
  return out->parameters != NULL;
}

static bool take_parameters(run *r, const deck_material *m, const deck_material *values,
                            int interaction) {
  simulation_law *l = &r->laws[interaction];
  double *parameters = parameters_of(r, values, l->law);
  bool good = parameters != NULL;
  l->regional = must_calloc((size_t)m->regional_count + 1, sizeof *l->regional);
  for (int k = 0; k < m->regional_count; k++)
    good = take_regional(r, interaction, m->regional[k], &l->regional[l->regional_count++]) && good;
  if (good)
    l->parameters = parameters;
  else
    free(parameters);
  return good;
}

void free_parameters(simulation_law *l) {
  for (int k = 0; k < l->regional_count; k++)
    free(l->regional[k].parameters);
  free(l->regional);
  free(l->parameters);
}

int load_law(run *r, int interaction) {
  const deck_material *m = r->deck->interactions[interaction].material;
  deck_material values;
  if (!m) return INPUT_WRONG; /* said already */
  const int status = !r->options->laws ? take_model(r, m, interaction, &values)
                     : take_built_in(r, m, interaction, &values) ? 0
                                                                 : INPUT_WRONG;
  if (status) return status;
  return take_parameters(r, m, &values, interaction) ? 0 : INPUT_WRONG;
}

static bool is_of_cracks(run *r, const deck_crack *c, const model *opened) {
  if (opened->law->tree->law == LAW_CRACK) return true;
  diag_report(&r->said, DIAG_CONFLICT, deck_where(&c->item, "model"), "`%s` is no law of cracks",
              opened->law->tree->name);
  diag_hint(&r->said, "take one that has `crack ... end crack`, such as `lefm`");
  return false;
}

/* Of a solver: with what it was built. */
static int take_built_in_crack_law(run *r, const deck_crack *c, int number) {
  simulation_law *out = &r->laws[number];
  const built_in_law *b =
      find_built_in(r->options, &c->material, arena_printf(r->memory, BUILT_IN_CRACK, c->name));
  deck_material values;
  if (!b) {
    say_not_built_in(r, &c->item, c->model);
    return INPUT_WRONG;
  }
  if (!drop_built_in_choices(r, &c->material, b, &values)) return INPUT_WRONG;
  out->parameters = parameters_of(r, &values, b->law);
  if (!out->parameters) return INPUT_WRONG;
  r->built_in[number] = b;
  out->law = b->law;
  return 0;
}

/* Opened, with its parameters and its verdict; its kernel is that of a law that may run. */
static int take_crack_law(run *r, const deck_crack *c, int number) {
  simulation_law *out = &r->laws[number];
  char error[4 * ERROR_LENGTH];
  const char *note;
  model *opened = &r->models[r->open_models];
  const bool good = material_law_open(&c->material, NULL, r->options->deck_path, opened, &r->said);
  const deck_lattice none = lattice_default("plane_stress", 1, 1);
  r->open_models += opened->memory != NULL;
  if (!good || !is_of_cracks(r, c, opened)) return INPUT_WRONG;
  const pl_law *kernel = model_kernel(opened, r->options->interpret || r->options->check_only,
                                      &note, error, sizeof error);
  if (!kernel) {
    say_error("%s", error);
    return RUN_FAILED;
  }
  out->parameters = parameters_of(r, &opened->values, kernel);
  if (!out->parameters) return INPUT_WRONG;
  if (!r->options->no_physics &&
      !run_law_obeys(opened, &none, out->parameters, deck_where(&c->item, "model"), &opened->said,
                     &r->said))
    return INPUT_WRONG;
  r->model_of[number] = opened;
  out->law = kernel;
  return 0;
}

int load_crack_law(run *r, int crack) {
  const deck_crack *c = &r->deck->cracks[crack];
  const int number = r->deck->interaction_count + crack;
  if (!c->model) return 0;
  return r->options->laws ? take_built_in_crack_law(r, c, number) : take_crack_law(r, c, number);
}

bool check_law_alone(run *r, const deck_material *m) {
  char *path = r->options->laws ? NULL : model_find(m->model, r->options->deck_path);
  if (!path) return false;
  model *opened = &r->models[r->open_models++];
  const bool good = material_law_read(m, path, opened, &r->said);
  free(path);
  return good;
}
