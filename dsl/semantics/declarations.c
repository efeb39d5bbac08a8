#include "dsl/semantics/declarations.h"

#include <ctype.h>
#include <string.h>

#include "dsl/semantics/names.h"

/* Words of the deck's material group, which a law's parameters and options stand beside. */
static const char *const deck_words[] = {"name", "model", "lattice"};

/* All that the law makes of the name afterwards is not looked at. */
static bool refuse_reserved(checker *ck, const char *name, span where) {
  if (strcmp(name, "j") == 0) {
    complain(ck, DIAG_RESERVED_NAME, where, "`j` is reserved for the neighbour, as in x[j]");
    return true;
  }
  entry *found = names_find(ck, SPACE_QUANTITIES, name);
  if (!found || found->declared_at >= 0) return false;
  found->blamed = true;
  if (found->symbol.kind == SYMBOL_QUANTITY)
    complain(ck, DIAG_RESERVED_NAME, where, "`%s` is built in: %s", name, found->symbol.doc);
  else
    complain(ck, DIAG_RESERVED_NAME, where, "`%s` is built in: a setting of the lattice", name);
  const bool pi = found->symbol.kind == SYMBOL_QUANTITY && found->symbol.index == QUANTITY_PI;
  diag_hint(ck->d, pi ? "leave this line out, or choose another name" : "choose another name");
  return true;
}

/* A line `rest stretch` declares two names, `rest_stretch` and `total_stretch`. */
static bool is_of_rest(const stmt *s) {
  return s && (s->rest_of || s->total);
}

static void report_duplicate(checker *ck, const char *name, span where, const entry *first) {
  complain(ck, DIAG_DUPLICATE_NAME, where, "`%s` is declared twice", name);
  diag_note(ck->d, first->symbol.where, "first declared here");
}

/* Of two lines one is `rest stretch`. */
static void report_rest_name(checker *ck, const stmt *s, const entry *first) {
  const bool twice = is_of_rest(first->symbol.declared) && is_of_rest(s);
  const char *of = strchr(s->name, '_') + 1;
  complain(ck, DIAG_DUPLICATE_NAME, s->name_where,
           twice           ? "there is a line `rest %s` already"
           : is_of_rest(s) ? "`rest %s` declares `%s`, which is declared already"
                           : "a line `rest %s` has declared `%s`",
           of, s->name);
  if (!twice)
    diag_hint(ck->d, "choose another name for yours: `rest %s` declares `rest_%s` and `total_%s`",
              of, of, of);
  diag_note(ck->d, first->symbol.where, "declared here");
}

static entry *declare(checker *ck, symbol_kind kind, stmt *s) {
  if (!s->name || refuse_reserved(ck, s->name, s->name_where)) return NULL;
  const entry *first = names_find(ck, SPACE_QUANTITIES, s->name);
  if (first) {
    if (is_of_rest(s) || is_of_rest(first->symbol.declared))
      report_rest_name(ck, s, first);
    else
      report_duplicate(ck, s->name, s->name_where, first);
    return NULL;
  }
  entry *e = names_add(ck, SPACE_QUANTITIES, s->name,
                       (symbol){.kind = kind,
                                .name = s->name,
                                .where = s->name_where,
                                .declared = s,
                                .doc = s->doc ? s->doc : s->text});
  s->symbol = &e->symbol;
  return e;
}

static void append(checker *ck, symbol_list *list, entry *e) {
  /* The list's room is always the power of two at or above its count. */
  if ((list->count & (list->count - 1)) == 0) {
    size_t room = list->count ? 2 * (size_t)list->count : 1;
    symbol **items = arena_alloc(ck->memory, room * sizeof(symbol *));
    if (list->count) memcpy(items, list->items, (size_t)list->count * sizeof(symbol *));
    list->items = items;
  }
  e->symbol.index = list->count;
  list->items[list->count++] = &e->symbol;
}

/* Namelists do not know case, so names a deck sets must differ in more than case. Enters `what`;
   NULL after a message. */
static entry *declare_in_deck(checker *ck, const stmt *s, symbol what) {
  char *key = arena_text(ck->memory, s->name, strlen(s->name));
  for (char *c = key; *c; c++)
    *c = (char)tolower((unsigned char)*c);
  for (size_t i = 0; i < sizeof(deck_words) / sizeof(deck_words[0]); i++)
    if (strcmp(key, deck_words[i]) == 0) {
      complain(ck, DIAG_RESERVED_NAME, s->name_where, "`%s` is a word of the deck's material group",
               s->name);
      diag_hint(ck->d, "choose another name: decks do not know case");
    }
  const entry *first = names_find(ck, SPACE_DECK, key);
  if (first && first->symbol.component_of) {
    complain(ck, DIAG_DUPLICATE_NAME, s->name_where, "`%s` is the component %c of the vector `%s`",
             s->name, vector_axis(first->symbol.component), first->symbol.component_of->name);
    diag_note(ck->d, first->symbol.where, "`%s` is declared here",
              first->symbol.component_of->name);
  } else if (first && what.component_of) {
    complain(ck, DIAG_DUPLICATE_NAME, s->name_where,
             "the component %c of the vector `%s` is `%s` in decks, and so is another parameter",
             vector_axis(what.component), what.component_of->name, s->name);
    diag_note(ck->d, first->symbol.where, "`%s` is declared here", first->symbol.name);
    diag_hint(ck->d, "choose another name for one of them");
  } else if (first) {
    complain(ck, DIAG_DUPLICATE_NAME, s->name_where, "`%s` and `%s` differ only in case", s->name,
             first->symbol.name);
    diag_note(ck->d, first->symbol.where, "`%s` is declared here", first->symbol.name);
    diag_hint(ck->d, "choose another name: decks do not know case");
  } else {
    return names_add(ck, SPACE_DECK, key, what);
  }
  return NULL;
}

/* A line of its own for what the deck calls fibre_x. */
static stmt *component_line(checker *ck, const stmt *s, int k) {
  stmt *line = arena_alloc(ck->memory, sizeof *line);
  expr *zero = arena_alloc(ck->memory, sizeof *zero);
  *zero = (expr){.kind = EXPR_NUMBER, .where = s->value->where, .builtin = -1};
  *line = *s;
  line->name = arena_printf(ck->memory, "%s_%c", s->name, vector_axis(k));
  line->value = k < s->value->argument_count ? s->value->arguments[k].value : zero;
  line->next = NULL;
  return line;
}

/* Decks, kernels and checks know numbers only: the components of a vector are parameters of their
   own. The name itself keeps the index of the first. */
static void declare_components(checker *ck, const stmt *s, entry *whole) {
  whole->symbol.index = ck->law->parameters.count;
  for (int k = 0; k < VECTOR_COMPONENT_COUNT; k++) {
    stmt *line = component_line(ck, s, k);
    const char *doc = whole->symbol.doc;
    const symbol what = {.kind = SYMBOL_PARAMETER,
                         .name = line->name,
                         .where = s->name_where,
                         .declared = line,
                         .component_of = &whole->symbol,
                         .component = k,
                         .doc =
                             doc ? arena_printf(ck->memory, "%s, %c", doc, vector_axis(k)) : NULL};
    entry *e = declare_in_deck(ck, line, what);
    if (!e) { /* the law is refused */
      e = arena_alloc(ck->memory, sizeof *e);
      *e = (entry){.symbol = what, .key = line->name, .declared_at = ck->now, .rule_at = -1};
    }
    line->symbol = &e->symbol;
    append(ck, &ck->law->parameters, e);
  }
}

static void declare_parameter(checker *ck, stmt *s) {
  entry *e = declare(ck, SYMBOL_PARAMETER, s);
  if (!e) return;
  if (expr_is_vector(s->value)) {
    if (strcmp(s->name, "rho") == 0)
      complain(ck, DIAG_SHAPE, s->value->where,
               "`rho` is the mass density of the particles: a number, not a vector");
    declare_in_deck(ck, s, (symbol){.name = s->name, .where = s->name_where});
    declare_components(ck, s, e);
    return;
  }
  append(ck, &ck->law->parameters, e);
  if (strcmp(s->name, "rho") == 0) ck->law->rho = &e->symbol;
  declare_in_deck(ck, s, (symbol){.name = s->name, .where = s->name_where});
}

static void declare_option(checker *ck, stmt *s) {
  entry *e = declare(ck, SYMBOL_OPTION, s);
  if (!e) return;
  append(ck, &ck->law->options, e);
  declare_in_deck(ck, s, (symbol){.name = s->name, .where = s->name_where});
  for (int i = 0; i < s->word_count; i++) {
    if (names_find_choice(ck, &e->symbol, s->words[i]))
      complain(ck, DIAG_OPTION, s->word_where[i], "option `%s` has the choice `%s` twice", s->name,
               s->words[i]);
    names_add(ck, SPACE_CHOICES, s->words[i],
              (symbol){.kind = SYMBOL_CHOICE,
                       .name = s->words[i],
                       .where = s->word_where[i],
                       .declared = s,
                       .index = i,
                       .option = &e->symbol});
  }
}

static void declare_argument(checker *ck, stmt *s, int i, entry *e) {
  const char *name = s->words[i];
  refuse_reserved(ck, name, s->word_where[i]);
  for (int k = 0; k < i; k++)
    if (strcmp(name, s->words[k]) == 0) {
      complain(ck, DIAG_DUPLICATE_NAME, s->word_where[i], "`%s` has two arguments called `%s`",
               s->name, name);
      diag_note(ck->d, s->word_where[k], "the first one is here");
      break;
    }
  e->key = name;
  e->rule_at = -1;
  e->declared_at = ck->now;
  e->symbol = (symbol){
      .kind = SYMBOL_ARGUMENT, .name = name, .where = s->word_where[i], .declared = s, .index = i};
}

static void declare_function(checker *ck, stmt *s) {
  if (!s->name) return;
  if (builtin_function_find(s->name) >= 0) {
    complain(ck, DIAG_RESERVED_NAME, s->name_where, "`%s` is a built-in function: %s", s->name,
             builtin_functions[builtin_function_find(s->name)].meaning);
    diag_hint(ck->d, "choose another name");
    return;
  }
  const entry *first = names_find(ck, SPACE_FUNCTIONS, s->name);
  if (first) {
    report_duplicate(ck, s->name, s->name_where, first);
    return;
  }
  if (s->word_count > MOST_ARGUMENTS) {
    complain(ck, DIAG_ARGUMENTS, s->name_where, "`%s` has %d arguments; %d are the most", s->name,
             s->word_count, MOST_ARGUMENTS);
    return;
  }
  entry *e = names_add(ck, SPACE_FUNCTIONS, s->name,
                       (symbol){.kind = SYMBOL_FUNCTION,
                                .name = s->name,
                                .where = s->name_where,
                                .declared = s,
                                .rule = s,
                                .doc = s->doc ? s->doc : s->text});
  s->symbol = &e->symbol;
  e->arguments = arena_alloc(ck->memory, (size_t)s->word_count * sizeof(entry));
  for (int i = 0; i < s->word_count; i++)
    declare_argument(ck, s, i, &e->arguments[i]);
}

/* A bond that fails says so by a damage. */
static bool refuse_failure(checker *ck, const stmt *s) {
  if (ck->tree->law == LAW_CONTINUUM) return false;
  complain(ck, DIAG_LAW_KIND, s->name_where, "a %s law has no points that fail", law_word(ck));
  diag_hint(ck->d, "`failed when` belongs to `law continuum`; elsewhere a damage of 1 says it");
  return true;
}

static void declare_field(checker *ck, stmt *s) {
  if (s->failure && refuse_failure(ck, s)) return;
  entry *e = declare(ck, s->kind == STMT_STATE ? SYMBOL_STATE : SYMBOL_DAMAGE, s);
  if (!e) return;
  append(ck, &ck->law->fields, e);
  if (s->kind == STMT_DAMAGE && s->value) {
    e->rule_at = ck->now;
    e->symbol.rule = s;
  }
  if (s->failure) {
    e->symbol.doc = s->doc || s->text ? e->symbol.doc : "1 where the point has failed";
    ck->law->failed = &e->symbol;
  }
}

static void set_rule(checker *ck, stmt *s, entry *field) {
  if (field->symbol.rule) {
    complain(ck, DIAG_DUPLICATE_NAME, s->name_where, "%s `%s` has two rules",
             field->symbol.kind == SYMBOL_STATE ? "state" : "damage", s->name);
    diag_note(ck->d, field->symbol.rule->name_where, "its first rule is here");
    if (field->symbol.rule->kind == STMT_DAMAGE)
      diag_hint(ck->d, "a damage starts at 0: declare it without a value, `damage %s on ...`",
                s->name);
    else if ((field->symbol.rule->kind == STMT_RATE) != (s->kind == STMT_RATE))
      diag_hint(ck->d, "a state has a rate or a rule, not both: remove the one or the other");
    else
      diag_hint(ck->d, "join them in one rule with cases: | value when guard");
    return;
  }
  field->rule_at = ck->now;
  field->symbol.rule = s;
  s->symbol = &field->symbol;
}

static void declare_flow(checker *ck, stmt *s) {
  entry *field = s->name ? names_find(ck, SPACE_QUANTITIES, s->name) : NULL;
  const symbol_kind kind = field ? field->symbol.kind : SYMBOL_QUANTITY;
  if (kind == SYMBOL_STATE || kind == SYMBOL_DAMAGE) {
    set_rule(ck, s, field);
    return;
  }
  complain(ck, DIAG_UNKNOWN_NAME, s->name_where, "flow needs a state, but `%s` is not one",
           s->name);
  diag_hint(ck->d, "declare it above: `state %s on %s = 0`", s->name,
            is_single(ck) ? placement_name(natural_place(ck)) : "neighbour");
}

/* Of bonds, families and points; a crack has neither, and what slips is measured by its slip. */
static bool may_have_rest(checker *ck, const stmt *s) {
  const char *resting = law_resting(ck->tree->law);
  const bool named = resting && strcmp(s->rest_of, resting) == 0;
  if (named && (is_single(ck) || s->indexed)) return true;
  if (!resting)
    complain(ck, DIAG_LAW_KIND, s->name_where, "a %s law has no rest state", law_word(ck));
  else if (named)
    complain(ck, DIAG_PLACEMENT, s->name_where, "each neighbour has a rest %s", resting);
  else
    complain(ck, DIAG_LAW_KIND, s->name_where, "there is a rest state of `%s` alone, not of `%s`",
             resting, s->rest_of);
  if (resting)
    diag_hint(ck->d, "its form is `rest %s%s = ...`", resting, is_single(ck) ? "" : "[j]");
  return false;
}

static void declare_rate(checker *ck, stmt *s) {
  entry *field = s->name ? names_find(ck, SPACE_QUANTITIES, s->name) : NULL;
  const symbol_kind kind = field ? field->symbol.kind : SYMBOL_DEFINED;
  const bool refused = ck->tree->law == LAW_CRACK || kind == SYMBOL_DAMAGE;
  if (field && refused && !field->symbol.rule) { /* say no more of it */
    field->symbol.rule = s;
    field->rule_at = ck->now;
  }
  if (ck->tree->law == LAW_CRACK) {
    complain(ck, DIAG_LAW_KIND, s->name_where, "the states of a tip have no rates");
    diag_hint(ck->d, "a tip is looked at now and then: write its rule, `%s = ...`", s->name);
  } else if (kind == SYMBOL_STATE) {
    set_rule(ck, s, field);
  } else if (kind == SYMBOL_DAMAGE) {
    complain(ck, DIAG_LAW_KIND, s->name_where, "`%s` is a damage, which has no rate", s->name);
    diag_hint(ck->d,
              "let a state have the rate, and make the damage of it: `rate x = ...`, then "
              "`damage %s = x`",
              s->name);
  } else {
    complain(ck, DIAG_UNKNOWN_NAME, s->name_where, "rate needs a state, but `%s` is not one",
             s->name);
    diag_hint(ck->d, "declare it above: `state %s on %s = 0`", s->name,
              is_single(ck) ? placement_name(natural_place(ck)) : "neighbour");
  }
}

static void declare_definition(checker *ck, stmt *s) {
  if (s->rest_of && !may_have_rest(ck, s)) return;
  entry *found = s->name ? names_find(ck, SPACE_QUANTITIES, s->name) : NULL;
  if (found && (found->symbol.kind == SYMBOL_STATE || found->symbol.kind == SYMBOL_DAMAGE)) {
    set_rule(ck, s, found);
    return;
  }
  entry *e = declare(ck, SYMBOL_DEFINED, s);
  if (e) {
    e->symbol.rule = s;
    if (s->rest_of) ck->law->rest = &e->symbol, ck->rest_at = ck->now;
  } else if (found && found->symbol.kind == SYMBOL_DEFINED && !is_of_rest(s) &&
             !is_of_rest(found->symbol.declared)) {
    diag_hint(ck->d, "a name has one rule: join them with cases, | value when guard");
  }
}

static const char *const result_names[RESULT_COUNT] = {"N", "V",     "M_i",  "M_j",    "T",
                                                       "W", "sigma", "grow", "toward", "speed"};
static const stmt_kind result_kinds[RESULT_COUNT] = {
    STMT_FORCE,  STMT_FORCE,  STMT_MOMENT, STMT_MOMENT, STMT_MOMENT,
    STMT_ENERGY, STMT_STRESS, STMT_GROW,   STMT_TOWARD, STMT_SPEED};

static void report_result_name(checker *ck, const stmt *s) {
  const char *kind = stmt_kind_name(s->kind);
  const char *const forces[] = {[LAW_CENTRAL_BOND] = "`N`",
                                [LAW_MICROPOLAR_BOND] = "`N` (along the bond) or `V` (across it)",
                                [LAW_SLIP_BOND] = "`N` (along the bar) or `V` (across it)"};
  const char *names = s->kind == STMT_ENERGY   ? "`W`"
                      : s->kind == STMT_MOMENT ? "`M_i` or `M_j` (bending), or `T` (twisting)"
                                               : forces[ck->tree->law];
  complain(ck, DIAG_LAW_KIND, s->name_where, "the %s of a bond law is called %s", kind, names);
  ck->result_refused = true;
}

static bool is_given_twice(checker *ck, const stmt *s, int which) {
  const symbol *first = ck->law->results[which];
  if (!first) return false;
  complain(ck, DIAG_DUPLICATE_NAME, s->name_where, "`%s` is given twice",
           stmt_words(ck->memory, s));
  diag_note(ck->d, first->where, "first given here");
  return true;
}

/* `stress sigma` and `energy W` are what a continuum gives; stresses and strains of other names are
   only names. */
static void declare_continuum_result(checker *ck, stmt *s) {
  const bool energy = s->kind == STMT_ENERGY,
             tensor = s->kind == STMT_STRESS || s->kind == STMT_STRAIN;
  const int which = energy ? RESULT_W : RESULT_SIGMA;
  const bool given = result_kinds[which] == s->kind && strcmp(result_names[which], s->name) == 0;
  if (!given && !tensor) {
    complain(ck, DIAG_LAW_KIND, s->name_where,
             energy ? "the energy of a continuum law is called `W`" : "a continuum law has no %s",
             stmt_kind_name(s->kind));
    if (!energy) diag_hint(ck->d, "a continuum law gives `stress sigma = ...` or `energy W = ...`");
    ck->result_refused = true;
    return;
  }
  if (given && is_given_twice(ck, s, which)) return;
  entry *e = declare(ck, given ? SYMBOL_RESULT : SYMBOL_DEFINED, s);
  if (!e) return;
  e->symbol.rule = s;
  if (!given) return;
  e->symbol.index = which;
  ck->law->results[which] = &e->symbol;
}

/* `force V` stands beside the volume V of the particle, so it cannot be read by its name. */
static void declare_bond_result(checker *ck, stmt *s) {
  int which = 0;
  while (which < RESULT_COUNT &&
         (result_kinds[which] != s->kind || strcmp(result_names[which], s->name) != 0))
    which++;
  const bool central = ck->tree->law == LAW_CENTRAL_BOND, slip = ck->tree->law == LAW_SLIP_BOND;
  if (slip && s->kind == STMT_MOMENT) {
    complain(ck, DIAG_LAW_KIND, s->name_where, "a law of slip has no moments");
    diag_hint(ck->d, "the moment of `N` and `V` is balanced on bar and body by itself");
    ck->result_refused = true;
    return;
  }
  if (central && (s->kind == STMT_MOMENT || which == RESULT_V)) {
    complain(ck, DIAG_LAW_KIND, s->name_where, "a central law has no %s",
             which == RESULT_V ? "shear force" : "moments");
    diag_hint(ck->d, "begin with `law micropolar bond`");
    return;
  }
  if (which == RESULT_COUNT) {
    report_result_name(ck, s);
    return;
  }
  if (is_given_twice(ck, s, which)) return;
  symbol what = {.kind = SYMBOL_RESULT,
                 .name = s->name,
                 .where = s->name_where,
                 .declared = s,
                 .rule = s,
                 .doc = s->doc ? s->doc : s->text};
  entry *e;
  if (which == RESULT_V) {
    e = arena_alloc(ck->memory, sizeof(entry));
    *e = (entry){.symbol = what, .key = s->name, .declared_at = ck->now, .rule_at = -1};
    s->symbol = &e->symbol;
  } else {
    e = declare(ck, SYMBOL_RESULT, s);
    if (!e) return;
    e->symbol.rule = s;
  }
  e->symbol.index = which;
  ck->law->results[which] = &e->symbol;
}

/* `grow`, `toward` and `speed` are no names that others could read. */
static void declare_tip_result(checker *ck, stmt *s) {
  int which = RESULT_GROW;
  while (result_kinds[which] != s->kind)
    which++;
  if (ck->tree->law != LAW_CRACK) {
    complain(ck, DIAG_LAW_KIND, s->name_where, "a %s law has no `%s`", law_word(ck), s->name);
    diag_hint(ck->d, "it belongs to what a tip does: between `crack` and `end crack`");
    return;
  }
  if (is_given_twice(ck, s, which)) return;
  entry *e = arena_alloc(ck->memory, sizeof(entry));
  *e = (entry){.symbol = {.kind = SYMBOL_RESULT,
                          .name = s->name,
                          .where = s->name_where,
                          .declared = s,
                          .rule = s,
                          .index = which},
               .key = s->name,
               .declared_at = ck->now,
               .rule_at = -1};
  s->symbol = &e->symbol;
  ck->law->results[which] = &e->symbol;
}

static void report_kind_of_result(checker *ck, const stmt *s) {
  complain(ck, DIAG_LAW_KIND, s->name_where, "a %s law has no %s", law_word(ck),
           stmt_kind_name(s->kind));
  if (!is_single(ck))
    diag_hint(ck->d, "a state law gives `force state F[j] = ...`");
  else if (s->kind == STMT_FORCE_STATE)
    diag_hint(ck->d, "a bond law gives `force N = ...`");
  else
    diag_hint(ck->d, "stress and strain belong to a particle's family: begin with `law state`");
}

static void declare_result(checker *ck, stmt *s) {
  if (!s->name) return;
  if (ck->tree->law == LAW_CONTINUUM) {
    declare_continuum_result(ck, s);
    return;
  }
  if (ck->tree->law == LAW_CRACK) {
    complain(ck, DIAG_LAW_KIND, s->name_where, "a law of cracks gives no %s",
             stmt_kind_name(s->kind));
    diag_hint(ck->d, "it says `grow when ...`, `toward ...` and `speed ...`");
    ck->result_refused = true;
    return;
  }
  bool of_family = s->kind == STMT_FORCE_STATE || s->kind == STMT_STRESS || s->kind == STMT_STRAIN;
  if (!of_family && is_single(ck)) {
    declare_bond_result(ck, s);
    return;
  }
  bool refused = of_family == is_single(ck) && s->kind != STMT_ENERGY;
  ck->result_refused |= refused;
  if (refused) report_kind_of_result(ck, s);
  bool result = s->kind == STMT_FORCE_STATE || s->kind == STMT_ENERGY;
  entry *e = declare(ck, result ? SYMBOL_RESULT : SYMBOL_DEFINED, s);
  if (!e) return;
  e->symbol.rule = s;
  e->refused = refused;
  e->symbol.index = s->kind == STMT_ENERGY ? RESULT_W : RESULT_COUNT;
  if (s->kind == STMT_ENERGY && !ck->law->results[RESULT_W])
    ck->law->results[RESULT_W] = &e->symbol;
}

static void declare_output(checker *ck, stmt *s) {
  entry *e = declare(ck, SYMBOL_OUTPUT, s);
  if (!e) return;
  e->symbol.rule = s;
  append(ck, &ck->law->outputs, e);
}

static void declare_ruled(checker *ck, stmt *s) {
  entry *e = declare(ck, s->kind == STMT_CONSTANT ? SYMBOL_CONSTANT : SYMBOL_DEFINED, s);
  if (e) e->symbol.rule = s;
}

/* What is meant is of use to readers by its reason alone. */
static bool says_why(checker *ck, const stmt *s) {
  if (!s->text || s->text[strspn(s->text, " \t")]) return true;
  const bool accepts = s->kind == STMT_ACCEPT;
  complain(ck, DIAG_LAW_KIND, s->where, "`%s%s` says no reason", accepts ? "accept " : "",
           accepts ? s->name : "nonconservative");
  diag_hint(ck->d, "say in the text why the law means it");
  return false;
}

static void declare_nonconservative(checker *ck, stmt *s) {
  if (ck->law->nonconservative)
    complain(ck, DIAG_DUPLICATE_NAME, s->where, "`nonconservative` is written twice");
  says_why(ck, s);
  ck->law->nonconservative = s->text ? s->text : "";
}

static bool find_check(const char *name, diag_code *code) {
  for (int k = 0; k < DIAG_COUNT; k++)
    if (strcmp(name, diag_name((diag_code)k)) == 0) {
      *code = (diag_code)k;
      return true;
    }
  return false;
}

static void refuse_accepted(checker *ck, const stmt *s, bool found) {
  const char *checks[DIAG_COUNT];
  int count = 0;
  for (int k = 0; k < DIAG_COUNT; k++)
    if (diag_may_be_accepted((diag_code)k)) checks[count++] = diag_name((diag_code)k);
  if (found)
    complain(ck, DIAG_LAW_KIND, s->name_where,
             "`%s` is no check of mechanics: what it finds cannot be accepted", s->name);
  else
    complain(ck, DIAG_LAW_KIND, s->name_where, "there is no check `%s`", s->name);
  const char *nearest = found ? NULL : nearest_name(s->name, checks, count);
  if (nearest)
    diag_hint(ck->d, "did you mean `%s`?", nearest);
  else
    diag_hint(ck->d, "the code in brackets behind a message of mechanics, such as `patch`");
}

/* accept CHECK "why" */
static void declare_accepted(checker *ck, stmt *s) {
  diag_code code = DIAG_COUNT;
  if (strcmp(s->name, "nonconservative") == 0) {
    declare_nonconservative(ck, s);
    return;
  }
  const bool found = find_check(s->name, &code);
  if (!found || !diag_may_be_accepted(code)) {
    refuse_accepted(ck, s, found);
    return;
  }
  law *l = ck->law;
  if (law_accepts(l, code)) {
    complain(ck, DIAG_DUPLICATE_NAME, s->name_where, "`%s` is accepted twice", s->name);
    return;
  }
  if (!says_why(ck, s)) return;
  l->waivers[l->waiver_count++] = (law_waiver){code, s->text, s->where};
}

/* What a deck sets has its bounds in its own line; of what it does not, only cells have a size. */
static void declare_required(checker *ck, const stmt *s) {
  if (!s->name) return;
  const char *size = builtin_quantities[QUANTITY_CELL_SIZE].name;
  if (ck->tree->law != LAW_CONTINUUM || strcmp(s->name, size) != 0) {
    complain(ck, DIAG_LAW_KIND, s->name_where, "`require` is of the size `%s` of cells alone",
             size);
    diag_hint(ck->d,
              ck->tree->law == LAW_CONTINUUM
                  ? "bounds of a parameter stand in its own line: `parameter x = 1 in (0, 2)`"
                  : "only a law of a continuum knows cells");
  } else if (ck->law->sized) {
    complain(ck, DIAG_DUPLICATE_NAME, s->name_where, "`%s` is required twice", size);
    diag_note(ck->d, ck->law->sized->name_where, "first required here");
  } else {
    ck->law->sized = s;
  }
}

static void declare_one(checker *ck, stmt *s) {
  switch (s->kind) {
  case STMT_PARAMETER:
  case STMT_FIELD:
    declare_parameter(ck, s);
    break;
  case STMT_OPTION:
    declare_option(ck, s);
    break;
  case STMT_FUNCTION:
    declare_function(ck, s);
    break;
  case STMT_STATE:
  case STMT_DAMAGE:
    declare_field(ck, s);
    break;
  case STMT_DEFINITION:
    declare_definition(ck, s);
    break;
  case STMT_FLOW:
    declare_flow(ck, s);
    break;
  case STMT_RATE:
    declare_rate(ck, s);
    break;
  case STMT_FORCE:
  case STMT_FORCE_STATE:
  case STMT_MOMENT:
  case STMT_ENERGY:
  case STMT_STRESS:
  case STMT_STRAIN:
    declare_result(ck, s);
    break;
  case STMT_OUTPUT:
    declare_output(ck, s);
    break;
  case STMT_CONSTANT:
  case STMT_YIELD:
    declare_ruled(ck, s);
    break;
  case STMT_GROW:
  case STMT_TOWARD:
  case STMT_SPEED:
    declare_tip_result(ck, s);
    break;
  case STMT_NONCONSERVATIVE:
    declare_nonconservative(ck, s);
    break;
  case STMT_ACCEPT:
    declare_accepted(ck, s);
    break;
  case STMT_REQUIRE:
    declare_required(ck, s);
    break;
  case STMT_INCLUDE:
  case STMT_COUNT:
    break;
  }
}

/* In decks and results fibre_x is the component of the vector `fibre`; a name for a value of the
   step, as in `fibre_x = fibre[x]`, is seen by neither. */
static void refuse_names_of_components(checker *ck) {
  for (int k = 0; k < ck->law->parameters.count; k++) {
    const symbol *part = ck->law->parameters.items[k];
    const entry *other = part->component_of ? names_find(ck, SPACE_QUANTITIES, part->name) : NULL;
    if (!other || other->symbol.kind == SYMBOL_DEFINED || other->symbol.kind == SYMBOL_PARAMETER)
      continue; /* another parameter of that name has been refused */
    complain(ck, DIAG_DUPLICATE_NAME, other->symbol.where,
             "`%s` is what the component %c of the vector `%s` is called in decks", part->name,
             vector_axis(part->component), part->component_of->name);
    diag_note(ck->d, part->where, "`%s` is declared here", part->component_of->name);
  }
}

void declare_names(checker *ck) {
  for (int i = 0; i < ck->statement_count; i++) {
    ck->now = i;
    declare_one(ck, ck->statements[i]);
  }
  refuse_names_of_components(ck);
}
