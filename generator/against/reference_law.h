/* The law that another one is measured by: its table on a path, and the rows in which it says
   nothing, because a case of it begins there. */
#ifndef PERILAT_GENERATOR_REFERENCE_LAW_H
#define PERILAT_GENERATOR_REFERENCE_LAW_H

#include "generator/against/table_difference.h"
#include "generator/drive/driven_law.h"

typedef struct reference_law {
  drive_input in; /* the path, with this law */
  driven_law of;
  drive_table table;
  unsigned char *skip; /* [table.rows] within 1e-9 of where its answer jumps: SKIP_ANSWER, ... */
} reference_law;

/* Drives the law in the file `path`, found beside the path's file, along `in`. To be closed
   whatever comes of it; messages about the law are in of.model.said, others in `said`. `kept`
   (NULL: none): as driven_law_open_kept has it. */
driven_outcome reference_law_drive(reference_law *r, arena *memory, const drive_input *in,
                                   const char *path, driven_law *kept, diagnostics *said);
void reference_law_close(reference_law *r);

#endif
