#include "generator/study/study_setting.h"

#include <string.h>

study_setting study_set(arena *a, const char *key, const char *value, span key_where,
                        span value_where) {
  return (study_setting){.key = key,
                         .value = value,
                         .text = arena_printf(a, "%s=%s", key, value),
                         .key_where = key_where,
                         .value_where = value_where};
}

study_setting study_set_text(arena *a, const study_text *given) {
  const size_t length = strlen(given->text), key = strcspn(given->text, "="),
               value = key < length ? key + 1 : length;
  const span where = given->where;
  return (study_setting){.key = arena_text(a, given->text, key),
                         .value = given->text + value,
                         .text = given->text,
                         .key_where = {where.begin, where.begin + (uint32_t)key, where.file},
                         .value_where = {where.begin + (uint32_t)value, where.end, where.file}};
}

deck_override *study_overrides(arena *a, const study_setting *settings, int count) {
  deck_override *overrides = arena_alloc(a, ((size_t)count + 1) * sizeof *overrides);
  for (int k = 0; k < count; k++)
    overrides[k].text = settings[k].text;
  return overrides;
}

/* --- where they stand ------------------------------------------------------------------------- */

/* Each override is a source named "--set", in their order. Negative: this is none. */
static int number_of(const source_set *sources, int file) {
  int number = 0;
  if (file >= sources->count || strcmp(sources->items[file].name, "--set") != 0) return -1;
  for (int k = 0; k < file; k++)
    number += strcmp(sources->items[k].name, "--set") == 0;
  return number;
}

/* A part of the text, within where the whole stands; all of that where it was written otherwise. */
static span part_of(span whole, size_t length, size_t begin, size_t end) {
  if (whole.end - whole.begin != length || end > length) return whole;
  return (span){whole.begin + (uint32_t)begin, whole.begin + (uint32_t)end, whole.file};
}

static span place_of(const study_setting *s, span in_text) {
  const size_t key = strlen(s->key), value = strlen(s->text) - strlen(s->value);
  if (in_text.begin < value && in_text.end > key)
    return span_join(s->key_where, s->value_where); /* as it was set */
  return in_text.begin < value ? part_of(s->key_where, key, in_text.begin, in_text.end)
                               : part_of(s->value_where, strlen(s->value), in_text.begin - value,
                                         in_text.end - value);
}

static void move(const source_set *from, const study_setting *settings, source_set *to,
                 span *where) {
  const int number = number_of(to, where->file);
  if (number < 0) return;
  span own_place = place_of(&settings[number], *where);
  if (own_place.file >= from->count) return;
  const source *own = &from->items[own_place.file];
  own_place.file = (uint16_t)source_add(to, own->name, own->text, own->length);
  *where = own_place;
}

void study_place(const source_set *from, const study_setting *settings, diagnostics *said) {
  for (int k = 0; k < said->count; k++) {
    diagnostic *one = &said->items[k];
    move(from, settings, said->sources, &one->where);
    if (one->note) move(from, settings, said->sources, &one->note_where);
  }
}
