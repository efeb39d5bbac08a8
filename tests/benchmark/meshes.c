/* What the points of a mesh cost: forces by the assembled stencil beside those by points of
   integration in strips, of a linear law and of one that stiffens; a crack that grows beside a
   stiffness assembled afresh; a whole run of a running crack. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "dsl/base/arena.h"
#include "runtime/continuum/cells.h"
#include "tests/benchmark/measure.h"
#include "tests/benchmark/trial.h"

enum { ROUNDS = 7, TEXT = 2048 };
#define ROUND_SECONDS 0.15

/* --- forces ----------------------------------------------------------------------------------- */

typedef struct contestant {
  const node_stencil *stencil; /* or */
  point_forces *points;
  const point_motion *motion;
  double *force[2];
  int rows; /* of nodes */
  int threads;
} contestant;

static void find_block(const contestant *c, int block, bool take) {
  const int from = block * c->rows / c->threads, to = (block + 1) * c->rows / c->threads;
  if (c->stencil) {
    if (!take) node_stencil_multiply(c->stencil, c->motion->displacement, c->force, from, to);
    return;
  }
  if (!take) point_forces_find(c->points, block, from, to, c->motion, false, c->force);
  for (int row = from; row < to && take; row++)
    point_forces_take(c->points, row, false, c->force);
}

static void find(const contestant *c) {
#pragma omp parallel num_threads(c->threads) if (c->threads > 1)
  for (int take = 0; take < 2; take++) {
#pragma omp for schedule(static)
    for (int block = 0; block < c->threads; block++)
      find_block(c, block, take);
  }
}

/* Seconds of each, medians of rounds in turn. */
static void take_turns(const contestant *c, int count, double (*seconds)(void), double *median) {
  double taken[8][ROUNDS];
  long times[8];
  for (int k = 0; k < count; k++) {
    find(&c[k]);
    const double begun = seconds();
    find(&c[k]);
    times[k] = (long)(ROUND_SECONDS / (seconds() - begun)) + 1;
  }
  for (int round = 0; round < ROUNDS; round++)
    for (int k = 0; k < count; k++) {
      const double begun = seconds();
      for (long n = 0; n < times[k]; n++)
        find(&c[k]);
      taken[k][round] = (seconds() - begun) / (double)times[k];
    }
  for (int k = 0; k < count; k++)
    median[k] = median_of(taken[k], ROUNDS);
}

typedef struct mesh_case {
  const char *name, *about, *keys;
} mesh_case;

static const mesh_case cases[] = {{"wide", "76 x 76 nodes, element-free, support 3.5",
                                   "nodes = 76, 76 method = 'element_free' support = 3.5"},
                                  {"narrow", "76 x 76 nodes, element-free, support 2.1",
                                   "nodes = 76, 76 method = 'element_free' support = 2.1"},
                                  {"elements", "151 x 151 nodes, finite elements of 2 x 2 points",
                                   "nodes = 151, 151 method = 'finite_elements'"}};

static trial *open_mesh(const mesh_case *of, const char *law_name) {
  char text[TEXT];
  snprintf(text, sizeof text,
           "&simulation end_time = 1 /\n"
           "&mesh name = 'm' corner = 0, 0 size = 0.1, 0.1 thickness = 1 setting = 'plane_strain' "
           "%s /\n&material mesh = 'm' model = '%s' /\n",
           of->keys, law_name);
  return trial_open(text);
}

/* Both are sums of the same terms. */
static bool agree(const contestant *a, const contestant *b, const node_layout *l) {
  double most = 0, largest = 0;
  find(a);
  find(b);
  for (int d = 0; d < 2; d++)
    for (int n = 0; n < l->nodes[0] * l->nodes[1]; n++) {
      const long at = node_layout_at(l, n);
      most = fmax(most, fabs(a->force[d][at] - b->force[d][at]));
      largest = fmax(largest, fabs(a->force[d][at]));
    }
  if (most <= 1e-12 * largest) return true;
  printf("  stencil and points differ by %.3g of the largest force\n", most / largest);
  return false;
}

static void print_case(figures *f, const mesh_case *of, const contestant *c, const double *one,
                       const double *two) {
  const double points = c[1].points->points->count;
  const double bytes[] = {(double)point_forces_bytes(c[1].points) / points,
                          (double)point_forces_bytes(c[2].points) / points};
  printf("  %s, %.0f points\n", of->about, points);
  printf(
      "    stencil %.3g ms; points of elastic %.3g ms (x%.1f), %.3g million a second, %.0f bytes "
      "each\n",
      1e3 * one[0], 1e3 * one[1], one[1] / one[0], 1e-6 * points / one[1], bytes[0]);
  printf("    points of stiffening %.3g ms, %.3g million a second, %.0f bytes each\n", 1e3 * one[2],
         1e-6 * points / one[2], bytes[1]);
  printf("    two threads over one: stencil %.2f, points of stiffening %.2f\n", one[0] / two[0],
         one[2] / two[1]);
  figures_add(f, one[1] / one[0], "mesh_%s_stencil_times_points", of->name);
  figures_add(f, 1e-6 * points / one[1], "mesh_%s_elastic_million_points_per_second", of->name);
  figures_add(f, 1e-6 * points / one[2], "mesh_%s_stiffening_million_points_per_second", of->name);
  figures_add(f, bytes[1], "mesh_%s_bytes_per_point", of->name);
  figures_add(f, one[2] / two[1], "mesh_%s_threads_2_over_1", of->name);
}

static bool measure_case(figures *f, const mesh_case *of) {
  trial *linear = open_mesh(of, "elastic"), *bent = open_mesh(of, "stiffening");
  const cells *c = simulation_cells(linear->run, 0);
  const body *moved = simulation_state(linear->run, 0)->body;
  const double *const u[2] = {moved->displacement[0], moved->displacement[1]};
  const point_motion motion = {u, u, 0, 1e-9, 0};
  pl_law any = *linear->law.law;
  any.linear = 0;
  point_forces *of_elastic = point_forces_new(&c->mesh, NULL, &c->points, &any,
                                              linear->law.parameters, 2, true),
               *of_stiffening = point_forces_new(&c->mesh, NULL, &c->points, bent->law.law,
                                                 bent->law.parameters, 2, true);
  pool *memory = pool_new();
  contestant one[3], two[2];
  for (int k = 0; k < 3; k++) {
    one[k] = (contestant){.stencil = k == 0 ? &c->stencil : NULL,
                          .points = k == 1 ? of_elastic : of_stiffening,
                          .motion = &motion,
                          .rows = c->mesh.nodes[1],
                          .threads = 1};
    for (int d = 0; d < 2; d++)
      one[k].force[d] = pool_doubles(memory, c->stencil.layout.size);
  }
  two[0] = one[0];
  two[1] = one[2];
  two[0].threads = two[1].threads = 2;
  double by_one[3], wall_one[3], by_two[2];
  const bool fair = agree(&one[0], &one[1], &c->stencil.layout);
  take_turns(one, 3, processor_seconds, by_one);
  take_turns(one, 3, wall_seconds, wall_one);
  take_turns(two, 2, wall_seconds, by_two);
  by_two[0] *= by_one[0] / wall_one[0];
  by_two[1] *= by_one[2] / wall_one[2];
  print_case(f, of, one, by_one, by_two);
  pool_free(memory);
  point_forces_free(of_elastic);
  point_forces_free(of_stiffening);
  trial_close(linear);
  trial_close(bent);
  return fair;
}

/* --- growth ----------------------------------------------------------------------------------- */

/* Pieces of a third of a spacing, one after the other, and the whole matrix. */
static void measure_growth(figures *f) {
  enum { PIECES = 60 };
  trial *t = open_mesh(&cases[0], "elastic");
  const cells *c = simulation_cells(t->run, 0);
  mesh m = c->mesh;
  node_stencil k;
  double piece[PIECES], fresh[ROUNDS], changed = 0;
  crack_lines_open(&m.cracks);
  crack_lines_add(&m.cracks, (double[2]){0.025, 0.1}, (double[2]){0.025, 0.05});
  node_stencil_open(&k, &m, &c->points, c->stiffness, NULL);
  double a[2] = {0.025, 0.05};
  for (int n = 0; n < PIECES; n++) {
    const double b[2] = {a[0] + 0.95e-3 / 3, a[1] + 0.3e-3 / 3}, begun = processor_seconds();
    changed += node_stencil_grow(&k, &m, a, b, -1);
    piece[n] = processor_seconds() - begun;
    memcpy(a, b, sizeof a);
  }
  for (int n = 0; n < ROUNDS; n++) {
    node_stencil_close(&k);
    const double begun = processor_seconds();
    node_stencil_open(&k, &m, &c->points, c->stiffness, NULL);
    fresh[n] = processor_seconds() - begun;
  }
  node_stencil_close(&k);
  crack_lines_close(&m.cracks);
  trial_close(t);
  const double grown = median_of(piece, PIECES), all = median_of(fresh, ROUNDS);
  printf("  a crack grows by a piece (%.0f points change): %.3g ms; stiffness afresh %.3g ms: "
         "x%.0f\n",
         changed / PIECES, 1e3 * grown, 1e3 * all, all / grown);
  figures_add(f, 1e3 * grown, "mesh_growth_milliseconds");
  figures_add(f, all / grown, "mesh_afresh_times_growth");
}

/* --- a run ------------------------------------------------------------------------------------ */

/* The plate of 76 x 76 nodes at half of h/c_d, looks and pieces at the times of the deck. */
static void measure_run(figures *f) {
  static const char command[] =
      "cd \"$(mktemp -d)\" && " PERILAT_PROGRAM " run " SOURCE_DIR
      "/examples/kalthoff/m75.nml --threads 1 --set simulation.step=1.1790436e-7 "
      "--set tips.check_steps=17 --set output.result=out.h5 >/dev/null 2>&1 && rm -r \"$PWD\"";
  double seconds[3];
  for (int n = 0; n < 3; n++) {
    const double begun = wall_seconds();
    if (system(command) != 0) give_up("failed: %s", command);
    seconds[n] = wall_seconds() - begun;
  }
  printf("  examples/kalthoff/m75.nml at half of h/c_d, one thread, wall time: %.2f s\n",
         median_of(seconds, 3));
  figures_add(f, median_of(seconds, 3), "kalthoff_m75_seconds");
}

bool benchmark_meshes(figures *f) {
  bool fair = true;
  puts("\nMeshes");
  for (size_t k = 0; k < sizeof cases / sizeof *cases; k++)
    fair = measure_case(f, &cases[k]) && fair;
  measure_growth(f);
  measure_run(f);
  return fair;
}
