/* The linear peridynamic solid against that of LAMMPS (pair style peri/lps, Parks et al. 2008,
   2010), where `lmp` is on the path: a free cubic block in space that flies apart and shears.
   LAMMPS weighs bonds by 1/length and counts a part of the volumes near the horizon, so the law
   here is written with both. Kinetic energies are compared before times; what LAMMPS prints as
   potential energy is a density in which deviatoric parts count half. Its time includes the search
   for contacts that this style always does. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "runtime/base/subnormals.h"
#include "tests/benchmark/measure.h"
#include "tests/benchmark/trial.h"

enum { ROUNDS = 5, SIDE = 30, STEPS = 10 };
#define SPACING   0.01 /* m */
#define TIME_STEP 1e-6 /* s */
#define E_MODULUS 25e9 /* Pa */
#define NU        0.2
#define RHO       2323.0
#define AGREEMENT 1e-6 /* of the kinetic energy that the bonds took, relative */

static const char *const law_text =
    "model lps_of_lammps\n"
    "  law state\n"
    "  for space\n"
    "  parameter E   = 25 [GPa]       in (0, inf)   \"Young's modulus\"\n"
    "  parameter nu  = 0.2            in [0, 0.5)   \"Poisson's ratio\"\n"
    "  parameter rho = 2323 [kg/m^3]  in (0, inf)   \"mass density\"\n"
    "  parameter s_0 = 10             in (0, inf)   \"critical stretch\"\n"
    "  damage omega on bond  \"1: broken\"\n"
    "  constant mu = E/(2*(1 + nu))\n"
    "  constant k  = E/(3*(1 - 2*nu))\n"
    "  omega[j] = | 1   when stretch[j] >= s_0  jump\n"
    "             | 0   otherwise\n"
    "  weighted_volume = sum(weight*s*V[j])\n"
    "  dilatation = 3/weighted_volume*sum((1 - omega[j])*weight*s*stretch[j]*V[j])\n"
    "  e_d[j] = s*(stretch[j] - dilatation/3)\n"
    "  force state T[j] = (1 - omega[j])*weight/weighted_volume*(3*k*dilatation + 15*mu*e_d[j]/s)\n"
    "end model\n";

static const char *const input_text =
    "units si\n"
    "boundary s s s\n"
    "atom_style peri\n"
    "atom_modify map array\n"
    "neighbor 0.001 bin\n"
    "lattice sc %.17g\n"
    "region all block -1 2 -1 2 -1 2 units box\n"
    "region body block %.17g %.17g %.17g %.17g %.17g %.17g units box\n"
    "create_box 1 all\n"
    "create_atoms 1 region body\n"
    "pair_style peri/lps\n"
    "pair_coeff * * %.17g %.17g %.17g 10 0\n"
    "set group all density %.17g\n"
    "set group all volume %.17g\n"
    "velocity all ramp vx 0 30 x 0 0.3 units box\n"
    "velocity all ramp vy 0 15 x 0 0.3 sum yes units box\n"
    "fix 1 all nve\n"
    "timestep %.17g\n"
    "thermo %d\n"
    "thermo_style custom step ke\n"
    "thermo_modify format float %%.15g\n"
    /* finds the bonds only after the first forces, without which it takes 0 for the critical
       stretch */
    "run 0\n"
    "run %d\n";

typedef struct block_result {
  double kinetic, lost; /* J: at the beginning, and less after STEPS */
  double seconds;       /* of the processor, a step */
} block_result;

/* --- LAMMPS ----------------------------------------------------------------------------------- */

static void write_file(const char *path, const char *text) {
  FILE *out = fopen(path, "w");
  if (!out || fputs(text, out) < 0 || fclose(out) != 0) give_up("%s cannot be written", path);
}

static void write_input(const char *path) {
  char text[4096];
  const double low = -SPACING / 2, high = (SIDE - 0.5) * SPACING;
  snprintf(text, sizeof text, input_text, SPACING, low, high, low, high, low, high,
           E_MODULUS / (3 * (1 - 2 * NU)), E_MODULUS / (2 * (1 + NU)), 3.015 * SPACING, RHO,
           pow(SPACING, 3), TIME_STEP, STEPS, STEPS);
  write_file(path, text);
}

/* LAMMPS takes densities for masses: its energies are times the volume of a particle. */
static block_result run_lammps(const char *input) {
  char command[300], line[1000];
  double value, percent;
  int step;
  block_result r = {NAN, NAN, NAN};
  snprintf(command, sizeof command, "OMP_NUM_THREADS=1 lmp -in %s -log none 2>&1", input);
  FILE *in = popen(command, "r");
  if (!in) give_up("lmp does not start");
  while (fgets(line, sizeof line, in)) {
    if (sscanf(line, "Loop time of %lf on", &value) == 1)
      r.seconds = value / STEPS;
    else if (strstr(line, "% CPU use") && sscanf(line, "%lf", &percent) == 1)
      r.seconds *= percent / 100;
    else if (sscanf(line, " %d %lf", &step, &value) == 2 && step == 0 && isnan(r.kinetic))
      r.kinetic = value * pow(SPACING, 3);
    else if (sscanf(line, " %d %lf", &step, &value) == 2 && step == STEPS && isnan(r.lost))
      r.lost = r.kinetic - value * pow(SPACING, 3);
  }
  if (pclose(in) != 0 || isnan(r.lost) || isnan(r.seconds))
    give_up("lmp failed: run `lmp -in %s`", input);
  return r;
}

/* --- here ------------------------------------------------------------------------------------- */

typedef struct block {
  trial *trial;
  double *before[3]; /* velocities half a step earlier */
} block;

static void set_velocities(sweep *w) {
  for (long q = 0; q < w->body->lattice->size; q++) {
    const double part = w->body->lattice->present[q] ? w->body->lattice->x[q] / 0.3 : 0;
    for (int d = 0; d < 3; d++)
      w->body->displacement[d][q] = 0;
    w->body->velocity[0][q] = 30 * part;
    w->body->velocity[1][q] = 15 * part;
    w->body->velocity[2][q] = 0;
  }
}

static double kinetic_energy(const block *b, const sweep *w) {
  double sum = 0;
  for (int d = 0; d < 3; d++)
    for (long q = 0; q < w->body->lattice->size; q++) {
      const double v = 0.5 * (b->before[d][q] + w->body->velocity[d][q]);
      sum += 0.5 * w->body->mass[d] * v * v;
    }
  return sum;
}

static void keep_velocities(block *b, const sweep *w) {
  for (int d = 0; d < 3; d++)
    memcpy(b->before[d], w->body->velocity[d], (size_t)w->body->lattice->size * sizeof(double));
}

static void steps_of(sweep *w, long steps) {
  for (long step = 0; step < steps; step++)
    if (!sweep_step(w)) give_up("the block's motion went bad");
}

/* At rest in the bonds the first kick is none: velocities then stand half a step after the
   displacements, as they do in LAMMPS within a step. */
static block_result run_here(block *b) {
  sweep *w = simulation_state(b->trial->run, 0);
  block_result r;
  set_velocities(w);
  keep_velocities(b, w);
  r.kinetic = kinetic_energy(b, w);
  const double begun = processor_seconds();
  steps_of(w, STEPS);
  r.seconds = (processor_seconds() - begun) / STEPS;
  keep_velocities(b, w);
  steps_of(w, 1);
  r.lost = r.kinetic - kinetic_energy(b, w);
  return r;
}

static void open_block(block *b, const char *folder) {
  char path[200], text[2000];
  snprintf(path, sizeof path, "%s/lps_of_lammps.plm", folder);
  write_file(path, law_text);
  snprintf(text, sizeof text,
           "&simulation end_time = 1 step = %.17g threads = 1 /\n"
           "&lattice name = 'l' kind = 'cubic' spacing = %.17g horizon = 3.015 volume_correction = "
           "'linear' /\n"
           "&body lattice = 'l' shape = 'box' corner = 0, 0, 0 size = %.17g, %.17g, %.17g /\n"
           "&material lattice = 'l' model = '%s' /\n&output energy = .false. /\n",
           TIME_STEP, SPACING, (SIDE - 1) * SPACING, (SIDE - 1) * SPACING, (SIDE - 1) * SPACING,
           path);
  b->trial = trial_open(text);
  const rows *g = simulation_rows(b->trial->run, 0);
  if (g->particle_count != SIDE * SIDE * SIDE)
    give_up("the block has %ld particles", g->particle_count);
  for (int d = 0; d < 3; d++)
    b->before[d] = must_calloc((size_t)g->size, sizeof(double));
}

static void close_block(block *b) {
  for (int d = 0; d < 3; d++)
    free(b->before[d]);
  trial_close(b->trial);
}

static bool compare(figures *f, block *b, const char *folder) {
  char input[200];
  double theirs[ROUNDS], ours[ROUNDS], difference = 0;
  snprintf(input, sizeof input, "%s/in.lps", folder);
  write_input(input);
  const unsigned environment = subnormals_off();
  for (int round = 0; round < ROUNDS; round++) {
    const block_result lammps = run_lammps(input), here = run_here(b);
    difference = fmax(difference, fabs(here.lost / lammps.lost - 1));
    theirs[round] = lammps.seconds;
    ours[round] = here.seconds;
  }
  subnormals_restore(environment);
  const double particles = SIDE * SIDE * SIDE;
  printf("  LAMMPS %.2f, generated %.2f million particle-steps a second: %.1f times; energy the "
         "bonds took differs by %.1e\n",
         1e-6 * particles / median_of(theirs, ROUNDS), 1e-6 * particles / median_of(ours, ROUNDS),
         median_of(theirs, ROUNDS) / median_of(ours, ROUNDS), difference);
  figures_add(f, 1e-6 * particles / median_of(theirs, ROUNDS),
              "lammps_lps_million_particle_steps_per_second");
  figures_add(f, median_of(theirs, ROUNDS) / median_of(ours, ROUNDS), "lps_times_lammps");
  if (difference <= AGREEMENT) return true;
  fprintf(stderr, "benchmark: LAMMPS computes something else\n");
  return false;
}

bool benchmark_lammps(figures *f) {
  char folder[] = "/tmp/perilat-benchmark-XXXXXX", command[100];
  block b;
  printf("\nLAMMPS, peri/lps, cubic block of %d particles, horizon 3.015, one core\n",
         SIDE * SIDE * SIDE);
  if (system("command -v lmp >/dev/null 2>&1") != 0) {
    printf("  skipped: there is no `lmp` on the path (Debian, Ubuntu: apt-get install lammps)\n");
    return true;
  }
  if (!mkdtemp(folder)) give_up("no folder for LAMMPS");
  open_block(&b, folder);
  const bool fair = compare(f, &b, folder);
  close_block(&b);
  snprintf(command, sizeof command, "rm -r %s", folder);
  if (system(command) != 0) give_up("%s stays behind", folder);
  return fair;
}
