/* Clocks, medians, facts of the machine, and the flat object of named figures that the benchmark
   leaves behind. */
#ifndef PERILAT_BENCHMARK_MEASURE_H
#define PERILAT_BENCHMARK_MEASURE_H

#include <stdbool.h>
#include <stddef.h>

/* Ends the program. */
_Noreturn void give_up(const char *format, ...) __attribute__((format(printf, 1, 2)));

double processor_seconds(void); /* of this thread */
double wall_seconds(void);

double median_of(const double *values, int count);
/* Half the range of the middle half over the median. */
double spread_of(const double *values, int count);

/* First line of /proc/cpuinfo that begins with `key`; "unknown" where there is none. */
void processor_fact(const char *key, char *value, size_t size);
int vector_bits(void); /* of a register, as this program is compiled */
int processor_count(void);

/* Bytes a second that a = b + factor c moves (McCalpin's STREAM: 24 a place), on arrays of `bytes`
   altogether; median. */
double triad_bandwidth(size_t bytes, int threads);
/* Additions and multiplications a second, of fused multiply-adds in registers, on one core; median.
   */
double fused_peak(void);

typedef struct figures figures;
/* `path` NULL: they are only remembered. */
figures *figures_open(const char *path);
void figures_text(figures *f, const char *key, const char *text);
/* The key is made as printf makes it from `format`; a value that is not finite is left out. */
void figures_add(figures *f, double value, const char *format, ...)
    __attribute__((format(printf, 3, 4)));
/* NaN when there is none of that key. */
double figures_value(const figures *f, const char *key);
void figures_close(figures *f);

/* The parts of the benchmark, each with its own table. False when contestants compute different
   things. */
bool benchmark_bonds(figures *f);
bool benchmark_families(figures *f);
bool benchmark_meshes(figures *f);
bool benchmark_points(figures *f);
bool benchmark_growth(figures *f);
bool benchmark_runs(figures *f);
bool benchmark_lammps(figures *f);

#endif
