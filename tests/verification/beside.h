/* Specimens of examples/ as meshes of finite elements, beside the lattice: the peak of the load, and
   what their pages say of it. To be included after cmocka.h. */
#ifndef PERILAT_TESTS_BESIDE_H
#define PERILAT_TESTS_BESIDE_H

#include "tests/verification/case.h"
#include "tests/verification/page.h"

typedef struct beside {
  const char *example, *deck, *until; /* `until` is past the peak */
  double theory;                      /* N: f A, of a disc eq 5.6 */
  double least, most;                 /* parts of it: what the peak must lie between */
} beside;

typedef struct beside_peak {
  double load, displacement; /* N, m */
  double ends;               /* what the ends differ by there, over the load */
} beside_peak;

static inline beside_peak beside_run(const beside *b) {
  char path[128], until[64];
  deck_case c;
  snprintf(path, sizeof path, "examples/%s/%s.nml", b->example, b->deck);
  snprintf(until, sizeof until, "simulation.end_time=%s", b->until);
  const char *overrides[] = {"simulation.threads=1", until, "output.frames=0"};
  if (!deck_case_run(&c, path, overrides, 3)) fail_msg("%s does not run", path);
  const step_status status = deck_case_go(&c);
  assert_true(status == STEP_END || status == STEP_STOPPED);
  const double *load = deck_case_series(&c, "load");
  const long samples = simulation_history(c.simulation, NULL), at = largest_of(load, samples);
  assert_true(at < samples - 5);
  const beside_peak p = {
      load[at], deck_case_series(&c, "displacement")[at],
      fabs(deck_case_series(&c, "top")[at] - deck_case_series(&c, "bottom")[at]) / load[at]};
  print_message("%s: %.2f kN at %.2f um, %+.2f %% of theory, ends differ by %.2g\n", path,
                1e-3 * p.load, 1e6 * p.displacement, 100 * (p.load / b->theory - 1), p.ends);
  deck_case_close(&c);
  return p;
}

/* Runs, compares, and asks the example's page and the table of all. */
static inline double beside_check(const beside *b) {
  const beside_peak p = beside_run(b);
  char line[96], figure[64], page[96];
  assert_true(p.load > b->least * b->theory && p.load < b->most * b->theory);
  assert_true(p.ends < 0.02);
  snprintf(page, sizeof page, "examples/%s/README.md", b->example);
  snprintf(line, sizeof line, "| [%s.nml](%s.nml) |", b->deck, b->deck);
  snprintf(figure, sizeof figure, p.load < 100e3 ? " %.2f kN" : " %.1f kN", 1e-3 * p.load);
  page_line_says(page, line, figure);
  snprintf(line, sizeof line, "| [%s](%s/%s.nml)", b->deck, b->example, b->deck);
  page_line_says("examples/README.md", line, figure);
  return p.load;
}

#endif
