#include "runtime/result/result_find.h"

#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

#include "dsl/base/arena.h"
#include "dsl/base/characters.h"
#include "dsl/base/diagnostics.h"
#include "runtime/base/symmetric_tensor.h"
#include "runtime/deck/output_fields.h"
#include "runtime/result/result_sets.h"

/* --- what there is ---------------------------------------------------------------------------- */

static herr_t list_one(hid_t group, const char *name, const H5L_info_t *info, void *names) {
  (void)group, (void)info;
  result_names_add(names, "", name);
  return 0;
}

result_names result_list(result_file *f, const char *group) {
  result_names n = {0};
  if (H5Lexists(f->file, group, H5P_DEFAULT) <= 0) return n;
  hid_t g = H5Gopen2(f->file, group, H5P_DEFAULT);
  if (g < 0) return n;
  H5Literate(g, H5_INDEX_NAME, H5_ITER_INC, NULL, list_one, &n);
  H5Gclose(g);
  return n;
}

static bool is_group(const result_file *f, const char *path) {
  hid_t g = H5Gopen2(f->file, path, H5P_DEFAULT);
  if (g >= 0) H5Gclose(g);
  return g >= 0;
}

/* Of groups within groups, too: "notch/start/K_I". */
static void add_members(result_file *f, const char *group, const char *folder, int deep,
                        result_names *all) {
  enum { DEEPEST = 8 }; /* a damaged file may lead in circles */
  result_names here = result_list(f, group);
  for (int k = 0; k < here.count && deep < DEEPEST; k++) {
    char path[512], name[512];
    if (deep == 0 && strcmp(here.items[k], "time") == 0) continue;
    snprintf(path, sizeof path, "%.250s/%.250s", group, here.items[k]);
    snprintf(name, sizeof name, "%.250s%s%.250s", folder, *folder ? "/" : "", here.items[k]);
    if (is_group(f, path))
      add_members(f, path, name, deep + 1, all);
    else
      result_names_add(all, folder, here.items[k]);
  }
  result_names_free(&here);
}

result_names result_members(result_file *f, const char *group) {
  result_names all = {0};
  add_members(f, group, "", 0, &all);
  result_names_index(&all);
  return all;
}

const result_names *result_names_in(result_file *f, const char *group) {
  const named_group k = strcmp(group, "/frames") == 0 ? FIELDS : HISTORIES;
  if (!f->listed[k]) f->known[k] = result_members(f, group);
  f->listed[k] = true;
  return &f->known[k];
}

bool result_is_quasi_static(result_file *f) {
  return result_names_find(result_names_in(f, "/history"), "relaxation_steps") >= 0;
}

/* --- what is meant ---------------------------------------------------------------------------- */

/* Appends to the sentence, as far as there is room. */
static void add_text(char *text, size_t size, const char *format, ...)
    __attribute__((format(printf, 3, 4)));
static void add_text(char *text, size_t size, const char *format, ...) {
  const size_t used = strlen(text);
  va_list values;
  va_start(values, format);
  vsnprintf(text + used, size - used, format, values);
  va_end(values);
}

enum { OF_PARTICLES = 1, OF_BONDS = 2 }; /* the latter lie in folders */
static void add_names(char *text, size_t size, const result_names *n, int which) {
  int count = 0;
  for (int k = 0; k < n->count; k++)
    if (which & (strchr(n->items[k], '/') ? OF_BONDS : OF_PARTICLES))
      add_text(text, size, "%s%s", count++ ? ", " : "", name_shown(n->items[k]));
  if (!count) add_text(text, size, "none");
}

/* tensor_traced of names in any folder. */
static const char *traced(const result_names *n, const char *given, char *words, size_t size) {
  const char **last = must_calloc((size_t)n->count + 1, sizeof *last);
  for (int k = 0; k < n->count; k++)
    last[k] = result_names_last(n->items[k]);
  const char *said = tensor_traced(given, last, n->count, words, size);
  free(last);
  return said;
}

/* After `output`, `state` or `damage` in a law's text. */
static bool declares(const char *text, const char *name) {
  for (const char *line = text; line; line = strchr(line + 1, '\n')) {
    char word[16], found[256];
    if (sscanf(line, " %15[a-z] %255[A-Za-z0-9_]", word, found) == 2 &&
        (strcmp(word, "output") == 0 || strcmp(word, "state") == 0 ||
         strcmp(word, "damage") == 0) &&
        strcasecmp(found, name) == 0)
      return true;
  }
  return false;
}

static bool a_law_declares(result_file *f, const char *name) {
  result_names laws = result_list(f, "/input/models");
  bool found = false;
  for (int k = 0; k < laws.count && !found; k++) {
    char path[512];
    snprintf(path, sizeof path, "/input/models/%.250s", laws.items[k]);
    const hid_t set = H5Dopen2(f->file, path, H5P_DEFAULT);
    char *text = set >= 0 ? h5_read_text(set) : NULL;
    if (set >= 0) H5Dclose(set);
    found = text && declares(text, name);
    free(text);
  }
  result_names_free(&laws);
  return found;
}

/* Something that frames would hold if the deck asked for it. */
static bool can_be_stored(result_file *f, const char *name) {
#define X(field, ...) #field,
  static const char *const fields[] = {OUTPUT_FIELDS(X) OUTPUT_TENSORS(X)};
#undef X
  for (size_t k = 0; k < sizeof fields / sizeof *fields; k++)
    if (strcasecmp(fields[k], name) == 0) return true;
  return a_law_declares(f, name);
}

static void no_such_name(result_file *f, const char *group, const char *given, char *error,
                         size_t size) {
  const bool of_frames = strcmp(group, "/frames") == 0;
  const result_names *n = result_names_in(f, group);
  const char *near = result_names_near(n, given);
  char words[256];
  snprintf(error, size, "`%s` has no %s `%s`; ", f->path, of_frames ? "field" : "history", given);
  if (traced(n, given, words, sizeof words))
    add_text(error, size, "%s; ", words);
  else if (near)
    add_text(error, size, "did you mean `%s`? ", name_shown(near));
  else if (of_frames && can_be_stored(f, given))
    add_text(error, size, "add '%s' to `fields` in the deck's `&output` and run again; ", given);
  if (of_frames) {
    add_text(error, size, "fields of particles: ");
    add_names(error, size, n, OF_PARTICLES);
    add_text(error, size, "; of bonds: ");
    add_names(error, size, n, OF_BONDS);
  } else {
    add_text(error, size, "it has ");
    add_names(error, size, n, OF_PARTICLES | OF_BONDS);
  }
}

/* How many have a field of that name on their bonds. */
static int interactions_with(const result_names *n, const char *field) {
  int count = 0;
  for (int k = 0; k < n->count; k++)
    count += strchr(n->items[k], '/') && strcmp(result_names_last(n->items[k]), field) == 0;
  return count;
}

bool result_find(result_file *f, const char *group, const char *given, char *name, size_t size,
                 char *error, size_t error_size) {
  const result_names *n = result_names_in(f, group);
  const int k = result_names_find(n, given);
  const bool is_time = k < 0 && strcmp(group, "/history") == 0 && strcmp(given, "time") == 0;
  snprintf(name, size, "%s", k < 0 ? given : n->items[k]);
  if (k >= 0 || is_time) return true;
  const char *field = strncmp(given, "*/", 2) == 0 ? given + 2 : given;
  if (strcmp(group, "/frames") == 0 && interactions_with(n, field) > 0) {
    snprintf(name, size, "*/%s", field);
    return true;
  }
  no_such_name(f, group, given, error, error_size);
  return false;
}
