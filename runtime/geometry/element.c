#include "runtime/geometry/element.h"

#include <math.h>
#include <string.h>

#include "dsl/base/elementary.h"

static const double quad_corner[4][2] = {{-1, -1}, {1, -1}, {1, 1}, {-1, 1}};

/* --- functions -------------------------------------------------------------------------------- */

static void of_triangle(const double u[2], double n[], double slope[][2]) {
  static const double slopes[3][2] = {{-1, -1}, {1, 0}, {0, 1}};
  n[0] = 1 - u[0] - u[1];
  n[1] = u[0];
  n[2] = u[1];
  memcpy(slope, slopes, sizeof slopes);
}

/* Of the areas l of a triangle: l (2 l - 1) at corners, 4 l l at the sides. */
static void of_quadratic(const double u[2], double n[], double slope[][2]) {
  double l[3], d[3][2];
  of_triangle(u, l, d);
  for (int k = 0; k < 3; k++) {
    const int next = (k + 1) % 3;
    n[k] = l[k] * (2 * l[k] - 1);
    n[3 + k] = 4 * l[k] * l[next];
    for (int a = 0; a < 2; a++) {
      slope[k][a] = (4 * l[k] - 1) * d[k][a];
      slope[3 + k][a] = 4 * (l[k] * d[next][a] + l[next] * d[k][a]);
    }
  }
}

static void of_quadrilateral(const double u[2], double n[], double slope[][2]) {
  for (int k = 0; k < 4; k++) {
    const double a = quad_corner[k][0], b = quad_corner[k][1];
    n[k] = 0.25 * (1 + a * u[0]) * (1 + b * u[1]);
    slope[k][0] = 0.25 * a * (1 + b * u[1]);
    slope[k][1] = 0.25 * b * (1 + a * u[0]);
  }
}

void element_functions(int nodes, const double u[2], double n[ELEMENT_MOST_NODES],
                       double slope[ELEMENT_MOST_NODES][2]) {
  (nodes == 3 ? of_triangle : nodes == 4 ? of_quadrilateral : of_quadratic)(u, n, slope);
}

double element_map(int nodes, const double place[][2], const double u[2], double at[2],
                   double along[2][2]) {
  double n[ELEMENT_MOST_NODES], slope[ELEMENT_MOST_NODES][2], d[2][2] = {{0}}, here[2] = {0};
  element_functions(nodes, u, n, slope);
  for (int k = 0; k < nodes; k++)
    for (int i = 0; i < 2; i++) {
      here[i] += n[k] * place[k][i];
      d[i][0] += slope[k][0] * place[k][i];
      d[i][1] += slope[k][1] * place[k][i];
    }
  if (at) memcpy(at, here, sizeof here);
  if (along) memcpy(along, d, sizeof d);
  return d[0][0] * d[1][1] - d[0][1] * d[1][0];
}

void element_gradients(int nodes, const double place[][2], const double u[2],
                       double n[ELEMENT_MOST_NODES], double gradient[ELEMENT_MOST_NODES][2]) {
  double slope[ELEMENT_MOST_NODES][2], d[2][2];
  const double turn = element_map(nodes, place, u, NULL, d);
  element_functions(nodes, u, n, slope);
  for (int k = 0; k < nodes; k++) {
    gradient[k][0] = (slope[k][0] * d[1][1] - slope[k][1] * d[1][0]) / turn;
    gradient[k][1] = (slope[k][1] * d[0][0] - slope[k][0] * d[0][1]) / turn;
  }
}

/* --- places ----------------------------------------------------------------------------------- */

bool element_unmap(int nodes, const double place[][2], const double at[2], double u[2]) {
  enum { MOST = 40 };
  u[0] = u[1] = nodes == 4 ? 0 : 1.0 / 3;
  for (int round = 0; round < MOST; round++) {
    double here[2], d[2][2];
    const double turn = element_map(nodes, place, u, here, d), x = at[0] - here[0],
                 y = at[1] - here[1];
    const double du = (x * d[1][1] - y * d[0][1]) / turn, dv = (y * d[0][0] - x * d[1][0]) / turn;
    if (!isfinite(du) || !isfinite(dv)) return false;
    u[0] += du;
    u[1] += dv;
    if (!(fabs(u[0]) < 1e3 && fabs(u[1]) < 1e3)) return false;
    if (fabs(du) + fabs(dv) < 1e-14) return true;
  }
  double here[2], d[2][2]; /* rounding moves it to and fro */
  const double turn = element_map(nodes, place, u, here, d);
  const double away = pl_hypot(at[0] - here[0], at[1] - here[1]);
  return away * away <= 1e-18 * fabs(turn);
}

double element_outside(int nodes, const double u[2]) {
  if (nodes == 4) return pl_max(fabs(u[0]), fabs(u[1])) - 1;
  return pl_max(pl_max(-u[0], -u[1]), u[0] + u[1] - 1);
}

/* --- soundness -------------------------------------------------------------------------------- */

/* The Jacobian of a quadratic triangle is quadratic: with coefficients of Bernstein's polynomials
   in a part of the triangle that are all positive it is positive there. */
typedef struct part {
  double u[3][2];
} part;

static void middle_of(const double a[2], const double b[2], double out[2]) {
  for (int i = 0; i < 2; i++)
    out[i] = 0.5 * (a[i] + b[i]);
}

static bool part_is_sound(const double place[][2], const part *t, double least, int depth,
                          double u[2]) {
  double corner[3], middle[3][2];
  bool good = true;
  for (int k = 0; k < 3; k++) {
    corner[k] = element_map(6, place, t->u[k], NULL, NULL);
    middle_of(t->u[k], t->u[(k + 1) % 3], middle[k]);
    if (corner[k] > least) continue;
    memcpy(u, t->u[k], 2 * sizeof *u);
    return false;
  }
  for (int k = 0; k < 3; k++) {
    const double side = element_map(6, place, middle[k], NULL, NULL);
    good = good && 2 * side - 0.5 * (corner[k] + corner[(k + 1) % 3]) > least;
  }
  memcpy(u, middle[0], 2 * sizeof *u);
  if (good || depth == 0) return good;
  for (int k = 0; k < 4; k++) {
    part small;
    for (int n = 0; n < 3; n++)
      memcpy(small.u[n],
             k == 3   ? middle[n]
             : n == 0 ? t->u[k]
             : n == 1 ? middle[k]
                      : middle[(k + 2) % 3],
             sizeof small.u[n]);
    if (!part_is_sound(place, &small, least, depth - 1, u)) return false;
  }
  return true;
}

/* m^2: of the box around the element, of which a Jacobian is a part. */
static double box_of(int nodes, const double place[][2]) {
  double low[2] = {INFINITY, INFINITY}, high[2] = {-INFINITY, -INFINITY};
  for (int k = 0; k < nodes; k++)
    for (int i = 0; i < 2; i++) {
      low[i] = pl_min(low[i], place[k][i]);
      high[i] = pl_max(high[i], place[k][i]);
    }
  const double side = pl_max(high[0] - low[0], high[1] - low[1]);
  return side * side;
}

bool element_is_sound(int nodes, const double place[][2], double u[2]) {
  static const double triangle[3][2] = {{0, 0}, {1, 0}, {0, 1}};
  const double least = 1e-9 * box_of(nodes, place);
  if (nodes == 6) {
    part whole;
    memcpy(whole.u, triangle, sizeof whole.u);
    return part_is_sound(place, &whole, least, 5, u);
  }
  for (int k = 0; k < element_corners(nodes); k++) { /* linear: least at a corner */
    memcpy(u, nodes == 4 ? quad_corner[k] : triangle[k], 2 * sizeof *u);
    if (!(element_map(nodes, place, u, NULL, NULL) > least)) return false;
  }
  return true;
}

/* --- integrals -------------------------------------------------------------------------------- */

int element_rule(int nodes, int gauss, double u[ELEMENT_MOST_POINTS][2],
                 double weight[ELEMENT_MOST_POINTS]) {
  static const double three[3][2] = {{1.0 / 6, 1.0 / 6}, {2.0 / 3, 1.0 / 6}, {1.0 / 6, 2.0 / 3}};
  const double root = 1 / sqrt(3);
  if (nodes == 3 || (nodes == 4 && gauss == 1)) {
    u[0][0] = u[0][1] = nodes == 3 ? 1.0 / 3 : 0;
    weight[0] = nodes == 3 ? 0.5 : 4;
    return 1;
  }
  for (int k = 0; k < element_corners(nodes); k++)
    for (int i = 0; i < 2; i++) {
      u[k][i] = nodes == 6 ? three[k][i] : root * quad_corner[k == 3 ? 2 : k == 2 ? 3 : k][i];
      weight[k] = nodes == 6 ? 1.0 / 6 : 1;
    }
  return element_corners(nodes);
}

/* Exact for polynomials of degree 4 in a triangle (Strang and Fix 1973): three points each at a and
   b. */
static int fine_rule(int nodes, double u[6][2], double weight[6]) {
  static const double at[2] = {0.445948490915965, 0.091576213509771},
                      share[2] = {0.223381589678011, 0.109951743655322};
  if (nodes == 4) return element_rule(4, 2, u, weight);
  for (int k = 0; k < 6; k++) {
    const double a = at[k / 3], l[3] = {k % 3 ? a : 1 - 2 * a, k % 3 == 1 ? 1 - 2 * a : a,
                                        k % 3 == 2 ? 1 - 2 * a : a};
    u[k][0] = l[1];
    u[k][1] = l[2];
    weight[k] = 0.5 * share[k / 3];
  }
  return 6;
}

double element_area(int nodes, const double place[][2]) {
  double u[6][2], weight[6], sum = 0;
  const int count = fine_rule(nodes, u, weight);
  for (int k = 0; k < count; k++)
    sum += weight[k] * element_map(nodes, place, u[k], NULL, NULL);
  return sum;
}

void element_mass(int nodes, const double place[][2], double share[ELEMENT_MOST_NODES]) {
  double u[6][2], weight[6], n[ELEMENT_MOST_NODES], slope[ELEMENT_MOST_NODES][2], whole = 0,
                                                                                  sum = 0;
  const int count = fine_rule(nodes, u, weight);
  memset(share, 0, (size_t)nodes * sizeof *share);
  for (int k = 0; k < count; k++) {
    const double area = weight[k] * element_map(nodes, place, u[k], NULL, NULL);
    element_functions(nodes, u[k], n, slope);
    whole += area;
    for (int q = 0; q < nodes; q++)
      share[q] += area * (nodes == 6 ? n[q] * n[q] : n[q]);
  }
  for (int q = 0; q < nodes; q++)
    sum += share[q];
  for (int q = 0; q < nodes; q++)
    share[q] *= whole / sum;
}
