/* Forces of single bonds, asked of laws that add them up at once: they sum to the forces of the
   state observed, act on both ends alike, and are not changed by which are asked for. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "runtime/interaction/bond_forces.h"
#include "runtime/interaction/interaction.h"
#include "tests/verification/case.h"

#define HEAD "&simulation end_time = 1e-4 /\n&output sample = 1e-5 /\n"
#define PLATE                                                                                      \
  "&body lattice = 'l' shape = 'disc' centre = 0, 0 radius = 0.09 /\n"                             \
  "&notch lattice = 'l' shape = 'segment' from = -0.1, 0.003 to = -0.02, 0.003 /\n"
#define BALL                                                                                       \
  "&body lattice = 'l' shape = 'sphere' centre = 3*0 radius = 0.055 /\n"                           \
  "&notch lattice = 'l' shape = 'face' points = -0.1, -0.1, 0.003, 0, -0.1, 0.003, 0, 0.1, 0.003," \
  " -0.1, 0.1, 0.003 /\n"
#define PLANE(kind)                                                                                \
  HEAD "&lattice name = 'l' spacing = 0.01 thickness = 0.02 kind = " kind " /\n" PLATE
#define SPACE(kind) HEAD "&lattice name = 'l' spacing = 0.01 kind = " kind " /\n" BALL
#define FIELD                                                                                      \
  "&field parameter = 'E' distribution = 'normal' cv = 0.1 "                                       \
  "seed = 3 on = 'particle' /\n"
#define OF(model) "&material lattice = 'l' model = '" model "' /\n"

static const char *const decks[] = {
    PLANE("'hexagonal' rotation = 7") OF("elastic_central"),
    PLANE("'hexagonal' rotation = 7") OF("elastic_micropolar"),
    PLANE("'hexagonal'") OF("mplm_bilinear"),
    PLANE("'hexagonal'") OF("splm_elastic"),
    PLANE("'hexagonal'") OF("splm_concrete"),
    PLANE("'hexagonal' shells = 3") OF("lps"),
    PLANE("'square' horizon = 3.015") OF("lps"),
    PLANE("'square' horizon = 3.015") OF("pmb"),
    PLANE("'square' horizon = 1.5") OF("pmb"),
    PLANE("'blue_noise' seed = 3") OF("pmb"),
    PLANE("'blue_noise' seed = 3") OF("splm_elastic"),
    SPACE("'cubic' shells = 2") OF("pmb"),
    SPACE("'fcc' shells = 2") OF("splm_elastic"),
    SPACE("'fcc'") OF("pmb"),
    SPACE("'fcc' shells = 2") OF("eps"),
    SPACE("'fcc'") OF("lps"),
    SPACE("'fcc' shells = 2") OF("mplm_space"),
    SPACE("'fcc'") OF("cohesive"),
    PLANE("'square' horizon = 1.5") OF("cohesive"),
    PLANE("'square' horizon = 3.015") OF("pmb") FIELD,
    PLANE("'hexagonal'") OF("mplm_bilinear") FIELD,
    SPACE("'fcc' shells = 2") OF("mplm_space") FIELD,
};

/* Strains of some 1e-4, not alike anywhere, and what a few steps make of them. */
static void shake(sweep *w) {
  const rows *g = w->body->lattice;
  for (long q = 0; q < g->size; q++)
    for (int d = 0; d < w->body->dof; d++) {
      const double phase = 190 * g->x[q] + 130 * g->y[q] + (g->z ? 160 * g->z[q] : 0) + d;
      if (g->present[q])
        w->body->displacement[d][q] = (d < g->dimensions ? 2e-6 : 1e-4) * sin(phase);
    }
  for (int k = 0; k < 5; k++)
    assert_true(sweep_step(w));
}

static uint64_t bits_of_fields(const sweep *w) {
  uint64_t bits = 0;
  for (int f = 0; f < w->law->field_count; f++)
    for (long k = 0; k < sweep_planes(w, w->law->fields[f].place) * w->body->lattice->size; k++) {
      uint64_t one;
      memcpy(&one, &w->new_field[f][k], sizeof one);
      bits = (bits ^ one) * UINT64_C(0x100000001b3);
    }
  return bits;
}

typedef struct sums {
  const rows *lattice;
  int dof;
  double *force[PL_MAX_DOF], largest, unequal;
  long bonds;
} sums;

static void add(void *to, const bond_force *b) {
  sums *s = to;
  s->bonds++;
  assert_true(rows_has_bond(s->lattice, b->owner, b->direction));
  assert_int_equal(b->partner, rows_partner(s->lattice, b->owner, b->direction));
  for (int d = 0; d < s->dof; d++) {
    s->force[d][b->owner] += b->on_owner[d];
    s->force[d][b->partner] += b->on_partner[d];
    s->largest = fmax(s->largest, fabs(b->on_owner[d]));
    if (d < s->lattice->dimensions)
      s->unequal = fmax(s->unequal, fabs(b->on_owner[d] + b->on_partner[d]));
  }
}

static sums sums_new(const sweep *w) {
  sums s = {.lattice = w->body->lattice, .dof = w->body->dof};
  for (int d = 0; d < s.dof; d++)
    s.force[d] = calloc((size_t)s.lattice->size, sizeof(double));
  return s;
}

static void sums_free(sums *s) {
  for (int d = 0; d < s->dof; d++)
    free(s->force[d]);
}

static void assert_sums_are_those_observed(const sweep *w, bond_forces *f) {
  sums s = sums_new(w);
  double off = 0;
  bond_forces_find(f, -1);
  bond_forces_each(f, NULL, add, &s);
  for (int d = 0; d < s.dof; d++)
    for (long q = 0; q < s.lattice->size; q++)
      if (s.lattice->present[q]) off = fmax(off, fabs(s.force[d][q] - w->body->force[d][q]));
  assert_int_equal(s.bonds, s.lattice->bond_count);
  assert_true(s.largest > 1);
  assert_true(off < 1e-14 * s.largest);
  assert_true(s.unequal < 1e-14 * s.largest);
  sums_free(&s);
}

/* In any form that laws of models/ take on rows and on lists: the body of each deck, shaken. */
static void of_each_deck(void (*check)(const deck_case *c, sweep *w, bond_forces *f)) {
  for (size_t n = 0; n < sizeof decks / sizeof *decks; n++) {
    deck_case c;
    assert_true(deck_case_text(&c, decks[n]));
    sweep *w = simulation_state(c.simulation, 0);
    shake(w);
    bond_forces *f = bond_forces_new(w);
    check(&c, w, f);
    bond_forces_free(f);
    deck_case_close(&c);
  }
}

static void check_sums(const deck_case *c, sweep *w, bond_forces *f) {
  (void)c;
  sweep_observe(w);
  assert_sums_are_those_observed(w, f);
  assert_true(sweep_step(w));
  sweep_observe(w);
  const uint64_t before = bits_of_fields(w);
  assert_sums_are_those_observed(w, f);
  assert_int_equal(bits_of_fields(w), before);
}

/* What was observed stays. */
static void they_add_up_to_the_forces_on_particles(void **state) {
  (void)state;
  of_each_deck(check_sums);
}

typedef struct chosen {
  double *force[PL_MAX_DOF]; /* [directions * size] on owners */
  const rows *lattice;
  const uint64_t *wanted;
} chosen;

static chosen chosen_new(const rows *g, const uint64_t *wanted) {
  chosen all = {.lattice = g, .wanted = wanted};
  for (int d = 0; d < g->dimensions; d++)
    all.force[d] = calloc((size_t)(g->directions * g->size), sizeof(double));
  return all;
}

static void chosen_free(chosen *all) {
  for (int d = 0; d < all->lattice->dimensions; d++)
    free(all->force[d]);
}

static void keep(void *to, const bond_force *b) {
  const chosen *all = to;
  for (int d = 0; d < all->lattice->dimensions; d++)
    all->force[d][b->direction * all->lattice->size + b->owner] = b->on_owner[d];
}

static void compare(void *to, const bond_force *b) {
  chosen *all = to;
  assert_true(all->wanted[b->owner] >> b->direction & 1);
  for (int d = 0; d < all->lattice->dimensions; d++) {
    double *force = &all->force[d][b->direction * all->lattice->size + b->owner];
    assert_memory_equal(force, &b->on_owner[d], sizeof(double));
    *force = NAN; /* comes once */
  }
}

static void check_chosen(const deck_case *c, sweep *w, bond_forces *f) {
  (void)c;
  const rows *g = w->body->lattice;
  uint64_t *wanted = calloc((size_t)g->size, sizeof *wanted);
  chosen all = chosen_new(g, wanted);
  for (long q = 0; q < g->size; q++)
    if (fabs(g->x[q] - 0.02) < 0.012) wanted[q] = UINT64_C(0x5b) * (uint64_t)(q % 5);
  bond_forces_find(f, -1);
  bond_forces_each(f, NULL, keep, &all);
  bond_forces_each(f, wanted, compare, &all);
  chosen_free(&all);
  free(wanted);
}

static void those_asked_for_are_as_among_all(void **state) {
  (void)state;
  of_each_deck(check_chosen);
}

/* The same shaken body by the graph of the law, read node by node. */
static void check_interpreter(const deck_case *c, sweep *w, bond_forces *f) {
  const rows *g = w->body->lattice;
  pl_law *read = plan_interpreted(c->model.plan);
  sweep *other = interaction_new(g, read, c->law.parameters, w->body->time_step, 1, false, true);
  uint64_t *all_bonds = calloc((size_t)g->size, sizeof *all_bonds);
  chosen all = chosen_new(g, all_bonds);
  memset(all_bonds, 0xff, (size_t)g->size * sizeof *all_bonds);
  other->parameter = w->parameter;
  shake(other);
  bond_forces *others = bond_forces_new(other);
  bond_forces_find(f, -1);
  bond_forces_find(others, -1);
  bond_forces_each(f, NULL, keep, &all);
  bond_forces_each(others, NULL, compare, &all);
  chosen_free(&all);
  free(all_bonds);
  bond_forces_free(others);
  sweep_free(other);
  plan_interpreted_free(read);
}

static void the_interpreter_finds_the_same_bits(void **state) {
  (void)state;
  of_each_deck(check_interpreter);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(they_add_up_to_the_forces_on_particles),
      cmocka_unit_test(those_asked_for_are_as_among_all),
      cmocka_unit_test(the_interpreter_finds_the_same_bits),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
