#include "runtime/analysis/uniform_strain.h"

#include <math.h>
#include <omp.h>
#include <stdlib.h>

#include "dsl/base/arena.h"
#include "dsl/base/elementary.h"
#include "runtime/base/lane_sum.h"
#include "runtime/filling/bar_rows.h"
#include "runtime/interaction/interaction.h"
#include "runtime/lattice/shape_matrix.h"

/* LAPACK: solves a system of linear equations. */
void dgesv_(const int *n, const int *columns, double *a, const int *lda, int *pivot, double *b,
            const int *ldb, int *info);

enum { MOST_STRAINS = 6 };

/* Small against any strain that a law makes a difference at. */
static const double strain_size = 1e-7;
static const double nominal_step = 1e-9; /* s; what a step is to a law at rest */

/* Components of a symmetric tensor: those of the plane, or of space, shear last. */
static const int first_of[2][MOST_STRAINS] = {{0, 1, 0}, {0, 1, 2, 0, 1, 0}};
static const int second_of[2][MOST_STRAINS] = {{0, 1, 1}, {0, 1, 2, 1, 2, 2}};

typedef struct probe {
  sweep *sweep;
  body *body;
  const rows *lattice;
  int dimensions, strains;
  const int *first, *second;
  double *force[3]; /* [size] by strain: N */
  double volume;    /* m^3 that stresses act in */
  double *left;     /* [particle_count * strains] */
  double *moment;   /* [rotations * size] N m left; NULL without rotations */
  double *way;      /* the same: where to turn to */
} probe;

/* Engineering shear: both halves; nothing turned. */
static void displace(probe *p, int strain, double size) {
  const int a = p->first[strain], b = p->second[strain];
  for (long n = 0; n < p->lattice->particle_count; n++) {
    const long q = p->lattice->particle_site[n];
    double at[3];
    rows_place(p->lattice, q, at);
    for (int d = 0; d < p->body->dof; d++)
      p->body->displacement[d][q] = 0;
    p->body->displacement[a][q] = a == b ? size * at[a] : size / 2 * at[b];
    if (a != b) p->body->displacement[b][q] = size / 2 * at[a];
  }
}

/* --- rotations in balance --------------------------------------------------------------------- */

static long turning_count(const probe *p) {
  return (p->body->dof - p->dimensions) * p->lattice->size;
}

static double *turned(const probe *p, long k) {
  return &p->body->displacement[p->dimensions + k / p->lattice->size][k % p->lattice->size];
}

static double moment_at(const probe *p, long k) {
  const long q = k % p->lattice->size;
  return p->lattice->present[q] ? p->body->force[p->dimensions + k / p->lattice->size][q] : 0;
}

static double dot(long count, const double *a, const double *b) {
  return lane_dot(count, NULL, a, b);
}

static void turn(const probe *p, double by) {
  for (long k = 0; k < turning_count(p); k++)
    *turned(p, k) += by * p->way[k];
}

/* Along the way; returns how much less moment it leaves, as a product with the way, for each unit
   gone. */
static double resistance(const probe *p, double size) {
  double product = 0;
  turn(p, size);
  sweep_find_forces(p->sweep);
  for (long k = 0; k < turning_count(p); k++)
    product += (p->moment[k] - moment_at(p, k)) / size * p->way[k];
  return product;
}

static double largest_of(long count, const double *x) {
  double most = 0;
  for (long k = 0; k < count; k++)
    most = pl_fmax(most, fabs(x[k]));
  return most;
}

/* What rounding leaves of moments, squared: of all forces at the arm of a spacing. */
static double rounding(const probe *p) {
  double square = 0;
  for (int d = 0; d < p->dimensions; d++)
    square += dot(p->lattice->size, p->body->force[d], p->body->force[d]);
  return 1e-28 * square * p->lattice->spacing * p->lattice->spacing;
}

/* Particles turn until no moments are left on them (conjugate gradients, Hestenes and Stiefel
   1952): moments are linear in rotations as small as these. Those that nothing holds stay. */
static void balance_moments(const probe *p) {
  enum { MOST_STEPS = 200 };
  const long count = turning_count(p);
  sweep_find_forces(p->sweep);
  for (long k = 0; k < count; k++)
    p->way[k] = p->moment[k] = moment_at(p, k);
  double square = dot(count, p->moment, p->moment);
  const double enough = pl_fmax(1e-20 * square, rounding(p));
  for (int step = 0; step < MOST_STEPS && square > enough; step++) {
    const double size = strain_size / largest_of(count, p->way);
    const double against = resistance(p, size), before = square;
    if (!(against > 0)) {
      turn(p, -size);
      break;
    }
    const double part = square / against / size; /* of the change that was tried */
    for (long k = 0; k < count; k++)
      p->moment[k] += part * (moment_at(p, k) - p->moment[k]);
    turn(p, (part - 1) * size);
    square = dot(count, p->moment, p->moment);
    for (long k = 0; k < count; k++)
      p->way[k] = p->moment[k] + square / before * p->way[k];
  }
}

static void find_slopes(probe *p, int strain) {
  for (int side = 1; side >= -1; side -= 2) {
    displace(p, strain, side * strain_size);
    if (p->way) balance_moments(p);
    sweep_find_forces(p->sweep);
    for (int d = 0; d < p->dimensions; d++)
      for (long q = 0; q < p->lattice->size; q++) {
        const double before = side > 0 ? 0 : p->force[d][q];
        p->force[d][q] = before + side * p->body->force[d][q] / (2 * strain_size);
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
  const double V = rows_stressed_volume(w, site), t = w->stiffness_thickness;
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
  p.sweep = interaction_new(w, law, parameters, nominal_step, omp_get_max_threads(), false, true);
  p.body = p.sweep->body;
  for (int d = 0; d < p.dimensions; d++)
    p.force[d] = must_calloc((size_t)w->size, sizeof(double));
  for (long n = 0; n < w->particle_count; n++)
    p.volume += rows_stressed_volume(w, w->particle_site[n]);
  p.left = must_calloc((size_t)w->particle_count * (size_t)p.strains, sizeof *p.left);
  if (law->dof > law->dimensions) {
    p.moment = must_calloc((size_t)turning_count(&p), sizeof *p.moment);
    p.way = must_calloc((size_t)turning_count(&p), sizeof *p.way);
  }
  return p;
}

static void probe_free(probe *p) {
  sweep_free(p->sweep);
  for (int d = 0; d < p->dimensions; d++)
    free(p->force[d]);
  free(p->left);
  free(p->moment);
  free(p->way);
}

/* --- moduli of a body on a lattice ------------------------------------------------------------ */

/* A weight of the sections across one axis that is smooth and 0 at both ends of the middle part,
   and its integral. */
typedef struct window {
  int axis;
  double from, length; /* m */
} window;

static double weight_at(const window *v, double x) {
  const double part = (x - v->from) / v->length;
  return part <= 0 || part >= 1 ? 0 : 1 - pl_cos(2 * M_PI * part);
}

static double integral_at(const window *v, double x) {
  const double part = pl_fmin(pl_fmax((x - v->from) / v->length, 0), 1), turn = 2 * M_PI;
  return v->length * (part - pl_sin(turn * part) / turn);
}

/* Bonds that a section farther from an end cuts are all as they are inside: as far as the passes
   reach. */
static bool window_of(const pl_law *law, const rows *w, int axis, window *v) {
  enum { FEWEST = 3 }; /* spacings that are a middle */
  const int passes = law->kind == PL_STATE && !law->pairwise ? law->step.pass_count : 1;
  double low = INFINITY, high = -INFINITY, at[3];
  for (long p = 0; p < w->particle_count; p++) {
    rows_place(w, w->particle_site[p], at);
    low = pl_fmin(low, at[axis]);
    high = pl_fmax(high, at[axis]);
  }
  const double margin = passes * rows_largest_horizon(w), half = 0.5 * w->spacing;
  const bool has_middle = high - low - 2 * margin >= FEWEST * w->spacing;
  *v = has_middle ? (window){axis, low + margin, high - low - 2 * margin}
                  : (window){axis, low - half, high - low + 2 * half};
  return has_middle;
}

/* Mean over the sections of the force in direction b that they carry, over their area: a section
   carries minus the forces on all beyond it. */
static double section_stress(const probe *p, const window *v, int b) {
  double force = 0, area = 0, at[3];
  for (long n = 0; n < p->lattice->particle_count; n++) {
    const long q = p->lattice->particle_site[n];
    rows_place(p->lattice, q, at);
    force -= p->force[b][q] * integral_at(v, at[v->axis]);
    area += rows_stressed_volume(p->lattice, q) * weight_at(v, at[v->axis]);
  }
  return force / area;
}

static bool solve(int order, double *matrix, double *right) {
  int pivot[MOST_STRAINS], one = 1, info = 0;
  dgesv_(&order, &one, matrix, &order, pivot, right, &order, &info);
  return info == 0;
}

/* The strain that goes with a stress along the axis alone; its modulus. */
static double modulus_along(const double C[MOST_STRAINS][MOST_STRAINS], int strains, int axis) {
  double matrix[MOST_STRAINS * MOST_STRAINS], strain[MOST_STRAINS] = {0};
  strain[axis] = 1;
  for (int c = 0; c < strains; c++)
    for (int r = 0; r < strains; r++)
      matrix[c * strains + r] = C[r][c];
  return solve(strains, matrix, strain) && strain[axis] > 0 ? 1 / strain[axis] : NAN;
}

bool uniform_strain_moduli(const pl_law *law, const double *parameters, double *const *varying,
                           const rows *w, double E[3]) {
  double C[MOST_STRAINS][MOST_STRAINS] = {{0}};
  window along[3];
  bool any = false, has_middle[3];
  for (int a = 0; a < w->dimensions; a++)
    any = (has_middle[a] = window_of(law, w, a, &along[a])) || any;
  for (int a = 0; a < 3; a++)
    E[a] = NAN;
  if (!any) return true;
  probe p = probe_new(law, parameters, w);
  p.sweep->parameter = varying;
  for (int c = 0; c < p.strains; c++) {
    find_slopes(&p, c);
    for (int r = 0; r < p.strains; r++)
      C[r][c] = section_stress(&p, &along[p.first[r]], p.second[r]);
  }
  bool finite = true;
  for (int a = 0; a < p.dimensions; a++) {
    if (has_middle[a]) E[a] = modulus_along((const double(*)[MOST_STRAINS])C, p.strains, a);
    finite = finite && (!has_middle[a] || E[a] > 0);
  }
  probe_free(&p);
  return finite;
}

/* Parameters that differ from place to place, as if they did not. */
static double **same_everywhere(const pl_law *law, const double *parameters, const rows *w) {
  double **planes = must_calloc((size_t)law->varying_count + 1, sizeof *planes);
  const long size = 2 * w->directions * w->size;
  for (int k = 0; k < law->varying_count; k++) {
    planes[k] = must_alloc((size_t)size * sizeof *planes[k]);
    for (long q = 0; q < size; q++)
      planes[k][q] = parameters[law->varying[k]];
  }
  return planes;
}

double uniform_strain_of_bar(const pl_law *law, const double *parameters, const rows *bar) {
  enum { PARTICLES = 9 };
  rows *w = bar_rows_straight(bar, PARTICLES);
  window v;
  if (!w) return NAN;
  rows_set_density(w, 1);
  double **planes = same_everywhere(law, parameters, w);
  probe p = probe_new(law, parameters, w);
  p.sweep->parameter = planes;
  find_slopes(&p, 0);
  const double E = window_of(law, w, 0, &v) ? section_stress(&p, &v, 0) : NAN;
  probe_free(&p);
  for (int k = 0; k < law->varying_count; k++)
    free(planes[k]);
  free(planes);
  rows_free(w);
  return E;
}

bool uniform_strain_response(const pl_law *law, const double *parameters, double *const *varying,
                             const rows *w, bool plane_strain, uniform_response *out) {
  double C[MOST_STRAINS][MOST_STRAINS] = {{0}}, stress[MOST_STRAINS];
  probe p = probe_new(law, parameters, w);
  p.sweep->parameter = varying;
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
