#include "generator/exercise/exercise.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

#include "dsl/base/characters.h"
#include "generator/drive/group_keys.h"
#include "generator/exercise/exercise_files.h"
#include "generator/exercise/exercise_grammar.h"
#include "generator/kernel/model.h"
#include "runtime/deck/deck_value.h"

#define EXERCISE_LIMIT ((size_t)1 << 20) /* B: the longest file */
static const char file_name[] = "exercise.nml", teacher[] = "teacher";

typedef struct reader {
  arena *memory;
  source_set *sources;
  diagnostics *d;
  exercise *e;
} reader;

/* --- what a kind needs ------------------------------------------------------------------------ */

#define KIND(code) (1u << ITEM_##code)
enum {
  JUDGED_BY_TABLES = KIND(PATH) | KIND(SAMPLE),
  OF_LAWS = KIND(CHECK) | JUDGED_BY_TABLES | KIND(IMPLIED) | KIND(RUN)
};

/* Which keys go with which kinds, besides kind, title, points and hidden. */
static const deck_key_use uses_of_keys[] = {
    {"show", OF_LAWS | KIND(ANSWERS), false},
    {"file", JUDGED_BY_TABLES | KIND(RUN) | KIND(ANSWERS), false},
    {"against", KIND(PATH), false},
    {"tolerance", JUDGED_BY_TABLES | KIND(IMPLIED) | KIND(RUN) | KIND(ANSWERS), false},
    {"energies", JUDGED_BY_TABLES, false},
    {"states", KIND(SAMPLE), false},
    {"vary", KIND(SAMPLE), false},
    {"within", KIND(SAMPLE), false},
    {"seed", KIND(SAMPLE), false},
    {"quantity", KIND(IMPLIED), true},
    {"set", KIND(IMPLIED) | KIND(RUN), false},
    {"like", KIND(RUN), false},
    {"monitor", KIND(RUN), false},
    {"of", KIND(CHECK) | KIND(RUN), false},
    {"at", KIND(RUN), false},
    {"material", KIND(RUN), false},
    {"value", KIND(IMPLIED) | KIND(RUN), false}};

static const deck_key_use uses_of_files[] = {
    {"file", KIND(PATH) | KIND(RUN) | KIND(ANSWERS), true}};

bool item_is_public(const exercise_item *item) {
  if (item->hidden || item->withheld || item->kind == ITEM_HAND) return false;
  for (int k = 0; k < item->found_count; k++)
    if (item->found[k].hidden) return false;
  switch (item->kind) {
  case ITEM_CHECK:
    return true;
  case ITEM_PATH:
    return item->against == AGAINST_EXPECTATIONS;
  case ITEM_RUN:
    return item->value || item->like_count || (item->of && strcmp(item->of, "imbalance") == 0);
  case ITEM_IMPLIED:
    return item->value != NULL;
  default:
    return false;
  }
}

/* --- keys that are read later ----------------------------------------------------------------- */

static bool read_seed(const reader *r, const namelist_group *g, exercise_item *item) {
  const namelist_key *key = namelist_find(g, "seed");
  item->seed = 1;
  if (!key) return true;
  if (!deck_values_counted(key, 1, r->d)) return false;
  const namelist_value *v = &key->values[0];
  item->seed_of_student = v->kind == NAMELIST_TEXT && strcmp(v->text, "student") == 0;
  if (item->seed_of_student) return true;
  if (v->kind == NAMELIST_NUMBER && v->number >= 0 && v->number < 1e15 &&
      v->number == floor(v->number)) {
    item->seed = (uint64_t)v->number;
    return true;
  }
  diag_report(r->d, DIAG_BAD_VALUE, key->value_where,
              "`seed` is a whole number that is not negative, or 'student'");
  return false;
}

static bool expects_something(const reader *r, const char *path) {
  char error[256];
  size_t length;
  char *text = read_text_file(path, NAMELIST_LARGEST_TEXT, &length, error, sizeof error);
  if (!text) return false;
  source_set sources = {NULL, 0};
  diagnostics unheard;
  diag_begin(&unheard, &sources);
  const int file = source_add(&sources, path, text, length);
  const namelist *n = namelist_read(r->memory, &sources, file, &unheard);
  bool expects = false;
  for (int k = 0; k < n->group_count; k++)
    expects = expects || strcasecmp(n->groups[k].name, "expect") == 0;
  diag_clear(&unheard);
  source_clear(&sources);
  free(text);
  return expects;
}

static void choose_defaults(const reader *r, const namelist_group *g, exercise_item *item) {
  if (!namelist_find(g, "tolerance"))
    item->tolerance = item->kind == ITEM_RUN ? 0.05 : item->kind == ITEM_ANSWERS ? 0.01 : 1e-6;
  if (item->kind != ITEM_RUN) item->monitor = item->at = NULL;
  if (item->kind == ITEM_RUN && !item->of) item->of = "peak";
  if (namelist_find(g, "against") || item->kind != ITEM_PATH) return;
  bool by_itself = item->found_count > 0;
  for (int k = 0; k < item->found_count; k++)
    by_itself = by_itself && !item->found[k].hidden && expects_something(r, item->found[k].path);
  item->against = by_itself ? AGAINST_EXPECTATIONS : AGAINST_REFERENCE;
}

/* "path public.nml", "implied nu". */
static void choose_title(const reader *r, exercise_item *item) {
  if (item->title) return;
  const char *what = item->file_count                       ? item->files[0]
                     : item->quantity                       ? item->quantity
                     : item->kind == ITEM_CHECK && item->of ? item->of
                                                            : "";
  item->title =
      arena_printf(r->memory, "%s%s%s", item_kind_names[item->kind], *what ? " " : "", what);
}

/* --- files ------------------------------------------------------------------------------------ */

static void add_file(const reader *r, exercise_item *item, const char *name, bool hidden) {
  const exercise *e = r->e;
  const char *in = hidden ? path_in(r->memory, teacher, name) : name;
  item->found = arena_room(r->memory, item->found, item->found_count, sizeof *item->found);
  item->found[item->found_count++] = (exercise_file){
      path_in(r->memory, e->folder, in), path_in(r->memory, e->given, in), name, hidden};
}

/* In the exercise's folder, else in the teacher's. */
static bool find_files(const reader *r, exercise_item *item, const char *pattern) {
  const exercise *e = r->e;
  const char **names;
  int count;
  const span where = deck_where(&item->item, "file");
  if (!folder_match(r->memory, e->folder, pattern, &names, &count)) {
    diag_report(r->d, DIAG_BAD_VALUE, where, "`%s` leaves the folder of the exercise",
                name_shown(pattern));
    return false;
  }
  const bool hidden = count == 0;
  if (hidden)
    folder_match(r->memory, path_in(r->memory, e->folder, teacher), pattern, &names, &count);
  for (int k = 0; k < count; k++)
    add_file(r, item, names[k], hidden);
  if (count) return true;
  diag_report(r->d, DIAG_FILE, where, "there is no file `%s` in %s or its folder %s",
              name_shown(pattern), e->name, teacher);
  return false;
}

static bool find_all_files(const reader *r, exercise_item *item) {
  bool good = true;
  for (int k = 0; k < item->file_count && item->kind != ITEM_ANSWERS; k++)
    good = find_files(r, item, item->files[k]) && good;
  return good;
}

/* --- items ------------------------------------------------------------------------------------ */

static bool check_words(const reader *r, const exercise_item *item) {
  static const char *const of_check[] = {"reads", "physics", NULL}, *const of_run[] = {
                                                                        "peak",       "last",
                                                                        "at peak",    "imbalance",
                                                                        "dissipated", NULL};
  const char *const *words = item->kind == ITEM_CHECK ? of_check : of_run;
  if (!item->of) return true;
  int count = 0;
  for (; words[count]; count++)
    if (strcmp(words[count], item->of) == 0) return true;
  diag_report(r->d, DIAG_BAD_VALUE, deck_where(&item->item, "of"), "`of` can not be '%s' here",
              name_shown(item->of));
  deck_suggest(r->d, item->of, words, count, "it is one of");
  return false;
}

static bool check_within(const reader *r, const exercise_item *item) {
  if (item->within[0] <= item->within[1]) return true;
  diag_report(r->d, DIAG_BAD_VALUE, deck_where(&item->item, "within"),
              "`within` is a smaller and a larger factor");
  return false;
}

static void read_item(const reader *r, const namelist_group *g) {
  exercise_item item = {.kind = 0};
  char words[40];
  const deck_group_info *info = exercise_grammar.groups[EXERCISE_GROUP_ITEM];
  deck_defaults(r->memory, info, &item);
  group_places(r->memory, g, &item.item);
  if (!group_keys_read(r->memory, g, info, &item, r->d)) return;
  snprintf(words, sizeof words, "an item '%s'", item_kind_names[item.kind]);
  const int count = (int)(sizeof uses_of_keys / sizeof *uses_of_keys);
  /* in the folder that students have, hidden items are without their files */
  item.withheld = item.hidden && !r->e->kept;
  if (!item.withheld &&
      (!deck_keys_fit(g, uses_of_keys, count, item.kind, words, r->d) ||
       !deck_keys_fit(g, uses_of_files,
                      item.kind == ITEM_PATH || item.kind == ITEM_RUN || item.kind == ITEM_ANSWERS,
                      item.kind, words, r->d)))
    return;
  item.value = namelist_find(g, "value");
  if (!read_seed(r, g, &item) || !check_words(r, &item) || !check_within(r, &item)) return;
  if (!item.withheld && !find_all_files(r, &item)) return;
  choose_defaults(r, g, &item);
  choose_title(r, &item);
  if (!item_is_public(&item) && item.kind != ITEM_HAND) {
    item.hidden = true;
    item.withheld = !r->e->kept;
  }
  r->e->items[r->e->item_count++] = item;
}

static void check_titles(const reader *r) {
  const exercise *e = r->e;
  for (int k = 0; k < e->item_count; k++)
    for (int q = 0; q < k; q++)
      if (strcmp(e->items[k].title, e->items[q].title) == 0) {
        diag_report(r->d, DIAG_DUPLICATE_NAME, e->items[k].item.where,
                    "two items have the title `%s`", name_shown(e->items[k].title));
        diag_note(r->d, e->items[q].item.where, "the other is here");
        diag_hint(r->d, "give each a `title` of its own");
      }
}

static void check_points(const reader *r, int file) {
  const exercise *e = r->e;
  long sum = 0;
  for (int k = 0; k < e->item_count; k++)
    sum += e->items[k].points;
  const span at = {0, 0, (uint16_t)file};
  if (e->item_count == 0) {
    diag_report(r->d, DIAG_MISSING_KEY, at, "there is no `&item`: nothing is judged");
    return;
  }
  if (sum == e->points) return;
  diag_report(r->d, DIAG_CONFLICT, e->item.where.end ? deck_where(&e->item, "points") : at,
              "the points of the items add up to %ld, not to %d", sum, e->points);
}

/* --- known answers ---------------------------------------------------------------------------- */

static void find_known(const reader *r, const char *kind, known_answer **known, int *count) {
  const exercise *e = r->e;
  const char **names;
  const char *folder = path_in(r->memory, e->folder, teacher);
  const char *pattern = arena_printf(r->memory, "%s/*.%s", kind, e->of_answers ? "txt" : "plm");
  folder_match(r->memory, folder, pattern, &names, count);
  *known = arena_alloc(r->memory, ((size_t)*count + 1) * sizeof **known);
  for (int k = 0; k < *count; k++) {
    const char *path = path_in(r->memory, folder, names[k]);
    (*known)[k] = (known_answer){path, names[k], leading_sentence(r->memory, path)};
  }
}

static void find_kept(const reader *r, int file) {
  exercise *e = r->e;
  const char *folder = path_in(r->memory, e->folder, teacher);
  const char *solution =
      path_in(r->memory, folder, e->of_answers ? "solution.txt" : "solution.plm");
  bool needed = false;
  for (int k = 0; k < e->item_count; k++)
    needed = needed || (e->items[k].hidden && !e->items[k].value && !e->items[k].like_count &&
                        e->items[k].kind != ITEM_CHECK);
  e->solution = is_ordinary_file(solution) ? solution : NULL;
  if (needed && !e->solution)
    diag_report(r->d, DIAG_FILE, (span){0, 0, (uint16_t)file},
                "there is no solution to judge by, `%s`", solution + strlen(e->folder) + 1);
  find_known(r, "equal", &e->equal, &e->equal_count);
  find_known(r, "wrong", &e->wrong, &e->wrong_count);
  for (int k = 0; k < e->wrong_count; k++)
    if (!*e->wrong[k].sentence) {
      diag_report(r->d, DIAG_FILE, (span){0, 0, (uint16_t)file},
                  "the known wrong answer `%s` does not say what is wrong with it",
                  e->wrong[k].name);
      diag_hint(r->d, "its first lines are comments: `! words for the student`");
    }
}

/* --- the whole -------------------------------------------------------------------------------- */

static void read_groups(const reader *r, const namelist *n) {
  static const char *const names[] = {"exercise", "item"};
  const namelist_group *first = NULL;
  for (int k = 0; k < n->group_count; k++) {
    const namelist_group *g = &n->groups[k];
    if (strcasecmp(g->name, "item") == 0) {
      read_item(r, g);
    } else if (strcasecmp(g->name, "exercise") != 0) {
      diag_report(r->d, DIAG_UNKNOWN_GROUP, g->where, "an exercise has no group `&%s`", g->name);
      deck_suggest(r->d, g->name, names, 2, "the groups are");
    } else if (first) {
      diag_report(r->d, DIAG_DUPLICATE_NAME, g->where, "an exercise has one `&exercise`");
      diag_note(r->d, first->where, "it is given here");
    } else {
      first = g;
      group_places(r->memory, g, &r->e->item);
      group_keys_read(r->memory, g, exercise_grammar.groups[EXERCISE_GROUP_EXERCISE], r->e, r->d);
    }
  }
}

/* The last part of the path, "05_memory" of "course/05_memory/". */
static const char *name_of(arena *a, const char *folder) {
  size_t end = strlen(folder);
  while (end > 1 && folder[end - 1] == '/')
    end--;
  size_t begin = end;
  while (begin > 0 && folder[begin - 1] != '/')
    begin--;
  return arena_text(a, folder + begin, end - begin);
}

exercise *exercise_read(arena *a, source_set *sources, const char *folder, diagnostics *d) {
  exercise *e = arena_alloc(a, sizeof *e);
  reader r = {a, sources, d, e};
  char error[4096];
  size_t length;
  char *whole = realpath(folder, NULL);
  *e = (exercise){.folder = whole ? arena_text(a, whole, strlen(whole)) : folder, .given = folder};
  free(whole);
  e->name = name_of(a, e->folder);
  e->file = path_in(a, folder, file_name);
  char *text = read_text_file(e->file, EXERCISE_LIMIT, &length, error, sizeof error);
  if (!text) {
    diag_report(d, DIAG_FILE, (span){0, 0, UINT16_MAX}, "%s", error);
    return NULL;
  }
  const int file = source_add(sources, e->file, text, length), errors = d->errors;
  free(text);
  e->kept = is_folder(path_in(a, e->folder, teacher));
  deck_defaults(a, exercise_grammar.groups[EXERCISE_GROUP_EXERCISE], e);
  const namelist *n = namelist_read(a, sources, file, d);
  e->items = arena_alloc(a, ((size_t)n->group_count + 1) * sizeof *e->items);
  read_groups(&r, n);
  if (!e->title) e->title = e->name;
  for (int k = 0; k < e->item_count; k++)
    e->of_answers = e->of_answers || e->items[k].kind == ITEM_ANSWERS;
  if (d->errors == errors && !n->broken) {
    check_titles(&r);
    check_points(&r, file);
    if (e->kept) find_kept(&r, file);
  }
  return d->errors == errors && !n->broken ? e : NULL;
}
