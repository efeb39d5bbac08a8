/* The checks of physics.h, in parts that share one bench and what was found on it. */
#ifndef PERILAT_GENERATOR_PHYSICS_PARTS_H
#define PERILAT_GENERATOR_PHYSICS_PARTS_H

#include "generator/check/physics_bench.h"

enum { POOL_MOST = 512, SCALES_MOST = 96 };

typedef struct physics {
  bench b;
  diagnostics *said;
  bool failed[DIAG_COUNT]; /* each check speaks once */
  double *pool;            /* [POOL_MOST][width] states that a bond can reach from rest */
  int pool_count;
  motion scales[SCALES_MOST]; /* motions at which guards change */
  int scale_count;
} physics;

/* --- physics_report.c: saying what was found -------------------------------------------------- */

extern const char *const physics_force_names[FORCE_COUNT], *const physics_force_units[FORCE_COUNT];

/* "stretch = 1.2e-4, omega = 0.5; with E = 3.1e+10 Pa": what the law reads of the state. */
char *physics_state_text(const physics *p, const double *column);
/* One error or warning of a kind, with the state that shows it (NULL: none) as its note. Later ones
   of the same kind are dropped. */
void physics_say(physics *p, diag_code code, span where, const double *column, const char *format,
                 ...) __attribute__((format(printf, 5, 6)));
/* Whether forces or states need `stretch_rate`. */
bool physics_reads_rate(const physics *p);
/* The statement that gives N, M_i or M_j; of a list of cases the line in force at the state. */
span physics_fault(physics *p, int force, const double *column);

/* --- physics_states.c: where a law is driven -------------------------------------------------- */

/* Motion drawn log-uniformly, in half of the draws near one at which a guard changes. */
motion physics_draw_motion(physics *p);
/* A corner of a loop: of either sign and within a decade of the amplitude on every axis, so that
 * steps resolve the legs. */
motion physics_draw_corner(physics *p, motion amplitude);
/* Along rays from rest and from the pool: finds guards, both sides of which go to the pool;
 * continuity and flow. */
void physics_scan(physics *p, int rays, bool from_rest);
/* Random histories from rest; exchange, mirror, range of damages, finite forces. Fills the pool. */
void physics_histories(physics *p, int legs);

/* --- physics_energy.c: work ------------------------------------------------------------------- */

typedef struct work_done {
  double work, size; /* J; of the path's force times way, and of its absolute value */
  bool known;        /* a stress-free state was found to start from */
} work_done;
/* Work of the rate-free forces with the fields at hand from the stress-free state to each state,
 * along a straight path. */
void physics_work(physics *p, double *const *states, int count, int panels, work_done *out);
void physics_check_stored_energy(physics *p);
void physics_check_damage_force(physics *p);
void physics_check_energy_and_force(physics *p);
/* At states just beyond a yield limit: the energy stored may not rise by the flow. */
bool physics_flow_gains(physics *p, double *const *states, int lane, double *gain, double *stored);

/* --- physics_paths.c -------------------------------------------------------------------------- */
void physics_check_closed_path(physics *p);
void physics_check_dissipation(physics *p);
/* "0.001, 0, -0.002" or, of stretch and end rotations, "(0.001, 0, 0), ...": the corners after the
 * first; of a law that reads the rate "0.001 at 10 1/s" when `rates` has those of the legs (NULL: no). */
void physics_describe_way(const physics *p, const motion *corners, const double *rates, int count,
                          char *text, size_t size);

/* --- physics_healing.c ------------------------------------------------------------------------ */
/* A state that scales the forces may not go back toward its initial value (warning). */
void physics_check_healing(physics *p);

/* --- physics_hold.c --------------------------------------------------------------------------- */
/* A bond that is held may not pull harder and harder (error). */
void physics_check_hold(physics *p);

/* --- physics_tangent.c ------------------------------------------------------------------------ */
void physics_check_rest(physics *p);
void physics_check_stiffness(physics *p);
/* `wrong` (tests only): added to the derivative of N by the stretch. */
void physics_check_tangent(physics *p, double wrong);

#endif
