#include "runtime/result/views.h"

#include <stdlib.h>
#include <string.h>

#include "runtime/result/hdf5_tools.h"

enum { NAME = 512 };
enum { LINE = 3, TRIANGLE = 5, QUAD = 9, QUADRATIC_TRIANGLE = 22 }; /* of VTK */

int views_components(const result_field *f) {
  return f->components == 1 ? 1 : 3;
}

/* --- arrays ----------------------------------------------------------------------------------- */

static bool is_same(const result_field *a, const result_field *b) {
  return a->interaction && b->interaction && strcmp(a->name, b->name) == 0 &&
         strcmp(a->unit, b->unit) == 0 && a->components == b->components;
}

/* Two fields of bonds may have one name and other units. */
static bool is_taken(const views_array *arrays, int count, const result_field *f) {
  for (int k = 0; k < count; k++)
    if (arrays[k].field->interaction && f->interaction && strcmp(arrays[k].name, f->name) == 0)
      return true;
  return false;
}

int views_arrays(const result_header *h, views_array *arrays, arena *texts) {
  int count = 0;
  for (int k = 0; k < h->field_count; k++) {
    const result_field *f = &h->fields[k];
    bool shown = result_field_of_cracks(f) || result_field_of_cells(f) || result_field_of_stamp(f);
    for (int n = 0; n < count; n++)
      shown = shown || is_same(arrays[n].field, f);
    if (shown) continue;
    const bool taken = is_taken(arrays, count, f);
    arrays[count++] = (views_array){
        f, taken ? arena_printf(texts, "%s of %s", f->name, f->interaction) : f->name};
  }
  return count;
}

long views_bonds(const result_header *h) {
  long sum = 0;
  for (int k = 0; k < h->interaction_count; k++)
    sum += h->bonds[k].count;
  return sum;
}

long views_count(const result_header *h, const result_field *f) {
  return f->interaction ? views_bonds(h) : h->particle_count;
}

static const char *place_of(const result_field *f) {
  return f->interaction ? "bonds" : "particles";
}

void views_frame_name(const views_array *a, long frame, char *name, size_t size) {
  snprintf(name, size, "/xdmf/%s/%s/%ld", place_of(a->field), a->name, frame);
}

/* What an array is made of. */
typedef struct sources {
  h5_block *blocks; /* [interactions] */
  char (*sets)[NAME];
  int count;
  bool gaps;
} sources;

static void add_source(sources *s, const result_field *f, long first, long count, long before,
                       long all) {
  char *set = s->sets[s->count];
  snprintf(set, NAME, "/frames/%s%s%s", f->interaction ? f->interaction : "",
           f->interaction ? "/" : "", f->name);
  s->blocks[s->count++] =
      (h5_block){.set = set,
                 .start = {(hsize_t)first},
                 .count = {(hsize_t)count, (hsize_t)f->count, (hsize_t)f->components},
                 .first = (hsize_t)before,
                 .rows = (hsize_t)f->count,
                 .every = (hsize_t)all};
}

/* `count` frames from `first` on. */
static void find_sources(const result_header *h, const result_field *of, long first, long count,
                         sources *s) {
  const long all = views_count(h, of);
  long before = 0;
  s->count = 0;
  s->gaps = false;
  if (!of->interaction) add_source(s, of, first, count, 0, all);
  for (int b = 0; of->interaction && b < h->interaction_count; b++) {
    const int had = s->count;
    for (int k = 0; k < h->field_count; k++)
      if (is_same(&h->fields[k], of) && strcmp(h->fields[k].interaction, h->bonds[b].name) == 0)
        add_source(s, &h->fields[k], first, count, before, all);
    s->gaps = s->gaps || (s->count == had && h->bonds[b].count > 0);
    before += h->bonds[b].count;
  }
}

/* `count` frames of an array from `first` on, one behind the other. */
static bool show_frames(hid_t file, const result_header *h, const char *name, const result_field *f,
                        long first, long count) {
  const size_t most = (size_t)h->interaction_count + 1;
  const hsize_t shape[2] = {(hsize_t)(count * views_count(h, f)), 3};
  sources s = {.blocks = must_calloc(most, sizeof *s.blocks),
               .sets = must_calloc(most, sizeof *s.sets)};
  find_sources(h, f, first, count, &s);
  const bool good =
      h5_make_view(file, name, views_components(f) == 1 ? 1 : 2, shape, s.blocks, s.count, s.gaps);
  free(s.blocks);
  free(s.sets);
  return good;
}

static bool show_each_frame(hid_t file, const result_header *h, const views_array *a, long frames) {
  char name[NAME];
  snprintf(name, sizeof name, "/xdmf/%s/%s", place_of(a->field), a->name);
  bool good = h5_make_group(file, name);
  for (long k = 0; good && k < frames; k++) {
    views_frame_name(a, k, name, sizeof name);
    good = show_frames(file, h, name, a->field, k, 1);
  }
  return good;
}

/* --- /VTKHDF ---------------------------------------------------------------------------------- */

/* One number for each part. */
static bool write_counts(hid_t file, const char *name, const int64_t *values, int parts) {
  const hsize_t shape[1] = {(hsize_t)parts};
  return h5_write_list(file, name, values, 1, shape);
}

typedef struct grid_parts { /* of the grid, which frames choose from */
  int count;
  const mesh_cells *sets; /* [count]; NULL: bonds */
  int64_t *cells, *ids;   /* [count] how many, and points of all of them */
} grid_parts;

/* Bonds, or where there are none the cells of meshes. */
static grid_parts parts_of(const result_header *h, const mesh_views *m) {
  const bool bonds = views_bonds(h) > 0 || m->set_count == 0;
  grid_parts p = {.count = bonds ? 1 : m->set_count, .sets = bonds ? NULL : m->sets};
  p.cells = must_calloc(2 * (size_t)p.count, sizeof *p.cells);
  p.ids = p.cells + p.count;
  for (int k = 0; k < p.count; k++) {
    p.cells[k] = bonds ? views_bonds(h) : m->sets[k].count;
    p.ids[k] = bonds ? 2 * views_bonds(h) : m->sets[k].corner_count;
  }
  return p;
}

static int nodes_of(const grid_parts *p, int part, int64_t cell) {
  return p->sets ? p->sets[part].nodes[cell] : 2;
}

static unsigned char kind_of(int nodes) {
  return nodes == 2 ? LINE : nodes == 3 ? TRIANGLE : nodes == 4 ? QUAD : QUADRATIC_TRIANGLE;
}

/* In each part the points of cells begin at 0. */
static bool write_kinds(hid_t file, const grid_parts *p) {
  int64_t all = 0, at = 0, cell = 0;
  for (int k = 0; k < p->count; k++)
    all += p->cells[k];
  const hsize_t cells[1] = {(hsize_t)all}, ends[1] = {(hsize_t)(all + p->count)};
  int32_t *offsets = must_alloc((size_t)ends[0] * sizeof *offsets);
  unsigned char *types = must_alloc((size_t)all + 1);
  for (int k = 0; k < p->count; k++) {
    int32_t offset = 0;
    for (int64_t c = 0; c < p->cells[k]; c++) {
      const int nodes = nodes_of(p, k, c);
      types[cell++] = kind_of(nodes);
      offsets[at++] = offset;
      offset += nodes;
    }
    offsets[at++] = offset;
  }
  const bool good = h5_write_integers(file, "/VTKHDF/Offsets", offsets, 1, ends) &&
                    h5_write_bytes(file, "/VTKHDF/Types", types, 1, cells);
  free(types);
  free(offsets);
  return good;
}

/* The bonds of all interactions, one after the other. */
static bool show_bonds(hid_t file, const result_header *h) {
  const hsize_t ends[1] = {2 * (hsize_t)views_bonds(h)};
  const size_t most = (size_t)h->interaction_count;
  h5_block *blocks = must_calloc(most, sizeof *blocks);
  char(*sets)[NAME] = must_calloc(most, sizeof *sets);
  hsize_t before = 0;
  for (int b = 0; b < h->interaction_count; b++) {
    const hsize_t count = (hsize_t)h->bonds[b].count;
    snprintf(sets[b], NAME, "/bonds/%s", h->bonds[b].name);
    blocks[b] = (h5_block){
        .set = sets[b], .count = {count, 2}, .first = before, .rows = 2 * count, .every = ends[0]};
    before += 2 * count;
  }
  const bool good =
      h5_make_view(file, VIEWS_CONNECTIVITY, 1, ends, blocks, h->interaction_count, false);
  free(blocks);
  free(sets);
  return good;
}

/* The cells of all sets, one after the other. */
static bool write_cells(hid_t file, const mesh_views *m) {
  hsize_t ends[1] = {0}, at = 0;
  for (int k = 0; k < m->set_count; k++)
    ends[0] += (hsize_t)m->sets[k].corner_count;
  int32_t *corners = must_alloc(((size_t)ends[0] + 1) * sizeof *corners);
  for (int k = 0; k < m->set_count; k++) {
    const size_t numbers = (size_t)m->sets[k].corner_count;
    if (numbers) memcpy(corners + at, m->sets[k].corners, numbers * sizeof *corners);
    at += numbers;
  }
  const bool good = h5_write_integers(file, VIEWS_CONNECTIVITY, corners, 1, ends);
  free(corners);
  return good;
}

static bool write_grid(hid_t file, const result_header *h, const mesh_views *m,
                       const grid_parts *p) {
  const hsize_t points[2] = {(hsize_t)h->particle_count, 3};
  const h5_block places = {.set = "/particles/reference",
                           .count = {points[0], (hsize_t)h->dimensions}};
  int64_t *numbers = must_calloc((size_t)p->count, sizeof *numbers);
  for (int k = 0; k < p->count; k++)
    numbers[k] = h->particle_count;
  const bool good = write_counts(file, "/VTKHDF/NumberOfPoints", numbers, p->count) &&
                    write_counts(file, "/VTKHDF/NumberOfCells", p->cells, p->count) &&
                    write_counts(file, "/VTKHDF/NumberOfConnectivityIds", p->ids, p->count) &&
                    h5_make_view(file, VIEWS_POINTS, 2, points, &places, 1, false) &&
                    (p->sets ? write_cells(file, m) : show_bonds(file, h)) && write_kinds(file, p);
  free(numbers);
  return good;
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

/* Of the parts of the frames: which one, where its cells begin, and their points. */
static bool write_parts(hid_t file, const mesh_views *m, const grid_parts *p, long frames) {
  const hsize_t shape[2] = {(hsize_t)frames, 1};
  int64_t *part = must_calloc(3 * (size_t)frames, sizeof *part), *cell = part + frames,
          *id = cell + frames;
  for (long k = 0; k < frames; k++) {
    part[k] = p->count > 1 ? m->set_of_frame[k] : 0;
    for (int64_t n = 0; n < part[k]; n++) {
      cell[k] += p->cells[n];
      id[k] += p->ids[n];
    }
  }
  const bool good = h5_write_list(file, "/VTKHDF/Steps/PartOffsets", part, 1, shape) &&
                    h5_write_list(file, "/VTKHDF/Steps/CellOffsets", cell, 2, shape) &&
                    h5_write_list(file, "/VTKHDF/Steps/ConnectivityIdOffsets", id, 2, shape);
  free(part);
  return good;
}

/* The points are the same in all frames: they begin at 0. */
static bool write_steps(hid_t file, const mesh_views *m, const grid_parts *p, long frames) {
  bool good = h5_make_group(file, "/VTKHDF/Steps");
  const hid_t steps = good ? H5Gopen2(file, "/VTKHDF/Steps", H5P_DEFAULT) : -1;
  if (steps < 0) return false;
  good = h5_attribute_integer(steps, "NSteps", frames) &&
         H5Lcreate_hard(file, "/frames/time", steps, "Values", H5P_DEFAULT, H5P_DEFAULT) >= 0;
  H5Gclose(steps);
  return good && h5_make_group(file, "/VTKHDF/Steps/PointDataOffsets") &&
         h5_make_group(file, "/VTKHDF/Steps/CellDataOffsets") &&
         write_beginnings(file, "/VTKHDF/Steps/NumberOfParts", 1, frames, 1, 0) &&
         write_beginnings(file, "/VTKHDF/Steps/PointOffsets", 1, frames, 0, 0) &&
         write_parts(file, m, p, frames);
}

static bool write_array(hid_t file, const result_header *h, const views_array *a, long frames) {
  char name[NAME], offsets[NAME];
  const char *data = a->field->interaction ? "CellData" : "PointData";
  snprintf(name, sizeof name, "/VTKHDF/%s/%s", data, a->name);
  snprintf(offsets, sizeof offsets, "/VTKHDF/Steps/%sOffsets/%s", data, a->name);
  return show_frames(file, h, name, a->field, 0, frames) &&
         write_beginnings(file, offsets, 1, frames, 0, views_count(h, a->field));
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

/* Values of cells stand there already, frame by frame. */
static bool link_values(hid_t file, const mesh_views *m, const result_field *f, long frames) {
  char all[NAME], name[NAME], offsets[NAME];
  const hsize_t shape[1] = {(hsize_t)frames};
  int64_t *at = must_alloc((size_t)frames * sizeof *at);
  for (long k = 0; k < frames; k++)
    at[k] = mesh_views_values_begin(m, k);
  mesh_views_all_values_name(f, all, sizeof all);
  snprintf(name, sizeof name, "/VTKHDF/CellData/%s", f->name);
  snprintf(offsets, sizeof offsets, "/VTKHDF/Steps/CellDataOffsets/%s", f->name);
  const bool good = H5Lcreate_hard(file, all, file, name, H5P_DEFAULT, H5P_DEFAULT) >= 0 &&
                    h5_write_list(file, offsets, at, 1, shape);
  free(at);
  return good;
}

static bool link_all_values(hid_t file, const result_header *h, const mesh_views *m, long frames) {
  bool good = true;
  for (int k = 0; k < h->field_count && good; k++)
    if (result_field_of_cells(&h->fields[k])) good = link_values(file, m, &h->fields[k], frames);
  return good;
}

bool views_write(hid_t file, const result_header *h, const mesh_views *m, long frames) {
  grid_parts parts = parts_of(h, m);
  bool good = begin_groups(file) && write_grid(file, h, m, &parts) &&
              (!frames || write_steps(file, m, &parts, frames)) &&
              mesh_views_write(file, h, m, frames) &&
              (!parts.sets || !frames || link_all_values(file, h, m, frames));
  free(parts.cells);
  arena *texts = arena_new();
  views_array *arrays = must_calloc((size_t)h->field_count + 1, sizeof *arrays);
  const int count = frames ? views_arrays(h, arrays, texts) : 0;
  for (int k = 0; good && k < count; k++)
    good = write_array(file, h, &arrays[k], frames) && show_each_frame(file, h, &arrays[k], frames);
  free(arrays);
  arena_free(texts);
  return good;
}
