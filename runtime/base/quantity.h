/* A number with a unit in an option of a command: "58.88 kN", "0.128mm", "0.05". */
#ifndef PERILAT_RUNTIME_QUANTITY_H
#define PERILAT_RUNTIME_QUANTITY_H

#include <stdbool.h>
#include <stddef.h>

/* Reads the first `length` bytes of the text in SI; a plain number is in SI. False unless all of it
   is a finite number and perhaps a unit of the same dimension as `si_unit`. */
bool quantity_read(const char *text, size_t length, const char *si_unit, double *value);
/* True when the text begins as a number does. */
bool quantity_begins(const char *text);

#endif
