/* This room: what happens at the tip of a crack. It knows no mesh, no deck, no law. Here the speeds
   of waves in a linear isotropic plate. */
#ifndef PERILAT_RUNTIME_WAVE_SPEEDS_H
#define PERILAT_RUNTIME_WAVE_SPEEDS_H

/* Of a plate in plane stress or strain by its stiffness: D11 = rho c_d^2, D33 = mu. */
typedef struct crack_medium {
  double mu, density;   /* Pa, kg/m^3 */
  double modulus;       /* Pa: E' of G = K^2/E'; E in plane stress, E/(1 - nu^2) in plane strain */
  double D11, D12;      /* Pa */
  double c_d, c_s, c_R; /* m/s: dilatational, shear, Rayleigh */
} crack_medium;

/* stiffness: D11, D12, D33 of an isotropic plate, Pa. The Rayleigh speed is the root of D(v) = 0
   below c_s, with D(v) = 4 a_d a_s - (1 + a_s^2)^2, a = sqrt(1 - v^2/c^2) (Rayleigh 1885; Freund
   1990). */
crack_medium crack_medium_of(double D11, double D12, double D33, double density);

/* D(v): 0 at rest and at the Rayleigh speed, positive between. */
double rayleigh_function(const crack_medium *m, double v);

#endif
