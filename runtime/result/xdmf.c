#include "runtime/result/xdmf.h"

#include <string.h>

#include "runtime/result/views.h"

/* The sidecar names the HDF5 file without its folder: both move together. */
static const char *base_name(const char *path) {
  const char *slash = strrchr(path, '/');
  return slash ? slash + 1 : path;
}

/* Names of lattices and files may hold characters that mean something in XML. */
static void print_text(FILE *out, const char *text) {
  for (; *text; text++)
    switch (*text) {
    case '&':
      fputs("&amp;", out);
      break;
    case '<':
      fputs("&lt;", out);
      break;
    case '>':
      fputs("&gt;", out);
      break;
    case '"':
      fputs("&quot;", out);
      break;
    default:
      fputc(*text, out);
    }
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

static void print_attribute(FILE *out, const char *file, const result_header *h, long frame,
                            const views_array *a) {
  char set[512];
  const int components = views_components(a->field);
  views_frame_name(a, frame, set, sizeof set);
  fprintf(out, "<Attribute Name=\"%s\" AttributeType=\"%s\" Center=\"%s\">", a->name,
          components == 1 ? "Scalar" : "Vector", a->field->interaction ? "Cell" : "Node");
  print_item(out, file, set, "Float", 8, views_count(h, a->field), components);
  fputs("</Attribute>\n", out);
}

static long bonds_of(const result_header *h) {
  return views_count(h, &(result_field){.interaction = ""});
}

static void print_frame(FILE *out, const char *file, const result_header *h,
                        const views_array *arrays, int count, long frame, double time) {
  fprintf(out,
          "<Grid Name=\"frame\" GridType=\"Uniform\"><Time Value=\"%.17g\"/>\n"
          "<Topology TopologyType=\"Polyline\" NodesPerElement=\"2\" NumberOfElements=\"%ld\">",
          time, bonds_of(h));
  print_item(out, file, VIEWS_CONNECTIVITY, "Int", 4, bonds_of(h), 2);
  fputs("</Topology>\n<Geometry GeometryType=\"XYZ\">", out);
  print_item(out, file, VIEWS_POINTS, "Float", 8, h->particle_count, 3);
  fputs("</Geometry>\n", out);
  for (int k = 0; k < count; k++)
    print_attribute(out, file, h, frame, &arrays[k]);
  fputs("</Grid>\n", out);
}

bool xdmf_write(FILE *out, const result_header *h, const double *times, long frames) {
  arena *texts = arena_new();
  views_array *arrays = arena_alloc(texts, ((size_t)h->field_count + 1) * sizeof *arrays);
  const int count = views_arrays(h, arrays, texts);
  fputs("<?xml version=\"1.0\"?>\n<Xdmf Version=\"3.0\"><Domain>\n"
        "<Grid Name=\"frames\" GridType=\"Collection\" CollectionType=\"Temporal\">\n",
        out);
  for (long frame = 0; frame < frames; frame++)
    print_frame(out, base_name(h->path), h, arrays, count, frame, times[frame]);
  fputs("</Grid></Domain></Xdmf>\n", out);
  arena_free(texts);
  return fflush(out) == 0 && !ferror(out);
}
