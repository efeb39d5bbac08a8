#include "generator/report/report_bad.h"

#include <stdio.h>
#include <string.h>

#include "generator/drive/explain_bad.h"
#include "generator/drive/explain_point.h"
#include "generator/kernel/document.h"
#include "generator/report/bad_bond.h"
#include "generator/report/moment.h"
#include "generator/report/report_trust.h"
#include "generator/report/run_series.h"
#include "runtime/continuum/point_forces.h"
#include "runtime/deck/lattice_kind.h"

/* The bond at fault, for `perilat drive`. */
static void write_bad_bond(const run *r, const bad_state *b) {
  char path[4200], error[ERROR_LENGTH + 4200];
  bad_bond_path(r->result_path, b, path, sizeof path);
  if (bad_bond_write(path, r->options->deck_path, r->model_of[b->interaction],
                     &r->laws[b->interaction], simulation_rows(r->simulation, b->body), b, error,
                     sizeof error))
    fprintf(stderr, "  this bond alone: perilat drive %s\n", path);
  else
    fprintf(stderr, "  %s\n", error);
}

static void write_bad_point(const run *r, const bad_state *b) {
  char path[4200], error[ERROR_LENGTH + 4200];
  bad_bond_path(r->result_path, b, path, sizeof path);
  if (bad_point_write(path, r->options->deck_path, r->model_of[b->interaction],
                      &r->laws[b->interaction], &r->deck->lattices[b->body], b, error,
                      sizeof error))
    fprintf(stderr, "  this point alone: perilat drive %s\n", path);
  else
    fprintf(stderr, "  %s\n", error);
}

/* What its law says there, line by line. */
static point_fault explain_bad_point(const run *r, const bad_state *b) {
  const simulation_law *l = &r->laws[b->interaction];
  const point_state *p = b->point;
  const asked_point at = {p->strain, p->field, p->size, simulation_step_limit(r->simulation)->step,
                          b->advance};
  if (!r->model_of[b->interaction]) return POINT_FAULT_OTHER;
  return explain_point(r->model_of[b->interaction]->plan, l->parameters, &at, stderr);
}

static void print_fields(const pl_law *kernel, const double *values, bool on_particles) {
  for (int f = 0; f < kernel->field_count; f++)
    if ((kernel->fields[f].place == PL_ON_PARTICLE) == on_particles)
      fprintf(stderr, ", %s %.6g", kernel->fields[f].name, values[f]);
}

/* What the particle's law read: its family. */
static void print_family(const run *r, const bad_state *b) {
  const pl_law *kernel = r->laws[b->interaction].law;
  fprintf(stderr, "  the particle has %d bonds", b->family_count);
  print_fields(kernel, b->own_fields, true);
  fputc('\n', stderr);
  for (int k = 0; k < b->family_count; k++) {
    const bad_neighbour *n = &b->family[k];
    fprintf(stderr, "  bond to particle %ld: stretch %.6g, stretch rate %.6g 1/s", n->particle,
            n->stretch, n->stretch_rate);
    print_fields(kernel, n->fields, false);
    print_fields(kernel, n->fields, true);
    fputc('\n', stderr);
  }
}

/* What a point of a mesh was like before the step. */
static void print_point(const run *r, const bad_state *b) {
  const pl_law *kernel = r->laws[b->interaction].law;
  const point_state *p = b->point;
  char cell[BAD_CELL_TEXT];
  fprintf(stderr, "  point (%.6g, %.6g) mm of cell %s", 1e3 * p->at[0], 1e3 * p->at[1],
          bad_cell_text(&r->deck->lattices[b->body], p->cell, cell));
  fprintf(stderr, ": strain xx %.6g, yy %.6g, xy %.6g; stress xx %.6g, yy %.6g, xy %.6g MPa",
          p->strain[0], p->strain[1], p->strain[2], 1e-6 * p->stress[0], 1e-6 * p->stress[1],
          1e-6 * p->stress[2]);
  for (int f = 0; f < kernel->field_count; f++)
    fprintf(stderr, ", %s %.6g", kernel->fields[f].name, p->field[f]);
  fputc('\n', stderr);
}

static const char *stamp_too_far(const run *r) {
  for (int k = 0; k < r->deck->stamp_count; k++)
    if (simulation_stamp(r->simulation, k).too_far) return r->deck->stamps[k].name;
  return NULL;
}

/* Where no particle is at fault. */
static void report_bad_energy(const run *r, const bad_state *b) {
  char when[MOMENT_TEXT];
  const char *fast = stamp_too_far(r);
  if (fast) {
    say_error("the stamp `%s` went further than a spacing in step %ld (%s): it would pass through "
              "particles unseen\n"
              "  what was computed until then is in the result; a smaller `step_safety` mends it, "
              "or a slower stamp",
              fast, b->step, moment(r, b->time, when));
    return;
  }
  say_error("%s after %ld steps (%s): kinetic %.3g J, stored %.3g J\n"
            "  no stable step does that: the step is too long for this body, or the law's stored "
            "energy is "
            "not that of its forces\n"
            "  what was computed until then is in the result; a smaller `step_safety` tells which",
            b->what, b->step, moment(r, b->time, when), last_value(r, "energy/kinetic"),
            last_value(r, "energy/stored"));
  tell_of_steps(r, true);
}

static const char *const MENDS[] = {
    [POINT_FAULT_OTHER] = "a smaller `step_safety` or a law that stays finite there mends it",
    [POINT_FAULT_FLOW] = "no smaller step mends it, but a law whose flow comes back",
    [POINT_FAULT_FOLD] = "no smaller step finds one: a law whose stress along z rises with the "
                         "strain there mends it, or plane strain"};

/* Of a run whose steps may shrink. */
static void report_too_stiff(const run *r, const bad_state *b) {
  char when[MOMENT_TEXT];
  say_error("%s: from %s on `%s` is so stiff that the step would be less than 1/%d of the first "
            "one\n"
            "  what was computed until then is in the result; does its law have an end to its "
            "stiffness, or are\n  particles about to lie on each other?",
            b->what, moment(r, b->time, when), r->deck->lattices[b->body].name,
            1 << RUN_MOST_HALVINGS);
}

void report_bad(const run *r) {
  bad_state b = simulation_bad(r->simulation);
  char place_text[ROWS_PLACE_TEXT], when[MOMENT_TEXT];
  point_fault fault = POINT_FAULT_OTHER;
  if (b.particle < 0) {
    if (strcmp(b.what, BAD_TOO_STIFF) == 0)
      report_too_stiff(r, &b);
    else
      report_bad_energy(r, &b);
    return;
  }
  say_error(
      "%s in step %ld (%s%s) at %s %ld, %s", b.what, b.step,
      r->deck->relaxation.increments > 0 ? "after " : "", moment(r, b.time, when),
      deck_particle_word(&r->deck->lattices[b.body]), b.particle,
      rows_place_text(simulation_rows(r->simulation, b.body)->dimensions, b.place, place_text));
  if (b.family) print_family(r, &b);
  if (b.point) {
    print_point(r, &b);
    fault = explain_bad_point(r, &b);
    write_bad_point(r, &b);
  }
  if (b.bond_particle >= 0) {
    fprintf(stderr,
            "  bond to particle %ld: stretch %.6g, stretch rate %.6g 1/s, end rotations %.6g and "
            "%.6g\n",
            b.bond_particle, b.stretch, b.stretch_rate, b.theta_i, b.theta_j);
    const pl_bond_class bonds = rows_bond_class(simulation_rows(r->simulation, b.body), 0);
    if (r->model_of[b.interaction])
      explain_bad(r->model_of[b.interaction]->plan, b.parameters, &bonds, &b, stderr);
    write_bad_bond(r, &b);
  }
  tell_of_steps(r, true);
  fprintf(stderr, "  what was computed until then is in the result; %s\n", MENDS[fault]);
}
