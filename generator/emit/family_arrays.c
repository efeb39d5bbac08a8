#include "generator/emit/family_arrays.h"

static const ends_origin *origin_of(const emitter *e, ir_node n) {
  return &ends_origins[ir_input_index(e->graph, n)];
}

bool family_is_list(const emitter *e) {
  return e->plan->law->irregular;
}

bool family_is_protection(const emitter *e, ir_node n) {
  return ir_input_source(e->graph, n) == IR_FROM_ENDS && origin_of(e, n)->array == FROM_HELD;
}

bool family_is_of_neighbour(const emitter *e, ir_node n) {
  switch (ir_input_source(e->graph, n)) {
  case IR_FROM_NEIGHBOUR_FIELD:
  case IR_FROM_NEIGHBOUR_PARAMETER:
  case IR_FROM_NEIGHBOUR_LINK:
  case IR_FROM_NEIGHBOUR_BOND_LINK:
    return true;
  case IR_FROM_ENDS:
    return origin_of(e, n)->owner == OF_J;
  default:
    return false;
  }
}

static bool is_of_particle(const emitter *e, int field) {
  return e->plan->law->fields.items[field]->place <= ON_PARTICLE;
}

/* A value that both ends of a bond share, in the plane of the bond's number at its owner. */
static const char *shared(const emitter *e, int index, const family_index *at, const char *number,
                          const char *owner) {
  const shared_place stands = program_shared_place(index);
  return spell(e, stands.upper ? SAY_SHARED_UPPER : SAY_SHARED_LOWER, numeral(e, stands.link),
               at->first, owner, number);
}

/* Of a particle's position, velocity, protection, volume, mass, share or size, or of bonds'
   chords. */
static word ends_word(ends_array from) {
  static const word words[] = {[FROM_DISPLACEMENT] = SAY_DISPLACEMENT,
                               [FROM_VELOCITY] = SAY_VELOCITY,
                               [FROM_CHORD] = SAY_CHORD,
                               [FROM_LENGTH] = SAY_LENGTH,
                               [FROM_VOLUME] = SAY_VOLUME,
                               [FROM_MASS] = SAY_MASS,
                               [FROM_SHARE] = SAY_SHARE,
                               [FROM_SIZE] = SAY_OWN_SIZE,
                               [FROM_HELD] = SAY_PROTECTED_PARTICLES};
  return words[from];
}

static const char *own_array(const emitter *e, ir_node n, const family_index *at) {
  const int index = ir_input_index(e->graph, n);
  const char *number = numeral(e, index);
  switch (ir_input_source(e->graph, n)) {
  case IR_FROM_FIELD:
    return spell(e, is_of_particle(e, index) ? SAY_OLD_FIELD : SAY_OLD_FIELD_TOWARD, number,
                 at->first, at->k);
  case IR_FROM_NEW_FIELD:
    return spell(e, SAY_NEW_FIELD_TOWARD, number, at->first, at->k);
  case IR_FROM_NEIGHBOUR_FIELD: /* of the neighbour, or toward me */
    return spell(e, ir_place(e->graph, n) != ON_BOND ? SAY_OLD_FIELD_TOWARD : SAY_OLD_FIELD, number,
                 at->first, at->back);
  case IR_FROM_BOND_PARAMETER:
    return spell(e, SAY_FAMILY_PARAMETER_TOWARD, number, at->first, at->k);
  case IR_FROM_PARTICLE_PARAMETER:
  case IR_FROM_NEIGHBOUR_PARAMETER:
    return spell(e, SAY_FAMILY_PARAMETER, number, at->first);
  case IR_FROM_LINK:
  case IR_FROM_NEIGHBOUR_LINK:
    return spell(e, SAY_LINK, number, at->first);
  case IR_FROM_BOND_LINK:
    return spell(e, SAY_BOND_LINK, number, at->first, at->k);
  case IR_FROM_NEIGHBOUR_BOND_LINK:
    return spell(e, SAY_BOND_LINK, number, at->first, at->back);
  case IR_FROM_SHARED:
  case IR_FROM_SHARED_ODD:
    return shared(e, index, at, at->owned, at->owner);
  case IR_FROM_SHAPE:
    return spell(e, SAY_SHAPE, number, at->first);
  case IR_FROM_SLOT:
    return spell(e, SAY_SLOT, number);
  case IR_FROM_PLANE:
    return spell(e, SAY_PLANE, number);
  default:
    return spell(e, ends_word(origin_of(e, n)->array), numeral(e, origin_of(e, n)->component),
                 at->first, at->k);
  }
}

const char *family_input_array(const emitter *e, ir_node n, const family_index *at) {
  const ir_source from = ir_input_source(e->graph, n);
  const bool link = from == IR_FROM_NEIGHBOUR_LINK || from == IR_FROM_NEIGHBOUR_BOND_LINK;
  const char *array = own_array(e, n, at);
  if (!at->to || !family_is_of_neighbour(e, n)) return array;
  return spell(e, SAY_FROM_THERE, array, link ? at->link_to : at->to);
}

const char *family_way_value(const emitter *e, ir_node n) {
  const ends_origin *o = origin_of(e, n);
  return o->array == FROM_LENGTH ? spell(e, SAY_WAY_LENGTH)
                                 : spell(e, SAY_WAY_CHORD, numeral(e, o->component));
}

const char *family_root_array(const emitter *e, const segment_root *r, const family_index *at) {
  static const struct {
    word own, toward;
  } words[] = {[TO_SLOT] = {.own = SAY_SLOT},
               [TO_SUM] = {.toward = SAY_SLOT},
               [TO_LARGEST] = {.toward = SAY_SLOT},
               [TO_SMALLEST] = {.toward = SAY_SLOT},
               [TO_FORCE] = {SAY_FORCE, SAY_FORCE_STATE},
               [TO_DISSIPATED_STATE] = {.own = SAY_LOST},
               [TO_DISSIPATED_RATE] = {.own = SAY_LOST},
               [TO_GIVEN_BY_REST] = {.own = SAY_LOST},
               [TO_LINK] = {SAY_LINK, SAY_BOND_LINK},
               [TO_FIELD] = {SAY_NEW_FIELD, SAY_NEW_FIELD_TOWARD},
               [TO_OBSERVED] = {SAY_OBSERVED, SAY_OBSERVED_TOWARD},
               [TO_PLANE] = {.toward = SAY_PLANE}};
  if (r->target == TO_SHARED) return shared(e, r->index, at, at->k, "0");
  const word array = r->over == OVER_PARTICLES ? words[r->target].own : words[r->target].toward;
  return spell(e, array, numeral(e, r->index), at->first, at->k);
}
