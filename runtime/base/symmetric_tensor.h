/* Components of a symmetric tensor, their names and order: xx, yy, xy; in space xx, yy, zz, xy, yz,
   xz. A shear component is that of the tensor, half an engineering strain. */
#ifndef PERILAT_RUNTIME_SYMMETRIC_TENSOR_H
#define PERILAT_RUNTIME_SYMMETRIC_TENSOR_H

enum { TENSOR_MOST = 6 };

typedef struct tensor_component {
  const char *name;
  int first, second; /* directions of space */
} tensor_component;

/* In two or three dimensions; returns how many there are. */
int tensor_components(int dimensions, const tensor_component **components);
/* By its name, without regard to case; -1: there is none. */
int tensor_find(int dimensions, const char *name);
/* Whether `name` is "e_zz" where `names` has all other components of e: it is a deviator, which is
   kept without zz. Then how many characters "e" has, else 0. */
int tensor_traced(const char *name, const char *const *names, int count);

#endif
