/* Densities that differ from region to region, by formulas and at random: waves in a bar of two
   densities against theory, the stable step of bodies against what they bear, momentum and energy,
   the same bits as one density where all are equal, whatever the threads and after a resume; what a
   deck may not say. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "runtime/interaction/interaction.h"
#include "tests/generator/material_cases.h"
#include "tests/runtime/hand_over.h"

/* --- a joint of two bars ---------------------------------------------------------------------- */

/* Bars of one stiffness and the densities rho and 4 rho have impedances Z as 1 to 2. Of a wave that
   comes from the lighter one (Z2 - Z1)/(Z2 + Z1) = 1/3 in force is thrown back, so 1/9 of its
   energy; it runs on half as fast. */
#define JOINT                                                                                      \
  "&simulation end_time = '0.1 ms' step_safety = 0.5 /\n&output frames = 0 /\n"                    \
  "&lattice name = 'l' kind = '%s' spacing = '%d mm' %s /\n"                                       \
  "&body lattice = 'l' shape = 'rectangle' corner = '-400 mm', '-0.1 mm' size = '800 mm', '0.2 "   \
  "mm' /\n&region name = 'all' shape = 'rectangle' corner = -1, -1 size = 2, 2 /\n"                \
  "&region name = 'heavy' shape = 'rectangle' corner = '%.4g mm', -1 size = 1, 2 /\n"              \
  "&material lattice = 'l' model = '%s' E = '16 GPa' rho = 1000 /\n"                               \
  "&material lattice = 'l' region = 'heavy' model = '%s' E = '16 GPa' rho = 4000 /\n"              \
  "&initial_displacement region = 'all' component = 'x' value = '1 [um]*exp(-((x + 200 [mm])/40 "  \
  "[mm])**2)' /\n"                                                                                 \
  "&initial_velocity region = 'all' component = 'x' value = '%.17g [m/s]*1 [um]*2*(x + 200 "       \
  "[mm])/(40 [mm])**2*exp(-((x + 200 [mm])/40 [mm])**2)' /\n"

typedef struct halves { /* what has been thrown back, and what runs on */
  double energy[2], centre[2], time;
} halves;

/* Kinetic energies on either side of x = 0, and their centres. */
static halves run_joint(const char *kind, const char *more, const char *name, int spacing,
                        double speed) {
  char text[2048];
  deck_case c;
  halves h = {.energy = {0, 0}, .centre = {0, 0}};
  snprintf(text, sizeof text, JOINT, kind, spacing, more, 0.5 * spacing, name, name, speed);
  deck_case_open(&c, text);
  assert_int_equal(deck_case_go(&c), STEP_END);
  const body *w = simulation_state(c.simulation, 0)->body;
  for (long p = 0; p < w->lattice->particle_count; p++) {
    const long q = w->lattice->particle_site[p];
    const double v = w->velocity[0][q], x = w->lattice->x[q] - 0.5e-3 * spacing;
    const double energy = 0.5 * body_mass(w, 0, q) * v * v;
    h.energy[x > 0] += energy;
    h.centre[x > 0] += energy * x;
  }
  for (int k = 0; k < 2; k++)
    h.centre[k] /= h.energy[k];
  h.time = w->time - 0.5 * w->time_step; /* velocities are half a step behind */
  deck_case_close(&c);
  return h;
}

/* Young's modulus along a row: a hexagonal one is as a bar of the area that its bonds make. */
static double speed_along(const char *kind, const char *more, const char *name) {
  char text[2048];
  deck_case c;
  snprintf(text, sizeof text, JOINT, kind, 4, more, 2.0, name, name, 0.0);
  deck_case_open(&c, text);
  sweep *w = simulation_state(c.simulation, 0);
  const rows *g = w->body->lattice;
  const long first = g->particle_site[0];
  const double strain = 1e-9;
  for (long p = 0; p < g->particle_count; p++)
    w->body->displacement[0][g->particle_site[p]] = (double)p * strain * g->spacing;
  sweep_find_forces(w);
  const double spring = w->body->force[0][first] / (strain * g->spacing);
  const double speed = g->spacing * sqrt(spring / body_mass(w->body, 0, first));
  deck_case_close(&c);
  return speed;
}

static void check_joint(const char *kind, const char *more, const char *name) {
  const double speed = speed_along(kind, more, name);
  double last[3] = {0, 0, 0};
  for (int spacing = 8; spacing >= 2; spacing /= 2) {
    const halves h = run_joint(kind, more, name, spacing, speed);
    const double joint = 0.5e-3 * spacing, after = h.time - (0.2 + joint) / speed;
    const double error[3] = {sqrt(h.energy[0] / (h.energy[0] + h.energy[1])) * 3 - 1,
                             (-h.centre[0] / (speed * after)) - 1,
                             (h.centre[1] / (0.5 * speed * after)) - 1};
    print_message("%s, %s, %d mm: thrown back %+.2e off 1/3, speeds %+.2e and %+.2e off\n", kind,
                  name, spacing, error[0], error[1], error[2]);
    for (int k = 0; k < 3; k++) {
      if (spacing < 8) assert_true(fabs(error[k]) < 0.35 * fabs(last[k]));
      last[k] = error[k];
    }
  }
  for (int k = 0; k < 3; k++)
    assert_true(fabs(last[k]) < 0.005);
}

static void a_joint_throws_back_what_impedances_say(void **state) {
  (void)state;
  check_joint("hexagonal", "thickness = '10 mm'", "elastic_central");
  check_joint("chain", "area = '100 mm^2'", "bar");
}

/* --- the stable step -------------------------------------------------------------------------- */

#define PLATE(kind, more, law, rho)                                                                \
  START "&lattice name = 'l' kind = '" kind "' spacing = '5 mm' " more " /\n"                      \
        "&body lattice = 'l' shape = 'rectangle' corner = 0, 0 size = '60 mm', '40 mm' /\n"        \
        "&region name = 'core' shape = 'disc' centre = '30 mm', '20 mm' radius = '11 mm' /\n"      \
        "&material lattice = 'l' model = '" law "' rho = 2400 /\n"                                 \
        "&material lattice = 'l' region = 'core' model = '" law "' " rho " /\n"

/* Growth of velocities from tiny ones in 6000 steps of a part of the limit, or until it passes 1e5;
   rotations count with a spacing. */
static double growth(const deck_case *c, double part) {
  const step_limit *limit = simulation_step_limit(c->simulation);
  const rows *g = simulation_rows(c->simulation, 0);
  const double quiet = 1e-9 * g->spacing * limit->omega_max;
  sweep *w =
      interaction_new(g, c->law.law, c->law.parameters, part * limit->limit, 1, false, false);
  uint64_t seed = 11;
  double most = 1;
  w->parameter = simulation_planes(c->simulation, 0)->value;
  for (int d = 0; d < w->body->dof; d++)
    for (long p = 0; p < g->particle_count; p++)
      w->body->velocity[d][g->particle_site[p]] =
          draw_uniform(&seed, -quiet, quiet) / (d < 2 ? 1 : g->spacing);
  for (int step = 0; step < 6000 && most < 1e5; step++) {
    if (!sweep_step(w)) most = INFINITY;
    for (int d = 0; d < w->body->dof && step % 16 == 0; d++)
      for (long p = 0; p < g->particle_count; p++)
        most = fmax(most, fabs(w->body->velocity[d][g->particle_site[p]]) *
                              (d < 2 ? 1 : g->spacing) / quiet);
  }
  sweep_free(w);
  return most;
}

static void bodies_bear_the_step_and_no_more(void **state) {
  (void)state;
  static const char *const texts[] = {
      PLATE("hexagonal", "thickness = '10 mm'", "elastic_central", "rho = 300"),
      PLATE("hexagonal", "thickness = '10 mm'", "elastic_micropolar", "rho = 300"),
      PLATE("hexagonal", "thickness = '10 mm'", "mplm_bilinear", "rho = 9000"),
      PLATE("hexagonal", "thickness = '10 mm'", "elastic_central", "E = '300 GPa' rho = 7000"),
      PLATE("square", "thickness = '10 mm' horizon = 1.5", "elastic_central", "rho = 300"),
      PLATE("square", "thickness = '10 mm' horizon = 2.015", "lps", "rho = 300"),
      PLATE("blue_noise", "thickness = '10 mm'", "splm_elastic", "rho = 300")};
  for (size_t k = 0; k < sizeof texts / sizeof *texts; k++) {
    deck_case c;
    deck_case_open(&c, texts[k]);
    const double below = growth(&c, 0.999), above = growth(&c, 1.001);
    print_message(
        "%s %zu: limit %.6g us, velocities grow by %.3g at 0.999 of it, by %.3g at 1.001\n",
        c.law.law->name, k, 1e6 * simulation_step_limit(c.simulation)->limit, below, above);
    assert_true(below < 1000 && above >= 1e5);
    deck_case_close(&c);
  }
}

/* Dampers may stiffen with the strain: then no wave of the lightest particles on the stiffest bonds
   is faster. */
static void dampers_count_as_in_the_lightest_lattice(void **state) {
  (void)state;
  static const char *const whole = "&material lattice = 'l' model = 'dashpot.plm' ";
  char text[2][1024];
  deck_case c[2];
  FILE *out = fopen("dashpot.plm", "w");
  assert_non_null(out);
  fputs("model dashpot\n  law central bond\n  parameter E = 30 [GPa] in (0, inf)\n"
        "  parameter rho = 2400 [kg/m^3] in (0, inf)\n  parameter eta = 2 [kPa*s] in [0, inf)\n"
        "  force N = s*t*(E*stretch + eta*stretch_rate)\nend model\n",
        out);
  fclose(out);
  snprintf(text[0], sizeof text[0],
           CHAIN("hexagonal") "%s rho = 2400 /\n&region name = 'a' shape = 'disc' centre = 0, 0 "
                              "radius = '20 mm' /\n%s rho = 600 region = 'a' /\n",
           whole, whole);
  snprintf(text[1], sizeof text[1], CHAIN("hexagonal") "%s rho = 600 /\n", whole);
  for (int k = 0; k < 2; k++)
    deck_case_open(&c[k], text[k]);
  assert_true(simulation_step_limit(c[0].simulation)->limit ==
              simulation_step_limit(c[1].simulation)->limit);
  for (int k = 0; k < 2; k++)
    deck_case_close(&c[k]);
}

/* --- momentum and energy ---------------------------------------------------------------------- */

#define PUSHED                                                                                     \
  "&simulation end_time = '0.2 ms' threads = %d step = '0.2 us' /\n&output frames = 0 sample = "   \
  "'0.01 ms' /\n"                                                                                  \
  "&lattice name = 'l' kind = '%s' spacing = '5 mm' thickness = '10 mm' %s /\n"                    \
  "&body lattice = 'l' shape = 'rectangle' corner = 0, 0 size = '100 mm', '60 mm' /\n"             \
  "&region name = 'right' shape = 'rectangle' corner = '51 mm', -1 size = 1, 2 /\n"                \
  "&region name = 'end' shape = 'rectangle' corner = -1, '20 mm' size = '1.003 m', 2 /\n"          \
  "&force region = 'end' component = 'x' total = '2 kN' /\n"                                       \
  "&gravity acceleration = 0, -1000 /\n"                                                           \
  "&monitor name = 'p' kind = 'momentum' component = 'x' /\n"                                      \
  "&monitor name = 'q' kind = 'momentum' component = 'y' /\n"                                      \
  "&monitor name = 'k' kind = 'energy' component = 'kinetic' /\n"

#define STEPWISE                                                                                   \
  "&material lattice = 'l' model = '%s' rho = 2000 /\n"                                            \
  "&material lattice = 'l' model = '%s' region = 'right' rho = 7000 /\n"

static const struct body_kind {
  const char *kind, *more, *law;
} bodies[] = {{"hexagonal", "", "elastic_central"},
              {"hexagonal", "", "elastic_micropolar"},
              {"square", "horizon = 1.5", "elastic_central"},
              {"square", "horizon = 2.015", "lps"},
              {"blue_noise", "", "splm_elastic"}};
enum { BODIES = sizeof bodies / sizeof *bodies };

static void open_pushed(deck_case *c, const struct body_kind *b, int threads,
                        const char *material) {
  char text[4096];
  int length = snprintf(text, sizeof text, PUSHED, threads, b->kind, b->more);
  snprintf(text + length, sizeof text - (size_t)length, material, b->law, b->law);
  deck_case_open(c, text);
}

static double mass_of(const body *w) {
  double sum = 0;
  for (long p = 0; p < w->lattice->particle_count; p++) {
    const long q = w->lattice->particle_site[p];
    const double V = w->lattice->site_volume ? w->lattice->site_volume[q] : w->lattice->volume;
    sum += V * (w->lattice->x[q] > 0.051 - 1e-9 ? 7000 : 2000);
  }
  return sum;
}

static void check_momentum(deck_case *c, const char *name, bool checked) {
  assert_int_equal(deck_case_go(c), STEP_END);
  const long last = simulation_history(c->simulation, NULL) - 1;
  const body *w = simulation_state(c->simulation, 0)->body;
  const double t = w->time, mass = mass_of(w);
  const double p = deck_case_series(c, "p")[last] / (2000 * t) - 1,
               q = deck_case_series(c, "q")[last] / (-1000 * t * mass) - 1,
               work = deck_case_series(c, "energy/external")[last],
               k = deck_case_series(c, "k")[last] / deck_case_series(c, "energy/kinetic")[last] - 1,
               lost = deck_case_series(c, "energy/imbalance")[last] / work;
  print_message("%s: momentum %+.1e and %+.1e off, kinetic energy %+.1e, imbalance %+.1e\n", name,
                p, q, k, lost);
  assert_true(fabs(p) < 1e-12 && fabs(q) < 1e-12 && fabs(k) < 1e-12);
  if (checked) assert_true(fabs(lost) < 1e-6);
}

static void forces_and_weight_are_the_momentum(void **state) {
  (void)state;
  for (int b = 0; b < BODIES; b++) {
    deck_case c;
    open_pushed(&c, &bodies[b], 1, STEPWISE);
    check_momentum(&c, bodies[b].law, strcmp(bodies[b].law, "lps") != 0);
    deck_case_close(&c);
  }
}

#define BESIDE(first, second)                                                                      \
  "&material lattice = 'l' model = " first " rho = 2000 / ! %s\n"                                  \
  "&material lattice = 'l' region = 'right' model = " second " / ! %s\n"

/* The particles of that region and their density. */
static void write_right(const rows *g) {
  FILE *out = fopen("right.csv", "w");
  assert_non_null(out);
  fputs("x, y, rho [g/cm^3]\n", out);
  for (long p = 0; p < g->particle_count; p++) {
    const long q = g->particle_site[p];
    if (g->x[q] > 0.051 - 1e-9) fprintf(out, "%.17g, %.17g, 7\n", g->x[q], g->y[q]);
  }
  fclose(out);
}

/* Each law brings its own, from a file of its region, too; one reads masses. */
static void laws_on_one_lattice_have_their_densities(void **state) {
  (void)state;
  static const char *const materials[] = {
      BESIDE("'elastic_micropolar'", "'mplm_concrete' zeta = 0.02 rho = 7000"),
      BESIDE("'elastic_micropolar'", "'mplm_concrete' zeta = 0.02 rho = 'right.csv:rho'"),
      BESIDE("'lps'", "'pmb' rho = 7000")};
  for (int k = 0; k < 3; k++) {
    deck_case c;
    open_pushed(&c, &bodies[k < 2 ? 1 : 3], 1, materials[k]);
    if (k == 0) write_right(simulation_rows(c.simulation, 0));
    check_momentum(&c, materials[k], false);
    deck_case_close(&c);
  }
}

/* --- the same bits ---------------------------------------------------------------------------- */

#define ALIKE "&material lattice = 'l' model = '%s' rho = 2400 / ! %s\n"
#define ALL_ALIKE                                                                                  \
  "&material lattice = 'l' model = '%s' rho = '| 2400 [kg/m^3] when x < 51 [mm] | 2400 [kg/m^3] "  \
  "otherwise' / ! %s\n"
#define AT_RANDOM                                                                                  \
  "&material lattice = 'l' model = '%s' rho = 4000 / ! %s\n"                                       \
  "&field parameter = 'rho' distribution = 'lognormal' cv = 0.3 /\n"

static void equal_densities_are_one_density(void **state) {
  (void)state;
  for (int b = 0; b < BODIES; b++) {
    deck_case one, each;
    open_pushed(&one, &bodies[b], 1, ALIKE);
    open_pushed(&each, &bodies[b], 1, ALL_ALIKE);
    assert_non_null(simulation_rows(each.simulation, 0)->site_mass);
    assert_int_equal(deck_case_go(&one), STEP_END);
    assert_int_equal(deck_case_go(&each), STEP_END);
    assert_same_motion(&one, &each);
    deck_case_close(&one);
    deck_case_close(&each);
  }
}

static void threads_and_a_resume_give_the_same_bits(void **state) {
  (void)state;
  static const char *const materials[] = {STEPWISE, AT_RANDOM};
  for (int b = 0; b < 2 * BODIES; b++) {
    const char *const material = materials[b % 2];
    deck_case one, more, first, second;
    open_pushed(&one, &bodies[b / 2], 1, material);
    open_pushed(&more, &bodies[b / 2], 3, material);
    open_pushed(&first, &bodies[b / 2], 1, material);
    open_pushed(&second, &bodies[b / 2], 2, material);
    assert_int_equal(deck_case_go(&one), STEP_END);
    assert_int_equal(deck_case_go(&more), STEP_END);
    assert_same_motion(&one, &more);
    hand_over(first.simulation, simulation_step_count(one.simulation) / 2, second.simulation);
    assert_int_equal(deck_case_go(&second), STEP_END);
    assert_same_motion(&one, &second);
    deck_case_close(&one);
    deck_case_close(&more);
    deck_case_close(&first);
    deck_case_close(&second);
  }
}

/* --- laws that read masses -------------------------------------------------------------------- */

/* A stiffness that grows with the reduced over the smaller mass: 1 between equal ones, 8/5 between
   those of 1 to 4. Strips know one mass; such a law of bonds runs as one of families. */
static void laws_read_the_masses_of_their_ends(void **state) {
  (void)state;
  enum { PARTICLES = 20, JOINED = 10 };
  static const char halves_of[] =
      "&region name = 'right' shape = 'rectangle' corner = '49 mm', '-1 mm' size = '50 mm', '2 mm' "
      "/\n&material lattice = 'l' model = 'reduced.plm' rho = 2000 /\n"
      "&material lattice = 'l' region = 'right' model = 'reduced.plm' rho = 8000 /\n";
  static const char *const heads[] = {CHAIN("hexagonal"), CHAIN("square")};
  double stretch[PARTICLES], borne;
  FILE *out = fopen("reduced.plm", "w");
  assert_non_null(out);
  fputs("model reduced\n  law central bond\n  parameter E = 30 [GPa] in (0, inf)\n"
        "  parameter rho = 2400 [kg/m^3] in (0, inf)\n"
        "  force N = E*s*t*stretch*2*m_i*m_j/((m_i + m_j)*m)\nend model\n",
        out);
  fclose(out);
  for (int p = 0; p < PARTICLES; p++)
    stretch[p] = p == JOINED ? 1e-6 * 5 / 8 : 1e-6;
  for (int k = 0; k < 2; k++) {
    char text[2048];
    snprintf(text, sizeof text, "%s%s", heads[k], halves_of);
    const double left = left_in_a_row(text, stretch, &borne);
    print_message("%.1e of the force is left in a row of springs\n", left);
    assert_true(borne > 0 && left < 1e-9);
  }
}

/* --- what may not be -------------------------------------------------------------------------- */

#define OF_BAR(given) "&material lattice = 'l' model = 'elastic_central' " given " /\n"

static void what_cannot_be_is_told(void **state) {
  (void)state;
  refuse(OF_BAR("rho = '2000 [kg/m^3]*(1 - x/95 [mm])'"),
         "`rho` = 0 kg/m^3 in the particle at (95, 0) mm is not in (0, inf)");
  refuse(OF_BAR("rho = '2000 [Pa]*(1 + x/95 [mm])'"), "`rho` needs");
  refuse(OF_BAR("") "&field parameter = 'rho' distribution = 'normal' cv = 0.1 on = 'bond' /\n",
         "`rho` is the density of the particles: bonds have no mass");
  refuse(OF_BAR("") "&field parameter = 'rho' distribution = 'normal' cv = 2 /\n",
         "the range of the law `elastic_central`; so are");
}

int main(void) {
  const struct CMUnitTest tests[] = {cmocka_unit_test(a_joint_throws_back_what_impedances_say),
                                     cmocka_unit_test(bodies_bear_the_step_and_no_more),
                                     cmocka_unit_test(dampers_count_as_in_the_lightest_lattice),
                                     cmocka_unit_test(forces_and_weight_are_the_momentum),
                                     cmocka_unit_test(laws_on_one_lattice_have_their_densities),
                                     cmocka_unit_test(equal_densities_are_one_density),
                                     cmocka_unit_test(threads_and_a_resume_give_the_same_bits),
                                     cmocka_unit_test(laws_read_the_masses_of_their_ends),
                                     cmocka_unit_test(what_cannot_be_is_told)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
