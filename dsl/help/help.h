/* The reference that the program carries: a page for each diagnostic code and each word of the
   language, written in dsl/help, and entries for built-in quantities, functions and units. */
#ifndef PERILAT_DSL_HELP_H
#define PERILAT_DSL_HELP_H

#include <stdio.h>

typedef enum help_section { HELP_CODES, HELP_KEYWORDS } help_section;

typedef struct help_page {
  help_section section;
  const char *name, *text; /* Markdown; examples that must be right are fenced as plm or nml, faulty
                              ones as plm-error or nml-error */
} help_page;

extern const help_page help_pages[];
extern const int help_page_count;

/* Prints all that is known of a topic: its pages and built-ins of that name, or "units". Returns
   how many there are. */
int help_show(const char *topic, FILE *out);

/* Names of all topics, for lists and suggestions; `names` must hold help_topic_count() of them. */
int help_topic_count(void);
void help_topics(const char **names);

#endif
