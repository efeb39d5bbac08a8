/* Shape matrices of families that do not fix all strains. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "dsl/base/arena.h"
#include "runtime/deck/deck_read.h"
#include "runtime/filling/lattice.h"
#include "runtime/lattice/shape_matrix.h"

enum { MOST_VALUES = PL_SHAPE_PLANES(3) };

static const int first_axis[2][6] = {{0, 1, 0}, {0, 1, 2, 0, 1, 0}};
static const int second_axis[2][6] = {{0, 1, 1}, {0, 1, 2, 1, 2, 2}};

/* Strain, with shear as an angle, that fits a stretch of 1 of the only bond of a particle. */
static void strain_of_one_bond(const char *deck_text, double strain[6], double n[3]) {
  arena *memory = arena_new();
  source_set sources = {0};
  diagnostics said = {0};
  double *matrix[MOST_VALUES];
  diag_begin(&said, &sources);
  const int file = source_add(&sources, "deck.nml", deck_text, strlen(deck_text));
  const deck *k = deck_read(memory, &sources, file, NULL, 0, &said);
  if (said.errors) diag_print(&said, stderr);
  rows *w = lattice_build(k, 0, &said);
  assert_non_null(w);
  assert_int_equal(w->bond_count, 1);
  const int space = w->dimensions == 3, order = space ? 6 : 3;
  for (int v = 0; v < PL_SHAPE_PLANES(w->dimensions); v++)
    matrix[v] = calloc((size_t)w->size, sizeof(double));
  shape_matrices(w, matrix);
  const long site = w->particle_site[0];
  double a[3], c[3];
  rows_place(w, site, a);
  rows_place(w, w->particle_site[1], c);
  for (int d = 0; d < 3; d++)
    n[d] = (c[d] - a[d]) / w->spacing;
  memset(strain, 0, 6 * sizeof *strain);
  int at = 0;
  for (int p = 0; p < order; p++)
    for (int q = p; q < order; q++, at++) {
      const double value = matrix[at][site];
      strain[p] += value * n[first_axis[space][q]] * n[second_axis[space][q]];
      if (q > p) strain[q] += value * n[first_axis[space][p]] * n[second_axis[space][p]];
    }
  for (int v = 0; v < PL_SHAPE_PLANES(w->dimensions); v++)
    free(matrix[v]);
  rows_free(w);
  diag_clear(&said);
  source_clear(&sources);
  arena_free(memory);
}

static void assert_is_dyad(const double strain[6], const double n[3], int space) {
  for (int p = 0; p < (space ? 6 : 3); p++) {
    const int x = first_axis[space][p], y = second_axis[space][p];
    const double expected = (x == y ? 1 : 2) * n[x] * n[y];
    if (!(fabs(strain[p] - expected) < 1e-12))
      fail_msg("strain %d is %.15g, not %.15g", p, strain[p], expected);
  }
}

/* The smallest tensor, in whatever axes, is n n^T. */
static void one_bond_strains_along_itself(void **state) {
  (void)state;
  static const double turns[] = {0, 17, 45, 73};
  for (int k = 0; k < 4; k++) {
    char text[600];
    double strain[6], n[3], angle = turns[k] * acos(-1) / 180;
    snprintf(text, sizeof text,
             "&simulation end_time = 1 /\n&lattice name = 'l' kind = 'square' spacing = 1 "
             "thickness = 1 rotation = %g /\n&material lattice = 'l' model = 'm' /\n"
             "&body lattice = 'l' shape = 'point' at = 0, 0 /\n"
             "&body lattice = 'l' shape = 'point' at = %.15g, %.15g /\n",
             turns[k], cos(angle), sin(angle));
    strain_of_one_bond(text, strain, n);
    assert_is_dyad(strain, n, 0);
  }
}

static void in_space_too(void **state) {
  (void)state;
  double strain[6], n[3];
  strain_of_one_bond("&simulation end_time = 1 /\n&lattice name = 'l' kind = 'fcc' spacing = 1 /\n"
                     "&material lattice = 'l' model = 'm' /\n"
                     "&body lattice = 'l' shape = 'point' at = 0, 0, 0 /\n"
                     "&body lattice = 'l' shape = 'point' at = 0.7071067811865476, "
                     "0.7071067811865476, 0 /\n",
                     strain, n);
  assert_is_dyad(strain, n, 1);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(one_bond_strains_along_itself),
      cmocka_unit_test(in_space_too),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
