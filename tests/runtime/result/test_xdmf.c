/* The sidecar of a result: a grid for each frame, names that mean something in XML, and a disk
   that is full. */
#define _GNU_SOURCE
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "runtime/result/views.h"
#include "runtime/result/xdmf.h"
#include "tests/runtime/small_result.h"

static char *sidecar(const result_header *h, const double *times, long frames) {
  char *text = NULL;
  size_t length;
  FILE *out = open_memstream(&text, &length);
  assert_non_null(out);
  assert_true(xdmf_write(out, h, &(mesh_views){.set_count = 0}, times, frames));
  fclose(out);
  return text;
}

static int count_of(const char *text, const char *word) {
  int count = 0;
  for (const char *at = text; (at = strstr(at, word)); at += strlen(word))
    count++;
  return count;
}

/* Every element that opens is closed, in its order. */
static void assert_nested(const char *text) {
  char open[16][32];
  int depth = 0;
  for (const char *at = strchr(text, '<'); at; at = strchr(at + 1, '<')) {
    const char *end = strchr(at, '>');
    assert_non_null(end);
    if (at[1] == '?' || end[-1] == '/') continue;
    const size_t length = strcspn(at + 1 + (at[1] == '/'), " >");
    if (at[1] != '/') {
      assert_true(depth < 16);
      snprintf(open[depth++], sizeof open[0], "%.*s", (int)length, at + 1);
    } else {
      assert_true(depth > 0);
      depth--;
      assert_int_equal(strlen(open[depth]), length);
      assert_memory_equal(open[depth], at + 2, length);
    }
  }
  assert_int_equal(depth, 0);
}

static void every_frame_is_a_grid(void **state) {
  (void)state;
  const double times[] = {0, 0.1, 1.0 / 3};
  const result_header h = small_header("/some/where/small.h5");
  char *text = sidecar(&h, times, 3);
  assert_nested(text);
  assert_int_equal(count_of(text, "<Grid Name=\"frame\" GridType=\"Uniform\">"), 3);
  assert_non_null(strstr(text, "<Time Value=\"0.10000000000000001\"/>"));
  assert_non_null(strstr(text, "<Time Value=\"0.33333333333333331\"/>")); /* all digits */
  assert_int_equal(count_of(text, "NumberOfElements=\"2\""), 3);
  assert_int_equal(count_of(text, "Dimensions=\"3 3\">small.h5:" VIEWS_POINTS "<"), 3);
  assert_int_equal(count_of(text, "Dimensions=\"2 2\">small.h5:" VIEWS_CONNECTIVITY "<"), 3);
  assert_null(strstr(text, "/some/where")); /* both files move together */
  free(text);
}

/* Vectors have three components in space and in the plane; fields of bonds stand on cells. */
static void fields_stand_on_points_or_cells(void **state) {
  (void)state;
  const double times[] = {0, 1};
  const result_header h = small_header("small.h5");
  char *text = sidecar(&h, times, 2), expected[512], set[256];
  assert_int_equal(count_of(text, "<Attribute Name=\"displacement\" AttributeType=\"Vector\" "
                                  "Center=\"Node\">"),
                   2);
  assert_int_equal(
      count_of(text, "<Attribute Name=\"omega\" AttributeType=\"Scalar\" Center=\"Cell\">"), 2);
  for (long frame = 0; frame < 2; frame++)
    for (int f = 0; f < 2; f++) {
      views_frame_name(&(views_array){&h.fields[f], h.fields[f].name}, frame, set, sizeof set);
      snprintf(expected, sizeof expected, "Dimensions=\"%s\">small.h5:%s<", f ? "2" : "3 3", set);
      assert_int_equal(count_of(text, expected), 1);
    }
  free(text);
}

static void names_may_hold_what_xml_reserves(void **state) {
  (void)state;
  const double times[] = {0};
  const result_header h = small_header("a<b>&\"c\".h5");
  char *text = sidecar(&h, times, 1);
  assert_nested(text);
  assert_non_null(strstr(text, ">a&lt;b&gt;&amp;&quot;c&quot;.h5:"));
  free(text);
}

static void a_result_without_frames_has_a_sidecar(void **state) {
  (void)state;
  const result_header h = small_header("small.h5");
  char *text = sidecar(&h, NULL, 0);
  assert_nested(text);
  assert_null(strstr(text, "Uniform"));
  free(text);
}

static void a_full_disk_is_told(void **state) {
  (void)state;
  FILE *out = fopen("/dev/full", "w");
  if (!out) skip();
  const double times[] = {0};
  const result_header h = small_header("small.h5");
  assert_false(xdmf_write(out, &h, &(mesh_views){.set_count = 0}, times, 1));
  fclose(out);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(every_frame_is_a_grid),
      cmocka_unit_test(fields_stand_on_points_or_cells),
      cmocka_unit_test(names_may_hold_what_xml_reserves),
      cmocka_unit_test(a_result_without_frames_has_a_sidecar),
      cmocka_unit_test(a_full_disk_is_told),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
