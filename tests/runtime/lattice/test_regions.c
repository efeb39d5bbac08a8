/* The particles of regions, and what is said of those that hold none or are not named. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "runtime/filling/lattice.h"
#include "runtime/lattice/regions.h"
#include "runtime/lattice/rows_select.h"
#include "tests/runtime/built_rows.h"
#include "tests/runtime/small_run.h"

static void regions_hold_the_particles_inside(void **state) {
  (void)state;
  small_run r;
  small_open(&r, &elastic_bar,
             "&simulation end_time = 1e-5 step = 1e-7 /\n"
             "&lattice name = 'c' kind = 'hexagonal' spacing = 0.01 thickness = 0.1 /\n"
             "&body lattice = 'c' shape = 'rectangle' corner = 0, 0 size = 0.1, 0.1 /\n"
             "&material lattice = 'c' model = 'm' /\n"
             "&region name = 'edge' shape = 'rectangle' corner = 0, 0 size = 0.1, 0.001 /\n"
             "&region name = 'idle' shape = 'disc' centre = 0.05, 0.05 radius = 0.0101 /\n"
             "&region name = 'void' shape = 'disc' centre = 1, 1 radius = 0.01 /\n"
             "&support region = 'edge' fix = 'y' /\n&output frames = 0 /\n");
  if (r.simulation) small_print(&r);
  assert_null(r.simulation);
  diagnostics said;
  diag_begin(&said, &r.sources);
  rows *g = lattice_build(r.deck, 0, &said);
  region_sites *regions = regions_select(r.deck, "c", g, &said);
  assert_int_equal(regions[0].count, 11); /* 0, 10 mm, ..., 100 mm */
  for (long p = 0; p < regions[0].count; p++)
    assert_true(fabs(g->y[g->particle_site[regions[0].particles[p]]]) < 1e-9);
  assert_true(regions[1].count > 0 && regions[1].count <= 7);
  assert_int_equal(regions[2].count, 0);
  assert_int_equal(said.count, 2);
  assert_int_equal(said.items[0].code, DIAG_DECK_WARNING);
  assert_non_null(strstr(said.items[0].message, "region `idle` is never used"));
  assert_int_equal(said.items[1].code, DIAG_EMPTY_REGION);
  assert_non_null(strstr(said.items[1].message, "region `void` holds no particle"));
  regions_free(r.deck, regions);
  rows_free(g);
  diag_clear(&said);
  small_close(&r);
}

/* Of the shape itself, not of the box around it: a slanting line between particles, a ring whose
   hole holds some, and a point. */
static void what_is_near_an_empty_region_is_told(void **state) {
  (void)state;
  static const struct {
    const char *shape, *near;
  } empty[] = {
      {"shape = 'segment' from = '52.5 mm', '3 mm' to = '97.5 mm', '48 mm'",
       "the particles of `c` lie in x = 0 .. 100 mm, y = 0 .. 95.2628 mm; the nearest stands at "
       "(75, 25.9808) mm"},
      {"shape = 'disc' centre = '49.9 mm', '17.32 mm' radius = '9.7 mm' inner_radius = '9.5 mm'",
       "the nearest stands at (40, 17.3205) mm"},
      {"shape = 'point' at = '-30 mm', '-40 mm'",
       "the nearest particle stands 50 mm away at (0, 0) mm; `within`"},
  };
  for (size_t k = 0; k < sizeof empty / sizeof *empty; k++) {
    char text[1024];
    snprintf(text, sizeof text,
             "&simulation end_time = 1e-5 step = 1e-7 /\n"
             "&lattice name = 'c' kind = 'hexagonal' spacing = 0.01 thickness = 0.1 /\n"
             "&body lattice = 'c' shape = 'rectangle' corner = 0, 0 size = 0.1, 0.1 /\n"
             "&material lattice = 'c' model = 'm' /\n&region name = 'none' %s /\n"
             "&support region = 'none' fix = 'y' /\n&output frames = 0 /\n",
             empty[k].shape);
    small_run r;
    small_open(&r, &elastic_bar, text);
    assert_null(r.simulation);
    assert_true(r.said.count > 0 && r.said.items[0].hint);
    if (!strstr(r.said.items[0].hint, empty[k].near)) fail_msg("%s", r.said.items[0].hint);
    small_close(&r);
  }
}

/* Particles of 1 to 4 mm: a point chooses the nearest one within half of that one's spacing. */
static void points_reach_half_of_a_particles_own_spacing(void **state) {
  (void)state;
  built_rows b;
  build_rows(&b, "&simulation end_time = 1 /\n&material lattice = 'c' model = 'm' /\n"
                 "&lattice name = 'c' kind = 'blue_noise' spacing = '1 [mm] + 0.1*y' thickness = 1 "
                 "/\n&body lattice = 'c' shape = 'rectangle' corner = 0, 0 size = 0.03, 0.03 /\n");
  const rows *g = b.rows;
  for (int n = 0; n < 400; n++) {
    const deck_shape point = {.kind = SHAPE_POINT,
                              .at = {30e-3 * (n % 20) / 19, 30e-3 * (n / 20) / 19}};
    double least = INFINITY, own = 0;
    int32_t *list, nearest = -1;
    for (int32_t p = 0; p < g->particle_count; p++) {
      const long q = g->particle_site[p];
      const double way = hypot(g->x[q] - point.at[0], g->y[q] - point.at[1]);
      if (way < least) nearest = p, own = 1e-3 + 0.1 * g->y[q];
      least = fmin(least, way);
    }
    const long count = rows_select(g, &point, &list);
    assert_int_equal(count, least < 0.5 * own);
    if (count) assert_int_equal(list[0], nearest);
    free(list);
  }
  built_end(&b);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(regions_hold_the_particles_inside),
      cmocka_unit_test(what_is_near_an_empty_region_is_told),
      cmocka_unit_test(points_reach_half_of_a_particles_own_spacing)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
