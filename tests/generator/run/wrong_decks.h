/* A deck that is right, wrong in one place at a time, and the exact text that a user sees of each:
   a folder holds the deck, and a text for each fault. */
#ifndef PERILAT_TESTS_WRONG_DECKS_H
#define PERILAT_TESTS_WRONG_DECKS_H

#include "tests/generator/command_tools.h"

typedef struct fault {
  const char *name, *right, *wrong;
  bool warns; /* the deck runs all the same */
} fault;

/* malloc'ed; NULL where there is none. */
static inline char *fault_text(const char *folder, const char *name, const char *ending) {
  char path[400];
  snprintf(path, sizeof path, "%s/%s%s", folder, name, ending);
  FILE *in = fopen(path, "rb");
  if (!in) return NULL;
  char *text = calloc(SAID_SIZE, 1);
  assert_non_null(text);
  assert_true(fread(text, 1, SAID_SIZE - 1, in) < SAID_SIZE - 1);
  fclose(in);
  return text;
}

/* The deck with one part of it replaced. */
static inline void write_wrong(const workplace *w, const char *name, const char *deck,
                               const fault *f) {
  const char *at = strstr(deck, f->right);
  char text[SAID_SIZE];
  assert_non_null(at);
  snprintf(text, sizeof text, "%.*s%s%s", (int)(at - deck), deck, f->wrong, at + strlen(f->right));
  write_text(w, name, text);
}

/* Files of the source folder, such as laws that come along, without that folder. */
static inline void drop_source_folder(char *said) {
  const size_t length = strlen(SOURCE_DIR "/");
  for (char *at = said; (at = strstr(at, SOURCE_DIR "/"));)
    memmove(at, at + length, strlen(at + length) + 1);
}

static inline bool is_as_expected(const char *folder, const fault *f, const char *said) {
  if (getenv("PERILAT_BLESS")) {
    char path[400];
    snprintf(path, sizeof path, "%s/%s.txt", folder, f->name);
    FILE *out = fopen(path, "wb");
    assert_non_null(out);
    fputs(said, out);
    fclose(out);
  }
  char *expected = fault_text(folder, f->name, ".txt");
  const bool same = expected && strcmp(expected, said) == 0;
  if (!same)
    print_message("%s/%s.txt\n--- expected\n%s--- got\n%s", folder, f->name,
                  expected ? expected : "(no file)\n", said);
  free(expected);
  return same;
}

/* `name`: of the deck in the folder, as messages call it. */
static inline void check_faults(workplace *w, const char *folder, const char *name,
                                const fault *faults, int count) {
  char *deck = fault_text(folder, name, "");
  int different = 0;
  assert_non_null(deck);
  for (int k = 0; k < count; k++) {
    write_wrong(w, name, deck, &faults[k]);
    assert_int_equal(shell(w, "$P check %s 2>&1 >/dev/null", name), faults[k].warns ? 0 : 1);
    drop_source_folder(w->said);
    different += !is_as_expected(folder, &faults[k], w->said);
  }
  free(deck);
  assert_int_equal(different, 0);
}

#endif
