#include "generator/exercise/exercise_files.h"

#include <dirent.h>
#include <fnmatch.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

#include "generator/kernel/model.h"

const char *path_in(arena *a, const char *folder, const char *name) {
  const size_t length = strlen(folder);
  const bool ends = length > 0 && folder[length - 1] == '/';
  return arena_printf(a, "%s%s%s", folder, ends ? "" : "/", name);
}

bool is_ordinary_file(const char *path) {
  struct stat about;
  return stat(path, &about) == 0 && S_ISREG(about.st_mode);
}

bool is_folder(const char *path) {
  struct stat about;
  return stat(path, &about) == 0 && S_ISDIR(about.st_mode);
}

/* An absolute path, or a step up anywhere in it. */
static bool leaves(const char *pattern) {
  if (*pattern == '/' || !*pattern) return true;
  for (const char *part = pattern; part;) {
    const size_t length = strcspn(part, "/");
    if (length == 2 && strncmp(part, "..", 2) == 0) return true;
    part = part[length] ? part + length + 1 : NULL;
  }
  return false;
}

bool folder_match(arena *a, const char *folder, const char *pattern, const char ***names,
                  int *count) {
  *names = NULL;
  *count = 0;
  if (leaves(pattern)) return false;
  const char *slash = strrchr(pattern, '/'), *last = slash ? slash + 1 : pattern;
  const char *before = arena_text(a, pattern, (size_t)(last - pattern));
  struct dirent **at;
  const int all = scandir(path_in(a, folder, before), &at, NULL, alphasort);
  if (all < 0) return true;
  *names = arena_alloc(a, ((size_t)all + 1) * sizeof **names);
  for (int k = 0; k < all; k++) {
    const char *name = arena_printf(a, "%s%s", before, at[k]->d_name);
    if (fnmatch(last, at[k]->d_name, FNM_PERIOD) == 0 && is_ordinary_file(path_in(a, folder, name)))
      (*names)[(*count)++] = name;
    free(at[k]);
  }
  free(at);
  return true;
}

const char *leading_sentence(arena *a, const char *path) {
  char error[256];
  size_t length;
  char *text = read_text_file(path, MODEL_LIMIT, &length, error, sizeof error);
  if (!text) return "";
  const char *all = "";
  for (const char *line = text; *line;) {
    const size_t whole = strcspn(line, "\n");
    const char *begin = line + strspn(line, " \t");
    if (*begin != '!') break;
    begin += 1 + strspn(begin + 1, "> \t");
    size_t size = begin < line + whole ? (size_t)(line + whole - begin) : 0;
    while (size > 0 && strchr(" \t\r", begin[size - 1]))
      size--;
    if (size == 0) break;
    all = arena_printf(a, "%s%s%.*s", all, *all ? " " : "", (int)size, begin);
    line += whole + (line[whole] == '\n');
  }
  free(text);
  return all;
}
