/* Particles that stand on no lattice: how even blue noise is and that it fills its bodies,
   particles of tables and results, and what is said about those that are no set of particles. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include <cmocka.h>
#include <omp.h>

#include "runtime/base/random_number.h"
#include "runtime/deck/deck_read.h"
#include "runtime/geometry/shape.h"
#include "runtime/particles/gradation.h"
#include "runtime/particles/particle_set.h"
#include "runtime/particles/voronoi.h"
#include "runtime/result/hdf5_tools.h"
#include "tests/runtime/small_result.h"

typedef struct bench {
  arena *memory;
  source_set sources;
  diagnostics d;
  const deck *deck;
} bench;

/* A deck of one lattice with these keys, and of these groups. */
static void begin(bench *b, const char *keys, const char *groups) {
  *b = (bench){.memory = arena_new()};
  diag_begin(&b->d, &b->sources);
  const char *text = arena_printf(b->memory,
                                  "&simulation end_time = 1 /\n&lattice name = 'heap' %s /\n"
                                  "&material lattice = 'heap' model = 'elastic' /\n%s\n",
                                  keys, groups);
  const int file = source_add(&b->sources, "test.nml", text, strlen(text));
  b->deck = deck_read(b->memory, &b->sources, file, NULL, 0, &b->d);
  if (!b->deck) diag_print(&b->d, stderr);
  assert_non_null(b->deck);
}

static void end(bench *b, particle_set *set) {
  particle_set_free(set);
  diag_clear(&b->d);
  source_clear(&b->sources);
  arena_free(b->memory);
}

static particle_set *make(bench *b) {
  particle_set *set = particle_set_make(b->deck, 0, &b->d);
  if (!set) diag_print(&b->d, stderr);
  assert_non_null(set);
  assert_int_equal(b->d.errors, 0);
  return set;
}

static double sum_of(const particle_set *set) {
  double sum = 0;
  for (long k = 0; k < set->count; k++)
    sum += set->volume[k];
  return sum;
}

/* Standard deviation of the volumes over their mean. */
static double spread(const particle_set *set) {
  const double mean = sum_of(set) / (double)set->count;
  double square = 0;
  for (long k = 0; k < set->count; k++)
    square += (set->volume[k] - mean) * (set->volume[k] - mean);
  return sqrt(square / (double)set->count) / mean;
}

static bool any_nearer(const particle_set *set, double distance) {
  const voronoi_points p = {
      set->dimensions, set->count, {set->at[0], set->at[1], set->at[2]}, set->spacing, NULL};
  long pair[2];
  return voronoi_too_near(&p, distance, pair);
}

/* --- blue noise ------------------------------------------------------------------------------- */

typedef struct filled {
  const char *keys, *groups;
  double size, tolerance; /* m^2, m^3 */
} filled;

#define PLANE "kind = 'blue_noise' spacing = '20 mm' thickness = '1 mm'"
#define SPACE "kind = 'blue_noise' spacing = '80 mm' setting = 'space'"
#define BODY  "&body lattice = 'heap' shape = "

/* Spacing statistics: darts alone leave a spread of 0.21 (in space 0.25), particles at random 0.53
   (0.42). */
static void blue_noise_is_even_and_fills_its_body(void **state) {
  (void)state;
  const double pi = acos(-1), segment = 0.725 * 0.725 * acos(0.525 / 0.725) - 0.525 * 0.5;
  const filled bodies[] = {
      {PLANE, BODY "'rectangle' corner = 0, 0 size = 1, 0.5 /", 0.5, 1e-12},
      {PLANE, BODY "'rectangle' corner = 0, 0 size = 1, 0.5 rotation = 30 /", 0.5, 1e-12},
      {PLANE, BODY "'disc' centre = 0, 0 radius = 0.5 inner_radius = 0.2 /", 0.21 * pi, 1e-9},
      {PLANE, BODY "'dog_bone' centre = 0, 0 width = 1 height = 1.5 neck = 0.6 radius = 0.725 /",
       1.5 - 2 * segment, 1e-9},
      {PLANE, BODY "'polygon' points = 0, 0, 1, 0, 1, 0.3, 0.4, 0.3, 0.4, 1, 0, 1 /", 0.58, 1e-12},
      {PLANE,
       BODY "'rectangle' corner = 0, 0 size = 1, 0.5 /\n"
            "&notch lattice = 'heap' shape = 'rectangle' corner = 0.49, -0.1 size = 0.02, 0.4 /",
       0.5 - 0.02 * 0.3, 1e-12},
      {SPACE, BODY "'box' corner = 0, 0, 0 size = 1, 0.6, 0.5 /", 0.3, 1e-12},
      {SPACE, BODY "'sphere' centre = 0, 0, 0 radius = 0.5 /", pi / 6, 1e-3},
      {SPACE, BODY "'cylinder' from = 0, 0, 0 to = 0, 0, 1 radius = 0.4 /", 0.16 * pi, 1e-3}};
  for (size_t n = 0; n < sizeof bodies / sizeof *bodies; n++) {
    bench b;
    begin(&b, bodies[n].keys, bodies[n].groups);
    particle_set *set = make(&b);
    const double expected = bodies[n].size / particle_measure(set->dimensions, set->spacing);
    assert_true(fabs((double)set->count - expected) < 1 + 1e-3 * expected);
    if (fabs(sum_of(set) / bodies[n].size - 1) > bodies[n].tolerance)
      fail_msg("body %zu: off by %.3g", n, sum_of(set) / bodies[n].size - 1);
    if (any_nearer(set, 0.55 * set->spacing) || !(spread(set) < 0.12))
      fail_msg("body %zu: spread %.3f", n, spread(set));
    for (long k = 0; k < set->count; k++) {
      const double at[3] = {set->at[0][k], set->at[1][k], set->dimensions == 3 ? set->at[2][k] : 0};
      assert_true(shape_contains(&b.deck->bodys[0].shape, at, 0));
      if (b.deck->notch_count) assert_false(shape_contains(&b.deck->notchs[0].shape, at, 0));
    }
    end(&b, set);
  }
}

static bool same_places(const particle_set *a, const particle_set *b) {
  return a->count == b->count &&
         memcmp(a->at[0], b->at[0], (size_t)a->count * sizeof(double)) == 0 &&
         memcmp(a->at[1], b->at[1], (size_t)a->count * sizeof(double)) == 0;
}

static void the_seed_alone_decides(void **state) {
  (void)state;
  const char *body = BODY "'disc' centre = 0, 0 radius = 0.2 /";
  const int threads = omp_get_max_threads();
  bench b[3];
  particle_set *set[3];
  for (int k = 0; k < 3; k++) {
    begin(&b[k], k < 2 ? PLANE : PLANE " seed = 2", body);
    omp_set_num_threads(k == 1 ? 1 : 4);
    set[k] = make(&b[k]);
  }
  omp_set_num_threads(threads);
  assert_true(same_places(set[0], set[1]));
  assert_memory_equal(set[0]->volume, set[1]->volume,
                      (size_t)set[0]->count * sizeof *set[0]->volume);
  assert_false(same_places(set[0], set[2]));
  for (int k = 0; k < 3; k++)
    end(&b[k], set[k]);
}

/* A body of another size is filled alike with a spacing in proportion. */
static void lengths_enter_by_the_spacing(void **state) {
  (void)state;
  bench small, large;
  begin(&small, "kind = 'blue_noise' spacing = '1 mm' thickness = 1",
        BODY "'rectangle' corner = 0, 0 size = '16 mm', '8 mm' /");
  begin(&large, "kind = 'blue_noise' spacing = '1.024 m' thickness = 1",
        BODY "'rectangle' corner = 0, 0 size = '16.384 m', '8.192 m' /");
  particle_set *a = make(&small), *c = make(&large);
  assert_int_equal(a->count, c->count);
  for (long k = 0; k < a->count; k++)
    assert_true(fabs(c->volume[k] / (1.024e3 * 1.024e3) / a->volume[k] - 1) < 1e-6);
  end(&small, a);
  end(&large, c);
}

/* --- tables ----------------------------------------------------------------------------------- */

static const char *put_file(const char *name, const char *text) {
  static char path[256];
  char folder[200];
  assert_non_null(getcwd(folder, sizeof folder));
  snprintf(path, sizeof path, "%s/particle_set_%d_%s", folder, (int)getpid(), name);
  FILE *out = fopen(path, "wb");
  assert_non_null(out);
  fputs(text, out);
  fclose(out);
  return path;
}

static void begin_table(bench *b, const char *path, const char *keys, const char *groups) {
  char all[1024];
  snprintf(all, sizeof all, "kind = 'particles' file = '%s' %s", path, keys);
  begin(b, all, groups);
}

static void tables_are_read(void **state) {
  (void)state;
  const char *path = put_file("good.csv", "\xef\xbb\xbf# a comment\r\n\r\n"
                                          "id, \"X [mm]\", y[cm], volume [mm^3]\r\n"
                                          "1, 1.5, 2, 10\r\n"
                                          "# another\n"
                                          "2,-3e0,\t4 ,20\n"
                                          "3,0,0,30"); /* without an end of line */
  bench b;
  begin_table(&b, path, "thickness = '2 mm'", "");
  particle_set *set = make(&b);
  assert_int_equal(set->count, 3);
  assert_true(set->dimensions == 2 && set->at[2] == NULL);
  const double x[3] = {1.5e-3, -3e-3, 0}, y[3] = {0.02, 0.04, 0}, area[3] = {5e-6, 1e-5, 1.5e-5};
  for (int k = 0; k < 3; k++)
    assert_true(fabs(set->at[0][k] - x[k]) < 1e-15 && fabs(set->at[1][k] - y[k]) < 1e-15 &&
                fabs(set->volume[k] - area[k]) < 1e-18);
  assert_true(fabs(set->spacing - sqrt(1e-5 / sqrt(0.75))) < 1e-12);
  end(&b, set);
  unlink(path);
}

/* A square of four in a body of twice its width: the cells are quarters. What is outside is left
   out with a warning. */
static void bodies_give_volumes(void **state) {
  (void)state;
  const char *path =
      put_file("square.csv", "y,x,z\n1,1,1\n1,-1,1\n-1,1,1\n-1,-1,1\n5,0,1\n1.5,1.5,1\n");
  bench b;
  begin_table(&b, path, "setting = 'space'",
              BODY "'box' corner = -2, -2, 0 size = 4, 4, 2 /\n"
                   "&notch lattice = 'heap' shape = 'sphere' centre = 1.5, 1.5, 1 radius = 0.01 /");
  particle_set *set = make(&b);
  assert_int_equal(set->count, 4);
  for (int k = 0; k < 4; k++)
    assert_true(fabs(set->volume[k] - 8) < 1e-5);
  assert_int_equal(b.d.count, 1);
  assert_int_equal(b.d.items[0].code, DIAG_DECK_WARNING);
  assert_non_null(strstr(b.d.items[0].message, "1 of the 6 particles"));
  assert_int_equal(
      source_place(&b.sources, b.d.items[0].note_where.file, b.d.items[0].note_where.begin).line,
      6);
  end(&b, set);
  unlink(path);
}

typedef struct bad_table {
  const char *text, *code, *message;
  int line, column; /* in the table; 0: in the deck */
} bad_table;

static const bad_table bad_tables[] = {
    {"", "empty-region", "holds no particle", 0, 0},
    {"# only this\n", "empty-region", "holds no particle", 0, 0},
    {"x,y,area\n", "empty-region", "holds no particle", 0, 0},
    {"1,2,3\n4,5,6\n", "missing-key", "no column `x`", 1, 1},
    {"x,z,area\n", "missing-key", "no column `y`", 1, 1},
    {"x,y,z,area\n", "conflict", "the lattice is in the plane", 1, 1},
    {"x,y,area,volume\n", "conflict", "exclude each other", 1, 1},
    {"x,y,X\n", "duplicate-name", "second column `x`", 1, 5},
    {"x [inch],y\n", "unknown-unit", "no unit `inch`", 1, 4},
    {"x [kg],y\n", "units", "the unit of `x`", 1, 4},
    {"x [mm,y\n", "syntax", "no closing", 1, 3},
    {"x,y,area\n1,2,3\n4,5\n", "bad-value", "fewer values than the 3 columns", 3, 1},
    {"x,y,area\n1,2,3\n4,5,6,7\n", "bad-value", "more values than the 3 columns", 3, 1},
    {"x,y,area\n1,2,3\n4,,6\n", "bad-value", "no value of `y`", 3, 3},
    {"x,y,area\n1,2,3\n4,5 mm,6\n", "bad-number", "`y` is not a number", 3, 3},
    {"x,y,area\n1,2,3\n4,1e999,6\n", "bad-number", "`y` is not finite", 3, 3},
    {"x,y,area\n1,2,3\n4,5,1e40\n", "bad-number", "`area` is too large", 3, 5},
    {"x,y,area\n1,2,3\nnan,1,6\n", "bad-number", "`x` is not finite", 3, 1},
    {"x,y,area\n1,2,3\n4,5,0\n", "out-of-bounds", "`area` must be positive", 3, 5},
    {"x,y,area\n1,2,3\n4,5,6\n# here\n1,2.000001,9\n", "conflict", "line 2 and line 5", 5, 1},
    {"x,y\n1,2\n4,5\n", "missing-key", "gives no volumes", 0, 0},
};

static void bad_tables_say_where(void **state) {
  (void)state;
  for (size_t n = 0; n < sizeof bad_tables / sizeof *bad_tables; n++) {
    const bad_table *is = &bad_tables[n];
    const char *path = put_file("bad.csv", is->text);
    bench b;
    begin_table(&b, path, "thickness = 1", "");
    assert_null(particle_set_make(b.deck, 0, &b.d));
    assert_int_equal(b.d.count, 1);
    const diagnostic *d = &b.d.items[0];
    const source *from = &b.sources.items[d->where.file];
    const place at = source_place(&b.sources, d->where.file, d->where.begin);
    const bool in_table = strcmp(from->name, path) == 0;
    if (strcmp(diag_name(d->code), is->code) != 0 || !strstr(d->message, is->message) ||
        in_table != (is->line > 0) ||
        (in_table && (at.line != is->line || at.column != is->column)))
      fail_msg("table %zu: %s:%d:%d: %s [%s]", n, from->name, at.line, at.column, d->message,
               diag_name(d->code));
    end(&b, NULL);
    unlink(path);
  }
}

typedef struct bad_set {
  const char *keys, *groups, *code, *message;
} bad_set;

#define TINY "kind = 'blue_noise' spacing = '1 um' thickness = '1 mm'"

static void impossible_sets_are_refused(void **state) {
  (void)state;
  static const bad_set sets[] = {
      {PLANE, BODY "'rectangle' corner = 0, 0 size = '2 mm', '2 mm' /", "empty-region",
       "smaller than one particle"},
      {PLANE,
       BODY "'disc' centre = 0, 0 radius = 0.1 /\n"
            "&notch lattice = 'heap' shape = 'disc' centre = 0, 0 radius = 0.2 /",
       "empty-region", "the notches remove all"},
      {PLANE,
       BODY "'disc' centre = 0, 0 radius = 0.1 /\n" BODY "'disc' centre = 1, 0 radius = '0.1 mm' /",
       "empty-region", "contains no particle"},
      {PLANE, BODY "'rectangle' corner = 0, 0 size = 1e12, 1e-12 /", "out-of-bounds",
       "can be stored"},
      {TINY, BODY "'rectangle' corner = 0, 0 size = 1, 1 /", "out-of-bounds", "can be stored"},
      {"kind = 'particles' file = '/nowhere/at/all.csv' thickness = 1", "", "file", "cannot read"},
      {"kind = 'particles' file = '/' thickness = 1", "", "file", "it is a folder"},
      {"kind = 'particles' file = '/dev/zero' thickness = 1", "", "file", "it is not a file"},
  };
  for (size_t n = 0; n < sizeof sets / sizeof *sets; n++) {
    bench b;
    begin(&b, sets[n].keys, sets[n].groups);
    assert_null(particle_set_make(b.deck, 0, &b.d));
    assert_int_equal(b.d.count, 1);
    assert_string_equal(diag_name(b.d.items[0].code), sets[n].code);
    if (!strstr(b.d.items[0].message, sets[n].message)) fail_msg("%s", b.d.items[0].message);
    end(&b, NULL);
  }
}

/* Far away or without a body, a set is none. */
static void bodies_may_hold_none(void **state) {
  (void)state;
  const char *path = put_file("far.csv", "x,y\n1,2\n3,4\n");
  bench b;
  begin_table(&b, path, "thickness = 1", BODY "'disc' centre = 0, 0 radius = 0.1 /");
  assert_null(particle_set_make(b.deck, 0, &b.d));
  assert_int_equal(b.d.items[0].code, DIAG_EMPTY_REGION);
  assert_non_null(strstr(b.d.items[0].hint, "units"));
  end(&b, NULL);
  unlink(path);
}

/* --- results ---------------------------------------------------------------------------------- */

static const char *put_result(const double reference[2 * PARTICLES], const double *spacing) {
  h5_quiet();
  const char *path = put_file("small.h5", "");
  char error[512];
  double u[2 * PARTICLES], omega[BONDS];
  const double *values[2] = {u, omega}, time[1] = {0};
  result_header header = small_header(path);
  header.reference = reference;
  header.spacing = spacing;
  result *r = small_begin(&header, error, sizeof error);
  assert_non_null(r);
  small_frame(0, u, omega);
  assert_true(result_frame(r, 0, values, error, sizeof error));
  assert_true(small_finish(r, time, 1, NULL, 0, error, sizeof error));
  result_discard(r);
  result_close(r);
  return path;
}

static void remove_result(const char *path) {
  char beside[300];
  unlink(path);
  snprintf(beside, sizeof beside, "%.*s.xdmf", (int)strlen(path) - 3, path);
  unlink(beside);
}

static void results_are_read_back(void **state) {
  (void)state;
  const char *path = put_result(small_reference, NULL);
  bench b;
  begin_table(&b, path, "thickness = '500 mm'", "");
  particle_set *set = make(&b);
  assert_int_equal(set->count, PARTICLES);
  for (int k = 0; k < PARTICLES; k++) {
    assert_true(set->at[0][k] == small_reference[2 * k]);
    assert_true(set->at[1][k] == small_reference[2 * k + 1]);
    assert_true(set->volume[k] == 2 * (k + 1)); /* m^3 over a thickness of 0.5 m */
  }
  end(&b, set);
  begin_table(&b, path, "setting = 'space'", "");
  assert_null(particle_set_make(b.deck, 0, &b.d));
  assert_int_equal(b.d.items[0].code, DIAG_CONFLICT);
  end(&b, NULL);
  assert_int_equal(truncate(path, 3000), 0);
  begin_table(&b, path, "thickness = 1", "");
  assert_null(particle_set_make(b.deck, 0, &b.d));
  assert_int_equal(b.d.items[0].code, DIAG_FILE);
  end(&b, NULL);
  remove_result(path);
}

/* The first particle is left out, the others stand on one place: they are named as the result
   numbers them. */
static void particles_of_results_keep_their_names(void **state) {
  (void)state;
  const double places[2 * PARTICLES] = {9, 9, 0.5, 0.5, 0.5, 0.5};
  const char *path = put_result(places, NULL);
  bench b;
  begin_table(&b, path, "thickness = 1", BODY "'rectangle' corner = 0, 0 size = 1, 1 /");
  assert_null(particle_set_make(b.deck, 0, &b.d));
  const diagnostic *said = &b.d.items[b.d.count - 1];
  assert_int_equal(said->code, DIAG_CONFLICT);
  assert_non_null(strstr(said->message, "particle 1 of the result and particle 2 of the result"));
  end(&b, NULL);
  remove_result(path);
}

/* But where those that the bodies hold are alike. */
static void graded_results_are_refused(void **state) {
  (void)state;
  static const double spacing[PARTICLES] = {0.01, 0.01, 0.03};
  const char *path = put_result(small_reference, spacing);
  bench b;
  begin_table(&b, path, "thickness = 1", "");
  assert_null(particle_set_make(b.deck, 0, &b.d));
  const diagnostic *said = &b.d.items[b.d.count - 1];
  assert_int_equal(said->code, DIAG_CONFLICT);
  assert_non_null(strstr(said->message, "are graded, with spacings from 10 to 30 mm"));
  end(&b, NULL);
  begin_table(&b, path, "thickness = 1", BODY "'rectangle' corner = -0.1, -0.1 size = 1.2, 0.2 /");
  particle_set *set = make(&b);
  assert_int_equal(set->count, 2);
  end(&b, set);
  remove_result(path);
}

/* --- any text --------------------------------------------------------------------------------- */

/* Texts with bytes changed, taken out and doubled either are sets of finite particles or get a
   message. */
static void any_table_is_a_set_or_a_message(void **state) {
  (void)state;
  static const char start[] = "# heap\nx [mm], y [mm], area [mm^2], id\n1, 2, 3, a\n4, 5.5, 6, b\n"
                              "-7e0, .8, 9, c\n10, 1e1, 12, d\n";
  static const char bytes[] = ",,\n\n[]\"# \t\r0123456789.eE+-xyzn\x80\xff";
  uint64_t seed = 1;
  int sets = 0, messages = 0;
  for (int n = 0; n < 1500; n++) {
    char text[2 * sizeof start];
    strcpy(text, start);
    for (uint64_t changes = random_mix(seed++) % 4; changes-- > 0;) {
      const size_t length = strlen(text), at = random_mix(seed++) % length;
      const char with = bytes[random_mix(seed++) % (sizeof bytes - 1)];
      switch (random_mix(seed++) % 4) {
      case 0:
        text[at] = with;
        break;
      case 1:
        memmove(text + at, text + at + 1, length - at);
        break;
      case 2:
        text[at] = '\0';
        break;
      default:
        if (length + 2 > sizeof text) break;
        memmove(text + at + 1, text + at, length - at + 1);
        text[at] = with;
      }
      if (*text == '\0') strcpy(text, ",");
    }
    const char *path = put_file("any.csv", text);
    bench b;
    begin_table(&b, path, "thickness = 1", "");
    particle_set *set = particle_set_make(b.deck, 0, &b.d);
    assert_true((set == NULL) == (b.d.errors > 0));
    sets += set != NULL;
    messages += set == NULL;
    for (long k = 0; set && k < set->count; k++)
      assert_true(isfinite(set->at[0][k]) && isfinite(set->at[1][k]) && set->volume[k] > 0 &&
                  isfinite(set->volume[k]));
    end(&b, set);
    unlink(path);
  }
  assert_true(sets > 100 && messages > 100);
}

int main(void) {
  const struct CMUnitTest tests[] = {cmocka_unit_test(blue_noise_is_even_and_fills_its_body),
                                     cmocka_unit_test(the_seed_alone_decides),
                                     cmocka_unit_test(lengths_enter_by_the_spacing),
                                     cmocka_unit_test(tables_are_read),
                                     cmocka_unit_test(bodies_give_volumes),
                                     cmocka_unit_test(bad_tables_say_where),
                                     cmocka_unit_test(impossible_sets_are_refused),
                                     cmocka_unit_test(bodies_may_hold_none),
                                     cmocka_unit_test(results_are_read_back),
                                     cmocka_unit_test(particles_of_results_keep_their_names),
                                     cmocka_unit_test(graded_results_are_refused),
                                     cmocka_unit_test(any_table_is_a_set_or_a_message)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
