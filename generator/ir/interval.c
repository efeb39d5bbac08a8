#include "generator/ir/interval.h"

#include <math.h>

#include "dsl/base/elementary.h"

range range_between(double low, double high, bool low_open, bool high_open) {
  return (range){low, high, low_open || isinf(low), high_open || isinf(high)};
}

range range_of(double value) {
  return isnan(value) ? range_all() : range_between(value, value, false, false);
}

range range_all(void) {
  return range_between(-INFINITY, INFINITY, true, true);
}

/* --- ends ------------------------------------------------------------------------------------- */

typedef struct end {
  double at;
  bool open;
} end;

static end lower(end a, end b) {
  if (a.at == b.at) return (end){a.at, a.open && b.open};
  return a.at < b.at ? a : b;
}

static end upper(end a, end b) {
  if (a.at == b.at) return (end){a.at, a.open && b.open};
  return a.at > b.at ? a : b;
}

static range from_ends(end low, end high) {
  return range_between(low.at, high.at, low.open, high.open);
}

static end low_of(range a) {
  return (end){a.low, a.low_open};
}
static end high_of(range a) {
  return (end){a.high, a.high_open};
}

/* 0 times anything is 0, and reached when the 0 is. */
static end times(end a, end b) {
  if (a.at == 0 || b.at == 0) return (end){0, !((a.at == 0 && !a.open) || (b.at == 0 && !b.open))};
  return (end){a.at * b.at, a.open || b.open};
}

/* --- arithmetic ------------------------------------------------------------------------------- */

range range_join(range a, range b) {
  return from_ends(lower(low_of(a), low_of(b)), upper(high_of(a), high_of(b)));
}

static bool is_empty(range a) {
  return a.low > a.high || (a.low == a.high && (a.low_open || a.high_open));
}

range range_meet(range a, range b) {
  range c = {pl_fmax(a.low, b.low), pl_fmin(a.high, b.high), false, false};
  c.low_open = (a.low == c.low && a.low_open) || (b.low == c.low && b.low_open);
  c.high_open = (a.high == c.high && a.high_open) || (b.high == c.high && b.high_open);
  return is_empty(c) ? a : c;
}

range range_neg(range a) {
  return (range){-a.high, -a.low, a.high_open, a.low_open};
}

range range_add(range a, range b) {
  return range_between(a.low + b.low, a.high + b.high, a.low_open || b.low_open,
                       a.high_open || b.high_open);
}

range range_mul(range a, range b) {
  const end p[] = {times(low_of(a), low_of(b)), times(low_of(a), high_of(b)),
                   times(high_of(a), low_of(b)), times(high_of(a), high_of(b))};
  return from_ends(lower(lower(p[0], p[1]), lower(p[2], p[3])),
                   upper(upper(p[0], p[1]), upper(p[2], p[3])));
}

range range_square(range a) {
  range c = range_mul(a, a);
  end p = times(low_of(a), low_of(a)), q = times(high_of(a), high_of(a));
  if (range_holds(a, 0)) return from_ends((end){0, false}, high_of(c));
  return from_ends(lower(p, q), upper(p, q));
}

bool range_holds(range a, double value) {
  return (value > a.low || (value == a.low && !a.low_open)) &&
         (value < a.high || (value == a.high && !a.high_open));
}

bool range_is_positive(range a) {
  return a.low > 0 || (a.low == 0 && a.low_open);
}

bool range_is_nonnegative(range a) {
  return a.low >= 0;
}

static end inverse(end a, double side) {
  return a.at == 0 ? (end){copysign(INFINITY, side), true} : (end){1 / a.at, a.open};
}

range range_div(range a, range b) {
  if (!range_is_positive(b) && !range_is_positive(range_neg(b))) return range_all();
  double side = b.high > 0 ? 1 : -1;
  return range_mul(a, from_ends(inverse(high_of(b), side), inverse(low_of(b), side)));
}

/* --- other operations ------------------------------------------------------------------------- */

static range absolute(range a) {
  range m = range_neg(a);
  if (range_is_nonnegative(a)) return a;
  if (range_is_nonnegative(m)) return m;
  return from_ends((end){0, !range_holds(a, 0)}, upper(high_of(a), high_of(m)));
}

/* What a function can be of any numbers. */
static range image_of(ir_op op) {
  const operation_image *i = &operations[op].image;
  return range_between(i->low, i->high, i->open, i->open);
}

/* Of a rising function: it tends to the ends of its image and does not reach them. */
static range rising(ir_op op, range a) {
  const operation_image *i = &operations[op].image;
  double low = isinf(a.low) ? i->low : operation_value(op, a.low, 0, 0),
         high = isinf(a.high) ? i->high : operation_value(op, a.high, 0, 0);
  return range_between(low, high, a.low_open || low == i->low, a.high_open || high == i->high);
}

static range root_of(range a) {
  range b =
      range_between(pl_fmax(a.low, 0), pl_fmax(a.high, 0), a.low_open && a.low >= 0, a.high_open);
  return range_between(sqrt(b.low), sqrt(b.high), b.low_open, b.high_open);
}

static range logarithm_of(ir_op op, range a) {
  return range_between(a.low > 0 ? operation_value(op, a.low, 0, 0) : -INFINITY,
                       a.high > 0 ? operation_value(op, a.high, 0, 0) : INFINITY, a.low_open,
                       a.high_open);
}

/* asin rises and acos falls where they are defined, from -1 to 1. */
static range arc_of(ir_op op, range a) {
  const range b = range_meet(a, range_between(-1, 1, false, false));
  if (!(b.low <= b.high)) return image_of(op); /* nowhere */
  const end low = {operation_value(op, b.low, 0, 0), b.low_open},
            high = {operation_value(op, b.high, 0, 0), b.high_open};
  return op == IR_ASIN ? from_ends(low, high) : from_ends(high, low);
}

/* The hyperbolic cosine rises with the size of its argument. */
static range hyperbolic_cosine_of(range a) {
  const range b = absolute(a);
  return range_between(pl_cosh(b.low), pl_cosh(b.high), b.low_open, b.high_open);
}

/* Of a base that is not negative. */
static range power_of(range a, range b) {
  if (!range_is_nonnegative(a)) return range_all();
  bool positive = range_is_positive(a);
  if (isinf(a.high) || isinf(b.low) || isinf(b.high) || (a.low == 0 && b.low < 0)) {
    double low = b.low >= 0 && a.low >= 1 ? pl_pow(a.low, b.low) : 0;
    return range_between(low, INFINITY, positive && low == 0, true);
  }
  const double p[] = {pl_pow(a.low, b.low), pl_pow(a.low, b.high), pl_pow(a.high, b.low),
                      pl_pow(a.high, b.high)};
  double low = pl_fmin(pl_fmin(p[0], p[1]), pl_fmin(p[2], p[3])),
         high = pl_fmax(pl_fmax(p[0], p[1]), pl_fmax(p[2], p[3]));
  return range_between(low, high, low == 0 && positive, false);
}

static range extreme(range a, range b, bool most) {
  if (!most) return range_neg(extreme(range_neg(a), range_neg(b), true));
  range c = range_join(a, b);
  end low = a.low == b.low  ? (end){a.low, a.low_open && b.low_open}
            : a.low > b.low ? low_of(a)
                            : low_of(b);
  if (a.low == b.low && (a.low_open || b.low_open))
    low.open = true; /* the larger of the two reaches it only when both do */
  return from_ends(low, high_of(c));
}

static range sign_of(range a) {
  double low = range_is_positive(a) ? 1 : range_is_nonnegative(a) ? 0 : -1;
  range m = range_neg(a);
  double high = range_is_positive(m) ? -1 : range_is_nonnegative(m) ? 0 : 1;
  return range_between(low, high, false, false);
}

range range_apply(ir_op op, range a, range b) {
  switch (op) {
  case IR_ABS:
    return absolute(a);
  case IR_SQRT:
    return root_of(a);
  case IR_LOG:
  case IR_LOG10:
    return logarithm_of(op, a);
  case IR_ASIN:
  case IR_ACOS:
    return arc_of(op, a);
  case IR_COSH:
    return hyperbolic_cosine_of(a);
  case IR_POW:
    return power_of(a, b);
  case IR_MIN:
  case IR_MAX:
    return extreme(a, b, op == IR_MAX);
  case IR_SIGN:
    return sign_of(a);
  default:
    return operation_has(op, RISING) ? rising(op, a) : image_of(op);
  }
}
