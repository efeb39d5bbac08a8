#include "runtime/simulation/ledger.h"

#include <math.h>

#include "dsl/base/elementary.h"

const char *const ledger_names[LEDGER_COUNT] = {
#define X(code, name, words) name,
    LEDGER_TERMS(X)
#undef X
};
const char *const ledger_words[LEDGER_COUNT] = {
#define X(code, name, words) words,
    LEDGER_TERMS(X)
#undef X
};

const char *ledger_unchecked(const pl_law *law) {
  const bool loses = law->kind == PL_STATE && (law->field_count > 0 || law->reads_rates);
  if (!law->stores) return "the law has no stored energy";
  return loses && !sweep_books_losses(law) ? "the law does not say what it takes" : NULL;
}

/* What the law has taken by states and damage. */
static double taken(const ledger *g, const pl_law *law, const body_totals *t, double lost) {
  if (sweep_books_losses(law)) return t->dissipated_state;
  return ledger_unchecked(law) ? lost - g->lost : 0;
}

static bool is_sound(const ledger *g, const sweep *state, const body_totals *t, double omega) {
  const pl_law *law = state->law;
  const double phase = state->body->time_step * omega, part = pl_fmin(0.5 * phase * phase, 1);
  if (!law->stores || (law->kind == PL_STATE && law->reads_rates)) return true;
  return !(t->free + part * t->stored <
           -1e-6 * g->largest); /* numbers that are none are found by the next step */
}

bool ledger_sample(ledger *g, const sweep *state, const loads *l, const load_look *look,
                   double omega, double terms[LEDGER_COUNT]) {
  const body_totals t = body_sum(state->body);
  const load_sums s = load_steps_total(l);
  const double damping = t.dissipated_rate + t.dissipated + s.dissipated + look->dissipated;
  const double kinetic = t.kinetic + look->kinetic, held = kinetic + t.stored;
  const double lost = t.internal + s.internal - t.stored;
  if (!g->begun) *g = (ledger){.begun = 1, .initial = held, .lost = lost, .pending = damping};
  terms[LEDGER_KINETIC] = kinetic;
  terms[LEDGER_STORED] = t.stored;
  terms[LEDGER_EXTERNAL] = s.work + look->work + t.gravity;
  terms[LEDGER_DISSIPATED_DAMPING] = damping - g->pending;
  terms[LEDGER_DISSIPATED_DAMAGE] = taken(g, state->law, &t, lost);
  terms[LEDGER_IMBALANCE] = ledger_unchecked(state->law)
                                ? NAN
                                : terms[LEDGER_EXTERNAL] - (held - g->initial) -
                                      terms[LEDGER_DISSIPATED_DAMAGE] -
                                      terms[LEDGER_DISSIPATED_DAMPING];
  g->largest = pl_fmax(pl_fmax(g->largest, fabs(kinetic)),
                       pl_fmax(fabs(t.stored), fabs(terms[LEDGER_EXTERNAL])));
  return is_sound(g, state, &t, omega);
}
