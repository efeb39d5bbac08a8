#include "generator/report/report_mesh.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "dsl/base/elementary.h"
#include "generator/report/moment.h"
#include "generator/report/print_quantity.h"
#include "runtime/continuum/cells.h"
#include "runtime/lattice/regions.h"

static long count_set(const unsigned char *flags, int size) {
  long count = 0;
  for (int n = 0; n < size; n++)
    count += flags[n] != 0;
  return count;
}

/* ": 336 finite elements, 54 blended, 1362 element-free; 24 cut by holes, which take 60 nodes" */
static void print_cells(const mesh *m) {
  static const char *const words[] = {"absent", "finite elements", "blended", "element-free"};
  long count[4] = {0};
  const char *before = ": ";
  for (int c = 0; c < mesh_cell_count(m); c++)
    count[m->cell[c]]++;
  for (int k = 0; k < 4; k++) {
    if (count[k] == 0) continue;
    printf("%s%ld %s", before, count[k], words[k]);
    before = ", ";
  }
  if (m->holes.count > 0)
    printf("; %ld cut by holes, which take %ld nodes", count_set(m->cut, mesh_cell_count(m)),
           count_set(m->gone, mesh_node_count(m)));
}

/* "; groups that the deck does not name: plate, hole" */
static void print_groups(const deck *k, const char *name) {
  bool *used = regions_used(k);
  const char *before = "; groups that the deck does not name: ";
  for (int r = 0; r < k->region_count; r++) {
    const deck_region *region = &k->regions[r];
    if (!region->group || used[r] || strcmp(region->lattice, name) != 0) continue;
    printf("%s%s", before, region->name);
    before = ", ";
  }
  free(used);
}

/* "mesh       plate: 200 x 100 mm, 858 nodes of plate.msh, 1560 triangles of 3 nodes, 1.2 mm
   between neighbours at least; 1560 points" */
static void announce_lists(const cells *c, const deck *all, const deck_mesh *k) {
  const cell_lists *l = c->mesh.lists;
  long count[ELEMENT_MOST_NODES + 1] = {0};
  printf("  mesh       %s: %.6g x %.6g mm, %d nodes of %s", k->name, 1e3 * k->size[0],
         1e3 * k->size[1], l->node_count, k->file);
  for (int n = 0; n < l->count; n++)
    count[l->nodes[n]]++;
  for (int n = 3; n <= ELEMENT_MOST_NODES; n++)
    if (count[n] > 0)
      printf(", %ld %s", count[n],
             n == 4   ? "quadrilaterals"
             : n == 3 ? "triangles of 3 nodes"
                      : "triangles of 6 nodes");
  printf(", %.6g mm between neighbours at least; %d points", 1e3 * k->spacing, c->points.count);
  if (count[4] < l->count && k->dilatation == DILATATION_MEAN)
    fputs("; quadrilaterals alone take the mean dilatation", stdout);
  print_groups(all, k->name);
  putchar('\n');
}

/* "mesh       beam: 74 x 25 nodes, 3.13151 x 3.175 mm apart, 1752 cells: ...; 24048 points" */
static void announce_cells(const cells *c, const deck *all, const deck_mesh *k) {
  const mesh *m = &c->mesh;
  if (m->lists) {
    announce_lists(c, all, k);
    return;
  }
  printf("  mesh       %s: %d x %d nodes, ", k->name, m->nodes[0], m->nodes[1]);
  if (m->mapped)
    printf("at least %.6g mm apart", 1e3 * k->spacing);
  else
    printf("%.6g x %.6g mm apart", 1e3 * m->spacing[0], 1e3 * m->spacing[1]);
  printf(", %d cells", mesh_cell_count(m));
  print_cells(m);
  printf("; %d points\n", c->points.count);
}

static const char *path_of(const run *r, int interaction) {
  const char *path = r->model_of[interaction] ? r->model_of[interaction]->path : NULL;
  return path && strncmp(path, "./", 2) == 0 ? path + 2 : path;
}

static int cells_of_law(const cells *c, int number) {
  int count = 0;
  for (int n = 0; n < mesh_cell_count(&c->mesh); n++)
    count += c->mesh.cell[n] != CELL_ABSENT && cell_laws_at(&c->where, n) == number;
  return count;
}

/* "law        elastic (elastic.plm): linear; waves of 3690 and 2334 m/s"; of several laws also
   "in 336 cells of steel" */
static void announce_law(const run *r, int interaction, int number, const cells *c) {
  const pl_law *kernel = r->laws[interaction].law;
  const char *path = path_of(r, interaction);
  const double(*D)[3] = c->stiffness[number].D,
        rho = material_density(kernel, r->laws[interaction].parameters);
  printf("  law        %s", kernel->name);
  const char *region = r->deck->interactions[interaction].material->region;
  if (path) printf(" (%s)", path);
  if (c->where.count > 1)
    printf(" in %d cells%s%s", cells_of_law(c, number), region ? " of " : "", region ? region : "");
  printf(": %s; waves of %.4g and %.4g m/s%s\n", kernel->linear ? "linear" : "not linear",
         sqrt(D[0][0] / rho), sqrt(D[2][2] / rho), kernel->linear ? "" : " at rest");
}

/* "crack      notch: 19.05 mm, grows by lefm; its tip is looked at every 42 us, a sample every
   84 us" */
static void announce_crack(const run *r, const tips *t, const deck_crack *k) {
  int count = 0;
  double length = 0;
  for (int n = 1; n < k->point_count; n++)
    length += pl_hypot(k->points[2 * n] - k->points[2 * n - 2],
                       k->points[2 * n + 1] - k->points[2 * n - 1]);
  for (int n = 0; n < t->count; n++) {
    if (t->items[n].of != k) continue;
    length = t->items[n].now.length; /* outside of holes */
    count++;
  }
  printf("  crack      %s: %.6g mm, ", k->name, 1e3 * length);
  if (count == 0) {
    puts("from edge to edge: it has no tip");
    return;
  }
  if (k->grows)
    printf("grows by %s", k->model);
  else
    fputs("does not grow", stdout);
  if (r->deck->relaxation.increments > 0) {
    putchar('\n');
    return;
  }
  printf("; its tip%s looked at every %.4g us, a sample every %.4g us\n",
         count == 1 ? " is" : "s are",
         1e6 * simulation_step_limit(r->simulation)->step * (double)t->planned[0],
         1e6 * simulation_sample_interval(r->simulation));
}

void announce_mesh(const run *r, int lattice) {
  const cells *c = simulation_cells(r->simulation, lattice);
  const deck *k = r->deck;
  int number = 0;
  announce_cells(c, k, &k->lattices[lattice]);
  for (int n = 0; n < k->interaction_count; n++)
    if (k->interactions[n].lattice == lattice) announce_law(r, n, number++, c);
  for (int n = 0; n < k->crack_count && c->tips; n++)
    if (strcmp(k->cracks[n].mesh, k->lattices[lattice].name) == 0)
      announce_crack(r, c->tips, &k->cracks[n]);
}

static long count_cells(const cells *c) {
  long all = 0;
  for (int cell = 0; cell < mesh_cell_count(&c->mesh); cell++)
    all += c->mesh.cell[cell] != CELL_ABSENT;
  return all;
}

/* "cells      plate: 12 of 400 have died, the first at t = 0.31 ms" */
void conclude_deaths(const run *r) {
  for (int b = 0; b < simulation_bodies(r->simulation); b++) {
    const cells *c = simulation_cells(r->simulation, b);
    double first;
    char when[MOMENT_TEXT];
    const long died = c && cells_can_die(c) ? cells_deaths(c, &first) : 0;
    if (died == 0) continue;
    printf("  cells      %s: %ld of %ld have died", r->deck->lattices[b].name, died,
           count_cells(c));
    if (isfinite(first)) printf(", the first at %s", moment(r, first, when));
    putchar('\n');
  }
}

void put_deaths(json *w, const run *r) {
  json_put_array(w, "deaths");
  for (int b = 0; b < simulation_bodies(r->simulation); b++) {
    const cells *c = simulation_cells(r->simulation, b);
    double first;
    if (!c || !cells_can_die(c)) continue;
    json_object(w);
    json_put_text(w, "mesh", r->deck->lattices[b].name);
    json_put_integer(w, "cells", count_cells(c));
    json_put_integer(w, "died", cells_deaths(c, &first));
    json_put_number(w, "first_time", first);
    json_object_end(w);
  }
  json_array_end(w);
}
