/* splm_concrete whose plastic strain flows instead of its stretches (Nikravesh 2017, eqs 3.47 to
   3.49): what this changes in a prism is what the gallery says. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "tests/verification/page.h"
#include "tests/verification/specimen.h"

static void gallery_says_the_peak(const char *prism, const char *until, const char *line) {
  char figure[40];
  const outcome o = specimen_run(prism, until, "material.plastic=strain");
  snprintf(figure, sizeof figure, "%.1f kN", o.peak / 1e3);
  print_message("%s: peak %s at %.3f ms\n", prism, figure, 1e3 * o.time);
  page_line_says("models/README.md", line, figure);
}

static void the_prism_peaks_as_the_gallery_says(void **state) {
  (void)state;
  gallery_says_the_peak("examples/compression/rot0.nml", "7 ms", "- **What flows.**");
  gallery_says_the_peak("examples/compression/rot15.nml", "6.2 ms", "  from 402.5 to");
}

int main(void) {
  const struct CMUnitTest tests[] = {cmocka_unit_test(the_prism_peaks_as_the_gallery_says)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
