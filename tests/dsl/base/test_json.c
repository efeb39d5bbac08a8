/* The JSON writer gives valid JSON whatever it is fed; diagnostics have their documented form. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include <glob.h>
#include <math.h>

#include "dsl/base/diagnostics_json.h"
#include "dsl/semantics/law_check.h"
#include "dsl/syntax/parse.h"
#include "tests/dsl/json_valid.h"
#include "tests/dsl/text_files.h"

#define BAD SOURCE_DIR "/tests/dsl/bad/"

static void assert_valid(const char *text) {
  if (!json_is_valid(text)) fail_msg("this is no JSON:\n%s", text);
}

static void the_validator_tells_right_from_wrong(void **state) {
  (void)state;
  static const char *const right[] = {"{}", "[]", "[1, -2.5e+3, \"a\\u0041\\n\", true, null]",
                                      "{\"a\": {\"b\": []}}", "0"};
  static const char *const wrong[] = {
      "",   "{",          "[1,]", "{\"a\" 1}", "{a: 1}",       "\"\t\"",   "\"\\x\"",
      "01", "1.",         "nan",  "[1] 2",     "\"\xC0\x80\"", "\"\xFF\"", "\"\xED\xA0\x80\"",
      "\"", "{\"a\": 1,}"};
  for (size_t i = 0; i < sizeof right / sizeof right[0]; i++)
    assert_true(json_is_valid(right[i]));
  for (size_t i = 0; i < sizeof wrong / sizeof wrong[0]; i++)
    if (json_is_valid(wrong[i])) fail_msg("%s is no JSON", wrong[i]);
}

static void values_are_written_as_they_should(void **state) {
  (void)state;
  char *text = NULL;
  size_t length;
  FILE *out = open_memstream(&text, &length);
  json j;
  json_begin(&j, out);
  json_object(&j);
  json_key(&j, "text");
  json_text(&j, "a \"b\" \\ \n\t\x01\x7F \xC2\xB5m \xFFx");
  json_key(&j, "none");
  json_text(&j, NULL);
  json_key(&j, "numbers");
  json_array(&j);
  json_number(&j, 0.1);
  json_number(&j, -1e300);
  json_number(&j, 1.0 / 3.0);
  json_number(&j, NAN);
  json_number(&j, INFINITY);
  json_integer(&j, -7);
  json_array_end(&j);
  json_key(&j, "empty");
  json_object(&j);
  json_object_end(&j);
  json_key(&j, "right");
  json_bool(&j, true);
  json_object_end(&j);
  json_end(&j);
  fclose(out);
  assert_string_equal(
      text, "{\n  \"text\": \"a \\\"b\\\" \\\\ \\n\\t\\u0001\\u007f \xC2\xB5m \xEF\xBF\xBDx\",\n"
            "  \"none\": null,\n  \"numbers\": [\n    0.1,\n    -1e+300,\n    0.3333333333333333,\n"
            "    null,\n    null,\n    -7\n  ],\n  \"empty\": {},\n  \"right\": true\n}\n");
  assert_valid(text);
  free(text);
}

/* All texts of three bytes out of those that matter to UTF-8 and JSON, and all of two bytes. */
static void any_bytes_give_valid_text(void **state) {
  (void)state;
  static const unsigned char bytes[] = {0x01, '\n', '"',  '\\', 'a',  0x7F, 0x80, 0x8F, 0x90,
                                        0x9F, 0xA0, 0xBF, 0xC0, 0xC1, 0xC2, 0xDF, 0xE0, 0xE1,
                                        0xED, 0xEF, 0xF0, 0xF3, 0xF4, 0xF5, 0xFF};
  enum { COUNT = sizeof bytes };
  char *text = NULL;
  size_t length;
  FILE *out = open_memstream(&text, &length);
  json j;
  json_begin(&j, out);
  json_array(&j);
  for (int a = 1; a < 256; a++)
    for (int b = 1; b < 256; b++) {
      const char pair[] = {(char)a, (char)b};
      json_bytes(&j, pair, 2);
    }
  for (int k = 0; k < COUNT * COUNT * COUNT * COUNT; k++) {
    const char four[] = {(char)bytes[k % COUNT], (char)bytes[k / COUNT % COUNT],
                         (char)bytes[k / COUNT / COUNT % COUNT],
                         (char)bytes[k / COUNT / COUNT / COUNT]};
    json_bytes(&j, four, 4);
  }
  json_bytes(&j, "\0", 1);
  json_array_end(&j);
  json_end(&j);
  fclose(out);
  assert_int_equal(strlen(text), length);
  assert_true(json_is_valid(text));
  free(text);
}

/* --- diagnostics ------------------------------------------------------------------------------ */

static char *read_beside(void *context, const char *name, const char *from, char **found) {
  (void)context;
  (void)from;
  char path[4096];
  snprintf(path, sizeof path, "%s%s", BAD, name);
  size_t length;
  char *text = read_file(path, &length);
  if (text) *found = strdup(name);
  return text;
}

/* Adds what there is to say about one program of the folder; returns how many messages. */
static int add_program(diag_json *j, const char *name) {
  char path[4096];
  snprintf(path, sizeof path, "%s%s", BAD, name);
  size_t length;
  char *text = read_file(path, &length);
  assert_non_null(text);
  source_set sources = {0};
  diagnostics d;
  diag_begin(&d, &sources);
  arena *memory = arena_new();
  int file = source_add(&sources, name, text, length);
  const parse_options options = {read_beside, NULL};
  tree *t = parse_model(memory, &sources, file, &options, &d);
  if (t && d.errors == 0) law_check(memory, t, &sources, NULL, 0, &d);
  diag_json_add(j, &d);
  int count = d.count;
  arena_free(memory);
  diag_clear(&d);
  source_clear(&sources);
  free(text);
  return count;
}

/* A document in memory. */
typedef struct written {
  json writer;
  FILE *out;
  char *text;
  size_t length;
} written;

static void begin(written *d, diag_json *j, const char *checked) {
  d->out = open_memstream(&d->text, &d->length);
  json_document(&d->writer, d->out, "0");
  diag_json_begin(j, &d->writer, checked);
}

static char *document(written *d, diag_json *j) {
  diag_json_end(j, false);
  json_document_end(&d->writer);
  assert_int_equal(fclose(d->out), 0);
  return d->text;
}

static void a_dozen_programs_have_the_documented_form(void **state) {
  (void)state;
  static const char *const names[] = {"bounds_names.plm",     "cases_otherwise.plm",
                                      "names_duplicate.plm",  "names_unknown.plm",
                                      "options_choice.plm",   "order_cycle.plm",
                                      "placement_family.plm", "results_unused_warning.plm",
                                      "syntax_crlf.plm",      "syntax_include_content.plm",
                                      "syntax_utf8.plm",      "units_sum.plm"};
  diag_json j;
  written d;
  begin(&d, &j, "a dozen");
  for (size_t i = 0; i < sizeof names / sizeof names[0]; i++)
    add_program(&j, names[i]);
  char *text = document(&d, &j);
  assert_valid(text);
  assert_golden(SOURCE_DIR "/tests/dsl/golden/diagnostics.json", text);
  free(text);
}

static int count_of(const char *text, const char *part) {
  int count = 0;
  for (size_t at = 0, length = strlen(text); at < length; at++)
    count += strncmp(text + at, part, strlen(part)) == 0;
  return count;
}

static void every_bad_program_gives_valid_json(void **state) {
  (void)state;
  glob_t found;
  assert_int_equal(glob(BAD "*.plm", 0, NULL, &found), 0);
  assert_true(found.gl_pathc > 80);
  for (size_t i = 0; i < found.gl_pathc; i++) {
    diag_json j;
    written d;
    begin(&d, &j, "x");
    int messages = add_program(&j, strrchr(found.gl_pathv[i], '/') + 1);
    assert_int_equal(j.errors + j.warnings, messages);
    char *text = document(&d, &j);
    assert_valid(text);
    assert_int_equal(count_of(text, "\"severity\": "), messages);
    free(text);
  }
  globfree(&found);
}

/* --- the command ------------------------------------------------------------------------------ */

static char *check(const char *arguments, int *status) {
  char command[4096];
  snprintf(command, sizeof command, "PERILAT_MODELS=%s/models %s check --diagnostics=json %s",
           SOURCE_DIR, PERILAT_PROGRAM, arguments);
  char *text = run_command(command, status);
  assert_valid(text);
  return text;
}

static void assert_holds(const char *text, const char *part) {
  if (!strstr(text, part)) fail_msg("no %s in\n%s", part, text);
}

static void the_command_writes_one_document(void **state) {
  (void)state;
  int status;
  char *text = check(SOURCE_DIR "/models/elastic_central.plm", &status);
  assert_int_equal(status, 0);
  assert_holds(text,
               "\"diagnostics\": [],\n  \"errors\": 0,\n  \"warnings\": 0,\n  \"accepted\": true");
  free(text);
  text = check("no_such_file.plm", &status);
  assert_int_equal(status, 1);
  assert_holds(text, "\"code\": \"file\"");
  assert_holds(text, "\"where\": null");
  free(text);
}

static void decks_and_their_laws_share_a_document(void **state) {
  (void)state;
  char folder[] = "json_XXXXXX", path[64], arguments[128];
  assert_non_null(mkdtemp(folder));
  snprintf(path, sizeof path, "%s/faulty.plm", folder);
  write_file(path, "model faulty\n  law central bond\n  parameter EA = 2 [MN]\n  force N = "
                   "EA*strech\nend model\n");
  snprintf(path, sizeof path, "%s/deck.nml", folder);
  write_file(path, "&simulation end_time = '1 ms' /\n&lattice name = 'a' kind = 'hexagonal' "
                   "spacing = 0.01 thickness = 0.1 /\n"
                   "&material lattice = 'a' model = 'faulty' /\n"
                   "&body lattice = 'a' shape = 'rectangle' corner = 0, 0 size = 0.1, 0.1 /\n"
                   "&damping rate = 5 from = '3 ms' /\n");
  int status;
  char *text = check(path, &status);
  assert_int_equal(status, 1);
  assert_holds(text, "/faulty.plm\"");
  assert_holds(text, "\"code\": \"unknown-name\"");
  assert_holds(text, "\"hint\": \"did you mean `stretch`?\"");
  assert_holds(text, "/deck.nml\"");
  assert_holds(text, "\"code\": \"deck-warning\"");
  free(text);
  snprintf(arguments, sizeof arguments, "%s --set simulation.stap=3", path);
  text = check(arguments, &status);
  assert_int_equal(status, 1);
  assert_holds(text, "\"file\": \"--set\"");
  free(text);
  snprintf(arguments, sizeof arguments, "rm -r %s", folder);
  free(run_command(arguments, &status));
}

static void the_example_of_the_reference_is_real(void **state) {
  (void)state;
  size_t length;
  char *page = read_file(SOURCE_DIR "/dsl/README.md", &length);
  assert_non_null(page);
  char *begin = strstr(page, "\n```json\n"), *ends = begin ? strstr(begin, "\n```\n") : NULL;
  assert_non_null(ends);
  ends[1] = 0;
  char folder[] = "json_XXXXXX", line[4096];
  assert_non_null(mkdtemp(folder));
  snprintf(line, sizeof line, "%s/law.plm", folder);
  write_file(line, "model spring\n  law central bond\n  parameter EA = 2 [MN]\n  force N = "
                   "EA*strech\nend model\n");
  int status;
  snprintf(line, sizeof line, "cd %s && %s check law.plm --diagnostics=json", folder,
           PERILAT_PROGRAM);
  char *found = run_command(line, &status);
  assert_int_equal(status, 1);
  assert_string_equal(found, begin + strlen("\n```json\n"));
  free(found);
  snprintf(line, sizeof line, "rm -r %s", folder);
  free(run_command(line, &status));
  free(page);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(the_validator_tells_right_from_wrong),
      cmocka_unit_test(values_are_written_as_they_should),
      cmocka_unit_test(any_bytes_give_valid_text),
      cmocka_unit_test(a_dozen_programs_have_the_documented_form),
      cmocka_unit_test(every_bad_program_gives_valid_json),
      cmocka_unit_test(the_command_writes_one_document),
      cmocka_unit_test(decks_and_their_laws_share_a_document),
      cmocka_unit_test(the_example_of_the_reference_is_real),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
