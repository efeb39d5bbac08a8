/* Whose the bonds of a lattice are, where several laws are at work on it: each bond of laws of
   bonds belongs to one, each particle of laws of families. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "runtime/lattice/law_parts.h"
#include "tests/runtime/built_rows.h"

/* Rows of ten; the region stands in the columns from the fifth on. */
#define PLATE(kind)                                                                                \
  "&simulation end_time = 1 /\n"                                                                   \
  "&lattice name = 'l' kind = '" kind "' spacing = 0.01 thickness = 0.1 /\n"                       \
  "&body lattice = 'l' shape = 'rectangle' corner = 0, 0 size = 0.09, 0.04 /\n"                    \
  "&region name = 'a' shape = 'rectangle' corner = 0.049, -1 size = 1, 2 /\n"                      \
  "&region name = 'b' shape = 'rectangle' corner = -1, -1 size = 1.049, 2 /\n"                     \
  "&material lattice = 'l' model = 'm' /\n"                                                        \
  "&material lattice = 'l' region = 'a' model = 'n' /\n"
#define BETWEEN "&material lattice = 'l' between = 'b', 'a' model = 'm' /\n"

static bool right(const rows *w, long site) {
  return w->x[site] > 0.049;
}

static bool has(const law_part *part, long site, int direction) {
  return rows_has_bond(part->bonds, site, direction);
}

static void check_bonds(const char *text, int laws, bool families) {
  built_rows r;
  build_rows(&r, text);
  const rows *w = r.rows;
  assert_int_equal(r.deck->interaction_count, laws);
  law_part *parts = law_parts_new(r.deck, 0, laws, w, families, &r.said);
  assert_non_null(parts);
  long count[3] = {0, 0, 0};
  for (long p = 0; p < w->particle_count; p++)
    for (int k = 0; k < w->directions; k++) {
      const long i = w->particle_site[p];
      if (!rows_has_bond(w, i, k)) continue;
      const int ends = right(w, i) + right(w, rows_partner(w, i, k));
      const bool first = families ? ends < 2 : ends == 0 || (ends == 1 && laws == 2),
                 second = families ? ends > 0 : ends == 2;
      assert_int_equal(has(&parts[0], i, k), first);
      assert_int_equal(has(&parts[1], i, k), second);
      if (laws > 2) assert_int_equal(has(&parts[2], i, k), ends == 1);
      for (int n = 0; n < laws; n++)
        count[n] += has(&parts[n], i, k);
    }
  for (int n = 0; n < laws; n++) {
    assert_int_equal(parts[n].bonds->bond_count, count[n]);
    assert_true((parts[n].share != NULL) == families);
    for (long p = 0; p < w->particle_count && families; p++)
      assert_true(parts[n].share[w->particle_site[p]] == (right(w, w->particle_site[p]) == n));
  }
  law_parts_free(parts, laws);
  built_end(&r);
}

static void bonds_belong_to_one_law_and_particles_too(void **state) {
  (void)state;
  static const char *const texts[] = {PLATE("hexagonal"), PLATE("square"), PLATE("blue_noise")};
  static const char *const between[] = {PLATE("hexagonal") BETWEEN, PLATE("blue_noise") BETWEEN};
  for (int k = 0; k < 3; k++)
    for (int families = 0; families < 2; families++)
      check_bonds(texts[k], 2, families);
  for (int k = 0; k < 2; k++)
    check_bonds(between[k], 3, false);
}

/* Of a list both ends know of a bond. */
static void a_part_of_a_list_knows_its_bonds_from_both_ends(void **state) {
  (void)state;
  built_rows r;
  build_rows(&r, PLATE("blue_noise"));
  law_part *parts = law_parts_new(r.deck, 0, 2, r.rows, false, &r.said);
  const rows *w = parts[1].bonds;
  for (long p = 0; p < w->particle_count; p++)
    for (int k = 0; k < w->directions; k++) {
      const long i = w->particle_site[p], j = rows_partner(w, i, k);
      if (!rows_has_neighbour(r.rows, i, k)) continue;
      assert_int_equal(rows_has_neighbour(w, i, k), rows_has_neighbour(w, j, k + w->directions));
    }
  law_parts_free(parts, 2);
  built_end(&r);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(bonds_belong_to_one_law_and_particles_too),
      cmocka_unit_test(a_part_of_a_list_knows_its_bonds_from_both_ends)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
