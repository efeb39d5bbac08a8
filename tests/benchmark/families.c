/* How fast laws of families are: state-based lattices on the hexagon and on the face-centred cubic
   lattice with 18 neighbours, beams between these, the linear peridynamic solid with 122, each on
   about 100 000 particles, moved by a naive program, by a hand-written loop and by the generated
   kernel, in one process on one core.

   All must reach the same motion from the same start before anything is timed. Each is then timed
   in turn, round after round, by the thread's processor time.

   The generated kernel takes part a second time, compiled for explicit neighbours, with the same
   particles as a list. Laws may have another operator there: what it moves otherwise is named. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "dsl/semantics/law_variant.h"
#include "generator/kernel/model.h"
#include "generator/lower/lowered.h"
#include "runtime/base/subnormals.h"
#include "runtime/deck/deck_read.h"
#include "runtime/interaction/interaction.h"
#include "runtime/interaction/sweep.h"
#include "runtime/filling/lattice.h"
#include "runtime/lattice/scattered.h"
#include "runtime/simulation/simulation.h"
#include "tests/benchmark/handwritten_families.h"
#include "tests/benchmark/measure.h"
#include "tests/benchmark/naive_families.h"

enum {
  ROUNDS = 7,
  CASES = 5,
  MOST_FIELDS = 8,
  PROGRAMS = 3,
  KERNELS = 2,
  CONTESTANTS = PROGRAMS + KERNELS
};
enum { NAIVE, PLAIN, FUSED, GENERATED, LIST };
#define ROUND_SECONDS    0.08
#define AGREEMENT        1e-9 /* of displacements and velocities, relative */
#define WANTED_ADVANTAGE 15.0 /* of the hand-written loop over the naive program */

typedef struct contest {
  const char *key, *name, *model, *lattice, *body;
  const body_program *program[PROGRAMS];
  law_setting setting;
  double s_0;     /* of lps: bonds break */
  double stretch; /* of the start */
  long agreement_steps;
  /* spacings from the outline within which a list moves as a lattice does; 0: everywhere */
  double list_margin;
  arena *memory;
  source_set sources;
  diagnostics said;
  const deck *deck;
  rows *rows, *list;
  model opened[KERNELS];
  double *parameters;
  sweep *kernel[KERNELS]; /* on rows, on the list */
  family_problem problem;
  void *state[PROGRAMS];
  double difference[CONTESTANTS], changed[MOST_FIELDS]; /* after the comparison */
  long steps[CONTESTANTS];                              /* a round */
  double seconds[CONTESTANTS][ROUNDS];                  /* a step */
} contest;

#define BOX(size)                                                                                  \
  "shape = 'box' corner = 0, 0, 0 size = '" size " mm', '" size " mm', '" size " mm'"
#define PLATE "shape = 'rectangle' corner = 0, 0 size = '3160 mm', '2740 mm'"

static contest all[CASES] = {
    {.key = "splm_concrete",
     .name = "splm_concrete, hexagon, 6 neighbours",
     .model = "splm_concrete",
     .lattice = "kind = 'hexagonal' thickness = '150 mm'",
     .body = PLATE,
     .program = {&naive_concrete, &concrete_hexagon_plain, &concrete_hexagon_fused},
     .stretch = 1e-3, /* some yield, some crack */
     .agreement_steps = 60,
     .list_margin = 130}, /* other at the outline, and two spacings further in with each step */
    {.key = "splm_elastic_hexagon",
     .name = "splm_elastic, hexagon, 6 neighbours",
     .model = "splm_elastic",
     .lattice = "kind = 'hexagonal' thickness = '150 mm'",
     .body = PLATE,
     .program = {&naive_elastic, &elastic_hexagon_plain, &elastic_hexagon_fused},
     .stretch = 1e-3,
     .agreement_steps = 60,
     .list_margin = 130},
    {.key = "splm_elastic_fcc",
     .name = "splm_elastic, face-centred cubic, 18 neighbours",
     .model = "splm_elastic",
     .lattice = "kind = 'fcc' shells = 2",
     .body = BOX("410"),
     .program = {&naive_elastic, &elastic_fcc_plain, &elastic_fcc_fused},
     .setting = SETTING_SPACE,
     .stretch = 1e-3,
     .agreement_steps = 20,
     .list_margin = INFINITY} /* stiffness is shared out among the shells otherwise */,
    {.key = "mplm_space",
     .name = "mplm_space, face-centred cubic, 18 neighbours",
     .model = "mplm_space",
     .lattice = "kind = 'fcc' shells = 2",
     .body = BOX("410"),
     .program = {&naive_beams, &beams_fcc_plain, &beams_fcc_fused},
     .setting = SETTING_SPACE,
     .stretch = 1e-3,
     .agreement_steps = 20,
     .list_margin = INFINITY} /* a list knows no shells */,
    {.key = "lps_cubic",
     .name = "lps, cubic, 122 neighbours",
     .model = "lps",
     .lattice = "kind = 'cubic' horizon = 3.015",
     .body = BOX("460"),
     .program = {&naive_lps, &lps_cubic_plain, &lps_cubic_fused},
     .setting = SETTING_SPACE,
     .s_0 = 1.5e-3, /* some bonds break */
     .stretch = 1e-3,
     .agreement_steps = 5},
};

/* --- set-up ----------------------------------------------------------------------------------- */

static void build_lattice(contest *c) {
  char text[512];
  snprintf(text, sizeof text,
           "&simulation end_time = 1 /\n&lattice name = 'l' spacing = '10 mm' %s /\n"
           "&body lattice = 'l' %s /\n&material lattice = 'l' model = '%s' /\n",
           c->lattice, c->body, c->model);
  c->memory = arena_new();
  diag_begin(&c->said, &c->sources);
  int file = source_add(&c->sources, "deck", text, strlen(text));
  c->deck = deck_read(c->memory, &c->sources, file, NULL, 0, &c->said);
  c->rows = c->deck ? lattice_build(c->deck, 0, &c->said) : NULL;
  diag_print(&c->said, stderr);
  if (!c->rows) give_up("the lattice of %s cannot be built", c->name);
}

/* The same particles and bonds as a list. */
static rows *list_of(const rows *g) {
  const double part = g->dimensions == 2 ? g->site_area : g->volume;
  double *at[3] = {0}, *measure = must_calloc((size_t)g->particle_count, sizeof *measure);
  scattered from = {.points = {.dimensions = g->dimensions, .count = g->particle_count},
                    .measure = measure,
                    .spacing = g->spacing,
                    .horizon = g->horizon * (1 + BRAVAIS_REACH_TOLERANCE),
                    .stiffness_thickness = g->stiffness_thickness,
                    .mass_thickness = g->volume / part};
  long crowded;
  for (int d = 0; d < g->dimensions; d++)
    from.points.at[d] = at[d] = must_calloc((size_t)g->particle_count, sizeof **at);
  for (long p = 0; p < g->particle_count; p++) {
    double place_of[3];
    rows_place(g, g->particle_site[p], place_of);
    measure[p] = part;
    for (int d = 0; d < g->dimensions; d++)
      at[d][p] = place_of[d];
  }
  rows *list = scattered_rows(&from, &crowded);
  if (!list || list->bond_count != g->bond_count) give_up("the list has not the lattice's bonds");
  for (int d = 0; d < g->dimensions; d++)
    free(at[d]);
  free(measure);
  return list;
}

static const pl_law *compile(contest *c, model *m, bool irregular) {
  char path[4096], error[4096];
  const char *note;
  snprintf(path, sizeof path, "%s/models/%s.plm", SOURCE_DIR, c->model);
  bool good = model_open(m, path, NULL, 0);
  if (good)
    m->law = law_on_lattice(m->law, c->setting, irregular, irregular ? 0 : 2 * c->rows->directions);
  good = good && (m->law->tree->law == LAW_STATE
                      ? model_plan(m)
                      : model_plan_of_families(m, &(law_variation){.varying_count = 0}));
  diag_print(&m->said, stderr);
  const pl_law *kernel = good ? model_kernel(m, false, &note, error, sizeof error) : NULL;
  if (!kernel) give_up("%s: %s", c->model, good ? error : "the law cannot be compiled");
  return kernel;
}

static void set_parameters(contest *c, const pl_law *kernel) {
  family_problem *p = &c->problem;
  c->parameters = must_calloc((size_t)kernel->parameter_count + 1, sizeof *c->parameters);
  for (int k = 0; k < kernel->parameter_count; k++) {
    const char *name = kernel->parameters[k].name;
    c->parameters[k] = kernel->parameters[k].initial;
    if (strcmp(name, "s_0") == 0) c->parameters[k] = c->s_0;
#define X(of)                                                                                      \
  if (strcmp(name, #of) == 0) p->of = c->parameters[k];
    FAMILY_PARAMETERS(X)
#undef X
  }
}

static void open_contest(contest *c) {
  build_lattice(c);
  c->list = list_of(c->rows);
  for (int k = 0; k < KERNELS; k++) {
    rows *g = k ? c->list : c->rows;
    const pl_law *law_here = compile(c, &c->opened[k], k > 0);
    if (k == 0) set_parameters(c, law_here);
    rows_set_density(g, c->problem.rho);
    c->problem.time_step = 0.1 * g->spacing / sqrt(c->problem.E / c->problem.rho);
    c->kernel[k] =
        interaction_new(g, law_here, c->parameters, c->problem.time_step, 1, false, false);
  }
  c->problem.lattice = c->rows;
  for (int k = 0; k < PROGRAMS; k++)
    c->state[k] = c->program[k]->start(&c->problem);
}

static void close_contest(contest *c) {
  for (int k = 0; k < PROGRAMS; k++)
    c->program[k]->end(c->state[k]);
  for (int k = 0; k < KERNELS; k++) {
    sweep_free(c->kernel[k]);
    model_close(&c->opened[k]);
  }
  rows_free(c->rows);
  rows_free(c->list);
  free(c->parameters);
  diag_clear(&c->said);
  source_clear(&c->sources);
  arena_free(c->memory);
}

/* --- contestants ------------------------------------------------------------------------------ */

/* Particles have the same numbers on the lattice and in the list, but not the same sites. */
static void set_sweep(sweep *w, const rows *lattice, const motions *from) {
  for (int d = 0; d < w->body->dof; d++)
    for (long p = 0; p < lattice->particle_count; p++) {
      const long here = w->body->lattice->particle_site[p], there = lattice->particle_site[p];
      w->body->displacement[d][here] = from->displacement[d][there];
      w->body->velocity[d][here] = from->velocity[d][there];
    }
  for (int f = 0; f < w->law->field_count; f++)
    for (long k = 0; k < sweep_planes(w, w->law->fields[f].place) * w->body->lattice->size; k++)
      w->field[f][k] = w->law->fields[f].initial;
  sweep_fields_set(w);
}

static void get_sweep(const sweep *w, const rows *lattice, motions *to) {
  for (int d = 0; d < w->body->dof; d++)
    for (long p = 0; p < lattice->particle_count; p++) {
      const long here = w->body->lattice->particle_site[p], there = lattice->particle_site[p];
      to->displacement[d][there] = w->body->displacement[d][here];
      to->velocity[d][there] = w->body->velocity[d][here];
    }
}

static void set_contestant(contest *c, int k, const motions *from) {
  if (k < PROGRAMS)
    c->program[k]->set(c->state[k], from);
  else
    set_sweep(c->kernel[k - PROGRAMS], c->rows, from);
}

static void get_motions(const contest *c, int k, motions *to) {
  if (k < PROGRAMS)
    c->program[k]->get(c->state[k], to);
  else
    get_sweep(c->kernel[k - PROGRAMS], c->rows, to);
}

static void advance(contest *c, int k, long steps) {
  if (k < PROGRAMS) {
    c->program[k]->advance(c->state[k], steps);
    return;
  }
  for (long step = 0; step < steps; step++)
    if (!sweep_step(c->kernel[k - PROGRAMS]))
      give_up("the generated kernel of %s ran away", c->model);
}

/* Share of a field's values that are not 0 any more. */
static double changed_share(const sweep *w, int f) {
  const rows *g = w->body->lattice;
  double changed = 0, values = 0;
  for (long k = 0; k < sweep_planes(w, w->law->fields[f].place); k++)
    for (long p = 0; p < g->particle_count; p++, values++)
      changed += w->field[f][k * g->size + g->particle_site[p]] != 0;
  return changed / values;
}

static bool compare(contest *c) {
  const int dof = c->kernel[0]->law->dof;
  motions start = motions_new(c->rows, dof), first = motions_new(c->rows, dof),
          other = motions_new(c->rows, dof);
  bool fair = true;
  motions_start(&start, &c->problem, c->stretch);
  for (int k = 0; k < CONTESTANTS; k++) {
    set_contestant(c, k, &start);
    advance(c, k, c->agreement_steps);
    get_motions(c, k, k ? &other : &first);
    if (k)
      c->difference[k] =
          motions_difference(&first, &other, c->rows, k == LIST ? c->list_margin : 0);
    fair = fair && c->difference[k] <= AGREEMENT;
  }
  for (int f = 0; f < c->kernel[0]->law->field_count; f++)
    c->changed[f] = changed_share(c->kernel[0], f);
  motions_free(&start);
  motions_free(&first);
  motions_free(&other);
  return fair;
}

/* --- timing ----------------------------------------------------------------------------------- */

static double time_steps(contest *c, int k, long steps) {
  const double begun = processor_seconds();
  advance(c, k, steps);
  return (processor_seconds() - begun) / (double)steps;
}

/* From the state that the comparison left: the same for all. */
static void measure(void) {
  for (int n = 0; n < CASES; n++)
    for (int k = 0; k < CONTESTANTS; k++)
      all[n].steps[k] = (long)(ROUND_SECONDS / time_steps(&all[n], k, 1)) + 1;
  for (int round = 0; round < ROUNDS; round++)
    for (int n = 0; n < CASES; n++)
      for (int k = 0; k < CONTESTANTS; k++)
        all[n].seconds[k][round] = time_steps(&all[n], k, all[n].steps[k]);
}

static void report(figures *f, const contest *c) {
  static const char *const name[] = {"naive", "hand-written", "hand-written, fused", "generated",
                                     "generated for lists"};
  static const char *const key[] = {"naive", "handwritten", "handwritten_fused", "generated",
                                    "generated_list"};
  double median[CONTESTANTS];
  printf("\n%s: %ld particles", c->name, c->rows->particle_count);
  for (int field = 0; field < c->kernel[0]->law->field_count; field++)
    printf("%s %s in %.1f %%", field ? "," : "; when compared,",
           c->kernel[0]->law->fields[field].name, 100 * c->changed[field]);
  printf("\n  %-20s %14s %8s %8s %8s %11s\n", "", "1e6 steps/s", "spread", "x naive", "of best",
         "difference");
  for (int k = 0; k < CONTESTANTS; k++) {
    median[k] = median_of(c->seconds[k], ROUNDS);
    const double rate = 1e-6 * (double)c->rows->particle_count / median[k];
    printf("  %-20s %14.2f %7.1f%% %8.1f", name[k], rate, 100 * spread_of(c->seconds[k], ROUNDS),
           median[NAIVE] / median[k]);
    if (k) printf(" %7.0f%%", 100 * median[PLAIN] / median[k]);
    if (k && !(k == LIST && isinf(c->list_margin))) printf(" %11.1e", c->difference[k]);
    puts(k == LIST && c->list_margin > 0 ? isinf(c->list_margin) ? "   another operator" : " inside"
                                         : "");
    figures_add(f, rate, "%s_%s_million_particle_steps_per_second", c->key, key[k]);
    if (k) figures_add(f, median[NAIVE] / median[k], "%s_%s_times_naive", c->key, key[k]);
  }
  figures_add(f, median[PLAIN] / median[GENERATED], "%s_generated_of_handwritten", c->key);
  figures_add(f, median[FUSED] / median[GENERATED], "%s_generated_of_handwritten_fused", c->key);
  figures_add(f, median[LIST] / median[GENERATED], "%s_generated_times_list", c->key);
}

bool benchmark_families(figures *f) {
  bool fair = true;
  printf("\nLaws of families: million particle-steps a second, one core, medians of %d rounds\n",
         ROUNDS);
  for (int n = 0; n < CASES; n++)
    open_contest(&all[n]);
  const unsigned environment = subnormals_off();
  for (int n = 0; n < CASES; n++)
    fair = compare(&all[n]) && fair;
  measure();
  subnormals_restore(environment);
  for (int n = 0; n < CASES; n++) {
    report(f, &all[n]);
    close_contest(&all[n]);
  }
  if (!fair) fprintf(stderr, "benchmark: programs of one law move differently\n");
  return fair;
}
