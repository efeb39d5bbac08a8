#include "runtime/deck/deck_formula.h"

#include <ctype.h>
#include <stdlib.h>
#include <string.h>

#include "runtime/base/text_table.h"
#include "runtime/deck/deck_value.h"
#include "runtime/deck/time_function.h"

static const formula_variable variables[FORMULA_VARIABLES] = {[FORMULA_X] = {"x", "m"},
                                                              [FORMULA_Y] = {"y", "m"},
                                                              [FORMULA_Z] = {"z", "m"},
                                                              [FORMULA_T] = {"t", "s"}};
static const formula_variable time_alone[FORMULA_VARIABLES] = {
    {"", "m"}, {"", "m"}, {"", "m"}, [FORMULA_T] = {"t", "s"}};

const formula_scope deck_formula_of_all = {variables, FORMULA_VARIABLES, "x, y, z (m) and t (s)"};
const formula_scope deck_formula_of_place = {variables, FORMULA_T, "x, y, z (m) here"};
const formula_scope deck_formula_of_time = {time_alone, FORMULA_VARIABLES, "t (s) here"};

static bool is_word(const char *text) {
  size_t length = 0;
  while (isalnum((unsigned char)text[length]) || text[length] == '_')
    length++;
  return text[length] == 0;
}

/* Behind the number of a quantity stands nothing or a unit: a letter, or `%`, or `1/s`. */
bool deck_is_formula(const namelist_value *v) {
  if (v->kind != NAMELIST_TEXT) return false;
  const char *p = v->text + strspn(v->text, " \t");
  double ignored;
  const size_t number = namelist_number(p, strlen(p), &ignored);
  if (number == 0) return !is_word(p);
  const char *rest = p + number + strspn(p + number, " \t");
  return *rest && !isalnum((unsigned char)*rest) && *rest != '%' &&
         (unsigned char)*rest < 0x80; /* of other letters units are told to be unknown */
}

const formula *deck_formula_read(arena *a, const namelist_value *v, const char *key,
                                 const formula_scope *scope, const char *unit_text,
                                 diagnostics *d) {
  const bool text = v->kind == NAMELIST_TEXT;
  const uint32_t written = v->text_where.end - v->text_where.begin;
  if (text && v->text[strspn(v->text, " \t")] && !strpbrk(v->text, "!\n\r&") &&
      written == strlen(v->text))
    return formula_read(a, d->sources, v->text_where, scope, unit_text,
                        arena_printf(a, "`%s`", key), d);
  diag_report(d, DIAG_BAD_VALUE, v->where, "`%s` is one expression in quotes", key);
  diag_hint(d, "for example %s = '2 [mm]*sin(x/10 [mm])'", key);
  return NULL;
}

static bool read_value(arena *a, const namelist_key *key, const char *unit_text, deck_placed *p,
                       diagnostics *d) {
  if (!deck_values_counted(key, 1, d)) return false;
  const namelist_value *v = &key->values[0];
  if (!deck_is_formula(v)) return deck_real_read(v, key->name, unit_text, BOUND_NONE, &p->value, d);
  p->formula = deck_formula_read(a, v, key->name, &deck_formula_of_place, unit_text, d);
  return p->formula != NULL;
}

static bool ends_with(const char *text, const char *end) {
  const size_t length = strlen(text), of_end = strlen(end);
  return length >= of_end && strcmp(text + length - of_end, end) == 0;
}

/* The text of a table goes with the deck. */
static bool keep_text(const char *path, span where, diagnostics *d) {
  text_table t;
  if (ends_with(path, ".h5")) return true;
  const bool good = text_table_read(&t, must_copy(path), where, d);
  if (good) file_text_source(&t.file, d);
  text_table_free(&t);
  return good;
}

bool deck_is_place_file(const namelist_value *v) {
  static const char *const endings[] = {".csv", ".tsv", ".txt", ".dat", ".h5"};
  const char *column = NULL;
  if (v->kind != NAMELIST_TEXT) return false;
  char *name = text_table_split(v->text, &column);
  bool found = column != NULL;
  for (size_t k = 0; k < sizeof endings / sizeof *endings; k++)
    found = found || ends_with(name, endings[k]);
  free(name);
  return found;
}

bool deck_place_file_read(arena *a, uint16_t file, const namelist_value *v, deck_placed *p,
                          diagnostics *d) {
  const char *column = NULL;
  char *name = text_table_split(v->text, &column);
  char *path = deck_file_path(d->sources->items[file].name, name);
  p->path = arena_text(a, path, strlen(path));
  p->column = column;
  free(name);
  free(path);
  return keep_text(p->path, v->where, d);
}

static bool read_file(arena *a, const namelist_group *g, const namelist_key *key, deck_placed *p,
                      diagnostics *d) {
  if (!deck_values_counted(key, 1, d)) return false;
  const namelist_value *v = &key->values[0];
  if (v->kind == NAMELIST_TEXT && *v->text) return deck_place_file_read(a, g->where.file, v, p, d);
  diag_report(d, DIAG_BAD_VALUE, v->where, "`file` is the name of a table or result in quotes");
  return false;
}

bool deck_placed_changes(const deck_placed *p) {
  return p->in_time || (p->formula && formula_reads(p->formula, FORMULA_T));
}

bool deck_placed_read(arena *a, const namelist_group *g, const char *unit_text, deck_placed *p,
                      diagnostics *d) {
  const namelist_key *value = namelist_find(g, "value"), *file = namelist_find(g, "file");
  *p = (deck_placed){.unit_text = unit_text};
  if (value && !file) return read_value(a, value, unit_text, p, d);
  if (file && !value) return read_file(a, g, file, p, d);
  if (!value) {
    diag_report(d, DIAG_MISSING_KEY, g->where, "`&%s` needs `value` or `file`", g->name);
    return false;
  }
  diag_report(d, DIAG_CONFLICT, file->name_where, "`value` and `file` exclude each other");
  diag_note(d, value->name_where, "`value` is given here");
  return false;
}
