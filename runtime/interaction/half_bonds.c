#include "runtime/interaction/half_bonds.h"

#include <stdlib.h>
#include <string.h>

#include "dsl/base/arena.h"
#include "runtime/base/lane_sum.h"
#include "runtime/base/pool.h"

/* Those of one direction, side by side, filled up to whole vectors. */
typedef struct direction_bonds {
  int direction;
  long count, room;
  half_bond *bonds;
  double *uniforms;
  int64_t *flags;                      /* [room] */
  double *ends[4][PL_MAX_DOF];         /* [room] places and velocities of i, of j */
  double **field, **force, **observed; /* [fields], [planes], [1 + outputs][room] */
  double **parameter;                  /* [varying][room] */
  double *lost[PL_LOSSES];             /* [room] J: by states, by rates */
} direction_bonds;

struct half_bonds {
  const sweep *of;
  direction_bonds *parts; /* [directions] */
  pool *memory;           /* of values */
  arena *pointers;
  double booked[2]; /* J: taken by rates, given by rest states, in steps that are done */
};

static double *doubles(half_bonds *h, long count) {
  return pool_doubles(h->memory, count + PL_LANES);
}

static double **planes(half_bonds *h, int count, long room) {
  double **of = arena_alloc(h->pointers, ((size_t)count + 1) * sizeof *of);
  for (int k = 0; k < count; k++)
    of[k] = doubles(h, room);
  return of;
}

/* Of a lattice half as thick. */
static void prepare(half_bonds *h, direction_bonds *p, const double *parameters) {
  pl_bond_class c = rows_bond_class(h->of->lattice, p->direction);
  c.t *= 0.5;
  c.V *= 0.5;
  c.mass_i *= 0.5;
  c.mass_j *= 0.5;
  p->uniforms = doubles(h, h->of->law->uniform_count + 1);
  h->of->law->prepare(h->of->law, parameters, &c, p->uniforms);
}

static void take_parameters(const half_bonds *h, const direction_bonds *p) {
  const sweep *w = h->of;
  for (int k = 0; k < w->law->varying_count; k++)
    for (long n = 0; n < p->count; n++)
      p->parameter[k][n] = w->parameter[k][p->direction * w->lattice->size + p->bonds[n].site];
}

/* Those that the law declares as fields may change in time. */
static bool may_change(const pl_law *law) {
  return law->varying_count > 0 && PL_HAS(law, given) && law->given_count > 0;
}

static void open_direction(half_bonds *h, direction_bonds *p, const double *parameters) {
  const pl_law *law = h->of->law;
  p->room = (p->count + PL_LANES - 1) / PL_LANES * PL_LANES;
  p->flags = (int64_t *)(void *)doubles(h, p->room);
  for (long n = 0; n < p->count; n++)
    p->flags[n] = PL_PRESENT(p->direction) | PL_PROTECTED(p->direction);
  for (int e = 0; e < 4; e++)
    for (int d = 0; d < law->dof; d++)
      p->ends[e][d] = doubles(h, p->room);
  p->field = planes(h, law->field_count, p->room);
  p->force = planes(h, law->force_planes, p->room);
  p->observed = planes(h, 1 + law->output_count, p->room);
  for (int k = 0; k < PL_LOSSES; k++)
    p->lost[k] = doubles(h, p->room);
  prepare(h, p, parameters);
  p->parameter = planes(h, law->varying_count, p->room);
  take_parameters(h, p);
}

half_bonds *half_bonds_new(const sweep *w, const double *parameters, const half_bond *bonds,
                           long count) {
  half_bonds *h = must_calloc(1, sizeof *h);
  const int directions = w->lattice->directions;
  h->of = w;
  h->memory = pool_new();
  h->pointers = arena_new();
  h->parts = must_calloc((size_t)directions, sizeof *h->parts);
  for (int k = 0; k < directions; k++) {
    direction_bonds *p = &h->parts[k];
    p->direction = k;
    p->bonds = must_calloc((size_t)count + 1, sizeof *p->bonds);
    for (long n = 0; n < count; n++)
      if (bonds[n].direction == k) p->bonds[p->count++] = bonds[n];
    open_direction(h, p, parameters);
  }
  return h;
}

void half_bonds_free(half_bonds *h) {
  if (!h) return;
  for (int k = 0; k < h->of->lattice->directions; k++)
    free(h->parts[k].bonds);
  free(h->parts);
  pool_free(h->memory);
  arena_free(h->pointers);
  free(h);
}

/* --- a state ---------------------------------------------------------------------------------- */

static void take_ends(const half_bonds *h, const direction_bonds *p) {
  const body *of = h->of->body;
  for (long n = 0; n < p->count; n++) {
    const long i = p->bonds[n].site, j = rows_partner(of->lattice, i, p->direction);
    for (int d = 0; d < of->dof; d++) {
      p->ends[0][d][n] = of->displacement[d][i];
      p->ends[1][d][n] = of->displacement[d][j];
      p->ends[2][d][n] = of->velocity[d][i];
      p->ends[3][d][n] = of->velocity[d][j];
    }
  }
}

static pl_strip strip_of(const half_bonds *h, const direction_bonds *p) {
  const body *of = h->of->body;
  pl_strip s = {.size = sizeof s,
                .count = p->room,
                .direction = p->direction,
                .flags = p->flags,
                .parameter = (const double *const *)p->parameter,
                .field = p->field,
                .force = p->force,
                .dissipated_state = p->lost[0],
                .dissipated_rate = p->lost[1],
                .given_by_rest = p->lost[2],
                .observed = p->observed,
                .time = of->time,
                .time_step = of->time_step,
                .advance = of->advance};
  for (int d = 0; d < of->dof; d++) {
    s.displacement_i[d] = p->ends[0][d];
    s.displacement_j[d] = p->ends[1][d];
    s.velocity_i[d] = p->ends[2][d];
    s.velocity_j[d] = p->ends[3][d];
  }
  return s;
}

static double lost_now(const half_bonds *h, enum pl_loss to) {
  double sum = 0;
  for (int k = 0; k < h->of->lattice->directions; k++)
    sum += lane_total(h->parts[k].room, h->parts[k].lost[to]);
  return sum;
}

void half_bonds_find(half_bonds *h, bool stepped) {
  const pl_law *law = h->of->law;
  h->booked[0] += stepped ? lost_now(h, PL_LOST_TO_RATES) : 0;
  h->booked[1] += stepped ? lost_now(h, PL_GIVEN_BY_REST) : 0;
  for (int k = 0; k < h->of->lattice->directions; k++) {
    direction_bonds *p = &h->parts[k];
    if (p->count == 0) continue;
    take_ends(h, p);
    if (may_change(law)) take_parameters(h, p);
    for (int f = 0; f < law->field_count; f++)
      for (long n = 0; n < p->room; n++)
        p->field[f][n] = law->fields[f].initial;
    for (int e = 0; e < PL_LOSSES; e++)
      memset(p->lost[e], 0, (size_t)p->room * sizeof(double));
    const pl_strip s = strip_of(h, p);
    (h->of->body->ledger ? law->rows_ledger : law->rows)(law, p->uniforms, &s);
  }
}

/* Forces on j are the opposite of those on i; particles receive the opposite of end moments. */
void half_bonds_add(const half_bonds *h, double *const force[PL_MAX_DOF]) {
  for (int k = 0; k < h->of->lattice->directions; k++) {
    const direction_bonds *p = &h->parts[k];
    for (long n = 0; n < p->count; n++) {
      const int32_t i = p->bonds[n].end[0], j = p->bonds[n].end[1];
      for (int d = 0; d < 2; d++) {
        force[d][i] += p->force[d][n];
        force[d][j] -= p->force[d][n];
      }
      if (h->of->body->dof < 3) continue;
      force[2][i] -= p->force[2][n];
      force[2][j] -= p->force[3][n];
    }
  }
}

double half_bonds_stored(half_bonds *h) {
  double sum = 0;
  for (int k = 0; k < h->of->lattice->directions; k++) {
    const direction_bonds *p = &h->parts[k];
    if (p->count == 0) continue;
    const pl_strip s = strip_of(h, p);
    h->of->law->rows_observe(h->of->law, p->uniforms, &s);
    for (long n = 0; n < p->count; n++)
      sum += p->observed[0][n];
  }
  return sum;
}

double half_bonds_taken(const half_bonds *h) {
  return h->booked[0] + 0.5 * lost_now(h, PL_LOST_TO_RATES);
}

double half_bonds_given(const half_bonds *h) {
  return h->booked[1] + lost_now(h, PL_GIVEN_BY_REST);
}

double *half_bonds_booked(half_bonds *h) {
  return h->booked;
}
