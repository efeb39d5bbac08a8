#include "generator/page/page_frames.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "dsl/base/arena.h"
#include "dsl/base/elementary.h"
#include "dsl/base/units.h"
#include "generator/kernel/model.h"
#include "generator/page/html.h"
#include "generator/page/page_data.h"
#include "runtime/base/whole_file.h"
#include "runtime/plot/canvas.h"
#include "runtime/plot/colour_scale.h"
#include "runtime/plot/damage_classes.h"
#include "runtime/plot/plot_map.h"

/* --- numbers ---------------------------------------------------------------------------------- */

static void put_list(json *w, const char *name, packing *items, long count) {
  json_put_array(w, name);
  for (long k = 0; k < count; k++) {
    char *text = packing_text(&items[k]);
    json_text(w, text);
    free(text);
  }
  json_array_end(w);
}

static void put_packed(json *w, const char *name, const packing *bytes) {
  char *text = packing_text(bytes);
  json_put_text(w, name, text);
  free(text);
}

static void put_pair(json *w, const char *name, double first, double second) {
  json_put_array(w, name);
  json_number(w, first);
  json_number(w, second);
  json_array_end(w);
}

static void put_moments(json *w, const page_result *p, const movie *m) {
  char text[PAGE_MOMENT];
  json_put_array(w, "times");
  for (long k = 0; k < m->frame_count; k++)
    json_number(w, p->frame_times[m->frames[k]]);
  json_array_end(w);
  json_put_array(w, "numbers");
  for (long k = 0; k < m->frame_count; k++)
    json_integer(w, m->frames[k]);
  json_array_end(w);
  json_put_array(w, "moments");
  for (long k = 0; k < m->frame_count; k++)
    json_text(w, page_moment(p, p->frame_times[m->frames[k]], text));
  json_array_end(w);
}

static void put_field(json *w, const movie *m, const movie_field *f) {
  double factor;
  const char *shown = readable_unit(f->unit, pl_fmax(fabs(f->low), fabs(f->high)), &factor);
  json_object(w);
  json_put_text(w, "name", f->name);
  json_put_text(w, "unit", unit_is_pure(shown) ? "" : shown);
  json_put_text(w, "on", f->on == MOVIE_ON_BONDS ? "bonds" : "particles");
  json_put_bool(w, "damage", f->of_damage);
  put_pair(w, "range", f->low * factor, f->high * factor);
  put_list(w, "steps", f->steps, m->frame_count);
  json_object_end(w);
}

static void put_cells(json *w, const movie_cells *c) {
  json_put_integer(w, "cellCount", c->count);
  if (c->count == 0) return;
  put_packed(w, "cells", &c->listed);
  put_list(w, "alive", c->alive, c->frames);
  put_list(w, "parts", c->parts, c->frames);
  put_list(w, "faces", c->faces, c->frames);
}

void page_put_frames(json *w, const page_result *p, const movie *m) {
  if (*m->why || m->frame_count == 0) {
    json_key(w, "frames");
    json_null(w);
    return;
  }
  json_put_object(w, "frames");
  json_put_integer(w, "last", p->frames - 1);
  json_put_integer(w, "particles", m->particles);
  json_put_integer(w, "bonds", m->bonds);
  json_put_bool(w, "surface", m->surface);
  json_put_number(w, "spacing", m->spacing);
  json_put_number(w, "factor", m->factor);
  put_pair(w, "low", m->low[0], m->low[1]);
  put_pair(w, "high", m->high[0], m->high[1]);
  put_moments(w, p, m);
  put_packed(w, "places", &m->places);
  put_packed(w, "pairs", &m->pairs);
  put_packed(w, "nodes", &m->nodes);
  put_list(w, "moved", m->moved, m->frame_count);
  json_put_array(w, "ranges");
  for (long k = 0; k < m->frame_count; k++) {
    json_number(w, m->range[k][0]);
    json_number(w, m->range[k][1]);
  }
  json_array_end(w);
  put_cells(w, &m->cells);
  json_put_array(w, "fields");
  for (int k = 0; k < m->field_count; k++)
    put_field(w, m, &m->fields[k]);
  json_array_end(w);
  json_object_end(w);
}

static void put_colour(json *w, colour k) {
  char text[16];
  snprintf(text, sizeof text, "#%02lx%02lx%02lx", lround(255 * k.r), lround(255 * k.g),
           lround(255 * k.b));
  json_text(w, text);
}

void page_put_colours(json *w) {
  json_put_array(w, "scale");
  for (int k = 0; k < SCALE_STEPS; k++)
    put_colour(w, scale_colour((k + 0.5) / SCALE_STEPS));
  json_array_end(w);
  json_put_array(w, "classes");
  for (int k = 0; k < DAMAGE_CLASSES; k++) {
    json_object(w);
    json_put_number(w, "upTo", damage_classes[k].up_to);
    json_put_text(w, "text", damage_classes[k].text);
    json_key(w, "ink");
    put_colour(w, damage_classes[k].ink);
    json_object_end(w);
  }
  json_array_end(w);
}

/* --- pictures --------------------------------------------------------------------------------- */

enum { STILLS = 4, MANY = 20000 };
#define PICTURE_LIMIT ((size_t)16 << 20) /* B */

/* The one nearest to the peak, the last, and two between; all, where there are no more. */
static int choose_stills(const page_result *p, const movie *m, long frames[STILLS]) {
  const long count = m->frame_count;
  int chosen = 0;
  long peak = 0;
  for (long k = 0; k < count && p->peak >= 0; k++)
    if (fabs(p->frame_times[m->frames[k]] - p->time[p->peak]) <
        fabs(p->frame_times[m->frames[peak]] - p->time[p->peak]))
      peak = k;
  if (count - peak < STILLS) peak = count > STILLS ? count - STILLS : 0;
  for (int k = 0; k < STILLS; k++) {
    const long frame = m->frames[peak + k * (count - 1 - peak) / (STILLS - 1)];
    if (chosen == 0 || frames[chosen - 1] != frame) frames[chosen++] = frame;
  }
  return chosen;
}

/* Bytes that pictures may take, so that pages stay small. */
static size_t picture_room(const movie *m) {
  return (size_t)pl_fmin(2.6e6, pl_fmax(0.65e6, 52.0 * (double)m->particles));
}

/* `count` frames into a file, and its bytes; malloc'ed, NULL with a sentence. */
static char *draw_frames(const page_result *p, const movie *m, const char *path, long *frames,
                         int count, size_t *length, char *error, size_t size) {
  const movie_field *f = m->field_count ? &m->fields[0] : NULL;
  const plot_map_options o = {.output = path,
                              .frame = -1,
                              .field = f ? f->field : "displacement",
                              .part = f ? f->part : NULL,
                              .component = -1,
                              .factor = -1,
                              .slice_axis = -1,
                              .frames = frames,
                              .frame_count = count};
  if (!plot_map(p->path, &o, error, size)) return NULL;
  return read_text_file(path, PICTURE_LIMIT, length, error, size);
}

/* Four frames in one picture, or as many as there is room for: the last ones, one at least. */
static char *draw_stills(const page_result *p, const movie *m, size_t *length, char *error,
                         size_t size) {
  long frames[STILLS];
  const char *folder = getenv("TMPDIR");
  char path[WHOLE_FILE_PATH], *picture = NULL;
  snprintf(path, sizeof path, "%.3900s/perilat_report_XXXXXX.png",
           folder && *folder ? folder : "/tmp");
  const int handle = mkstemps(path, 4);
  if (handle < 0) {
    snprintf(error, size, "there is no room for pictures in `%.500s`", path);
    return NULL;
  }
  close(handle);
  const int all = choose_stills(p, m, frames);
  const bool many = m->particles > MANY && all > STILLS / 2; /* each takes a second, and room */
  for (int count = many ? STILLS / 2 : all; count > 0; count /= 2) {
    free(picture);
    picture = draw_frames(p, m, path, frames + all - count, count, length, error, size);
    if (!picture || *length <= picture_room(m)) break;
  }
  unlink(path);
  return picture;
}

static void put_stills(FILE *out, const page_result *p, const movie *m) {
  char error[1024] = "";
  size_t length = 0;
  char *picture = draw_stills(p, m, &length, error, sizeof error);
  fputs("<noscript>", out);
  if (picture) {
    char *code = packing_base64(picture, length);
    fprintf(out,
            "<img class=\"still\" alt=\"frames of the run\" src=\"data:image/png;base64,%s\"/>",
            code);
    free(code);
  } else
    html_print(out, "No pictures: %s.", error);
  fputs("</noscript>\n", out);
  free(picture);
}

/* --- the section ------------------------------------------------------------------------------ */

void page_frames(FILE *out, const page_result *p, const movie *m) {
  if (*m->why || m->frame_count == 0) {
    fputs("<p>", out);
    html_print(out, "No frame is shown: %s.", m->why);
    fputs("</p>\n", out);
    return;
  }
  fprintf(out, "<div class=\"movie\" data-of=\"%s\">", p->key);
  put_stills(out, p, m);
  fputs("</div>\n<p class=\"quiet\">", out);
  if (m->frame_count < p->frames)
    html_print(out, "%ld of %ld frames are in this page. ", m->frame_count, p->frames);
  if (*m->left_out) html_print(out, "Left out for their size: %s.", m->left_out);
  fputs("</p>\n", out);
}
