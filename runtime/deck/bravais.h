/* Infinite Bravais lattices as layers of rows of sites; a chain is a single row. Site (column, row,
   layer) stands at
     origin + (column + shift) step[0] axis[0] + row step[1] axis[1] + layer step[2] axis[2],
   where the shift of a row is 0 or a half. In the plane there is layer 0 alone. Lengths in m. */
#ifndef PERILAT_RUNTIME_BRAVAIS_H
#define PERILAT_RUNTIME_BRAVAIS_H

#include <stdbool.h>

#include "dsl/base/c_linkage.h"
#include "runtime/deck/lattice_kind.h"
#include "runtime/kernel.h"

C_LINKAGE_BEGIN

/* Bonds join sites as far apart as the horizon and this part of it more. */
#define BRAVAIS_REACH_TOLERANCE 1e-3

/* Axes of a lattice. */
enum { BRAVAIS_COLUMN, BRAVAIS_ROW, BRAVAIS_LAYER };

typedef struct bravais {
  int dimensions;      /* of the space that its particles move in: 2 or 3 */
  int axes;            /* of the lattice that have sites: 1 to `dimensions` */
  double spacing;      /* of nearest neighbours */
  double origin[3];    /* of site (0, 0, 0) */
  double axis[3][3];   /* unit vectors along rows, across rows, across layers */
  double step[3];      /* from site to site, row to row, layer to layer */
  double square[3];    /* of the steps, in spacings: exact */
  int shift_by[2];     /* half steps by which a row, a layer is shifted against the one before */
  double site_measure; /* m of a chain, m^2 of the plane, m^3 of space that a site stands for */
} bravais;

typedef struct bravais_neighbour {
  int halves;     /* half steps along the row */
  int row, layer; /* rows and layers from here to there */
  double square;  /* of the distance, in spacings */
  int shell;      /* 1: the nearest neighbours, ... */
} bravais_neighbour;

/* Dimensions of a kind of lattice by its name in decks: 2, 3; 0 for none that has sites. */
int bravais_dimensions(const char *kind);

/* False for a kind that has no sites, or is not known. */
bool bravais_of(const deck_lattice *l, bravais *b);

/* 1 when the sites of the row stand half a step further along it, else 0. */
int bravais_shift(const bravais *b, long row, long layer);
void bravais_place(const bravais *b, long column, long row, long layer, double at[3]);
/* In steps along the row, across rows, across layers; without the row's shift. */
void bravais_coordinates(const bravais *b, const double at[3], double out[3]);
double bravais_distance(const double p[3], const double q[3]);

/* One of each pair of opposite neighbours, that which lies in a higher layer, else in a higher row,
   else further along the row: nearest first, then by layer, by row, and from far to near along the
   row. `horizon` is in spacings; 0: `shells` decides; both 0: the nearest neighbours. Returns how
   many there are, which may be more than are written. */
int bravais_family(const bravais *b, double horizon, int shells,
                   bravais_neighbour list[PL_MAX_DIRECTIONS]);

/* The hexagonal lattice of nearest neighbours, on which laws of bonds run bond by bond. */
bool bravais_is_hexagon(const deck_lattice *l);

/* From a site to its neighbour. */
void bravais_chord(const bravais *b, const bravais_neighbour *n, double chord[3]);

C_LINKAGE_END

#endif
