#include "generator/emit/emit.h"

#include "generator/emit/descriptor.h"
#include "generator/emit/law_functions.h"
#include "generator/emit/programs.h"
#include "generator/target/prelude.h"

static void write_prelude(emitter *e) {
  const bool of_points = e->plan->form == FORM_POINTS;
  const char *options = spell(e, plan_is_of_families(e->plan) ? SAY_FAMILY_OPTIONS
                                 : of_points                  ? SAY_POINT_OPTIONS
                                                              : SAY_STRIP_OPTIONS);
  say(e, SAY_PRELUDE, e->plan->large ? spell(e, SAY_LARGE_OPTIONS, options) : options);
  c_text_add(e->out, "%s\n%s\n", prelude_kernel_h, prelude_elementary_h);
  if (of_points) c_text_add(e->out, "%s\n", prelude_rectangle_h);
  say(e, SAY_PRELUDE_END);
}

char *emit_kernel(const kernel_plan *p) {
  c_text out = {0};
  emitter e;
  emitter_begin(&e, p, &out);
  write_prelude(&e);
  descriptor_lists(p, &out);
  law_functions_of_parameters(&e);
  programs_functions(&e);
  descriptor_entry(p, &out);
  emitter_end(&e);
  return out.text;
}
