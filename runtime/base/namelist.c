#include "runtime/base/namelist.h"

#include <ctype.h>
#include <math.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

#include "dsl/base/characters.h"
#include "dsl/base/units.h"

typedef struct reader {
  arena *memory;
  const char *text;
  uint32_t at, end;
  uint16_t file;
  diagnostics *d;
  int errors_before;
  int value_count; /* so far, of all keys */
} reader;

/* --- bytes ------------------------------------------------------------------------------------ */

static int ahead(const reader *r, uint32_t k) {
  return r->end - r->at > k ? (unsigned char)r->text[r->at + k] : -1;
}

static span since(const reader *r, uint32_t begin) {
  return (span){begin, r->at, r->file};
}

static bool is_name_start(int c) {
  return isalpha(c) || c == '_';
}
static bool is_name_byte(int c) {
  return isalnum(c) || c == '_';
}
static bool is_line_end(int c) {
  return c == '\n' || c == '\r' || c == -1;
}
static bool is_blank(int c) {
  return c == ' ' || (c >= '\t' && c <= '\r');
}

static void skip_line(reader *r) {
  while (!is_line_end(ahead(r, 0)))
    r->at++;
}

/* After an error: to the line's end, but not past a `/` that ends both the line and the group. */
static void skip_rest(reader *r) {
  for (; !is_line_end(ahead(r, 0)); r->at++) {
    if (ahead(r, 0) != '/') continue;
    uint32_t k = 1;
    while (ahead(r, k) == ' ' || ahead(r, k) == '\t')
      k++;
    if (is_line_end(ahead(r, k)) || ahead(r, k) == '!') return;
  }
}

static void skip_blanks(reader *r) {
  for (;;) {
    while (is_blank(ahead(r, 0)))
      r->at++;
    if (ahead(r, 0) != '!') return;
    skip_line(r);
  }
}

/* A slash ends a group unless something follows at once: the unquoted 20 mm/s is one slip, not
 * three. */
static bool ends_token(const reader *r) {
  int c = ahead(r, 0);
  if (c == '/') return !isalnum(ahead(r, 1));
  return c == -1 || is_blank(c) || strchr(",;!='\"&", c) != NULL;
}

static void skip_token(reader *r) {
  uint32_t begin = r->at;
  while (!ends_token(r))
    r->at++;
  if (r->at == begin) r->at++;
}

/* False, with a message, when the bytes are not text. */
static bool is_text(reader *r) {
  const unsigned char *bytes = (const unsigned char *)r->text;
  for (uint32_t i = r->at; i < r->end;) {
    size_t length = utf8_length(r->text + i, r->end - i);
    span where = {i, i + 1, r->file};
    if (length == 0) {
      diag_report(r->d, DIAG_BAD_CHARACTER, where, "this byte (%02x) is not UTF-8 text", bytes[i]);
      diag_hint(r->d, "save the deck as UTF-8");
      return false;
    }
    if ((bytes[i] < 32 && !is_blank(bytes[i])) || bytes[i] == 127) {
      diag_report(r->d, DIAG_BAD_CHARACTER, where, "a deck is text, but this byte is %s (%02x)",
                  bytes[i] ? "a control character" : "NUL", bytes[i]);
      return false;
    }
    i += (uint32_t)length;
  }
  return true;
}

/* --- growing lists ---------------------------------------------------------------------------- */

namelist_group *namelist_add_group(arena *a, namelist *n, const char *name) {
  n->groups = arena_room(a, n->groups, n->group_count, sizeof(*n->groups));
  namelist_group *g = &n->groups[n->group_count++];
  *g = (namelist_group){.name = name};
  return g;
}

namelist_key *namelist_add_key(arena *a, namelist_group *g, const char *name) {
  g->keys = arena_room(a, g->keys, g->key_count, sizeof(*g->keys));
  namelist_key *key = &g->keys[g->key_count++];
  *key = (namelist_key){.name = name};
  return key;
}

void namelist_remove_key(namelist_group *g, namelist_key *key) {
  const size_t after = (size_t)(g->keys + g->key_count-- - (key + 1));
  memmove(key, key + 1, after * sizeof *key);
}

namelist_key *namelist_find(const namelist_group *g, const char *name) {
  for (int i = 0; i < g->key_count; i++)
    if (strcasecmp(g->keys[i].name, name) == 0) return &g->keys[i];
  return NULL;
}

static void add_value(reader *r, namelist_key *key, const namelist_value *value) {
  key->values = arena_room(r->memory, key->values, key->value_count, sizeof(*key->values));
  if (key->value_count == 0) key->value_where = value->where;
  key->value_where = span_join(key->value_where, value->where);
  key->values[key->value_count++] = *value;
}

/* --- values ----------------------------------------------------------------------------------- */

static size_t digits(const char *text, size_t length, size_t from) {
  size_t i = from;
  while (i < length && isdigit((unsigned char)text[i]))
    i++;
  return i - from;
}

size_t namelist_number(const char *text, size_t length, double *value) {
  size_t i = length > 0 && (text[0] == '+' || text[0] == '-');
  size_t whole = digits(text, length, i), fraction = 0;
  i += whole;
  if (i < length && text[i] == '.') {
    fraction = digits(text, length, i + 1);
    i += fraction + 1;
  }
  if (whole + fraction == 0) return 0;
  size_t exponent = 0;
  if (i < length && strchr("eEdD", text[i])) {
    size_t sign = i + 1 < length && (text[i + 1] == '+' || text[i + 1] == '-');
    size_t count = digits(text, length, i + 1 + sign);
    if (count) exponent = i;
    if (count) i += 1 + sign + count;
  }
  char small[64], *copy = i < sizeof(small) ? small : must_alloc(i + 1);
  memcpy(copy, text, i);
  copy[i] = '\0';
  if (exponent) copy[exponent] = 'e';
  *value = strtod(copy, NULL);
  if (copy != small) free(copy);
  return i;
}

static const char *excerpt(reader *r, uint32_t begin) {
  const uint32_t most = 40;
  uint32_t length = r->at - begin;
  if (length <= most) return arena_text(r->memory, r->text + begin, length);
  length = most;
  while (length > 0 && ((unsigned char)r->text[begin + length] & 0xC0) == 0x80)
    length--;
  return arena_printf(r->memory, "%.*s...", (int)length, r->text + begin);
}

/* `6.35 mm` without quotes: the number has been read, the unit begins at `begin`. */
static bool unquoted_unit(reader *r, const namelist_key *key, uint32_t begin, bool comma) {
  if (comma || !key->value_count || !unit_is_whole(r->text + begin, r->at - begin)) return false;
  const namelist_value *last = &key->values[key->value_count - 1];
  if (last->kind != NAMELIST_NUMBER) return false;
  span where = {last->where.begin, r->at, r->file};
  diag_report(r->d, DIAG_DECK_SYNTAX, where, "a value with a unit stands in quotes");
  diag_hint(r->d, "write '%.*s %s'", (int)(last->where.end - last->where.begin),
            r->text + last->where.begin, excerpt(r, begin));
  return true;
}

static bool bad_number(reader *r, const namelist_key *key, uint32_t begin, size_t used,
                       bool comma) {
  if (unquoted_unit(r, key, begin, comma)) return false;
  diag_report(r->d, DIAG_BAD_NUMBER, since(r, begin), "`%s` is not a number", excerpt(r, begin));
  const char *rest = r->text + begin + used;
  if (used && unit_is_whole(rest, r->at - begin - used))
    diag_hint(r->d, "a value with a unit stands in quotes: '%.*s %s'", (int)used, r->text + begin,
              excerpt(r, begin + (uint32_t)used));
  return false;
}

static bool read_number(reader *r, const namelist_key *key, bool comma, namelist_value *value) {
  uint32_t begin = r->at;
  skip_token(r);
  size_t used = namelist_number(r->text + begin, r->at - begin, &value->number);
  if (used != r->at - begin) return bad_number(r, key, begin, used, comma);
  value->kind = NAMELIST_NUMBER;
  value->where = since(r, begin);
  if (isfinite(value->number)) return true;
  diag_report(r->d, DIAG_BAD_NUMBER, value->where, "the number `%s` is too large",
              excerpt(r, begin));
  return false;
}

static bool read_text(reader *r, namelist_value *value) {
  uint32_t begin = r->at;
  char quote = r->text[r->at++];
  uint32_t from = r->at;
  for (;;) {
    if (ahead(r, 0) == quote && ahead(r, 1) == quote)
      r->at++;
    else if (ahead(r, 0) == quote || is_line_end(ahead(r, 0)))
      break;
    r->at++;
  }
  if (ahead(r, 0) != quote) {
    diag_report(r->d, DIAG_UNTERMINATED, since(r, begin), "the text that begins here has no end");
    diag_hint(r->d, "close it with %c on the same line", quote);
    return false;
  }
  char *text = arena_text(r->memory, r->text + from, r->at - from);
  size_t length = 0;
  for (const char *p = text; *p; p++) {
    text[length++] = *p;
    if (*p == quote) p++;
  }
  text[length] = '\0';
  value->kind = NAMELIST_TEXT;
  value->text = text;
  value->text_where = since(r, from);
  r->at++;
  value->where = since(r, begin);
  if (ends_token(r) && ahead(r, 0) != '\'' && ahead(r, 0) != '"') return true;
  diag_report(r->d, DIAG_DECK_SYNTAX, value->where, "the text ends here, but more follows at once");
  diag_hint(r->d, "is a closing quote missing? A quote inside a text is written twice");
  skip_rest(r);
  return false;
}

static bool is_word(const reader *r, uint32_t begin, const char *word) {
  size_t length = strlen(word);
  return r->at - begin == length && strncasecmp(r->text + begin, word, length) == 0;
}

static bool is_logical(const reader *r, uint32_t begin, bool *value) {
  static const char *const words[] = {"t", ".t.", ".true.", "true", "f", ".f.", ".false.", "false"};
  for (int i = 0; i < 8; i++)
    if (is_word(r, begin, words[i])) {
      *value = i < 4;
      return true;
    }
  return false;
}

static bool is_infinite(const reader *r, uint32_t begin) {
  if (r->text[begin] == '-' || r->text[begin] == '+') begin++;
  return is_word(r, begin, "nan") || is_word(r, begin, "inf") || is_word(r, begin, "infinity");
}

static bool bad_character(reader *r) {
  uint32_t begin = r->at;
  const unsigned char *bytes = (const unsigned char *)r->text + begin;
  r->at += (uint32_t)utf8_length(r->text + begin, r->end - begin);
  const char *shown = excerpt(r, begin);
  diag_report(r->d, DIAG_BAD_CHARACTER, since(r, begin), "`%s` has no meaning here", shown);
  static const char *const quotes = "‘’‚‛“”„‟«»‹›´`";
  if (strstr(quotes, shown))
    diag_hint(r->d, "texts stand in plain quotes, '...' or \"...\"");
  else if (bytes[0] == '#' || bytes[0] == '/' || bytes[0] == '*')
    diag_hint(r->d, "a comment begins with `!`");
  else if (bytes[0] == ';')
    diag_hint(r->d, "values are separated by commas or blanks");
  else if (bytes[0] == '$')
    diag_hint(r->d, "a group begins with `&` and ends with `/`");
  else if (strstr("\u00A0\u2007\u202F\u200B", shown))
    diag_hint(r->d, "it is a special blank; use the plain one");
  if (bytes[0] == '#') skip_line(r);
  if (bytes[0] >= 0x80) skip_rest(r);
  return false;
}

/* A word that is no value: say which slip it most likely is. */
static bool read_word(reader *r, const namelist_key *key, bool comma, namelist_value *value) {
  uint32_t begin = r->at;
  skip_token(r);
  value->kind = NAMELIST_LOGICAL;
  value->where = since(r, begin);
  if (is_logical(r, begin, &value->logical)) return true;
  const char *shown = excerpt(r, begin);
  if (is_infinite(r, begin)) {
    diag_report(r->d, DIAG_BAD_NUMBER, value->where, "`%s` is not a finite number", shown);
    return false;
  }
  if (unquoted_unit(r, key, begin, comma)) return false;
  uint32_t end = r->at;
  skip_blanks(r);
  int next = ahead(r, 0);
  bool value_follows = next == '\'' || next == '"' || isdigit(next) || next == '-' || next == '.';
  r->at = end;
  if (key->value_count && value_follows) {
    diag_report(r->d, DIAG_DECK_SYNTAX, value->where, "`=` is missing after `%s`", shown);
    return false;
  }
  diag_report(r->d, DIAG_DECK_SYNTAX, value->where, "`%s` is not a value", shown);
  diag_hint(r->d, "texts stand in quotes: '%s'", shown);
  return false;
}

/* Repeat count `3*` before a value: 1 when there is none, 0 after an error. */
static int read_repeat(reader *r) {
  size_t length = digits(r->text, r->end, r->at);
  if (length == 0 || ahead(r, (uint32_t)length) != '*') return 1;
  uint32_t begin = r->at;
  long count = length < 10 ? strtol(r->text + begin, NULL, 10) : NAMELIST_MOST_VALUES + 1;
  r->at += (uint32_t)length + 1;
  int next = ahead(r, 0);
  const char *shown = excerpt(r, begin);
  if (count < 1 || count > NAMELIST_MOST_VALUES)
    diag_report(r->d, DIAG_DECK_SYNTAX, since(r, begin), "the repeat count in `%s` must be 1 to %d",
                shown, NAMELIST_MOST_VALUES);
  else if (next == -1 || is_blank(next) || strchr(",;/!", next))
    diag_report(r->d, DIAG_DECK_SYNTAX, since(r, begin), "a value is missing after `%s`", shown);
  else
    return (int)count;
  if (!ends_token(r)) skip_token(r);
  return 0;
}

static bool read_value(reader *r, namelist_key *key, bool comma) {
  int count = read_repeat(r);
  if (count == 0) return false;
  namelist_value value = {0};
  int c = ahead(r, 0), next = ahead(r, 1);
  bool good;
  if (c == '\'' || c == '"')
    good = read_text(r, &value);
  else if (isdigit(c) || ((c == '+' || c == '-' || c == '.') && (isdigit(next) || next == '.')))
    good = read_number(r, key, comma, &value);
  else if (is_name_start(c) || c == '.' || ((c == '+' || c == '-') && isalpha(next)) ||
           (c == '%' && !comma))
    good = read_word(r, key, comma, &value);
  else
    return bad_character(r);
  if (!good) return false;
  if (count > NAMELIST_MOST_VALUES - r->value_count) {
    diag_report(r->d, DIAG_TOO_LONG, value.where, "with `%s` there are more than %d values",
                key->name, NAMELIST_MOST_VALUES);
    return false;
  }
  r->value_count += count;
  for (int i = 0; i < count; i++)
    add_value(r, key, &value);
  return true;
}

static bool too_many_errors(const reader *r) {
  return r->d->errors - r->errors_before >= NAMELIST_MOST_ERRORS;
}

/* True when `name =` (or a name with an index) comes next. */
static bool key_follows(reader *r) {
  uint32_t begin = r->at;
  if (!is_name_start(ahead(r, 0))) return false;
  while (is_name_byte(ahead(r, 0)))
    r->at++;
  skip_blanks(r);
  int c = ahead(r, 0);
  r->at = begin;
  return c == '=' || c == '(';
}

static bool ends_old_style(const reader *r) {
  return (ahead(r, 0) == '&' || ahead(r, 0) == '$') && r->end - r->at >= 4 &&
         strncasecmp(r->text + r->at + 1, "end", 3) == 0 && !is_name_byte(ahead(r, 4));
}

/* values: value ([,] value)* [,] */
static void read_values(reader *r, namelist_key *key) {
  int errors = r->d->errors;
  for (bool comma = true, first = true; !too_many_errors(r); first = false) {
    skip_blanks(r);
    int c = ahead(r, 0);
    if (c == -1 || c == '/' || c == '&' || ends_old_style(r) || key_follows(r)) break;
    if (c == ',') {
      r->at++;
      if (comma)
        diag_report(r->d, DIAG_DECK_SYNTAX, since(r, r->at - 1), "a value is missing %s",
                    first ? "before this comma" : "between these commas");
      comma = true;
      continue;
    }
    read_value(r, key, comma);
    comma = false;
  }
  key->broken = r->d->errors > errors;
}

/* --- keys and groups -------------------------------------------------------------------------- */

static const char *read_name(reader *r) {
  uint32_t begin = r->at;
  while (is_name_byte(ahead(r, 0)))
    r->at++;
  if (r->at - begin > NAMELIST_LONGEST_NAME) {
    diag_report(r->d, DIAG_TOO_LONG, since(r, begin), "a name has at most %d characters",
                NAMELIST_LONGEST_NAME);
    return arena_text(r->memory, r->text + begin, NAMELIST_LONGEST_NAME);
  }
  return arena_text(r->memory, r->text + begin, r->at - begin);
}

/* `key(3)`: refused, but what follows is read as usual. */
static void refuse_index(reader *r, const char *name, uint32_t begin) {
  while (!is_line_end(ahead(r, 0)) && ahead(r, 0) != ')' && ahead(r, 0) != '=')
    r->at++;
  if (ahead(r, 0) == ')') r->at++;
  diag_report(r->d, DIAG_DECK_SYNTAX, since(r, begin), "a key has no index");
  diag_hint(r->d, "give all values at once: `%s = v1, v2, ...`", name);
  skip_blanks(r);
}

/* key: name = values */
static void read_key(reader *r, namelist_group *g) {
  uint32_t begin = r->at;
  int errors = r->d->errors;
  const char *name = read_name(r);
  span where = since(r, begin);
  skip_blanks(r);
  namelist_key unwanted = {.name = name}, *key = &unwanted;
  if (ahead(r, 0) == '(') {
    refuse_index(r, name, begin);
  } else if (ahead(r, 0) != '=') {
    diag_report(r->d, DIAG_DECK_SYNTAX, where, "`=` is missing after `%s`", name);
  } else if (g->key_count >= NAMELIST_MOST_KEYS) {
    diag_report(r->d, DIAG_TOO_LONG, where, "a group has at most %d keys", NAMELIST_MOST_KEYS);
  } else if (r->d->errors == errors) {
    key = namelist_add_key(r->memory, g, name);
  }
  key->name_where = where;
  key->value_where = where;
  if (ahead(r, 0) == '=') r->at++;
  errors = r->d->errors;
  read_values(r, key);
  if (key != &unwanted && key->value_count == 0 && r->d->errors == errors) {
    diag_report(r->d, DIAG_DECK_SYNTAX, where, "`%s` has no value", name);
    key->broken = true;
  }
}

static void report_unended(reader *r, const namelist_group *g) {
  diag_report(r->d, DIAG_UNTERMINATED, g->where, "the group `&%s` that begins here has no end",
              g->name);
  diag_hint(r->d, "a group ends with `/`");
  if (r->at >= r->end) return;
  uint32_t begin = r->at++;
  while (is_name_byte(ahead(r, 0)))
    r->at++;
  diag_note(r->d, since(r, begin), "the next group begins here");
  r->at = begin;
}

static void read_keys(reader *r, namelist_group *g) {
  while (!too_many_errors(r)) {
    skip_blanks(r);
    int c = ahead(r, 0);
    if (ends_old_style(r)) {
      r->at += 4;
      return;
    }
    if (c == -1 || c == '&') {
      report_unended(r, g);
      return;
    }
    r->at += c == '/' || c == ',';
    if (c == '/') return;
    if (c == ',') continue;
    if (is_name_start(c)) {
      read_key(r, g);
      continue;
    }
    uint32_t begin = r->at;
    if (!isdigit(c) && !strchr("'\"=+-.", c)) {
      bad_character(r);
      continue;
    }
    skip_rest(r);
    diag_report(r->d, DIAG_DECK_SYNTAX, (span){begin, begin + 1, r->file},
                "a key's name is expected here");
    diag_hint(r->d, "write `key = value`");
  }
}

/* group: & name key* / */
static void read_group(reader *r, namelist *n) {
  int errors = r->d->errors;
  uint32_t begin = r->at++;
  if (!is_name_start(ahead(r, 0))) {
    diag_report(r->d, DIAG_DECK_SYNTAX, since(r, begin), "a group's name must follow `&` at once");
    skip_line(r);
    n->broken = true;
    return;
  }
  char *name = (char *)(uintptr_t)read_name(r);
  for (char *p = name; *p; p++)
    *p = (char)tolower((unsigned char)*p);
  namelist_group *g = namelist_add_group(r->memory, n, name);
  g->where = since(r, begin);
  if (r->text[begin] == '$') {
    diag_report(r->d, DIAG_DECK_SYNTAX, g->where, "a group begins with `&`, not `$`");
    diag_hint(r->d, "write `&%s ... /`", name);
  }
  read_keys(r, g);
  g->broken = r->d->errors > errors;
  n->broken |= g->broken;
}

static void report_outside(reader *r, namelist *n) {
  uint32_t begin = r->at;
  n->broken = true;
  if (ahead(r, 0) == '/') {
    r->at++;
    diag_report(r->d, DIAG_DECK_SYNTAX, since(r, begin), "this `/` ends no group");
    diag_hint(r->d, "the group before has ended already");
    return;
  }
  while (!is_line_end(ahead(r, 0)) && ahead(r, 0) != '&')
    r->at++;
  uint32_t next = r->at;
  while (is_blank(r->text[r->at - 1]))
    r->at--;
  diag_report(r->d, DIAG_DECK_SYNTAX, since(r, begin), "this stands outside every group");
  diag_hint(r->d, "a group is `&name key = value ... /`, a comment begins with `!`");
  r->at = next;
}

static reader reader_begin(arena *a, source_set *sources, int file, diagnostics *d) {
  const source *s = &sources->items[file];
  uint32_t length = s->length > UINT32_MAX ? UINT32_MAX : (uint32_t)s->length;
  return (reader){a, s->text, 0, length, (uint16_t)file, d, d->errors, 0};
}

namelist *namelist_read(arena *a, source_set *sources, int file, diagnostics *d) {
  namelist *n = arena_alloc(a, sizeof(*n));
  reader r = reader_begin(a, sources, file, d);
  n->broken = true;
  if (r.end > NAMELIST_LARGEST_TEXT) {
    diag_report(d, DIAG_TOO_LONG, (span){0, 0, r.file}, "the deck is larger than %d MiB",
                NAMELIST_LARGEST_TEXT / 1024 / 1024);
    return n;
  }
  if (r.end >= 3 && memcmp(r.text, "\xEF\xBB\xBF", 3) == 0) r.at = 3; /* byte order mark */
  if (!is_text(&r)) return n;
  n->broken = false;
  for (;;) {
    skip_blanks(&r);
    int c = ahead(&r, 0);
    span here = {r.at, r.at, r.file};
    if (c == -1) return n;
    if (too_many_errors(&r)) {
      diag_report(d, DIAG_TOO_LONG, here, "too many errors: the deck is not read further");
      return n;
    }
    if (n->group_count >= NAMELIST_MOST_GROUPS) {
      diag_report(d, DIAG_TOO_LONG, here, "a deck has at most %d groups", NAMELIST_MOST_GROUPS);
      n->broken = true;
      return n;
    }
    if (c == '&' || (c == '$' && is_name_start(ahead(&r, 1))))
      read_group(&r, n);
    else
      report_outside(&r, n);
  }
}

void namelist_read_values(arena *a, source_set *sources, int file, uint32_t begin,
                          namelist_key *key, diagnostics *d) {
  reader r = reader_begin(a, sources, file, d);
  r.at = begin;
  key->value_where = (span){begin, r.end, r.file};
  if (!is_text(&r)) {
    key->broken = true;
    return;
  }
  read_values(&r, key);
  if (r.at < r.end && !key->broken) {
    key->broken = true;
    diag_report(d, DIAG_DECK_SYNTAX, (span){r.at, r.end, r.file},
                "only the values of one key may stand here");
  } else if (key->value_count == 0 && !key->broken) {
    key->broken = true;
    diag_report(d, DIAG_DECK_SYNTAX, key->value_where, "`%s` has no value", key->name);
  }
}

/* --- writing ---------------------------------------------------------------------------------- */

static void print_lower(FILE *out, const char *name) {
  for (; *name; name++)
    fputc(*name >= 'A' && *name <= 'Z' ? *name + 'a' - 'A' : *name, out);
}

static void print_value(FILE *out, const namelist_value *v) {
  if (v->kind == NAMELIST_NUMBER) {
    fprintf(out, " %.17g", v->number);
  } else if (v->kind == NAMELIST_LOGICAL) {
    fputs(v->logical ? " .true." : " .false.", out);
  } else {
    fputs(" '", out);
    for (const char *c = v->text; *c; c++)
      fputs(*c == '\'' ? "''" : (char[]){*c, 0}, out);
    fputc('\'', out);
  }
}

char *namelist_text(arena *a, const namelist *n,
                    bool (*leave_out)(const char *group, const char *key)) {
  char *text = NULL;
  size_t length = 0;
  FILE *out = must_open_text(&text, &length);
  for (int g = 0; g < n->group_count; g++) {
    const namelist_group *group = &n->groups[g];
    if (leave_out(group->name, NULL)) continue;
    fprintf(out, "&%s", group->name);
    for (int k = 0; k < group->key_count; k++) {
      if (leave_out(group->name, group->keys[k].name)) continue;
      fputc(' ', out);
      print_lower(out, group->keys[k].name);
      fputs(" =", out);
      for (int v = 0; v < group->keys[k].value_count; v++)
        print_value(out, &group->keys[k].values[v]);
    }
    fputs(" /\n", out);
  }
  must_close_text(out);
  char *kept = arena_text(a, text, length);
  free(text);
  return kept;
}
