/* What a run is asked for: the deck, laws that are built in, options; and what it may exit
   with. */
#ifndef PERILAT_GENERATOR_RUN_REQUEST_H
#define PERILAT_GENERATOR_RUN_REQUEST_H

#include "dsl/base/diagnostics_json.h"
#include "runtime/deck/deck.h"
#include "runtime/kernel.h"

#define DECK_LIMIT ((size_t)16 << 20) /* B: the longest deck */

/* A law that is already compiled into the program (stand-alone solvers). */
typedef struct built_in_law {
  const char *interaction; /* of the deck, or BUILT_IN_CRACK, that it was built for */
  const char *model;       /* as the deck names it */
  const pl_law *law;
  const char *law_text, *c_text;
  const char *choices; /* "onset=rankine;..." decided when it was built */
  const char *compiler, *flags;
} built_in_law;

/* In place of an interaction's name that of a crack: a format. */
#define BUILT_IN_CRACK "&crack %s"

/* A table that a load of the built-in deck names. */
typedef struct built_in_file {
  const char *path; /* where the deck would find it */
  const char *text;
} built_in_file;

typedef struct run_options {
  const char *program;      /* as it is called: "perilat run", or a solver's name */
  const char *deck_path;    /* file, or the name of the built-in deck */
  const char *deck_text;    /* built-in deck, or NULL: read the file */
  const built_in_law *laws; /* NULL: compile the deck's models */
  int law_count;
  const built_in_file *files; /* of a built-in deck */
  int file_count;
  deck_override *overrides;
  int override_count;
  int threads; /* 0: as the deck or the machine says */
  bool resume;
  bool interpret;     /* no compiler: run on the interpreter */
  bool check_kernel;  /* compare kernel and interpreter on random states first */
  bool check_only;    /* `perilat check deck.nml`: everything but the run */
  int modes;          /* of `check_only`: so many of the lowest modes are told, too */
  const char *shapes; /* NULL, or the result that is written of their shapes */
  bool profile;       /* say at the end where the time went */
  bool json;          /* the command is asked for a document; run_deck looks at `report` */
  double *fraction;   /* NULL, or is told how much of the run is done */
  bool no_physics;    /* leave out the physics checks of the deck's laws */
  diag_json *report; /* NULL, or diagnostics go here: of a check alone; of a run to stderr, too, and
                        how it ended follows them in the document */
} run_options;

/* Exit status: 0 done, 1 the input is wrong, 2 the run failed, 128 + signal (130 by Ctrl-C) when
   it was stopped: what there is has been written then, whole. */
enum { INPUT_WRONG = 1, RUN_FAILED = 2 };

#endif
