#include "generator/grade/answers_found.h"

#include <dirent.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

#include "dsl/base/characters.h"
#include "generator/exercise/exercise_files.h"
#include "generator/kernel/document.h"

static const char *folder_of_file(arena *a, const char *path) {
  const char *slash = strrchr(path, '/');
  return slash ? arena_text(a, path, (size_t)(slash - path) + 1) : "./";
}

static handed_in *one_file(arena *a, const char *path) {
  handed_in *one = arena_alloc(a, sizeof *one);
  *one = (handed_in){path, path, folder_of_file(a, path)};
  return one;
}

/* Whatever it is: what is no ordinary file is told when it is copied. */
static bool is_there(const char *path) {
  struct stat about;
  return lstat(path, &about) == 0;
}

/* NAME.plm is an answer alone: what lies beside it is others'. */
static bool take_entry(arena *a, const exercise *e, const char *folder, const char *entry,
                       handed_in *out) {
  const char *ending = e->of_answers ? ".txt" : ".plm",
             *own = e->of_answers ? "answers.txt" : "answer.plm";
  const char *path = path_in(a, folder, entry);
  struct stat about;
  if (entry[0] == '.' || lstat(path, &about) != 0) return false;
  if (S_ISDIR(about.st_mode)) {
    const char *file = path_in(a, path, own);
    *out = (handed_in){arena_text(a, entry, strlen(entry)), is_there(file) ? file : NULL, path};
    return true;
  }
  if (!text_ends_in(entry, ending)) return false;
  *out = (handed_in){arena_text(a, entry, strlen(entry) - strlen(ending)), path, NULL};
  return true;
}

handed_in *answers_found(arena *a, const exercise *e, const char *path, int *count) {
  struct dirent **at;
  *count = 1;
  if (!is_folder(path)) {
    if (is_there(path)) return one_file(a, path);
    say_error("there is no answer `%s`", path);
    *count = -1;
    return NULL;
  }
  const int all = scandir(path, &at, NULL, alphasort);
  handed_in *found = arena_alloc(a, ((size_t)(all > 0 ? all : 0) + 1) * sizeof *found);
  *count = 0;
  for (int k = 0; k < all; k++) {
    *count += take_entry(a, e, path, at[k]->d_name, &found[*count]);
    free(at[k]);
  }
  if (all >= 0) free(at);
  if (*count > 0) return found;
  say_error("there is no answer in `%s`: they are NAME.%s or NAME/%s", path,
            e->of_answers ? "txt" : "plm", e->of_answers ? "answers.txt" : "answer.plm");
  *count = -1;
  return NULL;
}
