/* Programs of families as C: one function for each pass; in it, for each chunk of particles, the segments one after the
   other. Loops over the particles of a chunk are innermost and vectorise; a neighbour is an offset. */
#include <inttypes.h>
#include <stdlib.h>
#include <string.h>

#include "dsl/base/arena.h"
#include "generator/emit/emit_parts.h"
#include "generator/lower/kinematics.h"
#include "generator/plan/program_facts.h"

/* --- inputs ----------------------------------------------------------------------------------- */

bool emit_is_time_step(const emitter *e, ir_node n) {
  return ir_input_source(e->graph, n) == IR_FROM_ENDS &&
         ir_input_index(e->graph, n) == ENDS_TIME_STEP;
}

bool emit_is_held(const emitter *e, ir_node n) {
  return ir_input_source(e->graph, n) == IR_FROM_ENDS &&
         ends_origins[ir_input_index(e->graph, n)].array == FROM_HELD;
}

static bool is_of_particle(const emitter *e, int field) {
  return e->plan->law->fields.items[field]->place <= ON_PARTICLE;
}

static bool is_list(const emitter *e) {
  return e->plan->law->irregular;
}

/* The value is of the neighbour. */
static bool is_of_neighbour(const emitter *e, ir_node n) {
  switch (ir_input_source(e->graph, n)) {
  case IR_FROM_NEIGHBOUR_FIELD:
  case IR_FROM_NEIGHBOUR_LINK:
  case IR_FROM_NEIGHBOUR_BOND_LINK:
    return true;
  case IR_FROM_ENDS:
    return ends_origins[ir_input_index(e->graph, n)].owner == OF_J;
  default:
    return false;
  }
}

void emit_segment_input(emitter *e, ir_node n) {
  if (e->unrolled) {
    emit_unrolled_input(e, n);
    return;
  }
  const bool odd = ir_input_source(e->graph, n) == IR_FROM_SHARED_ODD;
  const char *at = is_list(e) && is_of_neighbour(e, n) ? "q + to[q]" : "q";
  if (emit_pairs_is_zero(e, n))
    c_text_add(e->out, "0.0");
  else if (emit_is_time_step(e, n))
    c_text_add(e->out, "family->time_step");
  else
    c_text_add(e->out, "%sat_%s[%s]%s", odd ? "sign*" : "", e->name[n], at,
               emit_is_held(e, n) ? " != 0 ? 1.0 : 0.0" : "");
}

/* Where the array of an input of particle positions, velocities, flags, volumes or masses begins, or of bonds' chords. */
static void write_ends_array(emitter *e, ir_node n) {
  const ends_origin *o = &ends_origins[ir_input_index(e->graph, n)];
  const family_words *w = e->words;
  switch (o->array) {
  case FROM_HELD:
    c_text_add(e->out, "family->held%s", w->first);
    break;
  case FROM_VOLUME:
    c_text_add(e->out, "family->volume%s", w->first);
    break;
  case FROM_MASS:
    c_text_add(e->out, "family->mass%s", w->first);
    break;
  case FROM_LENGTH:
    c_text_add(e->out, "family->length%s + %s*family->plane", w->first, w->k);
    break;
  case FROM_CHORD:
    c_text_add(e->out, "family->chord[%d]%s + %s*family->plane", o->component, w->first, w->k);
    break;
  default:
    c_text_add(e->out, "family->%s[%d]%s",
               o->array == FROM_DISPLACEMENT ? "displacement" : "velocity", o->component, w->first);
  }
}

/* A value that both ends of a bond share, in the plane of the bond's number at its owner. */
static void write_shared(emitter *e, int index, const char *number, const char *at) {
  const shared_place stands = program_shared_place(index);
  c_text_add(e->out, "family->bond_link[%d]%s + %s + (%s%s)*family->link_plane", stands.link,
             e->words->first, at, stands.upper ? "half + " : "", number);
}

static bool is_link(const emitter *e, ir_node n) {
  const ir_source from = ir_input_source(e->graph, n);
  return from == IR_FROM_NEIGHBOUR_LINK || from == IR_FROM_NEIGHBOUR_BOND_LINK;
}

/* Of the particle at hand, or at lane 0 of the chunk's neighbours; on lists the loop adds the way to the neighbour. */
void emit_family_array(emitter *e, ir_node n) {
  const int index = ir_input_index(e->graph, n);
  const bool own = ir_place(e->graph, n) != ON_BOND; /* of a neighbour's fields: toward me */
  const family_words *w = e->words;
  switch (ir_input_source(e->graph, n)) {
  case IR_FROM_FIELD:
    c_text_add(e->out, "family->old_field[%d]%s", index, w->first);
    if (!is_of_particle(e, index)) c_text_add(e->out, " + %s*family->plane", w->k);
    break;
  case IR_FROM_NEW_FIELD:
    c_text_add(e->out, "family->new_field[%d]%s + %s*family->new_plane", index, w->first, w->k);
    break;
  case IR_FROM_NEIGHBOUR_FIELD:
    c_text_add(e->out, "family->old_field[%d]%s", index, w->first);
    if (own) c_text_add(e->out, " + %s*family->plane", w->back);
    break;
  case IR_FROM_LINK:
  case IR_FROM_NEIGHBOUR_LINK:
    c_text_add(e->out, "family->link[%d]%s", index, w->first);
    break;
  case IR_FROM_BOND_LINK:
    c_text_add(e->out, "family->bond_link[%d]%s + %s*family->link_plane", index, w->first, w->k);
    break;
  case IR_FROM_NEIGHBOUR_BOND_LINK:
    c_text_add(e->out, "family->bond_link[%d]%s + %s*family->link_plane", index, w->first, w->back);
    break;
  case IR_FROM_SHARED:
  case IR_FROM_SHARED_ODD:
    write_shared(e, index, w->owned, w->owner);
    break;
  case IR_FROM_SHAPE:
    c_text_add(e->out, "family->shape[%d]%s", index, w->first);
    break;
  case IR_FROM_SLOT:
    c_text_add(e->out, "slot_%d", index);
    break;
  case IR_FROM_PLANE:
    c_text_add(e->out, "plane_%d[k]", index);
    break;
  default:
    write_ends_array(e, n);
  }
  if (is_of_neighbour(e, n) && !is_list(e))
    c_text_add(e->out, " + %s", is_link(e, n) ? w->link_to : w->to);
}

void emit_family_inputs(emitter *e) {
  const char *indent = e->scope == IN_NEIGHBOURS ? "      " : "    ";
  for (ir_node n = 0; n < e->node_count; n++) {
    if (!e->needed[n] || ir_operation(e->graph, n) == IR_CONSTANT) continue;
    if (emit_is_uniform(e, n)) {
      c_text_add(e->out, "%sconst double %s = uniforms[%s%d]", indent, e->name[n],
                 e->scope == IN_NEIGHBOURS && !is_list(e) ? "k*UNIFORMS + " : "", e->uniform_of[n]);
      emit_line_end(e, n);
    } else if (emit_is_input(e, n) && !emit_is_time_step(e, n)) {
      c_text_add(e->out, "%sconst %s *restrict at_%s = ", indent,
                 emit_is_held(e, n) ? "uint64_t" : "double", e->name[n]);
      emit_family_array(e, n);
      c_text_add(e->out, ";\n");
    }
  }
}

/* --- outputs ---------------------------------------------------------------------------------- */

/* The array that a root is written to. Slots and planes are the pass's own. */
void emit_family_target(emitter *e, const segment_root *r) {
  const family_words *w = e->words;
  switch (r->target) {
  case TO_LINK:
    c_text_add(e->out, "family->link[%d]%s", r->index, w->first);
    break;
  case TO_PARTICLE_FIELD:
    c_text_add(e->out, "family->new_field[%d]%s", r->index, w->first);
    break;
  case TO_PARTICLE_FORCE:
    c_text_add(e->out, "family->force[%d]%s", r->index, w->first);
    break;
  case TO_PARTICLE_OBSERVED:
    c_text_add(e->out, "family->observed[%d]%s", r->index, w->first);
    break;
  case TO_NEIGHBOUR_FIELD:
    c_text_add(e->out, "family->new_field[%d]%s + %s*family->new_plane", r->index, w->first, w->k);
    break;
  case TO_NEIGHBOUR_OBSERVED:
    c_text_add(e->out, "family->observed[%d]%s + %s*family->new_plane", r->index, w->first, w->k);
    break;
  case TO_PLANE:
    c_text_add(e->out, "plane_%d[k]", r->index);
    break;
  case TO_BOND_LINK:
    c_text_add(e->out, "family->bond_link[%d]%s + %s*family->link_plane", r->index, w->first, w->k);
    break;
  case TO_SHARED:
    write_shared(e, r->index, w->k, "0");
    break;
  default:
    c_text_add(e->out, "slot_%d", r->index);
  }
}

static void write_outputs(emitter *e, const segment *a) {
  const char *indent = a->kind == OVER_PARTICLES ? "    " : "      ";
  for (int k = 0; k < a->root_count; k++) {
    c_text_add(e->out, "%sdouble *restrict to_%d = ", indent, k);
    emit_family_target(e, &a->roots[k]);
    c_text_add(e->out, ";\n");
  }
}

static void store_sum(emitter *e, const segment_root *r, const char *to) {
  const char *asks = segment_asks(r) ? "present ? " : "", *otherwise = to;
  if (segment_fuses(e->graph, r)) {
    c_text_add(e->out, "= %spl_fma(", asks);
    emit_value(e, ir_operand(e->graph, r->node, 0));
    c_text_add(e->out, ", ");
    emit_value(e, ir_operand(e->graph, r->node, 1));
    c_text_add(e->out, ", %s)", to);
  } else if (e->unrolled) {
    c_text_add(e->out, "= %s%s + ", asks, to);
    emit_value(e, r->node);
  } else {
    c_text_add(e->out, "+= %s", asks);
    emit_value(e, r->node);
    otherwise = "0.0"; /* an array is written in any case */
  }
  if (segment_asks(r)) c_text_add(e->out, " : %s", otherwise);
  c_text_add(e->out, ";\n");
}

void emit_family_store(emitter *e, const segment_root *r, const char *to) {
  c_text_add(e->out, "        %s ", to);
  switch (r->target) {
  case TO_SUM:
    store_sum(e, r, to);
    break;
  case TO_LARGEST:
  case TO_SMALLEST:
    c_text_add(e->out, "= present ? pl_%s(%s, ", r->target == TO_LARGEST ? "max" : "min", to);
    emit_value(e, r->node);
    c_text_add(e->out, ") : %s;\n", to);
    break;
  default:
    c_text_add(e->out, segment_asks(r) ? "= present ? " : "= ");
    emit_value(e, r->node);
    c_text_add(e->out, segment_asks(r) ? " : 0.0;\n" : ";\n");
  }
}

static void write_stores(emitter *e, const segment *a) {
  char to[32];
  for (int k = 0; k < a->root_count; k++) {
    snprintf(to, sizeof to, "to_%d[q]", k);
    emit_family_store(e, &a->roots[k], to);
  }
}

/* --- segments --------------------------------------------------------------------------------- */

void emit_open_segment(emitter *e, const segment *a) {
  ir_node *nodes = must_alloc((2 * (size_t)a->root_count + 1) * sizeof *nodes);
  const int count = segment_nodes(e->graph, a, nodes);
  emit_open_nodes(e, a->kind == OVER_PARTICLES ? IN_PARTICLES : IN_NEIGHBOURS, nodes, count);
  free(nodes);
}

void emit_family_loop(emitter *e, const char *indent) {
  c_text_add(e->out, "%sPL_INDEPENDENT\n%sfor (long q = 0; q < lanes; q++) {\n", indent, indent);
}

static void write_particles(emitter *e, const segment *a) {
  c_text_add(e->out, "    { /* particle by particle */\n");
  emit_family_inputs(e);
  write_outputs(e, a);
  emit_family_loop(e, "    ");
  emit_lines(e);
  write_stores(e, a);
  c_text_add(e->out, "    }\n    }\n");
}

bool emit_is_reduction(const segment_root *r) {
  return r->target >= TO_SUM && r->target <= TO_SMALLEST;
}

const char *emit_reduction_start(const segment_root *r) {
  static const char *const starts[] = {
      [TO_SUM] = "0.0", [TO_LARGEST] = "-__builtin_inf()", [TO_SMALLEST] = "__builtin_inf()"};
  return starts[r->target];
}

void emit_family_starts(emitter *e, const segment *a) {
  bool any = false;
  for (int k = 0; k < a->root_count; k++)
    any = any || emit_is_reduction(&a->roots[k]);
  if (!any) return;
  c_text_add(e->out, "    for (long q = 0; q < lanes; q++) {\n");
  for (int k = 0; k < a->root_count; k++)
    if (emit_is_reduction(&a->roots[k]))
      c_text_add(e->out, "      slot_%d[q] = %s;\n", a->roots[k].index,
                 emit_reduction_start(&a->roots[k]));
  c_text_add(e->out, "    }\n");
}

bool emit_asks_for_presence(const segment *a) {
  bool asks = false;
  for (int k = 0; k < a->root_count; k++)
    asks = asks || segment_asks(&a->roots[k]);
  return asks;
}

static void write_presence(emitter *e) {
  c_text_add(e->out, "      const uint64_t *restrict bonds = ");
  c_text_add(e->out, is_list(e) ? "(k < half ? family->bonds : family->incoming) + first;\n"
                                : "family->bonds + first + (k < half ? 0 : to);\n");
  c_text_add(e->out, "      const uint64_t present_bit = UINT64_C(1) << (k < half ? k : back);\n");
}

static bool reads(const emitter *e, ir_source from) {
  bool does = false;
  for (ir_node n = 0; n < e->node_count && !does; n++)
    does = e->needed[n] && ir_operation(e->graph, n) == IR_INPUT &&
           ir_input_source(e->graph, n) == from;
  return does;
}

static void write_neighbours(emitter *e, const segment *a) {
  emit_family_starts(e, a);
  c_text_add(
      e->out,
      a->kind == OVER_BONDS
          ? "    for (long k = 0; k < half; k++) { /* bond by bond, for both ends */\n"
            "      const long back = k + half;\n"
          : "    for (long k = 0; k < family->neighbours; k++) { /* neighbour by neighbour */\n"
            "      const long back = k < half ? k + half : k - half;\n");
  c_text_add(
      e->out,
      is_list(e)
          ? "      const int32_t *restrict to = family->neighbour + first + k*family->plane;\n"
          : "      const long to = family->offset[k], link_to = family->link_offset[k];\n"
            "      (void)link_to;\n");
  c_text_add(e->out, "      (void)to, (void)back;\n");
  if (emit_asks_for_presence(a)) write_presence(e);
  if (reads(e, IR_FROM_SHARED_ODD))
    c_text_add(e->out, "      const double sign = k < half ? 1.0 : -1.0;\n");
  if (reads(e, IR_FROM_SHARED) || reads(e, IR_FROM_SHARED_ODD))
    c_text_add(e->out,
               "      const long owned = k < half ? k : back, owner = k < half ? 0 : link_to;\n");
  emit_family_inputs(e);
  write_outputs(e, a);
  emit_family_loop(e, "      ");
  emit_lines(e);
  if (emit_asks_for_presence(a))
    c_text_add(e->out, "        const int64_t present = (bonds[q] & present_bit) != 0;\n");
  write_stores(e, a);
  c_text_add(e->out, "      }\n    }\n");
}

/* --- passes ----------------------------------------------------------------------------------- */

/* Particles at a time. Long chunks read the planes of large families in long pieces; what a pass keeps between its segments
   should stay in the first cache. */
static int chunk_of(const family_pass *p) {
  enum { LONGEST = 512, KEPT = 16384 }; /* B */
  int chunk = LONGEST;
  if (p->plane_count > 0 || program_is_paired(p)) return FAMILY_CHUNK;
  while (chunk > FAMILY_CHUNK && p->slot_count * chunk * (int)sizeof(double) > KEPT)
    chunk /= 2;
  return chunk;
}

const char emit_rows_begin[] = "  for (long row = 0; row < family->rows; row++) {\n"
                               "  const long begin = row*family->row_stride,\n"
                               "    end = begin + family->count / PL_LANES * PL_LANES;\n";

static void write_rolled_pass(emitter *e, const family_pass *p) {
  static const family_words rolled = {.first = " + first",
                                      .k = "k",
                                      .back = "back",
                                      .to = "to",
                                      .link_to = "link_to",
                                      .owned = "owned",
                                      .owner = "owner"};
  e->words = &rolled;
  c_text_add(e->out, "  enum { CHUNK = %d };\n", chunk_of(p));
  if (program_sum_count(&e->plan->step) > 0 && !program_is_paired(p))
    c_text_add(e->out, "  if (family->ahead_only) return;\n");
  for (int k = 0; k < p->slot_count; k++)
    c_text_add(e->out, "  _Alignas(PL_ALIGNMENT) double slot_%d[CHUNK];\n", k);
  for (int k = 0; k < p->plane_count; k++)
    c_text_add(e->out, "  _Alignas(PL_ALIGNMENT) double plane_%d[2*PL_MAX_DIRECTIONS][CHUNK];\n",
               k);
  const bool rows = e->plan->form == FAMILY_WRITTEN_OUT;
  c_text_add(e->out, rows ? emit_rows_begin : "  const long begin = 0, end = family->count;\n");
  c_text_add(e->out, "  for (long first = begin; first < end; first += CHUNK) {\n"
                     "    const long left = end - first;\n"
                     "    const long lanes = left < CHUNK ? left / PL_LANES * PL_LANES : CHUNK;\n");
  for (int k = 0; k < p->segment_count; k++) {
    const segment *a = &p->segments[k];
    emit_open_segment(e, a);
    if (a->kind == OVER_PARTICLES)
      write_particles(e, a);
    else if (a->kind == OVER_PAIRS)
      emit_pairs(e, a);
    else
      write_neighbours(e, a);
    emit_close(e);
  }
  c_text_add(e->out, rows ? "  }\n  }\n" : "  }\n");
}

static void write_pass(emitter *e, const family_program *q, int number) {
  const bool unrolled = q == &e->plan->step && e->plan->form == FAMILY_WRITTEN_OUT;
  char name[40];
  if (unrolled)
    c_text_add(e->out, "/* one loop, %d neighbours written out */\n", e->plan->law->neighbours);
  snprintf(name, sizeof name, "%s_%d", q->name, number);
  emit_function_begin(e, "PL_PASS", name, "const pl_family *family");
  c_text_add(e->out, "  const long half = family->neighbours / 2;\n"
                     "  (void)law, (void)uniforms, (void)half;\n");
  if (unrolled)
    emit_unrolled_pass(e, &q->passes[number]);
  else
    write_rolled_pass(e, &q->passes[number]);
  emit_function_end(e);
}

static void write_program(emitter *e, const family_program *q) {
  for (int k = 0; k < q->pass_count; k++)
    write_pass(e, q, k);
  c_text_add(e->out, "static const pl_family_function %s_passes[] = {", q->name);
  for (int k = 0; k < q->pass_count; k++)
    c_text_add(e->out, "%s%s_%d", k ? ", " : "", q->name, k);
  c_text_add(e->out, "};\nstatic const uint64_t %s_shared[] = {", q->name);
  for (int k = 0; k < q->pass_count; k++)
    c_text_add(e->out, "%sUINT64_C(%" PRIu64 ")", k ? ", " : "", program_shared_by(&q->passes[k]));
  c_text_add(e->out, "};\n\n");
}

void emit_programs(emitter *e) {
  c_text_add(e->out, "enum { UNIFORMS = %d };\n\n", e->plan->uniform_count);
  emit_pairs_functions(e);
  write_program(e, &e->plan->step);
  write_program(e, &e->plan->observe);
}

static void write_program_member(emitter *e, const family_program *p) {
  c_text_add(e->out, "    .%s = {%d, %s_passes, %u, %u, %d, %s_shared},\n", p->name, p->pass_count,
             p->name, program_at_hand(e->graph, p), program_upward(e->graph, p),
             program_reaches_spared(e->graph, p), p->name);
}

void emit_program_members(emitter *e) {
  c_text_add(e->out,
             "    .topology = %s,\n    .neighbours = %d,\n    .link_count = %d,\n    "
             ".bond_link_count = %d,\n    .sum_count = %d,\n    .constant_sum_count = %d,\n    "
             ".reads_shape = %d,\n    .pairwise = %d,\n",
             is_list(e) ? "PL_LIST" : "PL_ROWS",
             e->plan->form == FAMILY_WRITTEN_OUT ? e->plan->law->neighbours : 0,
             e->plan->links.of_particles, e->plan->links.of_bonds,
             program_sum_count(&e->plan->step),
             program_constant_sums(e->graph, &e->plan->step, NULL), e->plan->reads_shape,
             e->plan->law->tree->law == LAW_CENTRAL_BOND);
  write_program_member(e, &e->plan->step);
  write_program_member(e, &e->plan->observe);
}
