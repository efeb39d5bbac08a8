/* The largest stable time step of a body, and what rules it. */
#ifndef PERILAT_RUNTIME_STEP_LIMIT_H
#define PERILAT_RUNTIME_STEP_LIMIT_H

#include <stdbool.h>

typedef struct step_limit {
  double limit;         /* s: largest stable step */
  double step;          /* s: chosen */
  double omega_max;     /* rad/s */
  double damping_ratio; /* of the ruling mode */
  const char *mode;     /* what rules: "translation" or "rotation", a body's mode */
  bool between;         /* instead, between bodies: "contact" or "a link" is faster than they are */
  bool at_surface;      /* the body as it stands has a faster mode than any wave of its lattice */
  double least; /* smallest eigenvalue of the virgin body over the largest; 0: none is negative */
  double prestrain; /* largest force on a particle at rest, over what the stiffest mode takes for a
                       way of a spacing: of the order of the rest stretch of its bonds */
} step_limit;

#endif
