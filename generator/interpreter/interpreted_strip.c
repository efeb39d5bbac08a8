#include "generator/interpreter/interpreted_strip.h"

#include <string.h>

#include "generator/lower/law_inputs.h"
#include "generator/lower/point_inputs.h"

enum { LANES = RUNNER_LANES };

static int lanes_left(long count, long first) {
  return count - first < LANES ? (int)(count - first) : LANES;
}

static void evaluate(runner *r, program_task task, int count) {
  interpreter *run = r->run[task][0][0];
  if (run) interpreter_run(run, &r->in, count, r->result);
}

/* The same without copies: value k is interpreter_root(..., k). */
static const interpreter *evaluate_there(runner *r, program_task task, int count) {
  interpreter *run = r->run[task][0][0];
  if (run) interpreter_run(run, &r->in, count, NULL);
  return run;
}

/* --- strips ----------------------------------------------------------------------------------- */

static const double *motion_of(const pl_strip *s, const ends_origin *o) {
  switch (o->array) {
  case FROM_DISPLACEMENT:
    return o->owner == OF_I ? s->displacement_i[o->component] : s->displacement_j[o->component];
  case FROM_VELOCITY:
    return o->owner == OF_I ? s->velocity_i[o->component] : s->velocity_j[o->component];
  default:
    return NULL;
  }
}

/* Arrays that strips, or a law without rotations, do not have stay NULL: no root needs them. */
static void point_at_bonds(runner *r, const pl_strip *s, long first, int count) {
  const double **ends = r->at[IR_FROM_ENDS];
  for (int k = 0; k < ENDS_COUNT; k++) {
    const double *array = motion_of(s, &ends_origins[k]);
    ends[k] = array ? array + first : NULL;
  }
  for (int lane = 0; lane < count; lane++)
    r->protection[0][lane] = s->flags[first + lane] & PL_PROTECTED(s->direction) ? 1 : 0;
  ends[ENDS_PROTECTED] = r->protection[0];
  ends[ENDS_TIME_STEP] = &s->time_step;
  ends[ENDS_ADVANCE] = &s->advance;
  for (int k = 0; k < r->plan->law->fields.count; k++)
    r->at[IR_FROM_FIELD][k] = s->field[k] + first;
  for (int k = 0; k < r->plan->variation.varying_count; k++)
    r->at[IR_FROM_BOND_PARAMETER][k] = s->parameter[k] + first;
}

/* Where the values of a root go; *absent: those of bonds that do not exist become 0, else they are
   left. */
static double *target_of(const segment_root *r, const pl_strip *s, bool *absent) {
  *absent = r->target != TO_FIELD;
  switch (r->target) {
  case TO_FORCE:
    return s->force[r->index];
  case TO_FIELD:
    return s->field[r->index];
  case TO_DISSIPATED_STATE:
    return s->dissipated_state;
  case TO_DISSIPATED_RATE:
    return s->dissipated_rate;
  case TO_GIVEN_BY_REST:
    return s->given_by_rest;
  default:
    return s->observed[r->index];
  }
}

static void store(const segment_root *r, const pl_strip *s, long first, int count,
                  const double *restrict from) {
  bool absent;
  const int64_t *flags = s->flags + first;
  const int64_t present = PL_PRESENT(s->direction);
  double *restrict to = target_of(r, s, &absent) + first;
  if (segment_is_loss(r))
    for (int k = 0; k < count; k++)
      to[k] += flags[k] & present ? from[k] : 0;
  else if (absent)
    for (int k = 0; k < count; k++)
      to[k] = flags[k] & present ? from[k] : 0;
  else
    for (int k = 0; k < count; k++)
      if (flags[k] & present) to[k] = from[k];
}

void interpreted_strip(runner *r, program_task task, const double *uniforms, const pl_strip *s) {
  const segment *a = plan_segment(r->plan, task);
  runner_take_uniforms(r, uniforms);
  for (long first = 0; first < s->count; first += LANES) {
    const int count = lanes_left(s->count, first);
    point_at_bonds(r, s, first, count);
    const interpreter *run = evaluate_there(r, task, count);
    for (int k = 0; k < a->root_count; k++)
      store(&a->roots[k], s, first, count, interpreter_root(run, k));
  }
}

/* --- single states ---------------------------------------------------------------------------- */

void interpreted_states(runner *r, program_task task, const double *uniforms, const pl_states *s) {
  const int results = task == PROGRAM_TANGENT ? PL_TANGENTS : PL_STATE_RESULTS;
  const segment *a = plan_segment(r->plan, task);
  runner_take_uniforms(r, uniforms);
  for (long first = 0; first < s->count; first += LANES) {
    const int now = lanes_left(s->count, first);
    for (int k = 0; k < PL_STATE_INPUTS; k++)
      r->at[IR_FROM_QUANTITY][law_motion[k]] = s->in[k] + first;
    for (int k = 0; k < r->plan->law->fields.count; k++)
      r->at[IR_FROM_FIELD][k] = s->field[k] + first;
    evaluate(r, task, now);
    for (int k = 0; k < a->root_count; k++) {
      const int index = a->roots[k].index;
      double *to = index < results ? s->out[index] : s->new_field[index - results];
      memcpy(to + first, r->result[k], (size_t)now * sizeof(double));
    }
  }
}

/* --- points of a continuum -------------------------------------------------------------------- */

static void point_at_points(runner *r, const pl_points *s, long first) {
  const int dimensions = r->plan->dimensions;
  const double **at = r->at[IR_FROM_POINT];
  for (int k = 0; k < PL_STRAINS(dimensions); k++) {
    const int component = point_component(dimensions, k);
    at[POINT_STRAIN + component] = s->strain[k] + first;
    at[POINT_STRAIN_RATE + component] = s->strain_rate ? s->strain_rate[k] + first : NULL;
  }
  at[POINT_CELL_SIZE] = s->cell_size ? s->cell_size + first : NULL;
  r->at[IR_FROM_ENDS][ENDS_TIME_STEP] = &s->time_step;
  r->at[IR_FROM_ENDS][ENDS_ADVANCE] = &s->advance;
  for (int k = 0; k < r->plan->law->fields.count; k++)
    r->at[IR_FROM_FIELD][k] = s->old_field[k] + first;
  for (int k = 0; k < r->plan->variation.varying_count; k++)
    r->at[IR_FROM_BOND_PARAMETER][k] = s->parameter[k] + first;
}

static double *array_of_root(const segment_root *root, const pl_points *s) {
  switch (root->target) {
  case TO_FORCE:
    return s->stress[root->index];
  case TO_FIELD:
    return s->new_field[root->index];
  case TO_TANGENT:
    return s->tangent[root->index];
  case TO_OBSERVED:
    return s->observed[root->index];
  default:
    return s->lost[root->index];
  }
}

void interpreted_points(runner *r, program_task task, const double *uniforms, const pl_points *s) {
  const segment *a = plan_segment(r->plan, task);
  runner_take_uniforms(r, uniforms);
  for (long first = 0; first < s->count; first += LANES) {
    const int now = lanes_left(s->count, first);
    point_at_points(r, s, first);
    evaluate(r, task, now);
    for (int k = 0; k < a->root_count; k++) {
      double *to = array_of_root(&a->roots[k], s) + first;
      for (int lane = 0; lane < now; lane++)
        to[lane] =
            segment_is_loss(&a->roots[k]) ? to[lane] + r->result[k][lane] : r->result[k][lane];
    }
  }
}

void interpreted_tips(runner *r, program_task task, const double *uniforms, const pl_tips *s) {
  const segment *a = plan_segment(r->plan, task);
  runner_take_uniforms(r, uniforms);
  for (long first = 0; first < s->count; first += LANES) {
    const int now = lanes_left(s->count, first);
    for (int k = 0; k < TIP_INPUTS; k++)
      r->at[IR_FROM_TIP][k] = s->in[k] + first;
    for (int k = 0; k < r->plan->law->fields.count; k++)
      r->at[IR_FROM_FIELD][k] = s->old_field[k] + first;
    evaluate(r, task, now);
    for (int k = 0; k < a->root_count; k++) {
      const segment_root *root = &a->roots[k];
      double *to = root->target == TO_OUT     ? s->out[root->index]
                   : root->target == TO_FIELD ? s->new_field[root->index]
                                              : s->observed[root->index];
      memcpy(to + first, r->result[k], (size_t)now * sizeof(double));
    }
  }
}

/* --- values of a bond class, bounds ----------------------------------------------------------- */

void interpreted_prepare(runner *r, const double *parameters, const pl_bond_class *bonds,
                         double *uniforms) {
  if (!r->prepare) return;
  law_class_values(bonds, r->of_class);
  for (int k = 0; k < LAW_CHORD; k++)
    r->at[IR_FROM_ENDS][law_chord[k]] = &bonds->chord[k];
  runner_take_parameters(r, parameters);
  interpreter_run(r->prepare, &r->in, 1, r->result);
  for (int k = 0; k < r->plan->uniform_count; k++)
    uniforms[k] = r->result[k][0];
}

void interpreted_bounds(runner *r, program_task task, const double *parameters, double *lower,
                        double *upper) {
  const segment *a = plan_segment(r->plan, task);
  runner_take_parameters(r, parameters);
  evaluate(r, task, 1);
  for (int k = 0; k < a->root_count; k++)
    (a->roots[k].target == TO_LOWER ? lower
                                    : upper)[task == PROGRAM_BOUNDS ? a->roots[k].index : 0] =
        r->result[k][0];
}

void interpreted_defaults(runner *r, const double *parameters, double *values) {
  const segment *a = plan_segment(r->plan, PROGRAM_DEFAULTS);
  runner_take_parameters(r, parameters);
  evaluate(r, PROGRAM_DEFAULTS, 1);
  for (int k = 0; k < a->root_count; k++)
    values[a->roots[k].index] = r->result[k][0];
}
