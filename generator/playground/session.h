/* One command of the program, as a page asks for it. The room: what a page in a browser asks of the
   program, which is compiled to WebAssembly for that; its files stand in memory. */
#ifndef PERILAT_PLAYGROUND_SESSION_H
#define PERILAT_PLAYGROUND_SESSION_H

/* `line`: the command and its arguments, a line each, such as "check\nlaw.plm". What it says goes
   to the standard output and error stream. Returns its exit status. */
int play_command(const char *line);

/* The words of the language, for colours: a line for each kind, its name and then the words. Until
   the next call. */
const char *play_words(void);

/* A formula of `perilat explain`, between its dollars, as MathML. Until the next call. */
const char *play_formula(const char *latex);

#endif
