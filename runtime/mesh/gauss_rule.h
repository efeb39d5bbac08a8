/* Points and weights of Gauss and Legendre on [-1, 1], which integrate polynomials up to degree
   2 order - 1 exactly. */
#ifndef PERILAT_RUNTIME_GAUSS_RULE_H
#define PERILAT_RUNTIME_GAUSS_RULE_H

enum { MESH_MOST_GAUSS = 6 };

/* `order` <= MESH_MOST_GAUSS places, ascending, and weights (sum 2). */
void gauss_rule(int order, double at[MESH_MOST_GAUSS], double weight[MESH_MOST_GAUSS]);

#endif
