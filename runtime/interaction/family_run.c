#include "runtime/interaction/family_run.h"

#include "runtime/base/clock.h"

static void point_at_fields(const sweep *w, family_block *b, long start) {
  const family *f = family_of(w);
  for (int k = 0; k < w->law->field_count; k++) {
    b->old_field[k] = (b->observing ? w->new_field : w->field)[k] + start;
    b->new_field[k] = w->new_field[k] + start;
  }
  for (int k = 0; k <= w->law->output_count; k++)
    b->observed[k] = f->observed[k] + start;
  for (int k = 0; k < w->law->varying_count; k++)
    b->parameter[k] = w->parameter[k] + start;
  for (int k = 0; k < SHAPE_PLANES && f->shape[k]; k++)
    b->shape[k] = f->shape[k] + start;
  for (int d = 0; d < w->body->dof; d++)
    b->force[d] = w->force[d] + start;
}

/* Where the neighbours of the run's particles are. */
static void point_at_neighbours(const rows *g, int row, long start, pl_family *run) {
  const neighbour_list *l = g->list;
  if (!l) {
    run->offset = g->offset[g->row_class[row + g->margin]];
    return;
  }
  run->neighbour = l->neighbour + start;
  run->incoming = l->incoming + start;
  run->length = l->length + start;
  run->alike = l->alike ? l->alike + start / PL_LANES * 2 * g->directions : NULL;
  run->way = l->way;
  for (int d = 0; d < g->dimensions; d++)
    run->chord[d] = l->chord[d] + start;
  run->volume = g->site_volume + start;
}

void family_run_begin(const sweep *w, const pl_program *program, int block, pl_family *run) {
  const family *f = family_of(w);
  family_block *b = &f->blocks[block];
  b->observing = program == &w->law->observe;
  *run = (pl_family){.size = sizeof *run,
                     .row_stride = FAMILY_ROWS_ALIKE * w->lattice->pitch,
                     .neighbours = f->neighbours,
                     .plane = w->lattice->size,
                     .parameter = b->parameter,
                     .shape = b->shape,
                     .old_field = b->old_field,
                     .new_field = b->new_field,
                     .link = b->link,
                     .bond_link = b->bond_link,
                     .force = b->force,
                     .observed = b->observed,
                     .time = w->body->time,
                     .time_step = w->body->time_step,
                     .advance = w->body->advance};
}

void family_run_part(const sweep *w, int block, const row_part *at, pl_family *run) {
  const long start = body_start(w->body, at->row) + at->first;
  point_at_fields(w, &family_of(w)->blocks[block], start);
  run->count = at->end - at->first;
  run->rows = 1;
  run->new_plane = w->lattice->size;
  run->bonds = w->lattice->bonds + start;
  run->held = w->lattice->held + start;
  if (w->law->reads_mass)
    run->mass = (w->lattice->site_mass ? w->lattice->site_mass : family_of(w)->mass) + start;
  if (w->law->reads_share) run->share = (w->share ? w->share : family_of(w)->whole) + start;
  if (PL_HAS(w->law, reads_own_size) && w->law->reads_own_size)
    run->own_size = (w->lattice->own_size ? w->lattice->own_size : family_of(w)->whole) + start;
  if (w->lost_state) {
    const bool aside = w->body->blocks[block].aside;
    run->lost[PL_LOST_TO_STATES] = (aside ? w->lost_state : w->dissipated_state) + start;
    run->lost[PL_LOST_TO_RATES] = (aside ? w->lost_rate : w->dissipated_rate) + start;
    if (w->given_by_rest)
      run->lost[PL_GIVEN_BY_REST] = (aside ? w->given_now : w->given_by_rest) + start;
  }
  point_at_neighbours(w->lattice, at->row, start, run);
  for (int d = 0; d < w->body->dof; d++) {
    run->displacement[d] = w->body->displacement[d] + start;
    run->velocity[d] = w->body->velocity[d] + start;
  }
}

void family_run_row(const sweep *w, int block, int row, pl_family *run) {
  const row_part whole = whole_row(w->body, row);
  family_run_part(w, block, &whole, run);
}

static void point_at_links(const sweep *w, int block, int row) {
  const family *f = family_of(w);
  const long start = body_start(w->body, row);
  for (int k = 0; k < w->law->link_count; k++)
    f->blocks[block].link[k] = f->link[k] + start;
  for (int k = 0; k < w->law->bond_link_count; k++)
    f->blocks[block].bond_link[k] = f->bond_link[k] + start;
}

void family_run_row_with_links(const sweep *w, int block, int row, pl_family *run) {
  family_run_row(w, block, row, run);
  point_at_links(w, block, row);
  run->link_plane = run->plane;
  run->link_offset = run->offset;
}

double family_run_pass_begins(const sweep *w) {
  return w->body->timed ? monotonic_seconds() : 0;
}

void family_run_pass_ends(const sweep *w, int block, int pass, double begun) {
  const int slot = least(pass, BODY_TIMED_PASSES - 1);
  if (w->body->timed) w->body->blocks[block].passes[slot] += monotonic_seconds() - begun;
}
