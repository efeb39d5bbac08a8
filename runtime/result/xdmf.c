#include "runtime/result/xdmf.h"

#include <string.h>

#include "dsl/base/characters.h"
#include "runtime/result/views.h"

/* The sidecar names the HDF5 file without its folder: both move together. */
static const char *base_name(const char *path) {
  const char *slash = strrchr(path, '/');
  return slash ? slash + 1 : path;
}

/* Names of lattices and files may hold characters that mean something in XML. */
static void print_text(FILE *out, const char *text) {
  for (; *text; text++)
    markup_put(out, *text);
}

/* `file:set`, as HDF5 data are named. */
static void print_place(FILE *out, const char *file, const char *set) {
  print_text(out, file);
  fputc(':', out);
  print_text(out, set);
}

static void print_item(FILE *out, const char *file, const char *set, const char *type,
                       int precision, long rows, int columns) {
  fprintf(out, "<DataItem Format=\"HDF\" NumberType=\"%s\" Precision=\"%d\" Dimensions=\"%ld", type,
          precision, rows);
  if (columns > 1) fprintf(out, " %d", columns);
  fputs("\">", out);
  print_place(out, file, set);
  fputs("</DataItem>", out);
}

static void print_array(FILE *out, const char *file, const views_array *a, const char *set,
                        long count) {
  const int components = views_components(a->field);
  const bool of_cells = a->field->interaction || result_field_of_cells(a->field);
  fprintf(out, "<Attribute Name=\"%s\" AttributeType=\"%s\" Center=\"%s\">", a->name,
          components == 1 ? "Scalar" : "Vector", of_cells ? "Cell" : "Node");
  print_item(out, file, set, "Float", 8, count, components);
  fputs("</Attribute>\n", out);
}

static void print_attribute(FILE *out, const char *file, const result_header *h, long frame,
                            const views_array *a) {
  char set[512];
  views_frame_name(a, frame, set, sizeof set);
  print_array(out, file, a, set, views_count(h, a->field));
}

static void begin_grid(FILE *out, const char *name, double time) {
  fprintf(out, "<Grid Name=\"%s\" GridType=\"Uniform\"><Time Value=\"%.17g\"/>\n", name, time);
}

static void print_topology(FILE *out, const char *file, const char *words, const char *set,
                           long cells, int corners) {
  fprintf(out, "<Topology TopologyType=\"%s NumberOfElements=\"%ld\">", words, cells);
  print_item(out, file, set, "Int", 4, cells, corners);
  fputs("</Topology>\n", out);
}

static void print_geometry(FILE *out, const char *file, const char *set, long points) {
  fputs("<Geometry GeometryType=\"XYZ\">", out);
  print_item(out, file, set, "Float", 8, points, 3);
  fputs("</Geometry>\n", out);
}

/* A part of the document: a series of grids. */
typedef struct sidecar {
  FILE *out;
  const char *file; /* without its folder */
  const result_header *header;
  const mesh_views *meshes;
  const double *times; /* [frames] */
  long frames;
  const views_array *arrays;
  int array_count;
} sidecar;

static void begin_series(const sidecar *s, const char *name, int length) {
  char text[512];
  snprintf(text, sizeof text, "%.*s", length, name);
  fputs("<Grid Name=\"", s->out);
  print_text(s->out, text);
  fputs("\" GridType=\"Collection\" CollectionType=\"Temporal\">\n", s->out);
}

static void print_attributes(const sidecar *s, long frame, bool of_bonds) {
  for (int k = 0; k < s->array_count; k++)
    if (of_bonds || !s->arrays[k].field->interaction)
      print_attribute(s->out, s->file, s->header, frame, &s->arrays[k]);
}

static void print_bonds(const sidecar *s, const char *name) {
  const long bonds = views_bonds(s->header);
  begin_series(s, name, (int)strlen(name));
  for (long frame = 0; frame < s->frames; frame++) {
    begin_grid(s->out, "frame", s->times[frame]);
    print_topology(s->out, s->file, "Polyline\" NodesPerElement=\"2\"", VIEWS_CONNECTIVITY, bonds,
                   2);
    print_geometry(s->out, s->file, VIEWS_POINTS, s->header->particle_count);
    print_attributes(s, frame, true);
    fputs("</Grid>\n", s->out);
  }
  fputs("</Grid>", s->out);
}

/* A set of cells that are alike or not. */
static void print_set(const sidecar *s, const char *name, const mesh_cells *c) {
  static const char *const words[] = {[3] = "Triangle\"", [4] = "Quadrilateral\"", [6] = "Tri_6\""};
  if (c->alike)
    print_topology(s->out, s->file, words[c->alike], name, c->count, c->alike);
  else {
    fprintf(s->out, "<Topology TopologyType=\"Mixed\" NumberOfElements=\"%ld\">", c->count);
    print_item(s->out, s->file, name, "Int", 4, c->count + c->corner_count, 1);
    fputs("</Topology>\n", s->out);
  }
}

/* Of cells; set -1: of a crack, which has none. */
static void print_values(const sidecar *s, long frame, int set) {
  for (int k = 0; k < s->header->field_count; k++) {
    const views_array a = {&s->header->fields[k], s->header->fields[k].name};
    char name[512];
    if (!result_field_of_cells(a.field)) continue;
    if (set < 0)
      mesh_views_nothing_name(1, 1, name, sizeof name);
    else
      mesh_views_values_name(a.field, frame, name, sizeof name);
    print_array(s->out, s->file, &a, name, set < 0 ? 1 : s->meshes->sets[set].count);
  }
}

static void print_cells(const sidecar *s) {
  begin_series(s, "cells", (int)strlen("cells"));
  for (long frame = 0; frame < s->frames; frame++) {
    const int set = s->meshes->set_of_frame[frame];
    char name[512];
    mesh_views_set_name(set, name, sizeof name);
    begin_grid(s->out, "frame", s->times[frame]);
    print_set(s, name, &s->meshes->sets[set]);
    print_geometry(s->out, s->file, VIEWS_POINTS, s->header->particle_count);
    print_attributes(s, frame, false);
    print_values(s, frame, set);
    fputs("</Grid>\n", s->out);
  }
  fputs("</Grid>", s->out);
}

/* Those of the nodes, so that all grids have them. */
static void print_nothings(const sidecar *s, long points) {
  for (int k = 0; k < s->array_count; k++) {
    char set[512];
    if (s->arrays[k].field->interaction) continue;
    mesh_views_nothing_name(points, views_components(s->arrays[k].field), set, sizeof set);
    print_array(s->out, s->file, &s->arrays[k], set, points);
  }
}

/* One line through all points. */
static void print_path(const sidecar *s, const mesh_path *p) {
  begin_series(s, p->field->name, mesh_path_name_length(p));
  for (long frame = 0; frame < s->frames; frame++) {
    const long points = mesh_path_count(p, frame);
    char name[512];
    mesh_views_path_name(p, frame, name, sizeof name);
    begin_grid(s->out, "frame", s->times[frame]);
    fprintf(s->out,
            "<Topology TopologyType=\"Polyline\" NodesPerElement=\"%ld\" NumberOfElements=\"1\">"
            "<DataItem Format=\"XML\" NumberType=\"Int\" Dimensions=\"1 %ld\">",
            points, points);
    for (long k = 0; k < points; k++)
      fprintf(s->out, "%s%ld", k ? " " : "", k);
    fputs("</DataItem></Topology>\n", s->out);
    print_geometry(s->out, s->file, name, points);
    print_nothings(s, points);
    print_values(s, frame, -1);
    fputs("</Grid>\n", s->out);
  }
  fputs("</Grid>", s->out);
}

bool xdmf_write(FILE *out, const result_header *h, const mesh_views *m, const double *times,
                long frames) {
  arena *texts = arena_new();
  views_array *arrays = arena_alloc(texts, ((size_t)h->field_count + 1) * sizeof *arrays);
  const sidecar s = {.out = out,
                     .file = base_name(h->path),
                     .header = h,
                     .meshes = m,
                     .times = times,
                     .frames = frames,
                     .arrays = arrays,
                     .array_count = views_arrays(h, arrays, texts)};
  fputs("<?xml version=\"1.0\"?>\n<Xdmf Version=\"3.0\"><Domain>\n", out);
  if (h->mesh_count == 0 || views_bonds(h) > 0) print_bonds(&s, h->mesh_count ? "bonds" : "frames");
  if (h->mesh_count > 0) print_cells(&s);
  for (int k = 0; k < m->path_count; k++)
    print_path(&s, &m->paths[k]);
  fputs("</Domain></Xdmf>\n", out);
  arena_free(texts);
  return fflush(out) == 0 && !ferror(out);
}
