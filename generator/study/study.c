#include "generator/study/study.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "generator/kernel/document.h"
#include "generator/study/study_converge.h"
#include "generator/study/study_deck.h"
#include "generator/study/study_fit.h"
#include "generator/study/study_publish.h"
#include "generator/study/study_strength.h"

static void say(study_request *r) {
  diag_print(&r->said, stderr);
  diag_print_topics(stderr);
  if (r->said.count) keep_error(r->said.items[0].message);
}

/* "perilat study FILE ..." goes on. */
static int tell_stopped(const study_case *cases, int count, int signal_number) {
  int done = 0;
  for (int k = 0; k < count; k++)
    done += cases[k].state == STUDY_DONE;
  printf("stopped as asked: %d of %d runs are done; the same command goes on from here\n", done,
         count);
  return 128 + signal_number;
}

/* --- values crossed --------------------------------------------------------------------------- */

/* The last of two would silently win. */
static bool is_new(study_request *r, const study_axis *axes, int axis, int key) {
  const study_key *own = &axes[axis].keys[key];
  for (int a = 0; a <= axis; a++)
    for (int k = 0; k < (a < axis ? axes[a].key_count : key); k++)
      if (study_same_key(axes[a].keys[k].name, own->name)) {
        diag_report(&r->said, DIAG_DUPLICATE_KEY, own->where, "`%s` is varied twice", own->name);
        diag_hint(&r->said, "give all its values at once");
        return false;
      }
  return true;
}

static bool keys_differ(study_request *r, const study_axis *axes) {
  for (int a = 0; a < r->vary.count; a++)
    for (int k = 0; k < axes[a].key_count; k++)
      if (!is_new(r, axes, a, k)) return false;
  return true;
}

static study_axis *read_axes(study_request *r) {
  study_axis *axes = arena_alloc(r->memory, ((size_t)r->vary.count + 1) * sizeof *axes);
  for (int k = 0; k < r->vary.count; k++)
    if (!study_axis_read(r->memory, &r->vary.items[k], &axes[k], &r->said)) return NULL;
  return keys_differ(r, axes) ? axes : NULL;
}

/* The names of all varied keys, whole where two have one last part. */
static const char **column_names(study_request *r, const study_axis *axes, int axis_count,
                                 int *count) {
  const char **names = NULL;
  *count = 0;
  for (int a = 0; a < axis_count; a++)
    for (int k = 0; k < axes[a].key_count; k++) {
      names = arena_room(r->memory, names, *count, sizeof *names);
      names[(*count)++] = axes[a].keys[k].name;
    }
  const char **shown = arena_alloc(r->memory, ((size_t)*count + 1) * sizeof *shown);
  for (int k = 0; k < *count; k++)
    shown[k] = study_key_shown(names, *count, k);
  return shown;
}

/* What is wrong with the first case is likely wrong with all. */
static bool check_cases(study_request *r, study_case *cases, int count) {
  for (int k = 0; k < count; k++)
    if (!study_case_check(r, &cases[k])) return false;
  return true;
}

static int run_crossed(study_request *r, study_pool *pool, json *w) {
  study_outcome o = {.request = r, .x = r->o.x, .y = r->o.y};
  const study_axis *axes = read_axes(r);
  if (!axes || !(o.cases = study_cross(r, axes, r->vary.count, &o.count))) return 1;
  const int sizes = r->converge.text ? study_converge_key(r, axes, r->vary.count) : 0;
  if (sizes < 0) return 1;
  o.keys = column_names(r, axes, r->vary.count, &o.key_count);
  if (!check_cases(r, o.cases, o.count)) return 1;
  study_warn_of_units(r, o.cases, o.count);
  if (r->check_only) return 0;
  if (!study_folder_open(pool->folder, r)) return 1;
  const int stopped = study_pool_run(pool, o.cases, o.count);
  if (stopped > 0) return tell_stopped(o.cases, o.count, stopped);
  if (stopped < 0) return -stopped;
  if (!study_read_rows(&o) || !study_publish(&o, w)) return 2;
  if (r->converge.text) return study_converge(&o, sizes, w);
  return study_rows_good(&o) == o.count ? 0 : 2;
}

/* --- any -------------------------------------------------------------------------------------- */

static int run_any(study_request *r, json *w) {
  study_folder folder = {.list = -1};
  study_pool pool = {r, &folder};
  const int status = r->strength.text ? study_strength(r, &pool, w)
                     : r->fit.count   ? study_fit(r, &pool, w)
                                      : run_crossed(r, &pool, w);
  study_folder_close(&folder);
  return status;
}

int study_run(study_request *r, json *w) {
  int status = 1;
  if (study_request_complete(r)) {
    if (w) json_put_text(w, "study", study_name(r));
    status = run_any(r, w);
  }
  say(r);
  return status;
}
