#include "runtime/deck/group_mesh.h"

#include <math.h>

#include "runtime/deck/deck_check.h"
#include "runtime/deck/lattice_kind.h"

/* --- the mesh --------------------------------------------------------------------------------- */

static const deck_key_info mesh_keys[] = {
    {.name = "name", .type = DECK_NAME, .required = true, DECK_AT(mesh, name), .doc = "its name"},
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
     .required = true,
     DECK_AT(mesh, size),
     .doc = "extent of the rectangle along x and y"},
    {.name = "nodes",
     .type = DECK_PAIR,
     .unit = "1",
     .bound = BOUND_POSITIVE,
     .required = true,
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
     .required = true,
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
    {.name = "ramp",
     .type = DECK_WORD,
     .choices = "linear|smooth",
     .fallback = "'linear'",
     DECK_NOT_KEPT,
     .doc = "how methods blend in the cells between zones: by R, or by 3R^2 - 2R^3"},
};

enum { LEAST_NODES = 2, MOST_NODES = 20000 };

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
  return true;
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

static void check_mesh(deck_reader *r, const namelist_group *from, void *into) {
  deck_mesh *item = into;
  const namelist_key *ramp = namelist_find(from, "ramp");
  if (!item->setting) item->setting = "plane_stress";
  item->stiffness_thickness = item->mass_thickness = item->thickness;
  item->smooth = ramp && ramp->values[0].text && ramp->values[0].text[0] == 's';
  deck_check_lattice_name(r, item);
  deck_check_places(r, from, &deck_group_mesh, 2);
  check_gauss(r, from, item);
  if (!has_nodes(r, item) || !has_support(r, item)) return;
  const double dx = item->size[0] / (item->nodes[0] - 1), dy = item->size[1] / (item->nodes[1] - 1);
  item->spacing = dx < dy ? dx : dy;
  item->origin[0] = item->corner[0];
  item->origin[1] = item->corner[1];
}

DECK_MORE(mesh, lattice, .identity = "name", .begin = begin_mesh, .check = check_mesh,
          .doc = "A rectangle of nodes and cells, whose law is one of a continuum. It needs no "
                 "`&body`; everywhere else it is named as a lattice is, and its nodes are the "
                 "particles.");

/* --- steps ------------------------------------------------------------------------------------ */

static const deck_key_info newmark_keys[] = {
    {.name = "beta_1",
     .type = DECK_REAL,
     .unit = "1",
     .fallback = "0.5",
     DECK_AT(newmark, beta_1),
     .doc = "0.5, central differences, to 1; above 0.5 fast waves are damped, by "
            "`(beta_1 - 0.5) omega dt/2` of the critical damping"},
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
