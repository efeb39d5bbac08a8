#include "generator/sense/sense_memory.h"

#include <math.h>
#include <stdlib.h>

#include "dsl/base/arena.h"
#include "generator/ir/rewrite.h"
#include "generator/lower/lower_inputs.h"

static const double COARSE = 0.01; /* of the work of all steps */
static const double SETTLED = 0.1; /* of a gain, with other steps */

/* --- in words --------------------------------------------------------------------------------- */

static const char *body_of(const sense_bench *b) {
  return b->law->tree->law == LAW_CONTINUUM ? "point" : "bond";
}

static const char *force_of(const sense_bench *b) {
  return b->law->tree->law == LAW_CONTINUUM ? "stress" : "force";
}

static const symbol *whole(const symbol *field) {
  return field->component_of ? field->component_of : field;
}

static const char *kind_of(const symbol *s) {
  return s->kind == SYMBOL_DAMAGE ? "damage" : "state";
}

/* --- states ----------------------------------------------------------------------------------- */

void sense_say_never_moves(sense_bench *b, const symbol *field) {
  const symbol *s = whole(field);
  sense_say(b, DIAG_ELASTIC, s->rule ? s->rule->where : s->where,
            "look at its guards and limits, and at their units",
            "the %s `%s` never moves, whatever a %s undergoes: this law is as if it had none",
            kind_of(s), s->name, body_of(b));
}

static bool is_called_unused(const sense_bench *b, const symbol *s) {
  for (int k = 0; k < b->said->count; k++) {
    const diagnostic *d = &b->said->items[k];
    if (d->code == DIAG_UNUSED && d->where.file == s->where.file &&
        d->where.begin == s->where.begin)
      return true;
  }
  return false;
}

void sense_say_without_effect(sense_bench *b, const symbol *field, const char *mend) {
  const symbol *s = whole(field);
  if (is_called_unused(b, s)) return;
  sense_say(b, DIAG_ELASTIC, s->rule ? s->rule->where : s->where, mend,
            "the %s `%s` never changes what this law answers: without it the %s does the same",
            kind_of(s), s->name, body_of(b));
}

/* --- forces that are not those of the states -------------------------------------------------- */

static bool reads(const ir *g, const ir_node *forces, int count, ir_node what) {
  bool found = false;
  for (int k = 0; k < count; k++)
    found = found || (forces[k] != IR_NONE && rewrite_depends(g, &forces[k], 1, &what, 1));
  return found;
}

sense_reads sense_forces_read(ir *g, const law *l, const ir_node *forces, int count,
                              const ir_node *new_fields) {
  const int fields = l->fields.count;
  ir_node *held = must_alloc(((size_t)count + 1) * sizeof *held),
          *from = must_alloc(((size_t)fields + 1) * sizeof *from),
          *to = must_alloc(((size_t)fields + 1) * sizeof *to);
  for (int k = 0; k < fields; k++) {
    from[k] = new_fields[k];
    to[k] = ir_input(g, IR_FROM_FIELD, 4 * fields + k, "new", ON_BOND);
  }
  for (int k = 0; k < count; k++) {
    held[k] = forces[k];
    if (held[k] != IR_NONE) ir_substitute(g, &held[k], 1, from, to, fields, &held[k]);
  }
  sense_reads found = {.dt = reads(g, held, count, lower_advance(g, l))};
  for (int k = 0; k < fields; k++)
    found.old = found.old || reads(g, held, count, lower_field(g, l, k));
  free(held);
  free(from);
  free(to);
  return found;
}

void sense_say_reads_dt(sense_bench *b) {
  sense_say(b, DIAG_STEP_DEPENDENT, sense_force(b->law),
            "let a state keep what goes on in time, by its `rate` or as in "
            "`age = previous(age) + dt`",
            "the %s reads `dt`: with the same states and at the same motion it is another one "
            "after a longer step",
            force_of(b));
}

void sense_hold(sense_held *h, bool moved, bool another) {
  h->settled++;
  h->changed += another;
  h->moved += moved;
  h->late += moved && another;
}

/* A force that reads dt and old states may be that of a rate, as in `(v - previous(v))/dt`. */
void sense_say_held(sense_bench *b, const sense_held *h, sense_reads forces) {
  enum { FEW = 8 };
  if (forces.dt && !forces.old && h->changed >= FEW) sense_say_reads_dt(b);
  if (forces.dt || h->late < FEW || h->late * 4 < h->moved) return;
  sense_say(b, DIAG_ONE_STEP_LATE, sense_force(b->law),
            "write it below the rules of what it reads, without `previous` and without names from "
            "above them",
            "the %s is a step late: held where it is, a %s has another %s in the next step, though "
            "its states are the same",
            force_of(b), body_of(b), force_of(b));
}

/* --- energies --------------------------------------------------------------------------------- */

void sense_lose(sense_losses *l, double work, double lost) {
  l->work += fabs(work);
  if (lost < 0) l->gained -= lost;
}

bool sense_gains(const sense_losses *l) {
  return isfinite(l->work) && l->gained > COARSE * l->work;
}

bool sense_say_losses(sense_bench *b, const sense_losses *l, const sense_losses *finer,
                      const char *way, const char *mend) {
  const double share = l->gained / l->work, other = finer->gained / finer->work;
  if (!sense_gains(l) || !(fabs(other - share) <= SETTLED * share)) return false;
  sense_say(b, DIAG_LOCKED_ENERGY, b->law->results[RESULT_W]->rule->where, mend,
            "%s and back, a %s gives back %.3g of the work more than its energy `W` had left: `W` "
            "lacks what the states store",
            way, body_of(b), share);
  return true;
}
