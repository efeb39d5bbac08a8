/* What is said of the memory of a law, of a bond's and of a point's in the same words: states
   without effect, forces that are not those of the states, energies that lack something. */
#ifndef PERILAT_GENERATOR_SENSE_MEMORY_H
#define PERILAT_GENERATOR_SENSE_MEMORY_H

#include "generator/ir/ir.h"
#include "generator/sense/sense_bench.h"

/* A state, of a tensor one of its components, that keeps its initial value. */
void sense_say_never_moves(sense_bench *b, const symbol *field);
/* One that moves in vain. `mend` may be NULL. */
void sense_say_without_effect(sense_bench *b, const symbol *field, const char *mend);

/* What the forces of a step read beside the motion and the new states. */
typedef struct sense_reads {
  bool old, dt; /* old values of states; the time of the step */
} sense_reads;

sense_reads sense_forces_read(ir *g, const law *l, const ir_node *forces, int count,
                              const ir_node *new_fields);

/* Steps after which one more at the same motion, in which no time goes on, left the states. */
typedef struct sense_held {
  int settled, changed; /* such steps, and those after which the force was another one */
  int moved, late;      /* the same of steps in which states moved */
} sense_held;

/* A force that is another one after a longer step. */
void sense_say_reads_dt(sense_bench *b);

void sense_hold(sense_held *h, bool moved, bool another);
void sense_say_held(sense_bench *b, const sense_held *h, sense_reads forces);

/* Work of a way out and back, by size, and what the law's energy gave back too much in its steps
   (J, or J/m^3). */
typedef struct sense_losses {
  double work, gained;
} sense_losses;

/* A step's work, and what it lost: its work less what the energy grew by. */
void sense_lose(sense_losses *l, double work, double lost);
/* Whether more came out than steps are coarse. */
bool sense_gains(const sense_losses *l);
/* Says so where steps four times as fine found the same: a law may overtake the strain in a step.
   `way`: "drawn out"; `mend` is an example. */
bool sense_say_losses(sense_bench *b, const sense_losses *l, const sense_losses *finer,
                      const char *way, const char *mend);

#endif
