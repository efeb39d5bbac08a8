#include "generator/results/frame_choice.h"

#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "dsl/base/arena.h"
#include "dsl/base/elementary.h"
#include "dsl/base/units.h"
#include "generator/kernel/document.h"
#include "runtime/base/quantity.h"
#include "runtime/plot/canvas.h"
#include "runtime/plot/plot_curve.h"
#include "runtime/plot/plot_map.h"
#include "runtime/result/result_file.h"
#include "runtime/result/result_read.h"

enum { VALUE_TEXT = 64, CAPTION_TEXT = 128 };

static bool refuse(const char *given) {
  say_error("--frames needs numbers, e.g. 0,5,-1, or values of a history, e.g. cmod=0.1mm,0.2mm, "
            "not `%s`",
            given);
  return false;
}

/* --- by number -------------------------------------------------------------------------------- */

static bool read_numbers(frame_choice *c, const char *given) {
  const char *p = given;
  for (int k = 0; k < c->count; k++) {
    char *end;
    errno = 0;
    c->frames[k] = strtol(p, &end, 10);
    end += strspn(end, " ");
    if (end == p || errno || *end != (k + 1 < c->count ? ',' : 0)) return refuse(given);
    p = end + 1;
  }
  return true;
}

/* --- by a history ----------------------------------------------------------------------------- */

typedef struct seeker {
  const char *result, *name; /* of the history */
  plot_histories h;          /* over time */
  double *times, *at_frames; /* [frames] of the frames, and the history there */
  long frames;
  double factor; /* of shown values */
  const char *unit_text;
} seeker;

static const char *shown(const seeker *s, double value, char text[VALUE_TEXT]) {
  const bool pure = unit_is_pure(s->unit_text);
  snprintf(text, VALUE_TEXT, "%.4g%s%.30s", value * s->factor + 0.0, pure ? "" : " ",
           pure ? "" : s->unit_text);
  return text;
}

static double history_at(const plot_histories *h, double time) {
  long k = 0;
  while (k + 1 < h->count && h->x[k + 1] < time)
    k++;
  if (k + 1 >= h->count || time <= h->x[k]) return h->y[k];
  const double part = (time - h->x[k]) / (h->x[k + 1] - h->x[k]);
  return part >= 1 ? h->y[k + 1] : h->y[k] + part * (h->y[k + 1] - h->y[k]);
}

static void choose_unit(seeker *s) {
  double most = 0;
  for (long k = 0; k < s->h.count; k++)
    if (isfinite(s->h.y[k])) most = pl_fmax(most, fabs(s->h.y[k]));
  s->unit_text = readable_unit(s->h.y_unit, most, &s->factor);
}

static bool begin(seeker *s, char *error, size_t size) {
  if (!plot_histories_read(&s->h, s->result, "time", s->name, error, size)) return false;
  result_file *f = result_read(s->result, error, size);
  if (!f) return false;
  s->times = result_read_frame_times(f, &s->frames);
  result_read_close(f);
  if (!s->times || s->frames == 0 || s->h.count == 0) {
    snprintf(error, size, "`%s` has no frames or no samples", s->result);
    return false;
  }
  s->at_frames = must_alloc((size_t)s->frames * sizeof *s->at_frames);
  for (long k = 0; k < s->frames; k++)
    s->at_frames[k] = history_at(&s->h, s->times[k]);
  choose_unit(s);
  return true;
}

static void end(seeker *s) {
  free(s->h.x);
  free(s->h.y);
  free(s->times);
  free(s->at_frames);
}

/* When the history first takes the value; NaN when never, and then *nearest is how near it came. */
static double first_time(const plot_histories *h, double value, double *nearest) {
  *nearest = NAN;
  for (long k = 0; k < h->count; k++) {
    const double here = h->y[k] - value, before = k ? h->y[k - 1] - value : here;
    if (!isfinite(here)) continue;
    if (here == 0) return h->x[k];
    if (before * here < 0) return h->x[k - 1] + before / (before - here) * (h->x[k] - h->x[k - 1]);
    if (!(fabs(here) >= fabs(*nearest - value))) *nearest = h->y[k];
  }
  return NAN;
}

/* Of the frames before and after a time, that nearer in the history. */
static long nearest_frame(const seeker *s, double time, double value) {
  long after = 0;
  while (after + 1 < s->frames && s->times[after] < time)
    after++;
  const long before = after > 0 ? after - 1 : 0;
  return fabs(s->at_frames[before] - value) <= fabs(s->at_frames[after] - value) ? before : after;
}

/* Half of what lies between the frame and its farther neighbour: what is beyond, another frame
   should have had. */
static double reach_of(const seeker *s, long frame) {
  const double here = s->at_frames[frame];
  const double before = frame > 0 ? fabs(here - s->at_frames[frame - 1]) : 0,
               after = frame + 1 < s->frames ? fabs(here - s->at_frames[frame + 1]) : 0;
  return pl_fmax(before, after) / 2;
}

static bool seek(const seeker *s, double value, long *frame, char caption[CAPTION_TEXT]) {
  char wanted[VALUE_TEXT], there[VALUE_TEXT], missed[VALUE_TEXT];
  double nearest;
  const double time = first_time(&s->h, value, &nearest);
  shown(s, value, wanted);
  if (isnan(time)) {
    say_error("`%s` never is %s: it comes as near as %s", s->name, wanted,
              shown(s, nearest, there));
    return false;
  }
  *frame = nearest_frame(s, time, value);
  const double miss = fabs(s->at_frames[*frame] - value);
  snprintf(caption, CAPTION_TEXT, "%.40s = %s", s->name, shown(s, s->at_frames[*frame], there));
  if (miss > reach_of(s, *frame) * (1 + 1e-9))
    fprintf(stderr,
            "perilat: warning: no frame is near `%s` = %s: the nearest, %ld, has %s and misses it "
            "by %s\n",
            s->name, wanted, *frame, there, shown(s, miss, missed));
  return true;
}

static bool read_values(frame_choice *c, const char *given, const char *values, seeker *s) {
  const char *p = values;
  for (int k = 0; k < c->count; k++) {
    double value;
    char caption[CAPTION_TEXT] = "";
    const size_t length = strcspn(p, ",");
    if (!quantity_read(p, length, s->h.y_unit, &value)) {
      say_error("`%s` is in %s; --frames %s: `%.*s` is no value of it", s->name, s->h.y_unit, given,
                (int)length, p);
      return false;
    }
    if (!seek(s, value, &c->frames[k], caption)) return false;
    c->captions[k] = must_copy(caption);
    p += length + 1;
  }
  return true;
}

static bool read_history(frame_choice *c, const char *path, const char *given, const char *equals) {
  char error[1024] = "", name[256];
  snprintf(name, sizeof name, "%.*s", (int)(equals - given), given);
  seeker s = {.result = path, .name = name};
  c->captions = must_calloc((size_t)c->count, sizeof *c->captions);
  bool good = begin(&s, error, sizeof error);
  if (!good) say_error("%s", error);
  good = good && read_values(c, given, equals + 1, &s);
  end(&s);
  return good;
}

/* --- both ------------------------------------------------------------------------------------- */

bool frame_choice_read(frame_choice *c, const char *path, const char *given) {
  const char *equals = strchr(given, '=');
  *c = (frame_choice){.count = 1};
  for (const char *p = given; *p; p++)
    c->count += *p == ',';
  if (c->count > PLOT_MOST_PANELS) {
    say_error("--frames has %d frames; one picture shows %d at most", c->count, PLOT_MOST_PANELS);
    return false;
  }
  c->frames = must_calloc((size_t)c->count, sizeof *c->frames);
  return equals ? read_history(c, path, given, equals) : read_numbers(c, given);
}

void frame_choice_free(frame_choice *c) {
  for (int k = 0; c->captions && k < c->count; k++)
    free(c->captions[k]);
  free(c->captions);
  free(c->frames);
}
