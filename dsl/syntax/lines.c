#include "dsl/syntax/lines.h"

#include <string.h>

#include "dsl/syntax/parser.h"
#include "dsl/syntax/tree_build.h"

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

/* `end crack` closes what a tip does; the model goes on to its own end. */
static void end_crack(parsing *p, span where) {
  if (!p->law_seen || p->model->law != LAW_CRACK)
    complain(p, where, "no `crack` has begun here", "write `crack` above, before what its tips do");
}

void line_end(parsing *p, word of, word name, span where) {
  if (refuse_in_include(p, where) || !inside_model(p, where)) return;
  if (of.text && strcmp(of.text, "crack") == 0 && !name.text) {
    end_crack(p, where);
    return;
  }
  p->ended = true;
  if (!of.text || strcmp(of.text, "model") != 0) {
    complain(p, where, "only a model ends here", "write `end model`");
  } else if (name.text && strcmp(name.text, p->model->name) != 0 && first_complaint(p)) {
    diag_report(p->messages, DIAG_SYNTAX, name.where, "the model that ends here is `%s`, not `%s`",
                p->model->name, name.text);
    diag_note(p->messages, p->model->name_where, "it begins here");
  }
}

void line_crack(parsing *p, span where) {
  if (refuse_in_include(p, p->lex.first_where) || !inside_model(p, where)) return;
  if (p->law_seen) {
    if (!first_complaint(p)) return;
    diag_report(p->messages, DIAG_SYNTAX, where, "the kind of law is given twice");
    diag_note(p->messages, p->model->law_where, "it is given here already");
    return;
  }
  p->law_seen = true;
  p->model->law_where = where;
  p->model->law = LAW_CRACK;
}

static bool find_law(const char *first, const char *second, law_kind *kind) {
  static const law_kind kinds[] = {
#define X(code, words) code,
      LAW_KINDS(X)
#undef X
  };
  const size_t length = strlen(first);
  for (size_t i = 0; i < sizeof kinds / sizeof kinds[0]; i++) {
    const char *name = law_kind_name(kinds[i]);
    if (kinds[i] == LAW_CRACK || strncmp(name, first, length) != 0) continue;
    if (second ? name[length] != ' ' || strcmp(name + length + 1, second) != 0 : name[length])
      continue;
    *kind = kinds[i];
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
    complain(p, where, "there is no such kind of law", "write " LAW_LINES);
}

void line_settings(parsing *p, const words *list, span where) {
#define X(code, word) word,
  static const char *const known[] = {LAW_SETTINGS(X) LAW_IRREGULAR, LAW_ANISOTROPIC};
#undef X
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
    diag_hint(p->messages, "the settings are plane_stress, plane_strain, space, " LAW_IRREGULAR
                           " and " LAW_ANISOTROPIC);
  }
  p->model->settings = list->items;
  p->model->setting_where = list->where;
  for (int i = 0; i < list->count; i++) {
    if (strcmp(list->items[i], LAW_ANISOTROPIC) == 0) {
      p->model->anisotropic = true;
      p->model->anisotropic_where = list->where[i];
      continue;
    }
    list->items[p->model->setting_count] = list->items[i];
    list->where[p->model->setting_count++] = list->where[i];
  }
}

/* The first such line that the checker will take. */
static bool may_rest(const parsing *p, const stmt *s) {
  const char *resting = law_resting(p->model->law);
  return !p->model->rests && resting && strcmp(s->rest_of, resting) == 0 &&
         s->indexed == (p->model->law == LAW_STATE);
}

bool line_statement(parsing *p, stmt *s, word text, span where) {
  if (!inside_model(p, where)) return false;
  bool shared = s->kind == STMT_FUNCTION || s->kind == STMT_CONSTANT || s->kind == STMT_INCLUDE;
  if (!shared && refuse_in_include(p, where)) return false;
  s->where = where;
  s->text = text.text;
  s->text_where = text.where;
  *p->tail = s;
  p->tail = &s->next;
  if (s->rest_of && may_rest(p, s)) {
    p->model->rests = true;
    s->next = build_total(p, s);
    p->tail = &s->next->next;
  }
  return s->kind == STMT_INCLUDE;
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
