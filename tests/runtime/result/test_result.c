/* Result files: written, read back, cut to a frame and resumed, refused when truncated or foreign;
   pictures of them. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include <fcntl.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "runtime/plot/canvas.h"
#include "runtime/plot/plot_curve.h"
#include "runtime/plot/plot_map.h"
#include "runtime/result/hdf5_tools.h"
#include "runtime/result/result_fields.h"
#include "runtime/result/result_file.h"
#include "runtime/result/result_find.h"
#include "runtime/result/result_names.h"
#include "runtime/result/result_read.h"
#include "runtime/result/views.h"
#include "tests/runtime/small_result.h"

static char error[512];

static result_header header(const char *path) {
  static const result_text deck_models[] = {{"law", "model law"}}, kernels[] = {{"law", "int x;"}};
  result_header h = small_header(path);
  h.models = deck_models;
  h.kernels = kernels;
  h.model_count = h.kernel_count = 1;
  return h;
}

static void write_frame(result *r, int k) {
  double u[2 * PARTICLES], omega[BONDS];
  small_frame(k, u, omega);
  const double *values[] = {u, omega};
  assert_true(result_frame(r, 0.5 * k, values, error, sizeof error));
}

static void finish(result *r) {
  double time[SAMPLES], load[SAMPLES];
  for (int k = 0; k < SAMPLES; k++) {
    time[k] = 0.25 * k;
    load[k] = 1000.0 * k * k;
  }
  const result_series series[] = {{.name = "load", .unit = "N", .values = load},
                                  {.name = "energy/kinetic", .unit = "J", .values = time}};
  assert_true(small_finish(r, time, SAMPLES, series, 2, error, sizeof error));
  result_discard(r);
  result_close(r);
}

static void expect_frame(result_file *f, int k) {
  long count;
  int components;
  char unit_text[16];
  double expected[2 * PARTICLES], damage[BONDS];
  small_frame(k, expected, damage);
  double *u = result_read_frame(f, "displacement", k, &count, &components, unit_text,
                                sizeof unit_text, error, sizeof error);
  assert_non_null(u);
  assert_int_equal(count, PARTICLES);
  assert_int_equal(components, 2);
  assert_string_equal(unit_text, "m");
  assert_memory_equal(u, expected, sizeof expected);
  free(u);
  double *omega = result_read_frame(f, "concrete/omega", k, &count, &components, unit_text,
                                    sizeof unit_text, error, sizeof error);
  assert_non_null(omega);
  assert_int_equal(count, BONDS);
  assert_memory_equal(omega, damage, sizeof damage);
  free(omega);
}

static void written_and_read_back(void **state) {
  (void)state;
  result_header h = header("result_a.h5");
  result *r = small_begin(&h, error, sizeof error);
  assert_non_null(r);
  for (int k = 0; k < 4; k++)
    write_frame(r, k);
  finish(r);
  assert_int_not_equal(access("result_a.h5.frames", F_OK), 0); /* the working file is gone */
  result_file *f = result_read("result_a.h5", error, sizeof error);
  assert_non_null(f);
  for (int k = 0; k < 4; k++)
    expect_frame(f, k);
  long count;
  char unit_text[16];
  double *load =
      result_read_series(f, "load", &count, unit_text, sizeof unit_text, error, sizeof error);
  assert_int_equal(count, SAMPLES);
  assert_string_equal(unit_text, "N");
  assert_true(load[4] == 16000);
  free(load);
  double *kinetic = result_read_series(f, "energy/kinetic", &count, unit_text, sizeof unit_text,
                                       error, sizeof error);
  assert_non_null(kinetic);
  free(kinetic);
  char *deck = result_read_text(f, "/input/deck"),
       *law_text = result_read_text(f, "/input/models/law");
  assert_string_equal(deck, "&simulation /");
  assert_string_equal(law_text, "model law");
  free(deck);
  free(law_text);
  assert_null(
      result_read_series(f, "lode", &count, unit_text, sizeof unit_text, error, sizeof error));
  assert_non_null(strstr(error, "load")); /* the message lists what there is */
  long particles;
  int components;
  assert_null(result_read_frame(f, "displacement", 4, &particles, &components, unit_text,
                                sizeof unit_text, error, sizeof error));
  result_read_close(f);
}

static void resumed_after_a_kill(void **state) {
  (void)state;
  unlink("result_b.h5"); /* of an earlier run of this test */
  result_header h = header("result_b.h5");
  result *r = small_begin(&h, error, sizeof error);
  frame_mark two = {0, 0};
  for (int k = 0; k < 3; k++) {
    if (k == 2) two = result_mark(r);
    write_frame(r, k);
  }
  /* as a kill would leave it: three frames, of which the checkpoint knows two, and half a fourth */
  result_close(r);
  int file = open("result_b.h5.frames", O_WRONLY | O_APPEND);
  assert_int_equal(write(file, "garbage", 7), 7);
  close(file);
  assert_int_not_equal(access("result_b.h5", F_OK), 0);
  r = result_open(&h, true, error, sizeof error);
  assert_non_null(r);
  assert_true(result_resume(r, &two, error, sizeof error));
  assert_int_equal(result_mark(r).count, 2);
  write_frame(r, 2);
  write_frame(r, 3);
  finish(r);
  result_file *f = result_read("result_b.h5", error, sizeof error);
  for (int k = 0; k < 4; k++)
    expect_frame(f, k);
  result_read_close(f);
}

static void resume_needs_its_frames(void **state) {
  (void)state;
  result_header h = header("result_c.h5");
  unlink("result_c.h5.frames");
  assert_null(result_open(&h, true, error, sizeof error));
  result *r = small_begin(&h, error, sizeof error);
  write_frame(r, 0);
  frame_mark mark = result_mark(r);
  result_close(r);
  mark.count++;
  r = result_open(&h, true, error, sizeof error);
  assert_non_null(r);
  assert_false(result_resume(r, &mark, error, sizeof error));
  assert_non_null(strstr(error, "fewer"));
  result_discard(r);
  result_close(r);
}

static void two_runs_do_not_share_a_result(void **state) {
  (void)state;
  result_header h = header("result_d.h5");
  result *first = small_begin(&h, error, sizeof error);
  assert_non_null(first);
  assert_null(small_begin(&h, error, sizeof error));
  assert_non_null(strstr(error, "another run"));
  result_close(first);
  unlink("result_d.h5.frames");
}

static void an_old_result_survives_a_failed_write(void **state) {
  (void)state;
  result_header h = header("full/result.h5");
  assert_null(small_begin(&h, error, sizeof error)); /* no such folder */
  assert_non_null(strstr(error, "full/result.h5"));
}

/* Files are known by their whole paths, however long what these begin with. */
static void files_with_long_paths_are_kept(void **state) {
  (void)state;
  char folder[600], names[2][620];
  memset(folder, 'f', sizeof folder);
  folder[sizeof folder - 1] = 0;
  for (int k = 0; k < 2; k++)
    snprintf(names[k], sizeof names[k], "%s:%d.csv", folder, k);
  const result_text files[] = {{names[0], "t, F"}, {names[1], "t, M"}};
  result_header h = header("result_l.h5");
  h.files = files;
  h.file_count = 2;
  result *r = small_begin(&h, error, sizeof error);
  write_frame(r, 0);
  finish(r);
  result_file *f = result_read("result_l.h5", error, sizeof error);
  assert_non_null(f);
  result_names kept = result_list(f, "/input/files");
  assert_int_equal(kept.count, 2);
  for (int k = 0; k < 2; k++)
    assert_string_equal(kept.items[k], names[k]);
  result_names_free(&kept);
  result_read_close(f);
  unlink("result_l.h5");
  unlink("result_l.xdmf");
}

static void damaged_files_are_refused(void **state) {
  (void)state;
  result_header h = header("result_e.h5");
  result *r = small_begin(&h, error, sizeof error);
  write_frame(r, 0);
  finish(r);
  struct stat about;
  assert_int_equal(stat("result_e.h5", &about), 0);
  for (int part = 0; part < 16; part++) { /* truncated at any length: an answer, no crash */
    assert_int_equal(truncate("result_e.h5", about.st_size * (15 - part) / 16), 0);
    result_file *f = result_read("result_e.h5", error, sizeof error);
    if (f)
      result_read_close(f);
    else
      assert_non_null(strstr(error, "result_e.h5"));
  }
  FILE *text = fopen("result_e.h5", "w");
  fputs("not HDF5 at all", text);
  fclose(text);
  assert_null(result_read("result_e.h5", error, sizeof error));
  assert_null(result_read("no_such_file.h5", error, sizeof error));
  assert_non_null(strstr(error, "no_such_file.h5"));
  unlink("result_e.h5");
}

/* Every element that is opened is closed, and every `&` begins an entity. Returns the number of
   elements. */
static int count_elements(const char *text) {
  char open[32][32];
  int depth = 0, elements = 0;
  for (const char *at = strpbrk(text, "<&"); at; at = strpbrk(at + 1, "<&")) {
    if (*at == '&') {
      assert_true(!strncmp(at, "&amp;", 5) || !strncmp(at, "&lt;", 4) || !strncmp(at, "&gt;", 4) ||
                  !strncmp(at, "&quot;", 6));
      continue;
    }
    const char *end = strchr(at, '>');
    assert_non_null(end);
    if (at[1] == '?') continue;
    size_t length = strcspn(at + 1 + (at[1] == '/'), " />");
    if (at[1] == '/') {
      assert_true(depth > 0 && strlen(open[depth - 1]) == length &&
                  !strncmp(open[depth - 1], at + 2, length));
      depth--;
      continue;
    }
    elements++;
    if (end[-1] == '/') continue;
    assert_true(depth < 32 && length < 32);
    snprintf(open[depth++], 32, "%.*s", (int)length, at + 1);
  }
  assert_int_equal(depth, 0);
  return elements;
}

static void the_sidecar_is_xml_whatever_the_names(void **state) {
  (void)state;
  static const result_field odd[] = {{"displacement", "m", NULL, 2, PARTICLES, "other", NULL},
                                     {"omega", "1", "a<b", 1, BONDS, "damage", NULL}};
  char text[16384];
  result_header h = header("result_<&>.h5");
  const result_bonds bonds = {"a<b", BONDS, h.bonds->pairs};
  h.bonds = &bonds;
  h.fields = odd;
  result *r = small_begin(&h, error, sizeof error);
  assert_non_null(r);
  write_frame(r, 0);
  write_frame(r, 1);
  finish(r);
  FILE *in = fopen("result_<&>.xdmf", "r");
  assert_non_null(in);
  text[fread(text, 1, sizeof text - 1, in)] = 0;
  fclose(in);
  enum {
    HEAD = 3,
    GRID = 2 + 2 + 2,
    FIELD = 2
  }; /* grid: itself, time; topology, geometry, fields each with their numbers */
  assert_int_equal(count_elements(text), HEAD + 2 * (GRID + 2 * FIELD));
  assert_non_null(strstr(text, ">result_&lt;&amp;&gt;.h5:/xdmf/bonds/omega/1</DataItem>"));
  assert_non_null(strstr(text, ">result_&lt;&amp;&gt;.h5:" VIEWS_CONNECTIVITY "</DataItem>"));
  unlink("result_<&>.xdmf");
  unlink("result_<&>.h5");
}

static long size_of(const char *path) {
  struct stat about;
  return stat(path, &about) == 0 ? (long)about.st_size : -1;
}

static void pictures(void **state) {
  (void)state;
  result_header h = header("result_f.h5");
  result *r = small_begin(&h, error, sizeof error);
  write_frame(r, 0);
  write_frame(r, 1);
  finish(r);
  const char *results[] = {"result_f.h5", "result_f.h5"};
  static const char *const curves[] = {"curve_f.png", "curve_f.svg", "curve_f.pdf"};
  static const char *const maps[] = {"map_f.png", "map_f.svg", "map_f.pdf"};
  for (int k = 0; k < 3; k++) {
    plot_curve_options curve = {.output = curves[k], .x = "time", .y = "load", .y_unit = "kN"};
    assert_true(plot_curve(results, 2, &curve, error, sizeof error));
    assert_true(size_of(curves[k]) > 1000);
    plot_map_options map = {.slice_axis = -1,
                            .output = maps[k],
                            .frame = -1,
                            .field = k ? "displacement" : "damage",
                            .component = -1,
                            .factor = -1};
    assert_true(plot_map("result_f.h5", &map, error, sizeof error));
    assert_true(size_of(maps[k]) > 1000);
  }
  plot_curve_options wrong = {.output = "curve_f.png", .x = "time", .y = "load", .y_unit = "mm"};
  assert_false(plot_curve(results, 1, &wrong, error, sizeof error));
  assert_non_null(strstr(error, "`load` is in N"));
  wrong = (plot_curve_options){.output = "curve_f.jpg", .x = "time", .y = "load"};
  assert_false(plot_curve(results, 1, &wrong, error, sizeof error));
  plot_map_options none = {.slice_axis = -1,
                           .output = "map_f.png",
                           .frame = 7,
                           .field = "damage",
                           .component = -1,
                           .factor = -1};
  assert_false(plot_map("result_f.h5", &none, error, sizeof error));
  assert_non_null(strstr(error, "2 frames"));
}

/* --- kinds of fields -------------------------------------------------------------------------- */

enum { KINDS = 6 };
static const result_field of_kinds[KINDS] = {
    {"displacement", "m", NULL, 2, PARTICLES, "other", NULL},
    {"damage", "1", NULL, 1, PARTICLES, "damage", NULL},
    {"alpha", "1", "concrete", 1, BONDS, "state", NULL},
    {"omega_c", "1", "concrete", 1, BONDS, "damage", NULL},
    {"omega_t", "1", "concrete", 1, BONDS, "damage", NULL},
    {"w", "m", "concrete", 1, BONDS, "output", NULL}};

/* One frame of a law with a state, two damages and an output; without the first `skip` fields. */
static void write_kinds(const char *path, int skip, int count) {
  static const double u[2 * PARTICLES] = {0}, mean[PARTICLES] = {0.2, 0.6, 1},
                            alpha[BONDS] = {5, 7}, crushed[BONDS] = {0.2, 0.3},
                            torn[BONDS] = {0.1, 1}, width[BONDS] = {0, 1e-3};
  const double *values[KINDS] = {u, mean, alpha, crushed, torn, width};
  result_header h = header(path);
  h.fields = of_kinds + skip;
  h.field_count = count;
  result *r = small_begin(&h, error, sizeof error);
  assert_non_null(r);
  assert_true(result_frame(r, 0, values + skip, error, sizeof error));
  finish(r);
}

static void damage_is_the_largest_of_the_damages(void **state) {
  (void)state;
  char name[64];
  long count;
  write_kinds("result_k.h5", 0, KINDS);
  result_file *f = result_read("result_k.h5", error, sizeof error);
  double *damage = result_read_damage(f, 0, &count, error, sizeof error);
  assert_non_null(damage);
  assert_int_equal(count, BONDS);
  assert_true(damage[0] == 0.2 && damage[1] == 1);
  free(damage);
  assert_null(result_read_damage(f, 3, &count, error, sizeof error));
  assert_non_null(strstr(error, "there is no frame 3"));
  static const char *const given[][2] = {{"w", "concrete/w"},
                                         {"concrete/w", "concrete/w"},
                                         {"displacement", "displacement"},
                                         {"damage", "damage"}};
  for (int k = 0; k < 4; k++) {
    assert_true(result_find(f, "/frames", given[k][0], name, sizeof name, error, sizeof error));
    assert_string_equal(name, given[k][1]);
  }
  assert_false(result_find(f, "/frames", "v", name, sizeof name, error, sizeof error));
  assert_false(result_find(f, "/frames", "concrete", name, sizeof name, error, sizeof error));
  result_read_close(f);
  write_kinds("result_n.h5", 0, 3); /* a state, but no damage on bonds */
  f = result_read("result_n.h5", error, sizeof error);
  assert_null(result_read_damage(f, 0, &count, error, sizeof error));
  assert_string_equal(error, "");
  result_read_close(f);
}

static void expect_text(hid_t object, const char *name, const char *text) {
  char found[64];
  hid_t a = H5Aopen(object, name, H5P_DEFAULT), type = H5Aget_type(a);
  assert_true(H5Tis_variable_str(type) > 0 && H5Tget_cset(type) == H5T_CSET_UTF8);
  assert_true(h5_read_attribute_text(object, name, found, sizeof found));
  assert_string_equal(found, text);
  H5Tclose(type);
  H5Aclose(a);
}

/* As Python's h5py wants it: texts of variable length are its str, counts are whole numbers. */
static void attributes_have_the_types_readers_expect(void **state) {
  (void)state;
  write_kinds("result_k.h5", 0, KINDS);
  hid_t file = H5Fopen("result_k.h5", H5F_ACC_RDONLY, H5P_DEFAULT);
  assert_true(file >= 0);
  expect_text(file, "title", "three particles");
  static const char *const sets[][3] = {{"/history/load", "units", "N"},
                                        {"/frames/displacement", "kind", "other"},
                                        {"/frames/concrete/alpha", "kind", "state"},
                                        {"/frames/concrete/omega_c", "kind", "damage"},
                                        {"/frames/concrete/w", "kind", "output"},
                                        {"/frames/concrete/w", "units", "m"}};
  for (size_t k = 0; k < sizeof sets / sizeof *sets; k++) {
    hid_t set = H5Dopen2(file, sets[k][0], H5P_DEFAULT);
    expect_text(set, sets[k][1], sets[k][2]);
    H5Dclose(set);
  }
  int64_t steps = 0;
  hid_t a = H5Aopen(file, "steps", H5P_DEFAULT), type = H5Aget_type(a);
  assert_int_equal(H5Tget_class(type), H5T_INTEGER);
  assert_true(H5Aread(a, H5T_NATIVE_INT64, &steps) >= 0);
  assert_int_equal(steps, 42);
  H5Tclose(type);
  H5Aclose(a);
  H5Fclose(file);
}

/* Files of others, and of earlier versions, may hold texts of fixed length. */
static void texts_of_fixed_length_are_read(void **state) {
  (void)state;
  char text[16];
  hid_t file = h5_create("fixed.h5"), space = H5Screate(H5S_SCALAR);
  static const H5T_cset_t sets[] = {H5T_CSET_ASCII, H5T_CSET_UTF8};
  static const char *const names[] = {"ascii", "utf8"};
  for (int k = 0; k < 2; k++) {
    hid_t type = H5Tcopy(H5T_C_S1);
    H5Tset_size(type, 8);
    H5Tset_cset(type, sets[k]);
    hid_t a = H5Acreate2(file, names[k], type, space, H5P_DEFAULT, H5P_DEFAULT);
    hid_t d = H5Dcreate2(file, names[k], type, space, H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT);
    assert_true(H5Awrite(a, type, "eight ch") >= 0 &&
                H5Dwrite(d, type, H5S_ALL, H5S_ALL, H5P_DEFAULT, "eight ch") >= 0);
    assert_true(h5_read_attribute_text(file, names[k], text, sizeof text));
    assert_string_equal(text, "eight ch");
    assert_true(h5_read_attribute_text(file, names[k], text, 6)); /* cut */
    assert_string_equal(text, "eight");
    char *whole = h5_read_text(d);
    assert_string_equal(whole, "eight ch");
    free(whole);
    H5Dclose(d);
    H5Aclose(a);
    H5Tclose(type);
  }
  assert_true(h5_attribute_text(file, "empty", "") &&
              h5_attribute_text(file, "long", "longer than the place for it"));
  assert_true(h5_read_attribute_text(file, "empty", text, sizeof text));
  assert_string_equal(text, "");
  assert_true(h5_read_attribute_text(file, "long", text, sizeof text));
  assert_string_equal(text, "longer than the");
  assert_true(h5_attribute_integer(file, "number", 3));
  assert_false(h5_read_attribute_text(file, "number", text, sizeof text));
  H5Sclose(space);
  H5Fclose(file);
  unlink("fixed.h5");
}

/* --- what pictures show ----------------------------------------------------------------------- */

/* Pixels of a colour in the part of a picture between its head and its foot. */
static long pixels(const char *path, colour ink) {
  enum { ABOVE = 64, BELOW = 100, NEAR = 6 };
  cairo_surface_t *s = cairo_image_surface_create_from_png(path);
  assert_int_equal(cairo_surface_status(s), CAIRO_STATUS_SUCCESS);
  const unsigned char *data = cairo_image_surface_get_data(s);
  long count = 0;
  for (int y = ABOVE; y < cairo_image_surface_get_height(s) - BELOW; y++)
    for (int x = 0; x < cairo_image_surface_get_width(s); x++) {
      const unsigned char *p = data + y * cairo_image_surface_get_stride(s) + 4 * x; /* B G R */
      count += fabs(p[2] - 255 * ink.r) < NEAR && fabs(p[1] - 255 * ink.g) < NEAR &&
               fabs(p[0] - 255 * ink.b) < NEAR;
    }
  cairo_surface_destroy(s);
  return count;
}

static const colour yellow = {0.95, 0.80, 0.10}, black = {0, 0, 0}, lowest = {0.27, 0.00, 0.33},
                    highest = {0.99, 0.91, 0.14};

static bool map_of(const char *path, const char *field) {
  const plot_map_options o = {.output = "map_k.png",
                              .frame = -1,
                              .field = field,
                              .component = -1,
                              .factor = 1,
                              .slice_axis = -1};
  return plot_map(path, &o, error, sizeof error);
}

static void maps_show_their_field(void **state) {
  (void)state;
  write_kinds("result_k.h5", 0, KINDS);
  assert_true(map_of("result_k.h5",
                     "damage")); /* 0.2 is yellow, 1 a crack; the state 5, 7 would be two cracks */
  assert_true(pixels("map_k.png", yellow) > 500 && pixels("map_k.png", black) > 500);
  static const char *const width[] = {"w", "concrete/w"};
  for (int k = 0; k < 2; k++) {
    assert_true(map_of("result_k.h5", width[k]));
    assert_true(pixels("map_k.png", lowest) > 500 && pixels("map_k.png", highest) > 500);
    assert_true(pixels("map_k.png", black) > 500 && pixels("map_k.png", yellow) == 0);
  }
  assert_false(map_of("result_k.h5", "nothing"));
  assert_non_null(strstr(
      error,
      "fields of particles: damage, displacement; of bonds: concrete/alpha, concrete/omega_c"));
  write_kinds("result_n.h5", 0, 1);
  assert_false(map_of("result_n.h5", "damage"));
  assert_non_null(strstr(
      error, "holds no damage of bonds: write fields = 'displacement', 'damage' in &output"));
  write_kinds("result_n.h5", 0, 3); /* damage on particles alone: 0.2, 0.6, 1 */
  assert_true(map_of("result_n.h5", "damage"));
  assert_true(pixels("map_k.png", yellow) > 500 && pixels("map_k.png", black) > 500);
  assert_true(map_of("result_n.h5", "alpha"));
  assert_int_equal(pixels("map_k.png", black), 0); /* no damage, no cracks */
  write_kinds("result_n.h5", 1, 4);
  assert_false(map_of("result_n.h5", "damage"));
  assert_non_null(strstr(error, "add 'displacement' to `fields` in &output"));
}

/* --- in space --------------------------------------------------------------------------------- */

enum { SIDE = 4, CUBE = SIDE * SIDE * SIDE, LINKS = 3 * SIDE * SIDE * (SIDE - 1) };

/* A cube of particles 1 mm apart, joined to their nearest neighbours; bonds along z from the layer
   1 to 2 mm have a damage of 0.5, from 2 to 3 mm of 1. Displacements are along z, as large as the
   place. */
static void write_cube(const char *path) {
  static double places[3 * CUBE], volumes[CUBE], u[3 * CUBE], omega[LINKS];
  static int32_t bodies[CUBE], pairs[2 * LINKS];
  int links = 0;
  for (int p = 0; p < CUBE; p++) {
    const int at[3] = {p % SIDE, p / SIDE % SIDE, p / SIDE / SIDE},
              ahead[3] = {1, SIDE, SIDE * SIDE};
    for (int c = 0; c < 3; c++) {
      places[3 * p + c] = 1e-3 * at[c];
      u[3 * p + c] = c == 2 ? 1e-3 * at[2] : 0;
      if (at[c] + 1 == SIDE) continue;
      omega[links] = c == 2 ? 0.5 * at[2] : 0;
      pairs[2 * links] = p;
      pairs[2 * links++ + 1] = p + ahead[c];
    }
  }
  assert_int_equal(links, LINKS);
  static const result_field of_cube[] = {{"displacement", "m", NULL, 3, CUBE, "other", NULL},
                                         {"omega", "1", "concrete", 1, LINKS, "damage", NULL}};
  result_header h = header(path);
  h.dimensions = 3;
  h.particle_count = CUBE;
  h.reference = places;
  h.volume = volumes;
  h.body = bodies;
  const result_bonds bonds = {"concrete", LINKS, pairs};
  h.bonds = &bonds;
  h.fields = of_cube;
  result *r = small_begin(&h, error, sizeof error);
  const double *values[] = {u, omega};
  assert_non_null(r);
  assert_true(result_frame(r, 0, values, error, sizeof error));
  finish(r);
}

static void bodies_in_space_are_written_and_read(void **state) {
  (void)state;
  write_cube("cube.h5");
  result_file *f = result_read("cube.h5", error, sizeof error);
  long count;
  int dimensions, components;
  char unit_text[16], text[16384];
  double *places = result_read_reference(f, &count, &dimensions);
  assert_int_equal(count, CUBE);
  assert_int_equal(dimensions, 3);
  assert_true(places[3 * (CUBE - 1) + 2] == 1e-3 * (SIDE - 1) && places[3 * SIDE + 1] == 1e-3);
  int32_t *pairs = result_read_bonds(f, NULL, &count);
  assert_true(pairs && count == LINKS);
  double *u = result_read_frame(f, "displacement", 0, &count, &components, unit_text,
                                sizeof unit_text, error, sizeof error);
  assert_true(u && components == 3 && u[3 * (CUBE - 1) + 2] == 1e-3 * (SIDE - 1));
  free(places);
  free(pairs);
  free(u);
  result_read_close(f);
  FILE *in = fopen("cube.xdmf", "r");
  assert_non_null(in);
  text[fread(text, 1, sizeof text - 1, in)] = 0;
  fclose(in);
  assert_non_null(strstr(text, "Dimensions=\"64 3\">cube.h5:" VIEWS_POINTS "</DataItem>"));
  assert_non_null(strstr(text, "Dimensions=\"144 2\">cube.h5:" VIEWS_CONNECTIVITY "</DataItem>"));
}

static bool view_of_cube(const char *field, int component, int axis, double at) {
  const plot_map_options o = {.output = "cube.png",
                              .frame = -1,
                              .field = field,
                              .component = component,
                              .factor = 0,
                              .slice_axis = axis,
                              .slice_at = at};
  return plot_map("cube.h5", &o, error, sizeof error);
}

static void bodies_in_space_are_seen_in_slices_and_from_outside(void **state) {
  static const colour orange = {0.95, 0.50, 0.05}, sound = {0.80, 0.82, 0.85},
                      red = {0.85, 0.05, 0.05};
  (void)state;
  write_cube("cube.h5");
  assert_true(view_of_cube("damage", -1, 0,
                           1.4e-3)); /* x = 1 mm: damaged and separated layers, seen edge-on */
  assert_true(pixels("cube.png", orange) > 500 && pixels("cube.png", black) > 500);
  assert_true(view_of_cube("damage", -1, 2, 0)); /* no damage along the layers */
  assert_true(pixels("cube.png", orange) == 0 && pixels("cube.png", black) == 0);
  assert_true(pixels("cube.png", sound) > 500);
  assert_true(view_of_cube("displacement", 2, 2, 2.5e-3)); /* one layer: one value, the lowest */
  assert_true(pixels("cube.png", lowest) > 5000 && pixels("cube.png", highest) == 0);
  assert_false(view_of_cube("damage", -1, 2, 3.6e-3));
  assert_non_null(strstr(error, "the body reaches from 0 to 3 mm"));
  /* from outside, means of bonds: 0 below, 0.1 to 0.125 (yellow), 0.25 to 0.375, 0.2 to 0.25 */
  assert_true(view_of_cube("damage", -1, -1, 0));
  assert_true(pixels("cube.png", yellow) > 2000 && pixels("cube.png", orange) > 2000);
  assert_true(pixels("cube.png", sound) > 2000 && pixels("cube.png", red) == 0);
  assert_true(view_of_cube("displacement", 2, -1, 0));
  assert_true(pixels("cube.png", lowest) > 2000 && pixels("cube.png", highest) > 2000);
  assert_false(map_of("result_k.h5", "nothing"));
  const plot_map_options flat = {
      .output = "cube.png", .frame = -1, .field = "damage", .component = -1};
  assert_false(plot_map("result_k.h5", &flat, error, sizeof error)); /* slice_axis is 0: x */
  assert_non_null(strstr(error, "this one is in the plane"));
}

static void several_histories_are_several_curves(void **state) {
  (void)state;
  static const colour first = {0.00, 0.27, 0.55}, second = {0.80, 0.25, 0.05};
  const char *results[] = {"result_k.h5"}, *ys[] = {"energy/kinetic", "time"},
             *loads[] = {"load", "load"};
  write_kinds("result_k.h5", 0, KINDS);
  plot_curve_options o = {.output = "curve_k.png", .ys = loads, .y_count = 1};
  assert_true(plot_curve(results, 1, &o, error, sizeof error));
  assert_true(pixels("curve_k.png", first) > 100 && pixels("curve_k.png", second) == 0);
  o.y_count = 2; /* the second one hides the first, but for the legend */
  assert_true(plot_curve(results, 1, &o, error, sizeof error));
  assert_true(pixels("curve_k.png", first) > 50 && pixels("curve_k.png", second) > 100);
  o.ys = ys;
  assert_false(plot_curve(results, 1, &o, error, sizeof error));
  assert_non_null(strstr(
      error, "`time` of `result_k.h5` is in s, but `energy/kinetic` of `result_k.h5` is in J"));
}

/* From 0.1 to 0.9 a level line, or none where the value between is no number. */
static void a_curve_has_gaps(void **state) {
  (void)state;
  static const colour first = {0.00, 0.27, 0.55};
  const double x[] = {0, 0.1, 0.5, 0.9, 1};
  long drawn[2];
  for (int gap = 0; gap < 2; gap++) {
    const double y[] = {0, 1, gap ? NAN : 1, 1, 0};
    const plot_curve_options o = {.output = "gap.png", .x = "x", .y = "y"};
    assert_true(plot_values(x, y, 5, "1", "1", &o, error, sizeof error));
    drawn[gap] = pixels("gap.png", first);
  }
  assert_true(drawn[1] > 500 && drawn[0] - drawn[1] > 700); /* of some 1000 x 2 */
}

/* The numbers along the x axis of a curve from `low` to 1. */
static unsigned char *x_numbers(double low, size_t *size) {
  enum { FROM = 710, TO = 740 }; /* rows of pixels */
  const double x[] = {low, 0, 1}, y[] = {0, 0.1, 1};
  const plot_curve_options o = {.output = "axis.png", .x = "x", .y = "y"};
  assert_true(plot_values(x, y, 3, "1", "1", &o, error, sizeof error));
  cairo_surface_t *s = cairo_image_surface_create_from_png("axis.png");
  const size_t stride = (size_t)cairo_image_surface_get_stride(s);
  *size = stride * (TO - FROM);
  unsigned char *numbers = malloc(*size);
  memcpy(numbers, cairo_image_surface_get_data(s) + FROM * stride, *size);
  cairo_surface_destroy(s);
  return numbers;
}

static void an_axis_gets_no_step_for_what_cannot_be_seen(void **state) {
  (void)state;
  size_t size;
  unsigned char *exact = x_numbers(0, &size), *nearly = x_numbers(-1e-3, &size),
                *less = x_numbers(-0.05, &size);
  assert_memory_equal(exact, nearly, size);
  assert_memory_not_equal(exact, less, size);
  free(exact);
  free(nearly);
  free(less);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(written_and_read_back),
      cmocka_unit_test(resumed_after_a_kill),
      cmocka_unit_test(resume_needs_its_frames),
      cmocka_unit_test(two_runs_do_not_share_a_result),
      cmocka_unit_test(an_old_result_survives_a_failed_write),
      cmocka_unit_test(files_with_long_paths_are_kept),
      cmocka_unit_test(damaged_files_are_refused),
      cmocka_unit_test(the_sidecar_is_xml_whatever_the_names),
      cmocka_unit_test(pictures),
      cmocka_unit_test(damage_is_the_largest_of_the_damages),
      cmocka_unit_test(attributes_have_the_types_readers_expect),
      cmocka_unit_test(texts_of_fixed_length_are_read),
      cmocka_unit_test(maps_show_their_field),
      cmocka_unit_test(bodies_in_space_are_written_and_read),
      cmocka_unit_test(bodies_in_space_are_seen_in_slices_and_from_outside),
      cmocka_unit_test(several_histories_are_several_curves),
      cmocka_unit_test(a_curve_has_gaps),
      cmocka_unit_test(an_axis_gets_no_step_for_what_cannot_be_seen)};
  return cmocka_run_group_tests_name("result", tests, NULL, NULL);
}
