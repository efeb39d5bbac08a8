#include "dsl/base/digits.h"

#include <stdio.h>
#include <stdlib.h>

const char *fewest_digits(double number, char text[DIGITS_TEXT]) {
  for (int digits = 15; digits <= 17; digits++) {
    snprintf(text, DIGITS_TEXT, "%.*g", digits, number);
    if (strtod(text, NULL) == number) break;
  }
  return text;
}
