/* Quantities in words: a number with a unit in an option of a command, "58.88 kN", "0.128mm",
   "0.05"; a time as reports have it, "4.1 ms". */
#ifndef PERILAT_RUNTIME_QUANTITY_H
#define PERILAT_RUNTIME_QUANTITY_H

#include <stdbool.h>
#include <stddef.h>

/* Reads the first `length` bytes of the text in SI; a plain number is in SI. False unless all of it
   is a finite number and perhaps a unit of the same dimension as `si_unit`. */
bool quantity_read(const char *text, size_t length, const char *si_unit, double *value);
/* True when the text begins as a number does. */
bool quantity_begins(const char *text);

/* A time (s) with so many digits: "4.1 ms", from 10 s on "20 s", from an hour on "31 h". */
enum { TIME_TEXT = 40 };
const char *time_text(double time, int digits, char text[TIME_TEXT]);

#endif
