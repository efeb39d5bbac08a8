/* Frames of a run that is going on: what a checkpoint counts on is found again to the bit or not at
   all; one run at a time; no file is written through a link. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include <errno.h>
#include <fcntl.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <sys/syscall.h>
#include <sys/wait.h>
#include <unistd.h>

#include "runtime/result/frame_file.h"
#include "tests/runtime/result/file_tools.h"

enum { VALUES = 5, RECORD = VALUES * sizeof(double), FRAMES = 4 };
static const char result[] = "frames_of.h5", path[] = "frames_of.h5.frames", other[] = "other.txt";
static char error[512];

/* What the system may do: give less than was asked for, and say that the disk has not taken it. */
static size_t most_at_once = SIZE_MAX;
static bool disk_fails;

ssize_t pread(int file, void *data, size_t bytes, off_t from) {
  return syscall(SYS_pread64, file, data, bytes < most_at_once ? bytes : most_at_once, from);
}

int fsync(int file) {
  if (!disk_fails) return (int)syscall(SYS_fsync, file);
  errno = EIO;
  return -1;
}

static int clean(void **state) {
  (void)state;
  most_at_once = SIZE_MAX;
  disk_fails = false;
  unlink(path);
  unlink(other);
  return 0;
}

static frame_file *open_frames(const char *fingerprint, bool there) {
  return frame_file_open(result, fingerprint, VALUES, there, error, sizeof error);
}

static void add(frame_file *f, int k) {
  double *values = frame_file_record(f);
  for (int v = 0; v < VALUES; v++)
    values[v] = k + 0.1 * v;
  assert_true(frame_file_add(f, error, sizeof error));
}

/* Frames on the disk, the mark after each of them. */
static void write_frames(frame_mark marks[FRAMES + 1]) {
  frame_file *f = open_frames("deck 1", false);
  assert_non_null(f);
  assert_true(frame_file_begin(f, error, sizeof error));
  marks[0] = frame_file_mark(f);
  for (int k = 0; k < FRAMES; k++) {
    add(f, k);
    marks[k + 1] = frame_file_mark(f);
  }
  frame_file_close(f);
}

static bool resumes(const char *fingerprint, const frame_mark *mark) {
  frame_file *f = open_frames(fingerprint, true);
  assert_non_null(f);
  const bool good = frame_file_resume(f, mark, error, sizeof error);
  frame_file_close(f);
  return good;
}

static bool takes_frame(void *seen, int64_t frame, const double *record) {
  assert_int_equal(frame, *(int64_t *)seen);
  for (int v = 0; v < VALUES; v++)
    assert_true(record[v] == (double)frame + 0.1 * v);
  ++*(int64_t *)seen;
  return true;
}

static void frames_are_found_again(void **state) {
  (void)state;
  frame_mark marks[FRAMES + 1];
  for (int kept = 0; kept <= FRAMES; kept++) {
    int64_t seen = 0;
    write_frames(marks);
    frame_file *f = open_frames("deck 1", true);
    assert_true(frame_file_resume(f, &marks[kept], error, sizeof error));
    for (int k = kept; k < FRAMES; k++)
      add(f, k);
    assert_true(frame_file_mark(f).sum == marks[FRAMES].sum); /* of a run that went straight on */
    assert_true(frame_file_each(f, takes_frame, &seen, error, sizeof error));
    assert_int_equal(seen, FRAMES);
    frame_file_remove(f);
    frame_file_close(f);
  }
}

static void frames_are_read_in_pieces(void **state) {
  most_at_once = 7;
  frames_are_found_again(state);
}

static void what_the_disk_has_not_taken_is_said(void **state) {
  (void)state;
  frame_file *f = open_frames("deck 1", false);
  assert_true(frame_file_begin(f, error, sizeof error));
  add(f, 0);
  assert_true(frame_file_sync(f, error, sizeof error));
  disk_fails = true;
  assert_false(frame_file_sync(f, error, sizeof error));
  assert_string_equal(error, "cannot bring to the disk `frames_of.h5.frames`: Input/output error");
  frame_file_close(f);
}

/* Any byte before the end of what the mark tells of; the file then stays as it was. Those behind do
   not matter. */
static void changed_frames_are_refused(void **state) {
  (void)state;
  frame_mark marks[FRAMES + 1];
  size_t size, now;
  write_frames(marks);
  unsigned char *bytes = read_file(path, &size);
  for (size_t k = 0; k < size; k++) {
    bytes[k] ^= 0x10;
    write_file(path, bytes, size);
    assert_int_equal(resumes("deck 1", &marks[FRAMES - 1]), k >= size - RECORD);
    if (k >= size - RECORD) break;
    unsigned char *after = read_file(path, &now);
    assert_int_equal(now, size);
    assert_memory_equal(after, bytes, size);
    free(after);
    bytes[k] ^= 0x10;
  }
  free(bytes);
}

static void frames_of_other_runs_are_refused(void **state) {
  (void)state;
  frame_mark marks[FRAMES + 1];
  write_frames(marks);
  assert_false(resumes("deck 2", &marks[2]));
  assert_non_null(strstr(error, "does not hold the frames of the run"));
  assert_false(resumes("deck 1", &(frame_mark){FRAMES + 1, marks[FRAMES].sum}));
  assert_non_null(strstr(error, "fewer than the 5 frames"));
  assert_true(resumes("deck 1", &marks[2]));
}

/* Also in the middle: the file is that of the frames that the run has added. */
static void damage_while_a_run_goes_on_is_seen(void **state) {
  (void)state;
  frame_file *f = open_frames("deck 1", false);
  assert_true(frame_file_begin(f, error, sizeof error));
  add(f, 0);
  add(f, 1);
  assert_true(frame_file_each(f, NULL, NULL, error, sizeof error));
  const int file = open(path, O_WRONLY);
  assert_int_equal(pwrite(file, "x", 1, 100), 1);
  close(file);
  assert_false(frame_file_each(f, NULL, NULL, error, sizeof error));
  assert_non_null(strstr(error, "are damaged, or were changed"));
  frame_file_close(f);
}

/* Though the frame before it was the same. */
static void a_frame_that_was_cut_off_is_missed(void **state) {
  (void)state;
  for (off_t left = 0; left < RECORD; left += 8) {
    frame_file *f = open_frames("deck 1", false);
    assert_true(frame_file_begin(f, error, sizeof error));
    add(f, 1);
    add(f, 1);
    struct stat about;
    assert_int_equal(stat(path, &about), 0);
    assert_int_equal(truncate(path, about.st_size - RECORD + left), 0);
    assert_false(frame_file_each(f, NULL, NULL, error, sizeof error));
    frame_file_close(f);
  }
}

static void nothing_is_written_through_links(void **state) {
  (void)state;
  size_t size;
  write_file(other, "precious", 8);
  for (int hard = 0; hard < 2; hard++) {
    assert_int_equal(hard ? link(other, path) : symlink(other, path), 0);
    for (int there = 0; there < 2; there++) {
      assert_null(open_frames("deck 1", there));
      assert_non_null(strstr(error, hard ? "another name" : "it is a link"));
    }
    unsigned char *bytes = read_file(other, &size);
    assert_int_equal(size, 8);
    assert_memory_equal(bytes, "precious", 8);
    free(bytes);
    unlink(path);
  }
}

static void pipes_are_not_waited_for(void **state) {
  (void)state;
  alarm(10); /* ends the test, were it waiting */
  assert_int_equal(mkfifo(path, 0600), 0);
  for (int there = 0; there < 2; there++) {
    assert_null(open_frames("deck 1", there));
    assert_non_null(strstr(error, "it is not a file"));
  }
  alarm(0);
}

/* A run that ends removes the file just when another one waits at its door: who has the lock has
   the file with the name. */
static void the_lock_is_that_of_the_name(void **state) {
  (void)state;
  enum { TRIES = 20000 };
  const pid_t child = fork();
  assert_true(child >= 0);
  for (int k = 0; k < TRIES; k++) {
    frame_file *f = open_frames("deck 1", false);
    if (!f) continue;
    if (child == 0)
      frame_file_remove(f);
    else
      assert_int_equal(access(path, F_OK), 0);
    frame_file_close(f);
  }
  if (child == 0) _exit(0);
  assert_int_equal(waitpid(child, NULL, 0), child);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test_teardown(frames_are_found_again, clean),
      cmocka_unit_test_teardown(frames_are_read_in_pieces, clean),
      cmocka_unit_test_teardown(what_the_disk_has_not_taken_is_said, clean),
      cmocka_unit_test_teardown(a_frame_that_was_cut_off_is_missed, clean),
      cmocka_unit_test_teardown(changed_frames_are_refused, clean),
      cmocka_unit_test_teardown(frames_of_other_runs_are_refused, clean),
      cmocka_unit_test_teardown(damage_while_a_run_goes_on_is_seen, clean),
      cmocka_unit_test_teardown(nothing_is_written_through_links, clean),
      cmocka_unit_test_teardown(pipes_are_not_waited_for, clean),
      cmocka_unit_test_teardown(the_lock_is_that_of_the_name, clean),
  };
  return cmocka_run_group_tests_name("frame_file", tests, NULL, NULL);
}
