#include "dsl/semantics/builtins.h"

#include <string.h>

const builtin_quantity_info builtin_quantities[QUANTITY_COUNT] = {
#define X(code, name, unit, shape, place, kinds, meaning)                                          \
  {name, unit, meaning, SHAPE_##shape, ON_##place, kinds},
    BUILTIN_QUANTITIES(X)
#undef X
};

const builtin_function_info builtin_functions[FUNCTION_COUNT] = {
#define X(code, name, least, most, meaning) {name, meaning, least, most},
    BUILTIN_FUNCTIONS(X)
#undef X
};

int builtin_quantity_find(const char *name) {
  for (int i = 0; i < QUANTITY_COUNT; i++)
    if (strcmp(builtin_quantities[i].name, name) == 0) return i;
  return -1;
}

int builtin_function_find(const char *name) {
  for (int i = 0; i < FUNCTION_COUNT; i++)
    if (strcmp(builtin_functions[i].name, name) == 0) return i;
  return -1;
}
