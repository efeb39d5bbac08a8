#include "generator/check/physics.h"

#include <assert.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "dsl/base/arena.h"
#include "generator/check/physics_energy.h"
#include "generator/check/physics_family_energy.h"
#include "generator/check/physics_family_healing.h"
#include "generator/check/physics_family_paths.h"
#include "generator/check/physics_healing.h"
#include "generator/check/physics_hold.h"
#include "generator/check/physics_parameters.h"
#include "generator/check/physics_paths.h"
#include "generator/check/physics_points.h"
#include "generator/check/physics_states.h"
#include "generator/check/physics_tangent.h"
#include "generator/check/physics_tips.h"
#include "generator/lower/rest_ends.h"
#include "runtime/base/clock.h"

/* --- the checks ------------------------------------------------------------------------------- */

static int times(const physics_options *o, int usual) {
  return (int)(usual * (o->effort > 0 ? o->effort : 1));
}

static void scan_from_rest(physics *p) {
  physics_scan(p, times(p->b.options, 48), true);
}

static void scan_from_pool(physics *p) {
  physics_scan(p, times(p->b.options, 48), false);
}

static void histories(physics *p) {
  physics_histories(p, times(p->b.options, 12));
}

static void tangent(physics *p) {
  physics_check_tangent(p, 0);
}

static void family_histories(family_bench *b) {
  family_check_histories(b, times(b->options, 24));
}

static void family_whole(family_bench *b) {
  family_check_energy(b, false);
}

static void family_damaged(family_bench *b) {
  if (!b->law->nonconservative) family_check_energy(b, true);
}

static void family_dissipation(family_bench *b) {
  family_check_dissipation(b, times(b->options, b->reads_time ? 30 : 5));
}

/* With the values of a deck a line may be out of reach: only around the defaults. Of very many
   lines the states that are drawn may miss a narrow one. */
static void check_lines(physics *p) {
  enum { MANY_LINES = 32 };
  const lowered_line *never = conditions_never_taken(&p->b.conditions);
  if (!never || p->b.options->parameters || p->b.law_step.text.line_count > MANY_LINES) return;
  physics_say(p, DIAG_NEVER_TAKEN, never->cases->cases[never->line].where, NULL,
              "no state of a bond is in this line: its condition never holds, or a line above has "
              "taken all that it is for");
  diag_hint(p->said, "look at the order of the lines, and at the limits in their conditions");
}

/* A bond that stands askew, between unlike particles unless they are a deck's. */
static pl_bond_class any_bond(const rows *lattice, bool alike) {
  static const double askew[2][3] = {{0.8, 0.6, 0}, {0.48, 0.6, 0.64}};
  pl_bond_class c = rows_bond_class(lattice, 0);
  for (int d = 0; d < 3; d++)
    c.chord[d] = c.s * askew[lattice->dimensions == 3][d];
  if (!alike) c.mass_j *= 1.5;
  return c;
}

/* "`rest stretch` is ...", where it is no number or not the same from both ends; said by `say`. */
typedef void rest_speaker(void *of, diag_code code, span where, const char *text);

static void check_rest_stretch(const law *l, const physics_options *o, const double *parameters,
                               const rows *lattice, rest_speaker *say, void *of, diagnostics *d) {
  const pl_bond_class bond = any_bond(lattice, o->lattice != NULL);
  rest_ends r;
  char text[200];
  if (!rest_ends_find(l, parameters, &bond, &r, d)) return;
  if (!r.finite) {
    say(of, DIAG_REST_FORCE, l->rest->where,
        "the rest stretch of a virgin bond is not a finite number");
    return;
  }
  if (!rest_ends_differ(&r)) return;
  snprintf(text, sizeof text,
           "the two ends of a bond find different rest stretches: one %.6g, the other %.6g",
           r.both[0], r.both[1]);
  say(of, DIAG_EXCHANGE, l->rest->where, text);
  diag_hint(d,
            l->tree->law == LAW_STATE
                ? "of a value x of the particle write (x + x[j])/2; of `direction` only what does "
                  "not change with its sign"
                : "only what does not change with the sign of `direction` is the same from both "
                  "ends");
}

static void say_of_bond(void *of, diag_code code, span where, const char *text) {
  physics_say(of, code, where, NULL, "%s", text);
}

static void rest_stretch_of_bonds(physics *p) {
  const bench *b = &p->b;
  double *parameters = must_calloc((size_t)b->parameter_count + 1, sizeof *parameters);
  physics_draw_parameters(b->law, NULL, parameters);
  check_rest_stretch(b->law, b->options,
                     b->options->parameters ? b->options->parameters : parameters, b->lattices[0],
                     say_of_bond, p, p->said);
  free(parameters);
}

static void say_of_family(void *of, diag_code code, span where, const char *text) {
  family_bench_say(of, code, where, 0, "%s", text);
}

static void rest_stretch_of_families(family_bench *b) {
  check_rest_stretch(b->law, b->options, b->parameters, b->lattice, say_of_family, b, b->said);
}

/* A check: what it may say, for which laws it is, and what a law has failed already when it is
   left out, because it would say the same again. Codes stand up to the first 0, which is none of
   mechanics. */
typedef struct physics_row {
  diag_code says[6];
  void (*of_bonds)(physics *p);         /* NULL: not for laws of bonds */
  void (*of_families)(family_bench *b); /* NULL: not for laws of families */
  void (*of_bodies)(family_bench *b);   /* NULL: not for micropolar laws in space, on bodies */
  double share; /* of the time that laws of bonds have; 0: what the one before has left */
  diag_code hushed_by[9];
} physics_row;

/* In their order: a scan and histories leave states to the checks that follow. */
static const physics_row checks[] = {
    {.says = {DIAG_REST_FORCE, DIAG_EXCHANGE},
     .of_bonds = rest_stretch_of_bonds,
     .of_families = rest_stretch_of_families},
    {.says = {DIAG_REST_FORCE},
     .of_bonds = physics_check_rest,
     .of_families = family_check_rest,
     .of_bodies = family_check_rest,
     .share = 0.05},
    {.says = {DIAG_STIFFNESS},
     .of_bonds = physics_check_stiffness,
     .of_families = family_check_stiffness,
     .of_bodies = family_check_twist,
     .hushed_by = {DIAG_REST_FORCE}},
    {.says = {DIAG_CONTINUITY, DIAG_FLOW}, .of_bonds = scan_from_rest, .share = 0.15},
    {.says = {DIAG_NOT_FINITE, DIAG_DAMAGE_RANGE, DIAG_EXCHANGE, DIAG_MIRROR},
     .of_bonds = histories,
     .share = 0.1},
    {.says = {DIAG_CONTINUITY, DIAG_FLOW}, .of_bonds = scan_from_pool, .share = 0.1},
    {.says = {DIAG_NOT_FINITE, DIAG_DAMAGE_RANGE, DIAG_EXCHANGE, DIAG_MIRROR},
     .of_bonds = histories,
     .share = 0.1},
    {.says = {DIAG_NOT_FINITE, DIAG_DAMAGE_RANGE, DIAG_EXCHANGE, DIAG_CONTINUITY, DIAG_FLOW},
     .of_families = family_histories},
    {.says = {DIAG_ENERGY_FORCE},
     .of_bonds = physics_check_energy_and_force,
     .of_families = family_check_energy_and_force,
     .share = 0.1},
    {.says = {DIAG_TANGENT}, .of_bonds = tangent},
    {.says = {DIAG_STORED_ENERGY},
     .of_bonds = physics_check_stored_energy,
     .share = 0.1,
     .hushed_by = {DIAG_STIFFNESS}},
    {.says = {DIAG_STORED_ENERGY, DIAG_CLOSED_PATH},
     .of_families = family_whole,
     .of_bodies = family_whole,
     .hushed_by = {DIAG_STIFFNESS}},
    {.says = {DIAG_DAMAGE_FORCE},
     .of_bonds = physics_check_damage_force,
     .hushed_by = {DIAG_STIFFNESS, DIAG_STORED_ENERGY}},
    {.says = {DIAG_STORED_ENERGY, DIAG_CLOSED_PATH_DAMAGED, DIAG_DAMAGE_FORCE},
     .of_families = family_damaged,
     .of_bodies = family_damaged,
     .hushed_by = {DIAG_STIFFNESS, DIAG_CLOSED_PATH}},
    {.says = {DIAG_FLOW}, .of_bonds = physics_check_hold, .share = 0.1, .hushed_by = {DIAG_FLOW}},
    {.says = {DIAG_HEALING},
     .of_bonds = physics_check_healing,
     .of_families = family_check_healing,
     .share = 2}, /* some hundred states of usual laws */
    {.says = {DIAG_CLOSED_PATH, DIAG_CLOSED_PATH_DAMAGED},
     .of_bonds = physics_check_closed_path,
     .share = 0.15},
    {.says = {DIAG_DISSIPATION},
     .of_bonds = physics_check_dissipation,
     .share = 0.25,
     .hushed_by = {DIAG_STORED_ENERGY, DIAG_CLOSED_PATH, DIAG_DAMAGE_FORCE, DIAG_STIFFNESS,
                   DIAG_REST_FORCE, DIAG_FLOW, DIAG_EXCHANGE, DIAG_MIRROR}},
    {.says = {DIAG_DISSIPATION},
     .of_families = family_dissipation,
     .hushed_by = {DIAG_STORED_ENERGY, DIAG_CLOSED_PATH, DIAG_DAMAGE_FORCE, DIAG_STIFFNESS,
                   DIAG_REST_FORCE, DIAG_FLOW}},
    {.says = {DIAG_NEVER_TAKEN}, .of_bonds = check_lines}, /* all states have been drawn */
};
enum { CHECK_COUNT = sizeof checks / sizeof *checks };

static bool is_hushed(const physics_row *c, const bool failed[DIAG_COUNT]) {
  for (int k = 0; c->hushed_by[k]; k++)
    if (failed[c->hushed_by[k]]) return true;
  return false;
}

/* Whether a check has said only what its row says. */
static bool keeps_to_its_row(const physics_row *c, const bool before[DIAG_COUNT],
                             const bool after[DIAG_COUNT]) {
  bool may[DIAG_COUNT] = {false};
  for (int k = 0; c->says[k]; k++)
    may[c->says[k]] = true;
  for (int code = 0; code < DIAG_COUNT; code++)
    if (after[code] && !before[code] && !may[code]) return false;
  return true;
}

static void check_bonds(physics *p) {
  bool before[DIAG_COUNT];
  for (const physics_row *c = checks; c < checks + CHECK_COUNT; c++) {
    if (!c->of_bonds) continue;
    if (c->share > 0) bench_allow(&p->b, c->share);
    if (is_hushed(c, p->failed)) continue;
    memcpy(before, p->failed, sizeof before);
    c->of_bonds(p);
    assert(keeps_to_its_row(c, before, p->failed));
  }
}

static void check_families(family_bench *b) {
  const bool of_families = b->law->tree->law == LAW_STATE;
  bool before[DIAG_COUNT];
  for (const physics_row *c = checks; c < checks + CHECK_COUNT; c++) {
    void (*check)(family_bench *) = of_families ? c->of_families : c->of_bodies;
    if (!check || is_hushed(c, b->failed)) continue;
    memcpy(before, b->failed, sizeof before);
    check(b);
    assert(keeps_to_its_row(c, before, b->failed));
  }
}

/* --- a law ------------------------------------------------------------------------------------ */

/* What single bonds have said already is not said again. */
static void check_twisting_bonds(const physics *p, physics_report *report) {
  const law *l = p->b.law;
  if (!law_kind_turns(l->tree->law) || l->setting != SETTING_SPACE) return;
  family_bench *b = family_bench_new(l, p->b.options, p->said);
  if (!b) return;
  memcpy(b->failed, p->failed, sizeof b->failed);
  check_families(b);
  report->states += b->evaluated;
  family_bench_free(b);
}

static void check_law_of_bonds(const law *l, const physics_options *o, diagnostics *d,
                               physics_report *report) {
  physics *p = must_calloc(1, sizeof *p);
  p->said = d;
  if (bench_open(&p->b, l, o, d)) {
    p->pool = must_alloc((size_t)POOL_MOST * (size_t)p->b.width * sizeof *p->pool);
    check_bonds(p);
    conditions_count(&p->b.conditions, report);
    report->states = p->b.evaluated;
    check_twisting_bonds(p, report);
    free(p->pool);
    bench_close(&p->b);
  }
  free(p);
}

static void check_law_of_families(const law *l, const physics_options *o, diagnostics *d,
                                  physics_report *report) {
  family_bench *b = family_bench_new(l, o, d);
  if (!b) return;
  check_families(b);
  conditions_count(&b->conditions, report);
  report->states = b->evaluated;
  family_bench_free(b);
}

bool physics_check(const law *l, const physics_options *o, diagnostics *d, physics_report *report) {
  static const physics_options usual = {0};
  const double begun = monotonic_seconds();
  const int errors = d->errors, before = d->count;
  physics_report unwanted;
  report = report ? report : &unwanted;
  *report = (physics_report){0};
  (l->tree->law == LAW_CONTINUUM ? physics_check_points
   : l->tree->law == LAW_CRACK   ? physics_check_tips
   : l->tree->law == LAW_STATE   ? check_law_of_families
                                 : check_law_of_bonds)(l, o ? o : &usual, d, report);
  if (!o || !o->strict) law_waive(l, d, before);
  report->seconds = monotonic_seconds() - begun;
  return d->errors == errors;
}
