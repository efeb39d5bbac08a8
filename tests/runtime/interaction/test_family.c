/* The sweep for laws of families with a law written by hand: forces against a plain loop over
   particles, uniform strain against the theory, momentum, threads, states on particles and
   neighbours. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "dsl/base/arena.h"
#include "runtime/deck/deck_read.h"
#include "runtime/interaction/family.h"
#include "runtime/interaction/interaction.h"
#include "runtime/filling/lattice.h"
#include "tests/runtime/family_law.h"

static const double spacing = 0.01, thickness = 0.1, step = 1e-7;

typedef struct marching {
  arena *memory;
  source_set sources;
  diagnostics said;
  rows *lattice;
  double parameters[FAMILY_PARAMETERS];
  sweep *w;
} marching;

/* A disc with a notch: ragged rows, families of all kinds. */
static void open_body(marching *b, double rotation, int threads, double tau, double S_t) {
  char text[512];
  memset(b, 0, sizeof *b);
  snprintf(text, sizeof text,
           "&simulation end_time = 1e-3 /\n"
           "&lattice name = 'c' kind = 'hexagonal' spacing = %g thickness = %g rotation = %g /\n"
           "&material lattice = 'c' model = 'm' /\n"
           "&body lattice = 'c' shape = 'disc' centre = 0.003, 0.001 radius = 0.07 /\n"
           "&notch lattice = 'c' shape = 'rectangle' corner = -0.001, -0.08 size = 0.002, 0.07 /\n",
           spacing, thickness, rotation);
  b->memory = arena_new();
  diag_begin(&b->said, &b->sources);
  const int file = source_add(&b->sources, "deck.nml", text, strlen(text));
  const deck *k = deck_read(b->memory, &b->sources, file, NULL, 0, &b->said);
  b->lattice = lattice_build(k, 0, &b->said);
  assert_non_null(b->lattice);
  for (int p = 0; p < FAMILY_PARAMETERS; p++)
    b->parameters[p] = family_parameters[p].initial;
  b->parameters[FAMILY_TAU] = tau;
  b->parameters[FAMILY_S_T] = S_t;
  b->lattice->mass = b->parameters[FAMILY_RHO] * b->lattice->volume;
  b->w = interaction_new(b->lattice, &family_hexagon, b->parameters, step, threads, true, true);
}

static void close_body(marching *b) {
  sweep_free(b->w);
  rows_free(b->lattice);
  diag_clear(&b->said);
  source_clear(&b->sources);
  arena_free(b->memory);
}

static uint64_t random_bits(uint64_t *state) { /* xorshift */
  *state ^= *state << 13;
  *state ^= *state >> 7;
  *state ^= *state << 17;
  return *state;
}

static double uniform(uint64_t *state) {
  return (double)(random_bits(state) >> 11) * 0x1p-52 - 1;
}

static void shake(marching *b, uint64_t seed) {
  for (long p = 0; p < b->lattice->particle_count; p++) {
    const long site = b->lattice->particle_site[p];
    for (int d = 0; d < 2; d++) {
      b->w->body->displacement[d][site] = 1e-5 * uniform(&seed);
      b->w->body->velocity[d][site] = 0.1 * uniform(&seed);
    }
    b->w->field[0][site] = 0.5 + 0.5 * uniform(&seed);
  }
}

/* --- against a loop over particles ------------------------------------------------------------ */

typedef struct neighbour {
  long particle;
  double chord[2];
} neighbour;

/* Neighbours of particle p, from positions and the list of bonds. */
static int neighbours_of(const marching *b, const rows_bond *bonds, long p, neighbour *out) {
  const rows *g = b->lattice;
  int count = 0;
  for (long m = 0; m < g->bond_count; m++) {
    if (bonds[m].i != p && bonds[m].j != p) continue;
    const long other = bonds[m].i == p ? bonds[m].j : bonds[m].i;
    const long here = g->particle_site[p], there = g->particle_site[other];
    out[count++] = (neighbour){other, {g->x[there] - g->x[here], g->y[there] - g->y[here]}};
  }
  return count;
}

typedef struct family_state_of {
  neighbour to[6];
  double stretch[6], rate[6], e[6][2], sum, left;
  int count;
} family_state_of;

static family_state_of state_of(const marching *b, const rows_bond *bonds, long p) {
  const sweep *w = b->w;
  family_state_of f = {.count = neighbours_of(b, bonds, p, f.to)};
  const long here = b->lattice->particle_site[p];
  double largest = 0;
  for (int k = 0; k < f.count; k++) {
    const long there = b->lattice->particle_site[f.to[k].particle];
    const double s = hypot(f.to[k].chord[0], f.to[k].chord[1]);
    double c[2], rate = 0;
    for (int a = 0; a < 2; a++)
      c[a] = f.to[k].chord[a] + w->body->displacement[a][there] - w->body->displacement[a][here];
    for (int a = 0; a < 2; a++) {
      f.e[k][a] = c[a] / hypot(c[0], c[1]);
      rate += f.e[k][a] * (w->body->velocity[a][there] - w->body->velocity[a][here]) / s;
    }
    f.stretch[k] = hypot(c[0], c[1]) / s - 1;
    f.rate[k] = rate;
    f.sum += f.stretch[k];
    largest = fmax(largest, f.stretch[k]);
  }
  const double onset = b->parameters[FAMILY_S_T];
  const double grown = fmin(1, fmax(0, (largest - onset) / onset));
  f.left = 1 - fmax(w->field[0][here], grown);
  return f;
}

static double force_state(const marching *b, const family_state_of *f, int k) {
  const double E = b->parameters[FAMILY_E], nu = b->parameters[FAMILY_NU];
  const double a = 2 * E * spacing * thickness / (sqrt(3) * (1 + nu));
  const double c = E * spacing * thickness * (1 - 3 * nu) / (6 * sqrt(3) * (nu * nu - 1));
  return f->left * (a * (f->stretch[k] + b->parameters[FAMILY_TAU] * f->rate[k]) + c * f->sum);
}

static int back(const family_state_of *f, long p) {
  for (int k = 0; k < f->count; k++)
    if (f->to[k].particle == p) return k;
  return -1;
}

static void sweep_gives_the_forces_of_a_loop_over_families(void **state) {
  (void)state;
  const double rotations[] = {0, 17, 90};
  for (int k = 0; k < 9; k++) {
    marching b;
    open_body(&b, rotations[k / 3], 1 + k % 3, 1e-7, 1e-3);
    shake(&b, 7);
    rows_bond *bonds = rows_bonds(b.lattice);
    const long n = b.lattice->particle_count;
    family_state_of *f = must_calloc((size_t)n, sizeof *f);
    for (long p = 0; p < n; p++)
      f[p] = state_of(&b, bonds, p);
    sweep_observe(b.w);
    double largest = 0, worst = 0;
    for (long p = 0; p < n; p++) {
      double force[2] = {0, 0};
      for (int m = 0; m < f[p].count; m++) {
        const family_state_of *other = &f[f[p].to[m].particle];
        const double N = (force_state(&b, &f[p], m) + force_state(&b, other, back(other, p))) / 2;
        for (int a = 0; a < 2; a++)
          force[a] += N * f[p].e[m][a];
      }
      for (int a = 0; a < 2; a++) {
        largest = fmax(largest, fabs(force[a]));
        worst = fmax(worst, fabs(force[a] - b.w->body->force[a][b.lattice->particle_site[p]]));
      }
    }
    assert_true(worst <= 1e-11 * largest); /* a stretch of 1e-3 by length/s - 1 has 1e-13 */
    free(f);
    free(bonds);
    close_body(&b);
  }
}

/* --- elasticity ------------------------------------------------------------------------------- */

static bool is_inside(const rows *g, long q) { /* full family of full families */
  return hypot(g->x[q] - 0.003, g->y[q] - 0.001) < 0.045 && g->y[q] > 0.015;
}

static void strain_uniformly(const marching *b, const double e[3], double size) {
  const rows *g = b->lattice;
  for (long p = 0; p < g->particle_count; p++) {
    const long q = g->particle_site[p];
    b->w->body->displacement[0][q] = size * (e[0] * g->x[q] + 0.5 * e[2] * g->y[q]);
    b->w->body->displacement[1][q] = size * (e[1] * g->y[q] + 0.5 * e[2] * g->x[q]);
  }
}

/* Inside there is no force, and a particle holds V/2 e D e; the strain fitted to the stretches is e
   wherever three bonds fix it. */
static void check_strain(double rotation, const double e[3]) {
  const double E = 30e9, nu = 0.2, size = 1e-12; /* second order is lost in rounding */
  const double D[3][3] = {{E / (1 - nu * nu), nu * E / (1 - nu * nu), 0},
                          {nu * E / (1 - nu * nu), E / (1 - nu * nu), 0},
                          {0, 0, E / (2 * (1 + nu))}};
  marching b;
  open_body(&b, rotation, 2, 0, 1e30);
  const rows *g = b.lattice;
  double *energy = must_calloc((size_t)g->size, sizeof *energy);
  double *strain = must_calloc((size_t)g->size, sizeof *strain), expected = 0;
  for (int i = 0; i < 3; i++)
    for (int j = 0; j < 3; j++)
      expected += 0.5 * D[i][j] * e[i] * e[j] * size * size * g->volume;
  strain_uniformly(&b, e, size);
  sweep_observe(b.w);
  sweep_output(b.w, 0, energy);
  sweep_output(b.w, 2, strain);
  long inside = 0, corners = 0;
  for (long p = 0; p < g->particle_count; p++) {
    const long q = g->particle_site[p];
    if (is_inside(g, q)) {
      inside++;
      assert_true(fabs(energy[q] - expected) <= 1e-12 * expected);
      for (int a = 0; a < 2; a++)
        assert_true(fabs(b.w->body->force[a][q]) <= 1e-12 * E * size * spacing * thickness);
    }
    if (__builtin_popcountll(g->bonds[q]) < 3) continue;
    corners += !is_inside(g, q);
    assert_true(fabs(strain[q] - size * e[0]) <= 1e-12 * size);
  }
  assert_true(inside > 15 && corners > 30);
  free(energy);
  free(strain);
  close_body(&b);
}

static void uniform_strain_gives_the_stiffness_of_theory(void **state) {
  (void)state;
  const double rotations[] = {0, 11, 30};
  const double strains[][3] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {0.3, -0.8, 0.6}};
  for (int k = 0; k < 12; k++)
    check_strain(rotations[k / 4], strains[k % 4]);
}

/* A rigid motion by a large angle leaves no force and no strain. */
static void rotation_leaves_no_force(void **state) {
  (void)state;
  marching b;
  open_body(&b, 17, 2, 0, 1e30);
  const rows *g = b.lattice;
  const double c = cos(2.1), s = sin(2.1);
  for (long p = 0; p < g->particle_count; p++) {
    const long q = g->particle_site[p];
    b.w->body->displacement[0][q] = c * g->x[q] - s * g->y[q] - g->x[q] + 0.07;
    b.w->body->displacement[1][q] = s * g->x[q] + c * g->y[q] - g->y[q] - 0.02;
  }
  sweep_observe(b.w);
  for (long p = 0; p < g->particle_count; p++)
    for (int a = 0; a < 2; a++) /* against the force of a stretch of 1 */
      assert_true(fabs(b.w->body->force[a][g->particle_site[p]]) <
                  1e-13 * 30e9 * spacing * thickness);
  close_body(&b);
}

/* --- steps ------------------------------------------------------------------------------------ */

static void momentum(const marching *b, double total[2], double *scale) {
  total[0] = total[1] = *scale = 0;
  for (long p = 0; p < b->lattice->particle_count; p++)
    for (int a = 0; a < 2; a++) {
      const double v = b->w->body->velocity[a][b->lattice->particle_site[p]];
      total[a] += v;
      *scale += fabs(v);
    }
}

static void momentum_stays(void **state) {
  (void)state;
  marching b;
  double before[2], after[2], scale;
  open_body(&b, 17, 3, 1e-7, 1e-4);
  shake(&b, 5);
  momentum(&b, before, &scale);
  for (int n = 0; n < 200; n++)
    assert_true(sweep_step(b.w));
  momentum(&b, after, &scale);
  for (int a = 0; a < 2; a++)
    assert_true(fabs(after[a] - before[a]) <= 1e-12 * scale);
  close_body(&b);
}

static void same_arrays(const sweep *a, const sweep *b) {
  const size_t site = (size_t)a->body->lattice->size * sizeof(double);
  for (int d = 0; d < a->body->dof; d++) {
    assert_memory_equal(a->body->displacement[d], b->body->displacement[d], site);
    assert_memory_equal(a->body->velocity[d], b->body->velocity[d], site);
    assert_memory_equal(a->body->force[d], b->body->force[d], site);
  }
  assert_memory_equal(a->field[0], b->field[0], site);
  assert_memory_equal(a->field[1], b->field[1], 6 * site);
}

static void threads_do_not_change_a_bit(void **state) {
  (void)state;
  marching one, many;
  open_body(&one, 17, 1, 1e-7, 1e-4);
  shake(&one, 3);
  for (int n = 0; n < 40; n++)
    assert_true(sweep_step(one.w));
  const int threads[] = {2, 3, 1000};
  for (int k = 0; k < 3; k++) {
    open_body(&many, 17, threads[k], 1e-7, 1e-4);
    assert_true(many.w->body->block_count > 1);
    shake(&many, 3);
    for (int n = 0; n < 40; n++)
      assert_true(sweep_step(many.w));
    same_arrays(one.w, many.w);
    close_body(&many);
  }
  close_body(&one);
}

static void observing_changes_no_state(void **state) {
  (void)state;
  marching a, b;
  open_body(&a, 0, 2, 1e-7, 1e-4);
  open_body(&b, 0, 2, 1e-7, 1e-4);
  shake(&a, 5);
  shake(&b, 5);
  for (int n = 0; n < 5; n++) {
    sweep_observe(a.w);
    assert_true(sweep_step(a.w) && sweep_step(b.w));
  }
  same_arrays(a.w, b.w);
  close_body(&a);
  close_body(&b);
}

/* States on either side of a bond, once all damage is held and once free; absent sites at rest. */
static void fields_follow_their_rules(void **state) {
  (void)state;
  for (int held = 0; held < 2; held++) {
    marching b;
    open_body(&b, 17, 2, 0, 1e-4);
    shake(&b, 9);
    rows *g = b.lattice;
    for (long q = 0; q < g->size; q++)
      g->held[q] = (uint64_t)held;
    double *before = must_calloc((size_t)g->size, sizeof *before), grown = 0;
    memcpy(before, b.w->field[0], (size_t)g->size * sizeof *before);
    rows_bond *bonds = rows_bonds(g);
    double *most = must_calloc((size_t)g->bond_count, sizeof *most);
    for (long m = 0; m < g->bond_count; m++)
      most[m] = -1;
    for (int n = 0; n < 30; n++) {
      for (long m = 0; m < g->bond_count; m++) {
        const long i = g->particle_site[bonds[m].i], j = g->particle_site[bonds[m].j];
        const double C[2] = {g->x[j] - g->x[i], g->y[j] - g->y[i]};
        const double now =
            hypot(C[0] + b.w->body->displacement[0][j] - b.w->body->displacement[0][i],
                  C[1] + b.w->body->displacement[1][j] - b.w->body->displacement[1][i]);
        most[m] = fmax(most[m], now / spacing - 1);
      }
      assert_true(sweep_step(b.w));
    }
    for (long m = 0; m < g->bond_count; m++) {
      const double kept = sweep_bond_value(b.w, b.w->field[1], &bonds[m]);
      assert_true(fabs(kept - most[m]) < 1e-13);
      assert_true(b.w->field[1][bonds[m].slot] == kept); /* both sides saw the same */
    }
    for (long q = 0; q < g->size; q++) {
      assert_true(b.w->field[0][q] >= before[q]);
      grown = fmax(grown, b.w->field[0][q] - before[q]);
      if (g->present[q]) continue;
      assert_true(b.w->body->displacement[0][q] == 0 && b.w->body->velocity[1][q] == 0);
    }
    assert_true(held ? grown == 0 : grown > 0.1);
    free(before);
    free(bonds);
    free(most);
    close_body(&b);
  }
}

static void a_number_gone_bad_is_caught_before_it_moves(void **state) {
  (void)state;
  marching b;
  open_body(&b, 0, 3, 0, 1e-4);
  const long site = b.lattice->particle_site[b.lattice->particle_count / 3];
  b.w->field[0][site] = NAN;
  assert_false(sweep_step(b.w));
  const body_block *at = &b.w->body->blocks[body_bad(b.w->body)];
  assert_true(at->bad_site <= site && isnan(at->bad_velocity));
  assert_true(b.w->body->velocity[0][site] == 0 && b.w->body->displacement[0][site] == 0);
  close_body(&b);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(sweep_gives_the_forces_of_a_loop_over_families),
      cmocka_unit_test(uniform_strain_gives_the_stiffness_of_theory),
      cmocka_unit_test(rotation_leaves_no_force),
      cmocka_unit_test(momentum_stays),
      cmocka_unit_test(threads_do_not_change_a_bit),
      cmocka_unit_test(observing_changes_no_state),
      cmocka_unit_test(fields_follow_their_rules),
      cmocka_unit_test(a_number_gone_bad_is_caught_before_it_moves),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
