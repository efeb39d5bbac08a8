/* Every deck in bad/ with the exact text that a user sees. Lines "! --set x" at its head are
   overrides. With PERILAT_BLESS=1 the texts are rewritten: then read each as a user would. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include <glob.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "runtime/deck/deck_read.h"

enum { MOST_OVERRIDES = 8, LEAST_CASES = 40 };

static char *read_file(const char *path, size_t *length) {
  FILE *file = fopen(path, "rb");
  if (!file) return NULL;
  char *text = NULL;
  FILE *copy = open_memstream(&text, length);
  for (int c; (c = fgetc(file)) != EOF;)
    fputc(c, copy);
  fclose(file);
  fclose(copy);
  return text;
}

static int read_overrides(arena *a, const char *text, deck_override *overrides) {
  static const char head[] = "! --set ";
  int count = 0;
  for (; count < MOST_OVERRIDES && strncmp(text, head, strlen(head)) == 0; count++) {
    text += strlen(head);
    size_t length = strcspn(text, "\n");
    overrides[count].text = arena_text(a, text, length);
    text += length + 1;
  }
  return count;
}

static char *messages_of(const char *path, bool *refused) {
  size_t length;
  char *text = read_file(path, &length);
  assert_non_null(text);
  source_set sources = {0};
  diagnostics d;
  arena *a = arena_new();
  deck_override overrides[MOST_OVERRIDES];
  int count = read_overrides(a, text, overrides);
  diag_begin(&d, &sources);
  int file = source_add(&sources, strrchr(path, '/') + 1, text, length);
  *refused = deck_read(a, &sources, file, overrides, count, &d) == NULL;
  assert_int_equal(*refused, d.errors > 0);

  char *messages = NULL;
  FILE *out = open_memstream(&messages, &length);
  diag_print(&d, out);
  fclose(out);
  diag_clear(&d);
  source_clear(&sources);
  arena_free(a);
  free(text);
  return messages;
}

static bool as_expected(const char *path, const char *messages) {
  char expected_path[4096];
  snprintf(expected_path, sizeof(expected_path), "%.*s.txt", (int)strlen(path) - 4, path);
  if (getenv("PERILAT_BLESS")) {
    FILE *out = fopen(expected_path, "wb");
    assert_non_null(out);
    fputs(messages, out);
    fclose(out);
  }
  size_t length;
  char *expected = read_file(expected_path, &length);
  bool same = expected && strcmp(expected, messages) == 0;
  if (!same)
    print_message("%s\n--- expected\n%s--- got\n%s", path, expected ? expected : "(no file)\n",
                  messages);
  free(expected);
  return same;
}

static void bad_decks_say_what_is_wrong(void **state) {
  (void)state;
  glob_t found;
  int different = 0;
  assert_int_equal(glob(SOURCE_DIR "/tests/runtime/deck/bad/*.nml", 0, NULL, &found), 0);
  for (size_t i = 0; i < found.gl_pathc; i++) {
    const char *path = found.gl_pathv[i];
    bool refused, warning = strstr(path, "/warning_") != NULL;
    char *messages = messages_of(path, &refused);
    if (refused == warning || *messages == '\0') {
      print_message("%s was %s\n", path, refused ? "refused" : "read without a word");
      different++;
    }
    different += !as_expected(path, messages);
    free(messages);
  }
  assert_true(found.gl_pathc >= LEAST_CASES);
  globfree(&found);
  assert_int_equal(different, 0);
}

int main(void) {
  const struct CMUnitTest tests[] = {cmocka_unit_test(bad_decks_say_what_is_wrong)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
