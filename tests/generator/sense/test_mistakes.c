/* Realistic mistakes, tests/mistakes/NNN_name.plm, each beside a legal law that differs
   in the mistake alone: how many are met with an error, how many with a warning, how many pass, and
   whether any legal law, of these, of models/ or of the course, is spoken of. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>
#include <glob.h>
#include <stdlib.h>
#include <string.h>

#include "generator/facts/law_judged.h"
#include "generator/kernel/model.h"

/* What is reached; a change that meets fewer of them has lost something. */
enum { MISTAKES = 106, LEAST_CAUGHT = 28, LEAST_MET = 103 };

typedef struct verdict {
  int errors, warnings;
} verdict;

/* As `perilat check` has it. */
static verdict judge(const char *path, bool print) {
  model m;
  verdict v = {0, 0};
  if (model_open(&m, path, NULL, 0)) law_obeys(m.law, NULL, &m.said, NULL);
  for (int k = 0; k < m.said.count; k++) {
    const bool error = diag_severity(m.said.items[k].code) == SEVERITY_ERROR;
    v.errors += error;
    v.warnings += !error;
  }
  if (print && m.said.count) diag_print(&m.said, stderr);
  model_close(&m);
  return v;
}

static void list(const char *pattern, glob_t *found) {
  assert_int_equal(glob(pattern, 0, NULL, found), 0);
}

static bool is_twin(const char *path) {
  return strstr(path, ".legal.plm") != NULL;
}

static void most_mistakes_are_met(void **state) {
  (void)state;
  glob_t found;
  int caught = 0, warned = 0, silent = 0;
  list(SOURCE_DIR "/tests/mistakes/*.plm", &found);
  for (size_t k = 0; k < found.gl_pathc; k++) {
    if (is_twin(found.gl_pathv[k])) continue;
    const verdict v = judge(found.gl_pathv[k], false);
    caught += v.errors > 0;
    warned += v.errors == 0 && v.warnings > 0;
    silent += v.errors + v.warnings == 0;
    if (v.errors + v.warnings == 0)
      print_message("silent: %s\n", strrchr(found.gl_pathv[k], '/') + 1);
  }
  globfree(&found);
  print_message("caught %d warned %d silent %d\n", caught, warned, silent);
  assert_int_equal(caught + warned + silent, MISTAKES);
  assert_true(caught >= LEAST_CAUGHT);
  assert_true(caught + warned >= LEAST_MET);
}

/* --- by the check that is meant for it -------------------------------------------------------- */

static const struct {
  const char *mistake, *code, *words; /* part of the message, or NULL */
} meant[] = {
    {"001_spring_without_root", "patch", "34.64 GPa, not 30 GPa"}, /* 2/sqrt(3) of 30 GPa */
    {"004_energy_without_half", "patch", "60 GPa, not 30 GPa"},
    {"006_both_moments_halved", "patch", NULL},
    {"012_thickness_for_length", "patch", NULL},
    {"080_bulk_modulus_without_two", "patch", NULL},
    {"084_shear_modulus_without_two", "patch", NULL},
    {"021_modulus_with_exponent_and_unit", "absurd-value", "`E`"},
    {"022_density_in_grams", "absurd-value", "`rho`"},
    {"028_strength_in_pascal", "absurd-value", "so weak"},
    {"027_strength_in_gigapascal", "absurd-value", "0.1 of `E`"},
    {"029_fracture_energy_in_newton_per_mm", "absurd-value", "266.7 m"}, /* E G/f^2 = 266.7 m */
    {"032_yield_in_gigapascal", "absurd-value", "1.5 of `E`"},
    {"035_toughness_with_exponent", "absurd-value", "`K_Ic`"},
    {"025_modulus_without_unit", "units", "`E` has no unit"},
    {"037_friction_in_degrees", "degrees", "`phi` = 35"},
    {"038_friction_turned_to_degrees", "degrees", "= 35 "},
    {"039_damage_only_in_output", "elastic", "never changes"},
    {"040_damage_only_in_compression", "elastic", "drawn out"},
    {"042_damage_not_in_the_moments", "elastic", "bent"},
    {"047_kappa_is_the_least", "elastic", NULL},
    {"070_flow_never", "elastic", "never moves"},
    {"088_threshold_upside_down", "elastic", "never changes"},
    {"095_breaks_in_compression", "elastic", "neither pulled nor pushed"},
    {"044_force_above_the_damage", "one-step-late", NULL},
    {"048_kappa_of_last_step", "one-step-late", NULL},
    {"064_force_of_trial", "one-step-late", NULL},
    {"082_family_reads_old_plastic", "one-step-late", "`S_p`"},
    {"092_stress_of_trial_strain", "one-step-late", NULL},
    {"049_damage_is_no_state", "reversible", NULL},
    {"053_guards_in_wrong_order", "never-taken", NULL},
    {"055_knee_never_reached", "never-taken", NULL},
    {"065_flow_of_half", "step-dependent", "removes 0.5 "},
    {"066_flow_without_hardening", "step-dependent", "removes 1.1 "}, /* (E + H)/E */
    {"069_energy_without_hardening", "locked-energy", NULL},
    {"101_stiffness_by_the_step", "step-dependent", "reads `dt`"},
    {"102_force_with_previous_creep", "one-step-late", "the force"},
    {"103_energy_without_creeping_spring", "locked-energy", "drawn out"},
    {"104_stress_with_previous_creep", "one-step-late", "the stress"},
    {"105_energy_of_point_without_creeping_spring", "locked-energy", "sheared"},
    {"106_family_with_previous_creep", "one-step-late", "before its rate"},
    {"094_energy_without_kinematic_hardening", "locked-energy", NULL},
    {"071_stress_as_state", "stress-state", "`stress_old`"},
    {"076_nonlocal_own_value", "own-value", "`eq`"},
    {"058_fracture_energy_without_two", "named-value", "40 N/m"}, /* along the rows, of 80 N/m */
    {"089_crack_band_without_half", "named-value", "`G_f` is 100 N/m"},
    {"090_yield_without_two_thirds", "named-value", "`f_y`"},
    {"091_root_of_a_half_without_brackets", "precedence", NULL},
    {"097_tip_turns_the_wrong_way", "crack-direction", NULL},
    {"099_tip_in_degrees", "degrees", "half a turn"},
};

static bool is_met_by(const diagnostics *said, const char *code, const char *words) {
  for (int k = 0; k < said->count; k++)
    if (strcmp(diag_name(said->items[k].code), code) == 0)
      return !words || strstr(said->items[k].message, words);
  return false;
}

static void the_check_that_is_meant_speaks(void **state) {
  (void)state;
  int wrong = 0;
  for (size_t k = 0; k < sizeof meant / sizeof *meant; k++) {
    char path[4096];
    model m;
    snprintf(path, sizeof path, "%s/tests/mistakes/%s.plm", SOURCE_DIR, meant[k].mistake);
    if (model_open(&m, path, NULL, 0)) law_obeys(m.law, NULL, &m.said, NULL);
    if (!is_met_by(&m.said, meant[k].code, meant[k].words)) {
      print_error("%s is not met by %s, \"%s\", but by:\n", meant[k].mistake, meant[k].code,
                  meant[k].words ? meant[k].words : "");
      diag_print(&m.said, stderr);
      wrong++;
    }
    model_close(&m);
  }
  assert_int_equal(wrong, 0);
}

/* A name that is built in draws one error, and a parameter without its unit, too. */
static void one_slip_draws_one_error(void **state) {
  (void)state;
  static const char *const laws[] = {"tests/mistakes/100_reserved_name.plm",
                                     "tests/mistakes/025_modulus_without_unit.plm"};
  for (int k = 0; k < 2; k++) {
    char path[4096];
    snprintf(path, sizeof path, "%s/%s", SOURCE_DIR, laws[k]);
    assert_int_equal(judge(path, false).errors, 1);
  }
}

/* The text below the first line; to be freed. */
static char *text_below(const char *path) {
  char error[256];
  size_t length;
  char *text = read_text_file(path, MODEL_LIMIT, &length, error, sizeof error);
  assert_non_null(text);
  char *below = strdup(strchr(text, '\n') + 1);
  free(text);
  return below;
}

/* Most twins are the same law: each text is judged once. */
static void no_twin_is_spoken_of(void **state) {
  (void)state;
  glob_t found;
  char *judged[MISTAKES];
  int count = 0, spoken = 0, twins = 0;
  list(SOURCE_DIR "/tests/mistakes/*.legal.plm", &found);
  for (size_t k = 0; k < found.gl_pathc; k++) {
    char *text = text_below(found.gl_pathv[k]);
    bool known = false;
    for (int q = 0; q < count && !known; q++)
      known = strcmp(judged[q], text) == 0;
    twins++;
    if (known) {
      free(text);
      continue;
    }
    judged[count++] = text;
    const verdict v = judge(found.gl_pathv[k], true);
    spoken += v.errors + v.warnings > 0;
  }
  for (int q = 0; q < count; q++)
    free(judged[q]);
  globfree(&found);
  print_message("false %d of %d legal twins, %d of them different\n", spoken, twins, count);
  assert_int_equal(twins, MISTAKES);
  assert_int_equal(spoken, 0);
}

static void no_law_that_comes_along_is_spoken_of(void **state) {
  (void)state;
  static const char *const patterns[] = {"/models/*.plm", "/generator/templates/*.plm",
                                         "/examples/course/*/teacher/solution.plm"};
  int spoken = 0, laws = 0;
  for (size_t p = 0; p < sizeof patterns / sizeof *patterns; p++) {
    char pattern[4096];
    glob_t found;
    snprintf(pattern, sizeof pattern, "%s%s", SOURCE_DIR, patterns[p]);
    list(pattern, &found);
    for (size_t k = 0; k < found.gl_pathc; k++, laws++) {
      const verdict v = judge(found.gl_pathv[k], true);
      spoken += v.errors + v.warnings > 0;
    }
    globfree(&found);
  }
  print_message("false %d of %d laws that come along\n", spoken, laws);
  assert_int_equal(spoken, 0);
}

/* A mistake and its twin differ in one place at least, and the first line says in which. */
static void each_mistake_has_its_twin(void **state) {
  (void)state;
  glob_t found;
  list(SOURCE_DIR "/tests/mistakes/*.legal.plm", &found);
  for (size_t k = 0; k < found.gl_pathc; k++) {
    char wrong[4096];
    const char *twin = found.gl_pathv[k];
    snprintf(wrong, sizeof wrong, "%.*s.plm", (int)(strlen(twin) - strlen(".legal.plm")), twin);
    char *right_text = text_below(twin), *wrong_text = text_below(wrong);
    assert_string_not_equal(right_text, wrong_text);
    free(right_text);
    free(wrong_text);
  }
  globfree(&found);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(each_mistake_has_its_twin),
      cmocka_unit_test(most_mistakes_are_met),
      cmocka_unit_test(the_check_that_is_meant_speaks),
      cmocka_unit_test(one_slip_draws_one_error),
      cmocka_unit_test(no_twin_is_spoken_of),
      cmocka_unit_test(no_law_that_comes_along_is_spoken_of),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
