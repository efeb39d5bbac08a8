#include "generator/check/physics_tips.h"

#include <math.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>

#include "dsl/base/arena.h"
#include "dsl/base/elementary.h"
#include "generator/check/physics_parameters.h"
#include "generator/interpreter/interpreted.h"
#include "generator/ir/random_values.h"

enum { LANES = PL_LANES, USUAL_SEED = 21 };

static const double MIRROR_TOLERANCE = 1e-9;

typedef struct tip_bench {
  const law *law;
  kernel_plan *plan;
  pl_law *kernel;
  diagnostics *said;
  uint64_t seed;
  double *parameters, *uniforms;
  bool failed[DIAG_COUNT];
  double in[PL_TIP_INPUTS][LANES], out[PL_TIP_RESULTS][LANES];
  double **field, **new_field, **observed;
  int turned, turned_away; /* tips that grow to a side, and those toward the less opened one */
} tip_bench;

static double **planes(int count) {
  double **all = must_calloc((size_t)count + 1, sizeof *all);
  for (int k = 0; k < count; k++)
    all[k] = must_calloc(LANES, sizeof **all);
  return all;
}

static void planes_free(double **all, int count) {
  for (int k = 0; k < count; k++)
    free(all[k]);
  free(all);
}

static void look(tip_bench *b) {
  const double *in[PL_TIP_INPUTS];
  double *out[PL_TIP_RESULTS];
  for (int k = 0; k < PL_TIP_INPUTS; k++)
    in[k] = b->in[k];
  for (int k = 0; k < PL_TIP_RESULTS; k++)
    out[k] = b->out[k];
  const pl_tips tips = {.size = sizeof tips,
                        .count = LANES,
                        .in = in,
                        .old_field = (const double *const *)b->field,
                        .new_field = b->new_field,
                        .out = out,
                        .observed = b->observed,
                        .time_step = 1e-6};
  b->kernel->tip_look(b->kernel, b->uniforms, &tips);
}

static void say(tip_bench *b, diag_code code, law_result which, int lane, const char *mend,
                const char *format, ...) __attribute__((format(printf, 6, 7)));
static void say(tip_bench *b, diag_code code, law_result which, int lane, const char *mend,
                const char *format, ...) {
  va_list values;
  va_start(values, format);
  const bool first = diag_report_once(b->said, b->failed, code, b->law->results[which]->rule->where,
                                      format, values);
  va_end(values);
  if (!first) return;
  diag_note(b->said, (span){0, 0, UINT16_MAX},
            "found at K_I = %.4g, K_II = %.4g Pa*sqrt(m), speed_now = %.4g m/s, rayleigh_speed = "
            "%.4g m/s",
            b->in[PL_TIP_K_I][lane] + 0.0, b->in[PL_TIP_K_II][lane] + 0.0,
            b->in[PL_TIP_SPEED][lane], b->in[PL_TIP_RAYLEIGH_SPEED][lane]);
  diag_hint(b->said, "%s", mend);
}

/* Pairs of lanes: a tip, and the same with -K_II. */
static void draw(tip_bench *b, bool at_rest) {
  for (int lane = 0; lane < LANES; lane += 2) {
    const double size = at_rest ? 0 : pl_pow(10, draw_uniform(&b->seed, 3, 9)),
                 mode = draw_uniform(&b->seed, -3, 3), shear = draw_uniform(&b->seed, 1e3, 4e3);
    const bool runs = draw_bits(&b->seed) % 2;
    const double speed = runs ? draw_uniform(&b->seed, 0, 0.9 * 0.9 * shear) : 0;
    const double values[PL_TIP_INPUTS] = {size * pl_cos(mode),
                                          size * pl_sin(mode),
                                          size * size / 30e9,
                                          draw_uniform(&b->seed, -3, 3),
                                          speed,
                                          draw_uniform(&b->seed, 1e-3, 1),
                                          0.9 * shear,
                                          shear,
                                          1.6 * shear};
    for (int k = 0; k < PL_TIP_INPUTS; k++)
      b->in[k][lane] = b->in[k][lane + 1] = values[k];
    b->in[PL_TIP_K_II][lane + 1] = -values[PL_TIP_K_II];
    b->in[PL_TIP_ANGLE][lane + 1] = -values[PL_TIP_ANGLE];
  }
}

static void check_rest(tip_bench *b) {
  draw(b, true);
  look(b);
  for (int lane = 0; lane < LANES; lane++)
    if (b->out[PL_TIP_GROW][lane] != 0)
      say(b, DIAG_REST_FORCE, RESULT_GROW, lane,
          "let it grow where a stress intensity reaches a toughness that is above 0",
          "a tip without stress grows");
}

static bool are_alike(double a, double b) {
  return fabs(a - b) <= MIRROR_TOLERANCE * pl_fmax(1e-3, pl_fmax(fabs(a), fabs(b)));
}

static void check_mirror(tip_bench *b, int lane) {
  const bool here = b->out[PL_TIP_GROW][lane] != 0, there = b->out[PL_TIP_GROW][lane + 1] != 0;
  if (here != there)
    say(b, DIAG_MIRROR, RESULT_GROW, lane, "read K_II as `abs(K_II)` or `K_II**2`",
        "the tip grows, but its mirror image (-K_II) does not");
  if (!here || !there) return;
  const double *toward = b->out[PL_TIP_TOWARD] + lane, *speed = b->out[PL_TIP_RUN] + lane;
  if (!isfinite(toward[0] + toward[1] + speed[0] + speed[1])) return; /* said elsewhere */
  if (!are_alike(toward[0], -toward[1]))
    say(b, DIAG_MIRROR, RESULT_TOWARD, lane, "an odd function of K_II, such as `atan2(-K_II, K_I)`",
        "the mirror image of a tip (-K_II) turns to %.6g rad, not to %.6g: `toward` must be odd in "
        "K_II",
        toward[1], -toward[0]);
  if (!are_alike(speed[0], speed[1]))
    say(b, DIAG_MIRROR, RESULT_SPEED, lane, "read K_II as `abs(K_II)` or `K_II**2`",
        "the mirror image of a tip (-K_II) runs at %.6g m/s, not at %.6g: `speed` must be even in "
        "K_II",
        speed[1], speed[0]);
}

static void check_run(tip_bench *b, int lane) {
  const double speed = b->out[PL_TIP_RUN][lane], toward = b->out[PL_TIP_TOWARD][lane];
  if (b->out[PL_TIP_GROW][lane] == 0) return;
  if (!isfinite(speed) || !isfinite(toward))
    say(b, DIAG_NOT_FINITE, isfinite(speed) ? RESULT_TOWARD : RESULT_SPEED, lane,
        "keep roots, logarithms and divisors off what they are not defined for, by cases or by "
        "`max`",
        "a growing tip has %s that is not finite", isfinite(speed) ? "a direction" : "a speed");
  else if (speed < 0 || speed >= b->in[PL_TIP_RAYLEIGH_SPEED][lane])
    say(b, DIAG_CRACK_SPEED, RESULT_SPEED, lane,
        "keep it between the two: `max(..., 0)`, `min(..., 0.9*rayleigh_speed)`",
        speed < 0 ? "the tip runs backward, at %.4g m/s"
                  : "the tip runs at %.4g m/s, not slower than the Rayleigh speed",
        speed);
}

/* sqrt(2 pi r) times the stress across a ray ahead of the tip. */
static double hoop_stress(double K_I, double K_II, double angle) {
  const double c = pl_cos(angle / 2);
  return c * (K_I * c * c - 1.5 * K_II * pl_sin(angle));
}

/* An angle beyond half a turn is none; a crack turns to the side on which it is opened more. */
static void check_direction(tip_bench *b, int lane) {
  const double K_I = b->in[PL_TIP_K_I][lane], K_II = b->in[PL_TIP_K_II][lane],
               toward = b->out[PL_TIP_TOWARD][lane];
  if (b->out[PL_TIP_GROW][lane] == 0 || !isfinite(toward)) return;
  if (fabs(toward) > M_PI * (1 + 1e-9))
    say(b, DIAG_DEGREES, RESULT_TOWARD, lane,
        "angles are in radians: no factor such as 180/pi; a number in degrees has its unit, `30 "
        "[deg]`",
        "the tip turns by %.4g rad, more than half a turn: this looks like degrees", toward);
  if (!(K_I > 0) || fabs(K_II) < 0.05 * K_I || fabs(toward) < 1e-3) return;
  b->turned++;
  b->turned_away += hoop_stress(K_I, K_II, toward) < hoop_stress(K_I, K_II, -toward);
}

static void judge_directions(tip_bench *b) {
  enum { FEW = 20 };
  if (b->turned < FEW || b->turned_away < b->turned || b->failed[DIAG_DEGREES]) return;
  say(b, DIAG_CRACK_DIRECTION, RESULT_TOWARD, 0,
      "look at the sign of K_II: with K_II above 0 a crack turns to negative angles",
      "in all of %d looks the tip turns to the side on which it is opened less", b->turned);
}

static bool bench_open(tip_bench *b, const law *l, const physics_options *o, diagnostics *d) {
  b->law = l;
  b->said = d;
  b->seed = o->seed ? o->seed : USUAL_SEED;
  b->plan = plan_kernel(l, d);
  if (!b->plan) return false;
  b->kernel = plan_interpreted(b->plan);
  b->parameters = must_calloc((size_t)l->parameters.count + 1, sizeof(double));
  b->uniforms = must_calloc((size_t)b->kernel->uniform_count + 1, sizeof(double));
  b->field = planes(l->fields.count);
  b->new_field = planes(l->fields.count);
  b->observed = planes(l->outputs.count);
  for (int f = 0; f < l->fields.count; f++)
    for (int lane = 0; lane < LANES; lane++)
      b->field[f][lane] = l->fields.items[f]->initial;
  return true;
}

static void bench_close(tip_bench *b) {
  if (!b->plan) return;
  plan_interpreted_free(b->kernel);
  plan_free(b->plan);
  free(b->parameters);
  free(b->uniforms);
  planes_free(b->field, b->law->fields.count);
  planes_free(b->new_field, b->law->fields.count);
  planes_free(b->observed, b->law->outputs.count);
}

void physics_check_tips(const law *l, const physics_options *o, diagnostics *d,
                        physics_report *report) {
  enum { SETS = 8, ROUNDS = 200 };
  const pl_bond_class none = {.size = sizeof none};
  tip_bench *b = must_calloc(1, sizeof *b);
  const bool good = bench_open(b, l, o, d);
  for (int set = 0; set < SETS && good; set++) {
    if (o->parameters)
      memcpy(b->parameters, o->parameters, (size_t)l->parameters.count * sizeof(double));
    else
      physics_draw_parameters(l, set ? &b->seed : NULL, b->parameters);
    b->kernel->prepare(b->kernel, b->parameters, &none, b->uniforms);
    check_rest(b);
    for (int round = 0; round < ROUNDS; round++) {
      draw(b, false);
      look(b);
      for (int lane = 0; lane < LANES; lane++) {
        if (lane % 2 == 0 && !l->tree->anisotropic) check_mirror(b, lane);
        check_run(b, lane);
        check_direction(b, lane);
      }
      report->states += LANES;
    }
  }
  if (good) judge_directions(b);
  bench_close(b);
  free(b);
}
