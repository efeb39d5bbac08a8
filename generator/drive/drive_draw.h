/* A drive's table as a picture; apart from what else it leaves, so that a solver needs no Cairo. */
#ifndef PERILAT_GENERATOR_DRIVE_DRAW_H
#define PERILAT_GENERATOR_DRIVE_DRAW_H

#include "generator/drive/drive_path.h"
#include "generator/drive/drive_table.h"

/* The columns that the drive's output names, by default force over way. */
bool drive_draw(const drive_input *in, const drive_table *t, const char *path, char *error,
                size_t size);

#endif
