#include "dsl/base/arena.h"

#include <stdarg.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { CHUNK_SIZE = 64 * 1024, ALIGNMENT = _Alignof(max_align_t) };

/* The address sanitizer sees chunks only. It is told what in them may be touched, with a gap behind
   each allocation. */
#ifdef PERILAT_ADDRESS_SANITIZER
#include <sanitizer/asan_interface.h>
enum { GAP = _Alignof(max_align_t) };
#else
enum { GAP = 0 };
#define ASAN_POISON_MEMORY_REGION(memory, size)   ((void)(memory))
#define ASAN_UNPOISON_MEMORY_REGION(memory, size) ((void)(memory))
#endif

typedef struct chunk {
  struct chunk *next;
  size_t used, size;
  _Alignas(max_align_t) unsigned char bytes[];
} chunk;

struct arena {
  chunk *first;
};

enum { UNKNOWN = 0 };

static void end_without_memory(size_t size) {
  if (size == UNKNOWN)
    fputs("perilat: out of memory\n", stderr);
  else
    fprintf(stderr, "perilat: out of memory (%zu bytes asked for)\n", size);
  exit(2);
}

void *must_alloc(size_t size) {
  void *memory = malloc(size ? size : 1);
  if (!memory) end_without_memory(size);
  return memory;
}

void *must_calloc(size_t count, size_t size) {
  void *memory = calloc(count ? count : 1, size ? size : 1);
  if (!memory) end_without_memory(size && count > SIZE_MAX / size ? UNKNOWN : count * size);
  return memory;
}

void *must_realloc(void *old, size_t size) {
  void *memory = realloc(old, size ? size : 1);
  if (!memory) end_without_memory(size);
  return memory;
}

char *must_copy(const char *text) {
  return strcpy(must_alloc(strlen(text) + 1), text);
}

void *must_align(size_t alignment, size_t size) {
  const size_t rounded = (size + alignment - 1) / alignment * alignment;
  void *memory = rounded < size ? NULL : aligned_alloc(alignment, rounded ? rounded : alignment);
  if (!memory) end_without_memory(size);
  return memory;
}

FILE *must_open_text(char **text, size_t *length) {
  FILE *out = open_memstream(text, length);
  if (!out) end_without_memory(UNKNOWN);
  return out;
}

void must_close_text(FILE *out) {
  if (fclose(out) != 0) end_without_memory(UNKNOWN);
}

static void add_chunk(arena *a, size_t size) {
  chunk *added = must_calloc(1, sizeof(chunk) + size);
  added->size = size;
  added->next = a->first;
  ASAN_POISON_MEMORY_REGION(added->bytes, size);
  a->first = added;
}

arena *arena_new(void) {
  return must_calloc(1, sizeof(arena));
}

void arena_free(arena *a) {
  if (!a) return;
  for (chunk *c = a->first; c;) {
    chunk *next = c->next;
    free(c);
    c = next;
  }
  free(a);
}

void *arena_alloc(arena *a, size_t size) {
  if (size > SIZE_MAX / 2) end_without_memory(UNKNOWN);
  size_t rounded = (size + ALIGNMENT - 1) / ALIGNMENT * ALIGNMENT + GAP;
  if (!a->first || a->first->size - a->first->used < rounded)
    add_chunk(a, rounded > CHUNK_SIZE ? rounded : CHUNK_SIZE);
  void *memory = a->first->bytes + a->first->used;
  ASAN_UNPOISON_MEMORY_REGION(memory, size);
  a->first->used += rounded;
  return memory;
}

void *arena_room(arena *a, const void *items, int count, size_t size) {
  if (count & (count - 1)) return (void *)(uintptr_t)items;
  void *larger = arena_alloc(a, (count ? 2 * (size_t)count : 1) * size);
  if (count) memcpy(larger, items, (size_t)count * size);
  return larger;
}

char *arena_text(arena *a, const char *text, size_t length) {
  char *copy = arena_alloc(a, length + 1);
  if (length) memcpy(copy, text, length);
  copy[length] = '\0';
  return copy;
}

char *arena_printf(arena *a, const char *format, ...) {
  va_list values, again;
  va_start(values, format);
  va_copy(again, values);
  int length = vsnprintf(NULL, 0, format, values);
  va_end(values);
  size_t size = length < 0 ? 1 : (size_t)length + 1;
  char *text = arena_alloc(a, size);
  if (length >= 0) vsnprintf(text, size, format, again);
  va_end(again);
  return text;
}
