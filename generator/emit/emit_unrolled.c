/* Passes with neighbours written out (FAMILY_WRITTEN_OUT). Arrays and the values of bond classes are named before the loop, each once,
   by a number; slots and planes are variables, and so is what an array holds, read once: compilers do not see that it is
   still the same behind what was written in between. */
#include <stdlib.h>
#include <string.h>

#include "dsl/base/arena.h"
#include "generator/emit/emit_parts.h"

/* Texts that stand before the loop under a name. */
typedef struct known_texts {
  const char **text;
  int count, capacity;
} known_texts;

typedef struct unrolled {
  arena *memory;
  known_texts arrays, words_of_bits, results, uniforms;
  int neighbour; /* of the segment at hand; -1: of the particles */
} unrolled;

static int number_of(unrolled *u, known_texts *t, const char *text) {
  for (int k = 0; k < t->count; k++)
    if (strcmp(t->text[k], text) == 0) return k;
  if (t->count == t->capacity) {
    t->capacity = 2 * t->capacity + 16;
    t->text = must_realloc(t->text, (size_t)t->capacity * sizeof *t->text);
  }
  t->text[t->count] = arena_text(u->memory, text, strlen(text));
  return t->count++;
}

/* What `write` writes, numbered. */
static int number_of_written(emitter *e, known_texts *t, void (*write)(emitter *, const void *),
                             const void *of) {
  c_text *out = e->out, text = {0};
  e->out = &text;
  write(e, of);
  e->out = out;
  const int number = number_of(e->unrolled, t, text.text);
  free(text.text);
  return number;
}

static void write_input_array(emitter *e, const void *n) {
  emit_family_array(e, *(const ir_node *)n);
}

static void write_result_array(emitter *e, const void *root) {
  emit_family_target(e, root);
}

/* --- inputs ----------------------------------------------------------------------------------- */

/* Of more neighbours no registers hold what was read: it is read again, as an operand. */
enum { MOST_KEPT = 8 };

void emit_unrolled_input(emitter *e, ir_node n) {
  unrolled *u = e->unrolled;
  const ir_source from = ir_input_source(e->graph, n);
  const int index = ir_input_index(e->graph, n), arrays = u->arrays.count;
  if (emit_is_time_step(e, n)) {
    c_text_add(e->out, "at_uniform_%d", number_of(u, &u->uniforms, "family->time_step"));
  } else if (from == IR_FROM_SLOT) {
    c_text_add(e->out, "at_slot_%d", index);
  } else if (from == IR_FROM_PLANE) {
    c_text_add(e->out, "at_plane_%d_%d", index, u->neighbour);
  } else if (emit_is_held(e, n)) {
    c_text_add(e->out, "at_bits_%d[q] != 0 ? 1.0 : 0.0",
               number_of_written(e, &u->words_of_bits, write_input_array, &n));
  } else {
    const int number = number_of_written(e, &u->arrays, write_input_array, &n);
    if (from == IR_FROM_SHARED_ODD && e->words->far) c_text_add(e->out, "-");
    if (e->plan->law->neighbours > MOST_KEPT)
      c_text_add(e->out, "at_%d[q]", number);
    else if (number < arrays)
      c_text_add(e->out, "PL_AGAIN(at_read_%d, at_%d)", number, number);
    else
      c_text_add(e->out, "(at_read_%d = at_%d[q])", number, number);
  }
}

static void write_uniforms(emitter *e) {
  unrolled *u = e->unrolled;
  for (ir_node n = 0; n < e->node_count; n++) {
    if (!e->needed[n] || ir_operation(e->graph, n) == IR_CONSTANT || !emit_is_uniform(e, n))
      continue;
    const char *text = arena_printf(u->memory, "uniforms[%d*UNIFORMS + %d]",
                                    u->neighbour < 0 ? 0 : u->neighbour, e->uniform_of[n]);
    c_text_add(e->out, "        const double %s = at_uniform_%d", e->name[n],
               number_of(u, &u->uniforms, text));
    emit_line_end(e, n);
  }
}

/* --- segments --------------------------------------------------------------------------------- */

static const char *result_name(emitter *e, const segment_root *r) {
  unrolled *u = e->unrolled;
  switch (r->target) {
  case TO_SLOT:
  case TO_SUM:
  case TO_LARGEST:
  case TO_SMALLEST:
    return arena_printf(u->memory, "at_slot_%d", r->index);
  case TO_PLANE:
    return arena_printf(u->memory, "at_plane_%d_%d", r->index, u->neighbour);
  default:
    return arena_printf(u->memory, "at_result_%d[q]",
                        number_of_written(e, &u->results, write_result_array, r));
  }
}

static void write_presence(emitter *e) {
  unrolled *u = e->unrolled;
  const char *array = arena_printf(u->memory, "family->bonds%s%s", e->words->far ? " + " : "",
                                   e->words->far ? e->words->to : "");
  c_text_add(e->out, "        const int64_t present = (at_bits_%d[q] & UINT64_C(1) << %s) != 0;\n",
             number_of(u, &u->words_of_bits, array), e->words->owned);
}

static family_words words_of(unrolled *u, int k, int half) {
  const bool far = k >= half;
  const char *link_to = arena_printf(u->memory, "family->link_offset[%d]", k);
  return (family_words){.first = "",
                        .k = arena_printf(u->memory, "%d", k),
                        .back = arena_printf(u->memory, "%d", far ? k - half : k + half),
                        .to = arena_printf(u->memory, "family->offset[%d]", k),
                        .link_to = link_to,
                        .owned = arena_printf(u->memory, "%d", far ? k - half : k),
                        .owner = far ? link_to : "0",
                        .far = far};
}

/* Bonds of one particle, line by line: a processor looks only so far ahead, and one bond's long chain of operations leaves
   it waiting where it does not see the next bond's. */
enum { ABREAST = 3 };

static void name_abreast(emitter *e, const char *const *plain, const char **name, int bond) {
  for (ir_node n = 0; n < e->node_count; n++)
    name[n] = plain[n] ? arena_printf(e->unrolled->memory, "at_%d_%s", bond, plain[n]) : NULL;
}

static void turn_to(emitter *e, int bond, const family_words *words, const char **name) {
  e->unrolled->neighbour = bond;
  e->words = words;
  e->name = name;
}

static void write_stores(emitter *e, const segment *a) {
  if (emit_asks_for_presence(a)) write_presence(e);
  for (int k = 0; k < a->root_count; k++)
    emit_family_store(e, &a->roots[k], result_name(e, &a->roots[k]));
}

static void write_abreast(emitter *e, const segment *a, int first, int count,
                          const family_words *words) {
  const char **plain = e->name, **name[ABREAST];
  c_text_add(e->out, "      {\n");
  for (int k = 0; k < count; k++) {
    name[k] = must_alloc(((size_t)e->node_count + 1) * sizeof *name[k]);
    name_abreast(e, plain, name[k], first + k);
    turn_to(e, first + k, &words[k], name[k]);
    write_uniforms(e);
  }
  for (ir_node n = 0; n < e->node_count; n++)
    for (int k = 0; k < count; k++) {
      turn_to(e, first + k, &words[k], name[k]);
      emit_line(e, n);
    }
  for (int k = 0; k < count; k++) {
    turn_to(e, first + k, &words[k], name[k]);
    c_text_add(e->out, "      {\n");
    write_stores(e, a);
    c_text_add(e->out, "      }\n");
    free(name[k]);
  }
  c_text_add(e->out, "      }\n");
  e->name = plain;
}

static void write_bonds(emitter *e, const segment *a, int half) {
  for (int first = 0; first < half; first += ABREAST) {
    family_words words[ABREAST];
    const int count = half - first < ABREAST ? half - first : ABREAST;
    for (int k = 0; k < count; k++)
      words[k] = words_of(e->unrolled, first + k, half);
    write_abreast(e, a, first, count, words);
  }
}

static void write_block(emitter *e, const segment *a, int neighbour, const family_words *words) {
  e->unrolled->neighbour = neighbour;
  e->words = words;
  c_text_add(e->out, "      {\n");
  write_uniforms(e);
  emit_lines(e);
  write_stores(e, a);
  c_text_add(e->out, "      }\n");
}

static void write_segment(emitter *e, const segment *a) {
  static const family_words own = {.first = ""};
  const int neighbours = e->plan->law->neighbours, half = neighbours / 2;
  emit_open_segment(e, a);
  for (int k = 0; k < a->root_count; k++)
    if (emit_is_reduction(&a->roots[k]))
      c_text_add(e->out, "      at_slot_%d = %s;\n", a->roots[k].index,
                 emit_reduction_start(&a->roots[k]));
  if (a->kind == OVER_PARTICLES)
    write_block(e, a, -1, &own);
  else if (a->kind == OVER_BONDS)
    write_bonds(e, a, half);
  else
    for (int k = 0; k < neighbours; k++) {
      const family_words words = words_of(e->unrolled, k, half);
      write_block(e, a, k, &words);
    }
  emit_close(e);
}

/* --- the pass --------------------------------------------------------------------------------- */

static void write_known(emitter *e, const known_texts *t, const char *type, const char *name) {
  for (int k = 0; k < t->count; k++)
    c_text_add(e->out, "  %s at_%s%d = %s;\n", type, name, k, t->text[k]);
}

static void write_variables(emitter *e, const family_pass *p, const unrolled *u) {
  for (int k = 0; k < u->arrays.count && e->plan->law->neighbours <= MOST_KEPT; k++)
    c_text_add(e->out, "    double at_read_%d;\n", k);
  for (int k = 0; k < p->slot_count; k++)
    c_text_add(e->out, "    double at_slot_%d;\n", k);
  for (int k = 0; k < p->plane_count; k++)
    for (int n = 0; n < e->plan->law->neighbours; n++)
      c_text_add(e->out, "    double at_plane_%d_%d;\n", k, n);
}

void emit_unrolled_pass(emitter *e, const family_pass *p) {
  unrolled u = {.memory = arena_new()};
  c_text *out = e->out, body = {0};
  e->unrolled = &u;
  e->out = &body;
  for (int k = 0; k < p->segment_count; k++)
    write_segment(e, &p->segments[k]);
  e->out = out;
  e->unrolled = NULL;
  write_known(e, &u.uniforms, "const double", "uniform_");
  write_known(e, &u.arrays, "const double *restrict", "");
  write_known(e, &u.words_of_bits, "const uint64_t *restrict", "bits_");
  write_known(e, &u.results, "double *restrict", "result_");
  c_text_add(out, "%s  PL_INDEPENDENT\n  for (long q = begin; q < end; q++) {\n", emit_rows_begin);
  write_variables(e, p, &u);
  c_text_add(out, "%s  }\n  }\n", body.text ? body.text : "");
  free(body.text);
  free(u.arrays.text);
  free(u.words_of_bits.text);
  free(u.results.text);
  free(u.uniforms.text);
  arena_free(u.memory);
}
