/* A bond drawn out, or a point pulled along x with its sides free, from nothing to a strain of 1:
   the stress over the strain, and what it shows. */
#ifndef PERILAT_GENERATOR_SENSE_RESPONSE_H
#define PERILAT_GENERATOR_SENSE_RESPONSE_H

#include "generator/sense/sense_bench.h"

enum { RESPONSE_STEPS = 290 };

typedef struct response {
  int count;
  double strain[RESPONSE_STEPS], stress[RESPONSE_STEPS]; /* of bonds the force, N */
  double stiffness;                                      /* at first: stress over strain */
  int limit;   /* the first step off that line by a tenth, -1 without one */
  int peak;    /* of the largest stress, -1 where it only grows */
  double area; /* below the curve */
  double size; /* of the point's cell, m */
} response;

/* With these parameters (SI); `sign` 1 in tension, -1 in compression: strain and stress are their
   sizes. False where the law is one of families, slip or cracks, or no such state is found. */
bool response_of(const sense_bench *b, const double *parameters, int sign, response *r);

#endif
