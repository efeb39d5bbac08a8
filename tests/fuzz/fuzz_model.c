/* A law's text through the whole front end: read, checked, its ranges followed, planned, emitted,
   laid out, explained. Besides sanitizers these watch: errors and results exclude each other,
   places lie in the text, the layout keeps the tree and is laid out, the emitted C holds nothing
   but what the emitter writes. */
#include <string.h>

#include "dsl/diagnostics_json.h"
#include "dsl/explain.h"
#include "dsl/format.h"
#include "dsl/parse.h"
#include "generator/emit.h"
#include "generator/interval.h"
#include "generator/passes.h"
#include "tests/fuzz/c_alphabet.h"
#include "tests/fuzz/fuzz.h"

enum { LONGEST = 1 << 16 };

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
  diag_print(d, nowhere());
  diag_json j;
  diag_json_begin(&j, "law.plm", "0");
  diag_json_add(&j, d);
  diag_json_end(&j, d->errors == 0, nowhere());
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

static void go_on_to_c(const law *l, diagnostics *d) {
  int errors = d->errors;
  kernel_plan *plan = plan_kernel(l, d);
  MUST((plan != NULL) == (d->errors == errors));
  if (!plan) return;
  char *c = emit_kernel(plan, "key");
  const char *stray = c_stray(c);
  if (stray) fprintf(stderr, "stray in the emitted C: %.80s\n", stray);
  MUST(!stray);
  free(c);
  plan_free(plan);
}

static void check_law(const uint8_t *data, size_t size) {
  source_set sources = {NULL, 0};
  diagnostics said;
  diag_begin(&said, &sources);
  arena *memory = arena_new();
  const int file = source_add(&sources, "law.plm", (const char *)data, size);
  const parse_options options = {read_include, NULL};
  tree *t = parse_model(memory, &sources, file, &options, &said);
  MUST(t || said.errors);
  const bool read = t && !said.errors;
  if (read) check_layout(&sources, t);
  law *l = read ? law_check(memory, t, &sources, NULL, 0, &said) : NULL;
  MUST(!read || (l != NULL) == (said.errors == 0));
  if (l) {
    interval_check(l, &said);
    MUST(said.errors == 0); /* it warns */
    explain_law(l, EXPLAIN_MARKDOWN, nowhere());
    explain_law(l, EXPLAIN_LATEX, nowhere());
    go_on_to_c(l, &said);
  }
  check_places(&said);
  diag_clear(&said);
  source_clear(&sources);
  arena_free(memory);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size) {
  if (size <= LONGEST) check_law(data, size);
  return 0;
}
