/* How the ends of a bond in space have turned against it, as IR, and what acts on particles then.

   A particle's rotation is a rotation vector: it has turned by its length about it, however large.
   With the bond's direction e and length L now, and t_i, t_j the reference direction as it has
   turned with either particle,

     theta_i = a e x t_i                    a such that |theta_i| is the angle from e to t_i
     twist   = 2 asin(w . e)                w: vector of the unit quaternion from end i to end j

   so that motions in a plane give what bonds in a plane have (kinematics.h), a rotation of the
   whole bond gives nothing, and each is small without loss of digits where displacements are. With
   a law's N, M_i, M_j (across e) and T the bond's ends bear the moments

     m_i = A_i M_i + T u w x e - M e        A = h + k theta theta^T, h = |theta| cot|theta|,
     m_j = A_j M_j + T u w x e + M e        k = (1 - h)/|theta|^2, u = (1 - (w . e)^2)^(-1/2)
     M   = T u w_0 + (M_i . (theta_i x e) - M_j . (theta_j x e))/2

   and the force on i is N e - (m_i + m_j) x e/L. This is in balance to rounding, whatever the law
   says. Its work is N dL + M_i . d(theta_i) + M_j . d(theta_j) + T d(twist) as seen from the bond,
   exactly for laws whose moments derive from an energy, since the factors are the derivatives of
   the angles by the particles' rotations; for other laws up to M_i x theta_i + M_j x theta_j, which
   such an energy lets vanish. */
#ifndef PERILAT_GENERATOR_END_ROTATIONS_H
#define PERILAT_GENERATOR_END_ROTATIONS_H

#include "generator/lower/lowered.h"

/* In the plane theta_i[0] and theta_j[0] alone; all others are IR_NONE. */
typedef struct end_rotations {
  ir_node theta_i[BENDING_AXES], theta_j[BENDING_AXES], twist; /* rad */
  ir_node h[2], k[2];                                          /* of A_i and A_j */
  ir_node turn[3];                                             /* u w x e */
  ir_node along;                                               /* u w_0 */
} end_rotations;

/* In space, of a bond with that reference chord, relative displacement, present chord, direction
   and 1/length. With `near` it is expected that particles turn by less than a quarter of a radian,
   and ends against the bond by less than a sixteenth. */
typedef struct moving_chord {
  ir_node reference[3]; /* unit vector */
  ir_node d[3], chord[3], e[3];
  ir_node per_length;
} moving_chord;
end_rotations end_rotations_in_space(ir *g, const moving_chord *c, bool near);

/* What a bond does to its particles: the force on i (on j the opposite), and the moment m_i on its
   end i; the particle receives the opposite. */
typedef struct bond_actions {
  ir_node force[3], moment[BENDING_AXES];
} bond_actions;
bond_actions end_actions_in_plane(ir *g, const lowered_law *p, const ir_node *e,
                                  ir_node per_length);
bond_actions end_actions_in_space(ir *g, const lowered_law *p, const ir_node *e, ir_node per_length,
                                  const end_rotations *r);

#endif
