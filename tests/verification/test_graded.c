/* Particles whose size is a formula of the place: as many and as large as the formula asks for, a
   body of the material's moduli, with one stress in one strain, in which waves run as fast as
   among particles of one size. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "runtime/analysis/uniform_strain.h"
#include "runtime/simulation/simulation_state.h"
#include "tests/verification/page.h"
#include "tests/verification/specimen.h"

static const double E = 25e9;

/* A bar of 100 x 200 mm; `more` are further groups, `keys` of the lattice. */
static bool start(deck_case *c, const char *spacing, const char *keys, const char *model_text,
                  const char *more) {
  char text[4096];
  snprintf(text, sizeof text,
           "&lattice name = 'l' kind = 'blue_noise' spacing = '%s' thickness = '100 mm' %s /\n"
           "&material lattice = 'l' model = %s /\n"
           "&body lattice = 'l' shape = 'rectangle' corner = '-50 mm', '-100 mm' "
           "size = '100 mm', '200 mm' /\n%s",
           spacing, keys, model_text, more);
  return deck_case_text(c, text);
}

#define ELASTIC "'splm_elastic' E = '25 GPa' nu = 0.2"
#define PULLED                                                                                     \
  "&simulation end_time = 1 /\n&relaxation increments = 1 tolerance = 1e-6 /\n"                    \
  "&region name = 'bottom' shape = 'rectangle' corner = '-50 mm', '-100 mm' "                      \
  "size = '100 mm', '8 mm' /\n"                                                                    \
  "&region name = 'top' shape = 'rectangle' corner = '-50 mm', '92 mm' size = '100 mm', '8 mm' "   \
  "/\n"                                                                                            \
  "&support region = 'bottom' fix = 'y' /\n"                                                       \
  "&drive region = 'top' component = 'y' displacement = '20 um' /\n"                               \
  "&monitor name = 'load' kind = 'reaction' between = 'bottom', 'top' component = 'y' /\n"

/* Slope of the displacements along y in the middle of the bar, each particle by its volume. */
static double strain_of(const sweep *w) {
  const rows *g = w->body->lattice;
  double n = 0, y = 0, u = 0, yy = 0, yu = 0;
  for (long p = 0; p < g->particle_count; p++) {
    const long q = g->particle_site[p];
    const double V = g->site_volume[q];
    if (fabs(g->y[q]) > 0.05) continue;
    n += V;
    y += V * g->y[q];
    u += V * w->body->displacement[1][q];
    yy += V * g->y[q] * g->y[q];
    yu += V * g->y[q] * w->body->displacement[1][q];
  }
  return (n * yu - y * u) / (n * yy - y * y);
}

/* Root of the mean square of sigma_1 about its mean, over the mean, by volume in the middle. */
static double stress_scatter(sweep *w) {
  const rows *g = w->body->lattice;
  double *sigma = calloc((size_t)g->size, sizeof *sigma), V = 0, mean = 0, square = 0;
  sweep_observe(w);
  sweep_output(w, 0, sigma);
  for (long p = 0; p < g->particle_count; p++) {
    const long q = g->particle_site[p];
    if (fabs(g->y[q]) > 0.05) continue;
    V += g->site_volume[q];
    mean += g->site_volume[q] * sigma[q];
    square += g->site_volume[q] * sigma[q] * sigma[q];
  }
  free(sigma);
  return sqrt(square / V - mean * mean / V / V) / (mean / V);
}

typedef struct seen {
  long particles;
  double ratio, held, left, modulus, scatter;
} seen;

static seen measure(const char *spacing) {
  deck_case c;
  uniform_response u;
  assert_true(start(&c, spacing, "seed = 1", ELASTIC, PULLED));
  const rows *g = simulation_rows(c.simulation, 0);
  assert_true(uniform_strain_response(c.law.law, c.law.parameters, NULL, g, false, &u));
  assert_true(fabs(u.nu - 0.2) < 1e-8);
  assert_int_equal(u.unresolved, 0);
  assert_int_equal(deck_case_go(&c), STEP_END);
  const double load = deck_case_last(&c, "load");
  const seen s = {g->particle_count,
                  g->own_size ? g->largest_size : 1,
                  u.E / E - 1,
                  u.left_force,
                  load / (0.1 * 0.1) / strain_of(simulation_state(c.simulation, 0)) / E - 1,
                  stress_scatter(simulation_state(c.simulation, 0))};
  print_message("%-36s %5ld particles, ratio %.2f: held off by %+.0e, force left %.0f %%, "
                "E %+.1f %%, stress +- %.1f %%\n",
                spacing, s.particles, s.ratio, s.held, 100 * s.left, 100 * s.modulus,
                100 * s.scatter);
  deck_case_close(&c);
  return s;
}

/* The row of the table in the reference. */
static void page_says(const char *row, const seen *s) {
  char figures[160];
  snprintf(figures, sizeof figures, "| %ld | %.2f | %+.1f %% | +- %.1f %% | %.0f %% |",
           s->particles, s->ratio, 100 * s->modulus, 100 * s->scatter, 100 * s->left);
  page_line_says("runtime/README.md", row, figures);
}

/* The operator of the law is exact for families of any shape: moduli of a body held in a strain are
   the material's at any gradation. Left to itself it is about 2 % too soft, as particles of one
   size are. */
static void moduli_are_held_at_every_ratio(void **state) {
  (void)state;
  static const char *const along[] = {"4 mm", "3 [mm] + 0.03*abs(y)", "3 [mm] + 0.09*abs(y)",
                                      "3 [mm] + 0.09*abs(x + 50 [mm])"};
  static const char *const rows_of_page[] = {"| 4 mm |", "| 3 mm + 0.03 abs(y) |",
                                             "| 3 mm + 0.09 abs(y) |", "| across: "};
  static const double ratio[] = {1, 2, 4, 4};
  for (int k = 0; k < 4; k++) {
    const seen s = measure(along[k]);
    assert_true(fabs(s.ratio / ratio[k] - 1) < 0.06);
    assert_true(fabs(s.held) < 1e-8);
    assert_true(s.modulus < 0 && s.modulus > -0.04);
    assert_true(s.left < 0.25);
    assert_true(s.scatter < 0.05);
    page_says(rows_of_page[k], &s);
  }
}

/* What the steepest gradation that decks may ask for costs: the stress of one strain scatters more
   than among particles of one size, but not twice as much. */
static void the_steepest_gradation_is_borne(void **state) {
  (void)state;
  const seen alike = measure("8 mm"), steep = measure("min(3 [mm] + 0.24*abs(y), 12 [mm])");
  assert_true(steep.scatter < 2 * alike.scatter);
  assert_true(fabs(steep.modulus) < 0.04);
  page_says("| 8 mm |", &alike);
  page_says("| 0.24 abs(y) more", &steep);
}

/* --- how many, how large ---------------------------------------------------------------------- */

static double spacing_of_volume(const rows *g, long site) {
  const double V = g->site_volume[site] / (g->dimensions == 2 ? 0.1 : 1);
  return g->dimensions == 2 ? sqrt(V / sqrt(0.75)) : cbrt(V * sqrt(2));
}

typedef double (*size_at)(const rows *g, long site);

/* Mean and scatter of the size of cells over that of the formula, in eight classes of sizes. */
static void check_sizes(const rows *g, size_at wanted, double within) {
  enum { CLASSES = 8 };
  double sum[CLASSES] = {0}, square[CLASSES] = {0}, volume = 0, worst = 0, scatter = 0;
  long count[CLASSES] = {0};
  for (long p = 0; p < g->particle_count; p++) {
    const long q = g->particle_site[p];
    const double asked = wanted(g, q), part = spacing_of_volume(g, q) / asked;
    const int k = (int)(CLASSES * 0.999 * (asked / g->spacing - 1) / (g->largest_size - 1));
    assert_true(fabs(rows_spacing(g, q) / asked - 1) < 1e-12);
    sum[k] += part;
    square[k] += part * part;
    count[k]++;
    volume += g->site_volume[q];
  }
  for (int k = 0; k < CLASSES; k++) {
    const double mean = sum[k] / (double)count[k];
    assert_true(count[k] > 10);
    worst = fmax(worst, fabs(mean - 1));
    scatter = fmax(scatter, sqrt(square[k] / (double)count[k] - mean * mean));
  }
  print_message("%ld particles: sizes off by %.1f %% at most in the mean of a class, +- %.1f %%\n",
                g->particle_count, 100 * worst, 100 * scatter);
  assert_true(worst < within);
  assert_true(scatter < 0.08);
}

static double by_height(const rows *g, long q) {
  return 2e-3 + 0.04 * fabs(g->y[q]);
}

static double by_depth(const rows *g, long q) {
  return 3e-3 + 0.08 * g->z[q];
}

static double volume_of(const rows *g) {
  double sum = 0;
  for (long p = 0; p < g->particle_count; p++)
    sum += g->site_volume[g->particle_site[p]];
  return sum;
}

/* Their number is the integral of one particle over its share, in closed form here. */
static void particles_are_as_large_as_asked_for(void **state) {
  (void)state;
  deck_case c;
  assert_true(
      deck_case_lattice(&c, "&simulation end_time = 1 /\n&lattice name = 'l' kind = 'blue_noise' "
                            "spacing = '2 [mm] + 0.04*abs(y)' thickness = '100 mm' /\n"
                            "&material lattice = 'l' model = 'splm_elastic' /\n"
                            "&body lattice = 'l' shape = 'rectangle' corner = '-50 mm', '-100 mm' "
                            "size = '100 mm', '200 mm' /\n"));
  const double plane = 2 * 0.1 / sqrt(0.75) / 0.04 * (1 / 2e-3 - 1 / 6e-3);
  assert_true(fabs((double)c.lattice->particle_count / plane - 1) < 0.01);
  assert_true(fabs(volume_of(c.lattice) / (0.1 * 0.2 * 0.1) - 1) < 1e-10);
  check_sizes(c.lattice, by_height, 0.04);
  deck_case_close(&c);
  assert_true(deck_case_lattice(
      &c, "&simulation end_time = 1 /\n&lattice name = 'l' kind = 'blue_noise' setting = 'space' "
          "spacing = '3 [mm] + 0.08*z' /\n"
          "&material lattice = 'l' model = 'splm_elastic' /\n"
          "&body lattice = 'l' shape = 'box' corner = 3*0 size = '50 mm', '50 mm', '60 mm' /\n"));
  const double space = 0.05 * 0.05 * sqrt(2) / (2 * 0.08) * (1 / 9e-6 - 1 / (7.8e-3 * 7.8e-3));
  assert_true(fabs((double)c.lattice->particle_count / space - 1) < 0.01);
  assert_true(fabs(volume_of(c.lattice) / (0.05 * 0.05 * 0.06) - 1) < 1e-8);
  check_sizes(c.lattice, by_depth, 0.04);
  deck_case_close(&c);
}

/* --- how easily they turn --------------------------------------------------------------------- */

#define FLAT_BODY                                                                                  \
  " thickness = '100 mm' /\n&material lattice = 'l' model = 'splm_elastic' /\n"                    \
  "&body lattice = 'l' shape = 'rectangle' corner = '-50 mm', '-100 mm' size = '100 mm', '200 "    \
  "mm' /\n&simulation end_time = 1 /\n"

/* m^2: of a particle, over its mass. */
static double turning(const rows *g, long site) {
  return g->inertia / g->mass * rows_radius_square(g, site);
}

/* As on a lattice of the particle's own spacing, whatever the others are. */
static void they_turn_as_particles_of_their_size(void **state) {
  (void)state;
  deck_case even, c;
  assert_true(deck_case_lattice(
      &even, "&lattice name = 'l' kind = 'hexagonal' spacing = '5 mm'" FLAT_BODY));
  rows_set_density(even.lattice, 2400);
  const double of_5_mm = even.lattice->inertia / even.lattice->mass;
  deck_case_close(&even);
  assert_true(fabs(of_5_mm / (0.4 * 2.5e-3 * 2.5e-3) - 1) < 1e-12);
  assert_true(deck_case_lattice(
      &c, "&lattice name = 'l' kind = 'blue_noise' spacing = '2 [mm] + 0.04*abs(y)'" FLAT_BODY));
  rows_set_density(c.lattice, 2400);
  const uint64_t known = rows_fingerprint(c.lattice);
  c.lattice->own_size[c.lattice->particle_site[0]] *= 1.5; /* sizes are part of what a run is of */
  assert_true(rows_fingerprint(c.lattice) != known);
  c.lattice->own_size[c.lattice->particle_site[0]] /= 1.5;
  for (long p = 0; p < c.lattice->particle_count; p++) {
    const long q = c.lattice->particle_site[p];
    const double part = by_height(c.lattice, q) / 5e-3;
    assert_true(fabs(turning(c.lattice, q) / (part * part * of_5_mm) - 1) < 1e-12);
  }
  deck_case_close(&c);
}

/* --- contact ---------------------------------------------------------------------------------- */

/* N/m: E V/s^2 of a particle in space, as large as in the fcc lattice. */
static double stiffness_of(const rows *g, long site) {
  return E * by_depth(g, site) / sqrt(2);
}

/* Two blocks lie above each other, a gap between them; the upper one, and a flat stamp above it, go
   down by `way`. */
static void open_blocks(deck_case *c, double way) {
#define BLOCK(name, z)                                                                             \
  "&lattice name = '" name                                                                         \
  "' kind = 'blue_noise' setting = 'space' spacing = '3 [mm] + 0.08*z' /\n"                        \
  "&material lattice = '" name "' model = " ELASTIC " /\n"                                         \
  "&body lattice = '" name "' shape = 'box' corner = 0, 0, " z                                     \
  " size = '20 mm', '20 mm', '20 mm' "                                                             \
  "/\n"
  assert_true(deck_case_text(
      c, "&simulation end_time = 1e-6 /\n" BLOCK("a", "0") BLOCK(
             "b", "'30 mm'") "&contact name = 'c' /\n"
                             "&stamp name = 's' shape = 'box' corner = '-50 mm', '-50 mm', '60 mm' "
                             "size = '0.2 m', "
                             "'0.2 m', '50 mm' direction = 0, 0, -1 velocity = 0 lattices = 'b' /\n"
                             "&output frames = 0 /\n"));
  body *upper = simulation_state(c->simulation, 1)->body;
  for (long p = 0; p < upper->lattice->particle_count; p++)
    upper->displacement[2][upper->lattice->particle_site[p]] = -way;
}

/* N along z: what the blocks exert on each other, pair by pair. */
static double push_by_hand(const rows *a, const rows *b, double way, long *pairs) {
  double sum = 0;
  *pairs = 0;
  for (long m = 0; m < a->particle_count; m++)
    for (long n = 0; n < b->particle_count; n++) {
      const long p = a->particle_site[m], q = b->particle_site[n];
      const double x = b->x[q] - a->x[p], y = b->y[q] - a->y[p], z = b->z[q] - way - a->z[p],
                   r = sqrt(x * x + y * y + z * z), d = 0.5 * (by_depth(a, p) + by_depth(b, q));
      if (r >= d) continue;
      sum += fmin(stiffness_of(a, p), stiffness_of(b, q)) * (d - r) * z / r;
      ++*pairs;
    }
  return sum;
}

static double sum_of_outer(const body *w) {
  double sum = 0;
  for (long p = 0; p < w->lattice->particle_count; p++)
    sum += body_outer(w, 2, w->lattice->particle_site[p]);
  return sum;
}

/* In space a particle's E V/s^2 grows with its spacing: of two the softer one's counts. */
static void large_particles_are_stiffer_in_contact(void **state) {
  (void)state;
  deck_case c;
  open_blocks(&c, 11.5e-3);
  body *const lower = simulation_state(c.simulation, 0)->body, *const upper =
                                                                   simulation_state(c.simulation, 1)
                                                                       ->body;
  const rows *a = lower->lattice, *b = upper->lattice;
  long pairs;
  const double push = push_by_hand(a, b, 11.5e-3, &pairs);
  body_clear_outer(lower);
  body_clear_outer(upper);
  contact_find(c.simulation->contacts.items[0].found);
  assert_true(pairs > 10);
  assert_int_equal(contact_touching(c.simulation->contacts.items[0].found, &(double){0}), pairs);
  assert_true(fabs(sum_of_outer(upper) / push - 1) < 1e-6);
  assert_true(fabs(sum_of_outer(lower) / push + 1) < 1e-6);
  /* what the stable step counts on */
  const double lightest = run_contact_lightest(a, run_contact_by_size(a, 0));
  const double most = E * a->spacing / sqrt(2) / lightest;
  for (long p = 0; p < a->particle_count; p++)
    assert_true(stiffness_of(a, a->particle_site[p]) / a->site_mass[a->particle_site[p]] <
                most * (1 + 1e-9));
  assert_false(run_contact_by_size(a, 1e8));
  /* the stamp comes down by 22 mm on what has gone down by 11.5 mm */
  const stamp_motion at = {.place = {0, 0, -22e-3}};
  double pressed = 0;
  for (long p = 0; p < b->particle_count; p++) {
    const long q = b->particle_site[p];
    const double depth = 0.5 * by_depth(b, q) - (60e-3 - 22e-3 - (b->z[q] - 11.5e-3));
    pressed += stiffness_of(b, q) * fmax(depth, 0);
  }
  const stamp_load l = stamp_find(c.simulation->stamps.items[0].found, &at, 0);
  assert_true(l.touching > 4 && fabs(l.force[2] / pressed - 1) < 1e-6);
  deck_case_close(&c);
}

/* --- waves ------------------------------------------------------------------------------------ */

/* The first mode along a free bar, let go: half a period until its ends have changed sides. The
   Rayleigh correction for the width w: 1 - (pi nu w/L)^2/24. */
static double first_period(const char *spacing) {
  deck_case c;
  assert_true(
      start(&c, spacing, "seed = 1", ELASTIC " rho = '2400 kg/m^3'",
            "&simulation end_time = '0.13 ms' /\n"
            "&region name = 'all' shape = 'rectangle' corner = '-50 mm', '-100 mm' "
            "size = '100 mm', '200 mm' /\n"
            "&region name = 'top' shape = 'rectangle' corner = '-50 mm', '80 mm' "
            "size = '100 mm', '20 mm' /\n"
            "&region name = 'bottom' shape = 'rectangle' corner = '-50 mm', '-100 mm' "
            "size = '100 mm', '20 mm' /\n"
            "&initial_displacement region = 'all' component = 'y' "
            "value = '1 [um]*sin(90 [deg]*y/100 [mm])' /\n"
            "&monitor name = 'open' kind = 'opening' between = 'bottom', 'top' component = 'y' /\n"
            "&output sample = '0.2 us' /\n"));
  assert_int_equal(deck_case_go(&c), STEP_END);
  const double *times;
  const long samples = simulation_history(c.simulation, &times);
  const double *open = deck_case_series(&c, "open");
  long n = 1;
  while (n < samples && open[n] > 0)
    n++;
  assert_true(n < samples);
  const double quarter =
      times[n - 1] + (times[n] - times[n - 1]) * open[n - 1] / (open[n - 1] - open[n]);
  deck_case_close(&c);
  return 4 * quarter;
}

static void waves_run_as_fast(void **state) {
  (void)state;
  const double pi = acos(-1);
  const double theory = 2 * 0.2 / sqrt(E / 2400) * (1 + pow(pi * 0.2 * 0.1 / 0.2, 2) / 24);
  const double alike = first_period("4 mm"), graded = first_period("3 [mm] + 0.09*abs(y)"),
               across = first_period("3 [mm] + 0.09*(x + 50 [mm])");
  print_message("period along the bar over theory: %+.2f %%; graded along it %+.2f %%, across it "
                "%+.2f %%\n",
                100 * (alike / theory - 1), 100 * (graded / theory - 1),
                100 * (across / theory - 1));
  assert_true(fabs(alike / theory - 1) < 0.02);
  assert_true(fabs(graded / theory - 1) < 0.02);
  assert_true(fabs(across / theory - 1) < 0.02);
}

/* --- the pages -------------------------------------------------------------------------------- */

/* The example's peak, beside theory and on its page. */
static void the_dog_bone_with_a_fine_neck(void **state) {
  (void)state;
  char figure[64];
  const outcome o = specimen_run("examples/dog_bone/d_graded.nml", "10.6 ms", NULL);
  snprintf(figure, sizeof figure, " %.2f kN", 1e-3 * o.peak);
  page_line_says("examples/dog_bone/README.md", "| [d_graded.nml](d_graded.nml) |", figure);
  assert_true(fabs(o.peak / 57.96e3 - 1) < 0.03);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(particles_are_as_large_as_asked_for),
      cmocka_unit_test(moduli_are_held_at_every_ratio),
      cmocka_unit_test(the_steepest_gradation_is_borne),
      cmocka_unit_test(they_turn_as_particles_of_their_size),
      cmocka_unit_test(large_particles_are_stiffer_in_contact),
      cmocka_unit_test(waves_run_as_fast),
      cmocka_unit_test(the_dog_bone_with_a_fine_neck),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
