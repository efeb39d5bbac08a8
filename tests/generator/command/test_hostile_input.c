/* Decks and laws received from somebody else: files that they name are not shown, numbers beyond
   all computing are refused at their line, and what the machine does not give is said. */
#define _GNU_SOURCE
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "tests/generator/command_tools.h"

/* --- files that are named --------------------------------------------------------------------- */

static const char secret[] = "root:x:0:0:the secret of line one\n"
                             "daemon:x:1:1:the secret, of line two\n";
static const char secret_bytes[] = "\x7f"
                                   "ELF\x02\x01\x01\0\0\0\0the secret of a program\n";

static void reveals_nothing(workplace *w, const char *arguments, const char *wanted) {
  const int status = shell(w, "$P %s", arguments);
  if (status != 1 || strstr(w->said, "secret") || strstr(w->said, "daemon") ||
      strstr(w->said, "ELF") || !strstr(w->said, wanted))
    show_failure(w, arguments, status, 1, wanted);
  assert_int_equal(status, 1);
  assert_null(strstr(w->said, "secret"));
  assert_null(strstr(w->said, "daemon"));
  assert_null(strstr(w->said, "ELF"));
  assert_non_null(strstr(w->said, wanted));
}

static void named_files_are_not_shown(void **state) {
  workplace *w = *state;
  write_text(w, "passwd.plm", secret);
  write_bytes(w, "program.plm", secret_bytes, sizeof secret_bytes - 1);
  write_text(w, "includes.plm",
             "model m\n  law central bond\n  include \"passwd.plm\"\n  parameter rho = 1 [kg/m^3]\n"
             "  force N = 1 [N]*stretch\nend model\n");
  write_text(w, "includes_bytes.plm",
             "model m\n  law central bond\n  include \"program.plm\"\n  force N = 1 [N]*stretch\n"
             "end model\n");
  write_text(w, "path.nml",
             "&material model = 'passwd.plm' /\n&path quantity = 'stretch' value = 0.1 /\n");
  write_text(w, "table.nml",
             "&simulation end_time = '1 ms' /\n"
             "&lattice name = 'a' kind = 'particles' file = 'passwd.plm' thickness = 1 /\n"
             "&material lattice = 'a' model = 'splm_elastic' /\n"
             "&body lattice = 'a' shape = 'rectangle' corner = 0, 0 size = 1, 1 /\n");
  static const char law[] = "`./passwd.plm` is not a law";
  reveals_nothing(w, "check beam.nml --set material.model=passwd.plm", law);
  reveals_nothing(w, "check beam.nml --set material.lattice=none --set material.model=passwd.plm",
                  law);
  reveals_nothing(w, "run beam.nml --set material.model=passwd.plm", law);
  reveals_nothing(w, "build beam.nml --set material.model=passwd.plm", "");
  reveals_nothing(w, "check --dump=c beam.nml --set material.model=passwd.plm", law);
  reveals_nothing(w, "check --diagnostics=json beam.nml --set material.model=passwd.plm", law);
  reveals_nothing(w, "run beam.nml --set material.model=program.plm", "is not a law");
  reveals_nothing(w, "drive path.nml", law);
  reveals_nothing(w, "check path.nml", law);
  reveals_nothing(w, "check includes.plm", "`passwd.plm` holds no functions and constants");
  reveals_nothing(w, "explain includes.plm", "`passwd.plm` holds no functions and constants");
  reveals_nothing(w, "check includes_bytes.plm", "`program.plm` holds no functions and constants");
  reveals_nothing(w, "check table.nml", "`passwd.plm` is not a table");
}

/* --- numbers ---------------------------------------------------------------------------------- */

static void refused_at_its_line(workplace *w, const char *setting, const char *wanted) {
  char line[400];
  snprintf(line, sizeof line, "run beam.nml --set %s", setting);
  expect(w, line, 1, wanted);
  assert_non_null(strstr(w->said, "--set:1:"));
  assert_null(strstr(w->said, "fault of the compiler"));
}

static void numbers_beyond_computing_are_refused(void **state) {
  workplace *w = *state;
  refused_at_its_line(w, "lattice.thickness=5e-324",
                      "`thickness` is too small to compute with: the least is 1e-40 m");
  refused_at_its_line(w, "lattice.thickness=1e308",
                      "`thickness` is too large to compute with: the most is 1e+40 m");
  refused_at_its_line(w, "lattice.spacing=1e-300", "`spacing` is too small");
  refused_at_its_line(w, "lattice.mass_thickness=1e300", "`mass_thickness` is too large");
  refused_at_its_line(w, "material.rho=1e308", "`rho` = 1e+308 is too large");
  refused_at_its_line(w, "material.rho=5e-324", "`rho` = 4.9406565e-324 is too small");
  refused_at_its_line(w, "material.E=1e-308", "`E` = 1e-308 is too small");
  refused_at_its_line(w, "drive.velocity=1e200", "`velocity` is too large");
  refused_at_its_line(w, "drive.rise=5e-324", "`rise` is too small");
  refused_at_its_line(w, "simulation.end_time=5e-324", "`end_time` is too small");
  refused_at_its_line(w, "simulation.step=5e-324", "`step` is too small");
  refused_at_its_line(w, "simulation.step_safety=1e-300", "`step_safety` is too small");
}

/* What is not refused has energies, or is said to be no run. */
static void numbers_at_the_limit_are_computed_with(void **state) {
  workplace *w = *state;
  static const char *const settings[] = {
      "material.rho=1e99 --set material.E=1e99 --set simulation.end_time=1",
      "material.rho=1e-99 --set material.E=1e-99 --set simulation.end_time=1",
      "material.E=1e-50 --set simulation.end_time=1e25 --set drive.velocity=1e-30",
      "lattice.mass_thickness=1e39 --set simulation.end_time=1e16 --set drive.velocity=1e-21",
      "lattice.thickness=1e-39",
      "lattice.thickness=1e39",
      "drive.velocity=5e-324"};
  for (size_t k = 0; k < sizeof settings / sizeof *settings; k++) {
    const int status = shell(w, "$P run beam.nml --set %s", settings[k]);
    if (status != 0 || strstr(w->said, "inf ") || strstr(w->said, "nan") ||
        strstr(w->said, "inf,") || !strstr(w->said, "imbalance"))
      fail_msg("%s: status %d\n%s", settings[k], status, w->said);
  }
  expect(w, "run beam.nml --set material.rho=1e99", 1, "is shorter than one step");
}

static void energies_beyond_computing_fail_the_run(void **state) {
  workplace *w = *state;
  write_text(w, "huge.plm",
             "model huge\n  law central bond\n  parameter rho = 2323 [kg/m^3]\n"
             "  parameter K = 1 [MN] in (0, inf)\n  parameter huge = 1 in (0, inf)\n"
             "  energy W = K*s*stretch**2*huge**4/2\n  force N = K*stretch\nend model\n");
  assert_int_equal(shell(w, "grep -v '^&material' beam.nml > huge.nml; echo \"&material "
                            "lattice='concrete' model='./huge.plm' /\" >> huge.nml"),
                   0);
  expect(w, "run huge.nml", 0, "imbalance");
  expect(w, "run huge.nml --set material.huge=1e99", 2, "energies that are not finite");
}

/* A law whose own numbers are as small is not blamed. */
static void tiny_laws_are_no_fault_of_the_compiler(void **state) {
  workplace *w = *state;
  write_text(w, "tiny.plm",
             "model tiny\n  law central bond\n  parameter rho = 1 [kg/m^3]\n"
             "  parameter E = 1e-307 [Pa]\n  force N = E*area*stretch\nend model\n");
  expect(w, "check tiny.plm", 0, "no errors");
}

/* --- the machine ------------------------------------------------------------------------------ */

static void a_cache_that_cannot_be_used_is_named(void **state) {
  workplace *w = *state;
  assert_int_equal(shell(w, "TMPDIR=$PWD PERILAT_CACHE=/dev/null/cache $P run beam.nml"), 0);
  static const char said[] = "perilat: warning: the cache `/dev/null/cache` cannot be written to "
                             "(Not a directory): compiled kernels are kept in `";
  const char *once = strstr(w->said, said);
  assert_non_null(once);
  assert_null(strstr(once + 1, said));
  assert_int_equal(shell(w, "PERILAT_CACHE=$PWD/cache $P run beam.nml"), 0);
  assert_null(strstr(w->said, "cache"));
}

/* Of no memory at all, of too little to begin with, of enough. */
static void memory_that_there_is_not_is_not_made_up(void **state) {
#ifdef PERILAT_ADDRESS_SANITIZER
  (void)state; /* takes terabytes of addresses for itself */
#else
  workplace *w = *state;
  int enough = 0, refused = 0;
  for (int kilobytes = 20000; kilobytes <= 240000; kilobytes += 5000) {
    const int status = shell(w, "ulimit -v %d && $P check beam.nml", kilobytes);
    assert_null(strstr(w->said, "18446744073709551615"));
    if (strstr(w->said, "perilat: out of memory (")) assert_int_equal(status, 2);
    refused += strstr(w->said, "perilat: out of memory (") != NULL;
    enough += status == 0;
  }
  assert_true(refused > 0 && enough > 0);
#endif
}

/* Where all private folders are taken by others, nothing is put into theirs, nor loaded from there.
   */
static void kernels_go_to_no_folder_of_others(void **state) {
  workplace *w = *state;
  assert_int_equal(shell(w, "mkdir t && for k in $(seq 0 99); do mkdir -m 777 "
                            "t/perilat-$(id -u)-$k; done"),
                   0);
  assert_int_equal(shell(w, "PERILAT_CACHE=/proc/none TMPDIR=$PWD/t $P run beam.nml"), 2);
  assert_non_null(strstr(w->said, "cannot write `/dev/null/"));
  assert_int_equal(shell(w, "test -z \"$(find t -type f)\""), 0);
}

#define T(test) cmocka_unit_test_setup_teardown(test, set_up_workplace, tear_down_workplace)

int main(void) {
  const struct CMUnitTest tests[] = {
      T(named_files_are_not_shown),
      T(numbers_beyond_computing_are_refused),
      T(numbers_at_the_limit_are_computed_with),
      T(energies_beyond_computing_fail_the_run),
      T(tiny_laws_are_no_fault_of_the_compiler),
      T(a_cache_that_cannot_be_used_is_named),
      T(kernels_go_to_no_folder_of_others),
      T(memory_that_there_is_not_is_not_made_up),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
