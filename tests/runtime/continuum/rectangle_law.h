/* The softening law with loops over rectangles, made of those over points: the same to the bit. */
#ifndef PERILAT_TESTS_RECTANGLE_LAW_H
#define PERILAT_TESTS_RECTANGLE_LAW_H

#include "runtime/mesh/rectangle_cells.h"
#include "softening_law.h"

enum { LAW_POINTS = 4 * PL_LANES };

static void rectangles_by_points(const pl_law *law, const double *uniforms,
                                 const pl_rectangles *cells, pl_point_function by) {
  const pl_points *all = cells->points;
  pl_rectangle_ends ends[2];
  for (int d = 0; d < 2; d++)
    pl_rectangle_begin(&ends[d], cells->right[d]);
  for (long first = 0; first < cells->count; first += PL_LANES) {
    double strain[3][LAW_POINTS], rate[3][LAW_POINTS], stress[4][LAW_POINTS];
    const double *old[SOFT_FIELDS], *u[2], *v[2];
    double *new[SOFT_FIELDS], *lost[PL_LOSSES], *at[RECTANGLE_PUSHES],
        pushed[RECTANGLE_PUSHES][PL_LANES];
    for (int d = 0; d < 2; d++) {
      u[d] = cells->displacement[d] + first;
      v[d] = cells->velocity[d] + first;
    }
    rectangle_cells_strain(cells->slopes, u, cells->stride,
                           (double *const[]){strain[0], strain[1], strain[2]});
    rectangle_cells_strain(cells->slopes, v, cells->stride,
                           (double *const[]){rate[0], rate[1], rate[2]});
    for (int f = 0; f < SOFT_FIELDS; f++) {
      old[f] = all->old_field[f] + 4 * first;
      new[f] = all->new_field[f] + 4 * first;
    }
    for (int k = 0; k < PL_LOSSES && all->lost; k++)
      lost[k] = all->lost[k] + 4 * first;
    for (int k = 0; k < RECTANGLE_PUSHES; k++)
      at[k] = pushed[k];
    pl_points p = *all;
    p.count = LAW_POINTS;
    p.strain = (const double *const[]){strain[0], strain[1], strain[2]};
    p.strain_rate = (const double *const[]){rate[0], rate[1], rate[2]};
    p.old_field = old;
    p.new_field = new;
    p.stress = (double *const[]){stress[0], stress[1], stress[2], stress[3]};
    p.lost = all->lost ? lost : NULL;
    by(law, uniforms, &p);
    rectangle_cells_push(cells->push, 1, (const double *const[]){stress[0], stress[1], stress[2]},
                         at);
    for (int d = 0; d < 2; d++) {
      for (int lane = 0; lane < PL_LANES; lane++)
        pl_rectangle_keep(&ends[d], lane,
                          (const double[]){pushed[4 * d][lane], pushed[4 * d + 1][lane],
                                           pushed[4 * d + 2][lane], pushed[4 * d + 3][lane]});
      pl_rectangle_sum(&ends[d], cells->cells - first, cells->force[d] + first,
                       cells->above[d] + first);
    }
  }
  for (int d = 0; d < 2; d++)
    pl_rectangle_end(&ends[d], cells->right[d]);
}

static void softening_rectangles(const pl_law *law, const double *uniforms,
                                 const pl_rectangles *cells) {
  rectangles_by_points(law, uniforms, cells, softening_step);
}

static void softening_rectangles_ledger(const pl_law *law, const double *uniforms,
                                        const pl_rectangles *cells) {
  rectangles_by_points(law, uniforms, cells, softening_ledger);
}

static pl_law rectangle_law(void) {
  pl_law law = softening_law;
  law.rectangle_step = softening_rectangles;
  law.rectangle_ledger = softening_rectangles_ledger;
  return law;
}

#endif
