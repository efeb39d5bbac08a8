#include "runtime/plot/plot_mesh.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "dsl/base/arena.h"
#include "dsl/base/elementary.h"
#include "runtime/result/mesh_views.h"
#include "runtime/result/result_fields.h"
#include "runtime/result/result_find.h"
#include "runtime/result/result_read.h"
#include "runtime/result/result_sets.h"

enum { CORNERS = 4, MOST_NODES = 6, MOST_NEAR = 256 };

void plot_meshes_free(plot_meshes *m) {
  for (int k = 0; k < m->count; k++) {
    free(m->items[k].cells);
    free(m->items[k].first);
    free(m->items[k].number);
    crack_lines_close(&m->items[k].lines);
  }
  for (int k = 0; k < m->crack_count; k++)
    free(m->cracks[k].points);
  free(m->items);
  free(m->cracks);
  *m = (plot_meshes){.count = 0};
}

/* --- reading ---------------------------------------------------------------------------------- */

static bool names_particles(const int32_t *cells, long count, long particles) {
  for (long k = 0; k < CORNERS * count; k++)
    if (cells[k] < 0 || cells[k] >= particles) return false;
  return true;
}

/* Among cells of at most four nodes; -1 is none. */
static bool has_triangles(const plot_mesh *m) {
  for (long c = 0; c < m->cell_count; c++)
    if (m->cells[CORNERS * c + CORNERS - 1] < 0) return true;
  return false;
}

/* A mesh's first particle, by its attribute. */
static bool read_first(result_file *f, const char *group, int64_t *first) {
  const hid_t object = H5Oopen(f->file, group, H5P_DEFAULT);
  const hid_t a = object >= 0 && H5Aexists(object, "first_particle") > 0
                      ? H5Aopen(object, "first_particle", H5P_DEFAULT)
                      : -1;
  const bool good = a >= 0 && H5Aread(a, H5T_NATIVE_INT64, first) >= 0;
  if (a >= 0) H5Aclose(a);
  if (object >= 0) H5Oclose(object);
  return good;
}

/* Cells of a file as cells of four corners: how many, at `to`. */
static int split(const int32_t *cell, int columns, int32_t (*to)[CORNERS]) {
  static const int parts[4][CORNERS] = {{0, 3, 5, 5}, {3, 1, 4, 4}, {5, 4, 2, 2}, {3, 4, 5, 5}};
  int nodes = 0;
  while (nodes < columns && cell[nodes] >= 0)
    nodes++;
  if (nodes == MOST_NODES) {
    for (int k = 0; k < CORNERS * CORNERS; k++)
      to[k / CORNERS][k % CORNERS] = cell[parts[k / CORNERS][k % CORNERS]];
    return CORNERS;
  }
  for (int k = 0; k < CORNERS; k++)
    to[0][k] = k < nodes ? cell[k] : nodes > 0 ? cell[nodes - 1] : -1;
  return 1;
}

/* m: the root of the mean area. */
static double mean_size(const plot_mesh *m, const double *reference) {
  double sum = 0;
  for (long c = 0; c < m->cell_count; c++)
    for (int k = 0; k < CORNERS; k++) {
      const double *a = reference + 2 * m->cells[CORNERS * c + k],
                   *b = reference + 2 * m->cells[CORNERS * c + (k + 1) % CORNERS];
      sum += 0.5 * (a[0] * b[1] - b[0] * a[1]);
    }
  return m->cell_count > 0 ? sqrt(fabs(sum) / (double)m->cell_count) : 0;
}

static void number_cells(plot_mesh *m) {
  m->number = must_alloc(((size_t)m->cell_count + 1) * sizeof *m->number);
  for (long c = 0; c < m->cell_count; c++)
    m->number[c] = (int32_t)c;
}

/* Of a mesh of a file. */
static void take_lists(plot_mesh *m, int columns) {
  int32_t *given = m->cells;
  long count = 0;
  const size_t most = CORNERS * (size_t)m->cell_count + 1; /* parts */
  m->cells = must_calloc(CORNERS * most, sizeof *m->cells);
  m->first = must_alloc(most * sizeof *m->first);
  m->number = must_alloc(most * sizeof *m->number);
  for (long c = 0; c < m->cell_count; c++) {
    const int parts = split(given + columns * c, columns, (int32_t(*)[CORNERS])m->cells + count);
    for (int k = 0; k < parts; k++) {
      m->number[count] = (int32_t)c;
      m->first[count++] = k == 0 ? given[columns * c] : -1;
    }
  }
  m->cell_count = count;
  free(given);
}

/* Its cells as particles of the result. */
static bool read_mesh(plot_mesh *m, result_file *f, const char *name, const double *reference,
                      long particles) {
  char group[512], path[560];
  int columns;
  int64_t first = 0;
  snprintf(m->name, sizeof m->name, "%.79s", name);
  snprintf(group, sizeof group, "/meshes/%.400s", name);
  snprintf(path, sizeof path, "%s/cells", group);
  m->cells = result_read_table(f, path, true, 3, MOST_NODES, &m->cell_count, &columns);
  if (!m->cells || !read_first(f, group, &first) || first < 0 || first > particles) return false;
  const bool of_file = columns != CORNERS || has_triangles(m);
  m->listed = m->cell_count;
  m->first_particle = first;
  if (of_file)
    take_lists(m, columns);
  else
    number_cells(m);
  if (!names_particles(m->cells, m->cell_count, particles - (long)first)) return false;
  for (long k = 0; k < CORNERS * m->cell_count; k++)
    m->cells[k] += (int32_t)first;
  for (long k = 0; m->first && k < m->cell_count; k++)
    if (m->first[k] >= 0) m->first[k] += (int32_t)first;
  m->all_count = m->cell_count;
  if (of_file) {
    m->size = mean_size(m, reference);
  } else if (m->cell_count > 0) {
    const double *low = reference + 2 * m->cells[0], *high = reference + 2 * m->cells[2];
    m->size = sqrt(fabs((high[0] - low[0]) * (high[1] - low[1])));
  }
  return true;
}

static long points_of(const double *points, long most) {
  long count = 0;
  while (count < most && isfinite(points[2 * count]) && isfinite(points[2 * count + 1]))
    count++;
  return count;
}

static void read_mesh_name(result_file *f, const char *crack, char *name, size_t size) {
  char path[512];
  snprintf(path, sizeof path, "/cracks/%.400s/points", crack);
  const hid_t set = result_set_open(f, path);
  *name = 0;
  if (set < 0) return;
  h5_read_attribute_text(set, "mesh", name, size);
  H5Dclose(set);
}

/* The points of the first frame are among those of later ones, in their order. */
static void find_beginning(plot_crack *c, const double *began, long count) {
  c->first = 0;
  c->last = c->count - 1;
  for (long k = 0; k + count <= c->count; k++) {
    if (memcmp(c->points + 2 * k, began, 2 * (size_t)count * sizeof *began) != 0) continue;
    c->first = k;
    c->last = k + count - 1;
    return;
  }
}

static bool read_crack(plot_crack *c, result_file *f, const char *name, long frame, char *error,
                       size_t size) {
  long frames = 0, most = 0;
  double *all = result_read_path(f, name, &frames, &most, error, size);
  const long wanted = frame < 0 ? frames + frame : frame;
  snprintf(c->name, sizeof c->name, "%.79s", name);
  read_mesh_name(f, name, c->mesh, sizeof c->mesh);
  if (all && wanted >= 0 && wanted < frames) {
    c->points = must_calloc(2 * (size_t)most + 1, sizeof *c->points);
    memcpy(c->points, all + 2 * most * wanted, 2 * (size_t)most * sizeof *c->points);
    c->count = points_of(c->points, most);
    find_beginning(c, all, points_of(all, most));
  } else if (all)
    snprintf(error, size, "the crack `%s` has %ld frames, numbered from 0; there is no frame %ld",
             name, frames, frame);
  free(all);
  return c->points != NULL;
}

static bool read_cracks(plot_meshes *m, result_file *f, long frame, char *error, size_t size) {
  result_names names = result_list(f, "/cracks");
  bool good = true;
  m->cracks = must_calloc((size_t)names.count + 1, sizeof *m->cracks);
  for (int k = 0; k < names.count && good; k++)
    if (result_has_path(f, names.items[k]))
      good = read_crack(&m->cracks[m->crack_count++], f, names.items[k], frame, error, size);
  result_names_free(&names);
  return good;
}

/* Those of a mesh lie in it. */
static void give_lines(plot_meshes *m) {
  for (int n = 0; n < m->count; n++)
    for (int c = 0; c < m->crack_count; c++)
      for (long k = 1; k < m->cracks[c].count && !strcmp(m->cracks[c].mesh, m->items[n].name); k++)
        crack_lines_add(&m->items[n].lines, m->cracks[c].points + 2 * k - 2,
                        m->cracks[c].points + 2 * k);
}

long plot_meshes_cells(const plot_meshes *m) {
  long sum = 0;
  for (int k = 0; k < m->count; k++)
    sum += m->items[k].listed;
  return sum;
}

/* In the order of the meshes' first particles, not of their names. */
static void number_all(plot_meshes *m) {
  for (int k = 0; k < m->count; k++) {
    plot_mesh *of = &m->items[k];
    long before = 0;
    for (int n = 0; n < m->count; n++)
      if (m->items[n].first_particle < of->first_particle) before += m->items[n].listed;
    for (long c = 0; c < of->all_count; c++)
      of->number[c] += (int32_t)before;
  }
}

double *plot_meshes_show_dead(plot_meshes *m) {
  double *dead = must_calloc((size_t)plot_meshes_cells(m) + 1, sizeof *dead);
  for (int k = 0; k < m->count; k++) {
    plot_mesh *of = &m->items[k];
    for (long c = of->cell_count; c < of->all_count; c++)
      dead[of->number[c]] = 1;
    of->cell_count = of->all_count;
  }
  return dead;
}

/* Cells that have died stand behind those that are left. */
static void bury(plot_mesh *m, const double *dead, long particles) {
  unsigned char *begun = must_calloc((size_t)particles + 1, 1);
  int32_t *gone = must_calloc((CORNERS + 1) * (size_t)m->cell_count + 1, sizeof *gone),
          *gone_number = gone + CORNERS * m->cell_count;
  long left = 0, died = 0;
  bool dies = false;
  for (long c = 0; c < m->cell_count; c++) {
    const int32_t *cell = m->cells + CORNERS * c, first = m->first ? m->first[c] : cell[0];
    if (first >= 0) dies = mesh_cell_died(dead[first], begun[first]++);
    *(dies ? &gone_number[died] : &m->number[left]) = m->number[c];
    int32_t *to = dies ? gone + CORNERS * died++ : m->cells + CORNERS * left++;
    memmove(to, cell, CORNERS * sizeof *cell);
  }
  memcpy(m->cells + CORNERS * left, gone, CORNERS * (size_t)died * sizeof *gone);
  memcpy(m->number + left, gone_number, (size_t)died * sizeof *gone_number);
  m->cell_count = left;
  free(begun);
  free(gone);
}

static void bury_all(plot_meshes *m, result_file *f, long frame, long particles) {
  char unit[64], error[512];
  long count = 0;
  int components = 0;
  double *dead = result_read_frame(f, MESH_DEAD_CELLS, frame, &count, &components, unit,
                                   sizeof unit, error, sizeof error);
  for (int k = 0; k < m->count && dead && count == particles; k++)
    bury(&m->items[k], dead, particles);
  free(dead);
}

bool plot_meshes_read(plot_meshes *m, result_file *f, long frame, char *error, size_t size) {
  *m = (plot_meshes){.count = 0};
  result_names names = result_list(f, "/meshes");
  long particles = 0;
  int dimensions = 0;
  double *reference = names.count ? result_read_reference(f, &particles, &dimensions) : NULL;
  bool good = names.count == 0 || (reference && dimensions == 2);
  m->items = must_calloc((size_t)names.count + 1, sizeof *m->items);
  for (int k = 0; k < names.count && good; k++)
    good = read_mesh(&m->items[m->count++], f, names.items[k], reference, particles);
  if (!good) snprintf(error, size, "`/meshes` of `%s` is damaged", f->path);
  good = good && (names.count == 0 || read_cracks(m, f, frame, error, size));
  if (good) number_all(m);
  if (good) give_lines(m);
  if (good && m->count > 0) bury_all(m, f, frame, particles);
  result_names_free(&names);
  free(reference);
  return good;
}

/* --- parts of cells --------------------------------------------------------------------------- */

typedef struct cell_view { /* a cell at the beginning, and the cracks that come near it */
  const mesh_view *of;
  const int32_t *corner;
  double value;             /* where cells have one */
  const double *low, *high; /* m */
  const crack_lines *lines;
  int near[MOST_NEAR], near_count;
} cell_view;

static cell_view view_of(const plot_mesh *m, const mesh_view *v, long cell) {
  const int32_t *corner = m->cells + CORNERS * cell;
  cell_view c = {.of = v,
                 .corner = corner,
                 .value = v->of_cells ? v->of_cells[m->number[cell]] : 0,
                 .low = v->reference + 2 * corner[0],
                 .high = v->reference + 2 * corner[2],
                 .lines = &m->lines};
  c.near_count = crack_lines_near(&m->lines, c.low, c.high, c.near, MOST_NEAR);
  if (c.near_count > MOST_NEAR) c.near_count = MOST_NEAR;
  return c;
}

/* Corners that a point sees past the cracks; all, where it sees none. */
static unsigned seen_from(const cell_view *c, const double at[2]) {
  unsigned seen = 0;
  for (int k = 0; k < CORNERS; k++) {
    bool hidden = false;
    for (int n = 0; n < c->near_count && !hidden; n++)
      hidden =
          crack_piece_hides(&c->lines->pieces[c->near[n]], at, c->of->reference + 2 * c->corner[k]);
    seen |= hidden ? 0 : 1u << k;
  }
  return seen ? seen : 15u;
}

/* Shares of the corners at the place (x, y) of the cell, 0 to 1: bilinear among those that are
   seen. */
static void shares_at(unsigned seen, double x, double y, double share[CORNERS]) {
  const double all[CORNERS] = {(1 - x) * (1 - y), x * (1 - y), x * y, (1 - x) * y};
  double sum = 0;
  int count = 0;
  for (int k = 0; k < CORNERS; k++) {
    share[k] = seen >> k & 1u ? all[k] : 0;
    sum += share[k];
    count += (int)(seen >> k & 1u);
  }
  for (int k = 0; k < CORNERS; k++)
    share[k] = sum > 1e-9 ? share[k] / sum : seen >> k & 1u ? 1.0 / count : 0;
}

/* Of a table with `columns` values for each particle. */
static double mixed(const cell_view *c, const double *table, int columns, int column,
                    const double share[CORNERS]) {
  double sum = 0;
  for (int k = 0; k < CORNERS; k++)
    if (share[k] > 0) sum += share[k] * table[columns * c->corner[k] + column];
  return sum;
}

/* Where a point of the cell was at the beginning, m. */
static void place_point(const cell_view *c, double x, double y, double at[2]) {
  double share[CORNERS];
  shares_at(15u, x, y, share);
  for (int a = 0; a < 2; a++)
    at[a] = mixed(c, c->of->reference, 2, a, share);
}

/* A point of the cell where it has moved to: it goes as what it sees does. */
static void move_point(const cell_view *c, const double share[CORNERS], double x, double y,
                       double moved[2]) {
  double at[2];
  place_point(c, x, y, at);
  for (int a = 0; a < 2; a++)
    moved[a] =
        at[a] + mixed(c, c->of->moved, 2, a, share) - mixed(c, c->of->reference, 2, a, share);
}

static void take_part(const cell_view *c, double x, double y, double size, mesh_part *take,
                      void *context) {
  static const double around[CORNERS][2] = {{0, 0}, {1, 0}, {1, 1}, {0, 1}};
  double middle[2], at[CORNERS][2], value[CORNERS] = {0};
  place_point(c, x + 0.5 * size, y + 0.5 * size, middle);
  const unsigned seen = seen_from(c, middle);
  for (int k = 0; k < CORNERS; k++) {
    const double u = x + size * around[k][0], v = y + size * around[k][1];
    double share[CORNERS];
    shares_at(seen, u, v, share);
    move_point(c, share, u, v, at[k]);
    if (c->of->of_cells)
      value[k] = c->value;
    else if (c->of->values)
      value[k] = mixed(c, c->of->values, 1, 0, share);
  }
  take(context, (const double(*)[2])at, value);
}

void plot_mesh_parts(const plot_mesh *m, const mesh_view *v, int whole, int cut, mesh_part *take,
                     void *context) {
  for (long cell = 0; cell < m->cell_count; cell++) {
    const cell_view c = view_of(m, v, cell);
    const int parts = c.near_count ? cut : whole;
    for (int j = 0; j < parts; j++)
      for (int i = 0; i < parts; i++)
        take_part(&c, (double)i / parts, (double)j / parts, 1.0 / parts, take, context);
  }
}

static bool holds(const mesh_view *v, const int32_t *corner, const double at[2]) {
  const double *low = v->reference + 2 * corner[0], *high = v->reference + 2 * corner[2];
  return at[0] >= low[0] && at[0] <= high[0] && at[1] >= low[1] && at[1] <= high[1];
}

void plot_mesh_face(const plot_mesh *m, const mesh_view *v, const double at[2],
                    const double side[2], double moved[2]) {
  const double beside[2] = {at[0] + side[0], at[1] + side[1]};
  memcpy(moved, at, 2 * sizeof *moved);
  for (int pass = 0; pass < 2; pass++) /* a face along the edge has no cell on its other side */
    for (long cell = 0; cell < m->cell_count; cell++) {
      const double *look = pass ? at : beside;
      if (!holds(v, m->cells + CORNERS * cell, look)) continue;
      const cell_view c = view_of(m, v, cell);
      double share[CORNERS];
      const double x = (at[0] - c.low[0]) / (c.high[0] - c.low[0]),
                   y = (at[1] - c.low[1]) / (c.high[1] - c.low[1]);
      shares_at(seen_from(&c, beside), x, y, share);
      move_point(&c, share, x, y, moved);
      return;
    }
}

void plot_mesh_crack_face(const plot_mesh *m, const mesh_view *v, const plot_crack *k, long from,
                          long to, double side, crack_point *take, void *context) {
  for (long n = from; n < to; n++) {
    const double *a = k->points + 2 * n, *b = a + 2;
    const double way[2] = {b[0] - a[0], b[1] - a[1]}, length = pl_hypot(way[0], way[1]);
    const int parts = (int)pl_fmin(pl_fmax(ceil(4 * length / m->size), 1), 2000);
    const double off = 1e-3 * m->size / pl_fmax(length, 1e-300);
    for (int q = n == from ? 0 : 1; q <= parts; q++) {
      const double u = (double)q / parts, point[2] = {a[0] + u * way[0], a[1] + u * way[1]},
                   beside[2] = {-side * off * way[1], side * off * way[0]};
      double moved[2];
      plot_mesh_face(m, v, point, beside, moved);
      take(context, moved);
    }
  }
}

bool plot_mesh_is_cut(const plot_mesh *m, const mesh_view *v, long cell) {
  return view_of(m, v, cell).near_count > 0;
}

/* --- outline ---------------------------------------------------------------------------------- */

typedef struct cell_side {
  int32_t a, b; /* ascending */
  int32_t from, to;
} cell_side;

static int compare_sides(const void *p, const void *q) {
  const cell_side *s = p, *t = q;
  if (s->a != t->a) return s->a < t->a ? -1 : 1;
  return (s->b > t->b) - (s->b < t->b);
}

int32_t *plot_mesh_outline(const plot_mesh *m, long *count) {
  const long all = CORNERS * m->cell_count;
  cell_side *sides = must_calloc((size_t)all + 1, sizeof *sides);
  int32_t *outline = must_calloc(2 * (size_t)all + 1, sizeof *outline);
  long there = 0;
  for (long k = 0; k < all; k++) {
    const int32_t i = m->cells[k],
                  j = m->cells[k / CORNERS * CORNERS + (k % CORNERS + 1) % CORNERS];
    if (i == j) continue; /* of a triangle */
    sides[there++] = (cell_side){i < j ? i : j, i < j ? j : i, i, j};
  }
  qsort(sides, (size_t)there, sizeof *sides, compare_sides);
  *count = 0;
  for (long k = 0; k < there;) {
    long next = k + 1;
    while (next < there && compare_sides(&sides[k], &sides[next]) == 0)
      next++;
    if (next == k + 1) {
      outline[2 * *count] = sides[k].from;
      outline[2 * (*count)++ + 1] = sides[k].to;
    }
    k = next;
  }
  free(sides);
  return outline;
}
