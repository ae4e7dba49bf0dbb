/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "talus/signals.h"

#include <signal.h>
#include <stdbool.h>
#include <stddef.h>
#include <string.h>
#include <unistd.h>

#include "talus/error.h"

static const struct {
  int number;
  const char *name;
  bool twice; /* a second one has its old effect */
} SIGNALS[] = {{SIGINT, "SIGINT", true},
               {SIGTERM, "SIGTERM", true},
               /* a terminal that closes may send several */
               {SIGHUP, "SIGHUP", false}};

enum { NSIGNALS = sizeof SIGNALS / sizeof *SIGNALS };

/* All that a handler may set. */
static volatile sig_atomic_t caught;

static void remember(int number) { caught = number; }

/* Print a text from a handler, where only write and _exit are safe. */
static void say(const char *text) {
  if (write(STDERR_FILENO, text, strlen(text)) < 0) return;
}

static void end_at_once(int number) {
  if (base_rank() == 0) {
    say("\ntalus: stopped by ");
    say(signals_name(number));
    say(" before the first step; nothing was written\n");
  }
  _exit(EXIT_STOPPED);
}

static void set_handlers(void (*handler)(int number)) {
  for (int k = 0; k < NSIGNALS; k++) {
    struct sigaction action = {.sa_handler = handler}, before;
    action.sa_flags = SA_RESTART;
    if (SIGNALS[k].twice) action.sa_flags |= (int)SA_RESETHAND;
    sigemptyset(&action.sa_mask);
    sigaction(SIGNALS[k].number, NULL, &before);
    if (SIGNALS[k].number == SIGHUP && before.sa_handler == SIG_IGN) continue;
    sigaction(SIGNALS[k].number, &action, NULL);
  }
}

void signals_catch(void) {
  struct sigaction ignore = {.sa_handler = SIG_IGN};
  sigemptyset(&ignore.sa_mask);
  sigaction(SIGPIPE, &ignore, NULL);
  sigaction(SIGXFSZ, &ignore, NULL); /* a write that fails says so itself */
  caught = 0;
  set_handlers(end_at_once);
}

void signals_remember(void) { set_handlers(remember); }

int signals_caught(void) { return caught; }

const char *signals_name(int number) {
  for (int k = 0; k < NSIGNALS; k++)
    if (SIGNALS[k].number == number) return SIGNALS[k].name;
  return "a signal";
}
