/* Random fields: numbers for parameters of a law that differ from bond to bond, or from particle to
   particle. A value is a function of the seed, of the parameter's name and of the place in the
   lattice alone, so that it does not depend on threads, on other bodies or on the order of
   particles.

   Behind every distribution stands a standard normal field z: its value is the quantile of Phi(z).
   Without correlation z comes from a hash of the seed and the lattice coordinates (on no lattice,
   of the place); with a correlation length L it is a sum of random waves (Shinozuka and Deodatis
   1991), sqrt(2/M) sum cos(k x + phi), with wave vectors from the spectrum of exp(-(r/L)^2). */
#ifndef PERILAT_RUNTIME_RANDOM_FIELD_H
#define PERILAT_RUNTIME_RANDOM_FIELD_H

#include "runtime/deck/deck.h"

/* uniform: low, high. normal: mean, standard deviation. lognormal: mean and deviation of the
   logarithm. Weibull: scale, shape. */
typedef struct random_distribution {
  field_kind kind;
  double a, b;
} random_distribution;

/* Distribution of a field. `own` is the material's value, the mean where the deck gives none. False
   with a sentence (a mean that the distribution cannot have). */
bool random_distribution_of(const deck_field *f, double own, random_distribution *out, char *error,
                            size_t size);
double random_distribution_mean(const random_distribution *r);
double random_distribution_deviation(const random_distribution *r);
/* Value with the probability Phi(z) of a smaller one. */
double random_quantile(const random_distribution *r, double z);

/* The standard normal field of a seed. */
typedef struct random_waves random_waves;
random_waves *random_waves_new(uint64_t seed, double correlation_length); /* m */
void random_waves_free(random_waves *w);
double random_waves_at(const random_waves *w, const double at[3]);
/* Standard normal number of a lattice site (its integer coordinates; c is 0 in the plane) and a
   direction (-1: of the particle). */
double random_normal_of_site(uint64_t seed, int64_t a, int64_t b, int64_t c, int direction);
/* The same of a place that is no lattice site, by the bits of where it is (m), and of the bond
   between two such places, from either end. */
double random_normal_of_place(uint64_t seed, const double at[3]);
double random_normal_between(uint64_t seed, const double at[3], const double end[3]);
/* Seed of a field: the deck's, mixed with the parameter's name without regard to case, so that two
   parameters with one seed are independent. */
uint64_t random_seed_of(const deck_field *f);

#endif
