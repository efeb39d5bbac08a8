/* The histories of four short runs have the same bits on any x86-64 processor, with any C compiler
   and C library: the first 16 digits of the SHA-256 of their names and bytes stand in
   digests/digests.txt, run by run and series by series. When the program is meant to compute
   something else,

       PERILAT_BLESS=1 ctest --test-dir build -R generator.run.digests

   writes them anew. A run that has its digest leaves digest_NAME.h5 in the build folder; one that
   has not is compared with it. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "dsl/base/arena.h"
#include "dsl/base/sha256.h"
#include "runtime/result/result_file.h"
#include "runtime/result/result_find.h"
#include "runtime/result/result_names.h"
#include "runtime/result/result_read.h"

#define FOLDER SOURCE_DIR "/tests/generator/run/digests/"

enum { DIGITS = 16, MOST_SERIES = 32 };

static const char *const runs[] = {"bonds", "family", "irregular", "quasi_static"};
enum { RUNS = sizeof runs / sizeof *runs };

typedef struct series {
  char name[64];
  double *values;
  long count;
  char digest[DIGITS + 1];
} series;

typedef struct history {
  series all[MOST_SERIES];
  int count;
  char digest[DIGITS + 1];
} history;

/* --- digests ---------------------------------------------------------------------------------- */

static void add_series(sha256 *h, const series *s) {
  sha256_add(h, s->name, strlen(s->name) + 1);
  sha256_add(h, s->values, (size_t)s->count * sizeof *s->values);
}

static void write_digest(sha256 *h, char digest[DIGITS + 1]) {
  unsigned char bytes[SHA256_SIZE];
  sha256_end(h, bytes);
  for (int k = 0; k < DIGITS / 2; k++)
    snprintf(digest + 2 * k, 3, "%02x", bytes[k]);
}

static void read_one(result_file *f, const char *name, series *s) {
  char unit[64], error[400];
  sha256 h;
  snprintf(s->name, sizeof s->name, "%s", name);
  s->values = result_read_series(f, name, &s->count, unit, sizeof unit, error, sizeof error);
  if (!s->values) fail_msg("%s: %s", name, error);
  sha256_begin(&h);
  add_series(&h, s);
  write_digest(&h, s->digest);
}

/* False when there is no such file. */
static bool read_history(const char *path, history *out) {
  char error[400];
  sha256 h;
  result_file *f = result_read(path, error, sizeof error);
  *out = (history){.count = 0};
  if (!f) return false;
  result_names names = result_members(f, "/history");
  assert_in_range(names.count, 4, MOST_SERIES - 1);
  read_one(f, "time", &out->all[out->count++]);
  for (int k = 0; k < names.count; k++)
    read_one(f, names.items[k], &out->all[out->count++]);
  sha256_begin(&h);
  for (int k = 0; k < out->count; k++)
    add_series(&h, &out->all[k]);
  write_digest(&h, out->digest);
  result_names_free(&names);
  result_read_close(f);
  return true;
}

static void free_history(history *h) {
  for (int k = 0; k < h->count; k++)
    free(h->all[k].values);
}

/* --- the values ------------------------------------------------------------------------------- */

/* Digest of "bonds" or "bonds/time" as the file has it; "" without one. */
static void expected_digest(const char *run, const char *name, char digest[DIGITS + 1]) {
  char line[200], wanted[100];
  const int length = snprintf(wanted, sizeof wanted, "%s%s%s ", run, *name ? "/" : "", name);
  *digest = 0;
  FILE *in = fopen(FOLDER "digests.txt", "r");
  while (in && fgets(line, sizeof line, in))
    if (strncmp(line, wanted, (size_t)length) == 0)
      snprintf(digest, DIGITS + 1, "%s", line + length);
  if (in) fclose(in);
}

static void put_digests(FILE *out, const char *run, const history *h) {
  fprintf(out, "%s %s\n", run, h->digest);
  for (int k = 0; k < h->count; k++)
    fprintf(out, "%s/%s %s\n", run, h->all[k].name, h->all[k].digest);
}

/* --- runs ------------------------------------------------------------------------------------- */

static void run_deck(const char *settings, const char *run, const char *options, const char *path) {
  char command[2000];
  snprintf(command, sizeof command,
           "env %s '" PERILAT_PROGRAM "' run '" FOLDER "%s.nml' %s --set output.result=%s > "
           "digest_log.txt 2>&1",
           settings, run, options, path);
  if (system(command) == 0) return;
  if (system("cat digest_log.txt >&2") != 0) fprintf(stderr, "the run says nothing\n");
  fail_msg("%s fails", command);
}

static void show_difference(const series *mine, const series *reference) {
  const long count = mine->count < reference->count ? mine->count : reference->count;
  long at = 0;
  while (at < count && memcmp(&mine->values[at], &reference->values[at], sizeof(double)) == 0)
    at++;
  if (at < count)
    fprintf(stderr, "    sample %ld is %.17g (%a), was %.17g (%a)\n", at, mine->values[at],
            mine->values[at], reference->values[at], reference->values[at]);
  else if (mine->count != reference->count)
    fprintf(stderr, "    has %ld samples, had %ld\n", mine->count, reference->count);
}

/* Which series differ from the values in the file, and where from the last good run. */
static void show_differences(const char *run, const history *h, const char *good) {
  history reference;
  char digest[DIGITS + 1];
  const bool at_hand = read_history(good, &reference);
  for (int k = 0; k < h->count; k++) {
    const series *s = &h->all[k];
    expected_digest(run, s->name, digest);
    if (strcmp(digest, s->digest) == 0) continue;
    fprintf(stderr, "  %s/%s %s, expected %s\n", run, s->name, s->digest, digest);
    for (int m = 0; at_hand && m < reference.count; m++)
      if (strcmp(reference.all[m].name, s->name) == 0) show_difference(s, &reference.all[m]);
  }
  free_history(&reference);
}

/* All runs, with these settings of the environment and options of the command. */
static void check_runs(const char *settings, const char *options) {
  int wrong = 0;
  for (int k = 0; k < RUNS; k++) {
    history h;
    char digest[DIGITS + 1], good[64], fresh[64];
    snprintf(good, sizeof good, "digest_%s.h5", runs[k]);
    snprintf(fresh, sizeof fresh, "digest_%s.new.h5", runs[k]);
    run_deck(settings, runs[k], options, fresh);
    assert_true(read_history(fresh, &h));
    expected_digest(runs[k], "", digest);
    print_message("%-14s %s\n", runs[k], h.digest);
    if (strcmp(digest, h.digest) != 0) {
      fprintf(stderr, "%s %s, expected %s (%s %s)\n", runs[k], h.digest, digest, settings, options);
      show_differences(runs[k], &h, good);
      wrong++;
    } else {
      assert_int_equal(rename(fresh, good), 0);
    }
    free_history(&h);
  }
  assert_int_equal(wrong, 0);
}

static void bless(void) {
  FILE *out = fopen(FOLDER "digests.txt", "w");
  assert_non_null(out);
  for (int k = 0; k < RUNS; k++) {
    history h;
    run_deck("", runs[k], "", "digest_blessed.h5");
    assert_true(read_history("digest_blessed.h5", &h));
    put_digests(out, runs[k], &h);
    free_history(&h);
  }
  assert_int_equal(fclose(out), 0);
}

/* --- tests ------------------------------------------------------------------------------------ */

static void as_this_program_is_built(void **state) {
  (void)state;
  if (getenv("PERILAT_BLESS")) bless();
  check_runs("", "");
}

static void on_the_interpreter(void **state) {
  (void)state;
  check_runs("", "--interpret");
}

/* The C library then takes other ways through its functions. */
static void with_another_way_through_the_library(void **state) {
  (void)state;
  check_runs("GLIBC_TUNABLES=glibc.cpu.hwcaps=-AVX2,-FMA,-FMA4,-AVX", "");
}

static void with_kernels_for_other_processors(void **state) {
  (void)state;
  check_runs("PERILAT_PROCESSOR=x86-64", "");
  if (system("grep -qw avx2 /proc/cpuinfo") == 0) check_runs("PERILAT_PROCESSOR=x86-64-v3", "");
  if (system("grep -qw avx512vl /proc/cpuinfo") == 0) check_runs("PERILAT_PROCESSOR=x86-64-v4", "");
}

static void with_kernels_of_other_compilers(void **state) {
  (void)state;
  if (system("gcc --version > /dev/null 2>&1") == 0) check_runs("PERILAT_CC=gcc", "");
  if (system("clang --version > /dev/null 2>&1") == 0) check_runs("PERILAT_CC=clang", "");
}

int main(void) {
#if !defined(__x86_64__)
  return 0;
#endif
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(as_this_program_is_built),
      cmocka_unit_test(on_the_interpreter),
      cmocka_unit_test(with_another_way_through_the_library),
      cmocka_unit_test(with_kernels_for_other_processors),
      cmocka_unit_test(with_kernels_of_other_compilers),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
