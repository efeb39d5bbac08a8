/* The parts of a kernel's text that are compiled at the same time, as PL_PART 0, 1, ..., and how
   its functions are shared among them. A text that does not say PL_PART is compiled whole.
   Functions of the parts are seen by all. */
#ifndef PERILAT_GENERATOR_KERNEL_PARTS_H
#define PERILAT_GENERATOR_KERNEL_PARTS_H

#include <stddef.h>

enum { KERNEL_PARTS = 2 };

struct c_text;

typedef struct kernel_parts {
  size_t length[KERNEL_PARTS]; /* of the functions so far */
  int part;                    /* of the function that is written */
  size_t start;                /* where it begins in the text */
} kernel_parts;

/* A function of the law, from its declaration to its end: `kind` void `name`(law, uniforms,
   `over`). It goes into the part that has the least so far. */
void kernel_function_begin(kernel_parts *p, struct c_text *out, const char *kind, const char *name,
                           const char *over);
void kernel_function_end(kernel_parts *p, struct c_text *out);

#endif
