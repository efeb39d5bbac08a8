#include "runtime/result/result_state.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "dsl/base/arena.h"
#include "runtime/result/result_fields.h"
#include "runtime/result/result_find.h"
#include "runtime/result/result_read.h"

enum { NAME = 600, MOST_DOF = 6 };

static bool read_number(result_file *f, const char *path, double *value) {
  long count = 0;
  int columns;
  double *values = result_read_table(f, path, false, 1, 1, &count, &columns);
  if (count == 1) *value = *values;
  free(values);
  return count == 1;
}

static bool read_place(result_file *f, const char *path, long *value) {
  long count = 0;
  int columns;
  int32_t *values = result_read_table(f, path, true, 1, 1, &count, &columns);
  if (count == 1) *value = *values;
  free(values);
  return count == 1;
}

static bool are_finite(const double *values, long count) {
  bool good = true;
  for (long k = 0; k < count; k++)
    good = good && isfinite(values[k]);
  return good;
}

/* [count][dof]; NULL where the other table has another shape. */
static double *read_motion(result_file *f, const char *group, const char *name, state_body *b) {
  char path[NAME];
  long count = 0;
  int dof = 0;
  snprintf(path, sizeof path, "%s/%s", group, name);
  double *values = result_read_table(f, path, false, 1, MOST_DOF, &count, &dof);
  if (values && b->dof == 0) {
    b->dof = dof;
    b->count = count;
  }
  if (values && count == b->count && dof == b->dof && are_finite(values, count * dof))
    return values;
  free(values);
  return NULL;
}

static bool read_body(result_file *f, const char *lattice, long particles, state_body *b) {
  char group[NAME / 2], path[NAME];
  snprintf(group, sizeof group, RESULT_STATE "/bodies/%.200s", lattice);
  b->lattice = must_copy(lattice);
  snprintf(path, sizeof path, "%s/kind", group);
  b->kind = result_read_text(f, path);
  b->displacement = read_motion(f, group, "displacement", b);
  b->velocity = read_motion(f, group, "velocity", b);
  snprintf(path, sizeof path, "%s/spacing", group);
  bool good = b->kind && b->displacement && b->velocity && read_number(f, path, &b->spacing);
  snprintf(path, sizeof path, "%s/first", group);
  good = good && read_place(f, path, &b->first);
  return good && b->spacing > 0 && isfinite(b->spacing) && b->first >= 0 &&
         b->count <= particles - b->first;
}

static bool read_field(result_file *f, const char *group, const char *name, state_field *into) {
  enum { ENDS = 2 };
  char path[2 * NAME];
  snprintf(path, sizeof path, "%s/%.200s", group, name);
  into->name = must_copy(name);
  into->values = result_read_table(f, path, false, 1, ENDS, &into->count, &into->columns);
  return into->values != NULL;
}

/* *fields[*count] of a group; none where it is not there. */
static bool read_fields(result_file *f, const char *interaction, const char *what,
                        state_field **fields, int *count) {
  char path[NAME];
  snprintf(path, sizeof path, RESULT_STATE "/laws/%.200s/%s", interaction, what);
  result_names names = result_list(f, path);
  bool good = true;
  *fields = must_calloc((size_t)names.count + 1, sizeof **fields);
  for (int k = 0; good && k < names.count; k++)
    good = read_field(f, path, names.items[k], &(*fields)[(*count)++]);
  result_names_free(&names);
  return good;
}

static bool read_law(result_file *f, const char *interaction, state_law *l) {
  char path[NAME];
  l->interaction = must_copy(interaction);
  snprintf(path, sizeof path, RESULT_STATE "/laws/%.200s/law", interaction);
  l->law = result_read_text(f, path);
  l->pairs = result_read_bonds(f, interaction, &l->bond_count);
  bool good = l->law && l->pairs &&
              read_fields(f, interaction, "fields", &l->fields, &l->field_count) &&
              read_fields(f, interaction, "lost", &l->lost, &l->lost_count);
  for (int k = 0; k < l->lost_count && good; k++)
    good = l->lost[k].columns == 1 && l->lost[k].count == l->bond_count;
  return good;
}

static bool read_numbers(result_file *f, const char *path, double *value, long wanted) {
  long count = 0;
  int columns;
  double *values = result_read_table(f, path, false, 1, 1, &count, &columns);
  const bool good = count == wanted && are_finite(values, count);
  if (good) memcpy(value, values, (size_t)count * sizeof *value);
  free(values);
  return good;
}

static const state_body *body_of(const result_state *s, const char *lattice) {
  for (int b = 0; b < s->body_count; b++)
    if (strcmp(s->bodies[b].lattice, lattice) == 0) return &s->bodies[b];
  return NULL;
}

static bool read_dragged(result_file *f, const char *group, const result_state *s,
                         state_stamp *into) {
  char path[2 * NAME];
  result_names names = result_list(f, group);
  bool good = true;
  into->dragged = must_calloc((size_t)names.count + 1, sizeof *into->dragged);
  for (int k = 0; good && k < names.count; k++) {
    state_field *field = &into->dragged[into->dragged_count++];
    const state_body *of = body_of(s, names.items[k]);
    snprintf(path, sizeof path, "%s/%.200s", group, names.items[k]);
    field->name = must_copy(names.items[k]);
    field->values = result_read_table(f, path, false, 1, 3, &field->count, &field->columns);
    good = field->values && of && field->count == of->count && field->columns == s->dimensions &&
           are_finite(field->values, field->count * field->columns);
  }
  result_names_free(&names);
  return good;
}

static bool read_stamp(result_file *f, const char *name, const result_state *s, state_stamp *into) {
  char path[NAME];
  into->name = must_copy(name);
  snprintf(path, sizeof path, RESULT_STATE "/stamps/%.200s/place", name);
  bool good = read_numbers(f, path, into->place, 3);
  snprintf(path, sizeof path, RESULT_STATE "/stamps/%.200s/velocity", name);
  good = good && read_numbers(f, path, into->velocity, 3);
  snprintf(path, sizeof path, RESULT_STATE "/stamps/%.200s/surface", name);
  good = good && read_numbers(f, path, into->surface, STATE_SURFACE);
  snprintf(path, sizeof path, RESULT_STATE "/stamps/%.200s/dragged", name);
  return good && read_dragged(f, path, s, into);
}

static bool read_all(result_file *f, result_state *s) {
  result_names bodies = result_list(f, RESULT_STATE "/bodies"),
               laws = result_list(f, RESULT_STATE "/laws"),
               stamps = result_list(f, RESULT_STATE "/stamps");
  s->reference = result_read_reference(f, &s->particle_count, &s->dimensions);
  s->bodies = must_calloc((size_t)bodies.count + 1, sizeof *s->bodies);
  s->laws = must_calloc((size_t)laws.count + 1, sizeof *s->laws);
  s->stamps = must_calloc((size_t)stamps.count + 1, sizeof *s->stamps);
  bool good = s->reference && read_number(f, RESULT_STATE "/step", &s->step) && s->step >= 0;
  for (int b = 0; good && b < bodies.count; b++)
    good = read_body(f, bodies.items[b], s->particle_count, &s->bodies[s->body_count++]);
  for (int n = 0; good && n < laws.count; n++)
    good = read_law(f, laws.items[n], &s->laws[s->law_count++]);
  for (int n = 0; good && n < stamps.count; n++)
    good = read_stamp(f, stamps.items[n], s, &s->stamps[s->stamp_count++]);
  result_names_free(&bodies);
  result_names_free(&laws);
  result_names_free(&stamps);
  return good && s->body_count > 0;
}

result_state *result_state_read(result_file *f, bool *missing, char *error, size_t size) {
  double step;
  *missing = !read_number(f, RESULT_STATE "/step", &step) && !result_trouble(f);
  if (*missing) {
    snprintf(error, size, "does not hold the state at its end");
    return NULL;
  }
  result_state *s = must_calloc(1, sizeof *s);
  if (read_all(f, s)) return s;
  snprintf(error, size, "is damaged: the state at its end cannot be read");
  result_state_free(s);
  return NULL;
}

static void free_fields(state_field *fields, int count) {
  for (int f = 0; f < count; f++) {
    free(fields[f].name);
    free(fields[f].values);
  }
  free(fields);
}

void result_state_free(result_state *s) {
  if (!s) return;
  for (int b = 0; b < s->body_count; b++) {
    free(s->bodies[b].lattice);
    free(s->bodies[b].kind);
    free(s->bodies[b].displacement);
    free(s->bodies[b].velocity);
  }
  for (int n = 0; n < s->law_count; n++) {
    free_fields(s->laws[n].fields, s->laws[n].field_count);
    free_fields(s->laws[n].lost, s->laws[n].lost_count);
    free(s->laws[n].interaction);
    free(s->laws[n].law);
    free(s->laws[n].pairs);
  }
  for (int n = 0; n < s->stamp_count; n++) {
    free_fields(s->stamps[n].dragged, s->stamps[n].dragged_count);
    free(s->stamps[n].name);
  }
  free(s->bodies);
  free(s->laws);
  free(s->stamps);
  free(s->reference);
  free(s);
}
