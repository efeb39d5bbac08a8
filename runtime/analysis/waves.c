#include "runtime/analysis/waves.h"

#include <complex.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "dsl/base/arena.h"
#include "dsl/base/elementary.h"

/* LAPACK: eigenvalues and vectors of a Hermitian matrix. The last two arguments are the hidden text
 * lengths. */
void zheev_(const char *job, const char *triangle, const int *n, double complex *a, const int *lda,
            double *values, double complex *work, const int *work_size, double *real_work,
            int *info, size_t job_length, size_t triangle_length);

enum {
  MOST_DOF = WAVES_MOST_DOF,
  MOST_ORDER = 2 * MOST_DOF,
  PLANE_GRID =
      48, /* wave vectors along each reciprocal vector; both hold the corners of the zones */
  SPACE_GRID = 24,
  STARTS = 6,      /* best grid points that are refined */
  MOST_MOVES = 500 /* of one refinement; about 45 are needed */
};

typedef double complex matrix[MOST_DOF][MOST_DOF];

/* The wave that rules at one wave vector. */
typedef struct wave {
  double pole;      /* 2/dt of its stability limit, 1/s */
  double frequency; /* rad/s */
  double damping_ratio;
  double rotation; /* share of its kinetic energy */
} wave;

/* --- lattice ---------------------------------------------------------------------------------- */

static void cross(const double a[3], const double b[3], double c[3]) {
  for (int k = 0; k < 3; k++)
    c[k] = a[(k + 1) % 3] * b[(k + 2) % 3] - a[(k + 2) % 3] * b[(k + 1) % 3];
}

static double volume_of(const double *a, const double *b, const double *c) {
  double n[3];
  cross(b, c, n);
  return a[0] * n[0] + a[1] * n[1] + a[2] * n[2];
}

static const double out_of_plane[3] = {0, 0, 1};

/* Of a chain the shortest chord, and unit vectors across it: nothing repeats itself there. */
static void chain_primitive(const rows *w, double primitive[3][3]) {
  memcpy(primitive[0], w->chord[0], sizeof primitive[0]);
  memcpy(primitive[2], out_of_plane, sizeof primitive[2]);
  cross(primitive[2], primitive[0], primitive[1]);
  for (int c = 0; c < 3; c++)
    primitive[1][c] /= w->length[0];
}

/* The chords that span the smallest cell; the first of those equally small. */
void lattice_primitive(const rows *w, double primitive[3][3]) {
  double smallest = INFINITY;
  if (rows_are_chain(w)) {
    chain_primitive(w, primitive);
    return;
  }
  for (int i = 0; i < w->directions; i++)
    for (int j = i + 1; j < w->directions; j++)
      for (int k = w->dimensions == 2 ? j : j + 1; k < w->directions; k++) {
        const double *c = w->dimensions == 2 ? out_of_plane : w->chord[k];
        const double size = fabs(volume_of(w->chord[i], w->chord[j], c));
        const double least = 1e-6 * pl_pow(w->spacing, w->dimensions);
        if (size >= least && size < smallest * (1 - 1e-6)) {
          smallest = size;
          memcpy(primitive[0], w->chord[i], sizeof primitive[0]);
          memcpy(primitive[1], w->chord[j], sizeof primitive[1]);
          memcpy(primitive[2], c, sizeof primitive[2]);
        }
        if (w->dimensions == 2) break;
      }
}

static void find_reciprocal(const rows *w, double reciprocal[3][3]) {
  double a[3][3];
  lattice_primitive(w, a);
  const double turn = 2 * M_PI / volume_of(a[0], a[1], a[2]);
  for (int k = 0; k < 3; k++) {
    cross(a[(k + 1) % 3], a[(k + 2) % 3], reciprocal[k]);
    for (int c = 0; c < 3; c++)
      reciprocal[k][c] *= turn;
  }
}

crystal crystal_new(const rows *w, int dof, int terms) {
  crystal c = {.dimensions = w->dimensions, .dof = dof, .term_count = terms};
  c.terms = must_calloc((size_t)terms + 1, sizeof *c.terms);
  c.finite = w->mass > 0 && (dof == w->dimensions || w->inertia > 0);
  for (int k = 0; k < dof; k++)
    c.scale[k] = 1 / sqrt(k < w->dimensions ? w->mass : w->inertia);
  find_reciprocal(w, c.reciprocal);
  return c;
}

void crystal_free(crystal *c) {
  free(c->terms);
}

/* --- waves ------------------------------------------------------------------------------------ */

static void add_part(const crystal *c, const wave_part *part, double complex phase, matrix out) {
  for (int p = 0; p < c->dof; p++)
    for (int q = 0; q < c->dof; q++)
      out[p][q] +=
          c->scale[p] * c->scale[q] *
          (part->self[p][q] + part->forward[p][q] * phase + part->backward[p][q] * conj(phase));
}

/* M^-1/2 K(k) M^-1/2 and the same of damping. */
static void wave_matrices(const crystal *c, const double k[3], matrix stiffness, matrix damping) {
  memset(stiffness, 0, sizeof(matrix));
  memset(damping, 0, sizeof(matrix));
  for (int n = 0; n < c->term_count; n++) {
    const wave_term *t = &c->terms[n];
    const double angle = k[0] * t->R[0] + k[1] * t->R[1] + k[2] * t->R[2];
    const double complex phase = pl_cos(angle) + I * pl_sin(angle);
    add_part(c, &t->stiffness, phase, stiffness);
    if (c->damped) add_part(c, &t->damping, phase, damping);
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
    omega[m] = sqrt(pl_fmax(omega[m], 0));
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

static bool wave_at(const crystal *c, const double k[3], bool damped, wave *out) {
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
    if (p >= c->dimensions) turning += share;
  }
  out->rotation = turning / all;
  return true;
}

/* --- search over the Brillouin zone ----------------------------------------------------------- */

typedef struct found {
  double at[3]; /* in reciprocal vectors */
  wave wave;
} found;

static bool look(const crystal *c, const double at[3], bool damped, found *out) {
  double k[3] = {0, 0, 0};
  for (int n = 0; n < c->dimensions; n++)
    for (int d = 0; d < 3; d++)
      k[d] += at[n] * c->reciprocal[n][d];
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

static int grid_of(const crystal *c) {
  return c->dimensions == 2 ? PLANE_GRID : SPACE_GRID;
}

/* Halving pattern search: branches cross, so the largest frequency has kinks and no derivative
 * there. */
static bool refine(const crystal *c, bool damped, found *f) {
  static const int plane[8][3] = {{1, 0}, {0, 1},   {-1, 0}, {0, -1},
                                  {1, 1}, {-1, -1}, {1, -1}, {-1, 1}};
  const int ways = c->dimensions == 2 ? 8 : 27;
  double h = 0.5 / grid_of(c);
  for (int move = 0; move < MOST_MOVES && h > 1e-13; move++) {
    const found from = *f;
    for (int n = 0; n < ways; n++) { /* in the plane, then above and below it */
      const int *way = n % 9 < 8 ? plane[n % 9] : (const int[3]){0, 0, 0};
      const int rise = n < 9 ? 0 : n < 18 ? 1 : -1;
      const double at[3] = {from.at[0] + h * way[0], from.at[1] + h * way[1],
                            from.at[2] + h * rise};
      found next;
      if (!look(c, at, damped, &next)) return false;
      if (next.wave.pole > f->wave.pole * (1 + 1e-14)) *f = next;
    }
    if (memcmp(f->at, from.at, sizeof f->at) == 0) h /= 2;
  }
  return true;
}

/* The ruling wave of the whole zone; k and -k are one, so half of it suffices. */
static bool search(const crystal *c, bool damped, wave *out) {
  found best[STARTS];
  int count = 0;
  const int n = grid_of(c), levels = c->dimensions == 2 ? 1 : n;
  for (int p = 0; p <= n / 2; p++)
    for (int q = 0; q < n; q++)
      for (int r = 0; r < levels; r++) {
        const double at[3] = {(double)p / n, (double)q / n, (double)r / n};
        found f;
        if (!look(c, at, damped, &f)) return false;
        keep_best(best, &count, &f);
      }
  *out = best[0].wave;
  for (int k = 0; k < count; k++) {
    if (!refine(c, damped, &best[k])) return false;
    if (best[k].wave.pole > out->pole * (1 + 1e-12)) *out = best[k].wave;
  }
  return true;
}

void waves_limit(const crystal *c, step_limit *out) {
  wave free, ruling;
  out->limit = 0;
  out->omega_max = NAN;
  out->damping_ratio = 0;
  out->mode = "translation";
  if (!c->finite || !search(c, false, &free)) return;
  ruling = free;
  if (c->damped && !search(c, true, &ruling)) return;
  out->omega_max = free.frequency;
  out->limit = ruling.pole > 0 ? 2 / ruling.pole : INFINITY;
  out->damping_ratio = ruling.damping_ratio;
  out->mode = ruling.rotation > 0.5 ? "rotation" : "translation";
}

double waves_omega(const crystal *c, const double k[3]) {
  wave there;
  return c->finite && wave_at(c, k, false, &there) ? there.frequency : NAN;
}
