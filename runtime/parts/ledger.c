#include "runtime/parts/ledger.h"

#include <math.h>
#include <string.h>

#include "dsl/base/elementary.h"
#include "runtime/continuum/cells_engine.h"
#include "runtime/interaction/family.h"

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

const char *ledger_unchecked(const pl_law *law, bool kept) {
  if (!law->stores) return "the law does not say all that its bonds store";
  if (sweep_knows_losses(law, kept)) return NULL;
  return sweep_knows_losses(law, true)
             ? "what a law of families loses is kept with `losses = .true.` in &output alone"
             : "the law does not say what it takes";
}

const char *ledger_why(const ledger_laws *of) {
  return of->unchecked;
}

void ledger_add_law(ledger_laws *of, const pl_law *law, bool kept) {
  if (!of->unchecked) of->unchecked = ledger_unchecked(law, kept);
  of->families = of->families || law->kind == PL_STATE;
  of->silent = of->silent || !law->stores;
  of->reads_rates = of->reads_rates || law->reads_rates;
}

/* What the laws have taken by states and damage; where some of families do not say it, all that is
   missing. */
static double taken(const ledger *g, const ledger_laws *of, const body_totals *t, double lost) {
  return of->unchecked && of->families ? lost - g->lost : t->dissipated_state;
}

/* J: of all particles on ways that strain their bonds by what rounding leaves. */
static double rounding_of(const body *state, double omega) {
  const double strain = 1e-14, speed = strain * omega * state->lattice->spacing;
  double mass = 0;
  for (long p = 0; p < state->lattice->particle_count; p++)
    mass += body_mass(state, 0, state->lattice->particle_site[p]);
  return mass * speed * speed;
}

static bool is_sound(const ledger *g, const ledger_laws *of, const body *state,
                     const body_totals *t, const load_look *look, double omega) {
  const double phase = state->time_step * omega, part = pl_fmin(0.5 * phase * phase, 1);
  if (of->silent || (of->families && of->reads_rates)) return true;
  const double sum = t->free + look->free + part * (t->stored + look->stored);
  if (!(sum < -1e-6 * g->largest)) return true; /* no numbers are found by the next step */
  return !(sum < -rounding_of(state, omega));
}

static double imbalance(const ledger *g, const ledger_laws *of, const double *terms) {
  const double held = terms[LEDGER_KINETIC] + terms[LEDGER_STORED];
  if (ledger_why(of)) return NAN;
  return terms[LEDGER_EXTERNAL] + terms[LEDGER_REST] - (held - g->initial) -
         terms[LEDGER_DISSIPATED_DAMAGE] - terms[LEDGER_DISSIPATED_DAMPING];
}

double ledger_stored_by(const sweep *law) {
  double sum = 0;
  if (law->law->kind == PL_CONTINUUM) return law->law->stores ? cells_stored_by(law) : NAN;
  for (int row = 0; row < law->lattice->row_count; row++)
    sum += family_stored_in_row(law, row);
  return law->law->stores ? sum : NAN;
}

double ledger_taken_by(const sweep *law) {
  double sum = 0;
  if (!law->lost_state) return law->law->field_count > 0 ? NAN : 0;
  for (long q = 0; q < law->lattice->size; q++)
    sum += law->dissipated_state[q] + law->lost_state[q];
  return sum;
}

static const ledger_term summed[] = {LEDGER_EXTERNAL, LEDGER_REST, LEDGER_DISSIPATED_DAMAGE,
                                     LEDGER_DISSIPATED_DAMPING};
enum { SUMMED = sizeof summed / sizeof *summed };

static void add_carried(const ledger *g, double terms[LEDGER_COUNT]) {
  for (int k = 0; k < SUMMED; k++)
    if (g->carried[summed[k]] != 0) terms[summed[k]] += g->carried[summed[k]];
}

void ledger_carry(ledger *g, const double before[LEDGER_COUNT], const double after[LEDGER_COUNT]) {
  g->initial += after[LEDGER_KINETIC] + after[LEDGER_STORED] -
                (before[LEDGER_KINETIC] + before[LEDGER_STORED]);
  for (int k = 0; k < SUMMED; k++)
    g->carried[summed[k]] += before[summed[k]] - after[summed[k]];
}

void ledger_sample_link(ledger *g, const ledger_laws *of, const body *state, double work,
                        double terms[LEDGER_COUNT]) {
  const body_totals t = body_sum(state);
  const double lost = work - t.stored;
  if (!g->begun) {
    *g = (ledger){.begun = 1, .lost = lost, .pending = t.dissipated_rate};
    g->initial = t.stored + taken(g, of, &t, lost) - t.given_by_rest;
  }
  terms[LEDGER_KINETIC] = 0;
  terms[LEDGER_STORED] = t.stored;
  terms[LEDGER_EXTERNAL] = work;
  terms[LEDGER_REST] = t.given_by_rest;
  terms[LEDGER_DISSIPATED_DAMPING] = t.dissipated_rate - g->pending;
  terms[LEDGER_DISSIPATED_DAMAGE] = taken(g, of, &t, lost);
  add_carried(g, terms);
  terms[LEDGER_IMBALANCE] = imbalance(g, of, terms);
}

void ledger_sample_contact(ledger *g, double stored, double work, double terms[LEDGER_COUNT]) {
  if (!g->begun) *g = (ledger){.begun = 1, .initial = stored};
  memset(terms, 0, LEDGER_COUNT * sizeof *terms);
  terms[LEDGER_STORED] = stored;
  terms[LEDGER_EXTERNAL] = work;
  terms[LEDGER_IMBALANCE] = work - (stored - g->initial);
}

void ledger_sample_stamp(ledger *g, const stamp_energies *e, double terms[LEDGER_COUNT]) {
  const double held = e->kinetic + e->stored;
  if (!g->begun) *g = (ledger){.begun = 1, .initial = held};
  memset(terms, 0, LEDGER_COUNT * sizeof *terms);
  terms[LEDGER_KINETIC] = e->kinetic;
  terms[LEDGER_STORED] = e->stored;
  terms[LEDGER_EXTERNAL] = e->work;
  terms[LEDGER_DISSIPATED_DAMPING] = e->dissipated;
  terms[LEDGER_IMBALANCE] = e->work - (held - g->initial) - e->dissipated;
}

bool ledger_sample(ledger *g, const ledger_laws *of, const body *state, const loads *l,
                   const load_look *look, double omega, double terms[LEDGER_COUNT]) {
  const body_totals t = body_sum(state);
  const load_sums s = load_steps_total(l);
  const double damping = t.dissipated_rate + t.dissipated + s.dissipated + look->dissipated;
  const double kinetic = t.kinetic + look->kinetic, stored = t.stored + look->stored,
               held = kinetic + stored;
  const double given = t.given_by_rest + look->given;
  const double lost = t.internal + s.internal + look->internal - t.stored;
  if (!g->begun) {
    *g = (ledger){.begun = 1, .lost = lost, .pending = damping};
    /* what breaks in the first state was held before, what its rest state gives was not */
    g->initial = held + taken(g, of, &t, lost) - given;
  }
  terms[LEDGER_KINETIC] = kinetic;
  terms[LEDGER_STORED] = stored;
  terms[LEDGER_EXTERNAL] = s.work + look->work + t.gravity + t.outer;
  terms[LEDGER_REST] = given;
  terms[LEDGER_DISSIPATED_DAMPING] = damping - g->pending;
  terms[LEDGER_DISSIPATED_DAMAGE] = taken(g, of, &t, lost);
  add_carried(g, terms);
  terms[LEDGER_IMBALANCE] = imbalance(g, of, terms);
  if (fabs(terms[LEDGER_IMBALANCE]) < state->rounding) terms[LEDGER_IMBALANCE] = 0;
  g->largest = pl_fmax(pl_fmax(g->largest, fabs(kinetic)),
                       pl_fmax(fabs(stored), fabs(terms[LEDGER_EXTERNAL])));
  return is_sound(g, of, state, &t, look, omega);
}
