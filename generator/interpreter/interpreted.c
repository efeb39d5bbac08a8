/* Several threads may call a kernel: each call borrows a worker, made in advance, so that a step
   allocates nothing. */
#include "generator/interpreter/interpreted.h"

#include <sched.h>
#include <stdatomic.h>
#include <stdlib.h>
#include <string.h>

#include "dsl/base/arena.h"
#include "generator/interpreter/interpreted_family.h"
#include "generator/interpreter/interpreted_strip.h"
#include "generator/lower/law_inputs.h"
#include "generator/plan/program_facts.h"
#include "runtime/base/processors.h"

enum { MOST_WORKERS = 64 };

/* One caller's. */
typedef struct worker {
  atomic_flag busy;
  runner *run;
} worker;

typedef struct interpreted {
  pl_law law; /* first: what callers hold */
  const kernel_plan *plan;
  arena *memory;
  int worker_count;
  worker *workers;
} interpreted;

/* --- workers ---------------------------------------------------------------------------------- */

static worker *borrow(const pl_law *kernel) {
  const interpreted *p = kernel->context;
  for (;;) {
    for (int k = 0; k < p->worker_count; k++)
      if (!atomic_flag_test_and_set_explicit(&p->workers[k].busy, memory_order_acquire))
        return &p->workers[k];
    sched_yield(); /* more callers than workers: one will be back in a moment */
  }
}

static void give_back(worker *w) {
  atomic_flag_clear_explicit(&w->busy, memory_order_release);
}

/* --- functions of a kernel -------------------------------------------------------------------- */

#define X(task, member)                                                                            \
  static void run_##member(const pl_law *kernel, const double *uniforms, const pl_strip *s) {      \
    worker *w = borrow(kernel);                                                                    \
    interpreted_strip(w->run, task, uniforms, s);                                                  \
    give_back(w);                                                                                  \
  }
STRIP_PROGRAMS(X)
#undef X

#define X(task, member)                                                                            \
  static void run_##member(const pl_law *kernel, const double *uniforms, const pl_points *s) {     \
    worker *w = borrow(kernel);                                                                    \
    interpreted_points(w->run, task, uniforms, s);                                                 \
    give_back(w);                                                                                  \
  }
POINT_PROGRAMS(X)
#undef X

#define X(task, member)                                                                            \
  static void run_##member(const pl_law *kernel, const double *uniforms, const pl_tips *s) {       \
    worker *w = borrow(kernel);                                                                    \
    interpreted_tips(w->run, task, uniforms, s);                                                   \
    give_back(w);                                                                                  \
  }
TIP_PROGRAMS(X)
#undef X

static void run_states(const pl_law *kernel, const double *uniforms, const pl_states *s) {
  worker *w = borrow(kernel);
  interpreted_states(w->run, PROGRAM_STATES, uniforms, s);
  give_back(w);
}

static void run_tangent(const pl_law *kernel, const double *uniforms, const pl_states *s) {
  worker *w = borrow(kernel);
  interpreted_states(w->run, PROGRAM_TANGENT, uniforms, s);
  give_back(w);
}

static void run_prepare(const pl_law *kernel, const double *parameters, const pl_bond_class *bonds,
                        double *uniforms) {
  worker *w = borrow(kernel);
  interpreted_prepare(w->run, parameters, bonds, uniforms);
  give_back(w);
}

static void run_bounds(const pl_law *kernel, const double *parameters, double *lower, double *upper,
                       unsigned char *low_open, unsigned char *high_open) {
  const interpreted *p = kernel->context;
  const symbol_list *list = &p->plan->law->parameters;
  worker *w = borrow(kernel);
  for (int k = 0; k < list->count; k++) {
    low_open[k] = list->items[k]->declared->in.lower_open;
    high_open[k] = list->items[k]->declared->in.upper_open;
  }
  interpreted_bounds(w->run, PROGRAM_BOUNDS, parameters, lower, upper);
  give_back(w);
}

static void run_defaults(const pl_law *kernel, const double *parameters, double *values) {
  worker *w = borrow(kernel);
  interpreted_defaults(w->run, parameters, values);
  give_back(w);
}

static void run_size_bounds(const pl_law *kernel, const double *parameters, double *lower,
                            double *upper, unsigned char *low_open, unsigned char *high_open) {
  const interpreted *p = kernel->context;
  worker *w = borrow(kernel);
  *low_open = p->plan->law->sized->in.lower_open;
  *high_open = p->plan->law->sized->in.upper_open;
  interpreted_bounds(w->run, PROGRAM_SIZE_BOUNDS, parameters, lower, upper);
  give_back(w);
}

static void run_family(const pl_law *kernel, const double *uniforms, const pl_family *family,
                       program_task task, int number) {
  worker *w = borrow(kernel);
  interpreted_family(w->run, task, number, uniforms, family);
  give_back(w);
}

/* One function for each pass that a program may have. */
#define PASS_NUMBERS(X) X(0) X(1) X(2) X(3) X(4) X(5) X(6) X(7)
#define RUN(name, task, n)                                                                         \
  static void run_##name##_##n(const pl_law *k, const double *u, const pl_family *f) {             \
    run_family(k, u, f, task, n);                                                                  \
  }
#define X(n)                                                                                       \
  RUN(step, PROGRAM_STEP, n)                                                                       \
  RUN(losses, PROGRAM_LEDGER, n)                                                                   \
  RUN(observe, PROGRAM_OBSERVE, n) RUN(force_state, PROGRAM_FORCE_STATE, n)
PASS_NUMBERS(X)
#undef X
static const pl_family_function passes_of[PROGRAM_COUNT][PLAN_MOST_PASSES] = {
#define X(n)                                                                                       \
  [PROGRAM_STEP][n] = run_step_##n, [PROGRAM_LEDGER][n] = run_losses_##n,                          \
  [PROGRAM_OBSERVE][n] = run_observe_##n, [PROGRAM_FORCE_STATE][n] = run_force_state_##n,
    PASS_NUMBERS(X)
#undef X
};

/* --- the descriptor --------------------------------------------------------------------------- */

static const char *unit_text(arena *memory, const symbol *s) {
  char text[64];
  dim_unit(s->dim, text, sizeof text);
  return arena_text(memory, text, strlen(text));
}

static const pl_parameter *describe_parameters(arena *memory, const symbol_list *list) {
  pl_parameter *all = arena_alloc(memory, ((size_t)list->count + 1) * sizeof *all);
  for (int k = 0; k < list->count; k++) {
    const symbol *s = list->items[k];
    all[k] = (pl_parameter){s->name, unit_text(memory, s), s->doc ? s->doc : "", s->initial,
                            s->has_default};
  }
  return all;
}

static const pl_input *describe_state_inputs(arena *memory) {
  pl_input *all = arena_alloc(memory, PL_STATE_INPUTS * sizeof *all);
  law_state_inputs(all);
  return all;
}

static int field_kind(const symbol *s) {
  if (s->kind == SYMBOL_DAMAGE) return PL_FIELD_DAMAGE;
  return s->kind == SYMBOL_STATE ? PL_FIELD_STATE : PL_FIELD_OUTPUT;
}

static int field_place(const symbol *s) {
  if (s->place == ON_POINT) return PL_ON_POINT;
  if (s->place == ON_TIP) return PL_ON_TIP;
  if (s->place <= ON_PARTICLE) return PL_ON_PARTICLE;
  return s->place == ON_BOND ? PL_ON_BOND : PL_ON_NEIGHBOUR;
}

static const pl_field *describe_fields(arena *memory, const symbol_list *list) {
  pl_field *all = arena_alloc(memory, ((size_t)list->count + 1) * sizeof *all);
  for (int k = 0; k < list->count; k++) {
    const symbol *s = list->items[k];
    all[k] = (pl_field){s->name,    unit_text(memory, s), s->doc ? s->doc : "",
                        s->initial, field_kind(s),        field_place(s)};
  }
  return all;
}

static pl_program program_facts(arena *memory, const ir *g, const kernel_program *p,
                                const pl_family_function *passes) {
  uint64_t *shared = arena_alloc(memory, ((size_t)p->pass_count + 1) * sizeof *shared);
  for (int k = 0; k < p->pass_count; k++)
    shared[k] = program_shared_by(&p->passes[k]);
  return (pl_program){.pass_count = p->pass_count,
                      .pass = passes,
                      .at_hand = program_at_hand(g, p),
                      .upward = program_upward(g, p),
                      .spared = program_reaches_spared(g, p),
                      .shared = shared};
}

/* The passes of a step, then those of its losses. */
static pl_program ledger_facts(arena *memory, const kernel_plan *plan) {
  const kernel_program *step = &plan->programs[PROGRAM_STEP],
                       ledger =
                           program_joined(memory, "ledger", step, &plan->programs[PROGRAM_LEDGER]);
  pl_family_function *passes =
      arena_alloc(memory, ((size_t)ledger.pass_count + 1) * sizeof *passes);
  for (int k = 0; k < ledger.pass_count; k++)
    passes[k] = k < step->pass_count ? passes_of[PROGRAM_STEP][k]
                                     : passes_of[PROGRAM_LEDGER][k - step->pass_count];
  return program_facts(memory, plan->graph, &ledger, passes);
}

static void describe_strips(interpreted *p) {
#define X(task, member) p->law.member = run_##member;
  STRIP_PROGRAMS(X)
#undef X
  p->law.state_input_count = PL_STATE_INPUTS;
  p->law.state_inputs = describe_state_inputs(p->memory);
  p->law.states = run_states;
  p->law.tangent = run_tangent;
}

static void describe_points(interpreted *p) {
#define X(task, member) p->law.member = run_##member;
  POINT_PROGRAMS(X)
#undef X
  p->law.linear = p->plan->linear;
  p->law.reads_size = p->plan->reads_size;
  p->law.affine = p->plan->affine;
  if (!p->plan->law->sized) return;
  p->law.size_bounds = run_size_bounds;
  p->law.size_reason = p->plan->law->sized->text;
}

static void describe_families(interpreted *p) {
  const kernel_plan *plan = p->plan;
  const law *l = plan->law;
  const kernel_program *programs = plan->programs;
  p->law.link_count = plan->links.of_particles;
  p->law.bond_link_count = plan->links.of_bonds;
  p->law.sum_count = program_sum_count(&programs[PROGRAM_STEP]);
  p->law.reads_shape = plan->reads_shape;
  p->law.reads_share = plan->reads_share;
  p->law.reads_mass = plan->reads_mass;
  p->law.reads_own_size = plan->variation.sizes;
  p->law.varying_place = l->tree->law == LAW_STATE ? PL_ON_PARTICLE : PL_ON_BOND;
  p->law.pairwise = l->tree->law != LAW_STATE;
  p->law.topology = l->irregular ? PL_LIST : PL_ROWS;
  p->law.step =
      program_facts(p->memory, plan->graph, &programs[PROGRAM_STEP], passes_of[PROGRAM_STEP]);
  p->law.observe =
      program_facts(p->memory, plan->graph, &programs[PROGRAM_OBSERVE], passes_of[PROGRAM_OBSERVE]);
  if (programs[PROGRAM_LEDGER].pass_count) p->law.ledger = ledger_facts(p->memory, plan);
  if (programs[PROGRAM_FORCE_STATE].pass_count)
    p->law.force_state = program_facts(p->memory, plan->graph, &programs[PROGRAM_FORCE_STATE],
                                       passes_of[PROGRAM_FORCE_STATE]);
}

static void describe_given(interpreted *p) {
  const symbol_list *list = &p->plan->law->parameters;
  int32_t *given = arena_alloc(p->memory, ((size_t)list->count + 1) * sizeof *given);
  for (int k = 0; k < list->count; k++)
    if (symbol_is_field(list->items[k])) given[p->law.given_count++] = k;
  p->law.given = given;
}

static void describe(interpreted *p) {
  const kernel_plan *plan = p->plan;
  const law *l = plan->law;
  p->law = (pl_law){
      .abi = PL_KERNEL_ABI,
      .size = sizeof(pl_law),
      .kind = plan_kind(plan),
      .dimensions = plan->dimensions,
      .dof = plan->dof,
      .force_planes = plan->force_planes,
      .name = l->tree->name,
      .key = "",
      .failed_field = l->failed ? l->failed->index : -1,
      .parameter_count = l->parameters.count,
      .parameters = describe_parameters(p->memory, &l->parameters),
      .density = l->rho ? l->rho->index : -1,
      .varying_count = plan->variation.varying_count,
      .varying = plan->variation.varying,
      .field_count = l->fields.count,
      .fields = describe_fields(p->memory, &l->fields),
      .output_count = l->outputs.count,
      .outputs = describe_fields(p->memory, &l->outputs),
      .stores = plan->stores,
      .reads_rates = plan->reads_rates,
      .uniform_count = plan->uniform_count,
      .flops_per_bond = plan->flops_per_bond,
      .divisions_per_bond = plan->divisions_per_bond,
      .prepare = run_prepare,
      .bounds = run_bounds,
      .defaults = plan->programs[PROGRAM_DEFAULTS].pass_count ? run_defaults : NULL,
      .context = p,
  };
  describe_given(p);
  p->law.works_at_rest = plan->works_at_rest;
  if (plan->form == FORM_STRIPS)
    describe_strips(p);
  else if (plan->form == FORM_POINTS)
    describe_points(p);
  else if (plan->form == FORM_TIPS)
    p->law.tip_look = run_tip_look;
  else
    describe_families(p);
}

/* --- making and freeing ----------------------------------------------------------------------- */

/* Inputs that stand for the uniforms, numbered after the parameters. */
static ir_node *make_inputs(const interpreted *p) {
  const kernel_plan *plan = p->plan;
  ir_node *inputs = arena_alloc(p->memory, ((size_t)plan->uniform_count + 1) * sizeof *inputs);
  for (int k = 0; k < plan->uniform_count; k++) {
    const char *name = ir_name(plan->graph, plan->uniforms[k]);
    inputs[k] = ir_input(plan->graph, IR_FROM_PARAMETER, plan->law->parameters.count + k,
                         name ? name : "uniform", ON_BODY);
  }
  return inputs;
}

/* One for each processor: more callers than that would only wait for processors. */
static int count_workers(void) {
  const int processors = usable_processors();
  return processors < MOST_WORKERS ? processors : MOST_WORKERS;
}

pl_law *plan_interpreted(const kernel_plan *plan) {
  interpreted *p = must_calloc(1, sizeof *p);
  p->plan = plan;
  p->memory = arena_new();
  describe(p);
  const ir_node *inputs = make_inputs(p);
  p->worker_count = count_workers();
  p->workers = must_calloc((size_t)p->worker_count, sizeof *p->workers);
  for (int k = 0; k < p->worker_count; k++) {
    atomic_flag_clear(&p->workers[k].busy);
    p->workers[k].run = runner_new(plan, inputs);
  }
  return &p->law;
}

void plan_interpreted_free(pl_law *kernel) {
  if (!kernel) return;
  interpreted *p = (interpreted *)kernel;
  for (int k = 0; k < p->worker_count; k++)
    runner_free(p->workers[k].run);
  free(p->workers);
  arena_free(p->memory);
  free(p);
}

void plan_interpreted_watch(const pl_law *kernel, interpreter_look *look, void *context) {
  const interpreted *p = kernel->context;
  for (int k = 0; k < p->worker_count; k++)
    runner_watch(p->workers[k].run, look, context);
}

const kernel_plan *plan_of_interpreted(const pl_law *kernel) {
  const interpreted *p = kernel->context;
  return p->plan;
}
