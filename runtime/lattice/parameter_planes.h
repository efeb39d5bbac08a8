/* Parameters of a law that differ in space: planes of their values, on bonds for laws of bonds, on
   particles for laws of families. They come from random fields (random_field.h), and from
   materials, by formulas of the place, by files of places and by regions: a particle has the value
   at its place, of its region, a bond the mean of its ends'. The density stands on particles,
   whatever else does. */
#ifndef PERILAT_RUNTIME_PARAMETER_PLANES_H
#define PERILAT_RUNTIME_PARAMETER_PLANES_H

#include "runtime/deck/deck.h"
#include "runtime/kernel.h"
#include "runtime/lattice/rows.h"

/* What a &material with `region` says: values of all parameters of the law. */
typedef struct regional_values {
  const deck_material *material;
  double *parameters; /* [law->parameter_count] SI */
} regional_values;

/* Why values differ; formulas and files perhaps in regions. */
typedef enum plane_source {
  PLANE_BY_REGIONS,
  PLANE_BY_FORMULA,
  PLANE_BY_FILE,
  PLANE_AT_RANDOM
} plane_source;

typedef struct parameter_planes {
  int count;       /* of law->varying those that differ */
  int all;         /* law->varying_count: behind them some of these as they were a step ago */
  double **value;  /* [all], aligned, as the sweep has them (sweep.h): on particles [size], on bonds
                     [directions * size], of laws of families [2 directions * size]; the mean where
                     there is no particle or bond */
  double *density; /* [size] kg/m^3 of the particles; NULL where all have one */
  double *smallest, *largest; /* [count] of the particles or bonds there are, at all times */
  plane_source *source;       /* [count] */
  bool changing;              /* some change in time */
  double time, before;        /* s: of `value`, and of what stands there as it was a step ago */
  struct plane_clock *clock;  /* how they change; NULL where none does */
  size_t plane_size;          /* doubles of one of `value` */
  size_t bytes;
} parameter_planes;

/* Evaluates all that the deck says of the law of a material on the lattice. `parameters` are those
   of the material `whole`, `regional` those of the regions that have its law; those with a random
   field become its mean. `own`: [size] 1 where a particle is of the law, NULL: everywhere. NULL
   with diagnostics: a wrong unit, values that the law does not allow (with the place of the first),
   a place without one, two materials for one particle, a kernel that takes such a parameter as the
   same everywhere. */
parameter_planes *parameter_planes_new(const deck *k, int lattice, const deck_material *whole,
                                       const rows *w, const unsigned char *own, const pl_law *law,
                                       double *parameters, const regional_values *regional,
                                       int regional_count, diagnostics *d);
/* How many of law->varying stand there for the first time: behind them are some as they were a step
   ago. */
int parameter_planes_of(const pl_law *law);
/* The values of a time (s), a function of it alone. Nothing is allocated, and what stays is not
   touched. NULL is allowed. False where all stays. */
bool parameter_planes_go_to(parameter_planes *p, double time);
/* A step ends: what values are now they were a step ago. NULL is allowed. False where nobody reads
   those. */
bool parameter_planes_turn(parameter_planes *p);
/* How one of them changes in time. */
typedef enum plane_change { PLANE_STAYS, PLANE_CHANGES_ALIKE, PLANE_CHANGES } plane_change;
plane_change parameter_planes_change(const parameter_planes *p, int plane);
/* Times (s) up to `end` at which values that change are looked at before a run: evenly, and the
   corners of tables. Returns how many; *times is to be freed. */
int parameter_planes_times(const parameter_planes *p, double end, double **times);

/* Tells values of other files from each other; 0 without a file. */
uint64_t parameter_planes_fingerprint(const parameter_planes *p);
void parameter_planes_free(parameter_planes *p);

#endif
