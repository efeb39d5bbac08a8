/* The thick ring of examples/thick_ring under pressure inside, in plane strain: elastic beside
   Lame, then yielding beside Hill (1950), who takes Tresca's condition with the shear strength
   k. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "tests/verification/case.h"
#include "tests/verification/page.h"

#define RING "examples/thick_ring/"

static const double a = 0.1, b = 0.2, E = 200e9, nu = 0.3, f_y = 250e6, pressure = 180.1954e6;

static double shear_strength(void) {
  return f_y / sqrt(3);
}

/* Radius up to which the ring has yielded: p = k (1 - c^2/b^2 + 2 ln(c/a)); a where it has not. */
static double yielded(double p) {
  double low = a, high = b;
  for (int n = 0; n < 60; n++) {
    const double c = (low + high) / 2;
    *(shear_strength() * (1 - c * c / (b * b) + 2 * log(c / a)) < p ? &low : &high) = c;
  }
  return low;
}

/* Of the inner edge. Elastic: Lame; else the change of volume is elastic and the shear at the
   border is k: u = 2 k c^2 (1 - nu^2)/(E a) - (1 - 2 nu)(1 + nu) a p/E. */
static double moved(double p) {
  const double c = yielded(p);
  if (c <= a * (1 + 1e-9))
    return (1 + nu) * p * a / (E * (b * b / (a * a) - 1)) * (1 - 2 * nu + b * b / (a * a));
  return 2 * shear_strength() * c * c * (1 - nu * nu) / (E * a) -
         (1 - 2 * nu) * (1 + nu) * a * p / E;
}

/* Where plastic strain ends, from what there is at a radius: the part of it around the ring is
   (1 - nu^2) 2k/E (c^2/r^2 - 1), the accumulated one 2/sqrt(3) of that. */
static double border(double flow, double radius) {
  return radius * sqrt(1 + flow * sqrt(3) / 2 / ((1 - nu * nu) * 2 * shear_strength() / E));
}

/* The same from how far the outer edge has moved: the elastic ring bears k at the border. */
static double border_by_outside(double outside) {
  return sqrt(outside * E * b / (2 * shear_strength() * (1 - nu * nu)));
}

typedef struct ring {
  deck_case run;
  const double *time, *inside, *outside, *force;
  long samples;
} ring;

static void press(ring *r) {
  static const char *const overrides[] = {"simulation.threads=1"};
  assert_true(deck_case_run(&r->run, RING "ring.nml", overrides, 1));
  assert_int_equal(deck_case_go(&r->run), STEP_END);
  r->samples = simulation_history(r->run.simulation, &r->time);
  r->inside = deck_case_series(&r->run, "inside");
  r->outside = deck_case_series(&r->run, "outside");
  r->force = deck_case_series(&r->run, "pressure_force");
}

static void page_row(double p, double expected, double found, double zone) {
  char line[32], figure[96];
  snprintf(line, sizeof line, "| %.1f |", 1e-6 * p);
  snprintf(figure, sizeof figure, "| %.1f | %.1f | %.1f | %.1f |", 1e3 * yielded(p), 1e3 * zone,
           1e6 * expected, 1e6 * found);
  page_line_says(RING "README.md", line, figure);
}

/* 24 chords around a quarter of the ring and 20 cells across: 0.1 % elastic. Yielding, 1 %: von
   Mises' metal flows along the ring's axis, too, which Hill leaves out. */
static void the_edges_move_as_lame_and_hill_have_it(void **state) {
  ring *r = *state;
  assert_int_equal(r->samples, 25);
  for (long n = 1; n < r->samples; n++) {
    const double p = pressure * r->time[n], expected = moved(p), c = yielded(p),
                 zone = border_by_outside(r->outside[n]), off = r->inside[n] / expected - 1;
    const bool flows = c > a * (1 + 1e-9);
    print_message("%.1f MPa: plastic to %.1f mm, by the outer edge %.1f, inside %.2f um, theory "
                  "%.2f (%+.2f %%)\n",
                  1e-6 * p, 1e3 * c, 1e3 * zone, 1e6 * r->inside[n], 1e6 * expected, 100 * off);
    assert_true(fabs(r->force[n] / (p * a * 0.01) - 1) < 1e-3);
    assert_true(fabs(off) < (flows ? 0.01 : 0.001));
    if (flows) assert_true(fabs(zone / c - 1) < 0.01);
    if (flows && n % 2 == 0) page_row(p, expected, r->inside[n], zone);
  }
}

static double *flow_at_nodes(ring *r) {
  const frame_field *fields;
  const int count = simulation_frame_fields(r->run.simulation, &fields);
  double *flow = calloc(1000, sizeof *flow);
  for (int k = 0; k < count; k++)
    if (strcmp(fields[k].name, "eps_bar") == 0 && !fields[k].on_cells)
      simulation_frame_values(r->run.simulation, k, flow);
  return flow;
}

/* A node has the mean of the cells around it: next to the inner edge and to the border these are on
   one side. */
static void strain_ends_at_the_border(void **state) {
  ring *r = *state;
  const rows *g = simulation_state(r->run.simulation, 0)->body->lattice;
  double *flow = flow_at_nodes(r);
  int within = 0, beyond = 0;
  assert_int_equal(g->particle_count, 525);
  for (long p = 0; p < g->particle_count; p++) {
    const long site = g->particle_site[p];
    const double radius = hypot(g->x[site], g->y[site]);
    if (radius > 0.1045 && radius < 0.1405) {
      assert_true(fabs(border(flow[p], radius) / 0.15 - 1) < 0.02);
      within++;
    }
    if (radius > 0.1595) {
      assert_true(flow[p] == 0);
      beyond++;
    }
  }
  assert_int_equal(within, 8 * 25);
  assert_int_equal(beyond, 9 * 25);
  free(flow);
}

static int open_ring(void **state) {
  static ring r;
  press(&r);
  *state = &r;
  return 0;
}

static int close_ring(void **state) {
  deck_case_close(&((ring *)*state)->run);
  return 0;
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(the_edges_move_as_lame_and_hill_have_it),
      cmocka_unit_test(strain_ends_at_the_border),
  };
  return cmocka_run_group_tests(tests, open_ring, close_ring);
}
