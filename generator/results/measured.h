/* What a laboratory has measured, or a code prescribes, beside a computed curve: columns of a table
   (text_table.h), bands, lines, all in SI. */
#ifndef PERILAT_GENERATOR_MEASURED_H
#define PERILAT_GENERATOR_MEASURED_H

#include <stdbool.h>

#include "runtime/base/text_table.h"

/* The two histories that a curve is drawn over. */
typedef struct measured_axes {
  const char *x;
  const char *const *ys; /* several curves: a table may have any of them */
  int y_count;
  const char *x_unit, *y_unit;
} measured_axes;

typedef struct measured {
  char label[256]; /* the file's name without its ending */
  double *x, *y, *low,
      *high; /* [count]; y NULL: a band alone; low and high NULL: no band; NaN: a gap */
  long count;
  text_table table;
} measured;

/* Reads "lab.csv", whose columns have the names of the histories, or "lab.csv:cmod,load", and with
   `band` ("low,high") two columns more; then the table needs none for y. False after messages,
   which point into the table or at the `option` that was given so ("--data"). */
bool measured_read(measured *m, const char *option, const char *given, const char *band,
                   const measured_axes *axes, diagnostics *d);
void measured_free(measured *m);

/* A level or a band of constants: "58.88 kN", "f_t A = 58.88 kN", "4 kN, 5 kN". False after a
   message on stderr. */
bool measured_line(const char *given, const char *si_unit, double *value);
bool measured_levels(const char *given, const char *si_unit, double value[2]);

#endif
