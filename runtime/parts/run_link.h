/* A link of a run at work: it finds the forces of its bonds on copies of the particles that it
   joins (linked.h), which then are forces on these like applied ones (loads.h).

   When a step has taken all bodies to t_(n+1), the copies are put where their particles are, and
   the link's law gives the forces of that instant. They act in the coming step, and are part of
   what is observed. What a link takes from the bodies, or gives them, is the work of its forces on
   them: the ledger of the link has it as external work with the opposite sign, so that in sum it
   goes out.

   All threads do this together, in stages; what they do does not depend on how many there are. */
#ifndef PERILAT_RUNTIME_RUN_LINK_H
#define PERILAT_RUNTIME_RUN_LINK_H

#include "runtime/parts/run_body.h"

/* What a copy follows: particles, and of one that turns with a bar that of the bar, those before
   and after it. */
typedef struct link_copy {
  const body *of, *bar;
  int count;
  int64_t site[ROWS_MOST_COPIED], at, before, after;
  double weight[ROWS_MOST_COPIED];
  double tangent[3]; /* in the reference state, through `before` and `after`, m */
  double ahead;      /* m */
  /* In the present state: */
  double way[PL_MAX_DOF], rate[PL_MAX_DOF]; /* of what it follows, m, m/s and rad, rad/s */
  double along[3];                          /* the bar's unit tangent */
  double chord, chord_rate[3];              /* from `before` to `after`: length m, m/s */
  double power; /* W: of its forces before and after the last step, with the present velocities */
} link_copy;

typedef struct run_link {
  run_body *own;     /* the body of copies, and what the law knows of the bonds */
  link_copy *copies; /* [particles of own] */
  /* [dimensions][particles of own] N: of places that turn with a bar, on the particle after; the
     opposite is on the one before */
  double *couple[3];
  int number;  /* of the run's links */
  double work; /* J: done on the link, by the ways that its particles have gone */
  bool known;  /* the forces of the present state are */
} run_link;

/* No link of bodies that are open reaches particles that ties move: its forces would not come to
   the mesh. Else false after messages at the links' lines. */
bool run_links_are_free(const run_body *bodies, int body_count, const deck *k, diagnostics *d);

/* The links among bodies that have begun; *count of them. Their forces become loads of the bodies
   that they join. */
run_link *run_links_new(run_body *bodies, int body_count, int *count);
void run_links_free(run_link *links, int count);

/* m: how far the place that this particle of a link to places is a copy of has slid along the bar's
   present tangent. */
double run_link_slip(const run_link *link, long particle);

/* Forces of the state that a run begins or goes on with; nothing where they are known. */
void run_link_begin(run_link *link);
/* Forces after a step of all bodies, and their work since the last state: all parts of a stage
   before the next one. The forces in the last one are known. */
enum { RUN_LINK_STAGES = 4 };
void run_link_step(run_link *link, int stage, int part, int parts);

#endif
