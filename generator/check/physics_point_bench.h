/* One point of a continuum on the interpreter, for the checks of its law: strains in, stress and
   tangent out, and what is said of a state. */
#ifndef PERILAT_GENERATOR_PHYSICS_POINT_BENCH_H
#define PERILAT_GENERATOR_PHYSICS_POINT_BENCH_H

#include "dsl/base/diagnostics.h"
#include "generator/check/physics.h"
#include "generator/plan/plan.h"

enum { POINT_LANES = PL_LANES, POINT_MOST = PL_MAX_STRAINS };

/* Kernels take PL_LANES points, of which the first counts. Strains, stresses and entries of the
   tangent stand in the kernel's order: xx, yy, xy in the plane, xx, yy, zz, xy, yz, xz in space. */
typedef struct point_bench {
  const law *law;
  struct law setting; /* the law in the setting at hand */
  kernel_plan *plan;
  pl_law *kernel;
  diagnostics *said;
  physics_report *report;
  uint64_t seed;
  bool others; /* parameters are drawn, not the defaults */
  double *parameters, *uniforms;
  double advance;  /* s: `dt` of the next evaluations, 0 if nothing is said */
  bool reads_time; /* the law reads it */
  bool failed[DIAG_COUNT];
  int strains, stresses;
  double strain[POINT_MOST][POINT_LANES], rate[POINT_MOST][POINT_LANES], size[POINT_LANES];
  double stress[POINT_MOST][POINT_LANES], tangent[POINT_MOST * POINT_MOST][POINT_LANES];
  double lost[PL_LOSSES][POINT_LANES];
  double *space, **old_field, **new_field, **observed;
  const double *strain_at[POINT_MOST], *rate_at[POINT_MOST];
  double *stress_at[POINT_MOST], *tangent_at[POINT_MOST * POINT_MOST], *lost_at[PL_LOSSES];
} point_bench;

/* Of b->law in a setting; false when it cannot be compiled there (said). To be closed either
   way. */
bool point_bench_open(point_bench *b, law_setting setting);
void point_bench_close(point_bench *b);
/* The parameters that the options give, else the defaults, else drawn ones. */
void point_bench_parameters(point_bench *b, const physics_options *o, bool usual);

/* The next evaluation is from the virgin point, or goes on from the one before. */
void point_bench_virgin(point_bench *b);
void point_bench_keep(point_bench *b);
/* strain[strains] (1), rate[strains] (1/s) or NULL: at rest. */
void point_bench_strain(point_bench *b, const double *strain, const double *rate);
void point_bench_run(point_bench *b, pl_point_function function, double time_step);
/* Stress of the strain with the fields at hand, at rest (Pa). */
void point_bench_stress(point_bench *b, const double *strain, double *stress);
/* Largest entry of the tangent in size, NaN where one is. */
double point_bench_tangent_size(const point_bench *b);

/* A direction of strain of that size; a strain of 1e-7 to 1e-2. Both return the size. */
double point_bench_direction(point_bench *b, double size, double *strain);
double point_bench_any_strain(point_bench *b, double *strain);
bool point_bench_is_shear(const point_bench *b, int k);
/* Work of a stress over a small change of strain (J/m^3); *size grows by that of its parts. */
double point_bench_work(const point_bench *b, const double *stress, const double *change,
                        double *size);
/* Largest in size, NaN where one is. */
double point_bench_largest(const double *v, int count);

/* Once a code: a message at the line of the stress or the energy, with the strain that shows it
   (NULL: rest) and how to mend it. */
void point_bench_say(point_bench *b, diag_code code, const double *strain, const char *mend,
                     const char *format, ...) __attribute__((format(printf, 5, 6)));
/* The same at another line. */
void point_bench_say_at(point_bench *b, span where, diag_code code, const double *strain,
                        const char *mend, const char *format, ...)
    __attribute__((format(printf, 6, 7)));

#endif
