#include "generator/check/physics_family_bench.h"

#include <math.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>

#include "dsl/base/arena.h"
#include "dsl/semantics/law_reads.h"
#include "generator/check/physics_parameters.h"
#include "generator/interpreter/interpreted.h"
#include "generator/ir/random_values.h"
#include "generator/plan/plan_family.h"
#include "generator/plan/plan_roots.h"
#include "runtime/analysis/implied.h"

/* --- plans ------------------------------------------------------------------------------------ */

/* What is observed beside the law's own results. */
typedef struct watching {
  kernel_plan *plan;
  segment wanted;
  int observed; /* places of observed values taken so far */
} watching;

/* Numbers of particles are observed first, those toward neighbours after them. */
static void watch(watching *v, ir_node n, watched *w, bool wide) {
  if (n == IR_NONE || ir_is_of_particle(v->plan->graph, n) == wide) return;
  *w = (watched){v->observed++, wide};
  plan_want(v->plan, &v->wanted, n, TO_OBSERVED, wide ? OVER_NEIGHBOURS : OVER_PARTICLES, w->at);
}

static void watch_all(family_bench *b, watching *v, bool wide) {
  const lowered_text *t = &b->step.text;
  for (int k = 0; k < b->law->fields.count; k++)
    if (b->law->fields.items[k]->kind == SYMBOL_DAMAGE) watch(v, t->rules[k], &b->rule[k], wide);
  for (int k = 0; k < b->conditions.count; k++) {
    watch(v, b->conditions.node[k], &b->guard[k], wide);
    if (k >= t->line_count)
      watch(v, t->flows[k - t->line_count].overstress, &b->overstress[k - t->line_count], wide);
  }
}

static watched *watches(family_bench *b, int count) {
  watched *w = arena_alloc(b->memory, ((size_t)count + 1) * sizeof *w);
  for (int k = 0; k < count; k++)
    w[k].at = -1;
  return w;
}

static kernel_plan *begin(const law *l) {
  kernel_plan *p = plan_begin(l, FORM_LOOPS);
  plan_axes(p);
  p->reads_shape = true; /* a body keeps them */
  return p;
}

static void build(kernel_plan *p, program_task task, const segment *wanted, bool along_reference) {
  program_motion motion = plan_motion(p, along_reference);
  program_build(&p->programs[task], "check", p->graph, p->memory, wanted, &motion, SHARE_NOTHING,
                &p->links);
}

/* Builds both programs; false where they have too many passes. */
static bool build_both(kernel_plan *p, const segment *step, const segment *observe,
                       bool along_reference) {
  build(p, PROGRAM_STEP, step, along_reference);
  build(p, PROGRAM_OBSERVE, observe, along_reference);
  plan_hoist(p);
  return p->programs[PROGRAM_STEP].pass_count <= PLAN_MOST_PASSES &&
         p->programs[PROGRAM_OBSERVE].pass_count <= PLAN_MOST_PASSES;
}

static bool plan_whole(family_bench *b, int *narrow, int *all) {
  const law *l = b->law;
  kernel_plan *p = b->plan[0] = begin(l);
  b->reads_time = law_reads_time(p->law);
  const int fields = l->fields.count;
  if (!lower_law(p->law, p->graph, LOWER_STEP, b->memory, &b->step, b->said)) return false;
  const lowered_text *t = &b->step.text;
  b->rule = watches(b, fields);
  b->conditions = conditions_new(t, p->graph, b->memory);
  b->guard = watches(b, b->conditions.count);
  b->overstress = watches(b, t->flow_count);
  segment step = {.root_count = 0};
  watching text = {.plan = p, .observed = 1 + l->outputs.count};
  for (int k = 0; k < fields; k++)
    plan_want(p, &step, b->step.fields[k], TO_FIELD, segment_kind_at(l->fields.items[k]->place), k);
  plan_forces(p, &b->step, &step);
  watch_all(b, &text, false);
  *narrow = text.observed - 1 - l->outputs.count;
  watch_all(b, &text, true);
  *all = text.observed - 1 - l->outputs.count;
  return build_both(p, &step, &text.wanted, b->step.along_reference);
}

static bool plan_frozen(family_bench *b) {
  kernel_plan *p = b->plan[1] = begin(b->law);
  lowered_law frozen;
  if (!lower_law(p->law, p->graph, LOWER_FROZEN, p->memory, &frozen, b->said)) return false;
  b->has_energy = frozen.W != IR_NONE && b->law->tree->law == LAW_STATE;
  segment step = {.root_count = 0}, energy = {.root_count = 0};
  plan_forces(p, &frozen, &step);
  plan_want(p, &energy, b->has_energy ? frozen.W : ir_constant(p->graph, 0), TO_OBSERVED,
            OVER_PARTICLES, 0);
  return build_both(p, &step, &energy, frozen.along_reference);
}

/* --- the body --------------------------------------------------------------------------------- */

static bool open_lattice(family_bench *b) {
  const deck_lattice usual = physics_usual_lattice(b->law);
  const deck_lattice *d = b->options->lattice ? b->options->lattice : &usual;
  const double density = b->law->rho ? b->parameters[b->law->rho->index] : 2000;
  b->lattice = implied_lattice_like(d, density);
  b->lattice_name = arena_text(b->memory, d->kind, strlen(d->kind));
  return b->lattice && b->lattice->dimensions == b->plan[0]->dimensions;
}

/* Takes away the bonds that lead out of the period. */
static void set_free(patch *p) {
  for (long q = 0; q < p->inside_count; q++)
    for (int k = 0; k < p->lattice->directions; k++) {
      const long site = p->inside[q], far = site + p->offset[k];
      if (p->image[far] != far) patch_cut(p, site, k);
    }
}

static patch *body_of(const family_bench *b, const pl_law *kernel, int narrow, int wide) {
  static const long plane[3] = {4, 4, 1}, space[3] = {2, 2, 2};
  const long *period = kernel->dimensions == 3 ? space : plane;
  patch *p = patch_new(kernel, b->parameters, b->lattice, period, narrow, wide);
  set_free(p);
  return p;
}

family_bench *family_bench_new(const law *l, const physics_options *o, diagnostics *d) {
  family_bench *b = must_calloc(1, sizeof *b);
  int narrow, all;
  b->law = l;
  b->options = o;
  b->said = d;
  b->memory = arena_new();
  b->seed = o->seed ? o->seed : 20260101;
  b->parameters = arena_alloc(b->memory, ((size_t)l->parameters.count + 1) * sizeof(double));
  physics_draw_parameters(l, NULL, b->parameters);
  if (o->parameters)
    memcpy(b->parameters, o->parameters, (size_t)l->parameters.count * sizeof(double));
  if (!plan_whole(b, &narrow, &all) || !plan_frozen(b) || !open_lattice(b)) {
    family_bench_free(b);
    return NULL;
  }
  for (int k = 0; k < 2; k++)
    b->kernel[k] = plan_interpreted(b->plan[k]);
  b->whole = body_of(b, b->kernel[0], narrow, all - narrow);
  b->frozen = body_of(b, b->kernel[1], 0, 0);
  b->values = b->whole->law->dof * b->whole->inside_count;
  return b;
}

void family_bench_free(family_bench *b) {
  patch_free(b->whole);
  patch_free(b->frozen);
  if (b->lattice) rows_free(b->lattice);
  for (int k = 0; k < 2; k++) {
    if (b->kernel[k]) plan_interpreted_free(b->kernel[k]);
    plan_free(b->plan[k]);
  }
  arena_free(b->memory);
  free(b);
}

void family_bench_draw(family_bench *b, bool defaults) {
  if (!b->options->parameters)
    physics_draw_parameters(b->law, defaults ? NULL : &b->seed, b->parameters);
  patch *both[] = {b->whole, b->frozen};
  for (int k = 0; k < 2; k++) {
    patch_prepare(both[k], b->parameters);
    patch_virgin(both[k]);
  }
}

/* --- motion ----------------------------------------------------------------------------------- */

void family_bench_deform(family_bench *b, double size, double *values) {
  const patch *p = b->whole;
  const int dimensions = p->law->dimensions;
  const double noise = draw_bits(&b->seed) % 2 ? draw_uniform(&b->seed, 0, 1) : 0;
  const uint64_t kind = draw_bits(&b->seed) % 4; /* a quarter swells, a quarter shrinks */
  const double swelling = kind == 0 ? 1 : kind == 1 ? -1 : 0;
  double gradient[3][3] = {{0}}, at[3];
  for (int r = 0; r < dimensions; r++)
    for (int c = 0; c < dimensions; c++)
      gradient[r][c] = size * (draw_uniform(&b->seed, -1, 1) + (r == c ? swelling : 0)) / 2;
  for (int d = 0; d < dimensions; d++)
    for (long q = 0; q < p->inside_count; q++) {
      patch_position(p, p->inside[q], at);
      double *u = &values[d * p->inside_count + q];
      *u = noise * size * p->lattice->spacing * draw_uniform(&b->seed, -1, 1);
      for (int c = 0; c < dimensions; c++)
        *u += gradient[d][c] * at[c];
    }
  for (long k = dimensions * p->inside_count; k < b->values; k++)
    values[k] = size * p->lattice->spacing * draw_uniform(&b->seed, -1, 1);
}

/* What a rotation of 1 is among the values. */
static double lever(const patch *p, int component) {
  return component < p->law->dimensions ? 1 : p->lattice->spacing;
}

static void put(patch *p, const double *values, double *const *into) {
  for (int d = 0; d < p->law->dof; d++)
    for (long q = 0; q < p->inside_count; q++)
      into[d][p->inside[q]] = values ? values[d * p->inside_count + q] / lever(p, d) : 0;
}

/* Without surroundings nothing reads the margins. */
void family_bench_move(family_bench *b, const double *u, const double *v) {
  patch *both[] = {b->whole, b->frozen};
  for (int k = 0; k < 2; k++) {
    put(both[k], u, both[k]->displacement);
    put(both[k], v, both[k]->velocity);
  }
}

static const double MOST_BONDS = 1e6; /* about 40 ms */

bool family_bench_tired(const family_bench *b) {
  const double effort = b->options->effort > 0 ? b->options->effort : 1;
  return b->bonds > effort * MOST_BONDS;
}

static void count_work(family_bench *b, const patch *of) {
  b->bonds += (double)(of->count * 2 * of->lattice->directions);
}

void family_bench_observe(family_bench *b) {
  patch_observe(b->whole);
  count_work(b, b->whole);
}

static void cross(const double a[3], const double b[3], double out[3]) {
  for (int k = 0; k < 3; k++)
    out[k] = a[(k + 1) % 3] * b[(k + 2) % 3] - a[(k + 2) % 3] * b[(k + 1) % 3];
}

/* A moment does its work on turns of the particle; the same on changes of the rotation vector r:
     m + (1 - cos r)/r^2 m x r + (r - sin r)/r^3 r x (r x m). */
static void on_rotation_vector(const double r[3], double m[3]) {
  double once[3], again[3];
  const double square = r[0] * r[0] + r[1] * r[1] + r[2] * r[2];
  const double angle = pl_fmax(sqrt(square), 1e-100), sine = pl_sin(angle / 2);
  const double first = 2 * (sine / angle) * (sine / angle);
  const double second = angle < 0.1 ? 1.0 / 6 - square / 120 + square * square / 5040
                                    : (1 - pl_sin(angle) / angle) / square;
  cross(r, m, once);
  cross(r, once, again);
  for (int k = 0; k < 3; k++)
    m[k] += second * again[k] - first * once[k];
}

static void turn_moments(const patch *p, long site, double f[PL_MAX_DOF]) {
  double r[3];
  for (int k = 0; k < 3; k++)
    r[k] = p->displacement[3 + k][site];
  on_rotation_vector(r, f + 3);
}

void family_bench_forces(family_bench *b, patch *of, double *force) {
  const int dof = of->law->dof;
  double f[PL_MAX_DOF];
  patch_step(of);
  b->evaluated += (double)of->inside_count;
  count_work(b, of);
  for (long q = 0; q < of->inside_count; q++) {
    for (int d = 0; d < dof; d++)
      f[d] = of->force[d][of->inside[q]];
    if (dof == 6) turn_moments(of, of->inside[q], f);
    for (int d = 0; d < dof; d++)
      force[d * of->inside_count + q] = f[d] / lever(of, d);
  }
}

void family_bench_share_fields(family_bench *b) {
  for (int f = 0; f < b->law->fields.count; f++) {
    const long count = patch_planes(b->whole, &b->whole->law->fields[f]) * b->whole->size;
    memcpy(b->frozen->field[f] - b->frozen->lead, b->whole->field[f] - b->whole->lead,
           (size_t)count * sizeof(double));
  }
}

void family_bench_accept(family_bench *b) {
  patch_accept(b->whole);
}

double family_bench_energy(family_bench *b) {
  double sum = 0;
  patch_observe(b->frozen);
  for (long q = 0; q < b->frozen->inside_count; q++)
    sum += b->frozen->observed[0][b->frozen->inside[q]];
  return sum;
}

double family_work(const double *force, const double *way, long count, double *size) {
  double sum = 0;
  for (long k = 0; k < count; k++) {
    sum -= force[k] * way[k]; /* against the bonds */
    *size += fabs(force[k] * way[k]);
  }
  return sum;
}

/* --- what is watched -------------------------------------------------------------------------- */

static int neighbours_of(const family_bench *b) {
  return 2 * b->lattice->directions;
}

int family_bench_places(const family_bench *b, watched w) {
  return w.at < 0 ? 0 : (int)b->whole->inside_count * (w.wide ? neighbours_of(b) : 1);
}

static long site_of(const family_bench *b, watched w, int where) {
  return b->whole->inside[w.wide ? where / neighbours_of(b) : where];
}

bool family_bench_exists(const family_bench *b, watched w, int where) {
  return !w.wide || patch_has_bond(b->whole, site_of(b, w, where), where % neighbours_of(b));
}

int family_bench_bonds(const family_bench *b, watched w, int where) {
  int count = 0;
  for (int k = 0; k < neighbours_of(b); k++)
    count += patch_has_bond(b->whole, site_of(b, w, where), k);
  return count;
}

double family_bench_value(const family_bench *b, watched w, int where) {
  const long plane = w.wide ? where % neighbours_of(b) : 0;
  return b->whole->observed[w.at][plane * b->whole->size + site_of(b, w, where)];
}

/* --- saying what was found -------------------------------------------------------------------- */

/* A way tells its times itself. */
static char *found_at(const family_bench *b, double size, bool on_a_way) {
  char *text;
  size_t length;
  bool others = false;
  FILE *out = must_open_text(&text, &length);
  fprintf(out, "%ld particles of a %s lattice, s = %.6g m", b->whole->inside_count, b->lattice_name,
          b->lattice->spacing);
  if (size > 0) fprintf(out, ", strained by %.3g", size);
  if (!on_a_way && law_reads(b->law, QUANTITY_DT)) fprintf(out, ", dt = %.4g s", b->whole->advance);
  for (int k = 0; k < b->law->parameters.count; k++) {
    const symbol *s = b->law->parameters.items[k];
    char si[64];
    dim_unit(s->dim, si, sizeof si);
    if (s->has_default && b->parameters[k] == s->initial) continue;
    fprintf(out, ", %s = %.6g%s%s", s->name, b->parameters[k], unit_is_pure(si) ? "" : " ",
            unit_is_pure(si) ? "" : si);
    others = others || s->has_default;
  }
  if (others && !b->options->parameters) fputs(PHYSICS_OTHER_VALUES, out);
  must_close_text(out);
  return text;
}

void family_bench_say(family_bench *b, diag_code code, span where, double size, const char *format,
                      ...) {
  va_list values;
  va_start(values, format);
  const bool first = diag_report_once(b->said, b->failed, code, where, format, values);
  va_end(values);
  if (!first) return;
  char *state = found_at(b, size, code == DIAG_DISSIPATION);
  diag_note(b->said, (span){0, 0, UINT16_MAX}, "found with %s", state);
  free(state);
}

span family_bench_force(const family_bench *b) {
  const law *l = b->law;
  const stmt *given = law_force_state(l);
  if (given) return given->where;
  if (l->results[RESULT_T]) return l->results[RESULT_T]->rule->where;
  return l->results[RESULT_W] ? l->results[RESULT_W]->rule->where : l->tree->name_where;
}

double *family_bench_values(const family_bench *b) {
  return must_calloc((size_t)b->values + 1, sizeof(double));
}
