/* A Bravais lattice (bravais.h) as rows: row r holds consecutive sites along the first lattice
   vector, all rows in one array with one pitch. In space the rows of a layer follow those of the
   layer below. Neighbour k of site q is always q + rows_offset(row, k): the number is the same
   along a row, and rows fall into one or two classes by their shift. Empty rows before the first,
   behind the last and between layers, and empty columns before each, which serve the row before,
   too, make every neighbour of every site of a row a place of the array. Nothing that an absent
   site's offset leads to is its neighbour by a bond that exists. Sites cut away stay as absent
   sites. Rows begin on aligned addresses.

   Three rows of three sites of a hexagonal lattice, o, and places without a site, . :

        row  3    . . . . .        margin
        row  2    . o o o .        class 0
        row  1     . o o o .       class 1: half a step further along
        row  0    . o o o .        class 0; begins at `first`, row 1 `pitch` later
        row -1    . . . . .        margin

   From a site of row 0 the neighbour up right is `pitch` further, from one of row 1 it is pitch +
   1; up left pitch - 1 and pitch. One offset serves the whole row, so that a loop over sites reads
   its neighbours with unit stride.

   Neighbours come in opposite pairs, neighbour k + directions opposite to neighbour k. The first
   `directions`, in the order of bravais_family, are those whose bonds a site owns: they lie in a
   higher layer, else in a higher row, else further along the row.

   Particles that stand on no lattice are rows with a list (scattered.h): sites of all rows one
   after the other, each with neighbours of its own. Particles, and with them results, are in the
   order of rows; on lists in that in which they were given. */
#ifndef PERILAT_RUNTIME_ROWS_H
#define PERILAT_RUNTIME_ROWS_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "dsl/base/c_linkage.h"
#include "runtime/deck/bravais.h"
#include "runtime/geometry/shape.h"
#include "runtime/kernel.h"

C_LINKAGE_BEGIN

/* Explicit neighbours, for particles that stand on no lattice. Each bond has an owner; among the
   bonds of a particle those it owns have different numbers below `directions`, those others own
   have different numbers from there on, and a bond that is number k at its owner is number k +
   directions at its other end: what rows have by themselves. Where there is no neighbour of a
   number, an absent site without bonds stands for it, at a chord of a spacing along x. */
typedef struct neighbour_list {
  int32_t *neighbour; /* [2 directions][size] how much further the neighbour stands than the site */
  uint64_t *incoming; /* [size] bit k: bond k + directions exists */
  double *length, *chord[3]; /* [2 directions][size] m; of reference chords to the neighbours */
  int32_t *alike; /* pl_family.alike and .way; NULL where particles stand on no lattice */
  pl_way *way;
} neighbour_list;

enum { ROWS_CLASSES = 2, ROWS_MAX_NEIGHBOURS = 2 * PL_MAX_DIRECTIONS };

/* Of a link: whose particle stands there, too; or a place of a lattice between several particles,
   which moves as their weighted mean, the heaviest first. */
enum { ROWS_MOST_COPIED = 4 };
typedef struct rows_copy {
  int32_t lattice, count;
  int32_t particle[ROWS_MOST_COPIED];
  double weight[ROWS_MOST_COPIED]; /* of sum 1 */
  bool along;                      /* it turns with a bar (tied.h): */
  int32_t at, before, after; /* particles of the bar: there; those that its tangent goes through */
  double ahead;              /* m: it is shown so far along the bar */
} rows_copy;

typedef struct rows {
  bravais infinite; /* the lattice without ends */
  int dimensions;   /* 2 or 3 */
  int row_count;    /* from the first with sites to the last, empty ones between layers included */
  int layer_rows;   /* rows from the first of a layer to the first of the next */
  int margin;       /* empty rows before the first, and as many behind the last */
  long pitch;       /* doubles between the starts of rows; multiple of PL_LANES */
  long first;       /* site at which row 0 starts */
  long size;        /* length of every site array */
  int directions;   /* owned bonds of a site of the infinite lattice: half the neighbours */
  long offset[ROWS_CLASSES][ROWS_MAX_NEIGHBOURS];
  unsigned char *row_class;           /* [margin + row_count + margin] */
  double chord[PL_MAX_DIRECTIONS][3]; /* reference chord from owner to partner, m (rotated) */
  double length[PL_MAX_DIRECTIONS];   /* m */
  double weight[PL_MAX_DIRECTIONS];   /* part of the partner's volume that lies in the horizon */
  int shell[PL_MAX_DIRECTIONS];       /* 1: of the nearest neighbours */
  double horizon;                     /* m; of particles of the size 1 (own_size) */
  double spacing, volume;     /* m, m^3 (stiffness thickness does not enter: mass thickness does) */
  double site_area;           /* m^2 of the plane that one site stands for; 0 in space, of chains */
  double stiffness_thickness; /* m: `t` of the laws; 0 in space and of chains */
  double area;                /* m^2: `area` of the laws; 0 but of chains */
  double mass, inertia;       /* kg, kg m^2: see rows_set_density; of the mean particle where they
                                 are not alike, the inertia always of the radius spacing/2 */
  neighbour_list *list;       /* NULL on lattices */
  double *site_volume, *site_mass; /* [size] m^3, kg; NULL where all particles are alike */
  /* [size] spacing of each particle over `spacing`, which is then the smallest; NULL where that is
     the same everywhere */
  double *own_size;
  double largest_size;    /* of these; 0 without */
  uint64_t *bonds;        /* [size] bit k: the owned bond k exists */
  uint64_t *held_bonds;   /* [size] bit k: the damage of the owned bond k stays as it is */
  uint64_t *held;         /* [size] 1: the particle is protected */
  unsigned char *present; /* [size] the site exists */
  double *x, *y, *z; /* [size] reference position, m (absent sites too); z is NULL in the plane */
  long particle_count, bond_count;
  rows_copy *copies;           /* [particle_count] of a link (linked.h); else NULL */
  int32_t *particle_site;      /* [particle_count] site of each particle, in the order of results */
  int32_t *site_particle;      /* [size] particle of each site, or -1 */
  double width, height, depth; /* extent of the present sites along x, y and z, m */
} rows;

/* A single row, of neighbours along it. */
static inline bool rows_are_chain(const rows *w) {
  return w->infinite.axes == 1;
}

/* First site of row r (0 .. row_count-1; in the margins, too). */
static inline long rows_start(const rows *w, int r) {
  return w->first + (long)r * w->pitch;
}

/* Row of a site of rows 0 .. row_count-1. */
static inline int rows_row(const rows *w, long site) {
  return (int)((site - w->first) / w->pitch);
}

/* From a site of the row to its neighbour in that direction, 0 .. 2 directions - 1. Not on
   lists. */
static inline long rows_offset(const rows *w, int row, int direction) {
  return w->offset[w->row_class[row + w->margin]][direction];
}

static inline long rows_partner(const rows *w, long site, int direction) {
  if (w->list) return site + w->list->neighbour[direction * w->size + site];
  return site + rows_offset(w, rows_row(w, site), direction);
}

/* The bond that the site owns in that direction exists. */
static inline bool rows_has_bond(const rows *w, long site, int direction) {
  return w->bonds[site] >> direction & 1;
}

/* Volume of a particle that its stresses act in, m^3: in the plane as thick as laws see it. On
   lists the mean. */
static inline double rows_stressed_mean(const rows *w) {
  return w->site_area > 0 ? w->site_area * w->stiffness_thickness : w->volume;
}

/* The same of a site's particle. */
static inline double rows_stressed_volume(const rows *w, long site) {
  const double V = w->site_volume ? w->site_volume[site] : w->volume;
  return w->site_area > 0 ? V / w->volume * w->site_area * w->stiffness_thickness : V;
}

/* Spacing of a site's particle, and the largest of all, m. */
static inline double rows_spacing(const rows *w, long site) {
  return w->own_size ? w->spacing * w->own_size[site] : w->spacing;
}
static inline double rows_largest_spacing(const rows *w) {
  return w->own_size ? w->spacing * w->largest_size : w->spacing;
}
/* The largest horizon, m. */
static inline double rows_largest_horizon(const rows *w) {
  return w->own_size ? w->horizon * w->largest_size : w->horizon;
}

/* Reference position of a site; at[2] is 0 in the plane. */
static inline void rows_place(const rows *w, long site, double at[3]) {
  at[0] = w->x[site];
  at[1] = w->y[site];
  at[2] = w->z ? w->z[site] : 0;
}

/* "(x, y) mm" or "(x, y, z) mm", as messages name a place of the lattice. */
enum { ROWS_PLACE_TEXT = 80 };
const char *rows_place_text(int dimensions, const double at[3], char text[ROWS_PLACE_TEXT]);

/* The bond to the neighbour in that direction, 0 .. 2 directions - 1, exists. */
static inline bool rows_has_neighbour(const rows *w, long site, int direction) {
  if (direction < w->directions) return rows_has_bond(w, site, direction);
  const int k = direction - w->directions;
  if (w->list) return w->list->incoming[site] >> k & 1;
  return rows_has_bond(w, rows_partner(w, site, direction), k);
}

/* Reference chord (m) from a site to its neighbour in that direction, 0 .. 2 directions - 1.
   Returns its length. */
static inline double rows_chord(const rows *w, long site, int direction, double chord[3]) {
  const int k = direction % w->directions;
  const double sign = direction < w->directions ? 1 : -1;
  for (int a = 0; a < 3; a++)
    chord[a] = !w->list            ? sign * w->chord[k][a]
               : a < w->dimensions ? w->list->chord[a][direction * w->size + site]
                                   : 0;
  return w->list ? w->list->length[direction * w->size + site] : w->length[k];
}

/* Number of bonds of a site. */
int rows_degree(const rows *w, long site);

/* Masses of all particles of a density (kg/m^3); a particle turns as a ball of half a spacing does,
   I = 2/5 m (s/2)^2 (Asadollahi 2014); on lists s is a spacing of its own, that of particles as
   large as itself. */
void rows_set_density(rows *w, double rho);
/* The same where each particle has a density of its own, [size]. `mass` and `inertia` are of one
   between the least and the largest. */
void rows_set_densities(rows *w, const double *rho);
/* The square of a particle's radius over that of a particle as large as `spacing`; 1 but on lists.
   So a particle's inertia is `inertia` times its mass over `mass` times this. */
double rows_radius_square(const rows *w, long site);

/* What a law is told about the bonds of one direction, 0 .. 2 directions - 1, wherever it is asked:
   in runs, in checks, by `drive` and `info`. Masses as `mass` says. On
   lists all are told the same, a bond of a spacing along x between particles of mean size, with the
   mean number of bonds, rounded. */
pl_bond_class rows_bond_class(const rows *w, int direction);

void rows_free(rows *w);

/* The same sites with these of their bonds alone: `bonds` [size] bits as of rows.bonds, taken over.
   All else stays that of `w`, which must stay; to be freed by rows_part_free. */
rows *rows_part(const rows *w, uint64_t *bonds);
void rows_part_free(rows *part);

/* Bond m of the results: its ends as particles and where its fields stand (direction * size +
   site). */
typedef struct rows_bond {
  int32_t i, j;
  int64_t slot;
} rows_bond;
/* All bonds, in the order of the particles that own them; malloc'ed, bond_count long. */
rows_bond *rows_bonds(const rows *w);

/* Tells lists of other particles or bonds from each other; 0 on lattices, which their decks
   describe. */
uint64_t rows_fingerprint(const rows *w);

/* --- for what builds rows: rows_build.h, and scattered.h for particles on no lattice --- */

/* `count` zeros of `each` bytes, aligned; NULL without memory. */
void *rows_array(long count, size_t each);
/* The arrays over sites of rows whose size and dimensions are set; false without memory. */
bool rows_new_sites(rows *w);
/* width, height and depth; bond_count. */
void rows_find_extent(rows *w);
void rows_count_bonds(rows *w);
/* Cuts the bonds that the site owns and that cross the shape. Returns how many do, whether they
   were cut before or not. */
long rows_cut(rows *w, long site, const deck_shape *shape);

C_LINKAGE_END

#endif
