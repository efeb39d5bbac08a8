/* A difference of two tables in sentences, as two rows, and for other programs. */
#ifndef PERILAT_GENERATOR_DIFFERENCE_WORDS_H
#define PERILAT_GENERATOR_DIFFERENCE_WORDS_H

#include <stdio.h>

#include "dsl/base/json.h"
#include "generator/against/table_difference.h"

/* One sentence without a full stop: "N is twice that of the reference in all states". `should` is
   what the answer is measured by: "that of the reference", "what it should be". The tables are
   those that were compared. */
void difference_say(const table_difference *d, const drive_table *answer, const char *should,
                    FILE *out);
/* The first state that differs: a head, the rows of both with the columns that differ there, under
   `names`: of the answer, of the reference. Each line begins with `indent`; nothing where all is
   equal. */
void difference_rows(const table_difference *d, const drive_table *reference,
                     const char *const names[2], const char *indent, FILE *out);
/* Keys in an object that is open: `difference`, `of`, `ratio`, `side`, `total`, `totals`, `rows`,
   `skipped`, `worst`, `first`. */
void difference_json(const table_difference *d, const drive_table *reference, json *j);
/* "twice" and what it should be, "minus half that of the reference", "0.73 times ...", "0", "off by
   0.003 %". */
void ratio_say(double ratio, const char *should, FILE *out);
/* The same of a ratio that holds to the last digits: it may be told as a fraction
   (ratio_formula). */
void exact_ratio_say(double ratio, const char *should, FILE *out);
/* The same without roots, pi and logarithms, which would tell the formula that is asked for: "1.155
   times what it should be", "minus 0.866 times ...". */
void plain_ratio_say(double ratio, const char *should, FILE *out);
/* Behind it, of a ratio that is nearly 1: the question whether a constant is rounded. */
void rounding_say(double ratio, FILE *out);
/* "the force N", "the stored energy", or the name itself. */
const char *column_words(const char *name);

#endif
