/* Bars tied to places of a lattice: cells and weights in the plane, in space and on no lattice;
   the lengths that bonds stand for; what lies outside. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include <math.h>
#include <stdlib.h>

#include "runtime/filling/lattice.h"
#include "runtime/filling/linked.h"
#include "runtime/filling/tied.h"
#include "tests/runtime/built_rows.h"

enum { BODY, BAR, LINK, LATTICES };
static const double spacing = 0.02;

typedef struct tied_rows {
  built_rows text;
  rows *built[LATTICES];
} tied_rows;

#define PLANE(kind)                                                                                \
  "&simulation end_time = 1 /\n"                                                                   \
  "&lattice name = 'c' kind = '" kind "' spacing = 0.02 thickness = 0.12 /\n"                      \
  "&body lattice = 'c' shape = 'rectangle' corner = 0, 0 size = 0.4, 0.2 /\n"
#define SPACE                                                                                      \
  "&simulation end_time = 1 /\n&lattice name = 'c' kind = 'fcc' spacing = 0.02 /\n"                \
  "&body lattice = 'c' shape = 'box' corner = 0, 0, 0 size = 0.3, 0.1, 0.1 /\n"

static void build(tied_rows *b, const char *head, const char *bar, const char *link) {
  char text[4096];
  memset(b, 0, sizeof *b);
  snprintf(text, sizeof text,
           "%s&material lattice = 'c' model = 'm' /\n&material bar = 'b' model = 'm' /\n"
           "&material link = 'l' model = 'm' /\n"
           "&bar name = 'b' area = 1e-4 %s /\n"
           "&link name = 'l' bar = 'b' lattice = 'c' to = 'place' %s /\n",
           head, bar, link);
  read_deck(&b->text, text);
  if (!b->text.deck) diag_print(&b->text.said, stderr);
  assert_non_null(b->text.deck);
  for (int n = BODY; n < LINK; n++) {
    b->built[n] = lattice_build(b->text.deck, n, &b->text.said);
    rows_set_density(b->built[n], 2300);
  }
  b->built[LINK] = linked_build(b->text.deck, LINK, b->built, &b->text.said);
  if (b->built[LINK]) linked_take_masses(b->built[LINK], b->built);
}

static void end(tied_rows *b) {
  for (int n = BODY; n < LATTICES; n++)
    if (b->built[n]) rows_free(b->built[n]);
  b->text.rows = NULL;
  diag_clear(&b->text.said);
  source_clear(&b->text.sources);
  arena_free(b->text.memory);
}

/* The place of each bond is that of the bar's particle: weights are parts of 1, and a field that is
   linear in space has its value there. On a lattice the corners are neighbours. */
static void check_places(const tied_rows *b, double reach) {
  const rows *w = b->built[LINK], *g = b->built[BODY];
  rows_bond *bonds = rows_bonds(w);
  for (long k = 0; k < w->bond_count; k++) {
    const rows_copy *i = &w->copies[bonds[k].i], *j = &w->copies[bonds[k].j];
    const rows_copy *bar = i->lattice == BAR ? i : j, *spot = i->lattice == BAR ? j : i;
    double at[3], sum = 0, mean[3] = {0, 0, 0};
    assert_true(bar->lattice == BAR && spot->lattice == BODY && bar->count == 1);
    rows_place(b->built[BAR], b->built[BAR]->particle_site[bar->particle[0]], at);
    for (int n = 0; n < spot->count; n++) {
      double corner[3], far = 0;
      rows_place(g, g->particle_site[spot->particle[n]], corner);
      assert_true(spot->weight[n] > 0 && spot->weight[n] <= 1);
      sum += spot->weight[n];
      for (int a = 0; a < 3; a++) {
        mean[a] += spot->weight[n] * corner[a];
        far += (corner[a] - at[a]) * (corner[a] - at[a]);
      }
      assert_true(sqrt(far) < reach);
    }
    assert_true(fabs(sum - 1) < 1e-15);
    for (int a = 0; a < g->dimensions; a++)
      assert_true(fabs(mean[a] - at[a]) < 1e-15);
  }
  free(bonds);
}

static double sum_of_lengths(const rows *w) {
  rows_bond *bonds = rows_bonds(w);
  double sum = 0;
  for (long k = 0; k < w->bond_count; k++)
    sum += w->list->length[bonds[k].slot];
  free(bonds);
  return sum;
}

#define BENT "points = 0.031, 0.02, 0.2, 0.03, 0.21, 0.15 spacing = 0.007"

static void places_are_where_the_bar_is(void **state) {
  (void)state;
  static const char *const heads[] = {PLANE("hexagonal"), PLANE("square"), PLANE("blue_noise") "",
                                      SPACE};
  static const double reach[] = {1.0001, 1.4143, 2, 1.42};
  for (int n = 0; n < 4; n++) {
    tied_rows b;
    build(&b, heads[n],
          n == 3 ? "points = 0.031, 0.02, 0.03, 0.2, 0.03, 0.05, 0.25, 0.09, 0.07 spacing = 0.007"
                 : BENT,
          "");
    assert_non_null(b.built[LINK]);
    assert_int_equal(b.built[LINK]->bond_count, b.built[BAR]->particle_count);
    check_places(&b, reach[n] * spacing);
    end(&b);
  }
}

/* A site itself, and the middle of two. */
static void corners_that_carry_nothing_are_none(void **state) {
  (void)state;
  tied_rows b;
  build(&b, PLANE("hexagonal"), "points = 0.1, 0, 0.14, 0 spacing = 0.01", "");
  const rows *w = b.built[LINK];
  int one = 0, two = 0;
  for (long p = 0; p < w->particle_count; p++) {
    one += w->copies[p].lattice == BODY && w->copies[p].count == 1;
    two += w->copies[p].lattice == BODY && w->copies[p].count == 2;
  }
  assert_int_equal(one, 3);
  assert_int_equal(two, 2);
  end(&b);
}

/* All of the bar, whichever particles are chosen; in a ring each as much as any other. */
static void bonds_stand_for_all_of_the_bar(void **state) {
  (void)state;
  static const char *const line = "points = 0.05, 0.1, 0.25, 0.1 spacing = 0.01";
  static const char *const links[] = {"", "every = 2", "every = 2 first = 1",
                                      "every = 4 first = 2"};
  tied_rows b;
  for (int n = 0; n < 4; n++) {
    build(&b, PLANE("hexagonal"), line, links[n]);
    assert_true(fabs(sum_of_lengths(b.built[LINK]) - 0.2) < 1e-14);
    end(&b);
  }
  build(&b, PLANE("hexagonal"),
        "points = 0.05, 0.05, 0.15, 0.05, 0.15, 0.15, 0.05, 0.15 closed = .true. spacing = 0.01",
        "every = 2");
  assert_true(fabs(sum_of_lengths(b.built[LINK]) - 0.4) < 1e-14);
  end(&b);
  build(&b, PLANE("hexagonal"),
        "points = 0.05, 0.05, 0.05, 0.064, 0.084, 0.064, 0.084, 0.164 copies = 4 shift = 0.05, 0 "
        "spacing = 0.01",
        "every = 3 first = 1");
  assert_true(fabs(sum_of_lengths(b.built[LINK]) - 4 * 0.148) < 1e-14);
  end(&b);
}

static bool says(const tied_rows *b, const char *text) {
  char *page = NULL;
  size_t length;
  FILE *out = open_memstream(&page, &length);
  diag_print((diagnostics *)&b->text.said, out);
  fclose(out);
  const bool found = strstr(page, text) != NULL;
  if (!found) print_message("%s", page);
  free(page);
  return found;
}

static void what_lies_outside_is_told(void **state) {
  (void)state;
  tied_rows b;
  build(&b, PLANE("hexagonal"), "points = 0.3, 0.1, 0.5, 0.1 spacing = 0.01", "");
  assert_int_equal(b.built[LINK]->bond_count, 11);
  assert_true(
      says(&b, "10 of the 21 particles of the bar `b` that the link `l` chooses are not joined"));
  end(&b);
  build(&b, PLANE("hexagonal"), "points = 0.3, 0.5, 0.5, 0.5 spacing = 0.01", "");
  assert_null(b.built[LINK]);
  assert_true(says(&b, "the bar `b` lies outside of `c`"));
  end(&b);
  build(&b, PLANE("hexagonal"), "points = 0.1, 0.1, 0.3, 0.1 spacing = 0.01", "first = 21");
  assert_null(b.built[LINK]);
  assert_true(says(&b, "has 21 particles: there is none with the number 21"));
  end(&b);
}

/* A slit between two columns of sites, on both sides of which or on which itself the bar has
   particles: no corner is behind it, and what it leaves without a cell is not joined. */
#define SLIT(kind, x)                                                                              \
  PLANE(kind) "&notch lattice = 'c' shape = 'segment' from = " x ", -1 to = " x ", 0.1 /\n"

static void no_cell_reaches_through_a_notch(void **state) {
  (void)state;
  static const struct {
    const char *head, *bar;
    double x;
    int missed;
  } cases[] = {
      {SLIT("square", "0.21"), "points = 0.1, 0.03, 0.32, 0.03 spacing = 0.005", 0.21, 3},
      {SLIT("square", "0.21"), "points = 0.102, 0.03, 0.322, 0.03 spacing = 0.005", 0.21, 4},
      {SLIT("hexagonal", "0.2051"), "points = 0.1, 0.03, 0.32, 0.045 spacing = 0.0044", 0.2051, 0},
      {PLANE("hexagonal") "&notch lattice = 'c' shape = 'rectangle' corner = 0.15, 0 size = 0.07, "
                          "0.1 /\n",
       "points = 0.1, 0.05, 0.32, 0.05 spacing = 0.005", 0.18, 0}};
  for (int n = 0; n < 4; n++) {
    tied_rows b;
    build(&b, cases[n].head, cases[n].bar, "");
    const rows *w = b.built[LINK], *g = b.built[BODY];
    const long missed = b.built[BAR]->particle_count - w->bond_count;
    check_places(&b, 2 * spacing);
    for (long p = 0; p < w->particle_count; p++) {
      const rows_copy *c = &w->copies[p];
      const double x = b.built[BAR]->x[b.built[BAR]->particle_site[c->at]];
      for (int k = 0; k < c->count && c->lattice == BODY; k++)
        assert_true((g->x[g->particle_site[c->particle[k]]] < cases[n].x) == (x < cases[n].x));
    }
    print_message("%ld not joined\n", missed);
    assert_true(missed > 0 && (cases[n].missed == 0 || missed == cases[n].missed));
    assert_true(says(&b, "they lie outside of it, or notches are between"));
    end(&b);
  }
}

/* However many places a site carries, together they are no heavier than it. */
static void places_share_the_masses_of_their_sites(void **state) {
  (void)state;
  tied_rows b;
  build(&b, PLANE("hexagonal"), BENT, "");
  const rows *w = b.built[LINK], *g = b.built[BODY];
  double *part = calloc((size_t)g->particle_count, sizeof *part);
  for (long p = 0; p < w->particle_count; p++) {
    const rows_copy *c = &w->copies[p];
    if (c->lattice == BAR) {
      assert_true(w->site_mass[w->particle_site[p]] ==
                  b.built[BAR]->site_mass[b.built[BAR]->particle_site[c->particle[0]]]);
      continue;
    }
    for (int n = 0; n < c->count; n++)
      part[c->particle[n]] += c->weight[n];
  }
  for (long p = 0; p < w->particle_count; p++) {
    const rows_copy *c = &w->copies[p];
    double mobility = 0;
    for (int n = 0; n < c->count && c->lattice == BODY; n++)
      mobility += c->weight[n] * part[c->particle[n]] / g->mass;
    if (c->lattice == BODY)
      assert_true(fabs(w->site_mass[w->particle_site[p]] * mobility - 1) < 1e-14);
  }
  free(part);
  end(&b);
}

/* Particles of 1 to 4 mm: places among the coarse ones are in cells, too. */
static void coarse_particles_make_cells(void **state) {
  (void)state;
  built_rows b;
  build_rows(&b, "&simulation end_time = 1 /\n&material lattice = 'c' model = 'm' /\n"
                 "&lattice name = 'c' kind = 'blue_noise' spacing = '1 [mm] + 0.1*y' thickness = 1 "
                 "/\n&body lattice = 'c' shape = 'rectangle' corner = 0, 0 size = 0.03, 0.03 /\n");
  near_particles near = tied_near(b.rows);
  for (int n = 0; n < 400; n++) {
    const double at[3] = {4e-3 + 22e-3 * (n % 20) / 19, 4e-3 + 22e-3 * (n / 20) / 19, 0};
    double mean[2] = {0, 0};
    rows_copy cell;
    assert_true(tied_cell(&near, NULL, NULL, at, &cell));
    for (int k = 0; k < cell.count; k++) {
      const long q = b.rows->particle_site[cell.particle[k]];
      mean[0] += cell.weight[k] * b.rows->x[q];
      mean[1] += cell.weight[k] * b.rows->y[q];
    }
    assert_true(fabs(mean[0] - at[0]) + fabs(mean[1] - at[1]) < 1e-12);
  }
  near_particles_end(&near);
  built_end(&b);
}

int main(void) {
  const struct CMUnitTest tests[] = {cmocka_unit_test(places_are_where_the_bar_is),
                                     cmocka_unit_test(corners_that_carry_nothing_are_none),
                                     cmocka_unit_test(bonds_stand_for_all_of_the_bar),
                                     cmocka_unit_test(what_lies_outside_is_told),
                                     cmocka_unit_test(no_cell_reaches_through_a_notch),
                                     cmocka_unit_test(places_share_the_masses_of_their_sites),
                                     cmocka_unit_test(coarse_particles_make_cells)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
