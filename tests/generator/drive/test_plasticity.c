/* Laws that yield, along paths drawn by chance: von Mises against the radial return (Wilkins 1964)
   by hand, in plane stress with the strain along z by bisection; Drucker and Prager against what
   makes a return one, on the cone and at its apex; tangents against differences. */
#include <setjmp.h>
#include <stdarg.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include <math.h>
#include <string.h>

#include "dsl/semantics/law_variant.h"
#include "generator/drive/driven_point.h"
#include "generator/ir/random_values.h"
#include "generator/kernel/model.h"

enum { MOST = PL_MAX_STRAINS, XX = 0, YY = 1, ZZ = 2, XY = 3, YZ = 4, XZ = 5 };

/* --- a law at a point ------------------------------------------------------------------------- */

typedef struct opened {
  model m;
  driven_point point;
  int strains, stresses;
  double parameters[16];
} opened;

static double *parameter(opened *o, const char *name) {
  const pl_law *kernel = o->point.kernel;
  for (int k = 0; k < kernel->parameter_count; k++)
    if (strcmp(kernel->parameters[k].name, name) == 0) return &o->parameters[k];
  fail_msg("no parameter %s", name);
  return NULL;
}

static int field(const opened *o, const char *name) {
  const pl_law *kernel = o->point.kernel;
  int k = 0;
  while (k < kernel->field_count && strcmp(kernel->fields[k].name, name) != 0)
    k++;
  assert_true(k < kernel->field_count);
  return k;
}

static void open_law(opened *o, const char *name, const char *option, const char *choice,
                     law_setting setting) {
  char path[512], error[2000];
  const char *note;
  const law_choice chosen = {option, choice};
  snprintf(path, sizeof path, SOURCE_DIR "/models/%s.plm", name);
  assert_true(model_open(&o->m, path, &chosen, 1));
  o->m.law = law_on_lattice(o->m.law, setting, false, 0);
  assert_true(model_plan(&o->m));
  const pl_law *kernel = model_kernel(&o->m, true, &note, error, sizeof error);
  assert_non_null(kernel);
  assert_true(kernel->parameter_count <= 16);
  for (int k = 0; k < kernel->parameter_count; k++)
    o->parameters[k] = kernel->parameters[k].initial;
  driven_point_open(&o->point, kernel, o->parameters, 0.01);
  o->strains = o->point.strains;
  o->stresses = o->point.stresses;
}

/* With other parameters than the law's own. */
static void set(opened *o, const char *name, double value) {
  const pl_law *kernel = o->point.kernel;
  *parameter(o, name) = value;
  driven_point_close(&o->point);
  driven_point_open(&o->point, kernel, o->parameters, 0.01);
}

static void close_law(opened *o) {
  driven_point_close(&o->point);
  model_close(&o->m);
}

static int component(const opened *o, int k) {
  static const int of_plane[] = {XX, YY, XY, ZZ};
  return o->strains == 3 ? of_plane[k] : k;
}

/* A walk that turns now and then; returns false where it ends. */
typedef struct walk {
  uint64_t seed;
  double step[MOST], size;
  int done;
} walk;

static void go_on(walk *w, const opened *o, double *strain) {
  if (w->done++ % 12 == 0)
    for (int k = 0; k < o->strains; k++)
      w->step[k] = w->size * draw_uniform(&w->seed, -1, 1);
  for (int k = 0; k < o->strains; k++)
    strain[k] += w->step[k];
}

/* --- von Mises by hand ------------------------------------------------------------------------ */

typedef struct steel {
  double mu, K, f_y, H, H_kin, f_inf, delta;
  bool saturating;
  double eps_p[MOST], eps_bar;
} steel;

static double strength(const steel *s, double k) {
  return s->f_y + s->H * k + (s->saturating ? (s->f_inf - s->f_y) * (1 - exp(-s->delta * k)) : 0);
}

/* The increment of eps_bar at which what is left of the trial's size is the strength there. */
static double increment(const steel *s, double q) {
  double low = 0, high = (q - s->f_y) / (3 * s->mu);
  for (int k = 0; k < 200; k++) {
    const double mid = 0.5 * (low + high),
                 left = q - (3 * s->mu + s->H_kin) * mid - strength(s, s->eps_bar + mid);
    *(left > 0 ? &low : &high) = mid;
  }
  return 0.5 * (low + high);
}

/* Stress at that strain; `after` is what the steel has become. */
static void return_to(const steel *s, const double *strain, double *stress, steel *after) {
  double trial[MOST], square = 0, trace = 0, plastic = 0;
  *after = *s;
  for (int k = 0; k < 3; k++) {
    trace += strain[k];
    plastic += s->eps_p[k];
  }
  for (int k = 0; k < MOST; k++) {
    const double dev = strain[k] - s->eps_p[k] - (k < 3 ? (trace - plastic) / 3 : 0);
    stress[k] = 2 * s->mu * dev;
    trial[k] = stress[k] - 2.0 / 3 * s->H_kin * s->eps_p[k];
    square += (k < 3 ? 1 : 2) * trial[k] * trial[k];
  }
  const double q = sqrt(1.5 * square);
  if (q > strength(s, s->eps_bar)) {
    const double grown = increment(s, q);
    after->eps_bar += grown;
    for (int k = 0; k < MOST; k++) {
      after->eps_p[k] += 1.5 * grown * trial[k] / q;
      stress[k] -= 3 * s->mu * grown * trial[k] / q;
    }
  }
  for (int k = 0; k < 3; k++)
    stress[k] += s->K * (trace - plastic);
}

/* In plane stress the strain along z that leaves none there. */
static void answer(const steel *s, law_setting setting, double *strain, double *stress,
                   steel *after) {
  return_to(s, strain, stress, after);
  if (setting != SETTING_PLANE_STRESS) return;
  double low = -1, high = 1;
  for (int k = 0; k < 200; k++) {
    strain[ZZ] = 0.5 * (low + high);
    return_to(s, strain, stress, after);
    *(stress[ZZ] > 0 ? &high : &low) = strain[ZZ];
  }
}

/* 240 steps: up to a tenth of the strain at yield, and to three times that. */
static void follow(const char *choice, law_setting setting, double size, uint64_t seed) {
  opened o;
  open_law(&o, "von_mises", "hardening", choice, setting);
  set(&o, "H", 3e9);
  set(&o, "H_kin", 5e9);
  const double E = *parameter(&o, "E"), nu = *parameter(&o, "nu");
  steel s = {.mu = E / (2 * (1 + nu)),
             .K = E / (3 * (1 - 2 * nu)),
             .f_y = *parameter(&o, "f_y"),
             .H = 3e9,
             .H_kin = 5e9,
             .f_inf = *parameter(&o, "f_inf"),
             .delta = *parameter(&o, "delta"),
             .saturating = strcmp(choice, "saturating") == 0};
  walk w = {.seed = seed, .size = size};
  strained at = {.step = 1};
  double most = 0;
  const int bar = field(&o, "eps_bar"), xx = field(&o, "eps_p_xx");
  for (int step = 0; step < 240; step++) {
    double strain[MOST] = {0}, stress[MOST];
    steel after;
    go_on(&w, &o, at.strain);
    for (int k = 0; k < o.strains; k++)
      strain[component(&o, k)] = at.strain[k];
    answer(&s, setting, strain, stress, &after);
    const stressed found = driven_point_step(&o.point, &at);
    driven_point_accept(&o.point);
    s = after;
    for (int k = 0; k < o.stresses; k++)
      most = fmax(most, fabs(found.stress[k] - stress[component(&o, k)]));
    assert_true(fabs(o.point.old_field[bar][0] - s.eps_bar) <= 1e-12 * (1e-2 + s.eps_bar));
    assert_true(fabs(o.point.old_field[xx][0] - s.eps_p[XX]) <= 1e-12 * (1e-2 + s.eps_bar));
  }
  if (!(most <= 1e-12 * s.f_y))
    print_message("%s %d %g: %g\n", choice, setting, size, most / s.f_y);
  assert_true(s.eps_bar > size);
  assert_true(most <= 1e-12 * s.f_y);
  close_law(&o);
}

static void radial_returns(void **state) {
  static const law_setting settings[] = {SETTING_PLANE_STRESS, SETTING_PLANE_STRAIN, SETTING_SPACE};
  (void)state;
  for (int k = 0; k < 3; k++) {
    follow("linear", settings[k], 1.25e-4, 11);
    follow("linear", settings[k], 4e-3, 12);
    follow("saturating", settings[k], 1.25e-4, 13);
    follow("saturating", settings[k], 4e-3, 14);
  }
}

/* --- Drucker and Prager ----------------------------------------------------------------------- */

typedef struct cone {
  double eta, dilation, xi, c, H, mu, K;
} cone;

static double invariants(const double *stress, double *dev) {
  const double p = (stress[XX] + stress[YY] + stress[ZZ]) / 3;
  for (int k = 0; k < MOST; k++)
    dev[k] = stress[k] - (k < 3 ? p : 0);
  return p;
}

static double half_square(const double *dev) {
  double sum = 0;
  for (int k = 0; k < MOST; k++)
    sum += (k < 3 ? 0.5 : 1) * dev[k] * dev[k];
  return sum;
}

/* Compression: the cone through Mohr and Coulomb's outer edges. */
static cone cone_of(opened *o) {
  const double E = *parameter(o, "E"), nu = *parameter(o, "nu"), a = *parameter(o, "phi"),
               b = *parameter(o, "psi");
  return (cone){.eta = 6 * sin(a) / (sqrt(3) * (3 - sin(a))),
                .dilation = 6 * sin(b) / (sqrt(3) * (3 - sin(b))),
                .xi = 6 * cos(a) / (sqrt(3) * (3 - sin(a))),
                .c = *parameter(o, "c"),
                .H = *parameter(o, "H"),
                .mu = E / (2 * (1 + nu)),
                .K = E / (3 * (1 - 2 * nu))};
}

typedef struct grain {
  double eps_p[MOST], gamma;
} grain;

static grain grain_of(const opened *o) {
  static const char *const names[] = {"eps_p_xx", "eps_p_yy", "eps_p_zz",
                                      "eps_p_xy", "eps_p_yz", "eps_p_xz"};
  grain g = {.gamma = o->point.old_field[field(o, "gamma_p")][0]};
  for (int k = 0; k < MOST; k++)
    g.eps_p[k] = o->point.old_field[field(o, names[k])][0];
  return g;
}

/* A step that has led from `old` to `now`: inside or on the cone; plastic strain along the stress
   that is left and, on the cone, as much volume as the dilatancy asks; at the apex at least that.
   0: elastic, 1: on the cone, 2: at the apex. */
static int is_a_return(const cone *c, const grain *old, const grain *now, const double *stress) {
  double dev[MOST], slip[MOST], part[MOST];
  const double p = invariants(stress, dev), tau = sqrt(half_square(dev)), near = 1e-12 * c->c,
               f = tau + c->eta * p - c->xi * (c->c + c->H * now->gamma);
  for (int k = 0; k < MOST; k++)
    part[k] = now->eps_p[k] - old->eps_p[k];
  const double volume = 3 * invariants(part, slip), gamma = now->gamma - old->gamma,
               size = 1e-12 * (1e-2 + now->gamma);
  if (!(f <= near * 10)) print_message("f %g\n", f);
  assert_true(f <= 10 * near);
  assert_true(gamma >= 0);
  if (gamma == 0 && volume == 0) return 0;
  assert_true(f >= -10 * near);
  assert_true(fabs(2 * sqrt(half_square(slip)) - gamma) <= size);
  if (tau < 1e-6 * c->c) {
    assert_true(volume >= c->dilation * gamma - size);
    return 2;
  }
  assert_true(fabs(volume - c->dilation * gamma) <= size);
  for (int k = 0; k < MOST; k++)
    assert_true(fabs(slip[k] - gamma * dev[k] / (2 * tau)) <= size);
  return 1;
}

/* The elastic strain is the stress's. */
static void is_hookes(const cone *c, const grain *now, const double *strain, const double *stress) {
  double dev[MOST], elastic[MOST], shear[MOST];
  const double p = invariants(stress, dev);
  for (int k = 0; k < MOST; k++)
    elastic[k] = strain[k] - now->eps_p[k];
  const double volume = 3 * invariants(elastic, shear);
  assert_true(fabs(p - c->K * volume) <= 1e-11 * c->c);
  for (int k = 0; k < MOST; k++)
    assert_true(fabs(dev[k] - 2 * c->mu * shear[k]) <= 1e-11 * c->c);
}

/* The walk is drawn out and pressed in turn. */
static void slide(double H, double size, uint64_t seed, int *seen) {
  opened o;
  open_law(&o, "drucker_prager", "cone", "compression", SETTING_SPACE);
  set(&o, "H", H);
  const cone c = cone_of(&o);
  walk w = {.seed = seed, .size = size};
  strained at = {.step = 1};
  for (int step = 0; step < 240; step++) {
    go_on(&w, &o, at.strain);
    for (int k = 0; k < 3; k++)
      at.strain[k] += step % 48 < 24 ? 0.7 * size : -0.7 * size;
    const grain old = grain_of(&o);
    const stressed found = driven_point_step(&o.point, &at);
    driven_point_accept(&o.point);
    const grain now = grain_of(&o);
    seen[is_a_return(&c, &old, &now, found.stress)]++;
    is_hookes(&c, &now, at.strain, found.stress);
  }
  close_law(&o);
}

static void cones_and_apexes(void **state) {
  int seen[3] = {0};
  (void)state;
  slide(0, 5e-5, 21, seen);
  slide(0, 1e-3, 22, seen);
  slide(5e8, 5e-5, 23, seen);
  for (int k = 0; k < 3; k++)
    assert_true(seen[k] > 30);
}

/* The stress that plane stress leaves is that of space with the strain along z that leaves none
   there: both points undergo the same. */
static void sheets_are_thin_plates(void **state) {
  (void)state;
  opened sheet, block;
  walk w = {.seed = 31, .size = 5e-5};
  strained at = {.step = 1}, in_space = {.step = 1};
  double most = 0;
  open_law(&sheet, "drucker_prager", "cone", "compression", SETTING_PLANE_STRESS);
  open_law(&block, "drucker_prager", "cone", "compression", SETTING_SPACE);
  for (int step = 0; step < 240; step++) {
    go_on(&w, &sheet, at.strain);
    in_space.strain[XX] = at.strain[0];
    in_space.strain[YY] = at.strain[1];
    in_space.strain[XY] = at.strain[2];
    double low = -0.1, high = 0.1;
    stressed b = {.stress = {0}};
    for (int k = 0; k < 100; k++) {
      in_space.strain[ZZ] = 0.5 * (low + high);
      b = driven_point_step(&block.point, &in_space);
      *(b.stress[ZZ] > 0 ? &high : &low) = in_space.strain[ZZ];
    }
    driven_point_accept(&block.point);
    const stressed a = driven_point_step(&sheet.point, &at);
    driven_point_accept(&sheet.point);
    most = fmax(most, fabs(a.stress[0] - b.stress[XX]));
    most = fmax(most, fabs(a.stress[1] - b.stress[YY]));
    most = fmax(most, fabs(a.stress[2] - b.stress[XY]));
  }
  const double c = *parameter(&sheet, "c");
  if (!(most <= 1e-11 * c)) print_message("%g\n", most / c);
  assert_true(most <= 1e-11 * c);
  close_law(&sheet);
  close_law(&block);
}

/* --- tangents --------------------------------------------------------------------------------- */

/* Central differences of two lengths, which tell apart what has a corner there. */
static bool differences(opened *o, const strained *at, int column, double by, double *slope) {
  stressed side[2];
  double slopes[2][MOST];
  for (int fine = 0; fine < 2; fine++) {
    const double length = fine ? by / 2 : by;
    for (int k = 0; k < 2; k++) {
      strained moved = *at;
      moved.strain[column] += k ? -length : length;
      side[k] = driven_point_step(&o->point, &moved);
    }
    for (int k = 0; k < o->strains; k++)
      slopes[fine][k] = (side[0].stress[k] - side[1].stress[k]) / (2 * length);
  }
  bool smooth = true;
  for (int k = 0; k < o->strains; k++) {
    slope[k] = slopes[1][k];
    smooth = smooth && fabs(slopes[0][k] - slopes[1][k]) <= 1e-7 * *parameter(o, "E");
  }
  return smooth;
}

static void tangents_along(const char *name, const char *option, const char *choice,
                           law_setting setting, double size, uint64_t seed) {
  opened o;
  open_law(&o, name, option, choice, setting);
  walk w = {.seed = seed, .size = size};
  strained at = {.step = 1};
  int compared = 0;
  double most = 0;
  for (int step = 0; step < 120; step++) {
    double tangent[MOST][MOST], slope[MOST];
    go_on(&w, &o, at.strain);
    driven_point_tangent(&o.point, &at, tangent);
    for (int b = 0; b < o.strains; b++) {
      if (!differences(&o, &at, b, 1e-3 * size, slope)) continue;
      compared++;
      for (int a = 0; a < o.strains; a++)
        most = fmax(most, fabs(slope[a] / (component(&o, b) >= XY ? 2 : 1) - tangent[a][b]));
    }
    (void)driven_point_step(&o.point, &at);
    driven_point_accept(&o.point);
  }
  assert_true(compared > 100 * o.strains);
  const double E = *parameter(&o, "E");
  if (!(most <= 1e-6 * E)) print_message("%s %s %d: %g\n", name, choice, setting, most / E);
  assert_true(most <= 1e-6 * E);
  close_law(&o);
}

static void tangents_are_those_of_the_step(void **state) {
  static const law_setting settings[] = {SETTING_PLANE_STRESS, SETTING_PLANE_STRAIN, SETTING_SPACE};
  (void)state;
  for (int k = 0; k < 3; k++) {
    tangents_along("von_mises", "hardening", "linear", settings[k], 1e-3, 41);
    tangents_along("von_mises", "hardening", "saturating", settings[k], 1e-3, 42);
    tangents_along("drucker_prager", "cone", "plane_strain", settings[k], 2e-4, 43);
  }
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(radial_returns),
      cmocka_unit_test(cones_and_apexes),
      cmocka_unit_test(sheets_are_thin_plates),
      cmocka_unit_test(tangents_are_those_of_the_step),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
