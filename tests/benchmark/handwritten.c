#include "tests/benchmark/handwritten.h"

#include <assert.h>
#include <stdlib.h>
#include <string.h>

#include "dsl/arena.h"
#include "tests/benchmark/lanes.h"

#ifndef HANDWRITTEN
#define HANDWRITTEN handwritten
#endif
#define JOIN2(a, b) a##b
#define JOIN(a, b)  JOIN2(a, b)
#define NAMED(name) JOIN(HANDWRITTEN, name)

/* The loops below each do a part of the work on the bonds of one direction of a row, through buffers that stay in the first
   cache. In one loop a bond would be a chain of some 170 cycles, of which the processor cannot keep enough in flight; the
   short chains overlap. */

/* The series hold while the ends' relative displacement is below this part of the bond's length: the chord then turns by
   less than asin(1/16), where five terms of the arc sine leave 2^-53. */
#define NEAR_PART (1.0 / 16)

#if defined(__clang__)
#define UNROLL
#else
#define UNROLL _Pragma("GCC unroll 2")
#endif

typedef struct direction {
  long offset[2];             /* from a site to its partner, by parity of the row */
  double chord_x, chord_y;    /* m */
  double unit_x, unit_y;      /* chord over s^2, 1/m */
} direction;

typedef struct constants {
  double per_square;          /* 1/s^2 */
  double near_square;         /* of the displacements that the series bear, m^2 */
  double bend_weight;         /* 4 beta: eps_mp doubled = 2 stretch + 4 beta max|2 theta + theta| */
  double least_strain;        /* 2 S_t */
  double soft_end, soft;      /* intact part on the first line: soft_end + soft/(2 eps_mp) */
  double tail_end, tail;      /* and on the second */
  double rate, zeta_rate;     /* of c.dv to stretch rate over rate_0, times L/s; the same times zeta */
  double axial;               /* EA/(2 s) */
  double shear;               /* 2 EI/s^3: bend_i + bend_j = 3 (theta_i + theta_j) */
  double moment;              /* -2 EI/s */
} constants;

/* X(buffer of a row's bonds): their length a multiple of LANES, with LANES more before and behind */
#define BUFFERS(X)                                                                                 \
  X(c_x) X(c_y)                  /* chord now, m */                                                \
  X(inverse)                     /* s/L */                                                         \
  X(ratio)                       /* L/s */                                                         \
  X(twice)                       /* twice the stretch */                                           \
  X(bend_i) X(bend_j)            /* 2 theta_i + theta_j and the reverse, rad */

enum { FORCE_X, FORCE_Y, MOMENT_I, MOMENT_J, PLANES };

struct handwritten {
  const problem *problem;
  constants c;
  direction directions[3];
  double *u[3], *v[3];        /* [size] */
  double *intact;             /* [3 * size] 1 - damage; 0 where no bond is: no force without a test */
  double *held;               /* [3 * size] 1 where the damage must stay, else 0 */
  unsigned char *row_held;    /* [row_count] some bond of the row is held */
#define X(name) double *name;
  BUFFERS(X)
#undef X
  double *force[2][3][PLANES]; /* [parity of the row][direction] */
  double kick[3], limit[3];
  long rare;
};

/* --- the bonds of one direction of a row ------------------------------------------------------ */

/* Chords and lengths. True when a bond that exists moved too far for the series. With sigma = sqrt(1 + h) - 1:
   2 sigma = h - sigma^2, which forgives the cancellation in the sigma on the right. */
static bool find_lengths(handwritten *h, const direction *k, long site, long far_site, const double *intact) {
  const constants c = h->c;
  const double *i_x = h->u[0] + site, *i_y = h->u[1] + site, *j_x = h->u[0] + far_site, *j_y = h->u[1] + far_site;
  const double chord_x = k->chord_x, chord_y = k->chord_y, unit_x = 2 * k->unit_x, unit_y = 2 * k->unit_y;
  double *to_x = h->c_x, *to_y = h->c_y, *to_inverse = h->inverse, *to_ratio = h->ratio, *to_twice = h->twice;
  const long count = h->problem->lattice->pitch;
  unsigned far = 0;
  UNROLL
  for (long q = 0; q < count; q += LANES) {
    const lanes d_x = lanes_load(j_x + q) - lanes_load(i_x + q), d_y = lanes_load(j_y + q) - lanes_load(i_y + q);
    const lanes square = d_x * d_x + d_y * d_y;
    const lanes growth = (unit_x * d_x + unit_y * d_y) + square * c.per_square; /* (L/s)^2 - 1 */
    const lanes ratio_square = lanes_max(1 + growth, lanes_all(0.125));
    const lanes inverse = lanes_inverse_root(ratio_square), ratio = ratio_square * inverse;
    const lanes rough = ratio - 1;
    lanes_store(to_x + q, chord_x + d_x);
    lanes_store(to_y + q, chord_y + d_y);
    lanes_store(to_inverse + q, inverse);
    lanes_store(to_ratio + q, ratio);
    lanes_store(to_twice + q, growth - rough * rough);
    far |= lanes_above(square, c.near_square, lanes_load(intact + q));
  }
  return far != 0;
}

/* End rotations less the chord's, by the arc sine's series. True when a bond that exists may have to be wrapped. */
static bool find_rotations(handwritten *h, const direction *k, long site, long far_site, const double *intact) {
  const double *i_turn = h->u[2] + site, *j_turn = h->u[2] + far_site;
  const double unit_x = k->unit_x, unit_y = k->unit_y;
  const double *c_x = h->c_x, *c_y = h->c_y, *from_inverse = h->inverse;
  double *to_i = h->bend_i, *to_j = h->bend_j;
  const long count = h->problem->lattice->pitch;
  unsigned far = 0;
  UNROLL
  for (long q = 0; q < count; q += LANES) {
    const lanes sine = (unit_x * lanes_load(c_y + q) - unit_y * lanes_load(c_x + q)) * lanes_load(from_inverse + q);
    const lanes z = sine * sine, z_2 = z * z;
    const lanes excess = ((1.0 / 6) + z * (3.0 / 40)) + z_2 * (((5.0 / 112) + z * (35.0 / 1152)) + z_2 * (63.0 / 2816));
    const lanes turn = sine + (sine * z) * excess;
    const lanes theta_i = lanes_load(i_turn + q) - turn, theta_j = lanes_load(j_turn + q) - turn;
    const lanes both = theta_i + theta_j, bend_i = both + theta_i, bend_j = both + theta_j;
    lanes_store(to_i + q, bend_i);
    lanes_store(to_j + q, bend_j);
    far |= lanes_above(lanes_max(lanes_abs(bend_i), lanes_abs(bend_j)), 3, lanes_load(intact + q));
  }
  return far != 0;
}

static double wrapped(double angle) { return remainder(angle, 2 * M_PI); }

/* The same for the bonds beyond the series, with the full arc tangent: they are few. */
static __attribute__((noinline, cold)) void find_far(handwritten *h, const direction *k, long site, long far_site,
                                                     const double *intact) {
  const constants *c = &h->c;
  for (long q = 0; q < h->problem->lattice->pitch; q++) {
    const double d_x = h->u[0][far_site + q] - h->u[0][site + q], d_y = h->u[1][far_site + q] - h->u[1][site + q];
    const double c_x = h->c_x[q], c_y = h->c_y[q], square = d_x * d_x + d_y * d_y;
    if (!(intact[q] > 0)) continue;
    if (square <= c->near_square && fmax(fabs(h->bend_i[q]), fabs(h->bend_j[q])) <= 3) continue;
    const double ratio = sqrt((c_x * c_x + c_y * c_y) * c->per_square);
    const double turn = atan2(k->unit_x * d_y - k->unit_y * d_x, k->unit_x * c_x + k->unit_y * c_y);
    const double theta_i = wrapped(h->u[2][site + q] - turn), theta_j = wrapped(h->u[2][far_site + q] - turn);
    h->ratio[q] = ratio;
    h->inverse[q] = 1 / ratio;
    h->twice[q] = 2 * (2 * (k->unit_x * d_x + k->unit_y * d_y) + square * c->per_square) / (ratio + 1);
    h->bend_i[q] = 2 * theta_i + theta_j;
    h->bend_j[q] = 2 * theta_j + theta_i;
    h->rare++;
  }
}

/* Damage as the part that is left. On the curve's two lines that part is linear in 1/strain, and the curve is the larger
   of the two, and zero: no case is chosen. */
LANES_FUNCTION void find_damage(handwritten *h, double *intact, const double *held) {
  const constants c = h->c;
  const double *twice = h->twice, *bend_i = h->bend_i, *bend_j = h->bend_j;
  const long count = h->problem->lattice->pitch;
  UNROLL
  for (long q = 0; q < count; q += LANES) {
    const lanes bend = lanes_max(lanes_abs(lanes_load(bend_i + q)), lanes_abs(lanes_load(bend_j + q)));
    const lanes strain = lanes_load(twice + q) + c.bend_weight * bend;
    const lanes per = 1 / lanes_max(strain, lanes_all(c.least_strain));
    const lanes left = lanes_max(c.soft_end + c.soft * per, c.tail_end + c.tail * per);
    const lanes floor = held ? lanes_load(held + q) : lanes_all(0);
    lanes_store(intact + q, lanes_min(lanes_load(intact + q), lanes_max(left, floor)));
  }
}

static void damage_of_row(handwritten *h, double *intact) { find_damage(h, intact, NULL); }
static void damage_of_held_row(handwritten *h, double *intact, const double *held) { find_damage(h, intact, held); }

static void find_forces(handwritten *h, long site, long far_site, const double *intact, double *const to[PLANES]) {
  const constants c = h->c;
  const double *i_x = h->v[0] + site, *i_y = h->v[1] + site, *j_x = h->v[0] + far_site, *j_y = h->v[1] + far_site;
  const double *from_x = h->c_x, *from_y = h->c_y, *from_inverse = h->inverse, *from_ratio = h->ratio;
  const double *from_twice = h->twice, *from_i = h->bend_i, *from_j = h->bend_j;
  double *to_x = to[FORCE_X], *to_y = to[FORCE_Y], *to_i = to[MOMENT_I], *to_j = to[MOMENT_J];
  const long count = h->problem->lattice->pitch;
  UNROLL
  for (long q = 0; q < count; q += LANES) {
    const lanes c_x = lanes_load(from_x + q), c_y = lanes_load(from_y + q);
    const lanes speed = c_x * (lanes_load(j_x + q) - lanes_load(i_x + q)) +
                        c_y * (lanes_load(j_y + q) - lanes_load(i_y + q));
    const lanes damper = (c.zeta_rate * speed) / (lanes_load(from_ratio + q) + lanes_abs(c.rate * speed));
    const lanes left = lanes_load(intact + q), inverse = lanes_load(from_inverse + q), twice = lanes_load(from_twice + q);
    const lanes bend_i = lanes_load(from_i + q), bend_j = lanes_load(from_j + q);
    const lanes left_inverse = left * inverse, left_moment = left * c.moment;
    const lanes axial = (c.axial * left_inverse) * (twice + lanes_abs(twice) * damper);        /* N/L */
    const lanes shear = (left_inverse * inverse) * (c.shear * (bend_i + bend_j));              /* V/L */
    lanes_store(to_x + q, axial * c_x + shear * c_y);
    lanes_store(to_y + q, axial * c_y - shear * c_x);
    lanes_store(to_i + q, left_moment * bend_i);
    lanes_store(to_j + q, left_moment * bend_j);
  }
}

static void evaluate(handwritten *h, int row, int d) {
  const rows *g = h->problem->lattice;
  const direction *k = &h->directions[d];
  const long site = rows_start(g, row), far_site = site + k->offset[row & 1];
  double *intact = h->intact + d * g->size + site;
  bool far = find_lengths(h, k, site, far_site, intact);
  far |= find_rotations(h, k, site, far_site, intact);
  if (__builtin_expect(far, false)) find_far(h, k, site, far_site, intact);
  if (h->row_held[row])
    damage_of_held_row(h, intact, h->held + d * g->size + site);
  else
    damage_of_row(h, intact);
  find_forces(h, site, far_site, intact, h->force[row & 1][d]);
}

/* --- the particles of a row ------------------------------------------------------------------- */

/* Kick and drift of one component. Nonzero when a velocity is beyond its limit or no number. */
LANES_FUNCTION unsigned move(handwritten *h, int row, int d, int own, int incoming, double sign) {
  const rows *g = h->problem->lattice;
  const int parity = row & 1;
  const double *const own_0 = h->force[parity][0][own], *const own_1 = h->force[parity][1][own];
  const double *const own_2 = h->force[parity][2][own], *const in_0 = h->force[parity][0][incoming] - 1;
  const double *const in_1 = h->force[!parity][1][incoming] - (h->directions[1].offset[!parity] - g->pitch);
  const double *const in_2 = h->force[!parity][2][incoming] - (h->directions[2].offset[!parity] - g->pitch);
  double *const v = h->v[d] + rows_start(g, row), *const u = h->u[d] + rows_start(g, row);
  const double kick = h->kick[d], time_step = h->problem->time_step, limit = h->limit[d];
  const long count = g->pitch;
  unsigned beyond = 0;
  UNROLL
  for (long q = 0; q < count; q += LANES) {
    const lanes owned = (lanes_load(own_0 + q) + lanes_load(own_1 + q)) + lanes_load(own_2 + q);
    const lanes others = (lanes_load(in_0 + q) + lanes_load(in_1 + q)) + lanes_load(in_2 + q);
    const lanes now = lanes_load(v + q) + kick * (sign < 0 ? owned - others : owned + others);
    lanes_store(v + q, now);
    lanes_store(u + q, lanes_load(u + q) + time_step * now);
    beyond |= lanes_beyond(now, limit);
  }
  return beyond;
}

static bool move_row(handwritten *h, int row) {
  return (move(h, row, 0, FORCE_X, FORCE_X, -1) | move(h, row, 1, FORCE_Y, FORCE_Y, -1) |
          move(h, row, 2, MOMENT_I, MOMENT_J, 1)) == 0;
}

static size_t stride_bytes(const handwritten *h) {
  return (size_t)(h->problem->lattice->pitch + 2 * LANES) * sizeof(double);
}

bool NAMED(_advance)(handwritten *h, long steps) {
  bool good = true;
  for (long step = 0; step < steps && good; step++) {
    for (int d = 1; d < 3; d++) /* nothing below the first row */
      for (int p = 0; p < PLANES; p++)
        memset(h->force[1][d][p] - LANES, 0, stride_bytes(h));
    for (int row = 0; row < h->problem->lattice->row_count; row++) {
      for (int d = 0; d < 3; d++)
        evaluate(h, row, d);
      good &= move_row(h, row);
    }
  }
  return good;
}

/* --- set-up ----------------------------------------------------------------------------------- */

static double *zeros(long count) {
  const size_t bytes = ((size_t)count * sizeof(double) + PL_ALIGNMENT - 1) / PL_ALIGNMENT * PL_ALIGNMENT;
  double *p = aligned_alloc(PL_ALIGNMENT, bytes);
  if (!p) must_alloc(SIZE_MAX); /* ends the program with the usual message */
  return memset(p, 0, bytes);
}

static double *buffer(const handwritten *h) { return zeros(h->problem->lattice->pitch + 2 * LANES) + LANES; }

static constants constants_of(const problem *p) {
  const bilinear_law *l = &p->law;
  const double s = p->lattice->spacing, EA = problem_axial_rigidity(p), EI = problem_bending_rigidity(p);
  const double soft = (l->alpha2 - l->alpha1) / (l->alpha2 - 1), tail = l->alpha1 / (l->alpha3 - l->alpha2);
  assert(soft >= tail * l->alpha3); /* the curve is convex, so that it is the larger of its lines */
  return (constants){.per_square = 1 / (s * s),
                     .near_square = NEAR_PART * NEAR_PART * s * s,
                     .bend_weight = 4 * l->beta,
                     .least_strain = 2 * l->S_t,
                     .soft_end = 1 - soft,
                     .soft = 2 * soft * l->S_t,
                     .tail_end = -tail,
                     .tail = 2 * tail * l->alpha3 * l->S_t,
                     .rate = 1 / (s * s * l->rate_0),
                     .zeta_rate = l->zeta / (s * s * l->rate_0),
                     .axial = EA / (2 * s),
                     .shear = 2 * EI / (s * s * s),
                     .moment = -2 * EI / s};
}

handwritten *NAMED(_new)(const problem *p) {
  const rows *g = p->lattice;
  const double square = g->spacing * g->spacing;
  handwritten *h = must_calloc(1, sizeof *h);
  h->problem = p;
  h->c = constants_of(p);
  for (int d = 0; d < 3; d++) {
    h->directions[d] = (direction){{g->offset[0][d], g->offset[1][d]}, g->chord[d][0], g->chord[d][1],
                                   g->chord[d][0] / square, g->chord[d][1] / square};
    h->u[d] = zeros(g->size);
    h->v[d] = zeros(g->size);
    h->kick[d] = p->time_step / (d < 2 ? g->mass : g->inertia);
    h->limit[d] = (d < 2 ? g->spacing : M_PI) / p->time_step;
  }
  h->intact = zeros(3 * g->size);
  h->held = zeros(3 * g->size);
  h->row_held = must_calloc((size_t)g->row_count, 1);
#define X(name) h->name = buffer(h);
  BUFFERS(X)
#undef X
  for (int k = 0; k < 6 * PLANES; k++)
    h->force[k / PLANES % 2][k / PLANES / 2][k % PLANES] = buffer(h);
  for (int row = 0; row < g->row_count; row++)
    for (long q = 0; q < 3 * g->pitch; q++) {
      const long d = q / g->pitch, site = rows_start(g, row) + q % g->pitch;
      if (!(g->flags[site] & PL_PROTECTED(d))) continue;
      h->held[d * g->size + site] = 1;
      h->row_held[row] = 1;
    }
  return h;
}

void NAMED(_free)(handwritten *h) {
  for (int d = 0; d < 3; d++) {
    free(h->u[d]);
    free(h->v[d]);
  }
  free(h->intact);
  free(h->held);
  free(h->row_held);
#define X(name) free(h->name - LANES);
  BUFFERS(X)
#undef X
  for (int k = 0; k < 6 * PLANES; k++)
    free(h->force[k / PLANES % 2][k / PLANES / 2][k % PLANES] - LANES);
  free(h);
}

void NAMED(_set)(handwritten *h, const motion *from) {
  const rows *g = h->problem->lattice;
  for (int d = 0; d < 3; d++) {
    memcpy(h->u[d], from->displacement[d], (size_t)g->size * sizeof(double));
    memcpy(h->v[d], from->velocity[d], (size_t)g->size * sizeof(double));
    for (long q = 0; q < g->size; q++)
      h->intact[d * g->size + q] = g->flags[q] & PL_PRESENT(d) ? 1 - from->damage[d * g->size + q] : 0;
  }
  h->rare = 0;
}

void NAMED(_get)(const handwritten *h, motion *to) {
  const rows *g = h->problem->lattice;
  for (int d = 0; d < 3; d++) {
    memcpy(to->displacement[d], h->u[d], (size_t)g->size * sizeof(double));
    memcpy(to->velocity[d], h->v[d], (size_t)g->size * sizeof(double));
    for (long q = 0; q < g->size; q++)
      to->damage[d * g->size + q] = g->flags[q] & PL_PRESENT(d) ? 1 - h->intact[d * g->size + q] : 0;
  }
}

long NAMED(_rare)(const handwritten *h) { return h->rare; }
