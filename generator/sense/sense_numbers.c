#include "generator/sense/sense_numbers.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "dsl/base/arena.h"
#include "dsl/base/elementary.h"
#include "dsl/semantics/law_reads.h"
#include "generator/check/physics_point_bench.h"
#include "generator/sense/sense_response.h"
#include "runtime/analysis/implied.h"

/* Lead and rubber lie inside, diamond too: 18 km/s. */
static const double SLOWEST = 10, FASTEST = 20e3; /* m/s */
/* The strongest fibres have 0.05, a soft clay 1e-3, thin ice 1e-4, wet sand 1e-6. What is soft, as
   rubber and gels, is stretched to several times its length. */
static const double STRONGEST = 0.06, WEAKEST = 1e-7; /* of Young's modulus */
static const double STIFF = 1e9;  /* Pa: polyethylene; below it STRONGEST says nothing */
static const double LONGEST = 50; /* m: E G/f**2; concrete has up to 1 */
static const double LEAST_TOUGH = 1e3, MOST_TOUGH = 1e10; /* Pa m^(1/2): snow, the toughest steel */
static const double LIGHT = 100, HEAVY = 3e4;             /* kg/m^3: cork, beyond osmium */
static const double WITHOUT_UNITS = 1e3; /* Pa: a law with a smaller modulus has no units at all */

/* --- waves ------------------------------------------------------------------------------------ */

/* Of the fastest wave, NaN where it is not known. */
static double speed_of_point(const sense_bench *b, double density) {
  const double rest[POINT_MOST] = {0};
  const physics_options with = {.parameters = b->parameters};
  physics_report unwanted = {0};
  double speed = NAN;
  point_bench *p = must_calloc(1, sizeof *p);
  *p = (point_bench){.law = b->law, .said = b->said, .report = &unwanted};
  if (point_bench_open(p, b->law->setting)) {
    point_bench_parameters(p, &with, true);
    point_bench_virgin(p);
    point_bench_strain(p, rest, NULL);
    point_bench_run(p, p->kernel->point_tangent, 1e-6);
    speed = sqrt(p->tangent[0][0] / density);
  }
  point_bench_close(p);
  free(p);
  return speed;
}

static double fastest_wave(const sense_bench *b, double density) {
  implied_elasticity e;
  implied_waves w;
  if (b->law->tree->law == LAW_CONTINUUM) return speed_of_point(b, density);
  if (!b->lattice || !implied_elastic(b->kernel, b->parameters, b->lattice, &e)) return NAN;
  implied_wave_speeds(b->kernel, b->parameters, b->lattice, &e, &w);
  return w.longitudinal[0];
}

static void check_waves(sense_bench *b) {
  const symbol *E = sense_parameter(b->law, "E", "Pa"), *rho = b->law->rho;
  if (!rho || (E && sense_value(b, E) < WITHOUT_UNITS)) return;
  const double density = sense_value(b, rho), speed = fastest_wave(b, density);
  if (!isfinite(speed) || (speed >= SLOWEST && speed <= FASTEST)) return;
  const bool density_is_odd = speed > FASTEST ? density < LIGHT : density > HEAVY;
  if (!E && !density_is_odd) return;
  const symbol *odd = density_is_odd || !E ? rho : E;
  char unit_of[64];
  dim_unit(odd->dim, unit_of, sizeof unit_of);
  sense_say(b, DIAG_ABSURD_VALUE, odd->where,
            odd == rho ? "a density is in kg/m^3: concrete has 2400 [kg/m^3], that is 2.4 [g/cm^3]"
                       : "concrete has 30 [GPa], steel 200 [GPa]; a unit in brackets is all there "
                         "is: no 1e9 before [GPa]",
            "with `%s` = %.4g %s waves run at %.4g m/s: no material has that", odd->name,
            sense_value(b, odd), unit_of, speed);
}

/* --- strengths -------------------------------------------------------------------------------- */

static double limit_with(const sense_bench *b, double *parameters, const symbol *s, double as,
                         int sign) {
  static response r;
  parameters[s->index] = as;
  return response_of(b, parameters, sign, &r) && r.limit > 0 ? r.strain[r.limit] : NAN;
}

/* Whether the law leaves its first line where this parameter says, in tension or compression. */
static bool is_strength(const sense_bench *b, const symbol *s, double E) {
  const size_t count = (size_t)b->law->parameters.count;
  double *with = must_calloc(count + 1, sizeof *with);
  bool found = false;
  for (int sign = 1; sign >= -1 && !found; sign -= 2) {
    memcpy(with, b->parameters, count * sizeof *with);
    const double low = limit_with(b, with, s, copysign(1e-4 * E, sense_value(b, s)), sign),
                 high = limit_with(b, with, s, copysign(4e-4 * E, sense_value(b, s)), sign);
    found = high > 2 * low && high < 8 * low;
  }
  free(with);
  return found;
}

static void say_strength(sense_bench *b, const symbol *s, double over) {
  sense_say(b, DIAG_ABSURD_VALUE, s->where,
            "concrete has 3 [MPa] in tension and 30 [GPa] as its modulus: look at the prefixes",
            "`%s` = %.4g Pa is %.3g of `E`: no material is %s", s->name, sense_value(b, s), over,
            over > 1e-3 ? "so strong" : "so weak");
}

/* Of an energy per area with the law's strengths: E G/f**2 is the length over which a crack tears.
   Which of several strengths goes with it is not known: all must say the same. */
static void check_length(sense_bench *b, const symbol *G, const bool *is_strength, double E) {
  double shortest = INFINITY, longest = 0;
  for (int k = 0; k < b->law->parameters.count; k++) {
    if (!is_strength[k]) continue;
    const double length = E * sense_value(b, G) / pl_pow(b->parameters[k], 2);
    shortest = pl_fmin(shortest, length);
    longest = pl_fmax(longest, length);
  }
  const double cell = b->lattice ? b->lattice->spacing : 1e-5;
  if (longest > 0 && shortest > LONGEST)
    sense_say(b, DIAG_ABSURD_VALUE, G->where,
              "concrete has 100 [N/m], that is 0.1 [N/mm]: look at the prefixes",
              "`%s` = %.4g N/m gives a length of fracture E G/f^2 of %.4g m: concrete has up to "
              "1 m",
              G->name, sense_value(b, G), shortest);
  else if (longest > 0 && longest < 0.25 * cell)
    sense_say(b, DIAG_ABSURD_VALUE, G->where,
              "concrete has 100 [N/m], that is 0.1 [N/mm]: look at the prefixes, or take a "
              "finer lattice",
              "`%s` = %.4g N/m gives a length of fracture E G/f^2 of %.4g m, below the %s of "
              "%.4g m: what breaks holds more energy than tears it",
              G->name, sense_value(b, G), longest, b->lattice ? "spacing" : "least that there is",
              cell);
}

/* --- what names say --------------------------------------------------------------------------- */

static const double OFF = 0.15; /* of a strength or an energy that a name gives */

static bool is_one_of(const char *name, const char *const *words) {
  for (; *words; words++)
    if (strcmp(name, *words) == 0) return true;
  return false;
}

/* The stress that a pulled or pushed point bears, between those of two steps. */
static bool bears(const sense_bench *b, int sign, double named_stress, double *found,
                  bool *softens) {
  static response r;
  *found = NAN;
  if (!response_of(b, b->parameters, sign, &r) || r.limit < 1) return false;
  *softens = r.peak > 0;
  const double low = *softens ? r.stress[r.peak] : r.stress[r.limit - 1],
               high = *softens ? 1.1 * low : r.stress[r.limit];
  *found = low;
  return named_stress >= (1 - OFF) * low && named_stress <= (1 + OFF) * pl_fmax(low, high);
}

static void check_named_strength(sense_bench *b, const symbol *s) {
  static const char *const strengths[] = {"f_t", "f_y", "sigma_y", "sigma_t", NULL};
  double pulled, pushed;
  bool softens = false, other;
  if (b->law->tree->law != LAW_CONTINUUM || !is_one_of(s->name, strengths)) return;
  if (bears(b, 1, sense_value(b, s), &pulled, &softens) || isnan(pulled)) return;
  if (bears(b, -1, sense_value(b, s), &pushed, &other)) return;
  sense_say(b, DIAG_NAMED_VALUE, s->where,
            "look at factors such as sqrt(2/3), between a norm and an equivalent stress",
            "pulled with its sides free a point %s at %.4g Pa, and `%s` is %.4g Pa",
            softens ? "has its largest stress" : "leaves its first line", pulled, s->name,
            sense_value(b, s));
}

static const char MEND_ENERGY[] =
    "look at the factor between the area below the curve and the energy: a triangle has half of "
    "its "
    "base times its height; along a row of the hexagon two bonds are cut for each spacing";

/* What a cell of a point takes until it has parted, N/m; NaN where that is not known. */
static double energy_of_cell(const sense_bench *b, const double *parameters) {
  static response r;
  if (!law_reads(b->law, QUANTITY_CELL_SIZE) || !response_of(b, parameters, 1, &r)) return NAN;
  if (r.peak < 0 || r.stress[r.count - 1] > 0.05 * r.stress[r.peak]) return NAN;
  return r.area * r.size;
}

/* What straight cracks through the lattice take: along the rows, across them, and by the bonds of a
   row alone. False where bonds do not part. */
static bool energies_of_cracks(const sense_bench *b, const double *parameters, double of[3]) {
  implied_bond bond;
  if (!b->hexagon || b->law->tree->law == LAW_STATE) return false;
  implied_bond_curve(b->kernel, parameters, b->lattice, 0, &bond);
  if (!bond.separates) return false;
  for (int k = 0; k < 2; k++)
    of[k] = implied_crack_energy(b->kernel, parameters, b->lattice, 1 - k);
  of[2] = bond.row_energy;
  return isfinite(of[0]) && isfinite(of[1]);
}

/* Of a parameter that the law, with the options in force, makes use of: with twice of it more is
   taken. */
static void check_named_energy(sense_bench *b, const symbol *G) {
  static const char *const energies[] = {"G_f", "G_F", NULL};
  const double is = sense_value(b, G);
  double of[3], twice_of[3];
  if (!is_one_of(G->name, energies)) return;
  const bool point = b->law->tree->law == LAW_CONTINUUM;
  const size_t count = (size_t)b->law->parameters.count;
  double *twice = must_alloc((count + 1) * sizeof *twice);
  memcpy(twice, b->parameters, count * sizeof *twice);
  twice[G->index] *= 2;
  if (point) {
    of[0] = of[1] = of[2] = energy_of_cell(b, b->parameters);
    twice_of[0] = energy_of_cell(b, twice);
  }
  const bool known =
      point ? isfinite(of[0]) && isfinite(twice_of[0])
            : energies_of_cracks(b, b->parameters, of) && energies_of_cracks(b, twice, twice_of);
  free(twice);
  if (!known || !(twice_of[0] > 1.2 * of[0])) return;
  const double allowed = (point ? 1 : 2) * OFF * is;
  for (int k = 0; k < 3; k++)
    if (fabs(of[k] - is) <= allowed) return;
  if (point)
    sense_say(b, DIAG_NAMED_VALUE, G->where, MEND_ENERGY,
              "pulled until it has parted, a cell takes %.4g N/m, and `%s` is %.4g N/m", of[0],
              G->name, is);
  else
    sense_say(b, DIAG_NAMED_VALUE, G->where, MEND_ENERGY,
              "a straight crack through the lattice takes %.4g N/m along the rows, %.4g N/m across "
              "them, and `%s` is %.4g N/m",
              of[0], of[1], G->name, is);
}

/* --- strengths and energies ------------------------------------------------------------------- */

static void find_strengths(const sense_bench *b, double E, bool *found) {
  for (int k = 0; k < b->law->parameters.count; k++) {
    const symbol *s = b->law->parameters.items[k];
    const bool stress = dim_equal(s->dim, dimension_of("Pa")) && strcmp(s->name, "E") != 0;
    found[k] = stress && sense_value(b, s) != 0 && is_strength(b, s, E);
  }
}

static void check_strengths(sense_bench *b) {
  const symbol *E = sense_parameter(b->law, "E", "Pa");
  if (!E || sense_value(b, E) < WITHOUT_UNITS) return;
  const double modulus = sense_value(b, E);
  const int count = b->law->parameters.count;
  bool *found = must_calloc((size_t)count + 1, sizeof *found);
  find_strengths(b, modulus, found);
  for (int k = 0; k < count; k++) {
    const symbol *s = b->law->parameters.items[k];
    const double over = fabs(sense_value(b, s)) / modulus;
    const bool too_strong = over > STRONGEST && modulus >= STIFF;
    if (found[k] && (too_strong || over < WEAKEST)) say_strength(b, s, over);
  }
  for (int k = 0; k < count && !b->said_of[DIAG_ABSURD_VALUE]; k++) {
    const symbol *s = b->law->parameters.items[k];
    const bool energy = dim_equal(s->dim, dimension_of("N/m")) && sense_value(b, s) > 0;
    if (found[k]) check_named_strength(b, s);
    if (energy) check_length(b, s, found, modulus);
    if (energy && !b->said_of[DIAG_ABSURD_VALUE]) check_named_energy(b, s);
  }
  free(found);
}

static void check_toughness(sense_bench *b) {
  for (int k = 0; k < b->law->parameters.count; k++) {
    const symbol *s = b->law->parameters.items[k];
    if (!dim_equal(s->dim, dimension_of("Pa*m^(1/2)"))) continue;
    if (sense_value(b, s) >= LEAST_TOUGH && sense_value(b, s) <= MOST_TOUGH) continue;
    sense_say(b, DIAG_ABSURD_VALUE, s->where,
              "glass has 0.8 [MPa*m^(1/2)], steel 100: look at the prefixes",
              "`%s` = %.4g Pa m^(1/2) is a toughness that no material has", s->name,
              sense_value(b, s));
  }
}

void sense_check_numbers(sense_bench *b) {
  check_waves(b);
  check_strengths(b);
  check_toughness(b);
}
