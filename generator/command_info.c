/* perilat info: what a law, a deck or a result holds, and the names that laws may use. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "generator/commands.h"
#include "generator/model.h"
#include "generator/run.h"
#include "runtime/result.h"

/* --- --builtins --------------------------------------------------------------------------------- */

static int info_builtins(void) {
  static const char *const kinds[] = {"", "central", "micropolar", "pairwise", "state", "central and state",
                                      "micropolar and state", "all"};
  printf("Quantities that a law may read:\n  %-13s %-7s %-9s %-11s %s\n", "name", "unit", "lives", "laws", "meaning");
  for (int q = 0; q < QUANTITY_COUNT; q++) {
    const builtin_quantity_info *b = &builtin_quantities[q];
    printf("  %-13s %-7s %-9s %-11s %s\n", b->name, b->unit, placement_name(b->place), kinds[b->kinds & 7], b->meaning);
  }
  printf("\nFunctions:\n");
  for (int f = 0; f < FUNCTION_COUNT; f++) {
    const builtin_function_info *b = &builtin_functions[f];
    if (b->least == b->most)
      printf("  %-13s %d argument%s  %s\n", b->name, b->least, b->least == 1 ? " " : "s", b->meaning);
    else
      printf("  %-13s %d to %-7d %s\n", b->name, b->least, b->most, b->meaning);
  }
  return 0;
}

/* --- laws --------------------------------------------------------------------------------------- */

static void print_parameter(const law *l, int p, const double *values) {
  const symbol *s = l->parameters.items[p];
  char unit_text[64], interval[128] = "";
  dim_unit(s->dim, unit_text, sizeof unit_text);
  if (s->declared->in.given)
    law_parameter_bounds(l, p, values, interval, sizeof interval);
  char value[32] = "(required)";
  if (s->has_default)
    snprintf(value, sizeof value, "%.6g", s->initial);
  printf("  %-12s %-12s %-10s %-18s %s\n", s->name, value, unit_text, interval, s->doc ? s->doc : "");
}

/* Further lines of a description stand below its first one. */
static void print_description(const char *text) {
  for (; *text; text++) {
    putchar(*text);
    if (*text == '\n')
      printf("%*s", 38, "");
  }
  putchar('\n');
}

static void print_symbols(const char *title, const symbol_list *list) {
  if (list->count)
    printf("%s\n", title);
  for (int k = 0; k < list->count; k++) {
    const symbol *s = list->items[k];
    char unit_text[64];
    dim_unit(s->dim, unit_text, sizeof unit_text);
    printf("  %-12s %-10s on %-9s ", s->name, unit_text, placement_name(s->place));
    print_description(s->doc ? s->doc : "");
  }
}

static void print_options(const law *l) {
  for (int k = 0; k < l->options.count; k++) {
    const stmt *declared = l->options.items[k]->declared;
    printf("option %s =", declared->name);
    for (int w = 0; w < declared->word_count; w++)
      printf("%s %s", w ? " |" : "", declared->words[w]);
    printf("   (now: %s)\n", l->chosen[k]);
  }
}

static void print_cost(const kernel_plan *p) {
  pl_law *interpreted = plan_interpreted(p, "");
  printf("Cost per bond and step: %.0f operations, %.0f of them divisions or roots; %d value%s computed once per lattice\n",
         interpreted->flops_per_bond, interpreted->divisions_per_bond, p->uniform_count,
         p->uniform_count == 1 ? "" : "s");
  plan_interpreted_free(interpreted);
}

static int info_law(const char *path) {
  static const char *const kinds[] = {"central bond", "micropolar bond", "state"};
  model m;
  bool good = model_open(&m, path, NULL, 0);
  if (good && m.law->tree->law != LAW_STATE)
    good = model_plan(&m);
  diag_print(&m.said, stderr);
  if (good) {
    const law *l = m.law;
    printf("%s (law %s)\n", l->tree->name, kinds[l->tree->law]);
    if (l->tree->doc)
      printf("%s\n", l->tree->doc);
    double *values = must_calloc((size_t)l->parameters.count + 1, sizeof *values);
    for (int p = 0; p < l->parameters.count; p++)
      values[p] = l->parameters.items[p]->initial;
    printf("Parameters (SI):\n");
    for (int p = 0; p < l->parameters.count; p++)
      print_parameter(l, p, values);
    free(values);
    print_options(l);
    print_symbols("State and damage:", &l->fields);
    print_symbols("Outputs:", &l->outputs);
    if (m.plan)
      print_cost(m.plan);
    if (l->nonconservative)
      printf("Not conservative: %s\n", l->nonconservative);
  }
  model_close(&m);
  return good ? 0 : 1;
}

/* --- results ------------------------------------------------------------------------------------ */

static void print_history(result_file *f, const char *name) {
  char unit_text[64] = "", error[512];
  long count = 0;
  double *v = result_read_series(f, name, &count, unit_text, sizeof unit_text, error, sizeof error);
  if (!v || count == 0) {
    free(v);
    return;
  }
  double low = v[0], high = v[0];
  for (long k = 0; k < count; k++) {
    low = fmin(low, v[k]);
    high = fmax(high, v[k]);
  }
  printf("  %-24s %-6s from %.6g to %.6g, last %.6g\n", name, unit_text, low + 0.0, high + 0.0,
         v[count - 1] + 0.0); /* no minus before zeros */
  free(v);
}

/* Each name of a comma-separated list through `show`. */
static void for_each_name(result_file *f, char *names, const char *prefix, void (*show)(result_file *, const char *)) {
  char *rest = names;
  for (char *name = strtok_r(names, ",", &rest); name; name = strtok_r(NULL, ",", &rest)) {
    char full[256];
    snprintf(full, sizeof full, "%s%s", prefix, name);
    if (strcmp(name, "energy") != 0)
      show(f, full);
  }
}

static int info_result(const char *path) {
  char error[1024];
  result_file *f = result_read(path, error, sizeof error);
  if (!f) {
    fprintf(stderr, "perilat: error: %s\n", error);
    return 1;
  }
  long particles = 0, bonds = 0, frames = 0;
  free(result_read_reference(f, &particles));
  free(result_read_bonds(f, NULL, &bonds));
  free(result_read_frame_times(f, &frames));
  printf("%s: %ld particles, %ld bonds, %ld frames\nHistories:\n", path, particles, bonds, frames);
  char *names = result_list(f, "/history"), *energies = result_list(f, "/history/energy");
  if (names)
    for_each_name(f, names, "", print_history);
  if (energies)
    for_each_name(f, energies, "energy/", print_history);
  char *fields = result_members(f, "/frames");
  printf("Frames hold: %s\n", fields);
  free(names);
  free(energies);
  free(fields);
  result_read_close(f);
  return 0;
}

int command_info(int argc, char **argv) {
  static const char *const options[] = {"--builtins"};
  if (argc == 1 && !strcmp(argv[0], "--builtins"))
    return info_builtins();
  if (argc == 1 && argv[0][0] == '-')
    return option_unknown("perilat info", argv[0], options, 1);
  if (argc != 1) {
    fputs("perilat: error: `perilat info` takes one law, deck or result, or --builtins\n", stderr);
    return 1;
  }
  file_kind kind = kind_of_file(argv[0]);
  if (kind == FILE_RESULT)
    return info_result(argv[0]);
  if (kind == FILE_DECK)
    return run_deck(&(run_options){.deck_path = argv[0], .check_only = true});
  char *path = model_find(argv[0], NULL);
  int status = info_law(path ? path : argv[0]);
  free(path);
  return status;
}
