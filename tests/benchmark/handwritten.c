#include "tests/benchmark/handwritten.h"

#include <assert.h>
#include <stdlib.h>
#include <string.h>

#include "dsl/base/arena.h"
#include "tests/benchmark/lanes.h"

#ifndef HANDWRITTEN
#define HANDWRITTEN handwritten
#endif
#define JOIN2(a, b) a##b
#define JOIN(a, b)  JOIN2(a, b)
#define NAMED(name) JOIN(HANDWRITTEN, name)

/* Units make most constants one: lengths in spacings s, velocities in s rate_0, forces in EA/2,
   moments in -2 EI/s, rotations in 1/stiffness, where stiffness = 4 EI/(EA s^2).

   Each loop does a part of the work on the bonds of one direction of a row, through buffers that
   stay in the first cache. In one loop a bond would be a chain of some 180 cycles, of which the
   processor cannot keep enough in flight; short chains overlap. What goes into one loop is chosen
   so that additions and multiplications balance. */

/* The series hold while the ends' relative displacement is below this part of the bond's length:
   the chord then turns by less than asin(1/16). And while no particle turned by more than
   TURN_LIMIT no difference of rotations needs wrapping. */
#define NEAR_PART  (1.0 / 16)
#define TURN_LIMIT 3.0

#if defined(__clang__)
#define UNROLL
#else
#define UNROLL _Pragma("GCC unroll 2")
#endif

/* X(buffer of the bonds of one direction of a row). What a value is needed for last stores its
   result in the same place: fewer lines of cache. */
#define BUFFERS(X)                                                                                 \
  X(c_x) /* chord now */                                                                           \
  X(c_y)                                                                                           \
  X(stretch) /* L^2 - 1, then twice the stretch */                                                 \
  X(turn)    /* L times the sine of the chord's rotation, then the rotation */                     \
  X(inverse) /* 1/L */                                                                             \
  X(pull)    /* L, then the axial force of an intact bond, damper included */                      \
  X(bend_i)  /* 2 theta_i + theta_j */                                                             \
  X(bend_j)  /* and the reverse */

enum { FORCE_X, FORCE_Y, MOMENT, PLANES };
enum { SERIES = 4 };
/* Doubles of a buffer: fixed, so that one address serves them all; not near a part of 4 KiB, at
   which distance a store holds up the loads behind it. */
enum { WIDTH = 328, MOST_SITES = WIDTH - 2 * LANES };

struct handwritten {
  const problem *problem;
  long offset[2][3]; /* from a site to its partner: [parity of the row][direction] */
  double chord[3][2];
  double stiffness;
  double series[SERIES]; /* of the arc sine, for rotations in their unit */
  double bend_weight;    /* 4 beta/stiffness: 2 eps_mp = 2 stretch + 4 beta max|2 theta + theta| */
  double least_strain;   /* 2 S_t */
  double soft_end, soft; /* intact part on the first line: soft_end + soft/(2 eps_mp) */
  double tail_end, tail; /* and on the second */
  double zeta;
  double kick[3], drift[3]; /* velocity by force, displacement by velocity, of one step */
  double *u[3], *v[3];      /* [size] */
  double *intact;           /* [3 * size] 1 - damage; 0 where no bond is: no force without a test */
  double *held;             /* [3 * size] 1 where the damage must stay, else 0 */
  unsigned char *row_held;  /* [row_count] some bond of the row is held */
  unsigned char *row_turned; /* [row_count + 1] some particle is beyond TURN_LIMIT */
  long *begin, *count;       /* [row_count] part of the row that holds sites, in whole lanes */
#define X(name) double name[WIDTH] __attribute__((aligned(PL_ALIGNMENT)));
  BUFFERS(X)
#undef X
  double sum[PLANES][WIDTH];            /* forces on the row's particles so far */
  double incoming[2][2][PLANES][WIDTH]; /* what the row's bonds of direction 1, 2 do to the row
                                  above, from place LANES on: [parity of the row] */
  long rare;
};

/* --- the bonds of one direction of a row ------------------------------------------------------ */

typedef struct strip {
  int row, direction;
  long count;     /* a multiple of LANES */
  long near, far; /* sites of the first bond's ends */
  double *intact;
  const double *held;
} strip;

/* Chords and what they grew by. True when a bond that exists moved too far for the series. */
static bool find_chords(handwritten *h, const strip *s) {
  const double *i_x = h->u[0] + s->near, *i_y = h->u[1] + s->near, *j_x = h->u[0] + s->far,
               *j_y = h->u[1] + s->far;
  const double *intact = s->intact, *chord = h->chord[s->direction];
  const double x = chord[0], y = chord[1], stiff_x = h->stiffness * x, stiff_y = h->stiffness * y;
  lanes_marks far = {0};
  UNROLL
  for (long q = 0, count = s->count; q < count; q += LANES) {
    const lanes d_x = lanes_load(j_x + q) - lanes_load(i_x + q),
                d_y = lanes_load(j_y + q) - lanes_load(i_y + q);
    const lanes square = d_x * d_x + d_y * d_y;
    lanes_store(h->c_x + q, x + d_x);
    lanes_store(h->c_y + q, y + d_y);
    lanes_store(h->stretch + q, ((2 * x) * d_x + (2 * y) * d_y) + square);
    lanes_store(h->turn + q, stiff_x * d_y - stiff_y * d_x);
    far |= lanes_above(square, NEAR_PART * NEAR_PART, lanes_load(intact + q));
  }
  return lanes_any(far);
}

/* Where no bond is the ends may even meet; the least length keeps infinities away. */
static void find_lengths(handwritten *h, const strip *s) {
  UNROLL
  for (long q = 0, count = s->count; q < count; q += LANES) {
    const lanes square = lanes_max(1 + lanes_load(h->stretch + q), lanes_all(1e-6));
    const lanes inverse = lanes_inverse_root(square);
    lanes_store(h->inverse + q, inverse);
    lanes_store(h->pull + q, square * inverse);
  }
}

/* Two independent chains: the chord's rotation by the arc sine's series; stretch and damper. With
   sigma = sqrt(1 + h) - 1: 2 sigma = h - sigma^2, which forgives the cancellation in the sigma on
   the right. */
static void find_turns_and_pulls(handwritten *h, const strip *s) {
  const double *i_x = h->v[0] + s->near, *i_y = h->v[1] + s->near, *j_x = h->v[0] + s->far,
               *j_y = h->v[1] + s->far;
  const double zeta = h->zeta, a = h->series[0], b = h->series[1], c = h->series[2],
               d = h->series[3];
  UNROLL
  for (long q = 0, count = s->count; q < count; q += LANES) {
    const lanes sine = lanes_load(h->turn + q) * lanes_load(h->inverse + q);
    const lanes speed = lanes_load(h->c_x + q) * (lanes_load(j_x + q) - lanes_load(i_x + q)) +
                        lanes_load(h->c_y + q) * (lanes_load(j_y + q) - lanes_load(i_y + q));
    const lanes z = sine * sine, length = lanes_load(h->pull + q);
    const lanes damper = (zeta * speed) / (length + lanes_abs(speed));
    lanes_store(h->turn + q, sine + (sine * z) * ((a + z * b) + (z * z) * (c + z * d)));
    const lanes rough = length - 1, twice = lanes_load(h->stretch + q) - rough * rough;
    lanes_store(h->stretch + q, twice);
    lanes_store(h->pull + q, twice + lanes_abs(twice) * damper);
  }
}

/* Chords that turned too far for the series, by the arc tangent. Whole turns are taken from the
   chord once, not from both ends: they could differ only in a bond bent by half a turn, which has
   no strength left. */
static __attribute__((noinline, cold)) void find_far_turns(handwritten *h, const strip *s) {
  const double x = h->chord[s->direction][0], y = h->chord[s->direction][1];
  for (long q = 0; q < s->count; q++) {
    if (!(s->intact[q] > 0)) continue;
    const double along = x * h->c_x[q] + y * h->c_y[q], across = x * h->c_y[q] - y * h->c_x[q];
    const double turn = atan2(across, along), end = h->u[2][s->near + q] / h->stiffness;
    h->turn[q] = h->stiffness * (end - remainder(end - turn, 2 * M_PI));
    h->rare++;
  }
}

/* Damage as the part that is left. On the curve's two lines that part is linear in 1/strain, and
   the curve is the larger of the two, and zero: no case is chosen. */
LANES_FUNCTION void find_damage(handwritten *h, const strip *s, bool with_held) {
  const double *i = h->u[2] + s->near, *j = h->u[2] + s->far, *held = s->held;
  double *intact = s->intact;
  const double weight = h->bend_weight, least = h->least_strain;
  const double soft_end = h->soft_end, soft = h->soft, tail_end = h->tail_end, tail = h->tail;
  UNROLL
  for (long q = 0, count = s->count; q < count; q += LANES) {
    const lanes turn = lanes_load(h->turn + q), theta_i = lanes_load(i + q) - turn,
                theta_j = lanes_load(j + q) - turn;
    const lanes both = theta_i + theta_j, bend_i = both + theta_i, bend_j = both + theta_j;
    const lanes strain =
        lanes_load(h->stretch + q) + weight * lanes_max(lanes_abs(bend_i), lanes_abs(bend_j));
    const lanes per = 1 / lanes_max(strain, lanes_all(least));
    const lanes left = lanes_max(soft_end + soft * per, tail_end + tail * per);
    const lanes floor = with_held ? lanes_load(held + q) : lanes_all(0);
    lanes_store(h->bend_i + q, bend_i);
    lanes_store(h->bend_j + q, bend_j);
    lanes_store(intact + q, lanes_min(lanes_load(intact + q), lanes_max(left, floor)));
  }
}

static void damage_of_row(handwritten *h, const strip *s) {
  find_damage(h, s, false);
}
static void damage_of_held_row(handwritten *h, const strip *s) {
  find_damage(h, s, true);
}

/* Everything about the strip's bonds but their forces. */
static void find_bonds(handwritten *h, const strip *s) {
  const bool far = find_chords(h, s) || h->row_turned[s->row] || h->row_turned[s->row + 1];
  find_lengths(h, s);
  find_turns_and_pulls(h, s);
  if (__builtin_expect(far, false)) find_far_turns(h, s);
  if (h->row_held[s->row])
    damage_of_held_row(h, s);
  else
    damage_of_row(h, s);
}

typedef struct forces {
  lanes x, y, moment_i, moment_j;
} forces;

LANES_FUNCTION forces bond_forces(const handwritten *h, const double *intact, long q) {
  const lanes c_x = lanes_load(h->c_x + q), c_y = lanes_load(h->c_y + q),
              inverse = lanes_load(h->inverse + q);
  const lanes bend_i = lanes_load(h->bend_i + q), bend_j = lanes_load(h->bend_j + q),
              left = lanes_load(intact + q);
  const lanes left_inverse = left * inverse,
              axial = left_inverse * lanes_load(h->pull + q);       /* N/L */
  const lanes shear = (left_inverse * inverse) * (bend_i + bend_j); /* V/L */
  return (forces){axial * c_x + shear * c_y, axial * c_y - shear * c_x, left * bend_i,
                  left * bend_j};
}

/* Bonds to the row above: kept for its turn, and summed up with what the same direction brings from
 * below. */
LANES_FUNCTION void add_forces(handwritten *h, const strip *s, bool first) {
  const int d = s->direction, parity = s->row & 1;
  const long begin = h->begin[s->row] + LANES,
             shift = begin - (h->offset[!parity][d] - h->problem->lattice->pitch);
  double(*up)[WIDTH] = h->incoming[parity][d - 1], (*below)[WIDTH] = h->incoming[!parity][d - 1];
  const double *intact = s->intact;
  UNROLL
  for (long q = 0, count = s->count; q < count; q += LANES) {
    const forces f = bond_forces(h, intact, q);
    const lanes x = f.x - lanes_load(below[FORCE_X] + shift + q),
                y = f.y - lanes_load(below[FORCE_Y] + shift + q);
    const lanes m = f.moment_i + lanes_load(below[MOMENT] + shift + q);
    lanes_store(up[FORCE_X] + begin + q, f.x);
    lanes_store(up[FORCE_Y] + begin + q, f.y);
    lanes_store(up[MOMENT] + begin + q, f.moment_j);
    lanes_store(h->sum[FORCE_X] + q, first ? x : x + lanes_load(h->sum[FORCE_X] + q));
    lanes_store(h->sum[FORCE_Y] + q, first ? y : y + lanes_load(h->sum[FORCE_Y] + q));
    lanes_store(h->sum[MOMENT] + q, first ? m : m + lanes_load(h->sum[MOMENT] + q));
  }
}

static void first_forces(handwritten *h, const strip *s) {
  add_forces(h, s, true);
}
static void second_forces(handwritten *h, const strip *s) {
  add_forces(h, s, false);
}

/* Bonds along the row complete the forces on its particles, which move at once. Nonzero when one
 * turned too far. */
static bool move_particles(handwritten *h, const strip *s) {
  const double *intact = s->intact;
  double *u_x = h->u[0] + s->near, *u_y = h->u[1] + s->near, *turn = h->u[2] + s->near;
  double *v_x = h->v[0] + s->near, *v_y = h->v[1] + s->near, *spin = h->v[2] + s->near;
  const double kick = h->kick[0], kick_turn = h->kick[2], drift = h->drift[0],
               drift_turn = h->drift[2];
  const double limit = TURN_LIMIT * h->stiffness;
  forces before = {lanes_all(0), lanes_all(0), lanes_all(0), lanes_all(0)};
  lanes_marks beyond = {0};
  UNROLL
  for (long q = 0, count = s->count; q < count; q += LANES) {
    const forces f = bond_forces(h, intact, q);
    const lanes x = lanes_load(h->sum[FORCE_X] + q) + (f.x - lanes_shift_in(before.x, f.x));
    const lanes y = lanes_load(h->sum[FORCE_Y] + q) + (f.y - lanes_shift_in(before.y, f.y));
    const lanes m =
        lanes_load(h->sum[MOMENT] + q) + (f.moment_i + lanes_shift_in(before.moment_j, f.moment_j));
    const lanes now_x = lanes_load(v_x + q) + kick * x, now_y = lanes_load(v_y + q) + kick * y;
    const lanes now = lanes_load(spin + q) + kick_turn * m,
                turned = lanes_load(turn + q) + drift_turn * now;
    before = f;
    lanes_store(v_x + q, now_x);
    lanes_store(v_y + q, now_y);
    lanes_store(spin + q, now);
    lanes_store(u_x + q, lanes_load(u_x + q) + drift * now_x);
    lanes_store(u_y + q, lanes_load(u_y + q) + drift * now_y);
    lanes_store(turn + q, turned);
    beyond |= lanes_beyond(turned, limit);
  }
  return lanes_any(beyond);
}

/* --- a step ----------------------------------------------------------------------------------- */

static strip strip_of(const handwritten *h, int row, int d) {
  const rows *g = h->problem->lattice;
  const long near = rows_start(g, row) + h->begin[row];
  return (strip){row,
                 d,
                 h->count[row],
                 near,
                 near + h->offset[row & 1][d],
                 h->intact + d * g->size + near,
                 h->held + d * g->size + near};
}

/* No force comes from a row below the first, nor from places of a row without sites. */
static void clear_incoming(handwritten *h, int parity) {
  memset(h->incoming[parity], 0, sizeof h->incoming[parity]);
}

static void advance_row(handwritten *h, int row) {
  const strip along = strip_of(h, row, 0), right = strip_of(h, row, 1), left = strip_of(h, row, 2);
  if (h->count[row] < h->problem->lattice->pitch) clear_incoming(h, row & 1);
  find_bonds(h, &right);
  first_forces(h, &right);
  find_bonds(h, &left);
  second_forces(h, &left);
  find_bonds(h, &along);
  h->row_turned[row] = move_particles(h, &along);
}

void NAMED(_advance)(handwritten *h, long steps) {
  for (long step = 0; step < steps; step++) {
    clear_incoming(h, 1);
    for (int row = 0; row < h->problem->lattice->row_count; row++)
      advance_row(h, row);
  }
}

/* --- set-up ----------------------------------------------------------------------------------- */

static double *zeros(long count) {
  const size_t bytes =
      ((size_t)count * sizeof(double) + PL_ALIGNMENT - 1) / PL_ALIGNMENT * PL_ALIGNMENT;
  double *p = aligned_alloc(PL_ALIGNMENT, bytes);
  if (!p) must_alloc(SIZE_MAX); /* ends the program with the usual message */
  return memset(p, 0, bytes);
}

/* (asin(x)/x - 1)/x^2 in x^2 through Chebyshev's points of |x| < 1/16: asin(x) to 2^-52. */
static const double arc_sine[SERIES] = {0x1.5555555554f92p-3, 0x1.3333334a3f0fap-4,
                                        0x1.6db5f5154638dp-5, 0x1.f4a7447a72cffp-6};

static void set_law(handwritten *h) {
  const problem *p = h->problem;
  const bilinear_law *l = &p->law;
  const double s = p->lattice->spacing, EA = problem_axial_rigidity(p),
               EI = problem_bending_rigidity(p);
  const double soft = (l->alpha2 - l->alpha1) / (l->alpha2 - 1),
               tail = l->alpha1 / (l->alpha3 - l->alpha2);
  assert(soft >= tail * l->alpha3); /* the curve is convex, so that it is the larger of its lines */
  h->stiffness = 4 * EI / (EA * s * s);
  assert(h->stiffness > 0);
  for (int k = 0; k < SERIES; k++)
    h->series[k] = arc_sine[k] / pow(h->stiffness, 2 * k + 2);
  h->bend_weight = 4 * l->beta / h->stiffness;
  h->least_strain = 2 * l->S_t;
  h->soft_end = 1 - soft;
  h->soft = 2 * soft * l->S_t;
  h->tail_end = -tail;
  h->tail = 2 * tail * l->alpha3 * l->S_t;
  h->zeta = l->zeta;
  for (int d = 0; d < 2; d++) {
    h->kick[d] = p->time_step / p->lattice->mass * (EA / 2) / (s * l->rate_0);
    h->drift[d] = p->time_step * l->rate_0;
  }
  h->kick[2] = -p->time_step / p->lattice->inertia * (2 * EI / s);
  h->drift[2] = p->time_step;
}

static void find_spans(handwritten *h) {
  const rows *g = h->problem->lattice;
  h->begin = must_calloc((size_t)g->row_count, sizeof *h->begin);
  h->count = must_calloc((size_t)g->row_count, sizeof *h->count);
  for (int row = 0; row < g->row_count; row++) {
    const unsigned char *present = g->present + rows_start(g, row);
    long first = 0, end = g->pitch;
    while (first < end && !present[first])
      first++;
    while (end > first && !present[end - 1])
      end--;
    h->begin[row] = first / LANES * LANES;
    h->count[row] = (end - h->begin[row] + LANES - 1) / LANES * LANES;
  }
}

static void hold_bonds(handwritten *h) {
  const rows *g = h->problem->lattice;
  for (int row = 0; row < g->row_count; row++)
    for (long q = 0; q < 3 * g->pitch; q++) {
      const long d = q / g->pitch, site = rows_start(g, row) + q % g->pitch;
      if (!(g->held_bonds[site] >> d & 1)) continue;
      h->held[d * g->size + site] = 1;
      h->row_held[row] = 1;
    }
}

handwritten *NAMED(_new)(const problem *p) {
  const rows *g = p->lattice;
  assert(g->pitch <= MOST_SITES);
  handwritten *h = (void *)zeros((long)(sizeof *h / sizeof(double)));
  h->problem = p;
  for (int d = 0; d < 3; d++) {
    for (int c = 0; c < 2; c++) {
      h->offset[c][d] = rows_offset(g, c, d);
      h->chord[d][c] = g->chord[d][c] / g->spacing;
    }
    h->u[d] = zeros(g->size);
    h->v[d] = zeros(g->size);
  }
  h->intact = zeros(3 * g->size);
  h->held = zeros(3 * g->size);
  h->row_held = must_calloc((size_t)g->row_count, 1);
  h->row_turned = must_calloc((size_t)g->row_count + 1, 1);
  set_law(h);
  find_spans(h);
  hold_bonds(h);
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
  free(h->row_turned);
  free(h->begin);
  free(h->count);
  free(h);
}

static double length_unit(const handwritten *h, int d) {
  return d < 2 ? h->problem->lattice->spacing : 1 / h->stiffness;
}
static double velocity_unit(const handwritten *h, int d) {
  return length_unit(h, d) * (d < 2 ? h->problem->law.rate_0 : 1);
}

void NAMED(_set)(handwritten *h, const motion *from) {
  const rows *g = h->problem->lattice;
  memset(h->row_turned, 0, (size_t)g->row_count + 1);
  for (int d = 0; d < 3; d++)
    for (long q = 0; q < g->size; q++) {
      const long slot = d * g->size + q;
      h->u[d][q] = from->displacement[d][q] / length_unit(h, d);
      h->v[d][q] = from->velocity[d][q] / velocity_unit(h, d);
      h->intact[slot] = rows_has_bond(g, q, d) ? 1 - from->damage[slot] : 0;
    }
  for (int row = 0; row < g->row_count; row++)
    for (long q = 0; q < g->pitch; q++)
      if (!(fabs(h->u[2][rows_start(g, row) + q]) <= TURN_LIMIT * h->stiffness))
        h->row_turned[row] = 1;
  h->rare = 0;
}

void NAMED(_get)(const handwritten *h, motion *to) {
  const rows *g = h->problem->lattice;
  for (int d = 0; d < 3; d++)
    for (long q = 0; q < g->size; q++) {
      const long slot = d * g->size + q;
      to->displacement[d][q] = h->u[d][q] * length_unit(h, d);
      to->velocity[d][q] = h->v[d][q] * velocity_unit(h, d);
      to->damage[slot] = rows_has_bond(g, q, d) ? 1 - h->intact[slot] : 0;
    }
}

long NAMED(_rare)(const handwritten *h) {
  return h->rare;
}
