/* Random fields through decks and the program: a chain breaks at its weakest bond; threads, the
   interpreter and a resumed run give the same bits; a field without spread is no field. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/wait.h>
#include <unistd.h>

#include "runtime/result/result_fields.h"
#include "runtime/result/result_file.h"
#include "runtime/result/result_read.h"

static void write_deck(const char *path, const char *text) {
  FILE *out = fopen(path, "w");
  assert_non_null(out);
  fputs(text, out);
  assert_int_equal(fclose(out), 0);
}

/* What the program says, to be freed, and its exit status. */
static char *call(const char *arguments, int *status) {
  char command[1024], piece[1024], *text = NULL;
  size_t length = 0, n;
  snprintf(command, sizeof command, "PERILAT_MODELS='%s/models' '%s' %s 2>&1", SOURCE_DIR,
           PERILAT_PROGRAM, arguments);
  FILE *in = popen(command, "r"), *out = open_memstream(&text, &length);
  assert_true(in && out);
  while ((n = fread(piece, 1, sizeof piece, in)) > 0)
    fwrite(piece, 1, n, out);
  fclose(out);
  const int ended = pclose(in);
  *status = WIFEXITED(ended) ? WEXITSTATUS(ended) : -1;
  return text;
}

static void must(const char *arguments, int wanted, const char *said) {
  int status;
  char *text = call(arguments, &status);
  if (status != wanted || (said && !strstr(text, said)))
    fail_msg("perilat %s: status %d, expected %d and `%s` in\n%s", arguments, status, wanted,
             said ? said : "", text);
  free(text);
}

static void remove_all(const char *const *names, int count) {
  for (int k = 0; k < count; k++) {
    char path[64];
    static const char *const endings[] = {"nml", "h5", "xdmf"};
    for (int e = 0; e < 3; e++) {
      snprintf(path, sizeof path, "%s.%s", names[k], endings[e]);
      unlink(path);
    }
  }
}

/* --- the weakest bond --- */

static const char chain[] =
    "&simulation end_time = '60 ms' threads = 1 /\n"
    "&lattice name = 'c' kind = 'hexagonal' spacing = '5 mm' thickness = '100 mm' /\n"
    "&material lattice = 'c' model = 'cohesive' /\n"
    "&field parameter = 'f_t' distribution = 'weibull' mean = '3 MPa' cv = 0.2 seed = %d /\n"
    "&body lattice = 'c' shape = 'rectangle' corner = 0, '-1 mm' size = '50 mm', '2 mm' /\n"
    "&region name = 'all' shape = 'rectangle' corner = -1, -1 size = 2, 2 /\n"
    "&region name = 'left' shape = 'point' at = 0, 0 /\n"
    "&region name = 'right' shape = 'point' at = '50 mm', 0 /\n"
    "&support region = 'left' fix = 'x' /\n"
    "&support region = 'all' fix = 'y' /\n"
    "&damping rate = '3000 1/s' /\n"
    "&drive region = 'right' component = 'x' velocity = '1 mm/s' rise = '1 ms' /\n"
    "&monitor name = 'load' kind = 'reaction' region = 'right' component = 'x' /\n"
    "&output result = 'chain.h5' frames = 1 sample = '0.01 ms' fields = 'f_t', 'omega' /\n";

static double *frame(result_file *f, const char *name, long *count) {
  char error[512], unit[32];
  int components;
  double *values =
      result_read_frame(f, name, -1, count, &components, unit, sizeof unit, error, sizeof error);
  if (!values) fail_msg("%s", error);
  return values;
}

/* In a chain all bonds carry one force: the load reaches the strength of the weakest and no other
   breaks. */
static void breaks_at_its_weakest_bond(int seed, double *strength) {
  static const char *const names[] = {"chain"};
  char text[2048], error[512], unit[32];
  snprintf(text, sizeof text, chain, seed);
  write_deck("chain.nml", text);
  must("run chain.nml", 0, "field      f_t differs from bond to bond");
  result_file *f = result_read("chain.h5", error, sizeof error);
  assert_non_null(f);
  long bonds, samples;
  double *f_t = frame(f, "c/f_t", &bonds), *omega = frame(f, "c/omega", &bonds);
  double *load = result_read_series(f, "load", &samples, unit, sizeof unit, error, sizeof error);
  assert_non_null(load);
  assert_int_equal(bonds, 10);
  int weakest = 0;
  double peak = 0;
  for (int k = 0; k < bonds; k++)
    if (f_t[k] < f_t[weakest]) weakest = k;
  for (long k = 0; k < samples; k++)
    peak = fmax(peak, load[k]);
  const double theory = sqrt(3) / 2 * f_t[weakest] * 5e-3 * 0.1;
  print_message("seed %d: bond %d of %.3f MPa breaks, load %.4f of theory\n", seed, weakest,
                1e-6 * f_t[weakest], peak / theory);
  assert_true(fabs(peak / theory - 1) < 0.01); /* damping and inertia of the pull */
  for (int k = 0; k < bonds; k++)
    assert_true(k == weakest ? omega[k] > 0.9 : omega[k] < 0.01);
  *strength = f_t[weakest];
  free(f_t);
  free(omega);
  free(load);
  result_read_close(f);
  remove_all(names, 1);
}

static void chains_break_at_their_weakest_bond(void **state) {
  (void)state;
  double a, b;
  breaks_at_its_weakest_bond(1, &a);
  breaks_at_its_weakest_bond(2, &b);
  assert_true(a != b);
}

/* --- the same bits --- */

#define BLOCK                                                                                      \
  "&simulation end_time = '1 ms' /\n"                                                              \
  "&lattice name = 'c' kind = 'hexagonal' spacing = '5 mm' thickness = '100 mm' rotation = 10 /\n" \
  "&body lattice = 'c' shape = 'rectangle' corner = 0, 0 size = '120 mm', '80 mm' /\n"             \
  "&region name = 'low' shape = 'rectangle' corner = -1, -1 size = 2, '1.007 m' /\n"               \
  "&region name = 'top' shape = 'rectangle' corner = -1, '73 mm' size = 2, 1 /\n"                  \
  "&support region = 'low' fix = 'xy' /\n"                                                         \
  "&drive region = 'top' component = 'y' velocity = '60 mm/s' rise = '0.1 ms' /\n"                 \
  "&monitor name = 'load' kind = 'reaction' region = 'top' component = 'y' /\n"

static void threads_and_readers_agree_to_the_bit(void **state) {
  (void)state;
  static const char *const names[] = {"rf_a", "rf_b", "rf_c", "rf_d"};
  static const char deck[] =
      BLOCK "&material lattice = 'c' model = 'mplm_bilinear' /\n"
            "&field parameter = 'S_t' distribution = 'weibull' cv = 0.15 correlation_length = "
            "'15 mm' /\n"
            "&field parameter = 'E' on = 'particle' distribution = 'lognormal' cv = 0.1 /\n"
            "&field parameter = 'beta' distribution = 'uniform' low = 0.05 high = 0.15 /\n"
            "&output frames = 3 fields = 'displacement', 'damage', 'omega', 'S_t', 'E' /\n";
  write_deck("rf_a.nml", deck);
  must("run rf_a.nml --threads 1 --check-kernel", 0, "its interpreter give the same bits");
  must("run rf_a.nml --threads 3 --set output.result=rf_b.h5", 0, NULL);
  must("run rf_a.nml --threads 2 --interpret --set output.result=rf_c.h5", 0, NULL);
  must("compare rf_a.h5 rf_b.h5", 0, "same");
  must("compare rf_a.h5 rf_c.h5", 0, "same");
  must("run rf_a.nml --set field[S_t].seed=2 --set output.result=rf_d.h5", 0, NULL);
  must("compare rf_a.h5 rf_d.h5 --tolerance 1e-3 --history load", 2, "different");
  must("compare rf_a.h5 rf_d.h5 --field c/E", 0, "same");
  must("compare rf_a.h5 rf_d.h5 --field c/S_t --tolerance 0.01", 2, "different");
  remove_all(names, 4);
}

/* With a spread below rounding the elastic block is that of the uniform law; what is hoisted in one
   and computed for each bond in the other is rounded otherwise. */
static void a_field_without_spread_is_no_field(void **state) {
  (void)state;
  static const char *const names[] = {"rf_a", "rf_b"};
  write_deck("rf_a.nml", BLOCK "&material lattice = 'c' model = 'elastic_micropolar' /\n");
  write_deck("rf_b.nml",
             BLOCK "&material lattice = 'c' model = 'elastic_micropolar' E = '10 GPa' /\n"
                   "&field parameter = 'E' distribution = 'normal' mean = '30 GPa' cv = 1e-200 /\n"
                   "&field parameter = 'nu' distribution = 'uniform' cv = 1e-200 /\n");
  must("run rf_a.nml", 0, NULL);
  must("run rf_b.nml", 0, "on this lattice E = 30 GPa, nu = 0.2000");
  must("compare rf_a.h5 rf_b.h5 --tolerance 1e-9", 0, "same");
  remove_all(names, 2);
}

/* The stiffest bond decides the step: c is sqrt(2.25) times as fast. */
static void the_step_knows_the_stiffest_bond(void **state) {
  (void)state;
  static const char *const names[] = {"rf_a"};
  write_deck("rf_a.nml", BLOCK "&material lattice = 'c' model = 'elastic_central' E = '10 GPa' /\n"
                               "&field parameter = 'E' distribution = 'uniform' low = '10 GPa' "
                               "high = '22.5 GPa' /\n");
  int status;
  char *with = call("check rf_a.nml", &status), *without;
  assert_int_equal(status, 0);
  write_deck("rf_a.nml",
             BLOCK "&material lattice = 'c' model = 'elastic_central' E = '10 GPa' /\n");
  without = call("check rf_a.nml", &status);
  double limit[2];
  const char *at[2] = {strstr(with, "of the stable step"), strstr(without, "of the stable step")};
  assert_true(at[0] && at[1]);
  for (int k = 0; k < 2; k++)
    assert_int_equal(sscanf(at[k], "of the stable step %lf us", &limit[k]), 1);
  /* the largest of some thousand values lies within a percent of the upper end */
  assert_true(limit[1] / limit[0] < 1.5 + 1e-3 && limit[1] / limit[0] > 1.49);
  free(with);
  free(without);
  remove_all(names, 1);
}

static void unknown_parameters_are_told_at_their_line(void **state) {
  (void)state;
  static const char *const names[] = {"rf_a"};
  write_deck("rf_a.nml", BLOCK "&material lattice = 'c' model = 'mplm_bilinear' /\n"
                               "&field parameter = 'S_f' distribution = 'normal' cv = 0.1 /\n");
  must("check rf_a.nml", 1, "the law `mplm_bilinear` has no parameter `S_f`");
  must("check rf_a.nml --set field.parameter=alpha2 --set field.cv=3", 1,
       "mm is not in (1, inf), the range of the law `mplm_bilinear`");
  remove_all(names, 1);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(chains_break_at_their_weakest_bond),
      cmocka_unit_test(threads_and_readers_agree_to_the_bit),
      cmocka_unit_test(a_field_without_spread_is_no_field),
      cmocka_unit_test(the_step_knows_the_stiffest_bond),
      cmocka_unit_test(unknown_parameters_are_told_at_their_line),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
