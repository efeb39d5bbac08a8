#define _GNU_SOURCE /* strcasestr */
#include "generator/run.h"

#include <errno.h>
#include <math.h>
#include <omp.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>
#include <sys/stat.h>
#include <time.h>
#include <unistd.h>

#include "generator/kernel_check.h"
#include "generator/model.h"
#include "generator/progress.h"
#include "generator/version.h"
#include "runtime/implied.h"
#include "runtime/result.h"
#include "runtime/simulation.h"

enum { INPUT_WRONG = 1, RUN_FAILED = 2, ERROR_LENGTH = 1024 };
#define DECK_LIMIT ((size_t)16 << 20)

static volatile sig_atomic_t interrupted;
static void on_interrupt(int signal_number) {
  (void)signal_number;
  interrupted = 1;
}

/* Everything a run holds, so that one function can let go of it. */
typedef struct run {
  const run_options *options;
  arena *memory;
  source_set sources;
  diagnostics said;
  deck *deck;
  model *models;           /* [material_count] */
  int open_models;
  simulation_law *laws;    /* [lattice_count] */
  const built_in_law **built_in; /* [lattice_count], NULL entries otherwise */
  simulation *simulation;
  result *result;
  char *result_path, *checkpoint_path;
  char fingerprint[40], started[32];
  double *frame_buffer;
} run;

/* --- paths and fingerprint ---------------------------------------------------------------------- */

/* The result stands in the working folder, named by the deck or after it. */
static void choose_paths(run *r) {
  const char *given = r->deck->output.result;
  char path[4096];
  if (given) {
    snprintf(path, sizeof path, "%s", given);
  } else {
    const char *slash = strrchr(r->options->deck_path, '/');
    const char *name = slash ? slash + 1 : r->options->deck_path;
    const char *dot = strrchr(name, '.');
    snprintf(path, sizeof path, "%.*s.h5", dot ? (int)(dot - name) : (int)strlen(name), name);
  }
  r->result_path = arena_text(r->memory, path, strlen(path));
  r->checkpoint_path = arena_printf(r->memory, "%s.checkpoint", path);
}

static uint64_t fnv(uint64_t hash, const char *text) {
  for (; *text; text++)
    hash = (hash ^ (unsigned char)*text) * UINT64_C(0x100000001b3);
  return (hash ^ 0xff) * UINT64_C(0x100000001b3);
}

/* What a checkpoint belongs to: the deck as overridden, and the kernels. */
static void fingerprint(run *r) {
  uint64_t hash = fnv(UINT64_C(0xcbf29ce484222325), r->sources.items[0].text);
  for (int k = 0; k < r->options->override_count; k++)
    hash = fnv(hash, r->options->overrides[k].text);
  for (int k = 0; k < r->deck->lattice_count; k++)
    hash = fnv(hash, r->laws[k].law->key);
  snprintf(r->fingerprint, sizeof r->fingerprint, "%016llx", (unsigned long long)hash);
}

/* --- setting up --------------------------------------------------------------------------------- */

static bool load_deck(run *r) {
  const run_options *o = r->options;
  char error[ERROR_LENGTH];
  size_t length = o->deck_text ? strlen(o->deck_text) : 0;
  char *text = o->deck_text ? strdup(o->deck_text)
                            : read_text_file(o->deck_path, DECK_LIMIT, &length, error, sizeof error);
  if (!text) {
    fprintf(stderr, "perilat: error: %s\n", error);
    return false;
  }
  int file = source_add(&r->sources, o->deck_path, text, length);
  free(text);
  r->deck = deck_read(r->memory, &r->sources, file, o->overrides, o->override_count, &r->said);
  return r->deck != NULL;
}

/* A material's assignment that names an option of the law is a choice, not a parameter value. */
static int take_choices(deck_material *m, const law *l, law_choice *choices) {
  int count = 0, kept = 0;
  for (int k = 0; k < m->assignment_count; k++) {
    const deck_assignment *a = &m->assignments[k];
    const char *option = NULL;
    for (int q = 0; l && q < l->options.count; q++)
      if (strcasecmp(l->options.items[q]->name, a->name) == 0)
        option = l->options.items[q]->name;
    if (option && a->word)
      choices[count++] = (law_choice){option, a->word};
    else
      m->assignments[kept++] = *a;
  }
  m->assignment_count = kept;
  return count;
}

/* Opens the law of one material; a second time with the deck's choices when it has options. */
bool run_open_material(deck_material *m, const char *deck_path, model *out, diagnostics *said) {
  char *path = model_find(m->model, deck_path);
  if (!path) {
    diag_report(said, DIAG_FILE, deck_where(&m->item, "model"), "there is no model `%s`", m->model);
    diag_hint(said, "give a path ending in .plm, or put the file beside the deck or in a folder "
                    "`models`; PERILAT_MODELS may name another folder");
    return false;
  }
  bool good = model_open(out, path, NULL, 0);
  if (good && out->law->options.count > 0) {
    law_choice *choices = must_calloc((size_t)m->assignment_count + 1, sizeof *choices);
    int count = take_choices(m, out->law, choices);
    if (count) {
      model_close(out);
      good = model_open(out, path, choices, count);
    }
    free(choices);
  }
  good = good && model_plan(out);
  diag_print(&out->said, stderr);
  free(path);
  return good;
}

static const built_in_law *find_built_in(const run_options *o, const char *model_name) {
  for (int k = 0; k < o->law_count; k++)
    if (strcmp(o->laws[k].model, model_name) == 0)
      return &o->laws[k];
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
      diag_report(&r->said, DIAG_OPTION, a->value_where,
                  "this solver was built with `%s` = '%.*s'", a->name, (int)n, at + strlen(pair));
      diag_hint(&r->said, "build another solver with `perilat build`, or use `perilat run`");
      good = false;
    }
  }
  m->assignment_count = kept;
  return good;
}

static deck_material *material_of(run *r, int lattice) {
  for (int k = 0; k < r->deck->material_count; k++)
    if (strcmp(r->deck->materials[k].lattice, r->deck->lattices[lattice].name) == 0)
      return &r->deck->materials[k];
  return NULL;
}

/* 0, or an exit status. */
static int load_law(run *r, int lattice) {
  deck_material *m = material_of(r, lattice);
  const built_in_law *b = r->options->laws ? find_built_in(r->options, m->model) : NULL;
  if (r->options->laws) {
    if (!b) {
      diag_report(&r->said, DIAG_FILE, deck_where(&m->item, "model"),
                  "this solver was built without the model `%s`", m->model);
      return INPUT_WRONG;
    }
    if (!drop_built_in_choices(r, m, b))
      return INPUT_WRONG;
    r->laws[lattice].law = b->law;
    r->built_in[lattice] = b;
  } else {
    model *opened = &r->models[r->open_models];
    bool good = run_open_material(m, r->options->deck_path, opened, &r->said);
    r->open_models += opened->memory != NULL;
    if (!good)
      return INPUT_WRONG;
    char error[4 * ERROR_LENGTH];
    const char *note;
    r->laws[lattice].law =
        model_kernel(opened, r->options->interpret || r->options->check_only, &note, error, sizeof error);
    if (note)
      fprintf(stderr, "perilat: warning: %s\n", note);
    if (!r->laws[lattice].law) {
      fprintf(stderr, "perilat: error: %s\n", error);
      return RUN_FAILED;
    }
  }
  const pl_law *kernel = r->laws[lattice].law;
  r->laws[lattice].parameters = must_calloc((size_t)kernel->parameter_count + 1, sizeof(double));
  return material_parameters(m, kernel, r->laws[lattice].parameters, &r->said) ? 0 : INPUT_WRONG;
}

/* Deck, laws, simulation. All errors of the deck's materials are reported before it gives up. */
static int set_up(run *r) {
  if (!load_deck(r))
    return INPUT_WRONG;
  size_t lattices = (size_t)r->deck->lattice_count;
  r->models = must_calloc((size_t)r->deck->material_count + 1, sizeof *r->models);
  r->laws = must_calloc(lattices, sizeof *r->laws);
  r->built_in = must_calloc(lattices, sizeof *r->built_in);
  int status = 0;
  for (int k = 0; k < r->deck->lattice_count; k++) {
    int s = load_law(r, k);
    status = s ? s : status;
  }
  if (status)
    return status;
  if (r->options->threads > 0)
    r->deck->simulation.threads = r->options->threads;
  choose_paths(r);
  fingerprint(r);
  r->simulation = simulation_new(r->deck, r->laws, &r->said);
  return r->simulation ? 0 : INPUT_WRONG;
}

static void let_go(run *r) {
  if (r->result)
    result_close(r->result);
  if (r->simulation)
    simulation_free(r->simulation);
  for (int k = 0; r->laws && k < r->deck->lattice_count; k++)
    free(r->laws[k].parameters);
  for (int k = 0; k < r->open_models; k++)
    model_close(&r->models[k]);
  free(r->frame_buffer);
  free(r->laws);
  free(r->built_in);
  free(r->models);
  diag_clear(&r->said);
  source_clear(&r->sources);
  arena_free(r->memory);
}

/* --- before the run ----------------------------------------------------------------------------- */

static void print_quantity(const char *text, double value, const char *unit_name) {
  static const struct {
    double factor;
    const char *prefix;
  } scales[] = {{1e9, "G"}, {1e6, "M"}, {1e3, "k"}, {1, ""}, {1e-3, "m"}, {1e-6, "u"}, {1e-9, "n"}};
  size_t k = 0;
  while (k < 6 && fabs(value) < scales[k].factor)
    k++;
  printf("%s%.4g %s%s", text, value / scales[k].factor, scales[k].prefix, unit_name);
}

static void announce_law(const run *r, int lattice) {
  const rows *w = simulation_rows(r->simulation, lattice);
  const pl_law *kernel = r->laws[lattice].law;
  implied_elasticity e;
  printf("  law        %s", kernel->name);
  if (implied_elastic(kernel, r->laws[lattice].parameters, w, &e)) {
    print_quantity(": on this lattice E = ", e.E[0], "Pa");
    printf(", nu = %.4f", e.nu[0]);
    double strength = implied_strength(kernel, r->laws[lattice].parameters, w, 0, NULL);
    print_quantity(", strength along x ", strength, "Pa (uniform strain)");
  }
  putchar('\n');
}

static void announce_lattice(const run *r, int lattice) {
  const rows *w = simulation_rows(r->simulation, lattice);
  const deck_lattice *k = &r->deck->lattices[lattice];
  printf("  lattice    %s: %s, spacing %.6g mm, %ld particles, %ld bonds, %.5g x %.5g mm between outermost sites\n",
         k->name, k->kind, 1e3 * w->spacing, w->particle_count, w->bond_count, 1e3 * w->width,
         1e3 * w->height);
}

static void announce(const run *r) {
  const deck_simulation *s = &r->deck->simulation;
  const step_limit *limit = simulation_step_limit(r->simulation);
  printf("%s\n", s->title ? s->title : r->options->deck_path);
  for (int k = 0; k < r->deck->lattice_count; k++) {
    announce_lattice(r, k);
    announce_law(r, k);
  }
  printf("  time       %.6g ms in %ld steps of %.4g us: %.3g of the stable step %.4g us (%s mode rules)\n",
         1e3 * s->end_time, simulation_step_count(r->simulation), 1e6 * limit->step,
         limit->step / limit->limit, 1e6 * limit->limit, limit->mode);
  printf("  machine    %d thread%s, %.1f MiB\n", simulation_threads(r->simulation),
         simulation_threads(r->simulation) == 1 ? "" : "s",
         simulation_memory(r->simulation) / 1048576.0);
  printf("  result     %s\n", r->result_path);
  fflush(stdout);
}

/* --- result ------------------------------------------------------------------------------------- */

static result_text *collect_texts(run *r, bool c_text, int *count) {
  *count = r->deck->lattice_count;
  result_text *texts = arena_alloc(r->memory, (size_t)*count * sizeof *texts);
  int opened = 0;
  for (int k = 0; k < *count; k++) {
    const built_in_law *b = r->built_in[k];
    const model *m = b ? NULL : &r->models[opened++];
    texts[k].name = r->laws[k].law->name;
    if (b)
      texts[k].text = c_text ? b->c_text : b->law_text;
    else
      texts[k].text = c_text ? m->c_text : m->sources.items[0].text;
  }
  return texts;
}

static void particle_table(run *r, const rows *w, result_header *h) {
  size_t n = (size_t)w->particle_count;
  double *reference = arena_alloc(r->memory, 2 * n * sizeof *reference);
  double *volume = arena_alloc(r->memory, n * sizeof *volume);
  int32_t *body = arena_alloc(r->memory, n * sizeof *body);
  for (size_t p = 0; p < n; p++) {
    reference[2 * p] = w->x[w->particle_site[p]];
    reference[2 * p + 1] = w->y[w->particle_site[p]];
    volume[p] = w->volume;
  }
  h->particle_count = w->particle_count;
  h->reference = reference;
  h->volume = volume;
  h->body = body;
  rows_bond *bonds = rows_bonds(w);
  int32_t *pairs = arena_alloc(r->memory, 2 * (size_t)w->bond_count * sizeof *pairs);
  for (long m = 0; m < w->bond_count; m++) {
    pairs[2 * m] = bonds[m].i;
    pairs[2 * m + 1] = bonds[m].j;
  }
  free(bonds);
  h->bond_count = w->bond_count;
  h->bonds = pairs;
}

/* Fields of the frames, as the simulation offers them. */
static void frame_table(run *r, result_header *h, const char *interaction) {
  const frame_field *offered;
  h->field_count = simulation_frame_fields(r->simulation, &offered);
  result_field *fields = arena_alloc(r->memory, (size_t)h->field_count * sizeof *fields);
  for (int k = 0; k < h->field_count; k++)
    fields[k] = (result_field){offered[k].name, offered[k].unit,
                               offered[k].on_bonds ? interaction : NULL, offered[k].components,
                               offered[k].on_bonds ? h->bond_count : h->particle_count};
  h->fields = fields;
}

static bool open_result(run *r, long resume_frames) {
  result_header h = {.path = r->result_path,
                     .title = r->deck->simulation.title ? r->deck->simulation.title : "",
                     .started = r->started,
                     .version = perilat_version,
                     .kernel_key = r->laws[0].law->key,
                     .deck_text = r->sources.items[0].text,
                     .interaction = r->deck->lattices[0].name};
  h.models = collect_texts(r, false, &h.model_count);
  h.kernels = collect_texts(r, true, &h.kernel_count);
  particle_table(r, simulation_rows(r->simulation, 0), &h);
  frame_table(r, &h, h.interaction);
  char error[ERROR_LENGTH];
  r->result = result_open(&h, resume_frames, error, sizeof error);
  if (!r->result)
    fprintf(stderr, "perilat: error: %s\n", error);
  size_t total = 0;
  for (int k = 0; k < h.field_count; k++)
    total += (size_t)(h.fields[k].count * h.fields[k].components);
  r->frame_buffer = must_alloc((total + 1) * sizeof(double));
  return r->result != NULL;
}

static bool write_frame(run *r) {
  const frame_field *fields;
  int count = simulation_frame_fields(r->simulation, &fields);
  const rows *w = simulation_rows(r->simulation, 0);
  const double **values = must_alloc((size_t)(count + 1) * sizeof *values);
  double *at = r->frame_buffer;
  for (int k = 0; k < count; k++) {
    values[k] = at;
    simulation_frame_values(r->simulation, k, at);
    at += (fields[k].on_bonds ? w->bond_count : w->particle_count) * fields[k].components;
  }
  char error[ERROR_LENGTH];
  bool good = result_frame(r->result, simulation_time(r->simulation), values, error, sizeof error);
  free(values);
  if (!good)
    fprintf(stderr, "perilat: error: %s\n", error);
  simulation_frame_taken(r->simulation);
  return good;
}

static bool write_checkpoint(run *r) {
  char error[ERROR_LENGTH];
  bool good = result_sync(r->result, error, sizeof error) &&
              simulation_save(r->simulation, r->checkpoint_path, r->fingerprint,
                              result_frame_count(r->result), error, sizeof error);
  if (!good)
    fprintf(stderr, "perilat: error: no checkpoint was written: %s\n", error);
  return good;
}

static bool finish_result(run *r, bool keep_working) {
  int count = simulation_series_count(r->simulation);
  result_series *series = arena_alloc(r->memory, (size_t)count * sizeof *series);
  for (int k = 0; k < count; k++)
    series[k].name = simulation_series(r->simulation, k, &series[k].unit, &series[k].values);
  const double *time;
  long samples = simulation_history(r->simulation, &time);
  char error[ERROR_LENGTH];
  bool good = result_finish(r->result, simulation_step_limit(r->simulation)->step,
                            simulation_step_done(r->simulation), time, samples, series, count,
                            keep_working, error, sizeof error);
  if (!good)
    fprintf(stderr, "perilat: error: %s\n", error);
  return good;
}

/* --- during and after --------------------------------------------------------------------------- */

/* "load 3100 N (peak 11020 N), cmod 1.2e-5 m": monitors at the last sample. */
static void describe_monitors(const run *r, char *text, size_t size) {
  const double *time;
  long samples = simulation_history(r->simulation, &time);
  int n = snprintf(text, size, "t = %.4g ms", 1e3 * simulation_time(r->simulation));
  for (int k = 0; samples > 0 && k < r->deck->monitor_count && k < 2 && n > 0 && (size_t)n < size; k++) {
    const char *unit_name;
    const double *values;
    const char *name = simulation_series(r->simulation, k, &unit_name, &values);
    n += snprintf(text + n, size - (size_t)n, ", %s %.4g %s", name, values[samples - 1], unit_name);
    if (k == 0 && (size_t)n < size)
      n += snprintf(text + n, size - (size_t)n, " (peak %.4g)",
                    simulation_monitor_peak(r->simulation, k, NULL));
  }
}

static void report_bad(const run *r) {
  bad_state b = simulation_bad(r->simulation);
  fprintf(stderr, "perilat: error: %s in step %ld (t = %.6g ms) at particle %ld (%.6g, %.6g mm)\n",
          b.what, b.step, 1e3 * b.time, b.particle, 1e3 * b.x, 1e3 * b.y);
  if (b.bond_particle >= 0) {
    fprintf(stderr,
            "  bond to particle %ld: stretch %.6g, stretch rate %.6g 1/s, end rotations %.6g and %.6g\n",
            b.bond_particle, b.stretch, b.stretch_rate, b.theta_i, b.theta_j);
    if (r->open_models > 0)
      kernel_check_explain_bad(r->models[0].plan, r->laws[0].parameters, simulation_rows(r->simulation, 0), &b, stderr);
  }
  fprintf(stderr, "  what was computed until then is in the result; a smaller `step_safety` or a law that "
                  "stays finite there mends it\n");
}

static double last_value(const run *r, const char *name) {
  const double *time;
  long samples = simulation_history(r->simulation, &time);
  for (int k = 0; k < simulation_series_count(r->simulation); k++) {
    const char *unit_name;
    const double *values;
    if (strcmp(simulation_series(r->simulation, k, &unit_name, &values), name) == 0 && samples > 0)
      return values[samples - 1];
  }
  return NAN;
}

static void conclude(const run *r, double seconds, long steps) {
  const rows *w = simulation_rows(r->simulation, 0);
  printf("%ld steps in %.2f s: %.0f steps/s, %.1f million bond updates/s\n", steps, seconds,
         (double)steps / seconds, 1e-6 * (double)steps * (double)w->bond_count / seconds);
  for (int k = 0; k < r->deck->monitor_count; k++) {
    const char *unit_name;
    const double *values;
    const char *name = simulation_series(r->simulation, k, &unit_name, &values);
    double when = 0, peak = simulation_monitor_peak(r->simulation, k, &when);
    printf("  %-10s largest %.6g %s at t = %.5g ms\n", name, peak, unit_name, 1e3 * when);
  }
  double external = last_value(r, "energy/external"), imbalance = last_value(r, "energy/imbalance");
  if (isfinite(external))
    printf("  energy     external work %.5g J: kinetic %.3g, stored %.3g, dissipated by damage %.5g, by damping %.3g; "
           "imbalance %.2g J (%.2g %%)\n",
           external, last_value(r, "energy/kinetic"), last_value(r, "energy/stored"),
           last_value(r, "energy/dissipated_damage"), last_value(r, "energy/dissipated_damping"), imbalance,
           100 * fabs(imbalance / external));
  printf("  written    %s (%ld frames)\n", r->result_path, result_frame_count(r->result));
}

/* Time loop with frames and checkpoints. */
static step_status march(run *r, bool *written) {
  const long total = simulation_step_count(r->simulation);
  progress bar;
  progress_begin(&bar, (double)simulation_step_done(r->simulation) / (double)total);
  double last_checkpoint = monotonic_seconds();
  step_status status = STEP_OK;
  *written = true;
  while (status == STEP_OK && !interrupted && *written) {
    if (simulation_frame_due(r->simulation))
      *written = write_frame(r);
    status = simulation_advance(r->simulation, 1000, &interrupted);
    char detail[256];
    describe_monitors(r, detail, sizeof detail);
    progress_show(&bar, (double)simulation_step_done(r->simulation) / (double)total, detail);
    double interval = r->deck->checkpoint.interval;
    if (interval > 0 && status == STEP_OK && monotonic_seconds() - last_checkpoint > interval) {
      write_checkpoint(r);
      last_checkpoint = monotonic_seconds();
    }
  }
  if (*written && status != STEP_BAD && (status != STEP_OK || interrupted) &&
      (simulation_frame_due(r->simulation) || status != STEP_OK))
    *written = write_frame(r);
  progress_end(&bar);
  return status;
}

static int execute(run *r, long resume_frames) {
  if (!open_result(r, resume_frames))
    return RUN_FAILED;
  struct sigaction action = {.sa_handler = on_interrupt}, before;
  interrupted = 0;
  sigaction(SIGINT, &action, &before);
  long first = simulation_step_done(r->simulation);
  double begun = monotonic_seconds();
  bool written;
  step_status status = march(r, &written);
  double seconds = monotonic_seconds() - begun;
  sigaction(SIGINT, &before, NULL);
  bool stopped_by_user = interrupted && status == STEP_OK;
  if (stopped_by_user)
    write_checkpoint(r);
  if (status == STEP_BAD)
    report_bad(r);
  if (!finish_result(r, stopped_by_user) || !written)
    return RUN_FAILED;
  conclude(r, seconds, simulation_step_done(r->simulation) - first);
  if (stopped_by_user)
    printf("stopped at t = %.5g ms as asked; `--resume` goes on from here\n", 1e3 * simulation_time(r->simulation));
  else
    unlink(r->checkpoint_path);
  return status == STEP_BAD ? RUN_FAILED : 0;
}

static bool resume(run *r, long *frames) {
  char error[ERROR_LENGTH];
  if (simulation_restore(r->simulation, r->checkpoint_path, r->fingerprint, frames, error, sizeof error)) {
    printf("resumed at t = %.5g ms (step %ld)\n", 1e3 * simulation_time(r->simulation),
           simulation_step_done(r->simulation));
    return true;
  }
  fprintf(stderr, "perilat: error: cannot resume: %s\n", error);
  return false;
}

/* --check-kernel: random states through kernel and interpreter. */
static bool check_kernels(const run *r) {
  bool good = true;
  for (int k = 0; k < r->open_models && !r->options->interpret; k++)
    good = kernel_check_report(r->models[k].plan, r->laws[k].law, r->laws[k].parameters, 100000, stdout) && good;
  return good;
}

int run_deck(const run_options *o) {
  run r = {.options = o, .memory = arena_new()};
  diag_begin(&r.said, &r.sources);
  time_t now = time(NULL);
  struct tm utc;
  strftime(r.started, sizeof r.started, "%Y-%m-%dT%H:%M:%SZ", gmtime_r(&now, &utc));
  int status = set_up(&r);
  diag_print(&r.said, stderr);
  if (!status) {
    announce(&r);
    long frames = -1;
    if (!o->check_only) {
      if (o->check_kernel && !check_kernels(&r))
        status = RUN_FAILED;
      else if (o->resume && !resume(&r, &frames))
        status = INPUT_WRONG;
      else
        status = execute(&r, frames);
    }
  }
  let_go(&r);
  return status;
}
