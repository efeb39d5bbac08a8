/* Laws of a deck: found, checked, options chosen, compiled; parameters read. */
#define _GNU_SOURCE /* strcasestr */
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

#include "dsl/base/elementary.h"
#include "dsl/syntax/parse.h"
#include "generator/check/physics.h"
#include "generator/kernel/document.h"
#include "generator/run/run_parts.h"
#include "runtime/deck/bravais.h"
#include "runtime/simulation/material.h"

/* --- options of a law ------------------------------------------------------------------------- */

static const symbol *find_option(const law *l, const char *name) {
  for (int k = 0; k < l->options.count; k++)
    if (strcasecmp(l->options.items[k]->name, name) == 0) return l->options.items[k];
  return NULL;
}

/* The choice as the law writes it, or NULL with a diagnostic at the deck's line. */
static const char *find_choice(const symbol *option, const deck_assignment *a, diagnostics *said) {
  const stmt *declared = option->declared;
  for (int w = 0; a->word && w < declared->word_count; w++)
    if (strcmp(declared->words[w], a->word) == 0) return declared->words[w];
  char words[256] = "";
  for (int w = 0; w < declared->word_count; w++) {
    size_t used = strlen(words);
    snprintf(words + used, sizeof words - used, "%s'%s'", w ? ", " : "", declared->words[w]);
  }
  if (a->word)
    diag_report(said, DIAG_OPTION, a->value_where, "the option `%s` has no choice `%s`",
                option->name, a->word);
  else
    diag_report(said, DIAG_OPTION, a->value_where, "the option `%s` takes a word", option->name);
  diag_hint(said, "the choices are %s", words);
  return NULL;
}

/* A material's assignment that names an option of the law is a choice, not a parameter value. The choices' texts are
   copies: they outlive the law. */
static bool take_choices(deck_material *m, const law *l, law_choice *choices, int *count,
                         diagnostics *said) {
  int kept = 0;
  bool good = true;
  *count = 0;
  for (int k = 0; k < m->assignment_count; k++) {
    const deck_assignment *a = &m->assignments[k];
    const symbol *option = find_option(l, a->name);
    if (!option) {
      m->assignments[kept++] = *a;
      continue;
    }
    const char *choice = find_choice(option, a, said);
    good = good && choice;
    if (choice) choices[(*count)++] = (law_choice){must_copy(option->name), must_copy(choice)};
  }
  m->assignment_count = kept;
  return good;
}

/* Opens the law a second time when the deck chooses among its options. */
static bool apply_choices(deck_material *m, const char *path, model *out, diagnostics *said) {
  law_choice *choices = must_calloc((size_t)m->assignment_count + 1, sizeof *choices);
  int count;
  bool good = take_choices(m, out->law, choices, &count, said);
  if (good && count) {
    model_close(out);
    good = model_open(out, path, choices, count);
  }
  for (int k = 0; k < count; k++) {
    free((void *)(uintptr_t)choices[k].option);
    free((void *)(uintptr_t)choices[k].choice);
  }
  free(choices);
  return good;
}

/* The parameter of a &field in the law, or -1 after a message. */
static int find_varying(const deck_material *m, int field, const law *l, diagnostics *said) {
  const char *wanted = m->varying[field];
  const char **names = must_calloc((size_t)l->parameters.count + 1, sizeof *names);
  int found = -1;
  for (int p = 0; p < l->parameters.count; p++) {
    names[p] = l->parameters.items[p]->name;
    if (strcasecmp(names[p], wanted) == 0) found = p;
  }
  if (found < 0) {
    diag_report(said, DIAG_UNKNOWN_NAME, m->varying_where[field],
                "the law `%s` has no parameter `%s`", l->tree->name, wanted);
    diag_suggest(said, wanted, names, l->parameters.count);
  } else if (l->rho && found == l->rho->index) {
    diag_report(
        said, DIAG_NOT_SUPPORTED, m->varying_where[field],
        "`rho` cannot differ from bond to bond: it belongs to the particles, which have one mass");
    found = -1;
  }
  free(names);
  return found;
}

/* Plans the kernel that the deck's random fields need. Their order decides nothing: the law's does. */
static bool plan_material(const deck_material *m, model *out, diagnostics *said) {
  int *varying = must_calloc((size_t)m->varying_count + 1, sizeof *varying), count = 0;
  bool good = true;
  for (int k = 0; k < m->varying_count; k++) {
    int found = find_varying(m, k, out->law, said);
    good = good && found >= 0;
    int at = count++;
    for (; at > 0 && varying[at - 1] > found; at--)
      varying[at] = varying[at - 1];
    varying[at] = found;
  }
  good = good && model_plan_varying(out, varying, count);
  free(varying);
  return good;
}

bool run_open_law(deck_material *m, const char *path, model *out, diagnostics *said) {
  bool good = model_open(out, path, NULL, 0);
  if (good && out->law->options.count > 0) good = apply_choices(m, path, out, said);
  return good;
}

/* A deck may come from somebody else, and name a file whose lines are nobody's business: only those
 * of laws are shown. */
static bool named_law_is_one(const deck_material *m, const char *path, diagnostics *said) {
  char error[4 * ERROR_LENGTH];
  size_t length;
  char *text = read_text_file(path, MODEL_LIMIT, &length, error, sizeof error);
  const bool good = text && parse_begins_law(text);
  const span where = deck_where(&m->item, "model");
  if (!text)
    diag_report(said, DIAG_FILE, where, "%s", error);
  else if (!good) {
    diag_report(said, DIAG_FILE, where, "`%s` is not a law", path);
    diag_hint(said, "the first word of a law is `model`");
  }
  free(text);
  return good;
}

static bool open_named_law(deck_material *m, const char *path, model *out, diagnostics *said) {
  return named_law_is_one(m, path, said) && run_open_law(m, path, out, said);
}

static law_setting setting_of(const deck_lattice *l) {
  for (int k = SETTING_PLANE_STRESS; l && k <= SETTING_SPACE; k++)
    if (strcmp(l->setting, law_setting_name((law_setting)k)) == 0) return (law_setting)k;
  return SETTING_PLANE_STRESS;
}

/* Of a full family; 0 where particles stand on no lattice. */
static int neighbours_of(const deck_lattice *l) {
  bravais_neighbour list[PL_MAX_DIRECTIONS];
  bravais b;
  if (!l || deck_lattice_is_irregular(l) || !bravais_of(l, &b)) return 0;
  return 2 * bravais_family(&b, l->horizon, l->shells, list);
}

/* What a bond knows of the third direction its law must say; `for` is the word that it has. */
static void warn_of_plane_strain(const deck_lattice *l, const model *m, diagnostics *said) {
  if (!l || m->law->setting != SETTING_PLANE_STRAIN || m->law->tree->law == LAW_STATE ||
      m->tree->setting_count > 0)
    return;
  diag_report(
      said, DIAG_DECK_WARNING, deck_where(&l->item, "setting"),
      "the law of bonds `%s` does not say for which setting it is: its bonds may be those of "
      "plane stress",
      m->law->tree->name);
  diag_hint(said,
            "where its equations hold in plane strain, write `for plane_strain` into the law; "
            "else take another one, such as `splm_elastic`");
}

/* The law takes the setting of its lattice; without one a bond is of a lattice in plane stress. */
static bool take_setting(const deck_material *m, const deck_lattice *l, model *out,
                         diagnostics *said) {
  char meant[96];
  if (!l && out->law->tree->law == LAW_STATE) return true;
  out->law->setting = setting_of(l);
  const char *name = law_setting_name(out->law->setting);
  out->law->irregular = l && deck_lattice_is_irregular(l);
  out->law->neighbours = neighbours_of(l);
  if (out->law->irregular && !model_suits_irregular(out)) {
    diag_report(said, DIAG_CONFLICT, deck_where(&m->item, "model"),
                "the law `%s` is meant for lattices, but these particles are irregular",
                out->law->tree->name);
    diag_hint(said,
              "take another law such as `splm_elastic`; where the equations hold for families of "
              "any shape add `irregular` to the law's line `for`");
    return false;
  }
  if (model_suits(out, name, meant, sizeof meant)) {
    warn_of_plane_strain(l, out, said);
    return true;
  }
  diag_report(said, DIAG_CONFLICT, deck_where(&m->item, "model"),
              "the law `%s` is meant for %s, but this lattice is in %s", out->law->tree->name,
              meant, name);
  diag_hint(said,
            "take another law or setting; where the equations hold in %s, too, add it to the "
            "law's line `for`",
            name);
  return false;
}

/* Laws of bonds run as strips on the hexagon of nearest neighbours; on all other lattices a central law runs as one of
   families. */
static bool needs_families(const deck_lattice *l, const law *of) {
  return of->tree->law == LAW_CENTRAL_BOND && !bravais_is_hexagon(l);
}

/* Families have one value of each parameter. */
static bool can_vary(const deck_material *m, const law *of, bool families, diagnostics *said) {
  if (m->varying_count == 0 || !(families || of->tree->law == LAW_STATE)) return true;
  if (families) {
    diag_report(said, DIAG_NOT_SUPPORTED, m->varying_where[0],
                "on this lattice the central law `%s` runs as one of families, whose parameters "
                "cannot differ from bond to bond",
                of->tree->name);
    diag_hint(said, "random fields need the hexagonal lattice of nearest neighbours");
  } else
    diag_report(said, DIAG_NOT_SUPPORTED, m->varying_where[0],
                "the law `%s` reads whole families: its parameters cannot differ from bond to bond",
                of->tree->name);
  return false;
}

bool run_open_material(deck_material *m, const deck_lattice *l, const char *deck_path, model *out,
                       diagnostics *said) {
  char *path = model_find(m->model, deck_path);
  if (!path) {
    diag_report(said, DIAG_FILE, deck_where(&m->item, "model"), "there is no model `%s`", m->model);
    diag_hint(said, "give a path ending in .plm, or put the file beside the deck or in a folder "
                    "`models`; PERILAT_MODELS may name another folder");
    return false;
  }
  bool good = open_named_law(m, path, out, said) && take_setting(m, l, out, said);
  free(path);
  if (!good) return false;
  const bool families = l && needs_families(l, out->law);
  if (!can_vary(m, out->law, families, said)) return false;
  return families ? model_plan_of_families(out) : plan_material(m, out, said);
}

/* --- laws ------------------------------------------------------------------------------------- */

static deck_material *material_of(const run *r, int lattice) {
  const int m = deck_find_material(r->deck, r->deck->lattices[lattice].name);
  return m < 0 ? NULL : &r->deck->materials[m];
}

static const built_in_law *find_built_in(const run_options *o, const char *model_name) {
  for (int k = 0; k < o->law_count; k++)
    if (strcmp(o->laws[k].model, model_name) == 0) return &o->laws[k];
  return NULL;
}

/* Options were decided when the solver was built; the deck may repeat them, not change them. */
static bool drop_built_in_choices(run *r, deck_material *m, const built_in_law *b) {
  int kept = 0;
  bool good = true;
  for (int k = 0; k < m->assignment_count; k++) {
    const deck_assignment *a = &m->assignments[k];
    char pair[256];
    snprintf(pair, sizeof pair, ";%s=", a->name);
    const char *at = strcasestr(b->choices, pair);
    if (!at || !a->word) {
      m->assignments[kept++] = *a;
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
  m->assignment_count = kept;
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
  if (!deck_lattice_is_irregular(d)) return like;
  const bool space = deck_lattice_dimensions(d) == 3;
  like.kind = space ? "fcc" : "hexagonal";
  like.spacing = nearest_distance(w);
  like.shells = d->horizon > 0 || !space ? 0 : 2;
  like.neighbours = 0;
  return like;
}

/* What `perilat check law.plm` judges is more than a deck needs. */
static void warn_of_other_values(model *opened, span where, diagnostics *d) {
  const law_setting setting = opened->law->setting;
  diagnostics found;
  diag_begin(&found, &opened->sources);
  opened->law->setting = law_first_setting(opened->law);
  if (!physics_check(opened->law, NULL, &found, NULL)) {
    diag_report(d, DIAG_DECK_WARNING, where,
                "the law `%s` obeys mechanics with these values on this lattice, but not with all "
                "that its bounds allow",
                opened->law->tree->name);
    diag_hint(d, "`perilat check %s`, with the options chosen here, shows where", opened->path);
  }
  opened->law->setting = setting;
  diag_clear(&found);
}

bool run_law_obeys(model *opened, const deck_lattice *lattice, const double *parameters, span where,
                   diagnostics *of_law, diagnostics *of_values) {
  const physics_options options = {.parameters = parameters, .lattice = lattice, .effort = 0.5};
  const bool irregular = opened->law->irregular;
  opened->law->irregular = false;
  const bool good = physics_check(opened->law, &options, of_law, NULL);
  if (good) warn_of_other_values(opened, where, of_values);
  opened->law->irregular = irregular;
  return good;
}

bool obeys_mechanics(run *r, int lattice) {
  const deck_lattice like = lattice_like(&r->deck->lattices[lattice], r->lattice);
  model *opened = &r->models[lattice];
  return run_law_obeys(opened, &like, r->laws[lattice].parameters,
                       deck_where(&material_of(r, lattice)->item, "model"), &opened->said,
                       &r->said);
}

/* --- opening ---------------------------------------------------------------------------------- */

static bool take_built_in(run *r, deck_material *m, int lattice) {
  const built_in_law *b = find_built_in(r->options, m->model);
  if (!b) {
    diag_report(&r->said, DIAG_FILE, deck_where(&m->item, "model"),
                "this solver was built without the model `%s`", m->model);
    return false;
  }
  if (!drop_built_in_choices(r, m, b)) return false;
  r->laws[lattice].law = b->law;
  r->built_in[lattice] = b;
  return true;
}

/* A check asks a kernel for a few hundred steps at most, to find the fastest mode of a body of
   families: of a small body that takes the interpreter less time than the compiler. */
static bool is_worth_compiling(const run *r, const model *opened) {
  enum { MANY_BONDS = 200000 };
  return r->lattice && r->lattice->bond_count > MANY_BONDS && opened->law->tree->law == LAW_STATE;
}

/* 0, or an exit status. */
static int take_model(run *r, deck_material *m, int lattice) {
  char error[4 * ERROR_LENGTH];
  const char *note;
  model *opened = &r->models[r->open_models];
  const bool good =
      run_open_material(m, &r->deck->lattices[lattice], r->options->deck_path, opened, &r->said);
  r->open_models += opened->memory != NULL;
  if (!good) return INPUT_WRONG;
  const bool interpret =
      r->options->interpret || (r->options->check_only && !is_worth_compiling(r, opened));
  r->laws[lattice].law = model_kernel(opened, interpret, &note, error, sizeof error);
  if (note) fprintf(stderr, "perilat: warning: %s\n", note);
  if (r->laws[lattice].law) return 0;
  say_error("%s", error);
  return RUN_FAILED;
}

static bool take_parameters(run *r, const deck_material *m, int lattice) {
  simulation_law *l = &r->laws[lattice];
  l->parameters = must_calloc((size_t)l->law->parameter_count + 1, sizeof(double));
  if (material_parameters(m, l->law, l->parameters, &r->said)) return true;
  free(l->parameters);
  l->parameters = NULL;
  return false;
}

int load_law(run *r, int lattice) {
  deck_material *m = material_of(r, lattice);
  if (!m) return INPUT_WRONG; /* said already */
  const int status = !r->options->laws              ? take_model(r, m, lattice)
                     : take_built_in(r, m, lattice) ? 0
                                                    : INPUT_WRONG;
  if (status) return status;
  return take_parameters(r, m, lattice) ? 0 : INPUT_WRONG;
}

bool check_law_alone(run *r, deck_material *m) {
  char *path = r->options->laws ? NULL : model_find(m->model, r->options->deck_path);
  if (!path) return false;
  model *opened = &r->models[r->open_models++];
  const bool good = open_named_law(m, path, opened, &r->said);
  free(path);
  return good;
}
