/* Fields near the tip of a crack that runs steadily, in axes 1 along the crack and 2 across it, the
   tip at the origin (Freund 1990, 4.3; Karlsson 2006, 3.4 and appendix A, with A.14 as +2 a_s a_d
   and A.17, A.18 derived anew). With S_b = sqrt(x + i a_b y) and C = 2/(mu D(v) sqrt(2 pi)), of a
   unit stress intensity factor:

     I    u_1 = C Re[(1 + a_s^2) S_d - 2 a_d a_s S_s]   u_2 = C Im[-a_d (1 + a_s^2) S_d + 2 a_d S_s]
     II   u_1 = C Im[2 a_s S_d - a_s (1 + a_s^2) S_s]   u_2 = C Re[2 a_s a_d S_d - (1 + a_s^2) S_s]

   Steady: du/dt = -v u_,1. */
#ifndef PERILAT_RUNTIME_TIP_FIELDS_H
#define PERILAT_RUNTIME_TIP_FIELDS_H

#include "runtime/crack/wave_speeds.h"

typedef struct tip_field {
  double u[2];              /* m per Pa m^(1/2), as all of these */
  double gradient[2][2];    /* u_i,j */
  double stress[3];         /* 11, 22, 12 */
  double velocity[2];       /* m/s */
  double velocity_slope[2]; /* du_i/dt,1 */
  double acceleration[2];   /* m/s^2 */
} tip_field;

/* mode 1 or 2, at (x, y) from the tip, of a crack of speed v, 0 < v < c_R. */
tip_field tip_field_at(const crack_medium *m, int mode, double v, double x, double y);

/* Energy release rate of K[2] at speed v (N/m); K^2/E' as v goes to 0. */
double tip_energy_release(const crack_medium *m, double v, const double K[2]);
/* mu c_s^2 D/(v^2 a): K of that mode from its interaction integral. */
double tip_factor(const crack_medium *m, int mode, double v);

#endif
