/* What loads do in a step. The sweep moves every particle as if it were free; afterwards the loaded
   ones are put right.

   Steps are of the second order. Places and forces are of the instants t_n = n dt, velocities of
   the middles between them, the first of them half a step before the run:
     v(-1/2) = v(0) - dt/2 a(0)                                   (load_steps_set_back)
   A load that begins at once within half a step of t_n counts there with the part of t_n - dt/2 ..
   t_n + dt/2 that it covers:
     t_(n-1)      t_n       t_(n+1)
        |----.-----|-----.-----|   here with three quarters of its value at t_n; damping likewise
               #################

   Signs: a reaction is what the support or drive exerts on the body,
     reaction = mass times prescribed acceleration - bond forces - mass damping - applied force,
   so that the sum of reactions, applied forces and damping is the rate of the momentum, to
   rounding. A drive leaves its particles free before its start; then their displacement follows
   time_function_integral (or the prescribed displacement) exactly, counted from where each particle
   is at the start. One that begins with a velocity changes the momentum at once: the impulse does
   work, but is no part of any reaction.

   A drive that ends at t_e lets go in the step whose middle is the first after t_e,
     v(n+1/2) = V(t_e) + a (t_(n+1/2) - t_e),   a: of the free particle at t_n, V: of the drive,
   which is the reaction times the part of t_n - dt/2 .. t_n + dt/2 that it covers, to the second
   order. Its particles are free from then on.

   In space what holds or drives a component of a particle's rotation vector is a moment that does
   no work where the component stays (rotation_vector.h): where the particle has turned, it has
   parts about the other axes. Reactions are the parts about the axes of what is held. */
#ifndef PERILAT_RUNTIME_LOAD_STEPS_H
#define PERILAT_RUNTIME_LOAD_STEPS_H

#include "runtime/body/momentum.h"
#include "runtime/loads/loads.h"

/* At the state observed: what loaded particles add to the sums over the body, J. */
typedef struct load_look {
  double kinetic;                /* they are not free */
  double work;                   /* of reactions, from the last half step on */
  double dissipated;             /* by mass damping, likewise */
  double stored, free, internal; /* what ties add to those of the body */
  double given;                  /* the same, by rest states */
} load_look;

/* Of a static run: the motion prescribed after `step` steps (m), counted from the anchor; the force
   of a cause then (N for each unit of share); and the weight. */
double load_steps_motion(const loads *l, const body *w, const constraint *c, long step);
double load_steps_factor(const loads *l, const body *w, const applied *f, long step);
void load_steps_weigh(const loads *l, body *w, long step);
/* Something holds or drives the component in the present increment. */
bool load_steps_holds(const loads *l, const body *w, const constraint *c);

/* Before the first step of each increment of a quasi-static run: its loads, and what they hold. */
void load_steps_increment(loads *l, const body *w, load_clock clock);
/* To be called once, before the first step: forces at time 0, places of the supports. */
void load_steps_begin(loads *l, body *w);
/* Then, in dynamic runs, when the state at time 0 was observed: velocities from there to half a
   step before. */
void load_steps_set_back(loads *l, body *w);
/* When step n -> n+1 has moved the rows of a block: applied forces, prescribed motions, reactions,
   work. What has not moved, as its row has a bad velocity, is left alone. */
void load_steps_apply(loads *l, body *w, int block, long step);
/* Some load begins or ends within half a step of the instant after `step` steps: only a part of it
   counts there (load_clock_part_after), and the step is not to change. */
bool load_steps_jump(const loads *l, const body *w, long step);
/* The state after `step` steps was observed: from it on steps take `time_step` (s), of which
   `steps`
   would have led there. Each particle keeps its velocity at this instant, the mean of those half a
   step before and after, and what pushes it: so it is kicked over half of the former step and half
   of the new one, and the change is of the second order. */
void load_steps_change(loads *l, body *w, long step, double time_step, long steps);
/* When all blocks have, alone: gravity and damping of the coming step (with a clock of its own that
   stays as it is). */
void load_steps_turn(const loads *l, body *w, long step);
/* Then, when they are known: the forces of links at the new places, of the rows of a block. */
void load_steps_take_links(loads *l, body *w, int block);
/* In a step, when all rows have moved but before load_steps_apply: what ties exert. */
void load_steps_take_ties(loads *l, const body *w, long step);
/* Of the state observed after `step` steps, before load_steps_observe: the same of one tie; returns
   the work that it has done up to there, J. */
double load_steps_see_tie(loads *l, const body *w, int tie, long step);
load_sums load_steps_total(const loads *l);

/* In space, of constraint i, the first of a particle's rotations: the moments about all axes that
   nothing holds of moment[3]. Returns how many constraints the particle's rotations have; 0: it is
   none of them. */
int load_steps_release(const loads *l, const body *w, long i, double moment[3]);

/* When the state after `step` steps was observed: reactions in it. */
load_look load_steps_observe(loads *l, const body *w, long step);
/* Then: velocity (m/s, rad/s) of a particle at this instant, the mean of those half a step before
   and after. */
double load_steps_velocity(const loads *l, const body *w, int component, int64_t site, long step);
/* The same with those half a step before and after. */
velocity_instant load_steps_velocities(const loads *l, const body *w, int component, int64_t site,
                                       long step);

/* The first force on that site or behind it; they stand in the order of their sites. */
long load_steps_first_force(const loads *l, int64_t site);

#endif
