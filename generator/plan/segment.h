/* What a program of a law of families is made of: passes of segments, and what segments write. */
#ifndef PERILAT_GENERATOR_SEGMENT_H
#define PERILAT_GENERATOR_SEGMENT_H

#include "generator/ir/ir.h"

/* Particles that the segments of a pass take at a time on the interpreter; in C it may be more
   (programs.c). */
enum { FAMILY_CHUNK = 64 };

typedef enum segment_kind {
  OVER_PARTICLES,
  OVER_NEIGHBOURS,
  OVER_BONDS,
  OVER_PAIRS /* bond by bond: sums of both ends, and fields at both ends */
} segment_kind;

/* What a root of a segment is written to. Over neighbours an absent bond adds nothing to a
   reduction and gives 0 to a field and to what is observed. */
typedef enum segment_target {
  TO_SLOT,              /* slot[index] = node */
  TO_LINK,              /* link[index] = node */
  TO_PARTICLE_FIELD,    /* new_field[index] = node */
  TO_PARTICLE_FORCE,    /* force[index] = node */
  TO_PARTICLE_OBSERVED, /* observed[index] = node */
  TO_PARTICLE_LOST,     /* lost[index] += node */
  TO_SUM,               /* slot[index] += node; the slot begins with 0 */
  TO_LARGEST,           /* slot[index] = max(slot, node); begins with -inf */
  TO_SMALLEST,          /* slot[index] = min(slot, node); begins with inf */
  TO_PLANE,             /* plane[index][neighbour] = node */
  TO_BOND_LINK,         /* bond_link[index][neighbour] = node */
  TO_SHARED,            /* shared value `index` of an owned bond = node (program_shared_place) */
  TO_NEIGHBOUR_FIELD,   /* new_field[index][neighbour] = node */
  TO_NEIGHBOUR_OBSERVED /* observed[index][neighbour] = node */
} segment_target;

typedef struct segment_root {
  ir_node node;
  segment_target target;
  int index;
  int parity;  /* at the other end of the bond: 1: the same; -1: the opposite; 0: something else */
  bool paired; /* of OVER_PAIRS */
  int sum;     /* of those: which pl_family.sum TO_SUM adds to at the far end */
  /* Where the bond is absent TO_SHARED writes 0, TO_SUM adds what is 0 by itself, and does not
     ask. */
  bool vanishes;
} segment_root;

/* Whether it matters for a root over neighbours or bonds that the bond exists. */
static inline bool segment_asks(const segment_root *r) {
  const bool plain = r->target == TO_PLANE || r->target == TO_BOND_LINK;
  return r->target >= TO_SUM && !plain && (r->target == TO_SHARED ? r->vanishes : !r->vanishes);
}

typedef struct segment {
  segment_kind kind;
  segment_root *roots;
  int root_count, root_capacity;
} segment;

typedef struct family_pass {
  segment *segments;
  int segment_count;
  int slot_count, plane_count;
} family_pass;

typedef struct family_program {
  const char *name; /* step, losses, observe */
  family_pass *passes;
  int pass_count;
} family_program;

/* What both ends of a bond share. */
typedef enum program_sharing {
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
   stand in pairs among the latter, since only owners write them. */
typedef struct program_links {
  int of_particles, of_bonds;
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

/* A sum of what is the same for all bonds of a class: it does not change from step to step
   (pl_family.constant_sum). */
static inline bool segment_is_constant(const ir *g, const segment_root *r) {
  return r->paired && r->target == TO_SUM && ir_is_uniform(g, r->node);
}

/* A sum of products, which differ from bond to bond, adds each with one rounding. Of pairs one
   factor must be what is always finite, since absent bonds add 0 times it: a constant, or where
   particles are. */
bool segment_fuses(const ir *g, const segment_root *r);

/* What a segment computes for its roots: nodes[at most 2 root_count]; first their values, or first
   factors, then the second factors of those that fuse (of pairs the finite ones). Returns how
   many. */
int segment_nodes(const ir *g, const segment *a, ir_node *nodes);

#endif
