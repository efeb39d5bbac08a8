/* Links between a bar and the lattice around it, of beams by hand: forces of one bond against
   closed forms, what a free body keeps, energies, the same bits for any number of threads and after
   stops, the stable step, motion at the start, rest, and what is held where a link pulls. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "dsl/base/arena.h"
#include "runtime/deck/deck_read.h"
#include "runtime/interaction/sweep.h"
#include "runtime/parts/link_limit.h"
#include "runtime/parts/run_link.h"
#include "runtime/simulation/simulation_state.h"
#include "runtime/simulation/step_shrink.h"
#include "tests/runtime/hand_over.h"
#include "tests/runtime/rigid_motion.h"
#include "tests/runtime/same_runs.h"
#include "tests/runtime/small_run.h"

enum { MOST = 4 };
typedef struct linked_run {
  small_run run;
  pl_law on_rows, on_lists;
  double parameters[MOST][BEAM_PARAMETERS];
  simulation_law law[MOST];
} linked_run;

/* Materials stand in the order of lattices, bars and links. */
static void open_linked_in(linked_run *r, int dimensions, const char *text) {
  const deck *k;
  memset(r, 0, sizeof *r);
  r->on_rows = beams_in(dimensions, PL_ROWS);
  r->on_lists = beams_in(dimensions, PL_LIST);
  small_read(&r->run, text);
  k = r->run.deck;
  for (int n = 0; k && n < k->lattice_count; n++) {
    const pl_law *law = n == 0 ? &r->on_rows : &r->on_lists;
    assert_true(material_parameters(&k->materials[n], law, r->parameters[n], &r->run.said));
    r->law[n] = (simulation_law){.law = law, .parameters = r->parameters[n]};
  }
  if (k) r->run.simulation = simulation_new(k, r->law, &r->run.said);
  if (r->run.simulation) return;
  small_print(&r->run);
  fail_msg("%s", text);
}

static void open_linked(linked_run *r, const char *text) {
  open_linked_in(r, 2, text);
}

static void close_linked(linked_run *r) {
  small_close(&r->run);
}

static body *body_of(const linked_run *r, int lattice) {
  return simulation_state(r->run.simulation, lattice)->body;
}

/* --- one bond --------------------------------------------------------------------------------- */

enum { CONCRETE, BAR, LINK };
/* The link's bond joins the bar's first particle to the nearest one of the lattice. */
#define ONE_BOND                                                                                   \
  "&simulation end_time = 1e-3 /\n&output frames = 0 /\n"                                          \
  "&lattice name = 'c' kind = 'hexagonal' spacing = 0.02 thickness = 0.1 /\n"                      \
  "&body lattice = 'c' shape = 'rectangle' corner = 0, 0 size = 0.1, 0.04 /\n"                     \
  "&material lattice = 'c' model = 'm' /\n"                                                        \
  "&bar name = 'b' points = 0.043, 0.004, 0.083, 0.004 spacing = 0.02 area = 1e-4 /\n"             \
  "&material bar = 'b' model = 'm' /\n"                                                            \
  "&link name = 'l' bar = 'b' lattice = 'c' every = 3 within = 0.3 /\n"                            \
  "&material link = 'l' model = 'm' k_n = 7e6 k_s = 3e6 /\n"

typedef struct bond_ends {
  const run_link *link;
  int at[2];       /* particles of the link: of the bar, of the lattice */
  double chord[2]; /* m, from the first to the second */
  double length, e[2];
} bond_ends;

static bond_ends ends_of(const linked_run *r) {
  bond_ends b = {.link = &r->run.simulation->links[0]};
  const rows *g = b.link->own->lattice_rows;
  double at[2][3];
  assert_int_equal(r->run.simulation->link_count, 1);
  assert_int_equal(g->bond_count, 1);
  assert_int_equal(g->particle_count, 2);
  for (int p = 0; p < 2; p++)
    b.at[g->copies[p].lattice == CONCRETE] = p;
  for (int end = 0; end < 2; end++)
    rows_place(g, g->particle_site[b.at[end]], at[end]);
  for (int a = 0; a < 2; a++)
    b.chord[a] = at[1][a] - at[0][a];
  b.length = hypot(b.chord[0], b.chord[1]);
  for (int a = 0; a < 2; a++)
    b.e[a] = b.chord[a] / b.length;
  return b;
}

/* Its ends move so, and each feels `force`: N along x and y, N m. */
static void check_bond(double along, double across, double turn, const double expected[2][3]) {
  linked_run r;
  open_linked(&r, ONE_BOND);
  const bond_ends b = ends_of(&r);
  const sweep *law = b.link->own->laws[0].state;
  const link_copy *bar = &b.link->copies[b.at[0]], *of = &b.link->copies[b.at[1]];
  const rows *g = b.link->own->lattice_rows;
  assert_true(fabs(b.length - 5e-3) < 1e-12);
  body *moved = body_of(&r, CONCRETE), *turned = body_of(&r, BAR);
  assert_true(of->of == moved && bar->of == turned);
  moved->displacement[0][of->site[0]] = along * b.e[0] - across * b.e[1];
  moved->displacement[1][of->site[0]] = along * b.e[1] + across * b.e[0];
  turned->displacement[2][bar->site[0]] = turn;
  run_link_begin(&r.run.simulation->links[0]);
  for (int end = 0; end < 2; end++) {
    const long q = g->particle_site[b.at[end]];
    const double f[3] = {law->force[0][q] * b.e[0] + law->force[1][q] * b.e[1],
                         law->force[1][q] * b.e[0] - law->force[0][q] * b.e[1],
                         law->force[2][q] / b.length};
    for (int d = 0; d < 3; d++)
      if (!(fabs(f[d] - expected[end][d]) < 2e-6)) /* of N; the second order of ways of 1e-9 m */
        fail_msg("end %d: %.12g, not %.12g, in %d", end, f[d], expected[end][d], d);
  }
  close_linked(&r);
}

/* A beam of length d with EI = k_s d^3/12: 12 EI/d^3 across, 6 EI/d^2, 4 EI/d, 2 EI/d by turns; all
   as forces, moments over d. */
static void a_link_is_a_beam(void **state) {
  (void)state;
  const double k_n = 7e6, k_s = 3e6, way = 1e-7, turn = 1e-5, d = 5e-3;
  check_bond(way, 0, 0, (const double[2][3]){{k_n * way, 0, 0}, {-k_n * way, 0, 0}});
  check_bond(0, way, 0,
             (const double[2][3]){{0, k_s * way, k_s * way / 2}, {0, -k_s * way, k_s * way / 2}});
  const double f = k_s * d * turn / 2;
  check_bond(0, 0, turn, (const double[2][3]){{0, -f, -2 * f / 3}, {0, f, -f / 3}});
}

/* --- a free body with a bar ------------------------------------------------------------------- */

#define CONCRETE_AND_BAR(points)                                                                   \
  "&lattice name = 'c' kind = 'hexagonal' spacing = 0.02 thickness = 0.1 /\n"                      \
  "&body lattice = 'c' shape = 'rectangle' corner = -0.1, -0.05 size = 0.2, 0.1 /\n"               \
  "&material lattice = 'c' model = 'm' /\n"                                                        \
  "&bar name = 'b' points = " points " spacing = 0.017 area = 1e-4 /\n"                            \
  "&material bar = 'b' model = 'm' k_n = 2e7 k_s = 3e6 rho = 7850 /\n"
#define LINKED                                                                                     \
  "&link name = 'l' bar = 'b' lattice = 'c' every = 2 first = 1 /\n"                               \
  "&material link = 'l' model = 'm' k_n = 4e6 k_s = 2e6 /\n"
#define ONE_WAY   "-0.087, -0.013, 0.085, 0.021"
#define OTHER_WAY "0.085, 0.021, -0.087, -0.013"

static void open_free(linked_run *r, const char *points, double safety, const char *more) {
  char text[4096];
  snprintf(text, sizeof text,
           "&simulation end_time = 5e-4 step_safety = %g /\n&output frames = 0 sample = 1e-6 /\n%s"
           "%s%s",
           safety,
           strcmp(points, ONE_WAY) == 0 ? CONCRETE_AND_BAR(ONE_WAY) : CONCRETE_AND_BAR(OTHER_WAY),
           LINKED, more);
  open_linked(r, text);
}

/* Of all that has a mass; a link has none. */
static momenta all_momenta(const linked_run *r) {
  momenta sum = momenta_of(body_of(r, CONCRETE));
  const momenta bar = momenta_of(body_of(r, BAR));
  for (int k = 0; k < 3; k++) {
    sum.linear[k] += bar.linear[k];
    sum.angular[k] += bar.angular[k];
  }
  return sum;
}

#define FREE_IN_SPACE                                                                              \
  "&simulation end_time = 5e-4 step_safety = 0.5 /\n&output frames = 0 sample = 1e-6 /\n"          \
  "&lattice name = 'c' kind = 'fcc' spacing = 0.02 origin = 3*0 /\n"                               \
  "&body lattice = 'c' shape = 'box' corner = -0.06, -0.03, -0.03 size = 0.12, 0.06, 0.06 /\n"     \
  "&material lattice = 'c' model = 'm' /\n"                                                        \
  "&bar name = 'b' points = -0.05, -0.013, 0.004, 0.045, 0.011, 0.017 spacing = 0.017 "            \
  "area = 1e-4 /\n"                                                                                \
  "&material bar = 'b' model = 'm' k_n = 2e7 k_s = 3e6 rho = 7850 /\n"

/* Spinning, flying and breathing through large rotations. */
static void keeps_momenta(linked_run *r, double rate) {
  double furthest = 0;
  for (int b = CONCRETE; b <= BAR; b++)
    rigid_spin(body_of(r, b), rate, b == BAR ? 4 : 2, 0.1);
  const momenta before = all_momenta(r);
  for (int k = 0; k < 20; k++) {
    simulation_advance(r->run.simulation, 100, NULL);
    const momenta now = all_momenta(r);
    furthest = fmax(furthest, momenta_apart(&now, &before));
  }
  const body *bar = body_of(r, BAR);
  const double turned = bar->displacement[bar->dof - 1][bar->lattice->particle_site[0]];
  print_message("turned by %.2g, momenta %.1e off\n", turned, furthest);
  assert_true(fabs(turned) > 0.5 && furthest < 1e-12);
  close_linked(r);
}

static void a_free_body_keeps_its_momenta(void **state) {
  (void)state;
  linked_run r;
  open_free(&r, ONE_WAY, 0.5, "");
  keeps_momenta(&r, 3000);
  open_linked_in(&r, 3, FREE_IN_SPACE LINKED);
  keeps_momenta(&r, 3000);
}

static void turns_without_force(linked_run *r) {
  for (int b = CONCRETE; b <= BAR; b++)
    rigid_turn(body_of(r, b), 0.9, 0.3);
  run_link *link = &r->run.simulation->links[0];
  run_link_begin(link);
  const sweep *law = link->own->laws[0].state;
  const double rigidity = 4e6 * link->own->lattice_rows->spacing;
  double most = 0;
  for (int d = 0; d < law->body->dof; d++)
    for (long p = 0; p < law->lattice->particle_count; p++)
      most = fmax(most, fabs(law->force[d][law->lattice->particle_site[p]]));
  print_message("%.1e of the rigidity\n", most / rigidity);
  assert_true(most < 1e-12 * rigidity);
  close_linked(r);
}

static void a_rigid_turn_causes_no_force(void **state) {
  (void)state;
  linked_run r;
  open_free(&r, ONE_WAY, 0.5, "");
  turns_without_force(&r);
  open_linked_in(&r, 3, FREE_IN_SPACE LINKED);
  turns_without_force(&r);
}

/* --- energies --------------------------------------------------------------------------------- */

#define PULLED                                                                                     \
  "&region name = 'left' lattice = 'c' shape = 'rectangle' corner = -0.11, -1 size = 0.02, 2 /\n"  \
  "&region name = 'tip' lattice = 'b' shape = 'rectangle' corner = 0.084, -1 size = 1, 2 /\n"      \
  "&support region = 'left' fix = 'xy' /\n"                                                        \
  "&drive region = 'tip' component = 'x' velocity = %g rise = 2e-5 /\n"                            \
  "&monitor name = 'held' kind = 'reaction' region = 'left' component = 'x' /\n"                   \
  "&monitor name = 'pull' kind = 'reaction' region = 'tip' component = 'x' /\n"

/* External work of all is that of the bar's end alone: what links give one body they take from the
   other. */
static void energies_add_up(void **state) {
  (void)state;
  linked_run r;
  char pulled[2048];
  snprintf(pulled, sizeof pulled, PULLED, 1e-6);
  open_free(&r, ONE_WAY, 0.5, pulled);
  assert_int_equal(small_go(&r.run), STEP_END);
  const double work = small_largest(&r.run, "energy/external");
  const double *of[3] = {small_values(&r.run, "c/external"), small_values(&r.run, "b/external"),
                         small_values(&r.run, "l/external")},
               *sum = small_values(&r.run, "energy/external");
  for (long n = 0; n < simulation_history(r.run.simulation, NULL); n++)
    assert_true(of[0][n] + of[1][n] + of[2][n] == sum[n]);
  const double imbalance = small_largest(&r.run, "energy/imbalance"),
               own = small_largest(&r.run, "l/imbalance"),
               stored = small_largest(&r.run, "l/stored");
  print_message("imbalance %.1e of the work, of the link %.1e of what it stores\n",
                imbalance / work, own / stored);
  assert_true(work > 0 && stored > 1e-3 * work && small_last(&r.run, "c/stored") > 1e-3 * work);
  assert_true(imbalance < 1e-10 * work && own < 1e-9 * stored);
  assert_true(small_largest(&r.run, "l/kinetic") == 0);
  close_linked(&r);
}

/* Each with its own ledger. */
static void energies_add_up_over_a_shorter_step(void **state) {
  (void)state;
  linked_run r;
  char pulled[2048];
  snprintf(pulled, sizeof pulled, PULLED, 1e-6);
  open_free(&r, ONE_WAY, 0.5, pulled);
  simulation *s = r.run.simulation;
  simulation_advance(s, simulation_step_count(s) / 2, NULL);
  step_shrink_to(s, 2, STEP_STIFFER, 0);
  assert_int_equal(small_go(&r.run), STEP_END);
  const double work = small_largest(&r.run, "energy/external"),
               stored = small_largest(&r.run, "l/stored");
  print_message("imbalance %.1e of the work, of the link %.1e of what it stores\n",
                small_largest(&r.run, "energy/imbalance") / work,
                small_largest(&r.run, "l/imbalance") / stored);
  assert_true(small_largest(&r.run, "energy/imbalance") < 1e-10 * work);
  assert_true(small_largest(&r.run, "l/imbalance") < 1e-9 * stored);
  close_linked(&r);
}

/* Of large motions it is of the second order in the step. */
static void the_imbalance_falls_with_the_step(void **state) {
  (void)state;
  double imbalance[2];
  for (int k = 0; k < 2; k++) {
    linked_run r;
    char pulled[2048];
    snprintf(pulled, sizeof pulled, PULLED, 1e-3);
    open_free(&r, ONE_WAY, k ? 0.2 : 0.8, pulled);
    assert_int_equal(small_go(&r.run), STEP_END);
    imbalance[k] =
        small_largest(&r.run, "energy/imbalance") / small_largest(&r.run, "energy/external");
    close_linked(&r);
  }
  print_message("imbalance %.1e, with a quarter of the step %.1e\n", imbalance[0], imbalance[1]);
  assert_true(imbalance[0] < 1e-6 && imbalance[1] < imbalance[0] / 8);
}

/* --- the same bits ---------------------------------------------------------------------------- */

static void open_threads(linked_run *r, int threads) {
  char text[4096], pulled[2048];
  snprintf(pulled, sizeof pulled, PULLED, 5.0);
  snprintf(text, sizeof text,
           "&simulation end_time = 3e-4 threads = %d /\n&output frames = 0 sample = 1e-6 /\n"
           "&monitor name = 'N' kind = 'bar_force' lattice = 'b' average = 3e-6 /\n%s%s"
           "&damping rate = 2000 until = 1e-4 /\n%s",
           threads, CONCRETE_AND_BAR(ONE_WAY), LINKED, pulled);
  open_linked(r, text);
}

static void threads_and_stops_do_not_change_a_bit(void **state) {
  (void)state;
  linked_run straight;
  open_threads(&straight, 1);
  assert_int_equal(small_go(&straight.run), STEP_END);
  const long steps = simulation_step_count(straight.run.simulation);
  assert_true(small_largest(&straight.run, "l/stored") > 0);
  for (int threads = 2; threads <= 3; threads++) {
    linked_run whole, first, second, third;
    open_threads(&whole, threads);
    assert_int_equal(small_go(&whole.run), STEP_END);
    same_runs(straight.run.simulation, whole.run.simulation);
    open_threads(&first, threads);
    open_threads(&second, 1);
    open_threads(&third, threads);
    hand_over(first.run.simulation, steps / 4, second.run.simulation);
    hand_over(second.run.simulation, steps / threads, third.run.simulation);
    assert_int_equal(small_go(&third.run), STEP_END);
    same_runs(straight.run.simulation, third.run.simulation);
    close_linked(&whole);
    close_linked(&first);
    close_linked(&second);
    close_linked(&third);
  }
  close_linked(&straight);
}

/* The same particles of a bar that is given from its other end. */
static void which_end_a_bar_begins_with_is_no_matter(void **state) {
  (void)state;
  linked_run r[2];
  char pulled[2048];
  double most = 0, apart = 0;
  snprintf(pulled, sizeof pulled, PULLED, 0.1);
  for (int k = 0; k < 2; k++) {
    open_free(&r[k], k ? OTHER_WAY : ONE_WAY, 0.5, pulled);
    assert_int_equal(small_go(&r[k].run), STEP_END);
  }
  for (int b = CONCRETE; b <= BAR; b++) {
    const body *x = body_of(&r[0], b), *y = body_of(&r[1], b);
    const long count = x->lattice->particle_count;
    assert_int_equal(y->lattice->particle_count, count);
    for (int d = 0; d < 2; d++)
      for (long p = 0; p < count; p++) {
        const long other = b == BAR ? count - 1 - p : p;
        const double u = x->displacement[d][x->lattice->particle_site[p]],
                     v = y->displacement[d][y->lattice->particle_site[other]];
        most = fmax(most, fabs(u));
        apart = fmax(apart, fabs(u - v));
      }
  }
  print_message("%.1e of the motion apart\n", apart / most);
  assert_true(most > 0 && apart < 1e-12 * most);
  close_linked(&r[0]);
  close_linked(&r[1]);
}

/* --- the stable step -------------------------------------------------------------------------- */

/* Energy after so many steps of `factor` times the stable one, over that at the start. */
static double growth(const char *more, double factor, long steps, double *limit) {
  linked_run r;
  char text[4096];
  snprintf(text, sizeof text, "&simulation end_time = 10 /\n&output frames = 0 /\n%s%s%s",
           CONCRETE_AND_BAR(ONE_WAY), LINKED, more);
  open_linked(&r, text);
  *limit = simulation_step_limit(r.run.simulation)->limit;
  double before = 0, after = 0;
  unsigned seed = 7;
  for (int n = 0; n < r.run.deck->lattice_count; n++) {
    body *b = body_of(&r, n);
    b->time_step = factor * *limit;
    for (long p = 0; p < b->lattice->particle_count; p++)
      for (int d = 0; d < b->dof && !b->lattice->copies; d++) {
        double *v = &b->velocity[d][b->lattice->particle_site[p]];
        seed = seed * 1103515245u + 12345u;
        *v = 1e-6 * (seed >> 16) / 65536.0 * (d == 2 ? 100 : 1);
        before += body_mass(b, d, b->lattice->particle_site[p]) * *v * *v;
      }
  }
  simulation_advance(r.run.simulation, steps, NULL);
  for (int n = 0; n < r.run.deck->lattice_count; n++) {
    const body *b = body_of(&r, n);
    for (long p = 0; p < b->lattice->particle_count; p++)
      for (int d = 0; d < b->dof && !b->lattice->copies; d++) {
        const double v = b->velocity[d][b->lattice->particle_site[p]];
        after += body_mass(b, d, b->lattice->particle_site[p]) * v * v;
      }
  }
  close_linked(&r);
  return after / before;
}

#define STIFF                                                                                      \
  "&link name = 'stiff' bar = 'b' lattice = 'c' within = 0.9 every = 4 %s /\n"                     \
  "&material link = 'stiff' model = 'm' k_n = 3e7 k_s = 1e7 %s /\n"

static void the_step_of_joined_bodies_is_safe(void **state) {
  (void)state;
  static const struct {
    const char *keys, *values;
  } cases[] = {{"first = 1", ""}, {"", ""}, {"first = 1", "tau = 2e-6"}};
  for (int k = 0; k < 3; k++) {
    char more[512];
    double limit;
    snprintf(more, sizeof more, STIFF, cases[k].keys, cases[k].values);
    const double kept = growth(more, 0.999, 10000, &limit);
    const double wild = growth(more, 1.5, 2000, &limit);
    print_message("step %.4g us: kept %.2g, above %.2g\n", 1e6 * limit, kept, wild);
    assert_true(kept < 3);
    assert_true(!(wild < 1e6));
  }
}

/* Stiffnesses of links on the same particles add up, those of others do not. */
static void only_links_that_share_particles_add_up(void **state) {
  (void)state;
#define AT_ENDS(a, b)                                                                              \
  "&link name = 'l' bar = 'b' lattice = 'c' every = 9 first = " #a " within = 0.9 /\n"             \
  "&material link = 'l' model = 'm' k_n = 3e7 k_s = 1e7 /\n"                                       \
  "&link name = 'm' bar = 'b' lattice = 'c' every = 9 first = " #b " within = 0.9 /\n"             \
  "&material link = 'm' model = 'm' k_n = 3e7 k_s = 1e7 /\n"
  static const char *const links[] = {AT_ENDS(2, 7), AT_ENDS(2, 2), AT_ENDS(7, 7)};
  double limit[3];
  for (int k = 0; k < 3; k++) {
    linked_run r;
    char text[4096];
    snprintf(text, sizeof text, "&simulation end_time = 10 /\n&output frames = 0 /\n%s%s",
             CONCRETE_AND_BAR(ONE_WAY), links[k]);
    open_linked(&r, text);
    limit[k] = simulation_step_limit(r.run.simulation)->limit;
    close_linked(&r);
  }
  print_message("steps %.4g, %.4g, %.4g us\n", 1e6 * limit[0], 1e6 * limit[1], 1e6 * limit[2]);
  assert_true(limit[0] > 1.05 * fmin(limit[1], limit[2]));
}

/* --- at the start ----------------------------------------------------------------------------- */

/* Links that are strained at the start pull from the first step on: the error is of the second
   order in the step. */
static void a_bar_that_begins_beside_its_place(void **state) {
  (void)state;
  enum { STEPS = 100, RUNS = 3 };
  double way[RUNS];
  for (int k = 0; k < RUNS; k++) {
    linked_run r;
    char text[4096];
    snprintf(text, sizeof text,
             "&simulation end_time = 2e-5 step = %.17g /\n&output frames = 0 sample = 1e-6 /\n"
             "%s%s&region name = 'all' lattice = 'b' shape = 'rectangle' corner = -1, -1 size = 2, "
             "2 /\n&initial_displacement region = 'all' component = 'x' value = 1e-7 /\n"
             "&monitor name = 'way' kind = 'displacement' region = 'all' component = 'x' /\n",
             2e-5 / (STEPS << (k == 2 ? 5 : k)), CONCRETE_AND_BAR(ONE_WAY), LINKED);
    open_linked(&r, text);
    assert_int_equal(small_go(&r.run), STEP_END);
    way[k] = small_last(&r.run, "way");
    assert_true(small_last(&r.run, "energy/kinetic") > 0);
    close_linked(&r);
  }
  const double error[2] = {fabs(way[0] - way[2]), fabs(way[1] - way[2])};
  print_message("errors %.2e and %.2e of the way\n", error[0] / way[2], error[1] / way[2]);
  assert_true(error[0] < 0.1 * fabs(way[2]));
  assert_true(error[0] > 3.7 * error[1] && error[0] < 4.5 * error[1]);
}

/* --- what is held, and rest ------------------------------------------------------------------- */

/* All particles are held or driven: what holds the lattice is what drives the bar, and both are the
   forces of the link. */
static void reactions_count_links(void **state) {
  (void)state;
  linked_run r;
  open_free(&r, ONE_WAY, 0.5,
            "&region name = 'concrete' lattice = 'c' shape = 'rectangle' corner = -1, -1 size = 2, "
            "2 /\n&region name = 'bar' lattice = 'b' shape = 'rectangle' corner = -1, -1 size = 2, "
            "2 /\n&support region = 'concrete' fix = 'xy', 'rotation' /\n"
            "&support region = 'bar' fix = 'y', 'rotation' /\n"
            "&drive region = 'bar' component = 'x' velocity = 1e-3 /\n"
            "&monitor name = 'held' kind = 'reaction' region = 'concrete' component = 'x' /\n"
            "&monitor name = 'pull' kind = 'reaction' region = 'bar' component = 'x' /\n"
            "&monitor name = 'way' kind = 'displacement' region = 'bar' component = 'x' /\n");
  assert_int_equal(small_go(&r.run), STEP_END);
  const double *held = small_values(&r.run, "held"), *pull = small_values(&r.run, "pull");
  const long end = simulation_history(r.run.simulation, NULL) - 1;
  for (long n = 0; n <= end; n++)
    assert_true(fabs(held[n] + pull[n]) < 1e-11 * pull[end]);
  const double stored = 0.5 * pull[end] * small_last(&r.run, "way");
  print_message("pull %.4g N, stored %.4g J\n", pull[end], stored);
  assert_true(pull[end] > 0.1);
  assert_true(fabs(small_last(&r.run, "l/stored") / stored - 1) < 1e-6);
  assert_true(fabs(small_last(&r.run, "l/external") / stored - 1) < 1e-6);
  assert_true(
      fabs((small_last(&r.run, "energy/external") - small_last(&r.run, "energy/kinetic")) / stored -
           1) < 1e-6);
  close_linked(&r);
}

/* Springs in a row: that of the bar, then that of the link. */
static void a_quasi_static_run_comes_to_the_balance_of_springs(void **state) {
  (void)state;
  linked_run r;
  open_linked(&r, "&simulation end_time = 1 /\n&relaxation increments = 2 tolerance = 1e-8 /\n"
                  "&lattice name = 'c' kind = 'hexagonal' spacing = 0.02 thickness = 0.1 /\n"
                  "&body lattice = 'c' shape = 'rectangle' corner = 0, 0 size = 0.041, 0.04 /\n"
                  "&material lattice = 'c' model = 'm' /\n"
                  "&bar name = 'b' points = 0.045, 0, 0.065, 0 spacing = 0.02 area = 1e-4 /\n"
                  "&material bar = 'b' model = 'm' /\n"
                  "&link name = 'l' bar = 'b' lattice = 'c' every = 2 within = 0.3 /\n"
                  "&material link = 'l' model = 'm' k_n = 7e6 k_s = 3e6 /\n"
                  "&region name = 'all' lattice = 'c' shape = 'rectangle' corner = -1, -1 size = "
                  "2, 2 /\n&region name = 'end' lattice = 'b' shape = 'point' at = 0.065, 0 /\n"
                  "&support region = 'all' fix = 'xy', 'rotation' /\n"
                  "&force region = 'end' component = 'x' total = 0.1 /\n"
                  "&monitor name = 'held' kind = 'reaction' region = 'all' component = 'x' /\n"
                  "&monitor name = 'way' kind = 'displacement' region = 'end' component = 'x' /\n"
                  "&output frames = 0 /\n");
  assert_int_equal(small_go(&r.run), STEP_END);
  long unbalanced;
  assert_int_equal(simulation_increments(r.run.simulation, &unbalanced), 2);
  print_message("%ld unbalanced, %ld steps\n", unbalanced, simulation_step_done(r.run.simulation));
  assert_int_equal(unbalanced, 0);
  for (int k = 0; k <= 2; k++) {
    const double force = 0.05 * k, way = force / 7e6 + force / 5e6;
    assert_true(fabs(small_values(&r.run, "held")[k] + force) < 1e-6);
    assert_true(fabs(small_values(&r.run, "way")[k] - way) < 1e-6 * 0.1 / 7e6);
  }
  close_linked(&r);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(a_link_is_a_beam),
      cmocka_unit_test(a_free_body_keeps_its_momenta),
      cmocka_unit_test(a_rigid_turn_causes_no_force),
      cmocka_unit_test(energies_add_up),
      cmocka_unit_test(energies_add_up_over_a_shorter_step),
      cmocka_unit_test(the_imbalance_falls_with_the_step),
      cmocka_unit_test(threads_and_stops_do_not_change_a_bit),
      cmocka_unit_test(which_end_a_bar_begins_with_is_no_matter),
      cmocka_unit_test(the_step_of_joined_bodies_is_safe),
      cmocka_unit_test(only_links_that_share_particles_add_up),
      cmocka_unit_test(a_bar_that_begins_beside_its_place),
      cmocka_unit_test(reactions_count_links),
      cmocka_unit_test(a_quasi_static_run_comes_to_the_balance_of_springs),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
