/* Loops over bonds that add to both ends (OVER_PAIRS). A chunk is FAMILY_CHUNK particles of one row, whatever thread has
   it, so that what a particle gets comes in one order. A value for the far end is added to family->sum there, and what the
   chunk's own particles have got from behind is theirs after the loop.

   Values of fields toward neighbours are 0 for nearly all bonds, and to read and write them would take longer than to
   compute them: eight at a time bear a mark where one is not (family->old_filled), the others are read from a few zeros
   in the first cache, and are stored only where they or what they replace is not 0. */
#include "generator/emit_parts.h"

bool emit_is_paired(const family_pass *p) {
  for (int k = 0; k < p->segment_count; k++)
    if (p->segments[k].kind == OVER_PAIRS) return true;
  return false;
}

static const char field_functions[] =
    "static const _Alignas(PL_ALIGNMENT) double zeros[%d];\n\n"
    "/* Of all particles of a chunk together. */\n"
    "static uint64_t all_filled(const uint64_t *filled, long lanes) {\n"
    "  uint64_t all = 0;\n"
    "  for (long q = 0; q < lanes; q += PL_LANES)\n"
    "    all |= filled[q / PL_LANES];\n"
    "  return all;\n"
    "}\n\n"
    "/* New values toward neighbour k, at both ends. */\n"
    "static void store_at_ends(const pl_family *family, int field, long first, long lanes, long "
    "k,\n"
    "                          const double *values, int filled) {\n"
    "  const long to = family->offset[k], half = family->neighbours / 2;\n"
    "  double *restrict here = family->new_field[field] + first + k*family->plane;\n"
    "  double *restrict there = family->new_field[field] + first + to + (k + half)*family->plane;\n"
    "  uint64_t *mark = family->new_filled[field] + first / PL_LANES;\n"
    "  const uint64_t bit = UINT64_C(1) << k;\n"
    "  for (long q = 0; q < lanes; q++)\n"
    "    here[q] = there[q] = values[q];\n"
    "  for (long q = 0; q < lanes / PL_LANES; q++)\n"
    "    mark[q] = filled ? mark[q] | bit : mark[q] & ~bit;\n"
    "}\n\n";

static bool is_field(const segment_root *r) {
  return r->target == TO_NEIGHBOUR_FIELD;
}

void emit_pairs_functions(emitter *e) {
  for (int f = 0; f < e->plan->law->fields.count; f++)
    if (program_pairs_field(&e->plan->step, f)) {
      c_text_add(e->out, field_functions, FAMILY_CHUNK);
      return;
    }
}

/* Whether a field's marks tell where it is 0. */
static bool is_marked(const emitter *e, ir_node n) {
  return ir_operation(e->graph, n) == IR_INPUT && ir_input_source(e->graph, n) == IR_FROM_FIELD &&
         program_pairs_field(&e->plan->step, ir_input_index(e->graph, n));
}

void emit_pairs_choice(emitter *e, ir_node n) {
  if (e->pairs && is_marked(e, n))
    c_text_add(e->out, "(old_filled_%d >> k & 1) == 0 ? zeros : ", ir_input_index(e->graph, n));
}

static void write_marks(emitter *e, const segment *a) {
  for (int f = 0; f < e->plan->law->fields.count; f++) {
    bool needed = false;
    for (ir_node n = 0; n < e->node_count && !needed; n++)
      needed = e->needed[n] && is_marked(e, n) && ir_input_index(e->graph, n) == f;
    if (needed)
      c_text_add(e->out,
                 "    const uint64_t old_filled_%d = all_filled(family->old_filled[%d] + first / "
                 "PL_LANES, lanes);\n",
                 f, f);
  }
  for (int k = 0; k < a->root_count; k++)
    if (is_field(&a->roots[k]))
      c_text_add(e->out,
                 "    const uint64_t new_filled_%d = all_filled(family->new_filled[%d] + first / "
                 "PL_LANES, lanes);\n"
                 "    _Alignas(PL_ALIGNMENT) double values_%d[CHUNK];\n",
                 k, a->roots[k].index, k);
}

static void write_outputs(emitter *e, const segment *a) {
  for (int k = 0; k < a->root_count; k++)
    if (is_field(&a->roots[k]))
      c_text_add(e->out, "      uint64_t bits_%d = 0;\n", k);
    else
      c_text_add(e->out,
                 "      double *restrict to_%d = slot_%d, *restrict far_%d = family->sum[%d] + "
                 "first + to;\n",
                 k, a->roots[k].index, k, a->roots[k].sum);
}

static void write_stores(emitter *e, const segment *a) {
  for (int k = 0; k < a->root_count; k++) {
    const segment_root *r = &a->roots[k];
    c_text_add(e->out, "        const double value_%d = present ? ", k);
    emit_value(e, r->node);
    c_text_add(e->out, " : 0.0;\n");
    if (is_field(r))
      c_text_add(e->out,
                 "        values_%d[q] = value_%d;\n        bits_%d |= pl_to_bits(value_%d);\n", k,
                 k, k, k);
    else
      c_text_add(e->out, "        to_%d[q] += value_%d;\n        far_%d[q] %c= value_%d;\n", k, k,
                 k, r->parity > 0 ? '+' : '-', k);
  }
}

static void write_field_stores(emitter *e, const segment *a) {
  for (int k = 0; k < a->root_count; k++)
    if (is_field(&a->roots[k]))
      c_text_add(e->out,
                 "      if (!family->ahead_only && (bits_%d != 0 || (new_filled_%d >> k & 1)))\n"
                 "        store_at_ends(family, %d, first, lanes, k, values_%d, bits_%d != 0);\n",
                 k, k, a->roots[k].index, k, k);
}

/* What the particles have got from behind; from then on the sums are 0 for the next pass. */
static void write_ends(emitter *e, const segment *a) {
  for (int k = 0; k < a->root_count; k++)
    if (!is_field(&a->roots[k]))
      c_text_add(e->out,
                 "    {\n"
                 "    double *restrict got = family->sum[%d] + first;\n"
                 "    for (long q = 0; q < lanes; q++) {\n"
                 "      slot_%d[q] += got[q];\n"
                 "      got[q] = 0.0;\n"
                 "    }\n"
                 "    }\n",
                 a->roots[k].sum, a->roots[k].index);
  c_text_add(e->out, "    if (family->ahead_only) continue;\n");
}

void emit_pairs(emitter *e, const segment *a) {
  e->pairs = true;
  emit_family_starts(e, a);
  write_marks(e, a);
  c_text_add(e->out,
             "    for (long k = 0; k < half; k++) { /* bond by bond, adding to both ends */\n"
             "      const long to = family->offset[k], back = k + half;\n"
             "      (void)back;\n"
             "      const uint64_t *restrict bonds = family->bonds + first;\n"
             "      const uint64_t present_bit = UINT64_C(1) << k;\n");
  emit_family_inputs(e);
  write_outputs(e, a);
  emit_family_loop(e, "      ");
  emit_lines(e);
  c_text_add(e->out, "        const int64_t present = (bonds[q] & present_bit) != 0;\n");
  write_stores(e, a);
  c_text_add(e->out, "      }\n");
  write_field_stores(e, a);
  c_text_add(e->out, "    }\n");
  write_ends(e, a);
  e->pairs = false;
}
