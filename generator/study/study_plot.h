/* A picture of a study's table: one of its columns over a key that was varied, a curve for each
   value of the others. */
#ifndef PERILAT_GENERATOR_STUDY_PLOT_H
#define PERILAT_GENERATOR_STUDY_PLOT_H

#include "runtime/plot/plot_curve.h"

/* o->x names a varied key ("lattice.rotation"), o->y a column of numbers ("stress peak"); labels
   are of the curves, one each. Cases without a value are left out. False after a message: no such
   columns, no numbers in them. */
bool study_plot(const char *path, const plot_curve_options *o, int label_count);

#endif
