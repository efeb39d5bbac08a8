/* Forces of nodes of a traction on a straight line: F_I = t integral of N_I times the traction, on
   an edge or inside. The line is cut at the borders of cells, each piece has four Gauss points
   (Karlsson 2006, 2.7). */
#ifndef PERILAT_RUNTIME_LINE_LOAD_H
#define PERILAT_RUNTIME_LINE_LOAD_H

#include "runtime/mesh/moving_least_squares.h"

/* At a point of integration of the line, whose part of the line has `area` (m^2): the functions of
   the nodes. */
typedef void line_visitor(void *context, const double at[2], double area, const point_shape *s);
/* Visits all that lie in the mesh; returns their length, m. */
double line_visit(const mesh *m, const double from[2], const double to[2], line_visitor *visit,
                  void *context);

/* Traction (Pa) at a point of the line. */
typedef void (*line_traction)(void *context, const double at[2], double traction[2]);

/* Adds to force[2][nodes] (N); node n of direction d at force[d][n]. Parts of the line outside the
   mesh or in its holes bear nothing. Returns the length that lies in the mesh, m. */
double line_load(const mesh *m, const double from[2], const double to[2], line_traction traction,
                 void *context, double *const force[2]);

#endif
