/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Test that all ranks have understood a case alike. */
#ifndef TALUS_SAME_CASE_H
#define TALUS_SAME_CASE_H

struct case_file;

/* Return the key of the first parameter or function in which ranks differ, as
 * this rank knows it, owned by the case; NULL: they agree. Collective. */
const char *same_case_difference(const struct case_file *file);

#endif
