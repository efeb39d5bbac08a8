/* Laws of models/ against their closed forms, through decks and the program: work of fracture and
   strength of cohesive at two spacings and with both kinds of softening, and of hordijk;
   elastic constants of the elastic laws. */
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

#include "runtime/result/result_file.h"
#include "runtime/result/result_read.h"

static const double f_t = 3e6, G_f = 80, thickness = 0.1; /* Pa, N/m, m */

/* Two rows of particles, of which the upper one is lifted by 1 mm/s and both are guided: only the
   inclined bonds between them work, two for each particle of the upper row. */
static const char strip[] =
    "&simulation end_time = '%g ms' /\n"
    "&lattice name = 'c' kind = 'hexagonal' spacing = %.17g thickness = '100 mm' /\n"
    "&material lattice = 'c' model = '%s' f_t = '3 MPa' G_f = '80 "
    "N/m' /\n"
    "&body lattice = 'c' shape = 'rectangle' corner = 0, 0 size = '50 mm', %.17g /\n"
    "&region name = 'low' shape = 'rectangle' corner = '-1 mm', '-1 mm' size = '52 mm', '2 mm' /\n"
    "&region name = 'top' shape = 'rectangle' corner = '-1 mm', '2 mm' size = '52 mm', '5 mm' /\n"
    "&support region = 'low' fix = 'xy' /\n"
    "&support region = 'top' fix = 'x' /\n"
    "&drive region = 'top' component = 'y' velocity = '1 mm/s' rise = '1 ms' /\n"
    "&monitor name = 'load' kind = 'reaction' region = 'top' component = 'y' /\n"
    "&output result = 'models_strip.h5' frames = 2 sample = '0.01 ms' /\n";

static void write_deck(const char *path, double end_ms, double spacing, const char *law) {
  FILE *out = fopen(path, "w");
  assert_non_null(out);
  fprintf(out, strip, end_ms, spacing, law, 0.9 * spacing);
  assert_int_equal(fclose(out), 0);
}

/* What the program prints, to be freed; its exit status must be 0. */
static char *program(const char *arguments) {
  char command[1024], *text = NULL, piece[1024];
  size_t length = 0, n;
  snprintf(command, sizeof command, "PERILAT_MODELS='%s/models' '%s' %s 2>&1", SOURCE_DIR,
           PERILAT_PROGRAM, arguments);
  FILE *in = popen(command, "r"), *out = open_memstream(&text, &length);
  assert_true(in && out);
  while ((n = fread(piece, 1, sizeof piece, in)) > 0)
    fwrite(piece, 1, n, out);
  fclose(out);
  if (pclose(in) != 0) fail_msg("%s\n%s", command, text);
  return text;
}

static double largest(const double *values, long count) {
  double most = values[0];
  for (long k = 1; k < count; k++)
    most = fmax(most, values[k]);
  return most;
}

static void fracture_costs_what_the_law_says(double spacing, const char *law, double end_ms) {
  char error[1024], unit[32];
  long samples, particles;
  write_deck("models_strip.nml", end_ms, spacing, law);
  free(program("run models_strip.nml"));
  result_file *f = result_read("models_strip.h5", error, sizeof error);
  assert_non_null(f);
  int dimensions;
  free(result_read_reference(f, &particles, &dimensions));
  double *load = result_read_series(f, "load", &samples, unit, sizeof unit, error, sizeof error);
  double *lost = result_read_series(f, "energy/dissipated_damage", &samples, unit, sizeof unit,
                                    error, sizeof error);
  assert_true(load && lost);
  double bonds = (double)(particles / 2) * 2; /* n + 1 sites below, n above */
  double bond_energy = G_f * spacing * thickness / 2;
  double bond_strength = sqrt(3) / 2 * f_t * spacing * thickness;
  double work = lost[samples - 1] / (bonds * bond_energy);
  double strength = largest(load, samples) / (bonds * bond_strength * sqrt(3) / 2);
  print_message("%s, %g mm: work of fracture %.5f, strength %.5f of theory\n", law, 1e3 * spacing,
                work, strength);
  /* The strip's bonds turn by 0.1 %, which enters squared; a sample every 0.01 ms may miss the peak
   * by 0.03 %. */
  assert_true(fabs(work - 1) < 1e-3);
  assert_true(fabs(strength - 1) < 1e-3);
  free(load);
  free(lost);
  result_read_close(f);
  unlink("models_strip.nml");
  unlink("models_strip.h5");
  unlink("models_strip.xdmf");
}

#define EXPONENTIAL "cohesive' softening = 'exponential"

static void work_of_fracture_of_cohesive_bonds(void **state) {
  (void)state;
  fracture_costs_what_the_law_says(5e-3, "cohesive", 50);
  fracture_costs_what_the_law_says(2.5e-3, "cohesive", 50);
  fracture_costs_what_the_law_says(5e-3, EXPONENTIAL, 200);
  fracture_costs_what_the_law_says(2.5e-3, EXPONENTIAL, 200);
  fracture_costs_what_the_law_says(5e-3, "hordijk", 110);
  fracture_costs_what_the_law_says(2.5e-3, "hordijk", 110);
}

/* The constants that the program announces are those of the perfect lattice, from the law's
 * tangent. */
static void assert_elastic(const char *model, const char *settings, const char *expected) {
  static const char deck[] =
      "&simulation end_time = '1 ms' /\n"
      "&lattice name = 'c' kind = 'hexagonal' spacing = '5 mm' rotation = 17 thickness = '100 mm' "
      "/\n"
      "&material lattice = 'c' model = '%s' %s /\n"
      "&body lattice = 'c' shape = 'rectangle' corner = 0, 0 size = '50 mm', '50 mm' /\n";
  FILE *out = fopen("models_elastic.nml", "w");
  assert_non_null(out);
  fprintf(out, deck, model, settings);
  assert_int_equal(fclose(out), 0);
  char *said = program("check models_elastic.nml");
  if (!strstr(said, expected)) fail_msg("%s: `%s` is missing in\n%s", model, expected, said);
  free(said);
  unlink("models_elastic.nml");
}

static void elastic_constants_are_those_asked_for(void **state) {
  (void)state;
  assert_elastic("elastic_central", "E = '25 GPa'", "E = 25 GPa, nu = 0.3333");
  assert_elastic("cohesive", "E = '25 GPa'", "E = 25 GPa, nu = 0.3333");
  assert_elastic("hordijk", "E = '25 GPa'", "E = 25 GPa, nu = 0.3333");
  assert_elastic("elastic_micropolar", "E = '25 GPa' nu = 0.15", "E = 25 GPa, nu = 0.1500");
  assert_elastic("parallel_bond", "kappa = 2.5", "E = 42.79 GPa, nu = 0.1765");
  assert_elastic("facet", "E = '25 GPa' nu = 0.1", "E = 25 GPa, nu = 0.1000");
  assert_elastic("mplm_bilinear", "E = '25 GPa' nu = 0.1", "E = 25 GPa, nu = 0.1000");
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(work_of_fracture_of_cohesive_bonds),
      cmocka_unit_test(elastic_constants_are_those_asked_for),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
