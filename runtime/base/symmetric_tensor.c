#include "runtime/base/symmetric_tensor.h"

#include <strings.h>

static const tensor_component plane[] = {{"xx", 0, 0}, {"yy", 1, 1}, {"xy", 0, 1}},
                              space[] = {{"xx", 0, 0}, {"yy", 1, 1}, {"zz", 2, 2},
                                         {"xy", 0, 1}, {"yz", 1, 2}, {"xz", 0, 2}};

int tensor_components(int dimensions, const tensor_component **components) {
  *components = dimensions == 2 ? plane : space;
  return dimensions == 2 ? 3 : TENSOR_MOST;
}

int tensor_find(int dimensions, const char *name) {
  const tensor_component *t;
  const int count = tensor_components(dimensions, &t);
  for (int c = 0; c < count; c++)
    if (strcasecmp(t[c].name, name) == 0) return c;
  return -1;
}
