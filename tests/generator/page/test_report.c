/* perilat report: pages are well formed and let nothing in or out, tell what `export` tells, are
   the same bytes each time; whatever a result holds is text; what cannot be read leaves a page that
   is there as it was. */
#define _XOPEN_SOURCE 700 /* nftw */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "dsl/base/sha256.h"
#include "generator/page/html.h"
#include "generator/page/packing.h"
#include "tests/generator/command_tools.h"
#include "tests/runtime/small_result.h"

/* --- reading a page --------------------------------------------------------------------------- */

static char *page_of(const workplace *w, const char *name) {
  size_t size;
  char *text = read_bytes(w, name, &size);
  assert_int_equal(strlen(text), size);
  return text;
}

/* From the end of `before` up to `after`; malloc'ed. */
static char *between(const char *text, const char *before, const char *after) {
  const char *begin = strstr(text, before);
  assert_non_null(begin);
  begin += strlen(before);
  const char *end = strstr(begin, after);
  assert_non_null(end);
  return strndup(begin, (size_t)(end - begin));
}

/* Base64 as RFC 4648 has it, read by its definition. */
static double *numbers_of(const char *code, long *count) {
  static const char digits[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  const size_t length = strcspn(code, "=\"");
  unsigned char *bytes = calloc(length + 8, 1);
  size_t used = 0;
  unsigned buffer = 0;
  int bits = 0;
  for (size_t k = 0; k < length; k++) {
    const char *digit = strchr(digits, code[k]);
    assert_non_null(digit);
    buffer = buffer << 6 | (unsigned)(digit - digits);
    bits += 6;
    if (bits < 8) continue;
    bits -= 8;
    bytes[used++] = (unsigned char)(buffer >> bits);
  }
  assert_int_equal(used % sizeof(double), 0);
  *count = (long)(used / sizeof(double));
  return (double *)(void *)bytes;
}

/* The values that the data give a series. */
static double *page_series_of(const char *page, const char *name, long *count) {
  char before[200];
  snprintf(before, sizeof before, "\"name\": \"%s\",", name);
  const char *at = strstr(page, before);
  assert_non_null(at);
  at = strstr(at, "\"values\": \"");
  assert_non_null(at);
  return numbers_of(at + strlen("\"values\": \""), count);
}

/* --- tests ------------------------------------------------------------------------------------ */

static void run_beam(workplace *w) {
  expect(w, "run beam.nml --set output.frames=6", 0, "written");
}

static void tells_what_export_tells(void **state) {
  workplace *w = *state;
  run_beam(w);
  expect(w, "report beam.h5 -o beam.html", 0, "written beam.html");
  char *page = page_of(w, "beam.html");
  static const char *const names[] = {"load", "energy/external", "energy/imbalance",
                                      "energy/dissipated_damage"};
  result_file *f = open_result_of(w, "beam.h5");
  for (size_t k = 0; k < sizeof names / sizeof *names; k++) {
    char unit_text[64], error[500];
    long stored, told;
    double *values = result_read_series(f, names[k], &stored, unit_text, sizeof unit_text, error,
                                        sizeof error),
           *shown = page_series_of(page, names[k], &told);
    assert_int_equal(told, stored);
    for (long n = 0; n < told; n++)
      assert_true(shown[n] == values[n]);
    free(values);
    free(shown);
  }
  result_read_close(f);
  free(page);
}

static void verdict_has_the_peak(void **state) {
  workplace *w = *state;
  run_beam(w);
  expect(w, "report beam.h5 -o beam.html", 0, "");
  char *page = page_of(w, "beam.html"), error[500], unit_text[64], wanted[100];
  result_file *f = open_result_of(w, "beam.h5");
  long count;
  double *load = result_read_series(f, "load", &count, unit_text, sizeof unit_text, error,
                                    sizeof error),
         peak = 0;
  for (long k = 0; k < count; k++)
    if (fabs(load[k]) > fabs(peak)) peak = load[k];
  if (fabs(peak) >= 1e3)
    snprintf(wanted, sizeof wanted, "<dd>%.6g kN<small>largest", peak / 1e3);
  else
    snprintf(wanted, sizeof wanted, "<dd>%.6g N<small>largest", peak);
  assert_non_null(strstr(page, wanted));
  assert_non_null(strstr(page, "The run in sentences"));
  assert_non_null(strstr(page, "lattice    concrete: hexagonal"));
  assert_non_null(strstr(page, "<math"));
  assert_non_null(strstr(page, "perilat run beam.nml --set output.frames=6"));
  free(load);
  free(page);
  result_read_close(f);
}

static void same_bytes_twice(void **state) {
  workplace *w = *state;
  run_beam(w);
  assert_int_equal(shell(w, "$P report beam.h5 -o a.html && sleep 1.1 && $P report beam.h5 -o "
                            "b.html && cmp a.html b.html"),
                   0);
}

/* A policy that names the script and the style by their sums, and nothing else that could ask for
   anything. */
static void policy_names_what_is_there(void **state) {
  workplace *w = *state;
  run_beam(w);
  expect(w, "report beam.h5 -o beam.html", 0, "");
  char *page = page_of(w, "beam.html");
  char *policy = between(page, "http-equiv=\"Content-Security-Policy\" content=\"", "\"");
  assert_ptr_equal(strstr(policy, "default-src 'none';"), policy);
  static const char *const parts[][3] = {{"script-src 'sha256-", "\n<script>", "</script>"},
                                         {"style-src 'sha256-", "<style>", "</style>"}};
  for (int k = 0; k < 2; k++) {
    char *text = between(page, parts[k][1], parts[k][2]), *sum = between(policy, parts[k][0], "'");
    unsigned char digest[SHA256_SIZE];
    sha256 h;
    sha256_begin(&h);
    sha256_add(&h, text, strlen(text));
    sha256_end(&h, digest);
    char *code = packing_base64(digest, sizeof digest);
    assert_string_equal(code, sum);
    free(code);
    free(text);
    free(sum);
  }
  static const char *const none[] = {"http://www.w3.org/2000/svg", " style=\"", " onclick",
                                     "<iframe", "<link rel=\"stylesheet\""};
  for (size_t k = 1; k < sizeof none / sizeof *none; k++)
    assert_null(strstr(page, none[k]));
  for (const char *at = page; (at = strstr(at, "http")); at++) /* a name in the script alone */
    assert_true(strncmp(at, "http-equiv", 10) == 0 || strncmp(at, none[0], strlen(none[0])) == 0);
  free(policy);
  free(page);
}

/* The tags are those of XML, closed in their order; by the tool of another house where there is
   one. */
static void is_well_formed(workplace *w, const char *name) {
  char *page = page_of(w, name), *to = page;
  for (const char *at = page; *at;) { /* without what scripts and styles hold */
    const bool opens = strncmp(at, "<script", 7) == 0 || strncmp(at, "<style", 6) == 0;
    const char *close = opens ? strstr(at, at[2] == 'c' ? "</script>" : "</style>") : NULL;
    if (close) {
      at = strchr(close, '>') + 1;
      continue;
    }
    *to++ = *at++;
  }
  *to = 0;
  write_text(w, "bare.xml", page);
  free(page);
  const int status =
      shell(w, "command -v xmllint > /dev/null || exit 77; xmllint --noout bare.xml");
  if (status != 77) {
    if (status) fprintf(stderr, "%s\n", w->said);
    assert_int_equal(status, 0);
  }
}

static void pages_are_well_formed(void **state) {
  workplace *w = *state;
  run_beam(w);
  expect(w, "report beam.h5 -o one.html", 0, "");
  is_well_formed(w, "one.html");
  expect(w, "run beam.nml --set output.result=other.h5 --set 'material.E=20 GPa'", 0, "written");
  expect(w, "report beam.h5 other.h5 -o pair.html", 0, "");
  is_well_formed(w, "pair.html");
  char *page = page_of(w, "pair.html");
  assert_non_null(strstr(page, "0:a:load;1:b:load;"));
  free(page);
}

static void hostile_texts_are_text(void **state) {
  workplace *w = *state;
  expect(w,
         "run beam.nml --set output.frames=2 --set \"simulation.title='<script>alert(1)</script> "
         "\\\"quoted\\\" & <b>'\"",
         0, "written");
  expect(w, "report beam.h5 -o beam.html", 0, "");
  is_well_formed(w, "beam.html");
  char *page = page_of(w, "beam.html");
  assert_null(strstr(page, "<script>alert"));
  assert_null(strstr(page, "<b>"));
  assert_non_null(strstr(page, "<title>&lt;script&gt;alert(1)&lt;/script&gt;"));
  free(page);
}

static void says_what_a_text_would_command(void **state) {
  (void)state;
  char *text = NULL;
  size_t length;
  FILE *out = open_memstream(&text, &length);
  html_text(out, "<a href=\"x\" id='y'>&\x1b[31m\xE2\x80\xAE\r\n\xff</a>");
  fclose(out);
  assert_string_equal(text,
                      "&lt;a href=&quot;x&quot; id=&#39;y&#39;&gt;&amp;\\x1b[31m\\u202e\\x0d\n"
                      "\\xff&lt;/a&gt;");
  free(text);
}

/* A damaged result, one that is none, no room: status, and a page that is there stays. */
static void leaves_what_is_there(void **state) {
  workplace *w = *state;
  run_beam(w);
  write_text(w, "old.html", "an old page\n");
  size_t size;
  char *bytes = read_bytes(w, "beam.h5", &size);
  bytes[size / 2] ^= 0x55;
  write_bytes(w, "damaged.h5", bytes, size);
  free(bytes);
  expect(w, "report damaged.h5 -o old.html", 1, "error");
  expect(w, "report beam.nml -o old.html", 1, "error");
  expect(w, "report missing.h5 -o old.html", 1, "error");
  expect(w, "report beam.h5 damaged.h5 -o old.html", 1, "error");
  char *page = page_of(w, "old.html");
  assert_string_equal(page, "an old page\n");
  free(page);
  expect(w, "report beam.h5 -o beam.h5", 1, "would overwrite");
  expect(w, "report beam.h5 -o missing/page.html", 2, "cannot write");
  expect(w, "report", 1, "needs a result");
  expect(w, "report beam.h5 beam.h5 beam.h5", 1, "one more");
  expect(w, "report beam.h5 --nothing", 1, "has no option");
  expect(w, "report beam.h5", 0, "written beam.html");
}

/* A run that failed, or whose energies do not add up, stands out. */
static void wrong_runs_stand_out(void **state) {
  workplace *w = *state;
  char path[400], error[500] = "";
  snprintf(path, sizeof path, "%s", in_workplace(w, "small.h5"));
  const result_header h = small_header(path);
  result *r = small_begin(&h, error, sizeof error);
  assert_non_null(r);
  for (int k = 0; k < SAMPLES; k++) {
    double u[2 * PARTICLES], omega[BONDS];
    small_frame(k, u, omega);
    assert_true(result_frame(r, k, (const double *const[]){u, omega}, error, sizeof error));
  }
  const double time[SAMPLES] = {0, 1, 2, 3, 4}, energy[SAMPLES] = {0, 1, 2, 3, 4},
               imbalance[SAMPLES] = {0, 0, 0, 0, 1}, load[SAMPLES] = {0, 2, NAN, -3, 1};
  const result_series series[] = {{"load", "N", NULL, load, false, NULL},
                                  {"energy/external", "J", NULL, energy, false, NULL},
                                  {"energy/kinetic", "J", NULL, energy, false, NULL},
                                  {"energy/imbalance", "J", NULL, imbalance, true, ""}};
  assert_true(small_finish(r, time, SAMPLES, series, 4, error, sizeof error));
  result_close(r);
  expect(w, "report small.h5 -o small.html", 0, "");
  is_well_formed(w, "small.html");
  char *page = page_of(w, "small.html");
  assert_non_null(strstr(page, "<section class=\"verdict wrong\""));
  assert_non_null(strstr(page, "The energies of this run do not add up."));
  assert_non_null(strstr(page, "25 %")); /* 1 of 4 J */
  assert_non_null(strstr(page, "-3 N"));
  free(page);
}

/* Whose energies could not be checked is not called right. */
static void unchecked_is_not_good(void **state) {
  workplace *w = *state;
  static const char *const rows[][2] = {
      {"", "verdict good"}, {"a reason", "verdict unchecked"}, {NULL, "verdict unchecked"}};
  for (size_t k = 0; k < sizeof rows / sizeof *rows; k++) {
    char path[400], error[500] = "";
    snprintf(path, sizeof path, "%s", in_workplace(w, "small.h5"));
    const result_header h = small_header(path);
    result *r = small_begin(&h, error, sizeof error);
    assert_non_null(r);
    const double time[2] = {0, 1}, energy[2] = {0, 4}, none[2] = {0, 0};
    const result_series series[] = {{"energy/external", "J", NULL, energy, false, NULL},
                                    {"energy/kinetic", "J", NULL, energy, false, NULL},
                                    {"energy/imbalance", "J", NULL, none, true, rows[k][0]}};
    assert_true(small_finish(r, time, 2, series, rows[k][0] ? 3 : 2, error, sizeof error));
    result_close(r);
    expect(w, "report small.h5 -o small.html", 0, "");
    char *page = page_of(w, "small.html");
    assert_non_null(strstr(page, rows[k][1]));
    assert_int_equal(strstr(page, "nothing was found wrong") != NULL, k == 0);
    assert_non_null(strstr(page, "<figcaption>external work</figcaption>"));
    free(page);
  }
}

/* Whose machine it was is nobody's business: of paths from the root the file's name stands. Two
   results of one name are told apart by a folder. */
static void folders_of_the_machine_are_left_out(void **state) {
  workplace *w = *state;
  assert_int_equal(
      shell(w, "mkdir one two && $P run $PWD/beam.nml --set output.result=$PWD/one/beam.h5 && "
               "cp one/beam.h5 two/ && $P report $PWD/one/beam.h5 -o one.html && "
               "$P report $PWD/one/beam.h5 two/beam.h5 -o pair.html"),
      0);
  static const char *const names[] = {"one.html", "pair.html"};
  for (int k = 0; k < 2; k++) {
    is_well_formed(w, names[k]);
    char *page = page_of(w, names[k]);
    assert_null(strstr(page, w->folder));
    assert_non_null(strstr(page, "perilat run beam.nml --set output.result=beam.h5"));
    assert_int_equal(strstr(page, ">one/beam.h5<") != NULL, k);
    assert_int_equal(strstr(page, ">two/beam.h5<") != NULL, k);
    free(page);
  }
}

/* What a run has said stands in its page; one that warned, or failed, does not look good. */
static void runs_speak(void **state) {
  workplace *w = *state;
  static const struct {
    int status;
    const char *ended, *verdict;
  } rows[] = {{0, "end of the run", "verdict doubtful"},
              {2, "failed at t = 1 ms: a force is not a number", "verdict wrong"}};
  const result_text said[] = {{"begin", "  lattice  <of> 3 particles\n"},
                              {"end", "  load  largest 3 N\n"},
                              {"warnings", "perilat: warning: not to be trusted\n"}};
  for (size_t k = 0; k < sizeof rows / sizeof *rows; k++) {
    char path[400], error[500] = "";
    snprintf(path, sizeof path, "%s", in_workplace(w, "small.h5"));
    result_header h = small_header(path);
    h.deck_name = "it's a deck.nml";
    result *r = small_begin(&h, error, sizeof error);
    assert_non_null(r);
    const double time[2] = {0, 1}, load[2] = {0, 3};
    const result_series series = {"load", "N", NULL, load, false, NULL};
    const result_ending e = {.ended = rows[k].ended,
                             .said = said,
                             .said_count = 3,
                             .status = rows[k].status,
                             .dt = 1,
                             .steps = 1,
                             .time = time,
                             .history_count = 2,
                             .series = &series,
                             .series_count = 1};
    assert_true(result_finish(r, &e, error, sizeof error));
    result_close(r);
    expect(w, "report small.h5 -o small.html", 0, "");
    is_well_formed(w, "small.html");
    char *page = page_of(w, "small.html");
    assert_non_null(strstr(page, rows[k].verdict));
    assert_non_null(strstr(page, "lattice  &lt;of&gt; 3 particles"));
    assert_non_null(strstr(page, "load  largest 3 N"));
    assert_non_null(strstr(page, "warning: not to be trusted"));
    assert_non_null(strstr(page, "perilat run &#39;it&#39;\\&#39;&#39;s a deck.nml&#39;"));
    if (k == 1) assert_non_null(strstr(page, "exit status 2"));
    free(page);
  }
}

/* A parameter that a formula, a file or a random field makes differ: the page tells one value, and
   what the law answers with it, as of a deck that gives that value. */
static void laws_that_differ_in_space(void **state) {
  workplace *w = *state;
  expect(w, "run beam.nml --set 'material.E=20 GPa' --set output.result=same.h5", 0, "written");
  expect(w, "report same.h5", 0, "");
  char *same = page_of(w, "same.html"),
       *wanted = between(same, "<figcaption>One bond", "</figure>");
  char *curve = strdup(strstr(wanted, "</figcaption>"));
  assert_int_equal(shell(w, "$P export same.h5 --frame 0 | sed -n '1s/.*/x [m],y [m],E [GPa]/p; "
                            "2,$s/^[^,]*,\\([^,]*,[^,]*\\).*/\\1,20/p' > E.csv && head -3 E.csv"),
                   0);
  static const char *const rows[][3] = {
      {"run beam.nml --set 'material.E=20 [GPa] + 1 [GPa/m]*abs(x - 0.01905 [m])'",
       "20 GPa in the middle of the bodies; differs", "20 GPa"},
      {"run beam.nml --set material.E=E.csv", "30 GPa by default; differs", NULL},
      {"run field.nml --set 'material.E=20 GPa'", "20 GPa of the material; differs", "20 GPa"}};
  assert_int_equal(shell(w, "cat beam.nml > field.nml && echo \"&field parameter = 'E' "
                            "distribution = 'normal' cv = 0.1 "
                            "/\" >> field.nml"),
                   0);
  for (size_t k = 0; k < sizeof rows / sizeof *rows; k++) {
    expect(w, rows[k][0], 0, "written");
    expect(w, "report beam.h5", 0, "written beam.html");
    is_well_formed(w, "beam.html");
    char *page = page_of(w, "beam.html");
    assert_non_null(strstr(page, rows[k][1]));
    assert_non_null(strstr(page, "with the values above, the same everywhere"));
    if (rows[k][2]) assert_non_null(strstr(page, curve));
    free(page);
  }
  free(curve);
  free(wanted);
  free(same);
}

/* A point free across of E = 30 GPa, nu = 0.49 at a thousandth: 30 MPa in plane stress, 39.5 MPa in
   plane strain. */
static void laws_are_those_of_their_setting(void **state) {
  static const struct {
    const char *setting, *words;
    double most;
  } cases[] = {{"plane_stress", "in plane stress", 30}, {"plane_strain", "in plane strain", 40}};
  workplace *w = *state;
  for (int k = 0; k < 2; k++) {
    char deck[800];
    snprintf(deck, sizeof deck,
             "&simulation end_time = '1 us' /\n"
             "&mesh name = 'm' size = '40 mm', '20 mm' nodes = 5, 3 thickness = '10 mm'\n"
             "      method = 'finite_elements' setting = '%s' /\n"
             "&material mesh = 'm' model = 'elastic' E = '30 GPa' nu = 0.49 /\n"
             "&output result = 'm.h5' /\n",
             cases[k].setting);
    write_text(w, "m.nml", deck);
    expect(w, "run m.nml", 0, "m.h5");
    expect(w, "report m.h5 -o m.html", 0, "m.html");
    char *page = page_of(w, "m.html"), *curve = between(page, "<figcaption>One point", "</svg>");
    double low, high, factor;
    assert_non_null(strstr(curve, cases[k].words));
    assert_int_equal(
        sscanf(strstr(curve, "data-y=\""), "data-y=\"%lf %lf %lf", &low, &high, &factor), 3);
    assert_true(fabs(high - cases[k].most) < 1e-9);
    free(curve);
    free(page);
  }
}

/* A mesh, solved for at rest. */
static void shows_meshes(void **state) {
  workplace *w = *state;
  expect(w, "run " SOURCE_DIR "/examples/cook/cook.nml --set output.result=cook.h5", 0, "written");
  expect(w, "report cook.h5", 0, "written cook.html");
  is_well_formed(w, "cook.html");
  char *page = page_of(w, "cook.html");
  assert_non_null(strstr(page, "\"cellCount\": 1024"));
  assert_non_null(strstr(page, "hooke"));
  free(page);
}

static void without_frames(void **state) {
  workplace *w = *state;
  char path[400], error[500] = "";
  snprintf(path, sizeof path, "%s", in_workplace(w, "small.h5"));
  const result_header h = small_header(path);
  result *r = small_begin(&h, error, sizeof error);
  assert_non_null(r);
  const double time[2] = {0, 1}, load[2] = {0, 1};
  const result_series series = {"load", "N", NULL, load, false, NULL};
  assert_true(small_finish(r, time, 2, &series, 1, error, sizeof error));
  result_close(r);
  expect(w, "report small.h5 -o small.html", 0, "");
  is_well_formed(w, "small.html");
  char *page = page_of(w, "small.html");
  assert_non_null(strstr(page, "No frame is shown"));
  free(page);
}

/* The page of a study has its table, a curve of each case, and the largest peak; it is the same by
   the name of its folder. */
static void shows_studies(void **state) {
  workplace *w = *state;
  expect(w, "study beam.nml --vary 'material.E=20,30 GPa' -o two --jobs 1", 0, "two.h5");
  expect(w, "report two.h5", 0, "written two.html");
  expect(w, "report two/ -o same.html", 0, "");
  assert_int_equal(shell(w, "cmp two.html same.html"), 0);
  is_well_formed(w, "two.html");
  char *page = page_of(w, "two.html");
  assert_non_null(strstr(page, "All 2 cases done."));
  assert_non_null(strstr(page, "0:c0:y;1:c1:y;"));
  assert_non_null(strstr(page, "<th>E [GPa]</th><th>load peak"));
  result_file *f = open_result_of(w, "two/E=30GPa.h5");
  char unit_text[64], error[500];
  long stored, told;
  double *values = result_read_series(f, "load", &stored, unit_text, sizeof unit_text, error,
                                      sizeof error),
         *shown = page_series_of(strstr(page, "\"path\": \"E=30GPa\""), "y", &told);
  assert_int_equal(told, stored);
  assert_memory_equal(shown, values, (size_t)told * sizeof *shown);
  free(values);
  free(shown);
  free(page);
  result_read_close(f);
  expect(w, "report two.h5 two.h5", 1, "shown alone");
}

/* --- sizes ------------------------------------------------------------------------------------ */

enum { MANY_ROWS = 200, MANY_COLUMNS = 250, MANY = MANY_ROWS * MANY_COLUMNS, MANY_FRAMES = 24 };

/* A square lattice of 50000 particles whose displacements have no order that could be told in few
   bytes. */
static void write_many(const workplace *w, const char *name) {
  static double place[2 * MANY], volume[MANY], u[2 * MANY], omega[2 * MANY];
  static int32_t body[MANY], pairs[4 * MANY];
  long bonds = 0;
  uint32_t random = 1;
  for (int k = 0; k < MANY; k++) {
    place[2 * k] = 1e-3 * (k % MANY_COLUMNS);
    place[2 * k + 1] = 1e-3 * (k / MANY_COLUMNS);
    volume[k] = 1;
    for (int c = 0; c < 2; c++) {
      const int other = k + (c ? MANY_COLUMNS : 1);
      if (other >= MANY || (c == 0 && other % MANY_COLUMNS == 0)) continue;
      pairs[2 * bonds] = k;
      pairs[2 * bonds++ + 1] = other;
    }
  }
  char path[400], error[500];
  snprintf(path, sizeof path, "%s", in_workplace(w, name));
  const result_bonds of = {"plate", bonds, pairs};
  const result_field fields[] = {{"displacement", "m", NULL, 2, MANY, "other", NULL},
                                 {"omega", "1", "plate", 1, bonds, "damage", NULL}};
  result_header h = small_header(path);
  h.particle_count = MANY;
  h.reference = place;
  h.body = body;
  h.volume = volume;
  h.bonds = &of;
  h.fields = fields;
  result *r = small_begin(&h, error, sizeof error);
  assert_non_null(r);
  for (int k = 0; k < MANY_FRAMES; k++) {
    for (int n = 0; n < 2 * MANY; n++) {
      random = random * 1664525u + 1013904223u;
      u[n] = 1e-6 * k * (random >> 8) / (1 << 24);
    }
    for (long b = 0; b < bonds; b++)
      omega[b] = b < 100 * k ? 1 : 0;
    assert_true(result_frame(r, k, (const double *const[]){u, omega}, error, sizeof error));
  }
  const double time[2] = {0, MANY_FRAMES}, load[2] = {0, 1};
  const result_series series = {"load", "N", NULL, load, false, NULL};
  assert_true(small_finish(r, time, 2, &series, 1, error, sizeof error));
  result_close(r);
}

static void pages_stay_small(void **state) {
  workplace *w = *state;
  run_beam(w);
  expect(w, "report beam.h5 -o beam.html", 0, "");
  assert_true(size_of(w, "beam.html") < 2000000);
  write_many(w, "many.h5");
  expect(w, "report many.h5 -o many.html", 0, "");
  assert_true(size_of(w, "many.html") < 10000000);
  char *page = page_of(w, "many.html");
  assert_non_null(strstr(page, "frames are in this page"));
  free(page);
}

/* --- numbers in few characters ---------------------------------------------------------------- */

static void packs_as_it_says(void **state) {
  (void)state;
  char *code = packing_base64("", 0); /* RFC 4648, section 10 */
  assert_string_equal(code, "");
  free(code);
  code = packing_base64("foobar", 6);
  assert_string_equal(code, "Zm9vYmFy");
  free(code);
  code = packing_base64("foob", 4);
  assert_string_equal(code, "Zm9vYg==");
  free(code);
  packing p = {.bytes = NULL};
  packing_whole(&p, 0);
  packing_whole(&p, -1);
  packing_whole(&p, 1);
  packing_whole(&p, 64);
  static const unsigned char wholes[] = {0, 1, 2, 0x80, 1};
  assert_int_equal(p.count, sizeof wholes);
  assert_memory_equal(p.bytes, wholes, sizeof wholes);
  packing_free(&p);
  const unsigned char before[] = {1, 1, 1, 1, 1, 1}, now[] = {1, 1, 2, 0, 1, 1};
  packing_runs(&p, now, before, 6);
  /* two are the same, two are not: by 1 and by -1; then two are the same again, and none follow */
  static const unsigned char runs[] = {4, 4, 1, 255, 4, 0};
  assert_int_equal(p.count, sizeof runs);
  assert_memory_equal(p.bytes, runs, sizeof runs);
  packing_free(&p);
  assert_int_equal(packing_step(NAN, 0, 1), 0);
  assert_int_equal(packing_step(0, 0, 1), 1);
  assert_int_equal(packing_step(0.5, 0, 1), 128);
  assert_int_equal(packing_step(1, 0, 1), 255);
}

#define IN_WORKPLACE(test)                                                                         \
  cmocka_unit_test_setup_teardown(test, set_up_workplace, tear_down_workplace)

int main(void) {
  const struct CMUnitTest tests[] = {
      IN_WORKPLACE(tells_what_export_tells),
      IN_WORKPLACE(verdict_has_the_peak),
      IN_WORKPLACE(same_bytes_twice),
      IN_WORKPLACE(policy_names_what_is_there),
      IN_WORKPLACE(pages_are_well_formed),
      IN_WORKPLACE(hostile_texts_are_text),
      cmocka_unit_test(says_what_a_text_would_command),
      IN_WORKPLACE(leaves_what_is_there),
      IN_WORKPLACE(wrong_runs_stand_out),
      IN_WORKPLACE(unchecked_is_not_good),
      IN_WORKPLACE(folders_of_the_machine_are_left_out),
      IN_WORKPLACE(runs_speak),
      IN_WORKPLACE(laws_that_differ_in_space),
      IN_WORKPLACE(laws_are_those_of_their_setting),
      IN_WORKPLACE(shows_meshes),
      IN_WORKPLACE(without_frames),
      IN_WORKPLACE(shows_studies),
      IN_WORKPLACE(pages_stay_small),
      cmocka_unit_test(packs_as_it_says),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
