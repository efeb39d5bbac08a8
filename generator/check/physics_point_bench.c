#include "generator/check/physics_point_bench.h"

#include <math.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>

#include "dsl/base/arena.h"
#include "dsl/base/elementary.h"
#include "dsl/semantics/law_reads.h"
#include "generator/check/physics_parameters.h"
#include "generator/interpreter/interpreted.h"
#include "generator/ir/random_values.h"

enum { LANES = POINT_LANES, MOST = POINT_MOST };

static const double CELL = 0.01; /* m, size of the cell */

static double **planes(double **space, int count) {
  double **all = must_calloc((size_t)count + 1, sizeof *all);
  for (int k = 0; k < count; k++, *space += LANES)
    all[k] = *space;
  return all;
}

static void point_at_planes(point_bench *b) {
  const int fields = b->law->fields.count, observed = 1 + b->law->outputs.count;
  double *space = b->space = must_calloc((size_t)((2 * fields + observed) * LANES), sizeof(double));
  b->old_field = planes(&space, fields);
  b->new_field = planes(&space, fields);
  b->observed = planes(&space, observed);
  for (int k = 0; k < MOST; k++) {
    b->strain_at[k] = b->strain[k];
    b->rate_at[k] = b->rate[k];
    b->stress_at[k] = b->stress[k];
  }
  for (int k = 0; k < MOST * MOST; k++)
    b->tangent_at[k] = b->tangent[k];
  for (int k = 0; k < PL_LOSSES; k++)
    b->lost_at[k] = b->lost[k];
  for (int k = 0; k < LANES; k++)
    b->size[k] = CELL;
}

bool point_bench_open(point_bench *b, law_setting setting) {
  b->setting = *b->law;
  b->setting.setting = setting;
  b->plan = plan_kernel_varying(&b->setting, &(law_variation){.measured = true}, b->said);
  if (!b->plan) return false;
  b->kernel = plan_interpreted(b->plan);
  b->reads_time = law_reads_time(&b->setting);
  b->strains = PL_STRAINS(b->kernel->dimensions);
  b->stresses = PL_STRESSES(b->kernel->dimensions);
  b->parameters = must_calloc((size_t)b->law->parameters.count + 1, sizeof(double));
  b->uniforms = must_calloc((size_t)b->kernel->uniform_count + 1, sizeof(double));
  point_at_planes(b);
  return true;
}

void point_bench_close(point_bench *b) {
  if (!b->plan) return;
  plan_interpreted_free(b->kernel);
  plan_free(b->plan);
  free(b->parameters);
  free(b->uniforms);
  free(b->space);
  free(b->old_field);
  free(b->new_field);
  free(b->observed);
  b->plan = NULL;
}

/* Of the cell: CELL, or as near to it as the law holds for with room to spare. */
static void choose_size(point_bench *b) {
  double low = 0, high = INFINITY;
  unsigned char open[2];
  const pl_law *kernel = b->kernel;
  if (kernel->size_bounds)
    kernel->size_bounds(kernel, b->parameters, &low, &high, &open[0], &open[1]);
  for (int k = 0; k < LANES; k++)
    b->size[k] = pl_fmax(2 * low, pl_fmin(high / 2, CELL));
}

void point_bench_parameters(point_bench *b, const physics_options *o, bool usual) {
  b->others = !o->parameters && !usual;
  if (o->parameters)
    memcpy(b->parameters, o->parameters, (size_t)b->law->parameters.count * sizeof(double));
  else
    physics_draw_parameters(b->law, usual ? NULL : &b->seed, b->parameters);
  choose_size(b);
  const pl_bond_class none = {.size = sizeof none};
  b->kernel->prepare(b->kernel, b->parameters, &none, b->uniforms);
}

void point_bench_virgin(point_bench *b) {
  for (int k = 0; k < b->law->fields.count; k++)
    for (int lane = 0; lane < LANES; lane++)
      b->old_field[k][lane] = b->law->fields.items[k]->initial;
}

void point_bench_keep(point_bench *b) {
  for (int k = 0; k < b->law->fields.count; k++)
    memcpy(b->old_field[k], b->new_field[k], LANES * sizeof(double));
}

void point_bench_strain(point_bench *b, const double *strain, const double *rate) {
  for (int k = 0; k < b->strains; k++)
    for (int lane = 0; lane < LANES; lane++) {
      b->strain[k][lane] = strain[k];
      b->rate[k][lane] = rate ? rate[k] : 0;
    }
}

void point_bench_run(point_bench *b, pl_point_function function, double time_step) {
  const pl_points given = {.size = sizeof given,
                           .count = LANES,
                           .strain = b->strain_at,
                           .strain_rate = b->rate_at,
                           .cell_size = b->size,
                           .old_field = (const double *const *)b->old_field,
                           .new_field = b->new_field,
                           .stress = b->stress_at,
                           .tangent = b->tangent_at,
                           .observed = b->observed,
                           .lost = b->lost_at,
                           .time_step = time_step,
                           .advance = b->advance};
  function(b->kernel, b->uniforms, &given);
  b->report->states += LANES;
}

void point_bench_stress(point_bench *b, const double *strain, double *stress) {
  point_bench_strain(b, strain, NULL);
  point_bench_run(b, b->kernel->point_step, 1e-6);
  for (int k = 0; k < b->strains; k++)
    stress[k] = b->stress[k][0];
}

double point_bench_tangent_size(const point_bench *b) {
  double most = 0;
  for (int k = 0; k < b->strains * b->strains; k++)
    if (!(fabs(b->tangent[k][0]) <= most)) most = fabs(b->tangent[k][0]);
  return most;
}

double point_bench_direction(point_bench *b, double size, double *strain) {
  double length = 0;
  for (int k = 0; k < b->strains; k++) {
    strain[k] = draw_uniform(&b->seed, -1, 1);
    length += strain[k] * strain[k];
  }
  for (int k = 0; k < b->strains; k++)
    strain[k] *= size / sqrt(length);
  return size;
}

double point_bench_any_strain(point_bench *b, double *strain) {
  return point_bench_direction(b, pl_pow(10, draw_uniform(&b->seed, -7, -2)), strain);
}

bool point_bench_is_shear(const point_bench *b, int k) {
  return k >= b->strains / 2 + (b->strains == 3);
}

double point_bench_work(const point_bench *b, const double *stress, const double *change,
                        double *size) {
  double sum = 0;
  for (int k = 0; k < b->strains; k++) {
    const double part = stress[k] * change[k] * (point_bench_is_shear(b, k) ? 2 : 1);
    sum += part;
    *size += fabs(part);
  }
  return sum;
}

double point_bench_largest(const double *v, int count) {
  double most = 0;
  for (int k = 0; k < count; k++)
    if (!(fabs(v[k]) <= most)) most = fabs(v[k]);
  return most;
}

/* --- what is said ----------------------------------------------------------------------------- */

static const char *component_name(const point_bench *b, int k) {
  static const char *const plane[] = {"xx", "yy", "xy"};
  static const char *const space[] = {"xx", "yy", "zz", "xy", "yz", "xz"};
  return b->strains == 3 ? plane[k] : space[k];
}

static const char *setting_words(const point_bench *b) {
  return b->setting.setting == SETTING_SPACE          ? "in space"
         : b->setting.setting == SETTING_PLANE_STRESS ? "in plane stress"
                                                      : "in plane strain";
}

/* The state as text, to be freed: strain, setting, parameters that were drawn. */
static char *state_text(const point_bench *b, const double *strain) {
  char *text;
  size_t length;
  FILE *out = must_open_text(&text, &length);
  for (int k = 0; strain && k < b->strains; k++)
    fprintf(out, "%sstrain[%c,%c] = %.4g", k ? ", " : "", component_name(b, k)[0],
            component_name(b, k)[1], strain[k]);
  fprintf(out, strain ? ", %s" : "rest, %s", setting_words(b));
  if (b->advance > 0 || law_reads(b->law, QUANTITY_DT)) fprintf(out, ", dt = %.4g s", b->advance);
  for (int k = 0; b->others && k < b->law->parameters.count; k++) {
    const symbol *s = b->law->parameters.items[k];
    if (s == b->law->rho) continue;
    fprintf(out, "%s%s = %.4g", k ? ", " : "; with ", s->name, b->parameters[k]);
  }
  if (b->others) fputs(PHYSICS_OTHER_VALUES, out);
  must_close_text(out);
  return text;
}

static void tell(point_bench *b, span where, diag_code code, const double *strain, const char *mend,
                 const char *format, va_list values) {
  if (!diag_report_once(b->said, b->failed, code, where, format, values)) return;
  char *state = state_text(b, strain);
  diag_note(b->said, (span){0, 0, UINT16_MAX}, "found at %s", state);
  if (mend) diag_hint(b->said, "%s", mend);
  free(state);
}

void point_bench_say(point_bench *b, diag_code code, const double *strain, const char *mend,
                     const char *format, ...) {
  const symbol *const *given = b->law->results;
  const symbol *s = given[RESULT_SIGMA] ? given[RESULT_SIGMA] : given[RESULT_W];
  va_list values;
  va_start(values, format);
  tell(b, s->rule->where, code, strain, mend, format, values);
  va_end(values);
}

void point_bench_say_at(point_bench *b, span where, diag_code code, const double *strain,
                        const char *mend, const char *format, ...) {
  va_list values;
  va_start(values, format);
  tell(b, where, code, strain, mend, format, values);
  va_end(values);
}
