#include "runtime/xdmf.h"

#include <string.h>

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

/* A frame's slab of a data set [F, count(, components)]. `first` and `width` choose components. */
static void print_slab(FILE *out, const char *file, const char *set, long frames, long frame,
                       const result_field *f, int first, int width) {
  bool flat = f->interaction != NULL;
  fprintf(out, "<DataItem ItemType=\"HyperSlab\" Dimensions=\"%ld", f->count);
  if (!flat && width > 1) fprintf(out, " %d", width);
  fputs("\" Type=\"HyperSlab\">", out);
  if (flat)
    fprintf(out, "<DataItem Dimensions=\"3 2\" Format=\"XML\">%ld 0 1 1 1 %ld</DataItem>", frame,
            f->count);
  else
    fprintf(out, "<DataItem Dimensions=\"3 3\" Format=\"XML\">%ld 0 %d 1 1 1 1 %ld %d</DataItem>",
            frame, first, f->count, width);
  fprintf(out, "<DataItem Format=\"HDF\" NumberType=\"Float\" Precision=\"8\" Dimensions=\"%ld %ld",
          frames, f->count);
  if (!flat) fprintf(out, " %d", f->components);
  fputs("\">", out);
  print_place(out, file, set);
  fputs("</DataItem></DataItem>\n", out);
}

static void print_attribute(FILE *out, const char *file, long frames, long frame,
                            const result_field *f) {
  char set[512];
  const char *centre = f->interaction ? "Cell" : "Node";
  if (f->interaction)
    snprintf(set, sizeof set, "/frames/%s/%s", f->interaction, f->name);
  else
    snprintf(set, sizeof set, "/frames/%s", f->name);
  fprintf(out, "<Attribute Name=\"%s\" AttributeType=\"%s\" Center=\"%s\">", f->name,
          f->components == 1 ? "Scalar" : "Vector", centre);
  if (f->components != 2) {
    print_slab(out, file, set, frames, frame, f, 0, f->components);
  } else { /* vectors have three components there */
    fprintf(
        out,
        "<DataItem ItemType=\"Function\" Function=\"JOIN($0, $1, 0*$0)\" Dimensions=\"%ld 3\">\n",
        f->count);
    print_slab(out, file, set, frames, frame, f, 0, 1);
    print_slab(out, file, set, frames, frame, f, 1, 1);
    fputs("</DataItem>", out);
  }
  fputs("</Attribute>\n", out);
}

static void print_geometry(FILE *out, const char *file, const result_header *h) {
  fprintf(
      out,
      "<Geometry GeometryType=\"%s\"><DataItem Format=\"HDF\" NumberType=\"Float\" Precision=\"8\" "
      "Dimensions=\"%ld %d\">",
      h->dimensions == 2 ? "XY" : "XYZ", h->particle_count, h->dimensions);
  print_place(out, file, "/particles/reference");
  fputs("</DataItem></Geometry>\n", out);
}

static void print_frame(FILE *out, const char *file, const result_header *h, long frames,
                        long frame, double time) {
  fprintf(out,
          "<Grid Name=\"frame %ld\" GridType=\"Collection\" CollectionType=\"Spatial\"><Time "
          "Value=\"%.17g\"/>\n",
          frame, time);
  fprintf(out,
          "<Grid Name=\"particles\"><Topology TopologyType=\"Polyvertex\" NodesPerElement=\"1\" "
          "NumberOfElements=\"%ld\"/>\n",
          h->particle_count);
  print_geometry(out, file, h);
  for (int k = 0; k < h->field_count; k++)
    if (!h->fields[k].interaction) print_attribute(out, file, frames, frame, &h->fields[k]);
  fprintf(out,
          "</Grid>\n<Grid Name=\"bonds\"><Topology TopologyType=\"Polyline\" NodesPerElement=\"2\" "
          "NumberOfElements=\"%ld\"><DataItem Format=\"HDF\" NumberType=\"Int\" Precision=\"4\" "
          "Dimensions=\"%ld 2\">",
          h->bond_count, h->bond_count);
  print_place(out, file, "/bonds/");
  print_text(out, h->interaction);
  fputs("</DataItem></Topology>\n", out);
  print_geometry(out, file, h);
  for (int k = 0; k < h->field_count; k++)
    if (h->fields[k].interaction || strcmp(h->fields[k].name, "displacement") == 0)
      print_attribute(out, file, frames, frame, &h->fields[k]);
  fputs("</Grid></Grid>\n", out);
}

bool xdmf_write(FILE *out, const result_header *h, const double *times, long frames) {
  fputs("<?xml version=\"1.0\"?>\n<Xdmf Version=\"2.0\"><Domain>\n"
        "<Grid Name=\"frames\" GridType=\"Collection\" CollectionType=\"Temporal\">\n",
        out);
  for (long frame = 0; frame < frames; frame++)
    print_frame(out, base_name(h->path), h, frames, frame, times[frame]);
  fputs("</Grid></Domain></Xdmf>\n", out);
  return fflush(out) == 0 && !ferror(out);
}
