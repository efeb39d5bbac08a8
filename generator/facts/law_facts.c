#include "generator/facts/law_facts.h"

#include <stdlib.h>

#include "dsl/base/arena.h"

const char *law_kind_text(const law *l) {
  return law_kind_name(l->tree->law);
}

bool law_facts_has_implied(const law_facts *f) {
  const law_kind kind = f->model.law->tree->law;
  return !f->missing && kind != LAW_SLIP_BOND && kind != LAW_CONTINUUM && kind != LAW_CRACK;
}

bool law_facts_of_families(const law_facts *f) {
  return f->law->kind == PL_STATE;
}

int law_facts_passes(const kernel_plan *p) {
  return p->programs[PROGRAM_STEP].pass_count;
}

/* --- bytes ------------------------------------------------------------------------------------ */

/* Arrays that a segment over neighbours or bonds reads and writes, without what a pass keeps for
   itself. Of a field of a strip the old values are read in any case, to stay where a bond is
   absent. */
static long arrays_of_segment(const kernel_plan *p, const segment *a) {
  const ir *g = p->graph;
  const bool strip = p->form == FORM_STRIPS;
  unsigned char *needed = segment_needed(g, a);
  const bool bonds = p->form != FORM_POINTS && p->form != FORM_TIPS;
  long count = bonds; /* their bits */
  for (int k = 0; k < a->root_count; k++) {
    const segment_target target = a->roots[k].target;
    count += (target == TO_FIELD) * (strip ? 2 : 1) + (target == TO_SHARED || target == TO_FORCE);
  }
  for (ir_node n = 0; n < ir_count(g); n++) {
    if (!needed[n] || ir_operation(g, n) != IR_INPUT || ir_is_uniform(g, n)) continue;
    const ir_source from = ir_input_source(g, n);
    count += strip ? from == IR_FROM_ENDS : from != IR_FROM_SLOT && from != IR_FROM_PLANE;
  }
  free(needed);
  return count;
}

long law_facts_bytes(const kernel_plan *p) {
  const kernel_program *step = &p->programs[PROGRAM_STEP];
  long count = 0; /* at both ends of a bond */
  for (int k = 0; k < step->pass_count; k++)
    for (int s = 0; s < step->passes[k].segment_count; s++) {
      const segment *a = &step->passes[k].segments[s];
      if (a->kind == OVER_PARTICLES) continue;
      const bool once = a->kind == OVER_BONDS && p->form != FORM_STRIPS;
      count += arrays_of_segment(p, a) * (once ? 1 : 2);
    }
  return 8 * count / 2;
}
