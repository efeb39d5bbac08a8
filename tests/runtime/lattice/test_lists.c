/* Particles that stand anywhere: their rows, and sweeps of a law written by hand over them, against
   the same particles on a lattice, whatever their numbers, on any number of threads. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include <stdio.h>

#include "runtime/analysis/stability.h"
#include "runtime/deck/deck.h"
#include "runtime/deck/deck_read.h"
#include "runtime/interaction/interaction.h"
#include "runtime/interaction/sweep.h"
#include "runtime/filling/lattice.h"
#include "runtime/lattice/rows_select.h"
#include "runtime/lattice/scattered.h"
#include "runtime/lattice/shape_matrix.h"
#include "tests/runtime/family_law.h"
#include "tests/runtime/scattered_points.h"

static const double spacing = 0.01, thickness = 0.1, step = 1e-7;

/* --- bodies ----------------------------------------------------------------------------------- */

typedef struct marching {
  rows *rows;
  pl_law law;
  double parameters[FAMILY_PARAMETERS];
  sweep *w;
} marching;

static void set_masses(rows *g, double rho) {
  g->mass = rho * g->volume;
  for (long q = 0; g->list && q < g->size; q++)
    g->site_mass[q] = rho * g->site_volume[q];
}

static marching body_of(rows *g, double tau, double S_t) {
  marching b = {.rows = g, .law = g->list ? family_for_lists(&family_hexagon) : family_hexagon};
  assert_non_null(g);
  for (int p = 0; p < FAMILY_PARAMETERS; p++)
    b.parameters[p] = family_parameters[p].initial;
  b.parameters[FAMILY_TAU] = tau;
  b.parameters[FAMILY_S_T] = S_t;
  set_masses(g, b.parameters[FAMILY_RHO]);
  return b;
}

static void set_going(marching *b, int threads) {
  b->w = interaction_new(b->rows, &b->law, b->parameters, step, threads, true, true);
}

static void close_body(marching *b) {
  sweep_free(b->w);
  rows_free(b->rows);
}

static rows *list_of(const test_points *p, const double *measure, double horizon, int neighbours) {
  const scattered from = {.points = p->cloud,
                          .measure = measure,
                          .spacing = spacing,
                          .horizon = horizon,
                          .neighbours = neighbours,
                          .stiffness_thickness = thickness,
                          .mass_thickness = thickness};
  long crowded;
  return scattered_rows(&from, &crowded);
}

/* Hexagonal, shaken, with volumes from half to one and a half of the mean. */
static rows *shaken_list(long columns, long lines, double shake, int neighbours,
                         const int32_t *numbers) {
  test_points p = points_hexagonal(columns, lines, shake, 3);
  double *measure = must_alloc((size_t)p.cloud.count * sizeof *measure);
  uint64_t seed = 77;
  for (long k = 0; k < p.cloud.count; k++) {
    for (int a = 0; a < 2; a++)
      p.at[a][k] *= spacing;
    measure[numbers ? numbers[k] : k] = sqrt(0.75) * spacing * spacing * (0.5 + points_draw(&seed));
  }
  if (numbers) {
    test_points other = points_renumbered(&p, numbers);
    points_free(&p);
    p = other;
  }
  rows *g = list_of(&p, measure, 0, neighbours);
  points_free(&p);
  free(measure);
  return g;
}

static rows *rows_of_deck(const char *text) {
  arena *memory = arena_new();
  source_set sources = {0};
  diagnostics said = {0};
  diag_begin(&said, &sources);
  const deck *k = deck_read(memory, &sources, source_add(&sources, "deck.nml", text, strlen(text)),
                            NULL, 0, &said);
  rows *g = k ? lattice_build(k, 0, &said) : NULL;
  if (!g) diag_print(&said, stderr);
  diag_clear(&said);
  source_clear(&sources);
  arena_free(memory);
  return g;
}

/* A disc with a notch, on a lattice; and the same particles on a list. */
static rows *lattice_disc(double radius) {
  char text[512];
  snprintf(text, sizeof text,
           "&simulation end_time = 1e-3 /\n"
           "&lattice name = 'c' kind = 'hexagonal' spacing = %g thickness = %g rotation = 17 /\n"
           "&material lattice = 'c' model = 'm' /\n"
           "&body lattice = 'c' shape = 'disc' centre = 0.003, 0.001 radius = %g /\n"
           "&notch lattice = 'c' shape = 'rectangle' corner = -0.001, %g size = 0.002, %g /\n",
           spacing, thickness, radius, -radius, radius);
  return rows_of_deck(text);
}

static rows *as_list(const rows *g) {
  test_points p = points_new(2, g->particle_count);
  double *measure = must_alloc((size_t)g->particle_count * sizeof *measure);
  for (long k = 0; k < g->particle_count; k++) {
    p.at[0][k] = g->x[g->particle_site[k]];
    p.at[1][k] = g->y[g->particle_site[k]];
    measure[k] = g->site_area;
  }
  rows *list = list_of(&p, measure, 1.001 * spacing, 0);
  deck_shape notch = {.kind = SHAPE_RECTANGLE, .corner = {-0.001, -1}, .size = {0.002, 1}};
  for (long q = 0; q < list->size; q++)
    rows_cut(list, q, &notch);
  rows_count_bonds(list);
  points_free(&p);
  free(measure);
  return list;
}

/* Particle k begins as particle numbers[k] of another body. */
static void shake(const marching *b, const int32_t *numbers, uint64_t seed) {
  for (long p = 0; p < b->rows->particle_count; p++) {
    const long site = b->rows->particle_site[numbers ? numbers[p] : p];
    for (int d = 0; d < 2; d++) {
      b->w->body->displacement[d][site] = 1e-5 * (2 * points_draw(&seed) - 1);
      b->w->body->velocity[d][site] = 0.1 * (2 * points_draw(&seed) - 1);
    }
    b->w->field[0][site] = 0.5 * points_draw(&seed);
  }
}

static void go(const marching *b, int steps) {
  for (int n = 0; n < steps; n++)
    assert_true(sweep_step(b->w));
}

/* --- rows ------------------------------------------------------------------------------------- */

static void check_list(const rows *g) {
  const neighbour_list *l = g->list;
  long bonds = 0;
  assert_int_equal(g->size, (long)g->row_count * g->pitch);
  assert_int_equal(g->pitch % PL_LANES, 0);
  for (long q = 0; q < g->size; q++) {
    if (!g->present[q]) assert_true(g->bonds[q] == 0 && l->incoming[q] == 0);
    for (int k = 0; k < 2 * g->directions; k++) {
      const long there = rows_partner(g, q, k), slot = k * g->size + q;
      const int back = k < g->directions ? k + g->directions : k - g->directions;
      double square = 0;
      assert_true(there >= 0 && there < g->size && l->length[slot] > 0);
      for (int a = 0; a < g->dimensions; a++)
        square += l->chord[a][slot] * l->chord[a][slot];
      assert_true(fabs(sqrt(square) - l->length[slot]) <= 1e-15 * l->length[slot]);
      if (!rows_has_neighbour(g, q, k)) {
        assert_true(!g->present[there] && rows_degree(g, there) == 0);
        continue;
      }
      bonds++;
      assert_true(g->present[there] && rows_has_neighbour(g, there, back));
      assert_true(rows_partner(g, there, back) == q);
      assert_true(l->chord[0][slot] == g->x[there] - g->x[q]);
      assert_true(l->chord[1][back * g->size + there] == -l->chord[1][slot]);
      assert_true(l->length[back * g->size + there] == l->length[slot]);
    }
  }
  assert_int_equal(bonds, 2 * g->bond_count);
}

static void lists_keep_their_promises(void **state) {
  (void)state;
  for (int neighbours = 1; neighbours <= 30; neighbours += 7) {
    rows *g = shaken_list(40, 31, 0.3, neighbours, NULL);
    check_list(g);
    rows_free(g);
  }
  const double sides[3] = {1, 2, 0.3};
  test_points p = points_drawn(3, 1500, sides, 9);
  double *measure = must_calloc(1500, sizeof *measure);
  for (long k = 0; k < 1500; k++)
    measure[k] = 0.6 / 1500;
  rows *g = list_of(&p, measure, 0, 18);
  check_list(g);
  assert_true(fabs(g->volume - 0.6 / 1500) <= 1e-15);
  for (long k = 0; k < 1500; k++) { /* particles keep their numbers */
    double at[3];
    rows_place(g, g->particle_site[k], at);
    for (int a = 0; a < 3; a++)
      assert_true(at[a] == p.at[a][k]);
    assert_int_equal(g->site_particle[g->particle_site[k]], k);
  }
  rows_free(g);
  points_free(&p);
  free(measure);
}

/* The radius of a disc, or a sphere, that holds the particle and k more: of area pi R^2 = (k + 1)
   A. */
static void horizon_holds_the_neighbours(void **state) {
  (void)state;
  test_points p = points_drawn(2, 300, (const double[3]){1, 1, 1}, 9);
  double measure[300];
  for (long k = 0; k < 300; k++)
    measure[k] = k % 2 ? 0.5e-2 : 1.5e-2;
  rows *g = list_of(&p, measure, 0, 12);
  assert_true(fabs(acos(-1) * g->horizon * g->horizon - 13e-2) < 1e-14);
  rows_free(g);
  g = list_of(&p, measure, 0.09, 0);
  assert_true(g->horizon == 0.09);
  rows_free(g);
  points_free(&p);
}

static void crowds_and_loners(void **state) {
  (void)state;
  test_points p = points_drawn(2, 200, (const double[3]){1, 1, 1}, 9);
  double measure[200];
  for (long k = 0; k < 200; k++)
    measure[k] = 1;
  long crowded;
  scattered from = {.points = p.cloud,
                    .measure = measure,
                    .spacing = 1,
                    .horizon = 10,
                    .stiffness_thickness = 1,
                    .mass_thickness = 1};
  assert_null(scattered_rows(&from, &crowded));
  assert_true(crowded >= 0 && crowded < 200);
  from.horizon = 1e-6;
  rows *g = scattered_rows(&from, &crowded);
  check_list(g);
  assert_int_equal(g->bond_count, 0);
  rows_free(g);
  points_free(&p);
}

static bool joins(const rows_bond *b, int32_t i, int32_t j) {
  return (b->i == i && b->j == j) || (b->i == j && b->j == i);
}

/* In any order, from either end. Of a bar, volumes are as given. */
static void bonds_may_be_given(void **state) {
  (void)state;
  test_points p = points_drawn(2, 60, (const double[3]){1, 1, 1}, 5);
  double measure[60];
  point_pair pairs[60 * 59 / 2];
  for (long k = 0; k < 60; k++)
    measure[k] = 1 + 0.01 * (double)k;
  long crowded, count = 0;
  scattered from = {.points = p.cloud,
                    .measure = measure,
                    .spacing = 1,
                    .horizon = 0.25,
                    .stiffness_thickness = 2,
                    .mass_thickness = 3};
  rows *found = scattered_rows(&from, &crowded);
  rows_bond *bonds = rows_bonds(found);
  for (long k = found->bond_count - 1; k >= 0; k--)
    pairs[count++] = (point_pair){bonds[k].j, bonds[k].i};
  from.horizon = 0;
  from.bonds = pairs;
  from.bond_count = count;
  rows *given = scattered_rows(&from, &crowded);
  check_list(given);
  assert_int_equal(given->bond_count, found->bond_count);
  rows_bond *same = rows_bonds(given);
  for (long k = 0; k < found->bond_count; k++) {
    long n = 0;
    while (n < count && !joins(&same[n], bonds[k].i, bonds[k].j))
      n++;
    assert_true(n < count);
    assert_true(given->list->length[same[n].slot] == found->list->length[bonds[k].slot]);
  }
  free(same);
  assert_true(given->horizon <= found->horizon && given->horizon > 0.2);
  rows_free(given);
  from.area = 4;
  given = scattered_rows(&from, &crowded);
  assert_true(given->area == 4 && given->site_area == 0 && given->stiffness_thickness == 0);
  assert_true(given->site_volume[given->particle_site[7]] == measure[7]);
  rows_free(given);
  rows_free(found);
  free(bonds);
  points_free(&p);
}

/* Bonds across a slit go, on both sides, and no other. */
static void slits_cut(void **state) {
  (void)state;
  rows *g = shaken_list(20, 20, 0.2, 12, NULL);
  deck_shape slit = {.kind = SHAPE_SEGMENT};
  const double x = 8.4 * spacing, top = 9.1 * spacing;
  slit.from[0] = slit.to[0] = x;
  slit.from[1] = -spacing;
  slit.to[1] = top;
  long crossing = 0, cut = 0, before = g->bond_count;
  for (long p = 0; p < g->particle_count; p++)
    for (int k = 0; k < g->directions; k++) {
      const long a = g->particle_site[p], b = rows_partner(g, a, k);
      if (!rows_has_bond(g, a, k) || (g->x[a] - x) * (g->x[b] - x) > 0) continue;
      const double part = (x - g->x[a]) / (g->x[b] - g->x[a]);
      crossing += g->y[a] + part * (g->y[b] - g->y[a]) < top;
    }
  for (long p = 0; p < g->particle_count; p++)
    cut += rows_cut(g, g->particle_site[p], &slit);
  rows_count_bonds(g);
  assert_true(crossing > 20);
  assert_int_equal(cut, crossing);
  assert_int_equal(g->bond_count, before - cut);
  long sides = 0;
  for (long q = 0; q < g->size; q++)
    sides += rows_degree(g, q);
  assert_int_equal(sides, 2 * g->bond_count);
  rows_free(g);
}

static void protection_reaches_as_far(void **state) {
  (void)state;
  rows *g = shaken_list(40, 40, 0.3, 12, NULL);
  const int32_t chosen[] = {7, 800, 801};
  const double radius = 3.3 * spacing;
  rows_protect(g, chosen, 3, radius);
  for (long p = 0; p < g->particle_count; p++) {
    const long q = g->particle_site[p];
    double nearest = INFINITY;
    for (int c = 0; c < 3; c++) {
      const long o = g->particle_site[chosen[c]];
      nearest = fmin(nearest, hypot(g->x[q] - g->x[o], g->y[q] - g->y[o]));
    }
    assert_int_equal(g->held[q], nearest <= radius);
  }
  for (long p = 0; p < g->particle_count; p++)
    for (int k = 0; k < g->directions; k++) {
      const long q = g->particle_site[p];
      if (!rows_has_bond(g, q, k)) continue;
      const bool near = g->held[q] || g->held[rows_partner(g, q, k)];
      assert_int_equal(g->held_bonds[q] >> k & 1, near);
    }
  rows_free(g);
}

/* --- sweeps ----------------------------------------------------------------------------------- */

static void assert_same(const marching *a, const marching *b, const int32_t *numbers,
                        double tolerance) {
  double most = 0, worst = 0;
  for (long p = 0; p < a->rows->particle_count; p++) {
    const long here = a->rows->particle_site[p];
    const long there = b->rows->particle_site[numbers ? numbers[p] : p];
    for (int d = 0; d < 2; d++) {
      const double u = a->w->body->displacement[d][here];
      most = fmax(most, fabs(u));
      worst = fmax(worst, fabs(u - b->w->body->displacement[d][there]));
    }
    assert_true(fabs(a->w->field[0][here] - b->w->field[0][there]) <= tolerance);
  }
  assert_true(most > 1e-6);
  assert_true(worst <= tolerance * most);
}

/* Damage, dampers, mass damping, gravity: all in the same way on a lattice and on a list. */
static void a_lattice_as_a_list(void **state) {
  (void)state;
  marching one = body_of(lattice_disc(0.07), 1e-8, 8e-4);
  marching two = body_of(as_list(one.rows), 1e-8, 8e-4);
  assert_int_equal(one.rows->bond_count, two.rows->bond_count);
  marching *both[] = {&one, &two};
  body_totals sum[2];
  for (int k = 0; k < 2; k++) {
    sweep *w;
    set_going(both[k], 2);
    w = both[k]->w;
    shake(both[k], NULL, 5);
    body_add_gravity(w->body);
    w->body->decay = 0.999;
    w->body->gravity[1] = -1e-4 / w->body->time_step;
    w->body->gravity_work[1] = w->body->mass[1] * w->body->time_step * w->body->gravity[1];
    go(both[k], 200);
    sweep_observe(w);
    sum[k] = body_sum(w->body);
  }
  assert_same(&one, &two, NULL, 1e-9);
  assert_true(sum[0].kinetic > 0 && sum[0].stored > 0 && sum[0].dissipated > 0);
  assert_true(fabs(sum[1].kinetic - sum[0].kinetic) <= 1e-9 * sum[0].kinetic);
  assert_true(fabs(sum[1].stored - sum[0].stored) <= 1e-9 * sum[0].stored);
  assert_true(fabs(sum[1].internal - sum[0].internal) <= 1e-9 * fabs(sum[0].internal));
  assert_true(fabs(sum[1].dissipated - sum[0].dissipated) <= 1e-9 * sum[0].dissipated);
  assert_true(fabs(sum[1].gravity - sum[0].gravity) <= 1e-9 * fabs(sum[0].gravity));
  close_body(&one);
  close_body(&two);
}

static void momentum(const marching *b, double total[2], double *scale) {
  total[0] = total[1] = *scale = 0;
  for (long p = 0; p < b->rows->particle_count; p++)
    for (int a = 0; a < 2; a++) {
      const long q = b->rows->particle_site[p];
      const double value = b->rows->site_mass[q] * b->w->body->velocity[a][q];
      total[a] += value;
      *scale += fabs(value);
    }
}

/* Masses differ by three; what is kinetic is the sum of m v^2/2, half a step before and after. */
static void particles_have_masses_of_their_own(void **state) {
  (void)state;
  marching b = body_of(shaken_list(40, 40, 0.3, 12, NULL), 1e-8, 1e-4);
  double before[2], after[2], scale;
  set_going(&b, 2);
  shake(&b, NULL, 5);
  momentum(&b, before, &scale);
  go(&b, 200);
  momentum(&b, after, &scale);
  for (int a = 0; a < 2; a++)
    assert_true(fabs(after[a] - before[a]) <= 1e-12 * scale);
  sweep_observe(b.w);
  const double kinetic = body_sum(b.w->body).kinetic;
  double expected = 0, force[2], most = 0;
  for (long p = 0; p < b.rows->particle_count; p++) {
    const long q = b.rows->particle_site[p];
    for (int d = 0; d < 2; d++) {
      const double v = b.w->body->velocity[d][q], m = b.rows->site_mass[q];
      expected += 0.5 * m * v * (v + step / m * b.w->body->force[d][q]);
    }
  }
  assert_true(fabs(kinetic - expected) <= 1e-13 * expected);
  force[0] = force[1] = 0;
  for (long p = 0; p < b.rows->particle_count; p++)
    for (int d = 0; d < 2; d++) {
      force[d] += b.w->body->force[d][b.rows->particle_site[p]];
      most += fabs(b.w->body->force[d][b.rows->particle_site[p]]);
    }
  assert_true(fabs(force[0]) <= 1e-13 * most && fabs(force[1]) <= 1e-13 * most);
  close_body(&b);
}

/* Springs without damage: what moves and what is stored stays, to the order of the scheme. */
static void energy_stays(void **state) {
  (void)state;
  marching b = body_of(shaken_list(30, 30, 0.3, 12, NULL), 0, 1e30);
  set_going(&b, 2);
  shake(&b, NULL, 5);
  for (long q = 0; q < b.rows->size; q++)
    b.w->field[0][q] = 0;
  sweep_observe(b.w);
  const body_totals first = body_sum(b.w->body);
  go(&b, 300);
  sweep_observe(b.w);
  const body_totals last = body_sum(b.w->body);
  const double all = first.kinetic + first.stored;
  assert_true(fabs(last.kinetic - first.kinetic) > 1e-2 * all);
  assert_true(fabs(last.kinetic + last.stored - all) <= 2e-4 * all);
  assert_true(fabs(last.kinetic - first.kinetic + last.internal - first.internal) <= 1e-11 * all);
  close_body(&b);
}

/* Particles given in another order move alike, to the last bit. */
static void numbers_do_not_matter(void **state) {
  (void)state;
  int32_t *numbers = points_shuffle(40 * 31, 3);
  marching one = body_of(shaken_list(40, 31, 0.3, 12, NULL), 1e-8, 1e-4);
  marching two = body_of(shaken_list(40, 31, 0.3, 12, numbers), 1e-8, 1e-4);
  set_going(&one, 1);
  set_going(&two, 1);
  shake(&one, NULL, 5);
  shake(&two, numbers, 5);
  go(&one, 50);
  go(&two, 50);
  assert_same(&one, &two, numbers, 0);
  close_body(&one);
  close_body(&two);
  free(numbers);
}

static void threads_do_not_change_a_bit(void **state) {
  (void)state;
  marching one = body_of(shaken_list(60, 50, 0.3, 12, NULL), 1e-8, 1e-4);
  set_going(&one, 1);
  shake(&one, NULL, 5);
  go(&one, 40);
  for (int threads = 2; threads <= 3; threads++) {
    marching many = body_of(shaken_list(60, 50, 0.3, 12, NULL), 1e-8, 1e-4);
    set_going(&many, threads);
    assert_int_equal(many.w->body->block_count, threads);
    shake(&many, NULL, 5);
    go(&many, 40);
    assert_same(&one, &many, NULL, 0);
    const size_t site = (size_t)one.rows->size * sizeof(double);
    assert_memory_equal(one.w->body->velocity[1], many.w->body->velocity[1], site);
    assert_memory_equal(one.w->field[1], many.w->field[1], 2 * (size_t)one.rows->directions * site);
    close_body(&many);
  }
  close_body(&one);
}

/* --- shape matrices --------------------------------------------------------------------------- */

/* Displacements that are linear in place are fitted exactly where the bonds resolve all strains; */
static void strains_are_fitted(void **state) {
  (void)state;
  const double size = 1e-9;
  marching b = body_of(shaken_list(30, 30, 0.3, 12, NULL), 0, 1e30);
  const rows *g = b.rows;
  set_going(&b, 1);
  for (long q = 0; q < g->size; q++) {
    b.w->body->displacement[0][q] = size * (0.7 * g->x[q] + 0.4 * g->y[q]);
    b.w->body->displacement[1][q] = size * (-0.2 * g->x[q] - 0.3 * g->y[q]);
  }
  double *strain = must_calloc((size_t)g->size, sizeof *strain);
  sweep_observe(b.w);
  sweep_output(b.w, 2, strain);
  assert_int_equal(shape_unresolved(g, NULL), 0);
  for (long p = 0; p < g->particle_count; p++)
    assert_true(fabs(strain[g->particle_site[p]] - 0.7 * size) <= 1e-6 * size);
  free(strain);
  close_body(&b);
}

/* Eight on a line, and apart from them a hexagon with its centre. */
static void unresolved_families_are_counted(void **state) {
  (void)state;
  test_points p = points_new(2, 15);
  double measure[15], *matrix[PL_SHAPE_PLANES(2)];
  int32_t resolved[15];
  for (long k = 0; k < 15; k++) {
    const double angle = (double)k * acos(-1) / 3;
    measure[k] = 1;
    p.at[0][k] = k >= 7 ? spacing * (double)k : k < 6 ? spacing * cos(angle) : 0;
    p.at[1][k] = k >= 7 ? 5 * spacing : k < 6 ? spacing * sin(angle) : 0;
  }
  rows *g = list_of(&p, measure, 1.01 * spacing, 0);
  assert_int_equal(shape_unresolved(g, resolved), 8);
  for (int v = 0; v < PL_SHAPE_PLANES(2); v++)
    matrix[v] = must_calloc((size_t)g->size, sizeof(double));
  shape_matrices(g, matrix);
  for (long k = 0; k < 15; k++) {
    const long site = g->particle_site[k];
    assert_true(matrix[PL_SHAPE_VALUES(2)][site] == (k < 7) && resolved[k] == (k < 7));
    if (k < 8 || k == 14)
      continue; /* two bonds along x of a spacing each: 1/(2 s), and nothing else */
    assert_true(fabs(matrix[0][site] * 2 * spacing - 1) < 1e-12);
    for (int v = 1; v < PL_SHAPE_VALUES(2); v++)
      assert_true(fabs(matrix[v][site]) < 1e-12 / spacing);
  }
  for (int v = 0; v < PL_SHAPE_PLANES(2); v++)
    free(matrix[v]);
  rows_free(g);
  points_free(&p);
}

/* --- step ------------------------------------------------------------------------------------- */

/* A body of 60 spacings holds waves that are as fast as those of the infinite lattice, to (1/60)^2.
   */
static void step_is_that_of_the_lattice(void **state) {
  (void)state;
  for (int damped = 0; damped < 2; damped++) {
    marching one = body_of(lattice_disc(0.3), damped ? 2e-6 : 0, 1e30);
    marching two = body_of(as_list(one.rows), damped ? 2e-6 : 0, 1e30);
    step_limit lattice = {0}, list = {0};
    stability_limit(&one.law, one.parameters, NULL, one.rows, &lattice);
    stability_limit(&two.law, two.parameters, NULL, two.rows, &list);
    print_message("stable step: lattice %.6g s, list %.6g s; damping ratio %.4g, %.4g\n",
                  lattice.limit, list.limit, lattice.damping_ratio, list.damping_ratio);
    assert_true(fabs(list.omega_max / lattice.omega_max - 1) < 1e-3);
    assert_true(fabs(list.limit / lattice.limit - 1) < 1e-3);
    assert_true(fabs(list.damping_ratio - lattice.damping_ratio) < 1e-2);
    rows_free(one.rows);
    rows_free(two.rows);
  }
}

/* At the limit the energy stays bounded, a little above it grows beyond all bounds. */
static void step_is_the_largest(void **state) {
  (void)state;
  for (int k = 0; k < 2; k++) {
    marching b = body_of(shaken_list(16, 16, 0.3, 12, NULL), 0, 1e30);
    step_limit limit = {0};
    stability_limit(&b.law, b.parameters, NULL, b.rows, &limit);
    const double dt = limit.limit * (k ? 1.005 : 0.999);
    b.w = interaction_new(b.rows, &b.law, b.parameters, dt, 2, true, true);
    uint64_t seed = 5;
    for (long p = 0; p < b.rows->particle_count; p++)
      b.w->body->velocity[0][b.rows->particle_site[p]] = 1e-6 * (points_draw(&seed) - 0.5);
    double most = 0;
    for (int n = 0; n < 1000 && most < 1e-2; n++) {
      assert_true(sweep_step(b.w));
      for (long p = 0; n % 100 == 99 && p < b.rows->particle_count; p++)
        most = fmax(most, fabs(b.w->body->velocity[0][b.rows->particle_site[p]]));
    }
    assert_true(k ? most > 1e-3 : most < 1e-4);
    close_body(&b);
  }
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(lists_keep_their_promises),
      cmocka_unit_test(horizon_holds_the_neighbours),
      cmocka_unit_test(crowds_and_loners),
      cmocka_unit_test(bonds_may_be_given),
      cmocka_unit_test(slits_cut),
      cmocka_unit_test(protection_reaches_as_far),
      cmocka_unit_test(a_lattice_as_a_list),
      cmocka_unit_test(particles_have_masses_of_their_own),
      cmocka_unit_test(energy_stays),
      cmocka_unit_test(numbers_do_not_matter),
      cmocka_unit_test(threads_do_not_change_a_bit),
      cmocka_unit_test(strains_are_fitted),
      cmocka_unit_test(unresolved_families_are_counted),
      cmocka_unit_test(step_is_that_of_the_lattice),
      cmocka_unit_test(step_is_the_largest),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
