/* Stress intensity factors of both modes from the interaction of a body's fields with those of a
   tip (tip_fields.h), over a box around it (Karlsson 2006, 3.5 with the indices of 3.30, 3.56, 3.57
   corrected; Attigui and Petit 1997). Per thickness, in axes along and across the crack, m = 1, 2:

     G_m = int -(s_ij e^m_ij + rho v_i v^m_i) q_,1 + (s^m_ij u_i,1 + s_ij u^m_i,1) q_,j
               + rho q (a^m_i u_i,1 + a_i u^m_i,1 - v_i,1 v^m_i - v_i v^m_i,1) dA,
     K_m = mu c_s^2 D/(v^2 a) G_m,    a of the mode

   a_i being the acceleration less gravity, div s = rho a, with a weight q that is 1 at the tip and
   0 on the box:

        2d                 pyramid   (1 - |x|/d)(1 - |y|/d)
     +--------+            plateau   f(|x|/d) f(|y|/d), f = 1 up to 1/2, then 2 - 2 r
     |   tip  | 2d
     |---o    |            A crack whose last leg has grown for less than d: the box begins 0.95 of
     +--------+            that behind the tip and is as long.
*/
#ifndef PERILAT_RUNTIME_INTERACTION_INTEGRAL_H
#define PERILAT_RUNTIME_INTERACTION_INTEGRAL_H

#include <stdbool.h>

#include "runtime/crack/tip_fields.h"

typedef enum box_weight { WEIGHT_PLATEAU, WEIGHT_PYRAMID } box_weight;

typedef struct tip_box {
  double at[2];         /* m: the tip */
  double angle;         /* rad, from x: of the crack's last leg */
  double behind, ahead; /* m: how far the box reaches along the crack */
  double across;        /* m: and to either side */
  box_weight weight;
} tip_box;

/* Half size d; `last`: length of the crack's last leg, m. Of a leg shorter than d the box is as
   small as the leg (`shrink`: of cracks that are there at the start), else it is moved ahead. */
tip_box tip_box_of(const double at[2], double angle, double half_size, double last, bool shrink,
                   box_weight weight);

/* q at a place of the body (0 outside), and its gradient along and across the crack, 1/m. */
double tip_box_weight(const tip_box *b, const double at[2], double gradient[2]);
/* Smallest box along x and y that holds it. */
void tip_box_extent(const tip_box *b, double lower[2], double upper[2]);

/* What the body has at a point, in the body's axes. */
typedef struct tip_point {
  double at[2], area;             /* m, m^2 */
  double gradient[2][2];          /* u_i,j */
  double stress[3];               /* xx, yy, xy, Pa */
  double velocity[2];             /* m/s */
  double velocity_gradient[2][2]; /* 1/s */
  double acceleration[2];         /* m/s^2, less gravity */
} tip_point;

/* K[0] of mode I, K[1] of mode II, Pa m^(1/2). The auxiliary fields are those of a tip of `speed`,
   of 0.01 c_s where that is less: the difference to rest is 1e-4. */
void tip_intensity(const crack_medium *m, const tip_box *b, const tip_point *points, int count,
                   double speed, double K[2]);

#endif
