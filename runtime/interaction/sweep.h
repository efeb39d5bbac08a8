/* A law at work on a body: its fields, and the engine that finds the forces and moves the particles
   by one step. Knows neither loads nor files.

   A step is a few stages: every block of rows does a stage, and when all blocks have, the next one
   begins. What the stages do is the engine's affair: pairwise.h for laws of bonds, family.h for
   laws that read a particle's whole family. Both kick and move the particles of a row in the same
   way (motion.h). A particle's bonds are summed in one order, whatever the blocks, so that results
   are the same to the last bit. */
#ifndef PERILAT_RUNTIME_SWEEP_H
#define PERILAT_RUNTIME_SWEEP_H

#include "runtime/body/body.h"
#include "runtime/kernel.h"

typedef struct sweep sweep;

typedef struct sweep_engine {
  int step_stages, force_stages, observe_stages;
  void (*step)(sweep *w, int stage, int block);
  void (*forces)(sweep *w, int stage, int block); /* of the present state */
  void (*fields_set)(
      sweep *w);          /* after values of fields were set from outside; NULL: nothing to do */
  void (*turn)(sweep *w); /* after the last stage of a good step, alone; NULL: nothing to do */
  void (*observe)(sweep *w, int stage, int block);
  void (*output)(sweep *w, int output, double *values);
  void (*stored)(sweep *w, double *values);
  void (*free)(sweep *w);
  /* laws of families: what passes leave for each other is kept of the whole body */
  bool keeps_links;
  void *own;
} sweep_engine;

/* Makes the engine of a sweep whose fields are set up (pairwise_engine, family_engine). */
typedef sweep_engine sweep_engine_new(sweep *w, const double *parameters);

struct sweep {
  body *body;          /* owned, but of one law beside others (joint.h) */
  const rows *lattice; /* with the bonds that the law is at work on; the body's, or some of these */
  const pl_law *law;
  bool beside; /* the engine finds forces and leaves it to others to move the particles */
  double
      *force[PL_MAX_DOF]; /* [size] N, N m: sums over its bonds; the body's unless it is beside */
  /* [fields][sweep_planes * size] of the state that the last step left behind, and of that observed
     last; which memory is whose may change in a step. */
  double **field, **new_field;
  /* [varying][sweep_planes(law->varying_place) * size] parameters that differ in space; not
     owned */
  double *const *parameter;
  const double *share; /* [size] of laws that read it (pl_family); NULL: 1 everywhere; not owned */
  /* [size] J at the site that owns the bond, of laws of families at each particle half of its
     bonds': of all steps, and of what the law takes in the state observed; NULL where they are not
     kept. */
  double *dissipated_state, *dissipated_rate, *lost_state, *lost_rate;
  /* The same of what a rest state or fields that change give; NULL of laws without `works_at_rest`,
     too. */
  double *given_by_rest, *given_now;
  sweep_engine engine;
};

/* The fields start at their initial values. The body is the sweep's from then on. Without an engine
   the caller sets it. */
sweep *sweep_new(body *of, const pl_law *law, const double *parameters, sweep_engine_new *engine);
/* One that finds forces of its own on a body that others move, and that it does not own. */
sweep *sweep_beside(body *of, const rows *lattice, const pl_law *law, const double *parameters,
                    const double *share, sweep_engine_new *engine);
void sweep_free(sweep *w);

/* Site arrays that make up a field or an output in that place (pl_place): one for each direction of
   a pairwise law's bonds; of a law of families one on particles, else one for each neighbour; of a
   law of a continuum one, the means of the points around each node. */
int sweep_planes(const sweep *w, int where);

/* To be called when values of `field` have been set otherwise than by a step. */
void sweep_fields_set(sweep *w);

/* Ends a step in which nothing was bad, alone. */
void sweep_turn(sweep *w);
/* All stages and blocks of a step, one after the other: for tools and tests. False when it went
 * bad. */
bool sweep_step(sweep *w);

/* Forces of the present state, a thread for each block; nothing moves, and the fields stay. */
void sweep_find_forces(sweep *w);

/* Observing is done in stages too: the law at the present places, aside: forces on the particles,
   new fields, stored energy and outputs with these; it changes no state. A step brings places to
   t_n and fields to t_(n-1): observed, all is of t_n. The velocity after the coming kick is needed
   for the kinetic energy: that of free particles without applied forces is taken. This does all
   stages, a thread for each block; then body_sum has the energies. */
void sweep_observe(sweep *w);
/* Value in a bond of a field, an output, or a parameter that stands on bonds or neighbours; of a
   law of families the mean of both sides. */
double sweep_bond_value(const sweep *w, const double *values, const rows_bond *bond);
/* For engines: makes the arrays of losses; adds those of a row, since the start and in the state
   observed, to what is known of it (body_row). */
void sweep_new_losses(sweep *w);
/* Of a row those of the state observed, to begin with. */
void sweep_clear_losses(sweep *w, int row);
void sweep_add_losses(sweep *w, int row);
/* Whether its rest state, or fields that change in time, do work. */
bool sweep_works_at_rest(const pl_law *law);
/* Whether what the law loses is known: of laws of bonds on strips always; of laws of families,
   which then store energy, too, where it is `kept`, or where they cannot lose any. */
bool sweep_knows_losses(const pl_law *law, bool kept);

/* An output in the state observed last: values[sweep_planes * size], defined where bonds or
   particles are. */
void sweep_output(sweep *w, int output, double *values);
/* J stored at each particle in the state observed last: of laws of bonds half of what its bonds
   store. values[size]; 0 at absent sites. */
void sweep_stored(sweep *w, double *values);

#endif
