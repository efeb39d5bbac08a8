#include "generator/intervals/interval_warning.h"

#include <stdlib.h>

enum { MOST_SEARCHES = 40, MOST_TRIES = 3 };

static int conditions_of(const context *c, interval_condition *out, int most) {
  int count = 0;
  for (; c && count < most; c = c->outer)
    if (c->guard != IR_NONE) out[count++] = (interval_condition){c->guard, c->truth};
  return count;
}

static span place_of(const analysis *a, ir_node n) {
  const lowered_text *t = &a->bench->law_step.text;
  for (int k = 0; k < t->place_count; k++)
    if (t->places[k].node == n) return t->places[k].where;
  for (ir_node at = n; at < a->nodes; at++) /* what it goes into stands behind it */
    if (ir_name(a->graph, at) && ir_where(a->graph, at).end > 0) return ir_where(a->graph, at);
  return a->law->tree->name_where;
}

bool interval_said_before(const analysis *a, diag_code code, span where) {
  for (int k = 0; k < a->said->count; k++) {
    const diagnostic *d = &a->said->items[k];
    if (d->code == code && d->where.file == where.file && d->where.begin == where.begin)
      return true;
  }
  return false;
}

void interval_warn(analysis *a, context *c, ir_node n, ir_node operand, interval_wish wish) {
  static const char *const what[] = {
      "this divides by zero", "this takes the root of a negative number",
      "this takes the logarithm of a number that is not positive",
      "this raises a negative number to a power that is not whole",
      "no angle has such a sine or cosine: the argument leaves [-1, 1]"};
  interval_condition conditions[32];
  diag_code code = wish == WISH_ZERO ? DIAG_DIVISION_BY_ZERO : DIAG_DOMAIN;
  span where = place_of(a, n);
  if (a->quiet || a->solved[n] || a->tried[n] == MOST_TRIES || a->searches == MOST_SEARCHES ||
      interval_said_before(a, code, where))
    return;
  a->tried[n]++;
  a->searches++;
  int count = conditions_of(c, conditions, 32);
  char *state = interval_witness(a->bench, a->fields, operand, wish, conditions, count);
  if (!state) return;
  diag_report(a->said, code, where, "%s in a state within the bounds", what[wish]);
  diag_note(a->said, (span){0, 0, UINT16_MAX}, "found at %s", state);
  diag_hint(a->said, "narrow the bounds of a parameter, or keep %s away by %s",
            wish == WISH_ZERO ? "the zero" : "such numbers",
            wish == WISH_BEYOND_ONE ? "`min(max(x, -1), 1)`" : "a case line or `max`");
  free(state);
}
