#include "generator/emit/family_unrolled.h"

#include <stdlib.h>
#include <string.h>

#include "generator/emit/family_arrays.h"
#include "generator/emit/family_segment.h"

/* Texts that stand before the loop under a name. */
typedef struct known_texts {
  const char **text;
  int count, capacity;
} known_texts;

typedef struct unrolled {
  known_texts arrays, bits, results, uniforms;
  const family_index *at;
  int neighbour; /* of the block that is written; -1: of the particles */
} unrolled;

/* The text's number, as a piece. */
static const char *number_in(const emitter *e, known_texts *t, const char *text) {
  int k = 0;
  while (k < t->count && strcmp(t->text[k], text) != 0)
    k++;
  if (k == t->capacity) {
    t->capacity = 2 * t->capacity + 16;
    t->text = must_realloc(t->text, (size_t)t->capacity * sizeof *t->text);
  }
  if (k == t->count) t->text[t->count++] = text;
  return numeral(e, k);
}

/* --- inputs ----------------------------------------------------------------------------------- */

/* Of more neighbours no registers hold what was read: it is read again, as an operand. */
enum { MOST_KEPT = 8 };

static const char *input(emitter *e, ir_node n) {
  unrolled *u = e->form;
  const ir_source from = ir_input_source(e->graph, n);
  const char *index = numeral(e, ir_input_index(e->graph, n));
  if (from == IR_FROM_SLOT) return spell(e, SAY_SLOT_VARIABLE, index);
  if (from == IR_FROM_PLANE) return spell(e, SAY_PLANE_VARIABLE, index, numeral(e, u->neighbour));
  const char *array = family_input_array(e, n, u->at);
  if (family_is_protection(e, n))
    return spell(e, SAY_ANY_BIT,
                 spell(e, SAY_HERE, spell(e, SAY_BITS_ARRAY, number_in(e, &u->bits, array))));
  const int known = u->arrays.count;
  const char *number = number_in(e, &u->arrays, array);
  const word read = e->plan->law->neighbours > MOST_KEPT ? SAY_READ_HERE
                    : u->arrays.count == known           ? SAY_READ_AGAIN
                                                         : SAY_READ_FIRST;
  return spell(e, read, number, from == IR_FROM_SHARED_ODD && u->at->far ? "-" : "");
}

static void write_uniforms(emitter *e) {
  unrolled *u = e->form;
  const char *neighbour = numeral(e, u->neighbour < 0 ? 0 : u->neighbour);
  for (ir_node n = 0; n < e->node_count; n++) {
    if (e->needed[n] && expression_is_of_time(e, n)) {
      if (expression_is_input(e, n))
        say(e, SAY_LINE, "        ", e->name[n],
            expression_time(e, n, SAY_FAMILY_TIME_STEP, SAY_FAMILY_ADVANCE),
            spell(e, SAY_LINE_END));
      else
        expression_line_of_time(e, n, "        ");
    }
    if (!e->needed[n] || ir_operation(e->graph, n) == IR_CONSTANT || !expression_is_uniform(e, n))
      continue;
    const char *value = spell(e, SAY_UNIFORM_OF, numeral(e, e->uniform_of[n]), neighbour);
    say(e, SAY_LINE, "        ", e->name[n],
        spell(e, SAY_UNIFORM_VARIABLE, number_in(e, &u->uniforms, value)),
        expression_line_end(e, n));
  }
}

/* --- segments --------------------------------------------------------------------------------- */

static const char *result_name(emitter *e, const segment_root *r) {
  unrolled *u = e->form;
  const char *index = numeral(e, r->index);
  if (r->target == TO_SLOT || family_root_is_reduction(r))
    return spell(e, SAY_SLOT_VARIABLE, index);
  if (r->target == TO_PLANE) return spell(e, SAY_PLANE_VARIABLE, index, numeral(e, u->neighbour));
  return spell(e, SAY_RESULT_VARIABLE, number_in(e, &u->results, family_root_array(e, r, u->at)));
}

static void write_presence(emitter *e) {
  unrolled *u = e->form;
  const char *bonds = spell(e, SAY_BONDS);
  if (u->at->far) bonds = spell(e, SAY_FROM_THERE, bonds, u->at->to);
  say(e, SAY_PRESENT_BIT_OF, number_in(e, &u->bits, bonds), u->at->owned);
}

static family_index index_of(const emitter *e, int k, int half) {
  const bool far = k >= half;
  const char *number = numeral(e, k), *link_to = spell(e, SAY_LINK_OFFSET, number);
  return (family_index){.first = "",
                        .k = number,
                        .back = numeral(e, far ? k - half : k + half),
                        .to = spell(e, SAY_OFFSET, number),
                        .link_to = link_to,
                        .owned = numeral(e, far ? k - half : k),
                        .owner = far ? link_to : "0",
                        .far = far};
}

static void write_stores(emitter *e, const segment *a) {
  if (family_segment_asks(a)) write_presence(e);
  for (int k = 0; k < a->root_count; k++)
    family_store(e, &a->roots[k], result_name(e, &a->roots[k]), true);
}

static void turn_to(emitter *e, int neighbour, const family_index *at) {
  unrolled *u = e->form;
  u->neighbour = neighbour;
  u->at = at;
}

/* Bonds of one particle, line by line: a processor looks only so far ahead, and one bond's long
   chain of operations leaves it waiting where it does not see the next bond's. */
enum { ABREAST = 3 };

static const char **names_of(const emitter *e, int bond) {
  const char **name = must_calloc((size_t)e->node_count + 1, sizeof *name);
  for (ir_node n = 0; n < e->node_count; n++)
    if (e->name[n]) name[n] = spell(e, SAY_NAME_OF_BOND, numeral(e, bond), e->name[n]);
  return name;
}

static void write_abreast(emitter *e, const segment *a, int first, int count,
                          const family_index *at) {
  const char **plain = e->name, **name[ABREAST];
  say(e, SAY_BLOCK);
  for (int k = 0; k < count; k++) {
    e->name = plain;
    e->name = name[k] = names_of(e, first + k);
    turn_to(e, first + k, &at[k]);
    write_uniforms(e);
  }
  for (ir_node n = 0; n < e->node_count; n++)
    for (int k = 0; k < count; k++) {
      turn_to(e, first + k, &at[k]);
      e->name = name[k];
      expression_line(e, n);
    }
  for (int k = 0; k < count; k++) {
    turn_to(e, first + k, &at[k]);
    e->name = name[k];
    say(e, SAY_BLOCK);
    write_stores(e, a);
    say(e, SAY_END, "      ");
    free(name[k]);
  }
  say(e, SAY_END, "      ");
  e->name = plain;
}

static void write_bonds(emitter *e, const segment *a, int half) {
  for (int first = 0; first < half; first += ABREAST) {
    family_index at[ABREAST];
    const int count = half - first < ABREAST ? half - first : ABREAST;
    for (int k = 0; k < count; k++)
      at[k] = index_of(e, first + k, half);
    write_abreast(e, a, first, count, at);
  }
}

static void write_block(emitter *e, const segment *a, int neighbour, const family_index *at) {
  turn_to(e, neighbour, at);
  say(e, SAY_BLOCK);
  write_uniforms(e);
  expression_lines(e);
  write_stores(e, a);
  say(e, SAY_END, "      ");
}

static void write_neighbours(emitter *e, const segment *a, int neighbours) {
  for (int k = 0; k < neighbours; k++) {
    const family_index at = index_of(e, k, neighbours / 2);
    write_block(e, a, k, &at);
  }
}

static void write_segment(emitter *e, const segment *a) {
  static const scope of_particles = {.indent = "      ", .uniform = SAY_UNIFORM, .input = input},
                     of_neighbours = {.indent = "        ", .uniform = SAY_UNIFORM, .input = input};
  static const family_index own = {.first = ""};
  const int neighbours = e->plan->law->neighbours;
  expression_open_segment(e, a->kind == OVER_PARTICLES ? &of_particles : &of_neighbours, a);
  for (int k = 0; k < a->root_count; k++)
    if (family_root_is_reduction(&a->roots[k]))
      say(e, SAY_STORE, "      ", spell(e, SAY_SLOT_VARIABLE, numeral(e, a->roots[k].index)),
          family_reduction_start(e, &a->roots[k]));
  if (a->kind == OVER_PARTICLES)
    write_block(e, a, -1, &own);
  else if (a->kind == OVER_BONDS)
    write_bonds(e, a, neighbours / 2);
  else
    write_neighbours(e, a, neighbours);
  expression_close(e);
}

/* --- the pass --------------------------------------------------------------------------------- */

static void declare_known(emitter *e, known_texts *t, word type, word name) {
  for (int k = 0; k < t->count; k++)
    say(e, SAY_DECLARE, "  ", spell(e, type), spell(e, name, numeral(e, k)), t->text[k]);
  free(t->text);
}

static void declare_variables(emitter *e, const program_pass *p, int arrays) {
  for (int k = 0; k < arrays && e->plan->law->neighbours <= MOST_KEPT; k++)
    say(e, SAY_VARIABLE, spell(e, SAY_READ_VARIABLE, numeral(e, k)));
  for (int k = 0; k < p->slot_count; k++)
    say(e, SAY_VARIABLE, spell(e, SAY_SLOT_VARIABLE, numeral(e, k)));
  for (int k = 0; k < p->plane_count; k++)
    for (int n = 0; n < e->plan->law->neighbours; n++)
      say(e, SAY_VARIABLE, spell(e, SAY_PLANE_VARIABLE, numeral(e, k), numeral(e, n)));
}

void family_unrolled_pass(emitter *e, const program_pass *p) {
  unrolled u = {.neighbour = -1};
  c_text *out = e->out, body = {0};
  e->form = &u;
  e->out = &body;
  for (int k = 0; k < p->segment_count; k++)
    write_segment(e, &p->segments[k]);
  e->out = out;
  e->form = NULL;
  declare_known(e, &u.uniforms, SAY_VALUE, SAY_UNIFORM_VARIABLE);
  declare_known(e, &u.arrays, SAY_READ, SAY_ARRAY_VARIABLE);
  declare_known(e, &u.bits, SAY_READ_BITS, SAY_BITS_ARRAY);
  declare_known(e, &u.results, SAY_WRITTEN, SAY_RESULT_ARRAY_OF);
  say(e, SAY_OVER_ROWS);
  say(e, SAY_OVER_RUN);
  declare_variables(e, p, u.arrays.count);
  c_text_add(out, "%s", body.text ? body.text : "");
  say(e, SAY_END, "  ");
  say(e, SAY_END, "  ");
  free(body.text);
}
