#include "runtime/base/whole_file.h"

#include <dirent.h>
#include <errno.h>
#include <fcntl.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "runtime/base/confined.h"

static const char ending[] = ".part";

static bool is_direct(const whole_file *f) {
  return strcmp(f->target, f->working) == 0;
}

/* TARGET.process.number.part, the first that is not there. */
static bool make_working(whole_file *f) {
  enum { MOST = 1000 };
  for (int k = 0; k < MOST; k++) {
    snprintf(f->working, sizeof f->working, "%s.%ld.%d%s", f->target, (long)getpid(), k, ending);
    const int file = open(f->working, O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
    if (file >= 0) return close(file) == 0;
    if (errno != EEXIST) return false;
  }
  return false;
}

bool whole_file_begin(whole_file *f, const char *path) {
  struct stat about;
  if (!file_may_be_written(path)) {
    errno = EACCES;
    return false;
  }
  const bool exists = stat(path, &about) == 0, ordinary = !exists || S_ISREG(about.st_mode);
  char *target = exists && ordinary ? realpath(path, NULL) : NULL;
  const int length = snprintf(f->target, sizeof f->target, "%s", target ? target : path);
  free(target);
  if (length >= (int)sizeof f->target) {
    errno = ENAMETOOLONG;
    return false;
  }
  strcpy(f->working, f->target);
  if (exists && access(path, W_OK) != 0) return false;
  return !ordinary || make_working(f);
}

FILE *whole_file_open(whole_file *f, const char *path) {
  FILE *out = NULL;
  if (whole_file_begin(f, path) && !(out = fopen(f->working, "wb"))) whole_file_end(f, false);
  return out;
}

bool whole_file_end(const whole_file *f, bool good) {
  if (is_direct(f)) return good;
  if (good && rename(f->working, f->target) == 0) return true;
  const int reason = errno;
  unlink(f->working);
  errno = reason;
  return false;
}

static bool sync_path(const char *path, int flags) {
  const int file = open(path, O_RDONLY | O_CLOEXEC | flags);
  const bool good = file >= 0 && fsync(file) == 0;
  const int reason = errno;
  if (file >= 0) close(file);
  errno = reason;
  return good;
}

/* Of the folder that holds `path`; with the slash at its end. "./" without one. */
static void folder_of(const char *path, char *folder, size_t size) {
  const char *slash = strrchr(path, '/');
  snprintf(folder, size, "%.*s", slash ? (int)(slash - path) + 1 : 2, slash ? path : "./");
}

/* A rename is on the disk only when its folder is. The file is whole under its name by then, and
   some file systems cannot sync folders: that this fails is no failure. */
bool whole_file_end_on_disk(const whole_file *f, bool good) {
  char folder[WHOLE_FILE_PATH];
  if (!whole_file_end(f, good && sync_path(f->working, 0))) return false;
  folder_of(f->target, folder, sizeof folder);
  (void)sync_path(folder, O_DIRECTORY);
  return true;
}

/* ".process.number.part" */
static bool is_working_end(const char *text) {
  for (int k = 0; k < 2; k++) {
    const size_t digits = *text == '.' ? strspn(text + 1, "0123456789") : 0;
    if (!digits) return false;
    text += digits + 1;
  }
  return strcmp(text, ending) == 0;
}

void whole_file_clear(const char *path) {
  char folder[WHOLE_FILE_PATH], found[WHOLE_FILE_PATH + 256];
  const char *slash = strrchr(path, '/'), *name = slash ? slash + 1 : path;
  const size_t length = strlen(name);
  folder_of(path, folder, sizeof folder);
  DIR *all = opendir(folder);
  for (const struct dirent *e; all && (e = readdir(all));) {
    if (strncmp(e->d_name, name, length) != 0 || !is_working_end(e->d_name + length)) continue;
    snprintf(found, sizeof found, "%s%s", folder, e->d_name);
    unlink(found);
  }
  if (all) closedir(all);
}
