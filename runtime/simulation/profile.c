#include "runtime/simulation/profile.h"

const char *const profile_names[PROFILE_PART_COUNT] = {
#define X(code, name) [PROFILE_##code] = name,
    PROFILE_PARTS(X)
#undef X
};
