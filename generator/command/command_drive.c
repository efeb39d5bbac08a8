/* perilat drive: one bond, one particle of a law of families or one point of a continuum, along a
   path. */
#include "generator/command/command_drive.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "dsl/base/elementary.h"
#include "generator/against/difference_draw.h"
#include "generator/against/difference_words.h"
#include "generator/against/reference_law.h"
#include "generator/command/commands.h"
#include "generator/drive/drive_bond.h"
#include "generator/drive/drive_draw.h"
#include "generator/drive/drive_expect.h"
#include "generator/drive/drive_family.h"
#include "generator/drive/drive_grammar.h"
#include "generator/drive/drive_hdf5.h"
#include "generator/drive/drive_path.h"
#include "generator/drive/drive_point.h"
#include "generator/drive/drive_table.h"
#include "generator/drive/drive_write.h"
#include "generator/drive/driven_fields.h"
#include "generator/drive/driven_law.h"
#include "generator/drive/explain_bad.h"
#include "generator/drive/explain_point.h"
#include "generator/facts/law_judged.h"
#include "generator/kernel/document.h"
#include "generator/kernel/settings.h"
#include "generator/run/run.h"
#include "runtime/analysis/material.h"

#define PATH_LIMIT_BYTES ((size_t)16 << 20)
enum { DRIVE_FAILED = 2, ERROR_LENGTH = 4096 };

typedef struct drive_options {
  const char *law, *path;
  const char *csv, *hdf5, *picture;
  const char *against; /* the law of reference, or NULL */
  double tolerance;    /* of that comparison */
  const char *const *settings;
  int setting_count;
  bool compiled, confined;
  bool check_only;
  bool json;
  diag_json *report; /* diagnostics go here; NULL: to stderr as text */
} drive_options;

/* Everything a drive holds. */
typedef struct driving {
  const drive_options *options;
  arena *memory;
  source_set sources;
  diagnostics said;
  drive_input *in;
  driven_law of;
  drive_table columns; /* without rows, for the expectations */
  drive_expectations *expectations;
  drive_table table;
  drive_band band; /* of points */
  reference_law reference;
  table_difference difference;
  bool compared;
  drive_verdict *verdicts; /* [expect_count], once it was driven */
} driving;

static void tell(const driving *r, const diagnostics *d) {
  if (r->options->report)
    diag_json_add(r->options->report, d);
  else
    diag_print(d, stderr);
}

/* --- options ---------------------------------------------------------------------------------- */

static bool take_file(drive_options *o, const char *file) {
  file_kind kind = kind_of_file(file);
  if (!file_suits(file, FILES(LAW) | FILES(DECK), "perilat drive", "a law and a path"))
    return false;
  if (kind == FILE_DECK && drive_is_deck(file) && !drive_is_path(file)) {
    say_error("`%s` is a deck, not a path\n  perilat run %s", file, file);
    return false;
  }
  const char **slot = kind == FILE_DECK ? &o->path : &o->law;
  if (*slot) {
    say_error("`perilat drive` takes one %s; `%s` is a second one",
              kind == FILE_DECK ? "path" : "law", file);
    return false;
  }
  *slot = file;
  return true;
}

static bool read_tolerance(const char *given, double *tolerance) {
  char *end;
  *tolerance = strtod(given, &end);
  if (end != given && !*end && *tolerance >= 0 && isfinite(*tolerance)) return true;
  say_error("--tolerance takes a number that is not negative, not `%s`", given);
  return false;
}

static bool read_options(int argc, char **argv, drive_options *o, const char **settings) {
  int bad = 0;
  for (int at = 0; at < argc && !bad;) {
    const char *value;
    if (option_flag(argv, &at, "--compiled"))
      o->compiled = true;
    else if (option_flag(argv, &at, "--confined"))
      o->confined = true;
    else if ((value = option_value(argc, argv, &at, "--set", &bad)))
      settings[o->setting_count++] = value;
    else if ((value = option_value(argc, argv, &at, "--csv", &bad)))
      o->csv = value;
    else if ((value = option_value(argc, argv, &at, "--hdf5", &bad)))
      o->hdf5 = value;
    else if ((value = option_value(argc, argv, &at, "--picture", &bad)))
      o->picture = value;
    else if ((value = option_value(argc, argv, &at, "--against", &bad)))
      o->against = value;
    else if ((value = option_value(argc, argv, &at, "--tolerance", &bad)))
      bad = !read_tolerance(value, &o->tolerance);
    else if (option_flag(argv, &at, "--json"))
      o->json = true;
    else if (argv[at][0] == '-')
      bad = option_unknown("drive", argv[at]);
    else
      bad = !take_file(o, argv[at++]);
  }
  if (!bad && !o->path) say_error("`perilat drive` needs a path\n  perilat drive law.plm path.nml");
  return !bad && o->path;
}

/* "group.key=value", as decks are changed; anything else sets a value of the law. */
static bool is_of_path(const char *setting) {
  const char first = setting[strcspn(setting, ".=[")];
  return first == '.' || first == '[';
}

/* --- what is driven --------------------------------------------------------------------------- */

static bool read_input(driving *r) {
  const drive_options *o = r->options;
  char error[ERROR_LENGTH];
  size_t length;
  char *text = read_text_file(o->path, PATH_LIMIT_BYTES, &length, error, sizeof error);
  if (!text) {
    diag_report(&r->said, DIAG_FILE, (span){0, 0, UINT16_MAX}, "%s", error);
    return false;
  }
  const size_t most = (size_t)o->setting_count + 1;
  deck_override *of_path = arena_alloc(r->memory, most * sizeof *of_path);
  const char **of_law = arena_alloc(r->memory, most * sizeof *of_law);
  int path_count = 0, law_count = 0;
  for (int k = 0; k < o->setting_count; k++)
    if (is_of_path(o->settings[k]))
      of_path[path_count++].text = o->settings[k];
    else
      of_law[law_count++] = o->settings[k];
  int file = source_add(&r->sources, o->path, text, length);
  free(text);
  r->in = drive_read(r->memory, &r->sources, file, of_path, path_count, &r->said);
  if (!r->in ||
      !settings_read(r->memory, &r->sources, of_law, law_count, &r->in->material, &r->said))
    return false;
  r->in->output.csv = o->csv ? o->csv : r->in->output.csv;
  r->in->output.hdf5 = o->hdf5 ? o->hdf5 : r->in->output.hdf5;
  r->in->output.picture = o->picture ? o->picture : r->in->output.picture;
  r->in->material.model = o->law ? o->law : r->in->material.model;
  if (r->in->material.model || o->check_only) return true;
  diag_report(&r->said, DIAG_MISSING_KEY, r->in->material.item.where, "no law is named");
  diag_hint(&r->said, "perilat drive law.plm path.nml, or &material model = 'name' / in the path");
  return false;
}

/* --- what came out ---------------------------------------------------------------------------- */

/* What a row of the table was computed from: the states of the row before, the parameters with the
   law's fields at its time, and by how much that went on, s. */
typedef struct origin {
  double *states, *parameters, advance;
} origin;

static origin origin_of(const driving *r, long row) {
  const drive_table *t = &r->table;
  const double *time = t->columns[DRIVE_COLUMN_TIME].values;
  const size_t parameters = (size_t)r->of.law->parameter_count;
  origin o = {.states = must_calloc((size_t)t->fields + 1, sizeof *o.states),
              .parameters = must_calloc(parameters + 1, sizeof *o.parameters),
              .advance = row ? time[row] - time[row - 1] : 0};
  for (int f = 0; f < t->fields; f++)
    o.states[f] = row ? t->columns[t->law_column + f].values[row - 1] : r->of.initial[f];
  memcpy(o.parameters, r->of.parameters, parameters * sizeof *o.parameters);
  driven_fields_at(r->in, r->of.law, time[row], o.parameters);
  return o;
}

static void origin_free(origin *o) {
  free(o->states);
  free(o->parameters);
}

static void explain_bad_point(const driving *r, long row) {
  const drive_table *t = &r->table;
  double strain[PL_MAX_STRAINS];
  origin from = origin_of(r, row);
  for (int k = 0; k < PL_STRAINS(r->of.law->dimensions); k++)
    strain[k] = t->columns[1 + k].values[row];
  const asked_point at = {strain, from.states, r->in->point.cell_size, row ? from.advance : 1,
                          from.advance};
  explain_point(r->of.model.plan, from.parameters, &at, stderr);
  origin_free(&from);
}

static void explain_bad_bond(const driving *r, long row) {
  const drive_table *t = &r->table;
  origin from = origin_of(r, row);
  const bad_state at = {.stretch = t->columns[DRIVE_COLUMN_STRETCH].values[row],
                        .stretch_rate = t->columns[DRIVE_COLUMN_STRETCH_RATE].values[row],
                        .theta_i = t->columns[DRIVE_COLUMN_THETA_I].values[row],
                        .theta_j = t->columns[DRIVE_COLUMN_THETA_J].values[row],
                        .advance = from.advance,
                        .fields = from.states,
                        .field_count = t->fields};
  pl_bond_class bonds;
  if (drive_bond_class(r->in, material_density(r->of.law, from.parameters), &bonds))
    explain_bad(r->of.model.plan, from.parameters, &bonds, &at, stderr);
  origin_free(&from);
}

static void report_bad(const driving *r) {
  const drive_table *t = &r->table;
  const long row = t->bad_row;
  int column = 0;
  while (isfinite(t->columns[column].values[row]))
    column++;
  say_error("`%s` is not a number at %.6g s, %s %.6g", t->columns[column].name,
            t->columns[DRIVE_COLUMN_TIME].values[row], t->columns[t->way].name,
            t->columns[t->way].values[row]);
  if (t->of == DRIVE_OF_POINTS) explain_bad_point(r, row);
  if (t->of == DRIVE_OF_BONDS) explain_bad_bond(r, row);
}

static void describe(const driving *r) {
  const drive_table *t = &r->table;
  const drive_bond *b = &r->in->bond;
  const deck_lattice like = drive_lattice(r->in, r->of.model.law);
  if (t->of == DRIVE_OF_POINTS)
    printf("%s at one point (%s)", r->of.law->name, law_setting_name(r->of.model.law->setting));
  else if (t->of == DRIVE_OF_FAMILIES)
    printf("%s on one particle of a lattice (%s, %s), s = %.6g mm", r->of.law->name, like.kind,
           like.setting, 1e3 * like.spacing);
  else if (b->area > 0)
    printf("%s on one bond, s = %.6g mm, A = %.6g mm^2", r->of.law->name, 1e3 * b->spacing,
           1e6 * b->area);
  else
    printf("%s on one bond, s = %.6g mm, t = %.6g mm", r->of.law->name, 1e3 * b->spacing,
           1e3 * b->thickness);
  printf(": %ld rows to %.6g s (%s)\n", t->rows, t->columns[DRIVE_COLUMN_TIME].values[t->rows - 1],
         r->of.law->context ? "interpreter" : "compiled");
  drive_print(r->in, t, stdout);
}

/* Row with the largest fall of what states have dissipated, counted from the rows before it; 0
   where it does not fall by more than a coarse path explains. */
static long largest_fall(const drive_table *t) {
  const drive_column *energy = &t->columns[t->column_count - DRIVE_ENERGY_COUNT];
  const double *lost = energy[DRIVE_ENERGY_DISSIPATED_DAMAGE].values;
  double most = 0, scale = 0, fall = 0;
  long row = 0;
  for (long k = 0; k < t->rows; k++) {
    scale = pl_fmax(scale, fabs(energy[DRIVE_ENERGY_STORED].values[k]) + fabs(lost[k]));
    most = pl_fmax(most, lost[k]);
    if (most - lost[k] <= fall) continue;
    fall = most - lost[k];
    row = k;
  }
  return fall > 1e-3 * scale ? row : 0;
}

static void note_fall(const driving *r) {
  const drive_table *t = &r->table;
  const long row = t->bad_row < 0 ? largest_fall(t) : 0;
  if (row == 0) return;
  printf("note: `dissipated_damage` falls, by most up to %.6g s, %s %.6g\n",
         t->columns[DRIVE_COLUMN_TIME].values[row], t->columns[t->way].name,
         t->columns[t->way].values[row]);
  if (r->of.model.law->results[RESULT_W])
    puts("  the law gives back more than its `energy W` says that it has stored: it makes energy");
  else
    puts(
        "  without `energy W` the stored energy is the work of the force at the states at hand: a\n"
        "  law whose states lock energy in should give W (`perilat help energy`), any other makes "
        "energy");
}

/* What is driven may be what `perilat check` rejects: its first error, in a line. */
static void note_rejected(driving *r) {
  diagnostics found;
  diag_begin(&found, &r->of.model.sources);
  if (!law_obeys_alone(r->of.model.law, &found)) {
    int first = 0;
    while (diag_severity(found.items[first].code) != SEVERITY_ERROR)
      first++;
    printf("note: `perilat check %s` rejects this law [%s]\n  %s\n", r->of.model.path,
           diag_name(found.items[first].code), found.items[first].message);
  }
  diag_clear(&found);
}

static void print_direction(const double *vector, int dimensions) {
  for (int k = 0; k < dimensions; k++)
    printf("%s%.4g", k ? ", " : "(", vector[k] + 0.0);
  putchar(')');
}

/* Where waves stop to run, and how the band of strain lies that may arise there. */
static void note_band(const driving *r) {
  const drive_table *t = &r->table;
  const ellipticity *e = &r->band.of;
  const int dimensions = r->of.law->dimensions, strains = PL_STRAINS(dimensions);
  double cosine = 0;
  if (r->band.row < 0) return;
  printf("note: ellipticity is lost at %.6g s:", t->columns[0].values[r->band.row]);
  for (int k = 0; k < strains; k++)
    printf("%s %s = %.6g", k ? "," : "", t->columns[1 + k].name,
           t->columns[1 + k].values[r->band.row] + 0.0);
  printf("\n  across n = ");
  print_direction(e->normal, dimensions);
  for (int k = 0; k < dimensions; k++)
    cosine += e->normal[k] * e->along[k];
  printf(" the smallest eigenvalue of n.D.n is %.4g Pa: strain may gather in a band, which %s\n",
         e->least, fabs(cosine) > sqrt(0.5) ? "opens" : "shears");
}

static bool spares_inputs(const driving *r) {
  const drive_output *o = &r->in->output;
  const char *const written[] = {o->csv, o->hdf5, o->picture};
  const char *reference = r->reference.of.opened ? r->reference.of.model.path : NULL;
  for (size_t k = 0; k < sizeof written / sizeof *written; k++)
    if (written[k] &&
        (same_file(written[k], r->options->path) || same_file(written[k], r->of.model.path) ||
         (reference && same_file(written[k], reference)))) {
      say_error("the output would overwrite `%s`", written[k]);
      return false;
    }
  return true;
}

static bool draw(const driving *r, char *error, size_t size) {
  const char *const labels[] = {r->in->material.model, r->options->against};
  if (!r->compared) return drive_draw(r->in, &r->table, r->in->output.picture, error, size);
  return difference_draw(r->in, &r->table, &r->reference.table, labels, r->in->output.picture,
                         error, size);
}

static bool write_files(const driving *r) {
  const drive_output *o = &r->in->output;
  char error[ERROR_LENGTH];
  bool good = true;
  const struct {
    const char *path;
    bool written;
  } files[] = {
      {o->csv, !o->csv || drive_write_csv(&r->table, o->csv, error, sizeof error)},
      {o->hdf5, !o->hdf5 || drive_write_hdf5(r->in, &r->table, o->hdf5, error, sizeof error)},
      {o->picture, !o->picture || draw(r, error, sizeof error)}};
  for (size_t k = 0; k < sizeof files / sizeof *files; k++) {
    if (files[k].path && files[k].written) printf("written %s\n", files[k].path);
    good = good && files[k].written;
  }
  if (!good) say_error("%s", error);
  return good;
}

/* So near that an extreme between two rows may be what is missed. */
static bool is_near(const drive_verdict *v) {
  return fabs(v->found - v->expected) <= 0.2 * fabs(v->expected);
}

static void print_verdict(const driving *r, const drive_expect *e, const drive_verdict *v) {
  place at = source_place(&r->sources, e->item.where.file, e->item.where.begin);
  const char *unit_text = unit_is_pure(v->unit) ? "" : v->unit;
  printf("%s  %s:%d: %s = %.9g%s%s", v->passed ? "PASS" : "FAIL", r->options->path, at.line,
         e->quantity, v->found + 0.0, *unit_text ? " " : "", unit_text); /* no minus before zeros */
  if (v->passed)
    printf(" (expected %.9g)\n", v->expected + 0.0);
  else
    printf(", expected %.9g: off by %.3g, %.3g is allowed (at %.6g s, %s %.6g)\n",
           v->expected + 0.0, fabs(v->found - v->expected), v->allowed, v->time, v->way_name,
           v->way);
  if (!v->passed && v->extreme && is_near(v))
    printf("      the rows beside it are at %.6g s and %.6g s; an extreme between them is found by "
           "more steps: --set simulation.steps=%d\n",
           v->beside[0], v->beside[1], 10 * r->in->simulation.steps);
}

static int judge(driving *r) {
  const int count = r->in->expect_count;
  r->verdicts = arena_alloc(r->memory, ((size_t)count + 1) * sizeof *r->verdicts);
  drive_judge(r->expectations, r->of.parameters, &r->table, r->verdicts);
  int passed = 0;
  for (int k = 0; k < count; k++) {
    print_verdict(r, &r->in->expects[k], &r->verdicts[k]);
    passed += r->verdicts[k].passed;
  }
  if (count) printf("%d of %d expectations hold\n", passed, count);
  return passed == count ? 0 : DRIVE_FAILED;
}

/* --- beside a reference ----------------------------------------------------------------------- */

/* 0, or an exit status. */
static int drive_the_other(driving *r) {
  const char *path = r->options->against;
  if (!path) return 0;
  if (!file_suits(path, FILES(LAW), "--against", "a law")) return INPUT_WRONG;
  const driven_outcome outcome =
      reference_law_drive(&r->reference, r->memory, r->in, path, NULL, &r->said);
  if (r->reference.of.opened) tell(r, &r->reference.of.model.said);
  if (outcome != DRIVEN_READY) return outcome == DRIVEN_NO_KERNEL ? DRIVE_FAILED : INPUT_WRONG;
  if (driven_law_kind(&r->reference.of) == driven_law_kind(&r->of)) return 0;
  say_error("`%s` and `%s` are laws of different things", r->in->material.model, path);
  return INPUT_WRONG;
}

static void compare(driving *r) {
  if (!r->options->against) return;
  table_difference_find(&r->difference, &r->table, &r->reference.table, r->options->tolerance,
                        r->reference.skip, true);
  r->compared = true;
}

static int tell_difference(const driving *r) {
  const table_difference *d = &r->difference;
  if (!r->compared) return 0;
  printf("against %s: ", r->options->against);
  difference_say(d, &r->table, "that of the reference", stdout);
  putchar('\n');
  difference_rows(d, &r->reference.table, (const char *const[]){"answer", "reference"}, "  ",
                  stdout);
  if (d->skipped)
    printf("  %ld of %ld rows are left out: there a case of the reference begins\n", d->skipped,
           d->rows);
  return d->kind == DIFFERENCE_NONE ? 0 : DRIVE_FAILED;
}

/* Everything that can be wrong before the bond moves. 0, or an exit status. */
static int prepare(driving *r) {
  if (!read_input(r)) return INPUT_WRONG;
  if (!r->in->material.model) return 0;
  const driven_outcome outcome =
      driven_law_open(&r->of, r->memory, r->in, r->options->compiled, &r->said);
  if (r->of.opened) tell(r, &r->of.model.said);
  if (outcome == DRIVEN_NO_KERNEL) return DRIVE_FAILED;
  if (outcome != DRIVEN_READY) return INPUT_WRONG;
  const int status = drive_the_other(r);
  if (status || !spares_inputs(r)) return status ? status : INPUT_WRONG;
  driven_law_columns(&r->of, &r->columns);
  r->expectations = drive_expectations_read(r->in, &r->of.model, &r->columns, &r->said);
  return r->expectations ? 0 : INPUT_WRONG;
}

/* 0, or an exit status. */
static int drive(driving *r) {
  int status = prepare(r);
  if (status || r->options->check_only) return status;
  if (!driven_law_march(&r->of, &r->table, &r->band)) return INPUT_WRONG;
  compare(r);
  describe(r);
  if (driven_law_kind(&r->of) != DRIVE_OF_FAMILIES) note_fall(r);
  if (driven_law_kind(&r->of) == DRIVE_OF_POINTS) note_band(r);
  note_rejected(r);
  bool written = write_files(r);
  if (r->table.bad_row >= 0) {
    report_bad(r);
    return DRIVE_FAILED;
  }
  const int apart = tell_difference(r);
  status = judge(r);
  status = status ? status : apart;
  return status ? status : written ? 0 : DRIVE_FAILED;
}

static void close_drive(driving *r) {
  if (r->expectations) drive_expectations_free(r->expectations);
  if (r->columns.memory) drive_table_free(&r->columns);
  if (r->table.memory) drive_table_free(&r->table);
  if (r->compared) table_difference_free(&r->difference);
  reference_law_close(&r->reference);
  driven_law_close(&r->of);
  diag_clear(&r->said);
  source_clear(&r->sources);
  arena_free(r->memory);
}

static void print_checked(const driving *r) {
  static const char *const things[] = {
      [DRIVE_OF_BONDS] = "bond", [DRIVE_OF_FAMILIES] = "particle", [DRIVE_OF_POINTS] = "point"};
  const char *path = r->options->path;
  if (r->of.law)
    printf("%s: no errors; a path that drives one %s of `%s`, with %d expectation%s\n  perilat "
           "drive %s\n",
           path, things[driven_law_kind(&r->of)], r->of.law->name, r->in->expect_count,
           r->in->expect_count == 1 ? "" : "s", path);
  else
    printf("%s: no errors; a path that names no law, so that its expectations are not checked\n"
           "  perilat drive law.plm %s\n",
           path, path);
}

/* --- for other programs ----------------------------------------------------------------------- */

static void put_expectations(const driving *r, json *j) {
  json_put_array(j, "expectations");
  for (int k = 0; k < r->in->expect_count; k++) {
    const drive_verdict *v = &r->verdicts[k];
    const span where = r->in->expects[k].item.where;
    json_object(j);
    json_put_text(j, "quantity", r->in->expects[k].quantity);
    json_put_integer(j, "line", source_place(&r->sources, where.file, where.begin).line);
    json_put_bool(j, "passed", v->passed);
    json_put_number(j, "found", v->found);
    json_put_number(j, "expected", v->expected);
    json_put_number(j, "allowed", v->allowed);
    json_put_text(j, "unit", v->unit);
    json_object_end(j);
  }
  json_array_end(j);
}

static void put_difference(const driving *r, json *j) {
  char *sentence;
  size_t length;
  FILE *out = must_open_text(&sentence, &length);
  difference_say(&r->difference, &r->table, "that of the reference", out);
  must_close_text(out);
  json_put_object(j, "against");
  json_put_text(j, "reference", r->options->against);
  json_put_bool(j, "equal", r->difference.kind == DIFFERENCE_NONE);
  json_put_text(j, "sentence", sentence);
  difference_json(&r->difference, &r->reference.table, j);
  json_object_end(j);
  free(sentence);
}

/* What was driven, what was expected, what it was compared with. */
static void put_drive(const driving *r, json *j) {
  if (!r->table.memory) return;
  json_put_text(j, "law", r->of.law->name);
  json_put_integer(j, "rows", r->table.rows);
  if (r->verdicts) put_expectations(r, j);
  if (r->compared) put_difference(r, j);
}

static int drive_as_asked(const drive_options *o, json *j) {
  driving r = {.options = o, .memory = arena_new()};
  diag_begin(&r.said, &r.sources);
  if (o->confined) model_confine(o->path, NULL);
  int status = drive(&r);
  if (!status && o->check_only && !o->report) print_checked(&r);
  fflush(stdout);
  tell(&r, &r.said);
  if (j) {
    diag_json_end(o->report, status != INPUT_WRONG);
    put_drive(&r, j);
  }
  close_drive(&r);
  return status;
}

static int drive_to_json(drive_options *o) {
  document d;
  diag_json report;
  document_begin(&d);
  diag_json_begin(&report, &d.writer, o->path);
  o->report = &report;
  return document_end(&d, drive_as_asked(o, &d.writer));
}

int drive_check(const char *path, const char *const *settings, int count, diag_json *report) {
  const drive_options o = {.path = path,
                           .settings = settings,
                           .setting_count = count,
                           .check_only = true,
                           .report = report};
  return drive_as_asked(&o, NULL);
}

int command_drive(int argc, char **argv) {
  const char **settings = must_calloc((size_t)argc + 1, sizeof *settings);
  drive_options o = {.settings = settings, .tolerance = 1e-6};
  int status = INPUT_WRONG;
  if (read_options(argc, argv, &o, settings))
    status = o.json ? drive_to_json(&o) : drive_as_asked(&o, NULL);
  free(settings);
  return status;
}
