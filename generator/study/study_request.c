#include "generator/study/study_request.h"

#include <stdlib.h>
#include <string.h>

#include "generator/kernel/document.h"
#include "generator/kernel/model.h"
#include "generator/run/run.h"
#include "runtime/deck/deck_read.h"
#include "runtime/deck/group_run.h"

void study_request_begin(study_request *r) {
  *r = (study_request){.memory = arena_new()};
  diag_begin(&r->said, &r->sources);
}

void study_request_end(study_request *r) {
  diag_clear(&r->said);
  source_clear(&r->sources);
  arena_free(r->memory);
}

study_text study_option(study_request *r, const char *option, const char *text) {
  const int file = source_add(&r->sources, option, text, strlen(text));
  return (study_text){text, source_whole(&r->sources, file)};
}

const char *study_word(const study_request *r, const char *name) {
  return r->grouped ? arena_printf(r->memory, "`%s`", name)
                    : arena_printf(r->memory, "%s%s", name[1] ? "--" : "-", name);
}

const char *study_written(const study_request *r, const char *name, const char *value) {
  const char *quote = r->grouped || strchr(value, ' ') ? r->grouped ? "'" : "\"" : "";
  return arena_printf(r->memory, "%s%s%s%s%s%s",
                      r->grouped ? ""
                      : name[1]  ? "--"
                                 : "-",
                      name, r->grouped ? " = " : " ", quote, value, quote);
}

void study_list_add(study_request *r, study_list *list, study_text text) {
  list->items = arena_room(r->memory, list->items, list->count, sizeof *list->items);
  list->items[list->count++] = text;
}

/* --- &study ----------------------------------------------------------------------------------- */

static void take_list(study_request *r, study_list *list, const deck_texts *from) {
  for (int k = 0; k < from->count; k++)
    study_list_add(r, list, (study_text){from->items[k], from->where[k]});
}

/* Files beside the one that names them. */
static void take_files(study_request *r, study_list *list, const deck_texts *from) {
  for (int k = 0; k < from->count; k++) {
    char *path = deck_file_path(r->files[0], from->items[k]);
    study_list_add(r, list,
                   (study_text){arena_text(r->memory, path, strlen(path)), from->where[k]});
    free(path);
  }
}

/* Behind the opening quote. */
static study_text text_of(const deck_study *s, const char *key, const char *text) {
  span where = deck_where(&s->item, key);
  where.begin++;
  return (study_text){text, text ? where : (span){0, 0, 0}};
}

/* The command's own come behind, where the last one counts. */
static void take_settings(study_request *r, const deck_study *s) {
  const study_list own = r->set;
  r->set = (study_list){NULL, 0};
  take_list(r, &r->set, &s->set);
  for (int k = 0; k < own.count; k++)
    study_list_add(r, &r->set, own.items[k]);
}

/* What the options ask for the group does not. */
static void take_question(study_request *r, const deck_study *s) {
  const bool scans = r->strength.text || r->fit.count, varies = r->vary.count > 0;
  if (!varies && !scans) take_list(r, &r->vary, &s->vary);
  if (varies || scans || r->converge.text) return;
  r->converge = text_of(s, "converge", s->converge);
  r->strength = text_of(s, "strength", s->strength);
  take_list(r, &r->fit, &s->fit);
}

static void take_group(study_request *r, const deck_study *s) {
  deck_study *o = &r->o;
  if (!r->decks.count) take_files(r, &r->decks, &s->decks);
  take_question(r, s);
  take_settings(r, s);
  if (!r->to.count) take_files(r, &r->to, &s->to);
  if (!o->x) o->x = s->x;
  if (!o->y) o->y = s->y;
  if (!o->result) o->result = s->result;
  if (!o->jobs) o->jobs = s->jobs;
  if (!o->of) o->of = s->of;
  if (!o->watch) o->watch = s->watch;
  if (!o->search) o->search = s->search;
  if (!o->runs) o->runs = s->runs;
  if (!o->twin && s->twin) {
    char *path = deck_file_path(r->files[0], s->twin);
    o->twin = arena_text(r->memory, path, strlen(path));
    free(path);
  }
  if (!o->weight_count) {
    o->weights = s->weights;
    o->weight_count = s->weight_count;
  }
  o->growth = s->growth;
  o->limit = s->limit;
  o->longest = s->longest;
}

static const deck_study *read_study(study_request *r, bool *whole) {
  char error[4096];
  size_t length;
  char *text = read_text_file(r->files[0], DECK_LIMIT, &length, error, sizeof error);
  if (!text) {
    diag_report(&r->said, DIAG_FILE, (span){0, 0, UINT16_MAX}, "%s", error);
    return NULL;
  }
  const int file = source_add(&r->sources, r->files[0], text, length);
  free(text);
  return deck_read_study(r->memory, &r->sources, file, whole, &r->said);
}

/* --- what goes together ----------------------------------------------------------------------- */

static bool refuse(study_request *r, span where, const char *sentence, const char *hint) {
  diag_report(&r->said, DIAG_CONFLICT, where, "%s", sentence);
  diag_hint(&r->said, "%s", hint);
  return false;
}

static bool refuse_of(study_request *r, span where, const char *before, const char *name,
                      const char *behind, const char *hint) {
  return refuse(r, where, arena_printf(r->memory, "%s%s%s", before, study_word(r, name), behind),
                hint);
}

/* One of the words that the group's table lists. */
static bool is_choice(study_request *r, const char *key, const char *word) {
  const int at = deck_key_find(&deck_group_study, key);
  const char *words[16];
  const int count = deck_choices(r->memory, deck_group_study.keys[at].choices, words, 16);
  for (int k = 0; k < count; k++)
    if (strcmp(words[k], word) == 0) return true;
  const study_text given = study_option(r, arena_printf(r->memory, "--%s", key), word);
  diag_report(&r->said, DIAG_BAD_VALUE, given.where, "--%s takes %s, not `%s`", key,
              deck_group_study.keys[at].choices, word);
  return false;
}

static const char *base_of(const char *path) {
  const char *slash = strrchr(path, '/');
  return slash ? slash + 1 : path;
}

/* Cases are named after their decks. */
static bool names_differ(study_request *r) {
  for (int k = 0; k < r->decks.count; k++)
    for (int other = 0; other < k; other++)
      if (strcmp(base_of(r->decks.items[k].text), base_of(r->decks.items[other].text)) == 0)
        return refuse(r, r->decks.items[k].where, "two of the decks have the same name",
                      "give each file a name of its own");
  return true;
}

/* Measured curves and what goes with them. */
static bool curves_fit(study_request *r) {
  const bool fits = r->fit.count > 0;
  const span whole = r->group;
  if (!fits && (r->to.count || r->o.weight_count))
    return refuse_of(r, r->to.count ? r->to.items[0].where : whole,
                     "measured curves and weights belong to ", "fit", "", "leave them out");
  if (!fits && r->decks.count > 1)
    return refuse_of(r, r->decks.items[1].where, "only ", "fit", " takes several decks",
                     "make a study of each");
  if (fits && r->to.count != r->decks.count)
    return refuse_of(
        r, r->to.count ? r->to.items[0].where : r->fit.items[0].where, "", "fit",
        " needs one measured curve for each deck",
        arena_printf(r->memory, "%s, as many as decks", study_written(r, "to", "lab.csv")));
  if (fits && r->o.weight_count && r->o.weight_count != r->decks.count)
    return refuse_of(r, whole, "as many weights as decks are needed: one for each ", "to", "",
                     r->grouped ? "weight = 1, 0.5" : "--weight 1 --weight 0.5");
  return true;
}

/* One question, with what belongs to it. */
static bool is_sensible(study_request *r) {
  const bool fits = r->fit.count > 0, scans = r->strength.text != NULL;
  const span whole = r->group;
  if (fits + scans + (r->converge.text != NULL) > 1)
    return refuse(r, whole,
                  arena_printf(r->memory, "%s, %s and %s are three questions",
                               study_word(r, "converge"), study_word(r, "strength"),
                               study_word(r, "fit")),
                  "make a study of each");
  if (!r->vary.count && !scans && !fits)
    return refuse(r, r->converge.text ? r->converge.where : whole, "nothing is varied",
                  arena_printf(r->memory, "say what: %s; or %s, %s",
                               study_written(r, "vary", "lattice.spacing=20,10,5 mm"),
                               study_word(r, "strength"), study_word(r, "fit")));
  if (r->vary.count && (fits || scans))
    return refuse(r, r->vary.items[0].where,
                  arena_printf(r->memory, "%s goes with %s, or stands by itself",
                               study_word(r, "vary"), study_word(r, "converge")),
                  arena_printf(r->memory, "give it another value for all runs with %s",
                               study_word(r, "set")));
  if (!scans && r->o.twin)
    return refuse_of(r, whole, "a twin belongs to ", "strength", "", "leave it out");
  return curves_fit(r) && names_differ(r) && is_choice(r, "of", r->o.of) &&
         is_choice(r, "search", r->o.search);
}

bool study_request_complete(study_request *r) {
  bool whole = false;
  const deck_study *s = read_study(r, &whole);
  if (!s) return false;
  const bool names_decks = r->file_count == 1 && s->decks.count > 0;
  for (int k = 0; k < r->file_count && !names_decks; k++)
    study_list_add(r, &r->decks, study_option(r, "perilat study", r->files[k]));
  r->grouped = s->item.key_count > 0 &&
               !(r->vary.count || r->fit.count || r->strength.text || r->converge.text);
  r->group = r->grouped ? s->item.where : (span){0, 0, UINT16_MAX};
  take_group(r, s);
  if (!whole && s->decks.count == 0)
    return refuse(r, s->item.where, "this file holds no deck, and names none",
                  "&study deck = 'beam.nml' ... /");
  return is_sensible(r);
}

void study_warn(study_request *r) {
  diag_print(&r->said, stderr);
  diag_clear(&r->said);
  diag_begin(&r->said, &r->sources);
}

bool study_is_alone(const char *path) {
  study_request r;
  bool whole = true;
  study_request_begin(&r);
  r.files = &path;
  const deck_study *s = kind_of_file(path) == FILE_DECK ? read_study(&r, &whole) : NULL;
  const bool alone = s && !whole && s->item.key_count > 0;
  study_request_end(&r);
  return alone;
}

bool study_refuse(const char *command, const char *path) {
  if (!study_is_alone(path)) return false;
  say_error("`%s` is a study of a deck that it names, not a deck for `perilat %s`\n"
            "  perilat study %s",
            path, command, path);
  return true;
}

const char *study_name(study_request *r) {
  const char *given = r->o.result ? r->o.result : r->files[0];
  const char *slash = strrchr(given, '/'), *name = !r->o.result && slash ? slash + 1 : given;
  const char *base = strrchr(name, '/'), *dot = strrchr(base ? base : name, '.');
  const size_t length = !r->o.result && dot ? (size_t)(dot - name) : strlen(name);
  const char *end = "_study";
  const bool named = r->o.result || (length >= strlen(end) &&
                                     strncmp(name + length - strlen(end), end, strlen(end)) == 0);
  return arena_printf(r->memory, "%.*s%s", (int)length, name, named ? "" : end);
}
