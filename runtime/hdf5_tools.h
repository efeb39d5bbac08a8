/* Short forms of the HDF5 calls that result files need. All return false (or a negative id) on failure; nothing is
   printed by the library. */
#ifndef PERILAT_RUNTIME_HDF5_TOOLS_H
#define PERILAT_RUNTIME_HDF5_TOOLS_H

#include <hdf5.h>
#include <stdbool.h>
#include <stdint.h>

void h5_quiet(void); /* before anything else */
/* A new file, in the format of HDF5 1.8, which every reader knows. */
hid_t h5_create(const char *path);
bool h5_make_group(hid_t file, const char *name); /* true when it is there already */

/* Data sets of numbers lie in chunks of up to half a megabyte, shuffled and compressed, each with a
   sum (Fletcher32) that is checked when it is read. */
bool h5_write_doubles(hid_t file, const char *name, const double *values, int rank,
                      const hsize_t *shape, const char *unit_text);
bool h5_write_integers(hid_t file, const char *name, const int32_t *values, int rank,
                       const hsize_t *shape);
/* Texts are UTF-8 of variable length, which readers take for text, not for bytes. */
bool h5_write_text(hid_t file, const char *name, const char *text);
bool h5_attribute_text(hid_t object, const char *name, const char *text);
bool h5_attribute_double(hid_t object, const char *name, double value);
bool h5_attribute_integer(hid_t object, const char *name, int64_t value);
/* A data set to be written frame by frame. */
hid_t h5_make_frames(hid_t file, const char *name, int rank, const hsize_t *shape,
                     const char *unit_text);
bool h5_write_frame(hid_t set, long frame, int rank, const hsize_t *shape, const double *values);
/* Text attribute of fixed or variable length, cut to size; false (and "") when there is none. */
bool h5_read_attribute_text(hid_t object, const char *name, char *text, size_t size);
/* Text of a data set that holds one, fixed or variable; malloc'ed, NULL when it holds something else. */
char *h5_read_text(hid_t set);

/* Calls `visit` for each data set, by each of its names. False when a call says so, or when the
   file holds a link that may lead out of it: links that are not hard are not followed. */
bool h5_each_set(hid_t file, bool (*visit)(hid_t set, void *context), void *context);
/* All that the file holds lies in it: no links to elsewhere, no values in other files, virtual data
   sets only of data sets of the file that are not virtual themselves. */
bool h5_stays_inside(hid_t file);

#endif
