#include "generator/drive/drive_hdf5.h"

#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "generator/kernel/version.h"
#include "runtime/base/whole_file.h"
#include "runtime/result/hdf5_tools.h"
#include "runtime/result/sealed_file.h"

static bool cannot_write(const char *path, char *error, size_t size) {
  const int reason = errno;
  snprintf(error, size, "cannot write `%s`: %s", path,
           reason ? strerror(reason) : "the HDF5 library refused");
  return false;
}

static double spacing_of(const drive_input *in, const drive_table *t) {
  return t->of == DRIVE_OF_POINTS     ? in->point.cell_size
         : t->of == DRIVE_OF_FAMILIES ? in->particle.spacing
                                      : in->bond.spacing;
}

static double volume_of(const drive_input *in, const drive_table *t) {
  const bool bond = t->of == DRIVE_OF_BONDS;
  const double s = spacing_of(in, t);
  if (t->of == DRIVE_OF_POINTS) return s * s * s;
  if (bond && in->bond.area > 0) return in->bond.area * s;
  return sqrt(3) / 2 * s * s * (bond ? in->bond.thickness : in->particle.thickness);
}

static bool write_particles(const drive_input *in, const drive_table *t, hid_t file) {
  const double s = spacing_of(in, t), reference[4] = {0, 0, s, 0};
  const double one = volume_of(in, t), volume[2] = {one, one};
  const int32_t body[2] = {0, 0};
  const hsize_t extent[2] = {2, 2};
  return h5_make_group(file, "/particles") &&
         h5_write_doubles(file, "/particles/reference", reference, 2, extent, "m") &&
         h5_write_integers(file, "/particles/body", body, 1, extent) &&
         h5_write_doubles(file, "/particles/volume", volume, 1, extent, "m^3");
}

static bool write_file(const drive_input *in, const drive_table *t, hid_t file) {
  char name[256];
  bool good = h5_attribute_text(file, "perilat_version", perilat_version) &&
              h5_attribute_text(file, "title", in->simulation.title) &&
              write_particles(in, t, file) && h5_make_group(file, "/history");
  const hsize_t rows = (hsize_t)t->rows;
  for (int c = 0; good && c < t->column_count; c++) {
    snprintf(name, sizeof name, "/history/%s", t->columns[c].name);
    good = h5_write_doubles(file, name, t->columns[c].values, 1, &rows,
                            unit_is_pure(t->columns[c].unit) ? "1" : t->columns[c].unit);
  }
  return good;
}

bool drive_write_hdf5(const drive_input *in, const drive_table *t, const char *path, char *error,
                      size_t size) {
  whole_file whole;
  if (!whole_file_begin(&whole, path)) return cannot_write(path, error, size);
  h5_quiet();
  errno = 0;
  const hid_t file = sealed_file_create(whole.working);
  bool good = file >= 0 && write_file(in, t, file);
  good = file >= 0 && sealed_file_close(file, whole.working) && good;
  return whole_file_end(&whole, good) || cannot_write(path, error, size);
}
