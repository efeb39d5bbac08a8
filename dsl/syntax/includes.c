#include "dsl/syntax/includes.h"

#include <stdlib.h>
#include <string.h>

#include "dsl/syntax/words.h"

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

static bool begins_include(const char *text) {
  static const char *const first[] = {"", "function", "constant", "include", "model"};
  return first_word_is(text, first, sizeof first / sizeof *first);
}

/* Below `p`, whose tree it continues. */
static parsing *parsing_within(parsing *p, const char *name, span where, int file) {
  parsing *inner = must_calloc(1, sizeof *inner);
  inner->memory = p->memory;
  inner->sources = p->sources;
  inner->file = (uint16_t)file;
  inner->part = source_whole(p->sources, file);
  inner->messages = p->messages;
  inner->options = p->options;
  inner->chain = (include_chain){&p->chain, name, where, p->chain.depth + 1};
  inner->included = p->included;
  inner->model = p->model;
  inner->tail = p->tail;
  return inner;
}

static parsing *open_text(parsing *p, const stmt *s, const char *found, const char *content) {
  const char *name = arena_text(p->memory, found, strlen(found));
  if (!include_allowed(p, s, name) || already_included(p->included, name)) return NULL;
  p->included->names[p->included->count++] = name;
  int file = source_add(p->sources, name, content, strlen(content));
  if (!text_acceptable(p->sources, file, p->messages)) return NULL;
  return parsing_within(p, name, s->where, file);
}

parsing *include_open(parsing *p, const stmt *s) {
  if (!p->options || !p->options->read_include) {
    diag_report(p->messages, DIAG_INCLUDE, s->text_where, "nothing can be included here");
    return NULL;
  }
  parsing *inner = NULL;
  char *found = NULL;
  char *content = p->options->read_include(p->options->context, s->text, p->chain.name, &found);
  if (!content) {
    diag_report(p->messages, DIAG_INCLUDE, s->text_where, "`%s` cannot be read", s->text);
  } else if (!begins_include(content)) {
    diag_report(p->messages, DIAG_INCLUDE, s->text_where, "`%s` holds no functions and constants",
                s->text);
    diag_hint(p->messages, "the first word of such a text is `function`, `constant` or `include`");
  } else {
    inner = open_text(p, s, found ? found : s->text, content);
  }
  free(content);
  free(found);
  return inner;
}

void include_close(parsing *p, parsing *inner) {
  p->tail = inner->tail;
  free(inner);
}
