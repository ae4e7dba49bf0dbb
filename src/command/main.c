/* SPDX-License-Identifier: GPL-3.0-or-later */
/* talus2d and talus3d: the commands that README.md lists. */
#include <errno.h>
#include <mpi.h>
#include <stdio.h>
#include <string.h>
#include <unistd.h>

#include "talus/case.h"
#include "talus/command_line.h"
#include "talus/error.h"
#include "talus/forest.h"
#include "talus/memory.h"
#include "talus/model.h"
#include "talus/program.h"
#include "talus/rheology.h"
#include "talus/run.h"
#include "talus/run_size.h"
#include "talus/same_case.h"
#include "talus/signals.h"
#include "talus/spelling.h"

_Static_assert((int)FOREST_MAX_LEVEL ==
                   (DIM == 2 ? CASE_MAX_LEVEL_2D : CASE_MAX_LEVEL_3D),
               "a case may ask for what the forest can do");
_Static_assert((int)FOREST_MAX_TREES == (int)CASE_MAX_TREES,
               "and for as many trees");

/* Read the text of the case on rank 0 and give it to all ranks. */
static char *read_everywhere(const char *path) {
  char *text = base_rank() == 0 ? case_read_text(path) : NULL;
  int64_t head[2] = {text != NULL ? (int64_t)strlen(text) : -1, errno};
  MPI_CHECK(MPI_Bcast(head, 2, MPI_INT64_T, 0, MPI_COMM_WORLD));
  if (head[0] < 0)
    USER_ERROR("cannot read the case %s: %s%s", path, strerror((int)head[1]),
               strchr(path, '=') == NULL
                   ? ""
                   : "; the case comes first, name=value follow it");
  if (base_rank() != 0) text = MEM_NEW(char, (size_t)head[0] + 1);
  MPI_CHECK(MPI_Bcast(text, (int)head[0], MPI_CHAR, 0, MPI_COMM_WORLD));
  return text;
}

/* Tell whether `talus plot` will find the outlines to compare with: as they
 * stand, beside the run, or among the examples, where a case comes from. */
static bool finds_reference(const struct command_line *line, const char *name) {
  enum { LENGTH = 4096 };
  const char *slash = strrchr(line->case_path, '/');
  const int n = slash != NULL ? (int)(slash - line->case_path) + 1 : 0;
  char path[3][LENGTH];
  if (access(name, R_OK) == 0) return true;
  if (*name == '/') return false;
  snprintf(path[0], LENGTH, "%.*s%s", n, line->case_path, name);
  const char *run = line->directory != NULL ? line->directory : ".";
  snprintf(path[1], LENGTH, "%s/%s", run, name);
  snprintf(path[2], LENGTH, "%s/../%s", run, name);
  for (int k = 0; k < 3; k++)
    if (access(path[k], R_OK) == 0) return true;
  return false;
}

/* Say what is no error but worth a word. */
static void say_notes(const struct command_line *line,
                      const struct case_file *file) {
  if (line->quiet || base_rank() != 0) return;
  const char *reference = case_parameter(file, "reference");
  if (case_note(file) != NULL) fprintf(stderr, "talus: %s\n", case_note(file));
  if (reference != NULL && *reference && !finds_reference(line, reference))
    fprintf(stderr,
            "talus: warning: reference=%s: there is no such file here, beside "
            "the case or beside the run; pictures will be without it\n",
            reference);
}

static struct case_file *load_case(const struct command_line *line) {
  char *text = read_everywhere(line->case_path);
  struct case_file *file =
      case_load_text(line->case_path, text, line->noverrides, line->overrides);
  mem_free(text);
  int dimension = case_params(file)->dimension;
  if (dimension != DIM)
    USER_ERROR("%s is a case of dimension %d: start it with talus or talus%dd",
               line->case_path, dimension, dimension);
  const char *different = same_case_difference(file);
  if (different != NULL)
    USER_ERROR(
        "%s: ranks see different values of %s: do they run on machines with "
        "different libraries? A case must be the same on each of them",
        line->case_path, different);
  say_notes(line, file);
  return file;
}

static void write_parameters(void *context, FILE *f) {
  case_write_parameters((const struct case_file *)context, f);
}

static int command_run(int argc, char *argv[]) {
  struct command_line line;
  command_line_read(argc, argv, true, &line);
  struct case_file *file = load_case(&line);
  const struct params *params = case_params(file);
  char directory[sizeof params->name + 8];
  snprintf(directory, sizeof directory, "%s.out", params->name);
  struct run_options options = {
      .directory = line.directory != NULL ? line.directory : directory,
      .restart = line.restart,
      .max_steps = line.max_steps,
      .max_walltime = line.max_walltime,
      .quiet = line.quiet,
      .timing = line.timing,
      .write_parameters = write_parameters,
      .context = file};
  int status = run_case(params, &options);
  case_destroy(file);
  return status;
}

/* Print what the model makes of the numbers of a case. */
static void say_numbers(const struct params *params) {
  const struct model_kind *kind = models_get(params->model);
  char text[512] = "";
  if (kind->describe != NULL) kind->describe(params, sizeof text, text);
  if (*text != '\0') printf("%s: %s\n", kind->keys->name, text);
}

static int command_check(int argc, char *argv[]) {
  struct command_line line;
  command_line_read(argc, argv, false, &line);
  struct case_file *file = load_case(&line);
  struct run_size size;
  char text[RUN_SIZE_LENGTH];
  const struct model_kind *kind = models_get(case_params(file)->model);
  if (kind->check != NULL) kind->check(case_params(file));
  run_size_estimate(case_params(file), &size);
  run_size_text(&size, text);
  if (base_rank() == 0) {
    case_print(file, stdout);
    for (int k = 0; k < case_params(file)->ncovers; k++)
      printf("%s\n", case_params(file)->cover[k]);
    printf("size: %s\n", text);
    say_numbers(case_params(file));
    fflush(stdout);
    run_size_warn(&size);
    if (!case_finds_grains(file))
      fprintf(stderr,
              "talus: warning: grains.shape is positive nowhere that was "
              "tried: are there grains?\n");
  }
  case_destroy(file);
  return EXIT_DONE;
}

static int command_version(int argc, char *argv[]) {
  (void)argc, (void)argv;
  printf("talus %s\n", TALUS_VERSION);
  return EXIT_DONE;
}

static const struct command {
  const char *name;
  int (*run)(int argc, char *argv[]);
  bool parallel; /* needs MPI */
} COMMANDS[] = {{"run", command_run, true},
                {"check", command_check, true},
                {"info", command_info, true},
                {"plot", command_plot, false},
                {"rheology", command_rheology, false},
                {"help", command_help, false},
                {"--help", command_help, false},
                {"-h", command_help, false},
                {"--version", command_version, false}};

enum { NCOMMANDS = sizeof COMMANDS / sizeof *COMMANDS };

/* Find a command; NULL: there is none of this name. */
static const struct command *find_command(const char *word) {
  for (int i = 0; i < NCOMMANDS; i++)
    if (strcmp(word, COMMANDS[i].name) == 0) return &COMMANDS[i];
  return NULL;
}

static _Noreturn void refuse_command(const char *word) {
  const char *names[NCOMMANDS];
  for (int i = 0; i < NCOMMANDS; i++) names[i] = COMMANDS[i].name;
  const char *nearest = spelling_nearest(word, NCOMMANDS, names);
  USER_ERROR("unknown command %s%s%s; `talus help` lists the commands", word,
             nearest ? "; did you mean " : "", nearest ? nearest : "");
}

/* Return the status, or another one if what was printed is lost. */
static int check_output(int status) {
  if (fflush(stdout) == 0 && !ferror(stdout)) return status;
  fprintf(stderr,
          "talus: error: cannot print all of it (%s); is there space left "
          "where the output goes?\n",
          strerror(errno));
  return status == EXIT_DONE ? EXIT_SYSTEM : status;
}

int main(int argc, char *argv[]) {
  const struct command *command = argc > 1 ? find_command(argv[1]) : NULL;
  /* the script behind plot has options of its own */
  const bool help = command != NULL && command->run != command_plot &&
                    command_asks_help(argc - 2, argv + 2);
  const bool parallel = command != NULL && command->parallel && !help;
  /* Do once what needs no MPI. The others end well: mpirun would kill the
   * first, before it has spoken, at the sight of a status. */
  if (base_take_rank() != 0 && !parallel) return EXIT_DONE;
  if (argc < 2) {
    command_usage(stderr);
    return EXIT_USER;
  }
  if (command == NULL) refuse_command(argv[1]);
  rheology_begin();
  if (help) return check_output(command_help(1, &argv[1]));
  if (command->run == command_run) signals_catch();
  if (command->parallel) base_begin(&argc, &argv);
  int status = command->run(argc - 2, argv + 2);
  if (command->run != command_run) status = check_output(status);
  if (command->parallel) base_end();
  return status;
}
