/* A confined process: what it may read and write, through links, `..` and absolute names. Each case
   is a process of its own, since there is no way back. */
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
#include <sys/wait.h>
#include <unistd.h>

#include "runtime/base/confined.h"
#include "runtime/base/ordinary_file.h"
#include "runtime/base/whole_file.h"

static void write_text(const char *path) {
  FILE *out = fopen(path, "w");
  assert_non_null(out);
  fputs("text\n", out);
  assert_int_equal(fclose(out), 0);
}

/* confined/mine/law, a link out of it; confined/secret, confined/models/shared. */
static int set_up(void **state) {
  (void)state;
  (void)system("rm -rf confined");
  mkdir("confined", 0777);
  mkdir("confined/mine", 0777);
  mkdir("confined/mine/deeper", 0777);
  mkdir("confined/mine_too", 0777);
  mkdir("confined/models", 0777);
  write_text("confined/mine/law");
  write_text("confined/mine_too/law");
  write_text("confined/secret");
  write_text("confined/models/shared");
  return symlink("../secret", "confined/mine/way_out") || symlink("law", "confined/mine/way") ||
         symlink("..", "confined/mine/above");
}

static bool can_read(const char *path) {
  const char *why;
  const int file = ordinary_file_open(path, O_RDONLY, &why);
  if (file >= 0) close(file);
  return file >= 0;
}

static bool can_write(const char *path) {
  whole_file f;
  FILE *out = whole_file_open(&f, path);
  if (out) fclose(out);
  return out && whole_file_end(&f, true);
}

/* Exit status of a child that asks `question` when it is confined. */
static int asked(bool (*question)(void)) {
  fflush(NULL);
  const pid_t child = fork();
  if (child == 0) {
    const char *const models[] = {"confined/models", "confined/none"};
    if (!files_confine("confined/mine", models, 2)) _exit(9);
    _exit(question() ? 0 : 1);
  }
  int status;
  assert_int_equal(waitpid(child, &status, 0), child);
  assert_true(WIFEXITED(status));
  return WEXITSTATUS(status);
}

static bool reads_its_own(void) {
  return can_read("confined/mine/law") && can_read("confined/mine/way") &&
         can_read("confined/mine/deeper/../law") && can_read("confined/models/shared") &&
         !can_read("confined/mine/none");
}

static bool reads_nothing_else(void) {
  return !can_read("confined/secret") && !can_read("confined/mine/../secret") &&
         !can_read("confined/mine/way_out") && !can_read("confined/mine/above/secret") &&
         !can_read("confined/mine_too/law") && !can_read("/etc/passwd");
}

static bool writes_in_its_own_alone(void) {
  return can_write("confined/mine/out") && can_write("confined/mine/deeper/out") &&
         can_write("confined/mine/out") && !can_write("confined/models/shared") &&
         !can_write("confined/models/out") && !can_write("confined/out") &&
         !can_write("confined/mine/../out") && !can_write("confined/mine/above/out") &&
         !can_write("confined/mine/way_out") && !can_write("/tmp/perilat_out");
}

static bool reads_all_but_one(void) {
  file_never_read("confined/mine/deeper/../law");
  const bool one = !can_read("confined/mine/law") && !can_read("confined/mine/way") &&
                   can_read("confined/models/shared");
  file_never_read("confined/mine/none");
  return one && can_read("confined/mine/law");
}

static void a_confined_process_keeps_to_its_folder(void **state) {
  (void)state;
  assert_int_equal(asked(reads_its_own), 0);
  assert_int_equal(asked(reads_nothing_else), 0);
  assert_int_equal(asked(writes_in_its_own_alone), 0);
  assert_int_equal(asked(reads_all_but_one), 0);
  assert_false(files_are_confined());
  assert_true(can_read("confined/secret") && can_write("confined/out"));
}

static bool reads_anything(void) {
  return files_confine("confined/none", NULL, 0) || can_read("confined/mine/law") ||
         can_write("confined/mine/out");
}

static void without_its_folder_it_reads_nothing(void **state) {
  (void)state;
  assert_int_equal(asked(reads_anything), 1);
}

int main(void) {
  const struct CMUnitTest tests[] = {cmocka_unit_test(a_confined_process_keeps_to_its_folder),
                                     cmocka_unit_test(without_its_folder_it_reads_nothing)};
  return cmocka_run_group_tests(tests, set_up, NULL);
}
