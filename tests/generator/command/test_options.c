/* The table of options is what --help, suggestions, manual and completion show: each command takes
   exactly what its rows say, and every option that the sources ask for has a row. */
#define _GNU_SOURCE
#include <setjmp.h>
#include <stdarg.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include <ctype.h>
#include <errno.h>
#include <glob.h>
#include <sys/syscall.h>

#include "generator/command/commands.h"
#include "generator/command/completion.h"
#include "generator/command/manual.h"
#include "tests/generator/command_tools.h"

static bool disk_fails;

int fsync(int file) {
  if (!disk_fails) return (int)syscall(SYS_fsync, file);
  errno = EIO;
  return -1;
}

static bool is_solver(const option_entry *o) {
  return strcmp(o->command, "solver") == 0;
}

static void every_command_takes_its_options(void **state) {
  workplace *w = *state;
  for (int k = 0; k < option_count; k++) {
    const option_entry *o = &option_table[k];
    if (is_solver(o)) continue;
    shell(w, "$P %s %s%s", o->command, o->name, *o->value ? " 1" : "");
    if (strstr(w->said, "has no option"))
      fail_msg("perilat %s refuses %s: %s", o->command, o->name, w->said);
    shell(w, "$P %s %s", o->command, o->name); /* at the end of the line */
    if ((strstr(w->said, "needs a value") != NULL) != (*o->value != 0))
      fail_msg("perilat %s %s: the table has the value `%s`, but it said: %s", o->command, o->name,
               o->value, w->said);
  }
}

static void options_of_others_are_refused(void **state) {
  workplace *w = *state;
  for (int c = 0; c < command_count; c++) {
    const char *command = command_table[c].name;
    if (!command_has_options(command)) continue;
    for (int k = 0; k < option_count; k++) {
      bool own = false;
      for (int o = 0; o < option_count; o++)
        own = own || (!strcmp(option_table[o].command, command) &&
                      !strcmp(option_table[o].name, option_table[k].name));
      if (own || (k && !strcmp(option_table[k].name, option_table[k - 1].name))) continue;
      int status = shell(w, "$P %s %s 1", command, option_table[k].name);
      if (status != 1 || !strstr(w->said, "has no option"))
        fail_msg("perilat %s takes %s, which has no row: %s", command, option_table[k].name,
                 w->said);
    }
  }
}

/* Options asked for by option_flag, option_value or a relative of theirs. */
static int check_source(const char *path) {
  char line[2000];
  int found = 0;
  FILE *in = fopen(path, "r");
  assert_non_null(in);
  while (fgets(line, sizeof line, in)) {
    if (!strstr(line, "option_flag(") && !strstr(line, "option_value(") &&
        !strstr(line, "special_value("))
      continue;
    char *name = strstr(line, ", \"-"), *end = name ? strchr(name + 3, '"') : NULL;
    if (!end) continue;
    *end = 0;
    bool known = false;
    for (int k = 0; k < option_count; k++)
      known = known || strcmp(option_table[k].name, name + 3) == 0;
    if (!known) fail_msg("%s asks for %s, which is not in the table of options", path, name + 3);
    found++;
  }
  fclose(in);
  return found;
}

static void every_option_in_the_sources_has_a_row(void **state) {
  (void)state;
  glob_t sources;
  int found = 0;
  assert_int_equal(glob(SOURCE_DIR "/generator/command/command_*.c", 0, NULL, &sources), 0);
  for (size_t k = 0; k < sources.gl_pathc; k++)
    found += check_source(sources.gl_pathv[k]);
  globfree(&sources);
  assert_true(found >= 40);
}

static void help_shows_every_option(void **state) {
  workplace *w = *state;
  for (int k = 0; k < option_count; k++) {
    if (is_solver(&option_table[k])) continue;
    char wanted[300], topic[100];
    snprintf(wanted, sizeof wanted, "  %s %s", option_table[k].name, option_table[k].value);
    snprintf(topic, sizeof topic, "%s --help", option_table[k].command);
    expect(w, topic, 0, wanted);
    expect(w, topic, 0, option_table[k].meaning);
    snprintf(topic, sizeof topic, "help %s", option_table[k].command);
    expect(w, topic, 0, wanted);
  }
}

static void help_on_nothing_lists_the_topics(void **state) {
  workplace *w = *state;
  static const char *const listed[] = {
      "did you mean `drive`?",  "commands: new check", "groups of decks: simulation",
      "words of the language:", " otherwise",          "units: rest_stretch total_stretch",
      " unknown-name"};
  for (size_t k = 0; k < sizeof listed / sizeof *listed; k++)
    expect(w, "help drivee", 1, listed[k]);
}

static void format_leaves_laws_with_errors(void **state) {
  workplace *w = *state;
  static const char *const laws[] = {
      "model x\n  law central bond\nforce N = zork*stretch\nend model\n", "model x\nforce N =\n"};
  for (size_t k = 0; k < sizeof laws / sizeof *laws; k++) {
    write_text(w, "x.plm", laws[k]);
    expect(w, "format -i x.plm", 1, "error: ");
    size_t size;
    char *left = read_bytes(w, "x.plm", &size);
    assert_string_equal(left, laws[k]);
    free(left);
  }
}

static int format_in_place(const char *path) {
  char option[] = "-i", file[400];
  snprintf(file, sizeof file, "%s", path);
  return command_format(2, (char *[]){option, file});
}

static void format_keeps_what_the_disk_does_not_take(void **state) {
  workplace *w = *state;
  assert_int_equal(shell(w, "sed 's/  */   /g' $PERILAT_MODELS/elastic_central.plm > x.plm; "
                            "cp x.plm before.plm"),
                   0);
  disk_fails = true;
  const int status = format_in_place(in_workplace(w, "x.plm"));
  disk_fails = false;
  assert_int_equal(status, 1);
  assert_int_equal(shell(w, "cmp x.plm before.plm && test $(ls x.plm* | wc -l) = 1"), 0);
  assert_int_equal(format_in_place(in_workplace(w, "x.plm")), 0);
  assert_int_equal(shell(w, "$P format --check x.plm"), 0);
}

/* --- completion ------------------------------------------------------------------------------- */

/* What bash offers, sorted, after a line whose words are given as it would cut them. */
static void expect_offers(workplace *w, const char *words, const char *wanted) {
  shell(
      w,
      "bash -c '. ./perilat.bash; COMP_WORDS=(%s); COMP_CWORD=$((${#COMP_WORDS[@]} - 1)); "
      "_perilat; "
      "printf \"%%s\\n\" \"${COMPREPLY[@]}\" | LC_ALL=C sort | paste -s -d , | sed \"s/.*/<&>/\"'",
      words);
  if (!strstr(w->said, wanted)) fail_msg("after %s bash offers %s, not %s", words, w->said, wanted);
}

static void bash_completes(void **state) {
  workplace *w = *state;
  assert_int_equal(completion_write(w->folder), 0);
  assert_int_equal(shell(w, "bash -n perilat.bash && touch a.plm b.nml c.h5 'd e.plm'"), 0);
  expect_offers(w, "perilat che", "<check>");
  expect_offers(w, "perilat check --d", "<--diagnostics,--dump>");
  expect_offers(w, "perilat check --dump \"\"", "<c,ir,passes,tree>");
  expect_offers(w, "perilat check --dump =", "<c,ir,passes,tree>");
  expect_offers(w, "perilat check --diagnostics = j", "<json>");
  expect_offers(w, "perilat run b", "<b.nml,beam.nml>");
  expect_offers(w, "perilat explain \"\"", "<a.plm,d e.plm>");
  expect_offers(w, "perilat plot \"\"", "<c.h5>");
  expect_offers(w, "perilat run --threads \"\"", "<>");
  expect_offers(w, "perilat help exp", "<explain,export>");
}

static void other_shells_read_theirs(void **state) {
  workplace *w = *state;
  assert_int_equal(completion_write(w->folder), 0);
  if (shell(w, "command -v zsh") == 0) assert_int_equal(shell(w, "zsh -n _perilat"), 0);
  if (shell(w, "command -v fish") == 0) assert_int_equal(shell(w, "fish -n perilat.fish"), 0);
  size_t sizes[2];
  char *texts[2] = {read_bytes(w, "_perilat", &sizes[0]), read_bytes(w, "perilat.fish", &sizes[1])};
  for (int k = 0; k < option_count; k++) {
    char zsh[100], fish[200];
    const char *name = option_table[k].name;
    if (is_solver(&option_table[k])) continue;
    snprintf(zsh, sizeof zsh, "'*%s", name);
    snprintf(fish, sizeof fish, "from %s' -%s ", option_table[k].command,
             name[1] == '-' ? "l" : "s");
    assert_non_null(strstr(texts[0], zsh));
    assert_non_null(strstr(texts[1], fish));
  }
  free(texts[0]);
  free(texts[1]);
}

/* --- man pages -------------------------------------------------------------------------------- */

static void man_pages_are_whole(void **state) {
  workplace *w = *state;
  assert_int_equal(manual_write(w->folder), 0);
  bool has_groff = shell(w, "command -v groff") == 0;
  for (int c = 0; c < command_count; c++) {
    char name[80];
    snprintf(name, sizeof name, "perilat-%s.1", command_table[c].name);
    assert_true(exists(w, name));
    if (has_groff) {
      assert_int_equal(shell(w, "groff -man -ww -Tascii -rHY=0 -rLL=300n %s > page", name), 0);
      assert_string_equal(w->said, "");
      assert_int_equal(shell(w, "sed 's/\\x1b\\[[0-9;]*m//g; s/.\\x08//g' page"), 0);
      for (int k = 0; k < option_count; k++)
        if (!strcmp(option_table[k].command, command_table[c].name))
          assert_non_null(strstr(w->said, option_table[k].name));
    }
  }
  assert_true(exists(w, "perilat.1"));
  assert_int_equal(manual_write("/nonexistent"), 2);
  assert_int_equal(completion_write("/nonexistent"), 2);
}

/* --- perilat new ------------------------------------------------------------------------------ */

static void new_files_work_at_once(void **state) {
  workplace *w = *state;
  static const struct {
    const char *name, *option, *holds, *plot; /* holds: of the path, or NULL without one */
  } kinds[] = {{"fresh", "", "5 of 5 expectations hold", "--x opening --y load"},
               {"Law_2", " --kind=micropolar", "5 of 5 expectations hold", "--x opening --y load"},
               {"third", " --kind central", "5 of 5 expectations hold", "--x opening --y load"},
               {"gel", " --kind state", "6 of 6 expectations hold", "--x opening --y load"},
               {"solid", " --kind continuum", "6 of 6 expectations hold", "--map mises"},
               {"tears", " --kind crack", NULL, "--map displacement"}};
  for (size_t k = 0; k < sizeof kinds / sizeof *kinds; k++) {
    const char *name = kinds[k].name;
    char line[300], written[300], drive[100] = "";
    if (kinds[k].holds) snprintf(drive, sizeof drive, "%s_drive.nml", name);
    snprintf(line, sizeof line, "new %s%s", name, kinds[k].option);
    snprintf(written, sizeof written, "written %s.plm, %s%s%s.nml", name, drive, *drive ? ", " : "",
             name);
    expect(w, line, 0, written);
    snprintf(line, sizeof line, "check %s.plm", name);
    expect(w, line, 0, "no errors, 0 warnings");
    snprintf(line, sizeof line, "format --check %s.plm", name);
    expect(w, line, 0, "");
    snprintf(line, sizeof line, "drive %s", drive);
    if (*drive) expect(w, line, 0, kinds[k].holds);
    snprintf(line, sizeof line, "check %s.nml", name);
    expect(w, line, 0, "no errors");
    snprintf(line, sizeof line, "run %s.nml", name);
    expect(w, line, 0, "written    ");
    snprintf(line, sizeof line, "plot %s.h5 %s -o %s.svg", name, kinds[k].plot, name);
    expect(w, line, 0, "written");
    assert_int_equal(shell(w, "grep -l NAME %s.plm %s %s.nml", name, drive, name),
                     1); /* no mark is left */
  }
}

static void new_refuses(void **state) {
  workplace *w = *state;
  static const char *const names[] = {
      "''",
      "2nd",
      "a-b",
      "a/b",
      "../a",
      "a.plm",
      "'a b'",
      "_a",
      "\xc3\xa4",
      "model",
      "stretch",
      "if",
      "aaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaa"};
  for (size_t k = 0; k < sizeof names / sizeof *names; k++) {
    int status = shell(w, "$P new %s", names[k]);
    bool made = shell(w, "ls *.plm") == 0;
    if (made) /* a name that the language allows must then work */
      status = shell(w, "$P check *.plm && rm *.plm *_drive.nml && rm -f [!b]*.nml") == 0 ? 1 : -1;
    if (status != 1) fail_msg("perilat new %s: status %d: %s", names[k], status, w->said);
  }
  expect(w, "new when", 1, "`when` cannot be the name of a law: `when` is a word of the language");
  assert_null(strstr(w->said, "when.plm"));
  expect(w, "new mplm_bilinear", 0, "warning: there is a law `mplm_bilinear` already");
  expect(w, "new", 1, "needs a name");
  expect(w, "new a b", 1, "takes one name");
  expect(w, "new a --kind family", 1, "--kind takes central, micropolar, state, continuum or");
  expect(w, "new a --kin central", 1, "did you mean `--kind`?");
  for (int k = 0; k < 3;
       k++) { /* one file of the three is in the way: it stays, and nothing else appears */
    static const char *const files[] = {"x.plm", "x_drive.nml", "x.nml"};
    write_text(w, files[k], "mine");
    expect(w, "new x", 1, "nothing was written");
    assert_int_equal(shell(w, "[ \"$(cat %s)\" = mine ] && [ \"$(echo x*)\" = %s ] && rm %s",
                           files[k], files[k], files[k]),
                     0);
  }
}

int main(void) {
#define T(test) cmocka_unit_test_setup_teardown(test, set_up_workplace, tear_down_workplace)
  const struct CMUnitTest tests[] = {
      T(every_command_takes_its_options),
      T(options_of_others_are_refused),
      T(every_option_in_the_sources_has_a_row),
      T(help_shows_every_option),
      T(help_on_nothing_lists_the_topics),
      T(format_leaves_laws_with_errors),
      T(format_keeps_what_the_disk_does_not_take),
      T(bash_completes),
      T(other_shells_read_theirs),
      T(man_pages_are_whole),
      T(new_files_work_at_once),
      T(new_refuses),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
