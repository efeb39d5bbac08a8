/* Shell completion, made of the tables in commands.h when perilat is built. */
#ifndef PERILAT_GENERATOR_COMPLETION_H
#define PERILAT_GENERATOR_COMPLETION_H

/* Writes perilat.bash, _perilat (zsh) and perilat.fish into the folder. An exit status, after a
   message. */
int completion_write(const char *folder);

#endif
