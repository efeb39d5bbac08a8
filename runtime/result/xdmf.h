/* The XDMF sidecar of a result, for ParaView: a time series of one grid (views.h); of a run on
   meshes one of the cells and one of each crack. It names whole data sets of at most two dimensions
   and nothing else: of cut or combined ones, and of collections within collections, ParaView's
   first reader (Xdmf3) shows nothing. */
#ifndef PERILAT_RUNTIME_XDMF_H
#define PERILAT_RUNTIME_XDMF_H

#include "runtime/result/mesh_views.h"

/* The text of a sidecar for the frames at `times` of the result `h`. False, with errno, when it
   cannot be written. */
bool xdmf_write(FILE *out, const result_header *h, const mesh_views *m, const double *times,
                long frames);

#endif
