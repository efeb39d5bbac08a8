#include "generator/emit/plan_dump.h"

#include <stdlib.h>
#include <string.h>

#include "dsl/base/arena.h"
#include "generator/emit/strip.h"
#include "generator/lower/kinematics.h"
#include "generator/lower/point_inputs.h"
#include "generator/plan/plan_roots.h"

static const char *const segment_names[] = {[OVER_BODY] = "once",
                                            [OVER_POINTS] = "point by point",
                                            [OVER_PARTICLES] = "particle by particle",
                                            [OVER_NEIGHBOURS] = "neighbour by neighbour",
                                            [OVER_BONDS] = "bond by bond",
                                            [OVER_PAIRS] = "bond by bond, adding to both ends"};

/* --- roots ------------------------------------------------------------------------------------ */

/* Of particles forces along the axes, then moments about them: in a plane about the one across. */
static const char *force_name(const kernel_plan *p, int index) {
  static const char *const of_strips[] = {"force x", "force y", "end moment i", "end moment j",
                                          "twisting moment"},
                           *const stresses[] = {"stress xx", "stress yy", "stress zz",
                                                "stress xy", "stress yz", "stress xz"},
                           *const forces[] = {"force x", "force y", "force z"},
                           *const moments[] = {"moment x", "moment y", "moment z"};
  if (p->form == FORM_STRIPS) return of_strips[index];
  if (p->form == FORM_POINTS) return stresses[point_component(p->dimensions, index)];
  if (index < p->dimensions) return forces[index];
  return moments[p->rotations == 1 ? 2 : index - p->dimensions];
}

static const char *observed_name(const kernel_plan *p, int index) {
  return index == 0 ? "stored energy" : p->law->outputs.items[index - 1]->name;
}

/* "slot 5 d", "sum into slot 19", "field w_t", "force x", "lower bound of E". */
static const char *root_name(const kernel_plan *p, const segment_root *r, char *text, size_t size) {
  static const char
      *const kept[] =
          {[TO_SLOT] = "slot", [TO_SHARED] = "shared", [TO_PLANE] = "plane", [TO_LINK] = "link"},
             *const reductions[] = {
                 [TO_SUM] = "sum", [TO_LARGEST] = "largest", [TO_SMALLEST] = "smallest"};
  const char *name = ir_name(p->graph, r->node) ? ir_name(p->graph, r->node) : "";
  const char *blank = *name ? " " : "";
  switch (r->target) {
  case TO_SLOT:
  case TO_LINK:
  case TO_SHARED:
  case TO_PLANE:
    snprintf(text, size, "%s%s %d%s%s", kept[r->target],
             r->target == TO_LINK && r->over != OVER_PARTICLES ? " of bonds" : "", r->index, blank,
             name);
    break;
  case TO_SUM:
  case TO_LARGEST:
  case TO_SMALLEST:
    snprintf(text, size, "%s%s%s into slot %d", reductions[r->target], blank, name, r->index);
    break;
  case TO_FORCE:
    return force_name(p, r->index);
  case TO_FIELD:
    snprintf(text, size, "field %s", p->law->fields.items[r->index]->name);
    break;
  case TO_DISSIPATED_STATE:
    return "lost to states";
  case TO_DISSIPATED_RATE:
    return "lost to rates";
  case TO_GIVEN_BY_REST:
    return "given by rest";
  case TO_OBSERVED:
    return observed_name(p, r->index);
  case TO_TANGENT:
    snprintf(text, size, "tangent %d", r->index);
    break;
  case TO_OUT:
    snprintf(text, size, "out %d", r->index);
    break;
  case TO_LOWER:
  case TO_UPPER:
    snprintf(text, size, "%s bound of %s", r->target == TO_LOWER ? "lower" : "upper",
             r->index == p->law->parameters.count ? p->law->sized->name
                                                  : p->law->parameters.items[r->index]->name);
  }
  return text;
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

/* What is the same for all bonds is read by segments that do something once. */
static bool is_read(const ir *g, const segment *a, ir_node n) {
  return ir_operation(g, n) == IR_INPUT && (a->kind == OVER_BODY || !ir_is_uniform(g, n));
}

/* Returns how many inputs there are. */
static int dump_reads(const kernel_plan *p, const segment *a, FILE *out) {
  const ir *g = p->graph;
  unsigned char *needed = segment_needed(g, a);
  int count = 0;
  for (int kind = 0; kind < READ_KINDS; kind++) {
    bool any = false;
    for (ir_node n = 0; n < ir_count(g); n++) {
      if (!needed[n] || !is_read(g, a, n) || (int)kind_of_input(g, n) != kind) continue;
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
  free(needed);
  return count;
}

/* --- segments and passes ---------------------------------------------------------------------- */

static void dump_segment(const kernel_plan *p, const segment *a, FILE *out) {
  static const char *const each[] = {[OVER_BODY] = "",
                                     [OVER_POINTS] = " a point",
                                     [OVER_PARTICLES] = " a particle",
                                     [OVER_NEIGHBOURS] = " a bond",
                                     [OVER_BONDS] = " a bond",
                                     [OVER_PAIRS] = " a bond"};
  char text[160];
  fprintf(out, "  %s\n", segment_names[a->kind]);
  const int reads = dump_reads(p, a, out);
  fprintf(out, "    %-12s", "writes");
  for (int k = 0; k < a->root_count; k++)
    fprintf(out, "%s %s", k ? "," : "", root_name(p, &a->roots[k], text, sizeof text));
  const ir_cost c = plan_cost(p, a, ON_POINT);
  fprintf(out,
          "\n    %-12s %d additions, %d multiplications, %d selects, %d divisions and roots, "
          "%d functions; %d bytes%s\n",
          "cost", c.additions, c.multiplications, c.selects, c.divisions, c.functions,
          8 * (reads + segment_value_count(a)), each[a->kind]);
}

/* Of families passes are numbered; over strips, and of what knows no body, they stand alone. */
static bool is_numbered(const kernel_plan *p, int task) {
  return plan_is_of_families(p) && task <= PROGRAM_FORCE_STATE;
}

static void dump_name(const kernel_plan *p, int task, int number, FILE *out) {
  fprintf(out, "pass %s", p->programs[task].name);
  if (is_numbered(p, task)) fprintf(out, " %d", number);
}

static void dump_pass(const kernel_plan *p, int task, int number, FILE *out) {
  const program_pass *now = &p->programs[task].passes[number];
  dump_name(p, task, number, out);
  if (is_numbered(p, task))
    fprintf(out, ": %d slots, %d planes", now->slot_count, now->plane_count);
  fputc('\n', out);
  if (task == PROGRAM_STEP && p->form == FORM_UNROLLED)
    fprintf(out, "  loops  one over the particles, %d neighbours written out\n",
            p->law->neighbours);
  for (int s = 0; s < now->segment_count; s++) {
    if (!now->segments[s].root_count) continue;
    dump_segment(p, &now->segments[s], out);
    if (p->form == FORM_STRIPS && task <= PROGRAM_OBSERVE)
      strip_describe_loops(p, &now->segments[s], out);
  }
}

void plan_dump(const kernel_plan *p, FILE *out) {
  static const char *const kinds[] = {[PL_CENTRAL] = "central bond",
                                      [PL_MICROPOLAR] = "micropolar bond",
                                      [PL_STATE] = "family",
                                      [PL_CONTINUUM] = "continuum",
                                      [PL_CRACK] = "crack"};
  fprintf(out, "kernel of %s: %s, %d dimensions, %d degrees of freedom, ", p->law->tree->name,
          kinds[plan_kind(p)], p->dimensions, p->dof);
  if (p->form == FORM_POINTS)
    fprintf(out, "%s\n", p->linear ? "linear" : "not linear");
  else if (plan_is_of_families(p))
    fprintf(out, "%d links of particles, %d of bonds\n", p->links.of_particles, p->links.of_bonds);
  else
    fprintf(out, "%d force planes\n", p->force_planes);
  fprintf(out, "computed once for each bond class: %d values\n", p->uniform_count);
  for (int k = 0; k < p->uniform_count; k++) {
    ir_node n = p->uniforms[k];
    fprintf(out, "  uniform %-3d %%%d %s %s\n", k, n, ir_op_name(ir_operation(p->graph, n)),
            ir_name(p->graph, n) ? ir_name(p->graph, n) : "");
  }
  for (int task = 0; task < PROGRAM_COUNT; task++)
    for (int k = 0; k < p->programs[task].pass_count; k++)
      dump_pass(p, task, k, out);
}

static void dump_segment_nodes(const kernel_plan *p, const segment *a, FILE *out) {
  arena *memory = arena_new();
  char text[160];
  ir_node *nodes = segment_values(a);
  const int count = segment_value_count(a);
  const char **names = arena_alloc(memory, ((size_t)count + 1) * sizeof *names);
  for (int k = 0, far = a->root_count; k < a->root_count; k++) {
    const char *name = root_name(p, &a->roots[k], text, sizeof text);
    names[k] = arena_text(memory, name, strlen(name));
    if (segment_has_far(&a->roots[k])) names[far++] = arena_printf(memory, "%s, far end", names[k]);
  }
  ir_dump(p->graph, nodes, names, count, out);
  free(nodes);
  arena_free(memory);
}

void plan_dump_ir(const kernel_plan *p, FILE *out) {
  for (int task = 0; task < PROGRAM_COUNT; task++)
    for (int k = 0; k < p->programs[task].pass_count; k++)
      for (int s = 0; s < p->programs[task].passes[k].segment_count; s++) {
        const segment *a = &p->programs[task].passes[k].segments[s];
        if (!a->root_count) continue;
        dump_name(p, task, k, out);
        fprintf(out, ", %s\n", segment_names[a->kind]);
        dump_segment_nodes(p, a, out);
        fputc('\n', out);
      }
}
