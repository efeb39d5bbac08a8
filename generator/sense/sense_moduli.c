#include "generator/sense/sense_moduli.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "dsl/base/arena.h"
#include "dsl/semantics/law_reads.h"
#include "generator/check/physics_point_bench.h"
#include "generator/lower/lower_family.h"
#include "generator/sense/sense_response.h"
#include "runtime/analysis/implied.h"

static const double TOLERANCE = 1e-2;
static const double OF_POINTS = 3e-2; /* laws may round off a kink at rest */
/* Of force densities whose micromodulus is that of a continuum, on a horizon of a few spacings. */
static const double OF_HORIZON = 0.3;
static const double IN_PROPORTION = 1e-6;

/* What a law has along an axis. */
typedef struct moduli {
  double E, nu; /* Pa, 1 */
} moduli;

/* --- what the parameters name ----------------------------------------------------------------- */

/* Whether `E` is Young's modulus: its description says so, or it has none and the law is one that
   nothing else is known of. A modulus of single bonds or of a part is described as such. */
static bool is_of_the_material(const law *l, const symbol *E) {
  const bool has_nu = sense_parameter(l, "nu", "1") != NULL;
  if (!E->doc) return has_nu || l->tree->law == LAW_CENTRAL_BOND;
  return strstr(E->doc, "Young") || strstr(E->doc, "young");
}

/* Young's modulus and Poisson's ratio that a plane sees. */
static moduli named_moduli(const sense_bench *b, law_setting setting) {
  moduli m = {sense_value(b, sense_parameter(b->law, "E", "Pa")),
              sense_value(b, sense_parameter(b->law, "nu", "1"))};
  if (setting != SETTING_PLANE_STRAIN || isnan(m.nu)) return m;
  return (moduli){m.E / (1 - m.nu * m.nu), m.nu / (1 - m.nu)};
}

/* --- what the law has ------------------------------------------------------------------------- */

/* Force per volumes: the law of a continuum, which a lattice approaches with a growing horizon. Its
   average over all directions is what the continuum has. */
static bool gives_density(const law *l) {
  const stmt *given = law_force_state(l);
  return given && lower_is_per_volumes(given->symbol->dim);
}

static moduli averaged(const implied_elasticity *e, int dimensions) {
  const double D11 = 0.5 * (e->D[0][0] + e->D[1][1]), D12 = e->D[0][1], D66 = e->D[2][2];
  if (dimensions == 2) {
    const double K = 0.5 * (D11 + D12), G = 0.25 * (D11 - D12) + 0.5 * D66;
    return (moduli){4 * K * G / (K + G), (K - G) / (K + G)};
  }
  const double K = (D11 + 2 * D12) / 3, G = (D11 - D12 + 3 * D66) / 5;
  return (moduli){9 * K * G / (3 * K + G), (3 * K - 2 * G) / (2 * (3 * K + G))};
}

/* Along x (0) or y. False where the lattice has no stiffness. */
static bool moduli_of_lattice(const sense_bench *b, const double *parameters, int axis, moduli *m) {
  implied_elasticity e;
  if (!implied_elastic(b->kernel, parameters, b->lattice, &e)) return false;
  *m = gives_density(b->law) ? averaged(&e, b->lattice->dimensions)
                             : (moduli){e.E[axis], e.nu[axis]};
  return isfinite(m->E);
}

/* Without a `nu` a plane strain does not know what the plane sees of `E`, but the lattice does. */
static void take_out_of_plane_strain(moduli *m) {
  m->nu = m->nu / (1 + m->nu);
  m->E *= 1 - m->nu * m->nu;
}

/* E of twice the parameter over E: 2 where nothing else adds to the stiffness. */
static bool is_in_proportion(const sense_bench *b, const symbol *E, double before) {
  const size_t count = (size_t)b->law->parameters.count;
  double *twice = must_calloc(count + 1, sizeof *twice);
  moduli m = {NAN, NAN};
  memcpy(twice, b->parameters, count * sizeof *twice);
  twice[E->index] *= 2;
  const bool known = moduli_of_lattice(b, twice, 0, &m);
  free(twice);
  return known && fabs(m.E - 2 * before) <= IN_PROPORTION * before;
}

/* Whether a virgin bond is as stiff in compression as in tension: a cable is not. */
static bool is_alike_both_ways(const sense_bench *b) {
  static response out, in;
  if (b->law->tree->law == LAW_STATE) return true;
  return response_of(b, b->parameters, 1, &out) && response_of(b, b->parameters, -1, &in) &&
         fabs(out.stiffness - in.stiffness) <= 1e-3 * out.stiffness;
}

/* --- saying it -------------------------------------------------------------------------------- */

static void say_off(sense_bench *b, const char *what, const char *seen, moduli found,
                    moduli named) {
  if (b->said_of[DIAG_PATCH]) return;
  char text[256];
  const double nu = fabs(found.nu) < 1e-9 ? 0 : found.nu; /* of rounding */
  if (isnan(named.nu))
    snprintf(text, sizeof text, "%.4g GPa, not %.4g GPa", 1e-9 * found.E, 1e-9 * named.E);
  else
    snprintf(text, sizeof text, "%.4g GPa and %.4g, not %.4g GPa and %.4g%s", 1e-9 * found.E, nu,
             1e-9 * named.E, named.nu, seen);
  sense_say(b, DIAG_PATCH, sense_force(b->law),
            law_reads(b->law, QUANTITY_DIRECTION)
                ? "where the law is meant to know directions, its line `for` says so: `for ..., "
                  "anisotropic`"
            : isnan(named.nu)
                ? "look at the factor of the stiffness; if `E` is no Young's modulus, "
                  "say in its description what it is"
                : "look at the factors of the stiffnesses",
            "under uniform strain %s that of `E`%s: it has %s", what,
            isnan(named.nu) ? "" : " and `nu`", text);
  if (b->lattice)
    diag_note(b->said, (span){0, 0, UINT16_MAX}, "found with particles of a %s lattice, s = %.6g m",
              b->lattice_name, b->lattice->spacing);
}

static bool is_off(moduli found, moduli named, double tolerance) {
  return !(fabs(found.E - named.E) <= tolerance * named.E) ||
         (!isnan(named.nu) && !(fabs(found.nu - named.nu) <= tolerance));
}

static void check_lattice(sense_bench *b, const symbol *E) {
  const bool density = gives_density(b->law), by_horizon = law_reads(b->law, QUANTITY_HORIZON);
  const moduli named = named_moduli(b, b->law->setting);
  moduli found;
  for (int axis = 0; axis < (density ? 1 : 2); axis++) {
    if (!moduli_of_lattice(b, b->parameters, axis, &found)) return;
    const double seen = found.E;
    if (isnan(named.nu) && b->law->setting == SETTING_PLANE_STRAIN)
      take_out_of_plane_strain(&found);
    if (!is_off(found, named, density && by_horizon ? OF_HORIZON : TOLERANCE)) continue;
    if (!is_in_proportion(b, E, seen) || !is_alike_both_ways(b)) return;
    say_off(b, density ? "the law of the continuum is not" : "the perfect lattice is not",
            b->law->setting == SETTING_PLANE_STRAIN ? " (as a plane strain sees them)" : "", found,
            named);
    return;
  }
}

/* --- points ----------------------------------------------------------------------------------- */

/* Of the virgin point, where it is isotropic. */
static bool moduli_of_point(point_bench *p, const double *parameters, moduli *m) {
  const double rest[POINT_MOST] = {0};
  const physics_options with = {.parameters = parameters};
  point_bench_parameters(p, &with, true);
  point_bench_virgin(p);
  point_bench_strain(p, rest, NULL);
  point_bench_run(p, p->kernel->point_tangent, 1e-6);
  const int n = p->strains, last = n - 1;
  const double D11 = p->tangent[0][0], D12 = p->tangent[n][0], mu = 0.5 * (D11 - D12);
  if (!(fabs(p->tangent[last * n + last][0] - mu) <= TOLERANCE * D11)) return false;
  m->nu = p->setting.setting == SETTING_PLANE_STRESS ? D12 / D11 : D12 / (D11 + D12);
  m->E = 2 * mu * (1 + m->nu);
  return D11 > 0;
}

static bool point_is_in_proportion(sense_bench *b, point_bench *p, const symbol *E, double before) {
  moduli m = {NAN, NAN};
  b->parameters[E->index] *= 2;
  const bool known = moduli_of_point(p, b->parameters, &m);
  b->parameters[E->index] /= 2;
  return known && fabs(m.E - 2 * before) <= IN_PROPORTION * before;
}

static void check_point(sense_bench *b, const symbol *E) {
  const moduli named = named_moduli(b, SETTING_SPACE);
  physics_report unwanted = {0};
  moduli found;
  point_bench *p = must_calloc(1, sizeof *p);
  *p = (point_bench){.law = b->law, .said = b->said, .report = &unwanted};
  if (point_bench_open(p, b->law->setting) && moduli_of_point(p, b->parameters, &found) &&
      is_off(found, named, OF_POINTS) && point_is_in_proportion(b, p, E, found.E))
    say_off(b, "a point is not", "", found, named);
  point_bench_close(p);
  free(p);
}

void sense_check_moduli(sense_bench *b) {
  const symbol *E = sense_parameter(b->law, "E", "Pa");
  if (!E || !is_of_the_material(b->law, E) || b->law->tree->anisotropic) return;
  if (b->law->tree->law == LAW_CONTINUUM) check_point(b, E);
  const bool bar = law_reads(b->law, QUANTITY_AREA); /* of a bar: a lattice of bars is no solid */
  if (b->lattice && !(bar && b->lattice->directions > 1)) check_lattice(b, E);
}
