/* Checked law to IR: results, new field values and outputs as functions of parameters, quantities
   and old fields. Functions are expanded at their calls; options are decided; damage is made
   non-decreasing and kept in [0, 1]. */
#ifndef PERILAT_GENERATOR_LOWER_H
#define PERILAT_GENERATOR_LOWER_H

#include "dsl/semantics/law.h"
#include "generator/ir/ir.h"

typedef enum lower_mode {
  LOWER_STEP,        /* fields read below their rule have their new value */
  LOWER_PROTECTABLE, /* the same, but a damage stays old where the input ENDS_PROTECTED is not 0 */
  LOWER_HELD,        /* the same in families: where ENDS_HELD_I is, of bonds also ENDS_HELD_J */
  LOWER_FROZEN /* fields keep the value at hand everywhere: the elastic law of a given state */
} lower_mode;

/* What became of the law's text (LOWER_STEP only), for checks that speak about it. */
typedef struct lowered_line { /* a case line with a guard */
  const expr *cases;
  int line, group; /* lines of one list in one call of a function share a group */
  ir_node guard;
} lowered_line;
typedef struct lowered_place { /* an operation that is not defined everywhere */
  ir_node node;
  span where;
} lowered_place;
typedef struct lowered_flow {
  const stmt *rule;
  int field;
  ir_node when;       /* IR_NONE: always */
  ir_node overstress; /* a - b of a guard a >= b; IR_NONE for other guards */
} lowered_flow;
typedef struct lowered_text {
  ir_node *rules; /* [law->fields.count] a damage's rule before it is kept in [0, 1] */
  lowered_line *lines;
  lowered_place *places;
  lowered_flow *flows;
  int line_count, place_count, flow_count;
} lowered_text;

typedef struct lowered_law {
  ir_node N, M_i, M_j; /* results; `force V` and `energy W` are resolved here; central: M IR_NONE */
  ir_node F;           /* force state in N (the bond force is the mean of both sides), or IR_NONE */
  bool along_reference; /* it acts along the reference bond */
  ir_node W;            /* the law's own `energy`, or IR_NONE */
  ir_node *fields;      /* [law->fields.count] new values (LOWER_FROZEN: the inputs themselves) */
  ir_node *outputs;     /* [law->outputs.count] */
  lowered_text text;
} lowered_law;

/* Adds the law's nodes to g. Quantities become inputs IR_FROM_QUANTITY, fields IR_FROM_FIELD.
   Arrays live in `memory`. diff(f, x) and forces derived from `energy W` hold every state and
   damage (old and new) that is not x itself:
     N = dW/dL = (dW/dstretch)/s, M_i = dW/dtheta_i, M_j = dW/dtheta_j
   `force V` gives M_i = M_j = V L/2. A damage rule that is not a number gives a damage that is not
   a number: it is found, not clamped away. What goes over a family are FAMILY operations, what belongs to a neighbour
   IR_NEIGHBOUR. False with a NOT_SUPPORTED diagnostic for what cannot be compiled yet. */
bool lower_law(const law *l, ir *g, lower_mode mode, arena *memory, lowered_law *out,
               diagnostics *d);

/* The input node of a built-in quantity that is one number. Stretch, its rate, theta_i, theta_j and length vary from
   bond to bond; the others are those of a bond class. */
ir_node lower_quantity(ir *g, builtin_quantity q);
/* The input node of parameter or field k. */
ir_node lower_parameter(ir *g, const law *l, int k);
ir_node lower_field(ir *g, const law *l, int k);
/* A bound of a parameter as IR over the parameters; infinite without an expression. IR_NONE with a
   diagnostic when it cannot be compiled. */
ir_node lower_bound(ir *g, const law *l, const expr *bound, double infinite, diagnostics *d);

/* Stored energy of a bond (J) in a frozen law at zero rate, as a function of its kinematics: the
   law's `energy` if it has one; half of force times deformation where the forces are homogeneous of
   degree one (linear, also piecewise); from the stress-free point where N is affine in the stretch
   alone; otherwise Gauss integration along the straight path from rest (4 points: exact for forces
   up to degree 7). */
ir_node lower_stored_energy(const law *l, ir *g, const lowered_law *frozen);

/* Power (W) of the parts of the results that vanish at zero rate: (N - N at zero rate) dL/dt, and
   the moments' with the given rates of theta_i and theta_j (rad/s; unused for central laws).
   IR_NONE if there are none. */
ir_node lower_rate_power(const law *l, ir *g, const lowered_law *frozen, ir_node theta_rate_i,
                         ir_node theta_rate_j);

#endif
