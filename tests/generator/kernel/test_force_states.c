/* The law of a family alone (pl_law.force_state): the force that a step finds is what both sides of
   its bonds say, and the new fields are the step's, on rows and lists, in every form of passes; a
   family that is taken out of its body says the same. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "generator/ir/random_values.h"
#include "generator/lower/lowered.h"
#include "tests/generator/kernel/compiled_family.h"

/* Particles at the sites from LEAD on; those before and behind are absent. */
enum {
  SITES = 136,
  LEAD = 56,
  SIZE = LEAD + SITES + LEAD,
  MOST_NEIGHBOURS = 2 * PL_MAX_DIRECTIONS
};

typedef struct body {
  const pl_law *law;
  int neighbours;
  double *uniforms;
  double **motion, **shape, **particle, **chord; /* [..][SIZE], chords [dimensions + 1][planes] */
  double **before, **after[2], **link, **bond_link, **force, **force_state, **sum;
  uint64_t bonds[SIZE], incoming[SIZE], held[SIZE], marks[2][SIZE];
  uint64_t **marked[2];
  long offset[MOST_NEIGHBOURS];
  int32_t *neighbour;
} body;

static long planes_size(const body *b) {
  return (long)b->neighbours * SIZE;
}

static void body_open(body *b, const pl_law *kernel, int neighbours) {
  memset(b, 0, sizeof *b);
  b->law = kernel;
  b->neighbours = neighbours;
  const long toward = planes_size(b);
  b->uniforms = must_calloc((size_t)(kernel->uniform_count * neighbours) + 1, sizeof(double));
  b->motion = planes_new(2 * kernel->dof, SIZE);
  b->shape = planes_new(PL_SHAPE_PLANES(kernel->dimensions), SIZE);
  b->particle = planes_new(2, SIZE);
  b->chord = planes_new(kernel->dimensions + 1, toward);
  b->before = planes_new(kernel->field_count, toward);
  b->after[0] = planes_new(kernel->field_count, toward);
  b->after[1] = planes_new(kernel->field_count, toward);
  b->link = planes_new(kernel->link_count, SIZE);
  b->bond_link = planes_new(kernel->bond_link_count, toward);
  b->force = planes_new(kernel->dof, SIZE);
  b->force_state = planes_new(kernel->dof, toward);
  b->sum = planes_new(kernel->sum_count, SIZE);
  b->neighbour = must_calloc((size_t)toward, sizeof *b->neighbour);
  memset(b->marks[0], 0xff, sizeof b->marks[0]);
  for (int side = 0; side < 2; side++)
    b->marked[side] = must_calloc((size_t)kernel->field_count + 1, sizeof *b->marked[side]);
  for (int f = 0; f < kernel->field_count; f++)
    b->marked[0][f] = b->marks[0], b->marked[1][f] = b->marks[1];
}

static void body_close(body *b) {
  const pl_law *kernel = b->law;
  free(b->uniforms);
  planes_free(b->motion, 2 * kernel->dof);
  planes_free(b->shape, PL_SHAPE_PLANES(kernel->dimensions));
  planes_free(b->particle, 2);
  planes_free(b->chord, kernel->dimensions + 1);
  planes_free(b->before, kernel->field_count);
  planes_free(b->after[0], kernel->field_count);
  planes_free(b->after[1], kernel->field_count);
  planes_free(b->link, kernel->link_count);
  planes_free(b->bond_link, kernel->bond_link_count);
  planes_free(b->force, kernel->dof);
  planes_free(b->force_state, kernel->dof);
  planes_free(b->sum, kernel->sum_count);
  free(b->marked[0]);
  free(b->marked[1]);
  free(b->neighbour);
}

/* --- a random body ---------------------------------------------------------------------------- */

static bool is_inside(long q) {
  return q >= LEAD && q < LEAD + SITES;
}

/* Bond k of the sites leads to a random permutation of them, on lists; on rows the same way. */
static void draw_neighbours(body *b, int k, uint64_t *seed) {
  const int half = b->neighbours / 2;
  int32_t to[SIZE];
  b->offset[k] = 1 + (long)(draw_bits(seed) % LEAD);
  b->offset[k + half] = -b->offset[k];
  for (int32_t q = 0; q < SIZE; q++)
    to[q] = q;
  for (int q = LEAD + SITES - 1; q > LEAD; q--) {
    const int other = LEAD + (int)(draw_bits(seed) % (uint64_t)(q - LEAD + 1));
    const int32_t kept = to[q];
    to[q] = to[other], to[other] = kept;
  }
  for (int32_t q = LEAD; q < LEAD + SITES; q++) {
    const long there = b->law->topology == PL_LIST ? to[q] : q + b->offset[k];
    const bool there_is = is_inside(there) && there != q && draw_bits(seed) % 8 != 0;
    b->neighbour[k * SIZE + q] = to[q] - q;
    b->neighbour[(k + half) * SIZE + to[q]] = q - to[q];
    if (!there_is) continue;
    b->bonds[q] |= UINT64_C(1) << k;
    b->incoming[there] |= UINT64_C(1) << k;
  }
}

static long neighbour_of(const body *b, long q, int k) {
  return q + (b->law->topology == PL_LIST ? b->neighbour[k * SIZE + q] : b->offset[k]);
}

static bool has_bond(const body *b, long q, int k) {
  const int half = b->neighbours / 2;
  return k < half ? b->bonds[q] >> k & 1 : b->incoming[q] >> (k - half) & 1;
}

static int back_of(const body *b, int k) {
  const int half = b->neighbours / 2;
  return k < half ? k + half : k - half;
}

/* Of some length where there is none. A bond has one from both ends, and one value `on bond`. */
static void draw_bonds(body *b, int k, uint64_t *seed) {
  const int back = back_of(b, k), dimensions = b->law->dimensions;
  for (long q = 0; q < SIZE; q++) {
    double square = 0;
    for (int d = 0; d < dimensions; d++) {
      const double component = bonds.s * draw_uniform(seed, d ? -1 : 0.5, 1);
      b->chord[d][k * SIZE + q] = b->chord[d][back * SIZE + q] = component;
      square += component * component;
    }
    b->chord[dimensions][k * SIZE + q] = b->chord[dimensions][back * SIZE + q] = sqrt(square);
  }
  for (long q = LEAD; q < LEAD + SITES; q++) {
    const long here = k * SIZE + q, there = back * SIZE + neighbour_of(b, q, k);
    if (!has_bond(b, q, k)) continue;
    for (int d = 0; d < dimensions; d++)
      b->chord[d][there] = -b->chord[d][here];
    b->chord[dimensions][there] = b->chord[dimensions][here];
    for (int f = 0; f < b->law->field_count; f++)
      if (b->law->fields[f].place == PL_ON_BOND) b->before[f][there] = b->before[f][here];
  }
}

static void draw_body(body *b, double order, uint64_t *seed) {
  const pl_law *kernel = b->law;
  const int resolved = PL_SHAPE_VALUES(kernel->dimensions);
  for (int d = 0; d < kernel->dof; d++)
    for (int q = 0; q < SIZE; q++) {
      const double size = d < kernel->dimensions ? bonds.s : 1;
      b->motion[d][q] = size * order * draw_uniform(seed, -1, 1);
      b->motion[kernel->dof + d][q] = draw_uniform(seed, -1, 1);
    }
  for (int q = 0; q < SIZE; q++) {
    b->particle[0][q] = bonds.V * draw_uniform(seed, 0.5, 1.5);
    b->particle[1][q] = bonds.mass_i * draw_uniform(seed, 0.5, 1.5);
    b->held[q] = draw_bits(seed) % 8 == 0;
    for (int v = 0; v <= resolved; v++)
      b->shape[v][q] = v == resolved ? (double)(draw_bits(seed) & 1) : draw_uniform(seed, -1, 1);
  }
  for (int f = 0; f < kernel->field_count; f++)
    for (long q = 0; q < planes_size(b); q++)
      b->before[f][q] = draw_field(seed, &kernel->fields[f]);
  for (int k = 0; k < b->neighbours / 2; k++)
    draw_neighbours(b, k, seed);
  for (int k = 0; k < b->neighbours / 2; k++)
    draw_bonds(b, k, seed);
}

static void prepare(body *b) {
  pl_bond_class family[MOST_NEIGHBOURS];
  double **sets = parameter_sets(b->law);
  family_of(family, b->law->dimensions, b->neighbours);
  for (int k = 0; k < b->neighbours; k++)
    b->law->prepare(b->law, sets[0], &family[k], b->uniforms + k * b->law->uniform_count);
  planes_free(sets, PARAMETER_SETS);
}

/* --- programs --------------------------------------------------------------------------------- */

enum { MOST_ARRAYS = 64 };

typedef struct moved {
  double *of[MOST_ARRAYS];
} moved;

static double *const *from(moved *m, double *const *planes, int count, long first) {
  assert_true(count <= MOST_ARRAYS);
  for (int k = 0; k < count; k++)
    m->of[k] = planes[k] + first;
  return m->of;
}

/* Over `count` sites from `first` on. New fields go to after[alone]. */
static void run(const body *b, const pl_program *program, bool alone, long first, long count) {
  const pl_law *kernel = b->law;
  moved m[8];
  pl_family f = {.size = sizeof f,
                 .count = count,
                 .rows = 1,
                 .neighbours = b->neighbours,
                 .plane = SIZE,
                 .new_plane = SIZE,
                 .link_plane = SIZE,
                 .bonds = b->bonds + first,
                 .held = b->held + first,
                 .new_field = from(&m[0], b->after[alone], kernel->field_count, first),
                 .link = from(&m[1], b->link, kernel->link_count, first),
                 .bond_link = from(&m[2], b->bond_link, kernel->bond_link_count, first),
                 .sum = from(&m[3], b->sum, kernel->sum_count, first),
                 .held_near = 1,
                 .mass = b->particle[1] + first,
                 .time_step = 1.7e-7,
                 .old_filled = (const uint64_t *const *)b->marked[0],
                 .new_filled = b->marked[0],
                 .settled = b->marked[1]};
  if (alone)
    f.force_state = from(&m[4], b->force_state, kernel->dof, first);
  else
    f.force = from(&m[4], b->force, kernel->dof, first);
  f.shape =
      (const double *const *)from(&m[5], b->shape, PL_SHAPE_PLANES(kernel->dimensions), first);
  f.old_field = (const double *const *)from(&m[6], b->before, kernel->field_count, first);
  for (int d = 0; d < kernel->dof; d++) {
    f.displacement[d] = b->motion[d] + first;
    f.velocity[d] = b->motion[kernel->dof + d] + first;
  }
  if (kernel->topology == PL_LIST) {
    f.neighbour = b->neighbour + first;
    f.incoming = b->incoming + first;
    f.length = b->chord[kernel->dimensions] + first;
    f.volume = b->particle[0] + first;
    for (int d = 0; d < kernel->dimensions; d++)
      f.chord[d] = b->chord[d] + first;
  } else {
    f.offset = f.link_offset = b->offset;
  }
  for (int k = 0; k < program->pass_count; k++)
    program->pass[k](kernel, b->uniforms, &f);
}

/* --- what is compared ------------------------------------------------------------------------- */

/* Of a component of force or moment on the particles, by the largest that bonds carry. */
static double gap_of(const body *b, int d) {
  double worst = 0, largest = 0;
  for (long q = LEAD; q < LEAD + SITES; q++) {
    double sum = 0, size = 0;
    for (int k = 0; k < b->neighbours; k++) {
      const double own = b->force_state[d][k * SIZE + q];
      if (!has_bond(b, q, k)) assert_true(own == 0);
      if (!has_bond(b, q, k)) continue;
      const long there = back_of(b, k) * SIZE + neighbour_of(b, q, k);
      const double other = d < b->law->dimensions ? b->force_state[d][there] : 0;
      sum += own - other;
      size += fabs(own) + fabs(other);
    }
    assert_true(isfinite(sum) && isfinite(b->force[d][q]));
    worst = fmax(worst, fabs(b->force[d][q] - sum));
    largest = fmax(largest, size);
  }
  return largest > 0 ? worst / largest : worst;
}

static long planes_of(const body *b, int field) {
  return b->law->fields[field].place == PL_ON_PARTICLE ? 1 : b->neighbours;
}

/* How far the new fields are from the step's, by the largest; *bits counts those with others. */
static double gap_of_fields(const body *b, long *bits) {
  double worst = 0;
  *bits = 0;
  for (int f = 0; f < b->law->field_count; f++) {
    double gap = 0, largest = 0;
    for (long k = 0; k < planes_of(b, f); k++)
      for (long at = k * SIZE + LEAD; at < k * SIZE + LEAD + SITES; at++) {
        *bits += memcmp(&b->after[0][f][at], &b->after[1][f][at], sizeof(double)) != 0;
        gap = fmax(gap, fabs(b->after[0][f][at] - b->after[1][f][at]));
        largest = fmax(largest, fabs(b->after[0][f][at]));
      }
    if (gap > 0) worst = fmax(worst, gap / largest);
  }
  return worst;
}

/* Lists are evaluated from either end; on rows ends share what is alike, and round otherwise. The
   inverse of the shape tensor of a random family rounds more than all else. */
static void assert_bonds_carry_the_step(const body *b) {
  const double rounding = strcmp(b->law->name, "correspondence") == 0 ? 1e-13 : 1e-14;
  long bits;
  for (int d = 0; d < b->law->dof; d++)
    if (!(gap_of(b, d) < rounding)) fail_msg("%s: %g", b->law->name, gap_of(b, d));
  assert_true(gap_of_fields(b, &bits) < 1e-14);
  if (b->law->topology == PL_LIST) assert_int_equal(bits, 0);
}

/* --- a family alone --------------------------------------------------------------------------- */

/* The particle at the first site of a body of nothing else; neighbour k a vector of sites behind
   it. What is not said to be read is no number. */
static void take_family(const body *of, long q, body *alone) {
  const pl_law *kernel = of->law;
  const int half = of->neighbours / 2;
  enum { NOTHING = 1 }; /* where no neighbour is, a site beside the particle */
  planes_poison(alone->motion, 2 * kernel->dof, SIZE);
  planes_poison(alone->shape, PL_SHAPE_PLANES(kernel->dimensions), SIZE);
  planes_poison(alone->particle, 2, SIZE);
  planes_poison(alone->chord, kernel->dimensions + 1, planes_size(of));
  planes_poison(alone->before, kernel->field_count, planes_size(of));
  for (int v = 0; v < PL_SHAPE_PLANES(kernel->dimensions); v++)
    alone->shape[v][0] = of->shape[v][q];
  for (int k = -1; k < of->neighbours; k++) {
    const long from = k < 0 ? q : neighbour_of(of, q, k), to = (k + 1) * PL_LANES;
    const bool is = k < 0 || has_bond(of, q, k);
    for (int d = 0; d < 2 * kernel->dof && is; d++)
      alone->motion[d][to] = of->motion[d][from];
    for (int f = 0; f < kernel->field_count && is; f++) {
      if (kernel->fields[f].place == PL_ON_PARTICLE) alone->before[f][to] = of->before[f][from];
      if (kernel->fields[f].place == PL_ON_PARTICLE || k < 0) continue;
      alone->before[f][k * SIZE] = of->before[f][k * SIZE + q];
      if (kernel->fields[f].place == PL_ON_NEIGHBOUR)
        alone->before[f][back_of(of, k) * SIZE + to] = of->before[f][back_of(of, k) * SIZE + from];
    }
    for (int p = 0; p < 2 && is; p++)
      alone->particle[p][to] = of->particle[p][from];
    alone->held[to] = is && of->held[from];
    if (k < 0) continue;
    alone->offset[k] = to;
    alone->neighbour[k * SIZE] = (int32_t)(is ? to : NOTHING);
    for (int d = 0; d <= kernel->dimensions; d++)
      alone->chord[d][k * SIZE] = of->chord[d][k * SIZE + q];
    if (is && k < half) alone->bonds[0] |= UINT64_C(1) << k;
    if (is && k >= half) alone->incoming[0] |= UINT64_C(1) << (k - half);
    if (is && k >= half) alone->bonds[to] |= UINT64_C(1) << (k - half); /* rows look there */
  }
}

static void assert_same_alone(const body *b) {
  const pl_law *kernel = b->law;
  for (long q = LEAD; q < LEAD + SITES; q += 17) {
    body alone;
    body_open(&alone, kernel, b->neighbours);
    memcpy(alone.uniforms, b->uniforms,
           (size_t)(kernel->uniform_count * b->neighbours) * sizeof(double));
    take_family(b, q, &alone);
    run(&alone, &kernel->force_state, true, 0, PL_LANES);
    for (int d = 0; d < kernel->dof; d++)
      for (int k = 0; k < b->neighbours; k++)
        assert_memory_equal(&alone.force_state[d][k * SIZE], &b->force_state[d][k * SIZE + q],
                            sizeof(double));
    for (int f = 0; f < kernel->field_count; f++)
      for (long k = 0; k < planes_of(b, f); k++)
        assert_memory_equal(&alone.after[1][f][k * SIZE], &b->after[1][f][k * SIZE + q],
                            sizeof(double));
    body_close(&alone);
  }
}

static int tried[FORM_PAIRS + 1], lists;

/* Returns how many passes the law alone has. */
static int check_planned(model *m, int neighbours) {
  char error[2000];
  const char *note;
  body b;
  uint64_t seed = 11;
  const pl_law *kernel = model_kernel(m, true, &note, error, sizeof error);
  assert_true(PL_HAS(kernel, force_state) && kernel->force_state.pass_count > 0);
  for (double order = 1e-5; order < 0.5; order *= 10) {
    body_open(&b, kernel, neighbours);
    draw_body(&b, order, &seed);
    prepare(&b);
    planes_poison(b.force_state, kernel->dof, planes_size(&b));
    run(&b, &kernel->step, false, LEAD, SITES);
    run(&b, &kernel->force_state, true, LEAD, SITES);
    assert_bonds_carry_the_step(&b);
    if (kernel->force_state.pass_count == 1) assert_same_alone(&b);
    body_close(&b);
  }
  tried[m->plan->form]++;
  lists += kernel->topology == PL_LIST;
  return kernel->force_state.pass_count;
}

static int check_in(const char *path, const law_choice *choice, law_setting setting, bool irregular,
                    int planned, int neighbours) {
  model m;
  assert_true(model_open(&m, path, choice, choice != NULL));
  m.law = law_on_lattice(m.law, setting, irregular, planned);
  assert_true(model_plan_of_families(&m, &(law_variation){.alone = true}));
  const int passes = check_planned(&m, neighbours);
  model_close(&m);
  return passes;
}

static int in_setting(const char *path, const law_choice *choice, law_setting setting) {
  check_in(path, choice, setting, false, 0, 18);
  check_in(path, choice, setting, false, 6, 6);
  check_in(path, choice, setting, false, 28, 28);
  check_in(path, choice, setting, true, 0, 20);
  return 1;
}

static int in_all_settings(const char *path, const law_choice *choice) {
  return check_settings(path, choice, in_setting);
}

static void both_sides_say_what_a_step_finds(void **state) {
  (void)state;
  check_laws_of_families(in_all_settings);
  assert_true(tried[FORM_LOOPS] && tried[FORM_UNROLLED] && tried[FORM_PAIRS] && lists);
}

/* Also of those whose steps leave rotations of the ends to their neighbours. */
static void laws_of_bonds_in_this_form_say_half(void **state) {
  (void)state;
  static const struct {
    const char *law;
    law_setting setting;
  } of[] = {{"models/cohesive", SETTING_PLANE_STRESS},
            {"models/elastic_central", SETTING_PLANE_STRESS},
            {"models/mplm_bilinear", SETTING_PLANE_STRESS},
            {"models/mplm_concrete", SETTING_PLANE_STRESS},
            {"models/mplm_space", SETTING_SPACE},
            {"tests/generator/laws/frame", SETTING_SPACE}};
  for (size_t k = 0; k < sizeof of / sizeof *of; k++) {
    char path[4096];
    snprintf(path, sizeof path, SOURCE_DIR "/%s.plm", of[k].law);
    assert_int_equal(check_in(path, NULL, of[k].setting, false, 0, 8), 1);
    assert_int_equal(check_in(path, NULL, of[k].setting, false, 18, 18), 1);
    assert_int_equal(check_in(path, NULL, of[k].setting, true, 0, 20), 1);
  }
}

/* One pass, unless the law asks what neighbours find of their own families. */
static void few_laws_ask_neighbours_for_their_families(void **state) {
  (void)state;
  const law_choice objective = {"profile", "objective"};
  const char *concrete = SOURCE_DIR "/models/splm_concrete.plm";
  static const char *const one[] = {"lps", "pmb", "splm_elastic", "splm_concrete"};
  for (size_t k = 0; k < sizeof one / sizeof *one; k++) {
    char path[4096];
    snprintf(path, sizeof path, SOURCE_DIR "/models/%s.plm", one[k]);
    assert_int_equal(check_in(path, NULL, SETTING_PLANE_STRESS, true, 0, 20), 1);
  }
  assert_int_equal(check_in(SOURCE_DIR "/models/eps.plm", NULL, SETTING_SPACE, true, 0, 20), 1);
  assert_int_equal(check_in(concrete, &objective, SETTING_PLANE_STRESS, true, 0, 20), 2);
}

/* Kernels of decks are made without. */
static void only_hosts_are_given_it(void **state) {
  (void)state;
  model m;
  char error[2000];
  const char *note;
  assert_true(model_open(&m, SOURCE_DIR "/models/lps.plm", NULL, 0) && model_plan(&m));
  assert_int_equal(model_kernel(&m, true, &note, error, sizeof error)->force_state.pass_count, 0);
  assert_null(strstr(model_c_text(&m), "force_state_0"));
  model_close(&m);
}

int main(void) {
  const struct CMUnitTest tests[] = {cmocka_unit_test(both_sides_say_what_a_step_finds),
                                     cmocka_unit_test(laws_of_bonds_in_this_form_say_half),
                                     cmocka_unit_test(few_laws_ask_neighbours_for_their_families),
                                     cmocka_unit_test(only_hosts_are_given_it)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
