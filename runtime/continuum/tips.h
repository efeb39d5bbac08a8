/* The tips of a mesh's cracks: their stress intensities at every look, and how they grow.

   A look at the state t_n finds K_I and K_II of each tip (interaction_integral.h) from the body's
   fields there: displacements, accelerations a_n by the forces of the present places, and Newmark's
   velocities

     v_n = v_(n-1/2) + dt/2 a_n + dt (beta_1 - 1/2)(a_n - a_(n-1));

   of nodes that loads or supports act on by the last two velocities. Gravity g is a force on every
   point: the integral wants a_n - g. Looks are at steps n = L, 2L,
   ...; between two of them growing tips advance `updates` times. An advance at t_n comes after the
   forces there were found: those of t_(n+1) are the first to know of it.

   What the stiffness loses as a crack advances is energy that the crack has released:

     u_(n+1).(K - K_after) u_n/2,

   which the discrete balance of energies wants, and is u.(K - K_after) u/2 up to the length of a
   step.

   An end of a crack inside the mesh is a tip; one on its border, or on or in a hole, is not. A
   crack on an edge of the mesh, where this is half of a body and its mirror image, hides nothing:
   it is a free face, and its tip has the half of the box that lies in the mesh, which counts twice
   for K_I; K_II is 0. */
#ifndef PERILAT_RUNTIME_TIPS_H
#define PERILAT_RUNTIME_TIPS_H

#include "dsl/base/diagnostics.h"
#include "runtime/body/body.h"
#include "runtime/continuum/node_stencil.h"
#include "runtime/crack/interaction_integral.h"
#include "runtime/crack/tip_values.h"
#include "runtime/deck/deck.h"

/* What ends a tip. */
typedef enum tip_end {
  TIP_ALIVE,
  TIP_HAS_LEFT,
  TIP_HAS_MET,
  TIP_AT_HOLE,
  TIP_AT_ELEMENTS,
  TIP_AT_LAW,
  TIP_HAS_TOO_MANY,
  TIP_ENDS
} tip_end;
/* "has met another crack" */
extern const char *const tip_end_words[TIP_ENDS];

/* What is known of a tip at the last look. */
typedef struct tip_state {
  double at[2];                 /* m */
  double angle;                 /* rad, from x: of the last leg */
  double last;                  /* m: length of the last leg */
  double length;                /* m: of the crack's line up to here, from its other end */
  double K[2];                  /* Pa m^(1/2) */
  double speed;                 /* m/s */
  int64_t segments;             /* legs that have grown */
  int64_t grown, done;          /* it has grown; tip_end, when it grows no more */
  double begun_time, done_time; /* s: of the look at which it began to grow; 0 before */
  /* How its faces have overlapped: the least K_I of all looks, at most 0, and when that was; K_I
     and the time as it became negative, by more than a hundredth of that; the largest K_I in size.
     Pa m^(1/2), s */
  double least, least_time, first, first_time, largest;
} tip_state;

/* The law of a crack, with its parameters; NULL: it does not grow. */
typedef struct tip_law {
  const pl_law *law;
  const double *parameters;
} tip_law;

typedef struct mesh_tip {
  const deck_crack *of;
  bool at_start;                                   /* of the crack's first point */
  int number;                                      /* among the mesh's live tips */
  const pl_law *law;                               /* NULL: it does not grow */
  double toughness;                                /* Pa m^(1/2): the law's only one; 0: none */
  double *uniforms, *field, *new_field, *observed; /* of the law, each value PL_LANES times */
  tip_state now;
} mesh_tip;

/* What has grown, piece by piece. */
enum { TIPS_MOST_PIECES = 20000 };
typedef struct tip_pieces {
  int64_t count;
  crack_piece *items; /* [TIPS_MOST_PIECES] */
  int32_t *tip;       /* [TIPS_MOST_PIECES] whose */
  unsigned char *leg; /* [TIPS_MOST_PIECES] 1: a leg begins with it; 2: no path, but in a hole */
} tip_pieces;

typedef struct tips {
  mesh_tip *items;
  int count;
  crack_medium medium;
  int law; /* of the mesh's: that of the cells around the tips (tip_laws.h) */
  const deck_tips *options;
  double half_size;                        /* m */
  int64_t check_steps, update_steps, step; /* between looks and advances; done */
  int64_t first_step;                      /* no look before */
  int64_t planned[3];                      /* check_steps, update_steps, first_step as planned */
  double beta_1;                           /* of Newmark's method */
  double segment;                          /* m: least length of a leg */
  double lower[2], upper[2];               /* m: where cracks grow */
  double released;                         /* J: by growth, since the start */
  double rated;      /* J: the energy release rate over the ways of the tips */
  tip_pieces pieces; /* grown, in order */
  /* [nodes] of the state that is looked at: m/s; m/s^2, less gravity; velocities before the last
     step */
  double *velocity[2], *acceleration[2], *kept[2];
  unsigned char *loaded; /* [nodes] loads or supports act on it */
  tip_point *points;     /* room for those of a box */
  int room;
} tips;

/* The tips of the cracks of the mesh called `name`, which has these cracks already. NULL without
   cracks; none without tips. False after a diagnostic. */
bool tips_new(const deck *k, const char *name, mesh *m, tips **out, diagnostics *d);
void tips_free(tips *t);
/* What the interaction integral of a tip is over. */
tip_box tips_box(const tips *t, const mesh_tip *p);
/* The law around the tips, once it is known, those of the deck's cracks, and the step. */
void tips_take(tips *t, const deck *k, const plane_stiffness *law, double density,
               const tip_law *cracks, double time_step);

/* Steps are 1/`times` of those that it was told of: looks and advances come at the same times. */
void tips_shrink(tips *t, int64_t times);

/* Before a step moves the nodes: what a look will need. */
void tips_before(tips *t, const body *w, const node_stencil *k);
/* When the step n-1 -> n has moved them: the advance that was due at t_(n-1), then a look at t_n,
   if it is time for one. `m` and `k` are the mesh and its stiffness, which growth changes;
   last_resistance[2][layout.size]: K u at t_(n-1), N. */
void tips_after(tips *t, const body *w, double *const last_resistance[2], mesh *m, node_stencil *k);
/* A look at a body that stands still (static_solution.h). */
void tips_at_rest(tips *t, const body *w, const node_stencil *k);
/* After `pieces` was read from a checkpoint: the mesh and its stiffness as they were then. */
void tips_replay(tips *t, mesh *m, node_stencil *k);
/* Pieces of a tip so far: points of its path, in order; *at begins with where the tip was at the
   start. Returns how many points. */
int tip_path(const tips *t, int tip, double (*at)[2], int most);

/* What is known of a tip at the last look. */
double tip_value_now(const tips *t, const mesh_tip *p, tip_value which);
/* Whether the faces at a tip have overlapped by more than rounding and noise. */
bool tip_overlaps(const tip_state *p);
/* "notch", or "notch/start" of the first point of a crack with two tips. */
const char *tip_folder(const tips *t, int tip, char *text, size_t size);

#endif
