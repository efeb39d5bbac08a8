#include "generator/grade/publish.h"

#include <ctype.h>
#include <dirent.h>
#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "dsl/base/characters.h"
#include "generator/exercise/exercise_files.h"
#include "generator/exercise/exercise_grammar.h"
#include "generator/kernel/document.h"
#include "generator/kernel/model.h"

enum { DEEPEST = 4 };
#define LONGEST ((size_t)64 << 20) /* B, of a file */
static const char own_file[] = "exercise.nml", kept[] = "teacher";

/* A file that may be given to students. */
typedef struct candidate {
  const char *name, *path; /* from the exercise's folder; whole */
  const char *unfit;       /* why it is never given, or NULL */
  bool taken;
} candidate;

typedef struct publishing {
  const exercise *e;
  const source_set *sources;
  arena *memory;
  const char *folder;
  const char **secrets; /* texts of all files in the teacher's folder */
  size_t *lengths;
  int secret_count;
  candidate *all;
  int count;
} publishing;

static bool fail(const char *what, const char *path) {
  say_error("%s `%s`: %s", what, path, strerror(errno));
  return false;
}

/* --- what is kept ----------------------------------------------------------------------------- */

static char *whole_text(const char *path, size_t *length) {
  char error[1024];
  char *text = read_text_file(path, LONGEST, length, error, sizeof error);
  if (!text) say_error("%s", error);
  return text;
}

/* Every entry of a folder that is no dot file; in alphabetical order. */
static int entries_of(arena *a, const char *folder, const char ***names) {
  struct dirent **at;
  int count = 0;
  const int all = scandir(folder, &at, NULL, alphasort);
  *names = arena_alloc(a, ((size_t)(all > 0 ? all : 0) + 1) * sizeof **names);
  for (int k = 0; k < all; k++) {
    if (at[k]->d_name[0] != '.')
      (*names)[count++] = arena_text(a, at[k]->d_name, strlen(at[k]->d_name));
    free(at[k]);
  }
  if (all >= 0) free(at);
  return count;
}

static bool learn_secrets(publishing *p, const char *folder, int depth) {
  const char **names;
  const int count = entries_of(p->memory, folder, &names);
  for (int k = 0; k < count; k++) {
    const char *path = path_in(p->memory, folder, names[k]);
    if (is_folder(path) && depth < DEEPEST) {
      if (!learn_secrets(p, path, depth + 1)) return false;
    } else if (is_ordinary_file(path)) {
      size_t length;
      char *text = whole_text(path, &length);
      if (!text) return false;
      p->secrets = arena_room(p->memory, p->secrets, p->secret_count, sizeof *p->secrets);
      p->lengths = arena_room(p->memory, p->lengths, p->secret_count, sizeof *p->lengths);
      p->secrets[p->secret_count] = arena_text(p->memory, text, length);
      p->lengths[p->secret_count++] = length;
      free(text);
    }
  }
  return true;
}

static bool is_secret(const publishing *p, const char *text, size_t length) {
  for (int k = 0; k < p->secret_count; k++)
    if (length > 0 && p->lengths[k] == length && memcmp(p->secrets[k], text, length) == 0)
      return true;
  return false;
}

/* --- files ------------------------------------------------------------------------------------ */

static bool write_file(const char *path, const char *text, size_t length) {
  FILE *out = fopen(path, "wbx");
  if (!out) return fail("cannot write", path);
  const bool good = fwrite(text, 1, length, out) == length;
  if (fclose(out) == 0 && good) return true;
  return fail("cannot write", path);
}

static bool copy_file(const publishing *p, const char *from, const char *to) {
  size_t length;
  char *text = whole_text(from, &length);
  if (!text) return false;
  bool good = !is_secret(p, text, length);
  if (!good) say_error("`%s` is the same as a file of %s/: nothing of it is published", from, kept);
  good = good && write_file(to, text, length);
  free(text);
  if (good) printf("written %s\n", to);
  return good;
}

/* --- what students get ------------------------------------------------------------------------ */

/* Why a file is never given, whatever names it; NULL: it may be. */
static const char *unfit(const char *name) {
  static const char *const results[] = {".h5", ".hdf5", ".xdmf"};
  if (strcmp(name, "answer.plm") == 0 || strcmp(name, "answers.txt") == 0) return "it is an answer";
  for (size_t k = 0; k < sizeof results / sizeof *results; k++)
    if (text_ends_in(name, results[k])) return "it is a result";
  return NULL;
}

static bool is_picture(const char *name) {
  static const char *const endings[] = {".png", ".svg", ".pdf", ".jpg", ".jpeg", ".gif", ".webp"};
  for (size_t k = 0; k < sizeof endings / sizeof *endings; k++)
    if (text_ends_in(name, endings[k])) return true;
  return false;
}

/* Every ordinary file beside the teacher's folder. Links are left out: they may lead anywhere. */
static void find_candidates(publishing *p, const char *inside, int depth) {
  const char **names;
  const int count = entries_of(p->memory, path_in(p->memory, p->e->folder, inside), &names);
  for (int k = 0; k < count; k++) {
    const char *name = arena_printf(p->memory, "%s%s", inside, names[k]),
               *path = path_in(p->memory, p->e->folder, name);
    struct stat about;
    if (depth == 0 && (strcmp(name, kept) == 0 || strcmp(name, own_file) == 0)) continue;
    if (lstat(path, &about) != 0) continue;
    if (S_ISDIR(about.st_mode) && depth < DEEPEST)
      find_candidates(p, arena_printf(p->memory, "%s/", name), depth + 1);
    if (!S_ISREG(about.st_mode)) continue;
    p->all = arena_room(p->memory, p->all, p->count, sizeof *p->all);
    p->all[p->count++] = (candidate){name, path, unfit(names[k]), false};
  }
}

/* Task, starter, and what public items name. */
static bool is_first(const exercise *e, const char *name) {
  if (strcmp(name, "task.md") == 0 || strncmp(name, "starter.", 8) == 0) return true;
  for (int k = 0; k < e->item_count; k++)
    for (int f = 0; f < e->items[k].found_count && item_is_public(&e->items[k]); f++)
      if (strcmp(e->items[k].found[f].name, name) == 0) return true;
  return false;
}

static bool continues_name(char c) {
  return isalnum((unsigned char)c) || c == '_' || c == '-';
}

/* `name` between two marks; of a picture a page that shows it, not one that has it drawn. */
static bool is_named_at(const char *text, const char *at, size_t length, bool picture) {
  const char before = at > text ? at[-1] : ' ', after = at[length];
  if (picture) return before == '(' || before == '"' || before == '/';
  if (continues_name(before) || before == '.' || continues_name(after)) return false;
  return after != '.' || !continues_name(at[length + 1]);
}

/* Does the text name the file, or a law by what stands before its ending, in quotes? */
static bool names_file(const char *text, const char *name) {
  const char *slash = strrchr(name, '/'), *last = slash ? slash + 1 : name;
  const size_t length = strlen(last), stem = text_ends_in(last, ".plm") ? length - 4 : 0;
  const bool picture = is_picture(last);
  for (const char *at = text; (at = strstr(at, last)); at++)
    if (is_named_at(text, at, length, picture)) return true;
  for (const char *at = text; stem && (at = strchr(at, '\'')); at++)
    if (strncmp(at + 1, last, stem) == 0 && at[1 + stem] == '\'') return true;
  return false;
}

/* A file that is given brings what it names. False after a sentence. */
static bool take(publishing *p, candidate *c) {
  size_t length;
  char *text = whole_text(c->path, &length);
  if (!text) return false;
  bool good = true;
  c->taken = true;
  for (int k = 0; k < p->count && good; k++)
    if (!p->all[k].taken && !p->all[k].unfit && names_file(text, p->all[k].name))
      good = take(p, &p->all[k]);
  free(text);
  return good;
}

/* The folders that a file's or folder's path goes through, as far as they are not there. */
static bool make_folders(const publishing *p, const char *path) {
  for (const char *slash = path + 1; (slash = strchr(slash, '/')); slash++) {
    const char *folder = arena_text(p->memory, path, (size_t)(slash - path));
    if (mkdir(folder, 0777) != 0 && errno != EEXIST) return fail("cannot make the folder", folder);
  }
  return true;
}

static bool give(const publishing *p, const candidate *c) {
  const char *to = path_in(p->memory, p->folder, c->name);
  return make_folders(p, to) && copy_file(p, c->path, to);
}

/* False after a sentence; what is left out is told. */
static bool copy_files(publishing *p) {
  find_candidates(p, "", 0);
  for (int k = 0; k < p->count; k++)
    if (!p->all[k].taken && !p->all[k].unfit && is_first(p->e, p->all[k].name) &&
        !take(p, &p->all[k]))
      return false;
  for (int k = 0; k < p->count; k++) {
    const candidate *c = &p->all[k];
    if (!c->taken)
      printf("left out %s: %s\n", name_shown(c->name),
             c->unfit ? c->unfit : "nothing that students get names it");
    else if (!give(p, c))
      return false;
  }
  return true;
}

/* --- the exercise's own file ------------------------------------------------------------------ */

static void put_text(FILE *out, const char *name, const char *text) {
  fprintf(out, "%s = '", name);
  for (const char *c = text; *c; c++)
    fputs(*c == '\'' ? "''" : (char[]){*c, 0}, out);
  fputc('\'', out);
}

/* As it was written. */
static void put_key(const publishing *p, const deck_key *key, FILE *out) {
  const source *s = &p->sources->items[key->value_where.file];
  const span at = key->value_where;
  fprintf(out, "  %s = %.*s", key->name, (int)(at.end - at.begin), s->text + at.begin);
}

static void put_item(const publishing *p, const exercise_item *item, FILE *out) {
  fputs("&item  ", out);
  if (!item_is_public(item)) {
    const bool by_hand = item->kind == ITEM_HAND;
    fprintf(out, "kind = '%s'  ", item_kind_names[item->kind]);
    put_text(out, "title", item->title);
    fprintf(out, "  points = %d%s", item->points, by_hand ? "" : "  hidden = .true.");
  }
  for (int k = 0; item_is_public(item) && k < item->item.key_count; k++)
    put_key(p, &item->item.keys[k], out);
  fputs("  /\n", out);
}

static bool write_exercise(const publishing *p) {
  const exercise *e = p->e;
  const char *path = path_in(p->memory, p->folder, own_file);
  char *text;
  size_t length;
  FILE *out = must_open_text(&text, &length);
  fputs("&exercise  ", out);
  put_text(out, "title", e->title);
  fprintf(out, "  minutes = %d  points = %d  /\n\n", e->minutes, e->points);
  for (int k = 0; k < e->item_count; k++)
    put_item(p, &e->items[k], out);
  must_close_text(out);
  const bool good = write_file(path, text, length);
  free(text);
  if (good) printf("written %s\n", path);
  return good;
}

/* --- the whole -------------------------------------------------------------------------------- */

/* The whole path of the folder, or of the nearest one above it that is there; to be freed. */
static char *nearest_there(const publishing *p, const char *folder) {
  const char *rest = folder;
  for (char *at; *rest; rest = arena_text(p->memory, rest, (size_t)(strrchr(rest, '/') - rest))) {
    if ((at = realpath(rest, NULL))) return at;
    if (!strchr(rest, '/')) break;
  }
  return realpath(*folder == '/' ? "/" : ".", NULL);
}

/* Would it be found in itself? */
static bool lies_inside(const publishing *p, const char *folder, const char *of) {
  char *whole = realpath(of, NULL), *at = nearest_there(p, folder);
  const size_t length = whole ? strlen(whole) : 0;
  const bool inside =
      whole && at && strncmp(at, whole, length) == 0 && (at[length] == '/' || at[length] == 0);
  free(whole);
  free(at);
  return inside;
}

/* An empty folder that is there will do; else it is made. False after a sentence. */
static bool make_folder(const publishing *p) {
  const char **names;
  const bool there = is_folder(p->folder);
  if (there && entries_of(p->memory, p->folder, &names) > 0) {
    say_error("the folder `%s` is not empty", p->folder);
    return false;
  }
  if (lies_inside(p, p->folder, p->e->folder)) {
    say_error("`%s` lies in the exercise itself", p->folder);
    return false;
  }
  if (there) return true;
  if (*p->folder && !make_folders(p, p->folder)) return false;
  if (mkdir(p->folder, 0777) == 0 || (errno == EEXIST && is_folder(p->folder))) return true;
  return fail("cannot make the folder", p->folder);
}

bool publish(const exercise *e, const source_set *sources, const char *folder) {
  publishing p = {.e = e, .sources = sources, .memory = arena_new(), .folder = folder};
  const bool good = make_folder(&p) && learn_secrets(&p, path_in(p.memory, e->folder, kept), 0) &&
                    copy_files(&p) && write_exercise(&p);
  arena_free(p.memory);
  return good;
}
