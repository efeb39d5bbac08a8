#include "runtime/stability.h"

#include <math.h>
#include <string.h>

#include "dsl/elementary.h"
#include "runtime/body_limit.h"
#include "runtime/bond_probe.h"
#include "runtime/stencil.h"
#include "runtime/waves.h"

enum {
  MOST_DOF = WAVES_MOST_DOF,
  MOST_ORDER = 2 * MOST_DOF,
  LAW_VARIABLES = 3 /* stretch, theta_i, theta_j; conjugate: N s, M_i, M_j */
};

#define LARGEST_STRETCH                                                                            \
  0.01 /* rate terms are judged up to here when nothing is damaged earlier                         \
        */

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

/* Symmetric part of B^T diag(s, 1, 1) D B, as what the ends feel. */
static void bond_part(const pl_bond_class *bonds, double d[LAW_VARIABLES][LAW_VARIABLES], int dof,
                      wave_part *out) {
  double b[LAW_VARIABLES][MOST_ORDER], m[MOST_ORDER][MOST_ORDER];
  kinematic_matrix(bonds->chord, bonds->s, dof, b);
  congruence(b, bonds->s, d, 2 * dof, m);
  for (int p = 0; p < dof; p++)
    for (int q = 0; q < dof; q++) {
      out->self[p][q] = m[p][q] + m[dof + p][dof + q];
      out->forward[p][q] = m[p][dof + q];
      out->backward[p][q] = m[dof + p][q];
    }
}

static void bond_setup(crystal *c, int direction, const pl_law *law, const double *parameters,
                       const rows *w) {
  const pl_bond_class bonds = rows_bond_class(w, direction);
  wave_term *out = &c->terms[direction];
  double t[PL_TANGENTS];
  bond_probe *b = bond_probe_new(law, parameters, &bonds);
  bond_probe_tangent(b, (bond_motion){0, 0, 0, 0}, t);
  for (int k = 0; k < PL_TANGENTS; k++)
    if (!isfinite(t[k])) c->finite = false;
  double elastic[LAW_VARIABLES][LAW_VARIABLES] = {
      {t[0], t[2], t[3]}, {t[4], t[6], t[7]}, {t[8], t[10], t[11]}};
  bond_part(&bonds, elastic, c->dof, &out->stiffness);
  const rate_scan rates = scan_rates(b);
  if (!rates.bounded && rates.size > 0) {
    double viscous[LAW_VARIABLES][LAW_VARIABLES] = {
        {pl_fmax(rates.slope[0], 0), 0, 0}, {rates.slope[1], 0, 0}, {rates.slope[2], 0, 0}};
    bond_part(&bonds, viscous, c->dof, &out->damping);
    c->damped = true;
  }
  memcpy(out->R, bonds.chord, sizeof out->R);
  bond_probe_free(b);
}

static crystal crystal_of(const pl_law *law, const double *parameters, const rows *w) {
  if (law->kind == PL_STATE) return stencil_crystal(law, parameters, w);
  crystal c = crystal_new(w, law->dof, w->directions);
  for (int k = 0; k < w->directions; k++)
    bond_setup(&c, k, law, parameters, w);
  return c;
}

void stability_limit(const pl_law *law, const double *parameters, const rows *w, step_limit *out) {
  if (w->list) {
    body_limit(law, parameters, w, out);
    return;
  }
  crystal c = crystal_of(law, parameters, w);
  waves_limit(&c, out);
  crystal_free(&c);
}

double stability_omega(const pl_law *law, const double *parameters, const rows *w, double kx,
                       double ky) {
  crystal c = crystal_of(law, parameters, w);
  const double omega = waves_omega(&c, (const double[3]){kx, ky, 0});
  crystal_free(&c);
  return omega;
}
