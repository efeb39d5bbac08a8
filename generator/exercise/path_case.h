/* A path that answers are driven along, with what they are measured by: the solution's table on it,
   and the solution's with the values that students have at hand. */
#ifndef PERILAT_GENERATOR_PATH_CASE_H
#define PERILAT_GENERATOR_PATH_CASE_H

#include "generator/against/reference_law.h"
#include "generator/exercise/exercise.h"

typedef struct path_case {
  const exercise_item *item;
  int number;          /* of those of the item, from 1 */
  drive_input *in;     /* names no law; parameters of the path first, then all others */
  int own_count;       /* of the path: in->material.assignments[own_count] */
  reference_law right; /* where `referenced` */
  bool referenced;
  drive_input *plain;        /* the same with the values at hand; NULL: these are */
  reference_law right_plain; /* where plain */
  const char *varied;        /* names of values that are not those at hand: "E, t" */
} path_case;

/* Names of parameters and options of a law. */
typedef struct declared_names {
  const char **names;
  int count;
} declared_names;

/* A law file read for what it declares; count 0 where it can not be read. */
declared_names names_declared(arena *a, const char *law);
/* A copy of the path that sets only what the law declares; *missing is the first of the path's own
   that it does not, or NULL. */
drive_input *input_suited(arena *a, const path_case *c, const drive_input *in,
                          const declared_names *to, const char **missing);

/* Reads a path from its file; values of parameters that it does not set are those of `solution`
   (an opened model, or NULL: none). NULL after messages. */
drive_input *path_input(arena *a, source_set *sources, const char *path, const model *solution,
                        int *own_count, diagnostics *d);
/* Drives the solution's file along c->in, and along c->plain where there is one; `kept`:
   driven_law_open_kept. False after messages. */
bool path_case_refer(path_case *c, arena *a, const char *solution, driven_law *kept,
                     diagnostics *d);
/* What is otherwise in the path than at hand: the defaults of the law, and the sizes of `first`.
   Sets c->plain and c->varied. */
void path_case_vary(path_case *c, arena *a, const model *solution, const drive_input *first);
void path_case_close(path_case *c);

#endif
