/* The largest load of a dog-bone with a cohesive crack across its neck (Hillerborg's fictitious
   crack), on a quarter of the body, in code of its own. To be included after cmocka.h. */
#ifndef PERILAT_TESTS_COHESIVE_NECK_H
#define PERILAT_TESTS_COHESIVE_NECK_H

#include <math.h>
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>

enum {
  NECK_COLUMNS = 20, /* of half the neck */
  NECK_ROWS = 30,
  NECK_NODES = NECK_COLUMNS + 1,
  NECK_FREEDOMS = 2 * NECK_NODES * (NECK_ROWS + 1),
  NECK_BAND = 2 * (NECK_NODES + 2),
  NECK_UNKNOWNS = NECK_NODES + 1 /* forces across the neck, and how far the end moves */
};

/* A stress is over Young's modulus, a force over that and the thickness, a length in m. Stress that
   is left across a crack of this opening, and its slope. */
typedef struct softening softening;
struct softening {
  double f_t, G_f; /* m */
  double (*stress)(const softening *s, double opening, double *slope);
};

/* K[i][NECK_BAND + j - i]: lower triangle, then Cholesky's factor. */
typedef struct neck {
  double nu, size; /* size: D */
  double (*K)[NECK_BAND + 1];
} neck;

static inline double *neck_entry(neck *n, int i, int j) {
  return &n->K[i][NECK_BAND + j - i];
}

/* --- a quarter of the body -------------------------------------------------------------------- */

/* Half of the width at a height above the neck. */
static inline double neck_half_width(double D, double y) {
  const double r = 0.725 * D;
  return y < 0.5 * D ? 0.3 * D + r - sqrt(r * r - y * y) : 0.5 * D;
}

/* Rows of strain xx, yy and twice xy over the displacements of a cell, and the area of the
   point. */
static inline double neck_strains(const double at[4][2], double a, double b, double B[3][8]) {
  static const double SIDE[4][2] = {{-1, -1}, {1, -1}, {1, 1}, {-1, 1}};
  double by[4][2], J[2][2] = {{0}};
  for (int k = 0; k < 4; k++) {
    by[k][0] = SIDE[k][0] * (1 + SIDE[k][1] * b) / 4;
    by[k][1] = SIDE[k][1] * (1 + SIDE[k][0] * a) / 4;
    for (int e = 0; e < 4; e++)
      J[e / 2][e % 2] += by[k][e / 2] * at[k][e % 2];
  }
  const double area = J[0][0] * J[1][1] - J[0][1] * J[1][0];
  memset(B, 0, 3 * sizeof *B);
  for (int k = 0; k < 4; k++) {
    const double x = (J[1][1] * by[k][0] - J[0][1] * by[k][1]) / area,
                 y = (J[0][0] * by[k][1] - J[1][0] * by[k][0]) / area;
    B[0][2 * k] = B[2][2 * k + 1] = x;
    B[1][2 * k + 1] = B[2][2 * k] = y;
  }
  return area;
}

static inline void neck_add_point(neck *n, const int node[4], double area, double B[3][8]) {
  const double c = area / (1 - n->nu * n->nu), g = c * (1 - n->nu) / 2;
  for (int i = 0; i < 8; i++)
    for (int j = 0; j < 8; j++) {
      const int row = 2 * node[i / 2] + i % 2, column = 2 * node[j / 2] + j % 2;
      const double xx = B[0][j] + n->nu * B[1][j], yy = B[1][j] + n->nu * B[0][j];
      if (column <= row)
        *neck_entry(n, row, column) += c * (B[0][i] * xx + B[1][i] * yy) + g * B[2][i] * B[2][j];
    }
}

static inline void neck_add_cell(neck *n, int column, int row) {
  const int first = row * NECK_NODES + column,
            node[4] = {first, first + 1, first + NECK_NODES + 1, first + NECK_NODES};
  double at[4][2], B[3][8];
  for (int k = 0; k < 4; k++) {
    at[k][1] = 0.75 * n->size * (node[k] / NECK_NODES) / NECK_ROWS;
    at[k][0] = neck_half_width(n->size, at[k][1]) * (node[k] % NECK_NODES) / NECK_COLUMNS;
  }
  for (int p = 0; p < 4; p++) {
    const double area = neck_strains(at, (p % 2 ? 1 : -1) / sqrt(3), (p / 2 ? 1 : -1) / sqrt(3), B);
    neck_add_point(n, node, area, B);
  }
}

static inline void neck_hold(neck *n, int i) {
  for (int j = i - NECK_BAND; j < i; j++)
    if (j >= 0) *neck_entry(n, i, j) = 0;
  for (int j = i + 1; j <= i + NECK_BAND && j < NECK_FREEDOMS; j++)
    *neck_entry(n, j, i) = 0;
  *neck_entry(n, i, i) = 1;
}

static inline void neck_factor(neck *n) {
  for (int j = 0; j < NECK_FREEDOMS; j++)
    for (int i = j; i <= j + NECK_BAND && i < NECK_FREEDOMS; i++) {
      double rest = *neck_entry(n, i, j);
      for (int k = i > NECK_BAND ? i - NECK_BAND : 0; k < j; k++)
        rest -= *neck_entry(n, i, k) * *neck_entry(n, j, k);
      *neck_entry(n, i, j) = i == j ? sqrt(rest) : rest / *neck_entry(n, j, j);
    }
}

static inline void neck_solve(neck *n, double *f) {
  for (int i = 0; i < NECK_FREEDOMS; i++) {
    for (int k = i > NECK_BAND ? i - NECK_BAND : 0; k < i; k++)
      f[i] -= *neck_entry(n, i, k) * f[k];
    f[i] /= *neck_entry(n, i, i);
  }
  for (int i = NECK_FREEDOMS - 1; i >= 0; i--) {
    f[i] /= *neck_entry(n, i, i);
    for (int k = i > NECK_BAND ? i - NECK_BAND : 0; k < i; k++)
      f[k] -= *neck_entry(n, i, k) * f[i];
  }
}

/* yields[i][j]: how far node i of the neck moves under a force along y at node j. The line of
   symmetry is held in x, the end in y. */
static inline void neck_compliance(neck *n, double yields[NECK_NODES][NECK_NODES]) {
  double f[NECK_FREEDOMS];
  n->K = calloc(NECK_FREEDOMS, sizeof *n->K);
  for (int row = 0; row < NECK_ROWS; row++)
    for (int column = 0; column < NECK_COLUMNS; column++)
      neck_add_cell(n, column, row);
  for (int row = 0; row <= NECK_ROWS; row++)
    neck_hold(n, 2 * row * NECK_NODES);
  for (int k = 0; k < NECK_NODES; k++)
    neck_hold(n, 2 * (NECK_ROWS * NECK_NODES + k) + 1);
  neck_factor(n);
  for (int j = 0; j < NECK_NODES; j++) {
    memset(f, 0, sizeof f);
    f[2 * j + 1] = 1;
    neck_solve(n, f);
    for (int i = 0; i < NECK_NODES; i++)
      yields[i][j] = f[2 * i + 1];
  }
  free(n->K);
}

/* --- a crack across the neck ------------------------------------------------------------------ */

typedef double neck_system[NECK_UNKNOWNS][NECK_UNKNOWNS + 1];

/* Gauss and Jordan, with the largest entry of a column first. */
static inline void neck_eliminate(neck_system m) {
  for (int c = 0; c < NECK_UNKNOWNS; c++) {
    int first = c;
    for (int i = c; i < NECK_UNKNOWNS; i++)
      if (fabs(m[i][c]) > fabs(m[first][c])) first = i;
    for (int j = 0; j <= NECK_UNKNOWNS; j++) {
      const double other = m[c][j];
      m[c][j] = m[first][j];
      m[first][j] = other;
    }
    for (int i = 0; i < NECK_UNKNOWNS; i++) {
      const double part = i == c ? 0 : m[i][c] / m[c][c];
      for (int j = c; j <= NECK_UNKNOWNS; j++)
        m[i][j] -= part * m[c][j];
    }
  }
  for (int i = 0; i < NECK_UNKNOWNS; i++)
    m[i][NECK_UNKNOWNS] /= m[i][i];
}

/* Load of half the neck where the crack has come from the side to the node `tip`, which
   just bears f_t. moved[i]: half of the opening. Newton's method. */
static inline double neck_load(double yields[NECK_NODES][NECK_NODES], const softening *s,
                               double width, int tip, double moved[NECK_NODES]) {
  neck_system m;
  const int end = NECK_NODES, right = NECK_UNKNOWNS;
  double load = 0, change = 1;
  for (int round = 0; round < 50 && change > 1e-13; round++) {
    memset(m, 0, sizeof m);
    for (int i = 0; i < NECK_NODES; i++) {
      double slope = 0;
      const double share = (i == 0 || i == NECK_COLUMNS ? 0.5 : 1) * width / NECK_COLUMNS,
                   stress = s->stress(s, 2 * moved[i], &slope),
                   by = i > tip ? -2 * share * slope : 1; /* closed: it does not move */
      m[i][end] = by;
      for (int j = 0; j < NECK_NODES; j++)
        m[i][j] = -by * yields[i][j];
      if (i > tip) m[i][i] += 1;
      m[i][right] = i > tip ? share * (stress - 2 * slope * moved[i]) : 0;
      if (i == tip) m[end][right] = share * s->f_t;
    }
    m[end][tip] = 1;
    neck_eliminate(m);
    load = change = 0;
    for (int i = 0; i < NECK_NODES; i++) {
      double u = m[end][right];
      for (int j = 0; j < NECK_NODES; j++)
        u -= yields[i][j] * m[j][right];
      change = fmax(change, fabs(u - moved[i]));
      moved[i] = u;
      load += m[i][right];
    }
  }
  assert_true(change <= 1e-13);
  return load;
}

/* The largest load, over f_t times the section of the neck. */
static inline double cohesive_neck(double nu, double D, const softening *s) {
  static double yields[NECK_NODES][NECK_NODES];
  neck n = {.nu = nu, .size = D};
  double moved[NECK_NODES] = {0}, most = 0;
  neck_compliance(&n, yields);
  for (int tip = NECK_COLUMNS; tip >= 0; tip--) {
    const double load = neck_load(yields, s, 0.3 * D, tip, moved);
    if (load < most) break;
    most = load;
  }
  return most / (0.3 * D * s->f_t);
}

/* --- of what the models leave across a crack -------------------------------------------------- */

/* brittle_cracking: through a quarter of f_t at a tenth of the last opening. */
static inline double neck_two_lines(const softening *s, double opening, double *slope) {
  const double last = 2 * s->G_f / (0.35 * s->f_t), knee = 0.1 * last;
  *slope = opening < knee   ? -0.75 * s->f_t / knee
           : opening < last ? -0.25 * s->f_t / (last - knee)
                            : 0;
  return opening < knee   ? s->f_t + *slope * opening
         : opening < last ? *slope * (opening - last)
                          : 0;
}

/* concrete_damage_plasticity: f_t (1 + X) X/2, X = exp(-3/4 f_t w/G_f), in a band much narrower
   than E G_f/f_t^2. */
static inline double neck_plastic(const softening *s, double opening, double *slope) {
  const double rate = -0.75 * s->f_t / s->G_f, X = exp(rate * opening);
  *slope = s->f_t * rate * X * (0.5 + X);
  return s->f_t * X * (1 + X) / 2;
}

/* Of the concrete of examples/dog_bone, with this fracture energy, N/m. */
static inline double cohesive_dog_bone(double D, double G_f, bool plastic) {
  static const double E = 30.825e9, nu = 0.2, f_t = 2.415e6;
  const softening s = {f_t / E, G_f / E, plastic ? neck_plastic : neck_two_lines};
  return cohesive_neck(nu, D, &s);
}

#endif
