/* Data sets of a result that is read, whatever they mean. Files may be damaged or made up: nothing
   is believed that a file says of its sizes. */
#ifndef PERILAT_RUNTIME_RESULT_SETS_H
#define PERILAT_RUNTIME_RESULT_SETS_H

#include "runtime/result/hdf5_tools.h"
#include "runtime/result/result_file.h"
#include "runtime/result/result_names.h"

typedef enum named_group { HISTORIES, FIELDS, NAMED_GROUPS } named_group;

struct result_file {
  hid_t file;
  hid_t field; /* the set of frames that was read last, open for the next frame; -1: none */
  char path[1024], field_name[512];
  char trouble[1600];
  result_names known[NAMED_GROUPS]; /* listed when they are first asked for */
  bool listed[NAMED_GROUPS];
  result_names interactions; /* likewise, */
  long *first_bond;          /* [interactions + 1] where theirs begin among all bonds */
};

/* Negative where there is none. Closed by H5Dclose. */
hid_t result_set_open(const result_file *f, const char *name);
/* A history ("/history") or a field ("/frames"), by its full name or a part that says which.
   Negative after a sentence. */
hid_t result_set_named(result_file *f, const char *group, const char *given, char *error,
                       size_t size);
/* Rank and shape of a data set; false when it is not of rank 1 to 3, or too large to be read from
   dimension `from` on. */
bool result_set_shape(hid_t set, int from, int *rank, hsize_t shape[3]);
/* All values, of `width` bytes in memory; malloc'ed. NULL, reported, when it is not of that rank or
   cannot be read. */
void *result_set_read(result_file *f, hid_t set, hid_t type, size_t width, int rank_wanted,
                      hsize_t shape[3]);
/* A set that is there cannot be read: the first is kept for result_trouble. */
void result_set_report(result_file *f, hid_t set);

#endif
