/* What every page begins and ends with: its policy, which lets nothing in or out, its style and its
   script. */
#ifndef PERILAT_GENERATOR_PAGE_SHELL_H
#define PERILAT_GENERATOR_PAGE_SHELL_H

#include <stdbool.h>
#include <stdio.h>

/* Up to the beginning of what is seen. */
void shell_begin(FILE *out, const char *title);
/* `data`: a JSON text for the script, or NULL: a page without script. */
void shell_end(FILE *out, const char *data);
/* Writes the page, whole or not at all. False with a sentence. */
bool shell_write(const char *path, const char *text, size_t length, char *error, size_t size);

#endif
