#include "generator/plan/plan.h"

#include <stdlib.h>

#include "dsl/base/arena.h"
#include "dsl/semantics/law_variant.h"
#include "generator/lower/lower_inputs.h"
#include "generator/plan/plan_family.h"
#include "generator/plan/plan_points.h"
#include "generator/plan/plan_roots.h"
#include "generator/plan/plan_strips.h"
#include "generator/plan/program_facts.h"
#include "generator/plan/seldom.h"

kernel_plan *plan_begin(const law *l, kernel_form form) {
  kernel_plan *plan = must_calloc(1, sizeof *plan);
  plan->law = l;
  plan->form = form;
  plan->graph = ir_new();
  ir_set_sources(plan->graph, l->sources);
  plan->memory = arena_new();
  return plan;
}

static kernel_plan *finish(kernel_plan *plan, bool good, diagnostics *d) {
  if (!good || !plan_bounds(plan, d)) {
    plan_free(plan);
    return NULL;
  }
  plan->large = plan_is_large(plan);
  if (!plan->large) plan_seldom(plan);
  plan_hoist(plan);
  plan_count_cost(plan);
  return plan;
}

kernel_plan *plan_kernel(const law *l, diagnostics *d) {
  return plan_kernel_varying(l, &(law_variation){.varying_count = 0}, d);
}

static void keep_variation(kernel_plan *plan, const law_variation *v) {
  int *varying = arena_alloc(plan->memory, ((size_t)v->varying_count + 1) * sizeof *varying);
  for (int k = 0; k < v->varying_count; k++)
    varying[k] = v->varying[k];
  plan->variation = *v;
  plan->variation.varying = varying;
}

static kernel_plan *plan_families(const law *l, const law_variation *v, kernel_form form,
                                  diagnostics *d) {
  kernel_plan *plan = plan_begin(l, form);
  keep_variation(plan, v);
  return finish(plan, plan_programs(plan, d), d);
}

/* Fields on bonds are worth adding to both ends with few neighbours already: such loops write them
   only where they change. So are end rotations, which are dear. */
static bool is_on_bonds(const law *l) {
  bool on_bonds = law_kind_turns(l->tree->law);
  for (int k = 0; k < l->fields.count; k++)
    on_bonds = on_bonds || l->fields.items[k]->place == ON_BOND;
  return on_bonds;
}

/* Some pass goes over the neighbours for the particle's own sake: bond by bond it would have as
   many short loops as there are neighbours. */
static bool has_own_sums(const kernel_plan *plan) {
  const kernel_program *step = &plan->programs[PROGRAM_STEP];
  for (int p = 0; p < step->pass_count; p++)
    for (int k = 0; k < step->passes[p].segment_count; k++)
      if (step->passes[p].segments[k].kind == OVER_NEIGHBOURS) return true;
  return false;
}

kernel_plan *plan_kernel_of_families(const law *l, const law_variation *v, diagnostics *d) {
  enum { WRITTEN_OUT_FASTER = 12, MOST_WRITTEN_OUT = 18 };
  const bool few = l->neighbours <= MOST_WRITTEN_OUT, on_bonds = is_on_bonds(l);
  if (l->irregular || l->neighbours == 0) return plan_families(l, v, FORM_LOOPS, d);
  if (on_bonds || l->neighbours > WRITTEN_OUT_FASTER) {
    kernel_plan *plan = plan_families(l, v, FORM_PAIRS, d);
    const bool adds = plan && program_sum_count(&plan->programs[PROGRAM_STEP]) > 0;
    if (!plan || (adds && (on_bonds || !few || !has_own_sums(plan)))) return plan;
    plan_free(plan);
  }
  if (few) {
    kernel_plan *plan = plan_families(l, v, FORM_UNROLLED, d);
    if (!plan || !plan->large) return plan;
    plan_free(plan);
  }
  return plan_families(l, v, FORM_LOOPS, d);
}

static kernel_plan *plan_kernel_of_points(const law *l, const law_variation *v, diagnostics *d) {
  kernel_plan *plan = plan_begin(l, FORM_POINTS);
  keep_variation(plan, v);
  plan->dimensions = plan->dof = lower_dimensions(l);
  return finish(plan, plan_points(plan, d), d);
}

static kernel_plan *plan_kernel_of_tips(const law *l, diagnostics *d) {
  kernel_plan *plan = plan_begin(l, FORM_TIPS);
  plan->dimensions = plan->dof = 2;
  return finish(plan, plan_tips(plan, d), d);
}

kernel_plan *plan_kernel_varying(const law *l, const law_variation *v, diagnostics *d) {
  if (l->tree->law == LAW_STATE) return plan_kernel_of_families(l, v, d);
  if (l->tree->law == LAW_CONTINUUM) return plan_kernel_of_points(l, v, d);
  if (l->tree->law == LAW_CRACK) return plan_kernel_of_tips(l, d);
  bool micropolar = law_kind_turns(l->tree->law);
  bool twists = micropolar && l->setting == SETTING_SPACE;
  kernel_plan *plan = plan_begin(twists ? law_twisting(l) : l, FORM_STRIPS);
  keep_variation(plan, v);
  plan->dimensions = 2;
  plan->dof = (micropolar ? 3 : 2) + twists;
  plan->force_planes = (micropolar ? 4 : 2) + twists;
  return finish(plan, plan_strips(plan, d), d);
}

void plan_free(kernel_plan *p) {
  if (!p) return;
  ir_free(p->graph);
  arena_free(p->memory);
  free(p);
}
