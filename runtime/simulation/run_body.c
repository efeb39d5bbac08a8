#include "runtime/simulation/run_body.h"

#include <omp.h>
#include <stdlib.h>
#include <string.h>

#include "runtime/interaction/interaction.h"
#include "runtime/lattice/lattice.h"
#include "runtime/simulation/law_fits.h"
#include "runtime/simulation/material.h"
#include "runtime/simulation/step_choice.h"

/* --- what fits -------------------------------------------------------------------------------- */

static bool has_field(const deck *k, const char *lattice) {
  for (int f = 0; f < k->field_count; f++)
    if (strcmp(k->fields[f].lattice, lattice) == 0) return true;
  return false;
}

static bool has_placed(const deck_material *m) {
  for (int n = 0; n < m->assignment_count; n++)
    if (m->assignments[n].placed) return true;
  return false;
}

static bool open_planes(run_body *b, const deck *k, diagnostics *d) {
  const int material = deck_find_material(k, b->name);
  if (!has_field(k, b->name) && b->regional_count == 0 && b->law->varying_count == 0 &&
      (material < 0 || !has_placed(&k->materials[material])))
    return true;
  b->planes = parameter_planes_new(k, b->lattice, b->lattice_rows, b->law, b->parameters,
                                   b->regional, b->regional_count, d);
  return b->planes != NULL;
}

static void set_masses(run_body *b) {
  if (b->planes && b->planes->density)
    rows_set_densities(b->lattice_rows, b->planes->density);
  else
    rows_set_density(b->lattice_rows, material_density(b->law, b->parameters));
}

/* What asks for the values of parameters. */
static bool open_material(run_body *b, const deck *k, diagnostics *d) {
  const bool planes = open_planes(b, k, d), mass = law_fits_motion(b->law, k, b->lattice, d);
  if (mass) set_masses(b);
  if (deck_lacks(k, "simulation") || deck_lacks(k, "relaxation")) return false;
  return planes && mass &&
         step_limit_of(k, b->lattice, b->law, b->parameters, b->planes, b->lattice_rows, &b->limit,
                       d);
}

bool run_body_open(run_body *b, const deck *k, rows *lattice, diagnostics *d) {
  enum { ANY_DOF = PL_MAX_DOF };
  b->name = k->lattices[b->lattice].name;
  b->lattice_rows = lattice ? lattice : lattice_build(k, b->lattice, d);
  if (!b->lattice_rows) return false;
  b->fits = b->law && law_fits_lattice(b->law, k, b->lattice, b->lattice_rows, d);
  b->loads = loads_new(k, b->lattice, b->lattice_rows, b->fits ? b->law->name : "",
                       b->fits ? b->law->dof : ANY_DOF, d);
  if (!b->fits) return false;
  law_fits_protection(b->law, k, b->lattice, d);
  return b->parameters && open_material(b, k, d) && b->loads;
}

/* --- the state -------------------------------------------------------------------------------- */

/* Small bodies are not worth many threads: a block has at least eight rows, of a list two, unless
   the deck insists. */
static int choose_threads(const run_body *b, const deck *k) {
  const int asked = k->simulation.threads;
  if (asked > 0) return asked;
  const int least = b->lattice_rows->list ? 2 : 8;
  const int offered = omp_get_max_threads(), sensible = b->lattice_rows->row_count / least;
  return sensible < 1 ? 1 : offered < sensible ? offered : sensible;
}

bool run_body_begin(run_body *b, const deck *k, double step, diagnostics *d) {
  b->limit.step = step;
  b->bonds = rows_bonds(b->lattice_rows);
  b->state = interaction_new(b->lattice_rows, b->law, b->parameters, step, choose_threads(b, k),
                             k->output.energy, k->relaxation.increments > 0);
  b->body = b->state->body;
  if (b->planes) b->state->parameter = b->planes->value;
  if (k->gravity_count > 0) body_add_gravity(b->body);
  return loads_initial_motion(b->loads, b->body, d);
}

void run_body_free(run_body *b) {
  loads_free(b->loads);
  sweep_free(b->state);
  parameter_planes_free(b->planes);
  free(b->bonds);
  if (b->lattice_rows) rows_free(b->lattice_rows);
}

double run_body_memory(const run_body *b) {
  const rows *g = b->lattice_rows;
  const double site = 2 * sizeof(double) + sizeof(int64_t) + sizeof(int32_t) + 1; /* of rows */
  const double list =
      g->list ? 2 * g->directions * (sizeof(int32_t) + (1 + (double)g->dimensions) * sizeof(double))
              : 0;
  return (double)b->body->bytes + (list + site) * (double)g->size +
         (b->planes ? (double)b->planes->bytes : 0) +
         (double)sizeof(rows_bond) * (double)g->bond_count;
}
