#include "runtime/deck/group_bar.h"

#include <math.h>
#include <string.h>

#include "runtime/deck/deck_check.h"
#include "runtime/deck/deck_value.h"
#include "runtime/deck/lattice_kind.h"
#include "runtime/geometry/polyline.h"

/* --- bars ------------------------------------------------------------------------------------- */

static const deck_key_info bar_keys[] = {
    {.name = "name", .type = DECK_NAME, .required = true, DECK_AT(bar, name), .doc = "its name"},
    {.name = "points",
     .type = DECK_REALS,
     .unit = "m",
     .required = true,
     DECK_AT(bar, points),
     DECK_COUNT_AT(bar, value_count),
     .doc = "its corners from end to end: x1, y1, x2, y2, ..., in space x1, y1, z1, ..."},
    {.name = "closed",
     .type = DECK_LOGICAL,
     .fallback = ".false.",
     DECK_AT(bar, closed),
     .doc = "the last corner is joined to the first, as of a stirrup"},
    {.name = "copies",
     .type = DECK_COUNT,
     .fallback = "1",
     .most = 1000000,
     DECK_AT(bar, copies),
     .doc = "how many such lines there are, which do not touch each other"},
    {.name = "shift",
     .type = DECK_PLACE,
     .unit = "m",
     .fallback = "= none; required with several `copies`",
     DECK_AT(bar, shift),
     .doc = "from each of the copies to the next"},
    {.name = "spacing",
     .type = DECK_REAL,
     .unit = "m",
     .bound = BOUND_POSITIVE,
     .required = true,
     DECK_AT(bar, spacing),
     .doc = "distance of its particles; each straight leg is divided into equal parts as near to "
            "it as can be"},
    {.name = "diameter",
     .type = DECK_REAL,
     .unit = "m",
     .bound = BOUND_POSITIVE,
     DECK_AT(bar, diameter),
     .doc = "of its round cross-section; or give the `area`"},
    {.name = "area",
     .type = DECK_REAL,
     .unit = "m^2",
     .bound = BOUND_POSITIVE,
     DECK_AT(bar, area),
     .doc = "of its cross-section, `area` of the law; or give the `diameter`"},
    {.name = "setting",
     .type = DECK_WORD,
     .choices = "plane|space",
     .fallback = "= that of the deck's lattices, without one `'plane'`",
     DECK_AT(bar, setting),
     .doc = "whether its corners have two coordinates or three"},
};

/* Bars move where the deck's lattices do. 0: nobody knows. */
static int bar_dimensions(const deck_reader *r, const deck_bar *item) {
  if (item->setting) return strcmp(item->setting, "space") == 0 ? 3 : 2;
  if (r->k->lattice_count > 0)
    return r->k->lattices[0].kind ? deck_lattice_dimensions(&r->k->lattices[0]) : 0;
  return deck_lacks(r->k, "lattice") ? 0 : 2;
}

/* Whole corners, as many as a line needs. */
static bool has_corners(deck_reader *r, const deck_bar *item, int dimensions) {
  const span where = deck_where(&item->item, "points");
  const int corners = item->value_count / dimensions, least = item->closed ? 3 : 2;
  if (item->value_count % dimensions) {
    diag_report(r->d, DIAG_BAD_VALUE, where,
                "a point has %d coordinates in %s, but `points` has %d "
                "values",
                dimensions, dimensions == 2 ? "the plane" : "space", item->value_count);
    diag_hint(r->d, "a bar in space, in a deck without a lattice, says so: `setting = 'space'`");
  } else if (corners < least)
    diag_report(r->d, DIAG_BAD_VALUE, where, "a %sbar has at least %d points, but here %s %d",
                item->closed ? "closed " : "", least, corners == 1 ? "is" : "are", corners);
  return item->value_count % dimensions == 0 && corners >= least;
}

static polyline line_of(const deck_bar *b, int dimensions) {
  return (polyline){dimensions, b->value_count / dimensions, b->points, b->closed};
}

static void check_legs(deck_reader *r, const deck_bar *item, int dimensions) {
  const polyline p = line_of(item, dimensions);
  for (int k = 0; k < polyline_legs(&p); k++) {
    const double *from, *to, length = polyline_leg(&p, k, &from, &to);
    const int end = (k + 1) % p.corners + 1;
    if (length == 0) {
      diag_report(r->d, DIAG_BAD_VALUE, deck_where(&item->item, "points"),
                  "points %d and %d are the same", k + 1, end);
      if (end == 1) diag_hint(r->d, "`closed` joins the last point to the first by itself");
    } else if (length < item->spacing * (1 - POLYLINE_ROUNDING)) {
      diag_report(r->d, DIAG_OUT_OF_BOUNDS, deck_where(&item->item, "spacing"),
                  "the leg from point %d to point %d is %.6g mm long, shorter than the `spacing`",
                  k + 1, end, 1e3 * length);
    } else
      continue;
    return;
  }
}

/* A bar is longer than thick: mostly a unit is missing. */
static void check_thickness(deck_reader *r, const namelist_group *from, const deck_bar *item,
                            int dimensions) {
  const polyline p = line_of(item, dimensions);
  const bool area = namelist_find(from, "area");
  const double length = polyline_length(&p);
  if (item->diameter < length) return;
  diag_report(r->d, DIAG_OUT_OF_BOUNDS, deck_where(&item->item, area ? "area" : "diameter"),
              "the bar is %.6g mm thick, but only %.6g mm long", 1e3 * item->diameter,
              1e3 * length);
  diag_hint(r->d, area ? "a plain number is in m^2: `area = '113 mm^2'`"
                       : "a plain number is in m: `diameter = '12 mm'`");
}

static bool is_nowhere(const double shift[3], double spacing) {
  const double length = sqrt(shift[0] * shift[0] + shift[1] * shift[1] + shift[2] * shift[2]);
  return length < POLYLINE_ROUNDING * spacing;
}

static void warn_of_overlap(deck_reader *r, const deck_bar *item, int dimensions) {
  const polyline p = line_of(item, dimensions);
  if (item->copies < 2 || is_nowhere(item->shift, item->spacing)) return;
  const double apart = polyline_apart(&p, item->shift);
  if (apart >= item->diameter) return;
  diag_report(r->d, DIAG_DECK_WARNING, deck_where(&item->item, "shift"),
              "copies of the bar are %.4g mm apart, but %.4g mm thick: they lie in each other, and "
              "do not touch",
              1e3 * apart, 1e3 * item->diameter);
  diag_hint(r->d, "give a longer `shift`, across the bar");
}

static void check_section(deck_reader *r, const namelist_group *from, deck_bar *item) {
  deck_refuse_both(r, from, "diameter", "area");
  if (item->diameter == 0 && item->area == 0)
    diag_report(r->d, DIAG_MISSING_KEY, from->where, "`&bar` needs a `diameter` or an `area`");
  if (item->area == 0)
    item->area = M_PI / 4 * item->diameter * item->diameter;
  else
    item->diameter = sqrt(item->area * 4 / M_PI);
}

static void check_copies(deck_reader *r, const namelist_group *from, const deck_bar *item) {
  const bool shift = namelist_find(from, "shift");
  if (item->copies < 1) {
    diag_report(r->d, DIAG_OUT_OF_BOUNDS, deck_where(&item->item, "copies"),
                "a bar has at least one copy: itself");
  } else if (shift && !namelist_find(from, "copies")) {
    diag_report(r->d, DIAG_MISSING_KEY, deck_where(&item->item, "shift"), "`shift` needs `copies`");
    diag_hint(r->d, "copies: how many such lines there are, the first one included");
  } else if (item->copies > 1 && !shift) {
    diag_report(r->d, DIAG_MISSING_KEY, deck_where(&item->item, "copies"),
                "several `copies` need a `shift`");
    diag_hint(r->d, "shift: from each to the next, such as '80 mm', 0%s",
              strcmp(item->setting, "space") == 0 ? ", 0" : "");
  } else if (item->copies > 1 && is_nowhere(item->shift, item->spacing))
    diag_report(r->d, DIAG_OUT_OF_BOUNDS, deck_where(&item->item, "shift"),
                "without a `shift` all %d copies are in the same place", item->copies);
}

static void begin_bar(void *item) {
  ((deck_bar *)item)->kind = lattice_kinds[LATTICE_KIND_bar].name;
}

static void check_bar(deck_reader *r, const namelist_group *from, void *into) {
  deck_bar *item = into;
  const int dimensions = bar_dimensions(r, item);
  item->setting = dimensions == 3 ? "space" : "plane_stress";
  check_section(r, from, item);
  check_copies(r, from, item);
  deck_check_lattice_name(r, item);
  if (!dimensions) return;
  deck_check_places(r, from, &deck_group_bar, dimensions);
  if (!has_corners(r, item, dimensions)) return;
  check_legs(r, item, dimensions);
  check_thickness(r, from, item, dimensions);
  warn_of_overlap(r, item, dimensions);
}

DECK_MORE(bar, lattice, .identity = "name", .begin = begin_bar, .check = check_bar,
          .doc =
              "A bar: particles along a line of straight legs, each joined to the next, or several "
              "such lines. It needs no `&body`; everywhere else it is named as a lattice is.");

/* --- links ------------------------------------------------------------------------------------ */

static const deck_key_info link_keys[] = {
    {.name = "name", .type = DECK_NAME, .required = true, DECK_AT(link, name), .doc = "its name"},
    {.name = "bar",
     .type = DECK_NAME,
     .required = true,
     DECK_AT(link, bar),
     .doc = "name of the bar that it joins"},
    {.name = "lattice",
     .type = DECK_NAME,
     .required = true,
     DECK_AT(link, around),
     .doc = "name of the lattice around the bar"},
    {.name = "every",
     .type = DECK_COUNT,
     .fallback = "1",
     .most = 1000000,
     DECK_AT(link, every),
     .doc =
         "of the particles of each of the bar's copies, counted from 0 along it, every one, every "
         "second, ... is joined"},
    {.name = "first",
     .type = DECK_COUNT,
     .fallback = "0",
     .most = 1000000000,
     DECK_AT(link, first),
     .doc = "the first of these"},
    {.name = "to",
     .type = DECK_CHOICE,
     .choices = "sites|place",
     .fallback = "'sites'",
     DECK_AT(link, to),
     .doc =
         "`sites`: a bond to each particle of the lattice within reach; `place`: one bond to the "
         "place where the bar's particle is, which moves as the corners of the triangle or "
         "tetrahedron of sites that holds it do"},
    {.name = "within",
     .type = DECK_REAL,
     .unit = "1",
     .bound = BOUND_POSITIVE,
     .fallback = "1",
     DECK_AT(link, within),
     .doc = "`sites`, in spacings of the lattice: how far away they may be; one at the same place "
            "is not joined"},
};

static void begin_link(void *item) {
  ((deck_link *)item)->kind = lattice_kinds[LATTICE_KIND_link].name;
}

/* What laws are told: of links to sites what they are of the lattice around the bar; of those to
   places the bar's area, and the length that each stands for. */
static void take_quantities(const deck_lattice *bar, const deck_lattice *around, deck_link *item) {
  item->setting = around->setting;
  if (item->to == LINK_TO_PLACE) {
    item->spacing = bar->spacing * item->every;
    item->area = bar->area;
    return;
  }
  item->spacing = around->spacing;
  item->thickness = around->thickness;
  item->stiffness_thickness = around->stiffness_thickness;
  item->mass_thickness = around->mass_thickness;
}

/* Links and ties are as long as a spacing says, which here is not one. */
static bool is_graded(deck_reader *r, const deck_lattice *l, const deck_item *item,
                      const char *word) {
  if (!l->graded) return false;
  diag_report(r->d, DIAG_CONFLICT, deck_where(item, "lattice"),
              "the particles of `%s` differ in size from place to place: no %s joins them",
              deck_shown(r->memory, l->name), word);
  diag_hint(r->d, "give `%s` one `spacing`", deck_shown(r->memory, l->name));
  return true;
}

/* What is wrong with what it joins has been said, and the link is left out with it. */
static void take_around(deck_reader *r, deck_link *item) {
  const deck_lattice *around = &r->k->lattices[item->of_around];
  item->item.faulty = around->item.faulty || r->k->lattices[item->of_bar].item.faulty;
  if (is_graded(r, around, &item->item, "link")) return;
  if (!item->item.faulty) take_quantities(&r->k->lattices[item->of_bar], around, item);
  if (deck_lattice_is_bar(around) || deck_lattice_is_link(around))
    diag_report(r->d, DIAG_BAD_VALUE, deck_where(&item->item, "lattice"),
                "`%s` is a %s: a link joins a bar to the lattice around it",
                deck_shown(r->memory, item->around), deck_lattice_word(around));
  else if (!item->item.faulty && around->kind &&
           deck_lattice_dimensions(around) !=
               deck_lattice_dimensions(&r->k->lattices[item->of_bar]))
    diag_report(r->d, DIAG_CONFLICT, deck_where(&item->item, "lattice"),
                "the bar `%s` and the lattice `%s` are not both in the plane, or in space",
                deck_shown(r->memory, item->bar), deck_shown(r->memory, item->around));
}

static void check_link(deck_reader *r, const namelist_group *from, void *into) {
  deck_link *item = into;
  deck_check_lattice_name(r, item);
  if (item->to == LINK_TO_PLACE && namelist_find(from, "within"))
    diag_report(r->d, DIAG_CONFLICT, deck_where(&item->item, "within"),
                "`within` is for links `to = 'sites'`: a place is where the bar is");
  if (item->every < 1)
    diag_report(r->d, DIAG_BAD_VALUE, deck_where(&item->item, "every"),
                "`every` counts from 1, which is each particle");
  if (!deck_bar_known(r, &item->item, item->bar) ||
      !deck_lattice_known(r, &item->item, item->around))
    return;
  item->of_bar = deck_find_lattice(r->k, item->bar);
  item->of_around = deck_find_lattice(r->k, item->around);
  if (item->of_bar >= 0 && item->of_around >= 0) take_around(r, item);
}

DECK_MORE(link, lattice, .identity = "name", .begin = begin_link, .check = check_link,
          .doc = "Bonds between a bar and the lattice around it; their law is that of a "
                 "`&material link =`. Everywhere else it is named as a lattice is.");

/* --- ties ------------------------------------------------------------------------------------- */

static const deck_key_info tie_keys[] = {
    {.name = "lattice",
     .type = DECK_NAME,
     .required = true,
     DECK_AT(tie, lattice),
     .doc = "name of the lattice whose particles in the mesh, or on its edge, are tied"},
    {.name = "mesh",
     .type = DECK_NAME,
     .required = true,
     DECK_AT(tie, mesh),
     .doc = "name of the mesh that moves them; its cells there are finite elements"},
};

static const deck_lattice *lattice_named(const deck_reader *r, const char *name) {
  const int found = deck_find_lattice(r->k, name);
  return found < 0 || r->k->lattices[found].item.faulty ? NULL : &r->k->lattices[found];
}

/* The two are parts of one body. */
static void compare(deck_reader *r, const deck_tie *item, const deck_lattice *l,
                    const deck_mesh *m) {
  const char *lattice = deck_shown(r->memory, item->lattice),
             *mesh = deck_shown(r->memory, item->mesh);
  if (deck_lattice_dimensions(l) != 2) {
    diag_report(r->d, DIAG_CONFLICT, deck_where(&item->item, "lattice"),
                "the lattice `%s` is not in the plane, as meshes are", lattice);
    return;
  }
  if (fabs(l->stiffness_thickness - m->thickness) > 1e-6 * m->thickness) {
    diag_report(r->d, DIAG_DECK_WARNING, item->item.where, "`%s` is %.6g mm thick, `%s` %.6g mm",
                lattice, 1e3 * l->stiffness_thickness, mesh, 1e3 * m->thickness);
    diag_hint(r->d, "give both the same `thickness`");
  }
  if (l->setting && m->setting && strcmp(l->setting, m->setting) != 0) {
    diag_report(r->d, DIAG_DECK_WARNING, item->item.where, "`%s` is in %s, `%s` in %s", lattice,
                l->setting, mesh, m->setting);
    diag_hint(r->d, "give both the same `setting`");
  }
}

static void check_tie(deck_reader *r, const namelist_group *from, void *into) {
  const deck_tie *item = into;
  (void)from;
  if (!deck_lattice_known(r, &item->item, item->lattice) ||
      !deck_mesh_known(r, &item->item, item->mesh))
    return;
  const deck_lattice *l = lattice_named(r, item->lattice), *m = lattice_named(r, item->mesh);
  if (!l || !m) return;
  if (deck_lattice_is_bar(l) || deck_lattice_is_link(l) || deck_lattice_is_mesh(l)) {
    diag_report(r->d, DIAG_BAD_VALUE, deck_where(&item->item, "lattice"),
                "`%s` is a %s: a tie joins a lattice to a mesh",
                deck_shown(r->memory, item->lattice), deck_lattice_word(l));
    return;
  }
  if (is_graded(r, l, &item->item, "tie")) return;
  for (int n = 0; n < r->k->tie_count; n++)
    if (deck_same_name(r->k->ties[n].lattice, item->lattice) &&
        deck_same_name(r->k->ties[n].mesh, item->mesh)) {
      diag_report(r->d, DIAG_CONFLICT, item->item.where, "`%s` is tied to `%s` twice",
                  deck_shown(r->memory, item->lattice), deck_shown(r->memory, item->mesh));
      diag_note(r->d, r->k->ties[n].item.where, "tied here first");
      return;
    }
  compare(r, item, l, m);
}

DECK_LIST(
    tie, .check = check_tie,
    .doc = "Particles of a lattice that lie in a mesh or on its edge go where the mesh goes, and "
           "give it what acts on them, see [Lattices in meshes](#lattices-in-meshes).");
