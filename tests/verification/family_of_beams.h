/* What theory and codes say of the beams of examples/families: b 120, h 260, d 240 mm, steel of
   414 MPa. Moments in kN m, forces in kN. */
#ifndef PERILAT_TESTS_FAMILY_OF_BEAMS_H
#define PERILAT_TESTS_FAMILY_OF_BEAMS_H

#include <math.h>

#define PI 3.14159265358979323846

static const double width = 0.120, depth = 0.240; /* m */
static const double yield = 414e6;                /* Pa */

static inline double steel_area(double bar_mm) {
  return PI / 4 * 1e-6 * bar_mm * bar_mm;
}

/* ACI 318: of a bar that yields, or has E_s times the strain at the crushing of the concrete. */
static inline double bending_moment(double bar_mm, double crushing) {
  const double area = steel_area(bar_mm), block = 0.85 * crushing * width, beta_1 = 0.85;
  double a = area * yield / block;
  const double ultimate = 0.003 * 200e9, c = a / beta_1;
  if (ultimate * (depth - c) / c < yield) { /* block beta_1 c^2 + ultimate area (c - depth) = 0 */
    const double p = ultimate * area / (block * beta_1);
    a = beta_1 * (-p + sqrt(p * p + 4 * p * depth)) / 2;
  }
  return 1e-3 * block * a * (depth - a / 2);
}

enum { SHEAR_BAR = 254, CRUSHING = 2758 }; /* tenths of mm, hundredths of MPa */

/* Zsutty (1968). */
static inline double zsutty(double a_over_d) {
  const double ratio = steel_area(SHEAR_BAR / 10.0) / (width * depth);
  const double v = 2.17 * cbrt(CRUSHING / 100.0 * ratio / a_over_d);
  return 1e3 * v * fmax(1, 2.5 / a_over_d) * width * depth;
}

/* CEB-FIP Model Code 1990, mean. */
static inline double model_code_90(double a_over_d) {
  const double ratio = steel_area(SHEAR_BAR / 10.0) / (width * depth);
  return 1e3 * 0.15 * cbrt(3 / a_over_d) * (1 + sqrt(0.2 / depth)) *
         cbrt(100 * ratio * CRUSHING / 100.0) * width * depth;
}

#endif
