#include "runtime/crack/hoop_stress.h"

#include <math.h>

#include "dsl/base/elementary.h"

double hoop_angle(const double K[2]) {
  if (K[0] == 0 && K[1] == 0) return 0;
  return 2 * pl_atan2(-2 * K[1], K[0] + sqrt(K[0] * K[0] + 8 * K[1] * K[1]));
}

double hoop_intensity(const double K[2], double angle) {
  return 0.25 * K[0] * (3 * pl_cos(angle / 2) + pl_cos(3 * angle / 2)) -
         0.75 * K[1] * (pl_sin(angle / 2) + pl_sin(3 * angle / 2));
}
