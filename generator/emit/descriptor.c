#include "generator/emit/descriptor.h"

#include "generator/lower/law_inputs.h"
#include "generator/plan/plan_points.h"
#include "generator/plan/program_facts.h"
#include <string.h>

static void write_symbol(c_text *out, const symbol *s) {
  char si[64];
  dim_unit(s->dim, si, sizeof si);
  const char *texts[] = {s->name, si, s->doc};
  c_text_add(out, "    {");
  for (int k = 0; k < 3; k++) {
    c_text_string(out, texts[k]);
    c_text_add(out, ", ");
  }
  c_text_number(out, s->initial);
}

static void write_parameters(c_text *out, const kernel_plan *p) {
  const symbol_list *list = &p->law->parameters;
  if (!list->count) return;
  c_text_add(out, "static const pl_parameter law_parameters[] = {\n");
  for (int k = 0; k < list->count; k++) {
    write_symbol(out, list->items[k]);
    c_text_add(out, ", %d},\n", list->items[k]->has_default);
  }
  c_text_add(out, "};\n\n");
}

static void write_varying(c_text *out, const kernel_plan *p) {
  const law_variation *v = &p->variation;
  if (!v->varying_count) return;
  c_text_add(out, "static const int law_varying[] = {");
  for (int k = 0; k < v->varying_count; k++)
    c_text_add(out, "%s%d", k ? ", " : "", v->varying[k]);
  c_text_add(out, "};\n\n");
}

/* Places of the fields that the law is given. */
static void write_given(c_text *out, const kernel_plan *p) {
  const symbol_list *list = &p->law->parameters;
  int count = 0;
  for (int k = 0; k < list->count; k++) {
    if (!symbol_is_field(list->items[k])) continue;
    c_text_add(out, count++ ? ", %d" : "static const int32_t law_given[] = {%d", k);
  }
  if (count) c_text_add(out, "};\n\n");
}

static int given_count(const kernel_plan *p) {
  int count = 0;
  for (int k = 0; k < p->law->parameters.count; k++)
    count += symbol_is_field(p->law->parameters.items[k]);
  return count;
}

static const char *place_of_field(const symbol *s) {
  return s->place == ON_POINT      ? "PL_ON_POINT"
         : s->place == ON_TIP      ? "PL_ON_TIP"
         : s->place <= ON_PARTICLE ? "PL_ON_PARTICLE"
         : s->place == ON_BOND     ? "PL_ON_BOND"
                                   : "PL_ON_NEIGHBOUR";
}

static void write_fields(c_text *out, const symbol_list *list, const char *name) {
  if (!list->count) return;
  c_text_add(out, "static const pl_field %s[] = {\n", name);
  for (int k = 0; k < list->count; k++) {
    const symbol *s = list->items[k];
    write_symbol(out, s);
    c_text_add(out, ", %s, %s},\n",
               s->kind == SYMBOL_DAMAGE  ? "PL_FIELD_DAMAGE"
               : s->kind == SYMBOL_STATE ? "PL_FIELD_STATE"
                                         : "PL_FIELD_OUTPUT",
               place_of_field(s));
  }
  c_text_add(out, "};\n\n");
}

static void write_state_inputs(c_text *out) {
  pl_input inputs[PL_STATE_INPUTS];
  law_state_inputs(inputs);
  c_text_add(out, "static const pl_input law_state_inputs[] = {\n");
  for (int k = 0; k < PL_STATE_INPUTS; k++) {
    c_text_add(out, "    {");
    c_text_string(out, inputs[k].name);
    c_text_add(out, ", ");
    c_text_string(out, inputs[k].unit);
    c_text_add(out, "},\n");
  }
  c_text_add(out, "};\n\n");
}

static void write_table(c_text *out, const char *member, const char *array, int count) {
  c_text_add(out, "    .%s_count = %d,\n    .%ss = %s,\n", member, count, member,
             count ? array : "0");
}

/* A line of its own, which nothing that a law says can be: its texts are literals and comments. */
#define KEY_LINE(key) "\n    .key = \"" key "\",\n"

static void write_law(c_text *out, const kernel_plan *p) {
  c_text_add(
      out,
      "static const pl_law the_law = {\n    .abi = PL_KERNEL_ABI,\n    .size = sizeof(pl_law),\n"
      "    .kind = %d,\n"
      "    .dimensions = %d,\n    .dof = %d,\n    .force_planes = %d,\n    .name = ",
      plan_kind(p), p->dimensions, p->dof, p->force_planes);
  c_text_string(out, p->law->tree->name);
  c_text_add(out, "," KEY_LINE(""));
  write_table(out, "parameter", "law_parameters", p->law->parameters.count);
  c_text_add(out, "    .density = %d,\n", p->law->rho ? p->law->rho->index : -1);
  if (p->variation.varying_count)
    c_text_add(out, "    .varying_count = %d,\n    .varying = law_varying,\n",
               p->variation.varying_count);
  if (p->works_at_rest) c_text_add(out, "    .works_at_rest = 1,\n");
  if (given_count(p))
    c_text_add(out, "    .given_count = %d,\n    .given = law_given,\n", given_count(p));
  write_table(out, "field", "law_fields", p->law->fields.count);
  write_table(out, "output", "law_outputs", p->law->outputs.count);
  c_text_add(out,
             "    .stores = %d,\n    .reads_rates = %d,\n    .uniform_count = %d,\n"
             "    .flops_per_bond = ",
             p->stores, p->reads_rates, p->uniform_count);
  c_text_number(out, p->flops_per_bond);
  c_text_add(out, ",\n    .divisions_per_bond = ");
  c_text_number(out, p->divisions_per_bond);
  c_text_add(out, ",\n    .prepare = prepare,\n    .bounds = bounds,\n    .failed_field = %d,\n",
             p->law->failed ? p->law->failed->index : -1);
  if (p->programs[PROGRAM_DEFAULTS].pass_count) c_text_add(out, "    .defaults = defaults,\n");
}

static void write_program(c_text *out, const kernel_plan *of, const kernel_program *p) {
  c_text_add(out, "    .%s = {%d, %s_passes, %u, %u, %d, %s_shared},\n", p->name, p->pass_count,
             p->name, program_at_hand(of->graph, p), program_upward(of->graph, p),
             program_reaches_spared(of->graph, p), p->name);
}

static void write_programs(c_text *out, const kernel_plan *p) {
  c_text_add(out,
             "    .topology = %s,\n    .neighbours = %d,\n    .link_count = %d,\n    "
             ".bond_link_count = %d,\n    .sum_count = %d,\n    .constant_sum_count = %d,\n    "
             ".reads_shape = %d,\n    .pairwise = %d,\n",
             p->law->irregular ? "PL_LIST" : "PL_ROWS",
             p->form == FORM_UNROLLED ? p->law->neighbours : 0, p->links.of_particles,
             p->links.of_bonds, program_sum_count(&p->programs[PROGRAM_STEP]),
             program_constant_sums(p->graph, &p->programs[PROGRAM_STEP], NULL), p->reads_shape,
             p->law->tree->law != LAW_STATE);
  if (p->variation.varying_count && p->law->tree->law == LAW_STATE)
    c_text_add(out, "    .varying_place = PL_ON_PARTICLE,\n");
  if (p->reads_share) c_text_add(out, "    .reads_share = 1,\n");
  if (p->reads_mass) c_text_add(out, "    .reads_mass = 1,\n");
  if (p->variation.sizes) c_text_add(out, "    .reads_own_size = 1,\n");
  const kernel_program *step = &p->programs[PROGRAM_STEP], *losses = &p->programs[PROGRAM_LEDGER],
                       *alone = &p->programs[PROGRAM_FORCE_STATE];
  write_program(out, p, step);
  write_program(out, p, &p->programs[PROGRAM_OBSERVE]);
  if (alone->pass_count) write_program(out, p, alone);
  if (losses->pass_count) {
    arena *memory = arena_new();
    const kernel_program ledger = program_joined(memory, "ledger", step, losses);
    write_program(out, p, &ledger);
    arena_free(memory);
  }
}

/* `require h in ...` */
static void write_sizes(c_text *out, const stmt *sized) {
  if (!sized) return;
  c_text_add(out, "    .size_bounds = size_bounds,\n");
  if (!sized->text) return;
  c_text_add(out, "    .size_reason = ");
  c_text_string(out, sized->text);
  c_text_add(out, ",\n");
}

void descriptor_entry(const kernel_plan *p, c_text *out) {
  c_text_add(out, "#if PL_IN_PART(0)\n");
  write_law(out, p);
  if (p->form == FORM_POINTS) {
#define X(task, member) c_text_add(out, "    .%s = %s,\n", #member, #member);
    POINT_PROGRAMS(X)
    if (plan_has_rectangles(p)) {
      RECTANGLE_PROGRAMS(X)
    }
#undef X
    c_text_add(out, "    .linear = %d,\n    .reads_size = %d,\n    .affine = %d,\n", p->linear,
               p->reads_size, p->affine);
    write_sizes(out, p->law->sized);
  } else if (p->form == FORM_TIPS) {
#define X(task, member) c_text_add(out, "    .%s = %s,\n", #member, #member);
    TIP_PROGRAMS(X)
#undef X
  } else if (p->form != FORM_STRIPS) {
    write_programs(out, p);
  } else {
#define X(task, member) c_text_add(out, "    .%s = %s,\n", #member, #member);
    STRIP_PROGRAMS(X)
#undef X
    write_table(out, "state_input", "law_state_inputs", PL_STATE_INPUTS);
    c_text_add(out, "    .states = states,\n    .tangent = tangent,\n");
  }
  c_text_add(out, "};\n\nconst pl_law *perilat_kernel(void);\n"
                  "const pl_law *perilat_kernel(void) { return &the_law; }\n#endif\n");
}

char *descriptor_keyed(const char *unkeyed, const char *key) {
  const char *line = strstr(unkeyed, KEY_LINE(""));
  const char *rest = line + strlen(KEY_LINE(""));
  c_text out = {0};
  c_text_add(&out, "%.*s" KEY_LINE("%s") "%s", (int)(line - unkeyed), unkeyed, key, rest);
  return out.text;
}

void descriptor_lists(const kernel_plan *p, c_text *out) {
  write_parameters(out, p);
  write_varying(out, p);
  write_given(out, p);
  write_fields(out, &p->law->fields, "law_fields");
  write_fields(out, &p->law->outputs, "law_outputs");
  if (p->form == FORM_STRIPS) write_state_inputs(out);
}
