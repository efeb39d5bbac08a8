/* A law for the checks of this room: its parameters, its kernel on the interpreter, a perfect
   lattice of it, and how they say what they find. */
#ifndef PERILAT_GENERATOR_SENSE_BENCH_H
#define PERILAT_GENERATOR_SENSE_BENCH_H

#include "generator/check/physics.h"
#include "generator/plan/plan.h"
#include "runtime/lattice/rows.h"

typedef struct sense_bench {
  const law *law;
  const physics_options *options;
  diagnostics *said;
  double *parameters; /* SI, in the law's order: those of the options, else the defaults */
  /* Of laws of bonds and families, else NULL: */
  kernel_plan *plan;
  pl_law *kernel;
  rows *lattice;
  const char *lattice_name;
  bool hexagon;             /* the lattice is that of nearest neighbours in the plane */
  bool said_of[DIAG_COUNT]; /* each code once */
} sense_bench;

/* False when the law cannot be planned, or there is no such lattice. To be closed either way. */
bool sense_bench_open(sense_bench *b, const law *l, const physics_options *o, diagnostics *d);
void sense_bench_close(sense_bench *b);

/* The parameter of that name and unit; NULL without one. */
const symbol *sense_parameter(const law *l, const char *name, const char *measured_in);
/* Its value, SI; of NULL NaN. */
double sense_value(const sense_bench *b, const symbol *parameter);
/* The line that gives the force, the stress or the energy. */
span sense_force(const law *l);
/* A warning or an error, once a code, with how to mend it (NULL: nothing is said of that). */
void sense_say(sense_bench *b, diag_code code, span where, const char *mend, const char *format,
               ...) __attribute__((format(printf, 5, 6)));

#endif
