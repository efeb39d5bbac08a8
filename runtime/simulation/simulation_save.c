#include "runtime/simulation/simulation_save.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "dsl/base/arena.h"
#include "runtime/continuum/cells_engine.h"
#include "runtime/result/checkpoint.h"
#include "runtime/simulation/simulation_state.h"
#include "runtime/simulation/step_shrink.h"

typedef struct part_list {
  checkpoint_part *items;
  int count;
} part_list;

static void add_part(part_list *l, const char *name, void *data, size_t bytes) {
  l->items = must_realloc(l->items, ((size_t)l->count + 1) * sizeof *l->items);
  l->items[l->count++] = (checkpoint_part){name, data, bytes};
}

static void add_fields(part_list *l, const sweep *w) {
  const size_t site = (size_t)w->lattice->size * sizeof(double);
  for (int f = 0; f < w->law->field_count; f++)
    add_part(l, w->law->fields[f].name, w->field[f],
             site * (size_t)sweep_planes(w, w->law->fields[f].place));
  if (!w->dissipated_state) return;
  add_part(l, "dissipated_state", w->dissipated_state, site);
  add_part(l, "dissipated_rate", w->dissipated_rate, site);
  if (w->given_by_rest) add_part(l, "given_by_rest", w->given_by_rest, site);
}

/* Of a mesh: the forces of the step before, and what has grown of its cracks. */
static void add_cells(part_list *l, cells_memory *m, tips *t) {
  for (int k = 0; k < m->count; k++)
    add_part(l, "forces of cells", m->planes[k], m->bytes[k]);
  if (!t) return;
  add_part(l, "steps of tips", &t->step, sizeof t->step);
  add_part(l, "released", &t->released, sizeof t->released);
  add_part(l, "rated", &t->rated, sizeof t->rated);
  add_part(l, "pieces", &t->pieces.count, sizeof t->pieces.count);
  add_part(l, "pieces", t->pieces.items, TIPS_MOST_PIECES * sizeof *t->pieces.items);
  add_part(l, "pieces", t->pieces.tip, TIPS_MOST_PIECES * sizeof *t->pieces.tip);
  add_part(l, "pieces", t->pieces.leg, TIPS_MOST_PIECES);
  for (int k = 0; k < t->count; k++) {
    mesh_tip *p = &t->items[k];
    add_part(l, "tip", &p->now, sizeof p->now);
    if (p->law && p->law->field_count > 0)
      add_part(l, "states of a tip", p->field,
               (size_t)p->law->field_count * PL_LANES * sizeof(double));
  }
}

static void add_state(part_list *l, const run_body *of) {
  const sweep *w = of->state;
  const size_t site = (size_t)of->lattice_rows->size * sizeof(double),
               row = (size_t)of->lattice_rows->row_count * sizeof(double);
  for (int d = 0; d < w->body->dof; d++) {
    add_part(l, "displacement", w->body->displacement[d], site);
    add_part(l, "velocity", w->body->velocity[d], site);
  }
  for (int n = 0; n < of->law_count; n++)
    add_fields(l, of->laws[n].state);
  if (w->body->weight) {
    add_part(l, "work_of_gravity", w->body->row_gravity, row);
    add_part(l, "gravity", w->body->gravity, sizeof w->body->gravity);
    add_part(l, "gravity_work", w->body->gravity_work, sizeof w->body->gravity_work);
  }
  if (w->body->row_outer) add_part(l, "work of outer forces", &w->body->outer_work, sizeof(double));
  if (of->rest) add_part(l, "given by rest", mesh_rest_sum(of->rest), sizeof(mesh_rest_account));
  add_part(l, "dissipated_mass", w->body->row_mass, row);
  add_part(l, "internal", w->body->row_internal, row);
  add_part(l, "decay", &w->body->decay, sizeof(double));
  add_part(l, "time of the states", &w->body->reached, sizeof(double));
  if (!of->cells) return;
  cells_memory m = cells_remembered(of->state);
  add_cells(l, &m, of->cells->tips);
  cells_memory_free(&m);
}

static void add_loads(part_list *l, loads *of) {
  add_part(l, "clock", &of->clock, sizeof(load_clock));
  add_part(l, "constraints", of->constraints, (size_t)of->constraint_count * sizeof(constraint));
  add_part(l, "forces", of->forces, (size_t)of->force_count * sizeof(applied));
}

static void add_relaxation(part_list *l, relaxation *r) {
  add_part(l, "relaxation", &r->state, sizeof r->state);
  for (int b = 0; b < r->body_count; b++) {
    add_part(l, "relaxed body", &r->looked_at[b].state, sizeof r->looked_at[b].state);
    const size_t site = (size_t)r->bodies[b].lattice_rows->size * sizeof(double);
    for (int d = 0; d < r->bodies[b].body->dof; d++) {
      add_part(l, "displacement looked at", r->looked_at[b].displacement[d], site);
      add_part(l, "force looked at", r->looked_at[b].force[d], site);
    }
  }
}

static void add_contact(part_list *l, run_contact *c) {
  add_part(l, "work of a contact", &c->work, sizeof c->work);
  add_part(l, "ledger", &c->ledger, sizeof c->ledger);
  add_part(l, "peaks of a contact", &c->peaks, sizeof c->peaks);
  for (int b = 0; b < c->count; b++) {
    size_t count;
    double *lost = contact_lost(c->found, b, &count);
    if (lost) add_part(l, "lost bonds", lost, count * sizeof *lost);
  }
}

static void add_stamp(part_list *l, run_stamp *s) {
  size_t count;
  double *dragged = stamp_dragged(s->found, &count);
  add_part(l, "stamp", &s->state, sizeof s->state);
  if (dragged) add_part(l, "dragged along a stamp", dragged, count * sizeof *dragged);
}

/* One list serves saving and restoring; `head` comes first. */
static part_list parts_of(const simulation *s, run_progress *head) {
  part_list l = {NULL, 0};
  add_part(&l, "progress", head, sizeof *head);
  const size_t samples = (size_t)head->samples * sizeof(double);
  for (int b = 0; b < s->body_count; b++) {
    add_state(&l, &s->bodies[b]);
    add_loads(&l, s->bodies[b].loads);
    add_part(&l, "ledger", &s->bodies[b].ledger, sizeof s->bodies[b].ledger);
    add_part(&l, "stiffened", &s->bodies[b].stiffened, sizeof s->bodies[b].stiffened);
  }
  for (int k = 0; k < s->link_count; k++)
    add_part(&l, "work of a link", &s->links[k].work, sizeof s->links[k].work);
  for (int k = 0; k < s->tie_count; k++) {
    tie_steps *t = &s->ties[k];
    add_part(&l, "work of a tie", &t->internal, sizeof t->internal);
    if (t->halves) add_part(&l, "taken by a tie", half_bonds_booked(t->halves), 2 * sizeof(double));
  }
  for (int k = 0; k < s->contacts.count; k++)
    add_contact(&l, &s->contacts.items[k]);
  for (int k = 0; k < s->stamps.count; k++)
    add_stamp(&l, &s->stamps.items[k]);
  if (s->relaxation) add_relaxation(&l, s->relaxation);
  for (int m = 0; m < s->monitors->count; m++)
    add_part(&l, s->deck->monitors[m].name, &s->monitors->items[m].state, sizeof(monitor_state));
  if (s->deck->frame_count > 0)
    add_part(&l, "events", s->frame_times.came, (size_t)s->deck->frame_count * sizeof(double));
  add_part(&l, "rings", s->monitors->ring_memory, (size_t)s->monitors->ring_size * sizeof(double));
  add_part(&l, "time", s->history.time, samples);
  for (int k = 0; k < s->history.series_count; k++)
    add_part(&l, "history", s->history.values + k * s->history.capacity, samples);
  return l;
}

bool simulation_save(const simulation *s, const char *path, const char *fingerprint,
                     const frame_mark *frames, char *error, size_t size) {
  run_progress head = s->clock.at;
  head.frames = *frames;
  part_list l = parts_of(s, &head);
  const bool good = checkpoint_write(path, fingerprint, l.items, l.count, error, size);
  free(l.items);
  return good;
}

static bool is_truth(int64_t of) {
  return of == 0 || of == 1;
}

/* The same of steps that have shrunk: each time at least by half. */
static bool steps_are_reachable(const simulation *s, const run_progress *at) {
  if (at->halvings < 0 || at->halvings > RUN_MOST_HALVINGS) return false;
  if (at->part < 0 || at->part >= INT64_C(1) << at->halvings) return false;
  if (at->change_count < 0 || at->change_count > at->halvings) return false;
  if (at->halvings > 0 && s->deck->simulation.shrink_every == 0) return false;
  if (at->looked < -1 || at->looked > at->step) return false;
  if (!is_truth(at->doubted) || !is_truth(at->touched)) return false;
  if (at->more < 0 || at->more >> RUN_MOST_HALVINGS > at->step) return false;
  step_change last = {.step = 0, .halvings = 0};
  for (int64_t k = 0; k < at->change_count; k++) {
    const step_change *c = &at->changes[k];
    if (c->step < last.step || c->step > at->step || c->halvings <= last.halvings ||
        c->halvings > at->halvings || c->cause < STEP_STIFFER || c->cause > STEP_TOUCHED ||
        c->body < 0 || c->body >= s->body_count)
      return false;
    last = *c;
  }
  return last.halvings == at->halvings;
}

/* Numbers that a run can have reached: array sizes and loops rely on them. Every sample takes at
   least one multiple of the interval, the one at the end perhaps none. */
static bool is_reachable(const simulation *s, const run_progress *at) {
  if (!is_truth(at->begun) || !is_truth(at->event)) return false;
  if (at->status < STEP_OK || at->status > STEP_BAD) return false;
  if (at->stop < -1 || at->stop >= s->deck->stop_count) return false;
  if (at->step < 0 || at->step > s->clock.step_count || (!at->begun && at->step > 0)) return false;
  if (!steps_are_reachable(s, at)) return false;
  if (at->next_sample < 0 || at->next_sample > s->history.capacity) return false;
  if (at->samples < (at->step > 0) || at->samples > at->next_sample + 1) return false;
  if (at->samples > s->history.capacity - (at->step < s->clock.step_count)) return false;
  if (s->relaxation && at->samples > run_clock_end(&s->clock) + 1) return false;
  return at->next_frame >= 0 && at->next_frame <= s->frame_times.count &&
         at->last_frame_step >= -1 && at->last_frame_step <= at->step && at->frames.count >= 0;
}

/* Places that the set-up chose: they index arrays, and no file may move them. */
typedef struct own_places {
  constraint *constraints;
  applied *forces;
} own_places;

static own_places keep_places(const loads *l) {
  const size_t held = (size_t)l->constraint_count * sizeof(constraint);
  const size_t pushed = (size_t)l->force_count * sizeof(applied);
  own_places own = {must_alloc(held + 1), must_alloc(pushed + 1)};
  if (held) memcpy(own.constraints, l->constraints, held);
  if (pushed) memcpy(own.forces, l->forces, pushed);
  return own;
}

/* Of what was read only what steps change is taken over. */
static void put_places_back(loads *l, const own_places *own) {
  for (long k = 0; k < l->constraint_count; k++) {
    const constraint read = l->constraints[k];
    constraint *c = &l->constraints[k];
    *c = own->constraints[k];
    c->active = read.active;
    c->anchor = read.anchor;
    c->held = read.held;
    c->velocity = read.velocity;
    memcpy(c->turning, read.turning, sizeof c->turning);
    c->impulse = read.impulse;
    c->reaction = read.reaction;
    c->sums = read.sums;
  }
  for (long k = 0; k < l->force_count; k++) {
    const applied read = l->forces[k];
    l->forces[k] = own->forces[k];
    l->forces[k].now = read.now;
    l->forces[k].velocity = read.velocity;
    l->forces[k].sums = read.sums;
  }
}

/* Counts that index arrays. */
static void put_counts_right(const simulation *s) {
  if (s->relaxation &&
      s->clock.at.samples > 0) { /* one at the start, and one after each increment */
    s->relaxation->state.done = s->clock.at.samples - 1;
    for (int b = 0; b < s->body_count; b++)
      s->bodies[b].loads->clock = relaxation_clock(s->relaxation, s->bodies[0].loads->clock.first);
  }
  for (int m = 0; m < s->monitors->count;
       m++) { /* one push a step, and perhaps one before the first */
    int64_t *filled = &s->monitors->items[m].state.filled;
    if (*filled < 0 || *filled > run_clock_position(&s->clock) + 1) *filled = 0;
  }
}

bool simulation_restore(simulation *s, const char *path, const char *fingerprint,
                        frame_mark *frames, char *error, size_t size) {
  run_progress head;
  if (!checkpoint_peek(path, fingerprint, &head, sizeof head, error, size)) return false;
  if (!is_reachable(s, &head)) {
    snprintf(error, size, "%s: the checkpoint holds a state of another size", path);
    return false;
  }
  part_list l = parts_of(s, &head);
  own_places *own = must_calloc((size_t)s->body_count, sizeof *own);
  for (int b = 0; b < s->body_count; b++)
    own[b] = keep_places(s->bodies[b].loads);
  const bool good = checkpoint_read(path, fingerprint, l.items, l.count, error, size);
  free(l.items);
  if (good) s->clock.at = head;
  if (good) step_shrink_restored(s);
  for (int k = 0; k < s->link_count; k++)
    s->links[k].known = false;
  for (int b = 0; b < s->body_count; b++) {
    if (good) put_places_back(s->bodies[b].loads, &own[b]);
    if (good) sweep_fields_set(s->bodies[b].state);
    if (good && s->bodies[b].cells) cells_restored(s->bodies[b].state);
    free(own[b].constraints);
    free(own[b].forces);
  }
  free(own);
  if (good) put_counts_right(s);
  if (good && frames) *frames = head.frames;
  return good;
}
