/* Two tables of one path in one picture; apart from what is said of them, so that a grader draws
   only where it is asked to. */
#ifndef PERILAT_GENERATOR_DIFFERENCE_DRAW_H
#define PERILAT_GENERATOR_DIFFERENCE_DRAW_H

#include <stddef.h>

#include "generator/drive/drive_path.h"
#include "generator/drive/drive_table.h"

/* The columns that the path's output names, by default force over way: the reference's curve below
   the answer's. `labels`: of the answer, of the reference. */
bool difference_draw(const drive_input *in, const drive_table *answer, const drive_table *reference,
                     const char *const labels[2], const char *path, char *error, size_t size);

#endif
