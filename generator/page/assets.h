/* The style and the script of a page, built into the program from page.css and page.js. */
#ifndef PERILAT_GENERATOR_PAGE_ASSETS_H
#define PERILAT_GENERATOR_PAGE_ASSETS_H

extern const char page_style[], page_script[];

#endif
