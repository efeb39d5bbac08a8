#include <math.h>

#include "tests/benchmark/bond_lanes.h"
#include "tests/benchmark/handwritten_families.h"

/* A row's bonds are found, with the sums of stretches of its particles; then the forces of the row
   below are known, and it moves. Buffers hold two rows, by parity; column c of a row stands at
   place LANES + c. Whole rows are done, with the columns beside the particles: what is no bond has
   no stretch, no direction, and so no force. */

enum { ALONG, RIGHT, LEFT, DIRECTIONS };

typedef struct row_buffer {
  double *stretch[DIRECTIONS], *e_x[DIRECTIONS], *e_y[DIRECTIONS]; /* e: direction now */
  double *f_x[DIRECTIONS],
      *f_y[DIRECTIONS]; /* RIGHT and LEFT: force of the bond to the row above */
  double *sum;          /* of the particle's stretches, times b/2 */
} row_buffer;

typedef struct elastic_hexagon {
  const family_problem *problem;
  double chord[DIRECTIONS][2]; /* spacings */
  double a, b;                 /* spacings a step, of a bond's full stretch, by its force */
  double *u[2], *v[2];         /* [size] spacings; spacings a step */
  row_buffer row[2];
} elastic_hexagon;

static void found_row(elastic_hexagon *h, int row) {
  const rows *g = h->problem->lattice;
  const long start = rows_start(g, row), right = rows_offset(g, row, RIGHT),
             left = rows_offset(g, row, LEFT);
  const double *u_x = h->u[0] + start, *u_y = h->u[1] + start;
  const uint64_t *bonds = g->bonds + start;
  const row_buffer *now = &h->row[row & 1], *below = &h->row[~row & 1];
  const long shift_right = LANES + g->pitch - rows_offset(g, row - 1, RIGHT),
             shift_left = LANES + g->pitch - rows_offset(g, row - 1, LEFT);
  const double *from_left = below->stretch[RIGHT] + shift_right,
               *from_right = below->stretch[LEFT] + shift_left;
  const double half_b = 0.5 * h->b;
  const double chord_x[DIRECTIONS] = {h->chord[0][0], h->chord[1][0], h->chord[2][0]},
               chord_y[DIRECTIONS] = {h->chord[0][1], h->chord[1][1], h->chord[2][1]};
  const long offset[DIRECTIONS] = {1, right, left};
  lanes before = lanes_all(0);
  for (long q = 0; q < g->pitch; q += LANES) {
    const lanes i_x = lanes_load(u_x + q), i_y = lanes_load(u_y + q);
    lanes stretch[DIRECTIONS];
    for (int k = 0; k < DIRECTIONS; k++) {
      const lanes_marks exists = lanes_marked(bonds + q, UINT64_C(1) << k);
      const lanes d_x = lanes_load(u_x + q + offset[k]) - i_x,
                  d_y = lanes_load(u_y + q + offset[k]) - i_y;
      const bond_lanes bond = bond_of_growth(((2 * chord_x[k]) * d_x + (2 * chord_y[k]) * d_y) +
                                             (d_x * d_x + d_y * d_y));
      const lanes inverse = lanes_keep(exists, bond.inverse);
      stretch[k] = 0.5 * lanes_keep(exists, bond.twice);
      lanes_store(now->stretch[k] + LANES + q, stretch[k]);
      lanes_store(now->e_x[k] + LANES + q, (chord_x[k] + d_x) * inverse);
      lanes_store(now->e_y[k] + LANES + q, (chord_y[k] + d_y) * inverse);
    }
    const lanes up =
        (stretch[RIGHT] + stretch[LEFT]) + (lanes_load(from_left + q) + lanes_load(from_right + q));
    const lanes sum = (stretch[ALONG] + lanes_shift_in(before, stretch[ALONG])) + up;
    before = stretch[ALONG];
    lanes_store(now->sum + LANES + q, half_b * sum);
  }
}

/* All that acts on the row's particles, which move. */
static void move_row(elastic_hexagon *h, int row) {
  const rows *g = h->problem->lattice;
  const long start = rows_start(g, row);
  const row_buffer *now = &h->row[row & 1], *above = &h->row[~row & 1];
  const long to_right = LANES + rows_offset(g, row, RIGHT) - g->pitch,
             to_left = LANES + rows_offset(g, row, LEFT) - g->pitch;
  const long from_left = LANES + g->pitch - rows_offset(g, row - 1, RIGHT),
             from_right = LANES + g->pitch - rows_offset(g, row - 1, LEFT);
  double *u_x = h->u[0] + start, *u_y = h->u[1] + start, *v_x = h->v[0] + start,
         *v_y = h->v[1] + start;
  const double a = h->a;
  lanes before_x = lanes_all(0), before_y = before_x;
  UNROLL
  for (long q = 0; q < g->pitch; q += LANES) {
    const long at = LANES + q;
    const lanes sum = lanes_load(now->sum + at);
    const lanes n_along =
        a * lanes_load(now->stretch[ALONG] + at) + (sum + lanes_load(now->sum + at + 1));
    const lanes n_right =
        a * lanes_load(now->stretch[RIGHT] + at) + (sum + lanes_load(above->sum + to_right + q));
    const lanes n_left =
        a * lanes_load(now->stretch[LEFT] + at) + (sum + lanes_load(above->sum + to_left + q));
    const lanes along_x = n_along * lanes_load(now->e_x[ALONG] + at),
                along_y = n_along * lanes_load(now->e_y[ALONG] + at);
    const lanes right_x = n_right * lanes_load(now->e_x[RIGHT] + at),
                right_y = n_right * lanes_load(now->e_y[RIGHT] + at);
    const lanes left_x = n_left * lanes_load(now->e_x[LEFT] + at),
                left_y = n_left * lanes_load(now->e_y[LEFT] + at);
    const lanes below_x = lanes_load(above->f_x[RIGHT] + from_left + q) +
                          lanes_load(above->f_x[LEFT] + from_right + q);
    const lanes below_y = lanes_load(above->f_y[RIGHT] + from_left + q) +
                          lanes_load(above->f_y[LEFT] + from_right + q);
    lanes_store(now->f_x[RIGHT] + at, right_x);
    lanes_store(now->f_y[RIGHT] + at, right_y);
    lanes_store(now->f_x[LEFT] + at, left_x);
    lanes_store(now->f_y[LEFT] + at, left_y);
    const lanes f_x =
        (along_x - lanes_shift_in(before_x, along_x)) + ((right_x + left_x) - below_x);
    const lanes f_y =
        (along_y - lanes_shift_in(before_y, along_y)) + ((right_y + left_y) - below_y);
    const lanes next_x = lanes_load(v_x + q) + f_x, next_y = lanes_load(v_y + q) + f_y;
    before_x = along_x;
    before_y = along_y;
    lanes_store(v_x + q, next_x);
    lanes_store(v_y + q, next_y);
    lanes_store(u_x + q, lanes_load(u_x + q) + next_x);
    lanes_store(u_y + q, lanes_load(u_y + q) + next_y);
  }
}

static void advance(void *state, long steps) {
  elastic_hexagon *h = state;
  const int rows_here = h->problem->lattice->row_count;
  const size_t bytes = (size_t)(h->problem->lattice->pitch + 2 * LANES) * sizeof(double);
  for (long step = 0; step < steps; step++) {
    for (int k = RIGHT; k <= LEFT; k++) { /* no bonds come from below the first row */
      memset(h->row[1].stretch[k], 0, bytes);
      memset(h->row[1].f_x[k], 0, bytes);
      memset(h->row[1].f_y[k], 0, bytes);
    }
    for (int row = 0; row < rows_here; row++) {
      found_row(h, row);
      if (row > 0) move_row(h, row - 1);
    }
    memset(h->row[rows_here & 1].sum, 0, bytes);
    move_row(h, rows_here - 1);
  }
}

static void *start(const family_problem *p) {
  const rows *g = p->lattice;
  const double s = g->spacing, t = g->stiffness_thickness,
               kick = p->time_step * p->time_step / (g->mass * s);
  elastic_hexagon *h = must_calloc(1, sizeof *h);
  h->problem = p;
  h->a = kick * 2 * p->E * s * t / (sqrt(3) * (1 + p->nu));
  h->b = kick * p->E * s * t * (1 - 3 * p->nu) / (6 * sqrt(3) * (p->nu * p->nu - 1));
  for (int d = 0; d < 2; d++) {
    h->u[d] = lanes_zeros(g->size);
    h->v[d] = lanes_zeros(g->size);
    for (int k = 0; k < DIRECTIONS; k++)
      h->chord[k][d] = g->chord[k][d] / s;
  }
  const long width = g->pitch + 2 * LANES;
  for (row_buffer *b = h->row; b < h->row + 2; b++) {
    b->sum = lanes_zeros(width);
    for (int k = 0; k < DIRECTIONS; k++) {
      double **buffers[] = {&b->stretch[k], &b->e_x[k], &b->e_y[k], &b->f_x[k], &b->f_y[k]};
      for (int n = 0; n < 5; n++)
        *buffers[n] = lanes_zeros(width);
    }
  }
  return h;
}

static void end(void *state) {
  elastic_hexagon *h = state;
  for (int d = 0; d < 2; d++) {
    free(h->u[d]);
    free(h->v[d]);
  }
  for (row_buffer *b = h->row; b < h->row + 2; b++) {
    free(b->sum);
    for (int k = 0; k < DIRECTIONS; k++) {
      free(b->stretch[k]);
      free(b->e_x[k]);
      free(b->e_y[k]);
      free(b->f_x[k]);
      free(b->f_y[k]);
    }
  }
  free(h);
}

static void set(void *state, const motions *from) {
  const elastic_hexagon *h = state;
  motions_scale(h->u, h->v, from, h->problem);
}

static void get(const void *state, motions *to) {
  const elastic_hexagon *h = state;
  motions_unscale(to, h->u, h->v, h->problem);
}

const body_program HANDWRITTEN_NAME(elastic_hexagon) = {start, end, set, get, advance};
