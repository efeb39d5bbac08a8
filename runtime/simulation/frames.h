/* What is stored in frames, and its values in the order of results: particles of all bodies,
   body by body, bonds of each for themselves, cracks across the lines of monitors. A field of
   particles that a body does not have is NaN there, a damage 0. */
#ifndef PERILAT_RUNTIME_FRAMES_H
#define PERILAT_RUNTIME_FRAMES_H

#include <stdbool.h>
#include <stdint.h>

#include "dsl/base/diagnostics.h"
#include "runtime/deck/deck.h"
#include "runtime/parts/run_body.h"
#include "runtime/simulation/frame_field.h"
#include "runtime/simulation/monitor.h"
#include "runtime/simulation/run_clock.h"

typedef struct frame_set frame_set;

/* False with a diagnostic when the deck asks for fields that no run has. */
bool frames_check(const deck_output *asked, const run_body *bodies, int count, diagnostics *d);
/* What the deck asks for and the run has; `damage` is that of particles and all damages of the
   laws. Bodies, monitors and clock must stay. */
frame_set *frames_new(const deck_output *asked, const run_body *bodies, int count,
                      const monitors *watched, const run_clock *clock);
void frames_free(frame_set *f);

int frames_fields(const frame_set *f, const frame_field **fields);
/* Values of a field in the state observed. */
void frames_values(const frame_set *f, int field, double *values);

#endif
