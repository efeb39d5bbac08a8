/* Files that appear whole or not at all. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include <errno.h>
#include <stdio.h>
#include <string.h>
#include <sys/stat.h>
#include <sys/syscall.h>
#include <unistd.h>

#include "runtime/base/whole_file.h"

static const char name[] = "whole.txt", link_name[] = "whole.link";

/* What a disk may refuse: files, or folders. */
static mode_t refused;

int fsync(int file) {
  struct stat about;
  if (fstat(file, &about) != 0 || (about.st_mode & S_IFMT) != refused)
    return (int)syscall(SYS_fsync, file);
  errno = EIO;
  return -1;
}

static void put(const char *path, const char *text) {
  FILE *out = fopen(path, "w");
  assert_non_null(out);
  fputs(text, out);
  assert_int_equal(fclose(out), 0);
}

static void expect_text(const char *path, const char *text) {
  char found[64] = "";
  FILE *in = fopen(path, "r");
  assert_non_null(in);
  found[fread(found, 1, sizeof found - 1, in)] = 0;
  fclose(in);
  assert_string_equal(found, text);
}

static int clean(void **state) {
  (void)state;
  refused = 0;
  unlink(name);
  unlink(link_name);
  return 0;
}

static void the_old_text_stays_until_the_end(void **state) {
  (void)state;
  whole_file f;
  put(name, "old");
  assert_true(whole_file_begin(&f, name));
  put(f.working, "new");
  expect_text(name, "old");
  errno = ENOSPC;
  assert_false(whole_file_end(&f, false));
  assert_int_equal(errno, ENOSPC);
  expect_text(name, "old");
  assert_int_not_equal(access(f.working, F_OK), 0);
  assert_true(whole_file_begin(&f, name));
  put(f.working, "new");
  assert_true(whole_file_end(&f, true));
  expect_text(name, "new");
  assert_int_not_equal(access(f.working, F_OK), 0);
}

/* Programs that write one file at the same time do not meet before the end; what stood under other
   names stays. */
static void working_files_have_names_of_their_own(void **state) {
  (void)state;
  whole_file f, g;
  put("other.txt", "precious");
  assert_int_equal(symlink("other.txt", "whole.txt.part"), 0);
  assert_true(whole_file_begin(&f, name) && whole_file_begin(&g, name));
  assert_string_not_equal(f.working, g.working);
  put(f.working, "first");
  put(g.working, "second");
  assert_true(whole_file_end(&g, true));
  expect_text(name, "second");
  assert_true(whole_file_end_on_disk(&f, true));
  expect_text(name, "first");
  expect_text("other.txt", "precious");
  unlink("whole.txt.part");
  unlink("other.txt");
}

static void what_killed_programs_left_is_cleared(void **state) {
  (void)state;
  static const char *const others[] = {"whole.txt.1.part", "whole.txt.1.2.parts",
                                       "whole.txt.a.2.part", "whole.text.1.2.part"};
  whole_file f;
  assert_true(whole_file_begin(&f, name));
  for (size_t k = 0; k < sizeof others / sizeof *others; k++)
    put(others[k], "mine");
  whole_file_clear(name);
  assert_int_not_equal(access(f.working, F_OK), 0);
  for (size_t k = 0; k < sizeof others / sizeof *others; k++) {
    expect_text(others[k], "mine");
    unlink(others[k]);
  }
}

/* A file that the disk has not taken does not replace the old one. Some file systems do not sync
   folders: that is no failure. */
static void what_the_disk_has_not_taken_replaces_nothing(void **state) {
  (void)state;
  whole_file f;
  put(name, "old");
  for (int folder = 0; folder < 2; folder++) {
    refused = folder ? S_IFDIR : S_IFREG;
    assert_true(whole_file_begin(&f, name));
    put(f.working, "new");
    assert_int_equal(whole_file_end_on_disk(&f, true), folder);
    if (!folder) assert_int_equal(errno, EIO);
    expect_text(name, folder ? "new" : "old");
    assert_int_not_equal(access(f.working, F_OK), 0);
  }
}

static void a_link_stays_a_link(void **state) {
  (void)state;
  whole_file f;
  struct stat about;
  put(name, "old");
  assert_int_equal(symlink(name, link_name), 0);
  assert_true(whole_file_begin(&f, link_name));
  put(f.working, "new");
  assert_true(whole_file_end(&f, true));
  assert_int_equal(lstat(link_name, &about), 0);
  assert_true(S_ISLNK(about.st_mode));
  expect_text(name, "new");
}

static void a_device_is_written_to_and_stays(void **state) {
  (void)state;
  whole_file f;
  struct stat about;
  assert_true(whole_file_begin(&f, "/dev/null"));
  assert_string_equal(f.working, "/dev/null");
  assert_true(whole_file_end(&f, true));
  assert_false(whole_file_end(&f, false));
  assert_int_equal(stat("/dev/null", &about), 0);
  assert_true(S_ISCHR(about.st_mode));
}

static void what_cannot_be_written_is_refused(void **state) {
  (void)state;
  whole_file f;
  char path[2 * WHOLE_FILE_PATH];
  memset(path, 'a', sizeof path);
  path[sizeof path - 1] = 0;
  assert_false(whole_file_begin(&f, path));
  assert_int_equal(errno, ENAMETOOLONG);
  put(name, "old");
  chmod(name, 0444);
  if (geteuid() != 0) assert_false(whole_file_begin(&f, name)); /* root may write everywhere */
  expect_text(name, "old");
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test_teardown(the_old_text_stays_until_the_end, clean),
      cmocka_unit_test_teardown(working_files_have_names_of_their_own, clean),
      cmocka_unit_test_teardown(what_killed_programs_left_is_cleared, clean),
      cmocka_unit_test_teardown(what_the_disk_has_not_taken_replaces_nothing, clean),
      cmocka_unit_test_teardown(a_link_stays_a_link, clean),
      cmocka_unit_test_teardown(a_device_is_written_to_and_stays, clean),
      cmocka_unit_test_teardown(what_cannot_be_written_is_refused, clean),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
