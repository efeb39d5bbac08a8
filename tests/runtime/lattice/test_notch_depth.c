/* What becomes of notches on sites: against lattices small enough to count. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "runtime/deck/deck_read.h"
#include "runtime/filling/lattice.h"
#include "runtime/lattice/notch_depth.h"
#include "tests/runtime/built_rows.h"

/* Depths of the notches of a deck that has these groups besides its lattice's name and
   thickness. */
static notch_depth depth_of(const char *lattice, const char *body, const char *notch) {
  char text[1000];
  source_set sources = {NULL, 0};
  diagnostics said;
  arena *memory = arena_new();
  diag_begin(&said, &sources);
  snprintf(text, sizeof text,
           "&simulation end_time = 1 /\n&material lattice = 'l' model = 'none' /\n"
           "&lattice name = 'l' %s /\n&body lattice = 'l' %s /\n&notch lattice = 'l' %s /\n",
           lattice, body, notch);
  const deck *k = deck_read(memory, &sources, source_add(&sources, "n.nml", text, strlen(text)),
                            NULL, 0, &said);
  rows *w = k ? lattice_build(k, 0, &said) : NULL;
  if (said.errors) diag_print(&said, stderr);
  assert_non_null(w);
  const notch_depth found = notch_depth_of(w, &k->notchs[0].shape);
  rows_free(w);
  diag_clear(&said);
  source_clear(&sources);
  arena_free(memory);
  return found;
}

static void assert_depth(notch_depth n, notch_kind kind, double drawn, double cut, double first,
                         double second) {
  const double tolerance = 1e-9;
  print_message("drawn %.6g mm, cut %.6g mm, ligaments %.6g and %.6g mm\n", 1e3 * n.drawn,
                1e3 * n.cut, 1e3 * n.ligament[0], 1e3 * n.ligament[1]);
  assert_int_equal(n.kind, kind);
  assert_true(fabs(n.drawn - drawn) < tolerance && fabs(n.cut - cut) < tolerance);
  assert_true(fabs(n.ligament[0] - first) < tolerance && fabs(n.ligament[1] - second) < tolerance);
}

#define SQUARE "kind = 'square' spacing = '1 mm' thickness = '1 mm' "
#define PLATE  "shape = 'rectangle' corner = 0, 0 size = '20 mm', '10 mm' "
#define MM(x)  ((x)*1e-3)

/* Sites at whole millimetres: bonds along x stand there, too. */
static void slits_end_at_bonds(void **state) {
  (void)state;
  const char *slit = "shape = 'segment' from = '9.5 mm', '-1 mm' to = '9.5 mm', '3.2 mm'";
  assert_depth(depth_of(SQUARE, PLATE, slit), NOTCH_AT_EDGE, MM(3.2), MM(4), MM(6), 0);
  slit = "shape = 'segment' from = '9.5 mm', '12 mm' to = '9.5 mm', '6.9 mm'";
  assert_depth(depth_of(SQUARE, PLATE, slit), NOTCH_AT_EDGE, MM(3.1), MM(4), MM(6), 0);
  slit = "shape = 'segment' from = '9.5 mm', '3.9 mm' to = '9.5 mm', '5.2 mm'";
  assert_depth(depth_of(SQUARE, PLATE, slit), NOTCH_INSIDE, MM(1.3), MM(3), MM(3), MM(4));
  slit = "shape = 'segment' from = '9.5 mm', '-1 mm' to = '9.5 mm', '11 mm'";
  const notch_depth through = depth_of(SQUARE, PLATE, slit);
  assert_int_equal(through.kind, NOTCH_THROUGH);
  assert_true(fabs(through.drawn - MM(10)) < 1e-9);
  /* along x from the left edge */
  slit = "shape = 'segment' from = '-1 mm', '4.5 mm' to = '7.3 mm', '4.5 mm'";
  assert_depth(depth_of(SQUARE, PLATE, slit), NOTCH_AT_EDGE, MM(7.3), MM(8), MM(12), 0);
}

/* A saw cut of some width, between columns and through one; with longer bonds the first one left
   leans over the tip. */
static void cuts_of_some_width(void **state) {
  (void)state;
  const char *cut = "shape = 'rectangle' corner = '9.2 mm', '-1 mm' size = '0.6 mm', '4.2 mm'";
  assert_depth(depth_of(SQUARE, PLATE, cut), NOTCH_AT_EDGE, MM(3.2), MM(4), MM(6), 0);
  cut = "shape = 'rectangle' corner = '9.7 mm', '-1 mm' size = '0.6 mm', '4.2 mm'";
  assert_depth(depth_of(SQUARE, PLATE, cut), NOTCH_AT_EDGE, MM(3.2), MM(4), MM(6), 0);
  cut = "shape = 'rectangle' corner = '9.2 mm', '-1 mm' size = '0.6 mm', '4.2 mm'";
  const notch_depth far = depth_of(SQUARE "horizon = 3.015 ", PLATE, cut);
  assert_true(far.kind == NOTCH_AT_EDGE && far.cut < MM(4) && far.cut > MM(3.2));
  /* what is as wide as long is a hole; at an edge it is a notch all the same */
  const char *hole = "shape = 'rectangle' corner = '8 mm', '4 mm' size = '3 mm', '2 mm'";
  assert_int_equal(depth_of(SQUARE, PLATE, hole).kind, NOTCH_NONE);
  const char *disc = "shape = 'disc' centre = '8 mm', '4 mm' radius = '2 mm'";
  assert_int_equal(depth_of(SQUARE, PLATE, disc).kind, NOTCH_NONE);
  const char *away = "shape = 'segment' from = '30 mm', 0 to = '30 mm', '5 mm'";
  assert_int_equal(depth_of(SQUARE, PLATE, away).kind, NOTCH_NONE);
}

/* The beam D3 at 6.35 mm: rows every 5.4993 mm; five of them are cut, the sixth is whole. */
static void the_notched_beam(void **state) {
  (void)state;
  const double row = sqrt(3) / 2 * 6.35e-3;
  assert_depth(depth_of("kind = 'hexagonal' spacing = '6.35 mm' thickness = '1 mm'",
                        "shape = 'rectangle' corner = 0, 0 size = '228.6 mm', '76.99 mm'",
                        "shape = 'rectangle' corner = '113.03 mm', 0 size = '2.54 mm', '25.4 mm'"),
               NOTCH_AT_EDGE, MM(25.4), 5 * row, 9 * row, 0);
}

/* Turned by 45 degrees with its lattice, a slit is the same. */
static void turned_slits(void **state) {
  (void)state;
  const double h = 1e-3 * sqrt(0.5);
  char slit[200], body[200];
  snprintf(body, sizeof body,
           "shape = 'rectangle' corner = 0, 0 size = '20 mm', '10 mm' rotation = 45");
  snprintf(slit, sizeof slit, "shape = 'segment' from = %.15g, %.15g to = %.15g, %.15g",
           9.5 * h + h, 9.5 * h - h, 9.5 * h - 3.2 * h, 9.5 * h + 3.2 * h);
  assert_depth(depth_of(SQUARE "rotation = 45 ", body, slit), NOTCH_AT_EDGE, MM(3.2), MM(4), MM(6),
               0);
}

/* In space: through the thickness, as a box and as a face, and a face inside. */
static void cuts_in_space(void **state) {
  (void)state;
  static const char *const lattice = "kind = 'cubic' spacing = '1 mm' ",
                           *const block =
                               "shape = 'box' corner = 3*0 size = '12 mm', '10 mm', '6 mm' ";
  const char *cut =
      "shape = 'box' corner = '5.3 mm', '-1 mm', '-1 mm' size = '0.4 mm', '4.2 mm', '8 mm' ";
  assert_depth(depth_of(lattice, block, cut), NOTCH_AT_EDGE, MM(3.2), MM(4), MM(6), 0);
  cut =
      "shape = 'face' points = 5.5e-3, -1e-3, -1e-3, 5.5e-3, 3.2e-3, -1e-3, 5.5e-3, 3.2e-3, 7e-3, "
      "5.5e-3, -1e-3, 7e-3 ";
  assert_depth(depth_of(lattice, block, cut), NOTCH_AT_EDGE, MM(3.2), MM(4), MM(6), 0);
  cut = "shape = 'face' points = 5.5e-3, 2.2e-3, 1.6e-3, 5.5e-3, 6.4e-3, 1.6e-3, 5.5e-3, 6.4e-3, "
        "4.4e-3, 5.5e-3, 2.2e-3, 4.4e-3 ";
  assert_depth(depth_of(lattice, block, cut), NOTCH_INSIDE, MM(4.2), MM(5), MM(2), MM(3));
}

/* Beside the notch the body is twice as high: that is not the notch's ligament. */
static void what_stands_beside_the_notch_does_not_count(void **state) {
  (void)state;
  const char *step = "shape = 'box' corner = 3*0 size = '12 mm', '10 mm', '2 mm' /\n"
                     "&body lattice = 'l' shape = 'box' corner = 0, 0, '3 mm' "
                     "size = '12 mm', '20 mm', '3 mm' ";
  const char *cut = "shape = 'face' points = 5.5e-3, -1e-3, -1e-3, 5.5e-3, 6.2e-3, -1e-3, 5.5e-3, "
                    "6.2e-3, 2.4e-3, "
                    "5.5e-3, -1e-3, 2.4e-3 ";
  assert_depth(depth_of("kind = 'cubic' spacing = '1 mm' ", step, cut), NOTCH_AT_EDGE, MM(6.2),
               MM(7), MM(3), 0);
}

/* Where the highest bond across x crosses it, and the highest particle. */
static double highest_crossing(const rows *w, double x, double *top) {
  double most = -INFINITY;
  *top = -INFINITY;
  rows_bond *bonds = rows_bonds(w);
  for (long k = 0; k < w->bond_count; k++) {
    const long i = w->particle_site[bonds[k].i], j = w->particle_site[bonds[k].j];
    if ((w->x[i] > x) != (w->x[j] > x))
      most = fmax(most, w->y[i] + (x - w->x[i]) / (w->x[j] - w->x[i]) * (w->y[j] - w->y[i]));
  }
  for (long p = 0; p < w->particle_count; p++)
    *top = fmax(*top, w->y[w->particle_site[p]]);
  free(bonds);
  return most;
}

/* Particles of 1 to 4 mm, a slit among the coarse ones: bonds of all that reach across it count. */
static void slits_among_coarse_particles(void **state) {
  (void)state;
  for (int seed = 1; seed <= 8; seed++) {
    char text[1000];
    built_rows b;
    snprintf(
        text, sizeof text,
        "&simulation end_time = 1 /\n&material lattice = 'l' model = 'none' /\n"
        "&lattice name = 'l' kind = 'blue_noise' spacing = '1 [mm] + 0.1*y' thickness = 1 "
        "seed = %d /\n"
        "&body lattice = 'l' shape = 'rectangle' corner = 0, 0 size = '16 mm', '30 mm' /\n"
        "&notch lattice = 'l' shape = 'segment' from = '8 mm', '31 mm' to = '8 mm', '18 mm' /\n",
        seed);
    build_rows(&b, text);
    double top;
    const notch_depth found = notch_depth_of(b.rows, &b.deck->notchs[0].shape);
    const double crossing = highest_crossing(b.rows, MM(8), &top);
    assert_int_equal(found.kind, NOTCH_AT_EDGE);
    assert_true(fabs(found.cut - (top - crossing)) < 1e-12);
    built_end(&b);
  }
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(slits_end_at_bonds),
      cmocka_unit_test(cuts_of_some_width),
      cmocka_unit_test(the_notched_beam),
      cmocka_unit_test(turned_slits),
      cmocka_unit_test(cuts_in_space),
      cmocka_unit_test(what_stands_beside_the_notch_does_not_count),
      cmocka_unit_test(slits_among_coarse_particles),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
