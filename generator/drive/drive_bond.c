#include "generator/drive/drive_bond.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "dsl/base/arena.h"
#include "generator/drive/drive_motion.h"
#include "generator/drive/drive_table.h"
#include "generator/drive/driven_fields.h"
#include "runtime/analysis/implied.h"
#include "runtime/analysis/material.h"
#include "runtime/simulation/simulation.h"

enum { LANES = PL_LANES };

/* --- one bond under the passes of a lattice --------------------------------------------------- */

typedef struct motion {
  double stretch, rate, theta[2], theta_rate[2], twist, twist_rate;
} motion;

/* Particle i at the origin, j on the x axis; the chord does not turn, so that the particles'
   rotations are those of the ends. The twist is that of particle j. The passes work on PL_LANES
   bonds at once, of which only the first is present. */
typedef struct driven_bond {
  const pl_law *kernel;
  pl_bond_class bonds;
  double *parameters; /* at hand */
  double s, *uniforms, **field, **force, **observed;
  double *displacement[2], *velocity[2], *lost_state, *lost_rate,
      *given; /* of i, j: [dof][LANES] */
  int64_t *flags;
  void *memory; /* of all arrays */
  bool rests;   /* pl_law.works_at_rest */
  pl_strip strip;
} driven_bond;

typedef struct answer {
  double N, M[2], T, lost_state, given, power; /* J, J; W: of the rate terms */
} answer;

static double **lanes(double **next, int count) {
  double **list = must_calloc((size_t)count + 1, sizeof *list);
  for (int k = 0; k < count; k++, *next += LANES)
    list[k] = *next;
  return list;
}

/* The first aligned address in a piece of memory that is a little larger than what is needed. */
static void *aligned(void *memory) {
  uintptr_t at = (uintptr_t)memory;
  return (char *)memory + (PL_ALIGNMENT - at % PL_ALIGNMENT) % PL_ALIGNMENT;
}

static void bond_open(driven_bond *r, const pl_law *kernel, const double *parameters,
                      const pl_bond_class *bonds) {
  int count =
      kernel->field_count + kernel->force_planes + 1 + kernel->output_count + 4 * kernel->dof + 3;
  *r = (driven_bond){.kernel = kernel,
                     .s = bonds->s,
                     .rests = PL_HAS(kernel, works_at_rest) && kernel->works_at_rest};
  r->uniforms = must_calloc((size_t)kernel->uniform_count + 1, sizeof(double));
  r->memory = must_calloc((size_t)(count + 2) * LANES, sizeof(double));
  r->flags = aligned(r->memory);
  double *next = (double *)aligned(r->memory) + LANES;
  r->field = lanes(&next, kernel->field_count);
  r->force = lanes(&next, kernel->force_planes);
  r->observed = lanes(&next, 1 + kernel->output_count);
  for (int end = 0; end < 2; end++) {
    r->displacement[end] = next;
    r->velocity[end] = next + LANES * kernel->dof;
    next += 2 * LANES * kernel->dof;
  }
  r->lost_state = next;
  r->lost_rate = next + LANES;
  r->given = next + 2 * LANES;
  r->flags[0] = PL_PRESENT(0);
  r->strip = (pl_strip){.size = sizeof r->strip,
                        .count = LANES,
                        .flags = r->flags,
                        .field = r->field,
                        .force = r->force,
                        .dissipated_state = r->lost_state,
                        .dissipated_rate = r->lost_rate,
                        .given_by_rest = r->given,
                        .observed = r->observed,
                        .time_step = 1};
  for (int k = 0; k < kernel->dof; k++) {
    r->strip.displacement_i[k] = r->displacement[0] + k * LANES;
    r->strip.displacement_j[k] = r->displacement[1] + k * LANES;
    r->strip.velocity_i[k] = r->velocity[0] + k * LANES;
    r->strip.velocity_j[k] = r->velocity[1] + k * LANES;
  }
  r->bonds = *bonds;
  r->parameters = must_calloc((size_t)kernel->parameter_count + 1, sizeof(double));
  memcpy(r->parameters, parameters, (size_t)kernel->parameter_count * sizeof(double));
  kernel->prepare(kernel, parameters, bonds, r->uniforms);
}

/* The law with what its fields are at a time. */
static void bond_given(driven_bond *r, const drive_input *in, double time) {
  if (driven_fields_at(in, r->kernel, time, r->parameters))
    r->kernel->prepare(r->kernel, r->parameters, &r->bonds, r->uniforms);
}

static void bond_close(driven_bond *r) {
  free(r->uniforms);
  free(r->parameters);
  free(r->memory);
  free(r->field);
  free(r->force);
  free(r->observed);
}

static void bond_move(driven_bond *r, const motion *m) {
  r->displacement[1][0] = m->stretch * r->s;
  r->velocity[1][0] = m->rate * r->s;
  for (int end = 0; end < 2 && r->kernel->dof > 2; end++) {
    r->displacement[end][2 * LANES] = m->theta[end];
    r->velocity[end][2 * LANES] = m->theta_rate[end];
  }
  if (r->kernel->dof < 4) return;
  r->displacement[1][3 * LANES] = m->twist;
  r->velocity[1][3 * LANES] = m->twist_rate;
}

/* Forces in a motion; state and damage go on. */
static answer bond_step(driven_bond *r, const motion *m) {
  bond_move(r, m);
  r->lost_state[0] = r->lost_rate[0] = r->given[0] = 0;
  r->kernel->rows_ledger(r->kernel, r->uniforms, &r->strip);
  answer a = {.N = r->force[0][0] + 0.0,
              .lost_state = r->lost_state[0],
              .given = r->given[0],
              .power = r->lost_rate[0] / r->strip.time_step};
  for (int end = 0; end < 2 && r->kernel->dof > 2; end++)
    a.M[end] = r->force[2 + end][0] + 0.0;
  if (r->kernel->dof > 3) a.T = r->force[4][0] + 0.0;
  return a;
}

/* Stored energy; state and damage stay. Outputs are in r->observed. */
static double stored_energy(driven_bond *r, const motion *m) {
  bond_move(r, m);
  r->kernel->rows_observe(r->kernel, r->uniforms, &r->strip);
  return r->observed[0][0];
}

/* Forces only: state and damage stay. */
static answer bond_probe(driven_bond *r, const motion *m) {
  double *kept = must_calloc((size_t)r->kernel->field_count + 1, sizeof *kept);
  for (int f = 0; f < r->kernel->field_count; f++)
    kept[f] = r->field[f][0];
  answer a = bond_step(r, m);
  for (int f = 0; f < r->kernel->field_count; f++)
    r->field[f][0] = kept[f];
  free(kept);
  return a;
}

/* --- the path --------------------------------------------------------------------------------- */

/* Slopes are taken just beside the time, inside of the step meant, where the path has no corner. */
static motion motion_at(const drive_input *in, double time, double inside, bool moving) {
  motion m = {.stretch = drive_at(in, DRIVE_STRETCH, time),
              .theta = {drive_at(in, DRIVE_THETA_I, time), drive_at(in, DRIVE_THETA_J, time)},
              .twist = drive_at(in, DRIVE_TWIST, time)};
  if (moving) {
    m.rate = drive_slope(in, DRIVE_STRETCH, inside);
    m.theta_rate[0] = drive_slope(in, DRIVE_THETA_I, inside);
    m.theta_rate[1] = drive_slope(in, DRIVE_THETA_J, inside);
    m.twist_rate = drive_slope(in, DRIVE_TWIST, inside);
  }
  if (drive_prescribes(in, DRIVE_STRETCH_RATE)) m.rate = drive_at(in, DRIVE_STRETCH_RATE, time);
  return m;
}

static const double beside = 1e-6; /* of a step */

static motion motion_ending(const drive_input *in, const double *t, long count, long k) {
  long other = k ? k - 1 : 1;
  return motion_at(in, t[k], count > 1 ? t[k] + beside * (t[other] - t[k]) : 0, count > 1);
}

static motion motion_beginning(const drive_input *in, const double *t, long k) {
  return motion_at(in, t[k], t[k] + beside * (t[k + 1] - t[k]), true);
}

static bool same_rates(const motion *a, const motion *b) {
  return a->rate == b->rate && a->theta_rate[0] == b->theta_rate[0] &&
         a->theta_rate[1] == b->theta_rate[1] && a->twist_rate == b->twist_rate;
}

/* --- the table -------------------------------------------------------------------------------- */

static const char *const first_names[] = {
#define X(code, name, unit) name,
    DRIVE_FIRST_COLUMNS(X)
#undef X
};
static const char *const first_units[] = {
#define X(code, name, unit) unit,
    DRIVE_FIRST_COLUMNS(X)
#undef X
};
static const char *const last_names[] = {
#define X(code, name) name,
    DRIVE_LAST_COLUMNS(X)
#undef X
};

static bool has_own(const pl_law *kernel, const char *name) {
  for (int k = 0; k < kernel->field_count; k++)
    if (strcmp(kernel->fields[k].name, name) == 0) return true;
  for (int k = 0; k < kernel->output_count; k++)
    if (strcmp(kernel->outputs[k].name, name) == 0) return true;
  for (int k = 0; k < kernel->parameter_count; k++)
    if (material_is_given(kernel, k) && strcmp(kernel->parameters[k].name, name) == 0) return true;
  return false;
}

/* Whether bonds of the law never have it: they do not turn, or not about themselves. */
static bool is_absent(const pl_law *kernel, int k) {
  const bool twist = k == DRIVE_COLUMN_TWIST || k == DRIVE_COLUMN_T;
  const bool turn = k == DRIVE_COLUMN_THETA_I || k == DRIVE_COLUMN_THETA_J ||
                    k == DRIVE_COLUMN_M_I || k == DRIVE_COLUMN_M_J;
  return (twist && kernel->dof < 4) || (turn && kernel->dof < 3);
}

/* Where a law measures `stretch` from a rest stretch, that of a path is what it calls the total.
   The temperature of a law without twist is `T`. */
static const char *name_of_column(drive_table *t, const law *l, const pl_law *kernel, int k) {
  if (k == DRIVE_COLUMN_STRETCH && l->rest) return "total_stretch";
  const bool gives_way = is_absent(kernel, k) && has_own(kernel, first_names[k]);
  return gives_way ? arena_printf(t->memory, "bond_%s", first_names[k]) : first_names[k];
}

static void table_open(drive_table *t, const law *l, const pl_law *kernel, long room) {
  int count = DRIVE_COLUMN_LAW + kernel->field_count + kernel->output_count +
              driven_fields_count(kernel) + DRIVE_ENERGY_COUNT;
  *t = (drive_table){.memory = arena_new(),
                     .way = DRIVE_COLUMN_STRETCH,
                     .force = DRIVE_COLUMN_N,
                     .law_column = DRIVE_COLUMN_LAW,
                     .fields = kernel->field_count,
                     .bad_row = -1};
  t->columns = arena_alloc(t->memory, (size_t)count * sizeof *t->columns);
  for (int k = 0; k < DRIVE_COLUMN_LAW; k++)
    drive_add_column(t, name_of_column(t, l, kernel, k), first_units[k], room);
  for (int k = 0; k < kernel->field_count; k++)
    drive_add_column(t, kernel->fields[k].name, kernel->fields[k].unit, room);
  for (int k = 0; k < kernel->output_count; k++)
    drive_add_column(t, kernel->outputs[k].name, kernel->outputs[k].unit, room);
  driven_fields_add(t, kernel, room);
  for (int k = 0; k < DRIVE_ENERGY_COUNT; k++)
    drive_add_column(t, last_names[k], "J", room);
}

void drive_columns(const law *l, const pl_law *kernel, drive_table *out) {
  table_open(out, l, kernel, 0);
}

/* --- the march -------------------------------------------------------------------------------- */

typedef struct marching {
  const drive_input *in;
  driven_bond driven_bond;
  drive_table *table;
  motion at; /* of the last row */
  answer forces;
  double energy[DRIVE_ENERGY_COUNT];
} marching;

static void put_row(marching *m, double time) {
  drive_table *t = m->table;
  const long row = t->rows++;
  const pl_law *kernel = m->driven_bond.kernel;
  const double first[DRIVE_COLUMN_LAW] = {
      time,        m->at.stretch, m->at.rate,     m->at.theta[0], m->at.theta[1],
      m->at.twist, m->forces.N,   m->forces.M[0], m->forces.M[1], m->forces.T};
  int c = 0;
  for (; c < DRIVE_COLUMN_LAW; c++)
    t->columns[c].values[row] = first[c];
  for (int f = 0; f < kernel->field_count; f++)
    t->columns[c++].values[row] = m->driven_bond.field[f][0];
  for (int f = 0; f < kernel->output_count; f++)
    t->columns[c++].values[row] = m->driven_bond.observed[1 + f][0];
  c = driven_fields_put(t, kernel, m->driven_bond.parameters, c, row);
  double *e = m->energy;
  e[DRIVE_ENERGY_DISSIPATED] =
      e[DRIVE_ENERGY_DISSIPATED_DAMAGE] + e[DRIVE_ENERGY_DISSIPATED_DAMPING];
  e[DRIVE_ENERGY_IMBALANCE] =
      e[DRIVE_ENERGY_EXTERNAL] - e[DRIVE_ENERGY_STORED] - e[DRIVE_ENERGY_DISSIPATED];
  for (int k = 0; k < DRIVE_ENERGY_COUNT; k++)
    t->columns[c++].values[row] = e[k];
  for (int k = 0; k < t->column_count; k++)
    if (!isfinite(t->columns[k].values[row])) t->bad_row = row;
}

/* Work is done before the first row, as much as is there. */
static void first_row(marching *m, const motion *to, double time) {
  m->at = *to;
  m->driven_bond.strip.time = time;
  m->forces = bond_step(&m->driven_bond, to);
  double stored = stored_energy(&m->driven_bond, to);
  m->energy[DRIVE_ENERGY_STORED] = stored;
  m->energy[DRIVE_ENERGY_DISSIPATED_DAMAGE] = m->forces.lost_state;
  m->energy[DRIVE_ENERGY_EXTERNAL] = stored + m->forces.lost_state;
  put_row(m, time);
}

/* What the change of the fields in a step adds to the stored energy, at the state at its end. */
static double given_by_fields(marching *m, const motion *at, double time, double step) {
  driven_bond *r = &m->driven_bond;
  if (m->in->given_count == 0) return 0;
  bond_given(r, m->in, time - step);
  const double before = stored_energy(r, at);
  bond_given(r, m->in, time);
  return stored_energy(r, at) - before;
}

/* Trapezoids throughout: work and rate losses between the step's ends, and what damage costs as the
   mean of what it costs at the deformation before and after, which is exact to second order and for
   sudden changes between the two. What fields give is the mean of what they do at either end; what
   a rest state gives that follows states, and what these cost, is as the law books it. */
static void next_row(marching *m, const motion *from, const motion *to, double time, double step) {
  double *e = m->energy;
  driven_bond *r = &m->driven_bond;
  r->strip.time = time - step;
  r->strip.advance = 0;
  answer before = same_rates(from, &m->at) ? m->forces : bond_probe(r, from);
  r->strip.time = time;
  r->strip.advance = step;
  r->strip.time_step = step;
  bond_given(r, m->in, time);
  const double begins = m->in->given_count ? stored_energy(r, from) : e[DRIVE_ENERGY_STORED];
  e[DRIVE_ENERGY_EXTERNAL] += 0.5 * (begins - e[DRIVE_ENERGY_STORED]);
  answer after = bond_step(r, to);
  const double lost_before = r->rests ? after.lost_state : begins - stored_energy(r, from);
  e[DRIVE_ENERGY_DISSIPATED_DAMAGE] += 0.5 * (lost_before + after.lost_state);
  e[DRIVE_ENERGY_EXTERNAL] += after.given;
  e[DRIVE_ENERGY_DISSIPATED_DAMPING] += 0.5 * (before.power + after.power) * step;
  e[DRIVE_ENERGY_EXTERNAL] += 0.5 * (before.N + after.N) * (to->stretch - from->stretch) * r->s;
  for (int end = 0; end < 2; end++)
    e[DRIVE_ENERGY_EXTERNAL] +=
        0.5 * (before.M[end] + after.M[end]) * (to->theta[end] - from->theta[end]);
  e[DRIVE_ENERGY_EXTERNAL] += 0.5 * (before.T + after.T) * (to->twist - from->twist);
  e[DRIVE_ENERGY_EXTERNAL] += 0.5 * given_by_fields(m, to, time, step);
  e[DRIVE_ENERGY_STORED] = stored_energy(r, to);
  m->at = *to;
  m->forces = after;
  put_row(m, time);
}

static bool stays_a_bond(const drive_input *in, double stretch, double time, diagnostics *d) {
  if (stretch > -1 && isfinite(stretch)) return true;
  int k = 0;
  while (k < in->piece_count - 1 && in->pieces[k].quantity != DRIVE_STRETCH)
    k++;
  diag_report(d, DIAG_OUT_OF_BOUNDS, in->pieces[k].where,
              "the stretch comes to %.6g at %.6g s: the bond has no length left", stretch, time);
  diag_hint(d, "a stretch is the change of length over the length, more than -1");
  return false;
}

bool drive_bond_class(const drive_input *in, double rho, pl_bond_class *out) {
  const drive_bond *b = &in->bond;
  const deck_lattice like = b->area > 0 ? lattice_default_chain(b->spacing, b->area)
                                        : lattice_default("plane_stress", b->spacing, b->thickness);
  rows *w = implied_lattice_like(&like, rho);
  if (!w) return false;
  *out = rows_bond_class(w, 0);
  rows_free(w);
  if (in->bond.mass_i > 0) out->mass_i = out->mass_j = in->bond.mass_i;
  if (in->bond.mass_j > 0) out->mass_j = in->bond.mass_j;
  return true;
}

bool drive_run(const drive_input *in, const law *l, const pl_law *kernel, const double *parameters,
               const double *initial, drive_table *out, diagnostics *d) {
  long count;
  pl_bond_class bonds;
  if (!drive_bond_class(in, material_density(kernel, parameters), &bonds)) {
    diag_report(d, DIAG_OUT_OF_BOUNDS, deck_where(&in->bond.item, "spacing"),
                "there is no lattice of a spacing of %.4g m", in->bond.spacing);
    return false;
  }
  double *t = drive_times(in, &count);
  marching m = {.in = in, .table = out};
  table_open(out, l, kernel, count);
  bond_open(&m.driven_bond, kernel, parameters, &bonds);
  for (int f = 0; f < kernel->field_count; f++)
    m.driven_bond.field[f][0] = initial[f];
  bond_given(&m.driven_bond, in, count > 0 ? t[0] : 0);
  bool good = true;
  for (long k = 0; good && k < count && out->bad_row < 0; k++) {
    motion to = motion_ending(in, t, count, k);
    good = stays_a_bond(in, to.stretch, t[k], d);
    if (!good) break;
    if (k == 0) {
      first_row(&m, &to, t[k]);
      continue;
    }
    motion from = motion_beginning(in, t, k - 1);
    next_row(&m, &from, &to, t[k], t[k] - t[k - 1]);
  }
  bond_close(&m.driven_bond);
  free(t);
  return good;
}

void drive_observe(const drive_input *in, const pl_law *kernel, const double *parameters,
                   const drive_table *t, long row, double *outputs) {
  pl_bond_class bonds;
  driven_bond r;
  if (!drive_bond_class(in, material_density(kernel, parameters), &bonds)) return;
  bond_open(&r, kernel, parameters, &bonds);
  bond_given(&r, in, t->columns[DRIVE_COLUMN_TIME].values[row]);
  for (int f = 0; f < kernel->field_count; f++)
    r.field[f][0] = t->columns[DRIVE_COLUMN_LAW + f].values[row];
  motion m = {.stretch = t->columns[DRIVE_COLUMN_STRETCH].values[row],
              .rate = t->columns[DRIVE_COLUMN_STRETCH_RATE].values[row],
              .theta = {t->columns[DRIVE_COLUMN_THETA_I].values[row],
                        t->columns[DRIVE_COLUMN_THETA_J].values[row]},
              .twist = t->columns[DRIVE_COLUMN_TWIST].values[row]};
  stored_energy(&r, &m);
  for (int k = 0; k < kernel->output_count; k++)
    outputs[k] = r.observed[1 + k][0];
  bond_close(&r);
}
