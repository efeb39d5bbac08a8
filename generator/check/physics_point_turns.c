#include "generator/check/physics_point_turns.h"

#include <math.h>

#include "dsl/base/elementary.h"
#include "generator/ir/random_values.h"

enum { AXES = 3, MOST = POINT_MOST };

static const double LEFT_STRESS = 1e-6;    /* of that without damage: less is rounding */
static const double TURN_TOLERANCE = 1e-6; /* of the largest stress */

/* Rows and columns of the components in the kernel's order. */
static int place_of(const point_bench *b, int k, int which) {
  static const int plane[][2] = {{0, 0}, {1, 1}, {0, 1}};
  static const int space[][2] = {{0, 0}, {1, 1}, {2, 2}, {0, 1}, {1, 2}, {0, 2}};
  return b->strains == 3 ? plane[k][which] : space[k][which];
}

/* R a R^T */
static void turn(const point_bench *b, double R[AXES][AXES], const double *a, double *turned) {
  double whole[AXES][AXES] = {{0}};
  for (int k = 0; k < b->strains; k++) {
    const int i = place_of(b, k, 0), j = place_of(b, k, 1);
    whole[i][j] = whole[j][i] = a[k];
  }
  for (int k = 0; k < b->strains; k++) {
    turned[k] = 0;
    for (int i = 0; i < AXES; i++)
      for (int j = 0; j < AXES; j++)
        turned[k] += R[place_of(b, k, 0)][i] * whole[i][j] * R[place_of(b, k, 1)][j];
  }
}

/* About z; in space then about x, too. */
static void draw_turn(point_bench *b, double *about_z, double *about_x, double R[AXES][AXES]) {
  const double z = draw_uniform(&b->seed, 0.2, 1.3),
               x = b->strains == 3 ? 0 : draw_uniform(&b->seed, 0.2, 1.3);
  const double Z[AXES][AXES] = {{pl_cos(z), -pl_sin(z), 0}, {pl_sin(z), pl_cos(z), 0}, {0, 0, 1}};
  const double X[AXES][AXES] = {{1, 0, 0}, {0, pl_cos(x), -pl_sin(x)}, {0, pl_sin(x), pl_cos(x)}};
  *about_z = z;
  *about_x = x;
  for (int i = 0; i < AXES; i++)
    for (int j = 0; j < AXES; j++) {
      R[i][j] = 0;
      for (int k = 0; k < AXES; k++)
        R[i][j] += X[i][k] * Z[k][j];
    }
}

/* Size of the stress that a point without damage would have. */
static double whole_stress(point_bench *b, const double *strain) {
  static const double SMALL = 1e-6;
  double less[MOST], stress[MOST];
  for (int k = 0; k < b->strains; k++)
    less[k] = SMALL * strain[k];
  point_bench_virgin(b);
  point_bench_stress(b, less, stress);
  return point_bench_largest(stress, b->strains) / SMALL;
}

void physics_check_turns(point_bench *b) {
  double R[AXES][AXES], strain[MOST], stress[MOST], turned[MOST], expected[MOST], about_z, about_x;
  if (b->law->tree->anisotropic || b->failed[DIAG_CONTINUITY] || b->failed[DIAG_OBJECTIVITY])
    return;
  point_bench_any_strain(b, strain);
  draw_turn(b, &about_z, &about_x, R);
  const double least = LEFT_STRESS * whole_stress(b, strain);
  point_bench_virgin(b);
  point_bench_stress(b, strain, stress);
  turn(b, R, stress, expected);
  turn(b, R, strain, turned);
  point_bench_stress(b, turned, stress);
  const double found = point_bench_largest(expected, b->strains),
               scale = found < least ? least : found;
  for (int k = 0; k < b->strains; k++)
    stress[k] -= expected[k];
  const double gap = point_bench_largest(stress, b->strains), degrees = 57.295779513082320877;
  if (!isfinite(gap) || !isfinite(scale) || gap <= TURN_TOLERANCE * scale) return;
  point_bench_say(
      b, DIAG_OBJECTIVITY, strain,
      "write it with what knows no axes (`trace`, `dev`, `norm`, `:`, `principal`), or "
      "say that it is meant: `for ..., anisotropic`",
      "the law knows the axes: turned by %.0f degrees about z%s, the strain has another "
      "stress than the turned one, by %.3g of it",
      about_z * degrees, about_x > 0 ? " and also about x" : "", gap / scale);
}
