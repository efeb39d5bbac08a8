/* Particles and bonds of links: which are joined, against all pairs one by one, on sites and off
   them, in the plane and in space; masses and inertias; notches; what is short, far or too much. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include <math.h>
#include <stdlib.h>

#include "runtime/filling/linked.h"
#include "tests/runtime/built_rows.h"

enum { CONCRETE, BAR, LINK, LATTICES };
static const double light = 2300, heavy = 7850; /* kg/m^3 */

typedef struct linked_rows {
  built_rows text;
  rows *built[LATTICES]; /* the last is NULL where nothing is joined */
} linked_rows;

#define PLANE                                                                                      \
  "&simulation end_time = 1 /\n"                                                                   \
  "&lattice name = 'c' kind = 'hexagonal' spacing = 0.02 thickness = 0.12 /\n"                     \
  "&body lattice = 'c' shape = 'rectangle' corner = 0, 0 size = 0.4, 0.2 /\n"                      \
  "&material lattice = 'c' model = 'm' /\n&material bar = 'b' model = 'm' /\n"                     \
  "&material link = 'l' model = 'm' /\n"
#define SPACE                                                                                      \
  "&simulation end_time = 1 /\n"                                                                   \
  "&lattice name = 'c' kind = 'fcc' spacing = 0.02 /\n"                                            \
  "&body lattice = 'c' shape = 'box' corner = 0, 0, 0 size = 0.3, 0.1, 0.1 /\n"                    \
  "&material lattice = 'c' model = 'm' /\n&material bar = 'b' model = 'm' /\n"                     \
  "&material link = 'l' model = 'm' /\n"

static void build_linked(linked_rows *b, const char *head, const char *bar, const char *link) {
  char text[4096];
  memset(b, 0, sizeof *b);
  snprintf(text, sizeof text,
           "%s&bar name = 'b' spacing = 0.02 area = 1e-4 %s /\n"
           "&link name = 'l' bar = 'b' lattice = 'c' %s /\n",
           head, bar, link);
  read_deck(&b->text, text);
  if (!b->text.deck) diag_print(&b->text.said, stderr);
  assert_non_null(b->text.deck);
  for (int n = CONCRETE; n < LATTICES; n++) {
    b->built[n] = lattice_build_next(b->text.deck, n, b->built, &b->text.said);
    if (n < LINK) rows_set_density(b->built[n], n == BAR ? heavy : light);
  }
  if (b->built[LINK]) linked_take_masses(b->built[LINK], b->built);
}

static void end_linked(linked_rows *b) {
  for (int n = CONCRETE; n < LATTICES; n++)
    if (b->built[n]) rows_free(b->built[n]);
  b->text.rows = NULL;
  diag_clear(&b->text.said);
  source_clear(&b->text.sources);
  arena_free(b->text.memory);
}

/* The bond of the link between these two, from either end: its length, or 0. */
static double joined(const rows *w, int32_t of_bar, int32_t of_body) {
  rows_bond *bonds = rows_bonds(w);
  double length = 0;
  for (long k = 0; k < w->bond_count; k++) {
    const rows_copy *i = &w->copies[bonds[k].i], *j = &w->copies[bonds[k].j],
                    *bar = i->lattice == BAR ? i : j, *body = i->lattice == BAR ? j : i;
    assert_true(bar->lattice == BAR && body->lattice == CONCRETE);
    if (bar->particle[0] == of_bar && body->particle[0] == of_body)
      length += w->list->length[bonds[k].slot];
  }
  free(bonds);
  return length;
}

static double apart(const rows *v, long p, const rows *w, long q) {
  double from[3] = {0}, to[3] = {0};
  rows_place(v, v->particle_site[p], from);
  rows_place(w, w->particle_site[q], to);
  return sqrt((to[0] - from[0]) * (to[0] - from[0]) + (to[1] - from[1]) * (to[1] - from[1]) +
              (v->dimensions == 3 ? (to[2] - from[2]) * (to[2] - from[2]) : 0));
}

/* All pairs, one by one; `expected`: so many, 0: some. */
static void check_pairs(const linked_rows *b, int first, int every, double within, long expected) {
  const rows *bar = b->built[BAR], *body = b->built[CONCRETE], *w = b->built[LINK];
  long count = 0;
  assert_non_null(w);
  for (int32_t p = 0; p < bar->particle_count; p++)
    for (int32_t q = 0; q < body->particle_count; q++) {
      const double far = apart(bar, p, body, q);
      const bool meant = p >= first && (p - first) % every == 0 && far > 1e-9 &&
                         far <= within * body->spacing * (1 + 1e-6);
      const double length = joined(w, p, q);
      assert_true(meant ? fabs(length - far) < 1e-12 : length == 0);
      count += meant;
    }
  print_message("%ld bonds, %ld particles\n", w->bond_count, w->particle_count);
  assert_int_equal(w->bond_count, count);
  assert_true(expected ? count == expected : count > 20);
}

/* On sites: six neighbours of the lattice each, at a spacing, and not the one at its own place; off
   them three, two of the row above and the one below. */
static void each_is_joined_to_all_in_reach(void **state) {
  (void)state;
  linked_rows b;
  build_linked(&b, PLANE, "points = 0.03, 0.0173205080756888, 0.37, 0.0173205080756888",
               "every = 2");
  check_pairs(&b, 0, 2, 1, 9 * 6);
  end_linked(&b);
  build_linked(&b, PLANE, "points = 0.03, 0.02, 0.37, 0.02", "every = 2 first = 1");
  check_pairs(&b, 1, 2, 1, 9 * 3);
  end_linked(&b);
  build_linked(&b, PLANE, "points = 0.031, 0.02, 0.2, 0.03, 0.2, 0.15", "every = 3 within = 1.7");
  check_pairs(&b, 0, 3, 1.7, 0);
  end_linked(&b);
  build_linked(&b, SPACE, "points = 0.03, 0.051, 0.052, 0.27, 0.049, 0.053", "within = 1.1");
  check_pairs(&b, 0, 1, 1.1, 0);
  end_linked(&b);
}

/* Of the particles that they are copies of. */
static void masses_are_those_of_the_particles(void **state) {
  (void)state;
  linked_rows b;
  build_linked(&b, PLANE, "points = 0.031, 0.02, 0.2, 0.03, 0.2, 0.15", "");
  const rows *w = b.built[LINK];
  for (long p = 0; p < w->particle_count; p++) {
    const rows_copy *c = &w->copies[p];
    const rows *g = b.built[c->lattice];
    const long site = g->particle_site[c->particle[0]], here = w->particle_site[p];
    const double mass = g->site_mass ? g->site_mass[site] : g->mass,
                 inertia = mass * g->inertia / g->mass * rows_radius_square(g, site);
    assert_true(apart(w, p, g, c->particle[0]) < 1e-15);
    assert_true(w->site_mass[here] == mass);
    assert_true(fabs(mass * w->inertia / w->mass * rows_radius_square(w, here) / inertia - 1) <
                1e-12);
  }
  end_linked(&b);
}

/* The only message with these words; NULL: none. */
static const diagnostic *said(const linked_rows *b, const char *words) {
  const diagnostic *found = NULL;
  for (int k = 0; k < b->text.said.count; k++) {
    const diagnostic *d = &b->text.said.items[k];
    if (!strstr(d->message, words)) continue;
    assert_null(found);
    found = d;
  }
  return found;
}

/* A slit cuts two of the four bonds of the bar's particle before it; the bar itself stays whole. */
static void no_bond_crosses_a_notch(void **state) {
  (void)state;
  linked_rows b;
#define SLIT                                                                                       \
  PLANE "&notch lattice = 'c' shape = 'segment' from = 0.1997, -1 to = 0.1997, 0.05 cut_bonds = "  \
        ".true. /\n"
  build_linked(&b, SLIT, "points = 0.031, 0.02, 0.371, 0.02", "");
  const rows *w = b.built[LINK];
  rows_bond *bonds = rows_bonds(w);
  for (long k = 0; k < w->bond_count; k++) {
    const double x = w->x[w->particle_site[bonds[k].i]], y = w->x[w->particle_site[bonds[k].j]];
    assert_true((x < 0.1997) == (y < 0.1997));
  }
  free(bonds);
  assert_int_equal(b.built[BAR]->bond_count, 17);
  assert_non_null(said(&b, "notches of `c` cut 2 bonds of the link `l`"));
  end_linked(&b);
  build_linked(&b, PLANE, "points = 0.031, 0.02, 0.371, 0.02", "");
  assert_int_equal(b.built[LINK]->bond_count, 18 * 4);
  assert_int_equal(b.text.said.count, 0);
  end_linked(&b);
}

static void must_say(const char *head, const char *bar, const char *link, const char *words,
                     bool refused) {
  linked_rows b;
  build_linked(&b, head, bar, link);
  const diagnostic *d = said(&b, words);
  if (!d) diag_print(&b.text.said, stderr);
  assert_non_null(d);
  assert_non_null(d->hint);
  assert_int_equal(b.text.said.errors, refused);
  assert_int_equal(b.built[LINK] == NULL, refused);
  end_linked(&b);
}

static void what_does_not_suit_is_said(void **state) {
  (void)state;
  must_say(PLANE, "points = 0.03, -0.05, 0.37, -0.05", "", "joins nothing: no particle of `c`",
           true);
  must_say(PLANE, "points = 0.03, 0.02, 0.37, 0.02", "first = 18",
           "the bar `b` has 18 particles: there is none with the number 18", true);
  must_say(PLANE, "points = 0.2, 0.1, 0.22, 0.1", "within = 9",
           "bonds of the link `l`, more than the 128 there can be", true);
  must_say(PLANE, "points = 0.1, 0.0017, 0.2, 0.0017", "",
           "the shortest bond of the link `l` is 1.7 mm", false);
  must_say(PLANE "&notch lattice = 'c' shape = 'rectangle' corner = 0.1, 0.05 size = 0.2, 0.1 /\n",
           "points = 0.12, 0.1, 0.2, 0.1", "within = 4", "each of its bonds would cross a notch",
           true);
  must_say(PLANE, "points = 0.05, 0.05, 0.55, 0.05", "every = 5",
           "2 of the 6 particles of the bar `b` that the link `l` chooses are not joined to `c`",
           false);
  must_say(PLANE, "points = 0.05, 0.05, 0.05, 0.15 copies = 5 shift = 0.1, 0", "",
           "6 of the 30 particles of the bar `b` that the link `l` chooses are not joined to `c`",
           false);
  must_say(SPACE, "points = 0.03, 0.05, 0.05, 0.27, 0.05, 0.05", "first = 14 every = 3",
           "the bar `b` has 13 particles: there is none with the number 14", true);
  must_say(PLANE, "points = 0.05, 0.05, 0.05, 0.15 copies = 3 shift = 0.1, 0", "first = 6",
           "each copy of the bar `b` has 6 particles: there is none with the number 6", true);
}

/* 11.3 mm in one row of particles every 10 mm, or in two. */
#define THIN(height)                                                                               \
  "&simulation end_time = 1 /\n"                                                                   \
  "&lattice name = 'c' kind = 'hexagonal' spacing = 0.01 thickness = 0.12 /\n"                     \
  "&body lattice = 'c' shape = 'rectangle' corner = 0, 0 size = 0.4, " height " /\n"               \
  "&material lattice = 'c' model = 'm' /\n&material bar = 'b' model = 'm' /\n"                     \
  "&material link = 'l' model = 'm' /\n"

static void a_bar_is_thinner_than_its_body(void **state) {
  (void)state;
  linked_rows b;
  must_say(THIN("0.001"), "points = 0.05, 0.003, 0.35, 0.003", "",
           "the bar `b` is 11.28 mm thick, but `c`, in which it lies, only 10 mm", true);
  build_linked(&b, THIN("0.009"), "points = 0.05, 0.003, 0.35, 0.003", "");
  assert_non_null(b.built[LINK]);
  end_linked(&b);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(each_is_joined_to_all_in_reach),
      cmocka_unit_test(masses_are_those_of_the_particles),
      cmocka_unit_test(no_bond_crosses_a_notch),
      cmocka_unit_test(what_does_not_suit_is_said),
      cmocka_unit_test(a_bar_is_thinner_than_its_body),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
