#include "dsl/base/source.h"

#include <stdbool.h>
#include <stdlib.h>
#include <string.h>

#include "dsl/base/arena.h"

static char *copy_text(const char *text, size_t length) {
  char *copy = must_alloc(length + 1);
  if (length) memcpy(copy, text, length);
  copy[length] = '\0';
  return copy;
}

/* Not a UTF-8 continuation byte. */
static bool begins_character(char byte) {
  return ((unsigned char)byte & 0xC0) != 0x80;
}

enum { STRIDE = 1024 };

/* So that a place is found at once, however long the text and whatever its lines. */
static void index_text(source *s) {
  size_t lines = 1;
  for (size_t i = 0; i < s->length; i++)
    lines += s->text[i] == '\n';
  s->lines = must_alloc(lines * sizeof *s->lines);
  s->characters = must_alloc((s->length / STRIDE + 1) * sizeof *s->characters);
  s->lines[s->line_count++] = 0;
  uint32_t characters = 0;
  for (size_t i = 0; i <= s->length; i++) {
    if (i % STRIDE == 0) s->characters[i / STRIDE] = characters;
    if (i == s->length) break;
    characters += begins_character(s->text[i]);
    if (s->text[i] == '\n') s->lines[s->line_count++] = (uint32_t)(i + 1);
  }
}

/* Where lines end in a carriage return alone it is a line end. */
static void end_lines(source *s) {
  if (memchr(s->text, '\n', s->length)) return;
  for (size_t i = 0; i < s->length; i++)
    if (s->text[i] == '\r') s->text[i] = '\n';
}

int source_add(source_set *set, const char *name, const char *text, size_t length) {
  size_t count = (size_t)set->count + 1;
  set->items = must_realloc(set->items, count * sizeof(source));
  source *s = &set->items[set->count];
  *s = (source){.name = must_copy(name), .text = copy_text(text, length), .length = length};
  end_lines(s);
  index_text(s);
  return set->count++;
}

span source_whole(const source_set *set, int file) {
  return (span){0, (uint32_t)set->items[file].length, (uint16_t)file};
}

void source_clear(source_set *set) {
  for (int i = 0; i < set->count; i++) {
    free(set->items[i].name);
    free(set->items[i].text);
    free(set->items[i].lines);
    free(set->items[i].characters);
  }
  free(set->items);
  *set = (source_set){0};
}

static const source *source_at(const source_set *set, int file) {
  static uint32_t beginning[1];
  static const source none = {"", "", 0, beginning, beginning, 1};
  return file >= 0 && file < set->count ? &set->items[file] : &none;
}

static size_t offset_in(const source *s, uint32_t offset) {
  return offset < s->length ? offset : s->length;
}

/* The line that holds a byte, from 0. */
static int line_of(const source *s, size_t offset) {
  int low = 0, high = s->line_count;
  while (high - low > 1) {
    const int middle = low + (high - low) / 2;
    if (s->lines[middle] <= offset)
      low = middle;
    else
      high = middle;
  }
  return low;
}

/* Those that begin before a byte. */
static uint32_t characters_before(const source *s, size_t offset) {
  uint32_t count = s->characters[offset / STRIDE];
  for (size_t i = offset / STRIDE * STRIDE; i < offset; i++)
    count += begins_character(s->text[i]);
  return count;
}

const char *source_line(const source_set *set, int file, uint32_t offset, size_t *length) {
  const source *s = source_at(set, file);
  const int line = line_of(s, offset_in(s, offset));
  const size_t begin = s->lines[line];
  size_t end = line + 1 < s->line_count ? s->lines[line + 1] - 1 : s->length;
  if (end > begin && s->text[end - 1] == '\r') end--;
  *length = end - begin;
  return s->text + begin;
}

int source_line_number(const source_set *set, int file, uint32_t offset) {
  const source *s = source_at(set, file);
  return line_of(s, offset_in(s, offset)) + 1;
}

place source_place(const source_set *set, int file, uint32_t offset) {
  const source *s = source_at(set, file);
  const size_t at = offset_in(s, offset);
  const int line = line_of(s, at);
  return (place){line + 1,
                 (int)(characters_before(s, at) - characters_before(s, s->lines[line])) + 1};
}

span span_join(span a, span b) {
  if (a.file != b.file) return a;
  return (span){a.begin < b.begin ? a.begin : b.begin, a.end > b.end ? a.end : b.end, a.file};
}
