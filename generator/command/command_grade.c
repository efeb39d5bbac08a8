/* perilat grade: answers to an exercise, marked in words. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "dsl/base/units.h"
#include "generator/command/commands.h"
#include "generator/grade/grade.h"
#include "generator/kernel/document.h"

enum { WRONG = 1 };
static const char example[] = "perilat grade EXERCISE answer.plm";

/* "20 s", "500 ms", "20". */
static bool read_time(const char *text, double *seconds) {
  char *end;
  const double number = strtod(text, &end);
  end += strspn(end, " ");
  const double factor = !*end || strcmp(end, "s") == 0 ? 1
                        : strcmp(end, "ms") == 0       ? 1e-3
                        : strcmp(end, "min") == 0      ? 60
                                                       : 0;
  *seconds = number * factor;
  if (*seconds > 0 && *seconds < 1e6) return true;
  say_error("--time takes a time such as '20 s', not `%s`", text);
  return false;
}

/* "2GB", "500 MB". */
static bool read_memory(const char *text, size_t *bytes) {
  char *end;
  const double number = strtod(text, &end);
  end += strspn(end, " ");
  const double factor = strcmp(end, "GB") == 0 ? 1e9 : strcmp(end, "MB") == 0 ? 1e6 : 0;
  const double size = number * factor;
  *bytes = size > 0 && size < 1e15 ? (size_t)size : 0;
  if (*bytes >= 100000000) return true;
  say_error("--memory takes 100MB or more, such as 2GB, not `%s`", text);
  return false;
}

static bool read_seed(const char *text, grade_options *o) {
  char *end;
  o->seed = strtoull(text, &end, 10);
  o->seeded = *text >= '0' && *text <= '9' && !*end;
  if (!o->seeded) say_error("--seed takes a whole number, not `%s`", text);
  return o->seeded;
}

static bool take_place(grade_options *o, const char *given) {
  const char **slot = !o->exercise ? &o->exercise : !o->answer ? &o->answer : NULL;
  if (!slot) {
    say_error("`perilat grade` takes an exercise and an answer or a class; `%s` is a third", given);
    return false;
  }
  *slot = given;
  return true;
}

static bool read_one(int argc, char **argv, int *at, grade_options *o, int *bad) {
  const char *value;
  if (option_flag(argv, at, "--public"))
    o->only_public = true;
  else if (option_flag(argv, at, "--json"))
    o->json = true;
  else if (option_flag(argv, at, "--self-test"))
    o->self_test = true;
  else if ((value = option_value(argc, argv, at, "--csv", bad)))
    o->csv = value;
  else if ((value = option_value(argc, argv, at, "--junit", bad)))
    o->junit = value;
  else if ((value = option_value(argc, argv, at, "--html", bad)))
    o->html = value;
  else if ((value = option_value(argc, argv, at, "--publish", bad)))
    o->publish = value;
  else if ((value = option_value(argc, argv, at, "--seed", bad)))
    return read_seed(value, o);
  else if ((value = option_value(argc, argv, at, "--time", bad)))
    return read_time(value, &o->limits.seconds);
  else if ((value = option_value(argc, argv, at, "--memory", bad)))
    return read_memory(value, &o->limits.memory);
  else if (argv[*at][0] == '-')
    return !option_unknown("grade", argv[*at]);
  else
    return take_place(o, argv[(*at)++]);
  return true;
}

/* Which of the three things is asked for? */
static bool is_complete(const grade_options *o) {
  const int asked = (o->answer != NULL) + o->self_test + (o->publish != NULL);
  if (!o->exercise)
    say_error("`perilat grade` needs an exercise\n  %s", example);
  else if (asked == 0)
    say_error("`perilat grade` needs an answer or a class, --self-test or --publish FOLDER\n  %s",
              example);
  else if (asked > 1)
    say_error("answers, --self-test and --publish are asked for one at a time");
  else if (!o->answer && (o->csv || o->junit || o->html))
    say_error("--csv, --junit and --html are of answers");
  else
    return true;
  return false;
}

int command_grade(int argc, char **argv) {
  grade_options o = {.limits = {.seconds = 20, .memory = 2000000000, .file = 256000000}};
  int bad = 0;
  for (int at = 0; at < argc && !bad;)
    if (!read_one(argc, argv, &at, &o, &bad)) bad = 1;
  return !bad && is_complete(&o) ? grade(&o) : WRONG;
}
