/* What a deck is told that does not fit its body or its law. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "tests/runtime/small_run.h"

typedef struct misfit {
  const char *groups;
  diag_code code;
  const char *text; /* part of the message */
} misfit;

#define BLOCK                                                                                      \
  "&lattice name = 'c' kind = 'hexagonal' spacing = 0.01 thickness = 0.1 /\n"                      \
  "&body lattice = 'c' shape = 'rectangle' corner = 0, 0 size = 0.1, 0.1 /\n"                      \
  "&region name = 'corner' shape = 'point' at = 0, 0 /\n"                                          \
  "&region name = 'edge' shape = 'rectangle' corner = 0, 0 size = 0.1, 0.001 /\n"
#define RUN "&simulation end_time = 1e-4 /\n"
#define LAW "&material lattice = 'c' model = 'm' /\n"
#define USE "&support region = 'corner' fix = 'x' /\n&protect region = 'edge' /\n"

static const misfit misfits[] = {
    {RUN LAW BLOCK USE "&region name = 'far' shape = 'disc' centre = 1, 1 radius = 0.01 /\n",
     DIAG_EMPTY_REGION, "region `far` holds no particle"},
    {RUN LAW BLOCK "&support region = 'corner' fix = 'x' /\n", DIAG_DECK_WARNING,
     "region `edge` is never used"},
    {RUN LAW BLOCK "&support region = 'edge' fix = 'y' /\n&drive region = 'corner' component = 'y' "
                   "velocity = 1 /\n",
     DIAG_CONFLICT, "the particle at (0, 0) mm has its motion in y prescribed twice"},
    {RUN LAW BLOCK "&drive region = 'edge' component = 'x' velocity = 1 /\n"
                   "&drive region = 'corner' component = 'x' velocity = 2 /\n",
     DIAG_CONFLICT, "prescribed twice"},
    {RUN LAW BLOCK USE "&support region = 'edge' fix = 'rotation' /\n", DIAG_BAD_VALUE,
     "do not rotate"},
    {RUN LAW BLOCK USE "&point_mass region = 'edge' mass = 3 inertia = 2 /\n", DIAG_BAD_VALUE,
     "do not rotate"},
    {RUN LAW BLOCK USE "&region name = 'far' shape = 'disc' centre = 9, 9 radius = 1 /\n"
                       "&point_mass region = 'far' mass = 3 /\n",
     DIAG_EMPTY_REGION, "region `far` holds no particle"},
    {RUN LAW BLOCK USE "&force region = 'edge' component = 'x' per_length = 3 /\n"
                       "&force region = 'corner' component = 'x' per_length = 3 /\n",
     DIAG_BAD_VALUE, "region `corner` holds one particle"},
    {RUN LAW BLOCK USE "&end_moment region = 'edge' moment = 3 /\n", DIAG_BAD_VALUE,
     "lie at one height"},
    {RUN LAW BLOCK USE "&output fields = 'displacment' /\n", DIAG_BAD_VALUE,
     "no field `displacment`"},
    {RUN LAW BLOCK USE "&output fields = 'energy' /\n", DIAG_BAD_VALUE, "no field `energy`"},
    {RUN LAW BLOCK USE "&output energy = .false. fields = 'dissipated' /\n", DIAG_DECK_WARNING,
     "no `dissipated` to store"},
    {RUN LAW BLOCK USE "&monitor name = 'n' kind = 'broken' above = 1.5 /\n", DIAG_OUT_OF_BOUNDS,
     "greater than 0 and at most 1"},
    {RUN LAW BLOCK USE "&monitor name = 'n' kind = 'broken' above = 0 /\n", DIAG_OUT_OF_BOUNDS,
     "greater than 0 and at most 1"},
    {RUN LAW BLOCK USE "&force region = 'edge' component = 'y' total = 3 /\n"
                       "&monitor name = 'n' kind = 'applied' region = 'edge' component = 'x' /\n",
     DIAG_CONFLICT, "no `&force` or `&end_moment` acts along `x` on particles of `edge`"},
    {RUN LAW BLOCK USE "&monitor name = 'n' kind = 'stress' at = 0.12, 0 component = 'xx' /\n",
     DIAG_EMPTY_REGION, "no particle stands within a spacing of `at`"},
    {RUN LAW BLOCK USE "&body lattice = 'c' shape = 'point' at = 0.11, 0 /\n"
                       "&monitor name = 'n' kind = 'strain' at = 0.11, 0 component = 'xx' /\n",
     DIAG_EMPTY_REGION, "there is no strain: the bonds of each particle lie on a line"},
    {RUN LAW BLOCK USE "&monitor name = 'n' kind = 'force' at = 0.12, 0 normal = 1, 0 /\n",
     DIAG_EMPTY_REGION, "no bond crosses this section"},
    {RUN LAW BLOCK USE "&monitor name = 'n' kind = 'force' at = 0.05, 0 normal = 1, 0 "
                       "region = 'corner' /\n",
     DIAG_EMPTY_REGION, "no bond crosses this section"},
    {RUN LAW BLOCK USE "&monitor name = 'n' kind = 'crack_width' from = 0.01, 0.01 "
                       "to = 0.5, 0.01 /\n",
     DIAG_EMPTY_REGION, "the line leaves the lattice at "},
    {RUN LAW BLOCK USE "&monitor name = 'n' kind = 'tip' at = 0.1, 0 direction = 1, 0 "
                       "above = 0.5 /\n",
     DIAG_EMPTY_REGION, "the way of the crack would always be 0"},
    {"&simulation end_time = 1e-4 step = 1e-7 /\n" LAW BLOCK USE
     "&monitor name = 'n' kind = 'tip_speed' at = 0, 0 direction = 1, 0 above = 0.5 "
     "average = 1e-7 /\n",
     DIAG_OUT_OF_BOUNDS, "a speed is taken over two states at least: 2e-07 s and more"},
    {RUN LAW BLOCK USE "&monitor name = 'n' kind = 'acceleration' region = 'edge' "
                       "component = 'rotation' /\n",
     DIAG_BAD_VALUE, "do not rotate"},
    {RUN LAW BLOCK USE "&monitor name = 'n' kind = 'acceleration' at = 0, 0 "
                       "component = 'rotation' /\n",
     DIAG_BAD_VALUE, "do not rotate"},
    {RUN LAW BLOCK USE "&output fields = 'stress_zz' /\n", DIAG_BAD_VALUE,
     "there is no field `stress_zz` to store"},
    {RUN "&lattice name = 'stress_xx' kind = 'square' spacing = 1 thickness = 1 /\n",
     DIAG_RESERVED_NAME, "a lattice cannot be called `stress_xx`"},
    {RUN LAW BLOCK USE "&output fields = 'rotation' /\n", DIAG_DECK_WARNING,
     "no `rotation` to store"},
    {"&simulation end_time = 1e-4 step = 1e-5 /\n" LAW BLOCK USE, DIAG_UNSTABLE_STEP,
     "is unstable: the largest"},
    {RUN "&material lattice = 'c' model = 'm' Nu = 0.4 /\n" BLOCK USE, DIAG_OUT_OF_BOUNDS,
     "`nu` = 0.4 is not in [0, 0.33333333], the range of the law `elastic_bar`"},
    {RUN "&material lattice = 'c' model = 'm' E = -3e9 /\n" BLOCK USE, DIAG_OUT_OF_BOUNDS,
     "`E` = -3e+09 Pa is not in (0, inf)"},
    {RUN "&material lattice = 'c' model = 'm' E = '30 mm' /\n" BLOCK USE, DIAG_UNITS, "`E` needs"},
    {RUN "&material lattice = 'c' model = 'm' rhoo = 3 /\n" BLOCK USE, DIAG_UNKNOWN_KEY,
     "no parameter `rhoo`"},
    {RUN "&material lattice = 'c' model = 'm' E = 'stiff' /\n" BLOCK USE, DIAG_BAD_VALUE,
     "needs a number"},
};

static bool said(const small_run *r, const misfit *m) {
  for (int k = 0; k < r->said.count; k++)
    if (r->said.items[k].code == m->code && strstr(r->said.items[k].message, m->text)) return true;
  return false;
}

static void misfits_are_told_at_their_line(void **state) {
  (void)state;
  for (size_t k = 0; k < sizeof misfits / sizeof *misfits; k++) {
    small_run r;
    small_open(&r, &elastic_bar, misfits[k].groups);
    if (!said(&r, &misfits[k])) {
      print_error("case %zu: expected \"%s\"\n", k, misfits[k].text);
      small_print(&r);
      fail();
    }
    if (getenv("PERILAT_SHOW")) small_print(&r);
    const bool warning = diag_severity(misfits[k].code) == SEVERITY_WARNING;
    assert_int_equal(r.simulation != NULL, warning);
    small_close(&r);
  }
}

/* The caret stands under the word that is wrong; the hint lists what this law can store. */
static void an_unknown_field_is_answered_with_the_known_ones(void **state) {
  (void)state;
  static const char text[] =
      RUN LAW BLOCK USE "&output fields = 'damage', 'toughness', 'energy' /\n";
  small_run r;
  small_open(&r, &elastic_bar, text);
  assert_null(r.simulation);
  assert_int_equal(r.said.count, 2);
  static const char *const words[] = {"'toughness'", "'energy'"};
  for (int k = 0; k < 2; k++) {
    const span where = r.said.items[k].where;
    assert_int_equal(where.end - where.begin, strlen(words[k]));
    assert_memory_equal(text + where.begin, words[k], strlen(words[k]));
  }
  assert_string_equal(r.said.items[0].hint,
                      "this run can store `displacement`, `velocity`, `force`, `damage`, "
                      "`dissipated`, `stress`, `strain`, `omega`, `axial`");
  assert_non_null(strstr(r.said.items[1].hint, "is `dissipated`"));
  small_close(&r);
}

static void parameters_are_matched_without_case(void **state) {
  (void)state;
  small_run r;
  small_open(&r, &elastic_beam,
             RUN "&material lattice = 'c' model = 'm' e = '20 GPa' s_T = 1e-3 /\n" BLOCK USE);
  if (!r.simulation) small_print(&r);
  assert_non_null(r.simulation);
  assert_true(r.parameters[ELASTIC_E] == 20e9);
  assert_true(r.parameters[ELASTIC_S_T] == 1e-3);
  assert_true(r.parameters[ELASTIC_NU] == 0.2); /* default */
  small_close(&r);
}

static void a_value_without_default_is_asked_for(void **state) {
  (void)state;
  pl_law strict = elastic_bar;
  pl_parameter table[ELASTIC_PARAMETERS];
  memcpy(table, elastic_parameters, sizeof table);
  table[ELASTIC_E].has_default = table[ELASTIC_NU].has_default = 0;
  strict.parameters = table;
  small_run r;
  small_open(&r, &strict, RUN "&material lattice = 'c' model = 'm' nu = 0.1 /\n" BLOCK USE);
  assert_null(r.simulation);
  assert_int_equal(r.said.count, 1);
  assert_int_equal(r.said.items[0].code, DIAG_MISSING_KEY);
  assert_string_equal(r.said.items[0].message,
                      "the law `elastic_bar` needs a value for `E` (Young's modulus)");
  small_close(&r);
}

static void a_law_without_density_is_refused(void **state) {
  (void)state;
  pl_law massless = elastic_bar;
  pl_parameter renamed[ELASTIC_PARAMETERS];
  memcpy(renamed, elastic_parameters, sizeof renamed);
  renamed[ELASTIC_RHO].name = "density";
  massless.parameters = renamed;
  massless.density = -1;
  small_run r;
  small_open(&r, &massless, RUN LAW BLOCK USE);
  assert_null(r.simulation);
  assert_string_equal(
      r.said.items[0].message,
      "the law `elastic_bar` has no parameter `rho`, so its particles have no mass");
  small_close(&r);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(misfits_are_told_at_their_line),
      cmocka_unit_test(an_unknown_field_is_answered_with_the_known_ones),
      cmocka_unit_test(parameters_are_matched_without_case),
      cmocka_unit_test(a_value_without_default_is_asked_for),
      cmocka_unit_test(a_law_without_density_is_refused),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
