/* Short forms of the HDF5 calls that result files need. All return false (or a negative id) on failure; nothing is
   printed by the library. */
#ifndef PERILAT_RUNTIME_HDF5_TOOLS_H
#define PERILAT_RUNTIME_HDF5_TOOLS_H

#include <hdf5.h>
#include <stdbool.h>
#include <stdint.h>

void h5_quiet(void); /* before anything else */
/* A new file, in the format of HDF5 1.8: every reader knows it, and its descriptions carry checksums, so that damage is
   an error instead of a crash of the reader. */
hid_t h5_create(const char *path);
bool h5_make_group(hid_t file, const char *name); /* true when it is there already */
bool h5_write_doubles(hid_t file, const char *name, const double *values, int rank,
                      const hsize_t *shape, const char *unit_text);
bool h5_write_integers(hid_t file, const char *name, const int32_t *values, int rank,
                       const hsize_t *shape);
/* Texts are UTF-8 of variable length, which readers take for text, not for bytes. */
bool h5_write_text(hid_t file, const char *name, const char *text);
bool h5_attribute_text(hid_t object, const char *name, const char *text);
bool h5_attribute_double(hid_t object, const char *name, double value);
bool h5_attribute_integer(hid_t object, const char *name, int64_t value);
/* Chunked (one frame a chunk), shuffled, compressed data set. */
hid_t h5_make_frames(hid_t file, const char *name, int rank, const hsize_t *shape,
                     const char *unit_text, int level);
bool h5_write_frame(hid_t set, long frame, int rank, const hsize_t *shape, const double *values);
/* Text attribute of fixed or variable length, cut to size; false (and "") when there is none. */
bool h5_read_attribute_text(hid_t object, const char *name, char *text, size_t size);
/* Text of a data set that holds one, fixed or variable; malloc'ed, NULL when it holds something else. */
char *h5_read_text(hid_t set);

/* fsync of a file and then of its folder. */
bool sync_file(const char *path);

#endif
