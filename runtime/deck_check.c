#include "runtime/deck_check.h"

#include <ctype.h>
#include <math.h>
#include <string.h>
#include <strings.h>

#include "runtime/bravais.h"
#include "runtime/deck_load.h"
#include "runtime/deck_value.h"
#include "runtime/shape.h"

/* --- names ------------------------------------------------------------------------------------ */

/* Names of one kind of group, for suggestions. */
#define NAMES_OF(group)                                                                            \
  static const char **group##_names(const deck_reader *r) {                                        \
    const deck *k = r->k;                                                                          \
    const char **names = arena_alloc(r->memory, ((size_t)k->group##_count + 1) * sizeof(*names));  \
    for (int i = 0; i < k->group##_count; i++)                                                     \
      names[i] = k->group##s[i].name;                                                              \
    return names;                                                                                  \
  }
NAMES_OF(lattice)
NAMES_OF(region)
NAMES_OF(monitor)

static bool known(deck_reader *r, bool found, span where, const char *kind, const char *name,
                  const char **names, int count) {
  if (found || !r->names_known) return found;
  diag_report(r->d, DIAG_UNKNOWN_NAME, where, "there is no %s `%s`", kind,
              deck_shown(r->memory, name));
  char intro[32];
  snprintf(intro, sizeof(intro), "the deck's %ss are", kind);
  deck_suggest(r->d, name, names, count, intro);
  return false;
}

static bool lattice_known(deck_reader *r, const deck_item *item, const char *name) {
  return known(r, deck_find_lattice(r->k, name) >= 0, deck_where(item, "lattice"), "lattice", name,
               lattice_names(r), r->k->lattice_count);
}

static bool region_known(deck_reader *r, span where, const char *name) {
  return known(r, deck_find_region(r->k, name) >= 0, where, "region", name, region_names(r),
               r->k->region_count);
}

static bool item_region_known(deck_reader *r, const deck_item *item, const char *name) {
  return region_known(r, deck_where(item, "region"), name);
}

static void name_is_new(deck_reader *r, const char *kind, const char *name, const deck_item *item,
                        const deck_item *first) {
  if (!first) return;
  diag_report(r->d, DIAG_DUPLICATE_NAME, deck_where(item, "name"), "a %s `%s` exists already", kind,
              deck_shown(r->memory, name));
  diag_note(r->d, deck_where(first, "name"), "it is named here");
}

/* Names of faulty items may be missing. */
static bool same(const char *a, const char *b) {
  return a && b && strcmp(a, b) == 0;
}

static bool is_one_of(const char *name, const char *const *words, int count) {
  for (int i = 0; i < count; i++)
    if (strcmp(words[i], name) == 0) return true;
  return false;
}

/* --- times ------------------------------------------------------------------------------------ */

static void warn_late(deck_reader *r, const deck_item *item, const char *key, double time) {
  double end = r->k->simulation.end_time;
  if (end <= 0 || time < end) return; /* 0: the end is not known */
  diag_report(r->d, DIAG_DECK_WARNING, deck_where(item, key),
              "`%s` is not before the end of the run", key);
}

static void refuse_both(deck_reader *r, const namelist_group *from, const char *a, const char *b) {
  const namelist_key *first = namelist_find(from, a), *second = namelist_find(from, b);
  if (!first || !second) return;
  diag_report(r->d, DIAG_CONFLICT, second->name_where, "`%s` and `%s` exclude each other", a, b);
  diag_note(r->d, first->name_where, "`%s` is given here", a);
}

/* --- shapes ----------------------------------------------------------------------------------- */

/* A place of two or three coordinates, as the lattice has dimensions. */
static void check_place(deck_reader *r, const namelist_group *from, const char *name,
                        int dimensions) {
  const namelist_key *key = namelist_find(from, name);
  if (!key || key->value_count == dimensions) return;
  diag_report(r->d, DIAG_BAD_VALUE, key->value_where,
              "`%s` takes %d values in %s, but %d are given", name, dimensions,
              dimensions == 2 ? "the plane" : "space", key->value_count);
}

enum {
  A_POINT = 1 << SHAPE_POINT,
  A_RECTANGLE = 1 << SHAPE_RECTANGLE,
  A_DISC = 1 << SHAPE_DISC,
  A_POLYGON = 1 << SHAPE_POLYGON,
  A_DOG_BONE = 1 << SHAPE_DOG_BONE,
  A_SEGMENT = 1 << SHAPE_SEGMENT,
  A_BOX = 1 << SHAPE_BOX,
  A_CYLINDER = 1 << SHAPE_CYLINDER,
  A_SPHERE = 1 << SHAPE_SPHERE,
  AN_EXTRUSION = 1 << SHAPE_EXTRUSION,
  A_FACE = 1 << SHAPE_FACE
};
static const char *const shape_words[] = {"a point",    "a rectangle",  "a disc", "a polygon",
                                          "a dog-bone", "a segment",    "a box",  "a cylinder",
                                          "a sphere",   "an extrusion", "a face"};
static const deck_key_use shape_uses[] = {
    {"at", A_POINT, true},
    {"within", A_POINT, false},
    {"corner", A_RECTANGLE | A_BOX, true},
    {"size", A_RECTANGLE | A_BOX, true},
    {"rotation", A_RECTANGLE | A_DOG_BONE, false},
    {"centre", A_DISC | A_DOG_BONE | A_SPHERE, true},
    {"radius", A_DISC | A_DOG_BONE | A_CYLINDER | A_SPHERE, true},
    {"inner_radius", A_DISC | A_CYLINDER | A_SPHERE, false},
    {"width", A_DOG_BONE, true},
    {"height", A_DOG_BONE, true},
    {"neck", A_DOG_BONE, true},
    {"from", A_SEGMENT | A_CYLINDER, true},
    {"to", A_SEGMENT | A_CYLINDER, true},
    {"z", AN_EXTRUSION, true},
    {"points", A_POLYGON | AN_EXTRUSION | A_FACE, true},
    {"bulge", A_POLYGON | AN_EXTRUSION, false}};

/* As read, `point_count` counts values; afterwards points. */
static bool check_points(deck_reader *r, const deck_item *item, deck_shape *shape) {
  const bool face = shape->kind == SHAPE_FACE;
  const span where = deck_where(item, "points");
  const int values = shape->point_count, each = face ? 3 : 2;
  shape->point_count = values / each;
  if (values % each && face)
    diag_report(r->d, DIAG_BAD_VALUE, where,
                "`points` holds triples x, y, z, but there are %d values", values);
  else if (values % each)
    diag_report(r->d, DIAG_BAD_VALUE, where,
                "`points` holds pairs x, y, but the number of values is odd (%d)", values);
  else if (values < 3 * each)
    diag_report(r->d, DIAG_BAD_VALUE, where, "a %s has at least 3 points; here are %d",
                face ? "face" : "polygon", values / each);
  else
    return true;
  return false;
}

/* Twice the area of a polygon of straight edges, positive when its corners are counter-clockwise. */
static double twice_area(const deck_shape *shape, double *extent) {
  const double *p = shape->points;
  const int values = 2 * shape->point_count;
  double area = 0;
  *extent = 0;
  for (int i = 2; i < values; i += 2) {
    int next = (i + 2) % values;
    area += (p[i] - p[0]) * (p[next + 1] - p[1]) - (p[next] - p[0]) * (p[i + 1] - p[1]);
    *extent = fmax(*extent, fmax(fabs(p[i] - p[0]), fabs(p[i + 1] - p[1])));
  }
  return area;
}

/* Edges with arcs are put in counter-clockwise order: the edge that began at point k then begins at its other end. */
static void put_counter_clockwise(deck_reader *r, deck_shape *shape) {
  const int n = shape->point_count;
  double *points = arena_alloc(r->memory, 2 * (size_t)n * sizeof *points);
  double *bulge = arena_alloc(r->memory, (size_t)n * sizeof *bulge);
  for (int k = 0; k < n; k++) {
    memcpy(points + 2 * k, shape->points + 2 * (n - 1 - k), 2 * sizeof *points);
    bulge[k] = shape->bulge[(2 * n - 2 - k) % n];
  }
  shape->points = points;
  shape->bulge = bulge;
}

static void check_polygon(deck_reader *r, const deck_item *item, deck_shape *shape) {
  double extent;
  if (!check_points(r, item, shape)) return;
  const double area = twice_area(shape, &extent);
  if (fabs(area) <= 1e-12 * extent * extent) {
    diag_report(r->d, DIAG_BAD_VALUE, deck_where(item, "points"), "this polygon has no area");
  } else if (shape->bulge && shape->bulge_count != shape->point_count) {
    diag_report(r->d, DIAG_BAD_VALUE, deck_where(item, "bulge"),
                "`bulge` has a value for each of the %d points, but %d are given",
                shape->point_count, shape->bulge_count);
  } else if (shape->bulge && area < 0) {
    put_counter_clockwise(r, shape);
  }
}

static void check_face(deck_reader *r, const deck_item *item, deck_shape *shape) {
  if (!check_points(r, item, shape)) return;
  const double away = shape_unevenness(shape);
  if (away <= 1e-6) return;
  diag_report(r->d, DIAG_BAD_VALUE, deck_where(item, "points"),
              isnan(away) ? "this face has no area"
                          : "the corners of this face do not lie in a plane");
}

static void check_dog_bone(deck_reader *r, const deck_item *item, const deck_shape *shape) {
  const double rise = (shape->width - shape->neck) / 2;
  if (rise <= 0) {
    diag_report(r->d, DIAG_OUT_OF_BOUNDS, deck_where(item, "neck"),
                "`neck` must be less than `width`");
  } else if (shape->radius < rise) {
    diag_report(r->d, DIAG_OUT_OF_BOUNDS, deck_where(item, "radius"),
                "with this radius the arcs do not reach the neck: at least half the difference of "
                "`width` and `neck` "
                "is needed");
  } else if (2 * sqrt(rise * (2 * shape->radius - rise)) > shape->height) {
    diag_report(r->d, DIAG_OUT_OF_BOUNDS, deck_where(item, "radius"),
                "the arcs at the neck are longer than the dog-bone is high");
  }
}

static void check_numbers(deck_reader *r, const deck_item *item, deck_shape *shape) {
  if (shape->inner_radius > 0 && shape->inner_radius >= shape->radius)
    diag_report(r->d, DIAG_OUT_OF_BOUNDS, deck_where(item, "inner_radius"),
                "`inner_radius` must be less than `radius`");
  if ((1 << shape->kind & (A_SEGMENT | A_CYLINDER)) &&
      memcmp(shape->from, shape->to, sizeof shape->to) == 0)
    diag_report(r->d, DIAG_BAD_VALUE, deck_where(item, "to"), "%s has two different ends",
                shape_words[shape->kind]);
  if (shape->kind == SHAPE_EXTRUSION && !(shape->z[0] < shape->z[1]))
    diag_report(r->d, DIAG_OUT_OF_BOUNDS, deck_where(item, "z"),
                "the second value of `z` must be larger than the first");
  if (shape->kind == SHAPE_DOG_BONE) check_dog_bone(r, item, shape);
  if (1 << shape->kind & (A_POLYGON | AN_EXTRUSION)) check_polygon(r, item, shape);
  if (shape->kind == SHAPE_FACE) check_face(r, item, shape);
}

/* Dimensions of the lattice of that name, or of the only one; 0 when it is not known which. */
static int dimensions_of(const deck_reader *r, const char *lattice) {
  const int l = lattice ? deck_find_lattice(r->k, lattice) : r->k->lattice_count == 1 ? 0 : -1;
  return l < 0 || !r->k->lattices[l].kind ? 0 : deck_lattice_dimensions(&r->k->lattices[l]);
}

static bool shape_is_of(deck_reader *r, const deck_item *item, const deck_shape *shape,
                        int dimensions) {
  if (shape->kind == SHAPE_POINT || (shape->kind >= SHAPE_BOX) == (dimensions == 3)) return true;
  diag_report(r->d, DIAG_CONFLICT, deck_where(item, "shape"), "%s is a shape %s, the lattice is %s",
              shape_words[shape->kind], dimensions == 2 ? "in space" : "of the plane",
              dimensions == 2 ? "in the plane" : "in space");
  diag_hint(r->d, "there are %s",
            dimensions == 2 ? "'point', 'rectangle', 'disc', 'polygon', 'dog_bone' and 'segment'"
                            : "'point', 'box', 'cylinder', 'sphere', 'extrusion' and 'face'");
  return false;
}

static void check_shape(deck_reader *r, const namelist_group *from, const deck_item *item,
                        deck_shape *shape, const char *lattice) {
  static const char *const places[] = {"at", "corner", "size", "centre", "from", "to"};
  const int count = (int)(sizeof(shape_uses) / sizeof(shape_uses[0]));
  const int dimensions = dimensions_of(r, lattice), errors = r->d->errors;
  if (!deck_keys_fit(from, shape_uses, count, (int)shape->kind, shape_words[shape->kind], r->d))
    return;
  if (dimensions && !shape_is_of(r, item, shape, dimensions)) return;
  for (size_t k = 0; dimensions && k < sizeof(places) / sizeof(places[0]); k++)
    check_place(r, from, places[k], dimensions);
  if (r->d->errors == errors) check_numbers(r, item, shape);
}

/* --- components ------------------------------------------------------------------------------- */

enum { WRITTEN_Z = 2, WRITTEN_ROTATION = 3 }; /* positions among "x|y|z|rotation" */

static int dimensions_of_region(const deck_reader *r, const char *name) {
  const int k = name ? deck_find_region(r->k, name) : -1;
  return k < 0 ? 0 : dimensions_of(r, r->k->regions[k].lattice);
}

/* The degree of freedom of a direction as written. -1 after a message: it is none of the region's particles. */
static int component_of(deck_reader *r, span where, const char *region, int written) {
  const int dimensions = dimensions_of_region(r, region);
  if (written < WRITTEN_Z) return written;
  if (dimensions == 2 && written == WRITTEN_Z)
    diag_report(r->d, DIAG_BAD_VALUE, where, "there is no direction z in the plane");
  else if (dimensions == 3 && written == WRITTEN_ROTATION)
    diag_report(r->d, DIAG_BAD_VALUE, where, "particles of a lattice in space have no rotation");
  else
    return 2;
  return -1;
}

static bool take_component(deck_reader *r, const deck_item *item, const char *region,
                           int *component) {
  const int found = component_of(r, deck_where(item, "component"), region, *component);
  if (found >= 0) *component = found;
  return found >= 0;
}

static bool is_rotation(const deck_reader *r, const char *region, int component) {
  return component == 2 && dimensions_of_region(r, region) != 3;
}

static const char *component_name(const deck_reader *r, const char *region, int component) {
  return deck_component_name(dimensions_of_region(r, region), component);
}

/* --- groups, in the order of DECK_GROUPS ------------------------------------------------------ */

void deck_check_simulation(deck_reader *r, const namelist_group *from, deck_simulation *item) {
  (void)from;
  if (item->step > item->end_time)
    diag_report(r->d, DIAG_OUT_OF_BOUNDS, deck_where(&item->item, "step"),
                "`step` is longer than the run");
}

void deck_check_relaxation(deck_reader *r, const namelist_group *from, deck_relaxation *item) {
  (void)from;
  if (item->increments < 1)
    diag_report(r->d, DIAG_OUT_OF_BOUNDS, deck_where(&item->item, "increments"),
                "a quasi-static run has at least one increment");
  if (item->most_steps < 1)
    diag_report(r->d, DIAG_OUT_OF_BOUNDS, deck_where(&item->item, "most_steps"),
                "an increment needs at least one step");
}

enum {
  PLANE = 2, /* by dimensions, and particles that stand on no lattice in space */
  SPACE,
  IRREGULAR_SPACE,
  IN_PLANE = 1 << PLANE,
  IN_SPACE = 1 << SPACE,
  IN_IRREGULAR_SPACE = 1 << IRREGULAR_SPACE
};
static const char *const dimension_words[] = {[PLANE] = "a lattice in the plane",
                                              [SPACE] = "a lattice in space",
                                              [IRREGULAR_SPACE] =
                                                  "a lattice of particles in space"};
static const deck_key_use dimension_uses[] = {{"axis", IN_SPACE, false},
                                              {"thickness", IN_PLANE, true},
                                              {"stiffness_thickness", IN_PLANE, false},
                                              {"mass_thickness", IN_PLANE, false},
                                              {"setting", IN_PLANE | IN_IRREGULAR_SPACE, false}};

enum {
  REGULAR,
  BLUE_NOISE,
  FROM_FILE,
  IS_BLUE_NOISE = 1 << BLUE_NOISE,
  IS_FROM_FILE = 1 << FROM_FILE
};
static const char *const arrangement_words[] = {"a regular lattice", "a lattice of blue noise",
                                                "a lattice of particles"};
static const deck_key_use arrangement_uses[] = {{"neighbours", IS_BLUE_NOISE | IS_FROM_FILE, false},
                                                {"seed", IS_BLUE_NOISE, false},
                                                {"file", IS_FROM_FILE, true}};

static int arrangement_of(const deck_lattice *l) {
  if (!deck_lattice_is_irregular(l)) return REGULAR;
  return strcmp(l->kind, "particles") == 0 ? FROM_FILE : BLUE_NOISE;
}

/* What only sites of a lattice have. */
static bool refuse_keys_of_sites(deck_reader *r, const namelist_group *from) {
  static const struct {
    const char *key, *reason;
  } none[] = {{"shells", "have no shells of neighbours: give `neighbours` or a `horizon`"},
              {"rotation", "have no direction that could be turned"},
              {"axis", "have no direction that could be turned"},
              {"origin", "have no origin; the bodies say where they are"},
              {"volume_correction", "have no volume correction: they have volumes of their own"}};
  bool good = true;
  for (size_t k = 0; k < sizeof none / sizeof *none; k++) {
    const namelist_key *key = namelist_find(from, none[k].key);
    if (!key) continue;
    diag_report(r->d, DIAG_CONFLICT, key->name_where, "particles that stand on no lattice %s",
                none[k].reason);
    good = false;
  }
  return good;
}

static bool has_spacing(deck_reader *r, const namelist_group *from, int arrangement) {
  if (arrangement == FROM_FILE || namelist_find(from, "spacing")) return true;
  diag_report(r->d, DIAG_MISSING_KEY, from->where, "`&lattice` has no `spacing`");
  diag_hint(r->d, arrangement == BLUE_NOISE
                      ? "spacing: that of the lattice whose particles are as large (m)"
                      : "spacing: distance of nearest neighbours (m)");
  return false;
}

static void check_neighbours(deck_reader *r, const namelist_group *from, deck_lattice *item,
                             int dimensions) {
  refuse_both(r, from, "horizon", "neighbours");
  if (namelist_find(from, "neighbours") && item->neighbours == 0)
    diag_report(r->d, DIAG_OUT_OF_BOUNDS, deck_where(&item->item, "neighbours"),
                "a particle has at least one neighbour");
  if (!namelist_find(from, "neighbours") && !namelist_find(from, "horizon"))
    item->neighbours = dimensions == 2 ? 12 : 18;
}

static bool setting_suits(deck_reader *r, const deck_lattice *item, int dimensions) {
  if (dimensions != 2 || !item->setting || strcmp(item->setting, "space") != 0) return true;
  diag_report(r->d, DIAG_CONFLICT, deck_where(&item->item, "setting"),
              "a %s lattice lies in the plane", item->kind);
  diag_hint(r->d, "lattices in space are 'cubic', 'fcc', 'blue_noise' and 'particles'");
  return false;
}

/* Which keys a lattice has depends on its dimensions and on whether there are sites at all. */
static void check_kind(deck_reader *r, const namelist_group *from, deck_lattice *item) {
  const int dimensions = deck_lattice_dimensions(item), arrangement = arrangement_of(item);
  const int kind = arrangement != REGULAR && dimensions == 3 ? IRREGULAR_SPACE : dimensions;
  if (arrangement != REGULAR && !refuse_keys_of_sites(r, from)) return;
  if (!has_spacing(r, from, arrangement) || !setting_suits(r, item, dimensions) ||
      !deck_keys_fit(from, arrangement_uses, 3, arrangement, arrangement_words[arrangement],
                     r->d) ||
      !deck_keys_fit(from, dimension_uses, 5, kind, dimension_words[kind], r->d))
    return;
  check_place(r, from, "origin", dimensions);
  if (!item->setting) item->setting = dimensions == 2 ? "plane_stress" : "space";
  if (arrangement != REGULAR) check_neighbours(r, from, item, dimensions);
}

void deck_check_lattice(deck_reader *r, const namelist_group *from, deck_lattice *item) {
  static const char *const taken[] = {"time",  "dissipated", "displacement", "velocity",
                                      "force", "damage",     "rotation",     "."};
  check_kind(r, from, item);
  refuse_both(r, from, "horizon", "shells");
  if (namelist_find(from, "shells") && item->shells == 0)
    diag_report(r->d, DIAG_OUT_OF_BOUNDS, deck_where(&item->item, "shells"),
                "a particle has at least one shell of neighbours");
  if (item->stiffness_thickness == 0) item->stiffness_thickness = item->thickness;
  if (item->mass_thickness == 0) item->mass_thickness = item->thickness;
  span where = deck_where(&item->item, "name");
  if (is_one_of(item->name, taken, 8))
    diag_report(r->d, DIAG_RESERVED_NAME, where,
                "a lattice cannot be called `%s`: the result has a field of that name", item->name);
  else if (strchr(item->name, '/'))
    diag_report(r->d, DIAG_BAD_VALUE, where, "a lattice's name must not hold `/`");
  int first = deck_find_lattice(r->k, item->name);
  name_is_new(r, "lattice", item->name, &item->item,
              first < 0 ? NULL : &r->k->lattices[first].item);
}

static bool read_assignment(deck_reader *r, const namelist_key *key, deck_assignment *a) {
  if (!deck_values_counted(key, 1, r->d)) return false;
  const namelist_value *v = &key->values[0];
  *a = (deck_assignment){
      .name = key->name, .name_where = key->name_where, .value_where = key->value_where};
  const char *text = v->kind == NAMELIST_TEXT ? v->text + strspn(v->text, " \t") : "0";
  if (isalpha((unsigned char)*text) || *text == '_') {
    a->word = text;
    return true;
  }
  deck_quantity q;
  if (!deck_quantity_read(v, key->name, &q, r->d)) return false;
  a->value = q.value;
  a->has_unit = q.has_unit;
  a->dim = q.dim;
  return true;
}

void deck_check_material(deck_reader *r, const namelist_group *from, deck_material *item) {
  item->assignments = arena_alloc(r->memory, (size_t)from->key_count * sizeof(*item->assignments));
  for (int i = 0; i < from->key_count; i++) {
    if (deck_key_find(&deck_groups[DECK_GROUP_material], from->keys[i].name) >= 0) continue;
    if (read_assignment(r, &from->keys[i], &item->assignments[item->assignment_count]))
      item->assignment_count++;
  }
  if (!lattice_known(r, &item->item, item->lattice)) return;
  const int first = deck_find_material(r->k, item->lattice);
  if (first < 0) return;
  diag_report(r->d, DIAG_CONFLICT, deck_where(&item->item, "lattice"),
              "the lattice `%s` has a material already", deck_shown(r->memory, item->lattice));
  diag_note(r->d, r->k->materials[first].item.where, "it is given here");
}

/* --- random fields ---------------------------------------------------------------------------- */

enum { OF_UNIFORM = 1 << FIELD_UNIFORM, OF_WEIBULL = 1 << FIELD_WEIBULL };
static const char *const field_words[] = {"a uniform distribution", "a normal distribution",
                                          "a lognormal distribution", "a Weibull distribution"};
static const deck_key_use field_uses[] = {{"low", OF_UNIFORM, false},
                                          {"high", OF_UNIFORM, false},
                                          {"shape", OF_WEIBULL, false},
                                          {"scale", OF_WEIBULL, false}};

static bool read_number(deck_reader *r, const namelist_group *from, const char *name,
                        deck_number *n) {
  const namelist_key *key = namelist_find(from, name);
  deck_quantity q;
  if (!key) return true;
  if (!deck_values_counted(key, 1, r->d) || !deck_quantity_read(&key->values[0], name, &q, r->d))
    return false;
  *n = (deck_number){true, q.has_unit, q.value, q.dim};
  return true;
}

/* What makes a distribution whole, and no more than that. */
static void check_distribution(deck_reader *r, const namelist_group *from, const deck_field *f) {
  const bool range = f->low.given || f->high.given;
  refuse_both(r, from, "low", "cv");
  refuse_both(r, from, "low", "mean");
  refuse_both(r, from, "shape", "cv");
  refuse_both(r, from, "scale", "mean");
  if (range && !(f->low.given && f->high.given)) {
    diag_report(r->d, DIAG_MISSING_KEY, from->where, "`low` and `high` belong together");
  } else if (range && f->high.value <= f->low.value) {
    diag_report(r->d, DIAG_OUT_OF_BOUNDS, deck_where(&f->item, "high"),
                "`high` must be larger than `low`");
  } else if (f->scale.given && f->shape == 0) {
    diag_report(r->d, DIAG_MISSING_KEY, from->where, "`scale` needs `shape`");
  } else if (!range && f->cv == 0 && f->shape == 0) {
    diag_report(r->d, DIAG_MISSING_KEY, from->where, "%s needs %s", field_words[f->kind],
                f->kind == FIELD_UNIFORM   ? "`low` and `high`, or `cv`"
                : f->kind == FIELD_WEIBULL ? "`shape` or `cv`"
                                           : "`cv`");
  }
}

static void add_varying(deck_reader *r, deck_material *m, const deck_field *f) {
  const size_t count = (size_t)m->varying_count;
  const char **names = arena_alloc(r->memory, (count + 1) * sizeof *names);
  span *where = arena_alloc(r->memory, (count + 1) * sizeof *where);
  for (size_t k = 0; k < count; k++) {
    names[k] = m->varying[k];
    where[k] = m->varying_where[k];
    if (strcasecmp(names[k], f->parameter) != 0) continue;
    diag_report(r->d, DIAG_CONFLICT, deck_where(&f->item, "parameter"),
                "`%s` has a random field already", deck_shown(r->memory, f->parameter));
    diag_note(r->d, where[k], "it is given here");
    return;
  }
  names[count] = f->parameter;
  where[count] = deck_where(&f->item, "parameter");
  m->varying = names;
  m->varying_where = where;
  m->varying_count++;
}

void deck_check_field(deck_reader *r, const namelist_group *from, deck_field *item) {
  const namelist_key *on = namelist_find(from, "on");
  if (on) item->on_particles = deck_choice_read(r->memory, on, "bond|particle", r->d) == 1;
  if (!deck_keys_fit(from, field_uses, 4, (int)item->kind, field_words[item->kind], r->d)) return;
  bool good = read_number(r, from, "mean", &item->mean);
  good &= read_number(r, from, "low", &item->low);
  good &= read_number(r, from, "high", &item->high);
  good &= read_number(r, from, "scale", &item->scale);
  if (good) check_distribution(r, from, item);
  if (item->lattice) {
    if (!lattice_known(r, &item->item, item->lattice)) return;
  } else if (r->k->lattice_count == 1) {
    item->lattice = r->k->lattices[0].name;
  } else {
    if (r->names_known && r->k->lattice_count > 1) {
      diag_report(r->d, DIAG_MISSING_KEY, item->item.where, "`&field` needs `lattice` here");
      diag_hint(r->d, "the deck has %d lattices", r->k->lattice_count);
    }
    return;
  }
  for (int i = 0; i < r->k->material_count; i++)
    if (same(r->k->materials[i].lattice, item->lattice)) add_varying(r, &r->k->materials[i], item);
}

/* Irregular particles fill areas and volumes; a notch may be a slit. */
static void check_can_be_filled(deck_reader *r, const deck_item *item, const deck_shape *shape,
                                const char *lattice, bool is_body) {
  const int l = deck_find_lattice(r->k, lattice);
  const bool suits = is_body ? shape_has_size(shape) : shape->kind != SHAPE_POINT;
  if (suits || l < 0 || r->k->lattices[l].item.faulty ||
      !deck_lattice_is_irregular(&r->k->lattices[l]))
    return;
  diag_report(r->d, DIAG_CONFLICT, deck_where(item, "shape"),
              shape->kind == SHAPE_POINT ? "%s means a site of a lattice, but here are none"
                                         : "%s cannot be filled with particles",
              shape_words[shape->kind]);
}

void deck_check_body(deck_reader *r, const namelist_group *from, deck_body *item) {
  lattice_known(r, &item->item, item->lattice);
  check_shape(r, from, &item->item, &item->shape, item->lattice);
  check_can_be_filled(r, &item->item, &item->shape, item->lattice, true);
}

void deck_check_notch(deck_reader *r, const namelist_group *from, deck_notch *item) {
  lattice_known(r, &item->item, item->lattice);
  check_shape(r, from, &item->item, &item->shape, item->lattice);
  check_can_be_filled(r, &item->item, &item->shape, item->lattice, false);
}

void deck_check_region(deck_reader *r, const namelist_group *from, deck_region *item) {
  check_shape(r, from, &item->item, &item->shape, item->lattice);
  int first = deck_find_region(r->k, item->name);
  name_is_new(r, "region", item->name, &item->item, first < 0 ? NULL : &r->k->regions[first].item);
  if (item->lattice) {
    lattice_known(r, &item->item, item->lattice);
  } else if (r->k->lattice_count == 1) {
    item->lattice = r->k->lattices[0].name;
  } else if (r->names_known && r->k->lattice_count > 1) {
    diag_report(r->d, DIAG_MISSING_KEY, item->item.where, "`&region` needs `lattice` here");
    diag_hint(r->d, "the deck has %d lattices", r->k->lattice_count);
  }
}

void deck_check_support(deck_reader *r, const namelist_group *from, deck_support *item) {
  (void)from;
  int fix = 0;
  item_region_known(r, &item->item, item->region);
  for (int k = 0; k <= WRITTEN_ROTATION; k++) {
    if (!(item->fix & 1 << k)) continue;
    const int component = component_of(r, deck_where(&item->item, "fix"), item->region, k);
    if (component >= 0) fix |= 1 << component;
  }
  item->fix = fix;
}

/* A particle cannot follow two motions; regions that overlap are found when their particles are
 * known. */
static void check_other_motions(deck_reader *r, const deck_drive *item) {
  const deck *k = r->k;
  span where = deck_where(&item->item, "component"), other = {0};
  bool conflict = false;
  for (int i = 0; i < k->support_count && !conflict; i++) {
    conflict = !k->supports[i].item.faulty && same(k->supports[i].region, item->region) &&
               (k->supports[i].fix & 1 << item->component);
    other = deck_where(&k->supports[i].item, "fix");
  }
  for (int i = 0; i < k->drive_count && !conflict; i++) {
    conflict = !k->drives[i].item.faulty && same(k->drives[i].region, item->region) &&
               k->drives[i].component == item->component;
    other = deck_where(&k->drives[i].item, "component");
  }
  if (!conflict) return;
  const char *component = component_name(r, item->region, item->component);
  diag_report(r->d, DIAG_CONFLICT, where, "`%s` of region `%s` has two motions", component,
              deck_shown(r->memory, item->region));
  diag_note(r->d, other, "the other one");
}

/* A load without a history grows with the increments of a quasi-static run. */
static void spread(const deck_reader *r, const namelist_group *from, time_function *f) {
  const double rest = r->k->simulation.end_time - f->start;
  if (r->k->relaxation.increments < 1 || f->shape != TIME_CONSTANT || !(rest > 0)) return;
  if (namelist_find(from, "history")) return;
  f->shape = TIME_RAMP_HOLD;
  f->rise = rest;
}

/* The one of two keys that was written, or NULL after a message. */
static const namelist_key *either(deck_reader *r, const namelist_group *from, const char *first,
                                  const char *second) {
  const namelist_key *a = namelist_find(from, first), *b = namelist_find(from, second);
  if (a && b) {
    diag_report(r->d, DIAG_CONFLICT, b->name_where, "`%s` and `%s` exclude each other", first,
                second);
    diag_note(r->d, a->name_where, "`%s` is given here", first);
  } else if (!a && !b) {
    diag_report(r->d, DIAG_MISSING_KEY, from->where, "`&%s` needs `%s` or `%s`", from->name, first,
                second);
  }
  return a && b ? NULL : a ? a : b;
}

void deck_check_drive(deck_reader *r, const namelist_group *from, deck_drive *item) {
  item_region_known(r, &item->item, item->region);
  if (!take_component(r, &item->item, item->region, &item->component)) return;
  const bool rotates = is_rotation(r, item->region, item->component);
  check_other_motions(r, item);
  const namelist_key *key = either(r, from, "velocity", "displacement");
  if (!key) return;
  item->is_displacement = key == namelist_find(from, "displacement");
  const char *unit_text = item->is_displacement ? (rotates ? "1" : "m") : rotates ? "1/s" : "m/s";
  if (!deck_load_read(r->memory, from, key, unit_text, &item->motion, r->d)) {
    if (rotates && r->d->items[r->d->count - 1].code == DIAG_UNITS)
      diag_hint(r->d, "a rotation is in rad, its velocity in rad/s");
    return;
  }
  warn_late(r, &item->item, "start", item->motion.start);
  if (!item->is_displacement) return;
  spread(r, from, &item->motion);
  if (item->motion.shape != TIME_CONSTANT || r->k->relaxation.increments > 0) return;
  diag_report(r->d, DIAG_DECK_WARNING, key->name_where, "this displacement comes all at once");
  diag_hint(r->d, "give a `rise`, e.g. rise = '1 ms'");
}

void deck_check_force(deck_reader *r, const namelist_group *from, deck_force *item) {
  item_region_known(r, &item->item, item->region);
  const namelist_key *key = either(r, from, "force", "moment");
  const namelist_key *component = namelist_find(from, "component");
  if (!key) return;
  bool rotates = key == namelist_find(from, "moment");
  item->component = rotates ? WRITTEN_ROTATION : 0;
  if (component) item->component = deck_choice_read(r->memory, component, "x|y|z|rotation", r->d);
  if (item->component < 0 || !take_component(r, &item->item, item->region, &item->component))
    return;
  if (!component && !rotates) {
    diag_report(r->d, DIAG_MISSING_KEY, from->where, "`&force` has no `component`");
    diag_hint(r->d, dimensions_of_region(r, item->region) == 3 ? "component = 'x', 'y' or 'z'"
                                                               : "component = 'x' or 'y'");
    return;
  }
  if (rotates != is_rotation(r, item->region, item->component)) {
    diag_report(r->d, DIAG_CONFLICT, key->name_where, "`%s` does not go with component = '%s'",
                key->name, component_name(r, item->region, item->component));
    diag_hint(r->d, "write `%s`", rotates ? "force" : "moment");
    return;
  }
  if (!deck_load_read(r->memory, from, key, rotates ? "N*m" : "N", &item->force, r->d)) return;
  warn_late(r, &item->item, "start", item->force.start);
  spread(r, from, &item->force);
}

void deck_check_end_moment(deck_reader *r, const namelist_group *from, deck_end_moment *item) {
  item_region_known(r, &item->item, item->region);
  if (!deck_load_read(r->memory, from, namelist_find(from, "moment"), "N*m", &item->moment, r->d))
    return;
  warn_late(r, &item->item, "start", item->moment.start);
  spread(r, from, &item->moment);
}

void deck_check_protect(deck_reader *r, const namelist_group *from, deck_protect *item) {
  (void)from;
  item_region_known(r, &item->item, item->region);
}

void deck_check_damping(deck_reader *r, const namelist_group *from, deck_damping *item) {
  if (!namelist_find(from, "until")) item->until = INFINITY;
  warn_late(r, &item->item, "from", item->from);
  if (item->until > item->from) return;
  diag_report(r->d, DIAG_OUT_OF_BOUNDS, deck_where(&item->item, "until"),
              "`until` must be later than `from`");
}

void deck_check_gravity(deck_reader *r, const namelist_group *from, deck_gravity *item) {
  if (deck_factor_read(r->memory, from, &item->factor, r->d)) {
    warn_late(r, &item->item, "start", item->factor.start);
    spread(r, from, &item->factor);
  }
  if (dimensions_of(r, NULL)) check_place(r, from, "acceleration", dimensions_of(r, NULL));
  if (item->acceleration[0] == 0 && item->acceleration[1] == 0 && item->acceleration[2] == 0)
    diag_report(r->d, DIAG_DECK_WARNING, deck_where(&item->item, "acceleration"),
                "this gravity is zero");
}

void deck_check_initial_velocity(deck_reader *r, const namelist_group *from,
                                 deck_initial_velocity *item) {
  const namelist_key *key = namelist_find(from, "value");
  item_region_known(r, &item->item, item->region);
  if (!take_component(r, &item->item, item->region, &item->component)) return;
  const bool rotates = is_rotation(r, item->region, item->component);
  if (!deck_values_counted(key, 1, r->d) ||
      deck_real_read(&key->values[0], "value", rotates ? "1/s" : "m/s", BOUND_NONE, &item->value,
                     r->d))
    return;
  if (rotates) diag_hint(r->d, "a rotation's velocity is in rad/s");
}

enum {
  OF_MOTION = 1 << MONITOR_REACTION | 1 << MONITOR_DISPLACEMENT | 1 << MONITOR_VELOCITY,
  OF_FIELD = 1 << MONITOR_FIELD,
  OF_PAIR = 1 << MONITOR_OPENING | 1 << MONITOR_REACTIONS,
  OF_DAMAGE = 1 << MONITOR_DAMAGED | 1 << MONITOR_BROKEN
};
static const char *const monitor_words[] = {
    "a reaction monitor", "a displacement monitor",
    "a velocity monitor", "an opening monitor",
    "a damaged monitor",  "a broken monitor",
    "a field monitor",    "a reaction monitor with `between`"};
static const deck_key_use monitor_uses[] = {{"region", OF_MOTION | OF_FIELD, true},
                                            {"between", OF_PAIR, true},
                                            {"component", OF_MOTION | OF_PAIR, true},
                                            {"field", OF_FIELD, true},
                                            {"above", OF_DAMAGE, false}};

static bool is_identifier(const char *name) {
  bool good = isalpha((unsigned char)*name) || *name == '_';
  for (const char *p = name; *p; p++)
    good &= isalnum((unsigned char)*p) || *p == '_';
  return good;
}

static void check_monitor_name(deck_reader *r, const deck_monitor *item) {
  static const char *const taken[] = {"time", "energy", "relaxation_steps", "relaxation_unbalance"};
  span where = deck_where(&item->item, "name");
  if (is_one_of(item->name, taken, 4))
    diag_report(r->d, DIAG_RESERVED_NAME, where,
                "a monitor cannot be called `%s`: the result has a history of that name",
                item->name);
  else if (!is_identifier(item->name)) {
    diag_report(r->d, DIAG_BAD_VALUE, where, "`%s` cannot be the name of a monitor",
                deck_shown(r->memory, item->name));
    diag_hint(r->d, "use letters, digits and `_`, and begin with a letter");
  }
  int first = deck_find_monitor(r->k, item->name);
  name_is_new(r, "monitor", item->name, &item->item,
              first < 0 ? NULL : &r->k->monitors[first].item);
}

/* Forces come from supports and drives only; without any along the component a reaction is 0 for
 * ever. */
static void check_reaction(deck_reader *r, const deck_monitor *item) {
  bool found = false;
  for (int i = 0; i < r->k->support_count; i++)
    found |= r->k->supports[i].item.faulty || r->k->supports[i].fix & 1 << item->component;
  for (int i = 0; i < r->k->drive_count; i++)
    found |= r->k->drives[i].item.faulty || r->k->drives[i].component == item->component;
  if (found || !r->names_known) return;
  diag_report(r->d, DIAG_CONFLICT, item->item.where,
              "this reaction is always 0: no `&support` or `&drive` acts on `%s`",
              component_name(r, item->region, item->component));
}

static void check_broken(deck_reader *r, const namelist_group *from, deck_monitor *item) {
  if (!namelist_find(from, "above")) item->above = 1;
  if (item->above > 0 && item->above <= 1) return;
  diag_report(r->d, DIAG_OUT_OF_BOUNDS, deck_where(&item->item, "above"),
              "`above` of a broken monitor must be greater than 0 and at most 1");
}

static const char *watched_region(const deck_monitor *item) {
  return item->region ? item->region : item->between[0];
}

void deck_check_monitor(deck_reader *r, const namelist_group *from, deck_monitor *item) {
  const namelist_key *between = namelist_find(from, "between");
  check_monitor_name(r, item);
  if (item->kind == MONITOR_REACTION && between) item->kind = MONITOR_REACTIONS;
  if (!deck_keys_fit(from, monitor_uses, 5, (int)item->kind, monitor_words[item->kind], r->d))
    return;
  if (!namelist_find(from, "zero_at")) item->zero_at = -1;
  if (item->kind == MONITOR_BROKEN) check_broken(r, from, item);
  warn_late(r, &item->item, "zero_at", item->zero_at);
  if (item->region) item_region_known(r, &item->item, item->region);
  for (int i = 0; between && i < 2; i++)
    region_known(r, between->values[i].where, item->between[i]);
  if (!take_component(r, &item->item, watched_region(item), &item->component)) return;
  if (item->kind == MONITOR_REACTION || item->kind == MONITOR_REACTIONS) check_reaction(r, item);
}

/* Unit of a monitor's values. */
static const char *monitor_unit(const deck_reader *r, const deck_monitor *m) {
  const bool rotates = is_rotation(r, watched_region(m), m->component);
  switch (m->kind) {
  case MONITOR_REACTION:
  case MONITOR_REACTIONS:
    return rotates ? "N*m" : "N";
  case MONITOR_DISPLACEMENT:
  case MONITOR_OPENING:
    return rotates ? "1" : "m";
  case MONITOR_VELOCITY:
    return rotates ? "1/s" : "m/s";
  default:
    return "1";
  }
}

static void check_level(deck_reader *r, const namelist_key *key, deck_stop *item,
                        const char *unit_text) {
  const namelist_value *v = &key->values[0];
  if (!deck_values_counted(key, 1, r->d) ||
      !deck_real_read(v, key->name, unit_text, BOUND_NOT_NEGATIVE, &item->level, r->d))
    return;
  if (item->of_peak && (item->level <= 0 || item->level >= 1))
    diag_report(r->d, DIAG_OUT_OF_BOUNDS, v->where,
                "a fraction of the peak must be greater than 0 and less than 1");
}

void deck_check_stop(deck_reader *r, const namelist_group *from, deck_stop *item) {
  const namelist_key *of = namelist_find(from, "of"), *key = either(r, from, "below", "above");
  warn_late(r, &item->item, "after", item->after);
  bool found =
      known(r, deck_find_monitor(r->k, item->monitor) >= 0, deck_where(&item->item, "monitor"),
            "monitor", item->monitor, monitor_names(r), r->k->monitor_count);
  if (!key || !found) return;
  item->below = key == namelist_find(from, "below");
  item->of_peak = of != NULL;
  if (of && !item->below) {
    diag_report(r->d, DIAG_CONFLICT, of->name_where, "`of = 'peak'` goes with `below` only");
    diag_hint(r->d, "no value is above the largest one so far");
    return;
  }
  const deck_monitor *m = &r->k->monitors[deck_find_monitor(r->k, item->monitor)];
  if (!m->item.faulty) check_level(r, key, item, of ? "1" : monitor_unit(r, m));
}

/* Which fields a law has is known later only. */
static void keep_field_places(deck_reader *r, const namelist_group *from, deck_output *item) {
  const namelist_key *fields = namelist_find(from, "fields");
  if (!fields || fields->value_count != item->field_count) return;
  span *where = arena_alloc(r->memory, (size_t)fields->value_count * sizeof *where);
  for (int k = 0; k < fields->value_count; k++)
    where[k] = fields->values[k].where;
  item->field_where = where;
}

void deck_check_output(deck_reader *r, const namelist_group *from, deck_output *item) {
  enum { MOST_SAMPLES = 10000000 };
  double end = r->k->simulation.end_time;
  keep_field_places(r, from, item);
  if (end <= 0 || item->sample <= 0) return;
  if (item->sample > end)
    diag_report(r->d, DIAG_OUT_OF_BOUNDS, deck_where(&item->item, "sample"),
                "`sample` is longer than the run");
  else if (end / item->sample > MOST_SAMPLES)
    diag_report(r->d, DIAG_OUT_OF_BOUNDS, deck_where(&item->item, "sample"),
                "`sample` gives %.3g samples; the most is %d", end / item->sample, MOST_SAMPLES);
}

void deck_check_checkpoint(deck_reader *r, const namelist_group *from, deck_checkpoint *item) {
  (void)r;
  (void)from;
  (void)item;
}

/* --- the whole deck --------------------------------------------------------------------------- */

/* A faulty item may be the one that is missed. Particles of a file need no body. */
static bool has_body(const deck *k, const deck_lattice *lattice) {
  for (int i = 0; i < k->body_count; i++)
    if (k->bodys[i].item.faulty || same(k->bodys[i].lattice, lattice->name)) return true;
  return same(lattice->kind, "particles");
}

static bool has_material(const deck *k, const char *lattice) {
  for (int i = 0; i < k->material_count; i++)
    if (k->materials[i].item.faulty || same(k->materials[i].lattice, lattice)) return true;
  return false;
}

/* Inertia and its damping are means of the relaxation. */
static void check_quasi_static(deck_reader *r) {
  const deck *k = r->k;
  if (k->relaxation.increments < 1) return;
  if (k->damping_count > 0)
    diag_report(r->d, DIAG_CONFLICT, k->dampings[0].item.where,
                "a quasi-static run chooses its damping itself: no `&damping` with `&relaxation`");
  if (k->initial_velocity_count > 0)
    diag_report(r->d, DIAG_CONFLICT, k->initial_velocitys[0].item.where,
                "a quasi-static run begins at rest: no `&initial_velocity` with `&relaxation`");
}

void deck_check_whole(deck_reader *r) {
  const deck *k = r->k;
  const deck_item *simulation = &k->simulation.item;
  if (simulation->where.end == 0) /* never read */
    diag_report(r->d, DIAG_MISSING_KEY, simulation->where, "the deck has no `&simulation`");
  if (k->lattice_count == 0)
    diag_report(r->d, DIAG_MISSING_KEY, simulation->where, "the deck has no `&lattice`");
  check_quasi_static(r);
  for (int i = 0; i < k->lattice_count; i++) {
    const deck_lattice *lattice = &k->lattices[i];
    if (!lattice->name) continue;
    const char *name = deck_shown(r->memory, lattice->name);
    if (!has_material(k, lattice->name))
      diag_report(r->d, DIAG_MISSING_KEY, lattice->item.where,
                  "the lattice `%s` has no `&material`", name);
    if (!has_body(k, lattice))
      diag_report(r->d, DIAG_MISSING_KEY, lattice->item.where, "the lattice `%s` has no `&body`",
                  name);
  }
}
