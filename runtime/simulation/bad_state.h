/* Where and why a state went bad: the particle, and what of its bonds tells of the law. */
#ifndef PERILAT_RUNTIME_BAD_STATE_H
#define PERILAT_RUNTIME_BAD_STATE_H

#include "dsl/base/c_linkage.h"
#include "runtime/lattice/rows.h"

C_LINKAGE_BEGIN

struct point_state; /* runtime/continuum/point_forces.h */
struct run_body;
struct run_clock;

typedef struct bad_neighbour {  /* of a law of families */
  long particle;                /* in the order of results */
  double stretch, stretch_rate; /* before the step */
  const double *fields; /* [law's fields] at its beginning: toward it; those on particles its own */
} bad_neighbour;

/* When STEP_BAD: of the first body that is bad. `particle` is -1 where only the energies tell
   (ledger.h). Else it is the lowest particle whose velocity was no number or took it further than a
   spacing (half a turn) in one step, and its bond that gave such a force, or else the largest. A
   row was not moved from about the first bad particle on, so that the state there is that before
   the step; a partner elsewhere is moved back by its velocity. With a law of families there is no
   such bond, but all neighbours; on a mesh with a law of points the point around that is worst. */
typedef struct bad_state {
  int body, interaction; /* of the run */
  long step;
  double time, advance; /* s; `dt` of laws in the step */
  long particle;
  double place[3];                                /* m; in the plane [2] is 0 */
  long bond_particle;                             /* partner of the first bad bond, or -1 */
  double stretch, stretch_rate, theta_i, theta_j; /* of that bond before the step */
  /* of that bond after the step's rules, initial values where these gave no number */
  const double *fields;
  int field_count;             /* 0 without a bond; the values are the simulation's */
  const double *parameters;    /* of the law in that bond; NULL without a bond */
  const bad_neighbour *family; /* of the particle; the values are the simulation's */
  int family_count;
  const double *own_fields;        /* [law's fields] those on particles: of the particle */
  const struct point_state *point; /* of a mesh; else NULL; the values are the simulation's */
  const char *what;                /* "not a number", "runaway velocity", "energy from nothing",
                                      "too stiff" */
} bad_state;

#define BAD_ENERGY    "energy from nothing"
#define BAD_TOO_STIFF "too stiff"

typedef struct bad_search bad_search;

/* All must stay. */
bad_search *bad_search_new(const struct run_body *bodies, int count, const struct run_clock *clock);
void bad_search_free(bad_search *s);
/* After a step in which some body had a velocity beyond its limit. */
void bad_search_velocity(bad_search *s);
/* A body of that number has become so stiff that steps would be too short. */
void bad_search_step(bad_search *s, int number);
/* The energies just sampled are none that a stable step allows. */
void bad_search_energy(bad_search *s, const char *what);
const bad_state *bad_search_found(const bad_search *s);

C_LINKAGE_END

#endif
