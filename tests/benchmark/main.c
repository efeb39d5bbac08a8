/* The benchmark: ratios of programs that compute the same thing, taken in turn in one process, medians of at least five
   rounds. Prints tables and writes a flat object of named figures.

     benchmark [--parts bonds,families,runs,lammps] [result.json] */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "tests/benchmark/measure.h"

typedef struct part {
  const char *name;
  bool (*measure)(figures *f);
} part;

static const part parts[] = {{"bonds", benchmark_bonds},
                             {"families", benchmark_families},
                             {"runs", benchmark_runs},
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
  figures_close(f);
  return fair ? EXIT_SUCCESS : EXIT_FAILURE;
}
