/* perilat study: study.h. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "generator/command/commands.h"
#include "generator/drive/drive_grammar.h"
#include "generator/kernel/document.h"
#include "generator/kernel/model.h"
#include "generator/study/study.h"

/* A whole number from 1 on. */
static bool read_number(const char *option, const char *text, int most, int *value) {
  char *end;
  const long number = strtol(text, &end, 10);
  *value = (int)number;
  if (!*end && end != text && number >= 1 && number <= most) return true;
  say_error("%s needs a whole number from 1 to %d, not `%s`", option, most, text);
  return false;
}

/* The keys of --with change together with those of the last --vary. */
static bool add_with(study_request *r, const char *value) {
  if (r->vary.count == 0) {
    say_error("--with names keys that change together with the --vary before it; there is none");
    return false;
  }
  study_text *last = &r->vary.items[r->vary.count - 1];
  *last = study_option(r, "--vary", arena_printf(r->memory, "%s with %s", last->text, value));
  return true;
}

static bool add_weight(study_request *r, const char *value) {
  char *end;
  const double weight = strtod(value, &end);
  if (*end || end == value || !(weight > 0) || weight > 1e300) {
    say_error("--weight needs a number larger than 0, not `%s`", value);
    return false;
  }
  double *all = arena_room(r->memory, r->o.weights, r->o.weight_count, sizeof *all);
  all[r->o.weight_count++] = weight;
  r->o.weights = all;
  return true;
}

/* Options whose values are texts that the study reads. */
static bool is_text_option(study_request *r, int argc, char **argv, int *at, int *bad) {
  const struct {
    const char *name;
    study_list *list;
    study_text *single;
    const char **word;
  } options[] = {{"--vary", &r->vary, NULL, NULL},
                 {"--set", &r->set, NULL, NULL},
                 {"--fit", &r->fit, NULL, NULL},
                 {"--to", &r->to, NULL, NULL},
                 {"--converge", NULL, &r->converge, NULL},
                 {"--strength", NULL, &r->strength, NULL},
                 {"--x", NULL, NULL, &r->o.x},
                 {"--y", NULL, NULL, &r->o.y},
                 {"--of", NULL, NULL, &r->o.of},
                 {"--watch", NULL, NULL, &r->o.watch},
                 {"--twin", NULL, NULL, &r->o.twin},
                 {"--search", NULL, NULL, &r->o.search},
                 {"-o", NULL, NULL, &r->o.result}};
  for (size_t k = 0; k < sizeof options / sizeof *options; k++) {
    const char *value = option_value(argc, argv, at, options[k].name, bad);
    if (!value) continue;
    if (options[k].word)
      *options[k].word = value;
    else if (options[k].single)
      *options[k].single = study_option(r, options[k].name, value);
    else
      study_list_add(r, options[k].list, study_option(r, options[k].name, value));
    return true;
  }
  return false;
}

/* False after a message. */
static bool read_one(int argc, char **argv, int *at, study_request *r) {
  int bad = 0;
  const char *value;
  if (option_flag(argv, at, "--json"))
    r->json = true;
  else if (option_flag(argv, at, "--no-physics"))
    r->no_physics = true;
  else if ((value = option_value(argc, argv, at, "--with", &bad)))
    bad = bad || !add_with(r, value);
  else if ((value = option_value(argc, argv, at, "--weight", &bad)))
    bad = bad || !add_weight(r, value);
  else if ((value = option_value(argc, argv, at, "--jobs", &bad)))
    bad = bad || !read_number("--jobs", value, 1024, &r->o.jobs);
  else if ((value = option_value(argc, argv, at, "--threads", &bad)))
    bad = bad || !read_number("--threads", value, 1024, &r->threads);
  else if ((value = option_value(argc, argv, at, "--runs", &bad)))
    bad = bad || !read_number("--runs", value, 100000, &r->o.runs);
  else if (is_text_option(r, argc, argv, at, &bad))
    return !bad;
  else if (is_option_like(argv[*at]))
    bad = option_unknown("study", argv[*at]);
  else {
    r->files = arena_room(r->memory, r->files, r->file_count, sizeof *r->files);
    r->files[r->file_count++] = argv[(*at)++];
  }
  return !bad;
}

static bool files_suit(const study_request *r) {
  if (r->file_count == 0)
    say_error("`perilat study` needs a deck\n  perilat study deck.nml --vary group.key=v1,v2");
  for (int k = 0; k < r->file_count; k++)
    if (!file_suits(r->files[k], FILES(DECK), "perilat study", "a deck") ||
        drive_refuse_path("study", r->files[k]))
      return false;
  return r->file_count > 0;
}

static int study_as_asked(study_request *r) {
  if (!r->json) return files_suit(r) ? study_run(r, NULL) : 1;
  document d;
  document_begin(&d);
  const int status = files_suit(r) ? study_run(r, &d.writer) : 1;
  if (r->converge.text) d.error_key = "message"; /* `error` is the error bar */
  return document_end(&d, status);
}

int command_study(int argc, char **argv) {
  study_request r;
  study_request_begin(&r);
  bool good = true;
  for (int at = 0; at < argc && good;)
    good = read_one(argc, argv, &at, &r);
  const int status = good ? study_as_asked(&r) : 1;
  study_request_end(&r);
  return status;
}
