/* What is opened is an ordinary file: folders, pipes, links and other names are refused, and nothing is waited for. */
#define _GNU_SOURCE
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include <fcntl.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "runtime/base/ordinary_file.h"

static char folder[] = "/tmp/perilat_XXXXXX";

static int make_folder(void **state) {
  (void)state;
  if (!mkdtemp(folder) || chdir(folder) != 0) return 1;
  FILE *out = fopen("file", "w");
  return !out || fputs("held\n", out) < 0 || fclose(out) != 0;
}

static int remove_folder(void **state) {
  (void)state;
  static const char *const made[] = {"file", "pipe", "link", "name", "new", "loop"};
  for (size_t k = 0; k < sizeof made / sizeof *made; k++)
    unlink(made[k]);
  return chdir("/") != 0 || rmdir(folder) != 0;
}

static void assert_refused(const char *path, int flags, const char *expected) {
  const char *why = NULL;
  assert_int_equal(ordinary_file_open(path, flags, &why), -1);
  assert_string_equal(why, expected);
}

static void a_file_is_read_and_closed_in_other_programs(void **state) {
  (void)state;
  const char *why = "not asked";
  char text[8] = "";
  const int file = ordinary_file_open("file", O_RDONLY | O_NOFOLLOW, &why);
  assert_true(file >= 0);
  assert_null(why);
  assert_int_equal(read(file, text, sizeof text), 5);
  assert_string_equal(text, "held\n");
  assert_true(fcntl(file, F_GETFD) & FD_CLOEXEC);
  close(file);
}

static void a_new_file_is_made(void **state) {
  (void)state;
  const char *why;
  const int file = ordinary_file_open("new", O_WRONLY | O_CREAT | O_EXCL, &why);
  assert_true(file >= 0);
  assert_int_equal(write(file, "x", 1), 1);
  close(file);
  assert_refused("new", O_WRONLY | O_CREAT | O_EXCL, "File exists");
}

static void what_is_no_file_is_refused(void **state) {
  (void)state;
  assert_refused("none", O_RDONLY, "No such file or directory");
  assert_refused(".", O_RDONLY, "it is a folder");
  assert_int_equal(mkfifo("pipe", 0600), 0);
  assert_refused("pipe", O_RDONLY, "it is not a file"); /* nobody writes into it: open would wait */
  assert_refused("/dev/null", O_RDWR, "it is not a file");
}

/* A reader may follow links; who writes into a file in its place must not change another one. */
static void links_are_refused_where_a_file_is_written(void **state) {
  (void)state;
  const char *why;
  assert_int_equal(symlink("file", "link"), 0);
  assert_refused("link", O_RDWR | O_NOFOLLOW, "it is a link");
  const int followed = ordinary_file_open("link", O_RDONLY, &why);
  assert_true(followed >= 0);
  close(followed);
  assert_int_equal(symlink("loop", "loop"), 0);
  assert_refused("loop", O_RDONLY, "Too many levels of symbolic links");
  assert_int_equal(link("file", "name"), 0);
  assert_refused("file", O_RDWR | O_NOFOLLOW, "the file has another name, too");
  const int read_only = ordinary_file_open("name", O_RDONLY, &why);
  assert_true(read_only >= 0);
  close(read_only);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(a_file_is_read_and_closed_in_other_programs),
      cmocka_unit_test(a_new_file_is_made),
      cmocka_unit_test(what_is_no_file_is_refused),
      cmocka_unit_test(links_are_refused_where_a_file_is_written),
  };
  return cmocka_run_group_tests(tests, make_folder, remove_folder);
}
