#include "runtime/parts/run_start.h"

#include <assert.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "dsl/base/arena.h"
#include "dsl/base/elementary.h"
#include "dsl/base/hash.h"
#include "runtime/deck/lattice_kind.h"
#include "runtime/lattice/near_particles.h"

enum { ENDS = 2 };

/* --- taking it -------------------------------------------------------------------------------- */

/* [particles][dof] of [dof][size]. */
static double *gather(const run_body *b, double *const *from, bool at_rest) {
  const rows *g = b->lattice_rows;
  const int dof = b->body->dof;
  double *values = must_calloc((size_t)g->particle_count * (size_t)dof + 1, sizeof *values);
  for (long p = 0; p < g->particle_count && !at_rest; p++)
    for (int c = 0; c < dof; c++)
      values[p * dof + c] = from[c][g->particle_site[p]];
  return values;
}

/* The deck's; where that is graded the smallest. */
static double spacing_of(const run_body *b, const deck *k) {
  return b->lattice_rows->own_size ? b->lattice_rows->spacing : k->lattices[b->lattice].spacing;
}

/* "hexagonal", "hexagonal with exact edges"; to be freed. */
static char *kind_of(const deck_lattice *l) {
  static const char exact[] = " with exact edges";
  char *kind = must_alloc(strlen(l->kind) + sizeof exact);
  sprintf(kind, "%s%s", l->kind, l->edges == EDGES_EXACT ? exact : "");
  return kind;
}

static state_body take_body(const run_body *b, const deck *k, double step) {
  const deck_lattice *l = &k->lattices[b->lattice];
  return (state_body){.lattice = must_copy(b->name),
                      .kind = kind_of(l),
                      .spacing = spacing_of(b, k),
                      .first = b->first_particle,
                      .count = b->lattice_rows->particle_count,
                      .dof = b->body->dof,
                      .displacement = gather(b, b->body->displacement, false),
                      .velocity = gather(b, b->body->velocity, step == 0)};
}

/* Where a field of a law has its values: a row of the table is a particle's or a bond's. */
typedef struct field_shape {
  bool on_particles;
  long count;
  int columns;
} field_shape;

static field_shape shape_of(const run_law *l, int field) {
  if (l->law->kind != PL_STATE) return (field_shape){false, l->rows->bond_count, 1};
  if (l->law->fields[field].place == PL_ON_PARTICLE)
    return (field_shape){true, l->rows->particle_count, 1};
  return (field_shape){false, l->rows->bond_count, ENDS};
}

/* Of a row and a column of the table: where it stands in the field. */
static long place_in(const run_law *l, const field_shape *shape, long row, int column) {
  const rows *g = l->rows;
  if (shape->on_particles) return g->particle_site[row];
  const rows_bond *bond = &l->bonds[row];
  if (column == 0) return bond->slot;
  return (bond->slot / g->size + g->directions) * g->size + g->particle_site[bond->j];
}

static state_field take_field(const run_law *l, int field) {
  const field_shape shape = shape_of(l, field);
  state_field f = {.name = must_copy(l->law->fields[field].name),
                   .unit = l->law->fields[field].unit,
                   .count = shape.count,
                   .columns = shape.columns};
  f.values = must_calloc((size_t)(shape.count * shape.columns) + 1, sizeof *f.values);
  for (long m = 0; m < shape.count; m++)
    for (int c = 0; c < shape.columns; c++)
      f.values[m * shape.columns + c] = l->state->field[field][place_in(l, &shape, m, c)];
  return f;
}

/* Where a contact keeps the distances at which bonds of that body were lost; NULL where it does
   not. */
static double *lost_of(const run_contact *c, int number) {
  size_t size;
  for (int side = 0; side < c->count; side++)
    if (c->of[side] == number) return contact_lost(c->found, side, &size);
  return NULL;
}

static state_field take_lost(const run_law *l, const char *name, const double *lost) {
  state_field f = {
      .name = must_copy(name), .unit = "m", .count = l->rows->bond_count, .columns = 1};
  f.values = must_calloc((size_t)f.count + 1, sizeof *f.values);
  for (long m = 0; m < f.count; m++)
    f.values[m] = lost[l->bonds[m].slot];
  return f;
}

static state_law take_law(const run_law *l, int body_number, const run_contacts *contacts) {
  const int count = l->law->field_count;
  state_law taken = {.interaction = must_copy(l->from->name), .law = must_copy(l->law->name)};
  taken.fields = must_calloc((size_t)count + 1, sizeof *taken.fields);
  for (int f = 0; f < count; f++)
    taken.fields[taken.field_count++] = take_field(l, f);
  taken.lost = must_calloc((size_t)contacts->count + 1, sizeof *taken.lost);
  for (int k = 0; k < contacts->count; k++) {
    const double *lost = lost_of(&contacts->items[k], body_number);
    if (lost) taken.lost[taken.lost_count++] = take_lost(l, contacts->items[k].from->name, lost);
  }
  return taken;
}

/* [particles][dimensions], of the body of that number of the stamp's. */
static state_field take_dragged(const run_stamp *of, int number, const run_body *b) {
  const long count = b->lattice_rows->particle_count;
  const int columns = b->body->dimensions;
  const double *dragged = stamp_dragged_of(of->found, number);
  state_field f = {.name = must_copy(b->name), .unit = "m", .count = count, .columns = columns};
  f.values = must_calloc((size_t)(count * columns) + 1, sizeof *f.values);
  for (long p = 0; p < count; p++)
    for (int c = 0; c < columns; c++)
      f.values[p * columns + c] = dragged[c * count + p];
  return f;
}

static_assert((int)STATE_SURFACE == (int)SURFACE_NUMBERS, "a result has all that a surface is");

/* Where it is drawn. */
static void numbers_of(const run_stamp *of, double numbers[SURFACE_NUMBERS]) {
  surface drawn;
  surface_open(&of->from->shape, &drawn);
  surface_numbers(&drawn, numbers);
}

static state_stamp take_stamp(const run_stamp *of, const run_body *bodies, bool at_rest) {
  state_stamp s = {.name = must_copy(of->from->name)};
  s.dragged = must_calloc((size_t)of->count + 1, sizeof *s.dragged);
  numbers_of(of, s.surface);
  for (int c = 0; c < 3; c++) {
    s.place[c] = of->state.at.place[c];
    s.velocity[c] = at_rest ? 0 : of->state.at.velocity[c];
  }
  for (int n = 0; n < of->count && stamp_dragged_of(of->found, n); n++)
    s.dragged[s.dragged_count++] = take_dragged(of, n, &bodies[of->of[n]]);
  return s;
}

result_state *run_state_take(const run_body *bodies, int count, const run_contacts *contacts,
                             const run_stamps *stamps, const deck *k, double step) {
  result_state *s = must_calloc(1, sizeof *s);
  s->step = step;
  s->dimensions = bodies[0].body->dimensions;
  s->bodies = must_calloc((size_t)count + 1, sizeof *s->bodies);
  s->laws = must_calloc((size_t)k->interaction_count + 1, sizeof *s->laws);
  for (int b = 0; b < count; b++) {
    if (!run_body_is_link(&bodies[b])) s->bodies[s->body_count++] = take_body(&bodies[b], k, step);
    for (int n = 0; n < bodies[b].law_count; n++)
      s->laws[s->law_count++] = take_law(&bodies[b].laws[n], b, contacts);
  }
  s->stamps = must_calloc((size_t)stamps->count + 1, sizeof *s->stamps);
  for (int n = 0; n < stamps->count; n++)
    s->stamps[s->stamp_count++] = take_stamp(&stamps->items[n], bodies, step == 0);
  return s;
}

/* --- whose it is ------------------------------------------------------------------------------ */

/* A start at work. */
typedef struct starting {
  run_body *bodies;
  int count;
  const run_contacts *contacts;
  run_stamps *stamps;
  const deck *deck;
  const result_state *from;
  int32_t *former; /* [particles of the run] that of the result, or -1 */
  span where;
  diagnostics *d;
} starting;

static const char *name_of(const starting *s) {
  return s->deck->start.result;
}

static const state_body *body_named(const starting *s, const char *lattice) {
  for (int b = 0; b < s->from->body_count; b++)
    if (strcmp(s->from->bodies[b].lattice, lattice) == 0) return &s->from->bodies[b];
  return NULL;
}

static const state_law *law_named(const starting *s, const char *interaction) {
  for (int n = 0; n < s->from->law_count; n++)
    if (strcmp(s->from->laws[n].interaction, interaction) == 0) return &s->from->laws[n];
  return NULL;
}

static bool same_size(double a, double b) {
  return fabs(a - b) <= 1e-9 * fabs(a);
}

/* On no lattice particles of either kind may be those of the result. */
static bool same_kind(const deck_lattice *l, const char *kind, const char *here) {
  const deck_lattice other = {.kind = kind};
  if (strcmp(here, kind) == 0) return true;
  return deck_lattice_is_irregular(l) && deck_lattice_is_irregular(&other);
}

static bool lattice_fits(const starting *s, const run_body *b, const state_body *from) {
  const deck_lattice *l = &s->deck->lattices[b->lattice];
  char *kind = kind_of(l);
  const bool alike = same_kind(l, from->kind, kind);
  if (!alike) {
    diag_report(s->d, DIAG_CONFLICT, s->where, "`%s` is %s in `%s`, and %s in this deck", b->name,
                from->kind, name_of(s), kind);
    diag_hint(s->d, "give it the `%s` that it has in the result's deck, or another name",
              strncmp(kind, from->kind, strlen(l->kind)) == 0 ? "edges" : "kind");
  }
  free(kind);
  if (!alike) return false;
  if (!same_size(spacing_of(b, s->deck), from->spacing)) {
    diag_report(s->d, DIAG_CONFLICT, s->where,
                "`%s` has a spacing of %.6g mm in `%s`, and of %.6g mm in this deck", b->name,
                1e3 * from->spacing, name_of(s), 1e3 * spacing_of(b, s->deck));
    diag_hint(s->d, "give it the `spacing` of the result's deck, or another name");
    return false;
  }
  return true;
}

static bool motion_fits(const starting *s, const run_body *b, const state_body *from) {
  if (b->body->dof == from->dof && b->body->dimensions == s->from->dimensions) return true;
  diag_report(s->d, DIAG_CONFLICT, s->where,
              "particles of `%s` move in %d components in `%s`, and in %d in this deck", b->name,
              from->dof, name_of(s), b->body->dof);
  diag_hint(s->d, "give it the law of the result's deck, or another name");
  return false;
}

static const state_field *named(const state_field *fields, int count, const char *name) {
  for (int f = 0; f < count; f++)
    if (strcmp(fields[f].name, name) == 0) return &fields[f];
  return NULL;
}

static const state_field *field_named(const state_law *l, const char *name) {
  return named(l->fields, l->field_count, name);
}

/* Rows and columns are those of the result's particles and bonds. */
static bool field_fits(const run_law *l, int field, const state_law *from, const state_body *of) {
  const field_shape shape = shape_of(l, field);
  const state_field *f = field_named(from, l->law->fields[field].name);
  const long rows_there = shape.on_particles ? of ? of->count : 0 : from->bond_count;
  return f && f->columns == shape.columns && f->count == rows_there;
}

static bool law_fits_state(const starting *s, const run_body *b, const run_law *l) {
  const state_law *from = law_named(s, l->from->name);
  if (!from) return true;
  bool same = from->field_count == l->law->field_count;
  for (int f = 0; f < l->law->field_count && same; f++)
    same = field_fits(l, f, from, body_named(s, b->name));
  if (strcmp(from->law, l->law->name) != 0)
    diag_report(s->d, DIAG_CONFLICT, s->where,
                "`%s` has the law `%s` in `%s`, and `%s` in this deck", l->from->name, from->law,
                name_of(s), l->law->name);
  else if (!same)
    diag_report(s->d, DIAG_CONFLICT, s->where,
                "the law `%s` of `%s` has other states and damage in `%s` than in this deck",
                l->law->name, l->from->name, name_of(s));
  else
    return true;
  diag_hint(s->d, "give it the law of the result's deck; values of parameters may differ");
  return false;
}

/* --- particles -------------------------------------------------------------------------------- */

/* The nearest of the particles found, if it is there; else -1. */
static int32_t particle_at(near_particles *near, const double at[3], double spacing) {
  static const double there = 1e-6;
  double least = there * spacing * (there * spacing);
  int32_t nearest = -1;
  near_particles_find(near, at);
  for (long n = 0; n < near->count; n++)
    if (near->found[n].square <= least) {
      least = near->found[n].square;
      nearest = near->found[n].particle;
    }
  return nearest;
}

static void match_particles(const starting *s, run_body *b, const state_body *from) {
  const double spacing = from->spacing;
  near_particles near = near_particles_of(b->lattice_rows, 0.25 * spacing);
  for (long p = 0; p < from->count; p++) {
    const double *rest = s->from->reference + (from->first + p) * s->from->dimensions;
    const double at[3] = {rest[0], rest[1], s->from->dimensions > 2 ? rest[2] : 0};
    const int32_t here = particle_at(&near, at, spacing);
    if (here < 0) continue;
    s->former[b->first_particle + here] = (int32_t)(from->first + p);
    b->going.particles++;
  }
  near_particles_end(&near);
  b->going.new_particles = run_body_particles(b) - b->going.particles;
  b->going.gone_particles = from->count - b->going.particles;
}

static void move_particles(const starting *s, run_body *b, const state_body *from) {
  const rows *g = b->lattice_rows;
  const bool at_rest = s->deck->relaxation.increments > 0;
  b->loads->goes_on = must_calloc((size_t)g->size, 1);
  b->loads->former_step = s->from->step;
  for (long p = 0; p < g->particle_count; p++) {
    const long there = s->former[b->first_particle + p] - from->first, q = g->particle_site[p];
    if (s->former[b->first_particle + p] < 0) continue;
    b->loads->goes_on[q] = 1;
    for (int c = 0; c < from->dof; c++) {
      b->body->displacement[c][q] = from->displacement[there * from->dof + c];
      if (!at_rest) b->body->velocity[c][q] = from->velocity[there * from->dof + c];
    }
  }
}

static bool start_body(const starting *s, run_body *b) {
  const state_body *from = body_named(s, b->name);
  if (!from) {
    b->going.new_particles = run_body_particles(b);
    return true;
  }
  if (!motion_fits(s, b, from)) return false;
  match_particles(s, b, from);
  if (b->going.particles == 0) {
    diag_report(s->d, DIAG_CONFLICT, s->where,
                "no particle of `%s` stands where one of it stands in `%s`", b->name, name_of(s));
    diag_hint(s->d, deck_lattice_is_irregular(&s->deck->lattices[b->lattice])
                        ? "particles on no lattice are the same ones where their `file` is the "
                          "result"
                        : "give the lattice the `origin` and the `rotation` of the result's deck");
    return false;
  }
  move_particles(s, b, from);
  return true;
}

/* --- bonds ------------------------------------------------------------------------------------ */

typedef struct known_bond { /* of the result */
  int32_t i, j;
  long number;
} known_bond;

static int by_particles(const void *p, const void *q) {
  const known_bond *a = p, *b = q;
  if (a->i != b->i) return a->i < b->i ? -1 : 1;
  if (a->j != b->j) return a->j < b->j ? -1 : 1;
  return (a->number > b->number) - (a->number < b->number);
}

static known_bond *sorted_bonds(const state_law *from) {
  known_bond *bonds = must_calloc((size_t)from->bond_count + 1, sizeof *bonds);
  for (long m = 0; m < from->bond_count; m++)
    bonds[m] = (known_bond){from->pairs[2 * m], from->pairs[2 * m + 1], m};
  qsort(bonds, (size_t)from->bond_count, sizeof *bonds, by_particles);
  return bonds;
}

static long find_bond(const known_bond *bonds, long count, int32_t i, int32_t j) {
  long low = 0, high = count;
  while (low < high) {
    const long middle = low + (high - low) / 2;
    const known_bond *m = &bonds[middle];
    if (m->i < i || (m->i == i && m->j < j))
      low = middle + 1;
    else
      high = middle;
  }
  return low < count && bonds[low].i == i && bonds[low].j == j ? bonds[low].number : -1;
}

/* The particle of the result that goes on as this end of a bond; of a link's as that which its copy
   follows, for a place between several the heaviest. */
static int32_t former_of(const starting *s, const run_body *b, int32_t particle) {
  const rows_copy *copy = run_body_is_link(b) ? &b->lattice_rows->copies[particle] : NULL;
  const run_body *of = b;
  for (int n = 0; n < s->count && copy; n++)
    if (s->bodies[n].lattice == copy->lattice) of = &s->bodies[n];
  return s->former[of->first_particle + (copy ? copy->particle[0] : particle)];
}

/* A contact that the result does not have finds lost bonds where they are now. */
static void put_lost(const starting *s, const run_body *b, const state_law *from, int64_t slot,
                     long there) {
  for (int k = 0; k < s->contacts->count; k++) {
    const run_contact *c = &s->contacts->items[k];
    const state_field *was = named(from->lost, from->lost_count, c->from->name);
    double *lost = was ? lost_of(c, (int)(b - s->bodies)) : NULL;
    if (lost) lost[slot] = was->values[there];
  }
}

static void put_bond(const run_law *l, const state_law *from, long here, long there, bool turned) {
  for (int f = 0; f < l->law->field_count; f++) {
    const field_shape shape = shape_of(l, f);
    const state_field *field = field_named(from, l->law->fields[f].name);
    for (int c = 0; c < shape.columns && !shape.on_particles; c++)
      l->state->field[f][place_in(l, &shape, here, c)] =
          field->values[there * shape.columns + (turned ? shape.columns - 1 - c : c)];
  }
}

static void start_bonds(const starting *s, run_body *b, const run_law *l, const state_law *from) {
  known_bond *known = sorted_bonds(from);
  long kept = 0;
  for (long m = 0; m < l->rows->bond_count; m++) {
    const int32_t i = former_of(s, b, l->bonds[m].i), j = former_of(s, b, l->bonds[m].j);
    if (i < 0 || j < 0) continue;
    long there = find_bond(known, from->bond_count, i, j);
    const bool turned = there < 0;
    if (turned) there = find_bond(known, from->bond_count, j, i);
    if (there < 0) continue;
    put_bond(l, from, m, there, turned);
    put_lost(s, b, from, l->bonds[m].slot, there);
    kept++;
  }
  free(known);
  b->going.bonds += kept;
  b->going.new_bonds += l->rows->bond_count - kept;
  b->going.gone_bonds += from->bond_count - kept;
}

static void start_fields_of_particles(const starting *s, const run_body *b, const run_law *l,
                                      const state_law *from) {
  const state_body *of = body_named(s, b->name);
  for (int f = 0; f < l->law->field_count && of; f++) {
    if (!shape_of(l, f).on_particles) continue;
    const state_field *field = field_named(from, l->law->fields[f].name);
    for (long p = 0; p < l->rows->particle_count; p++) {
      const int32_t there = s->former[b->first_particle + p];
      if (there >= 0)
        l->state->field[f][l->rows->particle_site[p]] = field->values[there - of->first];
    }
  }
}

static void start_laws(const starting *s, run_body *b) {
  for (int n = 0; n < b->law_count; n++) {
    const run_law *l = &b->laws[n];
    const state_law *from = law_named(s, l->from->name);
    if (!from) {
      b->going.new_bonds += l->rows->bond_count;
      continue;
    }
    start_bonds(s, b, l, from);
    if (!run_body_is_link(b)) start_fields_of_particles(s, b, l, from);
  }
  sweep_fields_set(b->state);
}

/* --- all -------------------------------------------------------------------------------------- */

static bool laws_fit_state(const starting *s) {
  bool good = true;
  for (int b = 0; b < s->count; b++)
    for (int n = 0; n < s->bodies[b].law_count; n++)
      good = law_fits_state(s, &s->bodies[b], &s->bodies[b].laws[n]) && good;
  return good;
}

static bool lattices_fit(const starting *s) {
  bool good = true;
  for (int b = 0; b < s->count; b++) {
    const state_body *from = body_named(s, s->bodies[b].name);
    good = (!from || lattice_fits(s, &s->bodies[b], from)) && good;
  }
  return good;
}

static bool has_namesakes(const starting *s) {
  for (int b = 0; b < s->count; b++)
    if (body_named(s, s->bodies[b].name)) return true;
  diag_report(s->d, DIAG_CONFLICT, s->where, "`%s` has no lattice of this deck: it has `%s`%s",
              name_of(s), s->from->bodies[0].lattice, s->from->body_count > 1 ? " and others" : "");
  diag_hint(s->d, "give the lattice the name that it has in the result's deck");
  return false;
}

/* What goes on has a motion already. */
static bool motion_is_free(const starting *s, const deck_initial *items, int count,
                           const char *what) {
  for (int n = 0; n < count; n++)
    for (int b = 0; b < s->count; b++) {
      const run_body *of = &s->bodies[b];
      const region_sites *at = &of->loads->regions[deck_find_region(s->deck, items[n].region)];
      for (long p = 0; p < at->count && of->loads->goes_on; p++) {
        if (!of->loads->goes_on[of->lattice_rows->particle_site[at->particles[p]]]) continue;
        diag_report(s->d, DIAG_CONFLICT, deck_where(&items[n].item, "region"),
                    "particles of `%s` go on from `%s` with the %s that they have there",
                    items[n].region, name_of(s), what);
        diag_hint(s->d, "give it to particles that are new in this deck, or load the others");
        return false;
      }
    }
  return true;
}

/* --- stamps ----------------------------------------------------------------------------------- */

static void start_dragged(const starting *s, run_stamp *of, const state_stamp *from) {
  for (int n = 0; n < of->count; n++) {
    const run_body *b = &s->bodies[of->of[n]];
    const long count = b->lattice_rows->particle_count;
    double *dragged = stamp_dragged_of(of->found, n);
    const state_field *was = named(from->dragged, from->dragged_count, b->name);
    const state_body *there = body_named(s, b->name);
    for (long p = 0; p < count && dragged && was && there; p++) {
      const long former = s->former[b->first_particle + p] - there->first;
      for (int c = 0; c < was->columns && former >= 0; c++)
        dragged[c * count + p] = was->values[former * was->columns + c];
    }
  }
}

static const state_stamp *former_stamp(const starting *s, const run_stamp *of) {
  for (int n = 0; n < s->from->stamp_count; n++)
    if (strcmp(s->from->stamps[n].name, of->from->name) == 0) return &s->from->stamps[n];
  return NULL;
}

/* A guided one leaves what it had across its way; one that had been guided already keeps its
   bits. */
static void guide(run_stamp *of) {
  double *v = of->state.at.velocity, along = 0, across = 0;
  const double *way = of->from->direction;
  for (int c = 0; c < 3; c++)
    along += v[c] * way[c];
  for (int c = 0; c < 3; c++)
    across = pl_fmax(across, fabs(v[c] - along * way[c]));
  for (int c = 0; c < 3 && across > 1e-12 * fabs(along); c++)
    v[c] = along * way[c];
}

static void start_stamp(const starting *s, run_stamp *of, const state_stamp *from) {
  of->goes_on = true;
  of->former_step = s->from->step;
  for (int c = 0; c < 3; c++) {
    of->start[c] = of->state.at.place[c] = from->place[c];
    of->state.at.velocity[c] = from->velocity[c];
  }
  if (of->from->guided) guide(of);
  start_dragged(s, of, from);
}

/* Its place counts from there. */
static bool is_drawn_there(const starting *s, const run_stamp *of, const state_stamp *from) {
  double now[SURFACE_NUMBERS];
  numbers_of(of, now);
  if (surface_is_alike(now, from->surface)) return true;
  diag_report(s->d, DIAG_CONFLICT, deck_where(&of->from->item, "shape"),
              "the stamp `%s` goes on from `%s`, where it is drawn with another shape or elsewhere",
              of->from->name, name_of(s));
  diag_hint(s->d, "draw it as there: it begins where it was at the end; or give it another name");
  return false;
}

/* A stamp that goes on has the velocity that it has there. */
static bool stamps_go_on(const starting *s) {
  bool good = true;
  for (int n = 0; n < s->stamps->count; n++) {
    run_stamp *of = &s->stamps->items[n];
    const state_stamp *from = former_stamp(s, of);
    if (!from) continue;
    good = is_drawn_there(s, of, from) && good;
    start_stamp(s, of, from);
    if (of->from->mass == 0 || !deck_is_written(&of->from->item, "velocity")) continue;
    diag_report(s->d, DIAG_CONFLICT, deck_where(&of->from->item, "velocity"),
                "the stamp `%s` goes on from `%s` with the velocity that it has there",
                of->from->name, name_of(s));
    diag_hint(s->d, "leave `velocity` away, or give the stamp another name");
    good = false;
  }
  return good;
}

static bool start_all(const starting *s) {
  bool good = has_namesakes(s) && lattices_fit(s) && laws_fit_state(s);
  for (int b = 0; b < s->count && good; b++)
    if (!run_body_is_link(&s->bodies[b])) good = start_body(s, &s->bodies[b]);
  if (!good) return false;
  for (int b = 0; b < s->count; b++)
    start_laws(s, &s->bodies[b]);
  const deck *k = s->deck;
  return stamps_go_on(s) &&
         motion_is_free(s, k->initial_velocitys, k->initial_velocity_count, "velocity") &&
         motion_is_free(s, k->initial_displacements, k->initial_displacement_count, "displacement");
}

static uint64_t hash_fields(uint64_t sum, const state_field *fields, int count) {
  for (int f = 0; f < count; f++)
    sum = hash_more(sum, fields[f].values,
                    (size_t)fields[f].count * (size_t)fields[f].columns * sizeof(double));
  return sum;
}

static uint64_t hash_of(const result_state *s) {
  uint64_t sum = hash_more(HASH_START, &s->step, sizeof s->step);
  for (int b = 0; b < s->body_count; b++) {
    const size_t bytes = (size_t)s->bodies[b].count * (size_t)s->bodies[b].dof * sizeof(double);
    sum = hash_more(hash_more(sum, s->bodies[b].displacement, bytes), s->bodies[b].velocity, bytes);
  }
  for (int n = 0; n < s->law_count; n++) {
    sum = hash_fields(sum, s->laws[n].fields, s->laws[n].field_count);
    sum = hash_fields(sum, s->laws[n].lost, s->laws[n].lost_count);
  }
  for (int n = 0; n < s->stamp_count; n++) {
    sum = hash_more(sum, s->stamps[n].place, sizeof s->stamps[n].place);
    sum = hash_more(sum, s->stamps[n].velocity, sizeof s->stamps[n].velocity);
    sum = hash_fields(sum, s->stamps[n].dragged, s->stamps[n].dragged_count);
  }
  return sum;
}

/* NULL after a message. */
static result_state *read_state(const char *path, span where, diagnostics *d) {
  char error[2048];
  bool missing = false;
  result_file *f = result_read(path, error, sizeof error);
  if (!f) {
    diag_report(d, DIAG_FILE, where, "%s", error);
    diag_hint(
        d, "the path is from the working folder; where it is right, run the result's deck again");
    return NULL;
  }
  result_state *s = result_state_read(f, &missing, error, sizeof error);
  result_read_close(f);
  if (s) return s;
  diag_report(d, DIAG_FILE, where, "`%s` %s", path, error);
  diag_hint(d, missing ? "run its deck again with `state = .true.` in &output: frames alone do not "
                         "hold all that a run needs to go on"
                       : "copy it again from where it was whole, or run its deck again");
  return NULL;
}

bool run_start(run_body *bodies, int count, const run_contacts *contacts, run_stamps *stamps,
               const deck *k, uint64_t *fingerprint, diagnostics *d) {
  if (!k->start.result) return true;
  const span where = deck_where(&k->start.item, "result");
  result_state *from = read_state(k->start.result, where, d);
  if (!from) return false;
  long particles = 0;
  for (int b = 0; b < count; b++)
    particles += run_body_particles(&bodies[b]);
  starting s = {.bodies = bodies,
                .count = count,
                .contacts = contacts,
                .stamps = stamps,
                .deck = k,
                .from = from,
                .where = where,
                .d = d};
  s.former = must_alloc(((size_t)particles + 1) * sizeof *s.former);
  for (long p = 0; p < particles; p++)
    s.former[p] = -1;
  const bool good = start_all(&s);
  *fingerprint = hash_of(from);
  free(s.former);
  result_state_free(from);
  return good;
}
