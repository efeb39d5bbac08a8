/* What a kernel is made of: programs of passes, passes of segments, and what segments write. A
   segment computes its roots for one thing after the other: a particle, a neighbour, a bond. */
#ifndef PERILAT_GENERATOR_SEGMENT_H
#define PERILAT_GENERATOR_SEGMENT_H

#include "dsl/base/arena.h"
#include "generator/ir/ir.h"

/* Particles that the segments of a pass take at a time on the interpreter; in C it may be more
   (programs.c). */
enum { FAMILY_CHUNK = 64 };

typedef enum segment_kind {
  OVER_BODY, /* once */
  OVER_POINTS, /* of a continuum */
  OVER_PARTICLES,
  OVER_NEIGHBOURS,
  OVER_BONDS, /* of a strip, or those that the particles of a chunk own; single states */
  OVER_PAIRS  /* bond by bond: sums of both ends, and fields at both ends */
} segment_kind;

/* The kind that computes values of a place for all particles. */
static inline segment_kind segment_kind_at(placement on) {
  return on <= ON_PARTICLE ? OVER_PARTICLES : OVER_NEIGHBOURS;
}

/* What a root of a segment is written to: an array of the segment's particles or bonds, of pl_strip
   or pl_family, or one toward each of the neighbours. Where a bond is absent a reduction, or a
   loss, gets nothing; a field of a strip stays; fields toward neighbours, forces and what is
   observed are 0. */
typedef enum segment_target {
  /* force[index] = node, or force_state[index][neighbour]; of points stress[index] */
  TO_FORCE,
  TO_FIELD,            /* field[index] = node, of families new_field */
  TO_DISSIPATED_STATE, /* dissipated_state += node; of families lost[index] */
  TO_DISSIPATED_RATE,  /* dissipated_rate += node; the same */
  TO_GIVEN_BY_REST,    /* given_by_rest += node; the same */
  TO_OBSERVED,         /* observed[index] = node */
  TO_TANGENT,          /* of points: tangent[index] = node */
  TO_OUT,              /* out[index] = node, behind these new_field: of single states */
  TO_LOWER,
  TO_UPPER,    /* lower[index], upper[index] = node; infinite where there is no bound */
  TO_SLOT,     /* slot[index] = node */
  TO_SUM,      /* slot[index] += node; the slot begins with 0 */
  TO_LARGEST,  /* slot[index] = max(slot, node); begins with -inf */
  TO_SMALLEST, /* slot[index] = min(slot, node); begins with inf */
  TO_PLANE,    /* plane[index][neighbour] = node */
  TO_LINK,     /* link[index] = node, or bond_link[index][neighbour] */
  TO_SHARED    /* shared value `index` of an owned bond = node (program_shared_place) */
} segment_target;

typedef struct segment_root {
  ir_node node;
  segment_target target;
  segment_kind over; /* what it is written for: its segment's kind */
  int index;         /* force plane, field, observed plane, out plane, parameter, slot, ... */
  int parity;  /* at the other end of the bond: 1: the same; -1: the opposite; 0: something else */
  ir_node far; /* OVER_PAIRS: that, where parity is 0 */
  int sum;     /* OVER_PAIRS: which pl_family.sum TO_SUM adds to at the far end */
  /* Where the bond is absent TO_SHARED writes 0, TO_SUM adds what is 0 by itself, and does not
     ask. */
  bool vanishes;
} segment_root;

/* What adds to what is lost, or given, already. */
static inline bool segment_is_loss(const segment_root *r) {
  return r->target >= TO_DISSIPATED_STATE && r->target <= TO_GIVEN_BY_REST;
}

/* Whether it matters for a root over neighbours or bonds that the bond exists. */
static inline bool segment_asks(const segment_root *r) {
  if (r->over <= OVER_PARTICLES || r->target == TO_PLANE || r->target == TO_LINK) return false;
  return r->target == TO_SHARED ? r->vanishes : !r->vanishes;
}

typedef struct segment {
  segment_kind kind;
  segment_root *roots;
  int root_count, root_capacity;
} segment;

typedef struct program_pass {
  segment *segments;
  int segment_count;
  int slot_count, plane_count;
} program_pass;

typedef struct kernel_program {
  const char *name; /* of its function, or what those of its passes begin with */
  program_pass *passes;
  int pass_count;
} kernel_program;

/* What both ends of a bond share. */
typedef enum program_sharing {
  SHARE_LEAST, /* nor do particles leave what their neighbours can compute: families alone */
  SHARE_NOTHING,
  SHARE_DEAR, /* what costs much more to compute than to leave and find */
  /* Also what costs less, and forces of bonds: of few neighbours in space, whose values stay in
     caches */
  SHARE_MORE,
  /* The same, and less is left to be computed from it: in the plane, where a few rows of values
     are enough */
  SHARE_MOST,
  SHARE_PAIRS /* all: a bond is evaluated once and adds to both ends (OVER_PAIRS) */
} program_sharing;

/* Values that passes leave to later ones: of particles, and toward each neighbour. Shared values
   stand in pairs among the latter, since only owners write them. What particles leave by themselves
   (program_ends.h) all programs leave in the same link. */
enum { MOST_LEFT = 32 };
typedef struct program_links {
  int of_particles, of_bonds;
  ir_node left[MOST_LEFT];
  int left_in[MOST_LEFT], left_count;
} program_links;

/* Where shared value `index` of owned bond k, of 0 .. half-1, stands: plane half*upper + k of link
   `link` of bonds. */
typedef struct shared_place {
  int link;
  bool upper;
} shared_place;
static inline shared_place program_shared_place(int index) {
  return (shared_place){index / 2, index % 2 != 0};
}

void segment_add(arena *memory, segment *a, segment_root root);
/* Whether the other end of a bond adds another value. */
static inline bool segment_has_far(const segment_root *r) {
  return r->over == OVER_PAIRS && r->target == TO_SUM && r->parity == 0;
}

/* [segment_value_count] of the roots, then those at far ends that are others; to be freed. And new
   ones in their place. */
int segment_value_count(const segment *a);
ir_node *segment_values(const segment *a);
void segment_replace(segment *a, const ir_node *values);
/* Marks [ir_count] the nodes that the roots need; to be freed. */
unsigned char *segment_needed(const ir *g, const segment *a);

/* A sum of what is the same for all bonds of a class: it does not change from step to step
   (pl_family.constant_sum). */
static inline bool segment_is_constant(const ir *g, const segment_root *r) {
  return r->over == OVER_PAIRS && r->target == TO_SUM && r->parity && ir_is_uniform(g, r->node);
}

/* A sum of products, which differ from bond to bond, adds each with one rounding. Of pairs one
   factor must be what is always finite, since absent bonds add 0 times it: a constant, or where
   particles are. */
bool segment_fuses(const ir *g, const segment_root *r);

/* What a segment computes for its roots: nodes[at most 2 root_count]; first their values, or first
   factors, then, of those that have one, the second factor (of pairs the finite one) or the value
   at the far end. Returns how many. */
int segment_nodes(const ir *g, const segment *a, ir_node *nodes);

#endif
