/* Loads per length: the length that belongs to each particle of a row or a bar, what is no row, and
   a bar under its axial load against the closed form. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "runtime/interaction/sweep.h"
#include "runtime/filling/lattice.h"
#include "runtime/loads/tributary.h"
#include "tests/runtime/small_run.h"

typedef struct row_case {
  const char *lattice, *bodies, *region;
  long particles;
  double sum, first, last; /* m: of all, of the first and of the last particle */
} row_case;

#define HEXAGON   "kind = 'hexagonal' spacing = 0.02 thickness = 0.1 "
#define BEAM      "shape = 'rectangle' corner = -0.6, 0 size = 1.2, "
#define TOP       "shape = 'rectangle' corner = -0.61, 0.25 size = 1.22, 0.02"
#define BOTTOM    "shape = 'rectangle' corner = -0.61, -0.001 size = 1.22, 0.002"
#define BODY      "&body lattice = 'c' "
#define FROM_CUBE "shape = 'box' corner = -0.001, -0.001, -0.001 size = "

static const row_case cases[] = {
    /* 60 particles from -0.59, half a spacing inside of the ends; 61 from -0.6, on these */
    {HEXAGON, BODY BEAM "0.26 /", TOP, 60, 1.2, 0.02, 0.02},
    {HEXAGON, BODY BEAM "0.26 /", BOTTOM, 61, 1.2, 0.01, 0.01},
    /* that lie on the outline */
    {HEXAGON, BODY BEAM "0.25980762113533160 /", TOP, 60, 1.2, 0.02, 0.02},
    /* unequal ends: the first site at -0.597, the last at 0.583 */
    {HEXAGON "origin = 0.003, 0 ", BODY BEAM "0.26 /", BOTTOM, 60, 1.2, 0.013, 0.027},
    /* a part of the row goes half way to the particles beyond */
    {HEXAGON, BODY BEAM "0.26 /", "shape = 'segment' from = -0.1, 0 to = 0.1, 0", 11, 0.22, 0.02,
     0.02},
    /* a notch 24 mm wide, one site in it */
    {HEXAGON,
     BODY BEAM
     "0.26 / &notch lattice = 'c' shape = 'rectangle' corner = -0.012, -0.01 size = 0.024, 0.1 /",
     BOTTOM, 60, 1.176, 0.01, 0.01},
    /* two bodies that overlap count once; one apart with its own sites, 30 mm of air between */
    {HEXAGON, BODY BEAM "0.1 / " BODY "shape = 'rectangle' corner = 0, 0 size = 0.6, 0.26 /",
     BOTTOM, 61, 1.2, 0.01, 0.01},
    {HEXAGON,
     BODY "shape = 'rectangle' corner = -0.1, 0 size = 0.105, 0.1 / " BODY
          "shape = 'rectangle' corner = 0.035, 0 size = 0.065, 0.1 /",
     BOTTOM, 10, 0.17, 0.01, 0.01},
    /* the lattice turned with the body; a side across the rows, every second one of them */
    {HEXAGON "rotation = 30 ",
     BODY "shape = 'rectangle' corner = 0, 0 size = 0.4, 0.2 rotation = 30 /",
     "shape = 'segment' from = -0.0173205080756888, -0.01 to = 0.3637306695894642, 0.21", 21, 0.4,
     0.01, 0.01},
    {HEXAGON, BODY BEAM "0.26 /", "shape = 'segment' from = -0.6, -1 to = -0.6, 1", 8, 0.26,
     0.01732050807568877, 0.034833395016046},
    {"kind = 'chain' spacing = 0.02 area = 1e-4 ",
     BODY "shape = 'rectangle' corner = 0, -0.001 size = 0.41, 0.002 /", BOTTOM, 21, 0.41, 0.01,
     0.02},
    /* a row of a body without an outline, beside one that has one */
    {HEXAGON,
     BODY "shape = 'rectangle' corner = 0, 0.2 size = 0.2, 0.1 / " BODY
          "shape = 'segment' from = -0.1, 0 to = 0.1, 0 /",
     BOTTOM, 11, 0.22, 0.02, 0.02},
    /* in space: along an edge of a box, along a row inside */
    {"kind = 'cubic' spacing = 0.02 ", BODY "shape = 'box' corner = 0, 0, 0 size = 0.2, 0.1, 0.1 /",
     FROM_CUBE "0.3, 0.002, 0.002", 11, 0.2, 0.01, 0.01},
    {"kind = 'cubic' spacing = 0.02 origin = 0.01, 0.01, 0.01 ",
     BODY "shape = 'box' corner = 0, 0, 0 size = 0.2, 0.1, 0.1 /", FROM_CUBE "0.012, 0.012, 0.3", 5,
     0.1, 0.02, 0.02},
};

/* Bodies that are mere points bound nothing. */
static const row_case unbounded = {
    HEXAGON, BODY "shape = 'segment' from = -0.1, 0 to = 0.1, 0 /", BOTTOM, 11, 0.22, 0.02, 0.02};

typedef struct lengths {
  small_run run; /* without a simulation */
  rows *lattice;
  region_sites *regions;
  double *length;
} lengths;

static bool find_lengths(lengths *l, const char *text) {
  small_run *r = &l->run;
  memset(l, 0, sizeof *l);
  r->memory = arena_new();
  diag_begin(&r->said, &r->sources);
  r->deck = deck_read(r->memory, &r->sources,
                      source_add(&r->sources, "deck.nml", text, strlen(text)), NULL, 0, &r->said);
  if (!r->deck) small_print(r);
  assert_non_null(r->deck);
  const int lattice = deck_find_lattice(r->deck, "c");
  l->lattice = lattice_build(r->deck, lattice, &r->said);
  assert_non_null(l->lattice);
  l->regions = regions_select(r->deck, "c", l->lattice, &r->said);
  l->length = calloc((size_t)l->regions[0].count + 1, sizeof *l->length);
  return tributary_lengths(r->deck, lattice, l->lattice, &l->regions[0], "loaded",
                           r->deck->regions[0].item.where, l->length, &r->said);
}

static void lengths_free(lengths *l) {
  free(l->length);
  regions_free(l->run.deck, l->regions);
  rows_free(l->lattice);
  small_close(&l->run);
}

static const char *deck_of(const row_case *c, char text[4096]) {
  snprintf(text, 4096,
           "&simulation end_time = 1 /\n&lattice name = 'c' %s /\n&material lattice = 'c' model = "
           "'m' /\n%s\n&region name = 'loaded' %s /\n&force region = 'loaded' component = 'x' "
           "per_length = 1 /\n",
           c->lattice, c->bodies, c->region);
  return text;
}

static void check_row(const row_case *c) {
  char text[4096];
  lengths l;
  double sum = 0;
  if (!find_lengths(&l, deck_of(c, text))) small_print(&l.run);
  const long count = l.regions[0].count;
  for (long p = 0; p < count; p++)
    sum += l.length[p];
  print_message("%ld particles, %.12g m, %.12g to %.12g\n", count, sum, l.length[0],
                l.length[count - 1]);
  assert_int_equal(count, c->particles);
  assert_true(fabs(sum - c->sum) < 1e-12);
  assert_true(fabs(l.length[0] - c->first) < 1e-12);
  assert_true(fabs(l.length[count - 1] - c->last) < 1e-12);
  lengths_free(&l);
}

static void rows_have_the_length_of_their_body(void **state) {
  (void)state;
  for (size_t n = 0; n < sizeof cases / sizeof *cases; n++)
    check_row(&cases[n]);
  check_row(&unbounded);
}

#define BAR                                                                                        \
  "&simulation end_time = 1 /\n&bar name = 'c' points = 0, 0, 0.1, 0, 0.1, 0.045 diameter = 0.01 " \
  "spacing = 0.02 %s /\n&material bar = 'c' model = 'm' /\n"                                       \
  "&region name = 'loaded' shape = %s /\n"                                                         \
  "&force region = 'loaded' component = 'y' per_length = 1 /\n"

static double bar_length(const char *closed, const char *shape) {
  char text[4096];
  lengths l;
  double sum = 0;
  snprintf(text, sizeof text, BAR, closed, shape);
  assert_true(find_lengths(&l, text));
  for (long p = 0; p < l.regions[0].count; p++)
    sum += l.length[p];
  lengths_free(&l);
  return sum;
}

/* Round corners, and of a single particle half of the parts beside it. */
static void bars_have_the_length_of_their_line(void **state) {
  (void)state;
  static const char all[] = "'rectangle' corner = -1, -1 size = 2, 2";
  assert_true(fabs(bar_length("", all) - 0.145) < 1e-14);
  assert_true(fabs(bar_length("closed = .true.", all) - 0.145 - hypot(0.1, 0.045)) < 1e-14);
  assert_true(fabs(bar_length("", "'point' at = 0, 0") - 0.01) < 1e-15);
  assert_true(fabs(bar_length("", "'point' at = 0.1, 0") - 0.01 - 0.01125) < 1e-14);
}

static void what_is_no_row_is_told(void **state) {
  (void)state;
  static const struct {
    row_case of;
    const char *message;
  } wrong[] = {{{HEXAGON, BODY BEAM "0.26 /", "shape = 'point' at = 0, 0", 0, 0, 0, 0},
                "region `loaded` holds one particle: a load per length acts on a row of them"},
               {{HEXAGON, BODY BEAM "0.26 /",
                 "shape = 'rectangle' corner = -0.61, -0.01 size = 1.22, 0.03", 0, 0, 0, 0},
                "the particles of region `loaded` are no straight row: that at"}};
  for (size_t n = 0; n < sizeof wrong / sizeof *wrong; n++) {
    char text[4096];
    lengths l;
    assert_false(find_lengths(&l, deck_of(&wrong[n].of, text)));
    assert_int_equal(l.run.said.errors, 1);
    assert_non_null(strstr(l.run.said.items[0].message, wrong[n].message));
    assert_non_null(strstr(l.run.said.items[0].hint, "`total`"));
    lengths_free(&l);
  }
}

/* Bonds under constant forces are linear elements, nodes bear half of what acts on the parts beside
   them: u(x) = q (L x - x^2/2)/(E A) holds at each node. */
static void a_bar_hangs_as_theory_says(void **state) {
  (void)state;
  static const char text[] =
      "&simulation end_time = 1 /\n&relaxation increments = 1 tolerance = 1e-9 /\n"
      "&lattice name = 'c' kind = 'hexagonal' spacing = 0.01 thickness = 0.1 /\n"
      "&material lattice = 'c' model = 'm' /\n"
      "&body lattice = 'c' shape = 'rectangle' corner = 0, -0.001 size = 0.1, 0.002 /\n"
      "&region name = 'foot' shape = 'point' at = 0, 0 /\n"
      "&region name = 'all' shape = 'rectangle' corner = -1, -1 size = 2, 2 /\n"
      "&support region = 'foot' fix = 'x' /\n&support region = 'all' fix = 'y' /\n"
      "&force region = 'all' component = 'x' per_length = 5000 /\n"
      "&monitor name = 'reaction' kind = 'reaction' region = 'foot' component = 'x' /\n"
      "&output frames = 0 /\n";
  small_run r;
  small_open(&r, &elastic_bar, text);
  if (!r.simulation) small_print(&r);
  assert_non_null(r.simulation);
  assert_int_equal(small_go(&r), STEP_END);
  const double EA = 30e9 * 0.01 * 0.1 / (sqrt(3) * (1 - 0.2)), q = 5000, L = 0.1;
  const body *b = simulation_state(r.simulation, 0)->body;
  const double most = q * L * L / (2 * EA);
  for (long p = 0; p < b->lattice->particle_count; p++) {
    const long site = b->lattice->particle_site[p];
    const double x = b->lattice->x[site], u = q * (L * x - x * x / 2) / EA;
    assert_true(fabs(b->displacement[0][site] - u) < 1e-6 * most);
  }
  assert_true(fabs(small_last(&r, "reaction") / (-q * L) - 1) < 1e-6);
  long particles;
  assert_true(fabs(simulation_loaded_length(r.simulation, 0, &particles) - L) < 1e-14);
  assert_int_equal(particles, 11);
  small_close(&r);
}

int main(void) {
  const struct CMUnitTest tests[] = {cmocka_unit_test(rows_have_the_length_of_their_body),
                                     cmocka_unit_test(bars_have_the_length_of_their_line),
                                     cmocka_unit_test(what_is_no_row_is_told),
                                     cmocka_unit_test(a_bar_hangs_as_theory_says)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
