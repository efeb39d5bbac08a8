/* The table of a drive as a result file. */
#ifndef PERILAT_GENERATOR_DRIVE_HDF5_H
#define PERILAT_GENERATOR_DRIVE_HDF5_H

#include "generator/drive/drive_path.h"
#include "generator/drive/drive_table.h"

/* Of two particles: `perilat plot` and `perilat info` read it. False with a message in `error`. */
bool drive_write_hdf5(const drive_input *in, const drive_table *t, const char *path, char *error,
                      size_t size);

#endif
