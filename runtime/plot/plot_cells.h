/* Meshes in a map: cells filled with the values of their nodes, lines of equal value, the outline,
   cracks. */
#ifndef PERILAT_RUNTIME_PLOT_CELLS_H
#define PERILAT_RUNTIME_PLOT_CELLS_H

#include "runtime/plot/canvas.h"
#include "runtime/plot/plot_mesh.h"

/* A place (X, Y) in m stands at x = origin_x + (X - left)*scale, y = origin_y - (Y - bottom)*scale.
   */
typedef struct map_place {
  double left, bottom, scale, origin_x, origin_y;
} map_place;

enum { CONTOURS_MOST = 64 };
/* Round values, about `wanted` of them between low and high. */
int contour_levels(double low, double high, int wanted, double levels[CONTOURS_MOST]);

colour contour_colour(int k, int count);

/* Nodes that have no number leave their cells without colour. */
void plot_cells_fill(canvas *c, const plot_meshes *m, const mesh_view *v, const map_place *at,
                     double low, double high);
void plot_cells_contours(canvas *c, const plot_meshes *m, const mesh_view *v, const map_place *at,
                         const double *levels, int count);
void plot_cells_outline(canvas *c, const plot_meshes *m, const mesh_view *v, const map_place *at);
/* Both faces where they have moved to: thick what was there at the beginning, thin what has grown.
   */
void plot_cells_cracks(canvas *c, const plot_meshes *m, const mesh_view *v, const map_place *at);
/* Samples of the lines, from x on; nothing without cracks. */
void plot_cells_crack_legend(canvas *c, const plot_meshes *m, double x, double y);
/* Whether some crack has grown. */
bool plot_cells_grown(const plot_meshes *m);

enum { CRACK_BEGUN_WIDTH = 6, CRACK_GROWN_WIDTH = 3 };

#endif
