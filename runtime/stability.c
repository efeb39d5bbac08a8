#include "runtime/stability.h"

#include <complex.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "runtime/bond_probe.h"

/* LAPACK: eigenvalues and vectors of a Hermitian matrix. The last two arguments are the hidden text
 * lengths. */
void zheev_(const char *job, const char *triangle, const int *n, double complex *a, const int *lda,
            double *values, double complex *work, const int *work_size, double *real_work,
            int *info, size_t job_length, size_t triangle_length);

enum {
  MOST_DOF = 3, /* u_x, u_y, rotation */
  MOST_ORDER = 2 * MOST_DOF,
  GRID = 48,        /* wave vectors along either reciprocal vector; holds G, K and M */
  STARTS = 6,       /* best grid points that are refined */
  MOST_MOVES = 500, /* of one refinement; about 30 are needed */
  LAW_VARIABLES = 3 /* stretch, theta_i, theta_j; conjugate: N s, M_i, M_j */
};

#define LARGEST_STRETCH                                                                            \
  0.01 /* rate terms are judged up to here when nothing is damaged earlier                         \
        */

/* A bond's share of stiffness and damping, over the degrees of freedom of end i, then of end j. */
typedef struct bond_matrices {
  double stiffness[MOST_ORDER][MOST_ORDER]; /* N/m, N, N m */
  double damping[MOST_ORDER][MOST_ORDER];   /* N s/m, ... */
  double chord[2];                          /* m */
} bond_matrices;

typedef struct crystal {
  int dof, directions;
  bond_matrices bonds[PL_MAX_DIRECTIONS];
  double scale[MOST_DOF];  /* 1/sqrt(mass), 1/sqrt(mass), 1/sqrt(inertia) */
  double reciprocal[2][2]; /* 1/m, of the lattice of chords 0 and 1 */
  bool finite, damped;
} crystal;

typedef double complex matrix[MOST_DOF][MOST_DOF];

/* The wave that rules at one wave vector. */
typedef struct wave {
  double pole;      /* 2/dt of its stability limit, 1/s */
  double frequency; /* rad/s */
  double damping_ratio;
  double rotation; /* share of its kinetic energy */
} wave;

/* --- one state of one bond -------------------------------------------------------------------- */

static bool damages(bond_probe *b, bond_motion m) {
  double forces[PL_STATE_RESULTS];
  bond_probe_forces(b, m, forces);
  for (int f = 0; f < b->law->field_count; f++)
    if (b->law->fields[f].kind == PL_FIELD_DAMAGE && b->new_fields[f] > b->law->fields[f].initial)
      return true;
  return false;
}

/* --- rate terms ------------------------------------------------------------------------------- */

/* Largest multiple u <= 1 of the state without damage (from the virgin state, in one step). */
static double harmless_part(bond_probe *b, bond_motion full) {
  double low = 0, high = 1;
  if (!damages(b, full)) return 1;
  for (int k = 0; k < 60; k++) {
    const double u = (low + high) / 2;
    const bond_motion part = {u * full.stretch, 0, u * full.theta_i, u * full.theta_j};
    if (damages(b, part))
      high = u;
    else
      low = u;
  }
  return low;
}

typedef struct rate_scan {
  bool bounded;                   /* every rate term stays below its elastic force */
  double slope[PL_STATE_RESULTS]; /* of the state with the largest: N s, N m s, N m s */
  double size;                    /* of that slope */
} rate_scan;

static void scan_bound(rate_scan *r, bond_probe *b, bond_motion k) {
  static const double rates[] = {1, 1e3, 1e6, 1e12}; /* 1/s */
  double still[PL_STATE_RESULTS], moving[PL_STATE_RESULTS];
  k.rate = 0;
  bond_probe_forces(b, k, still);
  for (int n = 0; n < 8; n++) {
    k.rate = n % 2 == 0 ? rates[n / 2] : -rates[n / 2];
    bond_probe_forces(b, k, moving);
    for (int c = 0; c < PL_STATE_RESULTS; c++)
      if (!(fabs(moving[c] - still[c]) <= fabs(still[c]) * (1 + 1e-9))) r->bounded = false;
  }
}

static void scan_slope(rate_scan *r, bond_probe *b, bond_motion k) {
  static const double rates[] = {0, 1e-3, -1e-3, 1, -1, 1e3, -1e3}; /* 1/s */
  for (size_t n = 0; n < sizeof rates / sizeof rates[0]; n++) {
    double tangent[PL_TANGENTS];
    k.rate = rates[n];
    bond_probe_tangent(b, k, tangent);
    const double slope[PL_STATE_RESULTS] = {tangent[1], tangent[5], tangent[9]};
    const double size = b->s * fabs(slope[0]) + fabs(slope[1]) + fabs(slope[2]);
    if (size <= r->size || !isfinite(size)) continue;
    r->size = size;
    memcpy(r->slope, slope, sizeof slope);
  }
}

/* Paths from rest: pure stretch either way, and bending along with it. */
static rate_scan scan_rates(bond_probe *b) {
  static const double bending[][2] = {{0, 0}, {1, 1}, {1, -1}, {0.3, -0.8}};
  const int paths = b->law->kind == PL_MICROPOLAR ? 8 : 2;
  rate_scan r = {.bounded = true};
  for (int path = 0; path < paths; path++) {
    const double sign = path % 2 == 0 ? 1 : -1;
    const bond_motion full = {sign * LARGEST_STRETCH, 0, LARGEST_STRETCH * bending[path / 2][0],
                              LARGEST_STRETCH * bending[path / 2][1]};
    const double harmless = harmless_part(b, full);
    for (double u = 1; u > 1e-4; u /= 4) {
      const double part = u * harmless;
      const bond_motion k = {part * full.stretch, 0, part * full.theta_i, part * full.theta_j};
      scan_bound(&r, b, k);
      scan_slope(&r, b, k);
    }
  }
  const bond_motion rest = {0, 0, 0, 0};
  scan_bound(&r, b, rest);
  scan_slope(&r, b, rest);
  return r;
}

/* --- one bond to matrices --------------------------------------------------------------------- */

/* Rates of stretch, theta_i, theta_j by the velocities of the ends: co-rotational kinematics about
   rest, with the chord's rotation (n . du)/s, n = e turned by +90 degrees. The transpose gives the
   particles' forces, V included. */
static void kinematic_matrix(const double chord[2], double s, int dof,
                             double b[LAW_VARIABLES][MOST_ORDER]) {
  memset(b, 0, LAW_VARIABLES * sizeof b[0]);
  const double e[2] = {chord[0] / s, chord[1] / s}, n[2] = {-e[1], e[0]};
  for (int c = 0; c < 2; c++) {
    b[0][c] = -e[c] / s;
    b[0][dof + c] = e[c] / s;
    if (dof < MOST_DOF) continue;
    for (int end = 1; end <= 2; end++) {
      b[end][c] = n[c] / s;
      b[end][dof + c] = -n[c] / s;
    }
  }
  if (dof < MOST_DOF) return;
  b[1][2] = 1;
  b[2][dof + 2] = 1;
}

/* Symmetric part of B^T diag(s, 1, 1) D B. */
static void congruence(double b[LAW_VARIABLES][MOST_ORDER], double s,
                       double d[LAW_VARIABLES][LAW_VARIABLES], int order,
                       double out[MOST_ORDER][MOST_ORDER]) {
  for (int p = 0; p < order; p++) {
    for (int q = 0; q < order; q++) {
      double sum = 0;
      for (int m = 0; m < LAW_VARIABLES; m++)
        for (int n = 0; n < LAW_VARIABLES; n++)
          sum += (b[m][p] * b[n][q] + b[m][q] * b[n][p]) / 2 * (m == 0 ? s : 1) * d[m][n];
      out[p][q] = sum;
    }
  }
}

static void bond_setup(crystal *c, int direction, const pl_law *law, const double *parameters,
                       const rows *w) {
  const pl_bond_class bonds = rows_bond_class(w, direction);
  bond_matrices *out = &c->bonds[direction];
  double t[PL_TANGENTS], kinematic[LAW_VARIABLES][MOST_ORDER];
  bond_probe *b = bond_probe_new(law, parameters, &bonds);
  bond_probe_tangent(b, (bond_motion){0, 0, 0, 0}, t);
  for (int k = 0; k < PL_TANGENTS; k++)
    if (!isfinite(t[k])) c->finite = false;
  double elastic[LAW_VARIABLES][LAW_VARIABLES] = {
      {t[0], t[2], t[3]}, {t[4], t[6], t[7]}, {t[8], t[10], t[11]}};
  kinematic_matrix(bonds.chord, bonds.s, c->dof, kinematic);
  congruence(kinematic, bonds.s, elastic, 2 * c->dof, out->stiffness);
  const rate_scan rates = scan_rates(b);
  if (!rates.bounded && rates.size > 0) {
    double viscous[LAW_VARIABLES][LAW_VARIABLES] = {
        {fmax(rates.slope[0], 0), 0, 0}, {rates.slope[1], 0, 0}, {rates.slope[2], 0, 0}};
    congruence(kinematic, bonds.s, viscous, 2 * c->dof, out->damping);
    c->damped = true;
  }
  memcpy(out->chord, bonds.chord, sizeof out->chord);
  bond_probe_free(b);
}

static void crystal_setup(crystal *c, const pl_law *law, const double *parameters, const rows *w) {
  memset(c, 0, sizeof *c);
  c->dof = law->dof < MOST_DOF ? law->dof : MOST_DOF;
  c->directions = w->directions;
  c->finite = w->mass > 0 && (c->dof < MOST_DOF || w->inertia > 0);
  for (int k = 0; k < c->dof; k++)
    c->scale[k] = 1 / sqrt(k < 2 ? w->mass : w->inertia);
  for (int k = 0; k < c->directions; k++)
    bond_setup(c, k, law, parameters, w);
  const double *a = w->chord[0], *b = w->chord[1];
  const double turn = 2 * acos(-1) / (a[0] * b[1] - a[1] * b[0]);
  const double reciprocal[2][2] = {{turn * b[1], -turn * b[0]}, {-turn * a[1], turn * a[0]}};
  memcpy(c->reciprocal, reciprocal, sizeof reciprocal);
}

/* --- waves ------------------------------------------------------------------------------------ */

static void add_bond(const crystal *c, const double bond[MOST_ORDER][MOST_ORDER],
                     double complex phase, matrix out) {
  const int n = c->dof;
  for (int p = 0; p < n; p++)
    for (int q = 0; q < n; q++)
      out[p][q] +=
          c->scale[p] * c->scale[q] *
          (bond[p][q] + bond[n + p][n + q] + bond[p][n + q] * phase + bond[n + p][q] * conj(phase));
}

/* M^-1/2 K(k) M^-1/2 and the same of damping. */
static void wave_matrices(const crystal *c, const double k[2], matrix stiffness, matrix damping) {
  memset(stiffness, 0, sizeof(matrix));
  memset(damping, 0, sizeof(matrix));
  for (int d = 0; d < c->directions; d++) {
    const double complex phase =
        cexp(I * (k[0] * c->bonds[d].chord[0] + k[1] * c->bonds[d].chord[1]));
    add_bond(c, c->bonds[d].stiffness, phase, stiffness);
    if (c->damped) add_bond(c, c->bonds[d].damping, phase, damping);
  }
}

/* Eigenvalues ascending; a (column-major, order n) becomes the eigenvectors. */
static bool eigen(int n, double complex *a, double *values) {
  double complex work[16 * MOST_ORDER];
  double real_work[3 * MOST_ORDER];
  const int size = 16 * MOST_ORDER;
  int info = 0;
  zheev_("V", "U", &n, a, &n, values, work, &size, real_work, &info, 1, 1);
  return info == 0;
}

/* Modes of the undamped wave: frequencies, and vectors[m][p] of mode m. */
static bool modes(const crystal *c, matrix stiffness, double *omega, matrix vectors) {
  const int n = c->dof;
  double complex a[MOST_DOF * MOST_DOF];
  for (int p = 0; p < n; p++)
    for (int q = 0; q < n; q++)
      a[q * n + p] = stiffness[p][q];
  if (!eigen(n, a, omega)) return false;
  for (int m = 0; m < n; m++) {
    omega[m] = sqrt(fmax(omega[m], 0));
    for (int p = 0; p < n; p++)
      vectors[m][p] = a[m * n + p];
  }
  return true;
}

static double complex sandwich(int n, const double complex *left, matrix a,
                               const double complex *right) {
  double complex sum = 0;
  for (int p = 0; p < n; p++)
    for (int q = 0; q < n; q++)
      sum += conj(left[p]) * a[p][q] * right[q];
  return sum;
}

/* dt^2 K + 2 dt C = 4 M, with p = 2/dt, is p^2 x = p C x + K x; with y = K^1/2 x / p it is the
   Hermitian problem p (x, y) = ((C, K^1/2), (K^1/2, 0)) (x, y), written here in the undamped modes.
   The largest p rules. */
static bool damped_wave(const crystal *c, matrix damping, const double *omega, matrix vectors,
                        wave *out, double complex *mode) {
  const int n = c->dof, order = 2 * n;
  double complex a[MOST_ORDER * MOST_ORDER] = {0};
  double values[MOST_ORDER], square = 0, stiff = 0;
  for (int p = 0; p < n; p++) {
    for (int q = 0; q < n; q++)
      a[q * order + p] = sandwich(n, vectors[p], damping, vectors[q]);
    a[(n + p) * order + p] = a[p * order + n + p] = omega[p];
  }
  if (!eigen(order, a, values)) return false;
  const double complex *x = a + (order - 1) * order;
  for (int p = 0; p < n; p++)
    mode[p] = 0;
  for (int m = 0; m < n; m++) {
    const double share = creal(x[m] * conj(x[m]));
    square += share;
    stiff += share * omega[m] * omega[m];
    for (int p = 0; p < n; p++)
      mode[p] += x[m] * vectors[m][p];
  }
  if (!(square > 0)) { /* neither stiffness nor damping: any vector will do */
    memcpy(mode, vectors[n - 1], (size_t)n * sizeof *mode);
    return true;
  }
  out->pole = values[order - 1];
  out->frequency = sqrt(stiff / square);
  const double rate = creal(sandwich(n, mode, damping, mode)) / square;
  out->damping_ratio = out->frequency > 0 ? rate / (2 * out->frequency) : rate > 0 ? INFINITY : 0;
  return true;
}

static bool wave_at(const crystal *c, const double k[2], bool damped, wave *out) {
  matrix stiffness, damping, vectors;
  double omega[MOST_DOF];
  double complex mode[MOST_DOF];
  const int n = c->dof;
  wave_matrices(c, k, stiffness, damping);
  if (!modes(c, stiffness, omega, vectors)) return false;
  *out = (wave){.pole = omega[n - 1], .frequency = omega[n - 1]};
  memcpy(mode, vectors[n - 1], (size_t)n * sizeof *mode);
  if (damped && !damped_wave(c, damping, omega, vectors, out, mode)) return false;
  double all = 0, turning = 0;
  for (int p = 0; p < n; p++) {
    const double share = creal(mode[p] * conj(mode[p]));
    all += share;
    if (p == 2) turning += share;
  }
  out->rotation = turning / all;
  return true;
}

/* --- search over the Brillouin zone ----------------------------------------------------------- */

typedef struct found {
  double at[2]; /* in reciprocal vectors */
  wave wave;
} found;

static bool look(const crystal *c, const double at[2], bool damped, found *out) {
  const double k[2] = {at[0] * c->reciprocal[0][0] + at[1] * c->reciprocal[1][0],
                       at[0] * c->reciprocal[0][1] + at[1] * c->reciprocal[1][1]};
  memcpy(out->at, at, sizeof out->at);
  return wave_at(c, k, damped, &out->wave);
}

static void keep_best(found best[STARTS], int *count, const found *f) {
  int rank = *count;
  while (rank > 0 && f->wave.pole > best[rank - 1].wave.pole)
    rank--;
  if (rank == STARTS) return;
  const int last = *count < STARTS ? *count : STARTS - 1;
  memmove(best + rank + 1, best + rank, (size_t)(last - rank) * sizeof *best);
  best[rank] = *f;
  if (*count < STARTS) (*count)++;
}

/* Halving pattern search: branches cross, so the largest frequency has kinks and no derivative
 * there. */
static bool refine(const crystal *c, bool damped, found *f) {
  static const int steps[8][2] = {{1, 0}, {0, 1},   {-1, 0}, {0, -1},
                                  {1, 1}, {-1, -1}, {1, -1}, {-1, 1}};
  double h = 0.5 / GRID;
  for (int move = 0; move < MOST_MOVES && h > 1e-9; move++) {
    const found from = *f;
    for (int k = 0; k < 8; k++) {
      const double at[2] = {from.at[0] + h * steps[k][0], from.at[1] + h * steps[k][1]};
      found next;
      if (!look(c, at, damped, &next)) return false;
      if (next.wave.pole > f->wave.pole * (1 + 1e-14)) *f = next;
    }
    if (f->at[0] == from.at[0] && f->at[1] == from.at[1]) h /= 2;
  }
  return true;
}

/* The ruling wave of the whole zone; k and -k are one, so half of it suffices. */
static bool search(const crystal *c, bool damped, wave *out) {
  found best[STARTS];
  int count = 0;
  for (int p = 0; p <= GRID / 2; p++) {
    for (int q = 0; q < GRID; q++) {
      const double at[2] = {(double)p / GRID, (double)q / GRID};
      found f;
      if (!look(c, at, damped, &f)) return false;
      keep_best(best, &count, &f);
    }
  }
  *out = best[0].wave;
  for (int k = 0; k < count; k++) {
    if (!refine(c, damped, &best[k])) return false;
    if (best[k].wave.pole > out->pole * (1 + 1e-12)) *out = best[k].wave;
  }
  return true;
}

void stability_limit(const pl_law *law, const double *parameters, const rows *w, step_limit *out) {
  crystal c;
  wave free, ruling;
  out->limit = 0;
  out->omega_max = NAN;
  out->damping_ratio = 0;
  out->mode = "translation";
  crystal_setup(&c, law, parameters, w);
  if (!c.finite || !search(&c, false, &free)) return;
  ruling = free;
  if (c.damped && !search(&c, true, &ruling)) return;
  out->omega_max = free.frequency;
  out->limit = ruling.pole > 0 ? 2 / ruling.pole : INFINITY;
  out->damping_ratio = ruling.damping_ratio;
  out->mode = ruling.rotation > 0.5 ? "rotation" : "translation";
}

double stability_omega(const pl_law *law, const double *parameters, const rows *w, double kx,
                       double ky) {
  crystal c;
  wave found_there;
  const double k[2] = {kx, ky};
  crystal_setup(&c, law, parameters, w);
  return c.finite && wave_at(&c, k, false, &found_there) ? found_there.frequency : NAN;
}
