/* All of a result that a page shows, read once: texts, histories, times of frames, and the deck, as
   far as it can be read again from the result alone. */
#ifndef PERILAT_GENERATOR_PAGE_RESULT_H
#define PERILAT_GENERATOR_PAGE_RESULT_H

#include "runtime/deck/deck.h"
#include "runtime/result/result_file.h"

typedef struct page_series {
  const char *name, *unit;
  const double *values;  /* [samples] SI */
  const char *unchecked; /* of one that judges the run: why it says nothing, or "" */
} page_series;

typedef struct page_result {
  arena *memory;
  const char *path, *key; /* key: "a", "b" of a pair */
  const char *shown;      /* the path as the page has it: the file's name */
  result_file *file;
  const char *title, *deck_name, *deck_text, *set; /* set: --set, one a line; all "" where none */
  const char *ended, *started, *version, *compiler, *flags;
  const char *said_begin, *said_end, *said_warnings; /* what the run said; "" where it did not */
  double status, steps, step, wall, threads;
  const double *time; /* [samples] s, or numbers */
  long samples;
  bool quasi_static;
  const page_series *series; /* [series_count] in alphabetical order */
  int series_count;
  int main;  /* the monitor whose peak is told: load, or else the first of the deck; -1: none */
  int over;  /* what it is drawn over: an opening or a displacement; -1: time */
  long peak; /* sample of its largest size; -1 */
  const double *frame_times; /* [frames] */
  long frames;
  source_set sources; /* the deck's */
  diagnostics said;   /* what is wrong in it, where it cannot be read without other files */
  const deck *deck;
} page_result;

/* False after a message. To be closed in either case. `command` as in table_open. */
bool page_result_open(page_result *p, const char *command, const char *path, const char *key);
/* What is `good` is so no longer, after a message, where something could not be read. */
bool page_result_close(page_result *p, bool good);

/* Two of one name are told apart by as many folders as that takes. */
void page_results_name(page_result *results, int count);
/* The text with the names of files alone where it has paths from the root: the folders of a machine
   are nobody's business who gets the page. */
const char *page_without_folders(const page_result *p, const char *text);
/* How a series is called before people: "external work" of "energy/external". */
const char *page_series_words(const char *name);

/* -1: none of that name. */
int page_series_find(const page_result *p, const char *name);
/* "t = 4.1 ms", "increment 17", "mode 3": of a sample. */
enum { PAGE_MOMENT = 96 };
const char *page_moment(const page_result *p, double time, char text[PAGE_MOMENT]);
/* How the time axis is called, and its unit. */
const char *page_time_name(const page_result *p);
const char *page_time_unit(const page_result *p);
/* The largest of the energies' sizes at the samples, J; 0 without any. */
double page_largest_energy(const page_result *p);

#endif
