#include "generator/emit/programs.h"

#include <inttypes.h>

#include "generator/emit/family_arrays.h"
#include "generator/emit/family_lists.h"
#include "generator/emit/family_loops.h"
#include "generator/emit/family_pairs.h"
#include "generator/emit/family_unrolled.h"
#include "generator/emit/law_functions.h"
#include "generator/emit/point_loops.h"
#include "generator/emit/strip.h"
#include "generator/plan/program_facts.h"

/* Particles at a time. Long chunks read the planes of large families in long pieces; what a pass
   keeps between its segments should stay in the first cache. Short ones on lists leave out more. */
static int chunk_of(const program_pass *p, bool list) {
  enum { LONGEST = 512, KEPT = 16384 }; /* B */
  int chunk = LONGEST;
  if (p->plane_count > 0 || program_is_paired(p) || list) return FAMILY_CHUNK;
  while (chunk > FAMILY_CHUNK && p->slot_count * chunk * (int)sizeof(double) > KEPT)
    chunk /= 2;
  return chunk;
}

/* Fields that have marks, or have none. */
static int fields_with(const emitter *e, bool marks) {
  int count = 0;
  for (int f = 0; f < e->plan->law->fields.count; f++)
    count += program_pairs_field(&e->plan->programs[PROGRAM_STEP], f) == marks;
  return count;
}

/* What of a chunk's fields has changed in the step; by their marks where they have such. */
static void write_changes(emitter *e) {
  const kernel_plan *p = e->plan;
  if (!p->loses_by_own_fields) return;
  if (fields_with(e, true)) say(e, SAY_CHANGED_MARKS);
  if (fields_with(e, false)) say(e, SAY_CHANGED_PLANE);
  say(e, SAY_CHANGES_BEGIN);
  for (int f = 0; f < p->law->fields.count; f++) {
    const bool on_particle = p->law->fields.items[f]->place <= ON_PARTICLE;
    if (program_pairs_field(&p->programs[PROGRAM_STEP], f))
      say(e, SAY_CHANGES_OF_MARKS, numeral(e, f));
    else
      say(e, SAY_CHANGES_OF_PLANES, numeral(e, f), on_particle ? "1" : "family->neighbours");
  }
  say(e, SAY_CHANGES_END);
}

static bool loops_over_neighbours(const program_pass *p) {
  for (int k = 0; k < p->segment_count; k++)
    if (p->segments[k].kind > OVER_PARTICLES) return true;
  return false;
}

/* Particles and neighbours by loops: chunk by chunk, segment after segment. */
static void write_loops(emitter *e, const program_pass *p) {
  const bool rows = e->plan->form == FORM_UNROLLED, list = family_is_list(e);
  void (*const neighbours)(emitter *, const segment *) =
      list ? family_lists_neighbours : family_loops_neighbours;
  void (*const forms[])(emitter *, const segment *) = {[OVER_PARTICLES] = family_loops_particles,
                                                       [OVER_NEIGHBOURS] = neighbours,
                                                       [OVER_BONDS] = neighbours,
                                                       [OVER_PAIRS] = family_pairs};
  say(e, SAY_CHUNK, numeral(e, chunk_of(p, list)));
  if (program_sum_count(&e->plan->programs[PROGRAM_STEP]) > 0 && !program_is_paired(p))
    say(e, SAY_RETURN_IF_AHEAD);
  for (int k = 0; k < p->slot_count; k++)
    say(e, SAY_KEEP_SLOT, numeral(e, k));
  for (int k = 0; k < p->plane_count; k++)
    say(e, SAY_KEEP_PLANE, numeral(e, k));
  say(e, rows ? SAY_OVER_ROWS : SAY_ONE_RUN);
  say(e, SAY_OVER_CHUNKS);
  if (list && loops_over_neighbours(p)) say(e, SAY_SOME_BONDS);
  const bool seldom = p == e->plan->programs[PROGRAM_LEDGER].passes && e->plan->loses_by_own_fields;
  if (seldom) say(e, SAY_IF_FIELDS_CHANGED);
  if (list) family_lists_begin(e, p);
  for (int k = 0; k < p->segment_count; k++)
    forms[p->segments[k].kind](e, &p->segments[k]);
  if (list) family_lists_end(e);
  if (seldom) say(e, SAY_END, "    ");
  say(e, SAY_END, "  ");
  if (rows) say(e, SAY_END, "  ");
}

static const char *pass_name(const emitter *e, const kernel_program *q, int number) {
  return spell(e, SAY_PASS_NAME, q->name, numeral(e, number));
}

static void write_pass(emitter *e, const kernel_program *q, int number) {
  const bool unrolled = q == &e->plan->programs[PROGRAM_STEP] && e->plan->form == FORM_UNROLLED;
  if (unrolled) say(e, SAY_UNROLLED_REMARK, numeral(e, e->plan->law->neighbours));
  kernel_function_begin(&e->parts, e->out, "PL_PASS", pass_name(e, q, number),
                        spell(e, SAY_OVER_FAMILY));
  say(e, SAY_FAMILY_HEAD);
  (unrolled ? family_unrolled_pass : write_loops)(e, &q->passes[number]);
  kernel_function_end(&e->parts, e->out);
}

typedef struct program_tables {
  const char *passes, *shared;
} program_tables;

static void list_passes(emitter *e, const kernel_program *q, program_tables *t) {
  for (int k = 0; k < q->pass_count; k++) {
    t->passes = words_join(e->memory, t->passes, ", ", pass_name(e, q, k));
    t->shared = words_join(
        e->memory, t->shared, ", ",
        arena_printf(e->memory, "UINT64_C(%" PRIu64 ")", program_shared_by(&q->passes[k])));
  }
}

/* `after` NULL: none. */
static void write_program(emitter *e, const char *name, const kernel_program *q,
                          const kernel_program *after) {
  program_tables t = {NULL, NULL};
  if (after) list_passes(e, after, &t);
  for (int k = 0; k < q->pass_count; k++)
    write_pass(e, q, k);
  list_passes(e, q, &t);
  say(e, SAY_PROGRAM_TABLES, name, t.passes, t.shared);
}

static void write_strips(emitter *e) {
  const kernel_program *p = e->plan->programs;
  for (int task = PROGRAM_STEP; task <= PROGRAM_OBSERVE; task++)
    strip_pass(e, p[task].passes[0].segments, p[task].name);
  law_functions_of_states(e);
}

void programs_functions(emitter *e) {
  if (e->plan->form == FORM_STRIPS) {
    write_strips(e);
    return;
  }
  if (e->plan->form == FORM_POINTS || e->plan->form == FORM_TIPS) {
    point_loops(e);
    return;
  }
  say(e, SAY_UNIFORM_COUNT, numeral(e, e->plan->uniform_count));
  family_pairs_functions(e);
  family_lists_functions(e);
  const kernel_program *step = &e->plan->programs[PROGRAM_STEP],
                       *losses = &e->plan->programs[PROGRAM_LEDGER],
                       *observe = &e->plan->programs[PROGRAM_OBSERVE],
                       *alone = &e->plan->programs[PROGRAM_FORCE_STATE];
  write_program(e, step->name, step, NULL);
  if (losses->pass_count) {
    write_changes(e);
    write_program(e, "ledger", losses, step);
  }
  write_program(e, observe->name, observe, NULL);
  if (alone->pass_count) write_program(e, alone->name, alone, NULL);
}
