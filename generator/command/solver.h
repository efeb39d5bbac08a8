/* A stand-alone solver: the runtime with a deck, its law and its kernel built in. */
#ifndef PERILAT_GENERATOR_SOLVER_H
#define PERILAT_GENERATOR_SOLVER_H

#include "generator/run/run.h"

/* Its main(). */
int perilat_solver_main(int argc, char **argv, const char *deck_name, const char *deck_text,
                        const built_in_law *laws, int law_count, const built_in_file *files,
                        int file_count);

#endif
