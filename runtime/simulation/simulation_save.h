/* All that a later step depends on, as a checkpoint. */
#ifndef PERILAT_RUNTIME_SIMULATION_SAVE_H
#define PERILAT_RUNTIME_SIMULATION_SAVE_H

#include "runtime/simulation/simulation.h"

C_LINKAGE_BEGIN

/* As a checkpoint file (checkpoint.h). Restore is into a
   simulation made from the same deck and laws; false with a sentence, and the state untouched, when
   the file does not fit. `fingerprint` names deck, laws and kernel; `frames` tells of the caller's
   frames. */
bool simulation_save(const simulation *s, const char *path, const char *fingerprint,
                     const frame_mark *frames, char *error, size_t size);
bool simulation_restore(simulation *s, const char *path, const char *fingerprint,
                        frame_mark *frames, char *error, size_t size);

C_LINKAGE_END

#endif
