#include "generator/check/physics_points.h"

#include <math.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>

#include "dsl/base/elementary.h"
#include "generator/check/physics_parameters.h"
#include "generator/interpreter/interpreted.h"
#include "generator/ir/random_values.h"
#include "runtime/base/eigen.h"

enum { LANES = PL_LANES, MOST = PL_MAX_STRAINS, USUAL_SEED = 20 };

static const double REST_TOLERANCE = 1e-12;    /* of the stress at a strain of 1e-3 */
static const double TANGENT_TOLERANCE = 1e-5;  /* of its largest entry, against differences */
static const double SYMMETRY_TOLERANCE = 1e-9; /* of its largest entry */
static const double PATH_TOLERANCE = 1e-6;     /* of the work of the absolute stresses */
static const double CELL = 0.01;               /* m, size of the cell */

/* One point on the interpreter; kernels take PL_LANES points, of which the first counts. */
typedef struct point {
  const law *law;
  kernel_plan *plan;
  pl_law *kernel;
  diagnostics *said;
  physics_report *report;
  uint64_t seed;
  double *parameters, *uniforms;
  bool failed[DIAG_COUNT];
  int strains, stresses;
  double strain[MOST][LANES], rate[MOST][LANES], size[LANES];
  double stress[MOST][LANES], tangent[MOST * MOST][LANES], lost[PL_LOSSES][LANES];
  double *space, **old_field, **new_field, **observed;
  const double *strain_at[MOST], *rate_at[MOST];
  double *stress_at[MOST], *tangent_at[MOST * MOST], *lost_at[PL_LOSSES];
} point;

/* --- the bench -------------------------------------------------------------------------------- */

static double **planes(double **space, int count) {
  double **all = must_calloc((size_t)count + 1, sizeof *all);
  for (int k = 0; k < count; k++, *space += LANES)
    all[k] = *space;
  return all;
}

static bool point_open(point *p, const law *l, const physics_options *o, diagnostics *d) {
  p->law = l;
  p->said = d;
  p->seed = o->seed ? o->seed : USUAL_SEED;
  p->plan = plan_kernel(l, d);
  if (!p->plan) return false;
  p->kernel = plan_interpreted(p->plan);
  const int fields = l->fields.count, observed = 1 + l->outputs.count;
  p->strains = PL_STRAINS(p->kernel->dimensions);
  p->stresses = PL_STRESSES(p->kernel->dimensions);
  p->parameters = must_calloc((size_t)l->parameters.count + 1, sizeof(double));
  p->uniforms = must_calloc((size_t)p->kernel->uniform_count + 1, sizeof(double));
  double *space = p->space = must_calloc((size_t)((2 * fields + observed) * LANES), sizeof(double));
  p->old_field = planes(&space, fields);
  p->new_field = planes(&space, fields);
  p->observed = planes(&space, observed);
  for (int k = 0; k < MOST; k++) {
    p->strain_at[k] = p->strain[k];
    p->rate_at[k] = p->rate[k];
    p->stress_at[k] = p->stress[k];
  }
  for (int k = 0; k < MOST * MOST; k++)
    p->tangent_at[k] = p->tangent[k];
  for (int k = 0; k < PL_LOSSES; k++)
    p->lost_at[k] = p->lost[k];
  for (int k = 0; k < LANES; k++)
    p->size[k] = CELL;
  return true;
}

static void point_close(point *p) {
  plan_interpreted_free(p->kernel);
  plan_free(p->plan);
  free(p->parameters);
  free(p->uniforms);
  free(p->space);
  free(p->old_field);
  free(p->new_field);
  free(p->observed);
}

static void point_run(point *p, pl_point_function function, double time_step) {
  const pl_points given = {.size = sizeof given,
                           .count = LANES,
                           .strain = p->strain_at,
                           .strain_rate = p->rate_at,
                           .cell_size = p->size,
                           .old_field = (const double *const *)p->old_field,
                           .new_field = p->new_field,
                           .stress = p->stress_at,
                           .tangent = p->tangent_at,
                           .observed = p->observed,
                           .lost = p->lost_at,
                           .time_step = time_step};
  function(p->kernel, p->uniforms, &given);
  p->report->states += LANES;
}

static void take_parameters(point *p, const physics_options *o, bool usual) {
  if (o->parameters)
    memcpy(p->parameters, o->parameters, (size_t)p->law->parameters.count * sizeof(double));
  else
    physics_draw_parameters(p->law, usual ? NULL : &p->seed, p->parameters);
  const pl_bond_class none = {.size = sizeof none};
  p->kernel->prepare(p->kernel, p->parameters, &none, p->uniforms);
}

static void set_virgin(point *p) {
  for (int k = 0; k < p->law->fields.count; k++)
    for (int lane = 0; lane < LANES; lane++)
      p->old_field[k][lane] = p->law->fields.items[k]->initial;
}

static void set_strain(point *p, const double *strain, const double *rate) {
  for (int k = 0; k < p->strains; k++)
    for (int lane = 0; lane < LANES; lane++) {
      p->strain[k][lane] = strain[k];
      p->rate[k][lane] = rate ? rate[k] : 0;
    }
}

static double draw_direction(point *p, double size, double *strain) {
  double length = 0;
  for (int k = 0; k < p->strains; k++) {
    strain[k] = draw_uniform(&p->seed, -1, 1);
    length += strain[k] * strain[k];
  }
  for (int k = 0; k < p->strains; k++)
    strain[k] *= size / sqrt(length);
  return size;
}

static double draw_strain(point *p, double *strain) {
  return draw_direction(p, pl_pow(10, draw_uniform(&p->seed, -7, -2)), strain);
}

static bool is_shear(const point *p, int k) {
  return k >= p->strains / 2 + (p->strains == 3);
}

/* Work of a stress over a small change of strain: shears count twice. */
static double work(const point *p, const double *stress, const double *change, double *size) {
  double sum = 0;
  for (int k = 0; k < p->strains; k++) {
    const double part = stress[k] * change[k] * (is_shear(p, k) ? 2 : 1);
    sum += part;
    *size += fabs(part);
  }
  return sum;
}

static void get_stress(const point *p, double *stress) {
  for (int k = 0; k < p->strains; k++)
    stress[k] = p->stress[k][0];
}

static double largest(const double *v, int count) {
  double most = 0;
  for (int k = 0; k < count; k++)
    if (!(fabs(v[k]) <= most)) most = fabs(v[k]);
  return most;
}

/* --- what is said ----------------------------------------------------------------------------- */

static const char *component_name(const point *p, int k) {
  static const char *const plane[] = {"xx", "yy", "xy"}, *const space[] = {"xx", "yy", "zz",
                                                                           "xy", "yz", "xz"};
  return p->strains == 3 ? plane[k] : space[k];
}

/* One a kind, with the strain that shows it (NULL: rest). */
static void say(point *p, diag_code code, const double *strain, const char *format, ...)
    __attribute__((format(printf, 4, 5)));
static void say(point *p, diag_code code, const double *strain, const char *format, ...) {
  if (p->failed[code]) return;
  p->failed[code] = true;
  char message[512], state[256] = "";
  va_list values;
  va_start(values, format);
  vsnprintf(message, sizeof message, format, values);
  va_end(values);
  const symbol *s =
      p->law->results[RESULT_SIGMA] ? p->law->results[RESULT_SIGMA] : p->law->results[RESULT_W];
  diag_report(p->said, code, s->rule->where, "%s", message);
  for (int k = 0; strain && k < p->strains; k++) {
    const size_t used = strlen(state);
    snprintf(state + used, sizeof state - used, "%s%s = %.4g", k ? ", " : "", component_name(p, k),
             strain[k]);
  }
  if (strain) diag_note(p->said, (span){0, 0, UINT16_MAX}, "found at the strain %s", state);
}

/* --- the checks ------------------------------------------------------------------------------- */

static void check_rest(point *p) {
  double strain[MOST] = {0}, stress[MOST];
  set_virgin(p);
  draw_direction(p, 1e-3, strain);
  set_strain(p, strain, NULL);
  point_run(p, p->kernel->point_step, 1e-6);
  get_stress(p, stress);
  const double scale = largest(stress, p->strains);
  memset(strain, 0, sizeof strain);
  set_strain(p, strain, NULL);
  point_run(p, p->kernel->point_step, 1e-6);
  get_stress(p, stress);
  const double found = largest(stress, p->strains);
  if (!(found <= REST_TOLERANCE * scale) || !(scale > 0))
    say(p, DIAG_REST_FORCE, NULL,
        scale > 0 ? "the virgin point at rest has a stress of %.6g Pa"
                  : "the virgin point has no stress when it is strained",
        found);
}

static double tangent_scale(const point *p) {
  double most = 0;
  for (int k = 0; k < p->strains * p->strains; k++)
    if (!(fabs(p->tangent[k][0]) <= most)) most = fabs(p->tangent[k][0]);
  return most;
}

/* The smallest eigenvalue of the tangent's symmetric part. */
static double least_stiffness(const point *p) {
  double matrix[EIGEN_MOST][EIGEN_MOST], value[EIGEN_MOST], vectors[EIGEN_MOST][EIGEN_MOST];
  for (int a = 0; a < p->strains; a++)
    for (int b = 0; b < p->strains; b++)
      matrix[a][b] = 0.5 * (p->tangent[a * p->strains + b][0] + p->tangent[b * p->strains + a][0]);
  eigen_symmetric(p->strains, matrix, value, vectors);
  double least = value[0];
  for (int k = 1; k < p->strains; k++)
    if (!(value[k] >= least)) least = value[k];
  return least;
}

static void check_stiffness(point *p) {
  const double rest[MOST] = {0};
  set_virgin(p);
  set_strain(p, rest, NULL);
  point_run(p, p->kernel->point_tangent, 1e-6);
  if (!isfinite(tangent_scale(p))) {
    say(p, DIAG_STIFFNESS, NULL, "the tangent of the virgin point is not finite");
    return;
  }
  const double least = least_stiffness(p);
  if (!(least > 0))
    say(p, DIAG_STIFFNESS, NULL,
        "the virgin point has a strain against which it is not stiff (%.4g Pa): it would fly apart",
        least);
}

/* The largest difference between the tangent and the stress's central differences. */
static double tangent_gap(point *p, const double *strain, const double *tangent, double by) {
  double moved[MOST], high[MOST], low[MOST], difference = 0;
  for (int b = 0; b < p->strains; b++) {
    for (int side = 0; side < 2; side++) {
      memcpy(moved, strain, sizeof moved);
      moved[b] += side ? -by : by;
      set_strain(p, moved, NULL);
      point_run(p, p->kernel->point_step, 1e-6);
      get_stress(p, side ? low : high);
    }
    for (int a = 0; a < p->strains; a++) {
      const double slope = (high[a] - low[a]) / (2 * by) * (is_shear(p, b) ? 0.5 : 1);
      difference = pl_fmax(difference, fabs(slope - tangent[a * p->strains + b]));
    }
  }
  return difference;
}

/* Across a kink differences say nothing; smaller ones are asked then. */
static void check_tangent(point *p) {
  double strain[MOST], tangent[MOST * MOST];
  const double size = draw_strain(p, strain);
  if (p->law->fields.count > 0) return;
  set_virgin(p);
  set_strain(p, strain, NULL);
  point_run(p, p->kernel->point_tangent, 1e-6);
  const double scale = tangent_scale(p);
  for (int k = 0; k < p->strains * p->strains; k++)
    tangent[k] = p->tangent[k][0];
  const double difference = pl_fmin(tangent_gap(p, strain, tangent, 1e-4 * size),
                                    tangent_gap(p, strain, tangent, 1e-5 * size));
  if (!isfinite(difference) || !isfinite(scale))
    say(p, DIAG_NOT_FINITE, strain, "the stress or the tangent of a finite strain is not finite");
  else if (!(difference <= TANGENT_TOLERANCE * scale))
    say(p, DIAG_TANGENT, strain,
        "the tangent is off the stress's differences by %.3g of its largest entry",
        difference / scale);
}

/* Of laws without states, whose tangent is that of the stress with nothing else changing. */
static void check_symmetry(point *p) {
  double strain[MOST];
  if (p->law->nonconservative || p->law->fields.count > 0 || p->kernel->reads_rates) return;
  draw_strain(p, strain);
  set_virgin(p);
  set_strain(p, strain, NULL);
  point_run(p, p->kernel->point_tangent, 1e-6);
  double most = 0;
  const double scale = tangent_scale(p);
  for (int a = 0; a < p->strains; a++)
    for (int b = 0; b < a; b++)
      most = pl_fmax(most,
                     fabs(p->tangent[a * p->strains + b][0] - p->tangent[b * p->strains + a][0]));
  if (isfinite(scale) && !(most <= SYMMETRY_TOLERANCE * scale))
    say(p, DIAG_STORED_ENERGY, strain,
        "the stress has no energy: its tangent is not symmetric, by %.3g of its largest entry",
        most / scale);
}

/* Where both are given: the work over a small straight change of strain is that of the energy. */
static void check_energy_and_stress(point *p) {
  if (!p->law->results[RESULT_SIGMA] || !p->law->results[RESULT_W]) return;
  double strain[MOST], moved[MOST], change[MOST], stress[MOST], energy[2], size = 0;
  const double length = draw_strain(p, strain);
  draw_direction(p, 1e-3 * length, change);
  set_virgin(p);
  for (int side = 0; side < 2; side++) {
    for (int k = 0; k < p->strains; k++)
      moved[k] = strain[k] + (side ? 0.5 : -0.5) * change[k];
    set_strain(p, moved, NULL);
    point_run(p, p->kernel->point_observe, 1e-6);
    energy[side] = p->observed[0][0];
  }
  set_strain(p, strain, NULL);
  point_run(p, p->kernel->point_step, 1e-6);
  get_stress(p, stress);
  const double done = work(p, stress, change, &size);
  if (!isfinite(size) || !isfinite(energy[0]) || !isfinite(energy[1])) return; /* said elsewhere */
  if (p->law->fields.count == 0 && !(fabs(energy[1] - energy[0] - done) <= 1e-4 * size))
    say(p, DIAG_ENERGY_FORCE, strain,
        "the stress is not the energy's derivative: a small strain does work of %.6g J/m^3, the "
        "energy changes by %.6g J/m^3",
        done, energy[1] - energy[0]);
}

/* Around a random polygon of strains and back, in small steps: what is done must be at least what is
   stored and lost. */
static void check_paths(point *p) {
  enum { CORNERS = 5, STEPS = 200 };
  double corner[CORNERS + 1][MOST] = {{0}}, change[MOST], before[MOST], after[MOST];
  double strain[MOST] = {0}, total = 0, size = 0, lost_least = 0;
  double worst[MOST] = {0};
  const double length = pl_pow(10, draw_uniform(&p->seed, -5, -2)), time_step = 1e-6;
  for (int k = 1; k < CORNERS; k++)
    draw_direction(p, length, corner[k]);
  set_virgin(p);
  set_strain(p, strain, NULL);
  point_run(p, p->kernel->point_step, time_step);
  get_stress(p, before);
  for (int k = 0; k < CORNERS; k++)
    for (int step = 1; step <= STEPS; step++) {
      double rate[MOST];
      for (int c = 0; c < p->strains; c++) {
        const double next = corner[k][c] + (corner[k + 1][c] - corner[k][c]) * step / STEPS;
        change[c] = next - strain[c];
        strain[c] = next;
        rate[c] = change[c] / time_step;
      }
      set_strain(p, strain, p->kernel->reads_rates ? rate : NULL);
      memset(p->lost, 0, sizeof p->lost);
      point_run(p, p->kernel->point_ledger, time_step);
      get_stress(p, after);
      for (int c = 0; c < p->strains; c++)
        before[c] = 0.5 * (before[c] + after[c]);
      total += work(p, before, change, &size);
      memcpy(before, after, sizeof before);
      for (int f = 0; f < p->law->fields.count; f++)
        memcpy(p->old_field[f], p->new_field[f], LANES * sizeof(double));
      for (int k2 = 0; k2 < PL_LOSSES; k2++)
        if (p->lost[k2][0] < lost_least) {
          lost_least = p->lost[k2][0];
          memcpy(worst, strain, sizeof worst);
        }
      if (!isfinite(total))
        say(p, DIAG_NOT_FINITE, strain, "the stress of a finite strain is not finite");
    }
  const bool conserves = p->law->fields.count == 0 && !p->kernel->reads_rates;
  if (!p->law->nonconservative && conserves && fabs(total) > 1e-3 * size)
    say(p, DIAG_CLOSED_PATH, corner[1],
        "around a closed path of strain the point %s %.3g of the work",
        total < 0 ? "gains" : "loses", fabs(total) / size);
  if (!conserves && total < -1e-3 * size)
    say(p, DIAG_CLOSED_PATH, corner[1],
        "around a closed path of strain the point gains %.3g of the work", -total / size);
  if (!p->law->nonconservative && lost_least < -PATH_TOLERANCE * size / (CORNERS * STEPS))
    say(p, DIAG_DISSIPATION, worst, "a step of strain loses a negative energy, %.3g J/m^3",
        lost_least);
}

void physics_check_points(const law *l, const physics_options *o, diagnostics *d,
                          physics_report *report) {
  enum { SETS = 6, ROUNDS = 40 };
  point *p = must_calloc(1, sizeof *p);
  p->report = report;
  if (point_open(p, l, o, d)) {
    const double effort = o->effort > 0 ? o->effort : 1;
    for (int set = 0; set < SETS; set++) {
      take_parameters(p, o, set == 0);
      check_rest(p);
      check_stiffness(p);
      for (int round = 0; round < ROUNDS * effort; round++) {
        check_tangent(p);
        check_symmetry(p);
        check_energy_and_stress(p);
      }
      for (int round = 0; round < 4 * effort; round++)
        check_paths(p);
    }
    point_close(p);
  }
  free(p);
}
