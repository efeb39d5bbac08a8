#include "runtime/crack/wave_speeds.h"

#include <math.h>

double rayleigh_function(const crack_medium *m, double v) {
  const double d = sqrt(1 - v * v / (m->c_d * m->c_d)), s2 = 1 - v * v / (m->c_s * m->c_s);
  return 4 * d * sqrt(s2) - (1 + s2) * (1 + s2);
}

crack_medium crack_medium_of(double D11, double D12, double D33, double density) {
  enum { HALVINGS = 100 };
  crack_medium m = {.mu = D33, .density = density, .D11 = D11, .D12 = D12};
  m.modulus = D11 - D12 * D12 / D11;
  m.c_d = sqrt(D11 / density);
  m.c_s = sqrt(D33 / density);
  double low = 0.5 * m.c_s, high = m.c_s;
  for (int k = 0; k < HALVINGS; k++) {
    const double middle = 0.5 * (low + high);
    if (rayleigh_function(&m, middle) > 0)
      low = middle;
    else
      high = middle;
  }
  m.c_R = low;
  return m;
}
