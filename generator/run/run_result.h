/* What a run writes: paths, result, frames, checkpoints. */
#ifndef PERILAT_GENERATOR_RUN_RESULT_H
#define PERILAT_GENERATOR_RUN_RESULT_H

#include "dsl/base/terminal.h"
#include "generator/report/run_state.h"

void choose_paths(run *r);
/* Errors at the deck's line: a result that cannot be written, or that would replace the deck or
   a law. */
bool result_can_be_written(run *r);
bool result_spares_inputs(run *r);
/* What a checkpoint belongs to: the program, the kernels and the deck as overridden, a line
   each. */
void fingerprint(run *r);
/* What a result says of the run's input and particles, but for the fields of its frames. */
result_header describe_result(run *r);
/* Takes the result for this run alone; nothing is changed yet. Of frames as the simulation offers
   them, or as described. */
bool open_result(run *r);
bool open_described(run *r, const result_header *h);
/* Either comes next. Anew: the checkpoint of an earlier run goes before the frames that it counts
   on. */
bool begin_anew(run *r);
bool resume(run *r);
bool write_frame(run *r);
bool write_checkpoint(run *r);
bool finish_result(run *r, const run_end *end, const terminal_record *said);
/* When what has been written is complete: no checkpoint, no frames beside the result. */
void remove_remains(run *r);
/* A checkpoint stands, and the frames that it counts on. */
bool can_go_on(const run *r);

#endif
