/* perilat grade and files that mean harm, or look as if: each is judged to an end, within its
   limits, with less than full points; nothing outside is read or written, no control character is
   printed, and the next one is judged as ever. With PERILAT_SHOW set, times and memory are
   listed. */
#define _GNU_SOURCE
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>
#include <fcntl.h>
#include <netinet/in.h>
#include <stdbool.h>
#include <sys/resource.h>
#include <sys/socket.h>

#include "dsl/base/arena.h"
#include "generator/grade/confine.h"
#include "tests/generator/command_tools.h"

enum { LIMIT = 4 /* s, of processor time */ };
static const char head[] = "model answer\n  law central bond\n  for plane_stress\n"
                           "  parameter E = 30 [GPa] in (0, inf)\n"
                           "  parameter rho = 2323 [kg/m^3] in (0, inf)\n"
                           "  parameter S_t = 1e-4 in (0, inf)\n"
                           "  parameter S_u = 2e-3 in (0, inf)\n";
static const char tail[] = "  force N = E*s*t*stretch\nend model\n";

static int set_up(void **state) {
  if (set_up_workplace(state) != 0) return -1;
  return shell(*state, "cp -r '" SOURCE_DIR "/tests/generator/grade/memory' memory && "
                       "cp memory/teacher/solution.plm right.plm && mkdir class tmp");
}

/* --- one answer ------------------------------------------------------------------------------- */

static double seconds_now(void) {
  struct timespec t;
  clock_gettime(CLOCK_MONOTONIC, &t);
  return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

/* What would move a terminal's cursor, or end its line elsewhere. */
static bool is_clean(const char *text) {
  for (; *text; text++)
    if ((unsigned char)*text < ' ' && *text != '\n' && *text != '\t') return false;
  return true;
}

static void judged(workplace *w, const char *name, const char *wanted) {
  const double begun = seconds_now();
  const int status =
      shell(w, "TMPDIR=$PWD/tmp $P grade memory '%s' --time '%d s' --memory 1GB", name, LIMIT);
  const double took = seconds_now() - begun;
  struct rusage most;
  getrusage(RUSAGE_CHILDREN, &most);
  if (getenv("PERILAT_SHOW"))
    fprintf(stderr, "%6.2f s, at most %ld MB  %s: %.300s\n", took, most.ru_maxrss / 1024, name,
            w->said);
  if (status != 2 || !strstr(w->said, wanted) || strstr(w->said, "root:") || !is_clean(w->said))
    show_failure(w, name, status, 2, wanted);
  assert_int_equal(status, 2);
  assert_non_null(strstr(w->said, wanted));
  assert_null(strstr(w->said, "root:"));
  assert_null(strstr(w->said, "largest stretch"));
  assert_true(is_clean(w->said));
  assert_true(strlen(w->said) < SAID_SIZE - 2);
  assert_int_equal(shell(w, "ls tmp"), 0);
  assert_string_equal(w->said, "");
}

static void text_judged(workplace *w, const char *text, const char *wanted) {
  write_text(w, "answer.plm", text);
  judged(w, "answer.plm", wanted);
}

/* A law with lines of its own. */
static void law_judged(workplace *w, const char *lines, const char *wanted) {
  char *text;
  size_t length;
  FILE *out = must_open_text(&text, &length);
  fprintf(out, "%s%s%s", head, lines, tail);
  must_close_text(out);
  text_judged(w, text, wanted);
  free(text);
}

/* `first`, `part` so many times, `last`. */
static void repeated_judged(workplace *w, const char *first, const char *part, int times,
                            const char *last, const char *wanted) {
  char *text;
  size_t length;
  FILE *out = must_open_text(&text, &length);
  fputs(first, out);
  for (int k = 0; k < times; k++)
    fputs(part, out);
  fputs(last, out);
  must_close_text(out);
  law_judged(w, text, wanted);
  free(text);
}

/* A line for each number, `format` taking it twice. */
static void numbered_judged(workplace *w, const char *first, const char *format, int times,
                            const char *wanted) {
  char *text;
  size_t length;
  FILE *out = must_open_text(&text, &length);
  fputs(first, out);
  for (int k = 0; k < times; k++) {
    const char *at = format;
    int number = k + 1;
    for (; *at; at++) {
      if (*at == '#')
        fprintf(out, "%d", number);
      else if (*at == '@')
        fprintf(out, "%d", k);
      else
        fputc(*at, out);
    }
  }
  must_close_text(out);
  law_judged(w, text, wanted);
  free(text);
}

/* --- files ------------------------------------------------------------------------------------ */

static void files_that_are_no_laws(void **state) {
  workplace *w = *state;
  text_judged(w, "", "0 of  90");
  text_judged(w, "\n\n\n", "0 of  90");
  text_judged(w, "\xef\xbb\xbfmodel answer\r\nend model\r\n", "0 of  90");
  text_judged(w,
              "\x7f"
              "ELF\x01\x02\x03\xff\xfe",
              "0 of  90");
  write_bytes(w, "answer.plm", "model answer\0\0\0end model\n", 25);
  judged(w, "answer.plm", "0 of  90");
  assert_int_equal(shell(w, "head -c 500000 /dev/urandom > answer.plm"), 0);
  judged(w, "answer.plm", "0 of  90");
  assert_int_equal(shell(w, "head -c 50000000 /dev/zero > answer.plm"), 0);
  judged(w, "answer.plm", "it is longer than 1 MB");
  assert_int_equal(shell(w, "head -c 1000000 /dev/zero | tr '\\0' 'x' > answer.plm"), 0);
  judged(w, "answer.plm", "0 of  90");
  assert_int_equal(shell(w, "head -c 1000000 /dev/zero | tr '\\0' '\\n' > answer.plm"), 0);
  judged(w, "answer.plm", "0 of  90");
  text_judged(w, "program answer\nprint *, 'hello'\nend\n", "0 of  90");
  text_judged(w, "&simulation end_time = 1 /\n", "0 of  90");
}

static void files_that_lead_elsewhere(void **state) {
  workplace *w = *state;
  assert_int_equal(shell(w, "ln -s /etc/passwd a.plm; ln -s memory/teacher/solution.plm b.plm; ln "
                            "-s nowhere c.plm; mkfifo d.plm; ln -s d.plm e.plm; ln -s /dev/zero "
                            "f.plm; ln -s . g.plm"),
                   0);
  judged(w, "a.plm", "it is a link, not a file");
  judged(w, "b.plm", "it is a link, not a file");
  judged(w, "c.plm", "it is a link, not a file");
  judged(w, "d.plm", "it is no ordinary file");
  judged(w, "e.plm", "it is a link, not a file");
  judged(w, "f.plm", "it is a link, not a file");
  assert_int_equal(shell(w, "mkdir class/folder.plm class/x; ln -s ../memory/teacher class/y; "
                            "mkfifo class/x/answer.plm; $P grade memory class"),
                   2);
  assert_non_null(strstr(w->said, "folder.plm: A bond that tears"));
  assert_null(strstr(w->said, "90 of  90"));
}

static void includes_of_what_is_not_theirs(void **state) {
  workplace *w = *state;
  law_judged(w, "  include \"/etc/passwd\"\n", "0 of  90");
  law_judged(w, "  include \"../memory/teacher/solution.plm\"\n", "0 of  90");
  law_judged(w, "  include \"../../../../../../etc/passwd\"\n", "0 of  90");
  law_judged(w, "  include \"answer.plm\"\n", "0 of  90");
  law_judged(w, "  include \"/dev/stdin\"\n", "0 of  90");
  law_judged(w, "  include \"class/../../right.plm\"\n", "0 of  90");
  law_judged(w, "  include \"memory/teacher/solution.plm\"\n", "0 of  90");
  char path[600];
  snprintf(path, sizeof path, "  include \"%s/memory/teacher/solution.plm\"\n", w->folder);
  law_judged(w, path, "0 of  90");
  /* of the others of a class, too */
  assert_int_equal(shell(w, "cp right.plm class/ada.plm; sed 's/model answer/include "
                            "\"ada.plm\"/' right.plm > class/bob.plm; $P grade memory class"),
                   2);
  assert_non_null(strstr(w->said, "bob: A bond that tears"));
}

/* --- texts ------------------------------------------------------------------------------------ */

static void texts_that_command(void **state) {
  workplace *w = *state;
  text_judged(w, "! \033[2J\033]0;owned\007\nmodel \033[31manswer\nend model\n", "0 of  90");
  law_judged(w, "  constant x\033[2J = y\033[1A\n", "0 of  90");
  law_judged(w, "  parameter q = 1 in (0, inf) \"\033]52;c;cm0gLXJm\007\"\n", "of  90");
  law_judged(w, "  constant \xe2\x80\xae = 1\n", "0 of  90");
  law_judged(w, "  constant \xff\xfe\xfd = 1\n", "0 of  90");
  law_judged(w, "  constant %s%n%x%999999d = %n\n", "0 of  90");
  law_judged(w, "  constant c = d\r\033[K`rm -rf`$(id)\n", "0 of  90");
  assert_int_equal(shell(w, "cp answer.plm 'class/=cmd()|x'\\''\"<b>.plm'; cp answer.plm "
                            "\"class/$(printf 'a\\033[2Jb\\nc').plm\"; $P grade memory class --csv "
                            "c.csv --html c.html --junit c.xml --json > c.json"),
                   2);
  assert_true(is_clean(w->said));
  assert_int_equal(shell(w, "cat c.csv; grep -c '<b>' c.html c.xml; ! grep -q \"$(printf "
                            "'\\033')\" c.csv c.html c.xml c.json"),
                   0);
  assert_non_null(strstr(w->said, "\"'=cmd()|x'\"\"<b>\""));
  assert_non_null(strstr(w->said, "c.html:0\nc.xml:0"));
}

/* --- size ------------------------------------------------------------------------------------- */

static void deep_ones(void **state) {
  workplace *w = *state;
  repeated_judged(w, "  constant c = ", "(", 400000, "1\n", "0 of  90");
  repeated_judged(w, "  constant c = ", "-", 400000, "1\n", "0 of  90");
  repeated_judged(w, "  constant c = ", "2**", 200000, "2\n", "0 of  90");
  repeated_judged(w, "  constant c = 1", " + 1", 200000, "\n", "of  90");
  repeated_judged(w, "  constant c = ", "sqrt(", 100000, "1\n", "0 of  90");
  repeated_judged(w, "  constant c = ", "(| 1 when stretch > 0 | ", 20000, "1\n", "0 of  90");
  repeated_judged(w, "  constant c = 1", "\n    | 2 when stretch > 0", 20000, "\n", "0 of  90");
  repeated_judged(w, "", "  if stretch > 0\n", 20000, "", "0 of  90");
}

static void long_ones(void **state) {
  workplace *w = *state;
  numbered_judged(w, "  constant c0 = 1\n", "  constant c# = c@ + c@\n", 6000, "of  90");
  numbered_judged(w, "  v0 = stretch\n", "  v# = v@*v@ + v@\n", 4000, "of  90");
  numbered_judged(w, "", "  state z# on bond = 0\n  z# = max(z#, stretch)\n", 1000, "of  90");
  numbered_judged(w, "", "  parameter p# = 1 in (0, inf)\n", 3000, "of  90");
  numbered_judged(w, "", "  output o# = stretch*#\n", 1500, "of  90");
  numbered_judged(w, "", "  constant e# = unknown#\n", 8000, "0 of  90");
  numbered_judged(w, "  function f0(x) = x*x + x\n", "  function f#(x) = f@(f@(x)) + f@(x + 1)\n",
                  40, "of  90");
  numbered_judged(w, "  function f0(x) = x + 1\n", "  function f#(x) = f@(x) + f@(x*2)\n", 30,
                  "of  90");
  repeated_judged(w, "  constant ", "a_long_name_", 50000, " = 1\n", "of  90");
  repeated_judged(w, "  ! ", "comment ", 100000, "\n", "of  90");
}

/* --- numbers ---------------------------------------------------------------------------------- */

static void strange_numbers(void **state) {
  workplace *w = *state;
  law_judged(w, "  constant c = 1e999\n", "of  90");
  law_judged(w, "  constant c = 1e308*1e308\n", "of  90");
  law_judged(w, "  constant c = 0/0\n", "of  90");
  law_judged(w, "  constant c = 1e-400\n", "of  90");
  law_judged(w, "  constant c = 1 [m^1000000]\n", "0 of  90");
  law_judged(w, "  constant c = 1 [m^m^m]\n", "0 of  90");
  law_judged(w, "  constant c = 99999999999999999999999999999999999999999999\n", "of  90");
  text_judged(w,
              "model answer\n  law central bond\n  parameter E = 30 [GPa] in (0, inf)\n"
              "  parameter rho = 1 [kg/m^3] in (0, inf)\n  parameter S_t = 1e-4\n"
              "  parameter S_u = 1\n  force N = E*s*t*stretch/(stretch - stretch)\nend model\n",
              "of  90");
  text_judged(w,
              "model answer\n  law central bond\n  parameter E = 30 [GPa] in (0, inf)\n"
              "  parameter rho = 1 [kg/m^3] in (0, inf)\n  parameter S_t = 1e-4\n"
              "  parameter S_u = 1\n  force N = E*s*t*exp(1e6*stretch**2 + 1e3)\nend model\n",
              "of  90");
}

/* --- laws ------------------------------------------------------------------------------------- */

static void laws_of_other_things(void **state) {
  workplace *w = *state;
  assert_int_equal(shell(w, "for m in elastic splm_elastic lefm bond_slip bar; do sed "
                            "\"s/model $m/model answer/\" " SOURCE_DIR "/models/$m.plm > $m.plm; "
                            "done"),
                   0);
  judged(w, "elastic.plm", "of  90");
  judged(w, "splm_elastic.plm", "of  90");
  judged(w, "lefm.plm", "of  90");
  judged(w, "bond_slip.plm", "of  90");
  judged(w, "bar.plm", "of  90");
  text_judged(w, "model answer\nmodel answer\nend model\nend model\n", "0 of  90");
  law_judged(w, "end model\nmodel other\n", "0 of  90");
  law_judged(w, "  function f(x) = f(x) + 1\n  constant c = f(1)\n", "0 of  90");
  law_judged(w, "  a = b\n  b = a\n", "0 of  90");
  law_judged(w, "  state E on bond = 0\n", "0 of  90");
}

/* --- the process ------------------------------------------------------------------------------ */

/* What it can do that it may not, as bits. */
static int forbidden_things(const char *folder, const char *outside) {
  const confinement little = {.seconds = 5, .memory = 2000000000, .file = 1000};
  int done = 0;
  if (!confine(folder, &little)) return 1;
  done |= (open(outside, O_WRONLY | O_CREAT, 0600) >= 0) << 1;
  done |= (socket(AF_INET, SOCK_STREAM, 0) >= 0) << 2;
  const pid_t child = fork();
  if (child == 0) _exit(0);
  done |= (child > 0) << 3;
  execl("/bin/true", "true", (char *)NULL); /* would end it with 0, as if it could do nothing */
  done |= (mkdir("../other", 0700) == 0) << 4;
  done |= (symlink("/etc/passwd", "../link") == 0) << 5;
  const int own = open("own", O_RDWR | O_CREAT, 0600);
  done |= (own < 0) << 6;
  signal(SIGXFSZ, SIG_IGN);
  char bytes[2000] = {0};
  done |= (write(own, bytes, sizeof bytes) > 1000) << 7;
  return done;
}

static void the_process_may_do_little(void **state) {
  const workplace *w = *state;
  char folder[300], outside[300];
  int status;
  snprintf(folder, sizeof folder, "%s/tmp", w->folder);
  snprintf(outside, sizeof outside, "%s/outside", w->folder);
  const pid_t child = fork();
  assert_true(child >= 0);
  if (child == 0) _exit(forbidden_things(folder, outside) + 100);
  assert_int_equal(waitpid(child, &status, 0), child);
  assert_true(WIFEXITED(status));
  assert_int_equal(WEXITSTATUS(status), 100);
  assert_false(exists(w, "outside"));
  assert_false(exists(w, "other"));
  assert_true(exists(w, "tmp/own"));
}

/* Beside an answer, in its own folder, of which it may include laws; the honest one is last. */
static void folders_that_hold_no_laws(void **state) {
  workplace *w = *state;
  assert_int_equal(
      shell(w,
            "cd class; for k in pipe sparse folder ring self missing; do mkdir $k; sed 's/^model "
            "answer/&\\n  include \"a.plm\"/' ../right.plm > $k/answer.plm; done; mkfifo "
            "pipe/a.plm; truncate -s 1G sparse/a.plm; mkdir folder/a.plm; echo 'include "
            "\"b.plm\"' > ring/a.plm; echo 'include \"a.plm\"' > ring/b.plm; cp "
            "self/answer.plm self/a.plm; mkdir huge many order; truncate -s 1G huge/answer.plm; "
            "mkdir order/answer.plm; cp ../right.plm many/answer.plm; for k in $(seq 300); do "
            "echo > many/l$k.plm; done; ln -s . loop; mkdir zz; cp ../right.plm zz/answer.plm"),
      0);
  assert_int_equal(shell(w, "TMPDIR=$PWD/tmp $P grade memory class --time '4 s' --csv c.csv; cut "
                            "-d, -f1,2 c.csv; ls tmp"),
                   0);
  assert_non_null(strstr(w->said, "`a.plm` cannot be read [include]"));
  assert_non_null(strstr(w->said, "a text cannot include itself [include]"));
  assert_non_null(strstr(w->said,
                         "\"folder\",0\n\"huge\",0\n\"many\",90\n\"missing\",0\n\"order\",0\n"
                         "\"pipe\",0\n\"ring\",0\n\"self\",0\n\"sparse\",0\n\"zz\",90\n"));
  assert_true(is_clean(w->said));
}

/* The class goes on behind each of them. */
static void others_are_judged_as_ever(void **state) {
  workplace *w = *state;
  assert_int_equal(shell(w, "cd class; cp ../right.plm a.plm; head -c 900000 /dev/urandom > b.plm; "
                            "mkfifo c.plm; cp ../right.plm d.plm; cd ..; $P grade memory class "
                            "--csv c.csv; cut -d, -f1,2 c.csv"),
                   0);
  assert_non_null(strstr(w->said, "\"a\",90\n\"b\",0\n\"c\",0\n\"d\",90\n"));
}

/* What was earned until then stays. */
static void time_and_memory_run_out(void **state) {
  workplace *w = *state;
  char *text;
  size_t length;
  FILE *out = must_open_text(&text, &length);
  fputs(head, out);
  for (int k = 0; k < 6000; k++)
    fprintf(out, "  state z%d on bond = 0\n  z%d = max(z%d, stretch)\n", k, k, k);
  fputs(tail, out);
  must_close_text(out);
  write_text(w, "answer.plm", text);
  free(text);
  assert_int_equal(shell(w, "TMPDIR=$PWD/tmp $P grade memory answer.plm --time '1 s'; ls tmp"), 0);
  assert_non_null(strstr(w->said, "not judged to the end: it takes longer than 1 s"));
  assert_non_null(strstr(w->said, "of  90  points"));
#if !defined(__SANITIZE_ADDRESS__) /* its shadow takes more addresses than any limit leaves */
  assert_int_equal(shell(w, "$P grade memory answer.plm --memory 100MB"), 2);
  assert_non_null(strstr(w->said, "not judged to the end: it needs more than 0.1 GB of memory"));
#endif
}

int main(void) {
#define TEST(name) cmocka_unit_test_setup_teardown(name, set_up, tear_down_workplace)
  const struct CMUnitTest tests[] = {TEST(files_that_are_no_laws),
                                     TEST(files_that_lead_elsewhere),
                                     TEST(includes_of_what_is_not_theirs),
                                     TEST(texts_that_command),
                                     TEST(deep_ones),
                                     TEST(long_ones),
                                     TEST(strange_numbers),
                                     TEST(laws_of_other_things),
                                     TEST(the_process_may_do_little),
                                     TEST(folders_that_hold_no_laws),
                                     TEST(others_are_judged_as_ever),
                                     TEST(time_and_memory_run_out)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
