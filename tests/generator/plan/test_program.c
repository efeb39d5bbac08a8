/* Programs of families: how many passes and loops they need. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "generator/plan/program_facts.h"
#include "tests/generator/plan/family_text.h"

static int loops_of(const program_pass *p) {
  int loops = 0;
  for (int k = 0; k < p->segment_count; k++)
    loops += p->segments[k].kind == OVER_NEIGHBOURS;
  return loops;
}

/* Values that the ends of a bond share; only the first pass finds them. */
static int shared_by(const kernel_program *p) {
  int count = 0;
  for (int at = 0; at < p->pass_count; at++)
    for (int k = 0; k < p->passes[at].segment_count; k++) {
      const segment *a = &p->passes[at].segments[k];
      for (int r = 0; r < a->root_count; r++) {
        if (a->roots[r].target != TO_SHARED) continue;
        assert_int_equal(a->kind, OVER_BONDS);
        assert_int_equal(at, 0);
        count++;
      }
    }
  return count;
}

static void one_sum_needs_one_pass_and_one_loop(void **state) {
  (void)state;
  tested_law *t =
      open_program("", "  force state F[j] = a*stretch[j]\n  output all = sum(stretch[j])\n");
  const kernel_program *step = &t->plan->programs[PROGRAM_STEP],
                       *observe = &t->plan->programs[PROGRAM_OBSERVE];
  assert_int_equal(
      step->pass_count,
      2); /* the first is over bonds: 1/length, which stretch and direction are made of */
  assert_int_equal(shared_by(step), 1);
  assert_int_equal(loops_of(&step->passes[0]), 0);
  assert_int_equal(loops_of(&step->passes[1]), 1);
  assert_int_equal(observe->pass_count, 1);
  assert_int_equal(loops_of(&observe->passes[0]), 1);
  assert_int_equal(t->plan->links.of_particles, 0);
  assert_int_equal(t->plan->links.of_bonds, 1);
  close_law(t);
}

/* What the ends have alike, or exchange, is shared; what one end has alone is not, nor what is
   cheap given the rest. */
static void ends_share_what_is_the_same_for_both(void **state) {
  (void)state;
  static const struct {
    const char *lines;
    int shared; /* besides stretch */
  } laws[] = {
      {"  force state F[j] = a*stretch[j] along reference\n", 0},
      {"  force state F[j] = a*exp(w)*exp(w[j])*stretch[j] along reference\n",
       0}, /* cheap: particle by particle */
      {"  d[j] = (1 - w)*(1 - w[j])/(2 - w - w[j])/(1 + w*w[j])*sqrt(4 - w - w[j])\n"
       "  force state F[j] = a*d[j]*stretch[j] along reference\n",
       1},
      {"  d[j] = (1 - w)*(1 - w[j])/(2 - w - w[j])/(1 + w*w[j])*sqrt(4 - w)\n"
       "  force state F[j] = a*d[j]*stretch[j] along reference\n",
       1}, /* the mean of both ends' forces */
      {"  x[j] = stretch[j] - (p[j] + p'[j])/2\n"
       "  force state F[j] = a*(exp(x[j]) - exp(-x[j]) + tanh(x[j])) along reference\n",
       1},
      {"  x[j] = stretch[j] - (p[j] + 2*p'[j])/3\n"
       "  force state F[j] = a*(exp(x[j]) - exp(-x[j]) + tanh(x[j])) along reference\n",
       0},
  };
  for (size_t k = 0; k < sizeof laws / sizeof *laws; k++) {
    char text[2000];
    snprintf(text, sizeof text,
             "  damage w on particle\n  state p on neighbour = 0\n%s"
             "  w = norm(stretch)\n  p[j] = previous(p[j])\n  output seen = w + sum(p[j])\n",
             laws[k].lines);
    tested_law *t = open_program("", text);
    if (shared_by(&t->plan->programs[PROGRAM_STEP]) != 1 + laws[k].shared)
      fail_msg("%d values are shared, not %d:\n%s", shared_by(&t->plan->programs[PROGRAM_STEP]),
               1 + laws[k].shared, laws[k].lines);
    assert_int_equal(shared_by(&t->plan->programs[PROGRAM_OBSERVE]), 0);
    close_law(t);
  }
}

static void long_horizons_share_nothing(void **state) {
  (void)state;
  static const char *const broken = "  damage w on bond\n  w[j] = | 1 when stretch[j] >= 1 jump\n"
                                    "         | 0 otherwise\n"
                                    "  force state F[j] = (1 - w[j])*a*stretch[j]\n",
                           *const whole = "  force state F[j] = a*stretch[j]\n";
  tested_law *t = open_program("  for space\n", broken);
  assert_int_equal(shared_by(&t->plan->programs[PROGRAM_STEP]), 0);
  assert_int_equal(t->plan->programs[PROGRAM_STEP].pass_count, 1);
  close_law(t);
  t = open_program("  for space\n", whole);
  assert_int_equal(shared_by(&t->plan->programs[PROGRAM_STEP]), 1);
  close_law(t);
}

/* The law planned again for families of so many neighbours. */
static tested_law *open_family(int neighbours, const char *lines) {
  tested_law *t = open_program("  for space\n", lines);
  plan_interpreted_free(t->kernel);
  plan_free(t->plan);
  t->law->neighbours = neighbours;
  t->plan = plan_kernel(t->law, &t->said);
  assert_non_null(t->plan);
  t->kernel = plan_interpreted(t->plan);
  return t;
}

static tested_law *open_large(const char *lines) {
  return open_family(122, lines);
}

static const segment *pairs_of(const program_pass *p) {
  for (int k = 0; k < p->segment_count; k++)
    if (p->segments[k].kind == OVER_PAIRS) return &p->segments[k];
  return NULL;
}

static void assert_form(int neighbours, const char *lines, kernel_form expected) {
  tested_law *t = open_family(neighbours, lines);
  if (t->plan->form != expected)
    fail_msg("form %d, not %d, for %d neighbours:\n%s", t->plan->form, expected, neighbours, lines);
  assert_int_equal(program_sum_count(&t->plan->programs[PROGRAM_STEP]) > 0, expected == FORM_PAIRS);
  close_law(t);
}

/* Small families are written out, unless bonds have fields that their ends would both write; in
   larger ones bonds add to both ends, unless these compute nothing alike. */
static void families_have_the_form_that_suits(void **state) {
  (void)state;
  static const char *const plain = "  force state F[j] = a*stretch[j]\n";
  static const char *const broken = "  damage w on bond\n  w[j] = | 1 when stretch[j] >= 1 jump\n"
                                    "         | 0 otherwise\n"
                                    "  force state F[j] = (1 - w[j])*a*stretch[j]\n";
  static const char *const of_ends = "  state p on neighbour = 0\n  p[j] = previous(p[j])\n"
                                     "  force state F[j] = (1 - p[j])*a*stretch[j]\n";
  assert_form(0, plain, FORM_LOOPS);
  assert_form(0, broken, FORM_LOOPS);
  assert_form(12, plain, FORM_UNROLLED);
  assert_form(14, plain, FORM_PAIRS);
  assert_form(6, broken, FORM_PAIRS);
  assert_form(122, broken, FORM_PAIRS);
  assert_form(12, of_ends, FORM_UNROLLED);
  assert_form(18, of_ends, FORM_UNROLLED);
  assert_form(26, of_ends, FORM_LOOPS);
}

/* Where many bonds meet in space, one end computes the force over the length, when both sums are
   known, and both read it. Links are kept of one reach of rows only. */
static void one_end_computes_the_force_of_a_bond(void **state) {
  (void)state;
  tested_law *t =
      open_family(12, "  force state F[j] = a*stretch[j]/(1 + sum(stretch[j])*stretch[j])\n");
  const kernel_program *step = &t->plan->programs[PROGRAM_STEP];
  assert_int_equal(step->pass_count, 4);
  assert_int_equal(step->passes[2].segment_count, 1);
  const segment *bonds = &step->passes[2].segments[0];
  assert_int_equal(bonds->kind, OVER_BONDS);
  assert_int_equal(bonds->root_count, 1);
  assert_int_equal(bonds->roots[0].target, TO_SHARED);
  assert_int_equal(program_at_hand(t->plan->graph, step), 1 + 2 + 8);
  assert_int_equal(program_reaches_spared(t->plan->graph, step), 1);
  close_law(t);
  t = open_family(12, "  force state F[j] = a*stretch[j]\n"); /* nothing that passes would add */
  assert_int_equal(t->plan->programs[PROGRAM_STEP].pass_count, 2);
  close_law(t);
  /* each end has its part; what is left costs less than to share it */
  t = open_family(12, "  force state F[j] = a*stretch[j] + b*sum(stretch[j])\n");
  assert_int_equal(t->plan->programs[PROGRAM_STEP].pass_count, 3);
  close_law(t);
}

/* Forces of the ends are opposite, sums of stretches the same; a later pass reads the damage that
   the first one found. */
static void bonds_of_large_families_add_to_both_ends(void **state) {
  (void)state;
  tested_law *t = open_large("  damage w on bond\n  w[j] = | 1 when stretch[j] >= 1 jump\n"
                             "         | 0 otherwise\n"
                             "  d = sum((1 - w[j])*stretch[j])\n"
                             "  force state F[j] = (1 - w[j])*(a*stretch[j] + b*d)\n");
  const kernel_program *step = &t->plan->programs[PROGRAM_STEP];
  assert_int_equal(step->pass_count, 2);
  assert_int_equal(program_sum_count(step), 3);
  assert_true(program_pairs_field(step, 0));
  assert_int_equal(t->plan->links.of_particles, 1);
  assert_int_equal(t->plan->links.of_bonds, 0);
  for (int at = 0; at < 2; at++) {
    const segment *a = pairs_of(&step->passes[at]);
    assert_non_null(a);
    assert_int_equal(a->root_count, at ? 3 : 2);
    for (int k = 0; k < a->root_count; k++)
      assert_int_equal(a->roots[k].parity, at ? -1 : 1);
  }
  close_law(t);
}

/* Of a force that is linear in particles' sums each end gives what stands before the stretch, and
   the rest; the weight does not change from step to step. */
static void particles_of_large_families_give_their_parts(void **state) {
  (void)state;
  tested_law *t = open_large("  w = sum(s**2)\n  d = sum(s**2*stretch[j])/w\n"
                             "  force state F[j] = s**2*(a*(stretch[j] - d/3) + b*d)/w\n");
  const kernel_program *step = &t->plan->programs[PROGRAM_STEP];
  assert_int_equal(step->pass_count, 2);
  assert_int_equal(t->plan->links.of_particles, 2);
  assert_int_equal(program_constant_sums(t->plan->graph, step, NULL), 1);
  const segment *forces = pairs_of(&step->passes[1]);
  assert_non_null(forces);
  ir_node nodes[6];
  assert_int_equal(segment_nodes(t->plan->graph, forces, nodes), 6);
  assert_true(nodes[0] == nodes[1] && nodes[1] == nodes[2]); /* times the chord */
  assert_int_equal(ir_count_cost(t->plan->graph, nodes, 1, ON_BOND, NULL).divisions, 0);
  close_law(t);
}

/* What cannot be taken apart stays the mean of both sides. */
static void forces_that_are_not_linear_stay_whole(void **state) {
  (void)state;
  tested_law *t = open_large("  d = sum(stretch[j])\n"
                             "  force state F[j] = max(a*stretch[j] - b*d, a*stretch[j])\n");
  assert_int_equal(t->plan->programs[PROGRAM_STEP].pass_count, 2);
  assert_int_equal(t->plan->links.of_particles, 1);
  assert_non_null(pairs_of(&t->plan->programs[PROGRAM_STEP].passes[1]));
  close_law(t);
}

/* What either end sees in its own way is computed by both. */
static void ends_that_differ_are_no_pair(void **state) {
  (void)state;
  tested_law *t = open_large("  state p on neighbour = 0\n  damage w on particle\n"
                             "  p[j] = max(previous(p[j]), abs(stretch[j])*(1 - previous(w)))\n"
                             "  w = mean(p[j])\n"
                             "  force state F[j] = (1 - w)*a*stretch[j]\n");
  const kernel_program *step = &t->plan->programs[PROGRAM_STEP];
  assert_null(pairs_of(&step->passes[0]));
  assert_false(program_pairs_field(step, 0));
  assert_non_null(pairs_of(&step->passes[step->pass_count - 1])); /* the mean of both forces */
  close_law(t);
}

static void a_sum_that_the_neighbour_has_too_is_a_link_and_a_second_pass(void **state) {
  (void)state;
  tested_law *t = open_program("", "  force state F[j] = a*stretch[j] + b*sum(stretch[j])\n");
  assert_int_equal(t->plan->programs[PROGRAM_STEP].pass_count, 3);
  assert_int_equal(loops_of(&t->plan->programs[PROGRAM_STEP].passes[1]), 1);
  assert_int_equal(loops_of(&t->plan->programs[PROGRAM_STEP].passes[2]), 1);
  assert_int_equal(t->plan->links.of_particles, 1);
  close_law(t);
}

static int count_asking(const kernel_program *p, segment_target target) {
  int count = 0;
  for (int k = 0; k < p->pass_count; k++)
    for (int s = 0; s < p->passes[k].segment_count; s++)
      for (int r = 0; r < p->passes[k].segments[s].root_count; r++) {
        const segment_root *root = &p->passes[k].segments[s].roots[r];
        count += root->target == target && segment_asks(root);
      }
  return count;
}

/* Sums of products with shared values ask for no absent bonds: owners ask once. What is not 0 there
   is asked for. */
static void owners_leave_zeros_for_absent_bonds(void **state) {
  (void)state;
  tested_law *t = open_family(12, "  force state F[j] = a*stretch[j] + b*sum(stretch[j])\n");
  assert_int_equal(count_asking(&t->plan->programs[PROGRAM_STEP], TO_SUM), 0);
  assert_int_equal(count_asking(&t->plan->programs[PROGRAM_STEP], TO_SHARED),
                   2); /* stretch, 1/length */
  close_law(t);
  t = open_family(12, "  force state F[j] = a*stretch[j] + b*sum(exp(stretch[j]))\n");
  assert_int_equal(count_asking(&t->plan->programs[PROGRAM_STEP], TO_SUM),
                   1 + 3); /* exp may be no number in forces, too */
  close_law(t);
}

/* What is cheap is computed on both sides; what is dear is kept for the other side. */
static void a_dear_value_toward_the_neighbour_is_kept(void **state) {
  (void)state;
  tested_law *t = open_program("", "  damage w on particle\n  w = norm(stretch)\n"
                                   "  x[j] = stretch[j]/1e-3\n"
                                   "  hard[j] = exp(x[j]) - exp(-x[j]) + tanh(x[j])\n"
                                   "  force state F[j] = (1 - previous(w))*a*hard[j]\n");
  assert_int_equal(t->plan->programs[PROGRAM_STEP].pass_count, 3);
  assert_int_equal(t->plan->links.of_particles, 0);
  assert_int_equal(t->plan->links.of_bonds,
                   1 + (shared_by(&t->plan->programs[PROGRAM_STEP]) + 1) / 2);
  close_law(t);
  t = open_program("", "  x[j] = stretch[j]/1e-3\n" /* the same on both sides */
                       "  force state F[j] = a*(exp(x[j]) - exp(-x[j]) + tanh(x[j]))\n");
  assert_int_equal(t->plan->programs[PROGRAM_STEP].pass_count, 2);
  assert_int_equal(t->plan->links.of_bonds, (shared_by(&t->plan->programs[PROGRAM_STEP]) + 1) / 2);
  close_law(t);
}

/* Particles leave what is dear and theirs alone to all their bonds; the other end does not compute
   it again. */
static void what_one_end_has_by_itself_is_left(void **state) {
  (void)state;
  static const struct {
    const char *factor;
    int links;
  } cases[] = {{"(1 - old[j])", 0},
               {"exp(old[j])", 0}, /* cheaper than a pass */
               {"exp(old[j])*tanh(old[j] + 1)*sqrt(2 - old[j])", 1},
               {"exp(old[j])*tanh(old[j] + 1)*sqrt(2 - stretch[j])", 0}, /* of the bond */
               {"exp(nu)*tanh(nu + 1)*sqrt(nu)", 0}};
  for (size_t k = 0; k < sizeof cases / sizeof *cases; k++) {
    char text[1000];
    snprintf(text, sizeof text,
             "  state w on particle = 0\n  old = previous(w)\n"
             "  force state F[j] = a*%s*stretch[j] along reference\n  w = norm(stretch)\n",
             cases[k].factor);
    tested_law *t = open_program("", text);
    const program_pass *first = &t->plan->programs[PROGRAM_STEP].passes[0];
    int links = 0;
    for (int n = 0; n < first->segment_count; n++)
      for (int r = 0; r < first->segments[n].root_count; r++)
        links += first->segments[n].roots[r].target == TO_LINK;
    if (links != cases[k].links) fail_msg("%d links of %s", links, cases[k].factor);
    close_law(t);
  }
}

static void neighbours_of_neighbours_need_a_pass_more(void **state) {
  (void)state;
  tested_law *t = open_program("", "  near = sum(stretch[j])\n  far = sum(near[j])\n"
                                   "  force state F[j] = a*stretch[j] + b*far\n");
  assert_int_equal(t->plan->programs[PROGRAM_STEP].pass_count, 4);
  assert_int_equal(t->plan->links.of_particles, 3); /* two of the step, one that observing leaves */
  close_law(t);
}

/* A value toward a neighbour that costs little is computed again in a second loop, a dear one is
   kept. */
static void dear_values_are_kept_in_planes(void **state) {
  (void)state;
  tested_law *cheap = open_program("", "  state p on neighbour = 0\n  p[j] = stretch[j]\n"
                                       "  force state F[j] = a*stretch[j]\n"
                                       "  output d = norm(deviator(p))\n");
  tested_law *dear = open_program("", "  force state F[j] = a*stretch[j]\n"
                                      "  output d = norm(deviator(stretch))\n");
  assert_int_equal(loops_of(&cheap->plan->programs[PROGRAM_OBSERVE].passes[0]), 2);
  assert_int_equal(cheap->plan->programs[PROGRAM_OBSERVE].passes[0].plane_count, 0);
  assert_int_equal(loops_of(&dear->plan->programs[PROGRAM_OBSERVE].passes[0]), 2);
  assert_int_equal(dear->plan->programs[PROGRAM_OBSERVE].passes[0].plane_count, 1);
  close_law(cheap);
  close_law(dear);
}

/* Planes stand on the stack: a law of many dear values computes some of them twice. */
static void planes_are_few(void **state) {
  (void)state;
  char lines[7000] = "  force state F[j] = a*stretch[j]\n";
  for (int k = 1; k <= 40; k++) {
    char *end = lines + strlen(lines);
    snprintf(end, sizeof lines - strlen(lines),
             "  x%d[j] = exp(%d*stretch[j])\n  output o%d = norm(deviator(x%d))\n", k, k, k, k);
  }
  tested_law *t = open_program("", lines);
  const program_pass *observe = &t->plan->programs[PROGRAM_OBSERVE].passes[0];
  assert_int_equal(loops_of(observe), 2);
  assert_in_range(observe->plane_count, 1, 16);
  close_law(t);
}

/* The example of program.h and program_schedule.h. */
static void assert_segment(const program_pass *p, int number, segment_kind kind,
                           segment_target first, int roots) {
  assert_true(number < p->segment_count);
  const segment *a = &p->segments[number];
  assert_int_equal(a->kind, kind);
  assert_int_equal(a->root_count, roots);
  assert_int_equal(a->roots[0].target, first);
}

static void the_example_has_the_segments_that_are_said(void **state) {
  (void)state;
  tested_law *t = open_law("model example\n  law state\n  for plane_stress\n"
                           "  parameter E = 30 [GPa] in (0, inf)\n"
                           "  theta = mean(stretch[j])\n"
                           "  force state F[j] = E*spacing*t*(stretch[j] + theta)\nend model\n");
  const kernel_program *step = &t->plan->programs[PROGRAM_STEP],
                       *observe = &t->plan->programs[PROGRAM_OBSERVE];
  assert_int_equal(step->pass_count, 3);
  assert_segment(&step->passes[0], 0, OVER_NEIGHBOURS, TO_SUM, 1);
  assert_segment(&step->passes[0], 1, OVER_PARTICLES, TO_LINK, 2);
  assert_segment(&step->passes[0], 2, OVER_BONDS, TO_SHARED, 1);
  assert_segment(&step->passes[1], 0, OVER_NEIGHBOURS, TO_SUM, 1);
  assert_segment(&step->passes[1], 1, OVER_PARTICLES, TO_LINK, 1);
  assert_segment(&step->passes[2], 0, OVER_NEIGHBOURS, TO_SUM, 2);
  assert_segment(&step->passes[2], 1, OVER_PARTICLES, TO_FORCE, 2);
  assert_string_equal(ir_name(t->plan->graph, step->passes[0].segments[2].roots[0].node),
                      "per_length");
  assert_int_equal(observe->pass_count, 1);
  assert_int_equal(observe->passes[0].plane_count, 1);
  assert_segment(&observe->passes[0], 0, OVER_NEIGHBOURS, TO_PLANE, 3);
  assert_segment(&observe->passes[0], 1, OVER_PARTICLES, TO_SLOT, 1);
  assert_segment(&observe->passes[0], 2, OVER_NEIGHBOURS, TO_SUM, 1);
  assert_segment(&observe->passes[0], 3, OVER_PARTICLES, TO_OBSERVED, 1);
  close_law(t);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(the_example_has_the_segments_that_are_said),
      cmocka_unit_test(one_sum_needs_one_pass_and_one_loop),
      cmocka_unit_test(ends_share_what_is_the_same_for_both),
      cmocka_unit_test(long_horizons_share_nothing),
      cmocka_unit_test(families_have_the_form_that_suits),
      cmocka_unit_test(one_end_computes_the_force_of_a_bond),
      cmocka_unit_test(owners_leave_zeros_for_absent_bonds),
      cmocka_unit_test(bonds_of_large_families_add_to_both_ends),
      cmocka_unit_test(particles_of_large_families_give_their_parts),
      cmocka_unit_test(forces_that_are_not_linear_stay_whole),
      cmocka_unit_test(ends_that_differ_are_no_pair),
      cmocka_unit_test(a_sum_that_the_neighbour_has_too_is_a_link_and_a_second_pass),
      cmocka_unit_test(a_dear_value_toward_the_neighbour_is_kept),
      cmocka_unit_test(what_one_end_has_by_itself_is_left),
      cmocka_unit_test(neighbours_of_neighbours_need_a_pass_more),
      cmocka_unit_test(dear_values_are_kept_in_planes),
      cmocka_unit_test(planes_are_few),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
