/* A law of a point as a specialist would program it for finite elements on a structured grid:
   von_mises with linear hardening in plane strain, on rectangles with 2 x 2 points. One pass over
   the cells: strains from the differences of displacements along the edges, return map, forces that
   are written once; states in place, of which only those are kept that are needed.

   It exists twice, compiled without and with contraction to fused multiply-adds. */
#ifndef PERILAT_BENCHMARK_HANDWRITTEN_POINTS_H
#define PERILAT_BENCHMARK_HANDWRITTEN_POINTS_H

#include "runtime/mesh/node_layout.h"

typedef struct plastic_material {
  double E, nu, f_y, H, H_kin; /* SI, as in von_mises.plm */
} plastic_material;

typedef struct plastic_plate plastic_plate;

typedef struct plastic_program {
  /* spacing: m; what is laid out as `layout` are nodes[0] x nodes[1] nodes. */
  plastic_plate *(*open)(const node_layout *layout, const double spacing[2], double thickness,
                         const plastic_material *material);
  void (*close)(plastic_plate *p);
  /* All states 0. */
  void (*rest)(plastic_plate *p);
  /* Forces (N) and new states from displacements (m), planes of the layout. */
  void (*find)(plastic_plate *p, const double *const u[2], double *const force[2]);
  /* eps_bar, eps_p xx, yy, zz, xy of a point of the cell (i, j): left or right, low or high. */
  void (*state)(const plastic_plate *p, int i, int j, int right, int high, double state[5]);
} plastic_program;

extern const plastic_program plastic_plain, plastic_fused;

#endif
