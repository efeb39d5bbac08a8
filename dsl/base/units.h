/* Physical dimensions and units. A dimension is a vector of rational exponents over the SI base
   quantities; angles are pure numbers. `30 [GPa]` is a value times a unit; all in SI. */
#ifndef PERILAT_DSL_UNITS_H
#define PERILAT_DSL_UNITS_H

#include <stdbool.h>
#include <stddef.h>

#include "dsl/base/c_linkage.h"

C_LINKAGE_BEGIN

/* Exponents of m, kg, s, K are kept in twelfths so that square and cube roots are exact. */
typedef struct dimension {
  short twelfths[4]; /* length, mass, time, temperature */
} dimension;

typedef struct unit {
  dimension dim;
  double factor; /* value in SI = value in unit * factor */
} unit;

extern const dimension DIMENSIONLESS;

bool dim_equal(dimension a, dimension b);
bool dim_is_none(dimension a);
dimension dim_mul(dimension a, dimension b);
dimension dim_div(dimension a, dimension b);
/* a ** (numerator/denominator); false when the exponent is not exact in twelfths or overflows. */
bool dim_pow(dimension a, int numerator, int denominator, dimension *result);

/* Reads a unit expression such as "kg/m^3", "N*m", "1/s", "mm", "kN/m", "m**2", "MPa*m^0.5",
   "MPa*sqrt(m)". On failure returns false, and *bad / *bad_length name the offending part. */
bool unit_parse(const char *text, size_t length, unit *result, const char **bad,
                size_t *bad_length);

/* Is all of it one unit? */
bool unit_is_whole(const char *text, size_t length);

/* Of a unit that the program itself writes: dimension_of("N/m"). No unit is a pure number. */
dimension dimension_of(const char *unit_text);

/* "a stress (Pa)", "a pure number", or "a quantity in kg^2*m/s" where the field has no word for it.
   Writes at most `size` bytes including the NUL. */
void dim_describe(dimension d, char *text, size_t size);
/* A short unit for tables and axis labels: "Pa", "N*m", "kg/m^3", "1" for a pure number. */
void dim_unit(dimension d, char *text, size_t size);

/* Whether there is nothing to write behind a number in that unit: NULL, "" or "1". */
bool unit_is_pure(const char *symbol);

/* All unit symbols, for suggestions. */
const char *const *unit_symbols(int *count);

C_LINKAGE_END

#endif
