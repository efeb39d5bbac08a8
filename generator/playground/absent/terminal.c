/* A terminal: what is printed goes to the page as it is. */
#include "dsl/base/terminal.h"

void terminal_begin(void) {}

void terminal_expect_data(void) {}

int terminal_columns(FILE *out) {
  (void)out;
  return 0;
}

bool terminal_is_able(FILE *out) {
  (void)out;
  return false;
}

void terminal_control(FILE *out, const char *sequence) {
  (void)out, (void)sequence;
}

void terminal_paint_with(FILE *out, terminal_paint paint) {
  (void)out, (void)paint;
}

/* Nothing is kept of it. */
void terminal_record_begin(terminal_record *t) {
  static char nothing[1];
  *t = (terminal_record){.texts = {nothing, nothing}};
}

void terminal_record_end(terminal_record *t) {
  (void)t;
}

void terminal_record_show(terminal_record *t) {
  (void)t;
}

void terminal_record_drop(terminal_record *t) {
  (void)t;
}
