/* The language reference and its laws: every ```plm block of dsl/README.md is a law without a
   message, which compiles where it is one of families; every ```plm-error block gives exactly the
   ```text block after it. The reference lists every diagnostic code and every built-in name. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>
#include <stdlib.h>
#include <string.h>

#include "dsl/semantics/law_check.h"
#include "dsl/syntax/parse.h"

#define PAGE SOURCE_DIR "/dsl/README.md"

static char *read_page(void) {
  FILE *f = fopen(PAGE, "rb");
  assert_non_null(f);
  fseek(f, 0, SEEK_END);
  size_t length = (size_t)ftell(f);
  rewind(f);
  char *page = must_calloc(length + 1, 1);
  assert_int_equal(fread(page, 1, length, f), length);
  fclose(f);
  return page;
}

/* Next block fenced as ```kind at or after *at, to be freed; *at moves behind it. NULL without one.
 */
static char *next_block(const char **at, const char *kind) {
  char fence[32];
  snprintf(fence, sizeof fence, "\n```%s\n", kind);
  const char *begin = strstr(*at, fence);
  if (!begin) return NULL;
  begin += strlen(fence);
  const char *end = strstr(begin, "```\n");
  assert_non_null(end);
  *at = end;
  return strndup(begin, (size_t)(end - begin));
}

/* All that the checker says about a law, as text to be freed. */
static char *messages_for(const char *text) {
  char *printed = NULL;
  size_t length;
  source_set sources = {0};
  diagnostics d;
  diag_begin(&d, &sources);
  arena *memory = arena_new();
  int file = source_add(&sources, "law.plm", text, strlen(text));
  const parse_options options = {NULL, NULL};
  tree *t = parse_model(memory, &sources, file, &options, &d);
  if (t && d.errors == 0) law_check(memory, t, &sources, NULL, 0, &d);
  FILE *out = open_memstream(&printed, &length);
  diag_print(&d, out);
  fclose(out);
  arena_free(memory);
  diag_clear(&d);
  source_clear(&sources);
  return printed;
}

static void laws_of_the_reference_are_right(void **state) {
  (void)state;
  char *page = read_page(), *text;
  const char *at = page;
  int count = 0;
  for (; (text = next_block(&at, "plm")); count++) {
    char *said = messages_for(text);
    if (*said) fail_msg("%s\n%s", text, said);
    free(said);
    free(text);
  }
  assert_true(count >= 8);
  free(page);
}

/* Laws of families are also compiled and put through the physics checks. */
static void laws_of_families_of_the_reference_hold(void **state) {
  (void)state;
  char *page = read_page(), *text;
  const char *at = page;
  int count = 0;
  for (; (text = next_block(&at, "plm")); free(text)) {
    if (!strstr(text, "law state")) continue;
    FILE *out = fopen("reference_law.plm", "w");
    assert_non_null(out);
    fputs(text, out);
    assert_int_equal(fclose(out), 0);
    if (system("'" PERILAT_PROGRAM "' check reference_law.plm --dump=c > reference_law.txt 2>&1"))
      fail_msg("%s\nis refused; see reference_law.txt", text);
    count++;
  }
  remove("reference_law.plm");
  remove("reference_law.txt");
  assert_true(count >= 4);
  free(page);
}

static void faults_of_the_reference_give_the_messages_shown(void **state) {
  (void)state;
  char *page = read_page(), *text;
  const char *at = page;
  int count = 0;
  for (; (text = next_block(&at, "plm-error")); count++) {
    char *shown = next_block(&at, "text"), *said = messages_for(text);
    assert_non_null(shown);
    assert_string_equal(said, shown);
    free(said);
    free(shown);
    free(text);
  }
  assert_true(count >= 2);
  free(page);
}

static void assert_listed(const char *page, const char *before, const char *name,
                          const char *after) {
  char quoted[80];
  snprintf(quoted, sizeof quoted, "%s%s%s", before, name, after);
  if (!strstr(page, quoted)) fail_msg("dsl/README.md does not list %s", name);
}

/* | `name`, `another` | unit | laws | meaning | */
static void the_reference_says_what_laws_read(void **state) {
  (void)state;
  char *page = read_page(), quoted[80], laws[80];
  for (int q = 0; q < QUANTITY_COUNT; q++) {
    const builtin_quantity_info *b = &builtin_quantities[q];
    snprintf(quoted, sizeof quoted, "`%s`", b->name);
    snprintf(laws, sizeof laws, "| %s |", builtin_laws(b->kinds));
    bool listed = false;
    for (const char *line = page; line && !listed; line = strchr(line, '\n')) {
      line += *line == '\n';
      const char *end = line + strcspn(line, "\n"), *name = strstr(line, quoted);
      const char *found = strstr(line, laws);
      listed = *line == '|' && name && name < end && found && found < end;
    }
    if (!listed) fail_msg("dsl/README.md has no row with %s %s", quoted, laws);
  }
  free(page);
}

static void the_reference_lists_every_code_and_name(void **state) {
  (void)state;
  char *page = read_page();
  for (int k = 0; k < DIAG_COUNT; k++)
    assert_listed(page, "`", diag_name((diag_code)k), "`");
  for (int q = 0; q < QUANTITY_COUNT; q++)
    assert_listed(page, "`", builtin_quantities[q].name, "`");
  for (int f = 0; f < FUNCTION_COUNT; f++)
    assert_listed(page, "`", builtin_functions[f].name, "");
  free(page);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(laws_of_the_reference_are_right),
      cmocka_unit_test(laws_of_families_of_the_reference_hold),
      cmocka_unit_test(faults_of_the_reference_give_the_messages_shown),
      cmocka_unit_test(the_reference_says_what_laws_read),
      cmocka_unit_test(the_reference_lists_every_code_and_name),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
