/* A path as a function of time: values, slopes, corners, and the times at which it is evaluated. */
#ifndef PERILAT_GENERATOR_DRIVE_MOTION_H
#define PERILAT_GENERATOR_DRIVE_MOTION_H

#include "generator/drive/drive_path.h"

/* Value at a time, and the slope there, which is taken at a time between two steps. */
double drive_at(const drive_input *in, drive_quantity q, double time);
double drive_slope(const drive_input *in, drive_quantity q, double time);
bool drive_prescribes(const drive_input *in, drive_quantity q);
/* Times within the path at which one of its pieces begins, ends or has a corner, ascending;
   malloc'ed. */
double *drive_corners(const drive_input *in, long *count);
/* Times from 0 to the end at which the bond is evaluated, ascending: even steps, the corners of the
   path and the times that expectations name; malloc'ed. */
double *drive_times(const drive_input *in, long *count);
double drive_end(const drive_input *in);
/* First time from `after` on at which the stretch takes the value, or NaN. */
double drive_time_of_stretch(const drive_input *in, double stretch, double after);

#endif
