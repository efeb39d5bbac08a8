#include "runtime/uniform_strain.h"

#include <math.h>
#include <omp.h>
#include <stdlib.h>

#include "dsl/arena.h"
#include "dsl/elementary.h"
#include "runtime/shape_matrix.h"
#include "runtime/sweep_parts.h"

enum { MOST_STRAINS = 6 };

/* Small against any strain that a law makes a difference at. */
static const double strain_size = 1e-7;
static const double nominal_step = 1e-9; /* s; what a step is to a law at rest */

/* Components of a symmetric tensor: those of the plane, or of space, shear last. */
static const int first_of[2][MOST_STRAINS] = {{0, 1, 0}, {0, 1, 2, 0, 1, 0}};
static const int second_of[2][MOST_STRAINS] = {{0, 1, 1}, {0, 1, 2, 1, 2, 2}};

typedef struct probe {
  sweep *sweep;
  const rows *lattice;
  int dimensions, strains;
  const int *first, *second;
  double *force[3]; /* [size] by strain: N */
  double volume;    /* m^3 that stresses act in */
  double *left;     /* [particle_count * strains] */
} probe;

static double volume_of(const rows *w, long site) {
  const double V = w->site_volume ? w->site_volume[site] : w->volume;
  return w->dimensions == 2 && w->site_area > 0
             ? V / w->volume * w->site_area * w->stiffness_thickness
             : V;
}

/* Engineering shear: both halves. */
static void displace(probe *p, int strain, double size) {
  const int a = p->first[strain], b = p->second[strain];
  for (long n = 0; n < p->lattice->particle_count; n++) {
    const long q = p->lattice->particle_site[n];
    double at[3];
    rows_place(p->lattice, q, at);
    for (int d = 0; d < p->dimensions; d++)
      p->sweep->displacement[d][q] = 0;
    p->sweep->displacement[a][q] = a == b ? size * at[a] : size / 2 * at[b];
    if (a != b) p->sweep->displacement[b][q] = size / 2 * at[a];
  }
}

static void find_slopes(probe *p, int strain) {
  for (int side = 1; side >= -1; side -= 2) {
    displace(p, strain, side * strain_size);
    sweep_find_forces(p->sweep);
    for (int d = 0; d < p->dimensions; d++)
      for (long q = 0; q < p->lattice->size; q++) {
        const double before = side > 0 ? 0 : p->force[d][q];
        p->force[d][q] = before + side * p->sweep->force[d][q] / (2 * strain_size);
      }
  }
}

/* -sum(f x)/V, symmetric part. */
static void mean_stress(const probe *p, double stress[MOST_STRAINS]) {
  for (int c = 0; c < p->strains; c++) {
    const int a = p->first[c], b = p->second[c];
    double sum = 0;
    for (long n = 0; n < p->lattice->particle_count; n++) {
      const long q = p->lattice->particle_site[n];
      double at[3];
      rows_place(p->lattice, q, at);
      sum -= (p->force[a][q] * at[b] + p->force[b][q] * at[a]) / 2;
    }
    stress[c] = sum / p->volume;
  }
}

static double momentum_of(const probe *p) {
  double sum[3] = {0}, all = 0;
  for (long n = 0; n < p->lattice->particle_count; n++) {
    const long q = p->lattice->particle_site[n];
    double square = 0;
    for (int d = 0; d < p->dimensions; d++) {
      sum[d] += p->force[d][q];
      square += p->force[d][q] * p->force[d][q];
    }
    all += sqrt(square);
  }
  return all > 0 ? sqrt(sum[0] * sum[0] + sum[1] * sum[1] + sum[2] * sum[2]) / all : 0;
}

/* The face of a particle: of the square or cube that has its volume. */
static double face_of(const rows *w, long site) {
  const double V = volume_of(w, site), t = w->stiffness_thickness;
  return w->dimensions == 2 ? sqrt(V * t) : pl_cbrt(V * V);
}

static void note_left(const probe *p, int strain, const double stress[MOST_STRAINS]) {
  double size = 0;
  for (int c = 0; c < p->strains; c++)
    size += (p->first[c] == p->second[c] ? 1 : 2) * stress[c] * stress[c];
  for (long n = 0; n < p->lattice->particle_count; n++) {
    const long q = p->lattice->particle_site[n];
    double square = 0;
    for (int d = 0; d < p->dimensions; d++)
      square += p->force[d][q] * p->force[d][q];
    p->left[n * p->strains + strain] = sqrt(square / size) / face_of(p->lattice, q);
  }
}

static int by_value(const void *a, const void *b) {
  const double x = *(const double *)a, y = *(const double *)b;
  return x < y ? -1 : x > y;
}

static double median(double *values, long count) {
  qsort(values, (size_t)count, sizeof *values, by_value);
  return values[count / 2];
}

/* Voigt's mean over all directions of a stiffness by engineering strains. */
static void isotropic(const probe *p, double C[MOST_STRAINS][MOST_STRAINS], bool plane_strain,
                      uniform_response *out) {
  if (p->dimensions == 2) { /* bulk and shear modulus of the plane */
    const double k = (C[0][0] + C[0][1] + C[1][0] + C[1][1]) / 4;
    const double G = (C[0][0] + C[1][1] - C[0][1] - C[1][0] + 4 * C[2][2]) / 8;
    out->nu = plane_strain ? (k - G) / (2 * k) : (k - G) / (k + G);
    out->E = 2 * G * (1 + out->nu);
    return;
  }
  double normal = 0, mixed = 0, shear = 0;
  for (int a = 0; a < 3; a++) {
    normal += C[a][a];
    shear += C[3 + a][3 + a];
    for (int b = 0; b < 3; b++)
      mixed += a == b ? 0 : C[a][b] / 2;
  }
  const double K = (normal + 2 * mixed) / 9, G = (normal - mixed + 3 * shear) / 15;
  out->nu = (3 * K - 2 * G) / (2 * (3 * K + G));
  out->E = 2 * G * (1 + out->nu);
}

static probe probe_new(const pl_law *law, const double *parameters, const rows *w) {
  const int space = w->dimensions == 3;
  probe p = {.lattice = w,
             .dimensions = w->dimensions,
             .strains = space ? 6 : 3,
             .first = first_of[space],
             .second = second_of[space]};
  p.sweep = sweep_new(w, law, parameters, nominal_step, omp_get_max_threads(), false, true);
  for (int d = 0; d < p.dimensions; d++)
    p.force[d] = must_calloc((size_t)w->size, sizeof(double));
  for (long n = 0; n < w->particle_count; n++)
    p.volume += volume_of(w, w->particle_site[n]);
  p.left = must_calloc((size_t)w->particle_count * (size_t)p.strains, sizeof *p.left);
  return p;
}

static void probe_free(probe *p) {
  sweep_free(p->sweep);
  for (int d = 0; d < p->dimensions; d++)
    free(p->force[d]);
  free(p->left);
}

bool uniform_strain_response(const pl_law *law, const double *parameters, const rows *w,
                             bool plane_strain, uniform_response *out) {
  double C[MOST_STRAINS][MOST_STRAINS] = {{0}}, stress[MOST_STRAINS];
  probe p = probe_new(law, parameters, w);
  *out = (uniform_response){.unresolved = shape_unresolved(w, NULL)};
  for (int c = 0; c < p.strains; c++) {
    find_slopes(&p, c);
    mean_stress(&p, stress);
    note_left(&p, c, stress);
    out->momentum = pl_fmax(out->momentum, momentum_of(&p));
    for (int r = 0; r < p.strains; r++)
      C[r][c] = stress[r];
  }
  isotropic(&p, C, plane_strain, out);
  out->left_force = median(p.left, w->particle_count * p.strains);
  probe_free(&p);
  return isfinite(out->E) && isfinite(out->nu) && out->E > 0 && isfinite(out->left_force);
}
