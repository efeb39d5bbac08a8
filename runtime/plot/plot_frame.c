#include "runtime/plot/plot_frame.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "dsl/base/arena.h"
#include "dsl/base/elementary.h"
#include "runtime/base/eigen.h"
#include "runtime/base/quantity.h"
#include "runtime/base/symmetric_tensor.h"
#include "runtime/plot/canvas.h"
#include "runtime/result/mesh_views.h"
#include "runtime/result/result_fields.h"
#include "runtime/result/result_file.h"
#include "runtime/result/result_find.h"
#include "runtime/result/result_names.h"
#include "runtime/result/result_read.h"

/* --- reading ---------------------------------------------------------------------------------- */

void plot_frame_free(plot_frame *m) {
  free(m->reference);
  free(m->size);
  free(m->moved);
  free(m->values);
  free(m->damage);
  free(m->second);
  free(m->pairs);
  free(m->marked);
  free(m->nodes);
  free(m->of_cells);
  plot_meshes_free(&m->meshes);
  plot_stamps_free(&m->stamps);
}

static double bond_length(const plot_frame *m, long b) {
  const int n = m->dimensions;
  const double *i = &m->reference[n * m->pairs[2 * b]], *j = &m->reference[n * m->pairs[2 * b + 1]];
  const double plane = pl_hypot(j[0] - i[0], j[1] - i[1]);
  return n == 2 ? plane : pl_hypot(plane, j[2] - i[2]);
}

/* Bonds of laws that know no damage, as of bars and links, lie among others and hide none. */
static bool has_no_damage(const plot_frame *m, long b) {
  return m->damage && isnan(m->damage[b]);
}

/* [particles] distance to the nearest bonded one, 0 without; to be freed. `damaging`: by bonds of
   laws that know damage. */
static double *nearest_of(const plot_frame *m, bool damaging) {
  double *nearest = must_calloc((size_t)m->particles + 1, sizeof *nearest);
  for (long b = 0; b < m->bonds; b++)
    for (int e = 0; e < 2; e++) {
      double *known = &nearest[m->pairs[2 * b + e]];
      const double length = bond_length(m, b);
      if (damaging && has_no_damage(m, b)) continue;
      if (*known == 0 || length < *known) *known = length;
    }
  return nearest;
}

/* Mean over the particles: on a lattice its spacing. */
static double spacing_of(const plot_frame *m) {
  double *nearest = nearest_of(m, false), sum = 0;
  long count = 0;
  for (long p = 0; p < m->particles; p++) {
    count += nearest[p] > 0;
    sum += nearest[p];
  }
  free(nearest);
  return count ? sum / (double)count : 0;
}

/* Of graded particles, over the mean: as `spacing` is one of the mean. */
static double *sizes_of(result_file *f, const plot_frame *m) {
  long count = 0;
  double sum = 0, *size = result_read_spacing(f, &count);
  bool good = size && count == m->particles;
  for (long p = 0; good && p < count; p++) {
    good = size[p] > 0 && isfinite(size[p]);
    sum += size[p];
  }
  if (!good) {
    free(size);
    return NULL;
  }
  for (long p = 0; p < count; p++)
    size[p] *= (double)count / sum;
  return size;
}

/* Displacements times factor; a factor is chosen so that the largest relative one is a twentieth of
   the body. */
static void move_particles(plot_frame *m, const double *displacement, double wanted) {
  const int n = m->dimensions;
  double low[3] = {INFINITY, INFINITY, INFINITY}, high[3] = {-INFINITY, -INFINITY, -INFINITY};
  double mean[3] = {0, 0, 0}, largest = 0, extent = 0;
  for (long p = 0; p < m->particles; p++)
    for (int c = 0; c < n; c++) {
      low[c] = pl_fmin(low[c], m->reference[n * p + c]);
      high[c] = pl_fmax(high[c], m->reference[n * p + c]);
      mean[c] += displacement[n * p + c] / (double)m->particles;
    }
  for (long p = 0; p < n * m->particles; p++)
    largest = pl_fmax(largest, fabs(displacement[p] - mean[p % n]));
  for (int c = 0; c < n; c++)
    extent = pl_fmax(extent, high[c] - low[c]);
  m->factor = wanted;
  if (wanted < 0) {
    double raw = largest > 0 ? 0.05 * extent / largest : 1;
    m->factor = raw < 1 ? 1 : pl_fmin(nice_step(raw, 1), 1e4);
  }
  m->moved = must_calloc((size_t)(m->particles * n) + 1, sizeof *m->moved);
  for (long p = 0; p < n * m->particles; p++)
    m->moved[p] = m->reference[p] + m->factor * displacement[p];
}

static bool is_stored(result_file *f, const char *field) {
  result_names fields = result_members(f, "/frames");
  const bool stored = result_names_find(&fields, field) >= 0;
  result_names_free(&fields);
  return stored;
}

/* --- tensors ---------------------------------------------------------------------------------- */

/* "stress" of a result that has "stress_xx". */
static bool is_tensor(result_file *f, const plot_frame *m, const char *field) {
  const tensor_component *component;
  const int count = tensor_components(m->dimensions, &component);
  bool any = false;
  for (int c = 0; c < count && !is_stored(f, field); c++) {
    char name[300];
    snprintf(name, sizeof name, "%.250s_%s", field, component[c].name);
    any = any || is_stored(f, name);
  }
  return any;
}

/* [particles] of one component. */
static double *read_component(result_file *f, plot_frame *m, const plot_map_options *o,
                              const char *component, char *error, size_t size) {
  char name[300];
  long count = 0;
  int components = 0;
  snprintf(name, sizeof name, "%.250s_%s", o->field, component);
  double *values = result_read_frame(f, name, o->frame, &count, &components, m->unit_text,
                                     sizeof m->unit_text, error, size);
  if (!values || (count == m->particles && components == 1)) return values;
  snprintf(error, size, "`%s` does not have a value for each particle", name);
  free(values);
  return NULL;
}

/* Into values[0]: of the components of one particle. */
static double largest_principal(int dimensions, const double *values) {
  const tensor_component *component;
  const int count = tensor_components(dimensions, &component);
  double a[EIGEN_MOST][EIGEN_MOST] = {{0}}, found[EIGEN_MOST], vectors[EIGEN_MOST][EIGEN_MOST];
  double most = -INFINITY;
  for (int c = 0; c < count; c++) {
    if (!isfinite(values[c])) return NAN;
    a[component[c].first][component[c].second] = values[c];
    a[component[c].second][component[c].first] = values[c];
  }
  eigen_symmetric(dimensions, a, found, vectors);
  for (int k = 0; k < dimensions; k++)
    most = pl_fmax(most, found[k]);
  return most;
}

/* In the plane that of the directions of the plane. */
static double *read_principal(result_file *f, plot_frame *m, const plot_map_options *o, char *error,
                              size_t size) {
  const tensor_component *component;
  const int count = tensor_components(m->dimensions, &component);
  double *all[TENSOR_MOST] = {NULL}, *most = NULL;
  bool good = true;
  for (int c = 0; c < count && good; c++) {
    all[c] = read_component(f, m, o, component[c].name, error, size);
    good = all[c] != NULL;
  }
  if (good) most = must_calloc((size_t)m->particles + 1, sizeof *most);
  for (long p = 0; good && p < m->particles; p++) {
    double here[TENSOR_MOST];
    for (int c = 0; c < count; c++)
      here[c] = all[c][p];
    most[p] = largest_principal(m->dimensions, here);
  }
  for (int c = 0; c < count; c++)
    free(all[c]);
  return most;
}

static bool read_tensor(result_file *f, plot_frame *m, const plot_map_options *o, char *error,
                        size_t size) {
  const bool principal = o->part && strcmp(o->part, "principal") == 0;
  if (!principal && (!o->part || tensor_find(m->dimensions, o->part) < 0)) {
    snprintf(error, size, "`%s` is a tensor: give --component xx, yy, %sxy%s or principal",
             o->field, m->dimensions == 3 ? "zz, " : "", m->dimensions == 3 ? ", yz, xz" : "");
    return false;
  }
  m->values = principal ? read_principal(f, m, o, error, size)
                        : read_component(f, m, o, o->part, error, size);
  m->value_count = m->particles;
  m->components = 1;
  if (principal)
    snprintf(m->shown, sizeof m->shown, "largest principal %.200s", o->field);
  else
    snprintf(m->shown, sizeof m->shown, "%.200s_%s", o->field, o->part);
  return m->values != NULL;
}

static bool read_values(result_file *f, plot_frame *m, const plot_map_options *o, char *error,
                        size_t size) {
  char name[512];
  if (is_tensor(f, m, o->field)) return read_tensor(f, m, o, error, size);
  snprintf(m->shown, sizeof m->shown, "%.250s", o->field);
  if (!result_find(f, "/frames", o->field, name, sizeof name, error, size)) return false;
  if (o->part) {
    snprintf(error, size, "`%s` has no component `%s`: it is no tensor", o->field, o->part);
    return false;
  }
  m->values = result_read_frame(f, name, o->frame, &m->value_count, &m->components, m->unit_text,
                                sizeof m->unit_text, error, size);
  if (!m->values) return false;
  m->of_bonds = strchr(name, '/') != NULL;
  if (m->value_count != (m->of_bonds ? m->bonds : m->particles)) {
    snprintf(error, size, "`%s` does not have a value for each %s", name,
             m->of_bonds ? "bond" : "particle");
    return false;
  }
  if (o->component >= m->components) {
    snprintf(error, size, "`%s` has %d component%s, numbered from 0; there is no component %d",
             o->field, m->components, m->components == 1 ? "" : "s", o->component);
    return false;
  }
  return true;
}

/* --- marks ------------------------------------------------------------------------------------ */

/* "S_p > 1e-6" is a field, a relation and a level in the field's unit; "yielded" alone is above
   0. */
typedef struct mark_rule {
  char field[256];
  bool below;
  const char *level; /* text; NULL: 0 */
} mark_rule;

static mark_rule rule_of(const char *mark) {
  mark_rule r = {.level = NULL};
  size_t length = strcspn(mark, "<>");
  if (mark[length]) r.level = mark + length + 1;
  r.below = mark[length] == '<';
  while (length > 0 && mark[length - 1] == ' ')
    length--;
  snprintf(r.field, sizeof r.field, "%.*s", (int)length, mark);
  return r;
}

static bool level_of(const mark_rule *r, const char *unit_text, double *level, char *error,
                     size_t size) {
  *level = 0;
  if (!r->level || quantity_read(r->level, strlen(r->level), unit_text, level)) return true;
  snprintf(error, size, "`%s` is compared with a value in a unit of `%s`, not `%s`", r->field,
           unit_text, r->level);
  return false;
}

static double size_of(const double *v, int components) {
  double sum = 0;
  for (int c = 0; c < components; c++)
    sum += v[c] * v[c];
  return components == 1 ? v[0] : sqrt(sum);
}

/* A vector is marked by its size. */
static bool read_marks(result_file *f, plot_frame *m, const plot_map_options *o, char *error,
                       size_t size) {
  const mark_rule r = rule_of(o->mark);
  char name[512], unit_text[64] = "1";
  long count = 0;
  int components = 0;
  double level;
  if (!result_find(f, "/frames", r.field, name, sizeof name, error, size)) return false;
  double *values = result_read_frame(f, name, o->frame, &count, &components, unit_text,
                                     sizeof unit_text, error, size);
  m->marks_on_bonds = strchr(name, '/') != NULL;
  bool good = values && level_of(&r, unit_text, &level, error, size);
  if (good && count != (m->marks_on_bonds ? m->bonds : m->particles)) {
    snprintf(error, size, "`%s` does not have a value for each %s", name,
             m->marks_on_bonds ? "bond" : "particle");
    good = false;
  }
  if (good) m->marked = must_calloc((size_t)count + 1, sizeof *m->marked);
  for (long k = 0; good && k < count; k++) {
    const double v = size_of(values + k * components, components);
    m->marked[k] = r.below ? v < level : v > level;
  }
  free(values);
  return good;
}

/* Of bonds that are not shown themselves both particles are marked. */
static void mark_particles(plot_frame *m) {
  double *marked = must_calloc((size_t)m->particles + 1, sizeof *marked);
  for (long b = 0; b < m->bonds; b++)
    for (int e = 0; e < 2; e++)
      if (m->marked[b] > 0) marked[m->pairs[2 * b + e]] = 1;
  free(m->marked);
  m->marked = marked;
  m->marks_on_bonds = false;
}

/* --- reading a frame -------------------------------------------------------------------------- */

/* A law may have its damage on particles. */
static bool read_damage_of_particles(result_file *f, plot_frame *m, const plot_map_options *o) {
  char none[256];
  if (!is_stored(f, "damage")) return false;
  m->values = result_read_frame(f, "damage", o->frame, &m->value_count, &m->components,
                                m->unit_text, sizeof m->unit_text, none, sizeof none);
  m->damage_of = "damage of particles:";
  return m->values && m->value_count == m->particles && m->components == 1;
}

/* Maps of other fields show separated bonds, too, where the result knows them and they are few
   enough to be seen: with a larger horizon they would cover what the map is about. */
static bool bonds_would_cover(const plot_frame *m) {
  enum { MOST_BONDS = 5 }; /* a particle: ten neighbours */
  return m->bonds > MOST_BONDS * m->particles;
}

static bool read_damage(result_file *f, plot_frame *m, const char *path, const plot_map_options *o,
                        char *error, size_t size) {
  long count = 0;
  if (!m->of_damage && bonds_would_cover(m)) return true;
  m->damage = result_read_damage(f, o->frame, &count, error, size);
  if (m->damage && count == m->bonds) return true;
  free(m->damage);
  m->damage = NULL;
  if (!m->of_damage || read_damage_of_particles(f, m, o)) return true;
  if (!error[0])
    snprintf(
        error, size,
        m->meshes.count > 0 && m->bonds == 0
            ? "`%s` is of a mesh, which has no damage: give --map stress, say, with fields = "
              "'displacement', 'stress' in &output"
            : "`%s` holds no damage of bonds: write fields = 'displacement', 'damage' in &output "
              "and run again "
              "(a law without a damage has none to store)",
        path);
  return false;
}

/* Of states and outputs cells have one value each, in results that know it. */
static bool read_cells(result_file *f, plot_frame *m, const plot_map_options *o, char *error,
                       size_t size) {
  char unit[64];
  long count = 0;
  if (m->meshes.count == 0 || m->of_bonds || m->of_damage || o->contours > 0) return true;
  if (strcmp(m->shown, MESH_DEAD_CELLS) == 0) {
    m->of_cells = plot_meshes_show_dead(&m->meshes);
    return true;
  }
  m->of_cells = result_read_cells(f, m->shown, o->frame, &count, unit, sizeof unit);
  if (!m->of_cells || count == plot_meshes_cells(&m->meshes)) return true;
  snprintf(error, size, "`/cells/%s` does not have a value for each cell", m->shown);
  return false;
}

/* NULL with a sentence: a damage of bonds. */
static double *read_one_damage(result_file *f, const plot_frame *m, const char *field, long frame,
                               char *error, size_t size) {
  char name[512], unit_text[64];
  long count = 0;
  int components = 0;
  if (!result_find(f, "/frames", field, name, sizeof name, error, size)) return NULL;
  double *values = result_read_frame(f, name, frame, &count, &components, unit_text,
                                     sizeof unit_text, error, size);
  if (values && strchr(name, '/') && count == m->bonds && components == 1) return values;
  if (values) snprintf(error, size, "`%s` is not on bonds: of two damages both are", field);
  free(values);
  return NULL;
}

/* "omega_t,omega_c": the larger of the two, and which it is. */
static bool read_two_damages(result_file *f, plot_frame *m, const plot_map_options *o, char *error,
                             size_t size) {
  const size_t first = strcspn(o->field, ",");
  snprintf(m->damages[0], sizeof m->damages[0], "%.*s", (int)first, o->field);
  snprintf(m->damages[1], sizeof m->damages[1], "%s", o->field + first + 1);
  m->damage = read_one_damage(f, m, m->damages[0], o->frame, error, size);
  m->second = m->damage ? read_one_damage(f, m, m->damages[1], o->frame, error, size) : NULL;
  for (long b = 0; m->second && b < m->bonds; b++) {
    const bool larger = m->second[b] > m->damage[b] || isnan(m->damage[b]);
    if (larger) m->damage[b] = m->second[b];
    m->second[b] = larger;
  }
  return m->second != NULL;
}

/* NULL with a sentence that says how to store them when they are not there. */
static double *read_displacements(result_file *f, const plot_frame *m, const char *path, long frame,
                                  char *error, size_t size) {
  char unit_text[64];
  long count = 0;
  int components = 0;
  if (!is_stored(f, "displacement")) {
    snprintf(error, size,
             "a map needs displacements, and `%s` holds none: add 'displacement' to `fields` in "
             "&output and run again",
             path);
    return NULL;
  }
  double *u = result_read_frame(f, "displacement", frame, &count, &components, unit_text,
                                sizeof unit_text, error, size);
  if (u && count == m->particles && components == m->dimensions) return u;
  if (u) snprintf(error, size, "the displacements in `%s` are not those of its particles", path);
  free(u);
  return NULL;
}

/* Quasi-static runs have a sample at the start and one after each increment. */
static long increment_at(result_file *f, double time) {
  if (!result_is_quasi_static(f)) return -1;
  char unit_text[64], none[256];
  long count = 0, at = 0;
  double *times =
      result_read_series(f, "time", &count, unit_text, sizeof unit_text, none, sizeof none);
  for (long k = 0; times && k < count; k++)
    if (fabs(times[k] - time) < fabs(times[at] - time)) at = k;
  free(times);
  return at;
}

/* Frames that are modes have numbers in place of times, and a sample each. */
static double frequency_of(result_file *f, long frame) {
  char unit_text[64], none[256];
  long count = 0;
  double found = NAN;
  double *numbers =
      result_read_series(f, "time", &count, unit_text, sizeof unit_text, none, sizeof none);
  const bool of_modes = numbers && strcmp(unit_text, "1") == 0;
  free(numbers);
  if (!of_modes) return NAN;
  double *all =
      result_read_series(f, "frequency", &count, unit_text, sizeof unit_text, none, sizeof none);
  if (all && frame >= 0 && frame < count) found = all[frame];
  free(all);
  return found;
}

static void find_nodes(plot_frame *m) {
  if (m->meshes.count > 0) m->nodes = must_calloc((size_t)m->particles + 1, 1);
  for (int n = 0; n < m->meshes.count; n++)
    for (long k = 0; k < 4 * m->meshes.items[n].all_count; k++)
      m->nodes[m->meshes.items[n].cells[k]] = 1;
}

static bool read_frame(result_file *f, const char *path, plot_frame *m, const plot_map_options *o,
                       char *error, size_t size) {
  m->reference = result_read_reference(f, &m->particles, &m->dimensions);
  m->pairs = result_read_bonds(f, NULL, &m->bonds);
  if (!m->reference || !m->pairs || m->particles == 0) {
    snprintf(error, size, "`%s` holds no lattice (particles and bonds) to draw", path);
    return false;
  }
  double *u = read_displacements(f, m, path, o->frame, error, size);
  if (!u) return false;
  /* what is magnified would lie in stamps, or far from them */
  move_particles(m, u, o->factor < 0 && m->stamps.count > 0 ? 1 : o->factor);
  free(u);
  long frames = 0;
  double *times = result_read_frame_times(f, &frames);
  long k = o->frame < 0 ? frames + o->frame : o->frame;
  m->time = times && k >= 0 && k < frames ? times[k] : NAN;
  free(times);
  if (!plot_meshes_read(&m->meshes, f, o->frame, error, size)) return false;
  find_nodes(m);
  m->increment = increment_at(f, m->time);
  m->frequency = frequency_of(f, k);
  m->spacing = spacing_of(m);
  m->size = sizes_of(f, m);
  if (m->spacing == 0 && m->meshes.count > 0) m->spacing = m->meshes.items[0].size;
  char *title = result_read_title(f);
  snprintf(m->title, sizeof m->title, "%s", o->title ? o->title : title);
  free(title);
  const bool two = strchr(o->field, ',') != NULL;
  const bool of_mesh = m->meshes.count > 0 && m->bonds == 0 && is_stored(f, "damage");
  m->of_damage = two || (strcmp(o->field, "damage") == 0 && !of_mesh);
  if (two)
    return read_two_damages(f, m, o, error, size) && (!o->mark || read_marks(f, m, o, error, size));
  return read_damage(f, m, path, o, error, size) &&
         (m->of_damage || read_values(f, m, o, error, size)) && read_cells(f, m, o, error, size) &&
         (!o->mark || read_marks(f, m, o, error, size));
}

double plot_frame_value(const plot_frame *m, long k, int component) {
  const double *v = &m->values[k * m->components];
  return component >= 0 && m->components > 1 ? v[component] : size_of(v, m->components);
}

double plot_frame_spacing(const plot_frame *m, long p) {
  return m->size ? m->spacing * m->size[p] : m->spacing;
}

/* --- what is shown of a body in space --------------------------------------------------------- */

/* Takes row k of a table from row order[k], in place; rows of `width` doubles. */
static void take_rows(double **table, const long *order, long count, int width) {
  if (!*table) return;
  double *taken = must_calloc((size_t)(count * width) + 1, sizeof *taken);
  for (long k = 0; k < count; k++)
    memcpy(taken + k * width, *table + order[k] * width, (size_t)width * sizeof *taken);
  free(*table);
  *table = taken;
}

/* The particles in `order`, and the bonds between them. */
static void take_particles(plot_frame *m, const long *order, long count) {
  int32_t *now = must_alloc(((size_t)m->particles + 1) * sizeof *now);
  long *bonds = must_alloc(((size_t)m->bonds + 1) * sizeof *bonds), kept = 0;
  for (long p = 0; p < m->particles; p++)
    now[p] = -1;
  for (long k = 0; k < count; k++)
    now[order[k]] = (int32_t)k;
  for (long b = 0; b < m->bonds; b++) {
    const int32_t i = now[m->pairs[2 * b]], j = now[m->pairs[2 * b + 1]];
    if (i < 0 || j < 0) continue;
    m->pairs[2 * kept] = i;
    m->pairs[2 * kept + 1] = j;
    bonds[kept++] = b;
  }
  take_rows(&m->reference, order, count, m->dimensions);
  take_rows(&m->moved, order, count, m->dimensions);
  take_rows(&m->size, order, count, 1);
  take_rows(&m->damage, bonds, kept, 1);
  take_rows(&m->second, bonds, kept, 1);
  if (m->marks_on_bonds)
    take_rows(&m->marked, bonds, kept, 1);
  else
    take_rows(&m->marked, order, count, 1);
  if (m->of_bonds)
    take_rows(&m->values, bonds, kept, m->components);
  else
    take_rows(&m->values, order, count, m->components);
  m->particles = count;
  m->bonds = kept;
  m->value_count = m->of_bonds ? kept : count;
  free(now);
  free(bonds);
}

/* Places in the picture: two rows of coefficients. */
static void project(plot_frame *m, const double across[3], const double up[3]) {
  for (int c = 0; c < 3; c++) {
    m->axes[c][0] = across[c];
    m->axes[c][1] = up[c];
  }
  double *places[2] = {m->reference, m->moved};
  for (int t = 0; t < 2; t++)
    for (long p = 0; p < m->particles; p++) {
      const double *at = places[t] + 3 * p;
      const double x = across[0] * at[0] + across[1] * at[1] + across[2] * at[2];
      const double y = up[0] * at[0] + up[1] * at[1] + up[2] * at[2];
      places[t][2 * p] = x;
      places[t][2 * p + 1] = y;
    }
}

/* Particles up to half of their spacing from the plane; on the far side that distance itself
   counts, too. */
static bool take_slice(plot_frame *m, const plot_map_options *o, char *error, size_t size) {
  static const double unit_vectors[3][3] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
  static const int sides[3][2] = {{1, 2}, {0, 2}, {0, 1}};
  const int across = sides[o->slice_axis][0], up = sides[o->slice_axis][1];
  const double rounding = 1e-6 * m->spacing;
  long *order = must_alloc(((size_t)m->particles + 1) * sizeof *order), count = 0;
  double low = INFINITY, high = -INFINITY;
  for (long p = 0; p < m->particles; p++) {
    const double at = m->reference[3 * p + o->slice_axis], half = 0.5 * plot_frame_spacing(m, p);
    low = pl_fmin(low, at);
    high = pl_fmax(high, at);
    if (at > o->slice_at - half + rounding && at <= o->slice_at + half + rounding)
      order[count++] = p;
  }
  if (count) take_particles(m, order, count);
  free(order);
  snprintf(m->view, sizeof m->view, "%c = %.5g mm, seen along %c (%c to the right), ",
           "xyz"[o->slice_axis], 1e3 * o -> slice_at, "xyz"[o->slice_axis], "xyz"[across]);
  if (count) project(m, unit_vectors[across], unit_vectors[up]);
  if (!count)
    snprintf(
        error, size,
        "no particle lies within half a spacing of %c = %.6g mm; the body reaches from %.6g to "
        "%.6g mm",
        "xyz"[o->slice_axis], 1e3 * o -> slice_at, 1e3 * low, 1e3 * high);
  return count > 0;
}

/* Means of the bonds' values over the bonds of each particle; sizes of vectors. */
static double *means_of_bonds(const plot_frame *m, const double *values, int component) {
  double *means = must_calloc((size_t)m->particles + 1, sizeof *means);
  int32_t *bonds = must_calloc((size_t)m->particles + 1, sizeof *bonds);
  for (long b = 0; b < m->bonds; b++)
    for (int e = 0; e < 2; e++) {
      const int32_t p = m->pairs[2 * b + e];
      const double value = values ? values[b] : plot_frame_value(m, b, component);
      if (isnan(value)) continue; /* of a law without it */
      means[p] += value;
      bonds[p]++;
    }
  for (long p = 0; p < m->particles; p++)
    means[p] = bonds[p] ? means[p] / bonds[p] : values ? 0 : NAN;
  free(bonds);
  return means;
}

/* Bonds that reach past the nearest neighbours hide each other when all are drawn. */
static bool has_crowded_bonds(const plot_frame *m) {
  double *nearest = nearest_of(m, true);
  bool crowded = false;
  for (long b = 0; b < m->bonds && !crowded; b++)
    crowded =
        !has_no_damage(m, b) &&
        bond_length(m, b) > 1.5 * pl_fmax(nearest[m->pairs[2 * b]], nearest[m->pairs[2 * b + 1]]);
  free(nearest);
  return crowded;
}

/* What bonds have, as means on particles. */
static void show_on_particles(plot_frame *m, int component) {
  if (!m->of_bonds && (!m->of_damage || m->values)) return;
  double *means = means_of_bonds(m, m->of_damage ? m->damage : NULL, component);
  free(m->values);
  m->values = means;
  m->components = 1;
  m->value_count = m->particles;
  m->damage_of = "mean damage of a particle's bonds:";
  m->of_bonds = false;
  free(m->damage);
  m->damage = NULL;
}

/* Those with fewer bonds than others have: all others are hidden by them. */
static long surface_particles(const plot_frame *m, long *order) {
  int32_t *bonds = must_calloc((size_t)m->particles + 1, sizeof *bonds), most = 0;
  for (long k = 0; k < 2 * m->bonds; k++) {
    bonds[m->pairs[k]]++;
    if (bonds[m->pairs[k]] > most) most = bonds[m->pairs[k]];
  }
  long count = 0;
  for (long p = 0; p < m->particles; p++)
    if (bonds[p] < most) order[count++] = p;
  for (long p = 0; count == 0 && p < m->particles; p++)
    order[p] = p;
  free(bonds);
  return count ? count : m->particles;
}

typedef struct seen {
  double depth;
  long particle;
} seen;

static int farthest_first(const void *p, const void *q) {
  const seen *a = p, *b = q;
  if (a->depth != b->depth) return a->depth > b->depth ? -1 : 1;
  return (a->particle > b->particle) - (a->particle < b->particle);
}

/* Sides toward +x, -y and +z are seen; parallel lines stay parallel. */
static void take_surface(plot_frame *m, int component) {
  const double turn = M_PI / 6, tilt = M_PI / 7;
  const double across[3] = {pl_cos(turn), pl_sin(turn), 0};
  const double up[3] = {-pl_sin(turn) * pl_sin(tilt), pl_cos(turn) * pl_sin(tilt), pl_cos(tilt)};
  const double away[3] = {-pl_sin(turn) * pl_cos(tilt), pl_cos(turn) * pl_cos(tilt), -pl_sin(tilt)};
  long *order = must_alloc(((size_t)m->particles + 1) * sizeof *order);
  show_on_particles(m, component);
  const long count = surface_particles(m, order);
  seen *all = must_alloc(((size_t)count + 1) * sizeof *all);
  for (long k = 0; k < count; k++) {
    const double *at = m->moved + 3 * order[k];
    all[k] = (seen){away[0] * at[0] + away[1] * at[1] + away[2] * at[2], order[k]};
  }
  qsort(all, (size_t)count, sizeof *all, farthest_first);
  for (long k = 0; k < count; k++)
    order[k] = all[k].particle;
  take_particles(m, order, count);
  project(m, across, up);
  free(m->damage);
  m->damage = NULL;
  m->surface = true;
  free(all);
  free(order);
}

static void describe_extents(plot_frame *m) {
  size_t used = 0;
  for (int c = 0; c < 3; c++) {
    double low = INFINITY, high = -INFINITY;
    for (long p = 0; p < m->particles; p++) {
      low = pl_fmin(low, m->reference[3 * p + c]);
      high = pl_fmax(high, m->reference[3 * p + c]);
    }
    used += (size_t)snprintf(m->extents + used, sizeof m->extents - used, "%s%c %.4g to %.4g mm",
                             c ? ", " : "", "xyz"[c], 1e3 * low, 1e3 * high);
  }
}

/* What is shown of what was read. */
static bool show_frame(plot_frame *m, const plot_map_options *o, char *error, size_t size) {
  bool good = true;
  if (m->dimensions == 2 && o->slice_axis >= 0) {
    snprintf(error, size, "a slice is cut out of a body in space; this one is in the plane");
    return false;
  }
  const bool crowded = m->of_damage && has_crowded_bonds(m);
  const bool surface = m->dimensions == 3 && o->slice_axis < 0;
  if (m->second && (crowded || surface)) {
    snprintf(error, size,
             "two damages are shown on bonds, and these would hide each other here: show `%s` or "
             "`%s`%s",
             m->damages[0], m->damages[1], surface ? ", or a slice" : "");
    return false;
  }
  if (m->marked && m->marks_on_bonds && (crowded || surface)) mark_particles(m);
  if (crowded) show_on_particles(m, -1);
  if (m->dimensions == 3) describe_extents(m);
  if (surface) take_surface(m, o->component);
  if (m->dimensions == 3 && o->slice_axis >= 0) good = take_slice(m, o, error, size);
  if (crowded || m->surface) m->bonds = 0;
  return good;
}

bool plot_frame_take(plot_frame *m, result_file *f, const char *path, const plot_map_options *o,
                     char *error, size_t size) {
  *m = (plot_frame){.factor = 1, .damage_of = "damage of bonds:"};
  bool good = plot_stamps_read(&m->stamps, f, o->frame);
  if (!good) snprintf(error, size, "`%s` is damaged: its stamps cannot be read", path);
  good = good && read_frame(f, path, m, o, error, size);
  if (result_trouble(f)) {
    snprintf(error, size, "%s", result_trouble(f));
    good = false;
  }
  return good && show_frame(m, o, error, size);
}

bool plot_frame_read(plot_frame *m, const char *path, const plot_map_options *o, char *error,
                     size_t size) {
  *m = (plot_frame){.factor = 1};
  result_file *f = result_read(path, error, size);
  if (!f) return false;
  const bool good = plot_frame_take(m, f, path, o, error, size);
  result_read_close(f);
  return good;
}
