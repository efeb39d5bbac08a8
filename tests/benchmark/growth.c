/* Laws whose states and damage need functions, divisions and roots only where they grow
   (generator/plan/seldom.h): the kernel that leaves these out elsewhere beside that of the same law
   which computes them everywhere, while nothing grows and while a part of a body does. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "dsl/base/arena.h"
#include "runtime/continuum/cells.h"
#include "runtime/continuum/point_forces.h"
#include "tests/benchmark/measure.h"
#include "tests/benchmark/trial.h"

enum { RIVALS = 2, SHARES = 3, ROUNDS = 15, TEXT = 2048 };
#define WIDTH         0.5 /* m */
#define ROUND_SECONDS 0.02
/* Parts of a body, from its left side on, in which all grows. */
static const double shares[SHARES] = {0, 0.05, 0.5};

/* One law, by both kernels. */
typedef struct growing {
  const char *key, *about, *text; /* text: of a deck */
  double still, from, step;       /* strains: where nothing grows; there, at first and in a step */
} growing;

static double least_of(const double *values, int count) {
  double least = values[0];
  for (int k = 1; k < count; k++)
    least = values[k] < least ? values[k] : least;
  return least;
}

/* Displacement along x, of a body that is stretched by `there` in a part of its width. */
static double place_at(double x, double part, double there, double elsewhere) {
  const double end = part * WIDTH;
  return x < end ? there * x : there * end + elsewhere * (x - end);
}

/* --- bonds ------------------------------------------------------------------------------------ */

/* In steps so short that nothing but what it is given moves a particle. */
#define STEP            "1e-12 s"
#define SECONDS_OF_STEP 1e-12

static void begin_bonds(trial *t, const growing *c, double part) {
  body *b = simulation_state(t->run, 0)->body;
  const rows *g = b->lattice;
  for (long q = 0; q < g->size; q++) {
    double at[3];
    if (!g->present[q]) continue;
    rows_place(g, q, at);
    for (int d = 0; d < b->dimensions; d++)
      b->displacement[d][q] = b->velocity[d][q] = 0;
    b->displacement[0][q] = place_at(at[0], part, c->from, c->still);
    b->velocity[0][q] = place_at(at[0], part, c->step / SECONDS_OF_STEP, 0);
  }
}

static void advance(trial *t, long steps) {
  for (long until = simulation_step_done(t->run) + steps; simulation_step_done(t->run) < until;)
    if (simulation_advance(t->run, until - simulation_step_done(t->run), NULL) != STEP_OK)
      give_up("a run ended early");
}

static void measure_bonds(const growing *c, double part, double least[RIVALS]) {
  double taken[RIVALS][ROUNDS];
  trial *t[RIVALS];
  long steps = 0;
  for (int k = 0; k < RIVALS; k++) {
    t[k] = trial_open_kernel(c->text, k == 1);
    begin_bonds(t[k], c, part);
    advance(t[k], 2);
  }
  for (int round = -1; round < ROUNDS; round++)
    for (int k = 0; k < RIVALS; k++) {
      const double begun = processor_seconds();
      advance(t[k], round < 0 ? 10 : steps);
      const double seconds = processor_seconds() - begun;
      if (round >= 0) taken[k][round] = seconds / (double)steps;
      if (round < 0 && k == 0) steps = (long)(10 * ROUND_SECONDS / seconds) + 1;
    }
  for (int k = 0; k < RIVALS; k++) {
    least[k] = least_of(taken[k], ROUNDS) / (double)simulation_rows(t[k]->run, 0)->particle_count;
    trial_close(t[k]);
  }
}

/* --- points ----------------------------------------------------------------------------------- */

enum { POINT_STEPS = 20, LOADINGS = 15 };

typedef struct mesh_rival {
  trial *trial;
  const cells *cells;
  point_forces *points;
  pool *memory;
  double *u[2], *force[2];
} mesh_rival;

static mesh_rival open_mesh(const char *text, bool everywhere) {
  mesh_rival m = {.trial = trial_open_kernel(text, everywhere), .memory = pool_new()};
  m.cells = simulation_cells(m.trial->run, 0);
  m.points = point_forces_new(&m.cells->mesh, NULL, &m.cells->points, m.trial->law.law,
                              m.trial->law.parameters, 2, false);
  for (int d = 0; d < 2; d++) {
    m.u[d] = pool_doubles(m.memory, m.points->strips.layout.size);
    m.force[d] = pool_doubles(m.memory, m.points->strips.layout.size);
  }
  return m;
}

static void close_mesh(mesh_rival *m) {
  pool_free(m->memory);
  point_forces_free(m->points);
  trial_close(m->trial);
}

static void stretch_mesh(mesh_rival *m, double part, double there, double elsewhere) {
  for (int n = 0; n < mesh_node_count(&m->cells->mesh); n++) {
    double at[2];
    mesh_place(&m->cells->mesh, n, at);
    m->u[0][node_layout_at(&m->points->strips.layout, n)] = place_at(at[0], part, there, elsewhere);
  }
}

static void rest(mesh_rival *m) {
  point_forces *p = m->points;
  const long count = p->strips.count;
  for (int f = 0; f < p->law->field_count; f++)
    for (long k = 0; k < count; k++)
      p->old_field[f * count + k] = p->new_field[f * count + k] = p->law->fields[f].initial;
}

/* Seconds of a loading, without those of what strains the mesh. */
static double load(mesh_rival *m, const growing *c, double part) {
  const double *const u[2] = {m->u[0], m->u[1]};
  const point_motion at = {u, u, 0, 1e-9, 1e-9};
  const int count = m->cells->mesh.nodes[1];
  double seconds = 0;
  rest(m);
  for (int n = 0; n < POINT_STEPS; n++) {
    stretch_mesh(m, part, c->from + n * c->step, c->still);
    const double begun = processor_seconds();
    point_forces_find(m->points, 0, 0, count, &at, false, m->force);
    for (int row = 0; row < count; row++)
      point_forces_take(m->points, row, false, m->force);
    point_forces_turn(m->points, 0);
    seconds += processor_seconds() - begun;
  }
  return seconds / POINT_STEPS;
}

static void measure_points(const growing *c, double part, double least[RIVALS]) {
  double taken[RIVALS][LOADINGS];
  mesh_rival m[RIVALS] = {open_mesh(c->text, false), open_mesh(c->text, true)};
  for (int round = 0; round < LOADINGS; round++)
    for (int k = 0; k < RIVALS; k++)
      taken[k][round] = load(&m[k], c, part);
  for (int k = 0; k < RIVALS; k++) {
    least[k] = least_of(taken[k], LOADINGS) / m[k].cells->points.count;
    close_mesh(&m[k]);
  }
}

/* --- laws ------------------------------------------------------------------------------------- */

#define COHESIVE "model = 'cohesive' softening = 'exponential'"
#define PLATE                                                                                      \
  "&simulation end_time = 1 step = '" STEP "' threads = 1 /\n"                                     \
  "&output energy = .false. /\n"                                                                   \
  "&lattice name = 'l' kind = 'hexagonal' spacing = '4 mm' thickness = '0.1 m' /\n"                \
  "&body lattice = 'l' shape = 'rectangle' corner = 0, 0 size = 0.5, 0.5 /\n"
#define BLOCK                                                                                      \
  "&simulation end_time = 1 step = '" STEP "' threads = 1 /\n"                                     \
  "&output energy = .false. /\n"                                                                   \
  "&lattice name = 'l' kind = 'fcc' shells = 2 spacing = '12 mm' /\n"                              \
  "&body lattice = 'l' shape = 'box' corner = 0, 0, 0 size = 0.5, 0.2, 0.2 /\n"
#define MESH(setting)                                                                              \
  "&simulation end_time = 1 /\n"                                                                   \
  "&mesh name = 'm' corner = 0, 0 size = 0.5, 0.5 thickness = 1 setting = '" setting "' "          \
  "nodes = 151, 151 method = 'finite_elements' /\n"                                                \
  "&material mesh = 'm' model = 'mazars' /\n"

static const growing laws[] = {
    {"cohesive_hexagon", "cohesive, exponential, hexagon",
     PLATE "&material lattice = 'l' " COHESIVE " /\n", 2e-5, 5e-4, 1e-9},
    {"cohesive_fcc", "cohesive, exponential, 18 neighbours",
     BLOCK "&material lattice = 'l' " COHESIVE " /\n", 2e-5, 5e-4, 1e-9},
    {"mazars_plane_strain", "mazars, plane strain", MESH("plane_strain"), 2e-5, 1.2e-4, 1e-6},
    {"mazars_plane_stress", "mazars, plane stress", MESH("plane_stress"), 2e-5, 1.2e-4, 1e-6}};

bool benchmark_growth(figures *f) {
  puts("\nWhere nothing grows (ns a particle or point; beside: computed everywhere)");
  printf("  %-40s", "");
  for (int s = 0; s < SHARES; s++)
    printf("  %14.0f %% grow", 100 * shares[s]);
  puts("");
  for (size_t k = 0; k < sizeof laws / sizeof *laws; k++) {
    const growing *c = &laws[k];
    printf("  %-40s", c->about);
    for (int s = 0; s < SHARES; s++) {
      double least[RIVALS];
      (strstr(c->text, "&mesh") ? measure_points : measure_bonds)(c, shares[s], least);
      printf("  %5.2f %5.2f x %4.2f", 1e9 * least[0], 1e9 * least[1], least[1] / least[0]);
      figures_add(f, least[1] / least[0], "%s_growth_%.0f_times_everywhere", c->key,
                  100 * shares[s]);
    }
    puts("");
  }
  return true;
}
