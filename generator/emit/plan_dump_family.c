#include "generator/emit/plan_dump_family.h"

#include <stdlib.h>
#include <string.h>

#include "dsl/base/arena.h"
#include "generator/lower/kinematics.h"

static const char *const segment_names[] = {[OVER_PARTICLES] = "particle by particle",
                                            [OVER_NEIGHBOURS] = "neighbour by neighbour",
                                            [OVER_BONDS] = "bond by bond",
                                            [OVER_PAIRS] = "bond by bond, adding to both ends"};
static const char *const axes[] = {"x", "y", "z"};

/* --- roots ------------------------------------------------------------------------------------ */

static const char *own_name(const kernel_plan *p, ir_node n) {
  return ir_name(p->graph, n) ? ir_name(p->graph, n) : "";
}

static const char *observed_name(const kernel_plan *p, int index) {
  return index == 0 ? "stored energy" : p->law->outputs.items[index - 1]->name;
}

/* "slot 5 d", "sum into slot 19", "field w_t", "force x". */
static const char *root_name(const kernel_plan *p, const segment_root *r, char *text, size_t size) {
  static const char
      *const places[] = {[TO_SLOT] = "slot",
                         [TO_LINK] = "link",
                         [TO_BOND_LINK] = "link of bonds",
                         [TO_SHARED] = "shared",
                         [TO_PLANE] = "plane"},
             *const reductions[] = {
                 [TO_SUM] = "sum", [TO_LARGEST] = "largest", [TO_SMALLEST] = "smallest"};
  const char *name = own_name(p, r->node), *blank = *name ? " " : "";
  switch (r->target) {
  case TO_SLOT:
  case TO_LINK:
  case TO_BOND_LINK:
  case TO_SHARED:
  case TO_PLANE:
    snprintf(text, size, "%s %d%s%s", places[r->target], r->index, blank, name);
    break;
  case TO_SUM:
  case TO_LARGEST:
  case TO_SMALLEST:
    snprintf(text, size, "%s%s%s into slot %d", reductions[r->target], blank, name, r->index);
    break;
  case TO_PARTICLE_FORCE:
    snprintf(text, size, "force %s", axes[r->index]);
    break;
  case TO_PARTICLE_LOST:
    snprintf(text, size, "lost to %s", r->index == PL_LOST_TO_STATES ? "states" : "rates");
    break;
  case TO_PARTICLE_FIELD:
  case TO_NEIGHBOUR_FIELD:
    snprintf(text, size, "field %s", p->law->fields.items[r->index]->name);
    break;
  default:
    snprintf(text, size, "%s", observed_name(p, r->index));
  }
  return text;
}

static ir_node *nodes_of(const segment *a) {
  ir_node *nodes = must_alloc(((size_t)a->root_count + 1) * sizeof *nodes);
  for (int k = 0; k < a->root_count; k++)
    nodes[k] = a->roots[k].node;
  return nodes;
}

/* --- what a segment reads --------------------------------------------------------------------- */

typedef enum read_kind {
  READ_OWN,
  READ_NEIGHBOUR,
  READ_LINKS,
  READ_SHARED,
  READ_SLOTS,
  READ_PLANES
} read_kind;
static const char *const read_names[] = {
    [READ_OWN] = "own",       [READ_NEIGHBOUR] = "neighbour's", [READ_LINKS] = "links",
    [READ_SHARED] = "shared", [READ_SLOTS] = "slots",           [READ_PLANES] = "planes"};
enum { READ_KINDS = sizeof read_names / sizeof *read_names };

static read_kind kind_of_input(const ir *g, ir_node n) {
  switch (ir_input_source(g, n)) {
  case IR_FROM_NEIGHBOUR_FIELD:
  case IR_FROM_NEIGHBOUR_PARAMETER:
  case IR_FROM_NEIGHBOUR_LINK:
  case IR_FROM_NEIGHBOUR_BOND_LINK:
    return READ_NEIGHBOUR;
  case IR_FROM_LINK:
  case IR_FROM_BOND_LINK:
    return READ_LINKS;
  case IR_FROM_SHARED:
  case IR_FROM_SHARED_ODD:
    return READ_SHARED;
  case IR_FROM_SLOT:
    return READ_SLOTS;
  case IR_FROM_PLANE:
    return READ_PLANES;
  case IR_FROM_ENDS:
    return ends_origins[ir_input_index(g, n)].owner == OF_J ? READ_NEIGHBOUR : READ_OWN;
  default:
    return READ_OWN;
  }
}

static bool is_read(const ir *g, const unsigned char *needed, ir_node n) {
  return needed[n] && ir_operation(g, n) == IR_INPUT && !ir_is_uniform(g, n);
}

/* Returns how many inputs there are. */
static int dump_reads(const kernel_plan *p, const segment *a, FILE *out) {
  const ir *g = p->graph;
  unsigned char *needed = must_calloc((size_t)ir_count(g) + 1, 1);
  ir_node *nodes = nodes_of(a);
  int count = 0;
  ir_mark(g, nodes, a->root_count, needed);
  for (int kind = 0; kind < READ_KINDS; kind++) {
    bool any = false;
    for (ir_node n = 0; n < ir_count(g); n++) {
      if (!is_read(g, needed, n) || (int)kind_of_input(g, n) != kind) continue;
      if (!any) fprintf(out, "    %-12s", read_names[kind]);
      if (kind == READ_SLOTS || kind == READ_PLANES) /* numbers are those of this pass */
        fprintf(out, " %d", ir_input_index(g, n));
      else
        fprintf(out, " %s", ir_name(g, n));
      any = true;
      count++;
    }
    if (any) fputc('\n', out);
  }
  free(nodes);
  free(needed);
  return count;
}

/* --- segments and passes ---------------------------------------------------------------------- */

static void dump_segment(const kernel_plan *p, const segment *a, FILE *out) {
  char text[160];
  fprintf(out, "  %s\n", segment_names[a->kind]);
  const int reads = dump_reads(p, a, out);
  fprintf(out, "    %-12s", "writes");
  for (int k = 0; k < a->root_count; k++)
    fprintf(out, "%s %s", k ? "," : "", root_name(p, &a->roots[k], text, sizeof text));
  ir_node *nodes = nodes_of(a);
  ir_cost c = ir_count_cost(p->graph, nodes, a->root_count, ON_PARTICLE);
  free(nodes);
  fprintf(out,
          "\n    %-12s %d additions, %d multiplications, %d selects, %d divisions and roots, "
          "%d functions; %d bytes %s\n",
          "cost", c.additions, c.multiplications, c.selects, c.divisions, c.functions,
          8 * (reads + a->root_count), a->kind == OVER_PARTICLES ? "a particle" : "a bond");
}

static void dump_program(const kernel_plan *p, const family_program *q, FILE *out) {
  for (int k = 0; k < q->pass_count; k++) {
    const family_pass *now = &q->passes[k];
    fprintf(out, "pass %s %d: %d slots, %d planes\n", q->name, k, now->slot_count,
            now->plane_count);
    if (q == &p->step && p->form == FAMILY_WRITTEN_OUT)
      fprintf(out, "  loops  one over the particles, %d neighbours written out\n",
              p->law->neighbours);
    for (int s = 0; s < now->segment_count; s++)
      dump_segment(p, &now->segments[s], out);
  }
}

void plan_dump_programs(const kernel_plan *p, FILE *out) {
  dump_program(p, &p->step, out);
  dump_program(p, &p->losses, out);
  dump_program(p, &p->observe, out);
}

static void dump_segment_nodes(const kernel_plan *p, const segment *a, FILE *out) {
  arena *memory = arena_new();
  char text[160];
  ir_node *nodes = nodes_of(a);
  const char **names = arena_alloc(memory, ((size_t)a->root_count + 1) * sizeof *names);
  for (int k = 0; k < a->root_count; k++) {
    const char *name = root_name(p, &a->roots[k], text, sizeof text);
    names[k] = arena_text(memory, name, strlen(name));
  }
  ir_dump(p->graph, nodes, names, a->root_count, out);
  free(nodes);
  arena_free(memory);
}

void plan_dump_programs_ir(const kernel_plan *p, FILE *out) {
  const family_program *programs[] = {&p->step, &p->losses, &p->observe};
  for (int q = 0; q < 3; q++)
    for (int k = 0; k < programs[q]->pass_count; k++)
      for (int s = 0; s < programs[q]->passes[k].segment_count; s++) {
        const segment *a = &programs[q]->passes[k].segments[s];
        fprintf(out, "pass %s %d, %s\n", programs[q]->name, k, segment_names[a->kind]);
        dump_segment_nodes(p, a, out);
        fputc('\n', out);
      }
}
