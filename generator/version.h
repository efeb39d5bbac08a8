/* Version of this program, from CMakeLists.txt. */
#ifndef PERILAT_GENERATOR_VERSION_H
#define PERILAT_GENERATOR_VERSION_H
extern const char perilat_version[];
#endif
