/* The subcommands of `perilat`. Each gets the arguments after its name and returns the exit status:
   0 done, 1 the input is wrong, 2 the run failed. */
#ifndef PERILAT_GENERATOR_COMMANDS_H
#define PERILAT_GENERATOR_COMMANDS_H

/* X(name, arguments, what it does) */
#define COMMANDS(X)                                                                                \
  X(check, "law.plm | deck.nml [--dump=tree|ir|passes|c] [--diagnostics=json] [--set ...]", "report all errors, run nothing")               \
  X(build, "law.plm [-o law.so] | deck.nml -o solver", "compile a law to a shared kernel, or a deck to a solver")      \
  X(run, "deck.nml [--threads N] [--resume] [--set group.key=value] [--check-kernel] [--interpret]", "run a deck")     \
  X(plot, "result.h5 ... [-o picture] [--x NAME --y NAME | --map FIELD [--frame N] [--factor F]]", "curve or map as PNG, SVG or PDF") \
  X(info, "law.plm | deck.nml | result.h5 | --builtins", "what a file holds")

#define X(name, arguments, purpose) int command_##name(int argc, char **argv);
COMMANDS(X)
#undef X

/* Reads the options of one command. Each call looks at argv[*at]; a match consumes it (and its value) and advances *at.
   `--name value` and `--name=value` are the same. A missing value is reported; *bad is set. */
int option_flag(char **argv, int *at, const char *name);
const char *option_value(int argc, char **argv, int *at, const char *name, int *bad);
/* Says that `given` is no option of `program` ("perilat run"), with the nearest of its options. Returns 1. */
int option_unknown(const char *program, const char *given, const char *const *options, int count);

#endif
