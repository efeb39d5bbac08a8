/* The table of a drive as text and as comma-separated values. */
#ifndef PERILAT_GENERATOR_DRIVE_WRITE_H
#define PERILAT_GENERATOR_DRIVE_WRITE_H

#include "generator/drive/drive_path.h"
#include "generator/drive/drive_table.h"

/* About in->output.rows rows: both ends, the largest force, the corners of the path, and others
   evenly between. What is wider than the terminal goes on below; of more than a dozen neighbours
   the columns are left out, and said to be. */
void drive_print(const drive_input *in, const drive_table *t, FILE *out);
bool drive_write_csv(const drive_table *t, const char *path, char *error, size_t size);

#endif
