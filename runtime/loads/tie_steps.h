/* What a tie between a lattice and a mesh (mesh_ties.h) does in a step. Both move their particles
   as if they were free; then the tied ones tell what has kicked them, the nodes are put right by
   that as by any applied force, in the same step, and the tied particles go where the mesh is.

     lattice   kicks and moves all its particles --.          .--> tied ones put on the mesh
                                                    f, N^T f /
     mesh      moves its nodes by its own forces ----> put right

   In sum over lattice and mesh the work of these forces is 0: the lattice's ledger has it with the
   opposite sign. All is done by one thread: an edge has few particles. */
#ifndef PERILAT_RUNTIME_TIE_STEPS_H
#define PERILAT_RUNTIME_TIE_STEPS_H

#include "runtime/continuum/cells.h"
#include "runtime/continuum/mesh_ties.h"
#include "runtime/interaction/half_bonds.h"
#include "runtime/loads/load_steps.h"

/* One of the two that are tied, at work. */
typedef struct tied_body {
  body *body;
  loads *loads;
} tied_body;

typedef struct tie_steps {
  const mesh_tie *of;
  int number;
  tied_body lattice, mesh;
  int64_t *site;       /* [of->count] of tied particles */
  double *velocity[2]; /* [of->count] m/s: before the coming step */
  /* [of->count] N, N m: on tied particles in the state last asked for, without moments of the
     lattice's own bonds; and those of the bonds that are borne by halves, of the present state */
  double *force[PL_MAX_DOF], *half[PL_MAX_DOF];
  int node_count;
  int *node;             /* [node_count] of the mesh */
  int32_t *node_number;  /* [nodes of the mesh] number of these */
  double *node_force[2]; /* [node_count] N */
  double *node_ahead;    /* [node_count] m/s, while looked at */
  half_bonds *halves;    /* NULL without */
  double internal;       /* J: correction of the work against the lattice's bonds */
  double work;           /* J: that it has done on loads of both, up to the state seen */
} tie_steps;

/* The bodies' state must be set up, at rest. Its forces become loads of both; masses go to the
   nodes. The last one is to be followed by loads_links_added. `law`,
   `parameters`: the lattice's, for bonds that are borne by halves. */
void tie_steps_open(tie_steps *t, const mesh_tie *of, int number, tied_body lattice,
                    tied_body of_mesh, const cells *c, const sweep *law, const double *parameters);
void tie_steps_close(tie_steps *t);

/* Tied particles go where the nodes are, with their velocities; `stepped`: a step has led there. */
void tie_steps_follow(tie_steps *t, bool stepped);
/* When all rows have moved in a step: what acts on the nodes. */
void tie_steps_give(tie_steps *t);
/* The same of the state observed after `step` steps, before load_steps_observe. */
void tie_steps_see(tie_steps *t, long step);
/* After it: what the tie adds to what is known of the lattice, and the velocities of tied particles
   after the coming step. */
void tie_steps_look(const tie_steps *t, load_look *look, long step);

#endif
