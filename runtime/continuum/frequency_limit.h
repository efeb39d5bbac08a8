/* The highest natural frequency of a mesh, by power iteration on M^-1 K over its free freedoms. It
   is found from below: Rayleigh's quotient after `FREQUENCY_PRODUCTS` products lies a little under
   it. */
#ifndef PERILAT_RUNTIME_FREQUENCY_LIMIT_H
#define PERILAT_RUNTIME_FREQUENCY_LIMIT_H

#include "runtime/continuum/node_matrix.h"

enum { FREQUENCY_PRODUCTS = 60 };

/* rad/s; mass[nodes] kg; held[2 n + d]. Nodes without mass count as held. */
double frequency_limit(const node_stencil *k, const double *mass, const unsigned char *held);
double frequency_limit_of_matrix(const node_matrix *k, const double *mass,
                                 const unsigned char *held);

#endif
