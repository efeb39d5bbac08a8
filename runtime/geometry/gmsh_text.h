/* The text of a Gmsh file, version 4 in ASCII: its sections as they stand there, with the place of
   each thing for messages. gmsh_mesh.h makes a mesh of them.

     $MeshFormat     4.1 0 8                     version, 0: ASCII
     $PhysicalNames  1 2 "right"                 dimension, tag, name of a group
     $Entities       points, curves, surfaces: which groups they belong to
     $Nodes          by entities: tags, places
     $Elements       by entities: type, tags of nodes                                             */
#ifndef PERILAT_RUNTIME_GMSH_TEXT_H
#define PERILAT_RUNTIME_GMSH_TEXT_H

#include <stdint.h>

#include "runtime/base/file_text.h"
#include "runtime/geometry/element.h"

enum { GMSH_MOST_GROUPS = 1000 };

typedef struct gmsh_name { /* of a physical group */
  int dimension;
  int64_t tag;
  char *name;
  uint32_t at; /* in the text, as below */
} gmsh_name;

typedef struct gmsh_entity {
  int dimension;
  int64_t tag;
  int first_group, group_count; /* among the tags of groups */
} gmsh_entity;

typedef struct gmsh_node {
  int64_t tag;
  double at[3]; /* m */
  uint32_t where;
} gmsh_node;

typedef struct gmsh_element {
  unsigned char dimension, nodes;   /* 0: 1 node; 1: 2, 3; 2: 3, 4, 6 */
  int64_t entity;                   /* tag */
  int64_t node[ELEMENT_MOST_NODES]; /* tags */
  int64_t tag;
  uint32_t where;
} gmsh_element;

typedef struct gmsh_text {
  file_text file;
  bool one; /* version 4.1, not 4.0 */
  gmsh_name *names;
  gmsh_entity *entities;
  int64_t *groups; /* tags; a surface on whose other side the group is has a negative one */
  gmsh_node *nodes;
  gmsh_element *elements;
  int name_count, entity_count, group_count, node_count, element_count;
} gmsh_text;

/* Takes over `path` (malloc'ed); a source of that name stands for the file. `unit`: m, of places.
   False after a message, at `where` for what concerns the file as a whole. To be freed in either
   case. */
bool gmsh_text_read(gmsh_text *t, char *path, double unit, span where, diagnostics *d);
void gmsh_text_free(gmsh_text *t);

#endif
