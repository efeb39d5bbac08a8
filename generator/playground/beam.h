/* A run that a page steps through and draws: a deck and its laws, on the interpreter. One at a
   time. */
#ifndef PERILAT_PLAYGROUND_BEAM_H
#define PERILAT_PLAYGROUND_BEAM_H

typedef enum beam_status { BEAM_GOES_ON, BEAM_ENDED, BEAM_FAILED } beam_status;

/* What was open is let go of. False after messages on the error stream. */
int beam_open(const char *deck_path);
void beam_close(void);
/* Up to so many steps more. */
beam_status beam_step(int steps);

double beam_time(void);     /* s */
double beam_progress(void); /* part of the run that is done, 0 to 1 */
int beam_count(void);       /* particles */
/* [count][2] m: reference places, and how far each has moved; [count] 0 to 1, the mean
   damage of the bonds it began with; 0 where the deck's frames hold none. Until the next call of
   this module. */
const double *beam_places(void);
const double *beam_moved(void);
const double *beam_damage(void);

/* Samples so far of the deck's monitors, which are counted from 0, in SI; their times with -1. */
int beam_samples(void);
const double *beam_series(int monitor);
/* "cmod", or NULL where there are no more. */
const char *beam_series_name(int monitor);

#endif
