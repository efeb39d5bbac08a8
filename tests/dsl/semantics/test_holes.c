/* Holes `?`: wherever a value stands in a law of models/, a hole in its place is told, alone, with
   the unit and the shape that the value has, as far as the rest of the law tells them; and the law
   whose holes are filled again passes. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>
#include <dirent.h>
#include <stdlib.h>
#include <string.h>

#include "dsl/semantics/law_check.h"
#include "dsl/syntax/parse.h"

#define FOLDER SOURCE_DIR "/models/"
enum { MOST_PLACES = 4096, PATH_LONGEST = 4096 };

static char *read_file(const char *path, size_t *length) {
  FILE *f = fopen(path, "rb");
  if (!f) return NULL;
  fseek(f, 0, SEEK_END);
  *length = (size_t)ftell(f);
  rewind(f);
  char *content = must_calloc(*length + 1, 1);
  assert_int_equal(fread(content, 1, *length, f), *length);
  fclose(f);
  return content;
}

static char *read_beside(void *context, const char *name, const char *from, char **found) {
  (void)context;
  (void)from;
  char path[PATH_LONGEST];
  snprintf(path, sizeof path, "%s%s", FOLDER, name);
  size_t length;
  char *content = read_file(path, &length);
  if (content) *found = must_copy(name);
  return content;
}

typedef struct checked {
  arena *memory;
  source_set sources;
  diagnostics said;
  tree *tree;
  law *law;
} checked;

static void check_text(checked *c, const char *text) {
  static const parse_options options = {read_beside, NULL};
  memset(c, 0, sizeof *c);
  c->memory = arena_new();
  diag_begin(&c->said, &c->sources);
  const int file = source_add(&c->sources, "law.plm", text, strlen(text));
  c->tree = parse_model(c->memory, &c->sources, file, &options, &c->said);
  if (c->tree && !c->said.errors)
    c->law = law_check(c->memory, c->tree, &c->sources, NULL, 0, &c->said);
}

static void forget(checked *c) {
  diag_clear(&c->said);
  source_clear(&c->sources);
  arena_free(c->memory);
}

/* --- places where a value stands -------------------------------------------------------------- */

/* A value in a law: where, and what it is. */
typedef struct hole_place {
  span where;
  dimension dim;
  enum shape shape;
  bool zero; /* agrees with any */
} hole_place;

typedef struct places {
  const char *text;
  hole_place all[MOST_PLACES];
  int count;
} places;

static void add_places(places *p, const expr *e) {
  if (!e) return;
  const bool choice = e->kind == EXPR_NAME && e->symbol &&
                      (e->symbol->kind == SYMBOL_OPTION || e->symbol->kind == SYMBOL_CHOICE);
  assert_true(p->count < MOST_PLACES);
  const bool listed = e->kind == EXPR_CASES && p->text[e->where.begin] == '|'; /* not in brackets */
  if (e->where.file == 0 && !choice && !listed)
    p->all[p->count++] =
        (hole_place){e->where, e->dim, e->shape, e->kind == EXPR_NUMBER && e->number == 0};
  if (e->kind != EXPR_UNARY || e->unary != OP_COMPONENT) add_places(p, e->left);
  add_places(p, e->right);
  for (int k = 0; k < e->argument_count; k++)
    add_places(p, e->arguments[k].value);
  for (int k = 0; k < e->case_count; k++) {
    add_places(p, e->cases[k].value);
    add_places(p, e->cases[k].guard);
  }
}

/* The failure of points is cases that nobody wrote, as is the total of what has a rest state; the
   start of a tensor or a vector is no expression. */
static void add_places_of_law(places *p, const tree *t) {
  for (const stmt *s = t->first; s; s = s->next) {
    if (s->kind == STMT_REQUIRE || s->total) continue;
    if (s->failure)
      add_places(p, s->value->cases[0].guard);
    else if (!s->tensor && !s->vector)
      add_places(p, s->value);
    add_places(p, s->when);
  }
}

static const expr *find_hole(const expr *e) {
  if (!e || e->kind == EXPR_HOLE) return e;
  const expr *found = find_hole(e->left);
  found = found ? found : find_hole(e->right);
  for (int k = 0; k < e->argument_count && !found; k++)
    found = find_hole(e->arguments[k].value);
  for (int k = 0; k < e->case_count && !found; k++) {
    found = find_hole(e->cases[k].value);
    found = found ? found : find_hole(e->cases[k].guard);
  }
  return found;
}

static const expr *hole_of(const tree *t) {
  const expr *found = NULL;
  for (const stmt *s = t->first; s && !found; s = s->next) {
    found = find_hole(s->value);
    found = found ? found : find_hole(s->when);
  }
  return found;
}

/* --- the laws that come along ----------------------------------------------------------------- */

static char *with_hole(const char *text, span where) {
  char *changed = must_alloc(strlen(text) + 4);
  sprintf(changed, "%.*s(?)%s", (int)where.begin, text, text + where.end);
  return changed;
}

typedef struct tally {
  int holes, told;
} tally;

static bool is_like(const expr *hole, const hole_place *p) {
  return hole->shape == p->shape && (p->shape == SHAPE_LOGICAL || dim_equal(hole->dim, p->dim));
}

static void assert_told(const char *name, const char *text, const hole_place *p, tally *count) {
  char *changed = with_hole(text, p->where);
  checked c;
  check_text(&c, changed);
  const bool alone = c.said.count == 1 && c.said.items[0].code == DIAG_HOLE &&
                     c.said.items[0].where.begin == p->where.begin;
  if (!alone) {
    diag_print(&c.said, stderr);
    fail_msg("%s: a hole for `%.*s`: %d messages", name, (int)(p->where.end - p->where.begin),
             text + p->where.begin, c.said.count);
  }
  const expr *hole = hole_of(c.tree);
  assert_non_null(hole);
  count->holes++;
  count->told += !hole->open;
  if (!hole->open && !p->zero && !is_like(hole, p)) {
    diag_print(&c.said, stderr);
    fail_msg("%s: a hole for `%.*s` has another unit or shape", name,
             (int)(p->where.end - p->where.begin), text + p->where.begin);
  }
  forget(&c);
  free(changed);
}

static void holes_in_law(const char *name, tally *count) {
  char path[PATH_LONGEST];
  size_t length;
  snprintf(path, sizeof path, "%s%s", FOLDER, name);
  char *text = read_file(path, &length);
  checked whole;
  check_text(&whole, text);
  assert_non_null(whole.law);
  places *p = must_calloc(1, sizeof *p);
  p->text = text;
  add_places_of_law(p, whole.tree);
  for (int k = 0; k < p->count; k++)
    assert_told(name, text, &p->all[k], count);
  free(p);
  forget(&whole);
  free(text);
}

static int is_law(const struct dirent *entry) {
  const size_t length = strlen(entry->d_name);
  return length > 4 && strcmp(entry->d_name + length - 4, ".plm") == 0;
}

static void a_hole_anywhere_is_the_only_message(void **state) {
  (void)state;
  struct dirent **entries;
  const int count = scandir(FOLDER, &entries, is_law, alphasort);
  tally all = {0, 0}, general = {0, 0}; /* a factor of a general tensor may be of any shape */
  assert_true(count >= 20);
  for (int k = 0; k < count; k++) {
    const char *name = entries[k]->d_name;
    holes_in_law(name, strcmp(name, "correspondence.plm") == 0 ? &general : &all);
    free(entries[k]);
  }
  free(entries);
  print_message("%d holes, of %d the unit is told; with general tensors %d, of %d\n", all.holes,
                all.told, general.holes, general.told);
  assert_true(all.holes > 1000 && 10 * all.told > 9 * all.holes);
  assert_true(2 * general.told > general.holes);
}

/* --- filled ----------------------------------------------------------------------------------- */

#define BASE                                                                                       \
  "model answer\n  law central bond\n  for plane_stress\n  parameter E = 30 [GPa] in (0, inf)\n"   \
  "  parameter rho = 2323 [kg/m^3] in (0, inf)\n"

static int messages_of(const char *text, diag_code code) {
  checked c;
  check_text(&c, text);
  int found = 0;
  for (int k = 0; k < c.said.count; k++)
    found += c.said.items[k].code == code;
  assert_int_equal(found, c.said.count);
  forget(&c);
  return found;
}

static void a_law_whose_holes_are_filled_passes(void **state) {
  (void)state;
  assert_int_equal(messages_of(BASE "constant EA = ?\nforce N = ?\nend model\n", DIAG_HOLE), 2);
  assert_int_equal(messages_of(BASE "constant EA = sqrt(3)/2*E*s*t\nforce N = EA*stretch\n"
                                    "end model\n",
                               DIAG_HOLE),
                   0);
}

/* What stands beside holes is judged as ever: a length is not a number. */
static void the_rest_is_checked(void **state) {
  (void)state;
  checked c;
  check_text(&c, BASE "constant EA = ?\nx = s + stretch\nforce N = EA*stretch + ?*x\nend model\n");
  assert_int_equal(c.said.count, 3);
  assert_int_equal(c.said.errors, 3);
  int units = 0;
  for (int k = 0; k < c.said.count; k++)
    units += c.said.items[k].code == DIAG_UNITS;
  assert_int_equal(units, 1);
  forget(&c);
}

/* A unit behind the hole is its unit. */
static void a_hole_may_say_its_unit(void **state) {
  (void)state;
  checked c;
  check_text(&c, BASE "constant EA = ? [mm]\nforce N = EA*stretch\nend model\n");
  assert_int_equal(c.said.count, 2);
  forget(&c);
  assert_int_equal(
      messages_of(BASE "constant EA = ? [kN]\nforce N = EA*stretch\nend model\n", DIAG_HOLE), 1);
}

/* What is wrong beside a hole tells nothing of it. */
static void errors_tell_nothing(void **state) {
  (void)state;
  checked c;
  check_text(&c, BASE "constant EA = ?\nforce N = EA*strech\nend model\n");
  assert_int_equal(c.said.count, 2);
  assert_true(hole_of(c.tree)->open);
  forget(&c);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(a_hole_anywhere_is_the_only_message),
      cmocka_unit_test(a_law_whose_holes_are_filled_passes), cmocka_unit_test(the_rest_is_checked),
      cmocka_unit_test(a_hole_may_say_its_unit), cmocka_unit_test(errors_tell_nothing)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
