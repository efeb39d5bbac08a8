/* Fields of frames, and counts of damaged bonds: of one and of several damages, with bonds that
   are protected. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "runtime/deck/deck_groups.h"
#include "runtime/deck/output_fields.h"
#include "runtime/interaction/sweep.h"
#include "runtime/simulation/frame_field.h"
#include "runtime/simulation/frames.h"
#include "tests/runtime/simulation/chain.h"

static double pair_step(void) {
  return 0.05 / sqrt(2 * rigidity_axial(0.2) / SPACING / particle_mass());
}

/* Stretching a pair past S_t damages its one bond; a protected one stays whole. */
static void damage_is_counted_and_protection_kept(void **state) {
  (void)state;
  for (int protected = 0; protected < 2; protected ++) {
    char text[2048];
    snprintf(text, sizeof text,
             "&simulation end_time = 1e-4 step = %.17g /\n" CHAIN
             "&material lattice = 'c' model = 'm' S_t = 1e-3 /\n" POINT("left", "0", "0")
                 POINT("right", "0.01",
                       "0") "&support region = 'left' fix = 'x' /\n"
                            "&drive region = 'right' component = 'x' velocity = 0.3 /\n%s"
                            "&monitor name = 'any' kind = 'damaged' /\n&monitor name = 'most' kind "
                            "= 'damaged' above = 0.9 /\n"
                            "&monitor name = 'gone' kind = 'broken' /\n&output frames = 0 fields = "
                            "'damage', 'omega' /\n",
             pair_step(), 1.0 * SPACING, protected ? "&protect region = 'left' /\n" : "");
    small_run r;
    must_open(&r, &elastic_bar, text);
    /* stretch 0.3 t/s: damage begins at 33 us, is complete at 67 us */
    simulation_advance(r.simulation, lround(5e-5 / pair_step()), NULL);
    const frame_field *fields;
    double values[2] = {-1, -1};
    assert_int_equal(simulation_frame_fields(r.simulation, &fields), 3);
    assert_string_equal(fields[0].name, "displacement"); /* by itself */
    assert_string_equal(fields[1].name, "damage");
    assert_true(fields[2].on_bonds);
    simulation_frame_values(r.simulation, 1, values);
    const double expected = protected ? 0 : 0.5;
    assert_true(fabs(values[0] - expected) < 0.01 && values[1] == values[0]);
    simulation_frame_values(r.simulation, 2, values);
    assert_true(values[0] == values[1]);
    assert_int_equal(small_go(&r), STEP_END);
    assert_true(small_last(&r, "any") == !protected);
    assert_true(small_last(&r, "most") == !protected);
    assert_true(small_last(&r, "gone") == !protected);
    small_close(&r);
  }
}

/* A law with two damages and a state before them: the larger damage of a bond counts everywhere.
   The chain has two bonds, far below any growth of damage. */
static void the_larger_of_two_damages_counts(void **state) {
  (void)state;
  static const pl_field fields[] = {{"omega", "1", "damage", 0, PL_FIELD_DAMAGE, PL_ON_BOND},
                                    {"alpha", "1", "state", 0, PL_FIELD_STATE, PL_ON_BOND},
                                    {"crush", "1", "damage", 0, PL_FIELD_DAMAGE, PL_ON_BOND}};
  pl_law law = elastic_bar;
  law.field_count = 3;
  law.fields = fields;
  char text[2048];
  snprintf(text, sizeof text,
           "&simulation end_time = 1e-5 step = 1e-7 /\n" CHAIN
           "&material lattice = 'c' model = 'm' /\n"
           "&monitor name = 'half' kind = 'damaged' above = 0.5 /\n"
           "&monitor name = 'most' kind = 'damaged' above = 0.6 /\n"
           "&monitor name = 'nearly' kind = 'broken' above = 0.9 /\n"
           "&monitor name = 'gone' kind = 'broken' /\n"
           "&output frames = 0 fields = 'damage', 'dissipated', 'alpha', 'axial' /\n",
           2.0 * SPACING);
  small_run r;
  must_open(&r, &law, text);
  sweep *w = simulation_state(r.simulation, 0);
  rows_bond *bonds = rows_bonds(simulation_rows(r.simulation, 0));
  assert_int_equal(w->body->lattice->bond_count, 2);
  const double given[2][3] = {{0.3, 0.99, 0.6},
                              {0.9, 0.99, 0.1}}; /* of each bond: omega, alpha, crush */
  int32_t ends[3] = {0};
  for (int b = 0; b < 2; b++) {
    for (int f = 0; f < 3; f++)
      w->field[f][bonds[b].slot] = given[b][f];
    ends[bonds[b].i]++;
    ends[bonds[b].j]++;
  }
  static const struct {
    const char *name, *kind;
    bool on_bonds;
  } expected[] = {{"displacement", "other", false}, {"damage", "damage", false},
                  {"dissipated", "other", false},   {"omega", "damage", true},
                  {"alpha", "state", true},         {"crush", "damage", true},
                  {"axial", "output", true}};
  const frame_field *offered;
  assert_int_equal(simulation_frame_fields(r.simulation, &offered), 7);
  for (int k = 0; k < 7; k++) {
    assert_string_equal(offered[k].name, expected[k].name);
    assert_string_equal(offered[k].kind, expected[k].kind);
    assert_int_equal(offered[k].on_bonds, expected[k].on_bonds);
  }
  double values[3];
  simulation_frame_values(r.simulation, 1, values);
  for (int b = 0; b < 2; b++) { /* 0.6 and 0.9 at the ends, their mean in the middle */
    const int32_t pair[2] = {bonds[b].i, bonds[b].j};
    for (int e = 0; e < 2; e++)
      assert_true(fabs(values[pair[e]] - (ends[pair[e]] == 2 ? 0.75 : b ? 0.9 : 0.6)) < 1e-15);
  }
  free(bonds);
  assert_int_equal(small_go(&r), STEP_END);
  assert_true(small_last(&r, "half") == 2 && small_last(&r, "most") == 1);
  assert_true(small_last(&r, "nearly") == 1 && small_last(&r, "gone") == 0);
  small_close(&r);
}

/* The key `fields` tells of each. */
static void the_reference_names_every_field(void **state) {
  (void)state;
  const deck_group_info *output = deck_groups[DECK_GROUP_output];
  const char *doc = NULL;
  for (int k = 0; k < output->key_count; k++)
    if (!strcmp(output->keys[k].name, "fields")) doc = output->keys[k].doc;
  assert_non_null(doc);
#define X(name, unit, components, exists, kind, words) assert_non_null(strstr(doc, #name));
  OUTPUT_FIELDS(X)
#undef X
#define X(name, unit, words, of_nodes) assert_non_null(strstr(doc, #name));
  OUTPUT_TENSORS(X)
#undef X
}

/* All that the table of fields holds, of a law that has it all, in the table's order and with its
   unit. */
static void every_field_of_the_table_can_be_stored(void **state) {
  (void)state;
#define X(name, unit, components, exists, kind, words) #name,
  static const char *const names[] = {OUTPUT_FIELDS(X)};
#undef X
#define X(name, unit, components, exists, kind, words) unit,
  static const char *const units[] = {OUTPUT_FIELDS(X)};
#undef X
  enum { COUNT = sizeof names / sizeof *names };
  char text[2048], fields[512] = "";
  for (int k = COUNT - 1; k >= 0; k--)
    snprintf(fields + strlen(fields), sizeof fields - strlen(fields), " '%s',", names[k]);
  snprintf(text, sizeof text,
           "&simulation end_time = 1e-4 step = %.17g /\n" CHAIN
           "&material lattice = 'c' model = 'm' /\n&output frames = 0 fields = %s 'nothing' /\n",
           pair_step(), 1.0 * SPACING, fields);
  small_run r;
  small_open(&r, &elastic_beam, text);
  assert_null(r.simulation); /* but for what no run has */
  assert_int_equal(r.said.items[r.said.count - 1].code, DIAG_BAD_VALUE);
  diagnostics said;
  diag_begin(&said, &r.sources);
  const run_body beam = {.law = &elastic_beam};
  assert_false(frames_check(&r.deck->output, &beam, 1, &said));
  deck without = *r.deck;
  without.output.field_count--;
  assert_true(frames_check(&without.output, &beam, 1, &said));
  assert_int_equal(said.errors, 1);
  r.said.errors = 0;
  r.simulation = simulation_new(&without, r.laws, &r.said);
  assert_non_null(r.simulation);
  const frame_field *stored;
  const int of_lattices = COUNT - 1; /* the last, dead_cells, is of meshes (test_cell_deaths.c) */
  assert_string_equal(names[of_lattices], "dead_cells");
  assert_int_equal(simulation_frame_fields(r.simulation, &stored), of_lattices + 1); /* and omega */
  for (int k = 0; k < of_lattices; k++) {
    double values[6];
    assert_string_equal(stored[k].name, names[k]);
    assert_string_equal(stored[k].unit, units[k]);
    simulation_frame_values(r.simulation, k, values);
    for (int c = 0; c < 2 * stored[k].components; c++)
      assert_true(values[c] == 0);
  }
  diag_clear(&said);
  small_close(&r);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(the_reference_names_every_field),
      cmocka_unit_test(every_field_of_the_table_can_be_stored),
      cmocka_unit_test(damage_is_counted_and_protection_kept),
      cmocka_unit_test(the_larger_of_two_damages_counts),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
