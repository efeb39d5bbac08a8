#include "runtime/mesh/cell_strips.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "dsl/base/arena.h"
#include "dsl/base/elementary.h"
#include "runtime/base/lane_sum.h"
#include "runtime/kernel.h"
#include "runtime/mesh/shape_functions.h"

/* --- tables ----------------------------------------------------------------------------------- */

/* Nodes around the lower left corner of a cell that may act in it. */
enum { REACH = 7, WIDE = 2 * REACH + 2, SLOTS = WIDE * WIDE };

typedef struct draft { /* of a group: what acts at [point][slot] */
  int points;
  unsigned char *acts; /* [points][SLOTS] */
  double *slope;       /* [points][SLOTS][2][PL_LANES] */
  double least;        /* 1/m: slopes that differ by less are the same */
} draft;

static int points_of(const integration_points *p, int cell) {
  return p->first[cell + 1] - p->first[cell];
}

/* With room for every cell: those that holes cut have many more points than others. */
static draft draft_new(const mesh *m, const integration_points *p) {
  size_t most = 1;
  for (int c = 0; c < mesh_cell_count(m); c++)
    if ((size_t)points_of(p, c) > most) most = (size_t)points_of(p, c);
  return (draft){.acts = must_calloc(most * SLOTS, 1),
                 .slope = must_calloc(most * SLOTS * 2 * PL_LANES, sizeof(double)),
                 .least = 1e-11 / pl_min(m->spacing[0], m->spacing[1])};
}

static void draft_free(draft *d) {
  free(d->acts);
  free(d->slope);
}

static void draft_clear(draft *d, int points) {
  d->points = points;
  memset(d->acts, 0, (size_t)points * SLOTS);
  memset(d->slope, 0, (size_t)points * SLOTS * 2 * PL_LANES * sizeof *d->slope);
}

static void draft_cell(draft *d, const mesh *m, const integration_points *p, int i, int j,
                       int lane) {
  const int cell = mesh_cell_at(m, i, j);
  point_shape shape;
  for (int g = 0; g < d->points; g++) {
    shape_functions(m, cell, p->at[p->first[cell] + g], &shape);
    for (int k = 0; k < shape.count; k++) {
      const int di = shape.node[k] % m->nodes[0] - i, dj = shape.node[k] / m->nodes[0] - j;
      const int slot = g * SLOTS + (dj + REACH) * WIDE + di + REACH;
      d->acts[slot] = 1;
      d->slope[(2 * slot) * PL_LANES + lane] = shape.nx[k];
      d->slope[(2 * slot + 1) * PL_LANES + lane] = shape.ny[k];
    }
  }
}

static bool is_uniform(const draft *d, int lanes) {
  const double *slope = d->slope;
  for (int k = 0; k < 2 * d->points * SLOTS; k++, slope += PL_LANES)
    for (int lane = 1; lane < lanes && d->acts[k / 2]; lane++)
      if (!(fabs(slope[lane] - slope[0]) <= d->least)) return false;
  return true;
}

static void count_slots(const draft *d, cell_table *t, int *node_of) {
  t->nodes = t->entries = 0;
  for (int slot = 0; slot < SLOTS; slot++) {
    int here = 0;
    for (int g = 0; g < d->points; g++)
      here += d->acts[g * SLOTS + slot];
    node_of[slot] = here > 0 ? t->nodes++ : -1;
    t->entries += here;
  }
}

static void allot(cell_table *t) {
  const size_t entries = (size_t)t->entries;
  t->offset = must_calloc((size_t)t->nodes + 1, sizeof(int));
  t->first = must_calloc((size_t)t->points + 1, sizeof(int));
  t->first_of_node = must_calloc((size_t)t->nodes + 1, sizeof(int));
  t->away = must_calloc(entries + 1, sizeof(int));
  t->entry = must_calloc(entries + 1, sizeof(int));
  t->point = must_calloc(entries + 1, sizeof(int));
  t->slope = must_calloc(entries * 2 * (size_t)t->lanes + 1, sizeof(double));
}

static void take_entry(const draft *d, cell_table *t, int e, int at) {
  for (int a = 0; a < 2; a++)
    for (int lane = 0; lane < t->lanes; lane++)
      t->slope[(2 * e + a) * t->lanes + lane] = d->slope[(2 * at + a) * PL_LANES + lane];
}

/* Entries stand point by point; `number` keeps which one is which. */
static cell_table *table_of(const draft *d, int lanes, long stride) {
  cell_table *t = must_calloc(1, sizeof *t);
  int node_of[SLOTS], *number = must_calloc((size_t)d->points * SLOTS, sizeof *number), e = 0;
  *t = (cell_table){.points = d->points, .lanes = lanes};
  count_slots(d, t, node_of);
  allot(t);
  for (int g = 0; g < d->points; g++) {
    t->first[g] = e;
    for (int slot = 0; slot < SLOTS; slot++) {
      if (!d->acts[g * SLOTS + slot]) continue;
      t->away[e] = (slot / WIDE - REACH) * (int)stride + slot % WIDE - REACH;
      take_entry(d, t, e, g * SLOTS + slot);
      number[g * SLOTS + slot] = e++;
    }
  }
  t->first[d->points] = e;
  e = 0;
  for (int slot = 0; slot < SLOTS; slot++) {
    if (node_of[slot] < 0) continue;
    t->offset[node_of[slot]] = (slot / WIDE - REACH) * (int)stride + slot % WIDE - REACH;
    t->first_of_node[node_of[slot]] = e;
    for (int g = 0; g < d->points; g++)
      if (d->acts[g * SLOTS + slot]) {
        t->entry[e] = number[g * SLOTS + slot];
        t->point[e++] = g;
      }
  }
  t->first_of_node[t->nodes] = e;
  free(number);
  return t;
}

/* Entries stand point by point and node row by node row, as in a rectangle. */
static void find_rectangle(cell_table *t, double least) {
  if (t->lanes == 1 && t->points == 4 && t->nodes == 4 && t->entries == 16)
    t->rectangle =
        rectangle_slopes_find(&t->slopes, (const double(*)[4][2])(const void *)t->slope, least);
}

static void table_free(cell_table *t) {
  free(t->offset);
  free(t->first);
  free(t->first_of_node);
  free(t->away);
  free(t->entry);
  free(t->point);
  free(t->slope);
  free(t);
}

static bool are_alike(const cell_table *a, const cell_table *b, double least) {
  if (a->points != b->points || a->lanes != b->lanes || a->nodes != b->nodes ||
      a->entries != b->entries ||
      memcmp(a->first, b->first, (size_t)a->points * sizeof *a->first) != 0 ||
      memcmp(a->away, b->away, (size_t)a->entries * sizeof *a->away) != 0)
    return false;
  for (int k = 0; k < 2 * a->entries * a->lanes; k++)
    if (!(fabs(a->slope[k] - b->slope[k]) <= least)) return false;
  return true;
}

static long bytes_of(const cell_table *t) {
  return (long)sizeof *t + (long)sizeof(int) * (2 * t->nodes + t->points + 3 * t->entries) +
         (long)sizeof(double) * 2 * t->entries * t->lanes;
}

/* One like it that is there already, or it. */
static const cell_table *keep(cell_strips *s, cell_table *t, double least) {
  for (int k = s->table_count - 1; k >= 0; k--)
    if (are_alike(s->tables[k], t, least)) {
      table_free(t);
      return s->tables[k];
    }
  if (s->table_count == s->table_room) {
    s->table_room = s->table_room ? 2 * s->table_room : 64;
    s->tables = must_realloc(s->tables, (size_t)s->table_room * sizeof(cell_table *));
  }
  find_rectangle(t, least);
  s->bytes += bytes_of(t);
  return s->tables[s->table_count++] = t;
}

/* --- groups ----------------------------------------------------------------------------------- */

int cell_strips_cell(const cell_strips *s, const mesh *m, int row, const cell_group *g, int lane) {
  if (s->elements) return s->elements->groups[g->first].cell[lane];
  return mesh_cell_at(m, g->first + (lane < g->count ? lane : 0), row);
}

bool cell_strips_reach(const cell_strips *s, const mesh *m, const cell_group *g, int lane,
                       int node) {
  if (lane >= g->count) return false;
  if (!s->elements) {
    const int away = node % m->nodes[0] - g->first - lane;
    return away >= s->low && away <= s->high;
  }
  int in[ELEMENT_MOST_NODES], k = 0;
  const int count = mesh_cell_nodes(m, s->elements->groups[g->first].cell[lane], in);
  while (k < count && in[k] != node)
    k++;
  return k < count;
}

/* Where it stands among cells, and its volumes; memory has room for every cell. */
static void place_group(cell_strips *s, const mesh *m, const integration_points *p, int row,
                        cell_group *g) {
  g->at = s->count;
  s->count += g->points * PL_LANES;
  s->most = g->points * PL_LANES > s->most ? g->points * PL_LANES : s->most;
  for (int lane = 0; lane < g->count; lane++) {
    const int cell = cell_strips_cell(s, m, row, g, lane);
    s->of_cell[cell] = g->at + lane;
    for (int k = 0; k < g->points; k++)
      s->volume[g->at + k * PL_LANES + lane] = m->thickness * p->area[p->first[cell] + k];
  }
}

/* The volume of each of its points, where that is one. */
static double even_volume(const cell_strips *s, const cell_group *g) {
  const double *volume = s->volume + g->at;
  if (!g->table->rectangle) return 0;
  for (int k = 0; k < g->table->points; k++)
    for (int lane = 0; lane < g->count; lane++)
      if (volume[k * PL_LANES + lane] != volume[0]) return 0;
  return volume[0];
}

/* Points of a cell that is among those asked for. */
static int points_here(const integration_points *p, const unsigned char *own, int cell) {
  return own && !own[cell] ? 0 : points_of(p, cell);
}

static void add_group(cell_strips *s, const mesh *m, const integration_points *p,
                      const unsigned char *own, int row, int i, draft *d) {
  const int points = points_of(p, mesh_cell_at(m, i, row));
  cell_group *g = &s->groups[s->group_count++];
  *g = (cell_group){.first = i};
  draft_clear(d, points);
  while (g->count < PL_LANES && i + g->count < m->nodes[0] - 1 &&
         points_here(p, own, mesh_cell_at(m, i + g->count, row)) == points) {
    draft_cell(d, m, p, i + g->count, row, g->count);
    g->count++;
  }
  g->points = points;
  place_group(s, m, p, row, g);
  g->table =
      keep(s, table_of(d, is_uniform(d, g->count) ? 1 : PL_LANES, s->layout.stride), d->least);
  g->even = even_volume(s, g);
}

static void find_reach(cell_strips *s) {
  s->high = 1;
  for (int k = 0; k < s->table_count; k++)
    for (int n = 0; n < s->tables[k]->nodes; n++) {
      const int at = s->tables[k]->offset[n] + REACH * (int)s->layout.stride + REACH,
                dj = at / (int)s->layout.stride - REACH;
      s->low = dj < s->low ? dj : s->low;
      s->high = dj > s->high ? dj : s->high;
    }
}

/* Those of a mesh of lists. */
static void open_elements(cell_strips *s, const mesh *m, const integration_points *p,
                          const unsigned char *own) {
  element_strips *e = element_strips_new(m, p, own);
  *s = (cell_strips){
      .layout = e->layout, .rows = e->rows, .low = -e->rows, .high = e->rows, .elements = e};
  s->first_group = must_calloc((size_t)e->rows + 1, sizeof(int));
  s->first_point = must_calloc((size_t)e->rows + 1, sizeof(int));
  s->groups = must_calloc((size_t)e->group_count + 1, sizeof *s->groups);
  s->of_cell = must_alloc(((size_t)mesh_cell_count(m) + 1) * sizeof(int));
  long points = 0;
  for (int g = 0; g < e->group_count; g++)
    points += (long)e->groups[g].points * PL_LANES;
  s->volume = must_calloc((size_t)points + 1, sizeof(double));
  for (int c = 0; c < mesh_cell_count(m); c++)
    s->of_cell[c] = -1;
  for (int row = 0; row < e->rows; row++) {
    s->first_group[row] = s->group_count;
    s->first_point[row] = s->count;
    for (int g = e->first_group[row]; g < e->first_group[row + 1]; g++) {
      cell_group *to = &s->groups[s->group_count++];
      *to = (cell_group){.first = g, .count = e->groups[g].count, .points = e->groups[g].points};
      place_group(s, m, p, row, to);
    }
  }
  s->first_group[e->rows] = s->group_count;
  s->first_point[e->rows] = s->count;
  s->bytes = element_strips_bytes(e) + (long)sizeof(int) * (2 * e->rows + mesh_cell_count(m)) +
             (long)sizeof(double) * s->count + (long)sizeof(cell_group) * s->group_count;
}

void cell_strips_open(cell_strips *s, const mesh *m, const integration_points *p,
                      const unsigned char *own) {
  if (m->lists) {
    open_elements(s, m, p, own);
    return;
  }
  const int rows = m->nodes[1] - 1, wide = m->nodes[0] - 1;
  const size_t room = (size_t)(p->count + 1) * PL_LANES;
  draft d = draft_new(m, p);
  *s = (cell_strips){.layout = node_layout_of(m->nodes, m->support), .rows = rows};
  s->first_group = must_calloc((size_t)rows + 1, sizeof(int));
  s->first_point = must_calloc((size_t)rows + 1, sizeof(int));
  s->groups = must_calloc((size_t)(rows * wide) + 1, sizeof *s->groups);
  s->of_cell = must_calloc((size_t)(rows * wide) + 1, sizeof(int));
  s->volume = must_calloc(room, sizeof(double));
  for (int c = 0; c < rows * wide; c++)
    s->of_cell[c] = -1;
  for (int row = 0; row < rows; row++) {
    s->first_group[row] = s->group_count;
    s->first_point[row] = s->count;
    for (int i = 0; i < wide; i++) {
      if (points_here(p, own, mesh_cell_at(m, i, row)) == 0) continue;
      add_group(s, m, p, own, row, i, &d);
      i += s->groups[s->group_count - 1].count - 1;
    }
  }
  s->first_group[rows] = s->group_count;
  s->first_point[rows] = s->count;
  s->volume = must_realloc(s->volume, ((size_t)s->count + 1) * sizeof(double));
  s->groups = must_realloc(s->groups, ((size_t)s->group_count + 1) * sizeof *s->groups);
  s->bytes += (long)sizeof(int) * (2 * rows + rows * wide) + (long)sizeof(double) * s->count +
              (long)sizeof(cell_group) * s->group_count;
  find_reach(s);
  draft_free(&d);
}

void cell_strips_close(cell_strips *s) {
  element_strips_free(s->elements);
  for (int k = 0; k < s->table_count; k++)
    table_free(s->tables[k]);
  free(s->tables);
  free(s->first_group);
  free(s->first_point);
  free(s->groups);
  free(s->of_cell);
  free(s->volume);
}

void cell_strips_place(const cell_strips *s, const mesh *m, const integration_points *p, int row,
                       const cell_group *g, int at, double place[2], int cell[2]) {
  const int lane = (at - g->at) % PL_LANES, k = (at - g->at) / PL_LANES,
            number = cell_strips_cell(s, m, row, g, lane);
  cell[0] = s->elements ? number : g->first + lane;
  cell[1] = s->elements ? -1 : row;
  memcpy(place, p->at[p->first[number] + k], 2 * sizeof *place);
}

/* --- strains ---------------------------------------------------------------------------------- */

/* PL_LANES doubles side by side, wherever they stand. */
typedef double lanes_at
    __attribute__((vector_size(PL_LANES * sizeof(double)), aligned(sizeof(double)), may_alias));

/* Four sums of products, kept apart so that none waits for another: of the slopes x, y x a, y b,
   y c, x d. Products are rounded, so that all processors have the same bits. */
typedef struct lane_sums {
  lanes_at xa, yb, yc, xd;
} lane_sums;

static inline __attribute__((always_inline)) void add_products(lane_sums *s, int lanes,
                                                               const double *slope, const double *a,
                                                               const double *b, const double *c,
                                                               const double *d) {
  const lanes_at *at[] = {(const lanes_at *)a, (const lanes_at *)b, (const lanes_at *)c,
                          (const lanes_at *)d};
  if (lanes == 1) {
    s->xa += slope[0] * *at[0];
    s->yb += slope[1] * *at[1];
    s->yc += slope[1] * *at[2];
    s->xd += slope[0] * *at[3];
  } else {
    const lanes_at *x = (const lanes_at *)slope, *y = (const lanes_at *)(slope + PL_LANES);
    s->xa += *x * *at[0];
    s->yb += *y * *at[1];
    s->yc += *y * *at[2];
    s->xd += *x * *at[3];
  }
}

/* `lanes` is a literal: slopes of one lane count for all. */
static inline __attribute__((always_inline)) void strain_of_group(const cell_table *t, int lanes,
                                                                  const double *ux,
                                                                  const double *uy,
                                                                  double *const strain[3]) {
  const double *slope = t->slope;
  for (int g = 0; g < t->points; g++) {
    lane_sums s = {{0}, {0}, {0}, {0}};
    for (int e = t->first[g]; e < t->first[g + 1]; e++, slope += 2 * lanes) {
      const double *x = ux + t->away[e], *y = uy + t->away[e];
      add_products(&s, lanes, slope, x, y, x, y);
    }
    *(lanes_at *)(strain[0] + g * PL_LANES) = s.xa;
    *(lanes_at *)(strain[1] + g * PL_LANES) = s.yb;
    *(lanes_at *)(strain[2] + g * PL_LANES) = 0.5 * (s.yc + s.xd);
  }
}

void cell_strips_strain(const cell_strips *s, int row, const cell_group *g,
                        const double *const u[2], double *const strain[3]) {
  if (s->elements) {
    element_strips_strain(s->elements, g->first, u, strain);
    return;
  }
  const long at = s->layout.origin + row * s->layout.stride + g->first;
  if (g->table->rectangle)
    rectangle_cells_strain(&g->table->slopes, (const double *const[]){u[0] + at, u[1] + at},
                           s->layout.stride, strain);
  else if (g->table->lanes == 1)
    strain_of_group(g->table, 1, u[0] + at, u[1] + at, strain);
  else
    strain_of_group(g->table, PL_LANES, u[0] + at, u[1] + at, strain);
  for (int k = 0; k < g->table->points && g->count < PL_LANES; k++)
    for (int lane = g->count; lane < PL_LANES; lane++)
      for (int c = 0; c < 3; c++)
        strain[c][k * PL_LANES + lane] = 0;
}

/* --- forces ----------------------------------------------------------------------------------- */

static inline __attribute__((always_inline)) void push_group(const cell_table *t, int lanes,
                                                             const double *const traction[3],
                                                             double *fx, double *fy) {
  const double *xx = traction[0], *yy = traction[1], *xy = traction[2];
  for (int n = 0; n < t->nodes; n++) {
    lane_sums s = {{0}, {0}, {0}, {0}};
    for (int e = t->first_of_node[n]; e < t->first_of_node[n + 1]; e++) {
      const double *slope = t->slope + (long)t->entry[e] * 2 * lanes;
      const long at = (long)t->point[e] * PL_LANES;
      add_products(&s, lanes, slope, xx + at, yy + at, xy + at, xy + at);
    }
    *(lanes_at *)(fx + t->offset[n]) += s.xa + s.yc;
    *(lanes_at *)(fy + t->offset[n]) += s.yb + s.xd;
  }
}

/* Doubles that a row of cells has: rows of nodes from `row + low` on, from node 0. */
static long plane_of(const cell_strips *s) {
  return (s->high - s->low + 2) * s->layout.stride;
}

void cell_strips_push(const cell_strips *s, int row, const cell_group *g,
                      const double *const traction[3], double *const pushed[2]) {
  if (s->elements) {
    element_strips_push(s->elements, g->first, traction, pushed);
    return;
  }
  const long at = row * plane_of(s) - s->low * s->layout.stride + g->first;
  if (g->table->lanes == 1)
    push_group(g->table, 1, traction, pushed[0] + at, pushed[1] + at);
  else
    push_group(g->table, PL_LANES, traction, pushed[0] + at, pushed[1] + at);
}

bool cell_strips_single(const cell_strips *s, const cell_group *g) {
  return g->points == 1 && (!s->elements || s->elements->groups[g->first].nodes == 4);
}

void cell_strips_mode(const cell_strips *s, int row, const cell_group *g, const double *gamma,
                      const double *u, double mode[PL_LANES]) {
  if (s->elements) {
    element_strips_mode(s->elements, g->first, gamma, u, mode);
    return;
  }
  const long stride = s->layout.stride;
  const double *at = u + s->layout.origin + row * stride + g->first;
  for (int lane = 0; lane < PL_LANES; lane++)
    mode[lane] = gamma[lane] * at[lane] + gamma[PL_LANES + lane] * at[1 + lane] +
                 gamma[2 * PL_LANES + lane] * at[stride + lane] +
                 gamma[3 * PL_LANES + lane] * at[stride + 1 + lane];
}

void cell_strips_push_mode(const cell_strips *s, int row, const cell_group *g, const double *gamma,
                           const double by[PL_LANES], double *pushed) {
  if (s->elements) {
    element_strips_push_mode(s->elements, g->first, gamma, by, pushed);
    return;
  }
  double *force = pushed + row * plane_of(s) - s->low * s->layout.stride + g->first;
  for (int corner = 0; corner < 4; corner++) {
    double *to = force + corner / 2 * s->layout.stride + corner % 2;
    for (int lane = 0; lane < PL_LANES; lane++)
      to[lane] += gamma[corner * PL_LANES + lane] * by[lane];
  }
}

void cell_strips_gather(const cell_strips *s, int row, const cell_group *g, int count,
                        double *const by_cell[RECTANGLE_PUSHES], double *const pushed[2]) {
  const long at = row * plane_of(s) - s->low * s->layout.stride + g->first;
  const int cells = (count - 1) * PL_LANES + g[count - 1].count;
  rectangle_cells_gather(cells, by_cell, (double *const[]){pushed[0] + at, pushed[1] + at},
                         s->layout.stride);
}

void cell_strips_add(const cell_strips *s, int row, int first, int count, const double *low,
                     const double *high, double *pushed) {
  double *to = pushed + row * plane_of(s) - s->low * s->layout.stride + first;
  for (int n = 0; n < count; n++) {
    to[n] += low[n];
    to[s->layout.stride + n] += high[n];
  }
}

bool cell_strips_is_whole(const cell_strips *s, int row) {
  int cells = 0;
  for (int g = s->first_group[row]; g < s->first_group[row + 1]; g++) {
    if (!(s->groups[g].even > 0) || s->groups[g].first != cells) return false;
    cells += s->groups[g].count;
  }
  return cells == s->layout.nodes[0] - 1 && s->low == 0 && s->high == 1;
}

double *cell_strips_pushed_row(const cell_strips *s, int row, double *pushed) {
  return pushed + row * plane_of(s) + (1 - s->low) * s->layout.stride;
}

long cell_strips_pushed(const cell_strips *s) {
  return s->elements ? s->elements->slots : plane_of(s) * s->rows;
}

/* A loop: to begin a memset of this size takes longer. What is behind the last row is not read. */
void cell_strips_clear(const cell_strips *s, int row, double *const pushed[2]) {
  const long count = (s->high - s->low + 1) * s->layout.stride;
  for (int d = 0; d < 2 && !s->elements; d++) { /* slots are written, not added to */
    double *plane = pushed[d] + row * plane_of(s);
    INDEPENDENT
    for (long k = 0; k < count; k++)
      plane[k] = 0;
  }
}

/* Of the row of cells below and of the one above. */
static void add_both(long count, const double *a, const double *b, double *out) {
  INDEPENDENT
  for (long k = 0; k < count; k++)
    out[k] = a[k] + b[k];
}

static void add_row(long count, const double *in, bool more, double *out) {
  if (!more) {
    memcpy(out, in, (size_t)count * sizeof *out);
    return;
  }
  INDEPENDENT
  for (long k = 0; k < count; k++)
    out[k] += in[k];
}

void cell_strips_take(const cell_strips *s, int row, double *const pushed[2], bool placed,
                      bool more, double *const force[2]) {
  const node_layout *l = &s->layout;
  if (s->elements) {
    element_strips_take(s->elements, row, pushed, more, force);
    return;
  }
  const int from = row - s->high < 0 ? 0 : row - s->high, above = placed ? row - 1 : row - s->low,
            to = above > s->rows - 1 ? s->rows - 1 : above;
  const bool first = !more && !placed;
  for (int d = 0; d < 2; d++) {
    double *out = force[d] + l->origin + row * l->stride;
    const double *in = pushed[d] + from * plane_of(s) + (row - from - s->low) * l->stride;
    const long next = plane_of(s) - l->stride;
    if (first && from > to) memset(out, 0, (size_t)l->padded * sizeof *out);
    if (first && to == from + 1)
      add_both(l->padded, in, in + next, out);
    else
      for (int c = from; c <= to; c++)
        add_row(l->padded, in + (c - from) * next, !first || c > from, out);
    for (long k = l->nodes[0]; k < l->padded; k++)
      out[k] = 0;
  }
}
