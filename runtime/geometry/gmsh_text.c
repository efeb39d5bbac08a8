#include "runtime/geometry/gmsh_text.h"

#include <ctype.h>
#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "dsl/base/arena.h"

#define FARTHEST 1e30 /* m: squares are finite */

enum { MOST = 1 << 28, WORD = 64 };

typedef struct reader {
  gmsh_text *of;
  const char *p, *end;
  const char *section; /* its line */
  double unit;
  diagnostics *d;
} reader;

void gmsh_text_free(gmsh_text *t) {
  for (int k = 0; k < t->name_count; k++)
    free(t->names[k].name);
  free(t->names);
  free(t->entities);
  free(t->groups);
  free(t->nodes);
  free(t->elements);
  file_text_close(&t->file);
}

/* --- words ------------------------------------------------------------------------------------ */

static uint32_t offset(const reader *r, const char *p) {
  return (uint32_t)(p - r->of->file.text);
}

/* The line that p stands in. */
static span line_of(const reader *r, const char *p) {
  return file_text_line(&r->of->file, p, r->d);
}

static void skip_blanks(reader *r) {
  while (r->p < r->end && isspace((unsigned char)*r->p))
    r->p++;
}

/* The end of the section, or of the file, where something is still to come. */
static bool ends_early(reader *r) {
  char name[WORD];
  const size_t length = strcspn(r->section, " \t\r\n");
  snprintf(name, sizeof name, "%.*s", (int)(length < WORD - 1 ? length : WORD - 1), r->section);
  if (r->p >= r->end)
    diag_report(r->d, DIAG_FILE, line_of(r, r->section),
                "the file ends before all of its section `%s` is there", name);
  else
    diag_report(r->d, DIAG_FILE, line_of(r, r->p),
                "the section `%s` ends before all of it is there", name);
  diag_hint(r->d, "the file is cut off or damaged: write it anew with Gmsh");
  return false;
}

static bool is_no_number(reader *r, const char *from, const char *what) {
  const size_t length = strcspn(from, " \t\r\n");
  diag_report(r->d, DIAG_BAD_NUMBER, line_of(r, from), "`%.*s` is no %s",
              (int)(length < 40 ? length : 40), from, what);
  return false;
}

/* A number begins here: *from. */
static bool has_word(reader *r, const char **from) {
  skip_blanks(r);
  *from = r->p;
  return r->p < r->end && *r->p != '$' ? true : ends_early(r);
}

static bool is_end_of_word(const char *p) {
  return *p == 0 || isspace((unsigned char)*p);
}

static bool whole(reader *r, int64_t *value) {
  const char *from;
  char *rest;
  if (!has_word(r, &from)) return false;
  errno = 0;
  *value = strtoll(from, &rest, 10);
  if (rest == from || errno || !is_end_of_word(rest)) return is_no_number(r, from, "whole number");
  r->p = rest;
  return true;
}

/* A number of things that follow; each of them takes two bytes at least. */
static bool number(reader *r, int *count) {
  int64_t value;
  const char *from;
  if (!has_word(r, &from) || !whole(r, &value)) return false;
  if (value < 0 || value > MOST) return is_no_number(r, from, "number of things in a file");
  if (value > (r->end - r->p) / 2 + 1) {
    r->p = r->end;
    return ends_early(r);
  }
  *count = (int)value;
  return true;
}

static bool real(reader *r, double *value) {
  const char *from;
  char *rest;
  if (!has_word(r, &from)) return false;
  *value = strtod(from, &rest);
  if (rest == from || !is_end_of_word(rest) || !(fabs(*value) < FARTHEST))
    return is_no_number(r, from, "number");
  r->p = rest;
  return true;
}

static bool skip_wholes(reader *r, int count) {
  int64_t value;
  for (int k = 0; k < count; k++)
    if (!whole(r, &value)) return false;
  return true;
}

static bool skip_reals(reader *r, int count) {
  double value;
  for (int k = 0; k < count; k++)
    if (!real(r, &value)) return false;
  return true;
}

/* --- sections --------------------------------------------------------------------------------- */

static bool read_format(reader *r) {
  double version;
  int64_t binary;
  const char *from;
  if (!has_word(r, &from) || !real(r, &version)) return false;
  if (version != 4 && version != 4.1) {
    diag_report(r->d, DIAG_NOT_SUPPORTED, line_of(r, from),
                "the file has version %g of Gmsh's format; read is version 4", version);
    diag_hint(r->d, "write it with `gmsh -2 -format msh41`, or save it as \"Version 4 ASCII\"");
    return false;
  }
  r->of->one = version == 4.1;
  if (!whole(r, &binary)) return false;
  if (binary == 0) return skip_wholes(r, 1);
  diag_report(r->d, DIAG_NOT_SUPPORTED, line_of(r, from), "the file is binary; read is ASCII");
  diag_hint(r->d, "leave `-bin` away: `gmsh -2 -format msh41`");
  return false;
}

/* What stands between quotes. */
static bool read_name(reader *r, gmsh_name *n) {
  const char *from;
  int64_t dimension;
  if (!has_word(r, &from) || !whole(r, &dimension) || !whole(r, &n->tag)) return false;
  const char *line_end = r->p + strcspn(r->p, "\n"),
             *open = memchr(r->p, '"', (size_t)(line_end - r->p)), *close = line_end;
  while (open && close > open && *close != '"')
    close--;
  if (!open || close <= open + 1 || dimension < 0 || dimension > 3) {
    diag_report(r->d, DIAG_FILE, line_of(r, from),
                "a physical group has a dimension, a number and a name in quotes");
    return false;
  }
  n->dimension = (int)dimension;
  n->at = offset(r, from);
  n->name = strndup(open + 1, (size_t)(close - open - 1));
  r->p = close + 1;
  return true;
}

static bool read_names(reader *r) {
  int count;
  if (!number(r, &count)) return false;
  if (r->of->name_count + count > GMSH_MOST_GROUPS) {
    diag_report(r->d, DIAG_OUT_OF_BOUNDS, line_of(r, r->section),
                "a file has at most %d physical groups, this one has %d", GMSH_MOST_GROUPS,
                r->of->name_count + count);
    return false;
  }
  r->of->names =
      must_realloc(r->of->names, ((size_t)(r->of->name_count + count) + 1) * sizeof *r->of->names);
  for (int k = 0; k < count; k++) {
    gmsh_name *n = &r->of->names[r->of->name_count];
    *n = (gmsh_name){.name = NULL};
    if (!read_name(r, n)) return false;
    r->of->name_count++;
  }
  return true;
}

static bool read_groups(reader *r, gmsh_entity *e) {
  gmsh_text *t = r->of;
  if (!number(r, &e->group_count)) return false;
  e->first_group = t->group_count;
  t->groups =
      must_realloc(t->groups, ((size_t)(t->group_count + e->group_count) + 1) * sizeof *t->groups);
  for (int k = 0; k < e->group_count; k++)
    if (!whole(r, &t->groups[t->group_count++])) return false;
  return true;
}

/* Its box, its groups, what bounds it. */
static bool read_entity(reader *r, int dimension) {
  gmsh_entity *e = &r->of->entities[r->of->entity_count++];
  int bounds;
  *e = (gmsh_entity){.dimension = dimension};
  if (!whole(r, &e->tag) || !skip_reals(r, dimension == 0 && r->of->one ? 3 : 6)) return false;
  if (!read_groups(r, e)) return false;
  return dimension == 0 || (number(r, &bounds) && skip_wholes(r, bounds));
}

static bool read_entities(reader *r) {
  int count[4];
  for (int k = 0; k < 4; k++)
    if (!number(r, &count[k])) return false;
  for (int k = 0; k < 4; k++) {
    r->of->entities = must_realloc(r->of->entities, ((size_t)(r->of->entity_count + count[k]) + 1) *
                                                        sizeof *r->of->entities);
    for (int n = 0; n < count[k]; n++)
      if (!read_entity(r, k)) return false;
  }
  return true;
}

/* Of a block: "dimension tag" in version 4.1, the other way round in 4.0. */
static bool read_owner(reader *r, int64_t *dimension, int64_t *tag) {
  const char *from;
  if (!has_word(r, &from)) return false;
  const bool good =
      r->of->one ? whole(r, dimension) && whole(r, tag) : whole(r, tag) && whole(r, dimension);
  if (!good || (*dimension >= 0 && *dimension <= 3)) return good;
  return is_no_number(r, from, "dimension");
}

static bool read_place(reader *r, gmsh_node *n, int more) {
  for (int a = 0; a < 3; a++) {
    if (!real(r, &n->at[a])) return false;
    n->at[a] *= r->unit;
  }
  return skip_reals(r, more);
}

static bool read_tag(reader *r, gmsh_node *n) {
  const char *from;
  if (!has_word(r, &from)) return false;
  n->where = offset(r, from);
  return whole(r, &n->tag);
}

/* The nodes of an entity: all tags before all places in version 4.1. */
static bool read_nodes_of(reader *r) {
  gmsh_text *t = r->of;
  int64_t dimension, tag, parametric;
  int count;
  if (!read_owner(r, &dimension, &tag) || !whole(r, &parametric) || !number(r, &count))
    return false;
  const int more = parametric ? (int)dimension : 0;
  t->nodes = must_realloc(t->nodes, ((size_t)(t->node_count + count) + 1) * sizeof *t->nodes);
  gmsh_node *first = t->nodes + t->node_count;
  for (int k = 0; k < count; k++)
    if (!read_tag(r, &first[k]) || (!t->one && !read_place(r, &first[k], more))) return false;
  for (int k = 0; k < count && t->one; k++)
    if (!read_place(r, &first[k], more)) return false;
  t->node_count += count;
  return true;
}

/* Of a section: blocks, things in all, and more numbers in version 4.1. */
static bool read_header(reader *r, int *blocks) {
  int all;
  return number(r, blocks) && number(r, &all) && skip_wholes(r, r->of->one ? 2 : 0);
}

static bool read_nodes(reader *r) {
  int blocks;
  if (!read_header(r, &blocks)) return false;
  for (int k = 0; k < blocks; k++)
    if (!read_nodes_of(r)) return false;
  return true;
}

/* Gmsh's numbers of the kinds of elements; those that are read have nodes. */
static const struct kind {
  int number, dimension, nodes;
  const char *words;
} kinds[] = {
    {15, 0, 1, "points"},
    {1, 1, 2, "lines of 2 nodes"},
    {8, 1, 3, "lines of 3 nodes"},
    {2, 2, 3, "triangles of 3 nodes"},
    {9, 2, 6, "triangles of 6 nodes"},
    {3, 2, 4, "quadrilaterals of 4 nodes"},
    {16, 2, 0, "quadrilaterals of 8 nodes"},
    {10, 2, 0, "quadrilaterals of 9 nodes"},
    {20, 2, 0, "triangles of 9 nodes"},
    {21, 2, 0, "triangles of 10 nodes"},
    {4, 3, 0, "tetrahedra"},
    {5, 3, 0, "hexahedra"},
    {6, 3, 0, "prisms"},
    {7, 3, 0, "pyramids"},
};

static const struct kind *kind_of(reader *r, const char *from, int64_t number, int64_t dimension) {
  const struct kind *known = NULL;
  for (size_t k = 0; k < sizeof kinds / sizeof *kinds; k++)
    if (kinds[k].number == number) known = &kinds[k];
  if (known && known->nodes > 0 && known->dimension == dimension) return known;
  if (known && known->dimension == dimension)
    diag_report(r->d, DIAG_NOT_SUPPORTED, line_of(r, from), "the file has %s, which are not read",
                known->words);
  else
    diag_report(r->d, DIAG_NOT_SUPPORTED, line_of(r, from),
                "the file has elements of type %lld of Gmsh in %lld dimensions, which are not read",
                (long long)number, (long long)dimension);
  const bool space = dimension == 3 || (known && known->dimension == 3);
  diag_hint(r->d, space ? "meshes are plane: `gmsh -2`, without volumes"
                        : "triangles of 3 or 6 nodes (Mesh.ElementOrder = 1 or 2) and "
                          "quadrilaterals of 4 (order 1) are read");
  return NULL;
}

static bool read_element(reader *r, const struct kind *kind, int64_t entity) {
  gmsh_element *e = &r->of->elements[r->of->element_count];
  const char *from;
  if (!has_word(r, &from)) return false;
  *e = (gmsh_element){.dimension = (unsigned char)kind->dimension,
                      .nodes = (unsigned char)kind->nodes,
                      .entity = entity,
                      .where = offset(r, from)};
  if (!whole(r, &e->tag)) return false;
  for (int k = 0; k < kind->nodes; k++)
    if (!whole(r, &e->node[k])) return false;
  r->of->element_count++;
  return true;
}

static bool read_elements_of(reader *r) {
  gmsh_text *t = r->of;
  int64_t dimension, tag, type;
  int count;
  const char *from;
  if (!has_word(r, &from) || !read_owner(r, &dimension, &tag) || !whole(r, &type) ||
      !number(r, &count))
    return false;
  const struct kind *kind = kind_of(r, from, type, dimension);
  if (!kind) return false;
  t->elements =
      must_realloc(t->elements, ((size_t)(t->element_count + count) + 1) * sizeof *t->elements);
  for (int k = 0; k < count; k++)
    if (!read_element(r, kind, tag)) return false;
  return true;
}

static bool read_elements(reader *r) {
  int blocks;
  if (!read_header(r, &blocks)) return false;
  for (int k = 0; k < blocks; k++)
    if (!read_elements_of(r)) return false;
  return true;
}

static bool refuse_parts(reader *r) {
  diag_report(r->d, DIAG_NOT_SUPPORTED, line_of(r, r->section), "the mesh is partitioned");
  diag_hint(r->d, "write it without partitions (Mesh.NbPartitions = 0)");
  return false;
}

typedef bool section_reader(reader *r);
static const struct {
  const char *name;
  section_reader *read;
} sections[] = {
    {"$MeshFormat", read_format}, {"$PhysicalNames", read_names},
    {"$Entities", read_entities}, {"$PartitionedEntities", refuse_parts},
    {"$Nodes", read_nodes},       {"$Elements", read_elements},
};
enum { SECTIONS = sizeof sections / sizeof *sections };

/* --- the text --------------------------------------------------------------------------------- */

static bool is_word(const char *p, const char *word) {
  const size_t length = strlen(word);
  return strncmp(p, word, length) == 0 && is_end_of_word(p + length);
}

/* Behind the line `$End...` of the section. */
static bool skip_to_end(reader *r) {
  const size_t length = strcspn(r->section, " \t\r\n") - 1;
  for (; r->p < r->end; r->p += strcspn(r->p, "\n") + 1) {
    skip_blanks(r);
    if (strncmp(r->p, "$End", 4) == 0 && strncmp(r->p + 4, r->section + 1, length) == 0 &&
        is_end_of_word(r->p + 4 + length)) {
      r->p += 4 + length;
      return true;
    }
  }
  r->p = r->end;
  return ends_early(r);
}

/* All is read: nothing but the end of the section follows. */
static bool is_at_end(reader *r) {
  skip_blanks(r);
  if (r->p >= r->end || *r->p == '$') return skip_to_end(r);
  diag_report(r->d, DIAG_FILE, line_of(r, r->p), "the section has more than it says it has");
  diag_hint(r->d, "the file is damaged: write it anew with Gmsh");
  return false;
}

static bool is_gmsh(reader *r) {
  skip_blanks(r);
  if (is_word(r->p, sections[0].name)) return true;
  diag_report(r->d, DIAG_FILE, line_of(r, r->p < r->end ? r->p : r->of->file.text),
              "this is no mesh of Gmsh: it does not begin with `$MeshFormat`");
  diag_hint(r->d, "`gmsh -2 -format msh41 plate.geo -o plate.msh` writes one");
  return false;
}

static bool read_sections(reader *r) {
  if (!is_gmsh(r)) return false;
  for (skip_blanks(r); r->p < r->end; skip_blanks(r)) {
    int k = 0;
    r->section = r->p;
    if (*r->p != '$') {
      diag_report(r->d, DIAG_FILE, line_of(r, r->p), "a section is expected here, as `$Nodes`");
      return false;
    }
    r->p += strcspn(r->p, " \t\r\n");
    while (k < SECTIONS && !is_word(r->section, sections[k].name))
      k++;
    if (k == SECTIONS ? !skip_to_end(r) : !sections[k].read(r) || !is_at_end(r)) return false;
  }
  return true;
}

bool gmsh_text_read(gmsh_text *t, char *path, double unit, span where, diagnostics *d) {
  *t = (gmsh_text){.name_count = 0};
  if (!file_text_open(&t->file, path, where, d)) return false;
  reader r = {.of = t,
              .p = t->file.text,
              .end = t->file.text + strlen(t->file.text), /* not beyond a zero byte */
              .section = t->file.text,
              .unit = unit,
              .d = d};
  return read_sections(&r);
}
