/* The sweep against a plain loop over the list of bonds, its independence of threads, and what it
   reports when a state goes bad. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "runtime/interaction/pairwise.h"
#include "runtime/parts/ledger.h"
#include "runtime/simulation/bad_state.h"
#include "tests/runtime/small_run.h"

/* A body with ragged rows: disc, rotated lattice, a notch. */
static void open_disc(small_run *r, const pl_law *law, double radius, double rotation,
                      int threads) {
  char text[1024];
  snprintf(text, sizeof text,
           "&simulation end_time = 1e-3 step = 1e-7 threads = %d /\n"
           "&lattice name = 'c' kind = 'hexagonal' spacing = 0.01 thickness = 0.1 rotation = %g /\n"
           "&material lattice = 'c' model = 'm' S_t = 1e-3 tau = 1e-7 /\n"
           "&body lattice = 'c' shape = 'disc' centre = 0.003, 0.001 radius = %g /\n"
           "&notch lattice = 'c' shape = 'rectangle' corner = -0.001, -0.08 size = 0.002, 0.07 /\n"
           "&output energy = .true. fields = 'displacement', 'force' /\n",
           threads, rotation, radius);
  small_open(r, law, text);
  if (!r->simulation) small_print(r);
  assert_non_null(r->simulation);
}

static void open_ragged(small_run *r, const pl_law *law, double rotation, int threads) {
  open_disc(r, law, 0.07, rotation, threads);
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

/* Random displacements and velocities on the particles, random damage on the bonds. */
static void shake(small_run *r, uint64_t seed) {
  sweep *w = simulation_state(r->simulation, 0);
  const rows *g = w->body->lattice;
  for (long p = 0; p < g->particle_count; p++)
    for (int d = 0; d < w->body->dof; d++) {
      w->body->displacement[d][g->particle_site[p]] = (d < 2 ? 1e-4 : 1e-2) * uniform(&seed);
      w->body->velocity[d][g->particle_site[p]] = (d < 2 ? 1 : 10) * uniform(&seed);
    }
  rows_bond *bonds = rows_bonds(g);
  for (long b = 0; b < g->bond_count; b++)
    w->field[0][bonds[b].slot] = 0.5 + 0.5 * uniform(&seed);
  free(bonds);
}

/* Force and moment on every particle: [particle][3], bond by bond. */
static double *forces_by_list(const sweep *w) {
  const rows *g = w->body->lattice;
  double *force = must_calloc((size_t)g->particle_count * 3, sizeof *force);
  rows_bond *bonds = rows_bonds(g);
  for (long m = 0; m < g->bond_count; m++) {
    const int k = (int)(bonds[m].slot / g->size);
    const long i = g->particle_site[bonds[m].i], j = g->particle_site[bonds[m].j];
    const int64_t flags = PL_PRESENT(k);
    double field = w->field[0][bonds[m].slot], plane[4] = {0};
    double *fields[] = {&field}, *planes[] = {&plane[0], &plane[1], &plane[2], &plane[3]};
    pl_strip s = {.size = sizeof(pl_strip),
                  .count = 1,
                  .direction = k,
                  .flags = &flags,
                  .field = fields,
                  .force = planes};
    for (int d = 0; d < w->body->dof; d++) {
      s.displacement_i[d] = &w->body->displacement[d][i];
      s.displacement_j[d] = &w->body->displacement[d][j];
      s.velocity_i[d] = &w->body->velocity[d][i];
      s.velocity_j[d] = &w->body->velocity[d][j];
    }
    w->law->rows(w->law, pairwise_uniforms(w, k), &s);
    for (int d = 0; d < 2; d++) {
      force[3 * bonds[m].i + d] += plane[d];
      force[3 * bonds[m].j + d] -= plane[d];
    }
    force[3 * bonds[m].i + 2] -= plane[2];
    force[3 * bonds[m].j + 2] -= plane[3];
  }
  free(bonds);
  return force;
}

static void check_against_list(const pl_law *law, double rotation, int threads) {
  small_run r;
  open_ragged(&r, law, rotation, threads);
  shake(&r, 7);
  sweep *w = simulation_state(r.simulation, 0);
  const rows *g = w->body->lattice;
  double *force = forces_by_list(w), *v = must_calloc((size_t)g->particle_count * 3, sizeof *v),
         scale[3] = {0};
  for (long p = 0; p < g->particle_count; p++)
    for (int d = 0; d < w->body->dof; d++) {
      v[3 * p + d] = w->body->velocity[d][g->particle_site[p]];
      scale[d] = fmax(scale[d], fabs(force[3 * p + d]));
    }
  sweep_observe(w);
  for (long p = 0; p < g->particle_count; p++)
    for (int d = 0; d < w->body->dof; d++) /* a few roundings of sums in another order */
      assert_true(fabs(w->body->force[d][g->particle_site[p]] - force[3 * p + d]) <=
                  1e-14 * scale[d]);
  sweep_step(w);
  for (long p = 0; p < g->particle_count; p++)
    for (int d = 0; d < w->body->dof; d++) {
      const double change = w->body->time_step / w->body->mass[d] * force[3 * p + d];
      const double after = w->body->velocity[d][g->particle_site[p]];
      assert_true(fabs(after - v[3 * p + d] - change) <=
                  1e-14 * w->body->time_step / w->body->mass[d] * scale[d] + 1e-14);
    }
  free(force);
  free(v);
  small_close(&r);
}

static void sweep_gives_the_forces_of_the_bond_list(void **state) {
  (void)state;
  const double rotations[] = {0, 17, 90};
  for (int k = 0; k < 3; k++)
    for (int threads = 1; threads <= 3; threads++) {
      check_against_list(&elastic_beam, rotations[k], threads);
      check_against_list(&elastic_bar, rotations[k], threads);
    }
}

static void same_arrays(const sweep *a, const sweep *b) {
  const size_t site = (size_t)a->body->lattice->size * sizeof(double);
  for (int d = 0; d < a->body->dof; d++) {
    assert_memory_equal(a->body->displacement[d], b->body->displacement[d], site);
    assert_memory_equal(a->body->velocity[d], b->body->velocity[d], site);
  }
  assert_memory_equal(a->field[0], b->field[0], site * (size_t)a->body->lattice->directions);
  assert_memory_equal(a->dissipated_state, b->dissipated_state, site);
  assert_memory_equal(a->dissipated_rate, b->dissipated_rate, site);
}

/* The rows of a disc are of many lengths: blocks differ from their part by less than a row. */
static void blocks_are_alike(void **state) {
  (void)state;
  for (int threads = 1; threads <= 8; threads++) {
    small_run r;
    open_disc(&r, &elastic_beam, 0.3, 0, threads);
    const sweep *w = simulation_state(r.simulation, 0);
    long all = 0, longest = 0;
    for (int row = 0; row < w->body->lattice->row_count; row++) {
      all += w->body->count[row];
      longest = w->body->count[row] > longest ? w->body->count[row] : longest;
    }
    assert_int_equal(w->body->block_count, threads);
    assert_int_equal(w->body->blocks[0].first, 0);
    assert_int_equal(w->body->blocks[threads - 1].last, w->body->lattice->row_count);
    for (int k = 0; k < threads; k++) {
      long here = 0;
      if (k > 0) assert_int_equal(w->body->blocks[k].first, w->body->blocks[k - 1].last);
      for (int row = w->body->blocks[k].first; row < w->body->blocks[k].last; row++)
        here += w->body->count[row];
      assert_true(here > 0 && labs(threads * here - all) <= threads * longest);
    }
    small_close(&r);
  }
}

static void threads_do_not_change_a_bit(void **state) {
  (void)state;
  small_run one, many;
  open_ragged(&one, &elastic_beam, 17, 1);
  shake(&one, 3);
  simulation_advance(one.simulation, 40, NULL);
  const int threads[] = {2, 3, 5, 1000};
  for (int k = 0; k < 4; k++) {
    open_ragged(&many, &elastic_beam, 17, threads[k]);
    shake(&many, 3);
    simulation_advance(many.simulation, 40, NULL);
    assert_int_equal(simulation_step_done(many.simulation), 40);
    same_arrays(simulation_state(one.simulation, 0), simulation_state(many.simulation, 0));
    const double *a, *b;
    assert_int_equal(simulation_series_count(one.simulation), LEDGER_COUNT);
    for (int t = 0; t < LEDGER_COUNT; t++) {
      simulation_series(one.simulation, t, NULL, &a);
      simulation_series(many.simulation, t, NULL, &b);
      assert_memory_equal(a, b, (size_t)simulation_history(one.simulation, NULL) * sizeof(double));
    }
    small_close(&many);
  }
  small_close(&one);
}

static void observing_changes_no_state(void **state) {
  (void)state;
  small_run a, b;
  open_ragged(&a, &elastic_beam, 0, 2);
  open_ragged(&b, &elastic_beam, 0, 2);
  shake(&a, 5);
  shake(&b, 5);
  sweep_observe(simulation_state(a.simulation, 0));
  same_arrays(simulation_state(a.simulation, 0), simulation_state(b.simulation, 0));
  small_close(&a);
  small_close(&b);
}

/* Absent sites stay at zero: nothing leaks out of the body. */
static void absent_sites_stay_at_rest(void **state) {
  (void)state;
  small_run r;
  open_ragged(&r, &elastic_beam, 17, 3);
  shake(&r, 9);
  simulation_advance(r.simulation, 20, NULL);
  const sweep *w = simulation_state(r.simulation, 0);
  for (long site = 0; site < w->body->lattice->size; site++)
    for (int d = 0; d < w->body->dof && !w->body->lattice->present[site]; d++) {
      assert_true(w->body->displacement[d][site] == 0);
      assert_true(w->body->velocity[d][site] == 0);
    }
  small_close(&r);
}

static void a_number_gone_bad_is_caught_in_its_step(void **state) {
  (void)state;
  for (int threads = 1; threads <= 3; threads++) {
    small_run r;
    open_ragged(&r, &elastic_beam, 0, threads);
    shake(&r, 11);
    assert_int_equal(simulation_advance(r.simulation, 3, NULL), STEP_OK);
    sweep *w = simulation_state(r.simulation, 0);
    rows_bond *bonds = rows_bonds(w->body->lattice);
    const rows_bond broken = bonds[w->body->lattice->bond_count / 2];
    w->field[0][broken.slot] = NAN;
    free(bonds);
    assert_int_equal(simulation_advance(r.simulation, 10, NULL), STEP_BAD);
    assert_int_equal(simulation_step_done(r.simulation), 3);
    const bad_state bad = simulation_bad(r.simulation);
    assert_int_equal(bad.step, 3);
    assert_int_equal(bad.particle, broken.i); /* the owner is the lower end */
    assert_int_equal(bad.bond_particle, broken.j);
    assert_string_equal(bad.what, "not a number");
    assert_true(isfinite(bad.stretch) && fabs(bad.stretch) < 0.1);
    assert_true(isfinite(bad.theta_i) && fabs(bad.theta_i) < 0.1);
    assert_int_equal(bad.field_count, elastic_beam.field_count);
    assert_true(bad.fields[0] == elastic_beam.fields[0].initial); /* what it held was no number */
    assert_int_equal(simulation_advance(r.simulation, 10, NULL), STEP_BAD);
    small_close(&r);
  }
}

static void a_runaway_is_caught(void **state) {
  (void)state;
  small_run r;
  open_ragged(&r, &elastic_beam, 0, 2);
  sweep *w = simulation_state(r.simulation, 0);
  const long site = w->body->lattice->particle_site[w->body->lattice->particle_count / 3];
  w->body->displacement[2][site] =
      1; /* a rotation that its neighbours answer with far too large a moment */
  w->body->velocity[2][site] = 1e9;
  assert_int_equal(simulation_advance(r.simulation, 10, NULL), STEP_BAD);
  const bad_state bad = simulation_bad(r.simulation);
  assert_int_equal(bad.step, 0);
  assert_int_equal(bad.particle, w->body->lattice->particle_count / 3);
  assert_string_equal(bad.what, "runaway rotation");
  assert_true(bad.bond_particle >= 0);
  assert_true(fabs(fabs(bad.theta_i) - 1) < 1e-12 || fabs(fabs(bad.theta_j) - 1) < 1e-12);
  small_close(&r);
}

/* Those of a disc differ, those along the notch do not. */
static void rows_alike_share_their_flags(void **state) {
  (void)state;
  small_run r;
  open_ragged(&r, &elastic_beam, 0, 1);
  const sweep *w = simulation_state(r.simulation, 0);
  const rows *g = w->body->lattice;
  int shared = 0, own = 0;
  for (int row = 0; row < g->row_count; row++) {
    const int64_t *flags = pairwise_flags(w, row);
    const long start = rows_start(g, row) + w->body->begin[row];
    for (long q = 0; q < w->body->count[row]; q++)
      assert_int_equal(flags[q], (int64_t)(g->bonds[start + q] | g->held_bonds[start + q] << 32));
    if (row < 2 || w->body->count[row] == 0) continue;
    if (flags == pairwise_flags(w, row - 2))
      shared++;
    else
      own++;
  }
  assert_true(shared > 0 && own > 0);
  small_close(&r);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(sweep_gives_the_forces_of_the_bond_list),
      cmocka_unit_test(rows_alike_share_their_flags),
      cmocka_unit_test(blocks_are_alike),
      cmocka_unit_test(threads_do_not_change_a_bit),
      cmocka_unit_test(observing_changes_no_state),
      cmocka_unit_test(absent_sites_stay_at_rest),
      cmocka_unit_test(a_number_gone_bad_is_caught_in_its_step),
      cmocka_unit_test(a_runaway_is_caught),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
