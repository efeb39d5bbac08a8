#include "dsl/digits.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

const char *fewest_digits(double number, char text[DIGITS_TEXT]) {
  char tried[DIGITS_TEXT];
  for (int digits = 15; digits <= 17; digits++) {
    snprintf(tried, sizeof tried, "%.*g", digits, number);
    if (strtod(tried, NULL) == number) break;
  }
  return memcpy(text, tried, sizeof tried);
}
