/* A deck's text through the namelist reader and the deck's checks. Lines `! --set text` at the top
   are overrides, as in tests/runtime/deck/bad. What can be read must have its numbers finite and
   its lists whole; every place lies in its text; what identifies the deck can be read again. */
#include <math.h>
#include <string.h>

#include "runtime/base/namelist.h"
#include "runtime/deck/deck_read.h"
#include "tests/fuzz/fuzz.h"

enum { LONGEST = 1 << 16, MOST_OVERRIDES = 8 };

static void check_places(const diagnostics *d) {
  for (int k = 0; k < d->count; k++) {
    const diagnostic *x = &d->items[k];
    MUST(x->where.file < d->sources->count);
    MUST(x->where.begin <= x->where.end && x->where.end <= d->sources->items[x->where.file].length);
    MUST(*x->message && !strchr(x->message, '\n'));
  }
}

static void check_values(const namelist *n, const source *text) {
  for (int g = 0; g < n->group_count; g++)
    for (int k = 0; k < n->groups[g].key_count; k++) {
      const namelist_key *key = &n->groups[g].keys[k];
      MUST(key->name_where.end <= text->length && key->value_where.end <= text->length);
      for (int v = 0; v < key->value_count; v++) {
        MUST(key->values[v].where.end <= text->length);
        MUST(key->values[v].kind != NAMELIST_NUMBER || isfinite(key->values[v].number));
        MUST(key->values[v].kind != NAMELIST_TEXT || key->values[v].text);
      }
    }
}

/* Only what every run may count on. */
static void check_deck(const deck *k) {
  MUST(k->simulation.end_time > 0 && isfinite(k->simulation.end_time));
  MUST(isfinite(k->simulation.step) && k->simulation.step_safety > 0);
  MUST(k->lattice_count > 0);
  for (int m = 0; m < k->lattice_count; m++)
    MUST(k->lattices[m].spacing > 0 && isfinite(k->lattices[m].spacing) &&
         (k->lattices[m].thickness > 0 || strcmp(k->lattices[m].setting, "space") == 0));
  for (int m = 0; m < k->region_count; m++)
    MUST(deck_find_region(k, k->regions[m].name) >= 0 &&
         deck_find_lattice(k, k->regions[m].lattice) >= 0);
  for (int m = 0; m < k->support_count; m++)
    MUST(deck_find_region(k, k->supports[m].region) >= 0 && k->supports[m].fix > 0);
  for (int m = 0; m < k->drive_count; m++) {
    MUST(deck_find_region(k, k->drives[m].region) >= 0);
    for (int t = 0; t < 5; t++)
      (void)(time_function_at(&k->drives[m].motion, 0.3 * t * k->simulation.end_time) +
             time_function_integral(&k->drives[m].motion, 0.3 * t * k->simulation.end_time));
  }
  for (int m = 0; m < k->stamp_count; m++) {
    const deck_stamp *of = &k->stamps[m];
    const double *v = of->direction, size = v[0] * v[0] + v[1] * v[1] + v[2] * v[2];
    MUST(deck_find_stamp(k, of->name) == m && of->mass >= 0 && isfinite(of->mass));
    MUST(fabs(size - 1) < 1e-9 || of->motion.value == 0);
  }
  for (int m = 0; m < k->stop_count; m++)
    MUST(deck_find_monitor(k, k->stops[m].monitor) >= 0);
  for (int m = 0; m < k->frame_count; m++)
    MUST(k->frames[m].at_count > 0 || deck_find_monitor(k, k->frames[m].event.monitor) >= 0);
}

static bool keep(const char *group, const char *key) {
  (void)group, (void)key;
  return false;
}

/* What the deck asks for, as one text, is a deck that asks for the same. */
static void check_identity(arena *memory, const deck *k) {
  source_set sources = {NULL, 0};
  diagnostics said;
  diag_begin(&said, &sources);
  const int file = source_add(&sources, "identity", k->identity, strlen(k->identity));
  const namelist *n = namelist_read(memory, &sources, file, &said);
  MUST(said.errors == 0);
  MUST(strcmp(namelist_text(memory, n, keep), k->identity) == 0);
  diag_clear(&said);
  source_clear(&sources);
}

/* The overrides in the comment lines at the top, cut out in place. */
static int take_overrides(char *text, deck_override *overrides) {
  static const char mark[] = "! --set ";
  int count = 0;
  while (count < MOST_OVERRIDES && strncmp(text, mark, sizeof mark - 1) == 0) {
    char *end = strchr(text, '\n');
    overrides[count++].text = text + sizeof mark - 1;
    if (!end) break;
    *end = 0;
    text = end + 1;
  }
  return count;
}

static void check_namelist(arena *memory, source_set *sources, int file) {
  diagnostics said;
  diag_begin(&said, sources);
  const namelist *n = namelist_read(memory, sources, file, &said);
  MUST(n);
  check_values(n, &sources->items[file]);
  diag_clear(&said);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size) {
  if (size > LONGEST) return 0;
  const fuzz_choice choice = fuzz_choose(data, size);
  source_set sources = {NULL, 0};
  diagnostics said;
  diag_begin(&said, &sources);
  arena *memory = arena_new();
  const int file = source_add(&sources, "deck.nml", (const char *)data, size);
  if (fuzz_one_in(choice, 4)) check_namelist(memory, &sources, file);
  deck_override overrides[MOST_OVERRIDES];
  char *head = arena_text(memory, (const char *)data, size);
  const int count = take_overrides(head, overrides);
  const deck *k = deck_read(memory, &sources, file, overrides, count, &said);
  MUST((k != NULL) == (said.errors == 0));
  if (k) check_deck(k);
  if (k && fuzz_one_in(choice, 3)) check_identity(memory, k);
  check_places(&said);
  if (fuzz_one_in(choice, 13)) diag_print(&said, nowhere());
  diag_clear(&said);
  source_clear(&sources);
  arena_free(memory);
  return 0;
}
