/* Lists of particles that stand on a lattice: their neighbours stand side by side, and what is said
   of those (pl_family.alike) is what the list says, to the bit, whatever the particles' numbers.
   Lists of particles that stand anywhere have no such ways. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "runtime/lattice/bond_ways.h"
#include "runtime/lattice/list_lines.h"
#include "runtime/lattice/list_ways.h"
#include "runtime/lattice/scattered.h"
#include "tests/runtime/scattered_points.h"

static const double spacing = 0.01;

static rows *list_of(const test_points *p, double horizon) {
  double *measure = must_alloc(((size_t)p->cloud.count + 1) * sizeof *measure);
  for (long k = 0; k < p->cloud.count; k++)
    measure[k] = spacing * spacing;
  const scattered from = {.points = p->cloud,
                          .measure = measure,
                          .spacing = spacing,
                          .horizon = horizon * spacing,
                          .stiffness_thickness = 0.1,
                          .mass_thickness = 0.1};
  long crowded;
  rows *w = scattered_rows(&from, &crowded);
  assert_non_null(w);
  free(measure);
  return w;
}

/* Far from the origin, where places are rounded most; in any order. */
static rows *hexagonal(long columns, long lines, double shake, bool shuffled) {
  test_points p = points_hexagonal(columns, lines, shake, 5);
  for (long k = 0; k < p.cloud.count; k++)
    for (int a = 0; a < 2; a++)
      p.at[a][k] = 3.7 + spacing * p.at[a][k];
  if (shuffled) {
    int32_t *numbers = points_shuffle(p.cloud.count, 11);
    test_points other = points_renumbered(&p, numbers);
    points_free(&p);
    free(numbers);
    p = other;
  }
  rows *w = list_of(&p, 1.01);
  points_free(&p);
  return w;
}

/* Every second place of a cubic grid, turned: a face-centred lattice. */
static rows *face_centred(int along) {
  test_points p = points_new(3, (long)along * along * along / 2);
  const double half = spacing / sqrt(2), c = cos(0.3), s = sin(0.3);
  long n = 0;
  for (int k = 0; k < along; k++)
    for (int j = 0; j < along; j++)
      for (int i = 0; i < along; i++) {
        if ((i + j + k) % 2) continue;
        p.at[0][n] = half * (c * i - s * j);
        p.at[1][n] = half * (s * i + c * j);
        p.at[2][n++] = half * k;
      }
  rows *w = list_of(&p, 1.42);
  points_free(&p);
  return w;
}

/* --- what is said is so ----------------------------------------------------------------------- */

static void compare_way(const rows *w, long site, int number, int32_t said) {
  const neighbour_list *l = w->list;
  const long slot = number * w->size + site;
  if (!rows_has_neighbour(w, site, number)) return;
  assert_int_not_equal(said, PL_NO_WAY);
  if (said < 0) return;
  assert_int_equal(l->way[said].to, l->neighbour[slot]);
  assert_memory_equal(&l->way[said].length, &l->length[slot], sizeof(double));
  for (int a = 0; a < w->dimensions; a++)
    assert_memory_equal(&l->way[said].chord[a], &l->chord[a][slot], sizeof(double));
}

/* How often no particle of a vector has a neighbour of that number. */
static long compare_ways(const rows *w) {
  long none = 0;
  for (long first = 0; first < w->size; first += PL_LANES)
    for (int k = 0; k < 2 * w->directions; k++) {
      const int32_t said = w->list->alike[first / PL_LANES * 2 * w->directions + k];
      bool any = false;
      for (long q = first; q < first + PL_LANES; q++) {
        compare_way(w, q, k, said);
        any = any || rows_has_neighbour(w, q, k);
      }
      assert_int_equal(said == PL_NO_WAY, !any);
      none += !any;
      if (said < 0) continue;
      assert_true(first + w->list->way[said].to >= 0);
      assert_true(first + PL_LANES + w->list->way[said].to <= w->size);
    }
  return none;
}

/* A chord is where the particles are, up to rounding, and the opposite from the other end. */
static void compare_chords(const rows *w) {
  for (long q = 0; q < w->size; q++)
    for (int k = 0; k < 2 * w->directions; k++) {
      double from[3], to[3], chord[3], back[3];
      if (!rows_has_neighbour(w, q, k)) continue;
      const long there = rows_partner(w, q, k);
      rows_place(w, q, from);
      rows_place(w, there, to);
      rows_chord(w, q, k, chord);
      rows_chord(w, there, (k + w->directions) % (2 * w->directions), back);
      for (int a = 0; a < w->dimensions; a++) {
        assert_true(fabs(to[a] - from[a] - chord[a]) < 1e-13);
        assert_true(chord[a] == -back[a]);
      }
    }
}

static void lattices_have_ways(void **state) {
  (void)state;
  rows *const w[] = {hexagonal(200, 60, 0, false), hexagonal(200, 60, 0, true), face_centred(40)};
  for (int n = 0; n < 3; n++) {
    assert_non_null(w[n]->list->way);
    print_message("%ld particles in %d rows: %.5f of all neighbours stand alike\n",
                  w[n]->particle_count, w[n]->row_count, list_ways_share(w[n]));
    assert_true(list_ways_share(w[n]) > 0.99);
    assert_true(compare_ways(w[n]) > 0); /* behind the outline, and where rows are filled up */
    compare_chords(w[n]);
    rows_free(w[n]);
  }
}

/* A bond number is a way: there are no more numbers than ways, and of a lattice of 6 neighbours 3.
   Bonds of a particle on one side have different numbers. */
static void bonds_are_all_there(void **state) {
  (void)state;
  rows *w = hexagonal(50, 40, 0, true);
  assert_int_equal(w->directions, 3);
  /* along lines, and up to the left and to the right between them */
  assert_int_equal(w->bond_count, 49 * 40 + 39 * (50 + 49));
  long ends = 0;
  for (long p = 0; p < w->particle_count; p++)
    ends += rows_degree(w, w->particle_site[p]);
  assert_int_equal(ends, 2 * w->bond_count);
  rows_free(w);
}

static void numbers_do_not_matter(void **state) {
  (void)state;
  rows *a = hexagonal(90, 30, 0, false), *b = hexagonal(90, 30, 0, true);
  assert_int_equal(a->size, b->size);
  assert_memory_equal(a->x, b->x, (size_t)a->size * sizeof *a->x);
  assert_memory_equal(a->y, b->y, (size_t)a->size * sizeof *a->y);
  assert_memory_equal(a->bonds, b->bonds, (size_t)a->size * sizeof *a->bonds);
  const size_t planes = 2 * (size_t)a->directions * (size_t)a->size;
  assert_memory_equal(a->list->neighbour, b->list->neighbour, planes * sizeof(int32_t));
  assert_memory_equal(a->list->length, b->list->length, planes * sizeof(double));
  rows_free(a);
  rows_free(b);
}

static void shaken_particles_have_none(void **state) {
  (void)state;
  rows *w = hexagonal(60, 60, 0.1, false);
  assert_null(w->list->way);
  assert_true(list_ways_share(w) == 0);
  rows_free(w);
}

/* 50 x 40 particles, every seventh with bonds of its own: all have a site, those aside none in a
   line's row, and along a line places differ by a spacing. */
static void lines_hold_all_others(void **state) {
  (void)state;
  test_points p = points_hexagonal(50, 40, 0, 5);
  point_pairs pairs = pairs_within(&p.cloud, 1.01, ROWS_MAX_NEIGHBOURS);
  bond_ways ways;
  assert_true(bond_ways_find(&p.cloud, &pairs, 1, &ways));
  assert_int_equal(ways.common, 3);
  assert_int_equal(ways.bonds[0], 49 * 40);
  list_lines l = list_lines_find(&ways, &p.cloud, 1);
  assert_int_equal(l.count, 40);
  int32_t highest[2000], site[2000];
  unsigned char *is_line, *taken = must_calloc((size_t)(4000 * l.pitch), 1);
  for (int r = 0; r < 2000; r++)
    highest[r] = r % 7 ? 2 : 3;
  const long rows_of = list_lines_place(&l, highest, 3, site, &is_line);
  for (int r = 0; r < 2000; r++) {
    assert_true(site[r] >= 0 && site[r] < rows_of * l.pitch && !taken[site[r]]);
    taken[site[r]] = 1;
    assert_int_equal(is_line[site[r] / l.pitch], highest[r] < 3);
    if (r % 50) assert_true(fabs(p.at[0][l.order[r]] - p.at[0][l.order[r - 1]] - 1) < 1e-12);
  }
  assert_true(list_lines_pay(&l, 2000, 0));
  assert_false(list_lines_pay(&l, 2000, 1000));
  free(taken);
  free(is_line);
  list_lines_free(&l);
  bond_ways_free(&ways);
  free(pairs.items);
  points_free(&p);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(lattices_have_ways), cmocka_unit_test(bonds_are_all_there),
      cmocka_unit_test(numbers_do_not_matter), cmocka_unit_test(lines_hold_all_others),
      cmocka_unit_test(shaken_particles_have_none)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
