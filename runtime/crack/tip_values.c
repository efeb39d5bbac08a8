#include "runtime/crack/tip_values.h"

#define X(name, unit, words) #name,
const char *const tip_value_names[TIP_VALUE_COUNT] = {TIP_VALUES(X)};
#undef X
#define X(name, unit, words) unit,
const char *const tip_value_units[TIP_VALUE_COUNT] = {TIP_VALUES(X)};
#undef X
#define X(name, unit, words) words,
const char *const tip_value_words[TIP_VALUE_COUNT] = {TIP_VALUES(X)};
#undef X
