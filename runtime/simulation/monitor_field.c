#include "runtime/simulation/monitor_field.h"

#include <stdlib.h>
#include <string.h>
#include <strings.h>

#include "dsl/base/arena.h"
#include "runtime/deck/deck_value.h"

/* By its place among the law's fields, then outputs. */
const pl_field *monitor_law_field(const pl_law *law, int k) {
  return k < law->field_count ? &law->fields[k] : &law->outputs[k - law->field_count];
}

/* Particles have it; of points nodes have the mean around. */
static bool is_watchable(const pl_field *f) {
  return f->place == PL_ON_PARTICLE || f->place == PL_ON_POINT;
}

int monitor_find_field(const deck_monitor *m, const pl_law *law) {
  for (int k = law->field_count + law->output_count - 1; k >= 0; k--) {
    const pl_field *f = monitor_law_field(law, k);
    if (is_watchable(f) && strcasecmp(f->name, m->field) == 0) return k;
  }
  return -1;
}

/* The first law of the body that has the field; NULL: none. */
const run_law *monitor_law_with_field(const deck_monitor *m, const run_body *of) {
  for (int n = 0; n < of->law_count; n++)
    if (monitor_find_field(m, of->laws[n].law) >= 0) return &of->laws[n];
  return NULL;
}

bool monitor_check_field(const deck_monitor *m, const run_body *of, diagnostics *d) {
  if (m->kind != MONITOR_FIELD || monitor_law_with_field(m, of)) return true;
  const pl_law *law = of->law;
  const int count = law->field_count + law->output_count;
  const char **names = must_calloc((size_t)count + 1, sizeof *names);
  int there = 0;
  for (int k = 0; k < count; k++)
    if (is_watchable(monitor_law_field(law, k))) names[there++] = monitor_law_field(law, k)->name;
  diag_report(d, DIAG_BAD_VALUE, deck_where(&m->item, "field"), "the law `%s` has no `%s` %s",
              law->name, m->field, of->cells ? "at points" : "on particles");
  deck_suggest(d, m->field, names, there, "a monitor can watch");
  free(names);
  return false;
}

/* The law has the monitor's field, in the monitor's unit. */
static bool same_field(const monitor *m, const run_law *law) {
  const int k = monitor_find_field(m->deck, law->law);
  return k >= 0 && strcmp(monitor_law_field(law->law, k)->unit, m->unit) == 0;
}

/* That of the region's first particle, where it has the field. */
const run_law *monitor_law_watched(const monitor *m) {
  const run_body *of = m->of[0];
  for (int n = 0; n < of->law_count && m->index_count[0] > 0; n++)
    if (of->laws[n].own && of->laws[n].own[m->indices[0][0]] &&
        monitor_find_field(m->deck, of->laws[n].law) >= 0)
      return &of->laws[n];
  return monitor_law_with_field(m->deck, of);
}

/* What of a node's value is a law's: by the areas of its cells around, among those of laws that
   have the field. */
static double part_of_node(const monitor *m, const run_law *law, long site) {
  double all = 0;
  if (!law->share) return 1;
  for (int n = 0; n < m->of[0]->law_count; n++)
    if (same_field(m, &m->of[0]->laws[n])) all += m->of[0]->laws[n].share[site];
  return all > 0 ? law->share[site] / all : 0;
}

/* Those with cells around of a law that has the field. */
void monitor_keep_nodes(monitor *m, diagnostics *d) {
  const run_body *of = m->of[0];
  long kept = 0;
  for (long p = 0; p < m->index_count[0]; p++) {
    bool has = false;
    for (int n = 0; n < of->law_count; n++)
      has = has ||
            (same_field(m, &of->laws[n]) && part_of_node(m, &of->laws[n], m->indices[0][p]) > 0);
    if (has) m->indices[0][kept++] = m->indices[0][p];
  }
  m->index_count[0] = kept;
  if (kept > 0) return;
  diag_report(d, DIAG_BAD_VALUE, deck_where(&m->deck->item, "region"),
              "no node of `%s` has a cell of the law `%s` around it, whose `%s` is watched",
              m->deck->region, m->law->law->name, m->deck->field);
}

/* Other laws have no such field on their particles. */
void monitor_check_share(const monitor *m, diagnostics *d) {
  for (long p = 0; m->law->share && p < m->index_count[0]; p++) {
    if (m->law->share[m->indices[0][p]] > 0) continue;
    diag_report(d, DIAG_BAD_VALUE, deck_where(&m->deck->item, "region"),
                "the region `%s` holds particles that are not of the law `%s`, whose `%s` is "
                "watched",
                m->deck->region, m->law->law->name, m->deck->field);
    return;
  }
}

double monitor_mean_at(const double *values, const int32_t *sites, long count) {
  double sum = 0;
  for (long p = 0; p < count; p++)
    sum += values[sites[p]];
  return count ? sum / (double)count : 0;
}

/* Of nodes, which have what frames show there. */
static double node_mean(const monitors *all, const monitor *m) {
  double sum = 0;
  for (int n = 0; n < m->of[0]->law_count; n++) {
    const run_law *law = &m->of[0]->laws[n];
    if (!same_field(m, law)) continue;
    const int k = monitor_find_field(m->deck, law->law), output = k - law->law->field_count;
    const double *values = output >= 0 ? all->values : law->state->new_field[k];
    if (output >= 0) sweep_output(law->state, output, all->values);
    for (long p = 0; p < m->index_count[0]; p++) {
      const double part = part_of_node(m, law, m->indices[0][p]);
      if (part > 0) sum += part * values[m->indices[0][p]];
    }
  }
  return sum / (double)m->index_count[0];
}

/* Of a law's field or output on particles. */
double monitor_field_mean(const monitors *all, const monitor *m, bool late) {
  if (m->of[0]->cells) return node_mean(all, m);
  sweep *state = m->law->state;
  const int count = m->law->law->field_count;
  const double *values = m->field >= count ? all->values
                         : late            ? state->field[m->field]
                                           : state->new_field[m->field];
  if (m->field >= count) sweep_output(state, m->field - count, all->values);
  return monitor_mean_at(values, m->indices[0], m->index_count[0]);
}
