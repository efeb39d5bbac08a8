/* perilat build: a law to a shared kernel; a deck to a stand-alone solver, which is the runtime
   with deck, law and kernel built in. Running a solver needs no compiler. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "dsl/semantics/law_variant.h"
#include "generator/command/commands.h"
#include "generator/drive/drive_grammar.h"
#include "generator/kernel/document.h"
#include "generator/kernel/material_law.h"
#include "generator/kernel/model.h"
#include "generator/kernel/toolchain_compiler.h"
#include "generator/lower/lowered.h"
#include "generator/run/run.h"
#include "generator/sense/sense.h"
#include "generator/study/study_request.h"
#include "generator/target/c_text.h"
#include "runtime/deck/deck_read.h"

#define ERROR_LENGTH 8192

enum { BUILD_FAILED = 2 };

static bool spares_input(const char *output, const char *input) {
  if (!same_file(output, input)) return true;
  say_error("the output `%s` would overwrite `%s`; give it another name with -o", output, input);
  return false;
}

static bool names(const model *m, const char *word, size_t length) {
  for (int k = 0; k < m->tree->setting_count; k++)
    if (strncmp(m->tree->settings[k], word, length) == 0 && !m->tree->settings[k][length])
      return true;
  return false;
}

static bool refuse_use(const model *m, const char *word, size_t length) {
  c_text named = {NULL, 0, 0};
  for (int k = 0; k < m->tree->setting_count; k++)
    c_text_add(&named, "%s%s", k ? ", " : " names ", m->tree->settings[k]);
  say_error("the law `%s` is not for `%.*s`: %s%s", m->law->tree->name, (int)length, word,
            named.text ? "its line `for`" : "it has no line `for`", named.text ? named.text : "");
  free(named.text);
  return false;
}

/* What the kernel is for, words of the law's line `for`: the setting of the lattices, or
   `irregular` particles. NULL: its first setting. */
static bool take_uses(model *m, const char *words) {
  law_setting setting = m->law->setting;
  bool irregular = false;
  int settings = 0;
  while (words) {
    const size_t length = strcspn(words, ",");
    if (!names(m, words, length)) return refuse_use(m, words, length);
    irregular = irregular || strncmp(LAW_IRREGULAR, words, length) == 0;
    for (int k = SETTING_PLANE_STRESS; k <= SETTING_SPACE; k++)
      if (strncmp(law_setting_name((law_setting)k), words, length) == 0)
        setting = (law_setting)k, settings++;
    words = words[length] ? words + length + 1 : NULL;
  }
  if (settings > 1) say_error("`--for` takes one setting: each has a kernel of its own");
  m->law = law_on_lattice(m->law, setting, irregular, 0);
  return settings <= 1;
}

/* With all that a host of its own may ask for: fields of the law, too, have arrays. */
static bool plan_law(model *m, bool no_physics) {
  const symbol_list *list = &m->law->parameters;
  int *given = arena_alloc(m->memory, ((size_t)list->count + 1) * sizeof *given);
  law_variation v = {.alone = true, .varying = given};
  for (int k = 0; k < list->count; k++)
    if (symbol_is_field(list->items[k])) given[v.varying_count++] = k;
  const law *regular = law_on_lattice(m->law, m->law->setting, false, 0);
  const bool planned =
      m->law->irregular ? model_plan_of_families(m, &v) : model_plan_varying(m, &v);
  return planned && (no_physics || law_is_sound(regular, NULL, &m->said, NULL));
}

/* 0, or an exit status. */
static int build_law(const char *path, const char *output, const char *uses, bool no_physics) {
  model m;
  char error[ERROR_LENGTH], chosen[512];
  bool good = model_open(&m, path, NULL, 0) && take_uses(&m, uses) && plan_law(&m, no_physics);
  diag_print(&m.said, stderr);
  if (good) {
    snprintf(chosen, sizeof chosen, "%s.so", m.law->tree->name);
    output = output ? output : chosen;
  }
  int status = good && spares_input(output, path) ? 0 : INPUT_WRONG;
  if (!status && !toolchain_build(model_c_text(&m), output, error, sizeof error)) {
    say_error("%s", error);
    status = BUILD_FAILED;
  }
  if (!status) printf("written %s (key %s)\n", output, model_key(&m));
  model_close(&m);
  return status;
}

/* --- solvers ---------------------------------------------------------------------------------- */

/* What the deck's lattices are made of, with their options decided, and the tables of the deck's
   loads. */
typedef struct deck_law {
  const char *owner; /* name of the interaction, or of the crack as BUILT_IN_CRACK */
  const deck_material *material;
  model model;
  bool opened;
  c_text choices; /* ";option=choice;..." */
} deck_law;

typedef struct deck_laws {
  arena *memory;
  source_set sources;
  const deck *deck;
  deck_law *items; /* [count] */
  int count;
} deck_laws;

static void list_choices(const law *l, c_text *out) {
  c_text_add(out, ";");
  for (int k = 0; k < l->options.count; k++)
    c_text_add(out, "%s=%s;", l->options.items[k]->name, l->chosen[k]);
}

/* Those of interactions have a lattice, those of cracks none. */
static bool open_deck_law(const char *owner, const deck_material *material,
                          const deck_lattice *lattice, const char *deck_path, deck_law *l,
                          diagnostics *said) {
  l->owner = owner;
  l->material = material;
  const bool good = material_law_open(material, lattice, deck_path, &l->model, said);
  l->opened = l->model.memory != NULL;
  if (good) list_choices(l->model.law, &l->choices);
  return good;
}

static bool open_all(const deck *k, const char *deck_path, deck_laws *out, diagnostics *said) {
  bool good = true;
  for (int n = 0; n < k->interaction_count; n++) {
    const deck_interaction *of = &k->interactions[n];
    good = open_deck_law(of->name, of->material, &k->lattices[of->lattice], deck_path,
                         &out->items[out->count++], said) &&
           good;
  }
  for (int n = 0; n < k->crack_count; n++) {
    const deck_crack *c = &k->cracks[n];
    if (!c->model) continue;
    const char *name = arena_printf(out->memory, BUILT_IN_CRACK, c->name);
    good =
        open_deck_law(name, &c->material, NULL, deck_path, &out->items[out->count++], said) && good;
  }
  return good;
}

/* The deck has been checked whole before: its warnings are not said again. */
static bool open_deck_laws(const char *deck_path, const char *deck_text, deck_laws *out) {
  diagnostics said;
  out->memory = arena_new();
  diag_begin(&said, &out->sources);
  int file = source_add(&out->sources, deck_path, deck_text, strlen(deck_text));
  const deck *k = deck_read(out->memory, &out->sources, file, NULL, 0, &said);
  const int most = k ? k->interaction_count + k->crack_count : 0;
  out->deck = k;
  out->items = must_calloc((size_t)most + 1, sizeof *out->items);
  const bool good = k && open_all(k, deck_path, out, &said);
  if (!good) diag_print(&said, stderr);
  diag_clear(&said);
  return good;
}

static void close_deck_laws(deck_laws *l) {
  for (int n = 0; n < l->count; n++) {
    if (l->items[n].opened) model_close(&l->items[n].model);
    free(l->items[n].choices.text);
  }
  free(l->items);
  source_clear(&l->sources);
  if (l->memory) arena_free(l->memory);
}

static void put_string(c_text *out, const char *name, const char *text) {
  c_text_add(out, "static const char %s[] = ", name);
  c_text_string(out, text);
  c_text_add(out, ";\n");
}

static void put_string_of(c_text *out, const char *name, int number, const char *text) {
  char numbered[64];
  snprintf(numbered, sizeof numbered, "%s_%d", name, number);
  put_string(out, numbered, text);
}

static const char solver_types[] =
    "typedef struct pl_law pl_law;\n"
    "typedef struct built_in_law {\n  const char *interaction, *model;\n  const pl_law *law;\n"
    "  const char *law_text, *c_text;\n  const char *choices;\n"
    "  const char *compiler, *flags;\n} built_in_law;\n"
    "typedef struct built_in_file {\n  const char *path, *text;\n} built_in_file;\n"
    "int perilat_solver_main(int argc, char **argv, const char *deck_name, const char *deck_text,\n"
    "                        const built_in_law *laws, int law_count,\n"
    "                        const built_in_file *files, int file_count);\n";

static void put_main(c_text *out, int laws) {
  c_text_add(out, "int main(int argc, char **argv) {\n  const built_in_law laws[] = {\n");
  for (int n = 0; n < laws; n++)
    c_text_add(out,
               "      {solver_interaction_%d, solver_model_%d, perilat_kernel_%d(), "
               "solver_law_text_%d,\n       solver_kernel_text_%d, solver_choices_%d, "
               "solver_compiler, solver_flags},\n",
               n, n, n, n, n, n);
  c_text_add(out,
             "  };\n  return perilat_solver_main(argc, argv, solver_deck_name, solver_deck, laws, "
             "%d,\n                             solver_files, solver_file_count);\n}\n",
             laws);
}

/* The tables of the loads; C wants one in an array. */
static void put_files(c_text *out, const deck_laws *l) {
  c_text_add(out,
             "static const int solver_file_count = %d;\n"
             "static const built_in_file solver_files[] = {\n",
             l->deck->file_count);
  for (int k = 0; k < l->deck->file_count; k++) {
    const source *s = &l->sources.items[l->deck->files[k].source];
    c_text_add(out, "  {");
    c_text_string(out, s->name);
    c_text_add(out, ", ");
    c_text_string(out, s->text);
    c_text_add(out, "},\n");
  }
  c_text_add(out, "  {0, 0}};\n");
}

static void put_law(c_text *out, int n, deck_law *l) {
  c_text_add(out, "const pl_law *perilat_kernel_%d(void);\n", n);
  put_string_of(out, "solver_interaction", n, l->owner);
  put_string_of(out, "solver_model", n, l->material->model);
  put_string_of(out, "solver_law_text", n, l->model.sources.items[0].text);
  put_string_of(out, "solver_kernel_text", n, model_c_text(&l->model));
  put_string_of(out, "solver_choices", n, l->choices.text);
}

/* Each kernel's C, a part for itself, and a main() that hands everything to the runtime.
   malloc'ed. */
static char *solver_text(deck_laws *l, const char *deck_name, const char *deck_text) {
  c_text out = {NULL, 0, 0};
  char compiler[512];
  for (int n = 0; n < l->count; n++)
    c_text_add(&out,
               "#if PL_SOLVER_PART == %d\n#define perilat_kernel perilat_kernel_%d\n%s\n#endif\n",
               n + 1, n, model_c_text(&l->items[n].model));
  c_text_add(&out, "#if PL_SOLVER_PART == 0\n/* --- the solver --- */\n\n%s", solver_types);
  put_string(&out, "solver_deck_name", deck_name);
  put_string(&out, "solver_deck", deck_text);
  for (int n = 0; n < l->count; n++)
    put_law(&out, n, &l->items[n]);
  put_files(&out, l);
  toolchain_version(compiler, sizeof compiler);
  put_string(&out, "solver_compiler", compiler);
  put_string(&out, "solver_flags", toolchain_flags());
  put_main(&out, l->count);
  c_text_add(&out, "#endif\n");
  return out.text;
}

static bool spares_all(const char *output, const deck_laws *l) {
  bool good = true;
  for (int n = 0; good && n < l->count; n++)
    good = spares_input(output, l->items[n].model.path);
  for (int k = 0; good && k < l->deck->file_count; k++)
    good = spares_input(output, l->sources.items[l->deck->files[k].source].name);
  return good;
}

static int link_solver(const char *path, const char *deck_text, const char *output) {
  char error[ERROR_LENGTH];
  deck_laws l = {.count = 0};
  int status = open_deck_laws(path, deck_text, &l) && spares_all(output, &l) ? 0 : INPUT_WRONG;
  if (!status) {
    char *text = solver_text(&l, path, deck_text);
    if (!toolchain_build_program(text, l.count + 1, output, error, sizeof error)) {
      say_error("%s", error);
      status = BUILD_FAILED;
    }
    free(text);
  }
  if (!status) printf("written %s: runs the deck %s without a compiler\n", output, path);
  close_deck_laws(&l);
  return status;
}

/* What perilat run would refuse is refused now, not when the solver runs. */
static int build_solver(const char *path, const char *output, bool no_physics) {
  char error[ERROR_LENGTH];
  size_t length;
  char *deck_text = read_text_file(path, DECK_LIMIT, &length, error, sizeof error);
  if (!deck_text) {
    say_error("%s", error);
    return INPUT_WRONG;
  }
  int status = INPUT_WRONG;
  if (!output)
    say_error("a solver needs a name: perilat build deck.nml -o solver");
  else if (spares_input(output, path))
    status =
        run_deck(&(run_options){.deck_path = path, .check_only = true, .no_physics = no_physics});
  if (!status) status = link_solver(path, deck_text, output);
  free(deck_text);
  return status;
}

int command_build(int argc, char **argv) {
  bool no_physics = false;
  const char *path = NULL, *output = NULL, *uses = NULL, *value;
  int bad = 0;
  for (int at = 0; at < argc && !bad;) {
    if ((value = option_value(argc, argv, &at, "-o", &bad)))
      output = value;
    else if ((value = option_value(argc, argv, &at, "--for", &bad)))
      uses = value;
    else if (option_flag(argv, &at, "--no-physics"))
      no_physics = true;
    else if (argv[at][0] == '-')
      bad = option_unknown("build", argv[at]);
    else if (path) {
      say_error("`perilat build` takes one file; `%s` is a second one", argv[at]);
      bad = 1;
    } else
      path = argv[at++];
  }
  if (bad) return 1;
  if (!path) {
    say_error("`perilat build` needs a law or a deck");
    return 1;
  }
  const file_kind kind = kind_of_file(path);
  if (!file_suits(path, FILES(LAW) | FILES(DECK), "perilat build", "a law or a deck")) return 1;
  if (kind == FILE_DECK && (drive_refuse_path("build", path) || study_refuse("build", path)))
    return 1;
  if (kind == FILE_DECK && uses) {
    say_error("`--for` says what the kernel of a law is for; a deck says that by its lattices");
    return 1;
  }
  if (kind == FILE_DECK) return build_solver(path, output, no_physics);
  char *found = model_find(path, NULL);
  int status = build_law(found ? found : path, output, uses, no_physics);
  free(found);
  return status;
}
