/* Meshes of Gmsh: what is read of both versions, groups, sides; and what is said of files that are
   damaged or not meant. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "runtime/geometry/gmsh_mesh.h"
#include "runtime/geometry/gmsh_text.h"

typedef struct reading {
  arena *memory;
  source_set sources;
  diagnostics d;
  const gmsh_mesh *m;
} reading;

static void read_text(reading *r, const char *text, double unit) {
  *r = (reading){.memory = arena_new()};
  diag_begin(&r->d, &r->sources);
  source_add(&r->sources, "t.msh", text, strlen(text));
  r->m = gmsh_mesh_read(r->memory, must_copy("t.msh"), unit, source_whole(&r->sources, 0), &r->d);
  assert_true((r->m == NULL) == (r->d.errors > 0));
}

static void end_reading(reading *r) {
  diag_clear(&r->d);
  source_clear(&r->sources);
  arena_free(r->memory);
}

/* Two triangles and a quadrilateral, 0 .. 3 x 0 .. 1; the quadrilateral's surface is clockwise.
   Node 9 is in no cell. */
#define HEAD "$MeshFormat\n4.1 0 8\n$EndMeshFormat\n"
#define NAMES                                                                                      \
  "$PhysicalNames\n4\n0 3 \"foot\"\n1 2 \"right edge\"\n2 1 \"left part\"\n2 5 \"right part\"\n"   \
  "$EndPhysicalNames\n"
#define ENTITIES                                                                                   \
  "$Entities\n1 1 2 0\n1 0 0 0 1 3\n1 2 0 0 3 1 0 1 2 2 1 1\n1 0 0 0 2 1 0 1 1 0\n"                \
  "2 2 0 0 3 1 0 1 5 1 1\n$EndEntities\n"
#define NODES                                                                                      \
  "$Nodes\n2 7 1 9\n2 1 0 4\n1\n2\n3\n4\n0 0 0\n2 0 0\n2 1 0\n0 1 0\n2 2 0 3\n5\n6\n9\n3 0 0\n"    \
  "3 1 0\n7 7 7\n$EndNodes\n"
#define ELEMENTS                                                                                   \
  "$Elements\n4 5 1 5\n0 1 15 1\n1 1\n1 1 1 1\n2 6 5\n2 1 2 2\n3 1 2 3\n4 1 3 4\n2 2 3 1\n"        \
  "5 2 3 6 5\n$EndElements\n"

static int node_of(const gmsh_mesh *m, int64_t tag) {
  int n = 0;
  while (n < m->node_count && m->tag[n] != tag)
    n++;
  assert_true(n < m->node_count);
  return n;
}

static void check_mesh(const gmsh_mesh *m) {
  assert_int_equal(m->node_count, 6);
  assert_int_equal(m->cell_count, 3);
  assert_int_equal(m->side_count, 1);
  assert_int_equal(m->group_count, 4);
  assert_true(fabs(m->area - 3e-6) < 1e-20 && fabs(m->least - 1e-3) < 1e-18);
  const int corner = node_of(m, 6);
  assert_true(m->at[corner][0] == 3e-3 && m->at[corner][1] == 1e-3);
  const gmsh_group *left = gmsh_mesh_group(m, "left part"),
                   *right = gmsh_mesh_group(m, "right part"),
                   *edge = gmsh_mesh_group(m, "right edge"), *foot = gmsh_mesh_group(m, "foot");
  assert_null(gmsh_mesh_group(m, "left"));
  assert_true(left->dimension == 2 && left->item_count == 2 && left->node_count == 4);
  assert_true(right->item_count == 1 && right->node_count == 4);
  assert_int_equal(m->cell_tag[right->items[0]], 5);
  assert_true(edge->dimension == 1 && edge->item_count == 1 && edge->node_count == 2);
  assert_true(foot->dimension == 0 && foot->node_count == 1);
  assert_int_equal(m->tag[foot->nodes[0]], 1);
  for (int c = 0; c < m->cell_count; c++) { /* also of the clockwise surface */
    double at[ELEMENT_MOST_NODES][2], u[2];
    for (int q = 0; q < m->nodes[c] && q < ELEMENT_MOST_NODES; q++)
      memcpy(at[q], m->at[m->cell[c][q]], sizeof at[q]);
    assert_true(element_is_sound(m->nodes[c], (const double(*)[2])at, u));
  }
  /* the line 6 -> 5 goes down: the quadrilateral, to its right, has it the other way round */
  const gmsh_side *side = &m->sides[edge->items[0]];
  assert_true(side->nodes == 2 && m->cell_tag[side->cell] == 5 && side->turned);
}

static void version_4_1_is_read(void **state) {
  (void)state;
  reading r;
  read_text(&r, HEAD NAMES ENTITIES NODES ELEMENTS, 1e-3);
  assert_non_null(r.m);
  assert_int_equal(r.d.count, 0);
  check_mesh(r.m);
  end_reading(&r);
}

static void version_4_0_is_read(void **state) {
  (void)state;
  reading r;
  read_text(&r,
            "$MeshFormat\n4 0 8\n$EndMeshFormat\n$Comments\n$Nodes \nhere\n$EndComments\n" NAMES
            "$Entities\n1 1 2 0\n1 0 0 0 0 0 0 1 3\n1 2 0 0 3 1 0 1 2 2 1 1\n1 0 0 0 2 1 0 1 1 0\n"
            "2 2 0 0 3 1 0 1 5 1 1\n$EndEntities\n"
            "$Nodes\n2 7\n1 2 0 4\n1 0 0 0\n2 2 0 0\n3 2 1 0\n4 0 1 0\n2 2 0 3\n5 3 0 0\n6 3 1 0\n"
            "9 7 7 7\n$EndNodes\n"
            "$Elements\n4 5\n1 0 15 1\n1 1\n1 1 1 1\n2 6 5\n1 2 2 2\n3 1 2 3\n4 1 3 4\n2 2 3 1\n"
            "5 2 3 6 5\n$EndElements\n",
            1e-3);
  assert_non_null(r.m);
  check_mesh(r.m);
  end_reading(&r);
}

/* Of nodes with their places along lines and in surfaces (Mesh.SaveParametric), which are not asked
   for. */
static void parametric_nodes_are_read(void **state) {
  (void)state;
  reading r;
  read_text(&r,
            HEAD NAMES ENTITIES
            "$Nodes\n3 7 1 9\n0 1 1 1\n1\n0 0 0\n1 1 1 2\n5\n6\n3 0 0 .25\n3 1 0 .75\n2 1 1 4\n2\n"
            "3\n4\n9\n2 0 0 .5 .6\n2 1 0 .7 .8\n0 1 0 -1 -2\n7 7 7 8 9\n$EndNodes\n" ELEMENTS,
            1e-3);
  assert_non_null(r.m);
  assert_int_equal(r.d.count, 0);
  check_mesh(r.m);
  end_reading(&r);
}

/* Of 6 nodes; the arc of a side is above its chord. */
static void quadratic_triangles_are_read(void **state) {
  (void)state;
  reading r;
  read_text(&r,
            HEAD "$PhysicalNames\n1\n1 1 \"arc\"\n$EndPhysicalNames\n"
                 "$Entities\n0 1 1 0\n1 0 0 0 1 1 0 1 1 0\n1 0 0 0 1 1 0 0 0\n$EndEntities\n"
                 "$Nodes\n1 6 1 6\n2 1 0 6\n1 2 3 4 5 6\n0 0 0 1 0 0 0 1 0 .5 0 0 .6 .6 0 0 .5 0\n"
                 "$EndNodes\n$Elements\n2 2 1 2\n1 1 8 1\n1 2 3 5\n2 1 9 1\n2 1 2 3 4 5 6\n"
                 "$EndElements\n",
            1);
  assert_non_null(r.m);
  assert_int_equal(r.m->nodes[0], 6);
  assert_int_equal(r.m->sides[0].nodes, 3);
  assert_int_equal(r.m->sides[0].cell, 0);
  assert_false(r.m->sides[0].turned);
  assert_int_equal(r.m->tag[r.m->sides[0].node[2]], 5);
  /* the triangle and 2/3 of that of the arc's middle, which is 0.1 sqrt 2 high on sqrt 2 */
  assert_true(fabs(r.m->area - (0.5 + 2.0 / 3 * 0.2)) < 1e-14);
  end_reading(&r);
}

typedef struct bad {
  const char *text, *message;
  int line;
} bad;

#define SMALL(nodes, elements)                                                                     \
  HEAD "$Nodes\n1 4 1 4\n2 1 0 4\n1 2 3 4\n" nodes "\n$EndNodes\n$Elements\n" elements             \
       "\n$EndElements\n"
#define FIVE(nodes, elements)                                                                      \
  HEAD "$Nodes\n1 5 1 5\n2 1 0 5\n1 2 3 4 5\n" nodes "\n$EndNodes\n$Elements\n1 2 1 2\n" elements  \
       "\n$EndElements\n"
#define SQUARE "0 0 0 1 0 0 1 1 0 0 1 0"

static const bad wrong[] = {
    {"", "this is no mesh of Gmsh", 1},
    {"x,y\n1,2\n", "this is no mesh of Gmsh", 1},
    {"$MeshFormat\n2.2 0 8\n$EndMeshFormat\n", "has version 2.2 of Gmsh's format", 2},
    {"$MeshFormat\n4.1 1 8\n\x01", "the file is binary", 2},
    {HEAD NAMES ENTITIES "$Nodes\n2 7 1 9\n2 1 0 4\n1\n2\n",
     "the file ends before all of its section `$Nodes`", 18},
    {HEAD "$Nodes\n1 4 1 4\n2 1 0 4\n1 2 3 4\n0 0 0\n$EndNodes\n",
     "the section `$Nodes` ends before", 9},
    {HEAD "$Nodes\n1 2 1 2\n2 1 0 1\n1 0 0 0 5\n$EndNodes\n", "has more than it says", 7},
    {HEAD "$Nodes\n1 4 1 4\n2 1 0 100000000\n1 2 3 4\n", "the file ends before", 4},
    {HEAD "$Nodes\n1 4 1 4\n2 1 0 -3\n1 2 3 4\n", "`-3` is no number of things", 6},
    {SMALL("0 0 0 1 0 0 1 x 0 0 1 0", "1 1 1 1\n2 1 3 1\n1 1 2 3 4"), "`x` is no number", 8},
    {SMALL("0 0 0 1 0 0 1 nan 0 0 1 0", "1 1 1 1\n2 1 3 1\n1 1 2 3 4"), "`nan` is no number", 8},
    {SMALL(SQUARE, "1 1 1 1\n2 1 3 1\n1 1 2 3 7"),
     "element 1 has the node 7, which the file has not", 13},
    {SMALL(SQUARE, "1 1 1 1\n2 1 3 1\n1 1 2 4 3"), "quadrilateral 1 is folded", 13},
    {SMALL(SQUARE, "1 1 1 1\n2 1 2 2\n1 1 2 3\n2 1 4 3"), "triangle 2 is inverted", 14},
    {SMALL(SQUARE, "2 1 1 1\n2 1 2 1\n1 1 2 3\n2 2 2 1\n2 1 2 3"),
     "cells 1 and 2 have the same nodes", 15},
    {SMALL(SQUARE, "1 1 1 1\n2 1 2 2\n1 1 2 3\n2 1 2 4"), "cells 1 and 2 lie over each other", 14},
    {FIVE("0 0 0 2 0 0 2 2 0 1 .5 0 0 2 0", "2 1 2 2\n1 1 2 3\n2 1 4 5"),
     "cells 1 and 2 lie over each other: node 4 of this one, at (1000, 500) mm, is in cell 1", 14},
    {FIVE("0 0 0 2 0 0 0 1 0 1 0 0 0 -1 0", "2 1 2 2\n1 1 2 3\n2 1 5 4"),
     "node 4 hangs: it lies at (1000, 0) mm on the side from node 1 to 2 of cell 1", 13},
    {HEAD "$Nodes\n1 6 1 6\n2 1 0 6\n1 2 3 4 5 6\n0 0 0 1 0 0 0 1 0 0 0 0 1 0 0 0 1 0\n"
          "$EndNodes\n$Elements\n1 2 1 2\n2 1 2 2\n1 1 2 3\n2 4 5 6\n$EndElements\n",
     "cells 1 and 2 lie over each other: the middle of this one is in cell 1", 14},
    {SMALL("0 0 0 1 0 0 1 1 .5 0 1 0", "1 1 1 1\n2 1 3 1\n1 1 2 3 4"), "stands at z = 500 mm", 7},
    {SMALL("0 0 0 1 0 0 2 0 0 3 0 0", "1 1 1 1\n2 1 2 1\n1 1 2 3"), "is degenerate", 13},
    {SMALL(SQUARE, "1 1 1 1\n2 1 2 1\n1 1 2 2"), "has a node twice", 13},
    {SMALL(SQUARE, "1 1 1 1\n2 1 16 1\n1 1 2 3 4 1 2 3 4"),
     "quadrilaterals of 8 nodes, which are not read", 12},
    {SMALL(SQUARE, "1 1 1 1\n3 1 4 1\n1 1 2 3 4"), "tetrahedra, which are not read", 12},
    {SMALL(SQUARE, "1 1 1 1\n1 1 1 1\n1 1 2"), "has no cells in the plane", 1},
    {HEAD "$Nodes\n1 2 1 2\n2 1 0 2\n1 1\n0 0 0 1 0 0\n$EndNodes\n", "there are two nodes 1", 7},
    {HEAD "$PhysicalNames\n2\n1 1 \"a\"\n2 2 \"a\"\n$EndPhysicalNames\n", "two physical groups `a`",
     7},
    {HEAD "$PhysicalNames\n1\n1 1 a\n$EndPhysicalNames\n", "a name in quotes", 6},
    {HEAD "$PartitionedEntities\n", "is partitioned", 4},
};

static void faulty_files_are_told_at_their_lines(void **state) {
  (void)state;
  for (size_t k = 0; k < sizeof wrong / sizeof *wrong; k++) {
    reading r;
    read_text(&r, wrong[k].text, 1);
    assert_null(r.m);
    assert_true(r.d.count > 0);
    const diagnostic *d = &r.d.items[0];
    const int line = source_line_number(&r.sources, d->where.file, d->where.begin);
    if (!strstr(d->message, wrong[k].message) || line != wrong[k].line)
      print_message("%zu: line %d: %s\n", k, line, d->message);
    assert_non_null(strstr(d->message, wrong[k].message));
    assert_int_equal(line, wrong[k].line);
    end_reading(&r);
  }
}

/* Wherever a file is cut off it is told, or nothing that counts was lost. */
static void truncated_files_are_told(void **state) {
  (void)state;
  static const char whole[] = HEAD NAMES ENTITIES NODES ELEMENTS;
  for (size_t length = 0; length < strlen(whole) - 1; length++) {
    char *text = strndup(whole, length);
    reading r;
    read_text(&r, text, 1);
    assert_null(r.m);
    end_reading(&r);
    free(text);
  }
}

static void nodes_at_one_place_are_told(void **state) {
  (void)state;
  reading r;
  read_text(&r,
            HEAD "$Nodes\n1 6 1 6\n2 1 0 6\n1 2 3 4 5 6\n0 0 0 1 0 0 1 1 0 0 1 0 1 0 0 2 0 0\n"
                 "$EndNodes\n$Elements\n1 2 1 2\n2 1 2 2\n1 1 2 3\n2 5 6 3\n$EndElements\n",
            1);
  assert_non_null(r.m);
  assert_int_equal(r.d.count, 1);
  assert_non_null(strstr(r.d.items[0].message, "1 pair of nodes stand at one place, as "));
  end_reading(&r);
}

/* A fan of triangles around node 1. */
static void read_fan(reading *r, int count) {
  char text[20000] = HEAD, *end = text + strlen(text);
  end += sprintf(end, "$Nodes\n1 %d 1 %d\n2 1 0 %d\n", count + 1, count + 1, count + 1);
  for (int n = 0; n <= count; n++)
    end += sprintf(end, "%d\n", n + 1);
  end += sprintf(end, "0 0 0\n");
  for (int n = 0; n < count; n++)
    end += sprintf(end, "%.16g %.16g 0\n", cos(2 * M_PI * n / count), sin(2 * M_PI * n / count));
  end += sprintf(end, "$EndNodes\n$Elements\n1 %d 1 %d\n2 1 2 %d\n", count, count, count);
  for (int n = 0; n < count; n++)
    end += sprintf(end, "%d 1 %d %d\n", n + 1, n + 2, (n + 1) % count + 2);
  sprintf(end, "$EndElements\n");
  read_text(r, text, 1);
}

/* A double has 53 bits for the cells that begin with a node. */
static void few_cells_meet_in_a_node(void **state) {
  (void)state;
  reading r;
  read_fan(&r, 52);
  assert_non_null(r.m);
  end_reading(&r);
  read_fan(&r, 53);
  assert_null(r.m);
  assert_non_null(strstr(r.d.items[0].message, "more than 52 cells meet in a node"));
  end_reading(&r);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(version_4_1_is_read),
      cmocka_unit_test(version_4_0_is_read),
      cmocka_unit_test(parametric_nodes_are_read),
      cmocka_unit_test(quadratic_triangles_are_read),
      cmocka_unit_test(faulty_files_are_told_at_their_lines),
      cmocka_unit_test(truncated_files_are_told),
      cmocka_unit_test(few_cells_meet_in_a_node),
      cmocka_unit_test(nodes_at_one_place_are_told),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
