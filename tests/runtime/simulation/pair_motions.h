/* Closed forms of what moves the pair (pair.h): a force on its right particle, or its weight. */
#ifndef PERILAT_TESTS_PAIR_MOTIONS_H
#define PERILAT_TESTS_PAIR_MOTIONS_H

#include "tests/runtime/simulation/pair.h"

static const double force = 100; /* N */
static const double rate = 3e4;  /* 1/s, of a damper */

#define PUSH   FIXED "&force region = 'right' component = 'x' total = 100 start = %.17g /\n"
#define WEIGHT FIXED "&gravity acceleration = 10, 0 start = %.17g /\n"

static inline double pushed(double t, double start) {
  return t < start ? 0 : force / stiffness() * (1 - cos(frequency() * (t - start)));
}

static inline double pushed_velocity(double t, double start) {
  return t < start ? 0 : force / stiffness() * frequency() * sin(frequency() * (t - start));
}

/* The support carries what the spring does. */
static inline double pushed_support(double t, double start) {
  return -stiffness() * pushed(t, start);
}

/* Damped from the beginning on. */
static inline double pushed_damped(double t, double start) {
  const double d = rate / 2, w = sqrt(frequency() * frequency() - d * d), since = t - start;
  return t < start ? 0
                   : force / stiffness() *
                         (1 - exp(-d * since) * (cos(w * since) + d / w * sin(w * since)));
}

static inline double fallen(double t, double start) {
  return t < start ? 0 : 10 / (frequency() * frequency()) * (1 - cos(frequency() * (t - start)));
}

#endif
