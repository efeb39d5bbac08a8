/* The physics checks: every broken law of tests/generator/check/physics is caught by the check
   meant for it and by no other, legal and shipped laws pass. Beside each law lie the lines and
   codes expected, e.g. "10 dissipation"; with PERILAT_BLESS=1 they are rewritten: read what
   changed. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>
#include <dirent.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#include "dsl/semantics/law_check.h"
#include "dsl/semantics/law_limits.h"
#include "dsl/syntax/parse.h"
#include "generator/check/physics_energy.h"
#include "generator/check/physics_states.h"
#include "generator/check/physics_tangent.h"
#include "generator/facts/law_judged.h"
#include "generator/intervals/interval_check.h"
#include "generator/kernel/model.h"
#include "generator/lower/lower_inputs.h"
#include "generator/sense/sense.h"
#include "runtime/deck/deck.h"

#define FOLDER SOURCE_DIR "/tests/generator/check/physics/"
#define MODELS SOURCE_DIR "/models/"
enum { PATH_LONGEST = 4096 };

static int is_law(const struct dirent *entry) {
  size_t n = strlen(entry->d_name);
  return n > 4 && strcmp(entry->d_name + n - 4, ".plm") == 0;
}

static void open_law(model *m, const char *folder, const char *name) {
  char path[PATH_LONGEST];
  snprintf(path, sizeof path, "%s%s", folder, name);
  if (model_open(m, path, NULL, 0)) return;
  diag_print(&m->said, stderr);
  fail_msg("%s is not a law", path);
}

static void open_text(model *m, const char *text) {
  memset(m, 0, sizeof *m);
  m->memory = arena_new();
  diag_begin(&m->said, &m->sources);
  int file = source_add(&m->sources, "law.plm", text, strlen(text));
  m->tree = parse_model(m->memory, &m->sources, file, NULL, &m->said);
  m->law = m->tree ? law_check(m->memory, m->tree, &m->sources, NULL, 0, &m->said) : NULL;
  if (m->law) return;
  diag_print(&m->said, stderr);
  fail_msg("not a law");
}

/* --- the folder -------------------------------------------------------------------------- */

typedef struct finding {
  int line;
  const char *code;
} finding;

static int by_line(const void *a, const void *b) {
  const finding *x = a, *y = b;
  return x->line != y->line ? x->line - y->line : strcmp(x->code, y->code);
}

/* "10 dissipation\n...": to be freed. */
static char *findings_of(const char *name) {
  model m;
  open_law(&m, FOLDER, name);
  law_obeys(m.law, NULL, &m.said, NULL);
  finding *all = must_calloc((size_t)m.said.count + 1, sizeof *all);
  for (int k = 0; k < m.said.count; k++) {
    span where = m.said.items[k].where;
    all[k] = (finding){source_place(&m.sources, where.file, where.begin).line,
                       diag_name(m.said.items[k].code)};
  }
  qsort(all, (size_t)m.said.count, sizeof *all, by_line);
  char *text;
  size_t length;
  FILE *out = open_memstream(&text, &length);
  for (int k = 0; k < m.said.count; k++)
    fprintf(out, "%d %s\n", all[k].line, all[k].code);
  fclose(out);
  free(all);
  model_close(&m);
  return text;
}

static bool as_expected(const char *name, const char *found) {
  char path[PATH_LONGEST], expected[1024] = "(no file)\n";
  snprintf(path, sizeof path, "%s%.*s.txt", FOLDER, (int)(strlen(name) - 4), name);
  if (getenv("PERILAT_BLESS")) {
    FILE *f = fopen(path, "wb");
    assert_non_null(f);
    fputs(found, f);
    fclose(f);
    return true;
  }
  FILE *f = fopen(path, "rb");
  if (f) {
    expected[fread(expected, 1, sizeof expected - 1, f)] = 0;
    fclose(f);
  }
  if (f && !strcmp(expected, found)) return true;
  print_error("%s\n--- expected\n%s--- found\n%s", name, expected, found);
  return false;
}

/* A law is named after the check that catches it. */
static bool is_caught_by_its_check(const char *name, const char *found) {
  char code[256];
  snprintf(code, sizeof code, "%s", name);
  for (char *c = code; *c; c++)
    *c = *c == '_' ? '-' : *c;
  for (const char *at = found; *at; at += strcspn(at, "\n") + 1) {
    const char *said = strchr(at, ' ') + 1;
    if (strncmp(code, said, strcspn(said, "\n")) == 0) return true;
  }
  print_error("%s is not caught by its check but by:\n%s", name, found);
  return false;
}

static void broken_laws_are_caught_and_legal_ones_pass(void **state) {
  (void)state;
  struct dirent **entries;
  int count = scandir(FOLDER, &entries, is_law, alphasort), broken = 0, legal = 0, wrong = 0;
  for (int k = 0; k < count; k++) {
    const char *name = entries[k]->d_name;
    char *found = findings_of(name);
    wrong += !as_expected(name, found);
    if (strncmp(name, "legal_", 6) != 0) {
      broken++;
      wrong += !is_caught_by_its_check(name, found);
    } else {
      legal++;
      wrong += *found != 0;
    }
    free(found);
    free(entries[k]);
  }
  free(entries);
  assert_int_equal(wrong, 0);
  assert_true(broken >= 25);
  assert_true(legal >= 8);
}

/* --- laws that pass ---------------------------------------------------------------------- */

/* No false alarm, whatever is drawn. */
static void check_quiet(const char *folder, const char *name, int seeds) {
  model m;
  open_law(&m, folder, name);
  for (int k = 1; k <= seeds; k++) {
    physics_report r;
    const physics_options o = {.seed = (uint64_t)k * 7919};
    (k == 1 ? law_is_sound : physics_check)(m.law, &o, &m.said, &r);
    if (m.said.count) diag_print(&m.said, stderr);
    assert_int_equal(m.said.count, 0);
    assert_int_equal(r.guards_reached, r.guards);
  }
  interval_check(m.law, &m.said);
  if (m.said.count) diag_print(&m.said, stderr);
  assert_int_equal(m.said.count, 0);
  model_close(&m);
}

static void check_folder_quiet(const char *folder, const char *prefix, int seeds, int least) {
  struct dirent **entries;
  int count = scandir(folder, &entries, is_law, alphasort), seen = 0;
  for (int k = 0; k < count; k++) {
    if (strncmp(entries[k]->d_name, prefix, strlen(prefix)) == 0) {
      check_quiet(folder, entries[k]->d_name, seeds);
      seen++;
    }
    free(entries[k]);
  }
  free(entries);
  assert_true(seen >= least);
}

static void shipped_laws_pass_with_any_seed_and_all_guards_are_reached(void **state) {
  (void)state;
  check_folder_quiet(MODELS, "", 12, 4);
}

/* A line of the text is one condition, of laws of bonds and of families, however often it is
   called. */
static void conditions_of_a_function_count_once(void **state) {
  (void)state;
  static const char *const laws[] = {
      "law central bond\n%s  force N = a*(cut(stretch) + cut(2*stretch))\nend model\n",
      "law state\n  for plane_stress\n%s  force state F[j] = a*(cut(stretch[j]) + "
      "cut(2*stretch[j]))"
      "\nend model\n"};
  for (size_t k = 0; k < sizeof laws / sizeof *laws; k++) {
    char lines[600], text[700];
    model m;
    physics_report r;
    snprintf(lines, sizeof lines, laws[k],
             "  parameter a = 40 [MN] in (0, inf)\n"
             "  parameter rho = 2300 [kg/m^3] in (0, inf)\n"
             "  function cut(x) = | x            when x <= 1e-3\n"
             "                    | 5e-4 + x/2   otherwise\n");
    snprintf(text, sizeof text, "model twice\n  %s", lines);
    open_text(&m, text);
    law_is_sound(m.law, NULL, &m.said, &r);
    assert_int_equal(m.said.errors, 0);
    assert_int_equal(r.guards, 1);
    assert_int_equal(r.guards_reached, 1);
    model_close(&m);
  }
}

/* Every choice of every option of a law, too. */
static void check_choices_quiet(const char *name, int *tried) {
  model first, m;
  char path[PATH_LONGEST];
  open_law(&first, MODELS, name);
  snprintf(path, sizeof path, "%s%s", MODELS, name);
  for (int k = 0; k < first.law->options.count; k++) {
    const stmt *option = first.law->options.items[k]->declared;
    for (int w = 0; w < option->word_count; w++, ++*tried) {
      law_choice choice = {option->name, option->words[w]};
      assert_true(model_open(&m, path, &choice, 1));
      physics_report r;
      law_is_sound(m.law, NULL, &m.said, &r);
      interval_check(m.law, &m.said);
      if (m.said.count) diag_print(&m.said, stderr);
      assert_int_equal(m.said.count, 0);
      assert_int_equal(r.guards_reached, r.guards);
      model_close(&m);
    }
  }
  model_close(&first);
}

static void shipped_laws_pass_with_any_option(void **state) {
  (void)state;
  struct dirent **entries;
  int count = scandir(MODELS, &entries, is_law, alphasort), tried = 0;
  for (int k = 0; k < count; k++) {
    check_choices_quiet(entries[k]->d_name, &tried);
    free(entries[k]);
  }
  free(entries);
  assert_true(tried >= 2);
}

static void legal_laws_pass_with_any_seed(void **state) {
  (void)state;
  check_folder_quiet(FOLDER, "legal_", 6, 8);
}

/* What a check costs is how many states it evaluates: about a microsecond each. */
static void a_check_evaluates_few_states(void **state) {
  (void)state;
  struct dirent **entries;
  int count = scandir(MODELS, &entries, is_law, alphasort);
  assert_true(count > 0);
  for (int k = 0; k < count; k++) {
    model m;
    physics_report found;
    open_law(&m, MODELS, entries[k]->d_name);
    law_is_sound(m.law, NULL, &m.said, &found);
    model_close(&m);
    if (!(found.states > 100 && found.states < 1000000))
      fail_msg("%s: %ld states", entries[k]->d_name, (long)found.states);
    free(entries[k]);
  }
  free(entries);
}

/* What is no number at rest has one cause, and so has a law that gains because a state forgets:
   they are named with their remedies. A state that is a function of the strain forgets nothing. */
static void causes_are_named_with_their_remedies(void **state) {
  (void)state;
  static const struct {
    const char *law;
    diag_code code;
    const char *message, *hint;
  } cases[] = {
      {"rest_force_divisor.plm", DIAG_REST_FORCE, "divides by `von_mises(trial)`, which is 0",
       "`max(von_mises(trial), 1 [Pa])`"},
      {"rest_force_return.plm", DIAG_REST_FORCE, "a flow that is returned is not found", "at rest"},
      {"dissipation_forgets.plm", DIAG_DISSIPATION, "negative energy", "`eps_p = eps_p + ...`"},
      {"dissipation_remembers.plm", DIAG_DISSIPATION, "negative energy", "softer on the way back"}};
  for (size_t k = 0; k < sizeof cases / sizeof *cases; k++) {
    model m;
    int found = 0;
    open_law(&m, FOLDER, cases[k].law);
    physics_check(m.law, NULL, &m.said, NULL);
    for (int i = 0; i < m.said.count; i++) {
      if (m.said.items[i].code != cases[k].code) continue;
      found++;
      assert_non_null(strstr(m.said.items[i].message, cases[k].message));
      assert_non_null(strstr(m.said.items[i].hint, cases[k].hint));
    }
    assert_int_equal(found, 1);
    model_close(&m);
  }
}

/* The same seed says the same thing. */
/* What a law says that it means is no error; all else is, and a strict check knows no waivers. */
static void a_law_may_accept_what_is_found(void **state) {
  (void)state;
  static const char text_of[] =
      "model prestressed\n  law central bond\n"
      "  parameter EA = 2 [MN] in (0, inf)\n  force N = EA*(stretch - 1e-4)\n"
      "%send model\n";
  static const struct {
    const char *line;
    int errors, accepted;
  } cases[] = {{"", 1, 0},
               {"  accept healing \"no\"\n", 1, 0},
               {"  accept rest-force \"prestress\"\n", 0, 1},
               {"  accept healing \"no\"\n  accept rest-force \"yes\"\n", 0, 1}};
  for (size_t k = 0; k < sizeof cases / sizeof *cases; k++)
    for (int strict = 0; strict < 2; strict++) {
      char text[512];
      model m;
      snprintf(text, sizeof text, text_of, cases[k].line);
      open_text(&m, text);
      const bool good = physics_check(m.law, &(physics_options){.strict = strict}, &m.said, NULL);
      assert_int_equal(m.said.errors, strict ? 1 : cases[k].errors);
      assert_int_equal(m.said.accepted_count, strict ? 0 : cases[k].accepted);
      assert_int_equal(good, m.said.errors == 0);
      model_close(&m);
    }
}

/* Of ranges, too: the root of what can be negative. */
static void a_law_may_accept_its_ranges(void **state) {
  (void)state;
  for (int accepts = 0; accepts < 2; accepts++) {
    char text[512];
    model m;
    snprintf(text, sizeof text,
             "model rooted\n  law central bond\n  parameter EA = 2 [MN] in (0, inf)\n"
             "  parameter x = 1 in (-1, 2)\n  force N = EA*sqrt(x)*stretch\n%send model\n",
             accepts ? "  accept domain \"x is positive in every deck\"\n" : "");
    open_text(&m, text);
    interval_check(m.law, &m.said);
    assert_int_equal(m.said.count, !accepts);
    assert_int_equal(m.said.accepted_count, accepts);
    model_close(&m);
  }
}

static void findings_are_reproducible(void **state) {
  (void)state;
  model a, b;
  open_law(&a, FOLDER, "dissipation_friction.plm");
  open_law(&b, FOLDER, "dissipation_friction.plm");
  physics_check(a.law, NULL, &a.said, NULL);
  physics_check(b.law, NULL, &b.said, NULL);
  assert_int_equal(a.said.count, b.said.count);
  assert_true(a.said.count > 0);
  for (int k = 0; k < a.said.count; k++) {
    assert_string_equal(a.said.items[k].message, b.said.items[k].message);
    assert_string_equal(a.said.items[k].note, b.said.items[k].note);
  }
  model_close(&a);
  model_close(&b);
}

/* --- parameters of a deck ---------------------------------------------------------------- */

static void the_parameters_given_decide(void **state) {
  (void)state;
  static const char text[] = "model turning\n  law central bond\n"
                             "  parameter k = 5 [MN] in (0, inf)\n"
                             "  parameter c = 0.1 in [0, 1]\n"
                             "  force N = k*(1 - 2*c)*stretch\nend model\n";
  static const deck_lattice plate = {.kind = "hexagonal",
                                     .spacing = 0.01,
                                     .thickness = 0.1,
                                     .stiffness_thickness = 0.1,
                                     .mass_thickness = 0.1,
                                     .setting = "plane_stress"};
  model m;
  open_text(&m, text);
  const double safe[] = {5e6, 0.3}, unsafe[] = {5e6, 0.6};
  assert_true(law_is_sound(m.law,
                           &(physics_options){.parameters = safe, .lattice = &plate, .effort = 0.5},
                           &m.said, NULL));
  assert_int_equal(m.said.count, 0);
  assert_false(law_is_sound(m.law, &(physics_options){.parameters = unsafe, .lattice = &plate},
                            &m.said, NULL));
  assert_int_equal(m.said.items[0].code, DIAG_STIFFNESS);
  assert_non_null(strstr(m.said.items[0].note, "c = 0.6"));
  model_close(&m);
}

/* Drawn parameters keep all bounds, those that refer to each other too. */
static void drawn_parameters_keep_their_bounds(void **state) {
  (void)state;
  static const char text[] =
      "model bounded\n  law central bond\n"
      "  parameter k = 5 [MN] in (0, inf)\n"
      "  parameter a = 2 in (1, 2.5]\n  parameter b = 3 in (a, 4)\n  parameter c = 3.5 in [b, 4]\n"
      "  parameter off = 0 in [0, 1)\n  parameter free [MPa] in (1 [kPa], inf)\n"
      "  force N = k*stretch*(b - a)*(c + off)*free/free\nend model\n";
  model m;
  open_text(&m, text);
  bench b;
  static const physics_options usual = {0};
  assert_true(bench_open(&b, m.law, &usual, &m.said));
  double **states = bench_states(&b), column[64], least = INFINITY, most = 0, on = 0;
  assert_true(b.width <= 64);
  for (int round = 0; round < 20; round++)
    for (int lane = 0; lane < BENCH_LANES; lane++) {
      bench_draw(&b, states, lane);
      bench_get(&b, states, lane, column);
      char interval[64];
      for (int p = 0; p < b.parameter_count; p++)
        assert_true(law_parameter_within(m.law, p, column, interval, sizeof interval));
      least = fmin(least, column[0]);
      most = fmax(most, column[0]);
      on += column[4] > 0;
    }
  assert_true(least < 0.6 * 5e6 && most > 1.8 * 5e6);
  assert_true(on > 100); /* what is switched off by default is tried */
  bench_states_free(&b, states);
  bench_close(&b);
  model_close(&m);
}

/* --- work -------------------------------------------------------------------------------- */

static physics *open_physics(model *m, const char *text) {
  static const physics_options usual = {0};
  open_text(m, text);
  physics *p = must_calloc(1, sizeof *p);
  p->said = &m->said;
  assert_true(bench_open(&p->b, m->law, &usual, &m->said));
  bench_allow(&p->b, 10);
  p->pool = must_calloc((size_t)POOL_MOST * (size_t)p->b.width, sizeof *p->pool);
  return p;
}

static void close_physics(physics *p, model *m) {
  bench_close(&p->b);
  free(p->pool);
  free(p);
  model_close(m);
}

/* Stored energy of a bond with plastic stretch: EA s (stretch - S_p)^2/2, from its own stress-free
 * state. */
static void work_is_that_of_theory(void **state) {
  (void)state;
  static const char text[] =
      "model plastic\n  law central bond\n  parameter EA = 5 [MN] in (0, inf)\n"
      "  state S_p = 0\n  S_p = previous(S_p)\n  damage d = | 0 when stretch <= 1 | 1 otherwise "
      "jump\n"
      "  force N = (1 - d)*EA*(stretch - S_p)\nend model\n";
  model m;
  physics *p = open_physics(&m, text);
  double **states = bench_states(&p->b);
  for (int lane = 0; lane < 8; lane++) {
    bench_draw(&p->b, states, lane);
    bench_virgin(&p->b, states, lane);
    bench_field(&p->b, states, 0)[lane] = 1e-3 * (lane - 3);
    bench_field(&p->b, states, 1)[lane] = lane / 10.0;
    bench_move(&p->b, states, lane, (motion){{2e-3 * (lane % 3), 5, 0, 0}});
  }
  work_done w[BENCH_LANES];
  physics_work(p, states, 8, 1, w);
  for (int lane = 0; lane < 8; lane++) {
    double e = 2e-3 * (lane % 3) - 1e-3 * (lane - 3),
           s = bench_quantity(&p->b, states, QUANTITY_S)[lane];
    double theory = (1 - lane / 10.0) * states[0][lane] * s * e * e / 2;
    assert_true(w[lane].known);
    assert_true(fabs(w[lane].work - theory) <= 1e-7 * theory + 1e-18);
  }
  bench_states_free(&p->b, states);
  close_physics(p, &m);
}

/* --- faults that the language does not let a law have ------------------------------------- */

/* Units and shapes keep rotations out of the axial force: such a force is put in by hand. */
static void a_force_that_knows_left_from_right_fails_the_mirror(void **state) {
  (void)state;
  static const char text[] =
      "model beam\n  law micropolar bond\n  parameter k = 5 [MN] in (0, inf)\n"
      "  force N = k*stretch\n  moment M_i = k*s*(2*theta_i + theta_j)/6\n"
      "  moment M_j = k*s*(2*theta_j + theta_i)/6\nend model\n";
  model m;
  physics *p = open_physics(&m, text);
  physics_histories(p, 2);
  assert_int_equal(m.said.count, 0);
  ir *g = p->b.graph;
  ir_node turn =
      ir_add(g, lower_quantity(g, QUANTITY_THETA_I), lower_quantity(g, QUANTITY_THETA_J));
  ir_node roots[FORCE_COUNT] = {ir_add(g, p->b.law_step.N, turn), p->b.law_step.M_i[0],
                                p->b.law_step.M_j[0]};
  probe_free(&p->b.step);
  p->b.step = probe_new(&p->b, roots, FORCE_COUNT);
  physics_histories(p, 2);
  assert_int_equal(m.said.count, 1);
  assert_int_equal(m.said.items[0].code, DIAG_MIRROR);
  close_physics(p, &m);
}

/* A derivative that is off by one part in a thousand is seen; the right one passes. */
static void a_wrong_tangent_is_seen(void **state) {
  (void)state;
  static const char text[] = "model curve\n  law central bond\n  parameter k = 5 [MN] in (0, inf)\n"
                             "  force N = k*tanh(stretch + abs(stretch)**3)\nend model\n";
  model m;
  physics *p = open_physics(&m, text);
  physics_histories(p, 4);
  assert_true(p->pool_count > 50);
  physics_check_tangent(p, 0);
  assert_int_equal(m.said.count, 0);
  physics_check_tangent(p, 1e-3 * 5e6);
  assert_int_equal(m.said.count, 1);
  assert_int_equal(m.said.items[0].code, DIAG_TANGENT);
  close_physics(p, &m);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(broken_laws_are_caught_and_legal_ones_pass),
      cmocka_unit_test(shipped_laws_pass_with_any_seed_and_all_guards_are_reached),
      cmocka_unit_test(conditions_of_a_function_count_once),
      cmocka_unit_test(shipped_laws_pass_with_any_option),
      cmocka_unit_test(legal_laws_pass_with_any_seed),
      cmocka_unit_test(a_check_evaluates_few_states),
      cmocka_unit_test(causes_are_named_with_their_remedies),
      cmocka_unit_test(a_law_may_accept_what_is_found),
      cmocka_unit_test(a_law_may_accept_its_ranges),
      cmocka_unit_test(findings_are_reproducible),
      cmocka_unit_test(the_parameters_given_decide),
      cmocka_unit_test(drawn_parameters_keep_their_bounds),
      cmocka_unit_test(work_is_that_of_theory),
      cmocka_unit_test(a_force_that_knows_left_from_right_fails_the_mirror),
      cmocka_unit_test(a_wrong_tangent_is_seen),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
