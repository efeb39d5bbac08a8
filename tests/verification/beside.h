/* Specimens of examples/ as meshes of finite elements, beside the lattice: the peak of the load,
   and what their pages say of it. To be included after cmocka.h. */
#ifndef PERILAT_TESTS_BESIDE_H
#define PERILAT_TESTS_BESIDE_H

#include "tests/verification/case.h"
#include "tests/verification/page.h"

typedef struct beside {
  const char *example, *deck, *until; /* `until` is past the peak */
  double theory;                      /* N: f A, of a disc eq 5.6 */
  double least, most;                 /* parts of it: what the peak must lie between */
  const char *mesh;                   /* another file of it, or NULL */
} beside;

typedef struct beside_peak {
  double load, displacement; /* N, m */
  double ends;               /* what the ends differ by there, over the load */
} beside_peak;

static inline void beside_open(deck_case *c, const beside *b) {
  char path[128], until[64], file[64];
  snprintf(path, sizeof path, "examples/%s/%s.nml", b->example, b->deck);
  snprintf(until, sizeof until, "simulation.end_time=%s", b->until);
  snprintf(file, sizeof file, "mesh.file=%s", b->mesh ? b->mesh : "");
  const char *overrides[] = {"simulation.threads=1", until, "output.frames=0", file};
  if (!deck_case_run(c, path, overrides, b->mesh ? 4 : 3)) fail_msg("%s does not run", path);
  const step_status status = deck_case_go(c);
  assert_true(status == STEP_END || status == STEP_STOPPED);
}

static inline beside_peak beside_run(const beside *b) {
  deck_case c;
  beside_open(&c, b);
  const double *load = deck_case_series(&c, "load"), *top = deck_case_series(&c, "top"),
               *bottom = deck_case_series(&c, "bottom");
  const long samples = simulation_history(c.simulation, NULL), at = largest_of(load, samples);
  assert_true(at < samples - 5);
  const beside_peak p = {load[at], deck_case_series(&c, "displacement")[at],
                         fabs(top[at] - bottom[at]) / load[at]};
  print_message("%s/%s: %.2f kN at %.2f um, %+.2f %% of theory, ends differ by %.2g\n", b->example,
                b->deck, 1e-3 * p.load, 1e6 * p.displacement, 100 * (p.load / b->theory - 1),
                p.ends);
  assert_true(p.load > b->least * b->theory && p.load < b->most * b->theory);
  assert_true(p.ends < 0.02);
  deck_case_close(&c);
  return p;
}

/* Of the load at the end, over the theory. */
static inline double beside_at_end(const beside *b) {
  deck_case c;
  beside_open(&c, b);
  const double load = deck_case_last(&c, "load");
  print_message("%s/%s: %.1f kN after %s\n", b->example, b->deck, 1e-3 * load, b->until);
  deck_case_close(&c);
  return load / b->theory;
}

/* Runs, compares, and asks the example's page and the table of all. */
static inline double beside_check(const beside *b) {
  const beside_peak p = beside_run(b);
  char line[96], figure[64], page[96];
  snprintf(page, sizeof page, "examples/%s/README.md", b->example);
  snprintf(line, sizeof line, "| [%s.nml](%s.nml) |", b->deck, b->deck);
  snprintf(figure, sizeof figure, p.load < 100e3 ? " %.2f kN" : " %.1f kN", 1e-3 * p.load);
  page_line_says(page, line, figure);
  snprintf(line, sizeof line, "| [%s](%s/%s.nml)", b->deck, b->example, b->deck);
  page_line_says("examples/README.md", line, figure);
  return p.load;
}

#endif
