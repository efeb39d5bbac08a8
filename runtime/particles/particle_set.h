/* This room: what takes a body's place, particles that stand on no lattice and the sites that
   bodies take. Here the former: where they are and how much of the body each stands for. Two kinds
   of &lattice give such sets. `blue_noise` fills the bodies less the notches evenly but at random:
   darts of a falling least distance (McCool and Fiume 1992), then a few steps of Lloyd (1982) to
   the centroids of the particles' cells. `particles` reads a table or a result (particle_table.h).
   A volume that no file gives is that of the Voronoi cell, cut by the body (voronoi.h). */
#ifndef PERILAT_RUNTIME_PARTICLE_SET_H
#define PERILAT_RUNTIME_PARTICLE_SET_H

#include "dsl/base/diagnostics.h"
#include "runtime/deck/deck.h"

typedef struct particle_set {
  int dimensions; /* 2 or 3 */
  long count;
  double *at[3];  /* [count] m; at[2] is NULL in the plane */
  double *volume; /* [count] m^2 of the plane or m^3 of space */
  /* m, of nearest neighbours in the hexagonal or fcc lattice with as large particles: of the deck,
     or from the mean volume; where the deck grades it the smallest */
  double spacing;
  double *own; /* [count] m, the deck's spacing at each particle where it is graded; else NULL */
} particle_set;

/* Particles of the deck's lattice of that number, whose kind deck_lattice_is_irregular. The same
   bits for the same deck, whatever the threads. NULL with diagnostics: a body that holds no
   particle, more particles than can be stored, a file that cannot be read or holds what is no set
   of particles. */
particle_set *particle_set_make(const deck *k, int lattice, diagnostics *d);
/* Volumes of particles whose places are set: of their Voronoi cells, cut by the bodies and notches
   of the deck's lattice of that number. */
void particle_set_measure(particle_set *set, const deck *k, int lattice);
/* Of so many particles, all places and volumes 0. */
particle_set *particle_set_new(int dimensions, long count);
void particle_set_free(particle_set *set);

#endif
