#include "runtime/deck/deck_groups.h"

#include <string.h>

#include "runtime/deck/group_bar.h"
#include "runtime/deck/group_body.h"
#include "runtime/deck/group_lattice.h"
#include "runtime/deck/group_load.h"
#include "runtime/deck/group_mesh.h"
#include "runtime/deck/group_monitor.h"
#include "runtime/deck/group_run.h"

const deck_group_info *const deck_groups[DECK_GROUP_COUNT] = {
#define X(group) &deck_group_##group,
    DECK_GROUPS(X, X, X)
#undef X
};

const deck_grammar deck_grammar_of_decks = {"deck", deck_groups, DECK_GROUP_COUNT};

/* --- reference -------------------------------------------------------------------------------- */

static void print_choices(const char *choices, FILE *out) {
  for (const char *p = choices; *p;) {
    size_t length = strcspn(p, "|");
    fprintf(out, "%s`'%.*s'`", p == choices ? "" : ", ", (int)length, p);
    p += length + (p[length] == '|');
  }
}

static void print_type(const deck_key_info *key, FILE *out) {
  bool pure = key->unit && strcmp(key->unit, "1") == 0;
  const char *shown = pure ? "a pure number" : key->unit;
  if (key->choices) {
    print_choices(key->choices, out);
    return;
  }
  switch (key->type) {
  case DECK_PAIR:
    fprintf(out, "two values, %s", shown);
    break;
  case DECK_DIRECTION:
    fputs("three pure numbers", out);
    break;
  case DECK_PLACE:
    fprintf(out, "two values, in space three, %s", shown);
    break;
  case DECK_REALS:
    fprintf(out, "list, %s", shown);
    break;
  case DECK_STEP:
    fprintf(out, "%s or `'auto'`", shown);
    break;
  case DECK_END:
    fprintf(out, "%s or `'100 periods'`", shown);
    break;
  case DECK_ANGLE:
    fputs("degrees, or `'0.3 rad'`", out);
    break;
  case DECK_COUNT:
    fputs("whole number", out);
    if (key->most > 0) fprintf(out, ", 0 to %d", key->most);
    break;
  case DECK_LOGICAL:
    fputs("`.true.` or `.false.`", out);
    break;
  case DECK_NAMES:
    fputs("texts", out);
    break;
  default:
    fputs(shown && *shown ? shown : "text", out);
  }
}

static void print_default(const deck_key_info *key, FILE *out) {
  if (key->required)
    fputs("required", out);
  else if (key->fallback && key->fallback[0] == '=')
    fputs(key->fallback + 2, out);
  else if (key->fallback)
    fprintf(out, "`%s`", key->fallback);
}

void deck_reference(const deck_grammar *of, FILE *out) {
  for (int i = 0; i < of->group_count; i++) {
    const deck_group_info *g = of->groups[i];
    fprintf(out, "### &%s\n\n%s\n\n| key | value | default | meaning |\n|---|---|---|---|\n",
            g->name, g->doc);
    for (int k = 0; k < g->key_count; k++) {
      fprintf(out, "| `%s` | ", g->keys[k].name);
      print_type(&g->keys[k], out);
      fputs(" | ", out);
      print_default(&g->keys[k], out);
      fprintf(out, " | %s", g->keys[k].doc);
      if (g->keys[k].former) fprintf(out, "; formerly `%s`", g->keys[k].former);
      fputs(" |\n", out);
    }
    fputc('\n', out);
  }
}
