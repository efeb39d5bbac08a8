#include "runtime/result/result_sets.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "dsl/base/arena.h"
#include "dsl/base/characters.h"
#include "dsl/base/diagnostics.h"
#include "runtime/result/result_find.h"

#define VALUES_LIMIT ((hsize_t)1 << 32) /* of one read: 32 GiB of doubles */

void result_set_report(result_file *f, hid_t set) {
  char name[512] = "";
  if (f->trouble[0]) return;
  H5Iget_name(set, name, sizeof name);
  snprintf(f->trouble, sizeof f->trouble, "`%s` of `%s` cannot be read: it is damaged", name,
           f->path);
}

/* Every part of the path must exist before H5Dopen may be asked. */
hid_t result_set_open(const result_file *f, const char *name) {
  char part[512];
  for (const char *at = strchr(name + 1, '/');; at = strchr(at + 1, '/')) {
    size_t n = at ? (size_t)(at - name) : strlen(name);
    if (n >= sizeof part) return -1;
    memcpy(part, name, n);
    part[n] = 0;
    if (H5Lexists(f->file, part, H5P_DEFAULT) <= 0) return -1;
    if (!at) return H5Dopen2(f->file, name, H5P_DEFAULT);
  }
}

/* False of a set that claims more values than its bytes in the file can hold, however well they are
   compressed (deflate reaches 1032): a small file must not ask for all memory. */
static bool is_stored(hid_t set, int rank, const hsize_t *shape) {
  const hid_t type = H5Dget_type(set);
  double bytes = (double)H5Tget_size(type);
  H5Tclose(type);
  for (int k = 0; k < rank; k++)
    bytes *= (double)shape[k];
  return bytes <= 1100.0 * (double)H5Dget_storage_size(set) + 64e6;
}

bool result_set_shape(hid_t set, int from, int *rank, hsize_t shape[3]) {
  hid_t space = H5Dget_space(set);
  *rank = H5Sget_simple_extent_ndims(space);
  bool good = *rank >= 1 && *rank <= 3 && H5Sget_simple_extent_dims(space, shape, NULL) >= 0;
  H5Sclose(space);
  hsize_t product = 1;
  for (int k = from; good && k < *rank; k++) {
    good = shape[k] <= VALUES_LIMIT / (product ? product : 1);
    product *= shape[k];
  }
  return good && is_stored(set, *rank, shape);
}

void *result_set_read(result_file *f, hid_t set, hid_t type, size_t width, int rank_wanted,
                      hsize_t shape[3]) {
  int rank;
  if (!result_set_shape(set, 0, &rank, shape) || rank != rank_wanted) {
    result_set_report(f, set);
    return NULL;
  }
  size_t count = 1;
  for (int k = 0; k < rank; k++)
    count *= (size_t)shape[k];
  void *values = must_calloc(count + 1, width);
  if (count && H5Dread(set, type, H5S_ALL, H5S_ALL, H5P_DEFAULT, values) < 0) {
    result_set_report(f, set);
    free(values);
    return NULL;
  }
  return values;
}

hid_t result_set_named(result_file *f, const char *group, const char *given, char *error,
                       size_t size) {
  char name[512], path[600];
  snprintf(path, sizeof path, "%s/%s", group, given);
  hid_t set = result_set_open(f, path);
  if (set >= 0) return set;
  if (!result_find(f, group, given, name, sizeof name, error, size)) return -1;
  snprintf(path, sizeof path, "%s/%s", group, name);
  set = result_set_open(f, path);
  if (set < 0) snprintf(error, size, "`%s` of `%s` cannot be read", name_shown(name), f->path);
  return set;
}
