#include "generator/check/physics_bench.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "dsl/base/arena.h"
#include "dsl/base/elementary.h"
#include "dsl/semantics/law_reads.h"
#include "generator/check/physics_parameters.h"
#include "generator/interpreter/comparison.h"
#include "generator/ir/random_values.h"
#include "generator/lower/law_inputs.h"
#include "runtime/analysis/implied.h"

/* --- probes ----------------------------------------------------------------------------------- */

probe probe_new(bench *b, const ir_node *roots, int count) {
  probe p = {.count = count};
  if (!count) return p;
  ir_node *nodes = must_alloc((size_t)count * sizeof *nodes);
  for (int k = 0; k < count; k++)
    nodes[k] = roots[k] == IR_NONE ? ir_constant(b->graph, 0) : roots[k];
  p.program = interpreter_new(b->graph, nodes, count);
  p.out = planes_new(count, BENCH_LANES);
  free(nodes);
  return p;
}

void probe_free(probe *p) {
  if (!p->count) return;
  interpreter_free(p->program);
  planes_free(p->out, p->count);
  p->count = 0;
}

static double *bench_chord(const bench *b, double *const *states, int component) {
  return states[b->width - LAW_CHORD + component];
}

void probe_run(bench *b, probe *p, double *const *states, int count) {
  if (!p->count || !count) return;
  const double *const *planes = (const double *const *)states, *ends[ENDS_COUNT] = {NULL};
  for (int k = 0; k < LAW_CHORD; k++)
    ends[law_chord[k]] = bench_chord(b, states, k);
  interpreter_inputs in = {
      .values = {[IR_FROM_PARAMETER] = planes,
                 [IR_FROM_QUANTITY] = planes + b->parameter_count,
                 [IR_FROM_FIELD] = planes + b->parameter_count + QUANTITY_COUNT,
                 [IR_FROM_ENDS] = ends},
      .stride = {[IR_FROM_PARAMETER] = b->strides,
                 [IR_FROM_QUANTITY] = b->strides,
                 [IR_FROM_FIELD] = b->strides,
                 [IR_FROM_ENDS] = b->strides}};
  interpreter_run(p->program, &in, count, p->out);
  b->evaluated += count;
}

static const double MOST_OPERATIONS = 3e8; /* about 50 ms */

void bench_allow(bench *b, double share) {
  double effort = b->options->effort > 0 ? b->options->effort : 1;
  b->allowed = b->evaluated + share * effort * MOST_OPERATIONS / b->operations;
}

bool bench_tired(const bench *b) {
  return b->evaluated > b->allowed;
}

/* --- opening ---------------------------------------------------------------------------------- */

static void open_guards(bench *b) {
  const law_conditions all = b->conditions = conditions_new(&b->law_step.text, b->graph, b->memory);
  ir_node *guards = must_alloc(((size_t)all.count + 1) * sizeof *guards);
  for (int k = 0; k < all.count; k++)
    guards[k] = all.node[k] == IR_NONE ? ir_constant(b->graph, 1) : all.node[k];
  b->guards = probe_new(b, guards, all.count);
  free(guards);
}

static void open_probes(bench *b) {
  const lowered_law *s = &b->law_step, *f = &b->law_frozen;
  int n = b->field_count;
  ir_node *roots = must_alloc((size_t)(FORCE_COUNT + 2 * n + 1) * sizeof *roots);
  ir_node results[FORCE_COUNT] = {s->N, s->M_i[0], s->M_j[0]},
          held[FORCE_COUNT] = {f->N, f->M_i[0], f->M_j[0]};
  memcpy(roots, results, sizeof results);
  for (int k = 0; k < n; k++) {
    roots[FORCE_COUNT + k] = s->fields[k];
    roots[FORCE_COUNT + n + k] = s->text.rules[k];
  }
  b->step = probe_new(b, roots, FORCE_COUNT + 2 * n);
  unsigned char *marks = must_calloc((size_t)ir_count(b->graph), 1);
  ir_mark(b->graph, roots, FORCE_COUNT + 2 * n, marks);
  for (ir_node k = 0; k < ir_count(b->graph); k++)
    b->operations += marks[k];
  free(marks);
  b->operations = b->operations ? b->operations : 1;
  b->frozen = probe_new(b, held, FORCE_COUNT);
  free(roots);
  open_guards(b);
}

/* That of the deck, or some of other sizes. */
static bool open_lattices(bench *b) {
  deck_lattice usual = physics_usual_lattice(b->law);
  const deck_lattice *given = b->options->lattice;
  const double spacing = usual.spacing, thickness = usual.thickness, area = usual.area;
  const int count = given ? 1 : BENCH_LATTICES;
  for (int k = 0; k < count; k++) {
    b->lattices[k] = implied_lattice_like(given ? given : &usual, 1);
    if (!b->lattices[k]) return false;
    b->lattice_count++;
    usual.spacing = spacing * pl_pow(2, draw_uniform(&b->seed, -2, 2));
    usual.thickness = thickness * pl_pow(2, draw_uniform(&b->seed, -2, 2));
    usual.stiffness_thickness = usual.mass_thickness = usual.thickness;
    usual.area = area * pl_pow(usual.spacing / spacing, 2);
  }
  return true;
}

bool bench_open(bench *b, const law *l, const physics_options *o, diagnostics *d) {
  *b = (bench){.law = l,
               .graph = ir_new(),
               .memory = arena_new(),
               .options = o,
               .seed = o->seed ? o->seed : 20260101};
  b->parameter_count = l->parameters.count;
  b->field_count = l->fields.count;
  b->width = b->parameter_count + QUANTITY_COUNT + b->field_count + LAW_CHORD;
  b->reads_time = law_reads_time(l);
  b->micropolar = law_kind_turns(l->tree->law);
  const size_t longest = (size_t)b->width + ENDS_COUNT; /* as long as any of the parts */
  b->strides = arena_alloc(b->memory, longest);
  memset(b->strides, 1, longest);
  if (!open_lattices(b) || !lower_law(l, b->graph, LOWER_STEP, b->memory, &b->law_step, d) ||
      !lower_law(l, b->graph, LOWER_FROZEN, b->memory, &b->law_frozen, d)) {
    bench_close(b);
    return false;
  }
  open_probes(b);
  return true;
}

void bench_close(bench *b) {
  probe_free(&b->step);
  probe_free(&b->frozen);
  probe_free(&b->guards);
  for (int k = 0; k < b->lattice_count; k++)
    rows_free(b->lattices[k]);
  ir_free(b->graph);
  arena_free(b->memory);
}

/* --- states ----------------------------------------------------------------------------------- */

double **bench_states(const bench *b) {
  return planes_new(b->width, BENCH_LANES);
}

void bench_states_free(const bench *b, double **states) {
  planes_free(states, b->width);
}

double *bench_quantity(const bench *b, double *const *states, builtin_quantity q) {
  return states[b->parameter_count + (int)q];
}

double *bench_field(const bench *b, double *const *states, int k) {
  return states[b->parameter_count + QUANTITY_COUNT + k];
}

void bench_get(const bench *b, double *const *states, int lane, double *column) {
  for (int k = 0; k < b->width; k++)
    column[k] = states[k][lane];
}

void bench_put(const bench *b, double *const *states, int lane, const double *column) {
  for (int k = 0; k < b->width; k++)
    states[k][lane] = column[k];
}

void bench_move(const bench *b, double *const *states, int lane, motion m) {
  for (int k = 0; k < AXIS_COUNT; k++)
    bench_quantity(b, states, law_motion[k])[lane] =
        k >= AXIS_THETA_I && !b->micropolar ? 0 : m.at[k];
  double s = bench_quantity(b, states, QUANTITY_S)[lane];
  bench_quantity(b, states, QUANTITY_LENGTH)[lane] = s * (1 + m.at[AXIS_STRETCH]);
}

void bench_turn(const bench *b, double *const *states, int lane) {
  for (int k = 0; k < LAW_CHORD; k++)
    bench_chord(b, states, k)[lane] *= -1;
}

motion bench_motion(const bench *b, double *const *states, int lane) {
  motion m;
  for (int k = 0; k < AXIS_COUNT; k++)
    m.at[k] = bench_quantity(b, states, law_motion[k])[lane];
  return m;
}

void bench_virgin(const bench *b, double *const *states, int lane) {
  for (int k = 0; k < b->field_count; k++)
    bench_field(b, states, k)[lane] = b->law->fields.items[k]->initial;
  bench_quantity(b, states, QUANTITY_DT)[lane] = 0;
  bench_move(b, states, lane, (motion){{0}});
}

void bench_accept(const bench *b, double *const *states, int count) {
  for (int k = 0; k < b->field_count; k++)
    memcpy(bench_field(b, states, k), b->step.out[FORCE_COUNT + k], (size_t)count * sizeof(double));
}

/* --- parameters ------------------------------------------------------------------------------- */

static void put_class(const bench *b, double *const *states, int lane, const pl_bond_class *c) {
  double values[QUANTITY_COUNT] = {0};
  law_class_values(c, values);
  for (int q = 0; q < QUANTITY_COUNT; q++)
    if (law_motion_place((builtin_quantity)q) < 0)
      bench_quantity(b, states, (builtin_quantity)q)[lane] = values[q];
  for (int k = 0; k < LAW_CHORD; k++)
    bench_chord(b, states, k)[lane] = c->chord[k];
}

/* Of a deck's lattice as a run is told. Without a deck the particles of a bond may differ. */
static pl_bond_class draw_class(bench *b, int lane, double density) {
  rows *w = b->lattices[lane ? draw_bits(&b->seed) % (uint64_t)b->lattice_count : 0];
  const int direction = lane ? (int)(draw_bits(&b->seed) % (uint64_t)(2 * w->directions)) : 0;
  rows_set_density(w, density);
  pl_bond_class c = rows_bond_class(w, direction);
  if (b->options->lattice) return c;
  if (lane) c.mass_j *= pl_pow(2, draw_uniform(&b->seed, -1, 1));
  return c;
}

void bench_draw(bench *b, double *const *states, int lane) {
  const law *l = b->law;
  int n = l->parameters.count;
  double *values = must_calloc((size_t)n + 1, sizeof *values);
  if (b->options->parameters)
    memcpy(values, b->options->parameters, (size_t)n * sizeof *values);
  else
    physics_draw_parameters(l, lane > 0 ? &b->seed : NULL, values);
  for (int p = 0; p < n; p++)
    states[p][lane] = values[p];
  const pl_bond_class c = draw_class(b, lane, l->rho ? values[l->rho->index] : 2000);
  put_class(b, states, lane, &c);
  free(values);
}

/* --- sizes and guards ------------------------------------------------------------------------- */

double bench_length(const bench *b, double *const *states, int lane) {
  return bench_quantity(b, states, QUANTITY_S)[lane];
}

double bench_size(const bench *b, double *const *states, const probe *p, int lane) {
  double moments = fabs(p->out[FORCE_M_I][lane]) + fabs(p->out[FORCE_M_J][lane]);
  return fabs(p->out[FORCE_N][lane]) + moments / bench_length(b, states, lane);
}

void bench_watch(bench *b, double *const *states, int count) {
  probe_run(b, &b->guards, states, count);
  for (int k = 0; k < b->guards.count; k++)
    for (int lane = 0; lane < count; lane++)
      conditions_see(&b->conditions, k, b->guards.out[k][lane] != 0);
  for (int lane = 0; lane < count && b->guards.count; lane++)
    conditions_take(&b->conditions, b->guards.out, lane);
}
