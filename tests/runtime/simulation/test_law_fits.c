/* Whether a law suits its deck: each misfit is told once, at the key that could mend it, and what
   fits is passed without a word. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "runtime/parts/law_fits.h"
#include "runtime/simulation/fields_fit.h"
#include "tests/runtime/built_rows.h"
#include "tests/runtime/elastic_law.h"
#include "tests/runtime/family_law.h"
#include "tests/runtime/spring_law.h"

#define REST "&simulation end_time = 1e-4 /\n&material lattice = 'c' model = 'm' /\n"
#define PLANE(keys)                                                                                \
  REST "&lattice name = 'c' spacing = 0.01 thickness = 0.1 " keys " /\n"                           \
       "&body lattice = 'c' shape = 'rectangle' corner = 0, 0 size = 0.1, 0.1 /\n"
#define SPACE                                                                                      \
  REST "&lattice name = 'c' kind = 'cubic' spacing = 0.01 /\n"                                     \
       "&body lattice = 'c' shape = 'box' corner = 3*0 size = 3*0.04 /\n"
#define NEAREST "kind = 'hexagonal'"

/* The last message stands at `word` of the deck, and says `sentence`. */
static void check_said(const built_rows *b, const char *text, const char *word,
                       const char *sentence) {
  assert_int_equal(b->said.count, 1);
  const diagnostic *last = &b->said.items[0];
  assert_ptr_equal(text + last->where.begin, strstr(text, word));
  if (!strstr(last->message, sentence)) fail_msg("%s, not: %s", last->message, sentence);
}

/* Laws, decks, and the key at which the misfit is told; NULL: they fit. */
static void a_law_is_of_its_lattice(void **state) {
  (void)state;
  pl_law for_four = family_hexagon, for_lists = family_for_lists(&family_hexagon);
  for_four.neighbours = 4;
  const struct {
    const pl_law *law;
    const char *deck, *at, *sentence;
  } cases[] = {
      {&elastic_beam, PLANE(NEAREST), NULL, NULL},
      {&family_hexagon, PLANE(NEAREST), NULL, NULL},
      {&family_hexagon, PLANE("kind = 'square'"), NULL, NULL},
      {&springs, SPACE, NULL, NULL},
      {&springs, PLANE(NEAREST), "'hexagonal'",
       "`springs` is of space, the lattice is in the plane"},
      {&elastic_bar, SPACE, "'cubic'", "`elastic_bar` is of the plane, the lattice is in space"},
      {&elastic_beam, PLANE("kind = 'square'"), "'square'",
       "runs on a hexagonal lattice of nearest"},
      {&elastic_beam, PLANE(NEAREST " horizon = 2.1"), "2.1", "of nearest neighbours"},
      {&elastic_beam, PLANE(NEAREST " shells = 2"), "2 /\n", "of nearest neighbours"},
      {&for_four, PLANE(NEAREST " shells = 2"), "2 /\n", "built for 4 neighbours, not 12"},
      {&for_lists, PLANE(NEAREST), "'hexagonal'", "for particles that stand on no lattice"},
      {&family_hexagon, PLANE("kind = 'blue_noise' neighbours = 6"), "'blue_noise'",
       "for particles that stand on a lattice"},
      {&elastic_beam, PLANE("kind = 'blue_noise' neighbours = 6"), "'blue_noise'",
       "as a law of bonds `elastic_beam` runs on a hexagonal lattice"},
  };
  for (size_t k = 0; k < sizeof cases / sizeof *cases; k++) {
    built_rows b;
    build_rows(&b, cases[k].deck);
    const bool fits = law_fits_lattice(cases[k].law, NULL, b.deck, 0, b.rows, &b.said);
    if (fits == (cases[k].at != NULL)) fail_msg("case %zu: %s", k, fits ? "fits" : "does not");
    if (cases[k].at)
      check_said(&b, cases[k].deck, cases[k].at, cases[k].sentence);
    else
      assert_int_equal(b.said.count, 0);
    built_end(&b);
  }
}

/* The message stands at the word `model`, and names the parameter that was meant. */
static void a_law_without_density_has_no_mass(void **state) {
  (void)state;
  pl_law law = elastic_bar;
  pl_parameter named[ELASTIC_PARAMETERS];
  memcpy(named, elastic_parameters, sizeof named);
  law.parameters = named;
  built_rows b;
  read_deck(&b, PLANE(NEAREST));
  assert_true(law_fits_motion(&law, b.deck, 0, &b.said));
  law.density = -1;
  named[ELASTIC_RHO].name = "Rho";
  assert_false(law_fits_motion(&law, b.deck, 0, &b.said));
  check_said(&b, PLANE(NEAREST), "'m'", "no parameter `rho`");
  assert_non_null(strstr(b.said.items[0].hint, "write `rho` for `Rho`"));
  named[ELASTIC_RHO].name = "density";
  assert_false(law_fits_motion(&law, b.deck, 0, &b.said));
  assert_non_null(strstr(b.said.items[1].hint, "add a mass density"));
  built_end(&b);
}

/* Only laws with states, none of them a damage, are told. */
static void protection_is_for_damage(void **state) {
  (void)state;
  static const char text[] =
      PLANE(NEAREST) "&region name = 'r' shape = 'point' at = 0, 0 /\n&protect region = 'r' /\n";
  pl_field plain[] = {elastic_fields[0]};
  pl_law softening = elastic_bar;
  softening.fields = plain;
  built_rows b;
  read_deck(&b, text);
  assert_int_equal(b.said.count, 0);
  law_fits_protection(&softening, b.deck, 0, &b.said);
  law_fits_protection(&springs, b.deck, 0, &b.said); /* without states */
  assert_int_equal(b.said.count, 0);
  plain[0].kind = PL_FIELD_STATE;
  law_fits_protection(&softening, b.deck, 0, &b.said);
  check_said(&b, text, "&protect", "has no damage that could be held back");
  assert_int_equal(b.said.errors, 0);
  built_end(&b);
}

/* Beside the fields of particles stand `time` and the folder of the bonds, named as the lattice. */
static void fields_are_named_once_in_a_result(void **state) {
  (void)state;
  const frame_field fields[] = {{.name = "velocity", .kind = "other"},
                                {.name = "velocity", .kind = "output"},
                                {.name = "time", .kind = "state"},
                                {.name = "c", .kind = "state"},
                                {.name = "time", .kind = "state", .on_bonds = true},
                                {.name = "c", .kind = "damage", .on_bonds = true},
                                {.name = "stress", .kind = "output"}};
  run_law law = {.law = &elastic_bar};
  const run_body bar = {.law = &elastic_bar, .laws = &law, .law_count = 1};
  built_rows b;
  read_deck(&b, PLANE(NEAREST));
  law.from = b.deck->interactions;
  assert_true(fields_fit_result(b.deck, &bar, fields + 4, 3, &b.said));
  assert_true(fields_fit_result(b.deck, &bar, fields, 1, &b.said));
  assert_int_equal(b.said.count, 0);
  const frame_field parameter[] = {{.name = "c", .kind = "other", .of_law = true}, fields[5]};
  assert_false(fields_fit_result(b.deck, &bar, parameter, 2, &b.said)); /* stands in frames, too */
  diag_clear(&b.said);
  diag_begin(&b.said, &b.sources);
  assert_false(fields_fit_result(b.deck, &bar, fields, 7, &b.said));
  assert_int_equal(b.said.count, 3);
  static const char *const refused[] = {"`velocity` of", "`time` of", "`c` of"};
  for (int k = 0; k < 3; k++) {
    assert_int_equal(b.said.items[k].code, DIAG_RESERVED_NAME);
    assert_memory_equal(b.said.items[k].message, refused[k], strlen(refused[k]));
  }
  built_end(&b);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(a_law_is_of_its_lattice),
      cmocka_unit_test(a_law_without_density_has_no_mass),
      cmocka_unit_test(protection_is_for_damage),
      cmocka_unit_test(fields_are_named_once_in_a_result),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
