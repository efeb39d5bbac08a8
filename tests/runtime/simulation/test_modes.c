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
  for (int k = 0; k < most; k++) {
    const double omega = sqrt(all.values[rigid + k]);
    if (!(fabs(modes[k].omega / omega - 1) < 6e-6))
      fail_msg("mode %d: %.9g, %.9g by the dense matrix", k + 1, modes[k].omega, omega);
    assert_true(modes[k].residual < 1e-6);
  }
  modes_free(modes, most, simulation_bodies(r->run.simulation));
  close_dense(&all);
}

#define PLATE                                                                                      \
  "&simulation end_time = 1e-3 /\n&output frames = 0 /\n"                                          \
  "&lattice name = 'c' kind = 'hexagonal' spacing = 0.02 thickness = 0.1 /\n"                      \
  "&body lattice = 'c' shape = 'rectangle' corner = 0, 0 size = 0.2, 0.08 /\n"                     \
  "&material lattice = 'c' model = 'm' /\n"                                                        \
  "&region name = 'left' shape = 'rectangle' corner = -0.005, -1 size = 0.01, 2 /\n"               \
  "&region name = 'end' shape = 'point' at = 0.2, 0 /\n"

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

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(a_held_plate_with_a_mass_has_the_modes_of_its_matrix),
      cmocka_unit_test(a_free_plate_has_three_rigid_motions),
      cmocka_unit_test(laws_of_families_reach_as_far_as_their_passes)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
