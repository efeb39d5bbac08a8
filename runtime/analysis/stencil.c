#include "runtime/analysis/stencil.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "dsl/base/arena.h"
#include "dsl/base/elementary.h"
#include "runtime/analysis/patch.h"

/* Small against any strain that a law makes a difference at; with central differences what is left
   is of the second order. */
static const double tiny = 1e-7;      /* spacings */
static const double tiny_rate = 1e-3; /* spacings a second */

/* Nothing that happens at the middle comes round to itself: the period is longer than the passes
   reach. */
typedef struct neighbourhood {
  patch *p;
  long reach[3]; /* of all passes, in primitive vectors */
} neighbourhood;

static neighbourhood neighbourhood_new(const pl_law *law, const double *parameters, const rows *w) {
  neighbourhood n;
  long margin[3], period[3];
  patch_margins(law, w, margin);
  for (int c = 0; c < 3; c++) {
    n.reach[c] = law->step.pass_count * margin[c];
    period[c] = 2 * n.reach[c] + 1;
  }
  n.p = patch_new(law, parameters, w, period, 0, 0);
  return n;
}

/* Forces of the virgin lattice in the present displacements and velocities, of which one was
   changed. */
static void find_forces(patch *p, double *moved) {
  patch_repeat(p, moved);
  patch_step(p);
}

/* Whoever feels the middle R ahead stands at -R. */
static long site_of(const neighbourhood *n, const stencil_block *block) {
  const long at[3] = {n->reach[0] - block->cell[0], n->reach[1] - block->cell[1],
                      n->reach[2] - block->cell[2]};
  return patch_site(n->p, at);
}

/* Forces on all when the particle in the middle is moved: [count][3]. */
static void push(const neighbourhood *n, double *moved, double by, const stencil *out,
                 double (*force)[3]) {
  moved[patch_site(n->p, n->reach)] = by;
  find_forces(n->p, moved);
  for (int k = 0; k < out->count; k++)
    for (int a = 0; a < out->dimensions; a++)
      force[k][a] = n->p->force[a][site_of(n, &out->blocks[k])];
}

/* Part by which either side of a kink at rest is stiffer than the mean of both, of blocks that
   matter. */
static void note_kink(stencil *out, double (*up)[3], double (*down)[3]) {
  const double matters = 1e-3;
  double largest = 0;
  for (int k = 0; k < 3 * out->count; k++)
    largest = pl_fmax(largest, fabs(up[k / 3][k % 3] - down[k / 3][k % 3]));
  for (int k = 0; k < 3 * out->count; k++) {
    const double odd = fabs(up[k / 3][k % 3] - down[k / 3][k % 3]),
                 even = fabs(up[k / 3][k % 3] + down[k / 3][k % 3]);
    if (odd > matters * largest) out->kink = pl_fmax(out->kink, even / odd);
  }
}

/* Column b of the blocks, -df/d(moved), of the particle in the middle. */
static void probe(const neighbourhood *n, double *const *moving, double size, int b, bool rates,
                  stencil *out) {
  double(*up)[3] = must_calloc(2 * (size_t)out->count, sizeof *up), (*down)[3] = up + out->count;
  push(n, moving[b], size, out, up);
  push(n, moving[b], -size, out, down);
  for (int k = 0; k < out->count; k++)
    for (int a = 0; a < out->dimensions; a++) {
      stencil_block *block = &out->blocks[k];
      double *value = rates ? &block->damping[a][b] : &block->stiffness[a][b];
      *value -= up[k][a] / (2 * size);
      *value += down[k][a] / (2 * size);
    }
  if (!rates) note_kink(out, up, down);
  free(up);
  moving[b][patch_site(n->p, n->reach)] = 0;
  patch_repeat(n->p, moving[b]);
}

/* --- blocks ----------------------------------------------------------------------------------- */

static void add_block(const patch *p, stencil *s, const long cell[3], int sign) {
  stencil_block *b = &s->blocks[s->count++];
  for (int n = 0; n < 3; n++) {
    b->cell[n] = sign * cell[n];
    for (int c = 0; c < 3; c++)
      b->R[c] += (double)b->cell[n] * p->primitive[n][c];
  }
}

static void add_blocks(const neighbourhood *n, stencil *s) {
  const long *period = n->p->period, all = n->p->inside_count;
  s->blocks = must_calloc((size_t)all, sizeof *s->blocks);
  add_block(n->p, s, (const long[3]){0, 0, 0}, 1);
  for (long k = all / 2 + 1; k < all; k++) { /* the half above the middle */
    const long cell[3] = {k % period[0] - n->reach[0], k / period[0] % period[1] - n->reach[1],
                          k / period[0] / period[1] - n->reach[2]};
    add_block(n->p, s, cell, 1);
    add_block(n->p, s, cell, -1);
  }
}

/* a becomes the mean of itself and b transposed, b its transpose. */
static void pair_up(double a[3][3], double b[3][3]) {
  double mean[3][3];
  for (int p = 0; p < 3; p++)
    for (int q = 0; q < 3; q++)
      mean[p][q] = 0.5 * (a[p][q] + b[q][p]);
  for (int p = 0; p < 3; p++)
    for (int q = 0; q < 3; q++) {
      a[p][q] = mean[p][q];
      b[q][p] = mean[p][q];
    }
}

static double largest_of(const double block[3][3]) {
  double most = 0;
  for (int k = 0; k < 9; k++)
    if (!(fabs(block[k / 3][k % 3]) <= most)) most = fabs(block[k / 3][k % 3]);
  return most;
}

static void balance(stencil *s) {
  double sum[3][3] = {{0}};
  stencil_block *own = &s->blocks[0];
  for (int n = 0; n < s->count; n++)
    for (int k = 0; k < 9; k++)
      sum[k / 3][k % 3] += s->blocks[n].stiffness[k / 3][k % 3];
  s->finite = isfinite(largest_of((const double(*)[3])sum));
  s->imbalance =
      largest_of((const double(*)[3])sum) / largest_of((const double(*)[3])own->stiffness);
  for (int k = 0; k < 9; k++)
    own->stiffness[k / 3][k % 3] -= sum[k / 3][k % 3];
}

stencil stencil_new(const pl_law *law, const double *parameters, const rows *w) {
  stencil s = {.dimensions = law->dimensions};
  neighbourhood near = neighbourhood_new(law, parameters, w);
  add_blocks(&near, &s);
  for (int b = 0; b < s.dimensions; b++) {
    probe(&near, near.p->displacement, tiny * w->spacing, b, false, &s);
    probe(&near, near.p->velocity, tiny_rate * w->spacing, b, true, &s);
  }
  patch_free(near.p);
  pair_up(s.blocks[0].stiffness, s.blocks[0].stiffness);
  pair_up(s.blocks[0].damping, s.blocks[0].damping);
  for (int n = 1; n < s.count; n += 2) {
    pair_up(s.blocks[n].stiffness, s.blocks[n + 1].stiffness);
    pair_up(s.blocks[n].damping, s.blocks[n + 1].damping);
  }
  balance(&s);
  return s;
}

void stencil_free(stencil *s) {
  free(s->blocks);
}

/* --- what follows from them ------------------------------------------------------------------- */

static void set_term(wave_term *t, const stencil_block *ahead, const stencil_block *behind) {
  memcpy(t->R, ahead->R, sizeof t->R);
  memcpy(t->stiffness.forward, ahead->stiffness, sizeof(wave_block));
  memcpy(t->stiffness.backward, behind->stiffness, sizeof(wave_block));
  memcpy(t->damping.forward, ahead->damping, sizeof(wave_block));
  memcpy(t->damping.backward, behind->damping, sizeof(wave_block));
}

static void scale_stiffness(crystal *c, double factor) {
  for (int n = 0; n < c->term_count; n++)
    for (int k = 0; k < WAVES_MOST_DOF * WAVES_MOST_DOF; k++) {
      c->terms[n].stiffness.self[k / 3][k % 3] *= factor;
      c->terms[n].stiffness.forward[k / 3][k % 3] *= factor;
      c->terms[n].stiffness.backward[k / 3][k % 3] *= factor;
    }
}

/* Blocks that rounding left count as none. */
crystal stencil_crystal(const pl_law *law, const double *parameters, const rows *w) {
  const double nothing = 1e-12;
  stencil s = stencil_new(law, parameters, w);
  crystal c = crystal_new(w, law->dof, (s.count + 1) / 2);
  const double stiff = largest_of((const double(*)[3])s.blocks[0].stiffness);
  const double critical = sqrt(stiff * w->mass);
  c.finite = c.finite && s.finite;
  memcpy(c.terms[0].stiffness.self, s.blocks[0].stiffness, sizeof(wave_block));
  memcpy(c.terms[0].damping.self, s.blocks[0].damping, sizeof(wave_block));
  c.term_count = 1;
  for (int n = 1; n < s.count; n += 2) {
    const bool stiffness = largest_of((const double(*)[3])s.blocks[n].stiffness) > nothing * stiff;
    const bool damping = largest_of((const double(*)[3])s.blocks[n].damping) > nothing * critical;
    if (stiffness || damping) set_term(&c.terms[c.term_count++], &s.blocks[n], &s.blocks[n + 1]);
  }
  c.damped = largest_of((const double(*)[3])s.blocks[0].damping) > nothing * critical;
  if (s.kink > STENCIL_KINK) scale_stiffness(&c, 1 + s.kink);
  stencil_free(&s);
  return c;
}

/* -1/(2 V) sum of K_ab R_c R_d */
static double moment(const stencil *s, double volume, int a, int b, int c, int d) {
  double sum = 0;
  for (int n = 1; n < s->count; n++)
    sum -= s->blocks[n].stiffness[a][b] * s->blocks[n].R[c] * s->blocks[n].R[d];
  return sum / (2 * volume);
}

void stencil_elastic(const stencil *s, const rows *w, double *D) {
  static const int plane[][2] = {{0, 0}, {1, 1}, {0, 1}};
  static const int space[][2] = {{0, 0}, {1, 1}, {2, 2}, {0, 1}, {1, 2}, {0, 2}};
  const int(*pair)[2] = s->dimensions == 2 ? plane : space;
  const int order = s->dimensions == 2 ? 3 : 6;
  const double V = rows_stressed_mean(w);
  for (int i = 0; i < order; i++)
    for (int j = 0; j < order; j++) {
      const int p = pair[i][0], q = pair[i][1], r = pair[j][0], t = pair[j][1];
      D[i * order + j] =
          moment(s, V, p, r, q, t) + moment(s, V, r, q, p, t) - moment(s, V, p, q, r, t);
    }
}
