/* What other programs read: --json writes one valid document and nothing else on the standard
   output, whatever happens, with no key that the reference does not tell of; and `-`, which is the
   standard input. */
#define _GNU_SOURCE
#include <setjmp.h>
#include <stdarg.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include <math.h>

#include "runtime/result/result_file.h"
#include "runtime/result/result_read.h"
#include "tests/dsl/json_valid.h"
#include "tests/generator/command_tools.h"

static void assert_holds(const char *text, const char *part) {
  if (!strstr(text, part)) fail_msg("no %s in\n%s", part, text);
}

/* What `perilat <arguments>` writes on the standard output: one document, also to python's reader.
   malloc'ed. */
static char *document_of(workplace *w, const char *arguments, int status) {
  const int found = shell(w, "$P %s > document 2> words", arguments);
  size_t size;
  char *text = read_bytes(w, "document", &size);
  if (found != status || !json_is_valid(text) || strlen(text) != size)
    fail_msg("%s\n  gave status %d (expected %d) and\n%s", arguments, found, status, text);
  assert_int_equal(
      shell(w, "! command -v python3 >/dev/null || python3 -m json.tool document >/dev/null"), 0);
  static const char begins[] = "{\n  \"schema\": 1,\n  \"perilat\": \"0.1.0\",\n";
  assert_memory_equal(text, begins, sizeof begins - 1);
  assert_non_null(strstr(text, "\n  \"error\": "));
  return text;
}

static void expect_document(workplace *w, const char *arguments, int status, const char *part) {
  char *text = document_of(w, arguments, status);
  assert_holds(text, part);
  free(text);
}

/* The number after `"key": `, from `at` on. */
static double number_after(const char *at, const char *key) {
  char quoted[100];
  snprintf(quoted, sizeof quoted, "\"%s\": ", key);
  at = strstr(at, quoted);
  assert_non_null(at);
  return strtod(at + strlen(quoted), NULL);
}

static double *series_of(const workplace *w, const char *file, const char *name, long *count) {
  result_file *f = open_result_of(w, file);
  char unit_text[64], error[1000];
  double *values =
      result_read_series(f, name, count, unit_text, sizeof unit_text, error, sizeof error);
  assert_non_null(values);
  result_read_close(f);
  return values;
}

/* --- run -------------------------------------------------------------------------------------- */

/* To the last bit what the result holds. */
static void a_run_tells_how_it_ended(void **state) {
  workplace *w = *state;
  char *text = document_of(w, "run beam.nml --json", 0);
  assert_holds(text, "\"status\": \"end\",\n  \"signal\": null,");
  assert_holds(text, "\"files\": [\n    \"beam.h5\",\n    \"beam.xdmf\"\n  ]");
  assert_holds(text, "\"checked\": true,\n    \"unchecked\": null");
  assert_holds(text, "\"error\": null");
  static const char *const series[][2] = {
      {"time", "time"}, {"energy/external", "external"}, {"energy/imbalance", "imbalance"}};
  for (size_t k = 0; k < sizeof series / sizeof *series; k++) {
    long count;
    double *values = series_of(w, "beam.h5", series[k][0], &count);
    assert_true(number_after(text, series[k][1]) == values[count - 1]);
    free(values);
  }
  long count;
  double *load = series_of(w, "beam.h5", "load", &count), largest = 0;
  for (long k = 0; k < count; k++)
    if (fabs(load[k]) > fabs(largest)) largest = load[k];
  assert_holds(text, "\"name\": \"load\",\n      \"unit\": \"N\"");
  assert_true(number_after(text, "last") == load[count - 1]);
  assert_true(fabs(number_after(text, "peak")) >= fabs(largest));
  free(load);
  free(text);
  assert_int_equal(shell(w, "grep -q 'small beam' words && grep -q 'written    beam.h5' words"), 0);
}

static void every_ending_has_its_name(void **state) {
  workplace *w = *state;
  assert_int_equal(shell(w, "cp beam.nml stop.nml; echo \"&stop monitor = 'load' above = '100 N' "
                            "/\" >> stop.nml"),
                   0);
  expect_document(w, "run stop.nml --json", 0, "\"status\": \"stopped\"");
  char *text = document_of(w, "run beam.nml --json --set material.E=-1", 1);
  assert_holds(text, "\"severity\": \"error\"");
  assert_holds(text, "\"accepted\": false,\n  \"status\": \"failed\",\n  \"signal\": null,\n  "
                     "\"error\": null");
  free(text);
  expect_document(w, "run none.nml --json", 1, "cannot read `none.nml`");
  expect_document(w, "run beam.nml --json --resume", 1, "\"error\": \"cannot resume: there is no");
  expect_document(w, "run beam.h5 --json", 1,
                  "\"status\": \"failed\",\n  \"error\": \"`beam.h5` is a result; `perilat run` "
                  "needs a deck\"");
  write_text(w, "kick.plm",
             "model kick\n  law central bond\n  parameter E = 30 [GPa] in (0, inf)\n  parameter "
             "rho = 2323 [kg/m^3] in (0, inf)\n"
             "  kick = | 0 when stretch <= 1e-5\n         | 1e6 otherwise\n"
             "  force N = E*s*t*(stretch - kick)\nend model\n");
  text = document_of(w, "run beam.nml --json --no-physics --set material.model=kick", 2);
  assert_holds(text, "\"status\": \"failed\"");
  assert_holds(text, "\"error\": \"runaway velocity in step");
  assert_holds(text, "bad_bond");
  free(text);
  expect_document(w, "run beam.nml --json --set output.energy=.false.", 0, "\"energy\": null");
}

static void an_interrupted_run_says_so(void **state) {
  workplace *w = *state;
  assert_int_equal(shell(w, "sed -e 's/1 ms/400000 ms/' beam.nml > long.nml"), 0);
  const int found = shell(w, "$P run long.nml --json > document 2> words & run=$!; "
                             "until test -s beam.h5.frames || ! kill -0 $run; do sleep 0.02; done; "
                             "kill -TERM $run; wait $run");
  assert_int_equal(found, 143);
  size_t size;
  char *text = read_bytes(w, "document", &size);
  assert_true(json_is_valid(text));
  assert_holds(text, "\"status\": \"interrupted\",\n  \"signal\": 15,");
  assert_holds(text, "\"beam.h5.checkpoint\"");
  free(text);
}

static void a_solver_writes_the_same_document(void **state) {
#if defined(__SANITIZE_ADDRESS__)
  (void)state;
  skip(); /* the solver's compiler does not know the sanitizers that the libraries were made with */
#else
  workplace *w = *state;
  static const char same[] = "for f in run own; do grep -v -e wall -e checked $f > $f.steady; done;"
                             " diff run.steady own.steady";
  expect(w, "build beam.nml -o solver", 0, "written solver");
  assert_int_equal(
      shell(w, "$P run beam.nml --json > run && ./solver --json > own && { %s; }", same), 0);
#endif
}

static void a_document_that_cannot_be_written_fails(void **state) {
  workplace *w = *state;
  expect(w, "run beam.nml --json > /dev/full", 2, "cannot write to the standard output");
  expect(w, "info cohesive --json > /dev/full", 2, "cannot write to the standard output");
  expect(w, "info cohesive --json >&-", 2, "cannot write to the standard output");
  assert_int_equal(
      shell(w, "$P run beam.nml --json 2>&1 > /dev/full | grep -c 'cannot write' | grep -qx 1"), 0);
}

/* --- results ---------------------------------------------------------------------------------- */

/* Their numbers are not given to files: neither result nor document holds what is said. */
static void closed_streams_are_no_files(void **state) {
  workplace *w = *state;
  size_t size;
  assert_int_equal(shell(w, "$P run beam.nml --json > document 2>&-"), 0);
  char *text = read_bytes(w, "document", &size);
  assert_true(json_is_valid(text));
  free(text);
  assert_int_equal(shell(w, "$P check beam.nml <&- >&- 2>&-"), 2);
  assert_int_equal(shell(w, "$P run beam.nml <&- > document 2>&-"), 0);
  expect(w, "info beam.h5", 0, "Ended: end of the run");
}

static void results_are_told_whole(void **state) {
  workplace *w = *state;
  expect(w, "run beam.nml --set simulation.title=beam", 0, "written");
  char *text = document_of(w, "info beam.h5 --json", 0);
  assert_holds(text, "\"title\": \"beam\",\n  \"dimensions\": 2,\n  \"particles\": 20,\n  "
                     "\"bonds\": 41,\n  \"frames\": 5,\n  \"set\": [\n    "
                     "\"simulation.title=beam\"\n  ]");
  long count;
  double *load = series_of(w, "beam.h5", "load", &count);
  const char *at = strstr(text, "\"name\": \"load\"");
  assert_non_null(at);
  assert_true(number_after(at, "samples") == (double)count);
  assert_true(number_after(at, "last") == load[count - 1]);
  free(load);
  free(text);
  expect_document(w, "info beam.nml --json", 1,
                  "--json is for laws, results and, with --modes, decks");
  expect_document(w, "info none.h5 --json", 1, "\"error\": \"cannot read");
}

static void tables_hold_the_numbers_of_the_result(void **state) {
  workplace *w = *state;
  expect(w, "run beam.nml", 0, "written");
  char *text = document_of(w, "export beam.h5 --history load --json", 0);
  long count;
  double *load = series_of(w, "beam.h5", "load", &count);
  char *at = strstr(text, "\"name\": \"load\"");
  assert_non_null(at);
  at = strchr(strstr(at, "\"values\": ["), '[') + 1;
  for (long k = 0; k < count; k++, at++)
    assert_true(strtod(at, &at) == load[k] + 0.0);
  assert_int_equal(at[strspn(at, " \n")], ']'); /* and no more */
  free(load);
  free(text);
  text = document_of(w, "export beam.h5 --frame -1 --json", 0);
  assert_holds(text, "\"of\": \"particles\",\n  \"frame\": 4,");
  assert_holds(text, "\"name\": \"displacement_y\",\n      \"unit\": \"m\"");
  free(text);
  text = document_of(w, "export beam.h5 --frame 0 --bonds --json", 0);
  assert_holds(text, "\"of\": \"bonds\",\n  \"frame\": 0,\n  \"time\": 0,\n  \"rows\": 41,");
  assert_holds(text, "\"name\": \"j\",\n      \"unit\": \"1\"");
  assert_holds(text, "\"name\": \"concrete/omega\"");
  free(text);
  expect_document(w, "export beam.h5 --frame 9 --json", 1, "there is no frame 9");
  expect_document(w, "export beam.h5 --history none --json", 1, "\"error\": \"");
  expect(w, "export beam.h5 --json -o table", 1, "leave out -o");
}

static void comparisons_tell_where_and_by_what(void **state) {
  workplace *w = *state;
  expect(w, "run beam.nml --set output.result=a.h5", 0, "written");
  expect(w, "run beam.nml --set output.result=b.h5 --set drive.velocity='-21 mm/s'", 0, "written");
  expect_document(w, "compare a.h5 a.h5 --json", 0, "\"same\": true");
  char *text = document_of(w, "compare a.h5 b.h5 --json", 2);
  assert_holds(text, "\"same\": false");
  const char *at = strstr(text, "\"name\": \"load\"");
  assert_non_null(at);
  assert_holds(at, "\"at\": \"sample\"");
  const char *values = strstr(at, "\"values\": [");
  char *end;
  const double first = strtod(strchr(values, '[') + 1, &end), second = strtod(end + 1, NULL);
  assert_true(number_after(at, "gap") == fabs(first - second));
  assert_holds(text, "\"at\": \"particle\"");
  assert_holds(text, "\"at\": \"bond\"");
  free(text);
  expect_document(w, "compare a.h5 none.h5 --json", 1, "\"error\": \"cannot read");
  expect_document(w, "compare a.h5 b.h5 --json --field none", 1, "\"same\": false");
  write_text(w, "other.csv", "time,stress\n0,0\n1,1\n");
  expect_document(w, "compare a.h5 other.csv --json", 1,
                  "\"error\": \"`other.csv` has no column `load`\"");
}

/* --- laws ------------------------------------------------------------------------------------- */

static void bounds_are_numbers(void **state) {
  workplace *w = *state;
  write_text(w, "bounded.plm",
             "model bounded\n  law central bond\n  parameter a = 2 [MPa] in [1 [MPa], inf)\n"
             "  parameter b = 3 [MPa] in (a, 10*a]\n  parameter c = 1\n  parameter rho [kg/m^3] in "
             "(0, inf)\n  force N = (a + b)*c*s*t*stretch\nend model\n");
  char *text = document_of(w, "info bounded.plm --json", 0);
  assert_holds(text, "\"lower\": 1000000,\n        \"lower_open\": false,\n        \"upper\": "
                     "null,\n        \"upper_open\": true");
  assert_holds(text, "\"lower\": 2000000,\n        \"lower_open\": true,\n        \"upper\": "
                     "20000000,\n        \"upper_open\": false");
  assert_holds(text, "\"value\": 1,\n      \"bounds\": null");
  free(text);
  text = document_of(w, "info none --json", 1);
  assert_holds(text, "there is no model `none`");
  free(text);
}

/* --- the reference ---------------------------------------------------------------------------- */

static char *section_of_reference(void) {
  FILE *in = fopen(SOURCE_DIR "/generator/README.md", "rb");
  assert_non_null(in);
  static char page[1 << 17];
  page[fread(page, 1, sizeof page - 1, in)] = 0;
  fclose(in);
  char *section = strstr(page, "## Documents for other programs");
  assert_non_null(section);
  char *next = strstr(section + 3, "\n## ");
  if (next) *next = 0;
  return section;
}

static void expect_keys(const char *reference, const char *text) {
  for (const char *at = text; (at = strstr(at, "\": ")); at++) {
    const char *begin = at;
    while (begin[-1] != '"')
      begin--;
    char key[100];
    snprintf(key, sizeof key, "`%.*s`", (int)(at - begin), begin);
    static const char *const elsewhere[] = {
        /* terms of /history/energy, and diagnostics */
        "`kinetic`",  "`stored`", "`dissipated_damage`", "`dissipated_damping`",
        "`external`", "`rest`",   "`imbalance`"};
    bool known = strstr(reference, key) != NULL;
    for (size_t k = 0; k < sizeof elsewhere / sizeof *elsewhere; k++)
      known = known || strcmp(key, elsewhere[k]) == 0;
    if (!known) fail_msg("the reference does not tell of %s", key);
  }
}

static void the_reference_tells_of_every_key(void **state) {
  workplace *w = *state;
  const char *reference = section_of_reference();
  write_text(w, "lab.csv", "time [ms],load [kN]\n0,0\n1,1\n");
  static const char *const commands[] = {"run beam.nml --json",
                                         "info beam.nml --modes 2 --json",
                                         "info beam.h5 --json",
                                         "info cohesive --json",
                                         "info mplm_bilinear --json",
                                         "compare beam.h5 beam.h5 --json",
                                         "compare beam.h5 lab.csv --tolerance 1e9 --json",
                                         "export beam.h5 --json",
                                         "export beam.h5 --frame 0 --json"};
  for (size_t k = 0; k < sizeof commands / sizeof *commands; k++) {
    char *text = document_of(w, commands[k], 0);
    expect_keys(reference, text);
    free(text);
  }
}

static const char torn[] =
    "&simulation end_time = '0.1 ms' step_safety = 0.7 /\n"
    "&mesh name = 'plate' size = 0.2, 0.1 nodes = 9, 5 thickness = 0.01 method = 'finite_elements' "
    "/\n"
    "&material mesh = 'plate' model = 'brittle_cracking' G_f = 50 /\n"
    "&region name = 'left' shape = 'segment' from = 0, 0 to = 0, 0.1 /\n"
    "&region name = 'right' shape = 'segment' from = 0.2, 0 to = 0.2, 0.1 /\n"
    "&support region = 'left' fix = 'x', 'y' /\n"
    "&drive region = 'right' component = 'x' velocity = '2 m/s' /\n"
    "&monitor name = 'load' kind = 'reaction' region = 'left' component = 'x' /\n"
    "&output result = 'torn.h5' /\n";

/* As many as in the words for people; there is no time before any did. */
static void dead_cells_are_counted(void **state) {
  workplace *w = *state;
  write_text(w, "torn.nml", torn);
  char *text = document_of(w, "run torn.nml --json", 0);
  assert_holds(text, "\"mesh\": \"plate\",\n      \"cells\": 32,");
  const long died = (long)number_after(text, "died");
  const double first = number_after(text, "first_time");
  assert_true(died > 0 && died < 32 && first > 0 && first < 0.1e-3);
  char command[200];
  snprintf(command, sizeof command, "grep -q 'plate: %ld of 32 have died, the first at' words",
           died);
  assert_int_equal(shell(w, command), 0);
  expect_keys(section_of_reference(), text);
  free(text);
  expect_document(w, "run torn.nml --json --set simulation.end_time=3e-5", 0,
                  "\"died\": 0,\n      \"first_time\": null");
}

/* The same text; numbers to six digits, but for the time that it took. */
static void expect_like(const char *example, const char *found) {
  static const char wall[] = "\"wall\": ";
  while (*example && *found) {
    const bool number = strspn(example, "-0123456789") && strspn(found, "-0123456789");
    if (!number) {
      if (*example++ != *found++)
        fail_msg("expected %.60s\nfound    %.60s", example - 1, found - 1);
      continue;
    }
    const bool clock = strncmp(example - strlen(wall), wall, strlen(wall)) == 0;
    char *rest[2];
    const double a = strtod(example, &rest[0]), b = strtod(found, &rest[1]);
    if (!clock && fabs(a - b) > 1e-6 * fabs(a)) fail_msg("%.17g is %.17g", a, b);
    example = rest[0], found = rest[1];
  }
  assert_int_equal(*example, *found);
}

static void the_example_of_the_reference_is_real(void **state) {
  workplace *w = *state;
  char *begin = strstr(section_of_reference(), "```json\n");
  assert_non_null(begin);
  begin += strlen("```json\n");
  char *ends = strstr(begin, "\n```\n");
  assert_non_null(ends);
  ends[1] = 0;
  char *found = document_of(w, "run beam.nml --json", 0);
  expect_like(begin, found);
  free(found);
}

/* --- the standard input ----------------------------------------------------------------------- */

static void texts_come_through_pipes(void **state) {
  workplace *w = *state;
  static const struct {
    const char *line;
    int status;
    const char *wanted;
  } list[] = {
      {"cat $PERILAT_MODELS/cohesive.plm | $P check -", 0, "-: cohesive, no errors"},
      {"cat beam.nml | $P check -", 0, "-: no errors"},
      {"cat $PERILAT_MODELS/drives/elastic_central.nml | $P check -", 0, "-: no errors; a path"},
      {"cat $PERILAT_MODELS/cohesive.plm | $P check - --dump=passes", 0, "kernel of cohesive"},
      {"cat $PERILAT_MODELS/cohesive.plm | $P explain -", 0, "# cohesive"},
      {"cat $PERILAT_MODELS/cohesive.plm | $P info -", 0, "work of fracture"},
      {"printf '\\211HDF\\r\\n\\032\\n' | $P info -", 1, "a result is not read from the standard"},
      {"cat $PERILAT_MODELS/cohesive.plm | $P format --check -", 0, ""},
      {"cat $PERILAT_MODELS/cohesive.plm | $P format - | cmp - $PERILAT_MODELS/cohesive.plm", 0,
       ""},
      {"printf 'model  m\\nlaw central bond\\nforce N=strech\\nend model\\n' | $P format -", 0,
       "  force N = strech"},
      {"printf 'model m\\n  law central bond\\n  force N = strech\\nend model\\n' | $P check -", 1,
       "-:3:13: error:"},
      {"printf 'model m\\n  law central bond\\n  force N = strech\\nend model\\n' | $P check "
       "--diagnostics=json -",
       1, "\"file\": \"-\""},
      {"$P format -i - < $PERILAT_MODELS/cohesive.plm", 1, "the standard input has no place"},
      {"$P check - < /dev/null", 1, "error: there is no model in this text"},
      {"$P check - <&-", 1, "cannot read the standard input: Bad file descriptor"},
      {"head -c 20000000 /dev/zero | $P format -", 1, "it is longer than 1 MiB"},
      {"$P run - < beam.nml", 1, "`perilat run` does not read the standard input"},
      {"$P build - < beam.nml", 1, "`perilat build` does not read the standard input"},
      {"$P check beam.nml --set material.model=-", 1, "there is no model `-`"},
  };
  for (size_t k = 0; k < sizeof list / sizeof *list; k++) {
    const int found = shell(w, "%s", list[k].line);
    if (found != list[k].status || !strstr(w->said, list[k].wanted))
      show_failure(w, list[k].line, found, list[k].status, list[k].wanted);
    assert_true(found == list[k].status && strstr(w->said, list[k].wanted));
  }
}

/* --- what stands beside ----------------------------------------------------------------------- */

static void alone_it_helps_on_the_error_stream(void **state) {
  workplace *w = *state;
  assert_int_equal(shell(w, "$P 2>words >out; test -s words && ! test -s out"), 0);
  assert_int_equal(shell(w, "grep -q 'usage: perilat COMMAND' words"), 0);
}

/* A law that gives energy: build refuses what run refuses, and takes it when it is told to. */
static void build_leaves_physics_out_when_asked(void **state) {
  workplace *w = *state;
  write_text(
      w, "pump.plm",
      "model pump\n  law central bond\n  parameter E = 30 [GPa] in (0, inf)\n  parameter rho "
      "= 2323 [kg/m^3] in (0, inf)\n  force N = E*s*t*(stretch - 1e-3 [s]*stretch_rate)\n"
      "end model\n");
  assert_int_equal(shell(w, "sed 's/mplm_bilinear/pump/' beam.nml > pump.nml"), 0);
  expect(w, "run pump.nml", 1, "[dissipation]");
  expect(w, "build pump.plm", 1, "[dissipation]");
  assert_false(exists(w, "pump.so"));
  expect(w, "build pump.plm --no-physics", 0, "written pump.so");
  expect(w, "build pump.nml -o pump", 1, "[dissipation]");
  assert_false(exists(w, "pump"));
#if !defined(__SANITIZE_ADDRESS__)
  expect(w, "build pump.nml -o pump --no-physics", 0, "written pump");
  shell(w, "./pump");
  assert_null(strstr(w->said, "[dissipation]"));
  assert_non_null(strstr(w->said, "steps of"));
#endif
}

#define IN_WORKPLACE(test)                                                                         \
  cmocka_unit_test_setup_teardown(test, set_up_workplace, tear_down_workplace)

int main(void) {
  const struct CMUnitTest tests[] = {
      IN_WORKPLACE(a_run_tells_how_it_ended),
      IN_WORKPLACE(every_ending_has_its_name),
      IN_WORKPLACE(an_interrupted_run_says_so),
      IN_WORKPLACE(a_solver_writes_the_same_document),
      IN_WORKPLACE(a_document_that_cannot_be_written_fails),
      IN_WORKPLACE(closed_streams_are_no_files),
      IN_WORKPLACE(results_are_told_whole),
      IN_WORKPLACE(tables_hold_the_numbers_of_the_result),
      IN_WORKPLACE(comparisons_tell_where_and_by_what),
      IN_WORKPLACE(bounds_are_numbers),
      IN_WORKPLACE(the_reference_tells_of_every_key),
      IN_WORKPLACE(dead_cells_are_counted),
      IN_WORKPLACE(the_example_of_the_reference_is_real),
      IN_WORKPLACE(texts_come_through_pipes),
      IN_WORKPLACE(alone_it_helps_on_the_error_stream),
      IN_WORKPLACE(build_leaves_physics_out_when_asked),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
