/* What lowering leaves of a law: its results as nodes of a graph, and what became of its text. */
#ifndef PERILAT_GENERATOR_LOWERED_H
#define PERILAT_GENERATOR_LOWERED_H

#include "dsl/semantics/law.h"
#include "generator/ir/ir.h"

typedef enum lower_mode {
  LOWER_STEP,        /* fields read below their rule have their new value */
  LOWER_PROTECTABLE, /* the same, but a damage stays old where the input ENDS_PROTECTED is not 0 */
  LOWER_HELD,        /* the same in families: where ENDS_HELD_I is, of bonds also ENDS_HELD_J */
  LOWER_FROZEN /* fields keep the value at hand everywhere: the elastic law of a given state */
} lower_mode;

/* What is not the same for all particles of a body beside their state, and what else is asked of
   the kernel. Of laws of families. */
typedef struct law_variation {
  const int *varying; /* [varying_count] ascending: law->parameters that differ in space: from bond
                         to bond of laws of bonds, else from particle to particle */
  int varying_count;
  /* of these the last: fields that change in time, which stand before, too, as they were a step
     ago; read by ledgers alone */
  int before_count;
  bool masses; /* particles have masses of their own */
  bool shares; /* force state and energy are those of a particle's share (pl_family) */
  bool sizes;  /* `spacing` and `horizon` are a particle's own (pl_family) */
  bool alone;  /* hosts take single families (pl_law.force_state) */
  /* what is needed only where something grows is computed everywhere (plan/seldom.h): for
     comparisons */
  bool everywhere;
  /* strains of points are given as measured from the rest strain, none along z in plane strain:
     for checks of what the law says of them */
  bool measured;
} law_variation;

/* What became of the law's text (LOWER_STEP only), for checks that speak about it. */
typedef struct lowered_line { /* a case line with a guard */
  const expr *cases;
  int line, group; /* lines of one list in one call of a function share a group */
  ir_node guard;
} lowered_line;
typedef struct lowered_place { /* an operation that is not defined everywhere */
  ir_node node;
  span where;
  const expr *of;
} lowered_place;
typedef struct lowered_flow {
  const stmt *rule;
  int field;
  ir_node when;       /* IR_NONE: always */
  ir_node overstress; /* a - b of a guard a >= b; IR_NONE for other guards */
  /* Of a returned flow of a point: of the overstress along it, at its start and hardly after. */
  ir_node slope, slope_after;
} lowered_flow;
typedef struct lowered_text {
  /* [law->fields.count] a damage's rule before it is kept in [0, 1]; the rate of a state that has
     one */
  ir_node *rules;
  lowered_line *lines;
  lowered_place *places;
  lowered_flow *flows;
  int line_count, place_count, flow_count;
} lowered_text;

enum { BENDING_AXES = 3, LOWERED_STRESSES = 6, FORCE_AXES = 3 };
enum { LOWERED_TIP = 3 }; /* grow (1 or 0), toward (rad), speed (m/s) */
enum { LOWERED_FORCES = 2 * BENDING_AXES + 3 + FORCE_AXES + LOWERED_STRESSES + LOWERED_TIP };

/* What a law does not give is IR_NONE. */
typedef struct lowered_law {
  ir_node N; /* results; `force V` and `energy W` are resolved here */
  /* end moments: components about the axes of the lattice, of plane bending the first */
  ir_node M_i[BENDING_AXES], M_j[BENDING_AXES];
  ir_node T; /* twisting moment on end j, on end i the opposite; in space */
  ir_node F; /* force state in N (the bond force is the mean of both sides), or IR_NONE */
  /* the same of a law that gives a vector: the force on the particle is half the difference of both
     sides; components that there are not, and all of other laws, are IR_NONE */
  ir_node F_of[FORCE_AXES];
  ir_node sigma[LOWERED_STRESSES]; /* of a continuum: xx, yy, zz, xy, yz, xz; Pa */
  ir_node tip[LOWERED_TIP];        /* of a crack */
  bool along_reference;            /* it acts along the reference bond */
  ir_node rest; /* stretch from which the input `stretch` of all this is measured; IR_NONE: 0 */
  ir_node rest_strain[LOWERED_STRESSES]; /* the same of strains, as sigma; all or none IR_NONE */
  ir_node W;                             /* the law's own `energy`, or IR_NONE */
  ir_node *fields;  /* [law->fields.count] new values (LOWER_FROZEN: the inputs themselves) */
  ir_node *outputs; /* [law->outputs.count] */
  lowered_text text;
} lowered_law;

/* Whether the force state is a vector toward each neighbour. */
static inline bool lowered_is_vector(const lowered_law *p) {
  return p->F_of[0] != IR_NONE;
}

/* The places of N, M_i, M_j, T, F, F_of and sigma that are not IR_NONE. Returns how many. */
int lowered_forces(lowered_law *p, ir_node **forces);

#endif
