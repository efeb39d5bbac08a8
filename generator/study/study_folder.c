#include "generator/study/study_folder.h"

#include <errno.h>
#include <fcntl.h>
#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <time.h>
#include <unistd.h>

#include "generator/kernel/document.h"
#include "generator/kernel/model.h"
#include "generator/run/run.h"
#include "runtime/result/result_read.h"

struct kept_case {
  uint64_t identity;
  const char *name;
};

/* A study of ten thousand runs with long names stays below. */
#define LIST_LIMIT ((size_t)64 << 20)

/* --- the list --------------------------------------------------------------------------------- */

/* "0123456789abcdef NAME"; a line that was not written whole, or is none, is passed over. */
static void read_line(study_folder *f, arena *a, const char *line, size_t length) {
  enum { DIGITS = 16 };
  struct kept_case one;
  if (length < DIGITS + 2 || line[DIGITS] != ' ') return;
  one.name = arena_text(a, line + DIGITS + 1, length - DIGITS - 1);
  if (sscanf(line, "%16" SCNx64, &one.identity) != 1) return;
  f->kept = arena_room(a, f->kept, f->kept_count, sizeof *f->kept);
  f->kept[f->kept_count++] = one;
}

static bool read_list(study_folder *f, arena *a, const char *path) {
  char error[1024];
  size_t length;
  char *text = read_text_file(path, LIST_LIMIT, &length, error, sizeof error);
  if (!text) {
    say_error("%s", error);
    return false;
  }
  for (const char *line = text, *end; (end = strchr(line, '\n')); line = end + 1)
    read_line(f, a, line, (size_t)(end - line));
  const bool whole = length == 0 || text[length - 1] == '\n';
  free(text);
  if (whole || write(f->list, "\n", 1) == 1) return true; /* of half a line */
  say_error("cannot write into the folder `%s`: %s", f->path, strerror(errno));
  return false;
}

/* Runs of a study that was killed write their checkpoints and end. */
static bool lock(const study_folder *f) {
  enum { TRIES = 600, TELL_AT = 20 };
  for (int k = 0; k < TRIES; k++) {
    if (flock(f->list, LOCK_EX | LOCK_NB) == 0) return true;
    if (k == TELL_AT)
      fprintf(stderr, "waiting for another study, or runs of it, to end in `%s`\n", f->path);
    nanosleep(&(struct timespec){0, 50000000}, NULL);
  }
  say_error("another study is at work in the folder `%s`; let it end, or name this one with %s",
            f->path, f->namer);
  return false;
}

/* What stands there under a name that no study has used yet is somebody's. */
static bool is_free(const study_folder *f, arena *a, const char *list) {
  static const char *const endings[] = {".csv", ".h5", ".png"};
  if (access(list, F_OK) == 0) return true;
  for (size_t k = 0; k < sizeof endings / sizeof *endings; k++)
    if (access(arena_printf(a, "%s%s", f->path, endings[k]), F_OK) == 0) {
      say_error("the study would overwrite `%s%s`; name it with %s", f->path, endings[k], f->namer);
      return false;
    }
  return true;
}

bool study_folder_open(study_folder *f, study_request *r) {
  arena *a = r->memory;
  const char *path = study_name(r);
  *f = (study_folder){.path = path, .namer = r->grouped ? "`result`" : "-o", .list = -1};
  const char *list = arena_printf(a, "%s/cases.txt", path);
  if (!is_free(f, a, list)) return false;
  if (mkdir(path, 0777) != 0 && errno != EEXIST) {
    say_error("cannot make the folder `%s`: %s", path, strerror(errno));
    return false;
  }
  f->list = open(list, O_RDWR | O_CREAT | O_APPEND, 0666);
  if (f->list >= 0) return lock(f) && read_list(f, a, list);
  say_error("cannot write into the folder `%s`: %s", path, strerror(errno));
  return false;
}

/* Runs that are still at work keep the lock. */
void study_folder_close(study_folder *f) {
  if (f->list >= 0) close(f->list);
  f->list = -1;
}

/* --- cases ------------------------------------------------------------------------------------ */

void study_folder_look(study_case *c, int status) {
  char error[1024];
  result_file *f =
      access(c->result, F_OK) == 0 ? result_read(c->result, error, sizeof error) : NULL;
  c->state = STUDY_FAILED;
  c->status = status;
  if (!f) return;
  const double ended = result_read_number(f, "status");
  result_read_close(f);
  if (ended != 0 && ended != RUN_FAILED) return; /* stopped on its way */
  c->state = STUDY_DONE;
  c->status = (int)ended;
}

static const struct kept_case *find_kept(const study_folder *f, const char *name) {
  for (int k = f->kept_count - 1; k >= 0; k--)
    if (strcmp(f->kept[k].name, name) == 0) return &f->kept[k];
  return NULL;
}

static int clash(const study_folder *f, const char *what) {
  say_error("`%s` holds %s of another deck, law or setting than this study's\n"
            "  name this one with %s, or move the folder away",
            f->path, what, f->namer);
  return INPUT_WRONG;
}

static bool keep(study_folder *f, arena *a, const study_case *c) {
  char line[1200];
  const off_t before = lseek(f->list, 0, SEEK_END);
  const int length = snprintf(line, sizeof line, "%016" PRIx64 " %s\n", c->identity, c->name);
  errno = 0;
  if (write(f->list, line, (size_t)length) != length) {
    say_error("cannot write into the folder `%s`: %s", f->path, strerror(errno ? errno : ENOSPC));
    if (before >= 0 && ftruncate(f->list, before) != 0) errno = 0; /* half a line is passed over */
    return false;
  }
  f->kept = arena_room(a, f->kept, f->kept_count, sizeof *f->kept);
  f->kept[f->kept_count++] = (struct kept_case){c->identity, c->name};
  return true;
}

int study_folder_take(study_folder *f, arena *a, study_case *cases, int count) {
  for (int k = 0; k < count; k++) {
    const struct kept_case *kept = find_kept(f, cases[k].name);
    if (kept && kept->identity != cases[k].identity)
      return clash(f, arena_printf(a, "a case `%s`", cases[k].name));
    if (!kept && access(cases[k].result, F_OK) == 0)
      return clash(f, arena_printf(a, "a result `%s.h5`", cases[k].name));
  }
  for (int k = 0; k < count; k++) {
    if (find_kept(f, cases[k].name)) {
      study_folder_look(&cases[k], 0);
      if (cases[k].state == STUDY_FAILED) cases[k].state = STUDY_WAITING;
    } else if (!keep(f, a, &cases[k]))
      return RUN_FAILED;
  }
  fsync(f->list);
  return 0;
}
