/* The lattice in rows against its definition (all pairs of sites), published particle counts and
 * geometry. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "dsl/base/arena.h"
#include "runtime/geometry/shape.h"
#include "runtime/lattice/rows.h"
#include "runtime/lattice/rows_select.h"
#include "tests/runtime/lattice/filled_lattice.h"

static const double degree = 0.017453292519943295;

static void begin(filled_lattice *b, double spacing) {
  fill_begin(b, (deck_lattice){.name = "concrete",
                               .kind = "hexagonal",
                               .spacing = spacing,
                               .thickness = 0.1524,
                               .stiffness_thickness = 0.127,
                               .mass_thickness = 0.12});
}

static deck_shape rectangle(double x, double y, double w, double h) {
  return (deck_shape){.kind = SHAPE_RECTANGLE, .corner = {x, y}, .size = {w, h}};
}

static deck_shape disc(double x, double y, double radius, double inner) {
  return (deck_shape){
      .kind = SHAPE_DISC, .centre = {x, y}, .radius = radius, .inner_radius = inner};
}

static deck_shape point(double x, double y) {
  return (deck_shape){.kind = SHAPE_POINT, .at = {x, y}};
}

static deck_shape polygon(const double *points, int count) {
  return (deck_shape){.kind = SHAPE_POLYGON, .points = points, .point_count = count};
}

static long partner(const rows *w, long site, int k) {
  return rows_partner(w, site, k);
}

/* --- invariants of the storage ------------------------------------------------------------------
 */

static void check_storage(const rows *w) {
  long particles = 0, bonds = 0;
  assert_true(w->pitch % PL_LANES == 0 && w->pitch % 512 != 0);
  assert_true(w->size >= (w->row_count + 2) * w->pitch);
  assert_true((uintptr_t)w->bonds % PL_ALIGNMENT == 0);
  assert_true((uintptr_t)(w->x + rows_start(w, 0)) % PL_ALIGNMENT == 0);
  for (long site = 0; site < w->size; site++) {
    const int row = site < w->first ? -1 : rows_row(w, site);
    const long column = site - rows_start(w, row);
    const bool ghost = row < 0 || row >= w->row_count || column < 1 || column >= w->pitch - 1;
    if (ghost) assert_true(w->present[site] == 0 && w->bonds[site] == 0);
    if (!w->present[site]) {
      assert_int_equal(w->site_particle[site], -1);
      assert_true(w->bonds[site] == 0);
      continue;
    }
    assert_int_equal(w->site_particle[site], particles);
    assert_int_equal(w->particle_site[particles], site);
    particles++;
    for (int k = 0; k < w->directions; k++) {
      const long other = partner(w, site, k);
      assert_true(other >= 0 && other < w->size);
      if (!rows_has_bond(w, site, k)) continue;
      bonds++;
      assert_true(w->present[other]);
      assert_true(fabs(w->x[other] - w->x[site] - w->chord[k][0]) < 1e-9 * w->spacing);
      assert_true(fabs(w->y[other] - w->y[site] - w->chord[k][1]) < 1e-9 * w->spacing);
      assert_true(fabs(hypot(w->chord[k][0], w->chord[k][1]) - w->length[k]) < 1e-14 * w->spacing);
    }
  }
  assert_int_equal(particles, w->particle_count);
  assert_int_equal(bonds, w->bond_count);
  /* the far end of the last row's strips must lie in the arrays */
  for (int k = 0; k < 2 * w->directions; k++) {
    const int last = w->row_count - 1;
    assert_true(rows_start(w, 0) + rows_offset(w, 0, k) >= 0);
    assert_true(rows_start(w, last) + rows_offset(w, last, k) + w->pitch <= w->size);
  }
}

/* Bonds are all pairs of particles within 1.001 spacings, each once, less those whose chord crosses
 * a notch. */
static void check_bonds(const filled_lattice *b, const rows *w) {
  const long n = w->particle_count;
  unsigned char *joined = must_calloc((size_t)(n * n), 1);
  rows_bond *bonds = rows_bonds(w);
  for (long m = 0; m < w->bond_count; m++) {
    const long i = bonds[m].i, j = bonds[m].j;
    const long site = bonds[m].slot % w->size, k = bonds[m].slot / w->size;
    assert_true(i < j); /* the lower, then left end owns it */
    assert_int_equal(w->particle_site[i], site);
    assert_true(rows_has_bond(w, site, (int)k));
    assert_int_equal(joined[i * n + j], 0);
    joined[i * n + j] = 1;
  }
  for (long i = 0; i < n; i++) {
    for (long j = i + 1; j < n; j++) {
      const long p = w->particle_site[i], q = w->particle_site[j];
      bool near = hypot(w->x[q] - w->x[p], w->y[q] - w->y[p]) < 1.001 * w->spacing;
      const double from[2] = {w->x[p], w->y[p]}, to[2] = {w->x[q], w->y[q]};
      for (int k = 0; near && k < b->deck.notch_count; k++)
        if (b->notches[k].cut_bonds &&
            shape_crossed(&b->notches[k].shape, from, to, 1e-9 * w->spacing))
          near = false;
      assert_int_equal(joined[i * n + j], near);
    }
  }
  free(bonds);
  free(joined);
}

static bool wanted(const filled_lattice *b, const double p[2]) {
  const double tolerance = 1e-6 * b->lattice.spacing;
  bool in = false;
  for (int k = 0; k < b->deck.body_count; k++)
    in = in || shape_contains(&b->bodies[k].shape, p, tolerance);
  for (int k = 0; k < b->deck.notch_count; k++)
    in = in && !shape_contains(&b->notches[k].shape, p, tolerance);
  return in;
}

/* Sites straight from the definition: origin + p a1 + q a2, over more than the bodies' box. */
static void check_sites(const filled_lattice *b, const rows *w, int reach) {
  const deck_lattice *l = &b->lattice;
  const double c = cos(l->rotation), s = sin(l->rotation);
  const double a1[2] = {l->spacing * c, l->spacing * s};
  const double a2[2] = {l->spacing * cos(l->rotation + 60 * degree),
                        l->spacing * sin(l->rotation + 60 * degree)};
  long count = 0;
  double sum[2] = {0, 0}, stored[2] = {0, 0};
  for (int p = -reach; p <= reach; p++) {
    for (int q = -reach; q <= reach; q++) {
      const double at[2] = {l->origin[0] + p * a1[0] + q * a2[0],
                            l->origin[1] + p * a1[1] + q * a2[1]};
      if (!wanted(b, at)) continue;
      count++;
      sum[0] += at[0];
      sum[1] += at[1];
    }
  }
  for (long n = 0; n < w->particle_count; n++) {
    const double at[2] = {w->x[w->particle_site[n]], w->y[w->particle_site[n]]};
    assert_true(wanted(b, at));
    stored[0] += at[0];
    stored[1] += at[1];
  }
  assert_int_equal(w->particle_count, count);
  assert_true(fabs(sum[0] - stored[0]) < 1e-9 * (double)count);
  assert_true(fabs(sum[1] - stored[1]) < 1e-9 * (double)count);
}

/* --- tests --------------------------------------------------------------------------------------
 */

static void neighbours_are_all_near_pairs(void **unused) {
  (void)unused;
  static const double rotations[] = {0, 17, 23.7, 90, -123.4};
  static const double origins[][2] = {{0, 0}, {0.00313, -0.0271}, {1.7213, 0.4411}};
  static const double arm[] = {0.05, 0.02, 0.14, 0.05, 0.12, 0.11, 0.09, 0.06, 0.04, 0.12};
  for (int r = 0; r < 5; r++) {
    for (int o = 0; o < 3; o++) {
      filled_lattice b;
      begin(&b, 6e-3);
      b.lattice.rotation = rotations[r] * degree;
      memcpy(b.lattice.origin, origins[o], sizeof origins[o]);
      add_body(&b, rectangle(0, 0, 0.1, 0.05));
      add_body(&b, disc(0.1, 0.05, 0.03, 0.012));
      add_body(&b, polygon(arm, 5));
      add_notch(&b, rectangle(0.03, -0.01, 0.002, 0.04), true);
      add_notch(&b, disc(0.1, 0.09, 0.01, 0), true);
      add_notch(&b, disc(0.06, 0.02, 0.007, 0), false);
      rows *w = fill_rows(&b);
      check_storage(w);
      check_bonds(&b, w);
      check_sites(&b, w, o == 2 ? 700 : 60);
      fill_end(&b, w);
    }
  }
}

/* The infinite lattice is the same whichever of its sites is the origin, and after a turn by 60
 * degrees. */
static void renumbering_changes_nothing(void **unused) {
  (void)unused;
  static const int steps[][3] = {{0, 0, 0},  {1, 0, 0},   {0, 1, 0},
                                 {-3, 7, 0}, {4, -5, 60}, {0, 1, 120}};
  long particles = 0, bonds = 0;
  for (int k = 0; k < 6; k++) {
    filled_lattice b;
    begin(&b, 6e-3);
    const double turn = 11 * degree, s = b.lattice.spacing;
    b.lattice.rotation = turn + steps[k][2] * degree;
    b.lattice.origin[0] = s * (steps[k][0] * cos(turn) + steps[k][1] * cos(turn + 60 * degree));
    b.lattice.origin[1] = s * (steps[k][0] * sin(turn) + steps[k][1] * sin(turn + 60 * degree));
    add_body(&b, rectangle(0.001, 0.0005, 0.2, 0.1));
    add_body(&b, disc(0.2, 0.1, 0.041, 0.0133));
    add_notch(&b, rectangle(0.1, 0, 0.0017, 0.0503), true);
    rows *w = fill_rows(&b);
    check_storage(w);
    if (k == 0) {
      particles = w->particle_count;
      bonds = w->bond_count;
    }
    assert_int_equal(w->particle_count, particles);
    assert_int_equal(w->bond_count, bonds);
    fill_end(&b, w);
  }
}

/* Notched beams of Asadollahi 2014, chapter 4: size, extra loaded particle on top, particles, bonds
 * (mm). */
typedef struct beam {
  double spacing, length, height, notch_height;
  long particles, bonds;
} beam;

static const beam beams[] = {
    {3.175, 228.6, 76.2, 25.4, 2026, 5864},   {6.35, 228.6, 76.2, 25.4, 509, 1419},
    {3.175, 457.2, 152.4, 50.8, 8083, 23820}, {6.35, 457.2, 152.4, 50.8, 2026, 5864},
    {6.35, 685.8, 228.6, 76.2, 4551, 13333},  {12.7, 685.8, 231.0, 76.2, 1196, 3425},
};

/* An extra particle stands on the first row that has a site at midspan and lies above or in the top
 * row. */
static void build_beam(filled_lattice *b, const beam *m, bool cut, bool extra) {
  const double mm = 1e-3, h = m->spacing * mm * sqrt(3) / 2;
  begin(b, m->spacing * mm);
  add_body(b, rectangle(0, 0, m->length * mm, m->height * mm));
  const long top = (long)floor(m->height * mm / h + 1e-6);
  /* even rows have sites at multiples of s, odd rows half-way */
  const bool even_midspan = lround(m->length / m->spacing) % 2 == 0;
  const bool top_fits = (top % 2 == 0) == even_midspan;
  if (extra) add_body(b, point(m->length * mm / 2, (double)(top_fits ? top : top + 1) * h));
  add_notch(b, rectangle((m->length / 2 - 1.27) * mm, 0, 2.54 * mm, m->notch_height * mm), cut);
}

static void published_particle_counts(void **unused) {
  (void)unused;
  for (size_t k = 0; k < sizeof beams / sizeof beams[0]; k++) {
    filled_lattice b;
    long bonds[2];
    for (int cut = 0; cut < 2; cut++) {
      build_beam(&b, &beams[k], cut, true);
      rows *w = fill_rows(&b);
      check_storage(w);
      bonds[cut] = w->bond_count;
      print_message(
          "beam %g mm, s %g mm, cut %d: %ld particles, %ld bonds, %g x %g mm, pitch %ld\n",
          beams[k].length, beams[k].spacing, cut, w->particle_count, w->bond_count, 1e3 * w->width,
          1e3 * w->height, w->pitch);
      assert_int_equal(w->particle_count, beams[k].particles);
      fill_end(&b, w);
    }
    assert_int_equal(bonds[0], beams[k].bonds);
    assert_true(bonds[1] < bonds[0]);
  }
}

/* No path of bonds leads from one flank of the notch to the other below its tip, when the rest is
 * cut away. */
static void notch_separates(void **unused) {
  (void)unused;
  filled_lattice b;
  build_beam(&b, &beams[3], true, false);
  add_notch(&b, rectangle(-1, 0.0508, 2, 1), true); /* everything above the notch */
  rows *w = fill_rows(&b);
  rows_bond *bonds = rows_bonds(w);
  long across = 0, lowest = 0;
  for (long m = 0; m < w->bond_count; m++) {
    const double xi = w->x[w->particle_site[bonds[m].i]], xj = w->x[w->particle_site[bonds[m].j]];
    if ((xi - 0.2286) * (xj - 0.2286) < 0) across++;
  }
  for (long p = 0; p < w->particle_count; p++)
    lowest += fabs(w->x[w->particle_site[p]] - 0.2286) < 1e-3;
  assert_int_equal(across, 0);
  assert_int_equal(lowest, 0);
  free(bonds);
  fill_end(&b, w);
}

static void disc_area_converges(void **unused) {
  (void)unused;
  const double radius = 0.1;
  double before = INFINITY;
  for (int level = 0; level < 5; level++) {
    double error = 0; /* mean over places of the lattice: a single one is erratic */
    for (int try = 0; try < 8; try++) {
      filled_lattice b;
      begin(&b, 0.02 / (1 << level));
      b.lattice.rotation = 5 * try * degree;
      b.lattice.origin[0] = 0.37e-2 * try;
      b.lattice.origin[1] = 0.21e-2 * try * try;
      add_body(&b, disc(0.3, -0.2, radius, 0));
      rows *w = fill_rows(&b);
      const double area = (double)w->particle_count * w->volume / b.lattice.mass_thickness;
      error += fabs(area / (acos(-1) * radius * radius) - 1) / 8;
      fill_end(&b, w);
    }
    print_message("disc: s/R %.4f, area error %.2e\n", 0.2 / (1 << level), error);
    assert_true(error < before);
    before = error;
  }
  assert_true(before < 1e-3);
}

static void thicknesses_stay_apart(void **unused) {
  (void)unused;
  filled_lattice b;
  begin(&b, 0.01);
  add_body(&b, rectangle(0, 0, 0.1, 0.1));
  rows *w = fill_rows(&b);
  w->mass = 3;
  const pl_bond_class c = rows_bond_class(w, 2);
  assert_true(fabs(w->volume - sqrt(3) / 2 * 1e-4 * 0.12) < 1e-18);
  assert_true(c.t == 0.127 && c.V == w->volume && c.mass_i == 3 && c.mass_j == 3);
  assert_true(c.s == 0.01 && c.n == 6 && c.shell == 1);
  assert_true(fabs(hypot(c.chord[0], c.chord[1]) - c.s) < 1e-17);
  fill_end(&b, w);
}

static void regions_are_selected(void **unused) {
  (void)unused;
  filled_lattice b;
  begin(&b, 6e-3);
  b.lattice.rotation = 17 * degree;
  add_body(&b, rectangle(0, 0, 0.2, 0.1));
  rows *w = fill_rows(&b);
  int32_t *list;
  const deck_shape shape = disc(0.05, 0.05, 0.02, 0.01);
  long count = rows_select(w, &shape, &list), next = 0;
  for (long p = 0; p < w->particle_count; p++) {
    const double r = hypot(w->x[w->particle_site[p]] - 0.05, w->y[w->particle_site[p]] - 0.05);
    if (r <= 0.02 && r >= 0.01) assert_int_equal(list[next++], p);
  }
  assert_int_equal(next, count);
  assert_true(count > 10);
  free(list);
  const long site = w->particle_site[77];
  deck_shape one = point(w->x[site] + 1e-3, w->y[site] - 2e-3);
  assert_int_equal(rows_select(w, &one, &list), 1);
  assert_int_equal(list[0], 77);
  free(list);
  const long next_site = w->particle_site[78];
  deck_shape half_way =
      point((w->x[site] + w->x[next_site]) / 2, (w->y[site] + w->y[next_site]) / 2);
  assert_int_equal(rows_select(w, &half_way, &list), 1);
  assert_int_equal(list[0], 77); /* the first of two that are as near */
  free(list);
  one.within = 1e-3;
  assert_int_equal(rows_select(w, &one, &list), 0);
  free(list);
  fill_end(&b, w);
}

static void protection_reaches_as_far_as_asked(void **unused) {
  (void)unused;
  static const double radii[] = {0, 0.5, 1, 1.01, 1.74, 5.3, 1e9}; /* spacings */
  for (size_t r = 0; r < sizeof radii / sizeof radii[0]; r++) {
    filled_lattice b;
    begin(&b, 6e-3);
    b.lattice.rotation = 23.7 * degree;
    add_body(&b, rectangle(0, 0, 0.15, 0.08));
    add_notch(&b, rectangle(0.07, 0, 0.001, 0.04), true);
    rows *w = fill_rows(&b);
    const int32_t feet[] = {0, 13, (int32_t)w->particle_count / 2, (int32_t)w->particle_count - 1};
    rows_protect(w, feet, 4, radii[r] * w->spacing);
    rows_bond *bonds = rows_bonds(w);
    for (long m = 0; m < w->bond_count; m++) {
      const int32_t ends[2] = {bonds[m].i, bonds[m].j};
      bool near = false;
      for (int n = 0; n < 8; n++) {
        const long p = w->particle_site[ends[n % 2]], q = w->particle_site[feet[n / 2]];
        near =
            near || hypot(w->x[p] - w->x[q], w->y[p] - w->y[q]) <= (radii[r] + 1e-6) * w->spacing;
      }
      const long site = bonds[m].slot % w->size, k = bonds[m].slot / w->size;
      assert_int_equal(w->held_bonds[site] >> k & 1, near);
    }
    free(bonds);
    check_storage(w);
    fill_end(&b, w);
  }
}

/* --- messages -----------------------------------------------------------------------------------
 */

static void expect(filled_lattice *b, diag_code code, const char *part) {
  rows *w = lattice_build(&b->deck, 0, &b->d);
  assert_true(b->d.count >= 1);
  assert_int_equal(b->d.items[0].code, code);
  assert_non_null(strstr(b->d.items[0].message, part));
  if (diag_severity(code) == SEVERITY_ERROR)
    assert_null(w);
  else
    assert_non_null(w);
  fill_end(b, w);
}

static void bad_geometry_is_reported(void **unused) {
  (void)unused;
  filled_lattice b;
  begin(&b, 6e-3);
  expect(&b, DIAG_EMPTY_REGION, "has no body");
  begin(&b, 6e-3);
  add_body(&b, rectangle(0.001, 0.001, 0.001, 0.001));
  expect(&b, DIAG_EMPTY_REGION, "contains no site");
  begin(&b, 6e-3);
  add_body(&b, rectangle(0, 0, 0.1, 0.1));
  add_body(
      &b,
      point(3e-3, sqrt(3) * 1e-3)); /* the middle of a triangle: 0.577 spacings from its corners */
  expect(&b, DIAG_EMPTY_REGION, "within 3 mm");
  begin(&b, 6e-3);
  add_body(&b, rectangle(0, 0, 0.1, 0.1));
  add_body(&b, disc(0.05, 0.05, 0.01, 0));
  expect(&b, DIAG_DECK_WARNING, "adds nothing");
  begin(&b, 6e-3);
  add_body(&b, rectangle(0, 0, 0.1, 0.1));
  add_notch(&b, rectangle(0.2, 0, 0.1, 0.1), true);
  expect(&b, DIAG_DECK_WARNING, "cuts no bond");
  begin(&b, 6e-3);
  add_body(&b, rectangle(0, 0, 0.1, 0.1));
  add_notch(&b, rectangle(-1, -1, 3, 3), true);
  expect(&b, DIAG_EMPTY_REGION, "every site");
}

/* Refused before anything is allocated. */
static void absurd_sizes_are_refused(void **unused) {
  (void)unused;
  filled_lattice b;
  begin(&b, 1e-6);
  add_body(&b, rectangle(0, 0, 10, 10));
  expect(&b, DIAG_OUT_OF_BOUNDS, "sites");
  begin(&b, 1e-3);
  add_body(&b, rectangle(0, 0, 0.1, 0.1));
  add_body(&b, rectangle(50e3, 50e3, 0.1, 0.1));
  expect(&b, DIAG_OUT_OF_BOUNDS, "sites");
  begin(&b, 1e-12);
  add_body(&b, rectangle(0, 0, 1, 1));
  expect(&b, DIAG_OUT_OF_BOUNDS, "farther");
  begin(&b, 1e-3);
  add_body(&b, rectangle(0, 0, INFINITY, 1));
  expect(&b, DIAG_OUT_OF_BOUNDS, "farther");
  begin(&b, 1e-3);
  add_body(&b, rectangle(0, 0, NAN, 1));
  expect(&b, DIAG_OUT_OF_BOUNDS, "farther");
  begin(&b, 0);
  add_body(&b, rectangle(0, 0, 1, 1));
  expect(&b, DIAG_BAD_VALUE, "positive");
}

/* The extra particle that is there already is no reason for a message. */
static void conditional_extra_point(void **unused) {
  (void)unused;
  filled_lattice b;
  begin(&b, 6e-3);
  add_body(&b, rectangle(0, 0, 0.06, 0.06));
  rows *w = lattice_build(&b.deck, 0, &b.d);
  const long count = w->particle_count;
  rows_free(w);
  add_body(&b, point(0.0301, -0.0001)); /* nearest to (0.03, 0): present */
  w = lattice_build(&b.deck, 0, &b.d);
  assert_int_equal(w->particle_count, count);
  assert_int_equal(b.d.count, 0);
  rows_free(w);
  add_body(&b, point(0.0661, 0.0001)); /* one site beyond the right end */
  w = lattice_build(&b.deck, 0, &b.d);
  assert_int_equal(w->particle_count, count + 1);
  assert_int_equal(b.d.count, 0);
  check_storage(w);
  fill_end(&b, w);
}

/* The first body that holds a site is its body; bodies of other lattices are counted, too. */
static void particles_know_their_bodies(void **unused) {
  (void)unused;
  filled_lattice b;
  begin(&b, 6e-3);
  add_body(&b, rectangle(0, 0, 0.06, 0.02));
  add_body(&b, rectangle(0, 0, 1, 1));
  add_body(&b, rectangle(0, 0, 0.06, 0.06));
  add_body(&b, point(0.066, 0));
  b.bodies[1].lattice = "steel";
  rows *w = fill_rows(&b);
  int32_t *of = must_calloc((size_t)w->particle_count, sizeof *of);
  long counts[4] = {0};
  rows_bodies(w, &b.deck, 0, of);
  for (long p = 0; p < w->particle_count; p++) {
    const long site = w->particle_site[p];
    const int32_t expected = w->x[site] > 0.063 ? 3 : w->y[site] < 0.0200001 ? 0 : 2;
    assert_int_equal(of[p], expected);
    counts[of[p]]++;
  }
  assert_true(counts[0] > 10 && counts[1] == 0 && counts[2] > 10 && counts[3] == 1);
  free(of);
  fill_end(&b, w);
}

static void other_lattices_bodies_stay_out(void **unused) {
  (void)unused;
  filled_lattice b;
  begin(&b, 6e-3);
  add_body(&b, rectangle(0, 0, 0.06, 0.06));
  add_body(&b, rectangle(0.06, 0, 0.06, 0.06));
  b.bodies[1].lattice = "steel"; /* not this lattice's */
  rows *w = fill_rows(&b);
  assert_true(w->width < 0.0601);
  fill_end(&b, w);
}

/* Offsets lead from absent sites, too, and must not lead to a particle along one of its bonds:
   whatever the width. */
static void absent_sites_have_no_neighbours(void **state) {
  (void)state;
  static const char *const kinds[] = {"hexagonal", "square", "fcc", "cubic"};
  for (int kind = 0; kind < 4; kind++)
    for (int columns = 1; columns <= 26; columns++)
      for (int horizon = 1; horizon <= (kind == 2 ? 2 : 3); horizon++) { /* fcc: 3 are too many */
        filled_lattice b;
        begin(&b, 0.01);
        b.lattice.kind = (char *)(uintptr_t)kinds[kind];
        b.lattice.horizon = horizon;
        const double width = 0.01 * columns - 0.004;
        if (kind < 2)
          add_body(&b, rectangle(0, 0, width, 0.06));
        else
          add_body(&b, (deck_shape){.kind = SHAPE_BOX, .size = {width, 0.03, 0.03}});
        rows *w = fill_rows(&b);
        for (long site = rows_start(w, 0); site < rows_start(w, w->row_count); site++)
          for (int k = 0; k < 2 * w->directions; k++)
            if (!w->present[site] && rows_has_neighbour(w, site, k))
              fail_msg("%s, %d columns, horizon %d: an absent site has neighbour %d", kinds[kind],
                       columns, horizon, k);
        fill_end(&b, w);
      }
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(neighbours_are_all_near_pairs),
      cmocka_unit_test(renumbering_changes_nothing),
      cmocka_unit_test(absent_sites_have_no_neighbours),
      cmocka_unit_test(published_particle_counts),
      cmocka_unit_test(notch_separates),
      cmocka_unit_test(disc_area_converges),
      cmocka_unit_test(thicknesses_stay_apart),
      cmocka_unit_test(regions_are_selected),
      cmocka_unit_test(protection_reaches_as_far_as_asked),
      cmocka_unit_test(bad_geometry_is_reported),
      cmocka_unit_test(absurd_sizes_are_refused),
      cmocka_unit_test(conditional_extra_point),
      cmocka_unit_test(particles_know_their_bodies),
      cmocka_unit_test(other_lattices_bodies_stay_out),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
