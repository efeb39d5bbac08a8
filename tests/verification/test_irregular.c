/* Laws of families on particles that stand on no lattice. Theory: the operator of the splm laws
   gives a family of any shape the stress of a uniform strain, so that a body has the material's
   moduli then, whatever its particles; left to itself it is a little softer, the less the more
   neighbours; on a perfect lattice it is the lattice's own. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>
#include <unistd.h>

#include "runtime/analysis/uniform_strain.h"
#include "tests/verification/case.h"

#define PLANE_BODY                                                                                 \
  "&body lattice = 'l' shape = 'rectangle' corner = 0, 0 size = '100 mm', '200 mm' /\n"
#define SPACE_BODY                                                                                 \
  "&body lattice = 'l' shape = 'box' corner = 3*0 size = '50 mm', '50 mm', '100 mm' /\n"

static const double E = 25e9, nu = 0.2;

/* A deck of blue noise; `more` are further groups. */
static bool start(deck_case *c, const char *model_name, const char *setting, int neighbours,
                  const char *more) {
  char text[2048];
  const bool space = strcmp(setting, "space") == 0;
  snprintf(text, sizeof text,
           "&simulation end_time = 1 /\n"
           "&lattice name = 'l' kind = 'blue_noise' spacing = '5 mm' setting = '%s' "
           "neighbours = %d %s /\n"
           "&material lattice = 'l' model = '%s' E = '25 GPa' %s /\n%s%s",
           setting, neighbours, space ? "" : "thickness = '100 mm'", model_name,
           strcmp(model_name, "pmb") == 0 ? "" : "nu = 0.2", space ? SPACE_BODY : PLANE_BODY, more);
  return deck_case_text(c, text);
}

static uniform_response response_of(const deck_case *c) {
  uniform_response u;
  const bool plane_strain = strcmp(c->deck->lattices[0].setting, "plane_strain") == 0;
  assert_true(uniform_strain_response(c->law.law, c->law.parameters, NULL,
                                      simulation_rows(c->simulation, 0), plane_strain, &u));
  return u;
}

static void assert_exact(const char *model_name, const char *setting, int neighbours) {
  deck_case c;
  assert_true(start(&c, model_name, setting, neighbours, ""));
  const uniform_response u = response_of(&c);
  print_message("%-14s %-12s k = %2d: E %+.1e, nu %+.1e, force left %.1f %% of stress times face, "
                "sum of forces %.0e, %ld families unresolved\n",
                model_name, setting, neighbours, u.E / E - 1, u.nu - nu, 100 * u.left_force,
                u.momentum, u.unresolved);
  assert_int_equal(u.unresolved, 0);
  assert_true(fabs(u.E / E - 1) < 1e-8); /* central differences of forces: 1e-16/1e-7 */
  assert_true(fabs(u.nu - nu) < 1e-8);
  assert_true(u.momentum < 1e-13);
  assert_true(u.left_force > 1e-3 && u.left_force < 0.4); /* what irregular means */
  deck_case_close(&c);
}

static void the_stress_of_a_uniform_strain_is_exact(void **state) {
  (void)state;
  static const char *const settings[] = {"plane_stress", "plane_strain"};
  static const int neighbours[] = {6, 12, 18};
  for (size_t s = 0; s < 2; s++)
    for (size_t k = 0; k < 3; k++)
      assert_exact("splm_elastic", settings[s], neighbours[k]);
  assert_exact("splm_concrete", "plane_stress", 12);
  assert_exact("splm_elastic", "space", 18);
  assert_exact("splm_concrete", "space", 18);
}

/* The same from the law's own stress, at every particle: a dilation of the plane, in plane stress.
   */
static void every_family_has_it(void **state) {
  (void)state;
  deck_case c;
  const double strain = 1e-8;
  assert_true(start(&c, "splm_elastic", "plane_stress", 12, ""));
  sweep *w = simulation_state(c.simulation, 0);
  const rows *g = w->body->lattice;
  for (long p = 0; p < g->particle_count; p++) {
    const long q = g->particle_site[p];
    w->body->displacement[0][q] = strain * g->x[q];
    w->body->displacement[1][q] = strain * g->y[q];
  }
  double *sigma_1 = calloc((size_t)g->size, sizeof *sigma_1),
         *sigma_3 = calloc((size_t)g->size, sizeof *sigma_3);
  sweep_observe(w);
  sweep_output(w, 0, sigma_1);
  sweep_output(w, 1, sigma_3);
  for (long p = 0; p < g->particle_count; p++) {
    const long q = g->particle_site[p];
    assert_true(fabs(sigma_1[q] / (E / (1 - nu) * strain) - 1) <
                1e-6);                                 /* 1e-16/1e-8, geometry 1e-8 */
    assert_true(fabs(sigma_3[q]) < 1e-6 * sigma_1[q]); /* through the thickness */
  }
  free(sigma_1);
  free(sigma_3);
  deck_case_close(&c);
}

/* --- a bar ------------------------------------------------------------------------------------ */

/* Slope of the displacements along y in the middle of the bar, by least squares. */
static double strain_of(const sweep *w) {
  const rows *g = w->body->lattice;
  double n = 0, y = 0, u = 0, yy = 0, yu = 0;
  for (long p = 0; p < g->particle_count; p++) {
    const long q = g->particle_site[p];
    if (g->y[q] < 0.05 || g->y[q] > 0.15) continue;
    n++;
    y += g->y[q];
    u += w->body->displacement[1][q];
    yy += g->y[q] * g->y[q];
    yu += g->y[q] * w->body->displacement[1][q];
  }
  return (n * yu - y * u) / (n * yy - y * y);
}

#define ENDS                                                                                       \
  "&relaxation increments = 1 tolerance = 1e-6 /\n"                                                \
  "&region name = 'bottom' shape = 'rectangle' corner = 0, 0 size = '100 mm', '8 mm' /\n"          \
  "&region name = 'top' shape = 'rectangle' corner = 0, '192 mm' size = '100 mm', '8 mm' /\n"      \
  "&support region = 'bottom' fix = 'y' /\n"                                                       \
  "&drive region = 'top' component = 'y' displacement = '20 um' /\n"                               \
  "&monitor name = 'load' kind = 'reaction' between = 'bottom', 'top' component = 'y' /\n"

/* Young's modulus by load and strain: what a user would measure. */
static double measured_modulus(int neighbours) {
  deck_case c;
  assert_true(start(&c, "splm_elastic", "plane_stress", neighbours, ENDS));
  assert_int_equal(deck_case_go(&c), STEP_END);
  const long samples = simulation_history(c.simulation, NULL);
  const double load = deck_case_series(&c, "load")[samples - 1];
  const double modulus = load / (0.1 * 0.1) / strain_of(simulation_state(c.simulation, 0));
  print_message("bar of blue noise, k = %2d: E %+.2f %%\n", neighbours, 100 * (modulus / E - 1));
  deck_case_close(&c);
  return modulus;
}

/* A body that is free to leave the uniform strain is softer than one that is held in it. */
static void a_bar_has_the_modulus_of_the_material(void **state) {
  (void)state;
  static const int neighbours[] = {6, 12, 18};
  double off[3];
  for (int k = 0; k < 3; k++)
    off[k] = 1 - measured_modulus(neighbours[k]) / E;
  for (int k = 0; k < 3; k++)
    assert_true(off[k] > 0 && off[k] < 0.06);
  assert_true(off[1] < 0.05); /* the bound for 12 neighbours */
  assert_true(off[2] < off[1] && off[1] < off[0]);
}

/* --- a perfect lattice as a list -------------------------------------------------------------- */

static void write_sites(const rows *g, const char *path) {
  FILE *out = fopen(path, "w");
  assert_non_null(out);
  fputs("x [m], y [m], volume [m^3]\n", out);
  for (long p = 0; p < g->particle_count; p++)
    fprintf(out, "%.17g, %.17g, %.17g\n", g->x[g->particle_site[p]], g->y[g->particle_site[p]],
            g->volume);
  fclose(out);
}

static double noise(long particle, int component) {
  return 1e-7 * sin(1.7 * (double)particle + 2.9 * component);
}

/* Largest force of a particle after displacements at random; force[component][particle]. */
static double forces_of(sweep *w, double *force[2]) {
  double most = 0;
  for (int d = 0; d < 2; d++)
    for (long p = 0; p < w->body->lattice->particle_count; p++)
      w->body->displacement[d][w->body->lattice->particle_site[p]] = noise(p, d);
  sweep_find_forces(w);
  for (int d = 0; d < 2; d++) {
    force[d] = calloc((size_t)w->body->lattice->particle_count, sizeof *force[d]);
    for (long p = 0; p < w->body->lattice->particle_count; p++) {
      force[d][p] = w->body->force[d][w->body->lattice->particle_site[p]];
      most = fmax(most, fabs(force[d][p]));
    }
  }
  return most;
}

static int neighbours_of(const rows *g, long particle) {
  return rows_degree(g, g->particle_site[particle]);
}

/* Inside, where families are whole, and the families of all neighbours too: more than two spacings
   from the edge. */
static bool is_inside(const rows *g, long particle) {
  const long q = g->particle_site[particle];
  return neighbours_of(g, particle) == 6 && g->x[q] > 0.015 && g->x[q] < 0.085 && g->y[q] > 0.015 &&
         g->y[q] < 0.185;
}

static void on_a_lattice_it_is_the_lattice_s_own(void **state) {
  (void)state;
  deck_case lattice, list;
  char path[] = "/tmp/perilat_sites_XXXXXX.csv", text[1024];
  const int file = mkstemps(path, 4);
  assert_true(file >= 0);
  close(file);
  assert_true(deck_case_text(
      &lattice,
      "&simulation end_time = 1 /\n"
      "&lattice name = 'l' kind = 'hexagonal' spacing = '5 mm' thickness = '100 mm' "
      "rotation = 17 /\n"
      "&material lattice = 'l' model = 'splm_elastic' E = '25 GPa' nu = 0.2 /\n" PLANE_BODY));
  const rows *g = simulation_rows(lattice.simulation, 0);
  write_sites(g, path);
  snprintf(
      text, sizeof text,
      "&simulation end_time = 1 /\n"
      "&lattice name = 'l' kind = 'particles' file = '%s' horizon = 1.1 thickness = '100 mm' /\n"
      "&material lattice = 'l' model = 'splm_elastic' E = '25 GPa' nu = 0.2 /\n",
      path);
  assert_true(deck_case_text(&list, text));
  double *mine[2], *theirs[2];
  const double most = forces_of(simulation_state(lattice.simulation, 0), mine);
  forces_of(simulation_state(list.simulation, 0), theirs);
  long inside = 0;
  for (long p = 0; p < g->particle_count; p++) {
    if (!is_inside(g, p)) continue;
    inside++;
    for (int d = 0; d < 2; d++)
      assert_true(fabs(mine[d][p] - theirs[d][p]) < 1e-9 * most);
  }
  print_message("%ld of %ld particles are inside\n", inside, g->particle_count);
  assert_true(inside > 500);
  for (int d = 0; d < 2; d++) {
    free(mine[d]);
    free(theirs[d]);
  }
  deck_case_close(&lattice);
  deck_case_close(&list);
  unlink(path);
}

/* --- motion ----------------------------------------------------------------------------------- */

static void sum_motion(const sweep *w, double momentum[2], double *spin) {
  momentum[0] = momentum[1] = *spin = 0;
  for (long p = 0; p < w->body->lattice->particle_count; p++) {
    const long q = w->body->lattice->particle_site[p];
    const double m = body_mass(w->body, 0, q),
                 x = w->body->lattice->x[q] + w->body->displacement[0][q],
                 y = w->body->lattice->y[q] + w->body->displacement[1][q];
    momentum[0] += m * w->body->velocity[0][q];
    momentum[1] += m * w->body->velocity[1][q];
    *spin += m * (x * w->body->velocity[1][q] - y * w->body->velocity[0][q]);
  }
}

static double energy_of(sweep *w) {
  sweep_observe(w);
  const body_totals t = body_sum(w->body);
  return t.kinetic + t.stored;
}

/* A free body shaken at random keeps its momentum and its energy: no mode grows. Forces act along
   the present bonds, so that its spin stays, too. */
static void a_free_body_keeps_what_it_has(void **state) {
  (void)state;
  deck_case c;
  double before[2], after[2], spin_before, spin_after, size = 0;
  assert_true(start(&c, "splm_elastic", "plane_stress", 12, ""));
  sweep *w = simulation_state(c.simulation, 0);
  for (long p = 0; p < w->body->lattice->particle_count; p++)
    for (int d = 0; d < 2; d++) {
      const long q = w->body->lattice->particle_site[p];
      w->body->velocity[d][q] = 0.1 + sin(12.9898 * (double)p + 78.233 * d);
      size += body_mass(w->body, d, q) * fabs(w->body->velocity[d][q]);
    }
  sum_motion(w, before, &spin_before);
  const double energy = energy_of(w);
  double largest = energy, smallest = energy;
  for (int k = 0; k < 40; k++) {
    assert_int_equal(simulation_advance(c.simulation, 100, NULL), STEP_OK);
    largest = fmax(largest, energy_of(w));
    smallest = fmin(smallest, energy_of(w));
  }
  sum_motion(w, after, &spin_after);
  print_message("energy within %+.1e and %+.1e, momentum %.0e, spin %.0e in %ld steps\n",
                smallest / energy - 1, largest / energy - 1,
                hypot(after[0] - before[0], after[1] - before[1]) / size,
                fabs(spin_after - spin_before) / (0.1 * size), simulation_step_done(c.simulation));
  assert_true(hypot(after[0] - before[0], after[1] - before[1]) < 1e-10 * size);
  assert_true(fabs(spin_after - spin_before) < 1e-10 * 0.1 * size);
  assert_true(largest < 1.02 * energy && smallest > 0.98 * energy);
  deck_case_close(&c);
}

/* --- peridynamics ----------------------------------------------------------------------------- */

/* By volumes, with a horizon of three spacings: near the material's modulus, as far as sums over
   irregular points are integrals. */
static void peridynamic_solids_come_near(void **state) {
  (void)state;
  static const char *const names[] = {"lps", "pmb"};
  for (int k = 0; k < 2; k++) {
    deck_case c;
    char text[1024];
    snprintf(text, sizeof text,
             "&simulation end_time = 1 /\n&lattice name = 'l' kind = 'blue_noise' spacing = '5 mm' "
             "horizon = 3 thickness = '100 mm' /\n"
             "&material lattice = 'l' model = '%s' E = '25 GPa' /\n" PLANE_BODY,
             names[k]);
    assert_true(deck_case_text(&c, text));
    const uniform_response u = response_of(&c);
    print_message("%s on blue noise, horizon 3: E %+.2f %%, nu %.4f, force left %.1f %%, sum of "
                  "forces %.0e\n",
                  names[k], 100 * (u.E / E - 1), u.nu, 100 * u.left_force, u.momentum);
    assert_true(fabs(u.E / E - 1) < 0.08);
    assert_true(fabs(u.nu - (k ? 1.0 / 3 : 0.2)) < 0.02);
    assert_true(u.momentum < 1e-13);
    deck_case_close(&c);
  }
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(the_stress_of_a_uniform_strain_is_exact),
      cmocka_unit_test(every_family_has_it),
      cmocka_unit_test(a_bar_has_the_modulus_of_the_material),
      cmocka_unit_test(on_a_lattice_it_is_the_lattice_s_own),
      cmocka_unit_test(a_free_body_keeps_what_it_has),
      cmocka_unit_test(peridynamic_solids_come_near),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
