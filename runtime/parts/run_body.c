#include "runtime/parts/run_body.h"

#include <math.h>
#include <omp.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

#include "dsl/base/arena.h"
#include "dsl/base/elementary.h"
#include "runtime/analysis/body_limit.h"
#include "runtime/analysis/material.h"
#include "runtime/analysis/stability.h"
#include "runtime/continuum/cell_sizes.h"
#include "runtime/continuum/cells_engine.h"
#include "runtime/continuum/line_load.h"
#include "runtime/continuum/side_load.h"
#include "runtime/continuum/tip_laws.h"
#include "runtime/deck/lattice_kind.h"
#include "runtime/filling/lattice.h"
#include "runtime/filling/linked.h"
#include "runtime/interaction/interaction.h"
#include "runtime/parts/law_fits.h"
#include "runtime/parts/step_choice.h"

/* --- what fits -------------------------------------------------------------------------------- */

static bool has_field(const deck *k, const char *lattice) {
  for (int f = 0; f < k->field_count; f++)
    if (k->fields[f].random && strcmp(k->fields[f].lattice, lattice) == 0) return true;
  return false;
}

static bool has_placed(const deck_material *m) {
  for (int n = 0; n < m->assignment_count; n++)
    if (m->assignments[n].placed) return true;
  return false;
}

static bool open_planes(const run_body *b, run_law *l, const deck *k, diagnostics *d) {
  const deck_material *m = l->from->material;
  if (!(l == b->laws && has_field(k, b->name)) && l->regional_count == 0 &&
      l->law->varying_count == 0 && !has_placed(m))
    return true;
  l->planes = parameter_planes_new(k, b->lattice, m, l->rows, l->own, l->law, l->parameters,
                                   l->regional, l->regional_count, d);
  return l->planes != NULL;
}

void run_body_go_to(run_body *b, double time) {
  for (int n = 0; n < b->law_count; n++) {
    const run_law *l = &b->laws[n];
    if (parameter_planes_go_to(l->planes, time) && b->cells && l->state)
      cells_give(l->state, l->planes->value);
  }
}

void run_body_turn(run_body *b) {
  for (int n = 0; n < b->law_count; n++) {
    const run_law *l = &b->laws[n];
    if (parameter_planes_turn(l->planes) && b->cells && l->state)
      cells_give(l->state, l->planes->value);
  }
}

static bool all_have_parameters(const run_body *b) {
  for (int n = 0; n < b->law_count; n++)
    if (!b->laws[n].parameters) return false;
  return true;
}

/* A solver has kernels of its own, and its deck may change. */
static bool is_for_one_of_several(const run_body *b, const run_law *l, diagnostics *d) {
  if (l->law->kind == PL_STATE && (l->law->pairwise || l->law->reads_share)) return true;
  diag_report(d, DIAG_NOT_SUPPORTED, deck_where(&l->from->material->item, "model"),
              "the kernel of `%s` was made for a lattice with one law, `%s` has several",
              l->law->name, b->name);
  diag_hint(d, "use `perilat run`, or build the solver from this deck again");
  return false;
}

/* A body has particles of one kind, and engines for laws of one kind. */
static bool laws_are_alike(const run_body *b, const deck *k, diagnostics *d) {
  if (deck_lattice_is_mesh(&k->lattices[b->lattice])) return true;
  for (int n = 0; n < b->law_count && b->law_count > 1; n++) {
    if (!is_for_one_of_several(b, &b->laws[n], d)) return false;
    const pl_law *first = b->law, *law = b->laws[n].law;
    const char *why = law->dof != first->dof ? "their particles have not the same rotations"
                      : law->pairwise != first->pairwise
                          ? "one is a law of bonds, the other one of families"
                          : NULL;
    if (!why) continue;
    diag_report(d, DIAG_NOT_SUPPORTED, deck_where(&b->laws[n].from->material->item, "model"),
                "the law `%s` cannot stand beside `%s` on one lattice: %s", law->name, first->name,
                why);
    diag_note(d, deck_where(&b->laws[0].from->material->item, "model"), "the lattice's law");
    diag_hint(d, "take two laws of bonds that both rotate or both do not, or two laws of families");
    return false;
  }
  return true;
}

static bool laws_fit(run_body *b, const deck *k, diagnostics *d) {
  bool good = true;
  for (int n = 0; n < b->law_count; n++) {
    run_law *l = &b->laws[n];
    l->rows = b->lattice_rows;
    l->fits =
        l->law && law_fits_lattice(l->law, l->from->material, k, b->lattice, b->lattice_rows, d);
    good = good && l->fits;
  }
  return good && laws_are_alike(b, k, d);
}

/* Of several laws: which bonds are whose; of those of a mesh, which nodes. */
static bool open_parts(run_body *b, const deck *k, diagnostics *d) {
  if (b->law_count == 1) return true;
  if (b->cells) {
    for (int n = 0; n < b->law_count; n++) {
      b->laws[n].own = b->cells->where.sites[n];
      b->laws[n].share = b->cells->where.share[n];
    }
    return true;
  }
  const int first = (int)(b->laws[0].from - k->interactions);
  const bool families = !b->law->pairwise;
  b->parts = law_parts_new(k, first, b->law_count, b->lattice_rows, families, d);
  for (int n = 0; n < b->law_count && b->parts; n++) {
    b->laws[n].rows = b->parts[n].bonds;
    b->laws[n].own = b->parts[n].own;
    b->laws[n].share = b->parts[n].share;
  }
  return b->parts != NULL;
}

/* What the engine of one of several laws sees: of families all bonds, of which they have shares. */
static interaction_law law_beside(const run_body *b, const run_law *l) {
  return (interaction_law){.law = l->law,
                           .parameters = l->parameters,
                           .varying = l->planes ? l->planes->value : NULL,
                           .lattice = l->share ? b->lattice_rows : l->rows,
                           .share = l->share};
}

static interaction_law *laws_beside(const run_body *b) {
  interaction_law *laws = must_calloc((size_t)b->law_count, sizeof *laws);
  for (int n = 0; n < b->law_count; n++)
    laws[n] = law_beside(b, &b->laws[n]);
  return laws;
}

/* Of several laws whose body flies apart, or has no stiffness, the first that does so alone. */
static const run_law *law_at_fault(const run_body *b) {
  if (stability_at_rest(&b->limit) && b->limit.limit > 0) return b->laws;
  for (int n = 0; n < b->law_count; n++) {
    const run_law *l = &b->laws[n];
    step_limit alone = {0};
    stability_limit(l->law, l->parameters, l->planes, b->lattice_rows, &alone);
    if (!stability_at_rest(&alone) || !(alone.limit > 0)) return l;
  }
  return b->laws;
}

/* Freedoms of nodes that supports or drives have. */
static unsigned char *held_freedoms(const run_body *b) {
  unsigned char *held = must_calloc(2 * (size_t)b->lattice_rows->particle_count, 1);
  for (long n = 0; n < b->loads->constraint_count; n++) {
    const constraint *c = &b->loads->constraints[n];
    held[2 * b->lattice_rows->site_particle[c->site] + c->component] = 1;
  }
  return held;
}

/* The fields of a tip are those of isotropic plates. */
static bool is_isotropic(const run_body *b, diagnostics *d) {
  const int law = b->cells->tips->law;
  const double(*D)[3] = b->cells->stiffness[law].D, scale = 1e-9 * D[0][0];
  double off = fabs(D[0][0] - D[1][1]) + fabs(D[0][1] - D[1][0]) + fabs(D[0][2]) + fabs(D[1][2]) +
               fabs(D[2][2] - 0.5 * (D[0][0] - D[0][1]));
  if (off <= scale) return true;
  diag_report(d, DIAG_CONFLICT, deck_where(&b->laws[law].from->material->item, "model"),
              "cracks need an isotropic law: stress intensities of `%s` have no meaning",
              b->laws[law].law->name);
  return false;
}

/* Where the law is stiffest at rest between the smallest and the largest values that it is given:
   `values` of these; so many looks at each. */
static void take_stiffest(const run_body *b, int number, double *values) {
  const run_law *l = &b->laws[number];
  const int fields = l->planes->count, looks = fields == 1 ? 17 : fields == 2 ? 9 : 3;
  const size_t bytes = ((size_t)l->law->parameter_count + 1) * sizeof(double);
  double *now = must_alloc(bytes), most = -INFINITY;
  long cases = 1;
  for (int k = 0; k < fields && cases < 1000; k++)
    cases *= looks;
  memcpy(now, values, bytes);
  for (long n = 0; n < cases; n++) {
    double D[3][3];
    long rest = n;
    for (int k = 0; k < fields; k++, rest /= looks)
      now[l->law->varying[k]] =
          l->planes->smallest[k] +
          (l->planes->largest[k] - l->planes->smallest[k]) * (double)(rest % looks) / (looks - 1);
    point_forces_rest(&b->cells->mesh, cell_laws_own(&b->cells->where, number), l->law, now, false,
                      D);
    const double trace = D[0][0] + D[1][1] + D[2][2];
    if (!(trace > most)) continue;
    most = trace;
    memcpy(values, now, bytes);
  }
  free(now);
}

/* Cells ask how stiff points are at rest: of a law that is given fields where it is stiffest. */
static void give_laws(run_body *b) {
  cells_law *laws = must_calloc((size_t)b->law_count, sizeof *laws);
  for (int n = 0; n < b->law_count; n++) {
    run_law *l = &b->laws[n];
    const size_t bytes = ((size_t)l->law->parameter_count + 1) * sizeof(double);
    laws[n] = (cells_law){l->law, l->parameters};
    if (!l->planes || l->law->varying_count == 0) continue;
    l->stiffest = must_alloc(bytes);
    memcpy(l->stiffest, l->parameters, bytes - sizeof(double));
    take_stiffest(b, n, l->stiffest);
    laws[n].parameters = l->stiffest;
  }
  cells_take_laws(b->cells, laws);
  free(laws);
}

/* Points have what is given at the nodes. */
static void give_points(run_body *b) {
  for (int n = 0; n < b->law_count; n++) {
    run_law *l = &b->laws[n];
    if (!l->planes || l->law->varying_count == 0) continue;
    l->state->parameter = l->planes->value;
    cells_give(l->state, l->planes->value);
  }
}

static bool cracks_suit_laws(const run_body *b, const deck *k, diagnostics *d) {
  const cells *c = b->cells;
  return !c->tips || (tip_laws_fit(c->tips, k, b->name, &c->where, c->linear, &c->mesh, d) &&
                      is_isotropic(b, d));
}

static bool cells_suit_laws(const run_body *b, diagnostics *d) {
  for (int n = 0; n < b->law_count; n++) {
    const run_law *l = &b->laws[n];
    if (!cell_sizes_fit(&b->cells->mesh, cell_laws_own(&b->cells->where, n), l->law, l->parameters,
                        deck_where(&l->from->material->item, "model"), d))
      return false;
  }
  return true;
}

static bool is_plane_strain(const deck *k, const run_body *b) {
  return strcmp(k->lattices[b->lattice].setting, "plane_strain") == 0;
}

static bool find_limit_of_cells(run_body *b, const deck *k, diagnostics *d) {
  if (!cells_suit_laws(b, d)) return false;
  give_laws(b);
  for (int n = 0; n < b->law_count && is_plane_strain(k, b); n++)
    law_fits_elements(b->laws[n].law, b->cells, n,
                      deck_where(&b->laws[n].from->material->item, "model"), d);
  if (!cracks_suit_laws(b, k, d)) return false;
  unsigned char *held = held_freedoms(b);
  cells_step_limit(b->cells, held, &b->limit);
  free(held);
  return step_limit_check(k, law_fits_where(k, b->lattice), b->law, &b->limit, d);
}

static bool find_limit_now(run_body *b, const deck *k, diagnostics *d) {
  const run_law *l = &b->laws[0];
  if (b->law_count == 1)
    return step_limit_of(k, b->lattice, l->law, l->parameters, l->planes, b->lattice_rows,
                         &b->limit, d);
  interaction_law *laws = laws_beside(b);
  stability_limit_joint(laws, b->law_count, b->lattice_rows, &b->limit);
  free(laws);
  l = law_at_fault(b);
  return step_limit_check(k, deck_where(&l->from->material->item, "model"), l->law, &b->limit, d);
}

static const parameter_planes *changing_planes(const run_body *b) {
  for (int n = 0; n < b->law_count; n++)
    if (b->laws[n].planes && b->laws[n].planes->changing) return b->laws[n].planes;
  return NULL;
}

/* Fields that change in time make the body stiffer or softer: the least of some times counts. */
static bool find_limit_in_time(run_body *b, const deck *k, diagnostics *d) {
  enum { LOOKS = 8 };
  double *times;
  const int count = parameter_planes_times(changing_planes(b), k->simulation.end_time, &times);
  const int apart = count > LOOKS ? count / LOOKS : 1;
  step_limit least = b->limit;
  bool good = true;
  for (int n = apart; n < count && good; n += apart) {
    run_body_go_to(b, times[n]);
    b->limit = (step_limit){0};
    good = find_limit_now(b, k, d);
    if (good && b->limit.limit < least.limit) least = b->limit;
  }
  free(times);
  run_body_go_to(b, 0);
  b->limit = least;
  return good;
}

static bool find_limit(run_body *b, const deck *k, diagnostics *d) {
  if (b->cells) return b->loads && find_limit_of_cells(b, k, d);
  if (!find_limit_now(b, k, d)) return false;
  return !changing_planes(b) || find_limit_in_time(b, k, d);
}

/* Of the nodes of a mesh with several laws. */
static void take_densities_of_cells(const run_body *b, double *rho) {
  double *density = must_calloc((size_t)b->law_count, sizeof *density);
  for (int n = 0; n < b->law_count; n++)
    density[n] = material_density(b->laws[n].law, b->laws[n].parameters);
  cells_densities(b->cells, density, rho);
  free(density);
}

/* Of the particles that a law owns; those between regions own none. */
static void take_densities(const run_body *b, const run_law *l, double *rho) {
  const rows *g = b->lattice_rows;
  const double one = material_density(l->law, l->parameters);
  for (long p = 0; p < g->particle_count; p++) {
    const long q = g->particle_site[p];
    if (!l->own || l->own[q])
      rho[q] = l->planes && l->planes->density ? l->planes->density[q] : one;
  }
}

static bool density_is_one(const run_body *b) {
  const double rho = material_density(b->law, b->laws[0].parameters);
  bool same = true;
  for (int n = 0; n < b->law_count; n++) {
    const run_law *l = &b->laws[n];
    same = same && !(l->planes && l->planes->density) &&
           (l->from->material->between[0] || material_density(l->law, l->parameters) == rho);
  }
  return same;
}

/* False where what is wrong with others has been said. */
static bool set_masses(run_body *b, rows *const *built) {
  if (run_body_is_link(b)) return linked_take_masses(b->lattice_rows, built);
  if (density_is_one(b)) {
    rows_set_density(b->lattice_rows, material_density(b->law, b->laws[0].parameters));
    return true;
  }
  double *rho = must_calloc((size_t)b->lattice_rows->size, sizeof *rho);
  for (int n = 0; n < b->law_count && !b->cells; n++)
    take_densities(b, &b->laws[n], rho);
  if (b->cells) take_densities_of_cells(b, rho);
  rows_set_densities(b->lattice_rows, rho);
  free(rho);
  return true;
}

/* Bonds between regions have no mass. */
static void warn_of_mass(const run_law *l, diagnostics *d) {
  const deck_material *m = l->from->material;
  for (int n = 0; n < m->assignment_count && m->between[0]; n++)
    if (strcasecmp(m->assignments[n].name, "rho") == 0)
      diag_report(d, DIAG_DECK_WARNING, m->assignments[n].name_where,
                  "the bonds between `%s` and `%s` have no mass: this `rho` is that of no particle",
                  m->between[0], m->between[1]);
}

/* What asks for the values of parameters. */
static bool open_materials(run_body *b, const deck *k, rows *const *built, diagnostics *d) {
  bool planes = true, mass = true;
  for (int n = 0; n < b->law_count; n++) {
    planes = open_planes(b, &b->laws[n], k, d) && planes;
    mass = (run_body_is_link(b) || law_fits_motion(b->laws[n].law, k, b->lattice, d)) && mass;
    warn_of_mass(&b->laws[n], d);
  }
  mass = mass && set_masses(b, built);
  if (mass) law_parts_take_masses(b->parts, b->law_count, b->lattice_rows);
  if (deck_lacks(k, "simulation") || deck_lacks(k, "relaxation")) return false;
  return planes && mass && find_limit(b, k, d);
}

/* The value of an element-free node is a parameter, not its displacement: it cannot be held, but by
   what bears nothing in a static run (mesh_rest.h). */
static bool moves_elements_alone(const run_body *b, const deck_item *item, int region,
                                 diagnostics *d) {
  const region_sites *at = region >= 0 ? &b->loads->regions[region] : NULL;
  for (long p = 0; at && p < at->count; p++) {
    const int node = cells_node(b->cells, b->lattice_rows->particle_site[at->particles[p]]);
    double at_node[2];
    if (!b->cells->mesh.element_free[node]) continue;
    mesh_place(&b->cells->mesh, node, at_node);
    diag_report(
        d, DIAG_CONFLICT, deck_where(item, "region"),
        "the node at (%.6g, %.6g) mm is element-free: its displacement cannot be prescribed",
        1e3 * at_node[0], 1e3 * at_node[1]);
    if (holes_near(&b->cells->mesh.holes, at_node, 2 * b->lattice_rows->spacing))
      diag_hint(d, "cells that a hole cuts are element-free: hold nodes that are farther from it");
    else
      diag_hint(d,
                "make the nodes of the region finite elements: &zone mesh = '%s' method = "
                "'finite_elements' ...",
                b->name);
    return false;
  }
  return true;
}

static bool holds_elements_alone(const run_body *b, const deck *k, diagnostics *d) {
  bool good = true;
  for (int n = 0; n < k->support_count && b->loads && !k->relaxation.solved; n++)
    good = moves_elements_alone(b, &k->supports[n].item, deck_find_region(k, k->supports[n].region),
                                d) &&
           good;
  for (int n = 0; n < k->drive_count && b->loads; n++)
    good =
        moves_elements_alone(b, &k->drives[n].item, deck_find_region(k, k->drives[n].region), d) &&
        good;
  return good;
}

/* Nor is what a file has at such a node what it begins with. */
static bool begins_with_parameters(const run_body *b, const deck_initial *v, int region,
                                   diagnostics *d) {
  const region_sites *at = v->value.path && region >= 0 ? &b->loads->regions[region] : NULL;
  for (long p = 0; at && p < at->count; p++) {
    const int node = cells_node(b->cells, b->lattice_rows->particle_site[at->particles[p]]);
    double at_node[2];
    if (!b->cells->mesh.element_free[node]) continue;
    mesh_place(&b->cells->mesh, node, at_node);
    diag_report(
        d, DIAG_NOT_SUPPORTED, deck_where(&v->item, "file"),
        "the node at (%.6g, %.6g) mm is element-free: what the file has there is no value of the "
        "node's",
        1e3 * at_node[0], 1e3 * at_node[1]);
    diag_hint(d, "give a formula as `value`, or take finite elements; a run goes on from its "
                 "checkpoint");
    return false;
  }
  return true;
}

static bool begins_well(const run_body *b, const deck *k, diagnostics *d) {
  bool good = true;
  for (int n = 0; n < k->initial_velocity_count && b->loads; n++) {
    const deck_initial *v = &k->initial_velocitys[n];
    good = begins_with_parameters(b, v, deck_find_region(k, v->region), d) && good;
  }
  for (int n = 0; n < k->initial_displacement_count && b->loads; n++) {
    const deck_initial *v = &k->initial_displacements[n];
    good = begins_with_parameters(b, v, deck_find_region(k, v->region), d) && good;
  }
  return good;
}

/* A traction as it is taken over: what each node bears of a unit stress on the line, m^2. */
typedef struct taken_traction {
  run_body *b;
  const deck_traction *from;
  int number;
  double *share; /* [nodes]; NULL of one that differs from place to place */
  bool good;
  diagnostics *d;
} taken_traction;

static void take_point(void *context, const double at[2], double area, const point_shape *s) {
  taken_traction *t = context;
  const double here[3] = {at[0], at[1], 0};
  for (int n = 0; n < s->count && t->share; n++)
    t->share[s->node[n]] += area * s->n[n];
  if (t->share || !t->good) return;
  t->good = loads_add_place(t->b->loads, here, t->number, t->d);
  for (int n = 0; n < s->count && t->good; n++)
    loads_add_share_there(t->b->loads, cells_particle(t->b->cells, s->node[n]), t->from->component,
                          t->number, area * s->n[n]);
}

/* Adds a share along x and y; the direction may turn along the edge. */
static void take_side(void *context, const double at[2], const double normal[2], double area,
                      const point_shape *s) {
  taken_traction *t = context;
  const double here[3] = {at[0], at[1], 0};
  const double way[4][2] = {{1, 0}, {0, 1}, {normal[0], normal[1]}, {-normal[1], normal[0]}};
  const double *along = way[t->from->component];
  if (!t->share && t->good) t->good = loads_add_place(t->b->loads, here, t->number, t->d);
  for (int n = 0; n < s->count && t->good; n++)
    for (int a = 0; a < 2; a++) {
      const double share = area * s->n[n] * along[a];
      if (t->share)
        t->share[2 * s->node[n] + a] += share;
      else if (share != 0)
        loads_add_share_there(t->b->loads, cells_particle(t->b->cells, s->node[n]), a, t->number,
                              share);
    }
}

/* On lines of the mesh's file. */
static bool add_edge(run_body *b, const deck *k, int number, diagnostics *d) {
  const deck_traction *f = &k->forces[number];
  const gmsh_mesh *file = k->lattices[b->lattice].gmsh;
  const int nodes = mesh_node_count(&b->cells->mesh);
  taken_traction t = {.b = b, .from = f, .number = number, .good = true, .d = d};
  if (!time_function_varies(&f->force)) t.share = must_calloc(2 * (size_t)nodes, sizeof(double));
  sides_visit(&b->cells->mesh, file, gmsh_mesh_group(file, f->edge), take_side, &t);
  for (int n = 0; n < 2 * nodes && t.share; n++)
    if (t.share[n] != 0)
      loads_add_share(b->loads, cells_particle(b->cells, n / 2), n % 2, number, t.share[n]);
  free(t.share);
  return t.good;
}

static void warn_of_part(const deck_traction *f, double loaded, const char *name, diagnostics *d) {
  const double length = pl_hypot(f->to[0] - f->from[0], f->to[1] - f->from[1]);
  if (!(loaded > 0) || loaded > (1 - 1e-6) * length) return;
  diag_report(d, DIAG_DECK_WARNING, deck_where(&f->item, "from"),
              "of this line of %.6g mm only %.6g mm lie in the mesh `%s` and are loaded",
              1e3 * length, 1e3 * loaded, name);
  diag_hint(d, "what lies outside of it, or in a hole, bears nothing");
}

/* False where the line misses the mesh. */
static bool add_traction(run_body *b, const deck *k, int number, diagnostics *d) {
  const deck_traction *f = &k->forces[number];
  const int nodes = mesh_node_count(&b->cells->mesh);
  taken_traction t = {.b = b, .from = f, .number = number, .good = true, .d = d};
  if (!time_function_varies(&f->force)) t.share = must_calloc((size_t)nodes, sizeof(double));
  const double loaded = line_visit(&b->cells->mesh, f->from, f->to, take_point, &t);
  for (int n = 0; n < nodes && t.share; n++)
    if (t.share[n] != 0)
      loads_add_share(b->loads, cells_particle(b->cells, n), f->component, number, t.share[n]);
  free(t.share);
  warn_of_part(f, loaded, b->name, d);
  if (loaded > 0) return t.good;
  diag_report(d, DIAG_EMPTY_REGION, deck_where(&f->item, "from"),
              "the line that is loaded lies outside the mesh `%s`", b->name);
  return false;
}

static bool add_tractions(run_body *b, const deck *k, diagnostics *d) {
  bool good = true;
  for (int n = 0; n < k->force_count && b->loads; n++)
    if (k->forces[n].mesh && strcmp(k->forces[n].mesh, b->name) == 0)
      good = (k->forces[n].edge ? add_edge : add_traction)(b, k, n, d) && good;
  if (b->loads) loads_links_added(b->loads);
  return good;
}

/* --- ties ------------------------------------------------------------------------------------- */

static bool is_tied_to_mesh(const run_body *b, const deck *k) {
  for (int n = 0; n < k->tie_count; n++)
    if (strcmp(k->ties[n].lattice, b->name) == 0) return true;
  return false;
}

/* What a tied particle bears of its own bonds is known; of a family it would be the mesh's, too. */
static bool can_be_tied(const run_body *b, diagnostics *d) {
  for (int n = 0; n < b->law_count; n++) {
    const pl_law *law = b->laws[n].law;
    if (law->kind != PL_STATE || law->pairwise) continue;
    diag_report(d, DIAG_NOT_SUPPORTED, deck_where(&b->laws[n].from->material->item, "model"),
                "`%s` is a law of families: a lattice that is tied to a mesh has a law of bonds",
                law->name);
    diag_hint(d, "take a law of bonds, such as `elastic_micropolar` or `mplm_bilinear`");
    return false;
  }
  return true;
}

static bool open_ties(run_body *b, const deck *k, diagnostics *d) {
  if (!is_tied_to_mesh(b, k)) return true;
  if (!can_be_tied(b, d)) return false;
  const bool halves = b->law_count == 1 && b->law->kind != PL_STATE;
  b->ties = mesh_ties_new(k, b->lattice, b->lattice_rows, halves, &b->tie_count, d);
  return b->ties != NULL;
}

static void refuse_load(const run_body *b, int64_t site, span where, const char *what,
                        diagnostics *d) {
  double at[3];
  char text[ROWS_PLACE_TEXT];
  rows_place(b->lattice_rows, site, at);
  diag_report(d, DIAG_CONFLICT, where, "the particle of `%s` at %s is %s, but tied to a mesh",
              b->name, rows_place_text(2, at, text), what);
  diag_hint(d, "let it be done to nodes of the mesh there, or to particles that are not tied");
}

/* The support that holds it. */
static span support_at(const run_body *b, const deck *k, int64_t site) {
  for (int n = 0; n < k->support_count; n++) {
    const int region = deck_find_region(k, k->supports[n].region);
    const region_sites *at = region >= 0 ? &b->loads->regions[region] : NULL;
    for (long p = 0; at && p < at->count; p++)
      if (b->lattice_rows->particle_site[at->particles[p]] == site)
        return deck_where(&k->supports[n].item, "region");
  }
  return b->ties[0].from->item.where;
}

unsigned char *run_body_tied_sites(const run_body *b) {
  unsigned char *tied = must_calloc((size_t)b->lattice_rows->size, 1);
  for (int n = 0; n < b->tie_count; n++)
    for (long p = 0; p < b->ties[n].count; p++)
      tied[b->lattice_rows->particle_site[b->ties[n].particles[p].particle]] = 1;
  return tied;
}

long run_body_damaged_ties(const run_body *b) {
  long count = 0;
  if (b->tie_count == 0) return 0;
  unsigned char *tied = run_body_tied_sites(b);
  const int32_t *site = b->lattice_rows->particle_site;
  for (int n = 0; n < b->law_count; n++) {
    const run_law *l = &b->laws[n];
    for (long m = 0; damage_on_bonds(l->law) && m < l->rows->bond_count; m++)
      count += (tied[site[l->bonds[m].i]] || tied[site[l->bonds[m].j]]) &&
               damage_of_bond_in(l->state, l->state->field, &l->bonds[m]) >= 0.5;
  }
  free(tied);
  return count;
}

/* What loads do to tied particles they would do to the mesh. */
static bool ties_are_free(const run_body *b, const deck *k, diagnostics *d) {
  unsigned char *tied = run_body_tied_sites(b);
  bool good = true;
  for (long n = 0; n < b->loads->constraint_count && good; n++) {
    const constraint *c = &b->loads->constraints[n];
    good = !tied[c->site];
    if (!good)
      refuse_load(b, c->site,
                  c->drive >= 0 ? deck_where(&k->drives[c->drive].item, "region")
                                : support_at(b, k, c->site),
                  c->drive >= 0 ? "driven" : "held", d);
  }
  for (long n = 0; n < b->loads->force_count && good; n++) {
    const applied *f = &b->loads->forces[n];
    const deck_item *from = f->cause < k->force_count
                                ? &k->forces[f->cause].item
                                : &k->end_moments[f->cause - k->force_count].item;
    good = !tied[f->site];
    if (!good) refuse_load(b, f->site, deck_where(from, "region"), "loaded", d);
  }
  free(tied);
  return good;
}

bool run_body_open(run_body *b, const deck *k, rows **built, diagnostics *d) {
  enum { ANY_DOF = PL_MAX_DOF };
  b->name = k->lattices[b->lattice].name;
  b->law = b->laws[0].law;
  if (!built[b->lattice]) built[b->lattice] = lattice_build_next(k, b->lattice, built, d);
  b->lattice_rows = built[b->lattice];
  if (!b->lattice_rows) return false;
  b->fits = laws_fit(b, k, d);
  if (b->fits && !open_ties(b, k, d)) return b->fits = false;
  b->loads = loads_new(k, b->lattice, b->lattice_rows, b->fits ? b->law->name : "",
                       b->fits ? b->law->dof : ANY_DOF, d);
  if (!b->fits || (b->loads && !ties_are_free(b, k, d))) return false;
  if (deck_lattice_is_mesh(&k->lattices[b->lattice])) {
    b->cells = cells_new(k, b->lattice, b->lattice_rows, d);
    if (!b->cells || !holds_elements_alone(b, k, d) || !begins_well(b, k, d) ||
        !add_tractions(b, k, d))
      return false;
  }
  for (int n = 0; n < b->law_count; n++)
    law_fits_protection(b->laws[n].law, k, b->lattice, d);
  return open_parts(b, k, d) && all_have_parameters(b) && open_materials(b, k, built, d) &&
         b->loads;
}

/* --- the state -------------------------------------------------------------------------------- */

/* Small bodies are not worth many threads: a block has at least eight rows, of a list two, unless
   the deck insists. */
static int choose_threads(const run_body *b, const deck *k) {
  const int asked = k->simulation.threads;
  if (run_body_is_link(b)) return 1;
  if (asked > 0) return asked;
  const int least = b->lattice_rows->list ? 2 : 8;
  const int offered = omp_get_max_threads(), sensible = b->lattice_rows->row_count / least;
  return sensible < 1 ? 1 : offered < sensible ? offered : sensible;
}

/* One law moves the body by itself, several do it together; that of a link moves nothing. */
static void open_state(run_body *b, const deck *k, double step) {
  run_law *l = &b->laws[0];
  const body_ledger energies = !k->output.energy  ? BODY_NO_LEDGER
                               : k->output.losses ? BODY_LOSSES
                                                  : BODY_LEDGER;
  const int threads = choose_threads(b, k);
  if (b->cells) {
    sweep **states = must_calloc((size_t)b->law_count, sizeof(sweep *));
    b->state = cells_sweep(b->cells, k, b->cracks, step, threads, energies, states);
    for (int n = 0; n < b->law_count; n++)
      b->laws[n].state = states[n];
    free(states);
    give_points(b);
    return;
  }
  if (b->law_count == 1 && !run_body_is_link(b)) {
    b->state = l->state = interaction_new(b->lattice_rows, l->law, l->parameters, step, threads,
                                          energies, k->relaxation.increments > 0);
    if (l->planes) l->state->parameter = l->planes->value;
    return;
  }
  interaction_law *laws = laws_beside(b);
  sweep **states = must_calloc((size_t)b->law_count, sizeof(sweep *));
  b->state =
      interaction_joint(b->lattice_rows, laws, b->law_count, step, threads, energies, states);
  for (int n = 0; n < b->law_count; n++)
    b->laws[n].state = states[n];
  free(states);
  free(laws);
}

/* Nodes on which loads or supports act, or cells of laws that are not linear, which the stiffness
   alone does not accelerate. */
static void mark_loaded(run_body *b) {
  tips *t = b->cells ? b->cells->tips : NULL;
  if (t && b->cells->linear) cells_mark_pushed(b->cells, t->loaded);
  for (long n = 0; t && n < b->loads->constraint_count; n++)
    t->loaded[cells_node(b->cells, b->loads->constraints[n].site)] = 1;
  for (long n = 0; t && n < b->loads->force_count; n++)
    t->loaded[cells_node(b->cells, b->loads->forces[n].site)] = 1;
}

bool run_body_begin(run_body *b, const deck *k, double step, diagnostics *d) {
  b->limit.step = step;
  b->stiffened = 1;
  for (int n = 0; n < b->law_count; n++) {
    b->laws[n].bonds = rows_bonds(b->laws[n].rows);
    ledger_add_law(&b->energies, b->laws[n].law, k->output.losses);
  }
  mark_loaded(b);
  open_state(b, k, step);
  b->body = b->state->body;
  loads_point_masses(b->loads, b->body);
  if (k->gravity_count > 0) body_add_gravity(b->body);
  if (b->cells && k->relaxation.solved) b->rest = mesh_rest_new(b->cells, b->loads, b->body);
  return loads_initial_motion(b->loads, b->body, d);
}

damage_law *run_body_damages(const run_body *b) {
  damage_law *laws = must_calloc((size_t)b->law_count, sizeof *laws);
  for (int n = 0; n < b->law_count; n++)
    laws[n] = (damage_law){b->laws[n].state, b->laws[n].bonds, b->laws[n].rows->bond_count};
  return laws;
}

double run_body_limit_now(const run_body *b) {
  step_limit now = b->limit;
  if (!b->cells) return now.limit;
  unsigned char *held = held_freedoms(b);
  cells_step_limit(b->cells, held, &now);
  free(held);
  return now.limit;
}

/* Where only the virgin body is known, that of this. */
double run_body_highest_frequency(const run_body *b) {
  return b->limit.omega_max * sqrt(b->cells ? pl_fmax(1, b->cells->stiffened.now) : b->stiffened);
}

static double limit_of_cracks(run_body *b) {
  const tips *t = b->cells->tips;
  const int64_t pieces = t ? t->pieces.count : 0;
  if (pieces == 0) return b->limit.limit;
  if (b->cracked_pieces != pieces) b->cracked_limit = run_body_limit_now(b);
  b->cracked_pieces = pieces;
  return b->cracked_limit;
}

double run_body_limit_here(run_body *b, bool *cracked) {
  const double rest = b->limit.omega_max * b->limit.omega_max;
  b->stiffened = 1;
  *cracked = false;
  if (run_body_is_link(b)) return b->limit.limit;
  if (b->cells) {
    const double cut = limit_of_cracks(b);
    *cracked = cut < b->limit.limit;
    b->stiffened = pl_fmax(1, b->cells->stiffened.now);
    return cut / sqrt(b->stiffened);
  }
  const double now = body_stiffness_now(b->state);
  if (!(rest > 0)) return now > 0 ? 2 / sqrt(now) : b->limit.limit;
  b->stiffened = now > rest ? now / rest : 1;
  return b->limit.limit / sqrt(b->stiffened);
}

void run_body_free(run_body *b) {
  mesh_ties_free(b->ties, b->tie_count);
  mesh_rest_free(b->rest);
  loads_free(b->loads);
  sweep_free(b->state);
  for (int n = 0; n < b->law_count; n++) {
    parameter_planes_free(b->laws[n].planes);
    free(b->laws[n].stiffest);
    free(b->laws[n].bonds);
  }
  law_parts_free(b->parts, b->law_count);
  cells_free(b->cells);
  if (b->lattice_rows) rows_free(b->lattice_rows);
}

double run_body_memory(const run_body *b) {
  const rows *g = b->lattice_rows;
  const double site = 2 * sizeof(double) + sizeof(int64_t) + sizeof(int32_t) + 1; /* of rows */
  const double list =
      g->list ? 2 * g->directions * (sizeof(int32_t) + (1 + (double)g->dimensions) * sizeof(double))
              : 0;
  double bytes = (double)b->body->bytes + (list + site) * (double)g->size;
  if (b->cells) bytes += cells_bytes(b->cells);
  for (int n = 0; n < b->law_count; n++) {
    const run_law *l = &b->laws[n];
    bytes += (double)sizeof(rows_bond) * (double)l->rows->bond_count;
    bytes += l->planes ? (double)l->planes->bytes : 0;
    bytes += (b->parts ? sizeof(uint64_t) : 0) * (double)g->size;
    bytes += (l->share ? sizeof(double) : 0) * (double)g->size;
  }
  return bytes;
}
