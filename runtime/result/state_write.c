#include "runtime/result/state_write.h"

#include <stdio.h>

#include "runtime/result/hdf5_tools.h"

enum { NAME = 600 };

/* What stands in a group is named behind it. */
static const char *in(const char *group, const char *name, char path[NAME]) {
  snprintf(path, NAME, "%s/%s", group, name);
  return path;
}

static bool write_number(hid_t file, const char *name, double value, const char *unit_text) {
  const hsize_t one[] = {1};
  return h5_write_doubles(file, name, &value, 1, one, unit_text);
}

static bool write_body(hid_t file, const state_body *b, int dimensions) {
  char group[NAME / 2], path[NAME];
  const hsize_t shape[] = {(hsize_t)b->count, (hsize_t)b->dof}, one[] = {1};
  const int32_t first = (int32_t)b->first;
  const bool turns = b->dof > dimensions;
  snprintf(group, sizeof group, RESULT_STATE "/bodies/%s", b->lattice);
  return h5_make_group(file, group) && h5_write_text(file, in(group, "kind", path), b->kind) &&
         write_number(file, in(group, "spacing", path), b->spacing, "m") &&
         h5_write_integers(file, in(group, "first", path), &first, 1, one) &&
         h5_write_doubles(file, in(group, "displacement", path), b->displacement, 2, shape,
                          turns ? "m, rad" : "m") &&
         h5_write_doubles(file, in(group, "velocity", path), b->velocity, 2, shape,
                          turns ? "m/s, rad/s" : "m/s");
}

static bool write_field(hid_t file, const char *group, const state_field *f) {
  char path[NAME];
  const hsize_t shape[] = {(hsize_t)f->count, (hsize_t)f->columns};
  return h5_write_doubles(file, in(group, f->name, path), f->values, 2, shape, f->unit);
}

static bool write_fields(hid_t file, const state_law *l, const char *what,
                         const state_field *fields, int count) {
  char group[NAME / 2];
  snprintf(group, sizeof group, RESULT_STATE "/laws/%s/%s", l->interaction, what);
  bool good = h5_make_group(file, group);
  for (int f = 0; good && f < count; f++)
    good = write_field(file, group, &fields[f]);
  return good;
}

static bool write_law(hid_t file, const state_law *l) {
  char group[NAME / 2], path[NAME];
  snprintf(group, sizeof group, RESULT_STATE "/laws/%s", l->interaction);
  return h5_make_group(file, group) && h5_write_text(file, in(group, "law", path), l->law) &&
         write_fields(file, l, "fields", l->fields, l->field_count) &&
         (l->lost_count == 0 || write_fields(file, l, "lost", l->lost, l->lost_count));
}

static bool write_stamp(hid_t file, const state_stamp *s) {
  char group[NAME / 2], path[NAME];
  const hsize_t three[] = {3}, surface[] = {STATE_SURFACE};
  snprintf(group, sizeof group, RESULT_STATE "/stamps/%s", s->name);
  bool good = h5_make_group(file, group) &&
              h5_write_doubles(file, in(group, "place", path), s->place, 1, three, "m") &&
              h5_write_doubles(file, in(group, "velocity", path), s->velocity, 1, three, "m/s") &&
              h5_write_doubles(file, in(group, "surface", path), s->surface, 1, surface, "m");
  snprintf(group, sizeof group, RESULT_STATE "/stamps/%s/dragged", s->name);
  good = good && (s->dragged_count == 0 || h5_make_group(file, group));
  for (int f = 0; good && f < s->dragged_count; f++)
    good = write_field(file, group, &s->dragged[f]);
  return good;
}

bool state_write(hid_t file, const result_state *s) {
  bool good = h5_make_group(file, RESULT_STATE) && h5_make_group(file, RESULT_STATE "/bodies") &&
              h5_make_group(file, RESULT_STATE "/laws") &&
              write_number(file, RESULT_STATE "/step", s->step, "s");
  for (int b = 0; good && b < s->body_count; b++)
    good = write_body(file, &s->bodies[b], s->dimensions);
  for (int n = 0; good && n < s->law_count; n++)
    good = write_law(file, &s->laws[n]);
  good = good && (s->stamp_count == 0 || h5_make_group(file, RESULT_STATE "/stamps"));
  for (int n = 0; good && n < s->stamp_count; n++)
    good = write_stamp(file, &s->stamps[n]);
  return good;
}
