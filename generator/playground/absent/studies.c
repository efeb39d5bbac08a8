/* Many runs in processes of their own. */
#include "generator/kernel/document.h"
#include "generator/study/study.h"

int study_run(study_request *r, json *w) {
  (void)r, (void)w;
  say_error("there are no studies in the playground");
  return 1;
}

bool study_is_alone(const char *path) {
  (void)path;
  return false;
}

bool study_refuse(const char *command, const char *path) {
  (void)command, (void)path;
  return false;
}

void study_request_begin(study_request *r) {
  (void)r;
}

void study_request_end(study_request *r) {
  (void)r;
}

study_text study_option(study_request *r, const char *option, const char *text) {
  (void)r, (void)option;
  return (study_text){.text = text};
}

void study_list_add(study_request *r, study_list *list, study_text text) {
  (void)r, (void)list, (void)text;
}
