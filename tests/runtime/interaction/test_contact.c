/* Contact against all pairs asked one by one: while particles wander about, come near and leave,
   and bonds are lost, the forces are the same to the last bit. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "dsl/base/arena.h"
#include "runtime/base/random_number.h"
#include "runtime/interaction/contact.h"
#include "tests/runtime/small_bodies.h"

enum { BODIES = 2, ROUNDS = 80 };
static const double k_of[BODIES] = {3e8, 2e8};

#define OF_BODY(name, kind, corner)                                                                \
  "&lattice name = '" name "' kind = " kind " thickness = 0.1 /\n"                                 \
  "&material lattice = '" name "' model = 'm' /\n"                                                 \
  "&body lattice = '" name "' shape = 'rectangle' corner = " corner " size = 0.1, 0.08 /\n"
static const char two_bodies[] = "&simulation end_time = 1e-5 step = 1e-7 /\n" OF_BODY(
    "a", "'hexagonal' spacing = 0.01", "0, 0")
    OF_BODY("b", "'hexagonal' spacing = 0.012 rotation = 20", "0.104, 0") "&output frames = 0 /\n";

typedef struct wanderers {
  small_bodies all;
  sweep *of[BODIES];
  double *lost[BODIES]; /* [slots] as the contact is to know them */
  rows_bond *bonds[BODIES];
  double *expected[BODIES][2], stored;
} wanderers;

static void open_wanderers(wanderers *w) {
  small_bodies_open(&w->all, &elastic_bar, two_bodies);
  for (int b = 0; b < BODIES; b++) {
    w->of[b] = simulation_state(w->all.run.simulation, b);
    const rows *g = w->of[b]->lattice;
    w->lost[b] = must_calloc((size_t)(g->directions * g->size), sizeof(double));
    w->bonds[b] = rows_bonds(g);
    for (int d = 0; d < 2; d++)
      w->expected[b][d] = must_calloc((size_t)g->size, sizeof(double));
    body_add_outer(w->of[b]->body);
  }
}

static void close_wanderers(wanderers *w) {
  for (int b = 0; b < BODIES; b++) {
    free(w->lost[b]);
    free(w->bonds[b]);
    for (int d = 0; d < 2; d++)
      free(w->expected[b][d]);
  }
  small_bodies_close(&w->all);
}

static contact *contact_of(const wanderers *w, bool selves) {
  contact_body of[BODIES];
  for (int b = 0; b < BODIES; b++) {
    of[b] = (contact_body){.of = w->of[b]->body, .stiffness = k_of[b], .law_count = selves};
    of[b].laws = must_calloc(1, sizeof(contact_law));
    *of[b].laws = (contact_law){w->of[b], w->of[b]->lattice, w->bonds[b]};
  }
  return contact_new(of, BODIES, selves);
}

static void place_of(const sweep *s, long q, bool at_rest, double at[2]) {
  const rows *g = s->lattice;
  at[0] = g->x[q] + (at_rest ? 0 : s->body->displacement[0][q]);
  at[1] = g->y[q] + (at_rest ? 0 : s->body->displacement[1][q]);
}

static double distance(const sweep *a, long p, const sweep *b, long q, bool at_rest,
                       double chord[2]) {
  double from[2], to[2];
  place_of(a, p, at_rest, from);
  place_of(b, q, at_rest, to);
  chord[0] = to[0] - from[0];
  chord[1] = to[1] - from[1];
  return sqrt(chord[0] * chord[0] + chord[1] * chord[1]);
}

static int64_t slot_of(const rows_bond *bonds, const rows *g, int32_t i, int32_t j) {
  for (long m = 0; m < g->bond_count; m++)
    if ((bonds[m].i == i && bonds[m].j == j) || (bonds[m].i == j && bonds[m].j == i))
      return bonds[m].slot;
  return -1;
}

static void expect_pair(wanderers *w, int a, int32_t i, int b, int32_t j, bool selves) {
  const long p = w->of[a]->lattice->particle_site[i], q = w->of[b]->lattice->particle_site[j];
  double chord[2];
  double d = 0.5 * (w->of[a]->lattice->spacing + w->of[b]->lattice->spacing);
  const double r = distance(w->of[a], p, w->of[b], q, false, chord);
  if (!(r < d) || (a == b && !selves)) return;
  double at_rest[2];
  d = fmin(d, distance(w->of[a], p, w->of[b], q, true, at_rest));
  const int64_t slot = a == b ? slot_of(w->bonds[a], w->of[a]->lattice, i, j) : -1;
  if (slot >= 0 && w->lost[a][slot] == 0) return;
  if (slot >= 0) d = fmin(d, w->lost[a][slot]);
  if (!(r < d)) return;
  const double k = fmin(k_of[a], k_of[b]);
  w->stored += 0.5 * k * (d - r) * (d - r);
  for (int c = 0; c < 2; c++) {
    const double force = k * (d - r) * chord[c] / r;
    w->expected[a][c][p] -= force;
    w->expected[b][c][q] += force;
  }
}

/* In the order of the particles, those of the first body before the other's. */
static void ask_all_pairs(wanderers *w, bool selves) {
  w->stored = 0;
  for (int b = 0; b < BODIES; b++)
    for (int c = 0; c < 2; c++)
      memset(w->expected[b][c], 0, (size_t)w->of[b]->lattice->size * sizeof(double));
  for (int a = 0; a < BODIES; a++)
    for (int32_t i = 0; i < w->of[a]->lattice->particle_count; i++)
      for (int b = a; b < BODIES; b++)
        for (int32_t j = b == a ? i + 1 : 0; j < w->of[b]->lattice->particle_count; j++)
          expect_pair(w, a, i, b, j, selves);
}

static double drawn(uint64_t what, uint64_t round, uint64_t which) {
  return random_unit(random_mix(random_mix(which) + 1000 * round + what));
}

/* By up to a twentieth of a spacing each, and the bodies into each other. */
static void wander(wanderers *w, uint64_t round) {
  for (int b = 0; b < BODIES; b++)
    for (long n = 0; n < w->of[b]->lattice->particle_count; n++)
      for (int c = 0; c < 2; c++) {
        const double u = drawn((uint64_t)(c + 2 * b), round, (uint64_t)n);
        w->of[b]->body->displacement[c][w->of[b]->lattice->particle_site[n]] +=
            1e-3 * (u - 0.5) + (b == 1 && c == 0 ? -3e-4 : 0);
      }
}

static void lose_some(wanderers *w, uint64_t round) {
  double chord[2];
  for (int b = 0; b < BODIES; b++) {
    const rows *g = w->of[b]->lattice;
    for (long m = 0; m < g->bond_count; m++) {
      const rows_bond *bond = &w->bonds[b][m];
      if (w->lost[b][bond->slot] > 0 || drawn(77, round, (uint64_t)(10000 * b + m)) > 0.01)
        continue;
      w->of[b]->field[0][bond->slot] = 1;
      w->lost[b][bond->slot] = distance(w->of[b], g->particle_site[bond->i], w->of[b],
                                        g->particle_site[bond->j], false, chord);
    }
  }
}

static void as_all_pairs_say(bool selves) {
  wanderers w;
  open_wanderers(&w);
  contact *c = contact_of(&w, selves);
  double most = 0;
  for (uint64_t round = 0; round < ROUNDS; round++) {
    wander(&w, round);
    lose_some(&w, round);
    for (int b = 0; b < BODIES; b++)
      body_clear_outer(w.of[b]->body);
    contact_find(c);
    ask_all_pairs(&w, selves);
    for (int b = 0; b < BODIES; b++)
      for (int d = 0; d < 2; d++)
        for (long n = 0; n < w.of[b]->lattice->particle_count; n++) {
          const long q = w.of[b]->lattice->particle_site[n];
          assert_true(w.of[b]->body->outer[d][q] == w.expected[b][d][q]);
        }
    assert_true(contact_stored(c) == w.stored);
    most = fmax(most, w.stored);
  }
  assert_true(most > 0);
  contact_free(c);
  close_wanderers(&w);
}

static void forces_between_bodies_are_those_of_all_pairs(void **state) {
  (void)state;
  as_all_pairs_say(false);
}

static void so_are_forces_within_them_while_bonds_are_lost(void **state) {
  (void)state;
  as_all_pairs_say(true);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(forces_between_bodies_are_those_of_all_pairs),
      cmocka_unit_test(so_are_forces_within_them_while_bonds_are_lost),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
