/* This room: what a result holds as one page that a browser shows without a network. Here texts as
   HTML: whatever they hold, they are text and nothing else. */
#ifndef PERILAT_GENERATOR_PAGE_HTML_H
#define PERILAT_GENERATOR_PAGE_HTML_H

#include <stddef.h>
#include <stdio.h>

/* For what stands between tags, and for a value in double quotes: characters that mean something
   there are written out; what would command or turn the text around is shown as a terminal has it
   (characters.h). */
void html_text(FILE *out, const char *text);
void html_bytes(FILE *out, const char *text, size_t length);
/* printf, and what comes out is text. */
void html_print(FILE *out, const char *format, ...) __attribute__((format(printf, 2, 3)));
/* A value in SI with a unit that reads well, "5.88075 kN", to six digits. */
enum { HTML_QUANTITY = 96 };
const char *html_quantity(double value, const char *si_unit, char text[HTML_QUANTITY]);
/* The same into a page, with the unit as html_unit has it. */
void html_put_quantity(FILE *out, double value, const char *si_unit);
/* A unit as people write it: N*m as N·m, m^2 as m². */
void html_unit(FILE *out, const char *unit_text);

#endif
