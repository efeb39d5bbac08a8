/* A checked law read back as equations, with tables of its symbols: units, bounds, descriptions.
   Values of the last step bear the index (n-1), those of the present step (n). */
#ifndef PERILAT_DSL_EXPLAIN_H
#define PERILAT_DSL_EXPLAIN_H

#include <stdio.h>

#include "dsl/base/c_linkage.h"
#include "dsl/semantics/law.h"

C_LINKAGE_BEGIN

typedef enum explain_form {
  EXPLAIN_MARKDOWN, /* formulas in $...$ and $$...$$, as GitHub, GitLab and pandoc read them */
  EXPLAIN_LATEX     /* a whole document for pdflatex */
} explain_form;

/* `choices` are those that `l` was checked with: cases on these options show the branch chosen
   alone; on other options all. */
void explain_law(const law *l, explain_form form, const law_choice *choices, int choice_count,
                 FILE *out);

C_LINKAGE_END

#endif
