/* Texts of files: what is read, what stands for a file, where messages point. */
#define _GNU_SOURCE
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "runtime/base/file_text.h"

typedef struct bench {
  char path[64];
  int file;
  source_set sources;
  diagnostics d;
  file_text f;
} bench;

static const char text[] = "first\r\nsecond line\n\nlast";

static int set_up(void **state) {
  bench *b = calloc(1, sizeof *b);
  assert_non_null(b);
  snprintf(b->path, sizeof b->path, "/tmp/perilat_text_XXXXXX");
  b->file = mkstemp(b->path);
  assert_true(b->file >= 0);
  assert_int_equal(write(b->file, text, sizeof text - 1), sizeof text - 1);
  diag_begin(&b->d, &b->sources);
  source_add(&b->sources, "deck", "file = 'x'", 10);
  *state = b;
  return 0;
}

static int tear_down(void **state) {
  bench *b = *state;
  file_text_close(&b->f);
  close(b->file);
  unlink(b->path);
  diag_clear(&b->d);
  source_clear(&b->sources);
  free(b);
  return 0;
}

static bool open_path(bench *b, const char *path) {
  return file_text_open(&b->f, strdup(path), (span){7, 10, 0}, &b->d);
}

static void line_is(bench *b, const char *at, const char *line) {
  const span s = file_text_line(&b->f, strstr(b->f.text, at), &b->d);
  assert_int_equal(s.file, 1);
  assert_int_equal(s.end - s.begin, strlen(line));
  assert_memory_equal(b->f.text + s.begin, line, strlen(line));
}

/* It is no source before a message needs it, and one only once. */
static void a_file_is_read(void **state) {
  bench *b = *state;
  assert_true(open_path(b, b->path));
  assert_int_equal(b->f.length, sizeof text - 1);
  assert_string_equal(b->f.text, text);
  assert_int_equal(b->sources.count, 1);
  line_is(b, "rst", "first");
  line_is(b, "second", "second line");
  line_is(b, "line", "second line");
  line_is(b, "\nlast", "");
  line_is(b, "t\r", "first");
  line_is(b, "ast", "last");
  const span word = file_text_span(&b->f, b->f.text + 7, b->f.text + 13, &b->d);
  assert_memory_equal(b->sources.items[word.file].text + word.begin, "second", 6);
  assert_int_equal(word.end, 13);
  assert_int_equal(file_text_source(&b->f, &b->d), 1);
  assert_int_equal(b->sources.count, 2);
}

static void a_source_stands_for_a_file(void **state) {
  bench *b = *state;
  assert_int_equal(source_add(&b->sources, b->path, "other", 5), 1);
  assert_true(open_path(b, b->path));
  assert_string_equal(b->f.text, "other");
  line_is(b, "h", "other");
  assert_int_equal(b->sources.count, 2);
}

static void is_refused(bench *b, const char *path, const char *why) {
  char said[200];
  snprintf(said, sizeof said, "cannot read `%s`: %s", path, why);
  assert_false(open_path(b, path));
  assert_int_equal(b->d.errors, 1);
  assert_string_equal(b->d.items[0].message, said);
  assert_int_equal(b->d.items[0].where.begin, 7);
}

static void a_missing_file_is_refused(void **state) {
  is_refused(*state, "/tmp/perilat_no_such_file", "No such file or directory");
}

/* Places are 32 bits. The file has a hole: it takes no room. */
static void a_long_file_is_refused(void **state) {
  bench *b = *state;
  assert_int_equal(ftruncate(b->file, (off_t)1 << 31), 0);
  is_refused(b, b->path, "it is longer than 2 GiB");
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test_setup_teardown(a_file_is_read, set_up, tear_down),
      cmocka_unit_test_setup_teardown(a_source_stands_for_a_file, set_up, tear_down),
      cmocka_unit_test_setup_teardown(a_missing_file_is_refused, set_up, tear_down),
      cmocka_unit_test_setup_teardown(a_long_file_is_refused, set_up, tear_down)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
