#include "generator/kernel/material_law.h"

#include <stdlib.h>
#include <string.h>
#include <strings.h>

#include "dsl/semantics/law_limits.h"
#include "dsl/semantics/law_reads.h"
#include "dsl/semantics/law_variant.h"
#include "dsl/syntax/parse.h"
#include "generator/lower/lowered.h"
#include "runtime/deck/bravais.h"
#include "runtime/deck/deck_formula.h"

enum { ERROR_LENGTH = 4096 };

/* --- options of a law ------------------------------------------------------------------------- */

static const symbol *find_option(const law *l, const char *name) {
  for (int k = 0; k < l->options.count; k++)
    if (strcasecmp(l->options.items[k]->name, name) == 0) return l->options.items[k];
  return NULL;
}

/* The choice as the law writes it, or NULL with a diagnostic at the deck's line. */
static const char *find_choice(const symbol *option, const deck_assignment *a, diagnostics *said) {
  const stmt *declared = option->declared;
  for (int w = 0; a->word && w < declared->word_count; w++)
    if (strcmp(declared->words[w], a->word) == 0) return declared->words[w];
  char words[256] = "";
  for (int w = 0; w < declared->word_count; w++) {
    size_t used = strlen(words);
    snprintf(words + used, sizeof words - used, "%s'%s'", w ? ", " : "", declared->words[w]);
  }
  if (a->word)
    diag_report(said, DIAG_OPTION, a->value_where, "the option `%s` has no choice `%s`",
                option->name, a->word);
  else
    diag_report(said, DIAG_OPTION, a->value_where, "the option `%s` takes a word", option->name);
  diag_hint(said, "the choices are %s", words);
  return NULL;
}

/* A material's assignment that names an option of the law is a choice, all others are values of
   parameters. */
bool material_law_take_options(const deck_material *m, model *out, diagnostics *said) {
  const size_t most = (size_t)m->assignment_count + 1;
  deck_assignment *values = arena_alloc(out->memory, most * sizeof *values);
  law_choice *choices = arena_alloc(out->memory, most * sizeof *choices);
  int value_count = 0, choice_count = 0;
  bool good = true;
  for (int k = 0; k < m->assignment_count; k++) {
    const deck_assignment *a = &m->assignments[k];
    const symbol *option = find_option(out->law, a->name);
    const char *choice = option ? find_choice(option, a, said) : NULL;
    if (!option) values[value_count++] = *a;
    if (choice) choices[choice_count++] = (law_choice){option->name, choice};
    good = good && (!option || choice);
  }
  out->values = *m;
  out->values.assignments = values;
  out->values.assignment_count = value_count;
  out->law = law_with_options(out->law, choices, choice_count);
  return good;
}

static bool repeats_choice(const deck_assignment *a, const law *l, const symbol *option,
                           diagnostics *said) {
  const char *chosen = l->chosen[option->index];
  if (a->word && strcmp(a->word, chosen) == 0) return true;
  diag_report(said, DIAG_OPTION, a->value_where,
              "a region has the options of its lattice: there `%s` is '%s'", option->name, chosen);
  return false;
}

bool material_law_regional(const deck_material *m, const model *of, arena *memory,
                           deck_material *values, diagnostics *said) {
  bool good = true;
  *values = *m;
  values->assignments =
      arena_alloc(memory, ((size_t)m->assignment_count + 1) * sizeof *values->assignments);
  values->assignment_count = 0;
  for (int k = 0; k < m->assignment_count; k++) {
    const deck_assignment *a = &m->assignments[k];
    const symbol *option = find_option(of->law, a->name);
    if (option)
      good = repeats_choice(a, of->law, option, said) && good;
    else
      values->assignments[values->assignment_count++] = *a;
  }
  return good;
}

/* --- reading ---------------------------------------------------------------------------------- */

/* A deck may come from somebody else, and name a file whose lines are nobody's business: only those
 * of laws are shown. */
static char *read_law(const deck_material *m, const char *path, size_t *length, diagnostics *said) {
  char error[ERROR_LENGTH];
  char *text = read_text_file(path, MODEL_LIMIT, length, error, sizeof error);
  const span where = deck_where(&m->item, "model");
  if (!text) {
    diag_report(said, DIAG_FILE, where, "%s", error);
    return NULL;
  }
  if (parse_begins_law(text)) return text;
  diag_report(said, DIAG_FILE, where, "`%s` is not a law", path);
  diag_hint(said, "the first word of a law is `model`");
  free(text);
  return NULL;
}

bool material_law_read(const deck_material *m, const char *path, model *out, diagnostics *said) {
  size_t length;
  char *text = read_law(m, path, &length, said);
  const bool good = text && model_open_text(out, path, text, length, NULL, 0) &&
                    material_law_take_options(m, out, said);
  free(text);
  return good;
}

/* --- the lattice ------------------------------------------------------------------------------ */

law_setting material_setting(const deck_lattice *l) {
  law_setting setting = SETTING_PLANE_STRESS;
  (void)law_setting_find(l->setting, &setting);
  return setting;
}

/* Of a full family; 0 where particles stand on no lattice. */
static int neighbours_of(const deck_lattice *l) {
  bravais_neighbour list[PL_MAX_DIRECTIONS];
  bravais b;
  if (deck_lattice_is_listed(l) || !bravais_of(l, &b)) return 0;
  return 2 * bravais_family(&b, l->horizon, l->shells, list);
}

/* What a bond knows of the third direction its law must say; `for` is the word that it has. */
static void warn_of_plane_strain(const deck_lattice *l, const model *m, diagnostics *said) {
  if (m->law->setting != SETTING_PLANE_STRAIN || m->law->tree->law == LAW_STATE ||
      m->law->tree->law == LAW_CONTINUUM || m->tree->setting_count > 0)
    return;
  diag_report(
      said, DIAG_DECK_WARNING, deck_where(&l->item, "setting"),
      "the law of bonds `%s` does not say for which setting it is: its bonds may be those of "
      "plane stress",
      m->law->tree->name);
  diag_hint(said,
            "where its equations hold in plane strain, write `for plane_strain` into the law; "
            "else take another one, such as `splm_elastic`");
}

/* Exact where neighbours lack are families that know which of them do, by an operator that is made
   for it. */
static bool suits_edges(const deck_lattice *l, const model *m, diagnostics *said) {
  const char *name = m->law->tree->name;
  const span where = deck_where(&l->item, "edges");
  if (m->law->tree->law != LAW_STATE)
    diag_report(said, DIAG_CONFLICT, where,
                "`%s` is a law of bonds, and a bond does not know which others its ends lack",
                name);
  else if (!model_suits_irregular(m))
    diag_report(said, DIAG_CONFLICT, where,
                "the law `%s` is meant for whole families of a lattice: its line `for` does not "
                "name `irregular`",
                name);
  else if (!law_calls(m->law, FUNCTION_UNIFORM_FORCE) &&
           !law_calls(m->law, FUNCTION_CORRESPONDENCE))
    diag_report(said, DIAG_CONFLICT, where,
                "the law `%s` is not exact at edges: it does not make its force state by "
                "`uniform_force` or `correspondence`",
                name);
  else
    return true;
  diag_hint(said, "edges = 'lattice' runs with every law; `splm_elastic`, `splm_concrete` and "
                  "`correspondence` have exact edges");
  return false;
}

/* The law takes the setting of its lattice; without one it keeps the first that it names. */
static bool take_setting(const deck_material *m, const deck_lattice *l, model *out,
                         diagnostics *said) {
  char meant[96];
  if (!l) return true;
  const bool irregular = deck_lattice_is_listed(l);
  out->law = law_on_lattice(out->law, material_setting(l), irregular, neighbours_of(l));
  const char *name = law_setting_name(out->law->setting);
  if (l->edges == EDGES_EXACT && !suits_edges(l, out, said)) return false;
  if (out->law->irregular && !deck_lattice_is_bar(l) && !deck_lattice_is_link(l) &&
      !model_suits_irregular(out)) {
    diag_report(said, DIAG_CONFLICT, deck_where(&m->item, "model"),
                "the law `%s` is meant for lattices, but these particles are irregular",
                out->law->tree->name);
    diag_hint(said,
              "take another law such as `splm_elastic`; where the equations hold for families of "
              "any shape add `irregular` to the law's line `for`");
    return false;
  }
  if (model_suits(out, name, meant, sizeof meant)) {
    warn_of_plane_strain(l, out, said);
    return true;
  }
  diag_report(said, DIAG_CONFLICT, deck_where(&m->item, "model"),
              "the law `%s` is meant for %s, but this lattice is in %s", out->law->tree->name,
              meant, name);
  diag_hint(said,
            "take another law or setting; where the equations hold in %s, too, add it to the "
            "law's line `for`",
            name);
  return false;
}

/* A chain has the cross-section of a bar in place of a thickness, and families on one line resolve
   no strain but that along it. */
static bool suits_chain(const deck_material *m, const deck_lattice *l, const law *of,
                        diagnostics *said) {
  const char *word = deck_lattice_is_bar(l)    ? "bar"
                     : deck_lattice_is_link(l) ? "link to places"
                                               : "chain";
  const bool families = of->tree->law == LAW_STATE;
  if (!families && !law_reads(of, QUANTITY_T)) return true;
  diag_report(said, DIAG_CONFLICT, deck_where(&m->item, "model"),
              families
                  ? "the law `%s` reads whole families, but a %s has bonds along one line alone"
                  : "the law `%s` reads the thickness `t`, which a %s does not have",
              of->tree->name, word);
  diag_hint(said,
            deck_lattice_is_link(l)
                ? "take a law that reads `area`, such as `bond_slip`, or a link `to = 'sites'`"
                : "take a law of bonds that reads `area`, such as `bar` or `beam`");
  return false;
}

static bool suits_link(const deck_material *m, const law *of, diagnostics *said) {
  if (of->tree->law != LAW_STATE) return true;
  diag_report(said, DIAG_CONFLICT, deck_where(&m->item, "model"),
              "the law `%s` reads whole families, but a link has bonds between two bodies alone",
              of->tree->name);
  diag_hint(said, "take a law of bonds, such as `bar_bond`");
  return false;
}

/* A bond with slip and gap lies along a bar, as those of links to places do. Without a deck, where
   a law is looked at alone, a lattice has no keys and only stands for one. */
static bool can_slip(const deck_material *m, const deck_lattice *l, const law *of,
                     diagnostics *said) {
  if (!l->item.keys || (deck_lattice_is_link(l) && l->area > 0)) return true;
  diag_report(said, DIAG_CONFLICT, deck_where(&m->item, "model"),
              "the law `%s` is one of slip and gap, which links to places alone have",
              of->tree->name);
  diag_hint(
      said,
      deck_lattice_is_link(l)
          ? "give the link `to = 'place'`, or take another law, such as `bar_bond`"
          : "take a law that begins with `law central bond`, `law micropolar bond` or `law state`");
  return false;
}

static bool suits_section(const deck_material *m, const deck_lattice *l, const law *of,
                          diagnostics *said) {
  if (!l) return true;
  if (of->tree->law == LAW_SLIP_BOND && !can_slip(m, l, of, said)) return false;
  if (deck_lattice_is_link(l) && !suits_link(m, of, said)) return false;
  if (deck_lattice_is_chain(l) || l->area > 0) return suits_chain(m, l, of, said);
  if (!law_reads(of, QUANTITY_AREA)) return true;
  diag_report(
      said, DIAG_CONFLICT, deck_where(&m->item, "model"),
      "the law `%s` reads `area`, the cross-section of a bar, which chains and bars alone have",
      of->tree->name);
  diag_hint(said, deck_lattice_is_link(l)
                      ? "take another law, such as `bar_bond`, or a link `to = 'place'`"
                      : "give the lattice `kind = 'chain'` and an `area`, or take another law");
  return false;
}

/* --- the plan --------------------------------------------------------------------------------- */

/* The parameter of a &field in the law, or -1 after a message. */
static int find_varying(const deck_material *m, int field, const law *l, diagnostics *said) {
  const char *wanted = m->varying[field];
  const char **names = must_calloc((size_t)l->parameters.count + 1, sizeof *names);
  int found = -1;
  for (int p = 0; p < l->parameters.count; p++) {
    names[p] = l->parameters.items[p]->name;
    if (strcasecmp(names[p], wanted) == 0) found = p;
  }
  if (found < 0) {
    diag_report(said, DIAG_UNKNOWN_NAME, m->varying_where[field],
                "the law `%s` has no parameter `%s`", l->tree->name, wanted);
    diag_suggest(said, wanted, names, l->parameters.count);
  }
  free(names);
  return found;
}

static const deck_assignment *assignment_of(const deck_material *m, const symbol *parameter) {
  for (int k = 0; k < m->assignment_count; k++)
    if (strcasecmp(m->assignments[k].name, parameter->name) == 0) return &m->assignments[k];
  return NULL;
}

/* Values of parameters in a material, SI [parameters]; what is wrong with them, others say. */
static void values_in(const deck_material *m, const law *l, double *values) {
  for (int p = 0; p < l->parameters.count; p++) {
    const symbol *s = l->parameters.items[p];
    const deck_assignment *a = assignment_of(m, s);
    values[p] = a            ? a->value
                : s->follows ? law_constant_value(s->declared->value, values)
                             : (s->has_default ? s->initial : 0);
  }
}

/* Marks [parameters] those of which some region has another value than the lattice. */
static void mark_regional(const deck_material *m, const law *l, bool *marks) {
  const size_t n = (size_t)l->parameters.count + 1;
  double *values = must_calloc(2 * n, sizeof *values);
  values_in(m, l, values);
  for (int k = 0; k < m->regional_count; k++) {
    values_in(m->regional[k], l, values + n);
    for (int p = 0; p < l->parameters.count; p++)
      marks[p] = marks[p] || values[n + (size_t)p] != values[p];
  }
  free(values);
}

/* A &field names it. */
static bool has_field(const deck_material *m, const symbol *parameter) {
  for (int k = 0; k < m->varying_count; k++)
    if (strcasecmp(m->varying[k], parameter->name) == 0) return true;
  return false;
}

/* The material or one of its regions gives it by a formula or a file. */
static bool is_placed(const deck_material *m, const symbol *parameter) {
  for (int k = -1; k < m->regional_count; k++) {
    const deck_material *of = k < 0 ? m : m->regional[k];
    for (int n = 0; n < of->assignment_count; n++)
      if (of->assignments[n].placed && strcasecmp(of->assignments[n].name, parameter->name) == 0)
        return true;
  }
  return false;
}

/* The same of a field that changes in time. */
static bool changes_in_time(const deck_material *m, const symbol *parameter) {
  for (int k = -1; k < m->regional_count; k++) {
    const deck_material *of = k < 0 ? m : m->regional[k];
    for (int n = 0; n < of->assignment_count; n++)
      if (of->assignments[n].placed && deck_placed_changes(of->assignments[n].placed) &&
          strcasecmp(of->assignments[n].name, parameter->name) == 0)
        return true;
  }
  return false;
}

/* A default that follows from what differs from place to place would have to differ, too. */
static bool default_is_uniform(const deck_material *m, const law *l, int p, diagnostics *said) {
  const symbol *s = l->parameters.items[p];
  if (!s->follows || assignment_of(m, s) || has_field(m, s)) return true;
  for (int k = 0; k < p; k++) {
    const symbol *from = l->parameters.items[k];
    if (!(has_field(m, from) || is_placed(m, from)) ||
        !law_reads_parameter(s->declared->value, from))
      continue;
    diag_report(said, DIAG_CONFLICT, deck_where(&m->item, "model"),
                "`%s` follows by default from `%s`, which differs from place to place here",
                s->name, from->name);
    diag_hint(said, "give `%s` in the deck: a number, or a formula of the place of its own",
              s->name);
    return false;
  }
  return true;
}

/* The parameters that random fields, regions or formulas make differ, as the law orders them; then
   once more those that change in time. */
static bool find_variation(const deck_material *m, const deck_lattice *l, model *out,
                           law_variation *v, diagnostics *said) {
  const symbol_list *all = &out->law->parameters;
  int *varying = arena_alloc(out->memory, (2 * (size_t)all->count + 1) * sizeof *varying);
  bool good = true;
  *v = (law_variation){.varying = varying};
  for (int k = 0; k < m->varying_count; k++)
    good = find_varying(m, k, out->law, said) >= 0 && good;
  bool *regional = must_calloc((size_t)all->count + 1, sizeof *regional);
  mark_regional(m, out->law, regional);
  for (int p = 0; p < all->count && good; p++) {
    good = default_is_uniform(m, out->law, p, said);
    if (has_field(m, all->items[p]) || regional[p] || is_placed(m, all->items[p]))
      varying[v->varying_count++] = p;
  }
  for (int p = 0; p < all->count && good; p++)
    if (changes_in_time(m, all->items[p])) varying[v->varying_count + v->before_count++] = p;
  v->varying_count += v->before_count;
  free(regional);
  v->shares = m->beside && out->law->tree->law == LAW_STATE;
  v->masses = m->beside;
  v->sizes = l && l->graded;
  for (int k = 0; out->law->rho && k < v->varying_count; k++)
    v->masses = v->masses || varying[k] == out->law->rho->index;
  return good;
}

static bool reads_masses(const law *l) {
  return law_reads(l, QUANTITY_M_BOND) || law_reads(l, QUANTITY_M_END_I) ||
         law_reads(l, QUANTITY_M_END_J);
}

/* Laws of bonds run as strips on the hexagon of nearest neighbours; as laws of families on all
   other lattices, beside other laws, and where they read masses that differ. */
static bool needs_families(const deck_material *m, const deck_lattice *l, const law *of,
                           const law_variation *v) {
  if (of->tree->law == LAW_STATE || of->tree->law == LAW_CONTINUUM) return false;
  return m->beside || !bravais_is_hexagon(l) || (v->masses && reads_masses(of));
}

/* A law of cracks is that of tips, not of a body. Without a deck, where a law is looked at alone, a
   lattice has no keys and only stands for one. */
static bool is_of_bodies(const deck_material *m, const deck_lattice *l, const law *of,
                         diagnostics *said) {
  if (!l || !l->item.keys || of->tree->law != LAW_CRACK) return true;
  const bool mesh = deck_lattice_is_mesh(l);
  diag_report(said, DIAG_CONFLICT, deck_where(&m->item, "model"),
              "`%s` is a law of cracks, not one of a %s", of->tree->name, mesh ? "mesh" : "body");
  diag_hint(said,
            mesh
                ? "a `&crack` takes it; a mesh has a law that begins with `law continuum`, such as "
                  "`elastic`"
                : "a `&crack` of a mesh takes it");
  return false;
}

bool material_law_plan(const deck_material *m, const deck_lattice *l, model *out,
                       diagnostics *said) {
  law_variation v;
  if (!is_of_bodies(m, l, out->law, said)) return false;
  if (!take_setting(m, l, out, said) || !suits_section(m, l, out->law, said)) return false;
  if (!find_variation(m, l, out, &v, said)) return false;
  return l && needs_families(m, l, out->law, &v) ? model_plan_of_families(out, &v)
                                                 : model_plan_varying(out, &v);
}

bool material_law_open(const deck_material *m, const deck_lattice *l, const char *deck_path,
                       model *out, diagnostics *said) {
  char *path = model_find(m->model, deck_path);
  if (!path) {
    diag_report(said, DIAG_FILE, deck_where(&m->item, "model"), "there is no model `%s`", m->model);
    diag_hint(said, "give a path ending in .plm, or put the file beside the deck or in a folder "
                    "`models`; PERILAT_MODELS may name another folder");
    model_suggest(m->model, deck_path, said);
    return false;
  }
  const bool good = material_law_read(m, path, out, said) && material_law_plan(m, l, out, said);
  free(path);
  return good;
}
