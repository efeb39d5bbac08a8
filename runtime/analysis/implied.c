#include "runtime/analysis/implied.h"

#include <math.h>
#include <string.h>

#include "dsl/base/elementary.h"
#include "runtime/analysis/bond_probe.h"
#include "runtime/analysis/stability.h"
#include "runtime/analysis/stencil.h"
#include "runtime/filling/lattice.h"

/* LAPACK: factors of a symmetric positive matrix, and its inverse from them. The last argument is
 * the hidden text length. */
void dpotrf_(const char *triangle, const int *n, double *a, const int *lda, int *info,
             size_t triangle_length);
void dpotri_(const char *triangle, const int *n, double *a, const int *lda, int *info,
             size_t triangle_length);

/* One bond of a direction of the lattice, uncoupled to others. */
typedef struct lattice_bond {
  bond_probe *probe;
  double n[2], s; /* direction, length */
} lattice_bond;

static lattice_bond bond_of(const pl_law *law, const double *parameters, const rows *w,
                            int direction) {
  const pl_bond_class bonds = rows_bond_class(w, direction);
  const double s = bonds.s, *chord = w->chord[direction];
  return (lattice_bond){bond_probe_new(law, parameters, &bonds), {chord[0] / s, chord[1] / s}, s};
}

/* The force with the fields at hand, which then go on. */
static void bond_step(lattice_bond *b, double stretch, double theta,
                      double result[PL_STATE_RESULTS]) {
  bond_probe_forces(b->probe, (bond_motion){stretch, 0, theta, theta}, result);
  bond_probe_accept(b->probe);
}

/* Stretch and chord rotation of a bond in the uniform strain e = (xx, yy, 2 xy). */
static double stretch_of(const lattice_bond *b, const double e[3]) {
  return b->n[0] * b->n[0] * e[0] + b->n[1] * b->n[1] * e[1] + b->n[0] * b->n[1] * e[2];
}
static double rotation_of(const lattice_bond *b, const double e[3]) {
  return b->n[0] * b->n[1] * (e[1] - e[0]) + 0.5 * (b->n[0] * b->n[0] - b->n[1] * b->n[1]) * e[2];
}

/* Adds the bond's share of the stress (xx, yy, xy, yx) * volume: force on i times chord. */
static void add_stress(const lattice_bond *b, double N, double V, double stress[4]) {
  double fx = N * b->n[0] + V * b->n[1], fy = N * b->n[1] - V * b->n[0];
  stress[0] += fx * b->n[0] * b->s;
  stress[1] += fy * b->n[1] * b->s;
  stress[2] += fx * b->n[1] * b->s;
  stress[3] += fy * b->n[0] * b->s;
}

/* Stress in the linear lattice under strain e; the common particle rotation balances the moments.
 */
static void linear_stress(const lattice_bond *bonds, double (*tangents)[PL_TANGENTS], int count,
                          const double e[3], double stress[4]) {
  double moment = 0, stiffness = 0;
  for (int k = 0; k < count; k++) {
    const double *T = tangents[k];
    double turning = T[6] + T[7] + T[10] + T[11];
    moment += (T[4] + T[8]) * stretch_of(&bonds[k], e) - turning * rotation_of(&bonds[k], e);
    stiffness += turning;
  }
  double common = stiffness != 0 ? -moment / stiffness : 0;
  memset(stress, 0, 4 * sizeof *stress);
  for (int k = 0; k < count; k++) {
    const double *T = tangents[k];
    double stretch = stretch_of(&bonds[k], e);
    double theta = common - rotation_of(&bonds[k], e);
    double N = T[0] * stretch + (T[2] + T[3]) * theta;
    double M = (T[4] + T[8]) * stretch + (T[6] + T[7] + T[10] + T[11]) * theta;
    add_stress(&bonds[k], N, M / bonds[k].s, stress);
  }
}

static bool invert3(const double a[3][3], double inverse[3][3]) {
  double c[3][3];
  for (int i = 0; i < 3; i++)
    for (int j = 0; j < 3; j++) {
      int i1 = (i + 1) % 3, i2 = (i + 2) % 3, j1 = (j + 1) % 3, j2 = (j + 2) % 3;
      c[i][j] = a[i1][j1] * a[i2][j2] - a[i1][j2] * a[i2][j1];
    }
  double det = a[0][0] * c[0][0] + a[0][1] * c[0][1] + a[0][2] * c[0][2];
  double scale = fabs(a[0][0] * a[1][1] * a[2][2]);
  if (!(fabs(det) > 1e-12 * scale)) return false;
  for (int i = 0; i < 3; i++)
    for (int j = 0; j < 3; j++)
      inverse[j][i] = c[i][j] / det;
  return true;
}

/* Of a symmetric positive matrix; else false, and the inverse means nothing. */
static bool invert_stiffness(int order, const double *D, double *S) {
  int info = 0;
  memcpy(S, D, (size_t)(order * order) * sizeof *S);
  dpotrf_("U", &order, S, &order, &info, 1);
  if (info != 0) return false;
  dpotri_("U", &order, S, &order, &info, 1); /* column-major: the lower triangle of rows */
  for (int r = 0; r < order; r++)
    for (int c = r + 1; c < order; c++)
      S[r * order + c] = S[c * order + r];
  return info == 0;
}

/* Whether two tangents differ in what a bond resists by itself: dN/dstretch, dM_i/dtheta_i,
   dM_j/dtheta_j. */
static bool differ(const double a[PL_TANGENTS], const double b[PL_TANGENTS]) {
  static const int own[] = {0, 6, 11};
  for (size_t k = 0; k < sizeof own / sizeof *own; k++)
    if (fabs(a[own[k]] - b[own[k]]) > 1e-6 * (fabs(a[own[k]]) + fabs(b[own[k]]))) return true;
  return false;
}

/* The tangent at rest; where the law has a kink there (a max, the size of a rotation), the mean of
   those on all sides of it. */
static void tangent_at_rest(bond_probe *b, double tangent[PL_TANGENTS]) {
  static const double beside = 1e-9; /* so small that only a kink at rest tells it from none */
  const int sides = b->law->kind == PL_MICROPOLAR ? 8 : 2;
  double mean[PL_TANGENTS] = {0}, side[PL_TANGENTS];
  for (int k = 0; k < sides; k++) {
    bond_probe_tangent(b,
                       (bond_motion){k & 1 ? -beside : beside, 0, k & 2 ? -beside : beside,
                                     k & 4 ? -0.7 * beside : 0.7 * beside},
                       side);
    for (int n = 0; n < PL_TANGENTS; n++)
      mean[n] += side[n] / sides;
  }
  bond_probe_tangent(b, (bond_motion){0, 0, 0, 0}, tangent);
  if (differ(mean, tangent)) memcpy(tangent, mean, sizeof mean);
}

static void pairwise_stiffness(const pl_law *law, const double *parameters, const rows *w,
                               implied_elasticity *out) {
  lattice_bond bonds[PL_MAX_DIRECTIONS];
  double tangents[PL_MAX_DIRECTIONS][PL_TANGENTS];
  for (int k = 0; k < w->directions; k++) {
    bonds[k] = bond_of(law, parameters, w, k);
    tangent_at_rest(bonds[k].probe, tangents[k]);
  }
  for (int c = 0; c < 3; c++) {
    double e[3] = {c == 0, c == 1, c == 2}, stress[4];
    linear_stress(bonds, tangents, w->directions, e, stress);
    for (int r = 0; r < 3; r++)
      out->D[r][c] = (r < 2 ? stress[r] : 0.5 * (stress[2] + stress[3])) / rows_stressed_mean(w);
    out->asymmetry = pl_fmax(out->asymmetry, fabs(stress[2] - stress[3]) / rows_stressed_mean(w));
  }
  for (int k = 0; k < w->directions; k++)
    bond_probe_free(bonds[k].probe);
}

/* The stress along a chain under a strain along it. */
static bool chain_elastic(const rows *w, implied_elasticity *out) {
  const double n[2] = {w->chord[0][0] / w->length[0], w->chord[0][1] / w->length[0]};
  const double e[3] = {n[0] * n[0], n[1] * n[1], 2 * n[0] * n[1]}; /* along n; D e : e */
  double along = 0;
  for (int r = 0; r < 3; r++)
    for (int c = 0; c < 3; c++)
      along += e[r] * out->D[r][c] * e[c];
  out->E[0] = along;
  out->E[1] = out->nu[0] = out->nu[1] = out->G = NAN;
  return along > 0;
}

/* In space the compliance knows all six strains, D only those of the plane x, y. */
static bool families_elastic(const pl_law *law, const double *parameters, const rows *w,
                             implied_elasticity *out) {
  const int order = law->dimensions == 2 ? 3 : 6, shear = law->dimensions;
  const int plane[3] = {0, 1, shear};
  double D[36], S[36];
  stencil s = stencil_new(law, parameters, w);
  stencil_elastic(&s, w, D);
  const bool finite = s.finite;
  stencil_free(&s);
  for (int r = 0; r < 3; r++)
    for (int c = 0; c < 3; c++)
      out->D[r][c] = D[plane[r] * order + plane[c]];
  if (rows_are_chain(w)) return finite && chain_elastic(w, out);
  const bool stiff = finite && invert_stiffness(order, D, S);
  for (int c = 0; c < 2; c++) {
    out->E[c] = 1 / S[c * order + c];
    out->nu[c] = -S[c * order + 1 - c] / S[c * order + c];
  }
  out->G = 1 / S[shear * order + shear];
  return stiff;
}

bool implied_elastic(const pl_law *law, const double *parameters, const rows *w,
                     implied_elasticity *out) {
  *out = (implied_elasticity){.asymmetry = 0};
  if (w->list) return false;
  if (law->kind == PL_STATE) return families_elastic(law, parameters, w, out);
  pairwise_stiffness(law, parameters, w, out);
  double S[3][3];
  if (!invert3(out->D, S)) return false;
  for (int c = 0; c < 2; c++) {
    out->E[c] = 1 / S[c][c];
    out->nu[c] = -S[1 - c][c] / S[c][c];
  }
  out->G = 1 / S[2][2];
  return true;
}

/* Largest stress over the strains from * ratio^0..count-1 (or from + k step when ratio is 0). */
static double scan_strength(const pl_law *law, const double *parameters, const rows *w,
                            int component, double from, double factor, double step, int count,
                            double *where) {
  lattice_bond bonds[PL_MAX_DIRECTIONS];
  for (int k = 0; k < w->directions; k++)
    bonds[k] = bond_of(law, parameters, w, k);
  double largest = 0, strain = from;
  *where = 0;
  for (int q = 0; q < count; q++, strain = strain * factor + step) {
    double e[3] = {component == 0 ? strain : 0, component == 1 ? strain : 0, 0}, stress[4] = {0};
    for (int k = 0; k < w->directions; k++) {
      double result[PL_STATE_RESULTS];
      double stretch = stretch_of(&bonds[k], e);
      bond_step(&bonds[k], stretch, -rotation_of(&bonds[k], e), result);
      add_stress(&bonds[k], result[0], (result[1] + result[2]) / (bonds[k].s * (1 + stretch)),
                 stress);
    }
    if (stress[component] > largest) {
      largest = stress[component];
      *where = strain;
    }
  }
  for (int k = 0; k < w->directions; k++)
    bond_probe_free(bonds[k].probe);
  return largest / rows_stressed_mean(w);
}

double implied_strength(const pl_law *law, const double *parameters, const rows *w, int component,
                        double *strain) {
  const double first = 1e-8, last = 1.0;
  if (strain) *strain = NAN;
  if (law->kind == PL_STATE || w->list) return INFINITY;
  const int coarse = 1600, fine = 400;
  double factor = pl_pow(last / first, 1.0 / (coarse - 1)), at;
  scan_strength(law, parameters, w, component, first, factor, 0, coarse, &at);
  bool found = at > 0 && at < 0.99 * last;
  double strength = INFINITY;
  if (found) {
    double from = at / factor, to = at * factor;
    strength =
        scan_strength(law, parameters, w, component, from, 1, (to - from) / (fine - 1), fine, &at);
  }
  if (strain) *strain = found ? at : NAN;
  return strength;
}

/* --- one bond --------------------------------------------------------------------------------- */

rows *implied_lattice_like(const deck_lattice *l, double rho) {
  const double s = l->spacing;
  deck_lattice lattice = *l;
  lattice.name = "lattice";
  lattice.edges = EDGES_OF_LATTICE; /* what is asked about is inside */
  deck_body body = {
      .lattice = lattice.name,
      .shape = {.kind = bravais_dimensions(l->kind) == 3 ? SHAPE_BOX : SHAPE_RECTANGLE,
                .corner = {-2.5 * s, -2.5 * s, -2.5 * s},
                .size = {5 * s, 5 * s, 5 * s}}};
  const deck k = {
      .name = "", .lattices = &lattice, .lattice_count = 1, .bodys = &body, .body_count = 1};
  source_set sources = {NULL, 0};
  diagnostics said;
  diag_begin(&said, &sources);
  rows *w = lattice_build(&k, 0, &said);
  diag_clear(&said);
  if (!w) return NULL;
  rows_set_density(w, rho);
  return w;
}

rows *implied_lattice(double spacing, double thickness, double rho) {
  const deck_lattice hexagonal = lattice_default("plane_stress", spacing, thickness);
  return implied_lattice_like(&hexagonal, rho);
}

enum { CURVE_POINTS = 24000, PEAK_POINTS = 400, PEAK_ROUNDS = 3 };
static const double first_stretch = 1e-9, last_stretch = 1e3;

/* Ways of the curve over the bond's length: evenly spaced logarithms. */
static double curve_stretch(int k) {
  return first_stretch * pl_pow(last_stretch / first_stretch, (double)k / (CURVE_POINTS - 1));
}

/* Stretch of a bond whose far end has gone `way` lengths along the unit vector e; *turn: of its
   chord. */
static double drawn_stretch(const lattice_bond *b, const double e[2], double way, double *turn) {
  double along = b->n[0] * e[0] + b->n[1] * e[1], across = b->n[0] * e[1] - b->n[1] * e[0];
  double length = pl_hypot(1 + way * along, way * across);
  *turn = pl_atan2(way * across, 1 + way * along);
  return way * (2 * along + way) / (1 + length); /* length - 1, of a small way too */
}

/* The largest force between two stretches, approached from the virgin state in equal steps. */
static double peak_between(lattice_bond *b, double from, double to, double *at) {
  double largest = -INFINITY;
  bond_probe_reset(b->probe);
  for (int k = 0; k <= PEAK_POINTS; k++) {
    double result[PL_STATE_RESULTS], stretch = from + (to - from) * k / PEAK_POINTS;
    bond_step(b, stretch, 0, result);
    if (result[0] > largest) {
      largest = result[0];
      *at = stretch;
    }
  }
  return largest;
}

static void find_peak(lattice_bond *b, double from, double to, implied_bond *out) {
  for (int round = 0; round < PEAK_ROUNDS; round++) {
    double at = from, step = (to - from) / PEAK_POINTS;
    out->peak_force = peak_between(b, from, to, &at);
    out->stretch_at_peak = at;
    from = pl_fmax(at - step, from);
    to = pl_fmin(at + step, to);
  }
}

typedef struct curve {
  double work, largest; /* J, N */
  int peak;             /* point of the largest force */
  bool separates;       /* all forces fall to nothing */
} curve;

/* Draws the bond's ends apart along e; the particles do not turn. Trapezoids; the points are close
   enough for 1e-6 at a kink. */
static curve trace_curve(lattice_bond *b, const double e[2]) {
  const double nothing = 1e-9; /* of the peak */
  curve c = {0};
  double stretch = 0, turn = 0, force = 0, moment = 0, size = 0;
  for (int k = 0; k < CURVE_POINTS; k++) {
    double result[PL_STATE_RESULTS], next_turn,
        next = drawn_stretch(b, e, curve_stretch(k), &next_turn);
    bond_step(b, next, -next_turn, result);
    double N = result[0], M = result[1] + result[2];
    if (!isfinite(N) || !isfinite(M)) return (curve){0};
    c.work += 0.5 * (force + N) * (next - stretch) * b->s - 0.5 * (moment + M) * (next_turn - turn);
    stretch = next, turn = next_turn, force = N, moment = M;
    size = pl_fmax(size, fabs(N) + fabs(M) / b->s);
    if (N > c.largest) {
      c.largest = N;
      c.peak = k;
    }
  }
  c.separates = c.largest > 0 && fabs(force) + fabs(moment) / b->s <= nothing * size;
  return c;
}

void implied_bond_curve(const pl_law *law, const double *parameters, const rows *w, int direction,
                        implied_bond *out) {
  lattice_bond b = bond_of(law, parameters, w, direction);
  *out = (implied_bond){
      .peak_force = INFINITY, .stretch_at_peak = NAN, .energy = INFINITY, .row_energy = INFINITY};
  curve c = trace_curve(&b, b.n);
  if (c.peak > 0 && c.peak < CURVE_POINTS - 1)
    find_peak(&b, curve_stretch(c.peak - 1), curve_stretch(c.peak + 1), out);
  out->separates = c.separates;
  if (out->separates) {
    out->energy = c.work;
    out->row_energy = c.work * b.s / rows_stressed_mean(w);
  }
  bond_probe_free(b.probe);
}

double implied_crack_energy(const pl_law *law, const double *parameters, const rows *w,
                            int component) {
  double energy = 0;
  for (int k = 0; k < w->directions; k++) {
    const double reach =
        w->chord[k][component]; /* a line across it cuts |reach| bonds per area of a site */
    if (fabs(reach) < 1e-9 * w->spacing) continue;
    const double e[2] = {component == 0 ? copysign(1, reach) : 0,
                         component == 1 ? copysign(1, reach) : 0};
    lattice_bond b = bond_of(law, parameters, w, k);
    curve c = trace_curve(&b, e);
    energy += c.separates ? c.work * fabs(reach) / rows_stressed_mean(w) : INFINITY;
    bond_probe_free(b.probe);
  }
  return energy;
}

void implied_wave_speeds(const pl_law *law, const double *parameters, const rows *w,
                         const implied_elasticity *e, implied_waves *out) {
  double density = w->mass / rows_stressed_mean(w); /* of the volume that stress is counted on */
  *out = (implied_waves){.transverse = sqrt(e->G / density)};
  for (int c = 0; c < 2; c++)
    out->longitudinal[c] = sqrt((rows_are_chain(w) ? e->E[c] : e->D[c][c]) / density);
  if (law->dof > law->dimensions) out->rotation_cutoff = stability_omega(law, parameters, w, 0, 0);
}
