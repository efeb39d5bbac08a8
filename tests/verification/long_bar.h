/* Closed form of a bar of 12.7 mm without end, pulled out of rigid concrete of 27.58 MPa. */
#ifndef PERILAT_TESTS_LONG_BAR_H
#define PERILAT_TESTS_LONG_BAR_H

#include <math.h>

static const double bar_E = 200e9, bar_diameter = 0.0127;

static inline double bar_area(void) {
  return M_PI / 4 * bar_diameter * bar_diameter;
}

/* fib Model Code 2010, table 6.1-1: tau_max (s/s_1)^0.4, with a line of 200 MPa/mm before it. */
static const double bond_line = 200e9, bond_s_1 = 1e-3;

static inline double bond_tau_max(void) {
  return 2.5 * sqrt(27.58) * 1e6;
}

/* m: slip where the line ends. */
static inline double bond_line_end(void) {
  return pow(bond_tau_max() / (bond_line * pow(bond_s_1, 0.4)), 1 / 0.6);
}

/* N: at a slip u of its end, between the line and s_1. F^2 = 2 E A pi d * integral of tau over
   slip. */
static inline double long_bar_force(double u) {
  const double line = bond_line_end(),
               under = bond_line * line * line / 2 +
                       bond_tau_max() / pow(bond_s_1, 0.4) / 1.4 * (pow(u, 1.4) - pow(line, 1.4));
  return sqrt(2 * bar_E * bar_area() * M_PI * bar_diameter * under);
}

#endif
