/* What becomes of a law's text behind its reader, with what must hold there: its layout, its
   messages, and for a checked law the ranges of its values, its emitted C, the equations that
   explain it and the physics checks. */
#ifndef PERILAT_TESTS_LAW_STAGES_H
#define PERILAT_TESTS_LAW_STAGES_H

#include <string.h>

#include "dsl/base/diagnostics_json.h"
#include "dsl/print/explain.h"
#include "dsl/print/format.h"
#include "dsl/semantics/law_check.h"
#include "dsl/syntax/parse.h"
#include "generator/sense/sense.h"
#include "generator/emit/emit.h"
#include "generator/intervals/interval_check.h"
#include "generator/plan/plan.h"
#include "tests/fuzz/c_alphabet.h"
#include "tests/fuzz/fuzz.h"

/* One text can be included: itself would be endless, nothing would leave includes untried. */
static char *read_include(void *context, const char *name, const char *from, char **found) {
  (void)context, (void)from;
  if (strcmp(name, "x.plm") != 0) return NULL;
  *found = strdup("x.plm");
  return strdup("let included = 2\n");
}

static char *tree_text(const tree *t) {
  char *text = NULL;
  size_t length = 0;
  FILE *out = open_memstream(&text, &length);
  MUST(out);
  tree_dump(t, out);
  fclose(out);
  return text;
}

static void check_places(const diagnostics *d) {
  for (int k = 0; k < d->count; k++) {
    const diagnostic *x = &d->items[k];
    if (x->where.file >= d->sources->count) continue; /* of a file that has no text */
    MUST(x->where.begin <= x->where.end && x->where.end <= d->sources->items[x->where.file].length);
    MUST(*x->message && !strchr(x->message, '\n'));
  }
}

static void print_all(const diagnostics *d) {
  diag_print(d, nowhere());
  json document;
  json_document(&document, nowhere(), "0");
  diag_json j;
  diag_json_begin(&j, &document, "law.plm");
  diag_json_add(&j, d);
  diag_json_end(&j, d->errors == 0);
  json_document_end(&document);
}

/* The text laid out has the tree of the text, and stays as it is when laid out again. */
static void check_layout(source_set *sources, const tree *before) {
  diagnostics said;
  diag_begin(&said, sources);
  char *once = format_model(sources, 0, &said);
  MUST(once);
  int file = source_add(sources, "once", once, strlen(once));
  char *twice = format_model(sources, file, &said);
  MUST(twice && strcmp(once, twice) == 0);
  arena *memory = arena_new();
  const parse_options options = {read_include, NULL};
  tree *after = parse_model(memory, sources, file, &options, &said);
  MUST(after && said.errors == 0);
  char *a = tree_text(before), *b = tree_text(after);
  MUST(strcmp(a, b) == 0);
  free(a);
  free(b);
  free(once);
  free(twice);
  arena_free(memory);
  diag_clear(&said);
}

static void check_kernel_text(const law *l, diagnostics *d) {
  int errors = d->errors;
  kernel_plan *plan = plan_kernel(l, d);
  MUST((plan != NULL) == (d->errors == errors));
  if (!plan) return;
  char *c = emit_kernel(plan);
  const char *stray = c_stray(c);
  if (stray) fprintf(stderr, "stray in the emitted C: %.80s\n", stray);
  MUST(!stray);
  free(c);
  plan_free(plan);
}

/* What is found wrong is said, and said to be wrong. The compiler's derivative is right. */
static void check_physics(const law *l, diagnostics *d) {
  const physics_options few = {.effort = 0.03};
  const int errors = d->errors;
  const bool sound = law_is_sound(l, &few, d, NULL);
  MUST(sound == (d->errors == errors));
  for (int k = 0; k < d->count; k++)
    MUST(d->items[k].code != DIAG_TANGENT);
}

static void check_further(const law *l, fuzz_choice choice, diagnostics *d) {
  if (fuzz_one_in(choice, 5)) {
    interval_check(l, d);
    for (int k = 0; k < d->count; k++) /* it warns, but of what is not compiled */
      MUST(diag_severity(d->items[k].code) == SEVERITY_WARNING ||
           d->items[k].code == DIAG_NOT_SUPPORTED);
  }
  if (fuzz_one_in(choice, 7)) {
    explain_law(l, EXPLAIN_MARKDOWN, NULL, 0, nowhere());
    explain_law(l, EXPLAIN_LATEX, NULL, 0, nowhere());
  }
  if (fuzz_one_in(choice, 11)) check_kernel_text(l, d);
  if (fuzz_one_in(choice, 31)) check_physics(l, d);
}

/* Is it a law? */
static bool check_law(const char *text, size_t size, fuzz_choice choice) {
  source_set sources = {NULL, 0};
  diagnostics said;
  diag_begin(&said, &sources);
  arena *memory = arena_new();
  const int file = source_add(&sources, "law.plm", text, size);
  const parse_options options = {read_include, NULL};
  tree *t = parse_model(memory, &sources, file, &options, &said);
  MUST(t || said.errors);
  const bool read = t && !said.errors;
  if (read && fuzz_one_in(choice, 3)) check_layout(&sources, t);
  law *l = read ? law_check(memory, t, &sources, NULL, 0, &said) : NULL;
  MUST(!read || (l != NULL) == (said.errors == 0));
  if (l) check_further(l, choice, &said);
  check_places(&said);
  if (fuzz_one_in(choice, 13)) print_all(&said);
  diag_clear(&said);
  source_clear(&sources);
  arena_free(memory);
  return l != NULL;
}

#endif
