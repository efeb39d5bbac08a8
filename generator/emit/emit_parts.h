/* Inside of the emitter, shared by its parts: emit.c writes expressions and the table of facts, emit_strip.c the passes
   over strips of bonds, emit_family.c the programs of families. */
#ifndef PERILAT_GENERATOR_EMIT_PARTS_H
#define PERILAT_GENERATOR_EMIT_PARTS_H

#include "generator/emit/c_text.h"
#include "generator/emit/kernel_parts.h"
#include "generator/plan/plan.h"

/* The functions differ in where inputs come from and in how the loop, if any, runs. */
typedef enum scope_kind {
  IN_PREPARE,
  IN_BOUNDS,
  IN_ROWS,
  IN_STATES,
  IN_PARTICLES, /* segments of families */
  IN_NEIGHBOURS
} scope_kind;

/* How the loops of a segment are written: what stands for the first particle of a chunk, for the number of the neighbour
   here and there, for the way to it and to its links, and for number and place of the bond at its owner. */
typedef struct family_words {
  const char *first, *k, *back, *to, *link_to, *owned, *owner;
  bool far; /* the bond is the neighbour's, which is known only where families are unrolled */
} family_words;

/* What a loop over bonds relies on: of choices by it only what it says is computed. */
typedef enum reliance {
  SURE_OF_NOTHING = 0,
  SURE_OF_EXPECTED = 1, /* conditions that are expected to hold do */
  SURE_OF_UNHELD = 2    /* no bond is protected */
} reliance;

typedef struct emitter {
  const kernel_plan *plan;
  const ir *graph;
  c_text *out;
  int node_count;
  int *uniform_of; /* [node_count] index in `uniforms`, or -1 */

  /* the function being written */
  scope_kind scope;
  const pass_root *roots; /* [root_count] of a pass over strips; NULL for a segment */
  int root_count;
  unsigned relies; /* reliance, together */
  c_names names;
  unsigned char *needed;     /* [node_count] */
  unsigned char *dropped;    /* [node_count] lines that are 0 where the bond is absent; or NULL */
  int *uses;                 /* [node_count] by needed nodes and roots */
  ir_node *user;             /* [node_count] the last of them; IR_NONE: a root */
  int *size;                 /* [node_count] operations written in place of the node */
  const char **name;         /* [node_count] NULL: written in place */
  const family_words *words; /* of segments */
  struct unrolled *unrolled; /* of a pass that is one loop (emit_unrolled.c); else NULL */
  bool quiet;                /* the loop is for where marked fields are 0 (emit_pairs.c) */

  int part;                            /* that the function is in */
  size_t part_start;                   /* of the function, in the text */
  size_t part_length[KERNEL_PARTS]; /* of the functions so far */
} emitter;

/* Begins and ends a function or a segment that computes these nodes: decides which get a line and a name. */
void emit_open_nodes(emitter *e, scope_kind scope, const ir_node *nodes, int count);
void emit_open_roots(emitter *e, scope_kind scope, const pass_root *roots, int root_count);
void emit_close(emitter *e);
/* A value loaded from `uniforms`; in `prepare` the same node is computed. */
bool emit_is_uniform(const emitter *e, ir_node n);
bool emit_is_input(const emitter *e, ir_node n);
/* `const double x = ...;` for a node that has a name here; for each of them, in the order of the graph. */
void emit_line(emitter *e, ir_node n);
void emit_lines(emitter *e);
/* Node n as an operand that needs no parentheses inside a choice. */
void emit_value(emitter *e, ir_node n);
/* Node n as C's condition. */
void emit_condition(emitter *e, ir_node n);
/* Whether node n, a condition, is that a bond of a strip is protected. */
bool emit_asks_whether_protected(const emitter *e, ir_node n);
/* What stands before the loop: values that are the same for all bonds, and the arrays of the others. */
void emit_inputs_before_loop(emitter *e);
void emit_loop_begin(emitter *e);
/* NULL without such a root. */
const pass_root *emit_find_root(const emitter *e, pass_target target, int index);
/* A function over bonds or particles, from its declaration to its end: `kind` void `name`(law, uniforms, `over`). It goes
   into the part of the text (toolchain.h) that has the least so far. */
void emit_function_begin(emitter *e, const char *kind, const char *name, const char *over);
void emit_function_end(emitter *e);
/* "; / * line 12 * /" and the end of the line. */
void emit_line_end(emitter *e, ir_node n);

/* Fills uniform_of; the caller frees it. */
void emit_find_uniforms(emitter *e);

/* --- emit_strip.c --- */

void emit_strip_pass(emitter *e, const pass *p, const char *name);

/* --- emit_family.c --- */

/* Functions of the passes and the tables of both programs. */
void emit_programs(emitter *e);
/* Members of the table of facts. */
void emit_program_members(emitter *e);
/* What a segment loads for an input. */
void emit_segment_input(emitter *e, ir_node n);
/* Where the array of an input begins, and that of a root; not of slots and planes. */
void emit_family_array(emitter *e, ir_node n);
void emit_family_target(emitter *e, const segment_root *r);
bool emit_is_held(const emitter *e, ir_node n);
bool emit_is_time_step(const emitter *e, ir_node n);
/* Some value of the segment is another one where the bond is absent. */
bool emit_asks_for_presence(const segment *a);
/* What a sum, a largest or smallest value begins with. */
bool emit_is_reduction(const segment_root *r);
const char *emit_reduction_start(const segment_root *r);
/* Begins a segment; emit_close ends it. */
void emit_open_segment(emitter *e, const segment *a);
/* `to = value;`, or what becomes of `to` where it is a reduction. */
void emit_family_store(emitter *e, const segment_root *r, const char *to);

/* Begins the loop over the rows of a run. */
extern const char emit_rows_begin[];

/* What a segment reads, before its loop; the beginning of that loop; slots as reductions begin. */
void emit_family_inputs(emitter *e);
void emit_family_loop(emitter *e, const char *indent);
void emit_family_starts(emitter *e, const segment *a);

/* --- emit_pairs.c --- */

/* What the passes call. */
void emit_pairs_functions(emitter *e);
void emit_pairs(emitter *e, const segment *a);
/* The input is 0 where the loop at hand is for. */
bool emit_pairs_is_zero(const emitter *e, ir_node n);

/* --- emit_unrolled.c --- */

/* A pass as one loop over the particles of a run, with neighbours written out instead of loops over them: what segments leave
   for each other stays in registers. */
void emit_unrolled_pass(emitter *e, const family_pass *p);
void emit_unrolled_input(emitter *e, ir_node n);

#endif
