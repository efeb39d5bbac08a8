#include "generator/report/print_quantity.h"

#include <math.h>
#include <stdio.h>

void print_quantity(const char *text, double value, const char *unit_name) {
  static const struct {
    double factor;
    const char *prefix;
  } scales[] = {{1e9, "G"}, {1e6, "M"}, {1e3, "k"}, {1, ""}, {1e-3, "m"}, {1e-6, "u"}, {1e-9, "n"}};
  size_t k = 0;
  while (k < 6 && fabs(value) < scales[k].factor)
    k++;
  printf("%s%.4g %s%s", text, value / scales[k].factor, scales[k].prefix, unit_name);
}
