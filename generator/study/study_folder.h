/* The folder of a study: results of its cases, and a list of what each is of, kept before a run
   begins. So nothing that is done is done twice, whatever stops the study, and no result of another
   one is taken for its own. */
#ifndef PERILAT_GENERATOR_STUDY_FOLDER_H
#define PERILAT_GENERATOR_STUDY_FOLDER_H

#include "generator/study/study_case.h"

typedef struct study_folder {
  const char *path, *namer; /* `namer`: what names it, -o or `result` */
  int list; /* open, and locked for this study and the runs that it has started; -1: not */
  struct kept_case *kept;
  int kept_count;
} study_folder;

/* Makes the folder where it is not there, and waits for runs that a killed study has left. False
   after a message: the name is taken, or cannot be written, or a study is at work there. */
bool study_folder_open(study_folder *f, study_request *r);
void study_folder_close(study_folder *f);
/* Takes up those cases that are not in the list, and finds out which are done. 0, or an exit status
   after a message: 1 when a name is that of another case, 2 when the list cannot be written. */
int study_folder_take(study_folder *f, arena *a, study_case *cases, int count);
/* What has become of a case whose run ended with `status`, or which is found. */
void study_folder_look(study_case *c, int status);

#endif
