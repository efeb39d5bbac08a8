/* The law of a material: opened once for options and lattice, its C written where it is wanted,
   nothing changed on the way. */
#define _GNU_SOURCE /* nftw, RTLD_NEXT */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include <dlfcn.h>
#include <fcntl.h>

#include "generator/emit/emit.h"
#include "generator/kernel/material_law.h"
#include "generator/kernel/toolchain.h"
#include "generator/plan/plan.h"
#include "generator/run/law_verdict.h"
#include "tests/generator/command_tools.h"

/* Counts how often a law's file is opened. */
static int laws_opened;

int open(const char *path, int flags, ...) {
  va_list values;
  va_start(values, flags);
  const mode_t mode = flags & (O_CREAT | O_TMPFILE) ? va_arg(values, mode_t) : 0;
  va_end(values);
  const size_t length = strlen(path);
  laws_opened += length > 4 && strcmp(path + length - 4, ".plm") == 0;
  int (*real)(const char *, int, ...);
  *(void **)&real = dlsym(RTLD_NEXT, "open");
  return real(path, flags, mode);
}

typedef struct opened_law {
  source_set sources;
  diagnostics said;
  deck_material material;
  model model;
} opened_law;

static bool open_on(opened_law *o, const char *name, deck_assignment *assignments, int count,
                    const deck_lattice *l) {
  memset(o, 0, sizeof *o);
  diag_begin(&o->said, &o->sources);
  o->material =
      (deck_material){.model = name, .assignments = assignments, .assignment_count = count};
  const bool good =
      material_law_open(&o->material, l, SOURCE_DIR "/models/deck.nml", &o->model, &o->said);
  if (o->model.memory) diag_print(&o->model.said, stderr);
  return good;
}

static void close_law(opened_law *o) {
  if (o->model.memory) model_close(&o->model);
  diag_clear(&o->said);
  source_clear(&o->sources);
}

static void options_are_taken_in_one_opening(void **state) {
  (void)state;
  deck_assignment given[] = {{.name = "G_f", .value = 100},
                             {.name = "Onset", .word = "mohr_coulomb"},
                             {.name = "f_t", .value = 3e6}};
  const deck_assignment before[3] = {given[0], given[1], given[2]};
  const deck_lattice hexagon = {
      .kind = "hexagonal", .setting = "plane_strain", .spacing = 0.01, .thickness = 0.1};
  opened_law o;
  laws_opened = 0;
  assert_true(open_on(&o, "splm_concrete", given, 3, &hexagon));
  assert_int_equal(laws_opened, 1);
  assert_string_equal(o.model.law->chosen[1], "mohr_coulomb");
  assert_int_equal(o.model.law->setting, SETTING_PLANE_STRAIN);
  assert_int_equal(o.model.law->neighbours, 6);
  assert_int_equal(o.model.values.assignment_count, 2);
  assert_string_equal(o.model.values.assignments[0].name, "G_f");
  assert_string_equal(o.model.values.assignments[1].name, "f_t");
  assert_int_equal(o.material.assignment_count, 3); /* the deck's, as it was */
  assert_memory_equal(given, before, sizeof given);
  close_law(&o);
}

static void a_choice_that_the_law_has_not_is_told(void **state) {
  (void)state;
  deck_assignment given[] = {{.name = "softening", .word = "quadratic"}};
  opened_law o;
  laws_opened = 0;
  assert_false(open_on(&o, "cohesive", given, 1, NULL));
  assert_int_equal(laws_opened, 1);
  assert_int_equal(o.said.errors, 1);
  assert_string_equal(o.said.items[0].message, "the option `softening` has no choice `quadratic`");
  close_law(&o);
}

/* Irregular particles are judged on a lattice, and all that the bounds allow in the law's first
   setting. */
static void a_law_that_is_judged_stays_as_it_was_opened(void **state) {
  (void)state;
  const deck_lattice sites = {
      .kind = "blue_noise", .setting = "plane_strain", .spacing = 0.01, .thickness = 0.1};
  const deck_lattice like = {
      .kind = "hexagonal", .setting = "plane_strain", .spacing = 0.01, .thickness = 0.1};
  opened_law o;
  assert_true(open_on(&o, "splm_elastic", NULL, 0, &sites));
  assert_true(o.model.law->irregular);
  const law *opened = o.model.law, before = *opened;
  double values[8];
  for (int p = 0; p < opened->parameters.count; p++)
    values[p] = opened->parameters.items[p]->initial;
  assert_true(
      run_law_obeys(&o.model, &like, values, (span){0, 0, UINT16_MAX}, &o.model.said, &o.said));
  assert_ptr_equal(o.model.law, opened);
  assert_memory_equal(opened, &before, sizeof before);
  close_law(&o);
}

/* What a law lacks for exact edges is told at the deck's key. */
static void exact_edges_need_a_law_that_has_them(void **state) {
  (void)state;
  static const struct {
    const char *law, *message;
  } cases[] = {
      {"mplm_concrete",
       "`mplm_concrete` is a law of bonds, and a bond does not know which others its ends lack"},
      {"lps", "the law `lps` is not exact at edges: it does not make its force state by "
              "`uniform_force` or `correspondence`"},
      {SOURCE_DIR "/tests/generator/kernel/whole_families.plm",
       "the law `whole_families` is meant for whole families of a lattice: its line `for` does not "
       "name `irregular`"},
  };
  deck_lattice l = {.kind = "hexagonal",
                    .setting = "plane_stress",
                    .spacing = 0.01,
                    .thickness = 0.1,
                    .edges = EDGES_EXACT};
  opened_law o;
  for (size_t k = 0; k < sizeof cases / sizeof *cases; k++) {
    assert_false(open_on(&o, cases[k].law, NULL, 0, &l));
    assert_int_equal(o.said.errors, 1);
    assert_string_equal(o.said.items[0].message, cases[k].message);
    close_law(&o);
  }
  assert_true(open_on(&o, "splm_elastic", NULL, 0, &l));
  assert_true(o.model.law->irregular);
  assert_int_equal(o.model.law->neighbours, 0);
  close_law(&o);
}

static void c_is_written_when_it_is_asked_for(void **state) {
  (void)state;
  opened_law o;
  char error[200];
  const char *note;
  assert_true(open_on(&o, "cohesive", NULL, 0, NULL));
  assert_non_null(model_kernel(&o.model, true, &note, error, sizeof error));
  assert_null(o.model.c_text);
  char line[200], *unkeyed = emit_kernel(o.model.plan), *key = toolchain_key(unkeyed);
  assert_string_equal(model_key(&o.model), key);
  snprintf(line, sizeof line, "    .key = \"%s\",\n", key);
  const char *text = model_c_text(&o.model), *at = strstr(text, line);
  assert_non_null(at);
  assert_int_equal(strlen(text), strlen(unkeyed) + strlen(key));
  assert_memory_equal(text, unkeyed, (size_t)(at - text));
  free(unkeyed);
  free(key);
  close_law(&o);
}

#define PATH SOURCE_DIR "/models/drives/cohesive.nml"

/* A compiler that says when it is asked for anything. */
static const char witness[] = "#!/bin/sh\necho \"$@\" >>asked\nexec cc \"$@\"\n";

static void no_compiler_is_asked_where_none_is_needed(void **state) {
  workplace *w = *state;
  write_text(w, "cc", witness);
  static const char *const commands[] = {"check cohesive", "info cohesive", "check beam.nml",
                                         "check " PATH, "drive " PATH};
  for (size_t k = 0; k < sizeof commands / sizeof *commands; k++) {
    assert_int_equal(shell(w, "chmod +x cc && PERILAT_CC=./cc $P %s", commands[k]), 0);
    if (exists(w, "asked")) fail_msg("`%s` asks the compiler", commands[k]);
  }
  assert_int_equal(shell(w, "PERILAT_CC=./cc $P check cohesive --dump=c"), 0);
  assert_true(exists(w, "asked")); /* its version is part of the key */
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(options_are_taken_in_one_opening),
      cmocka_unit_test(a_choice_that_the_law_has_not_is_told),
      cmocka_unit_test(a_law_that_is_judged_stays_as_it_was_opened),
      cmocka_unit_test(exact_edges_need_a_law_that_has_them),
      cmocka_unit_test(c_is_written_when_it_is_asked_for),
      cmocka_unit_test_setup_teardown(no_compiler_is_asked_where_none_is_needed, set_up_workplace,
                                      tear_down_workplace),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
