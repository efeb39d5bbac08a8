/* Stamps in maps of bodies in the plane: grey solids beneath the particles. */
#ifndef PERILAT_RUNTIME_PLOT_STAMPS_H
#define PERILAT_RUNTIME_PLOT_STAMPS_H

#include "runtime/plot/canvas.h"
#include "runtime/plot/plot_cells.h"
#include "runtime/result/result_file.h"

typedef struct plot_stamp {
  double *outline; /* [count][2] m: where it is drawn */
  long count;
  double way[2]; /* m: from there, in the frame */
} plot_stamp;

typedef struct plot_stamps {
  plot_stamp *items; /* [count] */
  int count;
} plot_stamps;

/* Of a frame, counted from the end where it is negative; none of a result without, or of bodies in
   space. False where there is no such frame, or the result is damaged. */
bool plot_stamps_read(plot_stamps *s, result_file *f, long frame);
void plot_stamps_free(plot_stamps *s);

/* Where ways are shown `factor` times as long: the rectangle from low to high, m, becomes one that
   holds all of them. */
void plot_stamps_reach(const plot_stamps *s, double factor, double low[2], double high[2]);
/* Within a rectangle of the picture's places, low to high, m. */
void plot_stamps_draw(canvas *c, const plot_stamps *s, double factor, const map_place *at,
                      const double low[2], const double high[2]);

#endif
