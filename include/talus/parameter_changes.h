/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Changes that a restart makes to the parameters of its run. */
#ifndef TALUS_PARAMETER_CHANGES_H
#define TALUS_PARAMETER_CHANGES_H

/*
 * Say `key = value (was value)` of the values that differ, one a line, on
 * stderr and in the log. Values that follow from the command line, now or
 * before, are many, and only the log names them; where the command line has
 * changed nothing the case was edited, and stderr has all changes. For one
 * rank. path  parameters.csv of the run so far; nothing is said if there is
 * none now   text of the parameters.csv to come
 */
void parameter_changes_say(const char *path, const char *now);

#endif
