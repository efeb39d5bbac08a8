#include "runtime/deck/group_body.h"

#include <math.h>
#include <string.h>

#include "dsl/base/elementary.h"
#include "runtime/deck/deck_check.h"
#include "runtime/deck/deck_formula.h"
#include "runtime/deck/deck_load.h"
#include "runtime/deck/deck_value.h"
#include "runtime/deck/group_load.h"
#include "runtime/deck/group_mesh.h"
#include "runtime/deck/group_monitor.h"
#include "runtime/deck/lattice_kind.h"

/* --- shapes ----------------------------------------------------------------------------------- */

#define SHAPE_KEYS(group)                                                                          \
  {.name = "shape",                                                                                \
   .type = DECK_CHOICE,                                                                            \
   .choices = "point|rectangle|disc|polygon|dog_bone|segment|box|cylinder|sphere|extrusion|face",  \
   .required = true,                                                                               \
   DECK_AT(group, shape.kind),                                                                     \
   .doc = "decides which of the keys below are needed; those from `box` on are "                   \
          "of space, a point is of both"},                                                         \
      {.name = "at",                                                                               \
       .type = DECK_PLACE,                                                                         \
       .unit = "m",                                                                                \
       DECK_AT(group, shape.at),                                                                   \
       .doc = "point: position; the nearest site is meant"},                                       \
      {.name = "within",                                                                           \
       .type = DECK_REAL,                                                                          \
       .unit = "m",                                                                                \
       .bound = BOUND_POSITIVE,                                                                    \
       .fallback = "= half a spacing",                                                             \
       DECK_AT(group, shape.within),                                                               \
       .doc = "point: largest distance of that site"},                                             \
      {.name = "corner",                                                                           \
       .type = DECK_PLACE,                                                                         \
       .unit = "m",                                                                                \
       DECK_AT(group, shape.corner),                                                               \
       .doc = "rectangle, box: the corner of least coordinates"},                                  \
      {.name = "size",                                                                             \
       .type = DECK_PLACE,                                                                         \
       .unit = "m",                                                                                \
       .bound = BOUND_POSITIVE,                                                                    \
       DECK_AT(group, shape.size),                                                                 \
       .doc = "rectangle, box: extent along x, y, z"},                                             \
      {.name = "rotation",                                                                         \
       .type = DECK_ANGLE,                                                                         \
       .fallback = "0",                                                                            \
       DECK_AT(group, shape.rotation),                                                             \
       .doc = "rectangle: about its corner; dog-bone: about its centre; a plain "                  \
              "number is in degrees"},                                                             \
      {.name = "centre",                                                                           \
       .type = DECK_PLACE,                                                                         \
       .unit = "m",                                                                                \
       DECK_AT(group, shape.centre),                                                               \
       .doc = "disc, dog-bone, sphere: centre"},                                                   \
      {.name = "radius",                                                                           \
       .type = DECK_REAL,                                                                          \
       .unit = "m",                                                                                \
       .bound = BOUND_POSITIVE,                                                                    \
       DECK_AT(group, shape.radius),                                                               \
       .doc = "disc, cylinder, sphere: outer radius; dog-bone: of the arcs at its "                \
              "neck"},                                                                             \
      {.name = "inner_radius",                                                                     \
       .type = DECK_REAL,                                                                          \
       .unit = "m",                                                                                \
       .bound = BOUND_NOT_NEGATIVE,                                                                \
       .fallback = "0",                                                                            \
       DECK_AT(group, shape.inner_radius),                                                         \
       .doc = "disc, cylinder, sphere: radius of the hole"},                                       \
      {.name = "width",                                                                            \
       .type = DECK_REAL,                                                                          \
       .unit = "m",                                                                                \
       .bound = BOUND_POSITIVE,                                                                    \
       DECK_AT(group, shape.width),                                                                \
       .doc = "dog-bone: of its ends"},                                                            \
      {.name = "height",                                                                           \
       .type = DECK_REAL,                                                                          \
       .unit = "m",                                                                                \
       .bound = BOUND_POSITIVE,                                                                    \
       DECK_AT(group, shape.height),                                                               \
       .doc = "dog-bone: from end to end"},                                                        \
      {.name = "neck",                                                                             \
       .type = DECK_REAL,                                                                          \
       .unit = "m",                                                                                \
       .bound = BOUND_POSITIVE,                                                                    \
       DECK_AT(group, shape.neck),                                                                 \
       .doc = "dog-bone: width in the middle, between two arcs"},                                  \
      {.name = "from",                                                                             \
       .type = DECK_PLACE,                                                                         \
       .unit = "m",                                                                                \
       DECK_AT(group, shape.from),                                                                 \
       .doc = "segment, cylinder: one end, of the cylinder's axis"},                               \
      {.name = "to",                                                                               \
       .type = DECK_PLACE,                                                                         \
       .unit = "m",                                                                                \
       DECK_AT(group, shape.to),                                                                   \
       .doc = "segment, cylinder: the other end"},                                                 \
      {.name = "z",                                                                                \
       .type = DECK_PAIR,                                                                          \
       .unit = "m",                                                                                \
       DECK_AT(group, shape.z),                                                                    \
       .doc = "extrusion: from where to where the polygon reaches"},                               \
      {.name = "points",                                                                           \
       .type = DECK_REALS,                                                                         \
       .unit = "m",                                                                                \
       DECK_AT(group, shape.points),                                                               \
       DECK_COUNT_AT(group, shape.point_count),                                                    \
       .doc = "polygon, extrusion: x1, y1, x2, y2, x3, y3, ...; face: x1, y1, z1, "                \
              "... of the corners of a plane polygon in space"},                                   \
  {                                                                                                \
    .name = "bulge", .type = DECK_REALS, .unit = "m", .fallback = "= straight edges",              \
    DECK_AT(group, shape.bulge), DECK_COUNT_AT(group, shape.bulge_count),                          \
    .doc = "polygon, extrusion: for each point, how far the edge that begins "                     \
           "there rises as an arc above its chord, outward positive, 0: straight"                  \
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

/* Twice the area of a polygon of straight edges, positive when its corners are
   counter-clockwise. */
static double twice_area(const deck_shape *shape, double *extent) {
  const double *p = shape->points;
  const int values = 2 * shape->point_count;
  double area = 0;
  *extent = 0;
  for (int i = 2; i < values; i += 2) {
    int next = (i + 2) % values;
    area += (p[i] - p[0]) * (p[next + 1] - p[1]) - (p[next] - p[0]) * (p[i + 1] - p[1]);
    *extent = pl_fmax(*extent, pl_fmax(fabs(p[i] - p[0]), fabs(p[i + 1] - p[1])));
  }
  return area;
}

/* Edges with arcs are put in counter-clockwise order: the edge that began at point k then begins at
   its other end. */
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

/* Of those that the group may have. */
static const char *shapes_of(const deck_group_info *info, int dimensions) {
  if (info == &deck_group_stamp)
    return dimensions == 2 ? "'rectangle' and 'disc'" : "'box', 'cylinder' and 'sphere'";
  return dimensions == 2 ? "'point', 'rectangle', 'disc', 'polygon', 'dog_bone' and 'segment'"
                         : "'point', 'box', 'cylinder', 'sphere', 'extrusion' and 'face'";
}

static bool shape_is_of(deck_reader *r, const deck_group_info *info, const deck_item *item,
                        const deck_shape *shape, int dimensions) {
  if (shape->kind == SHAPE_POINT || (shape->kind >= SHAPE_BOX) == (dimensions == 3)) return true;
  diag_report(r->d, DIAG_CONFLICT, deck_where(item, "shape"), "%s is a shape %s, the lattice is %s",
              shape_words[shape->kind], dimensions == 2 ? "in space" : "of the plane",
              dimensions == 2 ? "in the plane" : "in space");
  diag_hint(r->d, "there are %s", shapes_of(info, dimensions));
  return false;
}

static void check_shape(deck_reader *r, const namelist_group *from, const deck_group_info *info,
                        const deck_item *item, deck_shape *shape, const char *lattice) {
  const int count = (int)(sizeof shape_uses / sizeof *shape_uses);
  const int dimensions = deck_dimensions_of(r, lattice), errors = r->d->errors;
  if (!deck_keys_fit(from, shape_uses, count, (int)shape->kind, shape_words[shape->kind], r->d))
    return;
  if (dimensions && !shape_is_of(r, info, item, shape, dimensions)) return;
  if (dimensions) deck_check_places(r, from, info, dimensions);
  if (r->d->errors == errors) check_numbers(r, item, shape);
}

static void check_can_be_filled(deck_reader *r, const deck_item *item, const deck_shape *shape,
                                const char *lattice, bool is_body) {
  const int l = deck_find_lattice(r->k, lattice);
  const bool suits = is_body ? shape_has_size(shape) : shape->kind != SHAPE_POINT;
  if (l < 0 || r->k->lattices[l].item.faulty) return;
  if (deck_lattice_is_link(&r->k->lattices[l])) {
    diag_report(r->d, DIAG_CONFLICT, deck_where(item, "lattice"),
                "`%s` is a link, whose particles are those that it joins",
                deck_shown(r->memory, lattice));
    diag_hint(r->d, "name the bar, or the lattice around it");
    return;
  }
  if (deck_lattice_is_bar(&r->k->lattices[l])) {
    diag_report(r->d, DIAG_CONFLICT, deck_where(item, "lattice"),
                is_body ? "`%s` is a bar: its `points` say where it is"
                        : "`%s` is a bar: notches do not cut it",
                deck_shown(r->memory, lattice));
    return;
  }
  if (deck_lattice_is_mesh(&r->k->lattices[l])) {
    diag_report(r->d, DIAG_CONFLICT, deck_where(item, "lattice"),
                is_body ? "`%s` is a mesh: its `corner` and `size` say where it is"
                        : "`%s` is a mesh, not a lattice",
                deck_shown(r->memory, lattice));
    if (!is_body)
      diag_hint(r->d, "&notch mesh = '%s' ... is a hole in it", deck_shown(r->memory, lattice));
    return;
  }
  if (suits || !deck_lattice_is_listed(&r->k->lattices[l])) return;
  if (!deck_lattice_is_irregular(&r->k->lattices[l])) {
    if (!is_body) return; /* a notch may take a single site */
    diag_report(r->d, DIAG_CONFLICT, deck_where(item, "shape"),
                "%s has no area or volume, of which `edges = 'exact'` gives each particle its part",
                shape_words[shape->kind]);
    return;
  }
  diag_report(r->d, DIAG_CONFLICT, deck_where(item, "shape"),
              shape->kind == SHAPE_POINT ? "%s means a site of a lattice, but here are none"
                                         : "%s cannot be filled with particles",
              shape_words[shape->kind]);
}

/* --- what has a shape ------------------------------------------------------------------------- */

static const deck_key_info body_keys[] = {
    {.name = "lattice",
     .type = DECK_NAME,
     .required = true,
     DECK_AT(body, lattice),
     .doc = "name of the lattice"},
    SHAPE_KEYS(body),
};

static void check_body(deck_reader *r, const namelist_group *from, void *into) {
  deck_body *item = into;
  deck_lattice_known(r, &item->item, item->lattice);
  check_shape(r, from, &deck_group_body, &item->item, &item->shape, item->lattice);
  check_can_be_filled(r, &item->item, &item->shape, item->lattice, true);
}

DECK_LIST(body, .identity = "lattice", .check = check_body,
          .doc = "Adds the lattice sites inside or on a shape. At least one for each lattice.");

static const deck_key_info notch_keys[] = {
    {.name = "lattice",
     .type = DECK_NAME,
     .fallback = "= none; this or `mesh`",
     DECK_AT(notch, lattice),
     .doc = "name of the lattice"},
    {.name = "mesh",
     .type = DECK_NAME,
     .fallback = "= none",
     DECK_AT(notch, mesh),
     .doc = "instead: name of the mesh, in which this is a hole"},
    {.name = "cut_bonds",
     .type = DECK_LOGICAL,
     .fallback = ".true.",
     DECK_AT(notch, cut_bonds),
     .doc = "of a lattice: also remove bonds between remaining sites whose line crosses the shape"},
    SHAPE_KEYS(notch),
};

/* The name of what the notch is in. */
static bool take_cut_body(deck_reader *r, const namelist_group *from, deck_notch *item) {
  deck_refuse_both(r, from, "lattice", "mesh");
  deck_refuse_both(r, from, "mesh", "cut_bonds");
  if (item->lattice && item->mesh) return false;
  if (item->lattice) return deck_lattice_known(r, &item->item, item->lattice);
  if (item->mesh) {
    item->lattice = item->mesh;
    return deck_mesh_known(r, &item->item, item->mesh);
  }
  diag_report(r->d, DIAG_MISSING_KEY, from->where, "`&notch` has no `lattice`");
  diag_hint(r->d, "lattice: name of the lattice; of a hole in a mesh `mesh`");
  return false;
}

static void check_hole(deck_reader *r, const deck_notch *item) {
  if (shape_has_size(&item->shape)) return;
  diag_report(r->d, DIAG_CONFLICT, deck_where(&item->item, "shape"),
              "%s has no inside: it is no hole in a mesh", shape_words[item->shape.kind]);
  diag_hint(r->d, item->shape.kind == SHAPE_SEGMENT
                      ? "a &crack is a line that nodes do not act across"
                      : "there are 'rectangle', 'disc', 'polygon' and 'dog_bone'");
}

static void check_notch(deck_reader *r, const namelist_group *from, void *into) {
  deck_notch *item = into;
  const bool known = take_cut_body(r, from, item);
  check_shape(r, from, &deck_group_notch, &item->item, &item->shape, item->lattice);
  if (!known) return;
  if (item->mesh) {
    check_hole(r, item);
    deck_refuse_of_file(r, &item->item, item->mesh, "holes");
  } else
    check_can_be_filled(r, &item->item, &item->shape, item->lattice, false);
}

DECK_LIST(
    notch, .identity = "lattice", .parts = {"mesh"}, .check = check_notch,
    .doc = "Removes the sites inside or on a shape and, by default, the bonds that cross it; in a "
           "mesh it is a hole: see [Holes in meshes](#holes-in-meshes).");

static const deck_key_info region_keys[] = {
    {.name = "name", .type = DECK_NAME, .required = true, DECK_AT(region, name), .doc = "its name"},
    {.name = "lattice",
     .type = DECK_NAME,
     .fallback = "= the only one",
     DECK_AT(region, lattice),
     .doc = "name of the lattice; needed when there are several"},
    SHAPE_KEYS(region),
};

static void check_region(deck_reader *r, const namelist_group *from, void *into) {
  deck_region *item = into;
  check_shape(r, from, &deck_group_region, &item->item, &item->shape, item->lattice);
  int first = deck_find_region(r->k, item->name);
  deck_check_name(r, "region", item->name, &item->item,
                  first < 0 ? NULL : &r->k->regions[first].item);
  if (item->lattice) {
    deck_lattice_known(r, &item->item, item->lattice);
  } else if (r->k->lattice_count == 1) {
    item->lattice = r->k->lattices[0].name;
  } else if (r->names_known && r->k->lattice_count > 1) {
    diag_report(r->d, DIAG_MISSING_KEY, item->item.where, "`&region` needs `lattice` here");
    diag_hint(r->d, "the deck has %d lattices", r->k->lattice_count);
  }
}

DECK_LIST(region, .identity = "name", .check = check_region,
          .doc = "Names the particles inside or on a shape, for loads and monitors.");

static const deck_key_info zone_keys[] = {
    {.name = "mesh",
     .type = DECK_NAME,
     .required = true,
     DECK_AT(zone, mesh),
     .doc = "name of the mesh"},
    {.name = "method",
     .type = DECK_CHOICE,
     .choices = "element_free|finite_elements",
     .required = true,
     DECK_AT(zone, method),
     .doc = "of its nodes; cells between nodes of both blend them"},
    {.name = "gauss",
     .type = DECK_COUNT,
     .fallback = "2",
     .most = 2,
     DECK_AT(zone, gauss),
     .doc = "of finite elements: points of integration along either axis, 1 or 2"},
    {.name = "dilatation",
     .type = DECK_CHOICE,
     .choices = "point|mean",
     .fallback = "'point'",
     DECK_AT(zone, dilatation),
     .doc = "of its finite elements, as of the mesh's"},
    {.name = "hourglass",
     .type = DECK_REAL,
     .unit = "1",
     .bound = BOUND_NOT_NEGATIVE,
     .fallback = "0",
     DECK_AT(zone, hourglass),
     .doc = "of its finite elements, as of the mesh's"},
    SHAPE_KEYS(zone),
};

static void check_zone(deck_reader *r, const namelist_group *from, void *into) {
  deck_zone *item = into;
  check_shape(r, from, &deck_group_zone, &item->item, &item->shape, item->mesh);
  deck_mesh_known(r, &item->item, item->mesh);
  const int lattice = item->mesh ? deck_find_lattice(r->k, item->mesh) : -1;
  deck_refuse_of_file(r, &item->item, item->mesh, "zones");
  if (lattice >= 0 && r->k->lattices[lattice].corners && item->method == MESH_ELEMENT_FREE)
    diag_report(r->d, DIAG_CONFLICT, deck_where(&item->item, "method"),
                "element-free nodes stand on a rectangle, and `%s` is given by `corners`",
                deck_shown(r->memory, item->mesh));
  if (lattice >= 0)
    deck_check_elements(r, from, &item->item,
                        &(deck_elements){item->method, item->gauss, item->dilatation,
                                         item->hourglass, r->k->lattices[lattice].setting});
  if (item->gauss < 1)
    diag_report(r->d, DIAG_OUT_OF_BOUNDS, deck_where(&item->item, "gauss"),
                "an element has 1 or 2 points along either axis");
  if (item->method == MESH_ELEMENT_FREE && namelist_find(from, "gauss"))
    diag_report(r->d, DIAG_CONFLICT, deck_where(&item->item, "gauss"),
                "element-free cells have the points of the mesh: give `gauss` there");
}

DECK_LIST(zone, .identity = "mesh", .check = check_zone,
          .doc = "The nodes of a mesh inside or on a shape have this method. Of several zones the "
                 "last one counts.");

static const deck_key_info point_mass_keys[] = {
    {.name = "region",
     .type = DECK_NAME,
     .required = true,
     DECK_AT(point_mass, region),
     .doc = "what carries it"},
    {.name = "mass",
     .type = DECK_REAL,
     .unit = "kg",
     .bound = BOUND_POSITIVE,
     DECK_AT(point_mass, mass),
     .doc = "on each particle; or give the `total`"},
    {.name = "total",
     .type = DECK_REAL,
     .unit = "kg",
     .bound = BOUND_POSITIVE,
     DECK_AT(point_mass, total),
     .doc = "of all particles together, which have equal shares; or give the `mass`"},
    {.name = "inertia",
     .type = DECK_REAL,
     .unit = "kg*m^2",
     .bound = BOUND_POSITIVE,
     .fallback = "= 0",
     DECK_AT(point_mass, inertia),
     .doc = "moment of inertia on each particle, in space about any axis; for particles that "
            "rotate"},
};

static void check_point_mass(deck_reader *r, const namelist_group *from, void *into) {
  const deck_point_mass *item = into;
  deck_moving_region_known(r, &item->item, item->region);
  deck_refuse_both(r, from, "mass", "total");
  if (namelist_find(from, "mass") || namelist_find(from, "total")) return;
  diag_report(r->d, DIAG_MISSING_KEY, item->item.where, "`&point_mass` needs `mass` or `total`");
  diag_hint(r->d, "mass = '0.2 kg' puts this on each particle, total = '0.2 kg' on all together");
}

DECK_LIST(point_mass, .identity = "region", .check = check_point_mass,
          .doc = "Mass that particles carry beside their own, without stiffness; several add up. "
                 "See [Point masses](#point-masses).");

/* --- stamps ----------------------------------------------------------------------------------- */

static const deck_key_info stamp_keys[] = {
    {.name = "name",
     .type = DECK_NAME,
     .required = true,
     DECK_AT(stamp, name),
     .doc = "its name, also of its energies in the history"},
    {.name = "shape",
     .type = DECK_CHOICE,
     .choices = "rectangle|disc|box|cylinder|sphere",
     .required = true,
     DECK_AT(stamp, shape.kind),
     .doc = "decides which of the next seven keys are needed; those from `box` on are of space"},
    {.name = "corner",
     .type = DECK_PLACE,
     .unit = "m",
     DECK_AT(stamp, shape.corner),
     .doc = "rectangle, box: the corner of least coordinates"},
    {.name = "size",
     .type = DECK_PLACE,
     .unit = "m",
     .bound = BOUND_POSITIVE,
     DECK_AT(stamp, shape.size),
     .doc = "rectangle, box: extent along x, y, z"},
    {.name = "rotation",
     .type = DECK_ANGLE,
     .fallback = "0",
     DECK_AT(stamp, shape.rotation),
     .doc = "rectangle: about its corner; a plain number is in degrees"},
    {.name = "centre",
     .type = DECK_PLACE,
     .unit = "m",
     DECK_AT(stamp, shape.centre),
     .doc = "disc, sphere: centre"},
    {.name = "radius",
     .type = DECK_REAL,
     .unit = "m",
     .bound = BOUND_POSITIVE,
     DECK_AT(stamp, shape.radius),
     .doc = "disc, cylinder, sphere: radius"},
    {.name = "from",
     .type = DECK_PLACE,
     .unit = "m",
     DECK_AT(stamp, shape.from),
     .doc = "cylinder: one end of its axis"},
    {.name = "to",
     .type = DECK_PLACE,
     .unit = "m",
     DECK_AT(stamp, shape.to),
     .doc = "cylinder: the other end"},
    {.name = "lattices",
     .type = DECK_NAMES,
     .fallback = "= all",
     DECK_AT(stamp, lattices),
     DECK_COUNT_AT(stamp, lattice_count),
     .doc = "names of the lattices whose particles it touches. Bars and links touch nothing"},
    {.name = "mass",
     .type = DECK_REAL,
     .unit = "kg",
     .bound = BOUND_POSITIVE,
     DECK_AT(stamp, mass),
     .doc =
         "with it the stamp moves as the particles push it, and by `&gravity`; it does not turn. "
         "Without it its motion is prescribed"},
    {.name = "guided",
     .type = DECK_LOGICAL,
     .fallback = ".false.",
     DECK_AT(stamp, guided),
     .doc = "with a mass: it moves along `direction` alone"},
    {.name = "direction",
     .type = DECK_PLACE,
     .unit = "1",
     DECK_AT(stamp, direction),
     .doc = "of its velocity or displacement, of any length; a stamp of velocity 0 needs none"},
    {.name = "velocity",
     .type = DECK_LATER,
     .unit = "m/s",
     DECK_NOT_KEPT,
     .doc = "along `direction`; with a mass at the beginning, else as the run goes on; 0 without a "
            "mass: it stands"},
    {.name = "displacement",
     .type = DECK_LATER,
     .unit = "m",
     DECK_NOT_KEPT,
     .doc = "without a mass: along `direction`, from where it is drawn"},
    {.name = "stiffness",
     .type = DECK_REAL,
     .unit = "N/m",
     .bound = BOUND_POSITIVE,
     .fallback = "= E V/s^2 of the lattice",
     DECK_AT(stamp, stiffness),
     .doc = "force on a particle over the way that it lies in the stamp"},
    {.name = "friction",
     .type = DECK_REAL,
     .unit = "1",
     .bound = BOUND_NOT_NEGATIVE,
     .fallback = "0",
     DECK_AT(stamp, friction),
     .doc = "coefficient of friction: most that acts along the surface over what acts across"},
    {.name = "damping",
     .type = DECK_REAL,
     .unit = "1",
     .bound = BOUND_NOT_NEGATIVE,
     .fallback = "0",
     DECK_AT(stamp, damping),
     .doc = "of the contact, across the surface: part of the critical damping of a particle on its "
            "spring. Quasi-static runs leave it out"},
    DECK_TIME_KEYS,
};

/* Of a lattice, a contact or a stamp before this one: their energies stand side by side. */
static const deck_item *part_of_name(const deck_reader *r, const char *name) {
  const int lattice = deck_find_lattice(r->k, name), contact = deck_find_contact(r->k, name),
            stamp = deck_find_stamp(r->k, name);
  if (lattice >= 0) return &r->k->lattices[lattice].item;
  if (contact >= 0) return &r->k->contacts[contact].item;
  return stamp < 0 ? NULL : &r->k->stamps[stamp].item;
}

static void check_stamp_name(deck_reader *r, const deck_stamp *item) {
  deck_check_folder_name(r, "stamp", &item->item, item->name);
  deck_check_name(r, "lattice, contact or stamp", item->name, &item->item,
                  part_of_name(r, item->name));
}

/* Those that it names are lattices of particles. */
static void check_stamped(deck_reader *r, const deck_stamp *item) {
  const span where = deck_where(&item->item, "lattices");
  for (int n = 0; n < item->lattice_count; n++) {
    const char *name = item->lattices[n];
    if (!deck_lattice_known_at(r, where, name)) continue;
    const int lattice = deck_find_lattice(r->k, name);
    const deck_lattice *of = lattice < 0 ? NULL : &r->k->lattices[lattice];
    if (of && (deck_lattice_is_bar(of) || deck_lattice_is_link(of)))
      diag_report(r->d, DIAG_BAD_VALUE, where, "`%s` is a %s: a stamp touches lattices alone",
                  deck_shown(r->memory, name), deck_lattice_word(of));
  }
  bool some = item->lattice_count > 0 || r->k->lattice_count == 0;
  for (int n = 0; n < r->k->lattice_count; n++)
    some = some || deck_lattice_is_stamped(&r->k->lattices[n], item);
  if (!some)
    diag_report(r->d, DIAG_CONFLICT, item->item.where,
                "the deck has no lattice that this stamp could touch");
}

/* Length 1. */
static bool take_way(deck_reader *r, const namelist_group *from, deck_stamp *item) {
  double *v = item->direction;
  const double size = pl_hypot(pl_hypot(v[0], v[1]), v[2]);
  const bool stands = item->motion.shape == TIME_CONSTANT && item->motion.value == 0,
             written = namelist_find(from, "direction");
  if (!written && stands && !item->guided) return true;
  if (!(size > 0)) {
    diag_report(r->d, written ? DIAG_OUT_OF_BOUNDS : DIAG_MISSING_KEY,
                deck_where(&item->item, "direction"),
                written        ? "`direction` is 0 and points nowhere"
                : item->guided ? "a stamp that is guided needs a `direction`"
                               : "this stamp moves, but has no `direction`");
    diag_hint(r->d, "e.g. direction = 0, -1 in the plane, downward");
    return false;
  }
  for (int c = 0; c < 3; c++)
    v[c] /= size;
  return true;
}

/* Of a stamp with a mass: a velocity, and no more. */
static bool take_free(deck_reader *r, const namelist_group *from, deck_stamp *item) {
  static const char *const prescribed[] = {"displacement", "history", "start", "end",    "rise",
                                           "times",        "values",  "file",  "formula"};
  const namelist_key *velocity = namelist_find(from, "velocity");
  for (size_t k = 0; k < sizeof prescribed / sizeof *prescribed; k++) {
    const namelist_key *key = namelist_find(from, prescribed[k]);
    if (!key) continue;
    diag_report(r->d, DIAG_CONFLICT, key->name_where,
                "`mass` and `%s` exclude each other: a stamp with a mass moves as it is pushed",
                prescribed[k]);
    diag_hint(r->d, "leave `mass` away to prescribe the motion; `velocity` alone is that at the "
                    "beginning");
    return false;
  }
  if (r->k->relaxation.increments > 0) {
    diag_report(r->d, DIAG_CONFLICT, deck_where(&item->item, "mass"),
                "a quasi-static run has no inertia that a free stamp could move with");
    diag_hint(r->d, "prescribe its motion, e.g. direction = 0, -1  displacement = '1 mm'");
    return false;
  }
  item->motion = (time_function){.shape = TIME_CONSTANT};
  return !velocity || (deck_values_counted(velocity, 1, r->d) &&
                       deck_real_read(&velocity->values[0], "velocity", "m/s", BOUND_NONE,
                                      &item->motion.value, r->d));
}

static bool take_prescribed(deck_reader *r, const namelist_group *from, deck_stamp *item) {
  static const deck_load_kind kinds[] = {{"velocity", "m/s", false, &deck_formula_of_time},
                                         {"displacement", "m", false, &deck_formula_of_time}};
  static const char *const some[] = {"velocity", "displacement", "file", "formula"};
  bool moves = false;
  for (size_t k = 0; k < sizeof some / sizeof *some; k++)
    moves = moves || namelist_find(from, some[k]);
  if (!moves) {
    diag_report(r->d, DIAG_MISSING_KEY, from->where, "this stamp has neither a mass nor a motion");
    diag_hint(r->d, "mass = '2 kg' lets it move as it is pushed; `velocity` or `displacement` "
                    "prescribe how it moves; velocity = 0 holds it where it is");
    return false;
  }
  if (item->guided) {
    diag_report(r->d, DIAG_CONFLICT, deck_where(&item->item, "guided"),
                "`guided` goes with `mass`: a prescribed motion is along `direction` anyway");
    return false;
  }
  const int kind = deck_load_kind_of(r->memory, from, kinds, 2, r->d);
  if (kind < 0 || !deck_load_read(r->memory, from, &kinds[kind], &item->motion, r->d)) return false;
  deck_warn_late(r, &item->item, "start", item->motion.start);
  item->is_displacement = kind == 1;
  if (item->is_displacement) deck_spread_displacement(r, from, &item->motion);
  return true;
}

/* The lattice that says whether it is in the plane or in space. */
static const char *lattice_of_stamp(const deck_reader *r, const deck_stamp *item) {
  if (item->lattice_count > 0) return item->lattices[0];
  return r->k->lattice_count > 0 ? r->k->lattices[0].name : NULL;
}

static void check_stamp(deck_reader *r, const namelist_group *from, void *into) {
  static const shape_kind kinds[] = {SHAPE_RECTANGLE, SHAPE_DISC, SHAPE_BOX, SHAPE_CYLINDER,
                                     SHAPE_SPHERE};
  deck_stamp *item = into;
  item->shape.kind = kinds[item->shape.kind];
  check_stamp_name(r, item);
  check_stamped(r, item);
  check_shape(r, from, &deck_group_stamp, &item->item, &item->shape, lattice_of_stamp(r, item));
  if (item->mass > 0 ? take_free(r, from, item) : take_prescribed(r, from, item))
    take_way(r, from, item);
}

DECK_LIST(stamp, .identity = "name", .check = check_stamp,
          .doc = "A rigid body without particles that particles cannot enter: an indenter, a "
                 "projectile, an anvil, see [Stamps](#stamps). Give `mass`, `velocity` or "
                 "`displacement`.");
