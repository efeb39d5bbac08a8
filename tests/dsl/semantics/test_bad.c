/* Every faulty program of tests/dsl/bad gives exactly the messages beside it. With PERILAT_BLESS=1
   in the environment the files of expected messages are rewritten instead; read what changed. */
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

#define FOLDER SOURCE_DIR "/tests/dsl/bad/"
enum { PATH_LONGEST = 4096 };

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

/* Included texts lie in the same folder and keep their bare names. */
static char *read_beside(void *context, const char *name, const char *from, char **found) {
  (void)context;
  (void)from;
  char path[PATH_LONGEST];
  snprintf(path, sizeof path, "%s%s", FOLDER, name);
  size_t length;
  char *content = read_file(path, &length);
  if (content) *found = strdup(name);
  return content;
}

/* The messages for one program, as text to be freed. */
static char *messages_for(const char *name, int *count) {
  char path[PATH_LONGEST];
  snprintf(path, sizeof path, "%s%s", FOLDER, name);
  size_t length, printed_length;
  char *content = read_file(path, &length), *printed = NULL;
  assert_non_null(content);
  source_set sources = {0};
  diagnostics d;
  diag_begin(&d, &sources);
  arena *memory = arena_new();
  int file = source_add(&sources, name, content, length);
  const parse_options options = {read_beside, NULL};
  tree *t = parse_model(memory, &sources, file, &options, &d);
  if (t && d.errors == 0) law_check(memory, t, &sources, NULL, 0, &d);
  FILE *out = open_memstream(&printed, &printed_length);
  diag_print(&d, out);
  fclose(out);
  *count = d.count;
  arena_free(memory);
  diag_clear(&d);
  source_clear(&sources);
  free(content);
  return printed;
}

static void write_expected(const char *path, const char *messages) {
  FILE *f = fopen(path, "wb");
  assert_non_null(f);
  fputs(messages, f);
  assert_int_equal(fclose(f), 0);
}

/* PERILAT_BLESS=1 blesses all programs, any other value those whose names begin with it. */
static bool to_be_blessed(const char *name) {
  const char *prefix = getenv("PERILAT_BLESS");
  return prefix && (strcmp(prefix, "1") == 0 || strncmp(name, prefix, strlen(prefix)) == 0);
}

/* 1 when the messages differ from those expected (both are then shown). */
static int compare(const char *name, const char *messages) {
  char path[PATH_LONGEST];
  snprintf(path, sizeof path, "%s%.*s.txt", FOLDER, (int)(strlen(name) - 4), name);
  if (to_be_blessed(name)) {
    write_expected(path, messages);
    return 0;
  }
  size_t length = 0;
  char *expected = read_file(path, &length);
  bool same = expected && strcmp(expected, messages) == 0;
  if (!same)
    print_error("%s\n--- expected\n%s--- found\n%s", name, expected ? expected : "(no file)\n",
                messages);
  free(expected);
  return !same;
}

static int is_program(const struct dirent *entry) {
  size_t length = strlen(entry->d_name);
  return length > 4 && strcmp(entry->d_name + length - 4, ".plm") == 0 &&
         strncmp(entry->d_name, "included_", 9) != 0;
}

static void messages_are_as_expected(void **state) {
  (void)state;
  struct dirent **entries;
  int count = scandir(FOLDER, &entries, is_program, alphasort), wrong = 0;
  assert_true(count >= 25);
  for (int i = 0; i < count; i++) {
    int found;
    char *messages = messages_for(entries[i]->d_name, &found);
    if (found == 0) {
      print_error("%s: no message at all\n", entries[i]->d_name);
      wrong++;
    }
    wrong += compare(entries[i]->d_name, messages);
    free(messages);
    free(entries[i]);
  }
  free(entries);
  assert_int_equal(wrong, 0);
}

int main(void) {
  const struct CMUnitTest tests[] = {cmocka_unit_test(messages_are_as_expected)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
