/* What laws of a point cost on finite elements of 2 x 2 points, while a loading grows in which part
   of the points yield or break: one of them beside a hand-written program, all of them in points a
   second and memory. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "dsl/base/arena.h"
#include "runtime/continuum/cells.h"
#include "tests/benchmark/handwritten_points.h"
#include "tests/benchmark/measure.h"
#include "tests/benchmark/trial.h"

enum { ROUNDS = 5, STEPS = 100, SIDE = 151, TEXT = 2048 };
#define WIDTH     0.1 /* m */
#define THICKNESS 1.0

/* --- a mesh under load ------------------------------------------------------------------------ */

typedef struct loaded {
  trial *trial;
  const cells *cells;
  point_forces *points;
  pool *memory;
  double *shape[2], *u[2];     /* planes of the layout; shape: of a mean strain of 1 */
  double *force[2], *other[2]; /* other: of a program beside */
} loaded;

/* Strains differ from point to point, and do so slowly. */
static void shape_of(const double at[2], double u[2]) {
  const double x = at[0] / WIDTH, y = at[1] / WIDTH;
  u[0] = WIDTH * (x + 0.1 * sin(6 * x + 4 * y));
  u[1] = WIDTH * (-0.3 * y + 0.08 * sin(5 * y - 3 * x));
}

static void open_planes(loaded *l) {
  const node_layout *at = &l->points->strips.layout;
  for (int d = 0; d < 2; d++) {
    l->shape[d] = pool_doubles(l->memory, at->size);
    l->u[d] = pool_doubles(l->memory, at->size);
    l->other[d] = pool_doubles(l->memory, at->size);
    l->force[d] = pool_doubles(l->memory, at->size);
  }
  for (int n = 0; n < mesh_node_count(&l->cells->mesh); n++) {
    double at_node[2], u[2];
    mesh_place(&l->cells->mesh, n, at_node);
    shape_of(at_node, u);
    for (int d = 0; d < 2; d++)
      l->shape[d][node_layout_at(at, n)] = u[d];
  }
}

/* Linear laws are asked at their points all the same. */
static loaded loaded_open(const char *law_name, const char *setting, bool ledger) {
  char text[TEXT];
  snprintf(text, sizeof text,
           "&simulation end_time = 1 /\n"
           "&mesh name = 'm' corner = 0, 0 size = %g, %g thickness = %g setting = '%s' "
           "nodes = %d, %d method = 'finite_elements' /\n"
           "&material mesh = 'm' model = '%s' /\n",
           WIDTH, WIDTH, THICKNESS, setting, SIDE, SIDE, law_name);
  loaded l = {.trial = trial_open(text), .memory = pool_new()};
  l.cells = simulation_cells(l.trial->run, 0);
  l.points = point_forces_new(&l.cells->mesh, NULL, &l.cells->points, l.trial->law.law,
                              l.trial->law.parameters, 2, ledger);
  open_planes(&l);
  return l;
}

static void loaded_close(loaded *l) {
  pool_free(l->memory);
  point_forces_free(l->points);
  trial_close(l->trial);
}

static void load(loaded *l, double strain) {
  const long size = l->points->strips.layout.size;
  for (int d = 0; d < 2; d++)
    for (long k = 0; k < size; k++)
      l->u[d][k] = strain * l->shape[d][k];
}

/* All points as they were made. */
static void rest(loaded *l) {
  point_forces *p = l->points;
  const long count = p->strips.count;
  for (int f = 0; f < p->law->field_count; f++)
    for (long k = 0; k < count; k++)
      p->old_field[f * count + k] = p->new_field[f * count + k] = p->law->fields[f].initial;
}

/* Forces and new states, by so many threads. */
static void find(loaded *l, int threads) {
  const double *const u[2] = {l->u[0], l->u[1]};
  const point_motion at = {u, u, 0, 1e-9, 0};
  const int count = l->cells->mesh.nodes[1];
#pragma omp parallel num_threads(threads) if (threads > 1)
  for (int take = 0; take < 2; take++) {
#pragma omp for schedule(static)
    for (int block = 0; block < threads; block++) {
      const int from = block * count / threads, to = (block + 1) * count / threads;
      if (!take) point_forces_find(l->points, block, from, to, &at, false, l->force);
      for (int row = from; row < to && take; row++)
        point_forces_take(l->points, row, false, l->force);
    }
  }
  point_forces_turn(l->points, 0);
}

/* Part of the points whose states the last step has changed. */
static double part_that_changes(const loaded *l) {
  const point_forces *p = l->points;
  const long count = p->strips.count;
  long changed = 0, there = 0;
  for (long k = 0; k < count; k++) {
    bool here = false;
    for (int f = 0; f < p->law->field_count; f++)
      here = here || p->old_field[f * count + k] != p->new_field[f * count + k];
    there += p->strips.volume[k] > 0;
    changed += here && p->strips.volume[k] > 0;
  }
  return (double)changed / (double)there;
}

/* --- beside a hand-written program ------------------------------------------------------------ */

static double parameter_of(const loaded *l, const char *name) {
  const pl_law *of = l->trial->law.law;
  for (int k = 0; k < of->parameter_count; k++)
    if (strcmp(of->parameters[k].name, name) == 0) return l->trial->law.parameters[k];
  give_up("%s has no parameter %s", of->name, name);
}

static plastic_plate *plate_for(const loaded *l, const plastic_program *by) {
  const plastic_material m = {parameter_of(l, "E"), parameter_of(l, "nu"), parameter_of(l, "f_y"),
                              parameter_of(l, "H"), parameter_of(l, "H_kin")};
  return by->open(&l->points->strips.layout, l->cells->mesh.spacing, THICKNESS, &m);
}

/* Largest difference and largest value. */
typedef struct gap {
  double most, largest;
} gap;

static void gap_add(gap *g, double a, double b) {
  const double difference = fabs(a - b);
  g->most = difference <= g->most ? g->most : difference; /* what is no number stays */
  g->largest = fmax(g->largest, fabs(a));
}

/* The program by hand keeps eps_bar, xx, yy, zz, xy; the law all but zz. */
static gap states_apart(const loaded *l, const plastic_program *by, const plastic_plate *plate) {
  const cell_strips *s = &l->points->strips;
  const mesh *m = &l->cells->mesh;
  static const int kept[] = {0, 1, 2, 4};
  gap g = {0, 0};
  for (int cell = 0; cell < mesh_cell_count(m); cell++)
    for (int k = 0; k < 4; k++) {
      const int i = cell % (m->nodes[0] - 1), j = cell / (m->nodes[0] - 1);
      const double *at = l->cells->points.at[l->cells->points.first[cell] + k];
      double state[5];
      by->state(plate, i, j, at[0] > mesh_at(m, 0, i) + 0.5 * m->spacing[0],
                at[1] > mesh_at(m, 1, j) + 0.5 * m->spacing[1], state);
      for (int f = 0; f < 4; f++)
        gap_add(&g, l->points->old_field[f * (long)s->count + s->of_cell[cell] + k * PL_LANES],
                state[kept[f]]);
    }
  return g;
}

static gap forces_apart(const loaded *l) {
  gap g = {0, 0};
  for (int d = 0; d < 2; d++)
    for (int n = 0; n < mesh_node_count(&l->cells->mesh); n++) {
      const long at = node_layout_at(&l->points->strips.layout, n);
      gap_add(&g, l->force[d][at], l->other[d][at]);
    }
  return g;
}

static bool near(const char *what, gap g) {
  if (g.most <= 1e-12 * g.largest && g.largest > 0) return true;
  printf("  %s differ by %.3g of the largest\n", what, g.most / g.largest);
  return false;
}

enum { GENERATED, HANDWRITTEN, FUSED, PROGRAMS };

/* Seconds of each program in each step: the least of all loadings, so that what others take from
   the machine counts for little. */
typedef struct least_times {
  double of[PROGRAMS][STEPS];
} least_times;

static void note_time(least_times *t, int program, int step, double begun) {
  double *least = &t->of[program][step], taken = processor_seconds() - begun;
  *least = *least > 0 ? fmin(*least, taken) : taken;
}

/* One loading. False where programs differ. */
static bool load_all(loaded *l, plastic_plate *const plate[2], double strain, least_times *t,
                     double *changes) {
  static const plastic_program *const by[] = {&plastic_plain, &plastic_fused};
  const double *const u[2] = {l->u[0], l->u[1]};
  bool fair = true;
  rest(l);
  for (int k = 0; k < 2; k++)
    by[k]->rest(plate[k]);
  for (int n = 1; n <= STEPS; n++) {
    load(l, strain * n / STEPS);
    double begun = processor_seconds();
    find(l, 1);
    note_time(t, GENERATED, n - 1, begun);
    *changes += part_that_changes(l) / STEPS;
    for (int k = 0; k < 2; k++) {
      begun = processor_seconds();
      by[k]->find(plate[k], u, l->other);
      note_time(t, HANDWRITTEN + k, n - 1, begun);
      if (n % 10 == 0 && fair)
        fair = near("forces", forces_apart(l)) &&
               (*changes == 0 || near("states", states_apart(l, by[k], plate[k])));
    }
  }
  return fair;
}

static bool measure_beside(figures *f) {
  enum { LOADINGS = 9 };
  static const char *const name[] = {"generated", "handwritten", "handwritten_fused"};
  static least_times least;
  loaded l = loaded_open("von_mises", "plane_strain", false);
  plastic_plate *plate[] = {plate_for(&l, &plastic_plain), plate_for(&l, &plastic_fused)};
  double each[PROGRAMS] = {0}, changes = 0;
  bool fair = true;
  for (int n = 0; n < LOADINGS && fair; n++) {
    changes = 0;
    fair = load_all(&l, plate, 4e-3, &least, &changes);
  }
  printf(
      "  von_mises in plane strain, %d points, %d steps, each the least of %d; %.0f %% yield in a "
      "step\n",
      l.cells->points.count, STEPS, LOADINGS, 100 * changes);
  for (int k = 0; k < PROGRAMS && fair; k++) {
    for (int n = 0; n < STEPS; n++)
      each[k] += least.of[k][n] / STEPS / l.cells->points.count;
    printf("    %-20s %6.2f ns a point and step\n", name[k], 1e9 * each[k]);
    figures_add(f, 1e9 * each[k], "von_mises_%s_nanoseconds_per_point", name[k]);
  }
  if (fair) {
    figures_add(f, each[HANDWRITTEN] / each[GENERATED], "von_mises_generated_of_handwritten");
    figures_add(f, each[FUSED] / each[GENERATED], "von_mises_generated_of_handwritten_fused");
  }
  plastic_plain.close(plate[0]);
  plastic_fused.close(plate[1]);
  loaded_close(&l);
  return fair;
}

/* --- all laws --------------------------------------------------------------------------------- */

typedef struct point_case {
  const char *law, *setting;
  double strain; /* of the last step: part of the points yield or break */
} point_case;

static const point_case cases[] = {{"elastic", "plane_strain", 1e-4},
                                   {"stiffening", "plane_strain", 1e-2},
                                   {"von_mises", "plane_strain", 4e-3},
                                   {"von_mises", "plane_stress", 4e-3},
                                   {"drucker_prager", "plane_strain", 8e-4},
                                   {"drucker_prager", "plane_stress", 8e-4},
                                   {"brittle_cracking", "plane_strain", 2e-4},
                                   {"brittle_cracking", "plane_stress", 2e-4},
                                   {"mazars", "plane_strain", 2e-4},
                                   {"mazars", "plane_stress", 2e-4},
                                   {"concrete_damage_plasticity", "plane_strain", 1e-3}};

/* Seconds a step, mean of a loading. */
static double seconds_of_loading(loaded *l, double strain, int threads, double (*clock_of)(void),
                                 double *changes) {
  double sum = 0;
  rest(l);
  *changes = 0;
  for (int n = 1; n <= STEPS; n++) {
    load(l, strain * n / STEPS);
    const double begun = clock_of();
    find(l, threads);
    sum += clock_of() - begun;
    *changes += part_that_changes(l) / STEPS;
  }
  return sum / STEPS;
}

static void measure_law(figures *f, const point_case *c) {
  loaded l = loaded_open(c->law, c->setting, false);
  const double points = l.cells->points.count;
  double one[ROUNDS], wall[ROUNDS], two[ROUNDS], changes;
  for (int round = 0; round < ROUNDS; round++) {
    one[round] = seconds_of_loading(&l, c->strain, 1, processor_seconds, &changes);
    wall[round] = seconds_of_loading(&l, c->strain, 1, wall_seconds, &changes);
    two[round] = seconds_of_loading(&l, c->strain, 2, wall_seconds, &changes);
  }
  const double by_one = median_of(one, ROUNDS),
               faster = median_of(wall, ROUNDS) / median_of(two, ROUNDS),
               bytes = (double)point_forces_bytes(l.points) / points;
  const pl_law *of = l.trial->law.law;
  printf("  %-26s %-13s %7.1f %7.2f %7.2f %6.0f %7.0f %5.0f %6.0f %%\n", c->law, c->setting,
         1e-6 * points / by_one, 1e9 * by_one / points, faster, bytes, of->flops_per_bond,
         of->divisions_per_bond, 100 * changes);
  figures_add(f, 1e-6 * points / by_one, "points_%s_%s_million_per_second", c->law, c->setting);
  figures_add(f, faster, "points_%s_%s_threads_2_over_1", c->law, c->setting);
  figures_add(f, bytes, "points_%s_%s_bytes_per_point", c->law, c->setting);
  loaded_close(&l);
}

bool benchmark_points(figures *f) {
  puts("\nPoints");
  const bool fair = measure_beside(f);
  printf("  %-40s %7s %7s %7s %6s %7s %5s %8s\n", "", "10^6/s", "ns", "2 by 1", "bytes", "flops",
         "div.", "changed");
  for (size_t k = 0; k < sizeof cases / sizeof *cases; k++)
    measure_law(f, &cases[k]);
  return fair;
}
