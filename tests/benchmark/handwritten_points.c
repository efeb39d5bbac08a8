#include "tests/benchmark/handwritten_points.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "dsl/base/arena.h"
#include "runtime/base/pool.h"
#include "tests/benchmark/handwritten_families.h"
#include "tests/benchmark/lanes.h"

enum { EPS_BAR, XX, YY, XY, STATES, POINTS = 4 };

#if defined(__clang__)
#define UNROLL
#else
#define UNROLL _Pragma("GCC unroll 4")
#endif

/* Doubles of LANES neighbouring cells: states of a point side by side. */
enum { GROUP = POINTS * STATES * LANES };

typedef struct plastic_constants {
  double mu2, lambda, back; /* back: 2 mu + 2/3 H_kin */
  double f_y, H, pace;      /* pace: 1/(3 mu + H + H_kin) */
} plastic_constants;

struct plastic_plate {
  node_layout layout;
  long groups; /* of a row */
  pool *memory;
  plastic_constants law;
  /* Of the slopes at a point across an edge near it and the far one: of strains (1/m) and times
     half a spacing, thickness and the other spacing: of forces (m^2) */
  double near[2], far[2], push_near[2], push_far[2];
  double *states; /* [rows of cells][groups][GROUP] */
  double *up[2];  /* [padded] N: what the row of cells below does to the row of nodes */
};

/* --- a point ---------------------------------------------------------------------------------- */

typedef struct plane_lanes {
  lanes xx, yy, xy;
} plane_lanes;

/* The stress of a point, whose states go on. Where no lane yields, these are only read. */
LANES_FUNCTION plane_lanes return_map(const plastic_constants *c, plane_lanes e, double *state) {
  const lanes trace = e.xx + e.yy, mean = trace * (1.0 / 3);
  const lanes k = lanes_load(state + EPS_BAR * LANES);
  lanes p_xx = lanes_load(state + XX * LANES), p_yy = lanes_load(state + YY * LANES),
        p_xy = lanes_load(state + XY * LANES);
  const lanes s_xx = c->mu2 * (e.xx - mean) - c->back * p_xx,
              s_yy = c->mu2 * (e.yy - mean) - c->back * p_yy, s_xy = c->mu2 * e.xy - c->back * p_xy;
  const lanes square = 3 * ((s_xx * (s_xx + s_yy) + s_yy * s_yy) + s_xy * s_xy),
              strength = c->f_y + c->H * k;
  const lanes_marks yields = lanes_least(square, strength * strength);
  if (lanes_any(yields)) {
    const lanes inverse = lanes_inverse_root(lanes_max(square, lanes_all(1)));
    const lanes more = lanes_keep(yields, c->pace * (square * inverse - strength));
    const lanes along = (1.5 * more) * inverse;
    lanes_store(state + EPS_BAR * LANES, k + more);
    lanes_store(state + XX * LANES, p_xx += along * s_xx);
    lanes_store(state + YY * LANES, p_yy += along * s_yy);
    lanes_store(state + XY * LANES, p_xy += along * s_xy);
  }
  const lanes pressed = c->lambda * trace;
  return (plane_lanes){pressed + c->mu2 * (e.xx - p_xx), pressed + c->mu2 * (e.yy - p_yy),
                       c->mu2 * (e.xy - p_xy)};
}

/* --- a group of cells ------------------------------------------------------------------------- */

typedef struct edge_pair { /* values at low and high points, or at left and right ones */
  lanes first, second;
} edge_pair;

LANES_FUNCTION edge_pair blend(lanes first, lanes second, double near, double far) {
  return (edge_pair){near * first + far * second, far * first + near * second};
}

/* Differences along the lower and the upper edge, and along the left and the right one. */
LANES_FUNCTION edge_pair along_x(const double *low, const double *high) {
  return (edge_pair){lanes_load(low + 1) - lanes_load(low),
                     lanes_load(high + 1) - lanes_load(high)};
}
LANES_FUNCTION edge_pair along_y(const double *low, const double *high) {
  return (edge_pair){lanes_load(high) - lanes_load(low),
                     lanes_load(high + 1) - lanes_load(low + 1)};
}

/* What the group does to its nodes in one direction. */
typedef struct corner_lanes {
  lanes low_left, low_right, high_left, high_right;
} corner_lanes;

/* x: forces across the low and the high edge, y: across the left and the right one. */
LANES_FUNCTION corner_lanes corners_of(edge_pair x, edge_pair y) {
  return (corner_lanes){-(x.first + y.first), x.first - y.second, y.first - x.second,
                        x.second + y.second};
}

LANES_FUNCTION void find_group(plastic_plate *p, double *states, const double *const low[2],
                               const double *const high[2], corner_lanes out[2]) {
  const edge_pair a = along_x(low[0], high[0]), b = along_y(low[1], high[1]),
                  c = along_y(low[0], high[0]), d = along_x(low[1], high[1]);
  const edge_pair xx = blend(a.first, a.second, p->near[0], p->far[0]),
                  yy = blend(b.first, b.second, p->near[1], p->far[1]),
                  u_y = blend(c.first, c.second, 0.5 * p->near[1], 0.5 * p->far[1]),
                  v_x = blend(d.first, d.second, 0.5 * p->near[0], 0.5 * p->far[0]);
  const plane_lanes e[] = {{xx.first, yy.first, u_y.first + v_x.first},
                           {xx.first, yy.second, u_y.second + v_x.first},
                           {xx.second, yy.first, u_y.first + v_x.second},
                           {xx.second, yy.second, u_y.second + v_x.second}};
  plane_lanes s[POINTS];
  UNROLL
  for (int k = 0; k < POINTS; k++)
    s[k] = return_map(&p->law, e[k], states + k * STATES * LANES);
  const double near_x = p->push_near[0], far_x = p->push_far[0], near_y = p->push_near[1],
               far_y = p->push_far[1];
  out[0] = corners_of(blend(s[0].xx + s[1].xx, s[2].xx + s[3].xx, near_x, far_x),
                      blend(s[0].xy + s[2].xy, s[1].xy + s[3].xy, near_y, far_y));
  out[1] = corners_of(blend(s[0].xy + s[1].xy, s[2].xy + s[3].xy, near_x, far_x),
                      blend(s[0].yy + s[2].yy, s[1].yy + s[3].yy, near_y, far_y));
}

/* --- rows ------------------------------------------------------------------------------------- */

/* Cells beside the last one do nothing. */
static void cut(corner_lanes *c, int cells) {
  lanes keep;
  for (int lane = 0; lane < LANES; lane++)
    keep[lane] = lane < cells ? 1 : 0;
  c->low_left *= keep;
  c->low_right *= keep;
  c->high_left *= keep;
  c->high_right *= keep;
}

static void find_row(plastic_plate *p, int row, const double *const u[2], double *const force[2]) {
  const node_layout *l = &p->layout;
  const long at = l->origin + row * l->stride;
  lanes low_before[2] = {lanes_all(0), lanes_all(0)}, high_before[2] = {lanes_all(0), lanes_all(0)};
  double *states = p->states + row * p->groups * GROUP;
  for (long g = 0; g < p->groups; g++, states += GROUP) {
    const long q = at + g * LANES;
    const double *const low[] = {u[0] + q, u[1] + q}, *const high[] = {u[0] + q + l->stride,
                                                                       u[1] + q + l->stride};
    corner_lanes out[2];
    find_group(p, states, low, high, out);
    for (int d = 0; d < 2; d++) {
      double *up = p->up[d] + g * LANES;
      if (g == p->groups - 1) cut(&out[d], l->nodes[0] - 1 - (int)g * LANES);
      lanes_store(force[d] + q, (lanes_load(up) + out[d].low_left) +
                                    lanes_shift_in(low_before[d], out[d].low_right));
      lanes_store(up, out[d].high_left + lanes_shift_in(high_before[d], out[d].high_right));
      low_before[d] = out[d].low_right;
      high_before[d] = out[d].high_right;
    }
  }
}

static void find_all(plastic_plate *p, const double *const u[2], double *const force[2]) {
  const node_layout *l = &p->layout;
  const size_t wide = (size_t)l->padded * sizeof(double);
  const int last = l->nodes[1] - 1;
  for (int d = 0; d < 2; d++)
    memset(p->up[d], 0, wide);
  for (int row = 0; row < last; row++)
    find_row(p, row, u, force);
  for (int d = 0; d < 2; d++)
    memcpy(force[d] + l->origin + last * l->stride, p->up[d], wide);
}

/* --- set-up ----------------------------------------------------------------------------------- */

static size_t state_count(const plastic_plate *p) {
  return (size_t)(p->layout.nodes[1] - 1) * (size_t)p->groups * GROUP;
}

static void rest(plastic_plate *p) {
  memset(p->states, 0, state_count(p) * sizeof(double));
}

static plastic_plate *plate_open(const node_layout *layout, const double spacing[2],
                                 double thickness, const plastic_material *m) {
  const double near = 0.5 * (1 + 1 / sqrt(3)), mu = m->E / (2 * (1 + m->nu));
  plastic_plate *p = must_calloc(1, sizeof *p);
  *p = (plastic_plate){.layout = *layout, .groups = layout->padded / LANES, .memory = pool_new()};
  p->law = (plastic_constants){.mu2 = 2 * mu,
                               .lambda = 2 * mu * m->nu / (1 - 2 * m->nu),
                               .back = 2 * mu + 2.0 / 3 * m->H_kin,
                               .f_y = m->f_y,
                               .H = m->H,
                               .pace = 1 / (3 * mu + m->H + m->H_kin)};
  for (int d = 0; d < 2; d++) {
    const double area = 0.25 * spacing[0] * spacing[1] * thickness;
    p->near[d] = near / spacing[d];
    p->far[d] = (1 - near) / spacing[d];
    p->push_near[d] = area * p->near[d];
    p->push_far[d] = area * p->far[d];
    p->up[d] = pool_doubles(p->memory, layout->padded);
  }
  p->states = pool_doubles(p->memory, (long)state_count(p));
  return p;
}

static void plate_close(plastic_plate *p) {
  pool_free(p->memory);
  free(p);
}

static void state_at(const plastic_plate *p, int i, int j, int right, int high, double out[5]) {
  const double *at = p->states + (j * p->groups + i / LANES) * GROUP +
                     (2 * high + right) * STATES * LANES + i % LANES;
  const double xx = at[XX * LANES], yy = at[YY * LANES];
  const double all[] = {at[EPS_BAR * LANES], xx, yy, -(xx + yy), at[XY * LANES]};
  memcpy(out, all, sizeof all);
}

const plastic_program HANDWRITTEN_NAME(plastic) = {plate_open, plate_close, rest, find_all,
                                                   state_at};
