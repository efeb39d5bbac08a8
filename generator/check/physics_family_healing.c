/* A plain state that takes force from a body of families as a damage does, and gives it back. */
#include "generator/check/physics_family_healing.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "dsl/base/arena.h"
#include "dsl/base/elementary.h"
#include "generator/ir/random_values.h"

static const double FACTOR_TOLERANCE = 1e-6; /* of a factor of the forces, at two sizes of motion */
static const double LEAST_LOSS = 1e-3;       /* of the forces that a state must take to count */
static const double LEAST_RETURN = 1e-9;     /* of a state and of the forces that come back */

static double product(const double *x, const double *y, long count) {
  double sum = 0;
  for (long k = 0; k < count; k++)
    sum += x[k] * y[k];
  return sum;
}

static const symbol *field_symbol(const family_bench *b, int field) {
  return b->law->fields.items[field];
}

/* The same everywhere. */
static void set_field(family_bench *b, int field, double value) {
  patch *p = b->whole;
  for (long k = 0; k < patch_planes(p, &p->law->fields[field]); k++)
    for (long q = 0; q < p->inside_count; q++)
      p->field[field][k * p->size + p->inside[q]] = value;
  family_bench_share_fields(b);
}

/* --- states that are factors of the forces ---------------------------------------------------- */

enum { LEVELS = 8, LOOKS = 6 };

/* How far a state is from its initial value: 0, then over six decades, for it may count openings or
   shares. */
static double level_at(int k) {
  return k == 0 ? 0 : k == LEVELS - 1 ? 1 : k == LEVELS - 2 ? 0.5 : pl_pow(10, k - 7);
}

typedef enum answer { NOTHING, WEAKENS, NO_FACTOR } answer;

typedef struct healing {
  int field, way; /* 1 or -1: from its initial value in which it weakens the body */
  double began;   /* of the field */
  bool moved;     /* the field left it */
  double strain;
  double *corner, *u, *v, *force, *other; /* [values] */
} healing;

/* The factor that a level of the field puts before the forces without it; NaN where it is none. */
static double factor_of(family_bench *b, const healing *h, const double *u, double level) {
  const double initial = field_symbol(b, h->field)->initial;
  double *whole = h->force, *less = h->other;
  family_bench_move(b, u, NULL);
  set_field(b, h->field, initial);
  family_bench_forces(b, b->frozen, whole);
  set_field(b, h->field, initial + h->way * level);
  family_bench_forces(b, b->frozen, less);
  const double size = product(whole, whole, b->values);
  if (size == 0) return 1;
  const double factor = product(whole, less, b->values) / size;
  double left = 0;
  for (long k = 0; k < b->values; k++)
    left += (less[k] - factor * whole[k]) * (less[k] - factor * whole[k]);
  return left <= FACTOR_TOLERANCE * FACTOR_TOLERANCE * size ? factor : NAN;
}

/* Whether the levels multiply all forces by ever smaller factors, the same at a motion and half of
   it. */
static answer factors_of(family_bench *b, healing *h) {
  answer found = NOTHING;
  double before = 1;
  for (long k = 0; k < b->values; k++)
    h->u[k] = 0.5 * h->corner[k];
  for (int k = 1; k < LEVELS; k++) {
    const double factor = factor_of(b, h, h->corner, level_at(k));
    const bool same = fabs(factor - factor_of(b, h, h->u, level_at(k))) <= FACTOR_TOLERANCE;
    if (!same || !(factor >= -FACTOR_TOLERANCE && factor <= before + FACTOR_TOLERANCE))
      return NO_FACTOR;
    if (factor < 1 - LEAST_LOSS) found = WEAKENS;
    before = factor;
  }
  return found;
}

/* False: it does not scale the forces. Strains are small: geometry is no factor. */
static bool find_way(family_bench *b, healing *h) {
  for (h->way = 1; h->way >= -1; h->way -= 2) {
    answer all = NOTHING;
    for (int look = 0; look < LOOKS && all != NO_FACTOR; look++) {
      family_bench_draw(b, look == 0);
      family_bench_deform(b, 1e-7, h->corner);
      const answer one = factors_of(b, h);
      all = one != NOTHING ? one : all;
    }
    if (all == WEAKENS) return true;
  }
  return false;
}

/* --- there and back --------------------------------------------------------------------------- */

enum { TOURS = 6, STEPS = 12 };

static double force_size(family_bench *b, const double *u, double sign, healing *h) {
  for (long k = 0; k < b->values; k++)
    h->v[k] = sign * u[k];
  family_bench_move(b, h->v, NULL);
  family_bench_forces(b, b->frozen, h->other);
  return sqrt(product(h->other, h->other, b->values));
}

/* True when the body is stronger with the new value at one place, drawn out or pushed together. */
static bool is_stronger(family_bench *b, healing *h, double *at, double now) {
  const double old = *at;
  bool stronger = false;
  for (int sign = 1; sign >= -1 && !stronger; sign -= 2) {
    *at = old;
    const double before = force_size(b, h->u, sign, h);
    *at = now;
    stronger = force_size(b, h->u, sign, h) > (1 + LEAST_RETURN) * before;
  }
  *at = old;
  return stronger;
}

static void say_healing(family_bench *b, const healing *h, double before, double now) {
  const symbol *s = field_symbol(b, h->field);
  family_bench_say(b, DIAG_HEALING, s->rule ? s->rule->where : s->declared->where, h->strain,
                   "state `%s` acts as a damage does, but goes back, here from %.6g to %.6g: the "
                   "body heals",
                   s->name, before, now);
  const char *most = h->way > 0 ? "max" : "min";
  diag_hint(b->said,
            "keep what it was, `%s = %s(%s, ...)`%s; if healing is meant, say "
            "`nonconservative \"why\"`",
            s->name, most, s->name,
            h->way > 0 ? ", or write a `damage`, which never decreases" : "");
}

/* After the step of the whole law, before its new fields are taken over. */
static void look_at_step(family_bench *b, healing *h) {
  const double initial = field_symbol(b, h->field)->initial;
  const patch *p = b->whole;
  for (long k = 0; k < patch_planes(p, &p->law->fields[h->field]); k++)
    for (long q = 0; q < p->inside_count && !b->failed[DIAG_HEALING]; q++) {
      const long at = k * p->size + p->inside[q];
      if (k > 0 && !patch_has_bond(p, p->inside[q], (int)k)) continue;
      const double before = p->field[h->field][at], now = p->new_field[h->field][at];
      const double back = (before - now) * h->way, size = pl_fmax(fabs(before), fabs(now));
      h->moved = h->moved || before != now;
      if (!((before - initial) * h->way > 0) || !(back > LEAST_RETURN * size)) continue;
      family_bench_share_fields(b);
      if (is_stronger(b, h, &b->frozen->field[h->field][at], now)) say_healing(b, h, before, now);
    }
}

/* From rest to a corner and back, twice. */
static void go_tour(family_bench *b, healing *h) {
  double *rate = family_bench_values(b);
  h->strain = pl_pow(10, draw_uniform(&b->seed, -5, -0.7));
  const double speed = pl_pow(10, draw_uniform(&b->seed, -3, 4));
  family_bench_deform(b, h->strain, h->corner);
  for (int leg = 0; leg < 4; leg++)
    for (int step = 1; step <= STEPS && !b->failed[DIAG_HEALING]; step++) {
      const double part = (double)step / STEPS, way = leg % 2 ? 1 - part : part;
      for (long k = 0; k < b->values; k++) {
        h->u[k] = way * h->corner[k];
        rate[k] = (leg % 2 ? -speed : speed) * h->corner[k];
      }
      family_bench_move(b, h->u, rate);
      family_bench_forces(b, b->whole, h->force);
      look_at_step(b, h);
      family_bench_accept(b);
    }
  free(rate);
}

static void go_tours(family_bench *b, healing *h) {
  for (int k = 0; k < TOURS && !b->failed[DIAG_HEALING]; k++) {
    family_bench_draw(b, k == 0);
    set_field(b, h->field, h->began);
    go_tour(b, h);
  }
}

/* A state that no motion moves is looked at half way to a factor of its own accord. */
static void check_field(family_bench *b, healing *h) {
  h->began = field_symbol(b, h->field)->initial;
  h->moved = false;
  go_tours(b, h);
  if (h->moved) return;
  h->began += 0.5 * h->way;
  go_tours(b, h);
}

void family_check_healing(family_bench *b) {
  if (b->law->nonconservative) return;
  healing h = {.corner = family_bench_values(b),
               .u = family_bench_values(b),
               .v = family_bench_values(b),
               .force = family_bench_values(b),
               .other = family_bench_values(b)};
  for (h.field = 0; h.field < b->law->fields.count && !b->failed[DIAG_HEALING]; h.field++)
    if (field_symbol(b, h.field)->kind == SYMBOL_STATE && find_way(b, &h)) check_field(b, &h);
  double *all[] = {h.corner, h.u, h.v, h.force, h.other};
  for (size_t k = 0; k < sizeof all / sizeof *all; k++)
    free(all[k]);
}
