/* What a study is asked to do, by the options of `perilat study` and by `&study`: of the two the
   options count. */
#ifndef PERILAT_GENERATOR_STUDY_REQUEST_H
#define PERILAT_GENERATOR_STUDY_REQUEST_H

#include "dsl/base/arena.h"
#include "generator/study/study_axis.h"
#include "runtime/deck/deck.h"

typedef struct study_list {
  study_text *items;
  int count;
} study_list;

typedef struct study_request {
  arena *memory;
  source_set sources;
  diagnostics said;
  const char **files; /* as given: decks, or one with `&study` */
  int file_count;
  study_list decks; /* paths */
  study_list vary, set, fit, to;
  study_text converge, strength; /* text NULL: not asked */
  deck_study o;                  /* the rest; its lists are those above */
  bool json, no_physics;
  bool check_only; /* nothing is run */
  bool grouped;    /* the question stands in `&study`, not in options, */
  span group;      /* which is here; else nowhere */
  int threads;     /* of all runs together; 0: as many as there are processors */
} study_request;

void study_request_begin(study_request *r);
void study_request_end(study_request *r);
/* An option's text, which messages name `option`. */
study_text study_option(study_request *r, const char *option, const char *text);
/* How messages call what is asked by "fit": --fit, or `fit` of a group. */
const char *study_word(const study_request *r, const char *name);
/* How it is written: --fit material.E=20..40 GPa, or fit = '...'. */
const char *study_written(const study_request *r, const char *name, const char *value);
void study_list_add(study_request *r, study_list *list, study_text text);
/* What was not given by options is taken from the `&study` of the file, or from its defaults; names
   of files that it gives are those beside it. False after messages, in r->said. */
bool study_request_complete(study_request *r);
/* The file holds a `&study` and nothing else: it is no deck. */
bool study_is_alone(const char *path);
/* True, after a sentence on the standard error stream, when it does, and `perilat COMMAND` needs a
   deck. */
bool study_refuse(const char *command, const char *path);
/* Says now what has been warned of, before anything runs. */
void study_warn(study_request *r);
/* Path without its ending, in the working folder: "NAME_study". */
const char *study_name(study_request *r);

#endif
