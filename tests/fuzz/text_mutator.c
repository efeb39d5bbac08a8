/* How libFuzzer changes texts: as it does bytes, and, more often, by words and lines. A word or
   line takes the place of another, comes before it, or goes; with two texts it comes from the
   other. A word is mostly replaced by one of its kind: a name by a name, a number by a number. So
   more of the inventions are right enough to get past the reader. */
#include <ctype.h>
#include <string.h>

#include "tests/fuzz/fuzz.h"

size_t LLVMFuzzerMutate(uint8_t *data, size_t size, size_t most);
size_t LLVMFuzzerCustomMutator(uint8_t *data, size_t size, size_t most, unsigned seed);
size_t LLVMFuzzerCustomCrossOver(const uint8_t *one, size_t one_size, const uint8_t *other,
                                 size_t other_size, uint8_t *out, size_t most, unsigned seed);

typedef struct piece {
  const uint8_t *begin, *end;
} piece;

static unsigned draw(unsigned *seed, size_t below) {
  *seed = *seed * 1664525u + 1013904223u;
  return (unsigned)((*seed >> 8) % below);
}

static bool in_word(uint8_t c) {
  return isalnum(c) || c == '_' || c == '.';
}

/* The word, or the mark alone, at a place. */
static piece word_at(const uint8_t *text, size_t size, size_t place) {
  size_t begin = place, end = place + 1;
  if (in_word(text[place])) {
    while (begin > 0 && in_word(text[begin - 1]))
      begin--;
    while (end < size && in_word(text[end]))
      end++;
  }
  return (piece){text + begin, text + end};
}

/* With the line's end. */
static piece line_at(const uint8_t *text, size_t size, size_t place) {
  size_t begin = place, end = place;
  while (begin > 0 && text[begin - 1] != '\n')
    begin--;
  while (end < size && text[end] != '\n')
    end++;
  return (piece){text + begin, text + (end < size ? end + 1 : end)};
}

static bool alike(const uint8_t *a, const uint8_t *b) {
  return in_word(*a) ? in_word(*b) && !isdigit(*a) == !isdigit(*b) : !in_word(*b);
}

/* The place of a word in `from` that is, after some tries, of the kind of the one at `old`. */
static size_t draw_alike(const uint8_t *old, const uint8_t *from, size_t size, unsigned *seed) {
  size_t place = draw(seed, size);
  for (int tries = 0; tries < 8 && !alike(old, from + place); tries++)
    place = draw(seed, size);
  return place;
}

/* `to` with a piece of `from` in it. Returns the number of bytes in `out`. */
static size_t splice(const uint8_t *to, size_t to_size, const uint8_t *from, size_t from_size,
                     uint8_t *out, size_t most, unsigned *seed) {
  piece (*const pick)(const uint8_t *, size_t, size_t) = draw(seed, 2) ? word_at : line_at;
  const piece old = pick(to, to_size, draw(seed, to_size));
  piece new = pick(from, from_size, draw_alike(old.begin, from, from_size, seed));
  const unsigned how = draw(seed, 8);
  if (how == 0) new.end = new.begin;                    /* goes */
  const uint8_t *rest = how <= 5 ? old.end : old.begin; /* else: comes before */
  const size_t head = (size_t)(old.begin - to), middle = (size_t)(new.end - new.begin),
               tail = (size_t)(to + to_size - rest);
  if (head + middle + tail > most) return 0;
  memcpy(out, to, head);
  memcpy(out + head, new.begin, middle);
  memcpy(out + head + middle, rest, tail);
  return head + middle + tail;
}

size_t LLVMFuzzerCustomMutator(uint8_t *data, size_t size, size_t most, unsigned seed) {
  if (size == 0 || draw(&seed, 3) == 0) return LLVMFuzzerMutate(data, size, most);
  uint8_t *copy = malloc(most);
  MUST(copy);
  const size_t made = splice(data, size, data, size, copy, most, &seed);
  memcpy(data, copy, made);
  free(copy);
  return made ? made : LLVMFuzzerMutate(data, size, most);
}

size_t LLVMFuzzerCustomCrossOver(const uint8_t *one, size_t one_size, const uint8_t *other,
                                 size_t other_size, uint8_t *out, size_t most, unsigned seed) {
  if (one_size == 0 || other_size == 0) return 0;
  return splice(one, one_size, other, other_size, out, most, &seed);
}
