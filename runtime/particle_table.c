#include "runtime/particle_table.h"

#include <errno.h>
#include <fcntl.h>
#include <inttypes.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>
#include <sys/stat.h>

#include "dsl/arena.h"
#include "dsl/elementary.h"
#include "dsl/unit_hint.h"
#include "dsl/units.h"
#include "runtime/ordinary_file.h"
#include "runtime/result.h"

#define FARTHEST 1e30                 /* m, m^2, m^3: squares and cubes of sums are finite */
#define LONGEST  ((long long)1 << 31) /* bytes: places in the text are spans */

enum { X, Y, Z, VOLUME, AREA, COLUMNS };
static const char *const column_names[] = {"x", "y", "z", "volume", "area"};
static const char *const column_units[] = {"m", "m", "m", "m^3", "m^2"};

/* --- the file --------------------------------------------------------------------------------- */

typedef struct reader {
  particle_table *table;
  span where;
  double thickness;
  diagnostics *d;
  int column_count;      /* in the header */
  int place_of[COLUMNS]; /* position of each in a line, or -1 */
  double factor[COLUMNS];
  long room;
} reader;

static bool refuse_file(const reader *r, const char *why) {
  diag_report(r->d, DIAG_FILE, r->where, "cannot read `%s`: %s", r->table->path, why);
  return false;
}

static bool is_result(const particle_table *t) {
  return t->length >= 8 && memcmp(t->text, "\x89HDF\r\n\x1a\n", 8) == 0;
}

static bool load(const reader *r) {
  struct stat about;
  particle_table *t = r->table;
  const char *why = NULL;
  const int file = ordinary_file_open(t->path, O_RDONLY, &why);
  FILE *in = file >= 0 ? fdopen(file, "rb") : NULL;
  if (!in || fstat(file, &about) != 0) return refuse_file(r, why ? why : strerror(errno));
  if (about.st_size >= LONGEST) {
    fclose(in);
    return refuse_file(r, "it is longer than 2 GiB");
  }
  t->text = must_alloc((size_t)about.st_size + 1);
  t->length = fread(t->text, 1, (size_t)about.st_size, in);
  t->text[t->length] = 0;
  const bool failed = ferror(in) != 0;
  fclose(in);
  return failed ? refuse_file(r, strerror(errno)) : true;
}

/* --- places in the text ----------------------------------------------------------------------- */

static int source_of(particle_table *t, diagnostics *d) {
  if (t->source < 0) t->source = source_add(d->sources, t->path, t->text, t->length);
  return t->source;
}

static span text_span(const reader *r, const char *from, const char *to) {
  const char *text = r->table->text;
  return (span){(uint32_t)(from - text), (uint32_t)(to - text),
                (uint16_t)source_of(r->table, r->d)};
}

static const char *line_end(const char *p) {
  return p + strcspn(p, "\n");
}

span particle_table_where(particle_table *t, long particle, span otherwise, diagnostics *d) {
  if (!t->text) return otherwise;
  const char *line = t->text + t->begin[particle];
  const size_t length = strcspn(line, "\r\n");
  return (span){t->begin[particle], t->begin[particle] + (uint32_t)length,
                (uint16_t)source_of(t, d)};
}

const char *particle_table_name(const particle_table *t, long particle,
                                char text[PARTICLE_TABLE_TEXT]) {
  if (!t->text) {
    snprintf(text, PARTICLE_TABLE_TEXT, "particle %" PRIu32 " of the result", t->begin[particle]);
    return text;
  }
  long line = 1;
  for (const char *p = t->text; p < t->text + t->begin[particle]; p++)
    line += *p == '\n';
  snprintf(text, PARTICLE_TABLE_TEXT, "line %ld", line);
  return text;
}

/* --- fields of a line ------------------------------------------------------------------------- */

typedef struct field {
  const char *from, *to; /* without blanks around */
} field;

static bool is_blank(char c) {
  return c == ' ' || c == '\t' || c == '\r';
}

/* The field at `p`; `*next` is behind the comma, or NULL at the end of the line. */
static field read_field(const char *p, const char *end, const char **next) {
  const char *comma = memchr(p, ',', (size_t)(end - p));
  field f = {p, comma ? comma : end};
  *next = comma ? comma + 1 : NULL;
  while (f.from < f.to && is_blank(*f.from))
    f.from++;
  while (f.to > f.from && is_blank(f.to[-1]))
    f.to--;
  return f;
}

static bool begins_line(const char *p, const char *end) {
  while (p < end && is_blank(*p))
    p++;
  return p < end && *p != '#';
}

/* The next line that is neither blank nor a comment; NULL behind the last. */
static const char *find_line(const particle_table *t, const char *p) {
  while (p < t->text + t->length) {
    const char *end = line_end(p);
    if (begins_line(p, end)) return p;
    p = end < t->text + t->length ? end + 1 : end;
  }
  return NULL;
}

static const char *line_after(const particle_table *t, const char *end) {
  return end < t->text + t->length ? end + 1 : end;
}

/* --- the header ------------------------------------------------------------------------------- */

static bool read_unit(reader *r, int column, const char *from, const char *to) {
  unit given, needed;
  const char *bad;
  size_t bad_length;
  unit_parse(column_units[column], strlen(column_units[column]), &needed, &bad, &bad_length);
  if (!unit_parse(from, (size_t)(to - from), &given, &bad, &bad_length)) {
    diag_report(r->d, DIAG_UNKNOWN_UNIT, text_span(r, from, to), "there is no unit `%.*s`",
                (int)pl_fmin((double)bad_length, 40), bad);
    unit_hint(r->d, bad, bad_length);
    return false;
  }
  if (!dim_equal(given.dim, needed.dim)) {
    diag_report(r->d, DIAG_UNITS, text_span(r, from, to), "the unit of `%s` is one of `%s`",
                column_names[column], column_units[column]);
    return false;
  }
  r->factor[column] = given.factor;
  return true;
}

static int column_of(const char *from, const char *to) {
  for (int k = 0; k < COLUMNS; k++)
    if (strlen(column_names[k]) == (size_t)(to - from) &&
        strncasecmp(column_names[k], from, (size_t)(to - from)) == 0)
      return k;
  return -1;
}

/* "name" or "name [unit]", perhaps in quotes. */
static bool read_column(reader *r, field f, int position) {
  if (f.to - f.from >= 2 && *f.from == '"' && f.to[-1] == '"') {
    f.from++;
    f.to--;
  }
  const char *bracket = memchr(f.from, '[', (size_t)(f.to - f.from));
  const char *name_end = bracket ? bracket : f.to;
  while (name_end > f.from && is_blank(name_end[-1]))
    name_end--;
  const int column = column_of(f.from, name_end);
  if (column < 0) return true; /* of no concern here */
  if (r->place_of[column] >= 0) {
    diag_report(r->d, DIAG_DUPLICATE_NAME, text_span(r, f.from, f.to),
                "there is a second column `%s`", column_names[column]);
    return false;
  }
  r->place_of[column] = position;
  if (!bracket) return true;
  if (f.to[-1] == ']') return read_unit(r, column, bracket + 1, f.to - 1);
  diag_report(r->d, DIAG_SYNTAX, text_span(r, bracket, f.to), "this unit has no closing `]`");
  return false;
}

static bool hint_at_header(const reader *r) {
  diag_hint(r->d, "its first line names the columns, e.g. %s",
            r->table->dimensions == 2 ? "x [mm], y [mm], volume [mm^3]"
                                      : "x [mm], y [mm], z [mm], volume [mm^3]");
  return false;
}

static bool lacks(const reader *r, span where, const char *name) {
  diag_report(r->d, DIAG_MISSING_KEY, where, "the table has no column `%s`", name);
  return hint_at_header(r);
}

/* A deck may come from somebody else, and name a file whose lines are nobody's business: only those
   of tables are shown, which begin with the name of a column or, wrongly, with numbers. */
static bool is_table(const reader *r, const char *line) {
  static const char between[] = ",; \t\r\n[\"", numbers[] = "0123456789+-.eE,; \t\r";
  if (strspn(line, numbers) == strcspn(line, "\n")) return true;
  for (const char *end = line_end(line), *p = line; p < end;) {
    const char *word = p + strspn(p, between);
    p = word + strcspn(word, between);
    if (column_of(word, p) >= 0) return true;
  }
  diag_report(r->d, DIAG_FILE, r->where, "`%s` is not a table of particles", r->table->path);
  return hint_at_header(r);
}

static bool columns_suit(const reader *r, span where) {
  const bool plane = r->table->dimensions == 2;
  for (int c = 0; c < r->table->dimensions; c++)
    if (r->place_of[c] < 0) return lacks(r, where, column_names[c]);
  if (plane && r->place_of[Z] >= 0) {
    diag_report(r->d, DIAG_CONFLICT, where,
                "the table has a column `z`, the lattice is in the plane");
    diag_hint(r->d, "give the lattice `setting = 'space'`, or leave the column out");
  } else if (!plane && r->place_of[AREA] >= 0) {
    diag_report(r->d, DIAG_CONFLICT, where, "particles in space have a `volume`, not an `area`");
  } else if (r->place_of[AREA] >= 0 && r->place_of[VOLUME] >= 0) {
    diag_report(r->d, DIAG_CONFLICT, where, "`area` and `volume` exclude each other");
  } else {
    return true;
  }
  return false;
}

/* Semicolons and tabs are what other programs put between columns. */
static bool has_commas(const reader *r, const char *line) {
  const char *end = line_end(line), *other = memchr(line, ';', (size_t)(end - line));
  if (!other) other = memchr(line, '\t', (size_t)(end - line));
  if (!other || memchr(line, ',', (size_t)(end - line))) return true;
  diag_report(r->d, DIAG_BAD_VALUE, text_span(r, other, other + 1),
              "columns are separated by commas, not by %s", *other == ';' ? "semicolons" : "tabs");
  return false;
}

static bool read_header(reader *r, const char *line) {
  if (!is_table(r, line) || !has_commas(r, line)) return false;
  const char *end = line_end(line), *p = line;
  for (int k = 0; k < COLUMNS; k++) {
    r->place_of[k] = -1;
    r->factor[k] = 1;
  }
  for (; p; r->column_count++)
    if (!read_column(r, read_field(p, end, &p), r->column_count)) return false;
  return columns_suit(r, text_span(r, line, line + strcspn(line, "\r\n")));
}

/* --- lines ------------------------------------------------------------------------------------ */

static bool read_number(const reader *r, field f, int column, double *value) {
  char *rest;
  if (f.from == f.to) {
    diag_report(r->d, DIAG_BAD_VALUE, text_span(r, f.from, f.to), "here is no value of `%s`",
                column_names[column]);
    return false;
  }
  *value = strtod(f.from, &rest) * r->factor[column];
  if (rest != f.to) {
    diag_report(r->d, DIAG_BAD_NUMBER, text_span(r, f.from, f.to), "`%s` is not a number here",
                column_names[column]);
  } else if (!isfinite(*value)) {
    diag_report(r->d, DIAG_BAD_NUMBER, text_span(r, f.from, f.to), "`%s` is not finite here",
                column_names[column]);
  } else if (fabs(*value) > FARTHEST) {
    diag_report(r->d, DIAG_BAD_NUMBER, text_span(r, f.from, f.to), "`%s` is too large here",
                column_names[column]);
  } else if (column >= VOLUME && !(*value > 0)) {
    diag_report(r->d, DIAG_OUT_OF_BOUNDS, text_span(r, f.from, f.to), "`%s` must be positive",
                column_names[column]);
  } else {
    return true;
  }
  return false;
}

static int column_at(const reader *r, int position) {
  for (int k = 0; k < COLUMNS; k++)
    if (r->place_of[k] == position) return k;
  return -1;
}

static bool read_values(const reader *r, const char *line, double values[COLUMNS]) {
  const char *end = line_end(line), *p = line;
  int position = 0;
  for (; p && position <= r->column_count; position++) {
    const field f = read_field(p, end, &p);
    const int column = column_at(r, position);
    if (column >= 0 && !read_number(r, f, column, &values[column])) return false;
  }
  if (position == r->column_count) return true;
  diag_report(r->d, DIAG_BAD_VALUE, text_span(r, line, line + strcspn(line, "\r\n")),
              "this line has %s values than the %d columns",
              position > r->column_count ? "more" : "fewer", r->column_count);
  return false;
}

static void *grown(void *list, long room, size_t each) {
  return must_realloc(list, (size_t)room * each);
}

static void make_room(reader *r) {
  particle_table *t = r->table;
  if (t->count < r->room) return;
  r->room = 2 * r->room + 256;
  for (int c = 0; c < t->dimensions; c++)
    t->at[c] = grown(t->at[c], r->room, sizeof(double));
  t->begin = grown(t->begin, r->room, sizeof *t->begin);
  if (r->place_of[VOLUME] >= 0 || r->place_of[AREA] >= 0)
    t->volume = grown(t->volume, r->room, sizeof(double));
}

static bool read_line(reader *r, const char *line) {
  particle_table *t = r->table;
  double values[COLUMNS];
  if (!read_values(r, line, values)) return false;
  make_room(r);
  for (int c = 0; c < t->dimensions; c++)
    t->at[c][t->count] = values[c];
  if (r->place_of[AREA] >= 0)
    t->volume[t->count] = values[AREA];
  else if (t->volume)
    t->volume[t->count] = values[VOLUME] / (t->dimensions == 2 ? r->thickness : 1);
  t->begin[t->count++] = (uint32_t)(line - t->text);
  return true;
}

static bool no_particles(const reader *r) {
  diag_report(r->d, DIAG_EMPTY_REGION, r->where, "`%s` holds no particle", r->table->path);
  return false;
}

static bool read_text(reader *r) {
  particle_table *t = r->table;
  const bool marked = t->length >= 3 && memcmp(t->text, "\xef\xbb\xbf", 3) == 0;
  if (strlen(t->text) != t->length) return refuse_file(r, "it is not a text");
  const char *line = find_line(t, t->text + (marked ? 3 : 0));
  if (!line) return no_particles(r);
  if (!read_header(r, line)) return false;
  while ((line = find_line(t, line_after(t, line_end(line)))))
    if (!read_line(r, line)) return false;
  return t->count > 0 || no_particles(r);
}

/* --- results ---------------------------------------------------------------------------------- */

static bool take_places(const reader *r, const double *reference, int dimensions) {
  particle_table *t = r->table;
  t->begin = must_alloc(((size_t)t->count + 1) * sizeof *t->begin);
  for (long k = 0; k < t->count; k++)
    t->begin[k] = (uint32_t)k;
  for (int c = 0; c < dimensions; c++) {
    t->at[c] = must_alloc(((size_t)t->count + 1) * sizeof(double));
    for (long k = 0; k < t->count; k++) {
      t->at[c][k] = reference[k * dimensions + c];
      if (!(fabs(t->at[c][k]) <= FARTHEST))
        return refuse_file(r, "a place in it is not finite, or too far away");
    }
  }
  for (long k = 0; t->volume && k < t->count; k++) {
    if (t->dimensions == 2) t->volume[k] /= r->thickness;
    if (!(t->volume[k] > 0 && t->volume[k] <= FARTHEST))
      return refuse_file(r, "a volume in it is not positive");
  }
  return true;
}

static bool take_result(const reader *r, result_file *f) {
  particle_table *t = r->table;
  int dimensions;
  long volumes;
  double *reference = result_read_reference(f, &t->count, &dimensions);
  t->volume = result_read_volume(f, &volumes);
  bool good = false;
  if (result_trouble(f))
    diag_report(r->d, DIAG_FILE, r->where, "%s", result_trouble(f));
  else if (!reference || (t->volume && volumes != t->count))
    refuse_file(r, "its particles are damaged");
  else if (dimensions != t->dimensions)
    diag_report(r->d, DIAG_CONFLICT, r->where,
                "the particles of `%s` are in %s, the lattice is in %s", t->path,
                dimensions == 2 ? "the plane" : "space", dimensions == 2 ? "space" : "the plane");
  else if (t->count == 0)
    no_particles(r);
  else
    good = take_places(r, reference, dimensions);
  free(reference);
  return good;
}

static bool read_result(reader *r) {
  particle_table *t = r->table;
  char error[1024];
  free(t->text);
  t->text = NULL;
  result_file *f = result_read(t->path, error, sizeof error);
  if (!f) {
    diag_report(r->d, DIAG_FILE, r->where, "%s", error);
    return false;
  }
  const bool good = take_result(r, f);
  result_read_close(f);
  return good;
}

bool particle_table_read(particle_table *t, char *path, int dimensions, double thickness,
                         span where, diagnostics *d) {
  *t = (particle_table){.dimensions = dimensions, .path = path, .source = -1};
  reader r = {.table = t, .where = where, .thickness = thickness, .d = d};
  return load(&r) && (is_result(t) ? read_result(&r) : read_text(&r));
}

void particle_table_free(particle_table *t) {
  for (int c = 0; c < 3; c++)
    free(t->at[c]);
  free(t->volume);
  free(t->begin);
  free(t->text);
  free(t->path);
}
