/* Kernels that leave out what only growth needs (generator/plan/seldom.h) beside the same laws that
   compute it everywhere: the same bits, in random states and along paths with growth here and
   there, unloading, what is no number, absent and protected bonds. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "generator/kernel/material_law.h"
#include "generator/plan/plan.h"
#include "runtime/analysis/material.h"
#include "runtime/deck/deck_read.h"
#include "runtime/interaction/sweep.h"
#include "runtime/simulation/simulation.h"
#include "tests/generator/kernel/compiled_family.h"

/* --- both kernels of a law -------------------------------------------------------------------- */

typedef struct rivals {
  model m[2]; /* the second computes everywhere */
  const pl_law *kernel[2];
} rivals;

static void plan_one(model *m, bool families, bool everywhere) {
  const law_variation v = {.alone = families, .everywhere = everywhere};
  assert_true((families ? model_plan_of_families : model_plan_varying)(m, &v));
}

/* neighbours > 0: as a law of families. */
static void open_rivals(rivals *r, const char *path, const law_choice *choice, law_setting setting,
                        int neighbours) {
  for (int k = 0; k < 2; k++) {
    char error[2000];
    const char *note;
    assert_true(model_open(&r->m[k], path, choice, choice ? 1 : 0));
    r->m[k].law = law_on_lattice(r->m[k].law, setting, false, neighbours);
    plan_one(&r->m[k], neighbours > 0, k == 1);
    r->kernel[k] = model_kernel(&r->m[k], false, &note, error, sizeof error);
    if (!r->kernel[k]) fail_msg("%s", error);
  }
  assert_string_not_equal(model_c_text(&r->m[0]), model_c_text(&r->m[1]));
}

static void close_rivals(rivals *r) {
  model_close(&r->m[0]);
  model_close(&r->m[1]);
}

/* --- random states ---------------------------------------------------------------------------- */

#define LAW(name)    SOURCE_DIR "/models/" name ".plm"
#define SAMPLE(name) SOURCE_DIR "/tests/generator/laws/" name ".plm"

typedef struct random_case {
  const char *path;
  law_choice choice;
  law_setting setting;
  int neighbours; /* 0: not as a law of families */
} random_case;

/* The kernel of the one against the interpreter of the other. */
static void random_states_give_the_same_bits(void **state) {
  (void)state;
  static const random_case cases[] = {
      {LAW("cohesive"), {"softening", "exponential"}, SETTING_PLANE_STRESS, 0},
      {LAW("cohesive"), {"softening", "exponential"}, SETTING_SPACE, 18},
      {SAMPLE("exponential"), {"onset", "stretch"}, SETTING_PLANE_STRESS, 0},
      {SOURCE_DIR "/tests/generator/kernel/grows.plm", {NULL, NULL}, SETTING_PLANE_STRESS, 0},
      {LAW("mazars"), {"tension", "crack_band"}, SETTING_PLANE_STRESS, 0},
      {LAW("mazars"), {"tension", "mazars"}, SETTING_PLANE_STRAIN, 0},
      {LAW("mazars"), {"tension", "crack_band"}, SETTING_SPACE, 0}};
  for (size_t k = 0; k < sizeof cases / sizeof *cases; k++) {
    const random_case *c = &cases[k];
    rivals r;
    open_rivals(&r, c->path, c->choice.option ? &c->choice : NULL, c->setting, c->neighbours);
    if (c->neighbours)
      assert_same_families(r.m[1].plan, r.kernel[0], 40000);
    else
      assert_same_bits(&r.m[1], r.kernel[0], 40000);
    close_rivals(&r);
  }
}

/* --- numbers ---------------------------------------------------------------------------------- */

/* To the bit; but of what is no number the bits are the processor's. */
static bool same(double a, double b) {
  return memcmp(&a, &b, sizeof a) == 0 || (a != a && b != b);
}

static void assert_same_planes(double *const *a, double *const *b, int planes, long count) {
  for (int p = 0; p < planes; p++)
    for (long q = 0; q < count; q++)
      if (!same(a[p][q], b[p][q]))
        fail_msg("plane %d, place %ld: %.17g and %.17g", p, q, a[p][q], b[p][q]);
}

static void assert_filled(double *const *a, int plane, long at, double least, double most) {
  if (!(a[plane][at] >= least && a[plane][at] <= most))
    fail_msg("plane %d, place %ld: %.17g", plane, at, a[plane][at]);
}

/* How far a place is loaded, of at most 1: most rest; a few grow, fall back and grow on, some at
   once and some late; a whole stretch does; one is no number for a while. */
enum { STEPS = 24, PLACES = 624 };
static double load_of(long q, int step) {
  static const double path[] = {0, 0.3, 0.6, 0.4, 0, -0.5, 0.5, 0.8, 0.8, 1, 0.2, 1};
  const int late = q % 3 == 0 ? 0 : 10, at = step - late;
  const bool one = q == 5 || q == 70 || q == 255 || q == 256 || q == 600;
  const bool many = q >= 300 && q < 350;
  if (q == 131 && step % 7 == 3) return NAN;
  if (!one && !many) return 0.02;
  return at < 0 ? 0.02 : path[at % 12];
}

/* --- points ----------------------------------------------------------------------------------- */

typedef struct point_side {
  double **field[2], **stress, **lost; /* old and new */
} point_side;

static void ask_points(const rivals *r, int side, point_side *p, double *const *strain,
                       double *const *rate, const double *size, double *uniforms, bool ledger) {
  const pl_law *of = r->kernel[side];
  const pl_points at = {.size = sizeof at,
                        .count = PLACES,
                        .strain = (const double *const *)strain,
                        .strain_rate = (const double *const *)rate,
                        .cell_size = size,
                        .old_field = (const double *const *)p->field[0],
                        .new_field = p->field[1],
                        .stress = p->stress,
                        .lost = p->lost,
                        .time_step = 1e-6};
  (ledger ? of->point_ledger : of->point_step)(of, uniforms, &at);
}

static void points_follow_paths(void **state) {
  (void)state;
  rivals r;
  const law_choice choice = {"tension", "crack_band"};
  open_rivals(&r, LAW("mazars"), &choice, SETTING_PLANE_STRESS, 0);
  const int fields = r.kernel[0]->field_count, stresses = PL_STRESSES(2);
  double **sets = parameter_sets(r.kernel[0]), **strain = planes_new(3, PLACES),
         **rate = planes_new(3, PLACES), **size = planes_new(1, PLACES), *uniforms[2];
  point_side s[2];
  for (int k = 0; k < 2; k++) {
    s[k] = (point_side){{planes_new(fields, PLACES), planes_new(fields, PLACES)},
                        planes_new(stresses, PLACES),
                        planes_new(PL_LOSSES, PLACES)};
    uniforms[k] = must_calloc((size_t)r.kernel[k]->uniform_count + 1, sizeof *uniforms[k]);
    r.kernel[k]->prepare(r.kernel[k], sets[0], &bonds, uniforms[k]);
  }
  for (int step = 0; step < STEPS; step++) {
    for (long q = 0; q < PLACES; q++) {
      const double load = load_of(q, step);
      size[0][q] = 0.01;
      strain[0][q] = 6e-4 * load;
      strain[1][q] = -1e-4 * load;
      strain[2][q] = 2e-4 * load * load;
      rate[0][q] = 1;
    }
    for (int k = 0; k < 2; k++)
      ask_points(&r, k, &s[k], strain, rate, size[0], uniforms[k], step % 2);
    assert_same_planes(s[0].stress, s[1].stress, stresses, PLACES);
    assert_same_planes(s[0].field[1], s[1].field[1], fields, PLACES);
    assert_same_planes(s[0].lost, s[1].lost, PL_LOSSES, PLACES);
    for (int k = 0; k < 2; k++) {
      double **old = s[k].field[0];
      s[k].field[0] = s[k].field[1];
      s[k].field[1] = old;
    }
  }
  assert_filled(s[0].field[0], 1, 300, 0.5, 1); /* D: damaged, nearly not, no number */
  assert_filled(s[0].field[0], 1, 301, 0.5, 1);
  assert_filled(s[0].field[0], 1, 0, 0, 0);
  assert_true(isnan(s[0].field[0][1][131]));
  for (int k = 0; k < 2; k++) {
    planes_free(s[k].field[0], fields);
    planes_free(s[k].field[1], fields);
    planes_free(s[k].stress, stresses);
    planes_free(s[k].lost, PL_LOSSES);
    free(uniforms[k]);
  }
  planes_free(sets, PARAMETER_SETS);
  planes_free(strain, 3);
  planes_free(rate, 3);
  planes_free(size, 1);
  close_rivals(&r);
}

/* --- strips ----------------------------------------------------------------------------------- */

enum { DIRECTION = 2 };

typedef struct strip_side {
  double **field, **force, **lost;
} strip_side;

static void ask_strip(const rivals *r, int side, strip_side *s, double *const *u,
                      const int64_t *flags, const double *uniforms, int unheld, bool ledger) {
  const pl_law *of = r->kernel[side];
  const pl_strip at = {.size = sizeof at,
                       .count = PLACES,
                       .direction = DIRECTION,
                       .flags = flags,
                       .unheld = unheld,
                       .displacement_i = {u[0], u[1]},
                       .displacement_j = {u[2], u[3]},
                       .velocity_i = {u[0], u[1]},
                       .velocity_j = {u[2], u[3]},
                       .field = s->field,
                       .force = s->force,
                       .dissipated_state = s->lost[0],
                       .dissipated_rate = s->lost[1],
                       .time_step = 1e-7};
  (ledger ? of->rows_ledger : of->rows)(of, uniforms, &at);
}

/* A seventh absent; where some are protected, an eleventh of them. */
static void fill_flags(int64_t *flags, bool unheld) {
  for (long q = 0; q < PLACES; q++)
    flags[q] = (q % 7 != 4 ? PL_PRESENT(DIRECTION) : 0) |
               (!unheld && q % 11 == 5 ? PL_PROTECTED(DIRECTION) : 0) | PL_PRESENT(0);
}

static void follow_strip(const rivals *r, bool unheld) {
  const int fields = r->kernel[0]->field_count, forces = r->kernel[0]->force_planes;
  double **sets = parameter_sets(r->kernel[0]), **u = planes_new(4, PLACES), *uniforms[2];
  int64_t flags[PLACES];
  strip_side s[2];
  fill_flags(flags, unheld);
  for (int k = 0; k < 2; k++) {
    s[k] =
        (strip_side){planes_new(fields, PLACES), planes_new(forces, PLACES), planes_new(2, PLACES)};
    uniforms[k] = must_calloc((size_t)r->kernel[k]->uniform_count + 1, sizeof *uniforms[k]);
    r->kernel[k]->prepare(r->kernel[k], sets[0], &bonds, uniforms[k]);
  }
  for (int step = 0; step < STEPS; step++) {
    for (long q = 0; q < PLACES; q++)
      for (int d = 0; d < 2; d++)
        u[2 + d][q] = 2e-3 * load_of(q, step) * bonds.chord[d];
    for (int k = 0; k < 2; k++)
      ask_strip(r, k, &s[k], u, flags, uniforms[k], unheld, step % 2);
    assert_same_planes(s[0].force, s[1].force, forces, PLACES);
    assert_same_planes(s[0].field, s[1].field, fields, PLACES);
    assert_same_planes(s[0].lost, s[1].lost, 2, PLACES);
    assert_true(isnan(load_of(131, step)) == isnan(s[0].field[0][131]));
  }
  assert_filled(s[0].field, 0, 600, 0.5, 1); /* omega: damaged, absent, at rest, maybe protected */
  assert_filled(s[0].field, 0, 255, 0.5, 1);
  assert_filled(s[0].field, 0, 305, 0, 0);
  assert_filled(s[0].field, 0, 1, 0, 0);
  assert_filled(s[0].field, 0, 313, unheld ? 0.5 : 0, unheld ? 1 : 0);
  for (int k = 0; k < 2; k++) {
    planes_free(s[k].field, fields);
    planes_free(s[k].force, forces);
    planes_free(s[k].lost, 2);
    free(uniforms[k]);
  }
  planes_free(sets, PARAMETER_SETS);
  planes_free(u, 4);
}

static void strips_follow_paths(void **state) {
  (void)state;
  rivals r;
  const law_choice choice = {"softening", "exponential"};
  open_rivals(&r, LAW("cohesive"), &choice, SETTING_PLANE_STRESS, 0);
  follow_strip(&r, true);
  follow_strip(&r, false);
  close_rivals(&r);
}

/* --- families --------------------------------------------------------------------------------- */

/* A bar that is torn and let go. */
static const char bar[] =
    "&simulation end_time = '60 us' threads = 2 /\n"
    "&output energy = .true. /\n"
    "&lattice name = 'l' kind = 'fcc' shells = 2 spacing = '10 mm' /\n"
    "&body lattice = 'l' shape = 'box' corner = 0, 0, 0 size = 0.16, 0.05, 0.05 /\n"
    "&region name = 'left' shape = 'box' corner = 0, 0, 0 size = 0.012, 0.05, 0.05 /\n"
    "&region name = 'right' shape = 'box' corner = 0.148, 0, 0 size = 0.02, 0.05, 0.05 /\n"
    "&support region = 'left' fix = 'x' /\n"
    "&drive region = 'right' component = 'x' velocity = '3 m/s' end = '40 us' /\n"
    "&material lattice = 'l' model = 'cohesive' softening = 'exponential' /\n";

typedef struct whole_run {
  source_set sources;
  diagnostics said;
  arena *memory;
  model m;
  simulation_law law;
  simulation *run;
} whole_run;

static void open_run(whole_run *w, bool everywhere) {
  char error[2000];
  const char *note;
  *w = (whole_run){.memory = arena_new()};
  diag_begin(&w->said, &w->sources);
  const int file = source_add(&w->sources, "deck", bar, strlen(bar));
  const deck *d = deck_read(w->memory, &w->sources, file, NULL, 0, &w->said);
  const char *beside = SOURCE_DIR "/models/bar.nml";
  const bool opened =
      d && material_law_open(&d->materials[0], &d->lattices[0], beside, &w->m, &w->said);
  diag_print(&w->said, stderr);
  assert_true(opened);
  if (everywhere) {
    plan_free(w->m.plan);
    plan_one(&w->m, true, true);
  }
  w->law.law = model_kernel(&w->m, false, &note, error, sizeof error);
  double *parameters = must_calloc((size_t)w->law.law->parameter_count + 1, sizeof *parameters);
  assert_true(material_parameters(&w->m.values, w->law.law, parameters, &w->said));
  w->law.parameters = parameters;
  w->run = simulation_new(d, &w->law, &w->said);
  diag_print(&w->said, stderr);
  assert_non_null(w->run);
}

static void close_run(whole_run *w) {
  simulation_free(w->run);
  free(w->law.parameters);
  model_close(&w->m);
  diag_clear(&w->said);
  source_clear(&w->sources);
  arena_free(w->memory);
}

static void families_follow_a_run(void **state) {
  (void)state;
  whole_run w[2];
  double most = 0;
  open_run(&w[0], false);
  open_run(&w[1], true);
  assert_string_not_equal(model_c_text(&w[0].m), model_c_text(&w[1].m));
  for (int part = 0; part < 12; part++) {
    const sweep *s[2];
    for (int k = 0; k < 2; k++) {
      assert_int_equal(simulation_advance(w[k].run, 4, NULL), STEP_OK);
      s[k] = simulation_state(w[k].run, 0);
    }
    const long size = s[0]->lattice->size;
    assert_same_planes(s[0]->body->displacement, s[1]->body->displacement, 3, size);
    double *field[2] = {s[0]->field[0], s[1]->field[0]};
    const long count = sweep_planes(s[0], s[0]->law->fields[0].place) * size;
    assert_same_planes(&field[0], &field[1], 1, count);
    for (long q = 0; q < count; q++)
      most = fmax(most, field[0][q]);
  }
  assert_true(most > 0.1 && most <= 1);
  close_run(&w[0]);
  close_run(&w[1]);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(random_states_give_the_same_bits), cmocka_unit_test(points_follow_paths),
      cmocka_unit_test(strips_follow_paths), cmocka_unit_test(families_follow_a_run)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
