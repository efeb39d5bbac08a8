/* One run: bodies, their laws, loads and the time loop. Setting up allocates and checks everything;
   a step allocates nothing. Leapfrog steps, v += dt a, u += dt v, with velocities half a step
   before the places (load_steps.h), by the sweep in stages that all threads do together (sweep.h).
   Forces are summed in a fixed order: results do not depend on the number of threads. With a
   &relaxation the steps lead from one state of balance to the next (relaxation.h).

   The energy ledger is explained in ledger.h, signs of reactions and drives in load_steps.h, means
   and zeros in monitor.h. */
#ifndef PERILAT_RUNTIME_SIMULATION_H
#define PERILAT_RUNTIME_SIMULATION_H

#include <signal.h>

#include "dsl/base/c_linkage.h"
#include "runtime/analysis/material.h"
#include "runtime/analysis/step_limit.h"
#include "runtime/deck/deck.h"
#include "runtime/kernel.h"
#include "runtime/lattice/parameter_planes.h"
#include "runtime/lattice/rows.h"
#include "runtime/simulation/bad_state.h"
#include "runtime/simulation/frame_field.h"
#include "runtime/simulation/run_clock.h"

C_LINKAGE_BEGIN

typedef struct simulation simulation;
struct mesh_tie;
struct profile;
struct result_state;
struct run_going;
struct sweep;
struct tips;

/* What the front end hands over for each interaction of the deck, in its order, and then for each
   of its cracks (without a law: all 0). NULL where a law or its parameters are wrong: then the deck
   is checked as far as it does not depend on them. */
typedef struct simulation_law {
  const pl_law *law;
  /* [parameter_count] as of material_parameters; malloc'ed, owned by the caller. A simulation sets
     those that have a random field to its mean. */
  double *parameters;
  /* [regional_count] those of materials of regions (deck_material.regional); the caller's, too */
  regional_values *regional;
  int regional_count;
} simulation_law;

/* NULL with all diagnostics when the deck does not fit its lattices or the given step is unstable,
   and where `d` has errors already; what items that a deck lacks would have to do with is not said.
   laws: of each interaction of the deck, then of each crack (`law` NULL where it does not grow).
   Deck, laws and parameters must stay until the simulation is freed. With an automatic step the run
   ends with the first step at or past end_time. */
simulation *simulation_new(const deck *k, const simulation_law *laws, diagnostics *d);
/* The same on the deck's lattices as lattice_build has built them, which belong to the simulation
   from then on; NULL: all or this one is to be built. */
simulation *simulation_new_on(rows *const *lattices, const deck *k, const simulation_law *laws,
                              diagnostics *d);
void simulation_free(simulation *s);

/* As many as the deck has lattices, in their order. */
int simulation_bodies(const simulation *s);
/* The deck as the run takes it: with end and dampings that it gives by frequencies as times and
   rates. */
const deck *simulation_deck(const simulation *s);
/* rad/s of a mode, from 1, that the deck gives something by. */
double simulation_omega(const simulation *s, int mode);
/* Of a lattice, to meshes: *count of them. */
const struct mesh_tie *simulation_ties(const simulation *s, int number, int *count);
/* Of its bonds at tied particles those with a damage of 0.5 or more. */
long simulation_damaged_ties(const simulation *s, int number);
const rows *simulation_rows(const simulation *s, int body);
/* The cells of a mesh (runtime/continuum/cells.h); NULL of other bodies. */
const struct cells *simulation_cells(const simulation *s, int body);
/* s: between two samples of the history. */
double simulation_sample_interval(const simulation *s);
/* s: the longest stable step of a body as its cracks are now. */
double simulation_limit_now(const simulation *s, int body);
/* Of an interaction of the deck: the rows of its body with the bonds that the law has a part in,
   and the parameters that differ in space (NULL without). */
const rows *simulation_law_rows(const simulation *s, int interaction);
const parameter_planes *simulation_planes(const simulation *s, int interaction);
/* The shortest that a body has, and whose it is. */
const step_limit *simulation_step_limit(const simulation *s);
int simulation_ruling_body(const simulation *s);
long simulation_step_count(
    const simulation *s); /* planned; without meaning for quasi-static runs */
long simulation_step_done(const simulation *s);
/* s: the longest stable step at rest once bodies touch, where steps may shrink. */
double simulation_touching_limit(const simulation *s);
/* Steps done, with the parts of steps that have shrunk; s: the present step; when and why it became
   what it is, *count times. */
long simulation_steps_taken(const simulation *s);
double simulation_step_now(const simulation *s);
const step_change *simulation_step_changes(const simulation *s, int *count);
/* What a &start of another deck needs (to be freed by result_state_free); NULL of a run that has
   gone bad. */
struct result_state *simulation_take_state(const simulation *s);
/* Of a body that goes on from another run; and what tells states that runs go on from from each
   other, 0: this one begins at rest. */
struct run_going simulation_going(const simulation *s, int body);
uint64_t simulation_started_from(const simulation *s);
double simulation_progress(const simulation *s); /* part of the run that is done, 0 to 1 */
/* Increments done of a quasi-static run, and how many of them ended without balance; 0 else. */
long simulation_increments(const simulation *s, long *unbalanced);
/* Times that the body was as stiff as at rest when a quasi-static run looked last; 1 else. */
double simulation_stiffened(const simulation *s);
/* How many of them ended with hardly any loads or reactions on any body (relaxation.h). */
long simulation_increments_within(const simulation *s);
double simulation_time(const simulation *s);   /* s, as the deck's loads count it */
double simulation_memory(const simulation *s); /* bytes */
int simulation_threads(const simulation *s);   /* that will work on it */
/* From now on the time that parts of the run take is added to `p` (NULL: no longer); p must
   stay. */
void simulation_measure(simulation *s, struct profile *p);
/* The arrays of the state of a body, for tools and tests; before the first step they may be set (an
   initial velocity, say). */
struct sweep *simulation_state(simulation *s, int body);
/* With the fields of the law of an interaction. */
struct sweep *simulation_law_state(simulation *s, int interaction);

/* Of the deck's force of that number, per length: the length that it acts on, m, and on how many
   particles. */
double simulation_loaded_length(const simulation *s, int force, long *particles);

/* kg: the deck's point mass of that number in all, and on how many particles. */
double simulation_point_mass(const simulation *s, int index, long *particles);

/* s: when what the deck's &frame of that number waits for came; negative: it has not. */
double simulation_frame_came(const simulation *s, int frame);

/* The &stop of the deck that ended the run (STEP_STOPPED), or NULL. */
const deck_stop *simulation_stopped_by(const simulation *s);

/* Advances until `steps` more steps are done, the next frame's time is reached, the run ends, or
 *interrupted (may be NULL) is set. One parallel region. Samples are taken on the way. */
step_status simulation_advance(simulation *s, long steps, const volatile sig_atomic_t *interrupted);

bad_state simulation_bad(const simulation *s);

/* Particles that lie over each other, nearer than half of what contact would keep them at: how many
   pairs, and the nearest of them, by the numbers of their bodies. None where the deck has contact,
   and of a run that has gone bad. */
typedef struct overlap_found {
  long pairs;
  int body[2];
  long particle[2];
} overlap_found;
overlap_found simulation_overlap(simulation *s);

/* Of a contact of the deck: the largest numbers of all states so far. */
typedef struct contact_said {
  long pairs;           /* that touch at a time */
  double force, stored; /* N, of a pair; J */
} contact_said;
contact_said simulation_contact(const simulation *s, int contact);

/* Of a stamp of the deck. */
typedef struct stamp_said {
  long touching;   /* particles at a time, at most of all states so far */
  double force;    /* N: the largest on it */
  double place[3]; /* m: where it is now, from where it is drawn */
  double velocity[3];
  bool too_far; /* the run has ended, as it went further than a spacing in a step */
} stamp_said;
stamp_said simulation_stamp(const simulation *s, int stamp);
/* m: from the present place of the stamp to the nearest particle, a ball of half of its spacing;
   *lattice: whose that is, its number in the deck. Infinite where it touches no body. */
double simulation_stamp_gap(const simulation *s, int stamp, int *lattice);

/* History so far. Series 0.. are the deck's monitors, then the energy terms, in sum and, of several
   bodies, of each; of quasi-static runs
   then the steps that the increment took and the unbalanced force at its end (relaxation.h). */
long simulation_history(const simulation *s, const double **time);
int simulation_series_count(const simulation *s);
const char *simulation_series(const simulation *s, int k, const char **unit, const double **values);
/* What a series is, in words. */
char *simulation_series_words(const simulation *s, int k, arena *a);
/* The series that judges the run, the imbalance of its energies, or -1; *unchecked: why it says
   nothing (ledger.h), or NULL. */
int simulation_imbalance(const simulation *s, const char **unchecked);
/* J: the largest of all energies in sum in the history so far, in size; the imbalance is small or
   large beside it. */
double simulation_largest_energy(const simulation *s);
/* The series is such an imbalance, of the run or of a body; *unchecked likewise. */
bool simulation_judges(const simulation *s, int series, const char **unchecked);
double simulation_monitor_peak(const simulation *s, int monitor,
                               double *time); /* value that is largest in size, its sign kept */

/* Fields of the present state in the order of results, for frames. "force" and outputs are
 * evaluated on demand. */
int simulation_frame_fields(const simulation *s, const frame_field **fields);
void simulation_frame_values(simulation *s, int field, double *values);
bool simulation_frame_due(
    const simulation *s); /* a frame's time has been reached and not yet taken */
void simulation_frame_taken(simulation *s);

C_LINKAGE_END

#endif
