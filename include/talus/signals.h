/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * Signals that stop a run: SIGINT, SIGTERM and SIGHUP.
 *
 * While a run starts there is nothing to save, and a signal ends the program at
 * once, status EXIT_STOPPED, wherever it is. From the first step on a signal is
 * remembered and the run asks for it between steps; a second SIGINT or SIGTERM
 * then ends the program at once. A SIGHUP that was ignored (nohup) stays so.
 * SIGPIPE is ignored: a run goes on when nobody reads what it says.
 */
#ifndef TALUS_SIGNALS_H
#define TALUS_SIGNALS_H

/* Catch the signals of a run that starts. Not collective. */
void signals_catch(void);

/* Remember signals from now on. Not collective. */
void signals_remember(void);

/* Return the signal that came last, 0 if none did. This rank only. */
int signals_caught(void);

/* Return the name of a signal, "SIGINT" and so on, "a signal" of others. */
const char *signals_name(int number);

#endif
