/* The subcommands of `perilat`. Each gets the arguments after its name and returns the exit status:
   0 done, 1 the input is wrong, 2 the run failed. */
#ifndef PERILAT_GENERATOR_COMMANDS_H
#define PERILAT_GENERATOR_COMMANDS_H

#include <stdbool.h>
#include <stdio.h>

#include "runtime/deck/lattice_kind.h"

#define COMMAND_STATUS "0 done, 1 the input is wrong, 2 the run failed"
#define RUN_STATUS                                                                                 \
  COMMAND_STATUS ", 130 stopped by Ctrl-C, 143 by SIGTERM, 129 by SIGHUP: with the result so far " \
                 "and a checkpoint"
#define STUDY_STATUS                                                                               \
  "0 done, 1 the input is wrong, 2 a run failed or there is no answer, 130 stopped by Ctrl-C, "    \
  "143 by SIGTERM, 129 by SIGHUP: the same command goes on"
#define DRIVE_STATUS                                                                               \
  "0 all expectations hold, 1 the input is wrong, 2 an expectation fails, the law gives no "       \
  "number or differs from the one of --against"
#define GRADE_STATUS                                                                               \
  "0 all points that are not given by hand, 1 the exercise or the command is wrong, 2 less"
/* X(name, files, endings, what it does, exit status): `endings` are those of the files that
   shells offer, blanks between. */
#define COMMANDS(X)                                                                                \
  X(new, "NAME", "",                                                                               \
    "a commented law to start from, its drive path and the deck of a small specimen",              \
    COMMAND_STATUS)                                                                                \
  X(check, "law.plm | deck.nml | path.nml | -", "plm nml", "report all errors, run nothing",       \
    COMMAND_STATUS)                                                                                \
  X(build, "law.plm | deck.nml", "plm nml",                                                        \
    "compile a law to a shared kernel, or a deck to a solver", COMMAND_STATUS)                     \
  X(run, "deck.nml", "nml", "run a deck", RUN_STATUS)                                              \
  X(study, "deck.nml ...", "nml",                                                                  \
    "many runs: values crossed, strength, convergence, parameters that fit a curve", STUDY_STATUS) \
  X(drive, "[law.plm] path.nml", "plm nml",                                                        \
    "one bond, particle or point along a path: table, picture, expectations", DRIVE_STATUS)        \
  X(grade, "EXERCISE [answer.plm | CLASS]", "plm txt", "answers to an exercise, marked in words",  \
    GRADE_STATUS)                                                                                  \
  X(plot, "result.h5 ...", "h5 hdf5",                                                              \
    "curves, or a map of particles or bonds, as PNG, SVG or PDF", COMMAND_STATUS)                  \
  X(report, "result.h5 [other.h5] | study.h5", "h5 hdf5",                                          \
    "a run, two runs or a study as one page of HTML, to be looked at and sent", COMMAND_STATUS)    \
  X(compare, "a.h5 b.h5 | lab.csv", "h5 hdf5 csv",                                                 \
    "where two results, or a result and a table, differ most",                                     \
    "0 the same, 1 an input is wrong, 2 different")                                                \
  X(export, "result.h5", "h5 hdf5", "histories, a frame or cracks as comma-separated values",      \
    COMMAND_STATUS)                                                                                \
  X(info, "law.plm | deck.nml | result.h5 | -", "plm nml h5 hdf5",                                 \
    "what a law implies, what a file holds", COMMAND_STATUS)                                       \
  X(explain, "law.plm | -", "plm", "a law as equations with a table of its symbols",               \
    COMMAND_STATUS)                                                                                \
  X(format, "law.plm ... | -", "plm", "lay out laws",                                              \
    "0 done, 1 the input is wrong; with --check also when a file would change")                    \
  X(help, "TOPIC ...", "",                                                                         \
    "what a message's code, a word of the language, a deck group or a command means",              \
    COMMAND_STATUS)

/* Every option: X(command, option, value, meaning). A value is "" for none, FILE where shells
   offer files, a|b|c for one of these words, else what it stands for. Texts of --help,
   suggestions, manual and completion. */
#define OPTIONS_OF_SOLVERS(X, command)                                                             \
  X(command, "--threads", "N", "number of threads; the results are the same for any number")       \
  X(command, "--resume", "", "go on from the checkpoint that a stopped run left")                  \
  X(command, "--profile", "", "say at the end where the time of the run went and what limits it")  \
  X(command, "--json", "", "how the run ended, as one JSON document on the standard output")       \
  X(command, "--set", "group.key=value",                                                           \
    "set a value of the deck, `group.key=` its default; may be given several times")
#define COMMAND_OPTIONS(X)                                                                         \
  X(new, "--kind", "central|micropolar|state|continuum|crack",                                     \
    "bonds whose ends can turn (micropolar) or not (central, the default), families of bonds "     \
    "(state), a solid, or cracks")                                                                 \
  X(check, "--dump", "tree|ir|passes|c",                                                           \
    "show what becomes of a law, or of a deck's on its lattice, at this stage")                    \
  X(check, "--diagnostics", "text|json",                                                           \
    "the form of messages; json is one document on the standard output")                           \
  X(check, "--no-physics", "", "leave out the checks of mechanics")                                \
  X(check, "--set", "key=value",                                                                   \
    "set group.key of a deck or a path, or a parameter or an option of a law; may be given "       \
    "several times")                                                                               \
  X(build, "-o", "FILE",                                                                           \
    "name of the kernel (of a law, otherwise NAME.so) or of the solver (of a deck)")               \
  X(build, "--for", "WORDS",                                                                       \
    "what the kernel of a law is for, words of its line `for`: a setting, irregular, or both "     \
    "(space,irregular); its first setting if not given")                                           \
  X(build, "--no-physics", "", "leave out the checks of mechanics")                                \
  OPTIONS_OF_SOLVERS(X, run)                                                                       \
  X(run, "--check-kernel", "", "compare the compiled kernel with the interpreter first")           \
  X(run, "--interpret", "",                                                                        \
    "run on the interpreter: no C compiler, many times slower, the same results")                  \
  X(run, "--no-physics", "", "leave out the checks of mechanics")                                  \
  X(study, "--vary", "group.key=v1,v2,...",                                                        \
    "run all of these values; several are crossed; from..to:step counts, and semicolons part "     \
    "values that have commas")                                                                     \
  X(study, "--with", "group.key=w1,w2,...",                                                        \
    "a key that changes together with the --vary before it")                                       \
  X(study, "--set", "group.key=value", "set a value of the deck in all runs")                      \
  X(study, "--jobs", "N", "runs at the same time; as many as there are processors if not given")   \
  X(study, "--threads", "N", "of all runs together")                                               \
  X(study, "--x", "NAME", "history along x of the curves (time)")                                  \
  X(study, "--y", "NAME", "history whose curves are drawn and whose peaks count (load)")           \
  X(study, "--converge", "group.key",                                                              \
    "where the answer goes as this varied value goes to 0, with order and error bar")              \
  X(study, "--of", "peak|last", "the answer of --converge: the peak of --y, or its last value")    \
  X(study, "--strength", "group.key=from..to:step",                                                \
    "which values of a load that is held are borne; the key alone: around the deck's value")       \
  X(study, "--watch", "NAME",                                                                      \
    "the monitor that must not grow while the load is held (deflection)")                          \
  X(study, "--twin", "FILE",                                                                       \
    "of --strength: a deck of the same body that is moved; its peak is told beside")               \
  X(study, "--fit", "group.key=low..high", "a parameter that is sought between bounds")            \
  X(study, "--to", "lab.csv", "measured curve that it is fitted to, one for each deck")            \
  X(study, "--weight", "W", "of a curve, one for each --to (1)")                                   \
  X(study, "--search", "bobyqa|nelder-mead", "how parameters are sought")                          \
  X(study, "--runs", "N", "the most points that the search tries (200)")                           \
  X(study, "-o", "NAME",                                                                           \
    "folder of the results, and with endings table and picture; DECK_study if not given")          \
  X(study, "--no-physics", "", "leave out the checks of mechanics")                                \
  X(study, "--json", "", "what came out, as one JSON document on the standard output")             \
  X(drive, "--set", "key=value",                                                                   \
    "set a parameter or an option of the law, or group.key of the path; may be given several "     \
    "times")                                                                                       \
  X(drive, "--compiled", "", "drive the compiled kernel, not the interpreter")                     \
  X(drive, "--confined", "",                                                                       \
    "read and write in the path's folder alone, and read the models that come along")              \
  X(drive, "--csv", "FILE", "write the table as comma-separated values")                           \
  X(drive, "--hdf5", "FILE", "write the table as a result")                                        \
  X(drive, "--picture", "FILE", "draw the curve: PNG, SVG or PDF by the name's ending")            \
  X(drive, "--against", "reference.plm",                                                           \
    "drive this law, too, and say in words how the two differ; with --picture both curves")        \
  X(drive, "--tolerance", "R", "of --against: the relative difference that counts as none (1e-6)") \
  X(drive, "--json", "", "what came out, as one JSON document on the standard output")             \
  X(grade, "--public", "", "only what can be judged without the teacher's folder")                 \
  X(grade, "--self-test", "",                                                                      \
    "put the exercise to the test: solution and equal forms get all points, every known wrong "    \
    "law loses some, no two look alike, every case is reached")                                    \
  X(grade, "--publish", "FOLDER", "write what students get: nothing that is hidden")               \
  X(grade, "--csv", "FILE", "a row an answer, a column an item")                                   \
  X(grade, "--junit", "FILE", "as test results for continuous integration")                        \
  X(grade, "--html", "FILE", "as a page, with both curves of public paths")                        \
  X(grade, "--json", "", "as one JSON document on the standard output")                            \
  X(grade, "--seed", "N", "other random numbers than the exercise's own")                          \
  X(grade, "--time", "'20 s'", "processor time that an answer may take (20 s)")                    \
  X(grade, "--memory", "2GB", "memory that an answer may take (2GB)")                              \
  X(plot, "-o", "FILE",                                                                            \
    "the picture: PNG, SVG or PDF by the name's ending (RESULT_HISTORY.png, RESULT_FIELD.png)")    \
  X(plot, "--title", "TEXT", "title of the picture")                                               \
  X(plot, "--x", "NAME", "history along x; of a study's table (NAME.h5) a key that was varied")    \
  X(plot, "--y", "NAME",                                                                           \
    "history along y; several give several curves; of a study's table a column")                   \
  X(plot, "--x-unit", "UNIT", "unit along x")                                                      \
  X(plot, "--y-unit", "UNIT", "unit along y")                                                      \
  X(plot, "--label", "TEXT", "name of a result's curve, one for each result")                      \
  X(plot, "--data", "lab.csv",                                                                     \
    "points of a table: columns named as the histories, or lab.csv:X,Y; may be given several "     \
    "times")                                                                                       \
  X(plot, "--band", "LOW,HIGH",                                                                    \
    "a band between two columns of the --data before it, or two values, e.g. '4 kN,5 kN'")         \
  X(plot, "--line", "VALUE",                                                                       \
    "a line at a value, e.g. '58.88 kN' or 'f_t A = 58.88 kN'; may be given several times")        \
  X(plot, "--map", "FIELD",                                                                        \
    "a map of this field of particles or bonds instead of curves, or of two damages, A,B")         \
  X(plot, "--cracks", "",                                                                          \
    "paths of the cracks of meshes, of one or several results in one picture, with --label")       \
  X(plot, "--frame", "N", "frame of the map, from 0; -1 is the last (default)")                    \
  X(plot, "--frames", "LIST",                                                                      \
    "several frames in one picture: 0,5,-1, or those nearest to values: cmod=0.1mm,0.2mm")         \
  X(plot, "--mark", "FIELD",                                                                       \
    "dots where a field is above 0 (yielded), or above or below a value ('S_p > 1e-6')")           \
  X(plot, "--component", "K",                                                                      \
    "component of a vector: x, y, z, or 0, 1, 2; its size if not given. Of stress and strain xx, " \
    "yy, xy, ..., or principal, the largest principal value")                                      \
  X(plot, "--range", "LOW,HIGH",                                                                   \
    "values between which a map's colours run, e.g. '0 MPa,5 MPa'; all that there are if not "     \
    "given")                                                                                       \
  X(plot, "--contours", "N",                                                                       \
    "of a map on meshes: about N lines of equal value, at round values, instead of colours")       \
  X(plot, "--factor", "F", "displacements of the map times F; so that they are seen if not given") \
  X(plot, "--slice", "z=0.05",                                                                     \
    "a slice of a body in space, half a spacing to either side; its surface if not given")         \
  X(report, "-o", "FILE", "the page; RESULT.html if not given")                                    \
  X(compare, "--tolerance", "R", "largest relative difference that counts as the same (0)")        \
  X(compare, "--x", "NAME", "history along x of the curve that is compared with a table (time)")   \
  X(compare, "--y", "NAME", "history along y (load)")                                              \
  X(compare, "--band", "LOW,HIGH",                                                                 \
    "two columns of the table: what is outside of the band between them counts")                   \
  X(compare, "--history", "NAME", "compare this history only; may be given several times")         \
  X(compare, "--field", "NAME", "compare this field only; may be given several times")             \
  X(compare, "--json", "", "as one JSON document on the standard output")                          \
  X(export, "-o", "FILE", "file of the table; the standard output if not given")                   \
  X(export, "--history", "NAME", "this history only, not all; may be given several times")         \
  X(export, "--frame", "N", "the particles of a frame, from 0; -1 is the last")                    \
  X(export, "--field", "NAME",                                                                     \
    "this field of the frame only, not all; may be given several times")                           \
  X(export, "--bonds", "", "the bonds of the frame, not its particles")                            \
  X(export, "--cracks", "NAME",                                                                    \
    "points of this crack, or the cracks across the line of this monitor, frame by frame")         \
  X(export, "--json", "", "as one JSON document on the standard output")                           \
  X(info, "--spacing", "L", "of the lattice that the law is put on, e.g. '10 mm'")                 \
  X(info, "--thickness", "T", "of the plate, e.g. '0.1 m'")                                        \
  X(info, "--area", "A", "of the bar that a chain stands for, e.g. '100 mm^2'")                    \
  X(info, "--lattice", LATTICE_KINDS_OF_SITES, "kind of lattice; by the law if not given")         \
  X(info, "--horizon", "H",                                                                        \
    "neighbours up to so many spacings away; the nearest ones if not given")                       \
  X(info, "--shells", "N", "neighbours of so many shells")                                         \
  X(info, "--set", "name=value",                                                                   \
    "set a parameter or an option of the law, or group.key of the deck; may be given several "     \
    "times")                                                                                       \
  X(info, "--modes", "N",                                                                          \
    "of a deck: the N lowest frequencies of its bodies as they are held, at most 100")             \
  X(info, "-o", "FILE", "of --modes: a result whose frames are the shapes, to be drawn as maps")   \
  X(info, "--json", "",                                                                            \
    "of a law, a result, or a deck's modes: as one JSON document on the standard output")          \
  X(info, "--builtins", "", "quantities and functions that laws may use; takes no file")           \
  X(explain, "--markdown", "", "as Markdown (default)")                                            \
  X(explain, "--latex", "", "as a LaTeX document")                                                 \
  X(explain, "--set", "option=choice", "choose an option of the law; may be given several times")  \
  X(format, "--check", "", "change nothing, only say which files would change (exit status 1)")    \
  X(format, "-i", "", "in place")                                                                  \
  OPTIONS_OF_SOLVERS(X, solver)

typedef struct command_entry {
  const char *name, *files, *endings, *purpose, *status;
} command_entry;
typedef struct option_entry {
  const char *command, *name, *value, *meaning;
} option_entry;
extern const command_entry command_table[];
extern const option_entry option_table[];
extern const int command_count, option_count;

#define X(name, files, endings, purpose, status) int command_##name(int argc, char **argv);
COMMANDS(X)
#undef X

/* Reads the options of one command. Each call looks at argv[*at]; a match consumes it (and its
   value) and advances *at. `--name value` and `--name=value` are the same. A missing value is
   reported; *bad is set. */
int option_flag(char **argv, int *at, const char *name);
const char *option_value(int argc, char **argv, int *at, const char *name, int *bad);
/* Begins like an option; `-` is none, but the standard input, which some commands read. */
bool is_option_like(const char *given);
/* Says that `given` is no option of `program`, which knows those of `command`, with the nearest
   of them. Returns 1. */
int option_unknown_in(const char *program, const char *command, const char *given);
/* The same of `perilat command`. */
int option_unknown(const char *command, const char *given);

bool command_has_options(const char *command);
/* The options of a command, a line each; nothing where it has none. */
void options_print(const char *command, FILE *out);
/* Usage, purpose and options of command_table[k]. */
void command_print(int k, FILE *out);

#endif
