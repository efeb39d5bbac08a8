#include "runtime/parts/law_fits.h"

#include <string.h>
#include <strings.h>

#include "runtime/analysis/material.h"
#include "runtime/deck/group_monitor.h"
#include "runtime/deck/lattice_kind.h"
#include "runtime/mesh/element_modes.h"

span law_fits_where(const deck *k, int lattice) {
  const deck_lattice *l = &k->lattices[lattice];
  const int m = deck_find_material(k, l->name);
  return m < 0 ? l->item.where : deck_where(&k->materials[m].item, "model");
}

bool law_fits_motion(const pl_law *law, const deck *k, int lattice, diagnostics *d) {
  if (law->density >= 0) return true;
  diag_report(d, DIAG_MISSING_KEY, law_fits_where(k, lattice),
              "the law `%s` has no parameter `rho`, so its particles have no mass", law->name);
  for (int p = 0; p < law->parameter_count; p++)
    if (strcasecmp(law->parameters[p].name, "rho") == 0) {
      diag_hint(d, "in a law upper and lower case differ: write `rho` for `%s`",
                law->parameters[p].name);
      return false;
    }
  diag_hint(d, "add a mass density to the law, e.g. parameter rho = 2300 [kg/m^3] in (0, inf)");
  return false;
}

static const deck_protect *protected_on(const deck *k, const char *lattice) {
  for (int i = 0; i < k->protect_count; i++) {
    const int r = k->protects[i].region ? deck_find_region(k, k->protects[i].region) : -1;
    if (r >= 0 && k->regions[r].lattice && strcmp(k->regions[r].lattice, lattice) == 0)
      return &k->protects[i];
  }
  return NULL;
}

/* Protection keeps damage as it is: a law that softens through a plain state is not held back by
   it. */
void law_fits_protection(const pl_law *law, const deck *k, int lattice, diagnostics *d) {
  for (int f = 0; f < law->field_count; f++)
    if (law->fields[f].kind == PL_FIELD_DAMAGE) return;
  const deck_protect *in_vain = protected_on(k, k->lattices[lattice].name);
  if (in_vain && law->field_count > 0)
    diag_report(
        d, DIAG_DECK_WARNING, in_vain->item.where,
        "the law `%s` has no damage that could be held back; its states go on as they do elsewhere",
        law->name);
}

/* --- elements --------------------------------------------------------------------------------- */

/* Nodes of elements of the law that lock where the volume hardly changes: 4 of quadrilaterals whose
   dilatation is not the mean, 3 of triangles with one point; 0: there are none. */
static int nodes_that_lock(const cells *c, int law) {
  const mesh *m = &c->mesh;
  for (int cell = 0; cell < mesh_cell_count(m); cell++) {
    if (m->cell[cell] != CELL_ELEMENT || cell_laws_at(&c->where, cell) != law) continue;
    const int nodes = m->lists ? m->lists->nodes[cell] : 4;
    if (nodes == 3 || (nodes == 4 && m->element_gauss[cell] == 2 && !element_takes_mean(m, cell)))
      return nodes;
  }
  return 0;
}

void law_fits_elements(const pl_law *law, const cells *c, int number, span where, diagnostics *d) {
  const double most = 20; /* Poisson's ratio 0.475 */
  const plane_stiffness *at_rest = &c->stiffness[number];
  const double shear = at_rest->D[2][2], bulk = at_rest->D[0][0] - 4.0 / 3 * shear;
  const int nodes = bulk > most * shear ? nodes_that_lock(c, number) : 0;
  if (nodes == 0) return;
  diag_report(d, DIAG_DECK_WARNING, where,
              "`%s` hardly changes its volume, its bulk modulus is %.4g times the shear modulus: "
              "%s lock in plane strain, and the body is too stiff",
              law->name, bulk / shear,
              nodes == 3 ? "triangles of 3 nodes" : "quadrilaterals with 2 x 2 points");
  diag_hint(d, nodes == 3 ? "take triangles of 6 nodes (gmsh -order 2), or quadrilaterals with "
                            "dilatation = 'mean'"
                          : "give the mesh, or the zone, dilatation = 'mean'");
}

/* --- the lattice ------------------------------------------------------------------------------ */

/* The kernel of a law of families is made for lattices or for lists. A solver has one, and its deck
   may change. */
static bool topology_serves(const pl_law *law, const deck_lattice *l, const rows *w,
                            diagnostics *d) {
  const bool list = w->list != NULL;
  const int neighbours = 2 * w->directions;
  const bool same = (law->topology == PL_LIST) == list;
  if (law->kind == PL_STATE && same && law->neighbours && law->neighbours != neighbours) {
    diag_report(d, DIAG_NOT_SUPPORTED, deck_where(&l->item, l->horizon > 0 ? "horizon" : "shells"),
                "this solver was built for %d neighbours, not %d", law->neighbours, neighbours);
    diag_hint(d, "build another one with `perilat build`, or use `perilat run`");
    return false;
  }
  if (w->own_size && !(PL_HAS(law, reads_own_size) && law->reads_own_size)) {
    diag_report(d, DIAG_NOT_SUPPORTED, deck_where(&l->item, "spacing"),
                "this solver was built for particles of one size");
    diag_hint(d, "build another one with `perilat build`, or use `perilat run`");
    return false;
  }
  if (law->kind == PL_STATE && same) return true;
  if (law->kind == PL_STATE) {
    if (l->edges == EDGES_EXACT)
      diag_report(d, DIAG_NOT_SUPPORTED, deck_where(&l->item, "edges"),
                  "this solver was built for edges = 'lattice'");
    else
      diag_report(d, DIAG_NOT_SUPPORTED, deck_where(&l->item, "kind"),
                  "this solver was built for particles that stand on %s",
                  list ? "a lattice" : "no lattice, or for edges = 'exact'");
    diag_hint(d, "build another one with `perilat build`, or use `perilat run`");
    return false;
  }
  diag_report(
      d, DIAG_NOT_SUPPORTED, deck_where(&l->item, "kind"),
      "as a law of bonds `%s` runs on a hexagonal lattice, not on particles that stand on none",
      law->name);
  diag_hint(d, "compiled for these it does: use `perilat run`, or build a solver for them");
  return false;
}

/* Laws of continua are for meshes, and these have no others. */
static bool kind_differs(const pl_law *law, span where, const deck *k, int lattice,
                         diagnostics *d) {
  const bool continuum = law->kind == PL_CONTINUUM;
  diag_report(d, DIAG_CONFLICT, where,
              continuum ? "`%s` is a law of a continuum, but `%s` is no mesh"
                        : "`%s` is no law of a continuum, but `%s` is a mesh",
              law->name, k->lattices[lattice].name);
  diag_hint(d, continuum ? "take a law of bonds or families, such as `lps`, or a &mesh"
                         : "take a law that begins with `law continuum`, such as `elastic`");
  return false;
}

/* Stress intensities, and what hides nodes from points, are of linear laws. With other laws beside
   it depends on whose cells the tips are in (tip_laws.h). */
static bool cracks_fit(const pl_law *law, const deck *k, const deck_mesh *m, diagnostics *d) {
  const int whole = deck_find_material(k, m->name);
  if (whole >= 0 && k->materials[whole].beside) return true;
  for (int n = 0; n < k->crack_count; n++) {
    if (!k->cracks[n].mesh || strcmp(k->cracks[n].mesh, m->name) != 0) continue;
    diag_report(d, DIAG_CONFLICT, k->cracks[n].item.where,
                "a crack needs a linear elastic law: `%s` of the mesh `%s` is none", law->name,
                m->name);
    diag_hint(d, "take one such as `elastic`, or leave the &crack out");
    return false;
  }
  return true;
}

/* All that differs in space is what the law declares as fields. */
static bool all_are_given(const pl_law *law) {
  for (int k = 0; k < law->varying_count; k++)
    if (!material_is_given(law, law->varying[k])) return false;
  return true;
}

/* What meshes do not do as yet, and what of the deck would have to be done. */
static bool mesh_can_have(const pl_law *law, const deck_material *of, span where, const deck *k,
                          int lattice, diagnostics *d) {
  const deck_mesh *m = &k->lattices[lattice];
  const deck_item *item = NULL;
  const char *why = NULL;
  bool stamped = false;
  if (!law->linear && !cracks_fit(law, k, m, d)) return false;
  if (!law->linear && !(PL_HAS(law, affine) && law->affine) && k->relaxation.solved) {
    diag_report(d, DIAG_NOT_SUPPORTED, where,
                "the law `%s` is not linear: `&static` solves equations of linear laws alone",
                law->name);
    diag_hint(d, "`&relaxation increments = %d` in its place brings a body of any law to rest",
              k->relaxation.increments);
    return false;
  }
  if (of && of->between[0]) {
    item = &of->item;
    why = "a material between two regions, as it has no bonds;";
  }
  for (int n = 0; n < k->field_count && !item; n++)
    if (k->fields[n].random && k->fields[n].lattice && strcmp(k->fields[n].lattice, m->name) == 0) {
      item = &k->fields[n].item;
      why = "a random field";
    }
  if (!item && !all_are_given(law)) {
    item = of ? &of->item : &k->materials[deck_find_material(k, m->name)].item;
    why = "parameters that differ from place to place";
  }
  const deck_protect *held = protected_on(k, m->name);
  if (!item && held) {
    item = &held->item;
    why = "protected regions";
  }
  for (int n = 0; n < k->contact_count && !item; n++)
    if (deck_lattice_touches(m, &k->contacts[n])) {
      item = &k->contacts[n].item;
      why = "contact";
    }
  for (int n = 0; n < k->stamp_count && !item; n++)
    if (deck_lattice_is_stamped(m, &k->stamps[n])) {
      item = &k->stamps[n].item;
      why = "stamps that touch it";
      stamped = true;
    }
  if (!item) return true;
  diag_report(d, DIAG_NOT_SUPPORTED, item->where, "the mesh `%s` cannot have %s as yet", m->name,
              why);
  if (stamped) diag_hint(d, "name the lattices of particles that the stamp touches in `lattices`");
  return false;
}

bool law_fits_lattice(const pl_law *law, const deck_material *of, const deck *k, int lattice,
                      const rows *w, diagnostics *d) {
  const deck_lattice *l = &k->lattices[lattice];
  const span where = of ? deck_where(&of->item, "model") : law_fits_where(k, lattice);
  const bool same = law->dimensions == w->dimensions;
  if ((law->kind == PL_CONTINUUM) != deck_lattice_is_mesh(l))
    return kind_differs(law, where, k, lattice, d);
  if (same && law->kind == PL_CONTINUUM) return mesh_can_have(law, of, where, k, lattice, d);
  if (same && (law->kind == PL_STATE || w->list)) return topology_serves(law, l, w, d);
  if (same && bravais_is_hexagon(l)) return true;
  if (!same) {
    diag_report(d, DIAG_NOT_SUPPORTED, deck_where(&l->item, "kind"),
                "the law `%s` is of %s, the lattice is in %s", law->name,
                law->dimensions == 2 ? "the plane" : "space",
                law->dimensions == 2 ? "space" : "the plane");
    return false;
  }
  const bool hexagonal = strcmp(l->kind, "hexagonal") == 0;
  const char *key = !hexagonal ? "kind" : l->horizon > 0 ? "horizon" : "shells";
  diag_report(d, DIAG_NOT_SUPPORTED, deck_where(&l->item, key),
              "`%s` is a law of bonds: it runs on a hexagonal lattice of nearest neighbours",
              law->name);
  diag_hint(d, "compiled for this one it runs, too: use `perilat run`, or build a solver for it");
  return false;
}

/* --- several bodies --------------------------------------------------------------------------- */

static bool are_alike(const deck *k, const run_body *bodies, int count, diagnostics *d) {
  for (int b = 1; b < count; b++) {
    if (bodies[b].law->dimensions == bodies[0].law->dimensions) continue;
    diag_report(d, DIAG_NOT_SUPPORTED, deck_where(&k->lattices[b].item, "kind"),
                "`%s` is in %s, `%s` in %s: the bodies of a run are all of the plane or all in "
                "space",
                bodies[b].name, bodies[b].law->dimensions == 2 ? "the plane" : "space",
                bodies[0].name, bodies[0].law->dimensions == 2 ? "the plane" : "space");
    return false;
  }
  return true;
}

/* In the history a folder for the energies of each body stands beside the times, the monitors and
   the energies of all; a body alone has none. */
static bool has_own_name(const deck *k, int lattice, diagnostics *d) {
  const char *name = k->lattices[lattice].name;
  const int monitor = deck_find_monitor(k, name);
  if (monitor >= 0) {
    diag_report(d, DIAG_RESERVED_NAME, deck_where(&k->monitors[monitor].item, "name"),
                "a monitor cannot be named as a %s, `%s`, beside other bodies, contacts or stamps",
                deck_lattice_word(&k->lattices[lattice]), name);
    diag_note(d, deck_where(&k->lattices[lattice].item, "name"), "the %s",
              deck_lattice_word(&k->lattices[lattice]));
    return false;
  }
  if (!deck_is_history_name(k, name)) return true;
  diag_report(d, DIAG_RESERVED_NAME, deck_where(&k->lattices[lattice].item, "name"),
              "a result has another `%s`: a %s beside other bodies, contacts or stamps cannot be "
              "named so",
              name, deck_lattice_word(&k->lattices[lattice]));
  return false;
}

static bool name_is_new(const deck *k, int interaction) {
  const char *name = k->interactions[interaction].name;
  for (int n = 0; n < interaction; n++)
    if (strcmp(k->interactions[n].name, name) == 0) return false;
  return deck_find_lattice(k, name) < 0;
}

/* Laws beside others have folders of their own among the fields. */
static bool laws_have_names(const deck *k, diagnostics *d) {
  for (int n = 0; n < k->interaction_count; n++) {
    const deck_interaction *of = &k->interactions[n];
    const bool first = of->material == deck_material_of(k, of->lattice);
    if (first || (!strchr(of->name, '/') && name_is_new(k, n))) continue;
    diag_report(d, DIAG_RESERVED_NAME, of->material->item.where,
                strchr(of->name, '/')
                    ? "the result names the bonds of this law `%s`: no name of a region that has "
                      "a law of its own may hold `/`"
                    : "the result names the bonds of this law `%s`, as others are named already",
                of->name);
    diag_hint(d, "give the region another name");
    return false;
  }
  return true;
}

/* Particles that a link turns have rotations of their own. */
static bool link_suits(const deck *k, const run_body *bodies, int link, diagnostics *d) {
  const deck_link *of = &k->lattices[link];
  const pl_law *law = bodies[link].law;
  const int ends[] = {of->of_bar, of->of_around};
  for (int n = 0; n < 2; n++) {
    const run_body *end = &bodies[ends[n]];
    if (end->law->dof >= law->dof) continue;
    diag_report(
        d, DIAG_NOT_SUPPORTED, law_fits_where(k, link),
        "the law `%s` of the link `%s` bends bonds, but the particles of `%s` do not rotate",
        law->name, of->name, end->name);
    diag_note(d, law_fits_where(k, end->lattice), "by this law");
    diag_hint(d, "take a law of beams there, or one of springs for the link");
    return false;
  }
  return true;
}

bool bodies_fit(const deck *k, const run_body *bodies, int count, diagnostics *d) {
  bool good = are_alike(k, bodies, count, d) && laws_have_names(k, d);
  const bool apart = count + k->contact_count + k->stamp_count > 1;
  for (int b = 0; b < count && apart; b++)
    good = has_own_name(k, b, d) && good;
  for (int b = 0; b < count && good; b++)
    good = !run_body_is_link(&bodies[b]) || link_suits(k, bodies, b, d);
  return good;
}
