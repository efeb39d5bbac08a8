#include "runtime/whole_file.h"

#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

static bool is_direct(const whole_file *f) {
  return strcmp(f->target, f->working) == 0;
}

bool whole_file_begin(whole_file *f, const char *path) {
  struct stat about;
  const bool exists = stat(path, &about) == 0, ordinary = !exists || S_ISREG(about.st_mode);
  char *target = exists && ordinary ? realpath(path, NULL) : NULL;
  const int length = snprintf(f->target, sizeof f->target, "%s", target ? target : path);
  free(target);
  snprintf(f->working, sizeof f->working, "%s%s", f->target, ordinary ? ".part" : "");
  if (length >= (int)sizeof f->target) {
    errno = ENAMETOOLONG;
    return false;
  }
  return !exists || access(path, W_OK) == 0;
}

bool whole_file_end(const whole_file *f, bool good) {
  if (is_direct(f)) return good;
  if (good && rename(f->working, f->target) == 0) return true;
  const int reason = errno;
  unlink(f->working);
  errno = reason;
  return false;
}
