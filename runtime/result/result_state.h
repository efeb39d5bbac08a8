/* The whole state at the end of a run, as a result keeps it where its deck asks for it: what
   another run needs to go on from there.

     /state/step                     [1] s: velocities are those half of it before the places; 0: of
                                     bodies at rest
     /state/bodies/<lattice>/        kind (text), spacing [1] m, first [1] its first particle;
                                     displacement, velocity [n, dof] m, of rotations rad; m/s, rad/s
     /state/laws/<interaction>/      law (text), fields/<name>: [n, 1] of particles, [M, 1] of
                                     bonds, [M, 2] at both ends of bonds, in the order of /bonds; SI;
                                     lost/<contact> [M, 1] m: distance at which a bond was lost, 0:
                                     it was not
     /state/stamps/<stamp>/          place [3] m, from where it is drawn; velocity [3] m/s;
                                     surface [16] where it is drawn (surface_numbers);
                                     dragged/<lattice> [n, dimensions] m: of particles, along it */
#ifndef PERILAT_RUNTIME_RESULT_STATE_H
#define PERILAT_RUNTIME_RESULT_STATE_H

#include <stdbool.h>
#include <stdint.h>

#include "dsl/base/c_linkage.h"
#include "runtime/result/result_file.h"

C_LINKAGE_BEGIN

#define RESULT_STATE "/state"

/* All that pointers lead to is malloc'ed. */
typedef struct state_body {
  char *lattice, *kind; /* "hexagonal", "hexagonal with exact edges" */
  double spacing;       /* m */
  long first, count;    /* particles of the result */
  int dof;
  double *displacement, *velocity; /* [count][dof] */
} state_body;

typedef struct state_field {
  char *name;
  const char *unit; /* "Pa"; where it is written */
  long count;
  int columns;
  double *values; /* [count][columns] */
} state_field;

typedef struct state_law {
  char *interaction, *law;
  state_field *fields; /* [field_count] */
  int field_count;
  state_field *lost; /* [lost_count] of each contact of its body */
  int lost_count;
  int32_t *pairs; /* [bond_count][2] particles of the result; where it was read */
  long bond_count;
} state_law;

enum { STATE_SURFACE = 16 };

typedef struct state_stamp {
  char *name;
  double place[3], velocity[3], surface[STATE_SURFACE];
  state_field *dragged; /* [dragged_count] named as the lattices; [particles][dimensions] */
  int dragged_count;
} state_stamp;

typedef struct result_state { /* of a run */
  double step;                /* s */
  state_body *bodies;
  int body_count;
  state_law *laws;
  int law_count;
  state_stamp *stamps;
  int stamp_count;
  int dimensions;
  double *reference; /* [particle_count][dimensions] m; where it was read */
  long particle_count;
} result_state;

/* NULL with a sentence in `error`: there is none, `*missing`, or it cannot be read. Numbers of
   particles and sizes of tables are those that the rest of the result has. */
result_state *result_state_read(result_file *f, bool *missing, char *error, size_t size);
void result_state_free(result_state *s);

C_LINKAGE_END

#endif
