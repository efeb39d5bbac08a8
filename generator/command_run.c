/* perilat run, perilat check: the options, then run.h or the front end. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "generator/commands.h"
#include "generator/model.h"
#include "generator/run.h"

static const char *const run_option_names[] = {"--threads", "--resume",    "--set",
                                               "--profile", "--check-kernel", "--interpret", "--dump"};
enum { RUN_OPTION_COUNT = sizeof run_option_names / sizeof *run_option_names };

/* The options that run, check and a stand-alone solver share. False after a message. */
static bool read_run_options(const char *command, int argc, char **argv, run_options *o, const char **dump) {
  o->overrides = must_calloc((size_t)argc + 1, sizeof *o->overrides);
  int bad = 0;
  for (int at = 0; at < argc && !bad;) {
    const char *value;
    if (option_flag(argv, &at, "--resume"))
      o->resume = true;
    else if (option_flag(argv, &at, "--check-kernel"))
      o->check_kernel = true;
    else if (option_flag(argv, &at, "--interpret"))
      o->interpret = true;
    else if ((value = option_value(argc, argv, &at, "--set", &bad)))
      o->overrides[o->override_count++].text = value;
    else if ((value = option_value(argc, argv, &at, "--threads", &bad))) {
      char *end;
      long threads = strtol(value, &end, 10);
      if (!bad && (*end || end == value || threads < 1 || threads > 1024)) {
        fprintf(stderr, "perilat: error: --threads needs a whole number from 1 to 1024, not `%s`\n", value);
        bad = 1;
      }
      o->threads = (int)threads;
    } else if (dump && (value = option_value(argc, argv, &at, "--dump", &bad)))
      *dump = value;
    else if (argv[at][0] == '-')
      bad = option_unknown(command, argv[at], run_option_names, RUN_OPTION_COUNT);
    else if (o->deck_path) {
      fprintf(stderr, "perilat: error: `perilat %s` takes one file; `%s` is a second one\n", command, argv[at]);
      bad = 1;
    } else
      o->deck_path = argv[at++];
  }
  return !bad;
}

static bool ends_in(const char *text, const char *tail) {
  size_t n = strlen(text), m = strlen(tail);
  return n >= m && strcmp(text + n - m, tail) == 0;
}

int command_run(int argc, char **argv) {
  run_options o = {0};
  bool good = read_run_options("run", argc, argv, &o, NULL);
  int status = 1;
  if (good && !o.deck_path)
    fputs("perilat: error: `perilat run` needs a deck\n  perilat run deck.nml\n", stderr);
  else if (good && ends_in(o.deck_path, ".plm"))
    fprintf(stderr, "perilat: error: `%s` is a law; `perilat run` needs a deck that uses it\n", o.deck_path);
  else if (good)
    status = run_deck(&o);
  free(o.overrides);
  return status;
}

/* --dump=STAGE of a law that has been checked. */
static int dump_stage(model *m, const char *stage) {
  if (!strcmp(stage, "tree")) {
    tree_dump(m->tree, stdout);
    return 0;
  }
  if (strcmp(stage, "ir") && strcmp(stage, "passes") && strcmp(stage, "c")) {
    fprintf(stderr, "perilat: error: --dump takes tree, ir, passes or c, not `%s`\n", stage);
    return 1;
  }
  if (!model_plan(m))
    return 1;
  if (!strcmp(stage, "passes"))
    plan_dump(m->plan, stdout);
  else if (!strcmp(stage, "c"))
    fputs(m->c_text, stdout);
  else
    plan_dump_ir(m->plan, stdout);
  return 0;
}

static int check_law(const char *path, const char *dump) {
  model m;
  bool good = model_open(&m, path, NULL, 0);
  int status = good ? 0 : 1;
  bool pairwise = good && m.law->tree->law != LAW_STATE;
  if (good && dump)
    status = dump_stage(&m, dump);
  else if (pairwise && !model_plan(&m))
    status = 1;
  diag_print(&m.said, stderr);
  if (!status && !dump)
    printf("%s: %s, no errors, %d warning%s (%.1f ms)%s\n", path, m.law->tree->name, m.said.count,
           m.said.count == 1 ? "" : "s", 1e3 * m.seconds_front,
           pairwise ? "" : "; state laws can be checked but not yet compiled");
  model_close(&m);
  return status;
}

int command_check(int argc, char **argv) {
  run_options o = {.check_only = true};
  const char *dump = NULL;
  bool good = read_run_options("check", argc, argv, &o, &dump);
  int status = 1;
  if (good && !o.deck_path)
    fputs("perilat: error: `perilat check` needs a law or a deck\n  perilat check law.plm\n", stderr);
  else if (good && ends_in(o.deck_path, ".plm"))
    status = check_law(o.deck_path, dump);
  else if (good)
    status = run_deck(&o);
  free(o.overrides);
  return status;
}

int perilat_solver_main(int argc, char **argv, const char *deck_name, const char *deck_text,
                        const built_in_law *laws, int law_count) {
  run_options o = {.deck_path = deck_name, .deck_text = deck_text, .laws = laws, .law_count = law_count};
  for (int a = 1; a < argc; a++)
    if (!strcmp(argv[a], "--help") || !strcmp(argv[a], "-h")) {
      printf("usage: %s [--threads N] [--resume] [--set group.key=value]\n  runs the deck `%s` that it was built from\n",
             argv[0], deck_name);
      return 0;
    }
  bool good = read_run_options("run", argc - 1, argv + 1, &o, NULL);
  int status = good ? run_deck(&o) : 1;
  free(o.overrides);
  return status;
}
