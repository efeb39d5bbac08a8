/* Lists of words outside of the program, the editors' grammars and the fuzzers' dictionary, hold
   exactly the words that the lexer and the checker know. With PERILAT_BLESS=1 they are written anew
   from the language's own tables. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "dsl/semantics/builtins.h"
#include "dsl/syntax/words.h"
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
} word_list;

enum { LINE, RESERVED, QUANTITY, FUNCTION, LISTS };
#define LIST(name)                                                                                 \
  { name, sizeof name / sizeof name[0] }
static const word_list lists[LISTS] = {
    [LINE] = LIST(line_word_list),
    [RESERVED] = LIST(reserved_list),
    [QUANTITY] = LIST(quantity_list),
    [FUNCTION] = LIST(function_list),
};

/* A file that holds the lists: each stands between its head and the tail, with the separator
   between words. */
typedef struct holder {
  const char *path, *heads[LISTS], *separator, *tail;
} holder;

static const holder vim_grammar = {
    .path = EDITORS "vim/syntax/perilat.vim",
    .heads = {[LINE] = "\nsyntax keyword perilatStatement contained ",
              [RESERVED] = "\nsyntax keyword perilatReserved ",
              [QUANTITY] = "\nsyntax keyword perilatQuantity ",
              [FUNCTION] = "\nsyntax keyword perilatFunction "},
    .separator = " ",
    .tail = "\n",
};
static const holder code_grammar = {
    .path = EDITORS "vscode/syntaxes/perilat.tmLanguage.json",
    .heads = {[LINE] = "\"match\": \"^\\\\s*(",
              [RESERVED] = "\"name\": \"keyword.control.perilat\",\n      \"match\": \"\\\\b(",
              [QUANTITY] = "\"name\": \"variable.language.perilat\",\n      \"match\": \"\\\\b(",
              [FUNCTION] = "\"name\": \"support.function.perilat\",\n      \"match\": \"\\\\b("},
    .separator = "|",
    .tail = ")\\\\b",
};
static const holder dictionary = {
    .path = SOURCE_DIR "/tests/fuzz/model.dict",
    .heads = {[LINE] = "# Words that begin a line\n\"",
              [RESERVED] = "# Words that are never names\n\"",
              [QUANTITY] = "# Quantities\n\"",
              [FUNCTION] = "# Functions\n\""},
    .separator = "\"\n\"",
    .tail = "\"\n\n",
};

/* The text of a holder's file with its list of that number as it should be. */
static char *with_list(const holder *h, int list, const char *text) {
  const char *from = strstr(text, h->heads[list]);
  if (!from) fail_msg("%s has no line that begins with %s", h->path, h->heads[list]);
  from += strlen(h->heads[list]);
  const char *to = strstr(from, h->tail);
  if (!to) fail_msg("%s: the list after %s has no end", h->path, h->heads[list]);
  char *right;
  size_t length;
  FILE *out = open_memstream(&right, &length);
  assert_non_null(out);
  fprintf(out, "%.*s", (int)(from - text), text);
  for (size_t i = 0; i < lists[list].count; i++)
    fprintf(out, "%s%s", i ? h->separator : "", lists[list].words[i]);
  fputs(to, out);
  fclose(out);
  return right;
}

static void assert_lists(const holder *h) {
  size_t length;
  char *text = read_file(h->path, &length);
  assert_non_null(text);
  for (int list = 0; list < LISTS; list++) {
    char *right = with_list(h, list, text);
    free(text);
    text = right;
  }
  assert_golden(h->path, text);
  free(text);
}

static void vim_knows_the_words(void **state) {
  (void)state;
  assert_lists(&vim_grammar);
}

static void vs_code_knows_the_words(void **state) {
  (void)state;
  assert_lists(&code_grammar);
}

static void fuzzers_know_the_words(void **state) {
  (void)state;
  assert_lists(&dictionary);
}

/* Each function of numbers stands in a template of the laws that fuzz_law.c writes. */
static void fuzzers_call_the_functions(void **state) {
  (void)state;
  size_t length;
  char *fuzzer = read_file(SOURCE_DIR "/tests/fuzz/fuzz_law.c", &length), call[80];
  assert_non_null(fuzzer);
  for (int f = 0; f < FUNCTION_COUNT; f++) {
    const builtin_function_info *b = &builtin_functions[f];
    snprintf(call, sizeof call, "\"%s(#", b->name);
    if ((b->of_one || b->of_many || f == FUNCTION_ATAN2) && !strstr(fuzzer, call))
      fail_msg("tests/fuzz/fuzz_law.c has no template %s)\"", call);
  }
  free(fuzzer);
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
      cmocka_unit_test(vim_knows_the_words),       cmocka_unit_test(vs_code_knows_the_words),
      cmocka_unit_test(fuzzers_know_the_words),    cmocka_unit_test(fuzzers_call_the_functions),
      cmocka_unit_test(files_of_vs_code_are_json), cmocka_unit_test(units_need_no_list),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
