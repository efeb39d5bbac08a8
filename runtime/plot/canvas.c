#include "runtime/plot/canvas.h"

#include <cairo-pdf.h>
#include <cairo-svg.h>
#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "dsl/base/characters.h"
#include "dsl/base/elementary.h"
#include "dsl/base/powers.h"

/* Cairo's own file output takes a full disk for success; this does not. */
static cairo_status_t write_bytes(void *data, const unsigned char *bytes, unsigned int count) {
  canvas *c = data;
  if (fwrite(bytes, 1, count, c->file) == count) return CAIRO_STATUS_SUCCESS;
  c->reason = c->reason ? c->reason : errno;
  return CAIRO_STATUS_WRITE_ERROR;
}

bool canvas_open(canvas *c, const char *path, double width, double height, char *error,
                 size_t size) {
  *c = (canvas){
      .path = path, .width = width, .height = height, .is_png = text_ends_in(path, ".png")};
  const bool is_svg = text_ends_in(path, ".svg");
  if (!c->is_png && !is_svg && !text_ends_in(path, ".pdf")) {
    snprintf(error, size, "a picture's name ends in .png, .svg or .pdf; `%s` does not", path);
    return false;
  }
  c->file = whole_file_open(&c->place, path);
  if (!c->file) {
    snprintf(error, size, "cannot write `%s`: %s", path, strerror(errno));
    return false;
  }
  if (c->is_png)
    c->surface = cairo_image_surface_create(CAIRO_FORMAT_RGB24, (int)width, (int)height);
  else if (is_svg)
    c->surface = cairo_svg_surface_create_for_stream(write_bytes, c, width, height);
  else
    c->surface = cairo_pdf_surface_create_for_stream(write_bytes, c, width, height);
  c->cr = cairo_create(c->surface);
  cairo_set_source_rgb(c->cr, 1, 1, 1);
  cairo_paint(c->cr);
  cairo_select_font_face(c->cr, "sans-serif", CAIRO_FONT_SLANT_NORMAL, CAIRO_FONT_WEIGHT_NORMAL);
  return true;
}

bool canvas_close(canvas *c, char *error, size_t size) {
  cairo_status_t status = cairo_status(c->cr);
  if (status == CAIRO_STATUS_SUCCESS && c->is_png)
    status = cairo_surface_write_to_png_stream(c->surface, write_bytes, c);
  cairo_destroy(c->cr);
  cairo_surface_finish(c->surface);
  if (status == CAIRO_STATUS_SUCCESS) status = cairo_surface_status(c->surface);
  cairo_surface_destroy(c->surface);
  errno = 0;
  bool written = fclose(c->file) == 0 && status == CAIRO_STATUS_SUCCESS && !c->reason;
  if (whole_file_end(&c->place, written)) return true;
  int reason = c->reason ? c->reason : errno;
  snprintf(error, size, "cannot write `%s`: %s", c->path,
           reason ? strerror(reason) : cairo_status_to_string(status));
  return false;
}

void canvas_colour(canvas *c, colour k) {
  cairo_set_source_rgb(c->cr, k.r, k.g, k.b);
}

double canvas_text_width(canvas *c, double size, const char *text) {
  cairo_text_extents_t e;
  cairo_set_font_size(c->cr, size);
  cairo_text_extents(c->cr, text, &e);
  return e.x_advance;
}

void canvas_text(canvas *c, double x, double y, double size, anchor a, const char *text) {
  double width = canvas_text_width(c, size, text);
  cairo_move_to(c->cr, a == ANCHOR_LEFT ? x : a == ANCHOR_CENTRE ? x - width / 2 : x - width, y);
  cairo_show_text(c->cr, text);
}

static void put_within(canvas *c, double x, double y, double size, double width, anchor a,
                       const char *text) {
  char shown[512];
  snprintf(shown, sizeof shown, "%s", text);
  double least = 0.7 * size;
  size = pl_fmax(least,
                 pl_fmin(size, size * width / pl_fmax(canvas_text_width(c, size, shown), 1e-9)));
  for (size_t n = strlen(shown); n > 0 && canvas_text_width(c, size, shown) > width; n--) {
    while (n > 1 && ((unsigned char)shown[n - 1] & 0xC0) == 0x80) /* whole characters of UTF-8 */
      n--;
    snprintf(shown + n - 1, sizeof shown - n + 1, "...");
  }
  canvas_text(c, x, y, size, a, shown);
}

void canvas_text_within(canvas *c, double x, double y, double size, double width,
                        const char *text) {
  put_within(c, x, y, size, width, ANCHOR_LEFT, text);
}

void canvas_text_upward(canvas *c, double x, double y, double size, double length,
                        const char *text) {
  cairo_save(c->cr);
  cairo_translate(c->cr, x, y);
  cairo_rotate(c->cr, -M_PI / 2);
  put_within(c, 0, 0, size, length, ANCHOR_CENTRE, text);
  cairo_restore(c->cr);
}

void canvas_line(canvas *c, double x1, double y1, double x2, double y2, double width) {
  cairo_set_line_width(c->cr, width);
  cairo_move_to(c->cr, x1, y1);
  cairo_line_to(c->cr, x2, y2);
  cairo_stroke(c->cr);
}

double nice_step(double range, int least) {
  double raw = range / least, power = power_of(10, decade_of(raw));
  double lead = raw / power;
  return (lead >= 5 ? 5 : lead >= 2 ? 2 : 1) * power;
}

const char *readable_unit(const char *si_unit, double largest, double *factor) {
  static const struct {
    const char *si, *shown;
    double factor, from; /* used for largest values of at least `from` (SI) */
  } table[] = {{"m", "m", 1, 0.5},
               {"m", "mm", 1e3, 5e-4},
               {"m", "µm", 1e6, 0},
               {"N", "MN", 1e-6, 1e6},
               {"N", "kN", 1e-3, 1e3},
               {"N", "N", 1, 0},
               {"J", "MJ", 1e-6, 1e6},
               {"J", "kJ", 1e-3, 1e3},
               {"J", "J", 1, 0.5},
               {"J", "mJ", 1e3, 5e-4},
               {"J", "µJ", 1e6, 0},
               {"s", "h", 1 / 3600., 3600},
               {"s", "s", 1, 0.5},
               {"s", "ms", 1e3, 5e-4},
               {"s", "µs", 1e6, 0},
               {"Pa", "GPa", 1e-9, 1e9},
               {"Pa", "MPa", 1e-6, 1e5},
               {"Pa", "Pa", 1, 0},
               {"Pa*m^(1/2)", "MPa√m", 1e-6, 1e4},
               {"Pa*sqrt(m)", "MPa√m", 1e-6, 1e4}};
  for (size_t k = 0; k < sizeof table / sizeof *table; k++)
    if (strcmp(table[k].si, si_unit) == 0 && largest >= table[k].from) {
      *factor = table[k].factor;
      return table[k].shown;
    }
  *factor = 1;
  return si_unit;
}
