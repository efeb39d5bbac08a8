/* Grammar of a model file: a list of lines. What may stand where among the lines (model first, end
   last, one law) is checked by lines.c, so that each slip gets its own message. */
%define api.pure full
%define api.prefix {model_}
%define api.token.prefix {T_}
%define api.location.type {span}
%define parse.error custom
%define parse.lac full
%locations
%param {parsing *p}
%expect 0

%code requires {
#include "dsl/syntax/parsing.h"
}

%code provides {
/* Reads the text of p->file to its end, with the texts that it includes. */
void parser_read(parsing *p);
}

%union {
  double number;
  word word;
  words *words;
  expr *expr;
  stmt *stmt;
  bounds bounds;
  bool flag;
  binary_op binary;
}

%code {
#include "dsl/syntax/includes.h"
#include "dsl/syntax/lexer.h"
#include "dsl/syntax/lines.h"
#include "dsl/syntax/syntax_error.h"
#include "dsl/syntax/tree_build.h"

#define YYLLOC_DEFAULT(Current, Rhs, N)                                                            \
  do {                                                                                             \
    (Current) = (N) ? span_join(YYRHSLOC(Rhs, 1), YYRHSLOC(Rhs, N))                                \
                    : (span){YYRHSLOC(Rhs, 0).end, YYRHSLOC(Rhs, 0).end, p->file};                 \
  } while (0)

static void model_error(span *where, parsing *p, const char *message);
static void read_included(parsing *p, const stmt *s);

static const word no_word;
}

%initial-action { @$ = (span){0, 0, p->file}; }

%token NEWLINE
%token MODEL END LAW FOR PARAMETER CONSTANT OPTION STATE DAMAGE FUNCTION FORCE MOMENT ENERGY STRESS
%token STRAIN YIELD FLOW OUTPUT NONCONSERVATIVE INCLUDE CRACK GROW TOWARD SPEED FAILED
%token REQUIRE ACCEPT REST RATE FIELD
%token EXPRESSION /* begins one that stands by itself: no text has it */
%token WHEN OTHERWISE JUMP IN AND OR NOT BY ALONG RETURNED ON
%token EQ NE LE GE POW HOLE
%token <number> NUMBER
%token <word> NAME PRIMED UNIT STRING

%type <stmt> only_text declaration parameter field flow rule rate rest
%type <expr> default body cases case_lines call arguments
%type <expr> expression conjunction negation comparison sum addend term factor power primary
%type <word> text unit index on along late_word
%type <words> names choices
%type <bounds> interval
%type <flag> opening closing jump
%type <binary> relation

%%

lines:
  %empty
| lines line
;

line:
  NEWLINE
| MODEL NAME NEWLINE                { line_model(p, $2); }
| END NEWLINE                       { line_end(p, no_word, no_word, @1); }
| END NAME NEWLINE                  { line_end(p, $2, no_word, span_join(@1, @2)); }
| END NAME NAME NEWLINE             { line_end(p, $2, $3, span_join(@1, @3)); }
| LAW NAME NEWLINE                  { line_law(p, $2, no_word, @2); }
| LAW NAME NAME NEWLINE             { line_law(p, $2, $3, span_join(@2, @3)); }
| CRACK NEWLINE                     { line_crack(p, @1); }
| FOR names NEWLINE                 { line_settings(p, $2, @2); }
| declaration text NEWLINE          { line_statement(p, $1, $2, span_join(@1, @2)); }
| only_text STRING NEWLINE          { if (line_statement(p, $1, $2, span_join(@1, @2)))
                                        read_included(p, $1); }
| EXPRESSION body NEWLINE           { p->expression = $2; }
| error NEWLINE                     { line_broken(p); yyerrok; }
;

only_text:
  NONCONSERVATIVE                   { $$ = build_stmt(p, STMT_NONCONSERVATIVE, no_word, no_word,
                                                      NULL, @1); }
| ACCEPT NAME                       { $$ = build_stmt(p, STMT_ACCEPT, $2, no_word, NULL, @$); }
| INCLUDE                           { $$ = build_stmt(p, STMT_INCLUDE, no_word, no_word,
                                                      NULL, @1); }
;

declaration:
  parameter
| parameter IN interval             { $$ = $1; $$->in = $3; }
| field
| field IN interval                 { $$ = $1; $$->in = $3; }
| CONSTANT NAME index '=' body      { $$ = build_stmt(p, STMT_CONSTANT, $2, $3, $5, @$); }
| OPTION NAME '=' choices           { $$ = build_stmt(p, STMT_OPTION, $2, no_word, NULL, @$);
                                      build_words_of($$, $4); }
| OPTION NAME '=' '|' choices       { $$ = build_stmt(p, STMT_OPTION, $2, no_word, NULL, @$);
                                      build_words_of($$, $5); }
| NAME index '=' body               { $$ = build_stmt(p, STMT_DEFINITION, $1, $2, $4, @$); }
| late_word index '=' body          { $$ = build_stmt(p, STMT_DEFINITION, $1, $2, $4, @$); }
| rest
| STATE NAME index on '=' body      { $$ = build_stmt(p, STMT_STATE, $2, $3, $6, @$);
                                      build_placement(p, $$, $4); }
| STATE NAME index on '=' NAME NUMBER unit
                                    { $$ = build_stmt(p, STMT_STATE, $2, $3,
                                                      build_number(p, $7, $8, span_join(@7, @8)),
                                                      @$);
                                      build_placement(p, $$, $4);
                                      build_tensor_state(p, $$, $6); }
| DAMAGE NAME index on              { $$ = build_stmt(p, STMT_DAMAGE, $2, $3, NULL, @$);
                                      build_placement(p, $$, $4); }
| DAMAGE NAME index on '=' body     { $$ = build_stmt(p, STMT_DAMAGE, $2, $3, $6, @$);
                                      build_placement(p, $$, $4); }
| REQUIRE NAME IN interval          { $$ = build_stmt(p, STMT_REQUIRE, $2, no_word, NULL, @$);
                                      $$->in = $4; }
| FAILED WHEN expression            { $$ = build_failure(p, @1, $3, @$); }
| FUNCTION NAME '(' names ')' '=' body
                                    { $$ = build_stmt(p, STMT_FUNCTION, $2, no_word, $7, @$);
                                      build_words_of($$, $4); }
| FORCE NAME NAME index '=' body along
                                    { $$ = build_stmt(p, STMT_FORCE_STATE, $3, $4, $6, @$);
                                      build_force_state(p, $2, $$, $7); }
| rule
| flow
| rate
;

rule:
  FORCE NAME '=' body               { $$ = build_stmt(p, STMT_FORCE, $2, no_word, $4, @$); }
| MOMENT NAME '=' body              { $$ = build_stmt(p, STMT_MOMENT, $2, no_word, $4, @$); }
| ENERGY NAME '=' body              { $$ = build_stmt(p, STMT_ENERGY, $2, no_word, $4, @$); }
| STRESS NAME '=' body              { $$ = build_stmt(p, STMT_STRESS, $2, no_word, $4, @$); }
| STRAIN NAME '=' body              { $$ = build_stmt(p, STMT_STRAIN, $2, no_word, $4, @$); }
| YIELD NAME '=' body               { $$ = build_stmt(p, STMT_YIELD, $2, no_word, $4, @$); }
| GROW WHEN expression              { $$ = build_tip_stmt(p, STMT_GROW, @1, $3, @$); }
| TOWARD body                       { $$ = build_tip_stmt(p, STMT_TOWARD, @1, $2, @$); }
| SPEED body                        { $$ = build_tip_stmt(p, STMT_SPEED, @1, $2, @$); }
| OUTPUT NAME index '=' body        { $$ = build_stmt(p, STMT_OUTPUT, $2, $3, $5, @$); }
;

flow:
  FLOW NAME index BY expression WHEN expression
                                    { $$ = build_stmt(p, STMT_FLOW, $2, $3, $5, @$);
                                      $$->when = $7; }
| FLOW NAME index ALONG expression RETURNED WHEN expression
                                    { $$ = build_stmt(p, STMT_FLOW, $2, $3, $5, @$);
                                      $$->when = $8;
                                      $$->returned = true; }
;

rest:
  REST NAME index '=' body          { $$ = build_rest(p, $2, $3, $5, @$); }
;

rate:
  RATE NAME index '=' body          { $$ = build_stmt(p, STMT_RATE, $2, $3, $5, @$); }
;

/* Names of laws that were written before these words began lines. */
late_word:
  REST                              { $$ = (word){"rest", @1}; }
| RATE                              { $$ = (word){"rate", @1}; }
| FIELD                             { $$ = (word){"field", @1}; }
| ACCEPT                            { $$ = (word){"accept", @1}; }
;

parameter:
  PARAMETER NAME unit default       { $$ = build_stmt(p, STMT_PARAMETER, $2, no_word, $4, @$);
                                      $$->unit_text = $3.text; $$->unit_where = $3.where; }
;

field:
  FIELD NAME unit on default        { $$ = build_stmt(p, STMT_FIELD, $2, no_word, $5, @$);
                                      $$->unit_text = $3.text; $$->unit_where = $3.where;
                                      build_placement(p, $$, $4); }
;

unit:
  %empty                            { $$ = no_word; }
| UNIT
;

default:
  %empty                            { $$ = NULL; }
| '=' expression                    { $$ = $2; }
;

interval:
  opening sum ',' sum closing       { $$ = build_bounds(p, $1, $2, $4, $5, @$); }
;

opening:
  '('                               { $$ = true; }
| '['                               { $$ = false; }
;

closing:
  ')'                               { $$ = true; }
| ']'                               { $$ = false; }
;

choices:
  NAME                              { $$ = build_word(p, build_words(p), $1); }
| choices '|' NAME                  { $$ = build_word(p, $1, $3); }
;

names:
  NAME                              { $$ = build_word(p, build_words(p), $1); }
| names ',' NAME                    { $$ = build_word(p, $1, $3); }
;

on:
  %empty                            { $$ = no_word; }
| ON NAME                           { $$ = $2; }
;

along:
  %empty                            { $$ = no_word; }
| ALONG NAME                        { $$ = $2; }
;

text:
  %empty                            { $$ = no_word; }
| STRING
;

index:
  %empty                            { $$ = no_word; }
| '[' NAME ']'                      { $$ = $2; }
;

body:
  expression
| cases
;

cases:
  case_lines
;

case_lines:
  '|' expression WHEN expression jump
                                    { $$ = build_case(p, build_cases(p, @$), $2, $4, $5, @$); }
| '|' expression OTHERWISE jump     { $$ = build_case(p, build_cases(p, @$), $2, NULL, $4, @$); }
| '|' HOLE                          { $$ = build_open_case(p, build_cases(p, @$), @2); }
| case_lines '|' HOLE               { $$ = build_open_case(p, $1, @3); }
| case_lines '|' expression WHEN expression jump
                                    { $$ = build_case(p, $1, $3, $5, $6, span_join(@2, @6)); }
| case_lines '|' expression OTHERWISE jump
                                    { $$ = build_case(p, $1, $3, NULL, $5, span_join(@2, @5)); }
;

jump:
  %empty                            { $$ = false; }
| JUMP                              { $$ = true; }
;

/* Precedence is Fortran's; a sign may also follow an operator, and then binds tighter than `*`. */
expression:
  conjunction
| expression OR conjunction         { $$ = build_binary(p, OP_OR, $1, $3, @$); }
;

conjunction:
  negation
| conjunction AND negation          { $$ = build_binary(p, OP_AND, $1, $3, @$); }
;

negation:
  comparison
| NOT negation                      { $$ = build_unary(p, OP_NOT, $2, @$); }
;

comparison:
  sum
| sum relation sum                  { $$ = build_binary(p, $2, $1, $3, @$); }
;

relation:
  EQ                                { $$ = OP_EQ; }
| NE                                { $$ = OP_NE; }
| '<'                               { $$ = OP_LT; }
| LE                                { $$ = OP_LE; }
| '>'                               { $$ = OP_GT; }
| GE                                { $$ = OP_GE; }
;

sum:
  addend
| sum '+' addend                    { $$ = build_binary(p, OP_ADD, $1, $3, @$); }
| sum '-' addend                    { $$ = build_binary(p, OP_SUB, $1, $3, @$); }
;

addend:
  term
| '-' addend                        { $$ = build_unary(p, OP_NEG, $2, @$); }
| '+' addend                        { $$ = build_unary(p, OP_PLUS, $2, @$); }
;

term:
  power
| term '*' factor                   { $$ = build_binary(p, OP_MUL, $1, $3, @$); }
| term '/' factor                   { $$ = build_binary(p, OP_DIV, $1, $3, @$); }
| term ':' factor                   { $$ = build_binary(p, OP_CONTRACT, $1, $3, @$); }
;

factor:
  power
| '-' factor                        { $$ = build_unary(p, OP_NEG, $2, @$); }
| '+' factor                        { $$ = build_unary(p, OP_PLUS, $2, @$); }
;

power:
  primary
| primary POW factor                { $$ = build_binary(p, OP_POW, $1, $3, @$); }
;

primary:
  NUMBER                            { $$ = build_number(p, $1, no_word, @$); }
| NUMBER UNIT                       { $$ = build_number(p, $1, $2, @$); }
| HOLE unit                         { $$ = build_hole(p, $2, $2.text ? @$ : @1); }
| NAME index                        { $$ = build_name_or_axis(p, $1, $2, $2.text ? @$ : @1); }
| NAME '[' NAME ']' '[' NAME ']'    { $$ = build_axis(p, build_name(p, $1, false, $3,
                                                                    span_join(@1, @4)), $6, @$); }
| NAME '[' NAME ',' NAME ']'        { $$ = build_component(p, build_name(p, $1, false, no_word, @1),
                                                           $3, $5, @$); }
| NAME '[' NAME ']' '[' NAME ',' NAME ']'
                                    { $$ = build_component(p, build_name(p, $1, false, $3,
                                                                         span_join(@1, @4)),
                                                           $6, $8, @$); }
| PRIMED index                      { $$ = build_name(p, $1, true, $2, $2.text ? @$ : @1); }
| call ')'                          { $$ = $1; $$->where = @$; }
| '(' expression ')'                { $$ = $2; $$->where = @$; }
| '(' expression ',' expression ')' { $$ = build_vector(p, $2, $4, NULL, @$); }
| '(' expression ',' expression ',' expression ')'
                                    { $$ = build_vector(p, $2, $4, $6, @$); }
| '(' cases ')'                     { $$ = $2; $$->where = @$; }
;

call:
  arguments
;

arguments:
  NAME '(' expression               { $$ = build_argument(p, build_call(p, $1), no_word, $3); }
| NAME '(' NAME '=' expression      { $$ = build_argument(p, build_call(p, $1), $3, $5); }
| arguments ',' expression          { $$ = build_argument(p, $1, no_word, $3); }
| arguments ',' NAME '=' expression { $$ = build_argument(p, $1, $3, $5); }
;

%%

/* Called when the parser's stack is full: brackets and signs nested beyond all sense. */
static void model_error(span *where, parsing *p, const char *message) {
  (void)message;
  p->model_seen = p->law_seen = p->ended = true; /* what follows is not read, so not missed */
  if (!first_complaint(p)) return;
  diag_report(p->messages, DIAG_TOO_DEEP, *where,
              "the text nests too deeply to be read on from here");
}

static int yyreport_syntax_error(const yypcontext_t *context, parsing *p) {
  yysymbol_kind_t symbols[YYNTOKENS];
  int count = yypcontext_expected_tokens(context, symbols, YYNTOKENS);
  if (count < 0) return count;
  bool wanted[YYNTOKENS] = {false}, expected[TOKEN_CODES] = {false};
  for (int i = 0; i < count; i++) wanted[symbols[i]] = true;
  for (int token = 0; token <= YYMAXUTOK; token++) expected[token] = wanted[YYTRANSLATE(token)];
  syntax_error(p, p->lex.last, *yypcontext_location(context), expected);
  return 0;
}

void parser_read(parsing *p) {
  const source *s = &p->sources->items[p->file];
  lexer_open(p, s->text, p->part.begin, p->part.end);
  model_parse(p);
  lexer_close(p);
}

static void read_included(parsing *p, const stmt *s) {
  parsing *inner = include_open(p, s);
  if (!inner) return;
  parser_read(inner);
  include_close(p, inner);
}
