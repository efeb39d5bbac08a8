/* Results that are damaged, changed, or made to lead elsewhere: they give the right answers or
   none. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include <fcntl.h>
#include <hdf5.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "dsl/base/hash.h"
#include "runtime/result/hdf5_tools.h"
#include "runtime/result/result_fields.h"
#include "runtime/result/result_file.h"
#include "runtime/result/result_find.h"
#include "runtime/result/result_names.h"
#include "runtime/result/result_read.h"
#include "runtime/result/sealed_file.h"
#include "tests/runtime/result/file_tools.h"
#include "tests/runtime/small_result.h"

static char error[2048];
static const char name[] = "sealed.h5";

static int clean(void **state) {
  (void)state;
  unlink(name);
  unlink("sealed.xdmf");
  unlink("elsewhere.h5");
  unlink("elsewhere.bin");
  return 0;
}

static uint32_t random_number(uint32_t *seed) {
  *seed = *seed * 1664525 + 1013904223;
  return *seed >> 8;
}

/* --- a result with all kinds of sets ---------------------------------------------------------- */

enum { MANY = 3000, LONG = 400, STEPS = 6 }; /* particles, samples, frames */

/* Most bytes lie in large chunks, which the seal leaves to their sums. */
static void write_large(void) {
  static double places[2 * MANY], volumes[MANY], u[2 * MANY], omega[MANY], time[LONG];
  static int32_t bodies[MANY], pairs[2 * MANY];
  static const result_field fields[] = {{"displacement", "m", NULL, 2, MANY, "other", NULL},
                                        {"omega", "1", "concrete", 1, MANY, "damage", NULL}};
  uint32_t seed = 7;
  for (int p = 0; p < MANY; p++) {
    places[2 * p] = p % 50 + 1e-3 * random_number(&seed);
    volumes[p] = 1 + 1e-3 * p;
    pairs[2 * p] = p;
    pairs[2 * p + 1] = (p + 1) % MANY;
  }
  for (int k = 0; k < LONG; k++)
    time[k] = 1e-3 * k;
  result_header h = small_header(name);
  h.overrides = "material.E=1e9\n";
  h.particle_count = MANY;
  h.reference = places;
  h.volume = volumes;
  h.body = bodies;
  const result_bonds bonds = {"concrete", MANY, pairs};
  h.bonds = &bonds;
  h.fields = fields;
  result *r = small_begin(&h, error, sizeof error);
  assert_non_null(r);
  for (int k = 0; k < STEPS; k++) {
    const double *values[] = {u, omega};
    for (int p = 0; p < MANY; p++) {
      u[2 * p] = 1e-9 * random_number(&seed);
      omega[p] = p % 7 ? 0 : 1e-6 * random_number(&seed);
    }
    assert_true(result_frame(r, k, values, error, sizeof error));
  }
  const result_series series[] = {{.name = "load", .unit = "N", .values = time},
                                  {.name = "energy/kinetic", .unit = "J", .values = volumes}};
  assert_true(small_finish(r, time, LONG, series, 2, error, sizeof error));
  result_discard(r);
  result_close(r);
}

static void write_small(void) {
  result_header h = small_header(name);
  result *r = small_begin(&h, error, sizeof error);
  assert_non_null(r);
  for (int k = 0; k < STEPS; k++) {
    double u[2 * PARTICLES], omega[BONDS], *values[] = {u, omega};
    small_frame(k, u, omega);
    assert_true(result_frame(r, k, (const double *const *)values, error, sizeof error));
  }
  const double time[] = {0, 1, 2, 3, 4};
  const result_series series[] = {{.name = "load", .unit = "N", .values = time},
                                  {.name = "energy/kinetic", .unit = "J", .values = time}};
  assert_true(small_finish(r, time, SAMPLES, series, 2, error, sizeof error));
  result_discard(r);
  result_close(r);
}

/* --- all answers that it can give, as one number ---------------------------------------------- */

static uint64_t add(uint64_t sum, const void *data, size_t bytes) {
  return hash_more(sum, data ? data : "none", data ? bytes : 4);
}

static uint64_t add_text(uint64_t sum, const char *text) {
  return add(sum, text, text ? strlen(text) + 1 : 0);
}

static uint64_t add_group(uint64_t sum, result_file *f, const char *group) {
  result_names n = result_members(f, group);
  for (int k = 0; k < n.count; k++) {
    char unit[64] = "";
    long count = 0, frames = 1;
    int components = 1;
    const bool history = strcmp(group, "/history") == 0;
    sum = add_text(sum, n.items[k]);
    if (!history) free(result_read_frame_times(f, &frames));
    for (long frame = 0; frame < frames; frame++) {
      double *v = history ? result_read_series(f, n.items[k], &count, unit, sizeof unit, error,
                                               sizeof error)
                          : result_read_frame(f, n.items[k], frame, &count, &components, unit,
                                              sizeof unit, error, sizeof error);
      sum = add(sum, v, sizeof *v * (size_t)(count * components));
      free(v);
    }
    sum = add_text(sum, unit);
  }
  result_names_free(&n);
  return sum;
}

/* False: no answer. */
static bool read_answers(uint64_t *answers) {
  static const char *const texts[] = {"/input/deck", "/input/set"};
  uint64_t sum = HASH_START;
  long count;
  int dimensions;
  result_file *f = result_read(name, error, sizeof error);
  if (!f) return false;
  sum = add_group(add_group(sum, f, "/history"), f, "/frames");
  double *places = result_read_reference(f, &count, &dimensions);
  sum = add(sum, places, sizeof *places * (size_t)(count * dimensions));
  double *volumes = result_read_volume(f, &count);
  sum = add(sum, volumes, sizeof *volumes * (size_t)count);
  int32_t *pairs = result_read_bonds(f, NULL, &count);
  sum = add(sum, pairs, 2 * sizeof *pairs * (size_t)count);
  double *times = result_read_frame_times(f, &count);
  sum = add(sum, times, sizeof *times * (size_t)count);
  for (int k = 0; k < 2; k++) {
    char *text = result_read_text(f, texts[k]);
    sum = add_text(sum, text);
    free(text);
  }
  char *title = result_read_title(f);
  sum = add_text(sum, title);
  free(title);
  free(places);
  free(volumes);
  free(pairs);
  free(times);
  const bool good = !result_trouble(f);
  result_read_close(f);
  *answers = sum;
  return good;
}

/* --- changes ---------------------------------------------------------------------------------- */

typedef enum change { FLIP, BYTE, ZERO, ONES, NOISE, COPY, SWAP, CUT, CHANGES } change;

/* Changes the bytes in one way; returns how many are left. */
static size_t change_bytes(unsigned char *bytes, size_t size, uint32_t *seed) {
  const change how = random_number(seed) % CHANGES;
  const size_t at = random_number(seed) % size, to = random_number(seed) % size,
               last = at > to ? at : to;
  size_t width = (size_t)1 << random_number(seed) % 12;
  if (width > size - last) width = size - last;
  if (how == FLIP) bytes[at] ^= (unsigned char)(1u << random_number(seed) % 8);
  if (how == BYTE) bytes[at] = (unsigned char)random_number(seed);
  for (size_t k = 0; k < width; k++) {
    const unsigned char here = bytes[at + k], there = bytes[to + k];
    if (how == ZERO) bytes[at + k] = 0;
    if (how == ONES) bytes[at + k] = 0xff;
    if (how == NOISE) bytes[at + k] = (unsigned char)random_number(seed);
    if (how == COPY || how == SWAP) bytes[to + k] = here;
    if (how == SWAP) bytes[at + k] = there;
  }
  return how == CUT ? at : size;
}

/* Changed results give the right answers or none. */
static void try_changes(int count, uint32_t seed) {
  uint64_t right, found = 0;
  size_t size;
  unsigned char *bytes = read_file(name, &size), *changed = malloc(size);
  int answered = 0;
  assert_true(read_answers(&right));
  for (int k = 0; k < count; k++) {
    memcpy(changed, bytes, size);
    write_file(name, changed, change_bytes(changed, size, &seed));
    if (!read_answers(&found)) continue;
    answered++;
    assert_true(found == right);
  }
  assert_true(answered < count / 4); /* the rest was seen, though nothing had to be read there */
  free(changed);
  free(bytes);
}

static void changed_results_give_the_right_answers_or_none(void **state) {
  (void)state;
  write_small();
  try_changes(1000, 1);
  write_large();
  try_changes(1000, 2);
}

/* The sums of chunks hold what the seal leaves out. */
static void damaged_chunks_are_seen_when_they_are_read(void **state) {
  (void)state;
  write_large();
  const hid_t file = H5Fopen(name, H5F_ACC_RDONLY, H5P_DEFAULT);
  const hid_t set = H5Dopen2(file, "/frames/displacement", H5P_DEFAULT), space = H5Dget_space(set);
  hsize_t place[3], bytes;
  unsigned mask;
  haddr_t at;
  assert_true(H5Dget_chunk_info(set, space, 0, place, &mask, &at, &bytes) >= 0 && bytes > 5000);
  H5Sclose(space);
  H5Dclose(set);
  H5Fclose(file);
  const int out = open(name, O_RDWR);
  assert_int_equal(pwrite(out, "damage", 6, (off_t)at + 3000), 6);
  assert_int_equal(sealed_file_state(out), SEAL_WHOLE);
  close(out);
  result_file *f = result_read(name, error, sizeof error);
  assert_non_null(f);
  long count;
  int components;
  char unit[16];
  double *omega =
      result_read_frame(f, "omega", 0, &count, &components, unit, sizeof unit, error, sizeof error);
  assert_true(omega && !result_trouble(f));
  free(omega);
  assert_null(result_read_frame(f, "displacement", 0, &count, &components, unit, sizeof unit, error,
                                sizeof error));
  assert_non_null(
      strstr(result_trouble(f), "`/frames/displacement` of `sealed.h5` cannot be read"));
  result_read_close(f);
}

/* --- what a seal covers ----------------------------------------------------------------------- */

/* A virtual set of sets of the file, and an attribute that refers to one. */
static void add_view(hid_t file, const char *of_file, const char *of_set) {
  const hsize_t size[2] = {2, SAMPLES}, start[2] = {1, 0}, count[2] = {1, SAMPLES};
  const hid_t space = H5Screate_simple(2, size, NULL), row = H5Screate_simple(1, size + 1, NULL),
              plist = H5Pcreate(H5P_DATASET_CREATE), scalar = H5Screate(H5S_SCALAR);
  H5Sselect_hyperslab(space, H5S_SELECT_SET, start, NULL, count, NULL);
  assert_true(H5Pset_virtual(plist, space, of_file, of_set, row) >= 0);
  H5Sselect_all(space);
  const hid_t set =
      H5Dcreate2(file, "/view", H5T_IEEE_F64LE, space, H5P_DEFAULT, plist, H5P_DEFAULT);
  hobj_ref_t scale;
  assert_true(set >= 0 && H5Rcreate(&scale, file, "/history/time", H5R_OBJECT, -1) >= 0);
  const hid_t a = H5Acreate2(set, "scale", H5T_STD_REF_OBJ, scalar, H5P_DEFAULT, H5P_DEFAULT);
  assert_true(H5Awrite(a, H5T_STD_REF_OBJ, &scale) >= 0);
  H5Aclose(a);
  H5Dclose(set);
  H5Pclose(plist);
  H5Sclose(scalar);
  H5Sclose(row);
  H5Sclose(space);
}

/* The least that a result needs. */
static hid_t begin_file(const char *path) {
  static const double time[SAMPLES] = {0, 1, 2, 3, 4};
  const hsize_t n[1] = {SAMPLES};
  h5_quiet();
  const hid_t file = sealed_file_create(path);
  assert_true(file >= 0 && h5_make_group(file, "/history") && h5_make_group(file, "/particles"));
  assert_true(h5_write_doubles(file, "/history/time", time, 1, n, "s"));
  return file;
}

static bool is_refused(const char *path, const char *why) {
  result_file *f = result_read(path, error, sizeof error);
  if (f) result_read_close(f);
  if (!f && !strstr(error, why)) fail_msg("said: %s", error);
  return !f;
}

/* Whatever byte it is, before the library reads it: names, types, maps of virtual sets, references,
   the seal itself. */
static void no_byte_can_be_changed(void **state) {
  (void)state;
  size_t size;
  hid_t file = begin_file(name);
  add_view(file, ".", "/history/time");
  assert_true(sealed_file_close(file, name));
  result_file *f = result_read(name, error, sizeof error);
  if (!f) fail_msg("%s", error);
  result_read_close(f);
  unsigned char *bytes = read_file(name, &size);
  const int out = open(name, O_RDWR);
  for (size_t k = 0; k < size; k++) {
    const unsigned char before = bytes[k], after = before ^ (unsigned char)(1u << k % 8);
    assert_int_equal(pwrite(out, &after, 1, (off_t)k), 1);
    const seal_state seal = sealed_file_state(out);
    if (seal == SEAL_WHOLE) fail_msg("byte %zu of %zu can be changed", k, size);
    if (seal == SEAL_NONE) assert_true(is_refused(name, "has a broken seal"));
    assert_int_equal(pwrite(out, &before, 1, (off_t)k), 1);
  }
  enum { END = 16 + 32 }; /* what one place is left out of, and the rest (sealed_file.h) */
  for (size_t left = size - 1; left >= size - END; left--) {
    assert_int_equal(ftruncate(out, (off_t)left), 0);
    assert_true(is_refused(name, "has a broken seal"));
  }
  close(out);
  free(bytes);
}

static bool is_virtual(hid_t set, void *count) {
  const hid_t plist = H5Dget_create_plist(set);
  *(int *)count += H5Pget_layout(plist) == H5D_VIRTUAL;
  H5Pclose(plist);
  return true;
}

/* A result with all that it has for other programs: virtual sets, dimension scales, words. All its
   chunks are small, so that nothing is left to their sums. */
static void no_byte_of_a_result_can_be_changed(void **state) {
  (void)state;
  enum { STRIDE = 29, FIELDS = 2, POINTS_AND_BONDS = 2 };
  size_t size;
  int views = 0;
  write_small();
  const hid_t file = H5Fopen(name, H5F_ACC_RDONLY, H5P_DEFAULT);
  assert_true(h5_stays_inside(file) && h5_each_set(file, is_virtual, &views));
  assert_int_equal(views, POINTS_AND_BONDS + FIELDS * (1 + STEPS));
  H5Fclose(file);
  unsigned char *bytes = read_file(name, &size);
  const int out = open(name, O_RDWR);
  for (size_t k = 0; k < size; k += STRIDE) {
    const unsigned char after = bytes[k] ^ (unsigned char)(1u << k % 8);
    assert_int_equal(pwrite(out, &after, 1, (off_t)k), 1);
    if (sealed_file_state(out) == SEAL_WHOLE) fail_msg("byte %zu of %zu can be changed", k, size);
    assert_int_equal(pwrite(out, &bytes[k], 1, (off_t)k), 1);
  }
  assert_int_equal(sealed_file_state(out), SEAL_WHOLE);
  close(out);
  free(bytes);
}

/* Of an earlier version, or changed by somebody who takes the responsibility: a warning, which
   commands show. */
static void results_without_a_seal_are_read(void **state) {
  (void)state;
  uint64_t before, after;
  write_small();
  assert_true(read_answers(&before));
  hid_t file = H5Fopen(name, H5F_ACC_RDWR, H5P_DEFAULT);
  assert_true(h5_attribute_text(file, "my own", "remark"));
  H5Fclose(file);
  assert_true(is_refused(name, "has a broken seal"));
  file = H5Fopen(name, H5F_ACC_RDWR, H5P_DEFAULT);
  assert_true(H5Adelete(file, "seal") >= 0);
  H5Fclose(file);
  assert_true(read_answers(&after));
  assert_true(before == after);
}

/* --- files that lead out of themselves -------------------------------------------------------- */

static void make_elsewhere(void) {
  static const double secret[SAMPLES] = {1234, 5678, 9, 10, 11};
  write_file("elsewhere.bin", secret, sizeof secret);
  hid_t file = begin_file("elsewhere.h5");
  assert_true(sealed_file_close(file, "elsewhere.h5"));
}

static void link_softly(hid_t file) {
  assert_true(H5Lcreate_soft("/history/time", file, "/history/load", H5P_DEFAULT, H5P_DEFAULT) >=
              0);
}

static void link_elsewhere(hid_t file) {
  assert_true(H5Lcreate_external("elsewhere.h5", "/history/time", file, "/history/load",
                                 H5P_DEFAULT, H5P_DEFAULT) >= 0);
}

static void store_elsewhere(hid_t file) {
  const hsize_t n[1] = {SAMPLES};
  const hid_t space = H5Screate_simple(1, n, NULL), plist = H5Pcreate(H5P_DATASET_CREATE);
  assert_true(H5Pset_external(plist, "elsewhere.bin", 0, SAMPLES * sizeof(double)) >= 0);
  const hid_t set =
      H5Dcreate2(file, "/history/load", H5T_IEEE_F64LE, space, H5P_DEFAULT, plist, H5P_DEFAULT);
  assert_true(set >= 0);
  H5Dclose(set);
  H5Pclose(plist);
  H5Sclose(space);
}

static void view_elsewhere(hid_t file) {
  add_view(file, "elsewhere.h5", "/history/time");
}

static void view_itself(hid_t file) {
  add_view(file, ".", "/view");
}

static void view_nothing(hid_t file) {
  add_view(file, ".", "/history/nothing");
}

/* The seal is whole: who makes such a file can seal it. */
static void files_that_lead_elsewhere_are_refused(void **state) {
  (void)state;
  static void (*const traps[])(hid_t) = {link_softly,    link_elsewhere, store_elsewhere,
                                         view_elsewhere, view_itself,    view_nothing};
  make_elsewhere();
  for (size_t k = 0; k < sizeof traps / sizeof *traps; k++) {
    hid_t file = begin_file(name);
    traps[k](file);
    if (!sealed_file_close(
            file, name)) { /* as with links: such a file is not sealed in the first place */
      file = H5Fopen(name, H5F_ACC_RDWR, H5P_DEFAULT);
      H5Adelete(file, "seal");
      H5Fclose(file);
    }
    assert_true(is_refused(name, "leads to other files, or in a circle"));
  }
}

/* Groups that hold each other. */
static void circles_of_groups_end(void **state) {
  (void)state;
  alarm(10);
  hid_t file = begin_file(name);
  assert_true(H5Lcreate_hard(file, "/", file, "/history/up", H5P_DEFAULT, H5P_DEFAULT) >= 0);
  assert_true(sealed_file_close(file, name));
  result_file *f = result_read(name, error, sizeof error);
  assert_non_null(f);
  result_names n = result_members(f, "/history");
  result_names_free(&n);
  result_read_close(f);
  alarm(0);
}

static void a_pipe_is_refused(void **state) {
  (void)state;
  alarm(10); /* ends the test, were it waiting */
  assert_int_equal(mkfifo(name, 0600), 0);
  assert_true(is_refused(name, "it is not a file"));
  alarm(0);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test_teardown(changed_results_give_the_right_answers_or_none, clean),
      cmocka_unit_test_teardown(damaged_chunks_are_seen_when_they_are_read, clean),
      cmocka_unit_test_teardown(no_byte_can_be_changed, clean),
      cmocka_unit_test_teardown(no_byte_of_a_result_can_be_changed, clean),
      cmocka_unit_test_teardown(results_without_a_seal_are_read, clean),
      cmocka_unit_test_teardown(files_that_lead_elsewhere_are_refused, clean),
      cmocka_unit_test_teardown(circles_of_groups_end, clean),
      cmocka_unit_test_teardown(a_pipe_is_refused, clean),
  };
  return cmocka_run_group_tests_name("sealed_file", tests, NULL, NULL);
}
