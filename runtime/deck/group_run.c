#include "runtime/deck/group_run.h"

#include "runtime/deck/deck_check.h"
#include "runtime/deck/lattice_kind.h"

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
     .fallback = "= required; with &static 1 s",
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
    {.name = "shrink_every",
     .type = DECK_COUNT,
     .fallback = "0",
     .most = 1000000000,
     DECK_AT(simulation, shrink_every),
     .doc = "every so many steps the run looks whether the body has become so stiff that the step "
            "must be shorter, and halves it; 0: the step stays"},
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

/* --- a static solution */

static const deck_key_info static_keys[] = {
    {.name = "increments",
     .type = DECK_COUNT,
     .fallback = "1",
     .most = 1000000,
     DECK_AT(static, increments),
     .doc = "equal parts of `end_time`: there is a solution, and a sample of the history, for the "
            "loads at the end of each"},
};

static void check_static(deck_reader *r, const namelist_group *from, void *into) {
  const deck_static *item = into;
  deck_relaxation *kept = &r->k->relaxation;
  if (item->increments < 1) {
    diag_report(r->d, DIAG_OUT_OF_BOUNDS, deck_where(&item->item, "increments"),
                "a static run has at least one increment");
  } else if (kept->increments > 0) {
    diag_report(r->d, DIAG_CONFLICT, from->where,
                "a run is solved, `&static`, or relaxed, `&relaxation`, not both");
    diag_note(r->d, kept->item.where, "it is relaxed here");
  }
  *kept = (deck_relaxation){.item = item->item,
                            .increments = item->increments,
                            .tolerance = kept->tolerance,
                            .most_steps = 1,
                            .solved = true};
  if (r->k->simulation.end_time == 0 && r->k->simulation.periods == 0)
    r->k->simulation.end_time = 1;
}

DECK_ROW(static, .single = true, .place = offsetof(deck, at_rest), .check = check_static,
         .doc = "Makes the run static: the displacements of meshes whose laws are linear solve the "
                "equations K u = F, without steps in time.");

/* --- what it begins from ---------------------------------------------------------------------- */

static const deck_key_info start_keys[] = {
    {.name = "result",
     .type = DECK_NAME,
     .required = true,
     DECK_AT(start, result),
     .doc = "path of the result, from the working folder; its deck has `state = .true.` in "
            "&output"},
};

/* Of meshes the state is not kept. False after a message. */
static bool has_states(deck_reader *r, span where, const char *what) {
  for (int n = 0; n < r->k->lattice_count; n++) {
    if (!deck_lattice_is_mesh(&r->k->lattices[n])) continue;
    diag_report(r->d, DIAG_NOT_SUPPORTED, where, "`%s` is a mesh, and %s", r->k->lattices[n].name,
                what);
    diag_hint(r->d, "let one run take all of the loading: loads have `start` and `end`");
    return false;
  }
  return true;
}

static void check_start(deck_reader *r, const namelist_group *from, void *into) {
  const deck_start *item = into;
  (void)from;
  has_states(r, item->item.where, "runs with meshes begin at rest");
}

DECK_ONE(start, .check = check_start,
         .doc = "Begins the run from the end of another one, whose deck may differ, see "
                "[Stages](#stages).");

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
     .doc = "states stored after the initial one, which is frame 0; evenly spaced; `&frame` adds "
            "others"},
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
     .doc = "stored in each frame beside displacement, which comes by itself: velocity, rotation, "
            "force, damage (all of the "
            "law's, and their mean per particle), dissipated (energy lost, per particle), stress "
            "and strain (all components) or one of these (stress_xx), or a state, damage, output "
            "or random parameter of the law; dead_cells (of a mesh, which have died) comes by "
            "itself"},
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
    {.name = "state",
     .type = DECK_LOGICAL,
     .fallback = ".false.",
     DECK_AT(output, state),
     .doc = "keep in the result all of the state at the end, for a `&start` of another deck"},
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
  if (item->state)
    has_states(r, deck_where(&item->item, "state"), "the state of meshes is not kept");
}

DECK_ONE(output, .check = check_output, .doc = "What is written, and how often.");

static const deck_key_info checkpoint_keys[] = {
    {.name = "interval",
     .type = DECK_REAL,
     .unit = "s",
     .bound = BOUND_NOT_NEGATIVE,
     .fallback = "'600 s'",
     DECK_AT(checkpoint, interval),
     .doc =
         "of wall time between two checkpoints, the first after 30 s if that is shorter; 0: only "
         "when the run is stopped"},
};

DECK_ONE(checkpoint, .doc = "State from which a stopped or killed run goes on.");

/* --- many runs -------------------------------------------------------------------------------- */

static const deck_key_info study_keys[] = {
    {.name = "deck",
     .type = DECK_NAMES,
     .fallback = "= the file that this stands in",
     DECK_AT(study, decks.items),
     DECK_COUNT_AT(study, decks.count),
     .doc = "decks that are run, beside this file; several with `fit`"},
    {.name = "vary",
     .type = DECK_NAMES,
     DECK_AT(study, vary.items),
     DECK_COUNT_AT(study, vary.count),
     .doc = "keys with their values, which are crossed: `'lattice.spacing = 20, 10, 5 mm'`, from, "
            "to and step `'drive.velocity = -10..-40:10 mm/s'`, values with commas "
            "`'lattice.origin = 0, 0; 2.5 mm, 0'`; keys that change together: `'lattice.spacing = "
            "20, 10 mm with material.S_t = 1e-4, 2e-4'`"},
    {.name = "set",
     .type = DECK_NAMES,
     DECK_AT(study, set.items),
     DECK_COUNT_AT(study, set.count),
     .doc = "`'group.key = value'` in all runs"},
    {.name = "x",
     .type = DECK_NAME,
     .fallback = "'time'",
     DECK_AT(study, x),
     .doc = "history along x of the curves"},
    {.name = "y",
     .type = DECK_NAME,
     .fallback = "= 'load', or the first monitor",
     DECK_AT(study, y),
     .doc = "history whose curves are drawn and whose peaks are listed"},
    {.name = "result",
     .type = DECK_NAME,
     .fallback = "= NAME_study in the working folder",
     DECK_AT(study, result),
     .doc = "what its files are called: a folder of results, and with endings table and picture"},
    {.name = "jobs",
     .type = DECK_COUNT,
     .fallback = "0",
     .most = 1024,
     DECK_AT(study, jobs),
     .doc = "runs at the same time; 0: as many as there are processors"},
    {.name = "converge",
     .type = DECK_NAME,
     DECK_AT(study, converge),
     .doc = "one of the keys that are varied: where does the answer go as its value goes to 0?"},
    {.name = "of",
     .type = DECK_WORD,
     .choices = "peak|last",
     .fallback = "'peak'",
     DECK_AT(study, of),
     .doc = "the answer: the peak of `y`, or its last value"},
    {.name = "strength",
     .type = DECK_NAME,
     DECK_AT(study, strength),
     .doc = "a load that is held: which values are borne? `'force.per_length = -40..-50:2 kN/m'`; "
            "the key alone: tenths of the deck's value up to twice it, then fifths of the step "
            "between what is borne and what is not"},
    {.name = "watch",
     .type = DECK_NAME,
     .fallback = "'deflection'",
     DECK_AT(study, watch),
     .doc = "of `strength`: the monitor that must not grow while the load is held"},
    {.name = "growth",
     .type = DECK_REAL,
     .unit = "1",
     .bound = BOUND_POSITIVE,
     .fallback = "0.05",
     DECK_AT(study, growth),
     .doc = "the load is not borne if the monitor is larger by more than this part in the second "
            "half of the hold than in the first"},
    {.name = "limit",
     .type = DECK_REAL,
     .unit = "m",
     .bound = BOUND_POSITIVE,
     .fallback = "'1 m'",
     DECK_AT(study, limit),
     .doc = "nor if it passes this"},
    {.name = "longest",
     .type = DECK_COUNT,
     .fallback = "4",
     .most = 1000,
     DECK_AT(study, longest),
     .doc = "while the second half of the hold is smaller by more than that, the body still comes "
            "to rest: "
            "the hold is doubled, up to so many times that of the deck"},
    {.name = "twin",
     .type = DECK_NAME,
     DECK_AT(study, twin),
     .doc = "of `strength`: a deck of the same body that is moved, not loaded; its peak of `y` is "
            "told beside"},
    {.name = "fit",
     .type = DECK_NAMES,
     DECK_AT(study, fit.items),
     DECK_COUNT_AT(study, fit.count),
     .doc = "parameters that are sought, with bounds: `'material.S_t = 1e-4..2e-4'`; the search "
            "begins at the deck's values"},
    {.name = "to",
     .type = DECK_NAMES,
     DECK_AT(study, to.items),
     DECK_COUNT_AT(study, to.count),
     .doc = "of `fit`: tables with measured curves, one for each deck: `'lab.csv'` with columns "
            "named as `x` and `y`, `'lab.csv:cmod,load'`, or a band `'lab.csv:cmod,low,high'`"},
    {.name = "weight",
     .type = DECK_REALS,
     .unit = "1",
     .bound = BOUND_POSITIVE,
     .fallback = "= 1 each",
     DECK_AT(study, weights),
     DECK_COUNT_AT(study, weight_count),
     .doc = "of the curves"},
    {.name = "search",
     .type = DECK_WORD,
     .choices = "bobyqa|nelder-mead",
     .fallback = "'bobyqa'",
     DECK_AT(study, search),
     .doc = "how parameters are sought"},
    {.name = "runs",
     .type = DECK_COUNT,
     .fallback = "200",
     .most = 100000,
     DECK_AT(study, runs),
     .doc = "the most points that the search may try"},
};

/* Where each of the key's texts stands. */
static void keep_text_places(deck_reader *r, const namelist_group *from, const char *name,
                             deck_texts *texts) {
  const namelist_key *key = namelist_find(from, name);
  if (!key || key->value_count != texts->count) return;
  span *where = arena_alloc(r->memory, ((size_t)texts->count + 1) * sizeof *where);
  for (int k = 0; k < texts->count; k++)
    where[k] = key->values[k].text_where;
  texts->where = where;
}

static void check_study(deck_reader *r, const namelist_group *from, void *into) {
  deck_study *item = into;
  keep_text_places(r, from, "deck", &item->decks);
  keep_text_places(r, from, "vary", &item->vary);
  keep_text_places(r, from, "set", &item->set);
  keep_text_places(r, from, "fit", &item->fit);
  keep_text_places(r, from, "to", &item->to);
  deck_refuse_both(r, from, "converge", "strength");
  deck_refuse_both(r, from, "converge", "fit");
  deck_refuse_both(r, from, "strength", "fit");
}

DECK_ONE(study, .check = check_study,
         .doc = "Many runs of a deck, which `perilat study` does. It may stand in the deck, or by "
                "itself in a file that names the deck; a run takes no notice of it. What is asked, "
                "and what comes out: [many runs](../generator/README.md#many-runs).");
