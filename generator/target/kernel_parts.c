#include "generator/target/kernel_parts.h"

#include <stdio.h>

#include "generator/target/words.h"

void kernel_function_begin(kernel_parts *p, c_text *out, const char *kind, const char *name,
                           const char *over) {
  char part[12];
  p->part = 0;
  for (int k = 1; k < KERNEL_PARTS; k++)
    if (p->length[k] < p->length[p->part]) p->part = k;
  p->start = out->length;
  snprintf(part, sizeof part, "%d", p->part);
  words_add(out, WORDS_OF(SAY_FUNCTION, kind, name, over, part));
}

void kernel_function_end(kernel_parts *p, c_text *out) {
  words_add(out, WORDS_OF(SAY_FUNCTION_END));
  p->length[p->part] += out->length - p->start;
}
