#include "generator/drive/driven_point.h"

#include <stdlib.h>
#include <string.h>

#include "dsl/base/arena.h"

enum { LANES = PL_LANES };

/* --- components ------------------------------------------------------------------------------- */

const char *point_component_name(int dimensions, int k) {
  static const char *const of_plane[] = {"xx", "yy", "xy", "zz"};
  static const char *const of_space[] = {"xx", "yy", "zz", "xy", "yz", "xz"};
  return dimensions == 2 ? of_plane[k] : of_space[k];
}

int point_is_shear(int dimensions, int k) {
  return dimensions == 2 ? k == 2 : k > 2;
}

/* --- opening ---------------------------------------------------------------------------------- */

static double **lanes(double **next, int count) {
  double **list = must_calloc((size_t)count + 1, sizeof *list);
  for (int k = 0; k < count; k++, *next += LANES)
    list[k] = *next;
  return list;
}

static void take(double **next, int count, double **list) {
  for (int k = 0; k < count; k++, *next += LANES)
    list[k] = *next;
}

/* The first aligned address in a piece of memory that is a little larger than what is needed. */
static double *aligned(double *memory) {
  const uintptr_t at = (uintptr_t)memory;
  return (double *)(void *)((char *)memory + (PL_ALIGNMENT - at % PL_ALIGNMENT) % PL_ALIGNMENT);
}

void driven_point_open(driven_point *p, const pl_law *kernel, const double *parameters,
                       double cell_size) {
  const int fields = kernel->field_count, observed = 1 + kernel->output_count,
            fixed = 3 * PL_MAX_STRAINS + PL_MAX_STRAINS * PL_MAX_STRAINS + PL_LOSSES + 1;
  *p = (driven_point){.kernel = kernel,
                      .strains = PL_STRAINS(kernel->dimensions),
                      .stresses = PL_STRESSES(kernel->dimensions)};
  p->uniforms = must_calloc((size_t)kernel->uniform_count + 1, sizeof(double));
  p->space = must_calloc((size_t)(2 * fields + observed + fixed + 1) * LANES, sizeof(double));
  double *next = aligned(p->space);
  p->old_field = lanes(&next, fields);
  p->new_field = lanes(&next, fields);
  p->observed = lanes(&next, observed);
  take(&next, PL_MAX_STRAINS, p->strain);
  take(&next, PL_MAX_STRAINS, p->rate);
  take(&next, PL_MAX_STRAINS, p->stress);
  take(&next, PL_MAX_STRAINS * PL_MAX_STRAINS, p->tangent);
  take(&next, PL_LOSSES, p->lost);
  take(&next, 1, &p->cell_size);
  for (int lane = 0; lane < LANES; lane++)
    p->cell_size[lane] = cell_size;
  driven_point_take(p, parameters);
}

void driven_point_take(driven_point *p, const double *parameters) {
  const pl_bond_class none = {.size = sizeof none};
  p->kernel->prepare(p->kernel, parameters, &none, p->uniforms);
}

void driven_point_close(driven_point *p) {
  free(p->uniforms);
  free(p->space);
  free(p->old_field);
  free(p->new_field);
  free(p->observed);
}

/* --- running ---------------------------------------------------------------------------------- */

/* All lanes are the same point. */
static void fill(double *plane, double value) {
  for (int lane = 0; lane < LANES; lane++)
    plane[lane] = value;
}

static void run(driven_point *p, pl_point_function function, const strained *at) {
  for (int k = 0; k < p->strains; k++) {
    fill(p->strain[k], at->strain[k]);
    fill(p->rate[k], at->rate[k]);
  }
  const pl_points points = {.size = sizeof points,
                            .count = LANES,
                            .strain = (const double *const *)p->strain,
                            .strain_rate = (const double *const *)p->rate,
                            .cell_size = p->cell_size,
                            .old_field = (const double *const *)p->old_field,
                            .new_field = p->new_field,
                            .stress = p->stress,
                            .tangent = p->tangent,
                            .observed = p->observed,
                            .lost = p->lost,
                            .time_step = at->step,
                            .advance = at->advance};
  function(p->kernel, p->uniforms, &points);
}

void driven_point_set(driven_point *p, int field, double value) {
  fill(p->old_field[field], value);
}

stressed driven_point_step(driven_point *p, const strained *to) {
  stressed s = {.stress = {0}};
  for (int k = 0; k < PL_LOSSES; k++)
    fill(p->lost[k], 0);
  run(p, p->kernel->point_ledger, to);
  for (int k = 0; k < p->stresses; k++)
    s.stress[k] = p->stress[k][0] + 0.0;
  for (int k = 0; k < PL_LOSSES; k++)
    s.lost[k] = p->lost[k][0];
  return s;
}

void driven_point_accept(driven_point *p) {
  for (int f = 0; f < p->kernel->field_count; f++)
    memcpy(p->old_field[f], p->new_field[f], LANES * sizeof(double));
}

double driven_point_observe(driven_point *p, const strained *at) {
  run(p, p->kernel->point_observe, at);
  return p->observed[0][0];
}

void driven_point_tangent(driven_point *p, const strained *at,
                          double tangent[PL_MAX_STRAINS][PL_MAX_STRAINS]) {
  run(p, p->kernel->point_tangent, at);
  for (int a = 0; a < p->strains; a++)
    for (int b = 0; b < p->strains; b++)
      tangent[a][b] = p->tangent[a * p->strains + b][0];
}
