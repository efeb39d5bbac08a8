/* What a bond sees of its two ends, as IR: stretch, rates and co-rotational end rotations out of
   particle displacements, and particle forces out of the law's N, V, M. Written once as dataflow,
   so that it is shared by interpreter and emitter, and shares subexpressions with the law. */
#ifndef PERILAT_GENERATOR_KINEMATICS_H
#define PERILAT_GENERATOR_KINEMATICS_H

#include "generator/ir/ir.h"

/* Inputs with source IR_FROM_ENDS. U, V, PHI, OMEGA: displacement, velocity, rotation and rotation
   rate of end i or j. CHORD, REFERENCE_LENGTH: reference chord of this bond and its length (lists
   of families); CLASS_CHORD: the same chord for a whole strip (rows; pl_bond_class). VOLUME, MASS:
   of the particles (lists of families). SHARE: of the particle's law in it (pl_family). PROTECTED:
   1 where the damage of the bond stays as it is, else 0 (a number; the graph asks 0 < protected).
   HELD: the same for particle i or j, in families; what belongs to particle i is ON_PARTICLE there.
   The rotation in a plane and the third direction share component 2; in space the rotations PHI_X,
   PHI_Y, PHI_Z follow. Of a bond in a plane that twists PHI_X and OMEGA_X are about the bond.
   TIME_STEP: s, of the strip; ON_BOND because `prepare` does not know it. ADVANCE: s, `dt` of laws
   (kinematics_advance). */
/* X(code, name, where a strip keeps it, what it differs by, component) */
#define ENDS_INPUTS(X)                                                                             \
  X(U_IX, "u_ix", FROM_DISPLACEMENT, OF_I, 0)                                                      \
  X(U_IY, "u_iy", FROM_DISPLACEMENT, OF_I, 1)                                                      \
  X(PHI_I, "phi_i", FROM_DISPLACEMENT, OF_I, 2)                                                    \
  X(U_JX, "u_jx", FROM_DISPLACEMENT, OF_J, 0)                                                      \
  X(U_JY, "u_jy", FROM_DISPLACEMENT, OF_J, 1)                                                      \
  X(PHI_J, "phi_j", FROM_DISPLACEMENT, OF_J, 2)                                                    \
  X(V_IX, "v_ix", FROM_VELOCITY, OF_I, 0)                                                          \
  X(V_IY, "v_iy", FROM_VELOCITY, OF_I, 1)                                                          \
  X(OMEGA_I, "omega_i", FROM_VELOCITY, OF_I, 2)                                                    \
  X(V_JX, "v_jx", FROM_VELOCITY, OF_J, 0)                                                          \
  X(V_JY, "v_jy", FROM_VELOCITY, OF_J, 1)                                                          \
  X(OMEGA_J, "omega_j", FROM_VELOCITY, OF_J, 2)                                                    \
  X(CHORD_X, "chord_x", FROM_CHORD, OF_BOND, 0)                                                    \
  X(CHORD_Y, "chord_y", FROM_CHORD, OF_BOND, 1)                                                    \
  X(CHORD_Z, "chord_z", FROM_CHORD, OF_BOND, 2)                                                    \
  X(REFERENCE_LENGTH, "s", FROM_LENGTH, OF_BOND, 0)                                                \
  X(VOLUME_I, "V", FROM_VOLUME, OF_I, 0)                                                           \
  X(VOLUME_J, "V_j", FROM_VOLUME, OF_J, 0)                                                         \
  X(MASS_I, "m_i", FROM_MASS, OF_I, 0)                                                             \
  X(MASS_J, "m_j", FROM_MASS, OF_J, 0)                                                             \
  X(CLASS_CHORD_X, "class_chord_x", FROM_CLASS, OF_STRIP, 0)                                       \
  X(CLASS_CHORD_Y, "class_chord_y", FROM_CLASS, OF_STRIP, 1)                                       \
  X(U_IZ, "u_iz", FROM_DISPLACEMENT, OF_I, 2)                                                      \
  X(U_JZ, "u_jz", FROM_DISPLACEMENT, OF_J, 2)                                                      \
  X(V_IZ, "v_iz", FROM_VELOCITY, OF_I, 2)                                                          \
  X(V_JZ, "v_jz", FROM_VELOCITY, OF_J, 2)                                                          \
  X(CLASS_CHORD_Z, "class_chord_z", FROM_CLASS, OF_STRIP, 2)                                       \
  X(HELD_I, "held_i", FROM_HELD, OF_I, 0)                                                          \
  X(HELD_J, "held_j", FROM_HELD, OF_J, 0)                                                          \
  X(SHARE_I, "share_i", FROM_SHARE, OF_I, 0)                                                       \
  X(SHARE_J, "share_j", FROM_SHARE, OF_J, 0)                                                       \
  X(SIZE_I, "size_i", FROM_SIZE, OF_I, 0)                                                          \
  X(SIZE_J, "size_j", FROM_SIZE, OF_J, 0)                                                          \
  X(PROTECTED, "protected", FROM_FLAGS, OF_BOND, 0)                                                \
  X(TIME_STEP, "time_step", FROM_TIME, OF_STRIP, 0)                                                \
  X(ADVANCE, "dt", FROM_TIME, OF_STRIP, 1)                                                         \
  X(PHI_IX, "phi_ix", FROM_DISPLACEMENT, OF_I, 3)                                                  \
  X(PHI_IY, "phi_iy", FROM_DISPLACEMENT, OF_I, 4)                                                  \
  X(PHI_IZ, "phi_iz", FROM_DISPLACEMENT, OF_I, 5)                                                  \
  X(PHI_JX, "phi_jx", FROM_DISPLACEMENT, OF_J, 3)                                                  \
  X(PHI_JY, "phi_jy", FROM_DISPLACEMENT, OF_J, 4)                                                  \
  X(PHI_JZ, "phi_jz", FROM_DISPLACEMENT, OF_J, 5)                                                  \
  X(OMEGA_IX, "omega_ix", FROM_VELOCITY, OF_I, 3)                                                  \
  X(OMEGA_JX, "omega_jx", FROM_VELOCITY, OF_J, 3)

typedef enum ends_input {
#define X(code, name, array, owner, component) ENDS_##code,
  ENDS_INPUTS(X)
#undef X
      ENDS_COUNT
} ends_input;

/* Members of pl_strip, of each end where there are two; pl_bond_class; a bit of the flags. */
typedef enum ends_array {
  FROM_DISPLACEMENT,
  FROM_VELOCITY,
  FROM_CHORD,
  FROM_LENGTH,
  FROM_VOLUME,
  FROM_MASS,
  FROM_SHARE,
  FROM_SIZE, /* families: of a particle, over that of its bond class */
  FROM_CLASS,
  FROM_FLAGS,
  FROM_HELD, /* families: a particle's damage stays as it is */
  FROM_TIME
} ends_array;
typedef enum ends_owner { OF_I, OF_J, OF_BOND, OF_STRIP } ends_owner;

typedef struct ends_origin {
  const char *name;
  ends_array array;
  ends_owner owner;
  int component;
} ends_origin;
extern const ends_origin ends_origins[ENDS_COUNT];

/* The input node. Its placement follows from what it is: CLASS_CHORD on the body; HELD_I, VOLUME_I,
   MASS_I, SHARE_I and SIZE_I on the particle; all others on the bond. */
ir_node kinematics_input(ir *g, ends_input which);

/* `dt`, which is the same for all of a strip or run. It stands where the first thing stands that
   `prepare` does not know: on bonds, of laws of families on the particle, or on the point. */
ir_node kinematics_advance(ir *g, placement on);

/* asin(x)/x of the square of x, for |x| < 1/16. */
ir_node kinematics_arc_sine_ratio(ir *g, ir_node square);

typedef struct bond_kinematics {
  ir_node stretch, stretch_rate, theta_i, theta_j, length;
  ir_node s;                          /* reference length, m */
  ir_node e_x, e_y;                   /* present direction, i to j */
  ir_node per_length;                 /* 1/length, 1/m */
  ir_node theta_rate_i, theta_rate_j; /* rad/s */
  ir_node twist, twist_rate;          /* rad, rad/s; of bonds that do not twist IR_NONE */
} bond_kinematics;

/* 2D. The chord is the same along a strip, so what depends on it alone is hoisted. Without
   rotations the angles are IR_NONE. stretch = (2 C.du + du.du)/(s (L + s)): no cancellation for
   small displacements. The end rotations are those of the particles less the chord's, phi = atan2(C
   x c, C . c), wrapped to (-pi, pi]; with rotations it is expected (ir_expect) that chords move by
   less than a sixteenth of their length, and that angles stay below half a turn. The twist is the
   difference of the rotations about the bond. */
bond_kinematics kinematics_bond(ir *g, bool rotations, bool twists);

/* The bond to one neighbour of a family, in 2 or 3 dimensions; its chord is the same along a row.
   Rotations are of the plane (end_rotations.h has those in space).
   With `near` it is expected that bonds are nearly as long as at first (stretched by less than
   1/256). */
typedef struct family_kinematics {
  ir_node stretch, stretch_rate, length;
  ir_node per_length;   /* 1/length, 1/m */
  ir_node chord[3];     /* present chord, i to j, m */
  ir_node now[3];       /* present direction, i to j */
  ir_node reference[3]; /* reference direction */
  ir_node reference_chord[3];
  ir_node d[3];             /* relative displacement, m */
  ir_node theta_i, theta_j; /* rad, with rotations in the plane */
  ir_node theta_rate[2];    /* rad/s, of end i and j */
} family_kinematics;
family_kinematics kinematics_family(ir *g, int dimensions, bool rotations, bool near, bool listed);

/* Forces on end i and end moments (the particles receive the opposite of these):
   F_i = N e - V n, n = e turned by +90 degrees, V = (M_i + M_j)/L with the present L, which makes
   the bond's moment balance exact. M_i, M_j = IR_NONE: a central force. */
typedef struct bond_forces {
  ir_node f_x, f_y;           /* what particle i receives, and j the opposite */
  ir_node moment_i, moment_j; /* end moments: particles receive the opposite */
  ir_node twisting; /* the moment on end j about the bond; on i the opposite; or IR_NONE */
} bond_forces;
bond_forces kinematics_forces(ir *g, const bond_kinematics *k, ir_node N, ir_node M_i, ir_node M_j);

#endif
