/* Meshes in a result: which cells cracks leave whole, frame by frame; the tables of nodes, cells
   and points as they are read back; the sidecar that names them. */
#define _GNU_SOURCE
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "runtime/result/mesh_views.h"
#include "runtime/result/result_fields.h"
#include "runtime/result/result_read.h"
#include "runtime/result/xdmf.h"

/* A particle alone, then a mesh of 3 x 3 nodes a metre apart:

       c2 | c3
       c0 | c1 */
enum { NODES = 9, ALL = NODES + 1, CELLS = 4, FRAMES = 4, MOST = 5 };

static const double reference[2 * ALL] = {9, 9, 0, 0, 1, 0, 2, 0, 0, 1,
                                          1, 1, 2, 1, 0, 2, 1, 2, 2, 2};
static const int32_t cells[4 * CELLS] = {0, 1, 4, 3, 1, 2, 5, 4, 3, 4, 7, 6, 4, 5, 8, 7};
static const int32_t method[CELLS] = {1, 2, 2, 3};
static const result_mesh plate = {"plate", 1, NODES, CELLS, 4, cells, method, 0.5, NULL, NULL};
static const result_field fields[] = {{"displacement", "m", NULL, 2, ALL, "other", "displacement"},
                                      {"slit/points", "m", NULL, 2, MOST, "path", "its points"},
                                      {"D", "1", NULL, 1, CELLS, "cells", "damage"}};
static const result_crack cracks[] = {{"slit/points", "plate"}};

/* The crack comes in from the left, stands still, and turns up along x = 1 and into cell 3. */
static const double paths[FRAMES][2 * MOST] = {{0, 0.5, 0.5, 0.5, NAN, NAN, NAN, NAN, NAN, NAN},
                                               {0, 0.5, 0.5, 0.5, NAN, NAN, NAN, NAN, NAN, NAN},
                                               {0, 0.5, 0.5, 0.5, 1, 0.7, 1, 1.4, NAN, NAN},
                                               {0, 0.5, 0.5, 0.5, 1, 0.7, 1, 1.6, NAN, NAN}};

static result_header header(const char *path) {
  static const double volume[ALL] = {1};
  static const int32_t body_of[ALL] = {0};
  return (result_header){.path = path,
                         .fingerprint = "meshes",
                         .title = "four cells",
                         .started = "now",
                         .version = "0",
                         .kernel_key = "k",
                         .deck_text = "&simulation /",
                         .particle_count = ALL,
                         .dimensions = 2,
                         .reference = reference,
                         .body = body_of,
                         .volume = volume,
                         .meshes = &plate,
                         .mesh_count = 1,
                         .cracks = cracks,
                         .crack_count = 1,
                         .fields = fields,
                         .field_count = 3};
}

static mesh_views views(const result_header *h, double *points, long frames) {
  mesh_views v = {.paths = calloc(1, sizeof *v.paths), .path_count = 1};
  v.paths[0] = (mesh_path){.field = &fields[1], .mesh = "plate", .most = MOST, .points = points};
  mesh_views_find(&v, h, frames);
  return v;
}

static void close_views(mesh_views *v) {
  v->paths[0].points = NULL;
  mesh_views_free(v);
}

static void cells_that_a_crack_crosses_are_left_out(void **state) {
  (void)state;
  const result_header h = header("m.h5");
  double points[FRAMES * 2 * MOST];
  memcpy(points, paths, sizeof points);
  mesh_views v = views(&h, points, FRAMES);
  static const int sets[FRAMES] = {0, 0, 0, 0};
  assert_int_equal(v.set_count, 1); /* along x = 1 it crosses none */
  assert_memory_equal(v.set_of_frame, sets, sizeof sets);
  assert_int_equal(v.sets[0].count, 3);
  for (int k = 0; k < 12; k++)
    assert_int_equal(v.sets[0].corners[k], 1 + cells[4 + k]); /* particles: one stands before */
  close_views(&v);
  points[2 * MOST * 3 + 6] = 1.2; /* in the last frame it leans into cell 3 */
  v = views(&h, points, FRAMES);
  assert_int_equal(v.set_count, 2);
  assert_int_equal(v.set_of_frame[2], 0);
  assert_int_equal(v.set_of_frame[3], 1);
  assert_int_equal(v.sets[1].count, 1); /* from (1, 0.7) on it is in cells 1 and 3, too */
  assert_int_equal(v.sets[1].corners[0], 1 + cells[8]);
  close_views(&v);
  v = views(&h, points, 0); /* nothing is known of cracks */
  assert_int_equal(v.sets[0].count, CELLS);
  close_views(&v);
}

/* Of a file: a triangle, a quadrilateral, a triangle of 6 nodes; and triangles alone. */
static void cells_of_several_kinds(void **state) {
  (void)state;
  static const int32_t several[] = {0, 1, 3, -1, -1, -1, 1, 2, 5, 4, -1, -1, 3, 5, 8, 4, 7, 6},
                       alike[] = {0, 1, 3, 1, 4, 3};
  static const result_mesh mixed = {"plate", 1, NODES, 3, 6, several, method, 0.5, NULL, NULL},
                           triangles = {"plate", 1, NODES, 2, 3, alike, method, 0.5, NULL, NULL};
  static const unsigned char nodes[] = {3, 4, 6};
  result_header h = header("m.h5");
  mesh_views v = {.path_count = 0};
  h.meshes = &mixed;
  mesh_views_find(&v, &h, 1);
  assert_int_equal(v.sets[0].count, 3);
  assert_int_equal(v.sets[0].corner_count, 13);
  assert_int_equal(v.sets[0].alike, 0);
  assert_memory_equal(v.sets[0].nodes, nodes, sizeof nodes);
  for (int k = 0, at = 0; k < 18; k++)
    if (several[k] >= 0) assert_int_equal(v.sets[0].corners[at++], 1 + several[k]);
  mesh_views_free(&v);
  v = (mesh_views){.path_count = 0};
  h.meshes = &triangles;
  mesh_views_find(&v, &h, 1);
  assert_int_equal(v.sets[0].alike, 3);
  assert_int_equal(v.sets[0].corner_count, 6);
  mesh_views_free(&v);
}

/* Of a node the first bit is of the cell that begins with it. */
static void cells_that_have_died_are_left_out(void **state) {
  (void)state;
  const result_header h = header("m.h5");
  mesh_views v = {.particles = ALL, .dead = calloc(3 * ALL, sizeof(double))};
  v.dead[ALL + 1 + 1] = 1; /* cell 1 from the second frame on, */
  v.dead[2 * ALL + 1 + 1] = 1;
  v.dead[2 * ALL + 1 + 3] = 3; /* cell 2 from the third; another would begin there */
  mesh_views_find(&v, &h, 3);
  assert_int_equal(v.set_count, 3);
  for (int k = 0; k < 3; k++) {
    assert_int_equal(v.set_of_frame[k], k);
    assert_int_equal(v.sets[k].count, CELLS - k);
  }
  assert_int_equal(v.sets[2].corners[4], 1 + cells[12]);
  mesh_views_free(&v);
  assert_true(mesh_cell_died(5, 2) && !mesh_cell_died(5, 1) && mesh_cell_died(5, 0));
}

/* Of a fan of four triangles, which all begin at one node, the second and the fourth have died. */
static void cells_of_one_node_die_apart(void **state) {
  (void)state;
  static const int32_t fan[] = {4, 0, 1, 4, 1, 2, 4, 2, 5, 4, 5, 0};
  static const result_mesh of = {"plate", 1, NODES, 4, 3, fan, method, 0.5, NULL, NULL};
  static const int left[] = {0, 2};
  result_header h = header("m.h5");
  mesh_views v = {.particles = ALL, .dead = calloc(ALL, sizeof(double))};
  h.meshes = &of;
  v.dead[1 + 4] = 2 + 8;
  mesh_views_find(&v, &h, 1);
  assert_int_equal(v.sets[0].count, 2);
  for (int k = 0; k < 2; k++)
    for (int q = 0; q < 3; q++)
      assert_int_equal(v.sets[0].corners[3 * k + q], 1 + fan[3 * left[k] + q]);
  mesh_views_free(&v);
}

/* Of frame k and cell c; the crack crosses cell 0 in all frames. */
static double damage_of(int k, int c) {
  return 10 * k + c;
}

static void assert_numbers(hid_t file, const char *name, int frame) {
  double values[CELLS];
  const hid_t set = H5Dopen2(file, name, H5P_DEFAULT);
  assert_true(set >= 0);
  assert_true(H5Dread(set, H5T_NATIVE_DOUBLE, H5S_ALL, H5S_ALL, H5P_DEFAULT, values) >= 0);
  H5Dclose(set);
  for (int c = 1; c < CELLS; c++)
    assert_true(values[c - 1] == damage_of(frame, c));
}

/* Of cells: all in the result, those that are shown for ParaView. */
static void assert_values_of_cells(const char *path) {
  char error[512], unit[64];
  long count = 0;
  result_file *f = result_read(path, error, sizeof error);
  for (int k = 0; k < FRAMES; k++) {
    double *values = result_read_cells(f, "D", k, &count, unit, sizeof unit);
    assert_non_null(values);
    assert_int_equal(count, CELLS);
    for (int c = 0; c < CELLS; c++)
      assert_true(values[c] == damage_of(k, c));
    free(values);
  }
  assert_null(result_read_cells(f, "displacement", 0, &count, unit, sizeof unit));
  assert_null(result_read_cells(f, "D", FRAMES, &count, unit, sizeof unit));
  result_read_close(f);
  const hid_t file = H5Fopen(path, H5F_ACC_RDONLY, H5P_DEFAULT);
  for (int k = 0; k < FRAMES; k++) {
    char name[64];
    snprintf(name, sizeof name, "/xdmf/cell_values/D/%d", k);
    assert_numbers(file, name, k);
  }
  H5Fclose(file);
}

static bool has_number(hid_t file, const char *name, long rows, int columns) {
  hsize_t shape[3] = {0, 0, 0};
  const hid_t set = H5Dopen2(file, name, H5P_DEFAULT);
  if (set < 0) return false;
  const hid_t space = H5Dget_space(set);
  H5Sget_simple_extent_dims(space, shape, NULL);
  H5Sclose(space);
  H5Dclose(set);
  return shape[0] == (hsize_t)rows && (columns == 0 || shape[1] == (hsize_t)columns);
}

static void what_is_written_is_read_back(void **state) {
  (void)state;
  char path[] = "/tmp/perilat_mesh_XXXXXX", error[512], sidecar[64];
  close(mkstemp(path));
  const result_header h = header(path);
  result *r = result_open(&h, false, error, sizeof error);
  assert_non_null(r);
  assert_true(result_begin(r, error, sizeof error));
  const double u[2 * ALL] = {0};
  for (int k = 0; k < FRAMES; k++) {
    double damage[CELLS];
    for (int c = 0; c < CELLS; c++)
      damage[c] = damage_of(k, c);
    const double *values[] = {u, paths[k], damage};
    assert_true(result_frame(r, k, values, error, sizeof error));
  }
  const double time = 0;
  const result_ending e = {.ended = "end", .time = &time, .history_count = 1};
  assert_true(result_finish(r, &e, error, sizeof error));
  result_discard(r);
  result_close(r);
  result_file *f = result_read(path, error, sizeof error);
  assert_non_null(f);
  long frames = 0, most = 0, rows = 0;
  int columns = 0;
  assert_true(result_has_path(f, "slit") && !result_has_path(f, "slit/points"));
  double *points = result_read_path(f, "slit", &frames, &most, error, sizeof error);
  assert_non_null(points);
  assert_int_equal(frames, FRAMES);
  assert_int_equal(most, 4); /* as many as it has had, not could have */
  for (int k = 0; k < FRAMES; k++)
    for (int n = 0; n < 8; n++) {
      const double wanted = paths[k][n], found = points[8 * k + n];
      assert_true(isnan(wanted) ? isnan(found) : found == wanted);
    }
  free(points);
  int32_t *read = result_read_table(f, "/meshes/plate/cells", true, 4, 4, &rows, &columns);
  assert_non_null(read);
  assert_int_equal(rows, CELLS);
  assert_memory_equal(read, cells, sizeof cells);
  free(read);
  double *nodes = result_read_table(f, "/meshes/plate/nodes", false, 2, 2, &rows, &columns);
  assert_memory_equal(nodes, reference + 2, 2 * NODES * sizeof *nodes);
  free(nodes);
  result_read_close(f);
  const hid_t file = H5Fopen(path, H5F_ACC_RDONLY, H5P_DEFAULT);
  assert_true(has_number(file, "/xdmf/cells/0", 3, 4));
  assert_true(has_number(file, "/xdmf/cracks/slit/1", 2, 3));
  assert_true(has_number(file, "/xdmf/cracks/slit/3", 4, 3));
  assert_true(has_number(file, "/VTKHDF/Connectivity", 12, 0));
  assert_true(has_number(file, "/VTKHDF/CellData/D", 3 * FRAMES, 0));
  assert_true(has_number(file, "/VTKHDF/Steps/CellDataOffsets/D", FRAMES, 0));
  H5Fclose(file);
  assert_values_of_cells(path);
  result_sidecar(path, sidecar, sizeof sidecar);
  remove(sidecar);
  remove(path);
}

static int count_of(const char *text, const char *word) {
  int count = 0;
  for (const char *at = text; (at = strstr(at, word)); at += strlen(word))
    count++;
  return count;
}

static void the_sidecar_has_cells_and_cracks_in_every_frame(void **state) {
  (void)state;
  const result_header h = header("/some/where/m.h5");
  const double times[FRAMES] = {0, 1, 2, 3};
  double points[FRAMES * 2 * MOST];
  memcpy(points, paths, sizeof points);
  mesh_views v = views(&h, points, FRAMES);
  char *text = NULL;
  size_t length;
  FILE *out = open_memstream(&text, &length);
  assert_true(xdmf_write(out, &h, &v, times, FRAMES));
  fclose(out);
  assert_int_equal(count_of(text, "<Grid Name=\"cells\" GridType=\"Collection\""), 1);
  assert_int_equal(count_of(text, "<Grid Name=\"slit\" GridType=\"Collection\""), 1);
  assert_int_equal(count_of(text, "CollectionType=\"Temporal\""), 2); /* none within another */
  assert_int_equal(count_of(text, "TopologyType=\"Quadrilateral\" NumberOfElements=\"3\""), FRAMES);
  assert_int_equal(count_of(text, "Dimensions=\"3 4\">m.h5:/xdmf/cells/0<"), FRAMES);
  assert_int_equal(count_of(text, "NodesPerElement=\"2\" NumberOfElements=\"1\""), 2);
  assert_int_equal(count_of(text, "NodesPerElement=\"4\" NumberOfElements=\"1\""), 2);
  assert_int_equal(count_of(text, "Dimensions=\"1 4\">0 1 2 3<"), 2);
  assert_int_equal(count_of(text, "Dimensions=\"4 3\">m.h5:/xdmf/cracks/slit/3<"), 1);
  assert_int_equal(count_of(text, "Center=\"Cell\""), 2 * FRAMES); /* cells, and the crack */
  assert_int_equal(count_of(text, "Dimensions=\"3\">m.h5:/xdmf/cell_values/D/2<"), 1);
  assert_int_equal(count_of(text, "Dimensions=\"1\">m.h5:/xdmf/nothing/1/1<"), FRAMES);
  assert_int_equal(count_of(text, "<Grid"), count_of(text, "</Grid>"));
  free(text);
  close_views(&v);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(cells_that_a_crack_crosses_are_left_out),
      cmocka_unit_test(cells_of_several_kinds),
      cmocka_unit_test(cells_that_have_died_are_left_out),
      cmocka_unit_test(cells_of_one_node_die_apart),
      cmocka_unit_test(what_is_written_is_read_back),
      cmocka_unit_test(the_sidecar_has_cells_and_cracks_in_every_frame)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
