#include "generator/exercise/exercise_grammar.h"

#include "dsl/base/units.h"

enum { MOST_POINTS = 100000, MOST_MINUTES = 100000, MOST_STATES = 100000 };

#define AT(type, field) .offset = (long)offsetof(type, field)
#define COUNT_AT(field) .count_offset = (long)offsetof(exercise_item, field)

static const deck_key_info exercise_keys[] = {
    {.name = "title",
     .type = DECK_TEXT,
     .fallback = "= the folder's name",
     AT(exercise, title),
     .doc = "of reports"},
    {.name = "minutes",
     .type = DECK_COUNT,
     .fallback = "0",
     .most = MOST_MINUTES,
     AT(exercise, minutes),
     .doc = "that it is meant to take"},
    {.name = "points",
     .type = DECK_COUNT,
     .fallback = "100",
     .most = MOST_POINTS,
     AT(exercise, points),
     .doc = "what those of all items add up to"},
};

static const deck_key_info item_keys[] = {
    {.name = "kind",
     .type = DECK_CHOICE,
     .choices = "check|path|sample|implied|run|answers|hand",
     .required = true,
     AT(exercise_item, kind),
     .doc = "what is judged"},
    {.name = "title",
     .type = DECK_NAME,
     .fallback = "= by kind and file",
     AT(exercise_item, title),
     .doc = "of reports; no two items have the same"},
    {.name = "points",
     .type = DECK_COUNT,
     .required = true,
     .most = MOST_POINTS,
     AT(exercise_item, points),
     .doc = "of the item; of several files evenly"},
    {.name = "hidden",
     .type = DECK_LOGICAL,
     .fallback = ".false.",
     AT(exercise_item, hidden),
     .doc = "students know it by title alone; what needs the teacher's folder always is"},
    {.name = "show",
     .type = DECK_CHOICE,
     .choices = "nothing|words|state|curve",
     .fallback = "'state'",
     AT(exercise_item, show),
     .doc =
         "what is said of a wrong answer: points alone; words; the first state that differs, "
         "too; both curves in the page of --html, too (of public paths always, but for 'words')"},
    {.name = "file",
     .type = DECK_NAMES,
     AT(exercise_item, files),
     COUNT_AT(file_count),
     .doc = "paths, a deck or a table of answers, in the exercise's folder or in teacher/; the "
            "last part of a name may hold `*` and `?`"},
    {.name = "against",
     .type = DECK_CHOICE,
     .choices = "reference|expectations",
     .fallback = "= 'reference'; of public paths that expect something 'expectations'",
     AT(exercise_item, against),
     .doc = "path: the solution's table on the same path, or what the path expects"},
    {.name = "tolerance",
     .type = DECK_REAL,
     .unit = "1",
     .bound = BOUND_NOT_NEGATIVE,
     .fallback = "= 1e-6; of `run` 0.05, of `answers` 0.01",
     AT(exercise_item, tolerance),
     .doc = "relative"},
    {.name = "energies",
     .type = DECK_LOGICAL,
     .fallback = ".true.",
     AT(exercise_item, energies),
     .doc = "path, sample: energies are compared, not forces alone"},
    {.name = "states",
     .type = DECK_COUNT,
     .fallback = "200",
     .most = MOST_STATES,
     AT(exercise_item, states),
     .doc = "sample: how many"},
    {.name = "vary",
     .type = DECK_NAMES,
     AT(exercise_item, vary),
     COUNT_AT(vary_count),
     .doc = "sample: parameters that vary, `s` and `t` among them"},
    {.name = "within",
     .type = DECK_PAIR,
     .unit = "1",
     .bound = BOUND_POSITIVE,
     .fallback = "0.5, 2",
     AT(exercise_item, within),
     .doc = "sample: factors between which they vary"},
    {.name = "seed",
     .type = DECK_LATER,
     .offset = DECK_NO_FIELD,
     .fallback = "1",
     .doc = "sample: a number, or `'student'`: others for each answer, the same wherever its file "
            "lies"},
    {.name = "quantity",
     .type = DECK_WORD,
     .choices = "E|nu|G|stable_step|omega_max|peak_stress|work_of_fracture|crack_energy",
     AT(exercise_item, quantity),
     .doc = "implied: what follows on a lattice, as `perilat info` tells it (along x)"},
    {.name = "set",
     .type = DECK_NAMES,
     AT(exercise_item, set),
     COUNT_AT(set_count),
     .doc = "implied: parameters (`'nu=0.1'`), `s` and `t` among them; run: keys of the deck "
            "(`'lattice.spacing=10 mm'`)"},
    {.name = "like",
     .type = DECK_NAMES,
     AT(exercise_item, like),
     COUNT_AT(like_count),
     .doc = "run: the same run with this set, too, must agree with it"},
    {.name = "monitor",
     .type = DECK_NAME,
     .fallback = "'load'",
     AT(exercise_item, monitor),
     .doc = "run: which of the deck's"},
    {.name = "of",
     .type = DECK_NAME,
     AT(exercise_item, of),
     .doc = "check: `'reads'`, `'physics'`, both if not given; run: `'peak'` (default), `'last'`, "
            "`'at peak'`, `'imbalance'`, `'dissipated'`"},
    {.name = "at",
     .type = DECK_NAME,
     .fallback = "'load'",
     AT(exercise_item, at),
     .doc = "run, `'at peak'`: the monitor whose peak it is"},
    {.name = "material",
     .type = DECK_NAME,
     AT(exercise_item, material),
     .doc = "run: the lattice, bar or link whose law the answer is; the only one if not given"},
    {.name = "value",
     .type = DECK_LATER,
     .offset = DECK_NO_FIELD,
     .unit = "as the quantity",
     .doc = "implied, run: expected; the solution's if not given"},
};

static const deck_group_info groups[EXERCISE_GROUP_COUNT] = {
    {.name = "exercise",
     .single = true,
     .keys = exercise_keys,
     .key_count = (int)(sizeof exercise_keys / sizeof *exercise_keys),
     .doc = "The exercise as a whole."},
    {.name = "item",
     .keys = item_keys,
     .key_count = (int)(sizeof item_keys / sizeof *item_keys),
     .doc = "One thing that is judged. At least one."},
};
_Static_assert(sizeof item_keys / sizeof *item_keys <= DECK_MOST_KEYS, "too many keys");

static const deck_group_info *const group_list[EXERCISE_GROUP_COUNT] = {&groups[0], &groups[1]};

const deck_grammar exercise_grammar = {"exercise", group_list, EXERCISE_GROUP_COUNT};

const char *const item_kind_names[ITEM_KIND_COUNT] = {
#define X(code, name) name,
    ITEM_KINDS(X)
#undef X
};

static const char *value_words(const deck_key_info *key) {
  if (key->type == DECK_COUNT) return "whole number";
  if (key->type == DECK_LOGICAL) return ".true., .false.";
  if (key->type == DECK_PAIR) return "two pure numbers";
  if (!key->unit || !*key->unit) return key->type == DECK_NAMES ? "texts" : "text";
  return unit_is_pure(key->unit) ? "pure number" : key->unit;
}

void exercise_reference(FILE *out) {
  for (int g = 0; g < EXERCISE_GROUP_COUNT; g++) {
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
