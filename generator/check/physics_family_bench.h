/* A law of families on a free body of a few particles, driven on the interpreter: parameters,
   deformations, forces, what is observed, and how its checks say what they find; and a micropolar
   law in space, whose bonds twist. What holds by construction is not checked: bond forces are means
   of both sides, opposite to the bit, and stretches know no rotation. */
#ifndef PERILAT_GENERATOR_PHYSICS_FAMILY_BENCH_H
#define PERILAT_GENERATOR_PHYSICS_FAMILY_BENCH_H

#include "generator/check/physics_conditions.h"
#include "generator/plan/plan.h"
#include "runtime/analysis/patch.h"

/* A number that the law computes of a particle, or toward each of its neighbours: where it is
   observed. */
typedef struct watched {
  int at;    /* in patch.observed */
  bool wide; /* toward neighbours */
} watched;

/* The law twice on one body without surroundings. `whole`: forces and new fields; it observes
   `text` with the fields at hand. `frozen`: forces with the fields held, at the same rates; it
   observes the law's energy. */
typedef struct family_bench {
  const law *law;
  const physics_options *options;
  diagnostics *said;
  bool failed[DIAG_COUNT]; /* each check speaks once */
  arena *memory;
  lowered_law step;
  kernel_plan *plan[2];
  pl_law *kernel[2];
  patch *whole, *frozen;
  rows *lattice;
  const char *lattice_name;
  bool has_energy;
  bool reads_time; /* `dt`, which is whole->advance */
  double *parameters;
  uint64_t seed;
  watched *rule;             /* [fields] of damages */
  watched *guard;            /* [conditions.count] */
  watched *overstress;       /* [flows]; at -1 where there is none */
  law_conditions conditions; /* of step.text */
  long values;               /* of a displacement: dof * particles */
  double evaluated;          /* particles so far */
  double bonds;              /* of all passes over them */
} family_bench;

/* NULL when the law cannot be lowered or there is no such lattice (said in `d`). */
family_bench *family_bench_new(const law *l, const physics_options *o, diagnostics *d);
void family_bench_free(family_bench *b);

/* New parameters (the defaults at first), a virgin body at rest. */
void family_bench_draw(family_bench *b, bool defaults);
/* One displacement, or velocity, of all particles (m, m/s): [values], component by component. An
   affine deformation of random kind and random differences, at most `size` as strain. Rotations are
   counted as what they move at a distance of one spacing (m), and random. */
void family_bench_deform(family_bench *b, double size, double *values);
/* Puts both bodies at u, at the velocity v (NULL: at rest). */
void family_bench_move(family_bench *b, const double *u, const double *v);
/* Forces of a body after its step: [values]; their product with a change of the displacements is
   work. */
void family_bench_forces(family_bench *b, patch *of, double *force);
/* New fields of the whole law, for both bodies. */
void family_bench_accept(family_bench *b);
/* Fields of the whole law's body for the frozen one. */
void family_bench_share_fields(family_bench *b);
/* What `text` observes of the whole law's body. */
void family_bench_observe(family_bench *b);
/* The time there is has been used up (families of many neighbours): a check goes its first round
   only. */
bool family_bench_tired(const family_bench *b);
/* Sum of the law's energy over the body, J. */
double family_bench_energy(family_bench *b);

/* Values of a watched number at one place after patch_observe of the whole law: a place is a
   particle, or a particle and one of its neighbours. */
int family_bench_places(const family_bench *b, watched w);
bool family_bench_exists(const family_bench *b, watched w, int where);
double family_bench_value(const family_bench *b, watched w, int where);
int family_bench_bonds(const family_bench *b, watched w, int where); /* of the particle there */

/* One error or warning of a kind, with the parameters that show it and `size`, the strain of the
   body there (0: none). */
void family_bench_say(family_bench *b, diag_code code, span where, double size, const char *format,
                      ...) __attribute__((format(printf, 5, 6)));
/* Where the law gives its force state or its energy. */
span family_bench_force(const family_bench *b);

double family_work(const double *force, const double *way, long count, double *size);

/* Room for a displacement, at 0; to be freed. */
double *family_bench_values(const family_bench *b);

#endif
