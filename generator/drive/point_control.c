#include "generator/drive/point_control.h"

#include <float.h>
#include <math.h>
#include <string.h>

#include "dsl/base/elementary.h"
#include "generator/drive/drive_motion.h"

enum { MOST = PL_MAX_STRAINS, NOTHING = -1 };

static const double REACHED = 1e-13; /* of stiffness times strain: as near as rounding lets it */
static const double SUDDEN = 1e-9;   /* of a step: how long it takes to begin */
static const double ALL_BUT_REACHED = 1e-9; /* of the stresses, where it comes no nearer */
static const double MOST_LOST = 1e-7;       /* of the stresses: what rounding may leave open */
static const double SINGULAR = 1e-13;       /* of a matrix's largest entry */

/* --- who prescribes what ---------------------------------------------------------------------- */

/* Component of a quantity, as the point's are numbered; -1 where the plane has none. */
static int component_of(drive_quantity q, int dimensions) {
  static const int in_plane[] = {0, 1, -1, 2, -1, -1};
  const int k = (int)q - (int)(q >= DRIVE_STRESS_XX ? DRIVE_STRESS_XX : DRIVE_STRAIN_XX);
  return dimensions == 2 ? in_plane[k] : k;
}

static const char *quantity_name(drive_quantity q) {
  static const char *const names[] = {
#define X(code, name, unit) name,
      DRIVE_QUANTITIES(X)
#undef X
  };
  return names[q];
}

static bool refuse_component(const drive_piece *p, diagnostics *d) {
  diag_report(d, DIAG_LAW_KIND, p->where, "a point in the plane is not driven by `%s`",
              quantity_name(p->quantity));
  diag_hint(d, "the components are xx, yy, xy; &point setting = 'space' has all six");
  return false;
}

static bool refuse_both(const point_control *c, int k, const drive_piece *p, diagnostics *d) {
  diag_report(d, DIAG_CONFLICT, p->where, "`%s` cannot be prescribed beside `%s`",
              quantity_name(p->quantity), quantity_name((drive_quantity)c->follows[k]));
  diag_note(d, c->where[k], "that is prescribed here");
  diag_hint(d, "leave out one of the two: it is what the law answers");
  return false;
}

static bool read_pieces(const drive_input *in, int dimensions, point_control *c, diagnostics *d) {
  for (int n = 0; n < in->piece_count; n++) {
    const drive_piece *p = &in->pieces[n];
    const int k = component_of(p->quantity, dimensions);
    if (k < 0) return refuse_component(p, d);
    if (c->follows[k] == NOTHING) {
      c->follows[k] = (int)p->quantity;
      c->by_stress[k] = p->quantity >= DRIVE_STRESS_XX;
      c->where[k] = p->where;
    } else if (c->follows[k] != (int)p->quantity) {
      return refuse_both(c, k, p, d);
    }
  }
  return true;
}

/* --- tests ------------------------------------------------------------------------------------ */

static const char *test_name(drive_test test) {
  static const char *const names[] = {
#define X(code, name) name,
      DRIVE_TESTS(X)
#undef X
  };
  return names[test];
}

/* A test drives this component and no other. */
static bool drives_alone(const drive_input *in, int dimensions, int wanted, const point_control *c,
                         diagnostics *d) {
  const char *component = point_component_name(dimensions, wanted);
  for (int k = 0; k < c->strains; k++) {
    if ((c->follows[k] != NOTHING) == (k == wanted)) continue;
    diag_report(d, k == wanted ? DIAG_MISSING_KEY : DIAG_CONFLICT,
                k == wanted ? deck_where(&in->point.item, "test") : c->where[k],
                "the test '%s' is driven by `strain_%s` or `stress_%s`%s",
                test_name(in->point.test), component, component,
                k == wanted ? ": there is no such &path" : " alone");
    diag_hint(d, "&point test = 'components' leaves every component to a &path of its own");
    return false;
  }
  return true;
}

/* All that no path names bears no stress, from component `from` on. */
static void free_of_stress(const drive_input *in, int from, point_control *c) {
  for (int k = from; k < c->strains; k++)
    if (c->follows[k] == NOTHING) {
      c->by_stress[k] = true;
      c->where[k] = deck_where(&in->point.item, "test");
    }
}

/* All directions alike: no shear. */
static void all_alike(int dimensions, point_control *c) {
  for (int k = 1; k < c->strains; k++) {
    c->by_stress[k] = c->by_stress[0];
    c->follows[k] = point_is_shear(dimensions, k) ? NOTHING : c->follows[0];
    c->where[k] = c->where[0];
  }
}

/* What leaves the plane z bears no stress; in the plane the setting says so. */
static bool read_plane_stress(const drive_input *in, int dimensions, point_control *c,
                              diagnostics *d) {
  static const int outside[] = {2, 4, 5};
  const span where = deck_where(&in->point.item, "test");
  if (dimensions == 2) {
    diag_report(d, DIAG_CONFLICT, where, "the test 'plane stress' is one of a point in space");
    diag_hint(d, "in the plane &point setting = 'plane_stress' does the same; or give setting = "
                 "'space'");
    return false;
  }
  for (int n = 0; n < 3; n++) {
    const int k = outside[n];
    if (c->follows[k] != NOTHING) {
      diag_report(d, DIAG_CONFLICT, c->where[k],
                  "the test 'plane stress' leaves no stress there: `%s` is not driven",
                  quantity_name((drive_quantity)c->follows[k]));
      return false;
    }
    c->by_stress[k] = true;
    c->where[k] = where;
  }
  return true;
}

bool point_control_read(const drive_input *in, int dimensions, point_control *out, diagnostics *d) {
  const int shear = dimensions == 2 ? 2 : 3;
  *out = (point_control){.strains = PL_STRAINS(dimensions)};
  for (int k = 0; k < MOST; k++)
    out->follows[k] = NOTHING;
  if (!read_pieces(in, dimensions, out, d)) return false;
  switch (in->point.test) {
  case DRIVE_TEST_UNIAXIAL_STRESS:
  case DRIVE_TEST_SHEAR:
    if (!drives_alone(in, dimensions, in->point.test == DRIVE_TEST_SHEAR ? shear : 0, out, d))
      return false;
    free_of_stress(in, 0, out);
    return true;
  case DRIVE_TEST_HYDROSTATIC:
    if (!drives_alone(in, dimensions, 0, out, d)) return false;
    all_alike(dimensions, out);
    return true;
  case DRIVE_TEST_PLANE_STRESS:
    return read_plane_stress(in, dimensions, out, d);
  default:
    return true;
  }
}

/* --- Newton's method -------------------------------------------------------------------------- */

typedef struct search {
  const point_control *control;
  driven_point *point;
  const strained *before;
  double since;             /* s: from there on */
  double wanted[MOST];      /* stresses, where they are prescribed */
  int unknown[MOST], count; /* components */
  strained at;
  stressed answer;
  double gap[MOST], residual; /* what is left, Pa; the largest */
  bool too_far;               /* a step was left out: its stresses are lost in rounding */
} search;

/* The rates of the strains that are found follow from them. */
static void settle(search *s) {
  for (int n = 0; n < s->count; n++) {
    const int k = s->unknown[n];
    s->at.rate[k] = (s->at.strain[k] - s->before->strain[k]) / s->since;
  }
  s->answer = driven_point_step(s->point, &s->at);
  s->residual = 0;
  for (int n = 0; n < s->count; n++) {
    s->gap[n] = s->wanted[s->unknown[n]] - s->answer.stress[s->unknown[n]];
    if (!(fabs(s->gap[n]) <= s->residual)) s->residual = fabs(s->gap[n]);
  }
}

/* The stress by a rate: of a small one, as the stress is all but linear in it. */
static void add_rates(search *s, int column, double matrix[MOST][MOST]) {
  const int k = s->unknown[column];
  const double rate = s->at.rate[k], by = pl_fmax(1e-6 * fabs(rate), 1e-9 / s->since);
  double stress[2][MOST];
  for (int side = 0; side < 2; side++) {
    s->at.rate[k] = rate + (side ? by : -by);
    const stressed there = driven_point_step(s->point, &s->at);
    memcpy(stress[side], there.stress, sizeof stress[side]);
  }
  s->at.rate[k] = rate;
  for (int n = 0; n < s->count; n++)
    matrix[n][column] +=
        (stress[1][s->unknown[n]] - stress[0][s->unknown[n]]) / (2 * by) / s->since;
}

static void jacobian(search *s, double matrix[MOST][MOST]) {
  double tangent[MOST][MOST];
  const int dimensions = s->point->kernel->dimensions;
  driven_point_tangent(s->point, &s->at, tangent);
  for (int b = 0; b < s->count; b++) {
    const int k = s->unknown[b];
    for (int a = 0; a < s->count; a++)
      matrix[a][b] = tangent[s->unknown[a]][k] * (point_is_shear(dimensions, k) ? 2 : 1);
    if (s->point->kernel->reads_rates) add_rates(s, b, matrix);
  }
}

static double largest(int count, double a[MOST][MOST]) {
  double most = 0;
  for (int row = 0; row < count; row++)
    for (int column = 0; column < count; column++)
      most = pl_fmax(most, fabs(a[row][column]));
  return most;
}

/* Gauss's elimination with pivots. False where the matrix is singular, as far as rounding tells. */
static bool solve(int count, double a[MOST][MOST], double *x) {
  const double least = SINGULAR * largest(count, a);
  for (int k = 0; k < count; k++) {
    int pivot = k;
    for (int row = k + 1; row < count; row++)
      if (fabs(a[row][k]) > fabs(a[pivot][k])) pivot = row;
    if (!(fabs(a[pivot][k]) > least) || !isfinite(a[pivot][k])) return false;
    for (int c = 0; c < count && pivot != k; c++) {
      const double kept = a[k][c];
      a[k][c] = a[pivot][c];
      a[pivot][c] = kept;
    }
    const double kept = x[k];
    x[k] = x[pivot];
    x[pivot] = kept;
    for (int row = k + 1; row < count; row++) {
      const double part = a[row][k] / a[k][k];
      for (int c = k; c < count; c++)
        a[row][c] -= part * a[k][c];
      x[row] -= part * x[k];
    }
  }
  for (int k = count - 1; k >= 0; k--) {
    for (int c = k + 1; c < count; c++)
      x[k] -= a[k][c] * x[c];
    x[k] /= a[k][k];
  }
  return true;
}

/* --- what is near enough ---------------------------------------------------------------------- */

/* Stiffness times strain, Pa: stresses are differences of such, C:(strain - eps_p). */
static double summand(const search *s) {
  double strain = 0;
  for (int k = 0; k < s->control->strains; k++)
    strain = pl_fmax(strain, fabs(s->at.strain[k]));
  return strain * s->control->stiffness;
}

/* Pa: what rounding leaves open of them. */
static double rounding(const search *s) {
  return 16 * DBL_EPSILON * summand(s);
}

/* Pa: the largest stress that was asked for or borne, this step's with it. What a law bears where
   strains are prescribed counts if it is more than rounding: strains that run away have no say. */
static double size_of(const search *s) {
  double size = s->control->size;
  for (int k = 0; k < s->point->stresses; k++) {
    const double found = fabs(s->answer.stress[k]);
    if (k < s->control->strains && s->control->by_stress[k])
      size = pl_fmax(size, fabs(s->wanted[k]));
    else if (rounding(s) <= MOST_LOST * found)
      size = pl_fmax(size, found);
  }
  return size;
}

/* Whether the stresses can still be told from what rounding leaves open. */
static bool is_told(const search *s) {
  const double size = size_of(s);
  return !(size > 0 && rounding(s) > MOST_LOST * size);
}

/* Measured by the stresses, never by the strain that was found for them: a law that flows at a
   constant stress gives any strain. */
static bool is_found(const search *s) {
  return is_told(s) && s->residual <= pl_fmax(ALL_BUT_REACHED * size_of(s), rounding(s));
}

/* As near as rounding lets it. */
static bool is_exact(const search *s) {
  double stress = size_of(s);
  for (int k = 0; k < s->control->strains; k++)
    stress = pl_fmax(stress, fabs(s->answer.stress[k]));
  return !(s->residual > REACHED * (summand(s) + stress));
}

/* --- steps ------------------------------------------------------------------------------------ */

/* False where the tangent is singular: the law flows at a constant stress. */
static bool newton_step(search *s, double *change) {
  double matrix[MOST][MOST];
  jacobian(s, matrix);
  memcpy(change, s->gap, sizeof s->gap);
  return solve(s->count, matrix, change);
}

/* That of a body as stiff as the law is at first: from a flat tangent it unloads. */
static bool stiff_step(const search *s, double *change) {
  for (int n = 0; n < s->count; n++)
    change[n] = s->gap[n] / s->control->stiffness;
  return s->control->stiffness > 0;
}

/* A step, shortened until it leads nearer, and not where stresses are lost in rounding. False, and
   nothing moved, where none does. */
static bool take(search *s, const double *change) {
  enum { HALVINGS = 12 };
  const search here = *s;
  double part = 1;
  for (int k = 0; k < HALVINGS; k++, part *= 0.5) {
    for (int n = 0; n < s->count; n++)
      s->at.strain[s->unknown[n]] = here.at.strain[s->unknown[n]] + part * change[n];
    settle(s);
    if (!(s->residual < here.residual)) continue;
    if (is_told(s)) return true;
    s->too_far = true;
  }
  const bool too_far = s->too_far;
  *s = here;
  s->too_far = too_far;
  return false;
}

static bool go_nearer(search *s) {
  double change[MOST];
  if (newton_step(s, change) && take(s, change)) return true;
  if (stiff_step(s, change) && take(s, change)) return true;
  settle(s);
  return false;
}

static bool converge(search *s) {
  enum { MOST_STEPS = 60 };
  settle(s);
  for (int step = 0; step < MOST_STEPS && !is_exact(s); step++)
    if (!go_nearer(s)) break;
  return is_found(s);
}

/* The unknown that misses most, rather one that a path prescribes. */
static int worst_of(const search *s) {
  int worst = 0, by_path = -1;
  for (int n = 0; n < s->count; n++) {
    if (!(fabs(s->gap[n]) <= fabs(s->gap[worst]))) worst = n;
    if (s->control->follows[s->unknown[n]] == NOTHING) continue;
    if (by_path < 0 || !(fabs(s->gap[n]) <= fabs(s->gap[by_path]))) by_path = n;
  }
  return by_path >= 0 && fabs(s->gap[by_path]) > ALL_BUT_REACHED * size_of(s) ? by_path : worst;
}

static void report(const search *s, double time, diagnostics *d) {
  const int worst = worst_of(s), k = s->unknown[worst];
  const char *name = point_component_name(s->point->kernel->dimensions, k);
  diag_report(d, DIAG_OUT_OF_BOUNDS, s->control->where[k],
              "at %.6g s no strain is found that gives a stress_%s of %.6g Pa; the nearest gives "
              "%.6g Pa, %.2g Pa off",
              time, name, s->wanted[k], s->answer.stress[k], fabs(s->gap[worst]));
  if (s->too_far || !is_told(s))
    diag_note(d, s->control->where[k],
              "strains so large that rounding leaves %.2g Pa of the stresses open are left out",
              MOST_LOST * size_of(s));
  diag_hint(d,
            "beyond its largest stress a law is driven by strain (strain_%s); else more "
            "`steps` help",
            name);
}

bool point_control_reach(point_control *c, const drive_input *in, driven_point *p, double time,
                         double inside, const strained *before, strained *to, stressed *answer,
                         diagnostics *d) {
  static const strained rest = {.step = 0};
  const bool sudden = !before && p->kernel->reads_rates;
  search s = {.control = c,
              .point = p,
              .before = before ? before : &rest,
              .since = sudden ? SUDDEN * to->step : to->step,
              .at = {.step = to->step, .advance = to->advance}};
  for (int k = 0; k < c->strains; k++) {
    const drive_quantity q = (drive_quantity)c->follows[k];
    const bool given = c->follows[k] != NOTHING;
    if (c->by_stress[k]) {
      s.unknown[s.count++] = k;
      s.wanted[k] = given ? drive_at(in, q, time) : 0;
      s.at.strain[k] = s.before->strain[k];
    } else if (given) {
      s.at.strain[k] = drive_at(in, q, time);
      s.at.rate[k] = drive_slope(in, q, inside);
    }
  }
  const bool found = converge(&s);
  if (found) c->size = size_of(&s);
  *to = s.at;
  *answer = s.answer;
  bool finite = true; /* else the row says so */
  for (int k = 0; k < p->stresses; k++)
    finite = finite && isfinite(s.answer.stress[k]);
  if (!found && finite) report(&s, time, d);
  return found || !finite;
}
