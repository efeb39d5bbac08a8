/* In how many parts the text of a kernel is compiled at the same time: as PL_PART 0, 1, ... A text that does not say
   PL_PART is compiled whole. Functions of the parts are seen by all. */
#ifndef PERILAT_GENERATOR_KERNEL_PARTS_H
#define PERILAT_GENERATOR_KERNEL_PARTS_H

enum { KERNEL_PARTS = 2 };

#endif
