#include "runtime/loads/loads.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "dsl/base/arena.h"
#include "dsl/base/elementary.h"
#include "runtime/lattice/placed_values.h"
#include "runtime/lattice/rows_select.h"
#include "runtime/loads/tributary.h"

/* NULL: a region of another lattice. */
static const region_sites *region_of(const loads *l, const char *name) {
  const int r = deck_find_region(l->deck, name);
  return r < 0 || !l->regions[r].here ? NULL : &l->regions[r];
}

/* --- motions ---------------------------------------------------------------------------------- */

typedef struct motions { /* who holds which component of which particle, while the loads are set up
                          */
  int32_t *holder;       /* [dof * particle_count]: index of the constraint + 1 */
  int dof;
  const char *law, *particle; /* the latter in words */
  diagnostics *said;
} motions;

static span motion_where(const deck *k, const constraint *c, const int *supports, long index) {
  return c->drive >= 0 ? deck_where(&k->drives[c->drive].item, "region")
                       : deck_where(&k->supports[supports[index]].item, "region");
}

static const char *place_of(const loads *l, int64_t site, char text[ROWS_PLACE_TEXT]) {
  double at[3];
  rows_place(l->lattice, site, at);
  return rows_place_text(l->lattice->dimensions, at, text);
}

/* Two supports may share a particle: both hold it where it is. Anything else is two motions at
 * once. */
static bool add_motion(loads *l, motions *m, int **supports, int32_t particle, int component,
                       int drive, int support) {
  int32_t *holder = &m->holder[(long)component * l->lattice->particle_count + particle];
  if (*holder) {
    const constraint *first = &l->constraints[*holder - 1];
    if (drive < 0 && first->drive < 0) return true;
    const deck_item *item =
        drive >= 0 ? &l->deck->drives[drive].item : &l->deck->supports[support].item;
    char text[ROWS_PLACE_TEXT];
    diag_report(m->said, DIAG_CONFLICT, deck_where(item, "region"),
                "the %s at %s has its motion in %s prescribed twice", m->particle,
                place_of(l, l->lattice->particle_site[particle], text),
                deck_component_name(l->lattice->dimensions, component));
    diag_note(m->said, motion_where(l->deck, first, *supports, *holder - 1),
              "first prescribed here");
    return false;
  }
  l->constraints =
      must_realloc(l->constraints, ((size_t)l->constraint_count + 1) * sizeof *l->constraints);
  *supports = must_realloc(*supports, ((size_t)l->constraint_count + 1) * sizeof **supports);
  (*supports)[l->constraint_count] = support;
  l->constraints[l->constraint_count] = (constraint){
      .site = l->lattice->particle_site[particle], .component = component, .drive = drive};
  *holder = (int32_t)++l->constraint_count;
  return true;
}

static bool has_component(const motions *m, int component, span where) {
  if (component < m->dof) return true;
  diag_report(m->said, DIAG_BAD_VALUE, where, "the particles of the law `%s` do not rotate",
              m->law);
  diag_hint(m->said, "only micropolar laws have rotations and moments on particles");
  return false;
}

static void add_motions(loads *l, motions *m) {
  const deck *k = l->deck;
  int *supports = NULL;
  for (int i = 0; i < k->support_count; i++) {
    const region_sites *at = region_of(l, k->supports[i].region);
    for (int c = 0; c < PL_MAX_DOF; c++) {
      if (!at || !(k->supports[i].fix & (1 << c))) continue;
      bool good = has_component(m, c, deck_where(&k->supports[i].item, "fix"));
      for (long p = 0; good && p < at->count; p++)
        good = add_motion(l, m, &supports, at->particles[p], c, -1, i);
    }
  }
  for (int i = 0; i < k->drive_count; i++) {
    const region_sites *at = region_of(l, k->drives[i].region);
    const int c = k->drives[i].component;
    bool good = at && has_component(m, c, deck_where(&k->drives[i].item, "component"));
    for (long p = 0; good && p < at->count; p++)
      good = add_motion(l, m, &supports, at->particles[p], c, i, -1);
  }
  free(supports);
}

/* --- formulas --------------------------------------------------------------------------------- */

/* What the function has of the particle when it begins. False after a message: no number. */
static bool first_value(const loads *l, const time_function *f, const deck_item *item,
                        int32_t particle, double *first, diagnostics *d) {
  double at[3];
  rows_place(l->lattice, l->lattice->particle_site[particle], at);
  const time_function here = time_function_placed(f, at);
  *first = time_function_at(&here, f->start);
  if (isfinite(*first)) return true;
  char text[ROWS_PLACE_TEXT];
  diag_report(d, DIAG_BAD_NUMBER, deck_where(item, "formula"),
              "this formula has no finite value at %s, t = 0 s",
              rows_place_text(l->lattice->dimensions, at, text));
  return false;
}

static void check_formula(const loads *l, const time_function *f, const deck_item *item,
                          const char *region, bool from_zero, diagnostics *d) {
  const region_sites *at = region_of(l, region);
  double first = 0;
  bool jumps = false;
  if (!f->formula || !at) return;
  for (long p = 0; p < at->count; p++) {
    if (!first_value(l, f, item, at->particles[p], &first, d)) return;
    jumps |= first != 0;
  }
  if (!jumps || !from_zero) return;
  diag_report(d, DIAG_DECK_WARNING, deck_where(item, "formula"),
              "this displacement begins with a jump");
  diag_hint(d, "let the formula be 0 at t = 0");
}

static void check_formulas(const loads *l, diagnostics *d) {
  const deck *k = l->deck;
  const bool moves_at_once = k->relaxation.increments == 0;
  for (int i = 0; i < k->drive_count; i++)
    check_formula(l, &k->drives[i].motion, &k->drives[i].item, k->drives[i].region,
                  moves_at_once && k->drives[i].is_displacement, d);
  for (int i = 0; i < k->force_count; i++)
    if (!k->forces[i].mesh)
      check_formula(l, &k->forces[i].force, &k->forces[i].item, k->forces[i].region, false, d);
  for (int i = 0; i < k->end_moment_count; i++)
    check_formula(l, &k->end_moments[i].moment, &k->end_moments[i].item, k->end_moments[i].region,
                  false, d);
}

/* --- forces ----------------------------------------------------------------------------------- */

static void add_force(loads *l, int32_t particle, int component, int cause, double share) {
  l->forces = must_realloc(l->forces, ((size_t)l->force_count + 1) * sizeof *l->forces);
  l->forces[l->force_count++] = (applied){.site = l->lattice->particle_site[particle],
                                          .component = component,
                                          .cause = cause,
                                          .share = share};
}

/* Nodes have no parts of a row: what one at its end has would be too much. */
static bool may_be_per_length(const loads *l, int lattice, const deck_force *f, diagnostics *d) {
  const deck_lattice *of = &l->deck->lattices[lattice];
  if (!deck_lattice_is_mesh(of)) return true;
  diag_report(d, DIAG_NOT_SUPPORTED, deck_where(&f->item, "per_length"),
              "on nodes of the mesh `%s` a force per length would be wrong at the ends of its row",
              of->name);
  diag_hint(d,
            "load a line of the mesh by a `&traction`: its `stress` is the force per length over "
            "the thickness");
  return false;
}

/* [at->count] what each particle has of the force: of a total an equal part, of one per length its
   own length, m. False after a message. */
static bool find_shares(const loads *l, int lattice, const deck_force *f, const region_sites *at,
                        double *share, diagnostics *d) {
  if (f->per_length)
    return at->count == 0 || (may_be_per_length(l, lattice, f, d) &&
                              tributary_lengths(l->deck, lattice, l->lattice, at, f->region,
                                                deck_where(&f->item, "region"), share, d));
  for (long p = 0; p < at->count; p++)
    share[p] = 1.0 / (double)at->count;
  return true;
}

static void add_forces(loads *l, int lattice, const motions *m) {
  for (int i = 0; i < l->deck->force_count; i++) {
    const deck_force *f = &l->deck->forces[i];
    const region_sites *at = f->mesh ? NULL : region_of(l, f->region);
    if (!at || !has_component(m, f->component, deck_where(&f->item, "component"))) continue;
    double *share = must_alloc(((size_t)at->count + 1) * sizeof *share);
    if (find_shares(l, lattice, f, at, share, m->said))
      for (long p = 0; p < at->count; p++)
        add_force(l, at->particles[p], f->component, i, share[p]);
    free(share);
  }
}

double loads_shares_of(const loads *l, int force, long *particles) {
  double sum = 0;
  *particles = 0;
  for (long i = 0; i < l->force_count; i++) {
    if (l->forces[i].link || l->forces[i].cause != force) continue;
    sum += l->forces[i].share;
    ++*particles;
  }
  return sum;
}

/* Moment about z of horizontal forces f at heights y: -sum y f. Without resultant and linear in y,
   counter-clockwise when positive: f = -M (y - mean)/sum (y - mean)^2. */
static void add_end_moment(loads *l, int index, diagnostics *d) {
  const deck_end_moment *e = &l->deck->end_moments[index];
  const region_sites *at = region_of(l, e->region);
  if (!at || at->count == 0) return;
  const double *y = l->lattice->y;
  double mean = 0, square = 0;
  for (long p = 0; p < at->count; p++)
    mean += y[l->lattice->particle_site[at->particles[p]]] / (double)at->count;
  for (long p = 0; p < at->count; p++) {
    const double arm = y[l->lattice->particle_site[at->particles[p]]] - mean;
    square += arm * arm;
  }
  if (sqrt(square) < 1e-6 * l->lattice->spacing) {
    diag_report(
        d, DIAG_BAD_VALUE, deck_where(&e->item, "region"),
        "the particles of region `%s` lie at one height: horizontal forces on them make no moment",
        e->region);
    diag_hint(d, "let the region reach over several rows");
    return;
  }
  for (long p = 0; p < at->count; p++)
    add_force(l, at->particles[p], 0, l->deck->force_count + index,
              -(y[l->lattice->particle_site[at->particles[p]]] - mean) / square);
}

static int by_site(const void *a, const void *b) {
  const constraint *p = a, *q = b;
  if (p->site != q->site) return p->site < q->site ? -1 : 1;
  return (p->component > q->component) - (p->component < q->component);
}

static int by_site_and_cause(const void *a, const void *b) {
  const applied *p = a, *q = b;
  if (p->site != q->site) return p->site < q->site ? -1 : 1;
  if (p->component != q->component) return p->component < q->component ? -1 : 1;
  if (p->cause != q->cause) return p->cause < q->cause ? -1 : 1;
  if (p->place != q->place) return p->place < q->place ? -1 : 1;
  return (p->link > q->link) - (p->link < q->link); /* shares of one link's forces */
}

/* No two items compare as equal. */
static void put_in_order(loads *l, const motions *m) {
  if (l->constraint_count > 0)
    qsort(l->constraints, (size_t)l->constraint_count, sizeof *l->constraints, by_site);
  if (l->force_count > 0)
    qsort(l->forces, (size_t)l->force_count, sizeof *l->forces, by_site_and_cause);
  for (long i = 0; i < l->constraint_count; i++) {
    const constraint *c = &l->constraints[i];
    const int32_t particle = l->lattice->site_particle[c->site];
    m->holder[(long)c->component * l->lattice->particle_count + particle] = (int32_t)i + 1;
  }
}

static void find_holders(loads *l, const motions *m) {
  for (long i = 0; i < l->force_count; i++) {
    applied *f = &l->forces[i];
    const int32_t particle = l->lattice->site_particle[f->site];
    f->holder = m->holder[(long)f->component * l->lattice->particle_count + particle] - 1;
  }
}

/* --- links ------------------------------------------------------------------------------------ */

void loads_add_share(loads *l, int32_t particle, int component, int force, double share) {
  add_force(l, particle, component, force, share);
}

bool loads_add_place(loads *l, const double at[3], int force, diagnostics *d) {
  const deck_force *f = &l->deck->forces[force];
  const time_function here = time_function_placed(&f->force, at);
  char text[ROWS_PLACE_TEXT];
  l->places = must_realloc(l->places, ((size_t)l->place_count + 1) * sizeof *l->places);
  memcpy(l->places[l->place_count++], at, sizeof *l->places);
  if (isfinite(time_function_at(&here, f->force.start))) return true;
  diag_report(d, DIAG_BAD_NUMBER, deck_where(&f->item, "formula"),
              "this formula has no finite value at %s, t = %g s",
              rows_place_text(l->lattice->dimensions, at, text), f->force.start);
  return false;
}

void loads_add_share_there(loads *l, int32_t particle, int component, int force, double share) {
  add_force(l, particle, component, force, share);
  l->forces[l->force_count - 1].place = l->place_count;
}

void loads_add_link(loads *l, int64_t site, int component, int link, double share,
                    const double *force) {
  l->forces = must_realloc(l->forces, ((size_t)l->force_count + 1) * sizeof *l->forces);
  l->forces[l->force_count++] =
      (applied){.site = site,
                .component = component,
                .cause = l->deck->force_count + l->deck->end_moment_count + link,
                .link = force,
                .share = share};
}

void loads_add_tie(loads *l, int64_t site, int component, int tie, double share,
                   const double *force) {
  loads_add_link(l, site, component, l->deck->lattice_count + tie, share, force);
  l->forces[l->force_count - 1].tied = 1;
}

int loads_cause_of_tie(const loads *l, int tie) {
  return l->deck->force_count + l->deck->end_moment_count + l->deck->lattice_count + tie;
}

static int64_t holder_of(const loads *l, const applied *f) {
  const constraint key = {.site = f->site, .component = f->component}, *found = NULL;
  if (l->constraint_count > 0)
    found = bsearch(&key, l->constraints, (size_t)l->constraint_count, sizeof key, by_site);
  return found ? found - l->constraints : -1;
}

void loads_links_added(loads *l) {
  if (l->force_count > 0)
    qsort(l->forces, (size_t)l->force_count, sizeof *l->forces, by_site_and_cause);
  for (long i = 0; i < l->force_count; i++)
    l->forces[i].holder = holder_of(l, &l->forces[i]);
}

/* --- point masses ----------------------------------------------------------------------------- */

static void check_point_masses(const loads *l, const motions *m) {
  const int turning = l->lattice->dimensions;
  for (int i = 0; i < l->deck->point_mass_count; i++) {
    const deck_point_mass *p = &l->deck->point_masss[i];
    if (p->inertia > 0 && region_of(l, p->region))
      has_component(m, turning, deck_where(&p->item, "inertia"));
  }
}

static double mass_of_each(const deck_point_mass *p, const region_sites *at) {
  return p->mass > 0 ? p->mass : p->total / (double)at->count;
}

void loads_point_masses(const loads *l, body *w) {
  for (int i = 0; i < l->deck->point_mass_count; i++) {
    const deck_point_mass *p = &l->deck->point_masss[i];
    const region_sites *at = region_of(l, p->region);
    for (long n = 0; at && n < at->count; n++)
      body_add_mass(w, l->lattice->particle_site[at->particles[n]], mass_of_each(p, at),
                    p->inertia);
  }
}

double loads_heaviest(const loads *l) {
  const rows *g = l->lattice;
  double *mass = must_calloc((size_t)g->size + 1, sizeof *mass), most = 0;
  for (long p = 0; p < g->particle_count; p++)
    mass[g->particle_site[p]] = g->site_mass ? g->site_mass[g->particle_site[p]] : g->mass;
  for (int i = 0; i < l->deck->point_mass_count; i++) {
    const deck_point_mass *m = &l->deck->point_masss[i];
    const region_sites *at = region_of(l, m->region);
    for (long n = 0; at && n < at->count; n++)
      mass[g->particle_site[at->particles[n]]] += mass_of_each(m, at);
  }
  for (long q = 0; q < g->size; q++)
    most = pl_fmax(most, mass[q]);
  free(mass);
  return most;
}

double loads_point_mass_of(const loads *l, int index, long *particles) {
  const deck_point_mass *p = &l->deck->point_masss[index];
  const region_sites *at = region_of(l, p->region);
  *particles = at ? at->count : 0;
  return at ? mass_of_each(p, at) * (double)at->count : 0;
}

/* --- motion at the start ---------------------------------------------------------------------- */

typedef struct initial_list { /* of one kind */
  const deck_initial *items;
  int count;
  const char *are; /* what several are called */
  bool free;       /* held particles have none */
} initial_list;

static initial_list velocities_of(const deck *k) {
  return (initial_list){k->initial_velocitys, k->initial_velocity_count, "velocities", true};
}

static initial_list displacements_of(const deck *k) {
  return (initial_list){k->initial_displacements, k->initial_displacement_count, "displacements",
                        false};
}

enum { HELD = -1 };

static void mark_held(const loads *l, int *set) {
  for (long i = 0; i < l->constraint_count; i++) {
    const constraint *c = &l->constraints[i];
    if (c->drive < 0 || l->deck->drives[c->drive].motion.start <= 0)
      set[(long)c->component * l->lattice->size + c->site] = HELD;
  }
}

/* `set` remembers which are given: [dof][size], index of the group + 1, or HELD. */
static void check_initial(const loads *l, const initial_list *list, int index, int *set,
                          diagnostics *d) {
  const deck_initial *v = &list->items[index];
  const region_sites *at = region_of(l, v->region);
  for (long p = 0; p < at->count; p++) {
    const int64_t site = l->lattice->particle_site[at->particles[p]];
    int *given = &set[(long)v->component * l->lattice->size + site];
    if (*given) {
      const bool held = *given == HELD;
      char text[ROWS_PLACE_TEXT];
      diag_report(d, DIAG_CONFLICT, deck_where(&v->item, "region"), "the particle at %s %s%s in %s",
                  place_of(l, site, text),
                  held ? "is held from the start" : "is given two initial ", held ? "" : list->are,
                  deck_component_name(l->lattice->dimensions, v->component));
      if (!held) diag_note(d, list->items[*given - 1].item.where, "the other one");
      return;
    }
    *given = index + 1;
  }
  free(placed_values(&v->value, l->lattice, at->particles, at->count,
                     deck_where(&v->item, v->value.path ? "file" : "value"), d));
}

static void check_initials(const loads *l, const motions *m, initial_list list) {
  int *set = must_calloc((size_t)m->dof * (size_t)l->lattice->size + 1, sizeof *set);
  if (list.free) mark_held(l, set);
  for (int i = 0; i < list.count; i++) {
    const deck_initial *v = &list.items[i];
    if (region_of(l, v->region) &&
        has_component(m, v->component, deck_where(&v->item, "component")))
      check_initial(l, &list, i, set, m->said);
  }
  free(set);
}

/* --- set-up ----------------------------------------------------------------------------------- */

static void protect(loads *l, rows *w) {
  for (int i = 0; i < l->deck->protect_count; i++) {
    const deck_protect *p = &l->deck->protects[i];
    const region_sites *at = region_of(l, p->region);
    if (at) rows_protect(w, at->particles, at->count, p->radius * w->spacing);
  }
}

loads *loads_new(const deck *k, int lattice, rows *w, const char *law, int dof, diagnostics *d) {
  const int before = d->errors;
  loads *l = must_calloc(1, sizeof *l);
  l->deck = k;
  l->lattice = w;
  l->gives_way =
      deck_lattice_is_mesh(&k->lattices[lattice]) && k->newmark.motion == MOTION_VELOCITY_ONLY;
  l->regions = regions_select(k, k->lattices[lattice].name, w, d);
  motions m = {
      .dof = dof, .law = law, .particle = deck_particle_word(&k->lattices[lattice]), .said = d};
  m.holder = must_calloc((size_t)dof * (size_t)w->particle_count + 1, sizeof *m.holder);
  add_motions(l, &m);
  add_forces(l, lattice, &m);
  for (int i = 0; i < k->end_moment_count; i++)
    add_end_moment(l, i, d);
  put_in_order(l, &m);
  find_holders(l, &m);
  check_initials(l, &m, velocities_of(k));
  check_initials(l, &m, displacements_of(k));
  check_formulas(l, d);
  check_point_masses(l, &m);
  protect(l, w);
  free(m.holder);
  if (d->errors == before) return l;
  loads_free(l);
  return NULL;
}

void loads_free(loads *l) {
  if (!l) return;
  regions_free(l->deck, l->regions);
  free(l->constraints);
  free(l->forces);
  free(l->places);
  free(l->goes_on);
  free(l);
}

/* [size of the rows]: 1 at the sites of a region's particles. */
static unsigned char *marked_sites(const loads *l, int region) {
  const region_sites *at = &l->regions[region];
  unsigned char *inside = must_calloc((size_t)l->lattice->size, 1);
  for (long p = 0; p < at->count; p++)
    inside[l->lattice->particle_site[at->particles[p]]] = 1;
  return inside;
}

long loads_constraints_of(const loads *l, int region, int component, int32_t **indices) {
  long count = 0;
  *indices = must_calloc((size_t)l->constraint_count + 1, sizeof **indices);
  unsigned char *inside = marked_sites(l, region);
  for (long c = 0; c < l->constraint_count; c++)
    if (inside[l->constraints[c].site] && l->constraints[c].component == component)
      (*indices)[count++] = (int32_t)c;
  free(inside);
  return count;
}

long loads_forces_of(const loads *l, int region, int component, int32_t **indices) {
  long count = 0;
  *indices = must_calloc((size_t)l->force_count + 1, sizeof **indices);
  unsigned char *inside = marked_sites(l, region);
  for (long f = 0; f < l->force_count; f++)
    if (inside[l->forces[f].site] && l->forces[f].component == component)
      (*indices)[count++] = (int32_t)f;
  free(inside);
  return count;
}

/* --- motion at the start ---------------------------------------------------------------------- */

/* Into [component][site]. */
static bool set_initial(const loads *l, const deck_initial *v, double *const *into,
                        diagnostics *d) {
  const region_sites *at = region_of(l, v->region);
  if (!at) return true;
  double *values = placed_values(&v->value, l->lattice, at->particles, at->count,
                                 deck_where(&v->item, v->value.path ? "file" : "value"), d);
  for (long p = 0; values && p < at->count; p++)
    into[v->component][l->lattice->particle_site[at->particles[p]]] = values[p];
  free(values);
  return values != NULL;
}

static bool fits_a_step(const loads *l, const deck_initial *v, const body *w, diagnostics *d) {
  const region_sites *at = region_of(l, v->region);
  for (long p = 0; at && p < at->count; p++) {
    const int64_t site = l->lattice->particle_site[at->particles[p]];
    if (fabs(w->velocity[v->component][site]) < w->limit[v->component]) continue;
    diag_report(d, DIAG_OUT_OF_BOUNDS, deck_where(&v->item, v->value.path ? "file" : "value"),
                "this velocity takes a particle further than %s in one step",
                v->component < w->dimensions ? "a spacing" : "half a turn");
    return false;
  }
  return true;
}

bool loads_initial_motion(const loads *l, body *w, diagnostics *d) {
  const initial_list displacements = displacements_of(l->deck), velocities = velocities_of(l->deck);
  bool good = true;
  for (int i = 0; i < displacements.count; i++)
    good = set_initial(l, &displacements.items[i], w->displacement, d) && good;
  for (int i = 0; i < velocities.count; i++)
    good = set_initial(l, &velocities.items[i], w->velocity, d) &&
           fits_a_step(l, &velocities.items[i], w, d) && good;
  return good;
}
