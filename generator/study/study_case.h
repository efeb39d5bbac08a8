/* One run of a study: a deck with what is set in it, where its result goes, and a number that tells
   whether a result that is there already is of the same deck, laws and tables. */
#ifndef PERILAT_GENERATOR_STUDY_CASE_H
#define PERILAT_GENERATOR_STUDY_CASE_H

#include <stdint.h>

#include "generator/study/study_axis.h"
#include "generator/study/study_request.h"
#include "generator/study/study_setting.h"

typedef enum study_state {
  STUDY_WAITING,
  STUDY_DONE,   /* there is a result of a run that reached an end, or went bad */
  STUDY_FAILED, /* there is none; it is tried again when the study is gone on with */
} study_state;

typedef struct study_case {
  const char *name; /* of its files: "spacing=10mm,E=30GPa" */
  const char *deck; /* path */
  bool twin; /* of another motion of the body: it need not have the monitor that is watched */
  const char **values; /* [value_count] what is varied, as the table shows it */
  int value_count;
  study_setting *settings; /* [setting_count] all that is set */
  int setting_count;
  uint64_t identity;
  double
      crack_energy; /* N/m: what a crack along the rows takes by the law of the first lattice; NaN:
                          it says nothing of it */
  double cost;      /* of its run, compared with other cases */
  const char *result, *log; /* paths */
  study_state state;
  int status; /* exit status of its run */
} study_case;

/* The points of all axes crossed, the first one changing most slowly. NULL after messages: there
   are too many, or two are the same. */
study_case *study_cross(study_request *r, const study_axis *axes, int axis_count, int *count);
/* A case of a deck in which so much is varied. */
study_case study_case_of(study_request *r, const char *path, const study_setting *varied,
                         int count);
/* "spacing" of "lattice.spacing", or the whole where another of the keys has the same last part. */
const char *study_key_shown(const char *const *keys, int count, int k);
/* The deck and its laws are read as a run reads them: false after messages. Fills `identity`,
   `crack_energy` and `cost`. */
bool study_case_check(study_request *r, study_case *c);

#endif
