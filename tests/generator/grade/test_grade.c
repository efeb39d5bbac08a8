/* perilat grade: right answers in other forms, wrong ones and their words, classes, exercises that
   are published, put to the test, or broken. The exercise stands in
   tests/generator/grade/memory. */
#define _GNU_SOURCE
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>
#include <stdbool.h>

#include "generator/exercise/answer_table.h"
#include "generator/exercise/exercise_grammar.h"
#include "generator/grade/handed_in.h"
#include "generator/grade/mark_files.h"
#include "generator/grade/mark_page.h"
#include "generator/grade/mark_text.h"
#include "runtime/deck/deck_groups.h"
#include "tests/generator/command_tools.h"

/* A copy of the exercise in the workplace. */
static int set_up(void **state) {
  if (set_up_workplace(state) != 0) return -1;
  return shell(*state, "cp -r '" SOURCE_DIR "/tests/generator/grade/memory' memory && "
                       "cp memory/teacher/solution.plm right.plm");
}

/* The solution, changed by sed; it must change. */
static void answer(workplace *w, const char *changes) {
  assert_int_equal(
      shell(w, "sed -e '%s' right.plm > answer.plm && ! cmp -s right.plm answer.plm", changes), 0);
}

static void says(const workplace *w, const char *wanted) {
  if (!strstr(w->said, wanted)) fail_msg("there is no `%s` in\n%s", wanted, w->said);
}

static void does_not_say(const workplace *w, const char *unwanted) {
  if (strstr(w->said, unwanted)) fail_msg("there is `%s` in\n%s", unwanted, w->said);
}

static void graded(workplace *w, const char *changes, const char *wanted) {
  answer(w, changes);
  expect(w, "grade memory answer.plm", 2, wanted);
}

/* --- right ------------------------------------------------------------------------------------ */

static void right_answers_get_all_points(void **state) {
  workplace *w = *state;
  expect(w, "grade memory right.plm", 0, "     90 of  90  points; 10 are given by hand");
  expect(w, "grade memory memory/teacher/equal/cosine.plm", 0, "90 of  90");
  expect(w, "grade memory memory/teacher/equal/other_names.plm", 0, "90 of  90");
  answer(w, "s/(1 - omega)\\*EA\\*stretch /EA*stretch - EA*stretch*omega /");
  expect(w, "grade memory answer.plm", 0, "90 of  90");
  /* without a derivative at rest */
  answer(w, "s/^    | EA\\*stretch  *otherwise/    | -EA*positive_part(-stretch) otherwise/; "
            "s/\\*EA\\*stretch /*EA*positive_part(stretch) /");
  expect(w, "grade memory answer.plm", 0, "90 of  90");
}

/* --- wrong ------------------------------------------------------------------------------------ */

#define RIGIDITY "s|sqrt(3)/2\\*E\\*s\\*t|"

static void known_wrong_answers_get_their_sentence(void **state) {
  workplace *w = *state;
  static const char half[] = "Did you give half of the bond to each particle?";
  graded(w, RIGIDITY "E*s*t*sqrt(3)/4|", half);
  does_not_say(w, "N is half");
  graded(w, RIGIDITY "sqrt(3)/2*(E/2)*t*s|; s|kappa|far|g; s|omega|broken|g", half);
  graded(w, "s|    . EA\\*stretch  *otherwise|    \\| min(EA, 0*EA) otherwise|",
         "Your bond is a rope");
  graded(w, RIGIDITY "s*sqrt(3)*E/2|", "one length is missing");
  says(w, "[units]");
}

static void others_get_general_words(void **state) {
  workplace *w = *state;
  graded(w, RIGIDITY "sqrt(3)*E*s*t|",
         "path 1 of 2: the force N is twice what it should be in all states");
  says(w, "first differs   time [s]");
  says(w, "yours ");
  says(w, "E is 2e+10 Pa, twice what it should be");
  graded(w, RIGIDITY "-sqrt(3)/2*E*s*t|", "the force N has the wrong sign in all states");
  graded(w, RIGIDITY "-sqrt(3)*E*s*t|", "minus twice what it should be in all states");
  does_not_say(w, ", twice what");
  graded(w, RIGIDITY "0.866*E*s*t|", "off by 0.0029 % in all states: is a constant rounded?");
  says(w, "E is 9.9997e+09 Pa, off by 0.0029 %: is a constant rounded?");
  does_not_say(w, "1 times");
  graded(w,
         "s|(S_u - kappa)|(2*S_u - kappa)|; s|/(S_u - S_t)|/(2*S_u - S_t)|; s|kappa < S_u|kappa "
         "< 2*S_u|",
         "the force N is wrong only where it is stretched after it lost energy");
}

/* One factor of all that fails says something, one that each has for itself does not. */
static void factors_are_told_where_all_have_one(void **state) {
  workplace *w = *state;
  graded(w, RIGIDITY "sqrt(3)/2*8/9*E*s*t|", "8/9 times what it should be");
  says(w, "final N is -2309.4, expected -2598.08 N (at 2 s): 8/9 times what it should be");
  graded(w,
         "s/^    | EA\\*stretch  *otherwise/    | 0.996*EA*stretch otherwise/; "
         "s/(1 - omega)\\*EA/(1 - omega)*8\\/9*EA/",
         "final N is ");
  does_not_say(w, "constant rounded");
}

/* What students have says no root, which would be the formula that is asked for. */
static void public_items_tell_no_roots(void **state) {
  workplace *w = *state;
  answer(w, RIGIDITY "E*s*t|");
  expect(w, "grade memory answer.plm --public", 2, ": 1.155 times what it should be");
  does_not_say(w, "sqrt");
  expect(w, "grade memory answer.plm", 2, "2/sqrt(3) times what it should be");
  says(w, "E is 1.1547e+10 Pa, ");
}

static void numbers_for_names_are_told(void **state) {
  workplace *w = *state;
  graded(w, RIGIDITY "sqrt(3)/2*E*0.01 [m]*t|",
         "right with the values of the starter, wrong with others (");
  says(w, "did you write numbers for them?");
  says(w, "15 of  30  Cycles: 1 of 2");
  graded(w, "s|S_t/kappa\\*|1e-4/kappa*|", "wrong with others (");
}

static void errors_are_told_at_their_line(void **state) {
  workplace *w = *state;
  graded(w, "s/kappa, stretch/kappa, strech/",
         "answer.plm:13:22: error: there is no quantity `strech` [unknown-name]");
  says(w, "      0 of  20  check: 0 of 2");
  graded(w, "s/parameter E /parameter Y /; s/\\*E\\*/*Y*/", "your law has no parameter `E`");
  expect(w, "grade memory memory/starter.plm", 2, "2 holes `?` are still to be written");
  says(w, "[hole]");
}

/* An answer cannot excuse itself. */
static void waivers_of_an_answer_do_not_count(void **state) {
  workplace *w = *state;
  const char *heals = "s|EA\\*stretch  |EA*(stretch - 1e-5)|";
  graded(w, heals, "[rest-force]");
  assert_int_equal(shell(w, "sed -i 's|^end model|  accept rest-force \"so\"\\n&|' answer.plm"), 0);
  expect(w, "grade memory answer.plm", 2, "[rest-force]");
}

/* The file as it was given; warnings cost nothing. */
static void messages_name_the_file_that_was_given(void **state) {
  workplace *w = *state;
  answer(w, "s/kappa, stretch/kappa, strech/");
  assert_int_equal(shell(w, "mkdir try; mv answer.plm try/m04.plm"), 0);
  expect(w, "grade memory try/m04.plm", 2, "try/m04.plm:13:22: error: there is no quantity");
  does_not_say(w, "answer.plm");
  expect(w, "grade memory try", 2, "try/m04.plm:13:22: error: there is no quantity");
}

static void warnings_are_shown(void **state) {
  workplace *w = *state;
  assert_int_equal(
      shell(w, "sed 's/^  state kappa/  constant idle = E*t\\n&/' right.plm > idle.plm"), 0);
  expect(w, "grade memory idle.plm", 0,
         "  warnings of `perilat check`, which cost nothing:\n"
         "  idle.plm:12:12: warning: no force and no output uses the constant `idle` [unused]\n");
  says(w, "     90 of  90  points");
  expect(w, "grade memory idle.plm --html a.html --json > a.json", 0, "");
  assert_int_equal(shell(w, "cat a.html a.json"), 0);
  says(w, "which cost nothing:</p><pre>idle.plm:");
  says(w, "\"messages\": [],");
  says(w, "\"advice\": [\n        \"idle.plm:");
  says(w, "\"notes\": [],");
}

/* A default of the student's is not asked. */
static void defaults_are_the_exercises(void **state) {
  workplace *w = *state;
  answer(w, "s/30 \\[GPa\\]/31 [GPa]/");
  expect(w, "grade memory answer.plm", 0, "90 of  90");
}

static void cases_that_no_path_reaches_are_noted(void **state) {
  workplace *w = *state;
  answer(w, "s/when stretch > 0/when stretch > 0\\n    | 0.9*EA*stretch when stretch < -0.5/");
  expect(w, "grade memory answer.plm", 0, "note: a case of line 20 is never reached");
}

/* --- hidden ----------------------------------------------------------------------------------- */

static void hidden_items_stay_hidden(void **state) {
  workplace *w = *state;
  assert_int_equal(shell(w, "$P grade memory --publish given && ls -R given"), 0);
  does_not_say(w, "hidden");
  does_not_say(w, "teacher");
  assert_int_equal(shell(w, "cat given/*"), 0);
  says(w, "title = 'Cycles'  points = 30  hidden = .true.  /");
  does_not_say(w, "cycles.nml");
  does_not_say(w, "vary");
  does_not_say(w, "E=10 GPa");
  expect(w, "grade given right.plm", 0, "40 of  40  points; 50 are judged by the teacher");
  says(w, "?"
          " of  30  Cycles: hidden, judged by the teacher");
  expect(w, "grade memory right.plm --public", 0, "40 of  40  points");
  answer(w, RIGIDITY "sqrt(3)*E*s*t|");
  expect(w, "grade given answer.plm", 2, "peak N is ");
  says(w, "twice what it should be");
  expect(w, "grade memory answer.plm", 2, "Cycles: 0 of 2");
  does_not_say(w, ".nml");
}

static void folders_above_are_made(void **state) {
  workplace *w = *state;
  expect(w, "grade memory --publish new/for/05/", 0, "written new/for/05/task.md");
  expect(w, "grade memory --publish ./new/for/06", 0, "written ./new/for/06/exercise.nml");
  expect(w, "grade memory --publish memory/new/for/05", 1, "lies in the exercise itself");
  assert_false(exists(w, "memory/new"));
  assert_int_equal(shell(w, "mkdir memory/there there"), 0);
  expect(w, "grade memory --publish memory/there", 1, "lies in the exercise itself");
  assert_false(exists(w, "memory/there/task.md"));
  expect(w, "grade memory --publish there", 0, "written there/task.md");
  expect(w, "grade memory --publish right.plm/05", 1, "cannot make the folder");
}

static void publishing_refuses(void **state) {
  workplace *w = *state;
  expect(w, "grade memory --publish memory", 1, "is not empty");
  expect(w, "grade memory --publish memory/given", 1, "lies in the exercise itself");
  assert_false(exists(w, "memory/given"));
  assert_int_equal(shell(w,
                         "cp memory/teacher/solution.plm memory/hint.plm; echo 'See `hint.plm`.' "
                         ">> memory/task.md"),
                   0);
  expect(w, "grade memory --publish given", 1, "is the same as a file of teacher/");
  assert_false(exists(w, "given/hint.plm"));
  assert_int_equal(shell(w, "rm -r given memory/hint.plm; ln -s teacher/solution.plm memory/a.plm"),
                   0);
  expect(w, "grade memory --publish given", 0, "written given/task.md");
  assert_false(exists(w, "given/a.plm"));
}

/* A teacher has tried the exercise out in its own folder. */
static void what_nobody_names_is_not_published(void **state) {
  workplace *w = *state;
  assert_int_equal(shell(w,
                         "cd memory; cp teacher/wrong/half.plm answer.plm; cp answer.plm old.plm; "
                         "echo x | tee beam.h5 beam.xdmf loop.png shown.png marks.csv my.nml "
                         "my.nml.bak side.plm > deep.plm; mkdir data; echo 'See deep.plm.' > "
                         "data/outline.csv; echo \"model = 'side' file = 'data/outline.csv'\" > "
                         "beam.nml; echo 'Save it as answer.plm: perilat run beam.nml; perilat "
                         "plot beam.h5 -o loop.png ![a](shown.png) my.nml.bak' >> task.md"),
                   0);
  expect(w, "grade memory --publish given", 0, "left out answer.plm: it is an answer");
  says(w, "left out beam.h5: it is a result");
  says(w, "left out marks.csv: nothing that students get names it");
  assert_int_equal(shell(w, "cd given; find . -type f | sort | tr '\\n' ' '"), 0);
  assert_string_equal(w->said, "./beam.nml ./data/outline.csv ./deep.plm ./exercise.nml "
                               "./my.nml.bak ./public.nml ./shown.png ./side.plm ./starter.plm "
                               "./task.md ");
}

/* A constant of the student's may have any value. */
static void formulas_are_not_the_students(void **state) {
  workplace *w = *state;
  assert_int_equal(
      shell(w, "sed -i 's/sqrt(3)\\/2\\*E\\*s\\*t\\*S_t/EA*S_t/' memory/public.nml && grep -q "
               "EA.S_t memory/public.nml"),
      0);
  answer(w, RIGIDITY "sqrt(3)*E*s*t|");
  expect(w, "grade memory answer.plm", 2, "      0 of  20  Out and in");
  assert_int_equal(shell(w, "sed 's/\\bEA\\b/rigidity/' right.plm > answer.plm"), 0);
  assert_int_equal(shell(w, "sed -i 's/\\bEA\\b/rigidity/g' answer.plm"), 0);
  expect(w, "grade memory answer.plm", 0, "20 of  20  Out and in");
}

/* --- runs ------------------------------------------------------------------------------------- */

/* The deck of a run says `model = './answer.plm'`; another law of that name beside it is not the
   one that is marked. */
static void runs_are_of_the_law_that_is_marked(void **state) {
  workplace *w = *state;
  assert_int_equal(shell(w, "cp -r '" SOURCE_DIR "/examples/course/06_damping' run; mkdir class; "
                            "cp run/teacher/solution.plm right.plm; cp right.plm class/ada.plm; "
                            "cp run/teacher/wrong/half.plm class/bob.plm"),
                   0);
  for (int wrong = 0; wrong < 2; wrong++) {
    assert_int_equal(shell(w, "cp %s run/answer.plm", wrong ? "class/bob.plm" : "right.plm"), 0);
    assert_int_equal(shell(w, "$P grade run right.plm"), 0);
    says(w, "     10 of  10  Two swings");
    expect(w, "grade run class --csv marks.csv", 2, "");
    assert_int_equal(shell(w, "cut -d, -f1,8 marks.csv"), 0);
    says(w, "\"ada\",10\n\"bob\",0\n");
  }
}

/* Runs of the same law are those of the first that had it, whoever that was; nearly the same is
   not. Two are judged at a time: the same follow behind. */
static void the_same_law_has_the_same_runs(void **state) {
  workplace *w = *state;
  assert_int_equal(
      shell(w, "cp -r '" SOURCE_DIR "/examples/course/06_damping' run; mkdir class; cp "
               "run/teacher/solution.plm class/a.plm; cp run/teacher/wrong/half.plm class/b.plm; "
               "for k in c d e; do cp class/a.plm class/$k.plm; done; for k in 1 2 3 4; do cp "
               "class/a.plm class/f$k.plm; (echo '! mine'; sed 's/^  //; s/$/  ! \"so\"/; s/=/  "
               "=/' class/b.plm) > class/g$k.plm; done; sed 's/2.zeta/2.2*zeta/' class/a.plm > "
               "class/h.plm; sed 's/^  force.*/& != 2/' class/a.plm > class/i.plm; ! cmp -s "
               "class/a.plm class/h.plm && ! cmp -s class/a.plm class/i.plm"),
      0);
  expect(w, "grade run class --csv marks.csv", 2, "");
  assert_int_equal(shell(w, "cut -d, -f1,2,8 marks.csv; tail -1 marks.csv"), 0);
  says(w, "\"a\",90,10\n\"b\",20,0\n\"c\",90,10\n\"d\",90,10\n\"e\",90,10\n\"f1\",90,10\n");
  says(w, "\"g4\",20,0\n\"h\",20,0\n\"i\",0,0\n");
}

static void is_bare(const char *text, const char *wanted) {
  arena *a = arena_new();
  const handed_text t = {.text = text, .length = strlen(text)};
  const char *bare = handed_text_bare(a, &t);
  if (wanted)
    assert_string_equal(bare, wanted);
  else
    assert_null(bare);
  arena_free(a);
}

static void bare_texts_say_the_same(void **state) {
  (void)state;
  is_bare("a = 1 ! one\n\n  ! more\n\tb  = 2\r\n", "a = 1\nb = 2\n");
  is_bare("a = 12", "a = 12");
  is_bare("a = 1 2", "a = 1 2");
  is_bare("a \"x ! y  z\" ! \"k\"\nb", "a \"x ! y  z\"\nb");
  is_bare("a \"open\nb ! c\nd", "a \"open\nb\nd");
  is_bare("a ! include\nb", "a\nb");
  is_bare("include \"other.plm\"\n", NULL);
}

/* --- a class ---------------------------------------------------------------------------------- */

static void a_class_has_a_row_each(void **state) {
  workplace *w = *state;
  assert_int_equal(
      shell(w, "mkdir class class/cleo class/dora; cp right.plm class/ada.plm; cp "
               "memory/teacher/wrong/half.plm class/bob.plm; cp right.plm class/cleo/answer.plm"),
      0);
  expect(w,
         "grade memory class --csv marks.csv --junit marks.xml --html marks.html --seed 3 --json "
         "> marks.json",
         2, "");
  assert_int_equal(shell(w, "cut -d, -f1-8 marks.csv"), 0);
  says(w, "name,points,of,\"check\",\"Out and in\",\"Cycles\",\"Any material\",\"Stiffness\"\n"
          "\"ada\",90,90,20,20,30,10,10\n\"bob\",20,90,20,0,0,0,0\n\"cleo\",90,90,20,20,30,10,10\n"
          "\"dora\",0,90,,,,,\n");
  assert_int_equal(shell(w, "cat marks.json"), 0);
  says(w, "\"known\": \"wrong/half.plm\"");
  says(w, "\"trouble\": \"there is no answer\"");
  assert_int_equal(shell(w, "cat marks.xml"), 0);
  says(w, "<testsuite name=\"memory bob\" tests=\"6\" failures=\"4\" skipped=\"1\"");
  /* of the public path, and of the hidden one that asks for it */
  assert_int_equal(shell(w, "grep -c '<svg' marks.html; grep -c '<script' marks.html; grep -c "
                            "\"default-src 'none'\" marks.html; xmllint --noout marks.html"),
                   0);
  assert_string_equal(w->said, "2\n0\n1\n");
}

/* Curves are shown of public paths, where the exercise says no other thing. */
static void public_paths_have_curves(void **state) {
  workplace *w = *state;
  assert_int_equal(shell(w, "sed -i \"s/show = 'curve'//\" memory/exercise.nml"), 0);
  answer(w, RIGIDITY "sqrt(3)*E*s*t|");
  expect(w, "grade memory answer.plm --html a.html", 2, "");
  assert_int_equal(shell(w, "grep -c '<svg' a.html; sed -n '/Out and in/,/<svg/p' a.html | "
                            "grep -c Cycles"),
                   1);
  assert_string_equal(w->said, "1\n0\n");
  assert_int_equal(shell(w, "grep -o '<table class=.rows.*</table>' a.html"), 0);
  says(w, "<tr><td>first differs</td><td>time [s]</td><td>stretch</td><td>N [N]</td>");
  says(w, "</tr><tr><td>right</td><td>");
  assert_int_equal(
      shell(w, "sed -i \"s/file = 'public.nml'/& show = 'words'/\" memory/exercise.nml"), 0);
  expect(w, "grade memory answer.plm --html a.html", 2, "");
  assert_int_equal(shell(w, "! grep -q '<svg' a.html"), 0);
}

/* A student's own folder may hold further laws; what lies in the class's is others'. */
static void further_laws_are_their_owners(void **state) {
  workplace *w = *state;
  assert_int_equal(shell(w, "mkdir -p class/eve; echo 'function rigid(modulus, step, width) = "
                            "sqrt(3)/2*modulus*step*width' | tee class/parts.plm > "
                            "class/eve/parts.plm; sed -e 's|sqrt(3)/2.E.s.t|rigid(E, s, t)|' -e "
                            "'s|^  constant EA|  include \"parts.plm\"\\n&|' right.plm | tee "
                            "class/flat.plm > class/eve/answer.plm"),
                   0);
  expect(w, "grade memory class --csv c.csv", 2, "`parts.plm` cannot be read [include]");
  assert_int_equal(shell(w, "cut -d, -f1,2 c.csv"), 0);
  says(w, "\"eve\",90\n\"flat\",0\n\"parts\",0\n");
}

/* Numbers vary from answer to answer, and not with the place or the line ends of a file. */
static void samples_are_the_answers(void **state) {
  workplace *w = *state;
  assert_int_equal(
      shell(w, "sed -i '/vary/s/points = 10/points = 10  show = '\\''curve'\\''/' "
               "memory/exercise.nml; mkdir class other class/eve; sed 's|sqrt(3)/2|0.9|' right.plm "
               "> class/ada.plm; (cat class/ada.plm; echo '! Bob') > class/bob.plm; sed "
               "'s/$/\\r/' class/ada.plm > class/eve/answer.plm; cp class/ada.plm other/x.plm"),
      0);
  assert_int_equal(
      shell(w, "drawn() { $P grade memory $1 --html $2 $3 $4 > said; grep 'class=.curve' $2 | "
               "tail -1; }; drawn class/ada.plm 1 > a; drawn class/bob.plm 2 > b; "
               "drawn class/eve/answer.plm 3 > c; drawn other/x.plm 4 > d; drawn "
               "class/ada.plm 5 --seed 4 > e; test -s a && cmp a c && cmp a d && "
               "! cmp -s a b && ! cmp -s a e"),
      0);
  expect(w, "grade memory class/ada.plm", 2, "Any material: 0 of 4, all or nothing\n");
}

/* What is no law at all is told in the table of a class. */
static void files_that_hold_nothing_are_told(void **state) {
  workplace *w = *state;
  assert_int_equal(
      shell(w,
            "mkdir -p class/dir/answer.plm; : > class/a.plm; printf ' \\n\\r\\n' > class/b.plm; "
            "printf 'PK\\0\\1' > class/c.plm; ln -s a.plm class/d.plm; cp right.plm class/e.plm"),
      0);
  expect(w, "grade memory class --csv c.csv", 2, "not judged to the end: the file is empty");
  assert_int_equal(shell(w, "sed -n '2,$s/,[^\"]*,/ /p' c.csv"), 0);
  says(w, "\"a\" \"the file is empty\"\n\"b\" \"the file is empty\"\n"
          "\"c\" \"it is not a text file\"\n\"d\" \"it is a link, not a file\"\n"
          "\"dir\" \"it is no ordinary file\"\n\"e\" \"\"\n");
}

/* --- the exercise put to the test ------------------------------------------------------------- */

static void the_exercise_holds(void **state) {
  workplace *w = *state;
  expect(w, "grade memory --self-test", 0, "memory: 2 equal forms, 5 wrong answers: all hold");
  says(w, "4 of 4 conditions seen true and false");
}

static void what_does_not_hold_is_told(void **state) {
  workplace *w = *state;
  assert_int_equal(shell(w, "(echo '! Twice.'; cat right.plm) > memory/teacher/wrong/right.plm"),
                   0);
  expect(w, "grade memory --self-test", 1, "FAIL  wrong/right.plm: it gets all points");
  assert_int_equal(shell(w, "(echo '! Not all.'; cat memory/teacher/wrong/slack.plm) > "
                            "memory/teacher/wrong/right.plm"),
                   0);
  expect(w, "grade memory --self-test", 1, "it looks like wrong/right.plm on all paths");
  assert_int_equal(shell(w, "mv memory/teacher/wrong/right.plm memory/teacher/equal/slack.plm"), 0);
  expect(w, "grade memory --self-test", 1, "FAIL  equal/slack.plm: 20 of 90 points");
  assert_int_equal(shell(w, "rm memory/teacher/equal/slack.plm; sed -i s/2.5e-3/1.5e-3/ "
                            "memory/teacher/hidden/cycles.nml"),
                   0);
  expect(w, "grade memory --self-test", 1, "3 of 4 conditions seen true and false");
  says(w, "a case of line 15 is never reached");
}

/* --- broken exercises ------------------------------------------------------------------------- */

static void broken(workplace *w, const char *change, const char *wanted) {
  assert_int_equal(shell(w, "rm -rf broken; cp -r memory broken; cd broken; %s", change), 0);
  expect(w, "grade broken right.plm", 1, wanted);
}

static void broken_exercises_are_errors_at_their_line(void **state) {
  workplace *w = *state;
  broken(w, "sed -i 's/points = 30/points = 31/' exercise.nml",
         "broken/exercise.nml:2:64: error: the points of the items add up to 101, not to 100");
  broken(w, "rm public.nml", "exercise.nml:5:68: error: there is no file `public.nml`");
  broken(w, "rm teacher/hidden/*", "there is no file `hidden/*.nml`");
  broken(w, "sed -i 's/Cycles/Out and in/' exercise.nml", "two items have the title `Out and in`");
  broken(w, "sed -i 's/sample/smaple/' exercise.nml", "exercise.nml:7:");
  broken(w, "sed -i 's/vary/wary/' exercise.nml", "`&item` has no key `wary`");
  broken(w, "sed -i 's/states = 100/quantity = \"E\"/' exercise.nml",
         "`quantity` does not go with an item 'sample'");
  broken(w, "sed -i \"s/seed = 'student'/seed = 'teacher'/\" exercise.nml", "`seed` is a whole");
  broken(w, "sed -i 's|hidden/.*nml|../right.plm|' exercise.nml", "leaves the folder");
  broken(w, "sed -i 's|hidden/.*nml|/etc/passwd|' exercise.nml", "leaves the folder");
  broken(w, "rm teacher/solution.plm", "there is no solution to judge by, `teacher/solution.plm`");
  broken(w, "sed -i 1d teacher/wrong/half.plm", "`wrong/half.plm` does not say what is wrong");
  broken(w, "sed -i 's/omega/?/' teacher/solution.plm", "has errors");
  broken(w, "sed -i 's/&path/\\&pathh/' teacher/hidden/other.nml", "other.nml:3:1: error");
  broken(w, "sed -i 's/E = /EE = /' teacher/hidden/other.nml", "has no parameter `EE`");
  broken(w, "sed -i 's/-sqrt/sqrt/' public.nml", "public.nml:5:1: error: the solution does not");
  broken(w, "sed -i \"s/&bond/\\&material model = 'bar' \\/\\n\\&bond/\" public.nml",
         "a path of an exercise names no law");
  broken(w, "echo '&itme /' >> exercise.nml", "an exercise has no group `&itme`");
  broken(w, "echo '&exercise /' >> exercise.nml", "an exercise has one `&exercise`");
  broken(w, "sed -i '/item/d' exercise.nml", "there is no `&item`");
  broken(w, "echo \"&item kind = 'run' file = '*.nml' points = 0 /\" >> exercise.nml",
         "an item 'run' has one deck");
  broken(w, "echo \"&item kind = 'run' points = 0 /\" >> exercise.nml", "needs `file`");
  broken(w, "rm exercise.nml", "exercise.nml");
}

static void commands_are_refused(void **state) {
  workplace *w = *state;
  expect(w, "grade", 1, "needs an exercise");
  expect(w, "grade memory", 1, "needs an answer or a class");
  expect(w, "grade memory right.plm right.plm", 1, "is a third");
  expect(w, "grade memory missing.plm", 1, "there is no answer `missing.plm`");
  expect(w, "grade nowhere right.plm", 1, "nowhere/exercise.nml");
  expect(w, "grade memory right.plm --self-test", 1, "one at a time");
  expect(w, "grade memory --self-test --csv a.csv", 1, "are of answers");
  expect(w, "grade memory right.plm --time never", 1, "--time takes");
  expect(w, "grade memory right.plm --memory 3", 1, "--memory takes");
  expect(w, "grade memory right.plm --seed -1", 1, "--seed takes");
  expect(w, "grade memory right.plm --csv /nowhere/a.csv", 1, "cannot write");
  assert_int_equal(shell(w, "mkdir empty"), 0);
  expect(w, "grade memory empty", 1, "there is no answer in `empty`");
}

/* --- tables of answers ------------------------------------------------------------------------ */

static void set_up_table(workplace *w) {
  assert_int_equal(shell(w, "mkdir -p table/teacher/wrong"), 0);
  write_text(w, "table/exercise.nml",
             "&exercise title = 'A table' points = 10 /\n"
             "&item kind = 'answers' file = 'answers.txt' points = 10 tolerance = 0.01 /\n");
  write_text(w, "table/teacher/solution.txt",
             "step = 1.2 us ! stable\nomega = 1.6e6 1/s\nratio = 0.25\nmode = rotation\n");
  write_text(w, "table/teacher/wrong/period.txt",
             "! A period is no frequency.\nstep = 1.2 us\nomega = 254648 1/s\nratio = 0.25\nmode "
             "= rotation\n");
}

static void tables_are_judged_line_by_line(void **state) {
  workplace *w = *state;
  set_up_table(w);
  expect(w, "grade table --self-test", 0, "all hold");
  write_text(w, "a.txt", "mode = Rotation\nstep=1.201e-6 s\nOMEGA = 1600 1/ms\nratio = 0.2505\n");
  expect(w, "grade table a.txt", 0, "10 of  10");
  write_text(w, "a.txt", "step = 2.4 us\nomega = 0.2546e6 1/s\nratio = ? \n hello\n");
  expect(w, "grade table a.txt", 2, "A period is no frequency.");
  says(w, "step is twice what it should be");
  says(w, "ratio is still to be written");
  says(w, "mode: there is no such line");
  says(w, "note: 1 line is not `name = value`");
  says(w, "note: 1 answer is still to be written");
  write_text(w, "a.txt", "step = 1.2 mm\nomega = fast\nratio = 0.5\nmode = rows\n");
  expect(w, "grade table a.txt", 2, "step is a time (s), not a length (m)");
  says(w, "omega is no number with a unit");
  says(w, "mode is wrong");
  assert_int_equal(shell(w, "$P grade table --publish given"), 0);
  expect(w, "grade given a.txt", 0,
         "?"
         " of  10  answers answers.txt: hidden, judged by the teacher");
}

/* --- parts ------------------------------------------------------------------------------------ */

static void records_that_are_broken_are_left(void **state) {
  (void)state;
  char *text;
  size_t length;
  marks m;
  const double numbers[4] = {7, 2, 3, 0.5};
  FILE *out = must_open_text(&text, &length);
  record_write(out, RECORD_MARK, 0, numbers, NULL);        /* a share beyond 1 */
  record_write(out, RECORD_MARK, 9, numbers, NULL);        /* an item that is not */
  record_write(out, RECORD_WORDS, 1, NULL, "\033[31mred"); /* no control characters */
  record_write(out, RECORD_END, -1, NULL, NULL);
  must_close_text(out);
  marks_open(&m, "x", 2);
  records_read(&m, text, length - 1);
  assert_true(m.items[0].judged);
  assert_true(m.items[0].share == 0);
  assert_int_equal(m.items[0].of, 3);
  assert_string_equal(m.items[1].words, "\\x1b[31mred");
  assert_false(m.ended);
  records_read(&m, text, length);
  assert_true(m.ended);
  marks_close(&m);
  free(text);
}

static void text_in_pages_is_written_out(void **state) {
  (void)state;
  char *text;
  size_t length;
  FILE *out = must_open_text(&text, &length);
  marks_curve(out, "x<\n1\ny\033\n<N>\n0 0 1 1 nan 2 \n0 0 1 0.5 <script> 3\n");
  marks_curve(out, "");
  must_close_text(out);
  assert_non_null(strstr(text, "<svg"));
  assert_null(strstr(strstr(text, "<svg") + 1, "<svg"));
  assert_non_null(strstr(text, ">x&lt;</text>"));
  assert_non_null(strstr(text, "&lt;N&gt;"));
  assert_non_null(strstr(text, "</span>right</li>"));
  assert_null(strstr(text, "script"));
  assert_null(strchr(text, '\033'));
  free(text);
  assert_string_equal(points_shown(40. * 2 / 3), "26.67");
  assert_string_equal(points_shown(20), "20");
}

/* The reference page lists every key. */
static void the_reference_is_the_grammars(void **state) {
  workplace *w = *state;
  char *text;
  size_t length;
  FILE *out = must_open_text(&text, &length);
  deck_reference(&exercise_grammar, out);
  must_close_text(out);
  assert_int_equal(shell(w, "cat '" SOURCE_DIR "/generator/exercise/README.md' > page"), 0);
  char *page = read_bytes(w, "page", &length);
  if (!strstr(page, text)) fail_msg("generator/exercise/README.md has not\n%s", text);
  free(page);
  free(text);
}

int main(void) {
#define TEST(name) cmocka_unit_test_setup_teardown(name, set_up, tear_down_workplace)
  const struct CMUnitTest tests[] = {TEST(right_answers_get_all_points),
                                     TEST(known_wrong_answers_get_their_sentence),
                                     TEST(others_get_general_words),
                                     TEST(factors_are_told_where_all_have_one),
                                     TEST(numbers_for_names_are_told),
                                     TEST(errors_are_told_at_their_line),
                                     TEST(waivers_of_an_answer_do_not_count),
                                     TEST(messages_name_the_file_that_was_given),
                                     TEST(warnings_are_shown),
                                     TEST(defaults_are_the_exercises),
                                     TEST(cases_that_no_path_reaches_are_noted),
                                     TEST(hidden_items_stay_hidden),
                                     TEST(publishing_refuses),
                                     TEST(folders_above_are_made),
                                     TEST(public_items_tell_no_roots),
                                     TEST(what_nobody_names_is_not_published),
                                     TEST(formulas_are_not_the_students),
                                     TEST(runs_are_of_the_law_that_is_marked),
                                     TEST(the_same_law_has_the_same_runs),
                                     cmocka_unit_test(bare_texts_say_the_same),
                                     TEST(a_class_has_a_row_each),
                                     TEST(public_paths_have_curves),
                                     TEST(further_laws_are_their_owners),
                                     TEST(samples_are_the_answers),
                                     TEST(files_that_hold_nothing_are_told),
                                     TEST(the_exercise_holds),
                                     TEST(what_does_not_hold_is_told),
                                     TEST(broken_exercises_are_errors_at_their_line),
                                     TEST(commands_are_refused),
                                     TEST(tables_are_judged_line_by_line),
                                     cmocka_unit_test(records_that_are_broken_are_left),
                                     cmocka_unit_test(text_in_pages_is_written_out),
                                     TEST(the_reference_is_the_grammars)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
