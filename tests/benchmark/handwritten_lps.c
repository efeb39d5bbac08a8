#include <math.h>

#include "tests/benchmark/bond_lanes.h"
#include "tests/benchmark/handwritten_families.h"

/* On a cubic lattice all sites have their neighbours at the same distances in memory: the body is
   one long run, whose rows share the empty columns between them. Two turns over it: dilatations,
   and as far behind as a bond reaches the forces. A bond's stretch is found in both: to keep it
   would take more memory than any cache has.

   A bond adds to its far end while the next ones wait for what was just stored where their own far
   ends overlap; so neighbours of one row are taken far apart. */

enum { MOST = 64 };

typedef struct lps_direction {
  long offset;
  uint64_t bit;
  double chord[3], growth[3]; /* spacings; 2 chord/length^2 */
  double square, length;      /* (1/length)^2; length in spacings */
  double weight;              /* of twice the stretch in the dilatation */
} lps_direction;

typedef struct lps_cubic {
  const family_problem *problem;
  int directions;
  lps_direction direction[MOST];
  long *place;              /* [particles] here, of the particles of the lattice */
  long columns, first, end; /* pitch; sites first <= q < end hold all particles; whole lanes */
  long reach;               /* of bonds, in whole lanes */
  uint64_t *virgin, *bonds; /* [size] bit k: the bond exists; and is not broken */
  double *u[3], *v[3], *force[3];     /* [size] spacings; spacings a step; the same a step, more */
  double *dilated;                    /* [size] sums, then what both ends add to a bond's force */
  double *by_dilatation, *by_stretch; /* [size] of a particle with its weighted volume */
  double twice_limit;                 /* of the stretch */
  long size;
} lps_cubic;

LANES_FUNCTION lanes_marks intact(const lps_cubic *h, long q, const lps_direction *n) {
  return lanes_marked(h->bonds + q, n->bit);
}

LANES_FUNCTION bond_lanes bond_to(const lps_direction *n, const lanes d[3]) {
  return bond_of_growth((n->growth[0] * d[0] + n->growth[1] * d[1] + n->growth[2] * d[2]) +
                        n->square * (d[0] * d[0] + d[1] * d[1] + d[2] * d[2]));
}

/* Rare: the bonds of these sites that are too long break. */
static __attribute__((noinline, cold)) void break_bonds(lps_cubic *h, long q, uint64_t bit,
                                                        lanes twice) {
  for (int l = 0; l < LANES; l++)
    if (twice[l] >= h->twice_limit) h->bonds[q + l] &= ~bit;
}

static void find_dilatations(lps_cubic *h, long q) {
  const double *x = h->u[0] + q, *y = h->u[1] + q, *z = h->u[2] + q;
  const lanes i_x = lanes_load(x), i_y = lanes_load(y), i_z = lanes_load(z);
  const lanes limit = lanes_all(h->twice_limit);
  double *to = h->dilated + q;
  lanes mine = lanes_all(0);
  for (const lps_direction *n = h->direction; n < h->direction + h->directions; n++) {
    const lanes d[3] = {lanes_load(x + n->offset) - i_x, lanes_load(y + n->offset) - i_y,
                        lanes_load(z + n->offset) - i_z};
    lanes twice = lanes_keep(intact(h, q, n), bond_to(n, d).twice);
    const lanes_marks breaks = lanes_least(twice, limit);
    if (__builtin_expect(lanes_any(breaks), 0)) {
      break_bonds(h, q, n->bit, twice);
      twice = lanes_keep(intact(h, q, n), twice);
    }
    const lanes part = n->weight * twice;
    mine += part;
    lanes_store(to + n->offset, lanes_load(to + n->offset) + part);
  }
  lanes_store(to, (lanes_load(to) + mine) * lanes_load(h->by_dilatation + q));
}

static void find_forces(lps_cubic *h, long q) {
  const double *u[3] = {h->u[0] + q, h->u[1] + q, h->u[2] + q};
  const double *dilated = h->dilated + q, *by_stretch = h->by_stretch + q;
  double *force[3] = {h->force[0] + q, h->force[1] + q, h->force[2] + q};
  const lanes i[3] = {lanes_load(u[0]), lanes_load(u[1]), lanes_load(u[2])};
  const lanes i_dilated = lanes_load(dilated), i_stretch = lanes_load(by_stretch);
  lanes mine[3] = {lanes_all(0), lanes_all(0), lanes_all(0)};
  for (const lps_direction *n = h->direction; n < h->direction + h->directions; n++) {
    lanes d[3];
    for (int c = 0; c < 3; c++)
      d[c] = lanes_load(u[c] + n->offset) - i[c];
    const bond_lanes bond = bond_to(n, d);
    const lanes N = (i_dilated + lanes_load(dilated + n->offset)) +
                    (i_stretch + lanes_load(by_stretch + n->offset)) * bond.twice;
    const lanes per_length = lanes_keep(intact(h, q, n), N * bond.inverse);
    for (int c = 0; c < 3; c++) {
      const lanes f = per_length * (n->chord[c] + d[c]);
      mine[c] += f;
      lanes_store(force[c] + n->offset, lanes_load(force[c] + n->offset) - f);
    }
  }
  for (int c = 0; c < 3; c++)
    lanes_store(force[c], lanes_load(force[c]) + mine[c]);
}

static void move_particles(lps_cubic *h, long q) {
  for (int d = 0; d < 3; d++) {
    const lanes next = lanes_load(h->v[d] + q) + lanes_load(h->force[d] + q);
    lanes_store(h->v[d] + q, next);
    lanes_store(h->u[d] + q, lanes_load(h->u[d] + q) + next);
    lanes_store(h->force[d] + q, lanes_all(0));
  }
  lanes_store(h->dilated + q, lanes_all(0));
}

static void advance(void *state, long steps) {
  lps_cubic *h = state;
  for (long step = 0; step < steps; step++)
    for (long q = h->first; q < h->end + h->reach; q += LANES) {
      if (q < h->end) find_dilatations(h, q);
      if (q - h->reach < h->first) continue;
      find_forces(h, q - h->reach);
      move_particles(h, q - h->reach);
    }
}

/* --- set-up ----------------------------------------------------------------------------------- */

/* Round the rows of neighbours: of each the next one, until none is left. */
static void order_directions(lps_cubic *h, const int row_of[MOST]) {
  lps_direction sorted[MOST];
  bool taken[MOST] = {false};
  int count = 0;
  while (count < h->directions) {
    int rows_now[MOST], rows_taken = 0;
    for (int k = 0; k < h->directions; k++) {
      bool again = taken[k];
      for (int r = 0; r < rows_taken && !again; r++)
        again = rows_now[r] == row_of[k];
      if (again) continue;
      taken[k] = true;
      rows_now[rows_taken++] = row_of[k];
      sorted[count++] = h->direction[k];
    }
  }
  memcpy(h->direction, sorted, sizeof sorted);
}

/* Rows with only as many empty columns as the bonds reach. */
static void find_directions(lps_cubic *h) {
  const rows *g = h->problem->lattice;
  const double s = g->spacing;
  int row_of[MOST];
  h->directions = g->directions;
  for (int k = 0; k < g->directions; k++) {
    const double length = g->length[k] / s;
    const long offset = rows_offset(g, 0, k), across = lround((double)offset / (double)g->pitch);
    lps_direction *n = &h->direction[k];
    row_of[k] = (int)across;
    *n = (lps_direction){.offset = across * h->columns + (offset - across * g->pitch),
                         .bit = UINT64_C(1) << k,
                         .square = 1 / (length * length),
                         .length = length,
                         .weight = length * length / 2};
    for (int d = 0; d < 3; d++) {
      n->chord[d] = g->chord[k][d] / s;
      n->growth[d] = 2 * n->chord[d] * n->square;
    }
    while (n->offset > h->reach)
      h->reach += LANES;
  }
  h->reach += LANES;
  order_directions(h, row_of);
}

static void find_places(lps_cubic *h) {
  const rows *g = h->problem->lattice;
  long low = g->pitch, high = 0, columns = 0;
  for (long p = 0; p < g->particle_count; p++) {
    const long column = (g->particle_site[p] - g->first) % g->pitch;
    low = column < low ? column : low;
    high = column > high ? column : high;
  }
  for (int k = 0; k < g->directions; k++)
    if (g->offset[0][k] < g->pitch / 2)
      columns = columns > g->offset[0][k] ? columns : g->offset[0][k];
  h->columns = high - low + 1 + columns;
  find_directions(h);
  h->first = (h->reach + LANES) / LANES * LANES;
  h->end = h->first + (g->row_count * h->columns + LANES - 1) / LANES * LANES;
  h->size = h->end + 2 * h->reach;
  h->place = must_calloc((size_t)g->particle_count, sizeof *h->place);
  for (long p = 0; p < g->particle_count; p++) {
    const long site = g->particle_site[p];
    h->place[p] = h->first + rows_row(g, site) * h->columns + (site - g->first) % g->pitch - low;
  }
}

/* The bond force is T_i V^2 of both ends, T = s/m ((3 k - 5 mu) theta + 15 mu stretch) with the
   weighted volume m and theta = 3/m sum(s^2 stretch V); here by chord over length, in which s falls
   out, and by twice the stretch. */
static void set_law(lps_cubic *h) {
  const family_problem *p = h->problem;
  const rows *g = p->lattice;
  const double s = g->spacing, V = g->volume, k = p->E / (3 * (1 - 2 * p->nu)),
               mu = p->E / (2 * (1 + p->nu)), kick = p->time_step * p->time_step / (g->mass * s);
  for (long n = 0; n < g->particle_count; n++) {
    const long q = h->place[n], site = g->particle_site[n];
    double m = 0;
    for (int j = 0; j < 2 * g->directions; j++) {
      const bool mine = j < g->directions;
      const long other = rows_partner(g, site, j);
      if (rows_has_bond(g, mine ? site : other, mine ? j : j - g->directions))
        m += g->length[mine ? j : j - g->directions] * g->length[mine ? j : j - g->directions] * V;
    }
    h->virgin[q] = g->bonds[site];
    if (m == 0) continue;
    h->by_dilatation[q] = kick * V * V * s / m * (3 * k - 5 * mu) * 3 / m * V * s * s;
    h->by_stretch[q] = kick * V * V * s / m * 15 * mu / 2;
  }
  h->twice_limit = 2 * p->s_0;
}

static void *start(const family_problem *p) {
  lps_cubic *h = must_calloc(1, sizeof *h);
  h->problem = p;
  find_places(h);
  double **const arrays[] = {&h->u[0],     &h->u[1],    &h->u[2],          &h->v[0],
                             &h->v[1],     &h->v[2],    &h->force[0],      &h->force[1],
                             &h->force[2], &h->dilated, &h->by_dilatation, &h->by_stretch};
  lanes_share(arrays, sizeof arrays / sizeof *arrays, h->size);
  h->virgin = must_calloc((size_t)h->size, sizeof *h->virgin);
  h->bonds = must_calloc((size_t)h->size, sizeof *h->bonds);
  set_law(h);
  return h;
}

static void end(void *state) {
  lps_cubic *h = state;
  free(h->u[0]); /* with all that share its memory */
  free(h->virgin);
  free(h->bonds);
  free(h->place);
  free(h);
}

static void set(void *state, const motions *from) {
  lps_cubic *h = state;
  const rows *g = h->problem->lattice;
  memcpy(h->bonds, h->virgin, (size_t)h->size * sizeof *h->bonds);
  for (int d = 0; d < 3; d++)
    for (long p = 0; p < g->particle_count; p++) {
      h->u[d][h->place[p]] = from->displacement[d][g->particle_site[p]] / g->spacing;
      h->v[d][h->place[p]] =
          from->velocity[d][g->particle_site[p]] * h->problem->time_step / g->spacing;
    }
}

static void get(const void *state, motions *to) {
  const lps_cubic *h = state;
  const rows *g = h->problem->lattice;
  for (int d = 0; d < 3; d++)
    for (long p = 0; p < g->particle_count; p++) {
      to->displacement[d][g->particle_site[p]] = h->u[d][h->place[p]] * g->spacing;
      to->velocity[d][g->particle_site[p]] =
          h->v[d][h->place[p]] * g->spacing / h->problem->time_step;
    }
}

const body_program HANDWRITTEN_NAME(lps_cubic) = {start, end, set, get, advance};
