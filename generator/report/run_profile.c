#include "generator/report/run_profile.h"

#include <math.h>
#include <stdlib.h>
#include <unistd.h>

#include "dsl/base/arena.h"
#include "dsl/base/elementary.h"
#include "runtime/base/clock.h"
#include "runtime/interaction/sweep.h"

/* --- the machine ------------------------------------------------------------------------------ */

#define TRIAD_SECONDS 0.25
enum { TRIAD_BYTES = 192 << 20 }; /* of three arrays together: more than most caches hold */

/* Bytes a second of a = b + 3 c (McCalpin 1995), the best within a quarter of a second; 24 bytes
   a place. */
static double triad(int threads) {
  const long count = TRIAD_BYTES / (long)(3 * sizeof(double));
  double *memory = must_alloc(3 * (size_t)count * sizeof *memory);
  double *a = memory, *b = a + count, *c = b + count, best = INFINITY;
  double begun = 0, end = INFINITY;
  for (int round = 0; round < 2 || begun < end; round++) { /* the first touches the memory */
    begun = monotonic_seconds();
    if (round == 1) end = begun + TRIAD_SECONDS;
#pragma omp parallel for num_threads(threads) schedule(static)
    for (long k = 0; k < count; k++) {
      if (round == 0) b[k] = c[k] = (double)k;
      a[k] = b[k] + 3 * c[k];
    }
    if (round > 0) best = pl_fmin(best, monotonic_seconds() - begun);
  }
  free(memory);
  return TRIAD_BYTES / best;
}

/* --- a particle's step ------------------------------------------------------------------------ */

/* What a step must move for a particle: displacements, velocities and fields are read and
   written once, and so is what one pass leaves to another, unless it stays in windows of rows;
   marks of bonds, parameters that differ and what is known of the reference are read. Rows of bonds
   share marks; where bonds add to both ends, their fields are hardly touched. */
static double bytes_in(const run *r, int number) {
  const pl_law *kernel = r->laws[number].law;
  const sweep *w = simulation_law_state(r->simulation, number);
  const rows *g = w->body->lattice;
  const double one = sizeof(double);
  double both = 2.0 * kernel->dof, read = 0;
  for (int k = 0; k < kernel->field_count; k++)
    if (kernel->sum_count == 0 || kernel->fields[k].place == PL_ON_PARTICLE)
      both += sweep_planes(w, kernel->fields[k].place);
  if (kernel->kind == PL_STATE) {
    both += 0.5 * kernel->dof; /* forces are written */
    if (w->engine.keeps_links)
      both += kernel->link_count + kernel->bond_link_count * sweep_planes(w, PL_ON_NEIGHBOUR);
    read += 2 + (kernel->reads_shape ? PL_SHAPE_PLANES(kernel->dimensions) : 0);
  }
  const double both_ends = kernel->sum_count > 0 && kernel->varying_place == PL_ON_BOND ? 2 : 1;
  read += kernel->varying_count * sweep_planes(w, kernel->varying_place) / both_ends;
  if (g->site_mass) read += kernel->dof > kernel->dimensions ? 2 : 1;
  if (g->list) read += 2.0 * g->directions * (1.5 + kernel->dimensions) + 2;
  return one * (2 * both + read) * (double)g->particle_count;
}

/* A law of families is evaluated by both ends of a bond. */
static double operations_in(const run *r, int number) {
  const pl_law *kernel = r->laws[number].law;
  const double ends = kernel->kind == PL_STATE ? 2 : 1;
  return ends * (kernel->flops_per_bond + kernel->divisions_per_bond) *
         (double)simulation_law_rows(r->simulation, number)->bond_count;
}

static double particles_of(const run *r) {
  double sum = 0;
  for (int b = 0; b < simulation_bodies(r->simulation); b++)
    sum += (double)simulation_rows(r->simulation, b)->particle_count;
  return sum;
}

/* Of all laws, over the particles of all bodies. */
static double mean_over_particles(const run *r, double (*in)(const run *, int number)) {
  double sum = 0;
  for (int n = 0; n < r->deck->interaction_count; n++)
    sum += in(r, n);
  return sum / particles_of(r);
}

/* Of the law with the most; of laws of bonds one. */
static int most_passes(const run *r) {
  int most = 1;
  for (int n = 0; n < r->deck->interaction_count; n++) {
    const pl_law *kernel = r->laws[n].law;
    if (kernel->kind == PL_STATE && kernel->step.pass_count > most) most = kernel->step.pass_count;
  }
  return most;
}

/* --- the table -------------------------------------------------------------------------------- */

static void print_part(const char *name, double part, double seconds) {
  printf("    %-22s %6.1f %% %8.2f s\n", name, 100 * part / seconds, part);
}

static void print_parts(const run *r, double seconds) {
  const profile *p = &r->profile;
  const int passes = most_passes(r);
  double known = 0;
  for (int k = 0; k < PROFILE_PART_COUNT; k++) {
    known += p->part[k];
    if (k != PROFILE_LAW || passes == 1) {
      print_part(profile_names[k], p->part[k], seconds);
      continue;
    }
    double between = p->part[PROFILE_LAW];
    for (int number = 0; number < passes && number < BODY_TIMED_PASSES; number++) {
      char name[40];
      snprintf(name, sizeof name, "law, pass %d of %d", number + 1, passes);
      print_part(name, p->pass[number], seconds);
      between -= p->pass[number];
    }
    print_part("law, between passes", pl_fmax(between, 0), seconds);
  }
  print_part("rest", seconds - known, seconds);
}

/* Whether what the run holds stays in the second caches of its threads, as far as the system
   tells how large these are. */
static bool stays_in_caches(const run *r) {
#ifdef _SC_LEVEL2_CACHE_SIZE
  const long cache = sysconf(_SC_LEVEL2_CACHE_SIZE);
  return cache > 0 &&
         simulation_memory(r->simulation) < (double)cache * simulation_threads(r->simulation);
#else
  (void)r;
  return false;
#endif
}

static const char *limit_of(const run *r, double share_of_triad) {
  const double *part = r->profile.part, steps = part[PROFILE_LAW] + part[PROFILE_PARTICLES];
  if (part[PROFILE_WAITING] > 0.5 * steps)
    return "threads that wait for each other: a body with few rows runs as fast with fewer";
  if (part[PROFILE_SAMPLING] > steps)
    return "sampling: samples can be further apart (output.sample)";
  if (part[PROFILE_WRITING] > steps) return "writing: frames can be fewer (output.frames)";
  if (part[PROFILE_LOADS] > steps) return "loads and monitors";
  return share_of_triad > 0.6 && !stays_in_caches(r) ? "memory" : "the operations of the law";
}

void print_profile(const run *r, double seconds, long steps) {
  const int threads = simulation_threads(r->simulation);
  if (steps <= 0 || seconds <= 0) return;
  printf("  profile    %.2f s, %d thread%s\n", seconds, threads,
         threads == 1 ? "" : "s, their mean");
  print_parts(r, seconds);
  const double each = seconds / (double)steps / particles_of(r);
  const double bytes = mean_over_particles(r, bytes_in),
               operations = mean_over_particles(r, operations_in), peak = triad(threads);
  printf("    a particle's step: %.3g ns, %.0f bytes, %.0f operations: %.3g GB/s, %.0f %% of this "
         "machine's %.3g GB/s, %.3g Gflop/s\n",
         1e9 * each, bytes, operations, 1e-9 * bytes / each, 100 * bytes / each / peak, 1e-9 * peak,
         1e-9 * operations / each);
  printf("    limited by %s\n", limit_of(r, bytes / each / peak));
}
