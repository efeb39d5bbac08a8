#include "generator/report/run_cracks.h"

#include <math.h>

#include "generator/report/moment.h"
#include "generator/report/print_quantity.h"
#include "runtime/continuum/cells.h"

enum { NAME_TEXT = 256 };

static const tips *tips_of(const run *r, int number) {
  const cells *c = simulation_cells(r->simulation, number);
  return c ? c->tips : NULL;
}

bool cracks_have_grown(const run *r) {
  for (int b = 0; b < simulation_bodies(r->simulation); b++) {
    const tips *t = tips_of(r, b);
    if (t && t->pieces.count > 0) return true;
  }
  return false;
}

/* --- in words --------------------------------------------------------------------------------- */

static void conclude_tip(const run *r, const tips *t, int tip) {
  const tip_state *p = &t->items[tip].now;
  char name[NAME_TEXT], begun[MOMENT_TEXT], when[MOMENT_TEXT];
  printf("  crack      %s: ", tip_folder(t, tip, name, sizeof name));
  if (!p->grown && !p->done) {
    print_quantity("at the last look K_I = ", p->K[0] + 0.0, "Pa*sqrt(m)");
    const bool rounding = fabs(p->K[1]) < 1e-9 * fabs(p->K[0]);
    print_quantity(", K_II = ", rounding ? 0 : p->K[1], "Pa*sqrt(m)\n");
    return;
  }
  if (p->grown) printf("grew from %s on; ", moment(r, p->begun_time, begun));
  printf("%.6g mm long, its tip at (%.6g, %.6g) mm", 1e3 * p->length, 1e3 * p->at[0],
         1e3 * p->at[1]);
  if (p->done) printf(" %s at %s", tip_end_words[p->done], moment(r, p->done_time, when));
  putchar('\n');
}

/* Faces that nothing keeps apart. */
static void conclude_overlap(const run *r, const tips *t, int tip) {
  const tip_state *p = &t->items[tip].now;
  char name[NAME_TEXT], first[MOMENT_TEXT], when[MOMENT_TEXT];
  if (!tip_overlaps(p)) return;
  printf("  overlap    %s: its faces overlap (K_I < 0), first at %s; K_I at least %.4g MPa*sqrt(m)",
         tip_folder(t, tip, name, sizeof name), moment(r, p->first_time, first), 1e-6 * p->least);
  if (t->items[tip].toughness > 0) printf(", %.3g of K_Ic", p->least / t->items[tip].toughness);
  printf(", at %s\n", moment(r, p->least_time, when));
}

void conclude_cracks(const run *r) {
  double released = 0, rated = 0;
  for (int b = 0; b < simulation_bodies(r->simulation); b++) {
    const tips *t = tips_of(r, b);
    for (int n = 0; t && n < t->count; n++)
      conclude_tip(r, t, n);
    for (int n = 0; t && n < t->count; n++)
      conclude_overlap(r, t, n);
    released += t ? t->released : 0;
    rated += t ? t->rated : 0;
  }
  if (rated > 0)
    printf("  growth     released %.5g J, %.2g of the energy release rate over its way, %.5g J\n",
           released, released / rated, rated);
}

/* --- for other programs ----------------------------------------------------------------------- */

static void put_overlap(json *w, const mesh_tip *p) {
  json_key(w, "overlap");
  if (!tip_overlaps(&p->now)) {
    json_null(w);
    return;
  }
  json_object(w);
  json_put_number(w, "first_time", p->now.first_time);
  json_put_number(w, "K_I", p->now.least);
  json_put_number(w, "time", p->now.least_time);
  json_object_end(w);
}

static void put_tip(json *w, const tips *t, int tip) {
  const mesh_tip *p = &t->items[tip];
  char name[NAME_TEXT];
  json_object(w);
  json_put_text(w, "name", tip_folder(t, tip, name, sizeof name));
  json_put_number(w, "x", p->now.at[0]);
  json_put_number(w, "y", p->now.at[1]);
  json_put_number(w, "length", p->now.length);
  json_put_number(w, "speed", p->now.speed);
  json_put_number(w, "begun_time", p->now.grown ? p->now.begun_time : NAN);
  json_put_text(w, "finished", p->now.done ? tip_end_words[p->now.done] : NULL);
  json_put_number(w, "finished_time", p->now.done ? p->now.done_time : NAN);
  put_overlap(w, p);
  json_object_end(w);
}

void put_cracks(json *w, const run *r) {
  double released = 0, rated = 0;
  json_put_array(w, "cracks");
  for (int b = 0; b < simulation_bodies(r->simulation); b++) {
    const tips *t = tips_of(r, b);
    for (int n = 0; t && n < t->count; n++)
      put_tip(w, t, n);
    released += t ? t->released : 0;
    rated += t ? t->rated : 0;
  }
  json_array_end(w);
  json_key(w, "growth");
  if (!(rated > 0)) {
    json_null(w);
    return;
  }
  json_object(w);
  json_put_number(w, "released", released);
  json_put_number(w, "energy_release", rated);
  json_object_end(w);
}
