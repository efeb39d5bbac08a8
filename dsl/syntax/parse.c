#include "dsl/syntax/parse.h"

#include <locale.h>
#include <stdlib.h>

#include "dsl/syntax/parser.h"
#include "dsl/syntax/words.h"

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
    diag_hint(p->messages, "write " LAW_LINES " below");
  }
}

static parsing *parsing_new(arena *a, source_set *sources, span part, diagnostics *d) {
  parsing *p = must_calloc(1, sizeof *p);
  p->memory = a;
  p->sources = sources;
  p->file = part.file;
  p->part = part;
  p->messages = d;
  return p;
}

static tree *parse_checked(arena *a, source_set *sources, int file, const parse_options *options,
                           diagnostics *d) {
  include_list *included = must_calloc(1, sizeof *included);
  parsing *p = parsing_new(a, sources, source_whole(sources, file), d);
  p->options = options;
  p->chain = (include_chain){
      NULL, arena_printf(a, "%s", sources->items[file].name), {0, 0, (uint16_t)file}, 0};
  p->included = included;
  p->model = arena_alloc(a, sizeof *p->model);
  p->model->name = "";
  p->model->name_where = p->model->law_where = (span){0, 0, (uint16_t)file};
  p->tail = &p->model->first;
  parser_read(p);
  check_whole(p);
  tree *result = p->model_seen ? p->model : NULL;
  free(p);
  free(included);
  return result;
}

bool parse_begins_law(const char *text) {
  static const char *const first[] = {"model"};
  return first_word_is(text, first, 1);
}

/* A number reads the same whatever the host program's language. */
typedef struct plain_locale {
  locale_t plain, before;
} plain_locale;

static plain_locale locale_begin(void) {
  plain_locale l = {.plain = newlocale(LC_ALL_MASK, "C", (locale_t)0)};
  l.before = uselocale(l.plain);
  return l;
}

static void locale_end(plain_locale l) {
  uselocale(l.before);
  if (l.plain) freelocale(l.plain);
}

tree *parse_model(arena *a, source_set *sources, int file, const parse_options *options,
                  diagnostics *d) {
  if (!text_acceptable(sources, file, d)) return NULL;
  const plain_locale l = locale_begin();
  tree *result = parse_checked(a, sources, file, options, d);
  locale_end(l);
  return result;
}

expr *parse_expression(arena *a, source_set *sources, span where, diagnostics *d) {
  const int errors = d->errors;
  const plain_locale l = locale_begin();
  parsing *p = parsing_new(a, sources, where, d);
  p->alone = true;
  parser_read(p);
  expr *result = d->errors == errors ? p->expression : NULL;
  locale_end(l);
  free(p);
  return result;
}
