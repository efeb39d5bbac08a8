#include "generator/kernel/model.h"

#include <dirent.h>
#include <errno.h>
#include <fcntl.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "dsl/base/characters.h"
#include "dsl/semantics/law_check.h"
#include "dsl/syntax/parse.h"
#include "generator/emit/descriptor.h"
#include "generator/emit/emit.h"
#include "generator/interpreter/interpreted.h"
#include "generator/kernel/document.h"
#include "generator/kernel/standard_input.h"
#include "generator/kernel/toolchain_cache.h"
#include "generator/kernel/toolchain_compiler.h"
#include "runtime/base/clock.h"
#include "runtime/base/confined.h"
#include "runtime/base/ordinary_file.h"

#define PATH_LIMIT 4096

static char *read_standard_input(size_t limit, size_t *length, char *error, size_t size) {
  const char *why, *text = standard_input(length, &why);
  if (text && *length <= limit) return memcpy(must_alloc(*length + 1), text, *length + 1);
  if (text)
    snprintf(error, size, "cannot read the standard input: it is longer than %zu MiB", limit >> 20);
  else
    snprintf(error, size, "cannot read the standard input: %s", why);
  return NULL;
}

char *read_text_file(const char *path, size_t limit, size_t *length, char *error, size_t size) {
  if (is_standard_input(path)) return read_standard_input(limit, length, error, size);
  struct stat about;
  const char *why = NULL;
  const int file = ordinary_file_open(path, O_RDONLY, &why);
  FILE *in = file >= 0 ? fdopen(file, "rb") : NULL;
  if (!in || fstat(file, &about) != 0) {
    snprintf(error, size, "cannot read `%s`: %s", path, why ? why : strerror(errno));
    return NULL;
  }
  if ((size_t)about.st_size > limit) {
    snprintf(error, size, "cannot read `%s`: it is longer than %zu MiB", path, limit >> 20);
    fclose(in);
    return NULL;
  }
  char *text = must_alloc((size_t)about.st_size + 1);
  *length = fread(text, 1, (size_t)about.st_size, in);
  bool failed = ferror(in) != 0;
  fclose(in);
  text[*length] = 0;
  if (failed) {
    snprintf(error, size, "cannot read `%s`: %s", path, strerror(errno));
    free(text);
    return NULL;
  }
  return text;
}

/* --- kinds ------------------------------------------------------------------------------------ */

/* A deck's first group begins with `&`, before it are blanks and comments; anything else is
   taken for a law. */
static file_kind kind_of_text(const char *text) {
  for (; *text; text += strcspn(text, "\n")) {
    text += strspn(text, " \t\r\n");
    if (*text != '!') break;
  }
  return *text == '&' ? FILE_DECK : *text ? FILE_LAW : FILE_UNKNOWN;
}

static file_kind kind_of_bytes(const char *head, size_t n) {
  static const char signature[8] = {'\x89', 'H', 'D', 'F', '\r', '\n', '\x1a', '\n'};
  if (n >= sizeof signature && memcmp(head, signature, sizeof signature) == 0) return FILE_RESULT;
  if (strncmp(head, "\x89PNG", 4) == 0 || strncmp(head, "%PDF", 4) == 0) return FILE_PICTURE;
  return kind_of_text(head);
}

static file_kind kind_by_content(const char *path) {
  char head[65536];
  const char *why;
  if (is_standard_input(path)) {
    size_t length;
    const char *text = standard_input(&length, &why);
    return text ? kind_of_bytes(text, length) : FILE_UNKNOWN;
  }
  const int file = ordinary_file_open(path, O_RDONLY, &why);
  FILE *in = file >= 0 ? fdopen(file, "rb") : NULL;
  if (!in) return FILE_UNKNOWN;
  size_t n = fread(head, 1, sizeof head - 1, in);
  fclose(in);
  head[n] = 0;
  return kind_of_bytes(head, n);
}

file_kind kind_of_file(const char *path) {
  static const struct {
    const char *ending;
    file_kind kind;
  } endings[] = {{".plm", FILE_LAW},     {".nml", FILE_DECK},  {".h5", FILE_RESULT},
                 {".hdf5", FILE_RESULT}, {".csv", FILE_TABLE}, {".xdmf", FILE_SIDECAR}};
  for (size_t k = 0; k < sizeof endings / sizeof *endings; k++)
    if (text_ends_in(path, endings[k].ending)) return endings[k].kind;
  return kind_by_content(path);
}

bool file_suits(const char *path, unsigned kinds, const char *command, const char *needs) {
  static const char *const words[] = {[FILE_LAW] = "a law",
                                      [FILE_DECK] = "a deck",
                                      [FILE_RESULT] = "a result",
                                      [FILE_TABLE] = "a table of comma-separated values",
                                      [FILE_SIDECAR] = "what ParaView reads of a result (.h5)",
                                      [FILE_PICTURE] = "a picture"};
  const file_kind kind = kind_of_file(path);
  if (kind == FILE_UNKNOWN || kinds >> kind & 1) return true;
  say_error("`%s` is %s; `%s` needs %s", path, words[kind], command, needs);
  return false;
}

bool same_file(const char *a, const char *b) {
  struct stat x, y;
  return stat(a, &x) == 0 && stat(b, &y) == 0 && x.st_dev == y.st_dev && x.st_ino == y.st_ino;
}

/* --- finding ---------------------------------------------------------------------------------- */

/* That the process may read. */
static bool is_file(const char *path) {
  struct stat about;
  return stat(path, &about) == 0 && S_ISREG(about.st_mode) && file_may_be_read(path);
}

/* folder/name[.plm], when there is such a file. */
static char *try_path(const char *folder, const char *name) {
  char path[PATH_LIMIT];
  int n = snprintf(path, sizeof path, "%s%s%s%s", folder, *folder ? "/" : "", name,
                   text_ends_in(name, ".plm") ? "" : ".plm");
  return n > 0 && (size_t)n < sizeof path && is_file(path) ? must_copy(path) : NULL;
}

static void folder_of(const char *path, char *folder, size_t size) {
  const char *slash = strrchr(path, '/');
  if (slash)
    snprintf(folder, size, "%.*s", (int)(slash - path), path);
  else
    snprintf(folder, size, ".");
}

/* models/ in `from` and in the folders above it. */
static char *try_parents(const char *from, const char *name) {
  char folder[PATH_LIMIT];
  snprintf(folder, sizeof folder, "%s/models", from);
  for (int up = 0; up < 6; up++) {
    char *found = try_path(folder, name);
    if (found) return found;
    char next[PATH_LIMIT];
    size_t stem = strlen(folder) - strlen("models");
    if ((size_t)snprintf(next, sizeof next, "%.*s../models", (int)stem, folder) >= sizeof next)
      return NULL;
    memcpy(folder, next, sizeof folder);
  }
  return NULL;
}

enum { PROGRAM_FOLDERS = 3 };

/* Where models may stand from the program's own place; false where that is not known. */
static bool program_folders(char models[PROGRAM_FOLDERS][PATH_LIMIT + 32]) {
  static const char *const relative[PROGRAM_FOLDERS] = {"../models", PERILAT_DATA_FOLDER "/models",
                                                        "models"};
  char program[PATH_LIMIT], folder[PATH_LIMIT];
  ssize_t n = readlink("/proc/self/exe", program, sizeof program - 1);
  if (n <= 0) return false;
  program[n] = 0;
  folder_of(program, folder, sizeof folder);
  for (int k = 0; k < PROGRAM_FOLDERS; k++)
    snprintf(models[k], sizeof models[k], "%s/%s", folder, relative[k]);
  return true;
}

static char *try_program_tree(const char *name) {
  char models[PROGRAM_FOLDERS][PATH_LIMIT + 32], *found = NULL;
  if (!program_folders(models)) return NULL;
  for (int k = 0; k < PROGRAM_FOLDERS && !found; k++)
    found = try_path(models[k], name);
  return found;
}

bool model_confine(const char *file, const char *further) {
  char folder[PATH_LIMIT], models[PROGRAM_FOLDERS][PATH_LIMIT + 32];
  const char *readable[PROGRAM_FOLDERS + 2];
  int count = 0;
  folder_of(file, folder, sizeof folder);
  if (program_folders(models))
    for (int k = 0; k < PROGRAM_FOLDERS; k++)
      readable[count++] = models[k];
  if (getenv("PERILAT_MODELS")) readable[count++] = getenv("PERILAT_MODELS");
  if (further) readable[count++] = further;
  return files_confine(folder, readable, count);
}

char *model_find(const char *name, const char *beside) {
  char *found = NULL;
  if (!beside && is_standard_input(name)) return must_copy(name);
  if (name[0] == '/') found = is_file(name) ? must_copy(name) : NULL;
  if (!found && beside) {
    char folder[PATH_LIMIT];
    folder_of(beside, folder, sizeof folder);
    found = try_path(folder, name);
    found = found ? found : try_parents(folder, name);
  }
  if (!found && getenv("PERILAT_MODELS")) found = try_path(getenv("PERILAT_MODELS"), name);
  if (!found) found = try_path("", name);
  if (!found) found = try_parents(".", name);
  return found ? found : try_program_tree(name);
}

/* --- opening ---------------------------------------------------------------------------------- */

static void suggest_from(const char *folder, const char *name, diagnostics *said) {
  struct dirent **at;
  const int all = scandir(folder, &at, NULL, alphasort);
  if (all < 0) return;
  const char **names = must_calloc((size_t)all + 1, sizeof *names);
  int count = 0;
  for (int k = 0; k < all; k++) {
    if (!text_ends_in(at[k]->d_name, ".plm")) continue;
    at[k]->d_name[strlen(at[k]->d_name) - strlen(".plm")] = 0;
    names[count++] = at[k]->d_name;
  }
  diag_suggest(said, name, names, count);
  for (int k = 0; k < all; k++)
    free(at[k]);
  free(at);
  free(names);
}

void model_suggest(const char *name, const char *beside, diagnostics *said) {
  char folder[PATH_LIMIT];
  char *some = model_find("elastic", beside);
  if (!some) return;
  folder_of(some, folder, sizeof folder);
  free(some);
  suggest_from(folder, name, said);
}

/* include "x.plm": beside the including file, then wherever models are found. */
static char *read_include(void *context, const char *name, const char *from, char **found) {
  (void)context;
  if (files_are_confined() && (name[0] == '/' || strstr(name, ".."))) return NULL;
  char *path = model_find(name, from);
  if (!path) return NULL;
  size_t length;
  char error[PATH_LIMIT + 128];
  char *text = read_text_file(path, MODEL_LIMIT, &length, error, sizeof error);
  if (text)
    *found = path;
  else
    free(path);
  return text;
}

static void begin_model(model *m, const char *path) {
  memset(m, 0, sizeof *m);
  m->memory = arena_new();
  m->path = must_copy(path);
  diag_begin(&m->said, &m->sources);
}

static bool check_text(model *m, const char *text, size_t length, const law_choice *choices,
                       int choice_count) {
  double begun = monotonic_seconds();
  int file = source_add(&m->sources, m->path, text, length);
  parse_options options = {read_include, NULL};
  m->tree = parse_model(m->memory, &m->sources, file, &options, &m->said);
  if (!m->tree || m->said.errors) return false;
  m->law = law_check(m->memory, m->tree, &m->sources, choices, choice_count, &m->said);
  m->seconds_front += monotonic_seconds() - begun;
  return m->law && !m->said.errors;
}

bool model_open_text(model *m, const char *path, const char *text, size_t length,
                     const law_choice *choices, int choice_count) {
  begin_model(m, path);
  return check_text(m, text, length, choices, choice_count);
}

bool model_open(model *m, const char *path, const law_choice *choices, int choice_count) {
  double begun = monotonic_seconds();
  size_t length;
  char error[PATH_LIMIT + 128];
  begin_model(m, path);
  char *text = read_text_file(path, MODEL_LIMIT, &length, error, sizeof error);
  if (!text) {
    diag_report(&m->said, DIAG_FILE, (span){0, 0, UINT16_MAX}, "%s",
                error); /* has no line to show */
    return false;
  }
  m->seconds_front = monotonic_seconds() - begun;
  bool good = check_text(m, text, length, choices, choice_count);
  free(text);
  return good;
}

bool model_suits(const model *m, const char *setting, char *meant, size_t size) {
  const tree *t = m->tree;
  size_t n = 0;
  meant[0] = 0;
  for (int k = 0; k < t->setting_count; k++) {
    if (strcmp(t->settings[k], setting) == 0) return true;
    if (strcmp(t->settings[k], LAW_IRREGULAR) == 0 || n >= size) continue;
    n += (size_t)snprintf(meant + n, size - n, "%s%s", n ? ", " : "", t->settings[k]);
  }
  return n == 0;
}

bool model_suits_irregular(const model *m) {
  for (int k = 0; k < m->tree->setting_count; k++)
    if (strcmp(m->tree->settings[k], LAW_IRREGULAR) == 0) return true;
  return false;
}

bool model_plan(model *m) {
  return model_plan_varying(m, &(law_variation){.varying_count = 0});
}

static bool keep_plan(model *m, kernel_plan *plan, double begun) {
  m->plan = plan;
  m->seconds_front += monotonic_seconds() - begun;
  return plan != NULL;
}

bool model_plan_varying(model *m, const law_variation *v) {
  const double begun = monotonic_seconds();
  return keep_plan(m, plan_kernel_varying(m->law, v, &m->said), begun);
}

bool model_plan_of_families(model *m, const law_variation *v) {
  const double begun = monotonic_seconds();
  return keep_plan(m, plan_kernel_of_families(m->law, v, &m->said), begun);
}

static void emit_once(model *m) {
  if (m->c_text) return;
  char *unkeyed = emit_kernel(m->plan);
  m->key = toolchain_key(unkeyed);
  m->c_text = descriptor_keyed(unkeyed, m->key);
  free(unkeyed);
}

const char *model_c_text(model *m) {
  emit_once(m);
  return m->c_text;
}

const char *model_key(model *m) {
  emit_once(m);
  return m->key;
}

const pl_law *model_kernel(model *m, bool interpret, const char **note, char *error, size_t size) {
  *note = NULL;
  if (!interpret && !toolchain_compiler())
    *note = arena_printf(m->memory, "%s: the law runs on the interpreter, many times slower",
                         toolchain_no_compiler());
  if (interpret || *note) {
    m->interpreted = plan_interpreted(m->plan);
    return m->interpreted;
  }
  if (!toolchain_load(model_c_text(m), model_key(m), &m->loaded, error, size)) return NULL;
  const char *trouble = toolchain_cache_trouble();
  if (trouble) *note = arena_printf(m->memory, "%s", trouble);
  return m->loaded.law;
}

void model_close(model *m) {
  if (m->interpreted) plan_interpreted_free(m->interpreted);
  if (m->loaded.law) toolchain_unload(&m->loaded);
  if (m->plan) plan_free(m->plan);
  free(m->c_text);
  free(m->key);
  free(m->path);
  diag_clear(&m->said);
  source_clear(&m->sources);
  arena_free(m->memory);
  memset(m, 0, sizeof *m);
}
