/* Formatting keeps meaning and comments, is done after one pass, and lays out as the reference
 * shows. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include <ctype.h>
#include <glob.h>
#include <sys/stat.h>
#include <time.h>
#include <unistd.h>

#include "dsl/print/format.h"
#include "dsl/syntax/parse.h"
#include "tests/dsl/text_files.h"

/* NULL when the text has errors. */
static char *formatted(const char *text, size_t length) {
  source_set sources = {0};
  diagnostics d;
  diag_begin(&d, &sources);
  int file = source_add(&sources, "law.plm", text, length);
  char *result = format_model(&sources, file, &d);
  assert_true(result ? d.errors == 0 : d.errors > 0);
  for (int i = 0; i < d.count; i++)
    if (strstr(d.items[i].message, "fault of perilat"))
      fail_msg("%s\n%s", d.items[i].message, text);
  diag_clear(&d);
  source_clear(&sources);
  return result;
}

static void assert_formats(const char *before, const char *after) {
  char *found = formatted(before, strlen(before));
  assert_non_null(found);
  assert_string_equal(found, after);
  free(found);
}

#define AROUND(lines) "model m\n  law central bond\n" lines "end model\n"

static void a_messy_law_is_laid_out(void **state) {
  (void)state;
  size_t length;
  char *before = read_file(SOURCE_DIR "/tests/dsl/golden/format_before.plm", &length);
  assert_non_null(before);
  char *after = formatted(before, length);
  assert_non_null(after);
  assert_golden(SOURCE_DIR "/tests/dsl/golden/format_after.plm", after);
  free(after);
  free(before);
}

static void blanks_are_set(void **state) {
  (void)state;
  assert_formats(AROUND("x=-a * - b **-2/(  c+ -d )\nforce   N = f( x ,y )- +g : h\n"),
                 AROUND("  x = -a*-b**-2/(c + -d)\n  force N = f(x, y) - +g:h\n"));
  assert_formats(AROUND("force N=k*(|1 when a>b|2 otherwise)\n"),
                 AROUND("  force N = k*(| 1 when a > b | 2 otherwise)\n"));
  assert_formats(AROUND("x[ j ]=y'[ j ]+30[ kg / m^3 ]\n"),
                 AROUND("  x[j] = y'[j] + 30 [ kg / m^3 ]\n"));
}

static void line_ends_and_marks_are_plain(void **state) {
  (void)state;
  assert_formats("\xEF\xBB\xBFmodel m\r\n\tlaw central bond  ! kind  \r\n\r\n\r\n\r\nforce N = "
                 "1\t\"t\"\r\nend model",
                 "model m\n  law central bond  ! kind\n\n  force N = 1  \"t\"\nend model\n");
}

static void columns_count_characters(void **state) {
  (void)state;
  assert_formats(AROUND("output a = 1 [\xC2\xB5m] \"x\"\noutput b = 1 [mm] \"y\"\n"),
                 AROUND("  output a = 1 [\xC2\xB5m]  \"x\"\n  output b = 1 [mm]  \"y\"\n"));
}

static void brackets_stay_as_written(void **state) {
  (void)state;
  assert_formats(AROUND("x = ((a)*(b + (c)))\n"), AROUND("  x = ((a)*(b + (c)))\n"));
}

static void included_texts_can_be_formatted(void **state) {
  (void)state;
  assert_formats("! for all\nfunction f(x)=x**2\nconstant ab=1\nconstant c=2\n",
                 "! for all\nfunction f(x) = x**2\nconstant ab = 1\nconstant c  = 2\n");
  assert_formats(AROUND("include   \"nowhere.plm\"\nforce N = 1\n"),
                 AROUND("  include \"nowhere.plm\"\n  force N = 1\n"));
}

static void faulty_texts_are_left_alone(void **state) {
  (void)state;
  static const char *const faulty[] = {"nonsense",
                                       "model",
                                       AROUND("force N = (1\n"),
                                       AROUND("force N = 1; 2\n"),
                                       "model m\nforce N = 1\n",
                                       "function f(x) = \n"};
  for (size_t i = 0; i < sizeof faulty / sizeof faulty[0]; i++)
    assert_null(formatted(faulty[i], strlen(faulty[i])));
}

/* --- every law there is ----------------------------------------------------------------------- */

static char *no_include(void *context, const char *name, const char *from, char **found) {
  (void)context;
  (void)from;
  *found = strdup(name);
  return strdup("");
}

/* The tree as text; NULL when there are errors. */
static char *tree_text(const char *text, size_t length) {
  source_set sources = {0};
  diagnostics d;
  diag_begin(&d, &sources);
  arena *memory = arena_new();
  const parse_options options = {no_include, NULL};
  tree *t =
      parse_model(memory, &sources, source_add(&sources, "law.plm", text, length), &options, &d);
  char *dump = NULL;
  if (t && d.errors == 0) {
    FILE *out = open_memstream(&dump, &length);
    tree_dump(t, out);
    fclose(out);
  }
  arena_free(memory);
  diag_clear(&d);
  source_clear(&sources);
  return dump;
}

/* All that does not count as layout: the text without its blanks, and without `&`, which may go
 * before a `|`. */
static char *without_blanks(const char *text) {
  char *kept = must_calloc(strlen(text) + 1, 1), *to = kept;
  for (; *text; text++)
    if (!isspace((unsigned char)*text) && *text != '&') *to++ = *text;
  return kept;
}

static bool check_file(const char *path) {
  size_t length;
  char *text = read_file(path, &length);
  assert_non_null(text);
  char *before = tree_text(text, length), *once = before ? formatted(text, length) : NULL;
  if (before) {
    assert_non_null(once);
    char *after = tree_text(once, strlen(once)), *twice = formatted(once, strlen(once));
    if (!after || strcmp(before, after) != 0)
      fail_msg("%s means something else now:\n%s", path, once);
    if (strcmp(once, twice) != 0)
      fail_msg("%s: a second pass changes\n%s\nto\n%s", path, once, twice);
    char *old_words = without_blanks(text), *new_words = without_blanks(once);
    if (strcmp(old_words, new_words) != 0)
      fail_msg("%s: something was lost or added:\n%s", path, once);
    for (const char *line = once; line; line = strchr(line + 1, '\n'))
      if (line > once && isspace((unsigned char)line[-1]) && line[-1] != '\n')
        fail_msg("%s: blanks at a line's end", path);
    free(old_words);
    free(new_words);
    free(after);
    free(twice);
  }
  bool right = before != NULL;
  free(once);
  free(before);
  free(text);
  return right;
}

static void every_law_keeps_its_meaning(void **state) {
  (void)state;
  static const char *const places[] = {"/models/*.plm", "/tests/*/*.plm", "/tests/*/*/*.plm",
                                       "/tests/*/*/*/*.plm", "/examples/*/*.plm"};
  int checked = 0;
  for (size_t i = 0; i < sizeof places / sizeof places[0]; i++) {
    char pattern[4096];
    snprintf(pattern, sizeof pattern, "%s%s", SOURCE_DIR, places[i]);
    glob_t found;
    if (glob(pattern, 0, NULL, &found) != 0) continue;
    for (size_t k = 0; k < found.gl_pathc; k++)
      checked += check_file(found.gl_pathv[k]);
    globfree(&found);
  }
  assert_true(checked > 50);
}

/* Blanks are put in and taken out at random between the tokens of a law; the layout does not
 * change. */
static void layout_does_not_depend_on_blanks(void **state) {
  (void)state;
  size_t length;
  char *text = read_file(SOURCE_DIR "/tests/dsl/golden/splm_concrete.plm", &length);
  char *expected = formatted(text, length), *messy = must_calloc(4 * length + 1, 1);
  unsigned random = 1;
  for (int pass = 0; pass < 200; pass++) {
    char *to = messy;
    bool quoted = false, comment = false, bracket = false;
    for (const char *c = text; *c; c++) {
      if (*c == '\n') quoted = comment = bracket = false;
      if (*c == '"' && !comment) quoted = !quoted;
      if (*c == '!' && !quoted) comment = true;
      if (*c == '[') bracket = true;
      if (*c == ']') bracket = false;
      *to++ = *c;
      random = random * 1664525u + 1013904223u;
      bool free_place = !quoted && !comment && !bracket && *c == ' ';
      for (unsigned n = random >> 29; free_place && n > 0; n--)
        *to++ = n & 1 ? ' ' : '\t';
    }
    *to = 0;
    char *found = formatted(messy, (size_t)(to - messy));
    assert_non_null(found);
    assert_string_equal(found, expected);
    free(found);
  }
  free(messy);
  free(expected);
  free(text);
}

/* Megabytes of nonsense that parses are laid out in a moment. */
static void large_texts_take_no_time(void **state) {
  (void)state;
  static const struct {
    const char *head, *part, *tail;
  } shapes[] = {{"x =", "\n|1 when a>b", "\n|2 otherwise\n"},
                {"x =", "\n|(|1 when a>b\n|2 otherwise) when a>b", "\n|2 otherwise\n"},
                {"x = max(1", "&\n,max(a,b)", ")\n"},
                {"", "! c\n", ""},
                {"", "parameter a = 1 in (0, 2) \"t\" ! c\n\n", ""},
                {"x = 1 ", "& ! c\n", "\n"}};
  for (size_t k = 0; k < sizeof shapes / sizeof shapes[0]; k++) {
    size_t size = 400000, at;
    char *text = must_calloc(size + 200, 1);
    at = (size_t)sprintf(text, "model m\nlaw central bond\n%s", shapes[k].head);
    while (at < size)
      at += (size_t)sprintf(text + at, "%s", shapes[k].part);
    at += (size_t)sprintf(text + at, "%send model\n", shapes[k].tail);
    clock_t begun = clock();
    free(formatted(text, at));
    double seconds = (double)(clock() - begun) / CLOCKS_PER_SEC;
    if (seconds > 20) fail_msg("shape %zu took %.1f s", k, seconds);
    free(text);
  }
}

/* --- the command ------------------------------------------------------------------------------ */

static void the_command_checks_and_writes(void **state) {
  (void)state;
  char folder[] = "format_XXXXXX", path[64], link[64], command[4096];
  assert_non_null(mkdtemp(folder));
  snprintf(path, sizeof path, "%s/law.plm", folder);
  snprintf(link, sizeof link, "%s/link.plm", folder);
  write_file(path, "model m\nlaw central bond\nforce N=1 [N]*stretch\nend model\n");
  assert_int_equal(chmod(path, 0640), 0);
  assert_int_equal(symlink("law.plm", link), 0);
  int status;
  static const char right[] = "model m\n  law central bond\n  force N = 1 [N]*stretch\nend model\n";
  snprintf(command, sizeof command, "%s format --check %s 2>/dev/null", PERILAT_PROGRAM, path);
  free(run_command(command, &status));
  assert_int_equal(status, 1);
  snprintf(command, sizeof command, "%s format %s", PERILAT_PROGRAM, path);
  char *printed = run_command(command, &status);
  assert_string_equal(printed, right);
  free(printed);
  snprintf(command, sizeof command, "%s format -i %s && %s format --check %s", PERILAT_PROGRAM,
           link, PERILAT_PROGRAM, path);
  free(run_command(command, &status));
  assert_int_equal(status, 0);
  size_t length;
  char *written = read_file(path, &length);
  assert_string_equal(written, right);
  free(written);
  struct stat about;
  assert_int_equal(lstat(path, &about), 0);
  assert_int_equal(about.st_mode & 07777, 0640);
  assert_int_equal(lstat(link, &about), 0);
  assert_true(S_ISLNK(about.st_mode));
  snprintf(command, sizeof command, "ls %s | wc -l; rm -r %s", folder, folder);
  printed = run_command(command, &status);
  assert_int_equal(atoi(printed), 2); /* nothing was left beside it */
  free(printed);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(a_messy_law_is_laid_out),
      cmocka_unit_test(blanks_are_set),
      cmocka_unit_test(line_ends_and_marks_are_plain),
      cmocka_unit_test(columns_count_characters),
      cmocka_unit_test(brackets_stay_as_written),
      cmocka_unit_test(included_texts_can_be_formatted),
      cmocka_unit_test(faulty_texts_are_left_alone),
      cmocka_unit_test(every_law_keeps_its_meaning),
      cmocka_unit_test(layout_does_not_depend_on_blanks),
      cmocka_unit_test(large_texts_take_no_time),
      cmocka_unit_test(the_command_checks_and_writes),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
