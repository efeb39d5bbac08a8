/* The paths of cracks in meshes, of several results in one picture: where cracks ran, in places at
   the beginning, with the outline of the meshes. */
#ifndef PERILAT_RUNTIME_PLOT_PATHS_H
#define PERILAT_RUNTIME_PLOT_PATHS_H

#include <stdbool.h>
#include <stddef.h>

#include "dsl/base/c_linkage.h"

C_LINKAGE_BEGIN

typedef struct plot_paths_options {
  const char *output;
  const char *title;         /* NULL: the first result's */
  const char *const *labels; /* [results] NULL: file names */
  long frame;                /* negative: from the end */
} plot_paths_options;

bool plot_paths(const char *const *results, int count, const plot_paths_options *o, char *error,
                size_t size);

C_LINKAGE_END

#endif
