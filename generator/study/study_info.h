/* `perilat info NAME.h5` of a study's table: what it is, its columns and its cases. */
#ifndef PERILAT_GENERATOR_STUDY_INFO_H
#define PERILAT_GENERATOR_STUDY_INFO_H

#include <stdbool.h>

#include "dsl/base/json.h"

/* Prints it, or puts `columns` and `cases` into the document. False after a message. */
bool study_info(const char *path, json *w);

#endif
