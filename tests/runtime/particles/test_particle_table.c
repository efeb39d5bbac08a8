/* Particles of tables: columns and units, places for messages, and what is refused. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "dsl/base/arena.h"
#include "runtime/particles/particle_table.h"

typedef struct reading {
  source_set sources;
  diagnostics said;
  particle_table table;
  bool good;
} reading;

/* A table named grains.csv, as a source that stands for the file. */
static reading *read_table(const char *text, int dimensions) {
  reading *r = must_calloc(1, sizeof *r);
  diag_begin(&r->said, &r->sources);
  source_add(&r->sources, "deck.nml", "file = 'grains.csv'", 19);
  source_add(&r->sources, "grains.csv", text, strlen(text));
  r->good = particle_table_read(&r->table, must_copy("grains.csv"), dimensions, 0.5,
                                (span){7, 19, 0}, &r->said);
  return r;
}

static void forget(reading *r) {
  particle_table_free(&r->table);
  diag_clear(&r->said);
  source_clear(&r->sources);
  free(r);
}

/* Volumes in the plane become areas by the thickness, here half a metre; blank lines and remarks are no particles. */
static void columns_are_known_by_their_names(void **state) {
  (void)state;
  char text[PARTICLE_TABLE_TEXT];
  reading *r = read_table("# heap\nvolume [cm^3], Y [mm], x\n2, 3, 4\n\n# far\n6, 7, 8e3\n", 2);
  const particle_table *t = &r->table;
  assert_true(r->good);
  assert_int_equal(t->count, 2);
  assert_true(t->at[0][0] == 4 && t->at[0][1] == 8e3);
  assert_true(fabs(t->at[1][0] - 3e-3) < 1e-18 && fabs(t->at[1][1] - 7e-3) < 1e-18);
  assert_null(t->at[2]);
  assert_true(fabs(t->volume[0] - 4e-6) < 1e-20 && fabs(t->volume[1] - 12e-6) < 1e-20);
  assert_string_equal(particle_table_name(t, 1, text), "line 6");
  const span where = particle_table_where(&r->table, 1, (span){0, 0, 0}, &r->said);
  assert_memory_equal(r->sources.items[where.file].text + where.begin, "6, 7, 8e3",
                      where.end - where.begin);
  forget(r);
}

static void areas_and_no_sizes_are_taken_too(void **state) {
  (void)state;
  reading *r = read_table("x y area\n0 0 3\n1 0 5\n", 2);
  assert_true(r->good && r->table.volume[0] == 3 && r->table.volume[1] == 5);
  forget(r);
  r = read_table("x;y;z\n0;0;-1\n", 3);
  assert_true(r->good && r->table.count == 1 && r->table.at[2][0] == -1);
  assert_null(r->table.volume);
  forget(r);
}

static void tables_that_are_no_particles_are_refused(void **state) {
  (void)state;
  static const struct {
    const char *text;
    int dimensions;
    diag_code code;
    const char *message;
  } cases[] = {{"x, volume\n1, 1\n", 2, DIAG_MISSING_KEY, "the table has no column `y`"},
               {"x, y\n1, 1\n", 3, DIAG_MISSING_KEY, "the table has no column `z`"},
               {"x, y, z\n1, 1, 1\n", 2, DIAG_CONFLICT, "the lattice is in the plane"},
               {"x, y, z, area\n1, 1, 1, 1\n", 3, DIAG_CONFLICT, "not an `area`"},
               {"x, y, area, volume\n1, 1, 1, 1\n", 2, DIAG_CONFLICT, "exclude each other"},
               {"x, y, X\n1, 1, 1\n", 2, DIAG_DUPLICATE_NAME, "there is a second column `x`"},
               {"x, y\n1, 1e31\n", 2, DIAG_BAD_NUMBER, "`y` is too large here"},
               {"x, y, area\n1, 1, 0\n", 2, DIAG_OUT_OF_BOUNDS, "`area` must be positive"},
               {"x, y, area\n1, 1, -2\n", 2, DIAG_OUT_OF_BOUNDS, "`area` must be positive"},
               {"x, y\n", 2, DIAG_EMPTY_REGION, "`grains.csv` holds no particle"},
               {"", 2, DIAG_EMPTY_REGION, "`grains.csv` holds no particle"},
               {"x [s], y\n1, 1\n", 2, DIAG_UNITS, "x"},
               {"x, y\n1\n", 2, DIAG_BAD_VALUE, ""}};
  for (size_t k = 0; k < sizeof cases / sizeof *cases; k++) {
    reading *r = read_table(cases[k].text, cases[k].dimensions);
    if (r->good || r->said.errors != 1 || r->said.items[0].code != cases[k].code ||
        !strstr(r->said.items[0].message, cases[k].message)) {
      diag_print(&r->said, stderr);
      fail_msg("table %zu", k);
    }
    forget(r);
  }
}

static void a_missing_file_is_told_where_it_is_named(void **state) {
  (void)state;
  reading r = {0};
  diag_begin(&r.said, &r.sources);
  source_add(&r.sources, "deck.nml", "file = 'none.csv'", 17);
  assert_false(particle_table_read(&r.table, must_copy("/nowhere/none.csv"), 2, 1, (span){7, 17, 0},
                                   &r.said));
  assert_int_equal(r.said.errors, 1);
  assert_int_equal(r.said.items[0].code, DIAG_FILE);
  assert_int_equal(r.said.items[0].where.begin, 7);
  particle_table_free(&r.table);
  diag_clear(&r.said);
  source_clear(&r.sources);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(columns_are_known_by_their_names),
      cmocka_unit_test(areas_and_no_sizes_are_taken_too),
      cmocka_unit_test(tables_that_are_no_particles_are_refused),
      cmocka_unit_test(a_missing_file_is_told_where_it_is_named),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
