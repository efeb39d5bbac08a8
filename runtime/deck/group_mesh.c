#include "runtime/deck/group_mesh.h"

#include <math.h>
#include <string.h>

#include "dsl/base/elementary.h"
#include "dsl/base/units.h"
#include "runtime/deck/deck_check.h"
#include "runtime/deck/deck_value.h"
#include "runtime/deck/group_lattice.h"
#include "runtime/deck/group_monitor.h"
#include "runtime/deck/lattice_kind.h"
#include "runtime/geometry/gmsh_mesh.h"
#include "runtime/geometry/quadrilateral.h"
#include "runtime/kernel.h"

/* --- the mesh --------------------------------------------------------------------------------- */

static const deck_key_info mesh_keys[] = {
    {.name = "name", .type = DECK_NAME, .required = true, DECK_AT(mesh, name), .doc = "its name"},
    {.name = "file",
     .type = DECK_NAME,
     .fallback = "= a rectangle",
     DECK_AT(mesh, file),
     .doc =
         "in place of `size` or `corners`: a mesh of Gmsh (`.msh`, version 4, ASCII), beside the "
         "deck; its physical groups are regions"},
    {.name = "unit",
     .type = DECK_WORD,
     .choices = "m|cm|mm|um|km|in|ft",
     .fallback = "'m'",
     DECK_AT(mesh, unit),
     .doc = "of places in the `file`"},
    {.name = "corner",
     .type = DECK_PLACE,
     .unit = "m",
     .fallback = "= 0, 0",
     DECK_AT(mesh, corner),
     .doc = "the corner of least coordinates of the rectangle that it fills"},
    {.name = "size",
     .type = DECK_PLACE,
     .unit = "m",
     .bound = BOUND_POSITIVE,
     .fallback = "= required, or `corners` or `file`",
     DECK_AT(mesh, size),
     .doc = "extent of the rectangle along x and y"},
    {.name = "corners",
     .type = DECK_REALS,
     .unit = "m",
     .fallback = "= a rectangle",
     DECK_AT(mesh, corners),
     DECK_COUNT_AT(mesh, corner_count),
     .doc =
         "x1, y1, ..., x4, y4: in place of `corner` and `size` the corners of a quadrilateral of "
         "finite elements, counter-clockwise; the first two are the ends of the first row of "
         "nodes"},
    {.name = "nodes",
     .type = DECK_PAIR,
     .unit = "1",
     .bound = BOUND_POSITIVE,
     .fallback = "= required without a `file`",
     DECK_AT(mesh, nodes),
     .doc = "how many nodes there are along x and along y, those at the ends included"},
    {.name = "thickness",
     .type = DECK_REAL,
     .unit = "m",
     .bound = BOUND_POSITIVE,
     .required = true,
     DECK_AT(mesh, thickness),
     .doc = "out of the plane"},
    {.name = "setting",
     .type = DECK_WORD,
     .choices = "plane_stress|plane_strain",
     .fallback = "'plane_stress'",
     DECK_AT(mesh, setting),
     .doc = "what the thickness direction does"},
    {.name = "method",
     .type = DECK_CHOICE,
     .choices = "element_free|finite_elements",
     .fallback = "= required; with a `file` finite elements",
     DECK_AT(mesh, method),
     .doc = "element-free Galerkin (moving least squares), or bilinear finite elements; a `&zone` "
            "has the other one"},
    {.name = "support",
     .type = DECK_REAL,
     .unit = "1",
     .bound = BOUND_POSITIVE,
     .fallback = "2.1",
     DECK_AT(mesh, support),
     .doc = "element-free: half width of a node's support in spacings, 1.5 to 5.5"},
    {.name = "gauss",
     .type = DECK_COUNT,
     .fallback = "= 4; of finite elements 2",
     .most = 6,
     DECK_AT(mesh, gauss),
     .doc = "points of integration of a cell along either axis; of finite elements 1 or 2"},
    {.name = "parts",
     .type = DECK_COUNT,
     .fallback = "1",
     .most = 8,
     DECK_AT(mesh, parts),
     .doc = "element-free: equal parts of a cell along either axis, each with its own points"},
    {.name = "dilatation",
     .type = DECK_CHOICE,
     .choices = "point|mean",
     .fallback = "'point'",
     DECK_AT(mesh, dilatation),
     .doc =
         "of quadrilaterals with 2 x 2 points in plane strain: each point has its own change of "
         "volume, or all that of the cell in the mean, so that nothing locks where volumes hardly "
         "change"},
    {.name = "hourglass",
     .type = DECK_REAL,
     .unit = "1",
     .bound = BOUND_NOT_NEGATIVE,
     .fallback = "0",
     DECK_AT(mesh, hourglass),
     .doc = "of quadrilaterals with one point: how stiffly they resist motions that do not strain "
            "it, in parts of their largest stiffness, such as 0.05"},
    {.name = "basis",
     .type = DECK_WORD,
     .choices = "linear|enriched",
     .fallback = "'linear'",
     DECK_NOT_KEPT,
     .doc = "element-free: 1, x, y; around tips of cracks with sqrt(r) of the nearest one, too"},
    {.name = "enriched_radius",
     .type = DECK_REAL,
     .unit = "1",
     .bound = BOUND_POSITIVE,
     .fallback = "4",
     DECK_AT(mesh, rich),
     .doc =
         "how far from a tip the enriched basis reaches, in spacings along x; from half of it on "
         "it blends into the linear one"},
    {.name = "ramp",
     .type = DECK_WORD,
     .choices = "linear|smooth",
     .fallback = "'linear'",
     DECK_NOT_KEPT,
     .doc = "how methods blend in the cells between zones: by R, or by 3R^2 - 2R^3"},
};

enum { LEAST_NODES = 2, MOST_NODES = 20000, MOST_IN_ALL = 4000000 };

/* Whole numbers of nodes, as a pair. */
static bool has_nodes(deck_reader *r, const deck_mesh *item) {
  for (int a = 0; a < 2; a++) {
    const double n = item->nodes[a];
    if (n == floor(n) && n >= LEAST_NODES && n <= MOST_NODES) continue;
    diag_report(r->d, DIAG_OUT_OF_BOUNDS, deck_where(&item->item, "nodes"),
                "a mesh has a whole number of nodes along each axis, %d to %d", LEAST_NODES,
                MOST_NODES);
    diag_hint(r->d, "such as nodes = 74, 25: 73 x 24 cells");
    return false;
  }
  if (item->nodes[0] * item->nodes[1] <= MOST_IN_ALL) return true;
  diag_report(r->d, DIAG_OUT_OF_BOUNDS, deck_where(&item->item, "nodes"),
              "a mesh has at most %d nodes in all, these are %.3g", MOST_IN_ALL,
              item->nodes[0] * item->nodes[1]);
  return false;
}

/* At a point as many nodes act as the linear basis needs, and not more than there is room for. */
static bool has_support(deck_reader *r, const deck_mesh *item) {
  if (item->support >= 1.5 && item->support <= 5.5) return true;
  diag_report(r->d, DIAG_OUT_OF_BOUNDS, deck_where(&item->item, "support"),
              item->support < 1.5 ? "a support of %g spacings leaves points with too few nodes"
                                  : "a support of %g spacings is wider than what is computed",
              item->support);
  diag_hint(r->d, "1.5 to 5.5; 2.1 is the sharpest at cracks, 3.5 the smoothest of the usual ones");
  return false;
}

static void begin_mesh(void *item) {
  deck_mesh *m = item;
  m->kind = lattice_kinds[LATTICE_KIND_mesh].name;
}

static void check_gauss(deck_reader *r, const namelist_group *from, deck_mesh *item) {
  const bool elements = item->method == MESH_FINITE_ELEMENTS;
  if (!namelist_find(from, "gauss")) item->gauss = elements ? 2 : 4;
  if (item->gauss < 1 || (elements && item->gauss > 2))
    diag_report(r->d, DIAG_OUT_OF_BOUNDS, deck_where(&item->item, "gauss"),
                elements ? "a bilinear element has 1 or 2 points along either axis"
                         : "a cell has at least one point");
  if (item->parts < 1)
    diag_report(r->d, DIAG_OUT_OF_BOUNDS, deck_where(&item->item, "parts"),
                "a cell has at least one part");
}

/* A convex quadrilateral, whose box stands for the rectangle. */
static bool take_corners(deck_reader *r, const namelist_group *from, deck_mesh *item) {
  const span where = deck_where(&item->item, "corners");
  deck_refuse_both(r, from, "corners", "corner");
  deck_refuse_both(r, from, "corners", "size");
  if (item->corner_count != 8) {
    diag_report(r->d, DIAG_BAD_VALUE, where, "a quadrilateral has four corners, 8 values, not %d",
                item->corner_count);
    return false;
  }
  if (item->method != MESH_FINITE_ELEMENTS) {
    diag_report(r->d, DIAG_CONFLICT, where,
                "element-free nodes stand on a rectangle: `corners` are for finite elements");
    diag_hint(r->d, "method = 'finite_elements', or `corner` and `size`");
    return false;
  }
  const double(*corners)[2] = (const double(*)[2])item->corners;
  for (int k = 0; k < 4; k++) {
    const double across = quadrilateral_turn(corners, (k + 2) % 4);
    if (quadrilateral_turn(corners, k) > 1e-9 * fabs(across)) continue;
    diag_report(r->d, DIAG_BAD_VALUE, where,
                "at corner %d the quadrilateral is not convex, or its corners stand clockwise",
                k + 1);
    diag_hint(r->d, "give them counter-clockwise, each inner angle less than 180 degrees");
    return false;
  }
  double upper[2];
  quadrilateral_box(corners, item->corner, upper);
  for (int a = 0; a < 2; a++)
    item->size[a] = upper[a] - item->corner[a];
  return true;
}

/* m: of the edges' parts the shortest. */
static double spacing_of(const deck_mesh *item) {
  double least = INFINITY;
  for (int k = 0; k < 4 && item->corner_count > 0; k++) {
    const double *a = item->corners + 2 * k, *b = item->corners + 2 * ((k + 1) % 4);
    least = pl_min(least, pl_hypot(b[0] - a[0], b[1] - a[1]) / (item->nodes[k % 2] - 1));
  }
  if (item->corner_count > 0) return least;
  return pl_min(item->size[0] / (item->nodes[0] - 1), item->size[1] / (item->nodes[1] - 1));
}

static bool has_extent(deck_reader *r, const namelist_group *from, deck_mesh *item) {
  if (item->corner_count > 0) return take_corners(r, from, item);
  if (namelist_find(from, "size")) return true;
  diag_report(r->d, DIAG_MISSING_KEY, from->where, "`&mesh` has no `size`");
  diag_hint(r->d,
            "size: extent of the rectangle along x and y (m); or `corners` of a quadrilateral");
  return false;
}

/* --- elements --------------------------------------------------------------------------------- */

/* What is wrong with a choice of elements, and how to mend it; NULL: nothing. */
static const char *wrong_dilatation(const deck_elements *e, const char **mend) {
  *mend = "leave it out here, and give it in a `&zone` of finite elements";
  if (e->method != MESH_FINITE_ELEMENTS) return "`dilatation` is of finite elements";
  *mend = "leave it out, or gauss = 2";
  if (e->gauss != 2) return "an element with one point has one dilatation anyhow";
  *mend = "leave it out, or setting = 'plane_strain' of the mesh";
  if (!e->setting || strcmp(e->setting, "plane_strain") != 0)
    return "in plane stress the thickness gives way, so that nothing locks: `dilatation = 'mean'` "
           "is "
           "for plane strain";
  return NULL;
}

static const char *wrong_hourglass(const deck_elements *e, const char **mend) {
  *mend = "leave it out here, and give it in a `&zone` of finite elements with gauss = 1";
  if (e->method != MESH_FINITE_ELEMENTS) return "`hourglass` is of finite elements";
  *mend = "leave it out, or gauss = 1";
  if (e->gauss != 1) return "elements with 2 x 2 points have no hourglass modes";
  *mend = "0.05 is usual, and 0 leaves these motions alone";
  if (e->hourglass > 1) return "`hourglass` is a part of the element's stiffness, 0 to 1";
  return NULL;
}

void deck_check_elements(deck_reader *r, const namelist_group *from, const deck_item *item,
                         const deck_elements *e) {
  const char *mend, *why = NULL;
  if (e->dilatation == DILATATION_MEAN) why = wrong_dilatation(e, &mend);
  if (why) {
    diag_report(r->d, DIAG_CONFLICT, deck_where(item, "dilatation"), "%s", why);
    diag_hint(r->d, "%s", mend);
  }
  why = namelist_find(from, "hourglass") && e->hourglass > 0 ? wrong_hourglass(e, &mend) : NULL;
  if (!why) return;
  diag_report(r->d, DIAG_CONFLICT, deck_where(item, "hourglass"), "%s", why);
  diag_hint(r->d, "%s", mend);
}

static void check_elements_of(deck_reader *r, const namelist_group *from, const deck_mesh *item) {
  deck_check_elements(r, from, &item->item,
                      &(deck_elements){item->method, item->gauss, item->dilatation, item->hourglass,
                                       item->setting});
}

/* --- of a file -------------------------------------------------------------------------------- */

/* A mesh of a file has what stands there, and finite elements. */
static void refuse_keys_of_grids(deck_reader *r, const namelist_group *from,
                                 const deck_mesh *item) {
  static const char *const others[] = {"corner", "size",  "corners", "nodes",          "support",
                                       "parts",  "basis", "ramp",    "enriched_radius"};
  for (size_t k = 0; k < sizeof others / sizeof *others; k++)
    deck_refuse_both(r, from, "file", others[k]);
  if (!namelist_find(from, "method") || item->method == MESH_FINITE_ELEMENTS) return;
  diag_report(r->d, DIAG_CONFLICT, deck_where(&item->item, "method"),
              "element-free nodes stand on a rectangle: the mesh of a `file` is one of finite "
              "elements");
  diag_hint(r->d, "leave `method` away");
}

/* What quadrilaterals alone have, of a file without any. */
static void refuse_keys_of_quadrilaterals(deck_reader *r, const deck_mesh *item) {
  const gmsh_mesh *m = item->gmsh;
  int count = 0;
  for (int c = 0; c < m->cell_count; c++)
    count += m->nodes[c] == 4;
  if (count > 0) return;
  if (item->dilatation == DILATATION_MEAN) {
    diag_report(r->d, DIAG_CONFLICT, deck_where(&item->item, "dilatation"),
                "quadrilaterals alone take the mean dilatation, and `%s` has triangles only",
                item->file);
    diag_hint(r->d, "leave it out, with triangles of 6 nodes (gmsh -order 2), which do not lock; "
                    "or draw quadrilaterals: `Recombine Surface{:};`");
  }
  if (item->gauss == 1) {
    diag_report(r->d, DIAG_CONFLICT, deck_where(&item->item, "gauss"),
                "quadrilaterals alone may have one point in place of 2 x 2, and `%s` has triangles "
                "only",
                item->file);
    diag_hint(r->d, "leave it out: triangles of 3 nodes have one point, those of 6 nodes three");
  }
  if (!(item->hourglass > 0)) return;
  diag_report(r->d, DIAG_CONFLICT, deck_where(&item->item, "hourglass"),
              "triangles have no hourglass modes, and `%s` has nothing else", item->file);
  diag_hint(r->d, "leave it out");
}

/* m, of one of the choices. */
static double unit_of(const char *name) {
  unit u = {.factor = 1};
  const char *bad;
  size_t bad_length;
  (void)unit_parse(name, strlen(name), &u, &bad, &bad_length);
  return u.factor;
}

/* The smallest rectangle around nodes; all of them where `list` is NULL. */
static void find_box(const gmsh_mesh *m, const int32_t *list, int count, double corner[3],
                     double size[3]) {
  double upper[2] = {-INFINITY, -INFINITY};
  corner[0] = corner[1] = INFINITY;
  for (int k = 0; k < count; k++)
    for (int a = 0; a < 2; a++) {
      const double x = m->at[list ? list[k] : k][a];
      corner[a] = pl_min(corner[a], x);
      upper[a] = pl_max(upper[a], x);
    }
  for (int a = 0; a < 2; a++)
    size[a] = upper[a] - corner[a];
}

/* A group that holds nodes is a region. */
static void add_region(deck_reader *r, const deck_mesh *of, const gmsh_group *g) {
  deck *k = r->k;
  const int first = deck_find_region(k, g->name);
  deck_region region = {
      .item = {.where = g->where},
      .name = g->name,
      .lattice = of->name,
      .shape = {.kind = SHAPE_RECTANGLE, .members = g->nodes, .member_count = g->node_count},
      .group = g};
  deck_check_name(r, "region", g->name, &region.item, first < 0 ? NULL : &k->regions[first].item);
  find_box(of->gmsh, g->nodes, g->node_count, region.shape.corner, region.shape.size);
  deck_region *all = arena_alloc(r->memory, ((size_t)k->region_count + 1) * sizeof *all);
  if (k->region_count > 0) memcpy(all, k->regions, (size_t)k->region_count * sizeof *all);
  all[k->region_count] = region;
  k->regions = all;
  k->region_count++;
}

/* Nodes in rows about as long as there are rows, of whole vectors. */
static void lay_out(deck_mesh *item) {
  const int count = item->gmsh->node_count;
  const double lanes = PL_LANES;
  item->nodes[0] = lanes * ceil(sqrt(count) / lanes);
  item->nodes[1] = pl_max(2, ceil(count / item->nodes[0]));
}

static void take_file(deck_reader *r, const namelist_group *from, deck_mesh *item) {
  const int errors = r->d->errors;
  refuse_keys_of_grids(r, from, item);
  item->method = MESH_FINITE_ELEMENTS;
  item->support = 1;
  check_gauss(r, from, item);
  check_elements_of(r, from, item);
  if (r->d->errors > errors) return;
  item->gmsh = gmsh_mesh_read(r->memory, deck_file_path(r->k->name, item->file),
                              unit_of(item->unit), deck_where(&item->item, "file"), r->d);
  if (!item->gmsh) return;
  refuse_keys_of_quadrilaterals(r, item);
  find_box(item->gmsh, NULL, item->gmsh->node_count, item->corner, item->size);
  item->spacing = item->gmsh->least;
  item->origin[0] = item->corner[0];
  item->origin[1] = item->corner[1];
  lay_out(item);
  for (int k = 0; k < item->gmsh->group_count; k++)
    if (item->gmsh->groups[k].node_count > 0) add_region(r, item, &item->gmsh->groups[k]);
}

/* What a rectangle needs. */
static void check_required(deck_reader *r, const namelist_group *from) {
  static const char *const needed[] = {"nodes", "method"};
  for (int k = 0; k < 2; k++) {
    if (namelist_find(from, needed[k])) continue;
    diag_report(r->d, DIAG_MISSING_KEY, from->where, "`&mesh` has no `%s`", needed[k]);
    diag_hint(r->d,
              k ? "method = 'finite_elements', or 'element_free'"
                : "nodes: how many there are along x and along y, those at the ends included; "
                  "or a `file`");
  }
}

/* Without tips nothing is enriched: a radius alone would do nothing. */
static void check_basis(deck_reader *r, const namelist_group *from, deck_mesh *item) {
  const namelist_key *basis = namelist_find(from, "basis");
  const bool enriched = basis && basis->values[0].text && basis->values[0].text[0] == 'e';
  if (!enriched) item->rich = 0;
  if (!enriched && namelist_find(from, "enriched_radius")) {
    diag_report(r->d, DIAG_CONFLICT, deck_where(&item->item, "enriched_radius"),
                "a linear basis has no `enriched_radius`");
    diag_hint(r->d, "basis = 'enriched'");
  } else if (enriched && item->method == MESH_FINITE_ELEMENTS) {
    diag_report(r->d, DIAG_CONFLICT, deck_where(&item->item, "basis"),
                "bilinear elements have no basis to enrich");
    diag_hint(r->d, "method = 'element_free', with a `&zone` of finite elements");
  }
}

static void check_mesh(deck_reader *r, const namelist_group *from, void *into) {
  deck_mesh *item = into;
  const namelist_key *ramp = namelist_find(from, "ramp");
  if (!item->setting) item->setting = "plane_stress";
  item->stiffness_thickness = item->mass_thickness = item->thickness;
  item->smooth = ramp && ramp->values[0].text && ramp->values[0].text[0] == 's';
  deck_check_lattice_name(r, item);
  deck_check_places(r, from, &deck_group_mesh, 2);
  if (item->file) {
    item->rich = 0;
    take_file(r, from, item);
    return;
  }
  if (namelist_find(from, "unit")) {
    diag_report(r->d, DIAG_CONFLICT, deck_where(&item->item, "unit"),
                "`unit` is that of places in a `file`, which is not given");
    diag_hint(r->d, "other values of a deck have their own units: size = '100 mm', '20 mm'");
  }
  check_required(r, from);
  if (!namelist_find(from, "nodes")) return;
  check_gauss(r, from, item);
  check_basis(r, from, item);
  check_elements_of(r, from, item);
  if (!has_extent(r, from, item) || !has_nodes(r, item) || !has_support(r, item)) return;
  item->spacing = spacing_of(item);
  item->origin[0] = item->corner[0];
  item->origin[1] = item->corner[1];
}

DECK_MORE(mesh, lattice, .identity = "name", .begin = begin_mesh, .check = check_mesh,
          .doc = "Nodes and cells of a rectangle, or of a file, whose law is one of a continuum. "
                 "It needs no "
                 "`&body`; everywhere else it is named as a lattice is, and its nodes are the "
                 "particles.");

/* --- cracks ----------------------------------------------------------------------------------- */

static const deck_key_info crack_keys[] = {
    {.name = "name", .type = DECK_NAME, .required = true, DECK_AT(crack, name), .doc = "its name"},
    {.name = "mesh",
     .type = DECK_NAME,
     .required = true,
     DECK_AT(crack, mesh),
     .doc = "name of the mesh that it is in"},
    {.name = "points",
     .type = DECK_REALS,
     .unit = "m",
     .required = true,
     DECK_AT(crack, points),
     DECK_COUNT_AT(crack, point_count),
     .doc = "x1, y1, x2, y2, ... of its legs, from end to end; an end inside the mesh is a tip"},
    {.name = "grows",
     .type = DECK_LOGICAL,
     .fallback = ".false.",
     DECK_AT(crack, grows),
     .doc = "its tips run on as the law says"},
    {.name = "symmetry",
     .type = DECK_LOGICAL,
     .fallback = ".false.",
     DECK_AT(crack, symmetry),
     .doc = "it lies on a straight edge of the mesh, which is half of a body and its mirror image; "
            "beyond the tip a support holds the edge. Finite elements, too"},
    {.name = "model",
     .type = DECK_NAME,
     DECK_AT(crack, model),
     .fallback = "= none; required of a crack that grows",
     .doc = "name of a law of cracks in `models/`, or a path that ends in `.plm`"},
};

static bool has_points(deck_reader *r, deck_crack *item) {
  const span where = deck_where(&item->item, "points");
  if (item->point_count % 2 || item->point_count < 4) {
    diag_report(r->d, DIAG_BAD_VALUE, where,
                item->point_count % 2 ? "a point has two coordinates, but `points` has %d values"
                                      : "a crack has at least two points: here are %d values",
                item->point_count);
    return false;
  }
  item->point_count /= 2;
  for (int k = 1; k < item->point_count; k++)
    if (item->points[2 * k] == item->points[2 * k - 2] &&
        item->points[2 * k + 1] == item->points[2 * k - 1]) {
      diag_report(r->d, DIAG_BAD_VALUE, where, "points %d and %d are the same", k, k + 1);
      return false;
    }
  return true;
}

/* In results it is a folder of histories, and one beside the cracks of monitors. */
static void check_crack_name(deck_reader *r, const deck_crack *item) {
  const int first = deck_find_crack(r->k, item->name),
            monitor = deck_find_monitor(r->k, item->name);
  deck_check_folder_name(r, "crack", &item->item, item->name);
  deck_check_name(r, "crack", item->name, &item->item,
                  first < 0 ? NULL : &r->k->cracks[first].item);
  deck_check_not_both(r, "crack", &item->item, "monitor", item->name,
                      monitor < 0 ? NULL : &r->k->monitors[monitor].item);
}

static void check_crack(deck_reader *r, const namelist_group *from, void *into) {
  deck_crack *item = into;
  check_crack_name(r, item);
  deck_mesh_known(r, &item->item, item->mesh);
  deck_refuse_of_file(r, &item->item, item->mesh, "cracks");
  if (item->point_count > 0) has_points(r, item);
  item->material = (deck_material){
      .item = item->item, .lattice = item->mesh, .mesh = item->mesh, .model = item->model};
  deck_assignments_read(r->memory, from, &deck_group_crack, &item->material, r->d);
  if (item->grows && item->symmetry) {
    diag_report(r->d, DIAG_CONFLICT, deck_where(&item->item, "symmetry"),
                "a crack on a line of symmetry does not grow: supports hold its way");
    diag_hint(r->d, "leave out `grows`, or give the whole body");
  }
  if (item->grows && !item->model) {
    diag_report(r->d, DIAG_MISSING_KEY, from->where, "a crack that grows needs a `model`");
    diag_hint(r->d, "such as model = 'lefm'  K_Ic = '0.8 MPa*sqrt(m)'");
  } else if (!item->model && item->material.assignment_count > 0) {
    diag_report(r->d, DIAG_UNKNOWN_KEY, item->material.assignments[0].name_where,
                "`&crack` has no key `%s`", item->material.assignments[0].name);
    diag_hint(r->d, "parameters are those of a `model`");
  }
}

DECK_LIST(crack, .identity = "name", .open = true, .check = check_crack,
          .doc =
              "A crack in the element-free part of a mesh: nodes do not act across it; or on "
              "its edge, by `symmetry`. Every other key sets a parameter or an option of its law.");

static const deck_key_info tips_keys[] = {
    {.name = "integral",
     .type = DECK_CHOICE,
     .choices = "plateau|pyramid",
     .fallback = "'plateau'",
     DECK_AT(tips, integral),
     .doc =
         "weight of the interaction integral over the box: 1 up to half of the way from the tip, "
         "or falling from the tip on"},
    {.name = "half_size",
     .type = DECK_REAL,
     .unit = "1",
     .bound = BOUND_POSITIVE,
     .fallback = "4",
     DECK_AT(tips, half_size),
     .doc = "of the box around a tip, in spacings along x; less than 4 is coarse"},
    {.name = "points",
     .type = DECK_COUNT,
     .fallback = "0",
     .most = 64,
     DECK_AT(tips, points),
     .doc = "own points of the integral: so many cells of 2 x 2 along either axis of a quadrant of "
            "the box; 0: the mesh's points inside"},
    {.name = "from",
     .type = DECK_REAL,
     .unit = "s",
     .bound = BOUND_NOT_NEGATIVE,
     .fallback = "0",
     DECK_AT(tips, from),
     .doc = "no look at the tips before that time: until then they stay, and no K is known"},
    {.name = "check_every",
     .type = DECK_REAL,
     .unit = "s",
     .bound = BOUND_POSITIVE,
     DECK_AT(tips, check_every),
     .fallback = "= as `check_steps` says",
     .doc = "time between two looks at the tips: stress intensities, whether and where to they "
            "grow"},
    {.name = "check_steps",
     .type = DECK_COUNT,
     .fallback = "100",
     .most = 1000000000,
     DECK_AT(tips, check_steps),
     .doc = "the same in steps"},
    {.name = "updates",
     .type = DECK_COUNT,
     .fallback = "5",
     .most = 1000000,
     DECK_AT(tips, updates),
     .doc = "growing tips advance so often from one look to the next"},
    {.name = "segment",
     .type = DECK_REAL,
     .unit = "1",
     .bound = BOUND_NOT_NEGATIVE,
     .fallback = "= half of `half_size`",
     DECK_AT(tips, segment),
     .doc = "in spacings along x: a crack turns once its last leg is at least as long"},
    {.name = "corner",
     .type = DECK_PLACE,
     .unit = "m",
     DECK_AT(tips, corner),
     .fallback = "= the mesh's",
     .doc = "of the rectangle in which cracks grow, the corner of least coordinates; with `size`"},
    {.name = "size",
     .type = DECK_PLACE,
     .unit = "m",
     .bound = BOUND_POSITIVE,
     DECK_AT(tips, size),
     .fallback = "= the mesh's",
     .doc = "its extent; tips that leave it are finished"},
};

static void check_rectangle(deck_reader *r, const namelist_group *from) {
  const namelist_key *corner = namelist_find(from, "corner"), *size = namelist_find(from, "size");
  if (!corner == !size) return;
  diag_report(
      r->d, DIAG_MISSING_KEY, (corner ? corner : size)->name_where,
      "the rectangle in which cracks grow has a `corner` and a `size`, but no `%s` is given",
      corner ? "size" : "corner");
}

static void check_tips(deck_reader *r, const namelist_group *from, void *into) {
  deck_tips *item = into;
  deck_refuse_both(r, from, "check_every", "check_steps");
  deck_check_places(r, from, &deck_group_tips, 2);
  check_rectangle(r, from);
  if (!namelist_find(from, "segment")) item->segment = 0.5 * item->half_size;
  const char *const counts[] = {"check_steps", "updates"};
  const int values[] = {item->check_steps, item->updates};
  for (int k = 0; k < 2; k++)
    if (values[k] < 1)
      diag_report(r->d, DIAG_OUT_OF_BOUNDS, deck_where(&item->item, counts[k]),
                  "`%s` is at least 1", counts[k]);
}

DECK_ONE(tips, .check = check_tips,
         .doc = "How stress intensities at the tips of cracks are found, how often, and what of a "
                "path they allow.");

/* --- steps ------------------------------------------------------------------------------------ */

static const deck_key_info newmark_keys[] = {
    {.name = "beta_1",
     .type = DECK_REAL,
     .unit = "1",
     .fallback = "0.5",
     DECK_AT(newmark, beta_1),
     .doc = "0.5, central differences, to 1; above 0.5 fast waves are damped, by "
            "`(beta_1 - 0.5) omega dt/2` of the critical damping"},
    {.name = "motion",
     .type = DECK_CHOICE,
     .choices = "consistent|velocity_only",
     .fallback = "'consistent'",
     DECK_AT(newmark, motion),
     .doc =
         "of driven nodes: they go where their velocity takes them; or only that is set, and "
         "each step moves them by `dt^2 a/2` of the body's forces, too, as some programs do: the "
         "longer the step, the more they give way"},
};

static void check_newmark(deck_reader *r, const namelist_group *from, void *into) {
  const deck_newmark *item = into;
  (void)from;
  if (item->beta_1 >= 0.5 && item->beta_1 <= 1) return;
  diag_report(r->d, DIAG_OUT_OF_BOUNDS, deck_where(&item->item, "beta_1"),
              "`beta_1` is 0.5 to 1, not %g", item->beta_1);
  diag_hint(r->d, "below 0.5 waves would grow");
}

DECK_ONE(newmark, .check = check_newmark,
         .doc = "How meshes step: Newmark's explicit method, with `beta_2` = 0.");
