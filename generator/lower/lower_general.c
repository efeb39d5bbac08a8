#include "generator/lower/lower_general.h"

enum { AXES = VECTOR_COMPONENT_COUNT };

int general_place(int row, int column) {
  static const int places[AXES][AXES] = {{0, 3, 5}, {6, 1, 4}, {8, 7, 2}};
  return places[row][column];
}

/* Of a tensor of six or nine components. */
static ir_node entry(const components *a, int row, int column) {
  const int at = general_place(row, column);
  return a->of[a->count == GENERAL_COUNT ? at : symmetric_component(at)];
}

components general_of(ir *g, components a) {
  components v = {.count = GENERAL_COUNT};
  for (int r = 0; r < AXES; r++)
    for (int c = 0; c < AXES; c++)
      v.of[general_place(r, c)] = a.count == 1 ? ir_constant(g, 0) : entry(&a, r, c);
  return v;
}

components general_transpose(components a) {
  components v = a;
  for (int r = 0; r < AXES && a.count == GENERAL_COUNT; r++)
    for (int c = 0; c < AXES; c++)
      v.of[general_place(r, c)] = entry(&a, c, r);
  return v;
}

components general_symmetric(ir *g, components a) {
  components v = {.count = TENSOR_COUNT};
  if (a.count == TENSOR_COUNT) return a;
  for (int k = 0; k < TENSOR_COUNT; k++)
    v.of[k] = a.of[k];
  for (int k = TENSOR_XY; k < TENSOR_COUNT; k++)
    v.of[k] = half(g, ir_add(g, a.of[k], a.of[k + 3]));
  return v;
}

/* Row r of a with column c of b, or with a vector. */
static ir_node inner(ir *g, const components *a, const components *b, int r, int c) {
  ir_node sum = ir_constant(g, 0);
  for (int k = 0; k < AXES; k++) {
    const ir_node other = b->count == AXES ? b->of[k] : entry(b, k, c);
    sum = ir_add(g, sum, product(g, entry(a, r, k), other));
  }
  return sum;
}

components general_product(ir *g, components a, components b) {
  components v = {.count = b.count == AXES ? AXES : GENERAL_COUNT};
  for (int r = 0; r < AXES; r++)
    for (int c = 0; c < AXES; c++) {
      if (b.count == AXES && c > 0) continue;
      v.of[b.count == AXES ? r : general_place(r, c)] = inner(g, &a, &b, r, c);
    }
  return v;
}

ir_node general_contract(ir *g, components a, components b) {
  ir_node sum = ir_constant(g, 0);
  for (int r = 0; r < AXES; r++)
    for (int c = 0; c < AXES; c++)
      sum = ir_add(g, sum, product(g, entry(&a, r, c), entry(&b, r, c)));
  return sum;
}

/* The axes behind the row's and the column's take turns, so that the sign is right. */
ir_node general_cofactor(ir *g, const components *a, int r, int c) {
  const int r1 = (r + 1) % AXES, r2 = (r + 2) % AXES, c1 = (c + 1) % AXES, c2 = (c + 2) % AXES;
  const ir_node less = product(g, entry(a, r1, c2), entry(a, r2, c1));
  return ir_sub(g, product(g, entry(a, r1, c1), entry(a, r2, c2)), less);
}

ir_node general_determinant(ir *g, components a) {
  ir_node sum = ir_constant(g, 0);
  for (int c = 0; c < AXES; c++)
    sum = ir_add(g, sum, product(g, entry(&a, 0, c), general_cofactor(g, &a, 0, c)));
  return sum;
}

/* Does not leave the plane. */
static bool is_of_plane(const ir *g, const components *a) {
  bool of = true;
  for (int k = 0; k < 2; k++)
    of = of && ir_is_number(g, entry(a, 2, k), 0) && ir_is_number(g, entry(a, k, 2), 0);
  return of;
}

/* (c, s) along (xx + yy, yx - xy). */
static components rotation_in_plane(ir *g, const components *F) {
  const ir_node c = ir_add(g, entry(F, 0, 0), entry(F, 1, 1)),
                s = ir_sub(g, entry(F, 1, 0), entry(F, 0, 1)), square = ir_mul(g, s, s);
  const ir_node size = ir_unary(g, IR_SQRT, ir_add(g, ir_mul(g, c, c), square));
  components R = {.count = GENERAL_COUNT};
  for (int k = 0; k < GENERAL_COUNT; k++)
    R.of[k] = ir_constant(g, k == TENSOR_ZZ);
  R.of[general_place(0, 0)] = R.of[general_place(1, 1)] = ir_div(g, c, size);
  R.of[general_place(1, 0)] = ir_div(g, s, size);
  R.of[general_place(0, 1)] = ir_neg(g, R.of[general_place(1, 0)]);
  return R;
}

components general_rotation(ir *g, components F) {
  components R = general_of(g, F);
  if (is_of_plane(g, &R)) return rotation_in_plane(g, &R);
  for (int n = 0; n < GENERAL_TURNS; n++) {
    const components other = general_transpose(general_inverse(g, R));
    for (int k = 0; k < GENERAL_COUNT; k++)
      R.of[k] = half(g, ir_add(g, R.of[k], other.of[k]));
  }
  return R;
}

components general_inverse(ir *g, components a) {
  const ir_node determinant = general_determinant(g, a);
  components v = {.count = a.count};
  for (int r = 0; r < AXES; r++)
    for (int c = 0; c < AXES; c++) {
      const int at = general_place(r, c);
      if (at >= v.count) continue;
      const ir_node over = general_cofactor(g, &a, c, r);
      v.of[at] = ir_is_number(g, over, 0) ? over : ir_div(g, over, determinant);
    }
  return v;
}
