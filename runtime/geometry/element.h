/* Finite elements in the plane: triangles of 3 nodes, quadrilaterals of 4, triangles of 6. Corners
   stand counter-clockwise; of 6 nodes the last three are those of the sides 01, 12 and 20. Places
   in an element are u = (u, v), of a triangle u, v >= 0, u + v <= 1, of a quadrilateral -1 .. 1. */
#ifndef PERILAT_RUNTIME_ELEMENT_H
#define PERILAT_RUNTIME_ELEMENT_H

#include <stdbool.h>

enum { ELEMENT_MOST_NODES = 6, ELEMENT_MOST_POINTS = 6 };
/* Elements around a node: a double has a bit for each of those that begin with it
   (mesh_views.h). */
enum { ELEMENT_MOST_AROUND = 52 };

static inline int element_corners(int nodes) {
  return nodes == 4 ? 4 : 3;
}

/* Functions and their slopes along u and v. */
void element_functions(int nodes, const double u[2], double n[ELEMENT_MOST_NODES],
                       double slope[ELEMENT_MOST_NODES][2]);
/* Where u lies, m; returns the Jacobian d(x, y)/d(u, v), m^2. `along` (may be NULL):
   d x_i/d u_k. */
double element_map(int nodes, const double place[][2], const double u[2], double at[2],
                   double along[2][2]);
/* Functions at u, with their gradients in x and y, 1/m. */
void element_gradients(int nodes, const double place[][2], const double u[2],
                       double n[ELEMENT_MOST_NODES], double gradient[ELEMENT_MOST_NODES][2]);
/* The place u of a point; false where Newton's method finds none (far outside of a curved one). */
bool element_unmap(int nodes, const double place[][2], const double at[2], double u[2]);
/* How far u is outside of the element, in its own coordinates; negative inside. */
double element_outside(int nodes, const double u[2]);

/* The Jacobian is positive everywhere in the element. If not, *u is a place where it is not. */
bool element_is_sound(int nodes, const double place[][2], double u[2]);
double element_area(int nodes, const double place[][2]); /* m^2 */

/* Points of integration: 1 in a triangle of 3 nodes, 3 in one of 6, gauss x gauss (1 or 2) in a
   quadrilateral; weights sum to the area of the element's own domain. How many. */
int element_rule(int nodes, int gauss, double u[ELEMENT_MOST_POINTS][2],
                 double weight[ELEMENT_MOST_POINTS]);

/* The part of an element's mass at each node: row sums of the consistent matrix, of 6 nodes its
   diagonal scaled to the whole mass, which leaves all positive (Hinton, Rock and Zienkiewicz 1976).
   share[nodes]: m^2, together the area. */
void element_mass(int nodes, const double place[][2], double share[ELEMENT_MOST_NODES]);

#endif
