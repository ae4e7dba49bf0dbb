/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Text in lines of a terminal. */
#ifndef TALUS_WRAP_H
#define TALUS_WRAP_H

#include <stdio.h>

/* Print `text` and a newline, broken at blanks into lines of at most 79
 * characters; each begins at column `indent`, up to which the caller has
 * filled the first. */
void wrap_print(FILE *f, int indent, const char *text);

#endif
