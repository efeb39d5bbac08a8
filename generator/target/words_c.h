/* C as the target: the table of its words (words.h), loops that compilers vectorise, arrays of
   runtime/kernel.h. X(name, text) */
#ifndef PERILAT_GENERATOR_WORDS_C_H
#define PERILAT_GENERATOR_WORDS_C_H

/* clang-format off */
#define C_WORDS(X)                                                                                 \
  X(NOTHING, "")                                                                                   \
  /* expressions */                                                                                \
  X(CHOICE, "$1 ? $2 : $3")                                                                        \
  X(CASE, "$1 ? $2\n        : $3")                                                                 \
  X(CALL, "pl_$1($2)")                                                                             \
  X(FUSED, "pl_fma($1, $2, $3)")                                                                   \
  X(SUM, "$1 + $2")                                                                                \
  X(LARGER, "pl_max($1, $2)")                                                                      \
  X(SMALLER, "pl_min($1, $2)")                                                                     \
  X(ABOVE_ALL, "__builtin_inf()")                                                                  \
  X(BELOW_ALL, "-__builtin_inf()")                                                                 \
  X(NOT, "!($1)")                                                                                  \
  X(NOT_ZERO, "$1 != 0.0")                                                                         \
  X(ANY_BIT, "$1 != 0 ? 1.0 : 0.0")                                                                \
  X(SIGNED, "sign*$1")                                                                             \
  X(BITS, "pl_to_bits($1)")                                                                        \
  X(HERE, "$1[q]")                                                                                 \
  X(OF_LISTED, "$1[q + to[q]]")                                                                    \
  X(FROM_THERE, "$1 + $2")                                                                         \
  /* statements: $1 is the indentation */                                                          \
  X(LINE, "$1const double $2 = $3$4")                                                              \
  X(LINE_END, ";\n")                                                                               \
  X(LINE_END_OF, "; /* line $1 */\n")                                                              \
  X(DECLARE, "$1$2 $3 = $4;\n")                                                                    \
  X(STORE, "$1$2 = $3;\n")                                                                         \
  X(ADD, "$1$2 += $3;\n")                                                                          \
  X(END, "$1}\n")                                                                                  \
  X(LAST_END, "}\n\n")                                                                             \
  X(ELSE, "      } else {\n")                                                                      \
  X(BLOCK, "      {\n")                                                                            \
  X(VARIABLE, "    double $1;\n")                                                                  \
  X(REMARK, "/* $1 */\n")                                                                          \
  /* what a name is declared as */                                                                 \
  X(VALUE, "const double")                                                                         \
  X(READ, "const double *restrict")                                                                \
  X(READ_BITS, "const uint64_t *restrict")                                                         \
  X(WRITTEN, "double *restrict")                                                                   \
  /* functions: kind, name, over what, part of the text */                                         \
  X(FUNCTION, "$1 void $2(const pl_law *, const double *, $3);\n#if PL_IN_PART($4)\n"              \
    "$1 void $2(const pl_law *law, const double *uniforms, $3) {\n")                               \
  X(FUNCTION_END, "}\n#endif\n\n")                                                                 \
  X(OVER_STATES, "const pl_states *given")                                                         \
  X(OVER_STRIP, "const pl_strip *strip")                                                           \
  X(OVER_PART_OF_STRIP, "const pl_strip *strip, long first, long last,\n    "                      \
    "double *const *lent, double (*kept)[$1]")                                                     \
  X(OVER_POINTS, "const pl_points *points")                                                        \
  X(OVER_FAMILY, "const pl_family *family")                                                        \
  X(UNIFORM, "uniforms[$1]")                                                                       \
  X(INPUT_ARRAY, "at_$1")                                                                          \
  X(RESULT_ARRAY, "at_out_$1")                                                                     \
  X(OVER_BONDS, "  PL_INDEPENDENT\n  for (long q = 0; q < count; q++) {\n")                        \
                                                                                                   \
  /* --- functions of parameters and states --- */                                                 \
  X(PREPARE, "PL_RARE static void prepare(const pl_law *law, const double *parameters,\n"          \
    "    const pl_bond_class *bonds, double *uniforms) {\n"                                        \
    "  (void)law, (void)parameters, (void)bonds, (void)uniforms;\n")                               \
  X(BOUNDS, "PL_RARE static void $1(const pl_law *law, const double *parameters, "                 \
    "double *lower,\n"                                                                             \
    "    double *upper, unsigned char *low_open, unsigned char *high_open) {\n"                    \
    "  (void)law, (void)parameters, (void)lower, (void)upper, (void)low_open, (void)high_open;\n") \
  X(DEFAULTS, "PL_RARE static void defaults(const pl_law *law, const double *parameters, "         \
    "double *values) {\n  (void)law, (void)parameters;\n")                                         \
  X(DEFAULT, "values[$1]")                                                                         \
  X(PARAMETER, "parameters[$1]")                                                                   \
  X(CLASS_CHORD, "bonds->chord[$1]")                                                               \
  X(LOWER_BOUND, "  lower[$1] = $2, low_open[$1] = $3;\n")                                         \
  X(UPPER_BOUND, "  upper[$1] = $2, high_open[$1] = $3;\n")                                        \
  X(STATES_HEAD, "  (void)law, (void)uniforms;\n  const long count = given->count;\n")             \
  X(STATE_INPUT, "given->in[$1]")                                                                  \
  X(STATE_FIELD, "given->field[$1]")                                                               \
  X(STATE_RESULT, "given->out[$1]")                                                                \
  X(STATE_NEW_FIELD, "given->new_field[$1]")                                                       \
                                                                                                   \
  /* --- points of a continuum --- */                                                              \
  X(POINTS_HEAD, "  (void)law, (void)uniforms;\n"                                                  \
    "  const long count = points->count / PL_LANES * PL_LANES;\n")                                 \
  X(POINT_STRAIN, "points->strain[$1]")                                                            \
  X(POINT_RATE, "points->strain_rate[$1]")                                                         \
  X(POINT_SIZE, "points->cell_size")                                                               \
  X(POINT_PARAMETER, "points->parameter[$1]")                                                      \
  X(POINT_TIME_STEP, "points->time_step")                                                          \
  X(POINT_ADVANCE, "points->advance")                                                              \
  X(POINT_OLD_FIELD, "points->old_field[$1]")                                                      \
  X(POINT_NEW_FIELD, "points->new_field[$1]")                                                      \
  X(POINT_STRESS, "points->stress[$1]")                                                            \
  X(POINT_TANGENT, "points->tangent[$1]")                                                          \
  X(POINT_OBSERVED, "points->observed[$1]")                                                        \
  X(OVER_TIPS, "const pl_tips *points")                                                            \
  X(TIP_INPUT, "points->in[$1]")                                                                   \
  X(TIP_OUT, "points->out[$1]")                                                                    \
  X(POINT_LOST, "points->lost[$1]")                                                                \
  /* rectangles: their four points in one lane of a loop */                                        \
  X(OVER_RECTANGLES, "const pl_rectangles *cells")                                                 \
  X(RECTANGLES_HEAD, "  const pl_points *points = cells->points;\n"                                \
    "  (void)law, (void)uniforms, (void)points;\n"                                                 \
    "  const pl_rectangle slopes = *cells->slopes, push = *cells->push;\n"                         \
    "  const long stride = cells->stride;\n"                                                       \
    "  pl_rectangle_ends ends[2];\n"                                                               \
    "  for (long d = 0; d < 2; d++) pl_rectangle_begin(&ends[d], cells->right[d]);\n")             \
  X(RECTANGLE_FIELD, "  const double *restrict along_x_$1 = cells->$2[0];\n"                       \
    "  const double *restrict along_y_$1 = cells->$2[1];\n")                                       \
  X(RECTANGLE_FORCE, "  double *restrict at_force_$1 = cells->force[$1];\n"                        \
    "  double *restrict at_above_$1 = cells->above[$1];\n")                                        \
  X(RECTANGLE_LOOP, "  enum { BLOCK = 4*PL_LANES };\n"                                             \
    "  for (long first = 0; first < cells->count; first += PL_LANES) {\n"                          \
    "  const long begin = 4*first, end = begin + BLOCK;\n  (void)begin, (void)end;\n")             \
  X(RECTANGLE_LANES, "  PL_INDEPENDENT\n  for (long lane = 0; lane < PL_LANES; lane++) {\n"        \
    "    const long low = first + lane, high = low + stride;\n"                                    \
    "    double cell_stress[3][4], pushed[2][4];\n")                                               \
  X(RECTANGLE_STRAINS, "    double $1[3][4];\n"                                                    \
    "    pl_rectangle_strain(&slopes,\n"                                                           \
    "      (const double[]){along_x_$1[low], along_x_$1[low + 1],\n"                               \
    "                       along_x_$1[high], along_x_$1[high + 1]},\n"                            \
    "      (const double[]){along_y_$1[low], along_y_$1[low + 1],\n"                               \
    "                       along_y_$1[high], along_y_$1[high + 1]}, $1);\n")                      \
  X(RECTANGLE_POINTS, "    PL_UNROLL_4\n    for (long k = 0; k < 4; k++) {\n"                      \
    "    const long q = 4*first + k*PL_LANES + lane;\n    (void)q;\n")                             \
  X(RECTANGLE_VALUE, "$1[$2][k]")                                                                  \
  X(RECTANGLE_PUSH, "    pl_rectangle_push(&push, cell_stress[0], cell_stress[2], pushed[0]);\n"   \
    "    pl_rectangle_push(&push, cell_stress[2], cell_stress[1], pushed[1]);\n")                  \
  X(RECTANGLE_STORE, "    pl_rectangle_keep(&ends[$1], lane, pushed[$1]);\n")                      \
  X(RECTANGLE_SUM, "  pl_rectangle_sum(&ends[$1], cells->cells - first,\n"                         \
    "                   at_force_$1 + first, at_above_$1 + first);\n")                             \
  X(RECTANGLE_END, "  pl_rectangle_end(&ends[$1], cells->right[$1]);\n")                           \
  /* losses where what is expected may not be so: added once all points of the block are known */  \
  X(LOSS_WAITS, "  _Alignas(PL_ALIGNMENT) double lost_$1[BLOCK];\n")                               \
  X(LOSS_THAT_WAITS, "lost_$1[q - begin]")                                                         \
  /* searches: block by block, all points of one as long as one goes on */                         \
  X(SEARCH_BLOCKS, "  enum { BLOCK = $1 };\n"                                                      \
    "  for (long begin = 0; begin < count; begin += BLOCK) {\n"                                    \
    "  const long rest = count - begin, lanes = rest < BLOCK ? rest : BLOCK;\n"                    \
    "  const long end = begin + lanes;\n")                                                         \
  X(SEARCH_KEEP, "  _Alignas(PL_ALIGNMENT) double kept_$1[BLOCK];\n")                              \
  X(SEARCH_KEPT, "kept_$1[q - begin]")                                                             \
  X(SEARCH_FOUND, "  _Alignas(PL_ALIGNMENT) double found_$1[BLOCK];\n")                            \
  X(SEARCH_RESULT, "found_$1[q - begin]")                                                          \
  X(SEARCH_PLACES, "  _Alignas(PL_ALIGNMENT) double low[BLOCK], high[BLOCK], last[BLOCK], "        \
    "move[BLOCK],\n    going[BLOCK];\n")                                                           \
  X(SEARCH_START, "    const pl_search_place at_first = pl_search_from($1);\n"                     \
    "    $2 = at_first.z, low[q - begin] = at_first.low, high[q - begin] = at_first.high;\n"       \
    "    last[q - begin] = at_first.last, move[q - begin] = at_first.move;\n"                      \
    "    going[q - begin] = at_first.going;\n")                                                    \
  X(SEARCH_STEPS, "  uint64_t some_go_on = 1;\n"                                                   \
    "  for (long step = 0; step < PL_SEARCH_STEPS && some_go_on != 0; step++) {\n"                 \
    "  some_go_on = 0;\n")                                                                         \
  X(SEARCH_STEP, "    pl_search_place place = {$1, low[q - begin], high[q - begin], "              \
    "last[q - begin],\n      move[q - begin], going[q - begin]};\n"                                \
    "    place = pl_search(place, $2, $3);\n"                                                      \
    "    $1 = place.z, low[q - begin] = place.low, high[q - begin] = place.high;\n"                \
    "    last[q - begin] = place.last, move[q - begin] = place.move;\n"                            \
    "    going[q - begin] = place.going;\n"                                                        \
    "    some_go_on |= pl_to_bits(place.going);\n")                                                \
  X(SEARCH_BEGIN, "  {\n")                                                                         \
  X(SEARCH_LOOP, "  PL_INDEPENDENT\n  for (long q = begin; q < end; q++) {\n")                     \
                                                                                                   \
  /* --- strips of bonds --- */                                                                    \
  X(STRIP_HEAD, "  (void)law, (void)uniforms;\n"                                                   \
    "  const long count = strip->count / PL_LANES * PL_LANES;\n"                                   \
    "  const int64_t *restrict flags = strip->flags;\n"                                            \
    "  const int$1_t present_bit = (int$1_t)PL_PRESENT(strip->direction);\n")                      \
  X(NO_RESULTS, "  (void)flags, (void)present_bit;\n")                                             \
  X(STRIP_MOTION, "strip->$1$2[$3]")                                                               \
  X(STRIP_PARAMETER, "strip->parameter[$1]")                                                       \
  X(STRIP_TIME_STEP, "strip->time_step")                                                           \
  X(STRIP_ADVANCE, "strip->advance")                                                               \
  X(STRIP_FORCE, "strip->force[$1]")                                                               \
  X(STRIP_FIELD, "strip->field[$1]")                                                               \
  X(STRIP_STATE_LOSS, "strip->dissipated_state")                                                   \
  X(STRIP_RATE_LOSS, "strip->dissipated_rate")                                                     \
  X(STRIP_REST_GIFT, "strip->given_by_rest")                                                       \
  X(STRIP_OBSERVED, "strip->observed[$1]")                                                         \
  X(FORCE_ARRAY, "at_force_$1")                                                                    \
  X(FIELD_ARRAY, "at_field_$1")                                                                    \
  X(STATE_LOSS_ARRAY, "at_dissipated_state")                                                       \
  X(RATE_LOSS_ARRAY, "at_dissipated_rate")                                                         \
  X(REST_GIFT_ARRAY, "at_given_by_rest")                                                           \
  X(OBSERVED_ARRAY, "at_observed_$1")                                                              \
  /* protection and presence */                                                                    \
  X(PROTECTED_BIT, "  const int64_t protected_bit = PL_PROTECTED(strip->direction);\n")            \
  X(IS_PROTECTED, "(flags[q] & protected_bit) != 0")                                               \
  X(IF_UNPROTECTED, "  if (strip->unheld != 0) {\n")                                               \
  X(IF_PROTECTED, "  }\n  if (strip->unheld == 0) {\n")                                            \
  X(PRESENT_OF_STRIP, "    const int32_t present = (int32_t)flags[q] & present_bit;\n")            \
  X(PRESENT_OF_PART, "    const int64_t present = flags[q] & present_bit;\n")                      \
  X(NOT_ABSENT, "present != 0")                                                                    \
  /* stages over parts of a strip, and what they keep */                                           \
  X(OVER_PARTS, "  for (long first = 0; first < count; first += $1) {\n"                           \
    "  const long last = count - first < $1 ? count - first : $1;\n")                              \
  X(OVER_PART, "  PL_INDEPENDENT\n  for (long k = 0; k < last; k++) {\n")                          \
  X(BOND_OF_PART, "    const long q = first + k;\n")                                               \
  X(KEEP_BUFFERS, "  _Alignas(PL_ALIGNMENT) double kept[$1][$2];\n")                               \
  X(BUFFER, "kept[$1][k]")                                                                         \
  X(BUFFERS, "kept")                                                                               \
  X(NO_BUFFERS, "(void *)0")                                                                       \
  /* sizes of what is expected, new damage */                                                      \
  X(NO_LARGE, "  uint64_t large = 0;\n")                                                           \
  X(GATHER_LARGE, "    large |= $1 | $2;\n")                                                       \
  X(IS_LARGE, "(large >> 62 & 1) != 0")                                                            \
  X(NO_LARGEST, "  uint64_t largest_$1 = 0;\n")                                                    \
  X(GATHER_LARGEST, "    const uint64_t size_$1 = $2;\n"                                           \
    "    largest_$1 = size_$1 > largest_$1 ? size_$1 : largest_$1;\n")                             \
  X(IS_LARGEST, "largest_$1 >= $2")                                                                \
  X(NO_OTHER, "  uint64_t other_$1 = 0;\n")                                                        \
  X(GATHER_OTHER, "    const double other_here_$1 = $3 ? 0.0 : 1.0;\n"                             \
    "    const double other_bond_$1 = present != 0 ? other_here_$1 : 0.0;\n"                       \
    "    $2 = other_bond_$1;\n    other_$1 |= pl_to_bits(other_bond_$1);\n")                       \
  X(IS_OTHER, "other_$1 != 0")                                                                     \
  X(NO_CHANGES, "  uint64_t changed = 0;\n")                                                       \
  X(CHANGE, "($1 - pl_to_bits($2[q]))")                                                            \
  X(GATHER_CHANGES, "    changed |= present != 0 ? $1 : 0;\n")                                     \
  X(IF_CHANGED, "  if (changed != 0) {\n")                                                         \
  /* what is not as expected, computed again */                                                    \
  X(UNEXPECTED_NAME, "$1_unusual")                                                                 \
  X(DECLARE_UNEXPECTED, "PL_APART PL_PASS void $1(const pl_law *, const double *, $2);\n")         \
  X(COMPUTE_AGAIN, "  if ($1)\n"                                                                   \
    "    $2_unusual(law, uniforms, strip, first, last, (double *[]){$3}, $4);\n")                  \
  X(UNEXPECTED_HEAD, "  (void)law, (void)lent, (void)kept;\n"                                      \
    "  const int64_t *restrict flags = strip->flags;\n"                                            \
    "  const int64_t present_bit = (int64_t)PL_PRESENT(strip->direction);\n"                       \
    "  (void)flags, (void)present_bit;\n")                                                         \
  X(ARRAY_GIVEN, "lent[$1]")                                                                       \
  X(OVER_GROUPS, "  uint64_t unusual[$1] = {0};\n"                                                 \
    "  for (long group = 0; group < last; group += PL_LANES) {\n  uint64_t some = 0;\n")           \
  X(SEARCH, "  PL_INDEPENDENT\n"                                                                   \
    "  for (long k = group; k < group + PL_LANES; k++) {\n"                                        \
    "    const long q = first + k;\n")                                                             \
  X(SEARCH_END, "    const int64_t present = flags[q] & present_bit;\n"                            \
    "    some |= ($1) ? 0 : (uint64_t)present;\n  }\n")                                            \
  X(SEARCH_KEPT_FLAGS, "  for (long k = group; k < group + PL_LANES; k++)\n"                       \
    "    some |= pl_to_bits($1);\n")                                                               \
  X(OVER_UNEXPECTED, "  unusual[group / PL_LANES] = some;\n  }\n"                                  \
    "  for (long group = 0, end; group < last; group = end) {\n"                                   \
    "  end = group + PL_LANES;\n  if (unusual[group / PL_LANES] == 0) continue;\n"                 \
    "  while (unusual[end / PL_LANES] != 0) end += PL_LANES;\n")                                   \
  X(BOTH_SIDES, "  /* both sides of what was expected */\n  PL_INDEPENDENT\n"                      \
    "  for (long k = group; k < end; k++) {\n    const long q = first + k;\n    (void)q;\n")       \
  X(BOTH_SIDES_END, "  }\n  }\n")                                                                  \
                                                                                                   \
  /* --- families: $1: number of the array, $2: first particle of the chunk, $3: neighbour --- */  \
  X(PROTECTED_PARTICLES, "family->held$2")                                                         \
  X(VOLUME, "family->volume$2")                                                                    \
  X(FAMILY_PARAMETER, "family->parameter[$1]$2")                                                   \
  X(FAMILY_PARAMETER_TOWARD, "family->parameter[$1]$2 + $3*family->plane")                         \
  X(SHARE, "family->share$2")                                                                      \
  X(OWN_SIZE, "family->own_size$2")                                                                \
  X(MASS, "family->mass$2")                                                                        \
  X(LENGTH, "family->length$2 + $3*family->plane")                                                 \
  X(CHORD, "family->chord[$1]$2 + $3*family->plane")                                               \
  X(DISPLACEMENT, "family->displacement[$1]$2")                                                    \
  X(VELOCITY, "family->velocity[$1]$2")                                                            \
  X(SHAPE, "family->shape[$1]$2")                                                                  \
  X(OLD_FIELD, "family->old_field[$1]$2")                                                          \
  X(OLD_FIELD_TOWARD, "family->old_field[$1]$2 + $3*family->plane")                                \
  X(NEW_FIELD, "family->new_field[$1]$2")                                                          \
  X(NEW_FIELD_TOWARD, "family->new_field[$1]$2 + $3*family->new_plane")                            \
  X(FORCE, "family->force[$1]$2")                                                                  \
  X(FORCE_STATE, "family->force_state[$1]$2 + $3*family->new_plane")                               \
  X(OBSERVED, "family->observed[$1]$2")                                                            \
  X(LOST, "family->lost[$1]$2")                                                                    \
  X(FAMILY_TIME_STEP, "family->time_step")                                                         \
  X(FAMILY_ADVANCE, "family->advance")                                                             \
  X(OBSERVED_TOWARD, "family->observed[$1]$2 + $3*family->new_plane")                              \
  X(LINK, "family->link[$1]$2")                                                                    \
  X(BOND_LINK, "family->bond_link[$1]$2 + $3*family->link_plane")                                  \
  X(SHARED_LOWER, "family->bond_link[$1]$2 + $3 + ($4)*family->link_plane")                        \
  X(SHARED_UPPER, "family->bond_link[$1]$2 + $3 + (half + $4)*family->link_plane")                 \
  X(SLOT, "slot_$1")                                                                               \
  X(PLANE, "plane_$1[k]")                                                                          \
  X(ROOT_ARRAY, "to_$1")                                                                           \
  X(BONDS, "family->bonds")                                                                        \
  X(OFFSET, "family->offset[$1]")                                                                  \
  X(LINK_OFFSET, "family->link_offset[$1]")                                                        \
  /* passes */                                                                                     \
  X(UNIFORM_COUNT, "enum { UNIFORMS = $1 };\n\n")                                                  \
  X(UNIFORM_OF_NEIGHBOUR, "uniforms[k*UNIFORMS + $1]")                                             \
  X(UNIFORM_OF, "uniforms[$2*UNIFORMS + $1]")                                                      \
  X(PASS_NAME, "$1_$2")                                                                            \
  X(UNROLLED_REMARK, "/* one loop, $1 neighbours written out */\n")                                \
  X(FAMILY_HEAD, "  const long half = family->neighbours / 2;\n"                                   \
    "  (void)law, (void)uniforms, (void)half;\n")                                                  \
  X(PROGRAM_TABLES, "static const pl_family_function $1_passes[] = {$2};\n"                        \
    "static const uint64_t $1_shared[] = {$3};\n\n")                                               \
  X(OVER_ROWS, "  for (long row = 0; row < family->rows; row++) {\n"                               \
    "  const long begin = row*family->row_stride,\n"                                               \
    "    end = begin + family->count / PL_LANES * PL_LANES;\n")                                    \
  X(ONE_RUN, "  const long begin = 0, end = family->count;\n")                                     \
  X(CHUNK, "  enum { CHUNK = $1 };\n")                                                             \
  X(OVER_CHUNKS, "  for (long first = begin; first < end; first += CHUNK) {\n"                     \
    "    const long left = end - first;\n"                                                         \
    "    const long lanes = left < CHUNK ? left / PL_LANES * PL_LANES : CHUNK;\n")                 \
  X(KEEP_SLOT, "  _Alignas(PL_ALIGNMENT) double slot_$1[CHUNK];\n")                                \
  X(KEEP_PLANE, "  _Alignas(PL_ALIGNMENT) double plane_$1[2*PL_MAX_DIRECTIONS][CHUNK];\n")         \
  X(START_SLOTS, "    for (long q = 0; q < lanes; q++) {\n")                                       \
  X(RETURN_IF_AHEAD, "  if (family->ahead_only) return;\n")                                        \
  /* loops over particles and neighbours */                                                        \
  X(OVER_PARTICLES, "    { /* particle by particle */\n")                                          \
  X(SOME_UNEXPECTED, "    uint64_t unusual = 0;\n")                                                \
  X(IF_SOME_UNEXPECTED, "    if (unusual != 0) {\n")                                               \
  X(OVER_LANES, "$1PL_INDEPENDENT\n$1for (long q = 0; q < lanes; q++) {\n")                        \
  X(OVER_NEIGHBOURS, "    for (long k = 0; k < family->neighbours; k++) { "                        \
    "/* neighbour by neighbour */\n"                                                               \
    "      const long back = k < half ? k + half : k - half;\n")                                   \
  X(OVER_OWNED, "    for (long k = 0; k < half; k++) { /* bond by bond, for both ends */\n"        \
    "      const long back = k + half;\n")                                                         \
  X(WAY_OF_ROWS, "      const long to = family->offset[k], link_to = family->link_offset[k];\n"    \
    "      (void)link_to;\n      (void)to, (void)back;\n")                                         \
  X(WAY_OF_LIST, "      const int32_t *restrict to = family->neighbour + first + "                 \
    "k*family->plane;\n"                                                                           \
    "      (void)to, (void)back;\n")                                                               \
  X(BONDS_OF_ROWS, "      const uint64_t *restrict bonds = family->bonds + first + "               \
    "(k < half ? 0 : to);\n"                                                                       \
    "      const uint64_t present_bit = UINT64_C(1) << (k < half ? k : back);\n")                  \
  X(SOME_BONDS, "    uint64_t some_own = 0, some_others = 0; /* bonds that some particle has */\n" \
    "    for (long q = 0; q < lanes; q++) {\n"                                                     \
    "      some_own |= family->bonds[first + q];\n"                                                \
    "      some_others |= family->incoming[first + q];\n"                                          \
    "    }\n")                                                                                     \
  X(UNLESS_SOME, "      if (((k < half ? some_own : some_others) >> "                              \
    "(k < half ? k : back) & 1) == 0) {\n")                                                        \
  X(ZEROS, "        double *restrict absent_$1 = $2;\n"                                            \
    "        for (long q = 0; q < lanes; q++)\n          absent_$1[q] = 0.0;\n")                   \
  X(ZEROS_OF_SPAN, "        double *restrict absent_$1 = $2;\n"                                    \
    "        for (long q = from; q < until; q++)\n          absent_$1[q] = 0.0;\n")                \
  X(NEXT_NEIGHBOUR, "        continue;\n      }\n")                                                \
  X(BONDS_OF_LIST, "      const uint64_t *restrict bonds = (k < half ? family->bonds : "           \
    "family->incoming) + first;\n"                                                                 \
    "      const uint64_t present_bit = UINT64_C(1) << (k < half ? k : back);\n")                  \
  X(LIST_FUNCTIONS,                                                                                \
    "/* What PL_LANES particles after the other have toward a neighbour; NULL: each its own. */\n" \
    "static inline const int32_t *alike_toward(const pl_family *family, long first, long k) {\n"   \
    "  if (!PL_HAS(family, way) || !family->way) return (const int32_t *)0;\n"                     \
    "  return family->alike + first / PL_LANES*family->neighbours + k;\n"                          \
    "}\n\n"                                                                                        \
    "static inline long end_of_alike(const int32_t *alike, long step, long from, long lanes) {\n"  \
    "  long until = from + PL_LANES;\n"                                                            \
    "  if (!alike) return lanes;\n"                                                                \
    "  while (until < lanes && alike[until / PL_LANES*step] == alike[from / PL_LANES*step])\n"     \
    "    until += PL_LANES;\n"                                                                     \
    "  return until;\n"                                                                            \
    "}\n\n")                                                                                       \
  X(FETCH_NEXT, "      for (long q = 0; q < CHUNK; q += PL_LANES)\n"                               \
    "        __builtin_prefetch($1 + CHUNK + q, $2);\n")                                           \
  X(ONE_SPAN, "      {\n      const long from = 0, span = lanes;\n")                               \
  X(OVER_SPANS, "      const int32_t *alike = alike_toward(family, first, k);\n"                   \
    "      for (long from = 0, until; from < lanes; from = until) { "                              \
    "/* particles that are alike */\n"                                                             \
    "      const int32_t which = "                                                                 \
    "alike ? alike[from / PL_LANES*family->neighbours] : PL_OWN_WAYS;\n"                           \
    "      until = end_of_alike(alike, family->neighbours, from, lanes);\n"                        \
    "      const long span = (until - from) / PL_LANES * PL_LANES;\n"                              \
    "      if (which == PL_NO_WAY) {\n")                                                           \
  X(IF_ALIKE, "      if (which >= 0) {\n      const pl_way *way = family->way + which;\n"          \
    "      (void)way;\n")                                                                          \
  X(OVER_SPAN, "      PL_INDEPENDENT\n      for (long q = from; q < from + span; q++) {\n")        \
  X(AT_FROM, "$1[from]")                                                                           \
  X(WAY_LENGTH, "way->length")                                                                     \
  X(WAY_CHORD, "way->chord[$1]")                                                                   \
  X(PRESENT_BY_BIT, "        const int64_t present = (bonds[q] & present_bit) != 0;\n")            \
  X(SIGN, "      const double sign = k < half ? 1.0 : -1.0;\n")                                    \
  X(OWNER, "      const long owned = k < half ? k : back, owner = k < half ? 0 : link_to;\n")      \
  /* unrolled neighbours: variables instead of arrays; $1 is their number */                       \
  X(OVER_RUN, "  PL_INDEPENDENT\n  for (long q = begin; q < end; q++) {\n")                        \
  X(SLOT_VARIABLE, "at_slot_$1")                                                                   \
  X(PLANE_VARIABLE, "at_plane_$1_$2")                                                              \
  X(READ_VARIABLE, "at_read_$1")                                                                   \
  X(ARRAY_VARIABLE, "at_$1")                                                                       \
  X(UNIFORM_VARIABLE, "at_uniform_$1")                                                             \
  X(BITS_ARRAY, "at_bits_$1")                                                                      \
  X(RESULT_ARRAY_OF, "at_result_$1")                                                               \
  X(RESULT_VARIABLE, "at_result_$1[q]")                                                            \
  X(NAME_OF_BOND, "at_$1_$2")                                                                      \
  X(READ_HERE, "$2at_$1[q]")                                                                       \
  X(READ_AGAIN, "$2PL_AGAIN(at_read_$1, at_$1)")                                                   \
  X(READ_FIRST, "$2(at_read_$1 = at_$1[q])")                                                       \
  X(PRESENT_BIT_OF, "        const int64_t present = (at_bits_$1[q] & UINT64_C(1) << $2) != 0;\n") \
                                                                                                   \
  /* --- bonds that add to both ends --- */                                                        \
  X(OVER_PAIRS, "    for (long k = 0; k < half; k++) { /* bond by bond, adding to both ends */\n"  \
    "      const long to = family->offset[k], link_to = family->link_offset[k], "                  \
    "back = k + half;\n"                                                                           \
    "      (void)back, (void)link_to;\n"                                                           \
    "      const uint64_t *restrict bonds = family->bonds + first;\n"                              \
    "      const uint64_t present_bit = UINT64_C(1) << k;\n"                                       \
    "      const long above = 63 - k;\n"                                                           \
    "      (void)present_bit, (void)above;\n")                                                     \
  X(BOTH_ENDS, "      double *restrict to_$1 = slot_$2, *restrict far_$1 = family->sum[$3] + "     \
    "first + to;\n")                                                                               \
  /* by the sign of what is moved there: gcc asks more if it is to ask for a bit */                \
  X(PRESENT_BY_SIGN, "        const int64_t present = (int64_t)(bonds[q] << above) < 0;\n")        \
  X(ROOT_VALUE, "        const double value_$1 = present ? $2 : 0.0;\n")                           \
  X(KEEP_VALUES, "    _Alignas(PL_ALIGNMENT) double kept[$1][CHUNK];\n")                           \
  X(KEEP_VALUE, "        kept[$1][q] = value_$1;\n")                                               \
  X(KEPT_VALUE, "        const double value_$1 = kept[$1][q];\n")                                  \
  X(ADD_TO_BOTH, "        to_$1[q] += value_$2;\n        far_$1[q] $3= value_$2;\n")               \
  X(ADD_TO_EACH, "        to_$1[q] += value_$2;\n        far_$1[q] += value_$3;\n")                \
  X(ADD_PRODUCT_TO_BOTH, "        to_$1[q] = pl_fma(value_$2, $3, to_$1[q]);\n"                    \
    "        far_$1[q] = pl_fma($4value_$2, $3, far_$1[q]);\n")                                    \
  X(TAKE_SUM, "    {\n    double *restrict got = family->sum[$1] + first;\n"                       \
    "    for (long q = 0; q < lanes; q++) {\n      slot_$2[q] += got[q];\n"                        \
    "      got[q] = 0.0;\n    }\n    }\n")                                                         \
  X(UNLESS_KNOWN, "$1if (!family->constants_known)\n")                                             \
  X(KEEP_CONSTANT_SUM, "    if (family->constant_sum && !family->ahead_only) {\n"                  \
    "    double *restrict constant = family->constant_sum[$1] + first;\n"                          \
    "    for (long q = 0; q < lanes; q++)\n"                                                       \
    "      slot_$2[q] = constant[q] = family->constants_known ? constant[q] : "                    \
    "slot_$2[q];\n    }\n")                                                                        \
  X(NEXT_IF_AHEAD, "    if (family->ahead_only) continue;\n")                                      \
  /* what is not as expected, now and when the pass was here last */                               \
  X(GATHER_UNEXPECTED, "        unusual |= (($1)) ? 0 : $2;\n")                                    \
  X(AS_BEFORE, "      uint64_t unusual = before & present_bit;\n")                                 \
  X(AS_EXPECTED, "      uint64_t unusual = 0;\n")                                                  \
  X(IF_EXPECTED, "      if ((unusual & present_bit) == 0) {\n")                                    \
  X(IF_UNEXPECTED, "      }\n      if ((unusual & present_bit) != 0) {\n      unusual = 0;\n")     \
  X(REMEMBER, "      told |= unusual & present_bit;\n")                                            \
  X(UNEXPECTED_BEFORE, "    const uint64_t before = family->unusual && !family->ahead_only ? "     \
    "family->unusual[first / PL_LANES] : 0;\n    uint64_t told = 0;\n")                            \
  X(UNEXPECTED_NOW, "    const uint64_t unusual = family->unusual ? family->unusual[first / "      \
    "PL_LANES] : UINT64_MAX;\n")                                                                   \
  X(LEAVE_UNEXPECTED, "    if (family->unusual && !family->ahead_only) family->unusual[first / "   \
    "PL_LANES] = told;\n")                                                                         \
  /* fields and the marks of where they are 0 */                                                   \
  X(FILLED_MARKS, "    const uint64_t $1_filled_$2 = some_marked(family->$1_filled[$2] + first / " \
    "PL_LANES, lanes, 0);\n")                                                                      \
  X(SETTLED_MARKS, "    const uint64_t unsettled_$1 = some_marked(family->settled[$2] + first / "  \
    "PL_LANES, lanes, UINT64_MAX);\n")                                                             \
  X(FILLED, "$1_filled_$2")                                                                        \
  X(IF_FILLED, "      if ((($1) >> k & 1) != 0) {\n")                                              \
  X(IF_FILLED_OR_PROTECTED, "      if ((($1) >> k & 1) != 0 || family->held_near) {\n")            \
  X(FIELD_BEFORE, "      const double *restrict before_$1 = (old_filled_$2 >> k & 1) == 0 ? "      \
    "zeros : "                                                                                     \
    "family->old_field[$2] + first + k*family->plane;\n")                                          \
  X(STORE_FIELD, "      const int settled_$1 = are_equal(kept[$2], before_$1, lanes);\n"           \
    "      if (!family->ahead_only && (!settled_$1 || (unsettled_$1 >> k & 1)))\n"                 \
    "        store_at_ends(family, $3, first, lanes, k, kept[$2], settled_$1);\n")                 \
  X(FIELD_FUNCTIONS,                                                                               \
    "static const _Alignas(PL_ALIGNMENT) double zeros[$1];\n\n"                                    \
    "/* Bits of neighbours toward which some of the particles of a chunk have the mark, or do "    \
    "not "                                                                                         \
    "have it. */\n"                                                                                \
    "static uint64_t some_marked(const uint64_t *mark, long lanes, uint64_t turned) {\n"           \
    "  uint64_t all = 0;\n"                                                                        \
    "  for (long q = 0; q < lanes; q += PL_LANES)\n"                                               \
    "    all |= mark[q / PL_LANES] ^ turned;\n"                                                    \
    "  return all;\n"                                                                              \
    "}\n\n"                                                                                        \
    "static int are_equal(const double *a, const double *b, long lanes) {\n"                       \
    "  uint64_t differ = 0;\n"                                                                     \
    "  for (long q = 0; q < lanes; q++)\n"                                                         \
    "    differ |= pl_to_bits(a[q]) ^ pl_to_bits(b[q]);\n"                                         \
    "  return differ == 0;\n"                                                                      \
    "}\n\n"                                                                                        \
    "/* New values toward neighbour k, at both ends. */\n"                                         \
    "static __attribute__((noinline, cold)) void store_at_ends(\n"                                 \
    "    const pl_family *family, int field, long first, long lanes, long k, const double "        \
    "*values,\n"                                                                                   \
    "    int settled) {\n"                                                                         \
    "  const long to = family->offset[k], half = family->neighbours / 2;\n"                        \
    "  double *restrict here = family->new_field[field] + first + k*family->new_plane;\n"          \
    "  double *restrict there = family->new_field[field] + first + to + (k + "                     \
    "half)*family->new_plane;\n"                                                                   \
    "  const uint64_t bit = UINT64_C(1) << k;\n"                                                   \
    "  for (long at = 0; at < lanes; at += PL_LANES) {\n"                                          \
    "    uint64_t *filled = family->new_filled[field] + (first + at) / PL_LANES;\n"                \
    "    uint64_t *same = family->settled[field] + (first + at) / PL_LANES, bits = 0;\n"           \
    "    for (long q = at; q < at + PL_LANES; q++) {\n"                                            \
    "      here[q] = there[q] = values[q];\n"                                                      \
    "      bits |= pl_to_bits(values[q]);\n"                                                       \
    "    }\n"                                                                                      \
    "    *filled = bits != 0 ? *filled | bit : *filled & ~bit;\n"                                  \
    "    *same = settled ? *same | bit : *same & ~bit;\n"                                          \
    "  }\n"                                                                                        \
    "}\n\n")                                                                                       \
  /* losses: nothing is lost where no field has changed */                                         \
  X(CHANGED_PLANE, "static uint64_t changed_plane(const double *old, const double *now, "          \
    "long lanes) {\n"                                                                              \
    "  uint64_t bits = 0;\n"                                                                       \
    "  for (long q = 0; q < lanes; q++)\n"                                                         \
    "    bits |= pl_to_bits(old[q]) - pl_to_bits(now[q]);\n"                                       \
    "  return bits;\n"                                                                             \
    "}\n\n")                                                                                       \
  X(CHANGED_MARKS,                                                                                 \
    "/* By marks of the particles' own bonds, and of those that lead here. */\n"                   \
    "static uint64_t changed_marks(const pl_family *family, long field, long first, "              \
    "long lanes) {\n"                                                                              \
    "  const uint64_t *settled = family->settled[field];\n"                                        \
    "  const long half = family->neighbours / 2;\n"                                                \
    "  uint64_t bits = some_marked(settled + first / PL_LANES, lanes, UINT64_MAX);\n"              \
    "  bits &= (UINT64_C(1) << half) - 1;\n"                                                       \
    "  for (long k = 0; k < half; k++) {\n"                                                        \
    "    const long begin = (first - family->offset[k]) >> 3;\n"                                   \
    "    const long end = (first - family->offset[k] + lanes - 1) >> 3;\n"                         \
    "    for (long q = begin; q <= end; q++)\n"                                                    \
    "      bits |= ~settled[q] & UINT64_C(1) << k;\n"                                              \
    "  }\n"                                                                                        \
    "  return bits;\n"                                                                             \
    "}\n_Static_assert(PL_LANES == 8, \"sites of a mark\");\n\n")                                  \
  X(CHANGES_BEGIN, "static uint64_t changes(const pl_family *family, long first, "                 \
    "long lanes) {\n  uint64_t bits = 0;\n")                                                       \
  X(CHANGES_OF_MARKS, "  bits |= changed_marks(family, $1, first, lanes);\n")                      \
  X(CHANGES_OF_PLANES, "  for (long k = 0; k < $2 && bits == 0; k++)\n"                            \
    "    bits |= changed_plane(family->old_field[$1] + first + k*family->plane,\n"                 \
    "                          family->new_field[$1] + first + k*family->new_plane, lanes);\n")    \
  X(CHANGES_END, "  return bits;\n}\n\n")                                                          \
  X(IF_FIELDS_CHANGED, "    if (changes(family, first, lanes) != 0) {\n")                          \
                                                                                                   \
  /* --- before all: what the compiler is told --- */                                              \
  /* gcc would ask one question of a case several times, and of strips keep what it had better     \
     load again (8 % of a step); of families it would move what is loaded for a choice into a      \
     branch; of points it would take a power's cases apart and no longer see a loop for vectors.   \
     The others only take the compiler's time. */                                                  \
  X(STRIP_OPTIONS, "\"no-thread-jumps\", \"no-gcse\"")                                             \
  X(POINT_OPTIONS, "\"no-thread-jumps\", \"no-gcse\", \"no-tree-pre\"")                            \
  X(FAMILY_OPTIONS, "\"no-thread-jumps\", \"no-tree-sink\", \"no-tree-pre\", "                     \
    "\"no-tree-slp-vectorize\", \"no-predictive-commoning\", \"no-tree-loop-distribution\", "      \
    "\"no-split-loops\"")                                                                          \
  /* Loops of ten thousands of operations: passes that take more than linear time are left out. */ \
  X(LARGE_OPTIONS, "\"O1\", \"tree-vectorize\", $1")                                               \
  X(PRELUDE, "/* Written by perilat. */\n#if !defined(__clang__)\n"                                \
    "#pragma GCC optimize($1)\n#endif\n"                                                           \
    "#pragma GCC diagnostic push\n#pragma GCC diagnostic ignored \"-Wunused-function\"\n")         \
  /* Bonds of a strip share no output, whatever the pointers look like. What an array of a family  \
     held is there already: gcc would load it again behind every store, and compute again what     \
     follows; clang, spared the load, would branch. */                                             \
  X(PRELUDE_END, "#pragma GCC diagnostic pop\n"                                                    \
    "\n#if defined(__clang__)\n"                                                                   \
    "#define PL_INDEPENDENT _Pragma(\"clang loop vectorize(assume_safety)\")\n"                    \
    "#define PL_AGAIN(value, array) ((void)(value), (array)[q])\n"                                 \
    "#else\n"                                                                                      \
    "#define PL_INDEPENDENT _Pragma(\"GCC ivdep\")\n"                                              \
    "#define PL_AGAIN(value, array) (value)\n"                                                     \
    "#endif\n"                                                                                     \
    "#define PL_RARE __attribute__((cold)) /* not worth the compiler's time */\n"                  \
    "#define PL_APART __attribute__((noinline)) /* leaves its caller the registers */\n"           \
    "#if defined(PL_PART) /* one of the parts that are compiled at the same time */\n"             \
    "#define PL_PASS __attribute__((visibility(\"hidden\")))\n"                                    \
    "#define PL_IN_PART(part) (PL_PART == (part))\n"                                               \
    "#else\n"                                                                                      \
    "#define PL_PASS static\n"                                                                     \
    "#define PL_IN_PART(part) 1\n"                                                                 \
    "#endif\n\n")
/* clang-format on */

#endif
