# Talus: `make help` lists the targets, README.md says what it is about.
# The same sources are compiled twice: -DDIM=2 in build/2d, -DDIM=3 in build/3d.

BUILD   = build
MODE    = release
CC      = mpicc
PYTHON  = python3
NATIVE  = -march=native
WERROR  =
VERSION = 0.1
JOBS   := $(shell nproc 2>/dev/null || echo 2)
# Foreign libraries; Debian has no pkg-config file for p4est.
PKG_CONFIG   = pkg-config
PACKAGES     = hdf5-openmpi gsl lua5.4
PKG_CFLAGS  := $(shell $(PKG_CONFIG) --cflags $(PACKAGES) 2>/dev/null)
PKG_LIBS    := $(shell $(PKG_CONFIG) --libs $(PACKAGES) 2>/dev/null)
CHECK_LIBS  := $(shell $(PKG_CONFIG) --libs check 2>/dev/null)
P4EST_CFLAGS =
P4EST_LIBS   = -lp4est -lsc

OPT_release  = -O3 $(NATIVE) -DNDEBUG
OPT_debug    = -O0
OPT_asan     = -O1 -fno-omit-frame-pointer \
               -fsanitize=address,undefined,float-cast-overflow \
               -fno-sanitize-recover=undefined,float-cast-overflow
OPT_coverage = -O0 --coverage
WARNINGS     = -Wall -Wextra -Wshadow -Wstrict-prototypes \
               -Wmissing-prototypes -Wvla $(WERROR)
CFLAGS       = $(OPT_$(MODE)) -g -fno-math-errno $(WARNINGS)
CPPFLAGS     = -D_POSIX_C_SOURCE=200809L -DTALUS_VERSION='"$(VERSION)"' \
               -Iinclude $(P4EST_CFLAGS) $(PKG_CFLAGS)
COMPILE      = $(CC) -std=c11 $(CPPFLAGS) $(CFLAGS) $(EXTRA_CFLAGS)
LDLIBS       = $(P4EST_LIBS) $(PKG_LIBS) -lz -lm

LAUNCHER = src/command/launcher.c
MAIN     = src/command/main.c
# Files that each hold a model more than src/models.c lists, NAME.c of NAME_model
MODELS   =
SOURCES  = $(sort $(filter-out $(LAUNCHER) $(MAIN),$(wildcard src/*.c \
                  src/*/*.c tree/*.c)) $(MODELS))
LEVELS   = unit mesh convergence bench
C_FILES  = $(sort $(wildcard include/talus/*.h include/talus/*/*.h src/*.[ch] \
                  src/*/*.[ch] tree/*.[ch] tests/*/*.[ch]))
PROGRAMS = $(BUILD)/talus2d $(BUILD)/talus3d $(BUILD)/talus
TESTS    = $(foreach d,2d 3d,$(BUILD)/$d/unit $(BUILD)/$d/mesh)
PROOFS   = $(foreach d,2d 3d,$(BUILD)/$d/convergence $(BUILD)/$d/bench)

.DELETE_ON_ERROR:
.SUFFIXES:
# Targets that start programs; containers run as root and forbid CMA.
RUNNING = check check-unit check-mesh check-case examples-check demo asan \
          convergence bench valgrind coverage figure
.PHONY: all debug tests setup format format-check check-includes \
        tidy compdb clean help FORCE $(RUNNING)
$(foreach v,OMPI_ALLOW_RUN_AS_ROOT=1 OMPI_ALLOW_RUN_AS_ROOT_CONFIRM=1 \
  OMPI_MCA_btl_vader_single_copy_mechanism=none,$(eval $(RUNNING): export $v))
# V=1 shows the commands, else only what they make.
say = $(if $(V),,@echo '  make $(1)'; )
# Open MPI's own list of what is no error
VALGRIND_SUPPRESS = $(wildcard \
  $(dir $(shell command -v mpicc))../share/openmpi/openmpi-valgrind.supp)
# Make again, with all cores unless told otherwise: after the set-up, as flags
# are found when a Makefile is read, or for another MODE.
AGAIN = +@$(MAKE) --no-print-directory \
        $(if $(filter -j%,$(MAKEFLAGS)),,-j$(JOBS))

all: $(PROGRAMS) ## build talus, talus2d and talus3d
tests: $(TESTS)

# Texts the build depends on, written when they change: a change of flags or of
# the list of files rebuilds what it must.
STAMPS = flags sources models.inc $(LEVELS:%=%_suites.inc)
$(BUILD)/flags: TEXT = $(COMPILE) $(LDFLAGS) $(LDLIBS)
$(BUILD)/sources: TEXT = $(SOURCES)
$(BUILD)/models.inc: TEXT = $(foreach m,$(MODELS),MODEL($(basename $(notdir $m))))
$(foreach l,$(LEVELS),$(eval $(BUILD)/$l_suites.inc: TEXT = $(patsubst \
  tests/$l/test_%.c,SUITE(%),$(sort $(wildcard tests/$l/test_*.c)))))
$(STAMPS:%=$(BUILD)/%): FORCE
	@mkdir -p $(@D)
	@echo "$(TEXT)" | cmp -s - $@ || echo "$(TEXT)" > $@

define rules # 1: the dimension
$(BUILD)/$(1)d/%.o: %.c $(BUILD)/flags
	@mkdir -p $$(@D)
	$$(call say,$$@)$$(COMPILE) -DDIM=$(1) -MMD -MP -c -o $$@ $$<
$(BUILD)/$(1)d/src/models.o: $(BUILD)/models.inc
$(BUILD)/$(1)d/src/models.o: CPPFLAGS += -I$(BUILD)
$(BUILD)/$(1)d/libtalus.a: $(SOURCES:%.c=$(BUILD)/$(1)d/%.o) $(BUILD)/sources
	@rm -f $$@
	$$(call say,$$@)ar qcs $$@ $$(filter %.o,$$^)
$(BUILD)/talus$(1)d: $(BUILD)/$(1)d/$(MAIN:.c=.o) $(BUILD)/$(1)d/libtalus.a
endef
define test_rules # 1: the dimension, 2: the level
$(BUILD)/$(1)d/$(2): $(patsubst %.c,$(BUILD)/$(1)d/%.o,$(sort $(wildcard \
  tests/$(2)/*.c))) $(BUILD)/$(1)d/libtalus.a
$(BUILD)/$(1)d/tests/$(2)/main.o: $(BUILD)/$(2)_suites.inc
$(BUILD)/$(1)d/tests/$(2)/main.o: CPPFLAGS += -I$(BUILD)
endef
$(foreach d,2 3,$(eval $(call rules,$d)) \
  $(foreach l,$(LEVELS),$(eval $(call test_rules,$d,$l))))
# In 3D these loops read more arrays than there are registers, and vectors make it
# worse (docs/notes/solver.md).
$(BUILD)/3d/src/solver/sweep.o: private CFLAGS += -fno-tree-vectorize
$(BUILD)/talus: $(BUILD)/2d/$(LAUNCHER:.c=.o) $(BUILD)/2d/libtalus.a
$(TESTS): LDLIBS += $(CHECK_LIBS)
$(PROGRAMS) $(TESTS) $(PROOFS):
	$(call say,$@)$(CC) $(CFLAGS) $(EXTRA_CFLAGS) $(LDFLAGS) -o $@ $^ $(LDLIBS)
-include $(shell find $(BUILD)/2d $(BUILD)/3d -name '*.d' 2>/dev/null)

setup: ## find what is missing and install it
	@CC='$(CC)' CPPFLAGS='$(P4EST_CFLAGS)' PYTHON='$(PYTHON)' \
	  tools/setup.sh $(WITH)
demo: setup ## column collapse with pictures: half a minute on two cores, mostly compiling
	$(AGAIN) all
	$(BUILD)/talus run examples/column.lua level=9 -o $(BUILD)/demo
	$(BUILD)/talus plot $(BUILD)/demo
	@echo "The pictures are in $(BUILD)/demo:"; ls $(BUILD)/demo/*.[pg][ni][gf]

check: setup ## all tests, in four to five minutes on two free cores
	$(AGAIN) all tests
	@tests/run.sh $(BUILD) format includes unit mesh case
check-unit check-mesh check-case: check-%: ## one group of them
	$(AGAIN) all tests
	@tests/run.sh $(BUILD) $*
convergence: ## proof of the numbers in half an hour; CASE=NAME, CASE=short
	$(AGAIN) all $(PROOFS)
	@tests/convergence/run.sh $(BUILD) $(CASE)
bench: ## speed and memory, beside Gerris where it is installed; JOB=NAME
	$(AGAIN) all $(PROOFS)
	@$(PYTHON) tools/bench.py $(BUILD) $(JOB)
figure: ## of a paper, from our runs: PAPER=valette_2019 FIG=14, or FIG=all
	$(AGAIN) all
	@$(PYTHON) tools/figure.py $(PAPER) $(FIG) -o $(BUILD)/figures/$(PAPER) \
	  --talus $(BUILD)/talus
examples-check: ## every example at low resolution against its `expect`
	$(AGAIN) all
	@tests/run.sh $(BUILD) examples
format: ## clang-format 14 over all C files
	clang-format-14 -i $(C_FILES)
format-check check-includes: ## style; layering and forbidden calls
	@tests/run.sh $(BUILD) $(if $(filter f%,$@),format,includes)
tidy: ## clang-tidy, in both dimensions
	@failed=0; for d in 2 3; do printf '%s\n' $(filter src/%.c tree/%.c,$(C_FILES)) | \
	  xargs -P $(JOBS) -I{} clang-tidy --quiet {} -- -std=c11 -DDIM=$$d \
	    $(CPPFLAGS) $$($(CC) --showme:compile) || failed=1; done; exit $$failed
compdb: ## compile_commands.json
	bear -- $(MAKE) BUILD=$(BUILD)/compdb all tests

debug: ## with assertions, without optimisation, in build/debug
	$(AGAIN) MODE=debug BUILD=$(BUILD)/debug all tests
asan: ## address and undefined sanitizers: all tests but the cases
	$(AGAIN) MODE=asan BUILD=$(BUILD)/asan all tests
	@tests/run.sh $(BUILD)/asan unit mesh small
valgrind: ## memory check of a small case
	$(AGAIN) MODE=debug BUILD=$(BUILD)/debug all
	valgrind -q --error-exitcode=1 $(VALGRIND_SUPPRESS:%=--suppressions=%) \
	  $(BUILD)/debug/talus2d run examples/column.lua level=5 \
	  --max-steps 5 --quiet -o $(BUILD)/debug/column; test $$? -eq 5
coverage: ## lines of each source that unit and mesh tests reach
	$(AGAIN) MODE=coverage BUILD=$(BUILD)/coverage all tests
	@tests/run.sh $(BUILD)/coverage unit mesh
	@gcov -n $$(find $(BUILD)/coverage -name '*.gcda') 2>/dev/null | \
	  awk -F"'" '/^File/ {f = $$2} /^Lines/ && f ~ /^(src|tree)/ {print $$0, f}'
clean: ## remove everything that was built
	rm -rf $(BUILD) compile_commands.json
help: ## this list
	@sed -n 's/^\([a-z][a-z -]*\):.*## \(.*\)/\1: \2/p' Makefile
	@echo "variables: BUILD MODE CC NATIVE= WERROR=-Werror MODELS EXTRA_CFLAGS PYTHON V=1"
