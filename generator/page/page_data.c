#include "generator/page/page_data.h"

#include <math.h>
#include <stdlib.h>

#include "dsl/base/arena.h"
#include "generator/page/packing.h"

void page_put_packed(json *w, const char *name, packing *bytes) {
  char *text = packing_text(bytes);
  json_put_text(w, name, text);
  free(text);
  packing_free(bytes);
}

static long nearest_sample(const page_result *p, double time) {
  long low = 0, high = p->samples - 1;
  while (high - low > 1) {
    const long middle = (low + high) / 2;
    if (p->time[middle] <= time)
      low = middle;
    else
      high = middle;
  }
  return high >= 0 && fabs(p->time[high] - time) < fabs(p->time[low] - time) ? high : low;
}

/* The samples in which a series is least and largest. */
static void keep_extremes(const page_result *p, const double *values, bool *kept) {
  long least = -1, most = -1;
  for (long k = 0; k < p->samples; k++) {
    if (!isfinite(values[k])) continue;
    if (least < 0 || values[k] < values[least]) least = k;
    if (most < 0 || values[k] > values[most]) most = k;
  }
  if (least >= 0) kept[least] = kept[most] = true;
}

/* [samples] whether a sample is in the page. */
static bool *choose_samples(const page_result *p) {
  bool *kept = must_calloc((size_t)p->samples + 1, sizeof *kept);
  const long stride = 1 + (p->samples - 1) / PAGE_MOST_SAMPLES;
  for (long k = 0; k < p->samples; k += stride)
    kept[k] = true;
  if (p->samples > 0) kept[p->samples - 1] = true;
  for (int n = 0; n < p->series_count; n++)
    keep_extremes(p, p->series[n].values, kept);
  for (long n = 0; n < p->frames && p->samples > 0; n++)
    kept[nearest_sample(p, p->frame_times[n])] = true;
  return kept;
}

static void put_series(json *w, const char *name, const double *values, const bool *kept,
                       long samples) {
  packing bytes = {.bytes = NULL};
  for (long k = 0; k < samples; k++)
    if (kept[k]) packing_doubles(&bytes, &values[k], 1);
  page_put_packed(w, name, &bytes);
}

void page_put_histories(json *w, const page_result *p) {
  bool *kept = choose_samples(p);
  packing numbers = {.bytes = NULL};
  long last = 0;
  for (long k = 0; k < p->samples; k++) {
    if (!kept[k]) continue;
    packing_whole(&numbers, k - last);
    last = k;
  }
  json_put_text(w, "path", p->shown);
  json_put_integer(w, "sampled", p->samples);
  page_put_packed(w, "samples", &numbers);
  json_put_text(w, "timeName", page_time_name(p));
  put_series(w, "time", p->time, kept, p->samples);
  json_put_array(w, "series");
  for (int n = 0; n < p->series_count; n++) {
    json_object(w);
    json_put_text(w, "name", p->series[n].name);
    json_put_text(w, "shown", page_series_words(p->series[n].name));
    json_put_text(w, "unit", p->series[n].unit);
    put_series(w, "values", p->series[n].values, kept, p->samples);
    json_object_end(w);
  }
  json_array_end(w);
  free(kept);
}
