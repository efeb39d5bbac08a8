/* The stamps of examples/stamp against theory and what the page says: a rigid roll on a block in
   the plane and a rigid ball on one in space against Hertz, within the error of the spacing; a ram
   on a rod; a hammer on a beam. On a square lattice a deck that is turned by 90 degrees or mirrored
   gives the turned or mirrored answer. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "runtime/simulation/simulation_state.h"
#include "tests/verification/case.h"
#include "tests/verification/page.h"

/* --- Hertz ------------------------------------------------------------------------------------ */

typedef struct pressed { /* as it was found */
  double force;          /* N, on the stamp */
  double radius;         /* m: of the contact, by the moments of the forces of particles */
  double most;           /* N: the largest force of a particle */
  double height;         /* m: from the lowest particles to the surface */
  long touching;
} pressed;

/* What stamps exert on the particles of the first body; along y in the plane, along z in space. The
   mean of r^2, weighed by Hertz's pressure, is 1/4 of the square of the half width of a line, and
   2/5 of that of the radius of a circle. */
static pressed look(const deck_case *c) {
  const body *w = simulation_state(c->simulation, 0)->body;
  const int up = w->dimensions - 1;
  const stamp_load *l = &c->simulation->stamps.items[0].load;
  pressed p = {.force = l->force[up], .touching = l->touching};
  double sum = 0, second = 0;
  for (long n = 0; n < w->lattice->particle_count; n++) {
    const long q = w->lattice->particle_site[n];
    const double f = -body_outer(w, up, q);
    double at[3];
    rows_place(w->lattice, q, at);
    sum += f;
    for (int d = 0; d < up; d++)
      second += f * (at[d] + w->displacement[d][q]) * (at[d] + w->displacement[d][q]);
    p.most = fmax(p.most, f);
    p.height = fmax(p.height, -at[up]);
  }
  p.radius = sqrt(second / sum * (w->dimensions == 2 ? 4 : 2.5));
  return p;
}

#define FOLDER "examples/stamp/"
#define ROLL   0.2 /* m */
#define E_MOD  30e9

static void run(deck_case *c, const char *name, char (*texts)[96], int count) {
  const char *overrides[8] = {NULL};
  for (int n = 0; n < count; n++)
    overrides[n] = texts[n];
  assert_true(deck_case_run(c, name, overrides, count));
  assert_int_equal(deck_case_go(c), STEP_END);
}

static void says(const char *row, const char *form, double value) {
  char figure[64];
  snprintf(figure, sizeof figure, form, value);
  page_line_says(FOLDER "README.md", row, figure);
}

/* `stiffer`: than E V/s^2. */
static pressed roll(double s, double stiffer) {
  char set[4][96];
  snprintf(set[0], sizeof *set, "lattice.spacing=%.17g", s);
  snprintf(set[1], sizeof *set, "lattice.origin=0, %.17g", -0.5 * s);
  snprintf(set[2], sizeof *set, "stamp.stiffness=%.17g", stiffer * E_MOD * sqrt(3) / 2 * 0.01);
  snprintf(set[3], sizeof *set, "relaxation.increments=2");
  deck_case c;
  run(&c, FOLDER "roll.nml", set, 4);
  const pressed p = look(&c);
  deck_case_close(&c);
  return p;
}

/* Half width of a rigid roll's contact: a^2 = 4 F/t R/(pi E*), in plane stress E* = E; the largest
   pressure is 2 F/(pi a t). The places of particles see a roll of half a spacing more. */
static double roll_error(double s, double stiffer, double *force) {
  const pressed p = roll(s, stiffer);
  const double a = sqrt(4 * p.force / 0.01 * (ROLL + 0.5 * s) / (acos(-1) * E_MOD)),
               most = 2 * p.force / (acos(-1) * a) * s;
  print_message("roll, %g mm, %g k: F %6.2f kN, half width %.4f mm, %.4f by Hertz (%+.2f %%); %ld "
                "touch, the largest force %+.1f %%\n",
                1e3 * s, stiffer, 1e-3 * p.force, 1e3 * p.radius, 1e3 * a, 100 * (p.radius / a - 1),
                p.touching, 100 * (p.most / most - 1));
  assert_true(fabs(p.most / most - 1) < 0.08);
  *force = p.force;
  return p.radius / a - 1;
}

static void a_roll_presses_as_hertz_says(void **state) {
  (void)state;
  double force[3];
  const double coarse = roll_error(2e-3, 1, &force[0]), fine = roll_error(1e-3, 1, &force[1]),
               stiff = roll_error(2e-3, 4, &force[2]);
  assert_true(coarse > 0 && coarse < 0.06 && fabs(fine) < 0.5 * coarse && fabs(stiff) < 0.01);
  says("| roll, 2 mm |", "%.1f kN", 1e-3 * force[0]);
  says("| roll, 2 mm |", "%+.1f %%", 100 * coarse);
  says("| roll, 1 mm |", "%.1f kN", 1e-3 * force[1]);
  says("| roll, 1 mm |", "%+.1f %%", 100 * fine);
  says("| roll, 2 mm, four times as stiff |", "%.1f kN", 1e-3 * force[2]);
  says("| roll, 2 mm, four times as stiff |", "%+.1f %%", 100 * stiff);
}

#define BALL 0.1 /* m */
#define NU   0.2

static pressed ball(double s) {
  char set[3][96];
  snprintf(set[0], sizeof *set, "lattice.spacing=%.17g", s);
  snprintf(set[1], sizeof *set, "lattice.origin=0, 0, %.17g", -0.5 * s);
  snprintf(set[2], sizeof *set, "region.size=0.08, 0.08, %.17g", s > 3e-3 ? 2.5e-3 : 1.5e-3);
  deck_case c;
  run(&c, FOLDER "ball.nml", set, 3);
  const pressed p = look(&c);
  deck_case_close(&c);
  return p;
}

/* Force of a rigid ball on a layer that is bonded to what is rigid, over that on a half-space at
   the same depth: `part`, the root of R d, over the layer's height (Dimitriadis et al. 2002). */
static double of_layer(double part) {
  const double pi = acos(-1), p = -(1.2876 - 1.4678 * NU + 1.3442 * NU * NU) / (1 - NU),
               q = (0.6387 - 1.0277 * NU + 1.5164 * NU * NU) / (1 - NU), a = 2 * p / pi * part;
  return 1 - a + a * a - a * a * a * (1 + 4 * pi * pi / 15 * q / (p * p * p)) +
         a * a * a * a * (1 + 3 * pi * pi / 5 * q / (p * p * p));
}

/* Radius of the contact of a rigid ball: a^3 = 3 F R/(4 E*); F over that on a layer as high. */
static double ball_error(double s, double *over, double *force) {
  const double R = BALL + 0.5 * s, modulus = E_MOD / (1 - NU * NU), depth = 1e-3;
  const pressed p = ball(s);
  const double a = cbrt(0.75 * p.force * R / modulus);
  *force = p.force;
  *over = p.force / (4.0 / 3 * modulus * sqrt(BALL) * pow(depth, 1.5)) /
          of_layer(sqrt(BALL * depth) / p.height);
  print_message("ball, %g mm: F %6.2f kN, %.3f of that on a layer of %.2f mm; radius %.4f mm, %.4f "
                "by Hertz (%+.2f %%); %ld touch\n",
                1e3 * s, 1e-3 * p.force, *over, 1e3 * p.height, 1e3 * p.radius, 1e3 * a,
                100 * (p.radius / a - 1), p.touching);
  return fabs(p.radius / a - 1);
}

/* What is missing falls with the spacing: two of them tell what it would be without. */
static void a_ball_presses_as_hertz_says(void **state) {
  (void)state;
  double over[2], force[2];
  const double coarse = ball_error(4e-3, &over[0], &force[0]),
               fine = ball_error(2e-3, &over[1], &force[1]), found = 2 * over[1] - over[0];
  print_message("without the spacing's error %.3f\n", found);
  assert_true(fine < 0.1 && fine < 0.6 * coarse);
  assert_true(fabs(found - 1) < 0.05);
  says("| ball, 4 mm |", "%.1f kN", 1e-3 * force[0]);
  says("| ball, 4 mm |", "%+.1f %%", 100 * coarse);
  says("| ball, 2 mm |", "%.1f kN", 1e-3 * force[1]);
  says("| ball, 2 mm |", "%+.1f %%", 100 * fine);
  says("| ball, 4 mm |", "%.3f", over[0]);
  says("| ball, 2 mm |", "%.3f", over[1]);
  says("together tell", "%.2f", found);
}

/* --- blows ------------------------------------------------------------------------------------ */

/* Speed of a rigid mass M against a long rod: v exp(-Z t/M), Z = A sqrt(E rho). The largest
   difference, over v. */
static double ram_error(double s) {
  const double Z = 400e-6 * sqrt(E_MOD * 2400), v = 2, M = 0.4, *time;
  char set[2][96];
  snprintf(set[0], sizeof *set, "lattice.spacing=%.17g", s);
  snprintf(set[1], sizeof *set, "lattice.origin=%.17g, 0", 0.5 * s);
  deck_case c;
  run(&c, FOLDER "ram.nml", set, 2);
  const double *speed = deck_case_series(&c, "speed"), *force = deck_case_series(&c, "force");
  const long samples = simulation_history(c.simulation, &time);
  double most = 0;
  for (long k = 0; k < samples; k++)
    most = fmax(most, fabs(speed[k] / v - exp(-Z * time[k] / M)));
  assert_true(deck_case_largest(&c, "energy/imbalance") < 1e-11);
  print_message("ram, %g mm: speed within %.3f %%; largest force %.0f N, v Z %.0f N\n", 1e3 * s,
                100 * most, deck_case_largest(&c, "force"), v * Z);
  assert_true(force[0] == 0);
  deck_case_close(&c);
  return most;
}

static void a_ram_slows_down_as_on_a_long_rod(void **state) {
  (void)state;
  double error[3];
  for (int n = 0; n < 3; n++)
    error[n] = ram_error(4e-3 / (1 << n));
  for (int n = 0; n < 3; n++)
    says("| speed of the ram", "%.2f %%", 100 * error[n]);
  assert_true(error[0] < 5e-3 && error[1] < 0.6 * error[0] && error[2] < 0.6 * error[1]);
}

static void a_hammer_breaks_a_beam(void **state) {
  (void)state;
  deck_case c;
  run(&c, FOLDER "drop.nml", NULL, 0);
  const long last = simulation_history(c.simulation, NULL) - 1;
  const double *damped = deck_case_series(&c, "concrete/dissipated_damping"),
               *damage = deck_case_series(&c, "concrete/dissipated_damage");
  const double friction = deck_case_series(&c, "left/dissipated_damping")[last] +
                          deck_case_series(&c, "right/dissipated_damping")[last];
  says("| largest force of the hammer", "%.0f kN", 1e-3 * deck_case_largest(&c, "blow"));
  says("| largest force of a roller", "%.0f kN", 1e-3 * deck_case_largest(&c, "support"));
  says("| speed of the hammer after", "%.2f m/s", -deck_case_series(&c, "speed")[last]);
  says("| taken by damage", "%.1f J", damage[last]);
  says("| taken by dampers of the law", "%.1f J", damped[last]);
  says("| taken by friction", "%.1f J", friction);
  says("| imbalance", "%.2f J", fabs(deck_case_series(&c, "energy/imbalance")[last]));
  assert_true(deck_case_largest(&c, "energy/imbalance") <
              5e-3 * deck_case_largest(&c, "energy/kinetic"));
  deck_case_close(&c);
}

/* --- turned and mirrored ---------------------------------------------------------------------- */

/* An image of a place: turned by 90 degrees, or x and y with other signs. */
typedef struct image {
  const char *name;
  double to[2][2];
} image;

static const image images[] = {{"turned", {{0, -1}, {1, 0}}},
                               {"mirrored", {{-1, 0}, {0, 1}}},
                               {"turned by 180 degrees", {{-1, 0}, {0, -1}}}};

static void put(const image *of, double x, double y, double out[2]) {
  for (int c = 0; c < 2; c++)
    out[c] = of->to[c][0] * x + of->to[c][1] * y;
}

/* A block that a ball and a punch hit, as it is seen in the image. */
static void open_image(deck_case *c, const image *of) {
  double a[2], b[2], ball_at[2], way[2], p[2], q[2], down[2];
  char text[4096];
  put(of, 0, 0, a);
  put(of, 0.05, 0.04, b);
  put(of, 0.0712, 0.026, ball_at);
  put(of, -1, -0.2, way);
  put(of, 0.011, 0.0412, p);
  put(of, 0.029, 0.05, q);
  put(of, 0, -1, down);
  snprintf(text, sizeof text,
           "&simulation end_time = 1e-4 step = 1e-7 /\n"
           "&lattice name = 'b' kind = 'square' spacing = 0.002 horizon = 3.015 thickness = 0.01 "
           "/\n&material lattice = 'b' model = 'pmb' G_0 = 1000 /\n"
           "&body lattice = 'b' shape = 'rectangle' corner = %.17g, %.17g size = %.17g, %.17g /\n"
           "&stamp name = 'ball' shape = 'disc' centre = %.17g, %.17g radius = 0.02 mass = 0.02 "
           "direction = %.17g, %.17g velocity = 20 friction = 0.3 damping = 0.05 /\n"
           "&stamp name = 'punch' shape = 'rectangle' corner = %.17g, %.17g size = %.17g, %.17g "
           "direction = %.17g, %.17g velocity = 5 friction = 0.2 /\n"
           "&monitor name = 'x' kind = 'displacement' stamp = 'ball' component = 'x' /\n"
           "&monitor name = 'y' kind = 'displacement' stamp = 'ball' component = 'y' /\n"
           "&monitor name = 'M' kind = 'moment' stamp = 'ball' /\n"
           "&monitor name = 'Fx' kind = 'contact_force' stamp = 'punch' component = 'x' /\n"
           "&monitor name = 'Fy' kind = 'contact_force' stamp = 'punch' component = 'y' /\n"
           "&output frames = 0 sample = 1e-6 /\n",
           fmin(a[0], b[0]), fmin(a[1], b[1]), fabs(b[0] - a[0]), fabs(b[1] - a[1]), ball_at[0],
           ball_at[1], way[0], way[1], fmin(p[0], q[0]), fmin(p[1], q[1]), fabs(q[0] - p[0]),
           fabs(q[1] - p[1]), down[0], down[1]);
  deck_case_open(c, text);
  assert_int_equal(deck_case_go(c), STEP_END);
}

/* Difference of two vectors of which one is the image of the other, over the largest. */
static double image_error(const image *of, const deck_case *first, const deck_case *second,
                          const char *x, const char *y) {
  const double *u = deck_case_series(first, x), *v = deck_case_series(first, y),
               *p = deck_case_series(second, x), *q = deck_case_series(second, y);
  double most = 0, size = 0;
  for (long k = 0; k < simulation_history(first->simulation, NULL); k++) {
    double there[2];
    put(of, u[k], v[k], there);
    most = fmax(most, fmax(fabs(there[0] - p[k]), fabs(there[1] - q[k])));
    size = fmax(size, fmax(fabs(u[k]), fabs(v[k])));
  }
  assert_true(size > 0);
  return most / size;
}

static void images_are_alike(void **state) {
  (void)state;
  static const image itself = {"itself", {{1, 0}, {0, 1}}};
  deck_case first;
  open_image(&first, &itself);
  for (size_t n = 0; n < sizeof images / sizeof *images; n++) {
    const image *of = &images[n];
    deck_case second;
    open_image(&second, of);
    const double way = image_error(of, &first, &second, "x", "y"),
                 force = image_error(of, &first, &second, "Fx", "Fy"),
                 turn = of->to[0][0] * of->to[1][1] - of->to[0][1] * of->to[1][0];
    double moment = 0;
    const double *M = deck_case_series(&first, "M"), *N = deck_case_series(&second, "M");
    for (long k = 0; k < simulation_history(first.simulation, NULL); k++)
      moment = fmax(moment, fabs(M[k] - turn * N[k]));
    moment /= deck_case_largest(&first, "M");
    print_message("%-22s way %.1e, force %.1e, moment %.1e\n", of->name, way, force, moment);
    assert_true(way < 1e-12 && force < 1e-10 && moment < 1e-10);
    deck_case_close(&second);
  }
  deck_case_close(&first);
}

/* --- graded particles ------------------------------------------------------------------------- */

#define TOP 0.06 /* m */

/* Half of its own spacing. */
static double radius_at(double y) {
  return 0.5 * (2e-3 + 0.06 * y);
}

/* How far the lower side of a stamp at y lies in the body; `sum`: in all its particles. */
static double depth_by_hand(const rows *w, double y, double *sum) {
  double most = -INFINITY;
  *sum = 0;
  for (long p = 0; p < w->particle_count; p++) {
    const double at = w->y[w->particle_site[p]], depth = radius_at(at) - (y - at);
    most = fmax(most, depth);
    *sum += fmax(depth, 0);
  }
  return most;
}

/* Particles from 2 to 5.6 mm: a stamp that comes down on the coarse side meets each at half of its
   own spacing. */
static void coarse_particles_touch_at_half_their_own_spacing(void **state) {
  (void)state;
  const deck_shape flat = {.kind = SHAPE_RECTANGLE, .corner = {-0.02, TOP}, .size = {0.08, 0.02}};
  deck_case c;
  surface of;
  deck_case_open(&c, "&simulation end_time = 1e-4 /\n"
                     "&lattice name = 'b' kind = 'blue_noise' spacing = '2 [mm] + 0.06*y' "
                     "thickness = 0.01 /\n&material lattice = 'b' model = 'splm_elastic' /\n"
                     "&body lattice = 'b' shape = 'rectangle' corner = 0, 0 size = 0.04, 0.06 /\n"
                     "&output frames = 0 /\n");
  body *w = simulation_state(c.simulation, 0)->body;
  assert_true(surface_open(&flat, &of));
  body_add_outer(w);
  stamp *s = stamp_new(&of, &(stamp_body){.of = w, .stiffness = 1e8}, 1, 0, 0);
  double sum;
  for (int n = 0; n < 5; n++) {
    const double way = 3e-4 * (n - 2);
    const stamp_motion at = {.place = {0, way}};
    const double most = depth_by_hand(w->lattice, TOP + way, &sum);
    body_clear_outer(w);
    const stamp_load l = stamp_find(s, &at, 1e-6);
    const stamp_inside in = stamp_look_inside(s, at.place, 0);
    assert_true(fabs(in.depth - most) < 1e-12);
    assert_true(fabs(l.force[1] - 1e8 * sum) < 1e-6);
    assert_int_equal(l.touching, in.count);
    assert_true(n > 2 || l.touching > 0);
  }
  stamp_free(s);
  deck_case_close(&c);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(a_roll_presses_as_hertz_says),
      cmocka_unit_test(a_ball_presses_as_hertz_says),
      cmocka_unit_test(a_ram_slows_down_as_on_a_long_rod),
      cmocka_unit_test(a_hammer_breaks_a_beam),
      cmocka_unit_test(images_are_alike),
      cmocka_unit_test(coarse_particles_touch_at_half_their_own_spacing),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
