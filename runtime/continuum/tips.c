#include "runtime/continuum/tips.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "dsl/base/arena.h"
#include "dsl/base/elementary.h"
#include "dsl/base/units.h"
#include "runtime/crack/hoop_stress.h"
#include "runtime/mesh/mesh_fields.h"

static const double MET = 1e-9;       /* of an advance: nearer is where it begins */
static const double ON_BORDER = 1e-6; /* spacings */
static const double OVERLAP = 0.01;   /* of the largest K_I: less is noise */

/* --- set-up ----------------------------------------------------------------------------------- */

/* Not on the border nor on that of a hole. */
static bool is_inside(const mesh *m, const double at[2]) {
  bool inside = !holes_near(&m->holes, at, ON_BORDER * m->spacing[0]);
  for (int a = 0; a < 2; a++) {
    const double margin = ON_BORDER * m->spacing[a];
    inside =
        inside && at[a] > m->corner[a] + margin && at[a] < mesh_at(m, a, m->nodes[a] - 1) - margin;
  }
  return inside;
}

static double distance(const double a[2], const double b[2]) {
  return pl_hypot(b[0] - a[0], b[1] - a[1]);
}

/* Of what a leg has outside of holes. */
static double leg_length(const mesh *m, const double a[2], const double b[2]) {
  double *u, sum = 0;
  const int count = holes_cuts(&m->holes, a, b, &u);
  for (int k = 0; k + 1 < count; k++) {
    const double middle = 0.5 * (u[k] + u[k + 1]);
    const double at[2] = {a[0] + middle * (b[0] - a[0]), a[1] + middle * (b[1] - a[1])};
    if (!holes_hold(&m->holes, at)) sum += u[k + 1] - u[k];
  }
  free(u);
  return sum * distance(a, b);
}

static double line_length(const deck_crack *c, const mesh *m) {
  double sum = 0;
  for (int k = 1; k < c->point_count; k++)
    sum += leg_length(m, c->points + 2 * k - 2, c->points + 2 * k);
  return sum;
}

/* Two legs are one where the crack does not turn between them. */
static bool goes_on(const double a[2], const double b[2], const double c[2]) {
  const double u[2] = {b[0] - a[0], b[1] - a[1]}, v[2] = {c[0] - b[0], c[1] - b[1]};
  const double along = u[0] * v[0] + u[1] * v[1], across = u[0] * v[1] - u[1] * v[0];
  return along > 0 && fabs(across) < 1e-9 * along;
}

static mesh_tip tip_of(const deck_crack *c, const mesh *m, bool at_start) {
  const int end = at_start ? 0 : c->point_count - 1, step = at_start ? 1 : -1;
  int before = end + step;
  while (before + step >= 0 && before + step < c->point_count &&
         goes_on(c->points + 2 * (before + step), c->points + 2 * before, c->points + 2 * end))
    before += step;
  const double *at = c->points + 2 * end, *from = c->points + 2 * before;
  return (mesh_tip){.of = c,
                    .at_start = at_start,
                    .now = {.at = {at[0], at[1]},
                            .angle = pl_atan2(at[1] - from[1], at[0] - from[0]),
                            .last = distance(from, at) * holes_until(&m->holes, at, from),
                            .length = line_length(c, m)}};
}

static void add_tip(tips *t, mesh *m, mesh_tip tip) {
  tip.number = t->count;
  t->items = must_realloc(t->items, ((size_t)t->count + 1) * sizeof *t->items);
  m->cracks.tips = must_realloc(m->cracks.tips, ((size_t)t->count + 1) * sizeof *m->cracks.tips);
  memcpy(m->cracks.tips[t->count], tip.now.at, sizeof tip.now.at);
  t->items[t->count++] = tip;
  m->cracks.tip_count = t->count;
}

/* A finite element knows nothing of cracks. */
static bool is_seen(const deck_crack *c, const mesh *m, diagnostics *d) {
  for (int k = 1; k < c->point_count; k++) {
    const double *a = c->points + 2 * k - 2, *b = c->points + 2 * k;
    const double finest = 0.1 * pl_min(m->spacing[0], m->spacing[1]);
    const int parts = (int)ceil(distance(a, b) / finest) + 1;
    for (int n = 0; n < parts; n++) {
      const double u = (n + 0.5) / parts,
                   at[2] = {a[0] + u * (b[0] - a[0]), a[1] + u * (b[1] - a[1])};
      const int cell = mesh_cell_of(m, at);
      if (cell >= 0 && m->cell[cell] != CELL_ELEMENT) continue;
      diag_report(d, DIAG_BAD_VALUE, deck_where(&c->item, "points"),
                  cell < 0 ? "the crack leaves the mesh at (%.6g, %.6g) mm"
                           : "at (%.6g, %.6g) mm the crack is in a finite element, which does not "
                             "see it",
                  1e3 * at[0], 1e3 * at[1]);
      diag_hint(d, cell < 0
                       ? "a crack may end on the edge of the mesh, not beyond"
                       : "make that part element-free: by the mesh's `method`, and no `&zone` of "
                         "finite elements there");
      return false;
    }
  }
  return true;
}

static bool is_in_material(const deck_crack *c, const mesh *m, diagnostics *d) {
  if (m->holes.count == 0 || line_length(c, m) > ON_BORDER * m->spacing[0]) return true;
  diag_report(d, DIAG_BAD_VALUE, deck_where(&c->item, "points"), "the crack lies in a hole");
  diag_hint(d, "one that begins on the outline of a hole, or inside, has to leave it");
  return false;
}

/* Along a row of nodes all of these count as on one side: K_I is 57 % low, and K_II is none of the
   body's. */
static void warn_of_nodes(const deck_crack *c, const mesh *m, diagnostics *d) {
  for (int k = 1; k < c->point_count; k++)
    for (int a = 0; a < 2; a++) {
      const double *from = c->points + 2 * k - 2, *to = c->points + 2 * k;
      const double row = (from[a] - m->corner[a]) / m->spacing[a];
      if (fabs(from[a] - to[a]) > ON_BORDER * m->spacing[a] || fabs(row - round(row)) > ON_BORDER)
        continue;
      diag_report(d, DIAG_DECK_WARNING, deck_where(&c->item, "points"),
                  "leg %d of the crack runs along a %s of nodes, which all count as on one of its "
                  "sides: stress intensities will be wrong",
                  k, a ? "row" : "column");
      diag_hint(d,
                "move it by a fifth of a spacing, %.4g mm, along %c, or take another number of "
                "nodes",
                0.2e3 * m->spacing[a], "xy"[a]);
      return;
    }
}

tip_box tips_box(const tips *t, const mesh_tip *p) {
  const box_weight weight = t->options->integral == TIPS_PYRAMID ? WEIGHT_PYRAMID : WEIGHT_PLATEAU;
  return tip_box_of(p->now.at, p->now.angle, t->half_size, p->now.last, !p->now.grown, weight);
}

static bool meets_hole(const tip_box *b, const mesh *m) {
  enum { LINES = 32 }; /* along the crack */
  const double c = pl_cos(b->angle), s = pl_sin(b->angle);
  double lower[2], upper[2];
  tip_box_extent(b, lower, upper);
  if (!holes_meet_box(&m->holes, lower, upper)) return false;
  for (int n = 0; n <= LINES; n++) {
    const double up = b->across * (2.0 * n / LINES - 1),
                 back[2] = {b->at[0] - c * b->behind - s * up, b->at[1] - s * b->behind + c * up},
                 front[2] = {b->at[0] + c * b->ahead - s * up, b->at[1] + s * b->ahead + c * up};
    if (holes_until(&m->holes, back, front) < 1) return true;
  }
  return false;
}

static bool leaves_mesh(const tip_box *b, const mesh_tip *p, const mesh *m) {
  double lower[2], upper[2];
  tip_box_extent(b, lower, upper);
  for (int a = 0; a < 2; a++) {
    const double margin = ON_BORDER * m->spacing[a], first = m->corner[a],
                 last = mesh_at(m, a, m->nodes[a] - 1), *at = p->now.at;
    const bool half = p->of->symmetry; /* beyond the tip's own edge there is the mirror image */
    if ((lower[a] < first - margin && !(half && at[a] <= first + margin)) ||
        (upper[a] > last + margin && !(half && at[a] >= last - margin)))
      return true;
  }
  return false;
}

/* A box as small as the last leg, between points of integration. */
static void warn_of_short_leg(const mesh_tip *p, const tip_box *b, const mesh *m, diagnostics *d) {
  const double least = 0.5 * pl_min(m->spacing[0], m->spacing[1]);
  if (b->across >= least) return;
  diag_report(d, DIAG_DECK_WARNING, deck_where(&p->of->item, "points"),
              "the leg that ends at (%.6g, %.6g) mm is %.4g mm long, and the box around the tip "
              "reaches no farther: it holds too few points for stress intensities",
              1e3 * p->now.at[0], 1e3 * p->now.at[1], 1e3 * p->now.last);
  diag_hint(d, "make it at least half a spacing long, %.4g mm, or give &tips `points` of its own",
            1e3 * least);
}

/* Beyond the edge of the mesh and in holes there is nothing to integrate. */
static void warn_of_box(const tips *t, const mesh_tip *p, const mesh *m, diagnostics *d) {
  const tip_box b = tips_box(t, p);
  if (t->options->points == 0) warn_of_short_leg(p, &b, m, d);
  const bool leaves = leaves_mesh(&b, p, m);
  if (!leaves && !meets_hole(&b, m)) return;
  diag_report(
      d, DIAG_DECK_WARNING, deck_where(&p->of->item, "points"),
      "the box around the tip at (%.6g, %.6g) mm reaches %s: its stress intensities will be "
      "wrong",
      1e3 * p->now.at[0], 1e3 * p->now.at[1],
      leaves ? "beyond the edge of the mesh" : "into a hole");
  diag_hint(d, "it reaches %.4g mm to each side; make `half_size` of &tips smaller",
            1e3 * b.across);
}

/* A crack that ends at a hole parts its two sides up to the middle: lines that graze the hole
   pass. */
static void add_mouth(const deck_crack *c, mesh *m, int end, int before) {
  double middle[2];
  if (holes_beyond(&m->holes, c->points + 2 * before, c->points + 2 * end, middle))
    crack_lines_add(&m->cracks, c->points + 2 * end, middle);
}

/* Along which axis the edge of the mesh runs that both places lie on; -1: none. */
static int edge_with(const mesh *m, const double a[2], const double b[2]) {
  for (int across = 0; across < 2 && !m->mapped; across++)
    for (int side = 0; side < 2; side++) {
      const double edge = mesh_at(m, across, side ? m->nodes[across] - 1 : 0),
                   margin = ON_BORDER * m->spacing[across];
      if (fabs(a[across] - edge) <= margin && fabs(b[across] - edge) <= margin) return 1 - across;
    }
  return -1;
}

/* A free face of half of a body: its tips are the ends that are no corners of the mesh. */
static bool add_face(tips *t, const deck_crack *c, mesh *m, diagnostics *d) {
  const int before = t->count,
            axis = c->point_count == 2 ? edge_with(m, c->points, c->points + 2) : -1;
  if (axis < 0) {
    diag_report(d, DIAG_BAD_VALUE, deck_where(&c->item, "points"),
                "a crack on a line of symmetry has two points, both on one straight edge of the "
                "rectangle `%s`",
                c->mesh);
    return false;
  }
  for (int start = 1; start >= 0; start--) {
    const mesh_tip tip = tip_of(c, m, start);
    const double margin = ON_BORDER * m->spacing[axis], at = tip.now.at[axis];
    if (at <= m->corner[axis] + margin || at >= mesh_at(m, axis, m->nodes[axis] - 1) - margin)
      continue;
    add_tip(t, m, tip);
    warn_of_box(t, &t->items[t->count - 1], m, d);
  }
  if (t->count > before) return true;
  diag_report(d, DIAG_BAD_VALUE, deck_where(&c->item, "points"),
              "this crack has no tip: both of its ends are corners of the mesh, or beyond them");
  return false;
}

static bool add_crack(tips *t, const deck_crack *c, mesh *m, diagnostics *d) {
  if (c->symmetry) return add_face(t, c, m, d);
  if (!is_seen(c, m, d) || !is_in_material(c, m, d)) return false;
  warn_of_nodes(c, m, d);
  for (int k = 1; k < c->point_count; k++)
    crack_lines_add(&m->cracks, c->points + 2 * k - 2, c->points + 2 * k);
  add_mouth(c, m, 0, 1);
  add_mouth(c, m, c->point_count - 1, c->point_count - 2);
  for (int start = 1; start >= 0; start--) {
    const mesh_tip tip = tip_of(c, m, start);
    if (!is_inside(m, tip.now.at)) continue;
    add_tip(t, m, tip);
    warn_of_box(t, &t->items[t->count - 1], m, d);
  }
  return true;
}

bool tips_new(const deck *k, const char *name, mesh *m, tips **out, diagnostics *d) {
  tips *t = must_calloc(1, sizeof *t);
  bool good = true, any = false;
  t->options = &k->tips;
  t->beta_1 = k->newmark.beta_1;
  t->half_size = k->tips.half_size * m->spacing[0];
  for (int n = 0; n < k->crack_count; n++)
    if (strcmp(k->cracks[n].mesh, name) == 0) {
      good = add_crack(t, &k->cracks[n], m, d) && good;
      any = true;
    }
  if (any) {
    for (int a = 0; a < 2; a++) {
      t->kept[a] = must_calloc((size_t)mesh_node_count(m), sizeof(double));
      t->velocity[a] = must_calloc((size_t)mesh_node_count(m), sizeof(double));
      t->acceleration[a] = must_calloc((size_t)mesh_node_count(m), sizeof(double));
    }
    t->loaded = must_calloc((size_t)mesh_node_count(m), 1);
    t->segment = k->tips.segment * m->spacing[0];
    for (int a = 0; a < 2; a++) {
      t->lower[a] = m->corner[a];
      t->upper[a] = mesh_at(m, a, m->nodes[a] - 1);
      if (!(k->tips.size[a] > 0)) continue;
      t->lower[a] = pl_max(t->lower[a], k->tips.corner[a]);
      t->upper[a] = pl_min(t->upper[a], k->tips.corner[a] + k->tips.size[a]);
    }
    t->pieces.items = must_calloc(TIPS_MOST_PIECES, sizeof *t->pieces.items);
    t->pieces.tip = must_calloc(TIPS_MOST_PIECES, sizeof *t->pieces.tip);
    t->pieces.leg = must_calloc(TIPS_MOST_PIECES, 1);
    *out = t;
  } else {
    free(t);
  }
  return good;
}

void tips_free(tips *t) {
  if (!t) return;
  for (int n = 0; n < t->count; n++) {
    free(t->items[n].uniforms);
    free(t->items[n].field);
    free(t->items[n].new_field);
    free(t->items[n].observed);
  }
  free(t->pieces.items);
  free(t->pieces.tip);
  free(t->pieces.leg);
  free(t->items);
  free(t->points);
  for (int a = 0; a < 2; a++) {
    free(t->kept[a]);
    free(t->velocity[a]);
    free(t->acceleration[a]);
  }
  free(t->loaded);
  free(t);
}

static double *lanes(int count) {
  return must_calloc((size_t)count * PL_LANES + 1, sizeof(double));
}

/* The only parameter that is one, if there is just one. */
static double toughness_of(const tip_law *l) {
  double found = 0;
  int count = 0;
  for (int n = 0; n < l->law->parameter_count; n++)
    if (dim_equal(dimension_of(l->law->parameters[n].unit), dimension_of("Pa*sqrt(m)"))) {
      found = l->parameters[n];
      count++;
    }
  return count == 1 ? found : 0;
}

/* Each tip has the law's states for itself. */
static void give_law(mesh_tip *p, const tip_law *l) {
  const pl_bond_class none = {.size = sizeof none};
  const pl_law *law = l->law;
  if (!law) return;
  p->toughness = toughness_of(l);
  if (!p->of->grows) return;
  p->law = law;
  p->uniforms = must_calloc((size_t)law->uniform_count + 1, sizeof(double));
  p->field = lanes(law->field_count);
  p->new_field = lanes(law->field_count);
  p->observed = lanes(law->output_count);
  law->prepare(law, l->parameters, &none, p->uniforms);
  for (int f = 0; f < law->field_count; f++)
    for (int lane = 0; lane < PL_LANES; lane++)
      p->field[f * PL_LANES + lane] = law->fields[f].initial;
}

void tips_take(tips *t, const deck *k, const plane_stiffness *law, double density,
               const tip_law *cracks, double time_step) {
  const deck_tips *o = t->options;
  t->medium = crack_medium_of(law->D[0][0], law->D[0][1], law->D[2][2], density);
  t->check_steps = o->check_every > 0 ? llround(o->check_every / time_step) : o->check_steps;
  if (t->check_steps < 1) t->check_steps = 1;
  t->first_step = (int64_t)ceil(o->from / time_step - 1e-6);
  t->update_steps = t->check_steps / o->updates;
  if (t->update_steps < 1) t->update_steps = 1;
  t->planned[0] = t->check_steps;
  t->planned[1] = t->update_steps;
  t->planned[2] = t->first_step;
  for (int n = 0; n < t->count; n++)
    give_law(&t->items[n], &cracks[t->items[n].of - k->cracks]);
}

void tips_shrink(tips *t, int64_t times) {
  t->check_steps = times * t->planned[0];
  t->update_steps = times * t->planned[1];
  t->first_step = times * t->planned[2];
}

/* --- a look ----------------------------------------------------------------------------------- */

static double tips_speed(const tips *t, const mesh_tip *p) {
  return pl_max(p->now.speed, 0.01 * t->medium.c_s);
}

static bool is_time(const tips *t, int64_t step) {
  return t->count > 0 && step >= t->first_step && step % t->check_steps == 0;
}

void tips_before(tips *t, const body *w, const node_stencil *k) {
  if (!is_time(t, t->step + 1)) return;
  for (int d = 0; d < 2; d++)
    for (int n = 0; n < mesh_node_count(k->of); n++)
      t->kept[d][n] = w->velocity[d][node_layout_at(&k->layout, n)];
}

/* Velocities of the nodes at the present instant, and accelerations less gravity, which are what
   the stresses give: div sigma = rho (u'' - g). Their places are there. */
static void find_motion(tips *t, const body *w, double *const last_resistance[2],
                        const node_stencil *k) {
  pool *memory = pool_new();
  double *const force[2] = {pool_doubles(memory, k->layout.size),
                            pool_doubles(memory, k->layout.size)};
  node_stencil_multiply(k, (const double *const *)w->displacement, force, 0, k->layout.nodes[1]);
  for (int d = 0; d < 2; d++)
    for (int n = 0; n < mesh_node_count(k->of); n++) {
      const long site = node_layout_at(&k->layout, n);
      const double before = w->velocity[d][site];
      const double mass = body_mass(w, d, site), g = w->gravity[d];
      const double a =
          t->loaded[n] ? (before - t->kept[d][n]) / w->time_step - g : -force[d][site] / mass;
      const double last = t->loaded[n] ? a : -last_resistance[d][site] / mass;
      t->acceleration[d][n] = a;
      t->velocity[d][n] = before + w->time_step * (0.5 * (a + g) + (t->beta_1 - 0.5) * (a - last));
    }
  pool_free(memory);
}

/* The body's fields at a point. */
static tip_point fields_at(const tips *t, const body *w, const node_stencil *k, const double at[2],
                           double area, int cell) {
  tip_point p = {.at = {at[0], at[1]}, .area = area};
  point_shape s;
  shape_functions(k->of, cell, at, &s);
  mesh_field(&s, &k->layout, (const double *const *)w->displacement, NULL, p.gradient);
  for (int q = 0; q < s.count; q++)
    for (int d = 0; d < 2; d++) {
      const double v = t->velocity[d][s.node[q]];
      p.velocity[d] += s.n[q] * v;
      p.velocity_gradient[d][0] += s.nx[q] * v;
      p.velocity_gradient[d][1] += s.ny[q] * v;
      p.acceleration[d] += s.n[q] * t->acceleration[d][s.node[q]];
    }
  const double e[3] = {p.gradient[0][0], p.gradient[1][1], p.gradient[0][1] + p.gradient[1][0]};
  const plane_stiffness *law = node_stencil_law(k, cell);
  for (int a = 0; a < 3; a++)
    for (int b = 0; b < 3; b++)
      p.stress[a] += law->D[a][b] * e[b];
  return p;
}

static void note(tips *t, int count, tip_point p) {
  if (count == t->room) {
    t->room = t->room ? 2 * t->room : 1024;
    t->points = must_realloc(t->points, (size_t)t->room * sizeof *t->points);
  }
  t->points[count] = p;
}

/* The mesh's points inside the box. */
static int points_of_mesh(tips *t, const body *w, const node_stencil *k, const tip_box *b) {
  const mesh *m = k->of;
  double lower[2], upper[2], slope[2];
  int first[2], last[2], count = 0;
  tip_box_extent(b, lower, upper);
  for (int a = 0; a < 2; a++) {
    first[a] = (int)floor((lower[a] - m->corner[a]) / m->spacing[a]);
    last[a] = (int)floor((upper[a] - m->corner[a]) / m->spacing[a]);
    if (first[a] < 0) first[a] = 0;
    if (last[a] > m->nodes[a] - 2) last[a] = m->nodes[a] - 2;
  }
  for (int j = first[1]; j <= last[1]; j++)
    for (int i = first[0]; i <= last[0]; i++) {
      const int cell = mesh_cell_at(m, i, j);
      if (!node_stencil_law(k, cell)) continue;
      for (int n = k->points->first[cell]; n < k->points->first[cell + 1]; n++) {
        const double *at = k->points->at[n];
        if (tip_box_weight(b, at, slope) == 0) continue;
        note(t, count++, fields_at(t, w, k, at, k->points->area[n], cell));
      }
    }
  return count;
}

/* Own points of the box: cells of 2 x 2 in each quadrant. Those outside the mesh are left out, and
   so are those in cells of laws that are not linear. */
static int points_of_box(tips *t, const body *w, const node_stencil *k, const tip_box *b) {
  const int cells = t->options->points;
  const double c = pl_cos(b->angle), s = pl_sin(b->angle), gauss = 1 / sqrt(3.0);
  int count = 0;
  for (int quadrant = 0; quadrant < 4; quadrant++)
    for (int n = 0; n < 4 * cells * cells; n++) {
      const double side[2] = {quadrant % 2 ? -b->behind : b->ahead,
                              quadrant / 2 ? -b->across : b->across};
      const int i = n % (2 * cells), j = n / (2 * cells);
      const double x = side[0] * (i / 2 + 0.5 * (1 + (i % 2 ? gauss : -gauss))) / cells,
                   y = side[1] * (j / 2 + 0.5 * (1 + (j % 2 ? gauss : -gauss))) / cells;
      const double at[2] = {b->at[0] + c * x - s * y, b->at[1] + s * x + c * y};
      const int cell = mesh_cell_of(k->of, at);
      if (cell < 0 || k->of->cell[cell] == CELL_ABSENT || !node_stencil_law(k, cell) ||
          holes_hold(&k->of->holes, at))
        continue;
      const double area = fabs(side[0] * side[1]) / (4.0 * cells * cells);
      note(t, count++, fields_at(t, w, k, at, area, cell));
    }
  return count;
}

static void look_at(tips *t, mesh_tip *p, const body *w, const node_stencil *k) {
  const tip_box b = tips_box(t, p);
  const int count =
      t->options->points > 0 ? points_of_box(t, w, k, &b) : points_of_mesh(t, w, k, &b);
  tip_intensity(&t->medium, &b, t->points, count, p->now.speed, p->now.K);
  if (!p->of->symmetry) return;
  p->now.K[0] *= 2; /* the mirror image has as much of mode I, and the opposite of mode II */
  p->now.K[1] = 0;
}

bool tip_overlaps(const tip_state *p) {
  return p->least < -OVERLAP * p->largest;
}

static void note_overlap(const tips *t, mesh_tip *p, const body *w) {
  const double time = (double)t->step * w->time_step, K = p->now.K[0];
  p->now.largest = pl_max(p->now.largest, fabs(K));
  if (K < 0 && K < p->now.first / OVERLAP) {
    p->now.first = K;
    p->now.first_time = time;
  }
  if (!(K < p->now.least)) return;
  p->now.least = K;
  p->now.least_time = time;
}

/* --- growth ----------------------------------------------------------------------------------- */

/* What the law says of a tip: [PL_TIP_RESULTS]. */
static void ask_law(const tips *t, mesh_tip *p, double *said) {
  const double values[PL_TIP_INPUTS] = {
      p->now.K[0],   p->now.K[1],   tip_energy_release(&t->medium, tips_speed(t, p), p->now.K),
      p->now.angle,  p->now.speed,  p->now.length,
      t->medium.c_R, t->medium.c_s, t->medium.c_d};
  double in[PL_TIP_INPUTS][PL_LANES], out[PL_TIP_RESULTS][PL_LANES];
  const double *from[PL_TIP_INPUTS];
  double *to[PL_TIP_RESULTS];
  const int fields = p->law->field_count, outputs = p->law->output_count;
  double **field = must_calloc((size_t)(2 * fields + outputs) + 1, sizeof *field);
  for (int k = 0; k < PL_TIP_INPUTS; k++) {
    for (int lane = 0; lane < PL_LANES; lane++)
      in[k][lane] = values[k];
    from[k] = in[k];
  }
  for (int k = 0; k < PL_TIP_RESULTS; k++)
    to[k] = out[k];
  for (int f = 0; f < fields; f++) {
    field[f] = p->field + f * PL_LANES;
    field[fields + f] = p->new_field + f * PL_LANES;
  }
  for (int k = 0; k < outputs; k++)
    field[2 * fields + k] = p->observed + k * PL_LANES;
  const pl_tips asked = {.size = sizeof asked,
                         .count = PL_LANES,
                         .in = from,
                         .old_field = (const double *const *)field,
                         .new_field = field + fields,
                         .out = to,
                         .observed = field + 2 * fields};
  p->law->tip_look(p->law, p->uniforms, &asked);
  memcpy(p->field, p->new_field, (size_t)fields * PL_LANES * sizeof(double));
  for (int k = 0; k < PL_TIP_RESULTS; k++)
    said[k] = out[k][0];
  free(field);
}

/* The square around a tip holds a cell of another law. */
static bool is_near_law(const tips *t, const mesh_tip *p, const node_stencil *k) {
  const mesh *m = k->of;
  int first[2], last[2];
  for (int a = 0; a < 2 && k->law_of_cell; a++) {
    first[a] = (int)floor((p->now.at[a] - t->half_size - m->corner[a]) / m->spacing[a]);
    last[a] = (int)floor((p->now.at[a] + t->half_size - m->corner[a]) / m->spacing[a]);
    if (first[a] < 0) first[a] = 0;
    if (last[a] > m->nodes[a] - 2) last[a] = m->nodes[a] - 2;
  }
  for (int j = first[1]; k->law_of_cell && j <= last[1]; j++)
    for (int i = first[0]; i <= last[0]; i++)
      if (m->cell[mesh_cell_at(m, i, j)] != CELL_ABSENT &&
          k->law_of_cell[mesh_cell_at(m, i, j)] != t->law)
        return true;
  return false;
}

/* A grown tip near the edge of the mesh, a hole or another law keeps its direction: the box around
   it is cut. */
static bool is_near_edge(const tips *t, const mesh_tip *p, const node_stencil *k) {
  const mesh *m = k->of;
  bool near = holes_near(&m->holes, p->now.at, t->half_size) || is_near_law(t, p, k);
  for (int a = 0; a < 2; a++)
    near = near || p->now.at[a] - m->corner[a] < t->half_size ||
           mesh_at(m, a, m->nodes[a] - 1) - p->now.at[a] < t->half_size;
  return near && p->now.grown;
}

/* Arrest, or growth at the law's speed; a new leg where the crack may turn. */
static void decide(tips *t, mesh_tip *p, const node_stencil *k) {
  double said[PL_TIP_RESULTS];
  ask_law(t, p, said);
  if (!(said[PL_TIP_GROW] > 0)) {
    p->now.speed = 0;
    return;
  }
  const bool may_turn = p->now.segments == 0 || p->now.last >= t->segment;
  p->now.speed = said[PL_TIP_RUN];
  if (!may_turn || is_near_edge(t, p, k)) return;
  p->now.angle += said[PL_TIP_TOWARD];
  p->now.last = 0;
  p->now.segments++;
}

static double cross(const double a[2], const double b[2]) {
  return a[0] * b[1] - a[1] * b[0];
}

/* Of pieces on one line: until the nearer end of the other one ahead; 0 where that begins here. */
static double until_met_ahead(const double u[2], const double c[2], const double d[2]) {
  const double square = u[0] * u[0] + u[1] * u[1], to_c = (c[0] * u[0] + c[1] * u[1]) / square,
               to_d = (d[0] * u[0] + d[1] * u[1]) / square;
  const double nearer = pl_min(to_c, to_d), farther = pl_max(to_c, to_d);
  if (farther <= MET) return 1;
  return nearer > MET ? pl_min(nearer, 1) : 0;
}

/* Part of a -> b until it meets the other piece; 1: it does not. Both are on one line where they
   are nearer than `hardly`. */
static double until_met(const double a[2], const double b[2], const crack_piece *other,
                        double hardly) {
  const double u[2] = {b[0] - a[0], b[1] - a[1]}, c[2] = {other->a[0] - a[0], other->a[1] - a[1]},
               d[2] = {other->b[0] - a[0], other->b[1] - a[1]}, v[2] = {d[0] - c[0], d[1] - c[1]};
  const double near = hardly * pl_hypot(u[0], u[1]);
  if (fabs(cross(u, c)) < near && fabs(cross(u, d)) < near) return until_met_ahead(u, c, d);
  const double turn = cross(u, v);
  if (turn == 0) return 1;
  const double along = cross(c, v) / turn, there = cross(c, u) / turn;
  return along > MET && along < 1 && there >= 0 && there <= 1 ? along : 1;
}

static double until_left(const double a[2], const double b[2], const double lower[2],
                         const double upper[2]) {
  double part = 1;
  for (int k = 0; k < 2; k++) {
    if (b[k] < lower[k]) part = pl_min(part, (lower[k] - a[k]) / (b[k] - a[k]));
    if (b[k] > upper[k]) part = pl_min(part, (upper[k] - a[k]) / (b[k] - a[k]));
  }
  return pl_max(part, 0);
}

const char *const tip_end_words[TIP_ENDS] = {
    [TIP_ALIVE] = "",
    [TIP_HAS_LEFT] = "has left where cracks grow",
    [TIP_HAS_MET] = "has met another crack",
    [TIP_AT_HOLE] = "has run into a hole",
    [TIP_AT_ELEMENTS] = "has come to finite elements, which do not see it",
    [TIP_AT_LAW] = "has come to another material",
    [TIP_HAS_TOO_MANY] = "has grown by more pieces than can be kept",
};

static void finish(const tips *t, mesh_tip *p, const body *w, tip_end why) {
  p->now.done = why;
  p->now.done_time = (double)t->step * w->time_step;
  p->now.speed = 0;
}

enum { PIECE_GOES_ON, PIECE_BEGINS_LEG, PIECE_IN_HOLE };

static void keep_piece(tips *t, const mesh_tip *p, const double a[2], const double b[2],
                       unsigned char kind) {
  tip_pieces *all = &t->pieces;
  crack_piece *piece = &all->items[all->count];
  memcpy(piece->a, a, sizeof piece->a);
  memcpy(piece->b, b, sizeof piece->b);
  all->tip[all->count] = p->number;
  all->leg[all->count++] = kind;
}

/* A crack that has run into a hole: see add_mouth. */
static void part_hole(tips *t, const mesh_tip *p, const double from[2], mesh *m, node_stencil *k) {
  double middle[2];
  if (t->pieces.count == TIPS_MOST_PIECES || !holes_beyond(&m->holes, from, p->now.at, middle))
    return;
  keep_piece(t, p, p->now.at, middle, PIECE_IN_HOLE);
  node_stencil_grow(k, m, p->now.at, middle, -1);
}

/* By its way over the time between two advances; shorter where something ends it. */
static void advance(tips *t, mesh_tip *p, const body *w, mesh *m, node_stencil *k) {
  const double way = p->now.speed * w->time_step * (double)t->update_steps;
  const double *a = p->now.at,
               b[2] = {a[0] + way * pl_cos(p->now.angle), a[1] + way * pl_sin(p->now.angle)};
  double part = until_left(a, b, t->lower, t->upper);
  tip_end why = part < 1 ? TIP_HAS_LEFT : TIP_ALIVE;
  for (int n = 0; n < m->cracks.count; n++) {
    const double met = until_met(a, b, &m->cracks.pieces[n], ON_BORDER * m->spacing[0]);
    if (met >= part) continue;
    part = met;
    why = TIP_HAS_MET;
  }
  const double hole = holes_until(&m->holes, a, b);
  if (hole < part) {
    part = hole;
    why = TIP_AT_HOLE;
  }
  const double to[2] = {a[0] + part * (b[0] - a[0]), a[1] + part * (b[1] - a[1])},
               from[2] = {a[0], a[1]};
  const int cell = mesh_cell_of(m, to);
  if (cell >= 0 && m->cell[cell] == CELL_ELEMENT) {
    finish(t, p, w, TIP_AT_ELEMENTS);
    return;
  }
  if (cell >= 0 && k->law_of_cell && k->law_of_cell[cell] != t->law) {
    finish(t, p, w, TIP_AT_LAW);
    return;
  }
  if (t->pieces.count == TIPS_MOST_PIECES) {
    finish(t, p, w, TIP_HAS_TOO_MANY);
    return;
  }
  if (part * way > 0) {
    t->rated +=
        part * way * m->thickness * tip_energy_release(&t->medium, tips_speed(t, p), p->now.K);
    keep_piece(t, p, from, to, p->now.last == 0 ? PIECE_BEGINS_LEG : PIECE_GOES_ON);
    node_stencil_grow(k, m, from, to, p->number);
    p->now.last += part * way;
    p->now.length += part * way;
    memcpy(p->now.at, to, sizeof to);
    p->now.grown = 1;
  }
  if (hole < 1 && part == hole) part_hole(t, p, from, m, k);
  if (why != TIP_ALIVE) finish(t, p, w, why);
}

/* u_n K u_(n-1)/2 of the last step. */
static double stored(const body *w, const node_stencil *k, double *const product[2]) {
  double sum = 0;
  node_stencil_multiply(k, (const double *const *)w->displacement, product, 0, k->layout.nodes[1]);
  for (int d = 0; d < 2; d++)
    for (long q = 0; q < k->layout.size; q++)
      sum += 0.5 * product[d][q] * (w->displacement[d][q] - w->time_step * w->velocity[d][q]);
  return sum;
}

static bool some_grows(const tips *t) {
  for (int n = 0; n < t->count; n++)
    if (t->items[n].now.speed > 0 && !t->items[n].now.done) return true;
  return false;
}

static void grow(tips *t, const body *w, mesh *m, node_stencil *k) {
  pool *memory = pool_new();
  double *const product[2] = {pool_doubles(memory, k->layout.size),
                              pool_doubles(memory, k->layout.size)};
  const double before = stored(w, k, product);
  for (int n = 0; n < t->count; n++) {
    mesh_tip *p = &t->items[n];
    if (p->now.speed > 0 && !p->now.done) advance(t, p, w, m, k);
  }
  t->released += before - stored(w, k, product);
  pool_free(memory);
}

static void look(tips *t, const body *w, double *const last_resistance[2], const node_stencil *k) {
  find_motion(t, w, last_resistance, k);
  for (int n = 0; n < t->count; n++) {
    mesh_tip *p = &t->items[n];
    if (p->now.done) continue;
    look_at(t, p, w, k);
    note_overlap(t, p, w);
    if (p->law) decide(t, p, k);
    if (p->now.speed > 0 && p->now.begun_time == 0)
      p->now.begun_time = (double)t->step * w->time_step;
  }
}

void tips_after(tips *t, const body *w, double *const last_resistance[2], mesh *m,
                node_stencil *k) {
  if (t->step > 0 && t->step % t->update_steps == 0 && some_grows(t)) grow(t, w, m, k);
  t->step++;
  if (is_time(t, t->step)) look(t, w, last_resistance, k);
}

void tips_at_rest(tips *t, const body *w, const node_stencil *k) {
  for (int d = 0; d < 2; d++)
    for (int n = 0; n < mesh_node_count(k->of); n++)
      t->acceleration[d][n] = -w->gravity[d]; /* velocities are 0, as they began */
  for (int n = 0; n < t->count; n++) {
    look_at(t, &t->items[n], w, k);
    note_overlap(t, &t->items[n], w);
  }
}

void tips_replay(tips *t, mesh *m, node_stencil *k) {
  if (t->pieces.count < 0 || t->pieces.count > TIPS_MOST_PIECES) t->pieces.count = 0;
  for (int64_t n = 0; n < t->pieces.count; n++)
    if (t->pieces.tip[n] >= 0 && t->pieces.tip[n] < t->count)
      node_stencil_grow(k, m, t->pieces.items[n].a, t->pieces.items[n].b,
                        t->pieces.leg[n] == PIECE_IN_HOLE ? -1 : t->pieces.tip[n]);
}

int tip_path(const tips *t, int tip, double (*at)[2], int most) {
  int count = 0;
  for (int64_t n = 0; n < t->pieces.count; n++) {
    if (t->pieces.tip[n] != tip || t->pieces.leg[n] == PIECE_IN_HOLE) continue;
    const crack_piece *p = &t->pieces.items[n];
    if (count == 0 && most > 0) memcpy(at[count++], p->a, sizeof p->a);
    if (count > 1 && t->pieces.leg[n] == PIECE_GOES_ON) count--;
    if (count < most) memcpy(at[count++], p->b, sizeof p->b);
  }
  return count;
}

/* --- series ----------------------------------------------------------------------------------- */

double tip_value_now(const tips *t, const mesh_tip *p, tip_value which) {
  const tip_state *now = &p->now;
  switch (which) {
  case TIP_K_I:
    return now->K[0];
  case TIP_K_II:
    return now->K[1];
  case TIP_K_eq:
    return hoop_intensity(now->K, hoop_angle(now->K));
  case TIP_kink:
    return hoop_angle(now->K);
  case TIP_energy_release:
    return tip_energy_release(&t->medium, tips_speed(t, p), now->K);
  case TIP_angle:
    return now->angle;
  case TIP_length:
    return now->length;
  case TIP_speed:
    return now->speed;
  case TIP_x:
    return now->at[0];
  case TIP_y:
    return now->at[1];
  case TIP_segments:
    return (double)now->segments;
  case TIP_VALUE_COUNT:
    break;
  }
  return 0;
}

/* Whether the crack's other end is a tip, too. */
static bool has_two(const tips *t, const deck_crack *c) {
  int count = 0;
  for (int n = 0; n < t->count; n++)
    count += t->items[n].of == c;
  return count == 2;
}

const char *tip_folder(const tips *t, int tip, char *text, size_t size) {
  const mesh_tip *p = &t->items[tip];
  const bool start = p->at_start && has_two(t, p->of);
  snprintf(text, size, "%s%s", p->of->name, start ? "/start" : "");
  return text;
}
