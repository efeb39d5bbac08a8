/* Loops over bonds that add to both ends (OVER_PAIRS). A chunk is FAMILY_CHUNK particles of one row, whatever thread has
   it, so that what a particle gets comes in one order. A value for the far end is added to family->sum there, and what the
   chunk's own particles have got from behind is theirs after the loop.

   Values of fields toward neighbours are 0 for nearly all bonds and seldom change, and to read and write them would take
   longer than to compute them: eight at a time bear marks of where one is not 0 (family->old_filled), elsewhere the loop has 0 as a
   constant; and new values are stored only where they differ from what stands there. */
#include "generator/emit_parts.h"

static const char field_functions[] =
    "static const _Alignas(PL_ALIGNMENT) double zeros[%d];\n\n"
    "/* Bits of neighbours toward which some of the particles of a chunk have the mark, or do not "
    "have it. */\n"
    "static uint64_t some_marked(const uint64_t *mark, long lanes, uint64_t turned) {\n"
    "  uint64_t all = 0;\n"
    "  for (long q = 0; q < lanes; q += PL_LANES)\n"
    "    all |= mark[q / PL_LANES] ^ turned;\n"
    "  return all;\n"
    "}\n\n"
    "static int are_equal(const double *a, const double *b, long lanes) {\n"
    "  uint64_t differ = 0;\n"
    "  for (long q = 0; q < lanes; q++)\n"
    "    differ |= pl_to_bits(a[q]) ^ pl_to_bits(b[q]);\n"
    "  return differ == 0;\n"
    "}\n\n"
    "/* New values toward neighbour k, at both ends. */\n"
    "static __attribute__((noinline, cold)) void store_at_ends(\n"
    "    const pl_family *family, int field, long first, long lanes, long k, const double "
    "*values,\n"
    "    int settled) {\n"
    "  const long to = family->offset[k], half = family->neighbours / 2;\n"
    "  double *restrict here = family->new_field[field] + first + k*family->new_plane;\n"
    "  double *restrict there = family->new_field[field] + first + to + (k + "
    "half)*family->new_plane;\n"
    "  const uint64_t bit = UINT64_C(1) << k;\n"
    "  for (long at = 0; at < lanes; at += PL_LANES) {\n"
    "    uint64_t *filled = family->new_filled[field] + (first + at) / PL_LANES;\n"
    "    uint64_t *same = family->settled[field] + (first + at) / PL_LANES, bits = 0;\n"
    "    for (long q = at; q < at + PL_LANES; q++) {\n"
    "      here[q] = there[q] = values[q];\n"
    "      bits |= pl_to_bits(values[q]);\n"
    "    }\n"
    "    *filled = bits != 0 ? *filled | bit : *filled & ~bit;\n"
    "    *same = settled ? *same | bit : *same & ~bit;\n"
    "  }\n"
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

/* "old" or "new" where marks tell where the field is 0; else NULL. */
static const char *marked_field(const emitter *e, ir_node n) {
  if (ir_operation(e->graph, n) != IR_INPUT) return NULL;
  const ir_source from = ir_input_source(e->graph, n);
  if (from != IR_FROM_FIELD && from != IR_FROM_NEW_FIELD) return NULL;
  if (!program_pairs_field(&e->plan->step, ir_input_index(e->graph, n))) return NULL;
  return from == IR_FROM_FIELD ? "old" : "new";
}

bool emit_pairs_is_zero(const emitter *e, ir_node n) {
  return e->quiet && (marked_field(e, n) || emit_is_held(e, n));
}

static void write_filled(emitter *e, const char *which, int field) {
  c_text_add(e->out,
             "    const uint64_t %s_filled_%d = some_marked(family->%s_filled[%d] + first / "
             "PL_LANES, lanes, 0);\n",
             which, field, which, field);
}

static bool writes_field(const segment *a, int field) {
  for (int k = 0; k < a->root_count; k++)
    if (is_field(&a->roots[k]) && a->roots[k].index == field) return true;
  return false;
}

/* Whether the segment reads the old, or the new, values of the field. */
static bool reads_marked(const emitter *e, int field, bool new) {
  for (ir_node n = 0; n < e->node_count; n++) {
    const char *which = e->needed[n] ? marked_field(e, n) : NULL;
    if (which && ir_input_index(e->graph, n) == field && (*which == 'n') == new) return true;
  }
  return false;
}

static void write_marks(emitter *e, const segment *a) {
  for (int f = 0; f < e->plan->law->fields.count; f++) {
    if (writes_field(a, f) || reads_marked(e, f, false)) write_filled(e, "old", f);
    if (reads_marked(e, f, true)) write_filled(e, "new", f);
  }
  for (int k = 0; k < a->root_count; k++)
    if (is_field(&a->roots[k]))
      c_text_add(e->out,
                 "    const uint64_t unsettled_%d = some_marked(family->settled[%d] + first / "
                 "PL_LANES, lanes, UINT64_MAX);\n"
                 "    _Alignas(PL_ALIGNMENT) double values_%d[CHUNK];\n",
                 k, a->roots[k].index, k);
}

static void write_outputs(emitter *e, const segment *a) {
  for (int k = 0; k < a->root_count; k++)
    if (is_field(&a->roots[k]))
      c_text_add(e->out,
                 "      const double *restrict before_%d = (old_filled_%d >> k & 1) == 0 ? zeros : "
                 "family->old_field[%d] + first + k*family->plane;\n",
                 k, a->roots[k].index, a->roots[k].index);
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
      c_text_add(e->out, "        values_%d[q] = value_%d;\n", k, k);
    else
      c_text_add(e->out, "        to_%d[q] += value_%d;\n        far_%d[q] %c= value_%d;\n", k, k,
                 k, r->parity > 0 ? '+' : '-', k);
  }
}

static void write_field_stores(emitter *e, const segment *a) {
  for (int k = 0; k < a->root_count; k++)
    if (is_field(&a->roots[k]))
      c_text_add(e->out,
                 "      const int settled_%d = are_equal(values_%d, before_%d, lanes);\n"
                 "      if (!family->ahead_only && (!settled_%d || (unsettled_%d >> k & 1)))\n"
                 "        store_at_ends(family, %d, first, lanes, k, values_%d, settled_%d);\n",
                 k, k, k, k, k, a->roots[k].index, k, k);
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

static void write_loop(emitter *e, const segment *a) {
  emit_family_loop(e, "      ");
  emit_lines(e);
  c_text_add(e->out, "        const int64_t present = (bonds[q] & present_bit) != 0;\n");
  write_stores(e, a);
  c_text_add(e->out, "      }\n");
}

static bool reads_held(const emitter *e) {
  for (ir_node n = 0; n < e->node_count; n++)
    if (e->needed[n] && emit_is_input(e, n) && emit_is_held(e, n)) return true;
  return false;
}

/* One loop for where all fields that it reads are 0 and nothing is held, with these as constants, and one for elsewhere. */
static void write_loops(emitter *e, const segment *a) {
  const char *join = "      if (((";
  const bool held = reads_held(e);
  for (int f = 0; f < e->plan->law->fields.count; f++)
    for (int new = 0; new < 2; new ++)
      if (reads_marked(e, f, new)) {
        c_text_add(e->out, "%s%s_filled_%d", join, new ? "new" : "old", f);
        join = " | ";
      }
  const bool marks = *join == ' ' && join[1] == '|';
  if (marks) c_text_add(e->out, ") >> k & 1) != 0%s) {\n", held ? " || family->held_near" : "");
  write_loop(e, a);
  if (!marks) return;
  c_text_add(e->out, "      } else {\n");
  e->quiet = true;
  write_loop(e, a);
  e->quiet = false;
  c_text_add(e->out, "      }\n");
}

void emit_pairs(emitter *e, const segment *a) {
  emit_family_starts(e, a);
  write_marks(e, a);
  c_text_add(e->out,
             "    for (long k = 0; k < half; k++) { /* bond by bond, adding to both ends */\n"
             "      const long to = family->offset[k], link_to = family->link_offset[k], back = k "
             "+ half;\n"
             "      (void)back, (void)link_to;\n"
             "      const uint64_t *restrict bonds = family->bonds + first;\n"
             "      const uint64_t present_bit = UINT64_C(1) << k;\n");
  emit_family_inputs(e);
  write_outputs(e, a);
  write_loops(e, a);
  write_field_stores(e, a);
  c_text_add(e->out, "    }\n");
  write_ends(e, a);
}
