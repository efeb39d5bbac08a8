/* Particles of a file: a table (text_table.h) with columns x, y and in space z, and perhaps volume
   or, in the plane, area; or a result of an earlier run, of which the places at the beginning and
   the volumes are taken. */
#ifndef PERILAT_RUNTIME_PARTICLE_TABLE_H
#define PERILAT_RUNTIME_PARTICLE_TABLE_H

#include "runtime/base/text_table.h"

typedef struct particle_table {
  int dimensions;
  long count;
  double *at[3];   /* [count] m; at[2] is NULL in the plane */
  double *volume;  /* [count] m^2 of the plane or m^3 of space; NULL when the file gives none */
  double *spacing; /* [count] m; NULL but of a result whose particles are graded */
  long *row;       /* [count] of the table, or the particle's number in the result */
  text_table text; /* without columns when the file is a result */
} particle_table;

/* Takes over `path` (malloc'ed). `thickness` (m) turns volumes in the plane into areas. False with
   diagnostics, at `where` for what concerns the file as a whole: it cannot be read, is of the other
   dimensions, lacks a column, holds no particle, or a value is no finite number, a volume not
   positive. To be freed in either case. */
bool particle_table_read(particle_table *t, char *path, int dimensions, double thickness,
                         span where, diagnostics *d);
void particle_table_free(particle_table *t);

/* The line of a particle, or `otherwise` for a result. */
span particle_table_where(particle_table *t, long particle, span otherwise, diagnostics *d);
/* "line 12" or "particle 10 of the result" (from 0), for messages. */
enum { PARTICLE_TABLE_TEXT = 64 };
const char *particle_table_name(const particle_table *t, long particle,
                                char text[PARTICLE_TABLE_TEXT]);

#endif
