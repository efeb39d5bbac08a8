#include "runtime/base/confined.h"

#include <limits.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { MOST_FOLDERS = 8, PATH_LONGEST = 4096 };

/* folders[0] is the one to write in, too; none where there is none. */
static struct {
  bool on;
  int count;
  char folders[MOST_FOLDERS][PATH_LONGEST];
  char hidden[PATH_LONGEST]; /* a file that is never read; "": none */
} confined;

/* Takes the folder as it is without links. */
static bool add_folder(const char *folder) {
  char *whole = realpath(folder, NULL);
  const bool good = whole && strlen(whole) < PATH_LONGEST && confined.count < MOST_FOLDERS;
  if (good) strcpy(confined.folders[confined.count++], whole);
  free(whole);
  return good;
}

bool files_confine(const char *folder, const char *const *readable, int count) {
  confined.on = true;
  confined.count = 0;
  if (!add_folder(folder)) return false;
  for (int k = 0; k < count; k++)
    add_folder(readable[k]);
  return true;
}

void file_never_read(const char *path) {
  char *whole = realpath(path, NULL);
  confined.hidden[0] = 0;
  if (whole && strlen(whole) < PATH_LONGEST) strcpy(confined.hidden, whole);
  free(whole);
}

bool files_are_confined(void) {
  return confined.on;
}

static bool lies_in(const char *whole, const char *folder) {
  const size_t length = strlen(folder);
  return strncmp(whole, folder, length) == 0 && (whole[length] == '/' || length == 1);
}

bool file_may_be_read(const char *path) {
  if (!confined.on) return true;
  char *whole = realpath(path, NULL);
  bool found = false;
  for (int k = 0; whole && k < confined.count && !found; k++)
    found = lies_in(whole, confined.folders[k]);
  if (whole && strcmp(whole, confined.hidden) == 0) found = false;
  free(whole);
  return found;
}

/* The folder that holds `path`; with the slash at its end. */
static char *folder_of(const char *path) {
  char folder[PATH_LONGEST];
  const char *slash = strrchr(path, '/');
  const int length = snprintf(folder, sizeof folder, "%.*s", slash ? (int)(slash - path) + 1 : 2,
                              slash ? path : "./");
  return length < (int)sizeof folder ? realpath(folder, NULL) : NULL;
}

bool file_may_be_written(const char *path) {
  if (!confined.on) return true;
  char *whole = realpath(path, NULL);
  if (whole) {
    const bool inside = confined.count > 0 && lies_in(whole, confined.folders[0]);
    free(whole);
    return inside;
  }
  char *folder = folder_of(path);
  char below[PATH_LONGEST + 2];
  if (folder) snprintf(below, sizeof below, "%s/", folder);
  const bool inside = folder && confined.count > 0 && lies_in(below, confined.folders[0]);
  free(folder);
  return inside;
}
