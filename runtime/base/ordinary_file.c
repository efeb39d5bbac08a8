#include "runtime/base/ordinary_file.h"

#include <errno.h>
#include <fcntl.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "runtime/base/confined.h"

static const char *objection(int file, int flags) {
  struct stat about;
  if (fstat(file, &about) != 0) return strerror(errno);
  if (S_ISDIR(about.st_mode)) return "it is a folder";
  if (!S_ISREG(about.st_mode)) return "it is not a file";
  return (flags & O_NOFOLLOW) && about.st_nlink > 1 ? "the file has another name, too" : NULL;
}

int ordinary_file_open(const char *path, int flags, const char **why) {
  const bool writes = (flags & O_ACCMODE) != O_RDONLY;
  if (writes ? !file_may_be_written(path) : !file_may_be_read(path)) {
    *why = "it is none of the files that may be used here";
    return -1;
  }
  const int file = open(path, flags | O_NONBLOCK | O_CLOEXEC, 0666);
  if (file < 0) {
    *why = errno == ELOOP && (flags & O_NOFOLLOW) ? "it is a link" : strerror(errno);
    return -1;
  }
  *why = objection(file, flags);
  if (!*why) return file;
  close(file);
  return -1;
}
