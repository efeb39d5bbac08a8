#include "generator/study/study_converge.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

#include "dsl/base/elementary.h"
#include "dsl/base/units.h"
#include "generator/study/convergence.h"

/* --- what is asked ---------------------------------------------------------------------------- */

static double size_of(const char *text) {
  double number = NAN;
  const char *symbol_text, *bad;
  size_t length;
  unit u = {.factor = 1};
  if (!study_split_number(text, &number, &symbol_text)) return NAN;
  if (*symbol_text && !unit_parse(symbol_text, strlen(symbol_text), &u, &bad, &length)) return NAN;
  return number * u.factor;
}

static int refuse(study_request *r, span where, const char *sentence) {
  diag_report(&r->said, DIAG_BAD_VALUE, where, "`%s` %s", r->converge.text, sentence);
  diag_hint(&r->said, "%s names one of the keys of %s, whose values could go to 0",
            study_word(r, "converge"), study_word(r, "vary"));
  return -1;
}

static bool has_sizes(const study_axis *axis, const study_key *key) {
  bool sizes = true;
  for (int k = 0; k < axis->count; k++)
    sizes = sizes && fabs(size_of(key->values[k])) > 0;
  return sizes;
}

/* Order and limit come from three. */
static bool has_three(study_request *r, const study_axis *axis, const study_key *key) {
  int sizes = 0;
  for (int k = 0; k < axis->count; k++) {
    bool new = true;
    for (int before = 0; before < k; before++)
      new = new &&fabs(size_of(key->values[before])) != fabs(size_of(key->values[k]));
    sizes += new;
  }
  if (sizes >= 3) return true;
  diag_report(&r->said, DIAG_BAD_VALUE, key->where,
              "order and limit need three sizes or more; `%s` has %d", key->name, sizes);
  diag_hint(&r->said, "say more, best in one ratio, such as half the smallest");
  return false;
}

int study_converge_key(study_request *r, const study_axis *axes, int axis_count) {
  int found = -1, at = 0;
  for (int a = 0; a < axis_count; a++)
    for (int k = 0; k < axes[a].key_count; k++, at++) {
      const study_key *key = &axes[a].keys[k];
      if (!study_key_is(key, r->converge.text)) continue;
      if (found >= 0)
        return refuse(r, r->converge.where, "may be two of the keys; name it in full");
      if (!has_sizes(&axes[a], key)) return refuse(r, key->where, "has a value that is no size");
      if (!has_three(r, &axes[a], key)) return -1;
      found = at;
    }
  return found < 0 ? refuse(r, r->converge.where, "is not varied") : found;
}

/* --- the levels ------------------------------------------------------------------------------- */

static double answer_of(const study_outcome *o, const study_row *row) {
  if (!row->there || row->of->status != 0) return NAN;
  if (strcmp(o->request->o.of, "last") != 0) return row->peak;
  const study_history *h = study_row_history(row, row->y_name);
  return h ? h->last : NAN;
}

/* Rows with one value of the key, in their order. */
static int levels_of(const study_outcome *o, int key, convergence_level *levels) {
  arena *a = o->request->memory;
  int count = 0;
  for (int r = 0; r < o->count; r++) {
    const char *name = o->cases[r].values[key];
    int n = 0;
    while (n < count && strcmp(levels[n].name, name) != 0)
      n++;
    if (n == count)
      levels[count++] = (convergence_level){.size = fabs(size_of(name)), .name = name};
    double *values = arena_room(a, levels[n].values, levels[n].count, sizeof *values);
    values[levels[n].count++] = answer_of(o, &o->rows[r]);
    levels[n].values = values;
  }
  return count;
}

/* Which runs of a level share a value of another key, by numbers from 0. */
static const int *shared_of(const study_outcome *o, int key, int other, const char *name,
                            int runs) {
  int *shared = arena_alloc(o->request->memory, (size_t)runs * sizeof *shared), values = 0;
  const char **value = arena_alloc(o->request->memory, (size_t)runs * sizeof *value);
  for (int r = 0, i = 0; r < o->count && i < runs; r++) {
    if (strcmp(o->cases[r].values[key], name) != 0) continue;
    int v = 0;
    while (v < values && strcmp(value[v], o->cases[r].values[other]) != 0)
      v++;
    if (v == values) value[values++] = o->cases[r].values[other];
    shared[i++] = v;
  }
  return shared;
}

static void note_shared(const study_outcome *o, int key, convergence_level *first) {
  const int **shared = arena_alloc(o->request->memory, (size_t)o->key_count * sizeof *shared);
  first->shared = shared;
  for (int k = 0; k < o->key_count; k++)
    if (k != key) shared[first->shared_count++] = shared_of(o, key, k, first->name, first->count);
}

/* --- one material? ---------------------------------------------------------------------------- */

/* Some bonds have lost what counts. */
static bool is_damaged(const study_row *row) {
  const study_history *lost = study_row_history(row, "energy/dissipated_damage"),
                      *work = study_row_history(row, "energy/external");
  return lost && work && lost->last > 1e-2 * fabs(work->peak);
}

/* The work that a crack takes per area differs between the cases: N/m, its least and largest. */
static bool work_moves(const study_outcome *o, double *least, double *largest) {
  const double same = 0.02;
  *least = INFINITY;
  *largest = 0;
  for (int r = 0; r < o->count; r++) {
    const double work = o->cases[r].crack_energy;
    if (!(work > 0) || !isfinite(work)) return false;
    *least = pl_fmin(*least, work);
    *largest = pl_fmax(*largest, work);
  }
  return *largest > (1 + same) * *least;
}

/* What has no limit is not fitted with one. */
static void refuse_moving(const study_outcome *o, convergence *found) {
  double least, largest;
  bool damaged = false;
  if (!work_moves(o, &least, &largest)) return;
  for (int r = 0; r < o->count; r++)
    damaged = damaged || (o->rows[r].there && is_damaged(&o->rows[r]));
  if (!damaged) {
    fprintf(stderr,
            "perilat: warning: the law's work of fracture is %.4g N/m in one case and %.4g in "
            "another; no crack opened here\n",
            least, largest);
    return;
  }
  *found = (convergence){.order = NAN, .value = NAN, .error = NAN};
  found->discretisation = found->scatter = NAN;
  snprintf(found->reason, sizeof found->reason,
           "the cases are different materials: the law's work of fracture is from %.4g to %.4g N/m",
           least, largest);
  printf("  the work of fracture must not move with the spacing: take a law whose softening ends "
         "by a fracture energy (`cohesive`: G_f; `mplm_concrete`: tension = 'energy', G_F), or let "
         "its softening change together with the spacing (%s)\n",
         o->request->grouped ? "`vary = '... with ...'`" : "--with");
}

/* --- the answer ------------------------------------------------------------------------------- */

static const study_row *any_row(const study_outcome *o) {
  for (int r = 0; r < o->count; r++)
    if (o->rows[r].there) return &o->rows[r];
  return NULL;
}

static void tell(const study_outcome *o, const convergence *c, const study_row *row) {
  const char *of = o->request->o.of, *unit_text = unit_is_pure(row->y_unit) ? "" : row->y_unit;
  if (!c->converged) {
    printf("  %s of %s: not converged: %s\n", of, row->y_name, c->reason);
    return;
  }
  printf("  %s of %s goes to %.6g %s, +- %.2g (%.2g %%)", of, row->y_name, c->value, unit_text,
         c->error, 100 * fabs(c->error / c->value));
  if (isfinite(c->order)) printf(", with order %.3g", c->order);
  if (c->scatter > 0)
    printf("; of the bar, the size makes %.2g and the other keys %.2g", c->discretisation,
           c->scatter);
  printf("%s%s\n", *c->reason ? "; " : "", c->reason);
}

int study_converge(const study_outcome *o, int key, json *w) {
  convergence_level *levels =
      arena_alloc(o->request->memory, ((size_t)o->count + 1) * sizeof *levels);
  convergence found;
  const study_row *row = any_row(o);
  const int count = levels_of(o, key, levels);
  if (count > 0) note_shared(o, key, levels);
  convergence_find(levels, count, &found);
  refuse_moving(o, &found);
  if (row) tell(o, &found, row);
  if (w) {
    json_put_text(w, "key", o->keys[key]);
    json_put_text(w, "of", o->request->o.of);
    json_put_bool(w, "converged", found.converged);
    json_put_number(w, "order", found.order);
    json_put_number(w, "value", found.value);
    json_put_number(w, "error", found.error);
    json_put_text(w, "unit", row ? row->y_unit : NULL);
    json_put_text(w, "reason", *found.reason ? found.reason : NULL);
  }
  return found.converged ? 0 : 2;
}
