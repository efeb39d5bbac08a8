#include "generator/check/physics_points.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "dsl/base/arena.h"
#include "dsl/base/elementary.h"
#include "generator/check/physics_point_bench.h"
#include "generator/check/physics_point_flows.h"
#include "generator/check/physics_point_turns.h"
#include "generator/interpreter/bad_origin.h"
#include "generator/interpreter/lone_point.h"
#include "generator/ir/random_values.h"
#include "generator/ir/rewrite.h"
#include "generator/lower/lower.h"
#include "generator/lower/lower_inputs.h"
#include "runtime/base/eigen.h"

enum { MOST = POINT_MOST, USUAL_SEED = 20 };

static const double REST_TOLERANCE = 1e-12;   /* of the stress at a strain of 1e-3 */
static const double TANGENT_TOLERANCE = 1e-5; /* of its largest entry, against differences */
static const double NO_STIFFNESS = 1e-3;      /* of that at rest: as a point at the tip of a cone */
static const double SYMMETRY_TOLERANCE = 1e-9; /* of its largest entry */
static const double PATH_TOLERANCE = 1e-6;     /* of the work of the absolute stresses */
static const double ROUNDING = 1e-12;          /* of an energy */
static const double TIME_STEP = 1e-6;          /* s */

static const char MEND_ENERGY[] =
    "give an `energy W` instead, of which the stress is the derivative, or write "
    "`nonconservative \"why\"`";

static const char MEND_KINK[] = "its slope jumps or is not that of the energy at some strain, as "
                                "of a principal value where two "
                                "are equal: take a function of all principal values alike";

static const char MEND_ROOT[] =
    "a root of a strain that is 0 has no slope: write `strain : strain` for `norm(strain)**2`, or "
    "keep roots off 0";

static const char MEND_AT_REST[] =
    "its guard holds at rest: f must be below 0 there, with all parameters within their bounds";

static const char MEND_JUMP[] = "let the values of the cases meet where one ends, or write `jump` "
                                "at the end of the line if the jump is meant";
static const char MEND_FOLD[] =
    "no strain along z, or several, leave no stress there, as the stress along z does not rise all "
    "the way with it: bound what lets it fall, or let the law be `for plane_strain, space`";
static const char MEND_NOT_DEFINED[] = "keep roots, logarithms and divisors off what they are not "
                                       "defined for, by cases or by `max`";

static const char MEND_NOT_FOUND[] =
    "keep roots, logarithms and divisors off what they are not defined for, by cases or by `max`; "
    "a "
    "flow that does not come back to its limit, and in plane stress a strain along z that is not "
    "found, are no numbers, too: `perilat drive` along this strain tells which";

/* --- along z ---------------------------------------------------------------------------------- */

/* The point by itself at this strain, with the states at hand. *field is to be freed after it. */
static void open_lone(const point_bench *b, const double *strain, lone_point *point,
                      asked_point *at, double **field) {
  *field = must_calloc((size_t)b->law->fields.count + 1, sizeof **field);
  for (int k = 0; k < b->law->fields.count; k++)
    (*field)[k] = b->old_field[k][0];
  *at = (asked_point){strain, *field, b->size[0], TIME_STEP, 0};
  lone_point_open(point, b->plan, b->parameters, at);
}

/* How many strains along z leave no stress there at this strain; 1 where that is no question. */
static int roots_along_z(const point_bench *b, const double *strain) {
  if (b->setting.setting != SETTING_PLANE_STRESS) return 1;
  double *field;
  asked_point at;
  lone_point point;
  open_lone(b, strain, &point, &at, &field);
  const along_z seen = lone_point_along_z(&point, &b->setting);
  lone_point_close(&point);
  free(field);
  return isfinite(seen.least) ? seen.roots : 1;
}

/* --- at rest ---------------------------------------------------------------------------------- */

/* Size of the stress at a strain of 1e-3, from a smaller one where the point has failed before. */
static double size_of_stress(point_bench *b) {
  double strain[MOST] = {0}, stress[MOST], scale = 0;
  for (double size = 1e-3; !(scale > 0) && size > 1e-10; size *= 1e-2) {
    point_bench_virgin(b);
    point_bench_direction(b, size, strain);
    point_bench_stress(b, strain, stress);
    scale = point_bench_largest(stress, b->strains) * 1e-3 / size;
    if (!b->law->failed) break;
  }
  return scale;
}

/* How to keep a divisor off 0. To be freed. */
static char *mend_of_divisor(const expr *e, const char *divisor) {
  const bool stress = dim_equal(e->dim, dimension_of("Pa"));
  char *text;
  size_t length;
  FILE *out = must_open_text(&text, &length);
  fprintf(out, "keep it off 0: write `max(%s, %s)`%s", divisor, stress ? "1 [Pa]" : "small",
          stress ? "" : ", `small` far below its usual size");
  must_close_text(out);
  return text;
}

/* The divisor that is 0, or the flow, that leaves no number at rest. */
static void say_not_a_number(point_bench *b, const double *rest) {
  static const char what[] = "the stress of the virgin point at rest is not a number";
  double *field;
  asked_point at;
  lone_point point;
  open_lone(b, rest, &point, &at, &field);
  const bad_origin from = bad_origin_of_point(&b->setting, &point.in);
  lone_point_close(&point);
  free(field);
  if (from.kind == BAD_DIVISION) {
    char *divisor = expr_text(from.of->right), *mend = mend_of_divisor(from.of->right, divisor);
    point_bench_say_at(b, from.of->where, DIAG_REST_FORCE, NULL, mend,
                       "%s: this divides by `%s`, which is 0 there", what, divisor);
    free(mend);
    free(divisor);
  } else {
    point_bench_say(b, DIAG_REST_FORCE, NULL, from.kind == BAD_RETURN ? MEND_AT_REST : MEND_ROOT,
                    from.kind == BAD_RETURN ? "%s: a flow that is returned is not found" : "%s",
                    what);
  }
}

static void check_rest(point_bench *b) {
  double strain[MOST] = {0}, stress[MOST];
  const double scale = size_of_stress(b);
  memset(strain, 0, sizeof strain);
  point_bench_stress(b, strain, stress);
  const double found = point_bench_largest(stress, b->strains);
  if (scale <= 0 && isfinite(found))
    point_bench_say(b, DIAG_STIFFNESS, strain, "let the stress depend on `strain`",
                    "the virgin point has no stress when it is strained");
  else if (!isfinite(found) && !b->failed[DIAG_FLOW])
    say_not_a_number(b, strain);
  else if (!(found <= REST_TOLERANCE * scale) && isfinite(scale))
    point_bench_say(b, DIAG_REST_FORCE, NULL, "take the stress of rest away from it",
                    "the virgin point at rest has a stress of %.6g Pa", found);
}

/* The smallest eigenvalue of the tangent's symmetric part. */
static double least_stiffness(const point_bench *b) {
  double matrix[EIGEN_MOST][EIGEN_MOST], value[EIGEN_MOST], vectors[EIGEN_MOST][EIGEN_MOST];
  for (int i = 0; i < b->strains; i++)
    for (int k = 0; k < b->strains; k++)
      matrix[i][k] = 0.5 * (b->tangent[i * b->strains + k][0] + b->tangent[k * b->strains + i][0]);
  eigen_symmetric(b->strains, matrix, value, vectors);
  double least = value[0];
  for (int k = 1; k < b->strains; k++)
    if (!(value[k] >= least)) least = value[k];
  return least;
}

static void check_stiffness(point_bench *b) {
  const double rest[MOST] = {0};
  if (b->failed[DIAG_REST_FORCE]) return;
  point_bench_virgin(b);
  point_bench_strain(b, rest, NULL);
  point_bench_run(b, b->kernel->point_tangent, TIME_STEP);
  if (!isfinite(point_bench_tangent_size(b))) {
    if (b->failed[DIAG_FLOW]) return; /* f may be above 0 at rest with these parameters */
    point_bench_say(b, DIAG_STIFFNESS, NULL, MEND_ROOT,
                    "the stiffness of the virgin point is not finite");
    return;
  }
  const double least = least_stiffness(b);
  if (!(least > 0))
    point_bench_say(
        b, DIAG_STIFFNESS, NULL,
        "look at signs, and at bounds of parameters such as `nu in [0, 0.5)`",
        "the virgin point has a strain against which it is not stiff (%.4g Pa): not all "
        "of its waves run, it would fly apart",
        least);
}

/* --- the stress's slope ----------------------------------------------------------------------- */

/* The larger one; no number where one is none. */
static double worse(double a, double b) {
  return isnan(a) || a > b ? a : b;
}

/* Of one column: the largest distance of differences over `by` between two stresses. */
static double column_gap(const point_bench *b, const double *tangent, int k, const double *high,
                         const double *low, double by) {
  const double part = point_bench_is_shear(b, k) ? 0.5 : 1;
  double gap = 0;
  for (int i = 0; i < b->strains; i++)
    gap = worse(gap, fabs((high[i] - low[i]) / by * part - tangent[i * b->strains + k]));
  return gap;
}

/* The largest distance of the tangent from the stress's differences, in each direction those of the
   better side or of both: at a kink it is that of one side. No number where the stress is none. */
static double tangent_gap(point_bench *b, const double *strain, const double *tangent, double by) {
  double moved[MOST], high[MOST], low[MOST], here[MOST], difference = 0;
  point_bench_stress(b, strain, here);
  for (int k = 0; k < b->strains; k++) {
    for (int side = 0; side < 2; side++) {
      memcpy(moved, strain, sizeof moved);
      moved[k] += side ? -by : by;
      point_bench_stress(b, moved, side ? low : high);
    }
    const double both = column_gap(b, tangent, k, high, low, 2 * by),
                 ahead = column_gap(b, tangent, k, high, here, by),
                 behind = column_gap(b, tangent, k, here, low, by);
    difference = worse(difference, pl_fmin(both, pl_fmin(ahead, behind)));
  }
  return difference;
}

static double tangent_size_at_rest(point_bench *b) {
  const double rest[MOST] = {0};
  point_bench_virgin(b);
  point_bench_strain(b, rest, NULL);
  point_bench_run(b, b->kernel->point_tangent, TIME_STEP);
  return point_bench_tangent_size(b);
}

static double draw_tangent(point_bench *b, double *strain, double *tangent) {
  const double size = point_bench_any_strain(b, strain);
  point_bench_virgin(b);
  point_bench_strain(b, strain, NULL);
  point_bench_run(b, b->kernel->point_tangent, TIME_STEP);
  for (int k = 0; k < b->strains * b->strains; k++)
    tangent[k] = b->tangent[k][0];
  return size;
}

/* Across a kink differences say nothing; smaller ones are asked then. Where hardly any of the
   stiffness of rest is left, differences are rounding. */
static void check_tangent(point_bench *b) {
  double strain[MOST], tangent[MOST * MOST];
  const double least = NO_STIFFNESS * tangent_size_at_rest(b);
  const double size = draw_tangent(b, strain, tangent);
  double scale = point_bench_tangent_size(b);
  if (scale < least) scale = least;
  const double difference = pl_fmin(pl_fmin(tangent_gap(b, strain, tangent, 1e-4 * size),
                                            tangent_gap(b, strain, tangent, 1e-5 * size)),
                                    tangent_gap(b, strain, tangent, 1e-6 * size));
  const bool finite = isfinite(difference) && isfinite(scale);
  if (!finite && !b->failed[DIAG_FLOW] && !b->failed[DIAG_NOT_FINITE] &&
      roots_along_z(b, strain) == 0)
    point_bench_say(b, DIAG_NOT_FINITE, strain, MEND_FOLD,
                    "no strain along z is found that leaves no stress there");
  else if (!finite && !b->failed[DIAG_FLOW])
    point_bench_say(b, DIAG_NOT_FINITE, strain,
                    b->law->fields.count > 0 || b->setting.setting == SETTING_PLANE_STRESS
                        ? MEND_NOT_FOUND
                        : MEND_NOT_DEFINED,
                    "the stress or its slope is not finite at a finite strain");
  else if (finite && !b->failed[DIAG_CONTINUITY] && !b->failed[DIAG_NOT_FINITE] &&
           !(difference <= TANGENT_TOLERANCE * scale))
    point_bench_say(b, DIAG_TANGENT, strain, roots_along_z(b, strain) != 1 ? MEND_FOLD : NULL,
                    "the tangent is off the stress's differences by %.3g of its largest entry",
                    difference / scale);
}

/* Of laws without states, whose tangent is that of the stress with nothing else changing. */
static void check_symmetry(point_bench *b) {
  double strain[MOST], tangent[MOST * MOST], most = 0;
  if (b->law->nonconservative || b->law->fields.count > 0 || b->kernel->reads_rates) return;
  draw_tangent(b, strain, tangent);
  const double scale = point_bench_tangent_size(b);
  for (int i = 0; i < b->strains; i++)
    for (int k = 0; k < i; k++)
      most = pl_fmax(most, fabs(tangent[i * b->strains + k] - tangent[k * b->strains + i]));
  if (isfinite(scale) && !(most <= SYMMETRY_TOLERANCE * scale))
    point_bench_say(
        b, DIAG_STORED_ENERGY, strain, MEND_ENERGY,
        "the stress has no energy: its tangent is not symmetric, by %.3g of its largest "
        "entry",
        most / scale);
}

/* --- energies --------------------------------------------------------------------------------- */

static double energy_at(point_bench *b, const double *strain) {
  point_bench_strain(b, strain, NULL);
  point_bench_run(b, b->kernel->point_observe, TIME_STEP);
  return b->observed[0][0];
}

/* The virgin point stores more than at rest. */
static void check_stored(point_bench *b) {
  double strain[MOST], stress[MOST];
  const double rest[MOST] = {0};
  if (b->law->nonconservative || b->failed[DIAG_STIFFNESS] || b->failed[DIAG_REST_FORCE]) return;
  point_bench_any_strain(b, strain);
  point_bench_virgin(b);
  double size = 0;
  point_bench_stress(b, strain, stress);
  point_bench_work(b, stress, strain, &size);
  const double stored = energy_at(b, strain) - energy_at(b, rest);
  if (isfinite(size) && stored < -1e-9 * size)
    point_bench_say(b, DIAG_STORED_ENERGY, strain,
                    "energy that a strain sets free drives motion "
                    "without end: look at signs and powers",
                    "the virgin point stores less than at rest, by %.6g J/m^3", -stored);
}

/* Whether the last evaluation of the stress has left every state as it was. */
static bool held(const point_bench *b) {
  bool same = true;
  for (int k = 0; k < b->law->fields.count && same; k++)
    same = b->new_field[k][0] == b->old_field[k][0];
  return same;
}

/* The virgin point is strained, half of the times to and fro, and goes back part of the way: there
   states may keep what they are. The strain that it is left at; returns its size. */
static double unloaded(point_bench *b, double *strain) {
  double stress[MOST], next[MOST];
  const bool again = draw_uniform(&b->seed, 0, 1) < 0.5;
  const double length = point_bench_any_strain(b, strain);
  point_bench_virgin(b);
  if (b->law->fields.count == 0 || draw_uniform(&b->seed, 0, 1) < 0.5) return length;
  point_bench_stress(b, strain, stress);
  point_bench_keep(b);
  if (again) {
    point_bench_direction(b, length, next);
    point_bench_stress(b, next, stress);
    point_bench_keep(b);
    memcpy(strain, next, sizeof next);
  }
  const double left = 1 - pl_pow(10, draw_uniform(&b->seed, -3, 0));
  for (int k = 0; k < b->strains; k++)
    strain[k] *= left;
  point_bench_stress(b, strain, stress);
  if (!held(b)) point_bench_keep(b);
  return length;
}

/* Over a small straight change of strain about a strain. */
typedef struct small_change {
  double done, energy, tolerance; /* J/m^3: work, change of the energy */
  bool held;                      /* states keep what they are */
} small_change;

static small_change change_about(point_bench *b, const double *strain, double length) {
  double moved[MOST], change[MOST], stress[MOST], energy[2], size = 0;
  small_change c = {.held = true};
  point_bench_direction(b, length, change);
  for (int side = 0; side < 2; side++) {
    for (int k = 0; k < b->strains; k++)
      moved[k] = strain[k] + (side ? 0.5 : -0.5) * change[k];
    point_bench_stress(b, moved, stress);
    c.held = c.held && held(b);
    energy[side] = energy_at(b, moved);
  }
  point_bench_stress(b, strain, stress);
  c.held = c.held && held(b);
  c.done = point_bench_work(b, stress, change, &size);
  c.energy = energy[1] - energy[0];
  c.tolerance = 1e-4 * size + ROUNDING * pl_fmax(fabs(energy[0]), fabs(energy[1]));
  return c;
}

/* Where both are given and states keep what they are: the work over a small straight change of
   strain is that of the energy. Across a kink it is so of smaller ones. */
static void check_energy_and_stress(point_bench *b) {
  if (!b->law->results[RESULT_SIGMA] || !b->law->results[RESULT_W]) return;
  double strain[MOST];
  const double length = unloaded(b, strain);
  small_change c;
  for (double part = 1e-3; part > 1e-6; part *= 0.1) {
    c = change_about(b, strain, part * length);
    /* what is no number is said elsewhere */
    if (!c.held || !isfinite(c.tolerance) || !isfinite(c.energy)) return;
    if (fabs(c.energy - c.done) <= c.tolerance) return;
  }
  const bool states = b->law->fields.count > 0;
  point_bench_say(b, DIAG_ENERGY_FORCE, strain,
                  states ? "look at factors of `energy W` (1/2, the damage), and that it takes the "
                           "strain less what is plastic; or leave it away"
                         : "give the `energy W` alone, and the stress follows from it",
                  "the stress is not the energy's derivative%s: a small strain does work of %.6g "
                  "J/m^3, the energy changes by %.6g J/m^3",
                  states ? " while the states keep what they are" : "", c.done, c.energy);
}

/* --- jumps ------------------------------------------------------------------------------------ */

static bool holds_jump(const expr *e) {
  if (!e) return false;
  bool found = holds_jump(e->left) || holds_jump(e->right);
  for (int k = 0; k < e->argument_count && !found; k++)
    found = holds_jump(e->arguments[k].value);
  for (int k = 0; k < e->case_count && !found; k++)
    found = e->cases[k].jump || holds_jump(e->cases[k].value);
  return found;
}

static bool means_jumps(const law *l) {
  for (const stmt *s = l->tree->first; s; s = s->next)
    if (holds_jump(s->value)) return true;
  return false;
}

static void between(const point_bench *b, const double *from, const double *to, double at,
                    double *strain) {
  for (int k = 0; k < b->strains; k++)
    strain[k] = from[k] + at * (to[k] - from[k]);
}

/* The largest change of the stress's components. */
static double change_of(const point_bench *b, const double *one, const double *other) {
  double most = 0;
  for (int k = 0; k < b->strains; k++)
    most = pl_fmax(most, fabs(one[k] - other[k]));
  return most;
}

/* Between two strains, always into the half with the larger change: what is left of it is a
   jump. */
static void check_continuity(point_bench *b, bool meant) {
  enum { PIECES = 32, HALVES = 36 };
  double from[MOST], to[MOST], here[MOST], low[MOST], high[MOST], next[MOST], scale = 0;
  double begin = 0, most = -1;
  if (meant || b->failed[DIAG_CONTINUITY]) return;
  point_bench_any_strain(b, from);
  point_bench_any_strain(b, to);
  point_bench_virgin(b);
  point_bench_stress(b, from, low);
  for (int k = 1; k <= PIECES; k++, memcpy(low, high, sizeof low)) {
    between(b, from, to, (double)k / PIECES, here);
    point_bench_stress(b, here, high);
    scale = pl_fmax(scale, point_bench_largest(high, b->strains));
    if (!(change_of(b, low, high) > most)) continue;
    most = change_of(b, low, high);
    begin = (double)(k - 1) / PIECES;
  }
  double width = 1.0 / PIECES;
  between(b, from, to, begin, here);
  point_bench_stress(b, here, low);
  between(b, from, to, begin + width, here);
  point_bench_stress(b, here, high);
  for (int k = 0; k < HALVES; k++) {
    width /= 2;
    between(b, from, to, begin + width, here);
    point_bench_stress(b, here, next);
    const bool second = change_of(b, next, high) > change_of(b, low, next);
    if (second) begin += width;
    memcpy(second ? low : high, next, sizeof next);
  }
  if (!isfinite(scale) || !(change_of(b, low, high) > 1e-4 * scale)) return;
  between(b, from, to, begin + width, next);
  between(b, from, to, begin, here);
  const bool folds = roots_along_z(b, here) != 1 || roots_along_z(b, next) != 1;
  point_bench_say(b, DIAG_CONTINUITY, next, folds ? MEND_FOLD : MEND_JUMP,
                  folds ? "the strain along z that leaves no stress there ends here: the stress "
                          "jumps by %.6g Pa"
                        : "the stress jumps by %.6g Pa",
                  change_of(b, low, high));
}

/* --- closed paths ----------------------------------------------------------------------------- */

typedef struct round_trip {
  double strain[MOST], stress[MOST], first[MOST], worst[MOST];
  double total, size, lost_least;
  bool *gone; /* [fields] the state whose first component this is went back to its first value */
} round_trip;

/* Whether a state, from component k on, was something else before the last step and is now what the
   virgin point has. */
static bool goes_back(const point_bench *b, int k, int components) {
  bool moved = false, back = true;
  for (int i = k; i < k + components; i++) {
    const double first = b->law->fields.items[i]->initial;
    moved = moved || b->old_field[i][0] != first;
    back = back && b->new_field[i][0] == first;
  }
  return moved && back;
}

static const symbol *whole_of(const symbol *s) {
  return s->component_of ? s->component_of : s;
}

static void note_gone(const point_bench *b, round_trip *t) {
  const symbol_list *fields = &b->law->fields;
  for (int k = 0, next; k < fields->count; k = next) {
    const symbol *whole = whole_of(fields->items[k]);
    for (next = k + 1; next < fields->count && whole_of(fields->items[next]) == whole;)
      next++;
    t->gone[k] = t->gone[k] || goes_back(b, k, next - k);
  }
}

/* A state whose rule reads what it was, by other names perhaps, and that has lost it all the same:
   the rule gives the increment alone. NULL without one. */
static const symbol *forgotten(const point_bench *b, const round_trip *t) {
  const symbol_list *fields = &b->law->fields;
  const symbol *found = NULL;
  arena *memory = arena_new();
  ir *graph = ir_new();
  diagnostics said = {0};
  lowered_law step;
  const bool lowered = lower_law(&b->setting, graph, LOWER_STEP, memory, &step, &said);
  for (int k = 0; lowered && k < fields->count && !found; k++) {
    const ir_node old = lower_field(graph, &b->setting, k);
    const stmt *rule = fields->items[k]->rule;
    if (t->gone[k] && rule->kind == STMT_DEFINITION &&
        rewrite_depends(graph, &step.fields[k], 1, &old, 1))
      found = whole_of(fields->items[k]);
  }
  ir_free(graph);
  arena_free(memory);
  diag_clear(&said);
  return found;
}

static void go(point_bench *b, round_trip *t, const double *next) {
  double change[MOST], rate[MOST], after[MOST];
  const double time = b->reads_time ? b->advance : TIME_STEP;
  for (int k = 0; k < b->strains; k++) {
    change[k] = next[k] - t->strain[k];
    rate[k] = change[k] / time;
    t->strain[k] = next[k];
  }
  point_bench_strain(b, next, b->kernel->reads_rates ? rate : NULL);
  memset(b->lost, 0, sizeof b->lost);
  point_bench_run(b, b->kernel->point_ledger, time);
  for (int k = 0; k < b->strains; k++) {
    after[k] = b->stress[k][0];
    t->stress[k] = 0.5 * (t->stress[k] + after[k]);
  }
  t->total += point_bench_work(b, t->stress, change, &t->size);
  memcpy(t->stress, after, sizeof after);
  if (point_bench_largest(next, b->strains) > 0) note_gone(b, t);
  point_bench_keep(b);
  for (int k = 0; k < PL_LOSSES; k++)
    if (b->lost[k][0] < t->lost_least) {
      t->lost_least = b->lost[k][0];
      memcpy(t->worst, next, sizeof t->worst);
    }
}

/* Around a random polygon of strains and back, in small steps; of laws that read the time quickly
   or slowly. */
static void go_around(point_bench *b, round_trip *t, int steps) {
  enum { CORNERS = 5 };
  double corner[CORNERS + 1][MOST] = {{0}}, next[MOST];
  const double length = pl_pow(10, draw_uniform(&b->seed, -5, -2));
  for (int k = 1; k < CORNERS; k++)
    point_bench_direction(b, length, corner[k]);
  memcpy(t->first, corner[1], sizeof t->first);
  point_bench_virgin(b);
  point_bench_stress(b, t->strain, t->stress);
  if (b->reads_time) point_bench_keep(b); /* how quickly states begin to change */
  if (b->reads_time) b->advance = pl_pow(10, draw_uniform(&b->seed, -8, 9)) / steps;
  for (int k = 0; k < CORNERS; k++)
    for (int step = 1; step <= steps; step++) {
      between(b, corner[k], corner[k + 1], (double)step / steps, next);
      go(b, t, next);
    }
}

/* Whether what a step loses is known: a state may lock energy in, which only the law's own W tells
   from what is lost; and one that goes on in time may overtake the strain within a step. */
static bool knows_losses(const law *l, bool reads_time) {
  bool known = !l->nonconservative && !reads_time;
  for (int k = 0; k < l->fields.count && !l->results[RESULT_W]; k++)
    known = known && l->fields.items[k]->kind == SYMBOL_DAMAGE;
  return known;
}

/* What is wrong with a law that gains on its way, in `text`. */
static const char *mend_of_gain(const point_bench *b, const round_trip *t, bool conserves,
                                char *text, size_t size) {
  const symbol *forgets = forgotten(b, t);
  if (forgets) {
    const char *name = forgets->name;
    snprintf(text, size,
             "the state `%s` forgets: in a step that adds nothing it goes back to %.4g; write `%s "
             "= %s + ...`",
             name, forgets->initial, name, name);
    return text;
  }
  if (conserves) return b->law->results[RESULT_SIGMA] ? MEND_ENERGY : MEND_KINK;
  return "let what a state or a rate adds to the stress take work, never give it: softer on the "
         "way back than on the way out";
}

/* What is done must be at least what is stored and lost. */
static void judge_path(point_bench *b, const round_trip *t, int steps) {
  const bool conserves = b->law->fields.count == 0 && !b->kernel->reads_rates;
  const bool may_gain = conserves && b->law->nonconservative; /* one way around, then */
  const double gain = b->law->nonconservative ? GAIN_OF_NONCONSERVATIVE : 1e-3;
  const bool gains = !may_gain && t->total < -gain * t->size;
  const bool loses = conserves && !b->law->nonconservative && t->total > 1e-3 * t->size;
  const bool creates =
      knows_losses(b->law, b->reads_time) && t->lost_least < -PATH_TOLERANCE * t->size / steps;
  char text[512];
  if (!gains && !loses && !creates) return;
  const char *mend = mend_of_gain(b, t, conserves, text, sizeof text);
  if (gains || loses)
    point_bench_say(b, DIAG_CLOSED_PATH, t->first, mend,
                    "around a closed path of strain the point %s %.3g of the work that is done",
                    gains ? "gains" : "loses", fabs(t->total) / t->size);
  if (creates && !b->failed[DIAG_CLOSED_PATH])
    point_bench_say(b, DIAG_DISSIPATION, t->worst, mend,
                    "a step of strain loses a negative energy, %.3g J/m^3", t->lost_least);
}

static void check_paths(point_bench *b) {
  enum { STEPS = 200 };
  round_trip t = {.gone = must_calloc((size_t)b->law->fields.count + 1, sizeof(bool))};
  go_around(b, &t, STEPS);
  if (isfinite(t.total)) judge_path(b, &t, STEPS); /* what is not is said elsewhere */
  b->advance = 0;
  free(t.gone);
}

/* --- a law ------------------------------------------------------------------------------------ */

static void check_setting(point_bench *b, const physics_options *o, int sets) {
  enum { ROUNDS = 40, PATHS = 4, TIMED_PATHS = 16 };
  const double effort = o->effort > 0 ? o->effort : 1;
  const bool jumps = means_jumps(b->law);
  point_flows *flows = point_flows_open(b);
  for (int set = 0; set < sets; set++) {
    point_bench_parameters(b, o, set == 0);
    check_rest(b);
    check_stiffness(b);
    for (int round = 0; round < PATHS * effort; round++)
      check_continuity(b, jumps);
    for (int round = 0; flows && round < ROUNDS * effort; round++)
      physics_check_flows(b, flows);
    for (int round = 0; round < ROUNDS * effort; round++) {
      check_tangent(b);
      check_symmetry(b);
      check_stored(b);
      check_energy_and_stress(b);
      physics_check_turns(b);
    }
    for (int round = 0; round < (b->reads_time ? TIMED_PATHS : PATHS) * effort; round++)
      check_paths(b);
  }
  point_flows_close(flows);
}

/* A deck's law is judged in the deck's setting alone, and where others do not ask for less, every
   law in those that it names, most of all in the first. */
void physics_check_points(const law *l, const physics_options *o, diagnostics *d,
                          physics_report *report) {
  static const law_setting settings[] = {SETTING_PLANE_STRESS, SETTING_PLANE_STRAIN, SETTING_SPACE};
  enum { COUNT = sizeof settings / sizeof *settings, SETS = 6, FEWER_SETS = 2 };
  const int errors = d->errors;
  point_bench *b = must_calloc(1, sizeof *b);
  *b = (point_bench){.law = l, .said = d, .report = report, .seed = o->seed ? o->seed : USUAL_SEED};
  if (point_bench_open(b, l->setting)) check_setting(b, o, SETS);
  point_bench_close(b);
  for (int k = 0; k < COUNT && !o->parameters && d->errors == errors; k++) {
    if (settings[k] == l->setting || !law_is_for(l, settings[k])) continue;
    if (point_bench_open(b, settings[k])) check_setting(b, o, FEWER_SETS);
    point_bench_close(b);
  }
  free(b);
}
