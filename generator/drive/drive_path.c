#include "generator/drive/drive_path.h"

#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

#include "generator/drive/drive_grammar.h"
#include "generator/drive/drive_motion.h"
#include "generator/drive/group_keys.h"
#include "generator/kernel/settings.h"
#include "runtime/deck/deck_load.h"
#include "runtime/deck/deck_set.h"
#include "runtime/deck/deck_value.h"

enum { MOST_CYCLES = 10000, MOST_ERRORS = 50 };
#define LONGEST 1e100 /* s */

/* --- reading one group ------------------------------------------------------------------------ */

typedef struct reader {
  arena *memory;
  source_set *sources;
  diagnostics *d;
  drive_input *in;
} reader;

static bool read_real(const reader *r, const namelist_group *g, const char *name,
                      const char *unit_text, deck_bound bound, double *value) {
  const namelist_key *key = namelist_find(g, name);
  return !key || (deck_values_counted(key, 1, r->d) &&
                  deck_real_read(&key->values[0], name, unit_text, bound, value, r->d));
}

/* --- paths ------------------------------------------------------------------------------------ */

static const char *const quantity_units[] = {
#define X(code, name, unit) unit,
    DRIVE_QUANTITIES(X)
#undef X
};

static const deck_key_use cycle_uses[] = {
    {"period", 1, true}, {"cycles", 1, false}, {"wave", 1, false}, {"rise", 0, false},
    {"times", 0, false}, {"values", 0, false}, {"file", 0, false}};
static const deck_key_use other_uses[] = {
    {"period", 0, false}, {"cycles", 0, false}, {"wave", 0, false}};

static bool read_cycles(const reader *r, const namelist_group *g, const char *unit_text,
                        drive_piece *p) {
  double count = 1;
  if (!deck_keys_fit(g, cycle_uses, 7, 0, "a path of cycles", r->d)) return false;
  if (!namelist_find(g, "value")) {
    diag_report(r->d, DIAG_MISSING_KEY, g->where,
                "a path of cycles needs `value`, their amplitude");
    return false;
  }
  bool good = read_real(r, g, "value", unit_text, BOUND_NONE, &p->amplitude);
  good = read_real(r, g, "period", "s", BOUND_POSITIVE, &p->period) && good;
  good = read_real(r, g, "start", "s", BOUND_NOT_NEGATIVE, &p->start) && good;
  good = read_real(r, g, "cycles", "1", BOUND_POSITIVE, &count) && good;
  const namelist_key *wave = namelist_find(g, "wave");
  int chosen =
      wave ? deck_choice_read(r->memory, wave, "triangle|sine|pulse", r->d) : WAVE_TRIANGLE;
  if (!good || chosen < 0) return false;
  if (count != floor(count) || count > MOST_CYCLES) {
    diag_report(r->d, DIAG_OUT_OF_BOUNDS, namelist_find(g, "cycles")->value_where,
                "`cycles` must be a whole number from 1 to %d", MOST_CYCLES);
    return false;
  }
  p->cyclic = true;
  p->cycles = (int)count;
  p->wave = (drive_wave)chosen;
  return true;
}

/* As a deck's load; a table without `value` holds the values themselves. */
static bool read_load(const reader *r, const namelist_group *g, const char *unit_text,
                      time_function *f) {
  const deck_load_kind kind = {.key = "value", .unit = unit_text, .implied = true};
  if (!deck_keys_fit(g, other_uses, 3, 0, "a path without cycles", r->d)) return false;
  if (!namelist_find(g, "value") && !namelist_find(g, "values") && !namelist_find(g, "file")) {
    diag_report(r->d, DIAG_MISSING_KEY, g->where,
                "`&path` needs `value`, or `times` and `values`, or `file`");
    return false;
  }
  return deck_load_read(r->memory, g, &kind, f, r->d);
}

static bool wants_cycles(const namelist_group *g) {
  const namelist_key *history = namelist_find(g, "history");
  if (!history)
    return namelist_find(g, "period") || namelist_find(g, "cycles") || namelist_find(g, "wave");
  return history->value_count == 1 && history->values[0].kind == NAMELIST_TEXT &&
         strcmp(history->values[0].text, "cycles") == 0;
}

/* Only `times` and `values`, which have its unit. */
static void read_given(const reader *r, const namelist_group *g, const namelist_key *name) {
  static const char *const others[] = {"quantity", "value",  "history", "start", "rise",
                                       "period",   "cycles", "wave",    "file"};
  const namelist_key *values = namelist_find(g, "values");
  drive_given given = {.name_where = name->value_where,
                       .where = values ? values->value_where : g->where};
  static const deck_key_info name_key = {.name = "field", .type = DECK_NAME, .offset = 0};
  deck_quantity q;
  for (size_t k = 0; k < sizeof others / sizeof *others; k++) {
    const namelist_key *other = namelist_find(g, others[k]);
    if (!other) continue;
    diag_report(r->d, DIAG_CONFLICT, other->name_where, "`%s` does not go with `field`", others[k]);
    diag_hint(r->d, "a field is given by `times` and `values`: &path field = 'T' times = 0, 1 "
                    "values = '293 K', '400 K' /");
    return;
  }
  if (!deck_field_read(r->memory, &name_key, name, &given.name, r->d) ||
      !deck_quantity_in_time_read(r->memory, g, &given.f, &q, r->d))
    return;
  for (int k = 0; k < r->in->given_count; k++)
    if (strcasecmp(r->in->given[k].name, given.name) == 0) {
      diag_report(r->d, DIAG_CONFLICT, given.name_where, "the field `%s` has a path already",
                  given.name);
      diag_note(r->d, r->in->given[k].name_where, "it is given here");
      return;
    }
  given.has_unit = q.has_unit;
  given.dim = q.dim;
  r->in->given[r->in->given_count++] = given;
}

static void read_path(const reader *r, const namelist_group *g) {
  drive_piece p = {.where = g->where};
  const deck_group_info *info = drive_grammar.groups[DRIVE_GROUP_path];
  const namelist_key *field = namelist_find(g, "field");
  if (!group_keys_read(r->memory, g, info, &p, r->d)) return;
  if (field) {
    read_given(r, g, field);
    return;
  }
  if (!namelist_find(g, "quantity")) {
    diag_report(r->d, DIAG_MISSING_KEY, g->where, "`&path` needs `quantity` or `field`");
    return;
  }
  int quantity =
      deck_choice_read(r->memory, namelist_find(g, "quantity"), info->keys[0].choices, r->d);
  if (quantity < 0) return;
  p.quantity = (drive_quantity)quantity;
  const char *unit_text = quantity_units[quantity];
  const bool good =
      wants_cycles(g) ? read_cycles(r, g, unit_text, &p) : read_load(r, g, unit_text, &p.f);
  if (good) r->in->pieces[r->in->piece_count++] = p;
}

/* --- expectations ----------------------------------------------------------------------------- */

static bool read_formula(const reader *r, const namelist_key *key, drive_expect *e) {
  const namelist_value *v = &key->values[0];
  if (!deck_values_counted(key, 1, r->d)) return false;
  if (v->kind != NAMELIST_TEXT || !v->text[strspn(v->text, " ")] || strpbrk(v->text, "!\n&")) {
    diag_report(r->d, DIAG_BAD_VALUE, v->where, "`formula` is one expression in quotes");
    diag_hint(r->d, "for example formula = 'EA*S_t'");
    return false;
  }
  e->formula = v->text;
  e->formula_where = v->text_where;
  return true;
}

static void read_expect(const reader *r, const namelist_group *g) {
  drive_expect e = {.at_time = NAN, .at_stretch = NAN};
  deck_defaults(r->memory, drive_grammar.groups[DRIVE_GROUP_expect], &e);
  group_places(r->memory, g, &e.item);
  if (!group_keys_read(r->memory, g, drive_grammar.groups[DRIVE_GROUP_expect], &e, r->d)) return;
  const namelist_key *formula = namelist_find(g, "formula");
  e.value = namelist_find(g, "value");
  e.absolute = namelist_find(g, "absolute");
  if (formula && !read_formula(r, formula, &e)) return;
  if ((e.value != NULL) == (formula != NULL)) {
    diag_report(r->d, formula ? DIAG_CONFLICT : DIAG_MISSING_KEY, g->where, "`&expect` needs %s",
                formula ? "`value` or `formula`, not both" : "`value` or `formula`");
    return;
  }
  if (!isnan(e.at_time) && !isnan(e.at_stretch)) {
    diag_report(r->d, DIAG_CONFLICT, deck_where(&e.item, "at_stretch"),
                "`at_time` and `at_stretch` exclude each other");
    return;
  }
  r->in->expects[r->in->expect_count++] = e;
}

/* --- the file --------------------------------------------------------------------------------- */

static void read_material(const reader *r, const namelist_group *g, int kind, deck_material *m) {
  if (!group_keys_read(r->memory, g, drive_grammar.groups[kind], m, r->d) ||
      !settings_of_group(r->memory, g, m, r->d))
    return;
  group_places(r->memory, g, &m->item);
  const namelist_key *name = kind == DRIVE_GROUP_material ? namelist_find(g, "model") : NULL;
  static const deck_key_info model_key = {.name = "model", .type = DECK_NAME, .offset = 0};
  if (name) deck_field_read(r->memory, &model_key, name, &m->model, r->d);
}

static void read_group(const reader *r, const namelist_group *g, int kind) {
  drive_input *in = r->in;
  switch (kind) {
  case DRIVE_GROUP_simulation:
    group_places(r->memory, g, &in->simulation.item);
    group_keys_read(r->memory, g, drive_grammar.groups[kind], &in->simulation, r->d);
    return;
  case DRIVE_GROUP_bond:
    group_places(r->memory, g, &in->bond.item);
    group_keys_read(r->memory, g, drive_grammar.groups[kind], &in->bond, r->d);
    return;
  case DRIVE_GROUP_particle:
    group_places(r->memory, g, &in->particle.item);
    group_keys_read(r->memory, g, drive_grammar.groups[kind], &in->particle, r->d);
    return;
  case DRIVE_GROUP_point:
    group_places(r->memory, g, &in->point.item);
    group_keys_read(r->memory, g, drive_grammar.groups[kind], &in->point, r->d);
    return;
  case DRIVE_GROUP_output:
    group_places(r->memory, g, &in->output.item);
    group_keys_read(r->memory, g, drive_grammar.groups[kind], &in->output, r->d);
    return;
  case DRIVE_GROUP_material:
    read_material(r, g, kind, &in->material);
    return;
  case DRIVE_GROUP_initial:
    read_material(r, g, kind, &in->initial);
    return;
  case DRIVE_GROUP_path:
    read_path(r, g);
    return;
  default:
    read_expect(r, g);
  }
}

static int find_group(const char *name) {
  for (int k = 0; k < DRIVE_GROUP_COUNT; k++)
    if (strcasecmp(drive_grammar.groups[k]->name, name) == 0) return k;
  return -1;
}

static void read_groups(const reader *r, const namelist *n) {
  const namelist_group *seen[DRIVE_GROUP_COUNT] = {NULL};
  const char *names[DRIVE_GROUP_COUNT];
  for (int k = 0; k < DRIVE_GROUP_COUNT; k++)
    names[k] = drive_grammar.groups[k]->name;
  for (int k = 0; k < n->group_count && r->d->errors <= MOST_ERRORS; k++) {
    const namelist_group *g = &n->groups[k];
    int kind = find_group(g->name);
    if (kind < 0) {
      diag_report(r->d, DIAG_UNKNOWN_GROUP, g->where, "a path has no group `&%s`", g->name);
      deck_suggest(r->d, g->name, names, DRIVE_GROUP_COUNT, "the groups are");
    } else if (drive_grammar.groups[kind]->single && seen[kind]) {
      diag_report(r->d, DIAG_DUPLICATE_NAME, g->where, "a path has one `&%s`", g->name);
      diag_note(r->d, seen[kind]->where, "it is given here");
    } else {
      seen[kind] = g;
      read_group(r, g, kind);
    }
  }
}

static const char *title_of(arena *a, const char *path) {
  const char *slash = strrchr(path, '/'), *name = slash ? slash + 1 : path,
             *dot = strrchr(name, '.');
  return arena_text(a, name, dot && dot > name ? (size_t)(dot - name) : strlen(name));
}

static void check_whole(const reader *r, int file) {
  drive_input *in = r->in;
  if (in->simulation.steps < 1) {
    diag_report(r->d, DIAG_OUT_OF_BOUNDS, deck_where(&in->simulation.item, "steps"),
                "`steps` must be at least 1");
    return;
  }
  if (in->piece_count == 0 && in->given_count == 0 && r->d->errors == 0)
    diag_report(r->d, DIAG_MISSING_KEY, (span){0, 0, (uint16_t)file},
                "there is no `&path`: nothing happens");
  double end = drive_end(in);
  if (!(end < LONGEST)) {
    diag_report(r->d, DIAG_OUT_OF_BOUNDS, (span){0, 0, (uint16_t)file},
                "the path would take %.3g s", end);
    return;
  }
  for (int k = 0; k < in->expect_count; k++)
    if (in->expects[k].at_time > end * (1 + 1e-12)) {
      diag_report(r->d, DIAG_OUT_OF_BOUNDS, deck_where(&in->expects[k].item, "at_time"),
                  "the path ends at %.6g s", end);
    }
}

drive_input *drive_read(arena *a, source_set *sources, int file, const deck_override *overrides,
                        int override_count, diagnostics *d) {
  int errors = d->errors;
  namelist *n = namelist_read(a, sources, file, d);
  deck_set(a, sources, n, &drive_grammar, overrides, override_count, d);
  drive_input *in = arena_alloc(a, sizeof *in);
  reader r = {a, sources, d, in};
  size_t most = (size_t)n->group_count + 1;
  in->path = arena_text(a, sources->items[file].name, strlen(sources->items[file].name));
  in->pieces = arena_alloc(a, most * sizeof *in->pieces);
  in->given = arena_alloc(a, most * sizeof *in->given);
  in->expects = arena_alloc(a, most * sizeof *in->expects);
  deck_defaults(a, drive_grammar.groups[DRIVE_GROUP_simulation], &in->simulation);
  deck_defaults(a, drive_grammar.groups[DRIVE_GROUP_bond], &in->bond);
  deck_defaults(a, drive_grammar.groups[DRIVE_GROUP_particle], &in->particle);
  deck_defaults(a, drive_grammar.groups[DRIVE_GROUP_point], &in->point);
  deck_defaults(a, drive_grammar.groups[DRIVE_GROUP_output], &in->output);
  in->simulation.end_time = in->bond.mass_i = in->bond.mass_j = -1;
  in->material.item.where = in->initial.item.where = (span){0, 0, (uint16_t)file};
  read_groups(&r, n);
  if (!in->simulation.title) in->simulation.title = title_of(a, in->path);
  if (!n->broken && d->errors == errors) check_whole(&r, file);
  return d->errors == errors && !n->broken ? in : NULL;
}
