#include "generator/study/study_case.h"

#include <ctype.h>
#include <inttypes.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "dsl/base/hash.h"
#include "generator/interpreter/interpreted.h"
#include "generator/kernel/document.h"
#include "generator/kernel/material_law.h"
#include "generator/kernel/version.h"
#include "generator/plan/plan.h"
#include "generator/run/run.h"
#include "generator/study/study_cost.h"
#include "runtime/analysis/implied.h"
#include "runtime/analysis/material.h"
#include "runtime/crack/tip_values.h"
#include "runtime/deck/deck_check.h"
#include "runtime/deck/deck_read.h"
#include "runtime/deck/lattice_kind.h"

enum { MOST_CASES = 10000, LONGEST_NAME = 120 };

/* --- names ------------------------------------------------------------------------------------ */

/* "lattice.spacing" is "spacing". */
static const char *last_part(const char *key) {
  const char *bracket = strrchr(key, ']'), *dot = strrchr(bracket ? bracket : key, '.');
  return dot ? dot + 1 : key;
}

/* Two keys may have one last part: then both are written whole. So is one that is called as a
   column of all tables. */
const char *study_key_shown(const char *const *keys, int count, int k) {
  static const char *const taken[] = {"case",   "steps", "time step", "wall",
                                      "status", "ended", "verdict"};
  for (size_t t = 0; t < sizeof taken / sizeof *taken; t++)
    if (strcmp(last_part(keys[k]), taken[t]) == 0) return keys[k];
  for (int other = 0; other < count; other++)
    if (other != k && strcmp(last_part(keys[other]), last_part(keys[k])) == 0) return keys[k];
  return last_part(keys[k]);
}

/* What every file system takes, and shells without quotes. */
static void append(char *name, size_t size, const char *text) {
  size_t used = strlen(name);
  for (; *text && used + 1 < size; text++)
    if (isalnum((unsigned char)*text) || strchr(".+-=,", *text))
      name[used++] = *text;
    else if (!isspace((unsigned char)*text))
      name[used++] = '_';
  name[used] = 0;
}

/* Of a file without folder and ending. */
static void append_base(char *name, size_t size, const char *path) {
  char base[256];
  const char *slash = strrchr(path, '/'), *from = slash ? slash + 1 : path,
             *dot = strrchr(from, '.');
  snprintf(base, sizeof base, "%.*s", dot ? (int)(dot - from) : (int)strlen(from), from);
  append(name, size, base);
}

/* A long name is cut, and what is cut told by its hash. */
static const char *case_name(study_request *r, const char *path, const study_setting *varied,
                             int count) {
  char name[1000] = "";
  const char **keys = arena_alloc(r->memory, ((size_t)count + 1) * sizeof *keys);
  for (int k = 0; k < count; k++)
    keys[k] = varied[k].key;
  if (r->decks.count > 1 || count == 0) append_base(name, sizeof name, path);
  for (int k = 0; k < count; k++) {
    if (*name) append(name, sizeof name, ",");
    append(name, sizeof name, study_key_shown(keys, count, k));
    append(name, sizeof name, "=");
    append(name, sizeof name, varied[k].value);
  }
  if (strlen(name) <= LONGEST_NAME) return arena_text(r->memory, name, strlen(name));
  const uint64_t rest = hash_more(HASH_START, name, strlen(name));
  return arena_printf(r->memory, "%.*s-%08" PRIx32, LONGEST_NAME, name, (uint32_t)rest);
}

study_case study_case_of(study_request *r, const char *path, const study_setting *varied,
                         int count) {
  const char *name = case_name(r, path, varied, count), *folder = study_name(r);
  study_case c = {.name = name,
                  .deck = path,
                  .value_count = count,
                  .setting_count = r->set.count + count,
                  .result = arena_printf(r->memory, "%s/%s.h5", folder, name),
                  .log = arena_printf(r->memory, "%s/%s.log", folder, name)};
  c.values = arena_alloc(r->memory, ((size_t)count + 1) * sizeof *c.values);
  c.settings = arena_alloc(r->memory, ((size_t)c.setting_count + 1) * sizeof *c.settings);
  for (int k = 0; k < r->set.count; k++)
    c.settings[k] = study_set_text(r->memory, &r->set.items[k]);
  for (int k = 0; k < count; k++) {
    c.values[k] = varied[k].value;
    c.settings[r->set.count + k] = varied[k];
  }
  return c;
}

/* --- crossing --------------------------------------------------------------------------------- */

static bool are_too_many(study_request *r, const study_axis *axes, int axis_count, int *count) {
  double product = 1;
  for (int a = 0; a < axis_count; a++)
    product *= axes[a].count;
  *count = product <= MOST_CASES ? (int)product : 0;
  if (*count) return false;
  diag_report(&r->said, DIAG_TOO_LONG, axes[axis_count - 1].where,
              "these are %.0f runs; a study has at most %d", product, MOST_CASES);
  return true;
}

/* Of point number `point` of the crossed axes. */
static study_case case_at(study_request *r, const study_axis *axes, int axis_count, int point) {
  int total = 0, at = 0;
  for (int a = 0; a < axis_count; a++)
    total += axes[a].key_count;
  study_setting *varied = arena_alloc(r->memory, ((size_t)total + 1) * sizeof *varied);
  at = total;
  for (int a = axis_count - 1; a >= 0; a--) {
    const int p = point % axes[a].count;
    point /= axes[a].count;
    at -= axes[a].key_count;
    for (int k = 0; k < axes[a].key_count; k++) {
      const study_key *key = &axes[a].keys[k];
      varied[at + k] = study_set(r->memory, key->name, key->values[p], key->where, key->places[p]);
    }
  }
  return study_case_of(r, r->decks.items[0].text, varied, total);
}

static int by_name(const void *a, const void *b) {
  return strcmp(*(const char *const *)a, *(const char *const *)b);
}

/* A name that two cases have, or NULL. */
static const char *name_twice(study_request *r, const study_case *cases, int count) {
  const char **names = arena_alloc(r->memory, ((size_t)count + 1) * sizeof *names);
  for (int k = 0; k < count; k++)
    names[k] = cases[k].name;
  qsort(names, (size_t)count, sizeof *names, by_name);
  for (int k = 1; k < count; k++)
    if (strcmp(names[k - 1], names[k]) == 0) return names[k];
  return NULL;
}

study_case *study_cross(study_request *r, const study_axis *axes, int axis_count, int *count) {
  if (are_too_many(r, axes, axis_count, count)) return NULL;
  study_case *cases = arena_alloc(r->memory, (size_t)*count * sizeof *cases);
  for (int k = 0; k < *count; k++)
    cases[k] = case_at(r, axes, axis_count, k);
  const char *twice = name_twice(r, cases, *count);
  if (!twice) return cases;
  diag_report(&r->said, DIAG_DUPLICATE_NAME, axes[0].where, "two of the runs are `%s`", twice);
  diag_hint(&r->said, "give each value once");
  return NULL;
}

/* --- what a case is --------------------------------------------------------------------------- */

/* The law's text and those that it includes. */
static uint64_t hash_of_law(uint64_t hash, const model *m) {
  for (int k = 0; k < m->sources.count; k++)
    hash = hash_more(hash, m->sources.items[k].text, m->sources.items[k].length);
  return hash;
}

/* However the lattice is turned. */
static double crack_energy_of(const pl_law *of, const double *values, const deck_lattice *l) {
  if (of->kind == PL_STATE || deck_lattice_is_irregular(l) || deck_lattice_is_bar(l) ||
      deck_lattice_is_link(l))
    return NAN;
  deck_lattice straight = *l;
  straight.rotation = 0;
  rows *w = implied_lattice_like(&straight, material_density(of, values));
  const double energy = w ? implied_crack_energy(of, values, w, 0) : (double)NAN;
  if (w) rows_free(w);
  return energy;
}

/* What the deck sets in it must be there, in its unit. */
static bool parameters_fit(model *opened, const deck_lattice *l, double *crack_energy,
                           diagnostics *said) {
  pl_law *kernel = plan_interpreted(opened->plan);
  double *values = must_calloc((size_t)kernel->parameter_count + 1, sizeof *values);
  const bool good = material_parameters(&opened->values, kernel, values, said);
  *crack_energy = good ? crack_energy_of(kernel, values, l) : (double)NAN;
  free(values);
  plan_interpreted_free(kernel);
  return good;
}

static bool take_law(const deck *k, int interaction, study_case *c, uint64_t *hash,
                     diagnostics *said) {
  const deck_interaction *of = &k->interactions[interaction];
  const deck_lattice *l = &k->lattices[of->lattice];
  double crack_energy;
  model opened = {.memory = NULL};
  const bool good = of->material && material_law_open(of->material, l, c->deck, &opened, said) &&
                    parameters_fit(&opened, l, &crack_energy, said);
  if (good && interaction == 0) c->crack_energy = crack_energy;
  if (opened.memory) {
    if (!good) diag_print(&opened.said, stderr);
    *hash = hash_of_law(*hash, &opened);
    model_close(&opened);
  }
  return good;
}

/* Of a crack that has one; whether it is one of cracks, its run says. */
static bool take_crack_law(const deck *k, int crack, const study_case *c, uint64_t *hash,
                           diagnostics *said) {
  const deck_crack *of = &k->cracks[crack];
  model opened = {.memory = NULL};
  if (!of->model) return true;
  const bool good = material_law_open(&of->material, NULL, c->deck, &opened, said);
  if (opened.memory) {
    if (!good) diag_print(&opened.said, stderr);
    *hash = hash_of_law(*hash, &opened);
    model_close(&opened);
  }
  return good;
}

/* "notch/K_I", "notch/start/K_I" of a crack of the deck. */
static bool is_of_tip(const deck *k, const char *name) {
  for (int c = 0; c < k->crack_count; c++) {
    const size_t length = strlen(k->cracks[c].name);
    if (strncmp(name, k->cracks[c].name, length) != 0 || name[length] != '/') continue;
    const char *series = name + length + 1;
    if (strncmp(series, "start/", 6) == 0) series += 6;
    if (deck_is_one_of(series, tip_value_names, TIP_VALUE_COUNT)) return true;
  }
  return false;
}

/* The energies' last parts are histories, too. */
static bool is_history(const deck *k, const char *name) {
  static const char *const energies[] = {"kinetic", "stored", "external", "imbalance"};
  if (!name || strcmp(name, "time") == 0 || deck_find_monitor(k, name) >= 0 || is_of_tip(k, name))
    return true;
  bool energy = strncmp(name, "energy/", 7) == 0 || strncmp(name, "dissipated", 10) == 0;
  for (size_t e = 0; e < sizeof energies / sizeof *energies; e++)
    energy = energy || strcmp(name, energies[e]) == 0;
  return energy && k->output.energy;
}

/* Hours of computing must not end in a curve that is not there. */
static bool has_curves(const study_request *r, const study_case *c, const deck *k) {
  const char *const names[] = {r->o.x, r->o.y, r->strength.text && !c->twin ? r->o.watch : NULL};
  for (size_t n = 0; n < sizeof names / sizeof *names; n++)
    if (!is_history(k, names[n])) {
      say_error("`%s` has no monitor `%s`", c->deck, names[n]);
      for (int m = 0; m < k->monitor_count; m++)
        fprintf(stderr, "%s`%s`%s", m ? ", " : "  it has ", k->monitors[m].name,
                m + 1 < k->monitor_count ? "" : "\n");
      return false;
    }
  return true;
}

/* Of a deck in hand, as it is without the place of its result. */
static bool identify(const study_request *r, arena *memory, study_case *c, source_set *sources,
                     int file, diagnostics *said) {
  const deck *k =
      deck_read(memory, sources, file, study_overrides(memory, c->settings, c->setting_count),
                c->setting_count, said);
  if (!k) return false;
  uint64_t hash = hash_more(HASH_START, k->identity, strlen(k->identity));
  hash = hash_more(hash, perilat_version, strlen(perilat_version));
  for (int f = 0; f < k->file_count; f++) {
    const source *table = &sources->items[k->files[f].source];
    hash = hash_more(hash, table->text, table->length);
  }
  bool good = has_curves(r, c, k);
  for (int n = 0; n < k->interaction_count && good; n++)
    good = take_law(k, n, c, &hash, said);
  for (int n = 0; good && n < k->crack_count; n++)
    good = take_crack_law(k, n, c, &hash, said);
  c->identity = hash;
  c->cost = study_cost(k);
  return good;
}

bool study_case_check(study_request *r, study_case *c) {
  char error[4096];
  size_t length;
  char *text = read_text_file(c->deck, DECK_LIMIT, &length, error, sizeof error);
  if (!text) {
    diag_report(&r->said, DIAG_FILE, r->decks.items[0].where, "%s", error);
    return false;
  }
  arena *memory = arena_new();
  source_set sources = {NULL, 0};
  diagnostics said;
  diag_begin(&said, &sources);
  const bool good =
      identify(r, memory, c, &sources, source_add(&sources, c->deck, text, length), &said);
  study_place(&r->sources, c->settings, &said);
  if (!good) diag_print(&said, stderr);
  diag_clear(&said);
  source_clear(&sources);
  arena_free(memory);
  free(text);
  return good;
}
