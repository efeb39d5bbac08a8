/* States that are tensors, end to end: on lattices the same bits whatever
   the threads and after a resume, their components in results; deviators beside tensors, and what
   is said of their zz; and solvers of meshes, whose law of a continuum and law of cracks they
   hold. */
#define _GNU_SOURCE /* nftw */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "tests/generator/command_tools.h"
#include "tests/verification/same_bits.h"

#define REMEMBERING SOURCE_DIR "/tests/generator/families/remembering.plm"
#define TURNED                                                                                     \
  "&simulation end_time = '0.1 ms' threads = %d /\n"                                               \
  "&lattice name = 'l' %s spacing = '5 mm' /\n"                                                    \
  "&material lattice = 'l' model = '" REMEMBERING "' /\n"                                          \
  "&body lattice = 'l' %s /\n"                                                                     \
  "&region name = 'low' shape = 'rectangle' corner = -1, -1 size = 2, '1.006 m' /\n"               \
  "&region name = 'top' shape = 'rectangle' corner = -1, '34 mm' size = 2, 1 /\n"                  \
  "&support region = 'low' fix = 'xy' /\n"                                                         \
  "&drive region = 'top' component = 'x' velocity = '2 m/s' rise = '0.02 ms' /\n"                  \
  "&monitor name = 'load' kind = 'reaction' region = 'top' component = 'x' /\n"                    \
  "&output frames = 2 fields = 'seen_xy', 'seen_yz', 'shear', 'strain' result = 'turned.h5' "      \
  "sample = '0.02 ms' /\n"

static const struct {
  const char *lattice, *body;
} runs[] = {{"kind = 'hexagonal' thickness = '10 mm'",
             "shape = 'rectangle' corner = 0, 0 size = '60 mm', '40 mm'"},
            {"kind = 'square' thickness = '10 mm' horizon = 3",
             "shape = 'rectangle' corner = 0, 0 size = '60 mm', '40 mm'"}};
enum { RUNS = sizeof runs / sizeof *runs };

static void open_turned(deck_case *c, size_t k, int threads) {
  char text[4096];
  snprintf(text, sizeof text, TURNED, threads, runs[k].lattice, runs[k].body);
  deck_case_open(c, text);
}

static void threads_and_a_resume_give_the_same_bits(void **state) {
  (void)state;
  for (size_t k = 0; k < RUNS; k++)
    assert_same_bits_of(open_turned, k);
}

/* An output that reads a component has that field's values; in the plane nothing leaves it. */
static void components_stand_in_results(void **state) {
  workplace *w = *state;
  char text[4096];
  snprintf(text, sizeof text, TURNED, 1, runs[0].lattice, runs[0].body);
  write_text(w, "turned.nml", text);
  expect(w, "run turned.nml", 0, "turned.h5 (3 frames)");
  expect(w, "info turned.h5", 0, "seen_xy, seen_yz, shear");
  expect(w,
         "export turned.h5 --frame -1 -o frame.csv --field seen_xy --field shear --field seen_yz",
         0, "");
  assert_int_equal(shell(w, "awk -F, 'NR > 1 { n = NF; if ($(n-2) != 0) moved++; "
                            "if ($(n-2) != $(n-1) || $n != 0) bad++ } "
                            "END { exit !(moved > 50 && !bad) }' frame.csv || head -3 frame.csv"),
                   0);
  assert_string_equal(w->said, "");
}

/* --- deviators -------------------------------------------------------------------------------- */

static const struct {
  const char *lattice, *body, *low, *top;
} pulled[] = {{"kind = 'hexagonal' thickness = '10 mm'",
               "shape = 'rectangle' corner = 0, 0 size = '60 mm', '40 mm'",
               "shape = 'rectangle' corner = -1, -1 size = 2, '1.006 m'",
               "shape = 'rectangle' corner = -1, '34 mm' size = 2, 1"},
              {"kind = 'cubic' horizon = 2",
               "shape = 'box' corner = 0, 0, 0 size = '30 mm', '20 mm', '20 mm'",
               "shape = 'box' corner = -1, -1, -1 size = 2, '1.006 m', 2",
               "shape = 'box' corner = -1, '14 mm', -1 size = 2, 1, 2"}};

static void write_pulled(const workplace *w, int k, const char *word, const char *field) {
  char text[4096], name[64];
  snprintf(text, sizeof text,
           "&simulation end_time = '0.05 ms' /\n"
           "&lattice name = 'l' %s spacing = '5 mm' /\n"
           "&material lattice = 'l' model = './as_%s.plm' /\n"
           "&body lattice = 'l' %s /\n"
           "&region name = 'low' %s /\n"
           "&region name = 'top' %s /\n"
           "&support region = 'low' fix = 'xy' /\n"
           "&drive region = 'top' component = 'x' velocity = '2 m/s' rise = '0.02 ms' /\n"
           "&drive region = 'top' component = 'y' velocity = '1 m/s' rise = '0.02 ms' /\n"
           "&output frames = 2 fields = 'displacement', 'strain', 'shape_xx', 'shape_yy', "
           "'shape_xy', 'shape_yz', 'shape_xz', 'handed_xy', '%s' result = '%s.h5' /\n",
           pulled[k].lattice, word, pulled[k].body, pulled[k].low, pulled[k].top, field, word);
  snprintf(name, sizeof name, "%s.nml", word);
  write_text(w, name, text);
}

/* The law that says `tensor` finds all that the one that says `deviator` does, zz among it, which
   of deviators is no field but may be an output. */
static void deviators_run_as_tensors_do(void **state) {
  workplace *w = *state;
  assert_int_equal(shell(w, "cp " SOURCE_DIR "/tests/generator/families/distorted.plm "
                            "as_deviator.plm && sed 's/= deviator 0/= tensor 0/; /shape_zz/d' "
                            "as_deviator.plm > as_tensor.plm"),
                   0);
  for (int k = 0; k < 2; k++) {
    write_pulled(w, k, "deviator", "shape_zz");
    write_pulled(w, k, "tensor", "shape_zz");
    expect(w, "run deviator.nml --interpret", 0, "(3 frames)");
    expect(w, "run tensor.nml --interpret", 0, "(3 frames)");
    expect(w, "compare deviator.h5 tensor.h5 --tolerance 1e-12", 0, "none differs");
    expect(w,
           "export deviator.h5 --frame -1 -o frame.csv --field shape_xx --field shape_yy "
           "--field shape_zz",
           0, "");
    assert_int_equal(shell(w, "awk -F, 'NR > 1 { sum = $(NF-2) + $(NF-1) + $NF; "
                              "if ($NF > 1e-5 || $NF < -1e-5) moved++; "
                              "if (sum > 1e-15 || sum < -1e-15) bad++ } "
                              "END { exit !(moved > 20 && !bad) }' frame.csv"),
                     0);
  }
  expect(w, "plot deviator.h5 --map shape --component principal --slice z=0.01 -o map.png", 0,
         "map.png");
  write_pulled(w, 0, "deviator", "handed_zz");
  expect(w, "check deviator.nml", 1,
         "hint: `handed` is a deviator, kept without zz = -(xx + yy): let the law give `output "
         "handed_zz = handed[z,z]`");
  write_pulled(w, 0, "deviator", "handed_xx', 'handed_yy', 'handed_yz', 'handed_xz");
  expect(w, "run deviator.nml --interpret", 0, "deviator.h5");
  expect(w, "plot deviator.h5 --map handed_zz -o map.png", 1,
         "no field `handed_zz`; `handed` is a deviator, kept without zz");
  write_pulled(w, 0, "tensor", "handed_zz");
  expect(w, "check tensor.nml", 0, "");
}

/* --- solvers of meshes ------------------------------------------------------------------------ */

static void solvers_hold_the_laws_of_a_mesh(void **state) {
  workplace *w = *state;
#if defined(__SANITIZE_ADDRESS__)
  skip(); /* its libraries need the sanitizer's */
#endif
  expect(w, "new tears --kind crack", 0, "written tears.plm, tears.nml");
  assert_int_equal(shell(w, "\"$P\" build tears.nml -o tears"), 0);
  assert_int_equal(shell(w, "./tears && mv tears.h5 solver.h5"), 0);
  expect(w, "run tears.nml", 0, "written");
  expect(w, "compare tears.h5 solver.h5", 0, "none differs");
  expect(w, "build tears.plm -o tip.so", 0, "written tip.so");
  assert_int_equal(
      shell(w, "\"$P\" build " SOURCE_DIR "/tests/generator/laws/hardening_point.plm -o point.so"),
      0);
}

int main(void) {
#define ONE(test) cmocka_unit_test_setup_teardown(test, set_up_workplace, tear_down_workplace)
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(threads_and_a_resume_give_the_same_bits),
      ONE(components_stand_in_results),
      ONE(deviators_run_as_tensors_do),
      ONE(solvers_hold_the_laws_of_a_mesh),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
