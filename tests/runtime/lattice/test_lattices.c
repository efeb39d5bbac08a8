/* Lattices of every kind against their definitions: sites, neighbours and bonds of random bodies by
   all pairs, known counts and shells, opposite neighbours, volumes, and the time that a million
   particles take. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#include <cmocka.h>

#include "dsl/base/arena.h"
#include "runtime/geometry/shape.h"
#include "runtime/lattice/rows.h"
#include "runtime/lattice/rows_build.h"
#include "runtime/lattice/rows_select.h"
#include "tests/runtime/lattice/filled_lattice.h"

static void begin(filled_lattice *b, const char *kind, double horizon, int shells) {
  fill_begin(b, (deck_lattice){.name = "body",
                               .kind = kind,
                               .spacing = 1,
                               .horizon = horizon,
                               .shells = shells,
                               .area = 0.3,
                               .mass_thickness = 0.3,
                               .stiffness_thickness = 0.3});
}

static uint64_t state;

static double uniform(double low, double high) {
  state = state * UINT64_C(6364136223846793005) + UINT64_C(1442695040888963407);
  return low + (high - low) * (double)(state >> 11) / 9007199254740992.0;
}

/* --- families --------------------------------------------------------------------------------- */

typedef struct family {
  const char *kind;
  double horizon;
  int shells;
  int neighbours, last_shell;
  double volume; /* of a particle, thickness 0.3 in the plane, area 0.3 of a chain */
  double last;   /* length of the last */
} family;

static const family families[] = {
    {"hexagonal", 0, 0, 6, 1, 0.25980762113533159, 1},
    {"hexagonal", 2, 0, 18, 3, 0.25980762113533159, 2},
    {"square", 0, 0, 4, 1, 0.3, 1},
    {"square", 0, 2, 8, 2, 0.3, 1.4142135623730951},
    {"square", 3.015, 0, 28, 6, 0.3, 3},
    {"square", 3, 0, 28, 6, 0.3, 3}, /* a site on the horizon belongs to it */
    {"square", 6, 0, 112, 18, 0.3, 6},
    {"cubic", 0, 0, 6, 1, 1, 1},
    {"cubic", 0, 3, 26, 3, 1, 1.7320508075688772},
    {"cubic", 3.015, 0, 122, 8, 1, 3},
    {"fcc", 0, 0, 12, 1, 0.70710678118654757, 1},
    {"fcc", 0, 2, 18, 2, 0.70710678118654757, 1.4142135623730951},
    {"fcc", 1.5, 0, 18, 2, 0.70710678118654757, 1.4142135623730951},
    {"fcc", 2, 0, 54, 4, 0.70710678118654757, 2},
    {"chain", 0, 0, 2, 1, 0.3, 1},
    {"chain", 3.015, 0, 6, 3, 0.3, 3},
};
enum { FAMILIES = sizeof families / sizeof *families };

static deck_shape middle_of(const char *kind) {
  static const double reach = 3;
  if (bravais_dimensions(kind) == 2) return (deck_shape){.kind = SHAPE_DISC, .radius = reach};
  return (deck_shape){.kind = SHAPE_SPHERE, .radius = reach};
}

static void families_have_their_neighbours(void **unused) {
  (void)unused;
  for (int f = 0; f < FAMILIES; f++) {
    const family *is = &families[f];
    filled_lattice b;
    begin(&b, is->kind, is->horizon, is->shells);
    add_body(&b, middle_of(is->kind));
    rows *w = fill_rows(&b);
    const int n = w->directions;
    assert_int_equal(2 * n, is->neighbours);
    assert_int_equal(w->shell[n - 1], is->last_shell);
    assert_true(fabs(w->length[n - 1] - is->last) < 1e-15 * is->last);
    assert_true(fabs(w->volume - is->volume) < 1e-15);
    for (int k = 0; k < n; k++) {
      const pl_bond_class c = rows_bond_class(w, k), o = rows_bond_class(w, k + n);
      assert_true(fabs(hypot(hypot(c.chord[0], c.chord[1]), c.chord[2]) - c.s) < 1e-15 * c.s);
      for (int a = 0; a < 3; a++)
        assert_true(o.chord[a] == -c.chord[a]);
      assert_true(c.s == o.s && c.shell == w->shell[k] && o.shell == c.shell);
      assert_true(c.n == is->neighbours && c.weight == 1 && c.V == w->volume);
      if (k) assert_true(w->length[k] >= w->length[k - 1] && w->shell[k] >= w->shell[k - 1]);
      if (k) assert_int_equal(w->length[k] == w->length[k - 1], w->shell[k] == w->shell[k - 1]);
    }
    fill_end(&b, w);
  }
}

/* Within a shell by layer, by row, from far to near along the row: part of what results mean. */
static void order_is_stable(void **unused) {
  (void)unused;
  static const double square[][2] = {{1, 0}, {0, 1}, {1, 1}, {-1, 1}};
  static const double fcc[][3] = {{1, 1, 0}, {-1, 1, 0}, {0, -1, 1},
                                  {1, 0, 1}, {-1, 0, 1}, {0, 1, 1}};
  filled_lattice b;
  begin(&b, "square", 0, 2);
  add_body(&b, middle_of("square"));
  rows *w = fill_rows(&b);
  for (int k = 0; k < 4; k++)
    for (int c = 0; c < 2; c++)
      assert_true(fabs(w->chord[k][c] - square[k][c]) < 1e-15);
  fill_end(&b, w);
  begin(&b, "fcc", 0, 1);
  add_body(&b, middle_of("fcc"));
  w = fill_rows(&b);
  assert_int_equal(w->directions, 6);
  for (int k = 0; k < 6; k++)
    for (int c = 0; c < 3; c++)
      assert_true(fabs(w->chord[k][c] - sqrt(0.5) * fcc[k][c]) < 1e-15);
  fill_end(&b, w);
}

static void linear_correction_weighs_the_horizon(void **unused) {
  (void)unused;
  filled_lattice b;
  begin(&b, "square", 3.015, 0);
  b.lattice.volume_correction = VOLUME_LINEAR;
  add_body(&b, middle_of("square"));
  rows *w = fill_rows(&b);
  for (int k = 0; k < w->directions; k++) {
    const double part = fmin(fmax(3.515 - w->length[k], 0), 1);
    assert_true(fabs(w->weight[k] - part) < 1e-14);
    assert_true(rows_bond_class(w, k + w->directions).weight == w->weight[k]);
  }
  assert_true(w->weight[0] == 1 && fabs(w->weight[w->directions - 1] - 0.515) < 1e-14);
  fill_end(&b, w);
}

/* --- random bodies by all pairs --------------------------------------------------------------- */

static deck_shape random_body(int dimensions, int number) {
  const double at[3] = {uniform(-2, 2), uniform(-2, 2), dimensions == 3 ? uniform(-2, 2) : 0};
  deck_shape s = {.centre = {at[0], at[1], at[2]}, .corner = {at[0], at[1], at[2]}};
  s.size[0] = uniform(1, 5);
  s.size[1] = uniform(1, 5);
  s.size[2] = uniform(1, 5);
  s.radius = uniform(1.5, 3);
  s.inner_radius = uniform(0, 1);
  s.rotation = uniform(-3, 3);
  if (dimensions == 2) {
    s.kind = number % 2 ? SHAPE_DISC : SHAPE_RECTANGLE;
    return s;
  }
  s.kind = number % 3 == 0 ? SHAPE_BOX : number % 3 == 1 ? SHAPE_SPHERE : SHAPE_CYLINDER;
  memcpy(s.from, at, sizeof at);
  for (int c = 0; c < 3; c++)
    s.to[c] = at[c] + uniform(1, 3);
  return s;
}

static const double facet[] = {-6, -6, 0.13, 6, -6, 0.37, 6, 0.3, 0.37, -6, 0.3, 0.13};

static deck_shape random_notch(int dimensions, int number) {
  deck_shape s = {.from = {uniform(-3, 3), uniform(-3, 3)}, .to = {uniform(-3, 3), uniform(-3, 3)}};
  if (dimensions == 2 && number % 2) {
    s.kind = SHAPE_SEGMENT;
  } else if (dimensions == 2) {
    s.kind = SHAPE_RECTANGLE;
    s.size[0] = 0.2;
    s.size[1] = uniform(1, 4);
    s.rotation = uniform(-3, 3);
  } else if (number % 2) {
    s.kind = SHAPE_FACE;
    s.points = facet;
    s.point_count = 4;
  } else {
    s.kind = SHAPE_BOX;
    s.corner[0] = uniform(-1, 1);
    s.corner[1] = s.corner[2] = -5;
    s.size[0] = 0.05;
    s.size[1] = 4;
    s.size[2] = 10;
  }
  return s;
}

static void random_lattice(filled_lattice *b, const family *is, int number) {
  begin(b, is->kind, is->horizon, is->shells);
  const int dimensions = bravais_dimensions(is->kind);
  const double far = deck_lattice_is_chain(&b->lattice) ? 1 : 9;
  b->lattice.rotation = number % 4 == 0 ? 0 : uniform(-3, 3);
  for (int c = 0; c < dimensions; c++) {
    b->lattice.origin[c] = uniform(-far, far);
    if (dimensions == 3 && number % 2) b->lattice.axis[c] = uniform(-1, 1);
  }
  for (int k = 0; k < 2; k++)
    add_body(b, random_body(dimensions, number + k));
  for (int k = 0; k < 2; k++)
    add_notch(b, random_notch(dimensions, number + k), true);
}

/* A vector turned with the lattice. */
static void turned(const filled_lattice *b, const double v[3], double out[3]) {
  const double *n = b->lattice.axis, size = hypot(hypot(n[0], n[1]), n[2]);
  const double e[3] = {size > 0 ? n[0] / size : 0, size > 0 ? n[1] / size : 0,
                       size > 0 ? n[2] / size : 1};
  const double c = cos(b->lattice.rotation), s = sin(b->lattice.rotation);
  const double along = e[0] * v[0] + e[1] * v[1] + e[2] * v[2];
  for (int a = 0; a < 3; a++) {
    const int p = (a + 1) % 3, q = (a + 2) % 3;
    out[a] = along * e[a] + c * (v[a] - along * e[a]) + s * (e[p] * v[q] - e[q] * v[p]);
  }
}

static const double basis_of[][3][3] = {
    {{1, 0, 0}, {0.5, 0.86602540378443865, 0}, {0, 0, 0}},
    {{1, 0, 0}, {0, 1, 0}, {0, 0, 0}},
    {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}},
    {{0.70710678118654757, 0.70710678118654757, 0},
     {0.70710678118654757, 0, 0.70710678118654757},
     {0, 0.70710678118654757, 0.70710678118654757}},
    {{1, 0, 0}, {0, 0, 0}, {0, 0, 0}},
};

static int basis_index(const char *kind) {
  static const char *const kinds[] = {"hexagonal", "square", "cubic", "fcc", "chain"};
  int k = 0;
  while (strcmp(kind, kinds[k]) != 0)
    k++;
  return k;
}

static bool wanted(const filled_lattice *b, const double p[3]) {
  bool in = false;
  for (int k = 0; k < b->deck.body_count; k++)
    in = in || shape_contains(&b->bodies[k].shape, p, 1e-6);
  for (int k = 0; k < b->deck.notch_count; k++)
    in = in && !shape_contains(&b->notches[k].shape, p, 1e-6);
  return in;
}

/* Count and centre of the sites straight from the definition: origin + sums of lattice vectors. */
static void check_sites(const filled_lattice *b, const rows *w) {
  enum { REACH = 32 };
  double basis[3][3], sum[3] = {0}, stored[3] = {0};
  const int last = w->dimensions == 3 ? REACH : 0, across = rows_are_chain(w) ? 0 : REACH;
  long count = 0;
  for (int k = 0; k < 3; k++)
    turned(b, basis_of[basis_index(b->lattice.kind)][k], basis[k]);
  for (int i = -REACH; i <= REACH; i++)
    for (int j = -across; j <= across; j++)
      for (int l = -last; l <= last; l++) {
        double p[3];
        for (int c = 0; c < 3; c++)
          p[c] = b->lattice.origin[c] + i * basis[0][c] + j * basis[1][c] + l * basis[2][c];
        if (hypot(hypot(p[0], p[1]), p[2]) > 16 || !wanted(b, p)) continue;
        count++;
        for (int c = 0; c < 3; c++)
          sum[c] += p[c];
      }
  for (long n = 0; n < w->particle_count; n++) {
    double p[3];
    rows_place(w, w->particle_site[n], p);
    assert_true(wanted(b, p));
    for (int c = 0; c < 3; c++)
      stored[c] += p[c];
  }
  assert_int_equal(w->particle_count, count);
  for (int c = 0; c < 3; c++)
    assert_true(fabs(sum[c] - stored[c]) < 1e-9 * (double)count);
}

static void check_storage(const rows *w) {
  const int n = w->directions;
  assert_true(w->pitch % PL_LANES == 0 && w->first % PL_LANES == 0);
  for (int r = 0; r < w->row_count; r++)
    for (int k = 0; k < 2 * n; k++) { /* whole rows, with all that a strip reads */
      assert_true(rows_start(w, r) + rows_offset(w, r, k) >= 0);
      assert_true(rows_start(w, r) + rows_offset(w, r, k) + w->pitch <= w->size);
    }
  long particles = 0;
  for (long site = 0; site < w->size; site++) {
    if (!w->present[site]) assert_true(w->bonds[site] == 0 && w->site_particle[site] == -1);
    particles += w->present[site];
  }
  assert_int_equal(particles, w->particle_count);
  for (long p = 0; p < w->particle_count; p++) {
    const long site = w->particle_site[p];
    assert_int_equal(w->site_particle[site], p);
    for (int k = 0; k < 2 * n; k++) {
      const long other = rows_partner(w, site, k);
      const pl_bond_class c = rows_bond_class(w, k);
      double from[3], to[3];
      assert_true(other >= 0 && other < w->size);
      if (!w->present[other]) continue;
      rows_place(w, site, from);
      rows_place(w, other, to);
      for (int a = 0; a < 3; a++)
        assert_true(fabs(to[a] - from[a] - c.chord[a]) < 1e-12);
      assert_int_equal(rows_partner(w, other, (k + n) % (2 * n)), site);
    }
  }
}

/* Every pair within the horizon and 0.1 % more has its bond once, if no notch is between. */
static void check_bonds(const filled_lattice *b, const rows *w) {
  const long n = w->particle_count;
  const double reach = 1.001 * w->length[w->directions - 1];
  unsigned char *joined = must_calloc((size_t)(n * n) + 1, 1);
  rows_bond *bonds = rows_bonds(w);
  for (long m = 0; m < w->bond_count; m++) {
    const long i = bonds[m].i, j = bonds[m].j;
    assert_true(i < j);
    assert_int_equal(bonds[m].slot % w->size, w->particle_site[i]);
    assert_int_equal(joined[i * n + j]++, 0);
  }
  for (long i = 0; i < n; i++)
    for (long j = i + 1; j < n; j++) {
      double p[3], q[3];
      rows_place(w, w->particle_site[i], p);
      rows_place(w, w->particle_site[j], q);
      bool near = bravais_distance(p, q) < reach;
      for (int k = 0; near && k < b->deck.notch_count; k++)
        near = !shape_crossed(&b->notches[k].shape, p, q, 1e-9);
      assert_int_equal(joined[i * n + j], near);
    }
  free(bonds);
  free(joined);
}

static void random_bodies_agree_with_all_pairs(void **unused) {
  (void)unused;
  long particles = 0, bonds = 0, in_chains = 0;
  state = 2026;
  for (int f = 0; f < FAMILIES; f++)
    for (int n = 0; n < 12; n++) {
      filled_lattice b;
      random_lattice(&b, &families[f], n);
      rows *w = lattice_build(&b.deck, 0, &b.d);
      if (!w || w->particle_count > 1500) {
        fill_end(&b, w);
        continue;
      }
      check_storage(w);
      check_sites(&b, w);
      check_bonds(&b, w);
      particles += w->particle_count;
      bonds += w->bond_count;
      in_chains += rows_are_chain(w) ? w->particle_count : 0;
      fill_end(&b, w);
    }
  print_message("%ld particles, %ld bonds compared\n", particles, bonds);
  assert_true(particles > 5000 && bonds > 50000 && in_chains > 30);
}

/* --- bodies ----------------------------------------------------------------------------------- */

static void volumes_converge(void **unused) {
  (void)unused;
  static const char *const kinds[] = {"cubic", "fcc"};
  const double exact = acos(-1) * 0.5 * 0.5 * 1.3;
  for (int k = 0; k < 2; k++) {
    double before = INFINITY;
    for (int level = 0; level < 3; level++) {
      double error = 0; /* mean over places of the lattice: a single one is erratic */
      for (int try = 0; try < 4; try++) {
        filled_lattice b;
        begin(&b, kinds[k], 0, 0);
        b.lattice.spacing = 0.1 / (1 << level);
        b.lattice.rotation = 0.21 * try;
        b.lattice.axis[0] = b.lattice.axis[2] = 1;
        b.lattice.origin[2] = 0.0137 * try;
        add_body(&b,
                 (deck_shape){
                     .kind = SHAPE_CYLINDER, .from = {0, 0, 0}, .to = {0, 0, 1.3}, .radius = 0.5});
        rows *w = fill_rows(&b);
        error += fabs((double)w->particle_count * w->volume / exact - 1) / 4;
        assert_true(fabs(w->width - 1) < 0.1 && fabs(w->height - 1) < 0.1);
        assert_true(fabs(w->depth - 1.3) < 0.1);
        fill_end(&b, w);
      }
      print_message("%s cylinder: spacing %.4f, volume error %.2e\n", kinds[k], 0.1 / (1 << level),
                    error);
      assert_true(error < before);
      before = error;
    }
    assert_true(before < 1e-2);
  }
}

static void points_find_their_site(void **unused) {
  (void)unused;
  static const char *const kinds[] = {"hexagonal", "square", "cubic", "fcc", "chain"};
  state = 5;
  for (int k = 0; k < 5; k++)
    for (int n = 0; n < 200; n++) {
      filled_lattice b;
      double best = INFINITY, p[3];
      int32_t *list;
      begin(&b, kinds[k], 0, 0);
      b.lattice.rotation = uniform(-3, 3);
      add_body(&b, middle_of(kinds[k]));
      const double away = k < 4 ? 1.4 : 0.6; /* from a chain no more than `within` */
      deck_shape point = {.kind = SHAPE_POINT, .at = {uniform(-away, away), uniform(-away, away)}};
      if (k == 2 || k == 3) point.at[2] = uniform(-1.4, 1.4);
      point.within = 1;
      add_body(&b, point); /* is there already */
      rows *w = fill_rows(&b);
      assert_int_equal(rows_select(w, &point, &list), 1);
      rows_place(w, w->particle_site[list[0]], p);
      const double chosen = bravais_distance(p, point.at);
      for (long m = 0; m < w->particle_count; m++) {
        rows_place(w, w->particle_site[m], p);
        best = fmin(best, bravais_distance(p, point.at));
      }
      assert_true(chosen < best + 1e-9);
      free(list);
      rows_free(w);
      b.bodies[0] = b.bodies[1]; /* alone: the one site nearest to it */
      b.deck.body_count = 1;
      w = fill_rows(&b);
      assert_int_equal(w->particle_count, 1);
      rows_place(w, w->particle_site[0], p);
      assert_true(fabs(bravais_distance(p, point.at) - chosen) < 1e-9);
      fill_end(&b, w);
    }
}

static void protection_reaches_as_far_as_asked(void **unused) {
  (void)unused;
  static const double radii[] = {0, 1, 1.01, 1.75, 3.3, 1e9};
  for (int f = 0; f < FAMILIES; f++)
    for (size_t r = 0; r < sizeof radii / sizeof *radii; r++) {
      filled_lattice b;
      begin(&b, families[f].kind, families[f].horizon, families[f].shells);
      b.lattice.rotation = 0.3;
      add_body(&b, middle_of(families[f].kind));
      rows *w = fill_rows(&b);
      const int32_t feet[] = {0, (int32_t)w->particle_count / 2};
      double at[2][3];
      rows_protect(w, feet, 2, radii[r]);
      for (int k = 0; k < 2; k++)
        rows_place(w, w->particle_site[feet[k]], at[k]);
      for (long p = 0; p < w->particle_count; p++) {
        const long site = w->particle_site[p];
        double here[3];
        rows_place(w, site, here);
        const double away = fmin(bravais_distance(here, at[0]), bravais_distance(here, at[1]));
        assert_int_equal(w->held[site], away <= radii[r] + 1e-6);
        for (int k = 0; k < w->directions; k++) {
          const bool held = w->held_bonds[site] >> k & 1;
          const bool near = w->held[site] || w->held[rows_partner(w, site, k)];
          assert_int_equal(held, rows_has_bond(w, site, k) && near);
        }
      }
      fill_end(&b, w);
    }
}

static void faults_are_reported(void **unused) {
  (void)unused;
  filled_lattice b;
  begin(&b, "cubic", 4, 0);
  add_body(&b, middle_of("cubic"));
  assert_null(lattice_build(&b.deck, 0, &b.d));
  assert_non_null(strstr(b.d.items[0].message, "more than 128 neighbours"));
  fill_end(&b, NULL);
  begin(&b, "square", 0.9, 0);
  add_body(&b, middle_of("square"));
  assert_null(lattice_build(&b.deck, 0, &b.d));
  assert_non_null(strstr(b.d.items[0].message, "reaches no neighbour"));
  fill_end(&b, NULL);
  begin(&b, "fcc", 0, 0);
  b.lattice.spacing = 1e-3;
  add_body(&b, middle_of("fcc"));
  assert_null(lattice_build(&b.deck, 0, &b.d));
  assert_non_null(strstr(b.d.items[0].message, "sites"));
  fill_end(&b, NULL);
}

static double seconds(void) {
  struct timespec t;
  clock_gettime(CLOCK_MONOTONIC, &t);
  return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

/* The limit is far above what it takes; work that grew faster than the particles would pass it. */
static void a_million_particles_take_seconds(void **unused) {
  (void)unused;
  filled_lattice b;
  begin(&b, "cubic", 3.015, 0);
  add_body(&b, (deck_shape){.kind = SHAPE_BOX, .size = {99, 99, 99}});
  add_notch(&b, (deck_shape){.kind = SHAPE_BOX, .corner = {49.4, -1, -1}, .size = {0.2, 50, 101}},
            true);
  const double begun = seconds();
  rows *w = fill_rows(&b);
  const double taken = seconds() - begun;
  print_message("%ld particles, %ld bonds: built in %.2f s\n", w->particle_count, w->bond_count,
                taken);
  assert_int_equal(w->particle_count, 1000000);
  assert_true(w->bond_count > 58000000);
  assert_true(taken < 30);
  fill_end(&b, w);
}

/* Particles on no lattice have no rows to build. */
static void a_kind_without_sites_is_refused(void **unused) {
  (void)unused;
  static const char *const kinds[] = {"blue_noise", "particles", "hexagon"};
  for (int k = 0; k < 3; k++) {
    filled_lattice b;
    begin(&b, kinds[k], 0, 0);
    add_body(&b, (deck_shape){.kind = SHAPE_DISC, .radius = 3});
    assert_null(rows_build(&b.deck, 0, &b.d));
    assert_int_equal(b.d.count, 1);
    assert_non_null(strstr(b.d.items[0].message, "there is no lattice of kind"));
    fill_end(&b, NULL);
  }
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(a_kind_without_sites_is_refused),
      cmocka_unit_test(families_have_their_neighbours),
      cmocka_unit_test(order_is_stable),
      cmocka_unit_test(linear_correction_weighs_the_horizon),
      cmocka_unit_test(random_bodies_agree_with_all_pairs),
      cmocka_unit_test(volumes_converge),
      cmocka_unit_test(points_find_their_site),
      cmocka_unit_test(protection_reaches_as_far_as_asked),
      cmocka_unit_test(faults_are_reported),
      cmocka_unit_test(a_million_particles_take_seconds),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
