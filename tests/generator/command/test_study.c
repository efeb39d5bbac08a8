/* perilat study: tables against single runs, whatever is stopped, killed, damaged or asked wrong.
   */
#define _GNU_SOURCE
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>
#include <math.h>

#include "tests/dsl/json_valid.h"
#include "tests/generator/command_tools.h"

static void write_decks(workplace *w) {
  write_text(w, "two_study.nml",
             "! two speeds, two laws\n"
             "&study  deck = 'beam.nml'  vary = 'drive.velocity = -20, -40 mm/s', 'material.beta = "
             "0, 0.2'  jobs = 2  /\n");
}

static int set_up(void **state) {
  const int failed = set_up_workplace(state);
  if (!failed) write_decks(*state);
  return failed;
}

/* Field number `column` (from 1) of the table's line `line`, names in quotes without commas. */
static void expect_cell(workplace *w, const char *table, int line, const char *title,
                        const char *value) {
  assert_int_equal(shell(w,
                         "python3 -c \"import csv; r = list(csv.reader(open('%s'))); "
                         "print(r[%d][r[0].index('%s')])\"",
                         table, line, title),
                   0);
  w->said[strcspn(w->said, "\n")] = 0;
  assert_string_equal(w->said, value);
}

/* What the table says of a case is what a run of it says. */
static void a_row_is_a_run(void **state) {
  workplace *w = *state;
  expect(w, "study two_study.nml", 0, "wrote two_study.csv, two_study.h5, two_study.png");
  assert_true(exists(w, "two_study.png"));
  expect(w, "run beam.nml --set drive.velocity='-40 mm/s' --set material.beta=0.2", 0, "beam.h5");
  expect_same_results(w, "beam.h5", "two_study/velocity=-40mm_s,beta=0.2.h5");
  expect_cell(w, "two_study.csv", 4, "velocity [mm/s]", "-40");
  expect_cell(w, "two_study.csv", 4, "beta", "0.2");
  expect_cell(w, "two_study.csv", 4, "status", "0");
  assert_int_equal(
      shell(w, "$P export beam.h5 --history load --json | python3 -c \"\n"
               "import csv, json, sys\n"
               "load = json.load(sys.stdin)['columns'][1]['values']\n"
               "r = list(csv.reader(open('two_study.csv')))\n"
               "print(float(r[4][r[0].index('load peak [N]')]) == max(load, key=abs))\"\n"),
      0);
  assert_string_equal(w->said, "True\n");
}

/* A column over a key, a curve for each value of the other. */
static void a_table_is_drawn(void **state) {
  workplace *w = *state;
  expect(w, "study two_study.nml", 0, "wrote");
  expect(w, "plot two_study.h5 --x velocity --y 'load peak' -o peaks.png", 0, "written peaks.png");
  assert_true(exists(w, "peaks.png"));
  expect(w, "plot two_study.h5 --x drive.velocity --y 'load peak' --label a --label b -o ab.svg", 0,
         "written ab.svg");
  expect(w, "plot two_study.h5 --x velocity --y 'load peak' --label a", 1,
         "1 labels for 2 curves; give one --label a curve");
  expect(w, "plot two_study.h5 --x alpha --y 'load peak'", 1,
         "there is no column `alpha` in `two_study.h5`");
  expect(w, "plot two_study.h5 --x velocity --y ended", 1, "holds texts, not numbers");
  expect(w, "plot two_study.h5 --x velocity --y 'load peak' --line '5 kN'", 1,
         "the table of a study is drawn by itself");
  expect(w, "plot two_study.h5 --x velocity --y 'load peak' -o two_study.h5", 1, "would overwrite");
}

/* Options and group say the same. */
static void options_or_group(void **state) {
  workplace *w = *state;
  expect(w, "study two_study.nml", 0, "wrote");
  expect(w,
         "study beam.nml --vary drive.velocity=-20,-40mm/s --vary material.beta=0,0.2 -o options",
         0, "wrote options.csv");
  assert_int_equal(shell(w, "cut -d, -f1-30 two_study.csv | sed 's/,[0-9.e-]*,0,end/,0,end/' > a; "
                            "sed 's/,[0-9.e-]*,0,end/,0,end/' options.csv > b; cmp a b"),
                   0);
}

/* All but the time that runs took. */
static const char without_wall[] =
    "python3 -c \"import csv, sys; r = list(csv.reader(open(sys.argv[1]))); k = r[0].index('wall "
    "[s]'); "
    "print([c[:k] + c[k+1:] for c in r])\"";

static void start_study(const workplace *w, pid_t *child) {
  *child = fork();
  assert_true(*child >= 0);
  if (*child) return;
  if (chdir(w->folder) != 0 || !freopen("said_long", "w", stdout) ||
      dup2(fileno(stdout), fileno(stderr)) < 0)
    _exit(99);
  setenv("PERILAT_MODELS", SOURCE_DIR "/models", 1);
  execl(PERILAT_PROGRAM, "perilat", "study", "long.nml", "--vary",
        "drive.velocity=-10,-20,-40 mm/s", "--jobs", "2", "-o", "killed", (char *)NULL);
  _exit(99);
}

/* Killed again and again, at other moments, it ends with the table of one that was left alone. */
static void killed_again_and_again(void **state) {
  workplace *w = *state;
  enum { KILLS = 12 };
  write_long_deck(w);
  expect(w, "study long.nml --vary 'drive.velocity=-10,-20,-40 mm/s' -o alone", 0, "wrote");
  for (int k = 0; k < KILLS; k++) {
    pid_t child;
    start_study(w, &child);
    for (int wait = 0; wait < 15 * (k + 1); wait++)
      wait_a_little();
    kill(child, k % 3 == 2 ? SIGTERM : SIGKILL);
    end_of(child);
  }
  expect(w, "study long.nml --vary 'drive.velocity=-10,-20,-40 mm/s' -o killed", 0, "wrote");
  assert_int_equal(
      shell(w, "%s alone.csv > a; %s killed.csv > b; cmp a b", without_wall, without_wall), 0);
  expect_same_results(w, "alone/velocity=-10mm_s.h5", "killed/velocity=-10mm_s.h5");
  expect_same_results(w, "alone/velocity=-40mm_s.h5", "killed/velocity=-40mm_s.h5");
}

static void stopped_by_a_signal(void **state) {
  workplace *w = *state;
  pid_t child;
  write_long_deck(w);
  start_study(w, &child);
  for (int k = 0; k < 20000 && !exists(w, "killed/velocity=-10mm_s.h5.frames"); k++)
    wait_a_little();
  kill(child, SIGINT);
  assert_int_equal(end_of(child), 130);
  assert_int_equal(shell(w, "cat said_long"), 0);
  assert_non_null(strstr(w->said, "the same command goes on from here"));
  assert_false(exists(w, "killed.csv"));
}

/* What is done is not done again. */
static void gone_on_with(void **state) {
  workplace *w = *state;
  expect(w, "study two_study.nml", 0, "wrote");
  assert_int_equal(shell(w, "stat -c %%y two_study/*.h5 > before; $P study two_study.nml; "
                            "stat -c %%y two_study/*.h5 | cmp - before"),
                   0);
  assert_int_equal(shell(w, "rm 'two_study/velocity=-20mm_s,beta=0.h5'; $P study two_study.nml"),
                   0);
  assert_non_null(strstr(w->said, "3 of 4 runs done"));
  /* widened */
  expect(w,
         "study beam.nml --vary 'drive.velocity=-20,-40,-80 mm/s' --vary material.beta=0,0.2 -o "
         "two_study",
         0, "4 of 6 runs done");
}

static void a_run_that_fails_is_a_row(void **state) {
  workplace *w = *state;
  expect(w, "study beam.nml --vary drive.region=loader,nowhere -o failed", 1, "nowhere");
  assert_false(exists(w, "failed"));
  expect(w, "study beam.nml --vary 'body.size=38.1 mm,12 mm; 1 um,1 um' -o failed", 2,
         "wrote failed.csv");
  expect_cell(w, "failed.csv", 1, "status", "0");
  expect_cell(w, "failed.csv", 2, "status", "1");
  expect_cell(w, "failed.csv", 2, "load peak [N]", "");
  expect(w,
         "study beam.nml --vary 'simulation.step=0.3 us, 20 us' --set output.energy=.false. "
         "--no-physics -o bad",
         2, "wrote bad.csv");
  expect_cell(w, "bad.csv", 2, "status", "1");
}

static void clashes(void **state) {
  workplace *w = *state;
  expect(w, "study two_study.nml", 0, "wrote");
  assert_int_equal(shell(w, "cp two_study.csv before; sed -i 's/1 ms/2 ms/' beam.nml"), 0);
  expect(w, "study two_study.nml", 1, "of another deck, law or setting");
  expect(w, "study two_study.nml --set material.nu=0.1", 1, "name this one with `result`");
  assert_int_equal(shell(w, "cmp two_study.csv before"), 0);
  expect(w, "study two_study.nml -o other", 0, "wrote other.csv");
  /* a result that this study has not made */
  assert_int_equal(shell(w, "mkdir own; cp 'other/velocity=-20mm_s,beta=0.h5' own"), 0);
  expect(w, "study two_study.nml -o own", 1, "holds a result `velocity=-20mm_s,beta=0.h5`");
}

/* A law's text is part of what a case is. */
static void another_law(void **state) {
  workplace *w = *state;
  assert_int_equal(shell(w, "cp " SOURCE_DIR "/models/mplm_bilinear.plm own.plm"), 0);
  expect(w, "study beam.nml --set material.model=./own.plm --vary material.beta=0,0.2 -o law", 0,
         "wrote");
  assert_int_equal(shell(w, "echo '! changed' >> own.plm"), 0);
  expect(w, "study beam.nml --set material.model=./own.plm --vary material.beta=0,0.2 -o law", 1,
         "another deck, law or setting");
}

static void damaged_files(void **state) {
  workplace *w = *state;
  expect(w, "study two_study.nml", 0, "wrote");
  assert_int_equal(
      shell(
          w,
          "%s two_study.csv > a; f='two_study/velocity=-20mm_s,beta=0.h5'; truncate -s 3000 "
          "\"$f\"; "
          "printf 'half a li' >> two_study/cases.txt; $P study two_study.nml && %s two_study.csv > "
          "b && cmp a b",
          without_wall, without_wall),
      0);
}

/* A full disk: no run is taken for done, and all is made up for when there is room. */
static void no_room(void **state) {
  workplace *w = *state;
  expect(w, "study two_study.nml -o alone", 0, "wrote");
  assert_int_equal(shell(w, "(ulimit -f 4; $P study two_study.nml)"), 2);
  assert_int_equal(
      shell(w, "$P study two_study.nml && %s two_study.csv > a && %s alone.csv > b && cmp a b",
            without_wall, without_wall),
      0);
  assert_int_equal(shell(w, "touch taken; $P study two_study.nml -o taken"), 1);
  assert_non_null(strstr(w->said, "cannot write into the folder `taken`"));
}

static void two_at_once(void **state) {
  workplace *w = *state;
  write_long_deck(w);
  assert_int_equal(
      shell(w,
            "$P study long.nml --vary 'drive.velocity=-10,-20 mm/s' -o same > one & sleep 0.3; $P "
            "study long.nml --vary 'drive.velocity=-10,-20 mm/s' -o same > two; wait; "
            "diff one two | grep -v wrote | grep -c ended"),
      1);
}

static void documents(void **state) {
  workplace *w = *state;
  assert_int_equal(shell(w, "$P study two_study.nml --json 2>/dev/null"), 0);
  assert_true(json_is_valid(w->said));
  assert_non_null(strstr(w->said, "\"load peak\": "));
  assert_non_null(strstr(w->said, "\"error\": null"));
  assert_int_equal(shell(w, "$P study beam.nml --vary nix=1 --json 2>/dev/null"), 1);
  assert_true(json_is_valid(w->said));
  assert_non_null(strstr(w->said, "form group.key=values"));
}

/* A file with a study alone: its runs are checked, and no other command takes it for a deck. */
static void a_file_of_its_own(void **state) {
  workplace *w = *state;
  expect(w, "check two_study.nml", 0, "two_study.nml: no errors");
  assert_false(exists(w, "two_study"));
  expect(w, "check two_study.nml --set material.nu=7", 1, "nu");
  expect(w, "run two_study.nml", 1, "perilat study two_study.nml");
  expect(w, "info two_study.nml", 1, "perilat study two_study.nml");
  expect(w, "build two_study.nml", 1, "perilat study two_study.nml");
  expect(w, "study two_study.nml", 0, "wrote");
  expect(w, "plot two_study.h5", 1, "is the table of a study");
  expect(w, "info two_study.h5", 0,
         "The table of a study: 4 cases, whose results are in two_study/");
  assert_non_null(strstr(w->said, "  velocity: -40 to -20 mm/s\n"));
  assert_non_null(strstr(w->said, "  velocity=-40mm_s,beta=0.2: end of the run\n"));
  assert_int_equal(
      shell(w, "$P info two_study.h5 --json > a; $P study two_study.nml --json 2>/dev/null > b; "
               "python3 -c \"import json; a, b = (json.load(open(f)) for f in 'ab'); "
               "print(a['cases'] == b['cases'])\""),
      0);
  assert_string_equal(w->said, "True\n");
}

/* In the deck it changes nothing of a run. */
static void in_the_deck(void **state) {
  workplace *w = *state;
  expect(w, "run beam.nml --set output.result=alone.h5", 0, "alone.h5");
  assert_int_equal(shell(w, "echo \"&study vary = 'drive.velocity=-20, -40 mm/s' /\" >> beam.nml"),
                   0);
  expect(w, "run beam.nml", 0, "beam.h5");
  expect_same_results(w, "beam.h5", "alone.h5");
  expect(w, "study beam.nml", 0, "wrote beam_study.csv");
  expect(w, "check beam.nml --set study.jobs=x", 1, "jobs");
}

/* What the command sets counts, not what the group does; another question drops what is varied. */
static void the_command_counts(void **state) {
  workplace *w = *state;
  expect(w, "study two_study.nml", 0, "wrote");
  write_text(w, "set.nml",
             "&study  deck = 'beam.nml'  vary = 'drive.velocity = -20 mm/s'  set = "
             "'material.beta = 0.2'  /\n");
  expect(w, "study set.nml --set material.beta=0 -o of_command", 0, "wrote");
  expect_same_results(w, "of_command/velocity=-20mm_s.h5", "two_study/velocity=-20mm_s,beta=0.h5");
  expect(w, "study set.nml -o of_group", 0, "wrote");
  expect_same_results(w, "of_group/velocity=-20mm_s.h5", "two_study/velocity=-20mm_s,beta=0.2.h5");
}

static void half_a_line_in_the_list(void **state) {
  workplace *w = *state;
  static const char widened[] =
      "study beam.nml --vary 'drive.velocity=-20,-40,-80 mm/s' --vary material.beta=0,0.2 -o "
      "two_study";
  expect(w, "study two_study.nml", 0, "wrote");
  assert_int_equal(shell(w, "printf 'half a li' >> two_study/cases.txt"), 0);
  expect(w, widened, 0, "wrote");
  expect(w, widened, 0, "wrote");
}

/* Results and tables of others stay. */
static void overwrites_nothing(void **state) {
  workplace *w = *state;
  expect(w, "run beam.nml", 0, "beam.h5");
  expect(w, "study two_study.nml -o beam", 1, "would overwrite `beam.h5`");
  assert_int_equal(shell(w, "echo 'cmod, load' > lab.csv; $P study two_study.nml -o lab"), 1);
  assert_non_null(strstr(w->said, "would overwrite `lab.csv`"));
  assert_false(exists(w, "lab"));
}

/* As some launchers start programs. */
static void with_children_ignored(void **state) {
  workplace *w = *state;
  assert_int_equal(shell(w, "trap '' CHLD; exec timeout 100 $P study two_study.nml"), 0);
  assert_non_null(strstr(w->said, "wrote"));
}

static void slips(void **state) {
  workplace *w = *state;
  expect(w, "study beam.nml --vary material.beta=0,1 --vary Material[1].beta=2", 1, "varied twice");
  expect(w, "study beam.nml --vary material.beta=0,1 --y nix", 1, "has no monitor `nix`");
  expect(w, "study beam.nml --vary material.beta=0,1 --y kinetic --set output.energy=.false.", 1,
         "has no monitor `kinetic`");
  expect(w, "study beam.nml --vary material.beta=1,2,3 --converge beta --of Last", 1,
         "--of takes peak|last");
  expect(w, "study beam.nml --vary material.beta=1,2 --converge nu", 1, "is not varied");
  expect(w, "study beam.nml --vary material.beta=0,1 --converge beta", 1, "is no size");
  expect(w, "study beam.nml --strength force.total=1..2:1 --fit material.E=1..2", 1,
         "three questions");
  expect(w, "study beam.nml --strength drive.velocity=1..2:1", 1, "no load that grows and is held");
  expect(w, "study beam.nml --set material.E=30GPa --fit material.E=40..50GPa --to beam.nml", 1,
         "leave out the deck's own");
  expect(w, "study beam.nml --set material.E=30GPa --fit material.E=50..40GPa --to beam.nml", 1,
         "not below");
  expect(w, "study beam.nml --set material.E=30GPa --fit material.E=20..40GPa", 1,
         "one measured curve for each deck");
  expect(w, "study beam.nml --set material.E=30GPa --fit material.E=20..40GPa --to nowhere.csv", 1,
         "nowhere.csv");
  expect(w, "study beam.nml --vary material.beta=0,1 --twin beam.nml", 1, "belongs to --strength");
  expect(w, "study beam.nml two/beam.nml --fit material.E=20..40GPa --to a.csv --to b.csv", 1,
         "the same name");
  assert_int_equal(shell(w, "ls -d *_study 2>/dev/null | grep -c . "), 1); /* nothing was begun */
}

/* What the deck reader says of a value stands where the value does. */
static void slips_in_values(void **state) {
  workplace *w = *state;
  expect(w, "study beam.nml --vary lattice.spacing=6.35,6.2mmm,5", 1, "--vary:1:25: error");
  expect(w, "study beam.nml --vary lattice.spacin=6.35,6.2", 1, "--vary:1:9: error");
  expect(w, "study beam.nml --vary material.beta=0,0.2 --with material.nu=0.1,7", 1,
         "--vary:1:42: error");
  expect(w, "study beam.nml --vary material.beta=0,0.2 --set lattice.thickness=3m/s", 1,
         "--set:1:19: error");
  expect(w, "study beam.nml --vary lattice.spacing=6..5:0.5mmm", 1, "--vary:1:17: error");
  write_text(w, "bad_study.nml",
             "! two\n&study  deck = 'beam.nml'\n"
             "  vary = 'lattice.spacing = 6 mmm, 5 mm'\n  set = 'material.nu = 7'  /\n");
  expect(w, "study bad_study.nml", 1, "bad_study.nml:3:31: error: there is no unit `mmm`");
  assert_non_null(strstr(w->said, "  3 |   vary = 'lattice.spacing = 6 mmm, 5 mm'"));
  write_text(w, "bad_study.nml",
             "&study deck = 'beam.nml' vary = 'material.beta = 0, 1' set = 'material.nu = 7' /\n");
  expect(w, "study bad_study.nml", 1, "bad_study.nml:1:77: error: `nu` = 7");
}

static void write_group(workplace *w, const char *keys) {
  char text[1000];
  snprintf(text, sizeof text, "&study deck = 'beam.nml' %s /\n", keys);
  write_text(w, "asked_study.nml", text);
}

/* Whoever writes a group is told of its keys, whoever gives options of these. */
static void words_of_the_asker(void **state) {
  workplace *w = *state;
  static const struct {
    const char *keys, *options, *words[2];
  } slips[] = {{"x = 'time'", "", {"or `strength`, `fit`", "or --strength, --fit"}},
               {"vary = 'material.beta=1,2' twin = 'beam.nml'",
                "--vary material.beta=1,2 --twin beam.nml",
                {"belongs to `strength`", "belongs to --strength"}},
               {"vary = 'material.beta=1,2' to = 'lab.csv'",
                "--vary material.beta=1,2 --to lab.csv",
                {"belong to `fit`", "belong to --fit"}},
               {"fit = 'material.E=20..40 GPa'",
                "--fit 'material.E=20..40 GPa'",
                {"to = 'lab.csv'", "--to lab.csv"}},
               {"fit = 'material.E=40..20 GPa' to = 'beam.nml'",
                "--fit 'material.E=40..20 GPa' --to beam.nml",
                {"fit = 'material.E=20..40 GPa'", "--fit \"material.E=20..40 GPa\""}},
               {"vary = 'material.beta=1,2,3' converge = 'nu'",
                "--vary material.beta=1,2,3 --converge nu",
                {"keys of `vary`", "keys of --vary"}},
               {"vary = 'material.beta=1,2' strength = 'force.total=1..2:1'",
                "--vary material.beta=1,2 --strength force.total=1..2:1",
                {"`vary` goes with `converge`", "--vary goes with --converge"}},
               {"vary = 'material.beta=0,1' result = 'mine'",
                "--vary material.beta=0,1 -o mine",
                {"name it with `result`", "name it with -o"}}};
  write_text(w, "mine.csv", "a\n");
  for (size_t k = 0; k < sizeof slips / sizeof *slips; k++) {
    char command[400];
    write_group(w, slips[k].keys);
    expect(w, "study asked_study.nml", 1, slips[k].words[0]);
    assert_null(strstr(w->said, "--"));
    snprintf(command, sizeof command, "study beam.nml %s", slips[k].options);
    expect(w, command, 1, slips[k].words[1]);
  }
}

/* A plain number is in SI, and that is said where the deck has another unit. */
static void numbers_without_unit(void **state) {
  workplace *w = *state;
  expect(w, "study beam.nml --vary simulation.end_time=1e-4,2e-4 --set lattice.spacing=0.006 -o p",
         0, "--vary:1:21: warning: `1e-4` has no unit and is read as 1e-4 s; the deck's own");
  assert_non_null(strstr(w->said, "--set:1:17: warning: `0.006`"));
  assert_null(strstr(w->said, "`2e-4`"));
  expect(w, "study beam.nml --vary simulation.end_time=0.1,0.2ms --set material.nu=0.1 -o q", 0,
         "wrote");
  assert_null(strstr(w->said, "warning"));
}

/* Before anything runs. */
static void too_few_sizes(void **state) {
  workplace *w = *state;
  expect(w, "study beam.nml --vary material.beta=0.1,0.2 --converge beta -o few", 1,
         "need three sizes or more; `material.beta` has 2");
  assert_false(exists(w, "few"));
}

static double fitted(workplace *w, const char *weights, const char *name) {
  assert_int_equal(
      shell(
          w,
          "$P study beam.nml b.nml --fit 'material.E=25..40 GPa' --to a.csv --to b.csv --x time %s "
          "-o %s --json 2>/dev/null | sed -n '/\"parameters\"/,$p'",
          weights, name),
      0);
  const char *value = strstr(w->said, "\"value\": ");
  assert_non_null(value);
  return strtod(value + strlen("\"value\": "), NULL);
}

/* Two decks whose curves want different parameters: the heavier one gets its own. */
static void weights_of_curves(void **state) {
  workplace *w = *state;
  assert_int_equal(
      shell(w, "sed -i 's/mplm_bilinear/elastic_micropolar/; s/model = /E = \"30 GPa\" model = /' "
               "beam.nml; "
               "sed 's/-20/-30/' beam.nml > b.nml; "
               "$P run beam.nml --set output.result=a.h5 && $P run b.nml --set 'material.E=33 GPa' "
               "--set output.result=b.h5 && "
               "for f in a b; do $P export $f.h5 --history load -o $f.csv || exit 9; done"),
      0);
  const double first = fitted(w, "--weight 1 --weight 1e-6", "first"),
               second = fitted(w, "--weight 1e-6 --weight 1", "second");
  assert_true(fabs(first - 30) < 0.05);
  assert_true(fabs(second - 33) < 0.05);
}

/* The same values with one process and two. */
static void jobs(void **state) {
  workplace *w = *state;
  expect(w, "study two_study.nml --jobs 1 -o one", 0, "wrote");
  expect(w, "study two_study.nml --jobs 4 -o four", 0, "wrote");
  assert_int_equal(shell(w, "%s one.csv > a; %s four.csv > b; cmp a b", without_wall, without_wall),
                   0);
}

/* The longest run begins first, so that none is left to run by itself at the end; rows stay as they
   were asked. */
static void longest_first(void **state) {
  workplace *w = *state;
  expect(w,
         "study beam.nml --vary 'simulation.end_time=0.1,0.3 ms' --vary "
         "'lattice.spacing=6.35,3.175 mm' --jobs 1 -o order",
         0, "wrote");
  assert_int_equal(shell(w, "ls -1tr --time-style=full-iso order/*.h5 | tr '\\n' ' '"), 0);
  assert_string_equal(w->said, "order/end_time=0.3ms,spacing=3.175mm.h5 "
                               "order/end_time=0.1ms,spacing=3.175mm.h5 "
                               "order/end_time=0.3ms,spacing=6.35mm.h5 "
                               "order/end_time=0.1ms,spacing=6.35mm.h5 ");
  expect_cell(w, "order.csv", 1, "case", "end_time=0.1ms,spacing=6.35mm");
}

int main(void) {
#define WITH(test) cmocka_unit_test_setup_teardown(test, set_up, tear_down_workplace)
  const struct CMUnitTest tests[] = {WITH(a_row_is_a_run),
                                     WITH(a_table_is_drawn),
                                     WITH(options_or_group),
                                     WITH(killed_again_and_again),
                                     WITH(gone_on_with),
                                     WITH(a_run_that_fails_is_a_row),
                                     WITH(stopped_by_a_signal),
                                     WITH(clashes),
                                     WITH(another_law),
                                     WITH(damaged_files),
                                     WITH(no_room),
                                     WITH(two_at_once),
                                     WITH(documents),
                                     WITH(jobs),
                                     WITH(longest_first),
                                     WITH(a_file_of_its_own),
                                     WITH(in_the_deck),
                                     WITH(the_command_counts),
                                     WITH(half_a_line_in_the_list),
                                     WITH(overwrites_nothing),
                                     WITH(with_children_ignored),
                                     WITH(slips),
                                     WITH(slips_in_values),
                                     WITH(words_of_the_asker),
                                     WITH(too_few_sizes),
                                     WITH(numbers_without_unit),
                                     WITH(weights_of_curves)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
