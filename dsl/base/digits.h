/* A number as text, with the fewest digits, from 15 on, that give it back to the last bit. */
#ifndef PERILAT_DSL_DIGITS_H
#define PERILAT_DSL_DIGITS_H

enum { DIGITS_TEXT = 40 };

/* Returns `text`. */
const char *fewest_digits(double number, char text[DIGITS_TEXT]);

#endif
