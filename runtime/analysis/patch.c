#include "runtime/analysis/patch.h"

#include <assert.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "dsl/base/arena.h"
#include "runtime/analysis/waves.h"
#include "runtime/interaction/family.h"
#include "runtime/lattice/shape_matrix.h"

static const double nominal_step = 1e-9; /* s; what a step is to a law at rest */

/* --- the lattice ------------------------------------------------------------------------------ */

static double dot(const double *a, const double *b) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

typedef struct vector {
  double at[3];
} vector;

static vector cross(const double *a, const double *b) {
  return (vector){
      {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]}};
}

/* Whole coordinates of the chords, by the dual vectors of the primitive ones. */
static void find_coordinates(const rows *w, double a[3][3], long (*cell)[3]) {
  for (int n = 0; n < 3; n++) {
    const double *b = a[(n + 1) % 3], *c = a[(n + 2) % 3];
    const vector dual = cross(b, c);
    for (int k = 0; k < w->directions; k++)
      cell[k][n] = lround(dot(dual.at, w->chord[k]) / dot(dual.at, a[n]));
  }
}

/* Whether the first half of the chords lead to later sites, as they do on rows. */
static bool leads_ahead(const rows *w, long (*cell)[3]) {
  bool ahead = true;
  for (int k = 0; k < w->directions && ahead; k++) {
    const long *c = cell[k];
    ahead = c[2] > 0 || (c[2] == 0 && (c[1] > 0 || (c[1] == 0 && c[0] > 0)));
  }
  return ahead;
}

/* As primitive vectors chords that span as small a cell, such that all chords lead ahead. */
static bool find_ahead(const rows *w, double a[3][3], long (*cell)[3]) {
  static const double out_of_plane[3] = {0, 0, 1};
  const double size = fabs(dot(a[0], cross(a[1], a[2]).at));
  const bool plane = w->dimensions == 2;
  for (int i = 0; i < w->directions; i++)
    for (int j = 0; j < w->directions; j++) {
      const vector normal = cross(w->chord[i], w->chord[j]);
      for (int k = 0; k < (plane ? 1 : w->directions); k++) {
        const double *third = plane ? out_of_plane : w->chord[k];
        if (fabs(fabs(dot(third, normal.at)) - size) > 1e-6 * size) continue;
        memcpy(a[0], w->chord[i], sizeof a[0]);
        memcpy(a[1], w->chord[j], sizeof a[1]);
        memcpy(a[2], third, sizeof a[2]);
        find_coordinates(w, a, cell);
        if (leads_ahead(w, cell)) return true;
      }
    }
  return false;
}

/* Whole coordinates of the chords; laws whose bonds add to both ends need those that lead ahead. */
static void find_cells(const pl_law *law, const rows *w, double a[3][3], long (*cell)[3]) {
  lattice_primitive(w, a);
  find_coordinates(w, a, cell);
  if (law->sum_count == 0 || leads_ahead(w, cell)) return;
  const bool found = find_ahead(w, a, cell);
  /* a large family has a neighbour on the row, one on the next and one on the next layer */
  assert(found);
  (void)found;
}

static void find_margins(const rows *w, const long (*cell)[3], long margin[3]) {
  for (int n = 0; n < 3; n++) {
    margin[n] = 0;
    for (int k = 0; k < w->directions; k++)
      margin[n] = labs(cell[k][n]) > margin[n] ? labs(cell[k][n]) : margin[n];
  }
}

void patch_margins(const pl_law *law, const rows *w, long margin[3]) {
  double primitive[3][3];
  long cell[PL_MAX_DIRECTIONS][3];
  find_cells(law, w, primitive, cell);
  find_margins(w, (const long(*)[3])cell, margin);
}

/* Of coordinates in the array, margins included. */
static long site_at(const patch *p, const long at[3]) {
  return (at[2] * p->width[1] + at[1]) * p->width[0] + at[0];
}

static void place_of(const patch *p, long site, long at[3]) {
  at[0] = site % p->width[0];
  at[1] = site / p->width[0] % p->width[1];
  at[2] = site / p->width[0] / p->width[1];
}

long patch_site(const patch *p, const long at[3]) {
  return site_at(p,
                 (const long[3]){at[0] + p->margin[0], at[1] + p->margin[1], at[2] + p->margin[2]});
}

void patch_position(const patch *p, long site, double at[3]) {
  long cell[3];
  place_of(p, site, cell);
  for (int d = 0; d < 3; d++) {
    at[d] = 0;
    for (int n = 0; n < 3; n++)
      at[d] += (double)(cell[n] - p->margin[n]) * p->primitive[n][d];
  }
}

static void find_images(patch *p) {
  long at[3], back[3];
  p->image = must_calloc((size_t)p->sites, sizeof *p->image);
  p->inside = must_calloc((size_t)p->sites, sizeof *p->inside);
  for (long q = 0; q < p->sites; q++) {
    place_of(p, q, at);
    for (int n = 0; n < 3; n++) {
      const long turns = at[n] - p->margin[n] + p->margin[n] * p->period[n]; /* not negative */
      back[n] = turns % p->period[n] + p->margin[n];
    }
    p->image[q] = site_at(p, back);
    if (p->image[q] == q) p->inside[p->inside_count++] = q;
  }
}

static void find_sizes(patch *p) {
  const int half = p->lattice->directions;
  p->sites = 1;
  for (int n = 0; n < 3; n++) {
    p->width[n] = p->period[n] + 2 * p->margin[n];
    p->sites *= p->width[n];
  }
  for (int k = 0; k < half; k++) {
    p->offset[k] = site_at(p, p->cell[k]);
    p->offset[half + k] = -p->offset[k];
    if (labs(p->offset[k]) > p->lead) p->lead = labs(p->offset[k]);
  }
  p->lead = (p->lead + PL_LANES - 1) / PL_LANES * PL_LANES;
  p->size = (p->sites + 2 * p->lead + 2 * PL_LANES) / PL_LANES * PL_LANES;
  find_images(p);
  const long last = p->inside[p->inside_count - 1];
  p->first = p->inside[0] / PL_LANES * PL_LANES;
  p->count = (last - p->first) / PL_LANES * PL_LANES + PL_LANES;
}

long patch_neighbour(const patch *p, long site, int k) {
  return p->image[site + p->offset[k]];
}

bool patch_has_bond(const patch *p, long site, int k) {
  const int half = p->lattice->directions;
  return k < half ? p->bonds[site] >> k & 1 : p->bonds[site + p->offset[k]] >> (k - half) & 1;
}

void patch_cut(patch *p, long site, int k) {
  const int half = p->lattice->directions;
  const long owner = k < half ? p->image[site] : patch_neighbour(p, site, k);
  const uint64_t bit = UINT64_C(1) << (k % half);
  for (long q = 0; q < p->sites; q++)
    if (p->image[q] == owner) p->bonds[q] &= ~bit;
}

/* --- memory ----------------------------------------------------------------------------------- */

/* Points at the first site. */
static void *site_array(const patch *p, long planes, size_t each) {
  const size_t bytes = (size_t)(planes * p->size) * each;
  char *memory = must_align(PL_ALIGNMENT, bytes);
  memset(memory, 0, bytes);
  return memory + (size_t)p->lead * each;
}

static void free_array(const patch *p, void *array, size_t each) {
  if (array) free((char *)array - (size_t)p->lead * each);
}

long patch_planes(const patch *p, const pl_field *f) {
  return f->place == PL_ON_PARTICLE ? 1 : 2 * p->lattice->directions;
}

static void new_particles(patch *p) {
  double shape[PL_SHAPE_PLANES(3)];
  p->bonds = site_array(p, 1, sizeof *p->bonds);
  p->held = site_array(p, 1, sizeof *p->held);
  for (long q = -p->lead; q < p->size - p->lead; q++)
    p->bonds[q] = UINT64_MAX;
  for (int d = 0; d < p->law->dof; d++) {
    p->displacement[d] = site_array(p, 1, sizeof(double));
    p->velocity[d] = site_array(p, 1, sizeof(double));
    p->force[d] = site_array(p, 1, sizeof(double));
  }
  shape_matrix_full(p->lattice, shape);
  for (int v = 0; v < PL_SHAPE_PLANES(p->law->dimensions); v++) {
    p->shape[v] = site_array(p, 1, sizeof(double));
    for (long q = -p->lead; q < p->size - p->lead; q++)
      p->shape[v][q] = shape[v];
  }
}

/* Values toward neighbours on bonds, else of particles. */
static long parameter_planes(const patch *p) {
  return p->law->varying_place == PL_ON_PARTICLE ? 1 : 2 * p->lattice->directions;
}

static void new_parameters(patch *p) {
  p->parameter = must_calloc((size_t)p->law->varying_count + 1, sizeof *p->parameter);
  for (int k = 0; k < p->law->varying_count; k++)
    p->parameter[k] = site_array(p, parameter_planes(p), sizeof(double));
  p->mass = site_array(p, 1, sizeof(double));
  for (long q = -p->lead; q < p->size - p->lead; q++)
    p->mass[q] = p->lattice->mass;
  if (!p->law->reads_share) return;
  p->share = site_array(p, 1, sizeof(double));
  for (long q = -p->lead; q < p->size - p->lead; q++)
    p->share[q] = 1;
}

static void new_values(patch *p, int more, int wide) {
  const pl_law *law = p->law;
  p->field = must_calloc((size_t)law->field_count + 1, sizeof *p->field);
  p->new_field = must_calloc((size_t)law->field_count + 1, sizeof *p->new_field);
  for (int f = 0; f < law->field_count; f++) {
    p->field[f] = site_array(p, patch_planes(p, &law->fields[f]), sizeof(double));
    p->new_field[f] = site_array(p, patch_planes(p, &law->fields[f]), sizeof(double));
  }
  p->link = must_calloc((size_t)law->link_count + 1, sizeof *p->link);
  for (int k = 0; k < law->link_count; k++)
    p->link[k] = site_array(p, 1, sizeof(double));
  p->bond_link = must_calloc((size_t)law->bond_link_count + 1, sizeof *p->bond_link);
  for (int k = 0; k < law->bond_link_count; k++)
    p->bond_link[k] = site_array(p, 2 * p->lattice->directions, sizeof(double));
  p->sum = must_calloc((size_t)law->sum_count + 1, sizeof *p->sum);
  for (int k = 0; k < law->sum_count; k++)
    p->sum[k] = site_array(p, 1, sizeof(double));
  for (int k = 0; k < 3 && law->sum_count; k++)
    p->marks[k] = site_array(p, 1, sizeof **p->marks);
  const int own = 1 + law->output_count;
  p->observed_count = own + more + wide;
  p->observed = must_calloc((size_t)p->observed_count, sizeof *p->observed);
  p->observed[0] = site_array(p, 1, sizeof(double));
  for (int k = 1; k < p->observed_count; k++) {
    const long planes = k < own          ? patch_planes(p, &law->outputs[k - 1])
                        : k < own + more ? 1
                                         : 2 * p->lattice->directions;
    p->observed[k] = site_array(p, planes, sizeof(double));
  }
}

static void free_arrays(const patch *p, double **arrays, int count) {
  for (int k = 0; k < count; k++)
    free_array(p, arrays[k], sizeof(double));
  free(arrays);
}

void patch_free(patch *p) {
  if (!p) return;
  for (int d = 0; d < PL_MAX_DOF; d++) {
    free_array(p, p->displacement[d], sizeof(double));
    free_array(p, p->velocity[d], sizeof(double));
    free_array(p, p->force[d], sizeof(double));
  }
  for (int v = 0; v < PL_SHAPE_PLANES(3); v++)
    free_array(p, p->shape[v], sizeof(double));
  free_array(p, p->bonds, sizeof *p->bonds);
  free_array(p, p->held, sizeof *p->held);
  free_arrays(p, p->parameter, p->law->varying_count);
  free_array(p, p->mass, sizeof(double));
  free_array(p, p->share, sizeof(double));
  free_arrays(p, p->field, p->law->field_count);
  free_arrays(p, p->new_field, p->law->field_count);
  free_arrays(p, p->link, p->law->link_count);
  free_arrays(p, p->bond_link, p->law->bond_link_count);
  free_arrays(p, p->observed, p->observed_count);
  free_arrays(p, p->sum, p->law->sum_count);
  for (int k = 0; k < 3; k++)
    free_array(p, p->marks[k], sizeof **p->marks);
  free(p->image);
  free(p->inside);
  free(p->uniforms);
  free(p);
}

void patch_virgin(patch *p) {
  for (int f = 0; f < p->law->field_count; f++)
    for (long q = -p->lead; q < patch_planes(p, &p->law->fields[f]) * p->size - p->lead; q++)
      p->field[f][q] = p->law->fields[f].initial;
}

void patch_prepare(patch *p, const double *parameters) {
  free(p->uniforms);
  p->uniforms = family_uniforms(p->law, p->lattice, parameters);
  for (int k = 0; k < p->law->varying_count; k++)
    for (long q = -p->lead; q < parameter_planes(p) * p->size - p->lead; q++)
      p->parameter[k][q] = parameters[p->law->varying[k]];
}

patch *patch_new(const pl_law *law, const double *parameters, const rows *w, const long period[3],
                 int more, int wide) {
  patch *p = must_calloc(1, sizeof *p);
  p->law = law;
  p->lattice = w;
  p->time_step = nominal_step;
  memcpy(p->period, period, sizeof p->period);
  find_cells(law, w, p->primitive, p->cell);
  find_margins(w, (const long(*)[3])p->cell, p->margin);
  find_sizes(p);
  new_particles(p);
  new_parameters(p);
  new_values(p, more, wide);
  patch_virgin(p);
  patch_prepare(p, parameters);
  return p;
}

/* --- motion ----------------------------------------------------------------------------------- */

void patch_repeat(const patch *p, double *values) {
  for (long q = 0; q < p->sites; q++)
    values[q] = values[p->image[q]];
}

void patch_deform(const patch *p, const double gradient[3][3], double *const *part,
                  double *const *values) {
  double at[3];
  for (long q = 0; q < p->sites; q++) {
    patch_position(p, q, at);
    for (int d = 0; d < p->law->dimensions; d++)
      values[d][q] = dot(gradient[d], at) + (part ? part[d][p->image[q]] : 0);
  }
}

/* --- passes ----------------------------------------------------------------------------------- */

enum { MOST_ARRAYS = 12 };

/* Arrays that begin where a pass does. */
typedef struct site_arrays {
  long first;
  void *lists[MOST_ARRAYS];
  int count;
} site_arrays;

static double *const *from_first(site_arrays *s, double *const *arrays, int count) {
  double **list = must_calloc((size_t)count + 1, sizeof *list);
  for (int k = 0; k < count; k++)
    list[k] = arrays[k] + s->first;
  s->lists[s->count++] = list;
  return list;
}

static uint64_t **marked_fields(site_arrays *s, const patch *p, uint64_t *marks, bool marked) {
  uint64_t **list = must_calloc((size_t)p->law->field_count + 1, sizeof *list);
  memset(marks - p->lead, marked ? 0xff : 0, (size_t)p->size * sizeof *marks);
  for (int k = 0; k < p->law->field_count; k++)
    list[k] = marks;
  s->lists[s->count++] = list;
  return list;
}

/* Every value of a field may be other than 0 and change. */
static void point_at_marks(site_arrays *s, const patch *p, pl_family *run) {
  run->old_filled = (const uint64_t *const *)marked_fields(s, p, p->marks[0], true);
  run->new_filled = marked_fields(s, p, p->marks[1], true);
  run->settled = marked_fields(s, p, p->marks[2], false);
}

/* Over `count` sites from `first` on. */
static void run_pass(patch *p, pl_family_function pass, long first, long count, bool ahead_only) {
  const pl_law *law = p->law;
  site_arrays s = {.first = first};
  pl_family run = {.size = sizeof run,
                   .count = count,
                   .rows = 1,
                   .neighbours = 2 * p->lattice->directions,
                   .plane = p->size,
                   .new_plane = p->size,
                   .link_plane = p->size,
                   .offset = p->offset,
                   .link_offset = p->offset,
                   .bonds = p->bonds + first,
                   .held = p->held + first,
                   .new_field = from_first(&s, p->new_field, law->field_count),
                   .link = from_first(&s, p->link, law->link_count),
                   .bond_link = from_first(&s, p->bond_link, law->bond_link_count),
                   .force = from_first(&s, p->force, law->dof),
                   .observed = from_first(&s, p->observed, p->observed_count),
                   .sum = from_first(&s, p->sum, law->sum_count),
                   .ahead_only = ahead_only,
                   .held_near = 1,
                   .mass = p->mass + first,
                   .share = p->share ? p->share + first : NULL,
                   .time_step = p->time_step,
                   .advance = p->advance};
  run.shape = (const double *const *)from_first(&s, p->shape, PL_SHAPE_PLANES(law->dimensions));
  run.parameter = (const double *const *)from_first(&s, p->parameter, law->varying_count);
  run.old_field = (const double *const *)from_first(&s, p->field, law->field_count);
  for (int d = 0; d < law->dof; d++) {
    run.displacement[d] = p->displacement[d] + first;
    run.velocity[d] = p->velocity[d] + first;
  }
  if (law->sum_count) point_at_marks(&s, p, &run);
  pass(law, p->uniforms, &run);
  for (int k = 0; k < s.count; k++)
    free(s.lists[k]);
}

/* Where bonds add to both ends, those of the margin before the sites inside reach them, too. */
static void run_sums(patch *p, pl_family_function pass) {
  run_pass(p, pass, 0, p->first, true);
  run_pass(p, pass, p->first, p->count, false);
  for (int k = 0; k < p->law->sum_count; k++)
    memset(p->sum[k] - p->lead, 0, (size_t)p->size * sizeof(double));
}

static void repeat_planes(const patch *p, const pl_field *f, double *values) {
  for (long k = 0; k < patch_planes(p, f); k++)
    patch_repeat(p, values + k * p->size);
}

static void run_program(patch *p, const pl_program *program) {
  const pl_law *law = p->law;
  for (int k = 0; k < program->pass_count; k++) {
    if (law->sum_count)
      run_sums(p, program->pass[k]);
    else
      run_pass(p, program->pass[k], p->first, p->count, false);
    for (int l = 0; l < law->link_count; l++)
      patch_repeat(p, p->link[l]);
    for (int l = 0; l < law->bond_link_count; l++)
      for (int n = 0; n < 2 * p->lattice->directions; n++)
        patch_repeat(p, p->bond_link[l] + n * p->size);
    for (int f = 0; f < law->field_count && law->sum_count; f++)
      repeat_planes(p, &law->fields[f], p->new_field[f]);
  }
}

void patch_step(patch *p) {
  run_program(p, &p->law->step);
}

void patch_observe(patch *p) {
  run_program(p, &p->law->observe);
}

void patch_accept(patch *p) {
  double **old = p->field;
  p->field = p->new_field;
  p->new_field = old;
  for (int f = 0; f < p->law->field_count; f++)
    repeat_planes(p, &p->law->fields[f], p->field[f]);
}
