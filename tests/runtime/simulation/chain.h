/* Rows of particles joined by bars or beams, whose runs have closed forms: of a hexagonal
   lattice only one row stands. */
#ifndef PERILAT_TESTS_CHAIN_H
#define PERILAT_TESTS_CHAIN_H

#include "runtime/interaction/sweep.h"
#include "tests/runtime/small_run.h"

#define SPACING   0.01
#define THICKNESS 0.1
#define CHAIN                                                                                      \
  "&lattice name = 'c' kind = 'hexagonal' spacing = 0.01 thickness = 0.1 /\n"                      \
  "&body lattice = 'c' shape = 'rectangle' corner = 0, -0.001 size = %g, 0.002 /\n"
#define POINT(name, x, y) "&region name = '" name "' shape = 'point' at = " x ", " y " /\n"
/* A chain of two particles that nothing holds. */
#define COASTING                                                                                   \
  "&simulation end_time = 1e-5 step = 1e-7 /\n" CHAIN                                              \
  "&material lattice = 'c' model = 'm' /\n" POINT("left", "0", "0") POINT("right", "0.01", "0")

static inline double rigidity_axial(double nu) {
  return 30e9 * SPACING * THICKNESS / (sqrt(3) * (1 - nu));
}

static inline double rigidity_bending(double nu) {
  return 30e9 * pow(SPACING, 3) * THICKNESS * (1 - 3 * nu) / (12 * sqrt(3) * (1 - nu * nu));
}

static inline double particle_mass(void) {
  return 2323 * sqrt(3) / 2 * SPACING * SPACING * THICKNESS;
}

static inline void must_open(small_run *r, const pl_law *law, const char *text) {
  small_open(r, law, text);
  if (!r->simulation) small_print(r);
  assert_non_null(r->simulation);
}

/* Both particles of a coasting chain at 2 m/s along x. */
static inline void must_coast(small_run *r, const char *text) {
  must_open(r, &elastic_bar, text);
  body *b = simulation_state(r->simulation, 0)->body;
  for (int p = 0; p < 2; p++)
    b->velocity[0][b->lattice->particle_site[p]] = 2;
}

#endif
