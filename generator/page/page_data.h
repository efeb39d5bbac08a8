/* The numbers of a result for the script of its page: histories to the last bit, with which
   readings are told; frames are page_frames.h's. */
#ifndef PERILAT_GENERATOR_PAGE_DATA_H
#define PERILAT_GENERATOR_PAGE_DATA_H

#include "dsl/base/json.h"
#include "generator/page/page_result.h"

enum { PAGE_MOST_SAMPLES = 1500 };

/* Into the open object: "samples": the numbers of those that are kept, all where there are not more
   than PAGE_MOST_SAMPLES, else every n-th one, the peaks and those of the frames; "time", and of
   each series its unit and values. */
void page_put_histories(json *w, const page_result *p);
/* "name": "...", in base64. */
struct packing;
void page_put_packed(json *w, const char *name, struct packing *bytes);

#endif
