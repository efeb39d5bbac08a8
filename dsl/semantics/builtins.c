#include "dsl/semantics/builtins.h"

#include <string.h>

#include "dsl/base/elementary.h"

static double soft_sign(double x) {
  return x / (1 + pl_abs(x));
}

static double positive_part(double x) {
  return pl_max(x, 0);
}

const builtin_quantity_info builtin_quantities[QUANTITY_COUNT] = {
#define X(code, name, unit, shape, place, kinds, fixed, example, meaning)                          \
  {name, unit, meaning, example, SHAPE_##shape, ON_##place, kinds, fixed},
    BUILTIN_QUANTITIES(X)
#undef X
};

#define NO_VALUE .of_one = NULL
#define ONE(f)   .of_one = f
#define MANY(f)  .of_many = f
const builtin_function_info builtin_functions[FUNCTION_COUNT] = {
#define X(code, name, least, most, check, value, formula, example, meaning)                        \
  {name, meaning, example, formula, least, most, value},
    BUILTIN_FUNCTIONS(X)
#undef X
};

const char *builtin_laws(int kinds) {
  switch (kinds) {
  case IN_MICROPOLAR:
    return "micropolar";
  case IN_STATE:
    return "state";
  case IN_SLIP:
    return "slip";
  case IN_BOND:
    return "bonds";
  case IN_LATTICE:
    return "but slip";
  case IN_LATTICE | IN_CRACK:
    return "but slip, crack";
  case IN_ALL:
    return "all";
  case IN_CONTINUUM:
    return "continuum";
  case IN_CRACK:
    return "crack";
  case IN_ANY | IN_CONTINUUM:
    return "but crack";
  default:
    return "lattice";
  }
}

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
