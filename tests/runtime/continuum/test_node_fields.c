/* Fields at nodes of a mesh with both methods and a crack: linear ones are exact, each side of the
   crack knows its own. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "runtime/continuum/node_fields.h"
#include "tests/runtime/continuum/hooke_law.h"

enum { ALONG = 9, UP = 8, NODES = ALONG * UP };

typedef struct small_mesh {
  cells c;
  cells_law law;
  point_forces *none;
  rows nodes;
  node_layout layout;
  int32_t *site_particle;
  double *u[2], *out[3];
} small_mesh;

static const double parameters[] = {30e9, 0.2, 2400};

/* Finite elements on the left, of one point or of four. */
static void begin(small_mesh *s, int gauss) {
  const int nodes[2] = {ALONG, UP};
  const double corner[2] = {1, -2}, size[2] = {8 * 0.25, 7 * 0.5};
  memset(s, 0, sizeof *s);
  mesh_open(&s->c.mesh, nodes, corner, size, 0.1, 2.1);
  for (int n = 0; n < NODES; n++)
    if (n % ALONG < 3) s->c.mesh.element_free[n] = 0;
  memset(s->c.mesh.element_gauss, gauss, (size_t)mesh_cell_count(&s->c.mesh));
  mesh_settle(&s->c.mesh);
  s->law = (cells_law){&hooke_law, parameters};
  s->c.where.count = 1;
  s->c.laws = &s->law;
  s->c.by_points = &s->none;
  s->layout = node_layout_of(nodes, 2.1);
  const size_t places = (size_t)s->layout.size;
  s->site_particle = malloc(places * sizeof *s->site_particle);
  for (size_t q = 0; q < places; q++)
    s->site_particle[q] = -1;
  for (int n = 0; n < NODES; n++)
    s->site_particle[node_layout_at(&s->layout, n)] = n;
  s->nodes.site_particle = s->site_particle;
  s->c.nodes = &s->nodes;
  for (int k = 0; k < 2; k++)
    s->u[k] = calloc(places, sizeof(double));
  for (int k = 0; k < 3; k++)
    s->out[k] = calloc(places, sizeof(double));
}

static void end(small_mesh *s) {
  mesh_close(&s->c.mesh);
  free(s->site_particle);
  for (int k = 0; k < 2; k++)
    free(s->u[k]);
  for (int k = 0; k < 3; k++)
    free(s->out[k]);
}

/* u = g x. */
static void displace(small_mesh *s, const double g[2][2]) {
  for (int n = 0; n < NODES; n++) {
    double at[2];
    mesh_place(&s->c.mesh, n, at);
    for (int k = 0; k < 2; k++)
      s->u[k][node_layout_at(&s->layout, n)] = g[k][0] * at[0] + g[k][1] * at[1];
  }
}

static void linear_fields_are_exact(void **state) {
  (void)state;
  static const double g[2][2] = {{1e-3, 4e-4}, {-2e-4, -5e-4}};
  const double strain[3] = {1e-3, -5e-4, 1e-4}, E = 30e9, nu = 0.2;
  const double stress[3] = {E / (1 - nu * nu) * (strain[0] + nu * strain[1]),
                            E / (1 - nu * nu) * (strain[1] + nu * strain[0]),
                            E / (1 + nu) * strain[2]};
  for (int gauss = 1; gauss <= 2; gauss++) {
    small_mesh s;
    double values[2 * NODES];
    begin(&s, gauss);
    displace(&s, g);
    const double *const u[2] = {s.u[0], s.u[1]};
    node_field_values(&s.c, u, values);
    node_field_strain(&s.c, u, s.out);
    for (int n = 0; n < NODES; n++)
      for (int k = 0; k < 3; k++) {
        const long site = node_layout_at(&s.layout, n);
        if (k < 2) assert_true(fabs(values[2 * n + k] - s.u[k][site]) < 1e-13);
        assert_true(fabs(s.out[k][site] - strain[k]) < 1e-12);
      }
    node_field_stress(&s.c, u, s.out);
    for (int n = 0; n < NODES; n++)
      for (int k = 0; k < 3; k++)
        assert_true(fabs(s.out[k][node_layout_at(&s.layout, n)] - stress[k]) < 1e-8 * stress[0]);
    end(&s);
  }
}

/* u_x = a x y in elements with the mean dilatation: that of an element, a y, is a y_middle instead,
   and the half of the difference is in either strain. Around a node inside differences cancel
   out. */
static void the_mean_dilatation_shows(void **state) {
  (void)state;
  const double a = 1e-3, E = 30e9, nu = 0.2, height = 0.5;
  small_mesh s;
  begin(&s, 2);
  memset(s.c.mesh.element_free, 0, NODES);
  memset(s.c.mesh.mean_dilatation, 1, (size_t)mesh_cell_count(&s.c.mesh));
  mesh_settle(&s.c.mesh);
  integration_points_open(&s.c.points, &s.c.mesh);
  for (int n = 0; n < NODES; n++) {
    double at[2];
    mesh_place(&s.c.mesh, n, at);
    s.u[0][node_layout_at(&s.layout, n)] = a * at[0] * at[1];
  }
  const double *const u[2] = {s.u[0], s.u[1]};
  for (int stress = 0; stress < 2; stress++) {
    (stress ? node_field_stress : node_field_strain)(&s.c, u, s.out);
    for (int n = 0; n < NODES; n++) {
      const int row = n / ALONG;
      const double y = -2 + height * row,
                   shift = (row == 0        ? 1
                            : row == UP - 1 ? -1
                                            : 0) *
                           0.25 * a * height,
                   x = a * y + shift, x_of = E / (1 - nu * nu) * (x + nu * shift),
                   y_of = E / (1 - nu * nu) * (shift + nu * x);
      const long site = node_layout_at(&s.layout, n);
      assert_true(fabs(s.out[0][site] - (stress ? x_of : x)) < (stress ? E : 1) * 1e-14);
      assert_true(fabs(s.out[1][site] - (stress ? y_of : shift)) < (stress ? E : 1) * 1e-14);
    }
  }
  integration_points_close(&s.c.points);
  end(&s);
}

/* The parameter of an element-free node is not its displacement; that of an element's node is. */
static void values_are_displacements(void **state) {
  (void)state;
  small_mesh s;
  double values[2 * NODES], far = 0;
  begin(&s, 2);
  for (int n = 0; n < NODES; n++)
    s.u[0][node_layout_at(&s.layout, n)] = (n % ALONG) % 2 ? 1 : -1;
  const double *const u[2] = {s.u[0], s.u[1]};
  node_field_values(&s.c, u, values);
  for (int n = 0; n < NODES; n++) {
    const double off = fabs(values[2 * n] - s.u[0][node_layout_at(&s.layout, n)]);
    if (n % ALONG < 3)
      assert_true(off < 1e-14);
    else if (n % ALONG > 3)
      far = fmax(far, off);
  }
  assert_true(far > 0.1);
  end(&s);
}

/* What is right of the crack has moved as a rigid body, what is left of it has not. */
static void a_crack_parts_its_sides(void **state) {
  (void)state;
  small_mesh s;
  double values[2 * NODES];
  begin(&s, 2);
  const double x = 1 + 5.4 * 0.25, low[2] = {x, -3}, high[2] = {x, 3};
  crack_lines_add(&s.c.mesh.cracks, low, high);
  for (int n = 0; n < NODES; n++)
    s.u[1][node_layout_at(&s.layout, n)] = n % ALONG > 5 ? 2 : 0;
  const double *const u[2] = {s.u[0], s.u[1]};
  node_field_values(&s.c, u, values);
  node_field_strain(&s.c, u, s.out);
  for (int n = 0; n < NODES; n++) {
    assert_true(fabs(values[2 * n + 1] - (n % ALONG > 5 ? 2 : 0)) < 1e-12);
    for (int k = 0; k < 3; k++)
      assert_true(fabs(s.out[k][node_layout_at(&s.layout, n)]) < 1e-11);
  }
  end(&s);
}

/* An hourglass is no strain of an element with one point. */
static void one_point_sees_no_hourglass(void **state) {
  (void)state;
  for (int gauss = 1; gauss <= 2; gauss++) {
    small_mesh s;
    begin(&s, gauss);
    for (int n = 0; n < NODES; n++)
      s.u[0][node_layout_at(&s.layout, n)] = (n % ALONG + n / ALONG) % 2 ? 1e-3 : -1e-3;
    const double *const u[2] = {s.u[0], s.u[1]};
    node_field_strain(&s.c, u, s.out);
    const double corner = fabs(s.out[0][node_layout_at(&s.layout, 0)]);
    assert_true(gauss == 1 ? corner < 1e-15 : corner > 1e-3);
    end(&s);
  }
}

/* The middle of an element of a quadrilateral is that of its corners. */
static void one_point_stands_in_the_middle(void **state) {
  (void)state;
  static const double cook[4][2] = {{0, 0}, {48, 44}, {48, 60}, {0, 44}};
  mesh m;
  mesh_open_mapped(&m, (int[2]){2, 2}, cook, 1, 2);
  m.element_gauss[0] = 1;
  double at[2];
  mesh_strain_place(&m, 0, cook[0], at);
  assert_true(fabs(at[0] - 24) < 1e-13 && fabs(at[1] - 37) < 1e-13);
  m.element_gauss[0] = 2;
  mesh_strain_place(&m, 0, cook[2], at);
  assert_true(at[0] == 48 && at[1] == 60);
  mesh_close(&m);
}

int main(void) {
  const struct CMUnitTest tests[] = {cmocka_unit_test(linear_fields_are_exact),
                                     cmocka_unit_test(the_mean_dilatation_shows),
                                     cmocka_unit_test(values_are_displacements),
                                     cmocka_unit_test(a_crack_parts_its_sides),
                                     cmocka_unit_test(one_point_sees_no_hourglass),
                                     cmocka_unit_test(one_point_stands_in_the_middle)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
