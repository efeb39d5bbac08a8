#include "generator/sense/sense_response.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "dsl/base/arena.h"
#include "dsl/base/elementary.h"
#include "generator/check/physics_bench.h"
#include "generator/check/physics_point_bench.h"

static const double OFF_THE_LINE = 0.1;
static const double FALLEN = 0.5; /* of a peak, where a stress that falls later counts as one */

static double strain_of_step(int k) {
  return pl_pow(10, -12 + 12.0 * k / (RESPONSE_STEPS - 1));
}

static void finish(response *r) {
  r->limit = r->peak = -1;
  r->area = 0;
  r->stiffness = r->stress[0] / r->strain[0];
  int most = 0;
  for (int k = 0; k < r->count; k++) {
    const double line = r->stiffness * r->strain[k];
    if (r->limit < 0 && fabs(r->stress[k] - line) > OFF_THE_LINE * line) r->limit = k;
    if (r->stress[k] > r->stress[most]) most = k;
    if (k > 0)
      r->area += 0.5 * (r->stress[k] + r->stress[k - 1]) * (r->strain[k] - r->strain[k - 1]);
  }
  for (int k = most; k < r->count; k++)
    if (r->stress[k] < FALLEN * r->stress[most]) r->peak = most;
}

/* --- a bond ----------------------------------------------------------------------------------- */

static bool of_bond(const sense_bench *s, const double *parameters, int sign, response *r) {
  physics_options with = *s->options;
  diagnostics unsaid;
  bench b;
  with.parameters = parameters;
  diag_begin(&unsaid, s->said->sources);
  const bool opened = bench_open(&b, s->law, &with, &unsaid);
  diag_clear(&unsaid);
  if (!opened) return false;
  double **states = bench_states(&b);
  bench_draw(&b, states, 0);
  bench_virgin(&b, states, 0);
  bool finite = true;
  for (int k = 0; k < RESPONSE_STEPS && finite; k++) {
    const double strain = strain_of_step(k);
    if (sign < 0 && strain > 0.9) break;
    bench_move(&b, states, 0, (motion){.at[AXIS_STRETCH] = sign * strain});
    probe_run(&b, &b.step, states, 1);
    r->strain[k] = strain;
    r->stress[k] = sign * b.step.out[FORCE_N][0];
    r->count = k + 1;
    finite = isfinite(r->stress[k]);
    bench_accept(&b, states, 1);
  }
  bench_states_free(&b, states);
  bench_close(&b);
  return finite && r->stress[0] > 0;
}

/* --- a point ---------------------------------------------------------------------------------- */

/* Free sides: strains across by Newton's method, the same on both in space. */
static bool free_sides(point_bench *p, double *strain, double scale) {
  enum { MOST_LOOKS = 60 };
  const int n = p->strains, sides = n == 3 ? 1 : 2;
  for (int look = 0; look < MOST_LOOKS; look++) {
    double stress[POINT_MOST];
    point_bench_stress(p, strain, stress);
    if (!isfinite(stress[1])) return false;
    if (fabs(stress[1]) <= 1e-6 * pl_fmax(fabs(stress[0]), 1e-6 * scale)) return true;
    point_bench_run(p, p->kernel->point_tangent, 1e-6);
    double slope = 0;
    for (int k = 1; k <= sides; k++)
      slope += p->tangent[n + k][0];
    if (!isfinite(slope) || slope == 0) return false;
    const double change = stress[1] / slope;
    for (int k = 1; k <= sides; k++)
      strain[k] -= change;
  }
  return false;
}

static law_setting setting_of_pull(const law *l) {
  return law_is_for(l, SETTING_SPACE) ? SETTING_SPACE : l->setting;
}

static bool pull(point_bench *p, int sign, response *r) {
  double strain[POINT_MOST] = {0}, last[POINT_MOST] = {0}, stress[POINT_MOST];
  point_bench_virgin(p);
  for (int k = 0; k < RESPONSE_STEPS; k++) {
    const double size = strain_of_step(k), before = k > 0 ? strain_of_step(k - 1) : 0;
    for (int q = 1; q < p->strains / 2 + (p->strains == 3); q++)
      strain[q] = k > 0 ? last[q] * size / before : 0;
    strain[0] = sign * size;
    const double scale = k > 0 ? r->stress[0] / r->strain[0] * size : 0;
    if (!free_sides(p, strain, scale)) return k > 0 && r->count > RESPONSE_STEPS / 2;
    point_bench_stress(p, strain, stress);
    r->strain[k] = size;
    r->stress[k] = sign * stress[0];
    r->count = k + 1;
    memcpy(last, strain, sizeof last);
    point_bench_keep(p);
  }
  return true;
}

static bool of_point(const sense_bench *s, const double *parameters, int sign, response *r) {
  const physics_options with = {.parameters = parameters};
  physics_report unwanted = {0};
  diagnostics unsaid;
  diag_begin(&unsaid, s->said->sources);
  point_bench *p = must_calloc(1, sizeof *p);
  *p = (point_bench){.law = s->law, .said = &unsaid, .report = &unwanted};
  const law_setting setting = setting_of_pull(s->law);
  bool known = setting != SETTING_PLANE_STRAIN && point_bench_open(p, setting);
  if (known) {
    point_bench_parameters(p, &with, true);
    r->size = p->size[0];
    known = pull(p, sign, r) && r->stress[0] > 0;
  }
  point_bench_close(p);
  free(p);
  diag_clear(&unsaid);
  return known;
}

bool response_of(const sense_bench *b, const double *parameters, int sign, response *r) {
  const law_kind kind = b->law->tree->law;
  *r = (response){.count = 0};
  const bool known = kind == LAW_CONTINUUM ? of_point(b, parameters, sign, r)
                     : kind == LAW_CENTRAL_BOND || kind == LAW_MICROPOLAR_BOND
                         ? of_bond(b, parameters, sign, r)
                         : false;
  if (known) finish(r);
  return known;
}
