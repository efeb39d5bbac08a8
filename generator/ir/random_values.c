#include "generator/ir/random_values.h"

#include <math.h>

#include "dsl/base/elementary.h"

uint64_t draw_bits(uint64_t *seed) {
  uint64_t z = *seed += UINT64_C(0x9e3779b97f4a7c15);
  z = (z ^ (z >> 30)) * UINT64_C(0xbf58476d1ce4e5b9);
  z = (z ^ (z >> 27)) * UINT64_C(0x94d049bb133111eb);
  return z ^ (z >> 31);
}

double draw_uniform(uint64_t *seed, double low, double high) {
  return low + (high - low) * (double)(draw_bits(seed) >> 11) * 0x1p-53;
}

double draw_size(uint64_t *seed, double low, double high) {
  double size = pl_pow(10, draw_uniform(seed, low, high));
  uint64_t choice = draw_bits(seed) % 16;
  return choice == 0 ? 0 : choice % 2 ? size : -size;
}

double draw_field(uint64_t *seed, const pl_field *field) {
  uint64_t choice = draw_bits(seed) % 4;
  if (field->kind == PL_FIELD_DAMAGE)
    return choice == 0 ? 0 : choice == 1 ? 1 : draw_uniform(seed, 0, 1);
  return field->initial + draw_size(seed, -8, -1);
}
