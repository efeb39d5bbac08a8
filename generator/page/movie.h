/* The frames of a result as the script of a page draws them: places, bonds, cells, displacements
   and fields, as maps show them (plot_frame.h), in as few bytes as can be seen.

   What is lost: places at the beginning are steps of 1/65535 of the body's extent, displacements
   steps of 1/65535 of what the frame has between its least and its largest, values of fields steps
   of 1/254 of what the field has in all frames. Where all frames would take more room than the page
   has, some are left out, evenly, and fields that find no more room. */
#ifndef PERILAT_GENERATOR_PAGE_MOVIE_H
#define PERILAT_GENERATOR_PAGE_MOVIE_H

#include "generator/page/movie_cells.h"
#include "generator/page/packing.h"
#include "generator/page/page_result.h"

enum { MOVIE_MOST_FIELDS = 12 };
typedef enum movie_place { MOVIE_ON_PARTICLES, MOVIE_ON_BONDS } movie_place;

typedef struct movie_field {
  char name[256], unit[64];
  char field[256];  /* as a map is asked for it, */
  const char *part; /* and which part of a tensor, or NULL */
  movie_place on;
  bool of_damage;
  double low, high;
  packing *steps; /* [frame_count] runs of what differs from the frame before */
} movie_field;

typedef struct movie {
  long *frames; /* [frame_count] of the result */
  long frame_count;
  long particles, bonds;
  int dimensions;
  bool surface;           /* particles of a body in space, from the farthest to the nearest */
  double low[2], high[2]; /* m: of the places at the beginning */
  double spacing, factor; /* factor: with which displacements are seen */
  double axes[3][2];
  packing places, pairs, nodes; /* nodes: runs, 1 where a particle is a node */
  packing *moved;               /* [frame_count] */
  double (*range)[2];           /* [frame_count] m: of these displacements */
  movie_cells cells;
  movie_field fields[MOVIE_MOST_FIELDS]; /* [field_count] */
  int field_count;
  char left_out[1024]; /* names of fields without room, or "" */
  char why[512];       /* without frames to show: a sentence */
} movie;

/* Reads all frames. False where there is nothing to show: m->why says it. To be freed in either
   case. */
bool movie_read(movie *m, const page_result *p);
void movie_free(movie *m);

#endif
