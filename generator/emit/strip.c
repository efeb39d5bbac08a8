#include "generator/emit/strip.h"

#include <stdlib.h>
#include <string.h>

#include "generator/emit/loop_cutting.h"
#include "generator/emit/strip_arrays.h"
#include "generator/emit/strip_cut.h"

/* What was decided, in a line for readers of the C text and of --dump=passes. */
static void describe(const stages *s, c_text *out) {
  if (s->count == 1) {
    c_text_add(out, "one loop, a chain of %d cycles", s->cost[0].chain);
    return;
  }
  c_text_add(out, "%d loops over parts of %d bonds, chains of", stages_last(s) + 1, STAGES_PART);
  for (int k = 0; k <= stages_last(s); k++)
    c_text_add(out, "%s%d", k ? ", " : " ", s->cost[k].chain);
  c_text_add(out, " cycles instead of %d, %d buffers between", s->whole_chain, s->buffers);
  if (s->conditions) c_text_add(out, ", %d choices expected", s->conditions);
  if (s->changes) c_text_add(out, ", one more loop where damage changed");
}

/* `present` has 32 bits in a loop that is not cut, on purpose: gcc then takes twice as many bonds
   at a time, as pairs of vectors, and the divisions of one hide those of the other (5 to 40 %
   faster on all laws tried). */
static void write_head(emitter *e, const char *name, bool cut) {
  kernel_function_begin(&e->parts, e->out, "PL_PASS", name, spell(e, SAY_OVER_STRIP));
  say(e, SAY_STRIP_HEAD, cut ? "64" : "32");
  strip_declare_protection(e);
  if (!e->root_count) say(e, SAY_NO_RESULTS);
  expression_declare(e);
  strip_declare_outputs(e);
}

static void write_one_loop(emitter *e) {
  say(e, SAY_OVER_BONDS);
  expression_lines(e);
  if (e->root_count) say(e, SAY_PRESENT_OF_STRIP);
  for (int k = 0; k < e->root_count; k++)
    strip_store(e, &e->roots[k]);
  say(e, SAY_END, "  ");
}

static void write_cut(emitter *e, const stages *s, const char *name) {
  unsigned char *whole = e->needed, *usual = strip_cut_usually_needed(e, s);
  if (s->conditions) strip_cut_declare(e, name);
  e->needed = usual;
  write_head(e, name, true);
  e->needed = whole;
  strip_cut_loops(e, s, name);
  kernel_function_end(&e->parts, e->out);
  if (s->conditions) strip_cut_unexpected(e, s, name);
  free(usual);
}

void strip_pass(emitter *e, const segment *a, const char *name) {
  c_text loops = {0};
  expression_open_segment(e, &scope_of_strips, a);
  stages *s = loop_cutting_plan(e, e->plan->cutting);
  describe(s, &loops);
  say(e, SAY_REMARK, loops.text);
  if (s->count > 1) {
    write_cut(e, s, name);
  } else {
    write_head(e, name, false);
    write_one_loop(e);
    kernel_function_end(&e->parts, e->out);
  }
  free(loops.text);
  stages_free(s);
  expression_close(e);
}

/* --- what --dump=passes says ------------------------------------------------------------------ */

static void describe_stages(const stages *s, FILE *out) {
  for (int k = 0; k < s->count; k++) {
    const stage_cost *c = &s->cost[k];
    fprintf(
        out,
        "      loop %d: %d operations, %d divisions, %d loads, %d stores, a chain of %d cycles; "
        "%.0f cycles for eight bonds%s\n",
        k + 1, c->operations, c->divisions, c->loads, c->stores, c->chain, c->cycles,
        k > stages_last(s) ? "; only where damage changed" : "");
  }
}

void strip_describe_loops(const kernel_plan *p, const segment *a, FILE *out) {
  emitter e;
  c_text text = {0};
  emitter_begin(&e, p, &text);
  expression_open_segment(&e, &scope_of_strips, a);
  stages *s = loop_cutting_plan(&e, p->cutting);
  describe(s, &text);
  fprintf(out, "    %-12s %s\n", "loops", text.text);
  describe_stages(s, out);
  stages_free(s);
  expression_close(&e);
  emitter_end(&e);
  free(text.text);
}
