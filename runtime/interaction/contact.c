#include "runtime/interaction/contact.h"

#include <assert.h>
#include <float.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "dsl/base/arena.h"
#include "dsl/base/elementary.h"
#include "runtime/geometry/bins.h"

static const double skin_part = 0.3; /* of the smallest spacing: what the list reaches further */
enum { CHUNK = 1024 /* sites of which losses are counted together */ };

typedef struct contact_side {
  contact_body from;
  int32_t first;     /* number of its first particle */
  double *listed[3]; /* [size] displacements when the list was found */
  /* [directions * size] m: distance at which a bond was lost, 0: it was not. NULL: bonds stay, or
     press on when they have failed. */
  double *lost;
  int32_t *broken; /* [laws][directions][chunks] bonds known to be lost */
  long chunks;
} contact_side;

typedef struct near_pair {
  int32_t i, j; /* i < j */
  double d, k;  /* m, N/m */
} near_pair;

typedef struct touch { /* of a pair, found last */
  int32_t i, j;
  double force[3]; /* N, on j */
} touch;

struct contact {
  contact_side *sides; /* [count] */
  int count, dimensions;
  bool selves;
  bool late;          /* bonds were lost nobody knows where */
  double skin, reach; /* m: reach of the list for the largest spacing */
  double ahead;       /* m */
  bool near;          /* in the state found last */
  /* Of each particle, all bodies counted through: */
  long particles;
  int32_t *side, *site;
  double *at[3]; /* m: where it was when the list was found */
  bins boxes;
  bool known; /* the list is */
  near_pair *pairs;
  long pair_count, pair_room;
  touch *touching;
  long touch_count, touch_room;
  near_pair *fresh; /* pairs whose bond was lost in this step */
  long fresh_count, fresh_room;
  double stored, largest; /* J; N, of a pair */
};

/* --- set-up ----------------------------------------------------------------------------------- */

static const rows *rows_of(const contact_side *s) {
  return s->from.of->lattice;
}

static void new_side(contact *c, contact_side *s, const contact_body *from) {
  const rows *g = from->of->lattice;
  *s = (contact_side){.from = *from, .first = (int32_t)c->particles};
  for (int d = 0; d < g->dimensions; d++)
    s->listed[d] = must_calloc((size_t)g->size, sizeof(double));
  s->chunks = (g->size + CHUNK - 1) / CHUNK;
  c->particles += g->particle_count;
  if (!c->selves || from->law_count == 0) return;
  s->lost = must_calloc((size_t)g->directions * (size_t)g->size, sizeof *s->lost);
  s->broken = must_calloc((size_t)from->law_count * (size_t)g->directions * (size_t)s->chunks,
                          sizeof *s->broken);
}

static void number_particles(contact *c) {
  long p = 0;
  c->side = must_alloc(((size_t)c->particles + 1) * sizeof *c->side);
  c->site = must_alloc(((size_t)c->particles + 1) * sizeof *c->site);
  for (int d = 0; d < c->dimensions; d++)
    c->at[d] = must_alloc(((size_t)c->particles + 1) * sizeof(double));
  for (int b = 0; b < c->count; b++) {
    const rows *g = rows_of(&c->sides[b]);
    for (long n = 0; n < g->particle_count; n++, p++) {
      c->side[p] = b;
      c->site[p] = g->particle_site[n];
    }
  }
}

contact *contact_new(const contact_body *bodies, int count, bool selves) {
  contact *c = must_calloc(1, sizeof *c);
  double least = INFINITY, most = 0;
  c->count = count;
  c->selves = selves || count == 1;
  c->dimensions = bodies[0].of->dimensions;
  c->sides = must_calloc((size_t)count, sizeof *c->sides);
  for (int b = 0; b < count; b++) {
    new_side(c, &c->sides[b], &bodies[b]);
    least = pl_fmin(least, bodies[b].of->lattice->spacing);
    most = pl_fmax(most, rows_largest_spacing(bodies[b].of->lattice));
  }
  c->skin = skin_part * least;
  c->reach = most + c->skin;
  number_particles(c);
  return c;
}

void contact_free(contact *c) {
  if (!c) return;
  for (int b = 0; b < c->count; b++) {
    contact_side *s = &c->sides[b];
    for (int d = 0; d < c->dimensions; d++)
      free(s->listed[d]);
    free(s->from.laws);
    free(s->lost);
    free(s->broken);
  }
  for (int d = 0; d < c->dimensions; d++)
    free(c->at[d]);
  bins_end(&c->boxes);
  free(c->sides);
  free(c->side);
  free(c->site);
  free(c->pairs);
  free(c->touching);
  free(c->fresh);
  free(c);
}

void contact_look_ahead(contact *c, double part) {
  assert(part < CONTACT_MOST_AHEAD);
  c->ahead = part / skin_part * c->skin;
}

static void make_room(void **items, long *room, long count, size_t each) {
  if (count <= *room) return;
  *room = 2 * count + 64;
  *items = must_realloc(*items, (size_t)*room * each);
}

/* --- places ----------------------------------------------------------------------------------- */

/* From i to j; returns the distance. */
static inline double chord_of(const contact *c, int32_t i, int32_t j, double chord[3]) {
  const body *a = c->sides[c->side[i]].from.of, *b = c->sides[c->side[j]].from.of;
  const long p = c->site[i], q = c->site[j];
  double from[3], to[3], square = 0;
  rows_place(a->lattice, p, from);
  rows_place(b->lattice, q, to);
  for (int d = 0; d < c->dimensions; d++) {
    chord[d] = (to[d] + b->displacement[d][q]) - (from[d] + a->displacement[d][p]);
    square += chord[d] * chord[d];
  }
  return sqrt(square);
}

/* At rest. */
static double reference_of(const contact *c, int32_t i, int32_t j) {
  double from[3], to[3], square = 0;
  rows_place(rows_of(&c->sides[c->side[i]]), c->site[i], from);
  rows_place(rows_of(&c->sides[c->side[j]]), c->site[j], to);
  for (int d = 0; d < c->dimensions; d++)
    square += (to[d] - from[d]) * (to[d] - from[d]);
  return sqrt(square);
}

/* Place of the bond that joined two particles of a body, or -1. */
static int64_t slot_between(const rows *g, long p, long q) {
  for (int k = 0; k < 2 * g->directions; k++)
    if (rows_has_neighbour(g, p, k) && rows_partner(g, p, k) == q)
      return k < g->directions ? (int64_t)k * g->size + p
                               : (int64_t)(k - g->directions) * g->size + q;
  return -1;
}

static double spacing_of(const contact *c, int32_t i, int32_t j) {
  return 0.5 * (rows_spacing(rows_of(&c->sides[c->side[i]]), c->site[i]) +
                rows_spacing(rows_of(&c->sides[c->side[j]]), c->site[j]));
}

static double stiffness_of(const contact *c, int32_t i) {
  const contact_body *of = &c->sides[c->side[i]].from;
  const rows *g = of->of->lattice;
  return of->by_size ? of->stiffness * (rows_spacing(g, c->site[i]) / g->spacing) : of->stiffness;
}

/* What two particles do when they touch. False where they cannot. */
static bool may_touch(const contact *c, int32_t i, int32_t j, near_pair *pair) {
  const contact_side *a = &c->sides[c->side[i]], *b = &c->sides[c->side[j]];
  double d = pl_fmin(spacing_of(c, i, j), reference_of(c, i, j));
  if (a == b) {
    if (!c->selves) return false;
    const int64_t slot = slot_between(rows_of(a), c->site[i], c->site[j]);
    if (slot >= 0 && !(a->lost && a->lost[slot] > 0)) return false;
    if (slot >= 0) d = pl_fmin(d, a->lost[slot]);
  }
  *pair = (near_pair){i, j, d, pl_fmin(stiffness_of(c, i), stiffness_of(c, j))};
  return true;
}

/* --- the list --------------------------------------------------------------------------------- */

static int by_particles(const void *a, const void *b) {
  const near_pair *p = a, *q = b;
  if (p->i != q->i) return p->i < q->i ? -1 : 1;
  return (p->j > q->j) - (p->j < q->j);
}

/* Half of the skin that is not looked ahead has been used up by some particle. */
static bool has_moved_far(const contact *c) {
  const double skin = c->skin - c->ahead, most = 0.25 * skin * skin;
  for (int b = 0; b < c->count; b++) {
    const contact_side *s = &c->sides[b];
    const body *w = s->from.of;
    for (int row = 0; row < w->lattice->row_count; row++) {
      const long start = body_start(w, row), count = w->count[row];
      int64_t far = 0;
      for (long q = start; q < start + count; q++) {
        double square = 0;
        for (int d = 0; d < c->dimensions; d++) {
          const double way = w->displacement[d][q] - s->listed[d][q];
          square += way * way;
        }
        far |= square > most;
      }
      if (far) return true;
    }
  }
  return false;
}

static void note_places(contact *c) {
  for (int b = 0; b < c->count; b++)
    for (int d = 0; d < c->dimensions; d++)
      memcpy(c->sides[b].listed[d], c->sides[b].from.of->displacement[d],
             (size_t)rows_of(&c->sides[b])->size * sizeof(double));
  for (long p = 0; p < c->particles; p++) {
    const body *w = c->sides[c->side[p]].from.of;
    double at[3];
    rows_place(w->lattice, c->site[p], at);
    for (int d = 0; d < c->dimensions; d++)
      c->at[d][p] = at[d] + w->displacement[d][c->site[p]];
  }
}

static void add_pair(contact *c, const near_pair *pair) {
  make_room((void **)&c->pairs, &c->pair_room, c->pair_count + 1, sizeof *c->pairs);
  c->pairs[c->pair_count++] = *pair;
}

/* Of particle i with those of a run of boxes that have higher numbers. */
static void list_run(contact *c, int32_t i, int64_t from, int64_t to) {
  for (int32_t n = c->boxes.first[from]; n < c->boxes.first[to + 1]; n++) {
    const int32_t j = c->boxes.point[n];
    double square = 0;
    near_pair pair;
    if (j <= i || (!c->selves && c->side[i] == c->side[j])) continue;
    for (int d = 0; d < c->dimensions; d++)
      square += (c->at[d][j] - c->at[d][i]) * (c->at[d][j] - c->at[d][i]);
    if (square < c->reach * c->reach && may_touch(c, i, j, &pair) &&
        square < (pair.d + c->skin) * (pair.d + c->skin))
      add_pair(c, &pair);
  }
}

static void list_pairs_of(contact *c, int32_t i) {
  const boxes *b = &c->boxes.boxes;
  const long before = c->pair_count;
  const double at[3] = {c->at[0][i], c->at[1][i], c->dimensions == 3 ? c->at[2][i] : 0};
  int home[3];
  boxes_home(b, at, home);
  const int left = home[0] > 0 ? home[0] - 1 : 0,
            right = home[0] < b->count[0] - 1 ? home[0] + 1 : home[0];
  for (int z = home[2] - 1; z <= home[2] + 1; z++)
    for (int y = home[1] - 1; y <= home[1] + 1; y++) {
      const int64_t row = boxes_number(b, (int[3]){0, y, z});
      if (row >= 0) list_run(c, i, row + left, row + right);
    }
  if (c->pair_count > before + 1)
    qsort(c->pairs + before, (size_t)(c->pair_count - before), sizeof *c->pairs, by_particles);
}

static void list_pairs(contact *c) {
  note_places(c);
  bins_renew(&c->boxes, c->dimensions, (const double *const *)c->at, c->particles, c->reach);
  c->pair_count = 0;
  for (long p = 0; p < c->particles; p++)
    list_pairs_of(c, (int32_t)p);
  c->known = true;
}

/* --- bonds that are lost ---------------------------------------------------------------------- */

/* No law's part of the bond is left. */
static bool is_gone(const contact_side *s, const rows_bond *bond) {
  const rows *g = rows_of(s);
  for (int n = 0; n < s->from.law_count; n++) {
    const contact_law *l = &s->from.laws[n];
    if (rows_has_bond(l->rows, bond->slot % g->size, (int)(bond->slot / g->size)) &&
        damage_of_bond_in(l->of, l->of->field, bond) < 1)
      return false;
  }
  return true;
}

static void lose_bond(contact *c, contact_side *s, const rows_bond *bond) {
  const int32_t a = s->first + bond->i, b = s->first + bond->j;
  const int32_t i = a < b ? a : b, j = a < b ? b : a;
  double chord[3];
  near_pair pair;
  if (s->lost[bond->slot] > 0 || !is_gone(s, bond)) return;
  s->lost[bond->slot] = c->late ? INFINITY : pl_fmax(chord_of(c, i, j, chord), DBL_MIN);
  if (!may_touch(c, i, j, &pair)) return;
  make_room((void **)&c->fresh, &c->fresh_room, c->fresh_count + 1, sizeof *c->fresh);
  c->fresh[c->fresh_count++] = pair;
}

static rows_bond bond_at(const rows *g, long site, int direction) {
  return (rows_bond){g->site_particle[site], g->site_particle[rows_partner(g, site, direction)],
                     (int64_t)direction * g->size + site};
}

/* Where one plane for each direction says it all; chunks in which as many are lost as before are
   passed over. */
static void look_at_planes(contact *c, contact_side *s, int law, const double *damage) {
  const rows *g = rows_of(s), *own = s->from.laws[law].rows;
  int32_t *broken = s->broken + (long)law * g->directions * s->chunks;
  for (int k = 0; k < g->directions; k++)
    for (long n = 0; n < s->chunks; n++) {
      const double *here = damage + (long)k * g->size + n * CHUNK;
      const long count = g->size - n * CHUNK < CHUNK ? g->size - n * CHUNK : CHUNK;
      int32_t now = 0;
      for (long q = 0; q < count; q++)
        now += here[q] >= 1;
      if (now == broken[k * s->chunks + n]) continue;
      broken[k * s->chunks + n] = now;
      for (long q = 0; q < count; q++) {
        if (!(here[q] >= 1) || !rows_has_bond(own, n * CHUNK + q, k)) continue;
        const rows_bond bond = bond_at(g, n * CHUNK + q, k);
        lose_bond(c, s, &bond);
      }
    }
}

static void look_at_bonds(contact *c, contact_side *s, const contact_law *l) {
  for (long m = 0; m < l->rows->bond_count; m++)
    if (!(s->lost[l->bonds[m].slot] > 0) &&
        damage_of_bond_in(l->of, l->of->field, &l->bonds[m]) >= 1)
      lose_bond(c, s, &l->bonds[m]);
}

static void find_losses(contact *c) {
  c->fresh_count = 0;
  for (int b = 0; b < c->count; b++) {
    contact_side *s = &c->sides[b];
    for (int n = 0; n < s->from.law_count && s->lost; n++) {
      const double *damage = damage_of_all_bonds_in(s->from.laws[n].of, s->from.laws[n].of->field);
      if (damage)
        look_at_planes(c, s, n, damage);
      else if (damage_on_bonds(s->from.laws[n].of->law))
        look_at_bonds(c, s, &s->from.laws[n]);
    }
  }
}

/* Pairs whose bond was lost, into their places in the list. */
static void merge_fresh(contact *c) {
  if (c->fresh_count == 0) return;
  qsort(c->fresh, (size_t)c->fresh_count, sizeof *c->fresh, by_particles);
  long listed = c->pair_count - 1, fresh = c->fresh_count - 1;
  c->pair_count += c->fresh_count;
  make_room((void **)&c->pairs, &c->pair_room, c->pair_count, sizeof *c->pairs);
  for (long to = c->pair_count - 1; fresh >= 0; to--) {
    const bool later = listed < 0 || by_particles(&c->pairs[listed], &c->fresh[fresh]) < 0;
    c->pairs[to] = later ? c->fresh[fresh--] : c->pairs[listed--];
  }
}

/* --- forces ----------------------------------------------------------------------------------- */

static void push_apart(contact *c, const near_pair *pair) {
  double chord[3] = {0, 0, 0}, back[3] = {0, 0, 0};
  const double r = chord_of(c, pair->i, pair->j, chord), over = pair->d - r;
  if (over > -c->ahead) c->near = true;
  if (!(over > 0)) return;
  c->stored += 0.5 * pair->k * over * over;
  c->largest = pl_fmax(c->largest, pair->k * over);
  if (!(r > 0)) return; /* no direction leads apart */
  touch *t = &c->touching[c->touch_count++];
  *t = (touch){.i = pair->i, .j = pair->j};
  for (int d = 0; d < c->dimensions; d++) {
    t->force[d] = pair->k * over * chord[d] / r;
    back[d] = -t->force[d];
  }
  body_push(c->sides[c->side[pair->i]].from.of, c->site[pair->i], back);
  body_push(c->sides[c->side[pair->j]].from.of, c->site[pair->j], t->force);
}

void contact_find(contact *c) {
  find_losses(c);
  if (!c->known || has_moved_far(c))
    list_pairs(c);
  else
    merge_fresh(c);
  make_room((void **)&c->touching, &c->touch_room, c->pair_count, sizeof *c->touching);
  c->touch_count = 0;
  c->stored = c->largest = 0;
  c->near = false;
  for (long n = 0; n < c->pair_count; n++)
    push_apart(c, &c->pairs[n]);
}

double contact_stored(const contact *c) {
  return c->stored;
}

long contact_touching(const contact *c, double *largest) {
  *largest = c->largest;
  return c->touch_count;
}

bool contact_near(const contact *c) {
  return c->near;
}

double contact_power(const contact *c, double *power) {
  double sum = 0;
  for (long n = 0; n < c->touch_count; n++) {
    const touch *t = &c->touching[n];
    const int ends[2] = {t->i, t->j};
    for (int e = 0; e < 2; e++) {
      const int of = c->side[ends[e]];
      double here = 0;
      for (int d = 0; d < c->dimensions; d++)
        here += t->force[d] * c->sides[of].from.of->velocity[d][c->site[ends[e]]];
      power[of] += e ? here : -here;
      sum += e ? here : -here;
    }
  }
  return sum;
}

static void add_overlap(const contact *c, const near_pair *pair, double d, double part,
                        contact_overlap *o) {
  double chord[3];
  const double r = chord_of(c, pair->i, pair->j, chord);
  const int32_t ends[2] = {pair->i, pair->j};
  if (!(r < part * d)) return;
  o->pairs++;
  if (!(r < o->nearest * d)) return;
  o->nearest = r / d;
  for (int e = 0; e < 2; e++) {
    o->body[e] = c->side[ends[e]];
    o->site[e] = c->site[ends[e]];
  }
}

contact_overlap contact_drawn_over(contact *c, double part) {
  contact_overlap o = {.nearest = INFINITY};
  list_pairs(c);
  for (long n = 0; n < c->pair_count; n++) {
    const near_pair *pair = &c->pairs[n];
    if (c->side[pair->i] != c->side[pair->j])
      add_overlap(c, pair, spacing_of(c, pair->i, pair->j), part, &o);
  }
  return o;
}

contact_overlap contact_overlaps(contact *c, double part) {
  contact_overlap o = {.nearest = INFINITY};
  c->late = true;
  find_losses(c);
  list_pairs(c);
  for (long n = 0; n < c->pair_count; n++)
    add_overlap(c, &c->pairs[n], c->pairs[n].d, part, &o);
  return o;
}

double *contact_lost(contact *c, int number, size_t *count) {
  const rows *g = rows_of(&c->sides[number]);
  *count = (size_t)g->directions * (size_t)g->size;
  return c->sides[number].lost;
}

double contact_memory(const contact *c) {
  double bytes =
      (double)c->pair_room * sizeof(near_pair) + (double)c->touch_room * sizeof(touch) +
      (double)c->fresh_room * sizeof(near_pair) +
      (double)c->particles * (2 * sizeof(int32_t) + (double)c->dimensions * sizeof(double));
  for (int b = 0; b < c->count; b++) {
    const rows *g = rows_of(&c->sides[b]);
    bytes += (double)g->size * (c->dimensions + (c->sides[b].lost ? g->directions : 0)) *
             (double)sizeof(double);
  }
  return bytes;
}
