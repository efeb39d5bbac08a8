/* A Bravais lattice as rows: row r holds consecutive sites along the first lattice vector, all rows in one array
   with one pitch, so that the partner of site q in direction k is always q + offset[parity of the row][k]. One ghost
   row below and above and at least one ghost column at either end hold no bond; rows begin on aligned addresses.
   Sites cut away stay as absent sites. Each bond is owned by its lower (then left) end: a hexagonal lattice has 3
   directions. */
#ifndef PERILAT_RUNTIME_ROWS_H
#define PERILAT_RUNTIME_ROWS_H

#include <stdbool.h>
#include <stdint.h>

#include "runtime/deck.h"
#include "runtime/kernel.h"

#define ROWS_MAX_DIRECTIONS 16

typedef struct rows {
  int row_count;  /* rows with sites, without ghost rows */
  long pitch;     /* doubles between the starts of rows; multiple of PL_LANES */
  long size;      /* (row_count + 2) * pitch + PL_LANES: length of every site array (the far end
                                  of the last row's strips reaches one past the upper ghost row) */
  int dimensions; /* 2 */
  int directions; /* 3 */
  long offset[2][ROWS_MAX_DIRECTIONS];  /* [row parity][direction] */
  double chord[ROWS_MAX_DIRECTIONS][3]; /* reference chord from owner to partner, m (rotated) */
  double length[ROWS_MAX_DIRECTIONS];   /* m */
  double spacing, volume;     /* m, m^3 (stiffness thickness does not enter: mass thickness does) */
  double site_area;           /* m^2 of the plane that one site stands for */
  double stiffness_thickness; /* m: `t` of the laws */
  double mass, inertia;       /* set from rho by the simulation: kg, kg m^2 */
  int64_t *flags;             /* [size] PL_PRESENT, PL_PROTECTED of the owned bonds */
  uint64_t *bonds;            /* [size] bit k: the owned bond of direction k exists */
  uint64_t *held;             /* [size] 1: a protected particle, whose damage stays; 0 elsewhere */
  unsigned char *present;     /* [size] the site exists */
  double *x, *y, *z; /* [size] reference position, m (absent sites too); z NULL in the plane */
  long particle_count, bond_count;
  int32_t *
      particle_site; /* [particle_count] site of each particle, in row order: the order of results */
  int32_t *site_particle; /* [size] particle of each site, or -1 */
  double width, height;   /* extent of the present sites along x and y, m */
} rows;

/* First site of row r (0 .. row_count-1). */
static inline long rows_start(const rows *w, int r) {
  return (r + 1) * w->pitch;
}

/* Offset from a site of row r to its partner in an owned direction. */
static inline long rows_offset(const rows *w, int r, int direction) {
  return w->offset[r & 1][direction];
}

/* What a law is told about the bonds of one direction (directions .. 2 directions - 1: the opposites); masses as `mass` says. `area` is 0: no bars here. */
pl_bond_class rows_bond_class(const rows *w, int neighbour);

/* Sites that are inside or on the outlines of the bodies (tolerance 1e-6 spacing), less the notches; bonds between
   present neighbours whose chord crosses no notch. NULL on errors (a body without sites, a point body with no
   lattice site within its tolerance, too many sites), reported at the deck's line. */
rows *rows_build(const deck *k, int lattice, diagnostics *d);
void rows_free(rows *w);

/* Particles inside or on the shape, ascending; a point gives the nearest within its tolerance. `list` is malloc'ed.
   Returns the count. */
long rows_select(const rows *w, const deck_shape *shape, int32_t **list);

/* body[particle_count]: number, from 0 in the order of the deck, of the first body that each particle belongs to. */
void rows_bodies(const rows *w, const deck *k, int lattice, int32_t *body);

/* Protects every bond that touches a particle within `radius` (m) of one of the `particles`, and holds those particles. */
void rows_protect(rows *w, const int32_t *particles, long count, double radius);

/* Bond m of the results: its ends as particles and where its fields stand (direction * size + site). */
typedef struct rows_bond {
  int32_t i, j;
  int64_t slot;
} rows_bond;
/* All bonds in row order; malloc'ed, bond_count long. */
rows_bond *rows_bonds(const rows *w);

#endif
