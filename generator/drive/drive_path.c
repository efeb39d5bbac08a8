/* Reading of a path, and the path as a function of time. */
#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

#include "dsl/base/elementary.h"
#include "generator/drive/drive.h"
#include "generator/kernel/document.h"
#include "generator/kernel/settings.h"
#include "runtime/deck/deck_load.h"
#include "runtime/deck/deck_set.h"
#include "runtime/deck/deck_value.h"

enum { MOST_STEPS = 1000000, MOST_CYCLES = 10000, MOST_ERRORS = 50 };
#define LONGEST 1e100 /* s */

/* --- the groups ------------------------------------------------------------------------------- */

#define AT(type, field) .offset = (long)offsetof(drive_##type, field)
#define NOT_KEPT        .offset = DECK_NO_FIELD
#define LATER(key, unit_text, text)                                                                \
  { .name = key, .type = DECK_LATER, .unit = unit_text, NOT_KEPT, .doc = text }

static const deck_key_info simulation_keys[] = {
    {.name = "title",
     .type = DECK_TEXT,
     .fallback = "= the file's name",
     AT(simulation, title),
     .doc = "for pictures and results"},
    {.name = "end_time",
     .type = DECK_REAL,
     .unit = "s",
     .bound = BOUND_NOT_NEGATIVE,
     .fallback = "= where the last `&path` ends",
     AT(simulation, end_time),
     .doc = "end of the path"},
    {.name = "steps",
     .type = DECK_COUNT,
     .fallback = "1000",
     .most = MOST_STEPS,
     AT(simulation, steps),
     .doc = "even steps; the corners of the path are always met, too"},
};

static const deck_key_info bond_keys[] = {
    {.name = "spacing",
     .type = DECK_REAL,
     .unit = "m",
     .bound = BOUND_POSITIVE,
     .fallback = "'10 mm'",
     AT(bond, spacing),
     .doc = "`s` and `spacing` of the law"},
    {.name = "thickness",
     .type = DECK_REAL,
     .unit = "m",
     .bound = BOUND_POSITIVE,
     .fallback = "'100 mm'",
     AT(bond, thickness),
     .doc = "`t` of the law"},
    {.name = "mass_i",
     .type = DECK_REAL,
     .unit = "kg",
     .bound = BOUND_POSITIVE,
     .fallback = "= from `rho`, as on a hexagonal lattice",
     AT(bond, mass_i),
     .doc = "`m_i`"},
    {.name = "mass_j",
     .type = DECK_REAL,
     .unit = "kg",
     .bound = BOUND_POSITIVE,
     .fallback = "= `mass_i`",
     AT(bond, mass_j),
     .doc = "`m_j`"},
};

static const deck_key_info particle_keys[] = {
    {.name = "lattice",
     .type = DECK_NAME,
     .fallback = "= 'hexagonal'; in space 'fcc' with `shells = 2`",
     AT(particle, lattice),
     .doc = "`'hexagonal'`, `'square'`, `'cubic'` or `'fcc'`"},
    {.name = "spacing",
     .type = DECK_REAL,
     .unit = "m",
     .bound = BOUND_POSITIVE,
     .fallback = "'10 mm'",
     AT(particle, spacing),
     .doc = "of nearest neighbours"},
    {.name = "thickness",
     .type = DECK_REAL,
     .unit = "m",
     .bound = BOUND_POSITIVE,
     .fallback = "'100 mm'",
     AT(particle, thickness),
     .doc = "`t` of the law, in the plane"},
    {.name = "horizon",
     .type = DECK_REAL,
     .unit = "1",
     .bound = BOUND_POSITIVE,
     .fallback = "= by `shells`",
     AT(particle, horizon),
     .doc = "neighbours up to so many spacings away"},
    {.name = "shells",
     .type = DECK_COUNT,
     .fallback = "= the nearest neighbours",
     .most = 64,
     AT(particle, shells),
     .doc = "neighbours of so many shells"},
    {.name = "rotation",
     .type = DECK_ANGLE,
     .fallback = "0",
     AT(particle, rotation),
     .doc = "of the lattice, in degrees"},
};

static const deck_key_info material_keys[] = {
    {.name = "model",
     .type = DECK_NAME,
     .fallback = "= the law on the command line",
     NOT_KEPT,
     .doc = "name or path of the law"},
    {.name = "lattice",
     .type = DECK_NAME,
     NOT_KEPT,
     .doc = "not used; so that a deck's `&material` can be copied"},
};

static const deck_key_info initial_keys[] = {
    LATER("the law's own", "theirs", "e.g. `omega = 0.3`")};

static const deck_key_info path_keys[] = {
    {.name = "quantity",
     .type = DECK_CHOICE,
     .choices = "stretch|theta_i|theta_j|stretch_rate|strain_xx|strain_yy|strain_zz|strain_xy|"
                "strain_yz|strain_xz",
     .required = true,
     NOT_KEPT,
     .doc = "what is prescribed; several `&path` of one quantity add up; the rate is that of the "
            "stretch unless it is given"},
    LATER(
        "value", "as the quantity",
        "full value of a load; amplitude of cycles; factor on `values` and files, 1 if not given"),
    {.name = "history",
     .type = DECK_CHOICE,
     .choices = "constant|ramp|ramp and hold|cosine|table|cycles",
     .fallback = "= by the other keys",
     NOT_KEPT,
     .doc = "how the value is reached, as for the loads of a deck"},
    LATER("start", "s", "0 before; default 0"),
    LATER("rise", "s", "ramp, ramp and hold, cosine: time to the full value"),
    LATER("times", "s", "table: times from `start`; straight lines between"),
    LATER("values", "1", "table: values, times `value`"),
    LATER("period", "s", "cycles: time of one"),
    LATER("cycles", "1", "cycles: how many; default 1"),
    LATER("wave", "",
          "cycles: `'triangle'` (default), `'sine'`, `'pulse'` (up and back to 0, never below)"),
    LATER(
        "file", "",
        "table: two columns of a text file beside this one, times and values, as for the loads of "
        "a deck"),
};

static const deck_key_info output_keys[] = {
    {.name = "csv", .type = DECK_NAME, AT(output, csv), .doc = "path of the table as text"},
    {.name = "hdf5",
     .type = DECK_NAME,
     AT(output, hdf5),
     .doc = "path of the table as a result, for `perilat plot`"},
    {.name = "picture",
     .type = DECK_NAME,
     AT(output, picture),
     .doc = "path of a curve, .png, .svg or .pdf"},
    {.name = "x",
     .type = DECK_NAME,
     .fallback = "= stretch, or the first strain",
     AT(output, x),
     .doc = "column along the picture"},
    {.name = "y",
     .type = DECK_NAME,
     .fallback = "= N, or the first stress",
     AT(output, y),
     .doc = "column up the picture"},
    {.name = "rows",
     .type = DECK_COUNT,
     .fallback = "12",
     .most = MOST_STEPS,
     AT(output, rows),
     .doc = "of the printed table"},
};

static const deck_key_info expect_keys[] = {
    {.name = "quantity",
     .type = DECK_NAME,
     .required = true,
     AT(expect, quantity),
     .doc = "a column, or `'peak N'`, `'lowest N'`, `'final N'`, `'stretch at peak'`, `'omega at "
            "peak M_i'`"},
    {.name = "at_time",
     .type = DECK_REAL,
     .unit = "s",
     .bound = BOUND_NOT_NEGATIVE,
     .fallback = "= the end",
     AT(expect, at_time),
     .doc = "of a column: when"},
    {.name = "at_stretch",
     .type = DECK_REAL,
     .unit = "1",
     .fallback = "= the end",
     AT(expect, at_stretch),
     .doc = "of a column: when the stretch first takes this value"},
    {.name = "after",
     .type = DECK_REAL,
     .unit = "s",
     .bound = BOUND_NOT_NEGATIVE,
     .fallback = "0",
     AT(expect, after),
     .doc = "`at_stretch`: looked for from this time on"},
    LATER("value", "as the quantity", "expected"),
    LATER("formula", "",
          "expected, in the law's language: parameters, constants, and what the row has, e.g. "
          "`'EA*S_t'`"),
    {.name = "tolerance",
     .type = DECK_REAL,
     .unit = "1",
     .bound = BOUND_NOT_NEGATIVE,
     .fallback = "1e-6",
     AT(expect, tolerance),
     .doc = "relative to the expected value"},
    LATER("absolute", "as the quantity", "tolerance; the larger of the two counts; default 0"),
};

/* X(name, single, open, doc) */
#define DRIVE_GROUPS(X)                                                                            \
  X(simulation, true, false, "The drive as a whole.")                                              \
  X(bond, true, false, "The bond that is driven.")                                                 \
  X(particle, true, false, "The particle of a law of families that is driven.")                    \
  X(material, true, true, "The law: every key but `model` sets a parameter or an option.")         \
  X(initial, true, true, "State and damage at the start, where not the law's own.")                \
  X(path, false, false, "What the bond or the particle undergoes. At least one.")                  \
  X(output, true, false, "What is written.")                                                       \
  X(expect, false, false, "What should come out. Give `value` or `formula`.")

enum {
#define X(name, single, open, doc) GROUP_##name,
  DRIVE_GROUPS(X)
#undef X
      GROUP_COUNT
};

static const deck_group_info groups[GROUP_COUNT] = {
#define X(group, once, more, text)                                                                 \
  {.name = #group,                                                                                 \
   .single = once,                                                                                 \
   .open = more,                                                                                   \
   .keys = group##_keys,                                                                           \
   .key_count = (int)(sizeof group##_keys / sizeof *group##_keys),                                 \
   .doc = text},
    DRIVE_GROUPS(X)
#undef X
};

static const deck_group_info *const group_list[GROUP_COUNT] = {
#define X(group, once, more, text) &groups[GROUP_##group],
    DRIVE_GROUPS(X)
#undef X
};

const deck_grammar drive_grammar = {"path", group_list, GROUP_COUNT};

const deck_group_info *drive_group(const char *name) {
  for (int g = 0; g < GROUP_COUNT; g++)
    if (strcmp(groups[g].name, name) == 0) return &groups[g];
  return NULL;
}

/* `path`, `bond`, ...: groups that paths have and decks do not; or the other way round. */
static bool has_own_group(const char *file, bool of_paths) {
  char said[512];
  size_t length;
  char *text = read_text_file(file, NAMELIST_LARGEST_TEXT, &length, said, sizeof said);
  if (!text) return false;
  arena *memory = arena_new();
  source_set sources = {NULL, 0};
  diagnostics unsaid;
  diag_begin(&unsaid, &sources);
  const namelist *n =
      namelist_read(memory, &sources, source_add(&sources, file, text, length), &unsaid);
  bool found = false;
  for (int k = 0; k < n->group_count && !found; k++) {
    const bool in_paths = drive_group(n->groups[k].name),
               in_decks = deck_group_find(n->groups[k].name) >= 0;
    found = of_paths ? in_paths && !in_decks : in_decks && !in_paths;
  }
  diag_clear(&unsaid);
  source_clear(&sources);
  arena_free(memory);
  free(text);
  return found;
}

bool drive_is_path(const char *file) {
  return has_own_group(file, true);
}

bool drive_is_deck(const char *file) {
  return has_own_group(file, false);
}

bool drive_refuse_path(const char *command, const char *file) {
  if (!drive_is_path(file)) return false;
  say_error("`%s` is a path that drives one bond, not a deck for `perilat %s`\n"
            "  perilat drive %s",
            file, command, file);
  return true;
}

static const char *value_words(const deck_key_info *key) {
  if (key->type == DECK_COUNT) return "whole number";
  if (!key->unit || !*key->unit) return "text";
  return unit_is_pure(key->unit) ? "pure number" : key->unit;
}

void drive_reference(FILE *out) {
  for (int g = 0; g < GROUP_COUNT; g++) {
    fprintf(out, "### &%s\n\n%s\n\n| key | value | default | meaning |\n|---|---|---|---|\n",
            groups[g].name, groups[g].doc);
    for (int k = 0; k < groups[g].key_count; k++) {
      const deck_key_info *key = &groups[g].keys[k];
      const char *given = key->required ? "required" : key->fallback ? key->fallback : "";
      fprintf(out, "| `%s` | ", key->name);
      for (const char *c = key->choices ? key->choices : value_words(key); *c; c++)
        fputs(*c == '|' ? ", " : (char[]){*c, 0}, out);
      fprintf(out, " | %s | %s |\n", given[0] == '=' ? given + 2 : given, key->doc);
    }
    fputc('\n', out);
  }
}

/* --- reading one group ------------------------------------------------------------------------ */

typedef struct reader {
  arena *memory;
  source_set *sources;
  diagnostics *d;
  drive_input *in;
} reader;

static void copy_places(arena *a, const namelist_group *from, deck_item *item) {
  deck_key *keys = arena_alloc(a, ((size_t)from->key_count + 1) * sizeof *keys);
  for (int k = 0; k < from->key_count; k++)
    keys[k] = (deck_key){from->keys[k].name, from->keys[k].name_where, from->keys[k].value_where};
  *item = (deck_item){.where = from->where, .keys = keys, .key_count = from->key_count};
}

static void report_unknown(const reader *r, const deck_group_info *info, const namelist_key *key) {
  const char *names[DECK_MOST_KEYS];
  diag_report(r->d, DIAG_UNKNOWN_KEY, key->name_where, "`&%s` has no key `%s`", info->name,
              key->name);
  deck_suggest(r->d, key->name, names, deck_key_names(info, names), "its keys are");
}

/* Reads the keys that the table says how to read. */
static bool read_keys(const reader *r, const namelist_group *from, const deck_group_info *info,
                      void *item) {
  int errors = r->d->errors;
  for (int k = 0; k < from->key_count; k++) {
    const namelist_key *key = &from->keys[k];
    const namelist_key *first = namelist_find(from, key->name);
    int at = deck_key_find(info, key->name);
    if (first != key) {
      diag_report(r->d, DIAG_DUPLICATE_KEY, key->name_where, "`%s` is given twice in this `&%s`",
                  key->name, info->name);
      diag_note(r->d, first->name_where, "it is given here");
    } else if (at < 0 && !info->open) {
      report_unknown(r, info, key);
    } else if (at >= 0 && !key->broken && info->keys[at].offset != DECK_NO_FIELD) {
      deck_field_read(r->memory, &info->keys[at], key, item, r->d);
    }
  }
  for (int k = 0; k < info->key_count; k++)
    if (info->keys[k].required && !namelist_find(from, info->keys[k].name)) {
      diag_report(r->d, DIAG_MISSING_KEY, from->where, "`&%s` has no `%s`", info->name,
                  info->keys[k].name);
      diag_hint(r->d, "%s: %s", info->keys[k].name, info->keys[k].doc);
    }
  return !from->broken && r->d->errors == errors;
}

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
  const deck_load_kind kind = {"value", unit_text, true};
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

static void read_path(const reader *r, const namelist_group *g) {
  drive_piece p = {.where = g->where};
  if (!read_keys(r, g, &groups[GROUP_path], &p)) return;
  int quantity =
      deck_choice_read(r->memory, namelist_find(g, "quantity"), path_keys[0].choices, r->d);
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
  deck_defaults(r->memory, &groups[GROUP_expect], &e);
  copy_places(r->memory, g, &e.item);
  if (!read_keys(r, g, &groups[GROUP_expect], &e)) return;
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
  if (!read_keys(r, g, &groups[kind], m) || !settings_of_group(r->memory, g, m, r->d)) return;
  copy_places(r->memory, g, &m->item);
  const namelist_key *name = kind == GROUP_material ? namelist_find(g, "model") : NULL;
  static const deck_key_info model_key = {.name = "model", .type = DECK_NAME, .offset = 0};
  if (name) deck_field_read(r->memory, &model_key, name, &m->model, r->d);
}

static void read_group(const reader *r, const namelist_group *g, int kind) {
  drive_input *in = r->in;
  switch (kind) {
  case GROUP_simulation:
    copy_places(r->memory, g, &in->simulation.item);
    read_keys(r, g, &groups[kind], &in->simulation);
    return;
  case GROUP_bond:
    copy_places(r->memory, g, &in->bond.item);
    read_keys(r, g, &groups[kind], &in->bond);
    return;
  case GROUP_particle:
    copy_places(r->memory, g, &in->particle.item);
    read_keys(r, g, &groups[kind], &in->particle);
    return;
  case GROUP_output:
    copy_places(r->memory, g, &in->output.item);
    read_keys(r, g, &groups[kind], &in->output);
    return;
  case GROUP_material:
    read_material(r, g, kind, &in->material);
    return;
  case GROUP_initial:
    read_material(r, g, kind, &in->initial);
    return;
  case GROUP_path:
    read_path(r, g);
    return;
  default:
    read_expect(r, g);
  }
}

static int find_group(const char *name) {
  for (int k = 0; k < GROUP_COUNT; k++)
    if (strcasecmp(groups[k].name, name) == 0) return k;
  return -1;
}

static void read_groups(const reader *r, const namelist *n) {
  const namelist_group *seen[GROUP_COUNT] = {NULL};
  const char *names[GROUP_COUNT];
  for (int k = 0; k < GROUP_COUNT; k++)
    names[k] = groups[k].name;
  for (int k = 0; k < n->group_count && r->d->errors <= MOST_ERRORS; k++) {
    const namelist_group *g = &n->groups[k];
    int kind = find_group(g->name);
    if (kind < 0) {
      diag_report(r->d, DIAG_UNKNOWN_GROUP, g->where, "a path has no group `&%s`", g->name);
      deck_suggest(r->d, g->name, names, GROUP_COUNT, "the groups are");
    } else if (groups[kind].single && seen[kind]) {
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
  if (in->piece_count == 0 && r->d->errors == 0)
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
  in->expects = arena_alloc(a, most * sizeof *in->expects);
  deck_defaults(a, &groups[GROUP_simulation], &in->simulation);
  deck_defaults(a, &groups[GROUP_bond], &in->bond);
  deck_defaults(a, &groups[GROUP_particle], &in->particle);
  deck_defaults(a, &groups[GROUP_output], &in->output);
  in->simulation.end_time = in->bond.mass_i = in->bond.mass_j = -1;
  in->material.item.where = in->initial.item.where = (span){0, 0, (uint16_t)file};
  read_groups(&r, n);
  if (!in->simulation.title) in->simulation.title = title_of(a, in->path);
  if (!n->broken && d->errors == errors) check_whole(&r, file);
  return d->errors == errors && !n->broken ? in : NULL;
}

/* --- the path as a function of time ----------------------------------------------------------- */

static double wave_at(const drive_piece *p, double since, bool slope) {
  double cycle = since / p->period, x = cycle - floor(cycle), a = p->amplitude;
  if (since < 0 || cycle >= p->cycles) return 0;
  switch (p->wave) {
  case WAVE_SINE:
    return slope ? a * 2 * M_PI / p->period * pl_cos(2 * M_PI * x) : a * pl_sin(2 * M_PI * x);
  case WAVE_PULSE:
    if (slope) return (x < 0.5 ? 2 : -2) * a / p->period;
    return a * (x < 0.5 ? 2 * x : 2 - 2 * x);
  default:
    if (slope) return (x < 0.25 || x >= 0.75 ? 4 : -4) * a / p->period;
    return a * (x < 0.25 ? 4 * x : x < 0.75 ? 2 - 4 * x : 4 * x - 4);
  }
}

double drive_at(const drive_input *in, drive_quantity q, double time) {
  double sum = 0;
  for (int k = 0; k < in->piece_count; k++) {
    const drive_piece *p = &in->pieces[k];
    if (p->quantity == q)
      sum += p->cyclic ? wave_at(p, time - p->start, false) : time_function_at(&p->f, time);
  }
  return sum;
}

double drive_slope(const drive_input *in, drive_quantity q, double time) {
  double sum = 0;
  for (int k = 0; k < in->piece_count; k++) {
    const drive_piece *p = &in->pieces[k];
    if (p->quantity == q)
      sum += p->cyclic ? wave_at(p, time - p->start, true) : time_function_slope(&p->f, time);
  }
  return sum;
}

bool drive_prescribes(const drive_input *in, drive_quantity q) {
  for (int k = 0; k < in->piece_count; k++)
    if (in->pieces[k].quantity == q) return true;
  return false;
}

/* --- times ------------------------------------------------------------------------------------ */

static long corner_count(const drive_piece *p) {
  return p->cyclic ? 4L * p->cycles + 1 : p->f.shape == TIME_TABLE ? p->f.count + 1L : 2;
}

static double corner(const drive_piece *p, long k) {
  if (p->cyclic) return p->start + (double)k * (p->period / 4);
  if (p->f.shape == TIME_TABLE) return k ? p->f.start + p->f.times[k - 1] : p->f.start;
  return k && p->f.shape != TIME_CONSTANT ? p->f.start + p->f.rise : p->f.start;
}

double drive_end(const drive_input *in) {
  double end = 0;
  if (in->simulation.end_time >= 0) return in->simulation.end_time;
  for (int k = 0; k < in->piece_count; k++)
    end = pl_fmax(end, corner(&in->pieces[k], corner_count(&in->pieces[k]) - 1));
  return end;
}

static int by_size(const void *a, const void *b) {
  double x = *(const double *)a, y = *(const double *)b;
  return (x > y) - (x < y);
}

/* Sorted, within [0, end], no two closer than rounding. */
static long clean(double *t, long count, double end) {
  long kept = 0;
  qsort(t, (size_t)count, sizeof *t, by_size);
  for (long k = 0; k < count; k++)
    if (t[k] >= 0 && t[k] <= end && (kept == 0 || t[k] - t[kept - 1] > 1e-12 * end))
      t[kept++] = t[k];
  return kept;
}

double *drive_corners(const drive_input *in, long *count) {
  long most = 0, n = 0;
  for (int k = 0; k < in->piece_count; k++)
    most += corner_count(&in->pieces[k]);
  double *t = must_alloc((size_t)(most + 1) * sizeof *t);
  for (int k = 0; k < in->piece_count; k++)
    for (long c = 0; c < corner_count(&in->pieces[k]); c++)
      t[n++] = corner(&in->pieces[k], c);
  *count = clean(t, n, drive_end(in));
  return t;
}

double *drive_times(const drive_input *in, long *count) {
  const double end = drive_end(in);
  long n;
  double *corners = drive_corners(in, &n);
  double *t =
      must_realloc(corners, (size_t)(n + in->simulation.steps + in->expect_count + 1L) * sizeof *t);
  for (int k = 0; k <= in->simulation.steps; k++)
    t[n++] = end * k / in->simulation.steps;
  for (int k = 0; k < in->expect_count; k++) {
    const drive_expect *e = &in->expects[k];
    double at =
        isnan(e->at_stretch) ? e->at_time : drive_time_of_stretch(in, e->at_stretch, e->after);
    if (!isnan(at)) t[n++] = at;
  }
  *count = clean(t, n, end);
  return t;
}

/* The path between even steps and corners is smooth: signs change there once, and bisection finds
 * where. */
double drive_time_of_stretch(const drive_input *in, double stretch, double after) {
  drive_input plain = *in;
  long count;
  plain.expect_count = 0;
  double *t = drive_times(&plain, &count), found = NAN;
  for (long k = 0; k < count && isnan(found); k++) {
    double high = t[k], low = k ? pl_fmax(t[k - 1], after) : high;
    if (high < after) continue;
    double a = drive_at(in, DRIVE_STRETCH, low) - stretch,
           b = drive_at(in, DRIVE_STRETCH, high) - stretch;
    if (a == 0 || b == 0) found = a == 0 ? low : high;
    if (a * b >= 0) continue;
    for (int halving = 0; halving < 80; halving++) {
      double middle = 0.5 * (low + high), c = drive_at(in, DRIVE_STRETCH, middle) - stretch;
      if ((c > 0) == (a > 0))
        low = middle;
      else
        high = middle;
    }
    found = 0.5 * (low + high);
  }
  free(t);
  return found;
}
