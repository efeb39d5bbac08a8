/* Names of what a result holds, "load", "energy/kinetic", "concrete/omega", and how they may be
   given: in full, or by the last part where that says which. */
#ifndef PERILAT_RUNTIME_RESULT_NAMES_H
#define PERILAT_RUNTIME_RESULT_NAMES_H

#include "dsl/base/c_linkage.h"
#include "dsl/base/name_index.h"

C_LINKAGE_BEGIN

typedef struct result_names {
  char **items;
  int count;
  name_index whole, last; /* where a name is; where its last part is, -1 where several have it */
} result_names;

/* One more, in a folder ("": in none). */
void result_names_add(result_names *n, const char *folder, const char *name);
/* After the last one. Of energies that several have the last part means the sum. */
void result_names_index(result_names *n);
void result_names_free(result_names *n);
/* Position of the name given in full or, where that says which, by its last part ("kinetic"); else
   -1. */
int result_names_find(const result_names *n, const char *given);
/* The nearest name, in full or its last part; NULL: none is near. */
const char *result_names_near(const result_names *n, const char *given);
const char *result_names_last(const char *name);

C_LINKAGE_END

#endif
