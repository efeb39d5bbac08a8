#include "runtime/base/pool.h"

#include <stdint.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>

#include "dsl/base/arena.h"
#include "runtime/kernel.h"

typedef struct piece {
  struct piece *before;
  char *memory;
  size_t size, used; /* B */
} piece;

struct pool {
  piece *last;
};

/* The address sanitizer sees the ends of arrays only if each has memory of its own. */
#if defined(__SANITIZE_ADDRESS__)
static const size_t least_piece = 0, large_page = PL_ALIGNMENT;
#else
static const size_t least_piece = (size_t)32 << 20, large_page = (size_t)2 << 20;
#endif

static size_t round_up(size_t bytes, size_t to) {
  return (bytes + to - 1) / to * to;
}

/* What is not written to takes no memory. */
static void add_piece(pool *p, size_t bytes) {
  piece *n = must_calloc(1, sizeof *n);
  n->before = p->last;
  n->size = round_up(bytes > least_piece ? bytes : least_piece, large_page);
  n->memory = must_align(large_page, n->size);
#if defined(MADV_HUGEPAGE)
  if (least_piece) madvise(n->memory, n->size, MADV_HUGEPAGE);
#endif
  p->last = n;
}

pool *pool_new(void) {
  return must_calloc(1, sizeof(pool));
}

void pool_free(pool *p) {
  if (!p) return;
  for (piece *n = p->last, *before; n; n = before) {
    before = n->before;
    free(n->memory);
    free(n);
  }
  free(p);
}

/* From one long array to the next the way is never nearly a multiple of a small page: a load would
   wait for the store to such a place. */
static size_t distance_of(size_t bytes) {
  enum { PAGE = 4096, STAGGER = 11 * 64 };
  return bytes < PAGE || !least_piece ? bytes : round_up(bytes, PAGE) + STAGGER;
}

double *pool_doubles(pool *p, long count) {
  const size_t bytes = round_up((size_t)count * sizeof(double) + (count == 0), PL_ALIGNMENT);
  const size_t distance = distance_of(bytes);
  if (!p->last || p->last->size - p->last->used < distance) add_piece(p, distance);
  double *array = (double *)(void *)(p->last->memory + p->last->used);
  p->last->used += distance;
  return memset(array, 0, bytes);
}
