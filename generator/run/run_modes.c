#include "generator/run/run_modes.h"

#include <math.h>
#include <stdlib.h>

#include "dsl/base/arena.h"
#include "generator/kernel/document.h"
#include "generator/run/run_shapes.h"
#include "runtime/simulation/modes.h"

static const char *const share_names[MODES_SHARES] = {"x", "y", "z", "turning"};

typedef struct found_modes {
  mode *modes;
  mode_count count;
  int dimensions;
  bool turn; /* some particles do */
} found_modes;

static bool has_share(const found_modes *f, int share) {
  return share == MODES_SHARES - 1 ? f->turn : share < f->dimensions;
}

static found_modes about(run *r) {
  found_modes f = {.turn = false};
  for (int b = 0; b < simulation_bodies(r->simulation); b++) {
    const rows *w = simulation_rows(r->simulation, b);
    f.dimensions = w->dimensions;
    for (int n = 0; n < r->deck->interaction_count; n++)
      f.turn = f.turn || r->laws[n].law->dof > w->dimensions;
  }
  return f;
}

/* --- as text ---------------------------------------------------------------------------------- */

static void print_mode(const found_modes *f, int number) {
  const mode *m = &f->modes[number];
  printf("  %4d  %12.6g  %12.6g  %12.6g", number + 1, m->omega / (2 * M_PI),
         1e3 * 2 * M_PI / m->omega, m->omega);
  for (int s = 0; s < MODES_SHARES; s++)
    if (has_share(f, s)) printf(" %9.1f", 100 * m->share[s]);
  printf("  %8.1g\n", m->residual);
}

static void print_rigid(const mode_count *count) {
  printf("; %ld components of particles can move, ", count->freedoms);
  if (count->rigid == 0)
    puts("nothing of them without resistance");
  else
    printf("%d %smotion%s of them without resistance\n", count->rigid,
           count->rigid == MODES_MOST_RIGID ? "or more " : "", count->rigid == 1 ? "" : "s");
}

static void print_modes(const run *r, const found_modes *f) {
  const step_limit *limit = simulation_step_limit(r->simulation);
  printf("  modes      the lowest %d", f->count.found);
  print_rigid(&f->count);
  printf("  mode  frequency/Hz     period/ms   omega/(1/s)");
  for (int s = 0; s < MODES_SHARES; s++)
    if (has_share(f, s)) printf(" %7s %%", share_names[s]);
  puts("  residual");
  for (int k = 0; k < f->count.found; k++)
    print_mode(f, k);
  printf("  last  %12.6g  %12.6g  %12.6g  at most: the stable step is %.4g us\n",
         limit->omega_max / (2 * M_PI), 1e3 * 2 * M_PI / limit->omega_max, limit->omega_max,
         1e6 * limit->limit);
  if (r->options->shapes)
    printf("  written    %s (%d frame%s) and its .xdmf for ParaView\n", r->result_path,
           f->count.found, f->count.found == 1 ? "" : "s");
}

/* --- in the document -------------------------------------------------------------------------- */

static void put_mode(json *w, const found_modes *f, int number) {
  const mode *m = &f->modes[number];
  json_object(w);
  json_put_integer(w, "number", number + 1);
  json_put_number(w, "frequency", m->omega / (2 * M_PI));
  json_put_number(w, "period", 2 * M_PI / m->omega);
  json_put_number(w, "omega", m->omega);
  json_put_number(w, "residual", m->residual);
  json_put_object(w, "shares");
  for (int s = 0; s < MODES_SHARES; s++)
    if (has_share(f, s)) json_put_number(w, share_names[s], m->share[s]);
  json_object_end(w);
  json_object_end(w);
}

static void put_modes(json *w, const run *r, const found_modes *f) {
  const step_limit *limit = simulation_step_limit(r->simulation);
  json_put_integer(w, "freedoms", f->count.freedoms);
  json_put_integer(w, "rigid", f->count.rigid);
  json_put_number(w, "omega_max", limit->omega_max);
  json_put_number(w, "stable_step", limit->limit);
  json_put_array(w, "modes");
  for (int k = 0; k < f->count.found; k++)
    put_mode(w, f, k);
  json_array_end(w);
  json_put_text(w, "result", r->options->shapes ? r->result_path : NULL);
}

static int tell(run *r, const found_modes *f) {
  if (r->options->shapes && !write_shapes(r, f->modes, f->count.found)) return RUN_FAILED;
  if (r->options->report)
    put_modes(r->options->report->document, r, f);
  else
    print_modes(r, f);
  return 0;
}

int tell_modes(run *r) {
  int status = INPUT_WRONG;
  const int asked = r->options->modes;
  found_modes f = about(r);
  f.modes = must_calloc((size_t)asked, sizeof *f.modes);
  const char *why = modes_find(r->simulation, asked, f.modes, &f.count);
  if (why)
    say_error("`%s` has no modes: %s", r->options->deck_path, why);
  else if (f.count.found < asked)
    say_error("`%s` has only %d mode%s: %ld components of its particles can move",
              r->options->deck_path, f.count.found, f.count.found == 1 ? "" : "s",
              f.count.freedoms);
  else
    status = tell(r, &f);
  modes_free(f.modes, f.count.found, simulation_bodies(r->simulation));
  free(f.modes);
  return status;
}
