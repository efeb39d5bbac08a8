/* Contact of particles with a stamp, a rigid body without particles: a particle is a ball of half
   its spacing, and as far as it lies in the stamp, w, it is pushed out along the normal n of the
   nearest point of the stamp's surface,

     f = k w n - c (v.n) n - k q,    W = k w^2/2 + k q^2/2,       v: of the particle past the stamp

   never pulled: the part along n is not negative. c is a part of the critical damping of the
   particle on its spring. q is how far the particle has been dragged along the surface; the spring
   gives way where it would push with more than mu times the part along n (Coulomb).

   Forces are added in the order of the particles. Particles near enough to matter in the next few
   steps are listed; what else is listed changes no force. */
#ifndef PERILAT_RUNTIME_STAMP_H
#define PERILAT_RUNTIME_STAMP_H

#include "runtime/body/body.h"
#include "runtime/geometry/surface.h"

typedef struct stamp_body {
  body *of;         /* it has outer forces (body_add_outer) */
  double stiffness; /* k of a particle, N/m */
  bool by_size;     /* that is k of the smallest, and it grows with a particle's own spacing */
} stamp_body;

typedef struct stamp_motion {
  double place[3];    /* m: from where it is drawn */
  double velocity[3]; /* m/s: of the step that led there */
} stamp_motion;

typedef struct stamp_load {   /* what the particles do to it */
  double force[3], moment[3]; /* N; N m about the middle of its surface's box */
  double stored;              /* J: W */
  double slipped;             /* J: taken by friction in the step */
  long touching;              /* particles */
  double largest;             /* N: the largest force of a particle */
} stamp_load;

typedef struct stamp stamp;

/* friction: mu; damping: c over the critical 2 sqrt(k m). */
stamp *stamp_new(const surface *s, const stamp_body *bodies, int count, double friction,
                 double damping);
void stamp_free(stamp *s);

/* Forces at the present places are added to the outer forces of the bodies. `step`, s: how long the
   step was that led there; 0: the state is found again, and nothing has been dragged. */
stamp_load stamp_find(stamp *s, const stamp_motion *at, double step);
/* W: what the forces found last do with the present velocities on each body, added to power[count];
   *damped: what damping takes of it. Returns the sum, less what they do on the stamp. */
double stamp_power(const stamp *s, const double velocity[3], double *power, double *damped);

/* m: the deepest that a particle lies in the stamp at the present places, and which; the number of
   those that lie in it by more than `least` of their spacings is returned. */
typedef struct stamp_inside {
  long count;
  double depth; /* m; negative: how far the nearest is away */
  int body;
  int32_t site;
} stamp_inside;
stamp_inside stamp_look_inside(const stamp *s, const double shift[3], double least);

/* m: how far particles of a body were dragged, [dimensions][particles]; NULL without friction. */
double *stamp_dragged_of(stamp *s, int body);
/* For saving a run: how far particles were dragged, *count numbers; NULL without friction. */
double *stamp_dragged(stamp *s, size_t *count);
double stamp_memory(const stamp *s); /* bytes */

#endif
