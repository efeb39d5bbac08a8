#include "runtime/deck/deck_value.h"

#include <assert.h>
#include <ctype.h>
#include <limits.h>
#include <math.h>
#include <string.h>

#include "dsl/base/unit_hint.h"
#include "dsl/base/units.h"
#include "runtime/base/symmetric_tensor.h"

enum { LONGEST_SHOWN = 60, LONGEST_LIST = 400, MOST_CHOICES = 32 };

/* --- showing ---------------------------------------------------------------------------------- */

/* Bytes of `text` that a message shows; a cut does not split a character. */
static int shown_length(const char *text, size_t length) {
  if (length <= LONGEST_SHOWN) return (int)length;
  int shown = LONGEST_SHOWN;
  while (shown > 0 && ((unsigned char)text[shown] & 0xC0) == 0x80)
    shown--;
  return shown;
}

const char *deck_shown(arena *a, const char *text) {
  size_t length = strlen(text);
  int shown = shown_length(text, length);
  return (size_t)shown == length ? text : arena_printf(a, "%.*s...", shown, text);
}

void deck_suggest(diagnostics *d, const char *name, const char *const *names, int count,
                  const char *intro) {
  char words[256];
  const char *nearest = nearest_name(name, names, count);
  if (tensor_traced(name, names, count, words, sizeof words)) {
    diag_hint(d, "%s", words);
    return;
  }
  if (nearest) {
    diag_hint(d, "did you mean `%s`?", nearest);
    return;
  }
  char list[LONGEST_LIST];
  size_t used = 0;
  for (int i = 0; i < count; i++) {
    int more = snprintf(list + used, sizeof(list) - used, "%s`%s`", i ? ", " : "", names[i]);
    if (more < 0 || used + (size_t)more >= sizeof(list)) return; /* too many to be of help */
    used += (size_t)more;
  }
  if (used) diag_hint(d, "%s %s", intro, list);
}

/* "a length", without the unit that dim_describe adds in parentheses. */
static void describe(dimension dim, char *text, size_t size) {
  dim_describe(dim, text, size);
  char *parenthesis = strstr(text, " (");
  if (parenthesis) *parenthesis = '\0';
}

static const char *kind_words(namelist_kind kind) {
  return kind == NAMELIST_NUMBER ? "a number"
         : kind == NAMELIST_TEXT ? "a text"
                                 : "a logical value";
}

static bool report_kind(const namelist_value *v, const char *key, const char *wanted,
                        diagnostics *d) {
  diag_report(d, DIAG_BAD_VALUE, v->where, "`%s` is %s, but this is %s", key, wanted,
              kind_words(v->kind));
  return false;
}

/* --- keys that depend on a choice ------------------------------------------------------------- */

static void hint_uses(const deck_key_use *uses, int count, int kind, const char *words,
                      diagnostics *d) {
  char list[LONGEST_LIST] = "";
  size_t used = 0;
  for (int i = 0; i < count; i++) {
    if (!(uses[i].kinds & 1u << kind)) continue;
    int more = snprintf(list + used, sizeof(list) - used, "%s`%s`", used ? ", " : "", uses[i].key);
    if (more < 0 || used + (size_t)more >= sizeof(list)) return;
    used += (size_t)more;
  }
  if (used) diag_hint(d, "%s has %s", words, list);
}

bool deck_keys_fit(const namelist_group *g, const deck_key_use *uses, int count, int kind,
                   const char *words, diagnostics *d) {
  bool good = true;
  for (int i = 0; i < count; i++) {
    const namelist_key *key = namelist_find(g, uses[i].key);
    bool belongs = uses[i].kinds & 1u << kind;
    if (key && !belongs) {
      diag_report(d, DIAG_UNKNOWN_KEY, key->name_where, "`%s` does not go with %s", key->name,
                  words);
      hint_uses(uses, count, kind, words, d);
      good = false;
    } else if (!key && belongs && uses[i].required) {
      diag_report(d, DIAG_MISSING_KEY, g->where, "%s needs `%s`", words, uses[i].key);
      good = false;
    }
  }
  return good;
}

/* --- quantities ------------------------------------------------------------------------------- */

/* A part of a text value as a span; the whole value where doubled quotes have shifted it. */
static span part(const namelist_value *v, const char *from, size_t length) {
  uint32_t size = v->text_where.end - v->text_where.begin;
  if (size != strlen(v->text)) return v->where;
  uint32_t begin = v->text_where.begin + (uint32_t)(from - v->text);
  return (span){begin, begin + (uint32_t)length, v->where.file};
}

/* Something of x, y, z, t. */
static bool looks_like_formula(const char *text) {
  for (const char *p = text; *p; p++) {
    const bool begins = p == text || !(isalnum((unsigned char)p[-1]) || p[-1] == '_');
    const bool ends = !(isalnum((unsigned char)p[1]) || p[1] == '_');
    if (begins && ends && strchr("xyzt", *p)) return true;
  }
  return false;
}

static bool report_unit(const namelist_value *v, const char *bad, size_t length, diagnostics *d) {
  diag_report(d, DIAG_UNKNOWN_UNIT, part(v, bad, length), "there is no unit `%.*s`",
              shown_length(bad, length), bad);
  if (looks_like_formula(v->text))
    diag_hint(d,
              "in a formula units stand in brackets, 100 [GPa]*(1 + x/1 [m]); that of a load goes "
              "into `formula`");
  else if (!unit_hint(d, bad, length))
    diag_hint(d, "a value in quotes is one number and its unit, e.g. '6.35 mm' or '1000 1/s'");
  return false;
}

static bool too_large(const namelist_value *v, const char *key, diagnostics *d) {
  diag_report(d, DIAG_BAD_NUMBER, v->where, "the value of `%s` is too large", key);
  return false;
}

static bool text_quantity(const namelist_value *v, const char *key, deck_quantity *q,
                          diagnostics *d) {
  const char *p = v->text + strspn(v->text, " \t");
  size_t length = strlen(p);
  while (length > 0 && strchr(" \t", p[length - 1]))
    length--;
  double number;
  size_t used = namelist_number(p, length, &number);
  if (used == 0) {
    diag_report(d, DIAG_BAD_VALUE, v->where, "`%s` must be a number, or a number with a unit", key);
    return false;
  }
  const char *rest = p + used;
  rest += strspn(rest, " \t");
  length -= (size_t)(rest - p) < length ? (size_t)(rest - p) : length;
  *q = (deck_quantity){.value = number, .has_unit = length > 0};
  unit u = {.factor = 1};
  const char *bad;
  size_t bad_length;
  if (q->has_unit && !unit_parse(rest, length, &u, &bad, &bad_length))
    return report_unit(v, bad, bad_length, d);
  q->value = number * u.factor;
  q->dim = u.dim;
  return isfinite(q->value) || too_large(v, key, d);
}

bool deck_quantity_read(const namelist_value *v, const char *key, deck_quantity *q,
                        diagnostics *d) {
  *q = (deck_quantity){.value = v->number};
  if (v->kind == NAMELIST_LOGICAL) return report_kind(v, key, "a number", d);
  return v->kind == NAMELIST_NUMBER || text_quantity(v, key, q, d);
}

/* False, with a message that names both dimensions, unless the quantity fits `unit`. */
static bool quantity_fits(const namelist_value *v, const char *key, const deck_quantity *q,
                          const char *unit_text, diagnostics *d) {
  dimension wanted = dimension_of(unit_text);
  char wanted_words[128], words[128];
  describe(wanted, wanted_words, sizeof(wanted_words));
  if (strcmp(unit_text, "N*m") == 0) snprintf(wanted_words, sizeof(wanted_words), "a moment");
  if (q->has_unit && !dim_equal(q->dim, wanted)) {
    describe(q->dim, words, sizeof(words));
    diag_report(d, DIAG_UNITS, v->where, "`%s` is %s; `%.*s` is %s", key, wanted_words,
                shown_length(v->text, strlen(v->text)), v->text, words);
    return false;
  }
  if (v->kind == NAMELIST_TEXT && !q->has_unit && !dim_is_none(wanted)) {
    diag_report(d, DIAG_UNITS, v->where, "`%s` is %s, but this text has no unit", key,
                wanted_words);
    diag_hint(d, "write '%g %s', or the number without quotes", q->value, unit_text);
    return false;
  }
  return true;
}

/* Masses, stiffnesses and energies are products of what a deck gives: each factor must leave room
   for the others, or they are 0 or infinite. */
static const double least_size = 1e-40, most_size = 1e40;

static bool computable(const namelist_value *v, const char *key, double value,
                       const char *unit_text, deck_bound bound, diagnostics *d) {
  const bool pure = strcmp(unit_text, "1") == 0;
  const bool may_vanish =
      bound == BOUND_NONE || bound == BOUND_NOT_NEGATIVE || (pure && bound == BOUND_POSITIVE);
  const bool small = !may_vanish && value > 0 && value < least_size;
  if (!small && fabs(value) <= most_size) return true;
  diag_report(d, DIAG_OUT_OF_BOUNDS, v->where, "`%s` is too %s to compute with: %s is %g%s%s", key,
              small ? "small" : "large", small ? "the least" : "the most",
              small ? least_size : most_size, pure ? "" : " ", pure ? "" : unit_text);
  return false;
}

static bool within(const namelist_value *v, const char *key, double value, deck_bound bound,
                   diagnostics *d) {
  bool good = bound == BOUND_POSITIVE       ? value > 0
              : bound == BOUND_NOT_NEGATIVE ? value >= 0
              : bound == BOUND_FRACTION     ? value > 0 && value <= 1
                                            : true;
  if (good) return true;
  diag_report(d, DIAG_OUT_OF_BOUNDS, v->where, "`%s` must %s", key,
              bound == BOUND_POSITIVE       ? "be greater than 0"
              : bound == BOUND_NOT_NEGATIVE ? "not be negative"
                                            : "be greater than 0 and at most 1");
  return false;
}

bool deck_real_read(const namelist_value *v, const char *key, const char *unit_text,
                    deck_bound bound, double *value, diagnostics *d) {
  deck_quantity q;
  if (!deck_quantity_read(v, key, &q, d) || !quantity_fits(v, key, &q, unit_text, d)) return false;
  *value = q.value;
  return within(v, key, q.value, bound, d) && computable(v, key, q.value, unit_text, bound, d);
}

/* --- typed fields ----------------------------------------------------------------------------- */

static bool all_numbers(const namelist_key *key) {
  for (int i = 0; i < key->value_count; i++)
    if (key->values[i].kind != NAMELIST_NUMBER) return false;
  return true;
}

bool deck_values_counted(const namelist_key *key, int count, diagnostics *d) {
  if (key->value_count == count) return true;
  const char *one = count == 1 ? "" : "s";
  diag_report(d, DIAG_BAD_VALUE, key->value_where, "`%s` takes %d value%s, but %d %s given",
              key->name, count, one, key->value_count, key->value_count == 1 ? "is" : "are");
  if (key->value_count == 2 * count && all_numbers(key))
    diag_hint(d, "decimals are written with a point, not a comma");
  return false;
}

static bool text_value(arena *a, const namelist_value *v, const char *key, bool may_be_empty,
                       const char **text, diagnostics *d) {
  if (v->kind != NAMELIST_TEXT) return report_kind(v, key, "a text", d);
  size_t length = strlen(v->text);
  while (length > 0 && v->text[length - 1] == ' ') /* blanks at the end mean nothing in Fortran */
    length--;
  if (length > 0 || may_be_empty) {
    *text = arena_text(a, v->text, length);
    return true;
  }
  diag_report(d, DIAG_BAD_VALUE, v->where, "`%s` must not be empty", key);
  return false;
}

static int choice_of(arena *a, const namelist_value *v, const char *key, const char *choices,
                     diagnostics *d) {
  const char *words[MOST_CHOICES], *text;
  int count = deck_choices(a, choices, words, MOST_CHOICES);
  if (!text_value(a, v, key, false, &text, d)) return -1;
  for (int i = 0; i < count; i++)
    if (strcmp(words[i], text) == 0) return i;
  diag_report(d, DIAG_BAD_VALUE, v->where, "`%s` cannot be `%s`", key, deck_shown(a, text));
  deck_suggest(d, text, words, count, count == 1 ? "it can only be" : "it is one of");
  return -1;
}

int deck_choice_read(arena *a, const namelist_key *key, const char *choices, diagnostics *d) {
  if (!deck_values_counted(key, 1, d)) return -1;
  return choice_of(a, &key->values[0], key->name, choices, d);
}

static bool read_fixed(arena *a, const deck_key_info *info, const namelist_key *key, int *bits,
                       diagnostics *d) {
  static const int meaning[] = {1,         2, 4,  1 | 2, 1 | 4, 2 | 4,
                                1 | 2 | 4, 8, 16, 32,    64}; /* as info->choices */
  for (int i = 0; i < key->value_count; i++) {
    int choice = choice_of(a, &key->values[i], info->name, info->choices, d);
    if (choice < 0) return false;
    *bits |= meaning[choice];
  }
  return true;
}

static bool read_count(const deck_key_info *info, const namelist_value *v, int *count,
                       diagnostics *d) {
  if (v->kind != NAMELIST_NUMBER) return report_kind(v, info->name, "a whole number", d);
  if (v->number != floor(v->number) || v->number < 0 || v->number > info->most) {
    diag_report(d, DIAG_OUT_OF_BOUNDS, v->where, "`%s` must be a whole number from 0 to %d",
                info->name, info->most);
    return false;
  }
  *count = (int)v->number;
  return true;
}

/* '100 periods' */
static bool is_of_periods(const namelist_value *v, double *periods) {
  if (v->kind != NAMELIST_TEXT) return false;
  const char *p = v->text + strspn(v->text, " \t");
  const size_t used = namelist_number(p, strlen(p), periods);
  p += used + strspn(p + used, " \t");
  const size_t length = strcspn(p, " \t");
  const bool named = (length == 7 && strncmp(p, "periods", length) == 0) ||
                     (length == 6 && strncmp(p, "period", length) == 0);
  return used > 0 && named && p[length + strspn(p + length, " \t")] == '\0';
}

static bool read_end(const deck_key_info *info, const namelist_key *key, char *item,
                     diagnostics *d) {
  const namelist_value *v = &key->values[0];
  double value = 0;
  if (!deck_values_counted(key, 1, d)) return false;
  const bool periods = is_of_periods(v, &value);
  const bool good = periods ? isfinite(value)
                                  ? within(v, info->name, value, info->bound, d) &&
                                        computable(v, info->name, value, "1", BOUND_NOT_NEGATIVE, d)
                                  : too_large(v, info->name, d)
                            : deck_real_read(v, info->name, info->unit, info->bound, &value, d);
  if (good) memcpy(item + (periods ? info->count_offset : info->offset), &value, sizeof value);
  return good;
}

enum { MOST_TURNS = 1000 }; /* more have lost digits that matter */

static bool read_angle(const deck_key_info *info, const namelist_value *v, double *angle,
                       diagnostics *d) {
  deck_quantity q;
  if (!deck_quantity_read(v, info->name, &q, d)) return false;
  *angle = q.has_unit ? q.value : q.value * (M_PI / 180);
  if (v->kind == NAMELIST_TEXT && !q.has_unit) {
    diag_report(d, DIAG_UNITS, v->where, "`%s` is an angle, but this text has no unit", info->name);
    diag_hint(d, "write '%g deg', or the number without quotes", q.value);
    return false;
  }
  if (dim_is_none(q.dim) && fabs(*angle) <= MOST_TURNS * 2 * M_PI) return true;
  if (dim_is_none(q.dim)) {
    diag_report(d, DIAG_OUT_OF_BOUNDS, v->where, "`%s` must be at most %d turns", info->name,
                MOST_TURNS);
    diag_hint(d, "leave out whole turns");
    return false;
  }
  char words[128];
  describe(q.dim, words, sizeof(words));
  diag_report(d, DIAG_UNITS, v->where, "`%s` is an angle; `%.*s` is %s", info->name,
              shown_length(v->text, strlen(v->text)), v->text, words);
  diag_hint(d, "write degrees, or e.g. '17 deg', '0.3 rad'");
  return false;
}

static bool read_reals(const deck_key_info *info, const namelist_key *key, double *values,
                       diagnostics *d) {
  for (int i = 0; i < key->value_count; i++)
    if (!deck_real_read(&key->values[i], info->name, info->unit, info->bound, &values[i], d))
      return false;
  return true;
}

static bool read_names(arena *a, const deck_key_info *info, const namelist_key *key,
                       const char **names, diagnostics *d) {
  for (int i = 0; i < key->value_count; i++) {
    if (!text_value(a, &key->values[i], info->name, false, &names[i], d)) return false;
    for (int k = 0; k < i; k++) {
      if (strcmp(names[k], names[i]) != 0) continue;
      diag_report(d, DIAG_DUPLICATE_NAME, key->values[i].where, "`%s` names `%s` twice", info->name,
                  deck_shown(a, names[i]));
      return false;
    }
  }
  return true;
}

/* A list of any length and, in the structure, its count. */
static bool read_list(arena *a, const deck_key_info *info, const namelist_key *key, char *item,
                      diagnostics *d) {
  enum { MOST_NAMES = 1000 };
  size_t count = (size_t)key->value_count;
  void *list = arena_alloc(a, count * (info->type == DECK_REALS ? sizeof(double) : sizeof(char *)));
  if (info->type == DECK_NAMES && count > MOST_NAMES) {
    diag_report(d, DIAG_TOO_LONG, key->value_where, "`%s` has more than %d values", info->name,
                MOST_NAMES);
    return false;
  }
  bool good =
      info->type == DECK_REALS ? read_reals(info, key, list, d) : read_names(a, info, key, list, d);
  if (!good) return false;
  memcpy(item + info->offset, &list, sizeof(list));
  memcpy(item + info->count_offset, &key->value_count, sizeof(int));
  return true;
}

static bool read_single(arena *a, const deck_key_info *info, const namelist_key *key, void *field,
                        diagnostics *d) {
  const namelist_value *v = &key->values[0];
  if (!deck_values_counted(key, 1, d)) return false;
  switch (info->type) {
  case DECK_TEXT:
  case DECK_NAME:
    return text_value(a, v, info->name, info->type == DECK_TEXT, field, d);
  case DECK_STEP:
    if (v->kind == NAMELIST_TEXT && strcmp(v->text, "auto") == 0) return true;
    return deck_real_read(v, info->name, info->unit, info->bound, field, d);
  case DECK_REAL:
    return deck_real_read(v, info->name, info->unit, info->bound, field, d);
  case DECK_ANGLE:
    return read_angle(info, v, field, d);
  case DECK_COUNT:
    return read_count(info, v, field, d);
  case DECK_LOGICAL:
    if (v->kind != NAMELIST_LOGICAL) return report_kind(v, info->name, ".true. or .false.", d);
    memcpy(field, &v->logical, sizeof(bool));
    return true;
  default:
    return true;
  }
}

static bool read_choice(arena *a, const deck_key_info *info, const namelist_key *key, void *field,
                        diagnostics *d) {
  int choice = deck_choice_read(a, key, info->choices, d);
  if (choice < 0) return false;
  if (info->offset == DECK_NO_FIELD) return true;
  const char *words[MOST_CHOICES];
  deck_choices(a, info->choices, words, MOST_CHOICES);
  if (info->type == DECK_WORD)
    memcpy(field, &words[choice], sizeof(words[choice]));
  else
    memcpy(field, &choice, sizeof(choice)); /* enumerations and components alike */
  return true;
}

static bool read_direction(const deck_key_info *info, const namelist_key *key, double field[3],
                           diagnostics *d) {
  if (!deck_values_counted(key, 3, d) || !read_reals(info, key, field, d)) return false;
  if (field[0] != 0 || field[1] != 0 || field[2] != 0) return true;
  diag_report(d, DIAG_BAD_VALUE, key->value_where, "`%s` = 0, 0, 0 has no direction", info->name);
  return false;
}

bool deck_field_read(arena *a, const deck_key_info *info, const namelist_key *key, void *item,
                     diagnostics *d) {
  char *base = item;
  void *field = info->offset == DECK_NO_FIELD ? NULL : base + info->offset;
  switch (info->type) {
  case DECK_LATER:
    return true;
  case DECK_WORD:
  case DECK_CHOICE:
    return read_choice(a, info, key, field, d);
  case DECK_FIXED:
    return read_fixed(a, info, key, field, d);
  case DECK_PAIR:
    return deck_values_counted(key, 2, d) && read_reals(info, key, field, d);
  case DECK_PLACE: /* whether it fits its lattice is known later only */
    return deck_values_counted(key, key->value_count == 3 ? 3 : 2, d) &&
           read_reals(info, key, field, d);
  case DECK_DIRECTION:
    return read_direction(info, key, field, d);
  case DECK_END:
    return read_end(info, key, base, d);
  case DECK_NAMES:
    if (info->count_offset == 0) /* a pair of names: no structure begins with a count */
      return deck_values_counted(key, 2, d) && read_names(a, info, key, field, d);
    return read_list(a, info, key, base, d);
  case DECK_REALS:
    return read_list(a, info, key, base, d);
  default:
    return read_single(a, info, key, field, d);
  }
}

/* Defaults are written in the table as a deck would write them, and read the same way. */
void deck_defaults(arena *a, const deck_group_info *g, void *item) {
  source_set sources = {0};
  diagnostics d;
  diag_begin(&d, &sources);
  for (int i = 0; i < g->key_count; i++) {
    const deck_key_info *info = &g->keys[i];
    if (!info->fallback || info->fallback[0] == '=') continue;
    namelist_key key = {.name = info->name};
    int file = source_add(&sources, "default", info->fallback, strlen(info->fallback));
    namelist_read_values(a, &sources, file, 0, &key, &d);
    bool good = !key.broken && deck_field_read(a, info, &key, item, &d);
    assert(good);
    (void)good;
  }
  diag_clear(&d);
  source_clear(&sources);
}
