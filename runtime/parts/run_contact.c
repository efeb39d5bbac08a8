#include "runtime/parts/run_contact.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "dsl/base/arena.h"
#include "dsl/base/elementary.h"
#include "runtime/analysis/implied.h"
#include "runtime/analysis/uniform_strain.h"
#include "runtime/deck/lattice_kind.h"
#include "runtime/lattice/rows_select.h"
#include "runtime/particles/gradation.h"

/* --- which bodies ----------------------------------------------------------------------------- */

static void take_bodies(run_contact *c, const deck *k) {
  c->of = must_calloc((size_t)k->lattice_count + 1, sizeof *c->of);
  c->stiffness = must_calloc((size_t)k->lattice_count + 1, sizeof *c->stiffness);
  for (int b = 0; b < k->lattice_count; b++)
    if (deck_lattice_touches(&k->lattices[b], c->from)) c->of[c->count++] = b;
}

/* A tied mesh lies where particles of the lattice are. */
static void leave_out_tied_meshes(run_contact *c, const run_body *bodies) {
  int count = 0;
  for (int n = 0; n < c->count; n++)
    if (!bodies[c->of[n]].cells || !bodies[c->of[n]].tied) c->of[count++] = c->of[n];
  c->count = count;
}

/* --- stiffness -------------------------------------------------------------------------------- */

/* Young's modulus, Pa; NaN without stiffness. */
static double modulus_of(const run_body *b, const run_law *l, const deck *k) {
  const rows *g = b->lattice_rows;
  if (g->list) {
    const bool plane_strain = strcmp(k->lattices[b->lattice].setting, "plane_strain") == 0;
    uniform_response u;
    return uniform_strain_response(l->law, l->parameters, l->planes ? l->planes->value : NULL, g,
                                   plane_strain, &u)
               ? u.E
               : NAN;
  }
  implied_elasticity e;
  return implied_elastic(l->law, l->parameters, g, &e) ? e.E[0] : NAN;
}

/* Of a particle of the spacing, m^3: the mean, where all are meant to be as large. */
static double stressed_volume(const rows *g) {
  const double thickness = g->dimensions == 2 ? g->stiffness_thickness : 1;
  return g->own_size ? particle_measure(g->dimensions, g->spacing) * thickness
                     : rows_stressed_mean(g);
}

/* Of the softest of its laws. */
double run_contact_stiffness(const run_body *b, const deck *k) {
  const rows *g = b->lattice_rows;
  double least = INFINITY;
  for (int n = 0; n < b->law_count; n++) {
    const double E = modulus_of(b, &b->laws[n], k);
    if (!(E > 0)) return NAN;
    least = pl_fmin(least, E);
  }
  return least * stressed_volume(g) / (g->spacing * g->spacing);
}

static bool find_stiffness(run_contact *c, const deck *k, const run_body *bodies, diagnostics *d) {
  for (int n = 0; n < c->count; n++) {
    const run_body *b = &bodies[c->of[n]];
    c->stiffness[n] = c->from->stiffness > 0 ? c->from->stiffness : run_contact_stiffness(b, k);
    if (c->stiffness[n] > 0) continue;
    diag_report(d, DIAG_STIFFNESS, c->from->item.where,
                "the lattice `%s` has no Young's modulus that the stiffness of its contact could "
                "follow from",
                b->name);
    diag_hint(d, "give `stiffness`, e.g. stiffness = '1e8 N/m'");
    return false;
  }
  return true;
}

bool run_contact_by_size(const rows *g, double given) {
  return g->own_size && g->dimensions == 3 && !(given > 0);
}

double run_contact_lightest(const rows *g, bool by_size) {
  double least = g->mass;
  for (long p = 0; g->site_mass && p < g->particle_count; p++) {
    const long site = g->particle_site[p];
    least = pl_fmin(least, g->site_mass[site] / (by_size ? g->own_size[site] : 1));
  }
  return least;
}

static void add_rates(const run_contact *c, const run_body *bodies, touch_rates *touching) {
  for (int n = 0; n < c->count; n++) {
    const rows *g = bodies[c->of[n]].lattice_rows;
    const double around = g->dimensions == 2 ? 3 : 4,
                 lightest = run_contact_lightest(g, run_contact_by_size(g, c->from->stiffness));
    touching[c->of[n]].square += 2 * around * c->stiffness[n] / lightest;
  }
}

bool run_contacts_open(run_contacts *c, const deck *k, run_body *bodies, int body_count,
                       touch_rates *touching, diagnostics *d) {
  *c = (run_contacts){.bodies = bodies, .step = -1};
  c->items = must_calloc((size_t)k->contact_count + 1, sizeof *c->items);
  c->power = must_calloc((size_t)body_count + 1, sizeof *c->power);
  for (; c->count < k->contact_count; c->count++) {
    run_contact *item = &c->items[c->count];
    item->from = &k->contacts[c->count];
    take_bodies(item, k);
    if (!find_stiffness(item, k, bodies, d)) {
      c->count++;
      return false;
    }
    add_rates(item, bodies, touching);
  }
  return true;
}

/* --- what failed bonds bear ------------------------------------------------------------------- */

static double *copy_of(const double *values, size_t count) {
  double *copy = must_alloc((count + 1) * sizeof *copy);
  memcpy(copy, values, count * sizeof *copy);
  return copy;
}

static void put_back(double *to, double *kept, size_t count) {
  memcpy(to, kept, count * sizeof *to);
  free(kept);
}

static double largest_force(sweep *w) {
  const body *of = w->body;
  double most = 0;
  for (int k = 0; k < of->block_count; k++)
    of->blocks[k].aside = true;
  sweep_find_forces(w);
  for (int d = 0; d < of->dof; d++)
    for (long p = 0; p < of->lattice->particle_count; p++)
      most = pl_fmax(most, fabs(of->force[d][of->lattice->particle_site[p]]));
  return most;
}

static size_t field_size(const run_law *l, int field) {
  return (size_t)sweep_planes(l->state, l->law->fields[field].place) *
         (size_t)l->state->lattice->size;
}

/* All damages 1; returns the fields as they were. */
static double **fail_all(const run_law *l) {
  double **kept = must_calloc((size_t)l->law->field_count + 1, sizeof *kept);
  for (int f = 0; f < l->law->field_count; f++) {
    const size_t count = field_size(l, f);
    kept[f] = copy_of(l->state->field[f], count);
    for (size_t q = 0; q < count && l->law->fields[f].kind == PL_FIELD_DAMAGE; q++)
      l->state->field[f][q] = 1;
  }
  return kept;
}

static void heal_all(const run_law *l, double **kept) {
  for (int f = 0; f < l->law->field_count; f++)
    put_back(l->state->field[f], kept[f], field_size(l, f));
  free(kept);
}

typedef struct kept_motion { /* of a body, while it is asked */
  double *displacement[PL_MAX_DOF], *velocity[PL_MAX_DOF];
} kept_motion;

/* A little, evenly, from rest. */
static kept_motion press_together(body *of) {
  const double strain = -1e-6;
  const size_t size = (size_t)of->lattice->size;
  kept_motion kept;
  for (int d = 0; d < of->dof; d++) {
    kept.displacement[d] = copy_of(of->displacement[d], size);
    kept.velocity[d] = copy_of(of->velocity[d], size);
    memset(of->displacement[d], 0, size * sizeof(double));
    memset(of->velocity[d], 0, size * sizeof(double));
  }
  for (long p = 0; p < of->lattice->particle_count; p++) {
    const long q = of->lattice->particle_site[p];
    double at[3];
    rows_place(of->lattice, q, at);
    for (int d = 0; d < of->dimensions; d++)
      of->displacement[d][q] = strain * at[d];
  }
  return kept;
}

static void let_go(body *of, kept_motion *kept) {
  for (int d = 0; d < of->dof; d++) {
    put_back(of->displacement[d], kept->displacement[d], (size_t)of->lattice->size);
    put_back(of->velocity[d], kept->velocity[d], (size_t)of->lattice->size);
  }
}

/* Bonds that have failed still bear what presses them together. */
static bool failed_bonds_bear(const run_body *b) {
  double ***kept = must_calloc((size_t)b->law_count, sizeof *kept);
  kept_motion motion = press_together(b->body);
  const double whole = largest_force(b->state);
  for (int n = 0; n < b->law_count; n++)
    kept[n] = fail_all(&b->laws[n]);
  sweep_fields_set(b->state);
  const double failed = largest_force(b->state);
  for (int n = 0; n < b->law_count; n++)
    heal_all(&b->laws[n], kept[n]);
  sweep_fields_set(b->state);
  let_go(b->body, &motion);
  free(kept);
  return failed > 1e-6 * whole;
}

/* Those that say when a bond has failed, where nothing is left of it then; else none. */
static contact_law *laws_of(const run_body *b, int *count) {
  contact_law *laws = must_calloc((size_t)b->law_count, sizeof *laws);
  bool damaged = false;
  for (int n = 0; n < b->law_count; n++) {
    laws[n] = (contact_law){b->laws[n].state, b->laws[n].rows, b->laws[n].bonds};
    damaged = damaged || damage_on_bonds(b->laws[n].law);
  }
  *count = damaged && !failed_bonds_bear(b) ? b->law_count : 0;
  return laws;
}

/* --- at work ---------------------------------------------------------------------------------- */

void run_contacts_begin(run_contacts *c, double ahead) {
  for (int n = 0; n < c->count; n++) {
    run_contact *item = &c->items[n];
    contact_body *of = must_calloc((size_t)item->count + 1, sizeof *of);
    for (int b = 0; b < item->count; b++) {
      const run_body *from = &c->bodies[item->of[b]];
      of[b] =
          (contact_body){.of = from->body,
                         .stiffness = item->stiffness[b],
                         .by_size = run_contact_by_size(from->lattice_rows, item->from->stiffness)};
      of[b].laws = laws_of(from, &of[b].law_count);
      body_add_outer(from->body);
    }
    item->found = contact_new(of, item->count, item->from->lattice_count == 0);
    contact_look_ahead(item->found, ahead);
    free(of);
  }
}

void run_contacts_free(run_contacts *c) {
  for (int n = 0; n < c->count; n++) {
    contact_free(c->items[n].found);
    free(c->items[n].of);
    free(c->items[n].stiffness);
  }
  free(c->items);
  free(c->power);
}

/* Of the forces found last over half of the way that the last step took. */
static void add_work(run_contacts *c) {
  for (int n = 0; n < c->count; n++) {
    run_contact *item = &c->items[n];
    memset(c->power, 0, (size_t)item->count * sizeof *c->power);
    const double half = 0.5 * c->bodies[item->of[0]].body->time_step;
    item->work -= half * contact_power(item->found, c->power);
    for (int b = 0; b < item->count; b++)
      c->bodies[item->of[b]].body->outer_work += half * c->power[b];
  }
}

static void note_peaks(run_contact *item) {
  double force;
  const long pairs = contact_touching(item->found, &force);
  item->peaks = (contact_peaks){.pairs = pairs > item->peaks.pairs ? pairs : item->peaks.pairs,
                                .force = pl_fmax(force, item->peaks.force),
                                .stored = pl_fmax(contact_stored(item->found), item->peaks.stored)};
}

void run_contacts_find(run_contacts *c, int64_t step) {
  const bool known = c->step >= 0;
  if (c->step == step) return;
  if (known) add_work(c);
  for (int n = 0; n < c->count; n++)
    for (int b = 0; b < c->items[n].count; b++)
      body_clear_outer(c->bodies[c->items[n].of[b]].body);
  c->near = false;
  for (int n = 0; n < c->count; n++) {
    contact_find(c->items[n].found);
    c->near = c->near || contact_near(c->items[n].found);
    note_peaks(&c->items[n]);
  }
  if (known) add_work(c);
  c->step = step;
}

/* --- without contact -------------------------------------------------------------------------- */

static bool has_lost_bonds(const run_body *b) {
  for (int n = 0; n < b->law_count; n++) {
    const run_law *l = &b->laws[n];
    for (long m = 0; damage_on_bonds(l->law) && m < l->rows->bond_count; m++)
      if (damage_of_bond_in(l->state, l->state->field, &l->bonds[m]) >= 1) return true;
  }
  return false;
}

contact_overlap run_contacts_overlap(const deck *k, const run_body *bodies) {
  static const deck_contact all = {.lattice_count = 0};
  run_contact c = {.from = &all};
  contact_overlap o = {.pairs = 0};
  bool lost = false;
  take_bodies(&c, k);
  leave_out_tied_meshes(&c, bodies);
  contact_body *of = must_calloc((size_t)c.count + 1, sizeof *of);
  for (int n = 0; n < c.count; n++) {
    const run_body *b = &bodies[c.of[n]];
    of[n].of = b->body;
    if (!has_lost_bonds(b)) continue;
    of[n].laws = laws_of(b, &of[n].law_count);
    lost = lost || of[n].law_count > 0;
  }
  if (lost || c.count > 1) {
    c.found = contact_new(of, c.count, true);
    o = contact_overlaps(c.found, 0.5);
    for (int e = 0; e < 2; e++)
      o.body[e] = c.of[o.body[e]];
    contact_free(c.found);
  } else {
    for (int n = 0; n < c.count; n++)
      free(of[n].laws);
  }
  free(of);
  free(c.of);
  free(c.stiffness);
  return o;
}

/* The group that draws a particle; that of its lattice where its place comes from a file. */
static span drawn_by(const deck *k, const run_body *of, int32_t site) {
  const rows *g = of->lattice_rows;
  int32_t *body_of = must_calloc((size_t)g->particle_count + 1, sizeof *body_of);
  rows_bodies(g, k, of->lattice, body_of);
  const int32_t number = body_of[g->site_particle[site]];
  free(body_of);
  return number >= 0 && number < k->body_count ? k->bodys[number].item.where
                                               : k->lattices[of->lattice].item.where;
}

static bool some_contact_has(const deck *k, int first, int second) {
  for (int n = 0; n < k->contact_count; n++)
    if (deck_lattice_touches(&k->lattices[first], &k->contacts[n]) &&
        deck_lattice_touches(&k->lattices[second], &k->contacts[n]))
      return true;
  return false;
}

void run_contacts_warn(const deck *k, const run_body *bodies, diagnostics *d) {
  static const deck_contact all = {.lattice_count = 0};
  run_contact c = {.from = &all};
  take_bodies(&c, k);
  leave_out_tied_meshes(&c, bodies);
  contact_body *of = must_calloc((size_t)c.count + 1, sizeof *of);
  for (int n = 0; n < c.count; n++)
    of[n].of = bodies[c.of[n]].body;
  if (c.count > 1) {
    c.found = contact_new(of, c.count, false);
    const contact_overlap o = contact_drawn_over(c.found, 0.5);
    if (o.pairs > 0) {
      const run_body *first = &bodies[c.of[o.body[0]]], *second = &bodies[c.of[o.body[1]]];
      diag_report(d, DIAG_DECK_WARNING, drawn_by(k, second, o.site[1]),
                  "bodies of `%s` and `%s` lie over each other from the beginning: particles of "
                  "theirs are nearer than half a spacing, %ld pair%s in all",
                  first->name, second->name, o.pairs, o.pairs == 1 ? "" : "s");
      diag_note(d, drawn_by(k, first, o.site[0]), "the other body");
      diag_hint(d, some_contact_has(k, c.of[o.body[0]], c.of[o.body[1]])
                       ? "a `&contact` keeps them no further apart than they begin"
                   : (first->cells != NULL) != (second->cells != NULL)
                       ? "no force acts between them: a `&tie` makes a lattice and a mesh one body"
                       : "no force acts between them: move one, or cut it with a `&notch`");
    }
    contact_free(c.found);
  }
  free(of);
  free(c.of);
  free(c.stiffness);
}

double run_contacts_memory(const run_contacts *c) {
  double bytes = 0;
  for (int n = 0; n < c->count; n++)
    bytes += contact_memory(c->items[n].found);
  return bytes;
}
