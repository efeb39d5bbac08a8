/* A law of families as programs. A program is a row of passes over all particles: what a pass needs of a neighbour's
   present step, an earlier pass has left as a link, a value of the particle. A pass is a row of segments over a chunk
   of particles: particle by particle, neighbour by neighbour with sums into slots, or bond by bond, which is over the
   neighbours whose bonds the particle owns; such a loop may also add to sums of both ends (SHARE_PAIRS). Values of particles that later segments need stand in slots; values toward
   neighbours that are too dear to be computed twice stand in planes. What is dear and the same from either end of a bond
   is computed once, by the owner in the first pass, and shared by both ends from then on; so, later, is the force of a bond
   (SHARE_MORE). The emitter writes segments as
   loops, the interpreter runs them. */
#ifndef PERILAT_GENERATOR_PROGRAM_H
#define PERILAT_GENERATOR_PROGRAM_H

#include "dsl/base/arena.h"
#include "generator/ir/ir.h"

/* Particles that the segments of a pass take at a time on the interpreter; in C it may be more (programs.c). */
enum { FAMILY_CHUNK = 64 };

typedef enum segment_kind {
  OVER_PARTICLES,
  OVER_NEIGHBOURS,
  OVER_BONDS,
  OVER_PAIRS /* bond by bond: sums of both ends, and fields at both ends */
} segment_kind;

/* What a root of a segment is written to. Over neighbours an absent bond adds nothing to a reduction and
   gives 0 to a field and to what is observed. */
typedef enum segment_target {
  TO_SLOT,              /* slot[index] = node */
  TO_LINK,              /* link[index] = node */
  TO_PARTICLE_FIELD,    /* new_field[index] = node */
  TO_PARTICLE_FORCE,    /* force[index] = node */
  TO_PARTICLE_OBSERVED, /* observed[index] = node */
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
  int parity; /* what the other end of the bond computes: 1: the same; -1: the opposite; 0: something else */
  bool paired; /* of OVER_PAIRS */
  int sum;     /* of those: which pl_family.sum TO_SUM adds to at the far end */
  bool vanishes; /* where the bond is absent: TO_SHARED writes 0; TO_SUM adds what is 0 by itself, and does not ask */
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

/* A sum of products, which differ from bond to bond, adds each with one rounding. Of pairs one factor must be what is
   always finite, since absent bonds add 0 times it: a constant, or where particles are. */
bool segment_fuses(const ir *g, const segment_root *r);

/* What a segment computes for its roots: nodes[at most 2 root_count]; first their values, or first factors, then the second
   factors of those that fuse (of pairs the finite ones). Returns how many. */
int segment_nodes(const ir *g, const segment *a, ir_node *nodes);

typedef struct family_pass {
  segment *segments;
  int segment_count;
  int slot_count, plane_count;
} family_pass;

typedef struct family_program {
  const char *name; /* step, observe */
  family_pass *passes;
  int pass_count;
} family_program;

/* Quantities of a bond's motion and what takes their place. */
typedef struct program_motion {
  const ir_node *from, *to;
  int count;
} program_motion;

/* What both ends of a bond share. */
typedef enum program_sharing {
  SHARE_NOTHING,
  SHARE_DEAR, /* what costs much more to compute than to leave and find */
  SHARE_MORE, /* also what costs less, and forces of bonds: of few neighbours in space, whose values stay in caches */
  SHARE_MOST, /* the same, and less is left to be computed from it: in the plane, where a few rows of values are enough */
  SHARE_PAIRS /* all: a bond is evaluated once and adds to both ends (OVER_PAIRS) */
} program_sharing;

/* Values that passes leave to later ones: of particles, and toward each neighbour. Shared values stand in pairs among the
   latter, since only owners write them. */
typedef struct program_links {
  int of_particles, of_bonds;
} program_links;

/* Where shared value `index` of owned bond k, of 0 .. half-1, stands: plane half*upper + k of link `link` of bonds. */
typedef struct shared_place {
  int link;
  bool upper;
} shared_place;
static inline shared_place program_shared_place(int index) {
  return (shared_place){index / 2, index % 2 != 0};
}

/* pl_program.at_hand */
unsigned program_at_hand(const ir *g, const family_program *p);
/* pl_program.upward, spared */
unsigned program_upward(const ir *g, const family_program *p);
int program_reaches_spared(const ir *g, const family_program *p);
/* pl_program.shared of a pass */
uint64_t program_shared_by(const family_pass *p);

/* Makes a program of `roots`, which speak of one particle and of the bond to one neighbour in the terms of lower.h; their
   targets are the final ones (TO_PARTICLE_..., TO_NEIGHBOUR_...). IR_NEIGHBOUR(x) becomes what the neighbour computes for
   x, to the bit: values of particles that go over a family are links, and so are values toward a neighbour that are dear;
   all others are evaluated again with both sides exchanged. Motion is substituted after that, since stretch and length are the same from either side. `memory` holds
   the program; *links is raised to what it needs. What is the same from either end of a bond, or differs
   by its sign, is evaluated once where that pays, as `sharing` says. */
void program_build(family_program *out, const char *name, ir *g, arena *memory,
                   const segment_root *roots, int root_count, const program_motion *motion,
                   program_sharing sharing, program_links *links);

/* Whether bonds of the pass add to both ends. */
bool program_is_paired(const family_pass *p);
/* Whether the program writes the field, which stands toward neighbours, bond by bond at both ends. */
bool program_pairs_field(const family_program *p, int field);
/* A sum of what is the same for all bonds of a class: it does not change from step to step (pl_family.constant_sum). */
static inline bool segment_is_constant(const ir *g, const segment_root *r) {
  return r->paired && r->target == TO_SUM && ir_place(g, r->node) <= ON_BODY;
}
/* How many the program has, or has before that segment's. */
int program_constant_sums(const ir *g, const family_program *p, const segment *before);
/* Which segment of pairs finds out where bonds are as is expected (ir_expect), for all that come later; NULL: none. Later
   segments may expect only what it has asked of the motion. */
const segment *program_asks(const ir *g, const family_program *p);
bool program_is_told(const ir *g, const family_program *p, const segment *a);
/* Sums that one pass adds to far ends, the most. */
int program_sum_count(const family_program *p);

#endif
