/* The functions of a kernel, as roots in one graph: what each reads, writes and costs. The emitter
   writes them as C, the interpreter evaluates them; both walk the same nodes. */
#ifndef PERILAT_GENERATOR_PLAN_H
#define PERILAT_GENERATOR_PLAN_H

#include "generator/lower/kinematics.h"
#include "generator/lower/lower.h"
#include "generator/plan/segment.h"
#include "runtime/kernel.h"

/* What is done over strips of bonds. */
typedef enum strip_task { STRIP_STEP, STRIP_LEDGER, STRIP_OBSERVE } strip_task;

/* The functions over strips. X(pass, member of pl_law, task) */
#define STRIP_PASSES(X)                                                                            \
  X(PASS_ROWS, rows, STRIP_STEP)                                                                   \
  X(PASS_ROWS_LEDGER, rows_ledger, STRIP_LEDGER)                                                   \
  X(PASS_ROWS_OBSERVE, rows_observe, STRIP_OBSERVE)

typedef enum pass_kind {
#define X(pass, member, task) pass,
  STRIP_PASSES(X)
#undef X
      PASS_STATES,
  PASS_TANGENT,
  PASS_BOUNDS,
  PASS_COUNT
} pass_kind;

/* What a root is written to. `present` is the bond's PL_PRESENT bit; the graph does not know of it.
   Protection is in the graph (ENDS_PROTECTED), because the force must use the damage that stays. */
typedef enum pass_target {
  TO_FORCE,            /* force[index] = present ? node : 0 */
  TO_FIELD,            /* field[index] = present ? node : field[index] */
  TO_DISSIPATED_STATE, /* dissipated_state += present ? node : 0 */
  TO_DISSIPATED_RATE,  /* dissipated_rate += present ? node : 0 */
  TO_OBSERVED,         /* observed[index] = present ? node : 0 */
  TO_OUT,              /* out[index] = node */
  TO_LOWER,
  TO_UPPER /* lower[index], upper[index] = node; infinite where there is no bound */
} pass_target;

/* Inputs of a pass, by source: IR_FROM_PARAMETER and, of IR_FROM_QUANTITY, what a bond class knows
   (s, spacing, t, V, m, m_i, m_j, area, shell, n): through uniforms. Of IR_FROM_QUANTITY stretch,
   stretch_rate, theta_i, theta_j, length: only in PASS_STATES and PASS_TANGENT, planes of
   pl_states.in. IR_FROM_FIELD k: field[k]. IR_FROM_ENDS: all strips.
   IR_FROM_BOND_PARAMETER k: in strips and families parameter[k], the value of parameter varying[k]
   in each bond, IR_FROM_PARTICLE_PARAMETER k: of each particle; all other passes take that
   parameter as IR_FROM_PARAMETER. */
typedef struct pass_root {
  ir_node node;
  pass_target target;
  int index; /* force plane, field, observed plane, out plane, parameter */
} pass_root;

typedef struct pass {
  pass_kind kind;
  const char *name;
  pass_root *roots;
  int root_count;
} pass;

enum { PLAN_MOST_PASSES = 8 }; /* of a program of families */

/* Whether loops over strips are cut into stages (stages.h). Results are the same to the bit. */
typedef enum loop_cutting {
  CUT_BY_COST,
  CUT_NEVER, /* unless something is expected (ir_expect) */
  CUT_ALWAYS /* into stages as short as they can be */
} loop_cutting;

/* How the passes of a law of families go over the neighbours. */
typedef enum family_form {
  FAMILY_LOOPS, /* by loops, of any number of neighbours */
  /* One loop over the particles, neighbour by neighbour in its body: law->neighbours of them */
  FAMILY_WRITTEN_OUT,
  FAMILY_PAIRS /* by loops over bonds that add to both ends (SHARE_PAIRS) */
} family_form;

typedef struct kernel_plan {
  const law *law;
  law_variation variation; /* what differs in space */
  ir *graph;
  pass passes[PASS_COUNT];
  loop_cutting cutting;
  int kind, dimensions, dof, force_planes;
  int rotations;     /* of a particle, behind its dimensions: dof in all */
  ir_node *uniforms; /* [uniform_count] ascending: values hoisted into `prepare`. All nodes, inputs
                        too but no constants, with ir_place <= ON_BODY that a local node or a root
                        of a pass other than PASS_BOUNDS reads directly: a strip reads uniforms[k]
                        and nothing before it */
  int uniform_count;
  double flops_per_bond,
      divisions_per_bond; /* of PASS_ROWS, or of `step`, without what is hoisted */
  /* Laws of families (kind PL_STATE): of the passes above only PASS_BOUNDS has roots. */
  family_form form; /* of `step`, and of how chords and forces are written */
  family_program step, observe;
  family_program losses; /* what pl_law.ledger does beside `step`; may have no passes */
  /* What is lost follows from fields of the particle's own: nothing is where none has changed. */
  bool loses_by_own_fields;
  program_links links;
  bool reads_shape;         /* inverse shape matrices */
  bool reads_share;         /* shares of particles */
  bool reads_mass;          /* and masses */
  bool stores, reads_rates; /* pl_law */
  arena *memory;
} kernel_plan;

/* An empty plan. */
kernel_plan *plan_begin(const law *l);
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
