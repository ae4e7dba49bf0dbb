/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Nearest word, for messages that say "did you mean". */
#ifndef TALUS_SPELLING_H
#define TALUS_SPELLING_H

/* Return the word that needs the fewest letters added, dropped, changed or
 * swapped to become `word`, in whatever case; NULL if none looks alike (more
 * than a third of it differs).
 *   words  [n], entries may be NULL */
const char *spelling_nearest(const char *word, int n, const char *const *words);

#endif
