#include "runtime/interaction/family_forces.h"

#include <stdlib.h>
#include <string.h>

#include "dsl/base/arena.h"
#include "runtime/interaction/family_run.h"
#include "runtime/interaction/pair_sums.h"

/* Planes over the sites of a body, and where they begin for the run at hand. */
typedef struct planes {
  int count;
  double **all, **at;
} planes;

/* Marks of fields (pl_family.old_filled), and where they begin for the run at hand. */
typedef struct marks {
  uint64_t **all, **at;
} marks;

/* Two, and one for the last bond of a ring of bonds of one direction, as lists may have them, with
   an odd number of bonds. */
enum { RUNS = 3 };

struct family_forces {
  sweep *w;
  planes field;           /* new ones, aside; each of as many planes as it has */
  planes link, bond_link; /* of the whole body */
  planes shown;           /* bond_link with 0 for bonds that are not seen, where they are shared */
  planes force;           /* [dof] */
  bool *shared;           /* [bond_link_count] owners keep it for both ends */
  uint64_t *run[RUNS];    /* [size] bit k: of direction k seen in that run */
  uint64_t *seen, *incoming; /* [size] bonds that the last pass sees */
  pair_sums sums;
  marks filled, written, settled; /* of laws with sums */
};

/* --- set-up ----------------------------------------------------------------------------------- */

static planes planes_new(int count) {
  return (planes){.count = count,
                  .all = must_calloc((size_t)count + 1, sizeof(double *)),
                  .at = must_calloc((size_t)count + 1, sizeof(double *))};
}

static void planes_free(planes *p) {
  free(p->all);
  free(p->at);
}

static planes planes_of(sweep *w, int count, long values) {
  planes p = planes_new(count);
  for (int k = 0; k < count; k++)
    p.all[k] = body_doubles(w->body, values);
  return p;
}

static double *const *planes_at(planes *p, long site) {
  for (int k = 0; k < p->count; k++)
    p->at[k] = p->all[k] ? p->all[k] + site : NULL;
  return p->at;
}

static marks marks_new(sweep *w) {
  return (marks){pair_marks_new(w),
                 must_calloc((size_t)w->law->field_count + 1, sizeof(uint64_t *))};
}

static void marks_free(const sweep *w, marks *m) {
  pair_marks_free(w, m->all);
  free(m->at);
}

static uint64_t *const *marks_at(marks *m, int count, long site) {
  for (int k = 0; k < count; k++)
    m->at[k] = m->all[k] ? m->all[k] + site / PL_LANES : NULL;
  return m->at;
}

static planes new_fields(sweep *w) {
  planes p = planes_new(w->law->field_count);
  for (int k = 0; k < p.count; k++)
    p.all[k] = body_doubles(w->body, sweep_planes(w, w->law->fields[k].place) * w->lattice->size);
  return p;
}

/* Bits of a word: there are 32 such links at most. */
static bool is_shared(const pl_program *step, int link) {
  uint64_t bits = 0;
  for (int p = 0; p < step->pass_count && step->shared && link < 32; p++)
    bits |= step->shared[p] >> 2 * link & 3;
  return bits != 0;
}

static void find_shared(family_forces *f) {
  f->shared = must_calloc((size_t)f->bond_link.count + 1, sizeof *f->shared);
  f->shown = planes_new(f->bond_link.count);
  for (int k = 0; k < f->bond_link.count; k++) {
    f->shared[k] = is_shared(&f->w->law->step, k);
    f->shown.all[k] =
        f->shared[k]
            ? body_doubles(f->w->body, sweep_planes(f->w, PL_ON_NEIGHBOUR) * f->w->lattice->size)
            : f->bond_link.all[k];
  }
}

static bool has_run(const family_forces *f, long site, int direction) {
  return ((f->run[0][site] | f->run[1][site] | f->run[2][site]) >> direction & 1) != 0;
}

/* From one bond to the next of that direction, to the end or round to where it began. */
static void share_out_chain(family_forces *f, long first, int direction) {
  const rows *g = f->w->lattice;
  const uint64_t bit = UINT64_C(1) << direction;
  long q = first, last = first;
  int run = 1;
  while (rows_has_bond(g, q, direction) && !has_run(f, q, direction)) {
    run = !run;
    f->run[run][q] |= bit;
    last = q;
    q = rows_partner(g, q, direction);
  }
  if (q != first || last == first || run != 0) return;
  f->run[0][last] &= ~bit;
  f->run[2][last] |= bit;
}

/* Chains that begin somewhere, then rings. */
static void share_out(family_forces *f) {
  const rows *g = f->w->lattice;
  for (int r = 0; r < RUNS; r++)
    f->run[r] = must_calloc((size_t)g->size, sizeof *f->run[r]);
  for (int rings = 0; rings < 2; rings++)
    for (long q = 0; q < g->size; q++)
      for (int k = 0; g->bonds[q] && k < g->directions; k++)
        if (rings || !rows_has_neighbour(g, q, k + g->directions)) share_out_chain(f, q, k);
}

/* Whatever is marked as 0 or settled is looked at all the same. */
static void set_marks(family_forces *f) {
  const size_t words = (size_t)(f->w->lattice->size / PL_LANES);
  for (int k = 0; k < f->field.count; k++) {
    if (!f->filled.all[k]) continue;
    memset(f->filled.all[k], 0xff, words * sizeof(uint64_t));
    memset(f->settled.all[k], 0, words * sizeof(uint64_t));
  }
}

family_forces *family_forces_new(sweep *w) {
  const rows *g = w->lattice;
  const long size = g->size, values = sweep_planes(w, PL_ON_NEIGHBOUR) * size;
  family_forces *f = must_calloc(1, sizeof *f);
  f->w = w;
  f->field = new_fields(w);
  f->link = planes_of(w, w->law->link_count, size);
  f->bond_link = planes_of(w, w->law->bond_link_count, values);
  f->force = planes_of(w, w->body->dof, size);
  find_shared(f);
  share_out(f);
  f->seen = must_calloc((size_t)size, sizeof *f->seen);
  f->incoming = must_calloc((size_t)size, sizeof *f->incoming);
  f->sums = pair_sums_new(w, &(body_block){.first = 0, .last = g->row_count}, family_of(w)->reach);
  f->filled = marks_new(w);
  f->written = marks_new(w);
  f->settled = marks_new(w);
  return f;
}

void family_forces_free(family_forces *f) {
  if (!f) return;
  planes *const all[] = {&f->field, &f->link, &f->bond_link, &f->shown, &f->force};
  for (size_t k = 0; k < sizeof all / sizeof *all; k++)
    planes_free(all[k]);
  free(f->shared);
  for (int r = 0; r < RUNS; r++)
    free(f->run[r]);
  free(f->seen);
  free(f->incoming);
  pair_sums_free(&f->sums);
  marks_free(f->w, &f->filled);
  marks_free(f->w, &f->written);
  marks_free(f->w, &f->settled);
  free(f);
}

/* --- passes ----------------------------------------------------------------------------------- */

/* A pass on a part of a row. `bonds` and `incoming` are those it sees. */
static void run_part(family_forces *f, int pass, row_part at, const uint64_t *bonds,
                     const uint64_t *incoming, planes *bond_link) {
  const sweep *w = f->w;
  const long start = body_start(w->body, at.row) + at.first;
  pl_family run;
  if (at.first >= at.end) return;
  family_run_begin(w, &w->law->step, 0, &run);
  family_run_part(w, 0, &at, &run);
  run.bonds = bonds + start;
  run.incoming = incoming ? incoming + start : NULL;
  run.new_field = planes_at(&f->field, start);
  run.link = planes_at(&f->link, start);
  run.bond_link = planes_at(bond_link, start);
  run.force = planes_at(&f->force, start);
  run.link_plane = run.plane;
  run.link_offset = run.offset;
  run.held_near = 1;
  run.sum = pair_sums_at(w, &f->sums, start);
  run.old_filled = (const uint64_t *const *)marks_at(&f->filled, f->field.count, start);
  run.new_filled = marks_at(&f->written, f->field.count, start);
  run.settled = marks_at(&f->settled, f->field.count, start);
  w->law->step.pass[pass](w->law, family_of(w)->uniforms, &run);
}

void family_forces_find(family_forces *f) {
  const body *of = f->w->body;
  const rows *g = f->w->lattice;
  set_marks(f);
  for (int pass = 0; pass + 1 < f->w->law->step.pass_count; pass++) {
    for (int row = 0; row < g->row_count; row++)
      run_part(f, pass, whole_row(of, row), g->bonds, g->list ? g->list->incoming : NULL,
               &f->bond_link);
    pair_sums_clear_ahead(f->w, &f->sums);
  }
}

/* --- bond by bond ----------------------------------------------------------------------------- */

/* The bond of a site in that direction is seen from now on, or no longer. */
static void show(family_forces *f, long site, int direction, bool seen) {
  const rows *g = f->w->lattice;
  const uint64_t bit = UINT64_C(1) << direction;
  const long partner = rows_partner(g, site, direction);
  f->seen[site] = seen ? bit : 0;
  f->incoming[partner] = seen ? bit : 0;
  for (int k = 0; k < f->bond_link.count; k++)
    for (int side = 0; side < 2 && f->shared[k]; side++) {
      const long slot = (direction + side * g->directions) * g->size + site;
      f->shown.all[k][slot] = seen ? f->bond_link.all[k][slot] : 0;
    }
}

static bool is_of_run(const family_forces *f, const uint64_t *wanted, long site, int direction,
                      int run) {
  return ((f->run[run][site] & (wanted ? wanted[site] : UINT64_MAX)) >> direction & 1) != 0;
}

/* The part of a row on which the last pass has something to do, in whole vectors. */
static row_part part_seen(const family_forces *f, int row) {
  const body *of = f->w->body;
  row_part part = {row, of->count[row], 0};
  for (long q = 0, site = body_start(of, row); q < of->count[row]; q++, site++) {
    if (!f->seen[site] && !f->incoming[site]) continue;
    if (part.first > q) part.first = q / PL_LANES * PL_LANES;
    part.end = (q / PL_LANES + 1) * PL_LANES;
  }
  return part;
}

static void use_force(const family_forces *f, long site, int direction, bond_force_use *use,
                      void *to) {
  bond_force b = {.owner = site,
                  .partner = rows_partner(f->w->lattice, site, direction),
                  .direction = direction};
  for (int d = 0; d < f->force.count; d++) {
    b.on_owner[d] = f->force.all[d][b.owner];
    b.on_partner[d] = f->force.all[d][b.partner];
  }
  use(to, &b);
}

static void each_of_run(family_forces *f, const uint64_t *wanted, int direction, int run,
                        bond_force_use *use, void *to) {
  const rows *g = f->w->lattice;
  bool any = false;
  for (long q = 0; q < g->size; q++) {
    if (!is_of_run(f, wanted, q, direction, run)) continue;
    show(f, q, direction, true);
    any = true;
  }
  for (int row = 0; any && row < g->row_count; row++)
    run_part(f, f->w->law->step.pass_count - 1, part_seen(f, row), f->seen, f->incoming, &f->shown);
  pair_sums_clear_ahead(f->w, &f->sums);
  for (long q = 0; any && q < g->size; q++) {
    if (!f->seen[q]) continue;
    use_force(f, q, direction, use, to);
    show(f, q, direction, false);
  }
}

void family_forces_each(family_forces *f, const uint64_t *wanted, bond_force_use *use, void *to) {
  for (int k = 0; k < f->w->lattice->directions; k++)
    for (int run = 0; run < RUNS; run++)
      each_of_run(f, wanted, k, run, use, to);
}
