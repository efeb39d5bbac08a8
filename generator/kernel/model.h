/* A model file on its way to a kernel: found, read, parsed, checked, planned, compiled (or
   interpreted). The room: from a law's file and a deck's material to a loaded kernel; the only
   place where the language meets the file system. */
#ifndef PERILAT_GENERATOR_MODEL_H
#define PERILAT_GENERATOR_MODEL_H

#include "dsl/base/c_linkage.h"
#include "dsl/semantics/law.h"
#include "generator/kernel/toolchain.h"
#include "runtime/deck/deck.h"

C_LINKAGE_BEGIN

typedef struct kernel_plan kernel_plan;
typedef struct law_variation law_variation;

typedef struct model {
  arena *memory;
  source_set sources;
  diagnostics said; /* all diagnostics so far; the caller prints them */
  char *path;       /* of the model file; NULL when it was not found */
  struct tree *tree;
  const struct law *law;
  deck_material values; /* of a material's law: what it sets beside options (material_law.h) */
  kernel_plan *plan;
  char *c_text, *key;   /* of model_c_text, model_key, once they were asked for */
  pl_law *interpreted;  /* the plan on the interpreter */
  loaded_kernel loaded; /* the compiled kernel, when there is one */
  double seconds_front; /* text to plan */
} model;

/* What a file is: by its ending, or else by how its text begins; a name without a file is
   FILE_UNKNOWN, maybe a law's. */
typedef enum file_kind {
  FILE_UNKNOWN,
  FILE_LAW,
  FILE_DECK, /* or a path for `perilat drive` */
  FILE_RESULT,
  FILE_TABLE,
  FILE_SIDECAR,
  FILE_PICTURE
} file_kind;
file_kind kind_of_file(const char *path);
#define FILES(kind) (1u << FILE_##kind)
/* False, after a sentence that says what the file is, when it is of a known kind that is none of
   `kinds`, made of FILES. `command` as the person typed it, "perilat plot", and what it needs:
   "a result". */
bool file_suits(const char *path, unsigned kinds, const char *command, const char *needs);
/* True when both name one existing file, by whatever path or link. */
bool same_file(const char *a, const char *b);

#define MODEL_LIMIT ((size_t)1 << 20) /* B: the longest law */

/* Path (malloc'ed) of a model given by name or by a path ending in .plm, or NULL; `-`, the
   standard input, where no deck gives the name. Looked for: beside `beside` (a deck's path, may
   be NULL); in $PERILAT_MODELS; in models/ under the working folder and its parents; in the
   models of this program's source or installation tree. */
char *model_find(const char *name, const char *beside);
/* From here on the process reads files in the folder of `file` and those of the models that come
   along, and writes in the first alone, whatever a law or a path names; what a law includes is
   named neither by an absolute path nor by one with `..`. `further` (NULL: none) is one more folder
   in which it reads. */
bool model_confine(const char *file, const char *further);
/* Of a name that was not found: the hint "did you mean `x`?", x among the models where `elastic`
   is. */
void model_suggest(const char *name, const char *beside, diagnostics *said);

/* Reads, parses, checks. False on errors; they are in m->said. The model must be closed in any
   case. */
bool model_open(model *m, const char *path, const law_choice *choices, int choice_count);
/* The same of a text at hand, which is named `path` in messages and found there by what it
   includes. */
bool model_open_text(model *m, const char *path, const char *text, size_t length,
                     const law_choice *choices, int choice_count);
/* True when the law is meant for a setting of the lattice, `plane_stress` say: its line `for`
   names it or is missing. Otherwise `meant` says what it is meant for: "plane_strain, space". */
bool model_suits(const model *m, const char *setting, char *meant, size_t size);
/* True when the law's line `for` names particles that stand on no lattice. */
bool model_suits_irregular(const model *m);
/* Plans the kernel (m->said on errors). */
bool model_plan(model *m);
/* The same for a kernel of what differs in space. */
bool model_plan_varying(model *m, const law_variation *v);
/* The same for a central law of bonds as a law of families. */
bool model_plan_of_families(model *m, const law_variation *v);
/* Kernel for the runtime: compiled; without a C compiler interpreted. *note is NULL, or says so, or
   that the cache is another one than was to be. NULL with `error`. */
const pl_law *model_kernel(model *m, bool interpret, const char **note, char *error, size_t size);
/* The C of the planned kernel, emitted at the first call, and its toolchain_key. */
const char *model_c_text(model *m);
const char *model_key(model *m);
void model_close(model *m);

/* Whole text of a file (malloc'ed, NUL-terminated), of `-` the standard input, or NULL with a
   sentence in error. Refuses folders and files over limit. */
char *read_text_file(const char *path, size_t limit, size_t *length, char *error, size_t size);

C_LINKAGE_END

#endif
