/* A compiled law with a state, a damage and a rate term on a mesh: the same bits for any number of
   threads, by the interpreter, resumed and from a solver; its fields at nodes; what is said of a
   step that its stiffening leaves behind. */
#define _GNU_SOURCE
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include <math.h>

#include "tests/generator/command_tools.h"

/* Soft at first: it stiffens, and breaks. */
static const char law_text[] =
    "model ageing\n"
    "  law continuum\n"
    "  for plane_stress\n"
    "  parameter E = 2 [GPa]  in (0, inf)\n"
    "  parameter nu = 0.2  in [0, 0.5)\n"
    "  parameter rho = 1000 [kg/m^3]  in (0, inf)\n"
    "  parameter tau = 0.2 [us]  in [0, inf)\n"
    "  state peak on point = 0  \"largest strain so far\"\n"
    "  damage omega on point\n"
    "  peak = max(previous(peak), norm(strain))\n"
    "  omega = 1 - exp(-peak/0.01)\n"
    "  stress sigma = (1 - omega)*hooke(strain, E, nu) + hooke(tau*strain_rate, E, nu)\n"
    "  output biggest = principal(sigma, 1)\n"
    "end model\n";

static const char deck_text[] =
    "&simulation  end_time = '0.2 ms'  /\n"
    "&mesh      name = 'bar'  size = '100 mm', '20 mm'  nodes = 31, 7  thickness = '20 mm'\n"
    "           method = 'element_free'  support = 2.1 /\n"
    "&zone      mesh = 'bar'  method = 'finite_elements'  shape = 'rectangle'  corner = 0, 0\n"
    "           size = '10 mm', '20 mm' /\n"
    "&zone      mesh = 'bar'  method = 'finite_elements'  shape = 'rectangle'\n"
    "           corner = '90 mm', 0  size = '10 mm', '20 mm' /\n"
    "&material  mesh = 'bar'  model = './ageing.plm' /\n"
    "&region    name = 'left'  shape = 'segment'  from = 0, 0  to = 0, '20 mm' /\n"
    "&region    name = 'right'  shape = 'segment'  from = '100 mm', 0  to = '100 mm', '20 mm' /\n"
    "&support   region = 'left'  fix = 'x' /\n"
    "&drive     region = 'right'  component = 'x'  velocity = '5 m/s'  rise = '50 us' /\n"
    "&monitor   name = 'load'  kind = 'reaction'  region = 'right'  component = 'x' /\n"
    "&monitor   name = 'broken'  kind = 'damaged'  above = 0.5 /\n"
    "&output    result = 'one.h5'  frames = 3  sample = '3 us'\n"
    "           fields = 'displacement', 'damage', 'peak', 'biggest', 'dissipated' /\n";

static void write_bar(const workplace *w) {
  write_text(w, "ageing.plm", law_text);
  write_text(w, "bar.nml", deck_text);
}

static void same_bits(void **state) {
  workplace *w = *state;
  write_bar(w);
  expect(w, "run bar.nml --threads 1", 0, "one.h5");
  expect(w, "run bar.nml --threads 2 --set output.result=other.h5", 0, "other.h5");
  expect_same_results(w, "one.h5", "other.h5");
  expect(w, "run bar.nml --threads 3 --set output.result=other.h5", 0, "other.h5");
  expect_same_results(w, "one.h5", "other.h5");
  expect(w, "run bar.nml --interpret --set output.result=other.h5", 0, "other.h5");
  expect_same_results(w, "one.h5", "other.h5");
  expect(w, "run bar.nml --check-kernel --set output.result=other.h5", 0, "the same bits");
#if !defined(__SANITIZE_ADDRESS__) /* a solver's libraries need the sanitizer's */
  expect(w, "build bar.nml -o bar", 0, "written");
  assert_int_equal(shell(w, "./bar --set output.result=other.h5"), 0);
  expect_same_results(w, "one.h5", "other.h5");
#endif
}

/* Rows of whole rectangles, which a kernel takes from nodes to nodes in one loop, a group that is
   not full, and a hole and another material in the rows. */
static void write_rectangles(const workplace *w, const char *energy) {
  static const char law[] =
      "model fading\n"
      "  law continuum\n"
      "  for plane_strain\n"
      "  parameter E = 2 [GPa]  in (0, inf)\n"
      "  parameter nu = 0.3  in [0, 0.5)\n"
      "  parameter rho = 1000 [kg/m^3]  in (0, inf)\n"
      "  parameter tau = 0.2 [us]  in [0, inf)\n"
      "  state k on point = 0\n"
      "  state e on point = deviator 0\n"
      "  damage D on point\n"
      "  k = max(previous(k), norm(strain))\n"
      "  e = previous(e) + 0.001*(dev(strain) - previous(e))\n"
      "  D = 1 - exp(-k/0.05)\n"
      "  stress sigma = (1 - D)*hooke(strain - e, E, nu) + hooke(tau*strain_rate, E, nu)\n"
      "  energy W = (1 - D)*(hooke(strain - e, E, nu):(strain - e))/2\n"
      "end model\n";
  static const char deck[] =
      "&simulation end_time = '20 us' /\n"
      "&mesh name = 'm' size = '100 mm', '5 mm' nodes = 101, 6 thickness = '10 mm'\n"
      "      method = 'finite_elements' setting = 'plane_strain' /\n"
      "&notch mesh = 'm' shape = 'disc' centre = '60.3 mm', '2.4 mm' radius = '1.4 mm' /\n"
      "&region name = 'part' shape = 'rectangle' corner = '8.01 mm', '-1 mm'\n"
      "        size = '7.98 mm', '7 mm' /\n"
      "&region name = 'left' shape = 'segment' from = 0, 0 to = 0, '5 mm' /\n"
      "&region name = 'right' shape = 'segment' from = '100 mm', 0 to = '100 mm', '5 mm' /\n"
      "&material mesh = 'm' model = './fading.plm' /\n"
      "&material mesh = 'm' model = './fading.plm' region = 'part' E = '1 GPa' /\n"
      "&drive region = 'right' component = 'x' velocity = '20 m/s' rise = '5 us' /\n"
      "&drive region = 'left' component = 'y' velocity = '20 m/s' rise = '5 us' /\n"
      "&output result = 'one.h5' frames = 2 sample = '20 us' energy = %s\n"
      "        fields = 'displacement', 'D', 'k', 'e_xx' /\n";
  char text[4000];
  snprintf(text, sizeof text, deck, energy);
  write_text(w, "fading.plm", law);
  write_text(w, "m.nml", text);
}

static void same_end(result_file *const file[2], const char *field) {
  double *values[2], most = 0;
  char text[64], error[1000];
  long count[2];
  int components;
  for (int k = 0; k < 2; k++) {
    values[k] = result_read_frame(file[k], field, 1, &count[k], &components, text, sizeof text,
                                  error, sizeof error);
    assert_non_null(values[k]);
  }
  assert_int_equal(count[0], count[1]);
  assert_memory_equal(values[0], values[1], (size_t)count[0] * (size_t)components * sizeof(double));
  for (long n = 0; n < count[0] * components; n++)
    if (fabs(values[0][n]) > most) most = fabs(values[0][n]);
  assert_true(most > 0);
  free(values[0]);
  free(values[1]);
}

static void expect_same_end(workplace *w, const char *options, bool energies) {
  static const char *const fields[] = {"displacement", "D", "k", "e_xx"};
  char line[200];
  snprintf(line, sizeof line, "run m.nml --set output.result=other.h5 %s", options);
  expect(w, line, 0, "other.h5");
  result_file *file[] = {open_result_of(w, "one.h5"), open_result_of(w, "other.h5")};
  for (int f = 0; f < 4; f++)
    same_end(file, fields[f]);
  if (energies) same_series(file[0], file[1], "energy/imbalance");
  result_read_close(file[0]);
  result_read_close(file[1]);
}

/* Whoever finds forces of them, and however often they are looked at. */
static void rectangles_give_the_same_bits(void **state) {
  workplace *w = *state;
  for (int energies = 0; energies < 2; energies++) {
    write_rectangles(w, energies ? ".true." : ".false.");
    expect(w, "run m.nml --threads 1", 0, "one.h5");
    expect_same_end(w, "--threads 2", energies);
    expect_same_end(w, "--interpret", energies);
    expect_same_end(w, "--set output.sample='1 us'", false);
  }
}

/* Nodes between broken points are broken; what all have lost is the ledger's. */
/* Two laws side by side, of which both have the field, or the first alone. */
static void write_block(const workplace *w, const char *second, const char *fields) {
  static const char block[] =
      "&simulation end_time = 1 /\n"
      "&relaxation increments = 2 /\n"
      "&mesh name = 'm' size = '40 mm', '20 mm' nodes = 17, 9 thickness = '10 mm'\n"
      "      method = 'finite_elements' dilatation = 'mean' setting = 'plane_strain' /\n"
      "&region name = 'half' shape = 'rectangle' corner = '20 mm', 0 size = '20 mm', '20 mm' /\n"
      "&region name = 'all' shape = 'rectangle' corner = 0, 0 size = '40 mm', '20 mm' /\n"
      "&region name = 'b' shape = 'segment' from = 0, 0 to = '40 mm', 0 /\n"
      "&region name = 'p' shape = 'segment' from = 0, '20 mm' to = '30 mm', '20 mm' /\n"
      "&material mesh = 'm' model = 'von_mises' H = '2 GPa' /\n"
      "&material mesh = 'm' region = 'half' model = %s /\n"
      "&support region = 'b' fix = 'xy' /\n"
      "&drive region = 'p' component = 'y' displacement = '-0.1 mm' /\n"
      "&monitor name = 'state' kind = 'field' field = 'eps_bar' region = 'all' /\n"
      "&monitor name = 'output' kind = 'field' field = 'mises' region = 'all' /\n"
      "&monitor name = 'sigma' kind = 'stress' component = 'yy' region = 'all' /\n"
      "&monitor name = 'epsilon' kind = 'strain' component = 'xy' region = 'all' /\n"
      "&output result = 'block.h5' fields = %s /\n";
  char text[4000];
  snprintf(text, sizeof text, block, second, fields);
  write_text(w, "block.nml", text);
}

/* The mean of a frame's field over the nodes that have it. */
static double mean_of_frame(result_file *f, const char *field) {
  long count, there = 0;
  int components;
  char text[64], error[1000];
  double sum = 0, *values = result_read_frame(f, field, 2, &count, &components, text, sizeof text,
                                              error, sizeof error);
  assert_non_null(values);
  for (long p = 0; p < count; p++) {
    if (isnan(values[p])) continue;
    sum += values[p];
    there++;
  }
  free(values);
  return sum / (double)there;
}

static void monitors_tell(void **state) {
  static const struct {
    const char *monitor, *field;
  } same[] = {
      {"state", "eps_bar"}, {"output", "mises"}, {"sigma", "stress_yy"}, {"epsilon", "strain_xy"}};
  static const char *const second[] = {"'von_mises' f_y = '300 MPa' H = 0", "'elastic'"};
  workplace *w = *state;
  char text[64], error[1000];
  for (int k = 0; k < 2; k++) {
    write_block(w, second[k], "'eps_bar', 'mises', 'stress', 'strain'");
    expect(w, "run block.nml --interpret", 0, "largest");
    result_file *f = open_result_of(w, "block.h5");
    for (int n = 0; n < 4; n++) {
      long samples;
      double *values =
          result_read_series(f, same[n].monitor, &samples, text, sizeof text, error, sizeof error);
      const double mean = mean_of_frame(f, same[n].field);
      assert_non_null(values);
      if (!(fabs(values[samples - 1] - mean) < 1e-12 * fabs(mean)))
        print_message("%s: %.15g, not %.15g\n", same[n].monitor, values[samples - 1], mean);
      assert_true(fabs(mean) > 0 && fabs(values[samples - 1] - mean) < 1e-12 * fabs(mean));
      free(values);
    }
    result_read_close(f);
  }
  /* two large increments: the body swings, and the work is damped */
  expect(w, "run block.nml --interpret", 0, "relaxation.increments=4");
  expect(w, "run block.nml --set monitor[state].field=eps_bat", 1, "has no `eps_bat` at points");
}

static void nodes_tell(void **state) {
  workplace *w = *state;
  double sum = 0, most = 0;
  char text[64], error[1000];
  long count, samples;
  int components;
  write_bar(w);
  expect(w, "run bar.nml", 0, "broken");
  result_file *f = open_result_of(w, "one.h5");
  double *lost = result_read_frame(f, "dissipated", 3, &count, &components, text, sizeof text,
                                   error, sizeof error),
         *peak = result_read_frame(f, "peak", 3, &count, &components, text, sizeof text, error,
                                   sizeof error),
         *damage = result_read_frame(f, "damage", 3, &count, &components, text, sizeof text, error,
                                     sizeof error);
  assert_int_equal(count, 31 * 7);
  for (long p = 0; p < count; p++) {
    sum += lost[p];
    most = peak[p] > most ? peak[p] : most;
    /* 1 - exp is bent, so that the mean of omega lies below that of the mean */
    assert_true(damage[p] <= 1 - exp(-peak[p] / 0.01) + 1e-12);
  }
  assert_true(most > 0.005);
  double taken = 0;
  static const char *const parts[] = {"energy/dissipated_damage", "energy/dissipated_damping"};
  for (int k = 0; k < 2; k++) {
    double *values =
        result_read_series(f, parts[k], &samples, text, sizeof text, error, sizeof error);
    taken += values[samples - 1];
    assert_true(values[samples - 1] > 0);
    free(values);
  }
  if (!(fabs(sum - taken) < 1e-9 * taken)) print_message("%.12g of %.12g\n", sum, taken);
  assert_true(fabs(sum - taken) < 1e-9 * taken);
  free(lost);
  free(peak);
  free(damage);
  result_read_close(f);
}

/* The largest imbalance of a bar that is struck, by the external work. */
static double imbalance_of(workplace *w, const char *law, const char *safety) {
  char text[3000], error[1000], unit[64];
  long samples;
  double most = 0, work = 0;
  snprintf(text, sizeof text,
           "&simulation  end_time = '60 us'  step_safety = %s /\n"
           "&mesh      name = 'bar'  size = '100 mm', '20 mm'  nodes = 21, 5  thickness = '20 mm'\n"
           "           method = 'finite_elements' /\n"
           "&material  mesh = 'bar'  model = './%s' /\n"
           "&region    name = 'left'  shape = 'segment'  from = 0, 0  to = 0, '20 mm' /\n"
           "&region    name = 'right'  shape = 'segment'  from = '100 mm', 0  to = '100 mm', "
           "'20 mm' /\n"
           "&support   region = 'left'  fix = 'x' /\n"
           "&drive     region = 'right'  component = 'x'  velocity = '30 m/s'  rise = '10 us' /\n"
           "&output    result = 'struck.h5'  frames = 1  sample = '3 us' /\n",
           safety, law);
  write_text(w, "struck.nml", text);
  expect(w, "run struck.nml", 0, "written");
  result_file *f = open_result_of(w, "struck.h5");
  double *left = result_read_series(f, "energy/imbalance", &samples, unit, sizeof unit, error,
                                    sizeof error),
         *done = result_read_series(f, "energy/external", &samples, unit, sizeof unit, error,
                                    sizeof error),
         *lost = result_read_series(f, "energy/dissipated_damage", &samples, unit, sizeof unit,
                                    error, sizeof error);
  for (long k = 0; k < samples; k++) {
    most = fmax(most, fabs(left[k]));
    work = fmax(work, fabs(done[k]));
  }
  assert_true(lost[samples - 1] > 0.1 * work);
  free(left);
  free(done);
  free(lost);
  result_read_close(f);
  return most / work;
}

/* Energies of struck bars: to rounding where the stress is that of the new states and the energy
   quadratic, else the imbalance falls with the square of the step. */
static void losses_are_of_second_order(void **state) {
  static const char late[] = "model late\n"
                             "  law continuum\n"
                             "  for plane_stress\n"
                             "  parameter E = 20 [GPa]  in (0, inf)\n"
                             "  parameter nu = 0.2  in [0, 0.5)\n"
                             "  parameter rho = 2000 [kg/m^3]  in (0, inf)\n"
                             "  state peak on point = 0\n"
                             "  damage omega on point\n"
                             "  peak = max(previous(peak), norm(strain))\n"
                             "  omega = 1 - exp(-peak/0.01)\n"
                             "  stress sigma = (1 - previous(omega))*hooke(strain, E, nu)\n"
                             "end model\n";
  workplace *w = *state;
  write_text(w, "late.plm", late);
  assert_int_equal(shell(w, "cp " SOURCE_DIR "/tests/generator/laws/hardening_point.plm ."), 0);
  const double yielding = imbalance_of(w, "hardening_point.plm", "0.8"),
               coarse = imbalance_of(w, "late.plm", "0.2"),
               fine = imbalance_of(w, "late.plm", "0.1");
  print_message("imbalance %.3g; %.3g, %.3g\n", yielding, coarse, fine);
  assert_true(yielding < 1e-10);
  assert_true(coarse < 1e-3 && fine < 0.3 * coarse);
}

/* A yielded bar at rest: what a gauge and nodes show is its force over its section. */
static void stress_knows_states(void **state) {
  static const char yielding[] =
      "&simulation  end_time = '1 s'  step_safety = 0.5 /\n"
      "&relaxation  increments = 10  tolerance = 1e-6 /\n"
      "&mesh      name = 'bar'  size = '50 mm', '20 mm'  nodes = 11, 5  thickness = '10 mm'\n"
      "           method = 'finite_elements' /\n"
      "&material  mesh = 'bar'  model = './hardening_point.plm' /\n"
      "&region    name = 'left'  shape = 'segment'  from = 0, 0  to = 0, '20 mm' /\n"
      "&region    name = 'foot'  shape = 'point'  at = 0, 0 /\n"
      "&region    name = 'right'  shape = 'segment'  from = '50 mm', 0  to = '50 mm', '20 mm' /\n"
      "&support   region = 'left'  fix = 'x' /\n"
      "&support   region = 'foot'  fix = 'y' /\n"
      "&drive     region = 'right'  component = 'x'  displacement = '0.5 mm' /\n"
      "&monitor   name = 'load'  kind = 'reaction'  region = 'right'  component = 'x' /\n"
      "&monitor   name = 's'  kind = 'stress'  at = '21 mm', '11 mm'  component = 'xx' /\n"
      "&output    result = 'bar.h5'  frames = 1  fields = 'stress' /\n";
  workplace *w = *state;
  char text[64], error[1000];
  long samples, count;
  int components;
  assert_int_equal(shell(w, "cp " SOURCE_DIR "/tests/generator/laws/hardening_point.plm ."), 0);
  write_text(w, "yielding.nml", yielding);
  expect(w, "run yielding.nml", 0, "written");
  result_file *f = open_result_of(w, "bar.h5");
  double *load = result_read_series(f, "load", &samples, text, sizeof text, error, sizeof error),
         *s = result_read_series(f, "s", &samples, text, sizeof text, error, sizeof error),
         *at_nodes = result_read_frame(f, "stress_xx", 1, &count, &components, text, sizeof text,
                                       error, sizeof error);
  const double expected = load[samples - 1] / 200e-6; /* N over m^2 */
  assert_true(expected > 350e6);                      /* the yield stress is 300 MPa */
  assert_true(fabs(s[samples - 1] - expected) < 1e-2 * expected);
  for (long n = 0; n < count; n++)
    assert_true(fabs(at_nodes[n] - expected) < 1e-2 * expected);
  free(load);
  free(s);
  free(at_nodes);
  result_read_close(f);
}

/* An output that is a state is that state at every node, beside a hole, too; nodes have lost what
   the body has. */
static void nodes_beside_a_hole_tell(void **state) {
  static const char holed[] =
      "&simulation  end_time = '40 us'  step_safety = 0.7 /\n"
      "&mesh      name = 'p'  corner = 0, 0  size = 0.02, 0.02  nodes = 13, 13  thickness = 0.01\n"
      "           method = 'element_free'  support = 2.1 /\n"
      "&notch     mesh = 'p'  shape = 'disc'  centre = 0.0103, 0.0097  radius = 0.0041 /\n"
      "&material  mesh = 'p'  model = './hardening_point.plm'  f_y = '100 MPa' /\n"
      "&traction  mesh = 'p'  from = 0.02, 0  to = 0.02, 0.02  component = 'x'  stress = '80 MPa' "
      "/\n"
      "&traction  mesh = 'p'  from = 0, 0  to = 0, 0.02  component = 'x'  stress = '-80 MPa' /\n"
      "&output    result = 'h.h5'  frames = 1  fields = 'across', 'eps_p_xy', 'dissipated' /\n";
  static const char *const names[] = {"across", "eps_p_xy", "dissipated"};
  workplace *w = *state;
  char text[64], error[1000];
  double *values[3], most = 0, sum = 0;
  long count = 0, samples;
  int components;
  assert_int_equal(shell(w, "cp " SOURCE_DIR "/tests/generator/laws/hardening_point.plm ."), 0);
  write_text(w, "holed.nml", holed);
  expect(w, "run holed.nml", 0, "dissipated by states ");
  result_file *f = open_result_of(w, "h.h5");
  for (int k = 0; k < 3; k++) {
    values[k] = result_read_frame(f, names[k], 1, &count, &components, text, sizeof text, error,
                                  sizeof error);
    assert_non_null(values[k]);
    assert_int_equal(count, 13 * 13 - 19);
  }
  for (long p = 0; p < count; p++) {
    most = fmax(most, fabs(values[1][p]));
    sum += values[2][p];
    assert_true(fabs(values[0][p] - values[1][p]) < 1e-12);
  }
  assert_true(most > 1e-4);
  double *taken = result_read_series(f, "energy/dissipated_damage", &samples, text, sizeof text,
                                     error, sizeof error);
  assert_true(sum > 0 && fabs(sum - taken[samples - 1]) < 1e-9 * sum);
  free(taken);
  for (int k = 0; k < 3; k++)
    free(values[k]);
  result_read_close(f);
}

/* By much too long it ends badly; by little only a warning says so. */
static void a_step_that_is_too_long_is_told(void **state) {
  workplace *w = *state;
  const char *run = "run " SOURCE_DIR "/examples/stiffening_bar/bar.nml --set output.result=b.h5 ";
  char line[600];
  snprintf(line, sizeof line,
           "%s --set simulation.step_safety=0.9 --set relaxation.increments=1", run);
  expect(w, line, 2, "runaway velocity");
  assert_non_null(strstr(w->said, "a point of `bar` was more than 1.23 times as stiff as at rest"));
  assert_non_null(strstr(w->said, "mm of cell ("));
  assert_non_null(strstr(w->said, "stress xx"));
  snprintf(line, sizeof line,
           "%s --set simulation.step_safety=0.7 --set relaxation.increments=1", run);
  expect(w, line, 0, "perilat: warning: from increment");
  assert_non_null(strstr(w->said, "became 2.6"));
  snprintf(line, sizeof line, "%s --set simulation.step_safety=0.9", run); /* looked at between */
  expect(w, line, 0, "the body became 2 times as stiff as at rest");
  assert_null(strstr(w->said, "warning"));
  expect(w, run, 0, "written");
  assert_null(strstr(w->said, "as stiff as at rest"));
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test_setup_teardown(same_bits, set_up_workplace, tear_down_workplace),
      cmocka_unit_test_setup_teardown(rectangles_give_the_same_bits, set_up_workplace,
                                      tear_down_workplace),
      cmocka_unit_test_setup_teardown(nodes_tell, set_up_workplace, tear_down_workplace),
      cmocka_unit_test_setup_teardown(monitors_tell, set_up_workplace, tear_down_workplace),
      cmocka_unit_test_setup_teardown(losses_are_of_second_order, set_up_workplace,
                                      tear_down_workplace),
      cmocka_unit_test_setup_teardown(stress_knows_states, set_up_workplace, tear_down_workplace),
      cmocka_unit_test_setup_teardown(nodes_beside_a_hole_tell, set_up_workplace,
                                      tear_down_workplace),
      cmocka_unit_test_setup_teardown(a_step_that_is_too_long_is_told, set_up_workplace,
                                      tear_down_workplace)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
