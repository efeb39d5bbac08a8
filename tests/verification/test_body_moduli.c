/* Moduli of bodies cut from lattices, held in a uniform strain: strips whose edges lack bonds.
   Theory: bonds k of a strip that is held in the strain of a bar, with the sections of its middle;
   perfect edges leave the lattice's modulus, those of a hexagon that is turned by 30 degrees leave
   the share of the inclined bonds that the strip still has. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "runtime/analysis/uniform_strain.h"
#include "tests/verification/case.h"

static const double E = 30e9;

static void moduli_of(const char *lattice, const char *model_name, const char *keys,
                      double out[3]) {
  deck_case c;
  char text[1000];
  snprintf(text, sizeof text,
           "&simulation end_time = 1 /\n&lattice name = 'l' spacing = '10 mm' %s /\n"
           "&material lattice = 'l' model = '%s' E = '30 GPa' /\n&body lattice = 'l' %s /\n",
           lattice, model_name, keys);
  assert_true(deck_case_text(&c, text));
  assert_true(uniform_strain_moduli(c.law.law, c.law.parameters, NULL,
                                    simulation_rows(c.simulation, 0), out));
  print_message("%s, %s: E %+.4f %% along x, %+.4f %% along y, %+.4f %% along z\n", lattice,
                model_name, 100 * (out[0] / E - 1), 100 * (out[1] / E - 1), 100 * (out[2] / E - 1));
  deck_case_close(&c);
}

#define HEXAGON(angle) "kind = 'hexagonal' thickness = '10 mm' rotation = " angle
#define STRIP(height)  "shape = 'rectangle' corner = 0, 0 size = 1, " height

static void rows_along_the_load_have_the_modulus_of_the_lattice(void **state) {
  (void)state;
  double found[3];
  moduli_of(HEXAGON("0"), "elastic_central", STRIP("0.0607"), found);
  assert_true(fabs(found[0] / E - 1) < 1e-6);
  moduli_of("kind = 'square' horizon = 1 thickness = '10 mm'", "elastic_central", STRIP("0.05"),
            found);
  assert_true(fabs(found[0] / (sqrt(3) / 2 * E) - 1) < 1e-6);
}

/* Columns of seven and six sites by turns: 24 inclined bonds for two of them, where 13 whole sites
   have 26. */
static void turned_strips_are_softer(void **state) {
  (void)state;
  double found[3];
  moduli_of(HEXAGON("30"), "elastic_central", STRIP("0.06"), found);
  assert_true(fabs(found[0] / E - 24.0 / 26) < 1e-3);
  moduli_of(HEXAGON("15"), "elastic_central", STRIP("0.0607"), found);
  assert_true(found[0] / E < 0.96 && found[0] / E > 0.92);
  moduli_of(HEXAGON("30"), "elastic_micropolar", STRIP("0.06"), found);
  assert_true(found[0] / E < 0.94 && found[0] / E > 0.90);
}

/* The part that edges lack falls as the strip grows. */
static void wide_strips_forget_their_edges(void **state) {
  (void)state;
  static const char *const strips[] = {STRIP("0.06"), STRIP("0.12"), STRIP("0.24"), STRIP("0.48")};
  double before = INFINITY;
  for (size_t k = 0; k < sizeof strips / sizeof *strips; k++) {
    double found[3];
    moduli_of(HEXAGON("30"), "elastic_central", strips[k], found);
    const double less = 1 - found[0] / E;
    assert_true(less > 0 && less < 0.6 * before);
    before = less;
  }
}

/* In space, and what has no middle. */
static void blocks_and_plates(void **state) {
  (void)state;
  double found[3];
  moduli_of("kind = 'fcc' shells = 2", "splm_elastic", "shape = 'box' corner = 3*0 size = 3*0.12",
            found);
  for (int a = 0; a < 3; a++)
    assert_true(found[a] / E < 1 && found[a] / E > 0.9);
  assert_true(fabs(found[0] / found[1] - 1) < 1e-6 && fabs(found[0] / found[2] - 1) < 1e-6);
  moduli_of("kind = 'fcc' shells = 2", "splm_elastic",
            "shape = 'box' corner = 3*0 size = 0.2, 0.2, 0.02", found);
  assert_true(found[0] / E < 0.95 && isnan(found[2]));
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(rows_along_the_load_have_the_modulus_of_the_lattice),
      cmocka_unit_test(turned_strips_are_softer),
      cmocka_unit_test(wide_strips_forget_their_edges),
      cmocka_unit_test(blocks_and_plates),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
