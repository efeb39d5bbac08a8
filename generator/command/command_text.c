/* perilat format, explain, help: laws and the language as text. */
#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "dsl/base/terminal.h"
#include "dsl/help/help.h"
#include "dsl/print/explain.h"
#include "dsl/print/format.h"
#include "generator/command/commands.h"
#include "generator/drive/drive_grammar.h"
#include "generator/kernel/document.h"
#include "generator/kernel/model.h"
#include "generator/kernel/standard_input.h"
#include "runtime/deck/deck_groups.h"

enum { INPUT_WRONG = 1, ERROR_LENGTH = 1024 };

/* --- format ----------------------------------------------------------------------------------- */

/* Beside the file, then in its place: a reader sees the old text or the new one, whatever
   happens. */
static bool write_in_place(const char *given, const char *text, char *error, size_t size) {
  struct stat about;
  char *path = realpath(given, NULL); /* a link stays a link */
  char *beside = must_calloc(strlen(path ? path : given) + 8, 1);
  sprintf(beside, "%s.XXXXXX", path ? path : given);
  int file = path && stat(path, &about) == 0 ? mkstemp(beside) : -1;
  FILE *out = file >= 0 ? fdopen(file, "wb") : NULL;
  bool good = out && fputs(text, out) >= 0 && fflush(out) == 0 && fsync(file) == 0 &&
              fchmod(file, about.st_mode & 07777) == 0;
  if (out) good = fclose(out) == 0 && good;
  good = good && rename(beside, path) == 0;
  if (!good) {
    snprintf(error, size, "cannot write `%s`: %s", given, strerror(errno));
    if (file >= 0) unlink(beside);
  }
  free(beside);
  free(path);
  return good;
}

typedef enum format_mode { FORMAT_PRINT, FORMAT_CHECK, FORMAT_IN_PLACE } format_mode;

/* 0, or an exit status. */
static int put_formatted(const char *path, const char *before, const char *after,
                         format_mode mode) {
  char error[ERROR_LENGTH];
  bool same = strcmp(before, after) == 0;
  if (mode == FORMAT_PRINT) {
    terminal_expect_data();
    fputs(after, stdout);
  }
  if (mode == FORMAT_CHECK && !same)
    fprintf(stderr, "%s: not laid out as `perilat format` does\n", path);
  if (mode != FORMAT_IN_PLACE) return mode == FORMAT_CHECK && !same ? INPUT_WRONG : 0;
  if (same || write_in_place(path, after, error, sizeof error)) return 0;
  say_error("%s", error);
  return INPUT_WRONG;
}

/* What is formatted in place is a law without errors: a slip is not moved about. */
static bool is_law(const char *path) {
  model m;
  bool good = model_open(&m, path, NULL, 0);
  if (!good) diag_print(&m.said, stderr);
  model_close(&m);
  return good;
}

static int format_file(const char *path, format_mode mode) {
  char error[ERROR_LENGTH];
  size_t length;
  if (mode == FORMAT_IN_PLACE && is_standard_input(path)) {
    say_error("the standard input has no place; leave out -i");
    return INPUT_WRONG;
  }
  if (!file_suits(path, FILES(LAW), "perilat format", "a law") ||
      (mode == FORMAT_IN_PLACE && !is_law(path)))
    return INPUT_WRONG;
  char *text = read_text_file(path, MODEL_LIMIT, &length, error, sizeof error);
  if (!text) {
    say_error("%s", error);
    return INPUT_WRONG;
  }
  source_set sources = {NULL, 0};
  diagnostics said;
  diag_begin(&said, &sources);
  int file = source_add(&sources, path, text, length);
  char *formatted = format_model(&sources, file, &said);
  diag_print(&said, stderr);
  int status = formatted ? put_formatted(path, text, formatted, mode) : INPUT_WRONG;
  free(formatted);
  free(text);
  diag_clear(&said);
  source_clear(&sources);
  return status;
}

int command_format(int argc, char **argv) {
  format_mode mode = FORMAT_PRINT;
  int files = 0, status = 0;
  for (int at = 0; at < argc;) {
    if (option_flag(argv, &at, "--check"))
      mode = FORMAT_CHECK;
    else if (option_flag(argv, &at, "-i"))
      mode = FORMAT_IN_PLACE;
    else if (is_option_like(argv[at]))
      return option_unknown("format", argv[at]);
    else
      argv[files++] = argv[at++];
  }
  if (files == 0) {
    say_error("`perilat format` needs a law");
    return INPUT_WRONG;
  }
  for (int k = 0; k < files; k++)
    if (format_file(argv[k], mode) != 0) status = INPUT_WRONG;
  return status;
}

/* --- explain ---------------------------------------------------------------------------------- */

static int explain_file(const char *path, explain_form form, const law_choice *choices, int count) {
  model m;
  bool good = model_open(&m, path, choices, count);
  diag_print(&m.said, stderr);
  if (good) explain_law(m.law, form, choices, count, stdout);
  model_close(&m);
  return good ? 0 : INPUT_WRONG;
}

/* "option=choice" is cut in two in place. */
static bool read_choice(char *given, law_choice *choice) {
  char *equals = strchr(given, '=');
  if (!equals || equals == given || !equals[1]) {
    say_error("--set chooses an option of the law, option=choice, not `%s`", given);
    return false;
  }
  *equals = 0;
  *choice = (law_choice){given, equals + 1};
  return true;
}

int command_explain(int argc, char **argv) {
  explain_form form = EXPLAIN_MARKDOWN;
  const char *path = NULL, *value;
  law_choice *choices = must_calloc((size_t)argc + 1, sizeof *choices);
  int bad = 0, count = 0;
  for (int at = 0; at < argc && !bad;) {
    if (option_flag(argv, &at, "--latex"))
      form = EXPLAIN_LATEX;
    else if (option_flag(argv, &at, "--markdown"))
      form = EXPLAIN_MARKDOWN;
    else if ((value = option_value(argc, argv, &at, "--set", &bad)))
      bad = bad || !read_choice((char *)(size_t)value, &choices[count++]);
    else if (is_option_like(argv[at]))
      bad = option_unknown("explain", argv[at]);
    else if (path) {
      say_error("`perilat explain` takes one law; `%s` is a second one", argv[at]);
      bad = 1;
    } else
      path = argv[at++];
  }
  if (!bad && !path) {
    say_error("`perilat explain` needs a law");
    bad = 1;
  }
  bad = bad || !file_suits(path, FILES(LAW), "perilat explain", "a law");
  char *found = bad ? NULL : model_find(path, NULL);
  int status = bad ? INPUT_WRONG : explain_file(found ? found : path, form, choices, count);
  free(found);
  free(choices);
  return status;
}

/* --- help ------------------------------------------------------------------------------------- */

static void show_command(int k) {
  printf("%s (a command)\n\n", command_table[k].name);
  command_print(k, stdout);
}

static void show_key(const deck_key_info *key) {
  static const char *const limits[] = {"", ", greater than 0", ", not negative",
                                       ", greater than 0 and at most 1"};
  printf("  %-20s %s", key->name, key->doc ? key->doc : "");
  if (!unit_is_pure(key->unit))
    printf(" (%s%s)", key->unit, limits[key->bound]);
  else if (key->bound)
    printf(" (%s)", limits[key->bound] + 2);
  if (key->choices) printf("; one of %s", key->choices);
  if (key->required)
    fputs("; required", stdout);
  else if (key->fallback)
    printf("; default %s", key->fallback[0] == '=' ? key->fallback + 2 : key->fallback);
  if (key->former) printf("; formerly %s", key->former);
  putchar('\n');
}

static void show_group(const deck_group_info *group, const char *of) {
  printf("&%s (a group of %s)\n\n%s\n\n", group->name, of, group->doc);
  for (int k = 0; k < group->key_count; k++)
    show_key(&group->keys[k]);
}

static int show_topic(const char *topic) {
  int shown = help_show(topic[0] == '&' ? "" : topic, stdout);
  const char *name = topic[0] == '&' ? topic + 1 : topic;
  int group = deck_group_find(name);
  if (group >= 0) {
    if (shown++) putchar('\n');
    show_group(deck_groups[group], "decks");
  }
  const deck_group_info *path = drive_group(name);
  if (path) {
    if (shown++) putchar('\n');
    show_group(path, "paths, read by `perilat drive`");
  }
  for (int k = 0; k < command_count; k++)
    if (strcmp(command_table[k].name, topic) == 0) {
      if (shown++) putchar('\n');
      show_command(k);
    }
  return shown;
}

static void list_names(const char *title, const char *const *names, int count) {
  enum { WIDTH = 100 };
  int column = fprintf(stderr, "  %s:", title);
  for (int k = 0; k < count; k++) {
    if (column + (int)strlen(names[k]) + 1 > WIDTH) column = fprintf(stderr, "\n   ") - 1;
    column += fprintf(stderr, " %s", names[k]);
  }
  fputc('\n', stderr);
}

static int unknown_topic(const char *topic) {
  const int written = help_topic_count(), pages = help_page_count;
  const char **names =
      must_calloc((size_t)(written + DECK_GROUP_COUNT + command_count), sizeof *names);
  help_topics(names);
  int codes = 0;
  while (codes < pages && help_pages[codes].section == HELP_CODES)
    codes++;
  const int groups = deck_group_names(names + written), all = written + groups + command_count;
  for (int k = 0; k < command_count; k++)
    names[written + groups + k] = command_table[k].name;
  const char *near = nearest_name(topic, names, all);
  fprintf(stderr, "perilat: error: there is no help on `%s`", topic);
  fprintf(stderr, near ? "; did you mean `%s`?\n" : "\n", near);
  list_names("commands", names + written + groups, command_count);
  list_names("groups of decks", names + written, groups);
  list_names("words of the language", names + codes, pages - codes);
  list_names("quantities, functions, units", names + pages, written - pages);
  list_names("codes of messages", names, codes);
  free(names);
  return INPUT_WRONG;
}

int command_help(int argc, char **argv) {
  for (int k = 0; k < argc; k++) {
    if (k > 0) putchar('\n');
    if (!show_topic(argv[k])) return unknown_topic(argv[k]);
  }
  return 0; /* main() answers `perilat help` alone */
}
