#include "runtime/analysis/bond_forms.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "dsl/base/arena.h"
#include "dsl/base/elementary.h"
#include "runtime/analysis/bond_probe.h"
#include "runtime/base/eigen.h"

/* Rate terms are judged up to here when nothing is damaged earlier. */
static const double largest_stretch = 0.01;
static const double rounding = 1e-12; /* of the largest eigenvalue */
static const double no_matter = 1e-6; /* of it: less shortens no step worth the name */
static const double beside =
    1e-9; /* a motion so small that only a kink at rest tells it from none */

/* --- forms ------------------------------------------------------------------------------------ */

bool form_is_definite(int order, const double *a, double tolerance) {
  double copy[EIGEN_MOST][EIGEN_MOST], values[EIGEN_MOST], vectors[EIGEN_MOST][EIGEN_MOST];
  double least = INFINITY, most = -INFINITY;
  for (int p = 0; p < order; p++)
    for (int q = 0; q < order; q++)
      copy[p][q] = a[p * order + q];
  eigen_symmetric(order, copy, values, vectors);
  for (int k = 0; k < order; k++) {
    least = pl_fmin(least, values[k]);
    most = pl_fmax(most, values[k]);
  }
  return least >= -tolerance * fabs(most);
}

void bond_form_raise(bond_form a, bond_form b) {
  double more[EIGEN_MOST][EIGEN_MOST], values[EIGEN_MOST], vectors[EIGEN_MOST][EIGEN_MOST];
  double size = 0;
  for (int p = 0; p < BOND_MOTIONS; p++)
    for (int q = 0; q < BOND_MOTIONS; q++) {
      more[p][q] = b[p][q] - a[p][q];
      size = pl_fmax(size, fabs(a[p][q]) + fabs(b[p][q]));
    }
  eigen_symmetric(BOND_MOTIONS, more, values, vectors);
  for (int k = 0; k < BOND_MOTIONS; k++)
    for (int p = 0; p < BOND_MOTIONS && values[k] > no_matter * size; p++)
      for (int q = 0; q < BOND_MOTIONS; q++)
        a[p][q] += values[k] * vectors[k][p] * vectors[k][q];
}

/* --- rate terms ------------------------------------------------------------------------------- */

static bool damages(bond_probe *b, bond_motion m) {
  double forces[PL_STATE_RESULTS];
  bond_probe_forces(b, m, forces);
  for (int f = 0; f < b->law->field_count; f++)
    if (b->law->fields[f].kind == PL_FIELD_DAMAGE && b->new_fields[f] > b->law->fields[f].initial)
      return true;
  return false;
}

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
    const bond_motion full = {sign * largest_stretch, 0, largest_stretch * bending[path / 2][0],
                              largest_stretch * bending[path / 2][1]};
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

/* --- a bond ----------------------------------------------------------------------------------- */

/* Symmetric part of diag(s, 1, 1) D. */
static void symmetric(double s, double d[BOND_MOTIONS][BOND_MOTIONS], bond_form out) {
  for (int p = 0; p < BOND_MOTIONS; p++)
    for (int q = 0; q < BOND_MOTIONS; q++)
      out[p][q] = 0.5 * ((p == 0 ? s : 1) * d[p][q] + (q == 0 ? s : 1) * d[q][p]);
}

static bool stiffness_at(bond_probe *b, bond_motion m, bond_form out) {
  double t[PL_TANGENTS];
  bool finite = true;
  bond_probe_tangent(b, m, t);
  for (int k = 0; k < PL_TANGENTS; k++)
    finite = finite && isfinite(t[k]);
  double elastic[BOND_MOTIONS][BOND_MOTIONS] = {
      {t[0], t[2], t[3]}, {t[4], t[6], t[7]}, {t[8], t[10], t[11]}};
  symmetric(b->s, elastic, out);
  return finite;
}

/* At rest, and on all sides of it: a law may have a kink there. */
static void add_stiffness(bond_probe *b, bond_forms *out) {
  const int sides = b->law->kind == PL_MICROPOLAR ? 8 : 2;
  out->finite = stiffness_at(b, (bond_motion){0, 0, 0, 0}, out->stiffness);
  out->definite = form_is_definite(BOND_MOTIONS, &out->stiffness[0][0], rounding);
  for (int k = 0; k < sides && out->finite; k++) {
    bond_form side;
    const double sign[] = {k & 1 ? -beside : beside, k & 2 ? -beside : beside,
                           k & 4 ? -beside : beside};
    if (!stiffness_at(b, (bond_motion){sign[0], 0, sign[1], 0.7 * sign[2]}, side)) continue;
    out->definite = out->definite && form_is_definite(BOND_MOTIONS, &side[0][0], rounding);
    bond_form_raise(out->stiffness, side);
  }
}

static void add_damping(bond_probe *b, bond_forms *out) {
  const rate_scan rates = scan_rates(b);
  if (rates.bounded || rates.size == 0) return;
  double viscous[BOND_MOTIONS][BOND_MOTIONS] = {
      {pl_fmax(rates.slope[0], 0), 0, 0}, {rates.slope[1], 0, 0}, {rates.slope[2], 0, 0}};
  symmetric(b->s, viscous, out->damping);
  out->damped = true;
}

static bond_forms forms_at(const pl_law *law, const double *parameters, const pl_bond_class *bonds,
                           bool dampers) {
  bond_forms f = {.finite = true};
  bond_probe *b = bond_probe_new(law, parameters, bonds);
  add_stiffness(b, &f);
  if (dampers) add_damping(b, &f);
  bond_probe_free(b);
  f.definite = f.finite && f.definite && form_is_definite(BOND_MOTIONS, &f.damping[0][0], rounding);
  return f;
}

bond_forms bond_forms_of(const pl_law *law, const double *parameters, const pl_bond_class *bonds) {
  return forms_at(law, parameters, bonds, true);
}

/* --- parameters that differ from bond to bond ------------------------------------------------- */

static bool are_allowed(const pl_law *law, const double *values) {
  const size_t n = (size_t)law->parameter_count + 1;
  double *lower = must_calloc(2 * n, sizeof *lower), *upper = lower + n;
  unsigned char *open = must_calloc(2 * n, 1);
  law->bounds(law, values, lower, upper, open, open + n);
  bool good = true;
  for (int p = 0; p < law->parameter_count; p++)
    good &= values[p] >= lower[p] && values[p] <= upper[p];
  free(lower);
  free(open);
  return good;
}

enum { MOST_AT_ONCE = 5, INSIDE = 100 };

static int corner_count(const parameter_planes *f) {
  return f->count <= MOST_AT_ONCE ? 1 << f->count : 2 * f->count + 2;
}

/* Of field k at a corner, 0 or 1; NaN: the mean. */
static double corner(const parameter_planes *f, int c, int k) {
  const double high = f->count <= MOST_AT_ONCE ? c >> k & 1 : c & 1;
  return f->count <= MOST_AT_ONCE || c >= 2 * f->count || c / 2 == k ? high : (double)NAN;
}

/* Evenly inside: multiples of irrational numbers (Kronecker). */
static double inside(int n, int k) {
  static const double prime[] = {2, 3, 5, 7, 11, 13, 17, 19};
  return fmod((n + 1) * (1 + k / 8) * sqrt(prime[k % 8]), 1);
}

static void take_sample(const pl_law *law, const parameter_planes *f, int n, double *values) {
  const int corners = corner_count(f);
  for (int k = 0; k < f->count; k++) {
    const double share = n < corners ? corner(f, n, k) : inside(n - corners, k);
    if (!isnan(share))
      values[law->varying[k]] = (1 - share) * f->smallest[k] + share * f->largest[k];
  }
}

static void raise(bond_forms *f, bond_forms *more) {
  bond_form_raise(f->stiffness, more->stiffness);
  bond_form_raise(f->damping, more->damping);
  f->finite = f->finite && more->finite;
  f->definite = f->definite && more->definite;
  f->damped = f->damped || more->damped;
}

bond_forms bond_forms_between(const pl_law *law, const double *parameters,
                              const pl_bond_class *bonds, const parameter_planes *fields) {
  const int corners = corner_count(fields);
  const size_t n = (size_t)law->parameter_count;
  bond_forms f = bond_forms_of(law, parameters, bonds);
  double *values = must_calloc(n + 1, sizeof *values);
  for (int k = 0; k < corners + INSIDE; k++) {
    memcpy(values, parameters, n * sizeof *values);
    take_sample(law, fields, k, values);
    if (!are_allowed(law, values)) continue;
    bond_forms more = forms_at(law, values, bonds, k < corners);
    raise(&f, &more);
  }
  free(values);
  return f;
}
