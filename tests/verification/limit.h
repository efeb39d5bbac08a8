/* Studies of a spacing that goes to 0, beside what the pages of the examples say of them. */
#ifndef PERILAT_TESTS_LIMIT_H
#define PERILAT_TESTS_LIMIT_H

#include <stdlib.h>
#include <string.h>

#include "generator/kernel/model.h"
#include "tests/generator/command_tools.h"
#include "tests/verification/page.h"

enum { MOST = 72 };

/* The numbers of the key in the document, in their order; returns how many. */
static inline int numbers_of(const char *said, const char *key, double *numbers) {
  char quoted[100];
  int count = 0;
  snprintf(quoted, sizeof quoted, "\"%s\": ", key);
  for (const char *at = said; (at = strstr(at, quoted)) && count < MOST; count++)
    numbers[count] = strtod(at += strlen(quoted), NULL);
  return count;
}

static inline double last_of(const char *said, const char *key) {
  double numbers[MOST];
  const int count = numbers_of(said, key, numbers);
  assert_true(count > 0);
  return numbers[count - 1];
}

static inline void says(const char *page, const char *row, const char *figure) {
  print_message("%s%s\n", row, figure);
  page_line_says(page, row, figure);
}

#endif
