/* Version of this program, from CMakeLists.txt. */
#ifndef PERILAT_GENERATOR_VERSION_H
#define PERILAT_GENERATOR_VERSION_H

#include "dsl/base/c_linkage.h"

C_LINKAGE_BEGIN
extern const char perilat_version[];

C_LINKAGE_END

#endif
