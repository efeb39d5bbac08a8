/* Widths of cracks across a line: pieces of a lattice that part by known ways, at one plane and at
   two, at rest, turned and strained; what is whole, or damaged alike everywhere. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "runtime/analysis/crack_line.h"
#include "tests/runtime/small_run.h"

/* --- a strip of lattice in pieces ------------------------------------------------------------- */

enum { PLANES = 2 };
static const double plane_at[PLANES] = {0.0831, 0.1377}; /* m: between sites of all lattices here */

typedef struct strip {
  small_run run;
  sweep *state;
  body *of;
  rows_bond *bonds;
  damage_law law;
} strip;

static void open_strip(strip *s, double spacing, double rotation) {
  char text[1024];
  snprintf(
      text, sizeof text,
      "&simulation end_time = 1e-3 /\n&output frames = 0 /\n"
      "&lattice name = 'c' kind = 'hexagonal' spacing = %.17g thickness = 0.1 rotation = %g /\n"
      "&material lattice = 'c' model = 'm' /\n"
      "&body lattice = 'c' shape = 'rectangle' corner = 0, 0 size = 0.2, 0.06 /\n",
      spacing, rotation);
  small_open(&s->run, &elastic_bar, text);
  assert_non_null(s->run.simulation);
  s->state = simulation_state(s->run.simulation, 0);
  s->of = s->state->body;
  s->bonds = rows_bonds(s->of->lattice);
  s->law = (damage_law){s->state, s->bonds, s->of->lattice->bond_count};
}

static void close_strip(strip *s) {
  free(s->bonds);
  small_close(&s->run);
}

static int piece_of(const rows *g, int32_t site, int planes) {
  double at[3];
  int piece = 0;
  rows_place(g, site, at);
  for (int k = 0; k < planes; k++)
    piece += at[0] > plane_at[k];
  return piece;
}

/* Pieces beyond each plane have gone further by the opening along x and by `slide` along y; all is
   strained along x, and turned at last. */
static void part(strip *s, int planes, const double *opening, double slide, double strain,
                 double angle) {
  const rows *g = s->of->lattice;
  for (long p = 0; p < g->particle_count; p++) {
    const int32_t q = g->particle_site[p];
    double x = g->x[q] * (1 + strain), y = g->y[q] * (1 - 0.2 * strain);
    for (int k = 0; k < piece_of(g, q, planes); k++) {
      x += opening[k];
      y += slide;
    }
    s->of->displacement[0][q] = x * cos(angle) - y * sin(angle) - g->x[q];
    s->of->displacement[1][q] = x * sin(angle) + y * cos(angle) - g->y[q];
  }
  for (long m = 0; m < g->bond_count; m++)
    if (piece_of(g, g->particle_site[s->bonds[m].i], planes) !=
        piece_of(g, g->particle_site[s->bonds[m].j], planes))
      s->state->new_field[0][s->bonds[m].slot] = 1;
}

static crack_line *line_along(const strip *s, double y) {
  double outside[3];
  crack_line *l = crack_line_new(s->of, &s->law, 1, (double[3]){0.02, y, 0},
                                 (double[3]){0.18, y, 0}, 0.5, outside);
  assert_non_null(l);
  return l;
}

/* --- known openings --------------------------------------------------------------------------- */

/* The line lies across cells, along a row of sites, and in lattices turned against it. */
static void pieces_part_to_rounding(void **state) {
  (void)state;
  static const double rotation[] = {0, 0, 17, 30}, angle[] = {0, 0.3, 2};
  static const double opening[PLANES] = {2.3e-4, 1.1e-5};
  for (int n = 0; n < 4; n++)
    for (int a = 0; a < 3; a++)
      for (int planes = 1; planes <= PLANES; planes++) {
        strip s;
        open_strip(&s, 0.01, rotation[n]);
        part(&s, planes, opening, 0, 0, angle[a]);
        crack_line *l = line_along(&s, n == 1 ? 2 * sqrt(0.75) * 0.01 : 0.0237);
        long count;
        const crack *found = crack_line_find(l, &count);
        assert_int_equal(count, planes);
        for (int k = 0; k < planes; k++) {
          assert_true(fabs(found[k].width - opening[k]) < 1e-15);
          assert_true(fabs(found[k].place + 0.02 - plane_at[k]) < 0.006);
        }
        assert_true(fabs(crack_line_widest(l) - opening[0]) < 1e-15);
        crack_line_free(l);
        close_strip(&s);
      }
}

/* Faces that slide do not open. */
static void what_slides_does_not_open(void **state) {
  (void)state;
  static const double opening[1] = {1e-4};
  strip s;
  open_strip(&s, 0.01, 0);
  part(&s, 1, opening, 1e-6, 0, 0);
  crack_line *l = line_along(&s, 0.0237);
  assert_true(fabs(crack_line_widest(l) - 1e-4) < 1e-11); /* slide^2 over the line's length */
  crack_line_free(l);
  close_strip(&s);
}

static double strained_error(double spacing, double strain) {
  static const double opening[1] = {1e-4};
  strip s;
  open_strip(&s, spacing, 0);
  part(&s, 1, opening, 0, strain, 0);
  crack_line *l = line_along(&s, 0.0237);
  long count;
  const double error = fabs(crack_line_find(l, &count)->width - opening[0]);
  assert_int_equal(count, 1);
  crack_line_free(l);
  close_strip(&s);
  return error;
}

/* Bonds that have failed show no strain: that of their cell is counted, and falls with the spacing.
   */
static void the_error_of_a_strained_body_falls_with_the_spacing(void **state) {
  (void)state;
  const double strain = 1e-4, coarse = strained_error(0.01, strain),
               fine = strained_error(0.0025, strain);
  print_message("error %.2e, %.2e m of 1e-4\n", coarse, fine);
  assert_true(coarse < strain * 0.01 * (1 + 1e-6) && fine < strain * 0.0025 * (1 + 1e-6));
  assert_true(coarse > 1e-9); /* there is one */
}

/* --- no crack, and everywhere a little -------------------------------------------------------- */

static void a_whole_body_has_no_crack(void **state) {
  (void)state;
  strip s;
  open_strip(&s, 0.01, 11);
  part(&s, 0, NULL, 0, 1e-3, 0.1);
  crack_line *l = line_along(&s, 0.031);
  long count;
  crack_line_find(l, &count);
  assert_int_equal(count, 0);
  assert_true(crack_line_widest(l) == 0);
  crack_line_free(l);
  close_strip(&s);
}

/* Of a strain e that all bonds bear with the damage D the part D e stays when it is unloaded. */
static void even_damage_opens_by_its_part(void **state) {
  (void)state;
  const double strain = 1e-4;
  strip s;
  open_strip(&s, 0.01, 11);
  part(&s, 0, NULL, 0, strain, 0.1);
  for (long m = 0; m < s.of->lattice->bond_count; m++)
    s.state->new_field[0][s.bonds[m].slot] = 0.6;
  crack_line *l = line_along(&s, 0.031);
  long count;
  const crack *found = crack_line_find(l, &count);
  assert_int_equal(count, 1);
  /* bonds across the strain are pressed, and bear all of it */
  assert_true(fabs(found[0].width / (0.6 * strain * 0.16) - 1) < 0.1);
  assert_true(fabs(found[0].place - 0.08) < 1e-3);
  part(&s, 0, NULL, 0, -strain, 0.1);
  assert_true(crack_line_widest(l) < 1e-12); /* closed */
  crack_line_free(l);
  close_strip(&s);
}

/* All is damaged a little: what opens beside a crack is its own, between two half each one's. */
static void damage_beside_a_crack_is_its_own(void **state) {
  (void)state;
  static const double opening[PLANES] = {2e-4, 1e-4};
  const double strain = 1e-4;
  for (int planes = 0; planes <= PLANES; planes++) {
    strip s;
    long count;
    open_strip(&s, 0.01, 0);
    part(&s, planes, opening, 0, strain, 0);
    const rows *g = s.of->lattice;
    for (long m = 0; m < g->bond_count; m++)
      if (s.state->new_field[0][s.bonds[m].slot] < 1) s.state->new_field[0][s.bonds[m].slot] = 0.2;
    crack_line *l = line_along(&s, 3 * sqrt(0.75) * 0.01); /* along a row */
    const crack *found = crack_line_find(l, &count);
    assert_int_equal(count, planes);
    const double half = 0.5 * (plane_at[0] + plane_at[1]) - 0.02,
                 share = planes == 2 ? half : 0.16; /* of the line, that is the first one's */
    for (int k = 0; k < planes; k++) {
      const double whole = opening[k] + 0.2 * strain * (k ? 0.16 - share : share);
      assert_true(fabs(found[k].width - whole) < 2e-6); /* and of the cell, all strain */
      assert_true(found[k].width > whole);
    }
    crack_line_free(l);
    close_strip(&s);
  }
}

/* --- where it cannot be ----------------------------------------------------------------------- */

static void a_line_must_lie_inside(void **state) {
  (void)state;
  double outside[3];
  strip s;
  open_strip(&s, 0.01, 0);
  static const double from[3] = {0.02, 0.03, 0}, to[2][3] = {{0.25, 0.03, 0}, {1e9, 0.03, 0}};
  for (int n = 0; n < 2; n++) {
    assert_null(crack_line_new(s.of, &s.law, 1, from, to[n], 0.5, outside));
    assert_true(outside[0] > 0.195);
  }
  close_strip(&s);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(pieces_part_to_rounding),
      cmocka_unit_test(what_slides_does_not_open),
      cmocka_unit_test(the_error_of_a_strained_body_falls_with_the_spacing),
      cmocka_unit_test(a_whole_body_has_no_crack),
      cmocka_unit_test(even_damage_opens_by_its_part),
      cmocka_unit_test(damage_beside_a_crack_is_its_own),
      cmocka_unit_test(a_line_must_lie_inside)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
