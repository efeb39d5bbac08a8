/* What is known of the tip of a crack at a look: names in decks and histories, units, words. Angles
   are in radians. */
#ifndef PERILAT_RUNTIME_TIP_VALUES_H
#define PERILAT_RUNTIME_TIP_VALUES_H

#define TIP_VALUES(X)                                                                              \
  X(K_I, "Pa*sqrt(m)", "stress intensity factor of mode I")                                        \
  X(K_II, "Pa*sqrt(m)", "stress intensity factor of mode II")                                      \
  X(K_eq, "Pa*sqrt(m)", "stress intensity of the largest hoop stress")                             \
  X(kink, "1", "direction of the largest hoop stress, from the crack's own")                       \
  X(energy_release, "N/m", "energy release rate")                                                  \
  X(angle, "1", "direction of the last leg, from x")                                               \
  X(length, "m", "length of the crack")                                                            \
  X(speed, "m/s", "speed of the tip")                                                              \
  X(x, "m", "place of the tip along x")                                                            \
  X(y, "m", "place of the tip along y")                                                            \
  X(segments, "1", "legs that have grown")

#define X(name, unit, words) TIP_##name,
typedef enum tip_value { TIP_VALUES(X) TIP_VALUE_COUNT } tip_value;
#undef X

extern const char *const tip_value_names[TIP_VALUE_COUNT];
extern const char *const tip_value_units[TIP_VALUE_COUNT];
extern const char *const tip_value_words[TIP_VALUE_COUNT];

#endif
