#include "generator/plan/program_mirror.h"

#include <assert.h>
#include <string.h>

#include "dsl/semantics/builtins.h"
#include "generator/lower/kinematics.h"

/* The same operation of other operands, with the name of the first. */
ir_node program_made_again(ir *g, ir_node n, const ir_node *operand) {
  ir_node made = ir_make(g, ir_operation(g, n), operand[0], operand[1], operand[2]);
  if (made != n && ir_name(g, n) && !is_leaf(g, made))
    ir_set_name(g, made, ir_name(g, n), ir_where(g, n));
  if (ir_is_expected(g, n)) ir_expect(g, made);
  return made;
}

/* n with its operands replaced by what `image` makes of them. */
static ir_node with_images(builder *b, ir_node n, ir_node (*image)(builder *, ir_node)) {
  ir_node operand[3] = {IR_NONE, IR_NONE, IR_NONE};
  bool changed = false;
  for (int k = 0; k < ir_arity(ir_operation(b->g, n)); k++) {
    ir_node old = ir_operand(b->g, n, k);
    operand[k] = image(b, old);
    changed = changed || operand[k] != old;
  }
  return changed ? program_made_again(b->g, n, operand) : n;
}

/* What a value toward a neighbour costs when it is computed again, in additions. */
int program_cost_again(const ir *g, ir_node n, int most) {
  if (is_leaf(g, n) || ir_is_uniform(g, n) || is_of_one_particle(g, n)) return 0;
  ir_op op = ir_operation(g, n);
  int cost = operations[op].weight;
  for (int k = 0; k < ir_arity(op) && cost < most; k++)
    cost += program_cost_again(g, ir_operand(g, n, k), most - cost);
  return cost;
}

/* --- what belongs to the neighbour ------------------------------------------------------------ */

/* Whether the value goes over a family, so that a neighbour cannot compute it again. */
bool program_goes_over_family(builder *b, ir_node n) {
  int known = map_get(&b->reduced, n);
  if (known >= 0) return known != 0;
  ir_op op = ir_operation(b->g, n);
  bool does = ir_is_reduction(op);
  for (int k = 0; k < ir_arity(op) && !does; k++)
    does = program_goes_over_family(b, ir_operand(b->g, n, k));
  map_set(&b->reduced, n, does);
  return does;
}

/* A number for the link of n, which some program may have left already. */
static int number_of(builder *b, ir_node n) {
  if (!is_of_one_particle(b->g, n)) return b->links.of_bonds++;
  for (int k = 0; k < b->links.left_count; k++)
    if (b->links.left[k] == n) return b->links.left_in[k];
  return b->links.of_particles++;
}

static int link_of(builder *b, ir_node n) {
  int known = map_get(&b->linked, n);
  if (known >= 0) return known;
  assert(b->link_count < MOST_LINKS);
  b->link[b->link_count] = n;
  b->link_number[b->link_count] = number_of(b, n);
  map_set(&b->linked, n, b->link_count);
  return b->link_count++;
}

/* What the link that an input reads from the neighbour holds. */
ir_node program_linked_node(const builder *b, ir_node input) {
  const bool of_particle = ir_input_source(b->g, input) == IR_FROM_NEIGHBOUR_LINK;
  int k = 0;
  while (b->link_number[k] != ir_input_index(b->g, input) ||
         is_of_one_particle(b->g, b->link[k]) != of_particle)
    k++;
  return b->link[k];
}

static const char *link_name(builder *b, int link) {
  const char *name = ir_name(b->g, b->link[link]);
  return name ? name : arena_printf(b->memory, "link_%d", link);
}

ir_node program_neighbour_link(builder *b, ir_node n) {
  int link = link_of(b, n);
  const char *name = arena_printf(b->memory, "%s_j", link_name(b, link));
  const bool of_particle = is_of_one_particle(b->g, n);
  return ir_input(b->g, of_particle ? IR_FROM_NEIGHBOUR_LINK : IR_FROM_NEIGHBOUR_BOND_LINK,
                  b->link_number[link], name, ON_NEIGHBOUR);
}

ir_node program_own_link(builder *b, ir_node n) {
  int link = link_of(b, n);
  const bool of_particle = is_of_one_particle(b->g, n);
  return ir_input(b->g, of_particle ? IR_FROM_LINK : IR_FROM_BOND_LINK, b->link_number[link],
                  link_name(b, link), of_particle ? ON_PARTICLE : ON_NEIGHBOUR);
}

/* What the ends of a bond exchange. */
static const ends_input exchanged[][2] = {
    {ENDS_U_IX, ENDS_U_JX},         {ENDS_U_IY, ENDS_U_JY},       {ENDS_U_IZ, ENDS_U_JZ},
    {ENDS_V_IX, ENDS_V_JX},         {ENDS_V_IY, ENDS_V_JY},       {ENDS_V_IZ, ENDS_V_JZ},
    {ENDS_PHI_I, ENDS_PHI_J},       {ENDS_OMEGA_I, ENDS_OMEGA_J}, {ENDS_PHI_IX, ENDS_PHI_JX},
    {ENDS_PHI_IY, ENDS_PHI_JY},     {ENDS_PHI_IZ, ENDS_PHI_JZ},   {ENDS_HELD_I, ENDS_HELD_J},
    {ENDS_VOLUME_I, ENDS_VOLUME_J}, {ENDS_MASS_I, ENDS_MASS_J},   {ENDS_SHARE_I, ENDS_SHARE_J},
    {ENDS_SIZE_I, ENDS_SIZE_J}};

static ir_node mirror_ends(builder *b, ir_node n) {
  switch ((ends_input)ir_input_index(b->g, n)) {
  case ENDS_CLASS_CHORD_X:
  case ENDS_CLASS_CHORD_Y:
  case ENDS_CLASS_CHORD_Z:
  case ENDS_CHORD_X:
  case ENDS_CHORD_Y:
  case ENDS_CHORD_Z:
    return ir_neg(b->g, n);
  default:
    break; /* the time step and lengths stay */
  }
  for (size_t k = 0; k < sizeof exchanged / sizeof *exchanged; k++)
    for (int end = 0; end < 2; end++)
      if ((int)exchanged[k][end] == ir_input_index(b->g, n))
        return kinematics_input(b->g, exchanged[k][!end]);
  return n;
}

static ir_node mirror_quantity(builder *b, ir_node n) {
  builtin_quantity q = (builtin_quantity)ir_input_index(b->g, n);
  if (q != QUANTITY_M_END_I && q != QUANTITY_M_END_J) return n;
  builtin_quantity other = q == QUANTITY_M_END_I ? QUANTITY_M_END_J : QUANTITY_M_END_I;
  return ir_input(b->g, IR_FROM_QUANTITY, (int)other, builtin_quantities[other].name, ON_BODY);
}

static const char *name_of_other(builder *b, ir_node n) {
  return arena_printf(b->memory, "%s_j", ir_name(b->g, n));
}

static const char *name_of_own(builder *b, ir_node n) {
  const char *name = ir_name(b->g, n);
  return arena_text(b->memory, name, strlen(name) - strlen("_j"));
}

/* Places of fields whose two sides were exchanged: ON_BOND for those of particles, which then can
   be told from values toward a neighbour. */
static ir_node mirror_input(builder *b, ir_node n) {
  ir *g = b->g;
  int index = ir_input_index(g, n);
  switch (ir_input_source(g, n)) {
  case IR_FROM_QUANTITY:
    return mirror_quantity(b, n);
  case IR_FROM_ENDS:
    return mirror_ends(b, n);
  case IR_FROM_FIELD:
    if (ir_place(g, n) == ON_BOND) return n; /* both sides keep the same value */
    return ir_input(g, IR_FROM_NEIGHBOUR_FIELD, index, name_of_other(b, n),
                    is_of_one_particle(g, n) ? ON_BOND : ON_NEIGHBOUR);
  case IR_FROM_NEIGHBOUR_FIELD:
    return ir_input(g, IR_FROM_FIELD, index, name_of_own(b, n),
                    ir_place(g, n) == ON_BOND ? ON_PARTICLE : ON_NEIGHBOUR);
  case IR_FROM_PARTICLE_PARAMETER:
    return ir_input(g, IR_FROM_NEIGHBOUR_PARAMETER, index, name_of_other(b, n), ON_BOND);
  case IR_FROM_NEIGHBOUR_PARAMETER:
    return ir_input(g, IR_FROM_PARTICLE_PARAMETER, index, name_of_own(b, n), ON_PARTICLE);
  case IR_FROM_NEIGHBOUR_LINK:
  case IR_FROM_NEIGHBOUR_BOND_LINK:
    return program_linked_node(b, n);
  case IR_FROM_SHARED_ODD:
    return ir_neg(g, n);
  case IR_FROM_SHAPE:
    return program_neighbour_link(b, n);
  default:
    return n;
  }
}

bool program_is_left(builder *b, ir_node n) {
  return is_of_one_particle(b->g, n) &&
         (program_goes_over_family(b, n) || map_get(&b->linked, n) >= 0);
}

ir_node program_mirror(builder *b, ir_node n) {
  int known = map_get(&b->mirrored, n);
  if (known >= 0) return known;
  ir_node image;
  if (ir_operation(b->g, n) == IR_CONSTANT)
    image = n;
  else if (is_leaf(b->g, n))
    image = mirror_input(b, n);
  else if (program_is_left(b, n))
    image = program_neighbour_link(b, n);
  else
    image = with_images(b, n, program_mirror);
  map_set(&b->mirrored, n, image);
  return image;
}

/* Whether the neighbour may have another value than the particle: not for what follows from the
   bond's own motion. */
static bool has_sides(builder *b, ir_node n) {
  int known = map_get(&b->sided, n);
  if (known >= 0) return known != 0;
  bool sided = is_of_one_particle(b->g, n);
  if (ir_operation(b->g, n) == IR_INPUT) sided = sided || mirror_input(b, n) != n;
  for (int k = 0; k < ir_arity(ir_operation(b->g, n)) && !sided; k++)
    sided = has_sides(b, ir_operand(b->g, n, k));
  map_set(&b->sided, n, sided);
  return sided;
}

/* A value toward a neighbour that costs more to compute on both sides than to keep: a store and two
   loads for each neighbour. The motion of the bond, which both sides need anyway, does not
   count. */
static bool is_dear(builder *b, ir_node n) {
  enum { DEAR = 30 };
  return !ir_is_uniform(b->g, n) && !is_of_one_particle(b->g, n) && has_sides(b, n) &&
         program_cost_again(b->g, n, DEAR) >= DEAR;
}

/* The value without IR_NEIGHBOUR. */
ir_node program_resolve(builder *b, ir_node n) {
  int known = map_get(&b->resolved, n);
  if (known >= 0) return known;
  ir_node image = n;
  if (ir_operation(b->g, n) == IR_NEIGHBOUR) {
    ir_node theirs = program_resolve(b, ir_operand(b->g, n, 0));
    const bool left = b->sharing != SHARE_LEAST && is_dear(b, theirs);
    image = left ? program_neighbour_link(b, theirs) : program_mirror(b, theirs);
  } else if (!is_leaf(b->g, n))
    image = with_images(b, n, program_resolve);
  map_set(&b->resolved, n, image);
  return image;
}

/* --- substitution ----------------------------------------------------------------------------- */

void program_substitute(builder *b, segment *wanted, const ir_node *from, const ir_node *to,
                        int pair_count) {
  const int root_count = wanted->root_count, count = root_count + b->link_count;
  ir_node *all = must_alloc(((size_t)count + 1) * sizeof *all);
  for (int k = 0; k < root_count; k++)
    all[k] = wanted->roots[k].node;
  for (int k = 0; k < b->link_count; k++)
    all[root_count + k] = b->link[k];
  ir_substitute(b->g, all, count, from, to, pair_count, all);
  map_clear(&b->linked);
  map_clear(&b->mirrored);
  map_clear(&b->reduced);
  segment_replace(wanted, all);
  for (int k = 0; k < b->link_count; k++) {
    b->link[k] = all[root_count + k];
    map_set(&b->linked, b->link[k], k);
  }
  free(all);
}
