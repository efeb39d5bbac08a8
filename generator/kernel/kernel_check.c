#include "generator/kernel/kernel_check.h"

#include <math.h>
#include <stdlib.h>

#include "dsl/base/arena.h"
#include "dsl/base/elementary.h"
#include "generator/interpreter/guard_watch.h"
#include "generator/interpreter/interpreted.h"
#include "generator/ir/random_values.h"
#include "generator/kernel/document.h"
#include "generator/kernel/kernel_check_families.h"
#include "generator/kernel/kernel_check_points.h"
#include "generator/kernel/kernel_check_strips.h"

enum { BATCH = 1024, STATES_PER_BOND = 4 };

/* --- states and tangents ---------------------------------------------------------------------- */

typedef struct state_arrays {
  int fields;
  double **in, **field;                          /* [PL_STATE_INPUTS], [fields][BATCH] */
  double **out[2], **new_field[2], **tangent[2]; /* of either reader */
} state_arrays;

static state_arrays arrays_new(const pl_law *kernel) {
  state_arrays a = {.fields = kernel->field_count};
  a.in = planes_new(PL_STATE_INPUTS, BATCH);
  a.field = planes_new(a.fields, BATCH);
  for (int side = 0; side < 2; side++) {
    a.out[side] = planes_new(PL_STATE_RESULTS, BATCH);
    a.new_field[side] = planes_new(a.fields, BATCH);
    a.tangent[side] = planes_new(PL_TANGENTS, BATCH);
  }
  return a;
}

static void arrays_free(state_arrays *a) {
  planes_free(a->in, PL_STATE_INPUTS);
  planes_free(a->field, a->fields);
  for (int side = 0; side < 2; side++) {
    planes_free(a->out[side], PL_STATE_RESULTS);
    planes_free(a->new_field[side], a->fields);
    planes_free(a->tangent[side], PL_TANGENTS);
  }
}

static void draw_states(const law_readers *l, const state_arrays *a, uint64_t *seed, int count) {
  double **in = a->in;
  const pl_law *kernel = l->law[0];
  for (int q = 0; q < count; q++) {
    in[0][q] = pl_fmax(draw_size(seed, -9, 0), -0.9);
    in[1][q] = draw_size(seed, -3, 6);
    in[2][q] = draw_size(seed, -9, 0.5);
    in[3][q] = draw_size(seed, -9, 0.5);
    in[4][q] = l->bonds->s * (1 + in[0][q]);
    in[5][q] = fabs(draw_size(seed, -9, 9));
    for (int f = 0; f < kernel->field_count; f++)
      a->field[f][q] = draw_field(seed, &kernel->fields[f]);
  }
}

static void compare_states(const law_readers *l, const state_arrays *a, int count, comparison *c) {
  static const char *const names[PL_STATE_RESULTS] = {"N", "M_i", "M_j"};
  for (int side = 0; side < 2; side++) {
    const pl_law *reader = l->law[side];
    pl_states s = {.size = sizeof s,
                   .count = count,
                   .in = (const double *const *)a->in,
                   .field = (const double *const *)a->field,
                   .out = a->out[side],
                   .new_field = a->new_field[side]};
    planes_poison(a->out[side], PL_STATE_RESULTS, count);
    planes_poison(a->new_field[side], a->fields, count);
    planes_poison(a->tangent[side], PL_TANGENTS, count);
    reader->states(reader, l->uniforms[side], &s);
    s.out = a->tangent[side];
    reader->tangent(reader, l->uniforms[side], &s);
  }
  for (int k = 0; k < PL_STATE_RESULTS; k++)
    comparison_add(c, "states", names[k], -1, a->out[0][k], a->out[1][k], count);
  for (int f = 0; f < a->fields; f++)
    comparison_add(c, "states", l->law[0]->fields[f].name, -1, a->new_field[0][f],
                   a->new_field[1][f], count);
  for (int k = 0; k < PL_TANGENTS; k++)
    comparison_add(c, "tangent", "derivative", k, a->tangent[0][k], a->tangent[1][k], count);
}

static void check_states(const law_readers *l, law_inputs *inputs, long wanted, uint64_t *seed,
                         guard_watch *guards, comparison *c) {
  state_arrays a = arrays_new(l->law[0]);
  for (long done = 0; done < wanted; done += BATCH) {
    int count = wanted - done < BATCH ? (int)(wanted - done) : BATCH;
    draw_states(l, &a, seed, count);
    compare_states(l, &a, count, c);
    interpreter_inputs in =
        law_inputs_at(inputs, (const double *const *)a.in, (const double *const *)a.field);
    guard_watch_see(guards, &in, count);
  }
  arrays_free(&a);
}

/* --- prepare and bounds ----------------------------------------------------------------------- */

static void check_prepare(const law_readers *l, const double *parameters, comparison *c) {
  const long count = l->law[0]->uniform_count;
  planes_poison(l->uniforms, 2, l->classes * count);
  for (int side = 0; side < 2; side++)
    for (int k = 0; k < l->classes; k++)
      l->law[side]->prepare(l->law[side], parameters, &l->bonds[k], l->uniforms[side] + k * count);
  comparison_add(c, "prepare", "uniforms", -1, l->uniforms[0], l->uniforms[1], l->classes * count);
}

static void check_bounds(const law_readers *l, const double *parameters, comparison *c) {
  enum { LOWER, UPPER, LOW_OPEN, HIGH_OPEN, COLUMNS };
  static const char *const names[COLUMNS] = {"lower", "upper", "low_open", "high_open"};
  const int count = l->law[0]->parameter_count;
  double **b[2];
  unsigned char *open = must_calloc(2 * (size_t)count + 1, 1);
  for (int side = 0; side < 2; side++) {
    b[side] = planes_new(COLUMNS, count);
    planes_poison(b[side], 2, count);
    l->law[side]->bounds(l->law[side], parameters, b[side][LOWER], b[side][UPPER], open,
                         open + count);
    for (int k = 0; k < count; k++) {
      b[side][LOW_OPEN][k] = open[k];
      b[side][HIGH_OPEN][k] = open[count + k];
    }
  }
  for (int k = 0; k < COLUMNS; k++)
    comparison_add(c, "bounds", names[k], -1, b[0][k], b[1][k], count);
  planes_free(b[0], COLUMNS);
  planes_free(b[1], COLUMNS);
  free(open);
}

/* --- all of it -------------------------------------------------------------------------------- */

static void check_bonds(kernel_check *c, const law *of, const law_readers *l, long states,
                        guard_watch *guards, uint64_t *seed) {
  law_inputs inputs;
  law_inputs_open(&inputs, of, l->parameters, l->bonds);
  check_states(l, &inputs, states, seed, guards, &c->outputs);
  law_inputs_close(&inputs);
  c->states += states;
  c->bonds += kernel_check_strips(l, states / STATES_PER_BOND, seed, &c->outputs);
}

static void check_families(kernel_check *c, const law_readers *l, long states, uint64_t *seed) {
  const pl_law *of = l->law[0];
  c->passes =
      kernel_check_step(of)->pass_count + of->observe.pass_count + of->force_state.pass_count;
  c->bonds += kernel_check_families(l, states / STATES_PER_BOND, seed, &c->outputs);
}

kernel_check kernel_check_run(const kernel_plan *p, const pl_law *kernel,
                              const double *const *parameters, int sets, const pl_bond_class *bonds,
                              int classes, long states, uint64_t seed) {
  kernel_check c = {.states = 0};
  pl_law *interpreted = plan_interpreted(p);
  double **uniforms = planes_new(2, (long)classes * kernel->uniform_count);
  law_readers l = {.law = {kernel, interpreted},
                   .uniforms = {uniforms[0], uniforms[1]},
                   .bonds = bonds,
                   .classes = classes};
  guard_watch *guards = guard_watch_new(p, BATCH);
  for (int k = 0; k < sets; k++) {
    l.parameters = parameters[k];
    check_prepare(&l, parameters[k], &c.outputs);
    check_bounds(&l, parameters[k], &c.outputs);
    if (kernel->kind == PL_CONTINUUM || kernel->kind == PL_CRACK) {
      const double *const each[2] = {uniforms[0], uniforms[1]};
      kernel_check_points(l.law, each, parameters[k], states / sets, &seed, &c.outputs);
      c.points += states / sets;
    } else if (kernel->kind == PL_STATE)
      check_families(&c, &l, states / sets, &seed);
    else
      check_bonds(&c, p->law, &l, states / sets, guards, &seed);
  }
  c.guards = guard_watch_count(guards);
  c.guards_both = guard_watch_both(guards);
  guard_watch_free(guards);
  planes_free(uniforms, 2);
  plan_interpreted_free(interpreted);
  return c;
}

bool kernel_check_agrees(const kernel_check *c) {
  return c->outputs.largest_ulps == 0 && c->outputs.unwritten == 0 && c->outputs.misplaced == 0;
}

static void report_fault(const kernel_check *c, const char *name) {
  const comparison *o = &c->outputs;
  char *text;
  size_t length;
  FILE *out = must_open_text(&text, &length);
  if (o->largest_ulps > 0)
    fprintf(out, " it differs from the interpreter by up to %.3g ulp (%s: %.17g, not %.17g);",
            o->largest_ulps, o->worst, o->kernel, o->interpreter);
  if (o->unwritten) fprintf(out, " %ld outputs were not written;", o->unwritten);
  if (o->misplaced)
    fprintf(out, " %ld values of absent or protected bonds were changed;", o->misplaced);
  must_close_text(out);
  say_error(
      "the compiled kernel of %s is wrong:%s run with --interpret, or take another C compiler "
      "(PERILAT_CC)",
      name, text);
  free(text);
}

void kernel_check_report(const kernel_check *c, const char *name) {
  if (!kernel_check_agrees(c)) {
    report_fault(c, name);
    return;
  }
  printf("kernel check: %s and its interpreter give the same bits (", name);
  if (c->points)
    printf("%ld random points or tips", c->points);
  else if (c->passes)
    printf("%ld random bonds of families in each of %d passes", c->bonds, c->passes);
  else
    printf("%ld random states, %ld random bonds in each of 6 strip functions", c->states, c->bonds);
  printf(", %ld values)", c->outputs.values);
  if (c->guards)
    printf("; %d of %d conditions were seen both true and false", c->guards_both, c->guards);
  puts("");
}
