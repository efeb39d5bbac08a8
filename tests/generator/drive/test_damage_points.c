/* Laws of a continuum that soften and fail, at one point: directions of principal values in space
   and in the plane, points that fail, the work of fracture of the damage laws in models/ for cells
   of three sizes, a crack at an angle against its closed form, cells of sizes that a law does
   not hold for; and damages that flow, of bonds and families, too. */
#define _GNU_SOURCE
#include <setjmp.h>
#include <stdarg.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "tests/generator/command_tools.h"

/* --- directions ------------------------------------------------------------------------------- */

/* Dyads of unit vectors at right angles that together are the unit tensor, and that the tensor is
   made of. */
static const char directions[] =
    "model directions\n"
    "  law continuum\n"
    "  for space, plane_strain\n"
    "  parameter E  = 30 [GPa]  in (0, inf)\n"
    "  parameter nu = 0.2       in [0, 0.5)\n"
    "  stress sigma = hooke(strain, E, nu)\n"
    "  a = principal_direction(strain, 1)\n"
    "  b = principal_direction(strain, 2)\n"
    "  c = principal_direction(strain, 3)\n"
    "  sum = (a : strain)*a + (b : strain)*b + (c : strain)*c\n"
    "  output of_size_one = norm(product(a, a) - a) + norm(product(b, b) - b)\n"
    "  output across = norm(product(a, b)) + norm(product(b, c)) + norm(product(c, a))\n"
    "  output whole = norm(a + b + c - tensor(1, 1, 1, 0))\n"
    "  output one_each = abs(trace(a) - 1) + abs(trace(b) - 1)\n"
    "  output left_over = norm(sum - strain)/max(norm(strain), 1e-30)\n"
    "end model\n";

#define PULL(component, value, period, start)                                                      \
  "&path quantity = 'strain_" component "' value = " value " history = 'cycles' period = '" period \
  "' start = '" start "' /\n"
#define NONE(quantity)                                                                             \
  "&expect quantity = 'peak " quantity "' value = 0 absolute = 1e-13 /\n"                          \
  "&expect quantity = 'lowest " quantity "' value = 0 absolute = 1e-13 /\n"
#define NONE_OF_ALL                                                                                \
  NONE("of_size_one") NONE("across") NONE("whole") NONE("one_each") NONE("left_over")

/* From rest, where all values are equal, over uniaxial strain, where two are. */
static void directions_of_principal_values(void **state) {
  workplace *w = *state;
  write_text(w, "directions.plm", directions);
  write_text(w, "space.nml",
             "&simulation steps = 400 /\n&point setting = 'space' /\n"
             "&material model = 'directions.plm' /\n" PULL("xx", "2e-3", "1 s", "0 s")
                 PULL("zz", "1.1e-3", "0.7 s", "0.1 s") PULL("yy", "1.3e-3", "0.3 s", "0.2 s")
                     PULL("yz", "1e-3", "0.4 s", "0.3 s") PULL("xz", "1e-3", "0.5 s", "0.4 s")
                         PULL("xy", "1e-3", "0.6 s", "0.3 s") NONE_OF_ALL);
  expect(w, "drive space.nml", 0, "10 of 10 expectations hold");
  write_text(w, "plane.nml",
             "&simulation steps = 400 /\n&point setting = 'plane_strain' /\n"
             "&material model = 'directions.plm' /\n" PULL("xx", "2e-3", "1 s", "0 s")
                 PULL("yy", "1.3e-3", "0.3 s", "0.2 s") PULL("xy", "1e-3", "0.6 s", "0.4 s")
                     NONE_OF_ALL);
  expect(w, "drive plane.nml", 0, "10 of 10 expectations hold");
}

/* --- points that fail ------------------------------------------------------------------------- */

/* What was stored when it failed is lost; whole again in strain, it stays as it is. */
static void a_point_fails_for_good(void **state) {
  workplace *w = *state;
  write_text(w, "glass.plm",
             "model glass\n"
             "  law continuum\n"
             "  for plane_stress, plane_strain, space\n"
             "  parameter E     = 70 [GPa]  in (0, inf)\n"
             "  parameter nu    = 0.2       in [0, 0.5)\n"
             "  parameter eps_u = 1e-3      in (0, 1)\n"
             "  stress sigma = hooke(strain, E, nu)\n"
             "  failed when principal(strain, 1) >= eps_u\n"
             "  output largest = principal(sigma, 1)\n"
             "end model\n");
  expect(w, "check glass.plm", 0, "no errors, 0 warnings");
  write_text(w, "path.nml",
             "&simulation steps = 1000 /\n&material model = 'glass.plm' /\n"
             "&path quantity = 'strain_xx' times = 0, '1 s', '2 s' values = 0, 2e-3, -1e-3 /\n"
             "&expect quantity = 'stress_xx' at_time = '0.4 s' formula = 'E/(1 - nu**2)*8e-4' /\n"
             "&expect quantity = 'largest' at_time = '0.4 s' formula = 'E/(1 - nu**2)*8e-4' /\n"
             "&expect quantity = 'failed' at_time = '0.499 s' value = 0 absolute = 0.5 /\n"
             "&expect quantity = 'failed' at_time = '0.502 s' value = 1 /\n"
             "&expect quantity = 'stress_xx' value = 0 absolute = '1e-9 Pa' /\n"
             "&expect quantity = 'stress_yy' value = 0 absolute = '1e-9 Pa' /\n"
             "&expect quantity = 'largest' value = 0 absolute = '1e-9 Pa' /\n"
             "&expect quantity = 'failed' value = 1 /\n"
             "&expect quantity = 'stored' value = 0 absolute = '1e-9 J/m^3' /\n"
             "&expect quantity = 'dissipated' formula = 'E/(1 - nu**2)*eps_u**2/2' "
             "tolerance = 5e-3 /\n"
             "&expect quantity = 'imbalance' value = 0 absolute = '1e-6 J/m^3' /\n");
  for (int k = 0; k < 2; k++)
    expect(w, k ? "drive path.nml --compiled" : "drive path.nml", 0, "11 of 11 expectations hold");
}

/* --- the work of fracture --------------------------------------------------------------------- */

/* Drawn until nothing is left, free of stress across: the work times the size is G_f. */
static void work_of_fracture(workplace *w, const char *material, const char *size,
                             const char *strain, const char *tolerance) {
  char text[1000];
  snprintf(text, sizeof text,
           "&simulation steps = 12000 /\n"
           "&point test = 'uniaxial stress' setting = 'plane_stress' size = '%s' /\n"
           "&material model = %s /\n"
           "&path quantity = 'strain_xx' times = 0, '1 s', '2 s' values = 0, 1e-3, %s /\n"
           "&expect quantity = 'external' formula = 'G_f/(%.2s [mm])' tolerance = %s /\n"
           "&expect quantity = 'dissipated' formula = 'G_f/(%.2s [mm])' tolerance = %s /\n",
           size, material, strain, size, tolerance, size, tolerance);
  write_text(w, "path.nml", text);
  expect(w, "drive path.nml", 0, "2 of 2 expectations hold");
}

/* Of the plastic damage 0.09 % is lost where the effective strength in tension stays below that of
   compression, and strengths are those of the last step. */
static void tearing_takes_the_fracture_energy(void **state) {
  static const char *const sizes[] = {"20 mm", "50 mm", "80 mm"}, *const strains[] = {
                                                                      "0.04", "0.016", "0.01"};
  for (int k = 0; k < 3; k++) {
    work_of_fracture(*state, "'mazars'", sizes[k], strains[k], "1e-3");
    work_of_fracture(*state, "'brittle_cracking'", sizes[k], strains[k], "1e-3");
    work_of_fracture(*state, "'concrete_damage_plasticity' tearing = 'whole'", sizes[k], strains[k],
                     "2e-3");
  }
}

/* --- a crack at an angle ---------------------------------------------------------------------- */

/* Strain e along n, at 30 degrees, and none across: with A = E/(1 - nu^2) the crack's strain is c =
   (A e - f_t)/(A - fall_1), the stress along n the curve's, that along the crack nu A (e - c). */
#define CRACK       "((E/(1 - nu**2)*1e-3 - f_t)/(E/(1 - nu**2) - fall_1))"
#define STRESS      "(f_t - fall_1*" CRACK ")"
#define ALONG_CRACK "(nu*E/(1 - nu**2)*(1e-3 - " CRACK "))"

static void a_crack_at_an_angle(void **state) {
  workplace *w = *state;
  write_text(w, "path.nml",
             "&simulation steps = 2000 /\n&point setting = 'plane_stress' size = '10 mm' /\n"
             "&material model = 'brittle_cracking' /\n"
             "&path quantity = 'strain_xx' value = 7.5e-4 rise = '1 s' /\n"
             "&path quantity = 'strain_yy' value = 2.5e-4 rise = '1 s' /\n"
             "&path quantity = 'strain_xy' value = 4.330127018922194e-4 rise = '1 s' /\n"
             "&expect quantity = 'n_1_xx' value = 0.75 tolerance = 1e-12 /\n"
             "&expect quantity = 'n_1_xy' value = 0.4330127018922194 tolerance = 1e-12 /\n"
             "&expect quantity = 'stress_xx' formula = '0.75*" STRESS " + 0.25*" ALONG_CRACK
             "' tolerance = 1e-9 /\n"
             "&expect quantity = 'stress_yy' formula = '0.25*" STRESS " + 0.75*" ALONG_CRACK
             "' tolerance = 1e-9 /\n"
             "&expect quantity = 'stress_xy' formula = '0.4330127018922194*(" STRESS
             " - " ALONG_CRACK ")' tolerance = 1e-9 /\n");
  expect(w, "drive path.nml", 0, "5 of 5 expectations hold");
}

/* --- sizes of cells --------------------------------------------------------------------------- */

static void cells_of_wrong_sizes_are_refused(void **state) {
  workplace *w = *state;
  write_text(w, "path.nml",
             "&point size = '700 mm' /\n&material model = 'mazars' /\n"
             "&path quantity = 'strain_xx' value = 1e-3 rise = '1 s' /\n");
  expect(w, "drive path.nml", 1,
         "a cell of 700 mm is not in (0, 666.667) mm, the sizes that the law `mazars` holds for");
  expect(w, "drive path.nml --set material.tension=mazars", 0, "");
  expect(w, "drive path.nml --set material.G_f='110 N/m'", 0, "");
  static const char deck[] =
      "&simulation end_time = '200 us' /\n"
      "&mesh name = 'bar' size = '2400 mm', '800 mm' nodes = 4, 2 thickness = '100 mm' "
      "method = '%s' /\n&material mesh = 'bar' model = '%s' /\n";
  char text[600];
  snprintf(text, sizeof text, deck, "finite_elements", "mazars");
  write_text(w, "deck.nml", text);
  expect(w, "check deck.nml", 1,
         "the cell at (400, 400) mm is 800 mm across, but the law `mazars` holds for less than "
         "666.7 mm");
  expect(w, "check deck.nml --set material.G_f='130 N/m'", 0, "");
  snprintf(text, sizeof text, deck, "element_free", "mazars");
  write_text(w, "deck.nml", text);
  expect(w, "check deck.nml", 1, "is element-free and has none");
  snprintf(text, sizeof text, deck, "element_free", "elastic");
  write_text(w, "deck.nml", text);
  expect(w, "check deck.nml", 0, "");
}

/* --- damages that flow ------------------------------------------------------------------------ */

#define STRENGTH "  parameter S = 1e-4 in (0, 1)\n  parameter rho = 2400 [kg/m^3] in (0, inf)\n"
#define HELD                                                                                       \
  " at_time = 1 formula = '1 - S/1e-3' tolerance = %s /\n&expect quantity = '%s' at_time = 2 "     \
  "formula = '1 - S/1e-3' tolerance = %s /\n&expect quantity = '%s' at_time = 3 "                  \
  "formula = '1 - S/2e-3' tolerance = %s /\n"

/* A damage grows along a flow until (1 - D) e is the strength, and stays as it is let go: of a
   bond, toward the neighbours of a particle, of a point. */
static void a_damage_flows_back_to_a_strength(void **state) {
  static const struct {
    const char *law, *of, *moved, *damage, *tolerance;
  } cases[] = {{"law central bond\n  parameter k = 50 [MN] in (0, inf)\n" STRENGTH
                "  damage D on bond\n  e = positive_part(stretch)\n"
                "  flow D along 1 returned when (1 - D)*e - S >= 0\n"
                "  force N = k*(stretch - D*e)\n",
                "&bond spacing = '10 mm' thickness = '10 mm'", "stretch", "D", "1e-9"},
               {"law state\n  for plane_stress\n  parameter E = 30 [GPa] in (0, inf)\n" STRENGTH
                "  damage D on bond\n  e[j] = positive_part(stretch[j])\n"
                "  flow D[j] along 1 returned when (1 - D[j])*e[j] - S >= 0\n"
                "  force state T[j] = 3*E/sum(s*V[j])*(stretch[j] - D[j]*e[j])\n",
                "&particle lattice = 'hexagonal' spacing = '10 mm'", "strain_xx", "D_1", "1e-3"},
               {"law continuum\n  for space\n  parameter E = 30 [GPa] in (0, inf)\n" STRENGTH
                "  damage D on point\n  e = positive_part(principal(strain, 1))\n"
                "  flow D along 1 returned when (1 - D)*e - S >= 0\n"
                "  stress sigma = (1 - D)*hooke(strain, E, 0.2)\n",
                "&point test = 'components'", "strain_xx", "D", "1e-9"}};
  workplace *w = *state;
  for (size_t k = 0; k < sizeof cases / sizeof *cases; k++) {
    char text[2000];
    const char *d = cases[k].damage, *near = cases[k].tolerance;
    snprintf(text, sizeof text, "model flowing\n  %send model\n", cases[k].law);
    write_text(w, "flowing.plm", text);
    snprintf(text, sizeof text,
             "&simulation steps = 60 /\n%s /\n&material model = 'flowing.plm' /\n"
             "&path quantity = '%s' times = 0, 1, 2, 3 values = 0, 1e-3, 0, 2e-3 /\n"
             "&expect quantity = '%s'" HELD,
             cases[k].of, cases[k].moved, d, near, d, near, d, near);
    write_text(w, "path.nml", text);
    expect(w, "check flowing.plm", 0, "no errors, 0 warnings");
    expect(w, "drive path.nml", 0, "3 of 3");
    expect(w, "drive path.nml --compiled", 0, "3 of 3");
  }
}

int main(void) {
#define T(test) cmocka_unit_test_setup_teardown(test, set_up_workplace, tear_down_workplace)
  const struct CMUnitTest tests[] = {
      T(directions_of_principal_values),    T(a_point_fails_for_good),
      T(tearing_takes_the_fracture_energy), T(a_crack_at_an_angle),
      T(cells_of_wrong_sizes_are_refused),  T(a_damage_flows_back_to_a_strength),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
