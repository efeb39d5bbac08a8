#include "generator/page/page_result.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "dsl/base/elementary.h"
#include "generator/kernel/document.h"
#include "generator/page/html.h"
#include "generator/results/result_table.h"
#include "runtime/deck/deck_read.h"
#include "runtime/result/result_find.h"
#include "runtime/result/result_read.h"

/* --- texts ------------------------------------------------------------------------------------ */

static const char *keep(arena *a, char *text) {
  const char *kept = text ? arena_text(a, text, strlen(text)) : "";
  free(text);
  return kept;
}

static const char *file_name(const char *path) {
  const char *slash = strrchr(path, '/');
  return slash && slash[1] ? slash + 1 : path;
}

const char *page_without_folders(const page_result *p, const char *text) {
  static const char before[] = " \n\t('\"`=,", behind[] = " \n\t)'\"`,;";
  char *out = arena_alloc(p->memory, strlen(text) + 1);
  size_t to = 0;
  for (const char *at = text; *at; at++) {
    const size_t length = strcspn(at, behind);
    size_t last = 0;
    if (*at == '/' && (at == text || strchr(before, at[-1])))
      for (size_t k = 0; k + 1 < length; k++)
        if (at[k] == '/') last = k + 1;
    at += last;
    out[to++] = *at;
  }
  out[to] = 0;
  return out;
}

/* One folder more than `name` has of `path`; the same where there is none. */
static const char *with_folder(const char *path, const char *name) {
  if (name == path || name - 1 == path) return name;
  const char *at = name - 1;
  while (at > path && at[-1] != '/')
    at--;
  return at;
}

void page_results_name(page_result *results, int count) {
  for (int k = 0; k < count; k++)
    results[k].shown = file_name(results[k].path);
  while (count == 2 && strcmp(results[0].shown, results[1].shown) == 0) {
    const char *longer[2];
    for (int k = 0; k < 2; k++)
      longer[k] = with_folder(results[k].path, results[k].shown);
    if (longer[0] == results[0].shown || longer[1] == results[1].shown) return;
    for (int k = 0; k < 2; k++)
      results[k].shown = longer[k];
  }
}

static void read_texts(page_result *p) {
  result_file *f = p->file;
  arena *a = p->memory;
  p->title = keep(a, result_read_title(f));
  p->deck_name = keep(a, result_read_words(f, "deck"));
  p->deck_text = keep(a, result_read_text(f, "/input/deck"));
  p->set = keep(a, result_read_text(f, "/input/set"));
  p->ended = keep(a, result_read_words(f, "ended"));
  p->started = keep(a, result_read_words(f, "started"));
  p->version = keep(a, result_read_words(f, "perilat_version"));
  p->compiler = keep(a, result_read_words(f, "compiler"));
  p->flags = keep(a, result_read_words(f, "flags"));
  p->said_begin = keep(a, result_read_text(f, "/said/begin"));
  p->said_end = keep(a, result_read_text(f, "/said/end"));
  p->said_warnings = keep(a, result_read_text(f, "/said/warnings"));
  p->said_begin = page_without_folders(p, p->said_begin);
  p->said_end = page_without_folders(p, p->said_end);
  p->said_warnings = page_without_folders(p, p->said_warnings);
  p->status = result_read_number(f, "status");
  p->steps = result_read_number(f, "steps");
  p->step = result_read_number(f, "dt");
  p->wall = result_read_number(f, "wall_seconds");
  p->threads = result_read_number(f, "threads");
}

/* --- the deck --------------------------------------------------------------------------------- */

/* Those of --set, but for the result's place, which is of no interest here. */
static deck_override *overrides_of(page_result *p, int *count) {
  size_t most = 1;
  for (const char *c = p->set; *c; c++)
    most += *c == '\n';
  deck_override *all = arena_alloc(p->memory, (most + 1) * sizeof *all);
  *count = 0;
  for (const char *line = p->set; *line;) {
    const size_t length = strcspn(line, "\n");
    if (length) all[(*count)++].text = arena_text(p->memory, line, length);
    line += length + (line[length] == '\n');
  }
  return all;
}

/* Tables of loads stand in the result; particles and meshes of files do not, and are looked for
   where the deck has them. */
static void read_deck(page_result *p) {
  diag_begin(&p->said, &p->sources);
  if (!*p->deck_text) return;
  const char *name = *p->deck_name ? p->deck_name : "deck.nml";
  const int file = source_add(&p->sources, name, p->deck_text, strlen(p->deck_text));
  result_names files = result_list(p->file, "/input/files");
  for (int k = 0; k < files.count; k++) {
    char *path = deck_file_path(name, files.items[k]);
    const char *text =
        keep(p->memory,
             result_read_text(p->file, arena_printf(p->memory, "/input/files/%s", files.items[k])));
    source_add(&p->sources, path, text, strlen(text));
    free(path);
  }
  result_names_free(&files);
  int count;
  const deck_override *overrides = overrides_of(p, &count);
  p->deck = deck_read_what_is_right(p->memory, &p->sources, file, overrides, count, &p->said);
}

/* --- histories -------------------------------------------------------------------------------- */

/* NULL after a message. */
static const double *series_of(page_result *p, const char *name, page_series *s) {
  char error[1024];
  table_values v;
  const bool read = table_read(p->file, name, -1, &v, error, sizeof error);
  if (!read) say_error("%s", error);
  const bool fits = read && (p->samples < 0 || v.count == p->samples);
  if (read && !fits)
    say_error("`%s` has %ld values where %ld are expected", name, v.count, p->samples);
  double *kept = fits ? arena_alloc(p->memory, ((size_t)v.count + 1) * sizeof *kept) : NULL;
  for (long k = 0; kept && k < v.count; k++)
    kept[k] = v.values[k] + 0.0; /* no minus before zeros */
  if (kept) {
    p->samples = v.count;
    *s = (page_series){arena_text(p->memory, name, strlen(name)),
                       *v.unit ? arena_text(p->memory, v.unit, strlen(v.unit)) : "1", kept,
                       arena_text(p->memory, v.unchecked, strlen(v.unchecked))};
  }
  if (read) free(v.values);
  return kept;
}

static bool read_histories(page_result *p) {
  result_names names = result_members(p->file, "/history");
  page_series *all = arena_alloc(p->memory, ((size_t)names.count + 1) * sizeof *all), time;
  p->samples = -1;
  p->time = series_of(p, "time", &time);
  bool good = p->time != NULL;
  for (int k = 0; good && k < names.count; k++)
    good = series_of(p, names.items[k], &all[p->series_count]) && ++p->series_count;
  p->series = all;
  p->quasi_static = result_is_quasi_static(p->file);
  result_names_free(&names);
  return good;
}

int page_series_find(const page_result *p, const char *name) {
  for (int k = 0; k < p->series_count; k++)
    if (strcmp(p->series[k].name, name) == 0) return k;
  return -1;
}

const char *page_series_words(const char *name) {
  static const char *const words[][2] = {
      {"energy/external", "external work"},
      {"energy/rest", "work of rest states and fields"},
      {"energy/kinetic", "kinetic energy"},
      {"energy/stored", "stored energy"},
      {"energy/dissipated_damage", "dissipated by damage and states"},
      {"energy/dissipated_damping", "dissipated by damping"},
      {"energy/imbalance", "energy imbalance"},
      {"relaxation_steps", "steps of relaxation"},
      {"relaxation_unbalance", "unbalanced force"}};
  for (size_t k = 0; k < sizeof words / sizeof *words; k++)
    if (strcmp(name, words[k][0]) == 0) return words[k][1];
  return name;
}

/* The first of the deck's monitors of that kind; -1. */
static int monitor_of(const page_result *p, monitor_kind kind) {
  for (int k = 0; p->deck && k < p->deck->monitor_count; k++) {
    const int found =
        p->deck->monitors[k].kind == kind ? page_series_find(p, p->deck->monitors[k].name) : -1;
    if (found >= 0 && found != p->main) return found;
  }
  return -1;
}

/* A monitor stands in no folder. */
static void choose_main(page_result *p) {
  p->main = page_series_find(p, "load");
  for (int k = 0; p->main < 0 && p->deck && k < p->deck->monitor_count; k++)
    p->main = page_series_find(p, p->deck->monitors[k].name);
  for (int k = 0; p->main < 0 && k < p->series_count; k++)
    if (!strchr(p->series[k].name, '/')) p->main = k;
  p->over = monitor_of(p, MONITOR_OPENING);
  if (p->over < 0) p->over = monitor_of(p, MONITOR_DISPLACEMENT);
  if (p->over < 0) p->over = monitor_of(p, MONITOR_STRAIN);
  p->peak = -1;
  for (long k = 0; p->main >= 0 && k < p->samples; k++) {
    const double value = p->series[p->main].values[k];
    if (isfinite(value) && (p->peak < 0 || fabs(value) > fabs(p->series[p->main].values[p->peak])))
      p->peak = k;
  }
}

double page_largest_energy(const page_result *p) {
  static const char *const names[] = {"energy/kinetic", "energy/stored", "energy/external"};
  double largest = 0;
  for (size_t n = 0; n < sizeof names / sizeof *names; n++) {
    const int found = page_series_find(p, names[n]);
    for (long k = 0; found >= 0 && k < p->samples; k++)
      if (isfinite(p->series[found].values[k]))
        largest = pl_fmax(largest, fabs(p->series[found].values[k]));
  }
  return largest;
}

/* --- times ------------------------------------------------------------------------------------ */

/* Frames that are modes have numbers. */
static bool is_of_modes(const page_result *p) {
  return !p->quasi_static && page_series_find(p, "frequency") >= 0;
}

const char *page_time_name(const page_result *p) {
  return is_of_modes(p) ? "mode" : "time";
}

const char *page_time_unit(const page_result *p) {
  return is_of_modes(p) ? "1" : "s";
}

const char *page_moment(const page_result *p, double time, char text[PAGE_MOMENT]) {
  long nearest = 0;
  for (long k = 0; k < p->samples; k++)
    if (fabs(p->time[k] - time) < fabs(p->time[nearest] - time)) nearest = k;
  char value[HTML_QUANTITY];
  if (is_of_modes(p))
    snprintf(text, PAGE_MOMENT, "mode %.0f", time);
  else if (p->quasi_static)
    snprintf(text, PAGE_MOMENT, "increment %ld of %ld", nearest, p->samples - 1);
  else
    snprintf(text, PAGE_MOMENT, "t = %s", html_quantity(time, "s", value));
  return text;
}

/* --- the whole -------------------------------------------------------------------------------- */

static void read_frame_times(page_result *p) {
  double *times = result_read_frame_times(p->file, &p->frames);
  if (!times) p->frames = 0;
  double *kept = arena_alloc(p->memory, ((size_t)p->frames + 1) * sizeof *kept);
  if (p->frames) memcpy(kept, times, (size_t)p->frames * sizeof *kept);
  p->frame_times = kept;
  free(times);
}

bool page_result_open(page_result *p, const char *command, const char *path, const char *key) {
  *p = (page_result){.memory = arena_new(),
                     .path = path,
                     .shown = file_name(path),
                     .key = key,
                     .main = -1,
                     .over = -1};
  p->file = table_open(command, path);
  if (!p->file) return false;
  read_texts(p);
  read_deck(p);
  read_frame_times(p);
  if (!read_histories(p)) return false;
  choose_main(p);
  return true;
}

bool page_result_close(page_result *p, bool good) {
  if (p->file) good = table_close(p->file, good);
  diag_clear(&p->said);
  source_clear(&p->sources);
  arena_free(p->memory);
  return good;
}
