/* What is stored in frames, when, and its values in the order of results. */
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

#include "runtime/deck/deck_value.h"
#include "runtime/interaction/damage.h"
#include "runtime/simulation/simulation_parts.h"

/* --- what frames hold ------------------------------------------------------------------------- */

enum { OWN_FIELDS = 6 };
static const char *const own_fields[OWN_FIELDS] = {"displacement", "velocity", "rotation",
                                                   "force",        "damage",   "dissipated"};

bool frames_want(const simulation *s, const char *name) {
  const deck_output *o = &s->deck->output;
  for (int k = 0; k < o->field_count; k++)
    if (strcasecmp(o->fields[k], name) == 0) return true;
  return false;
}

static bool has_damage(const pl_law *law) {
  return damage_on_bonds(law) || damage_on_particles(law);
}

static bool on_bonds(const pl_field *f) {
  return f->place != PL_ON_PARTICLE;
}

static void offer(simulation *s, bool offered, frame_field field, frame_source from) {
  if (!offered) return;
  s->frame_fields[s->frame_field_count] = field;
  s->frame_sources[s->frame_field_count++] = from;
}

static const char *words_of(const char *doc, const char *otherwise) {
  return doc && *doc ? doc : otherwise;
}

/* What is stored of any law. */
static void offer_own(simulation *s, bool damage) {
  const pl_law *law = s->law;
  double *const *u = s->body->displacement;
  const int dimensions = s->body->dimensions;
  offer(s, frames_want(s, "displacement"),
        (frame_field){"displacement", "m", false, dimensions, "other", "displacement"},
        (frame_source){FROM_STATE, u, 0});
  offer(s, frames_want(s, "velocity"),
        (frame_field){"velocity", "m/s", false, dimensions, "other",
                      "velocity: the mean of those half a step before and after"},
        (frame_source){FROM_VELOCITY, NULL, 0});
  offer(s, law->dof > law->dimensions && frames_want(s, "rotation"),
        (frame_field){"rotation", "rad", false, 1, "other", "rotation, counter-clockwise"},
        (frame_source){FROM_STATE, u + 2, 0});
  offer(s, frames_want(s, "force"),
        (frame_field){"force", "N", false, dimensions, "other", "sum of the forces of the bonds"},
        (frame_source){FROM_STATE, s->body->force, 0});
  offer(s, damage,
        (frame_field){"damage", "1", false, 1, "damage",
                      damage_on_particles(law)
                          ? "the largest damage of the particle"
                          : "mean damage of the bonds that the particle began with"},
        (frame_source){FROM_DAMAGE, NULL, 0});
  offer(s, s->state->dissipated_state && frames_want(s, "dissipated"),
        (frame_field){"dissipated", "J", false, 1, "other",
                      "energy lost in the bonds to the right of the particle and above it"},
        (frame_source){FROM_DISSIPATED, NULL, 0});
}

static void offer_law(simulation *s, bool damage) {
  const pl_law *law = s->law;
  for (int k = 0; k < law->field_count; k++) {
    const pl_field *f = &law->fields[k];
    const bool damages = f->kind == PL_FIELD_DAMAGE;
    offer(s, frames_want(s, f->name) || (damages && damage),
          (frame_field){f->name, f->unit, on_bonds(f), 1, damages ? "damage" : "state",
                        words_of(f->doc, damages ? "damage of the law" : "state of the law")},
          (frame_source){FROM_FIELD, NULL, k});
  }
  for (int k = 0; k < law->output_count; k++) {
    const pl_field *o = &law->outputs[k];
    offer(s, frames_want(s, o->name),
          (frame_field){o->name, o->unit, on_bonds(o), 1, "output",
                        words_of(o->doc, "output of the law")},
          (frame_source){FROM_OUTPUT, NULL, k});
  }
  for (int k = 0; k < law->varying_count; k++) {
    const pl_parameter *p = &law->parameters[law->varying[k]];
    offer(
        s, frames_want(s, p->name),
        (frame_field){p->name, p->unit, true, 1, "other", words_of(p->doc, "parameter of the law")},
        (frame_source){FROM_PARAMETER, NULL, k});
  }
}

void frames_choose(simulation *s) {
  const pl_law *law = s->law;
  const bool damage = has_damage(law) && frames_want(s, "damage");
  const size_t most = OWN_FIELDS + (size_t)law->field_count + (size_t)law->output_count +
                      (size_t)law->varying_count;
  s->frame_fields = must_calloc(most, sizeof *s->frame_fields);
  s->frame_sources = must_calloc(most, sizeof *s->frame_sources);
  offer_own(s, damage);
  offer_law(s, damage);
}

/* Known names that this run cannot give. */
static bool is_absent(const simulation *s, const char *name) {
  if (strcasecmp(name, "rotation") == 0) return s->law->dof == s->law->dimensions;
  if (strcasecmp(name, "damage") == 0) return !has_damage(s->law);
  return strcasecmp(name, "dissipated") == 0 &&
         (!s->deck->output.energy || s->law->kind == PL_STATE);
}

/* Names that this run can store, or with `all` that some run can; to be freed. */
static const char **field_names(const simulation *s, bool all, int *count) {
  const pl_law *law = s->law;
  const size_t most = OWN_FIELDS + (size_t)law->field_count + (size_t)law->output_count +
                      (size_t)law->varying_count;
  const char **names = must_calloc(most, sizeof *names);
  *count = 0;
  for (int k = 0; k < OWN_FIELDS; k++)
    if (all || !is_absent(s, own_fields[k])) names[(*count)++] = own_fields[k];
  for (int f = 0; f < law->field_count; f++)
    names[(*count)++] = law->fields[f].name;
  for (int f = 0; f < law->output_count; f++)
    names[(*count)++] = law->outputs[f].name;
  for (int k = 0; k < law->varying_count; k++)
    names[(*count)++] = law->parameters[law->varying[k]].name;
  return names;
}

static void report_no_field(const simulation *s, int k, diagnostics *d) {
  const deck_output *o = &s->deck->output;
  diag_report(d, DIAG_BAD_VALUE, o->field_where[k], "there is no field `%s` to store",
              o->fields[k]);
  if (strcasecmp(o->fields[k], "energy") == 0) {
    diag_hint(d, "energy lost, per particle, is `dissipated`; histories of energies are always "
                 "written");
    return;
  }
  int count;
  const char **names = field_names(s, false, &count);
  deck_suggest(d, o->fields[k], names, count, "this run can store");
  free(names);
}

bool frames_check(const simulation *s, diagnostics *d) {
  const deck_output *o = &s->deck->output;
  int count;
  const char **names = field_names(s, true, &count);
  bool good = true;
  for (int k = 0; o->field_where && k < o->field_count; k++) {
    bool known = false;
    for (int n = 0; n < count; n++)
      known |= strcasecmp(names[n], o->fields[k]) == 0;
    good &= known;
    if (!known)
      report_no_field(s, k, d);
    else if (is_absent(s, o->fields[k]))
      diag_report(d, DIAG_DECK_WARNING, o->field_where[k],
                  "this run with the law `%s` has no `%s` to store", s->law->name, o->fields[k]);
  }
  free(names);
  return good;
}

/* --- frames ----------------------------------------------------------------------------------- */

int64_t frames_step(const simulation *s, int64_t frame) {
  const int64_t frames = s->deck->output.frames;
  return (int64_t)llround((double)frame * (double)simulation_end(s) / (double)frames);
}

int simulation_frame_fields(const simulation *s, const frame_field **fields) {
  *fields = s->frame_fields;
  return s->frame_field_count;
}

bool simulation_frame_due(const simulation *s) {
  const int64_t frames = s->deck->output.frames;
  if (frames <= 0 || s->at.last_frame_step == s->at.step) return false;
  if (s->at.status != STEP_OK) return true; /* the last state is always worth a frame */
  return s->at.next_frame <= frames && frames_step(s, s->at.next_frame) <= simulation_position(s);
}

void simulation_frame_taken(simulation *s) {
  const int64_t frames = s->deck->output.frames;
  s->at.last_frame_step = s->at.step;
  while (frames > 0 && s->at.next_frame <= frames &&
         frames_step(s, s->at.next_frame) <= simulation_position(s))
    s->at.next_frame++;
}

static void site_values(const simulation *s, double *const *arrays, int components,
                        double *values) {
  for (long p = 0; p < s->lattice->particle_count; p++)
    for (int c = 0; c < components; c++)
      values[p * components + c] = arrays[c][s->lattice->particle_site[p]];
}

static void bond_values(const simulation *s, const double *array, double *values) {
  for (long b = 0; b < s->lattice->bond_count; b++)
    values[b] = sweep_bond_value(s->state, array, &s->bonds[b]);
}

/* Energy lost in the bonds that a particle owns (those to the right and above). */
static void particle_dissipated(const simulation *s, double *values) {
  for (long p = 0; p < s->lattice->particle_count; p++) {
    const int32_t site = s->lattice->particle_site[p];
    const sweep *w = s->state;
    values[p] = w->dissipated_state[site] + w->lost_state[site] + w->dissipated_rate[site] +
                0.5 * w->lost_rate[site];
  }
}

/* Of the law, on particles or on bonds. */
static void law_values(const simulation *s, const pl_field *field, double *array, double *values) {
  if (on_bonds(field))
    bond_values(s, array, values);
  else
    site_values(s, &array, 1, values);
}

static void output_values(simulation *s, int output, double *values) {
  const pl_field *field = &s->law->outputs[output];
  const size_t planes = (size_t)sweep_planes(s->state, field->place);
  double *array = must_calloc(planes * (size_t)s->lattice->size, sizeof *array);
  sweep_output(s->state, output, array);
  law_values(s, field, array, values);
  free(array);
}

static void velocities(const simulation *s, int components, double *values) {
  for (long p = 0; p < s->lattice->particle_count; p++)
    for (int c = 0; c < components; c++)
      values[p * components + c] =
          loads_velocity(s->loads, s->body, c, s->lattice->particle_site[p], (long)s->at.step);
}

void simulation_frame_values(simulation *s, int field, double *values) {
  const frame_source *from = &s->frame_sources[field];
  const unsigned environment = subnormals_off();
  simulation_observe(s);
  switch (from->kind) {
  case FROM_VELOCITY:
    velocities(s, s->frame_fields[field].components, values);
    break;
  case FROM_STATE:
    site_values(s, from->arrays, s->frame_fields[field].components, values);
    break;
  case FROM_DAMAGE:
    damage_of_particles(s->state, s->bonds, values);
    break;
  case FROM_DISSIPATED:
    particle_dissipated(s, values);
    break;
  case FROM_FIELD:
    law_values(s, &s->law->fields[from->index], s->state->new_field[from->index], values);
    break;
  case FROM_OUTPUT:
    output_values(s, from->index, values);
    break;
  case FROM_PARAMETER:
    bond_values(s, s->fields->value[from->index], values);
    break;
  }
  subnormals_restore(environment);
}
