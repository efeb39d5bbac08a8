#include "dsl/semantics/law.h"

#include <string.h>

static const char *const setting_names[] = {
#define X(code, word) word,
    LAW_SETTINGS(X)
#undef X
};

const char *law_setting_name(law_setting setting) {
  return setting_names[setting];
}

bool law_setting_find(const char *name, law_setting *setting) {
  for (int k = SETTING_PLANE_STRESS; k <= SETTING_SPACE; k++)
    if (strcmp(name, setting_names[k]) == 0) {
      *setting = (law_setting)k;
      return true;
    }
  return false;
}

law_setting law_first_setting(const law *l) {
  law_setting first = SETTING_PLANE_STRESS;
  if (l->tree->setting_count) law_setting_find(l->tree->settings[0], &first);
  return first;
}

bool law_is_for(const law *l, law_setting setting) {
  for (int k = 0; k < l->tree->setting_count; k++)
    if (strcmp(l->tree->settings[k], setting_names[setting]) == 0) return true;
  return l->tree->setting_count == 0;
}

law_setting law_setting_in(const law *l, int dimensions) {
  law_setting named;
  for (int k = 0; k < l->tree->setting_count; k++)
    if (law_setting_find(l->tree->settings[k], &named) &&
        (named == SETTING_SPACE) == (dimensions == 3))
      return named;
  return dimensions == 3 ? SETTING_SPACE : SETTING_PLANE_STRESS;
}

int law_field_of(const symbol *tensor, int k) {
  if (!tensor->deviator) return tensor->index + k;
  return k == TENSOR_TRACED ? -1 : tensor->index + k - (k > TENSOR_TRACED);
}

const law_waiver *law_accepts(const law *l, diag_code check) {
  for (int k = 0; k < l->waiver_count; k++)
    if (l->waivers[k].check == check) return &l->waivers[k];
  return NULL;
}

bool law_says(const law *l, int k, const char **check, const char **why) {
  const int first = l->nonconservative != NULL;
  if (k >= first + l->waiver_count) return false;
  *check = k < first ? "nonconservative" : diag_name(l->waivers[k - first].check);
  *why = k < first ? l->nonconservative : l->waivers[k - first].why;
  return true;
}

void law_waive(const law *l, diagnostics *d, int from) {
  for (int k = d->count - 1; k >= from; k--) {
    const law_waiver *w = law_accepts(l, d->items[k].code);
    if (w) diag_accept(d, k, w->why);
  }
}

bool law_waiver_is_idle(const law_waiver *w, const diagnostics *d) {
  for (int k = 0; k < d->accepted_count; k++)
    if (d->accepted[k].code == w->check) return false;
  return true;
}

int law_rate_field(const law *l, int k) {
  for (int n = l->fields.count - 1; n > k; n--)
    if (l->fields.items[n]->rate_of == l->fields.items[k]) return n;
  return -1;
}

const stmt *law_force_state(const law *l) {
  for (int k = 0; k < l->rule_count; k++)
    if (l->rules[k]->kind == STMT_FORCE_STATE) return l->rules[k];
  return NULL;
}
