#include "runtime/deck/group_run.h"

#include "runtime/deck/deck_check.h"

/* --- the run as a whole ---------------------------------------------------------------------- */

static const deck_key_info simulation_keys[] = {
    {.name = "title",
     .type = DECK_TEXT,
     .fallback = "= the deck's name",
     DECK_AT(simulation, title),
     .doc = "heading of pictures and results"},
    {.name = "end_time",
     .type = DECK_END,
     .unit = "s",
     .bound = BOUND_POSITIVE,
     .required = true,
     DECK_AT(simulation, end_time),
     DECK_COUNT_AT(simulation, periods),
     .doc = "the run begins at 0 and ends here; periods are those of the lowest mode"},
    {.name = "step",
     .type = DECK_STEP,
     .unit = "s",
     .bound = BOUND_POSITIVE,
     .fallback = "'auto'",
     DECK_AT(simulation, step),
     .doc = "time step; `'auto'`: `step_safety` times the largest stable one, that of small "
            "strains"},
    {.name = "step_safety",
     .type = DECK_REAL,
     .unit = "1",
     .bound = BOUND_FRACTION,
     .fallback = "= 0.25; with &relaxation 0.9",
     DECK_AT(simulation, step_safety),
     .doc = "part of the largest stable step"},
    {.name = "threads",
     .type = DECK_COUNT,
     .fallback = "0",
     .most = 4096,
     DECK_AT(simulation, threads),
     .doc = "0: as many as the machine offers"},
};

static void check_simulation(deck_reader *r, const namelist_group *from, void *into) {
  deck_simulation *item = into;
  (void)from;
  if (item->periods == 0 && item->step > item->end_time)
    diag_report(r->d, DIAG_OUT_OF_BOUNDS, deck_where(&item->item, "step"),
                "`step` is longer than the run");
}

DECK_ONE(simulation, .check = check_simulation, .doc = "The run as a whole. Required, once.");

/* --- a quasi-static run */

static const deck_key_info relaxation_keys[] = {
    {.name = "increments",
     .type = DECK_COUNT,
     .required = true,
     .most = 1000000,
     DECK_AT(relaxation, increments),
     .doc =
         "equal parts of `end_time` in which the loads come; the history has a sample after each"},
    {.name = "tolerance",
     .type = DECK_REAL,
     .unit = "1",
     .bound = BOUND_FRACTION,
     .fallback = "1e-4",
     DECK_AT(relaxation, tolerance),
     .doc =
         "an increment is done when the unbalanced force is this part of the reactions or loads; "
         "smaller for slender bodies, which bend far under little force: try a tenth and compare"},
    {.name = "most_steps",
     .type = DECK_COUNT,
     .fallback = "100000",
     .most = 1000000000,
     DECK_AT(relaxation, most_steps),
     .doc = "an increment that needs more steps is left as it is"},
};

static void check_relaxation(deck_reader *r, const namelist_group *from, void *into) {
  deck_relaxation *item = into;
  (void)from;
  if (item->increments < 1)
    diag_report(r->d, DIAG_OUT_OF_BOUNDS, deck_where(&item->item, "increments"),
                "a quasi-static run has at least one increment");
  if (item->most_steps < 1)
    diag_report(r->d, DIAG_OUT_OF_BOUNDS, deck_where(&item->item, "most_steps"),
                "an increment needs at least one step");
}

DECK_ONE(relaxation, .check = check_relaxation,
         .doc = "Makes the run quasi-static: the loads come in increments, and after each the body "
                "comes to "
                "rest by damped motion.");

/* --- what is written -------------------------------------------------------------------------- */

static const deck_key_info output_keys[] = {
    {.name = "result",
     .type = DECK_NAME,
     .fallback = "= the deck's name with .h5, in the working folder",
     DECK_AT(output, result),
     .doc = "path of the result file, from the working folder"},
    {.name = "frames",
     .type = DECK_COUNT,
     .fallback = "20",
     .most = 100000,
     DECK_AT(output, frames),
     .doc = "states stored after the initial one, which is frame 0; evenly spaced"},
    {.name = "sample",
     .type = DECK_REAL,
     .unit = "s",
     .bound = BOUND_POSITIVE,
     .fallback = "= end_time/2000, at least 200 steps",
     DECK_AT(output, sample),
     .doc = "interval of the history"},
    {.name = "fields",
     .type = DECK_NAMES,
     .fallback = "'displacement', 'damage'",
     DECK_AT(output, fields),
     DECK_COUNT_AT(output, field_count),
     .doc = "stored in each frame: displacement, velocity, rotation, force, damage (all of the "
            "law's, and their mean per particle), dissipated (energy lost, per particle), stress "
            "and strain (all components) or one of these (stress_xx), or a state, damage, output "
            "or random parameter of the law"},
    {.name = "energy",
     .type = DECK_LOGICAL,
     .fallback = ".true.",
     DECK_AT(output, energy),
     .doc = "keep the energy ledger"},
    {.name = "losses",
     .type = DECK_LOGICAL,
     .fallback = ".false.",
     DECK_AT(output, losses),
     .doc = "and in it what laws of families lose to states, damage and rate terms: then their "
            "imbalance is checked, too. Takes time, of some laws more than the steps themselves"},
};

/* False after a message. */
bool deck_samples_fit(const deck_output *item, double end, diagnostics *d) {
  enum { MOST_SAMPLES = 10000000 };
  const int before = d->errors;
  if (item->sample > end)
    diag_report(d, DIAG_OUT_OF_BOUNDS, deck_where(&item->item, "sample"),
                "`sample` is longer than the run");
  else if (item->sample > 0 && end / item->sample > MOST_SAMPLES)
    diag_report(d, DIAG_OUT_OF_BOUNDS, deck_where(&item->item, "sample"),
                "`sample` gives %.3g samples; the most is %d", end / item->sample, MOST_SAMPLES);
  return d->errors == before;
}

/* Which fields a law has is known later only. */
static void keep_field_places(deck_reader *r, const namelist_group *from, deck_output *item) {
  const namelist_key *fields = namelist_find(from, "fields");
  if (!fields || fields->value_count != item->field_count) return;
  span *where = arena_alloc(r->memory, (size_t)fields->value_count * sizeof *where);
  for (int k = 0; k < fields->value_count; k++)
    where[k] = fields->values[k].where;
  item->field_where = where;
}

static void check_output(deck_reader *r, const namelist_group *from, void *into) {
  deck_output *item = into;
  const double end = r->k->simulation.end_time;
  keep_field_places(r, from, item);
  if (end > 0) deck_samples_fit(item, end, r->d);
}

DECK_ONE(output, .check = check_output, .doc = "What is written, and how often.");

static const deck_key_info checkpoint_keys[] = {
    {.name = "interval",
     .type = DECK_REAL,
     .unit = "s",
     .bound = BOUND_NOT_NEGATIVE,
     .fallback = "'600 s'",
     DECK_AT(checkpoint, interval),
     .doc = "of wall time between two checkpoints; 0: only when the run is stopped"},
};

DECK_ONE(checkpoint, .doc = "State from which a stopped or killed run goes on.");
