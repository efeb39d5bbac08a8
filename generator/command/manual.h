/* Man pages, made of the tables in commands.h when perilat is built. */
#ifndef PERILAT_GENERATOR_MANUAL_H
#define PERILAT_GENERATOR_MANUAL_H

/* Writes perilat.1 and perilat-COMMAND.1 into the folder. An exit status, after a message. */
int manual_write(const char *folder);

#endif
