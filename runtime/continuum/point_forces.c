#include "runtime/continuum/point_forces.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "dsl/base/arena.h"
#include "dsl/base/elementary.h"
#include "runtime/base/lane_sum.h"
#include "runtime/continuum/point_law.h"
#include "runtime/mesh/element_modes.h"

enum {
  STRAINS = 3,
  STRESSES = 4,
  TANGENTS = STRAINS * STRAINS,
  STRIP = 320,      /* points of a strip, unless a group has more: strains and stresses are 18 kB */
  LONG_STRIP = 2048 /* where the law keeps these to itself: what its cells push is 32 kB */
};

/* What a thread works with: planes of one strip, and sums over rows of rectangles. */
typedef struct point_scratch {
  double *strain[STRAINS], *rate[STRAINS], *stress[STRESSES], *traction[STRAINS],
      *tangent[TANGENTS], *bound, *by_cell[RECTANGLE_PUSHES], *low[2];
  rectangle_rows sums;
  double **old_field, **new_field, **observed, **parameter;
} point_scratch;

/* --- set-up ----------------------------------------------------------------------------------- */

static double *doubles(point_forces *p, long count) {
  p->doubles += count;
  return pool_doubles(p->memory, count);
}

static void planes(point_forces *p, double **at, int count, long size) {
  for (int k = 0; k < count; k++)
    at[k] = doubles(p, size);
}

/* Whether the law goes from nodes to nodes by itself where cells are rectangles, unless these are
   asked whether they have failed. */
static bool goes_by_rectangles(const point_forces *p) {
  return p->failed < 0 && PL_HAS(p->law, rectangle_ledger) && p->law->rectangle_ledger;
}

/* Rectangles whose dilatation is the mean are strained like any other cells. */
static void open_strips(point_forces *p) {
  const bool by_law = goes_by_rectangles(p);
  p->parts = point_strips_new(&p->strips, !p->mean, STRIP, by_law ? LONG_STRIP : STRIP);
  p->whole = must_calloc((size_t)p->strips.rows + 1, 1);
  p->placed = must_calloc((size_t)p->strips.rows + 1, 1);
  p->summed = must_calloc((size_t)p->strips.rows + 1, 1);
  for (int row = 0; row < p->strips.rows; row++)
    p->whole[row] = by_law && !p->mean && cell_strips_is_whole(&p->strips, row);
}

static void open_scratch(point_forces *p, point_scratch *s) {
  const long size = p->parts->most > STRIP ? p->parts->most : STRIP;
  planes(p, s->strain, STRAINS, size);
  planes(p, s->rate, STRAINS, size);
  planes(p, s->stress, STRESSES, size);
  planes(p, s->traction, STRAINS, size);
  planes(p, s->tangent, TANGENTS, size);
  planes(p, &s->bound, 1, size);
  planes(p, s->by_cell, RECTANGLE_PUSHES, size / 4 + PL_LANES);
  planes(p, s->low, 2, p->strips.layout.padded);
  planes(p, s->sums.above, 2, p->strips.layout.padded);
  s->old_field = must_calloc((size_t)p->law->field_count + 1, sizeof(double *));
  s->new_field = must_calloc((size_t)p->law->field_count + 1, sizeof(double *));
  s->observed = must_calloc((size_t)p->law->output_count + 1, sizeof(double *));
  s->parameter = must_calloc((size_t)p->law->varying_count + 1, sizeof(double *));
}

static void open_parameters(point_forces *p, const double *parameters) {
  const long count = p->strips.count;
  if (p->law->varying_count == 0) return;
  point_values_open(&p->shapes, p->of, p->points);
  p->parameter = doubles(p, p->law->varying_count * count);
  for (int k = 0; k < p->law->varying_count; k++)
    for (long n = 0; n < count; n++)
      p->parameter[k * count + n] = parameters[p->law->varying[k]];
}

void point_forces_give(point_forces *p, int k, const double *nodes) {
  double *values = p->parameter + k * (long)p->strips.count;
  for (int n = 0; n < p->points->count; n++) {
    const int cell = p->points->cell[n];
    if (!point_forces_has(p, cell)) continue;
    const long at = p->strips.of_cell[cell] + (long)(n - p->points->first[cell]) * PL_LANES;
    values[at] = point_values_at(&p->shapes, n, nodes);
  }
}

static void open_states(point_forces *p, bool ledger) {
  const long count = p->strips.count;
  const pl_law *law = p->law;
  p->loses = ledger && (law->field_count > 0 || law->reads_rates ||
                        (PL_HAS(law, works_at_rest) && law->works_at_rest));
  p->old_field = doubles(p, law->field_count * count);
  p->new_field = doubles(p, law->field_count * count);
  for (int f = 0; f < law->field_count; f++)
    for (long k = 0; k < count; k++)
      p->old_field[f * count + k] = p->new_field[f * count + k] = law->fields[f].initial;
  p->observed = doubles(p, (1 + law->output_count) * count);
  p->stress = doubles(p, STRESSES * count);
  if (!p->loses) return;
  p->lost = doubles(p, PL_LOSSES * count);
  p->lost_now = doubles(p, PL_LOSSES * count);
}

static void find_sizes(point_forces *p, const mesh *m) {
  p->size = doubles(p, p->strips.count);
  for (int row = 0; row < p->strips.rows; row++)
    for (int n = p->strips.first_group[row]; n < p->strips.first_group[row + 1]; n++) {
      const cell_group *g = &p->strips.groups[n];
      for (int lane = 0; lane < PL_LANES; lane++) {
        const double h = mesh_cell_size(m, cell_strips_cell(&p->strips, m, row, g, lane));
        for (int k = 0; k < g->points; k++)
          p->size[g->at + k * PL_LANES + lane] = h;
      }
    }
}

/* L^-1 of Cholesky's factor of the tangent at rest; zeros where it has none. */
static void find_scale(const double rest[STRAINS][STRAINS], double scale[STRAINS][STRAINS]) {
  double l[STRAINS][STRAINS] = {{0}};
  memset(scale, 0, sizeof(double[STRAINS][STRAINS]));
  for (int i = 0; i < STRAINS; i++)
    for (int j = 0; j <= i; j++) {
      double sum = 0.5 * (rest[i][j] + rest[j][i]);
      for (int k = 0; k < j; k++)
        sum -= l[i][k] * l[j][k];
      if (i == j && !(sum > 0)) return;
      l[i][j] = i == j ? sqrt(sum) : sum / l[j][j];
    }
  for (int c = 0; c < STRAINS; c++)
    for (int i = c; i < STRAINS; i++) {
      double sum = i == c ? 1 : 0;
      for (int k = c; k < i; k++)
        sum -= l[i][k] * scale[k][c];
      scale[i][c] = sum / l[i][i];
    }
}

void point_forces_rest(const mesh *m, const unsigned char *own, const pl_law *law,
                       const double *parameters, bool viscous, double tangent[3][3]) {
  const double rest[STRAINS] = {0};
  point_law *one = point_law_new(law, parameters);
  const bool differ = (m->mapped || m->lists) && point_law_reads_size(law);
  double most = -INFINITY;
  for (int cell = 0; cell < (differ ? mesh_cell_count(m) : 1); cell++) {
    double here[STRAINS][STRAINS];
    if (differ && own && !own[cell]) continue;
    if (viscous)
      point_law_viscosity(one, mesh_cell_size(m, cell), here);
    else
      point_law_tangent(one, rest, mesh_cell_size(m, cell), here);
    const double trace = here[0][0] + here[1][1] + here[2][2];
    if (isfinite(most) && !(trace > most)) continue;
    most = trace;
    memcpy(tangent, here, sizeof here);
  }
  point_law_free(one);
}

static void find_rest(point_forces *p, const unsigned char *own, const double *parameters) {
  double tangent[STRAINS][STRAINS];
  point_forces_rest(p->of, own, p->law, parameters, false, tangent);
  p->strip = element_strip_stiffness((const double(*)[STRAINS])tangent);
  find_scale(tangent, p->scale);
}

typedef void take_cell(point_forces *p, int group, int lane, int cell);

static void for_each_cell(point_forces *p, take_cell *take) {
  for (int row = 0; row < p->strips.rows; row++)
    for (int n = p->strips.first_group[row]; n < p->strips.first_group[row + 1]; n++)
      for (int lane = 0; lane < p->strips.groups[n].count; lane++)
        take(p, n, lane, cell_strips_cell(&p->strips, p->of, row, &p->strips.groups[n], lane));
}

static void open_mean(point_forces *p, int group, int lane, int cell) {
  const cell_group *g = &p->strips.groups[group];
  const double *volume = p->strips.volume + g->at + lane;
  double whole = 0;
  if (!element_takes_mean(p->of, cell)) return;
  if (!p->mean) {
    p->mean = doubles(p, (long)p->strips.group_count * PL_LANES);
    p->part = doubles(p, p->strips.count);
  }
  p->mean[group * PL_LANES + lane] = 1;
  for (int k = 0; k < g->points; k++)
    whole += volume[k * PL_LANES];
  for (int k = 0; k < g->points; k++)
    p->part[g->at + k * PL_LANES + lane] = volume[k * PL_LANES] / whole;
}

enum { CORNERS = 4, HOURGLASS = CORNERS + 1 };

static void open_hourglass(point_forces *p, int group, int lane, int cell) {
  double gamma[CORNERS];
  const double part = element_hourglass(p->of, cell, gamma);
  if (!(part > 0)) return;
  if (!p->hourglass) p->hourglass = doubles(p, (long)p->strips.group_count * HOURGLASS * PL_LANES);
  double *own = p->hourglass + (long)group * HOURGLASS * PL_LANES + lane;
  for (int q = 0; q < CORNERS; q++)
    own[q * PL_LANES] = gamma[q];
  own[CORNERS * PL_LANES] = p->of->thickness * part * p->strip;
}

point_forces *point_forces_new(const mesh *m, const unsigned char *own,
                               const integration_points *points, const pl_law *law,
                               const double *parameters, int blocks, bool ledger) {
  const pl_bond_class none = {.size = sizeof none};
  point_forces *p = must_calloc(1, sizeof *p);
  *p = (point_forces){.of = m, .points = points, .law = law, .blocks = blocks};
  p->memory = pool_new();
  p->failed = point_law_failed(law);
  p->uniforms = must_calloc((size_t)law->uniform_count + 1, sizeof(double));
  law->prepare(law, parameters, &none, p->uniforms);
  cell_strips_open(&p->strips, m, points, own);
  open_states(p, ledger);
  open_parameters(p, parameters);
  for (int d = 0; d < 2; d++)
    p->pushed[d] = doubles(p, cell_strips_pushed(&p->strips));
  find_sizes(p, m);
  p->rows = must_calloc((size_t)p->strips.rows + 1, sizeof *p->rows);
  p->dead = must_calloc((size_t)p->strips.rows + 1, sizeof *p->dead);
  p->first_death = -1;
  find_rest(p, own, parameters);
  for_each_cell(p, open_mean);
  for_each_cell(p, open_hourglass);
  open_strips(p);
  p->scratch = must_calloc((size_t)blocks + 1, sizeof *p->scratch);
  for (int b = 0; b < blocks; b++)
    open_scratch(p, &p->scratch[b]);
  return p;
}

void point_forces_free(point_forces *p) {
  if (!p) return;
  for (int b = 0; b < p->blocks; b++) {
    free(p->scratch[b].old_field);
    free(p->scratch[b].new_field);
    free(p->scratch[b].observed);
    free(p->scratch[b].parameter);
  }
  free(p->scratch);
  free(p->rows);
  point_strips_free(p->parts);
  free(p->whole);
  free(p->placed);
  free(p->summed);
  free(p->dead);
  free(p->uniforms);
  point_values_close(&p->shapes);
  cell_strips_close(&p->strips);
  pool_free(p->memory);
  free(p);
}

long point_forces_bytes(const point_forces *p) {
  return p->strips.bytes + p->parts->bytes + (long)sizeof(double) * p->doubles;
}

/* --- a strip ---------------------------------------------------------------------------------- */

static void find_strains(const point_forces *p, const point_strip *s, const double *const nodes[2],
                         double *const strain[STRAINS]) {
  for (int g = s->first; g < s->last; g++) {
    const cell_group *group = &p->strips.groups[g];
    double *at[STRAINS];
    for (int c = 0; c < STRAINS; c++)
      at[c] = strain[c] + (group->at - s->at);
    cell_strips_strain(&p->strips, s->row, group, nodes, at);
  }
}

/* The law's view of a strip: states in place, all else in the thread's planes. */
static pl_points view_of(const point_forces *p, const point_strip *s, point_scratch *own,
                         const point_motion *at) {
  const long all = p->strips.count;
  for (int f = 0; f < p->law->field_count; f++) {
    own->old_field[f] = p->old_field + f * all + s->at;
    own->new_field[f] = p->new_field + f * all + s->at;
  }
  for (int k = 0; k < p->law->varying_count; k++)
    own->parameter[k] = p->parameter + k * all + s->at;
  return (pl_points){.size = sizeof(pl_points),
                     .count = s->count,
                     .strain = (const double *const *)own->strain,
                     .strain_rate = (const double *const *)own->rate,
                     .cell_size = p->size + s->at,
                     .parameter = (const double *const *)own->parameter,
                     .old_field = (const double *const *)own->old_field,
                     .new_field = own->new_field,
                     .stress = own->stress,
                     .tangent = own->tangent,
                     .time = at->time,
                     .time_step = at->time_step,
                     .advance = at->advance};
}

/* Takes the cells' mean dilatation in place of the points' own, of strains xx, yy; and of tractions
   (a stress times the volume) what is due to it: the transpose. */
static void take_mean(const point_forces *p, const point_strip *s, double *xx, double *yy,
                      bool tractions) {
  for (int g = s->first; g < s->last; g++) {
    const cell_group *group = &p->strips.groups[g];
    const double *taken = p->mean + (long)g * PL_LANES, *part = p->part + group->at;
    double *x = xx + (group->at - s->at), *y = yy + (group->at - s->at), sum[PL_LANES] = {0};
    for (int k = 0; k < group->points * PL_LANES; k++)
      sum[k % PL_LANES] += (tractions ? 1 : part[k]) * (x[k] + y[k]);
    for (int k = 0; k < group->points * PL_LANES; k++) {
      const int lane = k % PL_LANES;
      const double shift =
          taken[lane] * 0.5 * ((tractions ? part[k] : 1) * sum[lane] - (x[k] + y[k]));
      x[k] += shift;
      y[k] += shift;
    }
  }
}

/* dead[PL_LANES] 1 in cells of a group all of whose points have failed by these states, a plane
   that begins with it. */
static void find_dead(const cell_group *g, const double *failed, double dead[PL_LANES]) {
  for (int lane = 0; lane < PL_LANES; lane++)
    dead[lane] = lane < g->count;
  for (int k = 0; k < g->points; k++)
    for (int lane = 0; lane < PL_LANES; lane++)
      dead[lane] = failed[k * PL_LANES + lane] >= 1 ? dead[lane] : 0;
}

/* Dead cells strain no more. */
static void leave_dead(const point_forces *p, const point_strip *s, double *const strain[STRAINS]) {
  for (int g = s->first; g < s->last; g++) {
    const cell_group *group = &p->strips.groups[g];
    const long to = group->at - s->at;
    double dead[PL_LANES];
    find_dead(group, p->old_field + p->failed * (long)p->strips.count + group->at, dead);
    for (int c = 0; c < STRAINS; c++)
      for (int k = 0; k < group->points; k++)
        for (int lane = 0; lane < PL_LANES; lane++) {
          double *at = strain[c] + to + k * PL_LANES + lane;
          *at = dead[lane] > 0 ? 0 : *at;
        }
  }
}

static long count_dead(const point_forces *p, const point_strip *s, const point_scratch *own) {
  double sum = 0;
  for (int g = s->first; g < s->last; g++) {
    const cell_group *group = &p->strips.groups[g];
    double dead[PL_LANES];
    find_dead(group, own->new_field[p->failed] + (group->at - s->at), dead);
    for (int lane = 0; lane < PL_LANES; lane++)
      sum += dead[lane];
  }
  return (long)sum;
}

static pl_points motion_of(const point_forces *p, const point_strip *s, point_scratch *own,
                           const point_motion *at) {
  const bool rates = p->law->reads_rates || p->loses;
  find_strains(p, s, at->displacement, own->strain);
  if (rates) find_strains(p, s, at->velocity, own->rate);
  if (p->mean) take_mean(p, s, own->strain[0], own->strain[1], false);
  if (p->mean && rates) take_mean(p, s, own->rate[0], own->rate[1], false);
  if (p->failed >= 0) leave_dead(p, s, own->strain);
  if (p->failed >= 0 && rates) leave_dead(p, s, own->rate);
  return view_of(p, s, own, at);
}

static void push_group(const point_forces *p, int row, const cell_group *g,
                       const point_scratch *own, const double *const stress[STRAINS]) {
  const double *volume = p->strips.volume + g->at;
  const long count = (long)g->points * PL_LANES;
  for (int c = 0; c < STRAINS; c++) {
    double *traction = own->traction[c];
    const double *from = stress[c];
    INDEPENDENT
    for (long k = 0; k < count; k++)
      traction[k] = volume[k] * from[k];
  }
  cell_strips_push(&p->strips, row, g, (const double *const *)own->traction, p->pushed);
}

static void push_rectangles(const point_forces *p, const point_strip *s, const point_scratch *own,
                            double *const stress[STRAINS]) {
  rectangle_cells_push(&s->push, s->last - s->first,
                       (const double *const[]){stress[0], stress[1], stress[2]}, own->by_cell);
  cell_strips_gather(&p->strips, s->row, &p->strips.groups[s->first], s->last - s->first,
                     own->by_cell, p->pushed);
}

static void push_groups(const point_forces *p, const point_strip *s, const point_scratch *own,
                        double *const stress[STRAINS]) {
  for (int g = s->first; g < s->last; g++) {
    const long to = p->strips.groups[g].at - s->at;
    push_group(p, s->row, &p->strips.groups[g], own,
               (const double *const[]){stress[0] + to, stress[1] + to, stress[2] + to});
  }
}

/* Of elements whose dilatation is the mean. */
static void push_mean(const point_forces *p, const point_strip *s, const point_scratch *own,
                      double *const stress[STRAINS]) {
  const double *volume = p->strips.volume + s->at;
  for (int c = 0; c < STRAINS; c++) {
    double *traction = own->traction[c];
    const double *from = stress[c];
    INDEPENDENT
    for (long k = 0; k < s->count; k++)
      traction[k] = volume[k] * from[k];
  }
  take_mean(p, s, own->traction[0], own->traction[1], true);
  for (int g = s->first; g < s->last; g++) {
    const cell_group *group = &p->strips.groups[g];
    const long to = group->at - s->at;
    const double *traction[STRAINS] = {own->traction[0] + to, own->traction[1] + to,
                                       own->traction[2] + to};
    cell_strips_push(&p->strips, s->row, group, traction, p->pushed);
  }
}

static void push(const point_forces *p, const point_strip *s, const point_scratch *own,
                 double *const stress[STRAINS]) {
  (p->mean ? push_mean : s->rectangles ? push_rectangles : push_groups)(p, s, own, stress);
}

/* alive[PL_LANES] 0 in cells of a group that are dead by these states of its strip, else 1. */
static void find_alive(const point_forces *p, const point_strip *s, int g, double *const *fields,
                       double alive[PL_LANES]) {
  const cell_group *group = &p->strips.groups[g];
  double dead[PL_LANES] = {0};
  if (p->failed >= 0) find_dead(group, fields[p->failed] + (group->at - s->at), dead);
  for (int lane = 0; lane < PL_LANES; lane++)
    alive[lane] = 1 - dead[lane];
}

/* What elements resist their hourglass modes by. Of the point that each of them has, J/m^3:
   `stored` is added to; and what cells that die in this step had stored so is `lost`, with the term
   that is due to forces halfway (ledger.h). Either may be NULL. */
static void resist_hourglass(const point_forces *p, const point_strip *s, const point_scratch *own,
                             const point_motion *at, double *lost, double *stored) {
  for (int g = s->first; g < s->last && p->hourglass; g++) {
    const cell_group *group = &p->strips.groups[g];
    const double *gamma = p->hourglass + (long)g * HOURGLASS * PL_LANES,
                 *C = gamma + CORNERS * PL_LANES, *volume = p->strips.volume + group->at;
    const long point = group->at - s->at;
    double before[PL_LANES], after[PL_LANES];
    if (!cell_strips_single(&p->strips, group)) continue;
    find_alive(p, s, g, own->old_field, before);
    find_alive(p, s, g, own->new_field, after);
    for (int axis = 0; axis < 2; axis++) {
      double q[PL_LANES], rate[PL_LANES] = {0}, by[PL_LANES];
      cell_strips_mode(&p->strips, s->row, group, gamma, at->displacement[axis], q);
      if (lost) cell_strips_mode(&p->strips, s->row, group, gamma, at->velocity[axis], rate);
      for (int lane = 0; lane < PL_LANES; lane++)
        by[lane] = after[lane] * C[lane] * q[lane];
      cell_strips_push_mode(&p->strips, s->row, group, gamma, by, p->pushed[axis]);
      for (int lane = 0; lane < PL_LANES && (stored || lost); lane++) {
        if (!(C[lane] > 0)) continue;
        const double half = 0.5 * C[lane] * q[lane] / volume[lane];
        if (stored) stored[point + lane] += after[lane] * half * q[lane];
        if (lost)
          lost[point + lane] +=
              (before[lane] - after[lane]) * half * (q[lane] - at->time_step * rate[lane]);
      }
    }
  }
}

/* What the law writes goes to planes of the whole mesh. */
static void aim(const point_forces *p, const point_strip *s, double *plane, int count,
                double **at) {
  for (int k = 0; k < count; k++)
    at[k] = plane + k * (long)p->strips.count + s->at;
}

static int cells_of(const point_forces *p, const point_strip *s) {
  return (s->last - s->first - 1) * PL_LANES + p->strips.groups[s->last - 1].count;
}

/* Forces of the lower nodes of a strip, [cells], but for the right one of the last cell, and sums
   over rows (rectangle_rows): in one loop of the law's from displacements to these. */
static void step_rectangles(const point_forces *p, const point_strip *s, point_scratch *own,
                            const point_motion *at, double *const force[2]) {
  const cell_group *first = &p->strips.groups[s->first];
  const node_layout *l = &p->strips.layout;
  const long node = l->origin + s->row * l->stride + first->first;
  const double *const u[] = {at->displacement[0] + node, at->displacement[1] + node},
                      *const v[] = {at->velocity[0] + node, at->velocity[1] + node};
  double *const above[] = {own->sums.above[0] + first->first, own->sums.above[1] + first->first};
  double *lost[PL_LOSSES];
  pl_points points = view_of(p, s, own, at);
  const pl_rectangles cells = {.size = sizeof cells,
                               .count = (s->last - s->first) * PL_LANES,
                               .cells = cells_of(p, s),
                               .stride = l->stride,
                               .displacement = u,
                               .velocity = v,
                               .slopes = &first->table->slopes,
                               .push = &s->push,
                               .force = force,
                               .above = above,
                               .right = own->sums.right,
                               .points = &points};
  if (p->loses) {
    aim(p, s, p->lost, PL_LOSSES, lost);
    points.lost = lost;
  }
  (p->loses ? p->law->rectangle_ledger : p->law->rectangle_step)(p->law, p->uniforms, &cells);
}

static void step_points(const point_forces *p, const point_strip *s, point_scratch *own,
                        const point_motion *at) {
  double *lost[PL_LOSSES];
  pl_points points = motion_of(p, s, own, at);
  if (p->loses) {
    aim(p, s, p->lost, PL_LOSSES, lost);
    points.lost = lost;
    p->law->point_ledger(p->law, p->uniforms, &points);
  } else {
    p->law->point_step(p->law, p->uniforms, &points);
  }
  if (p->failed >= 0) p->dead[s->row] += count_dead(p, s, own);
  push(p, s, own, own->stress);
  resist_hourglass(p, s, own, at, p->loses && p->failed >= 0 ? lost[PL_LOST_TO_STATES] : NULL,
                   NULL);
}

static void step_strip(const point_forces *p, const point_strip *s, point_scratch *own,
                       const point_motion *at) {
  if (!s->rectangles || !goes_by_rectangles(p)) {
    step_points(p, s, own, at);
    return;
  }
  const int first = p->strips.groups[s->first].first, cells = cells_of(p, s);
  rectangle_rows_begin(&own->sums, first, first + cells + 1);
  step_rectangles(p, s, own, at, own->low);
  rectangle_rows_end(&own->sums, first + cells,
                     (double *const[]){own->low[0] + cells, own->low[1] + cells});
  for (int d = 0; d < 2; d++)
    cell_strips_add(&p->strips, s->row, first, cells + 1, own->low[d], own->sums.above[d] + first,
                    p->pushed[d]);
}

static void step_row(const point_forces *p, int row, point_scratch *own, const point_motion *at) {
  cell_strips_clear(&p->strips, row, p->pushed);
  for (int k = p->parts->first_of_row[row]; k < p->parts->first_of_row[row + 1]; k++)
    step_strip(p, &p->parts->items[k], own, at);
}

/* Of rectangles and nothing else. What the row does to its upper nodes waits for the next one if
   that is such a row, too, and this thread's. */
static void step_whole_row(const point_forces *p, int row, bool first, bool last,
                           point_scratch *own, const point_motion *at, double *const force[2]) {
  const cell_strips *s = &p->strips;
  double *low[2], *high[2];
  for (int d = 0; d < 2; d++) {
    low[d] = force[d] + s->layout.origin + row * s->layout.stride;
    high[d] = cell_strips_pushed_row(s, row, p->pushed[d]);
  }
  if (first) rectangle_rows_begin(&own->sums, 0, s->layout.nodes[0]);
  for (int k = p->parts->first_of_row[row]; k < p->parts->first_of_row[row + 1]; k++) {
    const point_strip *part = &p->parts->items[k];
    const int from = s->groups[part->first].first;
    step_rectangles(p, part, own, at, (double *const[]){low[0] + from, low[1] + from});
  }
  const int node = s->layout.nodes[0] - 1;
  rectangle_rows_end(&own->sums, node, (double *const[]){low[0] + node, low[1] + node});
  for (int d = 0; d < 2 && last; d++)
    memcpy(high[d], own->sums.above[d], (size_t)s->layout.nodes[0] * sizeof *high[d]);
}

/* --- looking at a state ----------------------------------------------------------------------- */

/* L^-1 D L^-T of the symmetric part of a point's tangent: its eigenvalues are those of the tangent
   by that at rest. */
static inline __attribute__((always_inline)) void relative_tangent(const point_forces *p,
                                                                   double *const tangent[TANGENTS],
                                                                   long at,
                                                                   double a[STRAINS][STRAINS]) {
  double d[STRAINS][STRAINS];
  for (int i = 0; i < STRAINS; i++)
    for (int j = 0; j < STRAINS; j++)
      d[i][j] = 0.5 * (tangent[STRAINS * i + j][at] + tangent[STRAINS * j + i][at]);
  for (int i = 0; i < STRAINS; i++)
    for (int j = 0; j <= i; j++) {
      double sum = 0;
      for (int k = 0; k <= i; k++)
        for (int m = 0; m <= j; m++)
          sum += p->scale[i][k] * p->scale[j][m] * d[k][m];
      a[i][j] = a[j][i] = sum;
    }
}

/* What no eigenvalue is above: mean + 2 p of the largest (below). */
static void find_bounds(const point_forces *p, double *const tangent[TANGENTS], long count,
                        double *bound) {
  INDEPENDENT
  for (long k = 0; k < count; k++) {
    double a[STRAINS][STRAINS];
    relative_tangent(p, tangent, k, a);
    const double mean = (a[0][0] + a[1][1] + a[2][2]) / 3, x = a[0][0] - mean, y = a[1][1] - mean,
                 z = a[2][2] - mean,
                 off = a[0][1] * a[0][1] + a[1][2] * a[1][2] + a[0][2] * a[0][2];
    bound[k] = mean + 2 * pl_sqrt((x * x + y * y + z * z + 2 * off) / 6);
  }
}

/* Largest eigenvalue of a symmetric matrix (Smith 1961). */
static double largest_eigenvalue(double a[STRAINS][STRAINS]) {
  const double mean = (a[0][0] + a[1][1] + a[2][2]) / 3, x = a[0][0] - mean, y = a[1][1] - mean,
               z = a[2][2] - mean, off = a[0][1] * a[0][1] + a[1][2] * a[1][2] + a[0][2] * a[0][2],
               p = pl_sqrt((x * x + y * y + z * z + 2 * off) / 6);
  if (!(p > 1e-12 * pl_abs(mean))) return mean;
  const double r = (x * (y * z - a[1][2] * a[1][2]) - a[0][1] * (a[0][1] * z - a[1][2] * a[0][2]) +
                    a[0][2] * (a[0][1] * a[1][2] - y * a[0][2])) /
                   (2 * p * p * p);
  const double within = pl_max(-1, pl_min(1, r));
  return mean + 2 * p * pl_cos(pl_atan2(pl_sqrt(1 - within * within), within) / 3);
}

/* The most that a point of the strip is as stiff as at rest, or `most` of others. */
static double stiffest_of(const point_forces *p, const point_strip *s, const point_scratch *own,
                          double most) {
  find_bounds(p, own->tangent, s->count, own->bound);
  for (long k = 0; k < s->count; k++) {
    double a[STRAINS][STRAINS];
    if (!(own->bound[k] > most)) continue;
    relative_tangent(p, own->tangent, k, a);
    most = pl_max(most, largest_eigenvalue(a));
  }
  return most;
}

static void add_losses(const point_forces *p, const point_strip *s, double *const lost[PL_LOSSES],
                       point_row *row) {
  const double *volume = p->strips.volume + s->at;
  double *before[PL_LOSSES];
  aim(p, s, p->lost, PL_LOSSES, before);
  const double now = lane_dot(s->count, NULL, lost[PL_LOST_TO_RATES], volume);
  row->state += lane_dot(s->count, NULL, before[PL_LOST_TO_STATES], volume) +
                lane_dot(s->count, NULL, lost[PL_LOST_TO_STATES], volume);
  row->rate += lane_dot(s->count, NULL, before[PL_LOST_TO_RATES], volume) + 0.5 * now;
  row->given += lane_dot(s->count, NULL, before[PL_GIVEN_BY_REST], volume) +
                lane_dot(s->count, NULL, lost[PL_GIVEN_BY_REST], volume);
  row->pending += 0.5 * now;
}

/* Lanes that fill up the last of a row of rectangles are strained by whatever stands beside the
   last node (step_rectangles). Nobody asks for them but sums, where they count with a volume of 0,
   which takes a number to be nothing: they are as made when looked at. */
static void forget_filling(const point_forces *p, const point_strip *s) {
  const cell_group *last = &p->strips.groups[s->last - 1];
  const long all = p->strips.count;
  for (int k = 0; k < last->points; k++)
    for (int lane = last->count; lane < PL_LANES; lane++) {
      const long at = last->at + k * PL_LANES + lane;
      for (int f = 0; f < p->law->field_count; f++)
        p->old_field[f * all + at] = p->law->fields[f].initial;
      for (int loss = 0; loss < PL_LOSSES && p->loses; loss++)
        p->lost[loss * all + at] = 0;
    }
}

static void see_strip(const point_forces *p, const point_strip *s, point_scratch *own,
                      const point_motion *at) {
  double *stress[STRESSES], *lost[PL_LOSSES];
  point_row *row = &p->rows[s->row];
  if (s->rectangles) forget_filling(p, s);
  pl_points points = motion_of(p, s, own, at);
  aim(p, s, p->stress, STRESSES, stress);
  points.stress = stress;
  if (p->loses) {
    aim(p, s, p->lost_now, PL_LOSSES, lost);
    for (int k = 0; k < PL_LOSSES; k++)
      memset(lost[k], 0, (size_t)s->count * sizeof(double));
    points.lost = lost;
    p->law->point_ledger(p->law, p->uniforms, &points);
  } else {
    p->law->point_step(p->law, p->uniforms, &points);
  }
  push(p, s, own, stress);
  points.old_field = (const double *const *)own->new_field; /* with the fields of this state */
  aim(p, s, p->observed, 1 + p->law->output_count, own->observed);
  points.observed = own->observed;
  p->law->point_observe(p->law, p->uniforms, &points);
  resist_hourglass(p, s, own, at, p->loses && p->failed >= 0 ? lost[PL_LOST_TO_STATES] : NULL,
                   own->observed[0]);
  if (p->loses) add_losses(p, s, lost, row);
  row->stored += lane_dot(s->count, NULL, own->observed[0], p->strips.volume + s->at);
  p->law->point_tangent(p->law, p->uniforms, &points);
  row->stiffness = stiffest_of(p, s, own, row->stiffness);
}

/* --- rows ------------------------------------------------------------------------------------- */

static void see_row(point_forces *p, int row, point_scratch *own, const point_motion *at) {
  cell_strips_clear(&p->strips, row, p->pushed);
  p->rows[row] = (point_row){0};
  for (int k = p->parts->first_of_row[row]; k < p->parts->first_of_row[row + 1]; k++)
    see_strip(p, &p->parts->items[k], own, at);
}

void point_forces_find(point_forces *p, int block, int from, int to, const point_motion *at,
                       bool seen, double *const force[2]) {
  const int last = to < p->strips.rows ? to : p->strips.rows;
  for (int row = from; row < last; row++) {
    const bool placed = !seen && force && p->whole[row],
               goes_on = placed && row > from && p->whole[row - 1];
    p->placed[row] = placed;
    p->summed[row] = goes_on;
    if (seen) {
      see_row(p, row, &p->scratch[block], at);
      continue;
    }
    p->dead[row] = 0;
    if (placed)
      step_whole_row(p, row, !goes_on, row + 1 == last || !p->whole[row + 1], &p->scratch[block],
                     at, force);
    else
      step_row(p, row, &p->scratch[block], at);
  }
}

void point_forces_take(const point_forces *p, int row, bool more, double *const force[2]) {
  const bool own = row < p->strips.rows;
  if (own && p->summed[row]) return;
  cell_strips_take(&p->strips, row, p->pushed, own && p->placed[row], more, force);
}

void point_forces_turn(point_forces *p, double time) {
  double *kept = p->old_field;
  p->old_field = p->new_field;
  p->new_field = kept;
  for (int row = 0; row < p->strips.rows && p->failed >= 0 && p->first_death < 0; row++)
    if (p->dead[row] > 0) p->first_death = time;
}

bool point_forces_dead(const point_forces *p, int cell) {
  if (p->failed < 0 || !point_forces_has(p, cell)) return false;
  const long plane = p->failed * (long)p->strips.count;
  const int count = p->points->first[cell + 1] - p->points->first[cell];
  for (int k = 0; k < count; k++) {
    const long at = plane + p->strips.of_cell[cell] + k * PL_LANES;
    if (!(p->old_field[at] >= 1 || p->new_field[at] >= 1)) return false;
  }
  return true;
}

long point_forces_deaths(const point_forces *p) {
  long count = 0;
  for (int cell = 0; cell < mesh_cell_count(p->of) && p->failed >= 0; cell++)
    count += point_forces_dead(p, cell);
  return count;
}

/* --- nodes ------------------------------------------------------------------------------------ */

/* Volume of a cell's points, and the integral of a plane over them. */
static void add_cell(const point_forces *p, const double *plane, int cell, double *volume,
                     double *sum) {
  const int count =
      point_forces_has(p, cell) ? p->points->first[cell + 1] - p->points->first[cell] : 0;
  for (int k = 0; k < count; k++) {
    const int at = p->strips.of_cell[cell] + k * PL_LANES;
    *volume += p->strips.volume[at];
    *sum += p->strips.volume[at] * plane[at];
  }
}

double point_forces_mean(const point_forces *p, const double *plane, int node) {
  int cell[ELEMENT_MOST_AROUND];
  const int count = mesh_cells_around(p->of, node, cell);
  double sum = 0, volume = 0;
  for (int n = 0; n < count; n++)
    add_cell(p, plane, cell[n], &volume, &sum);
  return sum / volume;
}

double point_forces_cell_mean(const point_forces *p, const double *plane, int cell) {
  double sum = 0, volume = 0;
  add_cell(p, plane, cell, &volume, &sum);
  return sum / volume;
}

static int corners_there(const mesh *m, int cell) {
  int corner[ELEMENT_MOST_NODES], count = 0;
  const int nodes = mesh_cell_nodes(m, cell, corner);
  for (int k = 0; k < nodes; k++)
    count += !m->gone[corner[k]];
  return count;
}

double point_forces_share(const point_forces *p, const double *plane, int node) {
  int cell[ELEMENT_MOST_AROUND];
  const int count = mesh_cells_around(p->of, node, cell);
  double share = 0;
  for (int n = 0; n < count; n++) {
    double sum = 0, volume = 0;
    add_cell(p, plane, cell[n], &volume, &sum);
    share += sum / corners_there(p->of, cell[n]);
  }
  return share;
}

/* --- where it went wrong ---------------------------------------------------------------------- */

static double size_of(double *const stress[STRESSES], long k) {
  double sum = 0;
  for (int c = 0; c < STRESSES; c++)
    sum += stress[c][k] * stress[c][k];
  return sum;
}

static void take_point(const point_forces *p, const point_strip *s, const point_scratch *own,
                       long k, point_state *out) {
  const cell_group *g = &p->strips.groups[s->first];
  cell_strips_place(&p->strips, p->of, p->points, s->row, g, (int)(s->at + k), out->at, out->cell);
  for (int c = 0; c < STRAINS; c++)
    out->strain[c] = own->strain[c][k];
  for (int c = 0; c < STRESSES; c++)
    out->stress[c] = own->stress[c][k];
  out->size = p->size[s->at + k];
  for (int f = 0; f < p->law->field_count; f++)
    out->field[f] = own->old_field[f][k];
}

double point_forces_worst(point_forces *p, int node, const point_motion *at, point_state *out) {
  const int at_row = node / p->of->nodes[0];
  point_scratch *own = &p->scratch[0];
  double most = -1;
  for (int row = at_row - p->strips.high; row <= at_row - p->strips.low; row++) {
    if (row < 0 || row >= p->strips.rows) continue;
    for (int g = p->strips.first_group[row]; g < p->strips.first_group[row + 1]; g++) {
      const cell_group *group = &p->strips.groups[g];
      const point_strip s = {.row = row,
                             .first = g,
                             .last = g + 1,
                             .at = group->at,
                             .count = (long)group->points * PL_LANES};
      const pl_points points = motion_of(p, &s, own, at);
      p->law->point_step(p->law, p->uniforms, &points);
      for (long k = 0; k < s.count && isfinite(most); k++) {
        const double here = size_of(own->stress, k);
        if (!cell_strips_reach(&p->strips, p->of, group, (int)(k % PL_LANES), node) || here <= most)
          continue;
        most = here;
        take_point(p, &s, own, k, out);
      }
    }
  }
  return isfinite(most) ? most : NAN;
}
