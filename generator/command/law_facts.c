#include "generator/command/law_facts.h"

#include <stdlib.h>

#include "dsl/base/arena.h"

const char *law_kind_text(const law *l) {
  static const char *const kinds[] = {"central bond", "micropolar bond", "state"};
  return kinds[l->tree->law];
}

bool law_facts_of_families(const law_facts *f) {
  return f->law->kind == PL_STATE;
}

int law_facts_passes(const kernel_plan *p) {
  return p->kind == PL_STATE ? p->step.pass_count : 1;
}

/* --- bytes ------------------------------------------------------------------------------------ */

/* Arrays that a segment over neighbours or bonds reads and writes, without what a pass keeps for
   itself. */
static long arrays_of_segment(const ir *g, const segment *a) {
  unsigned char *needed = must_calloc((size_t)ir_count(g) + 1, 1);
  long count = 1; /* the bits of the bonds */
  for (int k = 0; k < a->root_count; k++) {
    ir_mark(g, &a->roots[k].node, 1, needed);
    count += a->roots[k].target == TO_NEIGHBOUR_FIELD || a->roots[k].target == TO_SHARED;
  }
  for (ir_node n = 0; n < ir_count(g); n++) {
    if (!needed[n] || ir_operation(g, n) != IR_INPUT || ir_is_uniform(g, n)) continue;
    const ir_source from = ir_input_source(g, n);
    count += from != IR_FROM_SLOT && from != IR_FROM_PLANE;
  }
  free(needed);
  return count;
}

static long bytes_of_families(const kernel_plan *p) {
  long count = 0;
  for (int k = 0; k < p->step.pass_count; k++)
    for (int s = 0; s < p->step.passes[k].segment_count; s++)
      if (p->step.passes[k].segments[s].kind != OVER_PARTICLES)
        count += arrays_of_segment(p->graph, &p->step.passes[k].segments[s]) *
                 (p->step.passes[k].segments[s].kind == OVER_BONDS ? 1 : 2);
  return 8 * count / 2; /* of the two ends of a bond, one */
}

long law_facts_bytes(const kernel_plan *p) {
  if (p->kind == PL_STATE) return bytes_of_families(p);
  const pass *a = &p->passes[PASS_ROWS];
  unsigned char *needed = must_calloc((size_t)ir_count(p->graph) + 1, 1);
  long count = a->root_count + 1; /* the flags */
  for (int k = 0; k < a->root_count; k++) {
    ir_mark(p->graph, &a->roots[k].node, 1, needed);
    count += a->roots[k].target == TO_FIELD; /* read, too, to keep it where a bond is absent */
  }
  for (ir_node n = 0; n < ir_count(p->graph); n++)
    count += needed[n] && ir_operation(p->graph, n) == IR_INPUT && !ir_is_uniform(p->graph, n) &&
             ir_input_source(p->graph, n) == IR_FROM_ENDS;
  free(needed);
  return 8 * count;
}
