/* A result file that is read (result_read.h, result_fields.h); its layout and names are those of
   result.h. Damaged files, changed ones, and those that lead out of themselves are refused; of a
   file without a seal a warning is printed. */
#ifndef PERILAT_RUNTIME_RESULT_FILE_H
#define PERILAT_RUNTIME_RESULT_FILE_H

#include <stddef.h>

#include "dsl/base/c_linkage.h"

C_LINKAGE_BEGIN

typedef struct result_file result_file;
/* NULL with a sentence in `error`. */
result_file *result_read(const char *path, char *error, size_t size);
void result_read_close(result_file *f);
/* A sentence when something that is in the file could not be read: then no answer from it counts.
   NULL: all is well. */
const char *result_trouble(const result_file *f);

C_LINKAGE_END

#endif
