#include "runtime/deck/group_monitor.h"

#include <ctype.h>
#include <string.h>

#include "runtime/deck/deck_check.h"
#include "runtime/deck/deck_value.h"

/* --- monitors --------------------------------------------------------------------------------- */

static const deck_key_info monitor_keys[] = {
    {.name = "name",
     .type = DECK_NAME,
     .required = true,
     DECK_AT(monitor, name),
     .doc = "letters, digits and `_`; its name in the result"},
    {.name = "kind",
     .type = DECK_CHOICE,
     .choices = "reaction|displacement|velocity|opening|damaged|broken|field",
     .required = true,
     DECK_AT(monitor, kind),
     .doc = "decides which of the next five keys are needed"},
    {.name = "region",
     .type = DECK_NAME,
     DECK_AT(monitor, region),
     .doc = "reaction: force that its supports and drives exert on the body; displacement, "
            "velocity, field: mean"},
    {.name = "between",
     .type = DECK_NAMES,
     DECK_AT(monitor, between),
     .doc = "two regions; opening: mean displacement of the second less that of the first; "
            "reaction, in place of `region`: half the reaction of the second less that of the "
            "first, what the two ends of a specimen carry in the mean"},
    {.name = "component",
     .type = DECK_CHOICE,
     .choices = DECK_COMPONENTS,
     DECK_AT(monitor, component),
     .doc = "reaction, displacement, velocity, opening: direction"},
    {.name = "field",
     .type = DECK_NAME,
     DECK_AT(monitor, field),
     .doc = "field: name of a state, damage or output of the law that stands on particles"},
    {.name = "above",
     .type = DECK_REAL,
     .unit = "1",
     .bound = BOUND_NOT_NEGATIVE,
     .fallback = "= 0; broken: 1",
     DECK_AT(monitor, above),
     .doc = "damaged: bonds with more damage than this are counted (particles, where the law's "
            "damage stands on these alone); broken: those with at least this damage, e.g. 0.999 "
            "for laws whose bonds never separate completely"},
    {.name = "average",
     .type = DECK_REAL,
     .unit = "s",
     .bound = BOUND_NOT_NEGATIVE,
     .fallback = "0",
     DECK_AT(monitor, average),
     .doc = "mean of all states of this time before each sample, the present one included; of a "
            "velocity way over time; 0: the value at the sample"},
    {.name = "zero_at",
     .type = DECK_REAL,
     .unit = "s",
     .bound = BOUND_NOT_NEGATIVE,
     .fallback = "= never",
     DECK_AT(monitor, zero_at),
     .doc = "the value at this time is subtracted"},
    {.name = "scale",
     .type = DECK_REAL,
     .unit = "1",
     .fallback = "1",
     DECK_AT(monitor, scale),
     .doc = "factor on the value, e.g. -1 to count a downward load positive"},
};

enum {
  OF_MOTION = 1 << MONITOR_REACTION | 1 << MONITOR_DISPLACEMENT | 1 << MONITOR_VELOCITY,
  OF_FIELD = 1 << MONITOR_FIELD,
  OF_PAIR = 1 << MONITOR_OPENING | 1 << MONITOR_REACTIONS,
  OF_DAMAGE = 1 << MONITOR_DAMAGED | 1 << MONITOR_BROKEN
};
static const char *const monitor_words[] = {
    "a reaction monitor", "a displacement monitor",
    "a velocity monitor", "an opening monitor",
    "a damaged monitor",  "a broken monitor",
    "a field monitor",    "a reaction monitor with `between`"};
static const deck_key_use monitor_uses[] = {{"region", OF_MOTION | OF_FIELD, true},
                                            {"between", OF_PAIR, true},
                                            {"component", OF_MOTION | OF_PAIR, true},
                                            {"field", OF_FIELD, true},
                                            {"above", OF_DAMAGE, false}};

static bool is_identifier(const char *name) {
  bool good = isalpha((unsigned char)*name) || *name == '_';
  for (const char *p = name; *p; p++)
    good &= isalnum((unsigned char)*p) || *p == '_';
  return good;
}

static void check_monitor_name(deck_reader *r, const deck_monitor *item) {
  static const char *const taken[] = {"time", "energy", "relaxation_steps", "relaxation_unbalance"};
  span where = deck_where(&item->item, "name");
  if (deck_is_one_of(item->name, taken, 4))
    diag_report(r->d, DIAG_RESERVED_NAME, where,
                "a monitor cannot be called `%s`: the result has a history of that name",
                item->name);
  else if (!is_identifier(item->name)) {
    diag_report(r->d, DIAG_BAD_VALUE, where, "`%s` cannot be the name of a monitor",
                deck_shown(r->memory, item->name));
    diag_hint(r->d, "use letters, digits and `_`, and begin with a letter");
  }
  int first = deck_find_monitor(r->k, item->name);
  deck_check_name(r, "monitor", item->name, &item->item,
                  first < 0 ? NULL : &r->k->monitors[first].item);
}

/* Forces come from supports and drives only; without any along the component a reaction is 0 for
 * ever. */
static void check_reaction(deck_reader *r, const deck_monitor *item) {
  const bool found =
      deck_lacks(r->k, "support") || deck_lacks(r->k, "drive") || r->moved & 1 << item->component;
  if (found || !r->names_known) return;
  diag_report(r->d, DIAG_CONFLICT, item->item.where,
              "this reaction is always 0: no `&support` or `&drive` acts on `%s`",
              deck_component_of(r, item->region, item->component));
}

static void check_broken(deck_reader *r, const namelist_group *from, deck_monitor *item) {
  if (!namelist_find(from, "above")) item->above = 1;
  if (item->above > 0 && item->above <= 1) return;
  diag_report(r->d, DIAG_OUT_OF_BOUNDS, deck_where(&item->item, "above"),
              "`above` of a broken monitor must be greater than 0 and at most 1");
}

static const char *watched_region(const deck_monitor *item) {
  return item->region ? item->region : item->between[0];
}

static void check_monitor(deck_reader *r, const namelist_group *from, void *into) {
  deck_monitor *item = into;
  const namelist_key *between = namelist_find(from, "between");
  check_monitor_name(r, item);
  if (item->kind == MONITOR_REACTION && between) item->kind = MONITOR_REACTIONS;
  if (!deck_keys_fit(from, monitor_uses, 5, (int)item->kind, monitor_words[item->kind], r->d))
    return;
  if (!namelist_find(from, "zero_at")) item->zero_at = -1;
  if (item->kind == MONITOR_BROKEN) check_broken(r, from, item);
  deck_warn_late(r, &item->item, "zero_at", item->zero_at);
  if (item->region) deck_item_region_known(r, &item->item, item->region);
  for (int i = 0; between && i < 2; i++)
    deck_region_known(r, between->values[i].where, item->between[i]);
  if (!deck_take_component(r, &item->item, watched_region(item), &item->component)) return;
  if (item->kind == MONITOR_REACTION || item->kind == MONITOR_REACTIONS) check_reaction(r, item);
}

DECK_LIST(monitor, .identity = "name", .check = check_monitor,
          .doc = "A quantity recorded at every sample of the history.");

/* --- stops ------------------------------------------------------------------------------------ */

static const deck_key_info stop_keys[] = {
    {.name = "monitor",
     .type = DECK_NAME,
     .required = true,
     DECK_AT(stop, monitor),
     .doc = "name of the monitor that decides"},
    {.name = "below",
     .type = DECK_LATER,
     .unit = "as the monitor",
     DECK_NOT_KEPT,
     .doc = "stop when its absolute value is less"},
    {.name = "above",
     .type = DECK_LATER,
     .unit = "as the monitor",
     DECK_NOT_KEPT,
     .doc = "stop when its absolute value is more"},
    {.name = "of",
     .type = DECK_WORD,
     .choices = "peak",
     DECK_NOT_KEPT,
     .doc = "`below` is a fraction of the largest absolute value so far"},
    {.name = "after",
     .type = DECK_REAL,
     .unit = "s",
     .bound = BOUND_NOT_NEGATIVE,
     .fallback = "0",
     DECK_AT(stop, after),
     .doc = "not before this time"},
};

/* Unit of a monitor's values. */
static const char *monitor_unit(const deck_reader *r, const deck_monitor *m) {
  const bool rotates = deck_is_rotation(r, watched_region(m), m->component);
  switch (m->kind) {
  case MONITOR_REACTION:
  case MONITOR_REACTIONS:
    return rotates ? "N*m" : "N";
  case MONITOR_DISPLACEMENT:
  case MONITOR_OPENING:
    return rotates ? "1" : "m";
  case MONITOR_VELOCITY:
    return rotates ? "1/s" : "m/s";
  default:
    return "1";
  }
}

static void check_level(deck_reader *r, const namelist_key *key, deck_stop *item,
                        const char *unit_text) {
  const namelist_value *v = &key->values[0];
  if (!deck_values_counted(key, 1, r->d) ||
      !deck_real_read(v, key->name, unit_text, BOUND_NOT_NEGATIVE, &item->level, r->d))
    return;
  if (item->of_peak && (item->level <= 0 || item->level >= 1))
    diag_report(r->d, DIAG_OUT_OF_BOUNDS, v->where,
                "a fraction of the peak must be greater than 0 and less than 1");
}

/* The one of two keys that was written, or NULL after a message. */
static const namelist_key *either(deck_reader *r, const namelist_group *from, const char *first,
                                  const char *second) {
  const namelist_key *a = namelist_find(from, first), *b = namelist_find(from, second);
  deck_refuse_both(r, from, first, second);
  if (!a && !b)
    diag_report(r->d, DIAG_MISSING_KEY, from->where, "`&%s` needs `%s` or `%s`", from->name, first,
                second);
  return a && b ? NULL : a ? a : b;
}

static void check_stop(deck_reader *r, const namelist_group *from, void *into) {
  deck_stop *item = into;
  const namelist_key *of = namelist_find(from, "of"), *key = either(r, from, "below", "above");
  deck_warn_late(r, &item->item, "after", item->after);
  const bool found = deck_monitor_known(r, deck_where(&item->item, "monitor"), item->monitor);
  if (!key || !found) return;
  item->below = key == namelist_find(from, "below");
  item->of_peak = of != NULL;
  if (of && !item->below) {
    diag_report(r->d, DIAG_CONFLICT, of->name_where, "`of = 'peak'` goes with `below` only");
    diag_hint(r->d, "no value is above the largest one so far");
    return;
  }
  const deck_monitor *m = &r->k->monitors[deck_find_monitor(r->k, item->monitor)];
  if (!m->item.faulty) check_level(r, key, item, of ? "1" : monitor_unit(r, m));
}

DECK_LIST(stop, .identity = "monitor", .check = check_stop,
          .doc = "Ends the run early, at a sample. Give `below` or `above`.");
