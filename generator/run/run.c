#include "generator/run/run.h"

#include <errno.h>
#include <signal.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <time.h>
#include <unistd.h>

#include "generator/kernel/document.h"
#include "generator/kernel/kernel_check.h"
#include "generator/kernel/model.h"
#include "generator/report/moment.h"
#include "generator/report/report_bad.h"
#include "generator/report/report_begin.h"
#include "generator/report/report_end.h"
#include "generator/report/resuming.h"
#include "generator/report/run_document.h"
#include "generator/report/run_profile.h"
#include "generator/report/run_series.h"
#include "generator/report/run_state.h"
#include "generator/run/progress.h"
#include "generator/run/run_laws.h"
#include "generator/run/run_modes.h"
#include "generator/run/run_result.h"
#include "generator/run/stopping.h"
#include "runtime/base/clock.h"
#include "runtime/base/processors.h"
#include "runtime/deck/deck_read.h"
#include "runtime/filling/lattice.h"

enum { EARLY_CHECKPOINT = 30 }; /* s: the first one, so that a long run is never lost whole */

/* --- diagnostics ------------------------------------------------------------------------------ */

/* Prints diagnostics, or adds them to the report that the caller has asked for. */
static void tell(const run *r, const diagnostics *d) {
  const run_options *o = r->options;
  if (o->report) diag_json_add(o->report, d);
  if (!o->report || !o->check_only) diag_print(d, stderr);
}

/* --- setting up ------------------------------------------------------------------------------- */

static bool load_deck(run *r) {
  const run_options *o = r->options;
  char error[ERROR_LENGTH];
  size_t length = o->deck_text ? strlen(o->deck_text) : 0;
  char *text = o->deck_text
                   ? must_copy(o->deck_text)
                   : read_text_file(o->deck_path, DECK_LIMIT, &length, error, sizeof error);
  if (!text) {
    if (o->report)
      diag_report(&r->said, DIAG_FILE, (span){0, 0, UINT16_MAX}, "%s",
                  error); /* has no line to show */
    else
      say_error("%s", error);
    return false;
  }
  int file = source_add(&r->sources, o->deck_path, text, length);
  free(text);
  for (int k = 0; k < o->file_count; k++)
    source_add(&r->sources, o->files[k].path, o->files[k].text, strlen(o->files[k].text));
  r->deck = deck_read_what_is_right(r->memory, &r->sources, file, o->overrides, o->override_count,
                                    &r->said);
  return true;
}

/* Setting up does not take more threads than the run. */
static void keep_to_threads(run *r) {
  const int asked = r->options->threads > 0 ? r->options->threads : r->deck->simulation.threads;
  if (asked > 0) r->processors = processors_keep_to(asked);
}

/* The deck is as it was read, but for the threads that the command line asks for. */
static void take_threads(run *r) {
  if (r->options->threads < 1) return;
  deck *k = arena_alloc(r->memory, sizeof *k);
  *k = *r->deck;
  k->simulation.threads = r->options->threads;
  r->deck = k;
}

/* A solver's law was checked when it was built. A law that breaks mechanics has no step. */
static int check_physics(run *r, int interaction) {
  const int lattice = r->deck->interactions[interaction].lattice;
  simulation_law *l = &r->laws[interaction];
  const bool known = r->lattices[lattice] || !deck_lattice_is_listed(&r->deck->lattices[lattice]);
  if (r->options->laws || r->options->no_physics || !known || obeys_mechanics(r, interaction))
    return 0;
  free(l->parameters);
  l->parameters = NULL;
  return INPUT_WRONG;
}

/* The worst that has become of one. */
static int load_laws(run *r) {
  int status = 0;
  for (int k = 0; k < r->deck->interaction_count; k++) {
    int failed = load_law(r, k);
    if (!failed) failed = check_physics(r, k);
    status = failed > status ? failed : status;
  }
  for (int k = 0; k < r->deck->crack_count; k++) {
    const int failed = load_crack_law(r, k);
    status = failed > status ? failed : status;
  }
  for (int k = 0; k < r->deck->material_count; k++)
    if (deck_find_lattice(r->deck, r->deck->materials[k].lattice) < 0)
      check_law_alone(r, &r->deck->materials[k]);
  return status;
}

/* What is left of the deck may not say what they are. */
static void build_lattices(run *r) {
  const deck *k = r->deck;
  for (int n = 0; n < k->lattice_count && !deck_lacks(k, "body") && !deck_lacks(k, "notch"); n++)
    if (!deck_misses_body(k, n)) r->lattices[n] = lattice_build_next(k, n, r->lattices, &r->said);
}

/* All of them are known; else what there is goes. */
static bool has_lattices(run *r) {
  bool all = r->deck->lattice_count > 0;
  for (int n = 0; n < r->deck->lattice_count; n++)
    all = all && r->lattices[n];
  for (int n = 0; n < r->deck->lattice_count && !all; n++) {
    if (r->lattices[n]) rows_free(r->lattices[n]);
    r->lattices[n] = NULL;
  }
  return all;
}

/* Deck, laws, simulation. What is wrong is said at once, wherever it does not follow from what is
   wrong elsewhere. */
static int set_up(run *r) {
  if (!load_deck(r)) return INPUT_WRONG;
  const size_t lattices = (size_t)r->deck->lattice_count + 1, cracks = (size_t)r->deck->crack_count,
               laws = (size_t)run_law_count(r) + 1;
  r->models = must_calloc((size_t)r->deck->material_count + cracks + 1, sizeof *r->models);
  r->laws = must_calloc(laws, sizeof *r->laws);
  r->built_in = must_calloc(laws, sizeof *r->built_in);
  r->model_of = must_calloc(laws, sizeof *r->model_of);
  r->lattices = must_calloc(lattices, sizeof *r->lattices);
  keep_to_threads(r);
  choose_paths(r);
  const bool writes = !r->options->check_only || r->options->shapes;
  if (writes) result_can_be_written(r);
  build_lattices(r);
  const int status = load_laws(r);
  take_threads(r);
  result_spares_inputs(r);
  if (has_lattices(r)) r->simulation = simulation_new_on(r->lattices, r->deck, r->laws, &r->said);
  if (status) return status;
  if (!r->simulation) return INPUT_WRONG;
  if (writes) fingerprint(r);
  return 0;
}

/* Of laws, then of the deck. What is said is kept for the result. */
static void tell_all(run *r) {
  char *text = NULL;
  size_t length;
  FILE *kept = must_open_text(&text, &length);
  for (int k = 0; k <= r->open_models; k++) {
    const diagnostics *d = k < r->open_models ? &r->models[k].said : &r->said;
    tell(r, d);
    diag_print(d, kept);
  }
  must_close_text(kept);
  r->said_warnings = arena_text(r->memory, text, length);
  free(text);
}

/* The same of what is about to be done. */
static void announce_kept(run *r) {
  terminal_record said;
  terminal_record_begin(&said);
  announce(r);
  terminal_record_end(&said);
  r->said_begin = arena_text(r->memory, said.texts[0], said.lengths[0]);
  terminal_record_show(&said);
}

static void let_go(run *r) {
  if (r->processors > 0) processors_keep_to(r->processors);
  if (r->result) result_close(r->result);
  if (r->simulation) simulation_free(r->simulation);
  for (int k = 0; r->laws && k < run_law_count(r); k++)
    free_parameters(&r->laws[k]);
  for (int k = 0; k < r->open_models; k++)
    model_close(&r->models[k]);
  free(r->frame_buffer);
  free(r->laws);
  free(r->built_in);
  free(r->model_of);
  free(r->lattices);
  free(r->models);
  diag_clear(&r->said);
  source_clear(&r->sources);
  arena_free(r->memory);
}

/* --- the time loop ---------------------------------------------------------------------------- */

/* Steps between two looks at the clock: as many as take a few tenths of a second. */
static long next_stride(long stride, double seconds) {
  if (seconds < 0.1 && stride < 1L << 20) return 2 * stride;
  return seconds > 0.4 && stride > 1 ? stride / 2 : stride;
}

static bool write_timed(run *r, bool (*write)(run *)) {
  const double begun = monotonic_seconds();
  const bool good = write(r);
  r->profile.part[PROFILE_WRITING] += monotonic_seconds() - begun;
  return good;
}

/* Time loop with frames and checkpoints. */
static step_status march(run *r, bool *written) {
  progress bar;
  progress_begin(&bar, simulation_progress(r->simulation));
  double last_checkpoint = monotonic_seconds();
  bool first_checkpoint = true;
  long stride = 16;
  step_status status = STEP_OK;
  *written = true;
  while (status == STEP_OK && !stopping_signal) {
    if (simulation_frame_due(r->simulation) && !(*written = write_timed(r, write_frame))) break;
    double entered = monotonic_seconds();
    status = simulation_advance(r->simulation, stride, &stopping_signal);
    stride = next_stride(stride, monotonic_seconds() - entered);
    char detail[256];
    describe_monitors(r, detail, sizeof detail);
    progress_show(&bar, simulation_progress(r->simulation), detail);
    if (r->options->fraction) *r->options->fraction = simulation_progress(r->simulation);
    double interval = r->deck->checkpoint.interval;
    if (first_checkpoint && interval > EARLY_CHECKPOINT) interval = EARLY_CHECKPOINT;
    if (interval > 0 && status == STEP_OK && monotonic_seconds() - last_checkpoint > interval) {
      first_checkpoint = false;
      write_timed(r, write_checkpoint);
      last_checkpoint = monotonic_seconds();
    }
  }
  if (*written && status != STEP_BAD && simulation_frame_due(r->simulation))
    *written = write_timed(r, write_frame);
  progress_end(&bar);
  if (stopping_signal && status == STEP_OK)
    fputs("stopping: the result so far and a checkpoint are being written\n", stderr);
  return status;
}

/* What could not be written: what the last checkpoint needs stays. */
static void give_up_writing(run *r, step_status status) {
  char text[MOMENT_TEXT];
  if (status != STEP_BAD) write_checkpoint(r);
  if (can_go_on(r)) {
    fprintf(stderr,
            "  the run is kept in its checkpoint at %s: make room, then go on with --resume:\n",
            moment(r, r->kept_time, text));
    print_resume(r, stderr);
  } else if (!r->is_kept) {
    fputs("  nothing is kept of this run: it has no checkpoint to go on from (&checkpoint "
          "interval)\n",
          stderr);
    result_discard(r->result);
  }
}

/* A run that was asked to stop. Without its last checkpoint it has not stopped as it should. */
static int exit_status(step_status status, bool saved) {
  if (status == STEP_OK) return saved ? 128 + stopping_signal : RUN_FAILED;
  return status == STEP_BAD ? RUN_FAILED : 0;
}

static void print_stopped(const run *r, bool saved) {
  char now[MOMENT_TEXT], kept[MOMENT_TEXT];
  printf("stopped at %s as asked; ", moment(r, simulation_time(r->simulation), now));
  if (saved)
    puts("this goes on from here:");
  else if (r->is_kept)
    printf("its last checkpoint is that at %s, and this goes on from there:\n",
           moment(r, r->kept_time, kept));
  else
    puts("it has no checkpoint and cannot go on");
  if (r->is_kept) print_resume(r, stdout);
}

static const char *name_of_ending(int status, step_status last, bool interrupted_by_user) {
  if (status == RUN_FAILED) return "failed";
  if (interrupted_by_user) return "interrupted";
  return last == STEP_STOPPED ? "stopped" : "end";
}

static int execute(run *r) {
  stopping signals;
  stopping_catch(&signals);
  const long first = simulation_steps_taken(r->simulation);
  double begun = monotonic_seconds();
  bool written;
  if (r->options->profile) simulation_measure(r->simulation, &r->profile);
  step_status status = march(r, &written);
  const double seconds = r->wall = monotonic_seconds() - begun;
  const bool stopped_by_user = stopping_signal && status == STEP_OK;
  const bool saved = stopped_by_user && written && write_checkpoint(r);
  if (status == STEP_BAD) report_bad(r);
  const run_end end = {status, exit_status(status, saved), seconds};
  terminal_record said;
  terminal_record_begin(&said);
  conclude(r, seconds, simulation_steps_taken(r->simulation) - first);
  terminal_record_end(&said);
  written = written && finish_result(r, &end, &said);
  if (!written) give_up_writing(r, status);
  if (written && !(stopped_by_user && r->is_kept)) remove_remains(r);
  stopping_release(&signals);
  r->is_written = written;
  if (!written) {
    terminal_record_drop(&said);
    return RUN_FAILED;
  }
  terminal_record_show(&said);
  tell_result(r);
  if (!stopped_by_user) print_frames(r);
  if (status == STEP_STOPPED) print_stop(r);
  if (r->options->profile) print_profile(r, seconds, simulation_steps_taken(r->simulation) - first);
  if (stopped_by_user) print_stopped(r, saved);
  r->signal = stopped_by_user ? stopping_signal : 0;
  r->ending = name_of_ending(end.exit_status, status, stopped_by_user);
  return end.exit_status;
}

/* --check-kernel: every compiled kernel against the interpreter, with the deck's parameters. */
static bool check_kernels(const run *r) {
  enum { STATES = 100000 };
  bool good = true;
  for (int k = 0; k < run_law_count(r); k++) {
    const simulation_law *l = &r->laws[k];
    if (!l->law) continue; /* of a crack that does not grow */
    if (!r->model_of[k] || l->law->context) {
      printf("kernel check: nothing to compare %s with: %s\n", l->law->name,
             l->law->context ? "it runs on the interpreter"
                             : "a stand-alone solver has no interpreter");
      continue;
    }
    const pl_bond_class none = {.size = sizeof none};
    const double *values = l->parameters;
    if (l->law->kind == PL_CONTINUUM || l->law->kind == PL_CRACK) {
      kernel_check c =
          kernel_check_run(r->model_of[k]->plan, l->law, &values, 1, &none, 1, STATES, 1);
      kernel_check_report(&c, l->law->name);
      good = good && kernel_check_agrees(&c);
      continue;
    }
    const rows *w = simulation_law_rows(r->simulation, k);
    const int classes = l->law->kind == PL_STATE ? 2 * w->directions : 1;
    pl_bond_class bonds[ROWS_MAX_NEIGHBOURS];
    for (int n = 0; n < classes; n++)
      bonds[n] = rows_bond_class(w, n);
    const double *parameters = l->parameters;
    kernel_check c =
        kernel_check_run(r->model_of[k]->plan, l->law, &parameters, 1, bonds, classes, STATES, 1);
    kernel_check_report(&c, l->law->name);
    fflush(stdout);
    good = good && kernel_check_agrees(&c);
  }
  return good;
}

/* Before the frames are looked for, which would not be there either. */
static bool has_checkpoint(const run *r) {
  if (access(r->checkpoint_path, F_OK) == 0) return true;
  say_error("cannot resume: there is no checkpoint `%s`\n"
            "  a run leaves one when it is stopped, and writes one after %d s or the interval of "
            "&checkpoint, the shorter; run without --resume",
            r->checkpoint_path, EARLY_CHECKPOINT);
  return false;
}

static int start(run *r) {
  const bool resumes = r->options->resume;
  const int failed = resumes ? INPUT_WRONG : RUN_FAILED;
  if (r->options->check_kernel && !check_kernels(r)) return RUN_FAILED;
  if (resumes && !has_checkpoint(r)) return INPUT_WRONG;
  if (!open_result(r) || !(resumes ? resume(r) : begin_anew(r))) return failed;
  return execute(r);
}

int run_deck(const run_options *o) {
  run r = {.options = o, .memory = arena_new(), .ending = "failed"};
  diag_begin(&r.said, &r.sources);
  signal(SIGPIPE, SIG_IGN); /* a run outlives the program that reads what it says */
  time_t now = time(NULL);
  struct tm utc;
  strftime(r.started, sizeof r.started, "%Y-%m-%dT%H:%M:%SZ", gmtime_r(&now, &utc));
  int status = set_up(&r);
  tell_all(&r);
  if (!o->report && !status && !o->check_only)
    diag_print_topics(stderr); /* of these messages, not of the run's */
  if (o->report && (!o->check_only || o->modes)) diag_json_end(o->report, status == 0);
  if (!status) {
    if (!o->report || !o->check_only) announce_kept(&r);
    status = !o->check_only ? start(&r) : o->modes ? tell_modes(&r) : 0;
  }
  if (o->report && !o->check_only) put_run(o->report->document, &r);
  let_go(&r);
  return status;
}
