/* Decks of examples/reinforced_concrete: a load that grows and is held is borne or not; what the
   page says of it. */
#ifndef PERILAT_TESTS_HELD_LOAD_H
#define PERILAT_TESTS_HELD_LOAD_H

#include "tests/verification/case.h"
#include "tests/verification/page.h"

#define FOLDER "examples/reinforced_concrete/"
/* A line of the page's table holds both texts. */
static inline void page_says(const char *beginning, const char *figure) {
  page_line_says(FOLDER "README.md", beginning, figure);
}

/* A deck until its end, with overrides: a list that ends with NULL. */
static inline void run(deck_case *c, const char *deck_name, const char *const *overrides) {
  char path[256];
  int count = 0;
  while (overrides[count])
    count++;
  snprintf(path, sizeof path, FOLDER "%s.nml", deck_name);
  assert_true(deck_case_run(c, path, overrides, count));
  const step_status status = deck_case_go(c);
  assert_true(status == STEP_END || status == STEP_STOPPED);
  const long samples = simulation_history(c->simulation, NULL);
  const double imbalance = deck_case_series(c, "energy/imbalance")[samples - 1],
               external = deck_case_series(c, "energy/external")[samples - 1];
  if (!(fabs(imbalance) < 1e-2 * external)) fail_msg("%s: imbalance %g J", deck_name, imbalance);
}

static inline double largest_in(const double *values, const double *time, long samples, double from,
                                double until) {
  double most = 0;
  for (long k = 0; k < samples; k++)
    if (time[k] >= from && time[k] <= until) most = fmax(most, fabs(values[k]));
  return most;
}

/* So many kN on a prism in all, on a beam along its 1.2 m. */
static inline void load_override(const char *deck_name, double kN, char text[64]) {
  const bool prism = strstr(deck_name, "tension") || strstr(deck_name, "compression");
  if (prism)
    snprintf(text, 64, "force.total=%.9g kN", kN);
  else
    snprintf(text, 64, "force.per_length=%.9g kN/m", kN / 1.2);
}

/* Under the force `kN` held from `held`, s, on: the deflection of the second half of the hold is
   that of the first, within 5 %. */
static inline bool bears_with(const char *deck_name, double kN, double held,
                              const char *const *more) {
  deck_case c;
  char total[64];
  const char *overrides[8] = {"simulation.threads=1", total};
  for (int k = 2; k < 7 && *more; k++)
    overrides[k] = *more++;
  load_override(deck_name, kN, total);
  run(&c, deck_name, overrides);
  const double *time, *deflection = deck_case_series(&c, "deflection"),
                      *load = deck_case_series(&c, "load");
  const long samples = simulation_history(c.simulation, &time);
  const double end = time[samples - 1], middle = (held + end) / 2;
  const double first = largest_in(deflection, time, samples, held, middle),
               second = largest_in(deflection, time, samples, middle, end);
  assert_true(fabs(fabs(load[samples - 1]) - 1e3 * fabs(kN)) < 1e-6);
  print_message("%s, %g kN: deflection %.4g, then %.4g m\n", deck_name, kN, first, second);
  deck_case_close(&c);
  return second <= 1.05 * first;
}

static inline bool bears(const char *deck_name, double kN, double held) {
  return bears_with(deck_name, kN, held, (const char *[]){NULL});
}

/* The peak of a twin by displacement is what the page's row says; at the end at most a part `left`
   of it is borne. */
static inline void carries(const char *deck_name, const char *more, const char *row,
                           const char *form, double left) {
  deck_case c;
  char figure[64];
  run(&c, deck_name, (const char *[]){"simulation.threads=1", more, NULL});
  const double most = deck_case_largest(&c, "load"), last = fabs(deck_case_last(&c, "load"));
  print_message("%s: peak %.6g N, %.6g N left\n", deck_name, most, last);
  snprintf(figure, sizeof figure, form, most / 1e3);
  page_says(row, figure);
  assert_true(last <= left * most);
  deck_case_close(&c);
}

#endif
