/* The editor grammars know exactly the words that the lexer and the checker know. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "dsl/semantics/builtins.h"
#include "dsl/syntax/parsing.h"
#include "tests/dsl/json_valid.h"
#include "tests/dsl/text_files.h"

#define EDITORS SOURCE_DIR "/dsl/editors/"

#define X(token, text) text,
static const char *const line_word_list[] = {LINE_WORDS(X)}, *const reserved_list[] = {
                                                                 RESERVED_WORDS(X)};
#undef X
#define X(code, name, ...) name,
static const char *const quantity_list[] = {BUILTIN_QUANTITIES(X)}, *const function_list[] = {
                                                                        BUILTIN_FUNCTIONS(X)};
#undef X

typedef struct word_list {
  const char *const *words;
  size_t count;
  const char *vim, *vim_end, *code,
      *code_end; /* what stands around the words in the two grammars */
} word_list;

#define LIST(name) name, sizeof name / sizeof name[0]
static const word_list lists[] = {
    {LIST(line_word_list), "\nsyntax keyword perilatStatement contained ", "\n",
     "\"match\": \"^\\\\s*(", ")\\\\b\""},
    {LIST(reserved_list), "\nsyntax keyword perilatReserved ", "\n",
     "\"name\": \"keyword.control.perilat\",\n      \"match\": \"\\\\b(", ")\\\\b\""},
    {LIST(quantity_list), "\nsyntax keyword perilatQuantity ", "\n",
     "\"name\": \"variable.language.perilat\",\n      \"match\": \"\\\\b(", ")\\\\b\""},
    {LIST(function_list), "\nsyntax keyword perilatFunction ", "\n",
     "\"name\": \"support.function.perilat\",\n      \"match\": \"\\\\b(",
     ")\\\\b(?=\\\\s*\\\\()\""},
};

static void assert_lists(const char *path, bool vim) {
  size_t length;
  char *grammar = read_file(path, &length), line[4096];
  assert_non_null(grammar);
  for (size_t k = 0; k < sizeof lists / sizeof lists[0]; k++) {
    const word_list *l = &lists[k];
    size_t at = (size_t)snprintf(line, sizeof line, "%s", vim ? l->vim : l->code);
    for (size_t i = 0; i < l->count; i++)
      at += (size_t)snprintf(line + at, sizeof line - at, "%s%s", i ? (vim ? " " : "|") : "",
                             l->words[i]);
    snprintf(line + at, sizeof line - at, "%s", vim ? l->vim_end : l->code_end);
    if (!strstr(grammar, line))
      fail_msg("%s has not this line, with these words and no others:\n%s", path, line);
  }
  free(grammar);
}

static void vim_knows_the_words(void **state) {
  (void)state;
  assert_lists(EDITORS "vim/syntax/perilat.vim", true);
}

static void vs_code_knows_the_words(void **state) {
  (void)state;
  assert_lists(EDITORS "vscode/syntaxes/perilat.tmLanguage.json", false);
}

static void files_of_vs_code_are_json(void **state) {
  (void)state;
  static const char *const files[] = {"package.json", "language-configuration.json",
                                      "syntaxes/perilat.tmLanguage.json"};
  for (int i = 0; i < 3; i++) {
    char path[4096];
    snprintf(path, sizeof path, "%svscode/%s", EDITORS, files[i]);
    size_t length;
    char *text = read_file(path, &length);
    assert_non_null(text);
    if (!json_is_valid(text)) fail_msg("%s is no JSON", path);
    free(text);
  }
}

/* Both grammars take whatever stands in brackets after a number for its unit, so that every unit of
   the table is one, and no list of units can grow old; what matters is that no symbol holds a
   bracket. */
static void units_need_no_list(void **state) {
  (void)state;
  int count;
  const char *const *symbols = unit_symbols(&count);
  assert_true(count > 40);
  for (int i = 0; i < count; i++)
    assert_null(strpbrk(symbols[i], "[]\n\"!"));
  size_t length;
  char *vim = read_file(EDITORS "vim/syntax/perilat.vim", &length);
  char *code = read_file(EDITORS "vscode/syntaxes/perilat.tmLanguage.json", &length);
  assert_non_null(strstr(vim, "syntax match perilatUnit \"\\[[^]]*\\]\" contained"));
  assert_non_null(strstr(code, "(\\\\[[^\\\\]]*\\\\])"));
  free(vim);
  free(code);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(vim_knows_the_words),
      cmocka_unit_test(vs_code_knows_the_words),
      cmocka_unit_test(files_of_vs_code_are_json),
      cmocka_unit_test(units_need_no_list),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
