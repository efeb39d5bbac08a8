/* Laws of families as a specialist would program each for its one lattice: no neighbour list,
   structure of arrays, eight bonds at once, every bond found once a step, one sweep over the rows
   in which a row moves as soon as its forces are known. What a compiler of laws should come near
   to.

   They exist twice, compiled without and with contraction to fused multiply-adds. Rounding differs
   from that of the generated kernels, which keep to the order of the law's equations: agreement is
   to a part in 1e9, not to the bit. */
#ifndef PERILAT_BENCHMARK_HANDWRITTEN_FAMILIES_H
#define PERILAT_BENCHMARK_HANDWRITTEN_FAMILIES_H

#include "tests/benchmark/family_problem.h"

#ifndef HANDWRITTEN_SUFFIX
#define HANDWRITTEN_SUFFIX _plain
#endif
#define HANDWRITTEN_JOIN2(a, b) a##b
#define HANDWRITTEN_JOIN(a, b)  HANDWRITTEN_JOIN2(a, b)
#define HANDWRITTEN_NAME(name)  HANDWRITTEN_JOIN(name, HANDWRITTEN_SUFFIX)

extern const body_program elastic_hexagon_plain,
    elastic_hexagon_fused, /* splm_elastic, hexagon in plane stress */
    concrete_hexagon_plain,
    concrete_hexagon_fused, /* splm_concrete with its first options, hexagon in plane stress */
    elastic_fcc_plain, elastic_fcc_fused, /* splm_elastic, face-centred cubic, 18 neighbours */
    beams_fcc_plain, beams_fcc_fused,     /* mplm_space, the same */
    lps_cubic_plain, lps_cubic_fused;     /* lps, cubic box, any horizon up to 128 neighbours */

#endif
