#include "generator/grade/marks.h"

#include <math.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include "dsl/base/characters.h"

enum { MOST_TEXT = 1 << 20, MOST_TEXTS = 1000 /* of a kind */ };

/* Ahead of each text. */
typedef struct record_head {
  int32_t what, item;
  double numbers[4];
  uint32_t length, mark;
} record_head;
static const uint32_t head_mark = 0x6d61726b;

void marks_open(marks *m, const char *name, int item_count) {
  *m = (marks){.memory = arena_new(), .item_count = item_count, .known = -1};
  m->name = arena_text(m->memory, name, strlen(name));
  m->items = arena_alloc(m->memory, ((size_t)item_count + 1) * sizeof *m->items);
  for (int k = 0; k < item_count; k++)
    m->items[k].value = NAN;
}

void marks_close(marks *m) {
  arena_free(m->memory);
  *m = (marks){.memory = NULL};
}

void record_write(FILE *out, mark_record what, int item, const double numbers[4],
                  const char *text) {
  record_head head = {.what = (int32_t)what, .item = item, .mark = head_mark};
  if (numbers) memcpy(head.numbers, numbers, sizeof head.numbers);
  size_t length = text ? strlen(text) : 0;
  if (length > MOST_TEXT) length = MOST_TEXT;
  head.length = (uint32_t)length;
  fwrite(&head, sizeof head, 1, out);
  if (length) fwrite(text, 1, length, out);
  fflush(out);
}

/* As it may be shown anywhere. */
static char *shown(arena *a, const char *text, size_t length) {
  char *safe;
  size_t size;
  FILE *out = must_open_text(&safe, &size);
  characters_show(out, text, length);
  must_close_text(out);
  char *kept = arena_text(a, safe, size);
  free(safe);
  return kept;
}

static int bounded(double number, int most) {
  return number >= 0 && number <= most ? (int)number : 0;
}

static char *joined(arena *a, char *before, const char *more) {
  return arena_printf(a, "%s%s%s", before ? before : "", before ? "\n" : "", more);
}

static void add_text(marks *m, text_list *to, char *text) {
  if (to->count == MOST_TEXTS) return;
  to->items = arena_room(m->memory, to->items, to->count, sizeof *to->items);
  to->items[to->count++] = text;
}

static void take_item(marks *m, const record_head *h, char *text) {
  if (h->item < 0 || h->item >= m->item_count) return;
  item_mark *i = &m->items[h->item];
  switch (h->what) {
  case RECORD_MARK:
    i->judged = true;
    i->share = h->numbers[0] >= 0 && h->numbers[0] <= 1 ? h->numbers[0] : 0;
    i->passed = bounded(h->numbers[1], 1000000);
    i->of = bounded(h->numbers[2], 1000000);
    i->value = h->numbers[3];
    return;
  case RECORD_WORDS:
    i->words = joined(m->memory, i->words, text);
    return;
  case RECORD_STATE:
    i->state = text;
    return;
  case RECORD_CURVE:
    i->curve = text;
    return;
  default:
    return;
  }
}

static void take_record(marks *m, const record_head *h, char *text) {
  switch (h->what) {
  case RECORD_CHECKED:
    m->errors = bounded(h->numbers[0], 1000000);
    m->warnings = bounded(h->numbers[1], 1000000);
    m->holes = bounded(h->numbers[2], 1000000);
    return;
  case RECORD_MESSAGE:
    add_text(m, &m->messages, text);
    return;
  case RECORD_ADVICE:
    add_text(m, &m->advice, text);
    return;
  case RECORD_SENTENCE:
    m->sentence = text;
    m->known = bounded(h->numbers[0], 1000000);
    return;
  case RECORD_NOTE:
    add_text(m, &m->notes, text);
    return;
  case RECORD_CASES:
    m->cases = bounded(h->numbers[0], 1000000);
    m->reached = bounded(h->numbers[1], 1000000);
    return;
  case RECORD_END:
    m->ended = true;
    return;
  default:
    take_item(m, h, text);
  }
}

void records_read(marks *m, const char *data, size_t size) {
  record_head head;
  while (size >= sizeof head) {
    memcpy(&head, data, sizeof head);
    if (head.mark != head_mark || head.length > size - sizeof head) return;
    take_record(m, &head, shown(m->memory, data + sizeof head, head.length));
    data += sizeof head + head.length;
    size -= sizeof head + head.length;
  }
}
