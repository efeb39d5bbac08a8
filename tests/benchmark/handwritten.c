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

/* The series hold while the ends' relative displacement is below this part of the bond's length: the chord then turns by
   less than asin(1/16), where five terms of the arc sine leave 2^-53. */
#define NEAR_PART (1.0 / 16)

/* Constants of one direction; lengths in m, forces in N. */
typedef struct direction {
  long offset[2];             /* from a site to its partner, by parity of the row */
  double chord_x, chord_y;
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
  double shear;               /* 6 EI/s^3 */
  double moment;              /* 2 EI/s */
} constants;

struct handwritten {
  const problem *problem;
  constants c;
  direction directions[3];
  double *u[3], *v[3];        /* [size] */
  double *intact;             /* [3 * size] 1 - damage; 0 where no bond is: no force without a test */
  double *held;               /* [3 * size] 1 where the damage must stay, else 0 */
  unsigned char *row_held;    /* [row_count] some bond of the row is held */
  double *up[2];              /* forces of the bonds from the row below: [direction 1, 2][x, y, moment][stride] */
  long stride;
  double kick[3], limit[3];
  long rare;
};

typedef struct ends { /* of eight bonds */
  lanes u_x, u_y, turn, v_x, v_y;
} ends;

typedef struct forces {
  lanes x, y, moment_i, moment_j; /* on i, and the moment on j; the force on j is opposite */
} forces;

/* --- the law ---------------------------------------------------------------------------------- */

/* Damage as the part that is left. On the curve's two lines that part is linear in 1/strain, and the curve is the larger
   of the two, and zero: no case is chosen. */
LANES_FUNCTION lanes intact_part(const constants *c, lanes twice_strain, lanes old, lanes held) {
  const lanes per = 1 / lanes_max(twice_strain, lanes_all(c->least_strain));
  const lanes left = lanes_max(c->soft_end + c->soft * per, c->tail_end + c->tail * per);
  return lanes_min(old, lanes_max(left, held));
}

/* asin(x) - x over x, in x^2: the five terms that matter for |x| < 1/16. */
LANES_FUNCTION lanes arc_sine_excess(lanes z) {
  return z * (1.0 / 6 + z * (3.0 / 40 + z * (5.0 / 112 + z * (35.0 / 1152 + z * (63.0 / 2816)))));
}

/* With sigma = sqrt(1 + h) - 1: 2 sigma = h - sigma^2, which forgives the cancellation in the sigma on the right. */
LANES_FUNCTION lanes twice_stretch(lanes h, lanes ratio) {
  const lanes rough = ratio - 1;
  return h - rough * rough;
}

/* Forces of eight bonds and their new intact part. False when one that exists is beyond the series. */
LANES_FUNCTION bool bond_forces(const constants *c, const direction *k, const ends *i, const ends *j,
                                lanes held, lanes *intact, forces *f) {
  const lanes d_x = j->u_x - i->u_x, d_y = j->u_y - i->u_y;
  const lanes c_x = k->chord_x + d_x, c_y = k->chord_y + d_y;
  const lanes square = d_x * d_x + d_y * d_y;
  const lanes h = 2 * (k->unit_x * d_x + k->unit_y * d_y) + square * c->per_square; /* (L/s)^2 - 1 */
  const lanes ratio_square = lanes_max(1 + h, lanes_all(0.125));
  const lanes inverse = lanes_inverse_root(ratio_square); /* s/L */
  const lanes ratio = ratio_square * inverse;
  const lanes sine = (k->unit_x * d_y - k->unit_y * d_x) * inverse;
  const lanes turn = sine + sine * arc_sine_excess(sine * sine);
  const lanes theta_i = i->turn - turn, theta_j = j->turn - turn, both = theta_i + theta_j;
  const lanes bend_i = both + theta_i, bend_j = both + theta_j;
  const lanes bend = lanes_max(lanes_abs(bend_i), lanes_abs(bend_j));

  const lanes twice = twice_stretch(h, ratio), old = *intact;
  if (__builtin_expect(lanes_any_above(square, lanes_all(c->near_square), old) ||
                           lanes_any_above(bend, lanes_all(3), old), 0))
    return false;
  const lanes left = intact_part(c, twice + c->bend_weight * bend, old, held);
  const lanes speed = c_x * (j->v_x - i->v_x) + c_y * (j->v_y - i->v_y);
  const lanes damper = (c->zeta_rate * speed) / (ratio + lanes_abs(c->rate * speed));

  const lanes left_inverse = left * inverse, left_moment = left * c->moment;
  const lanes axial = (c->axial * left_inverse) * (twice + lanes_abs(twice) * damper); /* N/L */
  const lanes shear = (c->shear * left_inverse) * (inverse * both);                    /* V/L */
  f->x = axial * c_x + shear * c_y;
  f->y = axial * c_y - shear * c_x;
  f->moment_i = -left_moment * bend_i;
  f->moment_j = -left_moment * bend_j;
  *intact = left;
  return true;
}

static double wrapped(double angle) { return remainder(angle, 2 * M_PI); }

/* The same law for any displacement and rotation, bond by bond: those beyond the series are few. */
static __attribute__((noinline, cold)) void bond_forces_far(const constants *c, const direction *k, const ends *i,
                                                            const ends *j, lanes held, lanes *intact, forces *f) {
  *f = (forces){lanes_all(0), lanes_all(0), lanes_all(0), lanes_all(0)};
  for (int l = 0; l < LANES; l++) {
    if (!((*intact)[l] > 0)) continue;
    const double d_x = j->u_x[l] - i->u_x[l], d_y = j->u_y[l] - i->u_y[l];
    const double c_x = k->chord_x + d_x, c_y = k->chord_y + d_y;
    const double ratio = sqrt((c_x * c_x + c_y * c_y) * c->per_square), inverse = 1 / ratio;
    const double h = 2 * (k->unit_x * d_x + k->unit_y * d_y) + (d_x * d_x + d_y * d_y) * c->per_square;
    const double twice = 2 * h / (ratio + 1);
    const double turn = atan2(k->unit_x * d_y - k->unit_y * d_x, k->unit_x * c_x + k->unit_y * c_y);
    const double theta_i = wrapped(i->turn[l] - turn), theta_j = wrapped(j->turn[l] - turn);
    const double bend_i = 2 * theta_i + theta_j, bend_j = 2 * theta_j + theta_i;
    const double strain = twice + c->bend_weight * fmax(fabs(bend_i), fabs(bend_j));
    const double per = 1 / fmax(strain, c->least_strain);
    const double on_curve = fmax(c->soft_end + c->soft * per, c->tail_end + c->tail * per);
    const double left = fmin((*intact)[l], fmax(on_curve, held[l]));
    const double speed = c_x * (j->v_x[l] - i->v_x[l]) + c_y * (j->v_y[l] - i->v_y[l]);
    const double damper = c->zeta_rate * speed / (ratio + fabs(c->rate * speed));
    const double axial = c->axial * left * inverse * (twice + fabs(twice) * damper);
    const double shear = c->shear * left * inverse * inverse * (theta_i + theta_j);
    f->x[l] = axial * c_x + shear * c_y;
    f->y[l] = axial * c_y - shear * c_x;
    f->moment_i[l] = -c->moment * left * bend_i;
    f->moment_j[l] = -c->moment * left * bend_j;
    (*intact)[l] = left;
  }
}

/* --- a row ------------------------------------------------------------------------------------ */

LANES_FUNCTION ends load_ends(const handwritten *h, long site) {
  return (ends){lanes_load(h->u[0] + site), lanes_load(h->u[1] + site), lanes_load(h->u[2] + site),
                lanes_load(h->v[0] + site), lanes_load(h->v[1] + site)};
}

LANES_FUNCTION forces evaluate(handwritten *h, int d, int parity, long site, const ends *i, bool held) {
  const direction *k = &h->directions[d];
  const ends j = load_ends(h, site + k->offset[parity]);
  double *at = h->intact + d * h->problem->lattice->size + site;
  const lanes stays = held ? lanes_load(h->held + d * h->problem->lattice->size + site) : lanes_all(0);
  lanes intact = lanes_load(at);
  forces f;
  if (!bond_forces(&h->c, k, i, &j, stays, &intact, &f)) {
    h->rare++;
    bond_forces_far(&h->c, k, i, &j, stays, &intact, &f);
  }
  lanes_store(at, intact);
  return f;
}

LANES_FUNCTION double *up_plane(const handwritten *h, int parity, int d, int component) {
  return h->up[parity] + ((d - 1) * 3 + component) * h->stride + LANES;
}

/* Kick and drift of one component. Nonzero when a velocity is beyond its limit or no number. */
LANES_FUNCTION unsigned move(handwritten *h, int d, long site, lanes old, lanes u, lanes force) {
  const lanes v = old + h->kick[d] * force;
  lanes_store(h->v[d] + site, v);
  lanes_store(h->u[d] + site, u + h->problem->time_step * v);
  return lanes_beyond(v, h->limit[d]);
}

/* Forces of the bonds that the row owns, and its particles moved: each group of eight needs the group before it (for the
   bonds along the row) and the row below. */
LANES_FUNCTION bool advance_row(handwritten *h, int row, bool held) {
  const rows *g = h->problem->lattice;
  const int parity = row & 1;
  const long start = rows_start(g, row);
  const long below_1 = h->directions[1].offset[!parity] - g->pitch, below_2 = h->directions[2].offset[!parity] - g->pitch;
  forces before = {lanes_all(0), lanes_all(0), lanes_all(0), lanes_all(0)};
  unsigned beyond = 0;
  for (long q = 0; q < g->pitch; q += LANES) {
    const long site = start + q;
    const ends i = load_ends(h, site);
    const forces a = evaluate(h, 0, parity, site, &i, held);
    const forces b = evaluate(h, 1, parity, site, &i, held);
    const forces c = evaluate(h, 2, parity, site, &i, held);
    lanes_store(up_plane(h, parity, 1, 0) + q, b.x);
    lanes_store(up_plane(h, parity, 1, 1) + q, b.y);
    lanes_store(up_plane(h, parity, 1, 2) + q, b.moment_j);
    lanes_store(up_plane(h, parity, 2, 0) + q, c.x);
    lanes_store(up_plane(h, parity, 2, 1) + q, c.y);
    lanes_store(up_plane(h, parity, 2, 2) + q, c.moment_j);
    const lanes f_x = a.x + b.x + c.x - lanes_shift_in(before.x, a.x) -
                      lanes_load(up_plane(h, !parity, 1, 0) + q - below_1) -
                      lanes_load(up_plane(h, !parity, 2, 0) + q - below_2);
    const lanes f_y = a.y + b.y + c.y - lanes_shift_in(before.y, a.y) -
                      lanes_load(up_plane(h, !parity, 1, 1) + q - below_1) -
                      lanes_load(up_plane(h, !parity, 2, 1) + q - below_2);
    const lanes moment = a.moment_i + b.moment_i + c.moment_i + lanes_shift_in(before.moment_j, a.moment_j) +
                         lanes_load(up_plane(h, !parity, 1, 2) + q - below_1) +
                         lanes_load(up_plane(h, !parity, 2, 2) + q - below_2);
    before = a;
    beyond |= move(h, 0, site, i.v_x, i.u_x, f_x);
    beyond |= move(h, 1, site, i.v_y, i.u_y, f_y);
    beyond |= move(h, 2, site, lanes_load(h->v[2] + site), i.turn, moment);
  }
  return beyond == 0;
}

static bool free_row(handwritten *h, int row) { return advance_row(h, row, false); }
static bool held_row(handwritten *h, int row) { return advance_row(h, row, true); }

bool NAMED(_advance)(handwritten *h, long steps) {
  bool good = true;
  for (long step = 0; step < steps && good; step++) {
    memset(h->up[1], 0, (size_t)(6 * h->stride) * sizeof(double)); /* nothing below the first row */
    for (int row = 0; row < h->problem->lattice->row_count; row++)
      good &= h->row_held[row] ? held_row(h, row) : free_row(h, row);
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
                     .shear = 6 * EI / (s * s * s),
                     .moment = 2 * EI / s};
}

handwritten *NAMED(_new)(const problem *p) {
  const rows *g = p->lattice;
  const double square = g->spacing * g->spacing;
  handwritten *h = must_calloc(1, sizeof *h);
  h->problem = p;
  h->c = constants_of(p);
  h->stride = g->pitch + 2 * LANES;
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
  h->up[0] = zeros(6 * h->stride);
  h->up[1] = zeros(6 * h->stride);
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
  free(h->up[0]);
  free(h->up[1]);
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
