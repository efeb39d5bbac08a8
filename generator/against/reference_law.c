#include "generator/against/reference_law.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* How near a case a state may be, in parts of the way; and what a jump is, in parts of the largest
   value of a column. */
static const double near = 1e-9, jump = 1e-6;

/* --- beside a case ---------------------------------------------------------------------------- */

/* A path of the same times that goes a little farther, or less far. */
static drive_input scaled(arena *memory, const drive_input *in, double factor) {
  drive_input out = *in;
  out.pieces = arena_alloc(memory, ((size_t)in->piece_count + 1) * sizeof *out.pieces);
  for (int k = 0; k < in->piece_count; k++) {
    drive_piece *p = &out.pieces[k];
    *p = in->pieces[k];
    p->amplitude *= factor;
    p->f.value *= factor;
    if (p->f.shape != TIME_TABLE) continue;
    double *values = arena_alloc(memory, ((size_t)p->f.count + 1) * sizeof *values);
    for (int q = 0; q < p->f.count; q++)
      values[q] = factor * p->f.values[q];
    p->f.values = values;
  }
  return out;
}

/* Marks rows of the table in which `moved`, driven a little farther, answers otherwise. Times that
   only one of them has, of stretches that an expectation names, are passed by. */
static void mark_jumps(reference_law *r, const drive_table *moved) {
  const drive_table *t = &r->table;
  const double *time = t->columns[DRIVE_COLUMN_TIME].values,
               *other = moved->columns[DRIVE_COLUMN_TIME].values;
  double *scales = must_calloc((size_t)t->column_count + 1, sizeof *scales);
  column_scales(t, scales);
  for (int c = 1; c < t->column_count && c < moved->column_count; c++) {
    const column_role role = column_role_of(t, c);
    const unsigned char mark = role == COLUMN_ENERGY ? SKIP_ENERGY : SKIP_ANSWER;
    if (role == COLUMN_ASIDE) continue;
    for (long k = 0, q = 0; k < t->rows && q < moved->rows; k++) {
      while (q < moved->rows - 1 && other[q] < time[k])
        q++;
      const double apart = fabs(t->columns[c].values[k] - moved->columns[c].values[q]);
      if (other[q] == time[k] && !(apart <= jump * scales[c])) r->skip[k] |= mark;
    }
  }
  free(scales);
}

/* No message is heard: a path that goes as far as it may goes too far here. */
static void look_beside(reference_law *r, double factor) {
  arena *memory = arena_new();
  diagnostics unheard;
  diag_begin(&unheard, r->of.said->sources);
  drive_input in = scaled(memory, &r->in, factor);
  driven_law moved = r->of;
  drive_table table = {.memory = NULL};
  drive_band band;
  moved.in = &in;
  moved.said = &unheard;
  if (driven_law_march(&moved, &table, &band)) mark_jumps(r, &table);
  if (table.memory) drive_table_free(&table);
  diag_clear(&unheard);
  arena_free(memory);
}

/* --- the whole -------------------------------------------------------------------------------- */

driven_outcome reference_law_drive(reference_law *r, arena *memory, const drive_input *in,
                                   const char *path, driven_law *kept, diagnostics *said) {
  drive_band band;
  *r = (reference_law){.in = *in};
  r->in.material.model = path;
  const driven_outcome outcome = kept ? driven_law_open_kept(&r->of, kept, memory, &r->in, said)
                                      : driven_law_open(&r->of, memory, &r->in, false, said);
  if (outcome != DRIVEN_READY) return outcome;
  if (!driven_law_march(&r->of, &r->table, &band)) return DRIVEN_UNSUITED;
  r->skip = must_calloc((size_t)r->table.rows + 1, sizeof *r->skip);
  look_beside(r, 1 + near);
  look_beside(r, 1 - near);
  return DRIVEN_READY;
}

void reference_law_close(reference_law *r) {
  if (r->table.memory) drive_table_free(&r->table);
  free(r->skip);
  driven_law_close(&r->of);
  *r = (reference_law){.skip = NULL};
}
