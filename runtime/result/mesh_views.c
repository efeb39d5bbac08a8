#include "runtime/result/mesh_views.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "dsl/base/arena.h"
#include "dsl/base/elementary.h"
#include "runtime/result/hdf5_tools.h"

enum { NAME = 512 };

static void cells_free(mesh_cells *c) {
  free(c->corners);
  free(c->nodes);
  free(c->numbers);
}

void mesh_views_free(mesh_views *v) {
  for (int k = 0; k < v->path_count; k++)
    free(v->paths[k].points);
  for (int k = 0; k < v->set_count; k++)
    cells_free(&v->sets[k]);
  free(v->paths);
  free(v->sets);
  free(v->set_of_frame);
  free(v->dead);
}

long mesh_path_count(const mesh_path *p, long frame) {
  const double *at = p->points + 2 * p->most * frame;
  long count = 0;
  while (count < p->most && !isnan(at[2 * count]))
    count++;
  return count;
}

/* --- cells that no crack crosses -------------------------------------------------------------- */

/* Whether the line a -> b has a part inside the box; a line along its border has none. */
static bool crosses(const double a[2], const double b[2], const double low[2],
                    const double high[2]) {
  double from = 0, to = 1;
  for (int c = 0; c < 2; c++) {
    const double way = b[c] - a[c], margin = 1e-9 * (high[c] - low[c]);
    const double first = low[c] + margin - a[c], last = high[c] - margin - a[c];
    if (way == 0) {
      if (first >= 0 || last <= 0) return false;
      continue;
    }
    from = pl_fmax(from, pl_fmin(first / way, last / way));
    to = pl_fmin(to, pl_fmax(first / way, last / way));
  }
  return from < to;
}

static bool is_crossed(const mesh_path *p, long frame, const double low[2], const double high[2]) {
  const double *at = p->points + 2 * p->most * frame;
  bool crossed = false;
  for (long k = 1; k < p->most && !isnan(at[2 * k]) && !crossed; k++)
    crossed = crosses(at + 2 * k - 2, at + 2 * k, low, high);
  return crossed;
}

static bool is_whole(const mesh_views *v, const result_header *h, const result_mesh *m,
                     const int32_t *cell, long frame) {
  if (v->path_count == 0) return true;
  const double *low = h->reference + 2 * (m->first_particle + cell[0]),
               *high = h->reference + 2 * (m->first_particle + cell[2]);
  for (int k = 0; k < v->path_count; k++)
    if (strcmp(v->paths[k].mesh, m->name) == 0 && is_crossed(&v->paths[k], frame, low, high))
      return false;
  return true;
}

static void add_cell(mesh_cells *c, long first_particle, const int32_t *cell, int columns,
                     int32_t number) {
  int nodes = 0;
  for (; nodes < columns && cell[nodes] >= 0; nodes++)
    c->corners[c->corner_count++] = (int32_t)first_particle + cell[nodes];
  c->alike = c->count == 0 || c->alike == nodes ? nodes : 0;
  c->numbers[c->count] = number;
  c->nodes[c->count++] = (unsigned char)nodes;
}

static bool has_died(const mesh_views *v, unsigned char *begun, long corner, long frame) {
  return mesh_cell_died(v->dead[frame * v->particles + corner], begun[corner]++);
}

/* Without frames nothing is known of cracks. */
static mesh_cells cells_of(const mesh_views *v, const result_header *h, long frame, bool all) {
  mesh_cells shown = {.count = 0};
  size_t most = 0, corners = 0;
  int32_t number = 0;
  for (int n = 0; n < h->mesh_count; n++) {
    most += (size_t)h->meshes[n].cell_count;
    corners += (size_t)h->meshes[n].cell_count * (size_t)h->meshes[n].columns;
  }
  shown.corners = must_alloc((corners + 1) * sizeof *shown.corners);
  shown.nodes = must_alloc(most + 1);
  shown.numbers = must_alloc((most + 1) * sizeof *shown.numbers);
  unsigned char *begun = must_calloc((size_t)v->particles + 1, 1); /* cells so far at a corner */
  for (int n = 0; n < h->mesh_count; n++)
    for (long c = 0; c < h->meshes[n].cell_count; c++, number++) {
      const result_mesh *m = &h->meshes[n];
      const int32_t *cell = m->cells + m->columns * c;
      const bool died = !all && v->dead && has_died(v, begun, m->first_particle + cell[0], frame);
      if (!died && (all || is_whole(v, h, m, cell, frame)))
        add_cell(&shown, m->first_particle, cell, m->columns, number);
    }
  free(begun);
  return shown;
}

/* All cracks and dead cells are as they were a frame before. */
static bool is_unchanged(const mesh_views *v, long frame) {
  bool same = frame > 0;
  if (v->dead && same)
    same = memcmp(v->dead + frame * v->particles, v->dead + (frame - 1) * v->particles,
                  (size_t)v->particles * sizeof *v->dead) == 0;
  for (int k = 0; k < v->path_count && same; k++) {
    const mesh_path *p = &v->paths[k];
    const size_t numbers = 2 * (size_t)p->most;
    const double *now = p->points + numbers * (size_t)frame;
    same = mesh_path_count(p, frame) == mesh_path_count(p, frame - 1) &&
           memcmp(now, now - numbers, 2 * (size_t)mesh_path_count(p, frame) * sizeof *now) == 0;
  }
  return same;
}

static bool are_same(const mesh_cells *a, const mesh_cells *b) {
  return a->count == b->count && a->corner_count == b->corner_count &&
         memcmp(a->nodes, b->nodes, (size_t)a->count) == 0 &&
         memcmp(a->corners, b->corners, (size_t)a->corner_count * sizeof *a->corners) == 0;
}

static void add_set(mesh_views *v, mesh_cells shown) {
  if (v->set_count > 0 && are_same(&shown, &v->sets[v->set_count - 1])) {
    cells_free(&shown);
    return;
  }
  v->sets = must_realloc(v->sets, ((size_t)v->set_count + 1) * sizeof *v->sets);
  v->sets[v->set_count++] = shown;
}

void mesh_views_find(mesh_views *v, const result_header *h, long frames) {
  v->set_of_frame = must_calloc((size_t)frames + 1, sizeof *v->set_of_frame);
  if (h->mesh_count == 0) return;
  if (frames == 0) add_set(v, cells_of(v, h, 0, true));
  for (long k = 0; k < frames; k++) {
    if (!is_unchanged(v, k)) add_set(v, cells_of(v, h, k, false));
    v->set_of_frame[k] = v->set_count - 1;
  }
}

/* --- writing ---------------------------------------------------------------------------------- */

/* Of a data set or a group. */
static bool describe(hid_t file, const char *name, const char *words, const char *unit_text) {
  const hid_t object = H5Oopen(file, name, H5P_DEFAULT);
  const bool good = object >= 0 && h5_attribute_text(object, "long_name", words) &&
                    (!unit_text || h5_attribute_text(object, "units", unit_text));
  if (object >= 0) H5Oclose(object);
  return good;
}

static bool tell_of_mesh(hid_t file, const char *name, const result_mesh *m) {
  const hid_t group = H5Oopen(file, name, H5P_DEFAULT);
  const bool good = group >= 0 &&
                    h5_attribute_integer(group, "first_particle", m->first_particle) &&
                    h5_attribute_double(group, "thickness", m->thickness);
  if (group >= 0) H5Oclose(group);
  return good;
}

/* What nodes and cells are called in the file that they come from. */
static bool write_numbers(hid_t file, const char *group, const result_mesh *m) {
  char name[NAME + 16];
  const hsize_t nodes[1] = {(hsize_t)m->node_count}, cells[1] = {(hsize_t)m->cell_count};
  if (!m->node_numbers) return true;
  snprintf(name, sizeof name, "%s/node_numbers", group);
  if (!h5_write_list(file, name, m->node_numbers, 1, nodes) ||
      !describe(file, name, "numbers of the nodes in the mesh's file", "1"))
    return false;
  snprintf(name, sizeof name, "%s/cell_numbers", group);
  return h5_write_list(file, name, m->cell_numbers, 1, cells) &&
         describe(file, name, "numbers of the cells in the mesh's file", "1");
}

static bool write_mesh(hid_t file, const result_header *h, const result_mesh *m) {
  char group[NAME], name[NAME + 16];
  const hsize_t nodes[2] = {(hsize_t)m->node_count, 2},
                cells[2] = {(hsize_t)m->cell_count, (hsize_t)m->columns};
  snprintf(group, sizeof group, "/meshes/%s", m->name);
  if (!h5_make_group(file, group) || !tell_of_mesh(file, group, m)) return false;
  snprintf(name, sizeof name, "%s/nodes", group);
  bool good = h5_write_doubles(file, name, h->reference + 2 * m->first_particle, 2, nodes, "m") &&
              describe(file, name, "places of the nodes at the beginning", NULL);
  snprintf(name, sizeof name, "%s/cells", group);
  good =
      good && h5_write_integers(file, name, m->cells, 2, cells) &&
      describe(file, name,
               m->columns == 4 ? "nodes of each cell, counter-clockwise, numbered from 0"
                               : "nodes of each cell, corners counter-clockwise, then those of the "
                                 "sides, numbered from 0; -1 behind the last",
               "1");
  snprintf(name, sizeof name, "%s/method", group);
  return good && h5_write_integers(file, name, m->method, 1, cells) &&
         describe(file, name, "of each cell: 1 a finite element, 2 blended, 3 element-free", "1") &&
         write_numbers(file, group, m);
}

bool mesh_views_write_meshes(hid_t file, const result_header *h) {
  bool good = h->mesh_count == 0 || h5_make_group(file, "/meshes");
  for (int k = 0; good && k < h->mesh_count; k++)
    good = write_mesh(file, h, &h->meshes[k]);
  return good;
}

int mesh_path_name_length(const mesh_path *p) {
  return (int)(strrchr(p->field->name, '/') - p->field->name);
}

void mesh_views_set_name(int set, char *name, size_t size) {
  snprintf(name, size, "/xdmf/cells/%d", set);
}

void mesh_views_path_name(const mesh_path *p, long frame, char *name, size_t size) {
  snprintf(name, size, "/xdmf/cracks/%.*s/%ld", mesh_path_name_length(p), p->field->name, frame);
}

static bool show_path(hid_t file, const mesh_path *p, long frame) {
  char name[NAME], set[NAME];
  const hsize_t count = (hsize_t)mesh_path_count(p, frame), shape[2] = {count, 3};
  snprintf(set, sizeof set, "/cracks/%s", p->field->name);
  mesh_views_path_name(p, frame, name, sizeof name);
  const h5_block points = {.set = set, .start = {(hsize_t)frame}, .count = {1, count, 2}};
  return h5_make_view(file, name, 2, shape, &points, 1, false);
}

static bool show_paths(hid_t file, const mesh_path *p, long frames) {
  char name[NAME];
  snprintf(name, sizeof name, "/xdmf/cracks/%.*s", mesh_path_name_length(p), p->field->name);
  bool good = h5_make_group(file, "/xdmf/cracks") && h5_make_group(file, name);
  for (long k = 0; good && k < frames; k++)
    good = show_path(file, p, k);
  return good;
}

void mesh_views_nothing_name(long points, int columns, char *name, size_t size) {
  snprintf(name, size, "/xdmf/nothing/%d/%ld", columns, points);
}

static bool write_nothing(hid_t file, long points, int columns) {
  char name[NAME];
  const hsize_t shape[2] = {(hsize_t)points, (hsize_t)columns};
  mesh_views_nothing_name(points, columns, name, sizeof name);
  if (H5Lexists(file, name, H5P_DEFAULT) > 0) return true;
  double *values = must_calloc((size_t)(points * columns) + 1, sizeof *values);
  for (long k = 0; k < points && columns == 1; k++)
    values[k] = NAN;
  const bool good = h5_write_doubles(file, name, values, columns == 1 ? 1 : 2, shape, NULL);
  free(values);
  return good;
}

/* For the points that paths have in some frame. */
static bool write_nothings(hid_t file, const mesh_views *v, long frames) {
  bool good = v->path_count == 0 ||
              (h5_make_group(file, "/xdmf/nothing") && h5_make_group(file, "/xdmf/nothing/1") &&
               h5_make_group(file, "/xdmf/nothing/3"));
  for (int k = 0; k < v->path_count; k++)
    for (long n = 0; n < frames && good; n++) {
      const long points = mesh_path_count(&v->paths[k], n);
      good = write_nothing(file, points, 1) && write_nothing(file, points, 3) &&
             write_nothing(file, 1, 1);
    }
  return good;
}

/* Numbers of XDMF for kinds of cells. */
static int32_t kind_of(int nodes) {
  enum { TRIANGLE = 4, QUADRILATERAL = 5, QUADRATIC_TRIANGLE = 36 };
  return nodes == 3 ? TRIANGLE : nodes == 4 ? QUADRILATERAL : QUADRATIC_TRIANGLE;
}

static bool write_set(hid_t file, const char *name, const mesh_cells *c) {
  const hsize_t table[2] = {(hsize_t)c->count, (hsize_t)c->alike},
                row[1] = {(hsize_t)(c->count + c->corner_count)};
  if (c->alike || c->count == 0) return h5_write_integers(file, name, c->corners, 2, table);
  int32_t *all = must_alloc((size_t)row[0] * sizeof *all), *at = all;
  const int32_t *from = c->corners;
  for (long n = 0; n < c->count; from += c->nodes[n++]) {
    *at++ = kind_of(c->nodes[n]);
    memcpy(at, from, c->nodes[n] * sizeof *at);
    at += c->nodes[n];
  }
  const bool good = h5_write_integers(file, name, all, 1, row);
  free(all);
  return good;
}

/* --- values of cells -------------------------------------------------------------------------- */

void mesh_views_all_values_name(const result_field *f, char *name, size_t size) {
  snprintf(name, size, "/xdmf/cell_values/%s/all", f->name);
}

void mesh_views_values_name(const result_field *f, long frame, char *name, size_t size) {
  snprintf(name, size, "/xdmf/cell_values/%s/%ld", f->name, frame);
}

int64_t mesh_views_values_begin(const mesh_views *v, long frame) {
  int64_t sum = 0;
  for (long k = 0; k < frame; k++)
    sum += v->sets[v->set_of_frame[k]].count;
  return sum;
}

/* values[f->count]: what has been written of a frame. */
static bool read_frame(hid_t set, const result_field *f, long frame, double *values) {
  const hsize_t start[2] = {(hsize_t)frame, 0}, count[2] = {1, (hsize_t)f->count};
  const hid_t space = H5Dget_space(set), memory = H5Screate_simple(2, count, NULL);
  const bool good = H5Sselect_hyperslab(space, H5S_SELECT_SET, start, NULL, count, NULL) >= 0 &&
                    H5Dread(set, H5T_NATIVE_DOUBLE, memory, space, H5P_DEFAULT, values) >= 0;
  H5Sclose(memory);
  H5Sclose(space);
  return good;
}

/* all[...]: of each frame the cells that are shown. */
static bool take_shown(hid_t file, const mesh_views *v, const result_field *f, long frames,
                       double *all) {
  char name[NAME];
  snprintf(name, sizeof name, "/cells/%s", f->name);
  const hid_t set = H5Dopen2(file, name, H5P_DEFAULT);
  double *values = must_calloc((size_t)f->count + 1, sizeof *values);
  bool good = set >= 0;
  for (long k = 0; k < frames && good; k++) {
    const mesh_cells *shown = &v->sets[v->set_of_frame[k]];
    good = read_frame(set, f, k, values);
    for (long c = 0; c < shown->count; c++)
      *all++ = values[shown->numbers[c]];
  }
  free(values);
  if (set >= 0) H5Dclose(set);
  return good;
}

/* Whether all cells are shown in all frames, as they are where none dies: nothing is copied
   then. */
static bool are_all_shown(const mesh_views *v, const result_field *f, long frames) {
  for (long k = 0; k < frames; k++)
    if (v->sets[v->set_of_frame[k]].count != f->count) return false;
  return true;
}

static bool copy_values(hid_t file, const mesh_views *v, const result_field *f, long frames,
                        const char *name) {
  const hsize_t count[1] = {(hsize_t)mesh_views_values_begin(v, frames)};
  double *all = must_alloc(((size_t)count[0] + 1) * sizeof *all);
  const bool good =
      take_shown(file, v, f, frames, all) && h5_write_doubles(file, name, all, 1, count, f->unit);
  free(all);
  return good;
}

/* Frames of whole meshes one after the other. */
static bool view_values(hid_t file, const result_field *f, long frames, const char *name,
                        const char *own) {
  const hsize_t count = (hsize_t)f->count, sum[1] = {count * (hsize_t)frames};
  h5_block *at = must_calloc((size_t)frames + 1, sizeof *at);
  for (long k = 0; k < frames; k++)
    at[k] = (h5_block){.set = own,
                       .start = {(hsize_t)k},
                       .count = {1, count},
                       .first = (hsize_t)k * count,
                       .rows = count};
  const bool good = h5_make_view(file, name, 1, sum, at, (int)frames, false);
  free(at);
  return good;
}

static bool show_values(hid_t file, const mesh_views *v, const result_field *f, long frame,
                        const char *all, const char *own) {
  char name[NAME];
  const hsize_t count[1] = {(hsize_t)v->sets[v->set_of_frame[frame]].count};
  const h5_block whole = {.set = own, .start = {(hsize_t)frame}, .count = {1, count[0]}},
                 part = {.set = all,
                         .start = {(hsize_t)mesh_views_values_begin(v, frame)},
                         .count = {count[0], 1}};
  mesh_views_values_name(f, frame, name, sizeof name);
  return h5_make_view(file, name, 1, count, own ? &whole : &part, 1, false);
}

static bool write_values(hid_t file, const mesh_views *v, const result_field *f, long frames) {
  char group[NAME], all[NAME], own[NAME];
  const bool whole = are_all_shown(v, f, frames);
  snprintf(group, sizeof group, "/xdmf/cell_values/%s", f->name);
  snprintf(own, sizeof own, "/cells/%s", f->name);
  mesh_views_all_values_name(f, all, sizeof all);
  bool good =
      h5_make_group(file, "/xdmf/cell_values") && h5_make_group(file, group) &&
      (whole ? view_values(file, f, frames, all, own) : copy_values(file, v, f, frames, all));
  for (long k = 0; k < frames && good; k++)
    good = show_values(file, v, f, k, all, whole ? own : NULL);
  return good;
}

bool mesh_views_write(hid_t file, const result_header *h, const mesh_views *v, long frames) {
  char name[NAME];
  bool good = v->set_count == 0 || h5_make_group(file, "/xdmf/cells");
  for (int k = 0; good && k < v->set_count; k++) {
    mesh_views_set_name(k, name, sizeof name);
    good = write_set(file, name, &v->sets[k]);
  }
  for (int k = 0; good && k < v->path_count; k++)
    good = show_paths(file, &v->paths[k], frames);
  for (int k = 0; good && k < h->field_count && frames > 0; k++)
    if (result_field_of_cells(&h->fields[k])) good = write_values(file, v, &h->fields[k], frames);
  return good && write_nothings(file, v, frames);
}
