#include "runtime/deck/group_lattice.h"

#include <ctype.h>
#include <math.h>
#include <string.h>
#include <strings.h>

#include "dsl/semantics/formula.h"
#include "runtime/deck/deck_check.h"
#include "runtime/deck/deck_formula.h"
#include "runtime/deck/deck_load.h"
#include "runtime/deck/deck_value.h"
#include "runtime/deck/lattice_kind.h"

/* --- lattices --------------------------------------------------------------------------------- */

static const deck_key_info lattice_keys[] = {
    {.name = "name",
     .type = DECK_NAME,
     .required = true,
     DECK_AT(lattice, name),
     .doc = "its name"},
    {.name = "kind",
     .type = DECK_WORD,
     .choices = LATTICE_KIND_CHOICES,
     .required = true,
     DECK_AT(lattice, kind),
     .doc = "arrangement of the sites: `hexagonal` and `square` in the plane, `cubic` and `fcc` "
            "(edges of the cubes "
            "along x, y, z) in space; `chain`, one row in the plane, for laws of bars and beams; "
            "without a lattice, in the plane or in space as `setting` "
            "says: `blue_noise`, even "
            "but at random, and `particles`, read from a `file`"},
    {.name = "spacing",
     .type = DECK_LATER,
     .unit = "m",
     .fallback = "= from the mean volume with kind `particles`; else required",
     DECK_NOT_KEPT,
     .doc = "distance of nearest neighbours; `blue_noise`, `particles`: in the hexagonal or fcc "
            "lattice with particles as large; `blue_noise`: or a formula of `x`, `y`, `z`"},
    {.name = "horizon",
     .type = DECK_REAL,
     .unit = "1",
     .bound = BOUND_POSITIVE,
     .fallback = "= the nearest neighbours",
     DECK_AT(lattice, horizon),
     .doc = "in spacings: bonds join sites as far apart as this, and 0.1 % more; e.g. 3.015"},
    {.name = "shells",
     .type = DECK_COUNT,
     .fallback = "= 1",
     .most = 64,
     DECK_AT(lattice, shells),
     .doc = "instead of the horizon: 1 for the nearest neighbours, 2 for the second nearest, too, "
            "and so on"},
    {.name = "neighbours",
     .type = DECK_COUNT,
     .fallback = "= 12, in space 18, without a horizon",
     .most = 128,
     DECK_AT(lattice, neighbours),
     .doc = "`blue_noise`, `particles`, instead of the horizon: a bond joins two particles when "
            "either is among so many "
            "nearest ones of the other"},
    {.name = "seed",
     .type = DECK_COUNT,
     .fallback = "1",
     .most = 2147483647,
     DECK_AT(lattice, seed),
     .doc = "`blue_noise`: another seed gives another set of particles"},
    {.name = "file",
     .type = DECK_NAME,
     .fallback = "= none; required with kind `particles`",
     DECK_AT(lattice, file),
     .doc = "`particles`: a table (`.csv`) or a result (`.h5`), beside the deck"},
    {.name = "volume_correction",
     .type = DECK_CHOICE,
     .choices = "none|linear",
     .fallback = "'none'",
     DECK_AT(lattice, volume_correction),
     .doc = "part of a neighbour's volume that counts, for laws that use it; `linear`: (horizon + "
            "spacing/2 - "
            "distance)/spacing, from 0 to 1"},
    {.name = "edges",
     .type = DECK_CHOICE,
     .choices = "lattice|exact",
     .fallback = "'lattice'",
     DECK_AT(lattice, edges),
     .doc = "of bodies and notches. `lattice`: particles there lack neighbours and are otherwise "
            "as all others; `exact`: they have the volume of their part of the body, further "
            "neighbours, and exactly the stress of a uniform strain, for laws such as "
            "`splm_elastic`"},
    {.name = "rotation",
     .type = DECK_ANGLE,
     .fallback = "0",
     DECK_AT(lattice, rotation),
     .doc = "angle from x to the rows of sites; a plain number is in degrees"},
    {.name = "axis",
     .type = DECK_DIRECTION,
     .unit = "1",
     .fallback = "= 0, 0, 1",
     DECK_AT(lattice, axis),
     .doc = "in space: direction about which the lattice is rotated"},
    {.name = "origin",
     .type = DECK_PLACE,
     .unit = "m",
     .fallback = "= 0, 0",
     DECK_AT(lattice, origin),
     .doc = "a point that is a site"},
    {.name = "thickness",
     .type = DECK_REAL,
     .unit = "m",
     .bound = BOUND_POSITIVE,
     .fallback = "= none; required in the plane",
     DECK_AT(lattice, thickness),
     .doc = "out of the plane; the thicknesses are not for chains and lattices in space"},
    {.name = "area",
     .type = DECK_REAL,
     .unit = "m^2",
     .bound = BOUND_POSITIVE,
     .fallback = "= none; required with kind `chain`",
     DECK_AT(lattice, area),
     .doc = "`chain`: cross-section of the bar that the particles stand for, `area` of the law"},
    {.name = "stiffness_thickness",
     .type = DECK_REAL,
     .unit = "m",
     .bound = BOUND_POSITIVE,
     .fallback = "= thickness",
     DECK_AT(lattice, stiffness_thickness),
     .doc = "thickness that the law sees as `t`"},
    {.name = "mass_thickness",
     .type = DECK_REAL,
     .unit = "m",
     .bound = BOUND_POSITIVE,
     .fallback = "= thickness",
     DECK_AT(lattice, mass_thickness),
     .doc = "thickness for volume and mass"},
    {.name = "setting",
     .type = DECK_WORD,
     .choices = "plane_stress|plane_strain|space",
     .fallback = "= 'plane_stress'",
     DECK_AT(lattice, setting),
     .doc = "what the thickness direction does; `space`: `blue_noise` and `particles` in space"},
};

enum {
  PLANE = 2, /* by dimensions, and particles that stand on no lattice in space */
  SPACE,
  IRREGULAR_SPACE,
  CHAIN,
  IN_PLANE = 1 << PLANE,
  IN_SPACE = 1 << SPACE,
  IN_IRREGULAR_SPACE = 1 << IRREGULAR_SPACE,
  IN_CHAIN = 1 << CHAIN
};
static const char *const dimension_words[] = {[PLANE] = "a lattice in the plane",
                                              [SPACE] = "a lattice in space",
                                              [IRREGULAR_SPACE] = "a lattice of particles in space",
                                              [CHAIN] = "a chain"};
static const deck_key_use dimension_uses[] = {{"axis", IN_SPACE, false},
                                              {"thickness", IN_PLANE, true},
                                              {"stiffness_thickness", IN_PLANE, false},
                                              {"mass_thickness", IN_PLANE, false},
                                              {"area", IN_CHAIN, true},
                                              {"edges", IN_PLANE | IN_SPACE, false},
                                              {"setting", IN_PLANE | IN_IRREGULAR_SPACE, false}};
enum { DIMENSION_USES = sizeof dimension_uses / sizeof *dimension_uses };

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
              {"edges", "have families and volumes of their own everywhere"},
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

/* Only particles that are thrown can be as large as the place wants them. */
static bool read_graded(deck_reader *r, const namelist_value *v, deck_lattice *item) {
  static const double anywhere[FORMULA_VARIABLES];
  const formula *f = deck_formula_read(r->memory, v, "spacing", &deck_formula_of_place, "m", r->d);
  if (!f) return false;
  for (int k = 0; k < FORMULA_VARIABLES; k++)
    if (formula_reads(f, k)) item->graded = f;
  item->spacing = formula_value(f, anywhere);
  if (!item->graded && !(item->spacing > 0 && isfinite(item->spacing))) {
    diag_report(r->d, DIAG_OUT_OF_BOUNDS, v->where, "`spacing` must be greater than 0");
    return false;
  }
  if (!item->graded || arrangement_of(item) == BLUE_NOISE) return true;
  diag_report(r->d, DIAG_CONFLICT, v->where, "the spacing of %s is the same everywhere",
              arrangement_words[arrangement_of(item)]);
  diag_hint(r->d, "only with kind = 'blue_noise' may `spacing` be a formula of the place");
  return false;
}

static bool read_spacing(deck_reader *r, const namelist_group *from, deck_lattice *item) {
  const namelist_key *key = namelist_find(from, "spacing");
  if (!key) return true;
  if (!deck_values_counted(key, 1, r->d)) return false;
  const namelist_value *v = &key->values[0];
  if (deck_is_place_file(v)) {
    diag_report(r->d, DIAG_BAD_VALUE, v->where, "`spacing` is a number or a formula, not a file");
    return false;
  }
  if (deck_is_formula(v)) return read_graded(r, v, item);
  return deck_real_read(v, "spacing", "m", BOUND_POSITIVE, &item->spacing, r->d);
}

static void check_neighbours(deck_reader *r, const namelist_group *from, deck_lattice *item,
                             int dimensions) {
  deck_refuse_both(r, from, "horizon", "neighbours");
  if (namelist_find(from, "neighbours") && item->neighbours == 0)
    diag_report(r->d, DIAG_OUT_OF_BOUNDS, deck_where(&item->item, "neighbours"),
                "a particle has at least one neighbour");
  if (!namelist_find(from, "neighbours") && !namelist_find(from, "horizon"))
    item->neighbours = lattice_usual_neighbours(dimensions);
}

/* A &lattice of that kind may be. */
static bool is_in_space(int kind) {
  return lattice_kinds[kind].dimensions != 2 && kind != LATTICE_KIND_bar &&
         kind != LATTICE_KIND_link;
}

/* "lattices in space are 'cubic', 'fcc' and 'particles'" */
static void hint_kinds_in_space(deck_reader *r) {
  const char *list = "";
  int left = 0;
  for (int k = 0; k < LATTICE_KIND_COUNT; k++)
    left += is_in_space(k);
  for (int k = 0; k < LATTICE_KIND_COUNT; k++)
    if (is_in_space(k))
      list = arena_printf(r->memory, "%s'%s'%s", list, lattice_kinds[k].name,
                          --left > 1 ? ", "
                          : left     ? " and "
                                     : "");
  diag_hint(r->d, "lattices in space are %s", list);
}

static bool setting_suits(deck_reader *r, const deck_lattice *item, int dimensions) {
  if (dimensions != 2 || !item->setting || strcmp(item->setting, "space") != 0) return true;
  diag_report(r->d, DIAG_CONFLICT, deck_where(&item->item, "setting"),
              "a %s lattice lies in the plane", item->kind);
  hint_kinds_in_space(r);
  return false;
}

/* A neighbour then has the volume that its cell has. */
static void check_edges(deck_reader *r, const deck_lattice *item) {
  if (item->edges != EDGES_EXACT || item->volume_correction == VOLUME_WHOLE) return;
  diag_report(r->d, DIAG_CONFLICT, deck_where(&item->item, "volume_correction"),
              "with `edges = 'exact'` a particle has the volume of its cell, without a correction");
}

/* Which keys a lattice has depends on its dimensions and on whether there are sites at all. */
static void check_kind(deck_reader *r, const namelist_group *from, deck_lattice *item) {
  const int dimensions = deck_lattice_dimensions(item), arrangement = arrangement_of(item);
  const int kind = deck_lattice_is_chain(item)                 ? CHAIN
                   : arrangement != REGULAR && dimensions == 3 ? IRREGULAR_SPACE
                                                               : dimensions;
  if (arrangement != REGULAR && !refuse_keys_of_sites(r, from)) return;
  if (!has_spacing(r, from, arrangement) || !read_spacing(r, from, item) ||
      !setting_suits(r, item, dimensions) ||
      !deck_keys_fit(from, arrangement_uses, 3, arrangement, arrangement_words[arrangement],
                     r->d) ||
      !deck_keys_fit(from, dimension_uses, DIMENSION_USES, kind, dimension_words[kind], r->d))
    return;
  deck_check_places(r, from, &deck_group_lattice, dimensions);
  if (!item->setting) item->setting = dimensions == 2 ? "plane_stress" : "space";
  if (arrangement != REGULAR) check_neighbours(r, from, item, dimensions);
  check_edges(r, item);
}

static void check_lattice(deck_reader *r, const namelist_group *from, void *into) {
  deck_lattice *item = into;
  check_kind(r, from, item);
  deck_refuse_both(r, from, "horizon", "shells");
  if (namelist_find(from, "shells") && item->shells == 0)
    diag_report(r->d, DIAG_OUT_OF_BOUNDS, deck_where(&item->item, "shells"),
                "a particle has at least one shell of neighbours");
  if (item->stiffness_thickness == 0) item->stiffness_thickness = item->thickness;
  if (item->mass_thickness == 0) item->mass_thickness = item->thickness;
  deck_check_lattice_name(r, item);
}

DECK_LIST(lattice, .identity = "name", .check = check_lattice,
          .doc = "A lattice of particles that bodies are cut from. At least one.");

/* --- materials -------------------------------------------------------------------------------- */

static const deck_key_info material_keys[] = {
    {.name = "lattice",
     .type = DECK_NAME,
     DECK_AT(material, lattice),
     .fallback = "= none; required but for a bar or a link",
     .doc = "name of the lattice"},
    {.name = "bar", .type = DECK_NAME, DECK_AT(material, bar), .doc = "instead: name of the bar"},
    {.name = "link",
     .type = DECK_NAME,
     DECK_AT(material, link),
     .doc = "instead: name of the link"},
    {.name = "mesh",
     .type = DECK_NAME,
     DECK_AT(material, mesh),
     .doc = "instead: name of the mesh"},
    {.name = "model",
     .type = DECK_NAME,
     .required = true,
     DECK_AT(material, model),
     .doc = "name of a law in `models/`, or a path that ends in `.plm`"},
    {.name = "region",
     .type = DECK_NAME,
     .fallback = "= the whole lattice",
     DECK_AT(material, region),
     .doc =
         "other values of parameters, or another law, in a part of the lattice or the mesh, which "
         "has a material without `region`, too"},
    {.name = "between",
     .type = DECK_NAMES,
     DECK_AT(material, between),
     .doc = "two regions: the material of the bonds that join one with the other, such as those "
            "across a weak plane; for laws of bonds"},
};

static const deck_placed *placed_by(arena *memory, deck_placed by) {
  deck_placed *p = arena_alloc(memory, sizeof *p);
  *p = by;
  return p;
}

/* The law knows the unit. A table of a field is a grid, but for places of a result. */
static bool read_place_file(arena *memory, uint16_t file, const char *lattice,
                            const namelist_value *v, deck_assignment *a, diagnostics *d) {
  deck_placed p = {.component = -1, .lattice = lattice};
  if (!deck_place_file_read(memory, file, v, &p, d)) return false;
  const size_t length = strlen(p.path);
  p.grid = a->of_field && (length < 3 || strcmp(p.path + length - 3, ".h5") != 0);
  a->placed = placed_by(memory, p);
  return true;
}

/* One that reads no place is a number. */
static bool read_formula(arena *memory, const namelist_value *v, const char *key,
                         const formula_scope *scope, deck_assignment *a, diagnostics *d) {
  static const double anywhere[FORMULA_VARIABLES];
  const formula *f = deck_formula_read(memory, v, key, scope, NULL, d);
  if (!f) {
    const diagnostic *said = &d->items[d->count - 1];
    if (said->code == DIAG_UNKNOWN_NAME && strstr(said->message, "`t`"))
      diag_hint(d,
                "what changes in time is a field: declare `field %s ...` in the law, and give it "
                "by `&field name = '%s' value = ... /`",
                key, key);
    return false;
  }
  a->has_unit = !formula_is_zero(f);
  a->dim = formula_dimension(f);
  a->value = formula_value(f, anywhere);
  for (int k = 0; k < FORMULA_VARIABLES && !a->placed; k++)
    if (formula_reads(f, k)) a->placed = placed_by(memory, (deck_placed){.formula = f});
  if (a->placed || isfinite(a->value)) return true;
  diag_report(d, DIAG_BAD_NUMBER, a->value_where, "this is not a finite number");
  return false;
}

static bool read_assignment(arena *memory, const namelist_group *g, const namelist_value *v,
                            const char *lattice, deck_assignment *a, diagnostics *d) {
  const char *text = v->kind == NAMELIST_TEXT ? v->text + strspn(v->text, " \t") : "0";
  if (deck_is_place_file(v)) return read_place_file(memory, g->where.file, lattice, v, a, d);
  if (deck_is_formula(v)) return read_formula(memory, v, a->name, &deck_formula_of_place, a, d);
  if (isalpha((unsigned char)*text) || *text == '_') {
    a->word = text;
    return true;
  }
  deck_quantity q;
  if (!deck_quantity_read(v, a->name, &q, d)) return false;
  a->value = q.value;
  a->has_unit = q.has_unit;
  a->dim = q.dim;
  return true;
}

/* `fibre = 1, 0, 0` is fibre_x, fibre_y and fibre_z; the third is 0 where it is left out. */
static int read_list(arena *memory, const namelist_group *g, const namelist_key *key,
                     const char *lattice, deck_assignment *into, diagnostics *d) {
  static const char axes[] = "xyz";
  int count = 0;
  for (int k = 0; axes[k]; k++) {
    deck_assignment *a = &into[count];
    const bool given = k < key->value_count;
    *a = (deck_assignment){.name = arena_printf(memory, "%s_%c", key->name, axes[k]),
                           .vector = key->name,
                           .listed = key->value_count,
                           .name_where = key->name_where,
                           .value_where = given ? key->values[k].where : key->value_where};
    count += !given || read_assignment(memory, g, &key->values[k], lattice, a, d);
  }
  return count;
}

/* How many assignments a key is. */
static int read_assignments(arena *memory, const namelist_group *g, const namelist_key *key,
                            const char *lattice, deck_assignment *into, diagnostics *d) {
  if (key->value_count == 2 || key->value_count == 3)
    return read_list(memory, g, key, lattice, into, d);
  if (key->value_count > 3) {
    diag_report(d, DIAG_BAD_VALUE, key->value_where,
                "`%s` takes 1 value, of a vector 2 or 3, but %d are given", key->name,
                key->value_count);
    return 0;
  }
  if (!deck_values_counted(key, 1, d)) return 0;
  *into = (deck_assignment){
      .name = key->name, .name_where = key->name_where, .value_where = key->value_where};
  return read_assignment(memory, g, &key->values[0], lattice, into, d);
}

bool deck_assignments_read(arena *memory, const namelist_group *g, const deck_group_info *info,
                           deck_material *m, diagnostics *d) {
  const int errors = d->errors;
  enum { MOST = 3 }; /* assignments of a key */
  m->assignments = arena_alloc(memory, MOST * (size_t)g->key_count * sizeof *m->assignments);
  for (int i = 0; i < g->key_count; i++) {
    if (deck_key_find(info, g->keys[i].name) >= 0) continue;
    m->assignment_count += read_assignments(memory, g, &g->keys[i], m->lattice,
                                            &m->assignments[m->assignment_count], d);
  }
  return d->errors == errors;
}

/* The name of what the material is for. */
static bool take_lattice(deck_reader *r, const namelist_group *from, deck_material *item) {
  const char *of = item->bar ? item->bar : item->link ? item->link : item->mesh;
  const int named = !!item->lattice + !!item->bar + !!item->link + !!item->mesh;
  deck_refuse_both(r, from, "lattice", "bar");
  deck_refuse_both(r, from, "lattice", "link");
  deck_refuse_both(r, from, "bar", "link");
  deck_refuse_both(r, from, "lattice", "mesh");
  deck_refuse_both(r, from, "bar", "mesh");
  deck_refuse_both(r, from, "link", "mesh");
  if (named > 1) return false;
  if (item->lattice) return deck_lattice_known(r, &item->item, item->lattice);
  if (!of) {
    diag_report(r->d, DIAG_MISSING_KEY, from->where, "`&material` has no `lattice`");
    diag_hint(r->d,
              "lattice: name of the lattice; of a bar's material `bar`, of a link's `link`, of a "
              "mesh's `mesh`");
    return false;
  }
  item->lattice = of;
  return (item->bar    ? deck_bar_known
          : item->link ? deck_link_known
                       : deck_mesh_known)(r, &item->item, of);
}

static void check_material(deck_reader *r, const namelist_group *from, void *into) {
  deck_material *item = into;
  const bool known = take_lattice(r, from, item);
  deck_assignments_read(r->memory, from, &deck_group_material, item, r->d);
  if (!known) return;
  const int first = deck_find_material(r->k, item->lattice);
  deck_refuse_both(r, from, "region", "between");
  if (first < 0 || item->region || item->between[0]) return;
  const char *word = item->bar ? "bar" : item->link ? "link" : item->mesh ? "mesh" : "lattice";
  diag_report(r->d, DIAG_CONFLICT, deck_where(&item->item, word),
              "the %s `%s` has a material already", word, deck_shown(r->memory, item->lattice));
  diag_note(r->d, r->k->materials[first].item.where, "it is given here");
  diag_hint(r->d, "one for a part of the %s has `region` or `between`", word);
}

DECK_LIST(
    material, .identity = "lattice", .parts = {"bar", "link", "mesh", "region", "between"},
    .open = true, .check = check_material,
    .doc =
        "The law of a lattice's, a bar's or a link's bonds or of a mesh, or its parameters in a "
        "region. Every "
        "other key "
        "sets a "
        "parameter or an option of the law, e.g. `E = '30 GPa'`, or by place `E = '30 [GPa]*(1 + "
        "x/2 [m])'` or `E = 'field.csv:E'`, and a vector by a list: `fibre = 1, 0.5`.");

/* --- random fields ---------------------------------------------------------------------------- */

static const deck_key_info field_keys[] = {
    {.name = "name",
     .type = DECK_NAME,
     DECK_AT(field, name),
     .doc = "of a `field` that the law declares"},
    {.name = "parameter",
     .type = DECK_NAME,
     DECK_AT(field, parameter),
     .doc = "instead: a parameter of the law that differs at random"},
    {.name = "lattice",
     .type = DECK_NAME,
     .fallback = "= the only one",
     DECK_AT(field, lattice),
     .doc = "name of the lattice; needed when there are several"},
    {.name = "mesh", .type = DECK_NAME, DECK_AT(field, mesh), .doc = "instead: name of the mesh"},
    {.name = "value",
     .type = DECK_LATER,
     .unit = "as the field",
     DECK_NOT_KEPT,
     .doc = "of a field: its value, or a formula of `x`, `y`, `z`, where a particle stands, and of "
            "the time `t`"},
    {.name = "file",
     .type = DECK_LATER,
     DECK_NOT_KEPT,
     .doc =
         "of a field: a table beside the deck with columns `x`, `y`, in space `z`, and values on "
         "a rectangular grid, straight between them; or a result, whose nearest particle "
         "counts; `'temperature.csv:T'`"},
    {.name = "times",
     .type = DECK_LATER,
     .unit = "s",
     DECK_NOT_KEPT,
     .doc = "of a field that is the same everywhere: times, ascending"},
    {.name = "values",
     .type = DECK_LATER,
     .unit = "as the field",
     DECK_NOT_KEPT,
     .doc = "its values at those times, straight lines between, held before and after"},
    {.name = "table",
     .type = DECK_LATER,
     DECK_NOT_KEPT,
     .doc = "in place of `times` and `values`, two columns of a text file beside the deck"},
    {.name = "on",
     .type = DECK_WORD,
     .choices = "bond|particle",
     .fallback = "= 'bond' of laws of bonds; of families, and of `rho`, always 'particle'",
     DECK_NOT_KEPT,
     .doc = "`particle`: a value for each particle; a bond has the mean of its two ends"},
    {.name = "distribution",
     .type = DECK_CHOICE,
     .choices = "uniform|normal|lognormal|weibull",
     DECK_AT(field, kind),
     .doc = "at random: of the values"},
    {.name = "mean",
     .type = DECK_LATER,
     .unit = "as the parameter",
     .fallback = "= the material's value",
     DECK_NOT_KEPT,
     .doc = "mean of the values"},
    {.name = "cv",
     .type = DECK_REAL,
     .unit = "1",
     .bound = BOUND_POSITIVE,
     DECK_AT(field, cv),
     .doc = "standard deviation over mean"},
    {.name = "low",
     .type = DECK_LATER,
     .unit = "as the parameter",
     DECK_NOT_KEPT,
     .doc = "uniform: smallest value"},
    {.name = "high",
     .type = DECK_LATER,
     .unit = "as the parameter",
     DECK_NOT_KEPT,
     .doc = "uniform: largest value"},
    {.name = "shape",
     .type = DECK_REAL,
     .unit = "1",
     .bound = BOUND_POSITIVE,
     DECK_AT(field, shape),
     .doc = "Weibull: exponent; the part of values above x is exp(-(x/scale)**shape)"},
    {.name = "scale",
     .type = DECK_LATER,
     .unit = "as the parameter",
     .fallback = "= from the mean",
     DECK_NOT_KEPT,
     .doc = "Weibull: see shape"},
    {.name = "correlation_length",
     .type = DECK_REAL,
     .unit = "m",
     .bound = BOUND_NOT_NEGATIVE,
     .fallback = "0",
     DECK_AT(field, correlation_length),
     .doc = "L in exp(-(r/L)**2), the correlation of the underlying normal field at a distance r; "
            "0: none"},
    {.name = "seed",
     .type = DECK_COUNT,
     .fallback = "1",
     .most = 2147483647,
     DECK_AT(field, seed),
     .doc = "another seed gives another field"},
    {.name = "clip",
     .type = DECK_LOGICAL,
     .fallback = ".false.",
     DECK_AT(field, clip),
     .doc = "move values that the law does not allow to the nearest that it allows; else they are "
            "an error"},
};

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
  deck_refuse_both(r, from, "low", "cv");
  deck_refuse_both(r, from, "low", "mean");
  deck_refuse_both(r, from, "shape", "cv");
  deck_refuse_both(r, from, "scale", "mean");
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
  const int count = m->varying_count;
  for (int k = 0; k < count; k++) {
    if (strcasecmp(m->varying[k], f->parameter) != 0) continue;
    diag_report(r->d, DIAG_CONFLICT, deck_where(&f->item, "parameter"),
                "`%s` has a random field already", deck_shown(r->memory, f->parameter));
    diag_note(r->d, m->varying_where[k], "it is given here");
    return;
  }
  const char **names = arena_room(r->memory, m->varying, count, sizeof *names);
  span *where = arena_room(r->memory, m->varying_where, count, sizeof *where);
  names[count] = f->parameter;
  where[count] = deck_where(&f->item, "parameter");
  m->varying = names;
  m->varying_where = where;
  m->varying_count++;
}

/* The lattice or mesh that is meant; false where it is not known. */
static bool take_field_lattice(deck_reader *r, const namelist_group *from, deck_field *item) {
  deck_refuse_both(r, from, "lattice", "mesh");
  if (item->mesh) {
    item->lattice = item->mesh;
    return deck_mesh_known(r, &item->item, item->mesh);
  }
  if (item->lattice) return deck_lattice_known(r, &item->item, item->lattice);
  if (r->k->lattice_count == 1) {
    item->lattice = r->k->lattices[0].name;
    return true;
  }
  if (r->names_known && r->k->lattice_count > 1) {
    diag_report(r->d, DIAG_MISSING_KEY, item->item.where, "`&field` needs `lattice` here");
    diag_hint(r->d, "the deck has %d lattices", r->k->lattice_count);
  }
  return false;
}

static void check_random(deck_reader *r, const namelist_group *from, deck_field *item) {
  const namelist_key *on = namelist_find(from, "on");
  if (on)
    item->on = deck_choice_read(r->memory, on, "bond|particle", r->d) == 1 ? FIELD_ON_PARTICLES
                                                                           : FIELD_ON_BONDS;
  if (!deck_keys_fit(from, field_uses, 4, (int)item->kind, field_words[item->kind], r->d)) return;
  bool good = read_number(r, from, "mean", &item->mean);
  good &= read_number(r, from, "low", &item->low);
  good &= read_number(r, from, "high", &item->high);
  good &= read_number(r, from, "scale", &item->scale);
  if (good) check_distribution(r, from, item);
  if (!take_field_lattice(r, from, item)) return;
  for (int i = 0; i < r->k->material_count; i++)
    if (deck_same_name(r->k->materials[i].lattice, item->lattice) && !r->k->materials[i].region)
      add_varying(r, (deck_material *)(uintptr_t)&r->k->materials[i], item); /* still being read */
}

/* --- fields of the law ------------------------------------------------------------------------ */

static bool read_field_table(deck_reader *r, const namelist_group *from, deck_assignment *a) {
  time_function *f = arena_alloc(r->memory, sizeof *f);
  deck_quantity q;
  if (!deck_quantity_in_time_read(r->memory, from, f, &q, r->d)) return false;
  a->has_unit = q.has_unit;
  a->dim = q.dim;
  a->value = time_function_at(f, 0);
  a->placed = placed_by(r->memory, (deck_placed){.in_time = f});
  return true;
}

static bool read_field_value(deck_reader *r, const namelist_key *key, deck_assignment *a) {
  if (!deck_values_counted(key, 1, r->d)) return false;
  const namelist_value *v = &key->values[0];
  deck_quantity q;
  if (deck_is_formula(v))
    return read_formula(r->memory, v, key->name, &deck_formula_of_all, a, r->d);
  if (!deck_quantity_read(v, key->name, &q, r->d)) return false;
  a->value = q.value;
  a->has_unit = q.has_unit;
  a->dim = q.dim;
  return true;
}

static bool read_field_file(deck_reader *r, const namelist_group *from, const namelist_key *key,
                            const char *lattice, deck_assignment *a) {
  if (!deck_values_counted(key, 1, r->d)) return false;
  const namelist_value *v = &key->values[0];
  if (v->kind == NAMELIST_TEXT && *v->text)
    return read_place_file(r->memory, from->where.file, lattice, v, a, r->d);
  diag_report(r->d, DIAG_BAD_VALUE, v->where, "`file` is the name of a table or result in quotes");
  return false;
}

/* The key that gives the field; NULL after a message. */
static const namelist_key *field_source_key(deck_reader *r, const namelist_group *from) {
  static const char *const ways[] = {"value", "file", "times", "table", "distribution"};
  const namelist_key *found = NULL;
  for (size_t k = 0; k < sizeof ways / sizeof *ways; k++) {
    const namelist_key *key = namelist_find(from, ways[k]);
    if (!key) continue;
    if (found) {
      diag_report(r->d, DIAG_CONFLICT, key->name_where, "`%s` and `%s` exclude each other",
                  found->name, key->name);
      diag_note(r->d, found->name_where, "`%s` is given here", found->name);
      return NULL;
    }
    found = key;
  }
  if (found) return found;
  diag_report(r->d, DIAG_MISSING_KEY, from->where, "this field has no value");
  diag_hint(r->d, "give it a `value`, a `file` of places, `times` and `values`, a `table` in time, "
                  "or a `distribution`");
  return NULL;
}

/* An assignment of all materials of the lattice: what is asked of these goes for it, too. */
static void give_field(deck_reader *r, const deck_field *item, const deck_assignment *a) {
  const int whole = deck_find_material(r->k, item->lattice);
  for (int i = 0; i < r->k->material_count; i++) {
    deck_material *m = (deck_material *)(uintptr_t)&r->k->materials[i]; /* still being read */
    if (!deck_same_name(m->lattice, item->lattice)) continue;
    deck_assignment *all =
        arena_alloc(r->memory, ((size_t)m->assignment_count + 2) * sizeof *all); /* and a density */
    for (int n = 0; n < m->assignment_count; n++)
      all[n] = m->assignments[n];
    all[m->assignment_count] = *a;
    all[m->assignment_count].anyway =
        whole >= 0 && !deck_same_name(m->model, r->k->materials[whole].model);
    m->assignments = all;
    m->assignment_count++;
  }
}

static void check_given(deck_reader *r, const namelist_group *from, deck_field *item) {
  const namelist_key *key = field_source_key(r, from);
  deck_assignment a = {
      .name = item->name, .name_where = deck_where(&item->item, "name"), .of_field = true};
  if (!key) return;
  a.value_where = key->value_where;
  if (!take_field_lattice(r, from, item)) return;
  const bool good = strcmp(key->name, "value") == 0 ? read_field_value(r, key, &a)
                    : strcmp(key->name, "file") == 0
                        ? read_field_file(r, from, key, item->lattice, &a)
                        : read_field_table(r, from, &a);
  if (good) give_field(r, item, &a);
}

static void check_field(deck_reader *r, const namelist_group *from, void *into) {
  deck_field *item = into;
  deck_refuse_both(r, from, "name", "parameter");
  if (item->name && item->parameter) return;
  item->random = namelist_find(from, "distribution") != NULL;
  if (!item->name && !item->parameter) {
    diag_report(r->d, DIAG_MISSING_KEY, from->where, "`&field` needs `name` or `parameter`");
    diag_hint(r->d, "name: a `field` that the law declares; parameter: one that differs at random");
  } else if (item->name && !item->random) {
    check_given(r, from, item);
  } else if (!item->random) {
    diag_report(r->d, DIAG_MISSING_KEY, from->where, "`&field` needs `distribution`");
    diag_hint(r->d,
              "a field of the law is named by `name`; a parameter by place stands in "
              "&material: %s = '...'",
              deck_shown(r->memory, item->parameter));
  } else {
    if (item->name && !field_source_key(r, from)) return;
    if (item->name) item->parameter = item->name;
    check_random(r, from, item);
  }
}

DECK_LIST(
    field, .identity = "parameter", .parts = {"name"}, .check = check_field,
    .doc =
        "What a law is given in place and time, see [Fields in place and time]"
        "(#fields-in-place-and-time); or a parameter of the law that differs in space at random, "
        "the "
        "same for the same "
        "seed whatever the threads. Uniform: `low` and `high`, or `cv`; normal, lognormal: `cv`; "
        "Weibull: `shape`, or `cv`.");
