#include "runtime/geometry/cell.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "dsl/base/arena.h"
#include "dsl/base/elementary.h"

/* --- storage ---------------------------------------------------------------------------------- */

static int more_than(int room, int needed) {
  const int twice = 2 * room;
  return needed > twice ? needed : twice;
}

static void make_room(cell_part *p, int points, int faces, int corners) {
  if (points > p->point_room) {
    p->point_room = more_than(p->point_room, points);
    p->point = must_realloc(p->point, (size_t)p->point_room * sizeof *p->point);
  }
  if (faces > p->face_room) {
    p->face_room = more_than(p->face_room, faces);
    p->face = must_realloc(p->face, ((size_t)p->face_room + 1) * sizeof *p->face);
  }
  if (corners > p->corner_room) {
    p->corner_room = more_than(p->corner_room, corners);
    p->corner = must_realloc(p->corner, (size_t)p->corner_room * sizeof *p->corner);
  }
}

static void part_end(cell_part *p) {
  free(p->point);
  free(p->face);
  free(p->corner);
}

void cell_begin(cell *c, int dimensions) {
  *c = (cell){.dimensions = dimensions};
  make_room(&c->now, 64, 32, 256);
  make_room(&c->next, 64, 32, 256);
}

void cell_end(cell *c) {
  part_end(&c->now);
  part_end(&c->next);
  free(c->height);
  free(c->kept);
  free(c->edge);
  free(c->follower);
}

static void swap_parts(cell *c) {
  const cell_part old = c->now;
  c->now = c->next;
  c->next = old;
}

static void find_reach(cell *c) {
  double square = 0;
  for (int k = 0; k < c->now.point_count; k++) {
    const double *p = c->now.point[k];
    square = pl_fmax(square, p[0] * p[0] + p[1] * p[1] + p[2] * p[2]);
  }
  c->reach = sqrt(square);
}

/* --- boxes ------------------------------------------------------------------------------------ */

static void set_rectangle(cell_part *p, const double lower[3], const double upper[3]) {
  const double points[4][3] = {{lower[0], lower[1], 0},
                               {upper[0], lower[1], 0},
                               {upper[0], upper[1], 0},
                               {lower[0], upper[1], 0}};
  memcpy(p->point, points, sizeof points);
  p->point_count = 4;
  p->face_count = p->corner_count = 0;
}

/* Corner k of the box has its upper coordinate c where bit c of k is set. */
static void set_cuboid(cell_part *p, const double lower[3], const double upper[3]) {
  static const int corners[24] = {0, 4, 6, 2, 1, 3, 7, 5, 0, 1, 5, 4,
                                  2, 6, 7, 3, 0, 2, 3, 1, 4, 5, 7, 6};
  for (int k = 0; k < 8; k++)
    for (int c = 0; c < 3; c++)
      p->point[k][c] = k >> c & 1 ? upper[c] : lower[c];
  memcpy(p->corner, corners, sizeof corners);
  for (int f = 0; f <= 6; f++)
    p->face[f] = 4 * f;
  p->point_count = 8;
  p->face_count = 6;
  p->corner_count = 24;
}

void cell_set_box(cell *c, const double lower[3], const double upper[3]) {
  if (c->dimensions == 2)
    set_rectangle(&c->now, lower, upper);
  else
    set_cuboid(&c->now, lower, upper);
  find_reach(c);
}

/* --- cuts ------------------------------------------------------------------------------------- */

static bool find_heights(cell *c, const double n[3], double level) {
  bool any = false;
  if (c->now.point_count > c->room) {
    c->room = more_than(c->room, c->now.point_count);
    c->height = must_realloc(c->height, (size_t)c->room * sizeof *c->height);
    c->kept = must_realloc(c->kept, (size_t)c->room * sizeof *c->kept);
  }
  for (int k = 0; k < c->now.point_count; k++) {
    const double *p = c->now.point[k];
    c->height[k] = p[0] * n[0] + p[1] * n[1] + p[2] * n[2] - level;
    any |= c->height[k] > 0;
  }
  return any;
}

static bool is_out(const cell *c, int k) {
  return c->height[k] > 0;
}

/* Always reckoned from the point that stays, so that both faces of an edge find the same bits. */
static void cross_edge(const cell *c, int in, int out, double at[3]) {
  const double u = c->height[in] / (c->height[in] - c->height[out]);
  for (int d = 0; d < 3; d++)
    at[d] = c->now.point[in][d] + u * (c->now.point[out][d] - c->now.point[in][d]);
}

static void cut_polygon(cell *c) {
  const int count = c->now.point_count;
  make_room(&c->next, 2 * count, 0, 0);
  int made = 0;
  for (int a = 0; a < count; a++) {
    const int b = a + 1 < count ? a + 1 : 0;
    if (!is_out(c, a)) memcpy(c->next.point[made++], c->now.point[a], sizeof *c->now.point);
    if (is_out(c, a) == is_out(c, b)) continue;
    cross_edge(c, is_out(c, a) ? b : a, is_out(c, a) ? a : b, c->next.point[made++]);
  }
  c->next.point_count = made;
  c->next.face_count = c->next.corner_count = 0;
}

static void keep_points(cell *c) {
  int made = 0;
  make_room(&c->next, c->now.point_count, 0, 0);
  for (int k = 0; k < c->now.point_count; k++) {
    c->kept[k] = made;
    if (!is_out(c, k)) memcpy(c->next.point[made++], c->now.point[k], sizeof *c->now.point);
  }
  c->next.point_count = made;
  c->edge_count = 0;
}

/* Number, among those on the cut, of the point where an edge is cut; both faces of the edge ask for
   it. */
static int cut_point(cell *c, int in, int out) {
  for (int k = 0; k < c->edge_count; k++)
    if (c->edge[k][0] == in && c->edge[k][1] == out) return k;
  if (c->edge_count == c->edge_room) {
    c->edge_room = more_than(c->edge_room, 32);
    c->edge = must_realloc(c->edge, (size_t)c->edge_room * sizeof *c->edge);
    c->follower = must_realloc(c->follower, (size_t)c->edge_room * sizeof *c->follower);
  }
  const int k = c->edge_count++, point = c->next.point_count++;
  make_room(&c->next, c->next.point_count, 0, 0);
  cross_edge(c, in, out, c->next.point[point]);
  c->edge[k][0] = in;
  c->edge[k][1] = out;
  c->follower[k] = -1;
  return k;
}

static void add_corner(cell_part *p, int point) {
  make_room(p, 0, 0, p->corner_count + 1);
  p->corner[p->corner_count++] = point;
}

static void close_face(cell_part *p) {
  if (p->corner_count == p->face[p->face_count]) return;
  make_room(p, 0, p->face_count + 1, 0);
  p->face[++p->face_count] = p->corner_count;
}

/* What is left of a face runs along the cut from where it leaves to where it comes back; the new
   face, the other way. */
static void cut_face(cell *c, int face, int first_new) {
  const int *corner = c->now.corner + c->now.face[face];
  const int count = c->now.face[face + 1] - c->now.face[face];
  int left = -1, pending = -1;
  for (int k = 0; k < count; k++) {
    const int a = corner[k], b = corner[k + 1 < count ? k + 1 : 0];
    if (!is_out(c, a)) add_corner(&c->next, c->kept[a]);
    if (is_out(c, a) == is_out(c, b)) continue;
    const int at = is_out(c, a) ? cut_point(c, b, a) : cut_point(c, a, b);
    add_corner(&c->next, first_new + at);
    if (is_out(c, b))
      left = at;
    else if (left >= 0)
      c->follower[at] = left, left = -1;
    else
      pending = at;
  }
  if (pending >= 0) c->follower[pending] = left;
  close_face(&c->next);
}

static void add_cut_face(cell *c, int first_new) {
  for (int k = 0; k < c->edge_count; k++) {
    for (int at = k; c->follower[at] >= 0;) {
      const int then = c->follower[at];
      add_corner(&c->next, first_new + at);
      c->follower[at] = -1;
      at = then;
    }
    close_face(&c->next);
  }
}

static void cut_polyhedron(cell *c) {
  keep_points(c);
  const int first_new = c->next.point_count;
  c->next.face_count = c->next.corner_count = c->next.face[0] = 0;
  for (int f = 0; f < c->now.face_count; f++)
    cut_face(c, f, first_new);
  add_cut_face(c, first_new);
}

bool cell_cut(cell *c, const double normal[3], double level) {
  if (!find_heights(c, normal, level)) return false;
  if (c->dimensions == 2)
    cut_polygon(c);
  else
    cut_polyhedron(c);
  swap_parts(c);
  find_reach(c);
  return true;
}

/* --- measures --------------------------------------------------------------------------------- */

static void add_triangle(cell_moments *m, const double *a, const double *b) {
  const double area = 0.5 * (a[0] * b[1] - a[1] * b[0]);
  m->size += area;
  for (int c = 0; c < 2; c++)
    m->first[c] += area * (a[c] + b[c]) / 3;
}

static void add_tetrahedron(cell_moments *m, const double *p, const double *q, const double *r) {
  const double volume = (p[0] * (q[1] * r[2] - q[2] * r[1]) + p[1] * (q[2] * r[0] - q[0] * r[2]) +
                         p[2] * (q[0] * r[1] - q[1] * r[0])) /
                        6;
  m->size += volume;
  for (int c = 0; c < 3; c++)
    m->first[c] += volume * (p[c] + q[c] + r[c]) / 4;
}

cell_moments cell_measure(const cell *c) {
  const cell_part *p = &c->now;
  cell_moments m = {0};
  for (int k = 0; c->dimensions == 2 && k < p->point_count; k++)
    add_triangle(&m, p->point[k], p->point[k + 1 < p->point_count ? k + 1 : 0]);
  for (int f = 0; f < p->face_count; f++) {
    const double *first = p->point[p->corner[p->face[f]]];
    for (int k = p->face[f] + 1; k + 1 < p->face[f + 1]; k++)
      add_tetrahedron(&m, first, p->point[p->corner[k]], p->point[p->corner[k + 1]]);
  }
  return m;
}

void cell_extent(const cell *c, double lower[3], double upper[3]) {
  for (int d = 0; d < 3; d++) {
    lower[d] = INFINITY;
    upper[d] = -INFINITY;
    for (int k = 0; k < c->now.point_count; k++) {
      lower[d] = pl_fmin(lower[d], c->now.point[k][d]);
      upper[d] = pl_fmax(upper[d], c->now.point[k][d]);
    }
  }
}
