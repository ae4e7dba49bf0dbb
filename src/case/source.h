/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * Places in the text of a case where keys are set, for messages.
 *
 * Lua forgets where a table came from, so the text is searched for `key =`,
 * inside the braces of the keys above where these can be found. The search can
 * miss (a table filled in a loop) but does no harm.
 */
#ifndef TALUS_CASE_SOURCE_H
#define TALUS_CASE_SOURCE_H

/* Return the line of the key `path`, such as "domain.size" or "adapt[2].width";
 * if it is not there, of the nearest key above it, or of the last `return`; 0
 * if there is none. */
int source_line(const char *text, const char *path);

#endif
