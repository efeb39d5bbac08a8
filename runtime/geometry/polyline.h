/* Open or closed lines of straight legs, in the plane or in space, and their division into equal
   parts. Lengths in m. */
#ifndef PERILAT_RUNTIME_POLYLINE_H
#define PERILAT_RUNTIME_POLYLINE_H

#include <stdbool.h>

/* Lengths that differ by less than this part are the same, where a deck means them to be. */
#define POLYLINE_ROUNDING 1e-6

typedef struct polyline {
  int dimensions, corners;
  const double *at; /* [corners][dimensions] */
  bool closed;      /* a last leg goes from the last corner to the first */
} polyline;

int polyline_legs(const polyline *p);
/* Length of leg k, from corner k to the next; its ends. */
double polyline_leg(const polyline *p, int k, const double **from, const double **to);
double polyline_length(const polyline *p);

/* The least distance of two lines, m: of this one from itself moved by `shift` ([3]). */
double polyline_apart(const polyline *p, const double shift[3]);

/* A part of a leg is as long as `spacing` as nearly as equal parts can be. */
long polyline_parts(const polyline *p, int leg, double spacing);

#endif
