#include "generator/page/movie.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "dsl/base/elementary.h"
#include "runtime/plot/canvas.h"
#include "runtime/result/mesh_views.h"
#include "runtime/result/result_find.h"

/* Characters of the frames in a page: as many as let it stay below 2 MB for 500 particles and below
   10 MB for 50 000. */
static double room_of(long particles) {
  return pl_fmin(5.5e6, pl_fmax(0.8e6, 110.0 * (double)particles));
}

static plot_map_options options_of(const char *field, const char *part, long frame) {
  return (plot_map_options){
      .frame = frame, .field = field, .part = part, .component = -1, .factor = 0, .slice_axis = -1};
}

/* --- which frames ----------------------------------------------------------------------------- */

static bool is_kept(const movie *m, long frame) {
  for (long k = 0; k < m->frame_count; k++)
    if (m->frames[k] == frame) return true;
  return false;
}

static int ascending(const void *a, const void *b) {
  const long p = *(const long *)a, q = *(const long *)b;
  return (p > q) - (p < q);
}

static long frame_near(const page_result *p, double time) {
  long nearest = 0;
  for (long k = 0; k < p->frames; k++)
    if (fabs(p->frame_times[k] - time) < fabs(p->frame_times[nearest] - time)) nearest = k;
  return nearest;
}

/* The first, the last, that at the peak, and others evenly between. */
static void choose_frames(movie *m, const page_result *p) {
  enum { LEAST = 4 };
  const double bytes = 4.0 / 3 * 4 * (double)m->particles;
  long most = (long)(0.6 * room_of(m->particles) / pl_fmax(bytes, 1));
  if (most < LEAST) most = LEAST;
  if (most > p->frames) most = p->frames;
  m->frames = must_calloc((size_t)most + 2, sizeof *m->frames);
  for (long k = 0; k < most; k++)
    m->frames[m->frame_count++] = most > 1 ? k * (p->frames - 1) / (most - 1) : p->frames - 1;
  const long peak = p->peak >= 0 ? frame_near(p, p->time[p->peak]) : 0;
  if (!is_kept(m, peak)) m->frames[m->frame_count++] = peak;
  qsort(m->frames, (size_t)m->frame_count, sizeof *m->frames, ascending);
}

/* --- places ----------------------------------------------------------------------------------- */

/* Of both coordinates, between the same ends: 2 bytes each. */
static void pack_places(packing *to, const double *at, long count, const double low[2],
                        const double high[2]) {
  for (long k = 0; k < count; k++)
    for (int c = 0; c < 2; c++)
      packing_steps(to, &at[2 * k + c], 1, low[c], high[c]);
}

static void find_extent(movie *m, const plot_frame *f) {
  for (int c = 0; c < 2; c++) {
    m->low[c] = INFINITY;
    m->high[c] = -INFINITY;
  }
  for (long p = 0; p < f->particles; p++)
    for (int c = 0; c < 2; c++) {
      m->low[c] = pl_fmin(m->low[c], f->reference[2 * p + c]);
      m->high[c] = pl_fmax(m->high[c], f->reference[2 * p + c]);
    }
}

static void pack_pairs(movie *m, const plot_frame *f) {
  long last = 0;
  for (long b = 0; b < m->bonds; b++) {
    packing_whole(&m->pairs, f->pairs[2 * b] - last);
    packing_whole(&m->pairs, (long)f->pairs[2 * b + 1] - f->pairs[2 * b]);
    last = f->pairs[2 * b];
  }
}

/* What stays the same in all frames. With a larger horizon bonds would hide each other. */
static void take_body(movie *m, const plot_frame *f) {
  enum { MOST_BONDS = 5 };
  m->particles = f->particles;
  m->bonds = f->bonds <= MOST_BONDS * f->particles ? f->bonds : 0;
  m->dimensions = f->dimensions;
  m->surface = f->surface;
  m->spacing = f->spacing;
  memcpy(m->axes, f->axes, sizeof m->axes);
  find_extent(m, f);
  pack_places(&m->places, f->reference, f->particles, m->low, m->high);
  pack_pairs(m, f);
  if (f->nodes) packing_runs(&m->nodes, f->nodes, NULL, f->particles);
}

/* In the plane of the picture; [particles][2], to be freed. */
static double *shown_displacements(const plot_frame *f) {
  double *u = must_calloc(2 * (size_t)f->particles + 1, sizeof *u);
  for (long p = 0; p < f->particles; p++)
    for (int c = 0; c < 2; c++)
      for (int k = 0; k < f->components; k++)
        u[2 * p + c] += f->components == 3 ? f->axes[k][c] * f->values[3 * p + k]
                        : k == c           ? f->values[f->components * p + k]
                                           : 0;
  return u;
}

static void take_displacements(movie *m, long frame, const double *u) {
  double low = 0, high = 0;
  for (long k = 0; k < 2 * m->particles; k++) {
    if (!isfinite(u[k])) continue;
    low = pl_fmin(low, u[k]);
    high = pl_fmax(high, u[k]);
  }
  m->range[frame][0] = low;
  m->range[frame][1] = high;
  packing_steps(&m->moved[frame], u, 2 * m->particles, low, high);
}

/* As maps choose theirs: the largest displacement against the mean is a twentieth of the body in
   the frame where it is largest. */
static double factor_for(const movie *m, const double *u) {
  double mean[2] = {0, 0}, largest = 0;
  for (long k = 0; k < 2 * m->particles; k++)
    mean[k % 2] += u[k] / (double)m->particles;
  for (long k = 0; k < 2 * m->particles; k++)
    largest = pl_fmax(largest, fabs(u[k] - mean[k % 2]));
  const double extent = pl_fmax(m->high[0] - m->low[0], m->high[1] - m->low[1]),
               raw = largest > 0 ? 0.05 * extent / largest : INFINITY;
  return raw < 1 ? 1 : pl_fmin(isfinite(raw) ? nice_step(raw, 1) : 1e4, 1e4);
}

static bool read_motion(movie *m, const page_result *p) {
  m->moved = must_calloc((size_t)m->frame_count + 1, sizeof *m->moved);
  m->range = must_calloc((size_t)m->frame_count + 1, sizeof *m->range);
  m->factor = 1e4;
  for (long k = 0; k < m->frame_count; k++) {
    const plot_map_options o = options_of("displacement", NULL, m->frames[k]);
    plot_frame f;
    const bool good = plot_frame_take(&f, p->file, p->path, &o, m->why, sizeof m->why) &&
                      f.particles == m->particles;
    double *u = good ? shown_displacements(&f) : NULL;
    if (good) {
      take_displacements(m, k, u);
      m->factor = pl_fmin(m->factor, factor_for(m, u));
      if (k == 0) movie_cells_begin(&m->cells, &f.meshes, m->frame_count);
      movie_cells_take(&m->cells, k, &f, u, m->low, m->high, m->range[k]);
    }
    free(u);
    plot_frame_free(&f);
    if (!good) return false;
  }
  return true;
}

/* --- fields ----------------------------------------------------------------------------------- */

typedef struct field_values { /* of all frames */
  double **values;            /* [frames] NULL: not read */
  long count;
  bool is_damage; /* of bonds, under the law's own name */
} field_values;

static void free_values(field_values *v, long frames) {
  for (long k = 0; k < frames; k++)
    free(v->values[k]);
  free(v->values);
}

static bool is_damage(const plot_frame *f) {
  if (!f->of_bonds || !f->damage || f->components != 1) return false;
  for (long b = 0; b < f->bonds; b++)
    if (!(f->values[b] == f->damage[b]) && !isnan(f->damage[b])) return false;
  return true;
}

/* Of one frame; false where the field is not shown. */
static bool read_field_of(movie *m, const page_result *p, long k, const char *field,
                          const char *part, movie_field *out, field_values *v) {
  const plot_map_options o = options_of(field, part, m->frames[k]);
  char none[512];
  plot_frame f;
  bool good = plot_frame_take(&f, p->file, p->path, &o, none, sizeof none);
  const bool damage_of_bonds = good && f.of_damage && !f.values;
  out->of_damage = good && f.of_damage;
  out->on = damage_of_bonds || (good && f.of_bonds) ? MOVIE_ON_BONDS : MOVIE_ON_PARTICLES;
  v->is_damage = v->is_damage && good && is_damage(&f);
  v->count = out->on == MOVIE_ON_BONDS ? f.bonds : f.particles;
  good = good && v->count == (out->on == MOVIE_ON_BONDS ? m->bonds : m->particles) && v->count > 0;
  if (good) {
    v->values[k] = must_calloc((size_t)v->count + 1, sizeof **v->values);
    for (long n = 0; n < v->count; n++)
      v->values[k][n] = damage_of_bonds ? f.damage[n] : plot_frame_value(&f, n, -1);
    snprintf(out->field, sizeof out->field, "%s", field);
    out->part = part;
    snprintf(out->name, sizeof out->name, "%s", out->of_damage ? "damage" : f.shown);
    snprintf(out->unit, sizeof out->unit, "%s",
             *f.unit_text && !out->of_damage ? f.unit_text : "1");
  }
  plot_frame_free(&f);
  return good;
}

static void find_range(const movie *m, const field_values *v, movie_field *out) {
  out->low = out->of_damage ? 0 : INFINITY;
  out->high = out->of_damage ? 1 : -INFINITY;
  for (long k = 0; k < m->frame_count && !out->of_damage; k++)
    for (long n = 0; n < v->count; n++)
      if (isfinite(v->values[k][n])) {
        out->low = pl_fmin(out->low, v->values[k][n]);
        out->high = pl_fmax(out->high, v->values[k][n]);
      }
}

/* Below 1, and be it little, is not separated. */
static unsigned char step_of(const movie_field *f, double value) {
  const unsigned char step = packing_step(value, f->low, f->high);
  return f->of_damage && value < 1 && step == 255 ? 254 : step;
}

/* Characters that they take. */
static double pack_field(const movie *m, const field_values *v, movie_field *out) {
  const size_t count = (size_t)v->count + 1;
  unsigned char *now = must_calloc(count, 1), *before = must_calloc(count, 1);
  double bytes = 0;
  out->steps = must_calloc((size_t)m->frame_count + 1, sizeof *out->steps);
  for (long k = 0; k < m->frame_count; k++) {
    for (long n = 0; n < v->count; n++)
      now[n] = step_of(out, v->values[k][n]);
    packing_runs(&out->steps[k], now, before, v->count);
    memcpy(before, now, count);
    bytes += 4.0 / 3 * (double)out->steps[k].count;
  }
  free(now);
  free(before);
  return bytes;
}

static void free_field(movie_field *f, long frames) {
  for (long k = 0; f->steps && k < frames; k++)
    packing_free(&f->steps[k]);
  free(f->steps);
  f->steps = NULL;
}

static bool is_there(const movie *m, const char *name) {
  for (int k = 0; k < m->field_count; k++)
    if (strcmp(m->fields[k].name, name) == 0) return true;
  return false;
}

/* Adds a field, as far as there is room. */
static void add_field(movie *m, const page_result *p, const char *field, const char *part,
                      double *room) {
  field_values v = {.values = must_calloc((size_t)m->frame_count + 1, sizeof *v.values),
                    .is_damage = true};
  movie_field *out = &m->fields[m->field_count];
  bool good = true;
  *out = (movie_field){.low = 0};
  for (long k = 0; k < m->frame_count && good; k++)
    good = read_field_of(m, p, k, field, part, out, &v);
  if (good) find_range(m, &v, out);
  good = good && out->low <= out->high && !is_there(m, out->name);
  const double bytes = good ? pack_field(m, &v, out) : 0;
  const size_t used = strlen(m->left_out);
  if (good && bytes > *room)
    snprintf(m->left_out + used, sizeof m->left_out - used, "%s%.100s", used ? ", " : "",
             out->name);
  if (good && bytes <= *room && !v.is_damage) {
    *room -= bytes;
    m->field_count++;
  } else
    free_field(out, m->frame_count);
  free_values(&v, m->frame_count);
}

/* "stress" for "stress_xx", where the largest principal value is shown besides the components. */
static bool is_first_component(const char *field, char tensor[128]) {
  const size_t length = strlen(field);
  if (length < 4 || length > 120 || strcmp(field + length - 3, "_xx") != 0) return false;
  memcpy(tensor, field, length - 3);
  tensor[length - 3] = 0;
  return true;
}

static size_t cells_bytes(const movie_cells *c, long k) {
  return c->count ? c->alive[k].count + c->parts[k].count + c->faces[k].count : 0;
}

static void read_fields(movie *m, const page_result *p) {
  double room = room_of(m->particles);
  for (long k = 0; k < m->frame_count; k++)
    room -= 4.0 / 3 * (double)(m->moved[k].count + cells_bytes(&m->cells, k));
  result_names names = result_members(p->file, "/frames");
  char tensor[128];
  add_field(m, p, "damage", NULL, &room);
  add_field(m, p, "displacement", NULL, &room);
  for (int k = 0; k < names.count; k++) {
    const char *name = names.items[k];
    if (m->field_count + 2 >= MOVIE_MOST_FIELDS || strcmp(name, MESH_DEAD_CELLS) == 0) continue;
    if (is_first_component(name, tensor)) add_field(m, p, tensor, "principal", &room);
    add_field(m, p, name, NULL, &room);
  }
  result_names_free(&names);
}

/* --- the whole -------------------------------------------------------------------------------- */

static bool read_body(movie *m, const page_result *p) {
  const plot_map_options damage = options_of("damage", NULL, 0),
                         motion = options_of("displacement", NULL, 0);
  plot_frame f;
  bool good = plot_frame_take(&f, p->file, p->path, &damage, m->why, sizeof m->why);
  if (!good) {
    plot_frame_free(&f);
    good = plot_frame_take(&f, p->file, p->path, &motion, m->why, sizeof m->why);
  }
  if (good) take_body(m, &f);
  plot_frame_free(&f);
  return good;
}

bool movie_read(movie *m, const page_result *p) {
  *m = (movie){.frame_count = 0};
  if (p->frames == 0) {
    snprintf(m->why, sizeof m->why, "the result holds no frames");
    return false;
  }
  if (!read_body(m, p)) return false;
  choose_frames(m, p);
  if (!read_motion(m, p)) return false;
  read_fields(m, p);
  *m->why = 0;
  return true;
}

void movie_free(movie *m) {
  for (int k = 0; k < m->field_count; k++)
    free_field(&m->fields[k], m->frame_count);
  for (long k = 0; m->moved && k < m->frame_count; k++)
    packing_free(&m->moved[k]);
  movie_cells_free(&m->cells);
  packing_free(&m->places);
  packing_free(&m->pairs);
  packing_free(&m->nodes);
  free(m->moved);
  free(m->range);
  free(m->frames);
}
