/* Writing the state at the end of a run into its result (result_state.h). */
#ifndef PERILAT_RUNTIME_STATE_WRITE_H
#define PERILAT_RUNTIME_STATE_WRITE_H

#include <hdf5.h>

#include "runtime/result/result_state.h"

bool state_write(hid_t file, const result_state *s);

#endif
