/* SPDX-License-Identifier: GPL-3.0-or-later */
/* talus2d and talus3d: the commands of design.md, section 7. */
#include <errno.h>
#include <mpi.h>
#include <stdio.h>
#include <string.h>

#include "talus/case.h"
#include "talus/command_line.h"
#include "talus/error.h"
#include "talus/forest.h"
#include "talus/memory.h"
#include "talus/rheology.h"
#include "talus/run.h"
#include "talus/spelling.h"

_Static_assert((int)FOREST_MAX_LEVEL ==
                   (DIM == 2 ? CASE_MAX_LEVEL_2D : CASE_MAX_LEVEL_3D),
               "a case may ask for what the forest can do");

static const char USAGE[] =
    "Talus simulates dry granular flow on adaptive grids.\n"
    "\n"
    "  talus run CASE.lua [name=value ...] [options]   run a case\n"
    "  talus check CASE.lua [name=value ...]           check it, print every\n"
    "                                                  parameter in use\n"
    "  talus info DIR|FILE                             say what a run left\n"
    "  talus plot DIR                                  pictures and a film\n"
    "  talus rheology [NAME [key=value ...] [--csv]]   curve of a closure\n"
    "  talus help [run|case|output]                    more about one thing\n"
    "  talus --version\n"
    "  mpirun -n N talus run ...                       on N cores\n"
    "\n"
    "Begin with: talus run examples/column.lua level=8\n";

static const char RUN_HELP[] =
    "talus run CASE.lua [name=value ...] [options]\n"
    "\n"
    "  name=value         overrides what the case declares by param();\n"
    "                     lists as times=0.5,1,2\n"
    "  -o DIR             output directory; default: name of the case + .out\n"
    "  --restart          go on from DIR/checkpoint.h5\n"
    "  --max-steps N      stop after N steps, with a checkpoint\n"
    "  --max-walltime S   stop after S seconds, with a checkpoint\n"
    "  --quiet            say nothing but errors\n"
    "  --timing           say at the end where the time went\n"
    "\n"
    "Ctrl-C ends the step, writes a checkpoint and stops; the same command\n"
    "with --restart goes on. Exit status: 0 done, 2 error of the user,\n"
    "3 numerical failure, 4 memory, disk or MPI.\n";

static const char OUTPUT_HELP[] =
    "The output directory holds\n"
    "  series.csv       a row per logged step: time, dt, cells, front,\n"
    "                   height, volume, energies, iterations, ...\n"
    "  profile.csv      outlines of the grains at output.profile_times and\n"
    "                   at the end: time,x,height (3D: time,x,y,height)\n"
    "  snapshots.xdmf   all fields on the adaptive grid, for ParaView, with\n"
    "                   snapshot-*.h5\n"
    "  checkpoint.h5    to go on with --restart\n"
    "  parameters.csv   every parameter in use\n"
    "  run.log          what happened\n";

/* The text of the case, read by rank 0, on all ranks. */
static char *read_everywhere(const char *path) {
  char *text = base_rank() == 0 ? case_read_text(path) : NULL;
  int64_t head[2] = {text != NULL ? (int64_t)strlen(text) : -1, errno};
  MPI_CHECK(MPI_Bcast(head, 2, MPI_INT64_T, 0, MPI_COMM_WORLD));
  if (head[0] < 0)
    USER_ERROR("cannot read the case %s: %s", path, strerror((int)head[1]));
  if (base_rank() != 0) text = MEM_NEW(char, (size_t)head[0] + 1);
  MPI_CHECK(MPI_Bcast(text, (int)head[0], MPI_CHAR, 0, MPI_COMM_WORLD));
  return text;
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
  if (case_note(file) != NULL && !line->quiet && base_rank() == 0)
    fprintf(stderr, "talus: %s\n", case_note(file));
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
  char directory[PARAMS_NAME_LENGTH + 8];
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

static int command_check(int argc, char *argv[]) {
  struct command_line line;
  command_line_read(argc, argv, false, &line);
  struct case_file *file = load_case(&line);
  if (base_rank() == 0) case_print(file, stdout);
  case_destroy(file);
  return EXIT_DONE;
}

static int command_help(int argc, char *argv[]) {
  static const char *const TOPICS[] = {"run", "case", "output", "rheology"};
  const char *topic = argc > 0 ? argv[0] : "";
  if (argc == 0)
    fputs(USAGE, stdout);
  else if (strcmp(topic, "case") == 0 || strcmp(topic, "check") == 0)
    case_help(stdout);
  else if (strcmp(topic, "run") == 0)
    fputs(RUN_HELP, stdout);
  else if (strcmp(topic, "output") == 0 || strcmp(topic, "plot") == 0 ||
           strcmp(topic, "info") == 0)
    fputs(OUTPUT_HELP, stdout);
  else if (strcmp(topic, "rheology") == 0)
    return command_rheology(0, NULL);
  else {
    const char *nearest = spelling_nearest(topic, 4, TOPICS);
    USER_ERROR("no help on %s%s%s; there is run, case, output, rheology", topic,
               nearest ? "; did you mean " : "", nearest ? nearest : "");
  }
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

static const struct command *find_command(const char *word) {
  const char *names[NCOMMANDS];
  for (int i = 0; i < NCOMMANDS; i++) {
    names[i] = COMMANDS[i].name;
    if (strcmp(word, names[i]) == 0) return &COMMANDS[i];
  }
  const char *nearest = spelling_nearest(word, NCOMMANDS, names);
  USER_ERROR("unknown command %s%s%s; `talus help` lists the commands", word,
             nearest ? "; did you mean " : "", nearest ? nearest : "");
}

int main(int argc, char *argv[]) {
  if (argc < 2) {
    fputs(USAGE, stderr);
    return EXIT_USER;
  }
  const struct command *command = find_command(argv[1]);
  if (command->parallel) base_begin(&argc, &argv);
  rheology_begin();
  int status = command->run(argc - 2, argv + 2);
  if (command->parallel) base_end();
  return status;
}
