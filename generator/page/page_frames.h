/* The frames of a result in its page: a canvas that the script draws on, without script four
   pictures, as `perilat plot --map` draws them. */
#ifndef PERILAT_GENERATOR_PAGE_FRAMES_H
#define PERILAT_GENERATOR_PAGE_FRAMES_H

#include <stdio.h>

#include "dsl/base/json.h"
#include "generator/page/movie.h"

/* Of the section; the heading is the page's. */
void page_frames(FILE *out, const page_result *p, const movie *m);
/* "frames": {...}, or null where there is nothing to show. */
void page_put_frames(json *w, const page_result *p, const movie *m);
/* "scale": colours of values from low to high; "classes": of damage. */
void page_put_colours(json *w);

#endif
