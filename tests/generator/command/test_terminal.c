#define _GNU_SOURCE /* nftw, posix_openpt */
/* What a terminal shows: lines cut around the caret, which stays under its place; colours where
   they are wanted; the line of progress; and nothing that a file would have the terminal do. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "dsl/base/characters.h"
#include "tests/generator/command/pseudo_terminal.h"
#include "tests/runtime/small_result.h"

/* --- messages --------------------------------------------------------------------------------- */

/* Tabs, and three slips: at the beginning of a line, in the middle of a long one, at its end. */
static const char faulty_law[] =
    "model softening\n"
    "  law central bond\n"
    "  parameter k   = 50 [MN]  in (0, inf)  \"stiffness\"\n"
    "  parameter rho = 2323 [kg/m^3]\n"
    "\ta = strech1*k + k*stretch + k*strech2 + k*stretch +\tk*stretch + k*strech3\n"
    "\tforce N = a\n"
    "end model\n";

/* Columns that a terminal takes for the first `length` bytes of a line. */
static int columns_of(const char *line, size_t length) {
  int column = 0;
  for (size_t i = 0; i < length;) {
    const shown_character c = character_shown(line + i, length - i);
    column += *c.text == '\t' ? 8 - column % 8 : c.columns;
    i += c.length;
  }
  return column;
}

/* Each quoted line fits, and its caret stands under `slip`, of which there are so many. */
static void carets_stand_under(const char *said, const char *slip, int columns, int wanted) {
  int found = 0;
  for (const char *line = said; *line; line += strcspn(line, "\n") + (strchr(line, '\n') != NULL)) {
    const size_t length = strcspn(line, "\r\n");
    const char *bar = memchr(line, '|', length), *at = strstr(line, slip);
    if (!bar || !at || at > line + length) continue;
    if (strspn(line, " 0123456789") != (size_t)(bar - line)) continue; /* no quoted line */
    const char *below = strchr(line, '\n') + 1, *caret = strchr(below, '^');
    assert_non_null(caret);
    if (columns_of(below, (size_t)(caret - below)) != columns_of(line, (size_t)(at - line)))
      continue; /* another slip of this line is meant */
    found++;
    if (columns > 0 && columns_of(line, length) > columns)
      fail_msg("wider than %d columns:\n%s", columns, said);
  }
  if (found != wanted) fail_msg("`%s` is not marked in %d columns:\n%s", slip, columns, said);
}

static void carets_stay_in_place(void **state) {
  workplace *w = *state;
  write_text(w, "law.plm", faulty_law);
  static const int widths[] = {30, 50, 60, 80, 100, 200};
  for (size_t k = 0; k < sizeof widths / sizeof *widths; k++) {
    char *said = on_terminal(w, widths[k], "TERM=xterm NO_COLOR=1", "$P check law.plm");
    carets_stand_under(said, "strech1", widths[k], 1);
    carets_stand_under(said, "strech2", widths[k], 1);
    carets_stand_under(said, "strech3", widths[k], 1);
    free(said);
  }
  assert_int_equal(shell(w, "$P check law.plm"), 1);
  assert_null(strstr(w->said, "..."));
  carets_stand_under(w->said, "strech3", 0, 1);
}

/* One line for each width of characters before the slip. */
static void wide_characters_and_tabs_move_the_caret(void **state) {
  workplace *w = *state;
  static const char *const before[] = {
      "\t",       "\t\t", " \t ",        "\xe6\x97\xa5\xe6\x9c\xac", "e\xcc\x81\xcc\x81", "\x1b[5m",
      "\xc2\x9b", "\xff", "\xe2\x80\xae"};
  for (size_t k = 0; k < sizeof before / sizeof *before; k++) {
    char text[400];
    snprintf(text, sizeof text,
             "model m\n  law central bond\n  parameter rho = 1 [kg/m^3]\n"
             "  nonconservative \"%s\" strech\n  force N = 1 [N]*stretch\nend model\n",
             before[k]);
    write_text(w, "law.plm", text);
    for (int columns = 30; columns <= 90; columns += 20) {
      char *said = on_terminal(w, columns, "TERM=xterm NO_COLOR=1", "$P check law.plm");
      carets_stand_under(said, "strech", columns, 1);
      assert_null(strchr(said, '\x1b'));
      free(said);
    }
    assert_int_equal(shell(w, "$P check law.plm"), 1);
    carets_stand_under(w->said, "strech", 0, 1);
  }
}

static void colours_are_asked_for(void **state) {
  workplace *w = *state;
  write_text(w, "law.plm", faulty_law);
  static const struct {
    const char *settings;
    bool coloured;
  } cases[] = {{"TERM=xterm", true},
               {"TERM=xterm NO_COLOR=", true},
               {"TERM=xterm NO_COLOR=1", false},
               {"TERM=xterm NO_COLOR=0", false},
               {"TERM=dumb", false},
               {"TERM=", false}};
  for (size_t k = 0; k < sizeof cases / sizeof *cases; k++) {
    char *said = on_terminal(w, 80, cases[k].settings, "$P check law.plm");
    if ((strstr(said, "\033[1;31merror\033[0m: ") != NULL) != cases[k].coloured ||
        (strchr(said, '\033') != NULL) != cases[k].coloured)
      fail_msg("%s:\n%s", cases[k].settings, said);
    free(said);
  }
  assert_int_equal(shell(w, "TERM=xterm $P check law.plm"), 1);
  assert_null(strchr(w->said, '\033'));
}

static void help_is_named_once(void **state) {
  workplace *w = *state;
  write_text(w, "law.plm", faulty_law);
  assert_int_equal(shell(w, "$P check law.plm"), 1);
  const char *named = strstr(w->said, "`perilat help ");
  assert_non_null(named);
  assert_null(strstr(named + 1, "`perilat help "));
  assert_non_null(strstr(named, " unknown-name"));
  assert_string_equal(strchr(named, '\n'), "\n"); /* the last line */
  assert_int_equal(shell(w, "$P help units closed-path"), 0);
  assert_non_null(strstr(w->said, "units (a message)"));
  assert_non_null(strstr(w->said, "closed-path (a message)"));
  assert_int_equal(shell(w, "$P check --diagnostics=json law.plm"), 1);
  assert_null(strstr(w->said, "perilat help"));
  assert_int_equal(shell(w, "$P check beam.nml"), 0);
  assert_null(strstr(w->said, "perilat help"));
}

/* --- progress --------------------------------------------------------------------------------- */

static const char watched_deck[] =
    "&simulation  end_time = '0.2 ms'  /\n" SMALL_BEAM
    "&monitor name = 'the_displacement_of_the_loader_far_to_the_right'  kind = 'displacement'  "
    "region = 'loader'  component = 'x'  /\n"
    "&monitor name = 'the_displacement_of_the_loader_up_and_down_again'  kind = 'displacement'  "
    "region = 'loader'  component = 'y'  /\n";

static void progress_keeps_to_its_line(void **state) {
  workplace *w = *state;
  write_text(w, "watched.nml", watched_deck);
  for (int columns = 10; columns <= 200; columns += 30) {
    char *said = on_terminal(w, columns, "TERM=xterm", "$P run watched.nml");
    int shown = 0;
    for (const char *at = strstr(said, "\033[K"); at; at = strstr(at + 3, "\033[K")) {
      const char *begin = at;
      while (begin > said && begin[-1] != '\r')
        begin--;
      shown += at > begin;
      if (at - begin >= columns || memchr(begin, '\n', (size_t)(at - begin)))
        fail_msg("%d columns:\n%s", columns, said);
    }
    assert_true(shown > 0);
    free(said);
  }
  char *plain = on_terminal(w, 100, "TERM=dumb", "$P run watched.nml");
  assert_null(strchr(plain, '\033'));
  free(plain);
}

/* --- what files hold -------------------------------------------------------------------------- */

static const char hostile_law[] =
    "!> The law \x1b]0;title\x07 of\nmodel hostile\n  law central bond\n"
    "  parameter rho = 2323 [kg/m^3] \"\x1b[31mdensity \xc2\x9b"
    "5m \xe2\x80\xae rtl \xff\"\n"
    "  parameter E = 30 [GPa] \"\x1b[2J\"\n"
    "  option way = a | b \"\x1b[5m\"\n"
    "  output x = | stretch when way == a | 2*stretch otherwise \"\x1b[6m\"\n"
    "  nonconservative \"\x1b[7m because\"\n"
    "  force N = E*area*stretch\nend model\n";

static void write_hostile_result(const workplace *w) {
  char path[400], error[1024];
  snprintf(path, sizeof path, "%s", in_workplace(w, "hostile.h5"));
  result_header h = small_header(path);
  const result_field fields[] = {
      {"u\x1b[31m", "m\x1b[5m", NULL, 2, PARTICLES, "other", NULL},
      {"om\x1b[5mega", "1", "\x1b[7mconcrete", 1, BONDS, "damage", NULL}};
  h.title = "\x1b]0;title\x07";
  h.overrides = "simulation.title='\x1b[31m'\n";
  const result_bonds bonds = {"\x1b[7mconcrete", BONDS, h.bonds->pairs};
  h.bonds = &bonds;
  h.fields = fields;
  result *r = small_begin(&h, error, sizeof error);
  assert_non_null(r);
  double u[2 * PARTICLES], omega[BONDS], t[] = {0, 1, 2};
  small_frame(0, u, omega);
  assert_true(result_frame(r, 0, (const double *const[]){u, omega}, error, sizeof error));
  const result_series series[] = {{.name = "load\x1b[31m", .unit = "N\x1b[32m", .values = t},
                                  {.name = "two\nperilat: error: lines", .unit = "m", .values = t},
                                  {.name = "\xe2\x80\xae\xc2\x9b",
                                   .unit = "a,\"b\"\n",
                                   .values = t,
                                   .judges = true,
                                   .unchecked = "\x1b[35mwhy\n"}};
  const result_ending e = {.ended = "\x1b[31mat the end",
                           .dt = 0.1,
                           .steps = 3,
                           .time = t,
                           .history_count = 3,
                           .series = series,
                           .series_count = 3};
  assert_true(result_finish(r, &e, error, sizeof error));
  result_close(r);
}

static void holds_no_command(const char *line, const char *said) {
  static const char *const commands[] = {"\x1b", "\x07", "\xc2\x9b", "\xe2\x80\xae",
                                         "\nperilat: error: lines"};
  for (size_t k = 0; k < sizeof commands / sizeof *commands; k++)
    if (strstr(said, commands[k])) fail_msg("%s shows %zu:\n%s", line, k, said);
}

static void files_command_no_terminal(void **state) {
  workplace *w = *state;
  write_text(w, "hostile.plm", hostile_law);
  write_hostile_result(w);
  static const char *const lines[] = {
      "$P check hostile.plm",
      "$P info hostile.plm",
      "$P explain hostile.plm",
      "$P explain --latex hostile.plm",
      "$P check --dump=tree hostile.plm",
      "$P check --dump=ir hostile.plm",
      "$P check --dump=passes hostile.plm",
      "$P check --dump=c hostile.plm",
      "$P info hostile.h5",
      "$P compare hostile.h5 hostile.h5",
      "$P export hostile.h5 --history nothing",
      "$P export hostile.h5 --frame 0 --field nothing",
      "$P plot hostile.h5 --y nothing",
      "$P plot hostile.h5 --map nothing",
      "$P plot hostile.h5 --y \"$(printf 'load\\033[31m')\" --x-unit m"};
  for (size_t k = 0; k < sizeof lines / sizeof *lines; k++) {
    assert_true(shell(w, "%s", lines[k]) <= 1);
    holds_no_command(lines[k], w->said);
    char *shown = on_terminal(w, 80, "TERM=xterm NO_COLOR=1", lines[k]);
    holds_no_command(lines[k], shown);
    free(shown);
  }
}

/* As a file they are what they were; a terminal is shown no command of theirs. */
static void data_keep_their_own_form(void **state) {
  workplace *w = *state;
  write_text(w, "hostile.plm", hostile_law);
  write_hostile_result(w);
  assert_int_equal(shell(w, "$P export hostile.h5"), 0);
  assert_non_null(strstr(w->said,
                         "time [s],load\x1b[31m [N\x1b[32m],\"two\nperilat: error: lines [m]\","
                         "\"\xe2\x80\xae\xc2\x9b [a,\"\"b\"\"\n]\"\n0,0,0,0\n"));
  assert_int_equal(shell(w, "$P format hostile.plm"), 0);
  assert_non_null(strstr(w->said, "\"\x1b[31mdensity \xc2\x9b"
                                  "5m \xe2\x80\xae rtl \xff\""));
  assert_int_equal(shell(w, "$P info --json hostile.plm"), 0);
  assert_non_null(strstr(w->said, "\"\\u001b[31mdensity \xc2\x9b"
                                  "5m \xe2\x80\xae rtl \xef\xbf\xbd\""));
  static const char *const lines[] = {"$P export hostile.h5", "$P format hostile.plm",
                                      "$P info --json hostile.plm",
                                      "$P check --diagnostics=json hostile.plm"};
  for (size_t k = 0; k < sizeof lines / sizeof *lines; k++) {
    char *shown = on_terminal(w, 80, "TERM=xterm", lines[k]);
    static const char *const commands[] = {"\x1b", "\x07", "\xc2\x9b", "\xe2\x80\xae"};
    for (size_t c = 0; c < sizeof commands / sizeof *commands; c++)
      if (strstr(shown, commands[c])) fail_msg("%s:\n%s", lines[k], shown);
    free(shown);
  }
}

#define T(test) cmocka_unit_test_setup_teardown(test, set_up_workplace, tear_down_workplace)

int main(void) {
  const struct CMUnitTest tests[] = {
      T(carets_stay_in_place),       T(wide_characters_and_tabs_move_the_caret),
      T(colours_are_asked_for),      T(help_is_named_once),
      T(progress_keeps_to_its_line), T(files_command_no_terminal),
      T(data_keep_their_own_form),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
