#include "generator/grade/measure.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "dsl/semantics/law_reads.h"
#include "generator/interpreter/interpreted.h"
#include "generator/kernel/material_law.h"
#include "generator/kernel/settings.h"
#include "generator/run/run.h"
#include "runtime/analysis/implied.h"
#include "runtime/analysis/material.h"
#include "runtime/analysis/stability.h"
#include "runtime/deck/deck_value.h"
#include "runtime/deck/lattice_kind.h"
#include "runtime/result/result_read.h"

/* Of the n-th run. */
static const char result_names[] = "run_%d.h5";

/* --- implied ---------------------------------------------------------------------------------- */

typedef struct implying {
  arena *memory;
  bool beside;
  const exercise_item *item;
  source_set sources;
  diagnostics said;
  deck_material material;
  deck_lattice lattice;
  model model;
} implying;

/* "s=20 mm": a size, not a parameter of the law. */
static bool set_size(implying *m, const char *text) {
  double *size = text[0] == 's' ? &m->lattice.spacing : &m->lattice.thickness;
  if ((text[0] != 's' && text[0] != 't') || text[1 + strspn(text + 1, " ")] != '=') return false;
  const char *value = strchr(text, '=') + 1;
  value += strspn(value, " ");
  const int file = source_add(&m->sources, "set", text, strlen(text));
  const span where = source_whole(&m->sources, file);
  const namelist_value v = {
      .kind = NAMELIST_TEXT, .text = value, .where = where, .text_where = where};
  deck_real_read(&v, "set", "m", BOUND_POSITIVE, size, &m->said);
  return true;
}

static bool take_settings(implying *m) {
  const exercise_item *item = m->item;
  const char **of_law = arena_alloc(m->memory, ((size_t)item->set_count + 1) * sizeof *of_law);
  int count = 0;
  for (int k = 0; k < item->set_count; k++)
    if (!set_size(m, item->set[k])) of_law[count++] = item->set[k];
  m->lattice.stiffness_thickness = m->lattice.mass_thickness = m->lattice.thickness;
  return settings_read(m->memory, &m->sources, of_law, count, &m->material, &m->said) &&
         m->said.errors == 0;
}

static void choose_lattice(implying *m, const law *l) {
  m->lattice = law_reads(l, QUANTITY_AREA)
                   ? lattice_default_chain(10e-3, 100e-6)
                   : lattice_default(law_setting_name(l->setting), 10e-3, 100e-3);
}

static double choose(const char *quantity, const pl_law *kernel, const double *values,
                     const rows *w) {
  implied_elasticity elastic;
  implied_bond bond;
  double strain;
  if (strcmp(quantity, "stable_step") == 0 || strcmp(quantity, "omega_max") == 0) {
    step_limit step;
    if (!(w->mass > 0)) return NAN;
    stability_limit(kernel, values, NULL, w, &step);
    return quantity[0] == 's' ? step.limit : step.omega_max;
  }
  if (strcmp(quantity, "peak_stress") == 0) return implied_strength(kernel, values, w, 0, &strain);
  if (strcmp(quantity, "crack_energy") == 0) return implied_crack_energy(kernel, values, w, 0);
  if (strcmp(quantity, "work_of_fracture") == 0) {
    implied_bond_curve(kernel, values, w, 0, &bond);
    return bond.row_energy;
  }
  if (!implied_elastic(kernel, values, w, &elastic)) return NAN;
  return strcmp(quantity, "E") == 0    ? elastic.E[0]
         : strcmp(quantity, "nu") == 0 ? elastic.nu[0]
                                       : elastic.G;
}

static _Thread_local pl_states_function tangent_at; /* of the law at hand */

/* The mean of the tangents a little to both sides of the deformations. */
static void tangent_beside(const pl_law *kernel, const double *uniforms, const pl_states *states) {
  const double little = 1e-9;
  const double *in[PL_STATE_INPUTS];
  const size_t count = (size_t)states->count;
  double *moved = must_calloc(PL_STATE_INPUTS * count, sizeof *moved),
         *sum = must_calloc(PL_TANGENTS * count, sizeof *sum);
  for (int side = -1; side <= 1; side += 2) {
    pl_states at = *states;
    for (int i = 0; i < kernel->state_input_count; i++) {
      const char *name = kernel->state_inputs[i].name;
      const bool moves = strcmp(name, "stretch") == 0 || strncmp(name, "theta_", 6) == 0;
      for (size_t k = 0; k < count; k++)
        moved[(size_t)i * count + k] = states->in[i][k] + (moves ? side * little : 0);
      in[i] = moved + (size_t)i * count;
    }
    at.in = in;
    tangent_at(kernel, uniforms, &at);
    for (size_t k = 0; k < PL_TANGENTS * count; k++)
      sum[k] += states->out[k / count][k % count] / 2;
  }
  for (size_t k = 0; k < PL_TANGENTS * count; k++)
    states->out[k / count][k % count] = sum[k];
  free(moved);
  free(sum);
}

const char *implied_unit(const exercise_item *item) {
  static const struct {
    const char *quantity, *unit;
  } units[] = {{"E", "Pa"},
               {"G", "Pa"},
               {"stable_step", "s"},
               {"omega_max", "rad/s"},
               {"peak_stress", "Pa"},
               {"work_of_fracture", "J/m^2"},
               {"crack_energy", "J/m^2"}};
  for (size_t k = 0; k < sizeof units / sizeof *units; k++)
    if (strcmp(units[k].quantity, item->quantity) == 0) return units[k].unit;
  return "1"; /* nu */
}

static double imply(implying *m) {
  pl_law *kernel = plan_interpreted(m->model.plan);
  if (m->beside && kernel->tangent) {
    tangent_at = kernel->tangent;
    kernel->tangent = tangent_beside;
  }
  double *values = arena_alloc(m->memory, ((size_t)kernel->parameter_count + 1) * sizeof *values);
  double value = NAN;
  if (material_parameters(&m->model.values, kernel, values, &m->said)) {
    rows *w = implied_lattice_like(&m->lattice, material_density(kernel, values));
    value = w ? choose(m->item->quantity, kernel, values, w) : NAN;
    if (w) rows_free(w);
  }
  plan_interpreted_free(kernel);
  return value;
}

double measure_implied(arena *a, const exercise_item *item, const char *answer, bool beside,
                       const char **why) {
  implying m = {.memory = a, .beside = beside, .item = item, .material = {.model = answer}};
  model first;
  double value = NAN;
  diag_begin(&m.said, &m.sources);
  const bool read = model_open(&first, answer, NULL, 0);
  if (read) choose_lattice(&m, first.law);
  model_close(&first);
  if (read && take_settings(&m) &&
      material_law_open(&m.material, &m.lattice, "deck.nml", &m.model, &m.said))
    value = imply(&m);
  if (isnan(value))
    *why = arena_printf(a, "your law implies no `%s`%s%s", item->quantity, m.said.count ? ": " : "",
                        m.said.count ? m.said.items[0].message : "");
  if (m.model.memory) model_close(&m.model);
  diag_clear(&m.said);
  source_clear(&m.sources);
  return value;
}

/* --- a run ------------------------------------------------------------------------------------ */

static double largest_energy(result_file *f) {
  static const char *const terms[] = {"energy/kinetic",           "energy/stored",
                                      "energy/dissipated_damage", "energy/dissipated_damping",
                                      "energy/external",          "energy/rest"};
  double most = 0;
  char unit_text[64], error[256];
  for (size_t k = 0; k < sizeof terms / sizeof *terms; k++) {
    long count;
    double *v =
        result_read_series(f, terms[k], &count, unit_text, sizeof unit_text, error, sizeof error);
    for (long q = 0; v && q < count; q++)
      most = fabs(v[q]) > most ? fabs(v[q]) : most;
    free(v);
  }
  return most;
}

static double *series(result_file *f, const char *name, long *count, char *error, size_t size) {
  char unit_text[64];
  return result_read_series(f, name, count, unit_text, sizeof unit_text, error, size);
}

static long peak_of(const double *v, long count) {
  long best = 0;
  for (long k = 1; k < count; k++)
    if (fabs(v[k]) > fabs(v[best])) best = k;
  return best;
}

/* Of the whole run: in parts of its largest energy. */
static double worst_imbalance(result_file *f, char *error, size_t size) {
  long count;
  double *v = series(f, "energy/imbalance", &count, error, size);
  const double most = largest_energy(f),
               value = v && count && most > 0 ? fabs(v[peak_of(v, count)]) / most : NAN;
  free(v);
  return value;
}

static double total_dissipated(result_file *f, char *error, size_t size) {
  long counts[2];
  double *v = series(f, "energy/dissipated_damage", &counts[0], error, size),
         *w = series(f, "energy/dissipated_damping", &counts[1], error, size);
  const double value = v && w && counts[0] && counts[1] ? v[counts[0] - 1] + w[counts[1] - 1] : NAN;
  free(v);
  free(w);
  return value;
}

static double of_monitor(result_file *f, const exercise_item *item, char unit_text[64], char *error,
                         size_t size) {
  long count, other;
  double *v = result_read_series(f, item->monitor, &count, unit_text, 64, error, size);
  double *w = strcmp(item->of, "at peak") == 0 ? series(f, item->at, &other, error, size) : NULL;
  double value = NAN;
  if (v && count && strcmp(item->of, "last") == 0)
    value = v[count - 1];
  else if (v && w && other == count && count)
    value = v[peak_of(w, count)];
  else if (v && count && strcmp(item->of, "peak") == 0)
    value = v[peak_of(v, count)];
  free(v);
  free(w);
  return value;
}

static double read_result(arena *a, const exercise_item *item, int run, char unit_text[64],
                          const char **why) {
  char error[1024] = "the deck has no such monitor";
  result_file *f = result_read(arena_printf(a, result_names, run), error, sizeof error);
  if (!f) {
    *why = "the run left no result";
    return NAN;
  }
  snprintf(unit_text, 64, "%s", strcmp(item->of, "dissipated") == 0 ? "J" : "1");
  const double value = strcmp(item->of, "imbalance") == 0 ? worst_imbalance(f, error, sizeof error)
                       : strcmp(item->of, "dissipated") == 0
                           ? total_dissipated(f, error, sizeof error)
                           : of_monitor(f, item, unit_text, error, sizeof error);
  if (isnan(value)) *why = arena_printf(a, "%s", error);
  result_read_close(f);
  return value;
}

/* The run of that deck with these settings, made unless it was before. Its number. */
static int run_of(arena *a, const char *path, deck_override *all, int count, runs_made *made) {
  const char *key = path;
  for (int k = 0; k < count; k++)
    key = arena_printf(a, "%s\n%s", key, all[k].text);
  for (int k = 0; k < made->count; k++)
    if (strcmp(made->keys[k], key) == 0) return k;
  made->keys = arena_room(a, made->keys, made->count, sizeof *made->keys);
  made->status = arena_room(a, made->status, made->count, sizeof *made->status);
  all[count++].text =
      arena_printf(a, "output.result=%s", arena_printf(a, result_names, made->count));
  const run_options o = {.program = "perilat run",
                         .deck_path = path,
                         .overrides = all,
                         .override_count = count,
                         .threads = 1,
                         .interpret = true,
                         .no_physics = true};
  made->keys[made->count] = key;
  made->status[made->count] = run_deck(&o);
  return made->count++;
}

/* The text in quotes, as a deck has it. */
static const char *quoted(arena *a, const char *text) {
  const char *all = "'";
  for (; *text; text++)
    all = arena_printf(a, "%s%s%c", all, *text == '\'' ? "'" : "", *text);
  return arena_printf(a, "%s'", all);
}

/* The whole path of the law: what else has its name beside the deck, or among the models, is
   another one. */
static const char *law_in_deck(arena *a, const char *answer) {
  char *whole = realpath(answer, NULL);
  const char *name = quoted(a, whole ? whole : answer);
  free(whole);
  return name;
}

double measure_run(arena *a, const exercise_item *item, const char *answer, const char *const *more,
                   int more_count, runs_made *made, const char **why) {
  const int most = item->set_count + more_count + 2;
  deck_override *all = arena_alloc(a, (size_t)most * sizeof *all);
  int count = 0;
  const char *of = item->material ? arena_printf(a, "[%s]", item->material) : "";
  all[count++].text = arena_printf(a, "material%s.model=%s", of, law_in_deck(a, answer));
  for (int k = 0; k < item->set_count; k++)
    all[count++].text = item->set[k];
  for (int k = 0; k < more_count; k++)
    all[count++].text = more[k];
  const int run = run_of(a, item->found[0].path, all, count, made), status = made->status[run];
  if (status == 0) return read_result(a, item, run, made->unit, why);
  *why = status == INPUT_WRONG ? "the deck refuses your law" : "the run with your law failed";
  return NAN;
}
