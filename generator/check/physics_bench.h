/* A test bench for one law: the law alone on the interpreter, 64 bond states at a time, each with
   its own parameters. A state is a column over the planes [parameters][built-in
   quantities][fields][reference chord]. */
#ifndef PERILAT_GENERATOR_PHYSICS_BENCH_H
#define PERILAT_GENERATOR_PHYSICS_BENCH_H

#include "generator/check/physics_conditions.h"
#include "generator/ir/interpret.h"
#include "generator/lower/lower.h"

enum {
  BENCH_LANES = INTERPRET_LANES,
  BENCH_LATTICES = 16 /* without a deck; the first is the usual one */
};

/* What moves a bond: in the order of law_motion. */
typedef enum bench_axis {
  AXIS_STRETCH,
  AXIS_RATE,
  AXIS_THETA_I,
  AXIS_THETA_J,
  AXIS_COUNT
} bench_axis;
typedef struct motion {
  double at[AXIS_COUNT];
} motion;

/* Nodes of the bench's graph with the arrays that receive their values. */
typedef struct probe {
  interpreter *program;
  int count;
  double **out; /* [count][BENCH_LANES] */
} probe;

enum { FORCE_N, FORCE_M_I, FORCE_M_J, FORCE_COUNT };

typedef struct bench {
  const law *law;
  ir *graph;
  arena *memory;
  lowered_law law_step, law_frozen;
  int parameter_count, field_count, width;
  bool micropolar;
  const physics_options *options;
  uint64_t seed;
  struct rows *lattices[BENCH_LATTICES];
  int lattice_count;
  unsigned char *strides;    /* ones: every input has a value for each state */
  double evaluated;          /* states so far */
  double allowed;            /* states after which the present check ends */
  int operations;            /* of one evaluation of the law */
  bool reads_time;           /* `dt`, which rates of states read, too */
  probe step;                /* N, M_i, M_j, new fields, rules of the fields */
  probe frozen;              /* N, M_i, M_j with the fields at hand */
  law_conditions conditions; /* of law_step.text */
  probe guards;              /* [conditions.count] whether they hold */
} bench;

/* False when the law cannot be lowered (said in `d`), or there is no such lattice. */
bool bench_open(bench *b, const law *l, const physics_options *o, diagnostics *d);
void bench_close(bench *b);

probe probe_new(bench *b, const ir_node *roots, int count);
void probe_free(probe *p);
void probe_run(bench *b, probe *p, double *const *states, int count);

/* Planes for BENCH_LANES states. */
double **bench_states(const bench *b);
void bench_states_free(const bench *b, double **states);

double *bench_quantity(const bench *b, double *const *states, builtin_quantity q);
double *bench_field(const bench *b, double *const *states, int k);

/* Columns to and from [width] numbers. */
void bench_get(const bench *b, double *const *states, int lane, double *column);
void bench_put(const bench *b, double *const *states, int lane, const double *column);

void bench_move(const bench *b, double *const *states, int lane, motion m);
/* The reference chord from the other end. */
void bench_turn(const bench *b, double *const *states, int lane);
motion bench_motion(const bench *b, double *const *states, int lane);
/* At rest, at no time since it began. */
void bench_virgin(const bench *b, double *const *states, int lane);
/* Parameters and bond class of one lane: those of the options; without them a log-uniform factor of
   0.5 to 2 on every default, kept within the bounds. The first lane of a batch has the defaults,
   and the first bond of the first lattice. */
void bench_draw(bench *b, double *const *states, int lane);
/* New fields into the fields. */
void bench_accept(const bench *b, double *const *states, int count);

/* Length that turns moments into forces of the same weight (m). */
double bench_length(const bench *b, double *const *states, int lane);
/* |N| + (|M_i| + |M_j|)/length of lane `lane` of the first three outputs. */
double bench_size(const bench *b, double *const *states, const probe *p, int lane);

/* Allows the next check a share of all the time there is; bench_tired: it is used up. Counted in
   operations, so that the same law always gets the same states. Laws of ordinary size never come
   near. */
void bench_allow(bench *b, double share);
bool bench_tired(const bench *b);

/* Notes which sides of the guards the states are on. */
void bench_watch(bench *b, double *const *states, int count);

#endif
