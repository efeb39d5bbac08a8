#include "generator/sense/sense_modes.h"

#include <math.h>

#include "dsl/base/elementary.h"
#include "runtime/analysis/stencil.h"

static const double NOTHING = 1e-6; /* of the stiffness that a particle alone would meet */

/* By turns along the primitive vectors whose bits are set: whether a particle that moves so feels
   nothing of it, whatever its direction. A gradient over the family sums up what is odd in the
   chords, of which such a motion has nothing. */
static bool is_free_by_turns(const stencil *s, unsigned axes) {
  double left = 0, alone = 0;
  for (int a = 0; a < s->dimensions; a++)
    for (int b = 0; b < s->dimensions; b++) {
      double sum = 0;
      for (int k = 0; k < s->count; k++) {
        long turns = 0;
        for (int c = 0; c < s->dimensions; c++)
          turns += axes >> c & 1 ? s->blocks[k].cell[c] : 0;
        sum += turns % 2 ? -s->blocks[k].stiffness[a][b] : s->blocks[k].stiffness[a][b];
        alone = pl_fmax(alone, k == 0 ? fabs(s->blocks[k].stiffness[a][b]) : 0);
      }
      left = pl_fmax(left, fabs(sum));
    }
  return alone > 0 && left <= NOTHING * alone;
}

void sense_check_modes(sense_bench *b) {
  if (b->law->tree->law != LAW_STATE || !b->lattice) return;
  stencil s = stencil_new(b->kernel, b->parameters, b->lattice);
  bool free = false;
  for (unsigned axes = 1; s.finite && axes < 1u << s.dimensions; axes++)
    free = free || is_free_by_turns(&s, axes);
  stencil_free(&s);
  if (!free) return;
  sense_say(b, DIAG_ZERO_ENERGY, sense_force(b->law),
            "give what is not uniform springs of its own: a force in proportion to "
            "`u[j] - u - gradient(u)*(s*direction)`",
            "particles that move to and fro by turns feel nothing: such motions grow unseen");
}
