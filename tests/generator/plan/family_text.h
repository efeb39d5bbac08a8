/* A law of families of a few lines, planned. */
#ifndef PERILAT_TESTS_FAMILY_TEXT_H
#define PERILAT_TESTS_FAMILY_TEXT_H

#include "tests/generator/law_text.h"

#define HEAD                                                                                       \
  "  law state\n  parameter a = 40 [MN] in (0, inf)\n  parameter b = 3 [MN] in (0, inf)\n"         \
  "  parameter nu = 0.2 in [0, 0.5)\n"

static inline tested_law *open_program(const char *setting, const char *lines) {
  char text[8000];
  snprintf(text, sizeof text, "model tested\n" HEAD "%s%send model\n", setting, lines);
  tested_law *t = open_law(text);
  if (!t->plan) fail_msg("no plan of:\n%s", text);
  return t;
}

#endif
