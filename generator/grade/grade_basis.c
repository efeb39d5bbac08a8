#include "generator/grade/grade_basis.h"

#include <math.h>
#include <string.h>

#include "generator/drive/drive_expect.h"

bool item_is_judged(const exercise_item *item, bool only_public) {
  if (item->withheld || item->kind == ITEM_HAND) return false;
  return !only_public || item_is_public(item);
}

/* --- paths ------------------------------------------------------------------------------------ */

static bool has_paths(const exercise_item *item) {
  return item->kind == ITEM_PATH || item->kind == ITEM_SAMPLE;
}

static int count_paths(const exercise *e, bool only_public) {
  int count = 0;
  for (int k = 0; k < e->item_count; k++)
    if (item_is_judged(&e->items[k], only_public) && has_paths(&e->items[k]))
      count += e->items[k].found_count;
  return count;
}

static bool read_paths(grade_basis *b, bool only_public) {
  const exercise *e = b->of;
  bool good = true;
  b->cases = arena_alloc(b->memory, ((size_t)count_paths(e, only_public) + 1) * sizeof *b->cases);
  for (int k = 0; k < e->item_count; k++) {
    const exercise_item *item = &e->items[k];
    if (!item_is_judged(item, only_public) || !has_paths(item)) continue;
    for (int f = 0; f < item->found_count; f++) {
      path_case *c = &b->cases[b->case_count];
      *c = (path_case){.item = item, .number = f + 1, .varied = ""};
      c->in = path_input(b->memory, &b->sources, item->found[f].shown,
                         b->has_solution ? &b->solution : NULL, &c->own_count, &b->said);
      good = good && c->in;
      b->case_count += c->in != NULL;
    }
  }
  return good;
}

/* The sizes that students have at hand: of a path that they are given. */
static const drive_input *first_public(const grade_basis *b) {
  for (int k = 0; k < b->case_count; k++)
    if (!b->cases[k].item->hidden) return b->cases[k].in;
  return b->case_count ? b->cases[0].in : NULL;
}

/* What the solution makes of closed forms takes their place: those of an answer may not be
   asked. */
static bool fix_expectations(grade_basis *b, path_case *c) {
  drive_input *in = c->in;
  drive_table columns;
  if (c->item->against != AGAINST_EXPECTATIONS || !in->expect_count) return true;
  driven_law_columns(&c->right.of, &columns);
  drive_expectations *x = drive_expectations_read(in, &c->right.of.model, &columns, &b->said);
  drive_verdict *verdicts =
      arena_alloc(b->memory, ((size_t)in->expect_count + 1) * sizeof *verdicts);
  if (x) drive_judge(x, c->right.of.parameters, &c->right.table, verdicts);
  bool good = x != NULL;
  for (int k = 0; x && k < in->expect_count; k++) {
    drive_expect *e = &in->expects[k];
    if (!verdicts[k].passed) {
      diag_report(&b->said, DIAG_CONFLICT, e->item.where, "the solution does not meet this: %.9g",
                  verdicts[k].found);
      good = false;
    }
    if (!e->formula) continue;
    namelist_key *key = arena_alloc(b->memory, sizeof *key);
    namelist_value *value = arena_alloc(b->memory, sizeof *value);
    *value = (namelist_value){
        .kind = NAMELIST_NUMBER, .number = verdicts[k].expected, .where = e->formula_where};
    *key = (namelist_key){.name = "value",
                          .name_where = e->formula_where,
                          .value_where = e->formula_where,
                          .values = value,
                          .value_count = 1};
    e->value = key;
    e->formula = NULL;
  }
  if (x) drive_expectations_free(x);
  drive_table_free(&columns);
  return good;
}

/* Only the tables are asked from here on. */
static void let_laws_go(path_case *c) {
  driven_law_close(&c->right.of);
  if (c->plain) driven_law_close(&c->right_plain.of);
}

static bool refer_paths(grade_basis *b) {
  const drive_input *first = first_public(b);
  for (int k = 0; k < b->case_count; k++) {
    path_case *c = &b->cases[k];
    path_case_vary(c, b->memory, &b->solution, first);
    if (!path_case_refer(c, b->memory, b->of->solution, &b->kept, &b->said) ||
        !fix_expectations(b, c))
      return false;
    let_laws_go(c);
    if (c->right.table.bad_row < 0) continue;
    diag_report(&b->said, DIAG_FILE, c->in->material.item.where,
                "on this path the solution gives something that is not a number");
    return false;
  }
  return true;
}

/* --- known wrong laws ------------------------------------------------------------------------- */

static void drive_wrong(grade_basis *b, int path, int wrong, driven_law *kept) {
  const path_case *c = &b->cases[path];
  const char *missing;
  const drive_input *in = input_suited(b->memory, c, c->in, &b->declared[wrong], &missing);
  diagnostics unheard;
  diag_begin(&unheard, &b->sources);
  reference_law *r = &b->wrong[path * b->of->wrong_count + wrong];
  if (missing || reference_law_drive(r, b->memory, in, b->of->wrong[wrong].path, kept, &unheard) !=
                     DRIVEN_READY) {
    if (!missing) reference_law_close(r);
    *r = (reference_law){.skip = NULL};
  } else {
    driven_law_close(&r->of);
  }
  diag_clear(&unheard);
}

static void drive_all_wrong(grade_basis *b) {
  const exercise *e = b->of;
  const size_t tables = (size_t)b->case_count * (size_t)e->wrong_count;
  b->declared = arena_alloc(b->memory, ((size_t)e->wrong_count + 1) * sizeof *b->declared);
  b->wrong = arena_alloc(b->memory, (tables + 1) * sizeof *b->wrong);
  for (int w = 0; w < e->wrong_count; w++) {
    driven_law kept = {.in = NULL};
    b->declared[w] = names_declared(b->memory, e->wrong[w].path);
    for (int k = 0; k < b->case_count && b->declared[w].count; k++)
      drive_wrong(b, k, w, &kept);
    driven_law_close(&kept);
  }
}

const reference_law *wrong_table(const grade_basis *b, int path, int wrong) {
  const reference_law *r = b->wrong ? &b->wrong[path * b->of->wrong_count + wrong] : NULL;
  return r && r->table.memory ? r : NULL;
}

/* --- the whole -------------------------------------------------------------------------------- */

path_case *sample_origins(const grade_basis *b, const exercise_item *item, int *count) {
  int first = 0;
  *count = b->case_count;
  if (!item->found_count) return b->cases;
  while (first < b->case_count && b->cases[first].item != item)
    first++;
  *count = item->found_count;
  return &b->cases[first];
}

static bool read_solution(grade_basis *b) {
  b->has_solution = model_open(&b->solution, b->of->solution, NULL, 0);
  if (b->has_solution) return true;
  diag_report(&b->said, DIAG_FILE, (span){0, 0, UINT16_MAX}, "the solution `%s` has errors",
              b->of->solution);
  return false;
}

bool grade_basis_open(grade_basis *b, const exercise *e, bool only_public) {
  *b = (grade_basis){.of = e, .memory = arena_new()};
  diag_begin(&b->said, &b->sources);
  b->measured = arena_alloc(b->memory, ((size_t)e->item_count + 1) * sizeof *b->measured);
  for (int k = 0; k < e->item_count; k++)
    b->measured[k] = NAN;
  if (e->of_answers) return true;
  if (e->solution && !read_solution(b)) return false;
  if (!read_paths(b, only_public)) return false;
  if (!b->has_solution) return true;
  if (!refer_paths(b)) return false;
  drive_all_wrong(b);
  return true;
}

void grade_basis_close(grade_basis *b) {
  const int tables = b->wrong ? b->case_count * b->of->wrong_count : 0;
  for (int k = 0; k < tables; k++)
    if (b->wrong[k].table.memory) reference_law_close(&b->wrong[k]);
  for (int k = 0; k < b->case_count; k++)
    path_case_close(&b->cases[k]);
  driven_law_close(&b->kept);
  if (b->has_solution) model_close(&b->solution);
  diag_clear(&b->said);
  source_clear(&b->sources);
  arena_free(b->memory);
}
