/* Fortran's own namelist reader reads every deck and path that comes along, to the same values: a
   reader is written from the tables of groups and keys, compiled by gfortran, and what it prints is
   compared with what perilat reads. What has a unit, is a name or a choice it declares as text. */
#define _GNU_SOURCE
#include <setjmp.h>
#include <stdarg.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include <ctype.h>
#include <glob.h>
#include <strings.h>

#include "generator/drive/drive_grammar.h"
#include "generator/exercise/exercise_grammar.h"
#include "generator/kernel/model.h"
#include "runtime/base/namelist.h"
#include "runtime/deck/deck_groups.h"
#include "tests/generator/command_tools.h"

enum { MOST_DECKS = 200, MOST_OWN = 100, MOST_VALUES = 100 };

/* --- the decks -------------------------------------------------------------------------------- */

typedef struct text_of_deck {
  const char *path;
  source_set sources;
  namelist *groups;
} text_of_deck;

typedef struct collection {
  const deck_grammar *grammar;
  arena *memory;
  text_of_deck decks[MOST_DECKS];
  int count;
} collection;

static void add_deck(collection *c, const char *path) {
  char error[1000];
  size_t length;
  diagnostics d;
  assert_true(c->count < MOST_DECKS);
  text_of_deck *k = &c->decks[c->count++];
  char *text = read_text_file(path, NAMELIST_LARGEST_TEXT, &length, error, sizeof error);
  assert_non_null(text);
  diag_begin(&d, &k->sources);
  k->path = arena_text(c->memory, path, strlen(path));
  k->groups =
      namelist_read(c->memory, &k->sources, source_add(&k->sources, path, text, length), &d);
  assert_int_equal(d.count, 0);
  diag_clear(&d);
  free(text);
}

static void add_decks(collection *c, const char *pattern) {
  glob_t found;
  assert_int_equal(glob(pattern, 0, NULL, &found), 0);
  for (size_t k = 0; k < found.gl_pathc; k++)
    add_deck(c, found.gl_pathv[k]);
  globfree(&found);
}

/* Files of the course that hold such a group: decks, paths and exercises stand side by side
   there. */
static void add_of_course(collection *c, const char *group) {
  static const char *const patterns[] = {SOURCE_DIR "/examples/course/*/*.nml",
                                         SOURCE_DIR "/examples/course/*/teacher/hidden/*.nml"};
  for (size_t p = 0; p < sizeof patterns / sizeof *patterns; p++) {
    glob_t found;
    assert_int_equal(glob(patterns[p], 0, NULL, &found), 0);
    for (size_t k = 0; k < found.gl_pathc; k++) {
      char error[1000];
      size_t length;
      char *text =
          read_text_file(found.gl_pathv[k], NAMELIST_LARGEST_TEXT, &length, error, sizeof error);
      assert_non_null(text);
      if (strstr(text, group)) add_deck(c, found.gl_pathv[k]);
      free(text);
    }
    globfree(&found);
  }
}

static void let_go(collection *c) {
  for (int k = 0; k < c->count; k++)
    source_clear(&c->decks[k].sources);
  arena_free(c->memory);
}

/* --- types ------------------------------------------------------------------------------------ */

typedef enum fortran_type { TEXT, REAL, INTEGER, LOGICAL } fortran_type;

typedef struct variable {
  const char *name;
  fortran_type type;
} variable;

/* As the reference says it. */
static fortran_type type_of(const deck_key_info *key) {
  switch (key->type) {
  case DECK_COUNT:
    return INTEGER;
  case DECK_LOGICAL:
    return LOGICAL;
  case DECK_DIRECTION:
    return REAL;
  default:
    return key->unit && strcmp(key->unit, "1") == 0 ? REAL : TEXT;
  }
}

static bool is_identifier(const char *name) {
  for (const char *c = name; *c; c++)
    if (!isalnum((unsigned char)*c) && *c != '_') return false;
  return true;
}

static int variable_find(const variable *list, int count, const char *name) {
  for (int k = 0; k < count; k++)
    if (strcasecmp(list[k].name, name) == 0) return k;
  return -1;
}

/* Keys of laws: text where some deck gives a unit. */
static void add_own_keys(const collection *c, const namelist_group *g, variable *list, int *count) {
  for (int k = 0; k < g->key_count; k++) {
    const namelist_value *v = &g->keys[k].values[0];
    int at = variable_find(list, *count, g->keys[k].name);
    if (at < 0) {
      assert_true(*count < MOST_OWN);
      at = (*count)++;
      list[at] = (variable){arena_text(c->memory, g->keys[k].name, strlen(g->keys[k].name)), REAL};
    }
    if (v->kind == NAMELIST_TEXT) list[at].type = TEXT;
  }
}

/* The variables of a group: its keys, and in an open one those that the decks give. */
static int variables_of(const collection *c, const deck_group_info *info, variable *list) {
  int count = 0;
  for (int k = 0; k < info->key_count; k++)
    if (is_identifier(info->keys[k].name))
      list[count++] = (variable){info->keys[k].name, type_of(&info->keys[k])};
  for (int d = 0; info->open && d < c->count; d++)
    for (int g = 0; g < c->decks[d].groups->group_count; g++)
      if (strcmp(c->decks[d].groups->groups[g].name, info->name) == 0)
        add_own_keys(c, &c->decks[d].groups->groups[g], list, &count);
  return count;
}

/* Not so of an open group that no deck has. */
static bool has_variables(const collection *c, const deck_group_info *info) {
  variable list[DECK_MOST_KEYS + MOST_OWN];
  return variables_of(c, info, list) > 0;
}

/* --- the reader in Fortran -------------------------------------------------------------------- */

static const struct {
  const char *declaration, *unset, *kind;
} fortran[] = {[TEXT] = {"character(text_width)", "achar(0)", "text"},
               [REAL] = {"double precision", "-huge(1d0)", "real"},
               [INTEGER] = {"integer", "-huge(1)", "integer"},
               [LOGICAL] = {"logical", ".false.", "logical"}};

/* Every variable is a list: what a deck leaves out stays unset. */
static void write_group(FILE *out, const collection *c, const deck_group_info *info) {
  variable list[DECK_MOST_KEYS + MOST_OWN];
  const int count = variables_of(c, info, list);
  fprintf(out, "subroutine read_%s()\n  integer :: reading_status, reading_number\n", info->name);
  for (int k = 0; k < count; k++)
    fprintf(out, "  %s :: %s(%d)\n", fortran[list[k].type].declaration, list[k].name, MOST_VALUES);
  for (int k = 0; k < count; k++)
    fprintf(out, k ? ", %s" : "  namelist /%s/ %s", k ? list[k].name : info->name, list[0].name);
  fputs("\n  rewind(10)\n  reading_number = 0\n  do\n", out);
  for (int k = 0; k < count; k++)
    fprintf(out, "    %s = %s\n", list[k].name, fortran[list[k].type].unset);
  fprintf(out,
          "    read (10, nml=%s, iostat=reading_status, iomsg=reading_message)\n"
          "    if (reading_status < 0) exit\n"
          "    if (reading_status > 0) call refuse('%s')\n"
          "    reading_number = reading_number + 1\n"
          "    write (*, '(a,1x,i0)') '&%s', reading_number\n",
          info->name, info->name, info->name);
  for (int k = 0; k < count; k++)
    fprintf(out, "    call put_%s('%s', %s)\n", fortran[list[k].type].kind, list[k].name,
            list[k].name);
  fputs("  end do\nend subroutine\n\n", out);
}

static const char module_head[] =
    "module decks\n"
    "  implicit none\n"
    "  integer, parameter :: text_width = 1000\n"
    "  character(text_width) :: reading_message\n"
    "contains\n"
    "subroutine refuse(group)\n"
    "  character(*) :: group\n"
    "  write (*, '(4a)') 'refused &', group, ': ', trim(reading_message)\n"
    "  stop 1\n"
    "end subroutine\n"
    "subroutine put_text(name, values)\n"
    "  character(*) :: name, values(:)\n"
    "  integer :: k\n"
    "  do k = 1, size(values)\n"
    "    if (values(k)(1:1) /= achar(0)) write (*, '(5a)') name, ' = ', trim(values(k))\n"
    "  end do\n"
    "end subroutine\n"
    "subroutine put_real(name, values)\n"
    "  character(*) :: name\n"
    "  double precision :: values(:)\n"
    "  integer :: k\n"
    "  do k = 1, size(values)\n"
    "    if (values(k) > -huge(1d0)) write (*, '(2a,es25.16e3)') name, ' = ', values(k)\n"
    "  end do\n"
    "end subroutine\n"
    "subroutine put_integer(name, values)\n"
    "  character(*) :: name\n"
    "  integer :: values(:), k\n"
    "  do k = 1, size(values)\n"
    "    if (values(k) > -huge(1)) write (*, '(2a,i0)') name, ' = ', values(k)\n"
    "  end do\n"
    "end subroutine\n"
    "subroutine put_logical(name, values)\n" /* .false. is what was set before */
    "  character(*) :: name\n"
    "  logical :: values(:)\n"
    "  if (values(1)) write (*, '(2a)') name, ' = T'\n"
    "end subroutine\n\n";

static void write_reader(workplace *w, const collection *c) {
  FILE *out = fopen(in_workplace(w, "read_decks.f90"), "w");
  assert_non_null(out);
  fputs(module_head, out);
  for (int g = 0; g < c->grammar->group_count; g++)
    if (has_variables(c, c->grammar->groups[g])) write_group(out, c, c->grammar->groups[g]);
  fputs("end module\n\nprogram read_decks\n  use decks\n  implicit none\n"
        "  character(text_width) :: path\n  call get_command_argument(1, path)\n"
        "  open (10, file=path, status='old', action='read')\n",
        out);
  for (int g = 0; g < c->grammar->group_count; g++)
    if (has_variables(c, c->grammar->groups[g]))
      fprintf(out, "  call read_%s()\n", c->grammar->groups[g]->name);
  fputs("end program\n", out);
  assert_int_equal(fclose(out), 0);
  if (shell(w, "gfortran -O0 -ffree-line-length-none read_decks.f90 -o read_decks"))
    fail_msg("gfortran refuses the reader: %s", w->said);
}

/* --- what is read ----------------------------------------------------------------------------- */

static const char *next_line(const char **at, char *line, size_t size) {
  const size_t length = strcspn(*at, "\n");
  snprintf(line, size, "%.*s", (int)length, *at);
  *at += length + ((*at)[length] == '\n');
  return line;
}

static void expect_read(const text_of_deck *k, const char *line, const variable *v,
                        const namelist_value *value) {
  char text[2000];
  const size_t head = (size_t)snprintf(text, sizeof text, "%s = ", v->name);
  bool same = strncmp(line, text, head) == 0;
  const char *found = line + head;
  if (value->kind == NAMELIST_TEXT) {
    const size_t length = strlen(found); /* Fortran's texts end in blanks */
    same = same && strncmp(found, value->text, length) == 0 &&
           strspn(value->text + length, " ") == strlen(value->text + length);
  } else if (value->kind == NAMELIST_NUMBER) /* in text, too */
    same = same && *found && strtod(found, NULL) == value->number;
  else
    same = same && strcmp(found, "T") == 0;
  if (!same) fail_msg("%s: Fortran reads `%s` where the deck has %s", k->path, line, text);
}

static void expect_group(const text_of_deck *k, const char **said, const namelist_group *g,
                         const variable *list, int count) {
  char line[2000];
  int seen = 0;
  for (int v = 0; v < count; v++) {
    const namelist_key *key = namelist_find(g, list[v].name);
    seen += key != NULL;
    for (int n = 0; key && n < key->value_count; n++)
      if (key->values[n].kind != NAMELIST_LOGICAL || key->values[n].logical)
        expect_read(k, next_line(said, line, sizeof line), &list[v], &key->values[n]);
  }
  if (seen != g->key_count) fail_msg("%s: a key of &%s is in no table", k->path, g->name);
}

static void expect_deck(workplace *w, const collection *c, const text_of_deck *k) {
  char line[2000], head[100];
  if (shell(w, "./read_decks '%s'", k->path)) fail_msg("%s: %s", k->path, w->said);
  const char *said = w->said;
  int groups = 0;
  for (int t = 0; t < c->grammar->group_count; t++) {
    const deck_group_info *info = c->grammar->groups[t];
    variable list[DECK_MOST_KEYS + MOST_OWN];
    const int count = variables_of(c, info, list);
    int number = 0;
    for (int g = 0; g < k->groups->group_count; g++) {
      if (strcmp(k->groups->groups[g].name, info->name) != 0) continue;
      snprintf(head, sizeof head, "&%s %d", info->name, ++number);
      if (strcmp(next_line(&said, line, sizeof line), head) != 0)
        fail_msg("%s: Fortran says `%s`, not %s", k->path, line, head);
      expect_group(k, &said, &k->groups->groups[g], list, count);
      groups++;
    }
  }
  assert_int_equal(groups, k->groups->group_count);
  if (*said) fail_msg("%s: Fortran reads more: %s", k->path, said);
}

static void expect_decks(workplace *w, const collection *c) {
  write_reader(w, c);
  for (int k = 0; k < c->count; k++)
    expect_deck(w, c, &c->decks[k]);
}

static void skip_without_compiler(workplace *w) {
  if (shell(w, "command -v gfortran") == 0) return;
  puts("gfortran is not installed: decks are not read by Fortran");
  skip();
}

static void fortran_reads_every_deck(void **state) {
  workplace *w = *state;
  skip_without_compiler(w);
  collection c = {.grammar = &deck_grammar_of_decks, .memory = arena_new()};
  add_decks(&c, SOURCE_DIR "/examples/*/*.nml");
  add_of_course(&c, "\n&lattice");
  add_deck(&c, SOURCE_DIR "/generator/templates/deck.nml");
  write_text(w, "force.nml",
             "&force region = 'a' total = '2 kN' times = 0, '1 s', 1.5 /\n"
             "&notch cut_bonds = .false. points = '1 m', 2*3 /\n"
             "&notch cut_bonds = T corner = 1.25, '-1 mm' /\n");
  add_deck(&c, in_workplace(w, "force.nml"));
  assert_true(c.count > 30);
  expect_decks(w, &c);
  let_go(&c);
}

static void fortran_reads_every_path(void **state) {
  workplace *w = *state;
  skip_without_compiler(w);
  collection c = {.grammar = &drive_grammar, .memory = arena_new()};
  add_decks(&c, SOURCE_DIR "/models/drives/*.nml");
  add_of_course(&c, "\n&path");
  add_deck(&c, SOURCE_DIR "/generator/templates/drive.nml");
  assert_true(c.count > 10);
  expect_decks(w, &c);
  let_go(&c);
}

static void fortran_reads_every_exercise(void **state) {
  workplace *w = *state;
  skip_without_compiler(w);
  collection c = {.grammar = &exercise_grammar, .memory = arena_new()};
  add_of_course(&c, "\n&exercise");
  assert_true(c.count > 6);
  expect_decks(w, &c);
  let_go(&c);
}

/* A namelist and a variable in it cannot share a name. */
static void no_key_is_named_like_its_group(void **state) {
  (void)state;
  const deck_grammar *const grammars[] = {&deck_grammar_of_decks, &drive_grammar,
                                          &exercise_grammar};
  for (size_t f = 0; f < sizeof grammars / sizeof *grammars; f++)
    for (int g = 0; g < grammars[f]->group_count; g++) {
      const deck_group_info *info = grammars[f]->groups[g];
      for (int k = 0; k < info->key_count; k++)
        assert_int_not_equal(strcasecmp(info->keys[k].name, info->name), 0);
    }
}

int main(void) {
#define T(test) cmocka_unit_test_setup_teardown(test, set_up_workplace, tear_down_workplace)
  const struct CMUnitTest tests[] = {
      T(fortran_reads_every_deck),
      T(fortran_reads_every_path),
      T(fortran_reads_every_exercise),
      cmocka_unit_test(no_key_is_named_like_its_group),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
