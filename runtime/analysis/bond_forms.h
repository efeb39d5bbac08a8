/* What a virgin bond of a law of bonds resists: quadratic forms of its stiffness and its dampers
   over (stretch, theta_i, theta_j), from the law's tangent at rest and its rate terms. A body whose
   bonds all have positive semidefinite forms is bounded by the infinite lattice: what is cut away
   took stiffness along. */
#ifndef PERILAT_RUNTIME_BOND_FORMS_H
#define PERILAT_RUNTIME_BOND_FORMS_H

#include <stdbool.h>

#include "runtime/kernel.h"
#include "runtime/lattice/parameter_planes.h"

enum { BOND_MOTIONS = 3 /* stretch, theta_i, theta_j; conjugate: N s, M_i, M_j */ };

/* Symmetric: J, and J s for dampers. */
typedef double bond_form[BOND_MOTIONS][BOND_MOTIONS];

typedef struct bond_forms {
  bond_form stiffness, damping; /* stiffness: no less than on any side of a kink at rest */
  bool damped;
  bool finite;
  bool definite; /* both positive semidefinite, to rounding */
} bond_forms;

/* Rate terms are looked at between the largest shortening and stretch without damage (at most 1 %).
   Those that stay below the elastic force however large the rate (friction-like) are exempt; any
   other counts with its largest slope. */
bond_forms bond_forms_of(const pl_law *law, const double *parameters, const pl_bond_class *bonds);

/* Forms that no bond exceeds whose varying parameters lie anywhere between the smallest and the
   largest of the fields: stiffness at corners and inside, dampers at the corners (with more than
   five fields: all or one of them at an end). */
bond_forms bond_forms_between(const pl_law *law, const double *parameters,
                              const pl_bond_class *bonds, const parameter_planes *fields);

/* No eigenvalue of a symmetric matrix, row by row, is below 0 by more than `tolerance` times the
   largest. */
bool form_is_definite(int order, const double *a, double tolerance);
/* a becomes as little larger as makes a - b positive semidefinite; what is less than a millionth
   leaves a as it is. */
void bond_form_raise(bond_form a, bond_form b);

#endif
