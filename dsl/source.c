#include "dsl/source.h"

#include <stdlib.h>
#include <string.h>

#include "dsl/arena.h"

static char *copy_text(const char *text, size_t length) {
  char *copy = must_alloc(length + 1);
  if (length) memcpy(copy, text, length);
  copy[length] = '\0';
  return copy;
}

int source_add(source_set *set, const char *name, const char *text, size_t length) {
  size_t count = (size_t)set->count + 1;
  set->items = must_realloc(set->items, count * sizeof(source));
  set->items[set->count] = (source){copy_text(name, strlen(name)), copy_text(text, length), length};
  return set->count++;
}

void source_clear(source_set *set) {
  for (int i = 0; i < set->count; i++) {
    free(set->items[i].name);
    free(set->items[i].text);
  }
  free(set->items);
  *set = (source_set){0};
}

static const source *source_at(const source_set *set, int file) {
  static const source none = {"", "", 0};
  return file >= 0 && file < set->count ? &set->items[file] : &none;
}

const char *source_line(const source_set *set, int file, uint32_t offset, size_t *length) {
  const source *s = source_at(set, file);
  size_t begin = offset < s->length ? offset : s->length;
  size_t end = begin;
  while (begin > 0 && s->text[begin - 1] != '\n')
    begin--;
  while (end < s->length && s->text[end] != '\n')
    end++;
  if (end > begin && s->text[end - 1] == '\r') end--;
  *length = end - begin;
  return s->text + begin;
}

place source_place(const source_set *set, int file, uint32_t offset) {
  const source *s = source_at(set, file);
  size_t end = offset < s->length ? offset : s->length;
  place at = {1, 1};
  for (size_t i = 0; i < end; i++) {
    if (s->text[i] == '\n')
      at = (place){at.line + 1, 1};
    else if (((unsigned char)s->text[i] & 0xC0) != 0x80) /* not a UTF-8 continuation byte */
      at.column++;
  }
  return at;
}

span span_join(span a, span b) {
  if (a.file != b.file) return a;
  return (span){a.begin < b.begin ? a.begin : b.begin, a.end > b.end ? a.end : b.end, a.file};
}
