#define _GNU_SOURCE
#include "generator/grade/handed_in.h"

#include <errno.h>
#include <fcntl.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "dsl/base/hash.h"
#include "generator/kernel/model.h"

/* --- reading ---------------------------------------------------------------------------------- */

/* What is wrong with an open file, or NULL. */
static const char *unfit(int in) {
  struct stat about;
  if (fstat(in, &about) != 0 || !S_ISREG(about.st_mode)) return "it is no ordinary file";
  return (size_t)about.st_size > MODEL_LIMIT ? "it is longer than 1 MB" : NULL;
}

/* No more than the limit, however the file grows. */
static bool read_all(int in, char *text, size_t *length) {
  *length = 0;
  while (*length < MODEL_LIMIT) {
    const ssize_t got = read(in, text + *length, MODEL_LIMIT - *length);
    if (got <= 0) return got == 0;
    *length += (size_t)got;
  }
  return true;
}

handed_text handed_text_read(arena *a, const char *file) {
  handed_text t = {.text = "", .bad = file ? NULL : "there is no answer"};
  const int in = file ? open(file, O_RDONLY | O_NOFOLLOW | O_NONBLOCK | O_CLOEXEC) : -1;
  if (file && in < 0)
    t.bad = errno == ELOOP ? "it is a link, not a file" : "the file can not be read";
  if (!t.bad) t.bad = unfit(in);
  if (!t.bad) {
    char *text = arena_alloc(a, MODEL_LIMIT + 1);
    if (!read_all(in, text, &t.length)) t.bad = "the file can not be read";
    t.text = text;
  }
  if (in >= 0) close(in);
  return t;
}

/* --- what it holds ---------------------------------------------------------------------------- */

static bool is_space(char c) {
  return c == ' ' || c == '\t' || c == '\r' || c == '\n';
}

/* Bytes that no text has, or many that few have. */
static bool is_binary(const handed_text *t) {
  size_t odd = 0;
  for (size_t k = 0; k < t->length; k++) {
    const unsigned char c = (unsigned char)t->text[k];
    if (c == 0) return true;
    odd += (c < ' ' && !is_space(t->text[k])) || c == 0x7f;
  }
  return 10 * odd > t->length;
}

handed_text handed_answer_read(arena *a, const char *file) {
  handed_text t = handed_text_read(a, file);
  size_t first = 0;
  while (first < t.length && is_space(t.text[first]))
    first++;
  if (!t.bad && first == t.length) t.bad = "the file is empty";
  if (!t.bad && is_binary(&t)) t.bad = "it is not a text file";
  return t;
}

/* From `k` on to the end of a comment, or of blanks and comments. */
static size_t behind_blanks(const handed_text *t, size_t k, bool *line_ends) {
  for (bool comment = false; k < t->length; k++) {
    const char c = t->text[k];
    comment = (comment || c == '!') && c != '\n';
    *line_ends = *line_ends || c == '\n';
    if (!comment && !is_space(c)) return k;
  }
  return k;
}

char *handed_text_bare(arena *a, const handed_text *t) {
  char *bare = arena_alloc(a, t->length + 2);
  size_t length = 0;
  bool quoted = false;
  for (size_t k = 0; k < t->length;) {
    const char c = t->text[k];
    if (!quoted && (is_space(c) || c == '!')) {
      bool line_ends = false;
      k = behind_blanks(t, k, &line_ends);
      bare[length++] = line_ends ? '\n' : ' ';
      continue;
    }
    quoted = (c == '"') != quoted && c != '\n';
    bare[length++] = c;
    k++;
  }
  bare[length] = 0;
  return strstr(bare, "include") ? NULL : bare; /* of other texts, which may differ */
}

uint64_t handed_text_seed(const handed_text *t) {
  uint64_t seed = HASH_START;
  for (size_t k = 0; k < t->length; k++)
    if (t->text[k] != '\r') seed = hash_more(seed, &t->text[k], 1);
  return seed;
}
