#include "generator/intervals/interval_sums.h"

#include <math.h>

enum { DEEPEST = 24, MOST_VISITS = 300 /* of one sum: a graph can unfold to any size */ };

static sum one_factor(ir_node n) {
  return (sum){1, {{1, 1, {n}}}};
}

static sum number(double value) {
  sum s = {0};
  if (value != 0) {
    s.count = 1;
    s.term[0] = (sum_term){.coefficient = value};
  }
  return s;
}

bool sum_same_factors(const sum_term *a, const sum_term *b) {
  if (a->count != b->count) return false;
  for (int k = 0; k < a->count; k++)
    if (a->factor[k] != b->factor[k]) return false;
  return true;
}

static bool add_term(sum *s, sum_term t) {
  for (int k = 0; k < s->count; k++) {
    if (!sum_same_factors(&s->term[k], &t)) continue;
    s->term[k].coefficient += t.coefficient;
    if (s->term[k].coefficient == 0) s->term[k] = s->term[--s->count];
    return true;
  }
  if (s->count == SUM_TERMS) return false;
  s->term[s->count++] = t;
  return true;
}

bool sum_combine(const sum *a, double k, const sum *b, sum *out) {
  sum s = *a;
  for (int q = 0; q < b->count; q++) {
    sum_term t = b->term[q];
    t.coefficient *= k;
    if (!add_term(&s, t)) return false;
  }
  *out = s;
  return true;
}

static bool multiply_terms(const sum_term *a, const sum_term *b, sum_term *out) {
  sum_term t = {.coefficient = a->coefficient * b->coefficient};
  if (a->count + b->count > SUM_FACTORS) return false;
  for (int p = 0, q = 0; p < a->count || q < b->count;) {
    bool first = q == b->count || (p < a->count && a->factor[p] <= b->factor[q]);
    t.factor[t.count++] = first ? a->factor[p++] : b->factor[q++];
  }
  *out = t;
  return true;
}

static bool multiply(const sum *a, const sum *b, sum *out) {
  sum s = {0};
  for (int p = 0; p < a->count; p++)
    for (int q = 0; q < b->count; q++) {
      sum_term t;
      if (!multiply_terms(&a->term[p], &b->term[q], &t) || !add_term(&s, t)) return false;
    }
  *out = s;
  return true;
}

static sum expand(const ir *g, ir_node n, int depth, int *visits) {
  ir_op op = ir_operation(g, n);
  if (op == IR_CONSTANT && isfinite(ir_value(g, n))) return number(ir_value(g, n));
  if (depth == DEEPEST || ++*visits > MOST_VISITS ||
      (op != IR_ADD && op != IR_SUB && op != IR_MUL && op != IR_NEG && op != IR_DIV))
    return one_factor(n);
  sum a = expand(g, ir_operand(g, n, 0), depth + 1, visits), out, none = {0};
  if (op == IR_NEG) return sum_combine(&none, -1, &a, &out) ? out : one_factor(n);
  sum b = expand(g, ir_operand(g, n, 1), depth + 1, visits);
  bool fits;
  if (op == IR_MUL)
    fits = multiply(&a, &b, &out);
  else if (op == IR_DIV) /* by a number only */
    fits = b.count == 1 && b.term[0].count == 0 &&
           sum_combine(&none, 1 / b.term[0].coefficient, &a, &out);
  else
    fits = sum_combine(&a, op == IR_ADD ? 1 : -1, &b, &out);
  return fits ? out : one_factor(n);
}

sum sum_of(const ir *g, ir_node n) {
  int visits = 0;
  return expand(g, n, 0, &visits);
}

bool sum_replace(const sum *a, int which, const sum *b, sum *out) {
  sum rest = *a;
  double k = a->term[which].coefficient;
  rest.term[which] = rest.term[--rest.count];
  return sum_combine(&rest, k, b, out);
}

static bool has_factor(const sum_term *t, ir_node n, int *at) {
  for (int k = 0; k < t->count; k++)
    if (t->factor[k] == n) {
      *at = k;
      return true;
    }
  return false;
}

ir_node sum_take_factor(sum *a) {
  int at = 0;
  for (int k = 0; a->count > 1 && k < a->term[0].count; k++) {
    ir_node n = a->term[0].factor[k];
    bool shared = true;
    for (int q = 1; q < a->count && shared; q++)
      shared = has_factor(&a->term[q], n, &at);
    for (int q = 0; q < a->count && shared; q++) {
      sum_term *t = &a->term[q];
      has_factor(t, n, &at);
      t->count--;
      for (int f = at; f < t->count; f++)
        t->factor[f] = t->factor[f + 1];
    }
    if (shared) return n;
  }
  return IR_NONE;
}

bool sum_is_multiple(const sum *a, const sum *b) {
  double k = 0;
  if (a->count != b->count || a->count == 0) return false;
  for (int p = 0; p < a->count; p++) {
    int q = 0;
    while (q < b->count && !sum_same_factors(&a->term[p], &b->term[q]))
      q++;
    if (q == b->count) return false;
    double ratio = a->term[p].coefficient / b->term[q].coefficient;
    if (p > 0 && fabs(ratio - k) > 1e-12 * fabs(k)) return false;
    k = ratio;
  }
  return true;
}
