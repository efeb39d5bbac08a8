/* A law that a path drives: opened with the path's values, refused where the path does not suit it,
   driven as the bond, particle or point that it is a law of. */
#ifndef PERILAT_GENERATOR_DRIVEN_LAW_H
#define PERILAT_GENERATOR_DRIVEN_LAW_H

#include "generator/drive/drive_family.h"
#include "generator/drive/drive_path.h"
#include "generator/drive/drive_point.h"
#include "generator/drive/drive_table.h"
#include "generator/kernel/model.h"

typedef struct driven_law {
  const drive_input *in;
  arena *memory;     /* of what follows */
  diagnostics *said; /* what is wrong with the path */
  model model;       /* what is wrong with the law: model.said, where `opened` */
  bool opened;       /* here, not borrowed */
  const pl_law *law;
  family_gauge *gauge;          /* of families */
  double *parameters, *initial; /* initial [fields]: where state and damage begin */
} driven_law;

typedef enum driven_outcome {
  DRIVEN_READY,
  DRIVEN_BAD_LAW,   /* it was not found, or has errors */
  DRIVEN_NO_KERNEL, /* after a sentence on the error stream */
  DRIVEN_UNSUITED   /* path and law do not suit each other: messages in `said` */
} driven_outcome;

/* Opens in->material.model, which is found beside in->path. All four arguments must outlive it; to
   be closed whatever the outcome. */
driven_outcome driven_law_open(driven_law *r, arena *memory, const drive_input *in, bool compiled,
                               diagnostics *said);
/* The same of many paths that drive one law, on the interpreter: it is read and planned for the
   first of them, and kept in `kept`, empty at first, which must outlive all others and be closed
   like them. Where a path asks for another file, or another kernel of it, that is opened. */
driven_outcome driven_law_open_kept(driven_law *r, driven_law *kept, arena *memory,
                                    const drive_input *in, diagnostics *said);
void driven_law_close(driven_law *r);
drive_kind driven_law_kind(const driven_law *r);
/* A table without rows, with the columns that driving gives; to be freed. */
void driven_law_columns(const driven_law *r, drive_table *out);
/* The table must be freed; band: of points alone. False after a message. */
bool driven_law_march(const driven_law *r, drive_table *out, drive_band *band);

#endif
