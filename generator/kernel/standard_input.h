/* The text of the standard input, which a command is given as the file `-`: a pipe, say. It is read
   once, however often it is asked for. */
#ifndef PERILAT_GENERATOR_STANDARD_INPUT_H
#define PERILAT_GENERATOR_STANDARD_INPUT_H

#include <stdbool.h>
#include <stddef.h>

bool is_standard_input(const char *path);
/* NUL-terminated, until the program ends; NULL with the reason in *why where it cannot be read. */
const char *standard_input(size_t *length, const char **why);

#endif
