#include "runtime/interaction/bond_forces.h"

#include <stdlib.h>
#include <string.h>

#include "dsl/base/arena.h"
#include "runtime/body/motion.h"
#include "runtime/interaction/family_forces.h"
#include "runtime/interaction/joint.h"
#include "runtime/interaction/pairwise.h"

struct bond_forces {
  bond_forces **parts; /* [part_count] of several laws at work together; nothing else then */
  int part_count;
  sweep *w;
  family_forces *families; /* NULL of laws of bonds, which use what follows */
  double **field, **force; /* [field_count][pitch], [force_planes][pitch]: of a strip */
  const double **parameter;
  int64_t found_step; /* -1: none */
};

static double **planes_new(sweep *w, int count) {
  double **planes = must_calloc((size_t)count + 1, sizeof *planes);
  for (int k = 0; k < count; k++)
    planes[k] = body_doubles(w->body, w->lattice->pitch);
  return planes;
}

static bond_forces *forces_of_parts(sweep *const *parts, int count) {
  bond_forces *f = must_calloc(1, sizeof *f);
  f->part_count = count;
  f->parts = must_calloc((size_t)count, sizeof(bond_forces *));
  for (int k = 0; k < count; k++)
    f->parts[k] = bond_forces_new(parts[k]);
  return f;
}

bond_forces *bond_forces_new(sweep *w) {
  int count;
  sweep *const *parts = joint_parts(w, &count);
  if (parts) return forces_of_parts(parts, count);
  bond_forces *f = must_calloc(1, sizeof *f);
  f->w = w;
  f->found_step = -1;
  if (w->law->kind == PL_STATE) {
    f->families = family_forces_new(w);
    return f;
  }
  f->field = planes_new(w, w->law->field_count);
  f->force = planes_new(w, w->law->force_planes);
  f->parameter = must_calloc((size_t)w->law->varying_count + 1, sizeof *f->parameter);
  return f;
}

void bond_forces_free(bond_forces *f) {
  if (!f) return;
  for (int k = 0; k < f->part_count; k++)
    bond_forces_free(f->parts[k]);
  free(f->parts);
  family_forces_free(f->families);
  free(f->field);
  free(f->force);
  free(f->parameter);
  free(f);
}

void bond_forces_find(bond_forces *f, int64_t step) {
  for (int k = 0; k < f->part_count; k++)
    bond_forces_find(f->parts[k], step);
  if (step >= 0 && f->found_step == step) return;
  if (f->families) family_forces_find(f->families);
  f->found_step = step;
}

/* --- laws of bonds ---------------------------------------------------------------------------- */

/* Bonds of one direction that sites of a part own. */
static void evaluate(const bond_forces *f, row_part at, int direction) {
  const sweep *w = f->w;
  const long near = body_start(w->body, at.row) + at.first,
             far = near + rows_offset(w->lattice, at.row, direction),
             slot = direction * w->lattice->size + near;
  pl_strip s = {.size = sizeof s,
                .count = at.end - at.first,
                .direction = direction,
                .flags = pairwise_flags(w, at.row) + at.first,
                .parameter = f->parameter,
                .field = f->field,
                .force = f->force,
                .time = w->body->time,
                .time_step = w->body->time_step,
                .advance = w->body->advance};
  for (int k = 0; k < w->law->varying_count; k++)
    f->parameter[k] = w->parameter[k] + slot;
  for (int k = 0; k < w->law->field_count; k++)
    memcpy(f->field[k], w->field[k] + slot, (size_t)s.count * sizeof(double));
  for (int d = 0; d < w->body->dof; d++) {
    s.displacement_i[d] = w->body->displacement[d] + near;
    s.displacement_j[d] = w->body->displacement[d] + far;
    s.velocity_i[d] = w->body->velocity[d] + near;
    s.velocity_j[d] = w->body->velocity[d] + far;
  }
  w->law->rows(w->law, pairwise_uniforms(w, direction), &s);
}

/* Force planes as pl_law says. Particles get the opposite of end moments. */
static bond_force force_at(const bond_forces *f, long site, int direction, long q) {
  bond_force b = {.owner = site,
                  .partner = rows_partner(f->w->lattice, site, direction),
                  .direction = direction};
  for (int d = 0; d < 2; d++) {
    b.on_owner[d] = f->force[d][q];
    b.on_partner[d] = -f->force[d][q];
  }
  if (f->w->body->dof > 2) {
    b.on_owner[2] = -f->force[2][q];
    b.on_partner[2] = -f->force[3][q];
  }
  return b;
}

static bool is_wanted(const rows *g, const uint64_t *wanted, long site, int direction) {
  return rows_has_bond(g, site, direction) && (!wanted || wanted[site] >> direction & 1);
}

/* The part of a row that holds all owners of wanted bonds, in whole vectors. */
static row_part part_wanted(const body *of, const uint64_t *wanted, int row, int direction) {
  row_part part = {row, of->count[row], 0};
  for (long q = 0; q < of->count[row]; q++) {
    if (!is_wanted(of->lattice, wanted, body_start(of, row) + q, direction)) continue;
    if (part.first > q) part.first = q / PL_LANES * PL_LANES;
    part.end = (q / PL_LANES + 1) * PL_LANES;
  }
  return part;
}

static void each_of_strips(bond_forces *f, const uint64_t *wanted, bond_force_use *use, void *to) {
  const body *of = f->w->body;
  for (int row = 0; row < of->lattice->row_count; row++)
    for (int k = 0; k < of->lattice->directions; k++) {
      const row_part part = part_wanted(of, wanted, row, k);
      const long start = body_start(of, row) + part.first;
      if (part.first >= part.end) continue;
      evaluate(f, part, k);
      for (long q = 0; q < part.end - part.first; q++) {
        if (!is_wanted(of->lattice, wanted, start + q, k)) continue;
        const bond_force b = force_at(f, start + q, k, q);
        use(to, &b);
      }
    }
}

void bond_forces_each(bond_forces *f, const uint64_t *wanted, bond_force_use *use, void *to) {
  for (int k = 0; k < f->part_count; k++)
    bond_forces_each(f->parts[k], wanted, use, to);
  if (f->part_count > 0) return;
  if (f->families)
    family_forces_each(f->families, wanted, use, to);
  else
    each_of_strips(f, wanted, use, to);
}
