#include "dsl/syntax/words.h"

#include <string.h>

/* Length of the word that stands first behind comments; *begin is where it begins. */
static size_t first_word(const char *text, const char **begin) {
  static const char blanks[] = " \t\r\f\v\n";
  if (strncmp(text, "\xEF\xBB\xBF", 3) == 0) text += 3;
  for (text += strspn(text, blanks); *text == '!'; text += strspn(text, blanks))
    text += strcspn(text, "\n");
  *begin = text;
  return strcspn(text, " \t\r\f\v\n!");
}

bool first_word_is(const char *text, const char *const *any, size_t count) {
  const char *begin;
  const size_t length = first_word(text, &begin);
  for (size_t k = 0; k < count; k++)
    if (strlen(any[k]) == length && memcmp(begin, any[k], length) == 0) return true;
  return false;
}
