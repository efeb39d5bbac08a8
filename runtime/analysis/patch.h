/* A small periodic piece of a lattice, and a law of families on it: the particles are moved at
   will, and the law's passes give forces, new fields and what is observed. Without loads, time or
   files: for force constants, checks of laws and single particles.

   Sites stand in one array, whole multiples of the primitive vectors; a margin on all sides repeats
   what is inside, so that neighbour k is an offset away everywhere. Arrays begin at the first site;
   values toward neighbours have a plane of `size` for each. */
#ifndef PERILAT_RUNTIME_PATCH_H
#define PERILAT_RUNTIME_PATCH_H

#include "runtime/lattice/rows.h"

typedef struct patch {
  const pl_law *law;
  const rows *lattice;
  double primitive[3][3];          /* m */
  long cell[PL_MAX_DIRECTIONS][3]; /* chords as multiples of the primitive vectors */
  long margin[3], period[3];       /* period in primitive vectors */
  long width[3];                   /* sites along each of them, with the margins */
  long offset[2 * PL_MAX_DIRECTIONS];
  long sites, lead, size; /* in the lattice; before the first, in an array */
  long first, count;      /* what the passes run over: all that is inside */
  long *inside, inside_count;
  long *image;            /* [sites] the site inside that this one repeats */
  double *uniforms;       /* [neighbours][uniform_count] */
  uint64_t *bonds, *held; /* [size] as in pl_family */
  double *displacement[PL_MAX_DOF], *velocity[PL_MAX_DOF], *force[PL_MAX_DOF];
  double *shape[PL_SHAPE_PLANES(3)];
  double **parameter;          /* [varying] the same everywhere */
  double *share;               /* 1 everywhere */
  double *mass;                /* that of the lattice everywhere */
  double **field, **new_field; /* [fields] at hand; of the last step */
  double **link, **bond_link;
  double **sum;       /* of laws whose bonds add to both ends (pl_family) */
  uint64_t *marks[3]; /* [size] of all fields: filled everywhere, settled nowhere */
  double **observed;  /* [observed_count] */
  int observed_count;
  double time_step, advance; /* s, as of pl_family; `advance` is 0 until it is set */
} patch;

/* Margins that the law's patch of the lattice has: how far its chords reach. */
void patch_margins(const pl_law *law, const rows *w, long margin[3]);

/* All bonds there, nothing held, fields as they begin, nothing displaced. `more` planes of
   particles and `wide` of neighbours are kept for values observed beyond the law's own outputs. */
patch *patch_new(const pl_law *law, const double *parameters, const rows *w, const long period[3],
                 int more, int wide);
void patch_free(patch *p);

void patch_prepare(patch *p, const double *parameters);
void patch_virgin(patch *p); /* fields as they begin */

/* Site of whole coordinates inside: 0 .. period - 1 each. */
long patch_site(const patch *p, const long at[3]);
/* Reference position of a site (m) from the first one inside. */
void patch_position(const patch *p, long site, double at[3]);
/* Neighbour k of a site inside, as a site inside. */
long patch_neighbour(const patch *p, long site, int k);
bool patch_has_bond(const patch *p, long site, int k);
/* Takes the bond away, on all its images. */
void patch_cut(patch *p, long site, int k);

/* A value, or one plane, of all images as inside. */
void patch_repeat(const patch *p, double *values);
/* values[d] becomes the gradient (per m of reference) times position, and `part` (at the sites
   inside; NULL: nothing) repeated. For displacements and velocities; rotations stay. */
void patch_deform(const patch *p, const double gradient[3][3], double *const *part,
                  double *const *values);

/* Forces inside and new fields. */
void patch_step(patch *p);
/* What the law observes with the fields at hand. */
void patch_observe(patch *p);
/* The new fields become those at hand. */
void patch_accept(patch *p);

/* Doubles of a field (or an output) there, planes included. */
long patch_planes(const patch *p, const pl_field *f);

#endif
