/* Components of a symmetric tensor, their names and order: xx, yy, xy; in space xx, yy, zz, xy, yz,
   xz. A shear component is that of the tensor, half an engineering strain. */
#ifndef PERILAT_RUNTIME_SYMMETRIC_TENSOR_H
#define PERILAT_RUNTIME_SYMMETRIC_TENSOR_H

#include <stddef.h>

enum { TENSOR_MOST = 6 };

typedef struct tensor_component {
  const char *name;
  int first, second; /* directions of space */
} tensor_component;

/* In two or three dimensions; returns how many there are. */
int tensor_components(int dimensions, const tensor_component **components);
/* By its name, without regard to case; -1: there is none. */
int tensor_find(int dimensions, const char *name);
/* Where `name` is "e_zz" and `names` has all other components of e, which is a deviator then: that
   zz is not kept, and how it may be had, in words. Else NULL. */
const char *tensor_traced(const char *name, const char *const *names, int count, char *words,
                          size_t size);

#endif
