/* Points of continua that are driven: Hooke's law in every test against its closed form, stresses
   that are prescribed, rates, ellipticity that is lost, and what is refused. */
#define _GNU_SOURCE
#include <setjmp.h>
#include <stdarg.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include <math.h>

#include "generator/drive/ellipticity.h"
#include "tests/generator/command_tools.h"

#define ELASTIC   "&material model = 'elastic' E = '30 GPa' nu = 0.25 /\n"
#define TO_TEN    "&path quantity = 'strain_xx' value = 1e-5 rise = '1 s' /\n"
#define EXACT     " tolerance = 1e-12 /\n"
#define NONE_LEFT " value = 0 absolute = '1e-6 Pa' /\n"

static void drive(workplace *w, const char *path_text, int status, const char *wanted) {
  write_text(w, "path.nml", path_text);
  expect(w, "drive path.nml", status, wanted);
}

/* --- Hooke's law ------------------------------------------------------------------------------ */

static void hooke_in_every_test(void **state) {
  workplace *w = *state;
  drive(w,
        ELASTIC "&point test = 'uniaxial stress' setting = 'plane_strain' /\n" TO_TEN
                "&expect quantity = 'stress_xx' formula = 'E/(1 - nu**2)*1e-5'" EXACT
                "&expect quantity = 'strain_yy' formula = '-nu/(1 - nu)*1e-5'" EXACT
                "&expect quantity = 'stress_zz' formula = 'nu*E/(1 - nu**2)*1e-5'" EXACT
                "&expect quantity = 'stress_yy'" NONE_LEFT,
        0, "4 of 4");
  drive(w,
        ELASTIC "&point test = 'plane stress' setting = 'space' /\n" TO_TEN
                "&expect quantity = 'stress_xx' formula = 'E/(1 - nu**2)*1e-5'" EXACT
                "&expect quantity = 'stress_yy' formula = 'nu*E/(1 - nu**2)*1e-5'" EXACT
                "&expect quantity = 'strain_zz' formula = '-nu/(1 - nu)*1e-5'" EXACT
                "&expect quantity = 'stress_zz'" NONE_LEFT,
        0, "4 of 4");
  drive(w,
        ELASTIC "&point test = 'hydrostatic' setting = 'space' /\n" TO_TEN
                "&expect quantity = 'stress_xx' formula = 'E/(1 - 2*nu)*1e-5'" EXACT
                "&expect quantity = 'strain_zz' value = 1e-5" EXACT
                "&expect quantity = 'stored' formula = '3/2*E/(1 - 2*nu)*1e-10'" EXACT,
        0, "3 of 3");
  drive(w,
        ELASTIC "&point test = 'hydrostatic' /\n"
                "&path quantity = 'stress_xx' value = '1 MPa' rise = '1 s' /\n"
                "&expect quantity = 'strain_yy' formula = '(1 - nu)*1 [MPa]/E'" EXACT
                "&expect quantity = 'strain_xy' value = 0 absolute = 1e-18 /\n",
        0, "2 of 2");
  drive(w,
        ELASTIC "&point test = 'shear' setting = 'space' /\n"
                "&path quantity = 'strain_xy' value = 1e-5 rise = '1 s' /\n"
                "&expect quantity = 'stress_xy' formula = 'E/(1 + nu)*1e-5'" EXACT
                "&expect quantity = 'external' formula = 'E/(1 + nu)*1e-10'" EXACT,
        0, "2 of 2");
}

/* What is neither strained nor stressed by a path of its own stays unstrained. */
static void strains_and_stresses_mix(void **state) {
  workplace *w = *state;
  drive(w,
        ELASTIC TO_TEN "&path quantity = 'stress_yy' value = '-2 MPa' rise = '1 s' /\n"
                       "&path quantity = 'stress_xy' value = '0.5 MPa' rise = '1 s' /\n"
                       "&expect quantity = 'strain_yy' formula = '(1 - nu**2)*(-2 [MPa])/E - "
                       "nu*1e-5'" EXACT
                       "&expect quantity = 'strain_xy' formula = '(1 + nu)*0.5 [MPa]/E'" EXACT
                       "&expect quantity = 'stress_yy' value = '-2 MPa'" EXACT
                       "&expect quantity = 'stress_xx' formula = 'E*1e-5 - nu*2 [MPa]'" EXACT,
        0, "4 of 4");
  drive(w,
        ELASTIC
        "&point setting = 'plane_strain' /\n" TO_TEN "&expect quantity = 'stress_yy' formula = "
        "'nu*E/((1 + nu)*(1 - 2*nu))*1e-5'" EXACT "&expect quantity = 'stress_zz' formula = "
        "'nu*E/((1 + nu)*(1 - 2*nu))*1e-5'" EXACT,
        0, "at one point (plane_strain)");
}

static void a_table_drives_a_stress(void **state) {
  workplace *w = *state;
  write_text(w, "stress.csv", "time [s], stress [MPa]\n0, 0\n1, 3\n2, 1.5\n");
  drive(w,
        ELASTIC "&point test = 'uniaxial stress' /\n"
                "&path quantity = 'stress_xx' file = 'stress.csv' /\n"
                "&expect quantity = 'strain_xx' at_time = '1 s' value = 1e-4" EXACT
                "&expect quantity = 'strain_xx' value = 0.5e-4" EXACT,
        0, "2 of 2");
}

/* --- flows ------------------------------------------------------------------------------------ */

/* The return of a tensor whose limit rises with its own length: as that of one number. */
static void tensors_flow_with_their_length(void **state) {
  workplace *w = *state;
  drive(w,
        "&material model = '" SOURCE_DIR "/tests/generator/laws/coupled_point.plm' /\n"
        "&simulation steps = 7 /\n&point setting = 'space' test = 'uniaxial stress' /\n"
        "&path quantity = 'strain_xx' value = 0.02 rise = '1 s' /\n"
        "&expect quantity = 'stress_xx' formula = 'f_y + E*H/(E + H)*(0.02 - f_y/E)'" EXACT
        "&expect quantity = 'eps_bar' formula = '0.02 - sigma[x,x]/E'" EXACT,
        0, "2 of 2");
}

/* --- rates ------------------------------------------------------------------------------------ */

static const char kelvin_law[] =
    "model kelvin\n  law continuum\n  for plane_stress, plane_strain, space\n"
    "  parameter E = 1 [MPa] in (0, inf) \"modulus\"\n"
    "  parameter nu = 0.3 in [0, 0.5) \"Poisson's ratio\"\n"
    "  parameter tau = 1 [s] in [0, inf) \"relaxation time\"\n"
    "  parameter rho = 1000 [kg/m^3] in (0, inf) \"mass density\"\n"
    "  stress sigma = hooke(strain + tau*strain_rate, E, nu)\nend model\n";

/* Drawn evenly for t: E (e + tau e'), and E tau e'^2 t is lost. A stress that comes in one step of
   h and stays: steps of Euler backward, e_n = sigma/E (1 - (1 + h/tau)^-n). */
static void rates_cost_work(void **state) {
  workplace *w = *state;
  write_text(w, "kelvin.plm", kelvin_law);
#define KELVIN                                                                                     \
  "&material model = 'kelvin.plm' /\n&simulation steps = 100 end_time = '1 s' /\n"                 \
  "&point test = 'uniaxial stress' /\n"
  drive(w,
        KELVIN "&path quantity = 'strain_xx' value = 1e-3 rise = '1 s' /\n"
               "&expect quantity = 'stress_xx' at_time = 0.5 formula = 'E*1.5e-3' tolerance = "
               "1e-10 /\n"
               "&expect quantity = 'dissipated_damping' formula = 'E*1e-6' tolerance = 1e-10 /\n"
               "&expect quantity = 'stored' formula = 'E*1e-6/2' tolerance = 1e-10 /\n"
               "&expect quantity = 'imbalance' value = 0 absolute = '1e-10 J/m^3' /\n",
        0, "4 of 4");
  for (int space = 0; space < 2; space++)
    expect(w, space ? "drive path.nml --set point.setting=space --compiled" : "drive path.nml", 0,
           "4 of 4");
  drive(w,
        KELVIN "&path quantity = 'stress_xx' value = '1 kPa' history = 'ramp and hold' rise = "
               "'10 ms' /\n"
               "&expect quantity = 'strain_xx' formula = '1e-3*(1 - 1.01**(-100))' tolerance = "
               "1e-9 /\n"
               "&expect quantity = 'strain_yy' formula = '-nu*1e-3*(1 - 1.01**(-100))' tolerance "
               "= 1e-9 /\n",
        0, "2 of 2");
}

/* --- states ----------------------------------------------------------------------------------- */

/* Kinematic hardening drawn and pressed free of stress across: beyond f_y the slope is
   E_t = E H/(E + H), and the way back yields after 2 f_y. eps_p is without change of volume. Both
   kernels say the same to the bit. */
static void a_state_that_is_a_tensor(void **state) {
  workplace *w = *state;
  char text[2000];
  for (int space = 0; space < 2; space++) {
    snprintf(text, sizeof text,
             "&material model = '%s/tests/generator/laws/hardening_point.plm' /\n"
             "&point test = 'uniaxial stress' setting = '%s' /\n&simulation steps = 300 /\n"
             "&path quantity = 'strain_xx' times = 0, 1, 3 values = 0, 4e-3, '-4e-3' /\n"
             "&expect quantity = 'stress_xx' at_time = '1 s' formula = "
             "'f_y + E*H/(E + H)*(4e-3 - f_y/E)' tolerance = 1e-9 /\n"
             "&expect quantity = 'eps_p_xx' at_time = '1 s' formula = "
             "'4e-3 - (f_y + E*H/(E + H)*(4e-3 - f_y/E))/E' tolerance = 1e-9 /\n"
             "&expect quantity = 'eps_p_zz' at_time = '1 s' formula = "
             "'-(4e-3 - (f_y + E*H/(E + H)*(4e-3 - f_y/E))/E)/2' tolerance = 1e-9 /\n"
             "&expect quantity = 'stress_xx' formula = "
             "'-f_y + E*H/(E + H)*(4e-3 - f_y/E) - E*H/(E + H)*(8e-3 - 2*f_y/E)' tolerance = 1e-9 "
             "/\n"
             "&expect quantity = 'across' value = 0 absolute = 1e-15 /\n"
             "&expect quantity = 'imbalance' value = 0 absolute = '2 kJ/m^3' /\n",
             SOURCE_DIR, space ? "space" : "plane_stress");
    drive(w, text, 0, "6 of 6");
    expect(w, "drive path.nml --csv interpreted.csv", 0, "6 of 6");
    expect(w, "drive path.nml --compiled --csv compiled.csv", 0, "6 of 6");
    assert_int_equal(shell(w, "cmp interpreted.csv compiled.csv"), 0);
  }
}

/* --- ellipticity ------------------------------------------------------------------------------ */

/* omega = 1 - exp(-|e|/0.01), nu = 0: drawn along x the tangent there is 2 mu (1 - e/0.01)
   exp(-e/0.01); its end is the first, across x (all other directions come later). */
static void softening_loses_ellipticity(void **state) {
  workplace *w = *state;
  static const char *const settings[] = {"plane_strain", "space"};
  for (int k = 0; k < 2; k++) {
    char text[1000];
    snprintf(text, sizeof text,
             "&material model = '%s/tests/generator/laws/viscous.plm' nu = 0 tau = 0 E = '2 GPa' "
             "/\n&point setting = '%s' /\n"
             "&path quantity = 'strain_xx' value = 0.0202 rise = '1.01 s' /\n"
             "&simulation steps = 100 /\n"
             "&expect quantity = 'ellipticity' at_time = '0.5 s' value = 0 absolute = '1 Pa' /\n",
             SOURCE_DIR, settings[k]);
    drive(w, text, 0, "1 of 1");
    assert_non_null(strstr(w->said, "note: ellipticity is lost at 0.5"));
    assert_non_null(strstr(w->said, k ? "across n = (1, 0, 0)" : "across n = (1, 0)"));
    assert_non_null(strstr(w->said, "which opens"));
  }
  drive(w, ELASTIC TO_TEN, 0, "rows to 1 s");
  assert_null(strstr(w->said, "ellipticity is lost"));
}

enum { MOST = PL_MAX_STRAINS };

/* lambda, mu, less H times m x m of m = (x x - y y)/sqrt(2). */
static void soften_shear(int dimensions, double lambda, double mu, double H,
                         double tangent[MOST][MOST]) {
  const int normals = dimensions;
  for (int a = 0; a < MOST; a++)
    for (int b = 0; b < MOST; b++) {
      tangent[a][b] = a < normals && b < normals ? lambda : 0;
      if (a == b) tangent[a][b] += a < normals ? 2 * mu : mu;
      if (a < 2 && b < 2) tangent[a][b] -= (a == b ? 0.5 : -0.5) * H;
    }
}

/* It bands at 45 degrees, by shear, from H = 2 mu on: v = m.n has 1 - H v.A^-1.v = 0 there first.
   There A has the eigenvalue mu - H/2. */
static void a_band_of_shear(void **state) {
  (void)state;
  const double mu = 3, lambda = 5;
  for (int dimensions = 2; dimensions <= 3; dimensions++) {
    double tangent[MOST][MOST];
    soften_shear(dimensions, lambda, mu, 2.2 * mu, tangent);
    const ellipticity e = ellipticity_of(dimensions, (const double(*)[MOST])tangent);
    assert_true(fabs(e.least + 0.1 * mu) < 1e-12 * mu);
    assert_true(fabs(fabs(e.normal[0] * e.normal[1]) - 0.5) < 1e-9);
    assert_true(fabs(e.normal[0] * e.along[0] + e.normal[1] * e.along[1]) < 1e-6);
    assert_true(fabs(e.normal[2]) < 1e-6);
  }
}

/* Of an isotropic tangent the two speeds of waves, the slower one: mu, or lambda + 2 mu. */
static void isotropic_solids(void **state) {
  (void)state;
  for (int dimensions = 2; dimensions <= 3; dimensions++)
    for (int soft = 0; soft < 2; soft++) {
      double tangent[MOST][MOST];
      const double lambda = soft ? -1.5 : 2;
      soften_shear(dimensions, lambda, 1, 0, tangent);
      const ellipticity e = ellipticity_of(dimensions, (const double(*)[MOST])tangent);
      assert_true(fabs(e.least - (soft ? lambda + 2 : 1)) < 1e-12);
    }
}

/* A(n) of a tangent without symmetries, against directions in great number. */
static void any_tangent(void **state) {
  (void)state;
  static const double seed[MOST][MOST] = {
      {9, 2, 1, 0.4, -0.7, 0.3},     {1, 7, 2, 0.6, 0.2, -0.9},     {2, 1, 8, -0.3, 0.5, 0.8},
      {0.5, -0.2, 0.4, 2, 0.3, 0.1}, {-0.6, 0.3, 0.1, 0.2, 3, 0.4}, {0.2, 0.7, -0.5, 0.3, 0, 1}};
  static const int at[3][3] = {{0, 3, 5}, {3, 1, 4}, {5, 4, 2}};
  const ellipticity e = ellipticity_of(3, seed);
  double least = INFINITY;
  for (int n = 0; n < 200; n++)
    for (int m = 0; m < 400; m++) {
      const double up = M_PI / 2 * n / 199, round = 2 * M_PI * m / 400,
                   v[3] = {cos(up) * cos(round), cos(up) * sin(round), sin(up)};
      double sum = 0; /* along m of the band that is found */
      for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++)
          for (int k = 0; k < 3; k++)
            for (int l = 0; l < 3; l++)
              sum += e.along[i] * v[j] * seed[at[i][j]][at[k][l]] * e.along[k] * v[l];
      least = sum < least ? sum : least;
    }
  assert_true(e.least <= least + 1e-12);
  assert_true(e.least >= least - 1e-3);
}

/* --- refusals --------------------------------------------------------------------------------- */

static void bad_paths_are_explained(void **state) {
  workplace *w = *state;
  static const struct {
    const char *text, *part;
  } bad[] = {
      {ELASTIC "&path quantity = 'strain_zz' value = 1e-5 /\n",
       "a point in the plane is not driven by `strain_zz`"},
      {ELASTIC TO_TEN "&path quantity = 'stress_xx' value = '1 MPa' /\n",
       "`stress_xx` cannot be prescribed beside `strain_xx`"},
      {ELASTIC "&path quantity = 'stretch' value = 1e-5 /\n",
       "a law of a continuum is not driven by this quantity"},
      {ELASTIC "&point test = 'uniaxial stress' /\n&path quantity = 'strain_yy' value = 1e-5 /\n",
       "there is no such &path"},
      {ELASTIC "&point test = 'shear' /\n&path quantity = 'strain_xy' value = 1e-5 /\n" TO_TEN,
       "the test 'shear' is driven by `strain_xy` or `stress_xy` alone"},
      {ELASTIC "&point test = 'plane stress' /\n" TO_TEN, "is one of a point in space"},
      {ELASTIC "&point test = 'plane stress' setting = 'space' /\n"
               "&path quantity = 'stress_zz' value = '1 MPa' /\n" TO_TEN,
       "`stress_zz` is not driven"},
      {ELASTIC "&point test = 'uniaxial' /\n" TO_TEN, "uniaxial stress"},
      {ELASTIC "&point setting = 'plane' /\n" TO_TEN, "plane_stress"},
      {ELASTIC "&point size = 0 /\n" TO_TEN, "`size` must be greater than 0"},
      {ELASTIC "&path quantity = 'stress_xx' value = '1 mm' /\n", "`value` is a stress"},
      {"&material model = 'plane.plm' /\n&point setting = 'space' /\n" TO_TEN,
       "the law `plane` is not meant for space"},
      {"&material model = 'elastic_central' /\n"
       "&path quantity = 'stress_xx' value = '1 MPa' /\n",
       "a law of bonds is not driven by this quantity"},
      {"&material model = 'splm_elastic' /\n&path quantity = 'stress_xx' value = '1 MPa' /\n",
       "a law of families is not driven by this quantity"},
      {"&material model = 'lefm' /\n" TO_TEN, "`lefm` is a law of cracks"},
  };
  write_text(w, "plane.plm",
             "model plane\n  law continuum\n  for plane_stress\n"
             "  parameter E = 1 [MPa] in (0, inf) \"modulus\"\n"
             "  parameter rho = 1000 [kg/m^3] in (0, inf) \"mass density\"\n"
             "  stress sigma = hooke(strain, E, 0.2)\nend model\n");
  for (size_t k = 0; k < sizeof bad / sizeof *bad; k++)
    drive(w, bad[k].text, 1, bad[k].part);
}

/* More than a softening point bears: 2 GPa 0.01/e in the plane strained along x alone. */
static void a_stress_that_is_not_borne(void **state) {
  workplace *w = *state;
  char text[1000];
  static const char form[] =
      "&material model = '%s/tests/generator/laws/viscous.plm' nu = 0 tau = 0 E = '2 GPa' /\n"
      "&path quantity = 'stress_xx' value = '%s' rise = '1 s' /\n"
      "&expect quantity = 'stress_xx' value = '%s' /\n";
  snprintf(text, sizeof text, form, SOURCE_DIR, "7.3 MPa", "7.3 MPa"); /* 7.3576 is the largest */
  drive(w, text, 0, "1 of 1");
  snprintf(text, sizeof text, form, SOURCE_DIR, "7.5 MPa", "7.5 MPa");
  drive(w, text, 1, "no strain is found that gives a stress_xx of 7.");
  assert_non_null(strstr(w->said, "path.nml:2:"));
  assert_non_null(strstr(w->said, "a law is driven by strain (strain_xx)"));
}

static void results_can_be_read(void **state) {
  workplace *w = *state;
  char error[512], unit_text[32];
  long count;
  drive(w, ELASTIC "&output hdf5 = 'point.h5' picture = 'point.svg' /\n" TO_TEN, 0,
        "written point.svg");
  result_file *f = open_result_of(w, "point.h5");
  double *stress =
      result_read_series(f, "stress_xx", &count, unit_text, sizeof unit_text, error, sizeof error);
  assert_non_null(stress);
  assert_int_equal(count, 1001);
  assert_string_equal(unit_text, "Pa");
  assert_true(fabs(stress[1000] - 30e9 / (1 - 0.0625) * 1e-5) < 1e-3);
  free(stress);
  result_read_close(f);
  expect(w, "check path.nml", 0, "a path that drives one point of `elastic`");
}

/* Without `energy W` the stored energy of a law whose plastic strain moves the point without stress
   is the work from there; where nobody knows it, the law must say. */
static void stored_energy_without_a_law_of_it(void **state) {
  workplace *w = *state;
#define PERFECT(damage, stress)                                                                    \
  "model perfect\n  law continuum\n  for plane_stress, plane_strain, space\n"                      \
  "  parameter E = 200 [GPa] in (0, inf)\n  parameter nu = 0.3 in [0, 0.5)\n"                      \
  "  parameter f_y = 250 [MPa] in (0, inf)\n  parameter rho = 7850 [kg/m^3] in (0, inf)\n"         \
  "  state eps_p on point = deviator 0\n" damage "  trial = E/(1 + nu)*dev(strain - eps_p)\n"      \
  "  q = von_mises(trial)\n  slip = (q - f_y)*(1 + nu)/E/max(q, 1 [Pa])\n"                         \
  "  flow eps_p by slip*trial when q >= f_y\n"                                                     \
  "  stress sigma = " stress "hooke(strain - eps_p, E, nu)\nend model\n"
  write_text(w, "perfect.plm", PERFECT("", ""));
  write_text(w, "path.nml",
             "&simulation steps = 100 /\n&point test = 'uniaxial stress' setting = 'space' /\n"
             "&material model = 'perfect.plm' /\n"
             "&path quantity = 'strain_xx' times = 0, '1 s', '2 s' values = 0, 0.01, 0.00875 /\n"
             "&expect quantity = 'stress_xx' at_time = '1 s' formula = 'f_y' tolerance = 1e-9 /\n"
             "&expect quantity = 'stored' at_time = '1 s' formula = 'f_y**2/(2*E)' "
             "tolerance = 1e-9 /\n"
             "&expect quantity = 'stored' at_time = '2 s' value = 0 absolute = '1e-3 J/m^3' /\n");
  expect(w, "drive path.nml", 0, "3 of 3");
  expect(w, "drive path.nml --compiled", 0, "3 of 3");
  expect(w, "drive path.nml --set point.setting=plane_stress", 0, "3 of 3");
  write_text(w, "perfect.plm", PERFECT("  failed when strain[x,x] >= 0.015\n", ""));
  write_text(w, "path.nml",
             "&simulation steps = 100 /\n&point test = 'uniaxial stress' setting = 'space' /\n"
             "&material model = 'perfect.plm' /\n"
             "&path quantity = 'strain_xx' times = 0, '1 s', '2 s' values = 0, 0.01, 0.02 /\n"
             "&expect quantity = 'stored' at_time = '1 s' formula = 'f_y**2/(2*E)' "
             "tolerance = 1e-9 /\n"
             "&expect quantity = 'stored' at_time = '2 s' value = 0 absolute = '1e-9 J/m^3' /\n");
  expect(w, "drive path.nml", 0, "2 of 2");
  write_text(w, "perfect.plm",
             PERFECT("  damage D on point\n  D = 1 - exp(-(eps_p:eps_p))\n", "(1 - D)*"));
  expect(w, "check perfect.plm", 1, "what this law stores is not known");
}

/* Fibres in a matrix that has grown: the normal strains and the shear are coupled. In the plane the
   growth along z costs nothing that the plane could give back. */
static void stored_energy_of_coupled_strains(void **state) {
  workplace *w = *state;
  static const struct {
    const char *setting;
    double of_matrix; /* (strain - grown) : (strain - grown)/2 */
  } cases[] = {{"space", 1.5e-6}, {"plane_strain", 1e-6}, {"plane_stress", 1e-6}};
  write_text(w, "fibred.plm",
             "model fibred\n  law continuum\n  for plane_stress, plane_strain, space, anisotropic\n"
             "  parameter E = 1 [GPa] in (0, inf)\n  parameter C = 2 [GPa] in [0, inf)\n"
             "  parameter rho = 1000 [kg/m^3] in (0, inf)\n"
             "  state grown on point = 0\n  grown = grown\n"
             "  free  = strain - grown*tensor(1, 1, 1, 0)\n"
             "  fibre = tensor(0.75, 0.25, 0, sqrt(3)/4)\n"
             "  stress sigma = hooke(free, E, 0) + C*(fibre:free)*fibre\nend model\n");
  for (int k = 0; k < 3; k++) {
    char text[600];
    snprintf(text, sizeof text,
             "&point setting = '%s' /\n&material model = 'fibred.plm' /\n&initial grown = 1e-3 /\n"
             "&path quantity = 'strain_xx' value = 2e-3 rise = '1 s' /\n"
             "&expect quantity = 'stored' formula = '%g*E + C*5e-4**2/2' tolerance = 1e-9 /\n",
             cases[k].setting, cases[k].of_matrix);
    write_text(w, "path.nml", text);
    expect(w, "drive path.nml", 0, "1 of 1");
    expect(w, "drive path.nml --compiled", 0, "1 of 1");
  }
}

/* A stress along z that a state holds moves the plane where z is free: z follows by
   -p (1 + nu)(1 - 2 nu)/(1 - nu)/E, which leaves -p nu/(1 - nu) along x and y. */
static void stored_energy_of_a_stress_along_z(void **state) {
  workplace *w = *state;
  write_text(w, "held.plm",
             "model held\n  law continuum\n  for plane_stress, anisotropic\n"
             "  parameter E = 1 [GPa] in (0, inf)\n  parameter nu = 0.25 in [0, 0.5)\n"
             "  parameter rho = 1000 [kg/m^3] in (0, inf)\n"
             "  state p on point = 0 [MPa]\n  p = p\n"
             "  stress sigma = hooke(strain, E, nu) + p*tensor(0, 0, 1, 0)\n"
             "  output given = p\nend model\n");
  write_text(w, "path.nml",
             "&point setting = 'plane_stress' /\n&material model = 'held.plm' /\n"
             "&initial p = '2 MPa' /\n&path quantity = 'strain_xx' value = 0 rise = '1 s' /\n"
             "&expect quantity = 'stress_xx' formula = '-nu/(1 - nu)*given' tolerance = 1e-9 /\n"
             "&expect quantity = 'stored' formula = 'nu**2/(1 - nu)*given**2/E' "
             "tolerance = 1e-9 /\n");
  expect(w, "drive path.nml", 0, "2 of 2");
}

/* The graph of sqrt(wear**2) - wear does not show that it is 0: numbers do, and the energy is the
   work of the straight path from no strain. */
static void stored_energy_where_numbers_tell(void **state) {
  workplace *w = *state;
  write_text(
      w, "path.nml",
      "&point setting = 'space' /\n&material model = '" SOURCE_DIR
      "/tests/generator/check/physics/legal_rounded_opening.plm' nu = 0 /\n"
      "&initial wear = 2e-3 /\n"
      "&path quantity = 'strain_xx' value = 2e-3 rise = '1 s' /\n"
      "&expect quantity = 'stored' tolerance = 1e-6\n"
      "  formula = 'E*2e-3**2*(1/2 + (sqrt(2) + log(1 + sqrt(2)) - 1)/40)' /\n");
  expect(w, "drive path.nml", 0, "1 of 1");
}

int main(void) {
#define T(test) cmocka_unit_test_setup_teardown(test, set_up_workplace, tear_down_workplace)
  const struct CMUnitTest tests[] = {
      T(tensors_flow_with_their_length),
      T(hooke_in_every_test),
      T(strains_and_stresses_mix),
      T(a_table_drives_a_stress),
      T(rates_cost_work),
      T(a_state_that_is_a_tensor),
      T(softening_loses_ellipticity),
      cmocka_unit_test(a_band_of_shear),
      cmocka_unit_test(isotropic_solids),
      cmocka_unit_test(any_tangent),
      T(bad_paths_are_explained),
      T(a_stress_that_is_not_borne),
      T(results_can_be_read),
      T(stored_energy_without_a_law_of_it),
      T(stored_energy_of_coupled_strains),
      T(stored_energy_of_a_stress_along_z),
      T(stored_energy_where_numbers_tell),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
