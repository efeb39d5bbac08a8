#include "runtime/ledger.h"

const char *const ledger_names[LEDGER_COUNT] = {
#define X(code, name) name,
    LEDGER_TERMS(X)
#undef X
};

void ledger_sample(ledger *g, const sweep *state, const loads *l, long step,
                   double terms[LEDGER_COUNT]) {
  const sweep_totals t = sweep_sum(state);
  const load_sums s = loads_total(l);
  double kinetic, work;
  loads_observe(l, state, step, &kinetic, &work);
  terms[LEDGER_KINETIC] = t.kinetic + kinetic;
  terms[LEDGER_STORED] = t.stored;
  terms[LEDGER_DISSIPATED_DAMPING] =
      t.dissipated_rate + t.dissipated_mass + t.dissipated_pending + s.dissipated;
  terms[LEDGER_EXTERNAL] = s.work + work + t.gravity;
  const double held = terms[LEDGER_KINETIC] + terms[LEDGER_STORED];
  const double lost = t.internal + s.internal - t.stored;
  if (!g->begun)
    *g = (ledger){
        .begun = 1, .initial = held, .lost = lost, .pending = terms[LEDGER_DISSIPATED_DAMPING]};
  terms[LEDGER_DISSIPATED_DAMPING] -= g->pending;
  terms[LEDGER_DISSIPATED_DAMAGE] =
      state->law->kind == PL_STATE ? lost - g->lost : t.dissipated_state;
  terms[LEDGER_IMBALANCE] = terms[LEDGER_EXTERNAL] - (held - g->initial) -
                            terms[LEDGER_DISSIPATED_DAMAGE] - terms[LEDGER_DISSIPATED_DAMPING];
}
