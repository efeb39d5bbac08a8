#include "runtime/deck/group_load.h"

#include <math.h>

#include "dsl/base/elementary.h"
#include "runtime/deck/deck_check.h"
#include "runtime/deck/deck_formula.h"
#include "runtime/deck/deck_load.h"
#include "runtime/deck/deck_value.h"
#include "runtime/deck/group_monitor.h"
#include "runtime/deck/lattice_kind.h"
#include "runtime/geometry/gmsh_mesh.h"

#define REGION_KEY(group, text)                                                                    \
  { .name = "region", .type = DECK_NAME, .required = true, DECK_AT(group, region), .doc = text }

/* --- support ---------------------------------------------------------------------------------- */

static const deck_key_info support_keys[] = {
    REGION_KEY(support, "what is held"),
    {.name = "fix",
     .type = DECK_FIXED,
     .choices = "x|y|z|xy|xz|yz|xyz|rotation|rotation_x|rotation_y|rotation_z",
     .required = true,
     DECK_AT(support, fix),
     .doc = "directions that are held; several: `fix = 'x', 'rotation'`. Here and below, `z` and "
            "rotations about x, y and z are for lattices in space, `rotation` for those in the "
            "plane; in space `fix = 'rotation'` holds all three"},
};

/* Of all regions; NULL where the region is not known. */
static deck_motions *motions_of(deck_reader *r, const char *region) {
  const int k = region ? deck_find_region(r->k, region) : -1;
  if (!r->motions)
    r->motions = arena_alloc(r->memory, ((size_t)r->k->region_count + 1) * sizeof *r->motions);
  return k < 0 ? NULL : &r->motions[k];
}

/* Of an item in which nothing is wrong; `components` has a bit each. */
static void note_motions(deck_reader *r, const char *region, int components, span where) {
  deck_motions *m = motions_of(r, region);
  for (int c = 0; m && c < PL_MAX_DOF; c++)
    if (components & 1 << c && m->of[c].end == 0) m->of[c] = where;
}

static void check_support(deck_reader *r, const namelist_group *from, void *into) {
  deck_support *item = into;
  (void)from;
  const int errors = r->d->errors;
  const span where = deck_where(&item->item, "fix");
  deck_moving_region_known(r, &item->item, item->region);
  item->fix = deck_components(r, where, item->region, item->fix);
  if (r->d->errors == errors) note_motions(r, item->region, item->fix, where);
}

DECK_LIST(support, .identity = "region", .check = check_support,
          .doc = "Holds particles where they are.");

/* --- drive ------------------------------------------------------------------------------------ */

static const deck_key_info drive_keys[] = {
    REGION_KEY(drive, "what is moved"),
    {.name = "component",
     .type = DECK_CHOICE,
     .choices = DECK_COMPONENTS,
     .required = true,
     DECK_AT(drive, component),
     .doc = "direction of the motion"},
    {.name = "velocity",
     .type = DECK_LATER,
     .unit = "m/s; rotation: rad/s",
     DECK_NOT_KEPT,
     .doc = "full velocity"},
    {.name = "displacement",
     .type = DECK_LATER,
     .unit = "m; rotation: rad",
     DECK_NOT_KEPT,
     .doc = "full displacement, counted from where the region is at `start`"},
    {.name = "acceleration",
     .type = DECK_LATER,
     .unit = "m/s^2; rotation: rad/s^2",
     DECK_NOT_KEPT,
     .doc = "constant acceleration from rest at `start` on"},
    DECK_TIME_KEYS,
};

/* A particle cannot follow two motions; regions that overlap are found when their particles are
 * known. */
static void check_other_motions(deck_reader *r, const deck_drive *item) {
  const span where = deck_where(&item->item, "component");
  const deck_motions *m = motions_of(r, item->region);
  const span other = m ? m->of[item->component] : (span){0};
  if (other.end == 0) return;
  const char *component = deck_component_of(r, item->region, item->component);
  diag_report(r->d, DIAG_CONFLICT, where, "`%s` of region `%s` has two motions", component,
              deck_shown(r->memory, item->region));
  diag_note(r->d, other, "the other one");
}

/* A load without a history grows with the increments of a quasi-static run, up to its end. */
static void spread(const deck_reader *r, const namelist_group *from, time_function *f) {
  const double rest = pl_fmin(r->k->simulation.end_time, time_function_end(f)) - f->start;
  if (r->k->relaxation.increments < 1 || f->shape != TIME_CONSTANT || !(rest > 0)) return;
  if (namelist_find(from, "history")) return;
  f->shape = TIME_RAMP_HOLD;
  f->rise = rest;
}

static void warn_of_jump(deck_reader *r, const namelist_group *from, const time_function *f) {
  if (f->formula || time_function_jump(f) == 0 || r->k->relaxation.increments > 0) return;
  const bool table = f->shape == TIME_TABLE;
  const namelist_key *at = namelist_find(from, !table ? "displacement" : "values");
  diag_report(r->d, DIAG_DECK_WARNING, (at ? at : namelist_find(from, "file"))->name_where,
              table ? "this displacement begins with a jump"
                    : "this displacement comes all at once");
  diag_hint(r->d, table ? "let the first value be 0" : "give a `rise`, e.g. rise = '1 ms'");
}

void deck_spread_displacement(deck_reader *r, const namelist_group *from, time_function *f) {
  spread(r, from, f);
  warn_of_jump(r, from, f);
}

/* The velocity that a constant acceleration has given. */
static bool accelerate(deck_reader *r, const deck_drive *item, time_function *motion) {
  if (motion->shape == TIME_CONSTANT) {
    motion->shape = TIME_RAMP;
    motion->rise = 1;
    return true;
  }
  diag_report(r->d, DIAG_CONFLICT, deck_where(&item->item, "acceleration"),
              "an acceleration is constant, without a history");
  diag_hint(r->d, "give a `velocity` by a table or a `formula` of t");
  return false;
}

static void complete_drive(deck_reader *r, const namelist_group *from, deck_drive *item) {
  deck_moving_region_known(r, &item->item, item->region);
  if (!deck_take_component(r, &item->item, item->region, &item->component)) return;
  const bool rotates = deck_is_rotation(r, item->region, item->component);
  check_other_motions(r, item);
  const deck_load_kind kinds[] = {
      {"velocity", rotates ? "1/s" : "m/s", false, &deck_formula_of_all},
      {"displacement", rotates ? "1" : "m", false, &deck_formula_of_all},
      {"acceleration", rotates ? "1/s^2" : "m/s^2", false, &deck_formula_of_all}};
  const bool accelerated = namelist_find(from, "acceleration"); /* no file or formula is one */
  const int kind = deck_load_kind_of(r->memory, from, kinds, 2 + accelerated, r->d);
  if (kind < 0) return;
  item->is_displacement = kind == 1;
  if (!deck_load_read(r->memory, from, &kinds[kind], &item->motion, r->d)) {
    if (rotates && r->d->items[r->d->count - 1].code == DIAG_UNITS)
      diag_hint(r->d, "a rotation is in rad, its velocity in rad/s");
    return;
  }
  if (kind == 2 && !accelerate(r, item, &item->motion)) return;
  deck_warn_late(r, &item->item, "start", item->motion.start);
  if (item->is_displacement) deck_spread_displacement(r, from, &item->motion);
}

static void check_drive(deck_reader *r, const namelist_group *from, void *into) {
  deck_drive *item = into;
  const int errors = r->d->errors;
  complete_drive(r, from, item);
  if (r->d->errors == errors)
    note_motions(r, item->region, 1 << item->component, deck_where(&item->item, "component"));
}

DECK_LIST(drive, .identity = "region", .check = check_drive,
          .doc = "Prescribed motion of a region from `start` to `end`; free before and after. Give "
                 "`velocity`, `displacement` or `acceleration`.");

/* --- force ------------------------------------------------------------------------------------ */

static const deck_key_info force_keys[] = {
    REGION_KEY(force, "what is loaded"),
    {.name = "component",
     .type = DECK_LATER,
     .choices = DECK_COMPONENTS,
     .fallback = "= 'rotation' with a moment in the plane; else required",
     DECK_NOT_KEPT,
     .doc = "direction of the load"},
    {.name = "total",
     .former = "force", /* Fortran's own reader wants no variable named like its group */
     .type = DECK_LATER,
     .unit = "N",
     DECK_NOT_KEPT,
     .doc = "full force, of all particles together (`x`, `y`, `z`)"},
    {.name = "moment",
     .type = DECK_LATER,
     .unit = "N*m",
     DECK_NOT_KEPT,
     .doc =
         "full moment, of all particles together (`rotation`; in space about an axis): a couple on "
         "each, see [Rotations](#rotations); `&end_moment` bends a section as a whole"},
    {.name = "per_length",
     .type = DECK_LATER,
     .unit = "N/m",
     DECK_NOT_KEPT,
     .doc = "full force per length of a row of particles or of a bar (`x`, `y`, `z`): each bears "
            "its part of the line, half way to its neighbours, see [Loads along a "
            "line](#loads-along-a-line)"},
    DECK_TIME_KEYS,
};

/* What gives a load without its full value. */
static const namelist_key *source_of(const namelist_group *from) {
  const namelist_key *written = namelist_find(from, "formula");
  return written ? written : namelist_find(from, "file");
}

/* A force has a direction, and so has a moment in space. */
static bool lacks_component(deck_reader *r, const namelist_group *from, const char *region,
                            bool rotates) {
  const bool space = deck_dimensions_of_region(r, region) == 3;
  if (rotates && !space) return false;
  diag_report(r->d, DIAG_MISSING_KEY, from->where, "`&force` has no `component`");
  diag_hint(r->d, rotates ? "component = 'rotation_x', 'rotation_y' or 'rotation_z'"
                  : space ? "component = 'x', 'y' or 'z'"
                          : "component = 'x' or 'y'");
  return true;
}

enum { TOTAL, MOMENT, PER_LENGTH, FORCE_KINDS };

static const deck_load_kind force_kinds[FORCE_KINDS] = {
    [TOTAL] = {"total", "N", false, &deck_formula_of_all},
    [MOMENT] = {"moment", "N*m", false, &deck_formula_of_all},
    [PER_LENGTH] = {"per_length", "N/m", false, &deck_formula_of_all}};

/* What says it is the key, or the unit of the formula or file alone. */
static void report_kind(deck_reader *r, const namelist_group *from, int kind, const char *component,
                        bool rotates) {
  const namelist_key *key = namelist_find(from, force_kinds[kind].key);
  if (key) {
    diag_report(r->d, DIAG_CONFLICT, key->name_where, "`%s` does not go with component = '%s'",
                force_kinds[kind].key, component);
    diag_hint(r->d, rotates ? "write `total` or `per_length`" : "write `moment`");
    return;
  }
  const char *expected =
      rotates ? arena_printf(r->memory, "a force along %s is in N or N/m", component)
              : arena_printf(r->memory, "a moment, component = '%s', is in N*m", component);
  diag_report(r->d, DIAG_UNITS, source_of(from)->value_where, "%s, this is in %s", expected,
              force_kinds[kind].unit);
}

static void check_force(deck_reader *r, const namelist_group *from, void *into) {
  deck_force *item = into;
  deck_moving_region_known(r, &item->item, item->region);
  const int kind = deck_load_kind_of(r->memory, from, force_kinds, FORCE_KINDS, r->d);
  const namelist_key *component = namelist_find(from, "component");
  if (kind < 0) return;
  const bool rotates = kind == MOMENT;
  item->per_length = kind == PER_LENGTH;
  item->component = rotates ? DECK_WRITTEN_ROTATION : 0;
  if (component) item->component = deck_choice_read(r->memory, component, DECK_COMPONENTS, r->d);
  if (!component && lacks_component(r, from, item->region, rotates)) return;
  if (item->component < 0 || !deck_take_component(r, &item->item, item->region, &item->component))
    return;
  if (rotates != deck_is_rotation(r, item->region, item->component)) {
    report_kind(r, from, kind, deck_component_of(r, item->region, item->component), rotates);
    return;
  }
  if (!deck_load_read(r->memory, from, &force_kinds[kind], &item->force, r->d)) return;
  deck_warn_late(r, &item->item, "start", item->force.start);
  spread(r, from, &item->force);
}

DECK_LIST(force, .identity = "region", .check = check_force,
          .doc = "Force on a region, shared equally by its particles, or by length along a row of "
                 "them. Give `total`, `moment` or `per_length`.");

/* --- traction --------------------------------------------------------------------------------- */

static const deck_key_info traction_keys[] = {
    {.name = "mesh",
     .type = DECK_NAME,
     .required = true,
     DECK_AT(traction, mesh),
     .doc = "name of the mesh"},
    {.name = "from",
     .type = DECK_PLACE,
     .unit = "m",
     .fallback = "= required, or `edge`",
     DECK_AT(traction, from),
     .doc = "one end of the straight line that is loaded: an edge of the mesh, a part of it, or a "
            "line inside"},
    {.name = "to",
     .type = DECK_PLACE,
     .unit = "m",
     .fallback = "= required, or `edge`",
     DECK_AT(traction, to),
     .doc = "its other end"},
    {.name = "edge",
     .type = DECK_NAME,
     .fallback = "= none",
     DECK_AT(traction, edge),
     .doc = "instead, of the mesh of a file: the physical group of lines that are loaded"},
    {.name = "component",
     .type = DECK_CHOICE,
     .choices = "x|y|normal|tangential",
     .required = true,
     DECK_AT(traction, component),
     .doc =
         "direction of the load; of an `edge` also along its normal out of the body, or along it, "
         "counter-clockwise around the body"},
    {.name = "stress",
     .type = DECK_LATER,
     .unit = "Pa",
     DECK_NOT_KEPT,
     .doc = "full force per area of the line and the thickness"},
    DECK_TIME_KEYS,
};

static const deck_load_kind traction_kind = {"stress", "Pa", false, &deck_formula_of_all};

/* A name of lines, or what is there instead. */
static void check_edge_name(deck_reader *r, const deck_traction *item, const gmsh_mesh *file) {
  const gmsh_group *group = gmsh_mesh_group(file, item->edge);
  const char **names = arena_alloc(r->memory, ((size_t)file->group_count + 1) * sizeof(char *));
  int count = 0;
  const span where = deck_where(&item->item, "edge");
  for (int k = 0; k < file->group_count && !group; k++)
    if (file->groups[k].dimension == 1) names[count++] = file->groups[k].name;
  if (!group) {
    diag_report(r->d, DIAG_UNKNOWN_NAME, where, "the file of `%s` has no physical group `%s`",
                item->mesh, deck_shown(r->memory, item->edge));
    deck_suggest(r->d, item->edge, names, count, "its groups of lines are");
  } else if (group->dimension != 1) {
    diag_report(r->d, DIAG_CONFLICT, where, "`%s` is a physical group of %s, not of lines",
                deck_shown(r->memory, item->edge), group->dimension ? "cells" : "points");
  }
  for (int k = 0; group && group->dimension == 1 && k < group->item_count; k++) {
    const gmsh_side *side = &file->sides[group->items[k]];
    if (side->cell >= 0) continue;
    diag_report(r->d, DIAG_CONFLICT, where,
                "the line of `%s` from node %lld to %lld is no side of a cell",
                deck_shown(r->memory, item->edge), (long long)file->tag[side->node[0]],
                (long long)file->tag[side->node[1]]);
    return;
  }
}

static void check_edge(deck_reader *r, const namelist_group *from, const deck_traction *item) {
  const int lattice = item->mesh ? deck_find_lattice(r->k, item->mesh) : -1;
  deck_refuse_both(r, from, "edge", "from");
  deck_refuse_both(r, from, "edge", "to");
  if (lattice < 0 || r->k->lattices[lattice].item.faulty) return;
  if (r->k->lattices[lattice].gmsh) {
    check_edge_name(r, item, r->k->lattices[lattice].gmsh);
    return;
  }
  diag_report(r->d, DIAG_CONFLICT, deck_where(&item->item, "edge"),
              "edges have names in the mesh of a file, and `%s` is none",
              deck_shown(r->memory, item->mesh));
  diag_hint(r->d, "give the ends of the line, `from` and `to`");
}

/* A straight line by its ends. */
static void check_line(deck_reader *r, const namelist_group *from, const deck_traction *item) {
  static const char *const ends[] = {"from", "to"};
  const int lattice = item->mesh ? deck_find_lattice(r->k, item->mesh) : -1;
  if (lattice >= 0 && r->k->lattices[lattice].gmsh) {
    diag_report(r->d, DIAG_CONFLICT, from->where,
                "`%s` is the mesh of a file: its loaded lines are an `edge`",
                deck_shown(r->memory, item->mesh));
    diag_hint(r->d, "edge = 'right': a physical group of curves in Gmsh");
    return;
  }
  for (int k = 0; k < 2; k++) {
    if (namelist_find(from, ends[k])) continue;
    diag_report(r->d, DIAG_MISSING_KEY, from->where, "`&traction` has no `%s`", ends[k]);
    diag_hint(r->d,
              "from, to: the ends of the straight line that is loaded (m); of the mesh of a file "
              "also `edge`");
    return;
  }
  if (item->component > 1) {
    diag_report(r->d, DIAG_CONFLICT, deck_where(&item->item, "component"),
                "a line that is given by its ends is loaded along x or y");
    diag_hint(r->d, "the normal is known of an `edge` of the mesh of a file");
  }
  if (item->from[0] == item->to[0] && item->from[1] == item->to[1])
    diag_report(r->d, DIAG_BAD_VALUE, deck_where(&item->item, "to"),
                "the line that is loaded ends where it begins");
}

static void check_traction(deck_reader *r, const namelist_group *from, void *into) {
  deck_traction *item = into;
  deck_mesh_known(r, &item->item, item->mesh);
  deck_check_places(r, from, &deck_group_traction, 2);
  if (deck_load_kind_of(r->memory, from, &traction_kind, 1, r->d) < 0) return;
  if (item->edge)
    check_edge(r, from, item);
  else
    check_line(r, from, item);
  if (!deck_load_read(r->memory, from, &traction_kind, &item->force, r->d)) return;
  deck_warn_late(r, &item->item, "start", item->force.start);
  spread(r, from, &item->force);
}

DECK_MORE(traction, force, .identity = "mesh", .check = check_traction,
          .doc = "Force per area on a straight line of a mesh, or on an edge of one from a file. "
                 "Nodes bear the integral of their "
                 "functions over it.");

/* --- end moment ------------------------------------------------------------------------------- */

static const deck_key_info end_moment_keys[] = {
    REGION_KEY(end_moment, "what is loaded, e.g. the end columns of a beam"),
    {.name = "moment",
     .type = DECK_LATER,
     .unit = "N*m",
     .fallback = "= required, but for a file or formula with a unit",
     DECK_NOT_KEPT,
     .doc = "full moment; counter-clockwise on the body is positive"},
    DECK_TIME_KEYS,
};

static void check_end_moment(deck_reader *r, const namelist_group *from, void *into) {
  deck_end_moment *item = into;
  static const deck_load_kind kind = {"moment", "N*m", false, &deck_formula_of_time};
  deck_moving_region_known(r, &item->item, item->region);
  if (deck_load_kind_of(r->memory, from, &kind, 1, r->d) < 0 ||
      !deck_load_read(r->memory, from, &kind, &item->moment, r->d))
    return;
  deck_warn_late(r, &item->item, "start", item->moment.start);
  spread(r, from, &item->moment);
}

DECK_LIST(end_moment, .identity = "region", .check = check_end_moment,
          .doc =
              "Moment on a region about z, in the plane and in space: forces along x, linear in y, "
              "without resultant. They bend a body as a whole, whatever its law.");

/* --- protect ---------------------------------------------------------------------------------- */

static const deck_key_info protect_keys[] = {
    REGION_KEY(protect, "around which bonds stay whole"),
    {.name = "radius",
     .type = DECK_REAL,
     .unit = "1",
     .bound = BOUND_NOT_NEGATIVE,
     .fallback = "0",
     DECK_AT(protect, radius),
     .doc = "in spacings: all bonds of particles within it; 0: of the region's own particles"},
};

static void check_protect(deck_reader *r, const namelist_group *from, void *into) {
  deck_protect *item = into;
  (void)from;
  deck_item_region_known(r, &item->item, item->region);
}

DECK_LIST(protect, .identity = "region", .check = check_protect,
          .doc = "Bonds near a region take no damage.");

/* --- damping ---------------------------------------------------------------------------------- */

static const deck_key_info damping_keys[] = {
    {.name = "kind",
     .type = DECK_WORD,
     .choices = "mass",
     .fallback = "'mass'",
     DECK_NOT_KEPT,
     .doc = "`mass`: force = -rate * mass * velocity"},
    {.name = "rate",
     .type = DECK_REAL,
     .unit = "1/s",
     .bound = BOUND_POSITIVE,
     .fallback = "= that of `ratio`",
     DECK_AT(damping, rate),
     .doc = "how fast velocities decay"},
    {.name = "ratio",
     .type = DECK_REAL,
     .unit = "1",
     .bound = BOUND_POSITIVE,
     .fallback = "= none",
     DECK_AT(damping, ratio),
     .doc = "or give this part of the critical damping of a mode: a rate of twice its angular "
            "frequency times this"},
    {.name = "mode",
     .type = DECK_COUNT,
     .fallback = "1",
     .most = 100,
     DECK_AT(damping, mode),
     .doc = "of a `ratio`: number of the mode, from the lowest on"},
    {.name = "from",
     .type = DECK_REAL,
     .unit = "s",
     .bound = BOUND_NOT_NEGATIVE,
     .fallback = "0",
     DECK_AT(damping, from),
     .doc = "begin"},
    {.name = "until",
     .type = DECK_REAL,
     .unit = "s",
     .bound = BOUND_POSITIVE,
     .fallback = "= the end of the run",
     DECK_AT(damping, until),
     .doc = "end"},
};

/* Just one of the two. */
static void check_strength(deck_reader *r, const namelist_group *from, const deck_damping *item) {
  deck_refuse_both(r, from, "rate", "ratio");
  if (item->rate == 0 && item->ratio == 0) {
    diag_report(r->d, DIAG_MISSING_KEY, item->item.where, "`&damping` needs `rate` or `ratio`");
    diag_hint(r->d, "rate = '1000 1/s' is a rate, ratio = 0.2 a fifth of the critical damping of "
                    "the lowest mode");
  } else if (item->ratio == 0 && namelist_find(from, "mode")) {
    diag_report(r->d, DIAG_UNKNOWN_KEY, namelist_find(from, "mode")->name_where,
                "`mode` goes with `ratio`");
  } else if (item->mode < 1) {
    diag_report(r->d, DIAG_OUT_OF_BOUNDS, deck_where(&item->item, "mode"),
                "modes are counted from 1");
  }
}

static void check_damping(deck_reader *r, const namelist_group *from, void *into) {
  deck_damping *item = into;
  check_strength(r, from, item);
  if (!namelist_find(from, "until")) item->until = INFINITY;
  deck_warn_late(r, &item->item, "from", item->from);
  if (item->until > item->from) return;
  diag_report(r->d, DIAG_OUT_OF_BOUNDS, deck_where(&item->item, "until"),
              "`until` must be later than `from`");
}

DECK_LIST(damping, .check = check_damping, .doc = "Slows the motion of every particle for a time.");

/* --- gravity ---------------------------------------------------------------------------------- */

static const deck_key_info gravity_keys[] = {
    {.name = "acceleration",
     .type = DECK_PLACE,
     .unit = "m/s^2",
     .required = true,
     DECK_AT(gravity, acceleration),
     .doc = "full acceleration along x, y and, in space, z; e.g. 0, '-9.81 m/s^2'"},
    DECK_TIME_KEYS,
};

static void check_gravity(deck_reader *r, const namelist_group *from, void *into) {
  deck_gravity *item = into;
  if (deck_factor_read(r->memory, from, "acceleration", &item->factor, r->d)) {
    deck_warn_late(r, &item->item, "start", item->factor.start);
    spread(r, from, &item->factor);
  }
  if (deck_dimensions_of(r, NULL))
    deck_check_places(r, from, &deck_group_gravity, deck_dimensions_of(r, NULL));
  if (item->acceleration[0] == 0 && item->acceleration[1] == 0 && item->acceleration[2] == 0)
    diag_report(r->d, DIAG_DECK_WARNING, deck_where(&item->item, "acceleration"),
                "this gravity is zero");
}

DECK_LIST(gravity, .check = check_gravity,
          .doc = "Weight of every particle; several add up. Its work is in the energy ledger.");

/* --- contact ---------------------------------------------------------------------------------- */

static const deck_key_info contact_keys[] = {
    {.name = "name",
     .type = DECK_NAME,
     .fallback = "'contact'",
     DECK_AT(contact, name),
     .doc = "its name, also of its energies in the history"},
    {.name = "lattices",
     .type = DECK_NAMES,
     .fallback = "= all, each with itself and with all others",
     DECK_AT(contact, lattices),
     DECK_COUNT_AT(contact, lattice_count),
     .doc = "names of two lattices, whose particles touch each other's; or of one, whose own "
            "particles touch. Bars and links touch nothing"},
    {.name = "stiffness",
     .type = DECK_REAL,
     .unit = "N/m",
     .bound = BOUND_POSITIVE,
     .fallback = "= E V/s^2 of the softer lattice",
     DECK_AT(contact, stiffness),
     .doc = "force between two particles over the way that they overlap"},
};

/* That of a lattice, or of a contact before this one. */
static const deck_item *other_of_name(const deck_reader *r, const char *name) {
  const int lattice = deck_find_lattice(r->k, name), contact = deck_find_contact(r->k, name);
  if (lattice >= 0) return &r->k->lattices[lattice].item;
  return contact < 0 ? NULL : &r->k->contacts[contact].item;
}

/* Of lattices that both let touch. */
static bool have_a_pair(const deck_contact *a, const deck_contact *b) {
  bool same = a->lattice_count == b->lattice_count;
  for (int n = 0; same && n < a->lattice_count; n++)
    same = deck_is_one_of(a->lattices[n], b->lattices, b->lattice_count);
  return same || a->lattice_count == 0 || b->lattice_count == 0;
}

/* Bars and links do not. */
static bool some_lattice_touches(const deck *k) {
  for (int n = 0; n < k->lattice_count; n++)
    if (!deck_lattice_is_bar(&k->lattices[n]) && !deck_lattice_is_link(&k->lattices[n]))
      return true;
  return k->lattice_count == 0;
}

static void check_contact(deck_reader *r, const namelist_group *from, void *into) {
  deck_contact *item = into;
  const span where = deck_where(&item->item, "lattices");
  (void)from;
  const deck_item *other = other_of_name(r, item->name);
  deck_check_folder_name(r, "contact", &item->item, item->name);
  deck_check_name(r, "lattice or contact", item->name, &item->item, other);
  if (!some_lattice_touches(r->k))
    diag_report(r->d, DIAG_CONFLICT, item->item.where,
                "the deck has no lattice: bars touch nothing");
  if (item->lattice_count > 2)
    diag_report(r->d, DIAG_BAD_VALUE, where, "`lattices` takes one name or two, but %d are given",
                item->lattice_count);
  for (int n = 0; n < item->lattice_count; n++) {
    const char *name = item->lattices[n];
    if (!deck_lattice_known_at(r, where, name)) continue;
    const int lattice = deck_find_lattice(r->k, name);
    const deck_lattice *of = lattice < 0 ? NULL : &r->k->lattices[lattice];
    if (of && (deck_lattice_is_bar(of) || deck_lattice_is_link(of)))
      diag_report(r->d, DIAG_BAD_VALUE, where, "`%s` is a %s: only lattices touch",
                  deck_shown(r->memory, name), deck_lattice_word(of));
  }
  for (int k = 0; k < r->k->contact_count; k++) {
    if (r->k->contacts[k].item.faulty || !have_a_pair(&r->k->contacts[k], item)) continue;
    diag_report(r->d, DIAG_CONFLICT, where, "lattices of this contact touch already");
    diag_note(r->d, deck_where(&r->k->contacts[k].item, "lattices"), "they touch by this one");
    return;
  }
}

DECK_LIST(contact, .identity = "name", .check = check_contact,
          .doc = "Particles that no bond joins push each other apart when they come nearer than a "
                 "spacing, see [Contact](#contact).");

/* --- motion at the start ---------------------------------------------------------------------- */

#define INITIAL_KEYS(group, unit_text, what)                                                       \
  REGION_KEY(group, "what moves"),                                                                 \
      {.name = "component",                                                                        \
       .type = DECK_CHOICE,                                                                        \
       .choices = DECK_COMPONENTS,                                                                 \
       .required = true,                                                                           \
       DECK_AT(group, component),                                                                  \
       .doc = "direction of the motion"},                                                          \
      {.name = "value",                                                                            \
       .type = DECK_LATER,                                                                         \
       .unit = unit_text,                                                                          \
       .fallback = "= required, but for a file",                                                   \
       DECK_NOT_KEPT,                                                                              \
       .doc =                                                                                      \
           what ", of each particle; or a formula of `x`, `y`, `z`, where the particle stands"},   \
  {                                                                                                \
    .name = "file", .type = DECK_LATER, DECK_NOT_KEPT,                                             \
    .doc = "instead: a table with columns `x`, `y`, in space `z`, and values, or a result, whose " \
           "last frame counts, beside the deck; `'field.csv:v_x'`, `'run.h5:velocity'`. A "        \
           "particle has the value of the nearest place, within half a spacing"                    \
  }

static const deck_key_info initial_velocity_keys[] = {
    INITIAL_KEYS(initial_velocity, "m/s; rotation: rad/s", "the velocity")};
static const deck_key_info initial_displacement_keys[] = {
    INITIAL_KEYS(initial_displacement, "m; rotation: rad", "the displacement")};

static void check_initial(deck_reader *r, const namelist_group *from, deck_initial *item,
                          const char *unit_text, const char *unit_of_rotation, const char *hint) {
  deck_moving_region_known(r, &item->item, item->region);
  if (!deck_take_component(r, &item->item, item->region, &item->component)) return;
  const bool rotates = deck_is_rotation(r, item->region, item->component);
  const int errors = r->d->errors;
  const bool good =
      deck_placed_read(r->memory, from, rotates ? unit_of_rotation : unit_text, &item->value, r->d);
  const int region = item->region ? deck_find_region(r->k, item->region) : -1;
  item->value.component =
      item->component - (rotates ? deck_dimensions_of_region(r, item->region) : 0);
  item->value.lattice = region < 0 ? NULL : r->k->regions[region].lattice;
  if (good) return;
  const diagnostic *last = &r->d->items[r->d->count - 1];
  if (rotates && r->d->errors > errors && !last->hint) diag_hint(r->d, "%s", hint);
}

static void check_initial_velocity(deck_reader *r, const namelist_group *from, void *item) {
  check_initial(r, from, item, "m/s", "1/s", "a rotation's velocity is in rad/s");
}

static void check_initial_displacement(deck_reader *r, const namelist_group *from, void *item) {
  check_initial(r, from, item, "m", "1", "a rotation is in rad");
}

DECK_LIST(initial_velocity, .identity = "region", .check = check_initial_velocity,
          .doc = "Velocity of a region when the run begins.");

DECK_LIST(initial_displacement, .identity = "region", .check = check_initial_displacement,
          .doc =
              "Displacement of a region when the run begins: bonds are stretched from the start, "
              "where it is not a rigid motion.");
