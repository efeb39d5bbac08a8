/* Errors and warnings as data: a code, a span, one sentence, and optionally a note elsewhere and a
   mend. One printer draws every caret. Used by the law compiler and by the deck reader alike. */
#ifndef PERILAT_DSL_DIAGNOSTICS_H
#define PERILAT_DSL_DIAGNOSTICS_H

#include <stdarg.h>
#include <stdbool.h>
#include <stdio.h>

#include "dsl/base/c_linkage.h"
#include "dsl/base/source.h"

C_LINKAGE_BEGIN

typedef enum diag_code {
#define X(code, name, severity) DIAG_##code,
#include "dsl/base/diagnostic_codes.h"
#undef X
  DIAG_COUNT
} diag_code;

typedef enum severity { SEVERITY_ERROR, SEVERITY_WARNING } severity;

typedef struct diagnostic {
  diag_code code;
  span where;
  char *message; /* one sentence, no full stop, in the user's words */
  char *note;    /* NULL, or a sentence about note_where (e.g. "first declared here") */
  span note_where;
  char *hint;           /* NULL, or how to mend it (e.g. "did you mean `alpha2`?") */
  const char *accepted; /* NULL, or why the law means it */
} diagnostic;

typedef struct diagnostics {
  source_set *sources; /* not owned */
  diagnostic *items;
  int count;
  int errors;
  diagnostic *accepted; /* set apart: neither errors nor warnings */
  int accepted_count;
} diagnostics;

void diag_begin(diagnostics *d, source_set *sources);
void diag_clear(diagnostics *d);

/* Adds one diagnostic. note and hint attach to the one added last. */
void diag_report(diagnostics *d, diag_code code, span where, const char *format, ...)
    __attribute__((format(printf, 4, 5)));
/* Adds it where said[code] is not set, and sets that: checks speak once. Returns whether it did. */
bool diag_report_once(diagnostics *d, bool said[DIAG_COUNT], diag_code code, span where,
                      const char *format, va_list values) __attribute__((format(printf, 5, 0)));
void diag_note(diagnostics *d, span where, const char *format, ...)
    __attribute__((format(printf, 3, 4)));
void diag_hint(diagnostics *d, const char *format, ...) __attribute__((format(printf, 2, 3)));
/* Whether the last one has a hint. */
bool diag_hinted(const diagnostics *d);
/* Adds the hint "did you mean `x`?" when one of the candidates is close enough to `name`. */
void diag_suggest(diagnostics *d, const char *name, const char *const *candidates, int count);

/* Whether it is about mechanics or ranges, so that a law may say that it means what is found. */
bool diag_may_be_accepted(diag_code code);
/* Sets item k apart, with the reason, which is not copied. */
void diag_accept(diagnostics *d, int k, const char *why);

const char *diag_name(diag_code code); /* e.g. "unknown-name" */
severity diag_severity(diag_code code);

/* Prints all, sorted by place, and then what is accepted:
     law.plm:7:12: error: there is no quantity `alfa2` [unknown-name]
       7 |   x = alfa2*stretch
         |       ^~~~~
       hint: did you mean `alpha2`?                                       */
void diag_print(const diagnostics *d, FILE *out);
/* The command that explains the codes printed since the last call, on one line; nothing where there
 * were none. */
void diag_print_topics(FILE *out);

/* Pointers to all of them in the order of their places, as printed; to be freed. */
const diagnostic **diag_sorted(const diagnostics *d);

/* Candidate nearest to `name` (edit distance, case-insensitive first), or NULL. */
const char *nearest_name(const char *name, const char *const *candidates, int count);

C_LINKAGE_END

#endif
