/* perilat info: what a law implies, what a deck or a result holds, and the names that laws may use. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "dsl/elementary.h"
#include "generator/commands.h"
#include "generator/drive.h"
#include "generator/info_law.h"
#include "generator/model.h"
#include "generator/result_table.h"
#include "generator/run.h"

/* --- --builtins ------------------------------------------------------------------------------- */

static int info_builtins(void) {
  static const char *const kinds[] = {
      "",      "central",           "micropolar",           "pairwise",
      "state", "central and state", "micropolar and state", "all"};
  printf("Quantities that a law may read:\n  %-13s %-7s %-9s %-11s %s\n", "name", "unit", "lives",
         "laws", "meaning");
  for (int q = 0; q < QUANTITY_COUNT; q++) {
    const builtin_quantity_info *b = &builtin_quantities[q];
    printf("  %-13s %-7s %-9s %-11s %s\n", b->name, b->unit, placement_name(b->place),
           kinds[b->kinds & 7], b->meaning);
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

/* False after a message. */
static bool print_history(result_file *f, const char *name) {
  char unit_text[64] = "", error[2048];
  long count = 0;
  double *v = result_read_series(f, name, &count, unit_text, sizeof unit_text, error, sizeof error);
  if (!v) fprintf(stderr, "perilat: error: %s\n", error);
  if (!v || count == 0) {
    free(v);
    return v != NULL;
  }
  double low = v[0], high = v[0];
  for (long k = 0; k < count; k++) {
    low = pl_fmin(low, v[k]);
    high = pl_fmax(high, v[k]);
  }
  char why[256];
  result_read_unchecked(f, name, why, sizeof why);
  if (*why)
    printf("  %-26s %-6s not checked: %s\n", name, unit_text, why);
  else /* no minus before zeros */
    printf("  %-26s %-6s from %.6g to %.6g, last %.6g\n", name, unit_text, low + 0.0, high + 0.0,
           v[count - 1] + 0.0);
  free(v);
  return true;
}

/* False after a message. */
static bool print_sizes(result_file *f, const char *path) {
  long particles = 0, bonds = 0, frames = 0;
  int dimensions;
  double *places = result_read_reference(f, &particles, &dimensions);
  const bool placed = places != NULL;
  free(places);
  free(result_read_bonds(f, NULL, &bonds));
  free(result_read_frame_times(f, &frames));
  if (placed)
    printf("%s: %ld particles%s, %ld bonds, %ld frames\n", path, particles,
           dimensions == 3 ? " in space" : "", bonds, frames);
  else
    fprintf(stderr, "perilat: error: `%s` does not say where its particles are\n", path);
  return placed;
}

static int info_result(const char *path) {
  result_file *f = table_open("perilat info", path);
  if (!f) return 1;
  bool good = print_sizes(f, path);
  char *overrides = result_read_text(f, "/input/set");
  if (overrides) printf("Set on the command line:\n%s", overrides);
  free(overrides);
  puts("Histories:");
  good = print_history(f, "time") && good;
  result_names histories = result_members(f, "/history"), fields = result_members(f, "/frames");
  for (int k = 0; k < histories.count; k++)
    good = print_history(f, histories.items[k]) && good;
  printf("Frames hold:");
  for (int k = 0; k < fields.count; k++)
    printf("%s %s", k ? "," : "", fields.items[k]);
  puts(fields.count ? "" : " nothing");
  result_names_free(&histories);
  result_names_free(&fields);
  return table_close(f, good) ? 0 : 1;
}

typedef struct info_options {
  const char *file;
  info_law_options law;
  bool builtins;
} info_options;

static bool read_options(int argc, char **argv, const char **settings, info_options *o) {
  int bad = 0;
  for (int at = 0; at < argc && !bad;) {
    const char *value;
    if (option_flag(argv, &at, "--builtins"))
      o->builtins = true;
    else if (option_flag(argv, &at, "--json"))
      o->law.json = true;
    else if ((value = option_value(argc, argv, &at, "--spacing", &bad)))
      o->law.spacing = value;
    else if ((value = option_value(argc, argv, &at, "--thickness", &bad)))
      o->law.thickness = value;
    else if ((value = option_value(argc, argv, &at, "--lattice", &bad)))
      o->law.lattice = value;
    else if ((value = option_value(argc, argv, &at, "--horizon", &bad)))
      o->law.horizon = value;
    else if ((value = option_value(argc, argv, &at, "--shells", &bad)))
      o->law.shells = value;
    else if ((value = option_value(argc, argv, &at, "--set", &bad)))
      settings[o->law.setting_count++] = value;
    else if (argv[at][0] == '-')
      bad = option_unknown("info", argv[at]);
    else if (o->file || o->builtins)
      bad = 2;
    else
      o->file = argv[at++];
  }
  if (bad == 2 || (!bad && !o->file == !o->builtins)) {
    fputs("perilat: error: `perilat info` takes one law, deck or result, or --builtins\n", stderr);
    return false;
  }
  o->law.settings = settings;
  return !bad;
}

static int info_file(const info_options *o) {
  file_kind kind = kind_of_file(o->file);
  bool asks_law = o->law.spacing || o->law.thickness || o->law.lattice || o->law.horizon ||
                  o->law.shells || o->law.setting_count || o->law.json;
  if (asks_law && (kind == FILE_RESULT || kind == FILE_DECK)) {
    fprintf(stderr,
            "perilat: error: `%s` is a %s; --lattice, --spacing, --set, --json and their like ask "
            "about a law\n",
            o->file, kind == FILE_DECK ? "deck" : "result");
    return 1;
  }
  if (!file_suits(o->file, FILES(LAW) | FILES(DECK) | FILES(RESULT), "perilat info",
                  "a law, a deck or a result"))
    return 1;
  if (kind == FILE_RESULT) return info_result(o->file);
  if (kind == FILE_DECK && drive_refuse_path("info", o->file)) return 1;
  if (kind == FILE_DECK) return run_deck(&(run_options){.deck_path = o->file, .check_only = true});
  info_law_options law_options = o->law;
  law_options.law = o->file;
  return info_law(&law_options);
}

int command_info(int argc, char **argv) {
  const char **settings = must_calloc((size_t)argc + 1, sizeof *settings);
  info_options o = {.file = NULL};
  int status = 1;
  if (read_options(argc, argv, settings, &o)) status = o.builtins ? info_builtins() : info_file(&o);
  free(settings);
  return status;
}
