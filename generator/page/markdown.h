/* The little of Markdown that the program itself writes (explain.h), as HTML: headings, paragraphs,
   tables, code, formulas. Whatever the text holds, nothing of it becomes a tag. */
#ifndef PERILAT_GENERATOR_PAGE_MARKDOWN_H
#define PERILAT_GENERATOR_PAGE_MARKDOWN_H

#include <stdio.h>

/* `skip`: titles of sections that are left out, ended by NULL. Headings stand a level lower. */
void markdown_put(FILE *out, const char *text, const char *const *skip);

#endif
