/* A beam of particles that rotate, clamped at x = 0 where the exact motion is prescribed and loaded
   by a shear at its far end: solved by conjugate gradients with the law's own forces. */
#ifndef PERILAT_TESTS_CANTILEVER_H
#define PERILAT_TESTS_CANTILEVER_H

#include "runtime/interaction/interaction.h"
#include "tests/verification/case.h"

typedef struct cantilever {
  deck_case c;
  sweep *w;
  const rows *g;
  double s, length; /* m: spacing; clamped section to the load's centre */
  int32_t *held;    /* [particles] 1 where the exact motion is prescribed */
  double *load;     /* [dof * particles] N, N m */
  int dof, moving;  /* moving: of dof, not rotations */
  long unknowns;
} cantilever;

/* The lattice of b->c with its masses set. */
static inline void cantilever_open(cantilever *b, const pl_law *of, const double *parameters) {
  b->g = b->c.lattice;
  b->w = interaction_new(b->g, of, parameters, 1e-7, 1, false, true);
  b->dof = of->dof;
  b->moving = of->dimensions;
  b->unknowns = b->dof * b->g->particle_count;
  b->held = calloc((size_t)b->g->particle_count, sizeof *b->held);
  b->load = calloc((size_t)b->unknowns, sizeof *b->load);
}

static inline void cantilever_close(cantilever *b) {
  sweep_free(b->w);
  free(b->held);
  free(b->load);
  deck_case_close(&b->c);
}

/* Sections up to x = clamped follow the exact solution; those from x = loaded on carry -force along
   y, as a parabola over the depth. */
static inline void cantilever_ends(cantilever *b, double clamped, double loaded, double force,
                                   double depth) {
  double weight = 0;
  for (int pass_number = 0; pass_number < 2; pass_number++)
    for (long p = 0; p < b->g->particle_count; p++) {
      const double x = b->g->x[b->g->particle_site[p]], y = b->g->y[b->g->particle_site[p]];
      b->held[p] = x < clamped;
      if (x < loaded) continue;
      const double parabola = 1 - 4 * y * y / (depth * depth);
      if (pass_number == 0)
        weight += parabola;
      else
        b->load[b->dof * p + 1] = -force * parabola / weight;
    }
}

/* Forces K u on particles from the kernel: the even terms of its geometry cancel in the difference,
   and u is made so small (largest turn 1e-6 of a spacing) that the cubic ones are rounding. */
static inline void cantilever_forces(cantilever *b, const double *u, double *product) {
  body *w = b->w->body;
  double size = 1e-300;
  for (long k = 0; k < b->unknowns; k++)
    size = fmax(size, fabs(u[k]) / (k % b->dof < b->moving ? b->s : 1));
  for (int side = 1; side >= -1; side -= 2) {
    for (long k = 0; k < b->unknowns; k++)
      w->displacement[k % b->dof][b->g->particle_site[k / b->dof]] = side * 1e-6 / size * u[k];
    sweep_find_forces(b->w);
    for (long k = 0; k < b->unknowns; k++) {
      const double force = w->force[k % b->dof][b->g->particle_site[k / b->dof]];
      const double half = -side * force * size / 2e-6;
      product[k] = side > 0 ? half : product[k] + half;
    }
  }
}

static inline double cantilever_dot(const double *a, const double *b, long count) {
  double sum = 0;
  for (long k = 0; k < count; k++)
    sum += a[k] * b[k];
  return sum;
}

/* Entries of held particles (their rotations stay free) to zero; the rest by the inverse of a
 * typical stiffness. */
static inline void cantilever_precondition(const cantilever *b, const double *r, double *z) {
  for (long k = 0; k < b->unknowns; k++) {
    const bool moves = k % b->dof < b->moving;
    z[k] = moves && b->held[k / b->dof] ? 0 : r[k] / (moves ? 1 : 0.05 * b->s * b->s);
  }
}

/* K u = load by conjugate gradients, from the exact solution's values at the held particles.
 * Returns the iterations. */
static inline int cantilever_solve(cantilever *b, double *u) {
  const long n = b->unknowns;
  double *r = calloc((size_t)n, sizeof *r), *z = calloc((size_t)n, sizeof *z);
  double *p = calloc((size_t)n, sizeof *p), *Kp = calloc((size_t)n, sizeof *Kp);
  cantilever_forces(b, u, Kp);
  for (long k = 0; k < n; k++)
    r[k] = b->load[k] - Kp[k];
  cantilever_precondition(b, r, z);
  memcpy(p, z, (size_t)n * sizeof *p);
  double rz = cantilever_dot(r, z, n);
  const double target = 1e-16 * rz; /* residual by eight digits */
  int iterations = 0;
  while (rz > target && iterations < 20000) {
    cantilever_forces(b, p, Kp);
    for (long k = 0; k < n; k++)
      if (k % b->dof < b->moving && b->held[k / b->dof]) Kp[k] = 0;
    const double step = rz / cantilever_dot(p, Kp, n);
    for (long k = 0; k < n; k++) {
      u[k] += step * p[k];
      r[k] -= step * Kp[k];
    }
    cantilever_precondition(b, r, z);
    const double before = rz;
    rz = cantilever_dot(r, z, n);
    for (long k = 0; k < n; k++)
      p[k] = z[k] + rz / before * p[k];
    iterations++;
  }
  assert_true(rz <= target);
  free(r);
  free(z);
  free(p);
  free(Kp);
  return iterations;
}

/* Motion in the plane at (x, y) of a beam of that length, m. */
typedef void cantilever_exact(double length, double x, double y, double *ux, double *uy);

/* Mean deflection of the loaded sections over the exact one, less 1. */
static inline double cantilever_error(cantilever *b, cantilever_exact *exact) {
  double *u = calloc((size_t)b->unknowns, sizeof *u), sum = 0, expected = 0, ux, uy;
  for (long p = 0; p < b->g->particle_count; p++)
    if (b->held[p])
      exact(b->length, b->g->x[b->g->particle_site[p]], b->g->y[b->g->particle_site[p]],
            &u[b->dof * p], &u[b->dof * p + 1]);
  const int iterations = cantilever_solve(b, u);
  long loaded = 0;
  for (long p = 0; p < b->g->particle_count; p++) {
    if (b->load[b->dof * p + 1] == 0) continue;
    exact(b->length, b->g->x[b->g->particle_site[p]], b->g->y[b->g->particle_site[p]], &ux, &uy);
    sum += u[b->dof * p + 1];
    expected += uy;
    loaded++;
  }
  print_message("cantilever, spacing %.3f mm: deflection %.5f of theory's %.4g mm (%ld particles, "
                "%d iterations)\n",
                1e3 * b->s, sum / expected, 1e3 * expected / (double)loaded, b->g->particle_count,
                iterations);
  free(u);
  return sum / expected - 1;
}

#endif
