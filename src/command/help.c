/* SPDX-License-Identifier: GPL-3.0-or-later */
/* talus help: what the program does, and a page on each command. */
#include <stdio.h>
#include <string.h>

#include "talus/case.h"
#include "talus/command_line.h"
#include "talus/error.h"
#include "talus/model.h"
#include "talus/spelling.h"
#include "talus/wrap.h"

static const char USAGE[] =
    "Talus simulates dry granular flow on adaptive grids.\n"
    "\n"
    "  talus run CASE.lua [name=value ...] [options]   run a case\n"
    "  talus check CASE.lua [name=value ...]           check it, print every\n"
    "                                                  parameter in use\n"
    "  talus info DIR|FILE                             say what a run left\n"
    "  talus plot DIR                                  pictures and a film\n"
    "  talus rheology [NAME [key=value ...] [--csv]]   curve of a closure\n"
    "  talus help [run|check|case|output|info|plot|rheology]\n"
    "                                                  more about one thing\n"
    "  talus --version\n"
    "  mpirun -n N talus run ...                       on N cores\n"
    "\n"
    "Begin with: talus run examples/column.lua level=8\n";

static const char RUN_HELP[] =
    "talus run CASE.lua [name=value ...] [options]\n"
    "\n"
    "  CASE.lua           the first word that is no option\n"
    "  name=value         overrides what the case declares by param();\n"
    "                     lists as times=0.5,1,2\n"
    "  -o DIR             output directory; default: name of the case + .out;\n"
    "                     a run that it holds is replaced, with the pictures\n"
    "                     of talus plot; files of others are left alone\n"
    "  --restart          go on from DIR/checkpoint.h5, which must be as it "
    "was\n"
    "                     written, with all rows of the tables before it; or\n"
    "                     from a copy of it alone, with new tables\n"
    "  --max-steps N      stop after N steps, with a checkpoint\n"
    "  --max-walltime S   stop after S seconds, with a checkpoint\n"
    "  --quiet            say nothing but warnings and errors\n"
    "  --timing           say at the end where the time went\n"
    "\n"
    "Ctrl-C, SIGTERM and SIGHUP end the step, write a checkpoint and stop; "
    "the\n"
    "same command with --restart goes on. Before the first step they end the\n"
    "program at once. Exit status:\n"
    "  0  the run is finished: at output.stop, or at rest\n"
    "  2  the case or the command line is wrong, or the case too large for "
    "the\n"
    "     memory that the job may use\n"
    "  3  numerical failure, or steps with which the run would never end\n"
    "  4  memory, disk or MPI\n"
    "  5  stopped before its end, by a signal, --max-steps or --max-walltime\n"
    "mpirun hands these on (with words of its own that a process ended so), "
    "but\n"
    "returns 1 when the signal went to mpirun itself; `talus info DIR` says "
    "how\n"
    "the run ended.\n";

static const char CHECK_HELP[] =
    "talus check CASE.lua [name=value ...]\n"
    "\n"
    "Reads the case as `talus run` would, says what is wrong with it, and\n"
    "prints every parameter in use: key = value, unit, meaning, and whether\n"
    "it is a default or from the command line; then how much of a side each\n"
    "patch of boundary.patches covers, and about how many cells and how much\n"
    "memory the start will take. Nothing is computed or written. `talus help\n"
    "case` lists the keys of a case.\n";

static const char INFO_HELP[] =
    "talus info DIR|FILE\n"
    "\n"
    "Of the directory of a run: the last row of series.csv, whether the run "
    "is\n"
    "finished, stopped (and by what) or failed, parameters and files; of a "
    ".csv its columns and last row; of a snapshot or checkpoint\n"
    "(.h5) its time, step and cells, and the fields of a snapshot.\n"
    "`talus help output` says what they mean.\n";

static const char PLOT_HELP[] =
    "talus plot DIR [options]\n"
    "\n"
    "Draws into DIR\n"
    "  outlines.png       the heap at the times of profile.csv, the part of\n"
    "                     its height in each tracer, and the outlines of the\n"
    "                     file that the parameter `reference` names\n"
    "  fields-final.png   grid, speed, pressure, viscosity at the end\n"
    "  history.png        front, height, energies, cells against time\n"
    "  film.gif           a frame per snapshot (film.mp4 where ffmpeg is)\n"
    "and of a run in 3D, the film too,\n"
    "  plan.png           height over x and y, with contours\n"
    "  heap.png           the surface of the grains\n"
    "\n"
    "It needs a Python 3 with h5py and matplotlib: the one that TALUS_PYTHON\n"
    "names, else python3 on PATH, else /usr/bin/python3. Surfaces are "
    "rendered\n"
    "by VTK where that has it and a display (python3-vtk9; xvfb-run talus "
    "plot\n"
    "DIR), else by matplotlib. `talus plot --help` lists the options.\n";

static const char SERIES_HELP[] =
    "The output directory holds\n"
    "\n"
    "series.csv, a row per step (output.series_every), in the units of the\n"
    "case, here SI. \"The heap\" is the grains without droplets apart from "
    "it.\n";

static const char PROFILE_HELP[] =
    "\n"
    "profile.csv, outlines of the heap at output.profile_times and at the\n"
    "end: time,x,height (3D: time,x,y,height), then a column per tracer by "
    "its\n"
    "name: how much of the height is grains of that tracer, m. Columns that "
    "are\n"
    "not listed have the height 0.\n";

static const char SNAPSHOT_HELP[] =
    "\n"
    "snapshots.xdmf, to be opened in ParaView, and snapshot-*.h5: all fields\n"
    "at the start, at the first step at or after each multiple of\n"
    "output.snapshot_every, and at the end. Each file holds\n"
    "  vertices [n][2 or 3]     corners, m\n"
    "  cells [cells][4 or 8]    their rows in vertices; the mean of the\n"
    "                           corners is the centre of the cell\n"
    "  level                    of refinement\n"
    "  fraction                 of the cell that is grains\n"
    "  velocity [cells][3]      m/s\n"
    "  pressure, viscosity      Pa, Pa s\n"
    "  shear_rate, stress       1/s; of the grains, Pa: sqrt(2 D:D), "
    "sqrt(T:T/2)\n"
    "  yield_state              with regularisation = \"exact\": 0 where "
    "grains are\n"
    "                           held, 1 at their yield stress, where they "
    "flow;\n"
    "                           `viscosity` is then the plastic one, without "
    "the\n"
    "                           yield stress, and stress/shear_rate the "
    "whole\n"
    "  tracers by their names, and what the closure gives (nu, state, ...;\n"
    "  see `talus rheology`). `talus info FILE` lists the fields with their\n"
    "  units. In Python:\n"
    "    import h5py\n"
    "    with h5py.File(\"column.out/snapshot-000000.h5\") as f:\n"
    "        time, grains = f.attrs[\"time\"], f[\"fraction\"][:] > 0.5\n"
    "        centre = f[\"vertices\"][:][f[\"cells\"][:]].mean(axis=1)\n"
    "        print(time, centre[grains].max(axis=0))\n"
    "\n"
    "checkpoint.h5, to go on with --restart: HDF5 after a seal of 512 bytes,\n"
    "with a checksum of every byte; parameters.csv, every parameter in use;\n"
    "run.log, what happened; run.lock, while a run goes on, who runs it. "
    "`talus plot DIR` adds outlines.png,\n"
    "fields-final.png, history.png and film.gif, in 3D plan.png and heap.png\n"
    "(see `talus help plot`).\n";

static void help_usage(void) { fputs(USAGE, stdout); }
static void help_run(void) { fputs(RUN_HELP, stdout); }
static void help_check(void) { fputs(CHECK_HELP, stdout); }
static void help_info(void) { fputs(INFO_HELP, stdout); }
static void help_plot(void) { fputs(PLOT_HELP, stdout); }
static void help_case(void) { case_help(stdout); }
static void help_rheology(void) { command_rheology(0, NULL); }

/* Print the columns of a model's series.csv. */
static void print_columns(const struct model_kind *kind) {
  enum { INDENT = 23 };
  for (int k = 0; k < kind->ncolumns; k++) {
    const struct column *column = &kind->columns[k];
    char text[512];
    snprintf(text, sizeof text, "%s%s%s", column->help,
             *column->unit ? ", " : "", column->unit);
    printf("  %-*s ", INDENT - 3, column->name);
    wrap_print(stdout, INDENT, text);
  }
}

static void help_output(void) {
  const struct model_kind *kind;
  fputs(SERIES_HELP, stdout);
  print_columns(models_get(0));
  for (int k = 1; (kind = models_get(k)) != NULL; k++) {
    printf("\nThat of model = \"%s\" has the columns\n", kind->keys->name);
    print_columns(kind);
  }
  fputs(PROFILE_HELP, stdout);
  fputs(SNAPSHOT_HELP, stdout);
}

static const struct {
  const char *name;
  void (*print)(void);
} TOPICS[] = {{"run", help_run},           {"check", help_check},
              {"case", help_case},         {"output", help_output},
              {"info", help_info},         {"plot", help_plot},
              {"rheology", help_rheology}, {"help", help_usage}};

enum { NTOPICS = sizeof TOPICS / sizeof *TOPICS };

void command_usage(FILE *f) { fputs(USAGE, f); }

int command_help(int argc, char *argv[]) {
  const char *names[NTOPICS], *topic = argc > 0 ? argv[0] : "help";
  for (int i = 0; i < NTOPICS; i++) {
    names[i] = TOPICS[i].name;
    if (strcmp(topic, names[i]) != 0) continue;
    TOPICS[i].print();
    return EXIT_DONE;
  }
  const char *nearest = spelling_nearest(topic, NTOPICS, names);
  USER_ERROR(
      "no help on %s%s%s; there is run, check, case, output, info, plot, "
      "rheology",
      topic, nearest ? "; did you mean " : "", nearest ? nearest : "");
}

bool command_asks_help(int argc, char *argv[]) {
  for (int i = 0; i < argc; i++)
    if (strcmp(argv[i], "--help") == 0 || strcmp(argv[i], "-h") == 0)
      return true;
  return false;
}
