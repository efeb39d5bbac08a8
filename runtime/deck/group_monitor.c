#include "runtime/deck/group_monitor.h"

#include <ctype.h>
#include <string.h>

#include "runtime/base/symmetric_tensor.h"
#include "runtime/deck/deck_check.h"
#include "runtime/deck/deck_value.h"
#include "runtime/deck/lattice_kind.h"

/* --- monitors --------------------------------------------------------------------------------- */

#define X(name, unit, words) "|" #name
#define TIP_CHOICES          (&("" TIP_VALUES(X))[1])
#define COMPONENTS           DECK_COMPONENTS "|xx|yy|zz|xy|yz|xz|kinetic|stored"
enum { WRITTEN_KINETIC = DECK_WRITTEN_COUNT + 6 };

static const deck_key_info monitor_keys[] = {
    {.name = "name",
     .type = DECK_NAME,
     .required = true,
     DECK_AT(monitor, name),
     .doc = "letters, digits and `_`; its name in the result"},
    {.name = "kind",
     .type = DECK_CHOICE,
     .choices = "reaction|displacement|velocity|opening|damaged|broken|field|acceleration|"
                "momentum|angular_momentum|energy|force|moment|tip|tip_speed|stress|"
                "strain|applied|bar_force|slip|contact_force|crack_width|crack",
     .required = true,
     DECK_AT(monitor, kind),
     .doc = "decides which of the next fifteen keys are needed"},
    {.name = "region",
     .type = DECK_NAME,
     DECK_AT(monitor, region),
     .doc =
         "reaction: force that its supports and drives exert on the body, of a rotation the sum of "
         "the couples on its particles, without the moments r x F of forces; applied: sum of what "
         "`&force` and `&end_moment` exert on its particles; displacement, velocity, "
         "acceleration, field, stress, strain: mean; momentum, angular_momentum, "
         "energy, contact_force: of its particles, without it of all; force, moment, bar_force: "
         "only bonds between its particles; tip, tip_speed: only bonds of its particles"},
    {.name = "lattice",
     .type = DECK_NAME,
     .fallback = "= the only one; damaged, broken: all",
     DECK_AT(monitor, lattice),
     .doc = "in place of `region`: the lattice that is watched; bar_force: a bar, slip: a link to "
            "places. Where the deck has several, momentum, angular_momentum, energy, force, "
            "moment, bar_force, contact_force, crack_width, tip, tip_speed, and what is asked `at` "
            "a place, "
            "need one of the two; energies in sum over all are in `energy/...`"},
    {.name = "stamp",
     .type = DECK_NAME,
     DECK_AT(monitor, stamp),
     .doc = "in place of `region`: displacement, velocity: of a stamp; contact_force: that of the "
            "particles on it; moment: that of their forces about its middle"},
    {.name = "between",
     .type = DECK_NAMES,
     DECK_AT(monitor, between),
     .doc = "two regions; opening: mean displacement of the second less that of the first; "
            "reaction, in place of `region`: half the reaction of the second less that of the "
            "first, what the two ends of a specimen carry in the mean"},
    {.name = "component",
     .type = DECK_CHOICE,
     .choices = COMPONENTS,
     DECK_AT(monitor, component),
     .doc = "reaction, applied, displacement, velocity, opening, acceleration, momentum, "
            "contact_force: direction; force: direction, without it along the normal; moment, "
            "angular_momentum: axis, in the plane "
            "`z`, which need not be said; moment in space without it about the normal; energy: "
            "`kinetic` or `stored`; stress, strain: `xx`, `yy`, "
            "`xy`, in space `zz`, `yz`, `xz`, too"},
    {.name = "field",
     .type = DECK_NAME,
     DECK_AT(monitor, field),
     .doc = "field: name of a state, damage or output of the law that stands on particles or at "
            "the points of a mesh"},
    {.name = "crack",
     .type = DECK_NAME,
     DECK_AT(monitor, crack),
     .doc =
         "crack: the name of a crack, of whose tip at the last point the value is; with `/start` "
         "behind it of that at the first, where there are two"},
    {.name = "value",
     .type = DECK_CHOICE,
     .choices = TIP_CHOICES,
     DECK_AT(monitor, value),
     .doc = "crack: which of the tip's values; angles are in radians"},
    {.name = "at",
     .type = DECK_PLACE,
     .unit = "m",
     DECK_AT(monitor, at),
     .doc =
         "acceleration, stress, strain: in place of `region`, of the particle nearest to it, of a "
         "mesh at the place itself, as there displacement and velocity, too; bar_force: of the "
         "bond, slip: of the tied particle nearest to it; force, moment: a "
         "place of the section, which the moment is about; tip, tip_speed: where the crack "
         "begins"},
    {.name = "normal",
     .type = DECK_PLACE,
     .unit = "1",
     DECK_AT(monitor, normal),
     .doc = "force, moment: normal of the section, to the side that acts on the other: tension "
            "along it is "
            "positive"},
    {.name = "direction",
     .type = DECK_PLACE,
     .unit = "1",
     DECK_AT(monitor, direction),
     .doc = "tip, tip_speed: where the crack goes"},
    {.name = "from",
     .type = DECK_PLACE,
     .unit = "m",
     DECK_AT(monitor, from),
     .doc = "crack_width: where the line begins that cracks cut"},
    {.name = "to",
     .type = DECK_PLACE,
     .unit = "m",
     DECK_AT(monitor, to),
     .doc = "crack_width: where it ends"},
    {.name = "about",
     .type = DECK_PLACE,
     .unit = "m",
     .fallback = "= the origin",
     DECK_AT(monitor, about),
     .doc = "angular_momentum: a place of the axis"},
    {.name = "above",
     .type = DECK_REAL,
     .unit = "1",
     .bound = BOUND_NOT_NEGATIVE,
     .fallback = "= 0; broken: 1; crack_width: 0.99; required of a tip",
     DECK_AT(monitor, above),
     .doc = "damaged: bonds with more damage than this are counted (particles, where the law's "
            "damage stands on these alone); broken: those with at least this damage, e.g. 0.999 "
            "for laws whose bonds never separate completely; tip, tip_speed, crack_width: bonds "
            "with more damage than this belong to a crack"},
    {.name = "average",
     .type = DECK_REAL,
     .unit = "s",
     .bound = BOUND_NOT_NEGATIVE,
     .fallback = "0",
     DECK_AT(monitor, average),
     .doc = "mean of all states of this time before each sample, the present one included; of a "
            "velocity way over time, of an acceleration velocity over time; tip_speed: the time "
            "of the straight line that fits the tip's way best; 0: the value at the sample"},
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
  OF_MOTION = 1 << MONITOR_REACTION | 1 << MONITOR_APPLIED | 1 << MONITOR_DISPLACEMENT |
              1 << MONITOR_VELOCITY,
  OF_FIELD = 1 << MONITOR_FIELD,
  OF_PAIR = 1 << MONITOR_OPENING | 1 << MONITOR_REACTIONS,
  OF_DAMAGE = 1 << MONITOR_DAMAGED | 1 << MONITOR_BROKEN,
  OF_TENSOR = 1 << MONITOR_STRESS | 1 << MONITOR_STRAIN,
  OF_POINT = 1 << MONITOR_DISPLACEMENT | 1 << MONITOR_VELOCITY, /* at a place of meshes alone */
  OF_PLACE = OF_TENSOR | OF_POINT | 1 << MONITOR_ACCELERATION,  /* of a region or at a place */
  OF_SECTION = 1 << MONITOR_FORCE | 1 << MONITOR_MOMENT,
  OF_TIP = 1 << MONITOR_TIP | 1 << MONITOR_TIP_SPEED,
  OF_TURNS = 1 << MONITOR_ANGULAR_MOMENTUM,
  OF_ENERGY = 1 << MONITOR_ENERGY,
  OF_BAR = 1 << MONITOR_BAR_FORCE,
  OF_LINK = 1 << MONITOR_SLIP,
  OF_WIDTH = 1 << MONITOR_CRACK_WIDTH,
  OF_CRACK = 1 << MONITOR_CRACK,
  OF_CONTACT = 1 << MONITOR_CONTACT_FORCE,
  OF_SUMS = OF_CONTACT | 1 << MONITOR_MOMENTUM, /* along an axis, in sum */
  OF_PART = OF_TURNS | OF_ENERGY | OF_SUMS,     /* of a region or of all */
  /* of a lattice without a region */
  OF_WHOLE = OF_PLACE | OF_PART | OF_SECTION | OF_TIP | OF_BAR | OF_LINK | OF_WIDTH,
  OF_LATTICE = OF_WHOLE | OF_DAMAGE,
  OF_STAMP_WAY =
      1 << MONITOR_STAMP_DISPLACEMENT | 1 << MONITOR_STAMP_VELOCITY | 1 << MONITOR_STAMP_FORCE,
  OF_STAMP = OF_STAMP_WAY | 1 << MONITOR_STAMP_MOMENT,
  OF_MOVING = OF_MOTION | OF_PAIR | OF_PLACE | OF_TURNS | 1 << MONITOR_MOMENTUM,
  ALONG_AXIS = OF_MOTION | OF_PAIR | 1 << MONITOR_ACCELERATION | OF_SUMS | OF_STAMP_WAY
};
static const char *const monitor_words[] = {"a reaction monitor",
                                            "a displacement monitor",
                                            "a velocity monitor",
                                            "an opening monitor",
                                            "a damaged monitor",
                                            "a broken monitor",
                                            "a field monitor",
                                            "an acceleration monitor",
                                            "a momentum monitor",
                                            "an angular_momentum monitor",
                                            "an energy monitor",
                                            "a force monitor",
                                            "a moment monitor",
                                            "a tip monitor",
                                            "a tip_speed monitor",
                                            "a stress monitor",
                                            "a strain monitor",
                                            "an applied monitor",
                                            "a bar_force monitor",
                                            "a slip monitor",
                                            "a contact_force monitor",
                                            "a crack_width monitor",
                                            "a crack monitor",
                                            "a reaction monitor with `between`",
                                            "a displacement monitor of a stamp",
                                            "a velocity monitor of a stamp",
                                            "a contact_force monitor of a stamp",
                                            "a moment monitor of a stamp"};
static const deck_key_use monitor_uses[] = {
    {"region", OF_MOTION | OF_FIELD | OF_PLACE | OF_PART | OF_SECTION | OF_TIP | OF_BAR, false},
    {"lattice", OF_LATTICE, false},
    {"stamp", OF_STAMP, true},
    {"between", OF_PAIR, true},
    {"component", ALONG_AXIS | OF_ENERGY | OF_TENSOR | OF_TURNS | OF_SECTION | OF_STAMP, false},
    {"field", OF_FIELD, true},
    {"crack", OF_CRACK, true},
    {"value", OF_CRACK, true},
    {"at", OF_PLACE | OF_SECTION | OF_TIP | OF_BAR | OF_LINK, false},
    {"normal", OF_SECTION, true},
    {"direction", OF_TIP, true},
    {"from", OF_WIDTH, true},
    {"to", OF_WIDTH, true},
    {"about", OF_TURNS, false},
    {"above", OF_DAMAGE | OF_TIP | OF_WIDTH, false}};
/* The keys that some kinds need and others may have. */
static const deck_key_use monitor_needs[] = {
    {"region", (OF_MOTION & ~OF_POINT) | OF_FIELD, true},
    {"component", ALONG_AXIS | OF_ENERGY | OF_TENSOR, true},
    {"at", OF_SECTION | OF_TIP, true},
    {"above", OF_TIP, true},
    {"average", 1 << MONITOR_TIP_SPEED, true}};

static bool is_kind(const deck_monitor *item, unsigned kinds) {
  return (kinds >> item->kind & 1u) != 0;
}

static bool has_needs(deck_reader *r, const namelist_group *from, const deck_monitor *item) {
  const char *words = monitor_words[item->kind];
  bool good = true;
  for (size_t k = 0; k < sizeof monitor_needs / sizeof *monitor_needs; k++) {
    const deck_key_use *need = &monitor_needs[k];
    if (!is_kind(item, need->kinds) || namelist_find(from, need->key)) continue;
    diag_report(r->d, DIAG_MISSING_KEY, from->where, "%s needs `%s`", words, need->key);
    good = false;
  }
  return good;
}

static bool is_identifier(const char *name) {
  bool good = isalpha((unsigned char)*name) || *name == '_';
  for (const char *p = name; *p; p++)
    good &= isalnum((unsigned char)*p) || *p == '_';
  return good;
}

bool deck_is_history_name(const deck *k, const char *name) {
  static const char *const taken[] = {"time", "energy", "relaxation_steps", "relaxation_unbalance"};
  if (strcmp(name, "time_step") == 0) return k->simulation.shrink_every > 0;
  return deck_is_one_of(name, taken, (int)(sizeof taken / sizeof *taken));
}

void deck_check_folder_name(deck_reader *r, const char *kind, const deck_item *item,
                            const char *name) {
  if (name && (deck_is_history_name(r->k, name) || strcmp(name, ".") == 0))
    diag_report(r->d, DIAG_RESERVED_NAME, deck_where(item, "name"),
                "a %s cannot be called `%s`: the result has a history of that name", kind, name);
  else if (name && strchr(name, '/'))
    diag_report(r->d, DIAG_BAD_VALUE, deck_where(item, "name"), "a %s's name must not hold `/`",
                kind);
}

/* Cracks, contacts and stamps are folders of histories, beside those of monitors. */
static void check_is_no_folder(deck_reader *r, const deck_monitor *item) {
  const deck *k = r->k;
  const int crack = deck_find_crack(k, item->name), contact = deck_find_contact(k, item->name),
            stamp = deck_find_stamp(k, item->name);
  deck_check_not_both(r, "monitor", &item->item, "crack", item->name,
                      crack < 0 ? NULL : &k->cracks[crack].item);
  deck_check_not_both(r, "monitor", &item->item, "contact", item->name,
                      contact < 0 ? NULL : &k->contacts[contact].item);
  deck_check_not_both(r, "monitor", &item->item, "stamp", item->name,
                      stamp < 0 ? NULL : &k->stamps[stamp].item);
}

static void check_monitor_name(deck_reader *r, const deck_monitor *item) {
  span where = deck_where(&item->item, "name");
  if (deck_is_history_name(r->k, item->name))
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
  check_is_no_folder(r, item);
}

/* Regions overlap: whatever moves others of the same lattice may move particles of this one. */
static bool may_be_moved(const deck_reader *r, const char *region, int component) {
  const int lattice = deck_lattice_of_region(r, region);
  bool moved = lattice < 0;
  for (int k = 0; r->motions && k < r->k->region_count; k++)
    moved = moved || (r->motions[k].of[component].end != 0 &&
                      deck_lattice_of_region(r, r->k->regions[k].name) == lattice);
  return moved;
}

/* Forces come from supports and drives only; without any along the component a reaction is 0 for
 * ever. */
static void check_reaction(deck_reader *r, const deck_monitor *item) {
  const int c = item->component;
  const bool found =
      deck_lacks(r->k, "support") || deck_lacks(r->k, "drive") ||
      (item->region ? may_be_moved(r, item->region, c)
                    : may_be_moved(r, item->between[0], c) || may_be_moved(r, item->between[1], c));
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

/* A line that cracks cut, and the damage that makes them. */
static bool check_line(deck_reader *r, const namelist_group *from, deck_monitor *item) {
  double way[3];
  if (!is_kind(item, OF_WIDTH)) return true;
  if (!namelist_find(from, "above")) item->above = 0.99;
  if (item->above >= 1)
    diag_report(r->d, DIAG_OUT_OF_BOUNDS, deck_where(&item->item, "above"),
                "`above` of a crack must be less than 1: no damage is more");
  for (int a = 0; a < 3; a++)
    way[a] = item->to[a] - item->from[a];
  if (way[0] != 0 || way[1] != 0 || way[2] != 0) return item->above < 1;
  diag_report(r->d, DIAG_OUT_OF_BOUNDS, deck_where(&item->item, "to"),
              "the line has no length: `from` and `to` are the same place");
  return false;
}

static const char *watched_region(const deck_monitor *item) {
  return item->region ? item->region : item->between[0];
}

static int dimensions_of(const deck_reader *r, const deck_monitor *item) {
  const char *region = watched_region(item);
  const int stamp = item->stamp ? deck_find_stamp(r->k, item->stamp) : -1;
  if (item->stamp) return stamp < 0 ? 0 : r->k->stamps[stamp].shape.kind >= SHAPE_BOX ? 3 : 2;
  return region ? deck_dimensions_of_region(r, region) : deck_dimensions_of(r, item->lattice);
}

/* A region says which lattice; without one it must be said where there are several. */
static bool check_lattice(deck_reader *r, const namelist_group *from, const deck_monitor *item) {
  if (item->region && item->lattice) deck_refuse_both(r, from, "region", "lattice");
  if (item->lattice) return deck_lattice_known(r, &item->item, item->lattice) && !item->region;
  if (item->region || !is_kind(item, OF_WHOLE) || r->k->lattice_count < 2) return true;
  diag_report(r->d, DIAG_MISSING_KEY, from->where, "%s needs %s here", monitor_words[item->kind],
              is_kind(item, OF_LINK)    ? "the `lattice` that is the link"
              : is_kind(item, OF_WIDTH) ? "`lattice`"
                                        : "`region` or `lattice`");
  diag_hint(r->d, "the deck has %d lattices%s", r->k->lattice_count,
            is_kind(item, OF_ENERGY) ? "; the result has the sum over all in `energy/...`" : "");
  return false;
}

/* Of a link the bonds are watched: its particles move as others do. */
static void check_moves(deck_reader *r, const deck_monitor *item) {
  const bool kinetic = is_kind(item, OF_ENERGY) && item->component == MONITOR_KINETIC;
  if (!kinetic && !is_kind(item, OF_MOVING)) return;
  if (item->lattice) {
    deck_moves(r, deck_where(&item->item, "lattice"), deck_find_lattice(r->k, item->lattice));
  } else if (item->region) {
    deck_moves(r, deck_where(&item->item, "region"), deck_lattice_of_region(r, item->region));
  }
  for (int end = 0; end < 2 && item->between[end]; end++)
    deck_moves(r, deck_where(&item->item, "between"),
               deck_lattice_of_region(r, item->between[end]));
}

/* One of the two says of which particles. */
static bool check_place(deck_reader *r, const namelist_group *from, const deck_monitor *item) {
  if (!is_kind(item, OF_PLACE)) return true;
  if (item->region && item->placed) deck_refuse_both(r, from, "region", "at");
  if (!item->region && !item->placed)
    diag_report(r->d, DIAG_MISSING_KEY, from->where, "%s needs `region` or `at`",
                monitor_words[item->kind]);
  return !item->region != !item->placed;
}

/* The lattice that it watches; NULL: several, or it is not known which. */
static const deck_lattice *watched_lattice(const deck_reader *r, const deck_monitor *item) {
  const int only = r->k->lattice_count == 1 ? 0 : -1;
  const int found = item->region    ? deck_lattice_of_region(r, item->region)
                    : item->lattice ? deck_find_lattice(r->k, item->lattice)
                                    : only;
  return found < 0 ? NULL : &r->k->lattices[found];
}

static bool some_contact_touches(const deck *k, const deck_lattice *l) {
  for (int n = 0; n < k->contact_count; n++)
    if (deck_lattice_touches(l, &k->contacts[n])) return true;
  for (int n = 0; n < k->stamp_count; n++)
    if (deck_lattice_is_stamped(l, &k->stamps[n])) return true;
  return deck_lacks(k, "contact") || deck_lacks(k, "stamp");
}

/* Some kinds are of bars, of links or of what touches alone. */
static bool check_sort(deck_reader *r, const deck_monitor *item) {
  const deck_lattice *l = watched_lattice(r, item);
  if (l && item->placed && is_kind(item, OF_POINT) && !deck_lattice_is_mesh(l)) {
    diag_report(r->d, DIAG_CONFLICT, deck_where(&item->item, "at"),
                "%s has a place on meshes alone: name a `region` of `%s`",
                monitor_words[item->kind], deck_shown(r->memory, l->name));
    return false;
  }
  if (!l || !is_kind(item, OF_BAR | OF_LINK | OF_CONTACT | OF_WIDTH)) return true;
  const span where = deck_where(&item->item, item->region ? "region" : "lattice");
  const char *name = deck_shown(r->memory, l->name), *word = deck_lattice_word(l);
  if (is_kind(item, OF_BAR) && !deck_lattice_is_chain(l)) {
    diag_report(r->d, DIAG_CONFLICT, where, "`%s` is a %s: a bar_force is that of a bar", name,
                word);
    diag_hint(r->d, "through a section of a lattice acts a `force`");
  } else if (is_kind(item, OF_LINK) && !deck_lattice_is_link(l)) {
    diag_report(r->d, DIAG_CONFLICT, where, "`%s` is a %s: what slips is a link", name, word);
    diag_hint(r->d, "name the link of a bar to the lattice around it");
  } else if (is_kind(item, OF_LINK) && l->to == LINK_TO_SITES) {
    diag_report(r->d, DIAG_CONFLICT, where, "the link `%s` joins sites: it has no slip", name);
    diag_hint(r->d, "with `to = 'place'` the bar slips along the place where it is");
  } else if (is_kind(item, OF_WIDTH) && (deck_lattice_is_link(l) || deck_lattice_is_chain(l))) {
    diag_report(r->d, DIAG_CONFLICT, where,
                "`%s` is a %s: cracks are measured in the lattice around", name,
                deck_lattice_is_link(l) ? "link" : "row of particles");
  } else if (is_kind(item, OF_CONTACT) && !some_contact_touches(r->k, l)) {
    diag_report(r->d, DIAG_CONFLICT, where,
                "this is always 0: by no `&contact` or `&stamp` does `%s` touch", name);
  } else
    return true;
  return false;
}

static bool has_length(deck_reader *r, const deck_item *item, const char *key, const double v[3]) {
  if (v[0] != 0 || v[1] != 0 || v[2] != 0) return true;
  diag_report(r->d, DIAG_OUT_OF_BOUNDS, deck_where(item, key), "`%s` has no direction: it is 0",
              key);
  return false;
}

/* Damage that is never exceeded would never be seen. */
static bool check_tip(deck_reader *r, const deck_monitor *item) {
  if (!is_kind(item, OF_TIP)) return true;
  if (item->above >= 1)
    diag_report(r->d, DIAG_OUT_OF_BOUNDS, deck_where(&item->item, "above"),
                "`above` of a tip must be less than 1: no damage is more");
  if (item->kind == MONITOR_TIP_SPEED && item->average <= 0)
    diag_report(r->d, DIAG_OUT_OF_BOUNDS, deck_where(&item->item, "average"),
                "a speed needs an `average` greater than 0: the time that it is taken over");
  return has_length(r, &item->item, "direction", item->direction) && item->above < 1;
}

/* --- components ------------------------------------------------------------------------------- */

static bool refuse_component(deck_reader *r, const namelist_key *key, const deck_monitor *item,
                             const char *those) {
  diag_report(r->d, DIAG_BAD_VALUE, key->value_where, "%s has no component `%s`",
              monitor_words[item->kind], deck_shown(r->memory, key->values[0].text));
  diag_hint(r->d, "it has %s", those);
  return false;
}

static bool take_energy(deck_reader *r, const namelist_key *key, deck_monitor *item) {
  if (item->component < WRITTEN_KINETIC)
    return refuse_component(r, key, item, "'kinetic' and 'stored'");
  item->component = item->component == WRITTEN_KINETIC ? MONITOR_KINETIC : MONITOR_STORED;
  return true;
}

static bool take_tensor(deck_reader *r, const namelist_key *key, deck_monitor *item,
                        int dimensions) {
  const int found = tensor_find(dimensions, key->values[0].text);
  if (found < 0)
    return refuse_component(r, key, item,
                            dimensions == 2 ? "'xx', 'yy' and 'xy'"
                                            : "'xx', 'yy', 'zz', 'xy', 'yz' and 'xz'");
  item->component = found;
  return true;
}

/* The axis of a moment or an angular momentum; in the plane there is one, in space a section has
   its normal. */
static bool take_axis(deck_reader *r, const namelist_group *from, const namelist_key *key,
                      deck_monitor *item, int dimensions) {
  if (key &&
      (item->component > DECK_WRITTEN_Z || (dimensions == 2 && item->component < DECK_WRITTEN_Z)))
    return refuse_component(r, key, item, dimensions == 2 ? "'z'" : "'x', 'y' and 'z'");
  const bool needed = dimensions == 3 && item->kind != MONITOR_MOMENT;
  if (!key && needed)
    diag_report(r->d, DIAG_MISSING_KEY, from->where, "%s needs `component` in space",
                monitor_words[item->kind]);
  if (!key) item->component = dimensions == 3 ? -1 : DECK_WRITTEN_Z;
  return key || !needed;
}

static bool take_direction(deck_reader *r, const namelist_key *key, deck_monitor *item) {
  const bool turns = item->component >= DECK_WRITTEN_ROTATION,
             in_sum = is_kind(item, OF_SECTION | OF_SUMS | OF_STAMP);
  if (item->component >= DECK_WRITTEN_COUNT || (turns && in_sum))
    return refuse_component(r, key, item,
                            in_sum ? "'x', 'y' and, in space, 'z'"
                                   : "'x', 'y', in space 'z', and of particles that turn "
                                     "'rotation', in space 'rotation_x' and so on");
  const int found = deck_component_in(r, deck_where(&item->item, "component"),
                                      dimensions_of(r, item), item->component);
  if (found >= 0) item->component = found;
  return found >= 0;
}

static bool take_component(deck_reader *r, const namelist_group *from, deck_monitor *item) {
  const namelist_key *key = namelist_find(from, "component");
  const int dimensions = dimensions_of(r, item);
  if (is_kind(item, OF_TURNS | 1 << MONITOR_MOMENT | 1 << MONITOR_STAMP_MOMENT))
    return take_axis(r, from, key, item, dimensions);
  if (!key) {
    item->component = is_kind(item, OF_SECTION) ? -1 : 0;
    return true;
  }
  if (is_kind(item, OF_ENERGY)) return take_energy(r, key, item);
  if (is_kind(item, OF_TENSOR)) return take_tensor(r, key, item, dimensions);
  return take_direction(r, key, item);
}

/* What is watched of a stamp in place of particles. */
static void take_stamp(deck_monitor *item) {
  static const monitor_kind of_stamp[][2] = {{MONITOR_DISPLACEMENT, MONITOR_STAMP_DISPLACEMENT},
                                             {MONITOR_VELOCITY, MONITOR_STAMP_VELOCITY},
                                             {MONITOR_CONTACT_FORCE, MONITOR_STAMP_FORCE},
                                             {MONITOR_MOMENT, MONITOR_STAMP_MOMENT}};
  for (size_t k = 0; k < sizeof of_stamp / sizeof *of_stamp; k++)
    if (item->kind == of_stamp[k][0]) {
      item->kind = of_stamp[k][1];
      return;
    }
}

static void check_monitor(deck_reader *r, const namelist_group *from, void *into) {
  enum { USES = sizeof monitor_uses / sizeof *monitor_uses };
  deck_monitor *item = into;
  const namelist_key *between = namelist_find(from, "between");
  check_monitor_name(r, item);
  if (item->kind == MONITOR_REACTION && between) item->kind = MONITOR_REACTIONS;
  if (item->stamp) take_stamp(item);
  item->placed = namelist_find(from, "at") != NULL;
  const bool whole = has_needs(r, from, item);
  if (!deck_keys_fit(from, monitor_uses, USES, (int)item->kind, monitor_words[item->kind], r->d) ||
      !whole || !check_lattice(r, from, item) || !check_place(r, from, item) ||
      !check_tip(r, item) || !check_line(r, from, item))
    return;
  if (!namelist_find(from, "zero_at")) item->zero_at = -1;
  if (item->kind == MONITOR_BROKEN) check_broken(r, from, item);
  deck_warn_late(r, &item->item, "zero_at", item->zero_at);
  if (item->region) deck_item_region_known(r, &item->item, item->region);
  if (item->stamp && !deck_stamp_known(r, &item->item, item->stamp)) return;
  for (int i = 0; between && i < 2; i++)
    deck_region_known(r, between->values[i].where, item->between[i]);
  const int dimensions = dimensions_of(r, item);
  if (dimensions) deck_check_places(r, from, &deck_group_monitor, dimensions);
  if (is_kind(item, OF_SECTION) && !has_length(r, &item->item, "normal", item->normal)) return;
  if (!check_sort(r, item) || !take_component(r, from, item)) return;
  check_moves(r, item);
  if (item->kind == MONITOR_REACTION || item->kind == MONITOR_REACTIONS) check_reaction(r, item);
}

DECK_LIST(monitor, .identity = "name", .check = check_monitor,
          .doc = "A quantity recorded at every sample of the history.");

/* --- units ------------------------------------------------------------------------------------ */

const char *deck_monitor_unit(const deck_monitor *m, bool rotates) {
  switch (m->kind) {
  case MONITOR_REACTION:
  case MONITOR_REACTIONS:
  case MONITOR_APPLIED:
  case MONITOR_FORCE:
  case MONITOR_BAR_FORCE:
  case MONITOR_CONTACT_FORCE:
  case MONITOR_STAMP_FORCE:
    return rotates ? "N*m" : "N";
  case MONITOR_DISPLACEMENT:
  case MONITOR_OPENING:
  case MONITOR_TIP:
  case MONITOR_SLIP:
  case MONITOR_CRACK_WIDTH:
  case MONITOR_STAMP_DISPLACEMENT:
    return rotates ? "rad" : "m";
  case MONITOR_VELOCITY:
  case MONITOR_TIP_SPEED:
  case MONITOR_STAMP_VELOCITY:
    return rotates ? "rad/s" : "m/s";
  case MONITOR_ACCELERATION:
    return rotates ? "rad/s^2" : "m/s^2";
  case MONITOR_MOMENTUM:
    return "N*s";
  case MONITOR_MOMENT:
  case MONITOR_STAMP_MOMENT:
    return "N*m";
  case MONITOR_ANGULAR_MOMENTUM:
    return "N*m*s";
  case MONITOR_ENERGY:
    return "J";
  case MONITOR_STRESS:
    return "Pa";
  case MONITOR_CRACK:
    return tip_value_units[m->value];
  case MONITOR_STRAIN:
  case MONITOR_DAMAGED:
  case MONITOR_BROKEN:
  case MONITOR_FIELD: /* the law says */
    break;
  }
  return "1";
}

/* Where nobody knows the lattice, it is in the plane. */
static const char *unit_of(const deck_reader *r, const deck_monitor *m) {
  const int dimensions = dimensions_of(r, m) == 3 ? 3 : 2;
  return deck_monitor_unit(m, is_kind(m, ALONG_AXIS) && m->component >= dimensions);
}

/* --- stops ------------------------------------------------------------------------------------ */

/* Of a group: what is so when a monitor's value is below or above a level. */
#define EVENT_KEYS(event, what)                                                                    \
  {.name = "below",                                                                                \
   .type = DECK_LATER,                                                                             \
   .unit = "as the monitor",                                                                       \
   DECK_NOT_KEPT,                                                                                  \
   .doc = what " when its absolute value is less"},                                                \
      {.name = "above",                                                                            \
       .type = DECK_LATER,                                                                         \
       .unit = "as the monitor",                                                                   \
       DECK_NOT_KEPT,                                                                              \
       .doc = what " when its absolute value is more"},                                            \
      {.name = "of",                                                                               \
       .type = DECK_WORD,                                                                          \
       .choices = "peak",                                                                          \
       DECK_NOT_KEPT,                                                                              \
       .doc = "`below` is a fraction of the largest absolute value so far"},                       \
  {                                                                                                \
    .name = "after", .type = DECK_REAL, .unit = "s", .bound = BOUND_NOT_NEGATIVE, .fallback = "0", \
    event, .doc = "not before this time"                                                           \
  }

static const deck_key_info stop_keys[] = {
    {.name = "monitor",
     .type = DECK_NAME,
     .required = true,
     DECK_AT(stop, monitor),
     .doc = "name of the monitor that decides"},
    EVENT_KEYS(DECK_AT(stop, after), "stop"),
};

static const deck_key_info frame_keys[] = {
    {.name = "at",
     .type = DECK_REALS,
     .unit = "s",
     .bound = BOUND_NOT_NEGATIVE,
     DECK_AT(frame, at),
     DECK_COUNT_AT(frame, at_count),
     .doc = "a frame at each of these times"},
    {.name = "monitor",
     .type = DECK_NAME,
     DECK_AT(frame, event.monitor),
     .doc = "in place of `at`: name of the monitor that decides; one frame, of the first sample "
            "when what it waits for holds"},
    EVENT_KEYS(DECK_AT(frame, event.after), "a frame"),
};

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

static void check_event(deck_reader *r, const namelist_group *from, deck_stop *item) {
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
  if (!m->item.faulty) check_level(r, key, item, of ? "1" : unit_of(r, m));
}

static void check_stop(deck_reader *r, const namelist_group *from, void *into) {
  check_event(r, from, into);
}

DECK_LIST(stop, .identity = "monitor", .check = check_stop,
          .doc = "Ends the run early, at a sample. Give `below` or `above`.");

/* --- frames ----------------------------------------------------------------------------------- */

static void check_times(deck_reader *r, const namelist_group *from, const deck_frame *item) {
  static const char *const others[] = {"below", "above", "of", "after"};
  const double end = r->k->simulation.end_time;
  const namelist_key *at = namelist_find(from, "at");
  for (size_t k = 0; k < sizeof others / sizeof *others; k++) {
    const namelist_key *key = namelist_find(from, others[k]);
    if (!key) continue;
    diag_report(r->d, DIAG_CONFLICT, key->name_where, "`%s` goes with `monitor`, not with `at`",
                others[k]);
    diag_hint(r->d, "write a `&frame` of its own for what a monitor decides");
  }
  for (int k = 0; k < item->at_count && k < at->value_count; k++) {
    if (end <= 0 || item->at[k] <= end) continue;
    diag_report(r->d, DIAG_OUT_OF_BOUNDS, at->values[k].where,
                "a frame at %g s would be after the end of the run, %g s", item->at[k], end);
    diag_hint(r->d, "the state at the end of a run is stored in any case");
  }
}

static void check_frame(deck_reader *r, const namelist_group *from, void *into) {
  deck_frame *item = into;
  item->event.item = item->item;
  if (!either(r, from, "at", "monitor")) return;
  if (item->event.monitor)
    check_event(r, from, &item->event);
  else
    check_times(r, from, item);
}

DECK_LIST(frame, .identity = "monitor", .check = check_frame,
          .doc = "Stores a frame beside those of `&output`: at given times, or once, at the first "
                 "sample when a monitor says so. Give `at`, or `monitor` with `below` or `above`.");
