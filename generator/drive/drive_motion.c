#include "generator/drive/drive_motion.h"

#include <math.h>
#include <stdlib.h>

#include "dsl/base/arena.h"
#include "dsl/base/elementary.h"

/* --- the path as a function of time ----------------------------------------------------------- */

static double wave_at(const drive_piece *p, double since, bool slope) {
  double cycle = since / p->period, x = cycle - floor(cycle), a = p->amplitude;
  if (since < 0 || cycle >= p->cycles) return 0;
  switch (p->wave) {
  case WAVE_SINE:
    return slope ? a * 2 * M_PI / p->period * pl_cos(2 * M_PI * x) : a * pl_sin(2 * M_PI * x);
  case WAVE_PULSE:
    if (slope) return (x < 0.5 ? 2 : -2) * a / p->period;
    return a * (x < 0.5 ? 2 * x : 2 - 2 * x);
  default:
    if (slope) return (x < 0.25 || x >= 0.75 ? 4 : -4) * a / p->period;
    return a * (x < 0.25 ? 4 * x : x < 0.75 ? 2 - 4 * x : 4 * x - 4);
  }
}

double drive_at(const drive_input *in, drive_quantity q, double time) {
  double sum = 0;
  for (int k = 0; k < in->piece_count; k++) {
    const drive_piece *p = &in->pieces[k];
    if (p->quantity == q)
      sum += p->cyclic ? wave_at(p, time - p->start, false) : time_function_at(&p->f, time);
  }
  return sum;
}

double drive_slope(const drive_input *in, drive_quantity q, double time) {
  double sum = 0;
  for (int k = 0; k < in->piece_count; k++) {
    const drive_piece *p = &in->pieces[k];
    if (p->quantity == q)
      sum += p->cyclic ? wave_at(p, time - p->start, true) : time_function_slope(&p->f, time);
  }
  return sum;
}

bool drive_prescribes(const drive_input *in, drive_quantity q) {
  for (int k = 0; k < in->piece_count; k++)
    if (in->pieces[k].quantity == q) return true;
  return false;
}

/* --- times ------------------------------------------------------------------------------------ */

static long corner_count(const drive_piece *p) {
  return p->cyclic ? 4L * p->cycles + 1 : p->f.shape == TIME_TABLE ? p->f.count + 1L : 2;
}

static double corner(const drive_piece *p, long k) {
  if (p->cyclic) return p->start + (double)k * (p->period / 4);
  if (p->f.shape == TIME_TABLE) return k ? p->f.start + p->f.times[k - 1] : p->f.start;
  return k && p->f.shape != TIME_CONSTANT ? p->f.start + p->f.rise : p->f.start;
}

double drive_end(const drive_input *in) {
  double end = 0;
  if (in->simulation.end_time >= 0) return in->simulation.end_time;
  for (int k = 0; k < in->piece_count; k++)
    end = pl_fmax(end, corner(&in->pieces[k], corner_count(&in->pieces[k]) - 1));
  for (int k = 0; k < in->given_count; k++)
    end = pl_fmax(end, in->given[k].f.times[in->given[k].f.count - 1]);
  return end;
}

static int by_size(const void *a, const void *b) {
  double x = *(const double *)a, y = *(const double *)b;
  return (x > y) - (x < y);
}

/* Sorted, within [0, end], no two closer than rounding. */
static long clean(double *t, long count, double end) {
  long kept = 0;
  qsort(t, (size_t)count, sizeof *t, by_size);
  for (long k = 0; k < count; k++)
    if (t[k] >= 0 && t[k] <= end && (kept == 0 || t[k] - t[kept - 1] > 1e-12 * end))
      t[kept++] = t[k];
  return kept;
}

double *drive_corners(const drive_input *in, long *count) {
  long most = 0, n = 0;
  for (int k = 0; k < in->piece_count; k++)
    most += corner_count(&in->pieces[k]);
  for (int k = 0; k < in->given_count; k++)
    most += in->given[k].f.count;
  double *t = must_alloc((size_t)(most + 1) * sizeof *t);
  for (int k = 0; k < in->piece_count; k++)
    for (long c = 0; c < corner_count(&in->pieces[k]); c++)
      t[n++] = corner(&in->pieces[k], c);
  for (int k = 0; k < in->given_count; k++)
    for (int c = 0; c < in->given[k].f.count; c++)
      t[n++] = in->given[k].f.times[c];
  *count = clean(t, n, drive_end(in));
  return t;
}

double *drive_times(const drive_input *in, long *count) {
  const double end = drive_end(in);
  long n;
  double *corners = drive_corners(in, &n);
  double *t =
      must_realloc(corners, (size_t)(n + in->simulation.steps + in->expect_count + 1L) * sizeof *t);
  for (int k = 0; k <= in->simulation.steps; k++)
    t[n++] = end * k / in->simulation.steps;
  for (int k = 0; k < in->expect_count; k++) {
    const drive_expect *e = &in->expects[k];
    double at =
        isnan(e->at_stretch) ? e->at_time : drive_time_of_stretch(in, e->at_stretch, e->after);
    if (!isnan(at)) t[n++] = at;
  }
  *count = clean(t, n, end);
  return t;
}

/* The path between even steps and corners is smooth: signs change there once, and bisection finds
 * where. */
double drive_time_of_stretch(const drive_input *in, double stretch, double after) {
  drive_input plain = *in;
  long count;
  plain.expect_count = 0;
  double *t = drive_times(&plain, &count), found = NAN;
  for (long k = 0; k < count && isnan(found); k++) {
    double high = t[k], low = k ? pl_fmax(t[k - 1], after) : high;
    if (high < after) continue;
    double a = drive_at(in, DRIVE_STRETCH, low) - stretch,
           b = drive_at(in, DRIVE_STRETCH, high) - stretch;
    if (a == 0 || b == 0) found = a == 0 ? low : high;
    if (a * b >= 0) continue;
    for (int halving = 0; halving < 80; halving++) {
      double middle = 0.5 * (low + high), c = drive_at(in, DRIVE_STRETCH, middle) - stretch;
      if ((c > 0) == (a > 0))
        low = middle;
      else
        high = middle;
    }
    found = 0.5 * (low + high);
  }
  free(t);
  return found;
}
