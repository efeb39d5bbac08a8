/* All that a later step depends on, as a checkpoint. */
#include <stdio.h>
#include <stdlib.h>

#include "runtime/checkpoint.h"
#include "runtime/simulation_parts.h"

typedef struct part_list {
  checkpoint_part *items;
  int count;
} part_list;

static void add_part(part_list *l, const char *name, void *data, size_t bytes) {
  l->items = must_realloc(l->items, ((size_t)l->count + 1) * sizeof *l->items);
  l->items[l->count++] = (checkpoint_part){name, data, bytes};
}

static void add_state(part_list *l, const simulation *s) {
  const sweep *w = s->state;
  const size_t site = (size_t)s->lattice->size * sizeof(double);
  for (int d = 0; d < w->dof; d++) {
    add_part(l, "displacement", w->displacement[d], site);
    add_part(l, "velocity", w->velocity[d], site);
  }
  for (int f = 0; f < w->law->field_count; f++)
    add_part(l, w->law->fields[f].name, w->field[f], site * (size_t)s->lattice->directions);
  if (w->ledger) {
    add_part(l, "dissipated_state", w->dissipated_state, site);
    add_part(l, "dissipated_rate", w->dissipated_rate, site);
  }
  add_part(l, "dissipated_mass", w->row_mass, (size_t)s->lattice->row_count * sizeof(double));
}

/* One list serves saving and restoring; `head` comes first. */
static part_list parts_of(const simulation *s, progress_state *head) {
  part_list l = {NULL, 0};
  add_part(&l, "progress", head, sizeof *head);
  const size_t samples = (size_t)head->samples * sizeof(double);
  add_state(&l, s);
  add_part(&l, "decay", &s->state->decay, sizeof(double));
  add_part(&l, "constraints", s->loads->constraints,
           (size_t)s->loads->constraint_count * sizeof(constraint));
  add_part(&l, "forces", s->loads->forces, (size_t)s->loads->force_count * sizeof(applied));
  add_part(&l, "work", &s->loads->work, sizeof(double));
  add_part(&l, "dissipated", &s->loads->dissipated, sizeof(double));
  for (int m = 0; m < s->monitors->count; m++)
    add_part(&l, s->deck->monitors[m].name, &s->monitors->items[m].state, sizeof(monitor_state));
  add_part(&l, "rings", s->monitors->ring_memory, (size_t)s->monitors->ring_size * sizeof(double));
  add_part(&l, "ledger", (void *)&s->ledger, sizeof s->ledger);
  add_part(&l, "time", s->time, samples);
  for (int k = 0; k < s->series_count; k++)
    add_part(&l, "history", s->history + k * s->history_capacity, samples);
  return l;
}

bool simulation_save(const simulation *s, const char *path, const char *fingerprint, long frames,
                     char *error, size_t size) {
  progress_state head = s->at;
  head.result_frames = frames;
  part_list l = parts_of(s, &head);
  const bool good = checkpoint_write(path, fingerprint, l.items, l.count, error, size);
  free(l.items);
  return good;
}

bool simulation_restore(simulation *s, const char *path, const char *fingerprint, long *frames,
                        char *error, size_t size) {
  progress_state head;
  if (!checkpoint_peek(path, fingerprint, &head, sizeof head, error, size)) return false;
  if (head.samples < 0 || head.samples > s->history_capacity || head.step < 0 ||
      head.step > s->step_count) {
    snprintf(error, size, "%s: the checkpoint holds a state of another size", path);
    return false;
  }
  part_list l = parts_of(s, &head);
  const bool good = checkpoint_read(path, fingerprint, l.items, l.count, error, size);
  free(l.items);
  if (!good) return false;
  s->at = head;
  if (frames) *frames = (long)head.result_frames;
  return true;
}
