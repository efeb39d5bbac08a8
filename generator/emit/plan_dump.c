#include "generator/emit/plan_dump.h"

#include <stdlib.h>
#include <string.h>

#include "dsl/base/arena.h"
#include "generator/emit/plan_dump_family.h"
#include "generator/emit/strip.h"
#include "generator/plan/plan_roots.h"

/* --- passes --------------------------------------------------------------------------------- */

static const char *target_name(const kernel_plan *p, const pass_root *r, char *text, size_t size) {
  static const char *const planes[] = {"force x", "force y", "end moment i", "end moment j",
                                       "twisting moment"};
  const law *l = p->law;
  switch (r->target) {
  case TO_FORCE:
    return planes[r->index];
  case TO_FIELD:
    return l->fields.items[r->index]->name;
  case TO_DISSIPATED_STATE:
    return "dissipated by states";
  case TO_DISSIPATED_RATE:
    return "dissipated by rates";
  case TO_OBSERVED:
    return r->index == 0 ? "stored energy" : l->outputs.items[r->index - 1]->name;
  case TO_LOWER:
  case TO_UPPER:
    snprintf(text, size, "%s bound of %s", r->target == TO_LOWER ? "lower" : "upper",
             l->parameters.items[r->index]->name);
    return text;
  default:
    snprintf(text, size, "out %d", r->index);
    return text;
  }
}

static void dump_reads(const kernel_plan *p, const pass *a, FILE *out, int *read_count) {
  const ir *g = p->graph;
  unsigned char *needed = must_calloc((size_t)ir_count(g) + 1, 1);
  for (int k = 0; k < a->root_count; k++)
    ir_mark(g, &a->roots[k].node, 1, needed);
  fputs("  reads ", out);
  *read_count = 0;
  for (ir_node n = 0; n < ir_count(g); n++) {
    bool local = ir_operation(g, n) == IR_INPUT && !ir_is_uniform(g, n);
    if (!needed[n] || (!local && a->kind != PASS_BOUNDS) || ir_operation(g, n) != IR_INPUT)
      continue;
    fprintf(out, " %s", ir_name(g, n));
    ++*read_count;
  }
  fputc('\n', out);
  free(needed);
}

static void dump_pass(const kernel_plan *p, const pass *a, FILE *out) {
  int read_count = 0;
  char text[128];
  fprintf(out, "pass %s\n", a->name);
  dump_reads(p, a, out, &read_count);
  fputs("  writes", out);
  for (int k = 0; k < a->root_count; k++)
    fprintf(out, "%s %s", k ? "," : "", target_name(p, &a->roots[k], text, sizeof text));
  ir_cost c = plan_cost(p, a);
  fprintf(out,
          "\n  cost   %d additions, %d multiplications, %d selects, %d divisions and roots, "
          "%d functions; %d bytes\n",
          c.additions, c.multiplications, c.selects, c.divisions, c.functions,
          8 * (read_count + a->root_count));
  strip_describe_loops(p, a->kind, out);
}

void plan_dump(const kernel_plan *p, FILE *out) {
  static const char *const kinds[] = {
      [PL_CENTRAL] = "central bond", [PL_MICROPOLAR] = "micropolar bond", [PL_STATE] = "family"};
  fprintf(out, "kernel of %s: %s, %d dimensions, %d degrees of freedom, ", p->law->tree->name,
          kinds[p->kind], p->dimensions, p->dof);
  if (p->kind == PL_STATE)
    fprintf(out, "%d links of particles, %d of bonds\n", p->links.of_particles, p->links.of_bonds);
  else
    fprintf(out, "%d force planes\n", p->force_planes);
  fprintf(out, "computed once for each bond class: %d values\n", p->uniform_count);
  for (int k = 0; k < p->uniform_count; k++) {
    ir_node n = p->uniforms[k];
    fprintf(out, "  uniform %-3d %%%d %s %s\n", k, n, ir_op_name(ir_operation(p->graph, n)),
            ir_name(p->graph, n) ? ir_name(p->graph, n) : "");
  }
  plan_dump_programs(p, out);
  for (int k = 0; k < PASS_COUNT; k++)
    if (p->passes[k].root_count) dump_pass(p, &p->passes[k], out);
}

static void dump_pass_nodes(const kernel_plan *p, const pass *a, FILE *out) {
  arena *memory = arena_new();
  char text[128];
  ir_node *nodes = arena_alloc(memory, ((size_t)a->root_count + 1) * sizeof *nodes);
  const char **names = arena_alloc(memory, ((size_t)a->root_count + 1) * sizeof *names);
  for (int k = 0; k < a->root_count; k++) {
    const char *name = target_name(p, &a->roots[k], text, sizeof text);
    nodes[k] = a->roots[k].node;
    names[k] = arena_text(memory, name, strlen(name));
  }
  fprintf(out, "pass %s\n", a->name);
  ir_dump(p->graph, nodes, names, a->root_count, out);
  fputc('\n', out);
  arena_free(memory);
}

void plan_dump_ir(const kernel_plan *p, FILE *out) {
  plan_dump_programs_ir(p, out);
  for (int k = 0; k < PASS_COUNT; k++)
    if (p->passes[k].root_count) dump_pass_nodes(p, &p->passes[k], out);
}
