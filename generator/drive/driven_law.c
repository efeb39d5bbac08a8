#include "generator/drive/driven_law.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

#include "dsl/semantics/law_reads.h"
#include "dsl/semantics/law_variant.h"
#include "generator/drive/drive_bond.h"
#include "generator/drive/driven_fields.h"
#include "generator/kernel/document.h"
#include "generator/kernel/material_law.h"
#include "generator/plan/plan.h"
#include "runtime/analysis/material.h"
#include "runtime/deck/bravais.h"
#include "runtime/deck/deck_value.h"

/* Tips of cracks are not driven. */
static bool can_be_driven(driven_law *r) {
  if (r->law->kind != PL_CRACK) return true;
  diag_report(r->said, DIAG_NOT_SUPPORTED, r->in->material.item.where,
              "`perilat drive` drives bonds, particles and points; `%s` is a law of cracks",
              r->law->name);
  diag_hint(r->said, "see it at work in `perilat run` with a &crack");
  return false;
}

drive_kind driven_law_kind(const driven_law *r) {
  return r->law->kind == PL_STATE       ? DRIVE_OF_FAMILIES
         : r->law->kind == PL_CONTINUUM ? DRIVE_OF_POINTS
                                        : DRIVE_OF_BONDS;
}

/* A bond of a chain has an area, another one a thickness. */
static bool has_section(driven_law *r) {
  const bool given = r->in->bond.area > 0;
  if (driven_law_kind(r) != DRIVE_OF_BONDS || law_reads(r->model.law, QUANTITY_AREA) == given)
    return true;
  if (given)
    diag_report(r->said, DIAG_CONFLICT, deck_where(&r->in->bond.item, "area"),
                "the law `%s` does not read `area`", r->law->name);
  else
    diag_report(r->said, DIAG_MISSING_KEY, r->in->bond.item.where,
                "the law `%s` reads `area`: `&bond` must give it", r->law->name);
  if (!given) diag_hint(r->said, "such as &bond area = '100 mm^2' /");
  return false;
}

/* Bonds stretch and turn; particles are strained; points bear stress, too. */
static bool is_driven_by(drive_kind of, drive_quantity q) {
  if (of == DRIVE_OF_BONDS) return q < DRIVE_STRAIN_XX;
  return q >= DRIVE_STRAIN_XX && (of == DRIVE_OF_POINTS || q < DRIVE_STRESS_XX);
}

static bool refuse_quantity(driven_law *r, const drive_piece *p, bool beyond) {
  static const char *const laws[] = {[DRIVE_OF_BONDS] = "bonds",
                                     [DRIVE_OF_FAMILIES] = "families",
                                     [DRIVE_OF_POINTS] = "a continuum"};
  static const char *const hints[] = {
      [DRIVE_OF_BONDS] = "a bond is driven by stretch, theta_i, theta_j, twist",
      [DRIVE_OF_FAMILIES] = "a particle is driven by strain_xx, strain_yy, strain_xy",
      [DRIVE_OF_POINTS] = "a point is driven by strain_xx, ..., stress_xx, ..."};
  diag_report(r->said, DIAG_LAW_KIND, p->where,
              beyond ? "a law of %s in the plane knows no such strain"
                     : "a law of %s is not driven by this quantity",
              laws[driven_law_kind(r)]);
  diag_hint(r->said, "%s", hints[driven_law_kind(r)]);
  return false;
}

/* Beyond the plane in space only. */
static bool suits_law(driven_law *r) {
  for (int k = 0; k < r->in->piece_count; k++) {
    const drive_quantity q = r->in->pieces[k].quantity;
    const bool beyond = q == DRIVE_STRAIN_ZZ || q == DRIVE_STRAIN_YZ || q == DRIVE_STRAIN_XZ;
    if (!is_driven_by(driven_law_kind(r), q)) return refuse_quantity(r, &r->in->pieces[k], false);
    if (driven_law_kind(r) == DRIVE_OF_FAMILIES && beyond && r->law->dimensions == 2)
      return refuse_quantity(r, &r->in->pieces[k], true);
  }
  return driven_law_kind(r) != DRIVE_OF_POINTS || drive_point_suits(r->in, r->law, r->said);
}

/* A particle's lattice says whether it is in space; one that the law is not meant for is refused
   with the path. */
static law_setting setting_of_particle(const drive_input *in, const law *l) {
  const char *lattice = in->particle.lattice;
  const law_setting first = law_first_setting(l),
                    suits = lattice ? law_setting_in(l, bravais_dimensions(lattice)) : first;
  return law_is_for(l, suits) ? suits : first;
}

/* The law in the setting that the path asks for of a bond or a point; without one, NULL, in that
   which the law names first. NULL after a message, where the law is not meant for it. */
static const law *law_as_asked(const deck_item *from, const char *asked, const law *l,
                               diagnostics *d) {
  law_setting setting;
  if (!asked || !law_setting_find(asked, &setting)) return l;
  if (law_is_for(l, setting)) return law_on_lattice(l, setting, false, 0);
  diag_report(d, DIAG_CONFLICT, deck_where(from, "setting"), "the law `%s` is not meant for %s",
              l->tree->name, asked);
  diag_hint(d, "take another setting; where the equations hold in it, too, add it to the law's "
               "line `for`");
  return NULL;
}

static const law *law_of_particle(const drive_input *in, const law *l) {
  const law_setting setting = setting_of_particle(in, l);
  return setting == l->setting ? l : law_on_lattice(l, setting, false, 0);
}

/* A bond or a point is of the setting that the path asks for, a particle of one that suits its
   lattice. */
static bool take_setting(driven_law *r) {
  const law *first = r->model.law, *in_setting;
  const drive_bond *b = &r->in->bond;
  const drive_point *p = &r->in->point;
  if (first->tree->law == LAW_STATE)
    in_setting = law_of_particle(r->in, first);
  else if (first->tree->law == LAW_CONTINUUM)
    in_setting = law_as_asked(&p->item, p->setting, first, r->said);
  else
    in_setting = law_as_asked(&b->item, b->setting, first, r->said);
  if (!in_setting) return false;
  if (in_setting == first) return true;
  r->model.law = in_setting;
  plan_free(r->model.plan);
  return model_plan(&r->model);
}

/* The kernel of the law, which has been read without errors. */
static bool open_kernel(driven_law *r, bool compiled) {
  char error[256];
  const char *note;
  r->law = model_kernel(&r->model, !compiled, &note, error, sizeof error);
  if (note) fprintf(stderr, "perilat: warning: %s\n", note);
  if (!r->law) say_error("%s", error);
  return r->law != NULL;
}

static int find_field(const pl_law *kernel, const char *name) {
  for (int f = 0; f < kernel->field_count; f++)
    if (strcasecmp(kernel->fields[f].name, name) == 0) return f;
  return -1;
}

static bool refuse_field(driven_law *r, const deck_assignment *a) {
  const pl_law *kernel = r->law;
  const char **names = arena_alloc(r->memory, ((size_t)kernel->field_count + 1) * sizeof *names);
  for (int f = 0; f < kernel->field_count; f++)
    names[f] = kernel->fields[f].name;
  diag_report(r->said, DIAG_UNKNOWN_KEY, a->name_where, "the law `%s` has no state or damage `%s`",
              kernel->name, a->name);
  diag_suggest(r->said, a->name, names, kernel->field_count);
  return false;
}

static bool set_field(driven_law *r, const deck_assignment *a) {
  int f = find_field(r->law, a->name);
  if (f < 0) return refuse_field(r, a);
  const pl_field *field = &r->law->fields[f];
  unit wanted = {.dim = DIMENSIONLESS};
  const char *bad;
  size_t bad_length;
  if (*field->unit) (void)unit_parse(field->unit, strlen(field->unit), &wanted, &bad, &bad_length);
  if (a->word || (a->has_unit && !dim_equal(a->dim, wanted.dim))) {
    char needs[96];
    dim_describe(wanted.dim, needs, sizeof needs);
    diag_report(r->said, DIAG_UNITS, a->value_where, "`%s` is %s", field->name, needs);
    return false;
  }
  if (field->kind == PL_FIELD_DAMAGE && !(a->value >= 0 && a->value <= 1)) {
    diag_report(r->said, DIAG_OUT_OF_BOUNDS, a->value_where, "the damage `%s` is between 0 and 1",
                field->name);
    return false;
  }
  r->initial[f] = a->value;
  return true;
}

static bool is_assigned(const deck_material *m, const char *name) {
  for (int k = 0; k < m->assignment_count; k++)
    if (strcasecmp(m->assignments[k].name, name) == 0) return true;
  return false;
}

/* What a path gives needs no default: the material has the path's first value. */
static void take_first_values(driven_law *r) {
  deck_material *m = &r->model.values;
  const size_t count = (size_t)(m->assignment_count + r->in->given_count);
  deck_assignment *all = arena_alloc(r->memory, (count + 1) * sizeof *all);
  if (m->assignment_count) memcpy(all, m->assignments, (size_t)m->assignment_count * sizeof *all);
  m->assignments = all;
  for (int k = 0; k < r->in->given_count; k++) {
    const drive_given *g = &r->in->given[k];
    for (int p = 0; p < r->law->parameter_count; p++) {
      const pl_parameter *field = &r->law->parameters[p];
      if (field->has_default || !material_is_given(r->law, p) ||
          strcasecmp(field->name, g->name) != 0 || is_assigned(m, g->name))
        continue;
      all[m->assignment_count++] = (deck_assignment){.name = g->name,
                                                     .value = g->f.values[0],
                                                     .has_unit = g->has_unit,
                                                     .dim = g->dim,
                                                     .name_where = g->name_where,
                                                     .value_where = g->where,
                                                     .of_field = true};
    }
  }
}

/* Parameters, and where state and damage begin. */
static bool set_values(driven_law *r) {
  const pl_law *kernel = r->law;
  r->parameters = arena_alloc(r->memory, ((size_t)kernel->parameter_count + 1) * sizeof(double));
  r->initial = arena_alloc(r->memory, ((size_t)kernel->field_count + 1) * sizeof(double));
  for (int f = 0; f < kernel->field_count; f++)
    r->initial[f] = kernel->fields[f].initial;
  take_first_values(r);
  bool good = material_parameters(&r->model.values, kernel, r->parameters, r->said);
  good = good && driven_fields_suit(r->in, kernel, r->parameters, r->said);
  for (int k = 0; k < r->in->initial.assignment_count; k++)
    good = set_field(r, &r->in->initial.assignments[k]) && good;
  return good;
}

static driven_outcome open_law(driven_law *r, const drive_input *in, bool compiled,
                               diagnostics *said) {
  *r = (driven_law){.in = in, .said = said};
  const bool good = material_law_open(&in->material, NULL, in->path, &r->model, said);
  r->opened = r->model.memory != NULL;
  if (!good || !take_setting(r)) return DRIVEN_BAD_LAW;
  if (!open_kernel(r, compiled)) return DRIVEN_NO_KERNEL;
  if (r->law->kind == PL_STATE) r->gauge = arena_alloc(r->model.memory, sizeof *r->gauge);
  return DRIVEN_READY;
}

static driven_outcome suit_path(driven_law *r) {
  return can_be_driven(r) && has_section(r) && suits_law(r) && set_values(r) ? DRIVEN_READY
                                                                             : DRIVEN_UNSUITED;
}

driven_outcome driven_law_open(driven_law *r, arena *memory, const drive_input *in, bool compiled,
                               diagnostics *said) {
  const driven_outcome outcome = open_law(r, in, compiled, said);
  r->memory = memory;
  return outcome == DRIVEN_READY ? suit_path(r) : outcome;
}

/* Of a law of a bond or a family. */
static law_setting setting_asked(const drive_input *in, const law *l) {
  law_setting setting;
  const char *asked = in->bond.setting;
  if (l->tree->law == LAW_STATE) return setting_of_particle(in, l);
  return asked && law_setting_find(asked, &setting) ? setting : law_first_setting(l);
}

/* What a path sets has no part in the kernel, but for options and the setting. */
static bool has_kernel_of(const driven_law *kept, const drive_input *in) {
  char *path = model_find(in->material.model, in->path);
  const bool same = path && kept->model.path && strcmp(path, kept->model.path) == 0 &&
                    kept->law->kind != PL_CONTINUUM && kept->model.law->options.count == 0 &&
                    setting_asked(in, kept->model.law) == kept->model.law->setting;
  free(path);
  return same;
}

driven_outcome driven_law_open_kept(driven_law *r, driven_law *kept, arena *memory,
                                    const drive_input *in, diagnostics *said) {
  if (!kept->opened) {
    const driven_outcome outcome = open_law(kept, in, false, said);
    if (outcome != DRIVEN_READY) {
      *r = *kept;
      *kept = (driven_law){.in = NULL};
      return outcome;
    }
  }
  if (!has_kernel_of(kept, in)) return driven_law_open(r, memory, in, false, said);
  *r = *kept;
  r->in = in;
  r->memory = memory;
  r->said = said;
  r->opened = false;
  r->model.values = in->material;
  return suit_path(r);
}

void driven_law_columns(const driven_law *r, drive_table *out) {
  if (driven_law_kind(r) == DRIVE_OF_FAMILIES)
    drive_family_columns(r->in, r->model.law, r->law, out);
  else if (driven_law_kind(r) == DRIVE_OF_POINTS)
    drive_point_columns(r->in, r->law, out);
  else
    drive_columns(r->model.law, r->law, out);
}

bool driven_law_march(const driven_law *r, drive_table *out, drive_band *band) {
  switch (driven_law_kind(r)) {
  case DRIVE_OF_FAMILIES:
    return drive_family_run(r->in, r->model.law, r->law, r->gauge, r->parameters, r->initial, out,
                            r->said);
  case DRIVE_OF_POINTS:
    return drive_point_run(r->in, r->law, r->parameters, r->initial, out, band, r->said);
  default:
    return drive_run(r->in, r->model.law, r->law, r->parameters, r->initial, out, r->said);
  }
}

void driven_law_close(driven_law *r) {
  if (r->opened && r->gauge) family_gauge_close(r->gauge);
  if (r->opened) model_close(&r->model);
  *r = (driven_law){.in = NULL};
}
