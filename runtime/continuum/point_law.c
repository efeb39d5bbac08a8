#include "runtime/continuum/point_law.h"

#include <stdlib.h>
#include <string.h>

#include "dsl/base/arena.h"

enum { STRAINS = 3, STRESSES = 4, TANGENTS = STRAINS * STRAINS };

int point_law_failed(const pl_law *law) {
  const int field = PL_HAS(law, failed_field) ? law->failed_field : -1;
  return field >= 0 && field < law->field_count && law->fields[field].kind == PL_FIELD_DAMAGE
             ? field
             : -1;
}

bool point_law_reads_size(const pl_law *law) {
  return PL_HAS(law, reads_size) && law->reads_size;
}

struct point_law {
  const pl_law *law;
  double *uniforms;
  /* every value stands PL_LANES times */
  double strain[STRAINS][PL_LANES], rate[STRAINS][PL_LANES], size[PL_LANES];
  double *out;       /* [PL_LANES] each: the most that one function writes */
  double *old, *new; /* [fields][PL_LANES] */
  double *parameter; /* [varying][PL_LANES]: those given */
  double **old_at, **new_at, **out_at, **parameter_at;
};

static double *lanes(int count) {
  return must_calloc(((size_t)count + 1) * PL_LANES, sizeof(double));
}

static double **planes(double *values, int count) {
  double **at = must_calloc((size_t)count + 1, sizeof *at);
  for (int k = 0; k < count; k++)
    at[k] = values + k * PL_LANES;
  return at;
}

static int most_written(const pl_law *law) {
  const int observed = 1 + law->output_count;
  return observed > TANGENTS ? observed : TANGENTS;
}

point_law *point_law_new(const pl_law *law, const double *parameters) {
  const pl_bond_class none = {.size = sizeof none};
  point_law *p = must_calloc(1, sizeof *p);
  p->law = law;
  p->uniforms = must_calloc((size_t)law->uniform_count + 1, sizeof *p->uniforms);
  p->out = lanes(most_written(law));
  p->old = lanes(law->field_count);
  p->new = lanes(law->field_count);
  p->out_at = planes(p->out, most_written(law));
  p->old_at = planes(p->old, law->field_count);
  p->new_at = planes(p->new, law->field_count);
  p->parameter = lanes(law->varying_count);
  p->parameter_at = planes(p->parameter, law->varying_count);
  for (int k = 0; k < law->varying_count; k++)
    for (int lane = 0; lane < PL_LANES; lane++)
      p->parameter_at[k][lane] = parameters[law->varying[k]];
  law->prepare(law, parameters, &none, p->uniforms);
  point_law_states(p, NULL);
  return p;
}

void point_law_free(point_law *p) {
  if (!p) return;
  free(p->uniforms);
  free(p->out);
  free(p->old);
  free(p->new);
  free(p->parameter);
  free(p->parameter_at);
  free(p->out_at);
  free(p->old_at);
  free(p->new_at);
  free(p);
}

void point_law_states(point_law *p, const double *field) {
  for (int f = 0; f < p->law->field_count; f++)
    for (int lane = 0; lane < PL_LANES; lane++)
      p->old_at[f][lane] = field ? field[f] : p->law->fields[f].initial;
}

/* One strip of the same point in all lanes. */
static void run(point_law *p, pl_point_function function, const double strain[3], double h) {
  const double *strain_at[STRAINS], *rate_at[STRAINS];
  for (int k = 0; k < STRAINS; k++) {
    strain_at[k] = p->strain[k];
    rate_at[k] = p->rate[k];
    for (int lane = 0; lane < PL_LANES; lane++)
      p->strain[k][lane] = strain[k];
  }
  for (int lane = 0; lane < PL_LANES; lane++)
    p->size[lane] = h;
  const pl_points points = {.size = sizeof points,
                            .count = PL_LANES,
                            .strain = strain_at,
                            .strain_rate = rate_at,
                            .cell_size = p->size,
                            .parameter = (const double *const *)p->parameter_at,
                            .old_field = (const double *const *)p->old_at,
                            .new_field = p->new_at,
                            .stress = p->out_at,
                            .tangent = p->out_at,
                            .observed = p->out_at};
  function(p->law, p->uniforms, &points);
}

void point_law_stress(point_law *p, const double strain[3], double h, double stress[4]) {
  run(p, p->law->point_step, strain, h);
  for (int k = 0; k < STRESSES; k++)
    stress[k] = p->out_at[k][0];
}

void point_law_observe(point_law *p, const double strain[3], double h, double *observed) {
  run(p, p->law->point_observe, strain, h);
  for (int k = 0; k < 1 + p->law->output_count; k++)
    observed[k] = p->out_at[k][0];
}

void point_law_tangent(point_law *p, const double strain[3], double h, double tangent[3][3]) {
  run(p, p->law->point_tangent, strain, h);
  for (int a = 0; a < STRAINS; a++)
    for (int b = 0; b < STRAINS; b++)
      tangent[a][b] = p->out_at[STRAINS * a + b][0];
}

void point_law_viscosity(point_law *p, double h, double viscosity[3][3]) {
  const double none[STRAINS] = {0};
  for (int b = 0; b < STRAINS; b++) {
    double stress[2][STRESSES];
    for (int side = 0; side < 2; side++) {
      for (int lane = 0; lane < PL_LANES; lane++)
        p->rate[b][lane] = side ? 1 : -1; /* 1/s */
      point_law_stress(p, none, h, stress[side]);
    }
    for (int lane = 0; lane < PL_LANES; lane++)
      p->rate[b][lane] = 0;
    for (int a = 0; a < STRAINS; a++) /* a shear of engineers is two of tensors */
      viscosity[a][b] = (stress[1][a] - stress[0][a]) / (b == 2 ? 4 : 2);
  }
}
