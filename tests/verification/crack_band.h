/* What tears the bars of examples/crack_band, over the fracture energy times their section; and
   what their page says of it. To be included after cmocka.h. */
#ifndef PERILAT_TESTS_CRACK_BAND_H
#define PERILAT_TESTS_CRACK_BAND_H

#include "tests/verification/case.h"
#include "tests/verification/page.h"

#define BANDS "examples/crack_band/"

typedef struct band {
  const char *law, *nu;
  int size;    /* of a cell, mm: 20, 10, 5 */
  bool turned; /* by 45 degrees */
} band;

static inline double band_work(const band *b) {
  char values[6][64];
  const char *overrides[8] = {"simulation.threads=1", "output.fields=displacement"};
  deck_case c;
  const double section = b->turned ? 0.056569 : 0.04; /* m: width */
  snprintf(values[0], 64, "material[1].model=%s", b->law);
  snprintf(values[1], 64, "material[2].model=%s", b->law);
  snprintf(values[2], 64, "material[1].nu=%s", b->nu);
  snprintf(values[3], 64, "material[2].nu=%s", b->nu);
  if (b->turned)
    snprintf(values[4], 64, "mesh.file=turned_%d.msh", b->size);
  else
    snprintf(values[4], 64, "mesh.nodes=%d, %d", 40 / b->size + 1, 120 / b->size + 1);
  snprintf(values[5], 64, "region[weak].size=40 mm, %d mm", b->size);
  for (int k = 0; k < 6; k++)
    overrides[2 + k] = values[k];
  if (!deck_case_run(&c, b->turned ? BANDS "turned.nml" : BANDS "bar.nml", overrides,
                     b->turned ? 7 : 8))
    fail_msg("the bar of cells of %d mm does not run", b->size);
  assert_int_equal(deck_case_go(&c), STEP_END);
  const double work = deck_case_last(&c, "energy/dissipated_damage"),
               ratio = work / (81.43 * section * 0.1);
  print_message("%s, nu %s, cells of %d mm%s: %.4f\n", b->law, b->nu, b->size,
                b->turned ? ", turned" : "", ratio);
  deck_case_close(&c);
  return ratio;
}

/* The line of a law and nu has the figure of a size. */
static inline void band_page(const band *b, double ratio) {
  char line[96], figure[32];
  snprintf(line, sizeof line, "| %s%s, nu %s |", b->law, b->turned ? ", turned" : "", b->nu);
  snprintf(figure, sizeof figure, " %.3f |", ratio);
  page_line_says(BANDS "README.md", line, figure);
}

#endif
