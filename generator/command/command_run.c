/* perilat run, perilat check: run.h or the front end. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "generator/check/physics.h"
#include "generator/command/command_drive.h"
#include "generator/command/commands.h"
#include "generator/command/run_options.h"
#include "generator/drive/drive_grammar.h"
#include "generator/emit/plan_dump.h"
#include "generator/facts/law_judged.h"
#include "generator/interpreter/interpreted.h"
#include "generator/kernel/document.h"
#include "generator/kernel/material_law.h"
#include "generator/kernel/model.h"
#include "generator/kernel/settings.h"
#include "generator/plan/plan.h"
#include "generator/run/run.h"
#include "generator/study/study.h"
#include "runtime/deck/deck_read.h"
#include "runtime/simulation/simulation.h"

static bool is_runnable(const run_options *o) {
  return file_suits(o->deck_path, FILES(DECK), "perilat run", "a deck") &&
         !drive_refuse_path("run", o->deck_path) && !study_refuse("run", o->deck_path);
}

int command_run(int argc, char **argv) {
  run_options o = {.program = "perilat run"};
  bool good = read_run_options(OF_RUN, "perilat run", argc, argv, &o, NULL);
  int status = 1;
  if (good && !o.deck_path)
    say_error("`perilat run` needs a deck\n  perilat run deck.nml");
  else if (good)
    status = run_as_asked(&o, is_runnable);
  free(o.overrides);
  return status;
}

/* --dump=STAGE of a law that has been checked, and may have been planned. */
static int dump_stage(model *m, const char *stage) {
  if (!strcmp(stage, "tree")) {
    tree_dump(m->tree, stdout);
    return 0;
  }
  if (strcmp(stage, "ir") && strcmp(stage, "passes") && strcmp(stage, "c")) {
    say_error("--dump takes tree, ir, passes or c, not `%s`", stage);
    return 1;
  }
  if (!m->plan && !model_plan(m)) return 1;
  if (!strcmp(stage, "passes"))
    plan_dump(m->plan, stdout);
  else if (!strcmp(stage, "c"))
    fputs(model_c_text(m), stdout);
  else
    plan_dump_ir(m->plan, stdout);
  return 0;
}

static void print_physics(const physics_report *p) {
  printf("  physics: %.0f states in %.1f ms", p->states, 1e3 * p->seconds);
  if (p->guards)
    printf("; %d of %d conditions were seen both true and false", p->guards_reached, p->guards);
  putchar('\n');
}

/* "law.plm: spring, no errors, 2 warnings, 1 finding accepted (0.6 ms)" */
static void print_counts(const char *path, const model *m) {
  const diagnostics *d = &m->said;
  printf("%s: %s, no errors, %d warning%s", path, m->law->tree->name, d->count,
         d->count == 1 ? "" : "s");
  if (d->accepted_count)
    printf(", %d finding%s accepted", d->accepted_count, d->accepted_count == 1 ? "" : "s");
  printf(" (%.1f ms)\n", 1e3 * m->seconds_front);
}

/* Not a warning: with other values, options or settings there may be something. */
static void print_idle_waivers(const model *m) {
  const law *l = m->law;
  for (int k = 0; k < l->waiver_count; k++)
    if (law_waiver_is_idle(&l->waivers[k], &m->said))
      printf("  `accept %s`: its check finds nothing here\n", diag_name(l->waivers[k].check));
}

/* --- a law ------------------------------------------------------------------------------------ */

/* A law with the values that --set gives, name=value. */
typedef struct checking {
  arena *memory;
  source_set sources;
  diagnostics said; /* about what is set; the model has its own */
  deck_material material;
  model model;
  physics_report physics;
} checking;

/* The parameters that the law is checked at; NULL, around its defaults, where --set gives none.
   False after messages. */
static bool take_values(checking *c, double **values) {
  const symbol_list *list = &c->model.law->parameters;
  *values = NULL;
  if (c->model.values.assignment_count == 0) return true;
  *values = arena_alloc(c->memory, ((size_t)list->count + 1) * sizeof **values);
  pl_law *kernel = plan_interpreted(c->model.plan);
  bool good = material_parameters(&c->model.values, kernel, *values, &c->said);
  plan_interpreted_free(kernel);
  return good;
}

/* 0, or an exit status. */
static int check_as_law(checking *c, const run_options *o, const char *path, const char *dump) {
  const char **settings =
      arena_alloc(c->memory, ((size_t)o->override_count + 1) * sizeof *settings);
  for (int k = 0; k < o->override_count; k++)
    settings[k] = o->overrides[k].text;
  if (!settings_read(c->memory, &c->sources, settings, o->override_count, &c->material, &c->said) ||
      !model_open(&c->model, path, NULL, 0) ||
      !material_law_take_options(&c->material, &c->model, &c->said))
    return 1;
  if (dump) return dump_stage(&c->model, dump);
  double *values;
  if (!model_plan(&c->model) || !take_values(c, &values)) return 1;
  return o->no_physics || law_obeys(c->model.law, values, &c->model.said, &c->physics) ? 0 : 1;
}

static void say(const run_options *o, const diagnostics *d) {
  if (o->report)
    diag_json_add(o->report, d);
  else
    diag_print(d, stderr);
}

static int check_law(const run_options *o, const char *path, const char *dump) {
  checking c = {.memory = arena_new(), .material = {.item = {.where = {0, 0, UINT16_MAX}}}};
  diag_begin(&c.said, &c.sources);
  int status = check_as_law(&c, o, path, dump);
  say(o, &c.said);
  if (c.model.memory) say(o, &c.model.said);
  if (!status && !dump && !o->report) print_counts(path, &c.model);
  if (!status && !dump && !o->report && !o->no_physics) print_idle_waivers(&c.model);
  if (!status && !dump && !o->report && c.physics.states > 0) print_physics(&c.physics);
  if (c.model.memory) model_close(&c.model);
  diag_clear(&c.said);
  source_clear(&c.sources);
  arena_free(c.memory);
  return status;
}

/* --- any file --------------------------------------------------------------------------------- */

static int check_path(const run_options *o) {
  const char **settings = must_calloc((size_t)o->override_count + 1, sizeof *settings);
  for (int k = 0; k < o->override_count; k++)
    settings[k] = o->overrides[k].text;
  int status = drive_check(o->deck_path, settings, o->override_count, o->report);
  free(settings);
  return status;
}

static int dump_law(const deck *k, int interaction, const char *deck_path, const char *stage,
                    diagnostics *said) {
  const deck_interaction *of = &k->interactions[interaction];
  model opened = {.memory = NULL};
  const bool good =
      material_law_open(of->material, &k->lattices[of->lattice], deck_path, &opened, said);
  if (opened.memory) diag_print(&opened.said, stderr);
  if (good && k->interaction_count > 1)
    printf("%s/* lattice `%s` */\n", interaction ? "\n" : "", of->name);
  const int status = good ? dump_stage(&opened, stage) : 1;
  if (opened.memory) model_close(&opened);
  return status;
}

/* The laws of a deck's lattices, each as it is written for its lattice. */
static int dump_deck(const run_options *o, const char *stage) {
  char error[4096];
  size_t length;
  char *text = read_text_file(o->deck_path, DECK_LIMIT, &length, error, sizeof error);
  if (!text) {
    say_error("%s", error);
    return 1;
  }
  checking c = {.memory = arena_new()};
  diag_begin(&c.said, &c.sources);
  const int file = source_add(&c.sources, o->deck_path, text, length);
  const deck *k = deck_read(c.memory, &c.sources, file, o->overrides, o->override_count, &c.said);
  int status = k ? 0 : 1;
  for (int n = 0; k && n < k->interaction_count && !status; n++)
    status = dump_law(k, n, o->deck_path, stage, &c.said);
  diag_print(&c.said, stderr);
  diag_clear(&c.said);
  source_clear(&c.sources);
  arena_free(c.memory);
  free(text);
  return status;
}

/* What is set is set in all of its runs. */
static int check_study(const run_options *o) {
  study_request r;
  study_request_begin(&r);
  r.check_only = true;
  const char *files[] = {o->deck_path};
  r.files = files;
  r.file_count = 1;
  for (int k = 0; k < o->override_count; k++)
    study_list_add(&r, &r.set, study_option(&r, "--set", o->overrides[k].text));
  const int status = study_run(&r, NULL);
  if (o->report) diag_json_add(o->report, &r.said);
  study_request_end(&r);
  return status;
}

static int check_file(const run_options *o, const char *dump) {
  if (!file_suits(o->deck_path, FILES(LAW) | FILES(DECK), "perilat check", "a law or a deck"))
    return 1;
  char *found = NULL;
  file_kind kind = kind_of_file(o->deck_path);
  if (kind == FILE_UNKNOWN && (found = model_find(o->deck_path, NULL))) kind = FILE_LAW;
  int status = 1;
  if (kind == FILE_LAW)
    status = check_law(o, found ? found : o->deck_path, dump);
  else if (dump && drive_is_path(o->deck_path))
    say_error("--dump shows a law; give the law's file, or a deck");
  else if (dump)
    status = dump_deck(o, dump);
  else if (drive_is_path(o->deck_path))
    status = check_path(o);
  else if (study_is_alone(o->deck_path)) {
    if (!(status = check_study(o)) && !o->report) printf("%s: no errors\n", o->deck_path);
  } else if (!(status = run_deck(o)) && !o->report)
    printf("%s: no errors\n", o->deck_path);
  free(found);
  return status;
}

/* The same as one JSON document on the standard output. */
static int check_to_json(run_options *o) {
  document d;
  diag_json report;
  document_begin(&d);
  diag_json_begin(&report, &d.writer, o->deck_path);
  o->report = &report;
  const int status = check_file(o, NULL);
  diag_json_end(&report, status == 0);
  return document_end(&d, status);
}

static int check_as_asked(run_options *o, const check_options *asked) {
  if (!asked->diagnostics || !strcmp(asked->diagnostics, "text")) return check_file(o, asked->dump);
  if (strcmp(asked->diagnostics, "json") != 0)
    say_error("--diagnostics takes text or json, not `%s`", asked->diagnostics);
  else if (asked->dump)
    say_error("--dump and --diagnostics=json both write to the standard output; give "
              "one");
  else
    return check_to_json(o);
  return 1;
}

int command_check(int argc, char **argv) {
  run_options o = {.check_only = true};
  check_options asked = {NULL, NULL};
  bool good = read_run_options(OF_CHECK, "perilat check", argc, argv, &o, &asked);
  int status = 1;
  if (good && !o.deck_path)
    say_error("`perilat check` needs a law or a deck\n  perilat check law.plm");
  else if (good)
    status = check_as_asked(&o, &asked);
  free(o.overrides);
  return status;
}
