/* A table in a text: particles, a load in time, a curve of a laboratory. The first line names the
   columns, each perhaps with its unit, and the lines below hold the numbers:

     # blast 3 of the wall
     time [ms], F_2 [kN], w
     0,         0,        0
     0.12,      58.9,     0.25

   Columns are apart by commas; by tabs, semicolons or blanks where the first line has these. Lines
   that begin with `#` and blank lines are passed over. A first line of numbers names nothing: its
   columns are known by their number. Plain numbers are SI. */
#ifndef PERILAT_RUNTIME_TEXT_TABLE_H
#define PERILAT_RUNTIME_TEXT_TABLE_H

#include <stdbool.h>
#include <stdint.h>

#include "dsl/base/units.h"
#include "runtime/base/file_text.h"

typedef struct text_column {
  char *name;                    /* without its unit; "" in a table without names; owned */
  uint32_t begin, end;           /* the title in the text */
  uint32_t unit_begin, unit_end; /* what stands in the brackets; equal without a unit */
} text_column;

typedef struct text_table {
  file_text file;
  char separator;
  text_column *columns;
  int column_count;
  uint32_t header; /* the line with the names, or the first one of numbers */
  uint32_t *begin; /* [rows] where the lines of numbers begin */
  long rows;
} text_table;

/* Takes over `path` (malloc'ed); a source of that name stands for the file. False with diagnostics,
   at `where` for what concerns the file as a whole. A file without a line has no columns. To be
   freed in either case. */
bool text_table_read(text_table *t, char *path, span where, diagnostics *d);
void text_table_free(text_table *t);

/* The column of that name, whatever the case, or of that number from 1. Negative: TEXT_TABLE_NONE,
   or TEXT_TABLE_TWO after a message. */
enum { TEXT_TABLE_NONE = -1, TEXT_TABLE_TWO = -2 };
int text_table_find(text_table *t, const char *name, diagnostics *d);
/* The same; a column that is missing is an error at `where`, with a hint that lists those there
   are. */
int text_table_column(text_table *t, const char *name, span where, diagnostics *d);

bool text_table_has_unit(const text_table *t, int column);
/* The column's unit, a pure number without one. False after a message: there is no such unit. */
bool text_table_unit(text_table *t, int column, unit *u, diagnostics *d);
/* The column's values in SI, [rows], malloc'ed; NULL after messages. A unit must be one of
   `si_unit`. With `gaps` an empty place is NaN, else an error. */
double *text_table_values(text_table *t, int column, const char *si_unit, bool gaps,
                          diagnostics *d);

/* Places for messages: the line of the names, a title, a line of numbers, a number. */
span text_table_header(text_table *t, diagnostics *d);
span text_table_title(text_table *t, int column, diagnostics *d);
span text_table_line(text_table *t, long row, diagnostics *d);
span text_table_cell(text_table *t, long row, int column, diagnostics *d);
long text_table_line_number(const text_table *t, long row);

/* "lab.csv:cmod,load" is a file and, behind a colon that follows its ending, columns of it. The
   path (malloc'ed); *columns is the text behind the colon, or NULL. */
char *text_table_split(const char *given, const char **columns);
/* The names in "cmod, load", at most `most`, copied into names[0..]; each is to be freed. How many
   there are. */
int text_table_names(const char *columns, char **names, int most);

#endif
