#include "generator/sense/sense.h"

#include "generator/sense/sense_bench.h"
#include "generator/sense/sense_bonds.h"
#include "generator/sense/sense_modes.h"
#include "generator/sense/sense_moduli.h"
#include "generator/sense/sense_numbers.h"
#include "generator/sense/sense_points.h"
#include "generator/sense/sense_text.h"

static bool is_of_bonds(const law *l) {
  const law_kind kind = l->tree->law;
  return kind == LAW_CENTRAL_BOND || kind == LAW_MICROPOLAR_BOND || kind == LAW_SLIP_BOND;
}

/* What has been said already is not said again, nor what follows from it. */
static void hush(sense_bench *b, int before) {
  for (int k = before; k < b->said->count; k++)
    b->said_of[b->said->items[k].code] = true;
  for (int k = 0; k < b->said->accepted_count; k++)
    b->said_of[b->said->accepted[k].code] = true;
  if (b->said_of[DIAG_HEALING] || b->said_of[DIAG_NOT_FINITE]) b->said_of[DIAG_ELASTIC] = true;
}

/* What the text alone shows is said of a law that breaks a rule, too: it may be the cause. */
static void check_sense(const law *l, const physics_options *o, diagnostics *d, int before,
                        bool obeys) {
  sense_bench b;
  const bool planned = sense_bench_open(&b, l, o, d);
  hush(&b, before);
  sense_check_text(&b);
  if (planned && obeys) {
    sense_check_moduli(&b);
    sense_check_modes(&b);
    sense_check_numbers(&b);
    if (is_of_bonds(l)) sense_check_bonds(&b);
    if (l->tree->law == LAW_CONTINUUM) sense_check_points(&b);
  }
  sense_bench_close(&b);
}

bool law_is_sound(const law *l, const physics_options *o, diagnostics *d, physics_report *report) {
  static const physics_options usual = {0};
  const int errors = d->errors, before = d->count;
  const bool obeys = physics_check(l, o, d, report);
  check_sense(l, o ? o : &usual, d, before, obeys);
  if (!o || !o->strict) law_waive(l, d, before);
  return d->errors == errors;
}
