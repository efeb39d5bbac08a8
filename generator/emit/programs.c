#include "generator/emit/programs.h"

#include <inttypes.h>

#include "generator/emit/family_loops.h"
#include "generator/emit/family_pairs.h"
#include "generator/emit/family_unrolled.h"
#include "generator/plan/program_facts.h"

/* Particles at a time. Long chunks read the planes of large families in long pieces; what a pass
   keeps between its segments should stay in the first cache. */
static int chunk_of(const family_pass *p) {
  enum { LONGEST = 512, KEPT = 16384 }; /* B */
  int chunk = LONGEST;
  if (p->plane_count > 0 || program_is_paired(p)) return FAMILY_CHUNK;
  while (chunk > FAMILY_CHUNK && p->slot_count * chunk * (int)sizeof(double) > KEPT)
    chunk /= 2;
  return chunk;
}

/* Particles and neighbours by loops: chunk by chunk, segment after segment. */
static void write_loops(emitter *e, const family_pass *p) {
  static void (*const forms[])(emitter *,
                               const segment *) = {[OVER_PARTICLES] = family_loops_particles,
                                                   [OVER_NEIGHBOURS] = family_loops_neighbours,
                                                   [OVER_BONDS] = family_loops_neighbours,
                                                   [OVER_PAIRS] = family_pairs};
  const bool rows = e->plan->form == FAMILY_WRITTEN_OUT;
  say(e, SAY_CHUNK, numeral(e, chunk_of(p)));
  if (e->plan->sum_count > 0 && !program_is_paired(p)) say(e, SAY_RETURN_IF_AHEAD);
  for (int k = 0; k < p->slot_count; k++)
    say(e, SAY_KEEP_SLOT, numeral(e, k));
  for (int k = 0; k < p->plane_count; k++)
    say(e, SAY_KEEP_PLANE, numeral(e, k));
  say(e, rows ? SAY_OVER_ROWS : SAY_ONE_RUN);
  say(e, SAY_OVER_CHUNKS);
  for (int k = 0; k < p->segment_count; k++)
    forms[p->segments[k].kind](e, &p->segments[k]);
  say(e, SAY_END, "  ");
  if (rows) say(e, SAY_END, "  ");
}

static const char *pass_name(const emitter *e, const family_program *q, int number) {
  return spell(e, SAY_PASS_NAME, q->name, numeral(e, number));
}

static void write_pass(emitter *e, const family_program *q, int number) {
  const bool unrolled = q != &e->plan->observe && e->plan->form == FAMILY_WRITTEN_OUT;
  if (unrolled) say(e, SAY_UNROLLED_REMARK, numeral(e, e->plan->law->neighbours));
  kernel_function_begin(&e->parts, e->out, "PL_PASS", pass_name(e, q, number),
                        spell(e, SAY_OVER_FAMILY));
  say(e, SAY_FAMILY_HEAD);
  (unrolled ? family_unrolled_pass : write_loops)(e, &q->passes[number]);
  kernel_function_end(&e->parts, e->out);
}

static void write_program(emitter *e, const family_program *q) {
  const char *passes = NULL, *shared = NULL;
  e->program = q;
  for (int k = 0; k < q->pass_count; k++) {
    write_pass(e, q, k);
    passes = words_join(e->memory, passes, ", ", pass_name(e, q, k));
    shared = words_join(
        e->memory, shared, ", ",
        arena_printf(e->memory, "UINT64_C(%" PRIu64 ")", program_shared_by(&q->passes[k])));
  }
  say(e, SAY_PROGRAM_TABLES, q->name, passes, shared);
}

void programs_functions(emitter *e) {
  say(e, SAY_UNIFORM_COUNT, numeral(e, e->plan->uniform_count));
  family_pairs_functions(e);
  write_program(e, &e->plan->step);
  if (e->plan->ledger.pass_count) write_program(e, &e->plan->ledger);
  write_program(e, &e->plan->observe);
}
