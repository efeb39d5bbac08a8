/* perilat new: a law to start from, the path that one bond of it is driven along, and the deck
   of a small specimen. */
#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "generator/command/commands.h"
#include "generator/command/templates.h"
#include "generator/kernel/document.h"
#include "generator/kernel/model.h"
#include "generator/target/c_text.h"

enum {
  INPUT_WRONG = 1,
  NEW_FAILED = 2,
  FILE_COUNT = 3,
  LONGEST_NAME = 63,
  PATH_SIZE = LONGEST_NAME + 16
};

/* What there is to begin with, by --kind. */
typedef struct new_kind {
  const char *kind, *law, *drive, *deck; /* drive: NULL where no path drives such a law */
  const char *plot;                      /* what to draw of the specimen */
} new_kind;

static const new_kind kinds[] = {
    {"central", template_central, template_drive, template_deck, "--x opening --y load"},
    {"micropolar", template_micropolar, template_drive, template_deck, "--x opening --y load"},
    {"state", template_state, template_state_drive, template_deck, "--x opening --y load"},
    {"continuum", template_continuum, template_continuum_drive, template_continuum_deck,
     "--x displacement --y load"},
    {"crack", template_crack, NULL, template_crack_deck, "--map displacement"}};
enum { KIND_COUNT = sizeof kinds / sizeof *kinds };

typedef struct new_file {
  char path[PATH_SIZE];
  char *text; /* malloc'ed */
  bool written;
} new_file;

/* The template with `name` for each NAME; malloc'ed. */
static char *fill_in(const char *template, const char *name) {
  static const char mark[] = "NAME";
  c_text out = {NULL, 0, 0};
  for (const char *at = template, *next; at; at = next) {
    next = strstr(at, mark);
    c_text_add(&out, "%.*s%s", (int)(next ? (size_t)(next - at) : strlen(at)), at,
               next ? name : "");
    next = next ? next + strlen(mark) : NULL;
  }
  return out.text;
}

static bool is_name(const char *name) {
  static const char letters[] = "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ";
  static const char further[] = "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_";
  if (*name && strchr(letters, *name) && strspn(name, further) == strlen(name) &&
      strlen(name) <= LONGEST_NAME)
    return true;
  say_error("`%s` cannot be the name of a law\n  a name is made of letters, digits and _, begins "
            "with a letter and has at most %d characters; no path, no ending",
            name, LONGEST_NAME);
  return false;
}

/* The language has words that no law can be named after; its own front end knows them. */
static bool is_law(const new_file *f, const char *name) {
  model m;
  bool good = model_open_text(&m, f->path, f->text, strlen(f->text), NULL, 0);
  if (!good)
    say_error("`%s` cannot be the name of a law: %s\n  take another name, e.g. my_%s", name,
              m.said.count ? m.said.items[0].message : "its template is not a law", name);
  model_close(&m);
  return good;
}

static bool spares_all(const new_file *files) {
  for (int k = 0; k < FILE_COUNT; k++)
    if (files[k].text && access(files[k].path, F_OK) == 0) {
      say_error(
          "there is already a `%s`; nothing was written\n  take another name, or move it away",
          files[k].path);
      return false;
    }
  return true;
}

/* A law found by name in this folder goes before one that comes along. */
static void warn_of_hidden(const char *name) {
  char *found = model_find(name, NULL);
  if (found)
    fprintf(stderr,
            "perilat: warning: there is a law `%s` already (%s); decks in this folder that name it "
            "get the new one\n",
            name, found);
  free(found);
}

/* All files or none. */
static bool write_all(new_file *files) {
  bool good = true;
  for (int k = 0; k < FILE_COUNT && good; k++) {
    new_file *f = &files[k];
    if (!f->text) continue;
    FILE *out = fopen(f->path, "wbx"); /* never over what another program has just made */
    f->written = out != NULL;
    good = out && fputs(f->text, out) >= 0;
    if (out) good = fclose(out) == 0 && good;
    if (!good) say_error("cannot write `%s`: %s", f->path, strerror(errno));
  }
  for (int k = 0; k < FILE_COUNT && !good; k++)
    if (files[k].written) unlink(files[k].path);
  return good;
}

static void say_made(const new_file *files, const char *name, const new_kind *kind) {
  const char *plm = files[0].path, *path = files[1].path, *nml = files[2].path;
  printf("written %s, ", plm);
  if (kind->drive) printf("%s, ", path);
  printf("%s\n  perilat check %s\n", nml, plm);
  if (kind->drive) printf("  perilat drive %s\n", path);
  printf("  perilat run %s\n  perilat plot %s.h5 %s\n", nml, name, kind->plot);
}

static int make_new(const char *name, const new_kind *kind) {
  new_file files[FILE_COUNT] = {{.text = fill_in(kind->law, name)},
                                {.text = kind->drive ? fill_in(kind->drive, name) : NULL},
                                {.text = fill_in(kind->deck, name)}};
  static const char *const endings[FILE_COUNT] = {".plm", "_drive.nml", ".nml"};
  for (int k = 0; k < FILE_COUNT; k++)
    snprintf(files[k].path, sizeof files[k].path, "%s%s", name, endings[k]);
  int status = is_law(&files[0], name) && spares_all(files) ? 0 : INPUT_WRONG;
  if (!status) warn_of_hidden(name);
  if (!status && !write_all(files)) status = NEW_FAILED;
  if (!status) say_made(files, name, kind);
  for (int k = 0; k < FILE_COUNT; k++)
    free(files[k].text);
  return status;
}

static const new_kind *find_kind(const char *kind) {
  for (int k = 0; k < KIND_COUNT; k++)
    if (!strcmp(kind, kinds[k].kind)) return &kinds[k];
  say_error("--kind takes central, micropolar, state, continuum or crack, not `%s`", kind);
  return NULL;
}

int command_new(int argc, char **argv) {
  const char *name = NULL, *value;
  const new_kind *kind = &kinds[0];
  int bad = 0;
  for (int at = 0; at < argc && !bad;) {
    if ((value = option_value(argc, argv, &at, "--kind", &bad)))
      bad = bad || !(kind = find_kind(value));
    else if (argv[at][0] == '-')
      bad = option_unknown("new", argv[at]);
    else if (name) {
      say_error("`perilat new` takes one name; `%s` is a second one", argv[at]);
      bad = 1;
    } else
      name = argv[at++];
  }
  if (!bad && !name) {
    say_error("`perilat new` needs a name\n  perilat new my_law");
    bad = 1;
  }
  return bad || !is_name(name) ? INPUT_WRONG : make_new(name, kind);
}
