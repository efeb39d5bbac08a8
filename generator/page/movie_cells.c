#include "generator/page/movie_cells.h"

#include <stdlib.h>
#include <string.h>

#include "dsl/base/arena.h"

enum { CORNERS = 4, PARTS = 3 };

static packing *packings(long frames) {
  return must_calloc((size_t)frames + 1, sizeof(packing));
}

void movie_cells_begin(movie_cells *m, const plot_meshes *meshes, long frames) {
  long count = 0;
  for (int n = 0; n < meshes->count; n++)
    count += meshes->items[n].all_count;
  *m = (movie_cells){.count = count,
                     .frames = frames,
                     .alive = packings(frames),
                     .parts = packings(frames),
                     .faces = packings(frames)};
  m->corners = must_calloc(CORNERS * (size_t)count + 1, sizeof *m->corners);
  int32_t *to = m->corners;
  for (int n = 0; n < meshes->count; n++) {
    const size_t all = CORNERS * (size_t)meshes->items[n].all_count;
    memcpy(to, meshes->items[n].cells, all * sizeof *to);
    to += all;
  }
  for (long k = 0; k < CORNERS * count; k++)
    packing_whole(&m->listed, m->corners[k] - (k ? m->corners[k - 1] : 0));
}

/* --- cells ------------------------------------------------------------------------------------ */

typedef struct part_list { /* of one cell that is cut */
  double at[PARTS * PARTS][CORNERS][2], share[PARTS * PARTS];
  int count;
} part_list;

static void take_part(void *context, const double at[4][2], const double value[4]) {
  part_list *l = context;
  memcpy(l->at[l->count], at, sizeof l->at[0]);
  l->share[l->count++] = value[0] + value[1] + value[2] + value[3];
}

static part_list parts_of(const plot_mesh *m, long cell, const mesh_view *v) {
  plot_mesh one = *m;
  part_list l = {.count = 0};
  one.cells = m->cells + CORNERS * cell;
  one.cell_count = 1;
  plot_mesh_parts(&one, v, 1, PARTS, take_part, &l);
  return l;
}

/* Of each part the corner of the cell that it goes with most. */
static void find_owners(const plot_mesh *m, long cell, const plot_frame *f, double *marks,
                        int32_t owner[PARTS * PARTS]) {
  const mesh_view v = {.reference = f->reference, .moved = f->reference, .values = marks};
  double most[PARTS * PARTS] = {0};
  for (int k = 0; k < CORNERS; k++) {
    const int32_t node = m->cells[CORNERS * cell + k];
    marks[node] = 1;
    const part_list l = parts_of(m, cell, &v);
    for (int n = 0; n < l.count; n++)
      if (k == 0 || l.share[n] > most[n]) {
        most[n] = l.share[n];
        owner[n] = node;
      }
    marks[node] = 0;
  }
}

typedef struct bounds {
  const double *low, *high, *range;
} bounds;

static void pack_cut(packing *to, const plot_mesh *m, long cell, const plot_frame *f,
                     const double *moved, double *marks, const bounds *b) {
  int32_t owner[PARTS * PARTS];
  const mesh_view begun = {.reference = f->reference, .moved = f->reference},
                  now = {.reference = f->reference, .moved = moved};
  const part_list at = parts_of(m, cell, &begun), then = parts_of(m, cell, &now);
  find_owners(m, cell, f, marks, owner);
  for (int n = 0; n < at.count; n++) {
    packing_whole(to, owner[n]);
    for (int k = 0; k < CORNERS; k++)
      for (int c = 0; c < 2; c++) {
        const double u = then.at[n][k][c] - at.at[n][k][c];
        packing_steps(to, &at.at[n][k][c], 1, b->low[c], b->high[c]);
        packing_steps(to, &u, 1, b->range[0], b->range[1]);
      }
  }
}

/* Cells that have died are missing from those of the frame, which are in the same order. */
static void take_mesh(movie_cells *m, long k, const plot_mesh *mesh, const plot_frame *f,
                      const double *moved, double *marks, const bounds *b, const int32_t *corners,
                      unsigned char *alive) {
  const mesh_view v = {.reference = f->reference, .moved = moved};
  const size_t size = CORNERS * sizeof *corners;
  for (long c = 0, n = 0; c < mesh->all_count && n < mesh->cell_count; c++) {
    if (memcmp(corners + CORNERS * c, mesh->cells + CORNERS * n, size) != 0) continue;
    const bool cut = plot_mesh_is_cut(mesh, &v, n);
    alive[c] = cut ? 2 : 1;
    if (cut) pack_cut(&m->parts[k], mesh, n, f, moved, marks, b);
    n++;
  }
}

/* --- cracks ----------------------------------------------------------------------------------- */

typedef struct face_points {
  double *places; /* [count][2] m */
  long count, room;
} face_points;

static void take_point(void *context, const double moved[2]) {
  face_points *p = context;
  if (p->count == p->room) {
    p->room = p->room ? 2 * p->room : 64;
    p->places = must_realloc(p->places, 2 * (size_t)p->room * sizeof *p->places);
  }
  memcpy(p->places + 2 * p->count++, moved, 2 * sizeof *moved);
}

static void pack_face(packing *to, const plot_mesh *m, const plot_crack *crack, const plot_frame *f,
                      const double *moved, double side) {
  const mesh_view begun = {.reference = f->reference, .moved = f->reference},
                  now = {.reference = f->reference, .moved = moved};
  face_points at = {.count = 0}, then = {.count = 0};
  if (crack->count < 2 || !(m->size > 0)) return;
  plot_mesh_crack_face(m, &begun, crack, 0, crack->count - 1, side, take_point, &at);
  plot_mesh_crack_face(m, &now, crack, 0, crack->count - 1, side, take_point, &then);
  packing_whole(to, at.count);
  for (long k = 0; k < at.count; k++) {
    const double u[2] = {then.places[2 * k] - at.places[2 * k],
                         then.places[2 * k + 1] - at.places[2 * k + 1]};
    packing_floats(to, at.places + 2 * k, 2);
    packing_floats(to, u, 2);
  }
  free(at.places);
  free(then.places);
}

static void take_cracks(packing *to, const plot_frame *f, const double *moved) {
  const plot_meshes *all = &f->meshes;
  for (int n = 0; n < all->crack_count; n++)
    for (int k = 0; k < all->count; k++)
      if (strcmp(all->items[k].name, all->cracks[n].mesh) == 0)
        for (int side = 1; side >= -1; side -= 2)
          pack_face(to, &all->items[k], &all->cracks[n], f, moved, side);
}

/* --- a frame ---------------------------------------------------------------------------------- */

void movie_cells_take(movie_cells *m, long k, const plot_frame *f, const double *u,
                      const double low[2], const double high[2], const double range[2]) {
  if (m->count == 0) return;
  const bounds b = {low, high, range};
  double *moved = must_calloc(2 * (size_t)f->particles + 1, sizeof *moved),
         *marks = must_calloc((size_t)f->particles + 1, sizeof *marks);
  unsigned char *alive = must_calloc((size_t)m->count + 1, 1);
  for (long n = 0; n < 2 * f->particles; n++)
    moved[n] = f->reference[n] + u[n];
  long first = 0;
  for (int n = 0; n < f->meshes.count; n++) {
    take_mesh(m, k, &f->meshes.items[n], f, moved, marks, &b, m->corners + CORNERS * first,
              alive + first);
    first += f->meshes.items[n].all_count;
  }
  packing_runs(&m->alive[k], alive, NULL, m->count);
  take_cracks(&m->faces[k], f, moved);
  free(moved);
  free(marks);
  free(alive);
}

void movie_cells_free(movie_cells *m) {
  for (long k = 0; k < m->frames; k++) {
    packing_free(&m->alive[k]);
    packing_free(&m->parts[k]);
    packing_free(&m->faces[k]);
  }
  packing_free(&m->listed);
  free(m->corners);
  free(m->alive);
  free(m->parts);
  free(m->faces);
}
