/* SPDX-License-Identifier: GPL-3.0-or-later */
/* talus plot: hands over to tools/plot.py and a Python that can run it. */
#include <errno.h>
#include <fcntl.h>
#include <spawn.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/wait.h>
#include <unistd.h>

#include "talus/command_line.h"
#include "talus/error.h"

enum { LENGTH = 4096, MOST_WORDS = 64 };

extern char **environ;

/* Tell whether this interpreter is there and has what the plots need. */
static bool can_plot(const char *python) {
  char flag[] = "-c", code[] = "import h5py, matplotlib";
  char name[LENGTH];
  snprintf(name, sizeof name, "%s", python);
  char *const words[] = {name, flag, code, NULL};
  posix_spawn_file_actions_t quiet;
  posix_spawn_file_actions_init(&quiet);
  posix_spawn_file_actions_addopen(&quiet, 2, "/dev/null", O_WRONLY, 0);
  pid_t child;
  int status = -1;
  int error = posix_spawnp(&child, name, &quiet, NULL, words, environ);
  posix_spawn_file_actions_destroy(&quiet);
  if (error != 0) return false;
  while (waitpid(child, &status, 0) < 0 && errno == EINTR) continue;
  return WIFEXITED(status) && WEXITSTATUS(status) == 0;
}

static const char *find_python(void) {
  const char *const candidates[] = {"python3", "/usr/bin/python3"};
  const char *chosen = getenv("TALUS_PYTHON");
  if (chosen != NULL && *chosen != '\0') {
    if (can_plot(chosen)) return chosen;
    USER_ERROR(
        "TALUS_PYTHON=%s: there is no such program, or it has no h5py and "
        "matplotlib",
        chosen);
  }
  for (int i = 0; i < 2; i++)
    if (can_plot(candidates[i])) return candidates[i];
  USER_ERROR(
      "no Python with h5py and matplotlib: install them (Debian: apt install "
      "python3-h5py python3-matplotlib), or say in TALUS_PYTHON which "
      "interpreter has them");
}

/* Find plot.py in $TALUS_TOOLS, or in the tools/ of the tree we were built in,
 * or of the one we stand in. */
static void find_script(char *script) {
  static const char *const places[] = {"../tools", "../../tools"};
  char own[LENGTH / 2];
  const char *tools = getenv("TALUS_TOOLS");
  if (tools != NULL) {
    snprintf(script, LENGTH, "%s/plot.py", tools);
    if (access(script, R_OK) == 0) return;
    USER_ERROR("TALUS_TOOLS=%s holds no plot.py", tools);
  }
  if (command_own_directory(own, sizeof own)) {
    for (int i = 0; i < 2; i++) {
      snprintf(script, LENGTH, "%s/%s/plot.py", own, places[i]);
      if (access(script, R_OK) == 0) return;
    }
  }
  snprintf(script, LENGTH, "tools/plot.py");
  if (access(script, R_OK) == 0) return;
  USER_ERROR(
      "tools/plot.py is not where the program is: say in TALUS_TOOLS "
      "which directory holds plot.py");
}

int command_plot(int argc, char *argv[]) {
  char script[LENGTH];
  char *words[MOST_WORDS + 3];
  if (argc < 1) USER_ERROR("which run? Say: talus plot DIR");
  if (argc > MOST_WORDS)
    USER_ERROR("talus plot: more than %d words", MOST_WORDS);
  if (argv[0][0] != '-' && access(argv[0], R_OK) != 0)
    USER_ERROR("talus plot %s: %s", argv[0], strerror(errno));
  find_script(script);
  char python[LENGTH];
  snprintf(python, sizeof python, "%s", find_python());
  words[0] = python;
  words[1] = script;
  for (int i = 0; i < argc; i++) words[i + 2] = argv[i];
  words[argc + 2] = NULL;
  fflush(NULL);
  execvp(python, words);
  USER_ERROR("cannot start %s: %s", python, strerror(errno));
}
