#include "runtime/simulation/frames.h"

#include <math.h>
#include <stdlib.h>
#include <strings.h>

#include "dsl/base/arena.h"
#include "runtime/deck/deck_value.h"
#include "runtime/deck/output_fields.h"
#include "runtime/interaction/damage.h"
#include "runtime/simulation/load_steps.h"

typedef struct frame_source frame_source;
typedef void values_of(const frames_of *of, const frame_source *from, double *values);

struct frame_source { /* where a frame field comes from */
  values_of *values;
  int components;
  int index; /* of the law's fields, outputs, or parameters that differ from bond to bond */
};

struct frame_set {
  frames_of of;
  frame_field *fields;
  frame_source *sources;
  int count;
};

/* --- values ----------------------------------------------------------------------------------- */

static void site_values(const frames_of *of, double *const *arrays, int components,
                        double *values) {
  const rows *g = of->state->body->lattice;
  for (long p = 0; p < g->particle_count; p++)
    for (int c = 0; c < components; c++)
      values[p * components + c] = arrays[c][g->particle_site[p]];
}

static void bond_values(const frames_of *of, const double *array, double *values) {
  for (long b = 0; b < of->state->body->lattice->bond_count; b++)
    values[b] = sweep_bond_value(of->state, array, &of->bonds[b]);
}

static bool on_bonds(const pl_field *f) {
  return f->place != PL_ON_PARTICLE;
}

/* Of the law, on particles or on bonds. */
static void law_values(const frames_of *of, const pl_field *field, double *array, double *values) {
  if (on_bonds(field))
    bond_values(of, array, values);
  else
    site_values(of, &array, 1, values);
}

static void values_of_state(const frames_of *of, const frame_source *from, double *values) {
  law_values(of, &of->state->law->fields[from->index], of->state->new_field[from->index], values);
}

static void values_of_output(const frames_of *of, const frame_source *from, double *values) {
  const pl_field *field = &of->state->law->outputs[from->index];
  const size_t planes = (size_t)sweep_planes(of->state, field->place);
  double *array = must_calloc(planes * (size_t)of->state->body->lattice->size, sizeof *array);
  sweep_output(of->state, from->index, array);
  law_values(of, field, array, values);
  free(array);
}

static void values_of_parameter(const frames_of *of, const frame_source *from, double *values) {
  bond_values(of, of->parameter[from->index], values);
}

/* --- fields of any law ------------------------------------------------------------------------ */

static void values_of_displacement(const frames_of *of, const frame_source *from, double *values) {
  site_values(of, of->state->body->displacement, from->components, values);
}

static void values_of_velocity(const frames_of *of, const frame_source *from, double *values) {
  const rows *g = of->state->body->lattice;
  for (long p = 0; p < g->particle_count; p++)
    for (int c = 0; c < from->components; c++)
      values[p * from->components + c] = load_steps_velocity(
          of->loads, of->state->body, c, g->particle_site[p], (long)of->clock->at.step);
}

static void values_of_rotation(const frames_of *of, const frame_source *from, double *values) {
  const body *w = of->state->body;
  site_values(of, w->displacement + w->dimensions, from->components, values);
}

static void values_of_force(const frames_of *of, const frame_source *from, double *values) {
  site_values(of, of->state->body->force, from->components, values);
}

static void values_of_damage(const frames_of *of, const frame_source *from, double *values) {
  (void)from;
  damage_of_particles(of->state, of->bonds, values);
}

/* Energy lost in the bonds that a particle owns (those to the right and above). */
static void values_of_dissipated(const frames_of *of, const frame_source *from, double *values) {
  const sweep *w = of->state;
  (void)from;
  for (long p = 0; p < w->body->lattice->particle_count; p++) {
    const int32_t site = w->body->lattice->particle_site[p];
    values[p] = w->dissipated_state[site] + w->lost_state[site] + w->dissipated_rate[site] +
                0.5 * w->lost_rate[site];
  }
}

/* In runs with this law and output. */
typedef bool exists_in(const deck_output *asked, const pl_law *law);

static bool always(const deck_output *asked, const pl_law *law) {
  (void)asked;
  (void)law;
  return true;
}

static bool with_rotations(const deck_output *asked, const pl_law *law) {
  (void)asked;
  return law->dof > law->dimensions;
}

static bool with_damage(const deck_output *asked, const pl_law *law) {
  (void)asked;
  return damage_on_bonds(law) || damage_on_particles(law);
}

/* Laws of bonds count what each bond has lost. */
static bool with_losses(const deck_output *asked, const pl_law *law) {
  return asked->energy && law->kind != PL_STATE;
}

/* as many as there are directions of space, or axes to turn about */
enum { SCALAR = 1, VECTOR = 0, ROTATION = -1 };

static int component_count(int kind, const pl_law *law) {
  return kind == VECTOR ? law->dimensions : kind == ROTATION ? law->dof - law->dimensions : kind;
}

typedef struct own_field {
  const char *name, *unit;
  int components;
  const char *kind, *words;
  exists_in *exists;
  values_of *values;
} own_field;

static const own_field own_fields[] = {
#define X(name, unit, components, exists, kind, words)                                             \
  {#name, unit, components, kind, words, exists, values_of_##name},
    OUTPUT_FIELDS(X)
#undef X
};
enum { OWN_FIELDS = sizeof own_fields / sizeof *own_fields };

static const own_field *find_own(const char *name) {
  for (int k = 0; k < OWN_FIELDS; k++)
    if (strcasecmp(own_fields[k].name, name) == 0) return &own_fields[k];
  return NULL;
}

/* --- what frames hold ------------------------------------------------------------------------- */

static bool is_asked(const deck_output *o, const char *name) {
  for (int k = 0; k < o->field_count; k++)
    if (strcasecmp(o->fields[k], name) == 0) return true;
  return false;
}

static size_t most_fields(const pl_law *law) {
  return OWN_FIELDS + (size_t)law->field_count + (size_t)law->output_count +
         (size_t)law->varying_count;
}

static void add(frame_set *f, frame_field field, values_of *values, int index) {
  f->fields[f->count] = field;
  f->sources[f->count++] = (frame_source){values, field.components, index};
}

static const char *words_of(const char *doc, const char *otherwise) {
  return doc && *doc ? doc : otherwise;
}

/* What is stored of any law. */
static void add_own(frame_set *f) {
  const pl_law *law = f->of.state->law;
  for (const own_field *own = own_fields; own < own_fields + OWN_FIELDS; own++) {
    if (!is_asked(f->of.asked, own->name) || !own->exists(f->of.asked, law)) continue;
    const bool largest = own->values == values_of_damage && damage_on_particles(law);
    add(f,
        (frame_field){.name = own->name,
                      .unit = own->unit,
                      .components = component_count(own->components, law),
                      .kind = own->kind,
                      .long_name = largest ? "the largest damage of the particle" : own->words},
        own->values, 0);
  }
}

static void add_of_law(frame_set *f) {
  const pl_law *law = f->of.state->law;
  const deck_output *asked = f->of.asked;
  for (int k = 0; k < law->field_count; k++) {
    const pl_field *s = &law->fields[k];
    const bool damages = s->kind == PL_FIELD_DAMAGE;
    if (!is_asked(asked, s->name) && !(damages && is_asked(asked, "damage"))) continue;
    add(f,
        (frame_field){s->name, s->unit, on_bonds(s), 1, damages ? "damage" : "state",
                      words_of(s->doc, damages ? "damage of the law" : "state of the law")},
        values_of_state, k);
  }
  for (int k = 0; k < law->output_count; k++) {
    const pl_field *o = &law->outputs[k];
    if (!is_asked(asked, o->name)) continue;
    add(f,
        (frame_field){o->name, o->unit, on_bonds(o), 1, "output",
                      words_of(o->doc, "output of the law")},
        values_of_output, k);
  }
  for (int k = 0; k < law->varying_count; k++) {
    const pl_parameter *p = &law->parameters[law->varying[k]];
    if (!is_asked(asked, p->name)) continue;
    add(f,
        (frame_field){p->name, p->unit, true, 1, "other", words_of(p->doc, "parameter of the law")},
        values_of_parameter, k);
  }
}

frame_set *frames_new(const frames_of *of) {
  const size_t most = most_fields(of->state->law);
  frame_set *f = must_calloc(1, sizeof *f);
  f->of = *of;
  f->fields = must_calloc(most, sizeof *f->fields);
  f->sources = must_calloc(most, sizeof *f->sources);
  add_own(f);
  add_of_law(f);
  return f;
}

void frames_free(frame_set *f) {
  if (!f) return;
  free(f->fields);
  free(f->sources);
  free(f);
}

int frames_fields(const frame_set *f, const frame_field **fields) {
  *fields = f->fields;
  return f->count;
}

void frames_values(const frame_set *f, int field, double *values) {
  f->sources[field].values(&f->of, &f->sources[field], values);
}

/* --- what the deck asks for ------------------------------------------------------------------- */

/* Names that this run can store, or with `all` that some run can; to be freed. */
static const char **field_names(const deck_output *o, const pl_law *law, bool all, int *count) {
  const char **names = must_calloc(most_fields(law), sizeof *names);
  *count = 0;
  for (int k = 0; k < OWN_FIELDS; k++)
    if (all || own_fields[k].exists(o, law)) names[(*count)++] = own_fields[k].name;
  for (int f = 0; f < law->field_count; f++)
    names[(*count)++] = law->fields[f].name;
  for (int f = 0; f < law->output_count; f++)
    names[(*count)++] = law->outputs[f].name;
  for (int k = 0; k < law->varying_count; k++)
    names[(*count)++] = law->parameters[law->varying[k]].name;
  return names;
}

static void report_no_field(const deck_output *o, const pl_law *law, int k, diagnostics *d) {
  diag_report(d, DIAG_BAD_VALUE, o->field_where[k], "there is no field `%s` to store",
              o->fields[k]);
  if (strcasecmp(o->fields[k], "energy") == 0) {
    diag_hint(d, "energy lost, per particle, is `dissipated`; histories of energies are always "
                 "written");
    return;
  }
  int count;
  const char **names = field_names(o, law, false, &count);
  deck_suggest(d, o->fields[k], names, count, "this run can store");
  free(names);
}

bool frames_check(const deck_output *o, const pl_law *law, diagnostics *d) {
  int count;
  const char **names = field_names(o, law, true, &count);
  bool good = true;
  for (int k = 0; o->field_where && k < o->field_count; k++) {
    const own_field *own = find_own(o->fields[k]);
    bool known = false;
    for (int n = 0; n < count; n++)
      known |= strcasecmp(names[n], o->fields[k]) == 0;
    good &= known;
    if (!known)
      report_no_field(o, law, k, d);
    else if (own && !own->exists(o, law))
      diag_report(d, DIAG_DECK_WARNING, o->field_where[k],
                  "this run with the law `%s` has no `%s` to store", law->name, o->fields[k]);
  }
  free(names);
  return good;
}

/* --- when ------------------------------------------------------------------------------------- */

/* Position at which a frame is due; the first is that of the undeformed body. */
static int64_t position_of(const frame_set *f, int64_t frame) {
  const int64_t end = run_clock_end(f->of.clock), count = f->of.asked->frames;
  return (int64_t)llround((double)frame * (double)end / (double)count);
}

/* The first frame after the present position, from `frame` on. */
static int64_t frame_after(const frame_set *f, int64_t frame) {
  const int64_t here = run_clock_position(f->of.clock), count = f->of.asked->frames;
  while (count > 0 && frame <= count && position_of(f, frame) <= here)
    frame++;
  return frame;
}

int64_t frames_next(const frame_set *f) {
  const int64_t count = f->of.asked->frames, frame = frame_after(f, f->of.clock->at.next_frame);
  return count > 0 && frame <= count ? position_of(f, frame) : INT64_MAX;
}

bool frames_due(const frame_set *f) {
  const run_progress *at = &f->of.clock->at;
  if (f->of.asked->frames <= 0 || at->last_frame_step == at->step) return false;
  if (at->status != STEP_OK) return true; /* the last state is always worth a frame */
  return frame_after(f, at->next_frame) > at->next_frame;
}

void frames_taken(const frame_set *f, run_progress *at) {
  at->last_frame_step = at->step;
  at->next_frame = frame_after(f, at->next_frame);
}
