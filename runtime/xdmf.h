/* The XDMF sidecar of a result: frames as a time series of particles and of bonds, for ParaView. */
#ifndef PERILAT_RUNTIME_XDMF_H
#define PERILAT_RUNTIME_XDMF_H

#include "runtime/result.h"

/* The text of a sidecar for the frames at `times` of the result `h`. False, with errno, when it
   cannot be written. */
bool xdmf_write(FILE *out, const result_header *h, const double *times, long frames);

#endif
