/* For tests: runs of one lattice whose parameters differ in space, without files in between.
   Include after cmocka.h. */
#ifndef PERILAT_TESTS_MATERIAL_CASES_H
#define PERILAT_TESTS_MATERIAL_CASES_H

#include "generator/ir/random_values.h"
#include "runtime/interaction/sweep.h"
#include "tests/verification/case.h"

#define START "&simulation end_time = '0.05 ms' /\n&output frames = 0 energy = .false. /\n"
/* A row of 20 particles. */
#define CHAIN(kind)                                                                                \
  START "&lattice name = 'l' kind = '" kind "' spacing = '5 mm' thickness = '10 mm' /\n"           \
        "&body lattice = 'l' shape = 'rectangle' corner = 0, '-1 mm' size = '95 mm', '2 mm' /\n"
#define DISC(kind, more)                                                                           \
  START "&lattice name = 'l' kind = '" kind "' spacing = '5 mm' thickness = '10 mm' " more " /\n"  \
        "&body lattice = 'l' shape = 'disc' centre = 0, 0 radius = '40 mm' /\n"

/* Forces after random displacements, [2 * particles]; to be freed. */
static inline double *forces_of(const char *text, long *count) {
  deck_case c;
  deck_case_open(&c, text);
  sweep *w = simulation_state(c.simulation, 0);
  const rows *g = w->body->lattice;
  double *forces = must_calloc((size_t)(2 * g->particle_count), sizeof *forces);
  uint64_t seed = 5;
  for (long p = 0; p < g->particle_count; p++)
    for (int d = 0; d < 2; d++)
      w->body->displacement[d][g->particle_site[p]] = draw_uniform(&seed, -5e-6, 5e-6);
  sweep_find_forces(w);
  for (long p = 0; p < g->particle_count; p++)
    for (int d = 0; d < 2; d++)
      forces[2 * p + d] = w->body->force[d][g->particle_site[p]];
  *count = 2 * g->particle_count;
  deck_case_close(&c);
  return forces;
}

/* Springs in a row bear one force where each is stretched as it is soft, stretch[p] before particle
   p; *borne is that force. Returns the largest force left on one, over that. */
static inline double left_in_a_row(const char *text, const double *stretch, double *borne) {
  deck_case c;
  deck_case_open(&c, text);
  sweep *w = simulation_state(c.simulation, 0);
  const rows *g = w->body->lattice;
  double u = 0, left = 0;
  for (long p = 0; p < g->particle_count; p++) {
    u += p ? stretch[p] * g->spacing : 0;
    w->body->displacement[0][g->particle_site[p]] = u;
  }
  sweep_find_forces(w);
  *borne = w->body->force[0][g->particle_site[0]];
  for (long p = 1; p < g->particle_count - 1; p++)
    left = fmax(left, fabs(w->body->force[0][g->particle_site[p]]));
  deck_case_close(&c);
  return left / *borne;
}

/* A row of particles with these groups is refused, with this message. */
static inline void refuse(const char *groups, const char *message) {
  char text[2048];
  deck_case c;
  bool found = false;
  snprintf(text, sizeof text, CHAIN("hexagonal") "%s", groups);
  assert_false(deck_case_text(&c, text));
  for (int k = 0; k < c.said.count; k++)
    found = found || strstr(c.said.items[k].message, message);
  if (!found) fail_msg("expected `%s`", message);
  deck_case_close(&c);
}

/* To the last bit. */
static inline void assert_same_motion(const deck_case *a, const deck_case *b) {
  const body *x = simulation_state(a->simulation, 0)->body,
             *y = simulation_state(b->simulation, 0)->body;
  const rows *g = x->lattice;
  assert_int_equal(g->particle_count, y->lattice->particle_count);
  for (int d = 0; d < x->dof; d++)
    for (long p = 0; p < g->particle_count; p++) {
      const long q = g->particle_site[p];
      assert_memory_equal(&x->displacement[d][q], &y->displacement[d][q], sizeof(double));
      assert_memory_equal(&x->velocity[d][q], &y->velocity[d][q], sizeof(double));
    }
}

#endif
