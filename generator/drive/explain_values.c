#include "generator/drive/explain_values.h"

#include <math.h>
#include <stdlib.h>

#include "dsl/base/arena.h"
#include "generator/interpreter/comparison.h"

static ir_node *find_named(const kernel_plan *p, program_task task, int *count) {
  const ir *g = p->graph;
  unsigned char *marks = segment_needed(g, plan_segment(p, task));
  ir_node *named = must_calloc((size_t)ir_count(g) + 1, sizeof *named);
  *count = 0;
  for (ir_node n = 0; n < ir_count(g); n++)
    if (marks[n] && ir_name(g, n) && !ir_is_sought(g, n) && ir_operation(g, n) != IR_INPUT &&
        ir_where(g, n).end > 0)
      named[(*count)++] = n;
  free(marks);
  return named;
}

explained explain_values(const kernel_plan *p, program_task task, const interpreter_inputs *in) {
  explained e = {.bad = 0};
  e.named = find_named(p, task, &e.count);
  e.values = planes_new(e.count + 1, 1);
  interpreter *program = interpreter_new(p->graph, e.named, e.count);
  interpreter_run(program, in, 1, e.values);
  interpreter_free(program);
  while (e.bad < e.count && isfinite(e.values[e.bad][0]))
    e.bad++;
  return e;
}

void explained_free(explained *e) {
  planes_free(e->values, e->count + 1);
  free(e->named);
}

void explain_line(const kernel_plan *p, ir_node n, const char *what, FILE *out) {
  span where = ir_where(p->graph, n);
  place at = source_place(p->law->sources, where.file, where.begin);
  fprintf(out, "  %s:%d: the law's `%s` %s there\n", p->law->sources->items[where.file].name,
          at.line, ir_name(p->graph, n), what);
}
