/* Short forms of the HDF5 calls that result files need. All return false (or a negative id) on
   failure; nothing is printed by the library. */
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
bool h5_write_bytes(hid_t file, const char *name, const unsigned char *values, int rank,
                    const hsize_t *shape);
/* A short list of numbers, as it is: chunks would take more room than its numbers. */
bool h5_write_list(hid_t file, const char *name, const int64_t *values, int rank,
                   const hsize_t *shape);
/* Texts are UTF-8 of variable length, which readers take for text, not for bytes. */
bool h5_write_text(hid_t file, const char *name, const char *text);
bool h5_write_texts(hid_t file, const char *name, const char *const *texts, int count);
bool h5_attribute_text(hid_t object, const char *name, const char *text);
bool h5_attribute_double(hid_t object, const char *name, double value);
bool h5_attribute_integer(hid_t object, const char *name, int64_t value);
bool h5_attribute_integers(hid_t object, const char *name, const int64_t *values, int count);
/* ASCII of fixed length, as VTK wants it. */
bool h5_attribute_name(hid_t object, const char *name, const char *text);
/* A data set to be written frame by frame. */
hid_t h5_make_frames(hid_t file, const char *name, int rank, const hsize_t *shape,
                     const char *unit_text);
bool h5_write_frame(hid_t set, long frame, int rank, const hsize_t *shape, const double *values);
/* Dimension scales (H5DS): a data set becomes one, which is attached to a dimension of others. */
typedef struct h5_scale_user {
  hobj_ref_t set;
  unsigned dimension;
} h5_scale_user;

typedef struct h5_scale {
  hid_t set;
  hobj_ref_t reference;
  h5_scale_user *users; /* [count] */
  size_t count, room;
} h5_scale;

/* The set is closed by h5_scale_end, which must be called whatever has come out, and writes the
   list of users: H5DSattach_scale writes it anew each time. */
bool h5_scale_begin(h5_scale *s, hid_t set, const char *name);
/* Of the first of `rank` dimensions. */
bool h5_scale_attach(h5_scale *s, hid_t set, int rank);
bool h5_scale_end(h5_scale *s);

enum { H5_VIEW_RANK = 3 }; /* at most, of a view and of what it shows */
typedef struct h5_block {  /* of a data set of the file */
  const char *set;
  hsize_t start[H5_VIEW_RANK], count[H5_VIEW_RANK];
  /* Where its values go: `rows` rows of the view from `first` on, as many again `every` rows
     further on, and so forth. 0, 0, 0: one after the other, from the first row on. */
  hsize_t first, rows, every;
} h5_block;
/* A virtual data set, which shows blocks without a copy. A table may have more columns than the
   blocks: these are 0. With `gaps` there may be numbers in no block, which are NaN. */
bool h5_make_view(hid_t file, const char *name, int rank, const hsize_t *shape,
                  const h5_block *blocks, int count, bool gaps);

/* Text attribute of fixed or variable length, cut to size; false (and "") when there is none. */
bool h5_read_attribute_text(hid_t object, const char *name, char *text, size_t size);
/* Text of a data set that holds one, fixed or variable; malloc'ed, NULL when it holds something
   else. */
char *h5_read_text(hid_t set);

/* Calls `visit` for each data set, by each of its names. False when a call says so, or when the
   file holds a link that may lead out of it: links that are not hard are not followed. */
bool h5_each_set(hid_t file, bool (*visit)(hid_t set, void *context), void *context);
/* All that the file holds lies in it: no links to elsewhere, no values in other files, virtual data
   sets only of data sets of the file that are not virtual themselves. */
bool h5_stays_inside(hid_t file);
/* Whether the file is the table of a study (`perilat study`), and no result of a run. */
bool h5_is_study_table(hid_t file);

#endif
