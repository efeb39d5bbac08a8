/* The frames of a result that a person means: "0,5,-1", or "cmod=0.128mm,0.288mm", the stored ones
   nearest to where a history first takes these values. */
#ifndef PERILAT_GENERATOR_FRAME_CHOICE_H
#define PERILAT_GENERATOR_FRAME_CHOICE_H

#include <stdbool.h>

typedef struct frame_choice {
  long *frames;    /* [count] */
  char **captions; /* [count] what the history is there; NULL for frames by number */
  int count;
} frame_choice;

/* False after messages. A value that no frame is near to, a history that never takes a value, are
   said. To be freed in either case. */
bool frame_choice_read(frame_choice *c, const char *path, const char *given);
void frame_choice_free(frame_choice *c);

#endif
