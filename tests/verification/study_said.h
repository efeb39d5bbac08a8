/* What a study of an example says in its document. To be included after cmocka.h and math.h. */
#ifndef PERILAT_TESTS_STUDY_SAID_H
#define PERILAT_TESTS_STUDY_SAID_H

#include "tests/dsl/json_valid.h"
#include "tests/generator/command_tools.h"

static inline void is_near(double value, double expected, double tolerance) {
  if (!(fabs(value - expected) <= tolerance))
    fail_msg("%.9g is not %.9g +- %.2g", value, expected, tolerance);
}

#define EXAMPLES SOURCE_DIR "/examples/"

static char *said; /* the document of the last study */

/* `perilat study ... --json` ends with the status. */
static inline void study(workplace *w, int status, const char *arguments) {
  size_t length;
  const int found = shell(w, "$P study %s --json > document", arguments);
  free(said);
  said = read_bytes(w, "document", &length);
  if (found != status || !json_is_valid(said)) show_failure(w, arguments, found, status, "");
  assert_int_equal(found, status);
  assert_true(json_is_valid(said));
}

/* The number of the last key of that name, which is one of the object itself; NaN for null. */
static inline double number(const char *key) {
  char quoted[100];
  const char *last = NULL;
  snprintf(quoted, sizeof quoted, "\n  \"%s\": ", key);
  for (const char *at = said; (at = strstr(at, quoted)); at++)
    last = at;
  if (!last) fail_msg("no `%s` in %s", key, said);
  last += strlen(quoted);
  return strncmp(last, "null", 4) == 0 ? NAN : strtod(last, NULL);
}

#endif
