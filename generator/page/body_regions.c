#include "generator/page/body_regions.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "dsl/base/arena.h"
#include "generator/page/html.h"

/* --- particles -------------------------------------------------------------------------------- */

static long nearest(const double at[3], const double *places, long particles, int dimensions) {
  long found = -1;
  double least = INFINITY;
  for (long k = 0; k < particles; k++) {
    double square = 0;
    for (int c = 0; c < dimensions; c++)
      square += (places[dimensions * k + c] - at[c]) * (places[dimensions * k + c] - at[c]);
    if (square < least) {
      least = square;
      found = k;
    }
  }
  return found;
}

long *body_region_particles(const page_result *p, int region, const double *places, long particles,
                            int dimensions, double spacing, long *count) {
  const deck_region *r = &p->deck->regions[region];
  long *found = must_calloc((size_t)particles + 1, sizeof *found);
  *count = 0;
  if (r->shape.kind == SHAPE_POINT) {
    found[0] = nearest(r->shape.at, places, particles, dimensions);
    *count = found[0] >= 0;
    return found;
  }
  if (r->shape.members) { /* counted on a mesh or in a file */
    for (int k = 0; k < r->shape.member_count; k++)
      if (r->shape.members[k] >= 0 && r->shape.members[k] < particles)
        found[(*count)++] = r->shape.members[k];
    return found;
  }
  for (long k = 0; k < particles; k++)
    if (shape_contains(&r->shape, places + dimensions * k, 1e-3 * spacing)) found[(*count)++] = k;
  return found;
}

/* --- words ------------------------------------------------------------------------------------ */

typedef struct sentence {
  FILE *out;
  bool begun;
} sentence;

static void begin_phrase(sentence *s) {
  if (s->begun) fputs("; ", s->out);
  s->begun = true;
}

static bool is_there(const char *name, const char *region) {
  return name && strcmp(name, region) == 0;
}

static void say_held(sentence *s, const deck_support *k, int dimensions) {
  const int all = dimensions == 2 ? 3 : 6;
  bool first = true;
  begin_phrase(s);
  fputs("held along ", s->out);
  for (int c = 0; c < all; c++) {
    if (!(k->fix & 1 << c)) continue;
    if (!first) fputs(", ", s->out);
    fputs(deck_component_name(dimensions, c), s->out);
    first = false;
  }
}

/* "-20 mm/s", "a table", "a formula". */
static void say_function(FILE *out, const time_function *f, const char *si_unit) {
  static const char *const rises[] = {[TIME_RAMP] = ", rising on and on, each",
                                      [TIME_RAMP_HOLD] = ", rising in",
                                      [TIME_COSINE] = ", rising smoothly in"};
  if (f->shape == TIME_TABLE)
    fputs(" by a table", out);
  else if (f->shape == TIME_FORMULA)
    fputs(" by a formula", out);
  else {
    fputc(' ', out);
    html_put_quantity(out, f->value, si_unit);
  }
  if (f->shape == TIME_RAMP || f->shape == TIME_RAMP_HOLD || f->shape == TIME_COSINE) {
    fprintf(out, "%s ", rises[f->shape]);
    html_put_quantity(out, f->rise, "s");
  }
  if (f->start > 0) {
    fputs(", from t = ", out);
    html_put_quantity(out, f->start, "s");
  }
}

static void say_driven(sentence *s, const deck_drive *k, int dimensions) {
  const bool turns = k->component >= dimensions;
  begin_phrase(s);
  fprintf(s->out, "driven along %s, %s", deck_component_name(dimensions, k->component),
          k->is_displacement ? "displacement" : "velocity");
  say_function(s->out, &k->motion,
               k->is_displacement ? (turns ? "rad" : "m")
               : turns            ? "rad/s"
                                  : "m/s");
}

static void say_loaded(sentence *s, const deck_force *k, int dimensions) {
  const bool turns = k->component >= dimensions;
  begin_phrase(s);
  fprintf(s->out, "loaded along %s,", deck_component_name(dimensions, k->component));
  say_function(s->out, &k->force, k->per_length ? "N/m" : turns ? "N*m" : "N");
}

static void say_watched(sentence *s, const page_result *p, const char *name) {
  bool any = false;
  for (int n = 0; n < p->deck->monitor_count; n++) {
    const deck_monitor *m = &p->deck->monitors[n];
    if (!is_there(m->region, name) && !is_there(m->between[0], name) &&
        !is_there(m->between[1], name))
      continue;
    if (any)
      fputs(", ", s->out);
    else {
      begin_phrase(s);
      fputs("watched by ", s->out);
    }
    fputs("<code>", s->out);
    html_text(s->out, m->name);
    fputs("</code>", s->out);
    any = true;
  }
}

static void say_rest(sentence *s, const deck *k, const char *name) {
  for (int n = 0; n < k->end_moment_count; n++)
    if (is_there(k->end_moments[n].region, name)) {
      begin_phrase(s);
      fputs("turned by a moment,", s->out);
      say_function(s->out, &k->end_moments[n].moment, "N*m");
    }
  for (int n = 0; n < k->protect_count; n++)
    if (is_there(k->protects[n].region, name)) {
      begin_phrase(s);
      fputs("protected from damage", s->out);
    }
  for (int n = 0; n < k->point_mass_count; n++)
    if (is_there(k->point_masss[n].region, name)) {
      begin_phrase(s);
      fputs("carries a mass", s->out);
    }
  for (int n = 0; n < k->initial_velocity_count; n++)
    if (is_there(k->initial_velocitys[n].region, name)) {
      begin_phrase(s);
      fputs("moves at the beginning", s->out);
    }
}

void body_region_words(FILE *out, const page_result *p, int region, int dimensions) {
  const deck *k = p->deck;
  const char *name = k->regions[region].name;
  sentence s = {.out = out};
  if (!name) return;
  for (int n = 0; n < k->support_count; n++)
    if (is_there(k->supports[n].region, name)) say_held(&s, &k->supports[n], dimensions);
  for (int n = 0; n < k->drive_count; n++)
    if (is_there(k->drives[n].region, name)) say_driven(&s, &k->drives[n], dimensions);
  for (int n = 0; n < k->force_count; n++)
    if (is_there(k->forces[n].region, name)) say_loaded(&s, &k->forces[n], dimensions);
  say_rest(&s, k, name);
  say_watched(&s, p, name);
}
