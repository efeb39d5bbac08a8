/* The parts of a run, inside: run.c leads; run_laws.c finds and compiles the laws of a deck, run_result.c writes, run_report.c
   says what is going on, run_document.c what came out, for other programs. */
#ifndef PERILAT_GENERATOR_RUN_PARTS_H
#define PERILAT_GENERATOR_RUN_PARTS_H

#include "generator/run/run.h"
#include "runtime/result/result.h"
#include "runtime/simulation/profile.h"
#include "runtime/simulation/simulation.h"

enum { INPUT_WRONG = 1, RUN_FAILED = 2, ERROR_LENGTH = 1024 };

/* Everything a run holds, so that one function can let go of it. */
typedef struct run {
  const run_options *options;
  arena *memory;
  source_set sources;
  diagnostics said;
  const deck *deck;
  model *models; /* [material_count] */
  int open_models;
  rows *lattice; /* the simulation's, when there is one; NULL where it is not known */
  simulation_law *laws;          /* [lattice_count] */
  const built_in_law **built_in; /* [lattice_count], NULL entries otherwise */
  simulation *simulation;
  result *result;
  char *result_path, *checkpoint_path;
  const char *fingerprint;
  bool is_kept;     /* a checkpoint of this run stands, */
  double kept_time; /* s: of this moment */
  char started[32];
  double *frame_buffer;
  profile profile; /* with --profile */
  /* How it ended: */
  const char *ending; /* "end", "stopped", "interrupted", "failed" */
  int signal;         /* that interrupted it, or 0 */
  double wall;        /* s: of the march */
  bool is_written;    /* the result */
} run;

/* Prints diagnostics, or adds them to the report that the caller has asked for. */
void tell(const run *r, const diagnostics *d);

/* --- run_laws.c --- */

/* Opens and compiles the law of a lattice and reads its parameters; what is wrong with them leaves
   them NULL. 0, or an exit status. What a law's own file has to answer for stays in
   models[].said. */
int load_law(run *r, int lattice);
/* Only says what is wrong with the law's file and its options: of a material whose lattice is not
   known. */
bool check_law_alone(run *r, const deck_material *m);
/* The physics checks with the deck's parameters, on its lattice, which must have been built where
   particles stand on none. */
bool obeys_mechanics(run *r, int lattice);

/* --- run_result.c --- */

void choose_paths(run *r);
/* Errors at the deck's line: a result that cannot be written, or that would replace the deck or a law. */
bool result_can_be_written(run *r);
bool result_spares_inputs(run *r);
/* What a checkpoint belongs to: the program, the kernels and the deck as overridden, a line each. */
void fingerprint(run *r);
/* Takes the result for this run alone; nothing is changed yet. */
bool open_result(run *r);
/* Either comes next. Anew: the checkpoint of an earlier run goes before the frames that it counts
   on. */
bool begin_anew(run *r);
bool resume(run *r);
bool write_frame(run *r);
bool write_checkpoint(run *r);
/* What the run has come to, and what it will exit with. */
typedef struct run_end {
  step_status status;
  int exit_status;
  double seconds;
} run_end;
bool finish_result(run *r, const run_end *end);
/* When what has been written is complete: no checkpoint, no frames beside the result. */
void remove_remains(run *r);
/* A checkpoint stands, and the frames that it counts on. */
bool can_go_on(const run *r);

/* --- run_report.c --- */

/* What is about to be done. */
void announce(const run *r);
/* "t = 4.1 ms"; in quasi-static runs, whose time is only an order, "increment 170 of 480": the run's
   state at a time of the deck, s. */
enum { MOMENT_TEXT = 80 };
const char *moment(const run *r, double time, char text[MOMENT_TEXT]);
/* "t = 25 ms, load 3100 N (peak 11020), cmod 0.12 mm": the first monitors at the last sample. */
void describe_monitors(const run *r, char *text, size_t size);
/* Why and where a run went bad; leaves a path that drives the bond at fault. */
void report_bad(const run *r);
/* The command that goes on from the checkpoint. */
void print_resume(const run *r, FILE *out);
/* What the checkpoint belongs to and this run is not, when that is why it does not fit. */
void print_misfit(const run *r);
/* What came out. */
void conclude(const run *r, double seconds, long steps);
/* Which &stop ended the run early. */
void print_stop(const run *r);
/* "end of the run", "stopped by &stop: load was below 5 % of its peak": how a run ended. */
void describe_end(const run *r, const run_end *end, char *text, size_t size);

/* --- run_document.c --- */

/* How the run ended, as entries of the open object. */
void put_run(json *w, const run *r);

/* --- run_profile.c --- */

/* --profile: where the time of the march went, what a particle's step costs, and what limits it. Takes half a second. */
void print_profile(const run *r, double seconds, long steps);

#endif
