/* Data sets of files that are no honest results: what is missing, of another rank, or claims more
   values than its bytes can hold, is told and not read. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "runtime/result/result_sets.h"

static const char path[] = "sets.h5";

/* In chunks, of which none is written. */
static void add_set(hid_t file, const char *name, int rank, const hsize_t shape[4]) {
  const hsize_t chunk[4] = {1, 1, 1, 1};
  const hid_t space = H5Screate_simple(rank, shape, NULL), how = H5Pcreate(H5P_DATASET_CREATE);
  H5Pset_chunk(how, rank, chunk);
  H5Dclose(H5Dcreate2(file, name, H5T_NATIVE_DOUBLE, space, H5P_DEFAULT, how, H5P_DEFAULT));
  H5Pclose(how);
  H5Sclose(space);
}

static int set_up(void **state) {
  char error[512];
  const hid_t file = H5Fcreate(path, H5F_ACC_TRUNC, H5P_DEFAULT, H5P_DEFAULT);
  static const char *const groups[] = {"/history", "/particles"};
  for (int k = 0; k < 2; k++)
    H5Gclose(H5Gcreate2(file, groups[k], H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT));
  add_set(file, "/history/load", 1, (const hsize_t[4]){3});
  add_set(file, "/history/flat", 2, (const hsize_t[4]){3, 2});
  add_set(file, "/history/deep", 4, (const hsize_t[4]){1, 1, 1, 1});
  add_set(file, "/history/huge", 1, (const hsize_t[4]){UINT64_C(1) << 31});
  H5Fclose(file);
  *state = result_read(path, error, sizeof error);
  return *state == NULL;
}

static int tear_down(void **state) {
  result_read_close(*state);
  return unlink(path);
}

static void what_is_there_is_read(void **state) {
  hsize_t shape[3];
  char error[512];
  const hid_t set = result_set_named(*state, "/history", "load", error, sizeof error);
  assert_true(set >= 0);
  double *values = result_set_read(*state, set, H5T_NATIVE_DOUBLE, sizeof *values, 1, shape);
  assert_non_null(values);
  assert_true(shape[0] == 3 && values[2] == 0);
  assert_null(result_trouble(*state));
  free(values);
  H5Dclose(set);
}

static void what_is_not_there_is_told(void **state) {
  char error[512] = "";
  assert_true(result_set_open(*state, "/history/none") < 0);
  assert_true(result_set_open(*state, "/none/load") < 0);
  assert_true(result_set_named(*state, "/history", "loaf", error, sizeof error) < 0);
  assert_non_null(strstr(error, "did you mean `load`?"));
}

static void sizes_are_not_believed(void **state) {
  static const char *const names[] = {"/history/flat", "/history/deep", "/history/huge"};
  for (int k = 0; k < 3; k++) {
    hsize_t shape[3];
    int rank;
    const hid_t set = result_set_open(*state, names[k]);
    assert_true(set >= 0);
    assert_true(result_set_shape(set, 0, &rank, shape) == (k == 0));
    assert_null(result_set_read(*state, set, H5T_NATIVE_DOUBLE, sizeof(double), 1, shape));
    assert_non_null(strstr(result_trouble(*state), "/history/flat")); /* the first is kept */
    H5Dclose(set);
  }
}

int main(void) {
  const struct CMUnitTest tests[] = {cmocka_unit_test(what_is_there_is_read),
                                     cmocka_unit_test(what_is_not_there_is_told),
                                     cmocka_unit_test(sizes_are_not_believed)};
  return cmocka_run_group_tests(tests, set_up, tear_down);
}
