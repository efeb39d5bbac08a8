/* The benchmark: ratios of programs that compute the same thing, taken in turn in one process,
   medians of at least five rounds. Prints tables and writes a flat object of named figures.

   benchmark [--parts bonds,families,meshes,points,growth,runs,lammps] [result.json] */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "tests/benchmark/measure.h"

typedef struct part {
  const char *name;
  bool (*measure)(figures *f);
} part;

static const part parts[] = {{"bonds", benchmark_bonds},   {"families", benchmark_families},
                             {"meshes", benchmark_meshes}, {"points", benchmark_points},
                             {"growth", benchmark_growth}, {"runs", benchmark_runs},
                             {"lammps", benchmark_lammps}};
enum { PARTS = sizeof parts / sizeof *parts };

static void name_machine(figures *f) {
  char name[256], clock[64];
  processor_fact("model name", name, sizeof name);
  processor_fact("cpu MHz", clock, sizeof clock);
  printf("%s, %d cores, %s MHz as told, vectors of %d bits; compiled by gcc or clang %s\n", name,
         processor_count(), clock, vector_bits(), __VERSION__);
  figures_text(f, "processor", name);
  figures_text(f, "compiler", __VERSION__);
  figures_add(f, processor_count(), "cores");
  figures_add(f, vector_bits(), "vector_bits");
  double load;
  if (getloadavg(&load, 1) == 1) {
    figures_add(f, load, "load_before");
    if (load > 0.5)
      printf("Others use this machine: load %.1f. Figures by wall time (threads, triad, compiling, "
             "start) are worse than "
             "they would be alone.\n",
             load);
  }
}

/* What is wanted of a figure: at least this, or at most where `least` is false. */
typedef struct aim {
  const char *key, *about;
  bool least;
  double must, goal;
} aim;

static const aim aims[] = {
    {"mplm_bilinear_generated_of_handwritten", "mplm_bilinear, of hand-written", true, 0.85, 0.95},
    {"splm_concrete_generated_of_handwritten", "splm_concrete, of hand-written", true, 0.85, 0.95},
    {"splm_elastic_hexagon_generated_of_handwritten", "splm_elastic, of hand-written", true, 0.85,
     0.95},
    {"splm_elastic_fcc_generated_of_handwritten", "splm_elastic, 18 neighbours, of hand-written",
     true, 0.85, 0.95},
    {"mplm_space_generated_of_handwritten", "mplm_space, 18 neighbours, of hand-written", true,
     0.85, 0.95},
    {"lps_cubic_generated_of_handwritten", "lps, 122 neighbours, of hand-written", true, 0.85,
     0.95},
    {"von_mises_generated_of_handwritten", "von_mises, plane strain, of hand-written", true, 0.85,
     0.95},
    {"cohesive_hexagon_growth_0_times_everywhere", "cohesive, exponential, nothing grows", true,
     1.5, 1.5},
    {"mazars_plane_stress_growth_5_times_everywhere", "mazars, plane stress, 5 % grow", true, 1.5,
     1.5},
    {"mplm_bilinear_generated_times_naive", "mplm_bilinear, times naive", true, 10, 15},
    {"splm_concrete_generated_times_naive", "splm_concrete, times naive", true, 10, 15},
    {"splm_elastic_hexagon_generated_times_naive", "splm_elastic, times naive", true, 10, 15},
    {"splm_elastic_fcc_generated_times_naive", "splm_elastic, 18 neighbours, times naive", true, 10,
     15},
    {"lps_cubic_generated_times_naive", "lps, 122 neighbours, times naive", true, 10, 15},
    {"splm_concrete_generated_times_list", "splm_concrete, times list", true, 2.5, 3},
    {"splm_elastic_hexagon_generated_times_list", "splm_elastic, times list", true, 2.5, 3},
    {"splm_elastic_fcc_generated_times_list", "splm_elastic, 18 neighbours, times list", true, 2.5,
     3},
    {"lps_cubic_generated_times_list", "lps, 122 neighbours, times list", true, 2.5, 3},
    {"threads_2_over_1", "two threads over one", true, 1.7, 1.85},
    {"threads_2_over_1_8000_particles", "two threads over one, 8000 particles", true, 1.7, 1.85},
    {"threads_2_over_1_1000_particles", "two threads over one, 1000 particles", true, 1.3, 1.3},
    {"mplm_bilinear_share_of_triad", "share of the triad, two threads", true, 0.6, 0.8},
    {"mplm_bilinear_bytes_per_particle", "bytes a particle", false, 120, 80},
    {"mplm_bilinear_law_to_kernel_seconds", "mplm_bilinear, law to loaded kernel, s", false, 0.6,
     0.3},
    {"splm_concrete_law_to_kernel_seconds", "splm_concrete, law to loaded kernel, s", false, 0.6,
     0.3},
    {"frame_every_1000_steps", "a frame every 1000 steps", false, 0.05, 0.02},
    {"monitors_overhead", "monitors", false, 0.05, 0.02},
    {"splm_concrete_sample_of_monitors_in_steps", "a sample of splm_concrete, in steps", false, 1,
     0.5},
    {"mplm_bilinear_of_fast_math", "mplm_bilinear, of -ffast-math", true, 0.85, 0.92},
    {"splm_elastic_of_fast_math", "splm_elastic, of -ffast-math", true, 0.85, 0.92}};

static const char *verdict(const aim *a, double value) {
  const bool good = a->least ? value >= a->must : value <= a->must;
  const bool best = a->least ? value >= a->goal : value <= a->goal;
  return best ? "reached" : good ? "enough" : "missed";
}

static void print_aims(const figures *f) {
  printf("\n%-46s %9s %9s %9s\n", "Wanted", "measured", "at least", "better");
  for (size_t k = 0; k < sizeof aims / sizeof *aims; k++) {
    const double value = figures_value(f, aims[k].key);
    if (isnan(value)) continue;
    printf("  %-44s %9.3g %9.3g %9.3g  %s\n", aims[k].about, value, aims[k].must, aims[k].goal,
           verdict(&aims[k], value));
  }
}

int main(int argc, char **argv) {
  const char *chosen = NULL, *path = NULL;
  bool fair = true;
  for (int k = 1; k < argc; k++) {
    if (strcmp(argv[k], "--parts") == 0 && k + 1 < argc)
      chosen = argv[++k];
    else
      path = argv[k];
  }
  setvbuf(stdout, NULL, _IOLBF, 0);
  figures *f = figures_open(path);
  name_machine(f);
  for (int k = 0; k < PARTS; k++)
    if (!chosen || strstr(chosen, parts[k].name)) fair = parts[k].measure(f) && fair;
  print_aims(f);
  figures_close(f);
  return fair ? EXIT_SUCCESS : EXIT_FAILURE;
}
