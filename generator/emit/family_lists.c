#include "generator/emit/family_lists.h"

#include <stdlib.h>

#include "generator/emit/family_arrays.h"
#include "generator/emit/family_loops.h"
#include "generator/emit/family_segment.h"

typedef struct list_form {
  unsigned char *along; /* [nodes] follows from the way to the neighbour alone */
  bool alike;           /* the loop that is written is that of particles that are alike */
} list_form;

static const family_index by_list = {.first = " + first", .k = "k", .back = "back"},
                          by_way = {.first = " + first",
                                    .k = "k",
                                    .back = "back",
                                    .to = "way->to",
                                    .link_to = "way->to"};

void family_lists_functions(emitter *e) {
  if (family_is_list(e)) say(e, SAY_LIST_FUNCTIONS);
}

/* --- what follows from the way alone ---------------------------------------------------------- */

/* The only root that writes the plane; NULL where there are more. */
static const segment_root *writer_of_plane(const program_pass *p, int plane) {
  const segment_root *found = NULL;
  for (int s = 0; s < p->segment_count; s++)
    for (int k = 0; k < p->segments[s].root_count; k++) {
      const segment_root *r = &p->segments[s].roots[k];
      if (r->target != TO_PLANE || r->index != plane) continue;
      if (found) return NULL;
      found = r;
    }
  return found;
}

static bool is_of_way(const emitter *e, ir_node n) {
  return ir_operation(e->graph, n) == IR_INPUT && ir_input_source(e->graph, n) == IR_FROM_ENDS &&
         (ends_origins[ir_input_index(e->graph, n)].array == FROM_CHORD ||
          ends_origins[ir_input_index(e->graph, n)].array == FROM_LENGTH);
}

static bool is_plane(const emitter *e, ir_node n) {
  return ir_operation(e->graph, n) == IR_INPUT && ir_input_source(e->graph, n) == IR_FROM_PLANE;
}

static bool follows(const emitter *e, const program_pass *p, const unsigned char *along,
                    ir_node n) {
  const ir_op op = ir_operation(e->graph, n);
  if (op == IR_CONSTANT || e->uniform_of[n] >= 0 || is_of_way(e, n)) return true;
  if (is_plane(e, n)) {
    const segment_root *r = writer_of_plane(p, ir_input_index(e->graph, n));
    return r && r->node < n && along[r->node];
  }
  if (op == IR_INPUT || op == IR_SEARCH) return false;
  for (int k = 0; k < ir_arity(op); k++)
    if (!along[ir_operand(e->graph, n, k)]) return false;
  return true;
}

void family_lists_begin(emitter *e, const program_pass *p) {
  list_form *f = must_calloc(1, sizeof *f);
  f->along = must_calloc((size_t)e->node_count + 1, 1);
  for (ir_node n = 0; n < e->node_count; n++)
    f->along[n] = follows(e, p, f->along, n);
  e->form = f;
}

void family_lists_end(emitter *e) {
  list_form *f = e->form;
  free(f->along);
  free(f);
  e->form = NULL;
}

/* --- inputs ----------------------------------------------------------------------------------- */

static void declare(emitter *e, ir_node n) {
  const list_form *f = e->form;
  if (expression_is_of_time(e, n)) {
    family_loops_declare(e, n);
    return;
  }
  const bool of_way = f->alike && is_of_way(e, n);
  const char *from =
      of_way ? family_way_value(e, n) : family_input_array(e, n, f->alike ? &by_way : &by_list);
  say(e, SAY_DECLARE, e->scope->before,
      spell(e, of_way                       ? SAY_VALUE
               : family_is_protection(e, n) ? SAY_READ_BITS
                                            : SAY_READ),
      spell(e, SAY_INPUT_ARRAY, e->name[n]), from);
}

static const char *input(emitter *e, ir_node n) {
  const list_form *f = e->form;
  const char *array = spell(e, SAY_INPUT_ARRAY, e->name[n]);
  if (f->alike && is_of_way(e, n)) return array;
  if (f->alike && f->along[n]) return spell(e, SAY_AT_FROM, array);
  const bool listed = !f->alike && family_is_of_neighbour(e, n);
  const char *value = spell(e, listed ? SAY_OF_LISTED : SAY_HERE, array);
  return family_is_protection(e, n) ? spell(e, SAY_ANY_BIT, value) : value;
}

/* --- loops ------------------------------------------------------------------------------------ */

static const scope inside = {.before = "      ",
                             .indent = "        ",
                             .uniform = SAY_UNIFORM,
                             .declare = declare,
                             .input = input},
                   in_front = {.before = "      ",
                               .indent = "      ",
                               .uniform = SAY_UNIFORM,
                               .declare = declare,
                               .input = input};

/* Whether it matters for the segment that particles are alike. */
static bool goes_by_way(const emitter *e) {
  const list_form *f = e->form;
  for (ir_node n = 0; n < e->node_count; n++)
    if (e->needed[n] && expression_is_input(e, n) && (family_is_of_neighbour(e, n) || f->along[n]))
      return true;
  return false;
}

static bool stands_in_front(const emitter *e, const segment_root *r) {
  const list_form *f = e->form;
  return f->alike && r->target == TO_PLANE && f->along[r->node];
}

static void write_lines(emitter *e, bool along) {
  const list_form *f = e->form;
  for (int k = 0; k < e->node_count; k++) {
    const ir_node n = expression_in_order(e, k);
    if ((f->alike && f->along[n]) == along) expression_line(e, n);
  }
}

static void write_stores(emitter *e, const segment *a, bool front) {
  for (int k = 0; k < a->root_count; k++) {
    const char *to = spell(e, SAY_ROOT_ARRAY, numeral(e, k));
    if (stands_in_front(e, &a->roots[k]) == front)
      family_store(e, &a->roots[k], spell(e, front ? SAY_AT_FROM : SAY_HERE, to), false);
  }
}

static void write_loop(emitter *e, const segment *a, bool alike) {
  list_form *f = e->form;
  f->alike = alike;
  e->scope = &in_front;
  expression_declare(e);
  for (int k = 0; k < a->root_count; k++)
    say(e, SAY_DECLARE, "      ", spell(e, SAY_WRITTEN), spell(e, SAY_ROOT_ARRAY, numeral(e, k)),
        family_root_array(e, &a->roots[k], &by_list));
  write_lines(e, true);
  write_stores(e, a, true);
  e->scope = &inside;
  say(e, SAY_OVER_SPAN);
  write_lines(e, false);
  if (family_segment_asks(a)) say(e, SAY_PRESENT_BY_BIT);
  write_stores(e, a, false);
  say(e, SAY_END, "      ");
  f->alike = false;
}

/* Where no particle has such a neighbour what is kept of it beyond the pass is 0. */
static void skip_absent(emitter *e, const segment *a, word zeros) {
  for (int k = 0; k < a->root_count; k++)
    if (segment_asks(&a->roots[k]) && !family_root_is_reduction(&a->roots[k]) &&
        !segment_is_loss(&a->roots[k]))
      say(e, zeros, numeral(e, k), family_root_array(e, &a->roots[k], &by_list));
  say(e, SAY_NEXT_NEIGHBOUR);
}

/* What the next chunk reads and writes of bonds comes on its way: too many planes for processors to
   foresee it. */
static void fetch_next(emitter *e, const segment *a) {
  for (ir_node n = 0; n < e->node_count; n++)
    if (e->needed[n] && expression_is_input(e, n) && ir_place(e->graph, n) > ON_PARTICLE &&
        (ir_input_source(e->graph, n) == IR_FROM_FIELD ||
         ir_input_source(e->graph, n) == IR_FROM_BOND_LINK))
      say(e, SAY_FETCH_NEXT, family_input_array(e, n, &by_list), "0");
  for (int k = 0; k < a->root_count; k++)
    if (a->roots[k].target == TO_LINK || a->roots[k].target == TO_FIELD)
      say(e, SAY_FETCH_NEXT, family_root_array(e, &a->roots[k], &by_list), "1");
}

static void write_spans(emitter *e, const segment *a) {
  fetch_next(e, a);
  if (!goes_by_way(e)) {
    say(e, SAY_ONE_SPAN);
    write_loop(e, a, false);
    say(e, SAY_END, "      ");
    return;
  }
  say(e, SAY_OVER_SPANS);
  skip_absent(e, a, SAY_ZEROS_OF_SPAN);
  say(e, SAY_IF_ALIKE);
  write_loop(e, a, true);
  say(e, SAY_ELSE);
  write_loop(e, a, false);
  say(e, SAY_END, "      ");
  say(e, SAY_END, "      ");
}

void family_lists_neighbours(emitter *e, const segment *a) {
  expression_open_segment(e, &inside, a);
  family_loops_start(e, a);
  say(e, a->kind == OVER_BONDS ? SAY_OVER_OWNED : SAY_OVER_NEIGHBOURS);
  say(e, SAY_UNLESS_SOME);
  skip_absent(e, a, SAY_ZEROS);
  say(e, SAY_WAY_OF_LIST);
  if (family_segment_asks(a)) say(e, SAY_BONDS_OF_LIST);
  write_spans(e, a);
  say(e, SAY_END, "    ");
  expression_close(e);
}
