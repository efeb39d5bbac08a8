/* `perilat run` as the main() of a stand-alone solver. */
#ifndef PERILAT_GENERATOR_COMMAND_RUN_H
#define PERILAT_GENERATOR_COMMAND_RUN_H

#include "generator/run/run.h"

int perilat_solver_main(int argc, char **argv, const char *deck_name, const char *deck_text,
                        const built_in_law *laws, int law_count, const built_in_file *files,
                        int file_count);

#endif
