/* Particles near a place, against a look at each of them: on rows and on no lattice, in the plane
   and in space, at places inside and far outside. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include <math.h>

#include "runtime/lattice/near_particles.h"
#include "tests/runtime/built_rows.h"

#define LATTICE(keys, body)                                                                        \
  "&simulation end_time = 1 /\n&lattice name = 'l' spacing = 0.02 " keys " /\n"                    \
  "&material lattice = 'l' model = 'm' /\n&body lattice = 'l' " body " /\n"

/* Each in reach is there once, in the order of numbers. Returns how many there are. */
static long check_place(near_particles *n, const double from[3]) {
  const rows *w = n->body;
  long count = 0;
  near_particles_find(n, from);
  for (int32_t p = 0; p < w->particle_count; p++) {
    double at[3], square = 0;
    rows_place(w, w->particle_site[p], at);
    for (int a = 0; a < w->dimensions; a++)
      square += (at[a] - from[a]) * (at[a] - from[a]);
    if (square > n->reach * n->reach) continue;
    assert_true(count < n->count);
    const near_particle *found = &n->found[count++];
    assert_int_equal(found->particle, p);
    assert_true(found->square == square);
    for (int a = 0; a < 3; a++)
      assert_true(found->way[a] == (a < w->dimensions ? at[a] - from[a] : 0));
  }
  assert_int_equal(n->count, count);
  return count;
}

static void all_in_reach_are_found(void **state) {
  (void)state;
  static const char *const texts[] = {
      LATTICE("kind = 'hexagonal' thickness = 1",
              "shape = 'rectangle' corner = 0, 0 size = 0.4, 0.2"),
      LATTICE("kind = 'blue_noise' thickness = 1", "shape = 'disc' centre = 0.1, 0.1 radius = 0.1"),
      LATTICE("kind = 'fcc'", "shape = 'box' corner = 0, 0, 0 size = 0.2, 0.2, 0.1")};
  static const double reach[] = {0.011, 0.0200001, 0.07, 5};
  for (int k = 0; k < 12; k++) {
    built_rows b;
    long most = 0;
    build_rows(&b, texts[k / 4]);
    near_particles n = near_particles_of(b.rows, reach[k % 4]);
    for (int m = 0; m < 200; m++) {
      const double from[3] = {0.1 + 0.15 * sin(3 * m), 0.1 + 0.15 * sin(5 * m + 1),
                              0.05 + 0.1 * cos(7 * m)};
      const long found = check_place(&n, from);
      most = found > most ? found : most;
    }
    assert_true(most > 0 && (k % 4 != 3 || most == b.rows->particle_count));
    near_particles_end(&n);
    built_end(&b);
  }
}

int main(void) {
  const struct CMUnitTest tests[] = {cmocka_unit_test(all_in_reach_are_found)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
