/* A text's lines in their order: model, law, declarations, end; and the texts it includes. */
#include "dsl/syntax/parse.h"

#include <locale.h>
#include <stdlib.h>
#include <string.h>

#include "dsl/syntax/parser.h"

static void complain(parsing *p, span where, const char *message, const char *hint) {
  if (!first_complaint(p)) return;
  diag_report(p->messages, DIAG_SYNTAX, where, "%s", message);
  diag_hint(p->messages, "%s", hint);
}

static bool is_included(const parsing *p) {
  return p->chain.depth > 0;
}

/* True when a line may stand here: after the model line and before the end. Says so once a text. */
static bool inside_model(parsing *p, span where) {
  if (is_included(p) || (p->model_seen && !p->ended)) return true;
  if (p->out_of_model || !first_complaint(p)) return false;
  p->out_of_model = true;
  if (p->ended) {
    diag_report(p->messages, DIAG_SYNTAX, where, "there is text after `end model`");
    diag_hint(p->messages, "`end model` is the last line; a file holds one model");
  } else {
    diag_report(p->messages, DIAG_SYNTAX, where, "the file does not begin with its model line");
    diag_hint(p->messages, "write `model my_law` above this line");
  }
  return false;
}

/* True when the line is one that an included text cannot have. */
static bool refuse_in_include(parsing *p, span where) {
  if (!is_included(p)) return false;
  if (first_complaint(p)) {
    diag_report(p->messages, DIAG_INCLUDE, where,
                "an included text holds functions and constants only");
    diag_note(p->messages, p->chain.where, "it is included here");
    diag_hint(p->messages, "this line belongs into the model file");
  }
  return true;
}

void line_model(parsing *p, word name) {
  if (refuse_in_include(p, p->lex.first_where)) return;
  if (p->model_seen) {
    if (!p->ended)
      complain(p, p->lex.first_where, "this is a second model line", "a file holds one model");
    else
      inside_model(p, p->lex.first_where);
    return;
  }
  p->model_seen = true;
  p->model->name = name.text;
  p->model->name_where = name.where;
  p->model->doc = p->lex.doc;
}

void line_end(parsing *p, word of, word name, span where) {
  if (refuse_in_include(p, where) || !inside_model(p, where)) return;
  p->ended = true;
  if (!of.text || strcmp(of.text, "model") != 0) {
    complain(p, where, "only a model ends here", "write `end model`");
  } else if (name.text && strcmp(name.text, p->model->name) != 0 && first_complaint(p)) {
    diag_report(p->messages, DIAG_SYNTAX, name.where, "the model that ends here is `%s`, not `%s`",
                p->model->name, name.text);
    diag_note(p->messages, p->model->name_where, "it begins here");
  }
}

static bool find_law(const char *first, const char *second, law_kind *kind) {
  static const struct {
    const char *first, *second;
    law_kind kind;
  } laws[] = {{"central", "bond", LAW_CENTRAL_BOND},
              {"micropolar", "bond", LAW_MICROPOLAR_BOND},
              {"state", NULL, LAW_STATE}};
  for (size_t i = 0; i < sizeof laws / sizeof laws[0]; i++) {
    if (strcmp(first, laws[i].first) != 0 || !laws[i].second != !second) continue;
    if (second && strcmp(second, laws[i].second) != 0) continue;
    *kind = laws[i].kind;
    return true;
  }
  return false;
}

void line_law(parsing *p, word first, word second, span where) {
  if (refuse_in_include(p, p->lex.first_where) || !inside_model(p, where)) return;
  if (p->law_seen) {
    if (!first_complaint(p)) return;
    diag_report(p->messages, DIAG_SYNTAX, where, "the kind of law is given twice");
    diag_note(p->messages, p->model->law_where, "it is given here already");
    return;
  }
  p->law_seen = true;
  p->model->law_where = where;
  if (!find_law(first.text, second.text, &p->model->law))
    complain(p, where, "there is no such kind of law",
             "write `law central bond`, `law micropolar bond` or `law state`");
}

void line_settings(parsing *p, const words *list, span where) {
  static const char *const known[] = {"plane_stress", "plane_strain", "space", LAW_IRREGULAR};
  if (refuse_in_include(p, where) || !inside_model(p, where)) return;
  if (p->setting_seen) {
    complain(p, where, "the settings are given twice", "put them all into one `for` line");
    return;
  }
  p->setting_seen = true;
  for (int i = 0; i < list->count; i++) {
    bool found = false;
    for (size_t k = 0; k < sizeof known / sizeof *known; k++)
      found |= strcmp(list->items[i], known[k]) == 0;
    if (found || !first_complaint(p)) continue;
    diag_report(p->messages, DIAG_SYNTAX, list->where[i], "there is no setting `%s`",
                list->items[i]);
    diag_hint(p->messages, "the settings are plane_stress, plane_strain, space and " LAW_IRREGULAR);
  }
  p->model->settings = list->items;
  p->model->setting_where = list->where;
  p->model->setting_count = list->count;
}

static void read_included(parsing *p, const stmt *s);

void line_statement(parsing *p, stmt *s, word text, span where) {
  if (!inside_model(p, where)) return;
  bool shared = s->kind == STMT_FUNCTION || s->kind == STMT_CONSTANT || s->kind == STMT_INCLUDE;
  if (!shared && refuse_in_include(p, where)) return;
  s->where = where;
  s->text = text.text;
  s->text_where = text.where;
  *p->tail = s;
  p->tail = &s->next;
  if (s->kind == STMT_INCLUDE) read_included(p, s);
}

/* A line that was meant as model, law or end line counts as such: one slip, one message. */
void line_broken(parsing *p) {
  if (!p->model_seen) p->out_of_model = true;
  switch (p->lex.first) {
  case T_MODEL:
    p->model_seen = true;
    break;
  case T_LAW:
    p->law_seen = true;
    break;
  case T_END:
    p->ended = p->model_seen;
    break;
  default:
    break;
  }
}

static bool chain_holds(const include_chain *c, const char *name) {
  for (; c; c = c->outer)
    if (strcmp(c->name, name) == 0) return true;
  return false;
}

/* "a.plm includes b.plm includes a.plm" */
static const char *chain_text(arena *memory, const include_chain *c, const char *last) {
  const char *text = last;
  for (; c; c = c->outer)
    text = arena_printf(memory, "%s includes %s", c->name, text);
  return text;
}

static bool already_included(const include_list *list, const char *name) {
  for (int i = 0; i < list->count; i++)
    if (strcmp(list->names[i], name) == 0) return true;
  return false;
}

static bool include_allowed(parsing *p, const stmt *s, const char *found) {
  if (chain_holds(&p->chain, found)) {
    diag_report(p->messages, DIAG_INCLUDE, s->text_where, "a text cannot include itself");
    diag_hint(p->messages, "%s", chain_text(p->memory, &p->chain, found));
    return false;
  }
  if (p->chain.depth >= INCLUDE_DEEPEST) {
    diag_report(p->messages, DIAG_INCLUDE, s->text_where, "more than %d texts include one another",
                INCLUDE_DEEPEST);
    diag_hint(p->messages, "%s", chain_text(p->memory, &p->chain, found));
    return false;
  }
  if (p->included->count >= INCLUDE_MOST) {
    diag_report(p->messages, DIAG_INCLUDE, s->text_where, "a model includes at most %d texts",
                INCLUDE_MOST);
    return false;
  }
  return true;
}

static bool text_acceptable(const source_set *sources, int file, diagnostics *d) {
  const source *s = &sources->items[file];
  span start = {0, 0, (uint16_t)file};
  if (s->length > TEXT_LONGEST) {
    diag_report(d, DIAG_TOO_LONG, start, "the text has %zu bytes; a model may have up to %d",
                s->length, TEXT_LONGEST);
    return false;
  }
  const char *nul = memchr(s->text, 0, s->length);
  if (!nul) return true;
  uint32_t at = (uint32_t)(nul - s->text);
  diag_report(d, DIAG_BAD_CHARACTER, (span){at, at, (uint16_t)file},
              "there is a NUL byte here; this is not a text file");
  return false;
}

/* Reads the text of p->file to its end. */
static void read_text(parsing *p) {
  const source *s = &p->sources->items[p->file];
  lexer_open(p, s->text, s->length);
  model_parse(p);
  lexer_close(p);
}

static void splice(parsing *p, const char *name, span where, int file) {
  parsing *inner = must_calloc(1, sizeof *inner);
  inner->memory = p->memory;
  inner->sources = p->sources;
  inner->file = (uint16_t)file;
  inner->messages = p->messages;
  inner->options = p->options;
  inner->chain = (include_chain){&p->chain, name, where, p->chain.depth + 1};
  inner->included = p->included;
  inner->model = p->model;
  inner->tail = p->tail;
  read_text(inner);
  p->tail = inner->tail;
  free(inner);
}

static void read_included(parsing *p, const stmt *s) {
  if (!p->options || !p->options->read_include) {
    diag_report(p->messages, DIAG_INCLUDE, s->text_where, "nothing can be included here");
    return;
  }
  char *found = NULL;
  char *content = p->options->read_include(p->options->context, s->text, p->chain.name, &found);
  if (!content) {
    diag_report(p->messages, DIAG_INCLUDE, s->text_where, "`%s` cannot be read", s->text);
  } else if (!parse_begins_include(content)) {
    diag_report(p->messages, DIAG_INCLUDE, s->text_where, "`%s` holds no functions and constants",
                s->text);
    diag_hint(p->messages, "the first word of such a text is `function`, `constant` or `include`");
  } else {
    const char *name = found ? found : s->text;
    name = arena_text(p->memory, name, strlen(name));
    if (include_allowed(p, s, name) && !already_included(p->included, name)) {
      p->included->names[p->included->count++] = name;
      int file = source_add(p->sources, name, content, strlen(content));
      if (text_acceptable(p->sources, file, p->messages)) splice(p, name, s->where, file);
    }
  }
  free(content);
  free(found);
}

/* What only the end of the text can tell. */
static void check_whole(parsing *p) {
  span end = {p->lex.offset, p->lex.offset, p->file};
  if (p->messages->errors >= ERRORS_MOST) {
    diag_report(p->messages, DIAG_SYNTAX, end, "there are too many errors to read on from here");
    return;
  }
  if (!p->model_seen) {
    if (p->out_of_model) return;
    diag_report(p->messages, DIAG_SYNTAX, end, "there is no model in this text");
    diag_hint(p->messages, "a model file begins with `model my_law` and ends with `end model`");
    return;
  }
  if (!p->ended) {
    diag_report(p->messages, DIAG_SYNTAX, p->model->name_where, "the model `%s` does not end",
                p->model->name);
    diag_hint(p->messages, "write `end model` as the last line");
  }
  if (!p->law_seen) {
    diag_report(p->messages, DIAG_SYNTAX, p->model->name_where,
                "the model `%s` does not say what kind of law it is", p->model->name);
    diag_hint(p->messages, "write `law central bond`, `law micropolar bond` or `law state` below");
  }
}

static tree *parse_checked(arena *a, source_set *sources, int file, const parse_options *options,
                           diagnostics *d) {
  include_list *included = must_calloc(1, sizeof *included);
  parsing *p = must_calloc(1, sizeof *p);
  p->memory = a;
  p->sources = sources;
  p->file = (uint16_t)file;
  p->messages = d;
  p->options = options;
  p->chain = (include_chain){
      NULL, arena_printf(a, "%s", sources->items[file].name), {0, 0, (uint16_t)file}, 0};
  p->included = included;
  p->model = arena_alloc(a, sizeof *p->model);
  p->model->name = "";
  p->model->name_where = p->model->law_where = (span){0, 0, (uint16_t)file};
  p->tail = &p->model->first;
  read_text(p);
  check_whole(p);
  tree *result = p->model_seen ? p->model : NULL;
  free(p);
  free(included);
  return result;
}

/* Length of the word that stands first behind comments; *begin is where it begins. */
static size_t first_word(const char *text, const char **begin) {
  static const char blanks[] = " \t\r\f\v\n";
  if (strncmp(text, "\xEF\xBB\xBF", 3) == 0) text += 3;
  for (text += strspn(text, blanks); *text == '!'; text += strspn(text, blanks))
    text += strcspn(text, "\n");
  *begin = text;
  return strcspn(text, " \t\r\f\v\n!");
}

static bool begins_with_word(const char *text, const char *const *any, size_t count) {
  const char *begin;
  const size_t length = first_word(text, &begin);
  for (size_t k = 0; k < count; k++)
    if (strlen(any[k]) == length && memcmp(begin, any[k], length) == 0) return true;
  return false;
}

bool parse_begins_law(const char *text) {
  static const char *const first[] = {"model"};
  return begins_with_word(text, first, 1);
}

bool parse_begins_include(const char *text) {
  static const char *const first[] = {"", "function", "constant", "include", "model"};
  return begins_with_word(text, first, sizeof first / sizeof *first);
}

tree *parse_model(arena *a, source_set *sources, int file, const parse_options *options,
                  diagnostics *d) {
  if (!text_acceptable(sources, file, d)) return NULL;
  /* A number reads the same whatever the host program's language. */
  locale_t plain = newlocale(LC_ALL_MASK, "C", (locale_t)0), before = uselocale(plain);
  tree *result = parse_checked(a, sources, file, options, d);
  uselocale(before);
  if (plain) freelocale(plain);
  return result;
}
