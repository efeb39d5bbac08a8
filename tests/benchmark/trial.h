/* A run, or only its lattice and kernel, from a deck's text: what the parts of the benchmark about
   whole runs begin with. */
#ifndef PERILAT_BENCHMARK_TRIAL_H
#define PERILAT_BENCHMARK_TRIAL_H

#include "generator/kernel/model.h"
#include "runtime/interaction/interaction.h"
#include "runtime/simulation/simulation.h"

typedef struct trial {
  source_set sources;
  diagnostics said;
  arena *memory;
  const deck *deck;
  deck_material material; /* its own, without the options */
  model model;
  simulation_law law;
  simulation *run;
} trial;

/* A square plate of the hexagonal lattice, about `particles`, spacing 10 mm, free of loads; `more`
   are further keys of &simulation and groups, in that order. */
void trial_plate_text(char *text, size_t size, double particles, const char *model_name,
                      const char *simulation_keys, const char *groups);
/* Ends the program, after the diagnostics, when the deck is faulty. The particles start at rest,
   but for random displacements that stretch bonds by about 1e-5. */
trial *trial_open(const char *deck_text);
/* The same; `everywhere`: with a kernel that computes everywhere what is needed only where
   something grows (law_variation). */
trial *trial_open_kernel(const char *deck_text, bool everywhere);
void trial_close(trial *t);
/* A model, opened and planned; on a lattice of so many neighbours, 0: not known. */
void trial_open_model(model *m, const char *name, int neighbours);
/* Parameters of the deck's material, with the law's defaults; malloc'ed. */
double *trial_parameters(trial *t, const pl_law *kernel);

void trial_shake(sweep *state);

#endif
