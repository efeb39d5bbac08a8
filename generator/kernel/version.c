#include "generator/kernel/version.h"
const char perilat_version[] = PERILAT_VERSION;
