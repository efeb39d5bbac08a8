#include "generator/study/study_pool.h"

#include <errno.h>
#include <fcntl.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>

#include "generator/kernel/document.h"
#include "generator/run/progress.h"
#include "generator/run/run.h"
#include "generator/run/stopping.h"
#include "runtime/base/processors.h"
#include "runtime/result/checkpoint.h"

/* --- one run ---------------------------------------------------------------------------------- */

typedef struct job {
  pid_t child; /* 0: none */
  int of;      /* case */
} job;

typedef struct work {
  study_pool *pool;
  study_case *cases;
  int count, jobs, threads;
  study_case **order; /* [waiting] those that were not done, as they begin */
  int waiting;
  job *running;      /* [jobs] */
  double *fractions; /* [count] of the time of each run, which its process writes */
  bool cannot_start;
} work;

static int run_again(run_options *o, const study_case *c) {
  char checkpoint[4200];
  snprintf(checkpoint, sizeof checkpoint, "%s" CHECKPOINT_ENDING, c->result);
  o->resume = access(checkpoint, F_OK) == 0;
  const int status = run_deck(o);
  if (!o->resume || status != INPUT_WRONG) return status;
  o->resume = false; /* what it would go on from is damaged */
  return run_deck(o);
}

static void write_to_log(const study_case *c) {
  const int in = open("/dev/null", O_RDONLY);
  const int out = open(c->log, O_WRONLY | O_CREAT | O_TRUNC, 0666);
  if (in < 0 || out < 0 || dup2(in, 0) < 0 || dup2(out, 1) < 0 || dup2(out, 2) < 0)
    _exit(RUN_FAILED);
}

/* In the process of its own. */
static void run_case(const work *w, const study_case *c, double *fraction) {
  deck_override *overrides = must_calloc((size_t)c->setting_count + 1, sizeof *overrides);
  for (int k = 0; k < c->setting_count; k++)
    overrides[k].text = c->settings[k].text;
  char target[4200];
  snprintf(target, sizeof target, "output.result=%s", c->result);
  overrides[c->setting_count].text = target;
  write_to_log(c);
  run_options o = {.program = "perilat run",
                   .deck_path = c->deck,
                   .overrides = overrides,
                   .override_count = c->setting_count + 1,
                   .threads = w->threads,
                   .no_physics = w->pool->request->no_physics,
                   .fraction = fraction};
  const int status = run_again(&o, c);
  free(overrides);
  fflush(stdout);
  fflush(stderr);
  _exit(status);
}

static pid_t start(const work *w, int of, const stopping *signals) {
  fflush(NULL);
  sigset_t as_it_was;
  stopping_hold(&as_it_was); /* none comes before the run can take it */
  const pid_t parent = getpid(), child = fork();
  if (child == 0) {
    prctl(PR_SET_PDEATHSIG, SIGTERM);
    stopping_release(signals);
  }
  sigprocmask(SIG_SETMASK, &as_it_was, NULL);
  if (child != 0) return child;
  if (getppid() != parent) _exit(RUN_FAILED);
  run_case(w, &w->cases[of], &w->fractions[of]);
  return 0;
}

/* --- all of them ------------------------------------------------------------------------------ */

static int longest_first(const void *a, const void *b) {
  const study_case *const *x = a, *const *y = b;
  if ((*x)->cost != (*y)->cost) return (*x)->cost < (*y)->cost ? 1 : -1;
  return *x < *y ? -1 : *x > *y; /* as they stand in the table */
}

/* Else the longest, begun last, keeps one processor at work and the others waiting. */
static void put_in_order(work *w) {
  for (int k = 0; k < w->count; k++)
    if (w->cases[k].state == STUDY_WAITING) w->order[w->waiting++] = &w->cases[k];
  qsort(w->order, (size_t)w->waiting, sizeof *w->order, longest_first);
}

/* The next ones, where there is room. */
static void start_some(work *w, int *next, const stopping *signals) {
  for (int j = 0; j < w->jobs && *next < w->waiting && !stopping_signal; j++) {
    if (w->running[j].child) continue;
    const int of = (int)(w->order[*next] - w->cases);
    const pid_t child = start(w, of, signals);
    if (child < 0) {
      say_error("cannot start a run: %s", strerror(errno));
      w->cannot_start = true;
      return;
    }
    w->running[j] = (job){child, of};
    ++*next;
  }
}

/* Somebody else has taken how they ended. */
static void forget_all(work *w) {
  for (int j = 0; j < w->jobs; j++) {
    if (w->running[j].child) study_folder_look(&w->cases[w->running[j].of], RUN_FAILED);
    w->running[j].child = 0;
  }
}

/* One that has ended; false: none has. */
static bool collect(work *w) {
  int status;
  const pid_t child = waitpid(-1, &status, WNOHANG);
  if (child < 0 && errno == ECHILD) forget_all(w);
  if (child <= 0) return false;
  for (int j = 0; j < w->jobs; j++) {
    if (w->running[j].child != child) continue;
    const int of = w->running[j].of,
              code = WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
    w->running[j].child = 0;
    w->fractions[of] = 1;
    study_folder_look(&w->cases[of], code);
    if (stopping_signal && w->cases[of].state == STUDY_FAILED) w->cases[of].state = STUDY_WAITING;
  }
  return true;
}

static int running(const work *w) {
  int count = 0;
  for (int j = 0; j < w->jobs; j++)
    count += w->running[j].child > 0;
  return count;
}

/* Of all batches, as far as is known; a long run counts more than a short one. */
static int runs_of_all(const work *w) {
  const int least = w->pool->before + w->count;
  return w->pool->expected > least ? w->pool->expected : least;
}

static double fraction_done(work *w) {
  double sum = 0, total = 0;
  for (int k = 0; k < w->count; k++) {
    const double cost = w->cases[k].cost > 0 ? w->cases[k].cost : 1;
    sum += cost * (w->cases[k].state == STUDY_WAITING ? w->fractions[k] : 1);
    total += cost;
  }
  const double now = (w->pool->before + w->count * sum / total) / runs_of_all(w);
  if (now > w->pool->shown) w->pool->shown = now;
  return w->pool->shown;
}

static void show(work *w, progress *bar) {
  int done = w->pool->before, failed = 0;
  for (int k = 0; k < w->count; k++) {
    done += w->cases[k].state == STUDY_DONE;
    failed += w->cases[k].state == STUDY_FAILED;
  }
  char detail[200], without[40] = "";
  if (failed) snprintf(without, sizeof without, ", %d without a result", failed);
  snprintf(detail, sizeof detail, "%d of %s%d runs done%s, %d at work", done,
           w->pool->expected ? "at most " : "", runs_of_all(w), without, running(w));
  progress_show(bar, fraction_done(w), detail);
}

static void pass_on(const work *w, int signal_number) {
  for (int j = 0; j < w->jobs; j++)
    if (w->running[j].child) kill(w->running[j].child, signal_number);
}

static void go(work *w, const stopping *signals) {
  progress bar;
  int next = 0;
  bool told = false;
  progress_begin(&bar, fraction_done(w));
  do {
    if (!w->cannot_start) start_some(w, &next, signals);
    if (stopping_signal && !told) pass_on(w, stopping_signal);
    told = told || stopping_signal;
    while (collect(w))
      ;
    show(w, &bar);
    if (running(w)) nanosleep(&(struct timespec){0, 5000000}, NULL);
  } while (running(w) || (!stopping_signal && !w->cannot_start && next < w->waiting));
  progress_end(&bar);
}

int study_pool_jobs(const study_request *r, int count) {
  const int wanted = r->o.jobs ? r->o.jobs : usable_processors();
  return wanted < count ? wanted : count > 0 ? count : 1;
}

int study_pool_run(study_pool *p, study_case *cases, int count) {
  const int refused = study_folder_take(p->folder, p->request->memory, cases, count);
  if (refused) return -refused;
  work w = {.pool = p, .cases = cases, .count = count};
  w.order = arena_alloc(p->request->memory, ((size_t)count + 1) * sizeof *w.order);
  put_in_order(&w);
  if (w.waiting == 0) {
    p->before += count;
    return 0;
  }
  w.jobs = study_pool_jobs(p->request, w.waiting);
  const int threads = p->request->threads ? p->request->threads : usable_processors();
  w.threads = threads > w.jobs ? threads / w.jobs : 1;
  w.running = must_calloc((size_t)w.jobs, sizeof *w.running);
  const size_t bytes = (size_t)count * sizeof *w.fractions;
  w.fractions = mmap(NULL, bytes, PROT_READ | PROT_WRITE, MAP_SHARED | MAP_ANONYMOUS, -1, 0);
  int status = -RUN_FAILED;
  if (w.fractions == MAP_FAILED) {
    say_error("cannot start a run: %s", strerror(errno));
  } else {
    stopping signals;
    signal(SIGCHLD, SIG_DFL); /* else nobody is told how runs end */
    stopping_catch(&signals);
    go(&w, &signals);
    stopping_release(&signals);
    munmap(w.fractions, bytes);
    status = stopping_signal ? stopping_signal : w.cannot_start ? -RUN_FAILED : 0;
  }
  free(w.running);
  p->before += count;
  return status;
}
