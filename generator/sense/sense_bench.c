#include "generator/sense/sense_bench.h"

#include <math.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>

#include "dsl/base/arena.h"
#include "generator/check/physics_parameters.h"
#include "generator/interpreter/interpreted.h"
#include "runtime/analysis/implied.h"
#include "runtime/deck/bravais.h"
#include "runtime/deck/lattice_kind.h"

static bool has_lattice(law_kind kind) {
  return kind == LAW_CENTRAL_BOND || kind == LAW_MICROPOLAR_BOND || kind == LAW_STATE;
}

/* As a deck plans it: strips on the hexagon, families elsewhere. */
static bool plan_on_lattice(sense_bench *b, const deck_lattice *like) {
  diagnostics unsaid;
  diag_begin(&unsaid, b->said->sources);
  const bool strips = b->law->tree->law != LAW_STATE && b->hexagon;
  b->plan = strips ? plan_kernel(b->law, &unsaid)
                   : plan_kernel_of_families(b->law, &(law_variation){.varying_count = 0}, &unsaid);
  diag_clear(&unsaid);
  if (!b->plan) return false;
  b->kernel = plan_interpreted(b->plan);
  const double density = b->law->rho ? b->parameters[b->law->rho->index] : 2000;
  b->lattice = implied_lattice_like(like, density);
  return b->lattice && b->lattice->dimensions == b->plan->dimensions;
}

bool sense_bench_open(sense_bench *b, const law *l, const physics_options *o, diagnostics *d) {
  *b = (sense_bench){.law = l, .options = o, .said = d};
  b->parameters = must_calloc((size_t)l->parameters.count + 1, sizeof(double));
  physics_draw_parameters(l, NULL, b->parameters);
  if (o->parameters)
    memcpy(b->parameters, o->parameters, (size_t)l->parameters.count * sizeof(double));
  if (!has_lattice(l->tree->law)) return true;
  const deck_lattice usual = physics_usual_lattice(l);
  const deck_lattice *like = o->lattice ? o->lattice : &usual;
  b->lattice_name = like->kind;
  b->hexagon = bravais_is_hexagon(like);
  return plan_on_lattice(b, like);
}

void sense_bench_close(sense_bench *b) {
  if (b->lattice) rows_free(b->lattice);
  if (b->kernel) plan_interpreted_free(b->kernel);
  plan_free(b->plan);
  free(b->parameters);
}

const symbol *sense_parameter(const law *l, const char *name, const char *measured_in) {
  for (int k = 0; k < l->parameters.count; k++) {
    const symbol *s = l->parameters.items[k];
    if (strcmp(s->name, name) == 0 && dim_equal(s->dim, dimension_of(measured_in))) return s;
  }
  return NULL;
}

double sense_value(const sense_bench *b, const symbol *parameter) {
  return parameter ? b->parameters[parameter->index] : NAN;
}

span sense_force(const law *l) {
  static const law_result given[] = {RESULT_SIGMA, RESULT_N, RESULT_W};
  const stmt *state = law_force_state(l);
  if (state) return state->where;
  for (size_t k = 0; k < sizeof given / sizeof *given; k++)
    if (l->results[given[k]]) return l->results[given[k]]->rule->where;
  return l->tree->name_where;
}

void sense_say(sense_bench *b, diag_code code, span where, const char *mend, const char *format,
               ...) {
  va_list values;
  va_start(values, format);
  const bool first = diag_report_once(b->said, b->said_of, code, where, format, values);
  va_end(values);
  if (first && mend) diag_hint(b->said, "%s", mend);
}
