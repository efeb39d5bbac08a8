/* The XDMF sidecar of a result: frames as a time series of particles and of bonds, for ParaView. */
#ifndef PERILAT_RUNTIME_XDMF_H
#define PERILAT_RUNTIME_XDMF_H

#include <sys/types.h>

#include "runtime/result.h"

/* Writes PATH with .h5 replaced by .xdmf, through a temporary name. The times are read from the working file: the first
   value of each record. */
bool xdmf_write(const result_header *h, int working_file, long frames, size_t record, off_t first,
                char *error, size_t size);

#endif
