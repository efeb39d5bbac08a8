/* Lowest frequencies and shapes of bodies by hand: against all eigenvalues of a dense matrix of
   differences, closed forms of bars and beams, rigid motions, and what a run then does. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "dsl/base/arena.h"
#include "runtime/interaction/sweep.h"
#include "runtime/simulation/modes.h"
#include "runtime/simulation/simulation_state.h"
#include "tests/runtime/beam_law.h"
#include "tests/runtime/family_law.h"
#include "tests/runtime/small_run.h"

/* LAPACK: eigenvalues of a symmetric matrix, ascending. */
void dsyev_(const char *job, const char *part, const int *n, double *a, const int *leading,
            double *values, double *work, const int *room, int *info, size_t job_length,
            size_t part_length);

enum { LAWS = 4 };
typedef struct many_run {
  small_run run;
  double parameters[LAWS][16];
  simulation_law law[LAWS];
} many_run;

/* Of each interaction of the deck its law. */
static void open_many(many_run *r, const pl_law *const *laws, const char *text) {
  memset(r, 0, sizeof *r);
  small_read(&r->run, text);
  const deck *k = r->run.deck;
  for (int n = 0; k && n < k->interaction_count; n++) {
    assert_true(
        material_parameters(k->interactions[n].material, laws[n], r->parameters[n], &r->run.said));
    r->law[n] = (simulation_law){.law = laws[n], .parameters = r->parameters[n]};
  }
  if (k) r->run.simulation = simulation_new(k, r->law, &r->run.said);
  if (r->run.simulation) return;
  small_print(&r->run);
  fail_msg("%s", text);
}

/* --- all eigenvalues -------------------------------------------------------------------------- */

typedef struct dense {
  simulation *s;
  int order, body[2000], component[2000];
  long site[2000];
  double *matrix, *values;
} dense;

static bool is_held(const run_body *b, int component, long site) {
  for (long i = 0; i < b->loads->constraint_count; i++)
    if (b->loads->constraints[i].component == component && b->loads->constraints[i].site == site)
      return true;
  return false;
}

static double *force_on(const dense *m, double *sum) {
  for (int k = 0; k < m->s->body_count; k++)
    if (!run_body_is_link(&m->s->bodies[k])) sweep_find_forces(m->s->bodies[k].state);
  for (int k = 0; k < m->s->link_count; k++) {
    m->s->links[k].known = false;
    run_link_begin(&m->s->links[k]);
  }
  for (int i = 0; i < m->order; i++) {
    const run_body *b = &m->s->bodies[m->body[i]];
    sum[i] = b->body->force[m->component[i]][m->site[i]];
    for (long n = 0; n < b->loads->force_count; n++) {
      const applied *f = &b->loads->forces[n];
      if (f->link && f->component == m->component[i] && f->site == m->site[i])
        sum[i] += f->share * *f->link;
    }
  }
  return sum;
}

static void number(dense *m) {
  for (int b = 0; b < m->s->body_count; b++) {
    const run_body *of = &m->s->bodies[b];
    for (long p = 0; p < run_body_particles(of); p++)
      for (int d = 0; d < of->body->dof; d++) {
        if (is_held(of, d, of->lattice_rows->particle_site[p])) continue;
        assert_true(m->order < 2000);
        m->body[m->order] = b;
        m->component[m->order] = d;
        m->site[m->order++] = of->lattice_rows->particle_site[p];
      }
  }
}

static double mass_of(const dense *m, int i) {
  return body_mass(m->s->bodies[m->body[i]].body, m->component[i], m->site[i]);
}

/* Column by column, with no knowledge of who feels whom. */
static void open_dense(dense *m, simulation *s) {
  *m = (dense){.s = s};
  number(m);
  const size_t n = (size_t)m->order;
  const double h = 1e-7 * s->bodies[0].lattice_rows->spacing;
  double *plus = must_alloc(n * sizeof *plus), *minus = must_alloc(n * sizeof *minus);
  m->matrix = must_alloc(n * n * sizeof *m->matrix);
  m->values = must_alloc(n * sizeof *m->values);
  for (int c = 0; c < m->order; c++) {
    double *at = &s->bodies[m->body[c]].body->displacement[m->component[c]][m->site[c]];
    *at = h;
    force_on(m, plus);
    *at = -h;
    force_on(m, minus);
    *at = 0;
    for (int r = 0; r < m->order; r++)
      m->matrix[(size_t)c * n + (size_t)r] =
          (minus[r] - plus[r]) / (2 * h) / sqrt(mass_of(m, r) * mass_of(m, c));
  }
  free(plus);
  free(minus);
  const int room = 64 * m->order;
  int info;
  double *work = must_alloc((size_t)room * sizeof *work);
  dsyev_("N", "U", &m->order, m->matrix, &m->order, m->values, work, &room, &info, 1, 1);
  assert_int_equal(info, 0);
  free(work);
}

static void close_dense(dense *m) {
  free(m->matrix);
  free(m->values);
}

/* Shapes are at right angles by the masses, each of 1 kg. */
static void are_normal(const dense *all, const mode *modes, int count) {
  for (int k = 0; k < count; k++)
    for (int l = 0; l <= k; l++) {
      double sum = 0;
      for (int i = 0; i < all->order; i++) {
        const int b = all->body[i];
        const long at = all->component[i] * all->s->bodies[b].lattice_rows->size + all->site[i];
        sum += mass_of(all, i) * modes[k].shape[b][at] * modes[l].shape[b][at];
      }
      if (!(fabs(sum - (k == l)) < 1e-9)) fail_msg("modes %d and %d: %g", k + 1, l + 1, sum);
    }
}

/* The lowest `most` of the run against the dense matrix, of which `rigid` are 0. */
static void agree(many_run *r, int most, int rigid) {
  mode modes[MODES_MOST];
  mode_count count;
  dense all;
  open_dense(&all, r->run.simulation);
  const char *why = modes_find(r->run.simulation, most, modes, &count);
  if (why) fail_msg("%s", why);
  assert_int_equal(count.freedoms, all.order);
  assert_int_equal(count.rigid, rigid);
  assert_int_equal(count.found, most);
  const double last = sqrt(all.values[all.order - 1]),
               limit = simulation_step_limit(r->run.simulation)->omega_max;
  if (!(limit > last * (1 - 1e-9))) fail_msg("the step goes by %g, not %g", limit, last);
  for (int k = 0; k < most; k++) {
    const double omega = sqrt(all.values[rigid + k]);
    if (!(fabs(modes[k].omega / omega - 1) < 6e-6))
      fail_msg("mode %d: %.9g, %.9g by the dense matrix", k + 1, modes[k].omega, omega);
    assert_true(modes[k].residual < 1e-6);
  }
  are_normal(&all, modes, most);
  modes_free(modes, most, simulation_bodies(r->run.simulation));
  close_dense(&all);
}

#define PLATE                                                                                      \
  "&simulation end_time = 1e-3 /\n&output frames = 0 /\n"                                          \
  "&lattice name = 'c' kind = 'hexagonal' spacing = 0.02 thickness = 0.1 /\n"                      \
  "&body lattice = 'c' shape = 'rectangle' corner = 0, 0 size = 0.2, 0.08 /\n"                     \
  "&material lattice = 'c' model = 'm' /\n"                                                        \
  "&region name = 'left' lattice = 'c' shape = 'rectangle' corner = -0.005, -1 size = 0.01, 2 /\n" \
  "&region name = 'end' lattice = 'c' shape = 'point' at = 0.2, 0 /\n"

static void a_held_plate_with_a_mass_has_the_modes_of_its_matrix(void **state) {
  (void)state;
  const pl_law *const beams[] = {&elastic_beam};
  many_run r;
  open_many(&r, beams,
            PLATE "&support region = 'left' fix = 'x', 'y' /\n"
                  "&point_mass region = 'end' mass = 3 inertia = 1e-3 /\n");
  agree(&r, 60, 0);
  small_close(&r.run);
}

static void a_free_plate_has_three_rigid_motions(void **state) {
  (void)state;
  const pl_law *const beams[] = {&elastic_beam};
  many_run r;
  open_many(&r, beams, PLATE);
  agree(&r, 20, 3);
  small_close(&r.run);
}

static void laws_of_families_reach_as_far_as_their_passes(void **state) {
  (void)state;
  const pl_law *const families[] = {&family_hexagon};
  many_run r;
  open_many(&r, families, PLATE "&support region = 'left' fix = 'x', 'y' /\n");
  agree(&r, 20, 0);
  small_close(&r.run);
}

/* A bar in the plate, that bonds of all sorts join: to sites, and to the place that it lies at. */
static void links_are_springs_like_others(void **state) {
  (void)state;
  const pl_law on_rows = beams_in(2, PL_ROWS), on_lists = beams_in(2, PL_LIST);
  const pl_law *const laws[] = {&on_rows, &on_lists, &on_lists};
  static const char *const joins[] = {"within = 1.1", "to = 'place'"};
  for (int k = 0; k < 2; k++) {
    char text[4000];
    many_run r;
    snprintf(text, sizeof text,
             PLATE
             "&support region = 'left' fix = 'x', 'y' /\n"
             "&bar name = 'b' points = 0.033, 0.004, 0.163, 0.054 spacing = 0.02 area = 1e-4 /\n"
             "&material bar = 'b' model = 'm' /\n"
             "&link name = 'l' bar = 'b' lattice = 'c' %s /\n"
             "&material link = 'l' model = 'm' k_n = 7e6 k_s = 3e6 /\n",
             joins[k]);
    open_many(&r, laws, text);
    assert_true(r.run.simulation->links[0].own->lattice_rows->bond_count > 5);
    agree(&r, 25, 0);
    small_close(&r.run);
  }
}

static void a_free_block_in_space_has_six_rigid_motions(void **state) {
  (void)state;
  const pl_law beams = beams_in(3, PL_ROWS);
  const pl_law *const laws[] = {&beams};
  many_run r;
  open_many(&r, laws,
            "&simulation end_time = 1e-3 /\n&output frames = 0 /\n"
            "&lattice name = 'c' kind = 'cubic' spacing = 0.02 shells = 2 /\n"
            "&body lattice = 'c' shape = 'box' corner = 0, 0, 0 size = 0.1, 0.05, 0.05 /\n"
            "&material lattice = 'c' model = 'm' /\n");
  agree(&r, 30, 6);
  small_close(&r.run);
}

/* --- closed forms ----------------------------------------------------------------------------- */

static double first_omega(small_run *r) {
  mode m;
  mode_count count;
  const char *why = modes_find(r->simulation, 1, &m, &count);
  if (why) fail_msg("%s", why);
  modes_free(&m, 1, simulation_bodies(r->simulation));
  return m.omega;
}

/* n springs and masses in a row, the first held: 2 sqrt(k/m) sin((1/2) pi/(2 n + 1)), that is a
   period of 4 L/c with L = (n + 1/2) s but for the third order. Across nothing resists. */
static void a_bar_swings_in_four_times_its_length_over_the_speed(void **state) {
  (void)state;
  enum { SPRINGS = 40 };
  small_run r;
  small_open(&r, &elastic_bar,
             "&simulation end_time = 1e-3 /\n&output frames = 0 /\n"
             "&lattice name = 'c' kind = 'hexagonal' spacing = 0.01 thickness = 0.1 /\n"
             "&body lattice = 'c' shape = 'rectangle' corner = 0, -0.001 size = 0.4, 0.002 /\n"
             "&material lattice = 'c' model = 'm' nu = 0.2 /\n"
             "&region name = 'left' shape = 'point' at = 0, 0 /\n"
             "&support region = 'left' fix = 'x' /\n");
  assert_non_null(r.simulation);
  const rows *w = simulation_rows(r.simulation, 0);
  assert_int_equal(w->particle_count, SPRINGS + 1);
  const double k = 30e9 * 0.1 / (sqrt(3) * 0.8), c = 0.01 * sqrt(k / w->mass),
               exact = 2 * sqrt(k / w->mass) * sin(0.5 * M_PI / (2 * SPRINGS + 1)),
               omega = first_omega(&r);
  assert_true(fabs(omega / exact - 1) < 6e-6);
  assert_true(fabs(2 * M_PI / omega / (4 * (SPRINGS + 0.5) * 0.01 / c) - 1) < 1e-3);
  small_close(&r);
}

/* A cantilever of that many rows of particles that rotate, sixteen times as long as deep, against
   Bernoulli's beam: (1.8751/L)^2 sqrt(EI/(rho A)), 1. The clamp holds particles at x = 0 and half
   a spacing further. */
static double bernoulli_of(int row_count) {
  const double depth = 0.1, s = depth / (row_count * sqrt(0.75)), dy = s * sqrt(0.75);
  const long along = lround(16 * depth / s);
  char text[2000];
  small_run r;
  snprintf(text, sizeof text,
           "&simulation end_time = 1e-2 /\n&output frames = 0 /\n"
           "&lattice name = 'c' kind = 'hexagonal' spacing = %.15g thickness = 0.1 /\n"
           "&body lattice = 'c' shape = 'rectangle' corner = %.15g, %.15g size = %.15g, %.15g /\n"
           "&material lattice = 'c' model = 'm' E = 30e9 nu = 0.2 rho = 2400 /\n"
           "&region name = 'left' shape = 'rectangle' corner = -1, -1 size = %.15g, 2 /\n"
           "&support region = 'left' fix = 'x', 'y', 'rotation' /\n",
           s, -0.1 * s, -dy / 2, ((double)along + 0.2) * s, depth, 1 + 0.6 * s);
  small_open(&r, &elastic_beam, text);
  if (!r.simulation) small_print(&r);
  assert_non_null(r.simulation);
  const double length = (double)along * s, root = 1.8751040687 / length;
  const double theory = root * root * sqrt(30e9 * depth * depth / 12 / 2400);
  const double omega = first_omega(&r);
  print_message("cantilever of %d rows, %ld particles: %.5f of Bernoulli's frequency\n", row_count,
                simulation_rows(r.simulation, 0)->particle_count, omega / theory);
  small_close(&r);
  return omega / theory;
}

static void a_cantilever_swings_like_a_beam(void **state) {
  (void)state;
  const double coarse = fabs(bernoulli_of(9) - 1), middle = fabs(bernoulli_of(18) - 1),
               fine = fabs(bernoulli_of(36) - 1);
  assert_true(middle < 0.6 * coarse);
  assert_true(fine < 0.6 * middle);
  assert_true(fine < 0.01);
}

/* --- what a run does -------------------------------------------------------------------------- */

#define SWINGING(end, damping)                                                                     \
  "&simulation end_time = " end " /\n&output frames = 0 /\n"                                       \
  "&lattice name = 'c' kind = 'hexagonal' spacing = 0.02 thickness = 0.1 /\n"                      \
  "&body lattice = 'c' shape = 'rectangle' corner = 0, 0 size = 0.4, 0.05 /\n"                     \
  "&material lattice = 'c' model = 'm' /\n"                                                        \
  "&region name = 'left' shape = 'rectangle' corner = -0.005, -1 size = 0.02, 2 /\n"               \
  "&support region = 'left' fix = 'x', 'y' /\n" damping

/* How much of the mode is in the present motion, by the first particle that it moves the most. */
static double part_of(simulation *s, const mode *m) {
  const body *b = simulation_state(s, 0)->body;
  double energy = 0, sum = 0;
  for (int d = 0; d < b->dof; d++)
    for (long p = 0; p < b->lattice->particle_count; p++) {
      const long q = b->lattice->particle_site[p];
      const double shape = m->shape[0][d * b->lattice->size + q];
      energy += body_mass(b, d, q) * shape * shape;
      sum += body_mass(b, d, q) * shape * b->displacement[d][q];
    }
  return sum / energy;
}

/* Begins in the second mode; what is left of it at the end, and the end's time. */
static double swing(small_run *r, int number, const char *text, mode *m, double *time) {
  static const double small = 1e-8; /* of a mode of 1 kg */
  mode modes[3];
  mode_count count;
  small_open(r, &elastic_beam, text);
  if (!r->simulation) small_print(r);
  assert_non_null(r->simulation);
  assert_null(modes_find(r->simulation, number, modes, &count));
  *m = modes[number - 1];
  body *b = simulation_state(r->simulation, 0)->body;
  for (int d = 0; d < b->dof; d++)
    for (long q = 0; q < b->lattice->size; q++)
      b->displacement[d][q] = small * m->shape[0][d * b->lattice->size + q];
  assert_int_equal(small_go(r), STEP_END);
  *time = simulation_time(r->simulation);
  const double part = part_of(r->simulation, m) / small;
  modes_free(modes, number, 1);
  return part;
}

/* After ten periods and a quarter a part e of the period is 20.5 pi e of the amplitude. */
static void a_body_begun_in_a_mode_swings_in_its_period(void **state) {
  (void)state;
  small_run r;
  mode m;
  double time, part = swing(&r, 1, SWINGING("'10.25 periods'", ""), &m, &time);
  assert_true(fabs(time * m.omega / (2 * M_PI) - 10.25) < 1e-3);
  assert_true(simulation_deck(r.simulation)->simulation.end_time == 10.25 * (2 * M_PI / m.omega));
  assert_true(fabs(part - cos(m.omega * time)) < 20.5 * M_PI * 1e-4);
  small_close(&r);
}

/* exp(-zeta omega t) (cos(omega' t) + zeta/root sin(omega' t)), omega' = omega root(1 - zeta^2) */
static void the_ratio_of_damping_is_that_of_theory(void **state) {
  (void)state;
  static const struct {
    int number;
    double zeta;
    const char *text;
  } cases[] = {{1, 0.2, SWINGING("'1.5 periods'", "&damping ratio = 0.2 /\n")},
               {2, 0.05, SWINGING("'1 period'", "&damping ratio = 0.05 mode = 2 /\n")}};
  for (int k = 0; k < 2; k++) {
    small_run r;
    mode m;
    double time, part = swing(&r, cases[k].number, cases[k].text, &m, &time);
    const double zeta = cases[k].zeta, root = sqrt(1 - zeta * zeta), angle = m.omega * root * time;
    const double theory = exp(-zeta * m.omega * time) * (cos(angle) + zeta / root * sin(angle));
    assert_true(simulation_deck(r.simulation)->dampings[0].rate == 2 * zeta * m.omega);
    if (!(fabs(part - theory) < 1e-3)) fail_msg("%g, not %g", part, theory);
    small_close(&r);
  }
}

/* Bits at the end: of a run that was asked for modes at the start, and of one that was not. */
static void asking_leaves_the_run_as_it_is(void **state) {
  (void)state;
  static const char text[] =
      SWINGING("1e-4", "&region name = 'right' shape = 'point' at = 0.4, 0 /\n"
                       "&initial_displacement region = 'right' component = 'x' value = 1e-5 /\n"
                       "&initial_velocity region = 'right' component = 'y' value = 1 /\n");
  small_run asked, left;
  mode m[5];
  mode_count count;
  small_open(&asked, &elastic_beam, text);
  small_open(&left, &elastic_beam, text);
  assert_null(modes_find(asked.simulation, 5, m, &count));
  modes_free(m, 5, 1);
  assert_int_equal(small_go(&asked), STEP_END);
  assert_int_equal(small_go(&left), STEP_END);
  const body *a = simulation_state(asked.simulation, 0)->body,
             *b = simulation_state(left.simulation, 0)->body;
  for (int d = 0; d < a->dof; d++) {
    assert_memory_equal(a->displacement[d], b->displacement[d],
                        (size_t)a->lattice->size * sizeof(double));
    assert_memory_equal(a->velocity[d], b->velocity[d], (size_t)a->lattice->size * sizeof(double));
  }
  small_close(&asked);
  small_close(&left);
}

static void expect_refused(const char *text, const char *message) {
  small_run r;
  small_open(&r, &elastic_beam, text);
  assert_null(r.simulation);
  assert_int_equal(r.said.count, 1);
  if (!strstr(r.said.items[0].message, message))
    fail_msg("%s, not %s", r.said.items[0].message, message);
  small_close(&r);
}

static void what_has_no_frequency_is_refused(void **state) {
  (void)state;
  expect_refused("&simulation end_time = '3 periods' /\n"
                 "&lattice name = 'c' kind = 'hexagonal' spacing = 0.02 thickness = 0.1 /\n"
                 "&body lattice = 'c' shape = 'rectangle' corner = 0, 0 size = 0.1, 0.1 /\n"
                 "&material lattice = 'c' model = 'm' /\n",
                 "the bodies have no frequency to go by: nothing holds them");
  expect_refused("&simulation end_time = 1e-3 /\n"
                 "&lattice name = 'c' kind = 'hexagonal' spacing = 0.02 thickness = 0.1 /\n"
                 "&body lattice = 'c' shape = 'rectangle' corner = 0, 0 size = 0.02, 0.001 /\n"
                 "&material lattice = 'c' model = 'm' /\n"
                 "&region name = 'left' shape = 'point' at = 0, 0 /\n"
                 "&support region = 'left' fix = 'x', 'y' /\n&damping ratio = 0.1 mode = 7 /\n",
                 "the bodies have no mode 7, but 3");
  expect_refused(SWINGING("'1e-4 periods'", ""), "is shorter than one step");
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(a_held_plate_with_a_mass_has_the_modes_of_its_matrix),
      cmocka_unit_test(a_free_plate_has_three_rigid_motions),
      cmocka_unit_test(laws_of_families_reach_as_far_as_their_passes),
      cmocka_unit_test(links_are_springs_like_others),
      cmocka_unit_test(a_free_block_in_space_has_six_rigid_motions),
      cmocka_unit_test(a_bar_swings_in_four_times_its_length_over_the_speed),
      cmocka_unit_test(a_cantilever_swings_like_a_beam),
      cmocka_unit_test(a_body_begun_in_a_mode_swings_in_its_period),
      cmocka_unit_test(the_ratio_of_damping_is_that_of_theory),
      cmocka_unit_test(asking_leaves_the_run_as_it_is),
      cmocka_unit_test(what_has_no_frequency_is_refused)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
