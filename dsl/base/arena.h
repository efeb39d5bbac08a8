/* Region allocator: trees, interned names and IR nodes live until their arena is freed.
   Running out of memory ends the program with a message; no call returns NULL. */
#ifndef PERILAT_DSL_ARENA_H
#define PERILAT_DSL_ARENA_H

#include <stddef.h>
#include <stdio.h>

#include "dsl/base/c_linkage.h"

C_LINKAGE_BEGIN

typedef struct arena arena;

arena *arena_new(void);
void arena_free(arena *a);

/* Zeroed memory of `size` bytes, aligned for any scalar type. */
void *arena_alloc(arena *a, size_t size);
/* NUL-terminated copy of `length` bytes of `text`. */
char *arena_text(arena *a, const char *text, size_t length);
/* Formatted string. */
char *arena_printf(arena *a, const char *format, ...) __attribute__((format(printf, 2, 3)));

/* A list of `count` items with room for one more at least: the same, or a copy twice as long where
 * the count is a power of two. */
void *arena_room(arena *a, const void *items, int count, size_t size);

/* malloc, realloc, calloc, strdup that end the program with a message instead of returning NULL. */
void *must_alloc(size_t size);
void *must_calloc(size_t count, size_t size);
void *must_realloc(void *old, size_t size);
char *must_copy(const char *text);
/* Memory that begins at a multiple of `alignment`, a power of two; of as many bytes, rounded up to
 * it. */
void *must_align(size_t alignment, size_t size);
/* A text in memory that is written like a file (open_memstream), and its end. */
FILE *must_open_text(char **text, size_t *length);
void must_close_text(FILE *out);

C_LINKAGE_END

#endif
