#include "dsl/semantics/law_variant.h"

#include <string.h>

static law *copy_of(const law *l) {
  law *copy = arena_alloc(l->memory, sizeof *copy);
  *copy = *l;
  return copy;
}

/* The word of the option as the law writes it, or `otherwise`. */
static const char *chosen_word(const stmt *option, const law_choice *choices, int count,
                               const char *otherwise) {
  for (int k = 0; k < count; k++)
    for (int w = 0; w < option->word_count && !strcmp(option->name, choices[k].option); w++)
      if (strcmp(option->words[w], choices[k].choice) == 0) return option->words[w];
  return otherwise;
}

const law *law_with_options(const law *l, const law_choice *choices, int count) {
  law *copy = copy_of(l);
  copy->chosen = arena_alloc(l->memory, ((size_t)l->options.count + 1) * sizeof *copy->chosen);
  for (int k = 0; k < l->options.count; k++)
    copy->chosen[k] = chosen_word(l->options.items[k]->declared, choices, count, l->chosen[k]);
  return copy;
}

const law *law_on_lattice(const law *l, law_setting setting, bool irregular, int neighbours) {
  law *copy = copy_of(l);
  copy->setting = setting;
  copy->irregular = irregular;
  copy->neighbours = neighbours;
  return copy;
}

const law *law_twisting(const law *l) {
  law *copy = copy_of(l);
  copy->twists = true;
  return copy;
}

const law *law_bending_in_space(const law *l) {
  law *copy = copy_of(l);
  copy->twists = true;
  copy->bends_in_space = true;
  return copy;
}
