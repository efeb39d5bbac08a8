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

law_setting law_first_setting(const law *l) {
  for (int k = SETTING_PLANE_STRESS; k <= SETTING_SPACE; k++)
    if (l->tree->setting_count && strcmp(l->tree->settings[0], setting_names[k]) == 0)
      return (law_setting)k;
  return SETTING_PLANE_STRESS;
}

int law_field_of(const symbol *tensor, int k) {
  if (!tensor->deviator) return tensor->index + k;
  return k == TENSOR_TRACED ? -1 : tensor->index + k - (k > TENSOR_TRACED);
}

const stmt *law_force_state(const law *l) {
  for (int k = 0; k < l->rule_count; k++)
    if (l->rules[k]->kind == STMT_FORCE_STATE) return l->rules[k];
  return NULL;
}
