/* The history of a run: values of its monitors, energies and, in quasi-static runs, of its
   increments, sample by sample. */
#ifndef PERILAT_RUNTIME_HISTORY_H
#define PERILAT_RUNTIME_HISTORY_H

#include "runtime/parts/ledger.h"
#include "runtime/parts/run_contact.h"
#include "runtime/parts/run_stamp.h"
#include "runtime/simulation/monitor.h"
#include "runtime/simulation/relaxation.h"
#include "runtime/simulation/run_clock.h"

/* Series: the deck's monitors; the energy terms, in sum, then, of several bodies, those of each, of
   each contact and of each stamp, and of laws beside the first one of a body what they store and
   take; what an increment took, or the step where it may shrink. */
typedef struct history {
  const monitors *monitors;
  const run_contacts *contacts;
  const run_stamps *stamps;
  const relaxation *relaxation; /* NULL: a dynamic run */
  const run_clock *shrinking;   /* NULL: its step stays */
  int energies;                 /* series of energies, or 0 */
  int cracks;                   /* series of the tips of cracks, behind these */
  char **names;                 /* [energies + cracks] */
  int series_count;
  int64_t capacity;
  double *time, *values; /* [capacity]; [series][capacity] */
  double *sampled;       /* [series] at the sample being taken */
} history;

history history_new(const monitors *m, const run_contacts *c, const run_stamps *s,
                    const relaxation *r, const run_clock *shrinking, bool energies,
                    int64_t capacity);
void history_free(history *h);
/* Where the energies of a sample are to be put: those of all bodies, [LEDGER_COUNT], or of one;
   contacts and then stamps are counted on behind the bodies. NULL without. */
double *history_energies(const history *h);
double *history_energies_of(const history *h, int body);
/* The same of a law beside the first one of its body, all of them counted through: what is stored
   in its bonds, and what it takes by damage and states. */
enum { HISTORY_LAW_STORED, HISTORY_LAW_TAKES, HISTORY_LAW_TERMS };
double *history_energies_of_law(const history *h, int number);
/* Sample number `sample` is what stands in `sampled`, and of the increment that has ended. */
void history_add(history *h, int64_t sample, double time);

const char *history_series(const history *h, int k, const char **unit, const double **values);
/* What a series is, in words. */
char *history_words(const history *h, int k, arena *a);
/* The largest of all energies in sum, in size, J; NaN without. The imbalance is none. */
double history_largest_energy(const history *h, int64_t samples);
/* The series that judges the run, the imbalance of its energies, or -1; with a body of several, its
   own. */
int history_imbalance(const history *h, int body);

#endif
