/* Curves, stacked areas and bands as SVG inside of a page, in colours that the page's style gives,
   with what its script needs to read values off them. The axes are those of pictures
   (plot_axes.h). */
#ifndef PERILAT_GENERATOR_PAGE_DIAGRAM_H
#define PERILAT_GENERATOR_PAGE_DIAGRAM_H

#include <stdbool.h>
#include <stdio.h>

typedef struct diagram_curve {
  const char *label;   /* of a legend; NULL: none */
  const double *x, *y; /* [count] SI; what is no number is a gap */
  long count;
  int ink;            /* number of its colour, from 0 */
  const char *series; /* what the page's data call its values; NULL: they hold none */
  const char *of;     /* in which result of the page: "a", "b" */
} diagram_curve;

typedef struct diagram {
  const char *title; /* for who cannot see it */
  const char *x_name, *x_unit, *y_name, *y_unit;
  const diagram_curve *curves; /* [count] */
  int count;
  bool stacked; /* areas, each between its curve and the one before it; the first one's from 0 */
  bool large;   /* over the whole width of the page: smaller letters beside the curves */
  const char *over; /* what the data call the values along x, "" the time; NULL without data */
} diagram;

/* False, with nothing written, where no value can be drawn. */
bool diagram_svg(FILE *out, const diagram *d);
/* The curves that have labels, the topmost area first. */
void diagram_legend(FILE *out, const diagram *d);

#endif
