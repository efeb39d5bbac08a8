/* The table of groups: each stands where DECK_GROUPS says, its keys have names and places of their
   own, and every place of a deck wants as many values as its lattice has dimensions. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <string.h>
#include <strings.h>

#include <cmocka.h>

#include "runtime/deck/deck_groups.h"
#include "runtime/deck/deck_read.h"
#include "runtime/deck/deck_schema.h"
#include "runtime/deck/group_bar.h"
#include "runtime/deck/group_body.h"
#include "runtime/deck/group_lattice.h"
#include "runtime/deck/group_load.h"
#include "runtime/deck/group_monitor.h"
#include "runtime/deck/group_run.h"

static void each_group_stands_in_its_place(void **state) {
  (void)state;
  const deck k = {.name = ""};
  const char *names[DECK_GROUP_COUNT];
  assert_ptr_equal(deck_groups[DECK_GROUP_simulation], &deck_group_simulation);
  assert_ptr_equal(deck_groups[DECK_GROUP_lattice], &deck_group_lattice);
  assert_ptr_equal(deck_groups[DECK_GROUP_bar], &deck_group_bar);
  assert_ptr_equal(deck_groups[DECK_GROUP_body], &deck_group_body);
  assert_ptr_equal(deck_groups[DECK_GROUP_drive], &deck_group_drive);
  assert_ptr_equal(deck_groups[DECK_GROUP_stop], &deck_group_stop);
  assert_ptr_equal(deck_groups[DECK_GROUP_frame], &deck_group_frame);
  assert_int_equal(deck_group_names(names), DECK_GROUP_COUNT);
  for (int g = 0; g < DECK_GROUP_COUNT; g++) {
    const deck_group_info *info = deck_groups[g];
    assert_string_equal(info->name, names[g]);
    assert_int_equal(deck_group_find(info->name), g);
    assert_true(info->place + (info->single ? info->size : sizeof(void *)) <= sizeof k);
    assert_true(info->single == (info->count_place == 0));
    assert_true(info->identity == NULL || deck_key_find(info, info->identity) >= 0);
  }
  assert_int_equal(deck_group_find("LATTICE"), DECK_GROUP_lattice);
  assert_int_equal(deck_group_find("latice"), -1);
}

/* Behind what all items have, within the structure, no two at one place. */
static void each_key_has_a_name_and_a_place_of_its_own(void **state) {
  (void)state;
  for (int g = 0; g < DECK_GROUP_COUNT; g++)
    for (int i = 0; i < deck_groups[g]->key_count; i++) {
      const deck_key_info *key = &deck_groups[g]->keys[i];
      assert_int_equal(deck_key_find(deck_groups[g], key->name), i);
      if (key->former) assert_int_equal(deck_key_find(deck_groups[g], key->former), i);
      if (key->offset == DECK_NO_FIELD) continue;
      assert_true(key->offset >= (long)sizeof(deck_item));
      assert_true((size_t)key->offset < deck_groups[g]->size);
      for (int k = 0; k < i; k++)
        if (deck_groups[g]->keys[k].offset == key->offset)
          fail_msg("&%s: `%s` and `%s` are kept at one place", deck_groups[g]->name, key->name,
                   deck_groups[g]->keys[k].name);
    }
}

static void says(const char *text, const char *sentence) {
  source_set sources = {NULL, 0};
  diagnostics d;
  arena *memory = arena_new();
  diag_begin(&d, &sources);
  const int file = source_add(&sources, "d.nml", text, strlen(text));
  bool found = false;
  assert_null(deck_read(memory, &sources, file, NULL, 0, &d));
  for (int k = 0; k < d.count; k++)
    found = found || strstr(d.items[k].message, sentence);
  if (!found) diag_print(&d, stderr);
  if (!found) fail_msg("nothing says: %s", sentence);
  diag_clear(&d);
  source_clear(&sources);
  arena_free(memory);
}

#define PLANE "&lattice name = 'a' kind = 'square' spacing = 1 thickness = 1 %s /\n"
#define SPACE "&lattice name = 'a' kind = 'cubic' spacing = 1 %s /\n"

/* A group with one place of the wrong number of values, and what else its check needs before it
   looks at places. */
static const struct {
  const char *key, *of_plane, *of_space;
} uses[] = {
    {"at", "&region name = 'r' shape = 'point' at = 3*0 /",
     "&region name = 'r' shape = 'point' at = 2*0 /"},
    {"corner", "&body lattice = 'a' shape = 'rectangle' corner = 3*0 size = 1, 1 /",
     "&body lattice = 'a' shape = 'box' corner = 2*0 size = 1, 1, 1 /"},
    {"size", "&notch lattice = 'a' shape = 'rectangle' corner = 2*0 size = 3*1 /",
     "&notch lattice = 'a' shape = 'box' corner = 3*0 size = 2*1 /"},
    {"centre", "&body lattice = 'a' shape = 'disc' centre = 3*0 radius = 1 /",
     "&body lattice = 'a' shape = 'sphere' centre = 2*0 radius = 1 /"},
    {"from", "&notch lattice = 'a' shape = 'segment' from = 3*0 to = 1, 1 /",
     "&body lattice = 'a' shape = 'cylinder' from = 2*0 to = 1, 1, 1 radius = 1 /"},
    {"to", "&notch lattice = 'a' shape = 'segment' from = 2*0 to = 3*1 /",
     "&body lattice = 'a' shape = 'cylinder' from = 3*0 to = 2*1 radius = 1 /"},
    {"acceleration", "&gravity acceleration = 3*1 /", "&gravity acceleration = 2*1 /"},
    {"normal", "&monitor name = 'm' kind = 'force' at = 2*0 normal = 3*1 /",
     "&monitor name = 'm' kind = 'force' at = 3*0 normal = 2*1 /"},
    {"direction", "&monitor name = 'm' kind = 'tip' at = 2*0 direction = 3*1 above = 0.5 /",
     "&monitor name = 'm' kind = 'tip' at = 3*0 direction = 2*1 above = 0.5 /"},
    {"about", "&monitor name = 'm' kind = 'angular_momentum' about = 3*0 /",
     "&monitor name = 'm' kind = 'angular_momentum' about = 2*0 component = 'z' /"},
    {"shift", "&bar name = 'b' points = 4*0 spacing = 1 area = 1 copies = 2 shift = 3*1 /",
     "&bar name = 'b' points = 6*0 spacing = 1 area = 1 copies = 2 shift = 2*1 /"},
    {"origin", NULL, NULL}, /* of the lattice itself */
};

static bool is_tried(const char *key) {
  for (size_t u = 0; u < sizeof uses / sizeof *uses; u++)
    if (strcmp(uses[u].key, key) == 0) return true;
  return false;
}

static void a_place_has_as_many_values_as_its_lattice_has_dimensions(void **state) {
  (void)state;
  for (int g = 0; g < DECK_GROUP_COUNT; g++)
    for (int i = 0; i < deck_groups[g]->key_count; i++)
      if (deck_groups[g]->keys[i].type == DECK_PLACE && !is_tried(deck_groups[g]->keys[i].name))
        fail_msg("`%s` of &%s is a place that is not tried here", deck_groups[g]->keys[i].name,
                 deck_groups[g]->name);
  for (size_t u = 0; u < sizeof uses / sizeof *uses; u++)
    for (int space = 0; space < 2; space++) {
      char text[512], sentence[128];
      const char *rest = space ? uses[u].of_space : uses[u].of_plane;
      const char *own = rest ? "" : space ? "origin = 2*0" : "origin = 3*0";
      const int head = snprintf(text, sizeof text, space ? SPACE : PLANE, own);
      snprintf(text + head, sizeof text - (size_t)head, "%s\n", rest ? rest : "");
      snprintf(sentence, sizeof sentence, "`%s` takes %d values in %s, but %d are given",
               uses[u].key, 2 + space, space ? "space" : "the plane", 3 - space);
      says(text, sentence);
    }
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(each_group_stands_in_its_place),
      cmocka_unit_test(each_key_has_a_name_and_a_place_of_its_own),
      cmocka_unit_test(a_place_has_as_many_values_as_its_lattice_has_dimensions)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
