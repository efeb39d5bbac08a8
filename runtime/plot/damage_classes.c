#include "runtime/plot/damage_classes.h"

#include <math.h>

const damage_class damage_classes[DAMAGE_CLASSES] = {
    {0.0, {0.80, 0.82, 0.85}, "sound", 0},     {0.3, {0.95, 0.80, 0.10}, "0 - 0.3", 0},
    {0.6, {0.95, 0.50, 0.05}, "0.3 - 0.6", 0}, {0.8, {0.55, 0.30, 0.10}, "0.6 - 0.8", 0},
    {1.0, {0.85, 0.05, 0.05}, "0.8 - 1", 0},   {INFINITY, {0, 0, 0}, "separated", 0}};

int damage_class_of(double damage) {
  enum { SEPARATED = DAMAGE_CLASSES - 1 };
  if (damage >= 1) return SEPARATED;
  int k = 0;
  while (k < SEPARATED - 1 && damage > damage_classes[k].up_to)
    k++;
  return k;
}
