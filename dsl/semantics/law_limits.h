/* Values of what is made of numbers and parameters alone, and with them the bounds of parameters.
   All are in SI, and `values` are those of the parameters in the order of law->parameters. */
#ifndef PERILAT_DSL_LAW_LIMITS_H
#define PERILAT_DSL_LAW_LIMITS_H

#include "dsl/semantics/law.h"

C_LINKAGE_BEGIN

/* NAN where `values` is NULL and it reads a parameter, and where it is not plain. */
double law_constant_value(const expr *e, const double *values);

/* Is it made of numbers, names, + - * / ** and functions with a value of numbers, the law's own
   among them? */
bool law_is_plain(const expr *e);
/* Does it read that parameter; NULL: any? */
bool law_reads_parameter(const expr *e, const symbol *parameter);
/* Is it plain, or cases of such values that options and the lattice decide? */
bool law_is_bound(const expr *e);

/* The bounds as numbers: infinite where there is none, NAN where one depends on a value that is
   NAN; and whether the bound itself is left out. */
typedef struct law_limits {
  double lower, upper;
  bool lower_open, upper_open;
} law_limits;
law_limits law_parameter_limits(const law *l, int p, const double *values);

bool limits_hold(law_limits limits, double x);
/* The same in a unit that is `factor` in SI. */
law_limits limits_in(law_limits limits, double factor);
/* Such as "(20, inf)". */
void limits_text(law_limits limits, char *text, size_t size);

/* Does the value of parameter `p` respect its bounds? If not, `text` says what these are. */
bool law_parameter_within(const law *l, int p, const double *values, char *text, size_t size);
/* The bounds alone as such a text; "(-inf, inf)" where none are declared. */
void law_parameter_bounds(const law *l, int p, const double *values, char *text, size_t size);

C_LINKAGE_END

#endif
