#include "generator/report/bad_bond.h"

#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "runtime/base/whole_file.h"
#include "runtime/continuum/point_forces.h"
#include "runtime/geometry/gmsh_mesh.h"

void bad_bond_path(const char *result, const bad_state *b, char *path, size_t size) {
  size_t n = strlen(result);
  if (n > 3 && strcmp(result + n - 3, ".h5") == 0) n -= 3;
  snprintf(path, size, "%.*s_bad_%s.nml", (int)n, result, b->point ? "point" : "bond");
}

/* A text of a namelist: quotes are doubled, line ends become blanks. */
static void put_text(const char *text, FILE *out) {
  putc('\'', out);
  for (; *text; text++) {
    if (*text == '\'') putc('\'', out);
    putc((unsigned char)*text < 32 ? ' ' : *text, out);
  }
  putc('\'', out);
}

/* Numbers are written so that they read back to the same bits. */
static void put_value(const char *name, double value, const char *unit_text, FILE *out) {
  if (!isfinite(value))
    fprintf(out, "  ! %s was %g\n", name, value);
  else if (unit_is_pure(unit_text))
    fprintf(out, "  %s = %.17g\n", name, value);
  else
    fprintf(out, "  %s = '%.17g %s'\n", name, value, unit_text);
}

static void put_material(const model *m, const simulation_law *l, FILE *out) {
  char *found = m && m->path ? realpath(m->path, NULL) : NULL;
  fputs("&material\n  model = ", out);
  put_text(found ? found : l->law->name, out);
  putc('\n', out);
  free(found);
  for (int k = 0; m && m->law && k < m->law->options.count; k++)
    fprintf(out, "  %s = '%s'\n", m->law->options.items[k]->name, m->law->chosen[k]);
  for (int p = 0; p < l->law->parameter_count; p++)
    put_value(l->law->parameters[p].name, l->parameters[p], l->law->parameters[p].unit, out);
  fputs("/\n", out);
}

static void put_initial(const pl_law *kernel, const double *fields, int count, FILE *out) {
  if (!fields || count == 0) return;
  fputs("&initial\n", out);
  for (int f = 0; f < count && f < kernel->field_count; f++)
    put_value(kernel->fields[f].name, fields[f], kernel->fields[f].unit, out);
  fputs("/\n", out);
}

static void put_path(const char *quantity, double value, FILE *out) {
  if (isfinite(value))
    fprintf(out, "&path  quantity = '%s'  value = %.17g  /\n", quantity, value);
  else
    fprintf(out, "! the %s was %g\n&path  quantity = '%s'  value = 0  /\n", quantity, value,
            quantity);
}

static void put_title(const char *deck_name, FILE *out) {
  fputs("! perilat drive shows what the law answers there.\n&simulation  title = ", out);
  put_text(deck_name, out);
  fputs("  end_time = 0  steps = 1  /\n", out);
}

static bool write_bond(const char *deck_name, const model *m, const simulation_law *l,
                       const rows *w, const bad_state *b, FILE *out) {
  fprintf(
      out,
      "! The bond between particles %ld and %ld where a run stopped: %s in step %ld, t = %.9g s.\n",
      b->particle, b->bond_particle, b->what, b->step, b->time);
  put_title(deck_name, out);
  fprintf(out, "&bond\n  spacing = %.17g\n  thickness = %.17g\n", w->spacing,
          w->stiffness_thickness);
  if (w->mass > 0 && !w->site_mass) fprintf(out, "  mass_i = %.17g\n", w->mass);
  fputs("/\n", out);
  put_material(m, l, out);
  put_initial(l->law, b->fields, b->field_count, out);
  put_path("stretch", b->stretch, out);
  put_path("stretch_rate", b->stretch_rate, out);
  if (l->law->dof > 2) {
    put_path("theta_i", b->theta_i, out);
    put_path("theta_j", b->theta_j, out);
  }
  return !ferror(out);
}

const char *bad_cell_text(const deck_lattice *of, const int cell[2], char text[BAD_CELL_TEXT]) {
  if (of->gmsh)
    snprintf(text, BAD_CELL_TEXT, "%lld", (long long)of->gmsh->cell_tag[cell[0]]);
  else
    snprintf(text, BAD_CELL_TEXT, "(%d, %d)", cell[0], cell[1]);
  return text;
}

static bool write_point(const char *deck_name, const model *m, const simulation_law *l,
                        const deck_lattice *of, const bad_state *b, FILE *out) {
  static const char *const strain[] = {"strain_xx", "strain_yy", "strain_xy"};
  const point_state *p = b->point;
  char cell[BAD_CELL_TEXT];
  fprintf(out,
          "! The point (%.9g, %.9g) m of cell %s where a run stopped: %s in step %ld, t = "
          "%.9g s.\n",
          p->at[0], p->at[1], bad_cell_text(of, p->cell, cell), b->what, b->step, b->time);
  put_title(deck_name, out);
  fprintf(out, "&point  setting = '%s'  size = %.17g  /\n", of->setting, p->size);
  put_material(m, l, out);
  put_initial(l->law, p->field, l->law->field_count, out);
  for (int k = 0; k < 3; k++)
    put_path(strain[k], p->strain[k], out);
  return !ferror(out);
}

static bool end(whole_file *whole, FILE *out, bool good, const char *path, char *error,
                size_t size) {
  good = out && fclose(out) == 0 && good;
  good = out && whole_file_end(whole, good);
  if (!good) snprintf(error, size, "cannot write `%s`: %s", path, strerror(errno));
  return good;
}

bool bad_bond_write(const char *path, const char *deck_name, const model *m,
                    const simulation_law *l, const rows *w, const bad_state *b, char *error,
                    size_t size) {
  whole_file whole;
  FILE *out = whole_file_open(&whole, path);
  const bool good = out && write_bond(deck_name, m, l, w, b, out);
  return end(&whole, out, good, path, error, size);
}

bool bad_point_write(const char *path, const char *deck_name, const model *m,
                     const simulation_law *l, const deck_lattice *of, const bad_state *b,
                     char *error, size_t size) {
  whole_file whole;
  FILE *out = whole_file_open(&whole, path);
  const bool good = out && write_point(deck_name, m, l, of, b, out);
  return end(&whole, out, good, path, error, size);
}
