/* Texts that every emitted kernel begins with (built from the files themselves). */
#ifndef PERILAT_GENERATOR_PRELUDE_H
#define PERILAT_GENERATOR_PRELUDE_H

extern const char prelude_kernel_h[];
extern const char prelude_elementary_h[];
extern const char prelude_rectangle_h[];

#endif
