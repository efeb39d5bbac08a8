#include "generator/drive/drive_grammar.h"

#include <stdlib.h>
#include <string.h>

#include "generator/drive/drive_path.h"
#include "generator/kernel/document.h"
#include "generator/kernel/model.h"
#include "runtime/deck/lattice_kind.h"

enum { MOST_STEPS = 1000000 };

/* --- the groups ------------------------------------------------------------------------------- */

#define AT(type, field) .offset = (long)offsetof(drive_##type, field)
#define NOT_KEPT        .offset = DECK_NO_FIELD
#define LATER(key, unit_text, text)                                                                \
  { .name = key, .type = DECK_LATER, .unit = unit_text, NOT_KEPT, .doc = text }
#define SETTING_OF(group, text)                                                                    \
  {                                                                                                \
    .name = "setting", .type = DECK_WORD, .choices = "plane_stress|plane_strain|space",            \
    .fallback = "= the first that the law is for", AT(group, setting), .doc = text                 \
  }

static const deck_key_info simulation_keys[] = {
    {.name = "title",
     .type = DECK_TEXT,
     .fallback = "= the file's name",
     AT(simulation, title),
     .doc = "for pictures and results"},
    {.name = "end_time",
     .type = DECK_REAL,
     .unit = "s",
     .bound = BOUND_NOT_NEGATIVE,
     .fallback = "= where the last `&path` ends",
     AT(simulation, end_time),
     .doc = "end of the path"},
    {.name = "steps",
     .type = DECK_COUNT,
     .fallback = "1000",
     .most = MOST_STEPS,
     AT(simulation, steps),
     .doc = "even steps; the corners of the path are always met, too"},
};

static const deck_key_info bond_keys[] = {
    {.name = "spacing",
     .type = DECK_REAL,
     .unit = "m",
     .bound = BOUND_POSITIVE,
     .fallback = "'10 mm'",
     AT(bond, spacing),
     .doc = "`s` and `spacing` of the law"},
    {.name = "thickness",
     .type = DECK_REAL,
     .unit = "m",
     .bound = BOUND_POSITIVE,
     .fallback = "'100 mm'",
     AT(bond, thickness),
     .doc = "`t` of the law"},
    {.name = "area",
     .type = DECK_REAL,
     .unit = "m^2",
     .bound = BOUND_POSITIVE,
     .fallback = "= none; required by laws that read it",
     AT(bond, area),
     .doc = "`area` of the law: the bond is one of a chain"},
    {.name = "mass_i",
     .type = DECK_REAL,
     .unit = "kg",
     .bound = BOUND_POSITIVE,
     .fallback = "= from `rho`, as on a hexagonal lattice",
     AT(bond, mass_i),
     .doc = "`m_i`"},
    {.name = "mass_j",
     .type = DECK_REAL,
     .unit = "kg",
     .bound = BOUND_POSITIVE,
     .fallback = "= `mass_i`",
     AT(bond, mass_j),
     .doc = "`m_j`"},
    SETTING_OF(bond, "of the law: whether the bond is one of the plane, which plane, or of space"),
};

static const deck_key_info particle_keys[] = {
    {.name = "lattice",
     .type = DECK_NAME,
     .fallback = "= 'hexagonal'; in space 'fcc' with `shells = 2`",
     AT(particle, lattice),
     .doc = LATTICE_KINDS_OF_FAMILIES_QUOTED},
    {.name = "spacing",
     .type = DECK_REAL,
     .unit = "m",
     .bound = BOUND_POSITIVE,
     .fallback = "'10 mm'",
     AT(particle, spacing),
     .doc = "of nearest neighbours"},
    {.name = "thickness",
     .type = DECK_REAL,
     .unit = "m",
     .bound = BOUND_POSITIVE,
     .fallback = "'100 mm'",
     AT(particle, thickness),
     .doc = "`t` of the law, in the plane"},
    {.name = "horizon",
     .type = DECK_REAL,
     .unit = "1",
     .bound = BOUND_POSITIVE,
     .fallback = "= by `shells`",
     AT(particle, horizon),
     .doc = "neighbours up to so many spacings away"},
    {.name = "shells",
     .type = DECK_COUNT,
     .fallback = "= the nearest neighbours",
     .most = 64,
     AT(particle, shells),
     .doc = "neighbours of so many shells"},
    {.name = "rotation",
     .type = DECK_ANGLE,
     .fallback = "0",
     AT(particle, rotation),
     .doc = "of the lattice, in degrees"},
};

static const deck_key_info point_keys[] = {
    {.name = "test",
     .type = DECK_CHOICE,
     .choices = "components|uniaxial stress|plane stress|shear|hydrostatic",
     .fallback = "'components'",
     AT(point, test),
     .doc = "components that no `&path` names are not strained; uniaxial stress, driven by xx, and "
            "shear, driven by xy: they bear no stress; plane stress, in space: zz, yz, xz bear "
            "none; hydrostatic, driven by xx: yy and zz are as xx, without shear"},
    SETTING_OF(point, "what the third direction does"),
    {.name = "size",
     .type = DECK_REAL,
     .unit = "m",
     .bound = BOUND_POSITIVE,
     .fallback = "'10 mm'",
     AT(point, cell_size),
     .doc = "`h` of the law"},
};

static const deck_key_info material_keys[] = {
    {.name = "model",
     .type = DECK_NAME,
     .fallback = "= the law on the command line",
     NOT_KEPT,
     .doc = "name or path of the law"},
    {.name = "lattice",
     .type = DECK_NAME,
     NOT_KEPT,
     .doc = "not used; so that a deck's `&material` can be copied"},
};

static const deck_key_info initial_keys[] = {
    LATER("the law's own", "theirs", "e.g. `omega = 0.3`")};

static const deck_key_info path_keys[] = {
    {.name = "quantity",
     .type = DECK_CHOICE,
     .choices =
         "stretch|theta_i|theta_j|twist|stretch_rate|strain_xx|strain_yy|strain_zz|strain_xy|"
         "strain_yz|strain_xz|stress_xx|stress_yy|stress_zz|stress_xy|stress_yz|stress_xz",
     NOT_KEPT,
     .doc = "what is prescribed; several `&path` of one quantity add up; the rate is that of the "
            "stretch unless it is given; stresses drive points alone"},
    LATER("field", "",
          "instead: a `field` of the law, which goes as `times` and `values` say, in its unit; "
          "before and after as at the ends"),
    LATER(
        "value", "as the quantity",
        "full value of a load; amplitude of cycles; factor on `values` and files, 1 if not given"),
    {.name = "history",
     .type = DECK_CHOICE,
     .choices = "constant|ramp|ramp and hold|cosine|table|cycles",
     .fallback = "= by the other keys",
     NOT_KEPT,
     .doc = "how the value is reached, as for the loads of a deck"},
    LATER("start", "s", "0 before; default 0"),
    LATER("rise", "s", "ramp, ramp and hold, cosine: time to the full value"),
    LATER("times", "s", "table: times from `start`; straight lines between"),
    LATER("values", "1", "table: values, times `value`"),
    LATER("period", "s", "cycles: time of one"),
    LATER("cycles", "1", "cycles: how many; default 1"),
    LATER("wave", "",
          "cycles: `'triangle'` (default), `'sine'`, `'pulse'` (up and back to 0, never below)"),
    LATER(
        "file", "",
        "table: two columns of a text file beside this one, times and values, as for the loads of "
        "a deck"),
};

static const deck_key_info output_keys[] = {
    {.name = "csv", .type = DECK_NAME, AT(output, csv), .doc = "path of the table as text"},
    {.name = "hdf5",
     .type = DECK_NAME,
     AT(output, hdf5),
     .doc = "path of the table as a result, for `perilat plot`"},
    {.name = "picture",
     .type = DECK_NAME,
     AT(output, picture),
     .doc = "path of a curve, .png, .svg or .pdf"},
    {.name = "x",
     .type = DECK_NAME,
     .fallback = "= stretch, or the first strain",
     AT(output, x),
     .doc = "column along the picture"},
    {.name = "y",
     .type = DECK_NAME,
     .fallback = "= N, or the first stress",
     AT(output, y),
     .doc = "column up the picture"},
    {.name = "rows",
     .type = DECK_COUNT,
     .fallback = "12",
     .most = MOST_STEPS,
     AT(output, rows),
     .doc = "of the printed table"},
};

static const deck_key_info expect_keys[] = {
    {.name = "quantity",
     .type = DECK_NAME,
     .required = true,
     AT(expect, quantity),
     .doc = "a column, or `'peak N'`, `'lowest N'`, `'final N'`, `'stretch at peak'`, `'omega at "
            "peak M_i'`"},
    {.name = "at_time",
     .type = DECK_REAL,
     .unit = "s",
     .bound = BOUND_NOT_NEGATIVE,
     .fallback = "= the end",
     AT(expect, at_time),
     .doc = "of a column: when"},
    {.name = "at_stretch",
     .type = DECK_REAL,
     .unit = "1",
     .fallback = "= the end",
     AT(expect, at_stretch),
     .doc = "of a column: when that of the path first takes this value"},
    {.name = "after",
     .type = DECK_REAL,
     .unit = "s",
     .bound = BOUND_NOT_NEGATIVE,
     .fallback = "0",
     AT(expect, after),
     .doc = "`at_stretch`: looked for from this time on"},
    LATER("value", "as the quantity", "expected"),
    LATER("formula", "",
          "expected, in the law's language: parameters, constants, and what the row has, e.g. "
          "`'EA*S_t'`"),
    {.name = "tolerance",
     .type = DECK_REAL,
     .unit = "1",
     .bound = BOUND_NOT_NEGATIVE,
     .fallback = "1e-6",
     AT(expect, tolerance),
     .doc = "relative to the expected value"},
    LATER("absolute", "as the quantity", "tolerance; the larger of the two counts; default 0"),
};

static const deck_group_info groups[DRIVE_GROUP_COUNT] = {
#define X(group, once, more, text)                                                                 \
  {.name = #group,                                                                                 \
   .single = once,                                                                                 \
   .open = more,                                                                                   \
   .keys = group##_keys,                                                                           \
   .key_count = (int)(sizeof group##_keys / sizeof *group##_keys),                                 \
   .doc = text},
    DRIVE_GROUPS(X)
#undef X
};

static const deck_group_info *const group_list[DRIVE_GROUP_COUNT] = {
#define X(group, once, more, text) &groups[DRIVE_GROUP_##group],
    DRIVE_GROUPS(X)
#undef X
};

const deck_grammar drive_grammar = {"path", group_list, DRIVE_GROUP_COUNT};

const deck_group_info *drive_group(const char *name) {
  for (int g = 0; g < DRIVE_GROUP_COUNT; g++)
    if (strcmp(groups[g].name, name) == 0) return &groups[g];
  return NULL;
}

/* `path`, `bond`, ...: groups that paths have and decks do not; or the other way round. */
static bool has_own_group(const char *file, bool of_paths) {
  char said[512];
  size_t length;
  char *text = read_text_file(file, NAMELIST_LARGEST_TEXT, &length, said, sizeof said);
  if (!text) return false;
  arena *memory = arena_new();
  source_set sources = {NULL, 0};
  diagnostics unsaid;
  diag_begin(&unsaid, &sources);
  const namelist *n =
      namelist_read(memory, &sources, source_add(&sources, file, text, length), &unsaid);
  bool found = false;
  for (int k = 0; k < n->group_count && !found; k++) {
    const bool in_paths = drive_group(n->groups[k].name),
               in_decks = deck_group_find(n->groups[k].name) >= 0;
    found = of_paths ? in_paths && !in_decks : in_decks && !in_paths;
  }
  diag_clear(&unsaid);
  source_clear(&sources);
  arena_free(memory);
  free(text);
  return found;
}

bool drive_is_path(const char *file) {
  return has_own_group(file, true);
}

bool drive_is_deck(const char *file) {
  return has_own_group(file, false);
}

bool drive_refuse_path(const char *command, const char *file) {
  if (!drive_is_path(file)) return false;
  say_error("`%s` is a path for `perilat drive`, not a deck for `perilat %s`\n"
            "  perilat drive %s",
            file, command, file);
  return true;
}
