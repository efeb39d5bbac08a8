#include "runtime/lattice/bond_numbers.h"

#include <assert.h>
#include <stdbool.h>
#include <stdlib.h>

#include "dsl/base/arena.h"

enum { NONE = -1, OWNER = 0, OTHER = 1, MOST_NUMBERS = 64 /* bits of a mask */ };

/* --- owners ----------------------------------------------------------------------------------- */

typedef struct trails {
  const point_pairs *pairs;
  numbered_bond *bonds;
  long *first;     /* [particles + 1] into `around` */
  long *next;      /* [particles] where to go on in `around` */
  int32_t *left;   /* [particles] bonds that no trail has taken */
  int32_t *around; /* bonds of particle after particle */
  unsigned char *taken;
} trails;

static void find_around(trails *t, long particles) {
  for (long m = 0; m < t->pairs->count; m++) {
    t->left[t->pairs->items[m].i]++;
    t->left[t->pairs->items[m].j]++;
  }
  for (long p = 0; p < particles; p++) {
    t->first[p + 1] = t->first[p] + t->left[p];
    t->next[p] = t->first[p];
  }
  for (long m = 0; m < t->pairs->count; m++) {
    t->around[t->next[t->pairs->items[m].i]++] = (int32_t)m;
    t->around[t->next[t->pairs->items[m].j]++] = (int32_t)m;
  }
  for (long p = 0; p < particles; p++)
    t->next[p] = t->first[p];
}

/* As far as there are bonds; the particle where a bond is entered owns it. */
static void walk_trail(trails *t, int32_t from) {
  while (t->left[from] > 0) {
    while (t->taken[t->around[t->next[from]]])
      t->next[from]++;
    const int32_t m = t->around[t->next[from]];
    const point_pair ends = t->pairs->items[m];
    const int32_t to = ends.i == from ? ends.j : ends.i;
    t->taken[m] = 1;
    t->bonds[m] = (numbered_bond){from, to, NONE};
    t->left[from]--;
    t->left[to]--;
    from = to;
  }
}

/* Trails pass through particles, so that as many bonds come in as go out, but for one where a trail
   begins or ends: at particles with an odd number of bonds. What is left then are round trips. */
static void choose_owners(const point_pairs *pairs, long particles, numbered_bond *bonds) {
  const size_t n = (size_t)particles + 1;
  trails t = {.pairs = pairs, .bonds = bonds};
  t.first = must_calloc(n, sizeof *t.first);
  t.next = must_calloc(n, sizeof *t.next);
  t.left = must_calloc(n, sizeof *t.left);
  t.around = must_alloc((2 * (size_t)pairs->count + 1) * sizeof *t.around);
  t.taken = must_calloc((size_t)pairs->count + 1, 1);
  find_around(&t, particles);
  for (int round = 0; round < 2; round++)
    for (long p = 0; p < particles; p++)
      if (round == 1 || t.left[p] % 2 == 1) walk_trail(&t, (int32_t)p);
  free(t.first);
  free(t.next);
  free(t.left);
  free(t.around);
  free(t.taken);
}

/* --- numbers ---------------------------------------------------------------------------------- */

typedef struct colouring {
  numbered_bond *bonds;
  int numbers;
  int32_t *with[2];  /* [particles][numbers] bond of that number on the side, or NONE */
  uint64_t *free[2]; /* [particles] bit k: number k is free on the side */
  int32_t *path;     /* bonds whose numbers are exchanged */
  long room;
} colouring;

static int32_t end_of(const colouring *c, long bond, int side) {
  return side == OWNER ? c->bonds[bond].owner : c->bonds[bond].other;
}

static void give(colouring *c, long bond, int number) {
  c->bonds[bond].number = number;
  for (int side = OWNER; side <= OTHER; side++) {
    const long p = end_of(c, bond, side);
    c->with[side][p * c->numbers + number] = (int32_t)bond;
    c->free[side][p] &= ~(UINT64_C(1) << number);
  }
}

static void take_back(colouring *c, long bond) {
  const int number = c->bonds[bond].number;
  for (int side = OWNER; side <= OTHER; side++) {
    const long p = end_of(c, bond, side);
    c->with[side][p * c->numbers + number] = NONE;
    c->free[side][p] |= UINT64_C(1) << number;
  }
}

static void add_to_path(colouring *c, long at, int32_t bond) {
  if (at == c->room) {
    c->room = 2 * c->room + 64;
    c->path = must_realloc(c->path, (size_t)c->room * sizeof *c->path);
  }
  c->path[at] = bond;
}

/* The bonds numbered a, b, a, ... that hang together from the other side of particle p on change
   numbers: a is free there afterwards. Such a chain does not come to the owner's side of a particle
   where a is free. */
static void exchange(colouring *c, long p, int a, int b) {
  long length = 0;
  int side = OTHER, number = a;
  for (int32_t bond; (bond = c->with[side][p * c->numbers + number]) != NONE; length++) {
    add_to_path(c, length, bond);
    side = OWNER + OTHER - side;
    p = end_of(c, bond, side);
    number = a + b - number;
  }
  for (long k = 0; k < length; k++)
    take_back(c, c->path[k]);
  for (long k = 0; k < length; k++)
    give(c, c->path[k], k % 2 == 0 ? b : a);
}

/* The lowest number that is free on both sides; or the lowest of the owner's, where the other side
   has none higher than it, or its own lowest, to exchange: high numbers stay rare. */
static void number_bond(colouring *c, long bond) {
  const long owner = c->bonds[bond].owner, other = c->bonds[bond].other;
  const uint64_t here = c->free[OWNER][owner], there = c->free[OTHER][other];
  const int a = __builtin_ctzll(here), b = __builtin_ctzll(there), higher = a > b ? a : b;
  const uint64_t both = here & there;
  const int shared = both ? __builtin_ctzll(both) : MOST_NUMBERS;
  if (shared > higher) exchange(c, other, a, b);
  give(c, bond, shared > higher ? a : shared);
}

/* Most bonds that a particle has on one side. */
static int count_numbers(const numbered_bond *bonds, long count, long particles) {
  int32_t *sides = must_calloc(2 * (size_t)particles + 1, sizeof *sides), most = 0;
  for (long m = 0; m < count; m++) {
    const int32_t own = ++sides[2 * (long)bonds[m].owner];
    const int32_t other = ++sides[2 * (long)bonds[m].other + 1];
    most = own > most ? own : most;
    most = other > most ? other : most;
  }
  free(sides);
  return most;
}

int bond_numbers(const point_pairs *pairs, long particles, numbered_bond *bonds) {
  choose_owners(pairs, particles, bonds);
  colouring c = {.bonds = bonds, .numbers = count_numbers(bonds, pairs->count, particles)};
  assert(c.numbers <= MOST_NUMBERS);
  const long places = particles * c.numbers;
  const uint64_t all = c.numbers == MOST_NUMBERS ? UINT64_MAX : (UINT64_C(1) << c.numbers) - 1;
  for (int side = OWNER; side <= OTHER; side++) {
    c.with[side] = must_alloc(((size_t)places + 1) * sizeof *c.with[side]);
    c.free[side] = must_alloc(((size_t)particles + 1) * sizeof *c.free[side]);
    for (long k = 0; k < places; k++)
      c.with[side][k] = NONE;
    for (long p = 0; p < particles; p++)
      c.free[side][p] = all;
  }
  for (long m = 0; m < pairs->count; m++)
    number_bond(&c, m);
  for (int side = OWNER; side <= OTHER; side++) {
    free(c.with[side]);
    free(c.free[side]);
  }
  free(c.path);
  return c.numbers;
}

/* --- by ways ---------------------------------------------------------------------------------- */

/* The lowest number, not below `least`, that is free at both; MOST_NUMBERS: none. */
static int lowest_free(uint64_t here, uint64_t there, int least) {
  const uint64_t both = ~(here | there) & (least < MOST_NUMBERS ? UINT64_MAX << least : 0);
  return both ? __builtin_ctzll(both) : MOST_NUMBERS;
}

/* The end that owns a bond of an uncommon way is that which leaves the lower number, else the way's
   beginning. */
static void number_uncommon(uint64_t *taken[2], int least, int32_t from, int32_t to,
                            numbered_bond *bond) {
  const int ahead = lowest_free(taken[OWNER][from], taken[OTHER][to], least),
            back = lowest_free(taken[OWNER][to], taken[OTHER][from], least);
  *bond = ahead <= back ? (numbered_bond){from, to, ahead} : (numbered_bond){to, from, back};
}

int bond_numbers_by_ways(const point_pairs *pairs, long particles, const bond_ways *ways,
                         numbered_bond *bonds) {
  uint64_t *taken[2];
  int numbers = ways->common;
  for (int side = OWNER; side <= OTHER; side++)
    taken[side] = must_calloc((size_t)particles + 1, sizeof *taken[side]);
  for (long m = 0; m < pairs->count && numbers <= MOST_NUMBERS; m++) {
    const point_pair ends = pairs->items[m];
    const int way = abs(ways->of[m]) - 1;
    const int32_t from = ways->of[m] < 0 ? ends.j : ends.i, to = ends.i + ends.j - from;
    if (way >= 0 && way < ways->common)
      bonds[m] = (numbered_bond){from, to, way};
    else
      number_uncommon(taken, ways->common, from, to, &bonds[m]);
    if (bonds[m].number >= numbers) numbers = bonds[m].number + 1;
    const uint64_t bit = bonds[m].number < MOST_NUMBERS ? UINT64_C(1) << bonds[m].number : 0;
    if ((taken[OWNER][bonds[m].owner] | taken[OTHER][bonds[m].other]) & bit)
      numbers = MOST_NUMBERS + 1; /* two particles at one place */
    taken[OWNER][bonds[m].owner] |= bit;
    taken[OTHER][bonds[m].other] |= bit;
  }
  free(taken[OWNER]);
  free(taken[OTHER]);
  return numbers <= MOST_NUMBERS ? numbers : 0;
}
