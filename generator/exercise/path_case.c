#include "generator/exercise/path_case.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

/* --- what a law declares ---------------------------------------------------------------------- */

declared_names names_declared(arena *a, const char *path) {
  model m;
  declared_names all = {NULL, 0};
  if (model_open(&m, path, NULL, 0)) {
    const symbol_list *lists[] = {&m.law->parameters, &m.law->options};
    all.names =
        arena_alloc(a, ((size_t)(lists[0]->count + lists[1]->count) + 1) * sizeof *all.names);
    for (int l = 0; l < 2; l++)
      for (int k = 0; k < lists[l]->count; k++) {
        const char *name = lists[l]->items[k]->name;
        all.names[all.count++] = arena_text(a, name, strlen(name));
      }
  }
  model_close(&m);
  return all;
}

static bool is_declared(const declared_names *all, const char *name) {
  for (int k = 0; k < all->count; k++)
    if (strcasecmp(all->names[k], name) == 0) return true;
  return false;
}

drive_input *input_suited(arena *a, const path_case *c, const drive_input *in,
                          const declared_names *to, const char **missing) {
  drive_input *out = arena_alloc(a, sizeof *out);
  const deck_material *from = &in->material;
  *out = *in;
  *missing = NULL;
  out->material.assignments =
      arena_alloc(a, ((size_t)from->assignment_count + 1) * sizeof *from->assignments);
  out->material.assignment_count = 0;
  for (int k = 0; k < from->assignment_count; k++) {
    const deck_assignment *one = &from->assignments[k];
    if (is_declared(to, one->name))
      out->material.assignments[out->material.assignment_count++] = *one;
    else if (!*missing && k < c->own_count)
      *missing = one->name;
  }
  return out;
}

/* --- reading ---------------------------------------------------------------------------------- */

static const deck_assignment *assigned(const deck_material *m, const char *name) {
  for (int k = 0; k < m->assignment_count; k++)
    if (strcasecmp(m->assignments[k].name, name) == 0) return &m->assignments[k];
  return NULL;
}

/* Behind the path's own: an answer's defaults are not asked. */
static void assign_others(arena *a, deck_material *m, const model *solution) {
  const symbol_list *list = &solution->law->parameters;
  deck_assignment *all =
      arena_alloc(a, ((size_t)(m->assignment_count + list->count) + 1) * sizeof *all);
  if (m->assignment_count) memcpy(all, m->assignments, (size_t)m->assignment_count * sizeof *all);
  const int own = m->assignment_count;
  for (int k = 0; k < list->count; k++) {
    const symbol *s = list->items[k];
    const deck_material before = {.assignments = all, .assignment_count = own};
    if (s->has_default && !assigned(&before, s->name))
      all[m->assignment_count++] = (deck_assignment){.name = s->name,
                                                     .value = s->initial,
                                                     .name_where = m->item.where,
                                                     .value_where = m->item.where};
  }
  m->assignments = all;
}

drive_input *path_input(arena *a, source_set *sources, const char *path, const model *solution,
                        int *own_count, diagnostics *d) {
  char error[4096];
  size_t length;
  char *text = read_text_file(path, NAMELIST_LARGEST_TEXT, &length, error, sizeof error);
  if (!text) {
    diag_report(d, DIAG_FILE, (span){0, 0, UINT16_MAX}, "%s", error);
    return NULL;
  }
  const int file = source_add(sources, path, text, length);
  free(text);
  drive_input *in = drive_read(a, sources, file, NULL, 0, d);
  if (!in) return NULL;
  if (in->material.model) {
    diag_report(d, DIAG_CONFLICT, deck_where(&in->material.item, "model"),
                "a path of an exercise names no law");
    return NULL;
  }
  in->output = (drive_output){.rows = in->output.rows, .x = in->output.x, .y = in->output.y};
  *own_count = in->material.assignment_count;
  if (solution) assign_others(a, &in->material, solution);
  return in;
}

/* --- the solution on it ----------------------------------------------------------------------- */

static bool refer(reference_law *r, arena *a, const drive_input *in, const char *solution,
                  driven_law *kept, diagnostics *d) {
  const driven_outcome outcome = reference_law_drive(r, a, in, solution, kept, d);
  if (outcome == DRIVEN_BAD_LAW && r->of.opened)
    diag_report(d, DIAG_FILE, in->material.item.where, "the solution `%s` has errors", solution);
  return outcome == DRIVEN_READY;
}

bool path_case_refer(path_case *c, arena *a, const char *solution, driven_law *kept,
                     diagnostics *d) {
  c->referenced = true;
  if (!refer(&c->right, a, c->in, solution, kept, d)) return false;
  return !c->plain || refer(&c->right_plain, a, c->plain, solution, kept, d);
}

static void add_varied(path_case *c, arena *a, const char *name) {
  c->varied = arena_printf(a, "%s%s%s", c->varied, *c->varied ? ", " : "", name);
}

/* A size of the path and the one at hand. */
static void vary_size(path_case *c, arena *a, const char *name, double *size, double at_hand) {
  if (*size == at_hand) return;
  *size = at_hand;
  add_varied(c, a, name);
}

void path_case_vary(path_case *c, arena *a, const model *solution, const drive_input *first) {
  const symbol_list *list = &solution->law->parameters;
  drive_input *plain = arena_alloc(a, sizeof *plain);
  deck_material *m = &plain->material;
  *plain = *c->in;
  c->varied = "";
  m->assignments = arena_alloc(a, ((size_t)m->assignment_count + 1) * sizeof *m->assignments);
  for (int k = 0; k < m->assignment_count; k++) {
    deck_assignment *one = &m->assignments[k];
    *one = c->in->material.assignments[k];
    for (int p = 0; p < list->count; p++) {
      const symbol *s = list->items[p];
      if (strcasecmp(s->name, one->name) != 0 || !s->has_default || one->word ||
          fabs(one->value - s->initial) <= 1e-12 * fabs(s->initial))
        continue;
      one->value = s->initial;
      add_varied(c, a, s->name);
    }
  }
  vary_size(c, a, "s", &plain->bond.spacing, first->bond.spacing);
  vary_size(c, a, "t", &plain->bond.thickness, first->bond.thickness);
  vary_size(c, a, "s", &plain->particle.spacing, first->particle.spacing);
  vary_size(c, a, "t", &plain->particle.thickness, first->particle.thickness);
  vary_size(c, a, "h", &plain->point.cell_size, first->point.cell_size);
  c->plain = *c->varied ? plain : NULL;
}

void path_case_close(path_case *c) {
  if (c->referenced) reference_law_close(&c->right);
  if (c->referenced && c->plain) reference_law_close(&c->right_plain);
  c->referenced = false;
}
