/* What a path prescribes at a point of a continuum: of each component the strain or the stress; and
   the strains that give such stresses, by Newton's method with the law's own tangent. */
#ifndef PERILAT_GENERATOR_POINT_CONTROL_H
#define PERILAT_GENERATOR_POINT_CONTROL_H

#include "generator/drive/drive_path.h"
#include "generator/drive/driven_point.h"

typedef struct point_control {
  int strains;
  bool by_stress[PL_MAX_STRAINS]; /* else by strain */
  int follows[PL_MAX_STRAINS];    /* the drive_quantity whose paths it takes, or -1: it is 0 */
  span where[PL_MAX_STRAINS];     /* what says so */
  double stiffness;               /* Pa: largest entry of the first tangent */
  double size;                    /* Pa: largest stress asked for or borne so far */
} point_control;

/* False, with a message, where the path and its test do not go together. */
bool point_control_read(const drive_input *in, int dimensions, point_control *out, diagnostics *d);

/* The strains at a time, and the stress there. Rates are taken just beside it, `inside` of the step
   that ends there; those of strains that are found are their change since `before` over the step.
   Without `before` the path begins: the point was at rest, and what resists rates has not yielded.
   The point's fields wait to be accepted. False, with a message, where no strain gives these
   stresses. */
bool point_control_reach(point_control *c, const drive_input *in, driven_point *p, double time,
                         double inside, const strained *before, strained *to, stressed *answer,
                         diagnostics *d);

#endif
