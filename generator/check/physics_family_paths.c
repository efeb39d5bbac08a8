/* Histories of a body made of a law of families: ranges, jumps, flow, closed cycles. */
#include "generator/check/physics_family_paths.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "dsl/base/arena.h"
#include "dsl/base/elementary.h"
#include "generator/ir/random_values.h"

static const double DAMAGE_TOLERANCE = 1e-9;
static const double SIDES_TOLERANCE = 1e-9; /* of the largest value of the field */
static const double JUMP_TOLERANCE =
    1e-6; /* of the largest force, between two states that are nearly one */
static const double GAIN_TOLERANCE = 1e-6; /* of a cycle's peak energy */

/* --- one leg of a history --------------------------------------------------------------------- */

typedef struct flow_tally { /* states just beyond a yield limit */
  int judged, idle;         /* nothing, or less than nothing, was removed */
  double share;             /* in one of these */
} flow_tally;

typedef struct leg {
  double *from, *to, *rate, *u, *force, *other;
  double strain, speed;    /* 1, 1/s */
  bool in_time;            /* the time of the body has gone on */
  unsigned char *truth[2]; /* of all guards at all places: at the last step, now */
  long truths;
  flow_tally *tally; /* [flows] of all legs */
} leg;

static leg leg_new(const family_bench *b) {
  leg l = {.from = family_bench_values(b),
           .to = family_bench_values(b),
           .rate = family_bench_values(b),
           .u = family_bench_values(b),
           .force = family_bench_values(b),
           .other = family_bench_values(b)};
  for (int k = 0; k < b->conditions.count; k++)
    l.truths += family_bench_places(b, b->guard[k]);
  for (int k = 0; k < 2; k++)
    l.truth[k] = must_calloc((size_t)l.truths + 1, 1);
  l.tally = must_calloc((size_t)b->step.text.flow_count + 1, sizeof *l.tally);
  return l;
}

static void leg_free(leg *l) {
  double *all[] = {l->from, l->to, l->rate, l->u, l->force, l->other};
  for (size_t k = 0; k < sizeof all / sizeof *all; k++)
    free(all[k]);
  free(l->truth[0]);
  free(l->truth[1]);
  free(l->tally);
}

static void move_on_leg(family_bench *b, leg *l, double way) {
  for (long k = 0; k < b->values; k++)
    l->u[k] = l->from[k] + way * (l->to[k] - l->from[k]);
  family_bench_move(b, l->u, l->rate);
}

/* Truth of every guard at every place where its bond exists. */
static void find_truths(family_bench *b, unsigned char *truth) {
  family_bench_observe(b);
  for (int k = 0; k < b->conditions.count; k++)
    for (int q = 0; q < family_bench_places(b, b->guard[k]); q++)
      *truth++ =
          family_bench_exists(b, b->guard[k], q) && family_bench_value(b, b->guard[k], q) != 0;
}

static void note_seen(family_bench *b, const unsigned char *truth) {
  for (int k = 0; k < b->conditions.count; k++)
    for (int q = 0; q < family_bench_places(b, b->guard[k]); q++, truth++)
      if (family_bench_exists(b, b->guard[k], q)) conditions_see(&b->conditions, k, *truth);
}

/* --- what every step is asked ----------------------------------------------------------------- */

/* What grows in time may do so without end in one of the steps taken here. */
static void check_finite(family_bench *b, const leg *l) {
  for (long k = 0; k < b->values && !l->in_time; k++)
    if (!isfinite(l->force[k])) {
      family_bench_say(b, DIAG_NOT_FINITE, family_bench_force(b), l->strain,
                       "the force is not a finite number in a state that a body can reach");
      return;
    }
}

static void check_damage_range(family_bench *b, const leg *l) {
  for (int f = 0; f < b->law->fields.count; f++)
    for (int q = 0; q < family_bench_places(b, b->rule[f]); q++) {
      const double rule = family_bench_value(b, b->rule[f], q);
      if (!family_bench_exists(b, b->rule[f], q) ||
          !(rule < -DAMAGE_TOLERANCE || rule > 1 + DAMAGE_TOLERANCE))
        continue;
      family_bench_say(b, DIAG_DAMAGE_RANGE, b->law->fields.items[f]->rule->where, l->strain,
                       "the rule of damage `%s` gives %.6g, outside [0, 1]; it is cut off there",
                       b->law->fields.items[f]->name, rule);
    }
}

/* New values of a bond that its two particles find. */
typedef struct both_sides {
  double mine, other;
} both_sides;

static both_sides worst_sides(const patch *p, int field, double *size) {
  both_sides worst = {0, 0};
  const int half = p->lattice->directions;
  *size = 0;
  for (long q = 0; q < p->inside_count; q++)
    for (int k = 0; k < half; k++) {
      const long site = p->inside[q];
      if (!patch_has_bond(p, site, k)) continue;
      const double *v = p->new_field[field] + k * p->size, *back = v + half * p->size;
      const both_sides now = {v[site], back[patch_neighbour(p, site, k)]};
      *size = pl_fmax(*size, pl_fmax(fabs(now.mine), fabs(now.other)));
      if (fabs(now.mine - now.other) > fabs(worst.mine - worst.other)) worst = now;
    }
  return worst;
}

/* What lives on a bond has one value: passes take it for the neighbour's, too. */
static void check_bond_fields(family_bench *b, const leg *l) {
  for (int f = 0; f < b->law->fields.count; f++) {
    const symbol *s = b->law->fields.items[f];
    double size;
    if (s->place != ON_BOND || b->failed[DIAG_EXCHANGE]) continue;
    const both_sides worst = worst_sides(b->whole, f, &size);
    if (fabs(worst.mine - worst.other) <= SIDES_TOLERANCE * size) continue;
    family_bench_say(
        b, DIAG_EXCHANGE, s->rule->where, l->strain,
        "the particles of a bond find different values for its `%s`: one %.6g, the other %.6g",
        s->name, worst.mine, worst.other);
    diag_hint(b->said, "declare it `on neighbour`, which has a value on either side, or write a "
                       "rule that reads the same "
                       "from both");
  }
}

/* --- continuity ------------------------------------------------------------------------------- */

/* Place of guard k's truths. */
static long first_truth(const family_bench *b, int k) {
  long at = 0;
  for (int q = 0; q < k; q++)
    at += family_bench_places(b, b->guard[q]);
  return at;
}

/* Line of the group from `first` in force at a place; guards of a group may live on particles or
   toward neighbours. */
static int line_in_force(const family_bench *b, const unsigned char *truth, int first, int where,
                         bool wide) {
  const lowered_text *t = &b->step.text;
  const int neighbours = 2 * b->lattice->directions;
  int k = first;
  for (; k < t->line_count && t->lines[k].group == t->lines[first].group; k++) {
    const watched w = b->guard[k];
    if (w.at < 0) continue;
    const int at = w.wide == wide ? where : where / neighbours;
    if (truth[first_truth(b, k) + at]) return t->lines[k].line;
  }
  return t->lines[first].cases->case_count - 1;
}

static bool group_is_wide(const family_bench *b, int first) {
  const lowered_text *t = &b->step.text;
  for (int k = first; k < t->line_count && t->lines[k].group == t->lines[first].group; k++)
    if (b->guard[k].wide) return true;
  return false;
}

/* The line at whose end both truths part. NULL where none does, or *jump: one that is meant. */
static const case_line *parting_line(const family_bench *b, const leg *l, bool *jump) {
  const lowered_text *t = &b->step.text;
  const case_line *parting = NULL;
  *jump = false;
  for (int k = 0; k < t->line_count; k++) {
    if (k > 0 && t->lines[k].group == t->lines[k - 1].group) continue;
    const watched w = {0, group_is_wide(b, k)};
    for (int q = 0; q < family_bench_places(b, w); q++) {
      const int a = line_in_force(b, l->truth[0], k, q, w.wide),
                c = line_in_force(b, l->truth[1], k, q, w.wide);
      const case_line *lines = t->lines[k].cases->cases;
      if (a == c || !family_bench_exists(b, w, q)) continue;
      for (int n = a < c ? a : c; n <= (a < c ? c : a); n++)
        *jump = *jump || lines[n].jump;
      if (!parting) parting = &lines[a < c ? a : c];
    }
  }
  return parting;
}

/* Narrows the way between two states whose guards differ until it is nothing. Afterwards
   truth[0] and truth[1] are those of its ends. */
static void find_crossing(family_bench *b, leg *l, double *before, double *after) {
  enum { HALVINGS = 30 };
  unsigned char *middle = must_alloc((size_t)l->truths + 1);
  for (int k = 0; k < HALVINGS; k++) {
    const double way = 0.5 * (*before + *after);
    move_on_leg(b, l, way);
    find_truths(b, middle);
    const bool same = memcmp(middle, l->truth[0], (size_t)l->truths) == 0;
    *(same ? before : after) = way;
    memcpy(l->truth[same ? 0 : 1], middle, (size_t)l->truths);
  }
  free(middle);
}

static double largest_force(family_bench *b, leg *l, double way, double *force) {
  double most = 0;
  move_on_leg(b, l, way);
  family_bench_forces(b, b->whole, force);
  for (long k = 0; k < b->values; k++)
    most = pl_fmax(most, fabs(force[k]));
  return most;
}

static void check_continuity(family_bench *b, leg *l, double before, double after) {
  double jump = 0;
  bool meant;
  const case_line *line = parting_line(b, l, &meant);
  if (!line || meant || b->failed[DIAG_CONTINUITY]) return;
  const double reached = largest_force(b, l, 1, l->force);
  const double size =
      pl_fmax(largest_force(b, l, before, l->force), largest_force(b, l, after, l->other));
  for (long k = 0; k < b->values; k++)
    jump = pl_fmax(jump, fabs(l->force[k] - l->other[k]));
  const double smooth = (1e-9 + 1e3 * (after - before)) * reached;
  if (!(jump > JUMP_TOLERANCE * size + smooth)) return;
  family_bench_say(b, DIAG_CONTINUITY, line->where, l->strain,
                   "the law jumps where this case ends: a force changes by %.4g N, the largest is "
                   "%.4g N",
                   jump, size);
  diag_hint(b->said, "let the two values meet, or write `jump` at the end of the line if the jump "
                     "is meant");
}

/* --- flow ------------------------------------------------------------------------------------- */

/* Only what the flow changes is taken over. */
static void accept_flow(family_bench *b, int field) {
  patch *p = b->whole;
  for (long k = 0; k < patch_planes(p, &p->law->fields[field]); k++)
    for (long q = 0; q < p->inside_count; q++)
      p->field[field][k * p->size + p->inside[q]] = p->new_field[field][k * p->size + p->inside[q]];
}

static double *kept_field(const patch *p, int field) {
  const size_t bytes = (size_t)(patch_planes(p, &p->law->fields[field]) * p->size) * sizeof(double);
  double *kept = must_alloc(bytes);
  memcpy(kept, p->field[field] - p->lead, bytes);
  return kept;
}

static void restore_field(patch *p, int field, double *kept) {
  memcpy(p->field[field] - p->lead, kept,
         (size_t)(patch_planes(p, &p->law->fields[field]) * p->size) * sizeof(double));
  free(kept);
}

static double *values_of(const family_bench *b, watched w) {
  const int count = family_bench_places(b, w);
  double *v = must_alloc(((size_t)count + 1) * sizeof *v);
  for (int q = 0; q < count; q++)
    v[q] = family_bench_value(b, w, q);
  return v;
}

/* A flow that runs away does so once; one that goes nowhere, or backward, does so always: there
   are states that no flow can lead out of. */
static void tally_share(family_bench *b, leg *l, int k, double share) {
  flow_tally *t = &l->tally[k];
  const stmt *rule = b->step.text.flows[k].rule;
  t->judged++;
  if (!(share > 1e-9)) {
    t->idle++;
    t->share = share;
  }
  if (share < 2 - 1e-9) return;
  family_bench_say(b, DIAG_FLOW, rule->where, l->strain,
                   "this flow removes %.4g of the overstress in a step; it must remove more than "
                   "0 and less than 2",
                   share);
  diag_hint(b->said, "a flow that removes 1 returns to the yield limit; more than 2 runs away");
}

static void judge_tallies(family_bench *b, const leg *l) {
  enum { FEWEST_JUDGED = 4 }; /* of more than one crossing */
  for (int k = 0; k < b->step.text.flow_count; k++) {
    const flow_tally *t = &l->tally[k];
    if (t->idle < t->judged || t->judged < FEWEST_JUDGED) continue;
    family_bench_say(b, DIAG_FLOW, b->step.text.flows[k].rule->where, 0,
                     "this flow removes %.4g of the overstress in a step; it must remove more than "
                     "0 and less than 2",
                     t->share);
    diag_hint(b->said,
              "the flow must lower the yield function: look at its sign and at what it changes");
  }
}

static bool is_whole(const family_bench *b) {
  const patch *p = b->whole;
  for (int f = 0; f < b->law->fields.count; f++)
    for (long k = 0;
         b->law->fields.items[f]->kind == SYMBOL_DAMAGE && k < patch_planes(p, &p->law->fields[f]);
         k++)
      for (long q = 0; q < p->inside_count; q++)
        if (p->field[f][k * p->size + p->inside[q]] != 0) return false;
  return true;
}

/* Where the overstress is largest: what flows around it does not carry it away. Only among
   families as whole as there are any: stresses of a few bonds at an edge may have no way back.
   -1 where nothing yields. */
static int worst_place(const family_bench *b, watched over, const double *overstress,
                       const double *yields) {
  int worst = -1, most = 0;
  for (int q = 0; q < family_bench_places(b, over); q++)
    most = family_bench_bonds(b, over, q) > most ? family_bench_bonds(b, over, q) : most;
  for (int q = 0; q < family_bench_places(b, over); q++)
    if (family_bench_exists(b, over, q) && family_bench_bonds(b, over, q) == most &&
        yields[q] != 0 && overstress[q] > 0 && (worst < 0 || overstress[q] > overstress[worst]))
      worst = q;
  return worst;
}

/* At a state just beyond a yield limit: one flow, everything else as it is. */
static void check_one_flow(family_bench *b, leg *l, int k) {
  const lowered_flow *f = &b->step.text.flows[k];
  const watched over = b->overstress[k], when = b->guard[b->step.text.line_count + k];
  double *kept = kept_field(b->whole, f->field);
  family_bench_observe(b);
  double *before = values_of(b, over), *yields = values_of(b, when);
  family_bench_share_fields(b);
  const double stored = b->has_energy ? family_bench_energy(b) : 0;
  family_bench_forces(b, b->whole, l->force);
  accept_flow(b, f->field);
  family_bench_observe(b);
  double *after = values_of(b, over);
  const int worst = over.wide == when.wide ? worst_place(b, over, before, yields) : -1;
  if (worst >= 0) tally_share(b, l, k, (before[worst] - after[worst]) / before[worst]);
  family_bench_share_fields(b);
  const double gain = b->has_energy ? family_bench_energy(b) - stored : 0;
  if (gain > 1e-7 * fabs(stored) && (is_whole(b) || !b->law->nonconservative)) {
    family_bench_say(b, DIAG_FLOW, f->rule->where, l->strain,
                     "this flow raises the energy that the body stores, by %.4g of %.4g J: plastic "
                     "power is negative",
                     gain, stored);
    diag_hint(b->said, "a flow goes the way the force pulls");
  }
  restore_field(b->whole, f->field, kept);
  free(before);
  free(yields);
  free(after);
}

/* Flows that begin in the whole body between both truths: where it flows elsewhere, a step may
   have left too much. From just beyond the limit to a little further. */
static void check_flows(family_bench *b, leg *l, double after) {
  static const double beyond[] = {1e-6, 1e-4, 1e-2};
  const int lines = b->step.text.line_count;
  for (int k = 0; k < b->step.text.flow_count && !b->failed[DIAG_FLOW]; k++) {
    const long first = first_truth(b, lines + k);
    bool before = false, begins = false;
    for (int q = 0; q < family_bench_places(b, b->guard[lines + k]); q++) {
      before = before || l->truth[0][first + q];
      begins = begins || l->truth[1][first + q];
    }
    for (size_t n = 0; n < sizeof beyond / sizeof *beyond && begins && !before; n++) {
      move_on_leg(b, l, after * (1 + beyond[n]));
      check_one_flow(b, l, k);
    }
  }
}

/* --- histories -------------------------------------------------------------------------------- */

/* Every other leg is slow, and the last of a body goes far. */
static void begin_leg(family_bench *b, leg *l, bool slow, bool far) {
  double *from = l->from;
  l->from = l->to;
  l->to = from;
  l->strain = pl_pow(10, far ? draw_uniform(&b->seed, 0, 0.5) : draw_uniform(&b->seed, -3.5, -0.7));
  b->whole->advance = b->reads_time && !slow ? pl_pow(10, draw_uniform(&b->seed, -8, 8)) : 0;
  l->in_time = l->in_time || b->whole->advance > 0;
  l->speed = slow ? 0 : pl_pow(10, draw_uniform(&b->seed, -3, 5));
  family_bench_deform(b, l->strain, l->to);
  for (long k = 0; k < b->values; k++)
    l->rate[k] = l->speed * (l->to[k] - l->from[k]);
}

static void rest_leg(family_bench *b, leg *l) {
  memset(l->to, 0, (size_t)b->values * sizeof(double));
}

/* Steps grow: what a law begins with happens at small strains. */
static double way_at(int step, int steps) {
  return pl_pow(10, 3.0 * (step - steps) / steps);
}

/* Jumps are looked for on slow legs: a damper may begin with a case. */
static void go_leg(family_bench *b, leg *l, int *crossings) {
  enum { STEPS = 8 };
  for (int step = 1; step <= STEPS; step++) {
    const double before = step > 1 ? way_at(step - 1, STEPS) : 0, after = way_at(step, STEPS);
    move_on_leg(b, l, before);
    find_truths(b, l->truth[0]);
    move_on_leg(b, l, after);
    find_truths(b, l->truth[1]);
    check_damage_range(b, l);
    note_seen(b, l->truth[1]);
    if (*crossings > 0 && l->speed == 0 &&
        memcmp(l->truth[0], l->truth[1], (size_t)l->truths) != 0) {
      double low = before, high = after;
      --*crossings;
      find_crossing(b, l, &low, &high);
      note_seen(b, l->truth[1]);
      check_continuity(b, l, low, high);
      check_flows(b, l, high);
    }
    move_on_leg(b, l, after);
    family_bench_forces(b, b->whole, l->force);
    check_finite(b, l);
    check_bond_fields(b, l);
    family_bench_accept(b);
  }
}

void family_check_histories(family_bench *b, int legs) {
  enum { LEGS_OF_ONE = 4, CROSSINGS_OF_ONE = 2 };
  leg l = leg_new(b);
  int crossings = 0;
  for (int k = 0; k < legs && !(k && family_bench_tired(b)); k++) {
    if (k % LEGS_OF_ONE == 0) {
      family_bench_draw(b, k == 0);
      l.in_time = false;
      rest_leg(b, &l);
      crossings = CROSSINGS_OF_ONE;
    }
    begin_leg(b, &l, k % 2 == 0, k % LEGS_OF_ONE == LEGS_OF_ONE - 1);
    go_leg(b, &l, &crossings);
  }
  b->whole->advance = 0;
  judge_tallies(b, &l);
  leg_free(&l);
}

/* --- dissipation ------------------------------------------------------------------------------ */

enum { CORNERS = 5 }; /* the first and the last at rest */

typedef struct cycle {
  double *corner[CORNERS];
  double strain, speed, work, peak;
  double time; /* s, from corner to corner, of laws that read it */
} cycle;

/* How quickly states of the virgin body begin to change. */
static void begin_time(family_bench *b, double *force) {
  if (!b->reads_time) return;
  family_bench_move(b, NULL, NULL);
  family_bench_forces(b, b->whole, force);
  family_bench_accept(b);
}

/* The whole law round the corners from the virgin body, forces in the middle of each step. */
static void go_round(family_bench *b, cycle *c, int steps) {
  double *u = family_bench_values(b), *v = family_bench_values(b), *way = family_bench_values(b),
         *force = family_bench_values(b);
  const patch *p = b->whole;
  patch_virgin(b->whole);
  begin_time(b, force);
  c->work = c->peak = 0;
  for (int k = 0; k + 1 < CORNERS; k++) {
    for (long n = 0; n < b->values; n++) {
      way[n] = (c->corner[k + 1][n] - c->corner[k][n]) / steps;
      v[n] = c->speed * steps * way[n];
    }
    for (int step = 0; step < steps; step++) {
      double size = 0;
      for (long n = 0; n < b->values; n++)
        u[n] = c->corner[k][n] + (step + 0.5) * way[n];
      family_bench_move(b, u, v);
      if (b->reads_time) b->whole->advance = (k || step ? 1 : 0.5) * c->time / steps;
      family_bench_forces(b, b->whole, force);
      c->work += family_work(force, way, p->law->dimensions * p->inside_count, &size);
      c->peak = pl_fmax(c->peak, fabs(c->work));
      family_bench_accept(b);
    }
  }
  b->whole->advance = 0;
  free(u);
  free(v);
  free(way);
  free(force);
}

/* Forces along the reference bonds have an energy in the limit of small strains only. */
static double tolerated_gain(const family_bench *b, const cycle *c) {
  if (b->law->nonconservative || b->failed[DIAG_CLOSED_PATH_DAMAGED])
    return GAIN_OF_NONCONSERVATIVE;
  return GAIN_TOLERANCE + (b->step.along_reference ? c->strain : 0);
}

/* True when ever finer steps agree that work comes out. */
static bool stays_negative(family_bench *b, cycle *c) {
  static const int steps[] = {61, 139, 317, 727};
  double before = INFINITY;
  int settled = 0;
  for (size_t k = 0; k < sizeof steps / sizeof *steps && settled < 2; k++) {
    go_round(b, c, steps[k]);
    if (!(c->work < -tolerated_gain(b, c) * c->peak)) return false;
    settled = fabs(c->work - before) <= 0.1 * fabs(c->work) ? settled + 1 : 0;
    before = c->work;
  }
  return settled == 2;
}

/* Out and back through another corner; some twice the same way. */
static void draw_cycle(family_bench *b, cycle *c, int kind) {
  c->strain = pl_pow(10, draw_uniform(&b->seed, -5, -1));
  c->speed = b->reads_time ? 1 / c->time : pl_pow(10, draw_uniform(&b->seed, -3, 4));
  for (int k = 1; k + 1 < CORNERS; k++)
    family_bench_deform(b, c->strain, c->corner[k]);
  if (kind % 2) memset(c->corner[2], 0, (size_t)b->values * sizeof(double));
  if (kind % 4 == 1) memcpy(c->corner[3], c->corner[1], (size_t)b->values * sizeof(double));
}

void family_check_dissipation(family_bench *b, int cycles) {
  enum { COARSE = 16 };
  cycle c = {.time = 0};
  for (int k = 0; k < CORNERS; k++)
    c.corner[k] = family_bench_values(b);
  for (int k = 0; k < cycles && !b->failed[DIAG_DISSIPATION] && !(k && family_bench_tired(b));
       k++) {
    family_bench_draw(b, k == 0);
    /* nothing tells how slow a law is: all over seventeen decades */
    if (b->reads_time) c.time = pl_pow(10, -8 + 17 * (k + draw_uniform(&b->seed, 0, 1)) / cycles);
    draw_cycle(b, &c, k);
    go_round(b, &c, COARSE);
    if (!(c.work < -tolerated_gain(b, &c) * c.peak) || !stays_negative(b, &c)) continue;
    family_bench_say(b, DIAG_DISSIPATION, family_bench_force(b), c.strain,
                     "a closed cycle gives %.4g J of work out, %.3g %% of its peak energy: the law "
                     "feeds energy",
                     -c.work, -100 * c.work / c.peak);
    diag_hint(b->said,
              b->reads_time
                  ? "what relaxes goes toward the deformation that moves it: look at signs "
                    "of rates; a stiffness that grows in time adds to what comes, not to "
                    "what is there"
                  : "damping opposes the rate, friction needs a `state` for the slip, and "
                    "damage is not undone");
  }
  for (int k = 0; k < CORNERS; k++)
    free(c.corner[k]);
}
