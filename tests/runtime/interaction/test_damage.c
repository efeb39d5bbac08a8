/* Damage of bonds and particles: the largest of a bond's, the largest on a particle, else the
   mean over its bonds. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "runtime/interaction/damage.h"
#include "tests/runtime/small_run.h"

/* Three particles in a row: two bonds. */
#define ROW                                                                                        \
  "&simulation end_time = 1e-5 step = 1e-7 /\n"                                                    \
  "&lattice name = 'c' kind = 'hexagonal' spacing = 0.01 thickness = 0.1 /\n"                      \
  "&body lattice = 'c' shape = 'rectangle' corner = 0, -0.001 size = 0.02, 0.002 /\n"              \
  "&material lattice = 'c' model = 'm' /\n&output frames = 0 /\n"

static const pl_field fields[] = {{"omega", "1", "damage", 0, PL_FIELD_DAMAGE, PL_ON_BOND},
                                  {"alpha", "1", "state", 0, PL_FIELD_STATE, PL_ON_BOND},
                                  {"crush", "1", "damage", 0, PL_FIELD_DAMAGE, PL_ON_BOND}};

static pl_law law_of(int count) {
  pl_law law = elastic_bar;
  law.field_count = count;
  law.fields = fields;
  return law;
}

static void open_row(small_run *r, const pl_law *law) {
  small_open(r, law, ROW);
  if (!r->simulation) small_print(r);
  assert_non_null(r->simulation);
}

/* A state is no damage, however large; of two damages the larger counts. */
static void the_largest_damage_of_a_bond_counts(void **state) {
  (void)state;
  const pl_law law = law_of(3);
  small_run r;
  open_row(&r, &law);
  sweep *w = simulation_state(r.simulation, 0);
  rows_bond *bonds = rows_bonds(w->body->lattice);
  const double given[2][3] = {{0.3, 0.99, 0.6}, {0.9, 0.99, 0.1}};
  double values[3];
  assert_int_equal(w->body->lattice->bond_count, 2);
  for (int b = 0; b < 2; b++)
    for (int f = 0; f < 3; f++)
      w->new_field[f][bonds[b].slot] = given[b][f];
  assert_true(damage_of_bond(w, &bonds[0]) == 0.6 && damage_of_bond(w, &bonds[1]) == 0.9);
  assert_null(damage_of_all_bonds(w)); /* no single array holds it */
  damage_of_particles(&(damage_law){w, bonds, 2}, 1, values);
  for (int b = 0; b < 2; b++) { /* the ends have one bond, the middle has both */
    const int32_t end =
        bonds[b].i == bonds[1 - b].i || bonds[b].i == bonds[1 - b].j ? bonds[b].j : bonds[b].i;
    assert_true(values[end] == (b ? 0.9 : 0.6));
  }
  assert_true(fabs(values[0] + values[1] + values[2] - (0.6 + 0.9 + 0.75)) < 1e-15);
  free(bonds);
  small_close(&r);
}

static void one_damage_is_the_array_itself(void **state) {
  (void)state;
  small_run r;
  open_row(&r, &elastic_bar);
  const sweep *w = simulation_state(r.simulation, 0);
  assert_true(damage_of_all_bonds(w) == w->new_field[0]);
  small_close(&r);
}

/* Of a sound body, and of a law that knows no damage. */
static void without_damage_all_is_sound(void **state) {
  (void)state;
  pl_law law = law_of(3);
  law.fields = fields + 1;
  law.field_count = 1;
  assert_false(damage_on_bonds(&law) || damage_on_particles(&law));
  assert_true(damage_on_bonds(&elastic_bar) && !damage_on_particles(&elastic_bar));
  small_run r;
  double values[3] = {-1, -1, -1};
  open_row(&r, &law);
  sweep *w = simulation_state(r.simulation, 0);
  rows_bond *bonds = rows_bonds(w->body->lattice);
  w->new_field[0][bonds[0].slot] = 0.7;
  assert_true(damage_of_bond(w, &bonds[0]) == 0 &&
              damage_of_site(w, w->body->lattice->particle_site[0]) == 0);
  damage_of_particles(&(damage_law){w, bonds, 2}, 1, values);
  assert_true(values[0] == 0 && values[1] == 0 && values[2] == 0);
  free(bonds);
  small_close(&r);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(the_largest_damage_of_a_bond_counts),
      cmocka_unit_test(one_damage_is_the_array_itself),
      cmocka_unit_test(without_damage_all_is_sound),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
