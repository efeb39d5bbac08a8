#include "runtime/analysis/stability.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "dsl/base/elementary.h"
#include "runtime/analysis/body_limit.h"
#include "runtime/analysis/bond_forms.h"
#include "runtime/analysis/stencil.h"
#include "runtime/analysis/waves.h"

enum { MOST_DOF = WAVES_MOST_DOF, MOST_ORDER = 2 * MOST_DOF };

/* --- one bond to matrices --------------------------------------------------------------------- */

/* Rates of stretch, theta_i, theta_j by the velocities of the ends: co-rotational kinematics about
   rest, with the chord's rotation (n . du)/s, n = e turned by +90 degrees. The transpose gives the
   particles' forces, V included. */
static void kinematic_matrix(const double chord[2], double s, int dof,
                             double b[BOND_MOTIONS][MOST_ORDER]) {
  memset(b, 0, BOND_MOTIONS * sizeof b[0]);
  const double e[2] = {chord[0] / s, chord[1] / s}, n[2] = {-e[1], e[0]};
  for (int c = 0; c < 2; c++) {
    b[0][c] = -e[c] / s;
    b[0][dof + c] = e[c] / s;
    if (dof == 2) continue;
    for (int end = 1; end <= 2; end++) {
      b[end][c] = n[c] / s;
      b[end][dof + c] = -n[c] / s;
    }
  }
  if (dof == 2) return;
  b[1][2] = 1;
  b[2][dof + 2] = 1;
}

static void congruence(double b[BOND_MOTIONS][MOST_ORDER], bond_form d, int order,
                       double out[MOST_ORDER][MOST_ORDER]) {
  for (int p = 0; p < order; p++)
    for (int q = 0; q < order; q++) {
      double sum = 0;
      for (int m = 0; m < BOND_MOTIONS; m++)
        for (int n = 0; n < BOND_MOTIONS; n++)
          sum += b[m][p] * b[n][q] * d[m][n];
      out[p][q] = sum;
    }
}

/* B^T D B, as what the ends feel. */
static void bond_part(const pl_bond_class *bonds, bond_form d, int dof, wave_part *out) {
  double b[BOND_MOTIONS][MOST_ORDER], m[MOST_ORDER][MOST_ORDER];
  kinematic_matrix(bonds->chord, bonds->s, dof, b);
  congruence(b, d, 2 * dof, m);
  for (int p = 0; p < dof; p++)
    for (int q = 0; q < dof; q++) {
      out->self[p][q] = m[p][q] + m[dof + p][dof + q];
      out->forward[p][q] = m[p][dof + q];
      out->backward[p][q] = m[dof + p][q];
    }
}

/* --- the infinite lattice --------------------------------------------------------------------- */

/* `definite`: no body of such bonds is faster. */
static crystal crystal_of_bonds(const pl_law *law, const double *parameters,
                                const parameter_planes *fields, const rows *w, bool *definite) {
  crystal c = crystal_new(w, law->dof, w->directions);
  *definite = true;
  for (int k = 0; k < w->directions; k++) {
    const pl_bond_class bonds = rows_bond_class(w, k);
    bond_forms f = fields ? bond_forms_between(law, parameters, &bonds, fields)
                          : bond_forms_of(law, parameters, &bonds);
    bond_part(&bonds, f.stiffness, c.dof, &c.terms[k].stiffness);
    bond_part(&bonds, f.damping, c.dof, &c.terms[k].damping);
    memcpy(c.terms[k].R, bonds.chord, sizeof bonds.chord);
    c.finite = c.finite && f.finite;
    c.damped = c.damped || f.damped;
    *definite = *definite && f.definite;
  }
  return c;
}

/* Of a bond from here to R that resists no rigid motion: its energy is a form q D q/2 of the motion
   q = (u_R - u_0 - theta_0 x R, theta_R - theta_0) of its far end as the near end sees it, so that
   moving the far end alone gives f_0 = D (u_R, theta_R), and a moment R x f_0 beside. `block` is
   minus that, rotations as ways (stencil.h). */
static bool bond_is_definite(const crystal *c, const wave_term *t, const wave_block block,
                             double spacing) {
  const int d = c->dimensions, n = c->dof;
  const double R[3] = {t->R[0] / spacing, t->R[1] / spacing, t->R[2] / spacing};
  double form[MOST_DOF * MOST_DOF], mean[MOST_DOF * MOST_DOF];
  for (int q = 0; q < n; q++) {
    for (int p = 0; p < n; p++)
      form[p * n + q] = -block[p][q];
    for (int axis = 0; axis < n - d; axis++) {
      const int a = d == 2 ? 0 : (axis + 1) % 3, b = d == 2 ? 1 : (axis + 2) % 3;
      form[(d + axis) * n + q] += R[a] * block[b][q] - R[b] * block[a][q];
    }
  }
  for (int p = 0; p < n; p++)
    for (int q = 0; q < n; q++)
      mean[p * n + q] = 0.5 * (form[p * n + q] + form[q * n + p]);
  return form_is_definite(n, mean, -STABILITY_LEAST);
}

/* Of a law of bonds as one of families: every block is that of a bond, from differences of
   forces. */
static bool blocks_are_definite(const crystal *c, double spacing) {
  for (int n = 1; n < c->term_count; n++) {
    const wave_term *t = &c->terms[n];
    if (!bond_is_definite(c, t, t->stiffness.forward, spacing) ||
        !bond_is_definite(c, t, t->damping.forward, spacing))
      return false;
  }
  return true;
}

static crystal crystal_of(const pl_law *law, const double *parameters,
                          const parameter_planes *fields, const rows *w, bool *definite) {
  if (law->kind != PL_STATE) return crystal_of_bonds(law, parameters, fields, w, definite);
  const crystal c = stencil_crystal(law, parameters, w);
  *definite = law->pairwise && blocks_are_definite(&c, w->spacing);
  return c;
}

bool stability_at_rest(const step_limit *limit) {
  const double turning = 8; /* twice what the two examples have at most, over the prestrain */
  return limit->least >= STABILITY_LEAST - turning * limit->prestrain;
}

/* --- the limit -------------------------------------------------------------------------------- */

double stability_rounded(double x) {
  enum { KEPT = 10, EXPONENT = 19 }; /* places in d.ddddddddddddddddde-xx */
  char digits[40];
  if (!isfinite(x) || !(x > 0)) return x;
  snprintf(digits, sizeof digits, "%.17e", x * (1 + 1e-12));
  memmove(digits + KEPT, digits + EXPONENT, strlen(digits + EXPONENT) + 1);
  return strtod(digits, NULL);
}

static void take_body(const pl_law *law, const double *parameters, const parameter_planes *fields,
                      const rows *w, step_limit *out) {
  step_limit body = *out;
  body_limit(law, parameters, fields ? fields->value : NULL, w, &body);
  body.at_surface = body.limit < out->limit * (1 - BODY_ACCURACY);
  if (body.at_surface) *out = body;
  out->least = body.least;
  out->prestrain = body.prestrain;
}

/* No particle is lighter. */
static void take_lightest(crystal *c, const rows *w) {
  double least = INFINITY;
  for (long p = 0; p < w->particle_count; p++)
    least = pl_fmin(least, w->site_mass[w->particle_site[p]]);
  for (int d = 0; d < c->dof && w->particle_count > 0; d++)
    c->scale[d] *= sqrt(w->mass / least);
}

static void find_limit(const pl_law *law, const double *parameters, const parameter_planes *fields,
                       const rows *w, step_limit *out) {
  bool definite;
  out->at_surface = false;
  out->least = out->prestrain = 0;
  if (w->list || (fields && law->kind == PL_STATE)) {
    out->limit = 0;
    body_limit(law, parameters, fields ? fields->value : NULL, w, out);
    return;
  }
  crystal c = crystal_of(law, parameters, fields, w, &definite);
  if (w->site_mass) take_lightest(&c, w);
  waves_limit(&c, out);
  crystal_free(&c);
  if (w->site_mass && !c.damped) {
    body_limit(law, parameters, fields ? fields->value : NULL, w, out);
    return;
  }
  if (!definite && out->limit > 0) take_body(law, parameters, fields, w, out);
}

void stability_limit(const pl_law *law, const double *parameters, const parameter_planes *fields,
                     const rows *w, step_limit *out) {
  find_limit(law, parameters, fields, w, out);
  out->limit = stability_rounded(out->limit);
}

void stability_limit_joint(const struct interaction_law *laws, int count, const rows *w,
                           step_limit *out) {
  *out = (step_limit){0};
  body_limit_joint(laws, count, w, out);
  out->limit = stability_rounded(out->limit);
}

double stability_omega(const pl_law *law, const double *parameters, const rows *w, double kx,
                       double ky) {
  bool definite;
  crystal c = crystal_of(law, parameters, NULL, w, &definite);
  const double omega = waves_omega(&c, (const double[3]){kx, ky, 0});
  crystal_free(&c);
  return omega;
}
