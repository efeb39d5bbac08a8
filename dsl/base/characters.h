/* Characters of texts in UTF-8: how long each is, how many columns of a terminal it takes, and what
   is shown in place of one that would command the terminal or turn its text around. */
#ifndef PERILAT_DSL_CHARACTERS_H
#define PERILAT_DSL_CHARACTERS_H

#include <stdbool.h>
#include <stddef.h>
#include <stdio.h>

/* Length of the character at `text` (1 to 4), or 0 when the bytes there are none. */
size_t utf8_length(const char *text, size_t available);

/* A character as it is shown: itself, or written out as \x1b (a byte) or \u202e. */
typedef struct shown_character {
  size_t length; /* bytes of the text that it stands for; at least 1 */
  int columns;   /* a tab counts as one */
  char text[16]; /* NUL-terminated */
} shown_character;

/* Of a text that is not empty. Tabs and line ends stay. */
shown_character character_shown(const char *text, size_t available);
/* How many bytes at the beginning of a text are characters of ASCII that are shown as they are. */
size_t characters_plain(const char *text, size_t available);
/* Writes a text so. */
void characters_show(FILE *out, const char *text, size_t length);
/* Writes a byte of a text into XML or HTML, between tags or in a quoted value: written out where it
   means something there. */
void markup_put(FILE *out, char c);
/* Does a longer text end in `tail`? */
bool text_ends_in(const char *text, const char *tail);
/* A name on one line: line ends and tabs are written out, too. Good until the thread's fourth next
 * call. */
const char *name_shown(const char *name);

#endif
