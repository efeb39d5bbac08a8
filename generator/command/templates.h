/* The files in templates/, built into the program. NAME in them stands for the law's name. */
#ifndef PERILAT_GENERATOR_TEMPLATES_H
#define PERILAT_GENERATOR_TEMPLATES_H

extern const char template_central[], template_micropolar[]; /* laws of bonds */
extern const char template_drive[];                          /* a path of both */
extern const char template_state[], template_state_drive[];  /* a law of families, its path */
extern const char template_deck[];                           /* a small specimen of all three */
extern const char template_continuum[], template_crack[];    /* laws for meshes */
extern const char template_continuum_drive[];                /* its path */
extern const char template_continuum_deck[], template_crack_deck[]; /* their specimens */

#endif
