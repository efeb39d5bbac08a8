/* The functions of a kernel, as roots in one graph: what each reads, writes and costs. The emitter
   writes them as C, the interpreter evaluates them; both walk the same nodes. */
#ifndef PERILAT_GENERATOR_PLAN_H
#define PERILAT_GENERATOR_PLAN_H

#include "generator/lower/kinematics.h"
#include "generator/lower/lower.h"
#include "generator/plan/segment.h"
#include "runtime/kernel.h"

/* Programs over strips, of one pass with one segment. X(program, member of pl_law) */
#define STRIP_PROGRAMS(X)                                                                          \
  X(PROGRAM_STEP, rows)                                                                            \
  X(PROGRAM_LEDGER, rows_ledger)                                                                   \
  X(PROGRAM_OBSERVE, rows_observe)

/* Programs over points, likewise. */
#define POINT_PROGRAMS(X)                                                                          \
  X(PROGRAM_STEP, point_step)                                                                      \
  X(PROGRAM_LEDGER, point_ledger)                                                                  \
  X(PROGRAM_OBSERVE, point_observe)                                                                \
  X(PROGRAM_TANGENT, point_tangent)

/* Those that there are for whole rectangles, too. */
#define RECTANGLE_PROGRAMS(X)                                                                      \
  X(PROGRAM_STEP, rectangle_step)                                                                  \
  X(PROGRAM_LEDGER, rectangle_ledger)

/* The program over tips. */
#define TIP_PROGRAMS(X) X(PROGRAM_STEP, tip_look)

typedef enum program_task {
  PROGRAM_STEP, /* forces and new fields */
  /* The same, and the energies that are lost; of families the latter: passes that follow those of a
     step. */
  PROGRAM_LEDGER,
  PROGRAM_OBSERVE,     /* stored energy and outputs */
  PROGRAM_FORCE_STATE, /* of families: new fields and force states, family by family */
  PROGRAM_STATES,      /* a bond alone, state by state (pl_states) */
  PROGRAM_TANGENT,     /* its derivatives; of points the tangent */
  PROGRAM_BOUNDS,      /* of parameters */
  PROGRAM_SIZE_BOUNDS, /* of the size of cells */
  PROGRAM_DEFAULTS,    /* of parameters, those that read others */
  PROGRAM_COUNT
} program_task;

/* Inputs of a segment, by source: IR_FROM_PARAMETER and, of IR_FROM_QUANTITY, what a bond class
   knows (s, spacing, t, V, m, m_i, m_j, area, shell, n): through uniforms. Of IR_FROM_QUANTITY
   stretch, stretch_rate, theta_i, theta_j, length: only in PROGRAM_STATES and PROGRAM_TANGENT,
   planes of pl_states.in. IR_FROM_FIELD k: field[k]. IR_FROM_ENDS: all bodies.
   IR_FROM_BOND_PARAMETER k: in strips and families parameter[k], the value of parameter varying[k]
   in each bond, IR_FROM_PARTICLE_PARAMETER k: of each particle; all other programs take that
   parameter as IR_FROM_PARAMETER. The graph does not know of absent bonds; protection is in it
   (ENDS_PROTECTED), because the force must use the damage that stays. */

enum { PLAN_MOST_PASSES = 8 }; /* of a program */
/* Operations of a loop, those of functions counted, above which it is large. */
enum { PLAN_LARGE = 4000 };

/* Whether loops over strips are cut into stages (stages.h). Results are the same to the bit. */
typedef enum loop_cutting {
  CUT_BY_COST,
  CUT_NEVER, /* unless something is expected (ir_expect) */
  CUT_ALWAYS /* into stages as short as they can be */
} loop_cutting;

/* How the loops of `step` are written, and with it all others. */
typedef enum kernel_form {
  FORM_STRIPS, /* loops over strips of bonds, which leave forces for both ends */
  FORM_LOOPS,  /* families by loops over particles and neighbours, any number of these */
  /* One loop over the particles, neighbour by neighbour in its body: law->neighbours of them */
  FORM_UNROLLED,
  FORM_PAIRS,  /* loops over bonds that add to both ends (SHARE_PAIRS) */
  FORM_POINTS, /* loops over points of a continuum */
  FORM_TIPS    /* loops over tips of cracks */
} kernel_form;

typedef struct kernel_plan {
  const law *law;
  law_variation variation; /* what differs in space */
  ir *graph;
  kernel_form form;
  kernel_program programs[PROGRAM_COUNT]; /* without passes: there is none */
  loop_cutting cutting;
  int dimensions, dof, force_planes;
  int rotations;     /* of a particle of a family, behind its dimensions: dof in all */
  ir_node *uniforms; /* [uniform_count] ascending: values hoisted into `prepare`. All nodes, inputs
                        too but no constants, with ir_place <= ON_BODY that a local node or a root
                        of a program other than PROGRAM_BOUNDS reads directly: a loop reads
                        uniforms[k] and nothing before it */
  int uniform_count;
  double flops_per_bond, divisions_per_bond; /* of `step`, without what is hoisted */
  /* Some loop has so many operations, hundreds of cases for instance, that a C compiler takes more
     than linear time on it: it is written and compiled so that time is linear, not the fastest. */
  bool large;
  /* Of families: what is lost follows from fields of the particle's own: nothing is where none has
     changed. */
  bool loses_by_own_fields;
  program_links links;
  bool reads_shape;                                                    /* inverse shape matrices */
  bool reads_share;                                                    /* shares of particles */
  bool reads_mass;                                                     /* and masses */
  bool stores, reads_rates, reads_size, linear, affine, works_at_rest; /* pl_law */
  arena *memory;
} kernel_plan;

/* PL_CONTINUUM over points; PL_CRACK over tips; PL_CENTRAL, PL_MICROPOLAR over strips; else
   PL_STATE, of families. */
static inline int plan_kind(const kernel_plan *p) {
  if (p->form == FORM_POINTS) return PL_CONTINUUM;
  if (p->form == FORM_TIPS) return PL_CRACK;
  if (p->form != FORM_STRIPS) return PL_STATE;
  return law_kind_turns(p->law->tree->law) ? PL_MICROPOLAR : PL_CENTRAL;
}

static inline bool plan_is_of_families(const kernel_plan *p) {
  return p->form != FORM_STRIPS && p->form != FORM_POINTS && p->form != FORM_TIPS;
}

/* The segment of a program that has but one. */
static inline segment *plan_segment(const kernel_plan *p, program_task task) {
  return p->programs[task].passes[0].segments;
}

/* An empty plan. */
kernel_plan *plan_begin(const law *l, kernel_form form);
/* Plans all passes of a law: strips for laws of bonds in the plane, programs for laws of families.
   NULL with diagnostics when it cannot be compiled. */
kernel_plan *plan_kernel(const law *l, diagnostics *d);
/* A variant for what differs in space. */
kernel_plan *plan_kernel_varying(const law *l, const law_variation *v, diagnostics *d);
/* A law of bonds as a law of families, for lattices that are no hexagon: both ends of a bond
   evaluate it. */
kernel_plan *plan_kernel_of_families(const law *l, const law_variation *v, diagnostics *d);
void plan_free(kernel_plan *p);

#endif
