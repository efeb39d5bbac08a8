/* The law mplm_concrete through decks and the program: one bond between two particles pulled apart,
   pushed together, rubbed. Work of fracture, strength, crushing and friction against the closed
   forms of Gerstle et al. (2013) for all choices of each option; friction dissipates on any path.
   In space: the curvature of ends that turn about different axes, the cost of a crack. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "runtime/result/result_fields.h"
#include "runtime/result/result_file.h"
#include "runtime/result/result_read.h"

static const double E = 24.86e9, nu = 0.2, rho = 2323, eps_t = 1.26e-4, thickness = 0.127; /* SI */

/* Both particles may only move along the row, so that the bond neither turns nor bends. */
static const char pair[] =
    "&simulation end_time = %.17g threads = 1 /\n"
    "&lattice name = 'c' kind = 'hexagonal' spacing = %.17g thickness = '127 mm' /\n"
    "&material lattice = 'c' model = 'mplm_concrete' %s /\n"
    "&body lattice = 'c' shape = 'point' at = 0, 0 /\n"
    "&body lattice = 'c' shape = 'point' at = %.17g, 0 /\n"
    "&region name = 'left' shape = 'point' at = 0, 0 /\n"
    "&region name = 'right' shape = 'point' at = %.17g, 0 /\n"
    "&support region = 'left' fix = 'x', 'y', 'rotation' /\n"
    "&support region = 'right' fix = 'y', 'rotation' /\n"
    "&drive region = 'right' component = 'x' velocity = %.17g rise = '1 ms' /\n"
    "&monitor name = 'load' kind = 'reaction' region = 'right' component = 'x' /\n"
    "&output result = 'mplm_concrete.h5' frames = 2 sample = '0.02 ms' fields = 'displacement', "
    "'omega_t', 'omega_c', 'loss' /\n";

static void program(const char *arguments) {
  char command[1024];
  snprintf(command, sizeof command,
           "PERILAT_MODELS='%s/models' '%s' %s mplm_concrete.nml > mplm_concrete.log 2>&1",
           SOURCE_DIR, PERILAT_PROGRAM, arguments);
  if (system(command) != 0) fail_msg("%s\nfailed: see mplm_concrete.log", command);
}

static FILE *deck(void) {
  FILE *out = fopen("mplm_concrete.nml", "w");
  assert_non_null(out);
  return out;
}

static void run(const char *settings, double spacing, double velocity, double end) {
  FILE *out = deck();
  fprintf(out, pair, end, spacing, settings, spacing, spacing, velocity);
  assert_int_equal(fclose(out), 0);
  program("run");
}

static double *series(result_file *f, const char *name, long *count) {
  char error[256], unit[32];
  double *values = result_read_series(f, name, count, unit, sizeof unit, error, sizeof error);
  if (!values) fail_msg("%s", error);
  return values;
}

static double last(result_file *f, const char *name) {
  long count;
  double *values = series(f, name, &count), value = values[count - 1];
  free(values);
  return value;
}

static double last_frame(result_file *f, const char *name) {
  char error[256], unit[32];
  long count;
  int components;
  double *values =
      result_read_frame(f, name, -1, &count, &components, unit, sizeof unit, error, sizeof error);
  if (!values) fail_msg("%s", error);
  const double value = values[0];
  free(values);
  return value;
}

static result_file *open_result(void) {
  char error[256];
  result_file *f = result_read("mplm_concrete.h5", error, sizeof error);
  if (!f) fail_msg("%s", error);
  return f;
}

static void clean_up(result_file *f) {
  result_read_close(f);
  unlink("mplm_concrete.nml");
  unlink("mplm_concrete.log");
  unlink("mplm_concrete.h5");
  unlink("mplm_concrete.xdmf");
}

static double axial_rigidity(double spacing) {
  return E * spacing * thickness / (sqrt(3) * (1 - nu));
}

/* Force of the damper, N, at a steady velocity: 2 zeta m omega_n v; omega_n = 2 sqrt(2/(1-nu)) c/s
   above nu = 0.1765. */
static double damper(double spacing, double velocity) {
  const double mass = rho * sqrt(3) / 2 * spacing * spacing * thickness;
  return 2 * 0.05 * mass * sqrt(E / rho) / spacing * 2 * sqrt(2 / (1 - nu)) * velocity;
}

/* The triangle under the force: half EA eps_t^2 s alpha. In the end nothing but what is `left` of
   the damper holds. */
static void tears(const char *settings, double spacing, double alpha, double per_area,
                  double left) {
  const double velocity = 1e-3,
               bond = 0.5 * axial_rigidity(spacing) * eps_t * eps_t * spacing * alpha;
  run(settings, spacing, velocity, 1.1 * alpha * eps_t * spacing / velocity + 1e-3);
  result_file *f = open_result();
  long count;
  double *load = series(f, "load", &count), strength = 0;
  for (long k = 0; k < count; k++)
    strength = fmax(strength, load[k]);
  const double expected = axial_rigidity(spacing) * eps_t + damper(spacing, velocity);
  const double lost = last(f, "energy/dissipated_damage");
  const double area = sqrt(3) / 2 * spacing * thickness; /* of a row bond in a crack across rows */
  print_message("%s s = %g mm: %.5g N/m, %.6f of theory; strength %.6f of theory\n", settings,
                1e3 * spacing, lost / area, lost / bond, strength / expected);
  assert_true(fabs(lost / bond - 1) < 3e-4); /* the damage of a step comes all at its end */
  assert_true(fabs(lost / area / per_area - 1) < 2e-3);
  /* a sample every 0.02 ms stands within 1 % of the stretch of the peak */
  assert_true(strength / expected < 1 + 1e-6 && strength / expected > 0.99);
  assert_true(last_frame(f, "c/omega_t") == 1 && last_frame(f, "c/omega_c") == 0);
  assert_true(fabs(load[count - 1] - left * damper(spacing, velocity)) < 1e-6 * expected);
  free(load);
  clean_up(f);
}

/* Stretch ratio at separation for a crack energy (N/m), counting the row bonds of a crack across
   the rows. */
static double ratio_for(double G_F, double spacing) {
  return 3 * (1 - nu) * G_F / (E * spacing * eps_t * eps_t);
}

static void tension_costs_what_the_law_says(void **state) {
  (void)state;
  tears("", 20e-3, 10, 32.9, 0);
  tears("damper = 'lasting'", 20e-3, 10, 32.9, 1);
  tears("tension = 'energy'", 20e-3, ratio_for(175, 20e-3), 175, 0);
  tears("tension = 'energy'", 10e-3, ratio_for(175, 10e-3), 175, 0);
  assert_true(fabs(ratio_for(175, 20e-3) - 53.2) < 0.05);
}

/* In the plane and in space: what has parted goes its way. */
static void a_damper_goes_with_its_bond(void **state) {
  (void)state;
  static const char *const laws[] = {"mplm_concrete", "mplm_concrete_space"};
  for (int k = 0; k < 2; k++) {
    FILE *out = deck();
    fprintf(out,
            "&simulation steps = 100 /\n&bond spacing = '20 mm' thickness = '20 mm' /\n"
            "&material model = '%s' /\n"
            "&path quantity = 'stretch' value = 0.01 rise = '1 s' /\n"
            "&expect quantity = 'omega_t' value = 1 absolute = 1e-15 /\n"
            "&expect quantity = 'N' value = 0 absolute = '1e-12 N' /\n",
            laws[k]);
    assert_int_equal(fclose(out), 0);
    program("drive");
  }
  unlink("mplm_concrete.nml");
  unlink("mplm_concrete.log");
}

/* Pushed together to a strain of -0.002: the axial force is that of an intact bond. */
static void crushes(const char *settings, double loss) {
  const double spacing = 20e-3, velocity = -1e-3, end = 0.002 * spacing / 1e-3 + 0.5e-3;
  run(settings, spacing, velocity, end);
  result_file *f = open_result();
  const double load = last(f, "load");
  const double expected = -0.002 * axial_rigidity(spacing) + damper(spacing, velocity);
  print_message("crushing %s: loss %.6f, force %.6f of theory\n", settings,
                last_frame(f, "c/omega_c"), load / expected);
  assert_true(fabs(load / expected - 1) < 1e-4); /* the last step may pass the end by its length */
  assert_true(fabs(last_frame(f, "c/omega_c") - loss) < 1e-4);
  assert_true(last_frame(f, "c/omega_t") == 0);
  assert_true(last_frame(f, "c/loss") == last_frame(f, "c/omega_c"));
  clean_up(f);
}

static void crushing_keeps_the_axial_force(void **state) {
  (void)state;
  crushes("", 1 / 4.728);
  crushes("crushing = 'text' eps_u = -0.0015", 1); /* it has not parted */
  crushes("crushing = 'text'", 0.5);
  crushes("crushing = 'text' fading = 'force'", 3 / 2.0 * 0.5);
}

/* --- friction --------------------------------------------------------------------------------- */

/* A bond is crushed, let out to a strain of -0.001, and its right end moved up: what holds it down
   is friction. Nothing is free, so that the run follows the path. */
static const char rubbed[] =
    "&simulation end_time = '3.1 ms' threads = 1 step_safety = %g /\n"
    "&lattice name = 'c' kind = 'hexagonal' spacing = '20 mm' thickness = '127 mm' /\n"
    "&material lattice = 'c' model = 'mplm_concrete' friction = '%s' mu = 0.4 zeta = 0 /\n"
    "&body lattice = 'c' shape = 'point' at = 0, 0 /\n"
    "&body lattice = 'c' shape = 'point' at = '20 mm', 0 /\n"
    "&region name = 'left' shape = 'point' at = 0, 0 /\n"
    "&region name = 'right' shape = 'point' at = '20 mm', 0 /\n"
    "&support region = 'left' fix = 'x', 'y', 'rotation' /\n"
    "&support region = 'right' fix = 'rotation' /\n"
    "&drive region = 'right' component = 'x' displacement = '-0.02 mm' times = 0, '1 ms', '2 ms' "
    "values = 0, 6, 1 /\n"
    "&drive region = 'right' component = 'y' displacement = '0.2 mm' times = 0, '2 ms', '3 ms' "
    "values = 0, 0, 1 /\n"
    "&monitor name = 'up' kind = 'reaction' region = 'right' component = 'y' /\n"
    "&monitor name = 'turn' kind = 'reaction' region = 'right' component = 'rotation' /\n"
    "&output result = 'mplm_concrete.h5' frames = 1 sample = '0.01 ms' fields = 'slip' /\n";

static double rub(const char *friction, double mu, double safety) {
  FILE *out = deck();
  fprintf(out, rubbed, safety, friction);
  assert_int_equal(fclose(out), 0);
  program("run");
  result_file *f = open_result();
  const double s = 20e-3, x = s - 0.02e-3, y = 0.2e-3, length = hypot(x, y), chord = atan2(y, x);
  const double EI = E * s * s * s * thickness * (1 - 3 * nu) / (12 * sqrt(3) * (1 - nu * nu));
  const double N = axial_rigidity(s) * (length - s) / s, V = mu * fabs(N), stuck = V * length / 2;
  const double up = N * y / length + V * x / length, slip = chord - stuck * s / (6 * EI);
  /* The bond is stretched by the square of its turn, so that N falls by 5 %: by a third of that in
     the mean over the way. */
  const double start = axial_rigidity(s) * (x - s) / s, mean = start + (N - start) / 3;
  const double lost = mu * fabs(mean) * length * slip;
  print_message("%s: %.6g N up, %.6g by theory; lost %.6g J, %.6g by theory\n", friction,
                last(f, "up"), up, last(f, "energy/dissipated_damage"), lost);
  assert_true(fabs(last(f, "up") - up) < 1e-4 * fabs(N));
  assert_true(fabs(fabs(last(f, "turn")) - stuck) < 1e-4 * fabs(N) * s);
  if (mu > 0) assert_true(fabs(fabs(last_frame(f, "c/slip")) - slip) < 1e-4 * slip);
  assert_true(fabs(last(f, "energy/dissipated_damage") - lost) <= 5e-3 * lost);
  const double imbalance = last(f, "energy/imbalance") / last(f, "energy/external");
  clean_up(f);
  return fabs(imbalance);
}

static void a_failed_bond_rubs(void **state) {
  (void)state;
  assert_true(rub("none", 0, 0.25) < 1e-6);
  /* What slips in a step is lost at its end: the ledger's error is one of the step. */
  const double coarse = rub("stick_slip", 0.4, 0.2), fine = rub("stick_slip", 0.4, 0.1);
  assert_true(coarse < 5e-3 && fabs(coarse / fine - 2) < 0.1);
}

static double uniform(unsigned *seed) {
  *seed = *seed * 1664525u + 1013904223u;
  return (double)(*seed >> 8) / (1 << 24);
}

/* Corners at whole seconds, each anywhere within `size` around `middle`. */
static void wander(FILE *out, const char *quantity, double middle, double size, unsigned *seed) {
  enum { CORNERS = 30 };
  fprintf(out, "&path quantity = '%s' times = 0", quantity);
  for (int k = 1; k <= CORNERS; k++)
    fprintf(out, ", %d", k);
  fprintf(out, " values = 0");
  for (int k = 1; k <= CORNERS; k++)
    fprintf(out, ", %.9g", middle + size * (2 * uniform(seed) - 1));
  fprintf(out, " /\n");
}

/* Any path of stretch and rotations, through crushing, tearing, sticking, slipping and opening:
   what is lost never comes back. */
static void friction_takes_energy_on_any_path(void **state) {
  (void)state;
  for (unsigned seed = 1; seed <= 6; seed++) {
    unsigned drawn = seed;
    FILE *out = deck();
    fprintf(out, "&simulation steps = 24000 /\n&bond spacing = '20 mm' thickness = '127 mm' /\n"
                 "&material model = 'mplm_concrete' friction = 'stick_slip' crushing = 'text' "
                 "zeta = 0 /\n&output hdf5 = 'mplm_concrete.h5' /\n");
    wander(out, "stretch", -2e-3, 2.5e-3, &drawn);
    wander(out, "theta_i", 0, 0.01, &drawn);
    wander(out, "theta_j", 0, 0.01, &drawn);
    assert_int_equal(fclose(out), 0);
    program("drive");
    result_file *f = open_result();
    long count;
    double *lost = series(f, "dissipated", &count), most = 0, back = 0;
    for (long k = 0; k < count; k++) {
      most = fmax(most, lost[k]);
      back = fmax(back, most - lost[k]);
    }
    assert_true(most > 1 && last(f, "loss") == 1);
    if (!(back < 1e-6 * most)) fail_msg("path %u: %g of %g J came back", seed, back, most);
    free(lost);
    clean_up(f);
  }
}

/* --- in space --------------------------------------------------------------------------------- */

/* A bond along (1, 1, 0) whose ends turn by small angles. */
static const char turned[] =
    "&simulation end_time = '0.1 ms' threads = 1 /\n"
    "&lattice name = 'c' kind = 'fcc' shells = 2 spacing = '20 mm' /\n"
    "&material lattice = 'c' model = 'mplm_concrete_space' zeta = 0 /\n"
    "&body lattice = 'c' shape = 'point' at = 0, 0, 0 /\n"
    "&body lattice = 'c' shape = 'point' at = 0.0141421356, 0.0141421356, 0 /\n"
    "&region name = 'i' shape = 'point' at = 0, 0, 0 /\n"
    "&region name = 'j' shape = 'point' at = 0.0141421356, 0.0141421356, 0 /\n"
    "&support region = 'i' fix = 'xyz' /\n&support region = 'j' fix = 'xyz' /\n"
    "&output result = 'mplm_concrete.h5' frames = 1 fields = 'curvature' /\n";

/* Eqs 5 to 9, about all pairs of axes across the bond: about each the larger end, then the root of
   the sum of squares. The largest over the pairs. */
static double largest_curvature(const double a[2], const double b[2], double twist) {
  double most = 0;
  for (int k = 0; k < 20000; k++) {
    const double turn = 1.5707963267948966 * k / 20000, c = cos(turn), s = sin(turn);
    const double y = fmax(fabs(c * a[0] + s * a[1]), fabs(c * b[0] + s * b[1])),
                 z = fmax(fabs(c * a[1] - s * a[0]), fabs(c * b[1] - s * b[0]));
    most = fmax(most, y * y + z * z);
  }
  return sqrt(most + twist * twist);
}

static void curvatures_in_space_are_the_larger_ends(void **state) {
  (void)state;
  unsigned seed = 7;
  for (int n = 0; n < 6; n++) {
    const double s = 20e-3,
                 across[2][3] = {{-0.70710678118654757, 0.70710678118654757, 0}, {0, 0, 1}},
                 along[3] = {0.70710678118654757, 0.70710678118654757, 0};
    double angle[2][3], local[2][2], twist[2]; /* of the ends i, j */
    FILE *out = deck();
    fputs(turned, out);
    for (int e = 0; e < 2; e++) {
      for (int k = 0; k < 3; k++) {
        angle[e][k] = n == 0 && e == 1 ? 0 : 1e-7 * (2 * uniform(&seed) - 1);
        fprintf(out,
                "&drive region = '%s' component = 'rotation_%c' displacement = %.17g rise = "
                "5e-5 /\n",
                e ? "j" : "i", "xyz"[k], angle[e][k]);
      }
      twist[e] = angle[e][0] * along[0] + angle[e][1] * along[1];
      for (int k = 0; k < 2; k++)
        local[e][k] =
            angle[e][0] * across[k][0] + angle[e][1] * across[k][1] + angle[e][2] * across[k][2];
    }
    assert_int_equal(fclose(out), 0);
    program("run");
    double a[2], b[2];
    for (int k = 0; k < 2; k++) {
      a[k] = 2 / s * (2 * local[0][k] + local[1][k]);
      b[k] = 2 / s * (2 * local[1][k] + local[0][k]);
    }
    const double expected = largest_curvature(a, b, (twist[1] - twist[0]) / s);
    result_file *f = open_result();
    const double got = last_frame(f, "c/curvature");
    print_message("curvature %.9g, %.9g by axes\n", got, expected);
    assert_true(fabs(got / expected - 1) < 1e-7);
    clean_up(f);
  }
}

/* Half a crystal lifted off the other along a cube face, without bending: four first neighbours on
   each spacing squared cost G_F/5 each, and two second ones half as much. */
static const char lifted[] =
    "&simulation end_time = '4.5 ms' step_safety = 0.7 /\n"
    "&lattice name = 'c' kind = 'fcc' shells = 2 spacing = '20 mm' /\n"
    "&material lattice = 'c' model = 'mplm_concrete_space' tension = 'energy' %s nu = 0.25 beta = "
    "0 "
    "zeta = 0 /\n"
    "&body lattice = 'c' shape = 'box' corner = '-29 mm', '-29 mm', '-30 mm' size = '58 mm', '58 "
    "mm', '73 mm' /\n"
    "&region name = 'low' shape = 'box' corner = '-1 m', '-1 m', '-1 m' size = '2 m', '2 m', "
    "'1.001 m' /\n"
    "&region name = 'top' shape = 'box' corner = '-1 m', '-1 m', '2 mm' size = '2 m', '2 m', '1 m' "
    "/\n"
    "&support region = 'low' fix = 'xyz', 'rotation' /\n"
    "&support region = 'top' fix = 'x', 'y', 'rotation' /\n"
    "&drive region = 'top' component = 'z' velocity = '20 mm/s' rise = '1 ms' /\n"
    "&output result = 'mplm_concrete.h5' frames = 1 sample = '0.05 ms' fields = 'displacement', "
    "'damage', 'omega_t' /\n";

/* The bonds between both halves, by shells, J: all that cross z = 7 mm. */
static double cost_of_crossing(result_file *f, double s) {
  long particles, bonds;
  int dimensions;
  double cost = 0, *at = result_read_reference(f, &particles, &dimensions);
  int32_t *ends = result_read_bonds(f, "c", &bonds);
  assert_true(at && ends && dimensions == 3);
  for (long b = 0; b < bonds; b++) {
    const double *i = at + 3 * ends[2 * b], *j = at + 3 * ends[2 * b + 1];
    const double length = sqrt((i[0] - j[0]) * (i[0] - j[0]) + (i[1] - j[1]) * (i[1] - j[1]) +
                               (i[2] - j[2]) * (i[2] - j[2]));
    if ((i[2] > 7e-3) != (j[2] > 7e-3)) cost += 175 * s * s / (length < 1.2 * s ? 5 : 10);
  }
  free(at);
  free(ends);
  return cost;
}

static void a_crack_along_a_cube_face_costs_G_F(void **state) {
  (void)state;
  static const char *const shapes[] = {"softening = 'force'", "softening = 'strain'"};
  for (int k = 0; k < 2; k++) {
    FILE *out = deck();
    fprintf(out, lifted, shapes[k]);
    assert_int_equal(fclose(out), 0);
    program("run");
    result_file *f = open_result();
    const double ratio = last(f, "energy/dissipated_damage") / cost_of_crossing(f, 20e-3);
    print_message("%s: a cube face costs %.5f of G_F\n", shapes[k], ratio);
    assert_true(fabs(ratio - 1) < 2e-3);
    clean_up(f);
  }
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(tension_costs_what_the_law_says),
      cmocka_unit_test(a_damper_goes_with_its_bond),
      cmocka_unit_test(crushing_keeps_the_axial_force),
      cmocka_unit_test(a_failed_bond_rubs),
      cmocka_unit_test(friction_takes_energy_on_any_path),
      cmocka_unit_test(curvatures_in_space_are_the_larger_ends),
      cmocka_unit_test(a_crack_along_a_cube_face_costs_G_F),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
