#include "generator/command/run_options.h"

#include <stdlib.h>

#include "dsl/base/arena.h"
#include "generator/command/commands.h"
#include "generator/kernel/document.h"

static bool read_threads(const char *text, int *threads) {
  char *end;
  long value = strtol(text, &end, 10);
  *threads = (int)value;
  if (!*end && end != text && value >= 1 && value <= 1024) return true;
  say_error("--threads needs a whole number from 1 to 1024, not `%s`", text);
  return false;
}

bool read_run_options(option_reader reader, const char *program, int argc, char **argv,
                      run_options *o, check_options *check) {
  static const char *const names[] = {"run", "check", "solver"};
  o->overrides = must_calloc((size_t)argc + 1, sizeof *o->overrides);
  int bad = 0;
  for (int at = 0; at < argc && !bad;) {
    const char *value;
    if (reader != OF_CHECK && option_flag(argv, &at, "--resume"))
      o->resume = true;
    else if (reader == OF_RUN && option_flag(argv, &at, "--check-kernel"))
      o->check_kernel = true;
    else if (reader == OF_RUN && option_flag(argv, &at, "--interpret"))
      o->interpret = true;
    else if (reader != OF_SOLVER && option_flag(argv, &at, "--no-physics"))
      o->no_physics = true;
    else if ((value = option_value(argc, argv, &at, "--set", &bad)))
      o->overrides[o->override_count++].text = value;
    else if (reader != OF_CHECK && option_flag(argv, &at, "--profile"))
      o->profile = true;
    else if (reader != OF_CHECK && option_flag(argv, &at, "--json"))
      o->json = true;
    else if (reader != OF_CHECK && (value = option_value(argc, argv, &at, "--threads", &bad)))
      bad = bad || !read_threads(value, &o->threads);
    else if (reader == OF_CHECK && (value = option_value(argc, argv, &at, "--dump", &bad)))
      check->dump = value;
    else if (reader == OF_CHECK && (value = option_value(argc, argv, &at, "--diagnostics", &bad)))
      check->diagnostics = value;
    else if (reader == OF_CHECK ? is_option_like(argv[at]) : argv[at][0] == '-')
      bad = option_unknown_in(program, names[reader], argv[at]);
    else if (reader == OF_SOLVER) {
      say_error("`%s` runs the deck that it was built from; it takes no file", program);
      bad = 1;
    } else if (o->deck_path) {
      say_error("`%s` takes one file; `%s` is a second one", program, argv[at]);
      bad = 1;
    } else
      o->deck_path = argv[at++];
  }
  return !bad;
}

int run_as_asked(run_options *o, bool (*runnable)(const run_options *o)) {
  if (!o->json) return !runnable || runnable(o) ? run_deck(o) : 1;
  document d;
  diag_json report;
  document_begin(&d);
  diag_json_begin(&report, &d.writer, o->deck_path);
  o->report = &report;
  if (!runnable || runnable(o)) return document_end(&d, run_deck(o));
  diag_json_end(&report, false);
  json_put_text(&d.writer, "status", "failed");
  return document_end(&d, 1);
}
