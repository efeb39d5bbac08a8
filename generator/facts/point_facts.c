#include "generator/facts/point_facts.h"

#include <math.h>
#include <stdlib.h>

#include "dsl/base/arena.h"
#include "generator/check/physics_point_bench.h"
#include "runtime/crack/wave_speeds.h"

static const double ISOTROPY_TOLERANCE = 1e-9; /* of the tangent's largest entry */

/* An isotropic tangent has D11 on the diagonal of the normal strains, D12 beside it, and
   (D11 - D12)/2 for shears. */
static bool is_isotropic(const point_bench *b) {
  const int normal = b->strains == 3 ? 2 : 3;
  const double D11 = b->tangent[0][0], D12 = b->tangent[1][0], size = point_bench_tangent_size(b);
  for (int i = 0; i < b->strains; i++)
    for (int k = 0; k < b->strains; k++) {
      const double expected = i != k       ? i < normal && k < normal ? D12 : 0
                              : i < normal ? D11
                                           : (D11 - D12) / 2;
      if (!(fabs(b->tangent[i * b->strains + k][0] - expected) <= ISOTROPY_TOLERANCE * size))
        return false;
    }
  return D11 > 0 && D11 > fabs(D12);
}

/* lambda/(2 (lambda + mu)), or that of plane stress. */
static void find_moduli(point_facts *f, double D11, double D12) {
  const double mu = (D11 - D12) / 2;
  f->nu = f->setting == SETTING_PLANE_STRESS ? D12 / D11 : D12 / (D11 + D12);
  f->E = 2 * mu * (1 + f->nu);
}

static void find_facts(point_bench *b, point_facts *f) {
  const double rest[POINT_MOST] = {0};
  point_bench_virgin(b);
  point_bench_strain(b, rest, NULL);
  point_bench_run(b, b->kernel->point_tangent, 1e-6);
  f->linear = b->plan->linear && !b->law->rest;
  f->isotropic = is_isotropic(b);
  f->has_mass = b->law->rho != NULL;
  if (!f->isotropic) return;
  const double D11 = b->tangent[0][0], D12 = b->tangent[1][0];
  find_moduli(f, D11, D12);
  if (!f->has_mass) return;
  const crack_medium m =
      crack_medium_of(D11, D12, (D11 - D12) / 2, b->parameters[b->law->rho->index]);
  f->c_d = m.c_d;
  f->c_s = m.c_s;
  f->c_R = m.c_R;
}

int point_facts_of(const law *l, const double *values, point_facts found[POINT_SETTINGS]) {
  static const law_setting settings[POINT_SETTINGS] = {SETTING_PLANE_STRESS, SETTING_PLANE_STRAIN,
                                                       SETTING_SPACE};
  const physics_options options = {.parameters = values};
  physics_report unwanted = {0};
  diagnostics unsaid;
  int count = 0;
  diag_begin(&unsaid, NULL);
  point_bench *b = must_calloc(1, sizeof *b);
  for (int k = 0; k < POINT_SETTINGS; k++) {
    if (!law_is_for(l, settings[k])) continue;
    *b = (point_bench){.law = l, .said = &unsaid, .report = &unwanted};
    if (point_bench_open(b, settings[k])) {
      point_bench_parameters(b, &options, true);
      found[count] = (point_facts){.setting = settings[k]};
      find_facts(b, &found[count++]);
    }
    point_bench_close(b);
  }
  free(b);
  diag_clear(&unsaid);
  return count;
}
