#include "runtime/simulation/frames.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

#include "dsl/base/arena.h"
#include "runtime/analysis/material.h"
#include "runtime/analysis/particle_tensors.h"
#include "runtime/continuum/crack_paths.h"
#include "runtime/continuum/node_fields.h"
#include "runtime/continuum/point_law.h"
#include "runtime/deck/deck_value.h"
#include "runtime/deck/output_fields.h"
#include "runtime/interaction/damage.h"
#include "runtime/loads/load_steps.h"

typedef struct frame_source frame_source;
typedef struct frames_of { /* where values come from */
  const run_body *body;
  const run_law *law;
  long step;
} frames_of;
typedef void values_of(const frames_of *of, const frame_source *from, double *values);

struct frame_source { /* where values of a law come from; of a body: at its first law */
  values_of *values;  /* NULL: there is no such field */
  int components;
  bool on_bonds;
  /* of the law's fields, outputs, parameters that differ from bond to bond, or parameters; of a
     tensor's components */
  int index;
  struct frame_tensor *tensor;
};

typedef void tensor_values(const frames_of *of, bond_forces *forces, double *const *values);

/* All components of a tensor are found together. */
typedef struct frame_tensor {
  tensor_values *find;
  bond_forces *forces;
  double *values[TENSOR_MOST];
  char names[TENSOR_MOST][16];
  int first;          /* component that is stored first */
  int64_t found_step; /* step that the values are of; -1: none */
} frame_tensor;

#define X(name, unit, words, of_nodes) TENSOR_##name,
enum { OUTPUT_TENSORS(X) TENSORS };
#undef X

enum { PATH_NAME = NAMELIST_LONGEST_NAME + sizeof "/points" };
typedef struct frame_path { /* a crack of a mesh */
  char name[PATH_NAME];
  const tips *tips;
  const deck_crack *of;
} frame_path;

struct frame_set {
  const deck_output *asked;
  const run_body *bodies;
  int body_count;
  const run_law *laws; /* [law_count] those of all bodies */
  int law_count;
  const monitors *watched;
  const run_clock *clock;
  bond_forces **forces;  /* [body_count] NULL unless some field needs them */
  frame_tensor *tensors; /* [TENSORS][body_count] */
  frame_path *paths;     /* [path_count] those of the last fields */
  int path_count;
  int first_stamp; /* field */
  frame_field *fields;
  frame_source *sources; /* [count][law_count]; of bonds only that of their law */
  int count;
};

/* --- values ----------------------------------------------------------------------------------- */

static void site_values(const frames_of *of, double *const *arrays, int components,
                        double *values) {
  const rows *g = of->body->lattice_rows;
  for (long p = 0; p < g->particle_count; p++)
    for (int c = 0; c < components; c++)
      values[p * components + c] = arrays[c][g->particle_site[p]];
}

/* Of the particles that are of the law. */
static void law_site_values(const frames_of *of, const double *array, double *values) {
  const rows *g = of->body->lattice_rows;
  const unsigned char *own = of->law->own;
  for (long p = 0; p < g->particle_count; p++)
    if (!own || own[g->particle_site[p]]) values[p] = array[g->particle_site[p]];
}

static void bond_values(const frames_of *of, const double *array, double *values) {
  for (long b = 0; b < of->law->rows->bond_count; b++)
    values[b] = sweep_bond_value(of->law->state, array, &of->law->bonds[b]);
}

static bool on_bonds(const pl_field *f) {
  return f->place != PL_ON_PARTICLE && f->place != PL_ON_POINT;
}

/* Of the law, on particles or on bonds. */
static void law_values(const frames_of *of, const pl_field *field, double *array, double *values) {
  if (on_bonds(field))
    bond_values(of, array, values);
  else
    law_site_values(of, array, values);
}

static void values_of_state(const frames_of *of, const frame_source *from, double *values) {
  law_values(of, &of->law->law->fields[from->index], of->law->state->new_field[from->index],
             values);
}

static void values_of_output(const frames_of *of, const frame_source *from, double *values) {
  const pl_field *field = &of->law->law->outputs[from->index];
  const size_t planes = (size_t)sweep_planes(of->law->state, field->place);
  double *array = must_calloc(planes * (size_t)of->body->lattice_rows->size, sizeof *array);
  sweep_output(of->law->state, from->index, array);
  law_values(of, field, array, values);
  free(array);
}

static bool is_density(const pl_law *law, int varying) {
  return law->varying[varying] == law->density;
}

/* Which of the body's laws it is. */
static int number_of(const frames_of *of) {
  return (int)(of->law - of->body->laws);
}

static void values_of_cell_state(const frames_of *of, const frame_source *from, double *values) {
  cells_mean_state(of->body->cells, number_of(of), from->index, values);
}

static void values_of_cell_output(const frames_of *of, const frame_source *from, double *values) {
  cells_mean_output(of->body->cells, number_of(of), from->index, values);
}

static void values_of_parameter(const frames_of *of, const frame_source *from, double *values) {
  const bool density = is_density(of->law->law, from->index);
  const double *array = density ? of->law->planes->density : of->law->state->parameter[from->index];
  const pl_law *law = of->law->law;
  if (density || law->varying_place == PL_ON_PARTICLE || law->kind == PL_CONTINUUM)
    law_site_values(of, array, values);
  else
    bond_values(of, array, values);
}

/* One that is the same everywhere: where the law is at work. */
static void values_of_constant(const frames_of *of, const frame_source *from, double *values) {
  const rows *g = of->body->lattice_rows;
  const double value = of->law->parameters[from->index];
  const unsigned char *own = of->law->own;
  for (long b = 0; from->on_bonds && b < of->law->rows->bond_count; b++)
    values[b] = value;
  for (long p = 0; !from->on_bonds && p < g->particle_count; p++)
    if (!own || own[g->particle_site[p]]) values[p] = value;
}

/* --- fields of any law ------------------------------------------------------------------------ */

/* Nodes have parameters of their fields, which are not these themselves. */
static void node_values(const frames_of *of, double *const *planes, double *values) {
  const double *const two[2] = {planes[0], planes[1]};
  node_field_values(of->body->cells, two, values);
}

static void values_of_displacement(const frames_of *of, const frame_source *from, double *values) {
  if (of->body->cells)
    node_values(of, of->body->body->displacement, values);
  else
    site_values(of, of->body->body->displacement, from->components, values);
}

/* From those of the nodes' parameters, in place. */
static void smooth_velocity(const frames_of *of, double *values) {
  const rows *g = of->body->lattice_rows;
  double *planes[2];
  for (int c = 0; c < 2; c++) {
    planes[c] = must_calloc((size_t)g->size, sizeof **planes);
    for (long p = 0; p < g->particle_count; p++)
      planes[c][g->particle_site[p]] = values[2 * p + c];
  }
  node_values(of, planes, values);
  free(planes[0]);
  free(planes[1]);
}

static void values_of_velocity(const frames_of *of, const frame_source *from, double *values) {
  const rows *g = of->body->lattice_rows;
  for (long p = 0; p < g->particle_count; p++)
    for (int c = 0; c < from->components; c++)
      values[p * from->components + c] = load_steps_velocity(of->body->loads, of->body->state->body,
                                                             c, g->particle_site[p], of->step);
  if (of->body->cells) smooth_velocity(of, values);
}

static void values_of_rotation(const frames_of *of, const frame_source *from, double *values) {
  const body *w = of->body->body;
  site_values(of, w->displacement + w->dimensions, from->components, values);
}

static void values_of_force(const frames_of *of, const frame_source *from, double *values) {
  site_values(of, of->body->body->force, from->components, values);
}

static void values_of_damage(const frames_of *of, const frame_source *from, double *values) {
  (void)from;
  damage_law *laws = run_body_damages(of->body);
  damage_of_particles(laws, of->body->law_count, values);
  free(laws);
}

/* The largest of the laws' damages. */
static void values_of_cell_damage(const frames_of *of, const frame_source *from, double *values) {
  const long count = cells_whole_count(of->body->cells);
  double *one = must_calloc((size_t)count + 1, sizeof *one);
  (void)from;
  for (int n = 0; n < of->body->law_count; n++) {
    const pl_law *law = of->body->laws[n].law;
    for (int k = 0; k < law->field_count; k++) {
      if (law->fields[k].kind != PL_FIELD_DAMAGE) continue;
      cells_mean_state(of->body->cells, n, k, one);
      for (long c = 0; c < count; c++)
        if (one[c] > values[c]) values[c] = one[c];
    }
    memset(one, 0, (size_t)count * sizeof *one);
  }
  free(one);
}

/* Energy lost in the bonds that a particle owns (those to the right and above). */
static void values_of_dissipated(const frames_of *of, const frame_source *from, double *values) {
  const rows *g = of->body->lattice_rows;
  (void)from;
  memset(values, 0, (size_t)g->particle_count * sizeof *values);
  for (int n = 0; n < of->body->law_count; n++) {
    const sweep *w = of->body->laws[n].state;
    for (long p = 0; p < g->particle_count && w->lost_state; p++) {
      const int32_t site = g->particle_site[p];
      values[p] += w->dissipated_state[site] + w->lost_state[site] + w->dissipated_rate[site] +
                   0.5 * w->lost_rate[site];
    }
  }
}

/* Pictures leave out dead cells. */
static void values_of_dead_cells(const frames_of *of, const frame_source *from, double *values) {
  const cells *c = of->body->cells;
  const long count = of->body->lattice_rows->particle_count;
  int *begun = must_calloc((size_t)count + 1, sizeof *begun);
  (void)from;
  memset(values, 0, (size_t)count * sizeof *values);
  for (int cell = 0; c && cell < mesh_cell_count(&c->mesh); cell++) {
    int corner[ELEMENT_MOST_NODES];
    if (!cells_whole(c, cell)) continue;
    mesh_cell_nodes(&c->mesh, cell, corner);
    const int32_t first = cells_particle(c, corner[0]);
    values[first] += cells_dead(c, cell) ? ldexp(1, begun[first]) : 0;
    begun[first]++;
  }
  free(begun);
}

/* --- tensors ---------------------------------------------------------------------------------- */

/* What a tied particle's bonds bear is a part of what is there: the mesh has the rest. */
static void leave_out_tied(const run_body *of, double *const *values) {
  if (of->tie_count == 0) return;
  unsigned char *tied = run_body_tied_sites(of);
  for (long site = 0; site < of->lattice_rows->size; site++)
    for (int c = 0; c < TENSOR_MOST && values[c] && tied[site]; c++)
      values[c][site] = NAN;
  free(tied);
}

static void find_stress(const frames_of *of, bond_forces *forces, double *const *values) {
  if (of->body->cells) {
    double *const *u = of->body->body->displacement;
    const double *const two[2] = {u[0], u[1]};
    node_field_stress(of->body->cells, two, values);
    return;
  }
  bond_forces_find(forces, -1);
  particle_stress(forces, of->body->body, values);
  leave_out_tied(of->body, values);
}

static void find_strain(const frames_of *of, bond_forces *forces, double *const *values) {
  const body *b = of->body->body;
  (void)forces;
  if (of->body->cells) {
    const double *const two[2] = {b->displacement[0], b->displacement[1]};
    node_field_strain(of->body->cells, two, values);
    return;
  }
  for (long p = 0; p < b->lattice->particle_count; p++) {
    const long site = b->lattice->particle_site[p];
    double here[TENSOR_MOST] = {0};
    particle_strain(b, site, here);
    for (int c = 0; c < TENSOR_MOST && values[c]; c++)
      values[c][site] = here[c];
  }
}

/* Fields of a frame come in their order. */
static void values_of_tensor(const frames_of *of, const frame_source *from, double *values) {
  frame_tensor *t = from->tensor;
  if (from->index == t->first || t->found_step != of->step) t->find(of, t->forces, t->values);
  t->found_step = of->step;
  site_values(of, &t->values[from->index], 1, values);
}

typedef struct tensor_field {
  const char *name, *unit, *words, *of_nodes;
  tensor_values *find;
} tensor_field;

static const tensor_field tensor_fields[] = {
#define X(name, unit, words, of_nodes) {#name, unit, words, of_nodes, find_##name},
    OUTPUT_TENSORS(X)
#undef X
};

/* --- which runs have them --------------------------------------------------------------------- */

/* On bodies with this law, in runs with this output. */
typedef bool exists_in(const deck_output *asked, const pl_law *law);

static bool always(const deck_output *asked, const pl_law *law) {
  (void)asked;
  (void)law;
  return true;
}

static bool with_rotations(const deck_output *asked, const pl_law *law) {
  (void)asked;
  return law->dof > law->dimensions;
}

static bool with_damage(const deck_output *asked, const pl_law *law) {
  (void)asked;
  return damage_on_bonds(law) || damage_on_particles(law);
}

/* Laws of bonds on strips count what each bond has lost, those of families where it is asked. */
static bool with_losses(const deck_output *asked, const pl_law *law) {
  const bool may_lose = law->field_count > 0 || law->reads_rates;
  return asked->energy &&
         (law->kind != PL_STATE || (asked->losses && may_lose && sweep_knows_losses(law, true)));
}

static bool with_failing(const deck_output *asked, const pl_law *law) {
  (void)asked;
  return law->kind == PL_CONTINUUM && point_law_failed(law) >= 0;
}

/* as many as there are directions of space, or axes to turn about */
enum { SCALAR = 1, VECTOR = 0, ROTATION = -1 };

static int component_count(int kind, const pl_law *law) {
  return kind == VECTOR ? law->dimensions : kind == ROTATION ? law->dof - law->dimensions : kind;
}

typedef struct own_field {
  const char *name, *unit;
  int components;
  const char *kind, *words;
  exists_in *exists;
  values_of *values;
} own_field;

static const own_field own_fields[] = {
#define X(name, unit, components, exists, kind, words)                                             \
  {#name, unit, components, kind, words, exists, values_of_##name},
    OUTPUT_FIELDS(X)
#undef X
};
enum { OWN_FIELDS = sizeof own_fields / sizeof *own_fields };

static const own_field *find_own(const char *name) {
  for (int k = 0; k < OWN_FIELDS; k++)
    if (strcasecmp(own_fields[k].name, name) == 0) return &own_fields[k];
  return NULL;
}

/* --- what frames hold ------------------------------------------------------------------------- */

static bool is_asked(const deck_output *o, const char *name) {
  for (int k = 0; k < o->field_count; k++)
    if (strcasecmp(o->fields[k], name) == 0) return true;
  return false;
}

static int count_laws(const run_body *bodies, int count) {
  int sum = 0;
  for (int b = 0; b < count; b++)
    sum += bodies[b].law_count;
  return sum;
}

static size_t most_fields(const run_body *bodies, int count) {
  size_t most = 2 * OWN_FIELDS + TENSORS * (1 + TENSOR_MOST);
  for (int n = 0; n < count_laws(bodies, count); n++) {
    const pl_law *law = bodies[0].laws[n].law;
    most += (size_t)(2 * (law->field_count + law->output_count) + law->parameter_count);
  }
  return most;
}

/* Some law of the body has what the field is about. Particles of links are those of others. */
static bool exists_on(const own_field *own, const deck_output *asked, const run_body *of) {
  for (int n = 0; n < of->law_count && !run_body_is_link(of); n++)
    if (own->exists(asked, of->laws[n].law)) return true;
  return false;
}

static long particles_of(const run_body *bodies, int count) {
  long sum = 0;
  for (int b = 0; b < count; b++)
    sum += run_body_particles(&bodies[b]);
  return sum;
}

static long cells_of(const run_body *bodies, int count) {
  long sum = 0;
  for (int b = 0; b < count; b++)
    sum += bodies[b].cells ? cells_whole_count(bodies[b].cells) : 0;
  return sum;
}

/* The place of a field that another law has brought, or -1. */
static int find_shared(const frame_set *f, const frame_field *field) {
  for (int k = 0; k < f->count && !field->on_bonds; k++) {
    const frame_field *other = &f->fields[k];
    if (!other->on_bonds && other->interaction != field->interaction &&
        other->on_cells == field->on_cells && other->components == field->components &&
        strcmp(other->name, field->name) == 0 && strcmp(other->unit, field->unit) == 0 &&
        strcmp(other->kind, field->kind) == 0)
      return k;
  }
  return -1;
}

/* `field` says whose it is. */
static frame_source *add(frame_set *f, frame_field field, values_of *values, int index) {
  const int shared = find_shared(f, &field), at = shared < 0 ? f->count++ : shared;
  if (shared < 0) {
    field.count = field.on_bonds   ? f->laws[field.interaction].rows->bond_count
                  : field.on_cells ? cells_of(f->bodies, f->body_count)
                                   : particles_of(f->bodies, f->body_count);
    f->fields[at] = field;
  }
  frame_source *from = &f->sources[at * f->law_count + field.interaction];
  *from = (frame_source){
      .values = values, .components = field.components, .on_bonds = field.on_bonds, .index = index};
  return from;
}

/* The field of nodes once more, as one value a cell. */
static void add_on_cells(frame_set *f, frame_field field, values_of *values, int index) {
  field.on_cells = true;
  add(f, field, values, index);
}

static const char *words_of(const char *doc, const char *otherwise) {
  return doc && *doc ? doc : otherwise;
}

static int first_law(const frame_set *f, int b) {
  return (int)(f->bodies[b].laws - f->laws);
}

/* Without being asked for: no map can be drawn without it. */
static bool comes_by_itself(const own_field *own) {
  return own->values == values_of_displacement || own->values == values_of_dead_cells;
}

/* What is stored of any law. */
static void add_own(frame_set *f, const own_field *own, int b) {
  const run_body *of = &f->bodies[b];
  if (!(is_asked(f->asked, own->name) || comes_by_itself(own)) || !exists_on(own, f->asked, of))
    return;
  const bool largest = own->values == values_of_damage && damage_on_particles(of->law);
  const frame_field field = {.name = own->name,
                             .unit = own->unit,
                             .components = component_count(own->components, of->law),
                             .interaction = first_law(f, b),
                             .kind = own->kind,
                             .long_name =
                                 largest ? "the largest damage of the particle" : own->words};
  add(f, field, own->values, 0);
  if (of->cells && own->values == values_of_damage)
    add_on_cells(f, field, values_of_cell_damage, 0);
}

/* "stress_xx" */
static void name_component(char name[16], const char *tensor, const char *component) {
  snprintf(name, 16, "%s_%s", tensor, component);
}

/* What a law calls so goes before. */
static bool is_of_law(const pl_law *law, const char *name) {
  for (int k = 0; k < law->field_count; k++)
    if (strcasecmp(law->fields[k].name, name) == 0) return true;
  for (int k = 0; k < law->output_count; k++)
    if (strcasecmp(law->outputs[k].name, name) == 0) return true;
  return false;
}

/* A component of it, or all, is asked for. */
static void begin_tensor(frame_set *f, int k, int b) {
  const run_body *of = &f->bodies[b];
  frame_tensor *t = &f->tensors[k * f->body_count + b];
  const tensor_component *component;
  const int count = tensor_components(of->body->dimensions, &component);
  if (k == TENSOR_stress && !of->cells) f->forces[b] = bond_forces_new(of->state);
  *t = (frame_tensor){.find = tensor_fields[k].find, .forces = f->forces[b], .found_step = -1};
  for (int c = 0; c < count; c++) {
    t->values[c] = must_calloc((size_t)of->lattice_rows->size, sizeof(double));
    name_component(t->names[c], tensor_fields[k].name, component[c].name);
  }
}

static void add_tensor(frame_set *f, int k, int b) {
  const tensor_field *from = &tensor_fields[k];
  const pl_law *law = f->bodies[b].law;
  const tensor_component *component;
  const int count = tensor_components(law->dimensions, &component);
  for (int c = 0; c < count; c++) {
    frame_tensor *t = &f->tensors[k * f->body_count + b];
    char name[16];
    name_component(name, from->name, component[c].name);
    if (!is_asked(f->asked, from->name) && !is_asked(f->asked, name)) continue;
    if (is_of_law(law, name)) continue;
    if (!t->find) {
      begin_tensor(f, k, b);
      t->first = c;
    }
    const frame_field field = {.name = t->names[c],
                               .unit = from->unit,
                               .components = 1,
                               .interaction = first_law(f, b),
                               .kind = "other",
                               .long_name = f->bodies[b].cells ? from->of_nodes : from->words};
    add(f, field, values_of_tensor, c)->tensor = t;
  }
}

static bool varies(const pl_law *law, int parameter) {
  for (int k = 0; k < law->varying_count; k++)
    if (law->varying[k] == parameter) return true;
  return false;
}

/* Beside other laws one that is the same everywhere is worth a field. */
static bool is_field(const run_law *of, int parameter) {
  return of->own || varies(of->law, parameter) || material_is_given(of->law, parameter);
}

static void add_parameter(frame_set *f, int n, int parameter, values_of *values, int index) {
  const pl_law *law = f->laws[n].law;
  const pl_parameter *p = &law->parameters[parameter];
  const bool pairs = law->kind != PL_CONTINUUM && (law->kind != PL_STATE || law->pairwise);
  const bool bonds = pairs && parameter != law->density;
  const bool link = run_body_is_link(&f->bodies[f->laws[n].from->lattice]);
  if (!is_asked(f->asked, p->name) || (link && !bonds)) return;
  add(f,
      (frame_field){.name = p->name,
                    .unit = p->unit,
                    .on_bonds = bonds,
                    .components = 1,
                    .interaction = n,
                    .of_law = true,
                    .kind = "other",
                    .long_name = words_of(p->doc, "parameter of the law")},
      values, index);
}

static frame_field field_of_law(const pl_field *of, int n, const char *kind, const char *words) {
  return (frame_field){.name = of->name,
                       .unit = of->unit,
                       .on_bonds = on_bonds(of),
                       .components = 1,
                       .interaction = n,
                       .of_law = true,
                       .kind = kind,
                       .long_name = words_of(of->doc, words)};
}

static void add_states(frame_set *f, int n, bool of_cells) {
  const pl_law *law = f->laws[n].law;
  for (int k = 0; k < law->field_count; k++) {
    const pl_field *s = &law->fields[k];
    const bool damages = s->kind == PL_FIELD_DAMAGE;
    if (!is_asked(f->asked, s->name) && !(damages && is_asked(f->asked, "damage"))) continue;
    const frame_field field = field_of_law(s, n, damages ? "damage" : "state",
                                           damages ? "damage of the law" : "state of the law");
    add(f, field, values_of_state, k);
    if (of_cells) add_on_cells(f, field, values_of_cell_state, k);
  }
}

/* Laws that are linear have those that follow the strain alone: smooth, and known at nodes. */
static bool is_of_linear_law(const frame_set *f, const char *output) {
  for (int n = 0; n < f->law_count; n++)
    for (int k = 0; k < f->laws[n].law->output_count && f->laws[n].law->linear; k++)
      if (strcmp(f->laws[n].law->outputs[k].name, output) == 0) return true;
  return false;
}

static void add_outputs(frame_set *f, int n, bool of_cells) {
  const pl_law *law = f->laws[n].law;
  for (int k = 0; k < law->output_count; k++) {
    const pl_field *o = &law->outputs[k];
    if (!is_asked(f->asked, o->name)) continue;
    const frame_field field = field_of_law(o, n, "output", "output of the law");
    add(f, field, values_of_output, k);
    if (of_cells && !is_of_linear_law(f, o->name)) add_on_cells(f, field, values_of_cell_output, k);
  }
}

static void add_of_law(frame_set *f, int n) {
  const pl_law *law = f->laws[n].law;
  const bool of_cells = f->bodies[f->laws[n].from->lattice].cells != NULL;
  add_states(f, n, of_cells);
  add_outputs(f, n, of_cells);
  for (int k = 0; k < parameter_planes_of(law); k++)
    add_parameter(f, n, law->varying[k], values_of_parameter, k);
  for (int p = 0; p < law->parameter_count; p++)
    if (is_field(&f->laws[n], p) && !varies(law, p)) add_parameter(f, n, p, values_of_constant, p);
}

static crack_line *line_of(const frame_set *f, const frame_field *field) {
  const int m = deck_find_monitor(f->watched->deck, field->name);
  return watched_line(f->watched->items[m].own);
}

static void add_cracks(frame_set *f, const monitor *m) {
  const crack_line *line = watched_line(m->own);
  if (!line) return;
  f->fields[f->count++] = (frame_field){.name = m->deck->name,
                                        .unit = "m",
                                        .of_cracks = true,
                                        .components = 2,
                                        .count = crack_line_most(line),
                                        .kind = "cracks",
                                        .long_name = "of each crack: place along the line, width"};
}

/* Of the mesh of that body. */
static void add_path(frame_set *f, const run_body *of, const deck_crack *c) {
  frame_path *path = &f->paths[f->path_count++];
  *path = (frame_path){.tips = of->cells->tips, .of = c};
  snprintf(path->name, sizeof path->name, "%s/points", c->name);
  const int64_t steps = f->clock->relaxation ? INT64_MAX : f->clock->step_count;
  f->fields[f->count++] =
      (frame_field){.name = path->name,
                    .unit = "m",
                    .of_cracks = true,
                    .mesh = of->name,
                    .components = 2,
                    .count = crack_path_most(path->tips, c, steps),
                    .kind = "path",
                    .long_name = "points of the crack from its first to its last, with what has "
                                 "grown at either end"};
}

static void add_stamps(frame_set *f) {
  const run_stamps *all = f->watched->stamps;
  f->first_stamp = f->count;
  for (int n = 0; n < all->count; n++)
    f->fields[f->count++] = (frame_field){.name = all->items[n].from->name,
                                          .unit = "m",
                                          .of_stamp = true,
                                          .components = 1,
                                          .count = f->bodies[0].body->dimensions,
                                          .kind = "stamp",
                                          .long_name = "way of the stamp from where it is drawn"};
}

static void add_paths(frame_set *f, const deck *k) {
  f->paths = must_calloc((size_t)k->crack_count + 1, sizeof *f->paths);
  for (int n = 0; n < k->crack_count; n++)
    for (int b = 0; b < f->body_count; b++)
      if (f->bodies[b].cells && strcmp(f->bodies[b].name, k->cracks[n].mesh) == 0)
        add_path(f, &f->bodies[b], &k->cracks[n]);
}

frame_set *frames_new(const deck_output *asked, const run_body *bodies, int count,
                      const monitors *watched, const run_clock *clock) {
  const size_t most =
      most_fields(bodies, count) +
      (size_t)(watched->count + watched->stamps->count + watched->deck->crack_count);
  frame_set *f = must_calloc(1, sizeof *f);
  *f = (frame_set){.asked = asked,
                   .bodies = bodies,
                   .body_count = count,
                   .laws = bodies[0].laws,
                   .law_count = count_laws(bodies, count),
                   .watched = watched,
                   .clock = clock};
  f->fields = must_calloc(most, sizeof *f->fields);
  f->sources = must_calloc(most * (size_t)f->law_count, sizeof *f->sources);
  f->forces = must_calloc((size_t)count, sizeof *f->forces);
  f->tensors = must_calloc(TENSORS * (size_t)count, sizeof *f->tensors);
  for (const own_field *own = own_fields; own < own_fields + OWN_FIELDS; own++)
    for (int b = 0; b < count; b++)
      add_own(f, own, b);
  for (int k = 0; k < TENSORS; k++)
    for (int b = 0; b < count; b++)
      if (!run_body_is_link(&bodies[b])) add_tensor(f, k, b);
  for (int n = 0; n < f->law_count; n++)
    add_of_law(f, n);
  for (int m = 0; m < watched->count; m++)
    add_cracks(f, &watched->items[m]);
  add_stamps(f);
  add_paths(f, watched->deck);
  return f;
}

void frames_free(frame_set *f) {
  if (!f) return;
  for (int b = 0; b < f->body_count; b++)
    bond_forces_free(f->forces[b]);
  for (int k = 0; k < TENSORS * f->body_count; k++)
    for (int c = 0; c < TENSOR_MOST; c++)
      free(f->tensors[k].values[c]);
  free(f->forces);
  free(f->tensors);
  free(f->paths);
  free(f->fields);
  free(f->sources);
  free(f);
}

int frames_fields(const frame_set *f, const frame_field **fields) {
  *fields = f->fields;
  return f->count;
}

/* Of particles or cells whose laws do not have the field. */
static void fill_without(const frame_field *field, long count, double *values) {
  const double none = strcmp(field->kind, "damage") == 0 ? 0 : NAN;
  for (long k = 0; k < count * field->components; k++)
    values[k] = none;
}

static void values_of_law(const frame_set *f, int field, const run_body *of, const run_law *law,
                          double *values) {
  const frame_source *from = &f->sources[field * f->law_count + (law - f->laws)];
  const frames_of here = {of, law, (long)run_clock_parts(f->clock)};
  if (from->values) from->values(&here, from, values);
}

/* How many of a body's laws have the field. */
static int laws_with(const frame_set *f, int field, const run_body *of) {
  int count = 0;
  for (int n = 0; n < of->law_count; n++)
    count += f->sources[field * f->law_count + (of->laws + n - f->laws)].values != NULL;
  return count;
}

/* Nodes between cells of several laws that have the field: the mean by the areas of these. */
static void values_between_cells(const frame_set *f, int field, const run_body *of,
                                 double *values) {
  const rows *g = of->lattice_rows;
  const size_t count = (size_t)g->particle_count;
  double *one = must_calloc(count, sizeof *one), *weight = must_calloc(count, sizeof *weight),
         *sum = must_calloc(count, sizeof *sum);
  for (int n = 0; n < of->law_count; n++) {
    const run_law *law = &of->laws[n];
    if (!f->sources[field * f->law_count + (law - f->laws)].values) continue;
    values_of_law(f, field, of, law, one);
    for (long p = 0; p < g->particle_count; p++) {
      const double share = law->share[g->particle_site[p]];
      if (!(share > 0)) continue;
      sum[p] += share * one[p];
      weight[p] += share;
    }
  }
  for (long p = 0; p < g->particle_count; p++)
    if (weight[p] > 0) values[p] = sum[p] / weight[p];
  free(one);
  free(weight);
  free(sum);
}

/* Of all meshes, one after the other. */
static void values_on_cells(const frame_set *f, int field, double *values) {
  for (int b = 0; b < f->body_count; b++) {
    const run_body *here = &f->bodies[b];
    if (!here->cells) continue;
    const long count = cells_whole_count(here->cells);
    fill_without(&f->fields[field], count, values);
    for (int n = 0; n < here->law_count; n++)
      values_of_law(f, field, here, &here->laws[n], values);
    values += count;
  }
}

static void values_of_cracks(const frame_set *f, const frame_field *field, double *values) {
  long count;
  const crack *found = crack_line_find(line_of(f, field), &count);
  for (long k = 0; k < field->count; k++) {
    values[2 * k] = k < count ? found[k].place : NAN;
    values[2 * k + 1] = k < count ? found[k].width : NAN;
  }
}

static void values_of_path(const frame_path *path, long most, double *values) {
  const int count = crack_path(path->tips, path->of, (double(*)[2])values, (int)most);
  for (long k = 2 * (long)count; k < 2 * most; k++)
    values[k] = NAN;
}

void frames_values(const frame_set *f, int field, double *values) {
  const frame_field *of = &f->fields[field];
  if (of->mesh) {
    values_of_path(&f->paths[field - (f->count - f->path_count)], of->count, values);
    return;
  }
  if (of->of_cracks) {
    values_of_cracks(f, of, values);
    return;
  }
  if (of->of_stamp) {
    memcpy(values, f->watched->stamps->items[field - f->first_stamp].state.at.place,
           (size_t)of->count * sizeof *values);
    return;
  }
  if (of->on_cells) {
    values_on_cells(f, field, values);
    return;
  }
  if (of->on_bonds) {
    const run_law *law = &f->laws[of->interaction];
    values_of_law(f, field, &f->bodies[law->from->lattice], law, values);
    return;
  }
  for (int b = 0; b < f->body_count; b++) {
    const run_body *here = &f->bodies[b];
    double *at = values + here->first_particle * of->components;
    fill_without(of, run_body_particles(here), at);
    if (here->cells && of->of_law && laws_with(f, field, here) > 1) {
      values_between_cells(f, field, here, at);
      continue;
    }
    for (int n = 0; n < here->law_count && !run_body_is_link(here); n++)
      values_of_law(f, field, here, &here->laws[n], at);
  }
}

/* --- what the deck asks for ------------------------------------------------------------------- */

static bool exists_in_run(const own_field *own, const deck_output *o, const run_body *bodies,
                          int count) {
  for (int b = 0; b < count; b++)
    if (exists_on(own, o, &bodies[b])) return true;
  return false;
}

/* Once. */
static int add_name(const char *name, const char **names, int count) {
  for (int n = 0; n < count; n++)
    if (strcmp(names[n], name) == 0) return count;
  names[count] = name;
  return count + 1;
}

static int add_law_names(const run_law *of, const char **names, int count) {
  const pl_law *law = of->law;
  for (int f = 0; f < law->field_count; f++)
    count = add_name(law->fields[f].name, names, count);
  for (int f = 0; f < law->output_count; f++)
    count = add_name(law->outputs[f].name, names, count);
  for (int p = 0; p < law->parameter_count; p++)
    if (is_field(of, p)) count = add_name(law->parameters[p].name, names, count);
  return count;
}

/* Names that this run can store, or with `all` that some run can; to be freed. */
static const char **field_names(const deck_output *o, const run_body *bodies, int bodies_count,
                                bool all, int *count) {
  const char **names = must_calloc(most_fields(bodies, bodies_count), sizeof *names);
  *count = 0;
  for (int k = 0; k < OWN_FIELDS; k++)
    if (all || exists_in_run(&own_fields[k], o, bodies, bodies_count))
      names[(*count)++] = own_fields[k].name;
  for (int k = 0; k < TENSORS; k++)
    names[(*count)++] = tensor_fields[k].name;
  for (int n = 0; n < count_laws(bodies, bodies_count); n++)
    *count = add_law_names(&bodies[0].laws[n], names, *count);
  return names;
}

static void report_no_field(const deck_output *o, const run_body *bodies, int bodies_count, int k,
                            diagnostics *d) {
  diag_report(d, DIAG_BAD_VALUE, o->field_where[k], "there is no field `%s` to store",
              o->fields[k]);
  if (strcasecmp(o->fields[k], "energy") == 0) {
    diag_hint(d, "energy lost, per particle, is `dissipated`; histories of energies are always "
                 "written");
    return;
  }
  int count;
  const char **names = field_names(o, bodies, bodies_count, false, &count);
  deck_suggest(d, o->fields[k], names, count, "this run can store");
  free(names);
}

static void warn_of_none(const deck_output *o, const run_body *bodies, int count, int k,
                         diagnostics *d) {
  if (count_laws(bodies, count) == 1)
    diag_report(d, DIAG_DECK_WARNING, o->field_where[k],
                "this run with the law `%s` has no `%s` to store", bodies[0].law->name,
                o->fields[k]);
  else
    diag_report(d, DIAG_DECK_WARNING, o->field_where[k],
                "none of the laws of this run has `%s` to store", o->fields[k]);
}

bool frames_check(const deck_output *o, const run_body *bodies, int bodies_count, diagnostics *d) {
  int count;
  const char **names = field_names(o, bodies, bodies_count, true, &count);
  bool good = true;
  for (int k = 0; o->field_where && k < o->field_count; k++) {
    const own_field *own = find_own(o->fields[k]);
    bool known = output_is_component(o->fields[k], bodies[0].law->dimensions);
    for (int n = 0; n < count; n++)
      known |= strcasecmp(names[n], o->fields[k]) == 0;
    good &= known;
    if (!known)
      report_no_field(o, bodies, bodies_count, k, d);
    else if (own && !exists_in_run(own, o, bodies, bodies_count))
      warn_of_none(o, bodies, bodies_count, k, d);
  }
  free(names);
  return good;
}
