/* Numbers with their units, as a person reads them: "30 GPa", "1.5 mm". */
#ifndef PERILAT_GENERATOR_PRINT_QUANTITY_H
#define PERILAT_GENERATOR_PRINT_QUANTITY_H

/* `text`, then the value with four digits and a prefix of thousands before its unit. */
void print_quantity(const char *text, double value, const char *unit_name);

#endif
