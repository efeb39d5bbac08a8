/* The seal of an HDF5 file: its attribute `seal` is a SHA-256 of the whole file, names, types,
   shapes, attributes, layouts and values as they are stored. It is looked at before the library
   reads anything, so that damage is found, not followed. The insides of large chunks are left out:
   for them stand their sums (Fletcher32), which the library checks when it reads the values. What
   is left out is told behind the end of what HDF5 reads (and cuts off when it opens the file for
   writing):

     [count] pairs of places from, to, ascending: bytes that the seal leaves out, itself among them
     place of the seal, count, "perilat seal 1" in 16 bytes; numbers of 8 bytes, lowest first  */
#ifndef PERILAT_RUNTIME_SEALED_FILE_H
#define PERILAT_RUNTIME_SEALED_FILE_H

#include <hdf5.h>
#include <stdbool.h>

/* A new file with room for its seal (h5_create); negative on failure. */
hid_t sealed_file_create(const char *path);
/* Closes the file and seals it. False, with errno or 0, when that fails; closed it is, too. */
bool sealed_file_close(hid_t file, const char *path);
/* Seals a file anew whose bytes have changed, not their number. For tests. */
bool sealed_file_renew(int file);

typedef enum seal_state { SEAL_NONE, SEAL_WHOLE, SEAL_BROKEN } seal_state;
/* `file` is open for reading. A file without an end as above has no seal; when it is marked as
   sealed all the same, by the attribute, its end has been lost. */
seal_state sealed_file_state(int file);
bool sealed_file_is_marked(hid_t file);

#endif
