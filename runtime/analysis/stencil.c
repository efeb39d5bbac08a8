#include "runtime/analysis/stencil.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "dsl/base/arena.h"
#include "dsl/base/elementary.h"
#include "runtime/analysis/patch.h"
#include "runtime/base/eigen.h"

/* Small against any strain that a law makes a difference at; with central differences what is left
   is of the second order. */
static const double tiny = 1e-7;         /* spacings */
static const double tiny_rate = 1e-3;    /* spacings a second */
static const double no_stiffness = 1e-9; /* of a particle's: what differences leave */

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

/* What a way is to a component: a way, or an angle. */
static double angle_of(const neighbourhood *n, const stencil *s, int component) {
  return component < s->dimensions ? 1 : 1 / n->p->lattice->spacing;
}

typedef double site_force[WAVES_MOST_DOF];

/* Forces on all when component b of the particle in the middle is moved: [count]. */
static void push(const neighbourhood *n, double *const *moving, int b, double by,
                 const stencil *out, site_force *force) {
  moving[b][patch_site(n->p, n->reach)] = by * angle_of(n, out, b);
  find_forces(n->p, moving[b]);
  for (int k = 0; k < out->count; k++)
    for (int a = 0; a < out->dof; a++)
      force[k][a] = n->p->force[a][site_of(n, &out->blocks[k])] * angle_of(n, out, a);
}

/* Column b of the blocks, -df/d(moved), of the particle in the middle. `even` [count] is what the
   forces by a way and by its opposite have in common, less those at rest, over twice the way. */
static void probe(const neighbourhood *n, double *const *moving, double size, int b,
                  site_force *even, stencil *out) {
  site_force *up = must_calloc(3 * (size_t)out->count, sizeof *up), *down = up + out->count,
             *rest = down + out->count;
  push(n, moving, b, 0, out, rest);
  push(n, moving, b, size, out, up);
  push(n, moving, b, -size, out, down);
  for (int k = 0; k < out->count; k++)
    for (int a = 0; a < out->dof; a++) {
      stencil_block *block = &out->blocks[k];
      double *value = even ? &block->stiffness[a][b] : &block->damping[a][b];
      *value -= up[k][a] / (2 * size);
      *value += down[k][a] / (2 * size);
      if (even) even[k][a] = fabs(up[k][a] + down[k][a] - 2 * rest[k][a]) / (2 * size);
    }
  free(up);
  moving[b][patch_site(n->p, n->reach)] = 0;
  patch_repeat(n->p, moving[b]);
}

/* Of all columns: the part by which either side of a kink at rest is stiffer than the mean of both,
   where the stiffness matters. */
static void find_kink(site_force *const *even, stencil *out) {
  const double matters = 1e-3;
  double largest = 0;
  for (int k = 0; k < out->count; k++)
    for (int a = 0; a < out->dof; a++)
      for (int b = 0; b < out->dof; b++)
        largest = pl_fmax(largest, fabs(out->blocks[k].stiffness[a][b]));
  for (int k = 0; k < out->count; k++)
    for (int a = 0; a < out->dof; a++)
      for (int b = 0; b < out->dof; b++) {
        const double odd = fabs(out->blocks[k].stiffness[a][b]);
        if (odd > matters * largest) out->kink = pl_fmax(out->kink, even[b][k][a] / odd);
      }
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
static void pair_up(wave_block a, wave_block b) {
  wave_block mean;
  for (int p = 0; p < WAVES_MOST_DOF; p++)
    for (int q = 0; q < WAVES_MOST_DOF; q++)
      mean[p][q] = 0.5 * (a[p][q] + b[q][p]);
  for (int p = 0; p < WAVES_MOST_DOF; p++)
    for (int q = 0; q < WAVES_MOST_DOF; q++)
      a[p][q] = b[q][p] = mean[p][q];
}

static double largest_of(wave_block block) {
  double most = 0;
  for (int p = 0; p < WAVES_MOST_DOF; p++)
    for (int q = 0; q < WAVES_MOST_DOF; q++)
      if (!(fabs(block[p][q]) <= most) && !isnan(most)) most = fabs(block[p][q]);
  return most;
}

/* Moments by rotations need not add up to nothing: all particles may turn against their bonds. */
static void balance(stencil *s) {
  wave_block sum = {{0}};
  stencil_block *own = &s->blocks[0];
  for (int n = 0; n < s->count; n++)
    for (int p = 0; p < s->dof; p++)
      for (int q = 0; q < (p < s->dimensions ? s->dof : s->dimensions); q++)
        sum[p][q] += s->blocks[n].stiffness[p][q];
  s->finite = isfinite(largest_of(sum)) && isfinite(largest_of(own->stiffness));
  s->imbalance = largest_of(sum) / largest_of(own->stiffness);
  for (int p = 0; p < s->dof; p++)
    for (int q = 0; q < s->dof; q++)
      own->stiffness[p][q] -= sum[p][q];
}

stencil stencil_new(const pl_law *law, const double *parameters, const rows *w) {
  stencil s = {.dimensions = law->dimensions, .dof = law->dof};
  neighbourhood near = neighbourhood_new(law, parameters, w);
  add_blocks(&near, &s);
  site_force *even[WAVES_MOST_DOF] = {NULL};
  for (int b = 0; b < s.dof; b++) {
    even[b] = must_calloc((size_t)s.count, sizeof *even[b]);
    probe(&near, near.p->displacement, tiny * w->spacing, b, even[b], &s);
    probe(&near, near.p->velocity, tiny_rate * w->spacing, b, NULL, &s);
  }
  find_kink(even, &s);
  for (int b = 0; b < s.dof; b++)
    free(even[b]);
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
    for (int p = 0; p < c->dof; p++)
      for (int q = 0; q < c->dof; q++) {
        c->terms[n].stiffness.self[p][q] *= factor;
        c->terms[n].stiffness.forward[p][q] *= factor;
        c->terms[n].stiffness.backward[p][q] *= factor;
      }
}

/* Blocks that rounding left count as none. */
crystal stencil_crystal(const pl_law *law, const double *parameters, const rows *w) {
  const double nothing = 1e-12;
  stencil s = stencil_new(law, parameters, w);
  crystal c = crystal_new(w, law->dof, (s.count + 1) / 2);
  const double stiff = largest_of(s.blocks[0].stiffness);
  const double critical = sqrt(stiff * w->mass);
  for (int d = c.dimensions; d < c.dof; d++)
    c.scale[d] *= w->spacing;
  c.finite = c.finite && s.finite;
  memcpy(c.terms[0].stiffness.self, s.blocks[0].stiffness, sizeof(wave_block));
  memcpy(c.terms[0].damping.self, s.blocks[0].damping, sizeof(wave_block));
  c.term_count = 1;
  for (int n = 1; n < s.count; n += 2) {
    const bool stiffness = largest_of(s.blocks[n].stiffness) > nothing * stiff;
    const bool damping = largest_of(s.blocks[n].damping) > nothing * critical;
    if (stiffness || damping) set_term(&c.terms[c.term_count++], &s.blocks[n], &s.blocks[n + 1]);
  }
  c.damped = largest_of(s.blocks[0].damping) > nothing * critical;
  if (s.kink > STENCIL_KINK) scale_stiffness(&c, 1 + s.kink);
  stencil_free(&s);
  return c;
}

/* Long waves feel V k_c k_d [ab,cd]: from ways alone, -1/(2 V) sum of K_ab R_c R_d; less what the
   rotations take, which are in balance. */
typedef struct long_waves {
  const stencil *s;
  double volume;
  /* sum of K_aq R_c over all R, q the principal directions of the stiffness of all particles
     turning alike, over its root */
  double turned[3][3][3];
} long_waves;

/* A rotation that nothing holds takes nothing. */
static void find_turned(long_waves *w) {
  const stencil *s = w->s;
  const int d = s->dimensions, turns = s->dof - d;
  double sum[EIGEN_MOST][EIGEN_MOST] = {{0}}, values[EIGEN_MOST], axes[EIGEN_MOST][EIGEN_MOST];
  for (int n = 0; n < s->count; n++)
    for (int p = 0; p < turns; p++)
      for (int q = 0; q < turns; q++)
        sum[p][q] += s->blocks[n].stiffness[d + p][d + q];
  eigen_symmetric(turns, sum, values, axes);
  for (int m = 0; m < turns; m++) {
    if (!(values[m] > no_stiffness * s->blocks[0].stiffness[0][0])) continue;
    for (int n = 0; n < s->count; n++)
      for (int a = 0; a < d; a++)
        for (int c = 0; c < d; c++)
          for (int q = 0; q < turns; q++)
            w->turned[m][a][c] +=
                s->blocks[n].stiffness[a][d + q] * s->blocks[n].R[c] * axes[m][q] / sqrt(values[m]);
  }
}

static double moment(const long_waves *w, int a, int b, int c, int d) {
  double sum = 0;
  for (int n = 1; n < w->s->count; n++)
    sum -= w->s->blocks[n].stiffness[a][b] * w->s->blocks[n].R[c] * w->s->blocks[n].R[d];
  for (int m = 0; m < w->s->dof - w->s->dimensions; m++)
    sum -= w->turned[m][a][c] * w->turned[m][b][d] + w->turned[m][a][d] * w->turned[m][b][c];
  return sum / (2 * w->volume);
}

void stencil_elastic(const stencil *s, const rows *w, double *D) {
  static const int plane[][2] = {{0, 0}, {1, 1}, {0, 1}};
  static const int space[][2] = {{0, 0}, {1, 1}, {2, 2}, {0, 1}, {1, 2}, {0, 2}};
  const int(*pair)[2] = s->dimensions == 2 ? plane : space;
  const int order = s->dimensions == 2 ? 3 : 6;
  long_waves waves = {.s = s, .volume = rows_stressed_mean(w)};
  find_turned(&waves);
  for (int i = 0; i < order; i++)
    for (int j = 0; j < order; j++) {
      const int p = pair[i][0], q = pair[i][1], r = pair[j][0], t = pair[j][1];
      D[i * order + j] =
          moment(&waves, p, r, q, t) + moment(&waves, r, q, p, t) - moment(&waves, p, q, r, t);
    }
}
