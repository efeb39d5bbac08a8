/* perilat info: what a law implies, what a deck or a result holds, and the names that laws may
   use. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "dsl/base/characters.h"
#include "dsl/base/elementary.h"
#include "generator/command/commands.h"
#include "generator/command/info_law.h"
#include "generator/drive/drive_grammar.h"
#include "generator/kernel/document.h"
#include "generator/kernel/model.h"
#include "generator/kernel/standard_input.h"
#include "generator/results/result_table.h"
#include "generator/run/run.h"
#include "generator/study/study_info.h"
#include "generator/study/study_read.h"
#include "generator/study/study_request.h"
#include "runtime/result/result_fields.h"
#include "runtime/result/result_find.h"
#include "runtime/result/result_names.h"
#include "runtime/result/result_read.h"
#include "runtime/simulation/modes.h"

/* --- --builtins ------------------------------------------------------------------------------- */

static int info_builtins(void) {
  printf("Quantities that a law may read:\n  %-18s %-11s %-9s %-15s %s\n", "name", "unit", "lives",
         "laws", "meaning");
  for (int q = 0; q < QUANTITY_COUNT; q++) {
    const builtin_quantity_info *b = &builtin_quantities[q];
    printf("  %-18s %-11s %-9s %-15s %s\n", b->name, b->unit, placement_name(b->place),
           builtin_laws(b->kinds), b->meaning);
  }
  printf("\nFunctions:\n");
  for (int f = 0; f < FUNCTION_COUNT; f++) {
    const builtin_function_info *b = &builtin_functions[f];
    if (b->least == b->most)
      printf("  %-13s %d argument%s  %s\n", b->name, b->least, b->least == 1 ? " " : "s",
             b->meaning);
    else
      printf("  %-13s %d to %-7d %s\n", b->name, b->least, b->most, b->meaning);
  }
  return 0;
}

/* --- results ---------------------------------------------------------------------------------- */

typedef struct history_facts {
  const char *name;
  char unit[64], unchecked[256]; /* why a series that judges the run does not, or "" */
  long count;
  double least, largest, last;
} history_facts;

/* False after a message. */
static bool read_history(result_file *f, const char *name, history_facts *h) {
  char error[2048];
  *h = (history_facts){.name = name, .least = NAN, .largest = NAN, .last = NAN};
  double *v = result_read_series(f, name, &h->count, h->unit, sizeof h->unit, error, sizeof error);
  if (!v) say_error("%s", error);
  for (long k = 0; v && k < h->count; k++) {
    h->least = k ? pl_fmin(h->least, v[k]) : v[k];
    h->largest = k ? pl_fmax(h->largest, v[k]) : v[k];
    h->last = v[k];
  }
  free(v);
  result_read_unchecked(f, name, h->unchecked, sizeof h->unchecked);
  return v != NULL;
}

static void print_history(const history_facts *h) {
  if (h->count == 0) return;
  if (*h->unchecked)
    printf("  %-26s %-6s not checked: %s\n", name_shown(h->name), name_shown(h->unit),
           name_shown(h->unchecked));
  else /* no minus before zeros */
    printf("  %-26s %-6s from %.6g to %.6g, last %.6g\n", name_shown(h->name), name_shown(h->unit),
           h->least + 0.0, h->largest + 0.0, h->last + 0.0);
}

static void put_history(json *w, const history_facts *h) {
  json_object(w);
  json_put_text(w, "name", h->name);
  json_put_text(w, "unit", *h->unit ? h->unit : "1");
  json_put_integer(w, "samples", h->count);
  json_put_number(w, "least", h->least + 0.0);
  json_put_number(w, "largest", h->largest + 0.0);
  json_put_number(w, "last", h->last + 0.0);
  json_put_text(w, "unchecked", *h->unchecked ? h->unchecked : NULL);
  json_object_end(w);
}

/* Says it as text, or in the list of the document. False after a message. */
static bool tell_history(result_file *f, const char *name, json *w) {
  history_facts h;
  if (!read_history(f, name, &h)) return false;
  if (w)
    put_history(w, &h);
  else
    print_history(&h);
  return true;
}

/* All histories, the time first. */
static bool tell_histories(result_file *f, json *w) {
  result_names names = result_members(f, "/history");
  bool good = tell_history(f, "time", w);
  for (int k = 0; k < names.count; k++)
    good = tell_history(f, names.items[k], w) && good;
  result_names_free(&names);
  return good;
}

typedef struct result_sizes {
  long particles, bonds, frames;
  int dimensions;
} result_sizes;

/* False after a message. */
static bool read_sizes(result_file *f, const char *path, result_sizes *s) {
  *s = (result_sizes){0};
  double *places = result_read_reference(f, &s->particles, &s->dimensions);
  const bool placed = places != NULL;
  free(places);
  free(result_read_bonds(f, NULL, &s->bonds));
  free(result_read_frame_times(f, &s->frames));
  if (!placed) say_error("`%s` does not say where its particles are", path);
  return placed;
}

/* How the run ended, and what made it; results of earlier versions do not say. */
static void print_ending(result_file *f) {
  char *ended = result_read_words(f, "ended"), *compiler = result_read_words(f, "compiler"),
       *flags = result_read_words(f, "flags"), *started = result_read_words(f, "started");
  if (*ended)
    printf("Ended: %s (status %.0f); %.0f steps in %.3g s of wall time, %.0f thread%s, begun %s\n",
           ended, result_read_number(f, "status"), result_read_number(f, "steps"),
           result_read_number(f, "wall_seconds"), result_read_number(f, "threads"),
           result_read_number(f, "threads") > 1 ? "s" : "", started);
  if (*compiler) printf("Compiler of the law: %s%s%s\n", compiler, *flags ? ", " : "", flags);
  free(ended);
  free(compiler);
  free(flags);
  free(started);
}

static void put_words(json *w, const char *name, char *text) {
  json_put_text(w, name, *text ? text : NULL);
  free(text);
}

static void put_ending(result_file *f, json *w) {
  static const char *const words[] = {"started", "ended", "compiler", "flags"}, *const numbers[] = {
                                                                                    "status",
                                                                                    "steps",
                                                                                    "wall_seconds",
                                                                                    "threads"};
  for (size_t k = 0; k < sizeof words / sizeof *words; k++)
    put_words(w, words[k], result_read_words(f, words[k]));
  for (size_t k = 0; k < sizeof numbers / sizeof *numbers; k++)
    json_put_number(w, numbers[k], result_read_number(f, numbers[k]));
}

/* "width: 3 in the last frame, the widest 0.21 mm; at most 4 in a frame" */
static bool print_cracks(result_file *f, const char *monitor) {
  char error[1024];
  long frames = 0, most = 0, last = 0, largest = 0;
  double widest = 0;
  double *values = result_read_cracks(f, monitor, &frames, &most, error, sizeof error);
  if (!values) say_error("%s", error);
  for (long n = 0; values && n < frames; n++) {
    last = 0;
    widest = 0;
    for (long k = n * most; k < (n + 1) * most && !isnan(values[2 * k]); k++, last++)
      widest = pl_fmax(widest, values[2 * k + 1]);
    largest = last > largest ? last : largest;
  }
  if (values)
    printf("Cracks of `%s`: %ld in the last frame, the widest %.4g mm; at most %ld in a frame\n",
           name_shown(monitor), last, 1e3 * widest, largest);
  free(values);
  return values != NULL;
}

static long points_in(const double *points, long most) {
  long count = 0;
  while (count < most && !isnan(points[2 * count]))
    count++;
  return count;
}

static double length_of(const double *points, long count) {
  double sum = 0;
  for (long k = 1; k < count; k++)
    sum += pl_hypot(points[2 * k] - points[2 * k - 2], points[2 * k + 1] - points[2 * k - 1]);
  return sum;
}

/* "from (114.3, -38.1) to (114.3, -35.7) mm, 2.381 mm long; 19.05 mm in the first frame" */
static bool print_path(result_file *f, const char *crack) {
  char error[1024];
  long frames = 0, most = 0;
  double *points = result_read_path(f, crack, &frames, &most, error, sizeof error);
  if (!points) say_error("%s", error);
  if (points && frames > 0) {
    const double *last = points + 2 * most * (frames - 1);
    const long count = points_in(last, most);
    if (count > 0)
      printf("Crack `%s`: from (%.6g, %.6g) to (%.6g, %.6g) mm in the last frame, %.5g mm long; "
             "%.5g mm in the first\n",
             name_shown(crack), 1e3 * last[0], 1e3 * last[1], 1e3 * last[2 * count - 2],
             1e3 * last[2 * count - 1], 1e3 * length_of(last, count),
             1e3 * length_of(points, points_in(points, most)));
  }
  free(points);
  return points != NULL;
}

/* What moves in a run: "particles", of meshes alone "nodes". */
static const char *what_moves(result_file *f, const result_sizes *s) {
  result_names meshes = result_list(f, "/meshes");
  const bool any = meshes.count > 0;
  result_names_free(&meshes);
  return !any ? "particles" : s->bonds > 0 ? "nodes and particles" : "nodes";
}

static bool print_result(result_file *f, const char *path) {
  result_sizes s;
  bool good = read_sizes(f, path, &s);
  if (good)
    printf("%s: %ld %s%s, %ld bonds, %ld frames\n", path, s.particles, what_moves(f, &s),
           s.dimensions == 3 ? " in space" : "", s.bonds, s.frames);
  print_ending(f);
  char *overrides = result_read_text(f, "/input/set");
  if (overrides) printf("Set on the command line:\n%s", overrides);
  free(overrides);
  result_names files = result_list(f, "/input/files");
  for (int k = 0; k < files.count; k++)
    printf("%s%s%s", k ? ", " : "Loads from files: ", files.items[k],
           k + 1 < files.count ? "" : "\n");
  result_names_free(&files);
  puts("Histories:");
  good = tell_histories(f, NULL) && good;
  result_names fields = result_members(f, "/frames");
  printf("Frames hold:");
  for (int k = 0; k < fields.count; k++)
    printf("%s %s", k ? "," : "", name_shown(fields.items[k]));
  puts(fields.count ? "" : " nothing");
  result_names_free(&fields);
  result_names cracks = result_list(f, "/cracks");
  for (int k = 0; k < cracks.count; k++)
    good = (result_has_path(f, cracks.items[k]) ? print_path(f, cracks.items[k])
                                                : print_cracks(f, cracks.items[k])) &&
           good;
  result_names_free(&cracks);
  return good;
}

static void put_lines(json *w, const char *name, char *lines) {
  json_put_array(w, name);
  for (char *line = lines ? strtok(lines, "\n") : NULL; line; line = strtok(NULL, "\n"))
    json_text(w, line);
  json_array_end(w);
}

static bool put_result(result_file *f, const char *path, json *w) {
  result_sizes s;
  const bool sized = read_sizes(f, path, &s);
  char *title = result_read_title(f), *overrides = result_read_text(f, "/input/set");
  json_put_text(w, "result", path);
  json_put_text(w, "title", title && *title ? title : NULL);
  json_put_integer(w, "dimensions", s.dimensions);
  json_put_integer(w, "particles", s.particles);
  json_put_integer(w, "bonds", s.bonds);
  json_put_integer(w, "frames", s.frames);
  put_lines(w, "set", overrides);
  put_ending(f, w);
  free(title);
  free(overrides);
  json_put_array(w, "histories");
  const bool good = tell_histories(f, w) && sized;
  json_array_end(w);
  result_names fields = result_members(f, "/frames");
  json_put_array(w, "fields");
  for (int k = 0; k < fields.count; k++)
    json_text(w, fields.items[k]);
  json_array_end(w);
  result_names_free(&fields);
  result_names cracks = result_list(f, "/cracks");
  json_put_array(w, "cracks");
  for (int k = 0; k < cracks.count; k++)
    json_text(w, cracks.items[k]);
  json_array_end(w);
  result_names_free(&cracks);
  return good;
}

/* As text, or into the document. */
static int info_result(const char *path, json *w) {
  if (study_is_table(path)) return study_info(path, w) ? 0 : 1;
  result_file *f = table_open("perilat info", path);
  if (!f) return 1;
  const bool good = w ? put_result(f, path, w) : print_result(f, path);
  return table_close(f, good) ? 0 : 1;
}

typedef struct info_options {
  const char *file;
  info_law_options law;
  int modes;          /* 0: not asked for */
  const char *shapes; /* result that is written of them, or NULL */
  bool builtins, json;
} info_options;

static bool asks_about_law(const info_options *o) {
  const info_law_options *l = &o->law;
  return l->spacing || l->thickness || l->area || l->lattice || l->horizon || l->shells;
}

static bool read_modes(const char *text, int *modes) {
  char *end;
  const long value = strtol(text, &end, 10);
  *modes = (int)value;
  if (!*end && end != text && value >= 1 && value <= MODES_MOST) return true;
  say_error("--modes needs a whole number from 1 to %d, not `%s`", MODES_MOST, text);
  return false;
}

static bool read_options(int argc, char **argv, const char **settings, info_options *o) {
  int bad = 0;
  for (int at = 0; at < argc && !bad;) {
    const char *value;
    if (option_flag(argv, &at, "--builtins"))
      o->builtins = true;
    else if (option_flag(argv, &at, "--json"))
      o->json = true;
    else if ((value = option_value(argc, argv, &at, "--spacing", &bad)))
      o->law.spacing = value;
    else if ((value = option_value(argc, argv, &at, "--thickness", &bad)))
      o->law.thickness = value;
    else if ((value = option_value(argc, argv, &at, "--area", &bad)))
      o->law.area = value;
    else if ((value = option_value(argc, argv, &at, "--lattice", &bad)))
      o->law.lattice = value;
    else if ((value = option_value(argc, argv, &at, "--horizon", &bad)))
      o->law.horizon = value;
    else if ((value = option_value(argc, argv, &at, "--shells", &bad)))
      o->law.shells = value;
    else if ((value = option_value(argc, argv, &at, "--modes", &bad)))
      bad = bad || !read_modes(value, &o->modes);
    else if ((value = option_value(argc, argv, &at, "-o", &bad)))
      o->shapes = value;
    else if ((value = option_value(argc, argv, &at, "--set", &bad)))
      settings[o->law.setting_count++] = value;
    else if (is_option_like(argv[at]))
      bad = option_unknown("info", argv[at]);
    else if (o->file || o->builtins)
      bad = 2;
    else
      o->file = argv[at++];
  }
  if (bad == 2 || (!bad && !o->file == !o->builtins)) {
    say_error("`perilat info` takes one law, deck or result, or --builtins");
    return false;
  }
  o->law.settings = settings;
  if (!bad && o->builtins &&
      (o->json || o->modes || o->shapes || o->law.setting_count || asks_about_law(o))) {
    say_error("--builtins takes no other option");
    return false;
  }
  return !bad;
}

static int info_about_law(const info_options *o, json *w) {
  info_law_options asked = o->law;
  diag_json report;
  asked.law = o->file;
  asked.report = w ? &report : NULL;
  if (w) diag_json_begin(&report, w, o->file);
  return info_law(&asked);
}

/* Options that do not go with the file; false after a message. */
static bool options_fit(const info_options *o, file_kind kind) {
  const char *what = kind == FILE_DECK ? "deck" : kind == FILE_RESULT ? "result" : "law";
  const bool is_law = kind != FILE_DECK && kind != FILE_RESULT;
  const char *why = NULL;
  if (!is_law && asks_about_law(o))
    why = "--lattice, --spacing and their like ask about a law";
  else if (kind == FILE_RESULT && o->law.setting_count)
    why = "--set is for laws and decks";
  else if (kind == FILE_DECK && o->json && !o->modes)
    why = "--json is for laws, results and, with --modes, decks";
  else if (kind != FILE_DECK && o->modes)
    why = "--modes is for decks";
  else if (kind != FILE_DECK && o->shapes)
    why = "-o is for the shapes of a deck's modes";
  else if (o->shapes && !o->modes)
    why = "-o is for the shapes of its modes; add --modes N";
  if (why) say_error("`%s` is a %s; %s", o->file, what, why);
  return !why;
}

static int info_deck(const info_options *o, json *w) {
  const int count = o->law.setting_count;
  deck_override *overrides = must_calloc((size_t)count + 1, sizeof *overrides);
  for (int k = 0; k < count; k++)
    overrides[k].text = o->law.settings[k];
  diag_json report;
  if (w) diag_json_begin(&report, w, o->file);
  const int status = run_deck(&(run_options){.deck_path = o->file,
                                             .overrides = overrides,
                                             .override_count = count,
                                             .modes = o->modes,
                                             .shapes = o->shapes,
                                             .report = w ? &report : NULL,
                                             .check_only = true});
  free(overrides);
  return status;
}

/* w: of the document, or NULL. */
static int info_file(const info_options *o, json *w) {
  const file_kind kind = kind_of_file(o->file);
  if (!options_fit(o, kind)) return 1;
  if (!file_suits(o->file, FILES(LAW) | FILES(DECK) | FILES(RESULT), "perilat info",
                  "a law, a deck or a result"))
    return 1;
  if (kind == FILE_RESULT && is_standard_input(o->file)) {
    say_error("a result is not read from the standard input; give it as a file");
    return 1;
  }
  if (kind == FILE_RESULT) return info_result(o->file, w);
  if (kind == FILE_DECK && (drive_refuse_path("info", o->file) || study_refuse("info", o->file)))
    return 1;
  return kind == FILE_DECK ? info_deck(o, w) : info_about_law(o, w);
}

static int info_as_asked(const info_options *o) {
  if (o->builtins) return info_builtins();
  if (!o->json) return info_file(o, NULL);
  document d;
  document_begin(&d);
  return document_end(&d, info_file(o, &d.writer));
}

int command_info(int argc, char **argv) {
  const char **settings = must_calloc((size_t)argc + 1, sizeof *settings);
  info_options o = {.file = NULL};
  int status = 1;
  if (read_options(argc, argv, settings, &o)) status = info_as_asked(&o);
  free(settings);
  return status;
}
