/* What may happen to a run and to what it has written: another run in its place, a full disk, links
   and pipes in the way, damage between stop and --resume. Nothing is lost that could be kept, and
   nothing wrong is taken for right. */
#define _GNU_SOURCE
#include <setjmp.h>
#include <stdarg.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include <fcntl.h>

#include "tests/generator/command_tools.h"

#define COUNT(table) (sizeof(table) / sizeof *(table))

static const char go_on[] = "run long.nml --set output.result=part.h5 --set 'simulation.title=a "
                            "long run' --resume";

static bool says(const workplace *w, const char *file, const char *wanted) {
  size_t size;
  char *text = read_bytes(w, file, &size);
  const bool found = strstr(text, wanted) != NULL;
  free(text);
  return found;
}

/* Stopped as it should be. */
static void stop_long_run(const workplace *w) {
  const pid_t run = start_long_run(w, "part.h5", NULL);
  kill(run, SIGTERM);
  assert_int_equal(end_of(run), 128 + SIGTERM);
}

static void wait_for(const workplace *w, const char *name) {
  while (!exists(w, name))
    wait_a_little();
}

/* The run in `part.h5` goes on and ends as one that was not stopped. */
static void expect_the_rest(workplace *w) {
  expect(w, "run long.nml --set output.result=whole.h5 --set 'simulation.title=a long run'", 0,
         "written");
  expect(w, go_on, 0, "resumed at");
  expect_same_results(w, "whole.h5", "part.h5");
}

/* --- another run in its place ----------------------------------------------------------------- */

/* A is stopped; B begins anew under the same name and is killed before its first checkpoint. */
static void a_checkpoint_goes_with_its_frames(void **state) {
  workplace *w = *state;
  size_t size;
  write_long_deck(w);
  assert_int_equal(shell(w, "sed -i 's/interval = 0.02/interval = 600/' long.nml"), 0);
  stop_long_run(w);
  char *checkpoint = read_bytes(w, "part.h5.checkpoint", &size);
  const pid_t run = start_long_run(w, "part.h5", "material.zeta=0");
  kill(run, SIGKILL);
  assert_int_equal(end_of(run), 128 + SIGKILL);
  assert_true(says(w, "said_long", "`part.h5.checkpoint` of an earlier one is given up"));
  expect(w, go_on, 1, "there is no checkpoint `part.h5.checkpoint`");
  write_bytes(w, "part.h5.checkpoint", checkpoint, size); /* put back by hand */
  expect(w, go_on, 1, "`part.h5.frames` does not hold the frames of the run to be resumed");
  free(checkpoint);
}

static void only_what_is_given_up_is_said_to_be(void **state) {
  workplace *w = *state;
  write_long_deck(w);
  pid_t run = start_long_run(w, "part.h5", NULL);
  assert_false(says(w, "said_long", "given up"));
  wait_for(w, "part.h5.checkpoint");
  kill(run, SIGSTOP);
  expect(w, "run long.nml --set output.result=part.h5", 2, "another run is writing `part.h5`");
  assert_null(strstr(w->said, "given up"));
  assert_true(exists(w, "part.h5.checkpoint"));
  kill(run, SIGKILL);
  assert_int_equal(end_of(run), 128 + SIGKILL);
  for (int k = 0; k < 2; k++)
    expect(w, k ? "plot part.h5 --x time --y load" : "info part.h5", 1,
           "there is no result `part.h5` yet, but the checkpoint of its run");
  assert_non_null(strstr(w->said, "perilat run DECK --resume"));
  expect_the_rest(w);
}

static void frames_alone_are_no_result(void **state) {
  workplace *w = *state;
  write_text(w, "gone.h5.frames", "");
  expect(w, "info gone.h5", 1, "there is no result `gone.h5`, but frames of its run");
  expect(w, "info never.h5", 1, "cannot read the result `never.h5`: No such file");
}

/* --- what cannot be written ------------------------------------------------------------------- */

/* Neither a frame nor a checkpoint fits: what the last one needs stays. */
static void a_full_disk_leaves_the_last_checkpoint(void **state) {
  workplace *w = *state;
  write_long_deck(w);
  stop_long_run(w);
  assert_int_equal(shell(w, "ulimit -f 8; exec $P %s", go_on), 2);
  assert_non_null(strstr(w->said, "cannot write a frame"));
  assert_non_null(strstr(w->said, "no checkpoint was written"));
  assert_non_null(strstr(w->said, "make room, then go on with --resume:\n  perilat run long.nml"));
  expect_the_rest(w);
  assert_false(exists(w, "part.h5.checkpoint") || exists(w, "part.h5.frames"));
}

/* Nothing can be put under the names that the run would take for its checkpoint's working file. */
static void block_checkpoints(const workplace *w, pid_t run) {
  for (int k = 0; k < 1000; k++) {
    char name[100];
    snprintf(name, sizeof name, "part.h5.checkpoint.%ld.%d.part", (long)run, k);
    const int file = open(in_workplace(w, name), O_WRONLY | O_CREAT, 0600);
    assert_true(file >= 0);
    close(file);
  }
}

static void a_stop_without_its_checkpoint_says_so(void **state) {
  workplace *w = *state;
  write_long_deck(w);
  for (int older = 0; older < 2; older++) {
    pid_t run = start_long_run(w, "part.h5", older ? NULL : "checkpoint.interval=600");
    if (older) wait_for(w, "part.h5.checkpoint");
    kill(run, SIGSTOP);
    block_checkpoints(w, run);
    kill(run, SIGTERM);
    kill(run, SIGCONT);
    assert_int_equal(end_of(run), 2);
    assert_true(says(w, "said_long", "no checkpoint was written"));
    assert_true(says(w, "said_long",
                     older ? "its last checkpoint is that at t = "
                           : "it has no checkpoint and cannot go on"));
    assert_int_equal(says(w, "said_long", "--resume"), older);
    assert_int_equal(exists(w, "part.h5.frames"), older);
    assert_int_equal(exists(w, "part.h5.checkpoint"), older);
    expect(w, "info part.h5", 0, "Frames hold");
  }
  expect_the_rest(w);
  assert_int_equal(shell(w, "ls | grep -c 'part$'"), 1); /* what killed runs have left is gone */
}

/* --- links and pipes in the way --------------------------------------------------------------- */

static void expect_precious(const workplace *w) {
  size_t size;
  char *kept = read_bytes(w, "precious", &size);
  assert_string_equal(kept, "precious");
  free(kept);
}

static void links_are_not_written_through(void **state) {
  workplace *w = *state;
  static const struct {
    const char *name, *command;
    int status;
  } traps[] = {
      {"beam.h5.frames", "run beam.nml", 2},      {"beam.h5.part", "run beam.nml", 0},
      {"beam.xdmf", "run beam.nml", 1},           {"beam.xdmf.part", "run beam.nml", 0},
      {"beam.h5.checkpoint", "run beam.nml", 0},  {"beam.h5.checkpoint.tmp", "run beam.nml", 0},
      {"c.png.part", "plot beam.h5 -o c.png", 0}, {"c.csv.part", "export beam.h5 -o c.csv", 0}};
  write_text(w, "precious", "precious");
  for (size_t k = 0; k < COUNT(traps); k++) {
    unlink(in_workplace(w, traps[k].name));
    assert_int_equal(symlink("precious", in_workplace(w, traps[k].name)), 0);
    assert_int_equal(shell(w, "$P %s", traps[k].command), traps[k].status);
    if (traps[k].status) assert_non_null(strstr(w->said, "a link"));
    expect_precious(w);
    unlink(in_workplace(w, traps[k].name));
  }
}

static void pipes_hang_nobody(void **state) {
  workplace *w = *state;
  expect(w, "run beam.nml", 0, "written");
  static const struct {
    const char *name, *command;
    int status;
  } traps[] = {{"p.h5", "info p.h5", 1},
               {"p.h5", "export p.h5", 1},
               {"p.h5", "plot p.h5", 1},
               {"p.h5", "compare beam.h5 p.h5", 1},
               {"p.h5", "run beam.nml --set lattice.kind=particles --set lattice.file=p.h5", 1},
               {"beam.h5.frames", "run beam.nml", 2},
               {"beam.xdmf", "run beam.nml", 1},
               {"beam.h5.checkpoint", "run beam.nml --resume", 1}};
  for (size_t k = 0; k < COUNT(traps); k++) {
    if (strcmp(traps[k].name, "beam.h5.checkpoint") == 0) write_text(w, "beam.h5.frames", "");
    unlink(in_workplace(w, traps[k].name));
    assert_int_equal(mkfifo(in_workplace(w, traps[k].name), 0600), 0);
    const int status = shell(w, "timeout 20 $P %s", traps[k].command);
    if (status != traps[k].status) fail_msg("%s: %d\n%s", traps[k].command, status, w->said);
    unlink(in_workplace(w, traps[k].name));
  }
}

/* --- one name, many programs ------------------------------------------------------------------ */

static void pictures_to_one_name_are_whole(void **state) {
  enum { ROUNDS = 10 };
  workplace *w = *state;
  expect(w, "run beam.nml", 0, "written");
  expect(w, "plot beam.h5 -o right.png", 0, "written");
  for (int k = 0; k < ROUNDS; k++)
    assert_int_equal(shell(w, "for n in 1 2 3 4 5 6; do $P plot beam.h5 -o c.png & done; wait; "
                              "test $(grep -c 'written c.png' said) = 6 && cmp c.png right.png"),
                     0);
  assert_int_equal(shell(w, "ls | grep -c part"), 1); /* none */
}

/* --- damage ----------------------------------------------------------------------------------- */

static uint32_t random_number(uint32_t *seed) {
  *seed = *seed * 1664525 + 1013904223;
  return *seed >> 8;
}

/* A flipped bit, or some bytes that are something else, in part `part` of so many equal ones. */
static void damage(char *bytes, size_t size, int part, int parts, uint32_t *seed) {
  const size_t length = size / (size_t)parts, width = 1 + random_number(seed) % 64;
  const size_t at = (size_t)part * length + random_number(seed) % length;
  if (random_number(seed) % 2)
    bytes[at] ^= (char)(1u << random_number(seed) % 8);
  else
    for (size_t k = at; k < at + width && k < size; k++)
      bytes[k] = (char)~bytes[k];
}

/* What a command says on its standard output and draws into o.png (malloc'ed, of `size` bytes); its
   status. */
static char *answer(workplace *w, const char *command, int *status, size_t *size) {
  *status = shell(w, "rm -f o.png; $P %s > all 2> errors", command);
  shell(w, "test ! -f o.png || cat o.png >> all");
  return read_bytes(w, "all", size);
}

static void damaged_results_answer_right_or_not_at_all(void **state) {
  enum { TRIES = 16 };
  workplace *w = *state;
  static const char *const commands[] = {"info x.h5",
                                         "export x.h5",
                                         "export x.h5 --frame -1",
                                         "export x.h5 --frame 1 --bonds",
                                         "compare right.h5 x.h5",
                                         "plot x.h5 --map damage -o o.png"};
  expect(w, "run beam.nml --set output.frames=200 --set output.result=right.h5", 0, "written");
  size_t size, lengths[COUNT(commands)], length;
  uint32_t seed = 5;
  char *right = read_bytes(w, "right.h5", &size), *expected[COUNT(commands)];
  int status, answered = 0;
  write_bytes(w, "x.h5", right, size);
  for (size_t c = 0; c < COUNT(commands); c++) {
    expected[c] = answer(w, commands[c], &status, &lengths[c]);
    assert_int_equal(status, 0);
  }
  for (int k = 0; k < TRIES; k++) {
    char *bytes = read_bytes(w, "right.h5", &size);
    damage(bytes, size, k, TRIES, &seed);
    write_bytes(w, "x.h5", bytes, size);
    free(bytes);
    for (size_t c = 0; c < COUNT(commands); c++) {
      char *got = answer(w, commands[c], &status, &length);
      if (status != 0 && status != 1) fail_msg("%s: status %d", commands[c], status);
      if (status == 0 && (length != lengths[c] || memcmp(got, expected[c], length) != 0))
        fail_msg("%s: another answer", commands[c]);
      answered += status == 0;
      free(got);
    }
  }
  assert_in_range(answered, 1,
                  TRIES * COUNT(commands) - 1); /* some damage is not where it is read */
  for (size_t c = 0; c < COUNT(commands); c++)
    free(expected[c]);
  free(right);
}

static void damaged_frames_are_not_gone_on_from(void **state) {
  enum { TRIES = 14 };
  workplace *w = *state;
  size_t size, checkpoint_size, now;
  uint32_t seed = 3;
  write_long_deck(w);
  stop_long_run(w);
  char *frames = read_bytes(w, "part.h5.frames", &size),
       *checkpoint = read_bytes(w, "part.h5.checkpoint", &checkpoint_size);
  for (int k = 0; k < TRIES; k++) {
    char *bytes = read_bytes(w, "part.h5.frames", &now);
    damage(bytes, size, k, TRIES, &seed);
    write_bytes(w, "part.h5.frames", bytes, size);
    free(bytes);
    expect(w, go_on, 1, "cannot resume: ");
    write_bytes(w, "part.h5.frames", frames, size);
  }
  char *kept = read_bytes(w, "part.h5.checkpoint", &now);
  assert_int_equal(now, checkpoint_size);
  assert_memory_equal(kept, checkpoint, now);
  free(kept);
  free(frames);
  free(checkpoint);
  expect_the_rest(w);
}

#define ONE(test) cmocka_unit_test_setup_teardown(test, set_up_workplace, tear_down_workplace)

int main(void) {
  const struct CMUnitTest tests[] = {
      ONE(frames_alone_are_no_result),
      ONE(a_checkpoint_goes_with_its_frames),
      ONE(only_what_is_given_up_is_said_to_be),
      ONE(a_full_disk_leaves_the_last_checkpoint),
      ONE(a_stop_without_its_checkpoint_says_so),
      ONE(links_are_not_written_through),
      ONE(pipes_hang_nobody),
      ONE(pictures_to_one_name_are_whole),
      ONE(damaged_results_answer_right_or_not_at_all),
      ONE(damaged_frames_are_not_gone_on_from),
  };
  return cmocka_run_group_tests_name("lost runs", tests, NULL, NULL);
}
