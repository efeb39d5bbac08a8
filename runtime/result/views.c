#include "runtime/result/views.h"

#include <stdlib.h>
#include <string.h>

#include "dsl/base/arena.h"
#include "runtime/result/hdf5_tools.h"

enum { NAME = 512, LINE = 3 }; /* VTK's number of a cell that is a line */

int views_components(const result_field *f) {
  return f->components == 1 ? 1 : 3;
}

/* --- fields ----------------------------------------------------------------------------------- */

static const char *place_of(const result_field *f) {
  return f->interaction ? "bonds" : "particles";
}

void views_frame_name(const result_field *f, long frame, char *name, size_t size) {
  snprintf(name, size, "/xdmf/%s/%s/%ld", place_of(f), f->name, frame);
}

/* `count` frames of a field from `first` on, one behind the other. */
static bool show_frames(hid_t file, const char *name, const result_field *f, long first,
                        long count) {
  char set[NAME];
  const hsize_t shape[2] = {(hsize_t)(count * f->count), 3};
  snprintf(set, sizeof set, "/frames/%s%s%s", f->interaction ? f->interaction : "",
           f->interaction ? "/" : "", f->name);
  return h5_make_view(file, name, views_components(f) == 1 ? 1 : 2, shape,
                      &(h5_block){set,
                                  {(hsize_t)first},
                                  {(hsize_t)count, (hsize_t)f->count, (hsize_t)f->components}});
}

static bool show_each_frame(hid_t file, const result_field *f, long frames) {
  char name[NAME];
  snprintf(name, sizeof name, "/xdmf/%s/%s", place_of(f), f->name);
  bool good = h5_make_group(file, name);
  for (long k = 0; good && k < frames; k++) {
    views_frame_name(f, k, name, sizeof name);
    good = show_frames(file, name, f, k, 1);
  }
  return good;
}

/* --- /VTKHDF ---------------------------------------------------------------------------------- */

static bool write_count(hid_t file, const char *name, long count) {
  const hsize_t one[1] = {1};
  const int64_t value = count;
  return h5_write_list(file, name, &value, 1, one);
}

/* Cells that are lines have their points at 0, 2, 4, ... */
static bool write_lines(hid_t file, long count) {
  const hsize_t cells[1] = {(hsize_t)count}, ends[1] = {(hsize_t)count + 1};
  int32_t *offsets = must_alloc(((size_t)count + 1) * sizeof *offsets);
  unsigned char *types = must_alloc((size_t)count + 1);
  memset(types, LINE, (size_t)count + 1);
  for (long k = 0; k <= count; k++)
    offsets[k] = (int32_t)(2 * k);
  const bool good = h5_write_integers(file, "/VTKHDF/Offsets", offsets, 1, ends) &&
                    h5_write_bytes(file, "/VTKHDF/Types", types, 1, cells);
  free(types);
  free(offsets);
  return good;
}

static bool write_grid(hid_t file, const result_header *h) {
  char bonds[NAME];
  const hsize_t points[2] = {(hsize_t)h->particle_count, 3}, ends[1] = {2 * (hsize_t)h->bond_count};
  snprintf(bonds, sizeof bonds, "/bonds/%s", h->interaction);
  return write_count(file, "/VTKHDF/NumberOfPoints", h->particle_count) &&
         write_count(file, "/VTKHDF/NumberOfCells", h->bond_count) &&
         write_count(file, "/VTKHDF/NumberOfConnectivityIds", 2 * h->bond_count) &&
         h5_make_view(
             file, VIEWS_POINTS, 2, points,
             &(h5_block){"/particles/reference", {0}, {points[0], (hsize_t)h->dimensions}}) &&
         h5_make_view(file, VIEWS_CONNECTIVITY, 1, ends,
                      &(h5_block){bonds, {0}, {(hsize_t)h->bond_count, 2}}) &&
         write_lines(file, h->bond_count);
}

/* For each frame where something begins: `stride` further each time. */
static bool write_beginnings(hid_t file, const char *name, int rank, long frames, int64_t first,
                             int64_t stride) {
  const hsize_t shape[2] = {(hsize_t)frames, 1};
  int64_t *at = must_alloc((size_t)frames * sizeof *at);
  for (long k = 0; k < frames; k++)
    at[k] = first + stride * k;
  const bool good = h5_write_list(file, name, at, rank, shape);
  free(at);
  return good;
}

/* The grid is the same in all frames: it begins at 0. */
static bool write_steps(hid_t file, long frames) {
  bool good = h5_make_group(file, "/VTKHDF/Steps");
  const hid_t steps = good ? H5Gopen2(file, "/VTKHDF/Steps", H5P_DEFAULT) : -1;
  if (steps < 0) return false;
  good = h5_attribute_integer(steps, "NSteps", frames) &&
         H5Lcreate_hard(file, "/frames/time", steps, "Values", H5P_DEFAULT, H5P_DEFAULT) >= 0;
  H5Gclose(steps);
  return good && h5_make_group(file, "/VTKHDF/Steps/PointDataOffsets") &&
         h5_make_group(file, "/VTKHDF/Steps/CellDataOffsets") &&
         write_beginnings(file, "/VTKHDF/Steps/PartOffsets", 1, frames, 0, 0) &&
         write_beginnings(file, "/VTKHDF/Steps/NumberOfParts", 1, frames, 1, 0) &&
         write_beginnings(file, "/VTKHDF/Steps/PointOffsets", 1, frames, 0, 0) &&
         write_beginnings(file, "/VTKHDF/Steps/CellOffsets", 2, frames, 0, 0) &&
         write_beginnings(file, "/VTKHDF/Steps/ConnectivityIdOffsets", 2, frames, 0, 0);
}

static bool write_array(hid_t file, const result_field *f, long frames) {
  char name[NAME], offsets[NAME];
  const char *data = f->interaction ? "CellData" : "PointData";
  snprintf(name, sizeof name, "/VTKHDF/%s/%s", data, f->name);
  snprintf(offsets, sizeof offsets, "/VTKHDF/Steps/%sOffsets/%s", data, f->name);
  return show_frames(file, name, f, 0, frames) &&
         write_beginnings(file, offsets, 1, frames, 0, f->count);
}

static bool begin_groups(hid_t file) {
  static const char *const groups[] = {"/VTKHDF", "/VTKHDF/PointData", "/VTKHDF/CellData",
                                       "/xdmf",   "/xdmf/particles",   "/xdmf/bonds"};
  static const int64_t version[2] = {2, 0};
  bool good = true;
  for (size_t k = 0; good && k < sizeof groups / sizeof *groups; k++)
    good = h5_make_group(file, groups[k]);
  const hid_t vtk = good ? H5Gopen2(file, "/VTKHDF", H5P_DEFAULT) : -1;
  if (vtk < 0) return false;
  good = h5_attribute_integers(vtk, "Version", version, 2) &&
         h5_attribute_name(vtk, "Type", "UnstructuredGrid");
  return H5Gclose(vtk) >= 0 && good;
}

bool views_write(hid_t file, const result_header *h, long frames) {
  bool good = begin_groups(file) && write_grid(file, h) && (!frames || write_steps(file, frames));
  for (int k = 0; good && frames && k < h->field_count; k++)
    good = write_array(file, &h->fields[k], frames) && show_each_frame(file, &h->fields[k], frames);
  return good;
}
