#define _GNU_SOURCE
#include "generator/grade/grade_child.h"

#include <dirent.h>
#include <errno.h>
#include <fcntl.h>
#include <ftw.h>
#include <poll.h>
#include <signal.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include "dsl/base/characters.h"
#include "generator/grade/judge_table.h"
#include "generator/kernel/document.h"
#include "runtime/base/clock.h"
#include "runtime/base/confined.h"
#include "runtime/base/processors.h"

enum {
  MOST_COPIED = 20, /* laws beside an answer */
  SPARE = 4,        /* the clock may run so many times the processor time, and a while longer */
  A_WHILE = 5,      /* s */
  MOST_ENTRIES = 64
};
static const char law_name[] = "answer.plm", table_name[] = "answers.txt";
#define MOST_SAID ((size_t)8 << 20) /* B, of records */

/* --- the folder ------------------------------------------------------------------------------- */

static bool write_text(const handed_text *t, const char *folder, const char *name) {
  char to[4096];
  snprintf(to, sizeof to, "%s/%s", folder, name);
  const int out = open(to, O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0600);
  if (out < 0) return false;
  const bool good = write(out, t->text, t->length) == (ssize_t)t->length;
  return close(out) == 0 && good;
}

/* Nothing is said of what can not be copied. */
static bool copy_law(const char *from, const char *folder, const char *name) {
  arena *a = arena_new();
  const handed_text t = handed_text_read(a, from);
  const bool good = !t.bad && write_text(&t, folder, name);
  arena_free(a);
  return good;
}

/* Further laws beside the answer, so that it may include them. */
static void copy_others(const handed_in *answer, const char *folder) {
  DIR *at = answer->folder ? opendir(answer->folder) : NULL;
  int copied = 0;
  for (struct dirent *e; at && copied < MOST_COPIED && (e = readdir(at));) {
    char from[4096];
    if (!text_ends_in(e->d_name, ".plm") || strcmp(e->d_name, law_name) == 0) continue;
    snprintf(from, sizeof from, "%s/%s", answer->folder, e->d_name);
    copied += copy_law(from, folder, e->d_name);
  }
  if (at) closedir(at);
}

static int remove_entry(const char *path, const struct stat *about, int kind, struct FTW *at) {
  (void)about, (void)kind, (void)at;
  return remove(path);
}

static bool make_folder(char *folder, size_t size) {
  const char *temporary = getenv("TMPDIR");
  snprintf(folder, size, "%s/perilat-grade-XXXXXX", temporary && *temporary ? temporary : "/tmp");
  if (mkdtemp(folder)) return true;
  say_error("there is no place for answers: %s: %s", folder, strerror(errno));
  return false;
}

/* --- the process ------------------------------------------------------------------------------ */

/* The deck of an exercise names the law that is marked as one beside it; another one may stand
   there, the teacher's or a student's own. */
static void hide_law_beside(const exercise *e) {
  char path[4096 + 16];
  snprintf(path, sizeof path, "%s/%s", e->folder, law_name);
  file_never_read(path);
}

static void be_child(const judge_request *q, const char *folder, const confinement *to, int pipe) {
  FILE *out = fdopen(pipe, "w");
  if (!out || !confine(folder, to) || !model_confine(q->answer, q->basis->of->folder)) _exit(3);
  hide_law_beside(q->basis->of);
  processors_keep_to(1); /* other answers have the others */
  if (q->basis->of->of_answers)
    judge_table(q, out);
  else
    judge_answer(q, out);
  fclose(out);
  _exit(0);
}

/* All that it says until it ends, or the clock comes to `end`; killed then. */
static char *listen(int from, pid_t child, double end, size_t *size, bool *late) {
  char *said = NULL;
  size_t room = 0;
  *size = 0;
  *late = false;
  for (;;) {
    const double left = end - monotonic_seconds();
    struct pollfd one = {.fd = from, .events = POLLIN};
    const int ready = poll(&one, 1, left > 0 ? (int)(1e3 * left) + 1 : 0);
    if (ready < 0 && errno == EINTR) continue;
    if (*size + 65536 > room) said = must_realloc(said, room = 2 * room + 65536);
    const ssize_t got = ready > 0 ? read(from, said + *size, 65536) : -1;
    if (got == 0) return said;
    *size += got > 0 ? (size_t)got : 0;
    *late = ready == 0;
    if (got > 0 && *size <= MOST_SAID) continue;
    kill(child, SIGKILL);
    return said;
  }
}

static const char *what_ended(arena *a, int status, bool late, const confinement *to) {
  const bool signalled = WIFSIGNALED(status);
  const int with = signalled ? WTERMSIG(status) : 0;
  if (late || with == SIGXCPU) return arena_printf(a, "it takes longer than %.3g s", to->seconds);
  if (with == SIGXFSZ) return "it writes too much";
  if (WIFEXITED(status) && WEXITSTATUS(status) == 2)
    return arena_printf(a, "it needs more than %.3g GB of memory", 1e-9 * (double)to->memory);
  return signalled ? arena_printf(a, "the program that reads it failed (%s)", strsignal(with))
                   : "the program that reads it failed";
}

/* False where there is no process to be had. */
static bool start(judging_child *c, const judge_request *q, const confinement *to) {
  int ends[2];
  fflush(NULL);
  if (pipe2(ends, O_CLOEXEC) != 0) return false;
  c->process = fork();
  if (c->process == 0) {
    close(ends[0]);
    be_child(q, c->folder, to, ends[1]);
  }
  close(ends[1]);
  if (c->process < 0)
    close(ends[0]);
  else
    c->from = ends[0];
  return c->process > 0;
}

bool grade_child_begin(judging_child *c, marks *m, const judge_request *q, const handed_in *answer,
                       const handed_text *text, const confinement *to) {
  judge_request here = *q;
  c->begun = monotonic_seconds();
  m->trouble = text->bad;
  if (m->trouble) return true;
  if (!make_folder(c->folder, sizeof c->folder)) {
    c->folder[0] = 0;
    return false;
  }
  here.shown = answer->file;
  here.answer = q->basis->of->of_answers ? table_name : law_name;
  if (!write_text(text, c->folder, here.answer)) m->trouble = "it can not be copied";
  if (m->trouble) return true;
  copy_others(answer, c->folder);
  if (start(c, &here, to)) return true;
  say_error("no process can be started: %s", strerror(errno));
  return false;
}

void grade_child_end(judging_child *c, const confinement *to) {
  int status = 0;
  bool late;
  size_t size;
  if (c->from >= 0) {
    const double end = c->begun + SPARE * to->seconds + A_WHILE;
    char *said = listen(c->from, c->process, end, &size, &late);
    close(c->from);
    while (waitpid(c->process, &status, 0) < 0 && errno == EINTR)
      continue;
    records_read(c->m, said, size);
    if (!c->m->ended) c->m->trouble = what_ended(c->m->memory, status, late, to);
    free(said);
  }
  if (c->folder[0]) nftw(c->folder, remove_entry, MOST_ENTRIES, FTW_DEPTH | FTW_PHYS);
  c->m->seconds = monotonic_seconds() - c->begun;
}
