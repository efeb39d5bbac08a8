#include "runtime/base/symmetric_tensor.h"

#include <stdbool.h>
#include <stdio.h>
#include <string.h>
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

static bool is_named(const char *name, int length, const char *component, const char *const *names,
                     int count) {
  bool found = false;
  for (int k = 0; k < count && !found; k++)
    found = strncmp(names[k], name, (size_t)length) == 0 && names[k][length] == '_' &&
            strcmp(names[k] + length + 1, component) == 0;
  return found;
}

const char *tensor_traced(const char *name, const char *const *names, int count, char *words,
                          size_t size) {
  const int length = (int)strlen(name) - 3;
  if (length < 1 || strcmp(name + length, "_zz") != 0) return NULL;
  for (int c = 0; c < TENSOR_MOST; c++) {
    const bool traced = strcmp(space[c].name, "zz") == 0;
    if (is_named(name, length, space[c].name, names, count) == traced) return NULL;
  }
  snprintf(words, size,
           "`%.*s` is a deviator, kept without zz = -(xx + yy): let the law give "
           "`output %s = %.*s[z,z]`",
           length, name, name, length, name);
  return words;
}
