#include "generator/check/physics_report.h"

#include <math.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>

#include "dsl/base/arena.h"
#include "dsl/semantics/law_reads.h"
#include "generator/check/physics_parameters.h"
#include "generator/lower/law_inputs.h"

const char *const physics_force_names[FORCE_COUNT] = {"N", "M_i", "M_j"};
const char *const physics_force_units[FORCE_COUNT] = {"N", "N*m", "N*m"};

/* --- the state as text ------------------------------------------------------------------------ */

/* Inputs that the forces or fields need. */
static unsigned char *inputs_read(const bench *b, ir_source from, int count) {
  int nodes = ir_count(b->graph), fields = b->field_count;
  unsigned char *marks = must_calloc((size_t)nodes + 1, 1),
                *read = must_calloc((size_t)count + 1, 1);
  ir_node results[FORCE_COUNT] = {b->law_step.N, b->law_step.M_i[0], b->law_step.M_j[0]};
  ir_mark(b->graph, results, FORCE_COUNT, marks);
  ir_mark(b->graph, b->law_step.fields, fields, marks);
  for (ir_node n = 0; n < nodes; n++)
    if (marks[n] && ir_operation(b->graph, n) == IR_INPUT && ir_input_source(b->graph, n) == from &&
        ir_input_index(b->graph, n) < count)
      read[ir_input_index(b->graph, n)] = 1;
  free(marks);
  return read;
}

static void add_value(FILE *out, const char **separator, const char *name, double value,
                      const char *measured_in) {
  bool pure = unit_is_pure(measured_in);
  fprintf(out, "%s%s = %.6g%s%s", *separator, name, value, pure ? "" : " ",
          pure ? "" : measured_in);
  *separator = ", ";
}

static void add_motion(const bench *b, const double *column, FILE *out, const char **separator) {
  unsigned char *read = inputs_read(b, IR_FROM_QUANTITY, QUANTITY_COUNT);
  for (int k = 0; k < AXIS_COUNT; k++)
    if (read[law_motion[k]] || (k == 0 && read[QUANTITY_LENGTH]))
      add_value(out, separator, builtin_quantities[law_motion[k]].name,
                column[b->parameter_count + (int)law_motion[k]],
                builtin_quantities[law_motion[k]].unit);
  const double dt = column[b->parameter_count + (int)QUANTITY_DT];
  if (read[QUANTITY_DT] && (dt > 0 || law_reads(b->law, QUANTITY_DT)))
    add_value(out, separator, builtin_quantities[QUANTITY_DT].name, dt,
              builtin_quantities[QUANTITY_DT].unit);
  for (int k = 0; k < b->field_count; k++) {
    char si[64];
    dim_unit(b->law->fields.items[k]->dim, si, sizeof si);
    add_value(out, separator, b->law->fields.items[k]->name,
              column[b->parameter_count + QUANTITY_COUNT + k], si);
  }
  free(read);
}

/* Those that are not the defaults; what is 0 by default may be the cause. */
static void add_parameters(const bench *b, const double *column, FILE *out,
                           const char **separator) {
  unsigned char *read = inputs_read(b, IR_FROM_PARAMETER, b->parameter_count);
  for (int k = 0; k < b->parameter_count; k++) {
    const symbol *s = b->law->parameters.items[k];
    char si[64];
    dim_unit(s->dim, si, sizeof si);
    if (read[k] && !(s->has_default && column[k] == s->initial && s->initial != 0))
      add_value(out, separator, s->name, column[k], si);
  }
  free(read);
  read = inputs_read(b, IR_FROM_QUANTITY, QUANTITY_COUNT);
  if (read[QUANTITY_S] || read[QUANTITY_SPACING])
    add_value(out, separator, "s", column[b->parameter_count + (int)QUANTITY_S], "m");
  free(read);
}

bool physics_reads_rate(const physics *p) {
  unsigned char *read = inputs_read(&p->b, IR_FROM_QUANTITY, QUANTITY_COUNT);
  bool rate = read[QUANTITY_STRETCH_RATE];
  free(read);
  return rate;
}

char *physics_state_text(const physics *p, const double *column) {
  char *text;
  size_t length;
  FILE *out = must_open_text(&text, &length);
  const char *separator = "";
  add_motion(&p->b, column, out, &separator);
  separator = *separator ? "; with " : "";
  add_parameters(&p->b, column, out, &separator);
  must_close_text(out);
  return text;
}

/* --- diagnostics ------------------------------------------------------------------------------ */

/* Than the defaults. */
static bool with_other_values(const physics *p, const double *column) {
  const bench *b = &p->b;
  unsigned char *read = inputs_read(b, IR_FROM_PARAMETER, b->parameter_count);
  bool others = false;
  for (int k = 0; k < b->parameter_count; k++) {
    const symbol *s = b->law->parameters.items[k];
    others = others || (read[k] && s->has_default && column[k] != s->initial);
  }
  free(read);
  return others && !b->options->parameters;
}

void physics_say(physics *p, diag_code code, span where, const double *column, const char *format,
                 ...) {
  va_list values;
  va_start(values, format);
  const bool first = diag_report_once(p->said, p->failed, code, where, format, values);
  va_end(values);
  if (!first || !column) return;
  char *state = physics_state_text(p, column);
  if (*state)
    diag_note(p->said, (span){0, 0, UINT16_MAX}, "found at %s%s", state,
              with_other_values(p, column) ? PHYSICS_OTHER_VALUES : "");
  free(state);
}

/* Line of `cases` in force for the state in lane 0 of the guards, which must just have been run. */
static const case_line *line_in_force(const bench *b, const expr *cases) {
  const lowered_text *t = &b->law_step.text;
  for (int k = 0; k < t->line_count; k++)
    if (t->lines[k].cases == cases && b->guards.out[k][0] != 0)
      return &cases->cases[t->lines[k].line];
  return &cases->cases[cases->case_count - 1];
}

span physics_fault(physics *p, int force, const double *column) {
  static const law_result direct[FORCE_COUNT] = {RESULT_N, RESULT_M_I, RESULT_M_J};
  const law *l = p->b.law;
  const symbol *s = l->results[direct[force]];
  if (!s && force != FORCE_N) s = l->results[RESULT_V];
  if (!s) s = l->results[RESULT_W];
  const stmt *rule = s ? s->rule : NULL;
  if (!rule) return l->tree->name_where;
  if (!column || !rule->value || rule->value->kind != EXPR_CASES) return rule->where;
  double **states = bench_states(&p->b);
  bench_put(&p->b, states, 0, column);
  probe_run(&p->b, &p->b.guards, states, 1);
  bench_states_free(&p->b, states);
  return line_in_force(&p->b, rule->value)->where;
}
