/* What histories and fields a result has, and which is meant by a name. */
#ifndef PERILAT_RUNTIME_RESULT_FIND_H
#define PERILAT_RUNTIME_RESULT_FIND_H

#include <stdbool.h>

#include "runtime/result/result_file.h"
#include "runtime/result/result_names.h"

C_LINKAGE_BEGIN

/* Names of what a group holds ("/history", "/bonds"), in alphabetical order. Empty where there is
   no such group. */
result_names result_list(result_file *f, const char *group);
/* Histories ("/history") or fields ("/frames"): data sets of the group and of the groups in it,
   without `time`. */
result_names result_members(result_file *f, const char *group);
/* The same, listed once; the file's. */
const result_names *result_names_in(result_file *f, const char *group);
/* The full name of a history or a field that is given so; a field of bonds that several
   interactions have, of all of them, is named with a star for the interaction. False with a
   sentence that lists what there is. */
bool result_find(result_file *f, const char *group, const char *given, char *name, size_t size,
                 char *error, size_t error_size);
/* The run was quasi-static: its samples are increments, its time is only an order. */
bool result_is_quasi_static(result_file *f);

C_LINKAGE_END

#endif
