#define _GNU_SOURCE /* fopencookie */
#include "dsl/base/terminal.h"

#include <errno.h>
#include <fcntl.h>
#include <stdlib.h>
#include <string.h>
#include <sys/ioctl.h>
#include <unistd.h>

#include "dsl/base/arena.h"
#include "dsl/base/characters.h"

/* --- what gets through ------------------------------------------------------------------------ */

/* A stream that shows what is written to it (characters.h) on a file descriptor. */
typedef struct guard {
  FILE *stream; /* NULL: not begun */
  int descriptor;
  bool open; /* all gets through */
  char begun[4];
  size_t begun_length; /* bytes of a character whose last ones are still to come */
} guard;

static guard guards[] = {{.descriptor = STDOUT_FILENO}, {.descriptor = STDERR_FILENO}};
enum { GUARDS = sizeof guards / sizeof *guards };

static bool write_all(int descriptor, const char *data, size_t size) {
  while (size > 0) {
    const ssize_t n = write(descriptor, data, size);
    if (n < 0 && errno == EINTR) continue;
    if (n < 0) return false;
    data += n;
    size -= (size_t)n;
  }
  return true;
}

/* Bytes at the end of a text that may be the beginning of a character. */
static size_t unfinished(const char *text, size_t length) {
  for (size_t n = 1; n <= 3 && n <= length; n++) {
    const unsigned char byte = (unsigned char)text[length - n];
    if (byte >= 0xC0) return byte >= (n == 1 ? 0xC0 : n == 2 ? 0xE0 : 0xF0) ? n : 0;
    if (byte < 0x80) return 0;
  }
  return 0;
}

enum { PART = 1024 };

/* Of at most PART bytes. */
static bool show_part(int descriptor, const char *text, size_t length) {
  char shown[PART * sizeof((shown_character){0}).text];
  size_t used = 0;
  for (size_t i = 0; i < length;) {
    const size_t plain = characters_plain(text + i, length - i);
    memcpy(shown + used, text + i, plain);
    used += plain;
    i += plain;
    if (i == length) break;
    const shown_character c = character_shown(text + i, length - i);
    used += (size_t)sprintf(shown + used, "%s", c.text);
    i += c.length;
  }
  return write_all(descriptor, shown, used);
}

/* Takes no memory: it also says that there is none. */
static bool show(guard *g, const char *data, size_t size) {
  char text[PART];
  bool good = true;
  while (good && size > 0) {
    const size_t room = sizeof text - g->begun_length, taken = size < room ? size : room;
    size_t length = g->begun_length + taken;
    memcpy(text, g->begun, g->begun_length);
    memcpy(text + g->begun_length, data, taken);
    data += taken;
    size -= taken;
    g->begun_length = unfinished(text, length);
    length -= g->begun_length;
    memcpy(g->begun, text + length, g->begun_length);
    good = show_part(g->descriptor, text, length);
  }
  return good;
}

static ssize_t guarded_write(void *cookie, const char *data, size_t size) {
  guard *g = cookie;
  const bool good = g->open ? write_all(g->descriptor, data, size) : show(g, data, size);
  return good ? (ssize_t)size : 0; /* never -1, fopencookie(3) */
}

static FILE *guarded(guard *g, FILE *plain, int buffering) {
  fflush(plain);
  g->stream = fopencookie(g, "w", (cookie_io_functions_t){.write = guarded_write});
  if (!g->stream) return plain;
  setvbuf(g->stream, NULL, buffering, buffering == _IONBF ? 0 : BUFSIZ);
  return g->stream;
}

/* A stream that the shell has closed stays useless, but its number is taken: otherwise the next
   file would get it, and what is said would be written into that file. */
static void take_closed_descriptors(void) {
  for (int k = STDIN_FILENO; k <= STDERR_FILENO; k++)
    if (fcntl(k, F_GETFD) < 0) (void)open("/dev/null", k == STDIN_FILENO ? O_WRONLY : O_RDONLY);
}

/* The GNU C library lets a program set its streams. */
void terminal_begin(void) {
  if (guards[0].stream) return;
  take_closed_descriptors();
  stdout = guarded(&guards[0], stdout, isatty(STDOUT_FILENO) ? _IOLBF : _IOFBF);
  stderr = guarded(&guards[1], stderr, _IONBF);
}

void terminal_expect_data(void) {
  fflush(stdout);
  guards[0].open = !isatty(STDOUT_FILENO);
}

/* --- what is kept ----------------------------------------------------------------------------- */

void terminal_record_begin(terminal_record *t) {
  *t = (terminal_record){.streams = {stdout, stderr}};
  stdout = must_open_text(&t->texts[0], &t->lengths[0]);
  stderr = must_open_text(&t->texts[1], &t->lengths[1]);
}

void terminal_record_end(terminal_record *t) {
  must_close_text(stdout);
  must_close_text(stderr);
  stdout = t->streams[0];
  stderr = t->streams[1];
}

void terminal_record_show(terminal_record *t) {
  fputs(t->texts[0], stdout);
  fflush(stdout);
  fputs(t->texts[1], stderr);
  terminal_record_drop(t);
}

void terminal_record_drop(terminal_record *t) {
  free(t->texts[0]);
  free(t->texts[1]);
}

/* --- what the terminal is --------------------------------------------------------------------- */

static int descriptor_of(FILE *out) {
  for (int k = 0; k < GUARDS; k++)
    if (out == guards[k].stream) return guards[k].descriptor;
  return fileno(out);
}

int terminal_columns(FILE *out) {
  enum { USUAL = 80 };
  const int descriptor = descriptor_of(out);
  if (!isatty(descriptor)) return 0;
  const char *set = getenv("COLUMNS");
  const long columns = set ? strtol(set, NULL, 10) : 0;
  if (columns > 0 && columns < 10000) return (int)columns;
  struct winsize size;
  return ioctl(descriptor, TIOCGWINSZ, &size) == 0 && size.ws_col > 0 ? size.ws_col : USUAL;
}

bool terminal_is_able(FILE *out) {
  const char *kind = getenv("TERM");
  return isatty(descriptor_of(out)) && kind && *kind && strcmp(kind, "dumb") != 0;
}

/* --- own sequences ---------------------------------------------------------------------------- */

void terminal_control(FILE *out, const char *sequence) {
  guard *g = NULL;
  for (int k = 0; k < GUARDS; k++)
    if (out == guards[k].stream) g = &guards[k];
  if (!g) {
    fputs(sequence, out);
    return;
  }
  fflush(out);
  const bool open = g->open;
  g->open = true;
  fputs(sequence, out);
  fflush(out);
  g->open = open;
}

void terminal_paint_with(FILE *out, terminal_paint paint) {
  static const char *const sequences[] = {
#define X(what, sequence) sequence,
      TERMINAL_PAINTS(X)
#undef X
  };
  const char *forbidden = getenv("NO_COLOR");
  if (terminal_is_able(out) && !(forbidden && *forbidden)) terminal_control(out, sequences[paint]);
}
