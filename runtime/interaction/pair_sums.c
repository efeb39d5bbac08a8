#include "runtime/interaction/pair_sums.h"

#include <stdlib.h>
#include <string.h>

#include "dsl/base/arena.h"

/* --- sums ------------------------------------------------------------------------------------- */

pair_sums pair_sums_new(sweep *w, const body_block *b, int reach) {
  const rows *g = w->lattice;
  pair_sums s = {.before = b->first > reach ? b->first - reach : 0, .last = b->last};
  s.base = rows_start(g, s.before);
  s.size = rows_start(g, b->last + reach) + g->pitch - s.base;
  if (s.size > g->size - s.base) s.size = g->size - s.base;
  s.sum = must_calloc((size_t)w->law->sum_count + 1, sizeof *s.sum);
  s.at_run = must_calloc((size_t)w->law->sum_count + 1, sizeof *s.at_run);
  for (int k = 0; k < w->law->sum_count; k++)
    s.sum[k] = body_doubles(w->body, s.size);
  return s;
}

void pair_sums_free(pair_sums *s) {
  free(s->sum);
  free(s->at_run);
}

double *const *pair_sums_at(const sweep *w, pair_sums *s, long start) {
  for (int k = 0; k < w->law->sum_count; k++)
    s->at_run[k] = s->sum[k] + (start - s->base);
  return s->at_run;
}

void pair_sums_clear_ahead(const sweep *w, pair_sums *s) {
  const long own = rows_start(w->lattice, s->last) - s->base;
  for (int k = 0; k < w->law->sum_count && own < s->size; k++)
    memset(s->sum[k] + own, 0, (size_t)(s->size - own) * sizeof(double));
}

/* --- marks ------------------------------------------------------------------------------------ */

uint64_t **pair_marks_new(sweep *w) {
  const pl_law *law = w->law;
  uint64_t **marks = must_calloc((size_t)law->field_count + 1, sizeof *marks);
  for (int f = 0; f < law->field_count; f++) {
    if (law->fields[f].place == PL_ON_PARTICLE) continue;
    const size_t words = (size_t)(w->lattice->size / PL_LANES) + 1;
    marks[f] = must_calloc(words, sizeof **marks);
    w->body->bytes += words * sizeof **marks;
  }
  return marks;
}

void pair_marks_free(const sweep *w, uint64_t **marks) {
  for (int f = 0; f < w->law->field_count && marks; f++)
    free(marks[f]);
  free(marks);
}

typedef bool (*marker)(const double *values, const double *others); /* of PL_LANES values */

static bool is_filled(const double *values, const double *others) {
  static const double zeros[PL_LANES];
  (void)others;
  return memcmp(values, zeros, sizeof zeros) != 0;
}

static bool is_settled(const double *values, const double *others) {
  return memcmp(values, others, PL_LANES * sizeof *values) == 0;
}

static void find_marks(const sweep *w, double *const *field, double *const *other, marker has,
                       uint64_t **marks) {
  const rows *g = w->lattice;
  for (int f = 0; f < w->law->field_count; f++)
    for (long q = 0; marks[f] && q + PL_LANES <= g->size; q += PL_LANES) {
      uint64_t word = 0;
      for (int k = 0; k < g->directions; k++)
        if (has(field[f] + k * g->size + q, other[f] + k * g->size + q)) word |= UINT64_C(1) << k;
      marks[f][q / PL_LANES] = word;
    }
}

void pair_marks_filled(const sweep *w, double *const *field, uint64_t **marks) {
  find_marks(w, field, field, is_filled, marks);
}

void pair_marks_settled(const sweep *w, double *const *field, double *const *other,
                        uint64_t **marks) {
  find_marks(w, field, other, is_settled, marks);
}
