/* Completion for bash, zsh and fish. A value is FILE, a list of words with | between, or free. */
#include "generator/command/completion.h"

#include <errno.h>
#include <stdbool.h>
#include <stdio.h>
#include <string.h>

#include "generator/command/commands.h"
#include "generator/kernel/document.h"

enum { WRITE_FAILED = 2 };

static bool is_file_value(const char *value) {
  return strcmp(value, "FILE") == 0;
}

/* What stands for something else is in capitals (N, TEXT) or an assignment; words to choose from
   are in small letters. */
static bool is_choice(const char *value) {
  return *value >= 'a' && *value <= 'z' && !strchr(value, '=');
}

/* `a|b` as `a b`. */
static void put_words(FILE *out, const char *words) {
  for (; *words; words++)
    fputc(*words == '|' ? ' ' : *words, out);
}

/* Inside single quotes; `special` characters get a backslash. */
static void put_quoted(FILE *out, const char *text, const char *special) {
  for (; *text; text++) {
    if (*text == '\'')
      fputs("'\\''", out);
    else
      fprintf(out, "%s%c", strchr(special, *text) ? "\\" : "", *text);
  }
}

static bool is_of(const option_entry *o, int command) {
  return strcmp(o->command, command_table[command].name) == 0;
}

static void put_command_names(FILE *out) {
  for (int k = 0; k < command_count; k++)
    fprintf(out, "%s ", command_table[k].name);
}

/* --- bash ------------------------------------------------------------------------------------- */

static const char bash_begin[] =
    "# bash completion for perilat, made from its table of commands\n"
    "_perilat_files() {\n"
    "  local ending IFS=$'\\n'\n"
    "  compopt -o filenames 2>/dev/null\n"
    "  COMPREPLY=($(compgen -d -- \"$cur\"))\n"
    "  for ending; do COMPREPLY+=($(compgen -f -X \"!*.$ending\" -- \"$cur\")); done\n"
    "}\n\n"
    "_perilat() {\n"
    "  local cur=${COMP_WORDS[COMP_CWORD]} prev=${COMP_WORDS[COMP_CWORD-1]} "
    "command=${COMP_WORDS[1]}\n"
    "  COMPREPLY=()\n"
    "  if [ \"$cur\" = = ]; then cur=; elif [ \"$prev\" = = ]; then "
    "prev=${COMP_WORDS[COMP_CWORD-2]}; fi\n";

static void bash_values(FILE *out) {
  fputs("  case \"$command $prev\" in\n", out);
  for (int o = 0; o < option_count; o++) {
    const option_entry *e = &option_table[o];
    if (!*e->value || strcmp(e->command, "solver") == 0) continue;
    fprintf(out, "    \"%s %s\")", e->command, e->name);
    if (is_file_value(e->value))
      fputs(" local IFS=$'\\n'; compopt -o filenames 2>/dev/null; COMPREPLY=($(compgen -f -- "
            "\"$cur\"));",
            out);
    else if (is_choice(e->value)) {
      fputs(" COMPREPLY=($(compgen -W \"", out);
      put_words(out, e->value);
      fputs("\" -- \"$cur\"));", out);
    }
    fputs(" return ;;\n", out);
  }
  fputs("  esac\n", out);
}

static void write_bash(FILE *out) {
  fputs(bash_begin, out);
  fputs("  if [ \"$COMP_CWORD\" -eq 1 ]; then COMPREPLY=($(compgen -W \"", out);
  put_command_names(out);
  fputs("--help --version\" -- \"$cur\")); return; fi\n", out);
  bash_values(out);
  fputs("  case \"$command $cur\" in\n", out);
  for (int k = 0; k < command_count; k++) {
    fprintf(out, "    \"%s -\"*) COMPREPLY=($(compgen -W \"", command_table[k].name);
    for (int o = 0; o < option_count; o++)
      if (is_of(&option_table[o], k)) fprintf(out, "%s ", option_table[o].name);
    fputs("--help\" -- \"$cur\")) ;;\n", out);
  }
  for (int k = 0; k < command_count; k++)
    if (*command_table[k].endings)
      fprintf(out, "    \"%s \"*) _perilat_files %s ;;\n", command_table[k].name,
              command_table[k].endings);
  fputs("    \"help \"*) COMPREPLY=($(compgen -W \"", out);
  put_command_names(out);
  fputs("\" -- \"$cur\")) ;;\n  esac\n}\ncomplete -F _perilat perilat\n", out);
}

/* --- zsh -------------------------------------------------------------------------------------- */

static void zsh_option(FILE *out, const option_entry *e) {
  fprintf(out, " \\\n        '*%s%s[", e->name, *e->value && e->name[1] == '-' ? "=" : "");
  put_quoted(out, e->meaning, "[]:\\");
  fputc(']', out);
  if (*e->value) {
    fputc(':', out);
    put_quoted(out, is_choice(e->value) ? "choice" : e->value, ":\\");
    fputc(':', out);
    if (is_file_value(e->value))
      fputs("_files", out);
    else if (is_choice(e->value)) {
      fputc('(', out);
      put_words(out, e->value);
      fputc(')', out);
    } else
      fputc(' ', out);
  }
  fputc('\'', out);
}

static void zsh_command(FILE *out, int k) {
  const command_entry *c = &command_table[k];
  fprintf(out, "    %s)\n      _arguments '--help[usage and options]'", c->name);
  for (int o = 0; o < option_count; o++)
    if (is_of(&option_table[o], k)) zsh_option(out, &option_table[o]);
  if (*c->endings) {
    fputs(" \\\n        '*:file:_files -g \"*.(", out);
    for (const char *at = c->endings; *at; at++)
      fputc(*at == ' ' ? '|' : *at, out);
    fputs(")\"'", out);
  }
  if (strcmp(c->name, "help") == 0) {
    fputs(" \\\n        '1:topic:(", out);
    put_command_names(out);
    fputs(")'", out);
  }
  fputs(" ;;\n", out);
}

static void write_zsh(FILE *out) {
  fputs("#compdef perilat\n# zsh completion for perilat, made from its table of commands\n"
        "_perilat() {\n  local -a commands\n  commands=(\n",
        out);
  for (int k = 0; k < command_count; k++) {
    fprintf(out, "    '%s:", command_table[k].name);
    put_quoted(out, command_table[k].purpose, ":\\");
    fputs("'\n", out);
  }
  fputs("  )\n  if (( CURRENT == 2 )); then\n    _describe command commands\n    return\n  fi\n"
        "  shift words\n  (( CURRENT-- ))\n  case $words[1] in\n",
        out);
  for (int k = 0; k < command_count; k++)
    zsh_command(out, k);
  fputs("  esac\n}\n_perilat \"$@\"\n", out);
}

/* --- fish ------------------------------------------------------------------------------------- */

/* fish knows \' and \\ in single quotes. */
static void fish_text(FILE *out, const char *text) {
  fputc('\'', out);
  for (; *text; text++)
    fprintf(out, "%s%c", *text == '\'' || *text == '\\' ? "\\" : "", *text);
  fputc('\'', out);
}

static void fish_option(FILE *out, const option_entry *e) {
  bool is_long = e->name[1] == '-';
  fprintf(out, "complete -c perilat -n '__fish_seen_subcommand_from %s' -%c %s", e->command,
          is_long ? 'l' : 's', e->name + (is_long ? 2 : 1));
  if (is_file_value(e->value))
    fputs(" -r -F", out);
  else if (*e->value)
    fputs(" -x", out);
  if (is_choice(e->value)) {
    fputs(" -a '", out);
    put_words(out, e->value);
    fputc('\'', out);
  }
  fputs(" -d ", out);
  fish_text(out, e->meaning);
  fputc('\n', out);
}

static void fish_files(FILE *out, const command_entry *c) {
  char endings[64], *rest = endings;
  snprintf(endings, sizeof endings, "%s", c->endings);
  for (char *ending = strtok_r(endings, " ", &rest); ending; ending = strtok_r(NULL, " ", &rest))
    fprintf(out,
            "complete -c perilat -n '__fish_seen_subcommand_from %s' -a '(__fish_complete_suffix "
            ".%s)'\n",
            c->name, ending);
}

static void write_fish(FILE *out) {
  fputs("# fish completion for perilat, made from its table of commands\ncomplete -c perilat -f\n",
        out);
  for (int k = 0; k < command_count; k++) {
    fprintf(out, "complete -c perilat -n __fish_use_subcommand -a %s -d ", command_table[k].name);
    fish_text(out, command_table[k].purpose);
    fputc('\n', out);
    fish_files(out, &command_table[k]);
  }
  for (int o = 0; o < option_count; o++)
    if (strcmp(option_table[o].command, "solver") != 0) fish_option(out, &option_table[o]);
  fputs("complete -c perilat -n '__fish_seen_subcommand_from help' -a '", out);
  put_command_names(out);
  fputs("'\n", out);
}

int completion_write(const char *folder) {
  static const struct {
    const char *name;
    void (*write)(FILE *out);
  } files[] = {{"perilat.bash", write_bash}, {"_perilat", write_zsh}, {"perilat.fish", write_fish}};
  for (size_t k = 0; k < sizeof files / sizeof *files; k++) {
    char path[4096];
    snprintf(path, sizeof path, "%s/%s", folder, files[k].name);
    FILE *out = fopen(path, "w");
    if (out) files[k].write(out);
    bool good = out && !ferror(out);
    if (out) good = fclose(out) == 0 && good;
    if (!good) {
      say_error("cannot write `%s`: %s", path, strerror(errno));
      return WRITE_FAILED;
    }
  }
  return 0;
}
