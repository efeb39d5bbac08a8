/* The stable step of bodies: what bears 0.98 of it and, where a surface rules, no more than 1.03 of
   it; bodies that fly apart at rest. Theory: leapfrog is stable up to dt = 2/omega_max of the body
   at hand (Hughes 1987, section 9.1); bodies cut from a lattice of positive semidefinite bonds are
   not faster than the lattice (Weyl's inequality). */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "runtime/analysis/body_limit.h"
#include "runtime/analysis/bond_forms.h"
#include "runtime/analysis/stability.h"
#include "runtime/interaction/interaction.h"
#include "tests/verification/case.h"

/* --- laws of the test ------------------------------------------------------------------------- */

static void write_law(const char *name, const char *kind, const char *text) {
  FILE *out = fopen(name, "w");
  assert_non_null(out);
  fprintf(out,
          "model test_law\n  law %s\n  parameter E = 30 [GPa] in (0, inf)\n"
          "  parameter nu = 0.2 in [0, 0.5)\n  parameter rho = 2400 [kg/m^3] in (0, inf)\n%s"
          "end model\n",
          kind, text);
  fclose(out);
}

/* Stress of the fitted strain and nothing else: families that lack neighbours are stiffer. */
static void write_uniform_force(void) {
  write_law("uniform_force.plm", "state\n  for space",
            "  strain eps = fit(stretch)\n  force state F[j] = uniform_force(hooke(eps, E, nu))\n");
}

/* --- growth ----------------------------------------------------------------------------------- */

static uint64_t seed;

static double uniform(double low, double high) {
  seed = seed * UINT64_C(6364136223846793005) + UINT64_C(1442695040888963407);
  return low + (high - low) * (double)(seed >> 11) / 9007199254740992.0;
}

static double largest_velocity(const sweep *w) {
  double most = 0;
  for (int d = 0; d < w->body->dof; d++)
    for (long p = 0; p < w->body->lattice->particle_count; p++) {
      const double v = fabs(w->body->velocity[d][w->body->lattice->particle_site[p]]);
      most = fmax(most, v * (d < w->body->dimensions ? 1 : w->body->lattice->spacing));
    }
  return most;
}

/* Growth of the largest velocity in so many steps from velocities that stretch bonds by about 1e-9,
   or as soon as it passes 1e5. */
static double growth(const deck_case *c, double part, int steps) {
  const step_limit *limit = simulation_step_limit(c->simulation);
  const rows *g = simulation_rows(c->simulation, 0);
  const double quiet = 1e-9 * g->spacing * limit->omega_max;
  sweep *w =
      interaction_new(g, c->law.law, c->law.parameters, part * limit->limit, 1, false, false);
  const parameter_planes *f = simulation_planes(c->simulation, 0);
  if (f) w->parameter = f->value;
  seed = 11;
  for (int d = 0; d < w->body->dof; d++)
    for (long p = 0; p < g->particle_count; p++)
      w->body->velocity[d][g->particle_site[p]] =
          uniform(-quiet, quiet) / (d < w->body->dimensions ? 1 : g->spacing);
  double most = 1;
  for (int step = 0; step < steps && most < 1e5; step++) {
    if (!sweep_step(w)) most = INFINITY;
    if (step % 16 == 0 || step == steps - 1) most = fmax(most, largest_velocity(w) / quiet);
  }
  sweep_free(w);
  return most;
}

static void open_case(deck_case *c, const char *text) {
  assert_true(deck_case_text(c, text));
}

#define START "&simulation end_time = 1 /\n&output frames = 0 energy = .false. /\n"
#define PLANE(kind, more)                                                                          \
  "&lattice name = 'l' kind = '" kind "' spacing = '5 mm' thickness = '10 mm' " more " /\n"        \
  "&body lattice = 'l' shape = 'rectangle' corner = 0, 0 size = '60 mm', '30 mm' /\n"
#define SPACE(kind, more, size)                                                                    \
  "&lattice name = 'l' kind = '" kind "' spacing = '5 mm' " more " /\n"                            \
  "&body lattice = 'l' shape = 'box' corner = 3*0 size = 3*'" size "' /\n"
#define LAW(model) "&material lattice = 'l' model = '" model "' /\n"

/* --- bodies bear the step --------------------------------------------------------------------- */

typedef enum limit_owner { OF_LATTICE, OF_SURFACE, OF_BODY } limit_owner;

typedef struct body_case {
  const char *name, *text;
  limit_owner owner; /* but of a lattice, where edges are softer, a little more is too much */
} body_case;

static const body_case bodies[] = {
    {"uniform force, cubic 3.015",
     START SPACE("cubic", "horizon = 3.015", "25 mm") LAW("uniform_force.plm"), OF_SURFACE},
    {"lps, square 3.015", START PLANE("square", "horizon = 3.015") LAW("lps"), OF_SURFACE},
    {"pmb, cubic 3.015", START SPACE("cubic", "horizon = 3.015", "25 mm") LAW("pmb"), OF_SURFACE},
    {"splm_elastic, fcc 18", START SPACE("fcc", "shells = 2", "25 mm") LAW("splm_elastic"),
     OF_LATTICE},
    {"splm_concrete, hexagonal turned",
     START PLANE("hexagonal", "rotation = 15") LAW("splm_concrete"), OF_LATTICE},
    {"splm_elastic, blue noise", START PLANE("blue_noise", "") LAW("splm_elastic"), OF_BODY},
    {"cohesive, fcc 18", START SPACE("fcc", "shells = 2", "25 mm") LAW("cohesive"), OF_LATTICE},
    {"mplm_bilinear, random E and nu",
     START PLANE("hexagonal", "rotation = 20")
         LAW("mplm_bilinear") "&field parameter = 'nu' distribution = 'uniform' low = 0 high = "
                              "0.333 /\n"
                              "&field parameter = 'E' distribution = 'lognormal' cv = 0.3 /\n",
     OF_LATTICE},
    {"lps, square 2.015, random E",
     START PLANE("square", "horizon = 2.015")
         LAW("lps") "&field parameter = 'E' distribution = 'lognormal' cv = 0.5 /\n",
     OF_BODY},
    {"elastic_central, stiff region",
     START PLANE("square", "horizon = 1.5")
         LAW("elastic_central") "&region name = 'r' shape = 'disc' centre = 0, 0 radius = '10 mm' "
                                "/\n&material lattice = 'l' region = 'r' model = "
                                "'elastic_central' E = '200 GPa' /\n",
     OF_BODY},
};

static void bodies_bear_the_step(void **state) {
  (void)state;
  write_uniform_force();
  for (size_t k = 0; k < sizeof bodies / sizeof *bodies; k++) {
    deck_case c;
    open_case(&c, bodies[k].text);
    const step_limit *limit = simulation_step_limit(c.simulation);
    const double below = growth(&c, 0.98, 3000);
    const double above = bodies[k].owner == OF_LATTICE ? INFINITY : growth(&c, 1.03, 3000);
    print_message("%-32s limit %.6g us%s: velocities grow by %.3g at 0.98 of it, by %.3g at 1.03\n",
                  bodies[k].name, 1e6 * limit->limit, limit->at_surface ? " (surface)" : "", below,
                  above);
    assert_true(limit->at_surface == (bodies[k].owner == OF_SURFACE));
    assert_true(limit->least > STABILITY_LEAST);
    assert_true(below < 100);
    assert_true(above >= 1e5);
    deck_case_close(&c);
  }
}

/* Bodies of sound bonds need no search, however they are turned: they keep the limit of their
   lattice. */
static void sound_bonds_are_not_searched(void **state) {
  (void)state;
  static const char *const texts[] = {
      START SPACE("fcc", "shells = 2 rotation = 17 axis = 1, 2, 3", "25 mm") LAW("cohesive"),
      START PLANE("square", "horizon = 3.015 rotation = 33") LAW("elastic_central"),
      START PLANE("hexagonal", "rotation = 5") LAW("mplm_concrete")};
  for (size_t k = 0; k < sizeof texts / sizeof *texts; k++) {
    deck_case c;
    open_case(&c, texts[k]);
    const step_limit *limit = simulation_step_limit(c.simulation);
    assert_true(limit->least == 0 && !limit->at_surface);
    deck_case_close(&c);
  }
}

/* A bond that is a hundred times as stiff when it shortens, as one of two and as one of
   families. */
static void kinks_at_rest_count(void **state) {
  (void)state;
  static const char *const texts[] = {START PLANE("hexagonal", "") LAW("kink.plm"),
                                      START PLANE("square", "") LAW("kink.plm"),
                                      START PLANE("blue_noise", "") LAW("kink.plm")};
  write_law("kink.plm", "central bond\n  for plane_stress, irregular",
            "  constant k = (1 - nu)*E*s*t\n"
            "  force N = | 100*k*stretch when stretch < 0\n            | k*stretch otherwise\n");
  for (size_t k = 0; k < 3; k++) {
    deck_case c;
    open_case(&c, texts[k]);
    const double below = growth(&c, 0.98, 3000);
    print_message("kink at rest: limit %.6g us, velocities grow by %.3g at 0.98 of it\n",
                  1e6 * simulation_step_limit(c.simulation)->limit, below);
    assert_true(below < 100);
    deck_case_close(&c);
  }
}

/* --- random fields ---------------------------------------------------------------------------- */

/* EA grows with nu, EI falls: bonds of small and of large nu side by side are stiffer than lattices
   of either. */
static void no_body_of_random_bonds_is_faster(void **state) {
  (void)state;
  for (int n = 1; n <= 4; n++) {
    char text[1024];
    deck_case c;
    snprintf(text, sizeof text,
             START PLANE("hexagonal", "")
                 LAW("elastic_micropolar") "&field parameter = 'nu' distribution = 'uniform' "
                                           "low = 0 high = 0.333 seed = %d /\n",
             n);
    open_case(&c, text);
    const step_limit *limit = simulation_step_limit(c.simulation);
    step_limit whole = {0};
    body_limit(c.law.law, c.law.parameters, simulation_planes(c.simulation, 0)->value,
               simulation_rows(c.simulation, 0), &whole);
    print_message("seed %d: limit %.6g us, of the body itself %.6g us\n", n, 1e6 * limit->limit,
                  1e6 * whole.limit);
    assert_true(limit->limit <= whole.limit * (1 + BODY_ACCURACY));
    assert_true(limit->limit > 0.7 * whole.limit);
    deck_case_close(&c);
  }
}

static void forms_are_raised_no_more_than_needed(void **state) {
  (void)state;
  bond_form a = {{2, 0, 0}, {0, 3, 1}, {0, 1, 3}}, same, b = {{5, 0, 0}, {0, 1, 0}, {0, 0, 1}};
  memcpy(same, a, sizeof a);
  bond_form_raise(a, (bond_form){{1, 0, 0}, {0, 1, 0}, {0, 0, 1}});
  assert_memory_equal(a, same, sizeof a); /* it is larger already: to the bit */
  bond_form_raise(a, b);
  assert_true(fabs(a[0][0] - 5) < 1e-14 && fabs(a[1][1] - 3) < 1e-14 && fabs(a[1][2] - 1) < 1e-14);
  assert_true(form_is_definite(3, &a[0][0], 1e-12));
  assert_true(form_is_definite(3, &(bond_form){{1, 0, 0}, {0, 1, 1}, {0, 1, 1}}[0][0], 1e-12));
  assert_false(
      form_is_definite(3, &(bond_form){{1, 0, 0}, {0, 1, 1.001}, {0, 1.001, 1}}[0][0], 1e-12));
  assert_true(form_is_definite(3, &(bond_form){{0}}[0][0], 1e-12));
}

/* --- unstable at rest ------------------------------------------------------------------------- */

static void refused(const char *text, const char *model_kind, const char *force) {
  deck_case c;
  write_law("unstable.plm", model_kind, force);
  assert_true(deck_case_read(&c, "case.nml", text, NULL, 0));
  assert_false(deck_case_start(&c, "case.nml"));
  bool found = false;
  for (int k = 0; k < c.said.count; k++)
    found = found || (c.said.items[k].code == DIAG_STIFFNESS &&
                      strstr(c.said.items[k].message, "unstable at rest"));
  assert_true(found);
  deck_case_close(&c);
}

static void what_flies_apart_is_refused(void **state) {
  (void)state;
  const char *square = START PLANE("square", "") LAW("unstable.plm"),
             *hexagon = START PLANE("hexagonal", "") LAW("unstable.plm"),
             *space = START SPACE("fcc", "shells = 2", "20 mm") LAW("unstable.plm"),
             *given =
                 "&simulation end_time = 1 step = 1e-9 /\n" PLANE("square", "") LAW("unstable.plm");
  const char *away = "  force N = -(1 - nu)*E*s*t*stretch\n";
  refused(square, "central bond", away);
  refused(hexagon, "central bond", away);
  refused(given, "central bond", away);
  refused(hexagon, "micropolar bond",
          "  force N = E*s*t*stretch\n  moment M_i = nu*E*s**2*t*(theta_i - 3*theta_j)\n"
          "  moment M_j = nu*E*s**2*t*(theta_j - 3*theta_i)\n");
  refused(space, "state", "  force state F[j] = E*s**2*(stretch[j] - (1 - nu)*sum(stretch[j]))\n");
}

/* --- the limit as a decimal number ------------------------------------------------------------ */

static void limits_are_decimal_numbers(void **state) {
  (void)state;
  assert_true(stability_rounded(1.23456789876e-6) == 1.23456789e-6);
  assert_true(stability_rounded(9.99999999999e-6) == 9.99999999e-6 ||
              stability_rounded(9.99999999999e-6) == 1e-5);
  assert_true(stability_rounded(0.25) == 0.25 && stability_rounded(nextafter(0.25, 0)) == 0.25);
  assert_true(stability_rounded(0) == 0 && isinf(stability_rounded(INFINITY)));
  seed = 5;
  long steps = 0;
  for (int k = 0; k < 100000; k++) {
    const double x = exp(uniform(-40, 5)), down = stability_rounded(x);
    assert_true(down <= x * (1 + 1.1e-12) && down >= x * (1 - 1.1e-8));
    assert_true(stability_rounded(down) == down);
    /* a few last digits, as between two libraries */
    steps += stability_rounded(x * (1 + 4e-16)) != down;
  }
  assert_true(steps <= 1);
}

/* Bonds with an axial damper and elastic bending: what is damped most is not what is fastest
   without dampers. A body of some size has the limit of the infinite lattice, or one that is a
   little longer. */
static void the_most_damped_mode_is_found(void **state) {
  (void)state;
  write_law("damped_beam.plm", "micropolar bond",
            "  constant EA = E*s*t/(sqrt(3)*(1 - nu))\n"
            "  constant B  = E*s**2*t*(1 - 3*nu)/(6*sqrt(3)*(1 - nu**2))\n"
            "  force N = EA*(stretch + 2e-6 [s]*stretch_rate)\n"
            "  moment M_i = B*(2*theta_i + theta_j)\n  moment M_j = B*(2*theta_j + theta_i)\n");
  deck_case c;
  open_case(
      &c, START
      "&lattice name = 'l' kind = 'hexagonal' spacing = '5 mm' thickness = '10 mm' /\n"
      "&body lattice = 'l' shape = 'rectangle' corner = 0, 0 size = '200 mm', '150 mm' /\n" LAW(
          "damped_beam.plm"));
  const step_limit *lattice = simulation_step_limit(c.simulation);
  step_limit whole = {.limit = 0};
  body_limit(c.law.law, c.law.parameters, NULL, simulation_rows(c.simulation, 0), &whole);
  print_message("damped beam: lattice %.4g us, body %.4g us, undamped %.4g us\n",
                1e6 * lattice->limit, 1e6 * whole.limit, 2e6 / whole.omega_max);
  assert_true(lattice->limit < 0.5 * 2 / lattice->omega_max);
  assert_true(whole.limit > (1 - BODY_ACCURACY) * lattice->limit);
  assert_true(whole.limit < 1.01 * lattice->limit);
  deck_case_close(&c);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(bodies_bear_the_step),
      cmocka_unit_test(sound_bonds_are_not_searched),
      cmocka_unit_test(kinks_at_rest_count),
      cmocka_unit_test(no_body_of_random_bonds_is_faster),
      cmocka_unit_test(forms_are_raised_no_more_than_needed),
      cmocka_unit_test(the_most_damped_mode_is_found),
      cmocka_unit_test(what_flies_apart_is_refused),
      cmocka_unit_test(limits_are_decimal_numbers),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
