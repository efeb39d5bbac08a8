#include "generator/drive/group_keys.h"

#include "runtime/deck/deck_value.h"

void group_places(arena *a, const namelist_group *from, deck_item *item) {
  deck_key *keys = arena_alloc(a, ((size_t)from->key_count + 1) * sizeof *keys);
  for (int k = 0; k < from->key_count; k++)
    keys[k] = (deck_key){from->keys[k].name, from->keys[k].name_where, from->keys[k].value_where};
  *item = (deck_item){.where = from->where, .keys = keys, .key_count = from->key_count};
}

static void report_unknown(diagnostics *d, const deck_group_info *info, const namelist_key *key) {
  const char *names[DECK_MOST_KEYS];
  diag_report(d, DIAG_UNKNOWN_KEY, key->name_where, "`&%s` has no key `%s`", info->name, key->name);
  deck_suggest(d, key->name, names, deck_key_names(info, names), "its keys are");
}

bool group_keys_read(arena *a, const namelist_group *from, const deck_group_info *info, void *item,
                     diagnostics *d) {
  int errors = d->errors;
  for (int k = 0; k < from->key_count; k++) {
    const namelist_key *key = &from->keys[k];
    const namelist_key *first = namelist_find(from, key->name);
    int at = deck_key_find(info, key->name);
    if (first != key) {
      diag_report(d, DIAG_DUPLICATE_KEY, key->name_where, "`%s` is given twice in this `&%s`",
                  key->name, info->name);
      diag_note(d, first->name_where, "it is given here");
    } else if (at < 0 && !info->open) {
      report_unknown(d, info, key);
    } else if (at >= 0 && !key->broken && info->keys[at].offset != DECK_NO_FIELD) {
      deck_field_read(a, &info->keys[at], key, item, d);
    }
  }
  for (int k = 0; k < info->key_count; k++)
    if (info->keys[k].required && !namelist_find(from, info->keys[k].name)) {
      diag_report(d, DIAG_MISSING_KEY, from->where, "`&%s` has no `%s`", info->name,
                  info->keys[k].name);
      diag_hint(d, "%s: %s", info->keys[k].name, info->keys[k].doc);
    }
  return !from->broken && d->errors == errors;
}
