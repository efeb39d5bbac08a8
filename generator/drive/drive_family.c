/* One particle of a law of families, driven along a path of strain: a lattice in which all
   particles are alike, so that one of them, periodic, stands for all. */
#include "generator/drive/drive_family.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "dsl/base/arena.h"
#include "generator/drive/drive_motion.h"
#include "generator/drive/drive_table.h"
#include "generator/drive/driven_fields.h"
#include "generator/interpreter/interpreted.h"
#include "generator/lower/law_inputs.h"
#include "generator/lower/lower_inputs.h"
#include "generator/lower/lower_rest.h"
#include "generator/plan/plan_family.h"
#include "generator/plan/plan_roots.h"
#include "runtime/analysis/implied.h"
#include "runtime/analysis/patch.h"
#include "runtime/simulation/simulation.h"

static const char *const part_names[] = {"xx", "yy", "zz", "xy", "yz", "xz"};
static const int plane_parts[] = {0, 1, 3}, space_parts[] = {0, 1, 2, 3, 4, 5};
static const int first_axis[] = {0, 1, 2, 0, 1, 0}, second_axis[] = {0, 1, 2, 1, 2, 2};
static const drive_quantity strain_of[] = {DRIVE_STRAIN_XX, DRIVE_STRAIN_YY, DRIVE_STRAIN_ZZ,
                                           DRIVE_STRAIN_XY, DRIVE_STRAIN_YZ, DRIVE_STRAIN_XZ};
enum { PARTS = 6 };

/* --- what the law says of the particle -------------------------------------------------------- */

/* Components of stress and strain that there are. */
static int part_count(int dimensions) {
  return dimensions == 2 ? 3 : PARTS;
}

static int part(int dimensions, int k) {
  return dimensions == 2 ? plane_parts[k] : space_parts[k];
}

/* Component `which` of the moment of the force of a bond, times the particle's volume twice: of
   a force along it F X X/s; of a vector that of both its sides, the mean of F X and X F. */
static ir_node bond_moment(ir *g, const lowered_law *step, int which) {
  const int x = first_axis[which], y = second_axis[which];
  const ir_node X = kinematics_input(g, law_chord[x]), Y = kinematics_input(g, law_chord[y]);
  const ir_node half = ir_constant(g, 0.5);
  if (lowered_is_vector(step)) {
    ir_node other = ir_unary(g, IR_NEIGHBOUR, step->F_of[x]);
    const ir_node f_x = ir_mul(g, half, ir_sub(g, step->F_of[x], other));
    other = ir_unary(g, IR_NEIGHBOUR, step->F_of[y]);
    const ir_node f_y = ir_mul(g, half, ir_sub(g, step->F_of[y], other));
    const ir_node turned = ir_mul(g, f_y, X);
    return ir_mul(g, half, ir_add(g, ir_mul(g, f_x, Y), turned));
  }
  const ir_node other = ir_unary(g, IR_NEIGHBOUR, step->F);
  const ir_node force = ir_mul(g, half, ir_add(g, step->F, other));
  const ir_node moment = ir_div(g, force, lower_quantity(g, QUANTITY_S));
  return ir_mul(g, ir_mul(g, X, Y), moment);
}

/* What a neighbour's column shows: the force along the bond, of a vector as the bond was. */
static ir_node shown_force(ir *g, const lowered_law *step, int dimensions) {
  if (!lowered_is_vector(step)) return step->F;
  ir_node sum = ir_constant(g, 0);
  for (int d = 0; d < dimensions; d++) {
    const ir_node part = ir_mul(g, step->F_of[d], kinematics_input(g, law_chord[d]));
    sum = ir_add(g, sum, part);
  }
  return ir_div(g, sum, lower_quantity(g, QUANTITY_S));
}

/* A plan that observes the stress (by virtual work, of the bond forces) and the force state, of
   the step that begins with the fields at hand. NULL when the law cannot be lowered. */
static kernel_plan *plan_stress(const law *l, diagnostics *d) {
  kernel_plan *p = plan_begin(l, FORM_LOOPS);
  lowered_law step;
  ir *g = p->graph;
  p->dimensions = p->dof = l->setting == SETTING_SPACE ? 3 : 2;
  p->reads_shape = true;
  if (!lower_law(l, g, LOWER_STEP, p->memory, &step, d)) {
    plan_free(p);
    return NULL;
  }
  rest_take_off_law(g, l, &step);
  const int count = part_count(p->dimensions), own = 1 + l->outputs.count;
  segment wanted = {.root_count = 0};
  ir_node twice = ir_scaled(g, 2, lower_quantity(g, QUANTITY_V));
  for (int k = 0; k < count; k++) {
    const ir_node term = bond_moment(g, &step, part(p->dimensions, k));
    ir_node sum = ir_make(g, IR_FAMILY_SUM, term, IR_NONE, IR_NONE);
    plan_want(p, &wanted, ir_div(g, sum, twice), TO_OBSERVED, OVER_PARTICLES, own + k);
  }
  const ir_node shown = shown_force(g, &step, p->dimensions);
  plan_want(p, &wanted, shown, TO_OBSERVED, OVER_NEIGHBOURS, own + count);
  program_motion motion = plan_motion(p, step.along_reference);
  program_build(&p->programs[PROGRAM_OBSERVE], "stress", g, p->memory, &wanted, &motion,
                SHARE_NOTHING, &p->links);
  plan_hoist(p);
  return p;
}

static bool gauge_open(family_gauge *g, const law *l, diagnostics *d) {
  if (!g->plan) g->plan = plan_stress(l, d);
  if (g->plan && !g->kernel) g->kernel = plan_interpreted(g->plan);
  return g->kernel != NULL;
}

void family_gauge_close(family_gauge *g) {
  if (g->kernel) plan_interpreted_free(g->kernel);
  plan_free(g->plan);
  *g = (family_gauge){.plan = NULL};
}

/* --- the particle ----------------------------------------------------------------------------- */

typedef struct driven_particle {
  const pl_law *kernel;
  rows *lattice;
  patch *law, *stress; /* the same particle */
  long site;
  int dimensions, parts, neighbours;
} driven_particle;

deck_lattice drive_lattice(const drive_input *in, const law *l) {
  const drive_particle *p = &in->particle;
  deck_lattice d = lattice_default(law_setting_name(l->setting), p->spacing, p->thickness);
  if (p->lattice) d.kind = p->lattice;
  if (p->lattice || p->shells) d.shells = p->shells;
  d.horizon = p->horizon;
  d.rotation = p->rotation;
  return d;
}

static bool refuse(const drive_input *in, diagnostics *d, const char *what) {
  diag_report(d, DIAG_BAD_VALUE, in->particle.item.where, "%s", what);
  return false;
}

static void particle_close(driven_particle *r) {
  patch_free(r->law);
  patch_free(r->stress);
  if (r->lattice) rows_free(r->lattice);
}

/* `g` NULL: its stress is not asked for. */
static bool particle_open(driven_particle *r, const drive_input *in, const law *l,
                          const pl_law *kernel, family_gauge *g, const double *parameters,
                          diagnostics *d) {
  static const long one[3] = {1, 1, 1}, origin[3] = {0, 0, 0};
  const deck_lattice like = drive_lattice(in, l);
  *r = (driven_particle){.kernel = kernel, .dimensions = kernel->dimensions};
  if (bravais_dimensions(like.kind) != kernel->dimensions || deck_lattice_is_chain(&like))
    return refuse(in, d, "this lattice does not suit the setting of the law");
  r->lattice = implied_lattice_like(&like, material_density(kernel, parameters));
  if (!r->lattice)
    return refuse(in, d, "a particle of this lattice has no neighbours, or too many");
  if (g && !gauge_open(g, l, d)) return false;
  r->parts = part_count(r->dimensions);
  r->neighbours = 2 * r->lattice->directions;
  r->law = patch_new(kernel, parameters, r->lattice, one, 0, 0);
  r->stress = g ? patch_new(g->kernel, parameters, r->lattice, one, r->parts, 1) : NULL;
  r->site = patch_site(r->law, origin);
  return true;
}

/* A field of the particle, or all its planes toward neighbours, on all images. */
static void set_plane(patch *p, int field, long plane, double value) {
  double *v = p->field[field] + plane * p->size;
  v[p->inside[0]] = value;
  patch_repeat(p, v);
}

static void share_fields(driven_particle *r) {
  for (int f = 0; f < r->kernel->field_count; f++)
    for (long k = 0; k < patch_planes(r->law, &r->kernel->fields[f]); k++)
      set_plane(r->stress, f, k, r->law->field[f][k * r->law->size + r->site]);
}

static void particle_move(driven_particle *r, const double *strain, const double *rate) {
  double gradient[2][3][3] = {{{0}}};
  patch *both[] = {r->law, r->stress};
  for (int k = 0; k < r->parts; k++) {
    const int which = part(r->dimensions, k), x = first_axis[which], y = second_axis[which];
    gradient[0][x][y] = gradient[0][y][x] = strain[k];
    gradient[1][x][y] = gradient[1][y][x] = rate[k];
  }
  for (int k = 0; k < 2 && both[k]; k++) {
    patch_deform(both[k], (const double(*)[3])gradient[0], NULL, both[k]->displacement);
    patch_deform(both[k], (const double(*)[3])gradient[1], NULL, both[k]->velocity);
  }
}

/* --- the table -------------------------------------------------------------------------------- */

static void add_parts(drive_table *t, const char *what, const char *unit_text, int dimensions,
                      long room) {
  for (int k = 0; k < part_count(dimensions); k++)
    drive_add_column(t, arena_printf(t->memory, "%s_%s", what, part_names[part(dimensions, k)]),
                     unit_text, room);
}

/* One column, or one toward each neighbour: name_1, name_2, ... */
static void add_values(drive_table *t, const pl_field *f, int neighbours, long room) {
  if (f->place == PL_ON_PARTICLE) {
    drive_add_column(t, f->name, f->unit, room);
    return;
  }
  for (int k = 0; k < neighbours; k++)
    drive_add_column(t, arena_printf(t->memory, "%s_%d", f->name, k + 1), f->unit, room);
}

static int value_count(const pl_field *f, int neighbours) {
  return f->place == PL_ON_PARTICLE ? 1 : neighbours;
}

static const char *const energy_names[] = {"stored", "dissipated", "external"};
enum { STORED, DISSIPATED, EXTERNAL, ENERGIES };

static void table_open(drive_table *t, const pl_law *kernel, int neighbours, long room) {
  const int parts = part_count(kernel->dimensions);
  int count = 1 + 3 * parts + neighbours + driven_fields_count(kernel) + ENERGIES;
  for (int f = 0; f < kernel->field_count; f++)
    count += value_count(&kernel->fields[f], neighbours);
  for (int f = 0; f < kernel->output_count; f++)
    count += value_count(&kernel->outputs[f], neighbours);
  *t = (drive_table){.memory = arena_new(), .of = DRIVE_OF_FAMILIES, .bad_row = -1};
  t->columns = arena_alloc(t->memory, (size_t)count * sizeof *t->columns);
  drive_add_column(t, "time", "s", room);
  add_parts(t, "strain", "1", kernel->dimensions, room);
  add_parts(t, "strain_rate", "1/s", kernel->dimensions, room);
  add_parts(t, "stress", "Pa", kernel->dimensions, room);
  t->way = 1;
  t->force = 1 + 2 * parts;
  for (int k = 0; k < neighbours; k++)
    drive_add_column(t, arena_printf(t->memory, "F_%d", k + 1), "N", room);
  t->law_column = t->column_count;
  for (int f = 0; f < kernel->field_count; f++)
    add_values(t, &kernel->fields[f], neighbours, room);
  t->fields = t->column_count - t->law_column;
  for (int f = 0; f < kernel->output_count; f++)
    add_values(t, &kernel->outputs[f], neighbours, room);
  driven_fields_add(t, kernel, room);
  for (int k = 0; k < ENERGIES; k++)
    drive_add_column(t, energy_names[k], "J", room);
}

static int neighbours_of(const drive_input *in, const law *l) {
  const deck_lattice like = drive_lattice(in, l);
  rows *w = implied_lattice_like(&like, 0);
  const int count = w ? 2 * w->directions : 0;
  if (w) rows_free(w);
  return count;
}

void drive_family_columns(const drive_input *in, const law *l, const pl_law *kernel,
                          drive_table *out) {
  table_open(out, kernel, neighbours_of(in, l), 0);
}

/* --- the march -------------------------------------------------------------------------------- */

typedef struct state {
  double strain[PARTS], rate[PARTS], stress[PARTS];
} state;

static state state_at(const drive_input *in, int dimensions, double time, double inside) {
  state s = {.strain = {0}};
  for (int k = 0; k < part_count(dimensions); k++) {
    const drive_quantity q = strain_of[part(dimensions, k)];
    s.strain[k] = drive_at(in, q, time);
    s.rate[k] = drive_slope(in, q, inside);
  }
  return s;
}

/* J on the particle's volume; shear counts on either side of the diagonal. */
static double work_between(const driven_particle *r, const state *a, const state *b) {
  double sum = 0;
  for (int k = 0; k < r->parts; k++) {
    const int which = part(r->dimensions, k);
    const double times = first_axis[which] == second_axis[which] ? 1 : 2;
    sum += times * 0.5 * (a->stress[k] + b->stress[k]) * (b->strain[k] - a->strain[k]);
  }
  return sum * r->lattice->volume;
}

static void put_values(const driven_particle *r, drive_table *t, int *c, const pl_field *f,
                       const double *values) {
  for (int k = 0; k < value_count(f, r->neighbours); k++)
    t->columns[(*c)++].values[t->rows] = values[k * r->law->size + r->site];
}

static void put_row(const driven_particle *r, drive_table *t, double time, const state *s,
                    const double *given, const double *energy) {
  const pl_law *kernel = r->kernel;
  const double *of_state[] = {s->strain, s->rate, s->stress};
  int c = 0;
  t->columns[c++].values[t->rows] = time;
  for (int what = 0; what < 3; what++)
    for (int k = 0; k < r->parts; k++)
      t->columns[c++].values[t->rows] = of_state[what][k];
  const double *force = r->stress->observed[1 + kernel->output_count + r->parts];
  for (int k = 0; k < r->neighbours; k++)
    t->columns[c++].values[t->rows] = force[k * r->stress->size + r->site];
  for (int f = 0; f < kernel->field_count; f++)
    put_values(r, t, &c, &kernel->fields[f], r->law->field[f]);
  for (int f = 0; f < kernel->output_count; f++)
    put_values(r, t, &c, &kernel->outputs[f], r->law->observed[1 + f]);
  c = driven_fields_put(t, kernel, given, c, t->rows);
  for (int k = 0; k < ENERGIES; k++)
    t->columns[c++].values[t->rows] = energy[k];
  for (int k = 0; k < t->column_count; k++)
    if (!isfinite(t->columns[k].values[t->rows])) t->bad_row = t->rows;
  t->rows++;
}

/* The law's step at a state; fields go on. */
static void take_step(driven_particle *r, state *s) {
  particle_move(r, s->strain, s->rate);
  share_fields(r);
  patch_observe(r->stress);
  for (int k = 0; k < r->parts; k++)
    s->stress[k] = r->stress->observed[1 + r->kernel->output_count + k][r->site];
  patch_step(r->law);
  patch_accept(r->law);
  patch_observe(r->law);
}

static void set_fields(driven_particle *r, const double *initial) {
  for (int f = 0; f < r->kernel->field_count; f++)
    for (long k = 0; k < patch_planes(r->law, &r->kernel->fields[f]); k++)
      set_plane(r->law, f, k, initial[f]);
}

/* The law with what its fields are at a time. */
static void take_given(driven_particle *r, const drive_input *in, double time, double *parameters) {
  if (!driven_fields_at(in, r->kernel, time, parameters)) return;
  patch_prepare(r->law, parameters);
  if (r->stress) patch_prepare(r->stress, parameters);
}

/* J: what the change of the fields between two times adds to the stored energy at a state. */
static double given_by_fields(driven_particle *r, const drive_input *in, const state *at,
                              double before, double after, double *parameters) {
  if (in->given_count == 0) return 0;
  particle_move(r, at->strain, at->rate);
  take_given(r, in, before, parameters);
  patch_observe(r->law);
  const double stored = r->law->observed[0][r->site];
  take_given(r, in, after, parameters);
  patch_observe(r->law);
  return r->law->observed[0][r->site] - stored;
}

bool drive_family_run(const drive_input *in, const law *l, const pl_law *kernel, family_gauge *g,
                      const double *parameters, const double *initial, drive_table *out,
                      diagnostics *d) {
  const double beside = 1e-6; /* of a step: rates are those of the step that ends */
  long count;
  driven_particle r;
  state before = {.strain = {0}};
  double energy[ENERGIES] = {0};
  if (!particle_open(&r, in, l, kernel, g, parameters, d)) {
    particle_close(&r);
    return false;
  }
  double *t = drive_times(in, &count);
  table_open(out, kernel, r.neighbours, count);
  set_fields(&r, initial);
  double *now_given = must_calloc((size_t)kernel->parameter_count + 1, sizeof *now_given);
  memcpy(now_given, parameters, (size_t)kernel->parameter_count * sizeof *now_given);
  for (long k = 0; k < count && out->bad_row < 0; k++) {
    const double inside = k ? t[k] - beside * (t[k] - t[k - 1]) : count > 1 ? beside * t[1] : 0;
    state now = state_at(in, r.dimensions, t[k], inside);
    r.law->time_step = r.stress->time_step = k ? t[k] - t[k - 1] : r.law->time_step;
    r.law->advance = r.stress->advance = k ? t[k] - t[k - 1] : 0;
    if (k) energy[EXTERNAL] += 0.5 * given_by_fields(&r, in, &before, t[k - 1], t[k], now_given);
    take_given(&r, in, t[k], now_given);
    take_step(&r, &now);
    if (k) energy[EXTERNAL] += 0.5 * given_by_fields(&r, in, &now, t[k - 1], t[k], now_given);
    energy[STORED] = r.law->observed[0][r.site];
    energy[EXTERNAL] += k ? work_between(&r, &before, &now) : energy[STORED];
    energy[DISSIPATED] = energy[EXTERNAL] - energy[STORED];
    put_row(&r, out, t[k], &now, now_given, energy);
    before = now;
  }
  free(t);
  free(now_given);
  particle_close(&r);
  return true;
}

void drive_family_observe(const drive_input *in, const law *l, const pl_law *kernel,
                          const double *parameters, const drive_table *t, long row,
                          double *outputs) {
  driven_particle r;
  state s = {.strain = {0}};
  diagnostics unheard;
  source_set sources = {NULL, 0};
  double *values = must_calloc((size_t)kernel->parameter_count + 1, sizeof *values);
  diag_begin(&unheard, &sources);
  memcpy(values, parameters, (size_t)kernel->parameter_count * sizeof *values);
  driven_fields_at(in, kernel, t->columns[0].values[row], values);
  if (particle_open(&r, in, l, kernel, NULL, values, &unheard)) {
    int c = t->law_column;
    for (int k = 0; k < r.parts; k++)
      s.strain[k] = t->columns[1 + k].values[row];
    particle_move(&r, s.strain, s.rate);
    for (int f = 0; f < kernel->field_count; f++)
      for (long k = 0; k < patch_planes(r.law, &kernel->fields[f]); k++)
        set_plane(r.law, f, k, t->columns[c++].values[row]);
    patch_observe(r.law);
    for (int k = 0; k < kernel->output_count; k++)
      outputs[k] = r.law->observed[1 + k][r.site];
  }
  particle_close(&r);
  free(values);
  diag_clear(&unheard);
}
