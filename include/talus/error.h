/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * Errors of the program.
 *
 * Seven tools, each for one kind of trouble:
 *
 *   ASSERT(cond)           a bug; debug builds only, allowed in hot loops
 *   CHECK(cond, fmt, ...)  a broken contract between modules; always on
 *   FATAL(fmt, ...)        the machine lets us down: memory, MPI, HDF5, NaN
 *   USER_ERROR(fmt, ...)   the user asked for something that cannot be
 *   SYSTEM_ERROR(fmt, ...) so, but for want of something on this machine
 *   WARN_ONCE(fmt, ...)    the run goes on, but somebody should know
 *   WARN(fmt, ...)         likewise of the case, each time
 *
 * All but the errors of users and WARN add rank, file, line and function. Word
 * a message as: what happened, the value, what is allowed, what to try.
 *
 * Before base_begin and after base_end (program.h) the program is taken to be
 * rank 0 of 1, so that code without a mesh can be tested without MPI.
 */
#ifndef TALUS_ERROR_H
#define TALUS_ERROR_H

#include <stdbool.h>

/* Exit status of every talus program. */
enum {
  EXIT_DONE = 0,      /* the run ended as asked */
  EXIT_USER = 2,      /* bad case file, command line or directory */
  EXIT_NUMERICAL = 3, /* the scheme gave up; the last checkpoint is good */
  EXIT_SYSTEM = 4,    /* memory, disk, MPI, or a bug */
  EXIT_STOPPED = 5    /* a run stopped before its end, to be gone on with */
};

/*
 * Turn the traps of debug builds on or off on this rank, around foreign code
 * that divides by zero in good faith, as a Lua file may. Does nothing in
 * release builds. returns  whether they were on
 */
bool base_trap_floating_point(bool on);

/* Rank of this process in MPI_COMM_WORLD, 0 without MPI. Not collective. */
int base_rank(void);

/* Number of processes in MPI_COMM_WORLD, 1 without MPI. Not collective. */
int base_size(void);

/* Ends the program (status EXIT_SYSTEM, on all ranks) when a bug makes `cond`
 * false. Compiled out, and `cond` not evaluated, when NDEBUG is defined. */
#ifdef NDEBUG
#define ASSERT(cond) ((void)sizeof((cond) ? 1 : 0))
#else
#define ASSERT(cond) \
  ((cond)            \
       ? (void)0     \
       : base_fatal(__FILE__, __LINE__, __func__, "bug: %s is false", #cond))
#endif

/* Ends the program (status EXIT_SYSTEM, on all ranks) when `cond` is false;
 * the message (printf) says what the caller should have done. */
#define CHECK(cond, ...) \
  ((cond)                \
       ? (void)0         \
       : base_check_failed(__FILE__, __LINE__, __func__, #cond, __VA_ARGS__))

/* Ends the program on all ranks through MPI_Abort, status EXIT_SYSTEM. May be
 * called by one rank alone. */
#define FATAL(...) base_fatal(__FILE__, __LINE__, __func__, __VA_ARGS__)

/* Ends the program in good order, status EXIT_USER, without a stack trace.
 * Collective: all ranks must get here with the same message, only rank 0 prints
 * "talus: error: ..." on stderr. The message names file, line and key where
 * there are any. */
#define USER_ERROR(...) base_user_error(__VA_ARGS__)

/* As USER_ERROR, for what the machine does not allow: status EXIT_SYSTEM.
 * Collective. */
#define SYSTEM_ERROR(...) base_system_error(__VA_ARGS__)

/* USER_ERROR for what one rank may be alone to find, such as a function of the
 * case that fails at one point: ends all ranks, through MPI_Abort where there
 * are several. Where more than one finds something the lowest is heard. */
#define USER_ERROR_ALONE(...) base_user_error_alone(__VA_ARGS__)

/* Warns on stderr and in the log the first time this line of code is reached.
 * Only rank 0 prints: reduce the condition first if ranks can differ. */
#define WARN_ONCE(...)                                      \
  do {                                                      \
    static int warned_;                                     \
    if (!warned_) {                                         \
      warned_ = 1;                                          \
      base_warn(__FILE__, __LINE__, __func__, __VA_ARGS__); \
    }                                                       \
  } while (0)

/* Warns on stderr and in the log. Only rank 0 prints, as above. */
#define WARN(...) base_tell(__VA_ARGS__)

/* Runs an MPI call and ends the program as FATAL does, with the words of MPI,
 * unless it returns MPI_SUCCESS. */
#define MPI_CHECK(call) \
  base_check_mpi(__FILE__, __LINE__, __func__, #call, (call))

/* Hooks of an error: `record` writes a line to the log, `before` and
 * `after` stand around the last words of a program that ends in good order.
 * Each may be NULL. */
struct error_hooks {
  void (*record)(const char *line);
  void (*before)(void), (*after)(void);
};
/* Set the rank, the number of ranks and the hooks; for program.c. */
void base_set(int rank, int size, const struct error_hooks *hooks);

/* Serve the macros above; not meant to be called by name. */
void base_fatal(const char *file, int line, const char *function,
                const char *format, ...)
    __attribute__((format(printf, 4, 5), noreturn, cold));
void base_check_failed(const char *file, int line, const char *function,
                       const char *condition, const char *format, ...)
    __attribute__((format(printf, 5, 6), noreturn, cold));
void base_user_error(const char *format, ...)
    __attribute__((format(printf, 1, 2), noreturn, cold));
void base_system_error(const char *format, ...)
    __attribute__((format(printf, 1, 2), noreturn, cold));
void base_user_error_alone(const char *format, ...)
    __attribute__((format(printf, 1, 2), noreturn, cold));
void base_tell(const char *format, ...)
    __attribute__((format(printf, 1, 2), cold));
void base_warn(const char *file, int line, const char *function,
               const char *format, ...)
    __attribute__((format(printf, 4, 5), cold));
void base_check_mpi(const char *file, int line, const char *function,
                    const char *call, int result);

#endif
