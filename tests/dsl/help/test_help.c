/* Every diagnostic code and every word of the language has its page, and the examples do what the
   pages say: a faulty one gives its code, a mended one and all others give no message. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include <ctype.h>

#include "dsl/base/diagnostics.h"
#include "dsl/help/help.h"
#include "dsl/semantics/builtins.h"
#include "dsl/semantics/law_check.h"
#include "dsl/syntax/parse.h"
#include "dsl/syntax/words.h"
#include "runtime/deck/deck_groups.h"
#include "tests/dsl/text_files.h"

static const char *const words_of_the_language[] = {
#define X(token, text) text,
    LINE_WORDS(X) RESERVED_WORDS(X)
#undef X
};
enum { WORD_COUNT = sizeof words_of_the_language / sizeof words_of_the_language[0] };

static const help_page *page(help_section section, const char *name) {
  for (int i = 0; i < help_page_count; i++)
    if (help_pages[i].section == section && strcmp(help_pages[i].name, name) == 0)
      return &help_pages[i];
  return NULL;
}

static void every_code_and_word_has_a_page_and_no_other(void **state) {
  (void)state;
  for (int k = 0; k < DIAG_COUNT; k++)
    if (!page(HELP_CODES, diag_name((diag_code)k)))
      fail_msg("dsl/help/codes/%s.md is missing", diag_name((diag_code)k));
  for (int k = 0; k < WORD_COUNT; k++)
    if (!page(HELP_KEYWORDS, words_of_the_language[k]))
      fail_msg("dsl/help/keywords/%s.md is missing", words_of_the_language[k]);
  assert_int_equal(help_page_count, DIAG_COUNT + WORD_COUNT);
  for (int i = 0; i < help_page_count; i++) {
    char heading[128];
    snprintf(heading, sizeof heading, "# %s\n\n", help_pages[i].name);
    assert_memory_equal(help_pages[i].text, heading, strlen(heading));
  }
}

/* --- examples --------------------------------------------------------------------------------- */

static char folder[] = "help_XXXXXX";

/* What `perilat check` says about an example. */
static char *say(const char *example, bool is_deck) {
  char path[64], command[4096];
  snprintf(path, sizeof path, "%s/example.%s", folder, is_deck ? "nml" : "plm");
  write_file(path, example);
  snprintf(command, sizeof command, "PERILAT_MODELS=%s/models %s check --diagnostics=json %s 2>&1",
           SOURCE_DIR, PERILAT_PROGRAM, path);
  int status;
  return run_command(command, &status);
}

/* The block fenced as `kind` in a page, to be freed, or NULL. */
static char *block(const char *text, const char *kind) {
  char fence[32];
  snprintf(fence, sizeof fence, "\n```%s\n", kind);
  const char *begin = strstr(text, fence);
  if (!begin) return NULL;
  begin += strlen(fence);
  const char *ends = strstr(begin, "\n```\n");
  assert_non_null(ends);
  return strndup(begin, (size_t)(ends + 1 - begin));
}

static void assert_silent(const char *name, const char *example, bool is_deck) {
  char *said = say(example, is_deck);
  if (!strstr(said, "\"diagnostics\": [],") || !strstr(said, "\"accepted\": true"))
    fail_msg("%s:\n%s\n%s", name, example, said);
  free(said);
}

/* What no text can bring about: the compiler's own faults, and what the kinds of quantities
 * exclude. */
static bool has_faulty_example(const char *code) {
  return strcmp(code, "tangent") != 0 && strcmp(code, "mirror") != 0;
}

static void assert_gives(const char *code, const char *example, bool is_deck) {
  char wanted[128];
  snprintf(wanted, sizeof wanted, "\"code\": \"%s\"", code);
  char *said = say(example, is_deck);
  if (!strstr(said, wanted)) fail_msg("this does not give %s:\n%s\n%s", code, example, said);
  free(said);
}

static void examples_of_codes_are_real(void **state) {
  (void)state;
  for (int i = 0; i < help_page_count; i++) {
    const help_page *p = &help_pages[i];
    if (p->section != HELP_CODES) continue;
    bool is_deck = strstr(p->text, "\n```nml") != NULL;
    char *wrong = block(p->text, is_deck ? "nml-error" : "plm-error"),
         *right = block(p->text, is_deck ? "nml" : "plm");
    if (!right || (wrong != NULL) != has_faulty_example(p->name))
      fail_msg("the page of %s lacks an example", p->name);
    if (wrong) assert_gives(p->name, wrong, is_deck);
    assert_silent(p->name, right, is_deck);
    free(wrong);
    free(right);
  }
}

static bool holds_word(const char *text, const char *name) {
  size_t n = strlen(name);
  for (const char *at = strstr(text, name); at; at = strstr(at + 1, name)) {
    bool begins = at == text || !(isalnum((unsigned char)at[-1]) || at[-1] == '_');
    if (begins && !isalnum((unsigned char)at[n]) && at[n] != '_') return true;
  }
  return false;
}

static void examples_of_words_are_right_and_use_them(void **state) {
  (void)state;
  for (int i = 0; i < help_page_count; i++) {
    const help_page *p = &help_pages[i];
    if (p->section != HELP_KEYWORDS) continue;
    char *example = block(p->text, "plm");
    if (!example) fail_msg("the page of %s lacks an example", p->name);
    if (!holds_word(example, p->name) &&
        strcmp(p->name, "include") != 0) /* an example is one file */
      fail_msg("the example of %s does not use it", p->name);
    char *said = say(example, false);
    if (!strstr(said, "\"errors\": 0,") || !strstr(said, "\"warnings\": 0,"))
      fail_msg("%s:\n%s\n%s", p->name, example, said);
    free(said);
    free(example);
  }
}

/* --- built-ins -------------------------------------------------------------------------------- */

/* Laws with room for a line of the kinds that may hold it. */
static const char *const around[] = {
    "model m\n  law micropolar bond\n  parameter EA = 2 [MN]\n  parameter S_t = 1e-4\n"
    "  damage omega = | 0 when stretch <= S_t | 1 otherwise\n",
    "  force N = (1 - omega)*EA*stretch\n  force V = EA*theta_i\nend model\n",
    "model m\n  law state\n  parameter EA = 2 [MN]\n  force state F[j] = EA*stretch[j]\n",
    "end model\n",
    "model m\n  law slip bond\n  parameter k = 2 [MN/m]\n",
    "  force N = k*slip\n  force V = k*gap\nend model\n",
    "model m\n  law continuum\n  parameter E = 2 [GPa]\n",
    "  stress sigma = hooke(strain, E, 0.2)\nend model\n",
    "model m\n  crack\n  parameter K_Ic = 1 [MPa*m^(1/2)]\n",
    "  grow when K_I > K_Ic\n  toward 0\n  speed 0.5*rayleigh_speed\n  end crack\nend model\n"};
enum { KINDS_OF_LAWS = sizeof around / sizeof *around / 2 };

static bool line_is_right(const char *name, const char *line, int kind) {
  char text[2048];
  snprintf(text, sizeof text, "%s  %s\n%s", around[2 * kind], line, around[2 * kind + 1]);
  source_set sources = {0};
  diagnostics d;
  diag_begin(&d, &sources);
  arena *memory = arena_new();
  const parse_options options = {NULL, NULL};
  tree *t =
      parse_model(memory, &sources, source_add(&sources, name, text, strlen(text)), &options, &d);
  if (t && d.errors == 0) law_check(memory, t, &sources, NULL, 0, &d);
  bool right = d.errors == 0;
  arena_free(memory);
  diag_clear(&d);
  source_clear(&sources);
  return right;
}

static void assert_example(const char *name, const char *line) {
  if (!line) fail_msg("%s has no example", name);
  if (!holds_word(line, name)) fail_msg("the example of %s does not use it", name);
  bool right = false;
  for (int kind = 0; kind < KINDS_OF_LAWS; kind++)
    right = right || line_is_right(name, line, kind);
  if (!right) fail_msg("the example of %s is wrong", name);
}

static void examples_of_built_ins_are_right(void **state) {
  (void)state;
  assert_false(line_is_right("x", "x = strech", 0));
  for (int q = 0; q < QUANTITY_COUNT; q++)
    assert_example(builtin_quantities[q].name, builtin_quantities[q].example);
  for (int f = 0; f < FUNCTION_COUNT; f++)
    assert_example(builtin_functions[f].name, builtin_functions[f].example);
}

/* --- the command ------------------------------------------------------------------------------ */

static char *ask(const char *topic, int *status) {
  char command[4096];
  snprintf(command, sizeof command, "%s help '%s' 2>&1", PERILAT_PROGRAM, topic);
  return run_command(command, status);
}

static void assert_known(const char *topic, const char *part) {
  int status;
  char *said = ask(topic, &status);
  if (status != 0 || !strstr(said, part))
    fail_msg("help %s does not say `%s` but\n%s", topic, part, said);
  free(said);
}

/* What a line declares has the page of its word. */
static void declared_names_are_topics(void **state) {
  (void)state;
  FILE *out = fopen("/dev/null", "w");
  assert_non_null(out);
  assert_int_equal(help_show("rest_stretch", out), 1);
  assert_int_equal(help_show("total_stretch", out), 1);
  fclose(out);
}

static void all_topics_are_served(void **state) {
  (void)state;
  int count = help_topic_count();
  const char **names = must_calloc((size_t)count, sizeof *names);
  help_topics(names);
  for (int i = 0; i < count; i++) {
    char *text = NULL;
    size_t length;
    FILE *out = open_memstream(&text, &length);
    assert_true(help_show(names[i], out) > 0);
    fclose(out);
    assert_true(length > 40);
    assert_null(strstr(text, "```"));
    free(text);
  }
  free(names);
}

static void the_command_answers(void **state) {
  (void)state;
  assert_known("unknown-name", "(a message)");
  assert_known("damage", "damage omega on bond");
  assert_known("option", "(a message)"); /* a code and a word: both */
  assert_known("option", "(a word of the language)");
  assert_known("stretch", "change of bond length");
  assert_known("soft_sign", "1 argument\n");
  assert_known("units", "GPa");
  assert_known("check", "(a command)");
  for (int g = 0; g < DECK_GROUP_COUNT; g++) {
    char topic[64];
    snprintf(topic, sizeof topic, "&%s", deck_groups[g]->name);
    assert_known(topic, deck_groups[g]->doc);
    for (int k = 0; k < deck_groups[g]->key_count; k++)
      assert_known(topic, deck_groups[g]->keys[k].name);
  }
  int status;
  char *said = ask("damge", &status);
  assert_int_equal(status, 1);
  assert_non_null(strstr(said, "did you mean `damage`?"));
  free(said);
}

static int make_folder(void **state) {
  (void)state;
  return mkdtemp(folder) ? 0 : -1;
}

static int remove_folder(void **state) {
  (void)state;
  char command[128];
  snprintf(command, sizeof command, "rm -r %s", folder);
  return system(command);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(every_code_and_word_has_a_page_and_no_other),
      cmocka_unit_test(examples_of_codes_are_real),
      cmocka_unit_test(examples_of_words_are_right_and_use_them),
      cmocka_unit_test(examples_of_built_ins_are_right),
      cmocka_unit_test(declared_names_are_topics),
      cmocka_unit_test(all_topics_are_served),
      cmocka_unit_test(the_command_answers),
  };
  return cmocka_run_group_tests(tests, make_folder, remove_folder);
}
