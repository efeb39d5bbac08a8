/* Where the hoop stress around a tip is largest, and how large (Erdogan and Sih 1963): the
   direction, in radians from the crack's own, and the stress intensity of pure mode I that has the
   same. */
#ifndef PERILAT_RUNTIME_HOOP_STRESS_H
#define PERILAT_RUNTIME_HOOP_STRESS_H

/* 2 atan2(-2 K_II, K_I + sqrt(K_I^2 + 8 K_II^2)); 0 of K = 0. */
double hoop_angle(const double K[2]);
double hoop_intensity(const double K[2], double angle);

#endif
