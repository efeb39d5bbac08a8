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

#include "generator/explain_bad.h"
#include "generator/kernel_check.h"
#include "generator/model.h"
#include "generator/progress.h"
#include "generator/version.h"
#include "runtime/implied.h"
#include "runtime/result.h"
#include "runtime/simulation.h"

enum { INPUT_WRONG = 1, RUN_FAILED = 2, ERROR_LENGTH = 1024 };
#define DECK_LIMIT ((size_t)16 << 20)

/* --- signals ------------------------------------------------------------------------------------ */

static volatile sig_atomic_t interrupted;
static void on_interrupt(int signal_number) {
  (void)signal_number;
  interrupted = 1;
}

/* Ctrl-C, the end of a batch job, a closed terminal: all stop at a step and write what there is. */
static const int stopping_signals[] = {SIGINT, SIGTERM, SIGHUP};
enum { STOPPING_SIGNALS = sizeof stopping_signals / sizeof *stopping_signals };

static void catch_signals(struct sigaction before[STOPPING_SIGNALS]) {
  interrupted = 0;
  for (int k = 0; k < STOPPING_SIGNALS; k++) {
    struct sigaction action = {.sa_handler = on_interrupt, .sa_flags = SA_RESTART};
    sigaction(stopping_signals[k], NULL, &before[k]);
    if (before[k].sa_handler != SIG_IGN) /* as nohup wants it */
      sigaction(stopping_signals[k], &action, NULL);
  }
}

static void release_signals(const struct sigaction before[STOPPING_SIGNALS]) {
  for (int k = 0; k < STOPPING_SIGNALS; k++)
    sigaction(stopping_signals[k], &before[k], NULL);
}

/* --- the run ------------------------------------------------------------------------------------ */

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
  char *target = realpath(path, NULL); /* through links, so that the data lie where the user has put them */
  const char *chosen = target ? target : path;
  struct stat about;
  if (lstat(path, &about) != 0 || !S_ISLNK(about.st_mode))
    chosen = path;
  r->result_path = arena_text(r->memory, chosen, strlen(chosen));
  free(target);
  r->checkpoint_path = arena_printf(r->memory, "%s.checkpoint", path);
}

/* Hours of computing must not end in a path that cannot be written. */
static bool result_can_be_written(run *r) {
  const span where = deck_where(&r->deck->output.item, "result");
  struct stat about;
  char folder[4096];
  const char *slash = strrchr(r->result_path, '/');
  snprintf(folder, sizeof folder, "%.*s", slash ? (int)(slash - r->result_path) + 1 : 1, slash ? r->result_path : ".");
  bool exists = stat(r->result_path, &about) == 0;
  if (exists && !S_ISREG(about.st_mode))
    diag_report(&r->said, DIAG_FILE, where, "the result `%s` is %s", r->result_path,
                S_ISDIR(about.st_mode) ? "a folder" : "not an ordinary file");
  else if (exists && !(about.st_mode & 0222))
    diag_report(&r->said, DIAG_FILE, where, "the result `%s` is protected against writing", r->result_path);
  else if (access(folder, W_OK | X_OK) != 0)
    diag_report(&r->said, DIAG_FILE, where, "cannot write the result into the folder `%s`: %s", folder, strerror(errno));
  else
    return true;
  diag_hint(&r->said, "give `result` another path in &output, or --set output.result=PATH");
  return false;
}

static bool result_spares(run *r, const char *input) {
  if (!same_file(r->result_path, input))
    return true;
  diag_report(&r->said, DIAG_FILE, deck_where(&r->deck->output.item, "result"), "the result would overwrite `%s`", input);
  diag_hint(&r->said, "give `result` another name in &output");
  return false;
}

static bool result_spares_inputs(run *r) {
  bool good = r->options->deck_text || result_spares(r, r->options->deck_path);
  for (int k = 0; k < r->open_models; k++)
    for (int f = 0; f < r->models[k].sources.count; f++)
      good = good && result_spares(r, r->models[k].sources.items[f].name);
  return good;
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

/* --- diagnostics -------------------------------------------------------------------------------- */

static void tell(const run *r, const diagnostics *d) {
  if (r->options->report)
    diag_json_add(r->options->report, d);
  else
    diag_print(d, stderr);
}

/* --- setting up --------------------------------------------------------------------------------- */

static bool load_deck(run *r) {
  const run_options *o = r->options;
  char error[ERROR_LENGTH];
  size_t length = o->deck_text ? strlen(o->deck_text) : 0;
  char *text = o->deck_text ? strdup(o->deck_text)
                            : read_text_file(o->deck_path, DECK_LIMIT, &length, error, sizeof error);
  if (!text) {
    if (o->report)
      diag_report(&r->said, DIAG_FILE, (span){0, 0, UINT16_MAX}, "%s", error); /* has no line to show */
    else
      fprintf(stderr, "perilat: error: %s\n", error);
    return false;
  }
  int file = source_add(&r->sources, o->deck_path, text, length);
  free(text);
  r->deck = deck_read(r->memory, &r->sources, file, o->overrides, o->override_count, &r->said);
  return r->deck != NULL;
}

/* --- options of a law --------------------------------------------------------------------------- */

static const symbol *find_option(const law *l, const char *name) {
  for (int k = 0; k < l->options.count; k++)
    if (strcasecmp(l->options.items[k]->name, name) == 0)
      return l->options.items[k];
  return NULL;
}

/* The choice as the law writes it, or NULL with a diagnostic at the deck's line. */
static const char *find_choice(const symbol *option, const deck_assignment *a, diagnostics *said) {
  const stmt *declared = option->declared;
  for (int w = 0; a->word && w < declared->word_count; w++)
    if (strcmp(declared->words[w], a->word) == 0)
      return declared->words[w];
  char words[256] = "";
  for (int w = 0; w < declared->word_count; w++) {
    size_t used = strlen(words);
    snprintf(words + used, sizeof words - used, "%s'%s'", w ? ", " : "", declared->words[w]);
  }
  if (a->word)
    diag_report(said, DIAG_OPTION, a->value_where, "the option `%s` has no choice `%s`", option->name, a->word);
  else
    diag_report(said, DIAG_OPTION, a->value_where, "the option `%s` takes a word", option->name);
  diag_hint(said, "the choices are %s", words);
  return NULL;
}

/* A material's assignment that names an option of the law is a choice, not a parameter value. The choices' texts are
   copies: they outlive the law. */
static bool take_choices(deck_material *m, const law *l, law_choice *choices, int *count, diagnostics *said) {
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
    if (choice)
      choices[(*count)++] = (law_choice){strdup(option->name), strdup(choice)};
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

bool run_open_material(deck_material *m, const char *deck_path, model *out, diagnostics *said) {
  char *path = model_find(m->model, deck_path);
  if (!path) {
    diag_report(said, DIAG_FILE, deck_where(&m->item, "model"), "there is no model `%s`", m->model);
    diag_hint(said, "give a path ending in .plm, or put the file beside the deck or in a folder "
                    "`models`; PERILAT_MODELS may name another folder");
    return false;
  }
  bool good = model_open(out, path, NULL, 0);
  if (good && out->law->options.count > 0)
    good = apply_choices(m, path, out, said);
  good = good && model_plan(out);
  free(path);
  return good;
}

/* --- laws --------------------------------------------------------------------------------------- */

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

/* Kernels are compiled for plane stress only. */
static bool setting_is_supported(run *r, const deck_lattice *l) {
  if (strcmp(l->setting, "plane_stress") == 0)
    return true;
  diag_report(&r->said, DIAG_NOT_SUPPORTED, deck_where(&l->item, "setting"),
              "laws cannot be compiled for plane strain yet");
  diag_hint(&r->said, "write setting = 'plane_stress', or leave it out");
  return false;
}

/* 0, or an exit status. */
static int load_law(run *r, int lattice) {
  deck_material *m = material_of(r, lattice);
  if (!setting_is_supported(r, &r->deck->lattices[lattice]))
    return INPUT_WRONG;
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
    if (opened->memory)
      tell(r, &opened->said);
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

/* What the language of decks allows and a run cannot do yet. */
static bool is_supported(run *r) {
  if (r->deck->lattice_count < 2)
    return true;
  diag_report(&r->said, DIAG_NOT_SUPPORTED, r->deck->lattices[1].item.where,
              "a run can have one lattice, this is the second");
  return false;
}

/* Deck, laws, simulation. All errors of the deck's materials are reported before it gives up. */
static int set_up(run *r) {
  if (!load_deck(r) || !is_supported(r))
    return INPUT_WRONG;
  choose_paths(r);
  if (!r->options->check_only && !result_can_be_written(r))
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
  if (!result_spares_inputs(r))
    return INPUT_WRONG;
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
      explain_bad(r->models[0].plan, r->laws[0].parameters, simulation_rows(r->simulation, 0), &b, stderr);
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

static void conclude_energy(const run *r) {
  double external = last_value(r, "energy/external"), imbalance = last_value(r, "energy/imbalance");
  if (!isfinite(external))
    return;
  printf("  energy     external work %.5g J: kinetic %.3g, stored %.3g, dissipated by damage %.5g, by damping %.3g; "
         "imbalance %.2g J",
         external, last_value(r, "energy/kinetic"), last_value(r, "energy/stored"),
         last_value(r, "energy/dissipated_damage"), last_value(r, "energy/dissipated_damping"), imbalance);
  if (fabs(external) > 0)
    printf(" (%.2g %%)", 100 * fabs(imbalance / external));
  putchar('\n');
}

static void conclude(const run *r, double seconds, long steps) {
  const rows *w = simulation_rows(r->simulation, 0);
  double rate = (double)steps / fmax(seconds, 1e-9);
  printf("%ld steps in %.2f s: %.0f steps/s, %.1f million bond updates/s\n", steps, seconds, rate,
         1e-6 * rate * (double)w->bond_count);
  for (int k = 0; k < r->deck->monitor_count; k++) {
    const char *unit_name;
    const double *values;
    const char *name = simulation_series(r->simulation, k, &unit_name, &values);
    double when = 0, peak = simulation_monitor_peak(r->simulation, k, &when);
    bool pure = strcmp(unit_name, "1") == 0;
    printf("  %-10s largest %.6g%s%s at t = %.5g ms\n", name, peak, pure ? "" : " ", pure ? "" : unit_name, 1e3 * when);
  }
  conclude_energy(r);
  long frames = result_frame_count(r->result);
  printf("  written    %s (%ld frame%s) and its .xdmf for ParaView\n", r->result_path, frames, frames == 1 ? "" : "s");
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
  if (*written && status != STEP_BAD && simulation_frame_due(r->simulation))
    *written = write_frame(r);
  progress_end(&bar);
  if (interrupted && status == STEP_OK)
    fputs("stopping: the result so far and a checkpoint are being written\n", stderr);
  return status;
}

/* What could not be written: what there is stays for --resume when a checkpoint can be written, and goes otherwise. */
static void give_up_writing(run *r, step_status status) {
  if (status != STEP_BAD && write_checkpoint(r))
    fprintf(stderr, "  the run is kept in its checkpoint: make room, then go on with --resume\n");
  else
    result_discard(r->result);
}

static int execute(run *r, long resume_frames) {
  if (!open_result(r, resume_frames))
    return resume_frames >= 0 ? INPUT_WRONG : RUN_FAILED;
  struct sigaction before[STOPPING_SIGNALS];
  catch_signals(before);
  long first = simulation_step_done(r->simulation);
  double begun = monotonic_seconds();
  bool written;
  step_status status = march(r, &written);
  double seconds = monotonic_seconds() - begun;
  bool stopped_by_user = interrupted && status == STEP_OK;
  if (stopped_by_user && written)
    write_checkpoint(r);
  if (status == STEP_BAD)
    report_bad(r);
  written = written && finish_result(r, stopped_by_user);
  if (!written)
    give_up_writing(r, status);
  release_signals(before);
  if (!written)
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
  if (access(r->checkpoint_path, F_OK) != 0)
    fprintf(stderr, "perilat: error: cannot resume: there is no checkpoint `%s`\n"
                    "  a run leaves one when it is stopped or killed; run without --resume\n", r->checkpoint_path);
  else
    fprintf(stderr, "perilat: error: cannot resume: %s\n", error);
  return false;
}

static void warn_of_checkpoint(const run *r) {
  if (access(r->checkpoint_path, F_OK) == 0)
    fprintf(stderr, "perilat: warning: this run starts anew; `%s` of an earlier one is given up (--resume goes on from it)\n",
            r->checkpoint_path);
}

/* --check-kernel: every compiled kernel against the interpreter, with the deck's parameters. */
static bool check_kernels(const run *r) {
  enum { STATES = 100000 };
  bool good = true;
  for (int k = 0; k < r->deck->lattice_count; k++) {
    const simulation_law *l = &r->laws[k];
    if (k >= r->open_models || l->law->context) {
      printf("kernel check: nothing to compare %s with: %s\n", l->law->name,
             l->law->context ? "it runs on the interpreter" : "a stand-alone solver has no interpreter");
      continue;
    }
    pl_bond_class bonds = rows_bond_class(simulation_rows(r->simulation, k), 0);
    const double *parameters = l->parameters;
    kernel_check c = kernel_check_run(r->models[k].plan, l->law, &parameters, 1, &bonds, STATES, 1);
    kernel_check_report(&c, l->law->name, kernel_check_agrees(&c) ? stdout : stderr);
    fflush(stdout);
    good = good && kernel_check_agrees(&c);
  }
  return good;
}

static int start(run *r) {
  long frames = -1;
  if (r->options->check_kernel && !check_kernels(r))
    return RUN_FAILED;
  if (r->options->resume && !resume(r, &frames))
    return INPUT_WRONG;
  if (!r->options->resume)
    warn_of_checkpoint(r);
  return execute(r, frames);
}

int run_deck(const run_options *o) {
  run r = {.options = o, .memory = arena_new()};
  diag_begin(&r.said, &r.sources);
  time_t now = time(NULL);
  struct tm utc;
  strftime(r.started, sizeof r.started, "%Y-%m-%dT%H:%M:%SZ", gmtime_r(&now, &utc));
  int status = set_up(&r);
  tell(&r, &r.said);
  if (!status) {
    if (!o->report)
      announce(&r);
    status = o->check_only ? 0 : start(&r);
  }
  let_go(&r);
  return status;
}
